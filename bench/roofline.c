/* Counts, and the machine's limits, for scree-bench hot. */
#define _GNU_SOURCE /* syscall */
#include "bench/roofline.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The header that says how to count instructions comes with the kernel: without it none are. */
#if defined __linux__ && __has_include(<linux/perf_event.h>)
#define COUNTS_INSTRUCTIONS
#include <linux/perf_event.h>
#include <sys/ioctl.h>
#include <sys/syscall.h>
#include <unistd.h>
#endif

/* ---- what a contact takes ---- */

/* Counted pass by pass in contact/block.h, passes.h and push.h for balls of one size; signs, comparisons and choices
 * don't count, nor what a step adds in which bodies meet or part. */
static const struct {
    const char *laws;
    struct bench_work work;
} counted[] = {
    /* fetch 15, meet 11, slide 69, normal 8, friction 25, its trial 14, share 1 and end 20, push 33; quotients: fetch
     * 1, friction 1, share 1; roots: distance, overlap twice, trial */
    {"mindlin", {196, 3, 4, 0.0}},
    /* normal 6 and friction, behind a bare spring, 2; quotients: fetch 1, share 1; roots: distance, trial */
    {"linear", {171, 2, 2, 0.0}},
    /* fetch 15, meet 11, normal 7, push 12 */
    {"plain", {45, 1, 3, 0.0}},
};

struct bench_work bench_contact_work(const scree_scene *scene, const char *laws, double contacts) {
    const struct scree_bodies *bodies = &scene->bodies;
    const struct scree_contacts *all = &scene->contacts;
    struct bench_work work = {0};
    if (!(contacts > 0.0)) return work;                          /* nothing is near anything */
    const struct scree_batch *batch = &all->batch[all->busy[0]]; /* all keep the same: there is one pair of laws */
    for (size_t k = 0; k < sizeof counted / sizeof *counted && bodies->even > 0.0; k++)
        if (strcmp(laws, counted[k].laws) == 0) work = counted[k].work;
    size_t read = sizeof *batch->ends, both = batch->slides ? 1 : 0;
    for (int m = 0; m < SCREE_MEMORY; m++)
        if (batch->kept[m]) both += sizeof(double);
    double records = fmin(1.0 / contacts, 2.0); /* its share of those that are gone through */
    work.bytes = (double)(read + 2 * both) + 2.0 * records * (sizeof *bodies->record + sizeof *bodies->spin);
    return work;
}

/* ---- what the machine can do ---- */

/* Nanoseconds for a byte that is read, changed and written, in a field of so many bytes: half for each way. */
static double time_of_byte(double bytes) {
    size_t count = (size_t)(bytes / sizeof(double)) + 1;
    double *field = malloc(count * sizeof *field), least = INFINITY;
    if (!field) return NAN;
    for (size_t k = 0; k < count; k++) field[k] = 1.0;
    int calls = 1 + (int)(1e7 / (double)count);
    for (int try = 0; try < 7; try++) {
        double start = bench_now();
        for (int call = 0; call < calls; call++) {
            _Pragma("omp simd")
            for (size_t k = 0; k < count; k++) field[k] = 1.5 - 0.5 * field[k];
        }
        least = fmin(least, (bench_now() - start) / calls);
    }
    free(field);
    return least / (2.0 * (double)count * sizeof *field) * 1e9;
}

static struct bench_speed speed_of(const char *loop) {
#ifdef SCREE_HAS_AVX512
    if (strcmp(loop, "avx512") == 0) return bench_speed_avx512();
#endif
#ifdef SCREE_HAS_AVX2
    if (strcmp(loop, "avx2") == 0) return bench_speed_avx2();
#endif
    (void)loop;
    return bench_speed_baseline();
}

struct bench_limit bench_limit_of(struct bench_work work, const char *loop, double bytes) {
    struct bench_speed speed = speed_of(loop);
    struct bench_limit limit = {.arithmetic = work.flops * speed.flop,
                                .divider = work.quotients * speed.quotient + work.roots * speed.root,
                                .memory = work.bytes * time_of_byte(bytes)};
    limit.least = fmax(limit.memory, fmax(limit.arithmetic, limit.divider));
    return limit;
}

/* ---- instructions ---- */

#ifdef COUNTS_INSTRUCTIONS
static int counter = -1;

void bench_count_on(void) {
    struct perf_event_attr what = {.type = PERF_TYPE_HARDWARE, .size = sizeof what};
    what.config = PERF_COUNT_HW_INSTRUCTIONS;
    what.disabled = what.exclude_kernel = what.exclude_hv = 1;
    counter = (int)syscall(SYS_perf_event_open, &what, 0, -1, -1, 0);
    if (counter >= 0) ioctl(counter, PERF_EVENT_IOC_ENABLE, 0);
}

double bench_counted(void) {
    long long count = -1;
    if (counter < 0) return -1.0;
    if (read(counter, &count, sizeof count) != sizeof count) count = -1;
    close(counter);
    counter = -1;
    return (double)count;
}
#else
void bench_count_on(void) {}
double bench_counted(void) { return -1.0; }
#endif
