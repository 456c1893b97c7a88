/* The pair geometry: where a ball meets its partner. Each function gives the unit normal from the partner towards the ball
 * and the overlap (negative: the gap). */
#ifndef SCREE_CONTACT_GEOMETRY_H
#define SCREE_CONTACT_GEOMETRY_H

#include "bodies/bodies.h"

struct scree_meeting {
    struct vec normal;
    double overlap;
};

/* Gap that stands for "below the plate"; a contact with it never touches. */
#define SCREE_OUTSIDE (-1e30)

static inline struct scree_meeting scree_meet_ball(struct vec centre, double radius, struct vec other,
                                                   double other_radius) {
    struct vec d = vec_sub(centre, other);
    double distance = vec_norm(d), inverse = 1.0 / distance;
    int same = distance == 0.0; /* selections, no branch: the loop takes several at once */
    struct vec n = vec(same ? 0.0 : inverse * d.x, same ? 0.0 : inverse * d.y, same ? 1.0 : inverse * d.z);
    return (struct scree_meeting){n, radius + other_radius - distance};
}

static inline struct scree_meeting scree_meet_plane(struct vec centre, double radius, struct vec origin,
                                                    const struct mat *frame) {
    struct vec n = frame->column[2];
    return (struct scree_meeting){n, radius - vec_dot(n, vec_sub(centre, origin))};
}

/* The box that a ball is a corner of, as its partner sees it; a sphere is no box. */
struct scree_whole {
    struct vec centre;
    const struct scree_attitude *box; /* NULL: a sphere */
};

static inline struct scree_whole scree_whole_of(const struct scree_bodies *bodies, int ball, int corner) {
    return (struct scree_whole){vec_from(bodies->record[ball].x),
                                corner ? &bodies->attitude[bodies->slot[ball]] : NULL};
}

/* A thin plate: inside its borders a plane, at its borders a sharp edge. It has two sides: a sphere is on that of its centre, a
 * corner above as long as it is there or its body is, so that it may be pressed in, and may stay while its body tips over
 * the border. A corner beyond the border, but below its side, meets the border as a wall. A corner deeper than `thick` is below
 * the plate and doesn't touch. Force and energy are continuous wherever a sphere comes from; a corner that is below while its
 * body's centre passes the plate's level lets go of it, and from beneath only a corner with a rounding is held. */
static inline struct scree_meeting scree_meet_rectangle(struct vec centre, double radius, struct scree_whole whole,
                                                        struct vec origin, const struct mat *frame,
                                                        const double half[3], double thick) {
    struct vec p = mat_undo(frame, vec_sub(centre, origin));
    double above = whole.box ? vec_dot(frame->column[2], vec_sub(whole.centre, origin)) : -1.0;
    double side = p.z < 0.0 && above < 0.0 ? -1.0 : 1.0, height = side * p.z;
    int below = radius - height > thick;
    double x = fabs(p.x) - half[0], y = fabs(p.y) - half[1]; /* beyond the border where positive */
    if (below || (x <= 0.0 && y <= 0.0))
        return (struct scree_meeting){vec_scale(side, frame->column[2]), below ? SCREE_OUTSIDE : radius - height};
    struct vec out = vec(copysign(fmax(x, 0.0), p.x), copysign(fmax(y, 0.0), p.y), height > 0.0 ? p.z : 0.0);
    double distance = vec_norm(out);
    if (distance == 0.0) return (struct scree_meeting){vec_scale(side, frame->column[2]), radius};
    return (struct scree_meeting){mat_apply(frame, vec_scale(1.0 / distance, out)), radius - distance};
}

/* How far two boxes overlap along a direction of one of them: half-lengths `half` there, the other's projected onto it. */
static inline double scree_box_reach(struct vec direction, const struct scree_attitude *box) {
    return fabs(vec_dot(direction, box->frame.column[0])) * box->half[0] +
           fabs(vec_dot(direction, box->frame.column[1])) * box->half[1] +
           fabs(vec_dot(direction, box->frame.column[2])) * box->half[2];
}

/* The face through which a ball came in whose centre is in the core of a box: where the whole body of the ball is least
 * deep. Axis 0 … 2; `side` receives -1 or 1. */
static inline int scree_face_of(struct scree_whole whole, struct vec origin, const struct mat *frame,
                                const double half[3], double *side) {
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

/* A box with its core (half-lengths `half`) swept by `rounding`: the nearest point of the core while the centre is outside
 * of it, the face through which the ball's body came while it is inside. */
static inline struct scree_meeting scree_meet_box(struct vec centre, double radius, struct scree_whole whole,
                                                  struct vec origin, const struct mat *frame, const double half[3],
                                                  double rounding) {
    struct vec p = mat_undo(frame, vec_sub(centre, origin));
    struct vec nearest =
        vec(fmin(fmax(p.x, -half[0]), half[0]), fmin(fmax(p.y, -half[1]), half[1]), fmin(fmax(p.z, -half[2]), half[2]));
    struct vec out = vec_sub(p, nearest);
    double distance = vec_norm(out), side = 1.0;
    if (distance > 0.0) {
        struct vec n = mat_apply(frame, vec_scale(1.0 / distance, out));
        return (struct scree_meeting){n, radius + rounding - distance};
    }
    int k = scree_face_of(whole, origin, frame, half, &side);
    double along = k == 0 ? p.x : k == 1 ? p.y : p.z;
    return (struct scree_meeting){vec_scale(side, frame->column[k]), radius + rounding + half[k] - side * along};
}

/* The point of a box's core, centred at `centre`, that is nearest to `point`. */
static inline struct vec scree_nearest_in_box(struct vec centre, const struct scree_attitude *box, struct vec point) {
    struct vec p = mat_undo(&box->frame, vec_sub(point, centre));
    const double *h = box->half;
    struct vec inside = vec(fmin(fmax(p.x, -h[0]), h[0]), fmin(fmax(p.y, -h[1]), h[1]), fmin(fmax(p.z, -h[2]), h[2]));
    return vec_add(centre, mat_apply(&box->frame, inside));
}

/* Distance of two cores, by projecting to and fro (Cheney & Goldstein 1959): from above, and close after some rounds. */
static inline double scree_cores_distance(struct vec apart, const struct scree_attitude *a,
                                          const struct scree_attitude *b) {
    struct vec origin = {0.0, 0.0, 0.0}, on_a = apart, on_b = origin;
    double distance = HUGE_VAL;
    for (int k = 0; k < 100; k++) {
        double before = distance;
        on_b = scree_nearest_in_box(origin, b, on_a);
        on_a = scree_nearest_in_box(apart, a, on_b);
        distance = vec_norm(vec_sub(on_a, on_b));
        if (!(distance < before * (1.0 - 1e-6))) break;
    }
    return distance;
}

/* How deep two rounded boxes are in each other; 0 where they aren't. Cores that overlap: the least of the overlaps along the
 * directions that could separate them (Gottschalk, Lin & Manocha 1996). Cores apart: what the roundings overlap, which no such
 * direction tells where corner is next to corner. */
static inline double scree_boxes_depth(struct vec apart, const struct scree_attitude *a, const struct scree_attitude *b,
                                       double roundings) {
    double least = HUGE_VAL;
    for (int k = 0; k < 15 && least > 0.0; k++) {
        struct vec direction = k < 3   ? a->frame.column[k]
                               : k < 6 ? b->frame.column[k - 3]
                                       : vec_cross(a->frame.column[(k - 6) / 3], b->frame.column[(k - 6) % 3]);
        double size = vec_norm(direction);
        if (size < 1e-6) continue; /* parallel edges: the faces say it all */
        direction = vec_scale(1.0 / size, direction);
        double depth = scree_box_reach(direction, a) + scree_box_reach(direction, b) + roundings;
        least = fmin(least, depth - fabs(vec_dot(direction, apart)));
    }
    if (least > 0.0 && least < roundings) least = roundings - scree_cores_distance(apart, a, b);
    return fmax(least, 0.0);
}

#endif
