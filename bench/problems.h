/* Test problems of nonlinear least squares, shared by tests and benchmarks: the 27 of NIST's StRD and the 39 of More,
 * Garbow & Hillstrom, with analytic Jacobians. */
#ifndef SCREE_BENCH_PROBLEMS_H
#define SCREE_BENCH_PROBLEMS_H

#include "solver/lm.h"

enum { NIST_PROBLEMS = 27, NIST_PARAMETERS = 9, NIST_ROWS = 250, MGH_PROBLEMS = 39, MGH_UNKNOWNS = 40 };

/* A problem of NIST: model, data, starts, certified values, and the same optimum refined in quadruple precision. */
struct nist {
    const char *name;
    int parameters, rows;
    double start[2][NIST_PARAMETERS], certified[NIST_PARAMETERS], deviation[NIST_PARAMETERS];
    double refined[NIST_PARAMETERS]; /* of the value with 22 digits */
    double certified_rss;
    double x[2][NIST_ROWS], y[NIST_ROWS];
    /* Value of the model for one row; its derivatives into g. */
    double (*model)(const double *b, const double *x, double *g);
    int takes_log;              /* the response is ln y (Nelson) */
    int evaluations, jacobians; /* counted by the functions below */
};

/* Load problem `index` (0 … 26) from `folder`/nist. Returns 0, or 1 if the file can't be read. */
int nist_load(int index, const char *folder, struct nist *problem);

/* The problem for the solver; its context is `problem` itself. */
scree_lm_problem nist_problem(struct nist *problem);

/* Digits to which `b` agrees with the refined optimum: the least over the parameters, 17 at most. */
double nist_digits(const struct nist *problem, const double *b);

/* A problem of More, Garbow & Hillstrom. */
struct mgh {
    const char *name;
    int n, m;
    int starts;      /* standard start, also times 10, also times 100 */
    double minimum;  /* global minimum of the sum of squares */
    double local[2]; /* other minima, 0 if none */
    void (*start)(int n, double *x);
    void (*residual)(int n, int m, const double *x, double *r);
    void (*jacobian)(int n, int m, const double *x, double *j); /* by columns */
};

extern const struct mgh mgh_problems[MGH_PROBLEMS];

/* The problem for the solver; its context is `problem`. */
scree_lm_problem mgh_problem(const struct mgh *problem);

/* The standard start times 1, 10 or 100 (`run` 0 … 2); where that is zero, 1 times 10 or 100, as MINPACK's tests have
 * it. */
void mgh_start(const struct mgh *problem, int run, double *x);

enum mgh_kind { MGH_GLOBAL, MGH_LOCAL, MGH_NEITHER };

/* Which minimum x is, by its sum of squares (the limits are those in data/reference/mgh.csv). */
enum mgh_kind mgh_judge(const struct mgh *problem, const double *x);

#endif
