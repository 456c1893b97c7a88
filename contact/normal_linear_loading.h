/* Linear spring with a dashpot that acts while the bodies approach, and not while they part.
 *   F = k d + c max(u, 0)
 *   e = exp(-zeta arccos(zeta)/sqrt(1 - zeta^2))
 * The dashpot sees the first half of the contact only: half of the exponent of the law that is cut at zero force (Troll
 * et al., Adv. Mech. Eng. 2018, doi 10.1177/1687814018754953). */
#ifndef SCREE_CONTACT_NORMAL_LINEAR_LOADING_H
#define SCREE_CONTACT_NORMAL_LINEAR_LOADING_H

#include "contact/linear.h"

static SCREE_INLINE struct scree_normal_force normal_linear_loading_force(const struct scree_law_constants *law,
                                                                          struct scree_pair_constants pair,
                                                                          struct scree_pressing at) {
    double spring = law->c[LINEAR_STIFFNESS] * at.overlap;
    double approaching = at.closing > 0.0 ? 1.0 : 0.0;
    return (struct scree_normal_force){spring, approaching * pair.c[LINEAR_DAMPING], spring, 0.0, 0.0};
}

static inline scree_status normal_linear_loading_bake(const struct scree_values *values,
                                                      struct scree_law_constants *law, scree_trouble *trouble) {
    (void)trouble;
    double e = values->v[LINEAR_GIVEN_RESTITUTION];
    linear_bake(values, law, isnan(e) ? 0.0 : linear_invert(e, 1.0));
    return SCREE_OK;
}

static inline double normal_linear_loading_restitution(const struct scree_law_constants *law,
                                                       struct scree_pair_constants pair, double mass, double speed) {
    (void)speed;
    double zeta = linear_zeta(law, pair, mass);
    return exp(-zeta * linear_angle(zeta));
}

static const struct scree_normal_law scree_normal_linear_loading = {
    .text = {.name = "linear-loading",
             .formula = "F = k d + c max(u, 0)",
             .source = "Troll et al., Adv. Mech. Eng. (2018), doi 10.1177/1687814018754953",
             .note = "Damped while approaching only; never pulls. Restitution is the same at every speed: "
                     "e = exp(-zeta arccos(zeta)/sqrt(1-zeta^2)) below zeta = c/(2 sqrt(k m)) = 1, arcosh above; any "
                     "0 < e <= 1 can be had.",
             .example = "stiffness = 1e5, restitution = 0.5",
             .parameters = linear_parameters},
    .cut = 0,
    .bake = normal_linear_loading_bake,
    .pair = linear_pair,
    .force = normal_linear_loading_force,
    .stored = linear_stored,
    .restitution = normal_linear_loading_restitution,
};

#endif
