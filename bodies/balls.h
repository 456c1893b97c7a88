/* How free balls move alone: the two halves of the step (bodies.h), for one ball, on rows of four numbers at once. In a
 * header, so that whoever has the ball at hand can move it. */
#ifndef SCREE_BODIES_BALLS_H
#define SCREE_BODIES_BALLS_H

#include "bodies/bodies.h"

typedef double scree_row __attribute__((vector_size(32), aligned(8), may_alias));
typedef long long scree_bits __attribute__((vector_size(32), aligned(8), may_alias));

static inline scree_row scree_row_of(const double a[3]) { return (scree_row){a[0], a[1], a[2], 0.0}; }
static inline scree_row scree_row_times(double s, scree_row a) { return (scree_row){s, s, s, s} * a; }

/* A body that friction brings to rest slows down exponentially. Long before its speed could matter the squares of such
 * numbers become denormal, on which processors take a slow path; so numbers this small are zero. */
static const double scree_least_momentum = 1e-140;
static inline double scree_settle(double x) { return fabs(x) < scree_least_momentum ? 0.0 : x; }

/* Lengthen the path by the way of the last step; nonzero if the list may no longer hold when the contacts are measured
 * half a step from now (`to_come` 0.5), or in some of the steps after: then the path says so too. Written so that a NaN
 * counts as too far. */
static inline int scree_outgrown(double *path, double way, double margin, double to_come) {
    double gone = *path + way, soon = gone + to_come * way;
    int over = !(soon <= margin);
    *path = over ? soon : gone;
    return over;
}

#ifdef __AVX__
#include <immintrin.h> /* for what has no operator, or one of many instructions */
static inline scree_row scree_row_of_floats(const float a[4]) { return (scree_row)_mm256_cvtps_pd(_mm_loadu_ps(a)); }
static inline scree_row scree_row_root(scree_row a) { return (scree_row)_mm256_sqrt_pd((__m256d)a); }

/* The first three numbers of `a`, the fourth of `old`. */
static inline void scree_row_put(scree_row a, double *old) {
    *(scree_row *)old = __builtin_shufflevector(a, *(const scree_row *)old, 0, 1, 2, 7);
}

static inline scree_row scree_row_size(scree_row a) {
    const scree_bits sign = {INT64_MIN, INT64_MIN, INT64_MIN, INT64_MIN};
    return (scree_row)((scree_bits)a & ~sign);
}

static inline scree_row scree_row_settle(scree_row a) {
    const scree_row least = {scree_least_momentum, scree_least_momentum, scree_least_momentum, scree_least_momentum};
    return (scree_row)((scree_bits)a & ~(scree_bits)(scree_row_size(a) < least));
}

/* The rows of a state; fourth numbers are as they come. */
struct scree_ball_rows {
    scree_row x, v, l;
};

/* A state is six numbers: the row of its momentum is reached from the last of its velocity. */
static inline scree_row scree_row_behind(const double v[3]) {
    scree_row row = *(const scree_row *)&v[2];
    return __builtin_shufflevector(row, row, 1, 2, 3, 3);
}

static inline struct scree_ball_rows scree_ball_rows(const struct scree_state *state, const double position[3]) {
    return (struct scree_ball_rows){scree_row_of(position), *(const scree_row *)state->v, scree_row_behind(state->v)};
}

/* Let its position be known. */
static inline void scree_ball_stay(struct scree_ball_rows rows, double position[3]) {
    for (int k = 0; k < 3; k++) position[k] = rows.x[k];
}

/* Kick by the impulses in the record and by gravity at mid-step, and drift to the end of the step. Returns the new
 * state. */
static inline struct scree_ball_rows scree_ball_advance(const struct scree_record *record, struct scree_state *state,
                                                        double step, scree_row gravity) {
    const scree_row *impulse = (const scree_row *)record->impulse, *turn = (const scree_row *)record->turn;
    scree_row kick = scree_row_times(record->inverse_mass, *impulse) + scree_row_times(step, gravity);
    scree_row v = scree_row_settle(*(const scree_row *)state->v + kick);
    scree_row l = scree_row_settle(scree_row_behind(state->v) + *turn);
    scree_row x = *(const scree_row *)record->x + scree_row_times(0.5 * step, v);
    *(scree_row *)state->v = v; /* in this order: its fourth number isn't that of the momentum */
    *(scree_row *)&state->v[2] = __builtin_shufflevector(v, l, 2, 4, 5, 6);
    return (struct scree_ball_rows){x, v, l};
}

/* Drift to the middle of the next step, predict velocity and spin there, clear the impulses. Returns the square of the
 * speed off its flight, with which the path has yet to grow: roots are taken for many balls at once. */
static inline double scree_ball_look_ahead(struct scree_record *record, struct scree_spin *spin,
                                           struct scree_ball_rows state, double step, scree_row gravity,
                                           const float *flight) {
    const scree_row *impulse = (const scree_row *)record->impulse, *turn = (const scree_row *)record->turn;
    const scree_row none = {0.0, 0.0, 0.0, 0.0};
    scree_row off = state.v - scree_row_of_floats(flight), square = off * off;
    scree_row kick = scree_row_times(record->inverse_mass, *impulse) + scree_row_times(step, gravity);
    scree_row ahead = state.l + scree_row_times(0.5, *turn);
    scree_row_put(state.x + scree_row_times(0.5 * step, state.v), record->x);
    scree_row_put(state.v + scree_row_times(0.5, kick), record->v);
    scree_row_put(scree_row_times(record->inverse_moment, ahead), spin->w);
    scree_row_put(none, record->impulse);
    scree_row_put(none, record->turn);
    return square[0] + square[1] + square[2];
}

#else
/* Processors without such rows: number by number. The same bits. */
struct scree_ball_rows {
    const struct scree_state *state;
    double x[3];
};

static inline struct scree_ball_rows scree_ball_rows(const struct scree_state *state, const double position[3]) {
    return (struct scree_ball_rows){state, {position[0], position[1], position[2]}};
}

static inline void scree_ball_stay(struct scree_ball_rows rows, double position[3]) {
    for (int k = 0; k < 3; k++) position[k] = rows.x[k];
}

static inline struct scree_ball_rows scree_ball_advance(const struct scree_record *record, struct scree_state *state,
                                                        double step, scree_row gravity) {
    struct scree_ball_rows rows = {.state = state};
    for (int k = 0; k < 3; k++) {
        double v = state->v[k] + (record->inverse_mass * record->impulse[k] + step * gravity[k]),
               l = state->l[k] + record->turn[k];
        state->v[k] = scree_settle(v);
        rows.x[k] = record->x[k] + 0.5 * step * state->v[k];
        state->l[k] = scree_settle(l);
    }
    return rows;
}

static inline double scree_ball_look_ahead(struct scree_record *record, struct scree_spin *spin,
                                           struct scree_ball_rows rows, double step, scree_row gravity,
                                           const float *flight) {
    const struct scree_state *state = rows.state;
    const double *v = state->v;
    for (int k = 0; k < 3; k++) {
        double kick = record->inverse_mass * record->impulse[k] + step * gravity[k];
        record->x[k] = rows.x[k] + 0.5 * step * v[k];
        record->v[k] = v[k] + 0.5 * kick;
        spin->w[k] = record->inverse_moment * (state->l[k] + 0.5 * record->turn[k]);
        record->impulse[k] = record->turn[k] = 0.0;
    }
    double x = v[0] - (double)flight[0], y = v[1] - (double)flight[1], z = v[2] - (double)flight[2];
    return x * x + y * y + z * z;
}
#endif

#endif
