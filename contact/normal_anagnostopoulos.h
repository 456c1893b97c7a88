/* Linear spring and dashpot of pounding structures: the damping ratio of the law that may pull, and a force that
 * doesn't.
 *   F = max(0, k d + c u),  zeta = c/(2 sqrt(k m)) = -ln e/sqrt(pi^2 + ln^2 e)
 * Anagnostopoulos, Earthquake Eng. Struct. Dyn. 16 (1988) 443 and 33 (2004) 897. The contact ends where the force
 * vanishes; what it delivers is
 *   e' = exp(-2 zeta arccos(zeta)/sqrt(1 - zeta^2))
 * (Schwager & Poeschel, Granular Matter 9 (2007) 465). */
#ifndef SCREE_CONTACT_NORMAL_ANAGNOSTOPOULOS_H
#define SCREE_CONTACT_NORMAL_ANAGNOSTOPOULOS_H

#include "contact/normal_linear_cut.h"

static inline scree_status normal_anagnostopoulos_bake(const struct scree_values *values,
                                                       struct scree_law_constants *law, scree_trouble *trouble) {
    (void)trouble;
    linear_bake(values, law, linear_zeta_pulling(values->v[LINEAR_GIVEN_RESTITUTION]));
    return SCREE_OK;
}

static SCREE_INLINE struct scree_normal_force normal_anagnostopoulos_force(const struct scree_law_constants *law,
                                                                           struct scree_pair_constants pair,
                                                                           struct scree_pressing at) {
    return normal_linear_cut_force(law, pair, at);
}

static inline double normal_anagnostopoulos_restitution(const struct scree_law_constants *law,
                                                        struct scree_pair_constants pair, double mass, double speed) {
    return normal_linear_cut_restitution(law, pair, mass, speed);
}

static const struct scree_normal_law scree_normal_anagnostopoulos = {
    .text = {.name = "anagnostopoulos",
             .formula = "F = max(0, k d + c u), zeta = -ln e/sqrt(pi^2+ln^2 e)",
             .source = "Anagnostopoulos, Earthquake Eng. Struct. Dyn. 16 (1988) 443; 33 (2004) 897",
             .note = "Never pulls. The dashpot is the one that delivers e where the force may pull; cut at zero "
                     "it delivers more: e' = exp(-2 zeta arccos(zeta)/sqrt(1-zeta^2)), 0.55 for 0.5. linear-cut "
                     "delivers what is asked.",
             .parameters = linear_parameters,
             .example = "stiffness = 1e5, restitution = 0.5"},
    .cut = 1,
    .turns_smoothly = 1,
    .bake = normal_anagnostopoulos_bake,
    .pair = linear_pair,
    .force = normal_anagnostopoulos_force,
    .stored = linear_stored,
    .like = &scree_normal_linear_cut,
    .restitution = normal_anagnostopoulos_restitution,
};

#endif
