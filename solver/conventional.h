/* The conventional motion of a comb and a rigid product: the comb rises from rest to rest over the whole stroke, pushes
 * the product, and loses it where it brakes harder than friction does. Closed forms, apart from two roots. */
#ifndef SCREE_SOLVER_CONVENTIONAL_H
#define SCREE_SOLVER_CONVENTIONAL_H

#include "solver/rise.h"

/* A rise-to-dwell law over u = t/T, with T = 60 r/n at n cycles a minute. */
struct scree_conventional {
    double stroke;          /* s, in m; > 0 */
    double share;           /* r, of the cycle; > 0 */
    double friction;        /* mu_k between product and surface; > 0 */
    double gravity;         /* m/s^2; > 0 */
    enum scree_cam_law law; /* quintic unless told */
};

/* Duration of the rise at n cycles a minute, s. */
double scree_conventional_duration(const struct scree_conventional *motion, double cycles);

/* Position (m), velocity (m/s) and acceleration (m/s^2) of the comb at time t (s) after the start. */
void scree_conventional_at(const struct scree_conventional *motion, double cycles, double time, double *position,
                           double *velocity, double *acceleration);

/* Cycles a minute up to which the product never leaves the comb: where the largest deceleration
 * equals that of friction. For the quintic, whose largest one is (10/sqrt 3) s/T^2: 60 r sqrt(sqrt(3) mu g/(10 s)). */
double scree_conventional_limit(const struct scree_conventional *motion);

/* Time at which the product leaves the comb (s), or the end of the rise if it never does. */
double scree_conventional_detachment(const struct scree_conventional *motion, double cycles);

/* How far the product slides beyond its place, m; 0 where the comb catches up with it again. */
double scree_conventional_error(const struct scree_conventional *motion, double cycles);

/* Cycles a minute at which that error reaches `tolerance` (m, > 0 and finite); NAN if that or the motion makes no
 * sense. */
double scree_conventional_critical(const struct scree_conventional *motion, double tolerance);

#endif
