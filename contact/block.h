/* A block of contacts on its way through the loop, and how it is gathered from the bodies: rows of records are fetched
 * and turned into columns, from which normal, overlap, arms, relative velocity follow. Part of loop.c and smooth.c. */
#ifndef SCREE_CONTACT_BLOCK_H
#define SCREE_CONTACT_BLOCK_H

#include "bodies/balls.h"
#include "contact/meet.h"

#include <string.h>

/* Contacts that one instruction takes: passes run over full vectors. */
#ifdef __AVX512F__
enum { WIDTH = 8 };
#else
enum { WIDTH = 4 };
#endif
static inline int padded(int count) { return (count + WIDTH - 1) & -WIDTH; }

#ifdef __AVX__
/* Four rows to four columns, or back. */
static SCREE_INLINE void transpose(scree_row r[4]) {
    scree_row a = __builtin_shufflevector(r[0], r[1], 0, 4, 2, 6), b = __builtin_shufflevector(r[0], r[1], 1, 5, 3, 7);
    scree_row c = __builtin_shufflevector(r[2], r[3], 0, 4, 2, 6), d = __builtin_shufflevector(r[2], r[3], 1, 5, 3, 7);
    r[0] = __builtin_shufflevector(a, c, 0, 1, 4, 5);
    r[1] = __builtin_shufflevector(b, d, 0, 1, 4, 5);
    r[2] = __builtin_shufflevector(a, c, 2, 3, 6, 7);
    r[3] = __builtin_shufflevector(b, d, 2, 3, 6, 7);
}

static SCREE_INLINE void store_columns(scree_row r[4], int count, double (*column)[SCREE_LANES], int lane) {
    transpose(r);
    for (int i = 0; i < count; i++) *(scree_row *)&column[i][lane] = r[i];
}
#endif

#ifdef __AVX512F__
/* Two rows of a record in one. */
typedef double wide_row __attribute__((vector_size(64), aligned(8), may_alias));
typedef long long wide_bits __attribute__((vector_size(64), aligned(8), may_alias));

/* (gcc makes three instructions of a shuffle.) */
static SCREE_INLINE wide_row wide_of(scree_row a, scree_row b) {
    return (wide_row)_mm512_insertf64x4(_mm512_castpd256_pd512((__m256d)a), (__m256d)b, 1);
}

/* As many numbers as one instruction takes. */
typedef wide_row lane_row;
static SCREE_INLINE lane_row lane_root(lane_row a) { return (lane_row)_mm512_sqrt_pd((__m512d)a); }

/* Eight whole numbers in bytes to a vector and back; compilers would gather all bytes of a block first. */
static SCREE_INLINE void wide_from_bytes(const unsigned char bytes[8], double row[8]) {
    __m512i whole = _mm512_cvtepu8_epi64(_mm_loadl_epi64((const __m128i *)bytes));
    *(wide_row *)row = (wide_row)_mm512_cvtepi64_pd(whole);
}

static SCREE_INLINE void wide_to_bytes(const double row[8], unsigned char bytes[8]) {
    __m512i whole = _mm512_cvtpd_epi64((__m512d) * (const wide_row *)row);
    _mm_storel_epi64((__m128i *)bytes, _mm512_cvtepi64_epi8(whole));
}

/* Fourth numbers of both rows with the other sign. */
static SCREE_INLINE wide_row wide_turned(wide_row a) {
    const wide_bits sign = {0, 0, 0, INT64_MIN, 0, 0, 0, INT64_MIN};
    return (wide_row)((wide_bits)a ^ sign);
}

/* Four rows in the lower halves and four in the upper ones, to columns. */
static SCREE_INLINE void transpose_halves(wide_row r[4]) {
    wide_row a = __builtin_shufflevector(r[0], r[1], 0, 8, 2, 10, 4, 12, 6, 14);
    wide_row b = __builtin_shufflevector(r[0], r[1], 1, 9, 3, 11, 5, 13, 7, 15);
    wide_row c = __builtin_shufflevector(r[2], r[3], 0, 8, 2, 10, 4, 12, 6, 14);
    wide_row d = __builtin_shufflevector(r[2], r[3], 1, 9, 3, 11, 5, 13, 7, 15);
    r[0] = __builtin_shufflevector(a, c, 0, 1, 8, 9, 4, 5, 12, 13);
    r[1] = __builtin_shufflevector(b, d, 0, 1, 8, 9, 4, 5, 12, 13);
    r[2] = __builtin_shufflevector(a, c, 2, 3, 10, 11, 6, 7, 14, 15);
    r[3] = __builtin_shufflevector(b, d, 2, 3, 10, 11, 6, 7, 14, 15);
}

/* Eight rows to eight columns, or back. */
static SCREE_INLINE void transpose_wide(wide_row r[8]) {
    wide_row a[8], b[8];
    for (int i = 0; i < 8; i += 2) { /* pairs of rows */
        a[i] = __builtin_shufflevector(r[i], r[i + 1], 0, 8, 2, 10, 4, 12, 6, 14);
        a[i + 1] = __builtin_shufflevector(r[i], r[i + 1], 1, 9, 3, 11, 5, 13, 7, 15);
    }
    for (int i = 0; i < 8; i += 4) /* fours of rows */
        for (int j = 0; j < 2; j++) {
            b[i + j] = __builtin_shufflevector(a[i + j], a[i + j + 2], 0, 1, 8, 9, 4, 5, 12, 13);
            b[i + j + 2] = __builtin_shufflevector(a[i + j], a[i + j + 2], 2, 3, 10, 11, 6, 7, 14, 15);
        }
    for (int i = 0; i < 4; i++) {
        r[i] = __builtin_shufflevector(b[i], b[i + 4], 0, 1, 2, 3, 8, 9, 10, 11);
        r[i + 4] = __builtin_shufflevector(b[i], b[i + 4], 4, 5, 6, 7, 12, 13, 14, 15);
    }
}
#elif defined __AVX__
typedef scree_row lane_row;
static SCREE_INLINE lane_row lane_root(lane_row a) { return scree_row_root(a); }
#endif

/* The bodies of one block of contacts. */
struct ends {
    struct scree_record *ball[SCREE_LANES], *host[SCREE_LANES];
    const struct scree_spin *ball_spin[SCREE_LANES], *host_spin[SCREE_LANES];
};

/* Columns of one block of contacts. What one pass divides, or takes the root of, the next one works with: a processor
 * looks ahead over some sixty operations, and what waits for a root would fill them. For balls of one size
 * (scree_goes_even) ball_spin holds the sum of both spins; host_spin, radius and all fourth columns aren't set. */
struct block {
    /* from the host's centre to the ball body's, m; sum of radii */
    _Alignas(256) double shift[4][SCREE_LANES];
    double rush[4][SCREE_LANES];      /* velocity of the ball's centre against the host's, m/s; sum of inverse masses */
    double ball_spin[4][SCREE_LANES]; /* rad/s; largest tolerable overlap, m */
    double host_spin[4][SCREE_LANES]; /* rad/s; the fourth is free */
    double radius[SCREE_LANES];       /* of the ball, m */
    double apart[SCREE_LANES];        /* of two balls: distance of the centres, m, */
    double inverse[SCREE_LANES];      /* and one over it */
    double n[3][SCREE_LANES];         /* unit normal, from the host towards the ball */
    double corner[3][SCREE_LANES];    /* from the ball body's centre to the ball, m; boxes only */
    double arm[3][SCREE_LANES];   /* from the ball body's centre to the middle of the overlap, m; not of two balls */
    double lever[2][SCREE_LANES]; /* of two balls: from the centres of ball and host to there, m */
    double overlap[SCREE_LANES];  /* m */
    double root[SCREE_LANES], fourth[SCREE_LANES]; /* of the overlap: square and fourth root, for laws that need them */
    double closing[SCREE_LANES];                   /* m/s */
    double slip[3][SCREE_LANES];                   /* tangential velocity of the ball, m/s */
    double force[SCREE_LANES];                     /* normal, N */
    double reversible[SCREE_LANES];                /* part of it that is stored, N */
    double half_steps_in[SCREE_LANES];             /* scree_half_steps_in */
    double share[SCREE_LANES];                     /* of the step during which the bodies touch */
    double touching[SCREE_LANES];                  /* 1 while the contact lasts, else 0 */
    double snap[SCREE_LANES];        /* lost where bodies attach, J; only laws that reach beyond touch write it */
    double friction[3][SCREE_LANES]; /* N */
    double state[SCREE_LANES];       /* of friction, as kept */
    /* Of sliders (slider.h): what they are, and their trial force (N) with its size. */
    double k[SCREE_LANES], drag[SCREE_LANES], gone[SCREE_LANES], goes[SCREE_LANES], stays[SCREE_LANES];
    double holds[SCREE_LANES], slides[SCREE_LANES];
    double trial[3][SCREE_LANES], size[SCREE_LANES];
    double torque[3][SCREE_LANES]; /* of the rolling law on the ball, N m */
    double power[SCREE_LANES];     /* that it takes from the motion, W */
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

static inline struct vec get_kept(double *const *kept, int lane) {
    return vec(kept[0][lane], kept[1][lane], kept[2][lane]);
}

static inline struct vec get(double (*column)[SCREE_LANES], int lane) {
    return vec(column[0][lane], column[1][lane], column[2][lane]);
}

static inline struct vec normal_at(const struct block *b, int k) { return vec(b->n[0][k], b->n[1][k], b->n[2][k]); }
static inline struct vec slip_at(const struct block *b, int k) {
    return vec(b->slip[0][k], b->slip[1][k], b->slip[2][k]);
}
static inline struct vec shift_at(const struct block *b, int k) {
    return vec(b->shift[0][k], b->shift[1][k], b->shift[2][k]);
}
/* The spins of ball and host together; `even`: where there is a column for that. */
static SCREE_INLINE struct vec spins_at(const struct block *b, int k, int even) {
    struct vec ball = vec(b->ball_spin[0][k], b->ball_spin[1][k], b->ball_spin[2][k]);
    return even ? ball : vec_add(ball, vec(b->host_spin[0][k], b->host_spin[1][k], b->host_spin[2][k]));
}

/* Where balls are of one size (scree_goes_even), what columns needn't say: sum of both radii, and the largest tolerable
 * overlap, m. */
struct sizes {
    int even;
    double radii, limit;
};

/* Limit of the overlap in a lane, m. */
static SCREE_INLINE double limit_of(const struct block *b, int k, struct sizes sizes) {
    if (sizes.even) return sizes.limit;
    return b->ball_spin[3][k] < b->host_spin[3][k] ? b->ball_spin[3][k] : b->host_spin[3][k];
}

/* ---- gather ---- */

/* Distances of two balls, and one over them: of one vector. (clang doesn't make one of so short a loop.) */
#ifdef __AVX__
static SCREE_INLINE void measure_apart(struct block *b, int from) {
    lane_row x = *(lane_row *)&b->shift[0][from], y = *(lane_row *)&b->shift[1][from];
    lane_row z = *(lane_row *)&b->shift[2][from];
    *(lane_row *)&b->apart[from] = lane_root(x * x + y * y + z * z);
}

static SCREE_INLINE void invert_apart(struct block *b, int from) {
    const lane_row none = {0.0}, one = none + 1.0;
    *(lane_row *)&b->inverse[from] = one / (*(lane_row *)&b->apart[from] + SCREE_NO_WAY);
}
#else
static SCREE_INLINE void measure_apart(struct block *b, int from) {
    _Pragma("omp simd")
    for (int k = from; k < from + WIDTH; k++) b->apart[k] = vec_norm(get(b->shift, k));
}

static SCREE_INLINE void invert_apart(struct block *b, int from) {
    _Pragma("omp simd")
    for (int k = from; k < from + WIDTH; k++) b->inverse[k] = 1.0 / (b->apart[k] + SCREE_NO_WAY);
}
#endif

/* The same while vector after vector of balls is fetched. What divides is one vector behind: else the processor, which
 * looks ahead over little more than one vector's work, would wait for the root and then for the quotient. */
static SCREE_INLINE void measure_next(struct block *b, int lane, int end) {
    measure_apart(b, lane);
    if (lane > 0) invert_apart(b, lane - WIDTH);
    if (lane == end - WIDTH) invert_apart(b, lane);
}

/* Rows of records, subtracted, become columns: those of contacts lane … lane + WIDTH - 1. The fourth numbers of the
 * rows are added instead: sums of radii and of inverse masses. */
#ifdef __AVX512F__
static SCREE_INLINE void store_wide(const wide_row *row, int count, double (*column)[SCREE_LANES], int lane) {
    for (int i = 0; i < count; i++) *(wide_row *)&column[i][lane] = row[i];
}

static SCREE_INLINE void fetch_way(const struct ends *ends, int lane, int even, struct block *b) {
    wide_row r[8];
    for (int i = 0; i < 8; i++) {
        wide_row ball = *(const wide_row *)ends->ball[lane + i]->x;
        wide_row host = *(const wide_row *)ends->host[lane + i]->x;
        r[i] = ball - (even ? host : wide_turned(host));
    }
    transpose_wide(r);
    store_wide(r, even ? 3 : 4, b->shift, lane);
    store_wide(r + 4, even ? 3 : 4, b->rush, lane);
}

static SCREE_INLINE void fetch_spins(const struct ends *ends, int lane, struct block *b) {
    wide_row r[8];
    for (int i = 0; i < 8; i++) {
        const struct scree_spin *ball = ends->ball_spin[lane + i];
        const struct scree_spin *host = ends->host_spin[lane + i];
        r[i] = wide_of(*(const scree_row *)ball->w, *(const scree_row *)host->w);
        b->radius[lane + i] = ends->ball[lane + i]->radius;
    }
    transpose_wide(r);
    store_wide(r, 4, b->ball_spin, lane);
    store_wide(r + 4, 4, b->host_spin, lane);
}

/* Of ball and partner together. */
static SCREE_INLINE scree_row even_spin(const struct ends *ends, int lane) {
    const double *ball = ends->ball_spin[lane]->w, *host = ends->host_spin[lane]->w;
    return *(const scree_row *)ball + *(const scree_row *)host;
}

static SCREE_INLINE void fetch_even_spins(const struct ends *ends, int lane, struct block *b) {
    wide_row r[4];
    for (int i = 0; i < 4; i++) r[i] = wide_of(even_spin(ends, lane + i), even_spin(ends, lane + 4 + i));
    transpose_halves(r);
    store_wide(r, 3, b->ball_spin, lane);
}

#elif defined __AVX__
static SCREE_INLINE void fetch_way(const struct ends *ends, int lane, int even, struct block *b) {
    const scree_row sign = {1.0, 1.0, 1.0, -1.0};
    scree_row shift[4], rush[4];
    for (int i = 0; i < 4; i++) {
        const struct scree_record *ball = ends->ball[lane + i];
        const struct scree_record *host = ends->host[lane + i];
        shift[i] = *(const scree_row *)ball->x - *(const scree_row *)host->x * sign;
        rush[i] = *(const scree_row *)ball->v - *(const scree_row *)host->v * sign;
    }
    store_columns(shift, even ? 3 : 4, b->shift, lane);
    store_columns(rush, even ? 3 : 4, b->rush, lane);
}

static SCREE_INLINE void fetch_spins(const struct ends *ends, int lane, struct block *b) {
    scree_row ball_spin[4], host_spin[4];
    for (int i = 0; i < 4; i++) {
        ball_spin[i] = *(const scree_row *)ends->ball_spin[lane + i]->w;
        host_spin[i] = *(const scree_row *)ends->host_spin[lane + i]->w;
        b->radius[lane + i] = ends->ball[lane + i]->radius;
    }
    store_columns(ball_spin, 4, b->ball_spin, lane);
    store_columns(host_spin, 4, b->host_spin, lane);
}

static SCREE_INLINE void fetch_even_spins(const struct ends *ends, int lane, struct block *b) {
    scree_row spin[4];
    for (int i = 0; i < 4; i++)
        spin[i] = *(const scree_row *)ends->ball_spin[lane + i]->w + *(const scree_row *)ends->host_spin[lane + i]->w;
    store_columns(spin, 3, b->ball_spin, lane);
}

#else
/* Processors without such rows: number by number, which compilers do better than rows in halves. */
static SCREE_INLINE void fetch_way(const struct ends *ends, int lane, int even, struct block *b) {
    for (int i = lane; i < lane + WIDTH; i++) {
        const struct scree_record *ball = ends->ball[i];
        const struct scree_record *host = ends->host[i];
        for (int k = 0; k < 3; k++) {
            b->shift[k][i] = ball->x[k] - host->x[k];
            b->rush[k][i] = ball->v[k] - host->v[k];
        }
        if (even) continue;
        b->shift[3][i] = ball->radius + host->radius;
        b->rush[3][i] = ball->inverse_mass + host->inverse_mass;
    }
}

static SCREE_INLINE void fetch_spins(const struct ends *ends, int lane, struct block *b) {
    for (int i = lane; i < lane + WIDTH; i++) {
        const struct scree_spin *ball = ends->ball_spin[i], *host = ends->host_spin[i];
        for (int k = 0; k < 3; k++) {
            b->ball_spin[k][i] = ball->w[k];
            b->host_spin[k][i] = host->w[k];
        }
        b->ball_spin[3][i] = ball->limit;
        b->host_spin[3][i] = host->limit;
        b->radius[i] = ends->ball[i]->radius;
    }
}

static SCREE_INLINE void fetch_even_spins(const struct ends *ends, int lane, struct block *b) {
    for (int i = lane; i < lane + WIDTH; i++)
        for (int k = 0; k < 3; k++) b->ball_spin[k][i] = ends->ball_spin[i]->w[k] + ends->host_spin[i]->w[k];
}
#endif

static SCREE_INLINE void fetch_turning(const struct ends *ends, int lane, int even, struct block *b) {
    if (even)
        fetch_even_spins(ends, lane, b);
    else
        fetch_spins(ends, lane, b);
}

static SCREE_INLINE void fetch_some(const struct ends *ends, int lane, int even, struct block *b) {
    fetch_way(ends, lane, even, b);
    fetch_turning(ends, lane, even, b);
}

/* Padding repeats the last contact. */
static inline void find_ends(struct scree_record *record, const struct scree_spin *spin,
                             const struct scree_ends *contact, int count, struct ends *ends) {
    for (int k = 0; k < count; k++) {
        ends->ball[k] = &record[contact[k].ball];
        ends->host[k] = &record[contact[k].host];
        ends->ball_spin[k] = &spin[contact[k].ball];
        ends->host_spin[k] = &spin[contact[k].host];
    }
    for (int k = count; k < padded(count); k++) {
        ends->ball[k] = ends->ball[count - 1];
        ends->host[k] = ends->host[count - 1];
        ends->ball_spin[k] = ends->ball_spin[count - 1];
        ends->host_spin[k] = ends->host_spin[count - 1];
    }
}

static SCREE_INLINE void fetch_as(const struct ends *ends, int count, int balls, int even, struct block *b) {
    for (int lane = 0; lane < padded(count); lane += WIDTH) {
        fetch_some(ends, lane, even, b);
        if (balls) measure_next(b, lane, padded(count));
    }
}

static inline void fetch(const struct ends *ends, int count, int balls, int even, struct block *b) {
    if (balls && even)
        fetch_as(ends, count, 1, 1, b);
    else if (balls)
        fetch_as(ends, count, 1, 0, b);
    else
        fetch_as(ends, count, 0, 0, b);
}

/* What is seen in a block whose bodies meet. */
enum {
    CHANGES = 1, /* some meet or part within the step, or may */
    DEEPER = 2   /* some are deeper than any before, or may be */
};

static SCREE_INLINE int events_at(const struct block *b, int k, double step, double most, struct sizes sizes) {
    double way = 0.5 * SCREE_NEW * step * fabs(b->closing[k]) + SCREE_NO_SPEED;
    int changes = !(fabs(b->overlap[k]) >= way) ? CHANGES : 0;
    return changes | (!(b->overlap[k] <= most * limit_of(b, k, sizes)) ? DEEPER : 0);
}

/* CALL(one, other), with each value that two flags can have as a constant. */
#define WITH_FLAGS(one, other, CALL)                                                                                   \
    do {                                                                                                               \
        if ((one) && (other))                                                                                          \
            CALL(1, 1);                                                                                                \
        else if (one)                                                                                                  \
            CALL(1, 0);                                                                                                \
        else if (other)                                                                                                \
            CALL(0, 1);                                                                                                \
        else                                                                                                           \
            CALL(0, 0);                                                                                                \
    } while (0)

static SCREE_INLINE void find_root(struct block *b, int k) {
    b->root[k] = sqrt(b->overlap[k] > 0.0 ? b->overlap[k] : 0.0);
}

static inline void find_fourth_roots(struct block *b, int count) {
    _Pragma("omp simd")
    for (int k = 0; k < padded(count); k++) b->fourth[k] = sqrt(b->root[k]);
}

/* The roots of an overlap, as laws take them. */
static SCREE_INLINE struct scree_roots roots_at(const struct block *b, int k) {
    return (struct scree_roots){1, b->root[k], b->fourth[k]};
}

/* What is asked for with a block. */
struct wants {
    double step, most; /* s; overlap that events count from, as share of what is tolerable */
    struct sizes sizes;
    int takes_roots, remembers; /* laws need the roots of the overlap; friction has a stretch */
};

static SCREE_INLINE struct sizes sizes_if(struct sizes sizes, int even) {
    return (struct sizes){even, sizes.radii, sizes.limit};
}

static SCREE_INLINE double radii_of(const struct block *b, int k, struct sizes sizes) {
    return sizes.even ? sizes.radii : b->shift[3][k];
}

/* Normal, overlap and closing speed of two balls whose distance is known. */
static SCREE_INLINE int meet_balls_as(struct block *b, int count, struct wants wants, int even, int takes_roots) {
    struct sizes sizes = sizes_if(wants.sizes, even);
    int events = 0;
    _Pragma("omp simd reduction(| : events)")
    for (int k = 0; k < padded(count); k++) {
        double apart = b->apart[k], overlap = radii_of(b, k, sizes) - apart;
        struct vec n = scree_normal_of(get(b->shift, k), apart, b->inverse[k]);
        put(b->n, k, n);
        b->overlap[k] = overlap;
        if (takes_roots) find_root(b, k);
        b->closing[k] = -vec_dot(get(b->rush, k), n);
        b->touching[k] = b->share[k] = overlap > 0.0 ? 1.0 : 0.0;
        events |= events_at(b, k, wants.step, wants.most, sizes);
    }
    return events;
}

static inline int meet_balls(struct block *b, int count, struct wants wants) {
#define MEET(even, takes_roots) return meet_balls_as(b, count, wants, even, takes_roots)
    WITH_FLAGS(wants.sizes.even, wants.takes_roots, MEET);
#undef MEET
}

/* How two balls move at the middle of their overlap; where friction remembers a stretch, this is brought along with the
 * normal. The fourth root of the overlap goes along while there is enough else to do. */
static SCREE_INLINE void slide_lane(struct block *b, int k, double *const *kept, double step, struct sizes sizes,
                                    int remembers, int takes_roots) {
    double overlap = b->overlap[k], radii = radii_of(b, k, sizes);
    struct vec n = get(b->n, k), rush = get(b->rush, k);
    if (takes_roots) b->fourth[k] = sqrt(b->root[k]);
    struct scree_roll roll = sizes.even ? scree_roll_even(n, overlap, radii, rush, b->closing[k], get(b->ball_spin, k))
                                        : scree_roll_of(n, overlap, b->radius[k], radii, rush, b->closing[k],
                                                        get(b->ball_spin, k), get(b->host_spin, k));
    put(b->slip, k, roll.slip);
    b->lever[0][k] = roll.lever;
    b->lever[1][k] = roll.other;
    if (!remembers) return;
    double twirl = scree_twirl_angle(n, spins_at(b, k, sizes.even), step);
    put_kept(kept, k, scree_turn_along(get_kept(kept, k), n, roll.aside, step * b->inverse[k], twirl));
}

static SCREE_INLINE void slide_balls_as(struct block *b, int count, double *const *kept, struct wants wants, int even,
                                        int remembers, int takes_roots) {
    struct sizes sizes = sizes_if(wants.sizes, even);
    _Pragma("omp simd")
    for (int k = 0; k < padded(count); k++) slide_lane(b, k, kept, wants.step, sizes, remembers, takes_roots);
}

static inline void slide_balls(struct block *b, int count, double *const *kept, struct wants wants) {
#define SLIDE(even, remembers) slide_balls_as(b, count, kept, wants, even, remembers, 1)
    if (wants.takes_roots) WITH_FLAGS(wants.sizes.even, wants.remembers, SLIDE);
#undef SLIDE
#define SLIDE(even, remembers) slide_balls_as(b, count, kept, wants, even, remembers, 0)
    if (!wants.takes_roots) WITH_FLAGS(wants.sizes.even, wants.remembers, SLIDE);
#undef SLIDE
}

/* Contacts first … first + count - 1 of a batch; of two balls nobody asks for them. */
static inline void name_contacts(const struct scree_batch *batch, int first, int count, struct scree_contact *contact) {
    for (int k = 0; batch->geometry != SCREE_BALL_BALL && k < count; k++)
        contact[k] = scree_contact_at(batch, first + k);
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
    for (int lane = 0; lane < padded(count); lane += WIDTH) measure_next(b, lane, padded(count));
}

/* Partners that aren't balls, one after the other. */
static inline void meet_others(const struct scree_bodies *bodies, const struct scree_contact *contact,
                               const struct ends *ends, int count, enum scree_geometry geometry, struct block *b) {
    for (int lane = 0; lane < padded(count); lane++) {
        const struct scree_contact *one = &contact[lane < count ? lane : count - 1];
        struct vec corner = vec_from(bodies->corner[one->corner]);
        struct vec centre = vec_add(vec_from(ends->ball[lane]->x), corner);
        struct scree_meeting m = scree_meet_at(bodies, one, geometry, centre, ends->ball[lane]->radius);
        put(b->corner, lane, corner);
        put(b->n, lane, m.normal);
        b->overlap[lane] = m.overlap;
    }
}

/* Planes: where all is spheres, only where planes face is found one after the other. */
static inline void meet_planes(const struct scree_bodies *bodies, const struct scree_batch *batch,
                               const struct scree_contact *contact, const struct ends *ends, int count,
                               struct block *b) {
    if (batch->corner) {
        meet_others(bodies, contact, ends, count, SCREE_BALL_PLANE, b);
        return;
    }
    for (int lane = 0; lane < padded(count); lane++)
        put(b->n, lane, scree_attitude_of(bodies, contact[lane < count ? lane : count - 1].host)->frame.column[2]);
    _Pragma("omp simd")
    for (int k = 0; k < padded(count); k++) {
        put(b->corner, k, vec(0.0, 0.0, 0.0));
        b->overlap[k] = b->radius[k] - vec_dot(get(b->n, k), get(b->shift, k));
    }
}

static inline void move_all(int count, struct block *b) {
    _Pragma("omp simd")
    for (int k = 0; k < padded(count); k++) {
        struct vec n = normal_at(b, k);
        struct vec corner = vec(b->corner[0][k], b->corner[1][k], b->corner[2][k]);
        struct scree_gait gait = scree_gait_of(n, b->overlap[k], b->radius[k], corner, shift_at(b, k),
                                               vec(b->rush[0][k], b->rush[1][k], b->rush[2][k]),
                                               vec(b->ball_spin[0][k], b->ball_spin[1][k], b->ball_spin[2][k]),
                                               vec(b->host_spin[0][k], b->host_spin[1][k], b->host_spin[2][k]));
        put(b->arm, k, gait.arm);
        put(b->slip, k, gait.slip);
        b->closing[k] = gait.closing;
        b->touching[k] = b->share[k] = b->overlap[k] > 0.0 ? 1.0 : 0.0;
    }
}

/* A stretch that was kept a step ago, as bodies have turned since. */
static SCREE_INLINE struct vec turned_stretch(const struct block *b, int k, double *const *kept, double step) {
    return scree_turned(get_kept(kept, k), normal_at(b, k), spins_at(b, k, 0), step);
}

/* Of contacts that aren't of two balls. */
static inline void turn_stretches(const struct block *b, int count, double step, double *const *kept) {
    _Pragma("omp simd")
    for (int k = 0; k < padded(count); k++) put_kept(kept, k, turned_stretch(b, k, kept, step));
}

/* The events of contacts that aren't of two balls, and their roots. */
static inline int see(struct block *b, int count, struct wants wants) {
    const struct sizes any = {0};
    int events = 0;
    _Pragma("omp simd reduction(| : events)")
    for (int k = 0; k < padded(count); k++) events |= events_at(b, k, wants.step, wants.most, any);
    if (!wants.takes_roots) return events;
    _Pragma("omp simd")
    for (int k = 0; k < padded(count); k++) find_root(b, k);
    find_fourth_roots(b, count);
    return events;
}

static inline void share_out(int count, double step, struct block *b) {
    _Pragma("omp simd")
    for (int k = 0; k < padded(count); k++) {
        b->half_steps_in[k] = scree_met_lately(scree_half_steps_in(b->overlap[k], b->closing[k], step));
        b->share[k] = scree_share_of(b->half_steps_in[k]);
    }
}

/* `contact`: as name_contacts gives them. How two balls slide isn't found yet. Returns the events. */
static inline int gather(const struct scree_bodies *bodies, const struct scree_batch *batch,
                         const struct scree_contact *contact, const struct ends *ends, int count, struct wants wants,
                         struct block *b) {
    enum scree_geometry geometry = batch->geometry;
    int balls = geometry == SCREE_BALL_BALL || geometry == SCREE_BALL_IMAGE;
    fetch(ends, count, balls, wants.sizes.even, b);
    switch (geometry) { /* constant arguments: each case becomes a loop of its own */
    case SCREE_BALL_IMAGE:
        bring_images(bodies, contact, count, b);
        return meet_balls(b, count, wants);
    case SCREE_BALL_BALL:
        return meet_balls(b, count, wants);
    case SCREE_BALL_PLANE:
        meet_planes(bodies, batch, contact, ends, count, b);
        break;
    case SCREE_BALL_RECTANGLE:
        meet_others(bodies, contact, ends, count, SCREE_BALL_RECTANGLE, b);
        break;
    default:
        meet_others(bodies, contact, ends, count, SCREE_BALL_BOX, b);
        break;
    }
    move_all(count, b);
    return see(b, count, wants);
}

/* ---- edges on edges ---- */

/* What they do besides pushing at the middle of their overlap (scree_lean_of), and what they close in faster than laws
 * are told, m/s. */
struct lean {
    double force[3][SCREE_LANES], turn_ball[3][SCREE_LANES], turn_host[3][SCREE_LANES];
    double untold[SCREE_LANES];
    double borne[SCREE_LANES]; /* scree_borne */
};

/* What can't touch, or is padding. */
static inline void gather_nothing(struct block *b, int lane, struct lean *lean) {
    struct vec zero = {0.0, 0.0, 0.0};
    put(b->n, lane, vec(0.0, 0.0, 1.0));
    put(b->arm, lane, zero);
    put(b->slip, lane, zero);
    b->overlap[lane] = SCREE_OUTSIDE;
    b->touching[lane] = b->share[lane] = b->closing[lane] = lean->untold[lane] = 0.0;
    lean->borne[lane] = 1.0;
    put(lean->force, lane, zero);
    put(lean->turn_ball, lane, zero);
    put(lean->turn_host, lane, zero);
}

static inline void gather_crossing(const struct scree_bodies *bodies, const struct scree_contact *contact,
                                   const struct scree_two_boxes *boxes, enum scree_geometry geometry, struct block *b,
                                   int lane, struct lean *lean) {
    struct scree_crossing c = scree_cross(boxes, contact, geometry);
    struct scree_gait gait = scree_gait_on_edges(bodies, contact, &c);
    struct scree_gradient leans = scree_lean_of(&c, boxes->apart);
    put(b->n, lane, c.meeting.normal);
    put(b->arm, lane, gait.arm);
    put(b->slip, lane, gait.slip);
    b->overlap[lane] = c.meeting.overlap;
    b->touching[lane] = b->share[lane] = c.meeting.overlap > 0.0 ? 1.0 : 0.0;
    b->closing[lane] = gait.closing;
    lean->untold[lane] = gait.untold;
    lean->borne[lane] = scree_borne(&c, &leans, boxes->inset.by > 0.0);
    put(lean->force, lane, leans.force);
    put(lean->turn_ball, lane, leans.turn_a);
    put(lean->turn_host, lane, leans.turn_b);
}

/* Whether two boxes may touch edge on edge in this step, whose own way counts too: a contact that begins in it is felt
 * from its beginning. Where they can't, all would come out as zero. */
static inline int may_cross(const struct scree_bodies *bodies, const struct scree_contact *contact,
                            const struct scree_run *run, double step) {
    double way = bodies->path[contact->ball] + bodies->path[contact->host] - run->from;
    double haste = scree_fastest_point(bodies, contact->ball) + scree_fastest_point(bodies, contact->host);
    if (way < run->clear && way + step * haste < run->clear) return 0;
    struct scree_two_boxes boxes = scree_two_boxes_of(bodies, contact->ball, contact->host);
    return !scree_meet_as_rectangles(&boxes, run->first);
}

/* Contacts first … first + count - 1 of segment 0, a block of it. Returns 0 if nothing can touch; then nothing is
 * gathered. */
static inline int gather_crossings(const struct scree_bodies *bodies, const struct scree_batch *batch, int first,
                                   int count, double step, struct block *b, struct lean *lean) {
    struct scree_contact contact[SCREE_LANES];
    int own_first = batch->segment[0].first, start = first - own_first,
        first_run = batch->first_run[start / SCREE_LANES];
    int runs = 0, any = 0, may[SCREE_LANES];
    const struct scree_run *run = batch->run + first_run;
    for (; first_run + runs < batch->runs && run[runs].start < start + count; runs++) {
        struct scree_contact begins = scree_contact_at(batch, own_first + run[runs].start);
        any |= may[runs] = may_cross(bodies, &begins, &run[runs], step);
    }
    if (!any) return 0;
    struct ends ends = {.ball = {NULL}}; /* gcc 16 doesn't see that there is a contact */
    find_ends(bodies->record, bodies->spin, batch->ends + first, count, &ends);
    name_contacts(batch, first, count, contact);
    fetch(&ends, count, 0, 0, b);
    struct scree_two_boxes boxes = {.a = NULL};
    for (int lane = 0, own = 0; lane < padded(count); lane++) {
        int begins = lane == 0;
        if (own + 1 < runs && start + lane == run[own + 1].start) own += begins = 1;
        if (lane < count && may[own]) {
            if (begins) boxes = scree_deep_boxes_of(bodies, &contact[lane]);
            gather_crossing(bodies, &contact[lane], &boxes, SCREE_EDGE_EDGE, b, lane, lean);
        } else
            gather_nothing(b, lane, lean);
    }
    return 1;
}

/* Corners on boxes, of boxes that are deeper in each other than their roundings: they lean as well. Returns whether
 * there are any. */
static inline int deepen_corners(const struct scree_bodies *bodies, const struct scree_contact *contact, int count,
                                 struct block *b, struct lean *lean) {
    struct scree_two_boxes boxes = {.a = NULL};
    int any = 0;
    for (int lane = 0; lane < count; lane++) {
        const struct scree_contact *one = &contact[lane];
        if (one->corner == 0) continue; /* a sphere */
        int same = lane > 0 && one->ball == one[-1].ball && one->host == one[-1].host;
        if (!same) boxes = scree_deep_boxes_of(bodies, one);
        if (!(boxes.inset.by > 0.0)) continue;
        if (!any) {
            memset(lean, 0, sizeof *lean);
            for (int k = 0; k < SCREE_LANES; k++) lean->borne[k] = 1.0;
        }
        any = 1;
        gather_crossing(bodies, one, &boxes, SCREE_BALL_BOX, b, lane, lean);
    }
    return any;
}

#endif
