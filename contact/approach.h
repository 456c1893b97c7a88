/* Pairs of spheres on their flights: how they pass each other is a matter of chance, so that nothing branches on it.
 * For the lists. */
#ifndef SCREE_CONTACT_APPROACH_H
#define SCREE_CONTACT_APPROACH_H

#include "contact/contacts.h"

/* The share of the way that flights lead which lies in half a step. Near lists count from half a step ago: what has
 * parted since then acts in the step still (scree_share_of); it has parted by less than its flights lead apart in that
 * time and both bodies may still go, but for `bend`. */
static inline double scree_half_step_of(const struct scree_contacts *contacts, const struct scree_bodies *bodies) {
    double ahead = contacts->flights.ahead;
    return bodies->flight && ahead > 0.0 ? 0.5 * contacts->step / ahead : 0.0;
}

/* Whether two come within `reach` on the way that they fly, from the share `back` of it before `apart` on. Without
 * roots; rounding can only make a pair near. */
static SCREE_INLINE int scree_come_near(struct vec apart, struct vec flown, double back, double reach) {
    double square = scree_nearest2(vec_axpy(apart, -back, flown), vec_scale(1.0 + back, flown));
    return square > reach * reach * (1.0 + 1e-12) ? 0 : 1;
}

/* Columns: the way from one to the other, the way that it flies, how far they are apart when they are near, m; whether
 * they come near: 1, or 0. */
struct scree_approaches {
    double x[SCREE_LANES], y[SCREE_LANES], z[SCREE_LANES];
    double flown_x[SCREE_LANES], flown_y[SCREE_LANES], flown_z[SCREE_LANES];
    double reach[SCREE_LANES], near[SCREE_LANES];
};

static SCREE_INLINE void scree_put_approach(struct scree_approaches *a, int k, struct vec apart, struct vec flown,
                                            double reach) {
    a->x[k] = apart.x;
    a->y[k] = apart.y;
    a->z[k] = apart.z;
    a->flown_x[k] = flown.x;
    a->flown_y[k] = flown.y;
    a->flown_z[k] = flown.z;
    a->reach[k] = reach;
}

/* Several at once, from where they are. */
static inline void scree_judge_approaches(struct scree_approaches *a, int count) {
    _Pragma("omp simd")
    for (int k = 0; k < count; k++) {
        struct vec apart = vec(a->x[k], a->y[k], a->z[k]), flown = vec(a->flown_x[k], a->flown_y[k], a->flown_z[k]);
        a->near[k] = scree_come_near(apart, flown, 0.0, a->reach[k]) ? 1.0 : 0.0;
    }
}

#endif
