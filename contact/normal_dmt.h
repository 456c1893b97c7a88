/* Hertz's contact with a constant pull: adhesion of hard, small bodies.
 *   F = K d^(3/2) - 2 pi w R* while d > 0
 * Derjaguin, Muller & Toporov, J. Colloid Interface Sci. 53 (1975) 314. The contact ends at zero overlap, where it
 * pulls with 2 pi w R*, as it did when it began: restitution 1. */
#ifndef SCREE_CONTACT_NORMAL_DMT_H
#define SCREE_CONTACT_NORMAL_DMT_H

#include "contact/hertz.h"

enum { DMT_GIVEN_WORK = HERTZ_GIVEN };
enum { DMT_WORK = HERTZ_CONSTANTS };
enum { DMT_PULL = HERTZ_PAIR_CONSTANTS };

static const struct scree_parameter dmt_parameters[] = {
    HERTZ_PARAMETERS,
    {.name = "adhesion", .unit = "J/m^2", .meaning = "work of adhesion w", .range = SCREE_NOT_NEGATIVE, .shared = 1},
    {0}};

static inline struct scree_pair_constants dmt_pair(const struct scree_law_constants *law, double mass, double radius) {
    (void)mass;
    return (struct scree_pair_constants){
        {hertz_stiffness(law, radius), 2.0 * 3.14159265358979323846 * law->c[DMT_WORK] * radius}};
}

static SCREE_INLINE double dmt_stored(const struct scree_law_constants *law, struct scree_pair_constants pair,
                                      struct scree_pressing at) {
    double d = at.overlap > 0.0 ? at.overlap : 0.0;
    return hertz_stored(law, pair, at) - pair.c[DMT_PULL] * d;
}

static inline double dmt_jump(const struct scree_law_constants *law, struct scree_pair_constants pair, int ends) {
    (void)law;
    (void)ends;
    return -pair.c[DMT_PULL];
}

static inline scree_status normal_dmt_bake(const struct scree_values *values, struct scree_law_constants *law,
                                           scree_trouble *trouble) {
    (void)trouble;
    hertz_bake(values, law);
    law->c[DMT_WORK] = values->v[DMT_GIVEN_WORK];
    return SCREE_OK;
}

static SCREE_INLINE struct scree_normal_force
normal_dmt_force(const struct scree_law_constants *law, struct scree_pair_constants pair, struct scree_pressing at) {
    (void)law;
    double d = at.overlap > 0.0 ? at.overlap : 0.0;
    double force = pair.c[HERTZ_STIFFNESS] * d * sqrt(d) - pair.c[DMT_PULL];
    return (struct scree_normal_force){force, 0.0, force, 0.0, 0.0};
}

static inline double normal_dmt_restitution(const struct scree_law_constants *law, struct scree_pair_constants pair,
                                            double mass, double speed) {
    (void)law;
    (void)pair;
    (void)mass;
    (void)speed;
    return 1.0;
}

static const struct scree_normal_law scree_normal_dmt = {
    .text = {.name = "dmt",
             .formula = "F = K d^(3/2) - 2 pi w R* while d > 0, K = (4/3) E* sqrt(R*)",
             .source = "Derjaguin, Muller & Toporov, J. Colloid Interface Sci. 53 (1975) 314",
             .note = "Adhesion of hard, small bodies: pulls with 2 pi w R* from the first touch on, and ends at "
                     "d = 0 with that force. Elastic: restitution 1. Rests at the overlap (2 pi w R*/K)^(2/3).",
             .parameters = dmt_parameters,
             .example = "stiffness = 5e6, adhesion = 20.0"},
    .cut = 0,
    .turns_smoothly = 1,
    .bake = normal_dmt_bake,
    .pair = dmt_pair,
    .force = normal_dmt_force,
    .stored = dmt_stored,
    .jump = dmt_jump,
    .restitution = normal_dmt_restitution,
};

#endif
