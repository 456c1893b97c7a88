/* scree-bench precision: run time against error for the integrators. The cases are in precision_cases.c. */
#include "bench/precision.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

static const char help[] =
    "usage: scree-bench precision [--phases N] [--case NAME] [--many N] [--per N] [--script]\n"
    "\n"
    "Run time against error: events that each integrator simulates with steps of different length. Errors are over "
    "phases "
    "of\n"
    "first touch, with steps that don't divide the contact's duration; of velocities in parts of the impact speed, of "
    "ways\n"
    "in parts of them. Right are closed forms and tables of reference; where there is none, a run of small steps, "
    "whose "
    "row \"reference\"\n"
    "gives its difference from a run of the other integrator with the same steps.\n"
    "Columns: case, integrator, steps per contact, step (s), largest error, microseconds of one run, nanoseconds per "
    "step,\n"
    "error's root mean square over phases and numbers.\n"
    "\n"
    "  --phases N   at most 64; 16 if not given (long cases take fewer)\n"
    "  --case NAME  this one only\n"
    "  --many N     N (at most 1024) of the impacts at once, up to 32 phases; time is that of one contact of one ball "
    "(see\n"
    "               bench/peers/precision.sh, which sets other programs beside them), after two steps without touch\n"
    "  --per N      this number of steps per contact only (3, 5, 8 and those of the table; with --many 1 and 2, but "
    "not verlet)\n"
    "  --script     print a gnuplot script that draws precision.csv and precision_peers.csv of data/bench\n"
    "\n"
    "example: scree-bench precision --phases 16 --case cradle\n";

static const char script[] =
    "# scree-bench precision > precision.csv; bench/peers/precision.sh build > precision_peers.csv; gnuplot "
    "precision.gp\n"
    "set datafile separator ','\n"
    "set terminal svg size 1000,440 dynamic enhanced font 'sans,11' background 'white'\n"
    "set output 'precision.svg'\n"
    "set multiplot layout 1,3\n"
    "set logscale xy\n"
    "set format '10^{%L}'\n"
    "set xlabel 'microseconds of the processor for a contact'\n"
    "set ylabel 'largest error of the rebound'\n"
    "set key outside bottom center horizontal\n"
    "of(who, file) = sprintf(\"< awk -F, '$1 == \\\"%s\\\" && $2 == \\\"%s\\\"' %s.csv\", name, who, file)\n"
    "do for [name in \"'damped impact with tension' 'tsuji impact' 'oblique impact with tension'\"] {\n"
    "  set title name\n"
    "  plot for [who in \"lammps liggghts yade verlet pair-impulse 'pair-impulse x4'\"] of(who, 'precision_peers') \\\n"
    "       using 6:5 with linespoints pt 7 ps 0.3 title who\n"
    "}\n"
    "unset multiplot\n"
    "set output 'precision_cases.svg'\n"
    "set terminal svg size 1500,1700 dynamic\n"
    "set key off\n"
    "set xlabel; set ylabel\n"
    "set multiplot layout 7,4 title 'largest error over microseconds of a run: verlet (red), pair-impulse (blue), 4 "
    "substeps (green)'\n"
    "cases = system(\"awk -F, '!/^#/ && $1 != \\\"case\\\" && !seen[$1]++ { print \\\"\\\\047\\\" $1 \\\"\\\\047\\\" "
    "}' "
    "precision.csv\")\n"
    "do for [name in cases] {\n"
    "  set title name\n"
    "  plot of('verlet', 'precision') using 6:5 with linespoints pt 7 ps 0.3 lc rgb '#c03030', \\\n"
    "       of('pair-impulse', 'precision') using 6:5 with linespoints pt 7 ps 0.3 lc rgb '#3060c0', \\\n"
    "       of('pair-impulse x4', 'precision') using 6:5 with linespoints pt 7 ps 0.3 lc rgb '#2a9d4e'\n"
    "}\n"
    "unset multiplot\n";

enum { INTEGRATORS = 3, STEPS = 15, PHASES = 64, MANY = 1024, MANY_PHASES = 32, WARM = 2, PARTS = 4 };

static const struct {
    const char *name, *choice, *substeps;
} integrators[INTEGRATORS] = {
    {"verlet", "time.integrator=\"verlet\"", NULL},
    {"pair-impulse", "time.integrator=\"pair-impulse\"", NULL},
    {"pair-impulse x4", "time.integrator=\"pair-impulse\"", "time.substeps=4"},
};

static const double per_contact[STEPS] = {1, 2, 3, 5, 8, 10, 12, 15, 20, 30, 50, 100, 200, 350, 500};

/* `only` 0: all steps but those that are long even for pair impulses. */
static int wanted(int k, double only) { return only > 0.0 ? per_contact[k] == only : per_contact[k] >= 10.0; }

static int is_step(double per) {
    int found = 0;
    for (int k = 0; k < STEPS; k++) found |= per_contact[k] == per;
    return found;
}

/* Steps so long that Verlet's method is near its limit, pi/2 a contact, are for the others. */
static int first_for(int k) { return per_contact[k] < 3.0; }

/* Seconds of processor time: one thread runs, and whatever else the machine does isn't counted. */
static double processor_now(void) {
    struct timespec now;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static scree_scene *make(const struct precision_case *c, const char *const *changes, int count) {
    if (c->file && !c->scene) return bench_scene(c->file, changes, count);
    char *text = c->scene ? NULL : c->make(c);
    scree_scene *scene = bench_scene_text(text ? text : c->scene, changes, count);
    free(text);
    return scene;
}

/* Run the event; returns the seconds that it took. */
static double run_case(const struct precision_case *c, int integrator, double step, double phase, double *numbers,
                       long *steps) {
    char change[64], place[160];
    *steps = (long)ceil(c->time / step);
    if (c->timed) step = c->time / (double)(*steps = lround(c->time / step));
    /* Of a scene of a file: to go on for as long as needed, with no frame for each of its rows. */
    const char *changes[7] = {change, integrators[integrator].choice, "time.end=1e4", "time.force=true",
                              "output.write=[]"};
    int count = c->file ? 5 : 2;
    snprintf(change, sizeof change, "time.step=%.17g", step);
    if (integrators[integrator].substeps) changes[count++] = integrators[integrator].substeps;
    if (c->arrives) {
        snprintf(place, sizeof place, "%s.position=[%.17g, %.17g, %.17g]", c->arrives,
                 c->touch[0] - phase * step * c->velocity[0], c->touch[1] - phase * step * c->velocity[1],
                 c->touch[2] - phase * step * c->velocity[2]);
        changes[count++] = place;
    }
    scree_scene *scene = make(c, changes, count);
    double begin = processor_now();
    bench_step(scene, *steps);
    double seconds = processor_now() - begin;
    c->look(c, scene, numbers);
    for (int k = 0; k < 100000 && isnan(numbers[0]); k++) { /* not to be had at every time */
        bench_step(scene, 1);
        c->look(c, scene, numbers);
    }
    scree_scene_destroy(scene);
    return seconds;
}

/* The right numbers; returns by how much two fine runs differ, 0 where none is needed. */
static double set_reference(const struct precision_case *c, double *reference) {
    static double other[PRECISION_NUMBERS];
    double step = c->duration / (c->fine > 0.0 ? c->fine : 5000.0), worst = 0.0;
    long ignored;
    if (c->right) {
        memcpy(reference, c->right, (size_t)c->numbers * sizeof *reference);
        return 0.0;
    }
    if (c->solve) {
        c->solve(c, reference);
        return 0.0;
    }
    run_case(c, INTEGRATORS - 1, step, 0.0, reference, &ignored);
    run_case(c, 0, step, 0.0, other, &ignored);
    for (int n = 0; n < c->numbers; n++) worst = scree_most(worst, fabs(other[n] - reference[n]));
    printf("%s,reference,%g,%.4g,%.3g,,,\n", c->name, c->duration / step, step, worst);
    return worst;
}

/* One row of the table in the making. */
struct row {
    double worst, squares, seconds[PHASES], nanoseconds[PHASES];
};

static void add_errors(struct row *row, const double *numbers, const double *right, int count) {
    for (int n = 0; n < count; n++) {
        double error = fabs(numbers[n] - right[n]);
        if (!(error <= row->worst)) row->worst = error; /* a NaN stays */
        row->squares += error * error;
    }
}

/* Integrators take turns, so that what else the machine does hits them alike. */
static void fill(const struct precision_case *c, int phases, double only, const double *reference,
                 struct row (*rows)[STEPS]) {
    static double numbers[PRECISION_NUMBERS];
    for (int k = 0; k < STEPS; k++)
        for (int phase = 0; phase < phases && wanted(k, only); phase++)
            for (int integrator = first_for(k); integrator < INTEGRATORS; integrator++) {
                double part = (phase + 0.5) / phases, step = c->duration / (per_contact[k] - 0.5 + part);
                struct row *row = &rows[integrator][k];
                long steps;
                row->seconds[phase] = run_case(c, integrator, step, fmod(7.3 * part, 1.0), numbers, &steps);
                row->nanoseconds[phase] = row->seconds[phase] / (double)steps * 1e9;
                add_errors(row, numbers, reference, c->numbers);
            }
}

static void print_row(const char *name, double duration, int integrator, int k, struct row *row, int count,
                      double numbers) {
    printf("%s,%s,%g,%.4g,%.3g,%.4g,%.0f,%.3g\n", name, integrators[integrator].name, per_contact[k],
           duration / per_contact[k], row->worst, bench_median(row->seconds, count) * 1e6,
           bench_median(row->nanoseconds, count), sqrt(row->squares / numbers));
}

static void measure(const struct precision_case *c, int phases, double only) {
    static double reference[PRECISION_NUMBERS];
    static struct row rows[INTEGRATORS][STEPS];
    memset(rows, 0, sizeof rows);
    if (c->phases && c->phases < phases) phases = c->phases;
    set_reference(c, reference);
    fill(c, phases, only, reference, rows);
    for (int integrator = 0; integrator < INTEGRATORS; integrator++)
        for (int k = 0; k < STEPS; k++)
            if (wanted(k, only) && integrator >= first_for(k))
                print_row(c->name, c->duration, integrator, k, &rows[integrator][k], phases, phases * c->numbers);
    fflush(stdout);
}

/* ---- many at once ---- */

/* The case's text with its ball, which comes last but for the laws, MANY times. */
static char *multiply(const struct precision_case *c, int balls, double step) {
    const char *ball = strstr(c->scene, "[[body]]\nname = \"first\""), *laws = strstr(c->scene, "[[contact]]");
    size_t size = strlen(c->scene) + (size_t)balls * 320 + 256, used;
    char *text = malloc(size);
    if (!text) return NULL;
    used = (size_t)snprintf(text, size, "%.*s", (int)(ball - c->scene), c->scene);
    for (int k = 0; k < balls; k++) {
        double ahead = step * (WARM + (k % MANY_PHASES + 0.5) / MANY_PHASES);
        used += (size_t)snprintf(
            text + used, size - used,
            "[[body]]\nname = \"%d\"\nshape = { sphere = 0.01 }\nmaterial = \"ball\"\nmass = 0.03\n"
            "position = [%.17g, %.17g, %.17g]\nvelocity = [%.17g, 0, %.17g]\n",
            k, 0.05 * (k % 32), 0.05 * (k / 32), 0.01 - ahead * c->velocity[2], c->velocity[0], c->velocity[2]);
    }
    snprintf(text + used, size - used, "%s[[contact]]\nbetween = [\"ball\", \"ball\"]\nnone = true\n", laws);
    return text;
}

static void run_many(const struct precision_case *c, int balls, int integrator, int part, int k,
                     const double *reference, struct row *row) {
    double per = per_contact[k] - 0.5 + (part + 0.5) / PARTS, step = c->duration / per;
    long steps = (long)(1.3 * per + 3.0);
    char change[64], *text = multiply(c, balls, step);
    const char *changes[] = {change, integrators[integrator].choice, integrators[integrator].substeps};
    snprintf(change, sizeof change, "time.step=%.17g", step);
    scree_scene *scene = bench_scene_text(text, changes, integrators[integrator].substeps ? 3 : 2);
    bench_step(scene, WARM);
    double begin = processor_now();
    bench_step(scene, steps);
    row->nanoseconds[part] = (processor_now() - begin) / (double)steps / balls * 1e9;
    row->seconds[part] = row->nanoseconds[part] * 1e-9 * per;
    for (int ball = 0; ball < balls; ball++) {
        scree_body_state state = scree_scene_body(scene, ball + 1);
        double numbers[3] = {state.velocity[2], state.velocity[0], 0.01 * state.spin[1]};
        add_errors(row, numbers, reference, c->numbers);
    }
    scree_scene_destroy(scene);
    free(text);
}

static void measure_many(const struct precision_case *c, int balls, double only) {
    double reference[PRECISION_NUMBERS];
    static struct row rows[INTEGRATORS][STEPS];
    memset(rows, 0, sizeof rows);
    set_reference(c, reference);
    for (int k = 0; k < STEPS; k++)
        for (int part = 0; part < PARTS && wanted(k, only); part++)
            for (int integrator = first_for(k); integrator < INTEGRATORS; integrator++)
                run_many(c, balls, integrator, part, k, reference, &rows[integrator][k]);
    for (int integrator = 0; integrator < INTEGRATORS; integrator++)
        for (int k = 0; k < STEPS; k++)
            if (wanted(k, only) && integrator >= first_for(k))
                print_row(c->name, c->duration, integrator, k, &rows[integrator][k], PARTS, PARTS * balls * c->numbers);
    fflush(stdout);
}

int bench_precision(int count, char **words) {
    enum { MOST = 64 };
    const char *phases = NULL, *only = NULL, *names[MOST + 1] = {0};
    const char *many = NULL, *steps = NULL;
    int wants_script = 0;
    const struct cli_option options[] = {
        {.name = "--phases", .value = &phases},      {.name = "--case", .value = &only},
        {.name = "--many", .value = &many},          {.name = "--per", .value = &steps},
        {.name = "--script", .flag = &wants_script}, {0}};
    int code = bench_parse(count, words, options, help);
    if (code) return code < 0 ? EXIT_GOOD : code;
    if (wants_script) {
        fputs(script, stdout);
        return EXIT_GOOD;
    }
    int phase_count = phases ? cli_whole_number(phases, "--phases", PHASES) : 16;
    int balls = many ? cli_whole_number(many, "--many", MANY) : MANY;
    int per = steps ? cli_whole_number(steps, "--per", 500) : 500;
    if (!phase_count || !balls || !per) return EXIT_USAGE;
    if (!steps) per = 0;
    if (per && !is_step(per))
        return cli_complain("--per is one of 1, 2, 3, 5, 8, 10, 12, 15, 20, 30, 50, 100, 200, 350, 500, not %d", per);
    if (per && per < 3 && !many)
        return cli_complain("--per 1 and 2 go with --many: without, the run ends before the contact does");
    int known = only == NULL;
    for (int k = 0, n = 0; k < precision_case_count && n < MOST; k++) {
        if (many && !precision_cases[k].many) continue;
        known |= only && strcmp(only, precision_cases[k].name) == 0;
        names[n++] = precision_cases[k].name;
    }
    if (!known) {
        code = cli_complain("there is no case \"%s\"%s%s; there are", only, many ? " of many at once" : "",
                            scree_hint(only, names).text);
        for (int n = 0; names[n]; n++) fprintf(stderr, "  %s\n", names[n]);
        return code;
    }
    bench_describe_machine();
    printf("case,integrator,steps_per_contact,step_s,largest_error,run_us,ns_per_step,rms_error\n");
    for (int k = 0; k < precision_case_count; k++) {
        const struct precision_case *c = &precision_cases[k];
        if (only && strcmp(only, c->name) != 0) continue;
        if (!many)
            measure(c, phase_count, per);
        else if (c->many)
            measure_many(c, balls, per);
    }
    return EXIT_GOOD;
}
