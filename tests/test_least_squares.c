/* solver/lm: test problems with known optima, cost, bounds, bad input and hard outcomes, covariance, losses,
 * differences. */
#include "solver/lm.h"

#include "bench/problems.h"
#include "bodies/elementary.h"
#include "solver/qr.h"
#include "tests/check.h"

#include <float.h>
#include <limits.h>
#include <threads.h>

enum { GUARD = 64 };

/* ---- solving, with everything watched ---- */

/* One solve in a workspace that is filled with `fill` and has guards around it. */
static scree_lm_outcome solve_in(int fill, const scree_lm_problem *problem, const scree_lm_options *options,
                                 double *x) {
    size_t size = scree_lm_workspace(problem->unknowns, problem->residuals);
    unsigned char *memory = malloc(size + 2 * GUARD);
    memset(memory, 0xa5, size + 2 * GUARD);
    memset(memory + GUARD, fill, size);
    scree_lm_outcome outcome = scree_lm_solve(problem, options, x, memory + GUARD);
    int touched = 0;
    for (int k = 0; k < GUARD; k++) touched += memory[k] != 0xa5 || memory[GUARD + size + (size_t)k] != 0xa5;
    CHECK(touched == 0);
    free(memory);
    return outcome;
}

static int same_outcome(const scree_lm_outcome *a, const scree_lm_outcome *b) {
    return a->reason == b->reason && a->converged == b->converged && a->iterations == b->iterations &&
           a->residual_calls == b->residual_calls && a->jacobian_calls == b->jacobian_calls &&
           a->polish_steps == b->polish_steps && a->rank == b->rank && a->free == b->free && a->norm == b->norm &&
           a->cosine == b->cosine && a->last_step == b->last_step;
}

/* Solve twice, the workspace full of zeros and of NaN: the same in every bit, whatever was there and was solved
 * before. */
static scree_lm_outcome solve(const scree_lm_problem *problem, const scree_lm_options *options, double *x) {
    double again[SCREE_LM_UNKNOWNS];
    size_t size = (size_t)problem->unknowns * sizeof *x;
    memcpy(again, x, size);
    scree_lm_outcome outcome = solve_in(0x00, problem, options, x);
    scree_lm_outcome second = solve_in(0xff, problem, options, again);
    CHECK(memcmp(x, again, size) == 0);
    CHECK(same_outcome(&outcome, &second));
    return outcome;
}

/* ---- NIST ---- */

static struct nist nist_problems[NIST_PROBLEMS];

static void load_nist(void) {
    for (int k = 0; k < NIST_PROBLEMS; k++)
        if (nist_load(k, SCREE_DATA "/reference", &nist_problems[k])) {
            printf("can't read NIST's problem %d\n", k);
            exit(1);
        }
}

/* Calls that cminpack's lmder needs, from the row of the committed table; the rows are in the order of the runs. */
static double reference_calls(const struct check_table *table, int row, const char *name, int start) {
    CHECK(strcmp(check_text(table, row, "problem"), name) == 0 && check_number(table, row, "start") == start);
    return check_number(table, row, "residual_calls") + check_number(table, row, "jacobian_calls");
}

/* Every parameter of every run to 9.5 digits and more, which is more than double precision gives to a test of the sum
 * of squares; and for fewer calls than lmder at machine-precision tolerances needs in total. */
static void test_nist(void) {
    struct check_table *table = check_read("lmder_costs.csv");
    double sum_log = 0.0, total = 0.0, total_reference = 0.0, least = 17.0;
    int solved = 0;
    for (int run = 0; run < 2 * NIST_PROBLEMS; run++) {
        struct nist *nist = &nist_problems[run / 2];
        scree_lm_problem problem = nist_problem(nist);
        double x[NIST_PARAMETERS];
        memcpy(x, nist->start[run % 2], sizeof x);
        nist->evaluations = nist->jacobians = 0;
        scree_lm_outcome outcome = solve(&problem, NULL, x);
        CHECK(2 * outcome.residual_calls == nist->evaluations && 2 * outcome.jacobian_calls == nist->jacobians);
        double digits = nist_digits(nist, x), calls = outcome.residual_calls + outcome.jacobian_calls;
        if (digits < 9.5) printf("  %s from start %d: %.1f digits\n", nist->name, run % 2 + 1, digits);
        CHECK(digits >= 9.5 || !outcome.converged); /* no false success */
        solved += digits >= 9.5 && outcome.converged;
        least = scree_least(least, digits);
        double reference = reference_calls(table, run, nist->name, run % 2 + 1);
        sum_log += log(calls / reference);
        total += calls;
        total_reference += reference;
    }
    printf("NIST: %d of 54 solved, least %.1f digits; calls over lmder's: geometric mean %.3f, total %.3f\n", solved,
           least, exp(sum_log / 54.0), total / total_reference);
    CHECK(solved == 54);
    CHECK(exp(sum_log / 54.0) <= 1.25);
    CHECK(total / total_reference <= 0.90);
    free(table);
}

/* ---- More, Garbow & Hillstrom ---- */

/* The table of the problems is that of the reference file. */
static void check_mgh_table(void) {
    struct check_table *table = check_read("mgh.csv");
    CHECK(table->rows == MGH_PROBLEMS);
    for (int k = 0; k < table->rows; k++) {
        const struct mgh *mgh = &mgh_problems[k];
        CHECK(strcmp(check_text(table, k, "problem"), mgh->name) == 0);
        CHECK(check_number(table, k, "n") == mgh->n && check_number(table, k, "m") == mgh->m);
        CHECK(check_number(table, k, "starts") == mgh->starts);
        CHECK(check_number(table, k, "sum_of_squares") == mgh->minimum);
        const char *local = check_text(table, k, "local");
        char *end;
        CHECK(strtod(local, &end) == mgh->local[0] && strtod(end, NULL) == mgh->local[1]);
    }
    free(table);
}

/* Largest |J^T r| in parts of |J_j| |r|, by the analytic Jacobian; `sum` receives |r|^2. */
static double cosine_at(const scree_lm_problem *problem, const double *x, const double *lower, const double *upper,
                        double *sum) {
    static double r[NIST_ROWS], j[NIST_ROWS * MGH_UNKNOWNS];
    int m = problem->residuals;
    double worst = 0.0, square = 0.0;
    problem->residual(problem->context, x, r);
    problem->jacobian(problem->context, x, j);
    for (int i = 0; i < m; i++) square += r[i] * r[i];
    for (int k = 0; k < problem->unknowns; k++) {
        double gradient = 0.0, length = 0.0;
        for (int i = 0; i < m; i++) {
            gradient += j[k * m + i] * r[i];
            length += j[k * m + i] * j[k * m + i];
        }
        /* At a bound only a gradient that points inside counts. */
        if (lower && x[k] == lower[k]) gradient = scree_least(gradient, 0.0);
        if (upper && x[k] == upper[k]) gradient = scree_most(gradient, 0.0);
        if (gradient != 0.0) worst = scree_most(worst, fabs(gradient) / sqrt(length * square));
    }
    *sum = square;
    return worst;
}

static void test_mgh(void) {
    int count[3] = {0}, runs = 0;
    for (int index = 0; index < MGH_PROBLEMS; index++)
        for (int start = 0; start < mgh_problems[index].starts; start++, runs++) {
            const struct mgh *mgh = &mgh_problems[index];
            scree_lm_problem problem = mgh_problem(mgh);
            double x[MGH_UNKNOWNS], sum;
            mgh_start(mgh, start, x);
            scree_lm_outcome outcome = solve(&problem, NULL, x);
            enum mgh_kind kind = mgh_judge(mgh, x);
            count[kind]++;
            /* Convergence is claimed of minima alone. */
            CHECK(!outcome.converged || kind != MGH_NEITHER);
            (void)cosine_at(&problem, x, NULL, NULL, &sum);
            NEAR(outcome.norm, sqrt(sum), 1e-14 * outcome.norm + 1e-300);
            if (kind == MGH_NEITHER)
                printf("  %s n=%d start %d: %.6g, %s\n", mgh->name, mgh->n, start, sum, scree_lm_text(outcome.reason));
        }
    printf("MGH: %d runs, %d global, %d local, %d neither\n", runs, count[MGH_GLOBAL], count[MGH_LOCAL],
           count[MGH_NEITHER]);
    CHECK(runs == 86);
    CHECK(count[MGH_GLOBAL] >= 68);
    CHECK(count[MGH_NEITHER] <= 6);
}

/* ---- bounds ---- */

/* Numbers separated by blanks. */
static void read_numbers(const char *text, int count, double *values) {
    for (int k = 0; k < count; k++) {
        char *end;
        values[k] = strtod(text, &end);
        CHECK(end != text);
        text = end;
    }
}

struct bounded {
    scree_lm_problem problem;
    struct mgh mgh; /* with a number of residuals of its own */
    double start[2][NIST_PARAMETERS], lower[NIST_PARAMETERS], upper[NIST_PARAMETERS], best;
    int starts;
    const char *name;
};

/* A NIST problem with a bound "b4>=0.2"; starts outside of it are moved 1 % inside. */
static void read_bounded_nist(const char *bound, struct bounded *b) {
    for (int k = 0; k < NIST_PROBLEMS; k++)
        if (strcmp(nist_problems[k].name, b->name) == 0) {
            b->problem = nist_problem(&nist_problems[k]);
            memcpy(b->start, nist_problems[k].start, sizeof b->start);
        }
    int parameter = atoi(bound + 1) - 1, above = bound[2] == '>';
    double value = strtod(bound + 4, NULL);
    (above ? b->lower : b->upper)[parameter] = value;
    for (int k = 0; k < 2; k++) {
        double *x = &b->start[k][parameter];
        if (above ? *x < value : *x > value) *x = above ? 1.01 * value : 0.99 * value; /* all bounds are positive */
    }
    b->starts = 2;
}

static void read_bounded(const struct check_table *table, int row, struct bounded *b) {
    *b = (struct bounded){.name = check_text(table, row, "problem")};
    for (int k = 0; k < NIST_PARAMETERS; k++) {
        b->lower[k] = -HUGE_VAL;
        b->upper[k] = HUGE_VAL;
    }
    b->best = check_number(table, row, "sum_of_squares");
    if (check_text(table, row, "bound")[0])
        read_bounded_nist(check_text(table, row, "bound"), b);
    else {
        int n = (int)check_number(table, row, "n"), m = (int)check_number(table, row, "m");
        for (int k = 0; k < MGH_PROBLEMS; k++)
            if (strcmp(mgh_problems[k].name, b->name) == 0 && mgh_problems[k].n == n) b->mgh = mgh_problems[k];
        b->mgh.m = m;
        b->problem = mgh_problem(&b->mgh);
        read_numbers(check_text(table, row, "start"), n, b->start[0]);
        read_numbers(check_text(table, row, "lower"), n, b->lower);
        read_numbers(check_text(table, row, "upper"), n, b->upper);
        b->starts = 1;
    }
    b->problem.lower = b->lower;
    b->problem.upper = b->upper;
}

static int within(const struct bounded *b, const double *x) {
    for (int k = 0; k < b->problem.unknowns; k++)
        if (!(x[k] >= b->lower[k] && x[k] <= b->upper[k])) return 0;
    return 1;
}

/* Solved: within the bounds, and a point where the gradient's projection vanishes. A promised relative reduction of F
 * below 1e-10, the solver's test, leaves a cosine of at most sqrt(1e-10); where the residual itself vanishes there is
 * no direction to ask. */
static void test_bounded(void) {
    struct check_table *table = check_read("bounded.csv");
    int runs = 0, solved = 0, best = 0;
    for (int row = 0; row < table->rows; row++) {
        struct bounded b;
        read_bounded(table, row, &b);
        for (int start = 0; start < b.starts; start++, runs++) {
            double *x = b.start[start], sum;
            scree_lm_outcome outcome = solve(&b.problem, NULL, x);
            double cosine = cosine_at(&b.problem, x, b.lower, b.upper, &sum);
            int stationary = within(&b, x) && (cosine <= 1e-5 || sum <= 1e-20);
            CHECK(within(&b, x));
            CHECK(!outcome.converged || stationary);
            solved += stationary && outcome.converged;
            best += sum <= b.best * (1.0 + 1e-6) + 1e-20;
            if (!stationary || !outcome.converged)
                printf("  %s start %d: %s, cosine %.2g\n", b.name, start + 1, scree_lm_text(outcome.reason), cosine);
        }
    }
    printf("bounded: %d runs, %d solved, %d of them the best known minimum\n", runs, solved, best);
    CHECK(runs == 34);
    CHECK(solved >= 33);
    free(table);
}

/* ---- a small model that can misbehave: x0 exp(-x1 t) ---- */

enum mischief { TAME, NAN_BEYOND, FAILS_BEYOND, NAN_ALWAYS, WRONG_JACOBIAN, NAN_JACOBIAN, TWINS, IDLE };
enum { POINTS = 12 };

struct decay {
    enum mischief mischief;
    double scale;       /* of the residual; 0: 1 */
    double unit[2];     /* of the unknowns; 0: 1 */
    const double *data; /* NULL: 2.5 exp(-1.3 t) and a little */
    const double *lower, *upper;
    int refused, outside, points;
};

static double time_of(int k) { return 0.25 * k; }
static double decay_data(const struct decay *d, int k) {
    return d->data ? d->data[k] : 2.5 * scree_exp(-1.3 * time_of(k)) + (k % 3 - 1) * 0.01;
}
static double one_if_zero(double value) { return value == 0.0 ? 1.0 : value; }

static int decay_residual(void *context, const double *x, double *r) {
    struct decay *d = context;
    double a = x[0] * one_if_zero(d->unit[0]), b = x[1] * one_if_zero(d->unit[1]);
    int points = d->points ? d->points : POINTS;
    for (int k = 0; k < 2; k++) d->outside += (d->lower && x[k] < d->lower[k]) || (d->upper && x[k] > d->upper[k]);
    for (int k = 0; k < points; k++) {
        double model = d->mischief == TWINS  ? (a + b) * scree_exp(-time_of(k))
                       : d->mischief == IDLE ? a * scree_exp(-time_of(k))
                                             : a * scree_exp(-b * time_of(k));
        r[k] = one_if_zero(d->scale) * (model - decay_data(d, k));
    }
    int beyond = b > 1.4;
    d->refused += beyond;
    if (d->mischief == NAN_ALWAYS || (d->mischief == NAN_BEYOND && beyond)) r[points - 1] = NAN;
    return d->mischief == FAILS_BEYOND && beyond;
}

static int decay_jacobian(void *context, const double *x, double *j) {
    const struct decay *d = context;
    double ua = one_if_zero(d->unit[0]), ub = one_if_zero(d->unit[1]), a = x[0] * ua, b = x[1] * ub;
    int m = d->points ? d->points : POINTS;
    for (int k = 0; k < m; k++) {
        double t = time_of(k), e = scree_exp(-(d->mischief == TWINS || d->mischief == IDLE ? 1.0 : b) * t);
        double scale = one_if_zero(d->scale) * (d->mischief == WRONG_JACOBIAN ? -1.0 : 1.0);
        j[k] = scale * ua * e;
        j[m + k] = scale * ub * (d->mischief == TWINS ? e : d->mischief == IDLE ? 0.0 : -a * t * e);
    }
    if (d->mischief == NAN_JACOBIAN) j[m] = NAN;
    return 0;
}

static scree_lm_problem decay_problem(struct decay *d) {
    return (scree_lm_problem){.unknowns = 2,
                              .residuals = d->points ? d->points : POINTS,
                              .residual = decay_residual,
                              .jacobian = decay_jacobian,
                              .context = d,
                              .lower = d->lower,
                              .upper = d->upper};
}

static scree_lm_outcome solve_decay(struct decay d, const scree_lm_options *options, double *x) {
    scree_lm_problem problem = decay_problem(&d);
    return solve(&problem, options, x);
}

/* The optimum of the tame model, which others are compared with. */
static void decay_optimum(double *x) {
    x[0] = 1.0;
    x[1] = 0.2;
    CHECK(solve_decay((struct decay){0}, NULL, x).converged);
    scree_lm_problem problem = decay_problem(&(struct decay){0});
    double sum, cosine = cosine_at(&problem, x, NULL, NULL, &sum);
    CHECK(cosine <= 1e-13); /* rounding of twelve products, of the size of |J_j| |r| and of |J_j| |y| eps / |r| */
}

/* ---- bad input ---- */

static void check_refused(scree_lm_problem problem, scree_lm_options options) {
    static max_align_t workspace[4096];
    double x[2] = {1.0, 0.2};
    scree_lm_outcome outcome = scree_lm_solve(&problem, &options, x, workspace);
    CHECK(outcome.reason == SCREE_LM_BAD_INPUT && !outcome.converged);
    CHECK(x[0] == 1.0 && x[1] == 0.2 && outcome.residual_calls == 0);
    double covariance[4];
    CHECK(scree_lm_covariance(&problem, &options, x, covariance, NULL, workspace) == -1);
}

static void test_bad_input(void) {
    struct decay d = {0};
    scree_lm_problem good = decay_problem(&d), p;
    static const int sizes[][2] = {{0, 12},    {-1, 12},           {2, 0},      {2, -5}, {2, 1},
                                   {257, 300}, {INT_MIN, INT_MIN}, {2, INT_MAX}};
    for (size_t k = 0; k < sizeof sizes / sizeof sizes[0]; k++) {
        p = good;
        p.unknowns = sizes[k][0];
        p.residuals = sizes[k][1];
        CHECK(scree_lm_workspace(p.unknowns, p.residuals) == 0);
        check_refused(p, (scree_lm_options){0});
    }
    p = good;
    p.residual = NULL;
    check_refused(p, (scree_lm_options){0});
    static const double bounds[][2] = {
        {0.0, -1.0}, {NAN, 1.0}, {0.0, NAN}, {HUGE_VAL, HUGE_VAL}, {-HUGE_VAL, -HUGE_VAL}};
    for (size_t k = 0; k < sizeof bounds / sizeof bounds[0]; k++) {
        p = good;
        p.lower = (double[]){-10.0, bounds[k][0]};
        p.upper = (double[]){10.0, bounds[k][1]};
        check_refused(p, (scree_lm_options){0});
    }
    check_refused(good, (scree_lm_options){.reduction = -1e-8});
    check_refused(good, (scree_lm_options){.radius = NAN});
    check_refused(good, (scree_lm_options){.cosine = -1.0});
    check_refused(good, (scree_lm_options){.first = -0.1});
    check_refused(good, (scree_lm_options){.evaluations = -1});
    check_refused(good, (scree_lm_options){.loss = SCREE_LM_HUBER});
    check_refused(good, (scree_lm_options){.loss = SCREE_LM_CAUCHY, .scale = -1.0});
    check_refused(good, (scree_lm_options){.loss = SCREE_LM_CAUCHY, .scale = HUGE_VAL});
    check_refused(good, (scree_lm_options){.loss = (scree_lm_loss)7, .scale = 1.0});
    double x[2] = {1.0, NAN};
    CHECK(solve(&good, NULL, x).reason == SCREE_LM_BAD_INPUT && x[0] == 1.0 && isnan(x[1]));
    CHECK(scree_lm_solve(&good, NULL, (double[]){1.0, 0.2}, NULL).reason == SCREE_LM_BAD_INPUT);
    for (int reason = 0; reason <= SCREE_LM_BAD_INPUT; reason++) CHECK(scree_lm_text((scree_lm_reason)reason)[0]);
}

/* ---- hard outcomes ---- */

static void test_not_finite(void) {
    double best[2], x[2] = {1.0, 0.2};
    decay_optimum(best);
    CHECK(solve_decay((struct decay){.mischief = NAN_ALWAYS}, NULL, x).reason == SCREE_LM_NOT_FINITE);
    CHECK(x[0] == 1.0 && x[1] == 0.2);
    CHECK(solve_decay((struct decay){.mischief = NAN_JACOBIAN}, NULL, x).reason == SCREE_LM_NOT_FINITE);
    CHECK(x[0] == 1.0 && x[1] == 0.2);
    static const enum mischief kinds[2] = {NAN_BEYOND, FAILS_BEYOND};
    for (int k = 0; k < 2; k++) { /* the first step, to 1.96, lies beyond the cliff */
        struct decay d = {.mischief = kinds[k]};
        scree_lm_problem problem = decay_problem(&d);
        double far[2] = {0.5, 0.2};
        scree_lm_outcome outcome = solve(&problem, &(scree_lm_options){.first = 100.0}, far);
        CHECK(d.refused > 0 && outcome.converged);
        CLOSE(far[0], best[0], 1e-12);
        CLOSE(far[1], best[1], 1e-12);
        double beyond[2] = {1.0, 2.0};
        CHECK(solve(&problem, NULL, beyond).reason == SCREE_LM_NOT_FINITE);
    }
    /* Data whose optimum lies beyond the cliff: no minimum, and none claimed. */
    double data[POINTS];
    for (int k = 0; k < POINTS; k++) data[k] = 2.5 * scree_exp(-2.0 * time_of(k));
    double cliff[2] = {1.0, 0.2};
    scree_lm_outcome outcome = solve_decay((struct decay){.mischief = NAN_BEYOND, .data = data}, NULL, cliff);
    CHECK(!outcome.converged && outcome.reason == SCREE_LM_STUCK);
}

static void test_wrong_jacobian(void) {
    double x[2] = {1.0, 0.2};
    scree_lm_outcome outcome = solve_decay((struct decay){.mischief = WRONG_JACOBIAN}, NULL, x);
    CHECK(outcome.reason == SCREE_LM_STUCK && !outcome.converged);
    CHECK(outcome.iterations == 0 && x[0] == 1.0 && x[1] == 0.2); /* no step was an improvement */
}

static void test_singular(void) {
    double x[2] = {1.0, 0.2}, alone[2] = {1.0, 0.2};
    scree_lm_outcome twins = solve_decay((struct decay){.mischief = TWINS}, NULL, x);
    scree_lm_outcome idle = solve_decay((struct decay){.mischief = IDLE}, NULL, alone);
    CHECK(twins.converged && twins.rank == 1 && twins.free == 2);
    CHECK(idle.converged && idle.rank == 1 && idle.free == 2);
    CHECK(alone[1] == 0.2); /* without influence it stays */
    /* Linear least squares, sum y e / sum e e; the last step, undamped, gives it to rounding. */
    double above = 0.0, below = 0.0;
    for (int k = 0; k < POINTS; k++) {
        double e = scree_exp(-time_of(k));
        above += decay_data(&(struct decay){0}, k) * e;
        below += e * e;
    }
    CLOSE(alone[0], above / below, 1e-14);
    CLOSE(x[0] + x[1], above / below, 1e-14);
}

static int stop_at(void *context, const scree_lm_progress *progress) {
    double *seen = context; /* when to stop, then x there */
    memcpy(seen + 1, progress->x, 2 * sizeof *seen);
    return progress->iteration >= (int)seen[0];
}

static void test_limits(void) {
    double best[2];
    decay_optimum(best);
    for (int differences = 0; differences < 3; differences++)
        for (int limit = 1; limit <= 80; limit++) {
            struct decay d = {0};
            scree_lm_problem problem = decay_problem(&d);
            if (differences) problem.jacobian = NULL;
            double x[2] = {1.0, 0.2};
            scree_lm_outcome outcome =
                solve(&problem, &(scree_lm_options){.evaluations = limit, .central = differences == 2}, x);
            CHECK(outcome.residual_calls <= limit);
            CHECK(outcome.cosine <= 1.0 + 1e-12); /* of a point, not of one before it */
            CHECK(outcome.converged || outcome.reason == SCREE_LM_EVALUATIONS);
            CHECK(limit > 4 || !outcome.converged);
            CHECK(limit < 80 || outcome.converged);
            /* Without polish x is as good as the test of F, relative 1e-10, makes it: its root. */
            if (outcome.converged) CLOSE(x[1], best[1], 1e-5);
        }
    for (int stop = 1; stop <= 4; stop++) {
        double seen[3] = {stop}, x[2] = {1.0, 0.2};
        scree_lm_outcome outcome =
            solve_decay((struct decay){0}, &(scree_lm_options){.callback = stop_at, .callback_context = seen}, x);
        CHECK(outcome.reason == SCREE_LM_STOPPED && !outcome.converged && outcome.iterations == stop);
        CHECK(outcome.cosine > 0.0 && outcome.cosine <= 1.0 + 1e-12);
        CHECK(x[0] == seen[1] && x[1] == seen[2]);
    }
}

/* ---- units ---- */

struct scaled {
    scree_lm_problem inner;
    double factor, unit[NIST_PARAMETERS];
};

static int scaled_residual(void *context, const double *x, double *r) {
    const struct scaled *s = context;
    double inner[NIST_PARAMETERS];
    for (int k = 0; k < s->inner.unknowns; k++) inner[k] = x[k] * s->unit[k];
    int code = s->inner.residual(s->inner.context, inner, r);
    for (int k = 0; k < s->inner.residuals; k++) r[k] *= s->factor;
    return code;
}

static int scaled_jacobian(void *context, const double *x, double *j) {
    const struct scaled *s = context;
    double inner[NIST_PARAMETERS];
    int n = s->inner.unknowns, m = s->inner.residuals;
    for (int k = 0; k < n; k++) inner[k] = x[k] * s->unit[k];
    int code = s->inner.jacobian(s->inner.context, inner, j);
    for (int k = 0; k < n * m; k++) j[k] *= s->factor * s->unit[k / m];
    return code;
}

/* A power of two times the residual changes no bit of the way. */
static void test_units_of_residual(void) {
    for (int run = 0; run < 4 * NIST_PROBLEMS; run++) {
        struct nist *nist = &nist_problems[run / 4];
        struct scaled scaled = {.inner = nist_problem(nist), .factor = ldexp(1.0, run & 1 ? 500 : -500)};
        scree_lm_problem problem = scaled.inner;
        for (int k = 0; k < NIST_PARAMETERS; k++) scaled.unit[k] = 1.0;
        problem.residual = scaled_residual;
        problem.jacobian = scaled_jacobian;
        problem.context = &scaled;
        double x[NIST_PARAMETERS], plain[NIST_PARAMETERS];
        memcpy(x, nist->start[run / 2 % 2], sizeof x);
        memcpy(plain, x, sizeof x);
        scree_lm_outcome outcome = solve(&problem, NULL, x), usual = solve(&scaled.inner, NULL, plain);
        CHECK(memcmp(x, plain, (size_t)nist->parameters * sizeof *x) == 0);
        CHECK(outcome.reason == usual.reason && outcome.residual_calls == usual.residual_calls);
    }
    static const double factors[2] = {1e150, 1e-150};
    double best[2];
    decay_optimum(best);
    for (int k = 0; k < 2; k++) {
        double x[2] = {1.0, 0.2}, zero[2] = {0.0, 0.0}, differences[2] = {1.0, 0.2};
        CHECK(solve_decay((struct decay){.scale = factors[k]}, NULL, x).converged);
        CHECK(solve_decay((struct decay){.scale = factors[k]}, NULL, zero).converged);
        struct decay d = {.scale = factors[k]};
        scree_lm_problem problem = decay_problem(&d);
        problem.jacobian = NULL;
        CHECK(solve(&problem, NULL, differences).converged);
        for (int i = 0; i < 2; i++) {
            CLOSE(x[i], best[i], 1e-13);
            CLOSE(zero[i], best[i], 1e-13);
            CLOSE(differences[i], best[i], 1e-9); /* central differences are good to 1e-10 */
        }
    }
}

/* Unknowns in units that lie 40 decades apart: the same optimum. */
static void test_units_of_unknowns(void) {
    for (int run = 0; run < 2 * NIST_PROBLEMS; run++) {
        struct nist *nist = &nist_problems[run / 2];
        struct scaled scaled = {.inner = nist_problem(nist), .factor = 1.0};
        scree_lm_problem problem = scaled.inner;
        double x[NIST_PARAMETERS];
        for (int k = 0; k < nist->parameters; k++) {
            scaled.unit[k] = k % 2 ? 0x1p-66 : 0x1p66;
            x[k] = nist->start[run % 2][k] / scaled.unit[k];
        }
        problem.residual = scaled_residual;
        problem.jacobian = scaled_jacobian;
        problem.context = &scaled;
        scree_lm_outcome outcome = solve(&problem, NULL, x);
        CHECK(outcome.rank == nist->parameters);
        for (int k = 0; k < nist->parameters; k++) x[k] *= scaled.unit[k];
        if (nist_digits(nist, x) < 9.5 || !outcome.converged)
            printf("  %s from start %d: %.1f digits, %s\n", nist->name, run % 2 + 1, nist_digits(nist, x),
                   scree_lm_text(outcome.reason));
        CHECK(outcome.converged && nist_digits(nist, x) >= 9.5);
    }
}

/* ---- covariance ---- */

static int covariance_at(const scree_lm_problem *problem, const scree_lm_options *options, const double *x,
                         double *covariance, int *free_unknowns) {
    size_t size = scree_lm_workspace(problem->unknowns, problem->residuals);
    unsigned char *memory = malloc(size + 2 * GUARD);
    memset(memory, 0xa5, size + 2 * GUARD);
    int rank = scree_lm_covariance(problem, options, x, covariance, free_unknowns, memory + GUARD);
    for (int k = 0; k < GUARD; k++) CHECK(memory[k] == 0xa5 && memory[GUARD + size + (size_t)k] == 0xa5);
    free(memory);
    return rank;
}

enum { LINE_POINTS = 20 };

static double line_data(int k) { return 0.3 * k + 1.0 + 0.1 * sin(7.0 * k); }

/* a + b t, and with three unknowns a + b t + c t: b and c can't be told apart. */
static int line_residual(void *context, const double *x, double *r) {
    int three = *(const int *)context;
    for (int k = 0; k < LINE_POINTS; k++) r[k] = x[0] + x[1] * k + (three ? x[2] * k : 0.0) - line_data(k);
    return 0;
}

static int line_jacobian(void *context, const double *x, double *j) {
    (void)x;
    for (int k = 0; k < LINE_POINTS; k++) {
        j[k] = 1.0;
        j[LINE_POINTS + k] = k;
        if (*(const int *)context) j[2 * LINE_POINTS + k] = k;
    }
    return 0;
}

/* Against the textbook formulas of a straight line; condition about 3, so a few roundings. */
static void test_covariance_of_line(void) {
    int three = 0, is_free[3];
    scree_lm_problem problem = {2, LINE_POINTS, line_residual, line_jacobian, &three, NULL, NULL};
    double x[3] = {0.0, 0.0, 0.0}, c[9], mean = (LINE_POINTS - 1) / 2.0, spread = 0.0, rss = 0.0;
    CHECK(solve(&problem, NULL, x).converged);
    for (int k = 0; k < LINE_POINTS; k++) {
        double r = x[0] + x[1] * k - line_data(k);
        spread += (k - mean) * (k - mean);
        rss += r * r;
    }
    double variance = rss / (LINE_POINTS - 2);
    CHECK(covariance_at(&problem, NULL, x, c, is_free) == 2);
    CLOSE(c[0], variance * (1.0 / LINE_POINTS + mean * mean / spread), 1e-13);
    CLOSE(c[1], -variance * mean / spread, 1e-13);
    CLOSE(c[3], variance / spread, 1e-13);
    CHECK(c[1] == c[2] && is_free[0] && is_free[1]);
    /* Two unknowns share a column: neither is determined, the third is as before. */
    three = 1;
    problem.unknowns = 3;
    CHECK(covariance_at(&problem, NULL, x, c, NULL) == 2);
    CLOSE(c[0], variance * (1.0 / LINE_POINTS + mean * mean / spread), 1e-13);
    CHECK(c[4] == HUGE_VAL && c[8] == HUGE_VAL);
    CHECK(c[1] == 0.0 && c[2] == 0.0 && c[3] == 0.0 && c[5] == 0.0 && c[6] == 0.0 && c[7] == 0.0);
}

static void test_covariance_at_bound(void) {
    int three = 0, is_free[2];
    double lower[2] = {2.0, -HUGE_VAL}, x[2] = {5.0, 0.0}, c[4], squares = 0.0, rss = 0.0;
    scree_lm_problem problem = {2, LINE_POINTS, line_residual, line_jacobian, &three, lower, NULL};
    scree_lm_outcome outcome = solve(&problem, NULL, x);
    CHECK(outcome.converged && outcome.free == 1 && outcome.rank == 1 && x[0] == 2.0);
    CHECK(covariance_at(&problem, NULL, x, c, is_free) == 1);
    for (int k = 0; k < LINE_POINTS; k++) {
        double r = x[0] + x[1] * k - line_data(k);
        squares += (double)k * k;
        rss += r * r;
    }
    CHECK(!is_free[0] && is_free[1]);
    CHECK(c[0] == 0.0 && c[1] == 0.0 && c[2] == 0.0);
    CLOSE(c[3], rss / (LINE_POINTS - 1) / squares, 1e-13);
}

/* By differences, always central ones, as by the analytic Jacobian: errors of 4e-11 in each, the condition being
 * about 2. */
static void test_covariance_by_differences(void) {
    struct decay d = {0};
    scree_lm_problem problem = decay_problem(&d);
    double x[2], c[4], differences[4];
    decay_optimum(x);
    CHECK(covariance_at(&problem, NULL, x, c, NULL) == 2);
    problem.jacobian = NULL;
    CHECK(covariance_at(&problem, NULL, x, differences, NULL) == 2);
    for (int k = 0; k < 4; k++) CLOSE(differences[k], c[k], 1e-9);
    d.mischief = NAN_ALWAYS;
    CHECK(covariance_at(&problem, NULL, x, c, NULL) == -1);
}

/* NIST's standard deviations, to the 11 digits they are printed with. Beside those: the residual, the difference of
 * model and data, has rounding errors of some eps |y|, which count where the fit is as good as Lanczos1 (|r| =
 * 1e-13). */
static void test_covariance_of_nist(void) {
    for (int index = 0; index < NIST_PROBLEMS; index++) {
        struct nist *nist = &nist_problems[index];
        scree_lm_problem problem = nist_problem(nist);
        double c[NIST_PARAMETERS * NIST_PARAMETERS];
        double rounding = 2.0 * DBL_EPSILON * scree_norm(nist->rows, nist->y) / sqrt(nist->certified_rss);
        int n = nist->parameters;
        CHECK(covariance_at(&problem, NULL, nist->refined, c, NULL) == n);
        for (int k = 0; k < n; k++) CLOSE(sqrt(c[k * (n + 1)]), nist->deviation[k], 5.1e-11 + rounding);
    }
}

/* ---- losses ---- */

enum { ROBUST_POINTS = 40 };

/* Residuals of the decay with truth (2.5, 1.3), noise up to 0.01, and every sixth point moved up by 1. */
static void outliers(double *data) {
    uint64_t seed = 7;
    for (int k = 0; k < ROBUST_POINTS; k++)
        data[k] = 2.5 * scree_exp(-1.3 * time_of(k)) + check_between(&seed, -0.01, 0.01) + (k % 6 == 3);
}

/* Half the derivative of the loss. */
static double influence(scree_lm_loss loss, double c, double r) {
    if (loss == SCREE_LM_HUBER) return fmin(fmax(r, -c), c);
    return loss == SCREE_LM_CAUCHY ? r / (1.0 + (r / c) * (r / c)) : r;
}

/* The optimum of a loss: sum influence(r) J = 0, to what an error of 1e-13 in x leaves. Noise of 0.0058 rms gives x1 a
 * standard deviation of 0.0042. Cauchy's loss forgets outliers: five of those. Huber's bounds the pull of each of the
 * seven to c = 0.02, which shifts x1 by the second entry of (J^T J)^-1 sum c J, 0.009: that more. Squares follow the
 * outliers, fifty times as far. */
static void test_losses(void) {
    static const struct {
        scree_lm_loss loss;
        double low, high; /* error of x1 */
    } kinds[3] = {{SCREE_LM_CAUCHY, 0.0, 0.021}, {SCREE_LM_HUBER, 0.0, 0.03}, {SCREE_LM_SQUARES, 0.3, 10.0}};
    double data[ROBUST_POINTS], r[ROBUST_POINTS], j[2 * ROBUST_POINTS];
    outliers(data);
    for (int kind = 0; kind < 3; kind++) {
        struct decay d = {.data = data, .points = ROBUST_POINTS};
        scree_lm_problem problem = decay_problem(&d);
        scree_lm_options options = {.loss = kinds[kind].loss, .scale = 0.02};
        double x[2] = {2.0, 1.0}, gradient[2] = {0.0, 0.0}, sizes[2] = {0.0, 0.0};
        scree_lm_outcome outcome = solve(&problem, &options, x);
        CHECK(outcome.converged);
        decay_residual(&d, x, r);
        decay_jacobian(&d, x, j);
        for (int k = 0; k < 2 * ROBUST_POINTS; k++) {
            double psi = influence(options.loss, options.scale, r[k % ROBUST_POINTS]);
            gradient[k / ROBUST_POINTS] += psi * j[k];
            sizes[k / ROBUST_POINTS] += fabs(psi * j[k]);
        }
        for (int k = 0; k < 2; k++) NEAR(gradient[k], 0.0, 1e-11 * sizes[k]);
        CHECK(fabs(x[1] - 1.3) >= kinds[kind].low && fabs(x[1] - 1.3) <= kinds[kind].high);
        double differences[2] = {2.0, 1.0};
        problem.jacobian = NULL;
        CHECK(solve(&problem, &options, differences).converged);
        for (int k = 0; k < 2; k++) CLOSE(differences[k], x[k], 1e-8);
    }
}

/* Losses where nothing is left of the residual, and where nothing is large: the result of the squares. */
static void test_losses_without_outliers(void) {
    double data[POINTS], best[2];
    decay_optimum(best);
    for (int k = 0; k < POINTS; k++) data[k] = 2.5 * scree_exp(-1.3 * time_of(k));
    for (int loss = SCREE_LM_HUBER; loss <= SCREE_LM_CAUCHY; loss++) {
        double exact[2] = {1.0, 0.2}, wide[2] = {1.0, 0.2};
        scree_lm_options options = {.loss = (scree_lm_loss)loss, .scale = 0.1};
        CHECK(solve_decay((struct decay){.data = data}, &options, exact).converged);
        CLOSE(exact[0], 2.5, 1e-14);
        CLOSE(exact[1], 1.3, 1e-14);
        options.scale = 1e6; /* rho differs from r^2 by (r/c)^2 = 1e-12 and less */
        CHECK(solve_decay((struct decay){0}, &options, wide).converged);
        for (int k = 0; k < 2; k++) CLOSE(wide[k], best[k], 1e-12);
        wide[0] = 1.0; /* so wide that (r/c)^2 is no number any more */
        wide[1] = 0.2;
        CHECK(solve_decay((struct decay){.scale = 1e-180}, &options, wide).converged);
        for (int k = 0; k < 2; k++) CLOSE(wide[k], best[k], 1e-12);
    }
}

/* ---- differences ---- */

/* Forward and central, from zero and from corners of the bounds: never a step outside, and the optimum within the
 * bounds that the analytic Jacobian finds. The polish's central differences are good to 4e-11 of J, x therefore to that
 * times the condition. */
static void test_differences(void) {
    static const double bounds[][4] = {/* lower, upper of x0 and x1 */
                                       {0.0, 0.0, 3.0, 2.0},  {0.0, 0.0, 2.0, 2.0}, {-1.0, 1.5, 9.0, 9.0},
                                       {2.4, 0.5, 9.0, 1.25}, {1.0, 0.7, 9.0, 0.7}, {1.0, 0.7, 9.0, 0.7 + 1e-13}};
    for (size_t b = 0; b < sizeof bounds / sizeof bounds[0]; b++)
        for (int corner = 0; corner < 8; corner++) {
            struct decay d = {.lower = bounds[b], .upper = bounds[b] + 2};
            scree_lm_problem problem = decay_problem(&d);
            double x[2] = {bounds[b][corner & 1 ? 2 : 0], bounds[b][corner & 2 ? 3 : 1]}, exact[2] = {x[0], x[1]}, sum;
            CHECK(solve(&problem, NULL, exact).converged);
            problem.jacobian = NULL;
            CHECK(solve(&problem, &(scree_lm_options){.central = corner >= 4}, x).converged);
            CHECK(d.outside == 0);
            for (int k = 0; k < 2; k++) NEAR(x[k], exact[k], 1e-8);
            problem.jacobian = decay_jacobian;
            CHECK(cosine_at(&problem, exact, d.lower, d.upper, &sum) <= 1e-5); /* as in test_bounded */
        }
    double best[2], free_x[2] = {0.0, 0.0};
    decay_optimum(best);
    for (int central = 0; central < 2; central++) { /* from zero without bounds, where `typical` gives the step */
        struct decay d = {0};
        scree_lm_problem problem = decay_problem(&d);
        problem.jacobian = NULL;
        for (int typical = 0; typical < 2; typical++) {
            free_x[0] = free_x[1] = 0.0;
            scree_lm_options options = {.central = central, .typical = typical ? (double[]){2.0, 1.0} : NULL};
            CHECK(solve(&problem, &options, free_x).converged);
            for (int k = 0; k < 2; k++) CLOSE(free_x[k], best[k], 1e-8);
        }
    }
}

/* NIST's problems by differences, from the nearer start. An error dJ of the Jacobian moves the optimum by (J^T J)^-1
 * dJ^T r: in standard deviations by the condition of the columns times |dJ|/|J| n sqrt(m). Central differences with
 * steps of h = 6e-6 |x| have errors of eps |f|/h = 4e-11 and of h^2 f_xxx/6 = 6e-12 (x/l)^2, l being the length over
 * which the model bends: (x/l)^2 is 1e4 for Eckerle's narrow peak, less than 100 else. Rounding of the residual comes
 * on top, eps |y|/|r|. */
static void test_differences_of_nist(void) {
    static double j[NIST_ROWS * NIST_PARAMETERS];
    for (int index = 0; index < NIST_PROBLEMS; index++) {
        struct nist *nist = &nist_problems[index];
        scree_lm_problem problem = nist_problem(nist);
        int n = nist->parameters, m = nist->rows;
        double x[NIST_PARAMETERS], condition = 1.0, s = sqrt(nist->certified_rss / (m - n));
        memcpy(x, nist->start[1], sizeof x);
        problem.jacobian(problem.context, nist->refined, j);
        problem.jacobian = NULL;
        CHECK(solve(&problem, &(scree_lm_options){.evaluations = 20000}, x).converged);
        for (int k = 0; k < n; k++)
            condition = scree_most(condition, nist->deviation[k] * scree_norm(m, j + k * m) / s);
        double error = 4e-11 + 6e-12 * (strcmp(nist->name, "Eckerle4") == 0 ? 1e4 : 100.0);
        double deviations = condition * sqrt(m) * n * error + DBL_EPSILON * scree_norm(m, nist->y) / s;
        for (int k = 0; k < n; k++) NEAR(x[k], nist->refined[k], nist->deviation[k] * deviations);
    }
}

/* ---- acceleration, interleaved solves, threads ---- */

/* With geodesic acceleration the way differs, the optimum doesn't. */
static void test_acceleration(void) {
    int solved = 0;
    for (int run = 0; run < 2 * NIST_PROBLEMS; run++) {
        struct nist *nist = &nist_problems[run / 2];
        scree_lm_problem problem = nist_problem(nist);
        double x[NIST_PARAMETERS];
        memcpy(x, nist->start[run % 2], sizeof x);
        scree_lm_outcome outcome = solve(&problem, &(scree_lm_options){.acceleration = 1}, x);
        double digits = nist_digits(nist, x);
        CHECK(!outcome.converged || digits >= 9.5);
        solved += outcome.converged;
    }
    printf("NIST with acceleration: %d of 54 solved\n", solved);
    CHECK(solved >= 50); /* it helps some and hinders others; the gate keeps it from breaking */
}

struct inner {
    int calls, problem;
};

/* Solves another problem whole, in its own workspace, in the middle of a step. */
static int solve_another(void *context, const scree_lm_progress *progress) {
    struct inner *inner = context;
    (void)progress;
    struct nist *nist = &nist_problems[inner->problem];
    scree_lm_problem problem = nist_problem(nist);
    double x[NIST_PARAMETERS];
    memcpy(x, nist->start[1], sizeof x);
    CHECK(solve_in(0xff, &problem, &(scree_lm_options){.loss = SCREE_LM_CAUCHY, .scale = 1.0}, x).residual_calls > 1);
    inner->calls++;
    return 0;
}

/* Nothing is kept outside of the workspace: a solve with others in between ends with the same bits. */
static void test_interleaved(void) {
    for (int index = 0; index < NIST_PROBLEMS; index++) {
        struct nist *nist = &nist_problems[index];
        scree_lm_problem problem = nist_problem(nist);
        struct inner inner = {0, (index + 5) % NIST_PROBLEMS};
        double alone[NIST_PARAMETERS], x[NIST_PARAMETERS];
        memcpy(alone, nist->start[1], sizeof alone);
        memcpy(x, nist->start[1], sizeof x);
        scree_lm_outcome one = solve_in(0, &problem, NULL, alone);
        scree_lm_outcome two =
            solve_in(0, &problem, &(scree_lm_options){.callback = solve_another, .callback_context = &inner}, x);
        CHECK(same_outcome(&one, &two) && inner.calls == two.iterations);
        CHECK(memcmp(x, alone, (size_t)nist->parameters * sizeof *x) == 0);
    }
}

/* Two threads at once, each over all problems in its own order: the bits of one after the other. */
struct job {
    int first;
    double x[NIST_PROBLEMS][NIST_PARAMETERS];
    unsigned char *workspace;
};

static int work(void *context) {
    struct job *job = context;
    for (int k = 0; k < NIST_PROBLEMS; k++) {
        int index = (job->first + k) % NIST_PROBLEMS;
        struct nist nist = nist_problems[index]; /* which counts its calls */
        scree_lm_problem problem = nist_problem(&nist);
        memcpy(job->x[index], nist.start[0], sizeof job->x[index]);
        scree_lm_solve(&problem, NULL, job->x[index], job->workspace);
    }
    return 0;
}

static void test_threads(void) {
    struct job *jobs = calloc(3, sizeof *jobs);
    thrd_t threads[2];
    for (int k = 0; k < 3; k++) {
        jobs[k].first = 9 * k;
        jobs[k].workspace = malloc(scree_lm_workspace(NIST_PARAMETERS, NIST_ROWS));
    }
    for (int k = 0; k < 2; k++) CHECK(thrd_create(&threads[k], work, &jobs[k]) == thrd_success);
    for (int k = 0; k < 2; k++) thrd_join(threads[k], NULL);
    work(&jobs[2]);
    for (int k = 0; k < 2; k++) CHECK(memcmp(jobs[k].x, jobs[2].x, sizeof jobs[2].x) == 0);
    for (int k = 0; k < 3; k++) free(jobs[k].workspace);
    free(jobs);
}

/* ---- the same bits everywhere ---- */

/* FNV-1a over the bytes of x. */
static unsigned long long hash_of(const double *x, int count) {
    unsigned char bytes[NIST_PARAMETERS * sizeof *x];
    unsigned long long hash = 0xcbf29ce484222325u;
    memcpy(bytes, x, (size_t)count * sizeof *x);
    for (size_t k = 0; k < (size_t)count * sizeof *x; k++) hash = (hash ^ bytes[k]) * 0x100000001b3u;
    return hash;
}

/* Every compiler, optimisation and instruction set ends at the same x, on ways of hundreds of steps that any other bit
 * would change. (All problems of NIST but the two that need the maths library: Nelson's logarithm and Roszman1's
 * arctangent.) */
static void test_golden(void) {
    FILE *file = fopen(SCREE_DATA "/golden/least_squares.txt", "r");
    CHECK(file != NULL);
    int rows = 0, start;
    char name[32];
    unsigned long long golden;
    while (file && fscanf(file, "%31s %d %llx", name, &start, &golden) == 3) {
        struct nist *nist = NULL;
        for (int k = 0; k < NIST_PROBLEMS; k++)
            if (strcmp(nist_problems[k].name, name) == 0) nist = &nist_problems[k];
        CHECK(nist && (start == 1 || start == 2));
        if (!nist) break;
        scree_lm_problem problem = nist_problem(nist);
        double x[NIST_PARAMETERS];
        memcpy(x, nist->start[start - 1], sizeof x);
        solve(&problem, NULL, x);
        if (hash_of(x, nist->parameters) != golden)
            printf("%s %d %016llx\n", name, start, hash_of(x, nist->parameters));
        CHECK(hash_of(x, nist->parameters) == golden);
        rows++;
    }
    if (file) fclose(file);
    CHECK(rows == 50);
}

/* ---- sizes ---- */

/* r_i = (i + 1) (x_i - i/n)^3 + x_i - i/n, and one more that couples all: a minimum of zero at x_i = i/n. */
static int chain_residual(void *context, const double *x, double *r) {
    int n = *(const int *)context;
    r[n] = 0.0;
    for (int k = 0; k < n; k++) {
        double d = x[k] - (double)k / n;
        r[k] = (k + 1) * d * d * d + d;
        r[n] += d;
    }
    return 0;
}

/* The fewest and the most unknowns, by differences and with bounds (upper bounds that hold the second half). */
static void test_sizes(void) {
    static const int sizes[] = {1, 2, 3, 255, 256};
    for (size_t s = 0; s < sizeof sizes / sizeof sizes[0]; s++) {
        int n = sizes[s];
        double x[SCREE_LM_UNKNOWNS], upper[SCREE_LM_UNKNOWNS];
        scree_lm_problem problem = {.unknowns = n, .residuals = n + 1, .residual = chain_residual, .context = &n};
        for (int k = 0; k < n; k++) x[k] = 1.5;
        scree_lm_outcome outcome = solve(&problem, NULL, x);
        CHECK(outcome.converged && outcome.rank == n && outcome.free == n);
        for (int k = 0; k < n; k++) NEAR(x[k], (double)k / n, 1e-12);
        problem.upper = upper;
        for (int k = 0; k < n; k++) {
            upper[k] = k < (n + 1) / 2 ? 2.0 : 0.25;
            x[k] = 1.5;
        }
        outcome = solve(&problem, NULL, x);
        CHECK(outcome.converged);
        for (int k = 0; k < n; k++) CHECK(x[k] <= upper[k]);
        CHECK(outcome.free == (n + 1) / 2);
    }
}

/* ---- the README's example ---- */

struct record {
    int points;
    double t[5], y[5];
};

static int misfit(void *context, const double *x, double *r) {
    const struct record *record = context;
    for (int k = 0; k < record->points; k++) r[k] = x[0] * exp(-x[1] * record->t[k]) - record->y[k];
    return 0;
}

static void test_example(void) {
    struct record record = {5, {0.0, 0.5, 1.0, 1.5, 2.0}, {2.52, 1.29, 0.69, 0.35, 0.19}};
    scree_lm_problem problem = {.unknowns = 2, .residuals = 5, .residual = misfit, .context = &record};
    double x[2] = {1.0, 1.0}, covariance[4];
    void *workspace = malloc(scree_lm_workspace(2, 5));
    scree_lm_outcome outcome = scree_lm_solve(&problem, NULL, x, workspace);
    CHECK(outcome.converged && scree_lm_covariance(&problem, NULL, x, covariance, NULL, workspace) == 2);
    NEAR(x[0], 2.52, 0.02); /* the measured values are good to about 0.01 */
    NEAR(x[1], 1.31, 0.02);
    CHECK(sqrt(covariance[0]) < 0.02 && sqrt(covariance[3]) < 0.02);
    free(workspace);
}

int main(void) {
    load_nist();
    test_nist();
    check_mgh_table();
    test_mgh();
    test_bounded();
    test_bad_input();
    test_not_finite();
    test_wrong_jacobian();
    test_singular();
    test_limits();
    test_units_of_residual();
    test_units_of_unknowns();
    test_covariance_of_line();
    test_covariance_at_bound();
    test_covariance_by_differences();
    test_covariance_of_nist();
    test_losses();
    test_losses_without_outliers();
    test_differences();
    test_differences_of_nist();
    test_acceleration();
    test_interleaved();
    test_threads();
    test_golden();
    test_sizes();
    test_example();
    return check_report();
}
