/* How each body moves alone: the drift and kick of the step, free rotation, prescribed coordinates. */
#include "bodies/bodies.h"

#include "bodies/elementary.h"

#include <string.h>

/* Sine and cosine of an angle x and of 2x. In every sensible step angles are small, and a body's rotation is a chain of six
 * such turns, each waiting for the one before: so the short series, with few operations one after the other, comes
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
static struct quat turn_about(struct vec axis, double angle) {
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

/* Turn for time t at the given angular momentum, whatever the joint. `frame` belongs to q; `angle` is that of a driven turn
 * at the end. */
static inline struct quat rotate(const struct scree_attitude *attitude, const struct scree_inertia *inertia,
                                 const scree_joint *joint, struct quat q, const struct mat *frame, struct vec l,
                                 double t, int second, double angle) {
    struct vec axis = vec_from(attitude->axis);
    if (joint->turn == SCREE_DRIVEN) return quat_multiply(turn_about(axis, angle), quat_from(attitude->start));
    if (attitude->inverse_hinge == 0.0) return rotate_freely(q, frame, l, inertia->inverse_moments, t, second);
    return quat_normalise(quat_multiply(turn_about(axis, attitude->inverse_hinge * vec_dot(axis, l) * t), q));
}

/* Spin in the world at angular momentum l; `rate` is that of a driven turn. */
static struct vec spin_at(const struct scree_attitude *attitude, const struct scree_inertia *inertia,
                          const scree_joint *joint, const struct mat *frame, struct vec l, double rate) {
    struct vec axis = vec_from(attitude->axis);
    if (joint->turn == SCREE_FIXED) return vec(0.0, 0.0, 0.0);
    if (joint->turn == SCREE_DRIVEN) return vec_scale(rate, axis);
    if (attitude->inverse_hinge != 0.0) return vec_scale(attitude->inverse_hinge * vec_dot(axis, l), axis);
    return mat_apply(frame, vec_times(vec_from(inertia->inverse_moments), mat_undo(frame, l)));
}

static void place_corners(const struct scree_attitude *attitude, double (*corner)[4]) {
    struct vec a = vec_scale(attitude->half[0], attitude->frame.column[0]);
    struct vec b = vec_scale(attitude->half[1], attitude->frame.column[1]);
    struct vec c = vec_scale(attitude->half[2], attitude->frame.column[2]);
    for (int k = 0; k < 8; k++) {
        struct vec p = k & 1 ? a : vec_scale(-1.0, a);
        p = k & 2 ? vec_add(p, b) : vec_sub(p, b);
        p = k & 4 ? vec_add(p, c) : vec_sub(p, c);
        vec_store(p, corner[k]);
    }
}

/* Set the attitude that contacts see, and what follows from it. */
static void face(struct scree_bodies *bodies, int index, struct quat q) {
    struct scree_attitude *attitude = &bodies->attitude[bodies->slot[index]];
    attitude->ahead = q;
    attitude->frame = quat_to_mat(q);
    if (bodies->shape[index].kind == SCREE_BOX) place_corners(attitude, bodies->corner + 1 + 8 * bodies->slot[index]);
}

static void drive_to(const struct scree_bodies *bodies, double time) {
    for (int k = 0; k < bodies->motions; k++) bodies->moved[k] = scree_motion_at(&bodies->motion[k], time);
}

/* Lengthen the path by the way of the last step; nonzero if the list may no longer hold when the contacts are measured
 * half a step from now. Written so that a NaN counts as too far. */
static int outgrown(struct scree_record *record, double way, double margin) {
    record->path += way;
    return !(record->path + 0.5 * way <= margin);
}

static void clear_loads(struct scree_record *record) {
    memset(record->f, 0, sizeof record->f);
    memset(record->t, 0, sizeof record->t);
}

static int look_ahead_ball(struct scree_record *record, const struct scree_state *state,
                           const struct scree_inertia *inertia, double step, const double gravity[3], double margin) {
    double speed2 = 0.0;
    for (int k = 0; k < 3; k++) {
        double kick = inertia->inverse_mass[k] * record->f[k] + step * gravity[k];
        record->x[k] = state->x[k] + 0.5 * step * state->v[k];
        record->v[k] = state->v[k] + 0.5 * kick;
        record->w[k] = inertia->inverse_moments[0] * (state->l[k] + 0.5 * record->t[k]);
        record->f[k] = record->t[k] = 0.0;
        speed2 += state->v[k] * state->v[k];
    }
    return outgrown(record, step * sqrt(speed2), margin);
}

/* Attitude and spin half a step ahead; a body that can't turn keeps both. */
static void look_ahead_turn(struct scree_bodies *bodies, int index, double step) {
    const scree_joint *joint = &bodies->joint[index];
    if (joint->turn == SCREE_FIXED) return;
    struct scree_record *record = &bodies->record[index];
    const struct scree_inertia *inertia = &bodies->inertia[index];
    const struct scree_attitude *attitude = &bodies->attitude[bodies->slot[index]];
    struct scree_motion_value turn = {0};
    if (joint->turn == SCREE_DRIVEN) turn = bodies->moved[joint->turn_motion];
    struct vec l = vec_from(bodies->state[index].l);
    struct quat q = quat_from(attitude->q);
    struct mat frame = quat_to_mat(q);
    face(bodies, index, rotate(attitude, inertia, joint, q, &frame, l, 0.5 * step, 0, turn.position));
    struct vec predicted = vec_axpy(l, 0.5, vec_from(record->t));
    vec_store(spin_at(attitude, inertia, joint, &attitude->frame, predicted, turn.velocity), record->w);
}

static int look_ahead_general(struct scree_bodies *bodies, int index, double step, const double gravity[3],
                              double margin) {
    struct scree_record *record = &bodies->record[index];
    const struct scree_state *state = &bodies->state[index];
    const struct scree_inertia *inertia = &bodies->inertia[index];
    const scree_joint *joint = &bodies->joint[index];
    struct vec before = vec_from(record->x);
    for (int k = 0; k < 3; k++) {
        if (joint->along[k] == SCREE_DRIVEN) {
            record->x[k] = bodies->origin[index][k] + bodies->moved[joint->along_motion[k]].position;
            record->v[k] = bodies->moved[joint->along_motion[k]].velocity;
        } else if (joint->along[k] == SCREE_FREE) {
            record->x[k] = state->x[k] + 0.5 * step * state->v[k];
            record->v[k] = state->v[k] + 0.5 * (inertia->inverse_mass[k] * record->f[k] + step * gravity[k]);
        }
    }
    look_ahead_turn(bodies, index, step);
    clear_loads(record);
    /* A plane turns about its normal only, so its turning moves no surface. */
    double reach = bodies->shape[index].kind == SCREE_PLANE ? 0.0 : record->bound;
    double way = vec_norm(vec_sub(vec_from(record->x), before)) + step * vec_norm(vec_from(record->w)) * reach;
    return outgrown(record, way, margin);
}

int scree_bodies_look_ahead(struct scree_bodies *bodies, double time, double step, const double gravity[3],
                            double margin) {
    int too_far = 0;
    drive_to(bodies, time + 0.5 * step);
    for (int k = 0; k < bodies->count; k++) {
        if (bodies->class[k] == SCREE_CLASS_BALL)
            too_far |=
                look_ahead_ball(&bodies->record[k], &bodies->state[k], &bodies->inertia[k], step, gravity, margin);
        else if (bodies->class[k] == SCREE_CLASS_FIXED)
            clear_loads(&bodies->record[k]);
        else
            too_far |= look_ahead_general(bodies, k, step, gravity, margin);
    }
    return too_far;
}

/* A body that friction brings to rest slows down exponentially. Long before its speed could matter the squares of such numbers
 * become denormal, on which processors take a slow path; so numbers this small are zero. */
static inline double settle(double x) { return fabs(x) < 1e-140 ? 0.0 : x; }

static void advance_ball(const struct scree_record *record, struct scree_state *state,
                         const struct scree_inertia *inertia, double step, const double gravity[3]) {
    for (int k = 0; k < 3; k++) {
        state->v[k] = settle(state->v[k] + (inertia->inverse_mass[k] * record->f[k] + step * gravity[k]));
        state->x[k] = record->x[k] + 0.5 * step * state->v[k];
        state->l[k] = settle(state->l[k] + record->t[k]);
    }
}

static void advance_turn(struct scree_bodies *bodies, int index, double step) {
    const scree_joint *joint = &bodies->joint[index];
    if (joint->turn == SCREE_FIXED) return;
    struct scree_state *state = &bodies->state[index];
    struct scree_attitude *attitude = &bodies->attitude[bodies->slot[index]];
    double angle = joint->turn == SCREE_DRIVEN ? bodies->moved[joint->turn_motion].position : 0.0;
    for (int k = 0; joint->turn == SCREE_FREE && k < 3; k++)
        state->l[k] = settle(state->l[k] + bodies->record[index].t[k]);
    struct quat q = rotate(attitude, &bodies->inertia[index], joint, attitude->ahead, &attitude->frame,
                           vec_from(state->l), 0.5 * step, 1, angle);
    quat_store(q, attitude->q);
}

static void advance_general(struct scree_bodies *bodies, int index, double step, const double gravity[3]) {
    const struct scree_record *record = &bodies->record[index];
    struct scree_state *state = &bodies->state[index];
    const scree_joint *joint = &bodies->joint[index];
    for (int k = 0; k < 3; k++) {
        if (joint->along[k] == SCREE_DRIVEN) {
            state->x[k] = bodies->origin[index][k] + bodies->moved[joint->along_motion[k]].position;
            state->v[k] = bodies->moved[joint->along_motion[k]].velocity;
        } else if (joint->along[k] == SCREE_FREE) {
            state->v[k] =
                settle(state->v[k] + (bodies->inertia[index].inverse_mass[k] * record->f[k] + step * gravity[k]));
            state->x[k] = record->x[k] + 0.5 * step * state->v[k];
        }
    }
    advance_turn(bodies, index, step);
}

void scree_bodies_advance(struct scree_bodies *bodies, double time, double step, const double gravity[3]) {
    drive_to(bodies, time + step);
    for (int k = 0; k < bodies->count; k++) {
        if (bodies->class[k] == SCREE_CLASS_BALL)
            advance_ball(&bodies->record[k], &bodies->state[k], &bodies->inertia[k], step, gravity);
        else if (bodies->class[k] == SCREE_CLASS_GENERAL)
            advance_general(bodies, k, step, gravity);
    }
}

/* ---- by impulses and moments ---- */

static void settle_past(struct scree_past *past, const struct scree_record *record) {
    memcpy(past->f[1], past->f[0], sizeof past->f[0]);
    memcpy(past->t[1], past->t[0], sizeof past->t[0]);
    memcpy(past->f[0], record->f, sizeof past->f[0]);
    memcpy(past->t[0], record->t, sizeof past->t[0]);
}

/* One free coordinate, from where it is at mid-step by its velocity at the start. */
static inline void advance_along(int k, const struct scree_record *record, const struct scree_past *past,
                                 struct scree_state *state, const struct scree_inertia *inertia, double step,
                                 const double gravity[3]) {
    double before = state->v[k], inverse_mass = inertia->inverse_mass[k];
    state->v[k] = settle(before + (inverse_mass * record->f[k] + step * gravity[k]));
    state->x[k] =
        record->x[k] + (0.5 * step * before + (inverse_mass * past->moment[k] + 0.5 * step * step * gravity[k]));
}

static void turn_by_moments(struct scree_bodies *bodies, int index, double step) {
    const scree_joint *joint = &bodies->joint[index];
    if (joint->turn == SCREE_FIXED) return;
    struct scree_state *state = &bodies->state[index];
    struct scree_attitude *attitude = &bodies->attitude[bodies->slot[index]];
    double angle = joint->turn == SCREE_DRIVEN ? bodies->moved[joint->turn_motion].position : 0.0;
    struct vec second = vec_axpy(vec_from(state->l), 2.0 / step, vec_from(bodies->past[index].turn_moment));
    struct quat q = rotate(attitude, &bodies->inertia[index], joint, attitude->ahead, &attitude->frame, second,
                           0.5 * step, 1, angle);
    for (int k = 0; joint->turn == SCREE_FREE && k < 3; k++)
        state->l[k] = settle(state->l[k] + bodies->record[index].t[k]);
    quat_store(q, attitude->q);
}

void scree_bodies_advance_by_moments(struct scree_bodies *bodies, double time, double step, const double gravity[3]) {
    drive_to(bodies, time + step);
    for (int index = 0; index < bodies->count; index++) {
        const struct scree_record *record = &bodies->record[index];
        struct scree_past *past = &bodies->past[index];
        struct scree_state *state = &bodies->state[index];
        const scree_joint *joint = &bodies->joint[index];
        if (bodies->class[index] == SCREE_CLASS_FIXED) continue;
        for (int k = 0; k < 3; k++) {
            if (joint->along[k] == SCREE_DRIVEN) {
                state->x[k] = bodies->origin[index][k] + bodies->moved[joint->along_motion[k]].position;
                state->v[k] = bodies->moved[joint->along_motion[k]].velocity;
            } else if (joint->along[k] == SCREE_FREE) {
                advance_along(k, record, past, state, &bodies->inertia[index], step, gravity);
            }
        }
        if (bodies->class[index] == SCREE_CLASS_GENERAL)
            turn_by_moments(bodies, index, step);
        else
            for (int k = 0; k < 3; k++) state->l[k] = settle(state->l[k] + record->t[k]);
        settle_past(past, record);
    }
}

/* Accelerations in the coming step that no contact causes; motions are at its end, `now` at its start. */
static void know(const struct scree_bodies *bodies, const struct scree_bodies *now, int index, double step,
                 const double gravity[3], struct scree_past *past) {
    const scree_joint *joint = &bodies->joint[index];
    const struct scree_record *record = &now->record[index];
    for (int k = 0; k < 3; k++) {
        if (joint->along[k] == SCREE_FREE) past->known[k] = gravity[k];
        if (joint->along[k] == SCREE_DRIVEN)
            past->known[k] = (bodies->moved[joint->along_motion[k]].velocity - record->v[k]) / step;
    }
    if (bodies->slot[index] < 0 || joint->turn == SCREE_FIXED) return;
    const struct scree_attitude *attitude = &now->attitude[now->slot[index]];
    struct vec spin = vec_from(record->w), turn = {0.0, 0.0, 0.0};
    if (joint->turn == SCREE_DRIVEN) {
        struct vec later = vec_scale(bodies->moved[joint->turn_motion].velocity, vec_from(attitude->axis));
        turn = vec_scale(1.0 / step, vec_sub(later, spin));
    } else if (attitude->inverse_hinge == 0.0) { /* Euler's equations */
        struct mat inverse = scree_bodies_inverse_inertia(now, index);
        turn = mat_apply(&inverse, vec_cross(vec_from(bodies->state[index].l), spin));
    }
    vec_store(turn, past->known_turn);
}

/* An upper bound, with room for rounding, of the way of a body's points in the step if the accelerations of the last two
 * steps go on or are extrapolated. */
static double range_of(const struct scree_bodies *bodies, const struct scree_bodies *now, int index, double step) {
    const struct scree_past *past = &bodies->past[index];
    const struct scree_record *record = &now->record[index];
    const struct scree_inertia *inertia = &bodies->inertia[index];
    const double *inverse = inertia->inverse_moments;
    double spin = vec_norm(vec_from(record->w)), mass = 0.0;
    double turn = fmax(inverse[0], fmax(inverse[1], inverse[2]));
    if (bodies->slot[index] >= 0) turn = fmax(turn, bodies->attitude[bodies->slot[index]].inverse_hinge);
    for (int k = 0; k < 3; k++) mass = fmax(mass, inertia->inverse_mass[k]);
    double push = 2.0 * vec_norm(vec_from(past->f[0])) + vec_norm(vec_from(past->f[1]));
    double twist = 2.0 * vec_norm(vec_from(past->t[0])) + vec_norm(vec_from(past->t[1]));
    double along = vec_norm(vec_from(record->v)) + mass * push + step * vec_norm(vec_from(past->known));
    double around = spin + turn * twist + step * (vec_norm(vec_from(past->known_turn)) + spin * spin);
    /* A plane's turning about its normal moves no surface. */
    double reach = bodies->shape[index].kind == SCREE_PLANE ? 0.0 : record->bound;
    return 2.0 * step * (along + around * reach);
}

int scree_bodies_look_both(struct scree_bodies *bodies, double time, double step, const double gravity[3],
                           double margin, struct scree_bodies *now) {
    scree_bodies_look_now(bodies, time, now);
    drive_to(bodies, time + step);
    for (int k = 0; k < bodies->count; k++) {
        if (bodies->class[k] == SCREE_CLASS_FIXED) continue;
        know(bodies, now, k, step, gravity, &bodies->past[k]);
        bodies->past[k].range = range_of(bodies, now, k, step);
        memset(bodies->past[k].moment, 0, sizeof bodies->past[k].moment);
        memset(bodies->past[k].turn_moment, 0, sizeof bodies->past[k].turn_moment);
    }
    return scree_bodies_look_ahead(bodies, time, step, gravity, margin);
}

struct mat scree_bodies_inverse_inertia(const struct scree_bodies *bodies, int index) {
    const double *inverse = bodies->inertia[index].inverse_moments;
    struct mat m = {{{inverse[0], 0.0, 0.0}, {0.0, inverse[0], 0.0}, {0.0, 0.0, inverse[0]}}};
    if (bodies->slot[index] < 0) return m;
    const struct scree_attitude *attitude = &bodies->attitude[bodies->slot[index]];
    struct vec axis = vec_from(attitude->axis);
    for (int k = 0; k < 3; k++) {
        struct vec unit = vec(k == 0, k == 1, k == 2);
        if (attitude->inverse_hinge != 0.0)
            m.column[k] = vec_scale(attitude->inverse_hinge * vec_dot(axis, unit), axis);
        else
            m.column[k] = mat_apply(&attitude->frame, vec_times(vec_from(inverse), mat_undo(&attitude->frame, unit)));
    }
    return m;
}

struct vec scree_bodies_spin(const struct scree_bodies *bodies, int index, double time) {
    const struct scree_inertia *inertia = &bodies->inertia[index];
    const scree_joint *joint = &bodies->joint[index];
    struct vec l = vec_from(bodies->state[index].l);
    if (bodies->slot[index] < 0) return vec_scale(inertia->inverse_moments[0], l);
    const struct scree_attitude *attitude = &bodies->attitude[bodies->slot[index]];
    struct mat frame = quat_to_mat(quat_from(attitude->q));
    double rate = 0.0;
    if (joint->turn == SCREE_DRIVEN) rate = scree_motion_at(&bodies->motion[joint->turn_motion], time).velocity;
    return spin_at(attitude, inertia, joint, &frame, l, rate);
}

void scree_bodies_look_now(const struct scree_bodies *bodies, double time, struct scree_bodies *shadow) {
    for (int k = 0; shadow != bodies && k < bodies->count; k++) shadow->record[k] = bodies->record[k];
    for (int k = 0; shadow != bodies && k < bodies->attitudes; k++) shadow->attitude[k] = bodies->attitude[k];
    for (int k = 0; k < bodies->count; k++) {
        struct scree_record *record = &shadow->record[k];
        memcpy(record->x, bodies->state[k].x, sizeof record->x);
        memcpy(record->v, bodies->state[k].v, sizeof record->v);
        vec_store(scree_bodies_spin(bodies, k, time), record->w);
        clear_loads(record);
        if (shadow->slot[k] >= 0) face(shadow, k, quat_from(shadow->attitude[shadow->slot[k]].q));
    }
}

void scree_bodies_start(struct scree_bodies *bodies, double time) {
    drive_to(bodies, time);
    for (int k = 0; k < bodies->count; k++) {
        const scree_joint *joint = &bodies->joint[k];
        for (int axis = 0; axis < 3; axis++) {
            if (joint->along[axis] != SCREE_DRIVEN) continue;
            bodies->state[k].x[axis] = bodies->origin[k][axis] + bodies->moved[joint->along_motion[axis]].position;
            bodies->state[k].v[axis] = bodies->moved[joint->along_motion[axis]].velocity;
        }
        if (joint->turn != SCREE_DRIVEN) continue;
        struct scree_attitude *attitude = &bodies->attitude[bodies->slot[k]];
        struct quat turned = turn_about(vec_from(attitude->axis), bodies->moved[joint->turn_motion].position);
        quat_store(quat_multiply(turned, quat_from(attitude->start)), attitude->q);
    }
    scree_bodies_look_now(bodies, time, bodies);
}
