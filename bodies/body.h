/* A body as it is defined: shape, mass, where it starts, and which of its motions are free. */
#ifndef SCREE_BODIES_BODY_H
#define SCREE_BODIES_BODY_H

#include "bodies/shape.h"

typedef enum scree_freedom {
    SCREE_FREE = 0, /* moved by forces */
    SCREE_FIXED,
    SCREE_DRIVEN /* moved by a prescribed motion */
} scree_freedom;

/* Joint to the world. Zero: free in all six directions. Axes are world axes; turns are about the body's centre.
 * A free turn with a non-zero `axis` is a hinge about that axis, with the zero vector it is unhindered; a driven turn
 * needs the axis. Motions are indices returned by scree_scene_add_motion and count from the start position. Planes and
 * rectangles can't be free, and a plane turns about its normal only. */
typedef struct scree_joint {
    scree_freedom along[3]; /* x, y, z */
    int along_motion[3];    /* m, of driven ones */
    scree_freedom turn;
    int turn_motion; /* rad */
    double axis[3];  /* of any length from 1e-100 to 1e100 */
} scree_joint;

/* A body. Zero means the default wherever that makes sense: density from the material instead of a mass, identity
 * orientation, at rest, free. Positions in m, velocities in m/s, spin in rad/s, all in the world. */
typedef struct scree_body_def {
    const char *name; /* unique, not empty, at most 255 bytes; copied */
    scree_shape shape;
    int material;          /* index returned by scree_scene_add_material */
    double mass;           /* kg; 0: density of the material times volume */
    double position[3];    /* of the centre of mass; of the origin for planes and rectangles */
    double orientation[4]; /* quaternion, scalar first, body to world; need not be normalised; of a sphere that turns
                              freely none is kept, whatever it begins with */
    double velocity[3];    /* along free directions only */
    double spin[3];        /* about free directions only */
    scree_joint joint;
} scree_body_def;

/* True if forces can move the body in any direction. */
static inline int scree_joint_can_move(const scree_joint *joint) {
    return joint->along[0] == SCREE_FREE || joint->along[1] == SCREE_FREE || joint->along[2] == SCREE_FREE ||
           joint->turn == SCREE_FREE;
}

/* True if nothing moves the body. */
static inline int scree_joint_is_fixed(const scree_joint *joint) {
    return joint->along[0] == SCREE_FIXED && joint->along[1] == SCREE_FIXED && joint->along[2] == SCREE_FIXED &&
           joint->turn == SCREE_FIXED;
}

#endif
