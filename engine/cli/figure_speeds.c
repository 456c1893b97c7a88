/* Figures 6b and 16 and the tines' forces: what happens over the operating speed. */
#include "engine/cli/figures.h"
#include "solver/conventional.h"
#include "solver/map.h"

#include <math.h>

/* One motion at one speed, simulated with all tines. */
struct trial {
    const struct process *process;
    double cycles;
    struct scree_profile profile;
    double restitution; /* of the tines */
    struct process_run run;
};

static scree_status run_trial(const struct figures *figures, void *trials, int k, scree_trouble *trouble) {
    (void)figures;
    struct trial *trial = (struct trial *)trials + k;
    struct process with = *trial->process;
    with.tine_restitution = trial->restitution;
    scree_status status = process_simulate(&with, &trial->profile, figures_task.distance, &trial->run);
    if (status) *trouble = trial->run.trouble;
    return status;
}

static scree_status no_plan(struct figures *figures, const scree_plan *plan) {
    return scree_report(&figures->trouble, SCREE_FAILED, NULL, "no plan for %g cycles/min: %s", plan->cycles,
                        plan->text);
}

/* ---- figure 6b ---- */

enum { SPEEDS_6B = 57, MOST_TRIALS = 2 * SPEEDS_6B };
static const double design_speed = 500.0, tolerance = 1e-3, restitutions[2] = {0.5, 0.3};

static const char script_6b[] =
    "set title 'A profile planned for 500 cycles/min, scaled in time'\n"
    "set xlabel 'operating speed (1/min)'\nset ylabel 'positioning error (mm)'\nset bmargin 7\nset key outside below "
    "maxrows 2\n"
    "set xrange [0:800]\nset yrange [-21:6]\n"
    "# No detachment below n_det; within 1 mm from n_min to n_max (e = 0.5), around the speed of the design.\n"
    "set object rectangle from 297.5, -1 to 544.4, 1 behind fillcolor rgb '#dddddd' fillstyle solid noborder\n"
    "do for [n in '65.6 297.5 500 544.4'] { set arrow from n, graph 0 to n, graph 1 nohead lc rgb '#888888' dt 3 }\n"
    "set label 'n_{det}' at 72, 3\nset label 'n_{min}' at 304, 3\nset label 'n_{design}' at 493, 3 right\n"
    "set label 'n_{max}' at 551, 3\n"
    "plot 'fig_6b.csv' using 1:($2*1e3) with lines ls 1 title 'rigid, e = 0.5',\\\n"
    "     '' using 1:($3*1e3) with points ls 2 title 'simulated, e = 0.5',\\\n"
    "     '' using 1:($4*1e3) with lines ls 3 title 'rigid, e = 0.3',\\\n"
    "     '' using 1:($5*1e3) with points ls 4 title 'simulated, e = 0.3',\\\n"
    "     '' using 1:($6 < 0.006 ? $6*1e3 : 1/0) with lines ls 5 title 'conventional motion'\n";

static const struct scree_conventional conventional = {.stroke = 0.08, .share = 0.5, .friction = 0.3, .gravity = 9.81};

static struct scree_profile scaled_to(const scree_plan *design, double cycles) {
    return scree_profile_scaled(&design->profile, scree_transport_time(&figures_task, cycles));
}

static scree_status write_6b(struct figures *figures, const scree_plan *design, const struct trial *trials) {
    struct scree_out out;
    scree_status status = figures_table(
        figures, "fig_6b", "cycles_1_min,rigid_e05_m,simulated_e05_m,rigid_e03_m,simulated_e03_m,conventional_m", &out);
    for (int k = 0; !status && k < SPEEDS_6B; k++) {
        double cycles = trials[2 * k].cycles;
        struct scree_profile profile = scaled_to(design, cycles);
        fprintf(out.file, "%.17g", cycles);
        for (int e = 0; e < 2; e++)
            fprintf(out.file, ",%.17g,%.17g", scree_slide_simulate(&figures_task, &profile, restitutions[e]).error,
                    trials[2 * k + e].run.error);
        fprintf(out.file, ",%.17g\n", scree_conventional_error(&conventional, cycles));
    }
    return status ? status : scree_out_keep(&out, &figures->trouble);
}

/* The limit between a speed where the scaled profile places the product well enough and one where it doesn't, by
 * simulation. */
static scree_status bisect(struct figures *figures, const struct process *process, const scree_plan *design,
                           double good, double bad, double *limit) {
    for (int k = 0; k < 12; k++) {
        struct trial trial = {.process = process, .cycles = 0.5 * (good + bad), .restitution = 0.5};
        trial.profile = scaled_to(design, trial.cycles);
        scree_status status = run_trial(figures, &trial, 0, &figures->trouble);
        if (status) return status;
        if (fabs(trial.run.error) <= tolerance)
            good = trial.cycles;
        else
            bad = trial.cycles;
    }
    *limit = good;
    return SCREE_OK;
}

static scree_status report_6b(struct figures *figures, const struct process *process, const scree_plan *design) {
    double least, most, simulated[2] = {0.0, 0.0};
    scree_limit_range(&figures_task, design, 0.5, tolerance, &least, &most);
    struct process stiff = *process;
    stiff.tine_stiffness = 1e7;
    stiff.step = 3e-6;
    scree_status status = bisect(figures, &stiff, design, least + 10.0, least - 10.0, &simulated[0]);
    if (!status) status = bisect(figures, &stiff, design, most - 10.0, most + 10.0, &simulated[1]);
    if (status) return status;
    figures_report(figures, "6b", "n_det, a scaled profile (1/min)", 65.6,
                   scree_limit_detachment(&figures_task, design), 1e-3);
    figures_report(figures, "6b", "n_low, a fresh plan: 60 r sqrt(0.3 mu g/s) (1/min)",
                   30.0 * sqrt(0.3 * 0.3 * 9.81 / 0.08), scree_limit_low(&figures_task), 1e-9);
    /* Each bounce lasts pi sqrt(m/k), 0.17 ms of some 50 ms between bounces; 0.1/min is the width of the bisection. */
    figures_report(figures, "6b", "n_min for 1 mm, e = 0.5, tines of 1e7 N/m (1/min)", least, simulated[0], 5e-3);
    figures_report(figures, "6b", "n_max for 1 mm, e = 0.5, tines of 1e7 N/m (1/min)", most, simulated[1], 5e-3);
    static const double others[2] = {300.0, 700.0};
    for (int k = 0; k < 2; k++) {
        struct scree_profile profile = scaled_to(design, others[k]);
        double expected = scree_scaled_clearance(&figures_task, design, others[k]);
        scree_catch caught = {0};
        if (process_catch((void *)(uintptr_t)process, &profile, 0.75 * scree_profile_duration(&profile), &caught))
            return scree_report(&figures->trouble, SCREE_FAILED, NULL, "the process model failed at %g/min", others[k]);
        char quantity[80];
        snprintf(quantity, sizeof quantity, "clearance less the rigid %+.3f mm, scaled to %g/min (m)", 1e3 * expected,
                 others[k]);
        /* The tines' spring unloads at m j/k while the product leaves, which is its excess of velocity over the
         * slide. */
        double ratio = others[k] / design_speed, jerk = scree_extrema_jerk(&design->extrema) * ratio * ratio * ratio;
        double late = 0.5 * scree_profile_duration(&profile) * process->mass * jerk / process->tine_stiffness;
        figures_report(figures, "6b", quantity, 0.0, caught.clearance - expected, late);
    }
    return SCREE_OK;
}

scree_status figure_6b(struct figures *figures) {
    static struct trial trials[MOST_TRIALS];
    struct process process;
    scree_plan design;
    scree_plan_make(&figures_task, design_speed, NULL, &design);
    if (design.state) return no_plan(figures, &design);
    for (int k = 0; k < MOST_TRIALS; k++) {
        /* Slow runs are long: wider apart below 200/min. */
        int n = k / 2;
        double cycles = n < 9 ? 40.0 + 20.0 * n : 200.0 + 12.5 * (n - 8);
        trials[k] = (struct trial){.process = &process,
                                   .cycles = cycles,
                                   .restitution = restitutions[k % 2],
                                   .profile = scaled_to(&design, cycles)};
    }
    scree_status status = figures_process(figures, &process);
    process.step = 1e-5; /* half the digits of 5e-6, more than the plot shows */
    if (!status) status = figures_do(figures, run_trial, trials, MOST_TRIALS);
    if (!status) status = write_6b(figures, &design, trials);
    if (!status) status = report_6b(figures, &process, &design);
    process_free(&process);
    return status ? status : figures_plot(figures, "fig_6b", script_6b);
}

/* ---- figure 16 ---- */

enum { MOST_KNOTS = 32, SPEEDS_16 = 41, TIMES_16 = 101 };

static double simulated_clearance(void *process, const struct scree_profile *profile, double cycles) {
    scree_catch caught;
    double until = figures_task.fractions[2] * scree_transport_time(&figures_task, cycles);
    return process_catch(process, profile, until, &caught) ? HUGE_VAL : caught.clearance;
}

static const char script_16[] =
    "set title 'Characteristic map: velocity of the comb'\n"
    "set xlabel 'time over transport time'\nset ylabel 'operating speed (1/min)'\nset zlabel 'velocity (m/s)' rotate\n"
    "unset key\nset hidden3d offset 0\nset view 55,325\nset ticslevel 0\nset xtics 0.25\n"
    "splot 'fig_16.csv' using 2:1:3 every 2:2 with lines ls 3, 'fig_16_knots.csv' using 2:1:3 with lines ls 2\n";

static void write_surface(FILE *file, const scree_map *map, double cycles) {
    struct scree_profile profile;
    if (scree_map_profile(map, cycles, &profile)) return;
    for (int k = 0; k < TIMES_16; k++) {
        double u = k / (TIMES_16 - 1.0);
        fprintf(file, "%.17g,%.17g,%.17g\n", cycles, u,
                scree_profile_at(&profile, u * scree_profile_duration(&profile)).v);
    }
    fprintf(file, "\n");
}

static scree_status write_16(struct figures *figures, const scree_map *map) {
    struct scree_out out = {0};
    scree_status status = figures_table(figures, "fig_16", "cycles_1_min,share_of_time,v_m_s", &out);
    for (int n = 0; !status && n < SPEEDS_16; n++) write_surface(out.file, map, 300.0 + 10.0 * n);
    if (!status) status = scree_out_keep(&out, &figures->trouble);
    if (!status) status = figures_table(figures, "fig_16_knots", "cycles_1_min,share_of_time,v_m_s", &out);
    for (int k = 0; !status && k < map->count; k++) write_surface(out.file, map, map->knots[k].cycles);
    return status ? status : scree_out_keep(&out, &figures->trouble);
}

/* At 41 speeds, with all tines: where the product ends, and how fast it is caught, after planning for that very speed
 * and for what the map gives there. */
static scree_status report_16(struct figures *figures, const struct process *process, const scree_map *map,
                              const scree_plan_options *options) {
    static struct trial trials[2 * SPEEDS_16];
    static scree_plan plans[SPEEDS_16];
    double position[2] = {0.0, 0.0}, approach = 0.0;
#pragma omp parallel for schedule(dynamic) num_threads(figures->threads)
    for (int n = 0; n < SPEEDS_16; n++) scree_plan_make(&figures_task, 300.0 + 10.0 * n, options, &plans[n]);
    for (int n = 0; n < SPEEDS_16; n++) {
        struct trial *fresh = &trials[2 * n], *between = &trials[2 * n + 1];
        if (plans[n].state) return no_plan(figures, &plans[n]);
        *fresh = *between = (struct trial){
            .process = process, .cycles = plans[n].cycles, .restitution = 0.5, .profile = plans[n].profile};
        if (scree_map_profile(map, between->cycles, &between->profile))
            return scree_report(&figures->trouble, SCREE_FAILED, NULL, "the map has a hole at %g", between->cycles);
    }
    scree_status status = figures_do(figures, run_trial, trials, 2 * SPEEDS_16);
    if (status) return status;
    for (int n = 0; n < 2 * SPEEDS_16; n++) {
        position[n % 2] = scree_most(position[n % 2], fabs(trials[n].run.error));
        if (n % 2 == 0) approach = scree_most(approach, trials[n].run.approach);
    }
    figures_report(figures, "16", "planned at 41 speeds of 300 to 700/min: final position error (m)", 0.0, position[0],
                   5e-5);
    figures_report(figures, "16", "planned there: approach to the front tines (m/s)", 0.0, approach, 5e-3);
    figures_report(figures, "16", "from the map there: final position error (m)", 0.0, position[1], 5e-5);
    return SCREE_OK;
}

/* A rigid plan between the knots 300 and 700 at 500: what the weights are worth. */
static void report_weights(struct figures *figures) {
    static const double expected[SCREE_MAP_WEIGHTS] = {0.0, -0.254e-3, -0.866e-3};
    for (int weight = 0; weight < SCREE_MAP_WEIGHTS; weight++) {
        scree_map_knot knots[2];
        scree_map map = {.weight = (enum scree_map_weight)weight, .capacity = 2, .knots = knots};
        struct scree_profile profile;
        scree_transport task = figures_task;
        for (int n = 300; n <= 700; n += 400) {
            scree_plan plan;
            scree_plan_make(&task, n, NULL, &plan);
            scree_map_add(&map, &plan);
        }
        scree_map_profile(&map, 500.0, &profile);
        double clearance = scree_map_clearance(&task, &profile, 500.0);
        char quantity[96];
        snprintf(quantity, sizeof quantity, "clearance less %+.3f mm at 500 from knots 300 and 700, %s (m)",
                 1e3 * expected[weight], scree_map_names[weight]);
        /* Three decimals in mm are known; 1/n^2 is exact but for rounding of 20 mm. */
        figures_report(figures, "16", quantity, 0.0, clearance - expected[weight],
                       weight == SCREE_MAP_INVERSE_SQUARE ? 1e-15 : 5e-7);
    }
}

scree_status figure_16(struct figures *figures) {
    report_weights(figures);
    struct process process;
    scree_map_knot knots[MOST_KNOTS];
    scree_status status = figures_process(figures, &process);
    scree_map_options options = {
        .low = 300.0, .high = 700.0, .bound = 1e-5, .error = simulated_clearance, .context = &process};
    scree_plan_options plan = {
        .formulation = SCREE_PLAN_C, .process = process_catch, .context = &process, .clearance = 1e-7};
    for (int weight = SCREE_MAP_WEIGHTS - 1; weight >= 0 && !status; weight--) {
        scree_map map = {.weight = (enum scree_map_weight)weight, .capacity = MOST_KNOTS, .knots = knots};
        scree_map_report report = scree_map_place(&map, &figures_task, &plan, &options);
        char quantity[96];
        snprintf(quantity, sizeof quantity, "largest clearance between %d knots, linear in %s (m)", map.count,
                 scree_map_names[weight]);
        if (report.state)
            status = scree_report(&figures->trouble, SCREE_FAILED, NULL, "no map: %s", scree_map_text(report.state));
        else
            figures_report(figures, "16", quantity, 0.0, report.error, options.bound);
        if (status || weight != SCREE_MAP_INVERSE_SQUARE) continue;
        status = report_16(figures, &process, &map, &plan);
        if (!status) status = write_16(figures, &map);
    }
    process_free(&process);
    return status ? status : figures_plot(figures, "fig_16", script_16);
}

/* ---- the tines' forces ---- */

enum { SPEEDS_F = 24 };

static const char script_forces[] =
    "set title 'Catch by the front tines: conventional and new motion'\n"
    "set logscale y\nset xlabel 'operating speed (1/min)'\nset ylabel 'largest force (N)'\nset y2label 'impact speed "
    "(m/s)'\n"
    "set y2tics\nset ytics nomirror\nset key top left\n"
    "plot 'fig_forces.csv' using 1:2 with lines ls 1 title 'force, conventional',\\\n"
    "     '' using 1:4 with lines ls 2 title 'force, new',\\\n"
    "     '' using 1:3 axes x1y2 with points ls 3 title 'impact speed, conventional',\\\n"
    "     '' using 1:5 axes x1y2 with points ls 4 title 'impact speed, new'\n";

/* The conventional motion as a profile of one quintic. */
static struct scree_profile conventional_profile(double cycles) {
    struct scree_profile profile = {0};
    struct scree_segment rise =
        scree_position_segment(scree_conventional_duration(&conventional, cycles), (struct scree_kinematics){0},
                               (struct scree_kinematics){.x = conventional.stroke});
    scree_profile_append(&profile, &rise);
    return profile;
}

scree_status figure_forces(struct figures *figures) {
    static struct trial trials[2 * SPEEDS_F];
    struct process process;
    scree_status status = figures_process(figures, &process);
    scree_plan_options plan_options = {
        .formulation = SCREE_PLAN_C, .process = process_catch, .context = &process, .clearance = 1e-7};
    for (int n = 0; !status && n < SPEEDS_F; n++) {
        scree_plan plan;
        double cycles = 125.0 + 25.0 * n;
        scree_plan_make(&figures_task, cycles, &plan_options, &plan);
        if (plan.state) status = no_plan(figures, &plan);
        trials[2 * n] = trials[2 * n + 1] =
            (struct trial){.process = &process, .cycles = cycles, .restitution = 0.5, .profile = plan.profile};
        trials[2 * n].profile = conventional_profile(cycles);
    }
    if (!status) status = figures_do(figures, run_trial, trials, 2 * SPEEDS_F);
    process_free(&process);
    struct scree_out out = {0};
    if (!status)
        status = figures_table(figures, "fig_forces",
                               "cycles_1_min,catch_conventional_N,impact_conventional_m_s,catch_new_N,impact_new_m_s,"
                               "error_conventional_m,error_new_m",
                               &out);
    if (status) return status;
    double impact = 0.0, relief = 0.0;
    for (int n = 0; n < SPEEDS_F; n++) {
        const struct process_run *old = &trials[2 * n].run, *new = &trials[2 * n + 1].run;
        fprintf(out.file, "%.17g,%.17g,%.17g,%.17g,%.17g,%.17g,%.17g\n", trials[2 * n].cycles, old->catch_force,
                old->approach, new->catch_force, new->approach, old->error, new->error);
        impact = scree_most(impact, new->approach);
        if (old->catch_force > 0.0) relief = scree_most(relief, new->catch_force / old->catch_force);
    }
    status = scree_out_keep(&out, &figures->trouble);
    figures_report(figures, "forces", "largest impact speed of the new motion, 125 to 700/min (m/s)", 0.0, impact,
                   5e-3);
    if (!figures->silent)
        printf("     the new motion's catch takes at most %.3g of the conventional motion's force\n", relief);
    return status ? status : figures_plot(figures, "fig_forces", script_forces);
}
