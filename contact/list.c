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
    int ok = contact && old_contact && pair && yield;
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

/* Add a ball on one image of another: `periods` off; on the other itself if they are none. */
static scree_status add_image(struct scree_contacts *contacts, const struct scree_bodies *bodies,
                              const struct scree_rule *rule, int ball, int host, const int periods[3],
                              scree_trouble *trouble) {
    const struct scree_record *a = &bodies->record[ball], *b = &bodies->record[host];
    int off = periods[0] != 0 || periods[1] != 0 || periods[2] != 0;
    struct scree_contact contact = {ball, host, off ? scree_code_of(periods) : 0};
    enum scree_geometry geometry = off ? SCREE_BALL_IMAGE : SCREE_BALL_BALL;
    double gap = vec_norm(scree_apart(bodies, &contact, geometry)) - a->radius - b->radius;
    if (!(gap <= contacts->skin)) return SCREE_OK;
    for (int axis = 0; axis < 3; axis++)
        if (abs(periods[axis]) > SCREE_MOST_PERIODS)
            return scree_report(trouble, SCREE_FAILED, NULL,
                                "two bodies that meet are more than %d periods apart: a driven one has gone that far",
                                SCREE_MOST_PERIODS);
    return add(scree_batch_for(contacts, rule, geometry), &contact, trouble);
}

/* Add a ball on the nearest image of another, and where the box is so small that several are in reach on those too. */
static scree_status add_images(struct scree_contacts *contacts, const struct scree_bodies *bodies,
                               const struct scree_rule *rule, int ball, int host, scree_trouble *trouble) {
    const struct scree_record *a = &bodies->record[ball], *b = &bodies->record[host];
    double reach = a->radius + b->radius + contacts->skin;
    int first[3], last[3], periods[3];
    for (int axis = 0; axis < 3; axis++) {
        double period = bodies->period[axis], off = period > 0.0 ? (a->x[axis] - b->x[axis]) / period : 0.0;
        int nearest = (int)fmax(fmin(floor(off + 0.5), 1e9), -1e9), more = period > 0.0 && period < 2.0 * reach;
        first[axis] = nearest - more;
        last[axis] = nearest + more;
    }
    scree_status status = SCREE_OK;
    for (periods[0] = first[0]; periods[0] <= last[0]; periods[0]++)
        for (periods[1] = first[1]; periods[1] <= last[1]; periods[1]++)
            for (periods[2] = first[2]; periods[2] <= last[2] && !status; periods[2]++)
                status = add_image(contacts, bodies, rule, ball, host, periods, trouble);
    return status;
}

static scree_status add_pair(struct scree_contacts *contacts, const struct scree_bodies *bodies, int i, int j,
                             scree_trouble *trouble) {
    const struct scree_rule *rule = scree_contacts_rule(contacts, bodies, i, j, NULL);
    scree_shape_kind a = bodies->shape[i].kind, b = bodies->shape[j].kind;
    if (bodies->periodic && a == SCREE_SPHERE && b == SCREE_SPHERE)
        return add_images(contacts, bodies, rule, i, j, trouble);
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

/* Where a contact was in the old lists: its bodies may have returned into the box since, which changes how many periods they are
 * apart, and by it the batch. */
struct before {
    const struct scree_batch *batch;
    int place; /* -1: it wasn't there */
};

/* Look for a contact of which a body has returned. */
static void find_before(const struct scree_contacts *contacts, const struct scree_batch *batch,
                        const struct scree_contact *contact, struct before *before) {
    const struct scree_return *ball = return_of(contacts, contact->ball), *host = return_of(contacts, contact->host);
    if (!ball && !host) return;
    int periods[3], off = 0;
    for (int axis = 0; axis < 3; axis++) {
        periods[axis] = contact->corner ? scree_periods_of(contact->corner, axis) : 0;
        periods[axis] += (ball ? ball->periods[axis] : 0) - (host ? host->periods[axis] : 0);
        off |= periods[axis] != 0;
    }
    struct scree_contact old = {contact->ball, contact->host, off ? scree_code_of(periods) : 0};
    before->batch = scree_batch_for(contacts, &contacts->rule[batch->rule], off ? SCREE_BALL_IMAGE : SCREE_BALL_BALL);
    const struct scree_contact *found = NULL;
    if (before->batch->old_count)
        found =
            bsearch(&old, before->batch->old_contact, (size_t)before->batch->old_count, sizeof old, compare_contacts);
    before->place = found ? (int)(found - before->batch->old_contact) : -1;
}

/* Both lists are sorted, so one walk finds the contacts that go on. New ones start with empty memory. */
static void carry_memory_over(const struct scree_contacts *contacts, struct scree_batch *batch) {
    int returns = contacts->returns && (batch->geometry == SCREE_BALL_BALL || batch->geometry == SCREE_BALL_IMAGE);
    for (int k = 0, old = 0; k < (int)blocks_for(batch->count) * SCREE_LANES; k++) {
        int real = k < batch->count; /* the last block is filled up with zeros */
        while (real && old < batch->old_count && compare(&batch->old_contact[old], &batch->contact[k]) < 0) old++;
        int same = real && old < batch->old_count && compare(&batch->old_contact[old], &batch->contact[k]) == 0;
        struct before before = {batch, same ? old : -1};
        if (returns && real) find_before(contacts, batch, &batch->contact[k], &before);
        int block = before.place / SCREE_LANES, lane = before.place % SCREE_LANES;
        for (int m = 0; m < batch->memory; m++)
            batch->kept[k / SCREE_LANES][m][k % SCREE_LANES] =
                before.place >= 0 ? before.batch->old_kept[block][m][lane] : 0.0;
        for (int m = 0; batch->impulses && m < SCREE_PAST; m++)
            batch->past[k / SCREE_LANES][m][k % SCREE_LANES] =
                before.place >= 0 ? before.batch->old_past[block][m][lane] : 0.0;
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
        if (batch->memory || batch->impulses) carry_memory_over(contacts, batch);
        set_pair_constants(contacts, bodies, batch);
    }
    for (int k = 0; k < bodies->count; k++) bodies->record[k].path = 0.0;
    contacts->rebuilds++;
    contacts->returns = 0;
    return SCREE_OK;
}

/* ---- the periodic box ---- */

/* Periods that body k must go back along an axis to be in the box. */
static int periods_out(const struct scree_bodies *bodies, int k, int axis) {
    if (bodies->class[k] == SCREE_CLASS_FIXED || bodies->joint[k].along[axis] != SCREE_FREE) return 0;
    double off = scree_periods_off(bodies, bodies->state[k].x[axis], axis);
    return fabs(off) <= SCREE_MOST_PERIODS ? (int)off : 0; /* farther in one go: the run is about to be stopped */
}

static scree_status room_for_returns(struct scree_contacts *contacts, int count, scree_trouble *trouble) {
    if (count <= contacts->return_capacity) return SCREE_OK;
    struct scree_return *returned = realloc(contacts->returned, 2 * (size_t)count * sizeof *returned);
    if (!returned) return scree_report(trouble, SCREE_NO_MEMORY, NULL, "no memory for %d bodies at the border", count);
    contacts->returned = returned;
    contacts->return_capacity = 2 * count;
    return SCREE_OK;
}

scree_status scree_contacts_return(struct scree_contacts *contacts, struct scree_bodies *bodies,
                                   scree_trouble *trouble) {
    contacts->returns = 0;
    for (int k = 0; k < bodies->count; k++) {
        struct scree_return out = {.body = k};
        int any = 0;
        for (int axis = 0; axis < 3; axis++) any |= out.periods[axis] = periods_out(bodies, k, axis);
        if (!any) continue;
        memcpy(out.from, bodies->state[k].x, sizeof out.from);
        memcpy(out.ahead, bodies->record[k].x, sizeof out.ahead);
        scree_status status = room_for_returns(contacts, contacts->returns + 1, trouble);
        if (status) contacts->returns = 0;
        if (status) return status;
        contacts->returned[contacts->returns++] = out;
    }
    for (int n = 0; n < contacts->returns; n++) {
        const struct scree_return *out = &contacts->returned[n];
        for (int axis = 0; axis < 3; axis++) {
            double way = out->periods[axis] * bodies->period[axis];
            bodies->state[out->body].x[axis] -= way;
            bodies->record[out->body].x[axis] -= way; /* of bodies that keep it from step to step */
        }
    }
    return SCREE_OK;
}

void scree_contacts_undo_return(struct scree_contacts *contacts, struct scree_bodies *bodies) {
    for (int n = 0; n < contacts->returns; n++) {
        const struct scree_return *out = &contacts->returned[n];
        memcpy(bodies->state[out->body].x, out->from, sizeof out->from);
        memcpy(bodies->record[out->body].x, out->ahead, sizeof out->ahead);
    }
    contacts->returns = 0;
}
