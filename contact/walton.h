/* What the hysteretic springs of Walton & Braun share: stiffness K1 while the overlap is larger than ever before, and
 * K2 >= K1 from the largest overlap D back.
 *   F = max(0, K1 D - K2 (D - d)),  K2 = fixed + S K1 D
 * Kept of a contact: the largest overlap. The force vanishes at d0 = D (1 - K1/K2), and that is the end of a free
 * impact; the rest of the overlap opens without a force, and the memory ends with it. */
#ifndef SCREE_CONTACT_WALTON_H
#define SCREE_CONTACT_WALTON_H

#include "contact/law.h"

enum { WALTON_LOADING, WALTON_UNLOADING, WALTON_SLOPE }; /* pair constants: K1, the fixed part of K2, S */

static SCREE_INLINE struct scree_normal_force walton_force(struct scree_pair_constants pair, struct scree_pressing at) {
    int touching = at.overlap > 0.0, further = at.overlap > at.first;
    double largest = further ? at.overlap : at.first, load = pair.c[WALTON_LOADING] * largest;
    double unloading = pair.c[WALTON_UNLOADING] + pair.c[WALTON_SLOPE] * load;
    double force = load - unloading * (largest - at.overlap);
    double given_back = force > 0.0 ? force : 0.0;
    /* Of the work of loading, F^2/(2 K2) can come back. */
    double share = pair.c[WALTON_LOADING] / unloading * (1.0 - 0.5 * pair.c[WALTON_SLOPE] * load / unloading);
    double reversible = further && at.closing > 0.0 ? share * given_back : given_back;
    return (struct scree_normal_force){force, 0.0, reversible, touching ? largest : 0.0, 0.0};
}

static SCREE_INLINE double walton_stored(const struct scree_law_constants *law, struct scree_pair_constants pair,
                                         struct scree_pressing at) {
    (void)law;
    double largest = at.overlap > at.first ? at.overlap : at.first, load = pair.c[WALTON_LOADING] * largest;
    double unloading = pair.c[WALTON_UNLOADING] + pair.c[WALTON_SLOPE] * load;
    double force = load - unloading * (largest - at.overlap);
    return force > 0.0 ? 0.5 * force * force / unloading : 0.0;
}

/* Where it is pressed further than ever before. */
static SCREE_INLINE int walton_bends(const struct scree_law_constants *law, struct scree_pair_constants pair,
                                     struct scree_pressing from, struct scree_pressing to) {
    (void)law;
    (void)pair;
    return from.overlap < from.first * (1.0 - 1e-12) && to.overlap > from.first;
}

#endif
