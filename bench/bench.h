/* What the benchmarks share: scenes from the data folder, clocks, medians, and the subcommands themselves. */
#ifndef SCREE_BENCH_BENCH_H
#define SCREE_BENCH_BENCH_H

#include "bodies/elementary.h"
#include "engine/cli/cli.h"
#include "engine/scene.h"

int bench_process(int count, char **words);
int bench_hot(int count, char **words);
int bench_impact(int count, char **words);
int bench_look(int count, char **words);
int bench_laws(int count, char **words);
int bench_lm(int count, char **words);
int bench_plan(int count, char **words);
int bench_precision(int count, char **words);
int bench_skips(int count, char **words);
int bench_stability(int count, char **words);
int bench_stress(int count, char **words);
int bench_collide(int count, char **words);
int bench_boxes(int count, char **words);

/* cli_parse for benchmarks that take no words but options. */
int bench_parse(int count, char **words, const struct cli_option *options, const char *help);

/* Seconds on a clock that only runs forward. */
double bench_now(void);

/* Median of `count` values, which are put in order. */
double bench_median(double *values, int count);

/* A scene file of the data folder, changed and baked; prints the reason and ends the program if it isn't valid. */
scree_scene *bench_scene(const char *file, const char *const *changes, int count);

/* The same from TOML text. */
scree_scene *bench_scene_text(const char *text, const char *const *changes, int count);

/* Step; prints the reason and ends the program if the simulation stops. */
void bench_step(scree_scene *scene, long steps);

/* Pseudo-random number between 0 and 1 (Knuth's linear congruence). */
double bench_random(uint64_t *seed);

/* Spheres as they begin; velocities and spins are zero at first. Free with bench_free_spheres. */
struct bench_spheres {
    int count;
    double (*position)[3], (*velocity)[3], (*spin)[3], *radius; /* m, m/s, rad/s, m */
};
struct bench_spheres bench_make_spheres(int count);
void bench_free_spheres(struct bench_spheres *spheres);

/* Out of a bed of small spheres on a floor of `edge` x `edge`, one of sizes up to `ratio` times as large: larger ones
 * take the place of those that are in their way. Ends the program where the largest doesn't fit. */
struct bench_spheres bench_mix_sizes(const struct bench_spheres *small, double edge, double ratio);

/* Print compiler, flags and processor, as comment lines of a CSV file. */
void bench_describe_machine(void);

#endif
