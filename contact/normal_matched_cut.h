/* A power-law spring with its matching dashpot that never pulls; the contact ends where the force vanishes.
 *   F = max(0, k d^p + alpha sqrt(m k) d^((p-1)/2) u)
 *   e = exp(-2 zeta arccos(zeta)/sqrt(1 - zeta^2)),  zeta = alpha/sqrt(2 (p + 1)), arcosh above zeta = 1
 * The law of Tsuji, Tanaka & Ishida, Powder Technol. 71 (1992) 239, for any exponent (contact/matched.h). */
#ifndef SCREE_CONTACT_NORMAL_MATCHED_CUT_H
#define SCREE_CONTACT_NORMAL_MATCHED_CUT_H

#include "contact/matched.h"

static inline scree_status normal_matched_cut_bake(const struct scree_values *values, struct scree_law_constants *law,
                                                   scree_trouble *trouble) {
    (void)trouble;
    double e = values->v[MATCHED_GIVEN_RESTITUTION];
    matched_bake(values, law, isnan(e) ? 0.0 : linear_invert(e, 2.0));
    return SCREE_OK;
}

static SCREE_INLINE struct scree_normal_force normal_matched_cut_force(const struct scree_law_constants *law,
                                                                       struct scree_pair_constants pair,
                                                                       struct scree_pressing at) {
    return matched_force(law, pair, at);
}

static inline double normal_matched_cut_restitution(const struct scree_law_constants *law,
                                                    struct scree_pair_constants pair, double mass, double speed) {
    (void)pair;
    (void)mass;
    (void)speed;
    return exp(-2.0 * law->c[MATCHED_ZETA] * linear_angle(law->c[MATCHED_ZETA]));
}

static const struct scree_normal_law scree_normal_matched_cut = {
    .text = {.name = "matched-cut",
             .formula = "F = max(0, k d^p + alpha sqrt(m k) d^((p-1)/2) u)",
             .source = "Tsuji, Tanaka & Ishida, Powder Technol. 71 (1992) 239, for any exponent",
             .note = "Never pulls. Restitution is the same at every speed: e = exp(-2 zeta "
                     "arccos(zeta)/sqrt(1-zeta^2)), zeta = alpha/sqrt(2 (p+1)); any 0 < e <= 1 can be had.",
             .parameters = matched_parameters,
             .example = "stiffness = 1e7, exponent = 2.0, restitution = 0.5"},
    .cut = 1,
    .root = 4,
    .turns_smoothly = 1,
    .raises = 1,
    .bake = normal_matched_cut_bake,
    .pair = matched_pair,
    .force = normal_matched_cut_force,
    .stored = matched_stored,
    .restitution = normal_matched_cut_restitution,
};

#endif
