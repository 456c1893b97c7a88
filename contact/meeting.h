/* The way of smooth.c's lanes into the step and out of it: where two bodies meet, what drives them besides their
 * contact, what is kept of it; then impulses and torques of what it yields. One loop over the lanes each. */
#ifndef SCREE_CONTACT_MEETING_H
#define SCREE_CONTACT_MEETING_H

#include "contact/lane.h"

/* Both bodies are balls, or one is frozen. */
static inline int is_plain(const struct scree_bodies *bodies, const struct scree_ends *contact) {
    enum scree_body_class ball = bodies->class[contact->ball], host = bodies->class[contact->host];
    return (ball == SCREE_CLASS_BALL && host != SCREE_CLASS_GENERAL) ||
           (ball == SCREE_CLASS_FIXED && host == SCREE_CLASS_BALL);
}

/* ---- gather ---- */

/* Where contacts are, and what bodies do by themselves (scree_push; differences of ball and host where that is
 * enough). Balls of one size have one arm, and only sums of their spins and of what turns them count: there is no
 * column of the host. */
struct meeting {
    double later_n[3][SCREE_LANES];                              /* normal in the middle of the step */
    double arm[SCREE_LANES], host_arm[SCREE_LANES];              /* from the centres to the contact at the start, m */
    double last[3][SCREE_LANES], before[3][SCREE_LANES];         /* impulses of the last two steps, N s */
    double last_depth[SCREE_LANES], depth_before[SCREE_LANES];   /* and the overlaps that friction had on the mean, m */
    double kept[2][SCREE_LANES];                                 /* what the normal law remembers */
    double along[3][SCREE_LANES], more[4][SCREE_LANES];          /* m/s^2; more than 0 if one isn't a ball */
    double ball_turn[4][SCREE_LANES], host_turn[4][SCREE_LANES]; /* rad/s^2; 1/(kg m^2) */
    double ball_more[3][SCREE_LANES], host_more[3][SCREE_LANES];
};

/* Masses and radii count of balls of one size, too (unlike in fetch). */
static inline void fetch_motions(const struct ends *ends, int count, int balls, int even, struct block *b) {
    for (int lane = 0; lane < padded(count); lane += WIDTH) {
        fetch_way(ends, lane, 0, b);
        fetch_turning(ends, lane, even, b);
        if (balls) measure_next(b, lane, padded(count));
    }
}

/* Lanes lane … lane + WIDTH - 1 of contacts between such bodies; padding repeats the last. */
static inline const struct scree_ends *ends_at(const struct scree_ends *contact, int count, int lane) {
    return &contact[lane < count ? lane : count - 1];
}

#ifdef __AVX512F__
static SCREE_INLINE wide_row wide_at(const double *rows) { return *(const wide_row *)rows; }

static inline void put_turns(wide_row r[8], int lane, double (*turn)[SCREE_LANES], double (*more)[SCREE_LANES]) {
    transpose_wide(r);
    store_wide(r, 4, turn, lane);
    store_wide(r + 4, 3, more, lane);
}

static inline void fetch_some_pushes(const struct scree_push *push, const struct scree_ends *contact, int count,
                                     int lane, int turns, int even, struct meeting *to) {
    const struct scree_push *ball[8], *host[8];
    wide_row r[8];
    for (int i = 0; i < 8; i++) {
        const struct scree_ends *ends = ends_at(contact, count, lane + i);
        ball[i] = &push[ends->ball];
        host[i] = &push[ends->host];
        r[i] = wide_at(ball[i]->along) - wide_turned(wide_at(host[i]->along));
    }
    transpose_wide(r);
    store_wide(r, 3, to->along, lane);
    store_wide(r + 4, 4, to->more, lane);
    if (!turns) return;
    for (int i = 0; i < 8; i++) {
        r[i] = wide_at(ball[i]->turn);
        if (even) r[i] += wide_at(host[i]->turn);
    }
    put_turns(r, lane, to->ball_turn, to->ball_more);
    if (even) return;
    for (int i = 0; i < 8; i++) r[i] = wide_at(host[i]->turn);
    put_turns(r, lane, to->host_turn, to->host_more);
}
#elif defined __AVX__
static inline void fetch_some_pushes(const struct scree_push *push, const struct scree_ends *contact, int count,
                                     int lane, int turns, int even, struct meeting *to) {
    const scree_row sign = {1.0, 1.0, 1.0, -1.0};
    scree_row row[6][4];
    for (int i = 0; i < 4; i++) {
        const struct scree_ends *ends = ends_at(contact, count, lane + i);
        const struct scree_push *ball = &push[ends->ball], *host = &push[ends->host];
        row[0][i] = *(const scree_row *)ball->along - *(const scree_row *)host->along;
        row[1][i] = *(const scree_row *)ball->more - *(const scree_row *)host->more * sign;
        if (!turns) continue;
        row[2][i] = *(const scree_row *)ball->turn;
        row[3][i] = *(const scree_row *)ball->turn_more;
        row[4][i] = *(const scree_row *)host->turn;
        row[5][i] = *(const scree_row *)host->turn_more;
        if (!even) continue;
        row[2][i] += row[4][i];
        row[3][i] += row[5][i];
    }
    store_columns(row[0], 3, to->along, lane);
    store_columns(row[1], 4, to->more, lane);
    if (!turns) return;
    store_columns(row[2], 4, to->ball_turn, lane);
    store_columns(row[3], 3, to->ball_more, lane);
    if (even) return;
    store_columns(row[4], 4, to->host_turn, lane);
    store_columns(row[5], 3, to->host_more, lane);
}
#else
static inline void fetch_some_pushes(const struct scree_push *push, const struct scree_ends *contact, int count,
                                     int lane, int turns, int even, struct meeting *to) {
    for (int i = 0; i < WIDTH; i++) {
        const struct scree_ends *ends = ends_at(contact, count, lane + i);
        const struct scree_push *ball = &push[ends->ball], *host = &push[ends->host];
        for (int k = 0; k < 3; k++) {
            to->along[k][lane + i] = ball->along[k] - host->along[k];
            to->more[k][lane + i] = ball->more[k] - host->more[k];
        }
        to->more[3][lane + i] = ball->more[3] + host->more[3];
        for (int k = 0; turns && k < 4; k++) {
            to->ball_turn[k][lane + i] = even ? ball->turn[k] + host->turn[k] : ball->turn[k];
            to->host_turn[k][lane + i] = host->turn[k];
        }
        for (int k = 0; turns && k < 3; k++) {
            to->ball_more[k][lane + i] = even ? ball->turn_more[k] + host->turn_more[k] : ball->turn_more[k];
            to->host_more[k][lane + i] = host->turn_more[k];
        }
    }
}
#endif

static inline void fetch_pushes(const struct scree_push *push, const struct scree_ends *contact, int count, int turns,
                                int even, struct meeting *to) {
    for (int lane = 0; lane < padded(count); lane += WIDTH)
        if (even)
            fetch_some_pushes(push, contact, count, lane, 1, 1, to);
        else
            fetch_some_pushes(push, contact, count, lane, turns, 0, to);
}

/* Numbers of one column, of contacts one after the other (`index` NULL) or here and there. */
static inline void fetch_column(const double *column, int first, const int *index, int count, double *to) {
    if (index) { /* padding repeats the last */
        for (int k = 0; k < padded(count); k++) to[k] = column[index[k < count ? k : count - 1]];
    } else {
        _Pragma("omp simd")
        for (int k = 0; k < padded(count); k++) to[k] = column[first + k];
    }
}

/* The same of friction's state, 0 or 1. */
static inline void fetch_state(const unsigned char *slides, int first, const int *index, int count, double *to) {
    if (index) {
        for (int k = 0; k < padded(count); k++) to[k] = (double)slides[index[k < count ? k : count - 1]];
    } else {
        _Pragma("omp simd")
        for (int k = 0; k < padded(count); k++) to[k] = (double)slides[first + k];
    }
}

/* What is kept of the contacts. */
static inline void fetch_kept(const struct scree_batch *batch, int first, const int *index, int count, int turns,
                              struct meeting *to, struct course *c, struct lane_constants *m) {
    for (int axis = 0; axis < 3; axis++) {
        fetch_column(batch->past[axis], first, index, count, to->last[axis]);
        fetch_column(batch->past[SCREE_PAST_STEP + axis], first, index, count, to->before[axis]);
    }
    fetch_column(batch->past[SCREE_PAST_DEPTH], first, index, count, to->last_depth);
    fetch_column(batch->past[SCREE_PAST_STEP + SCREE_PAST_DEPTH], first, index, count, to->depth_before);
    for (int i = 0; batch->kept[SCREE_KEPT_NORMAL] && i < 2; i++) {
        fetch_column(batch->kept[SCREE_KEPT_NORMAL + i], first, index, count, to->kept[i]);
        memcpy(c->kept[i], to->kept[i], sizeof c->kept[i]);
    }
    int columns = turns ? SCREE_PAIR_LEVER : SCREE_PAIR_FRICTION;
    for (int column = 0; column < columns; column++)
        fetch_column(batch->pair[column], batch->uniform ? 0 : first, batch->uniform ? NULL : index, count,
                     m->pair[column]);
    if (!turns) return;
    if (!batch->kept[0]) {
        memset(c->s, 0, sizeof c->s);
        memset(c->slides, 0, sizeof c->slides);
        return;
    }
    for (int axis = 0; axis < 3; axis++) fetch_column(batch->kept[axis], first, index, count, c->s[axis]);
    fetch_state(batch->slides, first, index, count, c->slides);
}

/* Levers of both bodies times what they do, summed. */
static SCREE_INLINE struct vec by_arms(const struct meeting *at, int k, int even, struct vec ball, struct vec host) {
    struct vec own = vec_scale(at->arm[k], ball);
    return even ? own : vec_axpy(own, at->host_arm[k], host);
}

/* Normal, arms and speeds at the start, normal in the middle. */
static SCREE_INLINE void meet_lane(struct block *b, int k, double step, int balls, int turns, struct sizes sizes,
                                   struct meeting *to, struct course *c, struct lane_constants *m) {
    struct vec n = get(b->n, k), shift = get(b->shift, k), rush = get(b->rush, k), later_n = n;
    double d = b->overlap[k], radii = radii_of(b, k, sizes), apart = vec_dot(shift, n);
    if (balls) {
        const struct vec origin = {0.0, 0.0, 0.0};
        n = scree_normal_of(shift, b->apart[k], b->inverse[k]);
        d = radii - b->apart[k];
        apart = radii - d;
        later_n = scree_meet_ball(vec_axpy(shift, 0.5 * step, rush), radii, origin, 0.0).normal;
        put(b->n, k, n);
        b->overlap[k] = d;
    }
    put(to->later_n, k, later_n);
    to->arm[k] = (sizes.even ? 0.5 * radii : b->radius[k]) - 0.5 * d;
    if (!sizes.even) to->host_arm[k] = apart - to->arm[k];
    c->d[k] = d;
    c->u[k] = -vec_dot(rush, n);
    m->give[k] = b->rush[3][k];
    m->give_aside[k] = m->give[k];
    if (!turns) return;
    struct vec spin = get(b->ball_spin, k), other = get(b->host_spin, k);
    struct vec slip = vec_sub(rush, vec_cross(by_arms(to, k, sizes.even, spin, other), n));
    put(c->v, k, vec_axpy(slip, -vec_dot(slip, n), n));
    put(c->q, k, vec_scale(0.5, vec_cross(sizes.even ? spin : vec_add(spin, other), n)));
    put(c->s, k, scree_turned(get(c->s, k), n, spins_at(b, k, sizes.even), step));
    double ball = to->arm[k] * to->ball_turn[3][k], host = to->host_arm[k] * to->host_turn[3][k];
    double by_turns = to->arm[k] * ball;
    m->give_aside[k] += sizes.even ? by_turns : by_turns + to->host_arm[k] * host;
    m->start[k] = d;
    m->lever[0][k] = sizes.even ? ball : ball + host;
    m->lever[1][k] = sizes.even ? to->ball_turn[3][k] : to->ball_turn[3][k] + to->host_turn[3][k];
}

/* The acceleration that isn't the pair's own: the rest of what the bodies do, and the turning of arms and normal. */
static SCREE_INLINE void drive_lane(struct block *b, int k, double step, int turns, int even, struct meeting *to,
                                    struct lane_constants *m) {
    struct vec n = get(b->n, k), later_n = get(to->later_n, k), rush = get(b->rush, k), last = get(to->last, k);
    double more = (0.15 - 0.5 * m->rate[k] * step) / 0.06, per_step = 1.0 / step;
    more = more > 0.0 ? more : 0.0;
    more = more < 1.0 ? more : 1.0;
    struct vec own = vec_axpy(last, more, vec_sub(last, get(to->before, k)));
    struct vec a = vec_axpy(get(to->along, k), more, get(to->more, k));
    struct vec sweep = vec_scale(2.0 * per_step, vec_sub(later_n, n)), slip = rush, gain = {0.0, 0.0, 0.0};
    a = vec_axpy(a, -m->give[k] * per_step, own);
    if (turns) {
        struct vec ball = vec_axpy(get(to->ball_turn, k), more, get(to->ball_more, k));
        struct vec host = vec_axpy(get(to->host_turn, k), more, get(to->host_more, k));
        a = vec_sub(a, vec_cross(by_arms(to, k, even, ball, host), n));
        /* Levers were longer by half of what the overlap has gained since. */
        double longer = 0.5 * (b->overlap[k] - to->last_depth[k]),
               before_that = 0.5 * (b->overlap[k] - to->depth_before[k]);
        struct vec mine = vec_scale(m->give_aside[k] - m->give[k], own);
        mine = vec_axpy(mine, m->lever[0][k] * longer * (1.0 + more), last);
        mine = vec_axpy(mine, -m->lever[0][k] * before_that * more, get(to->before, k));
        a = vec_axpy(a, -per_step, vec_axpy(mine, -vec_dot(mine, n), n));
        struct vec around = by_arms(to, k, even, get(b->ball_spin, k), get(b->host_spin, k));
        gain = vec_scale(-1.0, vec_cross(around, sweep));
        slip = vec_sub(rush, vec_cross(around, n));
    }
    /* (n x n') x v */
    gain = vec_sub(gain, vec_axpy(vec_scale(vec_dot(n, slip), sweep), -vec_dot(sweep, slip), n));
    a = vec_add(a, gain);
    m->closing[k] = -vec_dot(a, n);
    if (turns) put(m->aside, k, vec_axpy(a, m->closing[k], n));
}

/* ---- scatter ---- */

/* A vector of the tangent plane turns with the normal, from n to `later`. */
static SCREE_INLINE struct vec turn_over(struct vec v, struct vec axis, double cosine) {
    struct vec once = vec_cross(axis, v);
    return vec_axpy(vec_add(v, once), 1.0 / (1.0 + cosine), vec_cross(axis, once));
}

/* A contact to which nothing happens. */
static inline void yield_nothing(struct scree_yield *yield, struct scree_moments *moments, int lane) {
    struct vec zero = {0.0, 0.0, 0.0};
    put(yield->impulse, lane, zero);
    put(yield->turn_ball, lane, zero);
    put(yield->turn_host, lane, zero);
    put(moments->impulse, lane, zero);
    yield->depth[lane] = yield->steep[lane] = yield->lasts[lane] = 0.0;
    yield->lost.normal[lane] = yield->lost.tangential[lane] = 0.0;
}

/* Impulses in the directions of mid-step. */
static SCREE_INLINE void yield_lane(struct block *b, int k, int balls, int turns, int even, struct meeting *at,
                                    struct course *c, struct scree_yield *yield, struct scree_moments *moments) {
    struct vec later = get(at->later_n, k);
    struct vec j = vec_scale(c->press[k], later), m = vec_scale(c->press_moment[k], later);
    if (turns) {
        struct vec rub = get(c->rub, k), rub_moment = get(c->rub_moment, k), deep = get(c->deep, k);
        if (balls) {
            struct vec n = get(b->n, k), axis = vec_cross(n, later);
            double cosine = vec_dot(n, later);
            rub = turn_over(rub, axis, cosine);
            rub_moment = turn_over(rub_moment, axis, cosine);
            deep = turn_over(deep, axis, cosine);
        }
        j = vec_add(j, rub);
        m = vec_add(m, rub_moment);
        struct vec ball = vec_cross(vec_axpy(vec_scale(at->arm[k], rub), -0.5, deep), later), host = ball;
        if (!even) host = vec_cross(vec_axpy(vec_scale(at->host_arm[k], rub), -0.5, deep), later);
        put(yield->turn_ball, k, ball);
        put(yield->turn_host, k, host);
    }
    put(yield->impulse, k, j);
    put(moments->impulse, k, m);
}

#endif
