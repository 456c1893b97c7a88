/* The comb's closed path: forward stroke, lift, return, lowering. */
#include "solver/cycle.h"

#include <math.h>
#include <stdio.h>

static int refuse(scree_cycle *cycle, const char *cause, double value) {
    snprintf(cycle->text, sizeof cycle->text, cause, value);
    return 1;
}

/* From rest to rest; a pause where both positions are the same. */
static struct scree_segment rest_to_rest(double duration, double from, double to) {
    return scree_position_segment(duration, (struct scree_kinematics){.x = from}, (struct scree_kinematics){.x = to});
}

/* Append a motion unless it takes no time. */
static void go(struct scree_profile *profile, double duration, double from, double to) {
    struct scree_segment segment = rest_to_rest(duration, from, to);
    if (duration > 0.0) scree_profile_append(profile, &segment);
}

/* Largest velocity and acceleration at the profile's ends, in parts of what a rest-to-rest motion of its size has. */
static double unrest(const struct scree_profile *forward) {
    double time = scree_profile_duration(forward);
    struct scree_kinematics from = scree_segment_at(&forward->segment[0], 0.0);
    const struct scree_segment *last = &forward->segment[forward->count - 1];
    struct scree_kinematics to = scree_segment_at(last, last->duration);
    double stroke = fabs(to.x - from.x);
    return fmax(fmax(fabs(from.v), fabs(to.v)) * time, fmax(fabs(from.a), fabs(to.a)) * time * time) / stroke;
}

static int check(const scree_cycle_def *def, const struct scree_profile *forward, scree_cycle *cycle) {
    if (!(def->cycles > 0.0) || !isfinite(def->cycles))
        return refuse(cycle, "the operating speed must be positive, got %g cycles/min", def->cycles);
    if (!isfinite(def->lift) || def->lift == 0.0)
        return refuse(cycle, "the lift must be a length other than 0, got %g m", def->lift);
    if (!(def->share >= 0.0 && def->share <= 0.5))
        return refuse(cycle, "the share of leaving the plane must be in 0 … 1/2, got %g", def->share);
    if (!(def->overlap >= 0.0 && def->overlap <= 1.0))
        return refuse(cycle, "the overlap of lift and return must be in 0 … 1, got %g", def->overlap);
    if (forward->count < 1 || forward->count > SCREE_PROFILE_SEGMENTS - 3 || forward->start[0] != 0.0)
        return refuse(cycle, "the forward stroke must have 1 to %g segments, from time 0", SCREE_PROFILE_SEGMENTS - 3);
    if (!(scree_profile_duration(forward) < 60.0 / def->cycles))
        return refuse(cycle, "the forward stroke takes the whole cycle (%g s): no time for the return",
                      60.0 / def->cycles);
    if (!(unrest(forward) < 1e-9)) /* rounding of polynomials whose coefficients are about 1e2 strokes */
        return refuse(cycle, "the forward stroke must begin and end at rest (relative unrest %g)", unrest(forward));
    return 0;
}

int scree_cycle_make(const scree_cycle_def *def, const struct scree_profile *forward, scree_cycle *cycle) {
    *cycle = (scree_cycle){0};
    if (check(def, forward, cycle)) return 1;
    cycle->duration = 60.0 / def->cycles;
    cycle->forward = forward->start[forward->count];
    double left = cycle->duration - cycle->forward, up = (def->share > 0.0 ? def->share : 1.0 / 3.0) * left;
    double wait = up * (1.0 - def->overlap);
    double from = scree_profile_at(forward, cycle->forward).x, to = scree_profile_at(forward, 0.0).x;
    cycle->x = *forward;
    go(&cycle->x, wait, from, from);
    go(&cycle->x, left - 2.0 * wait, from, to);
    go(&cycle->x, wait, to, to);
    go(&cycle->z, cycle->forward, 0.0, 0.0);
    go(&cycle->z, up, 0.0, def->lift);
    go(&cycle->z, left - 2.0 * up, def->lift, def->lift);
    go(&cycle->z, up, def->lift, 0.0);
    /* The ends are the same instant, whatever the sums of durations were rounded to. */
    cycle->x.start[cycle->x.count] = cycle->z.start[cycle->z.count] = cycle->duration;
    cycle->departure = scree_profile_at(&cycle->z, cycle->forward + wait).x;
    return 0;
}

void scree_cycle_at(const scree_cycle *cycle, double time, struct scree_kinematics *x, struct scree_kinematics *z) {
    double within = time - floor(time / cycle->duration) * cycle->duration;
    *x = scree_profile_at(&cycle->x, within);
    *z = scree_profile_at(&cycle->z, within);
}
