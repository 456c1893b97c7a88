/* Elastic-plastic rolling resistance (type C): a rolling spring and dashpot behind a slider that holds up to mu_r R N.
 *   M = -(k_r theta + c_r w), |M| <= mu_r R N;  k_r = k R^2, c_r = c R^2;  twisting likewise with its own coefficient
 * Ai et al., Powder Technol. 206 (2011) 269, model C, who put k_r = 2.25 k_n (mu_r R)^2, so k = 2.25 mu_r^2 k_n. There
 * the spring is cut and the dashpot off while it is; here both are behind the slider (contact/slider.h), so that the
 * torque is continuous. */
#ifndef SCREE_CONTACT_ROLLING_SPRING_DASHPOT_H
#define SCREE_CONTACT_ROLLING_SPRING_DASHPOT_H

#include "contact/slider.h"

enum { ROLLING_SPRING = SCREE_ROLLING_OWN, ROLLING_DASHPOT };

static const struct scree_parameter rolling_spring_dashpot_parameters[] = {
    {.name = "rolling", .unit = "1", .meaning = "coefficient mu_r of rolling", .range = SCREE_NOT_NEGATIVE},
    {.name = "twisting",
     .unit = "1",
     .meaning = "coefficient of twisting, torque over R N",
     .range = SCREE_NOT_NEGATIVE,
     .optional = 1,
     .fallback = 0.0},
    {.name = "stiffness",
     .unit = "N/m",
     .meaning = "k of the spring k_r = k R^2",
     .range = SCREE_ANY_POSITIVE,
     .shared = 1},
    {.name = "damping",
     .unit = "N s/m",
     .meaning = "c of the dashpot c_r = c R^2",
     .range = SCREE_NOT_NEGATIVE,
     .optional = 1,
     .fallback = 0.0,
     .shared = 1},
    {0}};

static inline scree_status rolling_spring_dashpot_bake(const struct scree_values *values,
                                                       struct scree_law_constants *law, scree_trouble *trouble) {
    (void)trouble;
    for (int k = 0; k < 4; k++) law->c[k] = values->v[k];
    return SCREE_OK;
}

static inline struct scree_tangential rolling_spring_dashpot_resist(const struct scree_law_constants *law,
                                                                    double coefficient, struct scree_sliding at) {
    double holds = coefficient * at.normal;
    return scree_slide(
        at, scree_slider_of(at, law->c[ROLLING_SPRING], law->c[ROLLING_DASHPOT], (struct scree_hold){holds, holds}));
}

static inline double rolling_spring_dashpot_stiffness(const struct scree_law_constants *law) {
    return law->c[ROLLING_SPRING];
}

static inline double rolling_spring_dashpot_damping(const struct scree_law_constants *law) {
    return law->c[ROLLING_DASHPOT];
}

static const struct scree_rolling_law scree_rolling_spring_dashpot = {
    .text = {.name = "spring-dashpot",
             .formula = "M = -(k_r theta + c_r w), |M| <= mu_r R N; k_r = k R^2, c_r = c R^2",
             .source = "Ai, Chen, Rotter & Ooi, Powder Technol. 206 (2011) 269, model C",
             .note = "Truly rests, on slopes up to tan(angle) = mu_r. Ai et al. take k = 2.25 mu_r^2 times the normal "
                     "stiffness.",
             .example = "rolling = 0.05, twisting = 0.02, stiffness = 1e3, damping = 0.5",
             .parameters = rolling_spring_dashpot_parameters},
    .memory = 1,
    .bake = rolling_spring_dashpot_bake,
    .resist = rolling_spring_dashpot_resist,
    .stiffness = rolling_spring_dashpot_stiffness,
    .damping = rolling_spring_dashpot_damping,
    .slope = scree_zero,
};

#endif
