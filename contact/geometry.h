/* The pair geometry: where a ball meets its partner. Each function gives the unit normal from the partner towards the
 * ball and the overlap (negative: the gap). */
#ifndef SCREE_CONTACT_GEOMETRY_H
#define SCREE_CONTACT_GEOMETRY_H

#include "bodies/bodies.h"

struct scree_meeting {
    struct vec normal;
    double overlap;
};

/* Gap that stands for "below the plate"; a contact with it never touches. */
#define SCREE_OUTSIDE (-1e30)

/* Added to distances before they divide: changes none above 1e-284 m. */
#define SCREE_NO_WAY 1e-300

/* The direction of a way; upwards if it leads nowhere. `inverse`: one over the distance. */
static SCREE_INLINE struct vec scree_normal_of(struct vec way, double distance, double inverse) {
    return vec(inverse * way.x, inverse * way.y, distance == 0.0 ? 1.0 : inverse * way.z);
}

static SCREE_INLINE struct scree_meeting scree_meet_ball(struct vec centre, double radius, struct vec other,
                                                         double other_radius) {
    struct vec d = vec_sub(centre, other);
    double distance = vec_norm(d), inverse = 1.0 / (distance + SCREE_NO_WAY);
    return (struct scree_meeting){scree_normal_of(d, distance, inverse), radius + other_radius - distance};
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

/* `centre`: of the ball. */
static inline struct scree_whole scree_whole_of(const struct scree_bodies *bodies, int ball, int corner,
                                                struct vec centre) {
    if (corner == 0) return (struct scree_whole){centre, NULL};
    return (struct scree_whole){vec_from(bodies->record[ball].x), scree_attitude_of(bodies, ball)};
}

/* A thin plate: inside its borders a plane, at its borders a sharp edge. It has two sides: a sphere is on that of its
 * centre, a corner above as long as it is there or its body is, so that it may be pressed in, and may stay while its
 * body tips over the border. A corner beyond the border, but below its side, meets the border as a wall. A corner
 * deeper than `thick` is below the plate and doesn't touch. Force and energy are continuous wherever a sphere comes
 * from; a corner that is below while its body's centre passes the plate's level lets go of it, and from beneath only a
 * corner with a rounding is held. */
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
    struct vec out = vec(copysign(x > 0.0 ? x : 0.0, p.x), copysign(y > 0.0 ? y : 0.0, p.y), height > 0.0 ? p.z : 0.0);
    double distance = vec_norm(out);
    if (distance == 0.0) return (struct scree_meeting){vec_scale(side, frame->column[2]), radius};
    return (struct scree_meeting){mat_apply(frame, vec_scale(1.0 / distance, out)), radius - distance};
}

/* How far a core reaches along a direction. */
static inline double scree_core_reach(struct vec direction, const struct mat *frame, const double half[3]) {
    return fabs(vec_dot(direction, frame->column[0])) * half[0] + fabs(vec_dot(direction, frame->column[1])) * half[1] +
           fabs(vec_dot(direction, frame->column[2])) * half[2];
}

static inline double scree_box_reach(struct vec direction, const struct scree_attitude *box) {
    return scree_core_reach(direction, &box->frame, box->half);
}

/* A ball whose centre is in the core of a box, at `p` in its axes (boxes.c); `radii` of ball and rounding together. */
struct scree_meeting scree_meet_core(struct vec p, double radii, struct scree_whole whole, struct vec origin,
                                     const struct mat *frame, const double half[3]);

/* A box with its core (half-lengths `half`) swept by `rounding`: the nearest point of the core while the centre is
 * outside of it, the face through which the ball's body came while it is inside; then no deeper than what takes the two
 * cores apart. */
static inline struct scree_meeting scree_meet_box(struct vec centre, double radius, struct scree_whole whole,
                                                  struct vec origin, const struct mat *frame, const double half[3],
                                                  double rounding) {
    struct vec p = mat_undo(frame, vec_sub(centre, origin));
    struct vec nearest = vec(scree_clamp(p.x, half[0]), scree_clamp(p.y, half[1]), scree_clamp(p.z, half[2]));
    struct vec out = vec_sub(p, nearest);
    double distance = vec_norm(out);
    if (distance > 0.0) {
        struct vec n = mat_apply(frame, vec_scale(1.0 / distance, out));
        return (struct scree_meeting){n, radius + rounding - distance};
    }
    return scree_meet_core(p, radius + rounding, whole, origin, frame, half);
}

/* How deep two rounded boxes are in each other; 0 where they aren't. */
double scree_boxes_depth(struct vec apart, const struct scree_attitude *a, const struct scree_attitude *b,
                         double roundings);

#endif
