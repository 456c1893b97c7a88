/* scree fit: parameters of scenes, adjusted to measured records by least squares, with confidence intervals. */
#include "engine/c_locale.h"
#include "engine/cli/cli.h"
#include "engine/cli/figures.h"
#include "engine/cli/fit_model.h"
#include "solver/qr.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

static const char help[] =
    "usage: scree fit FIT [-o DIR] [--set KEY=VALUE …] [--threads N]\n"
    "\n"
    "Adjust parameters of scenes, such as coefficients of friction or stiffnesses, until they say of a body what was\n"
    "measured: positions, velocities or spins over time. A fit file (\"-\": standard input) names the parameters, the\n"
    "records and the scenes. Printed are values with their confidence intervals; into DIR (default: the file's name\n"
    "without .toml) go\n"
    "  fit.csv           a row a parameter: value, standard error, confidence interval\n"
    "  correlation.csv   what two parameters do alike: near 1 or -1 where records hardly tell them apart\n"
    "  record_N.csv      the N-th record beside what the scene says, and record_N.svg\n"
    "Exit status 1 if no minimum was found, or the records don't tell a parameter.\n"
    "\n"
    "  -o DIR           where to write\n"
    "  --set KEY=VALUE  change the fit file: parameter.kinetic.start=0.25, confidence=0.99\n"
    "  --threads N      scenes run at the same time (default: the number of processors)\n"
    "\n"
    "example: scree fit data/fit/comb.toml -o /tmp/comb\n";

/* Beyond these something is worth a word. */
static const double alike = 0.999;    /* correlation of two parameters */
static const double neighbours = 4.;  /* that of neighbouring misfits, in its standard deviations if there is none, */
static const double rounding = 1e-12; /* unless they are as small as this beside the readings */

struct fitting {
    struct fit_file file;
    struct fit_result result;
    struct figures output; /* folder, plots, trouble */
    struct figures_tables tables;
    int threads;
    double seconds;
};

/* ---- what is printed ---- */

static int show_progress(void *context, const scree_lm_progress *progress) {
    (void)context;
    if (isatty(STDERR_FILENO)) fprintf(stderr, "\rstep %d: misfit %-14.8g", progress->iteration, progress->norm);
    return 0;
}

static void print_parameters(const struct fitting *p) {
    static const char *const said[] = {"", "held at its bound", "not told by the records", "no minimum was found"};
    const struct fit_file *f = &p->file;
    char interval[32];
    snprintf(interval, sizeof interval, "%.12g %% interval", 100.0 * f->confidence);
    printf("\n%-20s %16s %16s   %s\n", "parameter", "value", "standard error", interval);
    for (int j = 0; j < f->parameters; j++) {
        const struct fit_result *result = &p->result;
        printf("%-20s %16.9g ", f->parameter[j].name, result->value[j]);
        if (result->state[j] == FIT_FREE)
            printf("%16.3g   %.9g to %.9g\n", result->error[j], result->low[j], result->high[j]);
        else
            printf("%16s   %s\n", "", said[result->state[j]]);
    }
}

/* Misfits of a column, in parts of a deviation: root mean square, and correlation of each with the next. */
struct misfits {
    double size, correlation;
};

static struct misfits look_at(const double *misfit, size_t rows) {
    double norm = scree_norm((int)rows, misfit), correlation = 0.0;
    for (size_t row = 1; row < rows && norm > 0.0; row++)
        correlation += (misfit[row] / norm) * (misfit[row - 1] / norm);
    return (struct misfits){norm / sqrt((double)rows), correlation};
}

static double largest_of(const double *reading, size_t rows) {
    double largest = 0.0;
    for (size_t row = 0; row < rows; row++) largest = fmax(largest, fabs(reading[row]));
    return largest;
}

static void print_misfits(struct fitting *p) {
    const struct fit_file *f = &p->file;
    const double *misfit = p->result.misfit;
    double largest = 0.0;
    printf("\n%-36s %-9s %8s %14s%s   %s\n", "record", "column", "readings", "rms misfit",
           f->weighted ? "   of deviation" : "", "correlation of neighbours");
    for (int k = 0; k < f->experiments; k++) {
        const struct fit_experiment *e = &f->experiment[k];
        for (int c = 0; c < e->columns; c++, misfit += e->rows) {
            struct misfits seen = look_at(misfit, e->rows);
            printf("%-36s %-9s %8zu %14.4g", scree_shown(e->record).text, fit_quantity_name[e->quantity[c]], e->rows,
                   seen.size * e->deviation[c]);
            if (f->weighted) printf(" %14.4g", seen.size);
            printf("   %.2f\n", seen.correlation);
            if (seen.size * e->deviation[c] > rounding * largest_of(e->reading[c], e->rows) &&
                seen.correlation > neighbours / sqrt((double)e->rows))
                largest = fmax(largest, seen.correlation);
        }
    }
    if (f->weighted)
        printf("misfits are %.3g times as large as the deviations say (intervals go by the misfits)\n",
               p->result.scatter);
    fflush(stdout);
    if (largest > 0.0)
        cli_complain(
            "warning: misfits of neighbouring readings go together (correlation %.2f): the scenes lack "
            "something that was measured, or the noise isn't independent; intervals are too narrow by a factor "
            "of %.1f or so",
            largest, sqrt((1.0 + largest) / fmax(1.0 - largest, 1e-4)));
}

static double correlation_of(const struct fit_result *result, int n, int i, int j) {
    double root = sqrt(result->covariance[i * n + i]) * sqrt(result->covariance[j * n + j]);
    return i == j ? 1.0 : root > 0.0 ? result->covariance[i * n + j] / root : 0.0;
}

static void warn_of_alike(const struct fitting *p) {
    int n = p->file.parameters;
    for (int i = 0; i < n; i++)
        for (int j = 0; j < i; j++)
            if (p->result.state[i] == FIT_FREE && p->result.state[j] == FIT_FREE &&
                fabs(correlation_of(&p->result, n, i, j)) > alike)
                cli_complain("warning: the records hardly tell \"%s\" and \"%s\" apart (correlation %.4f)",
                             p->file.parameter[j].name, p->file.parameter[i].name, correlation_of(&p->result, n, i, j));
}

/* What may be in the way of a fit that ends without a minimum. */
static void tell_why(const struct fit_result *result) {
    if (result->outcome.converged) return;
    fflush(stdout);
    if (result->refused.status)
        cli_complain("some parameters that were tried can't be, the last for this: %s", result->refused.text);
    if (result->outcome.reason == SCREE_LM_STUCK)
        cli_complain(
            "where an impact falls into another step, what a scene says jumps a little with its parameters, and "
            "a fit may stick there: a shorter time.step, time.integrator = \"pair-impulse\", or a larger "
            "difference of the parameters help");
}

static void print_all(struct fitting *p) {
    const struct fit_file *f = &p->file;
    const scree_lm_outcome *outcome = &p->result.outcome;
    if (f->title[0]) printf("%s\n", scree_shown(f->title).text);
    printf("%s; %zu readings of %d record%s, %d step%s, %ld runs in %.3g s\n", scree_lm_text(outcome->reason),
           f->readings, f->experiments, f->experiments > 1 ? "s" : "", outcome->iterations,
           outcome->iterations == 1 ? "" : "s", p->result.runs, p->seconds);
    print_parameters(p);
    print_misfits(p);
    warn_of_alike(p);
    tell_why(&p->result);
}

/* ---- tables ---- */

static scree_status write_parameters(struct fitting *p) {
    static const char *const states[] = {"free", "held", "undetermined", "adrift"};
    const struct fit_file *f = &p->file;
    FILE *file = figures_begin(&p->output, "fit", "parameter,value,standard_error,low,high,start,state", &p->tables);
    if (!file) return p->output.trouble.status;
    for (int j = 0; j < f->parameters; j++) {
        const struct fit_result *result = &p->result;
        fprintf(file, "%s,%.17g,", f->parameter[j].name, result->value[j]);
        if (result->state[j] == FIT_FREE)
            fprintf(file, "%.17g,%.17g,%.17g", result->error[j], result->low[j], result->high[j]);
        else
            fprintf(file, ",,");
        fprintf(file, ",%.17g,%s\n", f->parameter[j].start, states[result->state[j]]);
    }
    return figures_end(&p->output, &p->tables);
}

static scree_status write_correlations(struct fitting *p) {
    const struct fit_file *f = &p->file;
    FILE *file = figures_begin(&p->output, "correlation", NULL, &p->tables);
    if (!file) return p->output.trouble.status;
    fprintf(file, "parameter");
    for (int j = 0; j < f->parameters; j++) fprintf(file, ",%s", f->parameter[j].name);
    for (int i = 0; i < f->parameters; i++) {
        fprintf(file, "\n%s", f->parameter[i].name);
        for (int j = 0; j < f->parameters; j++) {
            int both = p->result.state[i] == FIT_FREE && p->result.state[j] == FIT_FREE;
            if (both)
                fprintf(file, ",%.17g", correlation_of(&p->result, f->parameters, i, j));
            else
                fputc(',', file);
        }
    }
    fprintf(file, "\n");
    return figures_end(&p->output, &p->tables);
}

static scree_status write_record(struct fitting *p, int k, const double *misfit) {
    const struct fit_experiment *e = &p->file.experiment[k];
    char name[32];
    snprintf(name, sizeof name, "record_%d", k + 1);
    FILE *file = figures_begin(&p->output, name, NULL, &p->tables);
    if (!file) return p->output.trouble.status;
    fprintf(file, "time_s");
    for (int c = 0; c < e->columns; c++)
        fprintf(file, ",%s,fitted_%s", fit_quantity_name[e->quantity[c]], fit_quantity_name[e->quantity[c]]);
    for (size_t row = 0; row < e->rows; row++) {
        fprintf(file, "\n%.17g", e->time[row]);
        for (int c = 0; c < e->columns; c++) {
            double measured = e->reading[c][row];
            fprintf(file, ",%.17g,%.17g", measured, measured + e->deviation[c] * misfit[(size_t)c * e->rows + row]);
        }
    }
    fprintf(file, "\n");
    return figures_end(&p->output, &p->tables);
}

enum { MOST_POINTS = 4000 };

/* A panel a column: above what was measured and fitted, below the misfit. */
static scree_status plot_record(struct fitting *p, int k) {
    static const char *const units[] = {"m", "m/s", "rad/s"};
    const struct fit_experiment *e = &p->file.experiment[k];
    char name[32], script[8192];
    snprintf(name, sizeof name, "record_%d", k + 1);
    size_t apart = 1 + e->rows / MOST_POINTS; /* no plot holds more */
    int length =
        snprintf(script, sizeof script,
                 "set output\nset terminal svg size 960,%d enhanced font 'Helvetica,14' background rgb 'white'\n"
                 "set output '%s.svg'\nset multiplot layout %d,2\nset xlabel 'time (s)'\n"
                 "set xrange [:] noextend\nset format x '%%g'\nset xtics rotate by -30\n",
                 60 + 360 * e->columns, name, e->columns);
    for (int c = 0; c < e->columns; c++) {
        const char *quantity = fit_quantity_name[e->quantity[c]], *unit = units[e->quantity[c] / 3];
        int letters = (int)strcspn(quantity, "_"), column = 2 + 2 * c;
        length += snprintf(script + length, sizeof script - (size_t)length,
                           "set key top left\nset ylabel '%.*s (%s)'\n"
                           "plot '%s.csv' using 1:%d every %zu with points ls 2 ps 0.4 title 'measured',\\\n"
                           "     '' using 1:%d every %zu with lines ls 1 title 'fitted'\n"
                           "unset key\nset ylabel 'fitted less measured (%s)'\n"
                           "plot '%s.csv' using 1:($%d-$%d) every %zu with points ls 3 ps 0.4\n",
                           letters, quantity, unit, name, column, apart, column + 1, apart, unit, name, column + 1,
                           column, apart);
    }
    snprintf(script + length, sizeof script - (size_t)length, "unset multiplot\n");
    return figures_plot(&p->output, name, script);
}

/* Of an earlier fit with more records; each has left its script, which tells them from other files of such a name. */
static void remove_stale(const struct fitting *p) {
    static const char *const endings[] = {".gp", ".csv", ".svg"};
    int removed = 1;
    for (int k = p->file.experiments; removed; k++)
        for (int e = 0; e < 3 && removed; e++) {
            char name[32];
            snprintf(name, sizeof name, "record_%d%s", k + 1, endings[e]);
            char *path = scree_join(p->output.folder, name);
            int gone = path && remove(path) == 0;
            if (e == 0) removed = gone;
            free(path);
        }
}

static scree_status write_all(struct fitting *p) {
    const struct fit_file *f = &p->file;
    const double *misfit = p->result.misfit;
    scree_status status = write_parameters(p);
    if (!status) status = write_correlations(p);
    for (int k = 0; k < f->experiments && !status; k++) {
        status = write_record(p, k, misfit);
        misfit += f->experiment[k].rows * (size_t)f->experiment[k].columns;
    }
    status = figures_keep(&p->output, &p->tables, status);
    if (status) return status;
    remove_stale(p);
    for (int k = 0; k < f->experiments && !status; k++) status = plot_record(p, k);
    return status;
}

/* ---- the whole ---- */

/* Records and scenes aren't written over: what is in the folder for results is taken for results. */
static scree_status check_inputs(struct fitting *p) {
    for (int k = 0; k < 2 * p->file.experiments; k++) {
        const struct fit_experiment *e = &p->file.experiment[k / 2];
        const char *input = k % 2 ? e->scene : e->record;
        if (scree_is_in(p->output.folder, input))
            return scree_report(&p->output.trouble, SCREE_BAD_INPUT, NULL,
                                "%s is in the folder that results would go to; name another one with -o", input);
    }
    return SCREE_OK;
}

/* Before long runs. The folder is made first: a name such as new/.. leads nowhere before. */
static scree_status check_folder(struct fitting *p) {
    const char *folder = p->output.folder;
    scree_status status = scree_make_folder(folder, &p->output.trouble);
    if (!status) status = check_inputs(p);
    if (status || access(folder, W_OK | X_OK) == 0) return status;
    return scree_report(&p->output.trouble, SCREE_NO_FILE, NULL, "%s: %s", folder, strerror(errno));
}

static scree_status solve(struct fitting *p) {
    struct timespec start, end;
    clock_gettime(CLOCK_MONOTONIC, &start);
    scree_status status = fit_solve(&p->file, p->threads, show_progress, &p->result, &p->output.trouble);
    clock_gettime(CLOCK_MONOTONIC, &end);
    p->seconds = (double)(end.tv_sec - start.tv_sec) + 1e-9 * (double)(end.tv_nsec - start.tv_nsec);
    if (p->result.outcome.iterations > 0 && isatty(STDERR_FILENO)) fputc('\n', stderr); /* ends that of the progress */
    return status;
}

static scree_status work(struct fitting *p) {
    p->tables.out = calloc((size_t)p->file.experiments + 2, sizeof *p->tables.out);
    if (!p->tables.out) return scree_report(&p->output.trouble, SCREE_NO_MEMORY, NULL, "no memory for a fit");
    int there = access(p->output.folder, F_OK) == 0;
    scree_status status = check_folder(p);
    if (!status) status = solve(p);
    if (!status) print_all(p);
    if (!status) status = write_all(p);
    if (status && !there) rmdir(p->output.folder); /* only if nothing is in it */
    if (!status) printf("written to %s\n", p->output.folder);
    return status;
}

static int is_good(const struct fitting *p) {
    int good = p->result.outcome.converged;
    for (int j = 0; j < p->file.parameters; j++) good = good && p->result.state[j] <= FIT_HELD;
    return good;
}

int cli_fit(int count, char **words) {
    const char *folder = NULL, *threads = NULL, *assignments[256];
    int assignment_count = 0;
    const struct cli_option options[] = {
        {.name = "-o", .value = &folder},
        {.name = "--threads", .value = &threads},
        {.name = "--set", .list = assignments, .list_count = &assignment_count, .list_capacity = 256},
        {0}};
    int code = cli_parse(&count, words, options, help);
    if (code) return code < 0 ? EXIT_GOOD : code;
    if (count != 1) return cli_complain("fit takes one fit file (see scree fit --help)");
    struct fitting p = {.threads = cli_threads(threads)};
    if (!p.threads) return EXIT_USAGE;
    char *named = folder ? NULL : cli_default_folder(words[0], "fit", "");
    p.output = (struct figures){.folder = folder ? folder : named, .plots = 1};
    scree_status status = fit_file_read(words[0], assignments, assignment_count, &p.file, &p.output.trouble);
    if (!status && !p.output.folder)
        status = scree_report(&p.output.trouble, SCREE_NO_MEMORY, NULL, "no memory for a file name");
    struct scree_c_locale locale = scree_enter_c_locale();
    if (!status) status = work(&p);
    scree_leave_c_locale(locale);
    if (status) cli_complain("%s", p.output.trouble.text);
    code = status ? cli_exit_code(status) : is_good(&p) && !figures_unplotted(&p.output) ? EXIT_GOOD : EXIT_MISSED;
    fit_free_result(&p.result);
    fit_file_free(&p.file);
    free(p.tables.out);
    free(named);
    return code;
}
