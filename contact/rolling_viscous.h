/* Viscous rolling resistance (type B): the torque grows with the rolling.
 *   M = -eta_r R N (R w), w the relative angular velocity across the normal; twisting likewise along it
 * Ai et al., Powder Technol. 206 (2011) 269, model B, who write w1 R1 - w2 R2 in place of R w: that doesn't vanish when
 * two bodies turn as one. */
#ifndef SCREE_CONTACT_ROLLING_VISCOUS_H
#define SCREE_CONTACT_ROLLING_VISCOUS_H

#include "contact/law.h"

static const struct scree_parameter rolling_viscous_parameters[] = {
    {.name = "rolling", .unit = "s/m", .meaning = "coefficient eta_r of rolling", .range = SCREE_NOT_NEGATIVE},
    {.name = "twisting",
     .unit = "s/m",
     .meaning = "coefficient of twisting",
     .range = SCREE_NOT_NEGATIVE,
     .optional = 1,
     .fallback = 0.0},
    {0}};

static inline scree_status rolling_viscous_bake(const struct scree_values *values, struct scree_law_constants *law,
                                                scree_trouble *trouble) {
    (void)trouble;
    for (int k = 0; k < 2; k++) law->c[k] = values->v[k];
    return SCREE_OK;
}

static inline struct scree_tangential rolling_viscous_resist(const struct scree_law_constants *law, double coefficient,
                                                             struct scree_sliding at) {
    (void)law;
    return (struct scree_tangential){vec_scale(-coefficient * at.normal, at.velocity), {0.0, 0.0, 0.0}, 0.0};
}

static inline double rolling_viscous_slope(const struct scree_law_constants *law) {
    return fmax(law->c[SCREE_ROLLING_COEFFICIENT], law->c[SCREE_TWISTING_COEFFICIENT]);
}

static const struct scree_rolling_law scree_rolling_viscous = {
    .text = {.name = "viscous",
             .formula = "M = -eta_r R N (R w)",
             .source = "Ai, Chen, Rotter & Ooi, Powder Technol. 206 (2011) 269, model B",
             .note = "Slows rolling down and never stops it; on a slope a ball rolls at a steady speed.",
             .example = "rolling = 0.5, twisting = 0.2",
             .parameters = rolling_viscous_parameters},
    .bake = rolling_viscous_bake,
    .resist = rolling_viscous_resist,
    .stiffness = scree_zero,
    .damping = scree_zero,
    .slope = rolling_viscous_slope,
};

#endif
