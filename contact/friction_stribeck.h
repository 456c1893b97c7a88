/* Static friction that falls to kinetic friction by an exponential, and a viscous part (Stribeck's curve).
 *   mu(v) = (mu_k + (mu_s - mu_k) exp(-(v/v_s)^delta)) min(v/v_th, 1) + f v
 * R. Stribeck, Z. VDI 46 (1902) 1341; the exponential: L. C. Bo & D. Pavelescu, Wear 82 (1982) 277; delta = 2:
 * Armstrong-Helouvry, Dupont & Canudas de Wit, Automatica 30 (1994) 1083. The curve has a jump at v = 0; the ramp up to
 * v_th (much smaller than v_s) stands for it here: a resting body creeps. lugre and karnopp have the same curve and
 * truly stick. */
#ifndef SCREE_CONTACT_FRICTION_STRIBECK_H
#define SCREE_CONTACT_FRICTION_STRIBECK_H

#include "contact/law.h"

enum { STRIBECK_STATIC, STRIBECK_KINETIC, STRIBECK_SPEED, STRIBECK_THRESHOLD, STRIBECK_EXPONENT, STRIBECK_VISCOUS };

static const struct scree_parameter stribeck_parameters[] = {
    {.name = "static", .unit = "1", .meaning = "coefficient mu_s towards low speed", .range = SCREE_NOT_NEGATIVE},
    {.name = "kinetic", .unit = "1", .meaning = "coefficient mu_k towards high speed", .range = SCREE_NOT_NEGATIVE},
    {.name = "stribeck_speed", .unit = "m/s", .meaning = "speed v_s of the fall", .range = SCREE_ANY_POSITIVE},
    {.name = "threshold", .unit = "m/s", .meaning = "speed v_th of the ramp through zero", .range = SCREE_ANY_POSITIVE},
    {.name = "exponent",
     .unit = "1",
     .meaning = "exponent delta of the fall",
     .range = SCREE_ANY_POSITIVE,
     .optional = 1,
     .fallback = 2.0},
    {.name = "viscous",
     .unit = "s/m",
     .meaning = "viscous part f of the coefficient",
     .range = SCREE_NOT_NEGATIVE,
     .optional = 1,
     .fallback = 0.0},
    {0}};

static inline scree_status friction_stribeck_bake(const struct scree_values *values, struct scree_law_constants *law,
                                                  scree_trouble *trouble) {
    for (int k = 0; k < 6; k++) law->c[k] = values->v[k];
    law->exponent = scree_exponent_of(law->c[STRIBECK_EXPONENT]);
    return scree_check_static(law->c[STRIBECK_STATIC], law->c[STRIBECK_KINETIC], trouble);
}

static inline struct scree_tangential friction_stribeck_force(const struct scree_law_constants *law,
                                                              struct scree_pair_constants pair,
                                                              struct scree_sliding at) {
    (void)pair;
    double speed = vec_norm(at.velocity);
    double w = speed / law->c[STRIBECK_SPEED], ramp = speed / law->c[STRIBECK_THRESHOLD];
    double drop = law->c[STRIBECK_STATIC] - law->c[STRIBECK_KINETIC];
    double square = law->exponent.two, other = 1.0 - square; /* both in any case: a choice is no vector */
    double fall = scree_exp(-(square * (w * w) + other * scree_pow(w, law->c[STRIBECK_EXPONENT])));
    double dry = (law->c[STRIBECK_KINETIC] + drop * fall) * (ramp < 1.0 ? ramp : 1.0);
    return scree_against(at, dry + law->c[STRIBECK_VISCOUS] * speed, speed);
}

static inline double friction_stribeck_slope(const struct scree_law_constants *law) {
    return law->c[STRIBECK_STATIC] / law->c[STRIBECK_THRESHOLD] + law->c[STRIBECK_VISCOUS];
}

static const struct scree_friction_law scree_friction_stribeck = {
    .text = {.name = "stribeck",
             .formula = "mu = (mu_k + (mu_s - mu_k) exp(-(v/v_s)^delta)) min(v/v_th, 1) + f v",
             .source = "Stribeck, Z. VDI 46 (1902) 1341; Bo & Pavelescu, Wear 82 (1982) 277",
             .note = "Creeps at rest: at about r v_th under a share r < 1 of mu_s. f v is a coefficient: the viscous "
                     "force grows with the load.",
             .example = "static = 0.4, kinetic = 0.3, stribeck_speed = 2e-3, threshold = 3e-4, viscous = 2.0",
             .parameters = stribeck_parameters},
    .bake = friction_stribeck_bake,
    .force = friction_stribeck_force,
    .stored = scree_no_store,
    .slope = friction_stribeck_slope,
    .stiffness = scree_no_stiffness,
    .damping = scree_no_stiffness,
};

#endif
