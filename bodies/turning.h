/* What the ways of advancing bodies share (advance.c, moments.c): the turning of a body, motions, rest. For each of
 * them to inline. */
#ifndef SCREE_BODIES_TURNING_H
#define SCREE_BODIES_TURNING_H

#include "bodies/bodies.h"
#include "bodies/elementary.h"

/* Sine and cosine of an angle x and of 2x. In every sensible step angles are small, and a body's rotation is a chain of
 * six such turns, each waiting for the one before: so the short series, with few operations one after the other, comes
 * first. Both ways are exact to rounding. */
struct turn {
    double sine, cosine, sine2, cosine2;
};

static inline struct turn make_turn(double x) {
    double z = x * x;
    if (z < 1e-8)
        return (struct turn){x * (1.0 - z * (1.0 / 6.0)), 1.0 - 0.5 * z, x * (2.0 - z * (4.0 / 3.0)),
                             1.0 - z * (2.0 - z * (2.0 / 3.0))};
    double s, c;
    scree_sincos(x, &s, &c);
    return (struct turn){s, c, 2.0 * s * c, 1.0 - 2.0 * s * s};
}

/* The quaternion of a turn by `angle` about the unit vector `axis`. */
static inline struct quat turn_about(struct vec axis, double angle) {
    double s, c;
    scree_sincos(0.5 * angle, &s, &c);
    return (struct quat){c, s * axis.x, s * axis.y, s * axis.z};
}

/* Turn a body about its own axis k by twice the angle `half`; p is its angular momentum in body axes. */
static inline void turn_axis(int k, double half, struct quat *q, struct vec *p) {
    struct turn t = make_turn(half);
    double s = t.sine, c = t.cosine;
    struct quat o = *q;
    struct vec m = *p;
    if (k == 0) {
        *q = (struct quat){c * o.w - s * o.x, c * o.x + s * o.w, c * o.y + s * o.z, c * o.z - s * o.y};
        *p = vec(m.x, t.cosine2 * m.y + t.sine2 * m.z, t.cosine2 * m.z - t.sine2 * m.y);
    } else if (k == 1) {
        *q = (struct quat){c * o.w - s * o.y, c * o.x - s * o.z, c * o.y + s * o.w, c * o.z + s * o.x};
        *p = vec(t.cosine2 * m.x - t.sine2 * m.z, m.y, t.cosine2 * m.z + t.sine2 * m.x);
    } else {
        *q = (struct quat){c * o.w - s * o.z, c * o.x + s * o.y, c * o.y - s * o.x, c * o.z + s * o.w};
        *p = vec(t.cosine2 * m.x + t.sine2 * m.y, t.cosine2 * m.y - t.sine2 * m.x, m.z);
    }
}

/* Free rotation for time t by turns about the body's principal axes (Dullweber, Leimkuhler & McLachlan 1997): each is
 * exact, so the angular momentum in the world is kept to rounding. In the order x, y, z for the first half of a
 * step and z, y, x for the second, which makes the step symmetric in time and of second order. */
static inline struct quat rotate_freely(struct quat q, const struct mat *frame, struct vec l,
                                        const double inverse_moments[3], double t, int second) {
    struct vec p = mat_undo(frame, l);
    double a = 0.5 * t * inverse_moments[0], b = 0.5 * t * inverse_moments[1], c = 0.5 * t * inverse_moments[2];
    if (!second) {
        turn_axis(0, a * p.x, &q, &p);
        turn_axis(1, b * p.y, &q, &p);
        turn_axis(2, c * p.z, &q, &p);
        return q;
    }
    turn_axis(2, c * p.z, &q, &p);
    turn_axis(1, b * p.y, &q, &p);
    turn_axis(0, a * p.x, &q, &p);
    /* One Newton step towards unit length: rounding can't build up. */
    double s = 1.5 - 0.5 * (q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z);
    return (struct quat){s * q.w, s * q.x, s * q.y, s * q.z};
}

/* Turn for time t at the given angular momentum, whatever the joint. `frame` belongs to q; `angle` is that of a driven
 * turn at the end. */
static inline struct quat rotate(const struct scree_attitude *attitude, const struct scree_inertia *inertia,
                                 const scree_joint *joint, struct quat q, const struct mat *frame, struct vec l,
                                 double t, int second, double angle) {
    struct vec axis = vec_from(attitude->axis);
    if (joint->turn == SCREE_DRIVEN) return quat_multiply(turn_about(axis, angle), quat_from(attitude->start));
    if (attitude->inverse_hinge == 0.0) return rotate_freely(q, frame, l, inertia->inverse_moments, t, second);
    return quat_normalise(quat_multiply(turn_about(axis, attitude->inverse_hinge * vec_dot(axis, l) * t), q));
}

/* Put the motions at a time. */
static inline void drive_to(const struct scree_bodies *bodies, double time) {
    for (int k = 0; k < bodies->motions; k++) bodies->moved[k] = scree_motion_at(&bodies->motion[k], time);
}

#endif
