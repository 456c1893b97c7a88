/* What every way of stepping a contact needs: where its ball meets its partner, and how a stretch follows the normal. */
#ifndef SCREE_CONTACT_MEET_H
#define SCREE_CONTACT_MEET_H

#include "contact/contacts.h"

/* Normal and overlap of a contact whose ball's centre is at `centre`. */
static inline struct scree_meeting scree_meet(const struct scree_bodies *bodies, const struct scree_contact *contact,
                                              enum scree_geometry geometry, struct vec centre) {
    const struct scree_record *ball = &bodies->record[contact->ball], *host = &bodies->record[contact->host];
    struct vec origin = vec_from(host->x);
    double radius = ball->radius;
    if (geometry == SCREE_BALL_BALL) return scree_meet_ball(centre, radius, origin, host->radius);
    const struct scree_attitude *attitude = &bodies->attitude[bodies->slot[contact->host]];
    if (geometry == SCREE_BALL_PLANE) return scree_meet_plane(centre, radius, origin, &attitude->frame);
    struct scree_whole whole = scree_whole_of(bodies, contact->ball, contact->corner);
    if (geometry == SCREE_BALL_RECTANGLE)
        return scree_meet_rectangle(centre, radius, whole, origin, &attitude->frame, attitude->half,
                                    scree_thickness(ball));
    return scree_meet_box(centre, radius, whole, origin, &attitude->frame, attitude->half, host->radius);
}

/* The code of two edges in scree_contact.corner; above 0. */
static inline int scree_crossing_code(int edge_of_ball, int edge_of_host) {
    return 1 + edge_of_ball * SCREE_EDGES + edge_of_host;
}

static inline struct scree_two_boxes scree_two_boxes_of(const struct scree_bodies *bodies, int ball, int host) {
    const struct scree_record *a = &bodies->record[ball], *b = &bodies->record[host];
    return (struct scree_two_boxes){&bodies->attitude[bodies->slot[ball]],
                                    &bodies->attitude[bodies->slot[host]],
                                    vec_sub(vec_from(a->x), vec_from(b->x)),
                                    a->radius,
                                    b->radius,
                                    2.0 * fmin(a->limit, b->limit)};
}

/* A contact of two edges. */
static inline struct scree_crossing scree_cross(const struct scree_bodies *bodies,
                                                const struct scree_contact *contact) {
    struct scree_two_boxes boxes = scree_two_boxes_of(bodies, contact->ball, contact->host);
    int code = contact->corner - 1;
    return scree_meet_edges(&boxes, code / SCREE_EDGES, code % SCREE_EDGES);
}

/* Bring a stretch into the tangent plane without changing its length: the normal has turned since it was stored. The
 * threshold keeps rounding from doing anything where the normal stands still. */
static inline struct vec scree_into_tangent_plane(struct vec stretch, struct vec normal) {
    double along = vec_dot(stretch, normal), before = vec_norm2(stretch);
    struct vec flat = vec_axpy(stretch, -along, normal);
    double after = vec_norm2(flat);
    double scale = along * along > 1e-24 * before && after > 0.0 ? sqrt(before / after) : 1.0;
    return vec_scale(scale, flat);
}

#endif
