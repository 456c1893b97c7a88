/* Near lists: the contacts of the outer list whose gap is less than what margins are left to their two bodies. All of
 * them are computed in every step, touching or not. What laws keep of a contact moves along in place, segment by
 * segment.
 *
 * The invariant: a contact that isn't listed has a gap larger than the ways that its bodies may still go before they
 * ask for a new list. The first bodies that ask are answered alone (widen.c); when these become many, all lists are
 * made anew, and all bodies get new margins. */
#include "bodies/memory.h"
#include "contact/approach.h"
#include "contact/columns.h"
#include "contact/loop.h"
#include "contact/meet.h"

#include <stdlib.h>
#include <string.h>

/* A segment's new list while it is being made. */
struct scree_scratch {
    struct scree_contact *contact;
    int *from; /* where the contact was before, from the segment's first on; -1: nowhere */
    int capacity;
};

/* What was seen of the two boxes looked at last: how deep their cores are in each other; of edges the near ones, by
 * rising codes, and the first of them that hasn't been asked for. */
struct sight {
    int ball, host;
    double overlap;
    int count, next, code[SCREE_EDGES * SCREE_EDGES];
};

static void look_at(struct sight *sight, const struct scree_bodies *bodies, const struct scree_contact *contact,
                    int edges, double left) {
    if (sight->ball == contact->ball && sight->host == contact->host) return;
    struct scree_two_boxes boxes = scree_two_boxes_of(bodies, contact->ball, contact->host);
    sight->ball = contact->ball;
    sight->host = contact->host;
    sight->overlap = scree_cores_overlap(&boxes);
    sight->count = edges ? scree_near_edges(&boxes, sight->overlap, left, sight->code) : 0;
    sight->next = 0;
}

/* Contacts of two boxes are asked for by rising codes. */
static int sees_edges(struct sight *sight, const struct scree_bodies *bodies, const struct scree_contact *contact,
                      double left) {
    look_at(sight, bodies, contact, 1, left);
    while (sight->next < sight->count && sight->code[sight->next] < contact->corner) sight->next++;
    return sight->next < sight->count && sight->code[sight->next] == contact->corner;
}

/* Whether a contact may touch before its bodies have gone `left`, both together. */
static int is_near(const struct scree_contacts *contacts, const struct scree_bodies *bodies,
                   const struct scree_batch *batch, const struct scree_contact *contact, double left,
                   struct sight *sight) {
    const struct scree_record *ball = &bodies->record[contact->ball], *host = &bodies->record[contact->host];
    struct vec flown = scree_flown(contacts, bodies, contact->ball, contact->host);
    if (batch->geometry == SCREE_EDGE_EDGE) return sees_edges(sight, bodies, contact, left);
    if (batch->geometry == SCREE_BALL_IMAGE) {
        double back = scree_half_step_of(contacts, bodies);
        struct vec from = vec_axpy(scree_apart(bodies, contact, SCREE_BALL_IMAGE), -back, flown);
        double gap = sqrt(scree_nearest2(from, vec_scale(1.0 + back, flown))) - ball->radius - host->radius;
        return gap <= left + contacts->flights.bend;
    }
    left += vec_norm(flown); /* in any direction, so also of half a step ago */
    int boxes = batch->geometry == SCREE_BALL_BOX && contact->corner > 0;
    if (boxes) look_at(sight, bodies, contact, 0, left);
    return scree_gap(bodies, contact, left, boxes ? sight->overlap : 0.0) <= left;
}

/* The same of two spheres. */
static int are_near(const struct scree_contacts *contacts, const struct scree_bodies *bodies,
                    const struct scree_contact *contact) {
    const struct scree_record *ball = &bodies->record[contact->ball], *host = &bodies->record[contact->host];
    double left = scree_left_of(contacts, bodies, contact->ball, contact->host) + contacts->flights.bend;
    return scree_come_near(vec_sub(vec_from(ball->x), vec_from(host->x)),
                           scree_flown(contacts, bodies, contact->ball, contact->host),
                           scree_half_step_of(contacts, bodies), ball->radius + host->radius + left);
}

/* Whatever it is. */
static inline int is_any_near(const struct scree_contacts *contacts, const struct scree_bodies *bodies,
                              const struct scree_batch *batch, const struct scree_contact *contact,
                              struct sight *sight) {
    if (batch->geometry == SCREE_BALL_BALL && contact->corner == 0) return are_near(contacts, bodies, contact);
    double left = scree_left_of(contacts, bodies, contact->ball, contact->host);
    return is_near(contacts, bodies, batch, contact, left, sight);
}

int scree_contact_is_near(const struct scree_contacts *contacts, const struct scree_bodies *bodies,
                          const struct scree_batch *batch, const struct scree_contact *contact) {
    struct sight sight = {.ball = -1, .host = -1};
    return is_any_near(contacts, bodies, batch, contact, &sight);
}

static int compare_with(const struct scree_batch *batch, int k, const struct scree_contact *other, int segment) {
    struct scree_contact own = scree_contact_at(batch, k);
    return scree_compare_contacts(&own, other, segment);
}

/* The new list of a segment into the scratch: what is near enough, and what keeps something. Returns its length. */
static int pick(const struct scree_contacts *contacts, const struct scree_bodies *bodies,
                const struct scree_batch *batch, int s, struct scree_scratch *scratch) {
    const struct scree_part *segment = &batch->segment[s];
    int count = 0, before = 0;
    struct sight sight = {.ball = -1, .host = -1};
    struct scree_outer outer = scree_outer_of(batch, s);
    for (int k = 0; k < segment->outer_count; k++) {
        const struct scree_contact one = scree_next_outer(&outer);
        int near = is_any_near(contacts, bodies, batch, &one, &sight), order = -1;
        while (before < segment->count && (order = compare_with(batch, segment->first + before, &one, s)) < 0) before++;
        int same = before < segment->count && order == 0;
        if (same & !near) near = scree_keeps_something(batch, segment->first + before);
        scratch->contact[count] = one; /* counts if it is near */
        scratch->from[count] = same ? before : -1;
        count += near;
        before += same;
    }
    return count;
}

/* ---- pairs of spheres, of which slabs have many ---- */

/* So that it is at hand when the next ones are looked over: where a body is, and its path. Inlined: a function that
 * does nothing but ask is none to a compiler that looks for effects. */
static SCREE_INLINE void call(const struct scree_bodies *bodies, int k) {
    __builtin_prefetch(bodies->record[k].x);
    __builtin_prefetch(&bodies->path[k]);
}

/* The next ones of the outer list, of which `left` are left; those behind them repeat the first. Returns how many. */
static int read_ahead(const struct scree_bodies *bodies, struct scree_outer *outer, int left,
                      struct scree_contact pair[SCREE_LANES]) {
    int count = left < SCREE_LANES ? left : SCREE_LANES;
    struct scree_outer at = *outer;
    for (int k = 0; k < count; k++) {
        pair[k] = scree_next_outer(&at);
        call(bodies, pair[k].ball);
        call(bodies, pair[k].host);
    }
    *outer = at;
    for (int k = count; count && k < SCREE_LANES; k++) pair[k] = pair[0];
    return count;
}

/* The near ones into the scratch: chance decides which, so nothing branches on it. The next ones are read ahead, so
 * that their bodies come from memory meanwhile. Returns how many. */
static int sift(const struct scree_contacts *contacts, const struct scree_bodies *bodies,
                const struct scree_batch *batch, int s, struct scree_scratch *scratch) {
    struct scree_outer outer = scree_outer_of(batch, s);
    struct scree_contact pair[2][SCREE_LANES];
    int left = batch->segment[s].outer_count, count = 0, here = read_ahead(bodies, &outer, left, pair[0]);
    for (int turn = 0; here > 0; turn = !turn) {
        left -= here;
        int next = read_ahead(bodies, &outer, left, pair[!turn]);
        uint32_t near = contacts->loop->judge(contacts, bodies, pair[turn], here);
        struct scree_contact *to = scratch->contact + count;
        for (int k = 0; k < here; k++, near >>= 1) {
            *to = pair[turn][k];
            to += near & 1;
        }
        count = (int)(to - scratch->contact);
        here = next;
    }
    return count;
}

/* Where each of them was before. Returns how many were that aren't near and keep something. */
static int find_again(const struct scree_batch *batch, int s, int count, struct scree_scratch *scratch) {
    const struct scree_part *segment = &batch->segment[s];
    int before = segment->first, end = before + segment->count, held = 0;
    for (int k = 0; k < count; k++) {
        int order = -1;
        while (before < end && (order = compare_with(batch, before, &scratch->contact[k], s)) < 0)
            held += scree_keeps_something(batch, before++);
        int same = before < end && order == 0;
        scratch->from[k] = same ? before - segment->first : -1;
        before += same;
    }
    while (before < end) held += scree_keeps_something(batch, before++);
    return held;
}

/* Those go among them, from behind: they hold beyond the touch, though not as far as the outer list reaches. */
static void put_held(const struct scree_batch *batch, int s, int count, int held, struct scree_scratch *scratch) {
    const struct scree_part *segment = &batch->segment[s];
    int own = count - 1, before = segment->first + segment->count - 1;
    for (int to = own + held; to > own;) {
        int order = own < 0 ? 1 : compare_with(batch, before, &scratch->contact[own], s);
        if (order <= 0) {
            scratch->contact[to] = scratch->contact[own];
            scratch->from[to--] = scratch->from[own--];
        } else if (scree_keeps_something(batch, before)) {
            scratch->contact[to] = scree_contact_at(batch, before);
            scratch->from[to--] = before - segment->first;
        }
        before -= order >= 0;
    }
}

static int pick_any(const struct scree_contacts *contacts, const struct scree_bodies *bodies,
                    const struct scree_batch *batch, int s, struct scree_scratch *scratch) {
    if (batch->segment[s].outer_count == 0) return 0;
    if (s == 0 || batch->geometry != SCREE_BALL_BALL || batch->corners)
        return pick(contacts, bodies, batch, s, scratch);
    int count = sift(contacts, bodies, batch, s, scratch), held = find_again(batch, s, count, scratch);
    put_held(batch, s, count, held, scratch);
    return count + held;
}

/* A column from the places of the old list to those of the new one: those that go on move together, then apart. `size`
 * is a constant. */
static SCREE_INLINE void move_column(unsigned char *own, size_t size, int count, const int *from) {
    size_t going_on = 0;
    for (int k = 0; k < count; k++)
        if (from[k] >= 0) memmove(own + going_on++ * size, own + (size_t)from[k] * size, size);
    for (int k = scree_padded(count) - 1; k >= 0; k--) {
        if (k < count && from[k] >= 0)
            memmove(own + (size_t)k * size, own + --going_on * size, size);
        else
            memset(own + (size_t)k * size, 0, size);
    }
}

static void move_columns(struct scree_batch *batch, const struct scree_part *segment, int count, const int *from) {
    struct scree_column column[SCREE_MOST_COLUMNS];
    int columns = count ? scree_columns_of(batch, column) : 0;
    for (int c = 0; c < columns; c++) {
        if (column[c].size == 1)
            move_column(scree_column_at(column[c], segment->first), 1, count, from);
        else
            move_column(scree_column_at(column[c], segment->first), sizeof(double), count, from);
    }
}

/* Make a segment's list anew. Returns 0, or how many contacts it must hold if it has too little room: then nothing was
 * changed. */
static int renew(const struct scree_contacts *contacts, const struct scree_bodies *bodies, struct scree_batch *batch,
                 int s, struct scree_scratch *scratch) {
    struct scree_part *segment = &batch->segment[s];
    int count = pick_any(contacts, bodies, batch, s, scratch);
    if (scree_padded(count) > segment->capacity) return count;
    move_columns(batch, segment, count, scratch->from);
    for (int k = 0; k < count; k++) scree_put_contact(batch, segment->first + k, scratch->contact[k]);
    segment->count = count;
    return 0;
}

static scree_status prepare_scratch(struct scree_contacts *contacts, int threads, int segments,
                                    scree_trouble *trouble) {
    int most = 1;
    for (int b = 0; b < contacts->batches; b++)
        for (int s = 0; s < segments; s++) {
            const struct scree_part *segment = &contacts->batch[b].segment[s];
            int sorted = segment->outer_count + segment->count; /* near ones, and those that hold */
            if (sorted > most) most = sorted;
        }
    int ok = 1;
    if (threads > contacts->scratches) {
        ok = scree_enlarge(&contacts->scratch, contacts->scratches, threads, sizeof *contacts->scratch);
        if (ok) contacts->scratches = threads;
    }
    for (int t = 0; ok && t < threads; t++) {
        struct scree_scratch *scratch = &contacts->scratch[t];
        if (most <= scratch->capacity) continue;
        int capacity = most + most / 8;
        ok &= scree_enlarge(&scratch->contact, scratch->capacity, capacity, sizeof *scratch->contact);
        ok &= scree_enlarge(&scratch->from, scratch->capacity, capacity, sizeof *scratch->from);
        if (ok) scratch->capacity = capacity;
    }
    return ok ? SCREE_OK : scree_report(trouble, SCREE_NO_MEMORY, NULL, "no memory to sort %d contacts", most);
}

void scree_contacts_free_scratch(struct scree_contacts *contacts) {
    for (int t = 0; t < contacts->scratches; t++) {
        scree_memory_free(contacts->scratch[t].contact);
        scree_memory_free(contacts->scratch[t].from);
    }
    scree_memory_free(contacts->scratch);
    contacts->scratch = NULL;
    contacts->scratches = 0;
}

/* Segments of a batch by as many threads; those that lack room get it, and their turn once more. */
static scree_status renew_batch(struct scree_contacts *contacts, const struct scree_bodies *bodies,
                                struct scree_batch *batch, int segments, int threads, scree_trouble *trouble) {
    int lacking[SCREE_SEGMENTS] = {0}, capacity[SCREE_SEGMENTS], lack = 0;
    scree_status status = scree_enlarge_batch(batch, 0, trouble); /* with corners, if these are new */
    if (status) return status;
#pragma omp parallel for schedule(static) num_threads(threads) if (threads > 1)
    for (int t = 0; t < threads; t++)
        for (int s = t; s < segments; s += threads)
            lacking[s] = renew(contacts, bodies, batch, s, &contacts->scratch[t]);
    for (int s = 0; s < segments; s++) {
        int least = scree_padded(batch->segment[s].count), has = batch->segment[s].capacity;
        capacity[s] = lacking[s] ? scree_padded(lacking[s] + lacking[s] / 32 + SCREE_PADDING) : has;
        if (capacity[s] < least) capacity[s] = least;
        lack |= lacking[s];
    }
    if (lack) status = scree_lay_out(batch, segments, capacity, trouble);
    for (int s = 0; s < segments && !status; s++)
        if (lacking[s]) renew(contacts, bodies, batch, s, &contacts->scratch[0]);
    batch->count = 0;
    for (int s = 0; s < segments; s++) batch->count += batch->segment[s].count;
    return status ? status : scree_enlarge_yield(batch, trouble);
}

/* ---- edges on edges ---- */

static struct scree_run run_of(const struct scree_contacts *contacts, const struct scree_bodies *bodies,
                               const struct scree_batch *batch, int start) {
    const struct scree_ends *contact = &batch->ends[batch->segment[0].first + start];
    int holds_on = scree_normal_laws[contacts->rule[batch->rule].normal]->reach != NULL; /* beyond touch */
    struct scree_two_boxes boxes = scree_two_boxes_of(bodies, contact->ball, contact->host);
    double clear = scree_cores_apart(&boxes) - boxes.rounding_a - boxes.rounding_b;
    double from = bodies->path[contact->ball] + bodies->path[contact->host];
    return (struct scree_run){start, holds_on ? 0.0 : clear, from, scree_first_rectangles(&boxes)};
}

/* The runs of a batch of edges on edges. */
static scree_status find_runs(const struct scree_contacts *contacts, const struct scree_bodies *bodies,
                              struct scree_batch *batch, scree_trouble *trouble) {
    int count = batch->segment[0].count, before = batch->run_capacity, ok = 1;
    const struct scree_ends *contact = count ? batch->ends + batch->segment[0].first : NULL;
    if (count > before) {
        int after = count + count / 2;
        ok &= scree_enlarge(&batch->run, before, after, sizeof *batch->run);
        ok &= scree_enlarge(&batch->first_run, before, after, sizeof *batch->first_run);
        if (!ok) return scree_report(trouble, SCREE_NO_MEMORY, NULL, "no memory for %d contacts of edges", count);
        batch->run_capacity = after;
    }
    batch->runs = 0;
    for (int k = 0; k < count; k++) {
        int same = k > 0 && contact[k].ball == contact[k - 1].ball && contact[k].host == contact[k - 1].host;
        if (!same) batch->run[batch->runs++] = run_of(contacts, bodies, batch, k);
        if (k % SCREE_LANES == 0) batch->first_run[k / SCREE_LANES] = batch->runs - 1;
    }
    return SCREE_OK;
}

void scree_lend(struct scree_contacts *contacts, const struct scree_bodies *bodies, int s,
                const struct scree_contact *contact) {
    int later = contact->ball > contact->host ? contact->ball : contact->host;
    if (s % SCREE_STRETCH == 0 && s < bodies->order.slabs && later >= bodies->order.start[s]) contacts->lent[later] = 1;
}

/* Who has contacts in a stretch that ends before its own begins. */
static void mark_lent(struct scree_contacts *contacts, const struct scree_bodies *bodies) {
    for (int slab = SCREE_STRETCH; slab < bodies->order.slabs; slab += SCREE_STRETCH) {
        int start = bodies->order.start[slab];
        memset(contacts->lent + start, 0, (size_t)(bodies->order.start[slab + 1] - start));
        for (int b = 0; b < contacts->batches; b++) {
            const struct scree_batch *batch = &contacts->batch[b];
            const struct scree_part *before = &batch->segment[slab]; /* that of the slab before: 1 + slab - 1 */
            for (int k = before->first; k < before->first + before->count; k++) {
                struct scree_contact contact = scree_contact_at(batch, k);
                scree_lend(contacts, bodies, slab, &contact);
            }
        }
    }
}

scree_status scree_contacts_pick(struct scree_contacts *contacts, const struct scree_bodies *bodies, int threads,
                                 scree_trouble *trouble) {
    contacts->rest.stale = 1;
    memset(contacts->gated, 0, sizeof contacts->gated);
    int segments = bodies->order.slabs + 1;
    scree_status status = prepare_scratch(contacts, threads, segments, trouble);
    for (int b = 0; b < contacts->batches && !status; b++) {
        struct scree_batch *batch = &contacts->batch[b];
        if (batch->outer_count == 0 && batch->count == 0) continue;
        status = renew_batch(contacts, bodies, batch, segments, threads, trouble);
        if (!status && batch->geometry == SCREE_EDGE_EDGE) status = find_runs(contacts, bodies, batch, trouble);
        if (!status && !batch->uniform) status = scree_pair_constants(contacts, bodies, batch, trouble);
    }
    if (!status) mark_lent(contacts, bodies);
    contacts->broken |= status != SCREE_OK;
    return status;
}
