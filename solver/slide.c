/* A rigid product between the rigid tines of a comb that moves forward: pushed, sliding freely, caught, bouncing.
 * Between events all motions are polynomials, so events are found as roots, without time steps. */
#include "solver/transport.h"

#include <math.h>
#include <string.h>

enum { TERMS = SCREE_SEGMENT_TERMS };

/* First tau in [from, to) after which the polynomial is negative; HUGE_VAL if it nowhere is. */
static double turns_negative(const double q[TERMS], double from, double to) {
    double roots[TERMS], left = from;
    int found = scree_polynomial_roots(TERMS - 1, q, from, to, roots);
    for (int k = 0; k <= found; k++) {
        double right = k < found ? roots[k] : to;
        if (scree_polynomial(TERMS - 1, q, 0.5 * (left + right)) < 0.0) return left;
        left = right;
    }
    return HUGE_VAL;
}

/* Taylor terms of the comb's position from `time` on, and how long they hold (s). */
static double comb_terms(const struct scree_profile *profile, double time, double terms[TERMS]) {
    double end = profile->start[profile->count];
    if (time >= end) {
        memset(terms, 0, TERMS * sizeof *terms);
        terms[0] = scree_profile_at(profile, end).x;
        return HUGE_VAL;
    }
    int k = scree_profile_segment(profile, time);
    scree_segment_taylor(&profile->segment[k], fmax(time - profile->start[k], 0.0), terms);
    return profile->start[k + 1] - time;
}

/* First time, not before `from`, after which sign (a + deceleration) < 0 for the comb's acceleration a; -1 if never. */
static double crosses(const struct scree_profile *profile, double deceleration, double sign, double from) {
    double terms[TERMS], time = from;
    while (time < profile->start[profile->count]) {
        double hold = comb_terms(profile, time, terms), next = profile->start[scree_profile_segment(profile, time) + 1];
        double q[TERMS] = {sign * (2.0 * terms[2] + deceleration)};
        for (int k = 1; k < TERMS - 2; k++) q[k] = sign * (k + 1) * (k + 2) * terms[k + 2];
        /* Where a segment starts with just that deceleration, it is what follows that counts; at its very end, the next
         * one. */
        double near = 1e-6 * hold, tau = turns_negative(q, near, hold);
        if (tau < HUGE_VAL) return tau <= near ? time : tau >= hold - near ? next : time + tau;
        time = next;
    }
    return -1.0;
}

double scree_slide_detachment(const struct scree_profile *profile, double deceleration) {
    return crosses(profile, deceleration, 1.0, profile->start[0]);
}

double scree_slide_release(const struct scree_profile *profile, double deceleration, double from) {
    return crosses(profile, deceleration, -1.0, from);
}

scree_catch scree_slide_catch(const scree_transport *transport, const struct scree_profile *profile, double left,
                              double until) {
    double mu_g = scree_transport_slowing(transport), slide = until - left;
    struct scree_kinematics from = scree_profile_at(profile, left);
    double x = from.x + from.v * slide - 0.5 * mu_g * slide * slide;
    return (scree_catch){.clearance = scree_transport_play(transport) - (x - scree_profile_at(profile, until).x),
                         .velocity = from.v - mu_g * slide,
                         .acceleration = -mu_g};
}

/* ---- the events ---- */

enum where { PUSHED, FREE, CAUGHT };

struct slider {
    const struct scree_profile *profile;
    double mu_g, play, restitution;
    enum where where;
    double time, x, v; /* now */
    int touching,
        zeros; /* FREE: at the rear (-1) or front tines (1), and how many Taylor terms of the distance vanish there */
    scree_slide *result;
};

/* Taylor terms of the product's position, and how long they hold: friction acts until it rests. */
static double product_terms(const struct slider *s, double terms[TERMS]) {
    double sign = s->v < 0.0 ? -1.0 : 1.0;
    memset(terms, 0, TERMS * sizeof *terms);
    terms[0] = s->x;
    terms[1] = s->v;
    if (s->v == 0.0) return HUGE_VAL;
    terms[2] = -0.5 * sign * s->mu_g;
    return fabs(s->v) / s->mu_g;
}

/* How far the product is inside of the rear (side -1) or front tines (1), in Taylor terms; `slack` is added. */
static void distance_terms(const struct slider *s, int side, const double product[TERMS], const double comb[TERMS],
                           double slack, double q[TERMS]) {
    for (int k = 0; k < TERMS; k++) q[k] = side < 0 ? product[k] - comb[k] : comb[k] - product[k];
    q[0] += slack + (side > 0 ? s->play : 0.0);
}

/* When within `hold` the free product meets the tines of a side; HUGE_VAL if it doesn't. Where it touches them now, the
 * terms that vanish are divided out, so that rounding can't make a contact. */
static double meets(const struct slider *s, int side, const double product[TERMS], const double comb[TERMS],
                    double slack, double hold) {
    double q[TERMS], from = 0.0;
    distance_terms(s, side, product, comb, slack, q);
    if (s->touching == side) {
        memmove(q, q + s->zeros, (size_t)(TERMS - s->zeros) * sizeof *q);
        memset(q + TERMS - s->zeros, 0, (size_t)s->zeros * sizeof *q);
        from = fmin(1e-9 * scree_profile_duration(s->profile), 0.5 * hold);
    }
    return turns_negative(q, from, hold);
}

/* Go on by tau without a contact. */
static void coast(struct slider *s, const double product[TERMS], double tau) {
    s->x = scree_polynomial(TERMS - 1, product, tau);
    s->v += 2.0 * product[2] * tau;
    s->time += tau;
    s->touching = s->zeros = 0;
}

/* Leave the tines of a side with the comb's velocity and `after` (m/s) more. */
static void set_free(struct slider *s, int side, double after) {
    struct scree_kinematics comb = scree_profile_at(s->profile, s->time);
    s->where = FREE;
    s->touching = side;
    s->x = comb.x + (side > 0 ? s->play : 0.0);
    s->v = comb.v + after;
    s->zeros = after != 0.0 ? 1 : fabs(comb.a + s->mu_g) <= 1e-9 * s->mu_g ? 3 : 2;
}

/* The free product has met the tines of a side: it bounces, or stays if it is slow and they press against it. */
static void meet(struct slider *s, int side) {
    struct scree_kinematics comb = scree_profile_at(s->profile, s->time);
    double relative = side > 0 ? fmax(s->v - comb.v, 0.0) : fmin(s->v - comb.v, 0.0);
    double after = -s->restitution * relative;
    s->result->impacts++;
    if (side > 0 && s->result->first_contact == 0.0) s->result->first_contact = relative;
    /* Slower than what friction stops within a millionth of the motion. */
    int slow = fabs(after) < 1e-6 * s->mu_g * scree_profile_duration(s->profile);
    int rests = s->time >= s->profile->start[s->profile->count];
    int presses = rests || (side > 0 ? comb.a <= -s->mu_g : comb.a >= -s->mu_g);
    if (slow && presses)
        s->where = side > 0 ? CAUGHT : PUSHED;
    else
        set_free(s, side, slow ? 0.0 : after);
}

/* One event of the free product. Returns 1 when it rests for good. */
static int slide_on(struct slider *s) {
    double comb[TERMS], product[TERMS];
    double holds = comb_terms(s->profile, s->time, comb), rests = product_terms(s, product);
    double hold = fmin(holds, rests);
    if (hold == HUGE_VAL) return 1;
    double rear = meets(s, -1, product, comb, 0.0, hold), front = meets(s, 1, product, comb, 0.0, hold);
    double tau = fmin(rear, front);
    if (tau < HUGE_VAL) {
        coast(s, product, tau);
        meet(s, rear < front ? -1 : 1);
        return 0;
    }
    int k = scree_profile_segment(s->profile, s->time);
    coast(s, product, hold);
    if (rests <= holds) s->v = 0.0;
    if (holds <= rests) s->time = s->profile->start[k + 1];
    return 0;
}

/* The product at the tines until it leaves them. Returns 1 if it never does. */
static int ride_on(struct slider *s) {
    double leaves = crosses(s->profile, s->mu_g, s->where == PUSHED ? 1.0 : -1.0, s->time);
    if (leaves < 0.0) {
        s->x =
            scree_profile_at(s->profile, s->profile->start[s->profile->count]).x + (s->where == CAUGHT ? s->play : 0.0);
        return 1;
    }
    s->result->detached |= s->where == PUSHED;
    s->time = leaves;
    set_free(s, s->where == CAUGHT ? 1 : -1, 0.0);
    return 0;
}

scree_slide scree_slide_from(const scree_transport *transport, const struct scree_profile *profile, double restitution,
                             double lead) {
    enum { EVENTS = 20000 }; /* more only with a restitution of nearly 1, which bounces without end */
    scree_slide result = {0};
    struct slider s = {.profile = profile,
                       .mu_g = scree_transport_slowing(transport),
                       .play = scree_transport_play(transport),
                       .restitution = restitution,
                       .where = lead > 0.0 ? FREE : PUSHED,
                       .time = profile->start[0],
                       .x = scree_profile_at(profile, profile->start[0]).x + lead,
                       .result = &result};
    int done = 0;
    for (int k = 0; k < EVENTS && !done; k++) done = s.where == FREE ? slide_on(&s) : ride_on(&s);
    result.unfinished = !done;
    result.error = s.x - transport->distance;
    return result;
}

scree_slide scree_slide_simulate(const scree_transport *transport, const struct scree_profile *profile,
                                 double restitution) {
    return scree_slide_from(transport, profile, restitution, 0.0);
}

double scree_slide_leaves(const scree_transport *transport, const struct scree_profile *profile, double left,
                          double until, double slack) {
    double comb[TERMS], product[TERMS];
    struct scree_kinematics from = scree_profile_at(profile, left);
    struct slider s = {.profile = profile,
                       .mu_g = scree_transport_slowing(transport),
                       .play = scree_transport_play(transport),
                       .where = FREE,
                       .time = left,
                       .x = from.x,
                       .v = from.v};
    while (s.time < until) {
        int k = scree_profile_segment(profile, s.time);
        double holds = comb_terms(profile, s.time, comb), rests = product_terms(&s, product);
        double hold = fmin(fmin(holds, rests), until - s.time);
        double tau = fmin(meets(&s, -1, product, comb, slack, hold), meets(&s, 1, product, comb, slack, hold));
        if (tau < HUGE_VAL) return s.time + tau;
        coast(&s, product, hold);
        if (hold == rests) s.v = 0.0;
        if (hold == holds) s.time = profile->start[k + 1];
    }
    return -1.0;
}
