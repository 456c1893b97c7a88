/* Levenberg-Marquardt with a trust region, bounds and a Gauss-Newton polish. The iteration reads from top to bottom in
 * scree_lm_solve; each of its parts has a function above it. */
#include "solver/lm.h"

#include "solver/qr.h"

#include <float.h>
#include <limits.h>
#include <math.h>
#include <string.h>

struct solver {
    const scree_lm_problem *problem;
    scree_lm_options options; /* defaults filled in */
    int n, m;
    double *x, *r, *raw; /* the point, its residual, and that before the loss */
    double *trial_x, *trial_r, *trial_raw;
    double *jacobian, *norms, *gradient;             /* at x: J by columns, |J_j|, J^T (unit r) */
    double *d, *p;                                   /* scales; step */
    double *columns, *triangle, *rhs;                /* the free columns factored; R; -Q^T r */
    double *free_d, *free_p, *free_norms, *diagonal; /* of the free unknowns */
    double *scratch, *rest;                          /* n (n + 5) and m entries */
    double *inverse, *keep;                          /* of the polish: n x n, 3 n entries */
    int *pivot, *index;                              /* index: which unknowns the free columns belong to */
    char *seen;                                      /* unknowns whose column has been other than zero */
    char *held;                                      /* unknowns at a bound that the gradient presses them against */
    int free;
    double unit; /* of r: a power of two, so that no product leaves the range of numbers and no digit is lost */
    double norm, radius, par, x_norm, step, cosine;
    scree_lm_outcome outcome;
};

static int bounded(const struct solver *s) { return s->problem->lower || s->problem->upper; }

/* ---- residuals ---- */

/* The loss turns r into sign(r) sqrt(rho(r^2)), whose square sum is then minimised; `slope` is its derivative. */
static double lose(const scree_lm_options *options, double r, double *slope) {
    double c = options->scale, a = fabs(r);
    *slope = 1.0;
    if (options->loss == SCREE_LM_HUBER && a > c) {
        double root = sqrt(c * (2.0 * a - c));
        *slope = c / root;
        return r < 0.0 ? -root : root;
    }
    if (options->loss == SCREE_LM_CAUCHY && a > 1e-8 * c) { /* below, rho differs from r^2 by less than rounding */
        double t = a / c, root = c * sqrt(log1p(t * t));
        *slope = a / ((1.0 + t * t) * root);
        return r < 0.0 ? -root : root;
    }
    return r;
}

/* Residual at x after the loss; returns its norm, HUGE_VAL if it isn't finite. */
static double evaluate(struct solver *s, const double *x, double *r, double *raw) {
    s->outcome.residual_calls++;
    if (s->problem->residual(s->problem->context, x, raw) != 0) return HUGE_VAL;
    double slope;
    for (int k = 0; raw != r && k < s->m; k++) r[k] = lose(&s->options, raw[k], &slope);
    double norm = scree_norm(s->m, r);
    return isfinite(norm) ? norm : HUGE_VAL;
}

static double lower(const struct solver *s, int j) { return s->problem->lower ? s->problem->lower[j] : -HUGE_VAL; }
static double upper(const struct solver *s, int j) { return s->problem->upper ? s->problem->upper[j] : HUGE_VAL; }

/* Raw residual with x_j at `value` into `to`; 0 if it is finite. */
static int shifted(struct solver *s, int j, double value, double *to) {
    memcpy(s->trial_x, s->x, (size_t)s->n * sizeof *s->x);
    s->trial_x[j] = value;
    s->outcome.residual_calls++;
    return s->problem->residual(s->problem->context, s->trial_x, to) != 0 || !isfinite(scree_norm(s->m, to));
}

/* Column j by differences: steps that stay within the bounds, and on the other side if the residual isn't finite on
 * one. A side with less than half of the step is used only if the other has no more; an unknown without any room has a
 * zero column. */
static int difference(struct solver *s, int j, double *column) {
    double size = fmax(fabs(s->x[j]), s->options.typical ? fabs(s->options.typical[j]) : 0.0);
    double h = (s->options.central ? 6.0e-6 : 1.5e-8) * (size > 0.0 ? size : 1.0);
    volatile double ahead = fmin(s->x[j] + h, upper(s, j)), behind = fmax(s->x[j] - h, lower(s, j));
    double up = ahead - s->x[j], down = s->x[j] - behind; /* what the steps really are after rounding */
    double least = fmin(0.5 * h, fmax(up, down));
    if (least == 0.0) {
        memset(column, 0, (size_t)s->m * sizeof *column);
        return 0;
    }
    int has_up = up >= least && !shifted(s, j, ahead, column);
    int wants_down = !has_up || s->options.central;
    int has_down = wants_down && down >= least && !shifted(s, j, behind, s->trial_raw);
    for (int k = 0; k < s->m; k++) {
        double high = has_up ? column[k] : s->raw[k], low = has_down ? s->trial_raw[k] : s->raw[k];
        column[k] = (high - low) / ((has_up ? up : 0.0) + (has_down ? down : 0.0));
    }
    return !has_up && !has_down;
}

/* Jacobian at x. Nonzero if something isn't finite (columns that aren't are seen in their norms). */
static int linearise(struct solver *s) {
    s->outcome.jacobian_calls++;
    if (s->problem->jacobian) {
        if (s->problem->jacobian(s->problem->context, s->x, s->jacobian) != 0) return 1;
    } else
        for (int j = 0; j < s->n; j++)
            if (difference(s, j, s->jacobian + j * s->m)) return 1;
    for (int k = 0; s->options.loss != SCREE_LM_SQUARES && k < s->m; k++) {
        double slope;
        lose(&s->options, s->raw[k], &slope);
        for (int j = 0; j < s->n; j++) s->jacobian[j * s->m + k] *= slope;
    }
    return 0;
}

/* ---- bounds ---- */

/* An unknown is held where it stands at a bound and a step down the gradient would leave it. */
static void hold(struct solver *s) {
    for (int j = 0; j < s->n; j++) {
        int at_lower = s->x[j] <= lower(s, j) && s->gradient[j] >= 0.0;
        int at_upper = s->x[j] >= upper(s, j) && s->gradient[j] <= 0.0;
        s->held[j] = (char)(at_lower || at_upper);
    }
}

/* Largest cosine between the residual and a free column. */
static double stationarity(const struct solver *s) {
    double largest = 0.0;
    for (int j = 0; j < s->n; j++)
        if (!s->held[j] && s->norms[j] > 0.0 && s->norm > 0.0)
            largest = fmax(largest, fabs(s->gradient[j]) / (s->norms[j] * (s->unit * s->norm)));
    return largest;
}

/* ---- steps ---- */

/* Factor the columns of the unknowns that aren't held, with right-hand side -Q^T `residual`; in place if all are
 * free. */
static void factor(struct solver *s, const double *residual) {
    s->free = 0;
    for (int j = 0; j < s->n; j++) {
        if (s->held[j]) continue;
        if (s->columns != s->jacobian)
            memcpy(s->columns + s->free * s->m, s->jacobian + j * s->m, (size_t)s->m * sizeof(double));
        s->free_d[s->free] = s->d[j];
        s->index[s->free++] = j;
    }
    if (s->free == 0) return;
    scree_qr_factor(s->m, s->free, s->columns, s->pivot, s->diagonal, s->free_norms, s->scratch);
    for (int k = 0; k < s->m; k++) s->rest[k] = -residual[k];
    scree_qr_transform(s->m, s->free, s->columns, s->rest);
    memcpy(s->rhs, s->rest, (size_t)s->free * sizeof(double));
    scree_qr_triangle(s->m, s->free, s->columns, s->diagonal, s->triangle);
}

/* Norms of the columns and gradient J^T r, and which unknowns are held. Without bounds the factorisation gives them. */
static int measure(struct solver *s) {
    s->unit = scree_binary_unit(s->norm);
    if (bounded(s)) {
        for (int k = 0; k < s->m; k++) s->rest[k] = s->unit * s->r[k];
        for (int j = 0; j < s->n; j++) {
            s->norms[j] = scree_norm(s->m, s->jacobian + j * s->m);
            s->gradient[j] = scree_dot(s->m, s->jacobian + j * s->m, s->rest);
        }
        hold(s);
    } else {
        factor(s, s->r);
        for (int k = 0; k < s->n; k++) s->scratch[k] = -s->unit * s->rhs[k];
        for (int j = 0; j < s->n; j++) {
            s->norms[j] = s->free_norms[j];
            s->gradient[s->pivot[j]] = scree_dot(j + 1, s->triangle + j * s->n, s->scratch);
        }
    }
    for (int j = 0; j < s->n; j++)
        if (!isfinite(s->norms[j])) return 1;
    return 0;
}

/* The step within the radius for the free unknowns into p. */
static void trust_step(struct solver *s, double radius) {
    if (s->free)
        scree_qr_trust_step(s->free, s->triangle, s->pivot, s->free_d, s->rhs, radius, &s->par, s->free_p, s->scratch);
    for (int k = 0; k < s->free; k++) s->p[s->index[k]] = s->free_p[k];
}

/* As trust_step, with bounds: unknowns that the step would carry beyond a bound go there and are held for the rest of
 * it. */
static void bounded_step(struct solver *s) {
    char held[SCREE_LM_UNKNOWNS];
    memcpy(held, s->held, (size_t)s->n);
    memcpy(s->trial_r, s->r, (size_t)s->m * sizeof(double));
    for (int j = 0; j < s->n; j++) s->p[j] = 0.0;
    double unit = scree_binary_unit(s->radius), square = (unit * s->radius) * (unit * s->radius);
    for (int round = 0; round <= s->n; round++) {
        double left = square; /* of the radius, by the unknowns that have gone to a bound */
        for (int j = 0; j < s->n; j++)
            if (s->held[j]) left -= (unit * s->d[j] * s->p[j]) * (unit * s->d[j] * s->p[j]);
        factor(s, s->trial_r);
        trust_step(s, sqrt(fmax(left, 0.01 * square)) / unit);
        int crossed = 0;
        for (int k = 0; k < s->free; k++) {
            int j = s->index[k];
            double to = fmin(fmax(s->x[j] + s->p[j], lower(s, j)), upper(s, j));
            if (to == s->x[j] + s->p[j]) continue;
            s->p[j] = to - s->x[j];
            s->held[j] = 1;
            crossed++;
            for (int i = 0; i < s->m; i++) s->trial_r[i] += s->p[j] * s->jacobian[j * s->m + i];
        }
        if (!crossed) break;
    }
    memcpy(s->held, held, (size_t)s->n);
}

/* |D p| */
static double scaled(const struct solver *s, const double *p) {
    for (int j = 0; j < s->n; j++) s->scratch[j] = s->d[j] * p[j];
    return scree_norm(s->n, s->scratch);
}

/* J p into `rest` (its length is what counts: without bounds R P^T p serves as well), and its norm. */
static double image(struct solver *s) {
    if (bounded(s) || s->options.acceleration) {
        memset(s->rest, 0, (size_t)s->m * sizeof(double));
        for (int j = 0; j < s->n; j++)
            for (int k = 0; s->p[j] != 0.0 && k < s->m; k++) s->rest[k] += s->p[j] * s->jacobian[j * s->m + k];
        return scree_norm(s->m, s->rest);
    }
    memset(s->rest, 0, (size_t)s->n * sizeof(double));
    for (int j = 0; j < s->n; j++)
        for (int k = 0; k <= j; k++) s->rest[k] += s->p[s->pivot[j]] * s->triangle[j * s->n + k];
    return scree_norm(s->n, s->rest);
}

/* Second-order correction of the step along its own direction (Transtrum & Sethna, arXiv:1201.5885): a = -J^+ r_vv/2,
 * with the second directional derivative r_vv by a difference; taken only if it is small beside the step. */
static void accelerate(struct solver *s) {
    const double h = 0.1, largest = 0.375; /* |a| <= 0.75 |p|/2 */
    if (s->outcome.residual_calls + 2 > s->options.evaluations) return;
    for (int j = 0; j < s->n; j++) s->trial_x[j] = s->x[j] + h * s->p[j];
    if (!(evaluate(s, s->trial_x, s->trial_r, s->trial_raw) < HUGE_VAL)) return;
    image(s);
    for (int k = 0; k < s->m; k++) s->rest[k] = -(s->trial_r[k] - s->r[k] - h * s->rest[k]) / (h * h);
    scree_qr_transform(s->m, s->n, s->columns, s->rest);
    scree_qr_damped_solve(s->n, s->triangle, s->pivot, s->free_d, s->rest, s->par, s->free_p, s->scratch);
    double p = scaled(s, s->p);
    if (!(scaled(s, s->free_p) <= largest * p)) return;
    for (int j = 0; j < s->n; j++) s->p[j] += s->free_p[j];
}

static void take_trial(struct solver *s, double norm) {
    double *t = s->r, *raw = s->raw;
    s->r = s->trial_r;
    s->trial_r = t;
    s->raw = s->trial_raw;
    s->trial_raw = raw;
    memcpy(s->x, s->trial_x, (size_t)s->n * sizeof(double));
    s->norm = norm;
}

/* Trust radius and par after a trial (More 1978, section 5): `actual` and `promised` reductions, `along` =
 * g.p/|r|^2. */
static void adapt_radius(struct solver *s, double actual, double promised, double along, double trial_norm) {
    double ratio = promised > 0.0 ? actual / promised : 0.0;
    if (ratio <= 0.25) {
        double shrink = actual >= 0.0 ? 0.5 : 0.5 * along / (along + 0.5 * actual);
        if (!(0.1 * trial_norm < s->norm) || !(shrink >= 0.1)) shrink = 0.1;
        s->radius = shrink * fmin(s->radius, 10.0 * s->step);
        s->par /= shrink;
    } else if (s->par == 0.0 || ratio >= 0.75) {
        s->radius = 2.0 * s->step;
        s->par *= 0.5;
    }
}

/* One trial step from x. Returns 1 if it was accepted; sets *done and the reason where a test of convergence holds. */
static int try_step(struct solver *s, int first, int *done) {
    if (bounded(s))
        bounded_step(s);
    else
        trust_step(s, s->radius);
    if (s->options.acceleration && !bounded(s)) accelerate(s);
    s->step = scaled(s, s->p);
    if (first) s->radius = fmin(s->radius, s->step);
    for (int j = 0; j < s->n; j++) s->trial_x[j] = fmin(fmax(s->x[j] + s->p[j], lower(s, j)), upper(s, j));
    double change = image(s) / s->norm, along = 0.0;
    for (int j = 0; j < s->n; j++) along += s->gradient[j] * s->p[j] / (s->unit * s->norm) / s->norm;
    double promised = -2.0 * along - change * change; /* relative reduction of |r|^2 by the linear model */
    double trial_norm = evaluate(s, s->trial_x, s->trial_r, s->trial_raw);

    double actual = -1.0;
    if (0.1 * trial_norm < s->norm) actual = (1.0 - trial_norm / s->norm) * (1.0 + trial_norm / s->norm);
    adapt_radius(s, actual, promised, along, trial_norm);
    int accepted = actual >= 1e-4 * promised && promised > 0.0; /* actual is -1 where the residual isn't finite */
    if (accepted) {
        take_trial(s, trial_norm);
        s->x_norm = scaled(s, s->x);
        s->outcome.iterations++;
    }
    *done = 1;
    if (s->norm == 0.0)
        s->outcome.reason = SCREE_LM_BY_COSINE;
    else if (fabs(actual) <= s->options.reduction && promised <= s->options.reduction && actual <= 2.0 * promised)
        s->outcome.reason = SCREE_LM_BY_REDUCTION;
    else if (s->radius <= s->options.radius * s->x_norm)
        s->outcome.reason = SCREE_LM_BY_RADIUS;
    else if (s->outcome.residual_calls >= s->options.evaluations)
        s->outcome.reason = SCREE_LM_EVALUATIONS;
    else
        *done = 0;
    return accepted;
}

static int report(struct solver *s) {
    if (!s->options.callback) return 0;
    scree_lm_progress progress = {s->outcome.iterations, s->norm, s->step, s->radius, s->par, s->cosine, s->x, s->r};
    return s->options.callback(s->options.callback_context, &progress);
}

/* Scales: the largest norm that each column has had. A column that has been zero so far counts as if its unknown could
 * change the residual by its own length; that only takes part in |D x|, for the unknown doesn't move. */
static void rescale(struct solver *s, int first) {
    for (int j = 0; j < s->n; j++) {
        int seen = !first && s->seen[j];
        s->d[j] = seen ? fmax(s->d[j], s->norms[j]) : s->norms[j];
        s->seen[j] = s->d[j] > 0.0;
        if (!s->seen[j]) s->d[j] = s->x[j] != 0.0 ? fabs(s->norm / s->x[j]) : s->norm;
        if (s->d[j] == 0.0) s->d[j] = 1.0;
    }
    for (int k = 0; k < s->free; k++) s->free_d[k] = s->d[s->index[k]];
    if (!first) return;
    s->x_norm = scaled(s, s->x);
    s->radius = s->options.first * (s->x_norm > 0.0 ? s->x_norm : s->norm);
}

/* From the start to the first test that holds. */
static void iterate(struct solver *s) {
    int differences = s->problem->jacobian ? 0 : s->n * (s->options.central ? 2 : 1);
    for (int first = 1;; first = 0) {
        if (s->outcome.residual_calls + differences >= s->options.evaluations) {
            s->outcome.reason = SCREE_LM_EVALUATIONS;
            return;
        }
        if (linearise(s) || measure(s)) {
            s->outcome.reason = first ? SCREE_LM_NOT_FINITE : SCREE_LM_STUCK;
            return;
        }
        rescale(s, first);
        s->cosine = stationarity(s);
        if (s->cosine <= s->options.cosine || s->norm == 0.0) {
            s->outcome.reason = SCREE_LM_BY_COSINE;
            return;
        }
        int accepted = 0, done = 0;
        for (int trial = 0; !accepted && !done; trial++) accepted = try_step(s, first && trial == 0, &done);
        if (accepted && report(s)) {
            s->outcome.reason = SCREE_LM_STOPPED;
            return;
        }
        if (done) return;
    }
}

/* Of the free columns as last factored. */
static int rank_of(const struct solver *s) {
    return scree_qr_rank(s->free, s->diagonal, s->pivot, s->free_norms, 1e-14);
}

/* The Gauss-Newton step of the free unknowns at x into p, and |D p|; HUGE_VAL where there is none. */
static double gauss_newton(struct solver *s) {
    if (linearise(s) || measure(s)) return HUGE_VAL;
    s->cosine = stationarity(s);
    if (bounded(s)) factor(s, s->r);
    if (s->free == 0 || rank_of(s) < s->free) return HUGE_VAL;
    memset(s->p, 0, (size_t)s->n * sizeof(double));
    s->par = 0.0;
    trust_step(s, HUGE_VAL);
    return scaled(s, s->p);
}

/* Whether the point that a test of convergence has accepted is one. The tests see only steps within the trust radius;
 * here the whole Gauss-Newton step decides: at a minimum either it promises no reduction to speak of, or it is short,
 * the residual being rounding. Elsewhere the iteration is stuck: in a canyon too curved for the radius, or where the
 * Jacobian is wrong. And an unknown that has run to where it changes nothing any more, though it did before, has run
 * away. */
static scree_lm_reason judge(struct solver *s, scree_lm_reason reason) {
    if (s->norm == 0.0) return reason;
    for (int j = 0; j < s->n; j++) {
        double size = fmax(fabs(s->x[j]), s->keep[j]); /* keep: |x| at the start */
        if (!s->held[j] && s->seen[j] && s->d[j] * size > 1e-6 * s->norm && s->norms[j] * size < 1e-12 * s->norm)
            return SCREE_LM_RUN_AWAY;
    }
    if (bounded(s)) factor(s, s->r);
    if (s->free == 0) return reason;
    double promised = scree_norm(rank_of(s), s->rhs) / s->norm;
    memset(s->p, 0, (size_t)s->n * sizeof(double));
    s->par = 0.0;
    trust_step(s, HUGE_VAL);
    double length = scaled(s, s->p) / fmax(scaled(s, s->x), DBL_MIN);
    return promised * promised <= 1e-5 || length <= 1e-6 ? reason : SCREE_LM_STUCK;
}

/* Broyden's update (Math. Comput. 19 (1965) 577) of the inverse H of the derivative of -p, in scaled unknowns, from the
 * change `moved` of x and that of p since the step before. */
static void learn(struct solver *s, const double *moved, const double *p_before) {
    int n = s->n;
    double *h = s->inverse, *hy = s->scratch, *sh = s->scratch + n, shy = 0.0;
    double unit = scree_binary_unit(scaled(s, moved));
    for (int i = 0; i < n; i++) {
        hy[i] = sh[i] = 0.0;
        for (int k = 0; k < n; k++) {
            hy[i] += h[i * n + k] * s->d[k] * (p_before[k] - s->p[k]);
            sh[i] += unit * s->d[k] * moved[k] * h[k * n + i];
        }
    }
    for (int k = 0; k < n; k++) shy += sh[k] * (unit * s->d[k]) * (p_before[k] - s->p[k]);
    if (shy == 0.0) return;
    for (int i = 0; i < n; i++)
        for (int k = 0; k < n; k++) h[i * n + k] += unit * (s->d[i] * moved[i] - hy[i]) * sh[k] / shy;
}

/* Drive the Gauss-Newton step to zero. F can't judge here: near the minimum it is flat to within rounding while x still
 * has half of its digits to gain. So the length of the step judges: x is kept where it is shortest. With a residual
 * that doesn't vanish the bare steps converge linearly, slowly where the model is strongly curved; Broyden's updates
 * mend that. */
static void polish(struct solver *s) {
    int n = s->n;
    double *best = s->keep, *moved = best + n, *p_before = moved + n, shortest = HUGE_VAL, norm_start = s->norm;
    s->options.central = 1;
    for (int k = 0; k < n * n; k++) s->inverse[k] = k % (n + 1) == 0;
    int cost = 1 + (s->problem->jacobian ? 0 : 2 * n); /* of a step, in calls of the residual */
    for (int step = 0, wasted = 0; step < 30 && s->norm > 0.0; step++) {
        if (s->outcome.residual_calls + cost >= s->options.evaluations) break;
        double length = gauss_newton(s);
        if (!(length < 2.0 * shortest)) break;
        wasted = length < 0.7 * shortest ? 0 : wasted + 1;
        if (length < shortest) {
            shortest = length;
            memcpy(best, s->x, (size_t)n * sizeof(double));
            s->outcome.last_step = length / fmax(scaled(s, s->x), DBL_MIN);
        }
        if (wasted == 3 || s->outcome.last_step <= 2.0 * DBL_EPSILON) break;
        if (step > 0) learn(s, moved, p_before);
        memcpy(p_before, s->p, (size_t)n * sizeof(double));
        int inside = 1;
        for (int j = 0; j < n; j++) {
            double move = 0.0;
            for (int k = 0; k < n; k++) move += s->inverse[j * n + k] * s->d[k] * p_before[k];
            s->trial_x[j] = s->held[j] ? s->x[j] : s->x[j] + move / s->d[j];
            moved[j] = s->trial_x[j] - s->x[j];
            inside &= s->trial_x[j] >= lower(s, j) && s->trial_x[j] <= upper(s, j);
        }
        if (!inside) break;
        double norm = evaluate(s, s->trial_x, s->trial_r, s->trial_raw);
        if (!(norm <= norm_start * (1.0 + 1e-8))) break;
        take_trial(s, norm);
        s->outcome.polish_steps++;
    }
    if (!(shortest < HUGE_VAL) || memcmp(best, s->x, (size_t)n * sizeof(double)) == 0) return;
    memcpy(s->trial_x, best, (size_t)n * sizeof(double));
    take_trial(s, evaluate(s, s->trial_x, s->trial_r, s->trial_raw));
}

/* ---- the whole ---- */

static scree_lm_options with_defaults(const scree_lm_options *given, int n) {
    scree_lm_options o = given ? *given : (scree_lm_options){0};
    if (o.reduction == 0.0) o.reduction = 1e-10;
    if (o.radius == 0.0) o.radius = 1e-12;
    if (o.cosine == 0.0) o.cosine = 1e-14;
    if (o.first == 0.0) o.first = 0.28;
    if (o.evaluations == 0) o.evaluations = n >= 1 && n <= SCREE_LM_UNKNOWNS ? 200 * (n + 1) : 1;
    return o;
}

/* Sizes that fit, 0 otherwise: the workspace is reckoned in int. */
static int sizes_fit(int n, int m) { return n >= 1 && n <= SCREE_LM_UNKNOWNS && m >= n && m <= INT_MAX / (4 * n + 32); }

static int makes_sense(const scree_lm_problem *problem, const scree_lm_options *o, const double *x) {
    int ok = sizes_fit(problem->unknowns, problem->residuals) && problem->residual && x;
    ok = ok && o->reduction >= 0.0 && o->radius >= 0.0 && o->cosine >= 0.0 && o->first > 0.0 && o->evaluations > 0;
    ok = ok && (o->loss == SCREE_LM_SQUARES ||
                ((o->loss == SCREE_LM_HUBER || o->loss == SCREE_LM_CAUCHY) && o->scale > 0.0 && isfinite(o->scale)));
    for (int j = 0; ok && j < problem->unknowns; j++) {
        double low = problem->lower ? problem->lower[j] : -HUGE_VAL,
               high = problem->upper ? problem->upper[j] : HUGE_VAL;
        ok = low <= high && low < HUGE_VAL && high > -HUGE_VAL && isfinite(x[j]);
    }
    return ok;
}

size_t scree_lm_workspace(int unknowns, int residuals) {
    if (!sizes_fit(unknowns, residuals)) return 0;
    size_t n = (size_t)unknowns, m = (size_t)residuals;
    return SCREE_LM_DOUBLES(n, m) * sizeof(double);
}

static double *take(double **memory, int count) {
    double *start = *memory;
    *memory += count;
    return start;
}

/* As many doubles as SCREE_LM_DOUBLES says. */
static void lay_out(struct solver *s, void *workspace) {
    double *memory = workspace;
    int n = s->n, m = s->m;
    s->jacobian = take(&memory, m * n);
    s->columns = take(&memory, m * n);
    s->r = take(&memory, m);
    s->raw = take(&memory, m);
    s->trial_r = take(&memory, m);
    s->trial_raw = take(&memory, m);
    s->rest = take(&memory, m);
    s->triangle = take(&memory, n * n);
    s->trial_x = take(&memory, n);
    s->norms = take(&memory, n);
    s->gradient = take(&memory, n);
    s->d = take(&memory, n);
    s->p = take(&memory, n);
    s->rhs = take(&memory, n);
    s->free_d = take(&memory, n);
    s->free_p = take(&memory, n);
    s->free_norms = take(&memory, n);
    s->diagonal = take(&memory, n);
    s->scratch = take(&memory, n * (n + 5));
    s->inverse = take(&memory, n * n);
    s->keep = take(&memory, 3 * n);
    s->pivot = (int *)take(&memory, n);
    s->index = s->pivot + n;
    s->held = (char *)take(&memory, n);
    s->seen = s->held + n;
    memset(s->held, 0, 2 * (size_t)n);
    memset(s->norms, 0, 2 * (size_t)n * sizeof(double)); /* and the gradient, which follows */
    /* Without a loss the residual is the raw one, and without bounds J is factored in place. */
    if (s->options.loss == SCREE_LM_SQUARES) s->raw = s->r;
    if (s->options.loss == SCREE_LM_SQUARES) s->trial_raw = s->trial_r;
    if (!bounded(s) && !s->options.acceleration) s->columns = s->jacobian;
}

static struct solver start(const scree_lm_problem *problem, const scree_lm_options *options, double *x,
                           void *workspace) {
    struct solver s = {.problem = problem, .n = problem->unknowns, .m = problem->residuals, .x = x};
    s.options = with_defaults(options, s.n);
    lay_out(&s, workspace);
    return s;
}

scree_lm_outcome scree_lm_solve(const scree_lm_problem *problem, const scree_lm_options *options, double *x,
                                void *workspace) {
    scree_lm_options resolved = with_defaults(options, problem->unknowns);
    if (!makes_sense(problem, &resolved, x) || !workspace) return (scree_lm_outcome){.reason = SCREE_LM_BAD_INPUT};
    struct solver s = start(problem, options, x, workspace);
    for (int j = 0; j < s.n; j++) x[j] = fmin(fmax(x[j], lower(&s, j)), upper(&s, j));
    s.norm = evaluate(&s, x, s.r, s.raw);
    if (!(s.norm < HUGE_VAL)) {
        s.outcome.reason = SCREE_LM_NOT_FINITE;
        return s.outcome;
    }
    for (int j = 0; j < s.n; j++) s.keep[j] = fabs(x[j]);
    iterate(&s);
    if (s.outcome.reason <= SCREE_LM_BY_COSINE) s.outcome.reason = judge(&s, s.outcome.reason);
    s.outcome.converged = s.outcome.reason <= SCREE_LM_BY_COSINE;
    if (s.outcome.converged && !s.options.no_polish) polish(&s);
    s.outcome.norm = s.norm;
    s.outcome.cosine = s.cosine;
    if (s.outcome.reason == SCREE_LM_NOT_FINITE) return s.outcome;
    if (bounded(&s)) factor(&s, s.r); /* the last step may have held more than stays held */
    s.outcome.free = s.free;
    s.outcome.rank = rank_of(&s);
    return s.outcome;
}

const char *scree_lm_text(scree_lm_reason reason) {
    switch (reason) {
    case SCREE_LM_BY_REDUCTION:
        return "converged: the sum of squares can't be reduced further";
    case SCREE_LM_BY_RADIUS:
        return "converged: the steps have become small";
    case SCREE_LM_BY_COSINE:
        return "converged: the residual vanishes or is orthogonal to the Jacobian";
    case SCREE_LM_STUCK:
        return "stuck: steps have become small though the gradient hasn't";
    case SCREE_LM_RUN_AWAY:
        return "stuck: an unknown has run to where it has no influence";
    case SCREE_LM_EVALUATIONS:
        return "not converged: too many evaluations";
    case SCREE_LM_STOPPED:
        return "stopped by the callback";
    case SCREE_LM_NOT_FINITE:
        return "the residual or its Jacobian isn't finite at the start";
    case SCREE_LM_BAD_INPUT:
        return "sizes, tolerances or bounds make no sense";
    }
    return "";
}

/* Rows of R^-1 in place of R (upper triangle by columns). */
static void invert_triangle(int n, double *r) {
    for (int j = 0; j < n; j++) {
        r[j * n + j] = 1.0 / r[j * n + j];
        for (int k = 0; k < j; k++) {
            double sum = 0.0;
            for (int i = k; i < j; i++) sum += r[i * n + k] * r[j * n + i];
            r[j * n + k] = -sum * r[j * n + j];
        }
    }
}

/* Covariance of the free unknowns that the data determine, from the triangle whose leading `rank` columns are
 * regular. */
static void fill_covariance(struct solver *s, int rank, double *covariance) {
    int n = s->n, f = s->free;
    double *inverse = s->scratch, deviation = s->m > rank ? s->norm / sqrt(s->m - rank) : 0.0;
    for (int j = 0; j < rank; j++)
        for (int k = 0; k < rank; k++) inverse[j * rank + k] = s->triangle[j * f + k];
    invert_triangle(rank, inverse);
    for (int k = 0; k < rank * rank; k++) inverse[k] *= deviation;
    for (int a = 0; a < rank; a++)
        for (int b = 0; b < rank; b++) {
            double sum = 0.0;
            for (int k = a > b ? a : b; k < rank; k++) sum += inverse[k * rank + a] * inverse[k * rank + b];
            covariance[s->index[s->pivot[a]] * n + s->index[s->pivot[b]]] = sum;
        }
}

/* Unknown `place` (among the pivoted columns) as one that the data don't determine. */
static void undetermined(const struct solver *s, int place, double *covariance) {
    int j = s->index[s->pivot[place]];
    for (int k = 0; k < s->n; k++) covariance[j * s->n + k] = covariance[k * s->n + j] = 0.0;
    covariance[j * (s->n + 1)] = HUGE_VAL;
}

/* Each column beyond the rank depends on the ones before: a change of its unknown is undone by changes z of theirs, R z
 * = its column. All unknowns that take part in such a change can't be told; a part of 1e-8 (of the lengths of the
 * columns) is rounding. */
static void flag_undetermined(struct solver *s, int rank, double *covariance) {
    int f = s->free;
    double *z = s->scratch;
    for (int c = rank; c < f; c++) {
        for (int k = 0; k < rank; k++) z[k] = s->triangle[c * f + k];
        for (int j = rank - 1; j >= 0; j--) {
            z[j] /= s->triangle[j * f + j];
            for (int k = 0; k < j; k++) z[k] -= s->triangle[j * f + k] * z[j];
        }
        for (int a = 0; a < rank; a++)
            if (fabs(z[a]) * s->free_norms[s->pivot[a]] > 1e-8 * s->free_norms[s->pivot[c]])
                undetermined(s, a, covariance);
        undetermined(s, c, covariance);
    }
}

int scree_lm_covariance(const scree_lm_problem *problem, const scree_lm_options *options, const double *x,
                        double *covariance, int *free, void *workspace) {
    scree_lm_options resolved = with_defaults(options, problem->unknowns);
    if (!makes_sense(problem, &resolved, x) || !workspace) return -1;
    struct solver s = start(problem, options, NULL, workspace);
    s.x = s.p; /* the solver writes to x only in steps, of which there are none here */
    memcpy(s.x, x, (size_t)s.n * sizeof(double));
    s.options.central = 1;
    s.norm = evaluate(&s, s.x, s.r, s.raw);
    for (int j = 0; j < s.n; j++) s.d[j] = 1.0;
    if (!(s.norm < HUGE_VAL) || linearise(&s) || measure(&s)) return -1;
    if (bounded(&s)) factor(&s, s.r);
    int rank = rank_of(&s);
    for (int k = 0; k < s.n * s.n; k++) covariance[k] = 0.0;
    for (int j = 0; free && j < s.n; j++) free[j] = !s.held[j];
    fill_covariance(&s, rank, covariance);
    flag_undetermined(&s, rank, covariance);
    return rank;
}
