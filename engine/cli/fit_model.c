/* Scenes in the loop of a fit. Residuals and their derivatives run all experiments, several at a time; the order of
 * sums doesn't depend on that. */
#include "engine/cli/fit_model.h"

#include "engine/scene.h"
#include "engine/scene_file.h"
#include "solver/student.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- one experiment ---- */

/* The change with numbers in place of {names}; to be freed, NULL if there is no memory. */
static char *fill_in(const struct fit_file *file, const char *change, const double *x) {
    enum { LONGEST_NUMBER = 32 };
    size_t size = strlen(change) + 1, length;
    for (const char *c = change; (c = strchr(c, '{')) != NULL; c++) size += LONGEST_NUMBER;
    char *filled = malloc(size), *to = filled;
    if (!filled) return NULL;
    for (const char *place; (place = fit_next_place(change, &length)) != NULL; change = place + length + 2) {
        memcpy(to, change, (size_t)(place - change));
        to += place - change;
        to += snprintf(to, LONGEST_NUMBER, "%.17g", x[fit_find_parameter(file, place + 1, length)]);
    }
    strcpy(to, change);
    return filled;
}

/* A derivative is taken with one step throughout: where the engine chooses it, it would jump with the stiffness. */
static scree_scene *load(const struct fit_file *file, const struct fit_experiment *e, const double *x, double step,
                         struct scree_run_request *request, scree_trouble *trouble) {
    char fixed[64], **change = calloc((size_t)e->changes + 1, sizeof *change);
    scree_scene *scene = NULL;
    int count = 0, lacks = !change;
    for (; !lacks && count < e->changes; count++) lacks = !(change[count] = fill_in(file, e->change[count], x));
    if (lacks) scree_report(trouble, SCREE_NO_MEMORY, NULL, "no memory for a fit");
    if (!lacks && step > 0.0) {
        snprintf(fixed, sizeof fixed, "time.step=%.17g", step);
        change[count] = fixed;
    }
    if (!lacks)
        scree_read_scene(e->text, e->size, e->scene, (const char *const *)change, count + (step > 0.0), 1, &scene,
                         request, trouble);
    for (int k = 0; change && k < count; k++) free(change[k]);
    free(change);
    return scene;
}

/* A body on its way: its states at the ends of the last step. */
struct way {
    scree_scene *scene;
    int body;
    double from, to; /* s; the same where a whole number of steps led to the reading */
    scree_body_state before, after;
};

static scree_status step_on(struct way *way, long steps, scree_trouble *trouble) {
    way->from = way->to;
    way->before = way->after;
    scree_status status = scree_scene_step(way->scene, steps);
    if (status) *trouble = *scree_scene_trouble(way->scene);
    way->to = scree_scene_time(way->scene);
    way->after = scree_scene_body(way->scene, way->body);
    return status;
}

/* Times as near to a step as this, in steps, are on it. */
static const double near_step = 1e-9, rounding = 1e-15;

static scree_status go_to(struct way *way, double time, const struct fit_experiment *e, scree_trouble *trouble) {
    double step = scree_scene_step_length(way->scene), ahead = (time - way->to) / step;
    double near = near_step + rounding * time / step;
    scree_status status = SCREE_OK;
    if (ahead >= 1.0 - near) {
        status = step_on(way, (long)floor(ahead + near), trouble);
        way->from = way->to;
        way->before = way->after;
        step = scree_scene_step_length(way->scene); /* a watch may have halved it */
        ahead = (time - way->to) / step;
    }
    if (status || ahead <= near) return status;
    if (way->scene->time.integrator == SCREE_ADAPTIVE)
        return scree_report(
            trouble, SCREE_BAD_INPUT, NULL,
            "%s: with the adaptive integrator readings must fall on the scene's steps, of %.9g s; the one of its t = "
            "%.9g s doesn't: choose a time.step of which all times of the record are multiples",
            e->record, step, time);
    return step_on(way, 1, trouble);
}

static double value_at(const struct way *way, double time, int quantity) {
    int axis = quantity % 3, kind = quantity / 3;
    const scree_body_state *a = &way->before, *b = &way->after;
    double length = way->to - way->from, u = length > 0.0 ? (time - way->from) / length : 1.0;
    if (kind == FIT_WX / 3) return a->spin[axis] + u * (b->spin[axis] - a->spin[axis]);
    double x = a->position[axis], y = b->position[axis], v = a->velocity[axis], w = b->velocity[axis];
    if (u >= 1.0 - near_step) return kind == FIT_X / 3 ? y : w;
    if (kind == FIT_X / 3)
        return (1.0 - u) * (1.0 - u) * ((1.0 + 2.0 * u) * x + u * length * v) +
               u * u * ((3.0 - 2.0 * u) * y + (u - 1.0) * length * w);
    return 6.0 * u * (1.0 - u) * (y - x) / length + (1.0 - u) * (1.0 - 3.0 * u) * v + u * (3.0 * u - 2.0) * w;
}

static scree_status check_record(const struct fit_experiment *e, const scree_scene *scene, double delay, double end,
                                 scree_trouble *trouble) {
    double first = e->time[0] - delay, last = e->time[e->rows - 1] - delay;
    if (first < 0.0)
        return scree_report(trouble, SCREE_BAD_INPUT, NULL,
                            "%s: the record begins %.9g s before the scene does (with a delay of %.9g s)", e->record,
                            -first, delay);
    if (last > end * (1.0 + 1e-12))
        return scree_report(trouble, SCREE_BAD_INPUT, NULL,
                            "%s: the record goes on until the scene's t = %.9g s, and %s ends at %.9g s; set time.end",
                            e->record, last, e->scene, end);
    for (int c = 0; c < e->columns; c++)
        if (e->quantity[c] <= FIT_Z && scene->bounded && scene->domain.periodic[e->quantity[c]])
            return scree_report(trouble, SCREE_BAD_INPUT, NULL,
                                "%s: the scene repeats itself along %c, where positions jump; fit velocities instead",
                                e->record, "xyz"[e->quantity[c]]);
    return SCREE_OK;
}

/* Which body of the scene a wrong name may have meant. */
static struct scree_hint body_hint(const scree_scene *scene, const char *wrong) {
    enum { MOST = 64 };
    scree_name name[MOST];
    const char *names[MOST + 1] = {0};
    for (int k = 0; k < MOST && k < scree_scene_bodies(scene); k++) {
        name[k] = scree_scene_body_name(scene, k);
        names[k] = name[k].text;
    }
    return scree_hint(wrong, names);
}

static scree_status follow(const struct fit_experiment *e, scree_scene *scene, double delay, double *values,
                           scree_trouble *trouble) {
    struct way way = {.scene = scene, .body = scree_scene_find_body(scene, e->body)};
    if (way.body < 0)
        return scree_report(trouble, SCREE_BAD_INPUT, NULL, "%s has no body called \"%s\"%s", e->scene,
                            scree_shown(e->body).text, body_hint(scene, e->body).text);
    way.before = way.after = scree_scene_body(scene, way.body);
    for (size_t row = 0; row < e->rows; row++) {
        double time = e->time[row] - delay;
        scree_status status = go_to(&way, time, e, trouble);
        if (status) return status;
        for (int c = 0; c < e->columns; c++) values[(size_t)c * e->rows + row] = value_at(&way, time, e->quantity[c]);
    }
    return SCREE_OK;
}

scree_status fit_simulate(const struct fit_file *file, int k, const double *x, double step, double *values,
                          double *taken, scree_trouble *trouble) {
    const struct fit_experiment *e = &file->experiment[k];
    struct scree_run_request request = {0};
    scree_trouble cause = {0};
    scree_scene *scene = load(file, e, x, step, &request, &cause);
    scree_status status = scene ? SCREE_OK : cause.status;
    if (scene) {
        double delay = e->delay_parameter < 0 ? e->delay : x[e->delay_parameter];
        const struct scree_step_choice *choice = &scene->plan.choice;
        *taken = choice->automatic && !(choice->accurate > 0.0) ? choice->step : 0.0;
        status = check_record(e, scene, delay, request.end, &cause);
        if (!status) status = follow(e, scene, delay, values, &cause);
    }
    scree_scene_destroy(scene);
    scree_free_request(&request);
    return status ? scree_report(trouble, status, NULL, "%s: %s", e->place, cause.text) : SCREE_OK;
}

/* ---- all of them ---- */

struct model {
    const struct fit_file *file;
    int threads;
    size_t *offset;         /* of each experiment's first reading among all */
    double *x, *misfit;     /* parameters last run with, and misfits there; */
    double *steps;          /* steps taken there, one an experiment */
    double *beside;         /* misfits on both sides of it: 2 parameters x readings */
    scree_status *status;   /* of runs at the same time, 2 parameters x experiments at most, */
    scree_trouble *trouble; /* and why they failed */
    scree_trouble refused;  /* the last cause, and that of a lack of memory, which is no fault of the parameters */
    scree_trouble lack;
    long runs;
};

/* Run experiment k; its misfits into `misfit`, where those of all experiments are. */
static scree_status run(const struct model *m, int k, const double *x, double step, double *misfit, double *taken,
                        scree_trouble *trouble) {
    const struct fit_experiment *e = &m->file->experiment[k];
    double *own = misfit + m->offset[k];
    scree_status status = fit_simulate(m->file, k, x, step, own, taken, trouble);
    for (int c = 0; c < e->columns; c++, own += e->rows)
        for (size_t row = 0; row < e->rows; row++) own[row] = (own[row] - e->reading[c][row]) / e->deviation[c];
    return status;
}

static int has_failed(struct model *m, int job) {
    if (m->status[job]) m->refused = m->trouble[job];
    if (m->status[job] == SCREE_NO_MEMORY) m->lack = m->trouble[job];
    return m->status[job] != SCREE_OK;
}

static int residual(void *context, const double *x, double *r) {
    struct model *m = context;
    const struct fit_file *f = m->file;
    int failed = 0;
#pragma omp parallel for schedule(dynamic) num_threads(m->threads)
    for (int k = 0; k < f->experiments; k++) m->status[k] = run(m, k, x, 0.0, m->misfit, &m->steps[k], &m->trouble[k]);
    m->runs += f->experiments;
    for (int k = 0; k < f->experiments; k++) failed |= has_failed(m, k);
    memcpy(m->x, x, (size_t)f->parameters * sizeof *x);
    memcpy(r, m->misfit, f->readings * sizeof *r);
    return failed;
}

/* Where parameter j is put for its derivative, below or above x; within its bounds. */
static double beside(const struct fit_parameter *parameter, double x, int above) {
    double share = 1e-4 * fmax(fabs(x), 1e-3 * fabs(parameter->start));
    double by = parameter->difference > 0.0 ? parameter->difference : share;
    return above ? fmin(x + by, parameter->high) : fmax(x - by, parameter->low);
}

/* Misfits with parameter j on one side of x. */
static double *misfits_beside(const struct model *m, int j, int above) {
    return m->beside + (size_t)(2 * j + above) * m->file->readings;
}

/* One run for the derivatives: a parameter, a side, an experiment. */
static void run_beside(const struct model *m, const double *x, int job) {
    const struct fit_file *f = m->file;
    int k = job % f->experiments, above = job / f->experiments % 2, j = job / f->experiments / 2;
    double moved[SCREE_LM_UNKNOWNS], taken;
    if (!fit_uses(f, k, j)) {
        size_t first = m->offset[k], count = f->experiment[k].rows * (size_t)f->experiment[k].columns;
        memcpy(misfits_beside(m, j, above) + first, m->misfit + first, count * sizeof(double));
        m->status[job] = SCREE_OK;
        return;
    }
    memcpy(moved, x, (size_t)f->parameters * sizeof *x);
    moved[j] = beside(&f->parameter[j], x[j], above);
    m->status[job] = run(m, k, moved, m->steps[k], misfits_beside(m, j, above), &taken, &m->trouble[job]);
}

/* Derivative by parameter j: of one side alone where scenes can't run on the other. */
static int difference(struct model *m, int j, const double *x, double *column) {
    const struct fit_file *f = m->file;
    const double *misfit[2];
    double at[2];
    for (int above = 0; above < 2; above++) {
        int failed = 0;
        for (int k = 0; k < f->experiments; k++) failed |= has_failed(m, (2 * j + above) * f->experiments + k);
        misfit[above] = failed ? m->misfit : misfits_beside(m, j, above);
        at[above] = failed ? x[j] : beside(&f->parameter[j], x[j], above);
    }
    if (!(at[0] < at[1])) return 1;
    for (size_t row = 0; row < f->readings; row++) column[row] = (misfit[1][row] - misfit[0][row]) / (at[1] - at[0]);
    return 0;
}

/* Differences over 1e-4 of a parameter, not the 1e-8 that suits smooth functions: where an impact falls into another
 * step, a scene's error jumps a little, which small differences would take for a slope. */
static int jacobian(void *context, const double *x, double *columns) {
    struct model *m = context;
    const struct fit_file *f = m->file;
    int jobs = 2 * f->parameters * f->experiments, failed = 0;
    /* Derivatives need the misfits and the steps of x itself; the residual goes where columns are written later. */
    if (memcmp(m->x, x, (size_t)f->parameters * sizeof *x) != 0 && residual(m, x, columns)) return 1;
#pragma omp parallel for schedule(dynamic) num_threads(m->threads)
    for (int job = 0; job < jobs; job++) run_beside(m, x, job);
    for (int job = 0; job < jobs; job++) m->runs += fit_uses(f, job % f->experiments, job / f->experiments / 2);
    for (int j = 0; j < f->parameters; j++) failed |= difference(m, j, x, columns + (size_t)j * f->readings);
    return failed;
}

static scree_status make_model(const struct fit_file *f, int threads, struct model *m, scree_trouble *trouble) {
    size_t n = (size_t)f->parameters, experiments = (size_t)f->experiments;
    *m = (struct model){.file = f, .threads = threads};
    m->offset = calloc(experiments, sizeof *m->offset);
    m->x = calloc(n, sizeof *m->x);
    m->misfit = calloc(f->readings, sizeof *m->misfit);
    m->beside = calloc(2 * n * f->readings, sizeof *m->beside);
    m->steps = calloc(experiments, sizeof *m->steps);
    m->status = calloc(2 * n * experiments, sizeof *m->status);
    m->trouble = calloc(2 * n * experiments, sizeof *m->trouble);
    if (!m->offset || !m->x || !m->misfit || !m->beside || !m->steps || !m->status || !m->trouble)
        return scree_report(trouble, SCREE_NO_MEMORY, NULL, "no memory to fit %zu readings", f->readings);
    for (size_t k = 1; k < experiments; k++)
        m->offset[k] = m->offset[k - 1] + f->experiment[k - 1].rows * (size_t)f->experiment[k - 1].columns;
    return SCREE_OK;
}

static void free_model(struct model *m) {
    free(m->offset);
    free(m->x);
    free(m->misfit);
    free(m->beside);
    free(m->steps);
    free(m->status);
    free(m->trouble);
}

/* ---- the fit ---- */

/* A parameter that changes nothing isn't held by its bound. */
static int is_idle(const struct model *m, int j) {
    size_t size = m->file->readings * sizeof(double);
    return memcmp(misfits_beside(m, j, 0), misfits_beside(m, j, 1), size) == 0;
}

static enum fit_state state_of(const struct model *m, const scree_lm_outcome *outcome, int j, int held,
                               double variance) {
    if (is_idle(m, j) || (!held && !isfinite(variance))) return FIT_UNDETERMINED;
    return !outcome->converged ? FIT_ADRIFT : held ? FIT_HELD : FIT_FREE;
}

/* Intervals of the linear theory: value +- t standard errors. */
static void find_intervals(const struct model *m, int rank, const int *free_ones, struct fit_result *result) {
    const struct fit_file *f = m->file;
    result->freedom = (long)f->readings - (rank > 0 ? rank : 0);
    result->scatter = result->outcome.norm / sqrt((double)result->freedom);
    double t = scree_student_bound(f->confidence, result->freedom);
    for (int j = 0; j < f->parameters; j++) {
        double variance = result->covariance[j * f->parameters + j];
        result->state[j] = rank < 0 ? FIT_ADRIFT : state_of(m, &result->outcome, j, !free_ones[j], variance);
        result->error[j] = result->state[j] == FIT_FREE ? sqrt(variance) : NAN;
        result->low[j] = result->value[j] - t * result->error[j];
        result->high[j] = result->value[j] + t * result->error[j];
    }
}

/* Whether a run with parameter j on one side has failed; `cause` is then the first that did. */
static int side_failed(const struct model *m, int j, int above, scree_trouble *cause) {
    for (int k = 0; k < m->file->experiments; k++) {
        int job = (2 * j + above) * m->file->experiments + k;
        if (!m->status[job]) continue;
        *cause = m->trouble[job];
        return 1;
    }
    return 0;
}

/* Why there is nothing to begin with: the scenes don't run as they are, or with some parameter on neither side. */
static scree_status why_not(const struct model *m, scree_trouble *trouble) {
    const struct fit_file *f = m->file;
    int derived = m->runs > f->experiments;
    for (int j = 0; j < (derived ? f->parameters : 1); j++)
        if (side_failed(m, j, 0, trouble) && (!derived || side_failed(m, j, 1, trouble))) return trouble->status;
    return scree_report(trouble, SCREE_FAILED, NULL,
                        "misfits at the start, or their derivatives, are beyond all numbers: see readings, deviations "
                        "and differences");
}

static scree_status solve(const struct fit_file *f, struct model *m, int (*progress)(void *, const scree_lm_progress *),
                          struct fit_result *result, scree_trouble *trouble) {
    int n = f->parameters, free_ones[SCREE_LM_UNKNOWNS];
    double low[SCREE_LM_UNKNOWNS], high[SCREE_LM_UNKNOWNS];
    for (int j = 0; j < n; j++) {
        result->value[j] = f->parameter[j].start;
        low[j] = f->parameter[j].low;
        high[j] = f->parameter[j].high;
    }
    scree_lm_problem problem = {.unknowns = n,
                                .residuals = (int)f->readings,
                                .residual = residual,
                                .jacobian = jacobian,
                                .context = m,
                                .lower = low,
                                .upper = high};
    /* A hundredth of a standard error, which reduces the sum of squares by 1e-4 of its mean per degree of freedom, is
     * near enough. */
    scree_lm_options options = {
        .reduction = 1e-4 / (double)(f->readings - (size_t)n), .no_polish = 1, .callback = progress};
    void *workspace = malloc(scree_lm_workspace(n, (int)f->readings));
    if (!workspace) return scree_report(trouble, SCREE_NO_MEMORY, NULL, "no memory to fit %zu readings", f->readings);
    result->outcome = scree_lm_solve(&problem, &options, result->value, workspace);
    scree_status status = result->outcome.reason == SCREE_LM_NOT_FINITE ? why_not(m, trouble) : SCREE_OK;
    if (!status) {
        result->refused = m->refused;
        int rank = scree_lm_covariance(&problem, &options, result->value, result->covariance, free_ones, workspace);
        find_intervals(m, rank, free_ones, result);
    }
    if (m->lack.status) {
        *trouble = m->lack;
        status = m->lack.status;
    }
    memcpy(result->misfit, m->misfit, f->readings * sizeof *result->misfit);
    result->runs = m->runs;
    free(workspace);
    return status;
}

scree_status fit_solve(const struct fit_file *file, int threads,
                       int (*progress)(void *context, const scree_lm_progress *progress), struct fit_result *result,
                       scree_trouble *trouble) {
    size_t n = (size_t)file->parameters;
    *result = (struct fit_result){.runs = 0};
    result->value = calloc(4 * n, sizeof(double));
    result->state = calloc(n, sizeof *result->state);
    result->covariance = calloc(n * n, sizeof(double));
    result->misfit = calloc(file->readings, sizeof(double));
    if (!result->value || !result->state || !result->covariance || !result->misfit)
        return scree_report(trouble, SCREE_NO_MEMORY, NULL, "no memory for a fit");
    result->error = result->value + n;
    result->low = result->value + 2 * n;
    result->high = result->value + 3 * n;
    struct model model;
    scree_status status = make_model(file, threads, &model, trouble);
    if (!status) status = solve(file, &model, progress, result, trouble);
    free_model(&model);
    return status;
}

void fit_free_result(struct fit_result *result) {
    free(result->value);
    free(result->state);
    free(result->covariance);
    free(result->misfit);
}
