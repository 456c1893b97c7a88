/* The outer list: contacts that may get near before bodies have gone half a skin, made from candidate pairs. */
#include "contact/contacts.h"

#include "contact/meet.h"

#include <limits.h>
#include <stdlib.h>
#include <string.h>

/* A body's speed off its flight, m/s: at once, or soon. */
static double speed_of(const struct scree_contacts *contacts, const struct scree_bodies *bodies, int k) {
    double off = vec_norm(vec_sub(vec_from(bodies->record[k].v), scree_flight_of(bodies, k)));
    return bodies->class[k] == SCREE_CLASS_BALL ? fmax(off, contacts->flights.wander) : off;
}

/* Of a body in a step off its flight, m; on the mean of some thousands of them. */
static double mean_way(const struct scree_contacts *contacts, const struct scree_bodies *bodies) {
    int first = bodies->order.members, stride = 1 + (bodies->count - first) / 4096, some = 0;
    double way = 0.0;
    for (int k = first; k < bodies->count; k += stride, some++) way += speed_of(contacts, bodies, k);
    return way * contacts->step / some;
}

/* Steps that a body's margin is to last at its speed. The wider it is, the more contacts it lets into the near list,
 * each of which costs every step, and the fewer lists are made: so the sum is least at some sqrt(skin/w) steps, where w
 * is the mean way of a body in one step. How many, has been measured on a dense flow (bench/peers/chute.toml). */
static double steps_ahead(const struct scree_contacts *contacts, const struct scree_bodies *bodies) {
    double way = mean_way(contacts, bodies);
    return fmax(fmin(sqrt(0.4 * contacts->skin / way), 400.0), 20.0);
}

/* The corner of a box may touch another one sooner than its gap tells since they are deeper in each other than their
 * roundings: deep by D, it does so up to 2.3 D beside it (cores drawn in by 0.6 D, corners by sqrt(3) times that,
 * roundings as large). */
double scree_gap(const struct scree_bodies *bodies, const struct scree_contact *contact, double way, double overlap) {
    const struct scree_record *a = &bodies->record[contact->ball], *b = &bodies->record[contact->host];
    struct vec centre = vec_add(vec_from(a->x), vec_from(bodies->corner[contact->corner])), origin = vec_from(b->x);
    int slot = scree_kind_of(bodies, contact->host)->slot;
    const struct scree_attitude *partner = slot >= 0 ? &bodies->attitude[slot] : NULL;
    struct scree_whole whole = scree_whole_of(bodies, contact->ball, contact->corner, centre);
    switch (scree_kind_of(bodies, contact->host)->shape.kind) {
    case SCREE_PLANE:
        return -scree_meet_plane(centre, a->radius, origin, &partner->frame).overlap;
    case SCREE_RECTANGLE:
        return -scree_meet_rectangle(centre, a->radius, whole, origin, &partner->frame, partner->half,
                                     scree_thickness(bodies, contact->ball, contact->corner, a->radius) + way)
                    .overlap;
    case SCREE_BOX: {
        double gap =
            -scree_meet_box(centre, a->radius, whole, origin, &partner->frame, partner->half, b->radius).overlap;
        return whole.box && gap > way ? fmin(gap, fmax(-overlap, (gap - 2.3 * overlap) / 3.3)) : gap;
    }
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

/* Frozen partners that aren't balls don't mind how many slabs push them; whatever else isn't a member makes the contact
 * one of segment 0. */
int scree_segment_of(const struct scree_bodies *bodies, const struct scree_batch *batch,
                     const struct scree_contact *contact) {
    int a = bodies->slab[contact->ball], b = bodies->slab[contact->host];
    if (a < 0 || batch->geometry == SCREE_BALL_IMAGE) return 0;
    if (b < 0) {
        int frozen = batch->geometry != SCREE_BALL_BALL && bodies->class[contact->host] == SCREE_CLASS_FIXED;
        return frozen ? 1 + a : 0;
    }
    int low = a < b ? a : b;
    return (a < b ? b - a : a - b) > 1 ? 0 : 1 + low;
}

static int compare_loose(const void *a, const void *b) { return scree_compare_contacts(a, b, 0); }

/* Candidates come sorted by their lower body, which isn't always the ball: put segment 0 in order. */
static void sort(struct scree_batch *batch) {
    struct scree_contact *contact = batch->loose;
    int count = batch->segment[0].outer_count;
    for (int k = 1; k < count; k++)
        if (scree_compare_contacts(&contact[k - 1], &contact[k], 0) > 0) {
            qsort(contact, (size_t)count, sizeof *contact, compare_loose);
            return;
        }
}

/* What is done with contacts that the candidates yield: they are counted, or put in their places; and which are taken:
 * those of slabs, those of segment 0. */
enum { FILL = 1, OF_SLABS = 2, LOOSE = 4 };

static void put_code(struct scree_batch *batch, struct scree_part *segment, int code, int pass) {
    if (pass & FILL) batch->code[segment->codes_first + segment->codes] = code;
    segment->codes++;
}

void scree_widen_reach(struct scree_part *segment, int first, int partner, int next) {
    struct scree_span *span = &segment->reach[partner >= next];
    int way = partner - first;
    if (way < span->least) span->least = way;
    if (way > span->most) span->most = way;
}

/* Bodies come in their order, and so do their partners. `next`: where the next slab begins. */
static void encode(struct scree_batch *batch, struct scree_part *segment, const struct scree_contact *contact, int next,
                   int pass) {
    int swap = contact->host < contact->ball, first = swap ? contact->host : contact->ball;
    int partner = swap ? contact->ball : contact->host;
    if (segment->last != first) put_code(batch, segment, ~first, pass);
    segment->last = first;
    put_code(batch, segment, 2 * partner + swap, pass);
    scree_widen_reach(segment, first, partner, next);
}

static void take(struct scree_contacts *contacts, const struct scree_bodies *bodies, struct scree_batch *batch,
                 const struct scree_contact *contact, int pass) {
    int s = scree_segment_of(bodies, batch, contact);
    struct scree_part *segment = &batch->segment[s];
    if (s == 0 && !(pass & LOOSE))
        contacts->has_loose[contact->ball < contact->host ? contact->ball : contact->host] = 1;
    if (!(pass & (s > 0 ? OF_SLABS : LOOSE))) return;
    if (pass & FILL && s == 0) batch->loose[segment->outer_count] = *contact;
    if (s > 0) encode(batch, segment, contact, bodies->order.start[s], pass);
    if (!batch->any_turns && scree_contact_turns(batch, contact)) batch->any_turns = 1;
    if (contact->corner != 0) batch->corners = 1; /* of segment 0: in the pass that is nobody else's */
    segment->outer_count++;
}

/* The balls of body `ball` that are near body `host`: its corners, or itself; `overlap` of the cores of two boxes.
 * Returns how many. */
static int take_balls(struct scree_contacts *contacts, const struct scree_bodies *bodies, const struct scree_rule *rule,
                      int ball, int host, double overlap, int pass) {
    struct scree_batch *batch = scree_batch_for(contacts, rule, geometry_on(scree_kind_of(bodies, host)->shape.kind));
    int box = scree_kind_of(bodies, ball)->shape.kind == SCREE_BOX;
    int first = box ? 1 + 8 * scree_kind_of(bodies, ball)->slot : 0;
    if (batch->geometry == SCREE_BALL_BALL && !box) { /* their balls are their bounds */
        take(contacts, bodies, batch, &(struct scree_contact){ball, host, 0}, pass);
        return 1;
    }
    double left = scree_left_of(contacts, bodies, ball, host) + vec_norm(scree_flown(contacts, bodies, ball, host));
    int taken = 0;
    for (int corner = first; corner < first + (box ? 8 : 1); corner++) {
        struct scree_contact contact = {ball, host, corner};
        if (!(scree_gap(bodies, &contact, left, overlap) <= left)) continue;
        take(contacts, bodies, batch, &contact, pass);
        taken++;
    }
    return taken;
}

/* Two boxes that are deep in each other. */
static void note_depth(struct scree_contacts *contacts, const struct scree_bodies *bodies, int i, int j) {
    const struct scree_record *a = &bodies->record[i], *b = &bodies->record[j];
    struct vec apart = vec_sub(vec_from(a->x), vec_from(b->x));
    double depth =
        scree_boxes_depth(apart, scree_attitude_of(bodies, i), scree_attitude_of(bodies, j), a->radius + b->radius);
    double deep = depth / fmin(bodies->spin[i].limit, bodies->spin[j].limit);
    if (deep <= contacts->deepest) return;
    contacts->deepest = deep;
    contacts->deepest_ball = bodies->number[i];
    contacts->deepest_host = bodies->number[j];
}

/* Of a contact of two boxes, in one order, whichever of them the list names first. */
static void note_pair(struct scree_contacts *contacts, const struct scree_bodies *bodies, int i, int j) {
    if (scree_kind_of(bodies, i)->shape.kind != SCREE_BOX || scree_kind_of(bodies, j)->shape.kind != SCREE_BOX) return;
    int swap = bodies->number[i] > bodies->number[j];
    note_depth(contacts, bodies, swap ? j : i, swap ? i : j);
}

void scree_contacts_note_boxes(struct scree_contacts *contacts, const struct scree_bodies *bodies) {
    for (int b = 0; b < contacts->batches; b++) {
        const struct scree_batch *batch = &contacts->batch[b];
        struct scree_ends last = {-1, -1};
        if (batch->geometry != SCREE_BALL_BOX && batch->geometry != SCREE_EDGE_EDGE) continue;
        for (int k = scree_first(batch); k >= 0; k = scree_next(batch, k)) {
            struct scree_ends ends = batch->ends[k];
            if (ends.ball != last.ball || ends.host != last.host) note_pair(contacts, bodies, ends.ball, ends.host);
            last = ends;
        }
    }
}

/* Corners and edges of two boxes that may touch before the list is made anew. */
static void take_boxes(struct scree_contacts *contacts, const struct scree_bodies *bodies,
                       const struct scree_rule *rule, int i, int j, int pass) {
    struct scree_batch *batch = scree_batch_for(contacts, rule, SCREE_EDGE_EDGE);
    int swap = bodies->number[i] > bodies->number[j], ball = swap ? j : i, host = swap ? i : j;
    struct scree_two_boxes boxes = scree_two_boxes_of(bodies, ball, host);
    double overlap = scree_cores_overlap(&boxes), roundings = boxes.rounding_a + boxes.rounding_b;
    double left = scree_left_of(contacts, bodies, ball, host);
    if (-overlap > roundings + left) return;
    int taken = take_balls(contacts, bodies, rule, i, j, overlap, pass);
    taken += take_balls(contacts, bodies, rule, j, i, overlap, pass);
    if (rule->corners) {
        /* They cross, and nothing will tell. */
        if (!taken && !(pass & FILL) && overlap + roundings > 0.0) note_depth(contacts, bodies, i, j);
        return;
    }
    int code[SCREE_EDGES * SCREE_EDGES], count = scree_near_edges(&boxes, overlap, left, code);
    for (int k = 0; k < count; k++) {
        struct scree_contact contact = {ball, host, code[k]};
        take(contacts, bodies, batch, &contact, pass);
    }
}

/* A ball on one image of another: `periods` off; on the other itself if they are none. */
static void take_image(struct scree_contacts *contacts, const struct scree_bodies *bodies,
                       const struct scree_rule *rule, int ball, int host, const int periods[3], int pass) {
    int off = periods[0] != 0 || periods[1] != 0 || periods[2] != 0;
    struct scree_contact contact = {ball, host, off ? scree_code_of(periods) : 0};
    enum scree_geometry geometry = off ? SCREE_BALL_IMAGE : SCREE_BALL_BALL;
    struct vec apart = scree_apart(bodies, &contact, geometry), flown = scree_flown(contacts, bodies, ball, host);
    double gap = sqrt(scree_nearest2(apart, flown)) - bodies->record[ball].radius - bodies->record[host].radius;
    if (gap <= scree_left_of(contacts, bodies, ball, host))
        take(contacts, bodies, scree_batch_for(contacts, rule, geometry), &contact, pass);
}

/* A ball on the nearest image of another, and where the box is so small that several are in reach on those too. */
static void take_images(struct scree_contacts *contacts, const struct scree_bodies *bodies,
                        const struct scree_rule *rule, int ball, int host, int pass) {
    const struct scree_record *a = &bodies->record[ball], *b = &bodies->record[host];
    double reach = a->radius + b->radius + scree_left_of(contacts, bodies, ball, host) + 2.0 * contacts->flights.sweep;
    int first[3], last[3], periods[3];
    for (int axis = 0; axis < 3; axis++) {
        double period = bodies->period[axis], most = SCREE_MOST_PERIODS - 1;
        int nearest = (int)fmax(fmin(scree_periods_in(bodies, a->x[axis] - b->x[axis], axis), most), -most);
        int more = period > 0.0 && period < 2.0 * reach;
        first[axis] = nearest - more;
        last[axis] = nearest + more;
    }
    for (periods[0] = first[0]; periods[0] <= last[0]; periods[0]++)
        for (periods[1] = first[1]; periods[1] <= last[1]; periods[1]++)
            for (periods[2] = first[2]; periods[2] <= last[2]; periods[2]++)
                take_image(contacts, bodies, rule, ball, host, periods, pass);
}

static void take_pair(struct scree_contacts *contacts, const struct scree_bodies *bodies, int i, int j, int pass) {
    const struct scree_rule *rule = scree_contacts_rule(contacts, bodies, i, j, NULL);
    scree_shape_kind a = scree_kind_of(bodies, i)->shape.kind, b = scree_kind_of(bodies, j)->shape.kind;
    if (bodies->periodic && a == SCREE_SPHERE && b == SCREE_SPHERE) {
        int swap = bodies->number[i] > bodies->number[j];
        take_images(contacts, bodies, rule, swap ? j : i, swap ? i : j, pass);
    } else if (a == SCREE_SPHERE && b == SCREE_SPHERE && bodies->number[i] > bodies->number[j])
        take_balls(contacts, bodies, rule, j, i, 0.0, pass); /* who is the ball mustn't depend on the order */
    else if (a == SCREE_BOX && b == SCREE_BOX)
        take_boxes(contacts, bodies, rule, i, j, pass);
    else {
        int second = a != SCREE_SPHERE && (b == SCREE_SPHERE || a != SCREE_BOX);
        take_balls(contacts, bodies, rule, second ? j : i, second ? i : j, 0.0, pass);
    }
}

/* Pairs whose first body is at a place from … to - 1. */
static void take_some(struct scree_contacts *contacts, const struct scree_bodies *bodies, int from, int to, int pass) {
    for (int i = from, p = from > 0 ? contacts->end[from - 1] : 0; i < to; i++)
        for (; p < contacts->end[i]; p++) take_pair(contacts, bodies, i, contacts->partner[p], pass);
}

/* Two members make a contact of the first one's slab, and slabs can be filled at once; or of segment 0, if they are
 * images or, fast as they are, may meet from slabs that aren't neighbours: those come one after the other, and bodies
 * that have some are marked meanwhile in `has_loose`. */
static void take_all(struct scree_contacts *contacts, const struct scree_bodies *bodies, int threads, int pass) {
    const struct scree_order *order = &bodies->order;
    int members = order->slabs ? order->members : bodies->count, shared = threads > 1;
    memset(contacts->has_loose, 0, (size_t)bodies->count);
    for (int b = 0; b < contacts->batches; b++) {
        contacts->batch[b].any_turns = contacts->batch[b].turns;
        for (int s = 0; s <= order->slabs; s++) {
            struct scree_part *segment = &contacts->batch[b].segment[s];
            segment->outer_count = segment->codes = 0;
            segment->last = -1;
            segment->reach[0] = segment->reach[1] = (struct scree_span){INT_MAX, -1};
        }
    }
    take_some(contacts, bodies, 0, members, pass | OF_SLABS | LOOSE);
#pragma omp parallel for schedule(dynamic) num_threads(threads) if (shared)
    for (int slab = 0; slab < order->slabs; slab++)
        take_some(contacts, bodies, order->start[slab], order->start[slab + 1],
                  shared ? pass | OF_SLABS : pass | OF_SLABS | LOOSE);
    for (int k = members; k < bodies->count; k++)
        if (contacts->has_loose[k]) take_some(contacts, bodies, k, k + 1, pass | LOOSE);
}

/* Batches that hold contacts; those of two balls last. */
static void find_busy(struct scree_contacts *contacts) {
    contacts->busy_batches = 0;
    for (int balls = 0; balls < 2; balls++)
        for (int k = 0; k < contacts->batches; k++)
            if (contacts->batch[k].outer_count && (contacts->batch[k].geometry == SCREE_BALL_BALL) == balls)
                contacts->busy[contacts->busy_batches++] = k;
}

/* Room for what was counted; what candidates were found in is free again. */
static scree_status make_room(struct scree_contacts *contacts, const struct scree_bodies *bodies,
                              scree_trouble *trouble) {
    size_t loose = 0, codes = 0;
    for (int k = 0; k < contacts->batches; k++) {
        struct scree_batch *batch = &contacts->batch[k];
        int own = 0;
        batch->outer_count = batch->segment[0].outer_count;
        for (int s = 1; s <= bodies->order.slabs; s++) {
            batch->segment[s].codes_first = own;
            own += batch->segment[s].codes;
            batch->outer_count += batch->segment[s].outer_count;
        }
        codes += (size_t)own;
        loose += (size_t)batch->segment[0].outer_count;
    }
    find_busy(contacts);
    scree_status status =
        scree_make_space(&contacts->listed, loose * sizeof(struct scree_contact) + codes * sizeof(int), trouble);
    struct scree_contact *contact = contacts->listed.memory;
    int *code = (int *)(contact + loose);
    for (int k = 0; k < contacts->batches && !status; k++) {
        struct scree_batch *batch = &contacts->batch[k];
        batch->loose = contact;
        batch->code = code;
        contact += batch->segment[0].outer_count;
        for (int s = 1; s <= bodies->order.slabs; s++) code += batch->segment[s].codes;
    }
    return status;
}

/* More than so many bodies have narrow margins. */
enum { FEW_BODIES = 64 };
static int are_many(const struct scree_contacts *contacts, const struct scree_bodies *bodies) {
    return contacts->step > 0.0 && (bodies->order.slabs > 0 || bodies->count > FEW_BODIES);
}

static int is_box(const struct scree_bodies *bodies, int k) {
    return scree_kind_of(bodies, k)->shape.kind == SCREE_BOX;
}

/* Keep the pairs of boxes for later margins, where bodies are few. */
static scree_status note_boxes(struct scree_contacts *contacts, const struct scree_bodies *bodies,
                               scree_trouble *trouble) {
    contacts->box_pairs = 0;
    if (are_many(contacts, bodies)) return SCREE_OK;
    scree_status status =
        scree_make_space(&contacts->boxes, 2 * (size_t)contacts->pairs * sizeof(int) + sizeof(int), trouble);
    if (status) return status;
    int *pair = contacts->boxes.memory;
    for (int i = 0, p = 0; i < bodies->count; i++)
        for (; p < contacts->end[i]; p++) {
            if (!is_box(bodies, i) || !is_box(bodies, contacts->partner[p])) continue;
            pair[2 * contacts->box_pairs] = i;
            pair[2 * contacts->box_pairs++ + 1] = contacts->partner[p];
        }
    return SCREE_OK;
}

/* Where bodies are few, each gets half the skin; but a box only up to where its core could meet another's, for until
 * then corners and edges that can't touch sooner stay off the near list. Not where that is little: lists would be made
 * too often. */
static void limit_margins(struct scree_contacts *contacts, const struct scree_bodies *bodies) {
    double half = 0.5 * contacts->skin;
    for (int k = 0; k < bodies->count; k++) contacts->widest[k] = half;
    for (int k = 0; contacts->step > 0.0 && k < contacts->box_pairs; k++) {
        const int *pair = (const int *)contacts->boxes.memory + 2 * k;
        int i = pair[0], j = pair[1];
        struct scree_two_boxes boxes = scree_two_boxes_of(bodies, i, j);
        int alone = bodies->class[i] == SCREE_CLASS_FIXED || bodies->class[j] == SCREE_CLASS_FIXED;
        double share = (alone ? 1.0 : 0.5) * scree_cores_apart(&boxes);
        if (share < half / 64.0) continue;
        contacts->widest[i] = fmin(contacts->widest[i], share);
        contacts->widest[j] = fmin(contacts->widest[j], share);
    }
}

/* The most that a point of a body goes in a step, m. */
static double way_of(const struct scree_contacts *contacts, const struct scree_bodies *bodies, int k) {
    const struct scree_record *record = &bodies->record[k];
    double lever = scree_kind_of(bodies, k)->slot < 0 ? 0.0 : record->bound;
    return contacts->step * (speed_of(contacts, bodies, k) + vec_norm(scree_spin_of(bodies, k)) * lever);
}

/* Before an outer list: all that its bodies may go until the next one is half the skin, path 0. Where bodies are many,
 * a few that are much faster than the others would use that up long before these, and an outer list
 * costs as much as some ten steps: they may go farther, and their paths begin below 0. No result depends on it. */
static void widen_margins(struct scree_contacts *contacts, const struct scree_bodies *bodies) {
    double half = 0.5 * contacts->skin, steps = 0.0;
    int many = are_many(contacts, bodies);
    if (many) steps = fmin(half / (4.0 * mean_way(contacts, bodies) + SCREE_NO_SPEED), 2000.0);
    contacts->widest_margin = half;
    for (int k = 0; k < bodies->count; k++) {
        bodies->path[k] = 0.0;
        if (!many || scree_kind_of(bodies, k)->shape.kind == SCREE_PLANE) continue;
        double margin = fmin(1.5 * steps * way_of(contacts, bodies, k), contacts->most_margin);
        if (!(margin > 2.0 * half)) continue; /* one costs as much as a dozen others: only where it must be */
        bodies->path[k] = half - margin;
        contacts->widest_margin = fmax(contacts->widest_margin, margin);
    }
}

static inline double lesser(double a, double b) { return b < a ? b : a; }
static inline double larger(double a, double b) { return b > a ? b : a; }

/* A float that isn't larger. */
static float at_most(double way) {
    float near = (float)way;
    return (double)near > way ? nextafterf(near, -HUGE_VALF) : near;
}

/* Give a body a margin out of what the outer list has left it: where bodies are many, so wide that it lasts for as many
 * steps as it is to. 0 if too little is left. */
static int grant(struct scree_contacts *contacts, const struct scree_bodies *bodies, int k) {
    double half = 0.5 * contacts->skin, spare = (double)contacts->spare[k];
    double least = half / 80.0, most = larger(half, spare) / 2.0, way = way_of(contacts, bodies, k);
    double margin = lesser(larger(contacts->lasting * way, least), most);
    if (!are_many(contacts, bodies)) margin = contacts->widest[k] > 16.0 * way ? contacts->widest[k] : half;
    margin = lesser(larger(margin, 4.0 * way), spare);
    if (!(margin >= least && margin >= 2.0 * way)) return 0;
    contacts->spare[k] = at_most(spare - margin);
    bodies->path[k] = half - margin;
    return 1;
}

/* Before all bodies get new margins: how long these are to last. Where bodies fly, near lists look ahead over as many
 * steps. A list costs as much as some hundred answers to single bodies (widen.c); by the time so many have asked,
 * the others' margins have served. */
enum { ANSWERS_PER_SLAB = 10 };
static void begin_margins(struct scree_contacts *contacts, const struct scree_bodies *bodies) {
    struct scree_flights *flights = &contacts->flights;
    contacts->enough = contacts->answers + ANSWERS_PER_SLAB * bodies->order.slabs;
    contacts->lasting = 0.0;
    if (are_many(contacts, bodies))
        contacts->lasting = steps_ahead(contacts, bodies);
    else
        limit_margins(contacts, bodies);
    if (!bodies->flight) return;
    flights->until = fmin(flights->flown + contacts->lasting * contacts->step, flights->last);
    flights->ahead = flights->until - flights->flown;
}

/* Margins after an outer list. */
static void grant_all(struct scree_contacts *contacts, const struct scree_bodies *bodies, int threads) {
    (void)threads; /* without OpenMP */
    double half = 0.5 * contacts->skin;
    begin_margins(contacts, bodies);
#pragma omp parallel for schedule(static) num_threads(threads) if (threads > 1)
    for (int k = 0; k < bodies->count; k++) {
        int fixed = bodies->class[k] == SCREE_CLASS_FIXED;
        contacts->spare[k] = at_most(half - bodies->path[k]);
        if (fixed) bodies->path[k] = half;
        if (fixed || grant(contacts, bodies, k)) continue;
        contacts->spare[k] = 0.0F; /* so fast that it takes all at once */
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

static struct scree_contact first_outer(const struct scree_batch *batch) {
    int s = 0;
    while (batch->segment[s].outer_count == 0) s++;
    struct scree_outer outer = scree_outer_of(batch, s);
    return scree_next_outer(&outer);
}

/* Whether the constants of a pair would be the same with other bodies. */
static int are_alike(const struct scree_record *a, const struct scree_record *b) {
    return a->radius == b->radius && a->inverse_mass == b->inverse_mass;
}

/* All contacts are of members, and these are alike. */
static int is_of_alike_members(const struct scree_bodies *bodies, const struct scree_batch *batch) {
    const struct scree_record *first = &bodies->record[bodies->order.members];
    int unlike = batch->geometry != SCREE_BALL_BALL || batch->segment[0].outer_count > 0;
    for (int k = bodies->order.members; k < bodies->count && !unlike; k++)
        unlike = !are_alike(&bodies->record[k], first);
    return !unlike;
}

/* What the constants of a pair depend on is the same for all contacts. */
static int is_uniform(const struct scree_bodies *bodies, const struct scree_batch *batch) {
    if (is_of_alike_members(bodies, batch)) return 1;
    struct scree_contact first = first_outer(batch);
    for (int s = 0; s <= bodies->order.slabs; s++) {
        struct scree_outer outer = scree_outer_of(batch, s);
        for (int k = 0; k < batch->segment[s].outer_count; k++) {
            struct scree_contact one = scree_next_outer(&outer);
            if (!are_alike(&bodies->record[one.ball], &bodies->record[first.ball]) ||
                !are_alike(&bodies->record[one.host], &bodies->record[first.host]))
                return 0;
        }
    }
    return 1;
}

static scree_status enlarge_constants(struct scree_batch *batch, int after, scree_trouble *trouble) {
    int before = batch->pair_capacity, ok = 1;
    if (after <= before) return SCREE_OK;
    for (int c = 0; c < SCREE_PAIR_COLUMNS; c++) ok &= scree_enlarge(&batch->pair[c], before, after, sizeof(double));
    if (!ok) return scree_report(trouble, SCREE_NO_MEMORY, NULL, "no memory for the constants of %d contacts", after);
    batch->pair_capacity = after;
    return SCREE_OK;
}

scree_status scree_pair_constants(const struct scree_contacts *contacts, const struct scree_bodies *bodies,
                                  struct scree_batch *batch, scree_trouble *trouble) {
    scree_status status = enlarge_constants(batch, batch->capacity, trouble);
    for (int s = 0; s <= bodies->order.slabs && !status; s++) {
        const struct scree_part *segment = &batch->segment[s];
        struct columns pair = {{0.0}};
        int filled = segment->count ? segment->count + SCREE_PADDING - 1 : 0;
        for (int k = 0; k < filled && segment->first + k < batch->capacity; k++) {
            int index = segment->first + k; /* the padding gets what the last contact has */
            struct scree_contact contact = scree_contact_at(batch, k < segment->count ? index : segment->first);
            if (k < segment->count) pair = constants_of(contacts, bodies, batch, &contact);
            for (int c = 0; c < SCREE_PAIR_COLUMNS; c++) batch->pair[c][index] = pair.c[c];
        }
    }
    return status;
}

void scree_insert_constants(const struct scree_contacts *contacts, const struct scree_bodies *bodies,
                            struct scree_batch *batch, int s, int place) {
    const struct scree_part *segment = &batch->segment[s];
    struct scree_contact contact = scree_contact_at(batch, place);
    struct columns pair = constants_of(contacts, bodies, batch, &contact);
    int end = segment->first + segment->count, filled = segment->first + scree_padded(segment->count);
    for (int c = 0; c < SCREE_PAIR_COLUMNS; c++) {
        double *column = batch->pair[c];
        memmove(column + place + 1, column + place, (size_t)(end - 1 - place) * sizeof *column);
        column[place] = pair.c[c];
        for (int k = end; k < filled; k++) column[k] = column[end - 1];
    }
}

/* One block of constants for all contacts, if they have the same. */
static scree_status set_common_constants(const struct scree_contacts *contacts, const struct scree_bodies *bodies,
                                         struct scree_batch *batch, scree_trouble *trouble) {
    batch->uniform = is_uniform(bodies, batch);
    if (!batch->uniform) return SCREE_OK;
    scree_status status = enlarge_constants(batch, SCREE_LANES, trouble);
    if (status) return status;
    struct scree_contact first = first_outer(batch);
    struct columns pair = constants_of(contacts, bodies, batch, &first);
    for (int k = 0; k < SCREE_LANES; k++)
        for (int c = 0; c < SCREE_PAIR_COLUMNS; c++) batch->pair[c][k] = pair.c[c];
    return SCREE_OK;
}

static scree_status make_lists(struct scree_contacts *contacts, struct scree_bodies *bodies, int threads,
                               scree_trouble *trouble) {
    scree_status status = scree_flights_choose(contacts, bodies, are_many(contacts, bodies), trouble);
    if (status) return status;
    widen_margins(contacts, bodies);
    status = scree_candidates(contacts, bodies, threads, trouble);
    if (status) return status;
    take_all(contacts, bodies, threads, 0);
    status = make_room(contacts, bodies, trouble);
    if (status) return status;
    take_all(contacts, bodies, threads, FILL);
    status = note_boxes(contacts, bodies, trouble);
    if (status) return status;
    grant_all(contacts, bodies, threads);
    for (int k = 0; k < contacts->busy_batches && !status; k++) {
        struct scree_batch *batch = &contacts->batch[contacts->busy[k]];
        sort(batch);
        status = set_common_constants(contacts, bodies, batch, trouble);
    }
    if (status) return status;
    contacts->rebuilds++;
    contacts->extended = contacts->stays = 0;
    return scree_contacts_pick(contacts, bodies, threads, trouble);
}

scree_status scree_contacts_list(struct scree_contacts *contacts, struct scree_bodies *bodies, int threads,
                                 scree_trouble *trouble) {
    scree_status status = make_lists(contacts, bodies, threads, trouble);
    contacts->broken = status != SCREE_OK;
    return status;
}

/* No list may drop a contact that still holds, hence 1.5 times the reach. Fast bodies among many may go as far as the
 * mean body is wide beyond their half of the skin; not so far that one meets itself. */
void scree_contacts_choose_skin(struct scree_contacts *contacts, const struct scree_bodies *bodies, int few,
                                double reach) {
    double mean = 0.0, thinnest = HUGE_VAL, most = HUGE_VAL;
    int thick = 0;
    for (int k = 0; k < bodies->count; k++) {
        double half = scree_shape_half_width(&scree_kind_of(bodies, k)->shape);
        thinnest = fmin(thinnest, half);
        if (half < HUGE_VAL) mean += (half - mean) / ++thick;
        for (int axis = 0; axis < 3; axis++)
            if (bodies->period[axis] > 0.0)
                most = fmin(most, 0.25 * (bodies->period[axis] - 2.0 * bodies->record[k].radius));
    }
    if (!thick) thinnest = mean = 1.0;
    contacts->skin = contacts->chosen_skin = fmax((bodies->count <= few ? 1.0 : 0.4) * thinnest, 1.5 * reach);
    contacts->most_margin = fmin(0.5 * contacts->skin + mean, most);
}

/* For so many at once the outer list is extended; where they are more, it is old. */
enum { MOST_EXHAUSTED = 8 };

int scree_grant_anew(struct scree_contacts *contacts, const struct scree_bodies *bodies, int k) {
    contacts->spare[k] = at_most((double)contacts->spare[k] + (0.5 * contacts->skin - bodies->path[k]));
    return grant(contacts, bodies, k);
}

int scree_grant_more(struct scree_contacts *contacts, const struct scree_bodies *bodies, int k, double more) {
    contacts->spare[k] = at_most((double)contacts->spare[k] + more);
    return grant(contacts, bodies, k);
}

/* New margins for all bodies; those are told whose outer ones are used up: so many, or more than are told. */
static int grant_all_anew(struct scree_contacts *contacts, const struct scree_bodies *bodies, int threads,
                          int exhausted[MOST_EXHAUSTED]) {
    int count = 0;
    (void)threads; /* without OpenMP */
#pragma omp parallel for schedule(static) num_threads(threads) if (threads > 1)
    for (int k = 0; k < bodies->count; k++) {
        if (bodies->class[k] == SCREE_CLASS_FIXED || scree_grant_anew(contacts, bodies, k)) continue;
        int told = __atomic_fetch_add(&count, 1, __ATOMIC_RELAXED);
        if (told < MOST_EXHAUSTED) exhausted[told] = k;
    }
    return count;
}

scree_status scree_contacts_renew(struct scree_contacts *contacts, struct scree_bodies *bodies, int threads,
                                  scree_trouble *trouble) {
    int over = contacts->flights.flown + 2.0 * contacts->step > contacts->flights.last; /* after the step to come */
    if (contacts->broken || over) return scree_contacts_list(contacts, bodies, threads, trouble);
    begin_margins(contacts, bodies);
    int exhausted[MOST_EXHAUSTED], count = grant_all_anew(contacts, bodies, threads, exhausted);
    if (count > MOST_EXHAUSTED) return scree_contacts_list(contacts, bodies, threads, trouble);
    for (int n = 0; n < count; n++)
        if (!scree_contacts_extend(contacts, bodies, exhausted[n]))
            return scree_contacts_list(contacts, bodies, threads, trouble);
    contacts->renewals++;
    return scree_contacts_pick(contacts, bodies, threads, trouble);
}

scree_status scree_contacts_keep_order(struct scree_contacts *contacts, struct scree_bodies *bodies, int threads,
                                       scree_trouble *trouble) {
    if (!scree_bodies_disordered(bodies)) return SCREE_OK;
    return scree_contacts_sort(contacts, bodies, threads, trouble);
}
