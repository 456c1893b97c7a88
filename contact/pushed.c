/* Balls before and behind the contacts of a step of the pair-impulse method, one after the other. Compiled once for
 * each kind of processor, as loop.c is. */
#include "bodies/pushed.h"
#include "contact/loop.h"

int SCREE_PART(look_both)(struct scree_bodies *bodies, int from, int to, double step, const double gravity[3],
                          double margin) {
    int too_far = 0;
    for (int k = from; k < to; k++)
        if (bodies->class[k] == SCREE_CLASS_BALL)
            too_far |= scree_ball_look_both(bodies, k, step, scree_row_of(gravity), margin);
    return too_far;
}

static int show_one(const struct scree_bodies *bodies, const struct scree_bodies *now, int k, double step,
                    struct scree_starts *starts) {
    int is_new, slot = scree_slot_of(starts, k, &is_new);
    if (!is_new) return slot;
    if (bodies->class[k] == SCREE_CLASS_BALL) {
        scree_ball_show(bodies, k, step, &starts->record[slot], &starts->spin[slot], &starts->push[slot]);
    } else {
        starts->record[slot] = now->record[k];
        starts->spin[slot] = now->spin[k];
        starts->push[slot] = scree_body_push(bodies, k, step);
    }
    return slot;
}

void SCREE_PART(show)(const struct scree_bodies *bodies, const struct scree_bodies *now,
                      const struct scree_ends *contact, const int *lane, int count, double step,
                      struct scree_ends *slot, struct scree_starts *starts) {
    for (int i = 0; i < count; i++) {
        int k = lane ? lane[i] : i;
        slot[k].ball = show_one(bodies, now, contact[k].ball, step, starts);
        slot[k].host = show_one(bodies, now, contact[k].host, step, starts);
    }
}

void SCREE_PART(advance_by_moments)(struct scree_bodies *bodies, int from, int to, double step,
                                    const double gravity[3]) {
    for (int k = from; k < to; k++)
        if (bodies->class[k] == SCREE_CLASS_BALL) scree_ball_advance_by_moments(bodies, k, step, scree_row_of(gravity));
}

/* One after the other: the move of scree_loop. */
int SCREE_PART(move_by_moments)(struct scree_bodies *bodies, int from, int to, const struct scree_departure *go,
                                const unsigned char *lent, int wanted) {
    scree_row gravity = scree_row_of(go->gravity), next = scree_row_of(go->next_gravity);
    int too_far = 0;
    for (int k = from; k < to; k++) {
        if (bodies->class[k] != SCREE_CLASS_BALL || (lent && lent[k] != wanted)) continue;
        if (go->ahead)
            too_far |= scree_ball_move_by_moments(bodies, k, go->step, gravity, next, go->margin);
        else
            scree_ball_advance_by_moments(bodies, k, go->step, gravity);
    }
    return too_far;
}
