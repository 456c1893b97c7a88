/* Bodies that ask for a list before the others do are answered alone: each gets a new margin, and what comes near by it
 * is put into the near lists. That costs a look through those outer contacts of two slabs that reach as far as it.
 *
 * One that has used up what the outer list left it gets more, and those that it may meet by that are put into the outer
 * list, which costs a look at some slabs: among a million some have always begun to roll since. */
#include "contact/columns.h"
#include "contact/geometry.h"

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

/* ---- more of the outer list ---- */

/* A contact that the outer list may lack. */
struct lacking {
    int batch, segment;
    struct scree_contact contact;
};

enum { MOST_LACKING = 128 };

/* How far a body may go until outer lists are made anew, m. */
static double left_by_outer(const struct scree_contacts *contacts, const struct scree_bodies *bodies, int k) {
    int fixed = bodies->class[k] == SCREE_CLASS_FIXED;
    return fixed ? 0.0 : (double)contacts->spare[k] + (0.5 * contacts->skin - bodies->path[k]);
}

/* Whether two bodies, the first of which is a ball, may meet before they have gone so far together. */
static int may_meet(const struct scree_bodies *bodies, int k, int other, double left) {
    const struct scree_record *a = &bodies->record[k], *b = &bodies->record[other];
    struct vec apart = vec_sub(vec_from(a->x), vec_from(b->x));
    double reach = a->bound + b->bound + left;
    if (other >= bodies->order.members || scree_kind_of(bodies, other)->shape.kind != SCREE_PLANE)
        return vec_norm2(apart) <= reach * reach;
    const struct mat *frame = &scree_attitude_of(bodies, other)->frame;
    return -scree_meet_plane(vec_from(a->x), a->bound, vec_from(b->x), frame).overlap <= left;
}

/* The contact of a ball with another or with a plane, as the outer list has it; 0: of that kind the list has none. */
static int name_lacking(const struct scree_contacts *contacts, const struct scree_bodies *bodies, int k, int other,
                        const struct scree_rule *rule, struct lacking *lacking) {
    scree_shape_kind kind = scree_kind_of(bodies, other)->shape.kind;
    int swap = kind == SCREE_SPHERE && bodies->number[k] > bodies->number[other];
    enum scree_geometry geometry = kind == SCREE_SPHERE ? SCREE_BALL_BALL : SCREE_BALL_PLANE;
    if (kind != SCREE_SPHERE && kind != SCREE_PLANE) return 0;
    const struct scree_batch *batch = scree_batch_for(contacts, rule, geometry);
    lacking->contact = (struct scree_contact){swap ? other : k, swap ? k : other, 0};
    lacking->batch = (int)(batch - contacts->batch);
    lacking->segment = scree_segment_of(bodies, batch, &lacking->contact);
    return batch->outer_count > 0 && lacking->segment > 0;
}

/* A body that may go so far from where it is is one of those that stay. */
static void widen_stay(const struct scree_bodies *bodies, int k, double left, struct scree_stay *stay) {
    double x = bodies->record[k].x[bodies->order.axis[0]], reach = bodies->record[k].bound + fmax(left, 0.0);
    stay->low = fmin(stay->low, x - reach);
    stay->high = fmax(stay->high, x + reach);
}

/* Of a slab's bodies: what they go, and what is left of it, adds up to no more than now. */
static struct scree_stay stay_of(const struct scree_contacts *contacts, const struct scree_bodies *bodies, int slab) {
    struct scree_stay stay = {HUGE_VAL, -HUGE_VAL};
    for (int k = bodies->order.start[slab]; k < bodies->order.start[slab + 1]; k++)
        widen_stay(bodies, k, left_by_outer(contacts, bodies, k), &stay);
    return stay;
}

/* Those from place `from` to `to` - 1 that a ball may meet before it has gone `left`, behind `count` others. Returns
 * how many there are then, -1: more, or others than can be put in. */
static int find_lacking(const struct scree_contacts *contacts, const struct scree_bodies *bodies, int k, double left,
                        int from, int to, struct lacking lacking[MOST_LACKING], int count) {
    for (int other = from; other < to && count >= 0; other++) {
        if (other == k || !may_meet(bodies, k, other, left + left_by_outer(contacts, bodies, other))) continue;
        const struct scree_rule *rule = scree_contacts_rule(contacts, bodies, k, other, NULL);
        if (!rule) continue;
        int known = count < MOST_LACKING && name_lacking(contacts, bodies, k, other, rule, &lacking[count]);
        count = known ? count + 1 : -1;
    }
    return count;
}

/* The same among all bodies. */
static int find_all_lacking(const struct scree_contacts *contacts, const struct scree_bodies *bodies, int k,
                            double left, struct lacking lacking[MOST_LACKING]) {
    const struct scree_order *order = &bodies->order;
    double x = bodies->record[k].x[order->axis[0]], reach = bodies->record[k].bound + left;
    int count = find_lacking(contacts, bodies, k, left, 0, order->members, lacking, 0);
    for (int slab = 0; slab < order->slabs && count >= 0; slab++)
        if (x - reach <= contacts->stay[slab].high && x + reach >= contacts->stay[slab].low)
            count = find_lacking(contacts, bodies, k, left, order->start[slab], order->start[slab + 1], lacking, count);
    return count;
}

/* Where the outer lists of all batches end. */
static int *end_of_codes(const struct scree_contacts *contacts, const struct scree_bodies *bodies) {
    const struct scree_batch *last = &contacts->batch[contacts->batches - 1];
    int codes = 0;
    for (int s = 1; s <= bodies->order.slabs; s++) codes += last->segment[s].codes;
    return last->code + codes;
}

static int has_room(const struct scree_contacts *contacts, const struct scree_bodies *bodies, int codes) {
    const char *end = (const char *)end_of_codes(contacts, bodies), *begin = contacts->listed.memory;
    return (size_t)(end - begin) + (size_t)codes * sizeof(int) <= contacts->listed.size;
}

/* Codes into a segment's list, before the one at `at`; what lies behind moves up. */
static void put_codes(struct scree_contacts *contacts, const struct scree_bodies *bodies, const struct lacking *one,
                      int at, const int *code, int count) {
    struct scree_batch *batch = &contacts->batch[one->batch];
    int *place = batch->code + batch->segment[one->segment].codes_first + at;
    size_t behind = (size_t)(end_of_codes(contacts, bodies) - place);
    memmove(place + count, place, behind * sizeof *place);
    memcpy(place, code, (size_t)count * sizeof *place);
    batch->segment[one->segment].codes += count;
    for (int s = one->segment + 1; s <= bodies->order.slabs; s++) batch->segment[s].codes_first += count;
    for (int b = one->batch + 1; b < contacts->batches; b++) contacts->batch[b].code += count;
}

/* A contact into the outer list, if it isn't there. */
static void put_lacking(struct scree_contacts *contacts, const struct scree_bodies *bodies, const struct lacking *one) {
    struct scree_batch *batch = &contacts->batch[one->batch];
    struct scree_part *segment = &batch->segment[one->segment];
    const int *code = batch->code + segment->codes_first;
    int swap = one->contact.host < one->contact.ball, first = swap ? one->contact.host : one->contact.ball;
    int partner = swap ? one->contact.ball : one->contact.host, own[2] = {~first, 2 * partner + swap};
    int at = begin_of(code, segment->codes, first), leads = at < segment->codes && code[at] == ~first;
    if (leads)
        for (at++; at < segment->codes && code[at] >= 0 && code[at] < own[1] - swap;) at++;
    if (leads && at < segment->codes && code[at] >= 0 && code[at] >> 1 == partner) return;
    put_codes(contacts, bodies, one, at, own + leads, 2 - leads);
    scree_widen_reach(segment, first, partner, bodies->order.start[one->segment]);
    segment->outer_count++;
    batch->outer_count++;
}

void scree_find_stays(struct scree_contacts *contacts, const struct scree_bodies *bodies) {
    for (int slab = 0; !contacts->stays && slab < bodies->order.slabs; slab++)
        contacts->stay[slab] = stay_of(contacts, bodies, slab);
    contacts->stays = 1;
}

int scree_contacts_extend(struct scree_contacts *contacts, struct scree_bodies *bodies, int k) {
    struct lacking lacking[MOST_LACKING];
    double more = fmin(contacts->skin, contacts->most_margin);
    if (contacts->extended >= SCREE_MOST_EXTENDED) return 0;
    if (bodies->slab[k] < 0 || bodies->class[k] != SCREE_CLASS_BALL || bodies->periodic || bodies->flight) return 0;
    scree_find_stays(contacts, bodies);
    double left = (double)contacts->spare[k] + more;
    int count = find_all_lacking(contacts, bodies, k, left, lacking);
    if (count < 0 || !has_room(contacts, bodies, 2 * count)) return 0;
    widen_stay(bodies, k, left, &contacts->stay[bodies->slab[k]]);
    contacts->extended++;
    for (int n = 0; n < count; n++) put_lacking(contacts, bodies, &lacking[n]);
    return scree_grant_more(contacts, bodies, k, more);
}

scree_status scree_contacts_answer(struct scree_contacts *contacts, struct scree_bodies *bodies, const int *asking,
                                   int count, int threads, scree_trouble *trouble) {
    scree_status status = SCREE_OK;
    contacts->rest.stale = 1;
    contacts->flights.ahead = contacts->flights.until - contacts->flights.flown;
    for (int k = 0; k < count && !status; k++, contacts->answers++) {
        if (!scree_grant_anew(contacts, bodies, asking[k]) && !scree_contacts_extend(contacts, bodies, asking[k]))
            return scree_contacts_list(contacts, bodies, threads, trouble);
        status = add_of(contacts, bodies, asking[k], trouble);
    }
    contacts->broken |= status != SCREE_OK;
    return status;
}
