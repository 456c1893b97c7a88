/* Hysteretic spring, stiffer while it unloads.
 *   F = K1 d while loading;  F = max(0, K1 D - K2 (D - d)) while unloading from the largest overlap D
 * Walton & Braun, J. Rheol. 30 (1986) 949. A free impact ends where the force vanishes, at d0 = D (1 - K1/K2); e =
 * sqrt(K1/K2). */
#ifndef SCREE_CONTACT_NORMAL_WALTON_BRAUN_H
#define SCREE_CONTACT_NORMAL_WALTON_BRAUN_H

#include "contact/walton.h"

enum { WALTON_BRAUN_STIFFNESS, WALTON_BRAUN_RESTITUTION, WALTON_BRAUN_UNLOADING };

static const struct scree_parameter walton_parameters[] = {{.name = "stiffness",
                                                            .unit = "N/m",
                                                            .meaning = "stiffness K1 while loading",
                                                            .range = SCREE_ANY_POSITIVE,
                                                            .shared = 1},
                                                           {.name = "restitution",
                                                            .unit = "1",
                                                            .meaning = "restitution e wanted",
                                                            .range = SCREE_FRACTION,
                                                            .instead_of = "unloading"},
                                                           {.name = "unloading",
                                                            .unit = "N/m",
                                                            .meaning = "stiffness K2 while unloading",
                                                            .range = SCREE_ANY_POSITIVE,
                                                            .shared = 1},
                                                           {0}};

static inline struct scree_pair_constants walton_braun_pair(const struct scree_law_constants *law, double mass,
                                                            double radius) {
    (void)mass;
    (void)radius;
    return (struct scree_pair_constants){{law->c[WALTON_LOADING], law->c[WALTON_UNLOADING], 0.0}};
}

static inline scree_status normal_walton_braun_bake(const struct scree_values *values, struct scree_law_constants *law,
                                                    scree_trouble *trouble) {
    double k = values->v[WALTON_BRAUN_STIFFNESS], e = values->v[WALTON_BRAUN_RESTITUTION];
    double unloading = isnan(e) ? values->v[WALTON_BRAUN_UNLOADING] : k / (e * e);
    if (unloading < k)
        return scree_report(trouble, SCREE_BAD_INPUT, "unloading",
                            "unloading %g N/m is below stiffness %g N/m: that would gain energy", unloading, k);
    law->c[WALTON_LOADING] = k;
    law->c[WALTON_UNLOADING] = unloading;
    return SCREE_OK;
}

static SCREE_INLINE struct scree_normal_force normal_walton_braun_force(const struct scree_law_constants *law,
                                                                        struct scree_pair_constants pair,
                                                                        struct scree_pressing at) {
    (void)law;
    return walton_force(pair, at);
}

static inline double normal_walton_braun_restitution(const struct scree_law_constants *law,
                                                     struct scree_pair_constants pair, double mass, double speed) {
    (void)pair;
    (void)mass;
    (void)speed;
    return sqrt(law->c[WALTON_LOADING] / law->c[WALTON_UNLOADING]);
}

static const struct scree_normal_law scree_normal_walton_braun = {
    .text = {.name = "walton-braun",
             .formula = "F = K1 d while loading, max(0, K1 D - K2 (D - d)) while unloading from the largest overlap D",
             .source = "Walton & Braun, J. Rheol. 30 (1986) 949",
             .note = "Loses energy in the spring, without a dashpot: restitution sqrt(K1/K2), the same at every "
                     "speed; any 0 < e <= 1 can be had. Never pulls.",
             .parameters = walton_parameters,
             .example = "stiffness = 1e5, restitution = 0.5"},
    .cut = 1,
    .memory = 1,
    .bake = normal_walton_braun_bake,
    .pair = walton_braun_pair,
    .force = normal_walton_braun_force,
    .stored = walton_stored,
    .bends = walton_bends,
    .restitution = normal_walton_braun_restitution,
};

#endif
