/* What the three linear laws share: parameters, constants and energy. They differ in when the dashpot acts and in
 * what ends the contact, and so in the restitution that one dashpot gives. */
#ifndef SCREE_CONTACT_LINEAR_H
#define SCREE_CONTACT_LINEAR_H

#include "contact/law.h"

enum { LINEAR_GIVEN_STIFFNESS, LINEAR_GIVEN_RESTITUTION, LINEAR_GIVEN_DAMPING };
enum { LINEAR_STIFFNESS, LINEAR_FIXED_DAMPING, LINEAR_TWO_ZETA }; /* law constants */
enum { LINEAR_DAMPING };                                          /* pair constants */

static const struct scree_parameter linear_parameters[] = {
    {.name = "stiffness", .unit = "N/m", .meaning = "spring k", .range = SCREE_ANY_POSITIVE, .shared = 1},
    {.name = "restitution",
     .unit = "1",
     .meaning = "restitution e wanted for the pair's effective mass",
     .range = SCREE_FRACTION,
     .instead_of = "damping"},
    {.name = "damping", .unit = "N s/m", .meaning = "dashpot c", .range = SCREE_NOT_NEGATIVE, .shared = 1},
    {0}};

/* `zeta` is the damping ratio that gives the wanted restitution; it counts only if that was given. */
static inline void linear_bake(const struct scree_values *values, struct scree_law_constants *law, double zeta) {
    int wanted = !isnan(values->v[LINEAR_GIVEN_RESTITUTION]);
    law->c[LINEAR_STIFFNESS] = values->v[LINEAR_GIVEN_STIFFNESS];
    law->c[LINEAR_FIXED_DAMPING] = wanted ? 0.0 : values->v[LINEAR_GIVEN_DAMPING];
    law->c[LINEAR_TWO_ZETA] = wanted ? 2.0 * zeta : 0.0;
}

static inline struct scree_pair_constants linear_pair(const struct scree_law_constants *law, double mass,
                                                      double radius) {
    (void)radius;
    double critical = sqrt(law->c[LINEAR_STIFFNESS] * mass);
    return (struct scree_pair_constants){{law->c[LINEAR_FIXED_DAMPING] + law->c[LINEAR_TWO_ZETA] * critical}};
}

static SCREE_INLINE double linear_stored(const struct scree_law_constants *law, struct scree_pair_constants pair,
                                         struct scree_pressing at) {
    (void)pair;
    return 0.5 * law->c[LINEAR_STIFFNESS] * at.overlap * at.overlap;
}

static inline double linear_zeta(const struct scree_law_constants *law, struct scree_pair_constants pair, double mass) {
    return pair.c[LINEAR_DAMPING] / (2.0 * sqrt(law->c[LINEAR_STIFFNESS] * mass));
}

/* Damping ratio that gives restitution e where the contact ends at zero overlap, and the other way round. */
static inline double linear_zeta_pulling(double e) { return -log(e) / hypot(3.14159265358979323846, log(e)); }

static inline double linear_e_pulling(double zeta) {
    return zeta < 1.0 ? exp(-3.14159265358979323846 * zeta / sqrt((1.0 - zeta) * (1.0 + zeta))) : 0.0;
}

/* arccos(zeta)/sqrt(1 - zeta^2), continued beyond zeta = 1 by arcosh(zeta)/sqrt(zeta^2 - 1). */
static inline double linear_angle(double zeta) {
    double q = (1.0 - zeta) * (1.0 + zeta);
    if (q == 0.0) return 1.0;
    return q > 0.0 ? acos(zeta) / sqrt(q) : acosh(zeta) / sqrt(-q);
}

/* The zeta at which the falling function e(zeta) = exp(-factor zeta angle(zeta)) takes the value e in (0, 1]: bisection
 * until the interval stops shrinking, so to rounding. */
static inline double linear_invert(double e, double factor) {
    if (e == 1.0) return 0.0;
    double lost = -log(e), low = 0.0, high = 1.0;
    while (factor * high * linear_angle(high) < lost) high *= 2.0;
    for (int k = 0; k < 1100; k++) {
        double middle = 0.5 * (low + high);
        if (middle == low || middle == high) break;
        if (factor * middle * linear_angle(middle) < lost)
            low = middle;
        else
            high = middle;
    }
    return high;
}

#endif
