/* Edge on edge: what two boxes have of each other that no corner sees.
 *
 * A rounded box is its core swept by a ball, so two of them touch where their cores come closer than the sum R of the
 * roundings. The nearest points of two cores are either a corner and any point of the other core, which the contacts of
 * corners see, or inner points of two edges. Those are taken up here, each pair of edges whose common perpendicular
 * ends inside both:
 *
 *   d = R - distance of the edges,   d_i = overlap of the corners at their four ends (at least 0),
 *   q = d (1 - (d_1/d)^2) … (1 - (d_4/d)^2),   0 where a corner is as deep as the crossing
 *
 * and the law sees the overlap q. Where a crossing comes to the end of its edge, and where edges become parallel, there
 * is a corner just as deep: q goes to zero, and the corner takes over. Faces that lie on each other with corners
 * between them are borne by those corners alone, faces without by their crossings. As distances are differentiable
 * functions of the pose, so is q: the contact pushes along all the pushes that q consists of (`force`, `turn_a`,
 * `turn_b`), and an elastic law has a potential. Some of these take load off the corners beside it (`handed`): friction
 * counts from what is left at each point (relief.c).
 *
 * Boxes deeper in each other than R (sharp ones at once) are taken for more rounded than they are: both cores are drawn
 * in by s = 0.6 x the depth D of the cores, and both roundings grow by as much. They lie within the boxes, so nothing
 * touches that doesn't; their cores are apart, so all of the above holds; and they touch while D > 0 (boxes.c). But
 * they are less deep in each other than the boxes themselves where these touch with edges and corners, which have
 * become rounder, by (R + P)/(R + D) with their own depth P: so the law sees q (R + D)/(R + P), which is the boxes'
 * whole depth where one edge, or one corner, bears all. D and P are continuous, the least of what boxes overlap along
 * the directions that could separate them, so q is, and the contact pushes as its gradient says. */
#ifndef SCREE_CONTACT_CROSSING_H
#define SCREE_CONTACT_CROSSING_H

#include "contact/geometry.h"

/* A gradient, by how the boxes move against it: force on a (the opposite on b), torques about their centres. */
struct scree_gradient {
    struct vec force, turn_a, turn_b;
};

/* How far both cores are drawn in, m, and the factor of their overlaps; both with their gradients. */
struct scree_inset {
    double by, factor;
    struct scree_gradient deeper, larger;
};

/* Two boxes, seen from the centre of b. */
struct scree_two_boxes {
    const struct scree_attitude *a, *b;
    struct vec apart; /* from the centre of b to that of a, m */
    double rounding_a, rounding_b;
    struct scree_inset inset;
};

enum { SCREE_EDGES = 12 }; /* 4 along each axis; bits of the rest: the signs along the two axes that follow it */

/* Draw the cores in as far as they are deep in each other; before, and where they aren't, the inset is 0. */
void scree_draw_in(struct scree_two_boxes *boxes);

/* Where two edges meet, or a corner of a meets b, seen from a: unit normal towards a, overlap q (not positive: they
 * don't touch; 0 where a corner is as deep), middle of the overlap from the centre of a, and what one newton of the law
 * does to both bodies, the gradient of q: force on a (the opposite on b), torques about their centres. */
struct scree_crossing {
    struct scree_meeting meeting;
    struct vec point, force, turn_a, turn_b;
    double own, handed[4]; /* what of it pushes at the point itself; what is taken off the corners at the ends of the
                              edge of a, and of b */
};

/* Corner 0 … 7 of a (bits for +x, +y, +z) on b. */
struct scree_crossing scree_meet_corner(const struct scree_two_boxes *boxes, int corner);

/* Edge `ea` of a on edge `eb` of b, 0 … 11. */
struct scree_crossing scree_meet_edges(const struct scree_two_boxes *boxes, int ea, int eb);

/* The code of two edges in scree_contact.corner; above 0. */
static inline int scree_crossing_code(int edge_of_a, int edge_of_b) { return 1 + edge_of_a * SCREE_EDGES + edge_of_b; }

/* The codes of all edges that may touch before the boxes have gone `way`, m, their ways added up; `overlap`:
 * scree_cores_overlap. Returns how many. */
int scree_near_edges(const struct scree_two_boxes *boxes, double overlap, double way,
                     int code[SCREE_EDGES * SCREE_EDGES]);

/* How far the cores are apart, from below; 0 if no axis of theirs separates them. */
double scree_cores_apart(const struct scree_two_boxes *boxes);

/* How deep the cores are in each other, from above; negative: how far apart. */
double scree_cores_overlap(const struct scree_two_boxes *boxes);

/* Two boxes with an axis in common along which each has an end within the other, and whose cores are apart across it,
 * meet as two rectangles do, corner on side: then corners bear all that edges could. Which axes to look along first:
 * the common one, of both, and the one across, 0 … 2 of b, 3 … 5 of a. */
struct scree_rectangles {
    int axis_a, axis_b, across;
};

/* Whether they do, along whatever axes; `first` tells where to look first, which changes nothing but the time. */
int scree_meet_as_rectangles(const struct scree_two_boxes *boxes, struct scree_rectangles first);

/* Whether they have an axis in common along which each has an end within the other: they meet as rectangles as long as
 * they move across it and turn about it only. */
int scree_share_axis(const struct scree_two_boxes *boxes);

/* Where to look first in poses that are near to this one. */
struct scree_rectangles scree_first_rectangles(const struct scree_two_boxes *boxes);

#endif
