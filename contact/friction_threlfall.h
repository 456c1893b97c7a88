/* Coulomb friction smoothed by an exponential that ends at a finite speed.
 *   mu(v) = mu_k (1 - exp(-3 v/v_r))/(1 - exp(-3)) up to v_r, mu_k beyond
 * A. D. Threlfall, "The inclusion of Coulomb friction in mechanisms programs with particular reference to DRAM", Mech.
 * Mach. Theory 13 (1978) 475. The literature often writes 0.95 for 1 - exp(-3), which leaves a jump at v_r. */
#ifndef SCREE_CONTACT_FRICTION_THRELFALL_H
#define SCREE_CONTACT_FRICTION_THRELFALL_H

#include "contact/law.h"

enum { THRELFALL_KINETIC, THRELFALL_SPEED, THRELFALL_SCALE };

static const struct scree_parameter threlfall_parameters[] = {
    {.name = "kinetic", .unit = "1", .meaning = "coefficient mu_k while sliding", .range = SCREE_NOT_NEGATIVE},
    {.name = "threshold", .unit = "m/s", .meaning = "speed v_r at which it is reached", .range = SCREE_ANY_POSITIVE},
    {0}};

static inline scree_status friction_threlfall_bake(const struct scree_values *values, struct scree_law_constants *law,
                                                   scree_trouble *trouble) {
    (void)trouble;
    law->c[THRELFALL_KINETIC] = values->v[0];
    law->c[THRELFALL_SPEED] = values->v[1];
    law->c[THRELFALL_SCALE] = values->v[0] / (1.0 - scree_exp(-3.0));
    return SCREE_OK;
}

static inline struct scree_tangential friction_threlfall_force(const struct scree_law_constants *law,
                                                               struct scree_pair_constants pair,
                                                               struct scree_sliding at) {
    (void)pair;
    double speed = vec_norm(at.velocity), w = speed / law->c[THRELFALL_SPEED];
    double rising = law->c[THRELFALL_SCALE] * (1.0 - scree_exp(-3.0 * w));
    return scree_against(at, w < 1.0 ? rising : law->c[THRELFALL_KINETIC], speed);
}

static inline double friction_threlfall_slope(const struct scree_law_constants *law) {
    return 3.0 * law->c[THRELFALL_SCALE] / law->c[THRELFALL_SPEED];
}

static const struct scree_friction_law scree_friction_threlfall = {
    .text =
        {.name = "threlfall",
         .formula = "mu = mu_k (1 - exp(-3 v/v_r))/(1 - exp(-3)) up to v_r, mu_k beyond",
         .source = "Threlfall, Mech. Mach. Theory 13 (1978) 475",
         .note =
             "Creeps at rest: under a share r < 1 of the largest friction force at -(v_r/3) ln(1 - r (1 - exp(-3))).",
         .example = "kinetic = 0.3, threshold = 1e-3",
         .parameters = threlfall_parameters},
    .bake = friction_threlfall_bake,
    .force = friction_threlfall_force,
    .stored = scree_no_store,
    .slope = friction_threlfall_slope,
    .stiffness = scree_no_stiffness,
    .damping = scree_no_stiffness,
};

#endif
