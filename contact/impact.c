/* Two bodies meet head-on: classical Runge-Kutta steps, with the turning point and the end located inside the step. */
#include "contact/impact.h"

#include <stddef.h>

/* What is integrated: the uncut law, so that the right-hand side is smooth up to the end of the contact. */
struct pair {
    const struct scree_normal_law *law;
    const struct scree_law_constants *constants;
    struct scree_pair_constants of_pair;
    double mass, friction;
    int approaching; /* the branch of a law that tells approach from parting */
};

struct motion {
    double overlap, closing;
};

static double force_on(const struct pair *pair, struct motion at) {
    /* At the turning point rounding must not pick the other branch. */
    double closing = pair->approaching ? fmax(at.closing, 1e-300) : fmin(at.closing, -1e-300);
    struct scree_normal_force f =
        pair->law->force(pair->constants, pair->of_pair, (struct scree_pressing){at.overlap, closing, 0.0, 0.0});
    return f.elastic + f.damping * at.closing;
}

static struct motion rate(const struct pair *pair, struct motion at) {
    return (struct motion){at.closing, (pair->friction - force_on(pair, at)) / pair->mass};
}

static struct motion ahead(struct motion at, double h, struct motion rate) {
    return (struct motion){at.overlap + h * rate.overlap, at.closing + h * rate.closing};
}

static struct motion step(const struct pair *pair, struct motion at, double h) {
    struct motion a = rate(pair, at), b = rate(pair, ahead(at, 0.5 * h, a));
    struct motion c = rate(pair, ahead(at, 0.5 * h, b)), d = rate(pair, ahead(at, h, c));
    return (struct motion){at.overlap + h / 6.0 * (a.overlap + 2.0 * (b.overlap + c.overlap) + d.overlap),
                           at.closing + h / 6.0 * (a.closing + 2.0 * (b.closing + c.closing) + d.closing)};
}

/* Positive while the present phase of the contact lasts: approach until the closing speed vanishes, then parting until
 * the force (of a law that never pulls) or the overlap does. */
static double phase_left(const struct pair *pair, struct motion at) {
    if (pair->approaching) return at.closing;
    return pair->law->cut ? fmin(at.overlap, force_on(pair, at)) : at.overlap;
}

/* Length of the step from `at` after which the phase is just over: bisection on the step. */
static double locate_end(const struct pair *pair, struct motion at, double h) {
    double low = 0.0, high = h;
    for (int k = 0; k < 60; k++) {
        double middle = 0.5 * (low + high);
        if (phase_left(pair, step(pair, at, middle)) > 0.0)
            low = middle;
        else
            high = middle;
    }
    return high;
}

/* Time in which the elastic energy would stop the approach: the scale of the spring. */
static double spring_time(const struct pair *pair, double speed) {
    double energy = 0.5 * pair->mass * speed * speed, deepest = 1e-12;
    while (pair->law->stored(pair->constants, pair->of_pair, (struct scree_pressing){.overlap = deepest}) < energy &&
           deepest < 1e6)
        deepest *= 1.25;
    return deepest / speed;
}

/* A four-thousandth of the shorter of the times in which spring and dashpot change the motion here. */
static double step_length(const struct pair *pair, struct motion at, double spring) {
    double closing = pair->approaching ? 1e-300 : -1e-300;
    double damping =
        pair->law->force(pair->constants, pair->of_pair, (struct scree_pressing){at.overlap, closing, 0.0, 0.0})
            .damping;
    return fmin(spring, pair->mass / (damping + 1e-300)) / 4000.0;
}

/* Overlap up to which friction holds the bodies. */
static double held_overlap(const struct pair *pair, double speed) {
    double low = 0.0, high = 1e-12;
    if (force_on(pair, (struct motion){0.0, speed}) >= pair->friction) return 0.0;
    while (force_on(pair, (struct motion){high, speed}) < pair->friction) high *= 2.0;
    for (int k = 0; k < 60; k++) {
        double middle = 0.5 * (low + high);
        if (force_on(pair, (struct motion){middle, speed}) < pair->friction)
            low = middle;
        else
            high = middle;
    }
    return high;
}

struct scree_impact scree_impact(const struct scree_normal_law *law, const struct scree_law_constants *constants,
                                 struct scree_pair_constants of_pair, double mass, double speed, double friction,
                                 scree_impact_watch *watch, void *context) {
    struct pair pair = {law, constants, of_pair, mass, friction, 1};
    struct motion at = {held_overlap(&pair, speed), speed};
    struct scree_impact result = {.duration = at.overlap / speed, .force = force_on(&pair, at)};
    double spring = spring_time(&pair, speed);
    for (long k = 0; k < 4000000; k++) {
        double h = step_length(&pair, at, spring);
        struct motion next = step(&pair, at, h);
        double taken = h;
        int over = !(phase_left(&pair, next) > 0.0);
        if (over) {
            taken = locate_end(&pair, at, h);
            next = step(&pair, at, taken);
        }
        at = next;
        result.duration += taken;
        result.force = fmax(result.force, force_on(&pair, at));
        result.deepest = fmax(result.deepest, at.overlap);
        if (watch) watch(context, result.duration, at.overlap, at.closing, force_on(&pair, at));
        if (over && !pair.approaching) {
            result.restitution = -at.closing / speed;
            return result;
        }
        if (over) pair.approaching = 0;
    }
    return result;
}
