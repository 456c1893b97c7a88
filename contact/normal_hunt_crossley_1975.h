/* Spring and dashpot that grow alike with the overlap, scaled by the impact speed v0 of the contact
 * (contact/hysteresis.h).
 *   F = k d^n (1 + D u/v0),  D = 3 (1-e)/2
 * Hunt & Crossley, J. Appl. Mech. 42 (1975) 440. The contact ends at zero overlap, where the force is zero too; the
 * restitution e' it then has solves
 *   D (1 + e') = ln[(1 + D)/(1 - D e')] */
#ifndef SCREE_CONTACT_NORMAL_HUNT_CROSSLEY_1975_H
#define SCREE_CONTACT_NORMAL_HUNT_CROSSLEY_1975_H

#include "contact/hysteresis.h"

static inline scree_status normal_hunt_crossley_1975_bake(const struct scree_values *values,
                                                          struct scree_law_constants *law, scree_trouble *trouble) {
    (void)trouble;
    return hysteresis_bake(values, law, HYSTERESIS_HUNT_CROSSLEY);
}

static SCREE_INLINE struct scree_normal_force normal_hunt_crossley_1975_force(const struct scree_law_constants *law,
                                                                              struct scree_pair_constants pair,
                                                                              struct scree_pressing at) {
    (void)pair;
    return hysteresis_force(law, at);
}

static inline double normal_hunt_crossley_1975_restitution(const struct scree_law_constants *law,
                                                           struct scree_pair_constants pair, double mass,
                                                           double speed) {
    (void)pair;
    (void)mass;
    (void)speed;
    return hysteresis_restitution(law);
}

static const struct scree_normal_law scree_normal_hunt_crossley_1975 = {
    .text = {.name = "hunt-crossley-1975",
             .formula = "F = k d^n (1 + D u/v0), D = 3 (1-e)/2",
             .source = "Hunt & Crossley, J. Appl. Mech. 42 (1975) 440",
             .note = "v0 is the largest closing speed since the touch, of an impact its speed, so the restitution is "
                     "the same at every speed: D (1+e') = ln((1+D)/(1-D e')), which is not e but near e = 1; "
                     "calibrated = 1 takes the D that delivers e. Never pulls while it acts as on an impact.",
             .parameters = hysteresis_parameters,
             .example = "stiffness = 5e6, restitution = 0.5"},
    .cut = 1,
    .memory = 1,
    .turns_smoothly = 1,
    .raises = 1,
    .bake = normal_hunt_crossley_1975_bake,
    .pair = scree_any_pair,
    .force = normal_hunt_crossley_1975_force,
    .stored = normal_hunt_crossley_stored,
    .restitution = normal_hunt_crossley_1975_restitution,
};

#endif
