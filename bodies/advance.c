/* How each body moves alone: the drift and kick of the step, free rotation, prescribed coordinates. */
#include "bodies/balls.h"
#include "bodies/turning.h"

#include <string.h>

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
    struct scree_attitude *attitude = scree_attitude_of(bodies, index);
    attitude->ahead = q;
    attitude->frame = quat_to_mat(q);
    if (scree_kind_of(bodies, index)->shape.kind == SCREE_BOX)
        place_corners(attitude, bodies->corner + 1 + 8 * scree_kind_of(bodies, index)->slot);
}

static void clear_loads(struct scree_record *record) {
    memset(record->impulse, 0, sizeof record->impulse);
    memset(record->turn, 0, sizeof record->turn);
}

/* Attitude and spin half a step ahead; a body that can't turn keeps both. */
static void look_ahead_turn(struct scree_bodies *bodies, int index, double step) {
    const scree_joint *joint = &scree_kind_of(bodies, index)->joint;
    if (joint->turn == SCREE_FIXED) return;
    struct scree_record *record = &bodies->record[index];
    const struct scree_inertia *inertia = &scree_kind_of(bodies, index)->inertia;
    const struct scree_attitude *attitude = scree_attitude_of(bodies, index);
    struct scree_motion_value turn = {0};
    if (joint->turn == SCREE_DRIVEN) turn = bodies->moved[joint->turn_motion];
    struct vec l = vec_from(bodies->state[index].l);
    struct quat q = quat_from(attitude->q);
    struct mat frame = quat_to_mat(q);
    face(bodies, index, rotate(attitude, inertia, joint, q, &frame, l, 0.5 * step, 0, turn.position));
    struct vec predicted = vec_axpy(l, 0.5, vec_from(record->turn));
    vec_store(spin_at(attitude, inertia, joint, &attitude->frame, predicted, turn.velocity), bodies->spin[index].w);
}

static int look_ahead_general(struct scree_bodies *bodies, int index, double step, const double gravity[3],
                              double margin) {
    struct scree_record *record = &bodies->record[index];
    const struct scree_state *state = &bodies->state[index];
    const struct scree_inertia *inertia = &scree_kind_of(bodies, index)->inertia;
    const scree_joint *joint = &scree_kind_of(bodies, index)->joint;
    struct vec before = vec_from(record->x);
    for (int k = 0; k < 3; k++) {
        if (joint->along[k] == SCREE_DRIVEN) {
            record->x[k] = scree_kind_of(bodies, index)->origin[k] + bodies->moved[joint->along_motion[k]].position;
            record->v[k] = bodies->moved[joint->along_motion[k]].velocity;
        } else if (joint->along[k] == SCREE_FREE) {
            record->x[k] = bodies->position[index][k] + 0.5 * step * state->v[k];
            record->v[k] = state->v[k] + 0.5 * (inertia->inverse_mass[k] * record->impulse[k] + step * gravity[k]);
        }
    }
    look_ahead_turn(bodies, index, step);
    clear_loads(record);
    /* A plane turns about its normal only, so its turning moves no surface. */
    double reach = scree_kind_of(bodies, index)->shape.kind == SCREE_PLANE ? 0.0 : record->bound;
    double way = vec_norm(vec_sub(vec_from(record->x), before)) + step * vec_norm(scree_spin_of(bodies, index)) * reach;
    return scree_outgrown(&bodies->path[index], way, margin, 0.5);
}

int scree_bodies_look_ahead(struct scree_bodies *bodies, int count, double time, double step, const double gravity[3],
                            double margin) {
    int too_far = 0;
    drive_to(bodies, time + 0.5 * step);
    /* Nobody looks at the loads of fixed bodies; they pile up unseen. */
    for (int k = 0; k < count; k++) {
        if (bodies->class[k] == SCREE_CLASS_BALL) {
            double square = scree_ball_look_ahead(&bodies->record[k], &bodies->spin[k],
                                                  scree_ball_rows(&bodies->state[k], bodies->position[k]), step,
                                                  scree_row_of(gravity), scree_flight_row(bodies, k));
            too_far |= scree_outgrown(&bodies->path[k], step * sqrt(square), margin, 0.5);
        } else if (bodies->class[k] == SCREE_CLASS_GENERAL) {
            too_far |= look_ahead_general(bodies, k, step, gravity, margin);
        }
    }
    return too_far;
}

static void advance_turn(struct scree_bodies *bodies, int index, double step) {
    const scree_joint *joint = &scree_kind_of(bodies, index)->joint;
    if (joint->turn == SCREE_FIXED) return;
    struct scree_state *state = &bodies->state[index];
    struct scree_attitude *attitude = scree_attitude_of(bodies, index);
    double angle = joint->turn == SCREE_DRIVEN ? bodies->moved[joint->turn_motion].position : 0.0;
    for (int k = 0; joint->turn == SCREE_FREE && k < 3; k++)
        state->l[k] = scree_settle(state->l[k] + bodies->record[index].turn[k]);
    struct quat q = rotate(attitude, &scree_kind_of(bodies, index)->inertia, joint, attitude->ahead, &attitude->frame,
                           vec_from(state->l), 0.5 * step, 1, angle);
    quat_store(q, attitude->q);
}

static void advance_general(struct scree_bodies *bodies, int index, double step, const double gravity[3]) {
    const struct scree_record *record = &bodies->record[index];
    struct scree_state *state = &bodies->state[index];
    const scree_joint *joint = &scree_kind_of(bodies, index)->joint;
    for (int k = 0; k < 3; k++) {
        if (joint->along[k] == SCREE_DRIVEN) {
            bodies->position[index][k] =
                scree_kind_of(bodies, index)->origin[k] + bodies->moved[joint->along_motion[k]].position;
            state->v[k] = bodies->moved[joint->along_motion[k]].velocity;
        } else if (joint->along[k] == SCREE_FREE) {
            state->v[k] =
                scree_settle(state->v[k] + (scree_kind_of(bodies, index)->inertia.inverse_mass[k] * record->impulse[k] +
                                            step * gravity[k]));
            bodies->position[index][k] = record->x[k] + 0.5 * step * state->v[k];
        }
    }
    advance_turn(bodies, index, step);
}

void scree_bodies_advance(struct scree_bodies *bodies, int count, double time, double step, const double gravity[3]) {
    drive_to(bodies, time + step);
    for (int k = 0; k < count; k++) {
        if (bodies->class[k] == SCREE_CLASS_BALL)
            scree_ball_stay(scree_ball_advance(&bodies->record[k], &bodies->state[k], step, scree_row_of(gravity)),
                            bodies->position[k]);
        else if (bodies->class[k] == SCREE_CLASS_GENERAL)
            advance_general(bodies, k, step, gravity);
    }
}

void scree_bodies_find_positions(struct scree_bodies *bodies, int from, int to, double step) {
    for (int k = from; k < to; k++)
        for (int axis = 0; axis < 3 && bodies->class[k] == SCREE_CLASS_BALL; axis++)
            bodies->position[k][axis] = bodies->record[k].x[axis] - 0.5 * step * bodies->state[k].v[axis];
}

struct vec scree_bodies_spin(const struct scree_bodies *bodies, int index, double time) {
    const struct scree_inertia *inertia = &scree_kind_of(bodies, index)->inertia;
    const scree_joint *joint = &scree_kind_of(bodies, index)->joint;
    struct vec l = vec_from(bodies->state[index].l);
    if (scree_kind_of(bodies, index)->slot < 0) return vec_scale(inertia->inverse_moments[0], l);
    const struct scree_attitude *attitude = scree_attitude_of(bodies, index);
    struct mat frame = quat_to_mat(quat_from(attitude->q));
    double rate = 0.0;
    if (joint->turn == SCREE_DRIVEN) rate = scree_motion_at(&bodies->motion[joint->turn_motion], time).velocity;
    return spin_at(attitude, inertia, joint, &frame, l, rate);
}

static void look_now(const struct scree_bodies *bodies, int index, double time, struct scree_bodies *shadow) {
    struct scree_record *record = &shadow->record[index];
    memcpy(record->x, bodies->position[index], sizeof record->x);
    memcpy(record->v, bodies->state[index].v, sizeof record->v);
    vec_store(scree_bodies_spin(bodies, index, time), shadow->spin[index].w);
    clear_loads(record);
    if (scree_kind_of(shadow, index)->slot >= 0) face(shadow, index, quat_from(scree_attitude_of(shadow, index)->q));
}

void scree_bodies_look_now(const struct scree_bodies *bodies, double time, struct scree_bodies *shadow) {
    for (int k = 0; shadow != bodies && k < bodies->count; k++) {
        shadow->record[k] = bodies->record[k];
        shadow->spin[k] = bodies->spin[k];
    }
    for (int k = 0; shadow != bodies && k < bodies->attitudes; k++) shadow->attitude[k] = bodies->attitude[k];
    for (int k = 0; k < bodies->count; k++) look_now(bodies, k, time, shadow);
}

void scree_body_look_now(const struct scree_bodies *bodies, int index, double time, struct scree_bodies *shadow) {
    int slot = scree_kind_of(bodies, index)->slot;
    shadow->record[index] = bodies->record[index];
    shadow->spin[index] = bodies->spin[index];
    if (slot >= 0) shadow->attitude[slot] = bodies->attitude[slot];
    look_now(bodies, index, time, shadow);
}

int scree_body_look_ahead(struct scree_bodies *bodies, int index, double step, const double gravity[3], double margin) {
    if (bodies->class[index] == SCREE_CLASS_FIXED) return 0;
    return look_ahead_general(bodies, index, step, gravity, margin);
}

void scree_bodies_start(struct scree_bodies *bodies, double time) {
    drive_to(bodies, time);
    for (int k = 0; k < bodies->count; k++) {
        const scree_joint *joint = &scree_kind_of(bodies, k)->joint;
        for (int axis = 0; axis < 3; axis++) {
            if (joint->along[axis] != SCREE_DRIVEN) continue;
            bodies->position[k][axis] =
                scree_kind_of(bodies, k)->origin[axis] + bodies->moved[joint->along_motion[axis]].position;
            bodies->state[k].v[axis] = bodies->moved[joint->along_motion[axis]].velocity;
        }
        if (joint->turn != SCREE_DRIVEN) continue;
        struct scree_attitude *attitude = scree_attitude_of(bodies, k);
        struct quat turned = turn_about(vec_from(attitude->axis), bodies->moved[joint->turn_motion].position);
        quat_store(quat_multiply(turned, quat_from(attitude->start)), attitude->q);
    }
    scree_bodies_look_now(bodies, time, bodies);
}
