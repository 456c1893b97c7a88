/* The list of near contacts: made from candidate pairs, sorted, with the contact memory of the list before. */
#include "contact/contacts.h"

#include "contact/geometry.h"

#include <stdlib.h>
#include <string.h>

static size_t blocks_for(int count) { return ((size_t)count + SCREE_LANES - 1) / SCREE_LANES; }

static int padded(int count) { return (count + SCREE_PADDING - 1) / SCREE_PADDING * SCREE_PADDING; }

/* More room in an array; 0 if there is no memory, and then it stays as it was. What is new is zero, since passes run over it. */
static int enlarge(void *array, int before, int after, size_t size) {
    void **place = array, *memory = realloc(*place, (size_t)after * size);
    if (!memory) return 0;
    memset((char *)memory + (size_t)before * size, 0, (size_t)(after - before) * size);
    *place = memory;
    return 1;
}

static scree_status grow(struct scree_batch *batch, scree_trouble *trouble) {
    int before = batch->capacity, after = before ? 2 * before : SCREE_LANES, ok = 1;
    ok &= enlarge(&batch->contact, before, after, sizeof *batch->contact);
    ok &= enlarge(&batch->old_contact, before, after, sizeof *batch->old_contact);
    ok &= enlarge(&batch->yield, (int)blocks_for(before), (int)blocks_for(after), sizeof *batch->yield);
    for (int m = 0; m < SCREE_MEMORY; m++) {
        if (!batch->keeps[m]) continue;
        ok &= enlarge(&batch->kept[m], before, after, sizeof(double));
        ok &= enlarge(&batch->old_kept[m], before, after, sizeof(double));
    }
    for (int m = 0; batch->impulses && m < SCREE_PAST; m++) {
        ok &= enlarge(&batch->past[m], before, after, sizeof(double));
        ok &= enlarge(&batch->old_past[m], before, after, sizeof(double));
    }
    if (batch->impulses)
        ok &= enlarge(&batch->moments, (int)blocks_for(before), (int)blocks_for(after), sizeof *batch->moments);
    if (!ok) return scree_report(trouble, SCREE_NO_MEMORY, NULL, "no memory for %d contacts", after);
    batch->capacity = after;
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
    for (int m = 0; !status && m < SCREE_MEMORY; m++)
        if (batch->keeps[m]) batch->kept[m][place] = kept[m];
    for (int m = 0; !status && batch->impulses && m < SCREE_PAST; m++) batch->past[m][place] = past[m];
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

/* Corners and faces are what two boxes meet with; where they are deep in each other all the same, edge against edge has gone
 * unseen, and the run must not go on as if nothing had happened. */
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
    return status ? status : add_balls(contacts, bodies, rule, j, i, trouble);
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

/* Both lists are sorted, so one walk finds the contacts that go on. New ones start with empty memory, and so does the padding. */
static void carry_memory_over(struct scree_batch *batch) {
    for (int k = 0, old = 0; k < padded(batch->count); k++) {
        int real = k < batch->count;
        while (real && old < batch->old_count && compare(&batch->old_contact[old], &batch->contact[k]) < 0) old++;
        int same = real && old < batch->old_count && compare(&batch->old_contact[old], &batch->contact[k]) == 0;
        for (int m = 0; m < SCREE_MEMORY; m++)
            if (batch->keeps[m]) batch->kept[m][k] = same ? batch->old_kept[m][old] : 0.0;
        for (int m = 0; batch->impulses && m < SCREE_PAST; m++)
            batch->past[m][k] = same ? batch->old_past[m][old] : 0.0;
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

/* What the constants of a pair depend on is the same for all contacts. */
static int is_uniform(const struct scree_bodies *bodies, const struct scree_batch *batch) {
    const struct scree_contact *first = batch->contact;
    for (int k = 1; k < batch->count; k++) {
        const struct scree_contact *one = &batch->contact[k];
        const struct scree_record *a = &bodies->record[first->ball], *b = &bodies->record[first->host];
        const struct scree_record *c = &bodies->record[one->ball], *d = &bodies->record[one->host];
        if (a->radius != c->radius || a->inverse_mass != c->inverse_mass || b->radius != d->radius ||
            b->inverse_mass != d->inverse_mass)
            return 0;
    }
    return 1;
}

/* The laws' constants for each pair of bodies; one block of them where all pairs have the same. */
static scree_status set_pair_constants(const struct scree_contacts *contacts, const struct scree_bodies *bodies,
                                       struct scree_batch *batch, scree_trouble *trouble) {
    batch->uniform = is_uniform(bodies, batch);
    int count = batch->uniform ? SCREE_LANES : padded(batch->count), before = batch->pair_capacity, ok = 1;
    if (batch->count == 0) return SCREE_OK;
    int after = count > before ? (batch->uniform ? count : batch->capacity) : before;
    for (int c = 0; c < SCREE_PAIR_COLUMNS && after > before; c++)
        ok &= enlarge(&batch->pair[c], before, after, sizeof(double));
    if (!ok) return scree_report(trouble, SCREE_NO_MEMORY, NULL, "no memory for the constants of %d contacts", after);
    batch->pair_capacity = after;
    struct columns pair = {{0.0}};
    for (int k = 0; k < count; k++) {
        if (k == 0 || (!batch->uniform && k < batch->count))
            pair = constants_of(contacts, bodies, batch, &batch->contact[k]);
        for (int c = 0; c < SCREE_PAIR_COLUMNS; c++) batch->pair[c][k] = pair.c[c];
    }
    return SCREE_OK;
}

static void swap(void *one, void *other) {
    void **a = one, **b = other, *c = *a;
    *a = *b;
    *b = c;
}

static void set_aside(struct scree_batch *batch) {
    swap(&batch->contact, &batch->old_contact);
    for (int m = 0; m < SCREE_MEMORY; m++) swap(&batch->kept[m], &batch->old_kept[m]);
    for (int m = 0; m < SCREE_PAST; m++) swap(&batch->past[m], &batch->old_past[m]);
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
    for (int k = 0; k < contacts->batches && !status; k++) {
        struct scree_batch *batch = &contacts->batch[k];
        if (batch->count) contacts->busy[contacts->busy_batches++] = k;
        sort(batch);
        if (batch->memory || batch->impulses) carry_memory_over(batch);
        status = set_pair_constants(contacts, bodies, batch, trouble);
    }
    if (status) return status;
    for (int k = 0; k < bodies->count; k++) bodies->record[k].path = 0.0;
    contacts->rebuilds++;
    return SCREE_OK;
}
