/* Trial impacts: what step a contact needs so that velocities after an impact are right within a wanted accuracy.
 *
 * A sphere is thrown at a fixed plane under the laws of a contact, in a small scene of its own that the engine steps as
 * it steps any other; what it leaves with is compared with a reference, over steps of a ladder and phases of first
 * touch. */
#ifndef SCREE_ENGINE_TRIAL_H
#define SCREE_ENGINE_TRIAL_H

#include "contact/catalogue.h"
#include "engine/scree.h"

enum { SCREE_TRIAL_ANGLES = 3 };

/* An impact to try; then what is known of its end. */
struct scree_trial {
    const struct scree_rule *rule;
    double mass;     /* kg, of the sphere: the effective mass with which the pair meets */
    double law_mass; /* kg, from which the laws take their constants */
    double radius;   /* m */
    double speed;    /* m/s */
    /* Set by scree_trial_prepare. */
    int angles;                            /* 0, 30, 60 degrees; without friction the first alone */
    double duration[SCREE_TRIAL_ANGLES];   /* of the contact, s */
    double normal[SCREE_TRIAL_ANGLES];     /* speed of parting, m/s */
    double tangential[SCREE_TRIAL_ANGLES]; /* velocity of the contact point, m/s */
    double doubt;                          /* by which the tangential ones may be wrong, m/s */
    int stays;                             /* 1: the bodies don't part, and there is nothing to compare */
};

/* What a search has found. */
struct scree_trial_result {
    int reached;        /* the accuracy is */
    double step;        /* s: the longest that does, or the shortest tried */
    double per_contact; /* steps in the head-on impact */
    double error;       /* largest found, in parts of the impact speed */
};

/* Find out how the impact ends. SCREE_NO_MEMORY. */
scree_status scree_trial_prepare(struct scree_trial *trial, scree_trouble *trouble);

/* Search the longest step with which every trial ends within `accuracy` (in parts of the impact speed), and still does
 * with the next shorter one. For a prepared trial that doesn't stay. SCREE_NO_MEMORY. */
scree_status scree_trial_search(const struct scree_trial *trial, scree_integrator integrator, int substeps,
                                double accuracy, struct scree_trial_result *result, scree_trouble *trouble);

#endif
