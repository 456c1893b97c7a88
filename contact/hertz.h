/* What the laws on Hertz's spring share: its stiffness, from the moduli of the bodies or given, and its energy.
 *   F = K d^(3/2),  K = (4/3) E* sqrt(R*),  1/E* = (1 - nu1^2)/E1 + (1 - nu2^2)/E2,  1/R* = 1/R1 + 1/R2
 * H. Hertz, J. reine angew. Math. 92 (1882) 156; K. L. Johnson, Contact Mechanics (1985), ch. 4. */
#ifndef SCREE_CONTACT_HERTZ_H
#define SCREE_CONTACT_HERTZ_H

#include "contact/law.h"

/* The first two parameters of every law on Hertz's spring, and its first two constants. */
enum { HERTZ_GIVEN_MODULUS, HERTZ_GIVEN_STIFFNESS, HERTZ_GIVEN };
enum { HERTZ_MODULUS, HERTZ_FIXED, HERTZ_CONSTANTS }; /* law constants: one of the two is 0 */
enum { HERTZ_STIFFNESS, HERTZ_PAIR_CONSTANTS };       /* pair constants */

#define HERTZ_PARAMETERS                                                                                               \
    {.name = "modulus",                                                                                                \
     .unit = "Pa",                                                                                                     \
     .meaning = "effective modulus E*",                                                                                \
     .range = SCREE_ANY_POSITIVE,                                                                                      \
     .material = SCREE_FROM_MODULUS,                                                                                   \
     .shared = 1},                                                                                                     \
    {                                                                                                                  \
        .name = "stiffness", .unit = "N/m^1.5", .meaning = "spring K", .range = SCREE_ANY_POSITIVE,                    \
        .instead_of = "modulus", .shared = 1                                                                           \
    }

static inline void hertz_bake(const struct scree_values *values, struct scree_law_constants *law) {
    double modulus = values->v[HERTZ_GIVEN_MODULUS], stiffness = values->v[HERTZ_GIVEN_STIFFNESS];
    law->c[HERTZ_MODULUS] = isnan(modulus) ? 0.0 : modulus;
    law->c[HERTZ_FIXED] = isnan(modulus) ? stiffness : 0.0;
}

static inline double hertz_stiffness(const struct scree_law_constants *law, double radius) {
    return law->c[HERTZ_FIXED] + 4.0 / 3.0 * law->c[HERTZ_MODULUS] * sqrt(radius);
}

static inline struct scree_pair_constants hertz_pair(const struct scree_law_constants *law, double mass,
                                                     double radius) {
    (void)mass;
    return (struct scree_pair_constants){{hertz_stiffness(law, radius)}};
}

/* `root`: of the overlap, 0 where there is none. */
static SCREE_INLINE double hertz_spring(struct scree_pair_constants pair, double overlap, double root) {
    return pair.c[HERTZ_STIFFNESS] * overlap * root;
}

static SCREE_INLINE double hertz_stored(const struct scree_law_constants *law, struct scree_pair_constants pair,
                                        struct scree_pressing at) {
    (void)law;
    double d = at.overlap > 0.0 ? at.overlap : 0.0;
    return 0.4 * pair.c[HERTZ_STIFFNESS] * d * d * sqrt(d);
}

#endif
