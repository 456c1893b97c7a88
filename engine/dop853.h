/* One step of Dormand & Prince's method of order 8 with error estimates of orders 5 and 3 (J. Comput. Appl. Math. 6
 * (1980) 19; the coefficients and the combined estimate: Hairer, Norsett & Wanner, Solving Ordinary Differential
 * Equations I, 2nd ed. 1993, section II.10). Knows nothing of scenes: what a step is measured by, how long the next one
 * is and where it should end is its caller's business. */
#ifndef SCREE_ENGINE_DOP853_H
#define SCREE_ENGINE_DOP853_H

#include <stddef.h>

/* dy/ds at y into `rates`. The variable s itself, where the right-hand side needs it, is one of the y. */
typedef void scree_dop853_rates(void *context, const double *y, double *rates);

enum { SCREE_DOP853_STAGES = 12 };

/* Room for steps of `size` unknowns; grows, never shrinks. All zero to begin with. */
struct scree_dop853 {
    size_t size, capacity;
    double *k[SCREE_DOP853_STAGES]; /* rates at the stages; k[0], at the start, is the caller's to set */
    double *stage;                  /* unknowns at a stage */
    double *end;                    /* where the step ends */
    double *error5, *error3;        /* estimates of its error */
    double *memory;
};

/* 0, or -1 if there is no memory. What the arrays hold is lost. */
int scree_dop853_resize(struct scree_dop853 *work, size_t size);
void scree_dop853_free(struct scree_dop853 *work);

/* Step from y by h, 11 evaluations; fills `end`, `error5` and `error3`. */
void scree_dop853_step(struct scree_dop853 *work, scree_dop853_rates *rates, void *context, const double *y, double h);

/* The estimate of the error from the sizes of both, in whatever norm, as combined in II.10 of that book. */
double scree_dop853_error(double error5, double error3);

#endif
