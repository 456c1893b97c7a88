/* What edges that cross beside a corner take off it. The overlap of a crossing shrinks as the corners at the ends of
 * its edges get deep (crossing.h), so what the law makes of it pushes at the crossing and pulls at these corners, more
 * than it does together. Friction counts from what a point bears when all of that is summed up: else a box that
 * overhangs another would feel too much of it, and in the wrong place. */
#include "contact/meet.h"

/* The edge of a box along an axis that ends in a corner. */
static int edge_at(int corner, int axis) {
    int u = corner >> (axis + 1) % 3 & 1, v = corner >> (axis + 2) % 3 & 1;
    return 4 * axis + u + 2 * v;
}

/* An edge from its corner on, in the frame of the other box; it comes near that one's edges along axis w where the two
 * are nearest to each other seen along w. Bits of these edges, as in scree_meet_edges: most have none, and whether they
 * cross is found out there. */
static unsigned near_along(const double from[3], const double way[3], const double half[3], int w, double reach) {
    const double slack = 1.0 + 1e-9;
    int u = (w + 1) % 3, v = (w + 2) % 3;
    double square = way[u] * way[u] + way[v] * way[v];
    unsigned near = 0;
    for (unsigned k = 0; k < 4; k++) {
        double off_u = from[u] - (k & 1 ? half[u] : -half[u]), off_v = from[v] - (k & 2 ? half[v] : -half[v]);
        double along = -(off_u * way[u] + off_v * way[v]), beside = off_u * way[v] - off_v * way[u];
        int inside = along * slack >= -1e-9 * square && along <= square * slack &&
                     fabs(from[w] * square + along * way[w]) <= half[w] * square * slack &&
                     beside * beside <= reach * reach * square * slack;
        near |= (unsigned)inside << k;
    }
    return near << 4 * w;
}

/* Edges of the host that come near the edge of the ball along `axis` from a corner on; bits. */
static unsigned edges_near(const struct scree_two_boxes *boxes, int corner, int axis) {
    const struct scree_attitude *a = boxes->a;
    double from[3], way[3], half[3], inset = boxes->inset.by, length = 2.0 * (a->half[axis] - inset);
    double reach = boxes->rounding_a + boxes->rounding_b + 2.0 * inset;
    struct vec at = boxes->apart, along = vec_scale(corner >> axis & 1 ? -length : length, a->frame.column[axis]);
    for (int k = 0; k < 3; k++)
        at = vec_axpy(at, corner >> k & 1 ? a->half[k] - inset : inset - a->half[k], a->frame.column[k]);
    for (int k = 0; k < 3; k++) {
        half[k] = boxes->b->half[k] - inset;
        from[k] = vec_dot(boxes->b->frame.column[k], at);
        way[k] = vec_dot(boxes->b->frame.column[k], along);
    }
    unsigned near = 0;
    for (int w = 0; w < 3; w++) near |= near_along(from, way, half, w, reach);
    return near;
}

/* What the law makes of a crossing without history, N. */
static double force_of(const struct scree_bodies *bodies, const struct scree_rule *rule,
                       const struct scree_contact *contact, const struct scree_crossing *crossing) {
    const struct scree_normal_law *law = scree_normal_laws[rule->normal];
    double mass = scree_effective_mass(bodies, contact->ball, contact->host) / rule->share;
    double radius = scree_effective_radius(bodies, contact->ball, contact->host, SCREE_EDGE_EDGE);
    struct scree_gait gait = scree_gait_on_edges(bodies, contact, crossing);
    struct scree_pressing at = scree_pressed(crossing->meeting.overlap, gait.closing, 0.0, 0.0);
    struct scree_normal_force f =
        law->force(&rule->normal_constants, law->pair(&rule->normal_constants, mass, radius), at);
    double force = f.elastic + f.damping * gait.closing;
    return force > 0.0 ? force : 0.0;
}

/* By crossings of one edge that ends in the corner. */
static double relief_along(const struct scree_bodies *bodies, const struct scree_rule *rule,
                           const struct scree_contact *contact, const struct scree_two_boxes *boxes, int axis,
                           unsigned near) {
    int corner = (contact->corner - 1) % 8;
    double relief = 0.0;
    for (int other = 0; other < SCREE_EDGES; other++) {
        if (!(near >> other & 1)) continue;
        struct scree_crossing crossing = scree_meet_edges(boxes, edge_at(corner, axis), other);
        double handed = crossing.meeting.overlap > 0.0 ? crossing.handed[corner >> axis & 1] : 0.0;
        if (handed > 0.0) relief += handed * force_of(bodies, rule, contact, &crossing);
    }
    return relief;
}

double scree_relief(const struct scree_bodies *bodies, const struct scree_rule *rule,
                    const struct scree_contact *contact, const struct scree_two_boxes *boxes) {
    unsigned near[3], any = 0;
    for (int axis = 0; axis < 3; axis++) any |= near[axis] = edges_near(boxes, (contact->corner - 1) % 8, axis);
    if (!any || rule->corners) return 0.0;
    if (scree_meet_as_rectangles(boxes, (struct scree_rectangles){0, 0, 1})) return 0.0;
    double relief = 0.0;
    for (int axis = 0; axis < 3; axis++)
        if (near[axis]) relief += relief_along(bodies, rule, contact, boxes, axis, near[axis]);
    return relief;
}

int scree_may_be_relieved(const struct scree_bodies *bodies, const struct scree_contact *contact) {
    return contact->corner > 0 && scree_kind_of(bodies, contact->host)->shape.kind == SCREE_BOX;
}
