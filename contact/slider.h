/* A slider with a spring and a dashpot side by side behind it: what the laws that truly stick have in common.
 *   F = -(k s + c v) while |F| <= holds; then |F| = slides against the slip, and spring and dashpot carry that force:
 *   k s + c s' = -F
 * Slider and dashpot only take energy out. */
#ifndef SCREE_CONTACT_SLIDER_H
#define SCREE_CONTACT_SLIDER_H

#include "contact/law.h"

/* Forces in N: `holds` is the largest that the slider bears, `slides` (<= holds) that with which it slides. k > 0, c >= 0. */
static inline struct scree_tangential scree_slider(struct scree_sliding at, double k, double c, double holds,
                                                   double slides) {
    struct vec middle = vec_axpy(at.stretch, at.half, at.velocity);
    struct vec trial = vec_axpy(vec_scale(-k, middle), -c, at.velocity);
    double size = vec_norm(trial);
    int sliding = size > holds;
    double scale = sliding ? slides / (size + SCREE_NO_SPEED) : 1.0;
    struct vec force = vec_scale(scale, trial);
    /* Two implicit half steps of k s + c s' = -F: what the spring keeps of its stretch, and what it takes on. */
    double lag = c / (c + at.half * k + SCREE_NO_SPEED), keeps = lag * lag;
    struct vec slid = vec_axpy(vec_scale(keeps, at.stretch), (keeps - 1.0) / k, force);
    struct vec stuck = vec_axpy(middle, at.half, at.velocity);
    struct vec stretch = sliding ? slid : stuck;
    return (struct scree_tangential){force, stretch, sliding ? 1.0 : 0.0};
}

#endif
