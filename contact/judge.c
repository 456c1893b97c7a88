/* Which of some pairs of spheres come near each other, for near lists: rows of both bodies become columns, and nothing
 * branches on chance. Compiled once for each kind of processor, as loop.c is. */
#include "contact/approach.h"
#include "contact/block.h"
#include "contact/loop.h"

/* Columns: from the host to the ball, m, with the sum of their radii; difference of their flights, m/s. */
struct ways {
    _Alignas(64) double apart[4][SCREE_LANES];
    double flight[4][SCREE_LANES];
};

#if defined __AVX512F__
static SCREE_INLINE scree_row flight_of(const struct scree_bodies *bodies, int k) {
    return scree_row_of_floats(scree_flight_row(bodies, k));
}

static SCREE_INLINE void fetch_ways(const struct scree_bodies *bodies, const struct scree_contact *pair, int lane,
                                    struct ways *to) {
    wide_row r[8];
    for (int i = 0; i < 8; i++) {
        int ball = pair[lane + i].ball, host = pair[lane + i].host;
        wide_row a = wide_of(*(const scree_row *)bodies->record[ball].x, flight_of(bodies, ball));
        r[i] = a - wide_turned(wide_of(*(const scree_row *)bodies->record[host].x, flight_of(bodies, host)));
    }
    transpose_wide(r);
    store_wide(r, 4, to->apart, lane);
    store_wide(r + 4, 3, to->flight, lane);
}
#elif defined __AVX__
static SCREE_INLINE void fetch_ways(const struct scree_bodies *bodies, const struct scree_contact *pair, int lane,
                                    struct ways *to) {
    const scree_row sign = {1.0, 1.0, 1.0, -1.0};
    scree_row apart[4], flight[4];
    for (int i = 0; i < 4; i++) {
        int ball = pair[lane + i].ball, host = pair[lane + i].host;
        apart[i] = *(const scree_row *)bodies->record[ball].x - *(const scree_row *)bodies->record[host].x * sign;
        flight[i] =
            scree_row_of_floats(scree_flight_row(bodies, ball)) - scree_row_of_floats(scree_flight_row(bodies, host));
    }
    store_columns(apart, 4, to->apart, lane);
    store_columns(flight, 3, to->flight, lane);
}
#else
static SCREE_INLINE void fetch_ways(const struct scree_bodies *bodies, const struct scree_contact *pair, int lane,
                                    struct ways *to) {
    for (int i = lane; i < lane + WIDTH; i++) {
        const struct scree_record *ball = &bodies->record[pair[i].ball], *host = &bodies->record[pair[i].host];
        const float *one = scree_flight_row(bodies, pair[i].ball), *other = scree_flight_row(bodies, pair[i].host);
        for (int k = 0; k < 3; k++) {
            to->apart[k][i] = ball->x[k] - host->x[k];
            to->flight[k][i] = (double)one[k] - (double)other[k];
        }
        to->apart[3][i] = ball->radius + host->radius;
    }
}
#endif

uint32_t SCREE_PART(judge)(const struct scree_contacts *contacts, const struct scree_bodies *bodies,
                           const struct scree_contact *pair, int count) {
    struct ways ways;
    double left[SCREE_LANES], ahead = bodies->flight ? contacts->flights.ahead : 0.0;
    double back = scree_half_step_of(contacts, bodies);
    uint32_t near = 0;
    for (int lane = 0; lane < padded(count); lane += WIDTH) fetch_ways(bodies, pair, lane, &ways);
    for (int k = 0; k < padded(count); k++) left[k] = scree_left_of(contacts, bodies, pair[k].ball, pair[k].host);
    _Pragma("omp simd reduction(| : near)")
    for (int k = 0; k < padded(count); k++) {
        struct vec flown = vec_scale(ahead, get(ways.flight, k));
        double reach = ways.apart[3][k] + (left[k] + contacts->flights.bend);
        near |= (uint32_t)scree_come_near(get(ways.apart, k), flown, back, reach) << k;
    }
    return near;
}
