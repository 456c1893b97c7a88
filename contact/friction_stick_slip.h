/* Static and kinetic friction told apart by a speed threshold, piecewise linear.
 *   mu(v) runs through (0, 0), (v_th, mu_s), (1.5 v_th, mu_k) and stays at mu_k beyond
 * Simscape Multibody Contact Forces Library, "Stick-Slip Continuous"; Troll et al., Adv. Mech. Eng. (2018). */
#ifndef SCREE_CONTACT_FRICTION_STICK_SLIP_H
#define SCREE_CONTACT_FRICTION_STICK_SLIP_H

#include "contact/law.h"

enum { STICK_SLIP_STATIC, STICK_SLIP_KINETIC, STICK_SLIP_THRESHOLD };

static const struct scree_parameter stick_slip_parameters[] = {
    {.name = "static", .unit = "1", .meaning = "coefficient mu_s at the threshold", .range = SCREE_NOT_NEGATIVE},
    {.name = "kinetic", .unit = "1", .meaning = "coefficient mu_k while sliding", .range = SCREE_NOT_NEGATIVE},
    {.name = "threshold", .unit = "m/s", .meaning = "speed v_th of the largest friction", .range = SCREE_ANY_POSITIVE},
    {0}};

static inline scree_status friction_stick_slip_bake(const struct scree_values *values, struct scree_law_constants *law,
                                                    scree_trouble *trouble) {
    for (int k = 0; k < 3; k++) law->c[k] = values->v[k];
    return scree_check_static(law->c[STICK_SLIP_STATIC], law->c[STICK_SLIP_KINETIC], trouble);
}

static inline struct scree_tangential friction_stick_slip_force(const struct scree_law_constants *law,
                                                                struct scree_pair_constants pair,
                                                                struct scree_sliding at) {
    (void)pair;
    double speed = vec_norm(at.velocity);
    double w = speed / law->c[STICK_SLIP_THRESHOLD];
    double fall = 2.0 * (w - 1.0); /* 0 at the threshold, 1 at 1.5 times the threshold */
    fall = fall < 1.0 ? fall : 1.0;
    double drop = law->c[STICK_SLIP_STATIC] - law->c[STICK_SLIP_KINETIC];
    double mu = w < 1.0 ? law->c[STICK_SLIP_STATIC] * w : law->c[STICK_SLIP_STATIC] - drop * fall;
    return scree_against(at, mu, speed);
}

static inline double friction_stick_slip_slope(const struct scree_law_constants *law) {
    return law->c[STICK_SLIP_STATIC] / law->c[STICK_SLIP_THRESHOLD];
}

static const struct scree_friction_law scree_friction_stick_slip = {
    .text = {.name = "stick-slip",
             .formula = "mu through (0, 0), (v_th, mu_s), (1.5 v_th, mu_k), constant beyond",
             .source = "Simscape Multibody Contact Forces Library, Stick-Slip Continuous; Troll et al., Adv. "
                       "Mech. Eng. (2018)",
             .note = "Creeps at rest: on an incline at v = v_th tan(angle)/mu_s.",
             .parameters = stick_slip_parameters},
    .bake = friction_stick_slip_bake,
    .force = friction_stick_slip_force,
    .stored = scree_no_store,
    .slope = friction_stick_slip_slope,
    .stiffness = scree_no_stiffness,
    .damping = scree_no_stiffness,
};

#endif
