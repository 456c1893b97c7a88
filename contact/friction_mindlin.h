/* Mindlin's no-slip contact with its memory in the stretch ("tot"): the force follows the stiffness of the moment.
 *   F = -(k_t(d) s + c_t v), k_t = 8 G* sqrt(R d); cut to mu_s N, then mu_k N while sliding (contact/mindlin.h)
 * As in LIGGGHTS and MFiX: a total, not an increment. When the load falls, the force falls with k_t, and what the
 * spring loses is lost; when the load grows at a stretch that stands still, the spring gains energy that nothing pays
 * for. So the law is passive at constant load only. */
#ifndef SCREE_CONTACT_FRICTION_MINDLIN_H
#define SCREE_CONTACT_FRICTION_MINDLIN_H

#include "contact/mindlin.h"
#include "contact/slider.h"

static SCREE_INLINE struct scree_slider friction_mindlin_grip(const struct scree_law_constants *law,
                                                              struct scree_pair_constants pair,
                                                              struct scree_sliding at) {
    double k = mindlin_spring(pair, scree_square_root(at.roots, at.overlap));
    double c = mindlin_dashpot(pair, scree_fourth_root(at.roots, at.overlap));
    return scree_slider_of(at, k, c, mindlin_hold(law, at));
}

static SCREE_INLINE struct scree_tangential friction_mindlin_force(const struct scree_law_constants *law,
                                                                   struct scree_pair_constants pair,
                                                                   struct scree_sliding at) {
    return scree_slide(at, friction_mindlin_grip(law, pair, at));
}

static inline double friction_mindlin_stored(const struct scree_law_constants *law, struct scree_pair_constants pair,
                                             struct scree_sliding at) {
    return 0.5 * mindlin_stiffness(law, pair, at.overlap) * vec_norm2(at.stretch);
}

static const struct scree_friction_law scree_friction_mindlin = {
    .text = {.name = "mindlin",
             .formula = "F = -(k_t s + c_t v), k_t = 8 G* sqrt(R d), while |F| <= mu_s N, else |F| = mu_k N",
             .source = "Mindlin, J. Appl. Mech. 16 (1949) 259; memory in the stretch",
             .note =
                 "Truly sticks. Memory in the stretch: unlike mindlin-incremental, the force follows the load while "
                 "the contact sticks. Passive at constant load. c_t = 2 zeta sqrt(m k_t). For Hertz's contact.",
             .example = "static = 0.4, kinetic = 0.3, shear_modulus = 4e8",
             .parameters = mindlin_parameters},
    .memory = 1,
    .takes_roots = 1,
    .root = 2,
    .bake = mindlin_bake,
    .pair = mindlin_pair,
    .force = friction_mindlin_force,
    .grip = friction_mindlin_grip,
    .hold = mindlin_hold,
    .stored = friction_mindlin_stored,
    .slope = scree_zero,
    .stiffness = mindlin_stiffness,
    .damping = mindlin_damping,
};

#endif
