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

struct simplex {
    double point[4][3], cost[4];
};

/* The best first. */
static void order(struct simplex *s) {
    for (int i = 1; i < 4; i++)
        for (int k = i; k > 0 && s->cost[k] < s->cost[k - 1]; k--) {
            double cost = s->cost[k], point[3];
            s->cost[k] = s->cost[k - 1];
            s->cost[k - 1] = cost;
            memcpy(point, s->point[k], sizeof point);
            memcpy(s->point[k], s->point[k - 1], sizeof point);
            memcpy(s->point[k - 1], point, sizeof point);
        }
}

/* centre + factor (centre - worst), and its cost */
static double mirror(const struct search *search, const struct simplex *s, double factor, double to[3],
                     scree_plan *plan) {
    for (int k = 0; k < 3; k++) {
        double centre = (s->point[0][k] + s->point[1][k] + s->point[2][k]) / 3.0;
        to[k] = centre + factor * (centre - s->point[3][k]);
    }
    return cost_of(search, to, plan);
}

static void replace_worst(struct simplex *s, const double point[3], double cost) {
    memcpy(s->point[3], point, sizeof s->point[3]);
    s->cost[3] = cost;
}

/* Draw all points halfway to the best one. */
static void shrink(const struct search *search, struct simplex *s, scree_plan *plan) {
    for (int p = 1; p < 4; p++) {
        for (int k = 0; k < 3; k++) s->point[p][k] = 0.5 * (s->point[0][k] + s->point[p][k]);
        s->cost[p] = cost_of(search, s->point[p], plan);
    }
}

/* One step of Nelder & Mead's search (Computer Journal 7 (1965) 308) on an ordered simplex. */
static void improve(const struct search *search, struct simplex *s, scree_plan *plan) {
    double trial[3], other[3], mirrored = mirror(search, s, 1.0, trial, plan);
    if (mirrored < s->cost[0]) {
        double expanded = mirror(search, s, 2.0, other, plan);
        replace_worst(s, expanded < mirrored ? other : trial, fmin(expanded, mirrored));
    } else if (mirrored < s->cost[2]) {
        replace_worst(s, trial, mirrored);
    } else {
        double contracted = mirror(search, s, mirrored < s->cost[3] ? 0.5 : -0.5, other, plan);
        if (contracted < fmin(mirrored, s->cost[3]))
            replace_worst(s, other, contracted);
        else
            shrink(search, s, plan);
    }
}

void scree_plan_shares(scree_transport *transport, double cycles, const scree_plan_options *options,
                       enum scree_shares_rule rule, scree_plan_cost *cost, void *context, scree_plan *plan) {
    struct search search = {transport, options, rule, cost, context, cycles};
    struct simplex simplex;
    for (int p = 0; p < 4; p++) {
        memcpy(simplex.point[p], transport->fractions, sizeof simplex.point[p]);
        if (p > 0) simplex.point[p][p - 1] += 0.03;
        simplex.cost[p] = cost_of(&search, simplex.point[p], plan);
    }
    int most = cost ? 80 : 600; /* a simulation costs more than a formula */
    for (int step = 0; step < most; step++) {
        order(&simplex);
        if (simplex.cost[3] < HUGE_VAL && simplex.cost[3] - simplex.cost[0] <= 1e-10 * simplex.cost[0]) break;
        improve(&search, &simplex, plan);
    }
    order(&simplex);
    cost_of(&search, simplex.point[0], plan);
}
