/* Time shares of a plan's events that cost least. */
#include "solver/transport.h"

#include <math.h>
#include <string.h>

struct search {
    scree_transport *transport;
    const scree_plan_options *options;
    enum scree_shares_rule rule;
    scree_plan_cost *cost;
    void *context;
    double cycles;
};

static double cost_of(const struct search *search, const double f[3], scree_plan *plan) {
    memcpy(search->transport->fractions, f, sizeof search->transport->fractions);
    scree_plan_make(search->transport, search->cycles, search->options, plan);
    if (plan->state != SCREE_PLAN_GOOD) return HUGE_VAL;
    if (search->cost) return search->cost(search->context, plan);
    return search->rule == SCREE_LEAST_JERK ? scree_extrema_jerk(&plan->extrema)
                                            : scree_extrema_acceleration(&plan->extrema);
}

/* A corner of the simplex: time shares and what they cost. */
struct corner {
    double f[3], cost;
};

struct simplex {
    struct corner corner[4];
};

/* The best first. */
static void order(struct simplex *s) {
    for (int i = 1; i < 4; i++)
        for (int k = i; k > 0 && s->corner[k].cost < s->corner[k - 1].cost; k--) {
            struct corner better = s->corner[k];
            s->corner[k] = s->corner[k - 1];
            s->corner[k - 1] = better;
        }
}

/* centre + factor (centre - worst) */
static struct corner mirror(const struct search *search, const struct simplex *s, double factor, scree_plan *plan) {
    struct corner to;
    for (int k = 0; k < 3; k++) {
        double centre = (s->corner[0].f[k] + s->corner[1].f[k] + s->corner[2].f[k]) / 3.0;
        to.f[k] = centre + factor * (centre - s->corner[3].f[k]);
    }
    to.cost = cost_of(search, to.f, plan);
    return to;
}

/* Draw all corners halfway to the best one. */
static void shrink(const struct search *search, struct simplex *s, scree_plan *plan) {
    for (int p = 1; p < 4; p++) {
        for (int k = 0; k < 3; k++) s->corner[p].f[k] = 0.5 * (s->corner[0].f[k] + s->corner[p].f[k]);
        s->corner[p].cost = cost_of(search, s->corner[p].f, plan);
    }
}

/* One step of Nelder & Mead's search (Computer Journal 7 (1965) 308) on an ordered simplex. */
static void improve(const struct search *search, struct simplex *s, scree_plan *plan) {
    struct corner *worst = &s->corner[3], mirrored = mirror(search, s, 1.0, plan);
    if (mirrored.cost < s->corner[0].cost) {
        struct corner expanded = mirror(search, s, 2.0, plan);
        *worst = expanded.cost < mirrored.cost ? expanded : mirrored;
    } else if (mirrored.cost < s->corner[2].cost) {
        *worst = mirrored;
    } else {
        struct corner contracted = mirror(search, s, mirrored.cost < worst->cost ? 0.5 : -0.5, plan);
        if (contracted.cost < fmin(mirrored.cost, worst->cost))
            *worst = contracted;
        else
            shrink(search, s, plan);
    }
}

void scree_plan_shares(scree_transport *transport, double cycles, const scree_plan_options *options,
                       enum scree_shares_rule rule, scree_plan_cost *cost, void *context, scree_plan *plan) {
    struct search search = {transport, options, rule, cost, context, cycles};
    struct simplex simplex;
    if (rule == SCREE_LEAST_CATCH && !cost) {
        *plan = (scree_plan){.state = SCREE_PLAN_BAD_TASK, .text = "what a catch costs must be told"};
        return;
    }
    double start[3];
    memcpy(start, transport->fractions, sizeof start);
    for (int p = 0; p < 4; p++) {
        struct corner *corner = &simplex.corner[p];
        memcpy(corner->f, start, sizeof corner->f);
        if (p > 0) corner->f[p - 1] += 0.03;
        corner->cost = cost_of(&search, corner->f, plan);
    }
    int most = cost ? 80 : 600; /* a simulation costs more than a formula */
    for (int step = 0; step < most; step++) {
        order(&simplex);
        double best = simplex.corner[0].cost, worst = simplex.corner[3].cost;
        if (worst < HUGE_VAL && worst - best <= 1e-10 * best) break;
        improve(&search, &simplex, plan);
    }
    order(&simplex);
    cost_of(&search, simplex.corner[0].f, plan);
}
