/* How near a loop is to what the machine can do: its operations and bytes beside the machine's best (Williams, Waterman
 * & Patterson, "Roofline: an insightful visual performance model", Commun. ACM 52 (2009) 65). */
#ifndef SCREE_BENCH_ROOFLINE_H
#define SCREE_BENCH_ROOFLINE_H

#include "bench/bench.h"

/* Nanoseconds at best for one operation in double precision: a sum or product (as many of one kind as of the other), a
 * quotient, a root. */
struct bench_speed {
    double flop, quotient, root;
};
struct bench_speed bench_speed_baseline(void), bench_speed_avx2(void), bench_speed_avx512(void);

/* What a contact takes: sums and products, quotients and roots, counted in the loop's source; bytes that come from
 * memory or go there, its share of its bodies' included. */
struct bench_work {
    int flops, quotients, roots; /* flops 0: not counted */
    double bytes;
};

/* Of a contact of two equal spheres that goes on in touch, under the laws of scree-bench hot, by Verlet. `contacts`:
 * computed ones per body; 0: nothing is counted. */
struct bench_work bench_contact_work(const scree_scene *scene, const char *laws, double contacts);

/* Nanoseconds that the machine takes for it at least: each at best, one behind the other's back. */
struct bench_limit {
    double arithmetic, divider, memory, least; /* sums and products; quotients and roots; bytes; the largest of them */
};

/* `loop`: name of the processor's path; `bytes`: gone through in a step. */
struct bench_limit bench_limit_of(struct bench_work work, const char *loop, double bytes);

/* Instructions of this thread since bench_count_on; negative where the machine doesn't count them. */
void bench_count_on(void);
double bench_counted(void);

#endif
