/* Static and kinetic friction joined by cubic steps: no kink anywhere.
 *   mu(v) = mu_s (3 w/2 - w^3/2), w = v/v_s, up to v_s (the cubic STEP from -mu_s at -v_s to mu_s at v_s);
 *   STEP from mu_s at v_s to mu_k at v_d; mu_k beyond
 * MSC Adams/Solver, CONTACT statement, Coulomb friction. */
#ifndef SCREE_CONTACT_FRICTION_STEP_H
#define SCREE_CONTACT_FRICTION_STEP_H

#include "contact/law.h"

enum { STEP_STATIC, STEP_KINETIC, STEP_STICTION_SPEED, STEP_SLIDING_SPEED };

static const struct scree_parameter step_parameters[] = {
    {.name = "static", .unit = "1", .meaning = "coefficient mu_s at v_s", .range = SCREE_NOT_NEGATIVE},
    {.name = "kinetic", .unit = "1", .meaning = "coefficient mu_k from v_d on", .range = SCREE_NOT_NEGATIVE},
    {.name = "stiction_speed", .unit = "m/s", .meaning = "v_s", .range = SCREE_ANY_POSITIVE},
    {.name = "sliding_speed", .unit = "m/s", .meaning = "v_d, above v_s", .range = SCREE_ANY_POSITIVE},
    {0}};

static inline scree_status friction_step_bake(const struct scree_values *values, struct scree_law_constants *law,
                                              scree_trouble *trouble) {
    for (int k = 0; k < 4; k++) law->c[k] = values->v[k];
    if (scree_check_static(law->c[STEP_STATIC], law->c[STEP_KINETIC], trouble)) return SCREE_BAD_INPUT;
    if (law->c[STEP_SLIDING_SPEED] > law->c[STEP_STICTION_SPEED]) return SCREE_OK;
    return scree_report(trouble, SCREE_BAD_INPUT, "sliding_speed",
                        "sliding_speed (%g m/s) must be above stiction_speed (%g m/s)", law->c[STEP_SLIDING_SPEED],
                        law->c[STEP_STICTION_SPEED]);
}

static inline struct scree_tangential friction_step_force(const struct scree_law_constants *law,
                                                          struct scree_pair_constants pair, struct scree_sliding at) {
    (void)pair;
    double speed = vec_norm(at.velocity);
    double vs = law->c[STEP_STICTION_SPEED], vd = law->c[STEP_SLIDING_SPEED], s = law->c[STEP_STATIC];
    double w = speed / vs;
    double rising = s * w * (1.5 - 0.5 * w * w);
    double falling = s - (s - law->c[STEP_KINETIC]) * scree_step((speed - vs) / (vd - vs));
    return scree_against(at, w < 1.0 ? rising : falling, speed);
}

static inline double friction_step_slope(const struct scree_law_constants *law) {
    return 1.5 * law->c[STEP_STATIC] / law->c[STEP_STICTION_SPEED];
}

static const struct scree_friction_law scree_friction_step = {
    .text = {.name = "step",
             .formula =
                 "mu = mu_s (3w - w^3)/2, w = v/v_s, up to v_s; cubic step from mu_s to mu_k between v_s and v_d",
             .source = "MSC Adams/Solver, CONTACT statement, Coulomb friction",
             .note = "Smooth. Creeps at rest: under a share r < 1 of the largest friction force at 2 v_s "
                     "sin(arcsin(r)/3).",
             .parameters = step_parameters},
    .bake = friction_step_bake,
    .force = friction_step_force,
    .stored = scree_no_store,
    .slope = friction_step_slope,
    .stiffness = scree_no_stiffness,
    .damping = scree_no_stiffness,
};

#endif
