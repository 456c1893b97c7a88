/* All near contacts through one step.
 *
 * Segment 0 first: its blocks yield impulses by as many threads, and these are added to the bodies one after the other.
 * Then the segments of the slabs (slabs.c). */
#include "contact/loop.h"
#include "contact/rest.h"

/* ---- segment 0 ---- */

static void add_to_bodies(struct scree_bodies *bodies, const struct scree_contact *contact,
                          const struct scree_yield *yield, int lane, int turns) {
    struct scree_record *ball = &bodies->record[contact->ball], *host = &bodies->record[contact->host];
    for (int k = 0; k < 3; k++) {
        ball->impulse[k] += yield->impulse[k][lane];
        host->impulse[k] -= yield->impulse[k][lane];
    }
    for (int k = 0; turns && k < 3; k++) {
        ball->turn[k] += yield->turn_ball[k][lane];
        host->turn[k] += yield->turn_host[k][lane];
    }
}

void scree_contacts_collect(struct scree_contacts *contacts, struct scree_bodies *bodies,
                            const struct scree_batch *batch, int block) {
    int first = batch->segment[0].first + block * SCREE_LANES;
    const struct scree_yield *yield = &batch->yield[block];
    if (batch->geometry == SCREE_EDGE_EDGE && yield->silent) return;
    for (int lane = 0; lane < scree_contacts_in_block(batch, block); lane++) {
        struct scree_contact contact = scree_contact_at(batch, first + lane);
        if (contacts->rest.asleep > 0 && scree_is_still(bodies, &batch->ends[first + lane])) continue;
        add_to_bodies(bodies, &contact, yield, lane, scree_contact_turns(batch, &contact));
        scree_note(yield->depth[lane], bodies, contact.ball, contact.host, &contacts->deepest, &contacts->deepest_ball,
                   &contacts->deepest_host);
        scree_note(yield->steep[lane], bodies, contact.ball, contact.host, &contacts->steepest,
                   &contacts->steepest_ball, &contacts->steepest_host);
        if (!contacts->measured) continue;
        contacts->lost_normal += yield->lost.normal[lane];
        contacts->work_tangential += yield->lost.tangential[lane];
    }
}

static void act_block(const struct scree_contacts *contacts, const struct scree_bodies *bodies,
                      const struct scree_batch *batch, int block, double step) {
    int count = scree_contacts_in_block(batch, block), first = batch->segment[0].first + block * SCREE_LANES;
    const struct scree_loop *loop = count <= 8 ? contacts->loop_for_few : contacts->loop;
    loop->act(contacts, bodies, batch, first, count, step, &batch->yield[block]);
}

/* Blocks are independent of each other; a team of threads pays from some dozens of them on. */
static void act_loose(struct scree_contacts *contacts, struct scree_bodies *bodies, const struct scree_batch *batch,
                      double step, int threads) {
    int blocks = (batch->segment[0].count + SCREE_LANES - 1) / SCREE_LANES;
    if (threads > 1 && blocks > 32) {
#pragma omp parallel for schedule(static) num_threads(threads)
        for (int block = 0; block < blocks; block++)
            if (scree_rest_works(contacts, batch, block)) act_block(contacts, bodies, batch, block, step);
    } else {
        for (int block = 0; block < blocks; block++)
            if (scree_rest_works(contacts, batch, block)) act_block(contacts, bodies, batch, block, step);
    }
    for (int block = 0; block < blocks; block++)
        if (scree_rest_works(contacts, batch, block)) scree_contacts_collect(contacts, bodies, batch, block);
    if (contacts->rest.asleep > 0) scree_rest_give_back(batch);
}

/* ---- all of them ---- */

static void act_segment(void *argument, struct scree_contacts *contacts, struct scree_bodies *bodies,
                        const struct scree_batch *batch, int first, int count, double step, struct scree_tally *tally,
                        struct scree_trail *trail) {
    (void)argument;
    contacts->loop->act_straight(contacts, bodies, batch, first, count, step, tally, trail);
}

int scree_contacts_act(struct scree_contacts *contacts, struct scree_bodies *bodies, double step, int threads,
                       const struct scree_departure *go) {
    for (int k = 0; k < contacts->busy_batches; k++)
        act_loose(contacts, bodies, &contacts->batch[contacts->busy[k]], step, threads);
    if (!contacts->sweep.steps) contacts->flights.flown += step;
    return scree_contacts_by_slabs(contacts, bodies, step, threads, act_segment, NULL, go);
}
