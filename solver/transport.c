/* Planning the new motion of a comb: formulations A, B and C, and what makes a plan admissible. */
#include "solver/transport.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

const char *scree_plan_state_name(enum scree_plan_state state) {
    static const char *const names[] = {"good",          "bad task",          "no detachment", "early detachment",
                                        "early contact", "second separation", "backwards",     "acceleration",
                                        "jerk",          "no solution",       "model failed"};
    return names[state];
}

/* ---- the task ---- */

static void fail(scree_plan *plan, enum scree_plan_state state, const char *format, ...) {
    if (plan->state != SCREE_PLAN_GOOD) return;
    plan->state = state;
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(plan->text, sizeof plan->text, format, arguments);
    va_end(arguments);
}

static void check_task(const scree_transport *t, double cycles, scree_plan *plan) {
    const double *f = t->fractions;
    double play = scree_transport_play(t);
    const double sizes[] = {t->distance, t->gap, t->width, t->friction, t->gravity};
    static const char *const names[] = {"distance", "gap", "width", "friction", "gravity"};
    for (int k = 0; k < 5; k++)
        if (!(sizes[k] > 0.0) || !isfinite(sizes[k]))
            fail(plan, SCREE_PLAN_BAD_TASK, "%s must be positive, got %g", names[k], sizes[k]);
    if (!(play > 0.0))
        fail(plan, SCREE_PLAN_BAD_TASK, "the gap between the tines (%g m) is not wider than the product (%g m)", t->gap,
             t->width);
    if (!(t->gap < t->distance))
        fail(
            plan, SCREE_PLAN_BAD_TASK,
            "the gap between the tines (%g m) must be less than the transport distance (%g m), by the tines' thickness",
            t->gap, t->distance);
    if (!(t->share > 0.0 && t->share <= 1.0))
        fail(plan, SCREE_PLAN_BAD_TASK, "the share of the cycle used for transport must be in (0, 1], got %g",
             t->share);
    if (!(0.0 < f[0] && f[0] < f[1] && f[1] < f[2] && f[2] < 1.0))
        fail(plan, SCREE_PLAN_BAD_TASK, "the time shares %g, %g, %g must increase between 0 and 1", f[0], f[1], f[2]);
    if (!(cycles > 0.0) || !isfinite(cycles))
        fail(plan, SCREE_PLAN_BAD_TASK, "the operating speed must be positive, got %g cycles/min", cycles);
    if (!(t->largest_acceleration >= 0.0 && t->largest_jerk >= 0.0))
        fail(plan, SCREE_PLAN_BAD_TASK, "the drive's limits must not be negative");
}

static void set_times(const scree_transport *t, double cycles, scree_plan *plan) {
    plan->cycles = cycles;
    plan->duration = scree_transport_time(t, cycles);
    plan->time[0] = 0.0;
    for (int k = 0; k < 3; k++) plan->time[1 + k] = t->fractions[k] * plan->duration;
    plan->time[4] = plan->duration;
}

struct scree_profile scree_plan_profile(const double time[5], const double v[3], const double a[3]) {
    struct scree_profile profile = {0};
    struct scree_kinematics at = {0};
    for (int k = 0; k < 4; k++) {
        struct scree_kinematics next = {.v = k < 3 ? v[k] : 0.0, .a = k < 3 ? a[k] : 0.0};
        struct scree_segment segment = scree_velocity_segment(time[k + 1] - time[k], at.x, at, next);
        next.x = scree_segment_at(&segment, segment.duration).x;
        scree_profile_append(&profile, &segment);
        at = next;
    }
    return profile;
}

/* Fill the plan from velocities and accelerations at events 1 to 3. */
static void adopt(scree_plan *plan, const double v[3], const double a[3]) {
    plan->profile = scree_plan_profile(plan->time, v, a);
    for (int k = 0; k < 5; k++) plan->event[k] = scree_profile_at(&plan->profile, plan->time[k]);
    for (int k = 0; k < 3; k++) { /* as set, without the rounding of the polynomial */
        plan->event[1 + k].v = v[k];
        plan->event[1 + k].a = a[k];
    }
    plan->event[4].v = plan->event[4].a = 0.0;
    plan->extrema = scree_profile_extrema(&plan->profile);
}

/* ---- formulation A ---- */

/* Travel of a velocity quintic without jerk at its ends: D (va + vb)/2 + D^2 (aa - ab)/10. */
static double travel(double d, double va, double vb, double aa, double ab) {
    return 0.5 * d * (va + vb) + 0.1 * d * d * (aa - ab);
}

/* Residuals of the linear formulation at v1, v2: stroke and gap, in m. */
static void rigid_residuals(const scree_transport *t, const double time[5], double v1, double v2, double *stroke,
                            double *gap) {
    double mu_g = scree_transport_slowing(t), d[4], slide = time[3] - time[1], v3 = v1 - mu_g * slide;
    for (int k = 0; k < 4; k++) d[k] = time[k + 1] - time[k];
    double brake = travel(d[1], v1, v2, -mu_g, 0.0) + travel(d[2], v2, v3, 0.0, -mu_g);
    double all = travel(d[0], 0.0, v1, 0.0, -mu_g) + brake + travel(d[3], v3, 0.0, -mu_g, 0.0);
    *stroke = all - (t->distance - scree_transport_play(t));
    *gap = v1 * slide - 0.5 * mu_g * slide * slide - brake - scree_transport_play(t);
}

int scree_plan_rigid(const scree_transport *transport, double cycles, double v[3]) {
    scree_plan plan = {0};
    check_task(transport, cycles, &plan);
    if (plan.state) return 1;
    set_times(transport, cycles, &plan);
    /* Two linear equations: their values at three points give matrix and right-hand side. */
    double s0, g0, s1, g1, s2, g2;
    rigid_residuals(transport, plan.time, 0.0, 0.0, &s0, &g0);
    rigid_residuals(transport, plan.time, 1.0, 0.0, &s1, &g1);
    rigid_residuals(transport, plan.time, 0.0, 1.0, &s2, &g2);
    double a = s1 - s0, b = s2 - s0, c = g1 - g0, d = g2 - g0, det = a * d - b * c;
    if (det == 0.0) return 1;
    v[0] = (-s0 * d + g0 * b) / det;
    v[1] = (-g0 * a + s0 * c) / det;
    v[2] = v[0] - scree_transport_slowing(transport) * (plan.time[3] - plan.time[1]);
    return 0;
}

static void plan_a(const scree_transport *t, scree_plan *plan) {
    double v[3], mu_g = scree_transport_slowing(t), a[3] = {-mu_g, 0.0, -mu_g};
    if (scree_plan_rigid(t, plan->cycles, v)) {
        fail(plan, SCREE_PLAN_NO_SOLUTION, "the linear equations for these time shares are singular");
        return;
    }
    adopt(plan, v, a);
    plan->detached = plan->time[1];
    plan->detached_velocity = v[0];
}

/* ---- formulation B ---- */

struct task {
    const scree_transport *transport;
    const scree_plan_options *options;
    const double *time;
    double duration;
    int calls;
    scree_catch last; /* of the process model */
    int good;         /* the last accepted step is good enough */
};

/* First time in the segment from event 1 to event 2 at which the comb brakes harder than friction; negative if it never
 * does. */
static double detachment(const struct scree_profile *profile, double mu_g) {
    double t = scree_segment_first(&profile->segment[1], -mu_g);
    return t < 0.0 ? t : profile->start[1] + t;
}

/* Unknowns v1, v2, v3, a3; a1 = a2 = 0. */
static struct scree_profile profile_of(const struct task *task, const double *x) {
    double a[3] = {0.0, 0.0, x[3]};
    return scree_plan_profile(task->time, x, a);
}

/* Scaled residuals from what the product has at event 3: clearance, velocity, acceleration; and the stroke. */
static void scale_residuals(const struct task *task, const struct scree_profile *profile, const double *x,
                            const scree_catch *at, double *r) {
    const scree_transport *t = task->transport;
    double play = scree_transport_play(t);
    double end = scree_profile_at(profile, task->time[4]).x;
    r[0] = (end - (t->distance - play)) / t->distance;
    r[1] = at->clearance / play;
    r[2] = (at->velocity - x[2]) * task->duration / t->distance;
    r[3] = (x[3] - at->acceleration) / scree_transport_slowing(t);
}

/* A rigid product under this profile; nonzero if it never leaves the comb. */
static int rigid_catch(const struct task *task, const struct scree_profile *profile, scree_catch *at) {
    const scree_transport *t = task->transport;
    double mu_g = scree_transport_slowing(t), left = detachment(profile, mu_g);
    if (left < 0.0) return 1;
    *at = scree_slide_catch(t, profile, left, task->time[3]);
    return 0;
}

static int residual_b(void *context, const double *x, double *r) {
    struct task *task = context;
    struct scree_profile profile = profile_of(task, x);
    scree_catch at;
    if (rigid_catch(task, &profile, &at)) return 1;
    scale_residuals(task, &profile, x, &at, r);
    return 0;
}

static scree_lm_outcome solve_b(struct task *task, double *x) {
    scree_lm_problem problem = {.unknowns = 4, .residuals = 4, .residual = residual_b, .context = task};
    double workspace[SCREE_LM_DOUBLES(4, 4)];
    scree_lm_options options = {.central = 1, .typical = (const double[]){1.0, 1.0, 1.0, 10.0}};
    return scree_lm_solve(&problem, &options, x, workspace);
}

static void adopt_b(const scree_transport *t, const double *x, scree_plan *plan) {
    double a[3] = {0.0, 0.0, x[3]};
    adopt(plan, x, a);
    plan->detached = detachment(&plan->profile, scree_transport_slowing(t));
    if (plan->detached < 0.0)
        fail(plan, SCREE_PLAN_NO_DETACHMENT, "the comb never brakes harder than friction (%g m/s^2)",
             scree_transport_slowing(t));
    else
        plan->detached_velocity = scree_profile_at(&plan->profile, plan->detached).v;
}

/* The start of B: velocities of A, none negative. */
static void guess_b(const scree_transport *t, const scree_plan *plan, const double *guess, double *x) {
    double v[3] = {0};
    if (!guess) scree_plan_rigid(t, plan->cycles, v);
    for (int k = 0; k < 3; k++) x[k] = guess ? guess[k] : v[k];
    x[3] = guess ? guess[3] : -scree_transport_slowing(t);
}

static int solved(const scree_plan *plan) { return plan->solver.converged && plan->solver.norm <= 1e-8; }

static int plan_b(const scree_transport *t, const scree_plan_options *options, scree_plan *plan, double *x) {
    struct task task = {t, options, plan->time, plan->duration, 0, {.clearance = 0.0}, 0};
    guess_b(t, plan, options->guess, x);
    plan->solver = solve_b(&task, x);
    /* Other starts, if there is no root near the first: the closed form, and gentler and harder braking. */
    static const double harder[] = {1.0, 0.8, 0.5, 1.2, 0.2};
    for (int k = 0; k < 5 && !solved(plan); k++) {
        guess_b(t, plan, NULL, x);
        x[1] *= harder[k];
        plan->solver = solve_b(&task, x);
    }
    double r[4];
    if (!solved(plan) && residual_b(&task, x, r))
        fail(plan, SCREE_PLAN_NO_DETACHMENT, "the comb never brakes harder than friction at this speed: %s",
             scree_lm_text(plan->solver.reason));
    else if (!solved(plan))
        fail(plan, SCREE_PLAN_NO_SOLUTION, "no motion meets all conditions: %s", scree_lm_text(plan->solver.reason));
    adopt_b(t, x, plan);
    return plan->state != SCREE_PLAN_GOOD;
}

/* ---- formulation C ---- */

static int residual_c(void *context, const double *x, double *r) {
    struct task *task = context;
    struct scree_profile profile = profile_of(task, x);
    task->calls++;
    if (task->options->process(task->options->context, &profile, task->time[3], &task->last)) return 1;
    scale_residuals(task, &profile, x, &task->last, r);
    return 0;
}

/* The rigid product's Jacobian serves for the process model: it costs no simulation, and differs by the compliance of
 * the contacts, so that the iteration gains more than a digit a step. */
static int jacobian_c(void *context, const double *x, double *jacobian) {
    static const double typical[4] = {1.0, 1.0, 1.0, 10.0};
    for (int j = 0; j < 4; j++) {
        double ahead[4], behind[4], high[4], low[4], h = 1e-5 * typical[j];
        memcpy(ahead, x, sizeof ahead);
        memcpy(behind, x, sizeof behind);
        ahead[j] += h;
        behind[j] -= h;
        if (residual_b(context, ahead, high) || residual_b(context, behind, low)) return 1;
        for (int k = 0; k < 4; k++) jacobian[j * 4 + k] = (high[k] - low[k]) / (2.0 * h);
    }
    return 0;
}

/* Whether the catch is as good as asked for: all residuals below the scaled clearance, the stroke far below and the
 * acceleration, which acts only from then on, not far above. */
static int good_enough(const struct task *task, const double *r) {
    double wanted = task->options->clearance > 0.0 ? task->options->clearance : 1e-7;
    wanted /= scree_transport_play(task->transport);
    return fabs(r[1]) <= wanted && fabs(r[2]) <= wanted && fabs(r[0]) <= 1e-3 * wanted && fabs(r[3]) <= 1e3 * wanted;
}

/* Stop there; each further digit would cost a simulation. */
static int watch(void *context, const scree_lm_progress *progress) {
    struct task *task = context;
    const scree_plan_options *o = task->options;
    task->good = good_enough(task, progress->r);
    return (o->callback && o->callback(o->callback_context, progress)) || task->good;
}

/* The outcome at x, where the iteration ended. */
static void judge_c(struct task *task, const double *x, scree_plan *plan) {
    double r[4];
    if (task->good) return;
    if (plan->solver.reason == SCREE_LM_NOT_FINITE || residual_c(task, x, r))
        fail(plan, SCREE_PLAN_MODEL_FAILED, "the process model failed at the %s of the iteration%s%s",
             plan->solver.reason == SCREE_LM_NOT_FINITE ? "start" : "end", task->last.cause[0] ? ": " : "",
             task->last.cause);
    else if (!good_enough(task, r) && !(plan->solver.converged && plan->solver.norm <= 1e-5))
        fail(plan, SCREE_PLAN_NO_SOLUTION, "the iteration ended with a clearance of %.3g m and %.3g m/s: %s",
             task->last.clearance, task->last.velocity - x[2], scree_lm_text(plan->solver.reason));
}

static void plan_c(const scree_transport *t, const scree_plan_options *options, scree_plan *plan) {
    double x[4], workspace[SCREE_LM_DOUBLES(4, 4)];
    if (!options->process) {
        fail(plan, SCREE_PLAN_BAD_TASK, "formulation C needs a process model");
        return;
    }
    if (options->guess)
        memcpy(x, options->guess, sizeof x);
    else if (plan_b(t, options, plan, x))
        return;
    struct task task = {t, options, plan->time, plan->duration, 0, {.clearance = 0.0}, 0};
    scree_lm_problem problem = {
        .unknowns = 4, .residuals = 4, .residual = residual_c, .jacobian = jacobian_c, .context = &task};
    scree_lm_options lm = {.no_polish = 1,
                           .evaluations = options->iterations > 0 ? options->iterations : 60,
                           .first = 0.1,
                           .reduction = 1e-30,
                           .callback = watch,
                           .callback_context = &task};
    plan->solver = scree_lm_solve(&problem, &lm, x, workspace);
    judge_c(&task, x, plan);
    plan->simulations = task.calls;
    adopt_b(t, x, plan);
}

/* ---- admissibility ---- */

static void check_drive(const scree_transport *t, scree_plan *plan) {
    double a = scree_extrema_acceleration(&plan->extrema), j = scree_extrema_jerk(&plan->extrema);
    if (t->largest_acceleration > 0.0 && a > t->largest_acceleration)
        fail(plan, SCREE_PLAN_ACCELERATION, "the comb needs %.4g m/s^2, the drive gives %.4g", a,
             t->largest_acceleration);
    if (t->largest_jerk > 0.0 && j > t->largest_jerk)
        fail(plan, SCREE_PLAN_JERK, "the comb needs a jerk of %.4g m/s^3, the drive gives %.4g", j, t->largest_jerk);
}

/* Between detachment and catch: not before event 1, and nothing met on the way. */
static void check_slide(const scree_transport *t, scree_plan *plan) {
    double mu_g = scree_transport_slowing(t), slack = 1e-6 * t->distance;
    double early = scree_slide_detachment(&plan->profile, mu_g * (1.0 + 1e-9));
    if (early >= 0.0 && early < plan->time[1] * (1.0 - 1e-6))
        fail(plan, SCREE_PLAN_EARLY_DETACHMENT, "the comb brakes harder than friction at %.4g s, before the push ends",
             early);
    /* The process model's product isn't rigid: at the catch it is elsewhere, and so it is on the way there. */
    if (plan->simulations) slack += fabs(scree_slide_catch(t, &plan->profile, plan->detached, plan->time[3]).clearance);
    double contact = scree_slide_leaves(t, &plan->profile, plan->detached, plan->time[3] * (1.0 - 1e-9), slack);
    if (contact >= 0.0)
        fail(plan, SCREE_PLAN_EARLY_CONTACT, "the product meets a tine again at %.4g s, before the catch at %.4g s",
             contact, plan->time[3]);
}

/* The first cause wins, so causes stand before their consequences: a comb that would move backwards does so because the
 * speed is too low for the slide, which is what should be told. */
void scree_plan_check(const scree_transport *t, scree_plan *plan) {
    double mu_g = scree_transport_slowing(t), d4 = plan->time[4] - plan->time[3];
    if (plan->detached < 0.0 || plan->detached > plan->time[3])
        fail(plan, SCREE_PLAN_NO_DETACHMENT,
             "the comb brakes too softly for the product to leave it: at most %.4g m/s^2, friction %.4g m/s^2",
             fmax(-plan->extrema.least.a, 0.0), mu_g);
    /* With zero jerk at event 3, where the comb brakes like friction: only then does the quintic brake harder at
     * once. */
    if (!(plan->event[3].v / d4 > 0.6 * mu_g))
        fail(plan, SCREE_PLAN_SECOND_SEPARATION,
             "after the catch the comb brakes too softly to hold the product: v3/D4 = %.4g m/s^2, needed %.4g m/s^2 "
             "(a higher speed, or another last time share)",
             plan->event[3].v / d4, 0.6 * mu_g);
    if (plan->extrema.least.v < -1e-9 * t->distance / plan->duration)
        fail(plan, SCREE_PLAN_BACKWARDS, "the comb would move backwards at %.3g m/s", -plan->extrema.least.v);
    if (plan->state == SCREE_PLAN_GOOD) check_slide(t, plan);
    check_drive(t, plan);
}

/* ---- the whole ---- */

void scree_plan_make(const scree_transport *transport, double cycles, const scree_plan_options *options,
                     scree_plan *plan) {
    static const scree_plan_options defaults = {.formulation = SCREE_PLAN_A};
    if (!options) options = &defaults;
    *plan = (scree_plan){0};
    check_task(transport, cycles, plan);
    if (plan->state) return;
    set_times(transport, cycles, plan);
    double x[4];
    if (options->formulation == SCREE_PLAN_A) plan_a(transport, plan);
    if (options->formulation == SCREE_PLAN_B) plan_b(transport, options, plan, x);
    if (options->formulation == SCREE_PLAN_C) plan_c(transport, options, plan);
    if (plan->state == SCREE_PLAN_GOOD) scree_plan_check(transport, plan);
}

/* ---- formulation A as nine equations ---- */

struct nine {
    const scree_transport *transport;
    double duration;
};

/* Unknowns v1, v2, v3, a1, a2, a3, t1, t2, t3. */
static int residual_nine(void *context, const double *x, double *r) {
    const struct nine *nine = context;
    const scree_transport *t = nine->transport;
    double mu_g = scree_transport_slowing(t), T = nine->duration, time[5] = {0.0, x[6], x[7], x[8], T}, d[4];
    for (int k = 0; k < 4; k++) {
        d[k] = time[k + 1] - time[k];
        if (!(d[k] > 0.0)) return 1;
    }
    double brake = travel(d[1], x[0], x[1], x[3], x[4]) + travel(d[2], x[1], x[2], x[4], x[5]);
    double slide = time[3] - time[1];
    r[0] = (x[3] + mu_g) / mu_g;
    r[1] = x[4] / mu_g;
    r[2] = (x[5] + mu_g) / mu_g;
    r[3] = (x[2] - x[0] + mu_g * slide) * T / t->distance;
    r[4] = (x[0] * slide - 0.5 * mu_g * slide * slide - brake - scree_transport_play(t)) / t->distance;
    double all = travel(d[0], 0.0, x[0], 0.0, x[3]) + brake + travel(d[3], x[2], 0.0, x[5], 0.0);
    r[5] = (all - (t->distance - scree_transport_play(t))) / t->distance;
    for (int k = 0; k < 3; k++) r[6 + k] = time[1 + k] / T - t->fractions[k];
    return 0;
}

scree_lm_outcome scree_plan_nine(const scree_transport *transport, double cycles, scree_plan *plan) {
    *plan = (scree_plan){0};
    check_task(transport, cycles, plan);
    if (plan->state) return (scree_lm_outcome){.reason = SCREE_LM_BAD_INPUT};
    set_times(transport, cycles, plan);
    double mean = transport->distance / plan->duration, T = plan->duration, workspace[SCREE_LM_DOUBLES(9, 9)];
    double x[9] = {1.5 * mean, 0.5 * mean, 1.5 * mean, 0.0, 0.0, 0.0, 0.25 * T, 0.5 * T, 0.75 * T};
    struct nine nine = {transport, T};
    scree_lm_problem problem = {.unknowns = 9, .residuals = 9, .residual = residual_nine, .context = &nine};
    double mu_g = scree_transport_slowing(transport), typical[9] = {mean, mean, mean, mu_g, mu_g, mu_g, T, T, T};
    scree_lm_options options = {.central = 1, .typical = typical, .evaluations = 20000};
    plan->solver = scree_lm_solve(&problem, &options, x, workspace);
    if (!plan->solver.converged) fail(plan, SCREE_PLAN_NO_SOLUTION, "%s", scree_lm_text(plan->solver.reason));
    for (int k = 0; k < 3; k++) plan->time[1 + k] = x[6 + k];
    adopt(plan, x, x + 3);
    plan->detached = plan->time[1];
    plan->detached_velocity = x[0];
    return plan->solver;
}
