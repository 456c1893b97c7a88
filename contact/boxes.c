/* Boxes in boxes: how deep, through which face a corner came in, and edges on edges. */
#include "contact/crossing.h"

/* ---- depth ---- */

/* By the directions that could separate them: Gottschalk, Lin & Manocha 1996. */
double scree_cores_depth(struct vec apart, const struct scree_attitude *a, const struct mat *frame,
                         const double half[3]) {
    double least = HUGE_VAL;
    for (int k = 0; k < 15 && least > 0.0; k++) {
        struct vec direction = k < 3   ? a->frame.column[k]
                               : k < 6 ? frame->column[k - 3]
                                       : vec_cross(a->frame.column[(k - 6) / 3], frame->column[(k - 6) % 3]);
        double size = vec_norm(direction);
        if (size < 1e-6) continue; /* parallel edges: the faces say it all */
        double depth = scree_box_reach(direction, a) + scree_core_reach(direction, frame, half);
        least = fmin(least, (depth - fabs(vec_dot(direction, apart))) / size);
    }
    return least;
}

/* The point of a box's core, centred at `centre`, that is nearest to `point`. */
static struct vec nearest_in_box(struct vec centre, const struct scree_attitude *box, struct vec point) {
    struct vec p = mat_undo(&box->frame, vec_sub(point, centre));
    const double *h = box->half;
    struct vec inside = vec(fmin(fmax(p.x, -h[0]), h[0]), fmin(fmax(p.y, -h[1]), h[1]), fmin(fmax(p.z, -h[2]), h[2]));
    return vec_add(centre, mat_apply(&box->frame, inside));
}

/* Distance of two cores, by projecting to and fro (Cheney & Goldstein 1959): from above, and close after some rounds. */
static double cores_distance(struct vec apart, const struct scree_attitude *a, const struct scree_attitude *b) {
    struct vec origin = {0.0, 0.0, 0.0}, on_a = apart, on_b = origin;
    double distance = HUGE_VAL;
    for (int k = 0; k < 100; k++) {
        double before = distance;
        on_b = nearest_in_box(origin, b, on_a);
        on_a = nearest_in_box(apart, a, on_b);
        distance = vec_norm(vec_sub(on_a, on_b));
        if (!(distance < before * (1.0 - 1e-6))) break;
    }
    return distance;
}

/* How deep two rounded boxes are in each other; 0 where they aren't. Cores apart: what the roundings overlap, which no direction of
 * theirs tells where corner is next to corner. */
double scree_boxes_depth(struct vec apart, const struct scree_attitude *a, const struct scree_attitude *b,
                         double roundings) {
    double depth = scree_cores_depth(apart, a, &b->frame, b->half) + roundings;
    if (depth > 0.0 && depth < roundings) depth = roundings - cores_distance(apart, a, b);
    return fmax(depth, 0.0);
}

/* The face through which a ball came in whose centre is in the core of a box: where the whole body of the ball is least
 * deep. Axis 0 … 2; `side` receives -1 or 1. */
static int face_of(struct scree_whole whole, struct vec origin, const struct mat *frame, const double half[3],
                   double *side) {
    double least = HUGE_VAL;
    int face = 0;
    for (int k = 0; k < 3; k++) {
        double along = vec_dot(frame->column[k], vec_sub(whole.centre, origin));
        double depth = half[k] - fabs(along) + (whole.box ? scree_box_reach(frame->column[k], whole.box) : 0.0);
        if (!(depth < least)) continue;
        least = depth;
        face = k;
        *side = along < 0.0 ? -1.0 : 1.0;
    }
    return face;
}

struct scree_meeting scree_meet_core(struct vec p, double radii, struct scree_whole whole, struct vec origin,
                                     const struct mat *frame, const double half[3]) {
    double side = 1.0;
    int k = face_of(whole, origin, frame, half, &side);
    double along = k == 0 ? p.x : k == 1 ? p.y : p.z, depth = half[k] - side * along;
    if (whole.box) depth = fmin(depth, scree_cores_depth(vec_sub(whole.centre, origin), whole.box, frame, half));
    return (struct scree_meeting){vec_scale(side, frame->column[k]), radii + depth};
}

/* ---- edges ---- */

struct edge {
    struct vec middle, along, outward; /* from the centre of its box; unit; towards its two faces, not unit */
    double half;
};

static struct edge edge_of(const struct scree_attitude *box, int edge) {
    int axis = edge / 4, u = (axis + 1) % 3, v = (axis + 2) % 3;
    struct vec first = box->frame.column[u], second = box->frame.column[v];
    if (!(edge & 1)) first = vec_scale(-1.0, first);
    if (!(edge & 2)) second = vec_scale(-1.0, second);
    return (struct edge){vec_axpy(vec_scale(box->half[u], first), box->half[v], second), box->frame.column[axis],
                         vec_add(first, second), box->half[axis]};
}

/* The crossing of two lines: parameters of the nearest points, from the middles; normal from b to a; distance. */
struct lines {
    double on_a, on_b, distance;
    struct vec normal;
};

/* Returns 0 if the nearest points aren't inside both edges. Parallel edges are left to the corners at their ends. */
static int lines_cross(const struct edge *a, const struct edge *b, struct vec from_b_to_a, struct lines *lines) {
    struct vec across = vec_cross(a->along, b->along);
    double square = vec_norm2(across), same = vec_dot(a->along, b->along);
    if (!(square > 1e-12)) return 0;
    double along_a = vec_dot(from_b_to_a, a->along), along_b = vec_dot(from_b_to_a, b->along);
    lines->on_a = (same * along_b - along_a) / square;
    lines->on_b = (along_b - same * along_a) / square;
    if (!(fabs(lines->on_a) < a->half && fabs(lines->on_b) < b->half)) return 0;
    double size = sqrt(square), signed_distance = vec_dot(from_b_to_a, across) / size;
    lines->normal = vec_scale((signed_distance < 0.0 ? -1.0 : 1.0) / size, across);
    lines->distance = fabs(signed_distance);
    return 1;
}

/* Distance of two edges, ends included (Ericson, Real-Time Collision Detection, 2005, section 5.1.9). */
double scree_edges_apart(const struct scree_two_boxes *boxes, int ea, int eb) {
    struct edge a = edge_of(boxes->a, ea), b = edge_of(boxes->b, eb);
    struct vec r = vec_sub(vec_add(boxes->apart, a.middle), b.middle);
    double same = vec_dot(a.along, b.along), along_a = vec_dot(r, a.along), along_b = vec_dot(r, b.along);
    double square = 1.0 - same * same, s = square > 1e-12 ? (same * along_b - along_a) / square : 0.0;
    s = fmin(fmax(s, -a.half), a.half);
    double t = fmin(fmax(along_b + same * s, -b.half), b.half);
    s = fmin(fmax(same * t - along_a, -a.half), a.half);
    return vec_norm(vec_axpy(vec_axpy(r, s, a.along), -t, b.along));
}

/* How far a point, seen from the centre of a box, is inside of its core; negative: beyond a face. */
static double depth_in(const struct scree_attitude *box, struct vec point) {
    struct vec p = mat_undo(&box->frame, point);
    return fmin(fmin(box->half[0] - fabs(p.x), box->half[1] - fabs(p.y)), box->half[2] - fabs(p.z));
}

/* Overlap of edges that have passed through each other, and by which factor it counts (*share): all of it while both nearest points
 * are in the other box, less where they leave it sideways, as at faces that tilt on each other, and less close to the ends of edges,
 * where corners are inside; never more than what takes the boxes apart. */
static double passed_through(const struct scree_two_boxes *boxes, const struct edge *a, const struct edge *b,
                             const struct lines *lines, double *share) {
    double d = lines->distance;
    if (d > boxes->deepest || d == 0.0) return -d;
    struct vec point_a = vec_add(boxes->apart, vec_axpy(a->middle, lines->on_a, a->along));
    struct vec point_b = vec_sub(vec_axpy(b->middle, lines->on_b, b->along), boxes->apart);
    double inside = fmin(depth_in(boxes->b, point_a), depth_in(boxes->a, point_b)) / d;
    double left = fmin(a->half - fabs(lines->on_a), b->half - fabs(lines->on_b)) / d;
    double at_end = fmin(left, 1.0);
    *share = at_end * at_end * (3.0 - 2.0 * at_end);
    double deep = d * fmin(1.2 + 2.0 * inside, 1.0);
    double least = deep > -d ? scree_cores_depth(boxes->apart, boxes->a, &boxes->b->frame, boxes->b->half) : 0.0;
    return least > 0.0 ? fmin(deep, least) : -d;
}

/* A corner at the end of an edge: its overlap, where it is pushed, and by how much q falls per metre that it gets deeper. */
struct end {
    struct vec push, point; /* on a; from the centre of a */
    double ratio, overlap;
};

static struct end corner_of_a(const struct scree_two_boxes *boxes, const struct edge *edge, double way) {
    struct vec corner = vec_axpy(edge->middle, way, edge->along);
    struct scree_whole whole = {boxes->apart, boxes->a};
    struct scree_meeting m = scree_meet_box(vec_add(boxes->apart, corner), boxes->rounding_a, whole, vec(0.0, 0.0, 0.0),
                                            &boxes->b->frame, boxes->b->half, boxes->rounding_b);
    return (struct end){m.normal, corner, 0.0, m.overlap};
}

static struct end corner_of_b(const struct scree_two_boxes *boxes, const struct edge *edge, double way) {
    struct vec corner = vec_axpy(edge->middle, way, edge->along);
    struct scree_whole whole = {vec(0.0, 0.0, 0.0), boxes->b};
    struct scree_meeting m = scree_meet_box(corner, boxes->rounding_b, whole, boxes->apart, &boxes->a->frame,
                                            boxes->a->half, boxes->rounding_a);
    return (struct end){vec_scale(-1.0, m.normal), vec_sub(corner, boxes->apart), 0.0, m.overlap};
}

/* Add what `push` (on a) at `point` (from the centre of a) does. */
static void push(struct scree_crossing *c, struct vec apart, struct vec push, struct vec point) {
    c->force = vec_add(c->force, push);
    c->turn_a = vec_add(c->turn_a, vec_cross(point, push));
    c->turn_b = vec_sub(c->turn_b, vec_cross(vec_add(point, apart), push));
}

/* q and its derivatives from the overlap d and the corners at the four ends. */
static void share_with_ends(const struct scree_two_boxes *boxes, const struct end end[4], double d, double share,
                            struct scree_crossing *c) {
    double left = share, steeper = 1.0;
    for (int k = 0; k < 4; k++) {
        double square = end[k].ratio * end[k].ratio;
        left *= 1.0 - square;
        steeper += 2.0 * square / (1.0 - square);
    }
    c->meeting.overlap = d * left;
    push(c, boxes->apart, vec_scale(left * steeper, c->meeting.normal), c->point);
    for (int k = 0; k < 4; k++) {
        if (end[k].ratio == 0.0) continue;
        double less = -2.0 * end[k].ratio * left / (1.0 - end[k].ratio * end[k].ratio);
        push(c, boxes->apart, vec_scale(less, end[k].push), end[k].point);
    }
}

/* Edge `ea` of a on edge `eb` of b. */
struct scree_crossing scree_meet_edges(const struct scree_two_boxes *boxes, int ea, int eb) {
    struct edge a = edge_of(boxes->a, ea), b = edge_of(boxes->b, eb);
    struct vec zero = {0.0, 0.0, 0.0};
    struct scree_crossing c = {{vec(0.0, 0.0, 1.0), SCREE_OUTSIDE}, zero, zero, zero, zero};
    struct lines lines;
    if (!lines_cross(&a, &b, vec_sub(vec_add(boxes->apart, a.middle), b.middle), &lines)) return c;
    double d = boxes->rounding_a + boxes->rounding_b - lines.distance, share = 1.0;
    c.meeting.normal = lines.normal;
    /* Where each edge's inside faces the other one, they may have passed through each other. */
    if (vec_dot(lines.normal, a.outward) > 0.0 && vec_dot(lines.normal, b.outward) < 0.0) {
        double passed = passed_through(boxes, &a, &b, &lines, &share);
        if (passed > -lines.distance) c.meeting.normal = vec_scale(-1.0, lines.normal);
        d += lines.distance + passed;
    }
    c.meeting.overlap = fmin(d, 0.0);
    c.point = vec_axpy(vec_axpy(a.middle, lines.on_a, a.along), 0.5 * d - boxes->rounding_a, c.meeting.normal);
    if (!(d > 0.0)) {
        push(&c, boxes->apart, c.meeting.normal, c.point);
        return c;
    }
    struct end end[4];
    for (int k = 0; k < 4; k++) {
        end[k] =
            k < 2 ? corner_of_a(boxes, &a, k ? a.half : -a.half) : corner_of_b(boxes, &b, k == 3 ? b.half : -b.half);
        end[k].ratio = end[k].overlap > 0.0 ? end[k].overlap / d : 0.0;
        if (end[k].ratio >= 1.0) return c; /* and the overlap is 0 */
    }
    share_with_ends(boxes, end, d, share, &c);
    return c;
}

/* ---- boxes that meet as rectangles ---- */

double scree_cores_apart(const struct scree_two_boxes *boxes) {
    double most = 0.0;
    for (int k = 0; k < 6; k++) {
        const struct scree_attitude *own = k < 3 ? boxes->b : boxes->a, *other = k < 3 ? boxes->a : boxes->b;
        struct vec axis = own->frame.column[k % 3];
        double reach = own->half[k % 3] + scree_box_reach(axis, other);
        most = fmax(most, fabs(vec_dot(axis, boxes->apart)) - reach);
    }
    return most;
}

/* An axis in common, along which each has an end within the other. */
static int share_axis(const struct scree_two_boxes *boxes, int axis_a, int axis_b) {
    struct vec axis = boxes->b->frame.column[axis_b];
    if (vec_norm2(vec_cross(axis, boxes->a->frame.column[axis_a])) > 1e-24) return 0;
    double half_a = boxes->a->half[axis_a], half_b = boxes->b->half[axis_b];
    double along = fabs(vec_dot(axis, boxes->apart));
    return along >= fabs(half_a - half_b) && along <= half_a + half_b;
}

int scree_share_axis(const struct scree_two_boxes *boxes) {
    int any = 0;
    for (int k = 0; k < 9; k++) any |= share_axis(boxes, k / 3, k % 3);
    return any;
}

static int are_rectangles(const struct scree_two_boxes *boxes, struct scree_rectangles as) {
    if (!share_axis(boxes, as.axis_a, as.axis_b)) return 0;
    const struct scree_attitude *own = as.across < 3 ? boxes->b : boxes->a;
    const struct scree_attitude *other = as.across < 3 ? boxes->a : boxes->b;
    struct vec n = own->frame.column[as.across % 3];
    return fabs(vec_dot(n, boxes->apart)) > own->half[as.across % 3] + scree_box_reach(n, other);
}

/* Look along all axes; `as` receives those that were found. */
static int find_rectangles(const struct scree_two_boxes *boxes, struct scree_rectangles *as) {
    for (int k = 0; k < 9; k++) {
        *as = (struct scree_rectangles){k / 3, k % 3, 0};
        struct vec a = boxes->a->frame.column[as->axis_a], b = boxes->b->frame.column[as->axis_b];
        if (fabs(vec_dot(a, b)) < 0.999) continue;
        for (; as->across < 6; as->across++) {
            int own = as->across < 3 ? as->axis_b : as->axis_a;
            if (as->across % 3 != own && are_rectangles(boxes, *as)) return 1;
        }
    }
    *as = (struct scree_rectangles){0, 0, 1};
    return 0;
}

int scree_meet_as_rectangles(const struct scree_two_boxes *boxes, struct scree_rectangles first) {
    return are_rectangles(boxes, first) || find_rectangles(boxes, &first);
}

struct scree_rectangles scree_first_rectangles(const struct scree_two_boxes *boxes) {
    struct scree_rectangles as;
    find_rectangles(boxes, &as);
    return as;
}
