/* What the laws of viscoelastic spheres share. Their restitution is a function of b = (3/2) A (K/m)^(2/5) v^(1/5) and
 * of the end alone (Ramirez, Poeschel, Brilliantov & Schwager, Phys. Rev. E 60 (1999) 4465), which the integrator
 * inverts. */
#ifndef SCREE_CONTACT_KUWABARA_H
#define SCREE_CONTACT_KUWABARA_H

#include "contact/ask.h"
#include "contact/hertz.h"

enum { KUWABARA_GIVEN_RESTITUTION = HERTZ_GIVEN, KUWABARA_GIVEN_RELAXATION, KUWABARA_GIVEN_SPEED };
enum { KUWABARA_RELAXATION = HERTZ_CONSTANTS, KUWABARA_B, KUWABARA_SPEED };
enum { KUWABARA_DAMPING = HERTZ_PAIR_CONSTANTS };

static const struct scree_parameter kuwabara_parameters[] = {
    HERTZ_PARAMETERS,
    {.name = "restitution",
     .unit = "1",
     .meaning = "restitution e wanted at impact speed `speed`",
     .range = SCREE_FRACTION,
     .instead_of = "relaxation"},
    {.name = "relaxation", .unit = "s", .meaning = "time A of the material", .range = SCREE_NOT_NEGATIVE},
    {.name = "speed",
     .unit = "m/s",
     .meaning = "impact speed at which `restitution` is wanted",
     .range = SCREE_ANY_POSITIVE,
     .optional = 1,
     .fallback = NAN},
    {0}};

static inline struct scree_normal_force kuwabara_force(const struct scree_law_constants *law,
                                                       struct scree_pair_constants pair, struct scree_pressing at) {
    (void)law;
    double d = at.overlap > 0.0 ? at.overlap : 0.0, root = sqrt(d);
    double spring = pair.c[HERTZ_STIFFNESS] * d * root;
    return (struct scree_normal_force){spring, pair.c[KUWABARA_DAMPING] * root, spring, 0.0, 0.0};
}

/* Restitution for b, in the units of K = m = v = 1; `context` points at whether the law is cut. */
static inline double kuwabara_e(void *context, double b) {
    const int *cut = context;
    struct scree_normal_law law = {.cut = *cut, .force = kuwabara_force, .stored = hertz_stored};
    struct scree_pair_constants pair = {{1.0, b}};
    return scree_impact(&law, NULL, pair, 1.0, 1.0, 0.0, NULL, NULL).restitution;
}

static inline scree_status kuwabara_bake(const struct scree_values *values, struct scree_law_constants *law, int cut,
                                         scree_trouble *trouble) {
    double e = values->v[KUWABARA_GIVEN_RESTITUTION], speed = values->v[KUWABARA_GIVEN_SPEED];
    int wanted = !isnan(e);
    if (wanted && isnan(speed))
        return scree_report(
            trouble, SCREE_BAD_INPUT, "restitution",
            "the restitution of viscoelastic bodies depends on the impact speed: give `speed` (m/s) beside it");
    if (!wanted && !isnan(speed))
        return scree_report(trouble, SCREE_BAD_INPUT, "speed",
                            "`speed` goes with `restitution`, not with `relaxation`");
    hertz_bake(values, law);
    law->c[KUWABARA_RELAXATION] = wanted ? 0.0 : values->v[KUWABARA_GIVEN_RELAXATION];
    law->c[KUWABARA_B] = wanted ? scree_ask_falling(kuwabara_e, &cut, e, 1.0, 1e-13) : 0.0;
    law->c[KUWABARA_SPEED] = wanted ? speed : 1.0;
    return SCREE_OK;
}

static inline struct scree_pair_constants kuwabara_pair(const struct scree_law_constants *law, double mass,
                                                        double radius) {
    double k = hertz_stiffness(law, radius), b = law->c[KUWABARA_B];
    double relaxation = law->c[KUWABARA_RELAXATION];
    if (b > 0.0) relaxation = b / (1.5 * pow(k / mass, 0.4) * pow(law->c[KUWABARA_SPEED], 0.2));
    return (struct scree_pair_constants){{k, 1.5 * k * relaxation}};
}

#endif
