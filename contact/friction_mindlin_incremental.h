/* Mindlin's no-slip contact with its memory in the force ("inc"): only new stretch meets the stiffness of the moment.
 *   dF = -k_t(d) dx, k_t = 8 G* sqrt(R d); F - c_t v is cut to mu_s N, then mu_k N while sliding (contact/mindlin.h)
 * As in EDEM and Yade, without the rescaling that some add when the load falls. What is kept is the force of the
 * spring, in N. Stretching at a high load and going back at a low one gains energy (Elata & Berryman, Mech. Mater. 24
 * (1996) 229): the law is passive at constant load only. */
#ifndef SCREE_CONTACT_FRICTION_MINDLIN_INCREMENTAL_H
#define SCREE_CONTACT_FRICTION_MINDLIN_INCREMENTAL_H

#include "contact/mindlin.h"
#include "contact/slider.h"

/* The step of a spring whose force is kept. Up to mid-step it goes by the stiffness `early` (N/m) of half way there:
 * near the touch that of mid-step would make it break loose by mistake. */
static inline struct scree_tangential mindlin_in_force(const struct scree_law_constants *law,
                                                       struct scree_pair_constants pair, struct scree_sliding at,
                                                       double early) {
    double k = mindlin_stiffness(law, pair, at.overlap);
    /* The stretch that would carry the force at this stiffness: from there on it is the same slider. */
    at.stretch = vec_scale(1.0 / k, at.stretch);
    double c = mindlin_damping(law, pair, at.overlap);
    struct scree_slider slider = scree_slider_of(at, k, c, mindlin_hold(law, at));
    slider.drag += at.sliding > 0.0 ? 0.0 : at.half * (early - k);
    struct scree_tangential f = scree_slide(at, slider);
    f.stretch = vec_scale(k, f.stretch);
    return f;
}

static inline struct scree_tangential friction_mindlin_incremental_force(const struct scree_law_constants *law,
                                                                         struct scree_pair_constants pair,
                                                                         struct scree_sliding at) {
    double early = mindlin_stiffness(law, pair, at.overlap - 0.5 * at.half * at.closing);
    return mindlin_in_force(law, pair, at, early);
}

static inline double friction_mindlin_incremental_stored(const struct scree_law_constants *law,
                                                         struct scree_pair_constants pair, struct scree_sliding at) {
    return 0.5 * vec_norm2(at.stretch) / mindlin_stiffness(law, pair, at.overlap);
}

static const struct scree_friction_law scree_friction_mindlin_incremental = {
    .text = {.name = "mindlin-incremental",
             .formula = "dF = -k_t dx, k_t = 8 G* sqrt(R d), while |F - c_t v| <= mu_s N, else |F| = mu_k N",
             .source = "Mindlin, J. Appl. Mech. 16 (1949) 259; memory in the force",
             .note =
                 "Truly sticks. Memory in the force: unlike mindlin, the force stays while the load changes and the "
                 "contact sticks. Passive at constant load. c_t = 2 zeta sqrt(m k_t). For Hertz's contact.",
             .example = "static = 0.4, kinetic = 0.3, shear_modulus = 4e8, damping = 0.1",
             .parameters = mindlin_parameters},
    .memory = 1,
    .in_force = 1,
    .root = 2,
    .bake = mindlin_bake,
    .pair = mindlin_pair,
    .force = friction_mindlin_incremental_force,
    .hold = mindlin_hold,
    .stored = friction_mindlin_incremental_stored,
    .slope = scree_zero,
    .stiffness = mindlin_stiffness,
    .damping = mindlin_damping,
};

#endif
