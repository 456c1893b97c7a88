/* The pair geometry: where a ball meets its partner. Each function gives the unit normal from the partner towards the ball
 * and the overlap (negative: the gap). */
#ifndef SCREE_CONTACT_GEOMETRY_H
#define SCREE_CONTACT_GEOMETRY_H

#include "bodies/bodies.h"

struct scree_meeting {
    struct vec normal;
    double overlap;
};

/* Gap that stands for "out of the borders"; a contact with it never touches. */
#define SCREE_OUTSIDE (-1e30)

static inline struct scree_meeting scree_meet_ball(struct vec centre, double radius, struct vec other,
                                                   double other_radius) {
    struct vec d = vec_sub(centre, other);
    double distance = vec_norm(d);
    if (distance == 0.0) return (struct scree_meeting){{0.0, 0.0, 1.0}, radius + other_radius};
    return (struct scree_meeting){vec_scale(1.0 / distance, d), radius + other_radius - distance};
}

static inline struct scree_meeting scree_meet_plane(struct vec centre, double radius, struct vec origin,
                                                    const struct mat *frame) {
    struct vec n = frame->column[2];
    return (struct scree_meeting){n, radius - vec_dot(n, vec_sub(centre, origin))};
}

/* A plane that acts only while the ball's centre is above or in it inside the borders. It has an upper side only: a ball
 * deeper than `thick` is below it and doesn't touch. `beyond` widens the borders. */
static inline struct scree_meeting scree_meet_rectangle(struct vec centre, double radius, struct vec origin,
                                                        const struct mat *frame, const double half[3], double thick,
                                                        double beyond) {
    struct vec d = vec_sub(centre, origin);
    double x = vec_dot(frame->column[0], d), y = vec_dot(frame->column[1], d);
    double overlap = radius - vec_dot(frame->column[2], d);
    int inside = fabs(x) <= half[0] + beyond && fabs(y) <= half[1] + beyond && overlap <= thick + beyond;
    return (struct scree_meeting){frame->column[2], inside ? overlap : SCREE_OUTSIDE};
}

/* A box with its core (half-lengths `half`) swept by `rounding`: the nearest point of the core while the centre is outside
 * of it, the nearest face while it is inside. */
static inline struct scree_meeting scree_meet_box(struct vec centre, double radius, struct vec origin,
                                                  const struct mat *frame, const double half[3], double rounding) {
    struct vec p = mat_undo(frame, vec_sub(centre, origin));
    struct vec nearest =
        vec(fmin(fmax(p.x, -half[0]), half[0]), fmin(fmax(p.y, -half[1]), half[1]), fmin(fmax(p.z, -half[2]), half[2]));
    struct vec out = vec_sub(p, nearest);
    double distance = vec_norm(out);
    if (distance > 0.0) {
        struct vec n = mat_apply(frame, vec_scale(1.0 / distance, out));
        return (struct scree_meeting){n, radius + rounding - distance};
    }
    double depth[3] = {half[0] - fabs(p.x), half[1] - fabs(p.y), half[2] - fabs(p.z)};
    int k = depth[0] <= depth[1] ? 0 : 1;
    if (depth[2] < depth[k]) k = 2;
    double side = (k == 0 ? p.x : k == 1 ? p.y : p.z) < 0.0 ? -1.0 : 1.0;
    return (struct scree_meeting){vec_scale(side, frame->column[k]), radius + rounding + depth[k]};
}

#endif
