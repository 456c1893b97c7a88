/* Karnopp's stick band: near rest the contact holds whatever is applied, up to static friction; beyond it slides.
 *   |v| < dv: F = -(applied force), at most mu_s N;  |v| >= dv: F = -mu_k N v/|v|
 * D. Karnopp, "Computer simulation of stick-slip friction in mechanical dynamic systems", J. Dyn. Syst. Meas. Control
 * 107 (1985) 100. A contact of a penalty engine doesn't know the force applied to its bodies, and many contacts may
 * share it. So what holds is a spring and dashpot behind the slider of contact/slider.h, which balance the applied
 * force whatever it is: the body truly rests, at the stretch load/k_t. The band decides the slider's limit: mu_s N
 * inside, mu_k N outside. */
#ifndef SCREE_CONTACT_FRICTION_KARNOPP_H
#define SCREE_CONTACT_FRICTION_KARNOPP_H

#include "contact/slider.h"

enum { KARNOPP_STATIC, KARNOPP_KINETIC, KARNOPP_BAND, KARNOPP_STIFFNESS, KARNOPP_DAMPING };

static const struct scree_parameter karnopp_parameters[] = {
    {.name = "static", .unit = "1", .meaning = "coefficient mu_s inside the band", .range = SCREE_NOT_NEGATIVE},
    {.name = "kinetic", .unit = "1", .meaning = "coefficient mu_k outside", .range = SCREE_NOT_NEGATIVE},
    {.name = "band", .unit = "m/s", .meaning = "half width dv of the band", .range = SCREE_ANY_POSITIVE},
    {.name = "stiffness", .unit = "N/m", .meaning = "spring k_t that holds", .range = SCREE_ANY_POSITIVE, .shared = 1},
    {.name = "damping",
     .unit = "N s/m",
     .meaning = "dashpot c_t beside it",
     .range = SCREE_NOT_NEGATIVE,
     .optional = 1,
     .fallback = 0.0,
     .shared = 1},
    {0}};

static inline scree_status friction_karnopp_bake(const struct scree_values *values, struct scree_law_constants *law,
                                                 scree_trouble *trouble) {
    for (int k = 0; k < 5; k++) law->c[k] = values->v[k];
    return scree_check_static(law->c[KARNOPP_STATIC], law->c[KARNOPP_KINETIC], trouble);
}

static inline struct scree_hold karnopp_hold(const struct scree_law_constants *law, struct scree_sliding at) {
    int inside = vec_norm(at.velocity) < law->c[KARNOPP_BAND];
    double limit = at.normal * (inside ? law->c[KARNOPP_STATIC] : law->c[KARNOPP_KINETIC]);
    return (struct scree_hold){limit, limit};
}

static SCREE_INLINE struct scree_slider friction_karnopp_grip(const struct scree_law_constants *law,
                                                              struct scree_pair_constants pair,
                                                              struct scree_sliding at) {
    (void)pair;
    return scree_slider_of(at, law->c[KARNOPP_STIFFNESS], law->c[KARNOPP_DAMPING], karnopp_hold(law, at));
}

static inline struct scree_tangential friction_karnopp_force(const struct scree_law_constants *law,
                                                             struct scree_pair_constants pair,
                                                             struct scree_sliding at) {
    return scree_slide(at, friction_karnopp_grip(law, pair, at));
}

static inline double karnopp_band(const struct scree_law_constants *law) { return law->c[KARNOPP_BAND]; }

static inline double friction_karnopp_stored(const struct scree_law_constants *law, struct scree_pair_constants pair,
                                             struct scree_sliding at) {
    (void)pair;
    return 0.5 * law->c[KARNOPP_STIFFNESS] * vec_norm2(at.stretch);
}

static inline double friction_karnopp_stiffness(const struct scree_law_constants *law, struct scree_pair_constants pair,
                                                double overlap) {
    (void)pair;
    (void)overlap;
    return law->c[KARNOPP_STIFFNESS];
}

static inline double friction_karnopp_damping(const struct scree_law_constants *law, struct scree_pair_constants pair,
                                              double overlap) {
    (void)pair;
    (void)overlap;
    return law->c[KARNOPP_DAMPING];
}

static const struct scree_friction_law scree_friction_karnopp = {
    .text = {.name = "karnopp",
             .formula = "F = -(k_t s + c_t v), at most mu_s N while |v| < dv, at most mu_k N beyond",
             .source = "Karnopp, J. Dyn. Syst. Meas. Control 107 (1985) 100",
             .note =
                 "Truly sticks. The force that the original takes from the equations of motion comes from a spring "
                 "and a dashpot here. Unlike coulomb, it holds up to mu_s again as soon as the speed is in the band.",
             .example = "static = 0.4, kinetic = 0.3, band = 5e-4, stiffness = 4e4, damping = 20.0",
             .parameters = karnopp_parameters},
    .memory = 1,
    .bake = friction_karnopp_bake,
    .force = friction_karnopp_force,
    .grip = friction_karnopp_grip,
    .hold = karnopp_hold,
    .band = karnopp_band,
    .stored = friction_karnopp_stored,
    .slope = scree_zero,
    .stiffness = friction_karnopp_stiffness,
    .damping = friction_karnopp_damping,
};

#endif
