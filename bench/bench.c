/* scree-bench: finds the benchmark and hands over; and what the benchmarks share. */
#include "bench/bench.h"

#include "engine/scene_file.h"

#include <stdlib.h>
#include <string.h>
#include <time.h>

static const char help[] =
    "scree-bench: benchmarks of scree\n"
    "\n"
    "usage: scree-bench BENCHMARK [OPTION …]\n"
    "\n"
    "  process   time of a step in small scenes: a box on a plane, the process model; and where it goes\n"
    "  hot       time of a step of settled beds of spheres: per body, per contact, memory, lists\n"
    "  impact    error of the restitution against the step, for each normal law with a closed form\n"
    "  look      what many spheres are like: packing, coordination, energy; to compare with other programs' states\n"
    "  laws      time of a contact in the loop, for every contact law\n"
    "  lm        time of a least-squares solve; calls and digits on test problems; beside other solvers\n"
    "  plan      time of planning 41 operating speeds with the process model, against the clearance left\n"
    "  skips     what it saves to leave out what a scene doesn't need\n"
    "  precision run time against error for each integrator: impacts, rolling, rows, bouncing, a heap, …; of many at "
    "once\n"
    "  stability where a step is stable and right, over step and damping, for several laws; beside theory\n"
    "  stress    extreme masses, stiffnesses, sizes, speeds, stacks, long rests: what happens, and what is said of it\n"
    "  collide   contacts of boxes against an exact distance, and energy of their impacts, for millions of random "
    "pairs\n"
    "  boxes     time of the contacts of boxes, boxes poured by the thousand, towers that stand\n"
    "\n"
    "Results are CSV on standard output. `scree-bench BENCHMARK --help` tells more.\n";

static const struct {
    const char *name;
    int (*run)(int count, char **words);
} benchmarks[] = {
    {"process", bench_process},     {"hot", bench_hot},     {"impact", bench_impact},
    {"laws", bench_laws},           {"lm", bench_lm},       {"plan", bench_plan},
    {"precision", bench_precision}, {"skips", bench_skips}, {"stability", bench_stability},
    {"stress", bench_stress},       {"look", bench_look},   {"collide", bench_collide},
    {"boxes", bench_boxes},
};

enum { BENCHMARKS = sizeof benchmarks / sizeof benchmarks[0] };

int main(int count, char **words) {
    cli_program = "scree-bench";
    if (count < 2 || strcmp(words[1], "--help") == 0) {
        fputs(help, count < 2 ? stderr : stdout);
        return count < 2 ? EXIT_USAGE : EXIT_GOOD;
    }
    if (cli_check_isa()) return EXIT_USAGE;
    const char *names[BENCHMARKS + 1] = {0};
    for (int k = 0; k < BENCHMARKS; k++) {
        names[k] = benchmarks[k].name;
        if (strcmp(words[1], names[k]) != 0) continue;
        int code = benchmarks[k].run(count - 2, words + 2);
        if (fflush(stdout) == 0 && !ferror(stdout)) return code;
        return cli_complain("the results can't be written"), EXIT_MISSED;
    }
    return cli_complain("there is no benchmark \"%s\"%s", words[1], scree_hint(words[1], names).text);
}

int bench_parse(int count, char **words, const struct cli_option *options, const char *text) {
    int code = cli_parse(&count, words, options, text);
    return !code && count > 0 ? cli_complain("unexpected word \"%s\"", words[0]) : code;
}

double bench_now(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static int compare(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

double bench_median(double *values, int count) {
    qsort(values, (size_t)count, sizeof *values, compare);
    return count % 2 ? values[count / 2] : 0.5 * (values[count / 2 - 1] + values[count / 2]);
}

static void give_up(const char *reason) {
    cli_complain("%s", reason);
    exit(EXIT_MISSED);
}

scree_scene *bench_scene(const char *file, const char *const *changes, int count) {
    char path[1024];
    scree_scene *scene = NULL;
    struct scree_run_request request;
    scree_trouble trouble;
    snprintf(path, sizeof path, "%s/scenes/%s", SCREE_SOURCE_DATA, file);
    if (scree_load_scene(path, changes, count, 1, &scene, &request, &trouble)) give_up(trouble.text);
    scree_free_request(&request);
    return scene;
}

scree_scene *bench_scene_text(const char *text, const char *const *changes, int count) {
    scree_scene *scene = NULL;
    struct scree_run_request request;
    scree_trouble trouble;
    if (scree_read_scene(text, strlen(text), "scene", changes, count, 1, &scene, &request, &trouble))
        give_up(trouble.text);
    scree_free_request(&request);
    return scene;
}

void bench_step(scree_scene *scene, long steps) {
    if (scree_scene_step(scene, steps)) give_up(scree_scene_trouble(scene)->text);
}

void bench_describe_machine(void) {
    char line[256];
    FILE *file = fopen("/proc/cpuinfo", "r");
    printf("# scree %s, compiler %s, flags %s\n", SCREE_VERSION, SCREE_COMPILER, SCREE_FLAGS);
    while (file && fgets(line, sizeof line, file)) {
        if (strncmp(line, "model name", 10) != 0) continue;
        printf("# processor%s", strchr(line, ':'));
        break;
    }
    if (file) fclose(file);
}
