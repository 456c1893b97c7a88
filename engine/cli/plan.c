/* scree plan: motion profiles for one operating speed or many, the characteristic map, what happens over the speed,
 * servo tables. */
#include "engine/c_locale.h"
#include "engine/cli/cli.h"
#include "engine/cli/figures.h"
#include "engine/cli/transport_file.h"
#include "solver/conventional.h"
#include "solver/table.h"

#include <dirent.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const char help[] =
    "usage: scree plan TRANSPORT [-o DIR] [--set KEY=VALUE …] [--threads N]\n"
    "\n"
    "Plan motion profiles of a comb that throws and catches its product without impact, for the operating speeds of a\n"
    "transport file (\"-\": standard input). Into DIR (default: the file's name without .toml) go, as far as the file "
    "asks:\n"
    "  plan.csv       a row a speed: state, events, largest acceleration and jerk, what a simulation makes of it,\n"
    "                 sensitivities of the clearance at the catch\n"
    "  servo_N.csv    the profile at N cycles a minute, planned or from the map, for a motion controller\n"
    "  map.csv        the characteristic map's knots; what it gives in map_surface.csv and map.svg\n"
    "  curves.csv     position error over the operating speed: conventional, scaled, planned, from the map; and "
    "curves.svg\n"
    "Nothing is replaced before everything is computed; then files of an earlier plan that this one hasn't got are "
    "removed.\n"
    "If no speed has a plan, nothing is written or removed.\n"
    "The limits of both motions, and what lies between them, are printed. Exit status 1 if a speed has no plan, or "
    "ends\n"
    "farther from its place than the tolerance of [curves] (default: 1 mm).\n"
    "\n"
    "  -o DIR           where to write\n"
    "  --set KEY=VALUE  change the file: plan.speeds=[500], transport.friction=0.28\n"
    "  --threads N      speeds at the same time (default: the number of processors)\n"
    "\n"
    "example: scree plan data/transport/bars.toml -o /tmp/bars\n";

/* Motions compared over the operating speed. */
enum { CONVENTIONAL, SCALED, FRESH, MAPPED, MOTIONS };

/* One operating speed, planned and simulated. */
struct speed {
    scree_plan plan;
    int ran; /* `run` holds a simulation with all tines */
    struct process_run run;
    double clearance;                   /* at the catch, by simulation (by the plan without a model), m */
    scree_outcome by[SCREE_CONDITIONS]; /* derivatives of the clearance */
};

struct planning {
    struct transport_file file;
    struct figures output; /* folder, plots, trouble */
    struct speed *speeds;
    scree_map map;
    scree_map_report report;
    double (*errors)[MOTIONS]; /* over the operating speed; NULL: none */
    struct figures_tables tables;
    int threads, failed;
};

static scree_plan_options options_of(const struct transport_file *f) {
    scree_plan_options options = {.formulation = f->formulation, .clearance = f->clearance};
    options.process = f->modelled ? process_catch : NULL;
    options.context = (void *)(uintptr_t)&f->process; /* only read */
    return options;
}

/* ---- output ---- */

/* A number and the comma before it; nothing for what isn't known. */
static void put(FILE *file, double x) { fprintf(file, isfinite(x) ? ",%.17g" : ",", x); }

/* How many speeds are done, on a terminal: with little friction each may take minutes. */
static void show_progress(const char *what, int *done, int all) {
#pragma omp critical
    {
        ++*done;
        if (isatty(STDERR_FILENO))
            fprintf(stderr, "\r%s: %d of %d speeds%s", what, *done, all, *done == all ? "\n" : "");
    }
}

/* ---- plans ---- */

static double catch_cost(void *file, const scree_plan *plan) {
    const struct transport_file *f = file;
    struct process_run run = {.watch = NULL};
    return process_simulate(&f->process, &plan->profile, f->task.distance, &run) ? HUGE_VAL : run.catch_force;
}

/* Choose the time shares at the highest speed, where drive and catch are loaded most; they serve for all speeds. */
static scree_status choose_shares(struct planning *p) {
    struct transport_file *f = &p->file;
    double highest = 0.0;
    for (int k = 0; k < f->speeds; k++) highest = fmax(highest, f->speed[k]);
    scree_plan_options options = options_of(f);
    scree_plan plan;
    scree_plan_shares(&f->task, highest, &options, f->shares, f->shares == SCREE_LEAST_CATCH ? catch_cost : NULL, f,
                      &plan);
    if (plan.state)
        return scree_report(&p->output.trouble, SCREE_FAILED, NULL,
                            "no time shares found: already at the times given there is no plan for %g cycles/min: %s",
                            highest, plan.text);
    printf("times chosen at %g cycles/min: %.4f, %.4f, %.4f of the transport time\n", highest, f->task.fractions[0],
           f->task.fractions[1], f->task.fractions[2]);
    return SCREE_OK;
}

/* A fixed profile under other conditions, for sensitivities. */
struct probe {
    const struct transport_file *file;
    const scree_plan *plan;
};

static int probe_clearance(void *context, const double conditions[SCREE_CONDITIONS], scree_outcome *outcome) {
    const struct probe *probe = context;
    struct process with = probe->file->process;
    with.kinetic_friction = conditions[SCREE_BY_FRICTION];
    with.static_friction = fmax(with.static_friction, with.kinetic_friction);
    with.gap = conditions[SCREE_BY_PLAY] + with.length;
    with.start = conditions[SCREE_BY_START];
    with.tine_stiffness = conditions[SCREE_BY_STIFFNESS];
    with.tine_restitution = conditions[SCREE_BY_RESTITUTION];
    scree_catch caught = {0};
    int failed = process_catch(&with, &probe->plan->profile, probe->plan->time[3], &caught);
    *outcome = (scree_outcome){.clearance = caught.clearance};
    return failed;
}

static void add_sensitivities(const struct transport_file *f, struct speed *s) {
    for (int c = 0; c < SCREE_CONDITIONS; c++) s->by[c].clearance = NAN;
    scree_outcome by[SCREE_CONDITIONS];
    if (!f->modelled) {
        if (!scree_rigid_sensitivities(&f->task, &s->plan, by)) memcpy(s->by, by, sizeof by);
        return;
    }
    const struct process *m = &f->process;
    struct probe probe = {f, &s->plan};
    double play = scree_transport_play(&f->task);
    const double steps[SCREE_CONDITIONS] = {fmin(1e-3, 0.01 * m->kinetic_friction), fmin(1e-5, 0.1 * play),
                                            fmin(5e-5, 0.1 * play), 0.01 * m->tine_stiffness,
                                            fmin(0.01, 0.1 * m->tine_restitution)};
    const double working[SCREE_CONDITIONS] = {m->kinetic_friction, play, m->start, m->tine_stiffness,
                                              m->tine_restitution};
    for (int c = 0; c < SCREE_CONDITIONS; c++) {
        double at[SCREE_CONDITIONS], step[SCREE_CONDITIONS] = {0.0};
        memcpy(at, working, sizeof at);
        step[c] = steps[c];
        /* Central about the working point; where that is a bound, about the nearest point that leaves room. */
        if (c == SCREE_BY_START) at[c] = fmax(at[c], 2.0 * step[c]);
        if (c == SCREE_BY_RESTITUTION) at[c] = fmin(at[c], 1.0 - step[c]);
        if (!scree_sensitivities(probe_clearance, &probe, at, step, by)) s->by[c] = by[c];
    }
}

static void plan_speed(const struct transport_file *f, double cycles, struct speed *s) {
    scree_plan_options options = options_of(f);
    scree_plan_make(&f->task, cycles, &options, &s->plan);
    if (s->plan.state) return;
    scree_catch caught = {0};
    if (f->modelled) {
        s->ran = process_simulate(&f->process, &s->plan.profile, f->task.distance, &s->run) == SCREE_OK;
        if (process_catch(options.context, &s->plan.profile, s->plan.time[3], &caught)) caught.clearance = NAN;
    } else
        caught = scree_slide_catch(&f->task, &s->plan.profile, s->plan.detached, s->plan.time[3]);
    s->clearance = caught.clearance;
    add_sensitivities(f, s);
}

static scree_status write_plans(struct planning *p) {
    FILE *file = figures_begin(
        &p->output, "plan",
        "cycles_1_min,state,transport_time_s,t1_s,t2_s,t3_s,v1_m_s,v2_m_s,v3_m_s,a1_m_s2,a2_m_s2,a3_m_s2,detachment_s,"
        "largest_acceleration_m_s2,largest_jerk_m_s3,simulations,clearance_m,approach_m_s,catch_N,final_error_m,"
        "by_friction_m,by_play,by_start,by_stiffness_m2_N,by_restitution_m",
        &p->tables);
    if (!file) return p->output.trouble.status;
    for (int k = 0; k < p->file.speeds; k++) {
        const struct speed *s = &p->speeds[k];
        const scree_plan *plan = &s->plan;
        fprintf(file, "%.17g,%s", p->file.speed[k], scree_plan_state_name(plan->state));
        if (plan->state) {
            fprintf(file, ",,,,,,,,,,,,,,,,,,,,,,,\n");
            continue;
        }
        put(file, plan->duration);
        for (int e = 1; e <= 3; e++) put(file, plan->time[e]);
        for (int e = 1; e <= 3; e++) put(file, plan->event[e].v);
        for (int e = 1; e <= 3; e++) put(file, plan->event[e].a);
        put(file, plan->detached);
        put(file, scree_extrema_acceleration(&plan->extrema));
        put(file, scree_extrema_jerk(&plan->extrema));
        put(file, plan->simulations);
        put(file, s->clearance);
        put(file, s->ran ? s->run.approach : NAN);
        put(file, s->ran ? s->run.catch_force : NAN);
        put(file, s->ran ? s->run.error : NAN);
        for (int c = 0; c < SCREE_CONDITIONS; c++) put(file, s->by[c].clearance);
        fprintf(file, "\n");
    }
    return figures_end(&p->output, &p->tables);
}

/* `modelled`: products are simulated, too. */
static void print_heads(int modelled, const char *speed, const char *v1, const char *v2, const char *v3,
                        const char *clearance, const char *approach, const char *catch, const char *error) {
    printf("%10s %10s %10s %10s %12s", speed, v1, v2, v3, clearance);
    if (modelled) printf(" %12s %12s %12s", approach, catch, error);
    printf("\n");
}

static void print_plans(const struct planning *p) {
    print_heads(p->file.modelled, "speed", "v1", "v2", "v3", "clearance", "approach", "catch", "final error");
    print_heads(p->file.modelled, "(1/min)", "(m/s)", "(m/s)", "(m/s)", "(m)", "(m/s)", "(N)", "(mm)");
    for (int k = 0; k < p->file.speeds; k++) {
        const struct speed *s = &p->speeds[k];
        if (s->plan.state) {
            printf("%10g no plan: %s\n", p->file.speed[k], s->plan.text);
            continue;
        }
        printf("%10g %10.5f %10.5f %10.5f %12.3g", p->file.speed[k], s->plan.event[1].v, s->plan.event[2].v,
               s->plan.event[3].v, s->clearance);
        if (s->ran)
            printf(" %12.3g %12.3g %+12.3g", s->run.approach, s->run.catch_force, 1e3 * s->run.error);
        else if (p->file.modelled)
            printf("  the simulation stopped: %s", s->run.trouble.text);
        printf("\n");
    }
}

static void make_plans(struct planning *p) {
    const struct transport_file *f = &p->file;
    int misplaced = 0, done = 0;
#pragma omp parallel for schedule(dynamic) num_threads(p->threads)
    for (int k = 0; k < f->speeds; k++) {
        plan_speed(f, f->speed[k], &p->speeds[k]);
        show_progress("plans", &done, f->speeds);
    }
    for (int k = 0; k < f->speeds; k++) {
        const struct speed *s = &p->speeds[k];
        p->failed += s->plan.state || (f->modelled && !s->ran);
        misplaced += s->ran && !(fabs(s->run.error) <= f->tolerance);
    }
    print_plans(p);
    if (misplaced)
        printf("at %d of these speeds the simulated product ends farther than %g mm from its place\n", misplaced,
               1e3 * f->tolerance);
    p->failed += misplaced;
}

/* ---- servo tables ---- */

/* "servo_500", with as many digits as tell the speed from all others. */
static void servo_name(double cycles, char name[64]) {
    for (int digits = 6; digits <= 17; digits++) {
        snprintf(name, 64, "servo_%.*g", digits, cycles);
        if (strtod(name + 6, NULL) == cycles) return;
    }
}

static scree_status write_servo(struct planning *p, double cycles, const struct scree_profile *profile) {
    const struct transport_file *f = &p->file;
    char name[64];
    servo_name(cycles, name);
    scree_table_options options = {.rate = f->rate, .cycles = f->angle ? cycles : 0.0};
    scree_cycle cycle;
    scree_cycle_def def = {.cycles = cycles, .lift = f->lift};
    if (f->lift != 0.0 && scree_cycle_make(&def, profile, &cycle))
        return scree_report(&p->output.trouble, SCREE_BAD_INPUT, NULL, "no return stroke at %g cycles/min: %s", cycles,
                            cycle.text);
    FILE *file = figures_begin(&p->output, name, NULL, &p->tables);
    if (!file) return p->output.trouble.status;
    int failed =
        f->lift != 0.0 ? scree_table_write_cycle(file, &cycle, &options) : scree_table_write(file, profile, &options);
    scree_status status = figures_end(&p->output, &p->tables);
    if (!status && failed)
        status = scree_report(&p->output.trouble, SCREE_BAD_INPUT, NULL, "no servo table at %g rows a second", f->rate);
    return status;
}

/* Whether there is a servo table for speed k, the first of its speed, and its profile: the plan's or the map's. */
static int has_servo(const struct planning *p, int k, struct scree_profile *profile) {
    const struct transport_file *f = &p->file;
    if (!(f->rate > 0.0)) return 0;
    for (int j = 0; j < k; j++)
        if (f->speed[j] == f->speed[k]) return 0;
    if (f->from_map) return scree_map_profile(&p->map, f->speed[k], profile) == SCREE_MAP_GOOD;
    *profile = p->speeds[k].plan.profile;
    return p->speeds[k].plan.state == SCREE_PLAN_GOOD;
}

static scree_status write_servos(struct planning *p) {
    scree_status status = SCREE_OK;
    struct scree_profile profile;
    for (int k = 0; k < p->file.speeds && !status; k++)
        if (has_servo(p, k, &profile)) status = write_servo(p, p->file.speed[k], &profile);
    return status;
}

/* ---- characteristic map ---- */

/* What blending adds shows beside plans that reach the target: those of a rigid product don't with a soft one. */
static double map_error(void *file, const struct scree_profile *profile, double cycles) {
    const struct transport_file *f = file;
    if (f->formulation != SCREE_PLAN_C) return scree_map_clearance((void *)(uintptr_t)&f->task, profile, cycles);
    scree_catch caught;
    double until = f->task.fractions[2] * scree_transport_time(&f->task, cycles);
    return process_catch((void *)(uintptr_t)&f->process, profile, until, &caught) ? HUGE_VAL : caught.clearance;
}

static const char script_map[] =
    "set title 'Characteristic map: velocity of the comb'\n"
    "set xlabel 'time over transport time'\nset ylabel 'operating speed (1/min)'\nset zlabel 'velocity (m/s)' rotate\n"
    "unset key\nset hidden3d offset 0\nset view 55,325\nset ticslevel 0\n"
    "splot 'map_surface.csv' using 2:1:3 with lines ls 3\n";

static scree_status write_map(struct planning *p) {
    enum { ROWS = 41, COLUMNS = 51 };
    const scree_map *map = &p->map;
    if (map->count == 0) return SCREE_OK;
    FILE *file = figures_begin(&p->output, "map", "cycles_1_min,f1,f2,f3,v1_T_m,v2_T_m,v3_T_m,a1_T2_m,a2_T2_m,a3_T2_m",
                               &p->tables);
    for (int k = 0; file && k < map->count; k++) {
        const scree_map_knot *knot = &map->knots[k];
        const double *sets[3] = {knot->fractions, knot->v, knot->a};
        fprintf(file, "%.17g", knot->cycles);
        for (int s = 0; s < 9; s++) put(file, sets[s / 3][s % 3]);
        fprintf(file, "\n");
    }
    if (!file || figures_end(&p->output, &p->tables)) return p->output.trouble.status;
    file = figures_begin(&p->output, "map_surface", "cycles_1_min,share_of_time,v_m_s", &p->tables);
    for (int row = 0; file && row < ROWS; row++) {
        double cycles = p->file.map.low + (p->file.map.high - p->file.map.low) * row / (ROWS - 1);
        struct scree_profile profile;
        if (scree_map_profile(map, cycles, &profile)) continue;
        for (int k = 0; k < COLUMNS; k++) {
            double u = k / (COLUMNS - 1.0), time = u * scree_profile_duration(&profile);
            fprintf(file, "%.17g,%.17g,%.17g\n", cycles, u, scree_profile_at(&profile, time).v);
        }
        fprintf(file, "\n");
    }
    return file ? figures_end(&p->output, &p->tables) : p->output.trouble.status;
}

static void make_map(struct planning *p) {
    struct transport_file *f = &p->file;
    if (!f->mapped) return;
    f->map.error = map_error;
    f->map.context = f;
    scree_plan_options options = options_of(f);
    options.clearance = fmin(f->clearance, 0.1 * f->map.bound);
    p->report = scree_map_place(&p->map, &f->task, &options, &f->map);
    const scree_map_report *report = &p->report;
    p->failed += report->state != SCREE_MAP_GOOD;
    if (report->state == SCREE_MAP_BAD_PLAN) {
        printf("map: no plan at %g cycles/min: %s\n", report->plan.cycles, report->plan.text);
        p->map.count = 0;
        return;
    }
    printf("map: %d knots from %g to %g cycles/min, weights linear in %s: clearance within %.3g m at three speeds "
           "between each two (worst at %g)%s%s\n",
           p->map.count, f->map.low, f->map.high, scree_map_names[p->map.weight], report->error, report->at,
           report->state ? "; the bound is missed: " : "", report->state ? scree_map_text(report->state) : "");
}

/* ---- over the operating speed ---- */

static struct scree_conventional conventional_of(const scree_transport *t) {
    return (struct scree_conventional){
        .stroke = t->distance, .share = t->share, .friction = t->friction, .gravity = t->gravity};
}

/* Position error of a profile at rest: by the process model, or for a rigid product. NAN: the run went wrong. */
static double error_of(const struct transport_file *f, const struct scree_profile *profile) {
    if (!f->modelled) return scree_slide_simulate(&f->task, profile, f->process.tine_restitution).error;
    struct process_run run = {.watch = NULL};
    return process_simulate(&f->process, profile, f->task.distance, &run) ? NAN : run.error;
}

/* Errors at one speed; NAN where a motion doesn't exist. */
static void errors_at(const struct planning *p, const scree_plan *design, double cycles, double errors[MOTIONS]) {
    const struct transport_file *f = &p->file;
    struct scree_conventional conventional = conventional_of(&f->task);
    errors[CONVENTIONAL] = scree_conventional_error(&conventional, cycles);
    struct scree_profile profile = scree_profile_scaled(&design->profile, scree_transport_time(&f->task, cycles));
    errors[SCALED] = error_of(f, &profile);
    scree_plan_options options = options_of(f);
    scree_plan plan;
    scree_plan_make(&f->task, cycles, &options, &plan);
    errors[FRESH] = plan.state ? NAN : error_of(f, &plan.profile);
    errors[MAPPED] = scree_map_profile(&p->map, cycles, &profile) ? NAN : error_of(f, &profile);
}

static const char script_curves[] = "set title 'Positioning error over the operating speed'\n"
                                    "set xlabel 'operating speed (1/min)'\nset ylabel 'positioning error (mm)'\nset "
                                    "bmargin 7\nset key outside below maxrows 2\n"
                                    "set yrange [-5:5]\n"
                                    "plot 'curves.csv' using 1:($2*1e3) with lines ls 1 title 'conventional',\\\n"
                                    "     '' using 1:($3*1e3) with linespoints ls 2 title 'new, scaled',\\\n"
                                    "     '' using 1:($4*1e3) with linespoints ls 3 title 'new, planned'";
static const char script_mapped[] = ",\\\n     '' using 1:($5*1e3) with points ls 4 title 'new, from the map'";

static double curve_speed(const struct transport_file *f, int k) {
    return f->from + (f->to - f->from) * k / (f->curves - 1);
}

static scree_status make_curves(struct planning *p) {
    const struct transport_file *f = &p->file;
    if (!f->curves) return SCREE_OK;
    scree_plan_options options = options_of(f);
    scree_plan design;
    scree_plan_make(&f->task, f->design, &options, &design);
    if (design.state) {
        printf("curves: no plan for the design speed of %g cycles/min: %s\n", f->design, design.text);
        p->failed++;
        return SCREE_OK;
    }
    p->errors = calloc((size_t)f->curves, sizeof *p->errors);
    if (!p->errors)
        return scree_report(&p->output.trouble, SCREE_NO_MEMORY, NULL, "no memory for %d speeds", f->curves);
    int done = 0;
#pragma omp parallel for schedule(dynamic) num_threads(p->threads)
    for (int k = 0; k < f->curves; k++) {
        errors_at(p, &design, curve_speed(f, k), p->errors[k]);
        show_progress("curves", &done, f->curves);
    }
    return SCREE_OK;
}

static scree_status write_curves(struct planning *p) {
    const struct transport_file *f = &p->file;
    if (!p->errors) return SCREE_OK;
    FILE *file =
        figures_begin(&p->output, "curves", "cycles_1_min,conventional_m,scaled_m,planned_m,map_m", &p->tables);
    if (!file) return p->output.trouble.status;
    for (int k = 0; k < f->curves; k++) {
        fprintf(file, "%.17g", curve_speed(f, k));
        for (int m = 0; m < MOTIONS; m++) put(file, p->errors[k][m]);
        fprintf(file, "\n");
    }
    return figures_end(&p->output, &p->tables);
}

/* ---- limits in words ---- */

/* Whether a drive without limits could run a rigid plan. */
static int works(const scree_transport *task, double cycles, scree_plan *plan) {
    scree_transport free = *task;
    free.largest_acceleration = free.largest_jerk = 0.0;
    scree_plan_make(&free, cycles, NULL, plan);
    return plan->state == SCREE_PLAN_GOOD;
}

/* The lowest speed with a rigid plan: n_low, unless something else than the end of the stroke asks for more. The speeds
 * with a plan are one interval, for every condition is linear in T^2 at each instant. HUGE_VAL, and `plan` says why, if
 * none is found. */
static double lowest_speed(const scree_transport *task, scree_plan *plan) {
    double low = scree_limit_low(task), bad = low, good = low * (1.0 + 1e-9);
    if (works(task, good, plan)) return low;
    for (int k = 0; k < 1000 && plan->state; k++) {
        bad = good;
        good *= 1.01;
        works(task, good, plan);
    }
    if (plan->state) return HUGE_VAL;
    for (int k = 0; k < 60; k++) {
        double middle = 0.5 * (bad + good);
        if (works(task, middle, plan))
            good = middle;
        else
            bad = middle;
    }
    return good;
}

/* The highest speed above `low` with a rigid plan, and in `plan` what is wrong beyond it; HUGE_VAL if 100 times as fast
 * is no problem. */
static double highest_speed(const scree_transport *task, double low, scree_plan *plan) {
    double good = low * (1.0 + 1e-9), bad = 100.0 * low;
    if (works(task, bad, plan)) return HUGE_VAL;
    for (int k = 0; k < 60; k++) {
        double middle = 0.5 * (good + bad);
        if (works(task, middle, plan))
            good = middle;
        else
            bad = middle;
    }
    works(task, bad, plan);
    return good;
}

/* What a rigid plan needs, most times on a grid don't give, and costs next to nothing: velocities forwards, and a comb
 * that brakes hard enough after the catch (0.6 mu g; a little less, that rounding doesn't decide here). */
static int may_work(const scree_transport *task, double cycles) {
    double v[3], last = (1.0 - task->fractions[2]) * scree_transport_time(task, cycles);
    return !scree_plan_rigid(task, cycles, v) && v[1] >= 0.0 && v[2] >= 0.59 * scree_transport_slowing(task) * last;
}

/* Whether a rigid plan works at `cycles` with some times on a grid, which `task` then has: those with which one works
 * up to `low`, too, if there are any. */
static int find_times(scree_transport *task, double cycles, double low) {
    enum { GRID = 40 };
    double first[3] = {0.0};
    scree_plan plan;
    for (int i = 1; i < GRID; i++)
        for (int j = i + 1; j < GRID; j++)
            for (int k = j + 1; k < GRID; k++) {
                const double times[3] = {(double)i / GRID, (double)j / GRID, (double)k / GRID};
                memcpy(task->fractions, times, sizeof times);
                if (!may_work(task, cycles) || !works(task, cycles, &plan)) continue;
                if (works(task, low, &plan)) return 1; /* and between them */
                if (first[0] == 0.0) memcpy(first, times, sizeof first);
            }
    memcpy(task->fractions, first, sizeof first);
    return first[0] > 0.0;
}

/* The lowest speed from `critical` to `low` at which some times work: in whole cycles a minute, or farther apart if
 * they are many (each takes a grid of 9139 plans). */
static void print_other_times(const scree_transport *task, double critical, double low) {
    enum { MOST_TRIALS = 25 };
    scree_transport other = *task;
    scree_plan plan;
    double step = fmax(1.0, ceil((low - critical) / MOST_TRIALS)), cycles = ceil(critical);
    while (cycles < low && !find_times(&other, cycles, low)) cycles += step;
    if (cycles >= low) {
        printf("  no other times help there\n");
        return;
    }
    double from = lowest_speed(&other, &plan), to = highest_speed(&other, from, &plan);
    printf("  with times = [%g, %g, %g] a rigid product is placed from %.4g ", other.fractions[0], other.fractions[1],
           other.fractions[2], from);
    if (to < HUGE_VAL)
        printf("to %.4g", to);
    else
        printf("on");
    if (cycles > ceil(critical)) printf("; between %.4g and %g no times on a grid of 0.025 do", critical, cycles);
    printf("\n");
}

static void print_band(const struct transport_file *f, double critical, double low) {
    if (low <= critical) {
        printf(
            "hybrid operation: conventional up to %.4g, the new motion from %.4g cycles/min; every speed is covered\n",
            critical, low);
        return;
    }
    printf(
        "hybrid operation: conventional up to %.4g, the new motion from %.4g cycles/min; between them neither places "
        "the product\n",
        critical, low);
    print_other_times(&f->task, critical, low);
}

static void print_new_motion(const struct transport_file *f, double critical) {
    scree_plan plan;
    double low = lowest_speed(&f->task, &plan);
    if (low == HUGE_VAL) {
        printf("the new motion: with these times there is no plan for a rigid product at any speed: %s\n", plan.text);
        return;
    }
    int limited = f->task.largest_acceleration > 0.0 || f->task.largest_jerk > 0.0;
    double drive = limited ? scree_limit_drive(&f->task, low, 100.0 * low) : HUGE_VAL;
    double high = highest_speed(&f->task, low, &plan);
    printf("the new motion (formulation A, rigid product): from n_low = %.4g cycles/min", low);
    if (drive <= low)
        printf(", where the drive's limit is passed already: it can't be run\n");
    else if (high < drive)
        printf(" up to %.4g; beyond, %s\n", high, plan.text);
    else if (drive < HUGE_VAL)
        printf(" up to the drive's limit at %.4g\n", drive);
    else if (limited)
        printf("; the drive isn't the limit up to %.4g\n", 100.0 * low);
    else
        printf("; no limits of the drive are given\n");
    if (drive > low) print_band(f, critical, low);
}

static void print_limits(const struct planning *p) {
    const struct transport_file *f = &p->file;
    struct scree_conventional conventional = conventional_of(&f->task);
    double critical = scree_conventional_critical(&conventional, f->tolerance);
    printf("conventional motion: the product stays at the tines up to n_0 = %.4g cycles/min, slides on by %g mm at "
           "n_crit = %.4g\n",
           scree_conventional_limit(&conventional), 1e3 * f->tolerance, critical);
    if (f->curves) {
        scree_plan design;
        scree_plan_make(&f->task, f->design, NULL, &design);
        double least, most;
        if (!design.state) {
            scree_limit_range(&f->task, &design, f->process.tine_restitution, f->tolerance, &least, &most);
            printf("a profile for %g cycles/min, scaled (formulation A, rigid product, restitution %g): within %g mm "
                   "from n_min = "
                   "%.4g to "
                   "n_max = %.4g; no detachment below n_det = %.4g\n",
                   f->design, f->process.tine_restitution, 1e3 * f->tolerance, least, most,
                   scree_limit_detachment(&f->task, &design));
        }
    }
    print_new_motion(f, critical);
}

/* ---- the whole ---- */

/* A file of this program in the folder that the plan just made hasn't got: of an earlier one, and not to be taken for
 * this. */
static int is_stale(const struct planning *p, const char *name) {
    static const char *const map[] = {"map.csv", "map_surface.csv", "map.gp", "map.svg", NULL};
    static const char *const curves[] = {"curves.csv", "curves.gp", "curves.svg", NULL};
    for (int k = 0; map[k]; k++)
        if (strcmp(name, map[k]) == 0) return p->map.count == 0;
    for (int k = 0; curves[k]; k++)
        if (strcmp(name, curves[k]) == 0) return !p->errors;
    if (strncmp(name, "servo_", 6) != 0) return 0;
    double cycles = strtod(name + 6, NULL);
    char own[64 + sizeof ".csv"];
    servo_name(cycles, own);
    if (strcmp(strcat(own, ".csv"), name) != 0) return 0; /* not named by this program */
    struct scree_profile profile;
    for (int k = 0; k < p->file.speeds; k++)
        if (p->file.speed[k] == cycles && has_servo(p, k, &profile)) return 0;
    return 1;
}

static void remove_stale(const struct planning *p) {
    DIR *folder = opendir(p->output.folder);
    int removed = 0;
    for (struct dirent *entry; folder && (entry = readdir(folder));) {
        char *path = is_stale(p, entry->d_name) ? scree_join(p->output.folder, entry->d_name) : NULL;
        removed += path && remove(path) == 0;
        free(path);
    }
    if (folder) closedir(folder);
    if (removed) printf("removed from %s: %d files of an earlier plan\n", p->output.folder, removed);
}

static scree_status write_all(struct planning *p) {
    scree_status status = write_plans(p);
    if (!status) status = write_servos(p);
    if (!status) status = write_map(p);
    if (!status) status = write_curves(p);
    status = figures_keep(&p->output, &p->tables, status);
    if (status) return status;
    remove_stale(p);
    if (p->map.count) status = figures_plot(&p->output, "map", script_map);
    char script[sizeof script_curves + sizeof script_mapped];
    snprintf(script, sizeof script, "%s%s\n", script_curves, p->map.count ? script_mapped : "");
    if (!status && p->errors) status = figures_plot(&p->output, "curves", script);
    return status;
}

/* Without a plan for any speed there is nothing that could take the place of earlier results. */
static scree_status check_plans(struct planning *p) {
    for (int k = 0; k < p->file.speeds; k++)
        if (!p->speeds[k].plan.state) return SCREE_OK;
    return scree_report(&p->output.trouble, SCREE_FAILED, NULL, "no speed has a plan: nothing is written");
}

static scree_status compute(struct planning *p) {
    const struct transport_file *f = &p->file;
    if (f->title[0]) printf("%s\n", scree_shown(f->title).text);
    scree_status status = f->optimised ? choose_shares(p) : SCREE_OK;
    if (status) return status;
    make_plans(p);
    print_limits(p);
    status = check_plans(p);
    if (status) return status;
    make_map(p);
    return make_curves(p);
}

static scree_status work(struct planning *p) {
    enum { MOST_KNOTS = 256, OTHER_TABLES = 4 };
    static scree_map_knot knots[MOST_KNOTS];
    struct transport_file *f = &p->file;
    p->map = (scree_map){.weight = f->weight, .capacity = MOST_KNOTS, .knots = knots};
    p->speeds = calloc((size_t)f->speeds, sizeof *p->speeds);
    p->tables.out = calloc((size_t)f->speeds + OTHER_TABLES, sizeof *p->tables.out);
    if (!p->speeds || !p->tables.out)
        return scree_report(&p->output.trouble, SCREE_NO_MEMORY, NULL, "no memory for %d speeds", f->speeds);
    int there = access(p->output.folder, F_OK) == 0;
    scree_status status = scree_make_folder(p->output.folder, &p->output.trouble);
    if (status) return status;
    status = compute(p);
    if (!status) status = write_all(p);
    if (status && !there) rmdir(p->output.folder); /* only if nothing is in it */
    if (!status) printf("written to %s\n", p->output.folder);
    return status;
}

int cli_plan(int count, char **words) {
    const char *folder = NULL, *threads = NULL, *assignments[256];
    int assignment_count = 0;
    const struct cli_option options[] = {
        {.name = "-o", .value = &folder},
        {.name = "--threads", .value = &threads},
        {.name = "--set", .list = assignments, .list_count = &assignment_count, .list_capacity = 256},
        {0}};
    int code = cli_parse(&count, words, options, help);
    if (code) return code < 0 ? EXIT_GOOD : code;
    if (count != 1) return cli_complain("plan takes one transport file (see scree plan --help)");
    struct planning p = {.threads = cli_threads(threads)};
    if (!p.threads) return EXIT_USAGE;
    char *named = folder ? NULL : cli_default_folder(words[0], "plan", "");
    p.output = (struct figures){.folder = folder ? folder : named, .plots = 1, .threads = p.threads};
    scree_status status = transport_file_read(words[0], assignments, assignment_count, &p.file, &p.output.trouble);
    if (!status && !p.output.folder)
        status = scree_report(&p.output.trouble, SCREE_NO_MEMORY, NULL, "no memory for a file name");
    struct scree_c_locale locale = scree_enter_c_locale();
    if (!status) status = work(&p);
    scree_leave_c_locale(locale);
    free(p.speeds);
    free(p.tables.out);
    free(p.errors);
    if (status) cli_complain("%s", p.output.trouble.text);
    transport_file_free(&p.file);
    free(named);
    return status ? cli_exit_code(status) : p.failed || figures_unplotted(&p.output) ? EXIT_MISSED : EXIT_GOOD;
}
