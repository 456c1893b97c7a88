/* Contacts whose bodies get other places in memory, or other images in the periodic box. */
#include "contact/columns.h"

#include <string.h>

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
    return scree_enlarge_batch(batch, scree_padded(count), trouble);
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

/* Let contacts name body k as[k]: by `number` instead of its place, by `place` instead of its number. */
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

static void heap_sort(const struct scree_bodies *bodies, const struct scree_batch *batch, int *index, int count) {
    for (int k = count / 2; k-- > 0;) sift(bodies, batch, index, k, count);
    for (int last = count; last-- > 1;) {
        int value = index[0];
        index[0] = index[last];
        index[last] = value;
        sift(bodies, batch, index, 0, last);
    }
}

/* Contacts by their indices, in order. As a rule the first `stay` are so: then the others are sorted and merged in, for
 * which `index` has room behind its end. */
static void sort_indices(const struct scree_bodies *bodies, const struct scree_batch *batch, int stay, int count,
                         int *index) {
    for (int k = 1; k < stay; k++)
        if (in_order(bodies, batch, k, k - 1)) stay = 0;
    int others = count - stay, *other = stay ? index + count : index;
    for (int k = 0; k < others; k++) other[k] = stay + k;
    heap_sort(bodies, batch, other, others);
    while (stay > 0 && others > 0) {
        int later = in_order(bodies, batch, stay - 1, other[others - 1]);
        index[stay + others - 1] = later ? other[others - 1] : stay - 1;
        others -= later;
        stay -= !later;
    }
    for (int k = 0; k < stay; k++) index[k] = k;
    memmove(index, other, (size_t)others * sizeof *index);
}

/* Close the gaps between segments; how many contacts there are. */
static int close_up(struct scree_batch *batch) {
    int used = 0;
    for (int s = 0; s < SCREE_SEGMENTS; s++) {
        scree_shift_segment(batch, &batch->segment[s], used);
        batch->segment[s].capacity = batch->segment[s].count;
        used += batch->segment[s].count;
    }
    return used;
}

/* Put the first `used` contacts of a batch into their segments, one behind the other; `stay`, `index`: see
 * sort_indices. */
static void sort_batch(const struct scree_bodies *bodies, struct scree_batch *batch, int stay, int used, int *index) {
    struct scree_column column[SCREE_ALL_COLUMNS];
    int columns = scree_all_columns_of(batch, column);
    sort_indices(bodies, batch, stay, used, index);
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
        sort_batch(bodies, &contacts->batch[b], 0, close_up(&contacts->batch[b]), contacts->rough.memory);
    }
    return scree_contacts_list(contacts, bodies, threads, trouble);
}

/* ---- across the border of the periodic box ---- */

/* A contact with what is kept of it, on its way to another batch. */
struct scree_moving {
    struct scree_contact contact;
    double kept[SCREE_MOST_COLUMNS];
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
    struct scree_column column[SCREE_MOST_COLUMNS];
    int columns = scree_columns_of(batch, column), stay = 0;
    for (int k = 0; k < used; k++) {
        struct scree_contact contact = scree_contact_at(batch, k);
        contact.corner = code_after(contacts, &contact);
        if ((contact.corner == 0) != (batch->geometry == SCREE_BALL_BALL)) {
            moving->contact = contact;
            for (int c = 0; c < columns; c++) memcpy(&moving->kept[c], scree_column_at(column[c], k), column[c].size);
            moving++;
            continue;
        }
        scree_put_contact(batch, stay, contact);
        for (int c = 0; c < columns; c++)
            memmove(scree_column_at(column[c], stay), scree_column_at(column[c], k), column[c].size);
        stay++;
    }
    return stay;
}

static void put_in(struct scree_batch *batch, int at, const struct scree_moving *moving, int count) {
    struct scree_column column[SCREE_MOST_COLUMNS];
    int columns = scree_columns_of(batch, column);
    for (int k = 0; k < count; k++) {
        scree_put_contact(batch, at + k, moving[k].contact);
        for (int c = 0; c < columns; c++)
            memcpy(scree_column_at(column[c], at + k), &moving[k].kept[c], column[c].size);
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
    if (!status) status = scree_enlarge_batch(both.own, scree_padded(both.in_own + both.in), trouble);
    if (!status) status = scree_enlarge_batch(both.image, scree_padded(both.in_image + both.out), trouble);
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
    sort_batch(bodies, own, in_own, in_own + in, contacts->rough.memory);
    sort_batch(bodies, image, in_image, in_image + out, contacts->rough.memory);
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
