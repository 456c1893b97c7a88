/* Balls, and what they meet, as contacts ask for them that aren't steady: at the start of a step by pair impulses, with
 * what goes on as in the last two steps. Each window of contacts has its own, which stay in the caches: kept with the
 * bodies they would go through them and back in every step. */
#ifndef SCREE_CONTACT_STARTS_H
#define SCREE_CONTACT_STARTS_H

#include "contact/contacts.h"

enum {
    SCREE_WINDOW_LANES = SCREE_WINDOW * SCREE_LANES,
    SCREE_MOST_STARTS = 2 * SCREE_WINDOW_LANES,
    SCREE_START_TABLE = 2 * SCREE_MOST_STARTS /* a power of two */
};

/* Bodies have slots, in the order in which contacts ask for them. */
struct scree_starts {
    _Alignas(64) struct scree_record record[SCREE_MOST_STARTS]; /* the first two rows */
    struct scree_push push[SCREE_MOST_STARTS];
    struct scree_spin spin[SCREE_MOST_STARTS];
    struct scree_ends slot[SCREE_WINDOW_LANES]; /* of the two bodies of each contact that has asked */
    int count, body[SCREE_MOST_STARTS];         /* which body is in a slot */
    int16_t slot_of[SCREE_START_TABLE];         /* by a body's place, or in the next free row behind that; -1: free */
};

/* Nobody is shown yet. */
static inline void scree_begin_starts(struct scree_starts *starts) {
    starts->count = 0;
    memset(starts->slot_of, -1, sizeof starts->slot_of);
}

/* The slot of a body, or (`is_new`) where it is to be shown. */
static inline int scree_slot_of(struct scree_starts *starts, int body, int *is_new) {
    unsigned row = (unsigned)body % SCREE_START_TABLE;
    while (starts->slot_of[row] >= 0 && starts->body[starts->slot_of[row]] != body) row = (row + 1) % SCREE_START_TABLE;
    *is_new = starts->slot_of[row] < 0;
    if (!*is_new) return starts->slot_of[row];
    starts->slot_of[row] = (int16_t)starts->count;
    starts->body[starts->count] = body;
    return starts->count++;
}

#endif
