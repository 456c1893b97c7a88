/* Dahl's solid friction: a bristle that yields gradually, so that the contact is stiff at rest and slides at mu N.
 *   dF/dx = s_0 (1 - F sgn(v)/(mu N)): as a vector z' = v - s_0 |v| z/(mu N), F = -s_0 z
 * P. R. Dahl, "A solid friction model", Aerospace Corp. TOR-0158(3107-18)-1 (1968), with the exponent 1 (the usual one;
 * others have no settled form in two directions); J. AIAA 14 (1976) 1675. Under r mu N it comes to rest at -(mu N/s_0)
 * ln(1 - r). It has no static friction above mu, and no Stribeck effect: see lugre. contact/bristle.h says how it is
 * stepped. */
#ifndef SCREE_CONTACT_FRICTION_DAHL_H
#define SCREE_CONTACT_FRICTION_DAHL_H

#include "contact/bristle.h"

enum { DAHL_KINETIC, DAHL_STIFFNESS };

static const struct scree_parameter dahl_parameters[] = {
    {.name = "kinetic", .unit = "1", .meaning = "coefficient mu while sliding", .range = SCREE_NOT_NEGATIVE},
    {.name = "stiffness", .unit = "N/m", .meaning = "stiffness s_0 at rest", .range = SCREE_ANY_POSITIVE, .shared = 1},
    {0}};

static inline scree_status friction_dahl_bake(const struct scree_values *values, struct scree_law_constants *law,
                                              scree_trouble *trouble) {
    (void)trouble;
    law->c[DAHL_KINETIC] = values->v[0];
    law->c[DAHL_STIFFNESS] = values->v[1];
    return SCREE_OK;
}

static inline double friction_dahl_bears(const struct scree_law_constants *law, struct scree_sliding at) {
    return law->c[DAHL_KINETIC] * at.normal;
}

static inline struct scree_tangential friction_dahl_force(const struct scree_law_constants *law,
                                                          struct scree_pair_constants pair, struct scree_sliding at) {
    (void)pair;
    double g = friction_dahl_bears(law, at), s0 = law->c[DAHL_STIFFNESS];
    struct scree_bristle path = scree_bristle_path(at, at.stretch, s0, g, g / s0);
    return (struct scree_tangential){vec_scale(-s0, path.middle), path.end, 0.0};
}

static inline struct vec friction_dahl_rate(const struct scree_law_constants *law, struct scree_pair_constants pair,
                                            struct scree_sliding at) {
    (void)pair;
    return scree_bristle_rate(at, at.stretch, law->c[DAHL_STIFFNESS], friction_dahl_bears(law, at));
}

static inline double friction_dahl_stored(const struct scree_law_constants *law, struct scree_pair_constants pair,
                                          struct scree_sliding at) {
    (void)pair;
    return 0.5 * law->c[DAHL_STIFFNESS] * vec_norm2(at.stretch);
}

static inline double friction_dahl_stiffness(const struct scree_law_constants *law, struct scree_pair_constants pair,
                                             double overlap) {
    (void)pair;
    (void)overlap;
    return law->c[DAHL_STIFFNESS];
}

static const struct scree_friction_law scree_friction_dahl = {
    .text =
        {.name = "dahl",
         .formula = "z' = v - s_0 |v| z/(mu N), F = -s_0 z",
         .source = "Dahl, Aerospace Corp. TOR-0158(3107-18)-1 (1968)",
         .note =
             "Truly rests, under a share r < 1 of the largest friction force at -(mu N/s_0) ln(1 - r); undamped "
             "there but for its hysteresis. Smooth: no border between sticking and sliding. Where the load falls, |z| "
             "is at most mu N/s_0.",
         .example = "kinetic = 0.3, stiffness = 4e4",
         .parameters = dahl_parameters},
    .memory = 1,
    .bake = friction_dahl_bake,
    .force = friction_dahl_force,
    .rate = friction_dahl_rate,
    .bears = friction_dahl_bears,
    .stored = friction_dahl_stored,
    .slope = scree_zero,
    .stiffness = friction_dahl_stiffness,
    .damping = scree_no_stiffness,
};

#endif
