/* All near contacts through one step.
 *
 * Segment 0 first: its blocks yield impulses by as many threads, and these are added to the bodies one after the other.
 * Then slabs, whose contacts add straight to their bodies. A slab's contacts reach into the next slab. Slabs go in
 * stretches, one after the other, but the last of a stretch waits for the first of the next; so stretches don't depend
 * on each other, no two slabs at work at the same time have a body in common, and every sum has one order, for any
 * number of threads. Threads take slabs as soon as those that these wait for are through.
 *
 * A body is finished when the slab that it belongs to and the one before are. Most are so as soon as the contacts of
 * their own slab have passed them by: they move on right behind the contacts, while they are at hand. Those of a
 * stretch's first slab that the slab before touches are lent to it, and move on after it. */
#include "contact/loop.h"
#include "contact/rest.h"

#include <sched.h>
#include <stdatomic.h>

/* ---- segment 0 ---- */

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

/* Keep the largest value so far, and whose it was: bodies by their places. */
static inline void note(double value, const struct scree_bodies *bodies, int ball_place, int host_place,
                        double *largest, int *ball, int *host) {
    if (value <= *largest) return;
    *largest = value;
    *ball = bodies->number[ball_place];
    *host = bodies->number[host_place];
}

static inline void collect(struct scree_contacts *contacts, struct scree_bodies *bodies,
                           const struct scree_batch *batch, int block) {
    int first = batch->segment[0].first + block * SCREE_LANES;
    const struct scree_yield *yield = &batch->yield[block];
    if (batch->geometry == SCREE_EDGE_EDGE && yield->silent) return;
    for (int lane = 0; lane < scree_contacts_in_block(batch, block); lane++) {
        struct scree_contact contact = scree_contact_at(batch, first + lane);
        if (contacts->rest.asleep > 0 && scree_is_still(bodies, &batch->ends[first + lane])) continue;
        add_to_bodies(bodies, &contact, yield, lane, scree_contact_turns(batch, &contact));
        note(yield->depth[lane], bodies, contact.ball, contact.host, &contacts->deepest, &contacts->deepest_ball,
             &contacts->deepest_host);
        note(yield->steep[lane], bodies, contact.ball, contact.host, &contacts->steepest, &contacts->steepest_ball,
             &contacts->steepest_host);
        if (!contacts->measured) continue;
        contacts->lost_normal += yield->lost.normal[lane];
        contacts->work_tangential += yield->lost.tangential[lane];
    }
}

void scree_contacts_collect(struct scree_contacts *contacts, struct scree_bodies *bodies,
                            const struct scree_batch *batch, int block) {
    collect(contacts, bodies, batch, block);
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
        if (scree_rest_works(contacts, batch, block)) collect(contacts, bodies, batch, block);
    if (contacts->rest.asleep > 0) scree_rest_give_back(batch);
}

/* ---- slabs ---- */

struct slabs {
    struct scree_contacts *contacts;
    struct scree_bodies *bodies;
    double step;
    scree_segment_work *work; /* with its argument */
    void *argument;
    const struct scree_departure *go; /* NULL: bodies stay where they are */
};

static void act_segment(void *argument, struct scree_contacts *contacts, struct scree_bodies *bodies,
                        const struct scree_batch *batch, const struct scree_part *segment, double step,
                        struct scree_tally *tally, struct scree_trail *trail) {
    (void)argument;
    if (contacts->rest.asleep > 0)
        scree_rest_act(contacts, bodies, batch, segment, step, tally);
    else
        contacts->loop->act_straight(contacts, bodies, batch, segment->first, segment->count, step, tally, trail);
}

/* The members of a slab from place `from` on have all their impulses: on they go; `lent`: those that waited. */
static void move_slab(const struct slabs *all, int slab, int from, const unsigned char *lent, int only,
                      struct scree_tally *tally) {
    const int *start = all->bodies->order.start;
    if (all->go) tally->too_far |= all->contacts->loop->move(all->bodies, from, start[slab + 1], all->go, lent, only);
}

/* The last batch with contacts in a slab's segment, after which its bodies have all theirs; -1: none. */
static int last_batch(const struct scree_contacts *contacts, int slab) {
    int last = contacts->busy_batches - 1;
    while (last >= 0 && !contacts->batch[contacts->busy[last]].segment[1 + slab].count) last--;
    return last;
}

static void act_slab(const struct slabs *all, int slab) {
    struct scree_contacts *contacts = all->contacts;
    struct scree_tally *tally = &contacts->tally[1 + slab];
    const int *start = all->bodies->order.start, last = last_batch(contacts, slab);
    int lends = slab > 0 && slab % SCREE_STRETCH == 0; /* the slab before has yet to push some of its bodies */
    struct scree_trail trail = {all->go, lends ? contacts->lent : NULL, start[slab]};
    *tally = (struct scree_tally){0.0, 0.0, contacts->deepest, contacts->steepest, -1, -1, -1, -1, 0};
    for (int k = 0; k <= last; k++) {
        const struct scree_batch *batch = &contacts->batch[contacts->busy[k]];
        const struct scree_part *segment = &batch->segment[1 + slab];
        int follows = k == last && batch->geometry == SCREE_BALL_BALL && all->go;
        if (segment->count)
            all->work(all->argument, contacts, all->bodies, batch, segment, all->step, tally, follows ? &trail : NULL);
    }
    move_slab(all, slab, trail.next, trail.lent, 0, tally);
    if ((slab + 1) % SCREE_STRETCH == 0 && slab + 1 < all->bodies->order.slabs)
        move_slab(all, slab + 1, start[slab + 1], contacts->lent, 1, tally);
}

/* What slabs have summed up, in their order. */
static void add_tallies(struct scree_contacts *contacts, const struct scree_bodies *bodies) {
    for (int s = 1; s <= bodies->order.slabs; s++) {
        const struct scree_tally *tally = &contacts->tally[s];
        contacts->lost_normal += tally->lost_normal;
        contacts->work_tangential += tally->work_tangential;
        if (tally->deepest_ball >= 0)
            note(tally->deepest, bodies, tally->deepest_ball, tally->deepest_host, &contacts->deepest,
                 &contacts->deepest_ball, &contacts->deepest_host);
        if (tally->steepest_ball >= 0)
            note(tally->steepest, bodies, tally->steepest_ball, tally->steepest_host, &contacts->steepest,
                 &contacts->steepest_ball, &contacts->steepest_host);
    }
}

/* Where slabs are: nobody has begun one, somebody has, it is through. */
enum { FREE, TAKEN, DONE };

/* Whether a slab may begin: the first of a stretch at once, others after the one before; the last one (but of the last
 * stretch) after the first of the next stretch, too. */
static int is_ready(const atomic_char *state, int slab, int slabs) {
    int waits = slab % SCREE_STRETCH != 0, lends = (slab + 1) % SCREE_STRETCH == 0 && slab + 1 < slabs;
    return (!waits || atomic_load(&state[slab - 1]) == DONE) && (!lends || atomic_load(&state[slab + 1]) == DONE);
}

/* Slabs in work. */
struct shares {
    const struct slabs *all;
    int slabs, team;
    double work[SCREE_SLABS + 1]; /* of the slabs before each */
    atomic_char state[SCREE_SLABS];
};

/* Slabs of one thread: from … to - 1. */
struct share {
    int from, to;
};

/* A body costs about as much as half a contact, and has two. */
static void weigh(struct shares *shares) {
    const struct scree_contacts *contacts = shares->all->contacts;
    const int *start = shares->all->bodies->order.start;
    for (int slab = 0; slab < shares->slabs; slab++) {
        double work = 0.5 * (start[slab + 1] - start[slab]);
        for (int k = 0; k < contacts->busy_batches; k++)
            work += contacts->batch[contacts->busy[k]].segment[1 + slab].count;
        shares->work[slab + 1] = shares->work[slab] + work;
    }
}

/* Where the slabs of a thread begin: as much work lies before them as falls to the threads before. */
static int begin_of(const struct shares *shares, int thread) {
    const double *work = shares->work;
    double before = work[shares->slabs] * thread / shares->team;
    int slab = 0;
    while (slab < shares->slabs && work[slab] + work[slab + 1] < 2.0 * before) slab++;
    return slab;
}

/* Take a slab if it is ready; `left`: it is not, but there it is. */
static int take(struct shares *shares, int slab, int *left) {
    char unclaimed = FREE;
    if (atomic_load(&shares->state[slab]) != FREE) return 0;
    *left = 1;
    return is_ready(shares->state, slab, shares->slabs) &&
           atomic_compare_exchange_strong(&shares->state[slab], &unclaimed, TAKEN);
}

/* Take the next slab, of others' shares if the own one is through: one near by, so that the same ones change hands in
 * every step. Of several threads' slabs the first ones of all stretches come first, then the second ones: what others
 * wait for is never left to the end. Returns -1 if none is ready; `left`: there will be one. */
static int take_slab(struct shares *shares, struct share own, int *left) {
    int by = shares->team > 1 ? SCREE_STRETCH : 1;
    *left = 0;
    for (int place = 0; place < by; place++)
        for (int slab = own.from; slab < own.to; slab++)
            if (slab % by == place && take(shares, slab, left)) return slab;
    for (int place = 0; place < by; place++)
        for (int off = 0; off < shares->slabs; off++) {
            int before = own.from - 1 - off, behind = own.to + off;
            if (before >= 0 && before % by == place && take(shares, before, left)) return before;
            if (behind < shares->slabs && behind % by == place && take(shares, behind, left)) return behind;
        }
    return -1;
}

/* What one thread does: its own slabs, which it had the step before, so that bodies stay with it; then what is left of
 * others'. So nobody waits for a slow neighbour. */
static void share_slabs(struct shares *shares, struct share own) {
    for (int left = 1; left;) {
        int slab = take_slab(shares, own, &left);
        if (slab >= 0) {
            act_slab(shares->all, slab);
            atomic_store(&shares->state[slab], DONE);
        } else if (left) {
            sched_yield();
        }
    }
}

static void act_slabs(const struct slabs *all, int threads) {
    int slabs = all->bodies->order.slabs, team = slabs > SCREE_STRETCH ? threads : 1;
    struct shares shares = {all, slabs, team, {0.0}, {FREE}};
    if (team > 1) {
        weigh(&shares);
#pragma omp parallel for schedule(static) num_threads(team)
        for (int thread = 0; thread < team; thread++)
            share_slabs(&shares, (struct share){begin_of(&shares, thread), begin_of(&shares, thread + 1)});
    } else {
        share_slabs(&shares, (struct share){0, slabs});
    }
    add_tallies(all->contacts, all->bodies);
}

int scree_contacts_by_slabs(struct scree_contacts *contacts, struct scree_bodies *bodies, double step, int threads,
                            scree_segment_work *work, void *argument, const struct scree_departure *go) {
    struct slabs all = {contacts, bodies, step, work, argument, go};
    int too_far = 0;
    if (bodies->order.slabs) act_slabs(&all, threads);
    for (int s = 1; s <= bodies->order.slabs; s++) too_far |= contacts->tally[s].too_far;
    return too_far;
}

int scree_contacts_act_and_move(struct scree_contacts *contacts, struct scree_bodies *bodies, double step, int threads,
                                const struct scree_departure *go) {
    for (int k = 0; k < contacts->busy_batches; k++)
        act_loose(contacts, bodies, &contacts->batch[contacts->busy[k]], step, threads);
    contacts->flights.flown += step;
    return scree_contacts_by_slabs(contacts, bodies, step, threads, act_segment, NULL, go);
}

void scree_contacts_act(struct scree_contacts *contacts, struct scree_bodies *bodies, double step, int threads) {
    scree_contacts_act_and_move(contacts, bodies, step, threads, NULL);
}
