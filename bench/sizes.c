/* Beds of spheres of many sizes, out of a settled bed of one: larger spheres take the place of those that are in their
 * way. So hardly anything falls, and what is heavy crushes nothing. */
#include "bench/bench.h"

#include "engine/cli/cli.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static void *space(size_t size) {
    void *memory = calloc(1, size);
    if (!memory) exit(cli_complain("no memory for %zu bytes of spheres", size));
    return memory;
}

struct bench_spheres bench_make_spheres(int count) {
    size_t n = (size_t)count;
    struct bench_spheres spheres = {.count = count};
    spheres.position = space(n * sizeof *spheres.position);
    spheres.velocity = space(n * sizeof *spheres.velocity);
    spheres.spin = space(n * sizeof *spheres.spin);
    spheres.radius = space(n * sizeof *spheres.radius);
    return spheres;
}

void bench_free_spheres(struct bench_spheres *spheres) {
    free(spheres->position);
    free(spheres->velocity);
    free(spheres->spin);
    free(spheres->radius);
}

double bench_random(uint64_t *seed) {
    *seed = *seed * 6364136223846793005u + 1442695040888963407u;
    return (double)(*seed >> 11) * 0x1p-53;
}

/* Larger spheres: centres and radii, by columns. */
struct larger {
    int count;
    double *x, *y, *z, *radius;
};

/* Whether a sphere is deeper than `overlap` in one of them. */
static int hits(const struct larger *l, const double at[3], double radius, double overlap) {
    int any = 0;
    _Pragma("omp simd reduction(| : any)")
    for (int k = 0; k < l->count; k++) {
        double x = l->x[k] - at[0], y = l->y[k] - at[1], z = l->z[k] - at[2], reach = l->radius[k] + radius - overlap;
        any |= x * x + y * y + z * z < reach * reach;
    }
    return any;
}

/* One sphere somewhere in the bed, on the floor if it is larger than that is deep; 0 if there was no place. */
static int place(struct larger *l, double radius, double edge, double depth, uint64_t *seed) {
    for (int tries = 0; tries < 10000; tries++) {
        double at[3] = {radius + (edge - 2.0 * radius) * bench_random(seed),
                        radius + (edge - 2.0 * radius) * bench_random(seed),
                        radius + fmax(depth - 2.0 * radius, 0.0) * bench_random(seed)};
        if (hits(l, at, radius, 0.0)) continue;
        l->x[l->count] = at[0];
        l->y[l->count] = at[1];
        l->z[l->count] = at[2];
        l->radius[l->count++] = radius;
        return 1;
    }
    return 0;
}

static double depth_of(const struct bench_spheres *spheres) {
    double depth = 0.0;
    for (int k = 0; k < spheres->count; k++) depth = fmax(depth, spheres->position[k][2] + spheres->radius[k]);
    return depth;
}

/* Each size sqrt(10) times as large as the next one and a hundredth as often, so that each fills a third of what the
 * next does; at least one. */
struct bench_spheres bench_mix_sizes(const struct bench_spheres *small, double edge, double ratio) {
    enum { SIZES = 16 }; /* more than there are between 1 and any ratio that is allowed */
    uint64_t seed = 11;
    size_t most = (size_t)small->count + SIZES;
    double unit = small->radius[0], depth = depth_of(small);
    if (2.0 * ratio * unit > edge)
        exit(cli_complain("a sphere of %g m doesn't fit between walls %g m apart: take more --tiles", ratio * unit,
                          edge));
    struct larger l = {0, space(most * sizeof(double)), space(most * sizeof(double)), space(most * sizeof(double)),
                       space(most * sizeof(double))};
    for (double size = ratio; size > 1.5; size /= sqrt(10.0)) {
        int wanted = (int)fmax(1.0, small->count * pow(100.0, -round(2.0 * log10(size))));
        for (int k = 0; k < wanted; k++)
            if (!place(&l, size * unit, edge, depth, &seed)) break;
    }
    struct bench_spheres mixed = bench_make_spheres(small->count + l.count);
    mixed.count = 0;
    for (int k = 0; k < l.count; k++) {
        memcpy(mixed.position[mixed.count], (double[]){l.x[k], l.y[k], l.z[k]}, sizeof *mixed.position);
        mixed.radius[mixed.count++] = l.radius[k];
    }
    for (int k = 0; k < small->count; k++) {
        if (hits(&l, small->position[k], unit, 0.01 * unit)) continue;
        memcpy(mixed.position[mixed.count], small->position[k], sizeof *mixed.position);
        mixed.radius[mixed.count++] = unit;
    }
    free(l.x);
    free(l.y);
    free(l.z);
    free(l.radius);
    return mixed;
}
