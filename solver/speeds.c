/* Operating speeds: what a profile does at another speed than its own, and the limits of the new motion. */
#include "solver/transport.h"

#include <math.h>

double scree_scaled_clearance(const scree_transport *transport, const scree_plan *design, double cycles) {
    double duration = scree_transport_time(transport, cycles), t3 = design->time[3] * (duration / design->duration);
    struct scree_profile scaled = scree_profile_scaled(&design->profile, duration);
    double left = scree_slide_detachment(&scaled, scree_transport_slowing(transport));
    return left < 0.0 || left > t3 ? HUGE_VAL : scree_slide_catch(transport, &scaled, left, t3).clearance;
}

void scree_plan_scaled(const scree_transport *transport, const scree_plan *design, double cycles, scree_plan *plan) {
    *plan = *design;
    plan->state = SCREE_PLAN_GOOD;
    plan->text[0] = '\0';
    plan->simulations = 0;
    plan->cycles = cycles;
    plan->duration = scree_transport_time(transport, cycles);
    plan->profile = scree_profile_scaled(&design->profile, plan->duration);
    double ratio = plan->duration / design->duration;
    for (int k = 0; k < 5; k++) {
        plan->time[k] *= ratio;
        plan->event[k].v /= ratio;
        plan->event[k].a /= ratio * ratio;
        plan->event[k].j /= ratio * ratio * ratio;
    }
    plan->extrema = scree_profile_extrema(&plan->profile);
    plan->detached = scree_slide_detachment(&plan->profile, scree_transport_slowing(transport));
    plan->detached_velocity = plan->detached < 0.0 ? 0.0 : scree_profile_at(&plan->profile, plan->detached).v;
    scree_plan_check(transport, plan);
}

/* ---- limits ---- */

double scree_limit_detachment(const scree_transport *transport, const scree_plan *design) {
    /* The comb's hardest braking between events 1 and 2 scales with the square of the speed. */
    struct scree_profile one = {0};
    scree_profile_append(&one, &design->profile.segment[1]);
    return design->cycles * sqrt(scree_transport_slowing(transport) / -scree_profile_extrema(&one).least.a);
}

/* v3/D4 - 0.6 mu g of formulation A, which grows with the speed. */
static double margin_low(const scree_transport *t, double cycles) {
    double v[3], duration = scree_transport_time(t, cycles);
    if (scree_plan_rigid(t, cycles, v)) return NAN;
    return v[2] / ((1.0 - t->fractions[2]) * duration) - 0.6 * scree_transport_slowing(t);
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
    double a = scree_extrema_acceleration(&plan.extrema), j = scree_extrema_jerk(&plan.extrema);
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

/* The last speed towards `side` at which the error stays within the tolerance: steps of 1/min, the last one
 * bisected. */
static double farthest(const scree_transport *t, const scree_plan *design, double restitution, double tolerance,
                       int side) {
    double good = design->cycles, bad = good;
    for (int k = 1; k < 2000; k++) {
        bad = design->cycles + side * k;
        if (bad <= 1.0 || !within(t, design, restitution, tolerance, bad)) break;
        good = bad;
    }
    for (int k = 0; k < 40; k++) {
        double middle = 0.5 * (good + bad);
        if (within(t, design, restitution, tolerance, middle))
            good = middle;
        else
            bad = middle;
    }
    return good;
}

void scree_limit_range(const scree_transport *transport, const scree_plan *design, double restitution, double tolerance,
                       double *least, double *most) {
    *least = farthest(transport, design, restitution, tolerance, -1);
    *most = farthest(transport, design, restitution, tolerance, 1);
}
