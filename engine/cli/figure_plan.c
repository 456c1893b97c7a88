/* Figures 5b, 14 and 15: the new motion, planned with the process model in the loop. */
#include "engine/cli/figures.h"

#include <math.h>

/* ---- figure 5b ---- */

/* What MODEL says of plans: made for a rigid product (A) or with the process model (C), then run with all tines. */
static const struct {
    double cycles;
    enum scree_formulation formulation;
    double v[3], approach, catch_force, error; /* m/s, m/s, N, m */
} expected[] = {{500.0, SCREE_PLAN_A, {1.8219, 0.4444, 1.7336}, 0.143, 32.1, -0.006e-3},
                {700.0, SCREE_PLAN_A, {2.5204, 0.6222, 2.4574}, 0.359, 70.3, -1.27e-3},
                {500.0, SCREE_PLAN_C, {1.8211, 0.4434, 1.7355}, 0.0, 6.5, -0.002e-3},
                {700.0, SCREE_PLAN_C, {2.5076, 0.6314, 2.4610}, 0.0, 13.3, -0.033e-3}};

enum { PLANS = sizeof expected / sizeof expected[0] };

struct planned {
    scree_plan plan;
    struct process_run run;
};

/* All of them, and the process model that they share. */
struct all_planned {
    struct process process;
    struct planned planned[PLANS];
};

static scree_status plan_and_run(const struct figures *figures, void *context, int k, scree_trouble *trouble) {
    (void)figures;
    struct all_planned *all = context;
    struct planned *planned = &all->planned[k];
    scree_plan_options options = {.formulation = expected[k].formulation,
                                  .process = process_catch,
                                  .context = &all->process, /* only read */
                                  .clearance = 1e-7};
    scree_plan_make(&figures_task, expected[k].cycles, &options, &planned->plan);
    if (planned->plan.state != SCREE_PLAN_GOOD)
        return scree_report(trouble, SCREE_FAILED, NULL, "no plan for %g cycles/min: %s", expected[k].cycles,
                            planned->plan.text);
    scree_status status = process_simulate(&all->process, &planned->plan.profile, figures_task.distance, &planned->run);
    if (status) *trouble = planned->run.trouble;
    return status;
}

static void report_plan(struct figures *figures, int k, const struct planned *planned) {
    char quantity[96];
    const char *kind = expected[k].formulation == SCREE_PLAN_A ? "rigid plan" : "model in the loop";
    for (int event = 0; event < 3 && expected[k].formulation == SCREE_PLAN_C; event++) {
        snprintf(quantity, sizeof quantity, "v%d at %g/min, %s (m/s)", event + 1, expected[k].cycles, kind);
        /* Four decimals are known. */
        figures_report(figures, "5b", quantity, expected[k].v[event], planned->plan.event[1 + event].v, 1.5e-4);
    }
    snprintf(quantity, sizeof quantity, "approach to the front tines at %g/min, %s (m/s)", expected[k].cycles, kind);
    /* A planned catch is as soft as wanted: 5 mm/s is the bound. */
    figures_report(figures, "5b", quantity, expected[k].approach, planned->run.approach,
                   expected[k].approach > 0.0 ? 1e-2 : 5e-3);
    snprintf(quantity, sizeof quantity, "largest force of the catch at %g/min, %s (N)", expected[k].cycles, kind);
    figures_report(figures, "5b", quantity, expected[k].catch_force, planned->run.catch_force, 1e-2);
    snprintf(quantity, sizeof quantity, "final position less %+.3f mm at %g/min, %s (m)", 1e3 * expected[k].error,
             expected[k].cycles, kind);
    figures_report(figures, "5b", quantity, 0.0, planned->run.error - expected[k].error, 1e-5);
}

static const char script_5b[] =
    "set title 'New motion, 500 cycles/min'\nset xlabel 'path (mm)'\nset ylabel 'velocity (m/s)'\nset key top right\n"
    "set xrange [0:100]\nset yrange [0:2.2]\n"
    "plot 'fig_5b.csv' using ($2*1e3):3 with lines ls 1 title 'comb',\\\n"
    "     '' using ($4*1e3):5 with lines ls 2 title 'product, simulated'\n";

static void write_sample(void *file, const struct process_sample *s) {
    fprintf(file, "%.17g,%.17g,%.17g,%.17g,%.17g,%.17g,%.17g\n", s->time, s->comb, s->comb_velocity, s->product,
            s->product_velocity, s->push, s->catch_force);
}

/* The run of a plan as a table. */
static scree_status write_run(struct figures *figures, const struct process *process, const scree_plan *plan,
                              const char *name) {
    struct scree_out out = {0};
    scree_status status =
        figures_table(figures, name, "time_s,x_comb_m,v_comb_m_s,x_product_m,v_product_m_s,push_N,catch_N", &out);
    if (status) return status;
    struct process_run run = {.watch = write_sample, .context = out.file, .every = 1e-4};
    status = process_simulate(process, &plan->profile, figures_task.distance, &run);
    if (!status) return scree_out_keep(&out, &figures->trouble);
    figures->trouble = run.trouble;
    scree_out_drop(&out, 0);
    return status;
}

scree_status figure_5b(struct figures *figures) {
    static struct all_planned all;
    scree_status status = figures_process(figures, &all.process);
    if (!status) status = figures_do(figures, plan_and_run, &all, PLANS);
    for (int k = 0; k < PLANS && !status; k++) report_plan(figures, k, &all.planned[k]);
    if (!status) status = write_run(figures, &all.process, &all.planned[2].plan, "fig_5b");
    process_free(&all.process);
    return status ? status : figures_plot(figures, "fig_5b", script_5b);
}

/* ---- figure 14 ---- */

static const char script_14[] =
    "set title 'Profile of the comb at 500 cycles/min: events and what can be adjusted'\n"
    "set multiplot layout 2,1\nset xrange [0:60]\nset key off\nset lmargin 10\n"
    "do for [t in '15 30 45'] { set arrow from t, graph 0 to t, graph 1 nohead lc rgb '#888888' dt 3 }\n"
    "set label 1 '1: end of push' at 15.5, graph 0.08\nset label 2 '2: minimum' at 30.5, graph 0.08\n"
    "set label 3 '3: catch' at 45.5, graph 0.08\n"
    "set ylabel 'velocity (m/s)'\n"
    "plot 'fig_14.csv' using ($1*1e3):3 with lines ls 1, '' using ($1*1e3):($1 >= 0.0155 && $1 <= 0.045 ? $6 : 1/0) "
    "with lines ls 2, 'fig_14_events.csv' using ($1*1e3):2 with points ls 3 ps 1.5\n"
    "unset label\nunset title\nset ylabel 'acceleration (m/s²)'\nset xlabel 'time (ms)'\n"
    "plot 'fig_14.csv' using ($1*1e3):4 with lines ls 1, 'fig_14_events.csv' using ($1*1e3):3 with points ls 3 ps 1.5\n"
    "unset multiplot\n";

static scree_status write_profile(struct figures *figures, const scree_plan *plan) {
    enum { ROWS = 600 };
    struct scree_out out = {0};
    scree_status status = figures_table(figures, "fig_14", "time_s,x_m,v_m_s,a_m_s2,j_m_s3,v_product_m_s", &out);
    for (int k = 0; !status && k <= ROWS; k++) {
        double time = plan->duration * k / ROWS, slide = fmax(time - plan->detached, 0.0);
        struct scree_kinematics at = scree_profile_at(&plan->profile, time);
        double product = slide > 0.0 && time <= plan->time[3]
                             ? plan->detached_velocity - scree_transport_slowing(&figures_task) * slide
                             : at.v;
        fprintf(out.file, "%.17g,%.17g,%.17g,%.17g,%.17g,%.17g\n", time, at.x, at.v, at.a, at.j, product);
    }
    if (!status) status = scree_out_keep(&out, &figures->trouble);
    if (!status) status = figures_table(figures, "fig_14_events", "time_s,v_m_s,a_m_s2", &out);
    for (int k = 0; !status && k < 5; k++)
        fprintf(out.file, "%.17g,%.17g,%.17g\n", plan->time[k], plan->event[k].v, plan->event[k].a);
    return status ? status : scree_out_keep(&out, &figures->trouble);
}

scree_status figure_14(struct figures *figures) {
    scree_plan plan;
    scree_plan_options options = {.formulation = SCREE_PLAN_B};
    scree_plan_make(&figures_task, 500.0, &options, &plan);
    if (plan.state) return scree_report(&figures->trouble, SCREE_FAILED, NULL, "no plan: %s", plan.text);
    scree_status status = write_profile(figures, &plan);
    if (status) return status;
    double stroke = figures_task.distance - scree_transport_play(&figures_task);
    struct scree_kinematics jumps = scree_profile_jumps(&plan.profile);
    /* Sums of six terms of some 0.1 m; jumps in units of what the profile has at most. */
    figures_report(figures, "14", "stroke of the comb (m)", stroke, plan.event[4].x, 1e-14);
    figures_report(figures, "14", "largest jump of the acceleration, of its maximum", 0.0,
                   jumps.a / scree_extrema_acceleration(&plan.extrema), 1e-13);
    figures_report(figures, "14", "largest jump of the jerk, of its maximum", 0.0,
                   jumps.j / scree_extrema_jerk(&plan.extrema), 1e-13);
    figures_report(figures, "14", "time of the detachment over the transport time", 0.2584,
                   plan.detached / plan.duration, 2e-4); /* four decimals are known */
    figures_report(figures, "14", "velocity at the detachment (m/s)", 1.82207, plan.detached_velocity, 3e-6);
    return figures_plot(figures, "fig_14", script_14);
}

/* ---- figure 15 ---- */

enum { MOST_RUNS = 40 };

/* A process model that keeps the solver's residuals, unscaled. */
struct record {
    const struct process *process;
    int runs;
    double clearance[MOST_RUNS], velocity[MOST_RUNS]; /* m; relative, m/s */
    double acceleration, stroke; /* the largest of all runs: relative, m/s^2; against that wanted, m */
};

static int recorded(void *context, const struct scree_profile *profile, double until, scree_catch *result) {
    struct record *record = context;
    struct scree_kinematics comb = scree_profile_at(profile, until),
                            end = scree_profile_at(profile, profile->start[profile->count]);
    double play = scree_transport_play(&figures_task);
    int failed = process_catch((void *)(uintptr_t)record->process, profile, until, result);
    if (!failed && record->runs < MOST_RUNS) {
        record->clearance[record->runs] = result->clearance;
        record->velocity[record->runs] = result->velocity - comb.v;
        record->runs++;
        record->acceleration = scree_most(record->acceleration, fabs(result->acceleration - comb.a));
        record->stroke = scree_most(record->stroke, fabs(end.x - (figures_task.distance - play)));
    }
    return failed;
}

static const char script_15[] =
    "set title 'Residuals of the iterative solver: the model in the loop, started from the rigid plan'\n"
    "set xlabel 'simulation'\nset ylabel 'clearance at the catch (m), relative velocity (m/s)'\n"
    "set logscale y\nset format y '10^{%T}'\nset xrange [0.8:*]\nset xtics 1\nset key top right\n"
    "set label \"acceleration and stroke:\\nmet to rounding\\nfrom the start\" at graph 0.03, graph 0.17\n"
    "plot for [n=0:2] 'fig_15.csv' using ($1 == 300 + 200*n ? $2 : 1/0):(abs($3)) with linespoints ls n+1 title "
    "sprintf('clearance, %d/min', 300 + 200*n),\\\n"
    "     for [n=0:2] 'fig_15.csv' using ($1 == 300 + 200*n ? $2 : 1/0):(abs($4)) with linespoints ls n+4 title "
    "sprintf('velocity, %d/min', 300 + 200*n)\n";

/* A rigid plan, simulated with friction other than planned for: how the clearance changes, with tines so stiff that the
 * closed form for a rigid product holds but for the tines' swing, sqrt(m/k), at either end of the slide. */
static void report_sensitivity(struct figures *figures, const struct process *process, double cycles) {
    scree_plan plan;
    scree_plan_options options = {.formulation = SCREE_PLAN_B};
    scree_plan_make(&figures_task, cycles, &options, &plan);
    scree_outcome by[SCREE_CONDITIONS];
    scree_catch caught[2] = {{0}};
    double off = 0.01, swing = sqrt(process->mass / 1e7);
    if (plan.state || scree_rigid_sensitivities(&figures_task, &plan, by)) return;
    for (int side = 0; side < 2; side++) {
        struct process with = *process;
        with.tine_stiffness = 1e7;
        with.step = 1.5e-6;
        with.kinetic_friction += side ? off : -off;
        if (process_catch(&with, &plan.profile, plan.time[3], &caught[side])) caught[side].clearance = NAN;
    }
    char quantity[96];
    snprintf(quantity, sizeof quantity, "clearance per unit of mu_k at %g/min, tines of 1e7 N/m (m)", cycles);
    figures_report(figures, "15", quantity, by[SCREE_BY_FRICTION].clearance,
                   (caught[1].clearance - caught[0].clearance) / (2.0 * off),
                   2.0 * swing / (plan.time[3] - plan.detached));
}

scree_status figure_15(struct figures *figures) {
    struct process process;
    struct scree_out out = {0};
    scree_status status = figures_process(figures, &process);
    if (!status) status = figures_table(figures, "fig_15", "cycles_1_min,simulation,clearance_m,velocity_m_s", &out);
    double acceleration = 0.0, stroke = 0.0;
    for (int n = 300; n <= 700 && !status; n += 200) {
        struct record record = {.process = &process};
        double guess[4] = {0.0, 0.0, 0.0, -scree_transport_slowing(&figures_task)};
        scree_plan_rigid(&figures_task, n, guess);
        scree_plan_options options = {
            .formulation = SCREE_PLAN_C, .process = recorded, .context = &record, .guess = guess, .clearance = 1e-8};
        scree_plan plan;
        scree_plan_make(&figures_task, n, &options, &plan);
        for (int k = 0; k < record.runs; k++)
            fprintf(out.file, "%d,%d,%.17g,%.17g\n", n, k + 1, record.clearance[k], record.velocity[k]);
        char quantity[96];
        snprintf(quantity, sizeof quantity, "clearance at the catch after %d simulations, %d/min (m)", record.runs, n);
        if (plan.state) status = scree_report(&figures->trouble, SCREE_FAILED, NULL, "no plan: %s", plan.text);
        if (!status) figures_report(figures, "15", quantity, 0.0, record.clearance[record.runs - 1], options.clearance);
        acceleration = scree_most(acceleration, record.acceleration);
        stroke = scree_most(stroke, record.stroke);
    }
    /* Both are linear in the unknowns, and the rigid plan meets them: what is left is rounding, in the stroke that of
     * the Jacobian's differences (1e-11) times steps of a millimetre. */
    if (!status) {
        figures_report(figures, "15", "acceleration, after any simulation (m/s^2)", 0.0, acceleration, 1e-14);
        figures_report(figures, "15", "stroke, after any simulation (m)", 0.0, stroke, 1e-13);
    }
    for (int n = 300; n <= 700 && !status; n += 200) report_sensitivity(figures, &process, n);
    process_free(&process);
    if (status) {
        scree_out_drop(&out, 0);
        return status;
    }
    status = scree_out_keep(&out, &figures->trouble);
    return status ? status : figures_plot(figures, "fig_15", script_15);
}
