/* IMPACT, the contact force of multibody codes.
 *   F = max(0, k d^p + STEP(d; 0, 0; d_full, c) u),  STEP = c (3 w^2 - 2 w^3), w = d/d_full between 0 and 1
 * MSC Adams/Solver, functions IMPACT and STEP. */
#ifndef SCREE_CONTACT_NORMAL_IMPACT_H
#define SCREE_CONTACT_NORMAL_IMPACT_H

#include "contact/normal_blend.h"

static SCREE_INLINE struct scree_normal_force
normal_impact_force(const struct scree_law_constants *law, struct scree_pair_constants pair, struct scree_pressing at) {
    (void)pair;
    double touching = at.overlap > 0.0 ? at.overlap : 0.0;
    double spring = law->c[BLEND_STIFFNESS] * scree_power(touching, law->c[BLEND_EXPONENT], law->exponent);
    double dashpot = law->c[BLEND_DAMPING] * scree_step(at.overlap / law->c[BLEND_FULL]);
    return (struct scree_normal_force){spring, dashpot, spring, 0.0, 0.0};
}

static const struct scree_normal_law scree_normal_impact = {
    .text = {.name = "impact",
             .formula = "F = max(0, k d^p + c u S(d/d_full)), S(w) = 3 w^2 - 2 w^3",
             .source = "MSC Adams/Solver, functions IMPACT and STEP",
             .note = "Continuous at first touch; damped both ways; never pulls. Restitution depends on impact speed "
                     "and has no closed form, so the damping must be given.",
             .example = "stiffness = 1e5, exponent = 1.0, damping = 30.0, full = 2e-4",
             .parameters = blend_parameters},
    .cut = 1,
    .turns_smoothly = 1,
    .raises = 1,
    .bake = normal_blend_bake,
    .pair = scree_any_pair,
    .force = normal_impact_force,
    .stored = normal_blend_stored,
    .bends = normal_blend_bends,
};

#endif
