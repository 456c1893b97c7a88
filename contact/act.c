/* All near contacts through one step: the loop over batches and blocks, and the adding up of what they yield. */
#include "contact/loop.h"

static int contacts_in_block(const struct scree_batch *batch, int block) {
    int left = batch->count - block * SCREE_LANES;
    return left < SCREE_LANES ? left : SCREE_LANES;
}

static void add_to_bodies(struct scree_bodies *bodies, const struct scree_contact *contact,
                          const struct scree_yield *yield, int lane, int turns) {
    struct scree_record *ball = &bodies->record[contact->ball], *host = &bodies->record[contact->host];
    for (int k = 0; k < 3; k++) {
        ball->f[k] += yield->impulse[k][lane];
        host->f[k] -= yield->impulse[k][lane];
    }
    for (int k = 0; turns && k < 3; k++) {
        ball->t[k] += yield->turn_ball[k][lane];
        host->t[k] += yield->turn_host[k][lane];
    }
}

/* Keep the largest value so far, and whose it was. */
static inline void note(double value, const struct scree_contact *contact, double *largest, int *ball, int *host) {
    if (value <= *largest) return;
    *largest = value;
    *ball = contact->ball;
    *host = contact->host;
}

static inline void collect(struct scree_contacts *contacts, struct scree_bodies *bodies,
                           const struct scree_batch *batch, int block) {
    const struct scree_contact *contact = batch->contact + block * SCREE_LANES;
    const struct scree_yield *yield = &batch->yield[block];
    for (int lane = 0; lane < contacts_in_block(batch, block); lane++) {
        add_to_bodies(bodies, &contact[lane], yield, lane, scree_contact_turns(batch, &contact[lane]));
        note(yield->depth[lane], &contact[lane], &contacts->deepest, &contacts->deepest_ball, &contacts->deepest_host);
        note(yield->steep[lane], &contact[lane], &contacts->steepest, &contacts->steepest_ball,
             &contacts->steepest_host);
    }
    if (contacts->measured) {
        contacts->lost_normal += yield->lost_normal;
        contacts->work_tangential += yield->work_tangential;
    }
}

void scree_contacts_collect(struct scree_contacts *contacts, struct scree_bodies *bodies,
                            const struct scree_batch *batch, int block) {
    collect(contacts, bodies, batch, block);
}

/* Blocks are independent of each other; a team of threads pays from some dozens of them on. */
static void act_blocks(struct scree_contacts *contacts, struct scree_bodies *bodies, const struct scree_batch *batch,
                       int blocks, double step, int threads) {
    if (threads > 1 && blocks > 64) {
#pragma omp parallel for schedule(static) num_threads(threads)
        for (int block = 0; block < blocks; block++)
            contacts->loop->act(contacts, bodies, batch, block * SCREE_LANES, contacts_in_block(batch, block), step,
                                &batch->yield[block]);
    } else {
        for (int block = 0; block < blocks; block++)
            contacts->loop->act(contacts, bodies, batch, block * SCREE_LANES, contacts_in_block(batch, block), step,
                                &batch->yield[block]);
    }
}

void scree_contacts_act(struct scree_contacts *contacts, struct scree_bodies *bodies, double step, int threads) {
    for (int k = 0; k < contacts->busy_batches; k++) {
        const struct scree_batch *batch = &contacts->batch[contacts->busy[k]];
        int blocks = (batch->count + SCREE_LANES - 1) / SCREE_LANES;
        act_blocks(contacts, bodies, batch, blocks, step, threads);
        for (int block = 0; block < blocks; block++) collect(contacts, bodies, batch, block);
    }
}
