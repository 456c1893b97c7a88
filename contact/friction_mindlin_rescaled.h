/* Mindlin's no-slip contact that never gives back more than it took: memory in the force while the load grows, in the
 * stretch while it falls.
 *   dF = -k_t(d) dx while d grows;  F falls with k_t while d falls;  k_t = 8 G* sqrt(R d) (contact/mindlin.h)
 * As Walton & Braun, J. Rheol. 30 (1986) 949, and Thornton, Cummins & Cleary, Powder Technol. 233 (2013) 30, rescale
 * the force when the contact unloads. What is kept is the force of the spring, in N. Growing load keeps F and lowers
 * the energy F^2/(2 k_t), falling load keeps F/k_t and lowers k_t, so that what the change of stiffness does is only
 * ever a loss. */
#ifndef SCREE_CONTACT_FRICTION_MINDLIN_RESCALED_H
#define SCREE_CONTACT_FRICTION_MINDLIN_RESCALED_H

#include "contact/friction_mindlin_incremental.h"

/* k_t(d2)/k_t(d1) where the overlap falls from d1 to d2; 1 where it doesn't. */
static inline double mindlin_rescaled_share(double sooner, double later) {
    double share = later > 0.0 ? later / (sooner + SCREE_NO_SPEED) : 0.0;
    return sqrt(share);
}

static inline struct scree_tangential friction_mindlin_rescaled_force(const struct scree_law_constants *law,
                                                                      struct scree_pair_constants pair,
                                                                      struct scree_sliding at) {
    double fall = at.closing < 0.0 ? -at.closing * at.half : 0.0; /* of the overlap in half a step */
    /* A force that has slid is one of mid-step (slider.h). */
    double since = at.sliding > 0.0 ? 2.0 * fall : fall;
    at.stretch = vec_scale(mindlin_rescaled_share(at.overlap + since, at.overlap), at.stretch);
    double grown = at.closing > 0.0 ? at.closing * at.half : 0.0;
    struct scree_tangential f = mindlin_in_force(law, pair, at, mindlin_stiffness(law, pair, at.overlap - 0.5 * grown));
    double until = f.sliding > 0.0 ? 0.0 : fall;
    f.stretch = vec_scale(mindlin_rescaled_share(at.overlap, at.overlap - until), f.stretch);
    return f;
}

static const struct scree_friction_law scree_friction_mindlin_rescaled = {
    .text = {.name = "mindlin-rescaled",
             .formula = "dF = -k_t dx while d grows, F = -k_t s while it falls, k_t = 8 G* sqrt(R d); "
                        "|F - c_t v| <= mu_s N, else |F| = mu_k N",
             .source =
                 "Walton & Braun, J. Rheol. 30 (1986) 949; Thornton, Cummins & Cleary, Powder Technol. 233 (2013) "
                 "30",
             .note = "Truly sticks. Never gives back more energy than it took, unlike mindlin and mindlin-incremental "
                     "where the load changes. c_t = 2 zeta sqrt(m k_t). For Hertz's contact.",
             .example = "static = 0.4, kinetic = 0.3, shear_modulus = 4e8",
             .parameters = mindlin_parameters},
    .memory = 1,
    .in_force = 1,
    .rescaled = 1,
    .root = 2,
    .bake = mindlin_bake,
    .pair = mindlin_pair,
    .force = friction_mindlin_rescaled_force,
    .hold = mindlin_hold,
    .stored = friction_mindlin_incremental_stored,
    .slope = scree_zero,
    .stiffness = mindlin_stiffness,
    .damping = mindlin_damping,
};

#endif
