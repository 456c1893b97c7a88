/* Operating speeds: what a profile does at another speed than its own, and the limits of the new motion. */
#include "solver/transport.h"

#include <math.h>

static double slowing(const scree_transport *t) { return t->friction * t->gravity; }

double scree_scaled_clearance(const scree_transport *transport, const scree_plan *design, double cycles) {
    double duration = scree_transport_time(transport, cycles), ratio = duration / design->duration,
           mu_g = slowing(transport);
    struct scree_profile scaled = scree_profile_scaled(&design->profile, duration);
    double t3 = design->time[3] * ratio, left = scree_segment_first(&scaled.segment[1], -mu_g);
    /* The product leaves at event 1 if the comb brakes harder than friction from there on, else where it first does. */
    if (scree_segment_at(&scaled.segment[1], 0.0).a <= -mu_g) left = 0.0;
    if (left < 0.0) return HUGE_VAL;
    left += scaled.start[1];
    struct scree_kinematics from = scree_profile_at(&scaled, left);
    double slide = t3 - left, x = from.x + from.v * slide - 0.5 * mu_g * slide * slide;
    return scree_transport_play(transport) - (x - scree_profile_at(&scaled, t3).x);
}

/* ---- a rigid product between rigid tines ---- */

enum where { PUSHED, FREE, CAUGHT };

struct product {
    enum where where;
    double since, x, v; /* of the free slide: time, position, velocity at its begin */
};

/* Position and velocity of the free product: it slides to rest and stays. */
static void slide(const struct product *p, double mu_g, double time, double *x, double *v) {
    double sign = p->v < 0.0 ? -1.0 : 1.0, t = fmin(time - p->since, fabs(p->v) / mu_g);
    *x = p->x + t * (p->v - 0.5 * sign * mu_g * t);
    *v = p->v - sign * mu_g * t;
}

/* How far the product is outside of the play (> 0: beyond the front tines; < 0: into the rear ones; 0: between). */
static double outside(const struct product *p, const struct scree_profile *profile, double mu_g, double play,
                      double time) {
    double x, v;
    slide(p, mu_g, time, &x, &v);
    double y = x - scree_profile_at(profile, time).x;
    return y > play ? y - play : y < 0.0 ? y : 0.0;
}

/* The free product has met a tine between `before` and `time`: find when, and let it bounce or stay. */
static double meet(struct product *p, const struct scree_profile *profile, const scree_transport *t, double restitution,
                   double before, double time, scree_slide *result) {
    double mu_g = slowing(t), play = scree_transport_play(t), x, v;
    double low = before, high = time;
    for (int k = 0; k < 60; k++) {
        double middle = 0.5 * (low + high);
        if (outside(p, profile, mu_g, play, middle) == 0.0)
            low = middle;
        else
            high = middle;
    }
    int front = outside(p, profile, mu_g, play, high) > 0.0;
    struct scree_kinematics comb = scree_profile_at(profile, high);
    slide(p, mu_g, high, &x, &v);
    double relative = v - comb.v;
    result->impacts++;
    if (front && result->first_contact == 0.0) result->first_contact = fabs(relative);
    double after = -restitution * relative;
    /* Slower than friction would stop within a thousandth of the motion: it stays, if the comb presses against it. */
    int presses = front ? comb.a <= -mu_g || comb.v == 0.0 : comb.a >= -mu_g;
    int stays = fabs(after) < 1e-3 * mu_g * scree_profile_duration(profile) && presses;
    p->where = stays ? (front ? CAUGHT : PUSHED) : FREE;
    p->since = high;
    p->x = comb.x + (front ? play * (1.0 - 1e-15) : 0.0);
    p->v = comb.v + (stays ? 0.0 : after);
    return high;
}

scree_slide scree_slide_simulate(const scree_transport *transport, const struct scree_profile *profile,
                                 double restitution) {
    enum { STEPS = 20000 };
    double mu_g = slowing(transport), play = scree_transport_play(transport),
           duration = scree_profile_duration(profile);
    double step = duration / STEPS, last = 3.0 * duration;
    struct product p = {PUSHED, 0.0, 0.0, 0.0};
    scree_slide result = {0};
    double x = 0.0, v = 0.0, before = 0.0;
    for (double time = step; time < last || (p.where == FREE && v != 0.0 && time < 100.0 * duration); time += step) {
        struct scree_kinematics comb = scree_profile_at(profile, time);
        int moving = time < duration;
        if (p.where == PUSHED && moving && comb.a < -mu_g) {
            p = (struct product){FREE, time, comb.x, comb.v};
            result.detached = 1;
        } else if (p.where == CAUGHT && moving && comb.a > -mu_g) {
            p = (struct product){FREE, time, comb.x + play * (1.0 - 1e-15), comb.v};
        } else if (p.where != FREE) {
            x = comb.x + (p.where == CAUGHT ? play : 0.0);
            v = comb.v;
        } else {
            double from = before;
            for (int k = 0; k < 100 && p.where == FREE && outside(&p, profile, mu_g, play, time) != 0.0; k++)
                from = meet(&p, profile, transport, restitution, from, time, &result);
            if (p.where == FREE) slide(&p, mu_g, time, &x, &v);
        }
        before = time;
    }
    if (p.where != FREE) x = scree_profile_at(profile, last).x + (p.where == CAUGHT ? play : 0.0);
    result.error = x - transport->distance;
    return result;
}

/* ---- limits ---- */

double scree_limit_detachment(const scree_transport *transport, const scree_plan *design) {
    /* The comb's hardest braking in segment 12 scales with the square of the speed. */
    struct scree_profile one = {0};
    scree_profile_append(&one, &design->profile.segment[1]);
    return design->cycles * sqrt(slowing(transport) / -scree_profile_extrema(&one).least.a);
}

/* v3/D4 - 0.6 mu g of formulation A, which grows with the speed. */
static double margin_low(const scree_transport *t, double cycles) {
    double v[3], duration = scree_transport_time(t, cycles);
    if (scree_plan_rigid(t, cycles, v)) return NAN;
    return v[2] / ((1.0 - t->fractions[2]) * duration) - 0.6 * slowing(t);
}

double scree_limit_low(const scree_transport *transport) {
    double low = 1e-3, high = 1.0;
    while (margin_low(transport, high) < 0.0 && high < 1e9) high *= 2.0;
    for (int k = 0; k < 200; k++) {
        double middle = 0.5 * (low + high);
        if (margin_low(transport, middle) < 0.0)
            low = middle;
        else
            high = middle;
    }
    return high;
}

static int beyond_drive(const scree_transport *t, double cycles) {
    scree_plan plan;
    scree_plan_make(t, cycles, NULL, &plan);
    double a = fmax(-plan.extrema.least.a, plan.extrema.largest.a),
           j = fmax(-plan.extrema.least.j, plan.extrema.largest.j);
    return (t->largest_acceleration > 0.0 && a > t->largest_acceleration) ||
           (t->largest_jerk > 0.0 && j > t->largest_jerk);
}

double scree_limit_drive(const scree_transport *transport, double low, double high) {
    if (!beyond_drive(transport, high)) return HUGE_VAL;
    for (int k = 0; k < 100; k++) {
        double middle = 0.5 * (low + high);
        if (beyond_drive(transport, middle))
            high = middle;
        else
            low = middle;
    }
    return low;
}

/* Whether the scaled profile still places the product well enough. */
static int within(const scree_transport *t, const scree_plan *design, double restitution, double tolerance,
                  double cycles) {
    struct scree_profile scaled = scree_profile_scaled(&design->profile, scree_transport_time(t, cycles));
    return fabs(scree_slide_simulate(t, &scaled, restitution).error) <= tolerance;
}

void scree_limit_range(const scree_transport *transport, const scree_plan *design, double restitution, double tolerance,
                       double *least, double *most) {
    double n = design->cycles;
    *least = *most = n;
    /* Walk outwards by 1/min until it fails, then bisect the last step. */
    for (int side = -1; side <= 1; side += 2) {
        double good = n, bad = n;
        for (int k = 1; k < 2000; k++) {
            bad = n + side * k;
            if (bad <= 1.0 || !within(transport, design, restitution, tolerance, bad)) break;
            good = bad;
        }
        for (int k = 0; k < 20; k++) {
            double middle = 0.5 * (good + bad);
            if (within(transport, design, restitution, tolerance, middle))
                good = middle;
            else
                bad = middle;
        }
        *(side < 0 ? least : most) = good;
    }
}
