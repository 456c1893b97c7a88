/* Boxes in boxes: how deep, through which face a corner came in, and edges on edges. */
#include "contact/crossing.h"

/* ---- depth ---- */

/* The directions that could separate two cores (Gottschalk, Lin & Manocha 1996): faces of a, of b, an edge of each. Not
 * unit. */
enum { DIRECTIONS = 15 };

static struct vec direction_of(const struct mat *a, const struct mat *b, int k) {
    return k < 3 ? a->column[k] : k < 6 ? b->column[k - 3] : vec_cross(a->column[(k - 6) / 3], b->column[(k - 6) % 3]);
}

static const double parallel = 1e-6; /* edges: the faces say it all */

/* How deep two cores are in each other, the one seen from the other's centre: the least of the overlaps along the
 * directions that could separate them; not positive where one does. */
static double depth_of_cores(struct vec apart, const struct scree_attitude *a, const struct mat *frame,
                             const double half[3]) {
    double least = HUGE_VAL;
    for (int k = 0; k < DIRECTIONS && least > 0.0; k++) {
        struct vec direction = direction_of(&a->frame, frame, k);
        double size = vec_norm(direction);
        if (size < parallel) continue;
        double depth = scree_box_reach(direction, a) + scree_core_reach(direction, frame, half);
        least = fmin(least, (depth - fabs(vec_dot(direction, apart))) / size);
    }
    return least;
}

/* The point of a box's core, centred at `centre`, that is nearest to `point`. */
static struct vec nearest_in_box(struct vec centre, const struct scree_attitude *box, struct vec point) {
    struct vec p = mat_undo(&box->frame, vec_sub(point, centre));
    const double *h = box->half;
    struct vec inside = vec(scree_clamp(p.x, h[0]), scree_clamp(p.y, h[1]), scree_clamp(p.z, h[2]));
    return vec_add(centre, mat_apply(&box->frame, inside));
}

/* Distance of two cores, by projecting to and fro (Cheney & Goldstein 1959): from above, and close after some
 * rounds. */
static double cores_distance(struct vec apart, const struct scree_attitude *a, const struct scree_attitude *b) {
    struct vec origin = {0.0, 0.0, 0.0}, on_a = apart;
    double distance = HUGE_VAL;
    for (int k = 0; k < 100; k++) {
        double before = distance;
        struct vec on_b = nearest_in_box(origin, b, on_a);
        on_a = nearest_in_box(apart, a, on_b);
        distance = vec_norm(vec_sub(on_a, on_b));
        if (!(distance < before * (1.0 - 1e-6))) break;
    }
    return distance;
}

/* How deep two rounded boxes are in each other; 0 where they aren't. Cores apart: what the roundings overlap, which no
 * direction of theirs tells where corner is next to corner. */
double scree_boxes_depth(struct vec apart, const struct scree_attitude *a, const struct scree_attitude *b,
                         double roundings) {
    double depth = depth_of_cores(apart, a, &b->frame, b->half) + roundings;
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
    if (whole.box) depth = fmin(depth, depth_of_cores(vec_sub(whole.centre, origin), whole.box, frame, half));
    return (struct scree_meeting){vec_scale(side, frame->column[k]), radii + depth};
}

/* ---- edges ---- */

struct edge {
    struct vec middle, along, outward; /* from the centre of its box; unit; towards its two faces, not unit */
    double half;
};

/* Edge 0 … 11 of a core that is drawn in. */
static struct edge edge_of(const struct scree_attitude *box, int edge, double inset) {
    int axis = edge / 4, u = (axis + 1) % 3, v = (axis + 2) % 3;
    struct vec first = box->frame.column[u], second = box->frame.column[v];
    if (!(edge & 1)) first = vec_scale(-1.0, first);
    if (!(edge & 2)) second = vec_scale(-1.0, second);
    return (struct edge){vec_axpy(vec_scale(box->half[u] - inset, first), box->half[v] - inset, second),
                         box->frame.column[axis], vec_add(first, second), box->half[axis] - inset};
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

/* Square of the distance of two edges, ends included (Ericson, Real-Time Collision Detection, 2005, section 5.1.9). */
static double square_apart(const struct edge *a, const struct edge *b, struct vec from_b_to_a) {
    double same = vec_dot(a->along, b->along);
    double along_a = vec_dot(from_b_to_a, a->along), along_b = vec_dot(from_b_to_a, b->along);
    double square = 1.0 - same * same, s = square > 1e-12 ? (same * along_b - along_a) / square : 0.0;
    s = scree_clamp(s, a->half);
    double t = scree_clamp(along_b + same * s, b->half);
    s = scree_clamp(same * t - along_a, a->half);
    return vec_norm2(vec_axpy(vec_axpy(from_b_to_a, s, a->along), -t, b->along));
}

/* Edges of a core that come within `reach` of the bounds of another one along its axes; returns how many. */
static int edges_near(const struct scree_attitude *own, struct vec from_other, const struct scree_attitude *other,
                      double reach, int near[SCREE_EDGES]) {
    int count = 0;
    for (int k = 0; k < SCREE_EDGES; k++) {
        struct edge edge = edge_of(own, k, 0.0);
        struct vec middle = vec_add(from_other, edge.middle);
        int far = 0;
        for (int axis = 0; axis < 3; axis++) {
            struct vec n = other->frame.column[axis];
            far |= fabs(vec_dot(n, middle)) - edge.half * fabs(vec_dot(n, edge.along)) > other->half[axis] + reach;
        }
        near[count] = k;
        count += !far;
    }
    return count;
}

int scree_near_edges(const struct scree_two_boxes *boxes, double overlap, double way,
                     int code[SCREE_EDGES * SCREE_EDGES]) {
    double roundings = boxes->rounding_a + boxes->rounding_b;
    if (-overlap > roundings + way) return 0;
    /* Deep by D they touch at up to 2.9 D: drawn in by 0.6 D sqrt(2) each, both roundings larger by 0.6 D. */
    double reach = roundings + way + 2.9 * fmax(overlap + way, 0.0);
    struct edge b[SCREE_EDGES];
    int of_a[SCREE_EDGES + 1], of_b[SCREE_EDGES + 1], count = 0;
    int near_a = edges_near(boxes->a, boxes->apart, boxes->b, reach, of_a);
    int near_b = edges_near(boxes->b, vec_scale(-1.0, boxes->apart), boxes->a, reach, of_b);
    for (int k = 0; k < near_b; k++) b[k] = edge_of(boxes->b, of_b[k], 0.0);
    for (int i = 0; i < near_a; i++) {
        struct edge a = edge_of(boxes->a, of_a[i], 0.0);
        struct vec middle = vec_add(boxes->apart, a.middle);
        for (int k = 0; k < near_b; k++)
            if (square_apart(&a, &b[k], vec_sub(middle, b[k].middle)) <= reach * reach)
                code[count++] = scree_crossing_code(of_a[i], of_b[k]);
    }
    return count;
}

/* ---- boxes deeper in each other than their roundings ---- */

/* Six tenths: the cores are then apart whatever their attitudes (0.5 would do, since one that is drawn in by s reaches
 * less far by s at least along any direction), and what is left of the boxes touches (up to 1/(2 (sqrt(3) - 1)) = 0.68,
 * since with its rounding it reaches less far by (sqrt(3) - 1) s at most). */
static const double inset_per_depth = 0.6;

/* What two boxes are along a direction that could separate them. */
struct way {
    int axis;
    double size;       /* of the product of two edges */
    struct vec normal; /* unit, from b to a */
    double depth;      /* of the cores */
    double recess;     /* by how much less far both cores reach per metre that they are drawn in */
};

/* |x|, without a kink at 0: so that faces on each other, whatever the rounding of their normals, lie still. */
static double smooth_size(double x) {
    double size = fabs(x), t = fmin(50.0 * size, 1.0);
    return size * t * (2.0 - t);
}

static double smooth_slope(double x) {
    double t = fmin(50.0 * fabs(x), 1.0);
    return copysign(t * (4.0 - 3.0 * t), x);
}

/* What the depth of boxes that are drawn in counts for along the product of two edges, per metre of depth, if these are
 * at a small angle (sine `size`): such directions turn fast, and beyond a tenth never are the least. */
static double aside_of(const struct way *way) {
    double t = way->axis < 6 ? 0.0 : fmax(0.2 / way->size - 1.0, 0.0);
    return t * t;
}

static double recess_along(const struct scree_two_boxes *boxes, struct vec n) {
    double recess = 0.0;
    for (int k = 0; k < 3; k++)
        recess +=
            smooth_size(vec_dot(n, boxes->a->frame.column[k])) + smooth_size(vec_dot(n, boxes->b->frame.column[k]));
    return recess;
}

/* All but the recess. Returns 0 for edges that are parallel. */
static int look_along(const struct scree_two_boxes *boxes, int axis, struct way *way) {
    const struct scree_attitude *a = boxes->a, *b = boxes->b;
    struct vec direction = direction_of(&a->frame, &b->frame, axis);
    double size = vec_norm(direction);
    if (size < parallel) return 0;
    double along = vec_dot(direction, boxes->apart);
    struct vec n = vec_scale((along < 0.0 ? -1.0 : 1.0) / size, direction);
    double depth = (scree_box_reach(direction, a) + scree_box_reach(direction, b) - fabs(along)) / size;
    *way = (struct way){axis, size, n, depth, 0.0};
    return 1;
}

static struct scree_gradient gradient_of_force(struct vec apart, struct vec force, struct vec point) {
    return (struct scree_gradient){force, vec_cross(point, force),
                                   vec_scale(-1.0, vec_cross(vec_add(point, apart), force))};
}

static struct scree_gradient gradient_axpy(struct scree_gradient p, double s, struct scree_gradient q) {
    return (struct scree_gradient){vec_axpy(p.force, s, q.force), vec_axpy(p.turn_a, s, q.turn_a),
                                   vec_axpy(p.turn_b, s, q.turn_b)};
}

static struct scree_gradient gradient_scale(double s, struct scree_gradient p) {
    return (struct scree_gradient){vec_scale(s, p.force), vec_scale(s, p.turn_a), vec_scale(s, p.turn_b)};
}

/* The point of a core, from its centre, that is farthest along a direction. */
static struct vec farthest(const struct scree_attitude *box, struct vec direction) {
    struct vec p = {0.0, 0.0, 0.0};
    for (int k = 0; k < 3; k++)
        p = vec_axpy(p, copysign(box->half[k], vec_dot(direction, box->frame.column[k])), box->frame.column[k]);
    return p;
}

/* Gradient of the depth along a direction: a unit force on the deepest corner of a, or of b, or where two edges
 * cross. */
static struct scree_gradient gradient_of_depth(const struct scree_two_boxes *boxes, const struct way *way) {
    const struct scree_attitude *a = boxes->a, *b = boxes->b;
    struct vec n = way->normal, on_a = farthest(a, vec_scale(-1.0, n)), on_b = farthest(b, n);
    if (way->axis < 3) on_a = vec_sub(on_b, boxes->apart);
    if (way->axis >= 6) {
        struct vec along_a = a->frame.column[(way->axis - 6) / 3], along_b = b->frame.column[(way->axis - 6) % 3];
        struct vec across = vec_cross(along_a, along_b), r = vec_sub(vec_add(boxes->apart, on_a), on_b);
        on_a = vec_axpy(on_a, vec_dot(vec_cross(along_b, r), across) / vec_norm2(across), along_a);
    }
    return gradient_of_force(boxes->apart, n, on_a);
}

/* Gradient of the recess, which changes as the boxes turn, and the direction with them. */
static struct scree_gradient gradient_of_recess(const struct scree_two_boxes *boxes, const struct way *way) {
    const struct mat *a = &boxes->a->frame, *b = &boxes->b->frame;
    struct vec n = way->normal, zero = {0.0, 0.0, 0.0}, of_a = zero, of_b = zero;
    for (int k = 0; k < 3; k++) {
        of_a = vec_axpy(of_a, smooth_slope(vec_dot(n, a->column[k])), a->column[k]);
        of_b = vec_axpy(of_b, smooth_slope(vec_dot(n, b->column[k])), b->column[k]);
    }
    struct vec turn_a = vec_cross(n, of_a), turn_b = vec_cross(n, of_b), all = vec_add(of_a, of_b);
    if (way->axis < 3) turn_a = vec_sub(turn_a, vec_cross(n, all));
    if (way->axis >= 3 && way->axis < 6) turn_b = vec_sub(turn_b, vec_cross(n, all));
    if (way->axis >= 6) {
        struct vec u = a->column[(way->axis - 6) / 3], v = b->column[(way->axis - 6) % 3];
        double side = vec_dot(vec_cross(u, v), n) < 0.0 ? -1.0 : 1.0;
        struct vec flat = vec_scale(side / way->size, vec_axpy(all, -vec_dot(all, n), n));
        turn_a = vec_sub(turn_a, vec_cross(u, vec_cross(v, flat)));
        turn_b = vec_sub(turn_b, vec_cross(v, vec_cross(flat, u)));
    }
    return (struct scree_gradient){zero, turn_a, turn_b};
}

/* Gradient of aside_of. */
static struct scree_gradient gradient_of_aside(const struct scree_two_boxes *boxes, const struct way *way) {
    struct vec zero = {0.0, 0.0, 0.0};
    if (!(aside_of(way) > 0.0)) return (struct scree_gradient){zero, zero, zero};
    struct vec u = boxes->a->frame.column[(way->axis - 6) / 3], v = boxes->b->frame.column[(way->axis - 6) % 3];
    struct vec across = vec_scale(1.0 / way->size, vec_cross(u, v));
    double rate = 2.0 * (0.2 / way->size - 1.0) * 0.2 / (way->size * way->size);
    return (struct scree_gradient){zero, vec_scale(rate, vec_cross(u, vec_cross(v, across))),
                                   vec_scale(rate, vec_cross(v, vec_cross(across, u)))};
}

static double depth_left(const struct way *way, double depth) {
    return way->depth + depth * (aside_of(way) - inset_per_depth * (way->recess - 2.0));
}

void scree_draw_in(struct scree_two_boxes *boxes) {
    struct way way[DIRECTIONS];
    int ways = 0, least = 0, left = 0;
    boxes->inset = (struct scree_inset){.factor = 1.0};
    for (int k = 0; k < DIRECTIONS; k++) {
        if (!look_along(boxes, k, &way[ways])) continue;
        if (!(way[ways].depth > 0.0)) return;
        if (way[ways].depth < way[least].depth) least = ways;
        ways++;
    }
    for (int k = 0; k < ways; k++) way[k].recess = recess_along(boxes, way[k].normal);
    /* The depth of what they are drawn in to, roundings included. */
    double roundings = boxes->rounding_a + boxes->rounding_b, depth = way[least].depth, by = inset_per_depth * depth;
    for (int k = 1; k < ways; k++)
        if (depth_left(&way[k], depth) < depth_left(&way[left], depth)) left = k;
    double rest = roundings + depth_left(&way[left], depth), factor = (roundings + depth) / rest;
    struct scree_gradient deeper = gradient_of_depth(boxes, &way[least]), less = gradient_of_depth(boxes, &way[left]);
    less = gradient_axpy(less, aside_of(&way[left]) - inset_per_depth * (way[left].recess - 2.0), deeper);
    less = gradient_axpy(less, depth, gradient_of_aside(boxes, &way[left]));
    less = gradient_axpy(less, -by, gradient_of_recess(boxes, &way[left]));
    boxes->inset = (struct scree_inset){by, factor, gradient_scale(inset_per_depth, deeper),
                                        gradient_scale(1.0 / rest, gradient_axpy(deeper, -factor, less))};
}

/* A corner at the end of an edge, or alone: its overlap, where it is pushed, by how much the overlap grows per metre
 * that both cores are drawn in, and by how much q falls per metre that it gets deeper. */
struct end {
    struct vec push, point; /* on a; from the centre of a */
    double overlap, slope, ratio;
};

/* The corner at `centre`, whose faces look `outward` (their normals' sum), of a core that is drawn in, and the other
 * core at `origin`. */
static struct scree_meeting meet_drawn_in(struct vec centre, struct vec outward, double rounding,
                                          struct scree_whole whole, struct vec origin,
                                          const struct scree_attitude *host, double other, double inset,
                                          double *slope) {
    double half[3];
    for (int k = 0; k < 3; k++) half[k] = host->half[k] - inset;
    struct scree_meeting m = scree_meet_box(centre, rounding + inset, whole, origin, &host->frame, half, other + inset);
    *slope = 2.0 + vec_dot(m.normal, outward);
    for (int k = 0; k < 3; k++) *slope -= fabs(vec_dot(m.normal, host->frame.column[k]));
    return m;
}

static struct end corner_of_a(const struct scree_two_boxes *boxes, struct vec corner, struct vec outward) {
    double slope;
    struct scree_whole whole = {boxes->apart, boxes->a};
    struct scree_meeting m = meet_drawn_in(vec_add(boxes->apart, corner), outward, boxes->rounding_a, whole,
                                           vec(0.0, 0.0, 0.0), boxes->b, boxes->rounding_b, boxes->inset.by, &slope);
    return (struct end){m.normal, corner, m.overlap, slope, 0.0};
}

static struct end corner_of_b(const struct scree_two_boxes *boxes, struct vec corner, struct vec outward) {
    double slope;
    struct scree_whole whole = {vec(0.0, 0.0, 0.0), boxes->b};
    struct scree_meeting m = meet_drawn_in(corner, outward, boxes->rounding_b, whole, boxes->apart, boxes->a,
                                           boxes->rounding_a, boxes->inset.by, &slope);
    return (struct end){vec_scale(-1.0, m.normal), vec_sub(corner, boxes->apart), m.overlap, slope, 0.0};
}

/* End 0 or 1 of an edge. */
static struct end end_of(const struct scree_two_boxes *boxes, const struct edge *edge, int of_b, int second) {
    struct vec corner = vec_axpy(edge->middle, second ? edge->half : -edge->half, edge->along);
    struct vec outward = vec_axpy(edge->outward, second ? 1.0 : -1.0, edge->along);
    return of_b ? corner_of_b(boxes, corner, outward) : corner_of_a(boxes, corner, outward);
}

/* Add what `push` (on a) at `point` (from the centre of a) does. */
static void add_force(struct scree_crossing *c, struct vec apart, struct vec push, struct vec point) {
    c->force = vec_add(c->force, push);
    c->turn_a = vec_add(c->turn_a, vec_cross(point, push));
    c->turn_b = vec_sub(c->turn_b, vec_cross(vec_add(point, apart), push));
}

/* q grows by `slope` per metre that the cores are drawn in, which they are the farther, the deeper the boxes; and
 * counts by a factor. */
static void count_inset(struct scree_crossing *c, const struct scree_two_boxes *boxes, double slope) {
    const struct scree_inset *inset = &boxes->inset;
    if (!(inset->by > 0.0)) return;
    struct scree_gradient p =
        gradient_axpy((struct scree_gradient){c->force, c->turn_a, c->turn_b}, slope, inset->deeper);
    p = gradient_axpy(gradient_scale(inset->factor, p), c->meeting.overlap, inset->larger);
    for (int k = 0; k < 4; k++) c->handed[k] *= inset->factor;
    c->meeting.overlap *= inset->factor;
    c->force = p.force;
    c->turn_a = p.turn_a;
    c->turn_b = p.turn_b;
}

struct scree_crossing scree_meet_corner(const struct scree_two_boxes *boxes, int corner) {
    struct vec zero = {0.0, 0.0, 0.0}, p = zero, outward = zero;
    for (int k = 0; k < 3; k++) {
        double side = corner >> k & 1 ? 1.0 : -1.0;
        p = vec_axpy(p, side * (boxes->a->half[k] - boxes->inset.by), boxes->a->frame.column[k]);
        outward = vec_axpy(outward, side, boxes->a->frame.column[k]);
    }
    struct end end = corner_of_a(boxes, p, outward);
    struct scree_crossing c = {{end.push, end.overlap}, zero, zero, zero, zero, 1.0, {0.0}};
    c.point = vec_axpy(p, 0.5 * end.overlap - boxes->rounding_a - boxes->inset.by, end.push);
    add_force(&c, boxes->apart, end.push, c.point);
    count_inset(&c, boxes, end.slope);
    return c;
}

/* ---- edge on edge ---- */

/* q and its derivatives from the overlap d, which grows by `slope` per metre that the cores are drawn in, and the
 * corners at the four ends. */
static void share_with_ends(const struct scree_two_boxes *boxes, const struct end end[4], double d, double slope,
                            struct scree_crossing *c) {
    double left = 1.0, steeper = 1.0;
    for (int k = 0; k < 4; k++) {
        double square = end[k].ratio * end[k].ratio;
        left *= 1.0 - square;
        steeper += 2.0 * square / (1.0 - square);
    }
    c->meeting.overlap = d * left;
    c->own = left * steeper;
    add_force(c, boxes->apart, vec_scale(c->own, c->meeting.normal), c->point);
    slope *= left * steeper;
    for (int k = 0; k < 4; k++) {
        if (end[k].ratio == 0.0) continue;
        double less = -2.0 * end[k].ratio * left / (1.0 - end[k].ratio * end[k].ratio);
        c->handed[k] = -less;
        add_force(c, boxes->apart, vec_scale(less, end[k].push), end[k].point);
        slope += less * end[k].slope;
    }
    count_inset(c, boxes, slope);
}

/* Edge `ea` of a on edge `eb` of b. */
struct scree_crossing scree_meet_edges(const struct scree_two_boxes *boxes, int ea, int eb) {
    double inset = boxes->inset.by;
    struct edge a = edge_of(boxes->a, ea, inset), b = edge_of(boxes->b, eb, inset);
    struct vec zero = {0.0, 0.0, 0.0};
    struct scree_crossing c = {{vec(0.0, 0.0, 1.0), SCREE_OUTSIDE}, zero, zero, zero, zero, 1.0, {0.0}};
    struct lines lines;
    if (!lines_cross(&a, &b, vec_sub(vec_add(boxes->apart, a.middle), b.middle), &lines)) return c;
    double rounding_a = boxes->rounding_a + inset, d = rounding_a + (boxes->rounding_b + inset) - lines.distance;
    c.meeting = (struct scree_meeting){lines.normal, fmin(d, 0.0)};
    c.point = vec_axpy(vec_axpy(a.middle, lines.on_a, a.along), 0.5 * d - rounding_a, c.meeting.normal);
    if (!(d > 0.0)) {
        add_force(&c, boxes->apart, c.meeting.normal, c.point);
        return c;
    }
    struct end end[4];
    for (int k = 0; k < 4; k++) {
        end[k] = end_of(boxes, k < 2 ? &a : &b, k >= 2, k & 1);
        end[k].ratio = end[k].overlap > 0.0 ? end[k].overlap / d : 0.0;
        if (end[k].ratio >= 1.0) return c; /* and the overlap is 0 */
    }
    share_with_ends(boxes, end, d, 2.0 + vec_dot(c.meeting.normal, vec_sub(a.outward, b.outward)), &c);
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

double scree_cores_overlap(const struct scree_two_boxes *boxes) {
    double clear = scree_cores_apart(boxes);
    return clear > 0.0 ? -clear : depth_of_cores(boxes->apart, boxes->a, &boxes->b->frame, boxes->b->half);
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
