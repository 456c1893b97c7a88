/* The contact loop: blocks of contacts go through short passes over columns that stay in the L1 cache,
 *   fetch      body records, subtracted row by row
 *   meet       normal and overlap
 *   slide      levers, tangential velocity; stretches turn with the normal
 *   normal     the normal law
 *   friction   the friction law with its memory; a slider's in four passes
 *   rolling    the rolling law with its memory, where there is one
 *   push       impulses on both bodies
 * Choices are made per batch, never per contact. This file is compiled once for each kind of processor
 * (contact/meson.build), and uses nothing that could make a difference in a bit. */
#include "contact/loop.h"
#include "contact/passes.h"
#include "contact/push.h"

#include <string.h>

/* The last pass. */
static void finish(const struct scree_contacts *contacts, const struct scree_batch *batch, const struct block *b,
                   int count, double step, struct sizes sizes, struct scree_yield *yield) {
    const struct scree_rule *rule = &contacts->rule[batch->rule];
    write_yield(b, count, batch, deeds_of(batch, rule), sizes, step, yield);
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
    begin_at(&w, first);
    press(&w, first, count, see(&b, count, w.wants), &b);
    finish(contacts, batch, &b, count, step, w.wants.sizes, yield);
    act_leaning(&b, &lean, count, step, yield);
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
    find_ends(bodies, batch->ends + first, count, &ends);
    int events = gather(bodies, contact, &ends, count, batch->geometry, w.wants, &b);
    int deep = batch->geometry == SCREE_BALL_BOX && deepen_corners(bodies, contact, count, &b, &lean);
    if (deep) events = see(&b, count, w.wants);
    press(&w, first, count, events, &b);
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
        double steep = step * slope * b->force[k] * (4.0 * b->rush[3][k]);
        if (steep <= tally->steepest) continue;
        tally->steepest = steep;
        tally->steepest_ball = own[k].ball;
        tally->steepest_host = own[k].host;
    }
}

/* So that it is at hand later. */
static SCREE_INLINE void call(const void *array, size_t offset, size_t size) {
    for (size_t line = 0; line < size; line += 64)
        __builtin_prefetch((const void *)((uintptr_t)array + offset + line), 1);
}

/* A quarter of what the blocks to come need is asked for after each pass: partners of the next one, contacts and memory
 * of the one after. Asked for at once it would wait in a queue, and the passes behind it. Who comes first in its
 * contacts is read in order, which the processor sees by itself. */
enum { QUARTER = SCREE_LANES / 4 };
static SCREE_INLINE void call_ahead(const struct work *w, const struct scree_ends *own, const struct ends *next,
                                    int left, int quarter) {
    int from = quarter * QUARTER, to = left < from + QUARTER ? left : from + QUARTER;
    for (int k = from; k < to; k++) call(next->host[k], 0, sizeof *next->host[k]);
    call(own + 2 * SCREE_LANES + from, 0, QUARTER * sizeof *own);
    for (int m = 0; w->wants.remembers && m < 3; m++)
        call(w->kept[m] + 2 * SCREE_LANES + from, 0, QUARTER * sizeof(double));
}

/* ---- bodies ---- */

enum { FAR = 24 }; /* bodies between one that moves and the one whose state is asked for; records are at hand */

/* In two passes over some bodies at a time: a root at the end of each body's chain would hold up the next. */
static int move_some(struct scree_bodies *bodies, int from, int count, const struct scree_departure *go) {
    double square[SCREE_LANES], way[SCREE_LANES];
    scree_row gravity = scree_row_of(go->gravity), next = scree_row_of(go->next_gravity);
    int too_far = 0;
    for (int k = 0; k < count; k++) {
        struct scree_record *record = &bodies->record[from + k];
        call(&bodies->state[from + k], FAR * sizeof *bodies->state, sizeof *bodies->state);
        square[k] = 0.0;
        if (bodies->class[from + k] == SCREE_CLASS_ASLEEP) continue;
        if (bodies->class[from + k] != SCREE_CLASS_BALL) {
            memset(record->f, 0, sizeof record->f);
            memset(record->t, 0, sizeof record->t);
            continue;
        }
        struct scree_state *state = &bodies->state[from + k];
        struct scree_ball_rows rows = scree_ball_advance(record, state, go->step, gravity);
        if (go->ahead)
            square[k] = scree_ball_look_ahead(record, rows, go->step, next, scree_flight_row(bodies, from + k));
        else
            scree_ball_stay(rows, bodies->position[from + k]);
    }
    if (!go->ahead) return 0;
    _Pragma("omp simd")
    for (int k = 0; k < count; k++) way[k] = go->step * sqrt(square[k]);
    for (int k = 0; k < count; k++) too_far |= scree_outgrown(&bodies->record[from + k], way[k], go->margin);
    return too_far;
}

static int all_sleep(const struct scree_bodies *bodies, int from, int count) {
    int awake = 0;
    for (int k = from; k < from + count; k++) awake |= bodies->class[k] != SCREE_CLASS_ASLEEP;
    return !awake;
}

static int move(struct scree_bodies *bodies, int from, int to, const struct scree_departure *go) {
    int too_far = 0;
    for (int k = from; k < to; k += SCREE_LANES) {
        int count = to - k < SCREE_LANES ? to - k : SCREE_LANES;
        if (!bodies->calm || !all_sleep(bodies, k, count)) too_far |= move_some(bodies, k, count, go);
    }
    return too_far;
}

/* ---- one slab ---- */

/* Bodies before place `first` move on, a block of them at a time. Inlined, it would take registers from the
 * contacts. */
static __attribute__((noinline)) void follow(struct scree_bodies *bodies, int first, struct scree_trail *trail,
                                             struct scree_tally *tally) {
    for (; trail->next + SCREE_LANES <= first; trail->next += SCREE_LANES)
        tally->too_far |= move_some(bodies, trail->next, SCREE_LANES, trail->go);
}

static void act_straight(const struct scree_contacts *contacts, struct scree_bodies *bodies,
                         const struct scree_batch *batch, int first, int count, double step, struct scree_tally *tally,
                         struct scree_trail *trail) {
    struct block b;
    struct ends ends[2];
    const struct scree_ends *own = batch->ends + first;
    struct scree_contact contact[SCREE_LANES];
    struct work w = work_on(contacts, bodies, batch, first, step);
    int deeds = deeds_of(batch, w.rule), turn = 0;
    find_ends(bodies, own, count < SCREE_LANES ? count : SCREE_LANES, &ends[turn]);
    for (int done = 0; done < count; done += SCREE_LANES, own += SCREE_LANES, turn = !turn) {
        int here = count - done < SCREE_LANES ? count - done : SCREE_LANES;
        int left = count - done - here < SCREE_LANES ? count - done - here : SCREE_LANES;
        const struct ends *next = &ends[!turn];
        w.wants.most = tally->deepest * (1.0 - 1e-14); /* below it, rounding included, nothing is deeper */
        if (left) find_ends(bodies, own + here, left, &ends[!turn]);
        begin_at(&w, first + done);
        call_ahead(&w, own, next, left, 0);
        name_contacts(batch, first + done, here, contact);
        int events = gather(bodies, contact, &ends[turn], here, batch->geometry, w.wants, &b);
        call_ahead(&w, own, next, left, 1);
        press(&w, first + done, here, events, &b);
        call_ahead(&w, own, next, left, 2);
        push(&ends[turn], &b, here, batch, deeds, w.wants.sizes.even, step);
        call_ahead(&w, own, next, left, 3);
        if (events & DEEPER) note_depths(&b, own, here, w.wants.sizes, tally);
        if (batch->slope != 0.0) note_slopes(&b, own, here, batch->slope, step, tally);
        if (contacts->measured) note_losses(&b, here, w.rule, step, tally);
        if (trail && left)
            follow(bodies, own[here].ball < own[here].host ? own[here].ball : own[here].host, trail, tally);
    }
}

#define NAME_OF(loop) #loop
#define NAMED(loop)   NAME_OF(loop)
#define PREFIX        (sizeof "scree_loop_" - 1)
const struct scree_loop SCREE_LOOP = {&NAMED(SCREE_LOOP)[PREFIX], act, act_straight, move, SCREE_PART(impel),
                                      SCREE_PART(add_up)};
