/* Tsuji's law that never pulls; the contact ends where the force vanishes.
 *   F = max(0, K d^(3/2) + alpha sqrt(m K) d^(1/4) u)
 *   e = exp(-2 zeta arccos(zeta)/sqrt(1 - zeta^2)),  zeta = alpha/sqrt(5), arcosh above zeta = 1
 * Tsuji, Tanaka & Ishida, Powder Technol. 71 (1992) 239. The map to the linear law takes the force to the second
 * derivative x'' there, so this end too is that of the linear law (contact/tsuji.h). */
#ifndef SCREE_CONTACT_NORMAL_TSUJI_CUT_H
#define SCREE_CONTACT_NORMAL_TSUJI_CUT_H

#include "contact/tsuji.h"

static inline scree_status normal_tsuji_cut_bake(const struct scree_values *values, struct scree_law_constants *law,
                                                 scree_trouble *trouble) {
    (void)trouble;
    double e = values->v[TSUJI_GIVEN_RESTITUTION];
    tsuji_bake(values, law, isnan(e) ? 0.0 : linear_invert(e, 2.0));
    return SCREE_OK;
}

static SCREE_INLINE struct scree_normal_force normal_tsuji_cut_force(const struct scree_law_constants *law,
                                                                     struct scree_pair_constants pair,
                                                                     struct scree_pressing at) {
    (void)law;
    return tsuji_force(pair, at);
}

static inline double normal_tsuji_cut_restitution(const struct scree_law_constants *law,
                                                  struct scree_pair_constants pair, double mass, double speed) {
    (void)pair;
    (void)mass;
    (void)speed;
    return exp(-2.0 * tsuji_zeta(law) * linear_angle(tsuji_zeta(law)));
}

static const struct scree_normal_law scree_normal_tsuji_cut = {
    .text = {.name = "tsuji-cut",
             .formula = "F = max(0, K d^(3/2) + alpha sqrt(m K) d^(1/4) u), K = (4/3) E* sqrt(R*)",
             .source = "Tsuji, Tanaka & Ishida, Powder Technol. 71 (1992) 239",
             .note =
                 "Never pulls. Restitution is the same at every speed: e = exp(-2 zeta arccos(zeta)/sqrt(1-zeta^2)), "
                 "zeta = alpha/sqrt(5); any 0 < e <= 1 can be had.",
             .parameters = tsuji_parameters,
             .example = "stiffness = 5e6, restitution = 0.5"},
    .cut = 1,
    .root = 4,
    .turns_smoothly = 1,
    .takes_roots = 1,
    .bake = normal_tsuji_cut_bake,
    .pair = tsuji_pair,
    .force = normal_tsuji_cut_force,
    .stored = hertz_stored,
    .restitution = normal_tsuji_cut_restitution,
};

#endif
