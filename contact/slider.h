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

/* Forces in N: `holds` is the largest that the slider bears, `slides` (<= holds) that with which it slides. k > 0, c >=
 * 0. */
static SCREE_INLINE struct scree_tangential scree_slider(struct scree_sliding at, double k, double c, double holds,
                                                         double slides) {
    double stiff = at.half * k + SCREE_NO_SPEED, first = c + stiff, part = stiff / first;
    double other = first + stiff * part, inverse = 1.0 / other, gone = (stiff + stiff) * inverse;
    double late = at.sliding > 0.0 ? at.half * part : 0.0, drag = at.sliding > 0.0 ? other : first;
    struct vec trial = vec_axpy(vec_scale(k, at.stretch), drag, at.velocity);
    double size = vec_norm(trial), step = at.half + at.half;
    int sliding = size > holds;
    double scale = sliding ? slides / (size + SCREE_NO_SPEED) : 1.0;
    double way = sliding ? scale * step * (drag * inverse) : step + late;
    struct vec stretch = vec_axpy(vec_scale(1.0 + gone * (scale - 1.0), at.stretch), way, at.velocity);
    return (struct scree_tangential){vec_scale(-scale, trial), stretch, sliding ? 1.0 : 0.0};
}

#endif
