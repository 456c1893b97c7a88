/* How far two rounded boxes are apart, or in each other, by a way that has nothing in common with the collider: the set
 * of all differences of a point of the one and a point of the other core is a zonotope, of six generators; its point
 * nearest to zero by P. Wolfe, "Finding the nearest point in a polytope", Math. Programming 11 (1976) 128, and while
 * zero is inside, its nearest face, the normals of which are the products of two generators. Slow, and exact to
 * rounding. And random pairs to try a collider on. */
#ifndef SCREE_TESTS_BOXES_ORACLE_H
#define SCREE_TESTS_BOXES_ORACLE_H

#include "bodies/elementary.h"
#include "contact/crossing.h"

#include <stdint.h>

enum { ORACLE_GENERATORS = 6 };

struct oracle_zonotope {
    int generators;
    struct vec centre, generator[ORACLE_GENERATORS];
};

static inline void oracle_add(struct oracle_zonotope *z, const struct scree_attitude *box) {
    for (int k = 0; k < 3; k++) z->generator[z->generators++] = vec_scale(box->half[k], box->frame.column[k]);
}

/* The vertex farthest along a direction. */
static inline struct vec oracle_support(const struct oracle_zonotope *z, struct vec direction) {
    struct vec p = z->centre;
    for (int k = 0; k < z->generators; k++)
        p = vec_axpy(p, vec_dot(z->generator[k], direction) < 0.0 ? -1.0 : 1.0, z->generator[k]);
    return p;
}

/* A corral: up to 4 points; those that the nearest point lies between come first. */
struct oracle_corral {
    int count;
    struct vec p[4], nearest;
};

/* Keep the points of `set` if the point nearest to zero of their flat lies between them, and nearer than what is
 * known. */
static inline void oracle_try(const struct vec *p, int count, struct oracle_corral *best) {
    double weight[3] = {1.0, 0.0, 0.0};
    struct vec u = vec_sub(p[count > 1], p[0]), v = vec_sub(p[count > 2 ? 2 : 0], p[0]), x = p[0];
    if (count == 2) {
        weight[1] = -vec_dot(u, p[0]) / vec_norm2(u);
        weight[0] = 1.0 - weight[1];
        x = vec_axpy(p[0], weight[1], u);
    }
    if (count == 3) {
        struct vec n = vec_cross(u, v), back = vec_scale(-1.0, p[0]);
        double square = vec_norm2(n);
        weight[1] = vec_dot(n, vec_cross(back, v)) / square;
        weight[2] = vec_dot(n, vec_cross(u, back)) / square;
        weight[0] = 1.0 - weight[1] - weight[2];
        x = vec_scale(vec_dot(n, p[0]) / square, n);
    }
    for (int k = 0; k < count; k++)
        if (!(weight[k] > 0.0)) return;
    if (!(vec_norm2(x) < vec_norm2(best->nearest))) return;
    best->count = count;
    for (int k = 0; k < count; k++) best->p[k] = p[k];
    best->nearest = x;
}

/* The point nearest to zero of the hull of some points that doesn't hold zero: of all their triangles, edges and
 * corners. */
static inline void oracle_reduce(struct oracle_corral *corral) {
    struct oracle_corral best = {1, {corral->p[0]}, corral->p[0]};
    for (int set = 1; set < 1 << corral->count; set++) {
        struct vec p[4];
        int count = 0;
        for (int k = 0; k < corral->count; k++)
            if (set >> k & 1) p[count++] = corral->p[k];
        if (count < 4) oracle_try(p, count, &best);
    }
    *corral = best;
}

/* Distance of zero from a zonotope that doesn't hold it. */
static inline double oracle_distance(const struct oracle_zonotope *z, double size) {
    struct oracle_corral corral = {.count = 1, .p = {oracle_support(z, vec_scale(-1.0, z->centre))}};
    corral.nearest = corral.p[0];
    double before = HUGE_VAL;
    for (int round = 0; round < 100; round++) {
        struct vec x = corral.nearest, v = oracle_support(z, vec_scale(-1.0, x));
        double distance = vec_norm(x);
        /* No point of the zonotope is nearer than x.v/|x|: stop where that is as good as |x|. */
        if (vec_dot(x, vec_sub(x, v)) <= 1e-14 * size * distance || !(distance < before)) break;
        before = distance;
        corral.p[corral.count++] = v;
        oracle_reduce(&corral);
    }
    return vec_norm(corral.nearest);
}

/* How deep zero is inside: the least over the faces. */
static inline double oracle_depth(const struct oracle_zonotope *z, double size) {
    double least = HUGE_VAL;
    for (int i = 0; i < z->generators; i++)
        for (int j = i + 1; j < z->generators; j++) {
            struct vec n = vec_cross(z->generator[i], z->generator[j]);
            double length = vec_norm(n);
            if (length <= 1e-9 * size * size) continue; /* as good as parallel */
            n = vec_scale(1.0 / length, n);
            least = scree_least(least, vec_dot(n, oracle_support(z, n)));
            least = scree_least(least, -vec_dot(n, oracle_support(z, vec_scale(-1.0, n))));
        }
    return least < HUGE_VAL ? least : 0.0; /* a point or a line has no faces */
}

/* Overlap of whatever the zonotope stands for, swept by a ball; negative: the gap. */
static inline double oracle_overlap(const struct oracle_zonotope *z, double rounding) {
    double size = vec_norm(z->centre);
    for (int k = 0; k < z->generators; k++) size += vec_norm(z->generator[k]);
    double depth = oracle_depth(z, size);
    return rounding + (depth > 0.0 ? depth : -oracle_distance(z, size));
}

static inline double oracle_boxes(const struct scree_two_boxes *boxes) {
    struct oracle_zonotope z = {.centre = boxes->apart};
    oracle_add(&z, boxes->a);
    oracle_add(&z, boxes->b);
    return oracle_overlap(&z, boxes->rounding_a + boxes->rounding_b);
}

static inline double oracle_sphere(struct vec centre, double radius, const struct scree_attitude *box,
                                   double rounding) {
    struct oracle_zonotope z = {.centre = centre};
    oracle_add(&z, box);
    return oracle_overlap(&z, radius + rounding);
}

/* ---- random pairs ---- */

/* Uniform in [0, 1), the same sequence everywhere (xorshift64*, Vigna 2016). */
static inline double oracle_random(uint64_t *seed) {
    *seed ^= *seed >> 12;
    *seed ^= *seed << 25;
    *seed ^= *seed >> 27;
    return (double)((*seed * 0x2545f4914f6cdd1du) >> 11) * 0x1p-53;
}

static inline struct vec oracle_direction(uint64_t *seed) {
    for (;;) {
        double x = 2.0 * oracle_random(seed) - 1.0, y = 2.0 * oracle_random(seed) - 1.0;
        struct vec v = vec(x, y, 2.0 * oracle_random(seed) - 1.0);
        double size = vec_norm(v);
        if (size > 0.1 && size <= 1.0) return vec_scale(1.0 / size, v);
    }
}

static inline struct quat oracle_attitude(uint64_t *seed) {
    struct vec axis = oracle_direction(seed);
    double half = 3.14159265358979323846 * oracle_random(seed);
    return (struct quat){cos(half), sin(half) * axis.x, sin(half) * axis.y, sin(half) * axis.z};
}

/* Edges of six shapes: cube, brick, plate, beam, needle, leaf. */
enum { ORACLE_SHAPES = 6 };
static const double oracle_edges[ORACLE_SHAPES][3] = {{1.0, 1.0, 1.0}, {1.0, 0.7, 0.4},  {1.0, 1.0, 0.2},
                                                      {1.0, 0.3, 0.3}, {1.0, 0.1, 0.12}, {1.0, 0.6, 0.05}};

struct oracle_pair {
    struct scree_attitude a, b;
    struct scree_two_boxes boxes;
    double thinnest; /* shortest edge of the two, m */
};

static inline void oracle_box(struct scree_attitude *box, int shape, double rounding, struct quat q) {
    *box = (struct scree_attitude){.frame = quat_to_mat(q)};
    for (int k = 0; k < 3; k++) box->half[k] = 0.5 * oracle_edges[shape][k] - rounding;
}

static inline double oracle_thickness(int shape) {
    return fmin(oracle_edges[shape][0], fmin(oracle_edges[shape][1], oracle_edges[shape][2]));
}

/* Slide box a towards b along `way` until they overlap by `wanted`, to some 1e-3 of it. */
static inline void oracle_bring_together(struct oracle_pair *pair, struct vec way, double wanted) {
    double apart = 4.0, together = 0.0;
    for (int k = 0; k < 14; k++) {
        double middle = 0.5 * (apart + together);
        pair->boxes.apart = vec_scale(middle, way);
        if (oracle_boxes(&pair->boxes) > wanted)
            together = middle;
        else
            apart = middle;
    }
}

/* A pair of boxes whose overlap, or gap, is random: up to 0.49 of the thinner one deep (`deepest` of the roundings
 * instead, if that isn't 0). Every fourth pair has an axis in common, or nearly. `roundness` is the rounding in parts
 * of half the shortest edge. */
static inline void oracle_random_pair(struct oracle_pair *pair, uint64_t *seed, double roundness, double deepest) {
    int first = (int)(ORACLE_SHAPES * oracle_random(seed)), second = (int)(ORACLE_SHAPES * oracle_random(seed));
    double thin_a = oracle_thickness(first), thin_b = oracle_thickness(second);
    pair->thinnest = fmin(thin_a, thin_b);
    struct quat q = oracle_attitude(seed), p = oracle_attitude(seed);
    double kind = oracle_random(seed), tilt = kind < 0.06 ? 0.0 : pow(10.0, -8.0 * oracle_random(seed));
    if (kind < 0.25) { /* turned about a common axis, then tilted */
        double half = kind < 0.03 ? 0.0 : 1.6 * oracle_random(seed);
        struct vec axis = oracle_direction(seed);
        struct quat about = {cos(half), 0.0, 0.0, sin(half)};
        struct quat little = {1.0, tilt * axis.x, tilt * axis.y, tilt * axis.z};
        p = quat_multiply(q, quat_multiply(about, quat_normalise(little)));
    }
    double rounding_a = 0.5 * roundness * thin_a, rounding_b = 0.5 * roundness * thin_b;
    oracle_box(&pair->a, first, rounding_a, q);
    oracle_box(&pair->b, second, rounding_b, p);
    pair->boxes =
        (struct scree_two_boxes){&pair->a, &pair->b, vec(0.0, 0.0, 0.0), rounding_a, rounding_b, {.factor = 1.0}};
    double most = deepest > 0.0 ? deepest * (rounding_a + rounding_b) : 0.49 * pair->thinnest;
    double share = oracle_random(seed);
    double wanted = share < 0.2 ? -most * share : most * pow(10.0, -4.0 * (share - 0.2));
    oracle_bring_together(pair, oracle_direction(seed), wanted);
}

/* ---- what the collider makes of a pair ---- */

struct oracle_verdict {
    double truth, deepest; /* overlap by the oracle, and of the deepest contact */
    int corners, crossings;
};

/* The boxes seen from the other one. */
static inline struct scree_two_boxes oracle_swap(const struct scree_two_boxes *boxes) {
    return (struct scree_two_boxes){.a = boxes->b,
                                    .b = boxes->a,
                                    .apart = vec_scale(-1.0, boxes->apart),
                                    .rounding_a = boxes->rounding_b,
                                    .rounding_b = boxes->rounding_a,
                                    .inset = {.factor = 1.0}};
}

static inline void oracle_judge_corners(struct scree_two_boxes boxes, struct oracle_verdict *v) {
    scree_draw_in(&boxes);
    for (int k = 0; k < 8; k++) {
        struct scree_crossing c = scree_meet_corner(&boxes, k);
        v->corners += c.meeting.overlap > 0.0;
        v->deepest = scree_most(v->deepest, c.meeting.overlap);
    }
}

static inline struct oracle_verdict oracle_judge(const struct oracle_pair *pair) {
    struct scree_two_boxes boxes = pair->boxes;
    struct oracle_verdict v = {.truth = oracle_boxes(&boxes), .deepest = -HUGE_VAL};
    oracle_judge_corners(boxes, &v);
    oracle_judge_corners(oracle_swap(&boxes), &v);
    scree_draw_in(&boxes);
    for (int e = 0; e < SCREE_EDGES * SCREE_EDGES; e++) {
        struct scree_crossing c = scree_meet_edges(&boxes, e / SCREE_EDGES, e % SCREE_EDGES);
        v.crossings += c.meeting.overlap > 0.0;
        v.deepest = scree_most(v.deepest, c.meeting.overlap);
    }
    return v;
}

/* What came of many pairs. */
struct oracle_count {
    long touching, edges, phantoms, missed, deeper; /* edges: touching only with them */
    double worst;                                   /* largest excess over the truth, or depth that was missed, m */
};

/* Overlaps are told apart from gaps down to this, m; edges are up to 1 m long. */
static const double oracle_tolerance = 1e-12;

static inline void oracle_count_one(double truth, double deepest, struct oracle_count *count) {
    int phantom = deepest > 0.0 && truth<-oracle_tolerance, missed = truth> oracle_tolerance && !(deepest > 0.0);
    int deeper = !phantom && deepest > 0.0 && deepest > truth + oracle_tolerance;
    count->touching += truth > 0.0;
    count->phantoms += phantom;
    count->missed += missed;
    count->deeper += deeper;
    if (phantom || missed || deeper) count->worst = scree_most(count->worst, fabs(fmax(deepest, 0.0) - truth));
}

static inline void oracle_try_boxes(uint64_t *seed, double roundness, double deepest, struct oracle_count *count) {
    struct oracle_pair pair;
    oracle_random_pair(&pair, seed, roundness, deepest);
    struct oracle_verdict v = oracle_judge(&pair);
    oracle_count_one(v.truth, v.deepest, count);
    count->edges += v.truth > 0.0 && v.crossings > 0 && v.corners == 0;
}

/* A sphere on a box: of any size, up to half of its radius or of the box's thickness deep, or beside it. */
static inline void oracle_try_sphere(uint64_t *seed, struct oracle_count *count) {
    struct scree_attitude box;
    int shape = (int)(ORACLE_SHAPES * oracle_random(seed));
    double thin = oracle_thickness(shape), rounding = oracle_random(seed) < 0.3 ? 0.0 : 0.1 * thin;
    double radius = thin * pow(10.0, 2.0 * oracle_random(seed) - 1.0);
    oracle_box(&box, shape, rounding, oracle_attitude(seed));
    struct vec way = oracle_direction(seed);
    double apart = 2.0 + 10.0 * thin, together = 0.0, share = oracle_random(seed), most = 0.5 * fmin(radius, thin);
    double wanted = share < 0.2 ? -most * share : most * pow(10.0, -4.0 * (share - 0.2));
    for (int k = 0; k < 12; k++) {
        double middle = 0.5 * (apart + together);
        if (oracle_sphere(vec_scale(middle, way), radius, &box, rounding) > wanted)
            together = middle;
        else
            apart = middle;
    }
    struct vec centre = vec_scale(apart, way);
    struct scree_meeting m = scree_meet_box(centre, radius, (struct scree_whole){centre, NULL}, vec(0.0, 0.0, 0.0),
                                            &box.frame, box.half, rounding);
    oracle_count_one(oracle_sphere(centre, radius, &box, rounding), m.overlap, count);
}

#endif
