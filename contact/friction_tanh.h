/* Coulomb friction smoothed by a hyperbolic tangent.
 *   mu(v) = mu_k tanh(v/v_th) */
#ifndef SCREE_CONTACT_FRICTION_TANH_H
#define SCREE_CONTACT_FRICTION_TANH_H

#include "contact/friction_ramp.h"

static inline struct scree_tangential friction_tanh_force(const struct scree_law_constants *law,
                                                          struct scree_pair_constants pair, struct scree_sliding at) {
    (void)pair;
    double speed = vec_norm(at.velocity);
    return scree_against(at, law->c[RAMP_KINETIC] * scree_tanh(speed / law->c[RAMP_THRESHOLD]), speed);
}

static const struct scree_friction_law scree_friction_tanh = {
    .text = {.name = "tanh",
             .formula = "mu = mu_k tanh(v/v_th)",
             .source = "common regularisation of Coulomb's law",
             .note = "Smooth. Creeps at rest: under a share r < 1 of the largest friction force the body moves at "
                     "v_th artanh(r).",
             .parameters = ramp_parameters},
    .bake = friction_ramp_bake,
    .force = friction_tanh_force,
    .stored = scree_no_store,
    .slope = friction_ramp_slope,
    .stiffness = scree_no_stiffness,
    .damping = scree_no_stiffness,
};

#endif
