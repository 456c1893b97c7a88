/* A slider with a spring and a dashpot side by side behind it: what the laws that truly stick have in common.
 *   F = -(k s + c v) while |F| <= holds; then |F| = slides against the slip, and spring and dashpot carry that force:
 *   k s + c s' = -F
 * Slider and dashpot only take energy out.
 *
 * The stretch of a contact that slides without a dashpot is that of its force, so it belongs to the middle of the step,
 * not to its end: the next middle is a whole step ahead, not half of one. Otherwise a contact would go on sliding until
 * the load falls only half as fast as the spring relaxes, at any step. With a dashpot the stretch lags behind the force
 * by c/k, and the step ahead shrinks to the half again. Still passive: over a sliding step from s_0 to s = share x (s_0
 * + p), p = h v, the energy taken is k/2 (|p - (1 - share)(s_0 + p)|^2 + 2 share (1 - share) |s_0 + p|^2). The first
 * step that sticks again catches up to its end if that takes energy too, k/2 (-s_0 p - p^2/4) >= 0: where the slip has
 * turned round. */
#ifndef SCREE_CONTACT_SLIDER_H
#define SCREE_CONTACT_SLIDER_H

#include "contact/law.h"

/* Forces in N: `holds` is the largest that the slider bears, `slides` (<= holds) that with which it slides. k > 0, c >=
 * 0; `lag` is c/(c + half k), `slack` (lag^2 - 1)/k. */
static SCREE_INLINE struct scree_tangential scree_slider_lagging(struct scree_sliding at, double k, double c,
                                                                 double lag, double slack, double holds,
                                                                 double slides) {
    double late = at.sliding > 0.0 ? (1.0 - lag) * at.half : 0.0;
    struct vec middle = vec_axpy(at.stretch, at.half + late, at.velocity);
    struct vec trial = vec_axpy(vec_scale(-k, middle), -c, at.velocity);
    double size = vec_norm(trial);
    int sliding = size > holds;
    double scale = sliding ? slides / (size + SCREE_NO_SPEED) : 1.0;
    struct vec force = vec_scale(scale, trial);
    /* Two implicit half steps of k s + c s' = -F: what the spring keeps of its stretch, and what it takes on. */
    struct vec slid = vec_axpy(vec_scale(lag * lag, at.stretch), slack, force);
    double turned = -2.0 * vec_dot(at.stretch, at.velocity) - at.half * vec_norm2(at.velocity);
    struct vec stuck = vec_axpy(middle, turned >= 0.0 ? at.half : at.half - late, at.velocity);
    struct vec stretch = sliding ? slid : stuck;
    return (struct scree_tangential){force, stretch, sliding ? 1.0 : 0.0};
}

static SCREE_INLINE struct scree_tangential scree_slider(struct scree_sliding at, double k, double c, double holds,
                                                         double slides) {
    double lag = c / (c + at.half * k + SCREE_NO_SPEED);
    return scree_slider_lagging(at, k, c, lag, (lag * lag - 1.0) / k, holds, slides);
}

#endif
