/* Sleep: bodies that rest are left alone, and so are contacts between them, until somebody pushes.
 *
 * A free ball or box falls asleep that has been slower than `speed` at 16 looks, 64 steps apart, and whose forces are
 * balanced; it wakes in the step in which they are off balance by more than four times as much. All this is told by
 * bodies and by what touches, never by what else lists hold: so the result depends neither on lists nor on breaks nor
 * on threads. Asleep, a body has no speed and is where it was; what laws keep of contacts between sleepers stays as it
 * was.
 *
 * Contacts between those who sleep or never move are still, and left out. Sleepers that somebody may push are the
 * border: what their still contacts press is added up once, so that their balance is known in every step. */
#ifndef SCREE_CONTACT_REST_H
#define SCREE_CONTACT_REST_H

#include "contact/contacts.h"

static inline int scree_is_still(const struct scree_bodies *bodies, const struct scree_ends *contact) {
    int ball = bodies->class[contact->ball], host = bodies->class[contact->host];
    return (ball == SCREE_CLASS_FIXED || ball == SCREE_CLASS_ASLEEP) &&
           (host == SCREE_CLASS_FIXED || host == SCREE_CLASS_ASLEEP);
}

/* Let bodies sleep that are slower than `speed`, m/s, with forces off balance by less than `pull`, m/s^2.
 * SCREE_NO_MEMORY. */
scree_status scree_rest_allow(struct scree_contacts *contacts, struct scree_bodies *bodies, double speed, double pull,
                              scree_trouble *trouble);

/* Before the step's contacts: see which are still, and load the border with what these press. SCREE_NO_MEMORY. */
scree_status scree_rest_prepare(struct scree_contacts *contacts, struct scree_bodies *bodies, double step,
                                scree_trouble *trouble);

/* Contacts of a slab's segment that aren't still through one step, as scree_loop.act_straight. */
void scree_rest_act(const struct scree_contacts *contacts, struct scree_bodies *bodies, const struct scree_batch *batch,
                    const struct scree_part *segment, double step, struct scree_tally *tally);

/* Segment 0 goes by whole blocks: those with a contact that isn't still. What laws keep of the others in them is as it
 * was afterwards. */
static inline int scree_rest_works(const struct scree_contacts *contacts, const struct scree_batch *batch, int block) {
    return contacts->rest.asleep == 0 || batch->works[block];
}
void scree_rest_give_back(const struct scree_batch *batch);

/* After a step: sleepers wake whose forces aren't balanced. `ahead`: members of slabs are at the middle of the next
 * step already. */
void scree_rest_wake(struct scree_contacts *contacts, struct scree_bodies *bodies, double step, const double gravity[3],
                     int ahead);

/* After those steps of which this is true, none being ahead: see who rests, and who has rested long enough. */
int scree_rest_is_look(long steps);
void scree_rest_look(struct scree_contacts *contacts, struct scree_bodies *bodies, double step,
                     const double gravity[3]);

#endif
