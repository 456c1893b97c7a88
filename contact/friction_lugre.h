/* LuGre: bristles with a dashpot that saturate on Stribeck's curve.
 *   z' = v - s_0 |v| z/g(v),  F = -(s_0 z + s_1 z' + s_2 N v),  g = N (mu_k + (mu_s - mu_k) exp(-(v/v_s)^2))
 * C. Canudas de Wit, H. Olsson, K. J. Astrom & P. Lischinsky, "A new model for control of systems with friction", IEEE
 * Trans. Autom. Control 40 (1995) 419, eqs. 1 to 4. Here the viscous part is a coefficient, so that it goes with the
 * load; the bristles carry mu_s N at most, also when the load falls at rest; and s_1 is kept below 4 g/|v|, which keeps
 * the law passive and changes nothing near rest (contact/bristle.h). */
#ifndef SCREE_CONTACT_FRICTION_LUGRE_H
#define SCREE_CONTACT_FRICTION_LUGRE_H

#include "contact/lugre.h"

static inline scree_status friction_lugre_bake(const struct scree_values *values, struct scree_law_constants *law,
                                               scree_trouble *trouble) {
    return lugre_bake(values->v, law, trouble);
}

static inline struct scree_tangential friction_lugre_force(const struct scree_law_constants *law,
                                                           struct scree_pair_constants pair, struct scree_sliding at) {
    (void)pair;
    double speed = vec_norm(at.velocity), g = lugre_steady(law, at.normal, speed), s0 = law->c[LUGRE_STIFFNESS];
    struct scree_bristle path = scree_bristle_path(at, at.stretch, s0, g, lugre_bears(law, at) / s0);
    return lugre_force(law, at, path, g, speed);
}

static inline struct vec friction_lugre_rate(const struct scree_law_constants *law, struct scree_pair_constants pair,
                                             struct scree_sliding at) {
    (void)pair;
    double g = lugre_steady(law, at.normal, vec_norm(at.velocity));
    return scree_bristle_rate(at, at.stretch, law->c[LUGRE_STIFFNESS], g);
}

static const struct scree_friction_law scree_friction_lugre = {
    .text = {.name = "lugre",
             .formula =
                 "z' = v - s_0 |v| z/g, F = -(s_0 z + s_1 z' + s_2 N v), g = N (mu_k + (mu_s - mu_k) exp(-(v/v_s)^2))",
             .source = "Canudas de Wit, Olsson, Astrom & Lischinsky, IEEE Trans. Autom. Control 40 (1995) 419",
             .note =
                 "Truly rests under a steady load, at z = load/s_0 (s_1 about 2 sqrt(s_0 m) damps it well). Under a "
                 "load that vibrates it drifts, even far below breakaway: see elastoplastic. |z| is at most mu_s "
                 "N/s_0, and "
                 "s_1 acts as no more than 4 g/|v|, which keeps the law passive.",
             .example =
                 "static = 0.4, kinetic = 0.3, stribeck_speed = 2e-3, stiffness = 4e4, damping = 20.0, viscous = 2.0",
             .parameters = lugre_family + 1},
    .memory = 1,
    .bake = friction_lugre_bake,
    .force = friction_lugre_force,
    .rate = friction_lugre_rate,
    .bears = lugre_bears,
    .stored = lugre_stored,
    .slope = lugre_slope,
    .stiffness = lugre_stiffness,
    .damping = lugre_damping,
};

#endif
