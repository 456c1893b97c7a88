/* What the laws with Tsuji's dashpot on Hertz's spring share.
 *   F = K d^(3/2) + alpha sqrt(m K) d^(1/4) u
 * With x = (4/5) d^(5/4) and d(tau) = d^(1/4) sqrt(K/m) dt it becomes x'' + alpha x' + (5/4) x = 0: a linear spring and
 * dashpot of zeta = alpha/sqrt(5), met and left at the same speeds; and F = 0 where x'' = 0. So the restitution is that
 * of the linear law with the same end (Antypov & Elliott, Europhys. Lett. 94 (2011) 50004, for the end at zero
 * overlap), whatever the speed. */
#ifndef SCREE_CONTACT_TSUJI_H
#define SCREE_CONTACT_TSUJI_H

#include "contact/hertz.h"
#include "contact/linear.h"

enum { TSUJI_GIVEN_RESTITUTION = HERTZ_GIVEN, TSUJI_GIVEN_ALPHA };
enum { TSUJI_ALPHA = HERTZ_CONSTANTS };
enum { TSUJI_DAMPING = HERTZ_PAIR_CONSTANTS };

static const struct scree_parameter tsuji_parameters[] = {
    HERTZ_PARAMETERS,
    {.name = "restitution",
     .unit = "1",
     .meaning = "restitution e wanted",
     .range = SCREE_FRACTION,
     .instead_of = "alpha"},
    {.name = "alpha", .unit = "1", .meaning = "damping alpha", .range = SCREE_NOT_NEGATIVE},
    {0}};

/* `zeta` is the damping ratio that gives the wanted restitution; it counts only if that was given. */
static inline void tsuji_bake(const struct scree_values *values, struct scree_law_constants *law, double zeta) {
    int wanted = !isnan(values->v[TSUJI_GIVEN_RESTITUTION]);
    hertz_bake(values, law);
    law->c[TSUJI_ALPHA] = wanted ? sqrt(5.0) * zeta : values->v[TSUJI_GIVEN_ALPHA];
}

static inline struct scree_pair_constants tsuji_pair(const struct scree_law_constants *law, double mass,
                                                     double radius) {
    double stiffness = hertz_stiffness(law, radius);
    return (struct scree_pair_constants){{stiffness, law->c[TSUJI_ALPHA] * sqrt(mass * stiffness)}};
}

static SCREE_INLINE struct scree_normal_force tsuji_force(struct scree_pair_constants pair, struct scree_pressing at) {
    double root = scree_square_root(at.roots, at.overlap), spring = hertz_spring(pair, at.overlap, root);
    double damping = pair.c[TSUJI_DAMPING] * scree_fourth_root(at.roots, at.overlap);
    return (struct scree_normal_force){spring, damping, spring, 0.0, 0.0};
}

static inline double tsuji_zeta(const struct scree_law_constants *law) { return law->c[TSUJI_ALPHA] / sqrt(5.0); }

#endif
