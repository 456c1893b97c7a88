/* The family of laws whose dashpot grows like the spring and is scaled by the impact speed v0 of each contact:
 *   F = k d^n (1 + D u/v0),  D a function of the restitution e wanted, another one for each author.
 * What D delivers follows from D (1 + e') = ln[(1 + D)/(1 - D e')], for any n, speed and mass (Gonthier et al.,
 * Multibody Syst. Dyn. 11 (2004) 209; the separable equation of contact/normal_hunt_crossley.h); solved for D it is the
 * calibrated factor. The force vanishes at zero overlap, and the contact ends there.
 *
 * Kept of a contact: its impact speed, as the largest closing speed since it began, so that a contact that begins at
 * rest, and is driven together later, isn't damped without bounds. */
#ifndef SCREE_CONTACT_HYSTERESIS_H
#define SCREE_CONTACT_HYSTERESIS_H

#include "contact/normal_hunt_crossley.h"

enum hysteresis_author {
    HYSTERESIS_HUNT_CROSSLEY,
    HYSTERESIS_HERBERT_MCWHANNELL,
    HYSTERESIS_LEE_WANG,
    HYSTERESIS_LANKARANI_NIKRAVESH,
    HYSTERESIS_GONTHIER,
    HYSTERESIS_ZHIYING_QISHAO,
    HYSTERESIS_FLORES,
    HYSTERESIS_HU_GUO
};

enum {
    HYSTERESIS_GIVEN_STIFFNESS,
    HYSTERESIS_GIVEN_EXPONENT,
    HYSTERESIS_GIVEN_RESTITUTION,
    HYSTERESIS_GIVEN_CALIBRATED
};
enum { HYSTERESIS_STIFFNESS = HUNT_STIFFNESS, HYSTERESIS_EXPONENT = HUNT_EXPONENT, HYSTERESIS_FACTOR };

static const struct scree_parameter hysteresis_parameters[] = {
    {.name = "stiffness", .unit = "N/m^n", .meaning = "spring k", .range = SCREE_ANY_POSITIVE, .shared = 1},
    {.name = "exponent",
     .unit = "1",
     .meaning = "exponent n of the overlap",
     .range = SCREE_FROM_ONE_TO_3,
     .optional = 1,
     .fallback = 1.5},
    {.name = "restitution", .unit = "1", .meaning = "restitution e wanted", .range = SCREE_FRACTION},
    {.name = "calibrated",
     .unit = "1",
     .meaning = "factor D for `restitution`: 0 as published, 1 exact",
     .range = SCREE_ZERO_OR_ONE,
     .optional = 1,
     .fallback = 0.0},
    {0}};

/* The factor as published. */
static inline double hysteresis_published(enum hysteresis_author author, double e) {
    switch (author) {
    case HYSTERESIS_HUNT_CROSSLEY:
        return 1.5 * (1.0 - e);
    case HYSTERESIS_HERBERT_MCWHANNELL:
        return 6.0 * (1.0 - e) / ((2.0 * e - 1.0) * (2.0 * e - 1.0) + 3.0);
    case HYSTERESIS_LEE_WANG:
        return 0.75 * (1.0 - e);
    case HYSTERESIS_LANKARANI_NIKRAVESH:
        return 0.75 * (1.0 - e) * (1.0 + e);
    case HYSTERESIS_GONTHIER:
        return (1.0 - e) * (1.0 + e) / e;
    case HYSTERESIS_ZHIYING_QISHAO:
        return 0.75 * (1.0 - e) * (1.0 + e) * exp(2.0 * (1.0 - e));
    case HYSTERESIS_FLORES:
        return 1.6 * (1.0 - e) / e;
    case HYSTERESIS_HU_GUO:
        return 1.5 * (1.0 - e) / e;
    }
    return 0.0;
}

static inline scree_status hysteresis_bake(const struct scree_values *values, struct scree_law_constants *law,
                                           enum hysteresis_author author) {
    double e = values->v[HYSTERESIS_GIVEN_RESTITUTION];
    int calibrated = values->v[HYSTERESIS_GIVEN_CALIBRATED] > 0.0;
    law->c[HYSTERESIS_STIFFNESS] = values->v[HYSTERESIS_GIVEN_STIFFNESS];
    law->c[HYSTERESIS_EXPONENT] = values->v[HYSTERESIS_GIVEN_EXPONENT];
    law->exponent = scree_exponent_of(law->c[HYSTERESIS_EXPONENT]);
    law->c[HYSTERESIS_FACTOR] = calibrated ? hunt_damping(e) : hysteresis_published(author, e);
    return SCREE_OK;
}

static SCREE_INLINE struct scree_normal_force hysteresis_force(const struct scree_law_constants *law,
                                                               struct scree_pressing at) {
    int touching = at.overlap > 0.0;
    double d = touching ? at.overlap : 0.0;
    double fastest = at.closing > at.first ? at.closing : at.first;
    double impact = touching ? fastest : 0.0;
    double spring = law->c[HYSTERESIS_STIFFNESS] * scree_power(d, law->c[HYSTERESIS_EXPONENT], law->exponent);
    double damping = impact > 0.0 ? spring * law->c[HYSTERESIS_FACTOR] / (impact + SCREE_NO_SPEED) : 0.0;
    return (struct scree_normal_force){spring, damping, spring, impact, 0.0};
}

static inline double hysteresis_restitution(const struct scree_law_constants *law) {
    return hunt_restitution(law->c[HYSTERESIS_FACTOR]);
}

#endif
