/* Other people's least-squares solvers behind one face, for comparison in benchmarks. Each is there only if it was
 * found when the build was set up; nothing else needs them. */
#ifndef SCREE_BENCH_PEERS_H
#define SCREE_BENCH_PEERS_H

#include "solver/lm.h"

struct peer_outcome {
    int residual_calls, jacobian_calls;
    int converged; /* what the solver claims */
};

struct peer {
    const char *name; /* library, function and version */
    /* Whatever a solver wants to have allocated before; NULL if memory is short. The problem must have an analytic
     * Jacobian and outlive it. */
    void *(*create)(const scree_lm_problem *problem);
    void (*destroy)(void *state);
    /* Minimise from x, which receives the result. All tolerances that the solver knows are `tolerance`. */
    struct peer_outcome (*solve)(void *state, double tolerance, int evaluations, double *x);
};

extern const struct peer peer_cminpack, peer_gsl;

#endif
