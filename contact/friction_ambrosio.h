/* Coulomb friction with a ramp that sets in above a tolerance speed; below it there is none.
 *   mu(v) = 0 up to v_0, mu_k (v - v_0)/(v_1 - v_0) up to v_1, mu_k beyond
 * J. Ambrosio, "Impact of rigid and flexible multibody systems: deformation description and contact models", in:
 * Virtual Nonlinear Multibody Systems, NATO Science Series 103 (2003) 57. */
#ifndef SCREE_CONTACT_FRICTION_AMBROSIO_H
#define SCREE_CONTACT_FRICTION_AMBROSIO_H

#include "contact/law.h"

enum { AMBROSIO_KINETIC, AMBROSIO_TOLERANCE, AMBROSIO_THRESHOLD };

static const struct scree_parameter ambrosio_parameters[] = {
    {.name = "kinetic", .unit = "1", .meaning = "coefficient mu_k while sliding", .range = SCREE_NOT_NEGATIVE},
    {.name = "tolerance", .unit = "m/s", .meaning = "speed v_0 below which there is none", .range = SCREE_NOT_NEGATIVE},
    {.name = "threshold",
     .unit = "m/s",
     .meaning = "speed v_1 at which mu_k is reached, above v_0",
     .range = SCREE_ANY_POSITIVE},
    {0}};

static inline scree_status friction_ambrosio_bake(const struct scree_values *values, struct scree_law_constants *law,
                                                  scree_trouble *trouble) {
    for (int k = 0; k < 3; k++) law->c[k] = values->v[k];
    if (law->c[AMBROSIO_THRESHOLD] > law->c[AMBROSIO_TOLERANCE]) return SCREE_OK;
    return scree_report(trouble, SCREE_BAD_INPUT, "threshold", "threshold (%g m/s) must be above tolerance (%g m/s)",
                        law->c[AMBROSIO_THRESHOLD], law->c[AMBROSIO_TOLERANCE]);
}

static inline struct scree_tangential friction_ambrosio_force(const struct scree_law_constants *law,
                                                              struct scree_pair_constants pair,
                                                              struct scree_sliding at) {
    (void)pair;
    double speed = vec_norm(at.velocity), from = law->c[AMBROSIO_TOLERANCE];
    double share = (speed - from) / (law->c[AMBROSIO_THRESHOLD] - from);
    share = share > 0.0 ? share : 0.0;
    return scree_against(at, law->c[AMBROSIO_KINETIC] * (share < 1.0 ? share : 1.0), speed);
}

static inline double friction_ambrosio_slope(const struct scree_law_constants *law) {
    return law->c[AMBROSIO_KINETIC] / (law->c[AMBROSIO_THRESHOLD] - law->c[AMBROSIO_TOLERANCE]);
}

static const struct scree_friction_law scree_friction_ambrosio = {
    .text = {.name = "ambrosio",
             .formula = "mu = 0 up to v_0, mu_k (v - v_0)/(v_1 - v_0) up to v_1, mu_k beyond",
             .source = "Ambrosio, in: Virtual Nonlinear Multibody Systems (2003) 57",
             .note = "Slides freely below v_0; creeps under a share r < 1 of the largest friction force at v_0 + r "
                     "(v_1 - v_0).",
             .example = "kinetic = 0.3, tolerance = 2e-4, threshold = 1e-3",
             .parameters = ambrosio_parameters},
    .bake = friction_ambrosio_bake,
    .force = friction_ambrosio_force,
    .stored = scree_no_store,
    .slope = friction_ambrosio_slope,
    .stiffness = scree_no_stiffness,
    .damping = scree_no_stiffness,
};

#endif
