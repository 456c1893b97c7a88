/* Rolling resistance of constant torque (type A): against the rolling, whatever its speed.
 *   M = -mu_r R N w/|w|, w the relative angular velocity across the normal; twisting likewise along it
 * J. Ai, J.-F. Chen, J. M. Rotter & J. Y. Ooi, "Assessment of rolling resistance models in discrete element
 * simulations", Powder Technol. 206 (2011) 269, model A; Y. C. Zhou et al., Physica A 269 (1999) 536. As published the
 * torque jumps at w = 0, so a ball that has come to rest chatters, at up to M h/I rad/s, and doesn't hold on a slope
 * without that. `threshold` puts a ramp in place of the jump: then it creeps instead. spring-dashpot truly rests. */
#ifndef SCREE_CONTACT_ROLLING_CONSTANT_H
#define SCREE_CONTACT_ROLLING_CONSTANT_H

#include "contact/law.h"

enum { ROLLING_CONSTANT_THRESHOLD = SCREE_ROLLING_OWN };

static const struct scree_parameter rolling_constant_parameters[] = {
    {.name = "rolling", .unit = "1", .meaning = "coefficient mu_r of rolling", .range = SCREE_NOT_NEGATIVE},
    {.name = "twisting",
     .unit = "1",
     .meaning = "coefficient of twisting, torque over R N",
     .range = SCREE_NOT_NEGATIVE,
     .optional = 1,
     .fallback = 0.0},
    {.name = "threshold",
     .unit = "m/s",
     .meaning = "R w at which the torque is reached; 0: at once, as published",
     .range = SCREE_NOT_NEGATIVE,
     .optional = 1,
     .fallback = 0.0},
    {0}};

static inline scree_status rolling_constant_bake(const struct scree_values *values, struct scree_law_constants *law,
                                                 scree_trouble *trouble) {
    (void)trouble;
    for (int k = 0; k < 3; k++) law->c[k] = values->v[k];
    return SCREE_OK;
}

static inline struct scree_tangential rolling_constant_resist(const struct scree_law_constants *law, double coefficient,
                                                              struct scree_sliding at) {
    double speed = vec_norm(at.velocity), threshold = law->c[ROLLING_CONSTANT_THRESHOLD];
    return scree_against(at, coefficient * (speed < threshold ? speed / threshold : 1.0), speed);
}

static inline double rolling_constant_slope(const struct scree_law_constants *law) {
    double largest = fmax(law->c[SCREE_ROLLING_COEFFICIENT], law->c[SCREE_TWISTING_COEFFICIENT]);
    double threshold = law->c[ROLLING_CONSTANT_THRESHOLD];
    return threshold > 0.0 ? largest / threshold : 0.0;
}

static const struct scree_rolling_law scree_rolling_constant = {
    .text = {.name = "constant",
             .formula = "M = -mu_r R N w/|w|",
             .source = "Ai, Chen, Rotter & Ooi, Powder Technol. 206 (2011) 269, model A",
             .note = "The torque jumps at w = 0: a ball at rest chatters within a step. With a threshold it creeps "
                     "instead.",
             .example = "rolling = 0.05, twisting = 0.02, threshold = 1e-3",
             .parameters = rolling_constant_parameters},
    .bake = rolling_constant_bake,
    .resist = rolling_constant_resist,
    .stiffness = scree_zero,
    .damping = scree_zero,
    .slope = rolling_constant_slope,
};

#endif
