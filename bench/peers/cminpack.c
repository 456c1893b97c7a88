/* cminpack's lmder (github.com/devernay/cminpack), the C translation of MINPACK. */
#include "bench/peers/peers.h"

#include <cminpack.h>

#include <stdlib.h>

struct state {
    const scree_lm_problem *problem;
    double *memory; /* residual, Jacobian, and lmder's arrays */
    int *pivot;
};

static void destroy(void *state) {
    struct state *s = state;
    if (!s) return;
    free(s->memory);
    free(s->pivot);
    free(s);
}

static void *create(const scree_lm_problem *problem) {
    size_t n = (size_t)problem->unknowns, m = (size_t)problem->residuals;
    struct state *s = calloc(1, sizeof *s);
    if (!s) return NULL;
    s->problem = problem;
    s->memory = calloc(m * n + 2 * m + 5 * n, sizeof *s->memory);
    s->pivot = calloc(n, sizeof *s->pivot);
    if (s->memory && s->pivot) return s;
    destroy(s);
    return NULL;
}

static int evaluate(void *context, int m, int n, const double *x, double *r, double *jacobian, int leading, int flag) {
    const scree_lm_problem *problem = context;
    (void)m, (void)n, (void)leading; /* leading is m */
    if (flag == 1) return problem->residual(problem->context, x, r) ? -1 : 0;
    return problem->jacobian(problem->context, x, jacobian) ? -1 : 0;
}

static struct peer_outcome solve(void *state, double tolerance, int evaluations, double *x) {
    struct state *s = state;
    int n = s->problem->unknowns, m = s->problem->residuals;
    double *j = s->memory, *r = j + m * n, *diagonal = r + m, *w = diagonal + n;
    struct peer_outcome outcome = {0};
    /* Scales from the columns (mode 1) and an initial factor of 100, as its easy interface chooses them. */
    int info = lmder(evaluate, (void *)s->problem, m, n, x, r, j, m, tolerance, tolerance, tolerance, evaluations,
                     diagonal, 1, 100.0, 0, &outcome.residual_calls, &outcome.jacobian_calls, s->pivot, w, w + n,
                     w + 2 * n, w + 3 * n, w + 4 * n);
    /* 1 to 4: a tolerance was met; 6 to 8: it was too small for further progress. */
    outcome.converged = (info >= 1 && info <= 4) || (info >= 6 && info <= 8);
    return outcome;
}

const struct peer peer_cminpack = {"cminpack lmder " SCREE_CMINPACK_VERSION, create, destroy, solve};
