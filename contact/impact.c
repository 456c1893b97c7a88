/* Two bodies meet head-on, integrated to rounding.
 *
 * Laws begin and end with roots of the overlap (d^(1/4), d^(1/2), d^(3/2)), where no one-step method keeps its order.
 * With
 *   q = (d + reach)^(1/4),  dt = 4 q^3 ds:  dq/ds = u,  du/ds = 4 q^3 (P - F)/m
 * the right-hand side is smooth there (the pull-off of adhesive laws is a root of d + reach too), and the end at q = 0
 * is crossed at full speed. Steps are Gragg's midpoint rule extrapolated to order 12 (Bulirsch & Stoer, Numer. Math. 8
 * (1966) 1; Hairer, Norsett & Wanner, Solving Ordinary Differential Equations I, II.9), as short as their error
 * estimate demands: where a law has a kink, the steps close in on it. The turning point and the end are located inside
 * the step. */
#include "contact/impact.h"

#include <stddef.h>

enum { COLUMNS = 6, MOST_STEPS = 20000 };

/* Error allowed in a step, relative to overlap, speed and time: some units of rounding. And the share of the overlap's
 * scale in a step. */
static const double allowed = 1e-14, longest_step = 0.01;

/* What is integrated: the uncut law, so that the right-hand side is smooth up to the end of the contact. */
struct pair {
    const struct scree_normal_law *law;
    const struct scree_law_constants *constants;
    struct scree_pair_constants of_pair;
    double mass, friction, reach;
    int approaching;      /* the branch of a law that tells approach from parting */
    double first, second; /* what the law has kept, at the start of the step */
    double scale;         /* of q */
};

struct motion {
    double q, u, t;
};

static double overlap_of(const struct pair *pair, double q) { return q * q * q * q - pair->reach; }

static struct scree_pressing press(const struct pair *pair, double overlap, double closing) {
    /* At the turning point rounding must not pick the other branch. */
    double branch = pair->approaching ? fmax(closing, 1e-300) : fmin(closing, -1e-300);
    return scree_pressed(overlap, branch, pair->first, pair->second);
}

static double force_at(const struct pair *pair, double overlap, double closing) {
    struct scree_normal_force f = pair->law->force(pair->constants, pair->of_pair, press(pair, overlap, closing));
    return f.elastic + f.damping * closing;
}

static double force_on(const struct pair *pair, struct motion at) {
    return force_at(pair, overlap_of(pair, at.q), at.u);
}

static void remember(struct pair *pair, double overlap, double closing) {
    struct scree_normal_force f = pair->law->force(pair->constants, pair->of_pair, press(pair, overlap, closing));
    pair->first = f.first;
    pair->second = f.second;
}

/* ---- one step ---- */

static struct motion rate(const struct pair *pair, struct motion at) {
    double pace = 4.0 * at.q * at.q * at.q;
    return (struct motion){at.u, pace * (pair->friction - force_on(pair, at)) / pair->mass, pace};
}

static struct motion ahead(struct motion at, double h, struct motion rate) {
    return (struct motion){at.q + h * rate.q, at.u + h * rate.u, at.t + h * rate.t};
}

/* Change over the step h, by the midpoint rule in `parts` parts (an even number) with Gragg's smoothing at the end: its
 * error has even powers of h/parts only, and it sees a kink of the law wherever in the step that is. */
static struct motion midpoint(const struct pair *pair, struct motion start, double h, int parts) {
    double part = h / parts;
    struct motion before = {0.0, 0.0, 0.0}, now = ahead(before, part, rate(pair, start));
    for (int k = 1; k < parts; k++) {
        struct motion next = ahead(before, 2.0 * part, rate(pair, ahead(start, 1.0, now)));
        before = now;
        now = next;
    }
    struct motion beyond = ahead(before, part, rate(pair, ahead(start, 1.0, now)));
    return (struct motion){0.5 * (now.q + beyond.q), 0.5 * (now.u + beyond.u), 0.5 * (now.t + beyond.t)};
}

/* The motion a step h later; `error` receives an estimate of the step's error, the last two extrapolations'
 * difference. */
static struct motion step(const struct pair *pair, struct motion at, double h, struct motion *error) {
    struct motion row[COLUMNS];
    for (int k = 0; k < COLUMNS; k++) {
        struct motion finer = midpoint(pair, at, h, 2 * (k + 1));
        for (int j = 1; j <= k; j++) { /* Aitken-Neville in the squares of the parts' lengths */
            double ratio = (double)(k + 1) / (double)(k + 1 - j);
            double weight = 1.0 / (ratio * ratio - 1.0);
            struct motion coarser = row[j - 1];
            row[j - 1] = finer;
            finer =
                ahead(finer, weight, (struct motion){finer.q - coarser.q, finer.u - coarser.u, finer.t - coarser.t});
        }
        row[k] = finer;
    }
    if (error) {
        struct motion last = row[COLUMNS - 1], other = row[COLUMNS - 2];
        *error = (struct motion){fabs(last.q - other.q), fabs(last.u - other.u), fabs(last.t - other.t)};
    }
    return ahead(at, 1.0, row[COLUMNS - 1]);
}

/* Speed that the bodies would have if the contact gave back at once what it can. */
static double size_of(const struct pair *pair, struct motion at) {
    double stored = pair->law->stored(pair->constants, pair->of_pair, press(pair, overlap_of(pair, at.q), at.u));
    return sqrt(at.u * at.u + 2.0 * fabs(stored) / pair->mass);
}

/* Take the longest step that is allowed; `*h` is what to try first, and receives what to try next. Returns its
 * length. */
static double advance(const struct pair *pair, struct motion *at, double *h) {
    double size = size_of(pair, *at), most = longest_step * pair->scale / size;
    for (double taken = fmin(*h, most);; taken *= 0.5) {
        struct motion error, next = step(pair, *at, taken, &error);
        double worst = fmax(error.u / (fabs(at->u) + fabs(next.u - at->u)), error.q / (fabs(at->q) + taken * size));
        worst = fmax(worst, error.t / (fabs(next.t) + 1e-300));
        if (!(worst <= allowed) && taken > 1e-14 * most) continue;
        *at = next;
        *h = worst < 0.01 * allowed ? 2.0 * taken : taken;
        return taken;
    }
}

/* ---- the phases of a contact ---- */

/* Positive while the present phase of the contact lasts: approach until the closing speed vanishes, then parting until
 * the force (of a law that never pulls) or the overlap does. */
static double phase_left(const struct pair *pair, struct motion at) {
    if (pair->approaching) return at.u;
    return pair->law->cut ? fmin(at.q, force_on(pair, at)) : at.q;
}

/* The motion at the end of the phase, which is in the step h from `at`: bisection on the step. */
static struct motion locate_end(const struct pair *pair, struct motion at, double h) {
    double low = 0.0, high = h;
    for (int k = 0; k < 60; k++) {
        double middle = 0.5 * (low + high);
        if (phase_left(pair, step(pair, at, middle, NULL)) > 0.0)
            low = middle;
        else
            high = middle;
    }
    return step(pair, at, high, NULL);
}

/* The largest force in a stretch h from `at` with one peak in it: golden section. */
static double peak_force(const struct pair *pair, struct motion at, double h) {
    const double golden = 0.61803398874989485;
    double low = 0.0, high = h, best = 0.0;
    for (int k = 0; k < 40; k++) {
        double left = high - golden * (high - low), right = low + golden * (high - low);
        double at_left = force_on(pair, step(pair, at, left, NULL));
        double at_right = force_on(pair, step(pair, at, right, NULL));
        best = fmax(best, fmax(at_left, at_right));
        if (at_left > at_right)
            high = right;
        else
            low = left;
    }
    return best;
}

/* ---- the start ---- */

/* Overlap at which the contact could give back the energy of the impact: the scale of the overlap. */
static double deepest_scale(const struct pair *pair, double speed) {
    double energy = 0.5 * pair->mass * speed * speed, deepest = 1e-12;
    while (pair->law->stored(pair->constants, pair->of_pair,
                             (struct scree_pressing){.overlap = deepest, .second = pair->second}) < energy &&
           deepest < 1e6)
        deepest *= 1.25;
    return deepest;
}

/* Overlap up to which friction holds the bodies. */
static double held_overlap(const struct pair *pair, double speed) {
    double low = 0.0, high = 1e-12, first = force_at(pair, 0.0, speed);
    if (pair->friction <= 0.0 || first >= pair->friction || first < 0.0) return 0.0;
    while (force_at(pair, high, speed) < pair->friction) high *= 2.0;
    for (int k = 0; k < 60; k++) {
        double middle = 0.5 * (low + high);
        if (force_at(pair, middle, speed) < pair->friction)
            low = middle;
        else
            high = middle;
    }
    return high;
}

/* ---- the whole impact ---- */

/* The steps so far, as far as the peak of the force is concerned: the start of the step before, and both lengths. */
struct trail {
    struct motion before, start;
    double length_before, force_before, force;
};

static void follow_peak(const struct pair *pair, struct trail *trail, struct motion at, double taken, double force,
                        struct scree_impact *result) {
    if (trail->length_before > 0.0 && trail->force > trail->force_before && trail->force > force)
        result->force = fmax(result->force, peak_force(pair, trail->before, trail->length_before + taken));
    result->force = fmax(result->force, force);
    *trail = (struct trail){trail->start, at, taken, trail->force, force};
}

/* The motion from first touch to the end; returns whether the bodies part. */
static int follow(struct pair *pair, struct motion *at, double speed, scree_impact_watch *watch, void *context,
                  struct scree_impact *result) {
    struct trail trail = {*at, *at, 0.0, 0.0, result->force};
    double h = 1e-3 * pair->scale / speed;
    for (long k = 0; k < MOST_STEPS; k++) {
        struct motion start = *at;
        double taken = advance(pair, at, &h);
        int over = !(phase_left(pair, *at) > 0.0);
        if (over) *at = locate_end(pair, start, taken);
        double overlap = overlap_of(pair, at->q), force = force_on(pair, *at);
        if (pair->approaching && !over) follow_peak(pair, &trail, *at, taken, force, result);
        result->force = fmax(result->force, force);
        result->deepest = fmax(result->deepest, overlap);
        remember(pair, overlap, at->u);
        if (watch) watch(context, at->t, overlap, at->u, force);
        if (over && !pair->approaching) return 1;
        if (!over && !pair->approaching && at->u >= 0.0) return 0; /* turned back before the end */
        if (!over && size_of(pair, *at) < 1e-22 * speed) return 0; /* creeps */
        if (over) pair->approaching = 0;
    }
    return 0;
}

struct scree_impact scree_impact(const struct scree_normal_law *law, const struct scree_law_constants *constants,
                                 struct scree_pair_constants of_pair, double mass, double speed, double friction,
                                 scree_impact_watch *watch, void *context) {
    struct pair pair = {law, constants, of_pair, mass, friction, 0.0, 1, 0.0, 0.0, 0.0};
    if (law->reach) pair.reach = law->reach(constants, of_pair);
    remember(&pair, 1e-300, speed); /* they touch */
    double held = held_overlap(&pair, speed);
    pair.scale = sqrt(sqrt(deepest_scale(&pair, speed) + pair.reach));
    struct motion at = {sqrt(sqrt(held + pair.reach)), speed, held / speed};
    struct scree_impact result = {.force = force_at(&pair, held, speed), .deepest = held};
    int part = follow(&pair, &at, speed, watch, context, &result);
    result.duration = at.t;
    result.restitution = part ? -at.u / speed : 0.0;
    return result;
}
