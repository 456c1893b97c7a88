/* A bristle: the deflection z of the asperities of a contact, which lags behind the sliding.
 *   z' = v - a z,  a = |v| s_0/g:  it grows with the slip and saturates at g/s_0 in the direction of sliding
 *   F = s_0 z (+ s_1 z') on the body, against it
 * For a constant velocity over the step the path of z is an exponential; it is followed exactly, so that in one
 * direction z depends on the way alone, not on the step. In the middle of the step, where the load is known, z is cut
 * to what the load bears: cut at the start of the step it would be half a step ahead of a falling load.
 *
 * The step takes energy, whatever it starts from. With x = a h, the end of the path at -b, b = z s_0/g - v/|v| at the
 * start, the work h s_0 z_middle v less the growth of s_0 z^2/2 is g^2/s_0 times
 *   x (1 + beta e^(-x/2)) + beta (1 - e^-x) + b^2 (1 - e^-2x)/2,  beta = b v/|v| >= -|b|,
 * at least the integral of |z s_0/g|^2 for beta < 0 and at least x (1 + beta e^(-x/2))^2 for beta > 0. The dashpot s_1
 * z' takes energy while z' has the direction of v (beta < 0), and else at most 4 x beta e^(-x/2) g^2/s_0 is lost to it
 * if s_1 |v| <= 4 g, which that square covers. Hence `scree_bristle_dashpot` (the continuous bound: Barabanov & Ortega,
 * IEEE Trans. Autom. Control 45 (2000) 675). Where z_middle is cut to m g/s_0, m >= 1, what is taken is linear in the
 * cosine c between z and v, and at least x m^2 at c = 1 and c = -1; the dashpot loses 4 x (m c - 1) <= x m^2 at most.
 */
#ifndef SCREE_CONTACT_BRISTLE_H
#define SCREE_CONTACT_BRISTLE_H

#include "contact/law.h"

/* Added to what divides: changes nothing above 1e-184. */
#define SCREE_NO_FORCE 1e-200

/* Deflection in the middle and at the end of a step, and its rate in the middle. */
struct scree_bristle {
    struct vec middle, end, rate;
};

/* (1 - exp(-x))/x for x >= 0; `fallen` is exp(-x). The series' first dropped term is below 2e-16. */
static inline double scree_eased(double x, double fallen) {
    double series = 1.0 - x / 2.0 * (1.0 - x / 3.0 * (1.0 - x / 4.0 * (1.0 - x / 5.0 * (1.0 - x / 6.0))));
    double quotient = (1.0 - fallen) / (x + SCREE_NO_FORCE); /* in any case: a choice of divisions is no vector */
    return x < 0.01 ? series : quotient;
}

/* What a bristle can carry at most: a deflection cut to `most`. */
static inline struct vec scree_bristle_cut(struct vec z, double most) {
    double size = vec_norm(z), share = most / (size + SCREE_NO_FORCE);
    return vec_scale(size > most ? share : 1.0, z);
}

/* 1/s: how fast it turns to saturation g (N; without any, nothing bends). */
static inline double scree_bristle_pace(struct scree_sliding at, double s0, double g) {
    return s0 * vec_norm(at.velocity) / (g + SCREE_NO_FORCE);
}

/* z' at an instant. */
static inline struct vec scree_bristle_rate(struct scree_sliding at, struct vec z, double s0, double g) {
    struct vec v = vec_scale(g > 0.0 ? 1.0 : 0.0, at.velocity);
    return vec_axpy(v, -scree_bristle_pace(at, s0, g), z);
}

/* From deflection z over the step, at stiffness s_0 and saturation g, where the load bears a deflection of `most`. */
static SCREE_INLINE struct scree_bristle scree_bristle_path(struct scree_sliding at, struct vec z, double s0, double g,
                                                            double most) {
    double x = scree_bristle_pace(at, s0, g) * at.half, way = at.half * scree_eased(x, scree_exp(-x));
    /* Written as steps towards v = a z, so that saturation is met to rounding however small the steps. */
    struct scree_bristle path = {.middle = vec_axpy(z, way, scree_bristle_rate(at, z, s0, g))};
    double excess = vec_norm(path.middle) - most, left = 1.0 - excess / (vec_norm(z) + SCREE_NO_FORCE);
    /* A bristle turns the faster the shorter it is: what is cut turns as one that is short enough all along. */
    struct vec fits = vec_scale(left > 0.0 ? left : 0.0, z);
    fits = scree_bristle_cut(vec_axpy(fits, way, scree_bristle_rate(at, fits, s0, g)), most);
    path.middle = excess > 0.0 ? fits : path.middle;
    path.rate = scree_bristle_rate(at, path.middle, s0, g);
    path.end = vec_axpy(path.middle, way, path.rate);
    return path;
}

/* s_1, cut so that the dashpot never drives the sliding. It changes nothing near rest. */
static inline double scree_bristle_dashpot(double s1, double g, double speed) {
    double most = 4.0 * g / (speed + SCREE_NO_SPEED);
    return s1 < most ? s1 : most;
}

/* ---- bristles followed in time, by those who locate where the load falls too fast for them ---- */

/* At an instant: friction's force and the spring's, N; the rate of what is kept, m/s; stiffness, N/m; what the spring
 * bears, N, and how fast its force would outgrow that if the load stayed, N/s (of bristles that slip). */
struct scree_bent {
    struct vec force, elastic, rate;
    double k, bears, grows;
};

/* Along a stretch; without any, along the slip. */
static inline struct vec scree_direction_of(struct vec stretch, struct vec velocity) {
    double size = vec_norm(stretch), speed = vec_norm(velocity);
    if (size > 0.0) return vec_scale(1.0 / size, stretch);
    return vec_scale(speed > 0.0 ? 1.0 / speed : 0.0, velocity);
}

/* `slips`: the load falls too fast, they are bent as far as they bear, whatever the length of the stretch, and only
 * turn. Under next to no load they would give way at once, which no explicit step follows: below a load of `least`, N,
 * they do as there. If it is a hundred thousandth of the load, that leaves out some 1e-10 of friction's impulse. */
static inline struct scree_bent scree_bend(const struct scree_friction_law *friction,
                                           const struct scree_law_constants *law, struct scree_pair_constants pair,
                                           struct scree_sliding at, int slips, double least) {
    struct scree_bent bent = {.k = friction->stiffness(law, pair, at.overlap), .bears = friction->bears(law, at)};
    struct vec stretch = at.stretch, towards = scree_direction_of(stretch, at.velocity);
    if (slips) at.stretch = vec_scale(bent.bears / bent.k, towards);
    bent.force = friction->force(law, pair, at).force;
    bent.elastic = vec_scale(bent.k, at.stretch);
    at.normal = at.normal > least ? at.normal : least;
    bent.rate = friction->rate(law, pair, at);
    if (!slips) return bent;
    double along = vec_dot(bent.rate, towards), length = friction->bears(law, at) / bent.k + SCREE_NO_SPEED;
    bent.grows = bent.k * along;
    bent.rate = vec_scale(vec_norm(stretch) / length, vec_axpy(bent.rate, -along, towards));
    return bent;
}

#endif
