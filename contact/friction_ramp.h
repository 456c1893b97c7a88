/* Coulomb friction with a linear ramp through zero speed.
 *   mu(v) = mu_k min(v/v_th, 1): the simplest regularisation; a resting body creeps. */
#ifndef SCREE_CONTACT_FRICTION_RAMP_H
#define SCREE_CONTACT_FRICTION_RAMP_H

#include "contact/law.h"

enum { RAMP_KINETIC, RAMP_THRESHOLD };

static const struct scree_parameter ramp_parameters[] = {
    {.name = "kinetic", .unit = "1", .meaning = "coefficient mu_k while sliding", .range = SCREE_NOT_NEGATIVE},
    {.name = "threshold", .unit = "m/s", .meaning = "speed v_th at which it is reached", .range = SCREE_ANY_POSITIVE},
    {0}};

static inline scree_status friction_ramp_bake(const struct scree_values *values, struct scree_law_constants *law,
                                              scree_trouble *trouble) {
    (void)trouble;
    law->c[RAMP_KINETIC] = values->v[RAMP_KINETIC];
    law->c[RAMP_THRESHOLD] = values->v[RAMP_THRESHOLD];
    return SCREE_OK;
}

static inline struct scree_tangential friction_ramp_force(const struct scree_law_constants *law,
                                                          struct scree_pair_constants pair, struct scree_sliding at) {
    (void)pair;
    double speed = vec_norm(at.velocity);
    double w = speed / law->c[RAMP_THRESHOLD];
    return scree_against(at, law->c[RAMP_KINETIC] * (w < 1.0 ? w : 1.0), speed);
}

static inline double friction_ramp_slope(const struct scree_law_constants *law) {
    return law->c[RAMP_KINETIC] / law->c[RAMP_THRESHOLD];
}

static const struct scree_friction_law scree_friction_ramp = {
    .text = {.name = "ramp",
             .formula = "mu = mu_k min(v/v_th, 1)",
             .source = "common regularisation of Coulomb's law",
             .note = "Creeps at rest: under a share r < 1 of the largest friction force the body moves at r v_th.",
             .parameters = ramp_parameters},
    .bake = friction_ramp_bake,
    .force = friction_ramp_force,
    .stored = scree_no_store,
    .slope = friction_ramp_slope,
    .stiffness = scree_no_stiffness,
    .damping = scree_no_stiffness,
};

#endif
