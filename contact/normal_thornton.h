/* Elastic spheres that yield where the pressure reaches p_y.
 *   F = K d^(3/2) up to d_y = (pi p_y/(2 E*))^2 R*;  F = F_y + pi R* p_y (d - d_y) beyond
 * Unloading from the largest overlap D and its force F_D is Hertz's with a larger radius R_p; written without it,
 *   F = F_D ((d - d_p)/s)^(3/2),  s = D - d_p = (3 F_D/(4 E*)) sqrt(2 pi p_y/(2 F_D + F_y))
 * Thornton, J. Appl. Mech. 64 (1997) 383. A free impact ends where the force vanishes, at d_p; with x = v_y/v < 1,
 *   e = sqrt(6 sqrt(3)/5) sqrt(1 - x^2/6) (x/(x + 2 sqrt(6/5 - x^2/5)))^(1/4)
 * Kept of a contact: the largest overlap. */
#ifndef SCREE_CONTACT_NORMAL_THORNTON_H
#define SCREE_CONTACT_NORMAL_THORNTON_H

#include "contact/law.h"

enum { THORNTON_MODULUS, THORNTON_YIELD };
enum { THORNTON_STIFFNESS, THORNTON_YIELD_OVERLAP, THORNTON_YIELD_FORCE, THORNTON_SLOPE };

static const struct scree_parameter thornton_parameters[] = {
    {.name = "modulus",
     .unit = "Pa",
     .meaning = "effective modulus E*",
     .range = SCREE_ANY_POSITIVE,
     .material = SCREE_FROM_MODULUS,
     .shared = 1},
    {.name = "yield",
     .unit = "Pa",
     .meaning = "contact pressure p_y at which the softer body yields",
     .range = SCREE_ANY_POSITIVE,
     .shared = 1},
    {0}};

static inline struct scree_pair_constants thornton_pair(const struct scree_law_constants *law, double mass,
                                                        double radius) {
    (void)mass;
    double pi = 3.14159265358979323846, stiffness = 4.0 / 3.0 * law->c[THORNTON_MODULUS] * sqrt(radius);
    double ratio = 0.5 * pi * law->c[THORNTON_YIELD] / law->c[THORNTON_MODULUS], overlap = ratio * ratio * radius;
    return (struct scree_pair_constants){
        {stiffness, overlap, stiffness * overlap * sqrt(overlap), pi * radius * law->c[THORNTON_YIELD]}};
}

/* Largest force, and the way on which it vanishes while unloading. */
struct thornton_peak {
    double force, span;
};

static SCREE_INLINE struct thornton_peak thornton_peak_of(const struct scree_law_constants *law,
                                                          struct scree_pair_constants pair, double largest) {
    double yield = pair.c[THORNTON_YIELD_OVERLAP], deep = largest > 0.0 ? largest : 0.0;
    int plastic = deep > yield;
    double elastic = pair.c[THORNTON_STIFFNESS] * deep * sqrt(deep); /* in any case: a choice of roots is no vector */
    double yielded = pair.c[THORNTON_YIELD_FORCE] + pair.c[THORNTON_SLOPE] * (deep - yield);
    double force = plastic ? yielded : elastic;
    double pressure = 2.0 * 3.14159265358979323846 * law->c[THORNTON_YIELD];
    double span =
        0.75 * force / law->c[THORNTON_MODULUS] * sqrt(pressure / (2.0 * force + pair.c[THORNTON_YIELD_FORCE]));
    return (struct thornton_peak){force, plastic ? span : deep};
}

static SCREE_INLINE double thornton_stored(const struct scree_law_constants *law, struct scree_pair_constants pair,
                                           struct scree_pressing at) {
    double largest = at.overlap > at.first ? at.overlap : at.first;
    struct thornton_peak peak = thornton_peak_of(law, pair, largest);
    double w = 1.0 - (largest - at.overlap) / (peak.span + SCREE_NO_SPEED), left = w > 0.0 ? w : 0.0;
    return 0.4 * peak.force * peak.span * left * left * sqrt(left);
}

/* Speed at which yield begins: m v^2/2 = (2/5) K d_y^(5/2). */
static inline double thornton_yield_speed(struct scree_pair_constants pair, double mass) {
    return sqrt(0.8 * pair.c[THORNTON_YIELD_FORCE] * pair.c[THORNTON_YIELD_OVERLAP] / mass);
}

static inline scree_status normal_thornton_bake(const struct scree_values *values, struct scree_law_constants *law,
                                                scree_trouble *trouble) {
    (void)trouble;
    law->c[THORNTON_MODULUS] = values->v[THORNTON_MODULUS];
    law->c[THORNTON_YIELD] = values->v[THORNTON_YIELD];
    return SCREE_OK;
}

static SCREE_INLINE struct scree_normal_force normal_thornton_force(const struct scree_law_constants *law,
                                                                    struct scree_pair_constants pair,
                                                                    struct scree_pressing at) {
    int touching = at.overlap > 0.0, further = at.overlap > at.first;
    double largest = further ? at.overlap : at.first;
    struct thornton_peak peak = thornton_peak_of(law, pair, largest);
    double w = 1.0 - (largest - at.overlap) / (peak.span + SCREE_NO_SPEED), left = w > 0.0 ? w : 0.0;
    double force = peak.force * left * sqrt(left);
    /* Beyond yield less than the work done can come back: d(2/5 F_D s)/dD of it. */
    double per_force = 2.0 - peak.force / (2.0 * peak.force + pair.c[THORNTON_YIELD_FORCE]);
    double plastic = 0.4 * pair.c[THORNTON_SLOPE] * peak.span * per_force;
    int loses = further && at.closing > 0.0 && largest > pair.c[THORNTON_YIELD_OVERLAP];
    return (struct scree_normal_force){force, 0.0, loses ? plastic : force, touching ? largest : 0.0, 0.0};
}

static inline double normal_thornton_restitution(const struct scree_law_constants *law,
                                                 struct scree_pair_constants pair, double mass, double speed) {
    (void)law;
    double x = thornton_yield_speed(pair, mass) / speed;
    if (x >= 1.0) return 1.0;
    double root = sqrt(1.2 - 0.2 * x * x);
    return sqrt(1.2 * sqrt(3.0) * (1.0 - x * x / 6.0) * sqrt(x / (x + 2.0 * root)));
}

/* Where it yields, for the first time or further, and where it has unloaded. */
static SCREE_INLINE int normal_thornton_bends(const struct scree_law_constants *law, struct scree_pair_constants pair,
                                              struct scree_pressing from, struct scree_pressing to) {
    double yield = pair.c[THORNTON_YIELD_OVERLAP], further = from.first > yield ? from.first : yield;
    double unloaded = from.first - thornton_peak_of(law, pair, from.first).span;
    return scree_between(from.overlap, to.overlap, to.closing > 0.0 ? further : unloaded);
}

static const struct scree_normal_law scree_normal_thornton = {
    .text = {.name = "thornton",
             .formula = "F = K d^(3/2) up to yield, F_y + pi R* p_y (d - d_y) beyond; unloads like a Hertzian contact "
                        "of larger radius",
             .source = "Thornton, J. Appl. Mech. 64 (1997) 383",
             .note = "Elastic-perfectly plastic: restitution 1 up to the speed v_y = (pi/(2 E*))^2 sqrt(8 pi "
                     "R*^3/(15 m)) p_y^(5/2), 1.185 (v_y/v)^(1/4) far above it. Never pulls.",
             .parameters = thornton_parameters,
             .example = "modulus = 3e7, yield = 3e6"},
    .cut = 1,
    .memory = 1,
    .bake = normal_thornton_bake,
    .pair = thornton_pair,
    .force = normal_thornton_force,
    .stored = thornton_stored,
    .bends = normal_thornton_bends,
    .restitution = normal_thornton_restitution,
};

#endif
