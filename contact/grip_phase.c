/* The phases of a contact: where they end, what follows, what is kept of them. */
#include "contact/grip.h"

#include "contact/meet.h"

#include <string.h>

/* Where each way's numbers are kept. */
static const int kept_at[SCREE_GRIP_WAYS] = {SCREE_KEPT_FRICTION, SCREE_KEPT_ROLLING, SCREE_KEPT_ROLLING + 4};

static struct scree_normal_force law_at(const struct scree_grip *grip, double overlap, double closing) {
    struct scree_pressing at = scree_pressed(overlap, closing, grip->first, grip->second);
    return grip->normal->force(&grip->rule->normal_constants, grip->of_normal, at);
}

static int remembers_peak(const struct scree_grip *grip) { return grip->normal->memory && !grip->normal->reach; }

/* Overlap, speed and force of the order of those that the contact will have. */
static void set_scales(struct scree_grip *grip, double overlap, double closing) {
    const struct scree_law_constants *constants = &grip->rule->normal_constants;
    struct scree_pressing at = {.overlap = fmax(overlap, 0.0), .second = grip->second};
    double stored = fabs(grip->normal->stored(constants, grip->of_normal, at));
    double energy = stored + 0.5 * grip->mass * closing * closing, depth = fmax(1e-18, 1e-3 * at.overlap);
    for (at.overlap = depth; depth < 1e3; depth *= 1.25, at.overlap = depth)
        if (grip->normal->stored(constants, grip->of_normal, at) >= energy) break;
    grip->depth = depth;
    grip->speed = sqrt(2.0 * energy / grip->mass) + SCREE_NO_SPEED;
    grip->load = fmax(fabs(law_at(grip, depth, -SCREE_NO_SPEED).elastic), energy / depth) + SCREE_NO_SPEED;
}

/* ---- how a contact begins ---- */

/* Dashpot of a slider, N s/m. */
static double damping_at(const struct scree_grip *grip, int way, double overlap) {
    if (way != SCREE_GRIP_FRICTION) return grip->rolling->damping(&grip->rule->rolling_constants);
    return grip->friction->damping(&grip->rule->friction_constants, grip->of_friction, overlap);
}

/* The force of friction's spring at a small overlap over the way since the touch, by Simpson's rule in the root of the
 * overlap. */
static double mean_stiffness(const struct scree_grip *grip, double overlap) {
    const struct scree_friction_law *law = grip->friction;
    const struct scree_law_constants *constants = &grip->rule->friction_constants;
    double sum = 0.0;
    if (!law->in_force) return law->stiffness(constants, grip->of_friction, overlap);
    for (int k = 0; k <= 2; k++) {
        double q = 0.5 * k, k_t = law->stiffness(constants, grip->of_friction, overlap * q * q);
        sum += (k == 1 ? 4.0 : 1.0) / 6.0 * 2.0 * q * k_t;
    }
    return sum;
}

static int has_band(const struct scree_grip *grip) { return grip->friction && grip->friction->band; }

/* How much slower it slides than where its hold jumps, m/s. */
static double left_of_band(const struct scree_grip *grip, const struct scree_grip_view *view) {
    return grip->friction->band(&grip->rule->friction_constants) - vec_norm(view->slip);
}

/* Whether it is told where the slip is least. Of bristles, since their rates have a kink where it turns round: a step
 * across would be taken for right. */
static int watches_slip(const struct scree_grip *grip) {
    return has_band(grip) ? !grip->inside : grip->friction && grip->friction->rate;
}

/* By how much the square of the slip grows, m^2/s^2. */
static double slip_gain(const struct scree_grip_view *sooner, const struct scree_grip_view *later) {
    return vec_norm2(later->slip) - vec_norm2(sooner->slip);
}

static void note_band(struct scree_grip *grip, const struct scree_grip_view *view) {
    grip->inside = has_band(grip) && left_of_band(grip, view) > 0.0;
}

/* Whether a slider that starts without stretch slips from the first touch on: what it would carry at a tiny overlap if
 * it stuck, against what it holds there. */
static int slips_at_once(const struct scree_grip *grip, int way, const struct scree_grip_view *view) {
    if (!(view->closing > 0.0)) return 0;
    double d = 1e-8 * grip->depth, time = d / view->closing, speed = vec_norm(view->velocity[way]);
    struct scree_normal_force f = law_at(grip, d, view->closing);
    double normal = fmax(f.elastic + f.damping * view->closing, 0.0), damping = damping_at(grip, way, d);
    if (way != SCREE_GRIP_FRICTION)
        return (scree_grip_stiffness(grip, way, d) * time + damping) * speed > scree_grip_slides(grip, way, normal);
    struct scree_sliding at = {.normal = normal, .overlap = d, .velocity = view->slip};
    double holds = grip->friction->hold(&grip->rule->friction_constants, at).holds;
    return (mean_stiffness(grip, d) * time + damping) * speed > holds;
}

/* A way slips from its first stretch on; where it has no dashpot, along its velocity. */
static void let_slip(struct scree_grip *grip, int way, const struct scree_grip_view *view, double *memory) {
    double speed = vec_norm(view->velocity[way]);
    grip->slips[way] = 1;
    if (speed > 0.0 && damping_at(grip, way, grip->depth) == 0.0)
        vec_store(vec_scale(1e-3 * grip->depth / speed, view->velocity[way]), memory + 3 * way);
}

/* How far the spring of each way is stretched while it slips under the load to come. */
static void set_longest(struct scree_grip *grip) {
    for (int way = 0; way < SCREE_GRIP_WAYS; way++) {
        if (!scree_grip_is_slider(grip, way)) continue;
        double slides = scree_grip_slides(grip, way, grip->load), unit = scree_grip_stiffness(grip, way, grip->depth);
        int in_force = way == SCREE_GRIP_FRICTION && grip->friction->in_force;
        if (in_force) unit = grip->friction->stiffness(&grip->rule->friction_constants, grip->of_friction, grip->depth);
        grip->longest[way] = slides / unit;
    }
}

static void begin_sideways(struct scree_grip *grip, const struct scree_grip_view *view, double *memory) {
    memset(memory, 0, SCREE_GRIP_MEMORY * sizeof *memory);
    memset(grip->slips, 0, sizeof grip->slips);
    note_band(grip, view);
    set_longest(grip);
    for (int way = 0; way < SCREE_GRIP_WAYS; way++)
        if (scree_grip_is_slider(grip, way) && slips_at_once(grip, way, view)) let_slip(grip, way, view, memory);
}

/* Under no load yet a slider bears nothing: it slips, wherever a dashpot would push or a spring be stretched at once.
 * What should stick all the same does at the next look. */
static void take_hold(struct scree_grip *grip, const struct scree_grip_view *view, double *memory) {
    memset(memory, 0, SCREE_GRIP_MEMORY * sizeof *memory);
    memset(grip->slips, 0, sizeof grip->slips);
    note_band(grip, view);
    for (int way = 0; way < SCREE_GRIP_WAYS; way++)
        if (scree_grip_is_slider(grip, way) && vec_norm(view->velocity[way]) > 0.0) let_slip(grip, way, view, memory);
}

/* Where a force that may pull passes through zero: the spring beside a slider's dashpot goes on slackening. */
static void pass_no_load(struct scree_grip *grip, const struct scree_grip_view *view, double *memory) {
    double before[SCREE_GRIP_MEMORY];
    memcpy(before, memory, sizeof before);
    take_hold(grip, view, memory);
    for (int way = 0; way < SCREE_GRIP_WAYS; way++) {
        if (!scree_grip_is_slider(grip, way) || !(view->damping_of[way] > 0.0)) continue;
        memcpy(memory + 3 * way, before + 3 * way, 3 * sizeof *memory);
        grip->slips[way] = 1;
    }
}

static void begin(struct scree_grip *grip, const struct scree_grip_view *view, double *memory) {
    grip->state = SCREE_GRIP_HELD;
    grip->approaching = view->closing >= 0.0;
    set_scales(grip, view->overlap, view->closing);
    struct scree_normal_force first = law_at(grip, 1e-30 * grip->depth, view->closing);
    grip->first = first.first;
    grip->second = first.second;
    grip->pulling = !grip->normal->cut && first.elastic + first.damping * view->closing < 0.0;
    begin_sideways(grip, view, memory);
    for (int k = 0; k < SCREE_GRIP_CHANGES; k++) grip->since[k] = -HUGE_VAL;
    grip->fresh = 1;
}

static void end(struct scree_grip *grip, enum scree_grip_state state, double *memory) {
    grip->state = state;
    memset(memory, 0, SCREE_GRIP_MEMORY * sizeof *memory);
    memset(grip->slips, 0, sizeof grip->slips);
    grip->pulling = 0;
    if (state != SCREE_GRIP_APART) return;
    grip->first = grip->second = 0.0;
    grip->advancing = 0;
}

/* ---- memory between steps of the scene ---- */

void scree_grip_recall(struct scree_grip *grip, const struct scree_grip_view *view, const double *kept,
                       double *memory) {
    double overlap = view->overlap;
    memset(memory, 0, SCREE_GRIP_MEMORY * sizeof *memory);
    if (kept && grip->normal->memory) {
        grip->first = kept[SCREE_KEPT_NORMAL];
        grip->second = kept[SCREE_KEPT_NORMAL + 1];
    }
    int touches = overlap > 0.0 || (grip->normal->reach && grip->second > 0.0 && overlap > -grip->reach);
    if (!touches) {
        end(grip, SCREE_GRIP_APART, memory);
        return;
    }
    grip->approaching = view->closing >= 0.0;
    grip->fresh = 1;
    note_band(grip, view);
    set_scales(grip, overlap, view->closing);
    struct scree_normal_force now = law_at(grip, overlap, view->closing);
    if (grip->normal->memory) {
        grip->first = now.first;
        grip->second = now.second;
    }
    double force = now.elastic + now.damping * view->closing;
    grip->state = grip->normal->cut && !(force > 0.0) ? SCREE_GRIP_SPENT : SCREE_GRIP_HELD;
    grip->pulling = !grip->normal->cut && force < 0.0;
    for (int way = 0; kept && way < SCREE_GRIP_WAYS; way++) {
        int single = way == SCREE_GRIP_TWISTING, numbers = single ? 1 : 3;
        if (way == SCREE_GRIP_FRICTION ? !grip->friction || !grip->friction->memory
                                       : !grip->rolling || !grip->rolling->memory)
            continue;
        for (int m = 0; m < numbers; m++) memory[3 * way + m] = kept[kept_at[way] + m];
        grip->slips[way] = scree_grip_is_slider(grip, way) && kept[kept_at[way] + numbers] > 0.0;
    }
    set_longest(grip);
}

void scree_grip_keep(const struct scree_grip *grip, const struct scree_grip_view *view, const double *memory,
                     double *kept) {
    for (int m = 0; m < SCREE_MEMORY; m++) kept[m] = 0.0;
    if (grip->state == SCREE_GRIP_APART) return;
    kept[SCREE_KEPT_NORMAL] = grip->first;
    kept[SCREE_KEPT_NORMAL + 1] = grip->second;
    for (int way = 0; grip->state == SCREE_GRIP_HELD && way < SCREE_GRIP_WAYS; way++) {
        int single = way == SCREE_GRIP_TWISTING, numbers = single ? 1 : 3;
        struct vec stretch = vec_from(memory + 3 * way);
        if (grip->slips[way] && view->damping_of[way] == 0.0) {
            int in_force = way == SCREE_GRIP_FRICTION && grip->friction->in_force;
            stretch = vec_scale(in_force ? 1.0 : 1.0 / view->stiffness[way], view->elastic[way]);
        }
        double numbers_of[3] = {stretch.x, stretch.y, stretch.z};
        for (int m = 0; m < numbers; m++) kept[kept_at[way] + m] = numbers_of[m];
        kept[kept_at[way] + numbers] = grip->slips[way] && scree_grip_is_slider(grip, way) ? 1.0 : 0.0;
    }
}

/* ---- switch functions ---- */

int scree_grip_needs_rates(const struct scree_grip *grip) {
    if (grip->state != SCREE_GRIP_HELD) return 0;
    int any = remembers_peak(grip) || watches_slip(grip);
    for (int way = 0; way < SCREE_GRIP_WAYS; way++) any |= grip->slips[way];
    return any;
}

/* How fast the trial force of a bare spring that slips would outgrow what it slides with, N/s: while positive it slips
 * on. */
static double slip_rate(const struct scree_grip *grip, int way, const struct scree_grip_view *view,
                        const struct scree_grip_view *sooner, const struct scree_grip_view *later, double apart) {
    double rate = view->grows[way];
    rate -= (later->slides[way] - sooner->slides[way]) / apart;
    int in_stretch = way != SCREE_GRIP_FRICTION || !grip->friction->in_force;
    int falls = !in_stretch && grip->friction->rescaled && view->closing < 0.0;
    if ((in_stretch || falls) && view->stiffness[way] > 0.0)
        rate += view->slides[way] * (later->stiffness[way] - sooner->stiffness[way]) / apart / view->stiffness[way];
    return rate;
}

static double slide_switch(const struct scree_grip *grip, int way, const struct scree_grip_view *view,
                           const struct scree_grip_view *sooner, const struct scree_grip_view *later, double apart) {
    struct vec trial = vec_axpy(view->elastic[way], view->damping_of[way], view->velocity[way]);
    double size = vec_norm(trial);
    if (!grip->slips[way]) return (view->holds[way] - size) / grip->load;
    if (view->damping_of[way] > 0.0) return (size - view->slides[way]) / grip->load;
    return sooner && later ? slip_rate(grip, way, view, sooner, later, apart) * grip->depth / (grip->speed * grip->load)
                           : 1.0;
}

/* Positive while a law that is cut lasts: its force over its damping rather than the force, for k d/c + u has no root
 * of d in it. Of a contact that the law has let go, a step may pass the overlap at which a dashpot that fades lets it
 * take hold again, and the end: there and beyond, its force just before the end counts. Where only the speed does, it
 * is the force at the largest overlap, which tells it as well near the end and beyond. */
static double lasting(const struct scree_grip *grip, const struct scree_grip_view *view) {
    double whole = view->whole, damping = view->damping, least = 1e-6 * grip->depth;
    if (grip->by_speed || (grip->state == SCREE_GRIP_SPENT && view->overlap < least)) {
        struct scree_normal_force f = law_at(grip, grip->by_speed ? grip->depth : least, view->closing);
        whole = f.elastic + f.damping * view->closing;
        damping = f.damping;
    }
    return whole / (damping + 1e-6 * grip->load / grip->speed);
}

void scree_grip_switches(const struct scree_grip *grip, const struct scree_grip_view *view,
                         const struct scree_grip_view *sooner, const struct scree_grip_view *later, double apart,
                         double values[SCREE_SWITCHES]) {
    for (int k = 0; k < SCREE_SWITCHES; k++) values[k] = 1.0;
    if (grip->state == SCREE_GRIP_APART) {
        values[SCREE_SWITCH_OVERLAP] = -view->overlap;
        return;
    }
    values[SCREE_SWITCH_OVERLAP] = view->overlap + grip->reach;
    if (grip->state == SCREE_GRIP_SPENT) {
        values[SCREE_SWITCH_FORCE] = -lasting(grip, view);
        return;
    }
    if (grip->normal->cut) values[SCREE_SWITCH_FORCE] = lasting(grip, view);
    if (grip->directional) values[SCREE_SWITCH_TURN] = grip->approaching ? view->closing : -view->closing;
    if (!grip->normal->cut && (grip->friction || grip->rolling))
        values[SCREE_SWITCH_PULL] = (grip->pulling ? -view->force : view->force) / grip->load;
    if (remembers_peak(grip)) {
        double peak = scree_grip_peak(grip, view);
        if (!grip->advancing)
            values[SCREE_SWITCH_PEAK] = (grip->first * (1.0 + 1e-14) - peak) / (grip->first + SCREE_NO_SPEED);
        else if (sooner && later && !(fmin(sooner->overlap, later->overlap) < 0.5 * SCREE_OUTSIDE))
            values[SCREE_SWITCH_PEAK] = (scree_grip_peak(grip, later) - scree_grip_peak(grip, sooner)) / apart *
                                        grip->depth / (grip->speed * (grip->first + SCREE_NO_SPEED));
    }
    if (grip->pulling) return;
    if (watches_slip(grip) && !grip->wary[SCREE_GRIP_GROWTH] && sooner && later)
        values[SCREE_SWITCH_NEAREST] = (grip->recedes ? 1.0 : -1.0) * slip_gain(sooner, later) / apart * grip->depth /
                                       (grip->speed * grip->speed * grip->speed);
    if (has_band(grip))
        values[SCREE_SWITCH_BAND] = (grip->inside ? 1.0 : -1.0) * left_of_band(grip, view) / grip->speed;
    for (int way = 0; way < SCREE_GRIP_WAYS; way++)
        if (scree_grip_may_slip(grip, way) && !grip->wary[way])
            values[SCREE_SWITCH_SLIDE + way] = slide_switch(grip, way, view, sooner, later, apart);
}

static void switch_slide(struct scree_grip *grip, int way, const struct scree_grip_view *view, double *memory) {
    int in_force = way == SCREE_GRIP_FRICTION && grip->friction->in_force;
    if (grip->slips[way] && view->damping_of[way] == 0.0)
        vec_store(vec_scale(in_force ? 1.0 : 1.0 / view->stiffness[way], view->elastic[way]), memory + 3 * way);
    grip->slips[way] = !grip->slips[way];
}

/* Beyond the speed at which friction's hold jumps: what slips holds at once if it may bear more now than it does, what
 * holds breaks loose if it bears more than it may. */
static void switch_band(struct scree_grip *grip, const struct scree_grip_view *view, double *memory) {
    const int way = SCREE_GRIP_FRICTION;
    struct scree_sliding at = {.normal = fmax(view->force, 0.0), .overlap = view->overlap, .velocity = view->slip};
    double bears = vec_norm(vec_axpy(view->elastic[way], view->damping_of[way], view->velocity[way]));
    grip->inside = !grip->inside;
    grip->recedes = 1; /* out of it it goes only so */
    double holds = scree_hold_on(grip->friction, &grip->rule->friction_constants, at, grip->inside).holds;
    if (grip->slips[way] ? bears < holds : bears > holds) switch_slide(grip, way, view, memory);
}

void scree_grip_switch(struct scree_grip *grip, enum scree_switch which, const struct scree_grip_view *view,
                       double *memory) {
    switch (which) {
    case SCREE_SWITCH_OVERLAP:
        if (grip->state == SCREE_GRIP_APART)
            begin(grip, view, memory);
        else
            end(grip, SCREE_GRIP_APART, memory);
        break;
    case SCREE_SWITCH_FORCE:
        if (grip->state == SCREE_GRIP_HELD)
            end(grip, SCREE_GRIP_SPENT, memory);
        else {
            grip->state = SCREE_GRIP_HELD;
            take_hold(grip, view, memory);
        }
        grip->approaching = view->closing >= 0.0;
        break;
    case SCREE_SWITCH_TURN:
        grip->approaching = !grip->approaching;
        break;
    case SCREE_SWITCH_PULL:
        grip->pulling = !grip->pulling;
        pass_no_load(grip, view, memory);
        break;
    case SCREE_SWITCH_BAND:
        switch_band(grip, view, memory);
        break;
    case SCREE_SWITCH_NEAREST:
        grip->recedes = !grip->recedes;
        break;
    case SCREE_SWITCH_PEAK:
        if (grip->advancing) grip->first = fmax(grip->first, scree_grip_peak(grip, view));
        grip->advancing = !grip->advancing;
        break;
    default:
        switch_slide(grip, (int)which - SCREE_SWITCH_SLIDE, view, memory);
        break;
    }
}

void scree_grip_set_advancing(struct scree_grip *grip, const struct scree_grip_view *sooner,
                              const struct scree_grip_view *later) {
    grip->recedes = slip_gain(sooner, later) > 0.0;
    if (grip->state != SCREE_GRIP_HELD || !remembers_peak(grip)) return;
    double next = scree_grip_peak(grip, later);
    grip->advancing = next > scree_grip_peak(grip, sooner) && next >= grip->first * (1.0 - 1e-12);
}

void scree_grip_settle(struct scree_grip *grip, const struct scree_grip_view *view, double *memory) {
    for (int k = 0; k < SCREE_GRIP_CHANGES; k++) grip->wary[k] -= grip->wary[k] > 0;
    if (grip->state != SCREE_GRIP_HELD) return;
    if (!grip->directional) grip->approaching = view->closing >= 0.0;
    /* Others have pushed it together since it began. */
    if (view->overlap > 1.5 * grip->depth || fabs(view->closing) > 1.5 * grip->speed)
        set_scales(grip, view->overlap, view->closing);
    if (grip->normal->memory) {
        struct scree_normal_force f = law_at(grip, view->overlap, view->closing);
        if (grip->advancing && f.first > grip->first) grip->first = f.first;
        if (grip->normal->reach) grip->second = 1.0;
    }
    for (int way = 0; way < SCREE_GRIP_WAYS; way++) {
        if (!grip->slips[way] || view->damping_of[way] > 0.0 || !(view->stiffness[way] > 0.0)) continue;
        double stretch = view->slides[way] / view->stiffness[way];
        if (stretch > grip->longest[way]) grip->longest[way] = stretch;
        if (scree_grip_is_slider(grip, way) && !(stretch > 0.0)) let_slip(grip, way, view, memory);
    }
}
