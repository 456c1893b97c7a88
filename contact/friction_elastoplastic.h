/* LuGre's bristles with an elastic range: below it they only bend, so that a vibrating load makes nothing drift.
 *   z' = v - alpha s_0 |v| z/g(v),  F = -(s_0 z + s_1 z' + s_2 N v),  g as in lugre
 *   alpha = 0 for |z| <= z_b and while z goes back; 1 from z_s = g/s_0 on;
 *   (1 + sin(pi (|z| - (z_s + z_b)/2)/(z_s - z_b)))/2 between
 * P. Dupont, V. Hayward, B. Armstrong & F. Altpeter, "Single state elastoplastic friction models", IEEE Trans. Autom.
 * Control 47 (2002) 787. The elastic range z_b is given as a share of mu_k N/s_0, so that it goes with the load. */
#ifndef SCREE_CONTACT_FRICTION_ELASTOPLASTIC_H
#define SCREE_CONTACT_FRICTION_ELASTOPLASTIC_H

#include "contact/lugre.h"

static inline scree_status friction_elastoplastic_bake(const struct scree_values *values,
                                                       struct scree_law_constants *law, scree_trouble *trouble) {
    law->c[LUGRE_ELASTIC] = values->v[0];
    if (values->v[0] >= 1.0)
        return scree_report(trouble, SCREE_BAD_INPUT, "elastic", "elastic (%g) must be below 1", values->v[0]);
    return lugre_bake(values->v + 1, law, trouble);
}

/* alpha where z is `share` of the way from z_b to z_s. */
static SCREE_INLINE double elastoplastic_alpha_at(double share) {
    double sine, cosine;
    scree_sincos(3.14159265358979323846 * (share - 0.5), &sine, &cosine);
    return 0.5 + 0.5 * sine;
}

/* How plastic the bristles are at deflection z. */
static SCREE_INLINE double elastoplastic_alpha(struct vec z, struct vec v, double elastic, double steady) {
    double share = (vec_norm(z) - elastic) / (steady - elastic + SCREE_NO_FORCE);
    share = share > 0.0 ? share : 0.0;
    share = share < 1.0 ? share : 1.0;
    return vec_dot(z, v) > 0.0 ? elastoplastic_alpha_at(share) : 0.0;
}

/* What a step goes by: stiffness, N/m; saturation, N; z_b and the way from there to z_s, m; what the load bears, m. */
struct elastoplastic_step {
    struct scree_sliding at;
    double s0, g, elastic, way, most;
};

/* Where z in the middle of the step is sought: between two shares of the way from z_b to z_s; by how much z would be
 * beyond them, and the last one that was tried, m. */
struct elastoplastic_search {
    double low, high, beyond_low, beyond_high, last;
};

static SCREE_INLINE double elastoplastic_guess(const struct elastoplastic_search *in) {
    double size = in->beyond_low - in->beyond_high + SCREE_NO_FORCE;
    return in->low + (in->high - in->low) * (in->beyond_low / size);
}

/* By how much z is beyond a share if it is as plastic all along as there. */
static SCREE_INLINE double elastoplastic_beyond(const struct elastoplastic_step *step, double share) {
    double slope = elastoplastic_alpha_at(share) * step->s0;
    struct vec z = scree_bristle_path(step->at, step->at.stretch, slope, step->g, step->most).middle;
    return vec_norm(z) - step->elastic - share * step->way;
}

/* Regula falsi with the weights of Anderson & Bjoerck, BIT 13 (1973) 253: the value of an end that is kept twice is cut
 * by as much as the other one has fallen. */
static SCREE_INLINE void elastoplastic_narrow(const struct elastoplastic_step *step, struct elastoplastic_search *in) {
    double share = elastoplastic_guess(in), value = elastoplastic_beyond(step, share);
    double before = value > 0.0 ? in->beyond_low + SCREE_NO_FORCE : in->beyond_high - SCREE_NO_FORCE;
    double fallen = 1.0 - value / before, kept = fallen > 0.0 ? fallen : 0.5;
    kept = kept < 1.0 ? kept : 0.5;
    kept = value * in->last > 0.0 ? kept : 1.0; /* once is no reason */
    in->low = value > 0.0 ? share : in->low;
    in->high = value > 0.0 ? in->high : share;
    in->beyond_low = value > 0.0 ? value : in->beyond_low * kept;
    in->beyond_high = value > 0.0 ? in->beyond_high * kept : value;
    in->last = value;
}

/* alpha of the step is that of its middle, which alpha itself decides: between z_b and z_s z' falls from v to nothing,
 * and where these are close to one another a guess would be anywhere between. Three tries: no error of an impact is
 * less by five. Written out, as loops in loops over contacts are no vectors. */
static SCREE_INLINE double elastoplastic_alpha_of_step(const struct elastoplastic_step *step) {
    struct vec z = scree_bristle_cut(vec_axpy(step->at.stretch, step->at.half, step->at.velocity), step->most);
    struct elastoplastic_search in = {0.0, 1.0, vec_norm(z) - step->elastic, elastoplastic_beyond(step, 1.0), 0.0};
    double bends = in.beyond_low > 0.0 ? vec_dot(z, step->at.velocity) : 0.0, left = in.beyond_high;
    elastoplastic_narrow(step, &in);
    elastoplastic_narrow(step, &in);
    elastoplastic_narrow(step, &in);
    double alpha = elastoplastic_alpha_at(elastoplastic_guess(&in));
    alpha = left < 0.0 ? alpha : 1.0;
    return bends > 0.0 ? alpha : 0.0;
}

static inline struct scree_tangential friction_elastoplastic_force(const struct scree_law_constants *law,
                                                                   struct scree_pair_constants pair,
                                                                   struct scree_sliding at) {
    (void)pair;
    double speed = vec_norm(at.velocity), g = lugre_steady(law, at.normal, speed), s0 = law->c[LUGRE_STIFFNESS];
    double elastic = law->c[LUGRE_ELASTIC] * law->c[LUGRE_KINETIC] * at.normal / s0;
    struct elastoplastic_step step = {at, s0, g, elastic, g / s0 - elastic, lugre_bears(law, at) / s0};
    double alpha = elastoplastic_alpha_of_step(&step);
    return lugre_force(law, at, scree_bristle_path(at, at.stretch, alpha * s0, g, step.most), g, speed);
}

static inline struct vec friction_elastoplastic_rate(const struct scree_law_constants *law,
                                                     struct scree_pair_constants pair, struct scree_sliding at) {
    (void)pair;
    double g = lugre_steady(law, at.normal, vec_norm(at.velocity)), s0 = law->c[LUGRE_STIFFNESS];
    double elastic = law->c[LUGRE_ELASTIC] * law->c[LUGRE_KINETIC] * at.normal / s0;
    double alpha = elastoplastic_alpha(at.stretch, at.velocity, elastic, g / s0);
    return scree_bristle_rate(at, at.stretch, alpha * s0, g);
}

static const struct scree_friction_law scree_friction_elastoplastic = {
    .text = {.name = "elastoplastic",
             .formula =
                 "z' = v - alpha s_0 |v| z/g, F = -(s_0 z + s_1 z' + s_2 N v); alpha(z) = 0 in the elastic range",
             .source = "Dupont, Hayward, Armstrong & Altpeter, IEEE Trans. Autom. Control 47 (2002) 787",
             .note = "As lugre, but doesn't drift under a load that vibrates in the elastic range, |load| < elastic "
                     "mu_k N. z and s_1 are limited as in lugre.",
             .example =
                 "static = 0.4, kinetic = 0.3, stribeck_speed = 2e-3, stiffness = 4e4, damping = 20.0, elastic = "
                 "0.8",
             .parameters = lugre_family},
    .memory = 1,
    .bake = friction_elastoplastic_bake,
    .force = friction_elastoplastic_force,
    .rate = friction_elastoplastic_rate,
    .bears = lugre_bears,
    .stored = lugre_stored,
    .slope = lugre_slope,
    .stiffness = lugre_stiffness,
    .damping = lugre_damping,
};

#endif
