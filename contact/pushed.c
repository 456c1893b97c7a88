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

static void show_one(const struct scree_bodies *bodies, int k, double step, const struct scree_bodies *now) {
    if (bodies->past[k].range < 0.0) scree_ball_show(bodies, k, step, now);
}

void SCREE_PART(show)(const struct scree_bodies *bodies, const struct scree_ends *contact, const int *which, int count,
                      double step, const struct scree_bodies *now) {
    for (int i = 0; i < count; i++) {
        const struct scree_ends *own = &contact[which ? which[i] : i];
        show_one(bodies, own->ball, step, now);
        show_one(bodies, own->host, step, now);
    }
}

void SCREE_PART(show_all)(const struct scree_bodies *bodies, int from, int to, double step,
                          const struct scree_bodies *now) {
    for (int k = from; k < to; k++) show_one(bodies, k, step, now);
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
