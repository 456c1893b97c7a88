/* What the files that take slabs through a step, or several, share: between slabs.c and sweep.c, but for the room that
 * gates need (contacts.c). */
#ifndef SCREE_CONTACT_SLABS_H
#define SCREE_CONTACT_SLABS_H

#include "contact/loop.h"

#include <stdatomic.h>

/* How far a slab is: contacts to come touch no body of it before place `own`, and none of the next one before `next`.
 * A line of cache each. */
struct scree_front {
    _Alignas(64) atomic_int own;
    atomic_int next;
};

struct scree_slabs {
    struct scree_contacts *contacts;
    struct scree_bodies *bodies;
    double step;
    scree_segment_work *work; /* with its argument */
    void *argument;
    const struct scree_departure *go; /* NULL: bodies stay where they are */
    int slabs, team;                  /* so many threads share them, */
    atomic_int begun;                 /* of which so many have begun */
    double *before;                   /* work of the slabs before each, where there are several threads */
    atomic_char *state;               /* of each slab */
    struct scree_front *front;
};

static inline int scree_begins_stretch(int slab) { return slab % SCREE_STRETCH == 0; }

/* The last of a stretch, but of the last one. */
static inline int scree_ends_stretch(const struct scree_slabs *all, int slab) {
    return slab + 1 < all->slabs && scree_begins_stretch(slab + 1);
}

enum { SCREE_SHORTEST_STRIP = 96 };

/* How many bodies a strip has (slabs.c), of a slab of so many: a 24th of them, so many that the loop is worth
 * beginning, and so few that what the next strip needs, which is asked for during this one, stays in the nearest
 * caches. (By strips of 190 a million spheres take 0.96 of the time that they take by strips of 650, by those of 250
 * 0.98; 100,000 0.99, on two threads 1.01, of the time by strips of 230.) */
static inline int scree_strip_of(int members) {
    enum { USUAL = 24, LONGEST = 190 };
    int width = (members + USUAL - 1) / USUAL;
    if (width < SCREE_SHORTEST_STRIP) return SCREE_SHORTEST_STRIP;
    return width < LONGEST ? width : LONGEST;
}

/* The gates of a slab's strips: all but the last one of each slab have SCREE_SHORTEST_STRIP bodies or more. */
static inline struct scree_gate *scree_gates_of(const struct scree_contacts *contacts, const struct scree_order *order,
                                                int slab) {
    return contacts->gate + (order->start[slab] - order->members) / SCREE_SHORTEST_STRIP + slab;
}

/* One slab through a step, in a sweep the one after `lap` others. `at_border`: as in scree_trail. */
void scree_act_slab(struct scree_slabs *all, int slab, int lap, int at_border);

/* Before the first slab of a step: what it has found, of the step after `lap` others. */
void scree_begin_tallies(struct scree_contacts *contacts, int slabs, int lap);

/* All slabs through the steps of a sweep, or what is left of it (sweep.c). Returns 1 if lists must be renewed. */
int scree_sweep_slabs(struct scree_slabs *all);

/* What slabs have found in a step, in their order, into the sums of the scene. */
void scree_add_tallies(struct scree_contacts *contacts, const struct scree_bodies *bodies, int lap);

#endif
