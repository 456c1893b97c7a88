/* Near lists: the contacts of the outer list whose gap is less than what margins are left to their two bodies. All of
 * them are computed in every step, touching or not. What laws keep of a contact moves along in place, segment by
 * segment.
 *
 * The invariant: a contact that isn't listed has a gap larger than the ways that its bodies may still go before they
 * ask for a new list. One body that asks makes all lists anew, and all bodies get new margins: so they ask together,
 * not each at its time. */
#include "bodies/memory.h"
#include "contact/meet.h"

#include <stdlib.h>
#include <string.h>

/* A segment's new list while it is being made. */
struct scree_scratch {
    struct scree_contact *contact;
    int *from; /* where the contact was before, from the segment's first on; -1: nowhere */
    int capacity;
};

int scree_enlarge(void *array, int before, int after, size_t size) {
    void **place = array, *memory = scree_memory((size_t)after * size);
    if (!memory) return 0;
    if (before) memcpy(memory, *place, (size_t)before * size);
    scree_memory_free(*place);
    *place = memory;
    return 1;
}

scree_status scree_make_space(struct scree_space *space, size_t size, scree_trouble *trouble) {
    if (space->memory && size <= space->size) return SCREE_OK;
    size_t room = size + size / 16 + 64; /* never none: places in it are reckoned from its beginning */
    void *memory = scree_memory(room);
    if (!memory) return scree_report(trouble, SCREE_NO_MEMORY, NULL, "no memory for lists of %zu bytes", room);
    scree_memory_free(space->memory);
    *space = (struct scree_space){memory, room};
    return SCREE_OK;
}

/* ---- columns ---- */

/* A column of a batch that belongs to its contacts: numbers, or bytes. */
struct column {
    unsigned char *at;
    size_t size; /* of each */
};

static void *place_in(struct column column, int k) { return column.at + (size_t)k * column.size; }

/* The columns of what is kept of contacts; returns how many. */
enum { MOST_COLUMNS = SCREE_MEMORY + SCREE_PAST };
static int columns_of(const struct scree_batch *batch, struct column column[MOST_COLUMNS]) {
    int count = 0;
    for (int m = 0; m < SCREE_MEMORY; m++)
        if (batch->kept[m]) column[count++] = (struct column){(unsigned char *)batch->kept[m], sizeof(double)};
    for (int m = 0; batch->impulses && m < SCREE_PAST; m++)
        column[count++] = (struct column){(unsigned char *)batch->past[m], sizeof(double)};
    if (batch->slides) column[count++] = (struct column){batch->slides, 1};
    return count;
}

static scree_status enlarge_batch(struct scree_batch *batch, int capacity, scree_trouble *trouble) {
    int before = batch->capacity, ok = 1;
    int cornered = batch->corners && !batch->corner;
    if (capacity < before) capacity = before;
    if (cornered && capacity) ok &= scree_enlarge(&batch->corner, 0, capacity, sizeof *batch->corner);
    if (ok && capacity == before) return SCREE_OK;
    if (batch->corner && !cornered) ok &= scree_enlarge(&batch->corner, before, capacity, sizeof *batch->corner);
    ok &= scree_enlarge(&batch->ends, before, capacity, sizeof *batch->ends);
    for (int m = 0; m < SCREE_MEMORY; m++)
        if (batch->keeps[m] && m != SCREE_KEPT_STATE)
            ok &= scree_enlarge(&batch->kept[m], before, capacity, sizeof(double));
    if (batch->keeps[SCREE_KEPT_STATE]) ok &= scree_enlarge(&batch->slides, before, capacity, 1);
    for (int m = 0; batch->impulses && m < SCREE_PAST; m++)
        ok &= scree_enlarge(&batch->past[m], before, capacity, sizeof(double));
    if (!ok) return scree_report(trouble, SCREE_NO_MEMORY, NULL, "no memory for %d contacts", capacity);
    batch->capacity = capacity;
    return SCREE_OK;
}

/* Room for what the blocks of segment 0 yield. */
static scree_status enlarge_yield(struct scree_batch *batch, scree_trouble *trouble) {
    int blocks = (batch->segment[0].count + SCREE_LANES - 1) / SCREE_LANES, ok = 1;
    if (blocks <= batch->blocks) return SCREE_OK;
    blocks += blocks / 2;
    ok &= scree_enlarge(&batch->yield, batch->blocks, blocks, sizeof *batch->yield);
    if (batch->impulses) ok &= scree_enlarge(&batch->moments, batch->blocks, blocks, sizeof *batch->moments);
    if (!ok) return scree_report(trouble, SCREE_NO_MEMORY, NULL, "no memory for the yield of %d contacts", blocks);
    batch->blocks = blocks;
    return SCREE_OK;
}

/* Those that name the contacts. */
static int names_of(const struct scree_batch *batch, struct column column[2]) {
    column[0] = (struct column){(unsigned char *)batch->ends, sizeof *batch->ends};
    if (batch->corner) column[1] = (struct column){(unsigned char *)batch->corner, sizeof *batch->corner};
    return batch->corner ? 2 : 1;
}

/* All of them. */
enum { ALL_COLUMNS = MOST_COLUMNS + 2 };
static int all_columns_of(const struct scree_batch *batch, struct column column[ALL_COLUMNS]) {
    int count = columns_of(batch, column);
    return count + names_of(batch, column + count);
}

/* Move a segment's contacts and columns. */
static void shift(struct scree_batch *batch, struct scree_part *segment, int to) {
    struct column column[ALL_COLUMNS];
    int columns = all_columns_of(batch, column), count = segment->count;
    for (int c = 0; c < columns && to != segment->first && count; c++)
        memmove(place_in(column[c], to), place_in(column[c], segment->first), (size_t)count * column[c].size);
    segment->first = to;
}

static void clear_padding(struct scree_batch *batch, const struct scree_part *segment) {
    struct column column[MOST_COLUMNS];
    int columns = columns_of(batch, column), count = segment->count;
    for (int c = 0; c < columns && count; c++)
        memset(place_in(column[c], segment->first + count), 0, (size_t)(scree_padded(count) - count) * column[c].size);
}

/* Give the segments of a batch the capacities wanted (in `capacity`), in the order of segments. */
static scree_status lay_out(struct scree_batch *batch, int segments, const int *capacity, scree_trouble *trouble) {
    int all = 0, first[SCREE_SEGMENTS], used = 0;
    for (int s = 0; s < segments; s++) {
        first[s] = all;
        all += capacity[s];
    }
    scree_status status = enlarge_batch(batch, all, trouble);
    if (status) return status;
    for (int s = 0; s < segments; s++) { /* close the gaps, then open new ones from the end */
        shift(batch, &batch->segment[s], used);
        used += batch->segment[s].count;
    }
    for (int s = segments - 1; s >= 0; s--) {
        shift(batch, &batch->segment[s], first[s]);
        batch->segment[s].capacity = capacity[s];
        clear_padding(batch, &batch->segment[s]);
    }
    return SCREE_OK;
}

/* ---- picking ---- */

static int keeps_something(const struct scree_batch *batch, int k) {
    for (int m = 0; m < SCREE_MEMORY; m++)
        if (scree_kept(batch, m, k) != 0.0) return 1;
    for (int m = 0; batch->impulses && m < SCREE_PAST; m++)
        if (batch->past[m][k] != 0.0) return 1;
    return 0;
}

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
    if (batch->geometry == SCREE_BALL_IMAGE)
        return sqrt(scree_nearest2(scree_apart(bodies, contact, SCREE_BALL_IMAGE), flown)) - ball->radius -
                   host->radius <=
               left;
    left += vec_norm(flown);
    int boxes = batch->geometry == SCREE_BALL_BOX && contact->corner > 0;
    if (boxes) look_at(sight, bodies, contact, 0, left);
    return scree_gap(bodies, contact, left, boxes ? sight->overlap : 0.0) <= left;
}

/* The same of two spheres, without a root. */
static inline int are_near(const struct scree_contacts *contacts, const struct scree_bodies *bodies,
                           const struct scree_contact *contact, double left) {
    const struct scree_record *ball = &bodies->record[contact->ball], *host = &bodies->record[contact->host];
    double reach = ball->radius + host->radius + left;
    struct vec apart = vec_sub(vec_from(ball->x), vec_from(host->x));
    double square = vec_norm2(apart);
    if (bodies->flight) square = scree_nearest2(apart, scree_flown(contacts, bodies, contact->ball, contact->host));
    return !(square > reach * reach * (1.0 + 1e-12)); /* rounding can only add one to the list */
}

/* Some contacts of a segment's outer list, and which of them are near. Chance decides that: so nothing branches on it.
 * The next ones are read ahead, so that their bodies come from memory meanwhile. */
struct view {
    struct scree_outer outer;
    int left; /* to be read */
    int count, to_come;
    struct scree_contact contact[SCREE_LANES], next[SCREE_LANES];
    unsigned char near[SCREE_LANES];
};

/* So that it is at hand when the next ones are looked over: where a body is, and its path. Inlined: a function that
 * does nothing but ask is none to a compiler that looks for effects. */
static SCREE_INLINE void call(const struct scree_bodies *bodies, int k) {
    __builtin_prefetch(bodies->record[k].x);
    __builtin_prefetch(&bodies->path[k]);
}

static void read_ahead(const struct scree_bodies *bodies, struct view *view) {
    view->to_come = view->left < SCREE_LANES ? view->left : SCREE_LANES;
    view->left -= view->to_come;
    for (int k = 0; k < view->to_come; k++) {
        view->next[k] = scree_next_outer(&view->outer);
        call(bodies, view->next[k].ball);
        call(bodies, view->next[k].host);
    }
}

/* The next ones. */
static void look_over(const struct scree_contacts *contacts, const struct scree_bodies *bodies,
                      const struct scree_batch *batch, struct sight *sight, struct view *view) {
    view->count = view->to_come;
    memcpy(view->contact, view->next, (size_t)view->count * sizeof *view->next);
    read_ahead(bodies, view);
    for (int k = 0; k < view->count; k++) {
        const struct scree_contact *one = &view->contact[k];
        double left = scree_left_of(contacts, bodies, one->ball, one->host);
        if (batch->geometry == SCREE_BALL_BALL && one->corner == 0)
            view->near[k] = (unsigned char)are_near(contacts, bodies, one, left);
        else
            view->near[k] = (unsigned char)is_near(contacts, bodies, batch, one, left, sight);
    }
}

static int compare_with(const struct scree_batch *batch, int k, const struct scree_contact *other, int segment) {
    struct scree_contact own = scree_contact_at(batch, k);
    return scree_compare_contacts(&own, other, segment);
}

/* The new list of a segment into the scratch: what is near enough, and what keeps something. Returns its length. */
static int pick(const struct scree_contacts *contacts, const struct scree_bodies *bodies,
                const struct scree_batch *batch, int s, struct scree_scratch *scratch) {
    const struct scree_part *segment = &batch->segment[s];
    if (segment->outer_count == 0) return 0;
    int count = 0, before = 0;
    struct sight sight;
    struct view view;
    sight.ball = sight.host = -1;
    view.outer = scree_outer_of(batch, s);
    view.left = segment->outer_count;
    read_ahead(bodies, &view);
    for (int k = 0; k < segment->outer_count; k++) {
        int lane = k % SCREE_LANES;
        if (lane == 0) look_over(contacts, bodies, batch, &sight, &view);
        const struct scree_contact one = view.contact[lane];
        int near = view.near[lane];
        int order = -1;
        while (before < segment->count && (order = compare_with(batch, segment->first + before, &one, s)) < 0) before++;
        int same = before < segment->count && order == 0;
        if (same & !near) near = keeps_something(batch, segment->first + before);
        scratch->contact[count] = one; /* counts if it is near */
        scratch->from[count] = same ? before : -1;
        count += near;
        before += same;
    }
    return count;
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
    struct column column[MOST_COLUMNS];
    int columns = count ? columns_of(batch, column) : 0;
    for (int c = 0; c < columns; c++) {
        if (column[c].size == 1)
            move_column(place_in(column[c], segment->first), 1, count, from);
        else
            move_column(place_in(column[c], segment->first), sizeof(double), count, from);
    }
}

/* Make a segment's list anew; 0 if it has too little room, and then `count` says how much it takes. */
static int renew(const struct scree_contacts *contacts, const struct scree_bodies *bodies, struct scree_batch *batch,
                 int s, struct scree_scratch *scratch) {
    struct scree_part *segment = &batch->segment[s];
    int count = pick(contacts, bodies, batch, s, scratch);
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
        for (int s = 0; s < segments; s++)
            if (contacts->batch[b].segment[s].outer_count > most) most = contacts->batch[b].segment[s].outer_count;
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
    scree_status status = enlarge_batch(batch, 0, trouble); /* with corners, if these are new */
    if (status) return status;
#pragma omp parallel for schedule(static) num_threads(threads) if (threads > 1)
    for (int t = 0; t < threads; t++)
        for (int s = t; s < segments; s += threads)
            lacking[s] = renew(contacts, bodies, batch, s, &contacts->scratch[t]);
    for (int s = 0; s < segments; s++) {
        int least = scree_padded(batch->segment[s].count), has = batch->segment[s].capacity;
        capacity[s] = lacking[s] ? scree_padded(lacking[s] + lacking[s] / 16 + SCREE_PADDING) : has;
        if (capacity[s] < least) capacity[s] = least;
        lack |= lacking[s];
    }
    if (lack) status = lay_out(batch, segments, capacity, trouble);
    for (int s = 0; s < segments && !status; s++)
        if (lacking[s]) renew(contacts, bodies, batch, s, &contacts->scratch[0]);
    batch->count = 0;
    for (int s = 0; s < segments; s++) batch->count += batch->segment[s].count;
    return status ? status : enlarge_yield(batch, trouble);
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

/* Who has contacts in a stretch that ends before its own begins. */
static void mark_lent(struct scree_contacts *contacts, const struct scree_bodies *bodies) {
    for (int slab = SCREE_STRETCH; slab < bodies->order.slabs; slab += SCREE_STRETCH) {
        int start = bodies->order.start[slab];
        memset(contacts->lent + start, 0, (size_t)(bodies->order.start[slab + 1] - start));
        for (int b = 0; b < contacts->batches; b++) {
            const struct scree_batch *batch = &contacts->batch[b];
            const struct scree_part *before = &batch->segment[slab]; /* that of the slab before: 1 + slab - 1 */
            for (int k = before->first; k < before->first + before->count; k++) {
                int ball = batch->ends[k].ball, host = batch->ends[k].host, later = ball > host ? ball : host;
                if (later >= start) contacts->lent[later] = 1;
            }
        }
    }
}

scree_status scree_contacts_pick(struct scree_contacts *contacts, const struct scree_bodies *bodies, int threads,
                                 scree_trouble *trouble) {
    contacts->rest.stale = 1;
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

/* ---- another order of the bodies ---- */

void scree_contacts_forget(struct scree_contacts *contacts) {
    for (int b = 0; b < contacts->batches; b++) {
        struct scree_batch *batch = &contacts->batch[b];
        memset(batch->segment, 0, SCREE_SEGMENTS * sizeof *batch->segment);
        batch->count = batch->outer_count = 0;
    }
}

scree_status scree_contacts_reserve(struct scree_batch *batch, int count, int corners, scree_trouble *trouble) {
    batch->corners |= corners;
    return enlarge_batch(batch, scree_padded(count), trouble);
}

void scree_contacts_remember(struct scree_batch *batch, const struct scree_bodies *bodies,
                             const struct scree_contact *contact, const double *kept, const double *past) {
    struct scree_part *segment = &batch->segment[scree_segment_of(bodies, batch, contact)];
    int place = batch->count;
    if (segment->count == 0) segment->first = place;
    segment->capacity = ++segment->count;
    scree_put_contact(batch, place, *contact);
    for (int m = 0; m < SCREE_MEMORY; m++) scree_keep(batch, m, place, kept[m]);
    for (int m = 0; batch->impulses && m < SCREE_PAST; m++) batch->past[m][place] = past[m];
    batch->count++;
}

/* Let contacts name bodies by their numbers (1) or by their places (0). */
static void rename_bodies(struct scree_batch *batch, const int *as) {
    for (int s = 0; s < SCREE_SEGMENTS; s++)
        for (int k = batch->segment[s].first; k < batch->segment[s].first + batch->segment[s].count; k++) {
            batch->ends[k].ball = as[batch->ends[k].ball];
            batch->ends[k].host = as[batch->ends[k].host];
        }
}

static int in_order(const struct scree_bodies *bodies, const struct scree_batch *batch, int a, int b) {
    struct scree_contact first = scree_contact_at(batch, a), second = scree_contact_at(batch, b);
    int one = scree_segment_of(bodies, batch, &first), other = scree_segment_of(bodies, batch, &second);
    if (one != other) return one < other;
    return scree_compare_contacts(&first, &second, one) < 0;
}

/* Heap sort of indices. */
static void sift(const struct scree_bodies *bodies, const struct scree_batch *batch, int *index, int root, int count) {
    int value = index[root];
    for (int child = 2 * root + 1; child < count; root = child, child = 2 * root + 1) {
        if (child + 1 < count && in_order(bodies, batch, index[child], index[child + 1])) child++;
        if (!in_order(bodies, batch, value, index[child])) break;
        index[root] = index[child];
        index[child] = value;
    }
}

static void sort_indices(const struct scree_bodies *bodies, const struct scree_batch *batch, int *index, int count) {
    for (int k = 0; k < count; k++) index[k] = k;
    for (int k = count / 2; k-- > 0;) sift(bodies, batch, index, k, count);
    for (int last = count; last-- > 1;) {
        int value = index[0];
        index[0] = index[last];
        index[last] = value;
        sift(bodies, batch, index, 0, last);
    }
}

/* Close the gaps between segments; how many contacts there are. */
static int close_up(struct scree_batch *batch) {
    int used = 0;
    for (int s = 0; s < SCREE_SEGMENTS; s++) {
        shift(batch, &batch->segment[s], used);
        batch->segment[s].capacity = batch->segment[s].count;
        used += batch->segment[s].count;
    }
    return used;
}

/* Put the first `used` contacts of a batch, whose bodies lie elsewhere now, into their segments, one behind the
 * other. */
static void sort_batch(const struct scree_bodies *bodies, struct scree_batch *batch, int used, int *index) {
    struct column column[ALL_COLUMNS];
    int columns = all_columns_of(batch, column);
    sort_indices(bodies, batch, index, used);
    for (int c = 0; c < columns; c++) scree_permute(column[c].at, column[c].size, index, used);
    memset(batch->segment, 0, SCREE_SEGMENTS * sizeof *batch->segment);
    for (int k = 0; k < used; k++) {
        struct scree_contact contact = scree_contact_at(batch, k);
        struct scree_part *segment = &batch->segment[scree_segment_of(bodies, batch, &contact)];
        if (segment->count == 0) segment->first = k;
        segment->capacity = ++segment->count;
    }
    batch->count = used;
}

scree_status scree_contacts_sort(struct scree_contacts *contacts, struct scree_bodies *bodies, int threads,
                                 scree_trouble *trouble) {
    int most = 0;
    for (int b = 0; b < contacts->batches; b++)
        if (contacts->batch[b].count > most) most = contacts->batch[b].count;
    size_t count = (size_t)bodies->count, each = sizeof(uint64_t) + sizeof(int), indices = (size_t)most * sizeof(int);
    scree_status status = scree_make_space(&contacts->rough, count * each > indices ? count * each : indices, trouble);
    if (status) return status;
    for (int b = 0; b < contacts->batches; b++) rename_bodies(&contacts->batch[b], bodies->number);
    uint64_t *key = contacts->rough.memory;
    scree_bodies_sort(bodies, contacts->chosen_skin, key, (int *)(key + count));
    for (int b = 0; b < contacts->batches; b++) {
        rename_bodies(&contacts->batch[b], bodies->place);
        sort_batch(bodies, &contacts->batch[b], close_up(&contacts->batch[b]), contacts->rough.memory);
    }
    return scree_contacts_list(contacts, bodies, threads, trouble);
}

/* ---- across the border of the periodic box ---- */

/* A contact with what is kept of it, on its way to another batch. */
struct scree_moving {
    struct scree_contact contact;
    double kept[MOST_COLUMNS];
};

static const struct scree_return *return_of(const struct scree_contacts *contacts, int body) {
    int low = 0, high = contacts->returns;
    while (low < high) {
        int middle = low + (high - low) / 2;
        if (contacts->returned[middle].body < body)
            low = middle + 1;
        else
            high = middle;
    }
    return low < contacts->returns && contacts->returned[low].body == body ? &contacts->returned[low] : NULL;
}

/* The contact's code after the return of its bodies. */
static int code_after(const struct scree_contacts *contacts, const struct scree_contact *contact) {
    const struct scree_return *ball = return_of(contacts, contact->ball), *host = return_of(contacts, contact->host);
    if (!ball && !host) return contact->corner;
    int periods[3], off = 0;
    for (int axis = 0; axis < 3; axis++) {
        periods[axis] = contact->corner ? scree_periods_of(contact->corner, axis) : 0;
        periods[axis] += (host ? host->periods[axis] : 0) - (ball ? ball->periods[axis] : 0);
        off |= periods[axis] != 0;
    }
    return off ? scree_code_of(periods) : 0;
}

static int count_moving(const struct scree_contacts *contacts, const struct scree_batch *batch, int used) {
    int count = 0;
    for (int k = 0; k < used; k++) {
        struct scree_contact contact = scree_contact_at(batch, k);
        int code = code_after(contacts, &contact);
        count += (code == 0) != (batch->geometry == SCREE_BALL_BALL);
    }
    return count;
}

/* Give all contacts of a batch their new codes; those that belong to the other batch go to `moving`. Returns how many
 * stay. */
static int take_out(const struct scree_contacts *contacts, struct scree_batch *batch, int used,
                    struct scree_moving *moving) {
    struct column column[MOST_COLUMNS];
    int columns = columns_of(batch, column), stay = 0;
    for (int k = 0; k < used; k++) {
        struct scree_contact contact = scree_contact_at(batch, k);
        contact.corner = code_after(contacts, &contact);
        if ((contact.corner == 0) != (batch->geometry == SCREE_BALL_BALL)) {
            moving->contact = contact;
            for (int c = 0; c < columns; c++) memcpy(&moving->kept[c], place_in(column[c], k), column[c].size);
            moving++;
            continue;
        }
        scree_put_contact(batch, stay, contact);
        for (int c = 0; c < columns; c++) memmove(place_in(column[c], stay), place_in(column[c], k), column[c].size);
        stay++;
    }
    return stay;
}

static void put_in(struct scree_batch *batch, int at, const struct scree_moving *moving, int count) {
    struct column column[MOST_COLUMNS];
    int columns = columns_of(batch, column);
    for (int k = 0; k < count; k++) {
        scree_put_contact(batch, at + k, moving[k].contact);
        for (int c = 0; c < columns; c++) memcpy(place_in(column[c], at + k), &moving[k].kept[c], column[c].size);
    }
}

static scree_status room_for_moving(struct scree_contacts *contacts, int count, scree_trouble *trouble) {
    int capacity = 2 * count + 1;
    if (count < contacts->moving_capacity) return SCREE_OK;
    if (!scree_enlarge(&contacts->moving, contacts->moving_capacity, capacity, sizeof *contacts->moving))
        return scree_report(trouble, SCREE_NO_MEMORY, NULL, "no memory for %d contacts at the border", count);
    contacts->moving_capacity = capacity;
    return SCREE_OK;
}

/* The two batches of one rule: of two bodies as they are, and across the border. */
struct own_and_image {
    struct scree_batch *own, *image;
    int in_own, in_image, out, in; /* contacts there, and on their way out of `own` and into it */
};

static struct own_and_image both_of(struct scree_contacts *contacts, const struct scree_rule *rule) {
    struct own_and_image both = {.own = scree_batch_for(contacts, rule, SCREE_BALL_BALL),
                                 .image = scree_batch_for(contacts, rule, SCREE_BALL_IMAGE)};
    both.in_own = close_up(both.own);
    both.in_image = close_up(both.image);
    both.out = count_moving(contacts, both.own, both.in_own);
    both.in = count_moving(contacts, both.image, both.in_image);
    return both;
}

static scree_status room_for_recoding(struct scree_contacts *contacts, const struct scree_rule *rule,
                                      scree_trouble *trouble) {
    struct own_and_image both = both_of(contacts, rule);
    int all = both.in_own + both.in_image + both.out + both.in;
    scree_status status = room_for_moving(contacts, both.out + both.in, trouble);
    if (!status) status = enlarge_batch(both.own, scree_padded(both.in_own + both.in), trouble);
    if (!status) status = enlarge_batch(both.image, scree_padded(both.in_image + both.out), trouble);
    return status ? status : scree_make_space(&contacts->rough, (size_t)all * sizeof(int), trouble);
}

static void recode_rule(struct scree_contacts *contacts, const struct scree_bodies *bodies,
                        const struct scree_rule *rule) {
    struct own_and_image both = both_of(contacts, rule);
    struct scree_batch *own = both.own, *image = both.image;
    int in_own = both.in_own, in_image = both.in_image, out = both.out, in = both.in;
    in_own = take_out(contacts, own, in_own, contacts->moving);
    in_image = take_out(contacts, image, in_image, contacts->moving + out);
    put_in(own, in_own, contacts->moving + out, in);
    put_in(image, in_image, contacts->moving, out);
    sort_batch(bodies, own, in_own + in, contacts->rough.memory);
    sort_batch(bodies, image, in_image + out, contacts->rough.memory);
}

scree_status scree_contacts_recode(struct scree_contacts *contacts, const struct scree_bodies *bodies,
                                   scree_trouble *trouble) {
    scree_status status = SCREE_OK;
    contacts->broken = 1;
    for (int r = 0; r < contacts->rules && !status; r++)
        status = room_for_recoding(contacts, &contacts->rule[r], trouble);
    for (int r = 0; r < contacts->rules && !status; r++) recode_rule(contacts, bodies, &contacts->rule[r]);
    return status;
}
