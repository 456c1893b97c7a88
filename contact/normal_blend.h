/* Power-law spring with a dashpot that is blended in over the first part of the overlap and acts on approach only, so
 * that the force has no jump at the first touch.
 *   F = k d^p + c max(u, 0) S(d/d_full),  S(w) = 3 w^2 - 2 w^3 between 0 and 1
 * Troll et al., Adv. Mech. Eng. (2018), doi 10.1177/1687814018754953, non-linear contact force. */
#ifndef SCREE_CONTACT_NORMAL_BLEND_H
#define SCREE_CONTACT_NORMAL_BLEND_H

#include "contact/law.h"

enum { BLEND_STIFFNESS, BLEND_EXPONENT, BLEND_DAMPING, BLEND_FULL };

static const struct scree_parameter blend_parameters[] = {
    {.name = "stiffness", .unit = "N/m^p", .meaning = "spring k", .range = SCREE_ANY_POSITIVE, .shared = 1},
    {.name = "exponent",
     .unit = "1",
     .meaning = "exponent p of the overlap",
     .range = SCREE_FROM_ONE_TO_3,
     .optional = 1,
     .fallback = 1.0},
    {.name = "damping",
     .unit = "N s/m",
     .meaning = "dashpot c at full overlap",
     .range = SCREE_NOT_NEGATIVE,
     .shared = 1},
    {.name = "full",
     .unit = "m",
     .meaning = "overlap d_full from which the dashpot acts fully",
     .range = SCREE_ANY_POSITIVE},
    {0}};

static inline scree_status normal_blend_bake(const struct scree_values *values, struct scree_law_constants *law,
                                             scree_trouble *trouble) {
    (void)trouble;
    for (int k = 0; k < 4; k++) law->c[k] = values->v[k];
    law->exponent = scree_exponent_of(law->c[BLEND_EXPONENT]);
    return SCREE_OK;
}

static SCREE_INLINE struct scree_normal_force
normal_blend_force(const struct scree_law_constants *law, struct scree_pair_constants pair, struct scree_pressing at) {
    (void)pair;
    double touching = at.overlap > 0.0 ? at.overlap : 0.0;
    double spring = law->c[BLEND_STIFFNESS] * scree_power(touching, law->c[BLEND_EXPONENT], law->exponent);
    double dashpot = law->c[BLEND_DAMPING] * scree_step(at.overlap / law->c[BLEND_FULL]);
    double approaching = at.closing > 0.0 ? 1.0 : 0.0;
    return (struct scree_normal_force){spring, approaching * dashpot, spring, 0.0, 0.0};
}

static SCREE_INLINE double normal_blend_stored(const struct scree_law_constants *law, struct scree_pair_constants pair,
                                               struct scree_pressing at) {
    (void)pair;
    double p = law->c[BLEND_EXPONENT];
    return law->c[BLEND_STIFFNESS] * at.overlap * scree_power(at.overlap, p, law->exponent) / (p + 1.0);
}

/* Where the dashpot has come in fully. */
static SCREE_INLINE int normal_blend_bends(const struct scree_law_constants *law, struct scree_pair_constants pair,
                                           struct scree_pressing from, struct scree_pressing to) {
    (void)pair;
    return scree_between(from.overlap, to.overlap, law->c[BLEND_FULL]);
}

static const struct scree_normal_law scree_normal_blend = {
    .text = {.name = "blend",
             .formula = "F = k d^p + c max(u, 0) S(d/d_full), S(w) = 3 w^2 - 2 w^3",
             .source = "Troll et al., Adv. Mech. Eng. (2018), doi 10.1177/1687814018754953",
             .note =
                 "Continuous at first touch; damped while approaching only; never pulls. Restitution falls with impact "
                 "speed while the overlap stays below d_full; it has no closed form, so the damping must be given.",
             .example = "stiffness = 1e5, damping = 65.4, full = 2e-4",
             .parameters = blend_parameters},
    .cut = 0,
    .raises = 1,
    .bake = normal_blend_bake,
    .pair = scree_any_pair,
    .force = normal_blend_force,
    .stored = normal_blend_stored,
    .bends = normal_blend_bends,
};

#endif
