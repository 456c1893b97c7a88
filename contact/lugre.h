/* What lugre and elastoplastic share: Stribeck's curve g over a bristle with a dashpot. */
#ifndef SCREE_CONTACT_LUGRE_H
#define SCREE_CONTACT_LUGRE_H

#include "contact/bristle.h"

enum { LUGRE_STATIC, LUGRE_KINETIC, LUGRE_SPEED, LUGRE_STIFFNESS, LUGRE_DAMPING, LUGRE_VISCOUS, LUGRE_ELASTIC };

/* elastoplastic takes all of them, lugre all but the first. */
static const struct scree_parameter lugre_family[] = {
    {.name = "elastic",
     .unit = "1",
     .meaning = "elastic range z_b over mu_k N/s_0, below 1",
     .range = SCREE_FRACTION,
     .optional = 1,
     .fallback = 0.7},
    {.name = "static", .unit = "1", .meaning = "coefficient mu_s towards rest", .range = SCREE_NOT_NEGATIVE},
    {.name = "kinetic", .unit = "1", .meaning = "coefficient mu_k while sliding", .range = SCREE_NOT_NEGATIVE},
    {.name = "stribeck_speed", .unit = "m/s", .meaning = "speed v_s of the fall", .range = SCREE_ANY_POSITIVE},
    {.name = "stiffness",
     .unit = "N/m",
     .meaning = "stiffness s_0 of the bristles",
     .range = SCREE_ANY_POSITIVE,
     .shared = 1},
    {.name = "damping",
     .unit = "N s/m",
     .meaning = "damping s_1 of the bristles",
     .range = SCREE_NOT_NEGATIVE,
     .optional = 1,
     .fallback = 0.0,
     .shared = 1},
    {.name = "viscous",
     .unit = "s/m",
     .meaning = "viscous part s_2 of the coefficient",
     .range = SCREE_NOT_NEGATIVE,
     .optional = 1,
     .fallback = 0.0},
    {0}};

/* `value` holds the values from `static` on. */
static inline scree_status lugre_bake(const double *value, struct scree_law_constants *law, scree_trouble *trouble) {
    for (int k = LUGRE_STATIC; k <= LUGRE_VISCOUS; k++) law->c[k] = value[k];
    return scree_check_static(law->c[LUGRE_STATIC], law->c[LUGRE_KINETIC], trouble);
}

/* Friction force of steady sliding without its viscous part, N. */
static inline double lugre_steady(const struct scree_law_constants *law, double normal, double speed) {
    double w = speed / law->c[LUGRE_SPEED], drop = law->c[LUGRE_STATIC] - law->c[LUGRE_KINETIC];
    return normal * (law->c[LUGRE_KINETIC] + drop * scree_exp(-w * w));
}

static inline double lugre_bears(const struct scree_law_constants *law, struct scree_sliding at) {
    return law->c[LUGRE_STATIC] * at.normal;
}

/* -(s_0 z + s_1 z' + s_2 N v) in the middle of the path. */
static inline struct scree_tangential lugre_force(const struct scree_law_constants *law, struct scree_sliding at,
                                                  struct scree_bristle path, double g, double speed) {
    double s1 = scree_bristle_dashpot((1.0 - at.apart) * law->c[LUGRE_DAMPING], g, speed);
    struct vec force = vec_axpy(vec_scale(-law->c[LUGRE_STIFFNESS], path.middle), -s1, path.rate);
    force = vec_axpy(force, -law->c[LUGRE_VISCOUS] * at.normal, at.velocity);
    return (struct scree_tangential){force, path.end, 0.0};
}

static inline double lugre_stored(const struct scree_law_constants *law, struct scree_pair_constants pair,
                                  struct scree_sliding at) {
    (void)pair;
    return 0.5 * law->c[LUGRE_STIFFNESS] * vec_norm2(at.stretch);
}

static inline double lugre_slope(const struct scree_law_constants *law) { return law->c[LUGRE_VISCOUS]; }

static inline double lugre_stiffness(const struct scree_law_constants *law, struct scree_pair_constants pair,
                                     double overlap) {
    (void)pair;
    (void)overlap;
    return law->c[LUGRE_STIFFNESS];
}

static inline double lugre_damping(const struct scree_law_constants *law, struct scree_pair_constants pair,
                                   double overlap) {
    (void)pair;
    (void)overlap;
    return law->c[LUGRE_DAMPING];
}

#endif
