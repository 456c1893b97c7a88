/* All near contacts through one step of pair impulses (impulse.c), by threads as in act.c, and the balls before and
 * behind them: those of slabs move on behind the contacts of their slab. */
#include "contact/ahead.h"
#include "contact/loop.h"

static void impel_block(const struct scree_contacts *contacts, const struct scree_bodies *bodies,
                        const struct scree_bodies *now, const struct scree_batch *batch, int block, double step) {
    uint32_t odd;
    scree_impel_window(contacts, bodies, now, batch, batch->segment[0].first + block * SCREE_LANES,
                       scree_contacts_in_block(batch, block), step, &batch->yield[block], &batch->moments[block], &odd);
}

/* Moments of angular impulses into the bodies; balls have no attitude, and need none. `lanes`: bits of those that may
 * be of others. `hosts` 0: partners are frozen. */
static void add_turn_moments(struct scree_bodies *bodies, const struct scree_batch *batch, int first, uint32_t lanes,
                             int count, int hosts, const struct scree_moments *moments) {
    for (int lane = 0; batch->any_turns && lane < count && lanes >> lane; lane++) {
        if (!(lanes >> lane & 1)) continue;
        struct scree_contact own = scree_contact_at(batch, first + lane), *contact = &own;
        int turns = scree_contact_turns(batch, contact);
        int ball_turns = turns && bodies->class[contact->ball] == SCREE_CLASS_GENERAL;
        int host_turns = turns && hosts && bodies->class[contact->host] == SCREE_CLASS_GENERAL;
        double *ball = ball_turns ? scree_attitude_of(bodies, contact->ball)->turn_moment : NULL;
        double *host = host_turns ? scree_attitude_of(bodies, contact->host)->turn_moment : NULL;
        for (int k = 0; ball_turns && k < 3; k++) ball[k] += moments->turn_ball[k][lane];
        for (int k = 0; host_turns && k < 3; k++) host[k] += moments->turn_host[k][lane];
    }
}

/* Contacts that turn nothing, among others that do. */
static void clear_turns(const struct scree_batch *batch, int first, int count, struct scree_yield *yield) {
    for (int lane = 0; batch->any_turns && !batch->turns && lane < count; lane++) {
        struct scree_contact own = scree_contact_at(batch, first + lane);
        for (int k = 0; k < 3 && !scree_contact_turns(batch, &own); k++)
            yield->turn_ball[k][lane] = yield->turn_host[k][lane] = 0.0;
    }
}

static void tally_lane(const struct scree_ends *contact, const struct scree_yield *yield, int lane,
                       struct scree_tally *tally) {
    if (!(yield->depth[lane] <= tally->deepest)) {
        tally->deepest = yield->depth[lane];
        tally->deepest_ball = contact->ball;
        tally->deepest_host = contact->host;
    }
    if (!(yield->steep[lane] <= tally->steepest)) {
        tally->steepest = yield->steep[lane];
        tally->steepest_ball = contact->ball;
        tally->steepest_host = contact->host;
    }
}

/* One step's arguments, for slabs. */
struct stride {
    const struct scree_bodies *now;
};

/* Bodies lie in the order in which contacts come to them: they are asked for so many places ahead, partners that lie
 * farther by themselves, and what is kept of contacts a window ahead (as in loop.c, but each of them needs four times
 * as much). */
enum { AHEAD = 96, SIZE = 4 };

static SCREE_INLINE void prefetch_partner(const struct scree_bodies *bodies, int k) {
    SCREE_PREFETCH(bodies->record, k, k + 1);
    SCREE_PREFETCH(bodies->spin, k, k + 1);
    SCREE_PREFETCH(bodies->moment, k, k + 1);
}

static SCREE_INLINE void prefetch_bodies(const struct scree_bodies *bodies, int from, int to) {
    SCREE_PREFETCH(bodies->record, from, to);
    SCREE_PREFETCH(bodies->spin, from, to);
    SCREE_PREFETCH(bodies->moment, from, to);
    SCREE_PREFETCH(bodies->past, from, to);
    SCREE_PREFETCH(bodies->state, from, to);
    SCREE_PREFETCH(bodies->position, from, to);
}

static SCREE_INLINE void prefetch_ahead(const struct scree_contacts *contacts, const struct scree_bodies *bodies,
                                        const struct scree_batch *batch, int next, int left, int *prefetched) {
    const struct scree_ends *own = &batch->ends[next];
    if (left <= 0 || bodies->count < contacts->cached / SIZE) return;
    int first = scree_first_of(own), to = first + AHEAD < bodies->count ? first + AHEAD : bodies->count;
    int from = *prefetched > first ? *prefetched : first, later = SCREE_WINDOW * SCREE_LANES;
    if (to > from) prefetch_bodies(bodies, from, *prefetched = to);
    for (int k = later; k < later + SCREE_LANES && k < left; k++) {
        int last = scree_last_of(&own[k]);
        if (last >= first + AHEAD) prefetch_partner(bodies, last);
    }
    SCREE_PREFETCH(own, later, later + SCREE_LANES);
    for (int m = 0; m < SCREE_PAST; m++) SCREE_PREFETCH(&batch->past[m][next], later, later + SCREE_LANES);
    for (int m = 0; batch->kept[0] && m < 3; m++) SCREE_PREFETCH(&batch->kept[m][next], later, later + SCREE_LANES);
}

/* What a block yields, to its bodies, in the order of its contacts. */
static void add_block(struct scree_contacts *contacts, struct scree_bodies *bodies, const struct scree_batch *batch,
                      int first, int count, uint32_t odd, struct scree_yield *yield, struct scree_moments *moments,
                      struct scree_tally *tally) {
    const struct scree_ends *own = &batch->ends[first];
    int hosts = batch->geometry == SCREE_BALL_BALL;
    clear_turns(batch, first, count, yield);
    int more = contacts->loop->add_up(bodies, own, count, batch->any_turns, hosts, yield, moments, tally);
    add_turn_moments(bodies, batch, first, odd, count, hosts, moments);
    for (int lane = 0; more && lane < count; lane++) tally_lane(&own[lane], yield, lane, tally);
    if (contacts->measured) scree_tally_losses(tally, &yield->lost, count);
}

/* What a step has written in the place of the step before the last becomes the last. (A contact of which nothing is
 * written has nothing in either.) */
static void turn_over(struct scree_batch *batch) {
    double **past = batch->past;
    for (int m = 0; m < SCREE_PAST_STEP; m++) {
        double *before = past[SCREE_PAST_STEP + m];
        past[SCREE_PAST_STEP + m] = past[m];
        past[m] = before;
    }
}

static void impel_segment(void *context, struct scree_contacts *contacts, struct scree_bodies *bodies,
                          const struct scree_batch *batch, int first, int all, double step, struct scree_tally *tally,
                          struct scree_trail *trail) {
    const struct stride *stride = context;
    struct scree_batch own = *batch; /* in a sweep slabs are in several steps at once */
    if (trail->lap % 2) turn_over(&own);
    batch = &own;
    struct scree_yield yield[SCREE_WINDOW];
    struct scree_moments moments[SCREE_WINDOW];
    uint32_t odd[SCREE_WINDOW];
    for (int left = all, count; left > 0; left -= count, first += count) {
        count = left < SCREE_WINDOW * SCREE_LANES ? left : SCREE_WINDOW * SCREE_LANES;
        scree_impel_window(contacts, bodies, stride->now, batch, first, count, step, yield, moments, odd);
        for (int done = 0, block = 0; done < count; done += SCREE_LANES, block++) {
            prefetch_ahead(contacts, bodies, batch, first + done, left - done + trail->behind, &trail->prefetched);
            add_block(contacts, bodies, batch, first + done, count - done < SCREE_LANES ? count - done : SCREE_LANES,
                      odd[block], &yield[block], &moments[block], tally);
        }
    }
}

/* More bodies than that are worth a team of threads; so many one thread takes at once. */
enum { WORTH_A_TEAM = 1000, CHUNK = 256 };

static int chunk_end(int from, int count) { return from + CHUNK < count ? from + CHUNK : count; }

static void impel_loose(struct scree_contacts *contacts, struct scree_bodies *bodies, const struct scree_bodies *now,
                        const struct scree_batch *batch, double step, int threads) {
    int blocks = (batch->segment[0].count + SCREE_LANES - 1) / SCREE_LANES;
    if (threads > 1 && blocks > 8) {
#pragma omp parallel for schedule(static) num_threads(threads)
        for (int block = 0; block < blocks; block++) impel_block(contacts, bodies, now, batch, block, step);
    } else {
        for (int block = 0; block < blocks; block++) impel_block(contacts, bodies, now, batch, block, step);
    }
    for (int block = 0; block < blocks; block++) {
        scree_contacts_collect(contacts, bodies, batch, block);
        int first = batch->segment[0].first + block * SCREE_LANES, count = scree_contacts_in_block(batch, block);
        const struct scree_moments *moments = &batch->moments[block];
        for (int lane = 0; lane < count; lane++)
            for (int k = 0; k < 3; k++) {
                bodies->moment[batch->ends[first + lane].ball][k] += moments->impulse[k][lane];
                bodies->moment[batch->ends[first + lane].host][k] -= moments->impulse[k][lane];
            }
        add_turn_moments(bodies, batch, first, ~(uint32_t)0, count, 1, moments);
    }
}

int scree_contacts_impel(struct scree_contacts *contacts, struct scree_bodies *bodies, const struct scree_bodies *now,
                         double step, int threads, const struct scree_departure *go) {
    struct stride stride = {now};
    for (int k = 0; k < contacts->busy_batches; k++)
        impel_loose(contacts, bodies, now, &contacts->batch[contacts->busy[k]], step, threads);
    int too_far = scree_contacts_by_slabs(contacts, bodies, step, threads, impel_segment, &stride, go);
    int odd = contacts->sweep.steps == 0 && (!go || go->steps % 2); /* and all of them are through */
    for (int b = 0; odd && b < contacts->batches; b++) turn_over(&contacts->batch[b]);
    return too_far;
}

/* One thread has a loop of its own: a parallel region takes longer than a few bodies, even with a team of one. */
int scree_contacts_look_both(struct scree_contacts *contacts, struct scree_bodies *bodies, int count, double time,
                             double step, const double gravity[3], double margin, struct scree_bodies *now,
                             int threads) {
    const struct scree_loop *loop = contacts->loop;
    int too_far = scree_bodies_look_both(bodies, time, step, gravity, margin, now);
    if (threads > 1 && count > WORTH_A_TEAM) {
#pragma omp parallel for schedule(static) num_threads(threads)
        for (int from = 0; from < count; from += CHUNK)
            if (loop->look_both(bodies, from, chunk_end(from, count), step, gravity, margin))
                __atomic_store_n(&too_far, 1, __ATOMIC_RELAXED);
    } else {
        too_far |= loop->look_both(bodies, 0, count, step, gravity, margin);
    }
    return too_far;
}

void scree_contacts_advance_by_moments(struct scree_contacts *contacts, struct scree_bodies *bodies, int count,
                                       double time, double step, const double gravity[3], int threads) {
    const struct scree_loop *loop = contacts->loop;
    scree_bodies_advance_by_moments(bodies, time, step, gravity);
    if (threads > 1 && count > WORTH_A_TEAM) {
#pragma omp parallel for schedule(static) num_threads(threads)
        for (int from = 0; from < count; from += CHUNK)
            loop->advance_by_moments(bodies, from, chunk_end(from, count), step, gravity);
    } else {
        loop->advance_by_moments(bodies, 0, count, step, gravity);
    }
}
