/* Hertz's spring with Tsuji's dashpot while the bodies approach, and none while they part: pounding structures.
 *   F = K d^(3/2) + 2 xi sqrt(m K) d^(1/4) max(u, 0),  xi = (9 sqrt(5)/2) (1 - e^2)/(e (e (9 pi - 16) + 16))
 * Jankowski, Earthquake Eng. Struct. Dyn. 35 (2006) 517. The contact ends at zero overlap, where the force is zero too.
 * The map of contact/tsuji.h takes it to the linear law with a dashpot on approach only, so
 *   e' = exp(-zeta arccos(zeta)/sqrt(1 - zeta^2)),  zeta = 2 xi/sqrt(5), arcosh above zeta = 1 */
#ifndef SCREE_CONTACT_NORMAL_JANKOWSKI_H
#define SCREE_CONTACT_NORMAL_JANKOWSKI_H

#include "contact/tsuji.h"

enum { JANKOWSKI_GIVEN_RESTITUTION = HERTZ_GIVEN, JANKOWSKI_GIVEN_XI, JANKOWSKI_GIVEN_CALIBRATED };

static const struct scree_parameter jankowski_parameters[] = {
    HERTZ_PARAMETERS,
    {.name = "restitution",
     .unit = "1",
     .meaning = "restitution e wanted",
     .range = SCREE_FRACTION,
     .instead_of = "xi"},
    {.name = "xi", .unit = "1", .meaning = "damping ratio xi", .range = SCREE_NOT_NEGATIVE},
    {.name = "calibrated",
     .unit = "1",
     .meaning = "xi for `restitution`: 0 as published, 1 exact",
     .range = SCREE_ZERO_OR_ONE,
     .optional = 1,
     .fallback = 0.0},
    {0}};

static inline double jankowski_xi(double e) {
    return 4.5 * sqrt(5.0) * (1.0 - e) * (1.0 + e) / (e * (e * (9.0 * 3.14159265358979323846 - 16.0) + 16.0));
}

static inline scree_status normal_jankowski_bake(const struct scree_values *values, struct scree_law_constants *law,
                                                 scree_trouble *trouble) {
    (void)trouble;
    double e = values->v[JANKOWSKI_GIVEN_RESTITUTION], xi = values->v[JANKOWSKI_GIVEN_XI];
    if (isnan(xi))
        xi = values->v[JANKOWSKI_GIVEN_CALIBRATED] > 0.0 ? 0.5 * sqrt(5.0) * linear_invert(e, 1.0) : jankowski_xi(e);
    hertz_bake(values, law);
    law->c[TSUJI_ALPHA] = 2.0 * xi;
    return SCREE_OK;
}

static SCREE_INLINE struct scree_normal_force normal_jankowski_force(const struct scree_law_constants *law,
                                                                     struct scree_pair_constants pair,
                                                                     struct scree_pressing at) {
    (void)law;
    struct scree_normal_force f = tsuji_force(pair, at);
    f.damping *= at.closing > 0.0 ? 1.0 : 0.0;
    return f;
}

static inline double normal_jankowski_restitution(const struct scree_law_constants *law,
                                                  struct scree_pair_constants pair, double mass, double speed) {
    (void)pair;
    (void)mass;
    (void)speed;
    return exp(-tsuji_zeta(law) * linear_angle(tsuji_zeta(law)));
}

static const struct scree_normal_law scree_normal_jankowski = {
    .text = {.name = "jankowski",
             .formula = "F = K d^(3/2) + 2 xi sqrt(m K) d^(1/4) max(u, 0), K = (4/3) E* sqrt(R*)",
             .source = "Jankowski, Earthquake Eng. Struct. Dyn. 35 (2006) 517",
             .note = "Damped while approaching only; never pulls. Restitution is the same at every speed: e = "
                     "exp(-zeta arccos(zeta)/sqrt(1-zeta^2)), zeta = 2 xi/sqrt(5). As published xi = (9 "
                     "sqrt(5)/2) (1-e^2)/(e (e (9 pi - 16) + 16)); calibrated = 1 takes the xi that delivers e.",
             .parameters = jankowski_parameters,
             .example = "stiffness = 5e6, restitution = 0.5"},
    .cut = 0,
    .root = 4,
    .bake = normal_jankowski_bake,
    .pair = tsuji_pair,
    .force = normal_jankowski_force,
    .stored = hertz_stored,
    .restitution = normal_jankowski_restitution,
};

#endif
