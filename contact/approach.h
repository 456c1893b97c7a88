/* Pairs of spheres on their flights, several at once: how they pass each other is a matter of chance, so that nothing
 * branches on it. For the lists. */
#ifndef SCREE_CONTACT_APPROACH_H
#define SCREE_CONTACT_APPROACH_H

#include "contact/contacts.h"

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

/* Without roots. Rounding can only make a pair near. */
static inline void scree_judge_approaches(struct scree_approaches *a, int count) {
    _Pragma("omp simd")
    for (int k = 0; k < count; k++) {
        struct vec apart = vec(a->x[k], a->y[k], a->z[k]), flown = vec(a->flown_x[k], a->flown_y[k], a->flown_z[k]);
        double reach = a->reach[k];
        a->near[k] = scree_nearest2(apart, flown) > reach * reach * (1.0 + 1e-12) ? 0.0 : 1.0;
    }
}

#endif
