/* The contact loop: blocks of contacts go through short passes over columns that stay in the L1 cache,
 *   fetch      body records, subtracted row by row
 *   meet       normal and overlap
 *   slide      levers, tangential velocity; stretches turn with normal and bodies
 *   normal     the normal law
 *   friction   the friction law with its memory; a slider's in three passes
 *   rolling    the rolling law with its memory, where there is one
 *   push       impulses on both bodies
 * Choices are made per batch, never per contact. This file is compiled once for each kind of processor
 * (contact/meson.build), and uses nothing that could make a difference in a bit. */
#include "contact/loop.h"
#include "contact/ahead.h"
#include "contact/passes.h"
#include "contact/push.h"

#include <string.h>

/* For the books, what a force does is its whole way. */
static void tell_all(struct block *b, const struct lean *lean, int count) {
    for (int k = 0; k < count; k++) b->closing[k] += lean->untold[k];
}

/* The last pass. */
static void finish(const struct scree_contacts *contacts, const struct scree_batch *batch, const struct block *b,
                   int count, double step, struct sizes sizes, struct scree_yield *yield) {
    const struct scree_rule *rule = &contacts->rule[batch->rule];
    write_yield(b, count, batch, deeds_of(batch, rule, batch->any_turns), sizes, step, yield);
    if (contacts->measured) measure_losses(b, count, rule, step, &yield->lost);
}

/* ---- edges on edges ---- */

/* A block without touch: laws forget what they have kept. */
static void stay_silent(const struct scree_batch *batch, int first, int count) {
    for (int m = 0; m < SCREE_MEMORY; m++)
        if (batch->kept[m]) memset(batch->kept[m] + first, 0, (size_t)padded(count) * sizeof(double));
    if (batch->slides) memset(batch->slides + first, 0, (size_t)padded(count));
}

/* The rest of what edges on edges do, on top of what the middle of the overlap yields. */
static void act_leaning(const struct block *b, const struct lean *lean, int count, double step,
                        struct scree_yield *yield) {
    for (int axis = 0; axis < 3; axis++)
        for (int k = 0; k < count; k++) {
            double f = step * b->force[k];
            if (f == 0.0) continue;
            yield->impulse[axis][k] += f * lean->force[axis][k];
            yield->turn_ball[axis][k] += f * lean->turn_ball[axis][k];
            yield->turn_host[axis][k] += f * lean->turn_host[axis][k];
        }
}

static void act_edges(const struct scree_contacts *contacts, const struct scree_bodies *bodies,
                      const struct scree_batch *batch, int first, int count, double step, struct scree_yield *yield) {
    struct block b;
    struct lean lean;
    yield->silent = !gather_crossings(bodies, batch, first, count, step, &b, &lean);
    if (yield->silent) {
        stay_silent(batch, first, count);
        return;
    }
    struct work w = work_on(contacts, bodies, batch, first, step);
    struct bearing bearing = {.relief = {0.0}};
    memcpy(bearing.borne, lean.borne, sizeof bearing.borne);
    w.bearing = &bearing;
    begin_at(&w, first);
    press(&w, first, count, see(&b, count, w.wants), &b);
    tell_all(&b, &lean, count);
    finish(contacts, batch, &b, count, step, w.wants.sizes, yield);
    act_leaning(&b, &lean, count, step, yield);
}

/* What corners of boxes bear of their normal forces; `lean`: of those that are deep, NULL: none is. Returns whether
 * there are any. */
static int find_bearing(const struct scree_bodies *bodies, const struct scree_rule *rule,
                        const struct scree_contact *contact, int count, const struct block *b, const struct lean *lean,
                        struct bearing *bearing) {
    int last = -1; /* for which the boxes are at hand */
    struct scree_two_boxes boxes = {.a = NULL};
    for (int k = 0; k < padded(count); k++) {
        bearing->borne[k] = lean ? lean->borne[k] : 1.0;
        bearing->relief[k] = 0.0;
        if (k >= count || !(b->overlap[k] > 0.0) || !scree_may_be_relieved(bodies, &contact[k])) continue;
        int same = last >= 0 && contact[k].ball == contact[last].ball && contact[k].host == contact[last].host;
        if (!same) boxes = scree_deep_boxes_of(bodies, &contact[k]);
        bearing->relief[k] = scree_relief(bodies, rule, &contact[k], &boxes);
        last = k;
    }
    return last >= 0;
}

static void act(const struct scree_contacts *contacts, const struct scree_bodies *bodies,
                const struct scree_batch *batch, int first, int count, double step, struct scree_yield *yield) {
    struct block b;
    struct lean lean;
    if (batch->geometry == SCREE_EDGE_EDGE) {
        act_edges(contacts, bodies, batch, first, count, step, yield);
        return;
    }
    struct ends ends;
    struct scree_contact contact[SCREE_LANES];
    struct work w = work_on(contacts, bodies, batch, first, step);
    begin_at(&w, first);
    name_contacts(batch, first, count, contact);
    find_ends(bodies->record, bodies->spin, batch->ends + first, count, &ends);
    int events = gather(bodies, batch, contact, &ends, count, w.wants, &b);
    int deep = batch->geometry == SCREE_BALL_BOX && deepen_corners(bodies, contact, count, &b, &lean);
    struct bearing bearing;
    if (deep) events = see(&b, count, w.wants);
    if (w.rubs && batch->geometry == SCREE_BALL_BOX &&
        find_bearing(bodies, w.rule, contact, count, &b, deep ? &lean : NULL, &bearing))
        w.bearing = &bearing;
    press(&w, first, count, events, &b);
    if (deep) tell_all(&b, &lean, count);
    finish(contacts, batch, &b, count, step, w.wants.sizes, yield);
    if (deep) act_leaning(&b, &lean, count, step, yield);
}

/* The deepest overlap, of a block in which one may be deeper than those before. */
static void note_depths(const struct block *b, const struct scree_ends *own, int count, struct sizes sizes,
                        struct scree_tally *tally) {
    for (int k = 0; k < count; k++) {
        double depth = b->overlap[k] / limit_of(b, k, sizes);
        if (depth <= tally->deepest) continue;
        tally->deepest = depth;
        tally->deepest_ball = own[k].ball;
        tally->deepest_host = own[k].host;
    }
}

static void note_losses(const struct block *b, int count, const struct scree_rule *rule, double step,
                        struct scree_tally *tally) {
    struct scree_losses lost;
    measure_losses(b, count, rule, step, &lost);
    scree_tally_losses(tally, &lost, count);
}

/* The steepest friction, of laws that have a slope. */
static void note_slopes(const struct block *b, const struct scree_ends *own, int count, double slope, double step,
                        struct scree_tally *tally) {
    for (int k = 0; k < count; k++) {
        double steep = scree_steepness(step * b->force[k], slope, b->rush[3][k]);
        if (steep <= tally->steepest) continue;
        tally->steepest = steep;
        tally->steepest_ball = own[k].ball;
        tally->steepest_host = own[k].host;
    }
}

/* ---- memory ---- */

/* A scene that the third cache doesn't hold goes through the others in every step: what contacts need is asked for
 * before. Of bodies that is what a strip needs that those before it didn't: once each, during the strip before
 * (slabs.c). Where there are no strips, or where threads might write the same bodies, they are asked for some blocks
 * before, with each contact. Of two that is the later one, since most have been the later one of a contact before they
 * are the first; the others come in the order of their places. Most are asked for several times so: to find out which
 * are new would cost more, in branches that a processor guesses wrong. What stays in the third cache isn't asked for,
 * unless another thread has written it: to write what others have copies of takes longer than to read it. */
enum { BLOCKS_AHEAD = 2, ENDS_BEFORE = 2 * SCREE_LANES };

static SCREE_INLINE void prefetch_record(const struct scree_bodies *bodies, int place) {
    scree_prefetch_line(bodies->record[place].x);
    scree_prefetch_line(bodies->record[place].impulse);
}

/* What contacts need of a body. */
static SCREE_INLINE void prefetch_motion(const struct scree_bodies *bodies, int place) {
    prefetch_record(bodies, place);
    scree_prefetch_line(&bodies->spin[place]);
}

/* And what it needs to move on. (Paths a processor asks for by itself.) */
static SCREE_INLINE void prefetch_body(const struct scree_bodies *bodies, int place) {
    prefetch_motion(bodies, place);
    scree_prefetch_line(&bodies->state[place]);
}

/* With each contact from `own` on: those of a quarter of a block. */
static SCREE_INLINE void prefetch_bodies(const struct scree_bodies *bodies, const struct scree_ends *own, int count) {
    int first = scree_first_of(own), some = count / 2; /* a body has two or three contacts */
    for (int k = 0; k < count; k++) prefetch_body(bodies, scree_last_of(&own[k]));
    for (int place = first; place < first + some; place++) prefetch_record(bodies, place);
}

/* Of bodies for the next strip a share that leaves as many for each quarter of a block. */
static int share_of(struct scree_places ask, int count) {
    int quarters = (count + SCREE_LANES - 1) / SCREE_LANES * 4;
    return ask.from < ask.to ? (ask.to - ask.from + quarters - 1) / quarters : 0;
}

/* `own`: of the slab itself, which move on in it; those of the next one do so later. */
static SCREE_INLINE void prefetch_share(const struct scree_bodies *bodies, struct scree_places *ask, int share,
                                        int own) {
    int end = ask->from + share < ask->to ? ask->from + share : ask->to;
    for (; ask->from < end; ask->from++)
        if (own)
            prefetch_body(bodies, ask->from);
        else
            prefetch_motion(bodies, ask->from);
}

/* For a quarter of a block at a time: at once it would wait in a queue, and the passes behind it. `left`: contacts from
 * `own` on. */
static SCREE_INLINE void prefetch_ahead(const struct scree_contacts *contacts, const struct scree_bodies *bodies,
                                        const struct work *w, const struct scree_ends *own, int left, int quarter,
                                        struct scree_trail *trail, const int share[2]) {
    enum { QUARTER = SCREE_LANES / 4 };
    if (bodies->count < contacts->cached && !trail->at_border) return;
    int from = BLOCKS_AHEAD * SCREE_LANES + quarter * QUARTER, to = from + QUARTER;
    if (!trail->asked && to <= left) prefetch_bodies(bodies, &own[from], QUARTER);
    prefetch_share(bodies, &trail->ask[0], share[0], 1);
    prefetch_share(bodies, &trail->ask[1], share[1], 0);
    SCREE_PREFETCH(own, from + ENDS_BEFORE, to + ENDS_BEFORE); /* who it is must be known before */
    if (!w->wants.remembers) return;
    for (int m = 0; m < 3; m++) SCREE_PREFETCH_TO_WRITE(w->kept[m], from, to);
    if (quarter == 0 && w->batch->slides)
        scree_prefetch_line(w->batch->slides + (own - w->batch->ends) + to + SCREE_LANES);
}

/* ---- bodies ---- */

/* Whether all of some bytes have a value. */
static inline int all_are(const unsigned char *byte, int count, int value) {
    int others = 0;
    for (int k = 0; k < count; k++) others |= byte[k] != value;
    return !others;
}

/* One body goes on; the square of its speed off its flight, as far as lists mind. */
static SCREE_INLINE double move_one(struct scree_bodies *bodies, int k, const struct scree_departure *go,
                                    scree_row gravity, scree_row next) {
    struct scree_record *record = &bodies->record[k];
    if (bodies->class[k] != SCREE_CLASS_BALL) {
        memset(record->impulse, 0, sizeof record->impulse);
        memset(record->turn, 0, sizeof record->turn);
        return 0.0;
    }
    struct scree_ball_rows rows = scree_ball_advance(record, &bodies->state[k], go->step, gravity);
    if (go->ahead)
        return scree_ball_look_ahead(record, &bodies->spin[k], rows, go->step, next, scree_flight_row(bodies, k));
    scree_ball_stay(rows, bodies->position[k]);
    return 0.0;
}

/* The same of a ball that goes straight on to the middle of the next step. */
static SCREE_INLINE double hurry_one(struct scree_record *record, struct scree_spin *spin, struct scree_state *state,
                                     const float *flight, double step, scree_row gravity, scree_row next) {
    return scree_ball_look_ahead(record, spin, scree_ball_advance(record, state, step, gravity), step, next, flight);
}

/* In two passes over some bodies at a time: a root at the end of each body's chain would hold up the next. `lent`: see
 * scree_loop. */
static int move_some(struct scree_bodies *bodies, int from, int count, const struct scree_departure *go,
                     const unsigned char *lent, int wanted) {
    double square[SCREE_LANES], step = go->step, margin = go->margin, to_come = go->to_come;
    double *path = bodies->path + from;
    scree_row gravity = scree_row_of(go->gravity), next = scree_row_of(go->next_gravity);
    int plain =
        all_are(bodies->class + from, count, SCREE_CLASS_BALL) && (!lent || all_are(lent + from, count, wanted));
    if (plain && go->ahead) {
        struct scree_record *record = bodies->record + from;
        struct scree_spin *spin = bodies->spin + from;
        struct scree_state *state = bodies->state + from;
        int flies = bodies->flight != NULL;
        const float *flight = scree_flight_row(bodies, from);
        for (int k = 0; k < count; k++)
            square[k] = hurry_one(&record[k], &spin[k], &state[k], flight + (flies ? 4 * k : 0), step, gravity, next);
    } else {
        for (int k = 0; k < count; k++) {
            int stays = bodies->class[from + k] == SCREE_CLASS_ASLEEP || (lent && lent[from + k] != wanted);
            square[k] = stays ? 0.0 : move_one(bodies, from + k, go, gravity, next);
        }
    }
    if (!go->ahead) return 0;
    int too_far = 0;
    _Pragma("omp simd reduction(| : too_far)")
    for (int k = 0; k < count; k++) too_far |= scree_outgrown(&path[k], step * sqrt(square[k]), margin, to_come);
    return too_far;
}

/* Whether none of some bodies moves on. */
static int all_stay(const struct scree_bodies *bodies, int from, int count, const unsigned char *lent, int wanted) {
    int some = 0;
    for (int k = from; k < from + count; k++)
        some |= (bodies->class[k] != SCREE_CLASS_ASLEEP) & (!lent || lent[k] == wanted);
    return !some;
}

static int move(struct scree_bodies *bodies, int from, int to, const struct scree_departure *go,
                const unsigned char *lent, int wanted) {
    int too_far = 0;
    if (go->by_moments) return SCREE_PART(move_by_moments)(bodies, from, to, go, lent, wanted);
    for (int k = from; k < to; k += SCREE_LANES) {
        int count = to - k < SCREE_LANES ? to - k : SCREE_LANES;
        if ((bodies->calm || wanted) && all_stay(bodies, k, count, lent, wanted)) continue;
        too_far |= move_some(bodies, k, count, go, lent, wanted);
    }
    return too_far;
}

/* ---- one slab ---- */

static void act_straight(const struct scree_contacts *contacts, struct scree_bodies *bodies,
                         const struct scree_batch *batch, int first, int count, double step, struct scree_tally *tally,
                         struct scree_trail *trail) {
    struct block b;
    struct ends ends[2];
    const struct scree_ends *own = batch->ends + first;
    struct scree_contact contact[SCREE_LANES];
    struct work w = work_on(contacts, bodies, batch, first, step);
    int deeds = deeds_of(batch, w.rule, batch->turns), turn = 0; /* of slabs: no corners */
    const int share[2] = {share_of(trail->ask[0], count), share_of(trail->ask[1], count)};
    find_ends(bodies->record, bodies->spin, own, count < SCREE_LANES ? count : SCREE_LANES, &ends[turn]);
    for (int done = 0; done < count; done += SCREE_LANES, own += SCREE_LANES, turn = !turn) {
        int here = count - done < SCREE_LANES ? count - done : SCREE_LANES;
        int left = count - done - here < SCREE_LANES ? count - done - here : SCREE_LANES;
        int to_come = count + trail->behind - done;
        w.wants.most = tally->deepest * (1.0 - 1e-14); /* below it, rounding included, nothing is deeper */
        if (left) find_ends(bodies->record, bodies->spin, own + here, left, &ends[!turn]);
        begin_at(&w, first + done);
        prefetch_ahead(contacts, bodies, &w, own, to_come, 0, trail, share);
        name_contacts(batch, first + done, here, contact);
        int events = gather(bodies, batch, contact, &ends[turn], here, w.wants, &b);
        prefetch_ahead(contacts, bodies, &w, own, to_come, 1, trail, share);
        press(&w, first + done, here, events, &b);
        prefetch_ahead(contacts, bodies, &w, own, to_come, 2, trail, share);
        push(&ends[turn], &b, here, batch, deeds, w.wants.sizes.even, contacts->in_hand, step);
        prefetch_ahead(contacts, bodies, &w, own, to_come, 3, trail, share);
        if (events & DEEPER) note_depths(&b, own, here, w.wants.sizes, tally);
        if (batch->slope != 0.0) note_slopes(&b, own, here, batch->slope, step, tally);
        if (contacts->measured) note_losses(&b, here, w.rule, step, tally);
    }
}

#define NAME_OF(loop) #loop
#define NAMED(loop)   NAME_OF(loop)
#define PREFIX        (sizeof "scree_loop_" - 1)
const struct scree_loop SCREE_LOOP = {&NAMED(SCREE_LOOP)[PREFIX],
                                      act,
                                      act_straight,
                                      SCREE_PART(judge),
                                      move,
                                      SCREE_PART(hold_steady),
                                      SCREE_PART(impel),
                                      SCREE_PART(impel_few),
                                      SCREE_PART(add_up),
                                      SCREE_PART(look_both),
                                      SCREE_PART(show),
                                      SCREE_PART(advance_by_moments)};
