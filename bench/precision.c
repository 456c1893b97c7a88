/* scree-bench precision: run time against error for the integrators. */
#include "bench/bench.h"

#include "engine/cli/cli.h"

#include <math.h>
#include <string.h>
#include <time.h>

static const char help[] = "usage: scree-bench precision [--phases N] [--case NAME]\n"
                           "\n"
                           "Run time against error: a few events that each integrator simulates with steps of "
                           "different length. The error is the\n"
                           "largest over phases of first touch, with steps that don't divide the contact's duration; "
                           "of velocities in parts of\n"
                           "the impact speed, of the sliding distance in parts of it, of the bouncing ball's energy "
                           "after 20 bounces in parts of it.\n"
                           "Columns: case, integrator, steps per contact, step (s), largest error, microseconds of one "
                           "run, nanoseconds per step.\n"
                           "\n"
                           "example: scree-bench precision --phases 16 --case cradle\n";

enum { INTEGRATORS = 3, STEPS = 8, NUMBERS = 3 };

static const struct {
    const char *name, *choice, *substeps;
} integrators[INTEGRATORS] = {
    {"verlet", "time.integrator=\"verlet\"", NULL},
    {"pair-impulse", "time.integrator=\"pair-impulse\"", NULL},
    {"pair-impulse x4", "time.integrator=\"pair-impulse\"", "time.substeps=4"},
};

static const double per_contact[STEPS] = {10, 15, 20, 30, 50, 100, 200, 500};

#define BALL_AND_WALL                                                                                                  \
    "[time]\nend = 10.0\nforce = true\n[[material]]\nname = \"ball\"\n[[material]]\nname = \"wall\"\n"                 \
    "[[body]]\nname = \"wall\"\nshape = { plane = true }\nmaterial = \"wall\"\njoint = \"fixed\"\n"                    \
    "[[body]]\nname = \"first\"\nshape = { sphere = 0.01 }\nmaterial = \"ball\"\nmass = 0.03\n"
#define CONTACT "[[contact]]\nbetween = [\"ball\", \"wall\"]\n"

/* What happens, how long, and what is looked at. `reference` NAN: a run of pair-impulse x4 with 5000 steps a contact. */
static const struct event {
    const char *name, *scene;
    double duration; /* of a contact, s */
    double time;     /* of the event, s */
    double
        start; /* the first body's coordinate 0 or 2 along its way to touch, m: it starts up to a step's way before */
    int axis, numbers; /* of them; the numbers compared */
    double speed;      /* along that axis, m/s */
    double reference[NUMBERS];
} events[] = {
    {"damped impact",
     BALL_AND_WALL "velocity = [0, 0, -1]\n" CONTACT
                   "normal = { law = \"linear-cut\", stiffness = 1e5, restitution = 0.5 }\n",
     1.77e-3,
     3e-3,
     0.01,
     2,
     1,
     -1.0,
     {0.5}},
    {"hertz impact",
     BALL_AND_WALL "velocity = [0, 0, -1]\n" CONTACT "normal = { law = \"hertz\", stiffness = 5e6 }\n",
     1.66e-3,
     3e-3,
     0.01,
     2,
     1,
     -1.0,
     {1.0}},
    {"oblique impact",
     BALL_AND_WALL "velocity = [0.573576436351046, 0, -0.819152044288992]\n" CONTACT
                   "normal = { law = \"linear-cut\", stiffness = 1e5, restitution = 0.5 }\n"
                   "friction = { law = \"coulomb\", static = 0.3, kinetic = 0.3, stiffness = 8e4 }\n",
     1.77e-3,
     3e-3,
     0.01,
     2,
     3,
     -0.819152044288992,
     {NAN}},
    {"slide to rest",
     "gravity = [0, 0, -9.81]\n[time]\nend = 10.0\nforce = true\n[[material]]\nname = \"ball\"\n[[material]]\nname = "
     "\"wall\"\n[[body]]\nname = \"wall\"\nshape = { plane = true }\nmaterial = \"wall\"\njoint = \"fixed\"\n"
     "[[body]]\nname = \"first\"\nshape = { box = [0.03, 0.05, 0.012], rounding = 0.001 }\nmaterial = \"ball\"\nmass = "
     "0.03\nvelocity = [0.1, 0, 0]\n" CONTACT
     "normal = { law = \"linear-cut\", stiffness = 1e4, restitution = 0.5 }\nshared_by = 4\n"
     "friction = { law = \"coulomb\", static = 0.4, kinetic = 0.3, stiffness = 8e3, damping = 2.0 }\n",
     5.4e-3,
     0.4,
     0.006,
     2,
     1,
     0.0,
     {NAN}},
    {"cradle",
     "[time]\nend = 10.0\nforce = true\n[[material]]\nname = \"m\"\n"
     "[[contact]]\nbetween = [\"m\", \"m\"]\nnormal = { law = \"linear\", stiffness = 1e6, damping = 0.0 }\n"
     "[[body]]\nname = \"first\"\nshape = { sphere = 0.5 }\nmaterial = \"m\"\nmass = 1.0\nvelocity = [1, 0, 0]\n"
     "[[body]]\nname = \"second\"\nshape = { sphere = 0.5 }\nmaterial = \"m\"\nmass = 1.0\nposition = [1, 0, 0]\n"
     "[[body]]\nname = \"third\"\nshape = { sphere = 0.5 }\nmaterial = \"m\"\nmass = 1.0\nposition = [2, 0, 0]\n",
     2.2214e-3,
     12e-3,
     0.0,
     0,
     3,
     1.0,
     {-0.130261695065, 0.150229569434, 0.980032125631}},
    {"bouncing ball",
     "gravity = [0, 0, -9.81]\n" BALL_AND_WALL "velocity = [0, 0, -1]\n" CONTACT
     "normal = { law = \"hertz\", stiffness = 5e6 }\n",
     1.66e-3,
     4.1,
     0.02,
     2,
     1,
     0.0,
     {NAN}},
};
enum { EVENTS = sizeof events / sizeof events[0] };

/* The numbers that are compared. */
static void look(const struct event *event, const scree_scene *scene, double numbers[NUMBERS]) {
    scree_body_state first = scree_scene_body(scene, scree_scene_find_body(scene, "first"));
    if (strcmp(event->name, "cradle") == 0) {
        for (int k = 0; k < 3; k++) numbers[k] = scree_scene_body(scene, k).velocity[0];
    } else if (strcmp(event->name, "slide to rest") == 0) {
        numbers[0] = first.position[0] / 1.7e-3; /* (0.1 m/s)^2/(2 x 0.3 x 9.81 m/s^2) */
    } else if (strcmp(event->name, "bouncing ball") == 0) {
        double energy = 0.5 * first.velocity[2] * first.velocity[2] + 9.81 * (first.position[2] - 0.01);
        if (first.position[2] < 0.01) energy = NAN;
        numbers[0] = energy / (0.5 + 9.81 * 0.01);
    } else {
        numbers[0] = first.velocity[2];
        numbers[1] = first.velocity[0];
        numbers[2] = 0.01 * first.spin[1];
    }
}

/* Seconds of processor time: one thread runs, and whatever else the machine does isn't counted. */
static double processor_now(void) {
    struct timespec now;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* Run the event; returns the seconds that it took. */
static double run_event(const struct event *event, int integrator, double step, double phase, double numbers[NUMBERS],
                        long *steps) {
    char change[64], place[96];
    double start = event->start - phase * step * event->speed, at[3] = {0.0, 0.0, 0.0};
    at[event->axis] = start;
    snprintf(change, sizeof change, "time.step=%.17g", step);
    const char *body = strcmp(event->name, "cradle") == 0 ? "body.0" : "body.1";
    snprintf(place, sizeof place, "%s.position=[%.17g, %.17g, %.17g]", body, at[0], at[1], at[2]);
    const char *changes[] = {change, place, integrators[integrator].choice, integrators[integrator].substeps};
    scree_scene *scene = bench_scene_text(event->scene, changes, integrators[integrator].substeps ? 4 : 3);
    *steps = (long)ceil(event->time / step);
    double begin = processor_now();
    bench_step(scene, *steps);
    double seconds = processor_now() - begin;
    look(event, scene, numbers);
    if (strcmp(event->name, "bouncing ball") == 0)
        for (int k = 0; k < 100000 && isnan(numbers[0]); k++) {
            bench_step(scene, 1);
            look(event, scene, numbers);
        }
    scree_scene_destroy(scene);
    return seconds;
}

static void set_reference(const struct event *event, double reference[NUMBERS]) {
    long ignored;
    memcpy(reference, event->reference, sizeof event->reference);
    if (!isnan(reference[0])) return;
    if (strcmp(event->name, "bouncing ball") == 0)
        reference[0] = (9.81 * (event->start - 0.01) + 0.5) / (0.5 + 9.81 * 0.01);
    else
        run_event(event, INTEGRATORS - 1, event->duration / 5000.0, 0.0, reference, &ignored);
}

enum { PHASES = 64 };

/* One row of the table in the making. */
struct row {
    double worst, seconds[PHASES], nanoseconds[PHASES];
};

/* Integrators take turns, so that what else the machine does hits them alike. */
static void fill(const struct event *event, int phases, const double reference[NUMBERS], struct row (*rows)[STEPS]) {
    for (int k = 0; k < STEPS; k++)
        for (int phase = 0; phase < phases; phase++)
            for (int integrator = 0; integrator < INTEGRATORS; integrator++) {
                double part = (phase + 0.5) / phases, step = event->duration / (per_contact[k] - 0.5 + part);
                double numbers[NUMBERS];
                struct row *row = &rows[integrator][k];
                long steps;
                row->seconds[phase] = run_event(event, integrator, step, fmod(7.3 * part, 1.0), numbers, &steps);
                row->nanoseconds[phase] = row->seconds[phase] / (double)steps * 1e9;
                for (int n = 0; n < event->numbers; n++) row->worst = fmax(row->worst, fabs(numbers[n] - reference[n]));
            }
}

static void measure(const struct event *event, int phases) {
    double reference[NUMBERS];
    static struct row rows[INTEGRATORS][STEPS];
    memset(rows, 0, sizeof rows);
    set_reference(event, reference);
    fill(event, phases, reference, rows);
    for (int integrator = 0; integrator < INTEGRATORS; integrator++)
        for (int k = 0; k < STEPS; k++) {
            struct row *row = &rows[integrator][k];
            printf("%s,%s,%g,%.4g,%.3g,%.4g,%.0f\n", event->name, integrators[integrator].name, per_contact[k],
                   event->duration / per_contact[k], row->worst, bench_median(row->seconds, phases) * 1e6,
                   bench_median(row->nanoseconds, phases));
        }
    fflush(stdout);
}

int bench_precision(int count, char **words) {
    const char *phases = NULL, *only = NULL;
    const struct cli_option options[] = {
        {.name = "--phases", .value = &phases}, {.name = "--case", .value = &only}, {0}};
    int code = cli_parse(&count, words, options, help);
    if (code) return code < 0 ? EXIT_GOOD : code;
    int phase_count = phases ? cli_whole_number(phases, "--phases", PHASES) : 16;
    if (!phase_count) return EXIT_USAGE;
    const char *names[EVENTS + 1] = {0};
    int known = only == NULL;
    for (int k = 0; k < EVENTS; k++) {
        names[k] = events[k].name;
        known |= only && strcmp(only, names[k]) == 0;
    }
    if (!known) return cli_complain("there is no case \"%s\"%s", only, scree_hint(only, names).text);
    bench_describe_machine();
    printf("case,integrator,steps_per_contact,step_s,largest_error,run_us,ns_per_step\n");
    for (int k = 0; k < EVENTS; k++)
        if (!only || strcmp(only, names[k]) == 0) measure(&events[k], phase_count);
    return EXIT_GOOD;
}
