/* Linear spring and dashpot that may pull; the contact ends at zero overlap.
 *   F = k d + c u            Cundall & Strack, Geotechnique 29 (1979) 47
 *   e = exp(-pi zeta/sqrt(1 - zeta^2)),  zeta = c/(2 sqrt(k m)) */
#ifndef SCREE_CONTACT_NORMAL_LINEAR_H
#define SCREE_CONTACT_NORMAL_LINEAR_H

#include "contact/linear.h"

static SCREE_INLINE struct scree_normal_force
normal_linear_force(const struct scree_law_constants *law, struct scree_pair_constants pair, struct scree_pressing at) {
    double spring = law->c[LINEAR_STIFFNESS] * at.overlap;
    return (struct scree_normal_force){spring, pair.c[LINEAR_DAMPING], spring, 0.0, 0.0};
}

static inline scree_status normal_linear_bake(const struct scree_values *values, struct scree_law_constants *law,
                                              scree_trouble *trouble) {
    (void)trouble;
    linear_bake(values, law, linear_zeta_pulling(values->v[LINEAR_GIVEN_RESTITUTION]));
    return SCREE_OK;
}

static inline double normal_linear_restitution(const struct scree_law_constants *law, struct scree_pair_constants pair,
                                               double mass, double speed) {
    (void)speed;
    return linear_e_pulling(linear_zeta(law, pair, mass));
}

static const struct scree_normal_law scree_normal_linear = {
    .text = {.name = "linear",
             .formula = "F = k d + c u while d > 0 (may pull)",
             .source = "Cundall & Strack, Geotechnique 29 (1979) 47",
             .note = "Restitution is the same at every speed: e = exp(-pi zeta/sqrt(1-zeta^2)), zeta = c/(2 "
                     "sqrt(k m)). "
                     "Near the end of a contact the force pulls.",
             .example = "stiffness = 1e5, restitution = 0.5",
             .parameters = linear_parameters},
    .cut = 0,
    .turns_smoothly = 1,
    .bake = normal_linear_bake,
    .pair = linear_pair,
    .force = normal_linear_force,
    .stored = linear_stored,
    .restitution = normal_linear_restitution,
};

#endif
