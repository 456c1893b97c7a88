/* Sensitivities of a fixed profile. */
#include "solver/sensitivity.h"

#include <string.h>

const char *const scree_condition_names[SCREE_CONDITIONS] = {"friction", "play", "start", "stiffness", "restitution"};

int scree_sensitivities(scree_outcome_of *outcome, void *context, const double conditions[SCREE_CONDITIONS],
                        const double steps[SCREE_CONDITIONS], scree_outcome derivatives[SCREE_CONDITIONS]) {
    for (int k = 0; k < SCREE_CONDITIONS; k++) {
        double moved[SCREE_CONDITIONS];
        scree_outcome above, below;
        derivatives[k] = (scree_outcome){0};
        if (!(steps[k] > 0.0)) continue;
        memcpy(moved, conditions, sizeof moved);
        moved[k] = conditions[k] + steps[k];
        if (outcome(context, moved, &above)) return 1;
        moved[k] = conditions[k] - steps[k];
        if (outcome(context, moved, &below)) return 1;
        derivatives[k].clearance = (above.clearance - below.clearance) / (2.0 * steps[k]);
        derivatives[k].error = (above.error - below.error) / (2.0 * steps[k]);
    }
    return 0;
}

int scree_rigid_sensitivities(const scree_transport *transport, const scree_plan *plan,
                              scree_outcome derivatives[SCREE_CONDITIONS]) {
    double mu = transport->friction, g = transport->gravity;
    double left = scree_slide_detachment(&plan->profile, mu * g), slide = plan->time[3] - left;
    double last = scree_slide_release(&plan->profile, mu * g, plan->time[3]);
    if (left < 0.0 || slide < 0.0 || last < 0.0) return 1;
    double v = scree_profile_at(&plan->profile, last).v;
    memset(derivatives, 0, SCREE_CONDITIONS * sizeof *derivatives);
    derivatives[SCREE_BY_FRICTION].clearance = 0.5 * g * slide * slide;
    derivatives[SCREE_BY_FRICTION].error = -0.5 * v * v / (mu * mu * g);
    derivatives[SCREE_BY_PLAY] = (scree_outcome){1.0, 1.0};
    return 0;
}
