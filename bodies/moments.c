/* How bodies move by impulses and their first moments, and what pairs have to know of them beforehand: the part of the
 * bodies, but for free balls (pushed.h), in the pair-impulse method. */
#include "bodies/pushed.h"
#include "bodies/turning.h"

#include <string.h>

/* One free coordinate, from where it is at mid-step by its velocity at the start. */
static inline void advance_along(int k, const struct scree_record *record, const double moment[3],
                                 struct scree_state *state, double x[3], const struct scree_inertia *inertia,
                                 double step, const double gravity[3]) {
    double before = state->v[k], inverse_mass = inertia->inverse_mass[k];
    state->v[k] = scree_settle(before + (inverse_mass * record->impulse[k] + step * gravity[k]));
    x[k] = record->x[k] + (0.5 * step * before + (inverse_mass * moment[k] + 0.5 * step * step * gravity[k]));
}

static void turn_by_moments(struct scree_bodies *bodies, int index, double step) {
    const scree_joint *joint = &scree_kind_of(bodies, index)->joint;
    if (joint->turn == SCREE_FIXED) return;
    struct scree_state *state = &bodies->state[index];
    struct scree_attitude *attitude = scree_attitude_of(bodies, index);
    double angle = joint->turn == SCREE_DRIVEN ? bodies->moved[joint->turn_motion].position : 0.0;
    struct vec second = vec_axpy(vec_from(state->l), 2.0 / step, vec_from(attitude->turn_moment));
    struct quat q = rotate(attitude, &scree_kind_of(bodies, index)->inertia, joint, attitude->ahead, &attitude->frame,
                           second, 0.5 * step, 1, angle);
    for (int k = 0; joint->turn == SCREE_FREE && k < 3; k++)
        state->l[k] = scree_settle(state->l[k] + bodies->record[index].turn[k]);
    quat_store(q, attitude->q);
}

static void advance_one(struct scree_bodies *bodies, int index, double step, const double gravity[3]) {
    const struct scree_record *record = &bodies->record[index];
    struct scree_state *state = &bodies->state[index];
    const struct scree_kind *kind = scree_kind_of(bodies, index);
    double *x = bodies->position[index];
    for (int k = 0; k < 3; k++) {
        if (kind->joint.along[k] == SCREE_DRIVEN) {
            x[k] = kind->origin[k] + bodies->moved[kind->joint.along_motion[k]].position;
            state->v[k] = bodies->moved[kind->joint.along_motion[k]].velocity;
        } else if (kind->joint.along[k] == SCREE_FREE) {
            advance_along(k, record, bodies->moment[index], state, x, &kind->inertia, step, gravity);
        }
    }
    turn_by_moments(bodies, index, step);
    scree_settle_past(&bodies->past[index], record);
}

/* The next body from k on that isn't a free ball, which most are: eight are passed by at once. The number of bodies if
 * there is none. */
static int next_other(const struct scree_bodies *bodies, int k) {
    static const unsigned char balls[8] = {SCREE_CLASS_BALL, SCREE_CLASS_BALL, SCREE_CLASS_BALL, SCREE_CLASS_BALL,
                                           SCREE_CLASS_BALL, SCREE_CLASS_BALL, SCREE_CLASS_BALL, SCREE_CLASS_BALL};
    const unsigned char *class = bodies->class;
    while (k + 8 <= bodies->count && memcmp(&class[k], balls, sizeof balls) == 0) k += 8;
    while (k < bodies->count && class[k] == SCREE_CLASS_BALL) k++;
    return k;
}

void scree_bodies_advance_by_moments(struct scree_bodies *bodies, double time, double step, const double gravity[3]) {
    drive_to(bodies, time + step);
    for (int k = next_other(bodies, 0); k < bodies->count; k = next_other(bodies, k + 1))
        if (bodies->class[k] != SCREE_CLASS_FIXED) advance_one(bodies, k, step, gravity);
}

/* Accelerations in the coming step that no contact causes; motions are at its end, `now` at its start. */
static void know(const struct scree_bodies *bodies, const struct scree_bodies *now, int index, double step,
                 const double gravity[3], struct scree_past *past) {
    const scree_joint *joint = &scree_kind_of(bodies, index)->joint;
    const struct scree_record *record = &now->record[index];
    for (int k = 0; k < 3; k++) {
        if (joint->along[k] == SCREE_FREE) past->known[k] = gravity[k];
        if (joint->along[k] == SCREE_DRIVEN)
            past->known[k] = (bodies->moved[joint->along_motion[k]].velocity - record->v[k]) / step;
    }
    if (scree_kind_of(bodies, index)->slot < 0 || joint->turn == SCREE_FIXED) return;
    const struct scree_attitude *attitude = scree_attitude_of(now, index);
    struct vec spin = scree_spin_of(now, index), turn = {0.0, 0.0, 0.0};
    if (joint->turn == SCREE_DRIVEN) {
        struct vec later = vec_scale(bodies->moved[joint->turn_motion].velocity, vec_from(attitude->axis));
        turn = vec_scale(1.0 / step, vec_sub(later, spin));
    } else if (attitude->inverse_hinge == 0.0) { /* Euler's equations */
        struct mat inverse = scree_bodies_inverse_inertia(now, index);
        turn = mat_apply(&inverse, vec_cross(vec_from(bodies->state[index].l), spin));
    }
    vec_store(turn, scree_attitude_of(bodies, index)->known_turn);
}

/* An upper bound, with room for rounding, of the way of a body's points in the step if the accelerations of the last
 * two steps go on or are extrapolated. */
static double range_of(const struct scree_bodies *bodies, const struct scree_bodies *now, int index, double step) {
    const struct scree_past *past = &bodies->past[index];
    const struct scree_record *record = &now->record[index];
    const struct scree_inertia *inertia = &scree_kind_of(bodies, index)->inertia;
    const double *inverse = inertia->inverse_moments;
    double spin = vec_norm(scree_spin_of(now, index)), mass = 0.0, known_turn = 0.0;
    double turn = fmax(inverse[0], fmax(inverse[1], inverse[2]));
    if (scree_kind_of(bodies, index)->slot >= 0) {
        turn = fmax(turn, scree_attitude_of(bodies, index)->inverse_hinge);
        known_turn = vec_norm(vec_from(scree_attitude_of(bodies, index)->known_turn));
    }
    for (int k = 0; k < 3; k++) mass = fmax(mass, inertia->inverse_mass[k]);
    double push = 2.0 * vec_norm(vec_from(past->impulse[0])) + vec_norm(vec_from(past->impulse[1]));
    double twist = 2.0 * vec_norm(vec_from(past->turn[0])) + vec_norm(vec_from(past->turn[1]));
    double along = vec_norm(vec_from(record->v)) + mass * push + step * vec_norm(vec_from(past->known));
    double around = spin + turn * twist + step * (known_turn + spin * spin);
    /* A plane's turning about its normal moves no surface. */
    double reach = scree_kind_of(bodies, index)->shape.kind == SCREE_PLANE ? 0.0 : record->bound;
    return 2.0 * step * (along + around * reach);
}

struct scree_push scree_body_push(const struct scree_bodies *bodies, int index, double step) {
    struct scree_push push = {{0.0}, {0.0}, {0.0}, {0.0}};
    if (bodies->class[index] == SCREE_CLASS_FIXED) return push;
    const struct scree_past *past = &bodies->past[index];
    const double *mass = scree_kind_of(bodies, index)->inertia.inverse_mass,
                 moment = scree_kind_of(bodies, index)->inertia.inverse_moments[0];
    for (int k = 0; k < 3; k++) {
        push.along[k] = past->known[k] + mass[k] * past->impulse[0][k] / step;
        push.more[k] = mass[k] * (past->impulse[0][k] - past->impulse[1][k]) / step;
        push.turn[k] = moment * past->turn[0][k] / step;
        push.turn_more[k] = moment * (past->turn[0][k] - past->turn[1][k]) / step;
    }
    push.along[3] = past->range;
    push.more[3] = 1.0;
    push.turn[3] = moment;
    return push;
}

int scree_bodies_look_both(struct scree_bodies *bodies, double time, double step, const double gravity[3],
                           double margin, struct scree_bodies *now) {
    int too_far = 0;
    bodies->some_driven = 0;
    drive_to(bodies, time + step);
    for (int k = next_other(bodies, 0); k < bodies->count; k = next_other(bodies, k + 1)) {
        scree_body_look_now(bodies, k, time, now);
        /* Another order may have put it in the place of a ball. */
        bodies->glance[k] = (struct scree_glance){bodies->class[k] == SCREE_CLASS_FIXED ? 0.0F : INFINITY, 0};
        if (bodies->class[k] == SCREE_CLASS_FIXED) continue;
        bodies->some_driven = 1;
        know(bodies, now, k, step, gravity, &bodies->past[k]);
        bodies->past[k].range = range_of(bodies, now, k, step);
        memset(bodies->moment[k], 0, sizeof bodies->moment[k]);
        if (scree_kind_of(bodies, k)->slot < 0) continue;
        memset(scree_attitude_of(bodies, k)->turn_moment, 0, sizeof scree_attitude_of(bodies, k)->turn_moment);
    }
    drive_to(bodies, time + 0.5 * step);
    for (int k = next_other(bodies, 0); k < bodies->count; k = next_other(bodies, k + 1))
        too_far |= scree_body_look_ahead(bodies, k, step, gravity, margin);
    return too_far;
}

struct mat scree_bodies_inverse_inertia(const struct scree_bodies *bodies, int index) {
    const double *inverse = scree_kind_of(bodies, index)->inertia.inverse_moments;
    struct mat m = {{{inverse[0], 0.0, 0.0}, {0.0, inverse[0], 0.0}, {0.0, 0.0, inverse[0]}}};
    if (scree_kind_of(bodies, index)->slot < 0) return m;
    const struct scree_attitude *attitude = scree_attitude_of(bodies, index);
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
