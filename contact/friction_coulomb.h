/* Coulomb's law with a state that truly sticks: a tangential spring and dashpot, and a slider that holds up to mu_s and
 * slides at mu_k.
 *   F = -(k_t s + c_t v) while |F| <= mu_s N, then |F| = mu_k N against the slip
 * While it slides, spring and dashpot, side by side behind the slider, carry that force: k_t s + c_t s' = -F. For mu_s
 * = mu_k and c_t = 0: Cundall & Strack, Geotechnique 29 (1979) 47, where the spring takes the stretch of the force at
 * once. So slider and dashpot can only take energy out. The contact holds again when the trial force falls below mu_k
 * N, which happens as soon as the slip turns round. */
#ifndef SCREE_CONTACT_FRICTION_COULOMB_H
#define SCREE_CONTACT_FRICTION_COULOMB_H

#include "contact/slider.h"

enum { COULOMB_STATIC, COULOMB_KINETIC, COULOMB_STIFFNESS, COULOMB_DAMPING };

static const struct scree_parameter coulomb_parameters[] = {
    {.name = "static", .unit = "1", .meaning = "coefficient mu_s while sticking", .range = SCREE_NOT_NEGATIVE},
    {.name = "kinetic", .unit = "1", .meaning = "coefficient mu_k while sliding", .range = SCREE_NOT_NEGATIVE},
    {.name = "stiffness", .unit = "N/m", .meaning = "tangential spring k_t", .range = SCREE_ANY_POSITIVE, .shared = 1},
    {.name = "damping",
     .unit = "N s/m",
     .meaning = "tangential dashpot c_t while sticking",
     .range = SCREE_NOT_NEGATIVE,
     .optional = 1,
     .fallback = 0.0,
     .shared = 1},
    {0}};

static inline scree_status friction_coulomb_bake(const struct scree_values *values, struct scree_law_constants *law,
                                                 scree_trouble *trouble) {
    for (int k = 0; k < 4; k++) law->c[k] = values->v[k];
    return scree_check_static(law->c[COULOMB_STATIC], law->c[COULOMB_KINETIC], trouble);
}

static inline struct scree_hold coulomb_hold(const struct scree_law_constants *law, struct scree_sliding at) {
    double kinetic = law->c[COULOMB_KINETIC] * at.normal;
    return (struct scree_hold){at.sliding > 0.0 ? kinetic : law->c[COULOMB_STATIC] * at.normal, kinetic};
}

static SCREE_INLINE struct scree_slider friction_coulomb_grip(const struct scree_law_constants *law,
                                                              struct scree_pair_constants pair,
                                                              struct scree_sliding at) {
    (void)pair;
    return scree_slider_of(at, law->c[COULOMB_STIFFNESS], law->c[COULOMB_DAMPING], coulomb_hold(law, at));
}

static SCREE_INLINE struct scree_tangential friction_coulomb_force(const struct scree_law_constants *law,
                                                                   struct scree_pair_constants pair,
                                                                   struct scree_sliding at) {
    return scree_slide(at, friction_coulomb_grip(law, pair, at));
}

static inline double friction_coulomb_stored(const struct scree_law_constants *law, struct scree_pair_constants pair,
                                             struct scree_sliding at) {
    (void)pair;
    return 0.5 * law->c[COULOMB_STIFFNESS] * vec_norm2(at.stretch);
}

static inline double friction_coulomb_stiffness(const struct scree_law_constants *law, struct scree_pair_constants pair,
                                                double overlap) {
    (void)pair;
    (void)overlap;
    return law->c[COULOMB_STIFFNESS];
}

static inline double friction_coulomb_damping(const struct scree_law_constants *law, struct scree_pair_constants pair,
                                              double overlap) {
    (void)pair;
    (void)overlap;
    return law->c[COULOMB_DAMPING];
}

static const struct scree_friction_law scree_friction_coulomb = {
    .text = {.name = "coulomb",
             .formula = "F = -(k_t s + c_t v) while |F| <= mu_s N (sticks), else |F| = mu_k N against the slip",
             .source = "Cundall & Strack, Geotechnique 29 (1979) 47",
             .note = "Truly sticks: no creep. Without a dashpot a load that is put on at once makes the "
                     "friction force overshoot "
                     "to twice its resting value.",
             .example = "static = 0.4, kinetic = 0.3, stiffness = 4e4",
             .parameters = coulomb_parameters},
    .memory = 1,
    .bake = friction_coulomb_bake,
    .force = friction_coulomb_force,
    .grip = friction_coulomb_grip,
    .hold = coulomb_hold,
    .stored = friction_coulomb_stored,
    .slope = scree_zero,
    .stiffness = friction_coulomb_stiffness,
    .damping = friction_coulomb_damping,
};

#endif
