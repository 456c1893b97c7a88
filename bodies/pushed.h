/* How a free ball goes through a step of the pair-impulse method: what pairs have to know of it beforehand, and how it
 * moves by their impulses (all other bodies: moments.c). On rows of four numbers, as in balls.h.
 *
 * Records show it in the middle of the step where its accelerations A_1 of the last step and A_2 of the one before,
 * extrapolated, take it in half a step:
 *
 *   x + h/2 v + h^2/8 A_1 + h^2/12 (A_1 - A_2),  v + h/2 A_1 + 3/8 h (A_1 - A_2)
 *
 * which is what contacts need that hardly change (contact/steady.c). Its start, and accelerations if all goes on as in
 * the last two steps, are what other contacts ask for: they are shown when a contact does, and kept nowhere. */
#ifndef SCREE_BODIES_PUSHED_H
#define SCREE_BODIES_PUSHED_H

#include "bodies/balls.h"

/* A bound of the way of a ball in the step, if the impulses (sizes, N s) of the last two go on or are extrapolated;
 * `fall`: size of gravity, m/s^2. Its own turning moves no surface. */
static inline double scree_ball_range(double speed, double inverse_mass, double last, double before, double fall,
                                      double step) {
    return 2.0 * step * (speed + inverse_mass * (2.0 * last + before) + step * fall);
}

static inline double scree_ball_range_of(const struct scree_bodies *bodies, int index, double step) {
    const struct scree_past *past = &bodies->past[index];
    return scree_ball_range(vec_norm(vec_from(bodies->state[index].v)), bodies->record[index].inverse_mass,
                            vec_norm(vec_from(past->impulse[0])), vec_norm(vec_from(past->impulse[1])),
                            vec_norm(vec_from(past->known)), step);
}

/* Of a ball whose impulse of the last step along the first axis was `last`, N s. The way is a looser bound than
 * scree_ball_range, without roots; `sizes`: the sum, along the axes, of those of speed + inverse mass * (2 * last +
 * before) + step * gravity, m/s. */
static inline struct scree_glance scree_glance_of(double sizes, double step, double last) {
    return (struct scree_glance){(float)(2.0 * step * sizes), scree_trace_of(last)};
}

/* The impulses of a step that is over become past. */
static inline void scree_settle_past(struct scree_past *past, const struct scree_record *record) {
    for (int k = 0; k < 3; k++) {
        past->impulse[1][k] = past->impulse[0][k];
        past->turn[1][k] = past->turn[0][k];
        past->impulse[0][k] = record->impulse[k];
        past->turn[0][k] = record->turn[k];
    }
}

#ifdef __AVX__
/* Impulses of the last step, and of the one before it; fourth numbers are as they come. */
struct scree_ball_past {
    scree_row impulse, turn, impulse_before, turn_before;
};

static inline struct scree_ball_past scree_ball_past_of(const struct scree_past *past) {
    return (struct scree_ball_past){*(const scree_row *)past->impulse[0], *(const scree_row *)past->turn[0],
                                    *(const scree_row *)past->impulse[1], *(const scree_row *)past->turn[1]};
}

/* Each row's fourth number is the next one's first: the last is that of what is known already. */
static inline void scree_keep_ball_past(struct scree_ball_past p, struct scree_past *past) {
    scree_row known = *(const scree_row *)past->known;
    *(scree_row *)past->impulse[0] = p.impulse;
    *(scree_row *)past->impulse[1] = p.impulse_before;
    *(scree_row *)past->turn[0] = p.turn;
    *(scree_row *)past->turn[1] = p.turn_before;
    *(scree_row *)past->known = known;
}

static inline scree_row scree_row_with(scree_row a, double fourth) {
    return __builtin_shufflevector(a, (scree_row){fourth, fourth, fourth, fourth}, 0, 1, 2, 7);
}

static inline double scree_row_square(scree_row a) { return a[0] * a[0] + a[1] * a[1] + a[2] * a[2]; }

/* The middle of the step. Returns the square of the speed off its flight, as scree_ball_look_ahead. */
static inline double scree_ball_foresee(struct scree_record *record, struct scree_spin *spin,
                                        struct scree_ball_rows rows, struct scree_ball_past p, double step,
                                        scree_row gravity, const float *flight) {
    const scree_row none = {0.0, 0.0, 0.0, 0.0};
    scree_row off = rows.v - scree_row_of_floats(flight), square = off * off;
    scree_row kick = scree_row_times(record->inverse_mass, p.impulse) + scree_row_times(step, gravity);
    scree_row more = scree_row_times(record->inverse_mass, p.impulse - p.impulse_before);
    scree_row ahead = rows.l + scree_row_times(0.5, p.turn) + scree_row_times(0.375, p.turn - p.turn_before);
    scree_row bent = scree_row_times(0.125 * step, kick) + scree_row_times(step * (1.0 / 12.0), more);
    scree_row_put(rows.x + (scree_row_times(0.5 * step, rows.v) + bent), record->x);
    scree_row_put(rows.v + (scree_row_times(0.5, kick) + scree_row_times(0.375, more)), record->v);
    scree_row_put(scree_row_times(record->inverse_moment, ahead), spin->w);
    scree_row_put(none, record->impulse);
    scree_row_put(none, record->turn);
    return square[0] + square[1] + square[2];
}

/* The start of the step, and what goes on as in the last two steps. Of `start` what contacts read is set. */
static inline void scree_ball_show(const struct scree_bodies *bodies, int index, double step,
                                   struct scree_record *start, struct scree_spin *spin, struct scree_push *push) {
    const struct scree_record *record = &bodies->record[index];
    const struct scree_past *past = &bodies->past[index];
    struct scree_ball_rows rows = scree_ball_rows(&bodies->state[index], bodies->position[index]);
    struct scree_ball_past p = scree_ball_past_of(past);
    const scree_row steps = {step, step, step, step}, gravity = scree_row_of(past->known);
    scree_row rate = (scree_row){record->inverse_mass, record->inverse_moment, 0.0, 0.0} / steps;
    *(scree_row *)start->x = scree_row_with(rows.x, record->radius);
    *(scree_row *)start->v = scree_row_with(rows.v, record->inverse_mass);
    *(scree_row *)spin->w = scree_row_with(scree_row_times(record->inverse_moment, rows.l), bodies->spin[index].limit);
    *(scree_row *)push->more = scree_row_with(scree_row_times(rate[0], p.impulse - p.impulse_before), 0.0);
    *(scree_row *)push->turn = scree_row_with(scree_row_times(rate[1], p.turn), record->inverse_moment);
    *(scree_row *)push->turn_more = scree_row_with(scree_row_times(rate[1], p.turn - p.turn_before), 0.0);
    scree_row square = {scree_row_square(rows.v), scree_row_square(p.impulse), scree_row_square(p.impulse_before),
                        scree_row_square(gravity)};
    scree_row size = scree_row_root(square);
    double range = scree_ball_range(size[0], record->inverse_mass, size[1], size[2], size[3], step);
    *(scree_row *)push->along = scree_row_with(gravity + scree_row_times(rate[0], p.impulse), range);
}

/* To the middle of the step. Nonzero if the path has outgrown the margin. */
static inline int scree_ball_look_on(struct scree_bodies *bodies, int index, struct scree_ball_rows rows,
                                     struct scree_ball_past p, double step, scree_row gravity, double margin) {
    const scree_row none = {0.0, 0.0, 0.0, 0.0};
    *(scree_row *)bodies->moment[index] = none;
    scree_row size =
        scree_row_size(rows.v) +
        scree_row_times(bodies->record[index].inverse_mass,
                        scree_row_times(2.0, scree_row_size(p.impulse)) + scree_row_size(p.impulse_before)) +
        scree_row_times(step, scree_row_size(gravity));
    *(scree_row *)bodies->past[index].known = gravity;
    bodies->glance[index] = scree_glance_of(size[0] + size[1] + size[2], step, p.impulse[0]);
    double square = scree_ball_foresee(&bodies->record[index], &bodies->spin[index], rows, p, step, gravity,
                                       scree_flight_row(bodies, index));
    return scree_outgrown(&bodies->path[index], step * sqrt(square), margin, 0.5);
}

static inline int scree_ball_look_both(struct scree_bodies *bodies, int index, double step, scree_row gravity,
                                       double margin) {
    struct scree_ball_rows rows = scree_ball_rows(&bodies->state[index], bodies->position[index]);
    struct scree_ball_past past = scree_ball_past_of(&bodies->past[index]);
    return scree_ball_look_on(bodies, index, rows, past, step, gravity, margin);
}

/* By impulses and moments to the end of the step. Returns the new state, and what is past now. */
static inline struct scree_ball_rows scree_ball_go_on(struct scree_bodies *bodies, int index, double step,
                                                      scree_row gravity, struct scree_ball_past *past) {
    const struct scree_record *record = &bodies->record[index];
    double *state = bodies->state[index].v;
    scree_row impulse = *(const scree_row *)record->impulse, turn = *(const scree_row *)record->turn;
    scree_row v = *(const scree_row *)state;
    scree_row moved = scree_row_times(record->inverse_mass, *(const scree_row *)bodies->moment[index]) +
                      scree_row_times(0.5 * step * step, gravity);
    scree_row half = scree_row_times(0.5 * step, v),
              x = (scree_row_of(bodies->position[index]) + half) + (half + moved);
    scree_row l = scree_row_settle(scree_row_behind(state) + turn);
    v = scree_row_settle(v + (scree_row_times(record->inverse_mass, impulse) + scree_row_times(step, gravity)));
    *(scree_row *)state = v; /* in this order: its fourth number isn't that of the momentum */
    *(scree_row *)&state[2] = __builtin_shufflevector(v, l, 2, 4, 5, 6);
    struct scree_ball_past before = scree_ball_past_of(&bodies->past[index]);
    *past = (struct scree_ball_past){impulse, turn, before.impulse, before.turn};
    scree_keep_ball_past(*past, &bodies->past[index]);
    struct scree_ball_rows rows = {x, v, l};
    scree_ball_stay(rows, bodies->position[index]);
    return rows;
}

static inline void scree_ball_advance_by_moments(struct scree_bodies *bodies, int index, double step,
                                                 scree_row gravity) {
    struct scree_ball_past past;
    scree_ball_go_on(bodies, index, step, gravity, &past);
}

/* Both, from one step into the next: a processor waits for rows that have just been written in pieces, so none is read
 * again. */
static inline int scree_ball_move_by_moments(struct scree_bodies *bodies, int index, double step, scree_row gravity,
                                             scree_row next, double margin) {
    struct scree_ball_past past;
    struct scree_ball_rows rows = scree_ball_go_on(bodies, index, step, gravity, &past);
    return scree_ball_look_on(bodies, index, rows, past, step, next, margin);
}

#else
/* Number by number: the same bits. */
static inline double scree_ball_foresee(struct scree_bodies *bodies, int index, double step, scree_row gravity,
                                        const float *flight) {
    struct scree_record *record = &bodies->record[index];
    const struct scree_past *past = &bodies->past[index];
    const struct scree_state *state = &bodies->state[index];
    double square = 0.0;
    for (int k = 0; k < 3; k++) {
        double v = state->v[k], off = v - (double)flight[k];
        double kick = record->inverse_mass * past->impulse[0][k] + step * gravity[k];
        double more = record->inverse_mass * (past->impulse[0][k] - past->impulse[1][k]);
        double ahead = state->l[k] + 0.5 * past->turn[0][k] + 0.375 * (past->turn[0][k] - past->turn[1][k]);
        double bent = 0.125 * step * kick + step * (1.0 / 12.0) * more;
        record->x[k] = bodies->position[index][k] + (0.5 * step * v + bent);
        record->v[k] = v + (0.5 * kick + 0.375 * more);
        bodies->spin[index].w[k] = record->inverse_moment * ahead;
        record->impulse[k] = record->turn[k] = 0.0;
        square = k ? square + off * off : off * off;
    }
    return square;
}

static inline void scree_ball_show(const struct scree_bodies *bodies, int index, double step,
                                   struct scree_record *start, struct scree_spin *spin, struct scree_push *push) {
    const struct scree_record *record = &bodies->record[index];
    const struct scree_state *state = &bodies->state[index];
    const struct scree_past *past = &bodies->past[index];
    double along = record->inverse_mass / step, turn = record->inverse_moment / step;
    for (int k = 0; k < 3; k++) {
        start->x[k] = bodies->position[index][k];
        start->v[k] = state->v[k];
        spin->w[k] = record->inverse_moment * state->l[k];
        push->along[k] = past->known[k] + along * past->impulse[0][k];
        push->more[k] = along * (past->impulse[0][k] - past->impulse[1][k]);
        push->turn[k] = turn * past->turn[0][k];
        push->turn_more[k] = turn * (past->turn[0][k] - past->turn[1][k]);
    }
    start->radius = record->radius;
    start->inverse_mass = record->inverse_mass;
    spin->limit = bodies->spin[index].limit;
    push->turn[3] = record->inverse_moment;
    push->more[3] = 0.0;
    push->along[3] = scree_ball_range_of(bodies, index, step);
}

static inline int scree_ball_look_both(struct scree_bodies *bodies, int index, double step, scree_row gravity,
                                       double margin) {
    struct scree_past *past = &bodies->past[index];
    double sizes = 0.0;
    for (int k = 0; k < 3; k++) {
        double pushed = 2.0 * fabs(past->impulse[0][k]) + fabs(past->impulse[1][k]);
        double size = fabs(bodies->state[index].v[k]) + bodies->record[index].inverse_mass * pushed;
        sizes += size + step * fabs(gravity[k]);
        bodies->moment[index][k] = 0.0;
        past->known[k] = gravity[k];
    }
    bodies->glance[index] = scree_glance_of(sizes, step, past->impulse[0][0]);
    double square = scree_ball_foresee(bodies, index, step, gravity, scree_flight_row(bodies, index));
    return scree_outgrown(&bodies->path[index], step * sqrt(square), margin, 0.5);
}

static inline void scree_ball_advance_by_moments(struct scree_bodies *bodies, int index, double step,
                                                 scree_row gravity) {
    const struct scree_record *record = &bodies->record[index];
    const double *moment = bodies->moment[index];
    struct scree_state *state = &bodies->state[index];
    double inverse_mass = record->inverse_mass;
    for (int k = 0; k < 3; k++) {
        double before = state->v[k], v = before + (inverse_mass * record->impulse[k] + step * gravity[k]);
        double l = state->l[k] + record->turn[k];
        state->v[k] = scree_settle(v);
        state->l[k] = scree_settle(l);
        double half = 0.5 * step * before;
        bodies->position[index][k] =
            (bodies->position[index][k] + half) + (half + (inverse_mass * moment[k] + 0.5 * step * step * gravity[k]));
    }
    scree_settle_past(&bodies->past[index], record);
}

static inline int scree_ball_move_by_moments(struct scree_bodies *bodies, int index, double step, scree_row gravity,
                                             scree_row next, double margin) {
    scree_ball_advance_by_moments(bodies, index, step, gravity);
    return scree_ball_look_both(bodies, index, step, next, margin);
}
#endif

#endif
