/* scree-bench lm: time of a least-squares solve against the number of residuals; calls and digits on test problems;
 * beside other solvers if the build has found them. */
#include "bench/bench.h"

#include "bench/peers/peers.h"
#include "bench/problems.h"
#include "bodies/elementary.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>

static const char help[] =
    "usage: scree-bench lm [--repeats N]\n"
    "       scree-bench lm --costs [SOLVER]\n"
    "\n"
    "Time a fit of two Gaussian peaks (6 unknowns, analytic Jacobian, unknowns guessed to within 7 to 30 %) to m "
    "points "
    "with\n"
    "noise; solvers take turns, all tolerances are 1.5e-8. Columns: solver, m, microseconds per solve (median of the "
    "repeats),\n"
    "median of the ratio to the time of cminpack in the same turn (empty if the build hasn't found it), calls of "
    "residual\n"
    "and Jacobian, largest relative error of an unknown.\n"
    "\n"
    "--costs: calls and results on NIST's problems (27, two starts) and those of More, Garbow & Hillstrom (86 runs), "
    "of "
    "all\n"
    "solvers or those whose name contains SOLVER; scree with its defaults, the others with all tolerances at machine\n"
    "precision. Columns: solver, collection, problem, number of unknowns, of residuals, start (NIST: 1 or 2, else its\n"
    "factor), calls of residual and Jacobian, result (digits of the worst parameter, or which minimum), whether\n"
    "convergence is claimed.\n"
    "Unless given: --repeats 25.\n"
    "\n"
    "example: scree-bench lm --costs cminpack >data/reference/lmder_costs.csv\n";

/* ---- solvers behind one face ---- */

static void *own_create(const scree_lm_problem *problem);
static void own_destroy(void *state) { free(state); }
static struct peer_outcome own_bare(void *state, double tolerance, int evaluations, double *x);
static struct peer_outcome own_polished(void *state, double tolerance, int evaluations, double *x);

static const struct peer solver_bare = {"scree without polish", own_create, own_destroy, own_bare};
static const struct peer solver_polished = {"scree", own_create, own_destroy, own_polished};

/* The first is what the others are compared with. */
static const struct peer *const solvers[] = {
#ifdef SCREE_CMINPACK_VERSION
    &peer_cminpack,
#endif
    &solver_bare,
    &solver_polished,
#ifdef SCREE_GSL_VERSION
    &peer_gsl,
#endif
};
enum { SOLVERS = sizeof solvers / sizeof solvers[0] };
#ifdef SCREE_CMINPACK_VERSION
static const int has_reference = 1;
#else
static const int has_reference = 0;
#endif

struct own_state {
    const scree_lm_problem *problem;
    max_align_t workspace[];
};

static void *own_create(const scree_lm_problem *problem) {
    struct own_state *state =
        malloc(sizeof *state + scree_lm_workspace(problem->unknowns, problem->residuals) + sizeof(max_align_t));
    if (state) state->problem = problem;
    return state;
}

static struct peer_outcome run(struct own_state *state, const scree_lm_options *options, double *x) {
    scree_lm_outcome outcome = scree_lm_solve(state->problem, options, x, state->workspace);
    return (struct peer_outcome){outcome.residual_calls, outcome.jacobian_calls, outcome.converged};
}

/* Tolerance 0 leaves the defaults. */
static struct peer_outcome own_bare(void *state, double tolerance, int evaluations, double *x) {
    return run(state,
               &(scree_lm_options){.reduction = tolerance,
                                   .radius = tolerance,
                                   .cosine = tolerance,
                                   .evaluations = evaluations,
                                   .no_polish = 1},
               x);
}

static struct peer_outcome own_polished(void *state, double tolerance, int evaluations, double *x) {
    return run(state,
               &(scree_lm_options){
                   .reduction = tolerance, .radius = tolerance, .cosine = tolerance, .evaluations = evaluations},
               x);
}

static void *create(const struct peer *solver, const scree_lm_problem *problem) {
    void *state = solver->create(problem);
    if (!state) {
        cli_complain("out of memory");
        exit(EXIT_MISSED);
    }
    return state;
}

/* ---- time of a solve ---- */

enum { UNKNOWNS = 6, MOST_POINTS = 100, SIZES = 4, MOST_REPEATS = 1000 };
static const int sizes[SIZES] = {10, 24, 50, 100};

struct curve {
    int points;
    double t[MOST_POINTS], y[MOST_POINTS];
};

/* Two Gaussian peaks: height, centre, width each. */
static const double truth[UNKNOWNS] = {2.0, 3.0, 1.0, 1.2, 6.5, 1.5};
static const double guess[UNKNOWNS] = {1.6, 3.3, 1.3, 1.0, 6.0, 1.2};

static int curve_residual(void *context, const double *x, double *r) {
    const struct curve *c = context;
    for (int k = 0; k < c->points; k++) {
        double u = (c->t[k] - x[1]) / x[2], v = (c->t[k] - x[4]) / x[5];
        r[k] = x[0] * scree_exp(-u * u) + x[3] * scree_exp(-v * v) - c->y[k];
    }
    return 0;
}

static int curve_jacobian(void *context, const double *x, double *j) {
    const struct curve *c = context;
    int m = c->points;
    for (int k = 0; k < m; k++)
        for (int p = 0; p < UNKNOWNS; p += 3) {
            double u = (c->t[k] - x[p + 1]) / x[p + 2], e = scree_exp(-u * u), slope = 2.0 * x[p] * u * e / x[p + 2];
            j[p * m + k] = e;
            j[(p + 1) * m + k] = slope;
            j[(p + 2) * m + k] = slope * u;
        }
    return 0;
}

static void make_curve(int points, struct curve *c) {
    uint64_t seed = 88172645463325252u; /* xorshift64, Marsaglia 2003 */
    *c = (struct curve){.points = points};
    for (int k = 0; k < points; k++) c->t[k] = 10.0 * k / (points - 1);
    double r[MOST_POINTS];
    curve_residual(c, truth, r);
    for (int k = 0; k < points; k++) {
        seed ^= seed << 13;
        seed ^= seed >> 7;
        seed ^= seed << 17;
        c->y[k] = r[k] + 0.02 * ((double)(seed >> 11) * 0x1p-53 - 0.5) * 3.4641016151377544;
    }
}

/* Seconds of one solve, as the mean over a batch. */
static double time_batch(const struct peer *solver, void *state, int batch, struct peer_outcome *outcome, double *x) {
    double start = bench_now();
    for (int k = 0; k < batch; k++) {
        memcpy(x, guess, sizeof guess);
        *outcome = solver->solve(state, 1.5e-8, 1000, x);
    }
    return (bench_now() - start) / batch;
}

static double largest_error(const double *x, const double *best) {
    double largest = 0.0;
    for (int k = 0; k < UNKNOWNS; k++) largest = scree_most(largest, fabs(x[k] / best[k] - 1.0));
    return largest;
}

static void time_size(int points, int repeats) {
    static double seconds[SOLVERS][MOST_REPEATS], ratio[SOLVERS][MOST_REPEATS];
    struct curve curve;
    make_curve(points, &curve);
    scree_lm_problem problem = {UNKNOWNS, points, curve_residual, curve_jacobian, &curve, NULL, NULL};
    void *state[SOLVERS];
    struct peer_outcome outcome[SOLVERS];
    double x[SOLVERS][UNKNOWNS], best[UNKNOWNS];
    for (int s = 0; s < SOLVERS; s++) state[s] = create(solvers[s], &problem);
    for (int k = 0; k < repeats; k++)
        for (int s = 0; s < SOLVERS; s++) {
            seconds[s][k] = time_batch(solvers[s], state[s], 200, &outcome[s], x[s]);
            ratio[s][k] = seconds[s][k] / seconds[0][k];
        }
    void *reference = create(&solver_polished, &problem);
    memcpy(best, guess, sizeof best);
    own_polished(reference, 0.0, 0, best);
    own_destroy(reference);
    for (int s = 0; s < SOLVERS; s++) {
        printf("%s,%d,%.2f,", solvers[s]->name, points, 1e6 * bench_median(seconds[s], repeats));
        if (has_reference) printf("%.2f", bench_median(ratio[s], repeats));
        printf(",%d,%d,%.1e\n", outcome[s].residual_calls, outcome[s].jacobian_calls, largest_error(x[s], best));
        solvers[s]->destroy(state[s]);
    }
}

/* ---- calls and digits ---- */

static struct peer_outcome solve_tightly(const struct peer *solver, const scree_lm_problem *problem, double *x) {
    void *state = create(solver, problem);
    int own = solver == &solver_polished;
    struct peer_outcome outcome = solver->solve(state, own ? 0.0 : DBL_EPSILON, own ? 0 : 1000 * problem->unknowns, x);
    solver->destroy(state);
    return outcome;
}

static void print_cost(const struct peer *solver, const char *collection, const char *name,
                       const scree_lm_problem *problem, int start, struct peer_outcome outcome) {
    printf("%s,%s,%s,%d,%d,%d,%d,%d,", solver->name, collection, name, problem->unknowns, problem->residuals, start,
           outcome.residual_calls, outcome.jacobian_calls);
}

static int costs_nist(const struct peer *solver) {
    static struct nist nist;
    for (int index = 0; index < NIST_PROBLEMS; index++) {
        if (nist_load(index, SCREE_SOURCE_DATA "/reference", &nist))
            return cli_complain("can't read NIST's problems in %s/reference/nist", SCREE_SOURCE_DATA);
        scree_lm_problem problem = nist_problem(&nist);
        for (int start = 0; start < 2; start++) {
            double x[NIST_PARAMETERS];
            memcpy(x, nist.start[start], sizeof x);
            struct peer_outcome outcome = solve_tightly(solver, &problem, x);
            print_cost(solver, "NIST", nist.name, &problem, start + 1, outcome);
            printf("%.1f,%s\n", nist_digits(&nist, x), outcome.converged ? "yes" : "no");
        }
    }
    return EXIT_GOOD;
}

static void costs_mgh(const struct peer *solver) {
    static const char *const kinds[] = {[MGH_GLOBAL] = "global", [MGH_LOCAL] = "local", [MGH_NEITHER] = "neither"};
    static const int factor[3] = {1, 10, 100};
    for (int index = 0; index < MGH_PROBLEMS; index++) {
        const struct mgh *mgh = &mgh_problems[index];
        scree_lm_problem problem = mgh_problem(mgh);
        for (int start = 0; start < mgh->starts; start++) {
            double x[MGH_UNKNOWNS];
            mgh_start(mgh, start, x);
            struct peer_outcome outcome = solve_tightly(solver, &problem, x);
            print_cost(solver, "MGH", mgh->name, &problem, factor[start], outcome);
            printf("%s,%s\n", kinds[mgh_judge(mgh, x)], outcome.converged ? "yes" : "no");
        }
    }
}

static int wants(const struct peer *solver, const char *wanted) {
    return solver != &solver_bare && strstr(solver->name, wanted);
}

static int print_costs(const char *wanted) {
    int code = EXIT_GOOD, found = 0;
    for (int s = 0; s < SOLVERS; s++) found += wants(solvers[s], wanted);
    if (!found) return cli_complain("this build has no solver \"%s\"", wanted);
    bench_describe_machine();
    printf("# calls until convergence; tolerances %.1e (and an initial factor of 100 for lmder), scree: its defaults\n",
           DBL_EPSILON);
    printf("solver,collection,problem,unknowns,residuals,start,residual_calls,jacobian_calls,result,claims\n");
    for (int s = 0; s < SOLVERS && !code; s++) {
        if (!wants(solvers[s], wanted)) continue;
        code = costs_nist(solvers[s]);
        if (!code) costs_mgh(solvers[s]);
    }
    return code;
}

int bench_lm(int count, char **words) {
    const char *repeats = NULL;
    int costs = 0;
    const struct cli_option options[] = {
        {.name = "--repeats", .value = &repeats}, {.name = "--costs", .flag = &costs}, {0}};
    int code = cli_parse(&count, words, options, help);
    if (code) return code < 0 ? EXIT_GOOD : code;
    int repeat_count = repeats ? cli_whole_number(repeats, "--repeats", MOST_REPEATS) : 25;
    if (!repeat_count) return EXIT_USAGE;
    if (count > costs) return cli_complain("unexpected word \"%s\"", words[costs]);
    if (costs) return print_costs(count ? words[0] : "");
    bench_describe_machine();
    printf("solver,residuals,solve_us,ratio_to_cminpack,residual_calls,jacobian_calls,largest_relative_error\n");
    for (int k = 0; k < SIZES; k++) time_size(sizes[k], repeat_count);
    return EXIT_GOOD;
}
