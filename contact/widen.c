/* Bodies that ask for a list before the others do are answered alone: each gets a new margin, and what comes near by it
 * is put into the near lists. That costs a look through those outer contacts of two slabs that reach as far as it. */
#include "contact/columns.h"

#include <string.h>

/* Those who ask among some bodies: so many, and where they are. */
struct askers {
    int count, place[SCREE_ASKING];
};

/* One more than SCREE_ASKING are too many to go on. */
static void find_askers(const struct scree_contacts *contacts, const struct scree_bodies *bodies, int from, int to,
                        struct askers *askers) {
    enum { BLOCK = 64 }; /* looked over at once */
    double margin = 0.5 * contacts->skin;
    askers->count = 0;
    for (int end; from < to; from = end) {
        int some = 0;
        end = to - from < BLOCK ? to : from + BLOCK;
        for (int k = from; k < end; k++) some |= !(bodies->path[k] <= margin);
        for (int k = from; some && k < end; k++) {
            if (bodies->path[k] <= margin) continue;
            if (askers->count == SCREE_ASKING || bodies->slab[k] < 0) {
                askers->count = SCREE_ASKING + 1;
                return;
            }
            askers->place[askers->count++] = k;
        }
    }
}

int scree_contacts_asking(const struct scree_contacts *contacts, const struct scree_bodies *bodies, int threads,
                          int asking[SCREE_ASKING]) {
    struct askers askers[SCREE_PARTS];
    int count = 0;
    (void)threads; /* without OpenMP */
    if (contacts->broken || scree_flights_over(contacts) || contacts->answers == contacts->enough) return 0;
#pragma omp parallel for schedule(static) num_threads(threads) if (threads > 1)
    for (int part = 0; part < SCREE_PARTS; part++)
        find_askers(contacts, bodies, scree_part_begin(bodies, part), scree_part_begin(bodies, part + 1),
                    &askers[part]);
    for (int part = 0; part < SCREE_PARTS; part++) {
        if (count + askers[part].count > SCREE_ASKING) return 0;
        memcpy(asking + count, askers[part].place, (size_t)askers[part].count * sizeof *asking);
        count += askers[part].count;
    }
    return contacts->answers + count <= contacts->enough ? count : 0;
}

/* Where a contact is in its segment's list, or belongs. */
static int place_of(const struct scree_batch *batch, const struct scree_contact *contact, int s) {
    int low = batch->segment[s].first, high = low + batch->segment[s].count;
    while (low < high) {
        int middle = low + (high - low) / 2;
        struct scree_contact own = scree_contact_at(batch, middle);
        if (scree_compare_contacts(&own, contact, s) < 0)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

static int is_listed(const struct scree_batch *batch, const struct scree_contact *contact, int s) {
    int place = place_of(batch, contact, s);
    if (place == batch->segment[s].first + batch->segment[s].count) return 0;
    struct scree_contact own = scree_contact_at(batch, place);
    return scree_compare_contacts(&own, contact, s) == 0;
}

/* Room for one more contact in a segment, padding included. */
static scree_status give_room(const struct scree_contacts *contacts, const struct scree_bodies *bodies,
                              struct scree_batch *batch, int s, scree_trouble *trouble) {
    int capacity[SCREE_SEGMENTS], segments = bodies->order.slabs + 1, count = batch->segment[s].count;
    if (scree_padded(count + 1) <= batch->segment[s].capacity) return SCREE_OK;
    for (int k = 0; k < segments; k++) capacity[k] = scree_padded(batch->segment[k].capacity);
    capacity[s] = scree_padded(count + count / 16 + SCREE_PADDING);
    scree_status status = scree_lay_out(batch, segments, capacity, trouble);
    return status || batch->uniform ? status : scree_pair_constants(contacts, bodies, batch, trouble);
}

/* Put a contact that touches nobody yet into its place in the list. */
static scree_status insert(struct scree_contacts *contacts, const struct scree_bodies *bodies,
                           struct scree_batch *batch, int s, const struct scree_contact *contact,
                           scree_trouble *trouble) {
    scree_status status = give_room(contacts, bodies, batch, s, trouble);
    if (status) return status;
    struct scree_column column[SCREE_ALL_COLUMNS];
    struct scree_part *segment = &batch->segment[s];
    int columns = scree_all_columns_of(batch, column), place = place_of(batch, contact, s);
    size_t behind = (size_t)(segment->first + segment->count - place);
    for (int c = 0; c < columns; c++) {
        memmove(scree_column_at(column[c], place + 1), scree_column_at(column[c], place), behind * column[c].size);
        memset(scree_column_at(column[c], place), 0, column[c].size);
    }
    scree_put_contact(batch, place, *contact);
    segment->count++;
    batch->count++;
    scree_clear_padding(batch, segment);
    if (!batch->uniform) scree_insert_constants(contacts, bodies, batch, s, place);
    if (s > 0) scree_lend(contacts, bodies, s, contact);
    if (s > 0) contacts->gated[s - 1] = 0;
    return s > 0 ? SCREE_OK : scree_enlarge_yield(batch, trouble);
}

/* A contact of the outer list into the near one, if it is near and isn't there. */
static scree_status add(struct scree_contacts *contacts, const struct scree_bodies *bodies, struct scree_batch *batch,
                        int s, const struct scree_contact *contact, scree_trouble *trouble) {
    if (!scree_contact_is_near(contacts, bodies, batch, contact) || is_listed(batch, contact, s)) return SCREE_OK;
    return insert(contacts, bodies, batch, s, contact, trouble);
}

static scree_status add_loose(struct scree_contacts *contacts, const struct scree_bodies *bodies,
                              struct scree_batch *batch, int body, scree_trouble *trouble) {
    scree_status status = SCREE_OK;
    for (int k = 0; k < batch->segment[0].outer_count && !status; k++)
        if (batch->loose[k].ball == body || batch->loose[k].host == body)
            status = add(contacts, bodies, batch, 0, &batch->loose[k], trouble);
    return status;
}

static inline int names(int code, int body) { return (code >> 1 == body) | (code == ~body); }

/* The first code from `from` on that names a body; `end` if none does before. */
static int find(const int *code, int from, int end, int body) {
    enum { BLOCK = 32 }; /* looked over at once */
    for (int some = 0; from + BLOCK <= end; from += BLOCK) {
        for (int k = from; k < from + BLOCK; k++) some |= names(code[k], body);
        if (some) break;
    }
    while (from < end && !names(code[from], body)) from++;
    return from;
}

/* Where the codes begin of the first body from `first` on that comes first in contacts. */
static int begin_of(const int *code, int count, int first) {
    int low = 0, high = count;
    while (low < high) {
        int middle = low + (high - low) / 2, begin = middle;
        while (code[begin] >= 0) begin--;
        if (~code[begin] >= first)
            high = begin;
        else
            for (low = middle + 1; low < high && code[low] >= 0;) low++;
    }
    return low;
}

/* Contacts of a body in the outer list of a slab's segment: it comes first, and its partners follow, or it is the
 * partner of somebody within reach. */
static scree_status add_of_segment(struct scree_contacts *contacts, const struct scree_bodies *bodies,
                                   struct scree_batch *batch, int s, int body, scree_trouble *trouble) {
    const struct scree_part *segment = &batch->segment[s];
    const int *code = batch->code + segment->codes_first;
    int in_next = body >= bodies->order.start[s];
    struct scree_span reach = segment->reach[in_next];
    int from = begin_of(code, segment->codes, body - (reach.most > 0 ? reach.most : 0));
    int end = begin_of(code, segment->codes, in_next ? body - reach.least + 1 : body + 1);
    scree_status status = SCREE_OK;
    for (int k = find(code, from, end, body); k < end && !status; k = find(code, k, end, body)) {
        int first = k, leads = code[k] < 0;
        while (code[first] >= 0) first--;
        struct scree_outer outer = {NULL, code + k + leads, ~code[first]};
        do {
            struct scree_contact contact = scree_next_outer(&outer);
            status = add(contacts, bodies, batch, s, &contact, trouble);
            k = (int)(outer.code - code);
        } while (leads && k < end && code[k] >= 0 && !status);
    }
    return status;
}

/* What comes near a body of a slab by its new margin. */
static scree_status add_of(struct scree_contacts *contacts, const struct scree_bodies *bodies, int body,
                           scree_trouble *trouble) {
    scree_status status = SCREE_OK;
    int slab = bodies->slab[body];
    for (int b = 0; b < contacts->busy_batches && !status; b++) {
        struct scree_batch *batch = &contacts->batch[contacts->busy[b]];
        status = add_loose(contacts, bodies, batch, body, trouble);
        if (!status && slab > 0) status = add_of_segment(contacts, bodies, batch, slab, body, trouble);
        if (!status) status = add_of_segment(contacts, bodies, batch, 1 + slab, body, trouble);
    }
    return status;
}

scree_status scree_contacts_answer(struct scree_contacts *contacts, struct scree_bodies *bodies, const int *asking,
                                   int count, int threads, scree_trouble *trouble) {
    scree_status status = SCREE_OK;
    contacts->rest.stale = 1;
    contacts->flights.ahead = contacts->flights.until - contacts->flights.flown;
    for (int k = 0; k < count && !status; k++, contacts->answers++) {
        if (!scree_grant_anew(contacts, bodies, asking[k]))
            return scree_contacts_list(contacts, bodies, threads, trouble);
        status = add_of(contacts, bodies, asking[k], trouble);
    }
    contacts->broken |= status != SCREE_OK;
    return status;
}
