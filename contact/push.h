/* What a block of contacts yields: impulses and angular impulses, kept for later or added straight to the bodies. Part
 * of loop.c. */
#ifndef SCREE_CONTACT_PUSH_H
#define SCREE_CONTACT_PUSH_H

#include "contact/block.h"

/* What a contact does to its bodies: a constant for each loop over contacts. */
enum { RUBS = 1, TURNS = 2, ROLLS = 4, BALLS = 8 };

/* `turns`: of what doesn't rub, some turn bodies all the same. */
static inline int deeds_of(const struct scree_batch *batch, const struct scree_rule *rule, int turns) {
    int balls = batch->geometry == SCREE_BALL_BALL || batch->geometry == SCREE_BALL_IMAGE ? BALLS : 0;
    if (rule->rolling >= 0) return balls | TURNS | ROLLS | (rule->friction >= 0 ? RUBS : 0);
    if (rule->friction >= 0) return balls | TURNS | RUBS;
    return turns ? TURNS : 0; /* without friction a ball at the centre of its body can't turn it */
}

/* Impulse and angular impulses of one contact. */
struct kick {
    struct vec impulse, turn_ball, turn_host;
};

static SCREE_INLINE struct kick kick_of(const struct block *b, int k, double step, int deeds) {
    struct kick kick = {{0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}};
    struct vec n = normal_at(b, k), j = vec_scale(b->force[k], n);
    if (deeds & RUBS) j = vec_add(j, vec(b->friction[0][k], b->friction[1][k], b->friction[2][k]));
    kick.impulse = j = vec_scale(step, j);
    if (deeds & TURNS && deeds & BALLS) {
        struct vec turn = vec_cross(n, j);
        kick.turn_ball = vec_scale(-b->lever[0][k], turn);
        kick.turn_host = vec_scale(-b->lever[1][k], turn);
    } else if (deeds & TURNS) {
        struct vec arm = vec(b->arm[0][k], b->arm[1][k], b->arm[2][k]);
        struct vec reach = vec_add(arm, shift_at(b, k));
        kick.turn_ball = vec_cross(arm, j);
        kick.turn_host = vec_cross(j, reach);
    }
    if (deeds & ROLLS) {
        struct vec torque = vec(b->torque[0][k], b->torque[1][k], b->torque[2][k]);
        kick.turn_ball = vec_axpy(kick.turn_ball, step, torque);
        kick.turn_host = vec_sub(kick.turn_host, vec_scale(step, torque));
    }
    return kick;
}

/* CALL(deeds), with each value that these can have as a constant. */
#define FOR_DEEDS(deeds, CALL)                                                                                         \
    switch (deeds) {                                                                                                   \
    case 0:                                                                                                            \
        CALL(0);                                                                                                       \
        break;                                                                                                         \
    case TURNS:                                                                                                        \
        CALL(TURNS);                                                                                                   \
        break;                                                                                                         \
    case RUBS | TURNS:                                                                                                 \
        CALL(RUBS | TURNS);                                                                                            \
        break;                                                                                                         \
    case RUBS | TURNS | BALLS:                                                                                         \
        CALL(RUBS | TURNS | BALLS);                                                                                    \
        break;                                                                                                         \
    case TURNS | ROLLS:                                                                                                \
        CALL(TURNS | ROLLS);                                                                                           \
        break;                                                                                                         \
    case TURNS | ROLLS | BALLS:                                                                                        \
        CALL(TURNS | ROLLS | BALLS);                                                                                   \
        break;                                                                                                         \
    case RUBS | TURNS | ROLLS:                                                                                         \
        CALL(RUBS | TURNS | ROLLS);                                                                                    \
        break;                                                                                                         \
    default:                                                                                                           \
        CALL(RUBS | TURNS | ROLLS | BALLS);                                                                            \
        break;                                                                                                         \
    }

static SCREE_INLINE void write_kicks(const struct block *b, int count, double step, int deeds,
                                     struct scree_yield *yield) {
    _Pragma("omp simd")
    for (int k = 0; k < padded(count); k++) {
        struct kick kick = kick_of(b, k, step, deeds);
        put(yield->impulse, k, kick.impulse);
        if (!(deeds & TURNS)) continue;
        put(yield->turn_ball, k, kick.turn_ball);
        put(yield->turn_host, k, kick.turn_host);
    }
}

static void write_yield(const struct block *b, int count, const struct scree_batch *batch, int deeds,
                        struct sizes sizes, double step, struct scree_yield *yield) {
#define WRITE(constant) write_kicks(b, count, step, constant, yield)
    FOR_DEEDS(deeds, WRITE)
#undef WRITE
    _Pragma("omp simd")
    for (int k = 0; k < padded(count); k++) {
        yield->depth[k] = b->overlap[k] / limit_of(b, k, sizes);
        yield->steep[k] = 0.0;
    }
    if (batch->slope == 0.0) return;
    _Pragma("omp simd")
    for (int k = 0; k < padded(count); k++)
        yield->steep[k] = scree_steepness(step * b->force[k], batch->slope, b->rush[3][k]);
}

static void measure_losses(const struct block *b, int count, const struct scree_rule *rule, double step,
                           struct scree_losses *lost) {
    for (int k = 0; k < count; k++) {
        lost->normal[k] = step * (b->force[k] - b->reversible[k]) * b->closing[k];
        lost->tangential[k] = 0.0;
    }
    for (int k = 0; scree_normal_laws[rule->normal]->reach && k < count; k++) lost->normal[k] += b->snap[k];
    for (int k = 0; rule->friction >= 0 && k < count; k++)
        lost->tangential[k] -= step * (b->friction[0][k] * b->slip[0][k] + b->friction[1][k] * b->slip[1][k] +
                                       b->friction[2][k] * b->slip[2][k]);
    for (int k = 0; rule->rolling >= 0 && k < count; k++) lost->tangential[k] += step * b->power[k];
}

/* ---- straight into the bodies ---- */

/* Columns of impulses and angular impulses on the ball, and what is taken from the host: angular impulses with the
 * other sign. Fourth columns are zero. */
struct kicks {
    _Alignas(64) double impulse[4][SCREE_LANES];
    double turn_ball[4][SCREE_LANES], turn_host[4][SCREE_LANES];
};

/* Two balls that don't roll on torques of their own are turned along one direction, each by its lever: `turn_ball` is
 * that. */
static inline int by_levers(int deeds) { return deeds & TURNS && deeds & BALLS && !(deeds & ROLLS); }

static SCREE_INLINE void make_kicks(const struct block *b, int count, double step, int deeds, struct kicks *kicks) {
    _Pragma("omp simd")
    for (int k = 0; k < padded(count); k++) {
        struct kick kick = kick_of(b, k, step, deeds);
        put(kicks->impulse, k, kick.impulse);
        struct vec n = normal_at(b, k);
        put(kicks->turn_ball, k, by_levers(deeds) ? vec_cross(n, kick.impulse) : kick.turn_ball);
        if (!by_levers(deeds)) put(kicks->turn_host, k, vec_scale(-1.0, kick.turn_host));
    }
}

#ifdef __AVX__
/* Impulses and angular impulses of two balls that turn by the same lever, as columns. */
static SCREE_INLINE void kick_evenly(const struct block *b, int lane, double step, lane_row r[8]) {
    const lane_row none = {0.0};
    lane_row n[3], force = *(const lane_row *)&b->force[lane], lever = *(const lane_row *)&b->lever[0][lane];
    for (int i = 0; i < 3; i++) {
        n[i] = *(const lane_row *)&b->n[i][lane];
        r[i] = (none + step) * (force * n[i] + *(const lane_row *)&b->friction[i][lane]);
    }
    r[3] = r[7] = none;
    r[4] = lever * (n[2] * r[1] - n[1] * r[2]);
    r[5] = lever * (n[0] * r[2] - n[2] * r[0]);
    r[6] = lever * (n[1] * r[0] - n[0] * r[1]);
}
#endif

/* Add the kicks of a block to its bodies. `hosts`: partners are pushed too; else they are frozen, and several slabs
 * have them in common. */
#if defined __AVX512F__
/* The bodies of some contacts by their places, and where their sums begin: with what is in memory, or with nothing
 * where the contact before was one of the same body, so that its sum is at hand. Contacts of a body follow each other
 * where it comes first, and would wait for each other's stores. */
struct pairs {
    _Alignas(64) struct scree_record *first[WIDTH], *other[WIDTH];
    const struct scree_record *from[WIDTH];
    long long again[WIDTH]; /* all bits: the sum is at hand; or none */
};

_Static_assert(sizeof(struct scree_record *) == sizeof(long long), "addresses are worked out in columns of numbers");

/* `before`: the first bodies of the contacts before. Returns the sign of those whose ball doesn't come first: there
 * the impulse on the first body is the other one. */
static SCREE_INLINE wide_bits pair_up(const struct ends *ends, int lane, wide_bits *before, struct pairs *pairs) {
    static const struct scree_record nothing = {.radius = 0.0};
    const wide_bits none = (wide_bits){0} + (long long)(uintptr_t)&nothing;
    wide_bits ball = *(const wide_bits *)&ends->ball[lane], host = *(const wide_bits *)&ends->host[lane];
    wide_bits turned = ball > host, swap = (ball ^ host) & turned, first = ball ^ swap;
    wide_bits again = first == __builtin_shufflevector(*before, first, 7, 8, 9, 10, 11, 12, 13, 14);
    *before = first;
    *(wide_bits *)pairs->first = first;
    *(wide_bits *)pairs->other = host ^ swap;
    *(wide_bits *)pairs->from = first ^ ((first ^ none) & again);
    *(wide_bits *)pairs->again = again;
    return turned & INT64_MIN;
}

/* The impulse with the other sign is the host's: in one instruction, whose product is exact. */
static SCREE_INLINE void push_other(struct scree_record *other, wide_row kick) {
    const wide_row sign = {-1.0, -1.0, -1.0, -1.0, 1.0, 1.0, 1.0, 1.0};
    wide_row *sum = (wide_row *)other->impulse;
    *sum = (wide_row)_mm512_fmadd_pd((__m512d)kick, (__m512d)sign, (__m512d)*sum);
}

/* In one go from columns to bodies. Contacts of one body wait for each other's stores; on most processors
 * (scree_sums_in_hand) that costs less than what push_in_hand does to avoid it. */
static SCREE_INLINE void push_evenly(const struct ends *ends, const struct block *b, int count, double step) {
    for (int lane = 0; lane < count; lane += WIDTH) {
        wide_row r[8];
        kick_evenly(b, lane, step, r);
        transpose_wide(r);
        for (int i = 0; i < WIDTH && lane + i < count; i++) {
            *(wide_row *)ends->ball[lane + i]->impulse += r[i];
            push_other(ends->host[lane + i], r[i]);
        }
    }
}

/* The same, with the sums of first bodies at hand. */
static SCREE_INLINE void push_in_hand(const struct ends *ends, const struct block *b, int count, double step) {
    struct pairs pairs;
    wide_bits before = {0};
    wide_row sum = {0.0};
    for (int lane = 0; lane < count; lane += WIDTH) {
        wide_row r[8];
        wide_bits turned = pair_up(ends, lane, &before, &pairs);
        kick_evenly(b, lane, step, r);
        for (int i = 0; i < 3; i++) r[i] = (wide_row)((wide_bits)r[i] ^ turned);
        transpose_wide(r);
        for (int i = 0; i < WIDTH && lane + i < count; i++) {
            sum = (wide_row)(((wide_bits)sum & pairs.again[i]) | *(const wide_bits *)pairs.from[i]->impulse) + r[i];
            *(wide_row *)pairs.first[i]->impulse = sum;
            push_other(pairs.other[i], r[i]);
        }
    }
}

static SCREE_INLINE void load_kicks(double (*impulse)[SCREE_LANES], double (*turn)[SCREE_LANES], int lane,
                                    wide_row r[8]) {
    const wide_row none = {0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0};
    for (int i = 0; i < 3; i++) r[i] = *(const wide_row *)&impulse[i][lane];
    for (int i = 0; i < 3; i++) r[4 + i] = *(const wide_row *)&turn[i][lane];
    r[3] = r[7] = none;
    transpose_wide(r);
}

static SCREE_INLINE wide_row with_lever(double lever) {
    return (wide_row){1.0, 1.0, 1.0, 1.0, lever, lever, lever, lever};
}

static SCREE_INLINE void add_kicks(const struct ends *ends, const struct block *b, int count, int hosts, int deeds,
                                   struct kicks *kicks) {
    for (int lane = 0; lane < count; lane += 8) {
        wide_row on_ball[8], on_host[8];
        load_kicks(kicks->impulse, kicks->turn_ball, lane, on_ball);
        if (hosts && !by_levers(deeds)) load_kicks(kicks->impulse, kicks->turn_host, lane, on_host);
        for (int i = 0; i < 8 && lane + i < count; i++) {
            wide_row *ball = (wide_row *)ends->ball[lane + i]->impulse,
                     *host = (wide_row *)ends->host[lane + i]->impulse;
            if (by_levers(deeds)) {
                *ball += on_ball[i] * with_lever(-b->lever[0][lane + i]);
                if (hosts) *host -= on_ball[i] * with_lever(b->lever[1][lane + i]);
            } else {
                *ball += on_ball[i];
                if (hosts) *host -= on_host[i];
            }
        }
    }
}
#elif defined __AVX__
/* In one go from columns to bodies. */
static SCREE_INLINE void push_evenly(const struct ends *ends, const struct block *b, int count, double step) {
    for (int lane = 0; lane < count; lane += 4) {
        scree_row r[8];
        kick_evenly(b, lane, step, r);
        transpose(r);
        transpose(r + 4);
        for (int i = 0; i < 4 && lane + i < count; i++) {
            struct scree_record *ball = ends->ball[lane + i], *host = ends->host[lane + i];
            *(scree_row *)ball->impulse += r[i];
            *(scree_row *)ball->turn += r[4 + i];
            *(scree_row *)host->impulse -= r[i];
            *(scree_row *)host->turn += r[4 + i];
        }
    }
}

static SCREE_INLINE void load_kicks(double (*column)[SCREE_LANES], int lane, scree_row r[4]) {
    for (int i = 0; i < 3; i++) r[i] = *(scree_row *)&column[i][lane];
    r[3] = (scree_row){0.0, 0.0, 0.0, 0.0};
    transpose(r);
}

static SCREE_INLINE void add_kicks(const struct ends *ends, const struct block *b, int count, int hosts, int deeds,
                                   struct kicks *kicks) {
    for (int lane = 0; lane < count; lane += 4) {
        scree_row impulse[4], turn_ball[4], turn_host[4];
        load_kicks(kicks->impulse, lane, impulse);
        if (deeds & TURNS) load_kicks(kicks->turn_ball, lane, turn_ball);
        if (deeds & TURNS && hosts && !by_levers(deeds)) load_kicks(kicks->turn_host, lane, turn_host);
        for (int i = 0; i < 4 && lane + i < count; i++) {
            struct scree_record *ball = ends->ball[lane + i], *host = ends->host[lane + i];
            *(scree_row *)ball->impulse += impulse[i];
            if (hosts) *(scree_row *)host->impulse -= impulse[i];
            if (by_levers(deeds)) {
                *(scree_row *)ball->turn += scree_row_times(-b->lever[0][lane + i], turn_ball[i]);
                if (hosts) *(scree_row *)host->turn -= scree_row_times(b->lever[1][lane + i], turn_ball[i]);
            } else if (deeds & TURNS) {
                *(scree_row *)ball->turn += turn_ball[i];
                if (hosts) *(scree_row *)host->turn -= turn_host[i];
            }
        }
    }
}
#else
static SCREE_INLINE void add_kicks(const struct ends *ends, const struct block *b, int count, int hosts, int deeds,
                                   struct kicks *kicks) {
    for (int lane = 0; lane < count; lane++) {
        struct scree_record *ball = ends->ball[lane], *host = ends->host[lane];
        for (int k = 0; k < 3; k++) {
            ball->impulse[k] += kicks->impulse[k][lane];
            if (hosts) host->impulse[k] -= kicks->impulse[k][lane];
            if (by_levers(deeds)) {
                ball->turn[k] += -b->lever[0][lane] * kicks->turn_ball[k][lane];
                if (hosts) host->turn[k] -= b->lever[1][lane] * kicks->turn_ball[k][lane];
            } else if (deeds & TURNS) {
                ball->turn[k] += kicks->turn_ball[k][lane];
                if (hosts) host->turn[k] -= kicks->turn_host[k][lane];
            }
        }
    }
}
#endif

static SCREE_INLINE void push_as(const struct ends *ends, const struct block *b, int count, int hosts, int deeds,
                                 double step) {
    struct kicks kicks;
    make_kicks(b, count, step, deeds, &kicks);
    if (hosts)
        add_kicks(ends, b, count, 1, deeds, &kicks);
    else
        add_kicks(ends, b, count, 0, deeds, &kicks);
}

static void push(const struct ends *ends, const struct block *b, int count, const struct scree_batch *batch, int deeds,
                 int even, int in_hand, double step) {
    int hosts = batch->geometry == SCREE_BALL_BALL, evenly = even && deeds == (RUBS | TURNS | BALLS);
#ifdef __AVX512F__
    if (evenly && in_hand) {
        push_in_hand(ends, b, count, step);
        return;
    }
#endif
#ifdef __AVX__
    if (evenly) {
        push_evenly(ends, b, count, step);
        return;
    }
#endif
    (void)evenly;
    (void)in_hand;
#define PUSH(constant) push_as(ends, b, count, hosts, constant, step)
    FOR_DEEDS(deeds, PUSH)
#undef PUSH
}

#endif
