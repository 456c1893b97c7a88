/* Adhesion of soft bodies: contact of radius a, held together by the work of adhesion w.
 *   d = a^2/R* - sqrt(2 pi w a/E*),  F = 4 E* a^3/(3 R*) - sqrt(8 pi w E* a^3)
 * Johnson, Kendall & Roberts, Proc. R. Soc. A 324 (1971) 301. With a = a_c x^2, a_c^3 = pi w R*^2/(8 E*), d_c =
 * a_c^2/R*:
 *   d = d_c (x^4 - 4 x),  F = pi w R* (x^6/6 - x^3),  x >= 1;  largest pull 1.5 pi w R* at x^3 = 3
 * Bodies attach at d = 0, where the law jumps to x^3 = 4 and pulls, and let go at d = -3 d_c, x = 1: a loop that costs
 * pi w a_c^2 (12 4^(1/3) + 2)/5 = 4.2098 pi w a_c^2 a contact, e = sqrt(1 - 2 loss/(m v^2)). Energy counts from the end
 * at x = 1. Kept of a contact: that the bodies are attached. */
#ifndef SCREE_CONTACT_NORMAL_JKR_H
#define SCREE_CONTACT_NORMAL_JKR_H

#include "contact/law.h"

enum { JKR_MODULUS, JKR_ADHESION };
enum { JKR_FORCE, JKR_LENGTH }; /* pair constants: pi w R*, d_c */

static const struct scree_parameter jkr_parameters[] = {
    {.name = "modulus",
     .unit = "Pa",
     .meaning = "effective modulus E*",
     .range = SCREE_ANY_POSITIVE,
     .material = SCREE_FROM_MODULUS,
     .shared = 1},
    {.name = "adhesion", .unit = "J/m^2", .meaning = "work of adhesion w", .range = SCREE_ANY_POSITIVE, .shared = 1},
    {0}};

static inline struct scree_pair_constants jkr_pair(const struct scree_law_constants *law, double mass, double radius) {
    (void)mass;
    double force = 3.14159265358979323846 * law->c[JKR_ADHESION] * radius;
    double contact = cbrt(force * radius / (8.0 * law->c[JKR_MODULUS]));
    return (struct scree_pair_constants){{force, contact * contact / radius}};
}

/* t = x - 1 >= 0 of x^4 - 4 x = depth >= -3: t^2 (t^2 + 4 t + 6) = depth + 3. Without the term 4 t the equation gives a
 * start above the root, from which Newton's steps descend; six of them reach rounding (worst after the start: a
 * factor 1.5). */
static inline double jkr_beyond(double depth) {
    double e = depth > -3.0 ? depth + 3.0 : 0.0;
    double t = sqrt(e / (3.0 + sqrt(9.0 + e)));
    for (int k = 0; k < 6; k++)
        t -= (t * t * (t * (t + 4.0) + 6.0) - e) / (4.0 * t * (t * (t + 3.0) + 3.0) + SCREE_NO_SPEED);
    return t;
}

static SCREE_INLINE double jkr_stored(const struct scree_law_constants *law, struct scree_pair_constants pair,
                                      struct scree_pressing at) {
    (void)law;
    if (!(at.overlap > 0.0 || at.second > 0.0)) return 0.0;
    double x = 1.0 + jkr_beyond(at.overlap / pair.c[JKR_LENGTH]), cube = x * x * x, fourth = cube * x;
    double energy = (fourth * cube * cube - 1.0) / 15.0 - 2.0 / 3.0 * (fourth * cube - 1.0) + (fourth - 1.0);
    return pair.c[JKR_FORCE] * pair.c[JKR_LENGTH] * energy;
}

static inline double jkr_reach(const struct scree_law_constants *law, struct scree_pair_constants pair) {
    (void)law;
    return 3.0 * pair.c[JKR_LENGTH];
}

/* At x^3 = 4 and x = 1. */
static inline double jkr_jump(const struct scree_law_constants *law, struct scree_pair_constants pair, int ends) {
    (void)law;
    return pair.c[JKR_FORCE] * (ends ? -5.0 / 6.0 : -4.0 / 3.0);
}

static inline scree_status normal_jkr_bake(const struct scree_values *values, struct scree_law_constants *law,
                                           scree_trouble *trouble) {
    (void)trouble;
    law->c[JKR_MODULUS] = values->v[JKR_MODULUS];
    law->c[JKR_ADHESION] = values->v[JKR_ADHESION];
    return SCREE_OK;
}

static SCREE_INLINE struct scree_normal_force
normal_jkr_force(const struct scree_law_constants *law, struct scree_pair_constants pair, struct scree_pressing at) {
    (void)law;
    int attached = at.overlap > 0.0 || (at.second > 0.0 && at.overlap >= -3.0 * pair.c[JKR_LENGTH]);
    double x = 1.0 + jkr_beyond(at.overlap / pair.c[JKR_LENGTH]), cube = x * x * x;
    double force = attached ? pair.c[JKR_FORCE] * cube * (cube / 6.0 - 1.0) : 0.0;
    return (struct scree_normal_force){force, 0.0, force, 0.0, attached ? 1.0 : 0.0};
}

static inline double normal_jkr_restitution(const struct scree_law_constants *law, struct scree_pair_constants pair,
                                            double mass, double speed) {
    (void)law;
    double loss = pair.c[JKR_FORCE] * pair.c[JKR_LENGTH] * (2.4 * cbrt(4.0) + 0.4);
    double left = 1.0 - 2.0 * loss / (mass * speed * speed);
    return left > 0.0 ? sqrt(left) : 0.0;
}

static const struct scree_normal_law scree_normal_jkr = {
    .text = {.name = "jkr",
             .formula = "d = a^2/R* - sqrt(2 pi w a/E*), F = 4 E* a^3/(3 R*) - sqrt(8 pi w E* a^3); attaches at d = 0, "
                        "lets go at d = -3 a_c^2/R*",
             .source = "Johnson, Kendall & Roberts, Proc. R. Soc. A 324 (1971) 301",
             .note = "Adhesion of soft bodies: pulls with up to 1.5 pi w R*, and from the first touch on until "
                     "they are 3 a_c^2/R* apart, a_c^3 = pi w R*^2/(8 E*). Each contact costs 4.2098 pi w a_c^2: "
                     "restitution sqrt(1 - 2 loss/(m v^2)); slower bodies stay together.",
             .parameters = jkr_parameters,
             .example = "modulus = 3e7, adhesion = 20.0"},
    .cut = 0,
    .memory = 1,
    .bake = normal_jkr_bake,
    .pair = jkr_pair,
    .force = normal_jkr_force,
    .stored = jkr_stored,
    .reach = jkr_reach,
    .jump = jkr_jump,
    .restitution = normal_jkr_restitution,
};

#endif
