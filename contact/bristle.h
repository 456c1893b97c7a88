/* A bristle: the deflection z of the asperities of a contact, which lags behind the sliding.
 *   z' = v - a z,  a = |v| s_0/g:  it grows with the slip and saturates at g/s_0 in the direction of sliding
 *   F = s_0 z (+ s_1 z') on the body, against it
 * For a constant velocity over the step the path of z is an exponential; it is followed exactly, so that in one
 * direction z depends on the way alone, not on the step.
 *
 * The step takes energy, whatever it starts from. With x = a h, the end of the path at -b, b = z s_0/g - v/|v| at the
 * start, the work h s_0 z_middle v less the growth of s_0 z^2/2 is g^2/s_0 times
 *   x (1 + beta e^(-x/2)) + beta (1 - e^-x) + b^2 (1 - e^-2x)/2,  beta = b v/|v| >= -|b|,
 * at least the integral of |z s_0/g|^2 for beta < 0 and at least x (1 + beta e^(-x/2))^2 for beta > 0. The dashpot s_1
 * z' takes energy while z' has the direction of v (beta < 0), and else at most 4 x beta e^(-x/2) g^2/s_0 is lost to it
 * if s_1 |v| <= 4 g, which that square covers. Hence `scree_bristle_dashpot` (the continuous bound: Barabanov & Ortega,
 * IEEE Trans. Autom. Control 45 (2000) 675). */
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

/* From deflection z over the step, at stiffness s_0 and saturation g (N; without any, nothing bends). */
static inline struct scree_bristle scree_bristle_path(struct scree_sliding at, struct vec z, double s0, double g) {
    struct vec v = vec_scale(g > 0.0 ? 1.0 : 0.0, at.velocity);
    double a = s0 * vec_norm(at.velocity) / (g + SCREE_NO_FORCE), half = at.half;
    double fallen = scree_exp(-a * half), way = half * scree_eased(a * half, fallen);
    /* Written as steps towards v = a z, so that saturation is met to rounding however small the steps. */
    struct scree_bristle path;
    struct vec rate = vec_axpy(v, -a, z);
    path.rate = vec_scale(fallen, rate);
    path.middle = vec_axpy(z, way, rate);
    path.end = vec_axpy(path.middle, way, path.rate);
    return path;
}

/* z' at an instant. */
static inline struct vec scree_bristle_rate(struct scree_sliding at, struct vec z, double s0, double g) {
    at.half = 0.0;
    return scree_bristle_path(at, z, s0, g).rate;
}

/* What a bristle can carry at most: a deflection cut to `most`. The load may have fallen while nothing slid. */
static inline struct vec scree_bristle_cut(struct vec z, double most) {
    double size = vec_norm(z), share = most / (size + SCREE_NO_FORCE);
    return vec_scale(size > most ? share : 1.0, z);
}

/* s_1, cut so that the dashpot never drives the sliding. It changes nothing near rest. */
static inline double scree_bristle_dashpot(double s1, double g, double speed) {
    double most = 4.0 * g / (speed + SCREE_NO_SPEED);
    return s1 < most ? s1 : most;
}

#endif
