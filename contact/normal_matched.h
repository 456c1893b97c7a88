/* A power-law spring with its matching dashpot; the force may pull, and the contact ends at zero overlap.
 *   F = k d^p + alpha sqrt(m k) d^((p-1)/2) u
 *   e = exp(-pi zeta/sqrt(1 - zeta^2)),  zeta = alpha/sqrt(2 (p + 1))
 * The law of Tsuji, Tanaka & Ishida, Powder Technol. 71 (1992) 239, for any exponent (contact/matched.h). */
#ifndef SCREE_CONTACT_NORMAL_MATCHED_H
#define SCREE_CONTACT_NORMAL_MATCHED_H

#include "contact/matched.h"

static inline scree_status normal_matched_bake(const struct scree_values *values, struct scree_law_constants *law,
                                               scree_trouble *trouble) {
    (void)trouble;
    matched_bake(values, law, linear_zeta_pulling(values->v[MATCHED_GIVEN_RESTITUTION]));
    return SCREE_OK;
}

static SCREE_INLINE struct scree_normal_force normal_matched_force(const struct scree_law_constants *law,
                                                                   struct scree_pair_constants pair,
                                                                   struct scree_pressing at) {
    return matched_force(law, pair, at);
}

static inline double normal_matched_restitution(const struct scree_law_constants *law, struct scree_pair_constants pair,
                                                double mass, double speed) {
    (void)pair;
    (void)mass;
    (void)speed;
    return linear_e_pulling(law->c[MATCHED_ZETA]);
}

static const struct scree_normal_law scree_normal_matched = {
    .text = {.name = "matched",
             .formula = "F = k d^p + alpha sqrt(m k) d^((p-1)/2) u while d > 0 (may pull)",
             .source = "Tsuji, Tanaka & Ishida, Powder Technol. 71 (1992) 239, for any exponent",
             .note = "Restitution is the same at every speed: e = exp(-pi zeta/sqrt(1-zeta^2)), zeta = alpha/sqrt(2 "
                     "(p+1)). Near the end of a contact the force pulls.",
             .parameters = matched_parameters,
             .example = "stiffness = 5e6, exponent = 1.5, restitution = 0.5"},
    .cut = 0,
    .root = 4,
    .turns_smoothly = 1,
    .raises = 1,
    .bake = normal_matched_bake,
    .pair = matched_pair,
    .force = normal_matched_force,
    .stored = matched_stored,
    .restitution = normal_matched_restitution,
};

#endif
