/* GSL's gsl_multifit_nlinear (gnu.org/software/gsl) with its method "lm" and what else it takes by default. */
#include "bench/peers/peers.h"

#include <gsl/gsl_errno.h>
#include <gsl/gsl_multifit_nlinear.h>

#include <stdlib.h>

struct state {
    const scree_lm_problem *problem;
    gsl_multifit_nlinear_workspace *workspace;
    gsl_vector *start;
    double *columns; /* the Jacobian before it is turned into GSL's rows */
};

static void destroy(void *state) {
    struct state *s = state;
    if (!s) return;
    if (s->workspace) gsl_multifit_nlinear_free(s->workspace);
    if (s->start) gsl_vector_free(s->start);
    free(s->columns);
    free(s);
}

static void *create(const scree_lm_problem *problem) {
    size_t n = (size_t)problem->unknowns, m = (size_t)problem->residuals;
    gsl_multifit_nlinear_parameters parameters = gsl_multifit_nlinear_default_parameters();
    gsl_set_error_handler_off();
    struct state *s = calloc(1, sizeof *s);
    if (!s) return NULL;
    s->problem = problem;
    s->workspace = gsl_multifit_nlinear_alloc(gsl_multifit_nlinear_trust, &parameters, m, n);
    s->start = gsl_vector_alloc(n);
    s->columns = calloc(m * n, sizeof *s->columns);
    if (s->workspace && s->start && s->columns) return s;
    destroy(s);
    return NULL;
}

static int residual(const gsl_vector *x, void *context, gsl_vector *r) {
    const struct state *s = context;
    return s->problem->residual(s->problem->context, x->data, r->data) ? GSL_EDOM : GSL_SUCCESS;
}

static int jacobian(const gsl_vector *x, void *context, gsl_matrix *rows) {
    const struct state *s = context;
    size_t n = rows->size2, m = rows->size1;
    if (s->problem->jacobian(s->problem->context, x->data, s->columns)) return GSL_EDOM;
    for (size_t k = 0; k < m; k++)
        for (size_t j = 0; j < n; j++) rows->data[k * rows->tda + j] = s->columns[j * m + k];
    return GSL_SUCCESS;
}

static struct peer_outcome solve(void *state, double tolerance, int evaluations, double *x) {
    struct state *s = state;
    size_t n = (size_t)s->problem->unknowns;
    gsl_multifit_nlinear_fdf problem = {
        .f = residual, .df = jacobian, .n = (size_t)s->problem->residuals, .p = n, .params = s};
    int info = 0;
    for (size_t k = 0; k < n; k++) gsl_vector_set(s->start, k, x[k]);
    int status = gsl_multifit_nlinear_init(s->start, &problem, s->workspace);
    if (!status)
        status = gsl_multifit_nlinear_driver((size_t)evaluations, tolerance, tolerance, tolerance, NULL, NULL, &info,
                                             s->workspace);
    for (size_t k = 0; k < n; k++) x[k] = gsl_vector_get(gsl_multifit_nlinear_position(s->workspace), k);
    /* GSL_ENOPROG: no step within its tries reduces the sum, as at a minimum with tolerances of machine precision. */
    return (struct peer_outcome){(int)problem.nevalf, (int)problem.nevaldf,
                                 status == GSL_SUCCESS || status == GSL_ENOPROG};
}

const struct peer peer_gsl = {"GSL lm " SCREE_GSL_VERSION, create, destroy, solve};
