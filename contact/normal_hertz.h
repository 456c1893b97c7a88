/* Two elastic spheres.
 *   F = K d^(3/2),  K = (4/3) E* sqrt(R*)      Hertz, J. reine angew. Math. 92 (1882) 156
 * The contact ends at zero overlap, where the force is zero too; restitution 1, contact time 2.943 d_max/v. */
#ifndef SCREE_CONTACT_NORMAL_HERTZ_H
#define SCREE_CONTACT_NORMAL_HERTZ_H

#include "contact/hertz.h"

static const struct scree_parameter hertz_parameters[] = {HERTZ_PARAMETERS, {0}};

static inline scree_status normal_hertz_bake(const struct scree_values *values, struct scree_law_constants *law,
                                             scree_trouble *trouble) {
    (void)trouble;
    hertz_bake(values, law);
    return SCREE_OK;
}

static SCREE_INLINE struct scree_normal_force
normal_hertz_force(const struct scree_law_constants *law, struct scree_pair_constants pair, struct scree_pressing at) {
    (void)law;
    double spring = hertz_spring(pair, at.overlap, scree_square_root(at.roots, at.overlap));
    return (struct scree_normal_force){spring, 0.0, spring, 0.0, 0.0};
}

static inline double normal_hertz_restitution(const struct scree_law_constants *law, struct scree_pair_constants pair,
                                              double mass, double speed) {
    (void)law;
    (void)pair;
    (void)mass;
    (void)speed;
    return 1.0;
}

static const struct scree_normal_law scree_normal_hertz = {
    .text = {.name = "hertz",
             .formula = "F = K d^(3/2), K = (4/3) E* sqrt(R*)",
             .source = "Hertz, J. reine angew. Math. 92 (1882) 156",
             .note = "Elastic: restitution 1. The contact lasts 2.943 d_max/v, with d_max = (5 m v^2/(4 K))^(2/5).",
             .parameters = hertz_parameters,
             .example = "stiffness = 5e6"},
    .cut = 0,
    .turns_smoothly = 1,
    .takes_roots = 1,
    .bake = normal_hertz_bake,
    .pair = hertz_pair,
    .force = normal_hertz_force,
    .stored = hertz_stored,
    .restitution = normal_hertz_restitution,
};

#endif
