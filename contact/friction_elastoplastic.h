/* LuGre's bristles with an elastic range: below it they only bend, so that a vibrating load makes nothing drift.
 *   z' = v - alpha s_0 |v| z/g(v),  F = -(s_0 z + s_1 z' + s_2 N v),  g as in lugre
 *   alpha = 0 for |z| <= z_b and while z goes back; 1 from z_s = g/s_0 on;
 *   (1 + sin(pi (|z| - (z_s + z_b)/2)/(z_s - z_b)))/2 between
 * P. Dupont, V. Hayward, B. Armstrong & F. Altpeter, "Single state elastoplastic friction models", IEEE Trans. Autom.
 * Control 47 (2002) 787. The elastic range z_b is given as a share of mu_k N/s_0, so that it goes with the load. */
#ifndef SCREE_CONTACT_FRICTION_ELASTOPLASTIC_H
#define SCREE_CONTACT_FRICTION_ELASTOPLASTIC_H

#include "contact/lugre.h"

static inline scree_status friction_elastoplastic_bake(const struct scree_values *values,
                                                       struct scree_law_constants *law, scree_trouble *trouble) {
    law->c[LUGRE_ELASTIC] = values->v[0];
    if (values->v[0] >= 1.0)
        return scree_report(trouble, SCREE_BAD_INPUT, "elastic", "elastic (%g) must be below 1", values->v[0]);
    return lugre_bake(values->v + 1, law, trouble);
}

/* How plastic the bristles are at deflection z. */
static inline double elastoplastic_alpha(struct vec z, struct vec v, double elastic, double steady) {
    double share = (vec_norm(z) - elastic) / (steady - elastic + SCREE_NO_FORCE);
    share = share > 0.0 ? share : 0.0;
    share = share < 1.0 ? share : 1.0;
    double sine, cosine;
    scree_sincos(3.14159265358979323846 * (share - 0.5), &sine, &cosine);
    return vec_dot(z, v) > 0.0 ? 0.5 + 0.5 * sine : 0.0;
}

static inline struct scree_tangential friction_elastoplastic_force(const struct scree_law_constants *law,
                                                                   struct scree_pair_constants pair,
                                                                   struct scree_sliding at) {
    (void)pair;
    double speed = vec_norm(at.velocity), g = lugre_steady(law, at.normal, speed), s0 = law->c[LUGRE_STIFFNESS];
    double elastic = law->c[LUGRE_ELASTIC] * law->c[LUGRE_KINETIC] * at.normal / s0;
    double most = lugre_bears(law, at) / s0;
    /* alpha of the step: at the middle of a first guess of its path. */
    double alpha = elastoplastic_alpha(at.stretch, at.velocity, elastic, g / s0);
    struct scree_bristle path = scree_bristle_path(at, at.stretch, alpha * s0, g, most);
    alpha = elastoplastic_alpha(path.middle, at.velocity, elastic, g / s0);
    path = scree_bristle_path(at, at.stretch, alpha * s0, g, most);
    return lugre_force(law, at, path, g, speed);
}

static inline struct vec friction_elastoplastic_rate(const struct scree_law_constants *law,
                                                     struct scree_pair_constants pair, struct scree_sliding at) {
    (void)pair;
    double g = lugre_steady(law, at.normal, vec_norm(at.velocity)), s0 = law->c[LUGRE_STIFFNESS];
    double elastic = law->c[LUGRE_ELASTIC] * law->c[LUGRE_KINETIC] * at.normal / s0;
    double alpha = elastoplastic_alpha(at.stretch, at.velocity, elastic, g / s0);
    return scree_bristle_rate(at, at.stretch, alpha * s0, g);
}

static const struct scree_friction_law scree_friction_elastoplastic = {
    .text = {.name = "elastoplastic",
             .formula =
                 "z' = v - alpha s_0 |v| z/g, F = -(s_0 z + s_1 z' + s_2 N v); alpha(z) = 0 in the elastic range",
             .source = "Dupont, Hayward, Armstrong & Altpeter, IEEE Trans. Autom. Control 47 (2002) 787",
             .note = "As lugre, but doesn't drift under a load that vibrates in the elastic range, |load| < elastic "
                     "mu_k N.",
             .example =
                 "static = 0.4, kinetic = 0.3, stribeck_speed = 2e-3, stiffness = 4e4, damping = 20.0, elastic = "
                 "0.8",
             .parameters = lugre_family},
    .memory = 1,
    .bake = friction_elastoplastic_bake,
    .force = friction_elastoplastic_force,
    .rate = friction_elastoplastic_rate,
    .bears = lugre_bears,
    .stored = lugre_stored,
    .slope = lugre_slope,
    .stiffness = lugre_stiffness,
    .damping = lugre_damping,
};

#endif
