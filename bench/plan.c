/* scree-bench plan: time of planning many operating speeds with the process model in the loop, against the clearance
 * that is left. */
#include "bench/bench.h"

#include "engine/cli/process.h"

#include <math.h>
#include <stdlib.h>

static const char help[] = "usage: scree-bench plan [--repeats N] [--threads N]\n"
                           "\n"
                           "Plan 41 operating speeds from 300 to 700 cycles a minute by formulation C (process model "
                           "in the loop), for a range of\n"
                           "wanted clearances and largest steps of the simulation. Columns: wanted clearance, step, "
                           "threads, seconds (median of the\n"
                           "repeats), simulations, largest clearance left as the same model sees it and as a model "
                           "with an eighth of the step does.\n"
                           "Unless given: --repeats 3 --threads 1.\n"
                           "\n"
                           "example: scree-bench plan --repeats 5 --threads 2\n";

enum { SPEEDS = 41 };

static const scree_transport task = {.distance = 0.08,
                                     .gap = 0.05,
                                     .width = 0.03,
                                     .friction = 0.3,
                                     .gravity = 9.81,
                                     .share = 0.5,
                                     .fractions = {0.25, 0.5, 0.75}};

static void plan_all(struct process *process, double clearance, int threads, scree_plan plans[SPEEDS]) {
    (void)threads; /* without OpenMP */
    scree_plan_options options = {
        .formulation = SCREE_PLAN_C, .process = process_catch, .context = process, .clearance = clearance};
#pragma omp parallel for schedule(dynamic) num_threads(threads)
    for (int n = 0; n < SPEEDS; n++) scree_plan_make(&task, 300.0 + 10.0 * n, &options, &plans[n]);
}

/* Largest clearance that the plans leave. */
static double judge(struct process *process, int threads, const scree_plan plans[SPEEDS]) {
    (void)threads;
    double left[SPEEDS], worst = 0.0;
#pragma omp parallel for schedule(dynamic) num_threads(threads)
    for (int n = 0; n < SPEEDS; n++) {
        scree_catch caught;
        int failed = plans[n].state || process_catch(process, &plans[n].profile, plans[n].time[3], &caught);
        left[n] = failed ? NAN : fabs(caught.clearance);
    }
    for (int n = 0; n < SPEEDS; n++) worst = left[n] > worst || isnan(left[n]) ? left[n] : worst;
    return worst;
}

static void measure(struct process *process, double clearance, int repeats, int threads) {
    static scree_plan plans[SPEEDS];
    double *seconds = malloc((size_t)repeats * sizeof *seconds);
    if (!seconds) return;
    for (int k = 0; k < repeats; k++) {
        double begin = bench_now();
        plan_all(process, clearance, threads, plans);
        seconds[k] = bench_now() - begin;
    }
    int simulations = 0;
    for (int n = 0; n < SPEEDS; n++) simulations += plans[n].simulations;
    struct process fine = *process;
    fine.step /= 8.0;
    printf("%.1e,%.2e,%d,%.4g,%d,%.3g,%.3g\n", clearance, process->step, threads, bench_median(seconds, repeats),
           simulations, judge(process, threads, plans), judge(&fine, threads, plans));
    free(seconds);
}

int bench_plan(int count, char **words) {
    const char *repeats_text = NULL, *threads_text = NULL;
    const struct cli_option options[] = {
        {.name = "--repeats", .value = &repeats_text}, {.name = "--threads", .value = &threads_text}, {0}};
    int code = bench_parse(count, words, options, help);
    if (code) return code < 0 ? EXIT_GOOD : code;
    int repeats = repeats_text ? cli_whole_number(repeats_text, "--repeats", 1000) : 3;
    int threads = threads_text ? cli_whole_number(threads_text, "--threads", 1024) : 1;
    if (!repeats || !threads) return EXIT_USAGE;
    struct process process;
    scree_trouble trouble;
    if (process_load(&process, SCREE_SOURCE_DATA "/scenes/transport.toml", &task, &trouble))
        return cli_complain("%s", trouble.text);
    bench_describe_machine();
    printf("wanted_clearance_m,step_s,threads,seconds,simulations,clearance_left_m,clearance_left_finer_m\n");
    static const double clearances[] = {1e-4, 1e-5, 1e-6, 1e-7, 1e-8}, steps[] = {2e-5, 1e-5, 5e-6, 2.5e-6};
    for (size_t s = 0; s < sizeof steps / sizeof steps[0]; s++)
        for (size_t k = 0; k < sizeof clearances / sizeof clearances[0]; k++) {
            process.step = steps[s];
            measure(&process, clearances[k], repeats, threads);
        }
    process_free(&process);
    return EXIT_GOOD;
}
