/* Viscoelastic spheres that never pull; the contact ends where the force vanishes.
 *   F = max(0, K (d^(3/2) + (3/2) A d^(1/2) u))
 * Kuwabara & Kono, Jpn. J. Appl. Phys. 26 (1987) 1230; Brilliantov, Spahn, Hertzsch & Poeschel, Phys. Rev. E 53 (1996)
 * 5382. Restitution falls with impact speed (Schwager & Poeschel, Phys. Rev. E 78 (2008) 051304): a function of b =
 * (3/2) A (K/m)^(2/5) v^(1/5), e = 1 - 1.15345 b + 0.79827 b^2 + ..., without closed form. */
#ifndef SCREE_CONTACT_NORMAL_KUWABARA_KONO_CUT_H
#define SCREE_CONTACT_NORMAL_KUWABARA_KONO_CUT_H

#include "contact/kuwabara.h"

static inline scree_status normal_kuwabara_kono_cut_bake(const struct scree_values *values,
                                                         struct scree_law_constants *law, scree_trouble *trouble) {
    return kuwabara_bake(values, law, 1, trouble);
}

static SCREE_INLINE struct scree_normal_force normal_kuwabara_kono_cut_force(const struct scree_law_constants *law,
                                                                             struct scree_pair_constants pair,
                                                                             struct scree_pressing at) {
    return kuwabara_force(law, pair, at);
}

static const struct scree_normal_law scree_normal_kuwabara_kono_cut = {
    .text = {.name = "kuwabara-kono-cut",
             .formula = "F = max(0, K (d^(3/2) + (3/2) A d^(1/2) u)), K = (4/3) E* sqrt(R*)",
             .source =
                 "Kuwabara & Kono, Jpn. J. Appl. Phys. 26 (1987) 1230; Brilliantov et al., Phys. Rev. E 53 (1996) 5382",
             .note = "Never pulls (Schwager & Poeschel, Phys. Rev. E 78 (2008) 051304). Restitution falls with "
                     "impact speed: e = 1 - 1.15345 b + 0.79827 b^2 + ..., b = (3/2) A (K/m)^(2/5) v^(1/5); it "
                     "has no closed form, and a restitution asked for is found by integration.",
             .parameters = kuwabara_parameters,
             .example = "stiffness = 5e6, restitution = 0.5, speed = 1.0"},
    .cut = 1,
    .root = 2,
    .turns_smoothly = 1,
    .bake = normal_kuwabara_kono_cut_bake,
    .pair = kuwabara_pair,
    .force = normal_kuwabara_kono_cut_force,
    .stored = hertz_stored,
};

#endif
