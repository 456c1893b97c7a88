/* A block of contacts on its way through the loop, and how it is gathered from the bodies: rows of records are fetched and turned into
 * columns, from which normal, overlap, arms, relative velocity follow. Part of loop.c. */
#ifndef SCREE_CONTACT_BLOCK_H
#define SCREE_CONTACT_BLOCK_H

#include "bodies/balls.h"
#include "contact/meet.h"

/* Contacts that one instruction takes: passes run over full vectors. */
#ifdef __AVX512F__
enum { WIDTH = 8 };
#else
enum { WIDTH = 4 };
#endif
static int padded(int count) { return (count + WIDTH - 1) & -WIDTH; }

#ifdef __AVX__
/* Four rows to four columns, or back. */
static inline void transpose(scree_row r[4]) {
    scree_row a = __builtin_shufflevector(r[0], r[1], 0, 4, 2, 6), b = __builtin_shufflevector(r[0], r[1], 1, 5, 3, 7);
    scree_row c = __builtin_shufflevector(r[2], r[3], 0, 4, 2, 6), d = __builtin_shufflevector(r[2], r[3], 1, 5, 3, 7);
    r[0] = __builtin_shufflevector(a, c, 0, 1, 4, 5);
    r[1] = __builtin_shufflevector(b, d, 0, 1, 4, 5);
    r[2] = __builtin_shufflevector(a, c, 2, 3, 6, 7);
    r[3] = __builtin_shufflevector(b, d, 2, 3, 6, 7);
}

static inline void store_columns(scree_row r[4], double (*column)[SCREE_LANES], int lane) {
    transpose(r);
    for (int i = 0; i < 4; i++) *(scree_row *)&column[i][lane] = r[i];
}
#endif

/* Columns of one block of contacts. */
struct block {
    double shift[4][SCREE_LANES];     /* from the host's centre to the ball body's, m; sum of radii */
    double rush[4][SCREE_LANES];      /* velocity of the ball's centre against the host's, m/s; sum of inverse masses */
    double ball_spin[4][SCREE_LANES]; /* rad/s; largest tolerable overlap, m */
    double host_spin[4][SCREE_LANES];
    double radius[SCREE_LANES];      /* of the ball, m */
    double n[3][SCREE_LANES];        /* unit normal, from the host towards the ball */
    double corner[3][SCREE_LANES];   /* from the ball body's centre to the ball, m; boxes only */
    double arm[3][SCREE_LANES];      /* from the ball body's centre to the middle of the overlap, m */
    double overlap[SCREE_LANES];     /* m */
    double closing[SCREE_LANES];     /* m/s */
    double slip[3][SCREE_LANES];     /* tangential velocity of the ball, m/s */
    double force[SCREE_LANES];       /* normal, N */
    double reversible[SCREE_LANES];  /* part of it that is stored, N */
    double share[SCREE_LANES];       /* of the step during which the bodies touch */
    double touching[SCREE_LANES];    /* 1 while the contact lasts, else 0 */
    double snap[SCREE_LANES];        /* lost where bodies attach, J; only laws that reach beyond touch write it */
    double friction[3][SCREE_LANES]; /* N */
    double torque[3][SCREE_LANES];   /* of the rolling law on the ball, N m */
    double power[SCREE_LANES];       /* that it takes from the motion, W */
};

static inline void put(double (*column)[SCREE_LANES], int lane, struct vec a) {
    column[0][lane] = a.x;
    column[1][lane] = a.y;
    column[2][lane] = a.z;
}

static inline void put_kept(double *const *kept, int lane, struct vec a) {
    kept[0][lane] = a.x;
    kept[1][lane] = a.y;
    kept[2][lane] = a.z;
}

static inline struct vec get(double (*column)[SCREE_LANES], int lane) {
    return vec(column[0][lane], column[1][lane], column[2][lane]);
}

/* ---- gather ---- */

#ifdef __AVX__
/* Contacts lane … lane + 3. The fourth numbers of the rows are added instead of subtracted: sums of radii and of inverse masses. */
static inline void fetch_four(const struct scree_record *record, const struct scree_contact *const contact[4], int lane,
                              struct block *b) {
    const scree_row sign = {1.0, 1.0, 1.0, -1.0};
    scree_row shift[4], rush[4], ball_spin[4], host_spin[4];
    for (int i = 0; i < 4; i++) {
        const struct scree_record *ball = &record[contact[i]->ball], *host = &record[contact[i]->host];
        shift[i] = *(const scree_row *)ball->x - *(const scree_row *)host->x * sign;
        rush[i] = *(const scree_row *)ball->v - *(const scree_row *)host->v * sign;
        ball_spin[i] = *(const scree_row *)ball->w;
        host_spin[i] = *(const scree_row *)host->w;
        b->radius[lane + i] = ball->radius;
    }
    store_columns(shift, b->shift, lane);
    store_columns(rush, b->rush, lane);
    store_columns(ball_spin, b->ball_spin, lane);
    store_columns(host_spin, b->host_spin, lane);
}

#else
/* Processors without such rows: number by number, which compilers do better than rows in halves. */
static inline void fetch_four(const struct scree_record *record, const struct scree_contact *const contact[4], int lane,
                              struct block *b) {
    for (int i = 0; i < 4; i++) {
        const struct scree_record *ball = &record[contact[i]->ball], *host = &record[contact[i]->host];
        for (int k = 0; k < 3; k++) {
            b->shift[k][lane + i] = ball->x[k] - host->x[k];
            b->rush[k][lane + i] = ball->v[k] - host->v[k];
            b->ball_spin[k][lane + i] = ball->w[k];
            b->host_spin[k][lane + i] = host->w[k];
        }
        b->radius[lane + i] = ball->radius;
        b->shift[3][lane + i] = ball->radius + host->radius;
        b->rush[3][lane + i] = ball->inverse_mass + host->inverse_mass;
        b->ball_spin[3][lane + i] = ball->limit;
        b->host_spin[3][lane + i] = host->limit;
    }
}
#endif

static void fetch(const struct scree_bodies *bodies, const struct scree_contact *contact, int count, struct block *b) {
    for (int lane = 0; lane < padded(count); lane += 4) {
        const struct scree_contact *four[4];
        for (int i = 0; i < 4; i++) four[i] = &contact[lane + i < count ? lane + i : count - 1];
        fetch_four(bodies->record, four, lane, b);
    }
}

static void meet_balls(int count, struct block *b) {
    const struct vec origin = {0.0, 0.0, 0.0};
    _Pragma("omp simd")
    for (int k = 0; k < padded(count); k++) {
        struct vec apart = vec(b->shift[0][k], b->shift[1][k], b->shift[2][k]);
        struct scree_meeting m = scree_meet_ball(apart, b->shift[3][k], origin, 0.0);
        put(b->n, k, m.normal);
        b->overlap[k] = m.overlap;
    }
}

/* Partners that stand whole periods off. */
static inline void bring_images(const struct scree_bodies *bodies, const struct scree_contact *contact, int count,
                                struct block *b) {
    for (int lane = 0; lane < padded(count); lane++) {
        struct vec off = scree_shift_of(bodies, &contact[lane < count ? lane : count - 1], SCREE_BALL_IMAGE);
        b->shift[0][lane] -= off.x;
        b->shift[1][lane] -= off.y;
        b->shift[2][lane] -= off.z;
    }
}

/* Partners that aren't balls, one after the other. */
static inline void meet_others(const struct scree_bodies *bodies, const struct scree_contact *contact, int count,
                               enum scree_geometry geometry, struct block *b) {
    for (int lane = 0; lane < padded(count); lane++) {
        const struct scree_contact *one = &contact[lane < count ? lane : count - 1];
        struct vec corner = vec_from(bodies->corner[one->corner]);
        struct vec centre = vec_add(vec_from(bodies->record[one->ball].x), corner);
        struct scree_meeting m = scree_meet(bodies, one, geometry, centre);
        put(b->corner, lane, corner);
        put(b->n, lane, m.normal);
        b->overlap[lane] = m.overlap;
    }
}

static inline void move_all(int count, int corners, struct block *b) {
    _Pragma("omp simd")
    for (int k = 0; k < padded(count); k++) {
        struct vec n = vec(b->n[0][k], b->n[1][k], b->n[2][k]);
        struct vec corner = corners ? vec(b->corner[0][k], b->corner[1][k], b->corner[2][k]) : vec(0.0, 0.0, 0.0);
        struct scree_gait gait =
            scree_gait_of(n, b->overlap[k], b->radius[k], corner, vec(b->shift[0][k], b->shift[1][k], b->shift[2][k]),
                          vec(b->rush[0][k], b->rush[1][k], b->rush[2][k]),
                          vec(b->ball_spin[0][k], b->ball_spin[1][k], b->ball_spin[2][k]),
                          vec(b->host_spin[0][k], b->host_spin[1][k], b->host_spin[2][k]));
        put(b->arm, k, gait.arm);
        put(b->slip, k, gait.slip);
        b->closing[k] = gait.closing;
        b->touching[k] = b->overlap[k] > 0.0 ? 1.0 : 0.0;
    }
}

/* Share of the step during which the bodies touch: 1 or 0, but for the steps in which they meet or part. Where a block has none of
 * these, it does without divisions. */
static void share_out(int count, double step, struct block *b) {
    int parting = 0;
    _Pragma("omp simd reduction(| : parting)")
    for (int k = 0; k < padded(count); k++) {
        double way = 0.5 * step * fabs(b->closing[k]) + SCREE_NO_SPEED;
        b->share[k] = b->overlap[k] > 0.0 ? 1.0 : 0.0;
        parting |= !(fabs(b->overlap[k]) >= way);
    }
    if (!parting) return;
    _Pragma("omp simd")
    for (int k = 0; k < padded(count); k++) {
        double way = 0.5 * step * fabs(b->closing[k]) + SCREE_NO_SPEED;
        double share = 0.5 + 0.5 * (b->overlap[k] / way);
        share = share < 1.0 ? share : 1.0;
        b->share[k] = share > 0.0 ? share : 0.0;
    }
}

static void gather(const struct scree_bodies *bodies, const struct scree_contact *contact, int count,
                   enum scree_geometry geometry, struct block *b) {
    fetch(bodies, contact, count, b);
    switch (geometry) { /* constant arguments: each case becomes a loop of its own */
    case SCREE_BALL_BALL:
        meet_balls(count, b);
        move_all(count, 0, b);
        return;
    case SCREE_BALL_PLANE:
        meet_others(bodies, contact, count, SCREE_BALL_PLANE, b);
        break;
    case SCREE_BALL_RECTANGLE:
        meet_others(bodies, contact, count, SCREE_BALL_RECTANGLE, b);
        break;
    case SCREE_BALL_IMAGE:
        bring_images(bodies, contact, count, b);
        meet_balls(count, b);
        move_all(count, 0, b);
        return;
    default:
        meet_others(bodies, contact, count, SCREE_BALL_BOX, b);
        break;
    }
    move_all(count, 1, b);
}

/* ---- edges on edges ---- */

/* What they do besides pushing at the middle of their overlap, per newton of the normal force. */
struct lean {
    double force[3][SCREE_LANES], turn_ball[3][SCREE_LANES], turn_host[3][SCREE_LANES];
};

/* What can't touch, or is padding. */
static void gather_nothing(struct block *b, int lane, struct lean *lean) {
    struct vec zero = {0.0, 0.0, 0.0};
    put(b->n, lane, vec(0.0, 0.0, 1.0));
    put(b->arm, lane, zero);
    put(b->slip, lane, zero);
    b->overlap[lane] = SCREE_OUTSIDE;
    b->touching[lane] = b->closing[lane] = 0.0;
    put(lean->force, lane, zero);
    put(lean->turn_ball, lane, zero);
    put(lean->turn_host, lane, zero);
}

static void gather_crossing(const struct scree_bodies *bodies, const struct scree_contact *contact, struct block *b,
                            int lane, struct lean *lean) {
    struct scree_crossing c = scree_cross(bodies, contact);
    struct scree_gait gait = scree_gait_on_edges(bodies, contact, &c);
    struct vec n = c.meeting.normal, host_arm = vec_add(c.point, get(b->shift, lane));
    put(b->n, lane, n);
    put(b->arm, lane, gait.arm);
    put(b->slip, lane, gait.slip);
    b->overlap[lane] = c.meeting.overlap;
    b->touching[lane] = c.meeting.overlap > 0.0 ? 1.0 : 0.0;
    b->closing[lane] = gait.closing;
    put(lean->force, lane, vec_sub(c.force, n));
    put(lean->turn_ball, lane, vec_sub(c.turn_a, vec_cross(c.point, n)));
    put(lean->turn_host, lane, vec_add(c.turn_b, vec_cross(host_arm, n)));
}

/* Whether two boxes may touch edge on edge in this step. Where they can't, all would come out as zero. */
static int may_cross(const struct scree_bodies *bodies, const struct scree_contact *contact,
                     const struct scree_run *run) {
    const struct scree_record *a = &bodies->record[contact->ball], *b = &bodies->record[contact->host];
    double way = a->path + b->path - run->from;
    if (2.0 * way < run->clear) return 0; /* twice: the step's own way, wherever it is within it */
    struct scree_two_boxes boxes = scree_two_boxes_of(bodies, contact->ball, contact->host);
    return !scree_meet_as_rectangles(&boxes, run->first);
}

/* Contacts first … first + count - 1 of segment 0, a block of it. Returns 0 if nothing can touch; then nothing is gathered. */
static int gather_crossings(const struct scree_bodies *bodies, const struct scree_batch *batch, int first, int count,
                            struct block *b, struct lean *lean) {
    const struct scree_contact *contact = batch->contact + batch->segment[0].first;
    int start = first - batch->segment[0].first, first_run = batch->first_run[start / SCREE_LANES];
    int runs = 0, any = 0, may[SCREE_LANES];
    const struct scree_run *run = batch->run + first_run;
    for (; first_run + runs < batch->runs && run[runs].start < start + count; runs++)
        any |= may[runs] = may_cross(bodies, &contact[run[runs].start], &run[runs]);
    if (!any) return 0;
    fetch(bodies, contact + start, count, b);
    for (int lane = 0, own = 0; lane < padded(count); lane++) {
        if (own + 1 < runs && start + lane == run[own + 1].start) own++;
        if (lane < count && may[own])
            gather_crossing(bodies, &contact[start + lane], b, lane, lean);
        else
            gather_nothing(b, lane, lean);
    }
    return 1;
}

#endif
