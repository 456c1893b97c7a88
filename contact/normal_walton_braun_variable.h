/* Hysteretic spring that unloads the stiffer, the larger its largest force was.
 *   F = K1 d while loading
 *   F = max(0, K1 D - K2 (D - d)) while unloading from the largest overlap D,  K2 = K1 + S K1 D
 *   e = sqrt(w0/(S v + w0)),  w0 = sqrt(K1/m)
 * Walton & Braun, J. Rheol. 30 (1986) 949. A free impact ends where the force vanishes, at d0 = D (1 - K1/K2). */
#ifndef SCREE_CONTACT_NORMAL_WALTON_BRAUN_VARIABLE_H
#define SCREE_CONTACT_NORMAL_WALTON_BRAUN_VARIABLE_H

#include "contact/normal_walton_braun.h"

enum { WALTON_VARIABLE_STIFFNESS, WALTON_VARIABLE_RESTITUTION, WALTON_VARIABLE_SLOPE, WALTON_VARIABLE_SPEED };
enum {
    WALTON_VARIABLE_K,
    WALTON_VARIABLE_S,
    WALTON_VARIABLE_PACE
}; /* law constants; S is pace x sqrt(K1/m) if e is wanted */

static const struct scree_parameter walton_variable_parameters[] = {
    {.name = "stiffness",
     .unit = "N/m",
     .meaning = "stiffness K1 while loading",
     .range = SCREE_ANY_POSITIVE,
     .shared = 1},
    {.name = "restitution",
     .unit = "1",
     .meaning = "restitution e wanted at impact speed `speed`",
     .range = SCREE_FRACTION,
     .instead_of = "slope"},
    {.name = "slope", .unit = "1/m", .meaning = "rise S of K2 with the largest force", .range = SCREE_NOT_NEGATIVE},
    {.name = "speed",
     .unit = "m/s",
     .meaning = "impact speed at which `restitution` is wanted",
     .range = SCREE_ANY_POSITIVE,
     .optional = 1,
     .fallback = NAN},
    {0}};

static inline struct scree_pair_constants walton_variable_pair(const struct scree_law_constants *law, double mass,
                                                               double radius) {
    (void)radius;
    double k = law->c[WALTON_VARIABLE_K];
    double slope = law->c[WALTON_VARIABLE_S] + law->c[WALTON_VARIABLE_PACE] * sqrt(k / mass);
    return (struct scree_pair_constants){{k, k, slope}};
}

static inline scree_status normal_walton_braun_variable_bake(const struct scree_values *values,
                                                             struct scree_law_constants *law, scree_trouble *trouble) {
    double e = values->v[WALTON_VARIABLE_RESTITUTION], speed = values->v[WALTON_VARIABLE_SPEED];
    int wanted = !isnan(e);
    if (wanted && isnan(speed))
        return scree_report(
            trouble, SCREE_BAD_INPUT, "restitution",
            "the restitution of walton-braun-variable depends on the impact speed: give `speed` (m/s) beside it");
    if (!wanted && !isnan(speed))
        return scree_report(trouble, SCREE_BAD_INPUT, "speed", "`speed` goes with `restitution`, not with `slope`");
    law->c[WALTON_VARIABLE_K] = values->v[WALTON_VARIABLE_STIFFNESS];
    law->c[WALTON_VARIABLE_S] = wanted ? 0.0 : values->v[WALTON_VARIABLE_SLOPE];
    law->c[WALTON_VARIABLE_PACE] = wanted ? (1.0 - e) * (1.0 + e) / (e * e * speed) : 0.0;
    return SCREE_OK;
}

static SCREE_INLINE struct scree_normal_force normal_walton_braun_variable_force(const struct scree_law_constants *law,
                                                                                 struct scree_pair_constants pair,
                                                                                 struct scree_pressing at) {
    (void)law;
    return walton_force(pair, at);
}

static inline double normal_walton_braun_variable_restitution(const struct scree_law_constants *law,
                                                              struct scree_pair_constants pair, double mass,
                                                              double speed) {
    double w = sqrt(law->c[WALTON_VARIABLE_K] / mass);
    return sqrt(w / (pair.c[WALTON_SLOPE] * speed + w));
}

static const struct scree_normal_law scree_normal_walton_braun_variable = {
    .text = {.name = "walton-braun-variable",
             .formula = "F = K1 d while loading, max(0, K1 D - K2 (D - d)) while unloading from the largest overlap D, "
                        "K2 = K1 + S K1 D",
             .source = "Walton & Braun, J. Rheol. 30 (1986) 949",
             .note = "Loses energy in the spring, without a dashpot; restitution falls with impact speed v: e = "
                     "sqrt(w0/(S v + w0)), w0 = sqrt(K1/m). Never pulls.",
             .parameters = walton_variable_parameters,
             .example = "stiffness = 1e5, restitution = 0.5, speed = 1.0"},
    .cut = 1,
    .memory = 1,
    .bake = normal_walton_braun_variable_bake,
    .pair = walton_variable_pair,
    .force = normal_walton_braun_variable_force,
    .stored = walton_stored,
    .bends = walton_bends,
    .like = &scree_normal_walton_braun,
    .restitution = normal_walton_braun_variable_restitution,
};

#endif
