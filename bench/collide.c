/* scree-bench collide: boxes against an oracle, and what many impacts of boxes do to energy. Each block of pairs has a
 * seed of its own, so that the result is the same for any number of threads. */
#include "bench/bench.h"

#include "tests/boxes_impact.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char help[] =
    "usage: scree-bench collide [--pairs N] [--impacts N] [--row N] [--seed N] [--threads N]\n"
    "\n"
    "N random pairs of two boxes, N of a sphere and a box: what the contacts say against a slow and exact distance "
    "(nearest point\n"
    "of a zonotope). Columns: pair, rounding of the boxes over half their thickness, depth over the sum of roundings "
    "up to\n"
    "which they go (0: 0.49 of the thickness), pairs, of them touching, touching edge on edge alone; contacts where "
    "there is "
    "none\n"
    "(phantoms), touching pairs without a contact (missed), contacts deeper than the truth, and by how much at most "
    "(m).\n"
    "Then random impacts of two boxes: rounding, steps in pi sqrt(m/k), contact, impacts, of them stopped; change of "
    "energy,\n"
    "over the energy: its root mean square, the largest gain, the largest loss; impacts that gained more than 1e-3.\n"
    "--row N: of both tables only the Nth row; all pairs are then of that kind.\n"
    "Unless given: --pairs 100000 --impacts 1000 --seed 1 --threads 1.\n"
    "\n"
    "example: scree-bench collide --pairs 10000000 --impacts 0 --seed 1 --threads 2\n";

enum { BLOCK = 1000 };

/* A seed that no other block has (Steele, Lea & Flood 2014). */
static uint64_t seed_of(uint64_t seed, uint64_t block) {
    uint64_t z = (seed + 1) * 0x9e3779b97f4a7c15u + block * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return (z ^ (z >> 31)) | 1;
}

/* ---- pairs ---- */

static const struct {
    const char *name;
    double roundness, depth;
} kinds[] = {{"box on box", 0.2, 0.95}, {"box on box", 1.0, 0.95}, {"box on box", 0.02, 0.95},
             {"box on box", 0.2, 0.0},  {"box on box", 0.0, 0.0},  {"sphere on box", 0.0, 0.0}};

enum { KINDS = sizeof kinds / sizeof kinds[0] };

static struct oracle_count try_block(int kind, long pairs, uint64_t seed) {
    struct oracle_count count = {0};
    for (long k = 0; k < pairs; k++) {
        if (kind == KINDS - 1)
            oracle_try_sphere(&seed, &count);
        else
            oracle_try_boxes(&seed, kinds[kind].roundness, kinds[kind].depth, &count);
    }
    return count;
}

/* Returns how many went wrong. */
static long try_pairs(int kind, long pairs, uint64_t seed, int threads) {
    long blocks = (pairs + BLOCK - 1) / BLOCK, touching = 0, edges = 0, phantoms = 0, missed = 0, deeper = 0;
    double worst = 0.0;
    (void)threads; /* without OpenMP */
#pragma omp parallel for schedule(dynamic) num_threads(threads) reduction(+ : touching, edges, phantoms, missed, deeper) \
    reduction(max : worst)
    for (long block = 0; block < blocks; block++) {
        long count = pairs - block * BLOCK < BLOCK ? pairs - block * BLOCK : BLOCK;
        struct oracle_count one = try_block(kind, count, seed_of(seed, (uint64_t)(block * KINDS + kind)));
        touching += one.touching;
        edges += one.edges;
        phantoms += one.phantoms;
        missed += one.missed;
        deeper += one.deeper;
        worst = scree_most(worst, one.worst);
    }
    printf("%s,%g,%g,%ld,%ld,%ld,%ld,%ld,%ld,%.3g\n", kinds[kind].name, kinds[kind].roundness, kinds[kind].depth, pairs,
           touching, edges, phantoms, missed, deeper, worst);
    fflush(stdout);
    return phantoms + missed + deeper;
}

/* ---- impacts ---- */

#define SLIDES "friction = { law = \"coulomb\", static = 0.4, kinetic = 0.3, stiffness = 1e7, damping = 100 }"
static const struct {
    const char *name;
    struct impact_kind kind;
} impacts[] = {{"elastic", {0.2, 50, 0.5, "damping = 0", "", NULL}},
               {"elastic", {0.2, 100, 0.5, "damping = 0", "", NULL}},
               {"elastic", {0.2, 200, 0.5, "damping = 0", "", NULL}},
               {"elastic by pair-impulse", {0.2, 50, 0.5, "damping = 0", "", "pair-impulse"}},
               {"elastic by pair-impulse", {0.2, 200, 0.5, "damping = 0", "", "pair-impulse"}},
               {"elastic", {1.0, 100, 0.5, "damping = 0", "", NULL}},
               {"elastic", {0.02, 100, 0.5, "damping = 0", "", NULL}},
               {"e = 0.6", {0.2, 50, 0.5, "restitution = 0.6", "", NULL}},
               {"e = 0.6 and friction", {0.2, 50, 0.5, "restitution = 0.6", SLIDES, NULL}},
               {"elastic", {0.0, 100, 0.0, "damping = 0", "", NULL}},
               {"elastic", {0.0, 400, 0.0, "damping = 0", "", NULL}},
               {"elastic by pair-impulse", {0.0, 100, 0.0, "damping = 0", "", "pair-impulse"}},
               {"e = 0.6", {0.0, 100, 0.0, "restitution = 0.6", "", NULL}},
               {"e = 0.6 and friction", {0.0, 100, 0.0, "restitution = 0.6", SLIDES, NULL}},
               {"elastic 5 roundings deep", {0.02, 100, 5.0, "damping = 0", "", NULL}},
               {"elastic 5 roundings deep", {0.02, 400, 5.0, "damping = 0", "", NULL}}};

enum { IMPACTS = sizeof impacts / sizeof impacts[0] };

static void try_impacts(int kind, long count, uint64_t seed, int threads) {
    long blocks = (count + BLOCK - 1) / BLOCK, met = 0, stopped = 0, gained = 0;
    (void)threads; /* without OpenMP */
    double *squares = calloc((size_t)blocks + 1, sizeof *squares), largest = -1.0, least = HUGE_VAL, sum = 0.0;
    if (!squares) return;
#pragma omp parallel for schedule(dynamic) num_threads(threads) reduction(+ : met, stopped, gained)                    \
    reduction(max : largest) reduction(min : least)
    for (long block = 0; block < blocks; block++) {
        uint64_t own = seed_of(seed, (uint64_t)(block * IMPACTS + kind + 1000003));
        for (long k = block * BLOCK; k < count && k < (block + 1) * BLOCK; k++) {
            struct impact_result result = impact_run(&own, &impacts[kind].kind);
            stopped += result.stopped;
            if (!result.met) continue;
            met++;
            squares[block] += result.gained * result.gained;
            gained += result.gained > 1e-3;
            largest = scree_most(largest, result.gained);
            least = scree_least(least, result.gained);
        }
    }
    for (long block = 0; block < blocks; block++) sum += squares[block];
    free(squares);
    printf("%g,%g,%s,%ld,%ld,%.3g,%.3g,%.3g,%ld\n", impacts[kind].kind.roundness, impacts[kind].kind.steps,
           impacts[kind].name, met, stopped, sqrt(sum / (double)met), largest, least, gained);
    fflush(stdout);
}

int bench_collide(int count, char **words) {
    const char *pairs = NULL, *hits = NULL, *seed = NULL, *threads = NULL, *row = NULL;
    const struct cli_option options[] = {
        {.name = "--pairs", .value = &pairs},     {.name = "--impacts", .value = &hits},
        {.name = "--row", .value = &row},         {.name = "--seed", .value = &seed},
        {.name = "--threads", .value = &threads}, {0}};
    int code = bench_parse(count, words, options, help);
    if (code) return code < 0 ? EXIT_GOOD : code;
    int only = row ? cli_whole_number(row, "--row", IMPACTS) : 0;
    int pair_count = pairs && strcmp(pairs, "0") == 0 ? -1
                     : pairs                          ? cli_whole_number(pairs, "--pairs", 1000000000)
                                                      : 100000;
    int hit_count = hits && strcmp(hits, "0") == 0 ? -1 : hits ? cli_whole_number(hits, "--impacts", 1000000000) : 1000;
    int start = seed ? cli_whole_number(seed, "--seed", 1000000000) : 1;
    int team = threads ? cli_whole_number(threads, "--threads", 1024) : 1;
    if (!pair_count || !hit_count || !start || !team || (row && !only)) return EXIT_USAGE;
    bench_describe_machine();
    printf("# seed %d\npair,rounding,depth,pairs,touching,by_edges_alone,phantoms,missed,deeper,worst_m\n", start);
    long wrong = 0;
    for (int kind = 0; kind < KINDS && pair_count > 0; kind++) {
        if (only && kind != only - 1) continue;
        int boxes = kind < KINDS - 1 && !only; /* which share the pairs */
        long own = boxes ? (pair_count + KINDS - 2) / (KINDS - 1) : pair_count;
        wrong += try_pairs(kind, own, (uint64_t)start, team);
    }
    printf("rounding,steps,contact,impacts,stopped,rms,largest_gain,largest_loss,gained_1e-3\n");
    for (int kind = 0; kind < IMPACTS && hit_count > 0; kind++)
        if (!only || kind == only - 1) try_impacts(kind, hit_count, (uint64_t)start, team);
    return wrong ? EXIT_MISSED : EXIT_GOOD;
}
