/* Scenes in the loop of a fit: what they say where records were read, and the parameters that bring both together. */
#ifndef SCREE_CLI_FIT_MODEL_H
#define SCREE_CLI_FIT_MODEL_H

#include "engine/cli/fit_file.h"
#include "solver/lm.h"

enum fit_state {
    FIT_FREE = 0,
    FIT_HELD,         /* at a bound; how far the readings would let it move isn't known */
    FIT_UNDETERMINED, /* the readings don't tell it, alone or apart from others */
    FIT_ADRIFT        /* the fit ended without a minimum */
};

/* Arrays have an entry a parameter unless said otherwise, and are owned. */
struct fit_result {
    scree_lm_outcome outcome;
    long runs;                          /* of scenes */
    double *value, *error, *low, *high; /* standard error and confidence interval; NAN where there is none */
    enum fit_state *state;
    double *covariance;    /* of all pairs, as scree_lm_covariance gives it */
    double *misfit;        /* (simulated - measured)/deviation of every reading: by experiment, column, row */
    long freedom;          /* readings less parameters that they tell */
    double scatter;        /* root of the sum of squares of `misfit` over `freedom` */
    scree_trouble refused; /* why parameters that were tried couldn't be, the last time; status 0: all could */
};

/* Run experiment `k` with the parameters `x`, in steps of `step` s if that isn't 0 and the scene leaves the step to the
 * engine. `values` receives what the scene says at the times of the readings, column by column; `taken` the length of
 * its step if that was the engine's choice, else 0. Between two steps positions are interpolated by the cubic through
 * positions and velocities, velocities by its slope, spins by a straight line. Fails as the scene does, or if the
 * record reaches beyond its time. */
scree_status fit_simulate(const struct fit_file *file, int k, const double *x, double step, double *values,
                          double *taken, scree_trouble *trouble);

/* Adjust the parameters; `threads` scenes run at the same time, and change nothing but the time it takes. `progress`
 * (may be NULL) is called after every accepted step. Fails if the scenes can't be run at the start. The result is to be
 * freed in any case. */
scree_status fit_solve(const struct fit_file *file, int threads,
                       int (*progress)(void *context, const scree_lm_progress *progress), struct fit_result *result,
                       scree_trouble *trouble);
void fit_free_result(struct fit_result *result);

#endif
