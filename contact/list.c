/* The list of near contacts: made from candidate pairs, sorted, with the contact memory of the list before. */
#include "contact/contacts.h"

#include "contact/meet.h"

#include <stdlib.h>
#include <string.h>

static size_t blocks_for(int count) { return ((size_t)count + SCREE_LANES - 1) / SCREE_LANES; }

static scree_status grow(struct scree_batch *batch, scree_trouble *trouble) {
    int capacity = batch->capacity ? 2 * batch->capacity : SCREE_LANES;
    size_t blocks = blocks_for(capacity);
    struct scree_contact *contact = realloc(batch->contact, (size_t)capacity * sizeof *contact);
    if (contact) batch->contact = contact;
    struct scree_contact *old_contact = realloc(batch->old_contact, (size_t)capacity * sizeof *old_contact);
    if (old_contact) batch->old_contact = old_contact;
    void *pair = realloc(batch->pair, blocks * sizeof *batch->pair);
    if (pair) batch->pair = pair;
    struct scree_yield *yield = realloc(batch->yield, blocks * sizeof *yield);
    if (yield) batch->yield = yield;
    int *first_run = realloc(batch->first_run, blocks * sizeof *first_run);
    if (first_run) batch->first_run = first_run;
    struct scree_run *run = realloc(batch->run, (size_t)capacity * sizeof *run);
    if (run) batch->run = run;
    int ok = contact && old_contact && pair && yield && first_run && run;
    if (batch->memory) {
        void *kept = realloc(batch->kept, blocks * sizeof *batch->kept);
        if (kept) batch->kept = kept;
        void *old_kept = realloc(batch->old_kept, blocks * sizeof *batch->old_kept);
        if (old_kept) batch->old_kept = old_kept;
        ok = ok && kept && old_kept;
    }
    if (batch->impulses) {
        void *past = realloc(batch->past, blocks * sizeof *batch->past);
        if (past) batch->past = past;
        void *old_past = realloc(batch->old_past, blocks * sizeof *batch->old_past);
        if (old_past) batch->old_past = old_past;
        void *moments = realloc(batch->moments, blocks * sizeof *batch->moments);
        if (moments) batch->moments = moments;
        ok = ok && past && old_past && moments;
    }
    if (!ok) return scree_report(trouble, SCREE_NO_MEMORY, NULL, "no memory for %d contacts", capacity);
    batch->capacity = capacity;
    return SCREE_OK;
}

static scree_status add(struct scree_batch *batch, const struct scree_contact *contact, scree_trouble *trouble) {
    if (batch->count == batch->capacity) {
        scree_status status = grow(batch, trouble);
        if (status) return status;
    }
    batch->contact[batch->count++] = *contact;
    batch->any_turns |= scree_contact_turns(batch, contact);
    return SCREE_OK;
}

scree_status scree_contacts_remember(struct scree_batch *batch, const struct scree_contact *contact, const double *kept,
                                     const double *past, scree_trouble *trouble) {
    int place = batch->count;
    scree_status status = add(batch, contact, trouble);
    for (int m = 0; !status && m < batch->memory; m++)
        batch->kept[place / SCREE_LANES][m][place % SCREE_LANES] = kept[m];
    for (int m = 0; !status && batch->impulses && m < SCREE_PAST; m++)
        batch->past[place / SCREE_LANES][m][place % SCREE_LANES] = past[m];
    return status;
}

/* The gap between a ball and its partner, as far as the list needs it: exact while it is small. */
static double gap(const struct scree_bodies *bodies, const struct scree_contact *contact, double skin) {
    const struct scree_record *a = &bodies->record[contact->ball], *b = &bodies->record[contact->host];
    struct vec centre = vec_add(vec_from(a->x), vec_from(bodies->corner[contact->corner])), origin = vec_from(b->x);
    int slot = bodies->slot[contact->host];
    const struct scree_attitude *partner = slot >= 0 ? &bodies->attitude[slot] : NULL;
    struct scree_whole whole = scree_whole_of(bodies, contact->ball, contact->corner);
    switch (bodies->shape[contact->host].kind) {
    case SCREE_PLANE:
        return -scree_meet_plane(centre, a->radius, origin, &partner->frame).overlap;
    case SCREE_RECTANGLE:
        return -scree_meet_rectangle(centre, a->radius, whole, origin, &partner->frame, partner->half,
                                     scree_thickness(a) + skin)
                    .overlap;
    case SCREE_BOX:
        return -scree_meet_box(centre, a->radius, whole, origin, &partner->frame, partner->half, b->radius).overlap;
    default:
        return -scree_meet_ball(centre, a->radius, origin, b->radius).overlap;
    }
}

static enum scree_geometry geometry_on(scree_shape_kind host) {
    switch (host) {
    case SCREE_PLANE:
        return SCREE_BALL_PLANE;
    case SCREE_RECTANGLE:
        return SCREE_BALL_RECTANGLE;
    case SCREE_BOX:
        return SCREE_BALL_BOX;
    default:
        return SCREE_BALL_BALL;
    }
}

/* Add the balls of body `ball` that are near body `host`: its corners, or itself. */
static scree_status add_balls(struct scree_contacts *contacts, const struct scree_bodies *bodies,
                              const struct scree_rule *rule, int ball, int host, scree_trouble *trouble) {
    struct scree_batch *batch = scree_batch_for(contacts, rule, geometry_on(bodies->shape[host].kind));
    int box = bodies->shape[ball].kind == SCREE_BOX;
    int first = box ? 1 + 8 * bodies->slot[ball] : 0;
    for (int corner = first; corner < first + (box ? 8 : 1); corner++) {
        struct scree_contact contact = {ball, host, corner};
        if (!(gap(bodies, &contact, contacts->skin) <= contacts->skin)) continue;
        scree_status status = add(batch, &contact, trouble);
        if (status) return status;
    }
    return SCREE_OK;
}

/* Edges of two boxes that may touch before the list is made anew. */
static scree_status add_edges(struct scree_contacts *contacts, const struct scree_bodies *bodies,
                              const struct scree_rule *rule, int ball, int host, scree_trouble *trouble) {
    struct scree_batch *batch = scree_batch_for(contacts, rule, SCREE_EDGE_EDGE);
    struct scree_two_boxes boxes = scree_two_boxes_of(bodies, ball, host);
    double clear = scree_cores_apart(&boxes), reach = boxes.rounding_a + boxes.rounding_b;
    /* Edges that are yet to pass through each other are at no distance when they do. */
    reach = (clear > 0.0 ? reach : fmax(reach, boxes.deepest)) + contacts->skin;
    if (clear > reach) return SCREE_OK;
    scree_status status = SCREE_OK;
    for (int a = 0; a < SCREE_EDGES && !status; a++)
        for (int b = 0; b < SCREE_EDGES && !status; b++) {
            struct scree_contact contact = {ball, host, scree_crossing_code(a, b)};
            if (scree_edges_apart(&boxes, a, b) <= reach) status = add(batch, &contact, trouble);
        }
    return status;
}

/* Two boxes that are deep in each other, whatever their contacts say of it: the run must not go on as if nothing had happened. */
static void note_depth(struct scree_contacts *contacts, const struct scree_bodies *bodies, int i, int j) {
    const struct scree_record *a = &bodies->record[i], *b = &bodies->record[j];
    struct vec apart = vec_sub(vec_from(a->x), vec_from(b->x));
    double depth = scree_boxes_depth(apart, &bodies->attitude[bodies->slot[i]], &bodies->attitude[bodies->slot[j]],
                                     a->radius + b->radius);
    double deep = depth / fmin(a->limit, b->limit);
    if (deep <= contacts->deepest) return;
    contacts->deepest = deep;
    contacts->deepest_ball = i;
    contacts->deepest_host = j;
}

static scree_status add_pair(struct scree_contacts *contacts, const struct scree_bodies *bodies, int i, int j,
                             scree_trouble *trouble) {
    const struct scree_rule *rule = scree_contacts_rule(contacts, bodies, i, j, NULL);
    scree_shape_kind a = bodies->shape[i].kind, b = bodies->shape[j].kind;
    if (a == SCREE_SPHERE) return add_balls(contacts, bodies, rule, i, j, trouble);
    if (b == SCREE_SPHERE || a != SCREE_BOX) return add_balls(contacts, bodies, rule, j, i, trouble);
    scree_status status = add_balls(contacts, bodies, rule, i, j, trouble);
    if (b != SCREE_BOX) return status;
    note_depth(contacts, bodies, i, j);
    if (!status) status = add_balls(contacts, bodies, rule, j, i, trouble);
    return status ? status : add_edges(contacts, bodies, rule, i, j, trouble);
}

static int compare(const struct scree_contact *a, const struct scree_contact *b) {
    if (a->ball != b->ball) return a->ball < b->ball ? -1 : 1;
    if (a->host != b->host) return a->host < b->host ? -1 : 1;
    return (a->corner > b->corner) - (a->corner < b->corner);
}

static int compare_contacts(const void *a, const void *b) { return compare(a, b); }

/* Candidates come sorted by their lower body, which isn't always the ball: put the batch in order. */
static void sort(struct scree_batch *batch) {
    for (int k = 1; k < batch->count; k++)
        if (compare(&batch->contact[k - 1], &batch->contact[k]) > 0) {
            qsort(batch->contact, (size_t)batch->count, sizeof *batch->contact, compare_contacts);
            return;
        }
}

/* Both lists are sorted, so one walk finds the contacts that go on. New ones start with empty memory. */
static void carry_memory_over(struct scree_batch *batch) {
    for (int k = 0, old = 0; k < (int)blocks_for(batch->count) * SCREE_LANES; k++) {
        int real = k < batch->count; /* the last block is filled up with zeros */
        while (real && old < batch->old_count && compare(&batch->old_contact[old], &batch->contact[k]) < 0) old++;
        int same = real && old < batch->old_count && compare(&batch->old_contact[old], &batch->contact[k]) == 0;
        for (int m = 0; m < batch->memory; m++)
            batch->kept[k / SCREE_LANES][m][k % SCREE_LANES] =
                same ? batch->old_kept[old / SCREE_LANES][m][old % SCREE_LANES] : 0.0;
        for (int m = 0; batch->impulses && m < SCREE_PAST; m++)
            batch->past[k / SCREE_LANES][m][k % SCREE_LANES] =
                same ? batch->old_past[old / SCREE_LANES][m][old % SCREE_LANES] : 0.0;
    }
}

/* Constants of the laws for a pair of bodies, in the order of the columns. */
struct columns {
    double c[SCREE_PAIR_COLUMNS];
};

static struct columns constants_of(const struct scree_contacts *contacts, const struct scree_bodies *bodies,
                                   const struct scree_batch *batch, const struct scree_contact *contact) {
    const struct scree_rule *rule = &contacts->rule[batch->rule];
    double mass = scree_effective_mass(bodies, contact->ball, contact->host) / rule->share;
    double radius = scree_effective_radius(bodies, contact->ball, contact->host, batch->geometry);
    const struct scree_friction_law *friction = rule->friction >= 0 ? scree_friction_laws[rule->friction] : NULL;
    struct scree_pair_constants normal = scree_normal_laws[rule->normal]->pair(&rule->normal_constants, mass, radius);
    struct scree_pair_constants tangential = {{0.0}};
    if (friction && friction->pair) tangential = friction->pair(&rule->friction_constants, mass, radius);
    struct columns columns;
    memcpy(columns.c, normal.c, sizeof normal.c);
    for (int c = SCREE_PAIR_FRICTION; c < SCREE_PAIR_LEVER; c++) columns.c[c] = tangential.c[c - SCREE_PAIR_FRICTION];
    columns.c[SCREE_PAIR_LEVER] = rule->rolling >= 0 ? radius : 0.0;
    return columns;
}

/* The laws' constants for each pair of bodies; one block of them where all pairs have the same. */
static void set_pair_constants(const struct scree_contacts *contacts, const struct scree_bodies *bodies,
                               struct scree_batch *batch) {
    struct columns first = {{0.0}}, pair = first;
    batch->uniform = 1;
    for (int k = 0; k < (int)blocks_for(batch->count) * SCREE_LANES; k++) {
        if (k < batch->count) pair = constants_of(contacts, bodies, batch, &batch->contact[k]);
        if (k == 0) first = pair;
        if (memcmp(&first, &pair, sizeof pair) != 0) batch->uniform = 0;
        for (int c = 0; c < SCREE_PAIR_COLUMNS; c++) batch->pair[k / SCREE_LANES][c][k % SCREE_LANES] = pair.c[c];
    }
}

/* The runs of a sorted batch of edges on edges. */
static void find_runs(const struct scree_contacts *contacts, const struct scree_bodies *bodies,
                      struct scree_batch *batch) {
    int holds_on = scree_normal_laws[contacts->rule[batch->rule].normal]->reach != NULL; /* beyond touch */
    const struct scree_contact *contact = batch->contact;
    batch->runs = 0;
    for (int k = 0; k < batch->count; k++) {
        int same = k > 0 && contact[k].ball == contact[k - 1].ball && contact[k].host == contact[k - 1].host;
        if (!same) {
            struct scree_two_boxes boxes = scree_two_boxes_of(bodies, contact[k].ball, contact[k].host);
            double clear = scree_cores_apart(&boxes) - boxes.rounding_a - boxes.rounding_b;
            batch->run[batch->runs++] = (struct scree_run){k, holds_on ? 0.0 : clear, scree_first_rectangles(&boxes)};
        }
        if (k % SCREE_LANES == 0) batch->first_run[k / SCREE_LANES] = batch->runs - 1;
    }
}

static void set_aside(struct scree_batch *batch) {
    struct scree_contact *contact = batch->contact;
    double(*kept)[SCREE_MEMORY][SCREE_LANES] = batch->kept;
    batch->contact = batch->old_contact;
    batch->old_contact = contact;
    batch->kept = batch->old_kept;
    batch->old_kept = kept;
    double(*past)[SCREE_PAST][SCREE_LANES] = batch->past;
    batch->past = batch->old_past;
    batch->old_past = past;
    batch->old_count = batch->count;
    batch->count = 0;
    batch->any_turns = 0;
}

/* Undo set_aside after a failure, so that the old list stays in force. */
static void take_back(struct scree_batch *batch) {
    int count = batch->old_count;
    set_aside(batch);
    batch->count = count;
    batch->any_turns = 1; /* as far as known; costs time only */
}

scree_status scree_contacts_list(struct scree_contacts *contacts, struct scree_bodies *bodies, scree_trouble *trouble) {
    scree_status status = scree_candidates(contacts, bodies, trouble);
    if (status) return status;
    for (int k = 0; k < contacts->batches; k++) set_aside(&contacts->batch[k]);
    for (int k = 0; k < contacts->pairs && !status; k++)
        status = add_pair(contacts, bodies, contacts->pair[k].i, contacts->pair[k].j, trouble);
    if (status) {
        for (int k = 0; k < contacts->batches; k++) take_back(&contacts->batch[k]);
        return status;
    }
    contacts->busy_batches = 0;
    for (int k = 0; k < contacts->batches; k++) {
        struct scree_batch *batch = &contacts->batch[k];
        if (batch->count) contacts->busy[contacts->busy_batches++] = k;
        sort(batch);
        if (batch->geometry == SCREE_EDGE_EDGE) find_runs(contacts, bodies, batch);
        if (batch->memory || batch->impulses) carry_memory_over(batch);
        set_pair_constants(contacts, bodies, batch);
    }
    for (int k = 0; k < bodies->count; k++) bodies->record[k].path = 0.0;
    contacts->rebuilds++;
    return SCREE_OK;
}
