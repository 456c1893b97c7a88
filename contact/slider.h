/* A slider with a spring and a dashpot side by side behind it: what the laws that truly stick have in common.
 *   F = -(k s + c v) while |F| <= holds; then |F| = slides against the slip, and spring and dashpot carry that force:
 *   k s + c s' = -F
 * Slider and dashpot only take energy out.
 *
 * The stretch of a contact that slides without a dashpot is that of its force, so it belongs to the middle of the step,
 * not to its end: the next middle is a whole step ahead, not half of one, and the first step that sticks again goes on
 * for one and a half. Otherwise a contact would go on sliding until the load falls only half as fast as the spring
 * relaxes, at any step, and lack half a step of its stretch for as long as it sticks. With a dashpot the stretch
 * relaxes behind the force at the rate k/c, by the approximant of exp(-z) of orders 0 and 2, z = h k/c,
 *
 *   s = E s_0 - (1 - E) F/k,  E = 1/(1 + z + z^2/2)
 *
 * and is late by p h/2, p = (h k/2)/(c + h k/2): nothing for small z, h/2 for large. All that is of second order. With
 * G the factor of the velocity in the trial force, G = c + h k/2 before a first sliding step, D = G + p h k/2 before
 * any other, this is 1 - E = h k/D, and (1 - E) G/k = h G/D: a step from s_0 ends at multiples of s_0 and of h v alone.
 *
 * A sliding step after another takes energy out whatever the load: with P = -F, Q = P - k s_0 it is done at least the
 * work (1 - E)/k P.Q, and the spring takes (1 - E)/k (k s_0.Q + (1 - E) Q^2/2) of it. The step that sticks again takes
 * out k/2 (-s_0.p - p^2/4), p = h v, behind a bare spring: positive at constant load; while the load grows the spring
 * gets back what the sliding steps took too much, half a step's growth. */
#ifndef SCREE_CONTACT_SLIDER_H
#define SCREE_CONTACT_SLIDER_H

#include "contact/law.h"

/* Added to dashpots before they divide, and large enough for its third power: changes none above 1e-74 N s/m. */
#define SCREE_NO_DRAG 1e-90

/* k > 0, c >= 0. A bare spring (first = stiff) divides nothing; a dashpot takes one quotient for two. */
static SCREE_INLINE struct scree_slider scree_slider_of(struct scree_sliding at, double k, double c,
                                                        struct scree_hold hold) {
    double step = at.half + at.half, stiff = at.half * k + SCREE_NO_DRAG;
    int slid = at.sliding > 0.0;
    if (at.bare)
        return (struct scree_slider){
            k, slid ? stiff + stiff : stiff, 1.0, slid ? step : at.half, slid ? step + at.half : step, hold};
    double first = c * (1.0 - at.apart) + stiff, square = first * first, both = square + stiff * stiff;
    double inverse = 1.0 / (first * both), part = stiff * (both * inverse); /* stiff/first */
    double goes = step * (square * (first * inverse)), gone = (stiff + stiff) * (square * inverse);
    double late = at.half * part, other = first + stiff * part;
    return (struct scree_slider){k, slid ? other : first, gone, slid ? step : goes, slid ? step + late : step, hold};
}

static SCREE_INLINE struct vec scree_slider_trial(double k, double drag, struct vec stretch, struct vec velocity) {
    return vec_axpy(vec_scale(k, stretch), drag, velocity);
}

/* The force with which it slides, over a trial force of that size. */
static SCREE_INLINE double scree_slider_share(double slides, double size) { return slides / (size + SCREE_NO_SPEED); }

/* The end of the step; `share` counts if the trial force is more than the slider holds. */
static SCREE_INLINE struct scree_tangential scree_slider_end(struct scree_slider slider, struct vec trial, double size,
                                                             double share, struct vec stretch, struct vec velocity) {
    double holds = slider.bears.holds, scale = size > holds ? share : 1.0, goes = share * slider.goes;
    double way = size > holds ? goes : slider.stays;
    struct vec kept = vec_scale(1.0 + slider.gone * (scale - 1.0), stretch);
    return (struct scree_tangential){vec_scale(-scale, trial), vec_axpy(kept, way, velocity), size > holds ? 1.0 : 0.0};
}

/* ---- a slider followed in time, by those who locate where it breaks loose and where it holds again ---- */

/* So much of a step behind its begin, or before its end, the load on a slider is asked for once more: inside the step,
 * where its formula holds. */
#define SCREE_SO_SOON 1e-5

/* Where a slider may have changed twice, steps are halved until they are so much shorter. */
enum { SCREE_FINEST = 40 };

/* How far a slider that holds, or one that slides behind a dashpot, is from changing, in squares, N^2; `bears`: the
 * square of what spring and dashpot would bear, N^2; `holds` and `slides`: scree_hold. (Numbers, not choices, which
 * keep gcc from making vectors.) */
static SCREE_INLINE double scree_left(int bare, double sliding, double bears, double holds, double slides) {
    double held = sliding > 0.0 ? 0.0 : 1.0, left = held * (holds * holds - bears);
    return bare ? left : left + (1.0 - held) * (bears - slides * slides);
}

/* Whether it may have changed twice on the way, where nothing is to be seen of it at the end: whether the parabola
 * through begin, middle and end falls below zero, by a twenty-thousandth of the load `slides` at least. 1 or 0. */
static SCREE_INLINE double scree_dips(double begin, double middle, double last, double slides) {
    double bend = 2.0 * (begin - 2.0 * middle + last), slope = 4.0 * middle - 3.0 * begin - last;
    int inside = (begin >= 0.0) & (last >= 0.0) & (slope < 0.0) & (slope + 2.0 * bend > 0.0);
    return (inside & (slope * slope > 4.0 * bend * (begin + 1e-4 * slides * slides))) ? 1.0 : 0.0;
}

/* By how much a slider that should have changed at the begin of a step may be off, and it doesn't count: by rounding,
 * where it has just been on the verge; behind a bare spring, whose force doesn't jump there unless the normal law
 * changes its formula, by a hundred thousandth of the load, N, or while it slides by what makes so much in a step, m/s.
 * (At rest it is on the verge but for the small motions of others.) */
static SCREE_INLINE double scree_nearly(int bare, double sliding, double slides, double stiffness, double step) {
    double force = (bare ? 1e-5 : 1e-9) * slides, speed = force / (stiffness * step);
    return ((bare != 0) & (sliding > 0.0)) ? speed : force;
}

/* Spring, dashpot and slider at an instant: stiffness, N/m; damping, N s/m; the force with which it slides, N; how it
 * is dragged, m/s; what spring and dashpot carry, N; the stretch, m; what it holds, N, if that is asked for. */
struct scree_drawn {
    double k, drag, limit;
    struct vec slip, carries, stretch;
    double holds;
};

/* `time` after `first` a slider that has slid all along slides with a force along what spring and dashpot would bear,
 *
 *   k s + c s' = P,  P = limit (k s + c v)/|k s + c v|
 *
 * which is stiff: its rate is k/c, and where there is no dashpot P turns towards v at the rate k v/limit. So s goes by
 * the approximant of exp(-z) of orders 0 and 2, 1/(1 + z + z^2/2), z = k time/c, with P linear in time; the direction
 * of P likewise: of second order for any rate. Sets what is carried and the stretch of `at`. Where what is kept is the
 * force of the spring, first->stretch is that force over the stiffness of `at`, and `share` the stiffness of `first`
 * over that of `at`; else it is 1. */
static SCREE_INLINE void scree_draw_on(const struct scree_drawn *first, double share, double time, int bare,
                                       struct scree_drawn *at) {
    const double none = 1e-100; /* m, N, N s/m: divides where there is nothing yet */
    double own = first->limit + none, reach = own / first->k + at->limit * (1.0 / at->k);
    double per = 1.0 / (own * reach), turning = time * per * vec_dot(first->carries, at->slip);
    turning = turning > -0.5 ? turning : -0.5;
    struct vec goes = vec_axpy(vec_scale(0.5, vec_add(first->slip, at->slip)), turning, at->slip);
    struct vec pulls = vec_axpy(vec_scale(0.5 * reach * reach * per, first->carries), time, goes);
    if (bare) {
        at->carries = vec_scale(at->limit / (vec_norm(pulls) + SCREE_NO_SPEED), pulls);
        at->stretch = vec_scale(1.0 / at->k, at->carries);
        return;
    }
    double before = 1.0 / (first->drag + none), after = 1.0 / (at->drag + none);
    double z = 0.5 * time * (first->k * before + at->k * after), square = z * z;
    struct vec twice = vec_scale(2.0, first->stretch);
    pulls = vec_scale(at->k, vec_axpy(twice, z, pulls));
    pulls = vec_axpy(pulls, 2.0 * at->drag * (1.0 + z), at->slip);
    at->carries = vec_scale(at->limit / (vec_norm(pulls) + SCREE_NO_SPEED), pulls);
    struct vec stretch = vec_axpy(twice, time * (before * share), first->carries);
    stretch = vec_axpy(stretch, time * after + square * (1.0 / at->k), at->carries);
    at->stretch = vec_scale(1.0 / (2.0 + 2.0 * z + square), stretch);
}

/* The whole step. */
static SCREE_INLINE struct scree_tangential scree_slide(struct scree_sliding at, struct scree_slider slider) {
    struct vec trial = scree_slider_trial(slider.k, slider.drag, at.stretch, at.velocity);
    double size = vec_norm(trial), share = scree_slider_share(slider.bears.slides, size);
    return scree_slider_end(slider, trial, size, share, at.stretch, at.velocity);
}

#endif
