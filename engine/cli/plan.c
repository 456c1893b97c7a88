/* scree plan: motion profiles for one operating speed or many, the characteristic map, what happens over the speed, servo tables. */
#include "engine/c_locale.h"
#include "engine/cli/cli.h"
#include "engine/cli/figures.h"
#include "engine/cli/transport_file.h"
#include "solver/conventional.h"
#include "solver/table.h"

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
    "  servo_N.csv    the profile at N cycles a minute for a motion controller\n"
    "  map.csv        the characteristic map's knots, and map.svg\n"
    "  curves.csv     position error over the operating speed: conventional, scaled, planned, from the map; and "
    "curves.svg\n"
    "The limits of both motions, and what lies between them, are printed. Exit status 1 if a speed has no plan.\n"
    "\n"
    "  -o DIR           where to write\n"
    "  --set KEY=VALUE  change the file: plan.speeds=[500], transport.friction=0.28\n"
    "  --threads N      speeds at the same time (default: the number of processors)\n"
    "\n"
    "example: scree plan data/transport/bars.toml -o /tmp/bars\n";

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
    int threads, failed;
};

static scree_plan_options options_of(const struct transport_file *f) {
    scree_plan_options options = {.formulation = f->formulation, .clearance = f->clearance};
    options.process = f->modelled ? process_catch : NULL;
    options.context = (void *)(uintptr_t)&f->process; /* only read */
    return options;
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
    if (!f->modelled) {
        scree_rigid_sensitivities(&f->task, &s->plan, s->by);
        return;
    }
    const struct process *m = &f->process;
    struct probe probe = {f, &s->plan};
    /* Central about the working point; the lead can only grow from 0, so it is taken about one step. */
    double lead = 1e-4, at[SCREE_CONDITIONS] = {m->kinetic_friction, scree_transport_play(&f->task), m->start + lead,
                                                m->tine_stiffness, m->tine_restitution};
    double steps[SCREE_CONDITIONS] = {1e-3, 1e-5, 0.5 * lead, 0.01 * m->tine_stiffness, 0.01};
    at[SCREE_BY_START] = m->start;
    double start_step = steps[SCREE_BY_START];
    steps[SCREE_BY_START] = 0.0;
    if (scree_sensitivities(probe_clearance, &probe, at, steps, s->by)) return;
    scree_outcome by_start[SCREE_CONDITIONS];
    at[SCREE_BY_START] = m->start + lead;
    memset(steps, 0, sizeof steps);
    steps[SCREE_BY_START] = start_step;
    if (!scree_sensitivities(probe_clearance, &probe, at, steps, by_start))
        s->by[SCREE_BY_START] = by_start[SCREE_BY_START];
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
    struct scree_out out = {0};
    scree_status status = figures_table(
        &p->output, "plan",
        "cycles_1_min,state,transport_time_s,t1_s,t2_s,t3_s,v1_m_s,v2_m_s,v3_m_s,a1_m_s2,a2_m_s2,a3_m_s2,detachment_s,"
        "largest_acceleration_m_s2,largest_jerk_m_s3,simulations,clearance_m,approach_m_s,catch_N,final_error_m,"
        "by_friction_m,by_play,by_start,by_stiffness_m2_N,by_restitution_m",
        &out);
    for (int k = 0; !status && k < p->file.speeds; k++) {
        const struct speed *s = &p->speeds[k];
        const scree_plan *plan = &s->plan;
        fprintf(out.file, "%.17g,%s", p->file.speed[k], scree_plan_state_name(plan->state));
        if (plan->state) {
            fprintf(out.file, ",,,,,,,,,,,,,,,,,,,,,,,\n");
            continue;
        }
        fprintf(out.file, ",%.17g,%.17g,%.17g,%.17g", plan->duration, plan->time[1], plan->time[2], plan->time[3]);
        for (int e = 1; e <= 3; e++) fprintf(out.file, ",%.17g", plan->event[e].v);
        for (int e = 1; e <= 3; e++) fprintf(out.file, ",%.17g", plan->event[e].a);
        fprintf(out.file, ",%.17g,%.17g,%.17g,%d,%.17g", plan->detached, scree_extrema_acceleration(&plan->extrema),
                scree_extrema_jerk(&plan->extrema), plan->simulations, s->clearance);
        if (s->ran)
            fprintf(out.file, ",%.17g,%.17g,%.17g", s->run.approach, s->run.catch_force, s->run.error);
        else
            fprintf(out.file, ",,,");
        for (int c = 0; c < SCREE_CONDITIONS; c++) fprintf(out.file, ",%.17g", s->by[c].clearance);
        fprintf(out.file, "\n");
    }
    return status ? status : scree_out_keep(&out, &p->output.trouble);
}

static void print_plans(const struct planning *p) {
    printf("%10s %10s %10s %10s %12s %12s %12s  %s\n", "speed", "v1", "v2", "v3", "clearance", "approach", "catch",
           "final error");
    for (int k = 0; k < p->file.speeds; k++) {
        const struct speed *s = &p->speeds[k];
        if (s->plan.state) {
            printf("%10g no plan: %s\n", p->file.speed[k], s->plan.text);
            continue;
        }
        printf("%10g %10.5f %10.5f %10.5f %10.3g m", p->file.speed[k], s->plan.event[1].v, s->plan.event[2].v,
               s->plan.event[3].v, s->clearance);
        if (s->ran)
            printf(" %8.3g m/s %10.3g N  %+.3g mm", s->run.approach, s->run.catch_force, 1e3 * s->run.error);
        else if (p->file.modelled)
            printf("  the simulation stopped: %s", s->run.trouble.text);
        printf("\n");
    }
}

static scree_status make_plans(struct planning *p) {
    const struct transport_file *f = &p->file;
#pragma omp parallel for schedule(dynamic) num_threads(p->threads)
    for (int k = 0; k < f->speeds; k++) plan_speed(f, f->speed[k], &p->speeds[k]);
    for (int k = 0; k < f->speeds; k++) p->failed += p->speeds[k].plan.state || (f->modelled && !p->speeds[k].ran);
    print_plans(p);
    return write_plans(p);
}

/* ---- servo tables ---- */

static scree_status write_servo(struct planning *p, const scree_plan *plan) {
    const struct transport_file *f = &p->file;
    char name[64];
    snprintf(name, sizeof name, "servo_%g", plan->cycles);
    scree_table_options options = {.rate = f->rate, .cycles = f->angle ? plan->cycles : 0.0};
    scree_cycle cycle;
    scree_cycle_def def = {.cycles = plan->cycles, .lift = f->lift};
    if (f->lift != 0.0 && scree_cycle_make(&def, &plan->profile, &cycle))
        return scree_report(&p->output.trouble, SCREE_BAD_INPUT, NULL, "no return stroke at %g cycles/min: %s",
                            plan->cycles, cycle.text);
    struct scree_out out = {0};
    scree_status status = figures_open(&p->output, name, &out);
    if (status) return status;
    int failed = f->lift != 0.0 ? scree_table_write_cycle(out.file, &cycle, &options)
                                : scree_table_write(out.file, &plan->profile, &options);
    if (!failed) return scree_out_keep(&out, &p->output.trouble);
    scree_out_drop(&out, 0);
    return scree_report(&p->output.trouble, SCREE_BAD_INPUT, NULL, "no servo table at %g rows a second", f->rate);
}

static scree_status write_servos(struct planning *p) {
    scree_status status = SCREE_OK;
    for (int k = 0; k < p->file.speeds && p->file.rate > 0.0 && !status; k++)
        if (!p->speeds[k].plan.state) status = write_servo(p, &p->speeds[k].plan);
    return status;
}

/* ---- characteristic map ---- */

static double map_error(void *file, const struct scree_profile *profile, double cycles) {
    const struct transport_file *f = file;
    if (!f->modelled) return scree_map_clearance((void *)(uintptr_t)&f->task, profile, cycles);
    scree_catch caught;
    double until = f->task.fractions[2] * scree_transport_time(&f->task, cycles);
    return process_catch((void *)(uintptr_t)&f->process, profile, until, &caught) ? HUGE_VAL : caught.clearance;
}

static const char script_map[] =
    "set title 'Characteristic map: velocity of the comb'\n"
    "set xlabel 'time over transport time'\nset ylabel 'operating speed (1/min)'\nset zlabel 'velocity (m/s)' rotate\n"
    "unset key\nset hidden3d\nset view 55,325\nset ticslevel 0\n"
    "splot 'map_surface.csv' using 2:1:3 with lines ls 3\n";

static scree_status write_map(struct planning *p) {
    enum { ROWS = 41, COLUMNS = 51 };
    const scree_map *map = &p->map;
    struct scree_out out = {0};
    scree_status status =
        figures_table(&p->output, "map", "cycles_1_min,f1,f2,f3,v1_T_m,v2_T_m,v3_T_m,a1_T2_m,a2_T2_m,a3_T2_m", &out);
    for (int k = 0; !status && k < map->count; k++) {
        const scree_map_knot *knot = &map->knots[k];
        const double *sets[3] = {knot->fractions, knot->v, knot->a};
        fprintf(out.file, "%.17g", knot->cycles);
        for (int s = 0; s < 9; s++) fprintf(out.file, ",%.17g", sets[s / 3][s % 3]);
        fprintf(out.file, "\n");
    }
    if (!status) status = scree_out_keep(&out, &p->output.trouble);
    if (!status) status = figures_table(&p->output, "map_surface", "cycles_1_min,share_of_time,v_m_s", &out);
    for (int row = 0; !status && row < ROWS; row++) {
        double cycles = p->file.map.low + (p->file.map.high - p->file.map.low) * row / (ROWS - 1);
        struct scree_profile profile;
        if (scree_map_profile(map, cycles, &profile)) continue;
        for (int k = 0; k < COLUMNS; k++) {
            double u = k / (COLUMNS - 1.0), time = u * scree_profile_duration(&profile);
            fprintf(out.file, "%.17g,%.17g,%.17g\n", cycles, u, scree_profile_at(&profile, time).v);
        }
        fprintf(out.file, "\n");
    }
    if (!status) status = scree_out_keep(&out, &p->output.trouble);
    return status ? status : figures_plot(&p->output, "map", script_map);
}

static scree_status make_map(struct planning *p) {
    struct transport_file *f = &p->file;
    if (!f->mapped) return SCREE_OK;
    f->map.error = map_error;
    f->map.context = f;
    scree_plan_options options = options_of(f);
    options.clearance = fmin(f->clearance, 0.1 * f->map.bound);
    p->report = scree_map_place(&p->map, &f->task, &options, &f->map);
    const scree_map_report *report = &p->report;
    if (report->state == SCREE_MAP_BAD_PLAN) {
        printf("map: no plan at %g cycles/min: %s\n", report->plan.cycles, report->plan.text);
        p->failed++;
        return SCREE_OK;
    }
    printf("map: %d knots from %g to %g cycles/min, weights linear in %s: clearance within %.3g m everywhere (worst at "
           "%g)%s%s\n",
           p->map.count, f->map.low, f->map.high, scree_map_names[p->map.weight], report->error, report->at,
           report->state ? "; the bound is missed: " : "", report->state ? scree_map_text(report->state) : "");
    p->failed += report->state != SCREE_MAP_GOOD;
    return write_map(p);
}

/* ---- over the operating speed ---- */

enum { CONVENTIONAL, SCALED, FRESH, MAPPED, MOTIONS };

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

static const char script_curves[] =
    "set title 'Positioning error over the operating speed'\n"
    "set xlabel 'operating speed (1/min)'\nset ylabel 'positioning error (mm)'\nset key outside below maxrows 2\n"
    "set yrange [-5:5]\n"
    "plot 'curves.csv' using 1:($2*1e3) with lines ls 1 title 'conventional',\\\n"
    "     '' using 1:($3*1e3) with linespoints ls 2 title 'new, scaled',\\\n"
    "     '' using 1:($4*1e3) with linespoints ls 3 title 'new, planned',\\\n"
    "     '' using 1:($5*1e3) with points ls 4 title 'new, from the map'\n";

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
    double(*errors)[MOTIONS] = calloc((size_t)f->curves, sizeof *errors);
    if (!errors) return scree_report(&p->output.trouble, SCREE_NO_MEMORY, NULL, "no memory for %d speeds", f->curves);
#pragma omp parallel for schedule(dynamic) num_threads(p->threads)
    for (int k = 0; k < f->curves; k++)
        errors_at(p, &design, f->from + (f->to - f->from) * k / (f->curves - 1), errors[k]);
    struct scree_out out = {0};
    scree_status status =
        figures_table(&p->output, "curves", "cycles_1_min,conventional_m,scaled_m,planned_m,map_m", &out);
    for (int k = 0; !status && k < f->curves; k++) {
        fprintf(out.file, "%.17g", f->from + (f->to - f->from) * k / (f->curves - 1));
        for (int m = 0; m < MOTIONS; m++) fprintf(out.file, isfinite(errors[k][m]) ? ",%.17g" : ",", errors[k][m]);
        fprintf(out.file, "\n");
    }
    free(errors);
    if (!status) status = scree_out_keep(&out, &p->output.trouble);
    return status ? status : figures_plot(&p->output, "curves", script_curves);
}

/* ---- limits in words ---- */

/* Whether a rigid plan works at `cycles` with some times on a grid, which `task` then has. */
static int find_times(scree_transport *task, double cycles) {
    enum { GRID = 40 };
    for (int i = 1; i < GRID; i++)
        for (int j = i + 1; j < GRID; j++)
            for (int k = j + 1; k < GRID; k++) {
                const double times[3] = {(double)i / GRID, (double)j / GRID, (double)k / GRID};
                memcpy(task->fractions, times, sizeof times);
                scree_plan plan;
                scree_plan_make(task, cycles, NULL, &plan);
                if (plan.state == SCREE_PLAN_GOOD) return 1;
            }
    return 0;
}

/* The lowest speed from `critical` on, in whole cycles a minute, at which some times work. */
static void print_other_times(const scree_transport *task, double critical, double low) {
    scree_transport other = *task;
    double cycles = ceil(critical);
    while (cycles < low && !find_times(&other, cycles)) cycles += 1.0;
    if (cycles >= low) {
        printf("  no other times help there\n");
        return;
    }
    printf("  with times = [%g, %g, %g] the new motion works from %g on", other.fractions[0], other.fractions[1],
           other.fractions[2], cycles);
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

static void print_limits(const struct planning *p) {
    const struct transport_file *f = &p->file;
    struct scree_conventional conventional = conventional_of(&f->task);
    double critical = scree_conventional_critical(&conventional, f->tolerance), low = scree_limit_low(&f->task);
    printf("conventional motion: the product stays at the tines up to n_0 = %.4g cycles/min, slides on by %g mm at "
           "n_crit = %.4g\n",
           scree_conventional_limit(&conventional), 1e3 * f->tolerance, critical);
    if (f->curves) {
        scree_plan design;
        scree_plan_make(&f->task, f->design, NULL, &design);
        double least, most;
        if (!design.state) {
            scree_limit_range(&f->task, &design, f->process.tine_restitution, f->tolerance, &least, &most);
            printf("a profile for %g cycles/min, scaled (rigid product, restitution %g): within %g mm from n_min = "
                   "%.4g to "
                   "n_max = %.4g; no detachment below n_det = %.4g\n",
                   f->design, f->process.tine_restitution, 1e3 * f->tolerance, least, most,
                   scree_limit_detachment(&f->task, &design));
        }
    }
    double drive = scree_limit_drive(&f->task, low, 100.0 * low);
    printf("the new motion: from n_low = %.4g cycles/min", low);
    if (f->task.largest_acceleration > 0.0 || f->task.largest_jerk > 0.0) {
        if (drive < HUGE_VAL)
            printf(" up to the drive's limit at %.4g\n", drive);
        else
            printf("; the drive isn't the limit up to %.4g\n", 100.0 * low);
    } else
        printf("; no limits of the drive are given\n");
    print_band(f, critical, low);
}

/* ---- the whole ---- */

/* "transport/bars.toml" -> "bars"; to be freed. */
static char *default_folder(const char *path) {
    const char *slash = strrchr(path, '/');
    char *folder = strdup(strcmp(path, "-") == 0 ? "plan" : slash ? slash + 1 : path);
    char *dot = folder ? strrchr(folder, '.') : NULL;
    if (dot && dot > folder) *dot = '\0';
    return folder;
}

static scree_status work(struct planning *p) {
    enum { MOST_KNOTS = 256 };
    static scree_map_knot knots[MOST_KNOTS];
    struct transport_file *f = &p->file;
    p->map = (scree_map){.weight = f->weight, .capacity = MOST_KNOTS, .knots = knots};
    p->speeds = calloc((size_t)f->speeds, sizeof *p->speeds);
    if (!p->speeds)
        return scree_report(&p->output.trouble, SCREE_NO_MEMORY, NULL, "no memory for %d speeds", f->speeds);
    struct scree_c_locale locale = scree_enter_c_locale();
    scree_status status = scree_make_folder(p->output.folder, &p->output.trouble);
    if (!status && f->title[0]) printf("%s\n", f->title);
    if (!status && f->optimised) status = choose_shares(p);
    if (!status) status = make_plans(p);
    if (!status) status = write_servos(p);
    if (!status) print_limits(p);
    if (!status) status = make_map(p);
    if (!status) status = make_curves(p);
    if (!status) printf("written to %s\n", p->output.folder);
    scree_leave_c_locale(locale);
    free(p->speeds);
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
    long processors = sysconf(_SC_NPROCESSORS_ONLN);
    struct planning p = {.threads = processors > 0 ? (int)processors : 1};
    if (threads) p.threads = cli_whole_number(threads, "--threads", 1024);
    if (!p.threads) return EXIT_USAGE;
    char *named = folder ? NULL : default_folder(words[0]);
    p.output = (struct figures){.folder = folder ? folder : named, .plots = 1, .threads = p.threads};
    scree_status status = transport_file_read(words[0], assignments, assignment_count, &p.file, &p.output.trouble);
    if (!status) status = work(&p);
    if (status) cli_complain("%s", p.output.trouble.text);
    transport_file_free(&p.file);
    free(named);
    return status ? cli_exit_code(status) : p.failed ? EXIT_MISSED : EXIT_GOOD;
}
