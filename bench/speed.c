/* What the processor's arithmetic can do at best, in loops over columns like the contact loop's (roofline.h). Compiled
 * once for each kind of processor, as contact/loop.c is. */
#include "bench/roofline.h"

#include <math.h>

enum { COLUMN = 512 }; /* numbers, which stay in the first cache */

/* Eight products and eight sums of each number, most of which don't wait for each other. */
static void multiply_and_add(double *restrict x) {
    _Pragma("omp simd")
    for (int k = 0; k < COLUMN; k++) {
        double y = x[k], a = y * 0.1 + y * 0.2, b = y * 0.3 + y * 0.4, c = y * -0.1 + y * -0.2, d = y * -0.3 + y * 0.25;
        x[k] = ((a + b) + (c + d)) + 0.5;
    }
}

static void divide(double *restrict x) {
    _Pragma("omp simd")
    for (int k = 0; k < COLUMN; k++) x[k] = 1.5 / x[k];
}

static void take_roots(double *restrict x) {
    _Pragma("omp simd")
    for (int k = 0; k < COLUMN; k++) x[k] = sqrt(x[k]);
}

/* Nanoseconds for one of the operations, of which a call makes so many. */
static double time_of(void (*work)(double *restrict), double operations) {
    static double x[COLUMN];
    double least = INFINITY;
    for (int k = 0; k < COLUMN; k++) x[k] = 1.0 + 1e-3 * k;
    for (int try = 0; try < 7; try++) {
        const int calls = 2000;
        double start = bench_now();
        for (int call = 0; call < calls; call++) work(x);
        least = fmin(least, (bench_now() - start) / calls);
    }
    return least / operations * 1e9;
}

struct bench_speed SCREE_SPEED(void) {
    return (struct bench_speed){time_of(multiply_and_add, 16.0 * COLUMN), time_of(divide, COLUMN),
                                time_of(take_roots, COLUMN)};
}
