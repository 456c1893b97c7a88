/* Breakaway friction, Coulomb friction and a viscous part, smooth everywhere.
 *   mu(v) = sqrt(2 e) (mu_s - mu_k) exp(-(v/v_St)^2) v/v_St + mu_k tanh(v/v_C) + f v,  v_St = sqrt(2) v_b, v_C = v_b/10
 * Simscape, Translational Friction block (MathWorks), with coefficients in place of forces. */
#ifndef SCREE_CONTACT_FRICTION_SIMSCAPE_H
#define SCREE_CONTACT_FRICTION_SIMSCAPE_H

#include "contact/law.h"

enum { SIMSCAPE_STATIC, SIMSCAPE_KINETIC, SIMSCAPE_SPEED, SIMSCAPE_VISCOUS };

static const struct scree_parameter simscape_parameters[] = {
    {.name = "static", .unit = "1", .meaning = "breakaway coefficient mu_s, about at v_b", .range = SCREE_NOT_NEGATIVE},
    {.name = "kinetic", .unit = "1", .meaning = "coefficient mu_k while sliding", .range = SCREE_NOT_NEGATIVE},
    {.name = "threshold", .unit = "m/s", .meaning = "breakaway speed v_b", .range = SCREE_ANY_POSITIVE},
    {.name = "viscous",
     .unit = "s/m",
     .meaning = "viscous part f of the coefficient",
     .range = SCREE_NOT_NEGATIVE,
     .optional = 1,
     .fallback = 0.0},
    {0}};

static inline scree_status friction_simscape_bake(const struct scree_values *values, struct scree_law_constants *law,
                                                  scree_trouble *trouble) {
    for (int k = 0; k < 4; k++) law->c[k] = values->v[k];
    return scree_check_static(law->c[SIMSCAPE_STATIC], law->c[SIMSCAPE_KINETIC], trouble);
}

static inline struct scree_tangential friction_simscape_force(const struct scree_law_constants *law,
                                                              struct scree_pair_constants pair,
                                                              struct scree_sliding at) {
    (void)pair;
    double speed = vec_norm(at.velocity), w = speed / law->c[SIMSCAPE_SPEED];
    double drop = law->c[SIMSCAPE_STATIC] - law->c[SIMSCAPE_KINETIC];
    /* sqrt(2 e) v/v_St exp(-(v/v_St)^2) = w exp((1 - w^2)/2) */
    double hump = drop * w * scree_exp(0.5 * (1.0 - w) * (1.0 + w));
    double mu = hump + law->c[SIMSCAPE_KINETIC] * scree_tanh(10.0 * w) + law->c[SIMSCAPE_VISCOUS] * speed;
    return scree_against(at, mu, speed);
}

static inline double friction_simscape_slope(const struct scree_law_constants *law) {
    double drop = law->c[SIMSCAPE_STATIC] - law->c[SIMSCAPE_KINETIC];
    double rise = 0x1.a61298e1e069cp+0 * drop + 10.0 * law->c[SIMSCAPE_KINETIC]; /* sqrt(e) */
    return rise / law->c[SIMSCAPE_SPEED] + law->c[SIMSCAPE_VISCOUS];
}

static const struct scree_friction_law scree_friction_simscape = {
    .text =
        {.name = "simscape",
         .formula = "mu = (mu_s - mu_k) w exp((1 - w^2)/2) + mu_k tanh(10 w) + f v, w = v/v_b",
         .source = "Simscape, Translational Friction (MathWorks)",
         .note =
             "Smooth. Creeps at rest: under half of the load that it holds at about v_b/18 if mu_s = mu_k, faster if "
             "mu_s is larger. f v is a coefficient: the viscous force grows with the load.",
         .example = "static = 0.4, kinetic = 0.3, threshold = 1e-3, viscous = 2.0",
         .parameters = simscape_parameters},
    .bake = friction_simscape_bake,
    .force = friction_simscape_force,
    .stored = scree_no_store,
    .slope = friction_simscape_slope,
    .stiffness = scree_no_stiffness,
    .damping = scree_no_stiffness,
};

#endif
