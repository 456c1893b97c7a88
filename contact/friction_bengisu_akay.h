/* A parabola up to static friction, then an exponential fall to kinetic friction.
 *   mu(v) = mu_s (1 - (v/v_0 - 1)^2) up to v_0;  mu_k + (mu_s - mu_k) exp(-xi (v - v_0)) beyond
 * M. T. Bengisu & A. Akay, "Stability of friction-induced vibrations in multi-degree-of-freedom systems", J. Sound Vib.
 * 171 (1994) 557. */
#ifndef SCREE_CONTACT_FRICTION_BENGISU_AKAY_H
#define SCREE_CONTACT_FRICTION_BENGISU_AKAY_H

#include "contact/law.h"

enum { BENGISU_STATIC, BENGISU_KINETIC, BENGISU_SPEED, BENGISU_FALL };

static const struct scree_parameter bengisu_parameters[] = {
    {.name = "static", .unit = "1", .meaning = "coefficient mu_s at v_0", .range = SCREE_NOT_NEGATIVE},
    {.name = "kinetic", .unit = "1", .meaning = "coefficient mu_k at high speed", .range = SCREE_NOT_NEGATIVE},
    {.name = "threshold", .unit = "m/s", .meaning = "speed v_0 of the largest friction", .range = SCREE_ANY_POSITIVE},
    {.name = "fall", .unit = "s/m", .meaning = "rate xi of the fall to mu_k", .range = SCREE_ANY_POSITIVE},
    {0}};

static inline scree_status friction_bengisu_akay_bake(const struct scree_values *values,
                                                      struct scree_law_constants *law, scree_trouble *trouble) {
    for (int k = 0; k < 4; k++) law->c[k] = values->v[k];
    return scree_check_static(law->c[BENGISU_STATIC], law->c[BENGISU_KINETIC], trouble);
}

static inline struct scree_tangential friction_bengisu_akay_force(const struct scree_law_constants *law,
                                                                  struct scree_pair_constants pair,
                                                                  struct scree_sliding at) {
    (void)pair;
    double speed = vec_norm(at.velocity), beyond = speed - law->c[BENGISU_SPEED], w = speed / law->c[BENGISU_SPEED];
    double drop = law->c[BENGISU_STATIC] - law->c[BENGISU_KINETIC];
    double rising = law->c[BENGISU_STATIC] * (w * (2.0 - w));
    double falling = law->c[BENGISU_KINETIC] + drop * scree_exp(-law->c[BENGISU_FALL] * beyond);
    return scree_against(at, w < 1.0 ? rising : falling, speed);
}

static inline double friction_bengisu_akay_slope(const struct scree_law_constants *law) {
    return 2.0 * law->c[BENGISU_STATIC] / law->c[BENGISU_SPEED];
}

static const struct scree_friction_law scree_friction_bengisu_akay = {
    .text = {.name = "bengisu-akay",
             .formula = "mu = mu_s (1 - (v/v_0 - 1)^2) up to v_0; mu_k + (mu_s - mu_k) exp(-xi (v - v_0)) beyond",
             .source = "Bengisu & Akay, J. Sound Vib. 171 (1994) 557",
             .note = "Creeps at rest: under a share r < 1 of the largest friction force at v_0 (1 - sqrt(1 - r)).",
             .example = "static = 0.4, kinetic = 0.3, threshold = 1e-3, fall = 1e3",
             .parameters = bengisu_parameters},
    .bake = friction_bengisu_akay_bake,
    .force = friction_bengisu_akay_force,
    .stored = scree_no_store,
    .slope = friction_bengisu_akay_slope,
    .stiffness = scree_no_stiffness,
    .damping = scree_no_stiffness,
};

#endif
