/* Two bodies meet head-on: what a normal law makes of it, by integrating the one equation of motion of the pair,
 *   d(overlap)/dt = u,  m du/dt = -F(overlap, u),
 * apart from any scene. The reference for simulated impacts, and the answer where a law has no closed form. */
#ifndef SCREE_CONTACT_IMPACT_H
#define SCREE_CONTACT_IMPACT_H

#include "contact/law.h"

struct scree_impact {
    double restitution; /* speed of parting over speed of meeting; 0 if the bodies don't part */
    double duration;    /* s */
    double deepest;     /* largest overlap, m */
    double force;       /* largest force, N */
};

/* Called after each step of the integration, for force-overlap loops. */
typedef void scree_impact_watch(void *context, double time, double overlap, double closing, double force);

/* Bodies of effective mass `mass` (kg) meet at `speed` (m/s, > 0). `friction` is a constant force (N) that holds them
 * against being driven apart: they keep their speed until the law's force exceeds it, and from then on it drives them
 * together. The law's memory is kept along the way. The contact ends where the force does if the law never pulls, else
 * at zero overlap, or as far apart as the law reaches; bodies that turn back before, or creep for ever, don't part.
 * Relative error about 1e-12 of everything but `force` (1e-10), whatever roots and kinks the law has. `watch` may be
 * NULL. */
struct scree_impact scree_impact(const struct scree_normal_law *law, const struct scree_law_constants *constants,
                                 struct scree_pair_constants pair, double mass, double speed, double friction,
                                 scree_impact_watch *watch, void *context);

#endif
