/* A power-law spring with the dashpot that matches it, so that the restitution is the same at every speed.
 *   F = k d^p + alpha sqrt(m k) d^((p-1)/2) u
 * With x = d^((p+1)/2) it becomes a linear spring and dashpot of zeta = alpha/sqrt(2 (p + 1)), met and left at the same
 * speeds, with F = 0 where x'' = 0 (as for p = 3/2: contact/tsuji.h). */
#ifndef SCREE_CONTACT_MATCHED_H
#define SCREE_CONTACT_MATCHED_H

#include "contact/linear.h"

enum { MATCHED_GIVEN_STIFFNESS, MATCHED_GIVEN_EXPONENT, MATCHED_GIVEN_RESTITUTION, MATCHED_GIVEN_ALPHA };
enum { MATCHED_STIFFNESS, MATCHED_EXPONENT, MATCHED_ALPHA, MATCHED_ZETA };
enum { MATCHED_DAMPING };

static const struct scree_parameter matched_parameters[] = {
    {.name = "stiffness", .unit = "N/m^p", .meaning = "spring k", .range = SCREE_ANY_POSITIVE, .shared = 1},
    {.name = "exponent", .unit = "1", .meaning = "exponent p of the overlap", .range = SCREE_FROM_ONE_TO_3},
    {.name = "restitution",
     .unit = "1",
     .meaning = "restitution e wanted",
     .range = SCREE_FRACTION,
     .instead_of = "alpha"},
    {.name = "alpha", .unit = "1", .meaning = "damping alpha", .range = SCREE_NOT_NEGATIVE},
    {0}};

/* `zeta` is the damping ratio that gives the wanted restitution; it counts only if that was given. */
static inline void matched_bake(const struct scree_values *values, struct scree_law_constants *law, double zeta) {
    double alpha = values->v[MATCHED_GIVEN_ALPHA], root = sqrt(2.0 * (values->v[MATCHED_GIVEN_EXPONENT] + 1.0));
    law->c[MATCHED_STIFFNESS] = values->v[MATCHED_GIVEN_STIFFNESS];
    law->c[MATCHED_EXPONENT] = values->v[MATCHED_GIVEN_EXPONENT];
    law->exponent = scree_exponent_of(law->c[MATCHED_EXPONENT]);
    law->c[MATCHED_ALPHA] = isnan(alpha) ? zeta * root : alpha;
    law->c[MATCHED_ZETA] = isnan(alpha) ? zeta : alpha / root;
}

static inline struct scree_pair_constants matched_pair(const struct scree_law_constants *law, double mass,
                                                       double radius) {
    (void)radius;
    return (struct scree_pair_constants){{law->c[MATCHED_ALPHA] * sqrt(mass * law->c[MATCHED_STIFFNESS])}};
}

static SCREE_INLINE struct scree_normal_force
matched_force(const struct scree_law_constants *law, struct scree_pair_constants pair, struct scree_pressing at) {
    double d = at.overlap > 0.0 ? at.overlap : 0.0, power = scree_power(d, law->c[MATCHED_EXPONENT], law->exponent);
    double spring = law->c[MATCHED_STIFFNESS] * power;
    /* d^((p-1)/2) = sqrt(d^p/d), 1 at d = 0 for p = 1 and 0 otherwise. */
    double root = law->exponent.one > 0.0 ? 1.0 : sqrt(power / (d + SCREE_NO_SPEED));
    return (struct scree_normal_force){spring, pair.c[MATCHED_DAMPING] * root, spring, 0.0, 0.0};
}

static SCREE_INLINE double matched_stored(const struct scree_law_constants *law, struct scree_pair_constants pair,
                                          struct scree_pressing at) {
    (void)pair;
    double d = at.overlap > 0.0 ? at.overlap : 0.0, p = law->c[MATCHED_EXPONENT];
    return law->c[MATCHED_STIFFNESS] * d * scree_power(d, p, law->exponent) / (p + 1.0);
}

#endif
