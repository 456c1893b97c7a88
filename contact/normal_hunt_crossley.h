/* Hunt & Crossley's law with a constant damping factor: restitution falls with impact speed.
 *   F = k d^n (1 + c u)                                  Hunt & Crossley, J. Appl. Mech. 42 (1975) 440
 *   c (v_i + v_o) = ln[(1 + c v_i)/(1 - c v_o)]          for any n; v_i, v_o speeds before and after
 * The second line follows from d(u)/dd = -k d^n (1 + c u)/(m u), whose variables separate. */
#ifndef SCREE_CONTACT_NORMAL_HUNT_CROSSLEY_H
#define SCREE_CONTACT_NORMAL_HUNT_CROSSLEY_H

#include "contact/law.h"

enum { HUNT_GIVEN_STIFFNESS, HUNT_GIVEN_EXPONENT, HUNT_GIVEN_RESTITUTION, HUNT_GIVEN_FACTOR, HUNT_GIVEN_SPEED };
enum { HUNT_STIFFNESS, HUNT_EXPONENT, HUNT_FACTOR };

static const struct scree_parameter hunt_parameters[] = {
    {.name = "stiffness", .unit = "N/m^n", .meaning = "spring k", .range = SCREE_ANY_POSITIVE, .shared = 1},
    {.name = "exponent",
     .unit = "1",
     .meaning = "exponent n of the overlap",
     .range = SCREE_FROM_ONE_TO_3,
     .optional = 1,
     .fallback = 1.5},
    {.name = "restitution",
     .unit = "1",
     .meaning = "restitution e wanted at impact speed `speed`",
     .range = SCREE_FRACTION,
     .instead_of = "factor"},
    {.name = "factor", .unit = "s/m", .meaning = "damping factor c", .range = SCREE_NOT_NEGATIVE},
    {.name = "speed",
     .unit = "m/s",
     .meaning = "impact speed at which `restitution` is wanted",
     .range = SCREE_ANY_POSITIVE,
     .optional = 1,
     .fallback = NAN},
    {0}};

/* ln(1 + x) - x, without cancellation near 0. */
static inline double hunt_log(double x) {
    if (fabs(x) > 0.1) return log1p(x) - x;
    double sum = 0.0, sign = 1.0;
    for (int k = 18; k >= 2; k--) {
        sum = sum * x + sign / k;
        sign = -sign;
    }
    return -sum * x * x;
}

/* The D = c v_i > 0 that gives restitution e = v_o/v_i: ln[(1 + D)/(1 - e D)] - D (1 + e) is negative below it and
 * positive above, up to its pole at D = 1/e. Bisection to rounding. */
static inline double hunt_damping(double e) {
    double low = 0.0, high = 1.0 / e;
    for (int k = 0; k < 200; k++) {
        double middle = 0.5 * (low + high);
        if (middle == low || middle == high) break;
        if (hunt_log(middle) - hunt_log(-e * middle) < 0.0)
            low = middle;
        else
            high = middle;
    }
    return 0.5 * (low + high);
}

static inline scree_status normal_hunt_crossley_bake(const struct scree_values *values, struct scree_law_constants *law,
                                                     scree_trouble *trouble) {
    double e = values->v[HUNT_GIVEN_RESTITUTION], speed = values->v[HUNT_GIVEN_SPEED];
    int wanted = !isnan(e);
    if (wanted && isnan(speed))
        return scree_report(trouble, SCREE_BAD_INPUT, "restitution",
                            "hunt-crossley's restitution depends on the impact speed: give `speed` (m/s) beside it");
    if (!wanted && !isnan(speed))
        return scree_report(trouble, SCREE_BAD_INPUT, "speed", "`speed` goes with `restitution`, not with `factor`");
    law->c[HUNT_STIFFNESS] = values->v[HUNT_GIVEN_STIFFNESS];
    law->c[HUNT_EXPONENT] = values->v[HUNT_GIVEN_EXPONENT];
    law->exponent = scree_exponent_of(law->c[HUNT_EXPONENT]);
    law->c[HUNT_FACTOR] = values->v[HUNT_GIVEN_FACTOR];
    if (wanted) law->c[HUNT_FACTOR] = hunt_damping(e) / speed;
    return SCREE_OK;
}

static SCREE_INLINE struct scree_normal_force normal_hunt_crossley_force(const struct scree_law_constants *law,
                                                                         struct scree_pair_constants pair,
                                                                         struct scree_pressing at) {
    (void)pair;
    double touching = at.overlap > 0.0 ? at.overlap : 0.0;
    double spring = law->c[HUNT_STIFFNESS] * scree_power(touching, law->c[HUNT_EXPONENT], law->exponent);
    return (struct scree_normal_force){spring, spring * law->c[HUNT_FACTOR], spring, 0.0, 0.0};
}

static SCREE_INLINE double normal_hunt_crossley_stored(const struct scree_law_constants *law,
                                                       struct scree_pair_constants pair, struct scree_pressing at) {
    (void)pair;
    double n = law->c[HUNT_EXPONENT];
    return law->c[HUNT_STIFFNESS] * at.overlap * scree_power(at.overlap, n, law->exponent) / (n + 1.0);
}

/* Inverse of the relation above, the restitution of D = c v_i: w = c v_o solves w + ln(1 - w) = ln(1 + D) - D with
 * 0 <= w < min(1, D). */
static inline double hunt_restitution(double d) {
    if (d < 1e-9) return 1.0 - 2.0 / 3.0 * d;
    double low = 0.0, high = d < 1.0 ? d : 1.0, target = hunt_log(d);
    for (int k = 0; k < 200; k++) {
        double middle = 0.5 * (low + high);
        if (middle == low || middle == high) break;
        if (hunt_log(-middle) > target)
            low = middle;
        else
            high = middle;
    }
    return low / d;
}

static inline double normal_hunt_crossley_restitution(const struct scree_law_constants *law,
                                                      struct scree_pair_constants pair, double mass, double speed) {
    (void)pair;
    (void)mass;
    return hunt_restitution(law->c[HUNT_FACTOR] * speed);
}

static const struct scree_normal_law scree_normal_hunt_crossley = {
    .text = {.name = "hunt-crossley",
             .formula = "F = k d^n (1 + c u)",
             .source = "Hunt & Crossley, J. Appl. Mech. 42 (1975) 440",
             .note = "Restitution falls with impact speed v: c v (1+e) = ln((1+c v)/(1-c e v)), whatever n and the "
                     "masses. Never pulls while it acts as on an impact.",
             .example = "stiffness = 5e6, restitution = 0.5, speed = 1.0",
             .parameters = hunt_parameters},
    .cut = 1,
    .turns_smoothly = 1,
    .raises = 1,
    .bake = normal_hunt_crossley_bake,
    .pair = scree_any_pair,
    .force = normal_hunt_crossley_force,
    .stored = normal_hunt_crossley_stored,
    .restitution = normal_hunt_crossley_restitution,
};

#endif
