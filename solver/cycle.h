/* The comb's closed path over a whole machine cycle: forward with the tines in the plane (the planned profile), then
 * out of the plane, back, and in again. Position, velocity and acceleration are continuous, over the end of the cycle
 * too. */
#ifndef SCREE_SOLVER_CYCLE_H
#define SCREE_SOLVER_CYCLE_H

#include "solver/profile.h"

/* Zero means the default, where there is one. */
typedef struct scree_cycle_def {
    double cycles;  /* operating speed, 1/min */
    double lift;    /* out of the plane, m; negative: downwards, through the slot; not 0 */
    double share;   /* of the return's time for leaving the plane, and the same for coming back; 0 … 1/2; 0: 1/3 */
    double overlap; /* part of leaving during which the comb already moves back, and of coming back during which it
                       still does; 0 … 1. The tines must have cleared the product: compare scree_cycle.departure with
                       its height */
} scree_cycle_def;

typedef struct scree_cycle {
    char text[160];         /* what is wrong, "" if nothing */
    double duration;        /* s, 60/cycles */
    double forward;         /* s, end of the forward stroke */
    double departure;       /* lift at which the comb begins to move back, m; by symmetry that at which it ends, too */
    struct scree_profile x; /* along the conveying direction, m */
    struct scree_profile z; /* lift, m */
} scree_cycle;

/* The cycle from the comb's forward profile, which starts at time 0, begins and ends at rest and without acceleration,
 * and takes less than the cycle. Lift and return are quintics from rest to rest. 0, or 1 with the cause in
 * `cycle->text`. */
int scree_cycle_make(const scree_cycle_def *def, const struct scree_profile *forward, scree_cycle *cycle);

/* Both coordinates at any time, periodic. */
void scree_cycle_at(const scree_cycle *cycle, double time, struct scree_kinematics *x, struct scree_kinematics *z);

#endif
