/* Linear spring and dashpot that never pulls; the contact ends where the force vanishes.
 *   F = max(0, k d + c u)
 *   e = exp(-2 zeta arccos(zeta)/sqrt(1 - zeta^2))   Schwager & Poeschel, Granular Matter 9 (2007) 465 */
#ifndef SCREE_CONTACT_NORMAL_LINEAR_CUT_H
#define SCREE_CONTACT_NORMAL_LINEAR_CUT_H

#include "contact/linear.h"

static SCREE_INLINE struct scree_normal_force normal_linear_cut_force(const struct scree_law_constants *law,
                                                                      struct scree_pair_constants pair,
                                                                      struct scree_pressing at) {
    double spring = law->c[LINEAR_STIFFNESS] * at.overlap;
    return (struct scree_normal_force){spring, pair.c[LINEAR_DAMPING], spring, 0.0, 0.0};
}

static inline scree_status normal_linear_cut_bake(const struct scree_values *values, struct scree_law_constants *law,
                                                  scree_trouble *trouble) {
    (void)trouble;
    double e = values->v[LINEAR_GIVEN_RESTITUTION];
    linear_bake(values, law, isnan(e) ? 0.0 : linear_invert(e, 2.0));
    return SCREE_OK;
}

static inline double normal_linear_cut_restitution(const struct scree_law_constants *law,
                                                   struct scree_pair_constants pair, double mass, double speed) {
    (void)speed;
    double zeta = linear_zeta(law, pair, mass);
    return exp(-2.0 * zeta * linear_angle(zeta));
}

static const struct scree_normal_law scree_normal_linear_cut = {
    .text = {.name = "linear-cut",
             .formula = "F = max(0, k d + c u)",
             .source = "Schwager & Poeschel, Granular Matter 9 (2007) 465",
             .note = "Never pulls. Restitution is the same at every speed: e = exp(-2 zeta "
                     "arccos(zeta)/sqrt(1-zeta^2)), "
                     "zeta = c/(2 sqrt(k m)); any 0 < e <= 1 can be had.",
             .example = "stiffness = 1e5, restitution = 0.5",
             .parameters = linear_parameters},
    .cut = 1,
    .turns_smoothly = 1,
    .bake = normal_linear_cut_bake,
    .pair = linear_pair,
    .force = normal_linear_cut_force,
    .stored = linear_stored,
    .restitution = normal_linear_cut_restitution,
};

#endif
