/* Nonlinear least squares: minimise F(x) = |r(x)|^2/2 for small dense problems, by Levenberg and Marquardt's method in
 * the trust-region form of More (Numerical Analysis, Lecture Notes in Mathematics 630, 1978, p. 105), with bounds by an
 * active set and a Gauss-Newton polish.
 *
 * The contract. The caller owns all memory: x, the workspace, the problem and its context; nothing is allocated and
 * nothing is kept between calls, so solves may run in many threads. Every outcome has a reason: `converged` outcomes
 * are told apart from `stuck` ones, and a residual that isn't finite is never taken for progress. */
#ifndef SCREE_SOLVER_LM_H
#define SCREE_SOLVER_LM_H

#include <stddef.h>

/* Residuals at x into r (`residuals` entries). Nonzero: x can't be evaluated, which counts like a result that isn't
 * finite. */
typedef int scree_lm_residual(void *context, const double *x, double *r);

/* Jacobian at x by columns: column j (d r/d x_j, `residuals` entries) at jacobian + j * residuals. Nonzero as above. */
typedef int scree_lm_jacobian(void *context, const double *x, double *jacobian);

enum { SCREE_LM_UNKNOWNS = 256 }; /* most unknowns */

typedef struct scree_lm_problem {
    int unknowns;  /* n, 1 to SCREE_LM_UNKNOWNS */
    int residuals; /* m >= n */
    scree_lm_residual *residual;
    scree_lm_jacobian *jacobian; /* NULL: finite differences */
    void *context;               /* handed to both */
    const double *lower, *upper; /* bounds on x, NULL or -/+HUGE_VAL where there are none; lower <= upper */
} scree_lm_problem;

typedef enum scree_lm_loss {
    SCREE_LM_SQUARES = 0, /* r^2 */
    SCREE_LM_HUBER,       /* r^2 up to the scale c, 2 c |r| - c^2 beyond (Huber, Ann. Math. Stat. 35 (1964) 73) */
    SCREE_LM_CAUCHY       /* c^2 ln(1 + r^2/c^2) */
} scree_lm_loss;

/* What a callback sees after every accepted step. */
typedef struct scree_lm_progress {
    int iteration;
    double norm;   /* |r| */
    double step;   /* |D p| of the last step */
    double radius; /* trust radius */
    double par;    /* Levenberg-Marquardt parameter */
    double cosine; /* largest cosine between residual and a free column of the Jacobian, where the step began */
    const double *x;
    const double *r;
} scree_lm_progress;

/* Zero means the default. */
typedef struct scree_lm_options {
    double reduction; /* stop when actual and predicted relative reduction of F are below it; 1e-10 */
    double radius;    /* … when the trust radius is below it times |D x|; 1e-12 */
    double cosine;    /* … when the largest cosine is below it; 1e-14 */
    double first;     /* initial radius in parts of |D x0|, of |r| where x0 = 0; 0.28, chosen on three collections of
                          test problems: of NIST's 54 runs values from 0.1 to 1 solve 50 to 54 */
    int evaluations; /* most calls of the residual, all counted (differences that fail on one side may add some); 200 (n
                        + 1) */
    int central;     /* central instead of forward differences */
    const double *
        typical; /* sizes of the unknowns, for difference steps where x_j is smaller; NULL: |x_j|, or 1 where x_j = 0 */
    int no_polish;    /* leave out the Gauss-Newton steps at the end */
    int acceleration; /* geodesic acceleration (Transtrum & Sethna 2012): one more residual a step; not with bounds */
    scree_lm_loss loss;
    double scale;                                                      /* c of the loss, > 0 */
    int (*callback)(void *context, const scree_lm_progress *progress); /* nonzero stops */
    void *callback_context;
} scree_lm_options;

typedef enum scree_lm_reason {
    SCREE_LM_BY_REDUCTION, /* converged: F can't be reduced further by a relative amount that matters */
    SCREE_LM_BY_RADIUS,    /* converged: the steps have become small, and the residual is orthogonal to the Jacobian */
    SCREE_LM_BY_COSINE,    /* converged: the residual is orthogonal to the free columns of the Jacobian, or vanishes */
    SCREE_LM_STUCK,       /* not converged: steps have become small though the gradient hasn't (noise, wrong Jacobian, a
                             cliff) */
    SCREE_LM_RUN_AWAY,    /* not converged: an unknown has run to where it has no influence any more */
    SCREE_LM_EVALUATIONS, /* not converged: the evaluations are used up */
    SCREE_LM_STOPPED,     /* by the callback */
    SCREE_LM_NOT_FINITE,  /* the residual or Jacobian at the start isn't finite */
    SCREE_LM_BAD_INPUT    /* sizes, tolerances or bounds that make no sense; x is unchanged */
} scree_lm_reason;

typedef struct scree_lm_outcome {
    scree_lm_reason reason;
    int converged;      /* 1 for the first three reasons */
    int iterations;     /* accepted steps */
    int residual_calls; /* differences counted */
    int jacobian_calls; /* analytic ones, or sets of differences */
    int polish_steps;   /* Gauss-Newton steps taken at the end */
    int rank;           /* of the free columns of the last Jacobian; below their number: the minimum isn't isolated */
    int free;           /* unknowns not held by a bound at the end */
    double norm;        /* |r| at the end (after the loss) */
    double cosine;      /* largest cosine between residual and a free column where the last Jacobian was taken */
    double last_step;   /* |D p|/|D x| of the last Gauss-Newton step: an estimate of the relative error of x */
} scree_lm_outcome;

/* Workspace of a problem with n unknowns and m residuals in doubles, for an array of constant size; */
#define SCREE_LM_DOUBLES(n, m) (2 * (m) * (n) + 5 * (m) + 3 * (n) * (n) + 20 * (n))

/* and in bytes, 0 for sizes that make no sense; its memory must be aligned as malloc's. */
size_t scree_lm_workspace(int unknowns, int residuals);

/* Minimise from x, which receives the result; `options` may be NULL. */
scree_lm_outcome scree_lm_solve(const scree_lm_problem *problem, const scree_lm_options *options, double *x,
                                void *workspace);

/* "converged: …" for people. */
const char *scree_lm_text(scree_lm_reason reason);

/* Covariance of x (n x n, row by row) at a solution: s^2 (J^T J)^-1 with s^2 = |r|^2/(m - rank), for the free unknowns;
 * rows and columns of unknowns held by a bound are zero. An unknown that the data don't determine, alone or only
 * together with others, has HUGE_VAL on the diagonal and zeros beside it. `free` (n entries, may be NULL) receives 1
 * for unknowns that are free. Returns the rank, -1 for bad input or if the residual or Jacobian isn't finite there. The
 * loss of the options counts. */
int scree_lm_covariance(const scree_lm_problem *problem, const scree_lm_options *options, const double *x,
                        double *covariance, int *free, void *workspace);

#endif
