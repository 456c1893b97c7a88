/* Sensitivities of a fixed profile: how clearance at the catch and final position change with what isn't known
 * exactly. */
#ifndef SCREE_SOLVER_SENSITIVITY_H
#define SCREE_SOLVER_SENSITIVITY_H

#include "solver/transport.h"

/* What may differ from the plan. */
enum scree_condition {
    SCREE_BY_FRICTION = 0, /* mu_k */
    SCREE_BY_PLAY,         /* m */
    SCREE_BY_START,        /* the product's lead before the rear tines at the start, m */
    SCREE_BY_STIFFNESS,    /* of the tines, N/m (process model only) */
    SCREE_BY_RESTITUTION,  /* of the tines */
    SCREE_CONDITIONS
};

/* "friction", "play", "start", "stiffness", "restitution". */
extern const char *const scree_condition_names[SCREE_CONDITIONS];

/* Outcome of one run, or its derivative with respect to a condition. */
typedef struct scree_outcome {
    double clearance; /* at event 3 before the front tines, m */
    double error;     /* final position beyond the target, m */
} scree_outcome;

/* Simulate the fixed profile under these conditions. Nonzero: it couldn't. */
typedef int scree_outcome_of(void *context, const double conditions[SCREE_CONDITIONS], scree_outcome *outcome);

/* Central differences (outcome(+step) - outcome(-step))/(2 step), for each condition with a step above 0; the others'
 * derivatives are 0. Nonzero if a run failed. */
int scree_sensitivities(scree_outcome_of *outcome, void *context, const double conditions[SCREE_CONDITIONS],
                        const double steps[SCREE_CONDITIONS], scree_outcome derivatives[SCREE_CONDITIONS]);

/* Closed forms for a rigid product between plastic tines:
 *   friction  d clearance = g (t3 - td)^2/2. The time td of the detachment moves too, but where the comb's
 *             acceleration is -mu g the product's path doesn't depend on it to first order.
 *             d error = -v^2/(2 mu^2 g), v the comb's velocity where its braking fades below friction for the last
 *             time and the product slides on alone; -g tau^2/18 at a time tau before the end, to leading order.
 *   play      1 and 1
 *   start     0 and 0: the rear tines pick the product up while it rests
 * The others are 0. Nonzero if the product doesn't leave the rear tines, or isn't caught for good. */
int scree_rigid_sensitivities(const scree_transport *transport, const scree_plan *plan,
                              scree_outcome derivatives[SCREE_CONDITIONS]);

#endif
