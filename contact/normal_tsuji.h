/* Hertz's spring with a dashpot that makes the restitution the same at every speed; the force may pull, and the contact
 * ends at zero overlap.
 *   F = K d^(3/2) + alpha sqrt(m K) d^(1/4) u
 *   e = exp(-pi zeta/sqrt(1 - zeta^2)),  zeta = alpha/sqrt(5)
 * F: Tsuji, Tanaka & Ishida, Powder Technol. 71 (1992) 239; e: Antypov & Elliott, Europhys. Lett. 94 (2011) 50004. */
#ifndef SCREE_CONTACT_NORMAL_TSUJI_H
#define SCREE_CONTACT_NORMAL_TSUJI_H

#include "contact/tsuji.h"

static inline scree_status normal_tsuji_bake(const struct scree_values *values, struct scree_law_constants *law,
                                             scree_trouble *trouble) {
    (void)trouble;
    tsuji_bake(values, law, linear_zeta_pulling(values->v[TSUJI_GIVEN_RESTITUTION]));
    return SCREE_OK;
}

static SCREE_INLINE struct scree_normal_force
normal_tsuji_force(const struct scree_law_constants *law, struct scree_pair_constants pair, struct scree_pressing at) {
    (void)law;
    return tsuji_force(pair, at);
}

static inline double normal_tsuji_restitution(const struct scree_law_constants *law, struct scree_pair_constants pair,
                                              double mass, double speed) {
    (void)pair;
    (void)mass;
    (void)speed;
    return linear_e_pulling(tsuji_zeta(law));
}

static const struct scree_normal_law scree_normal_tsuji = {
    .text = {.name = "tsuji",
             .formula = "F = K d^(3/2) + alpha sqrt(m K) d^(1/4) u while d > 0 (may pull), K = (4/3) E* sqrt(R*)",
             .source = "Tsuji, Tanaka & Ishida, Powder Technol. 71 (1992) 239",
             .note = "Restitution is the same at every speed: e = exp(-pi zeta/sqrt(1-zeta^2)), zeta = alpha/sqrt(5). "
                     "Near the end of a contact the force pulls.",
             .parameters = tsuji_parameters,
             .example = "stiffness = 5e6, restitution = 0.5"},
    .cut = 0,
    .root = 4,
    .turns_smoothly = 1,
    .takes_roots = 1,
    .bake = normal_tsuji_bake,
    .pair = tsuji_pair,
    .force = normal_tsuji_force,
    .stored = hertz_stored,
    .restitution = normal_tsuji_restitution,
};

#endif
