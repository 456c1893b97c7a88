/* How bodies move by impulses and their first moments, and what pairs have to know of them beforehand: the bodies' part
 * of the pair-impulse method. */
#include "bodies/balls.h"
#include "bodies/turning.h"

#include <string.h>

static void settle_past(struct scree_past *past, const struct scree_record *record) {
    memcpy(past->f[1], past->f[0], sizeof past->f[0]);
    memcpy(past->t[1], past->t[0], sizeof past->t[0]);
    memcpy(past->f[0], record->f, sizeof past->f[0]);
    memcpy(past->t[0], record->t, sizeof past->t[0]);
}

/* One free coordinate, from where it is at mid-step by its velocity at the start. */
static inline void advance_along(int k, const struct scree_record *record, const double moment[3],
                                 struct scree_state *state, double x[3], const struct scree_inertia *inertia,
                                 double step, const double gravity[3]) {
    double before = state->v[k], inverse_mass = inertia->inverse_mass[k];
    state->v[k] = settle(before + (inverse_mass * record->f[k] + step * gravity[k]));
    x[k] = record->x[k] + (0.5 * step * before + (inverse_mass * moment[k] + 0.5 * step * step * gravity[k]));
}

static void advance_ball(const struct scree_record *record, const double moment[3], struct scree_state *state,
                         double x[3], double step, const double gravity[3]) {
    for (int k = 0; k < 3; k++) {
        double before = state->v[k], inverse_mass = record->inverse_mass;
        state->v[k] = settle(before + (inverse_mass * record->f[k] + step * gravity[k]));
        x[k] = record->x[k] + (0.5 * step * before + (inverse_mass * moment[k] + 0.5 * step * step * gravity[k]));
        state->l[k] = settle(state->l[k] + record->t[k]);
    }
}

static void turn_by_moments(struct scree_bodies *bodies, int index, double step) {
    const scree_joint *joint = &scree_kind_of(bodies, index)->joint;
    if (joint->turn == SCREE_FIXED) return;
    struct scree_state *state = &bodies->state[index];
    struct scree_attitude *attitude = scree_attitude_of(bodies, index);
    double angle = joint->turn == SCREE_DRIVEN ? bodies->moved[joint->turn_motion].position : 0.0;
    struct vec second = vec_axpy(vec_from(state->l), 2.0 / step, vec_from(bodies->past[index].turn_moment));
    struct quat q = rotate(attitude, &scree_kind_of(bodies, index)->inertia, joint, attitude->ahead, &attitude->frame,
                           second, 0.5 * step, 1, angle);
    for (int k = 0; joint->turn == SCREE_FREE && k < 3; k++)
        state->l[k] = settle(state->l[k] + bodies->record[index].t[k]);
    quat_store(q, attitude->q);
}

enum { FEW = 1000 }; /* bodies for which a team of threads doesn't pay */

static void advance_one(struct scree_bodies *bodies, int index, double step, const double gravity[3]) {
    const struct scree_record *record = &bodies->record[index];
    const double *moment = bodies->push[index].moment;
    struct scree_past *past = &bodies->past[index];
    struct scree_state *state = &bodies->state[index];
    const struct scree_kind *kind = scree_kind_of(bodies, index);
    double *x = bodies->position[index];
    if (bodies->class[index] == SCREE_CLASS_FIXED) return;
    if (bodies->class[index] == SCREE_CLASS_BALL) {
        advance_ball(record, moment, state, x, step, gravity);
        settle_past(past, record);
        return;
    }
    for (int k = 0; k < 3; k++) {
        if (kind->joint.along[k] == SCREE_DRIVEN) {
            x[k] = kind->origin[k] + bodies->moved[kind->joint.along_motion[k]].position;
            state->v[k] = bodies->moved[kind->joint.along_motion[k]].velocity;
        } else if (kind->joint.along[k] == SCREE_FREE) {
            advance_along(k, record, moment, state, x, &kind->inertia, step, gravity);
        }
    }
    turn_by_moments(bodies, index, step);
    settle_past(past, record);
}

/* One thread has a loop of its own: a parallel region takes longer than a few bodies, even with a team of one. */
void scree_bodies_advance_by_moments(struct scree_bodies *bodies, double time, double step, const double gravity[3],
                                     int threads) {
    drive_to(bodies, time + step);
    if (threads > 1 && bodies->count > FEW) {
#pragma omp parallel for schedule(static) num_threads(threads)
        for (int k = 0; k < bodies->count; k++) advance_one(bodies, k, step, gravity);
    } else {
        for (int k = 0; k < bodies->count; k++) advance_one(bodies, k, step, gravity);
    }
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
    vec_store(turn, past->known_turn);
}

/* An upper bound, with room for rounding, of the way of a body's points in the step if the accelerations of the last
 * two steps go on or are extrapolated. */
static double range_of(const struct scree_bodies *bodies, const struct scree_bodies *now, int index, double step) {
    const struct scree_past *past = &bodies->past[index];
    const struct scree_record *record = &now->record[index];
    const struct scree_inertia *inertia = &scree_kind_of(bodies, index)->inertia;
    const double *inverse = inertia->inverse_moments;
    double spin = vec_norm(scree_spin_of(now, index)), mass = 0.0;
    double turn = fmax(inverse[0], fmax(inverse[1], inverse[2]));
    if (scree_kind_of(bodies, index)->slot >= 0) turn = fmax(turn, scree_attitude_of(bodies, index)->inverse_hinge);
    for (int k = 0; k < 3; k++) mass = fmax(mass, inertia->inverse_mass[k]);
    double push = 2.0 * vec_norm(vec_from(past->f[0])) + vec_norm(vec_from(past->f[1]));
    double twist = 2.0 * vec_norm(vec_from(past->t[0])) + vec_norm(vec_from(past->t[1]));
    double along = vec_norm(vec_from(record->v)) + mass * push + step * vec_norm(vec_from(past->known));
    double around = spin + turn * twist + step * (vec_norm(vec_from(past->known_turn)) + spin * spin);
    /* A plane's turning about its normal moves no surface. */
    double reach = scree_kind_of(bodies, index)->shape.kind == SCREE_PLANE ? 0.0 : record->bound;
    return 2.0 * step * (along + around * reach);
}

/* What pairs read of the past. */
static void prepare_push(const struct scree_bodies *bodies, int index, double step) {
    const struct scree_past *past = &bodies->past[index];
    struct scree_push *push = &bodies->push[index];
    const double *mass = scree_kind_of(bodies, index)->inertia.inverse_mass,
                 moment = scree_kind_of(bodies, index)->inertia.inverse_moments[0];
    for (int k = 0; k < 3; k++) {
        push->along[k] = past->known[k] + mass[k] * past->f[0][k] / step;
        push->more[k] = mass[k] * (past->f[0][k] - past->f[1][k]) / step;
        push->turn[k] = moment * past->t[0][k] / step;
        push->turn_more[k] = moment * (past->t[0][k] - past->t[1][k]) / step;
        push->moment[k] = 0.0;
    }
    push->along[3] = past->range;
    push->turn[3] = moment;
}

/* All this for a ball: it starts from its state, gravity is all that is known, its own turning moves no surface. */
static void look_at_ball(const struct scree_bodies *bodies, int index, double step, const double gravity[3],
                         double fall, struct scree_record *now, struct scree_spin *spin) {
    const struct scree_record *record = &bodies->record[index];
    const struct scree_state *state = &bodies->state[index];
    const struct scree_past *past = &bodies->past[index];
    struct scree_push *push = &bodies->push[index];
    double along = record->inverse_mass / step, turn = record->inverse_moment / step;
    for (int k = 0; k < 3; k++) {
        now->x[k] = bodies->position[index][k];
        now->v[k] = state->v[k];
        spin->w[k] = record->inverse_moment * state->l[k];
        push->along[k] = gravity[k] + along * past->f[0][k];
        push->more[k] = along * (past->f[0][k] - past->f[1][k]);
        push->turn[k] = turn * past->t[0][k];
        push->turn_more[k] = turn * (past->t[0][k] - past->t[1][k]);
        push->moment[k] = 0.0;
    }
    now->radius = record->radius;
    now->inverse_mass = record->inverse_mass;
    spin->limit = bodies->spin[index].limit;
    now->bound = record->bound;
    double kicks = 2.0 * vec_norm(vec_from(past->f[0])) + vec_norm(vec_from(past->f[1]));
    push->along[3] = 2.0 * step * (vec_norm(vec_from(state->v)) + record->inverse_mass * kicks + step * fall);
    push->turn[3] = record->inverse_moment;
    bodies->past[index].range = push->along[3];
    memcpy(bodies->past[index].known, gravity, sizeof past->known);
}

/* Bodies that aren't balls. */
static int look_at_others(struct scree_bodies *bodies, double time, double step, const double gravity[3], double margin,
                          struct scree_bodies *now) {
    int too_far = 0;
    drive_to(bodies, time + step);
    for (int k = 0; k < bodies->count; k++) {
        if (bodies->class[k] == SCREE_CLASS_BALL) continue;
        scree_body_look_now(bodies, k, time, now);
        if (bodies->class[k] == SCREE_CLASS_FIXED) { /* another order may have put it in the place of a ball */
            bodies->push[k] = (struct scree_push){{0.0}, {0.0}, {0.0}, {0.0}, {0.0}};
            continue;
        }
        know(bodies, now, k, step, gravity, &bodies->past[k]);
        bodies->past[k].range = range_of(bodies, now, k, step);
        prepare_push(bodies, k, step);
        memset(bodies->past[k].turn_moment, 0, sizeof bodies->past[k].turn_moment);
    }
    drive_to(bodies, time + 0.5 * step);
    for (int k = 0; k < bodies->count; k++)
        if (bodies->class[k] != SCREE_CLASS_BALL) too_far |= scree_body_look_ahead(bodies, k, step, gravity, margin);
    return too_far;
}

static int look_both_ways(struct scree_bodies *bodies, int k, double step, const double gravity[3], double fall,
                          double margin, struct scree_bodies *now) {
    if (bodies->class[k] != SCREE_CLASS_BALL) return 0;
    look_at_ball(bodies, k, step, gravity, fall, &now->record[k], &now->spin[k]);
    double square = scree_ball_look_ahead(&bodies->record[k], &bodies->spin[k],
                                          scree_ball_rows(&bodies->state[k], bodies->position[k]), step,
                                          scree_row_of(gravity), scree_flight_row(bodies, k));
    return scree_outgrown(&bodies->path[k], step * sqrt(square), margin);
}

int scree_bodies_look_both(struct scree_bodies *bodies, double time, double step, const double gravity[3],
                           double margin, struct scree_bodies *now, int threads) {
    double fall = vec_norm(vec_from(gravity));
    int too_far = 0;
    now->push = bodies->push;
    if (threads > 1 && bodies->count > FEW) {
#pragma omp parallel for schedule(static) num_threads(threads)
        for (int k = 0; k < bodies->count; k++)
            if (look_both_ways(bodies, k, step, gravity, fall, margin, now))
                __atomic_store_n(&too_far, 1, __ATOMIC_RELAXED);
    } else {
        for (int k = 0; k < bodies->count; k++) too_far |= look_both_ways(bodies, k, step, gravity, fall, margin, now);
    }
    return too_far | look_at_others(bodies, time, step, gravity, margin, now);
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
