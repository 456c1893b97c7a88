/* Slabs through one step: their contacts, which add straight to their bodies, and their bodies behind them.
 *
 * A slab's contacts of two balls come by the place of their first body and reach into the next slab; those with what
 * isn't a ball (walls) come before all of these. So a slab may follow the one before through the step, as soon as that
 * one is through with all bodies that are next, and every sum has one order, for any number of threads. Where members
 * are of one material, their contacts are of one batch and go strip by strip, some rows behind each other; else batch
 * after batch, slab after slab. So that not all slabs have to follow one another, they go in stretches: the last slab
 * of a stretch follows the first of the next one.
 *
 * A body is finished when the contacts of its own slab have passed it by: then it moves on, while it is at hand. Those
 * of a stretch's first slab that the slab before touches are lent to it, and move on after it. */
#include "contact/slabs.h"
#include "contact/rest.h"

#include <limits.h>
#include <sched.h>

/* Where slabs are: nobody has begun one, somebody has, it is through. */
enum { FREE, TAKEN, DONE };

/* ---- strips ---- */

static int is_of_balls(const struct scree_batch *batch) { return batch->geometry == SCREE_BALL_BALL; }

static struct scree_batch *busy_batch(const struct scree_slabs *all, int k) {
    return &all->contacts->batch[all->contacts->busy[k]];
}

/* Slabs in one strip, where contacts are of several batches or some bodies sleep. */
static int goes_whole(const struct scree_slabs *all) { return all->bodies->mixed || all->contacts->rest.asleep > 0; }

/* Where the strip that begins with a body ends. */
static int end_of_strip(const struct scree_slabs *all, int slab, int from) {
    const int *start = &all->bodies->order.start[slab];
    int to = from + scree_strip_of(start[1] - start[0]);
    return to < start[1] && !goes_whole(all) ? to : start[1];
}

/* Where the piece of a segment ends that goes on at contact `from`: behind those whose first body is before place `to`,
 * and a block that isn't cut. */
static int end_of_piece(const struct scree_batch *batch, const struct scree_part *segment, int from, int to) {
    int end = segment->first + segment->count;
    while (from < end && scree_first_of(&batch->ends[from]) < to) from += SCREE_LANES;
    return from < end ? from : end;
}

/* ---- who waits for what ---- */

/* What a piece touches. Its last block may hold contacts of which only the first body lies in the slab, behind the
 * strip. */
static void widen_gate(const struct scree_batch *batch, int from, int to, int end, struct scree_gate *gate) {
    for (int c = from; c < to; c++) {
        const struct scree_ends *contact = &batch->ends[c];
        int later = scree_last_of(contact), beyond = later >= end, own = beyond ? scree_first_of(contact) : later;
        if (own > gate->last_own) gate->last_own = own;
        if (beyond && later > gate->last_next) gate->last_next = later;
        if (beyond && later < gate->first_next) gate->first_next = later;
    }
}

/* The batch of a slab's contacts of two balls, of which there is one; NULL: there are no contacts. */
static const struct scree_batch *balls_of(const struct scree_slabs *all, int slab) {
    for (int k = 0; k < all->contacts->busy_batches; k++)
        if (is_of_balls(busy_batch(all, k)) && busy_batch(all, k)->segment[1 + slab].count) return busy_batch(all, k);
    return NULL;
}

/* The gates of a slab's strips, from its list as it is. */
static void find_gates(const struct scree_slabs *all, int slab) {
    const int *start = &all->bodies->order.start[slab];
    const struct scree_batch *batch = balls_of(all, slab);
    struct scree_gate *gate = scree_gates_of(all->contacts, &all->bodies->order, slab), so_far = {0, -1, -1, INT_MAX};
    int strips = 0, first = batch ? batch->segment[1 + slab].first : 0, from = first;
    for (int place = start[0]; place < start[1]; strips++) {
        place = end_of_strip(all, slab, place);
        so_far.first_next = INT_MAX;
        if (place - 1 > so_far.last_own) so_far.last_own = place - 1; /* the strip's bodies move on */
        int to = batch ? end_of_piece(batch, &batch->segment[1 + slab], from, place) : from;
        widen_gate(batch, from, to, start[1], &so_far);
        so_far.contacts = to - first;
        gate[strips] = so_far;
        from = to;
    }
    for (int strip = strips - 2; strip >= 0; strip--)
        if (gate[strip + 1].first_next < gate[strip].first_next) gate[strip].first_next = gate[strip + 1].first_next;
    all->contacts->gated[slab] = 1;
}

/* Until a slab has passed a place by: for a short while without asking the system. */
static void wait_for(const atomic_int *front, int place) {
    enum { TRIES = 256 };
    for (int tries = 0; atomic_load_explicit(front, memory_order_acquire) <= place;)
        if (tries < TRIES)
            tries++;
        else
            sched_yield();
}

static void wait_at(struct scree_slabs *all, int slab, struct scree_gate gate) {
    if (!scree_begins_stretch(slab)) wait_for(&all->front[slab - 1].next, gate.last_own);
    if (scree_ends_stretch(all, slab)) wait_for(&all->front[slab + 1].own, gate.last_next);
}

static void tell(struct scree_slabs *all, int slab, int own, int next) {
    atomic_store_explicit(&all->front[slab].next, next, memory_order_release);
    atomic_store_explicit(&all->front[slab].own, own, memory_order_release);
}

/* ---- one slab ---- */

/* Contacts of a slab, batch after batch: of two balls, or of what isn't one (a flank). */
static void act_batches(const struct scree_slabs *all, int slab, int of_balls, int lap, struct scree_tally *tally) {
    for (int k = 0; k < all->contacts->busy_batches; k++) {
        const struct scree_batch *batch = busy_batch(all, k);
        const struct scree_part *segment = &batch->segment[1 + slab];
        if (is_of_balls(batch) != of_balls || !segment->count) continue;
        if (all->contacts->rest.asleep > 0)
            scree_rest_act(all->contacts, all->bodies, batch, segment, all->step, tally);
        else
            all->work(all->argument, all->contacts, all->bodies, batch, segment->first, segment->count, all->step,
                      tally, &(struct scree_trail){.lap = lap});
    }
}

/* Members before place `to` have all their impulses: on they go; `lent`: those that needn't wait (`wanted` 0), or
 * those that have waited (1). */
static void move_up(const struct scree_slabs *all, int from, int to, const unsigned char *lent, int wanted,
                    struct scree_tally *tally) {
    if (all->go && from < to) tally->too_far |= all->contacts->loop->move(all->bodies, from, to, all->go, lent, wanted);
}

/* Up to where the bodies lent by the next slab have all their impulses, too: no contact to come touches them, and that
 * slab has passed them by. */
static int end_of_lent(struct scree_gate gate, int first_next) {
    return first_next <= gate.last_next ? first_next : gate.last_next + 1;
}

/* What the next strip needs that those so far didn't; nothing behind the last one. */
static void look_ahead(const struct scree_gate *gate, int is_last, struct scree_places ask[2]) {
    ask[0] = ask[1] = (struct scree_places){0, 0};
    if (is_last) return;
    int next = gate[0].last_next;
    ask[0] = (struct scree_places){gate[0].last_own + 1, gate[1].last_own + 1};
    ask[1] = (struct scree_places){next < 0 ? gate[1].first_next : next + 1, gate[1].last_next + 1};
}

static void act_strips(struct scree_slabs *all, int slab, int lap, int at_border, const unsigned char *lent,
                       struct scree_tally *tally) {
    const int *start = &all->bodies->order.start[slab];
    const struct scree_batch *batch = balls_of(all, slab);
    const struct scree_part none = {0}, *segment = batch ? &batch->segment[1 + slab] : &none;
    const struct scree_gate *gate = scree_gates_of(all->contacts, &all->bodies->order, slab);
    struct scree_trail trail = {.at_border = at_border, .lap = lap};
    int from = segment->first, returned = start[1];
    if (!all->contacts->gated[slab]) find_gates(all, slab);
    for (int place = start[0], to; place < start[1]; place = to, gate++) {
        to = end_of_strip(all, slab, place);
        int next = segment->first + gate->contacts;
        int first_next = to < start[1] ? gate[1].first_next : INT_MAX;
        trail.behind = segment->first + segment->count - next;
        int looks = all->team < 2 && next > from;
        look_ahead(gate, !looks || to == start[1], trail.ask);
        wait_at(all, slab, *gate);
        if (next > from)
            all->work(all->argument, all->contacts, all->bodies, batch, from, next - from, all->step, tally, &trail);
        trail.asked = looks;
        from = next;
        move_up(all, place, to, lent, 0, tally);
        tell(all, slab, to, first_next);
        if (!scree_ends_stretch(all, slab) || end_of_lent(*gate, first_next) <= returned) continue;
        move_up(all, returned, end_of_lent(*gate, first_next), all->contacts->lent, 1, tally);
        returned = end_of_lent(*gate, first_next);
    }
}

static void act_whole(const struct scree_slabs *all, int slab, int lap, const unsigned char *lent,
                      struct scree_tally *tally) {
    const int *start = &all->bodies->order.start[slab];
    act_batches(all, slab, 1, lap, tally);
    move_up(all, start[0], start[1], lent, 0, tally);
    if (scree_ends_stretch(all, slab)) move_up(all, start[1], start[2], all->contacts->lent, 1, tally);
}

void scree_begin_tallies(struct scree_contacts *contacts, int slabs, int lap) {
    for (int slab = 0; slab < slabs; slab++)
        contacts->tally[lap][1 + slab] = (struct scree_tally){.deepest = contacts->deepest,
                                                              .steepest = contacts->steepest,
                                                              .deepest_ball = -1,
                                                              .deepest_host = -1,
                                                              .steepest_ball = -1,
                                                              .steepest_host = -1};
}

void scree_act_slab(struct scree_slabs *all, int slab, int lap, int at_border) {
    struct scree_tally *tally = &all->contacts->tally[lap][1 + slab];
    const unsigned char *lent = slab > 0 && scree_begins_stretch(slab) ? all->contacts->lent : NULL;
    if (scree_begins_stretch(slab)) act_batches(all, slab, 0, lap, tally);
    if (slab + 1 < all->slabs && !scree_begins_stretch(slab + 1)) act_batches(all, slab + 1, 0, lap, tally);
    if (goes_whole(all))
        act_whole(all, slab, lap, lent, tally);
    else
        act_strips(all, slab, lap, at_border, lent, tally);
    tell(all, slab, INT_MAX, INT_MAX);
    atomic_store(&all->state[slab], DONE);
}

/* ---- all of them ---- */

void scree_add_tallies(struct scree_contacts *contacts, const struct scree_bodies *bodies, int lap) {
    for (int s = 1; s <= bodies->order.slabs; s++) {
        const struct scree_tally *tally = &contacts->tally[lap][s];
        contacts->lost_normal += tally->lost_normal;
        contacts->work_tangential += tally->work_tangential;
        if (tally->deepest_ball >= 0)
            scree_note(tally->deepest, bodies, tally->deepest_ball, tally->deepest_host, &contacts->deepest,
                       &contacts->deepest_ball, &contacts->deepest_host);
        if (tally->steepest_ball >= 0)
            scree_note(tally->steepest, bodies, tally->steepest_ball, tally->steepest_host, &contacts->steepest,
                       &contacts->steepest_ball, &contacts->steepest_host);
    }
}

/* Work is shared out by its weight. */
static double weight_of(const struct scree_slabs *all, int slab) {
    const int *start = all->bodies->order.start;
    double work = 0.5 * (start[slab + 1] - start[slab]); /* a body costs about as much as half a contact */
    for (int k = 0; k < all->contacts->busy_batches; k++) work += busy_batch(all, k)->segment[1 + slab].count;
    return work;
}

/* Where the slabs of a thread begin: as much work lies before them as falls to the threads before. */
static int begin_of(const struct scree_slabs *all, int thread) {
    const double *work = all->before;
    double before = work[all->slabs] * thread / all->team;
    int slab = 0;
    while (slab < all->slabs && work[slab] + work[slab + 1] < 2.0 * before) slab++;
    return slab;
}

/* Slabs of one thread: from … to - 1. */
struct share {
    int from, to;
};

/* Whether a slab may be taken: those that it follows are so far. */
static int is_ready(const struct scree_slabs *all, int slab, char so_far) {
    return (scree_begins_stretch(slab) || atomic_load(&all->state[slab - 1]) >= so_far) &&
           (!scree_ends_stretch(all, slab) || atomic_load(&all->state[slab + 1]) >= so_far);
}

/* Take a slab if it is ready; `left`: it is not, but there it is. */
static int take(struct scree_slabs *all, int slab, char so_far, int *left) {
    char unclaimed = FREE;
    if (slab < 0 || slab >= all->slabs || atomic_load(&all->state[slab]) != FREE) return 0;
    *left = 1;
    return is_ready(all, slab, so_far) && atomic_compare_exchange_strong(&all->state[slab], &unclaimed, TAKEN);
}

static int take_own(struct scree_slabs *all, struct share own, char so_far, int *left) {
    for (int slab = own.from; slab < own.to; slab++)
        if (take(all, slab, so_far, left)) return slab;
    return -1;
}

/* One near by, so that the same ones change hands in every step. */
static int take_others(struct scree_slabs *all, struct share own, char so_far, int *left) {
    for (int off = 0; off < all->slabs; off++) {
        if (take(all, own.from - 1 - off, so_far, left)) return own.from - 1 - off;
        if (take(all, own.to + off, so_far, left)) return own.to + off;
    }
    return -1;
}

static int is_left(const struct scree_slabs *all) {
    for (int slab = 0; slab < all->slabs; slab++)
        if (atomic_load(&all->state[slab]) == FREE) return 1;
    return 0;
}

/* Take the next slab, an own one, or, if `helps`, one of others' shares if the own one is through: one that needn't
 * wait, or else one that goes strip by strip behind others. Returns -1 if none is ready; `left`: there will be one. */
static int take_slab(struct scree_slabs *all, struct share own, int helps, int *left) {
    int follows = !goes_whole(all);
    *left = 0;
    int slab = take_own(all, own, DONE, left);
    if (slab < 0 && follows) slab = take_own(all, own, TAKEN, left);
    if (slab < 0 && helps) slab = take_others(all, own, DONE, left);
    if (slab < 0 && helps && follows) slab = take_others(all, own, TAKEN, left);
    if (slab < 0 && !helps) *left = is_left(all);
    return slab;
}

/* Whether the slab before or the next one was another thread's, which is through by now with the bodies that both
 * touch: not where shares are short. */
static int is_at_border(const struct scree_slabs *all, int slab, struct share own) {
    if (own.to - own.from <= SCREE_STRETCH) return 0;
    return (slab + 1 == own.to && own.to < all->slabs) || (slab == own.from && slab > 0);
}

/* What one thread does: its own slabs, which it had the step before, so that bodies stay with it; then what is left of
 * others', at once if somebody hasn't even begun, or else after a while. So nobody waits for a slow neighbour, nor
 * takes what is in the cache of one that is nearly through: then the next step has to bring it back. */
static void share_slabs(struct scree_slabs *all, struct share own) {
    enum { PATIENCE = 32 };
    atomic_fetch_add(&all->begun, 1);
    for (int left = 1, tries = 0; left; tries++) {
        int helps = tries >= PATIENCE || atomic_load(&all->begun) < all->team;
        int slab = take_slab(all, own, helps, &left);
        if (slab >= own.from && slab < own.to) tries = 0;
        if (slab >= 0)
            scree_act_slab(all, slab, 0, is_at_border(all, slab, own));
        else if (left)
            sched_yield();
    }
}

/* A region always has all threads, also those that have no part in it: the runtime would end them, and begin them anew
 * for the next one. */
static void act_slabs(struct scree_slabs *all, int threads) {
    int team = all->team;
    (void)threads; /* without OpenMP */
    for (int slab = 0; slab < all->slabs; slab++) {
        atomic_init(&all->state[slab], FREE);
        atomic_init(&all->front[slab].own, 0);
        atomic_init(&all->front[slab].next, 0);
    }
    if (team > 1) {
        all->before[0] = 0.0;
        for (int slab = 0; slab < all->slabs; slab++) all->before[slab + 1] = all->before[slab] + weight_of(all, slab);
#pragma omp parallel for schedule(static) num_threads(threads)
        for (int thread = 0; thread < team; thread++)
            share_slabs(all, (struct share){begin_of(all, thread), begin_of(all, thread + 1)});
    } else {
        share_slabs(all, (struct share){0, all->slabs});
    }
}

/* More threads than that only wait, and their looking for work holds up the others: than slabs, or where these have few
 * strips, so that none is soon free to follow, than stretches. */
static int most_threads(const struct scree_slabs *all) {
    enum { FEW_STRIPS = 4 };
    int members = all->bodies->order.start[1] - all->bodies->order.start[0];
    int follow = !goes_whole(all) && members > FEW_STRIPS * scree_strip_of(members);
    return follow ? all->slabs : (all->slabs + SCREE_STRETCH - 1) / SCREE_STRETCH;
}

/* One step. Returns whether a body has outgrown its margin. */
static int step_slabs(struct scree_slabs *all, int threads) {
    int most = most_threads(all), too_far = 0;
    all->team = threads < most ? threads : most;
    scree_begin_tallies(all->contacts, all->slabs, 0);
    act_slabs(all, threads);
    for (int s = 1; s <= all->slabs; s++) too_far |= all->contacts->tally[0][s].too_far;
    return too_far;
}

int scree_contacts_by_slabs(struct scree_contacts *contacts, struct scree_bodies *bodies, double step, int threads,
                            scree_segment_work *work, void *argument, const struct scree_departure *go) {
    int slabs = bodies->order.slabs, steps = go ? go->steps : 1;
    if (!slabs) {
        contacts->sweep.told = steps; /* the sums hold what isn't of slabs already */
        return 0;
    }
    struct scree_front
        front[SCREE_SLABS]; /* as many as there are slabs are set: to clear all takes as long as some contacts */
    atomic_char state[SCREE_SLABS];
    double before[SCREE_SLABS + 1];
    struct scree_slabs all = {.contacts = contacts,
                              .bodies = bodies,
                              .step = step,
                              .work = work,
                              .argument = argument,
                              .go = go,
                              .slabs = slabs,
                              .before = before,
                              .state = state,
                              .front = front};
    int too_far = steps > 1 ? scree_sweep_slabs(&all) : step_slabs(&all, threads);
    if (contacts->sweep.steps) return too_far;
    contacts->sweep.told = 0;
    do scree_add_tallies(contacts, bodies, contacts->sweep.told++);
    while (contacts->sweep.told < steps && !(contacts->deepest > 1.0));
    return too_far;
}
