/* Shapes: what a body is made of. Volume, inertia, bounds. */
#ifndef SCREE_BODIES_SHAPE_H
#define SCREE_BODIES_SHAPE_H

#include "bodies/trouble.h"

typedef enum scree_shape_kind {
    SCREE_SPHERE = 0,
    SCREE_BOX,       /* a box with rounded edges: a core box swept by a sphere of the rounding radius */
    SCREE_PLANE,     /* the half-space below z = 0 of the body's axes; normal = body z */
    SCREE_RECTANGLE, /* that plane, active only inside |x| <= edge[0]/2, |y| <= edge[1]/2 of the body's axes; bodies
                        that are wholly below it don't touch it */
    SCREE_SHAPE_KINDS
} scree_shape_kind;

/* Lengths in m. Which fields count depends on the kind; the others are ignored. */
typedef struct scree_shape {
    scree_shape_kind kind;
    double radius;   /* sphere: > 0 */
    double edge[3];  /* box: full lengths along the body's axes, > 0; rectangle: the first two */
    double rounding; /* box: radius of its edges and corners, 0 … half the shortest edge */
} scree_shape;

/* ---- inside the library and its programs; the shared library keeps these to itself ---- */

/* SCREE_BAD_INPUT if a length is not a positive finite number or the rounding doesn't fit into the box. */
scree_status scree_shape_check(const scree_shape *shape, scree_trouble *trouble);

/* Volume in m^3; 0 for planes and rectangles. Exact for the rounded box (Steiner's formula for parallel bodies). */
double scree_shape_volume(const scree_shape *shape);

/* Principal moments about the centre for unit mass, in m^2 (kg m^2 per kg), along the body's axes; exact. Zero for
 * planes and rectangles. */
void scree_shape_inertia(const scree_shape *shape, double moments[3]);

/* Radius of the smallest sphere about the body's origin that holds the shape, m; HUGE_VAL for a plane. */
double scree_shape_bound(const scree_shape *shape);

/* The half-width that an overlap must stay well below, m: the radius, or half the shortest edge; HUGE_VAL for
 * planes and rectangles. */
double scree_shape_half_width(const scree_shape *shape);

/* "sphere", "box", "plane", "rectangle". */
const char *scree_shape_name(scree_shape_kind kind);

#endif
