/* The step, from the stiffest contact that can happen or from the accuracy asked for, and the integrator. */
#include "engine/plan.h"

#include <math.h>
#include <stdlib.h>

/* Steps per duration of the shortest contact that step = "auto" asks for, and the share of the stability limit that
 * it never exceeds: of a lone pair with Verlet, of a body among twelve others with pair impulses. */
static const double steps_per_contact = 50.0, share_of_limit = 0.2, share_of_impulse_limit = 0.5;

enum { few_spheres = 1000 };

/* Time of a step of pair impulses over that of a Verlet step, without and with friction, for choosing between them: of
 * impacts 3.2 to 4.3 and 5 to 8, of a box that slides 16 (scree-bench precision, data/bench/precision.csv). */
static const double cost_of_impulses[2] = {3.5, 10.0};

/* ---- the step by accuracy ---- */

static scree_status prepare_trials(struct scree_scene *scene) {
    for (int k = 0; k < scene->contacts.rules; k++) {
        struct scree_rule_trial *trial = &scene->plan.trial[k];
        if (trial->pair[0] < 0) continue;
        trial->impact.speed = scene->plan.choice.speed;
        scree_status status = scree_trial_prepare(&trial->impact, &scene->trouble);
        if (status) return status;
    }
    return SCREE_OK;
}

/* The rule that keeps farthest from the accuracy with this integrator; NULL: all reach it. */
static const struct scree_rule_trial *farthest(const struct scree_scene *scene, scree_integrator integrator) {
    const struct scree_rule_trial *worst = NULL;
    for (int k = 0; k < scene->contacts.rules; k++) {
        const struct scree_rule_trial *trial = &scene->plan.trial[k];
        if (trial->pair[0] < 0 || trial->impact.stays || trial->result[integrator].reached) continue;
        if (!worst || trial->result[integrator].error > worst->result[integrator].error) worst = trial;
    }
    return worst;
}

/* The longest step with which the scene's integrator is accurate enough, s; where bodies stay together, that of step =
 * "auto". */
static scree_status find_accurate(struct scree_scene *scene) {
    const struct scree_time_def *time = &scene->time;
    scene->plan.choice.accurate = HUGE_VAL;
    for (int k = 0; k < scene->contacts.rules; k++) {
        struct scree_rule_trial *trial = &scene->plan.trial[k];
        struct scree_trial_result *result = &trial->result[time->integrator];
        if (trial->pair[0] < 0) continue;
        int substeps = time->integrator == SCREE_PAIR_IMPULSE ? time->substeps : 0;
        double step = trial->duration / steps_per_contact;
        if (!trial->impact.stays) {
            scree_status status =
                scree_trial_search(&trial->impact, time->integrator, substeps, time->accuracy, result, &scene->trouble);
            if (status) return status;
            step = result->step;
        }
        scene->plan.choice.accurate = fmin(scene->plan.choice.accurate, step);
    }
    return SCREE_OK;
}

static double stable_share(const struct scree_scene *scene) {
    double share = scene->time.integrator == SCREE_PAIR_IMPULSE ? share_of_impulse_limit : share_of_limit;
    return share * scene->plan.choice.limit;
}

/* Few spheres: each impact counts, and pair impulses give it more digits for the time it takes. Many, in steady
 * contact, are computed for their mean, which Verlet gets faster; boxes keep more of their energy with it
 * (data/bench/collide.csv). */
static scree_integrator integrator_for(const struct scree_scene *scene) {
    const struct scree_bodies *bodies = &scene->bodies;
    int boxes = 0;
    for (int k = 0; k < bodies->count; k++) {
        const struct scree_kind *kind = scree_kind_of(bodies, k);
        boxes |= scree_joint_can_move(&kind->joint) && kind->shape.kind != SCREE_SPHERE;
    }
    return !boxes && scene->plan.free <= few_spheres ? SCREE_PAIR_IMPULSE : SCREE_VERLET;
}

/* Time per simulated second with the scene's integrator, in Verlet steps. */
static double cost_of_run(const struct scree_scene *scene) {
    double step = fmin(scene->plan.choice.accurate, stable_share(scene));
    int friction = 0;
    for (int k = 0; k < scene->contacts.rules; k++) friction |= scene->contacts.rule[k].friction >= 0;
    return (scene->time.integrator == SCREE_PAIR_IMPULSE ? cost_of_impulses[friction] : 1.0) / step;
}

static scree_status out_of_reach(struct scree_scene *scene) {
    int impulses = scene->plan.any_integrator || scene->time.integrator == SCREE_PAIR_IMPULSE;
    scree_integrator integrator = impulses ? SCREE_PAIR_IMPULSE : SCREE_VERLET;
    const struct scree_rule_trial *worst = farthest(scene, integrator);
    const struct scree_trial_result *result = &worst->result[integrator];
    return scree_report(&scene->trouble, SCREE_BAD_INPUT, "accuracy",
                        "an accuracy of %g can't be reached with the integrator %s: an impact of \"%s\" with \"%s\" at "
                        "%g m/s comes out within %.2g of its speed at %.0f steps per contact; ask for less%s",
                        scene->time.accuracy, impulses ? "pair-impulse" : "verlet",
                        scree_name_of(scene, worst->pair[0]).text, scree_name_of(scene, worst->pair[1]).text,
                        scene->plan.choice.speed, result->error, result->per_contact,
                        !impulses                    ? ", or take integrator = \"pair-impulse\""
                        : scene->plan.any_integrator ? ""
                        : scene->time.substeps < 4   ? ", or take substeps = 4"
                                                     : "");
}

/* Let trial impacts say how long a step may be, and which integrator is the cheaper if none is given. */
static scree_status choose_by_accuracy(struct scree_scene *scene, const struct scree_species *species) {
    struct scree_step_choice *choice = &scene->plan.choice, best = {0};
    static const scree_integrator integrators[] = {SCREE_VERLET, SCREE_PAIR_IMPULSE};
    scree_integrator wanted = scene->time.integrator, taken = wanted;
    double least = HUGE_VAL;
    int found = 0;
    scree_status status = prepare_trials(scene);
    for (int k = 0; k < 2 && !status; k++) {
        if (!scene->plan.any_integrator && integrators[k] != wanted) continue;
        scene->time.integrator = integrators[k];
        scree_find_limits(scene, species, choice);
        status = find_accurate(scene);
        double cost = cost_of_run(scene);
        if (farthest(scene, integrators[k]) || (found && !(cost < least))) continue;
        least = cost;
        best = *choice;
        taken = integrators[k];
        found = 1;
    }
    scene->time.integrator = taken;
    if (status) return status;
    if (!found) return out_of_reach(scene);
    *choice = best;
    return SCREE_OK;
}

/* Room for the trials of all rules. */
static scree_status make_trials(struct scree_scene *scene) {
    struct scree_rule_trial *trial = calloc((size_t)scene->contacts.rules + 1, sizeof *trial);
    if (!trial) return scree_report(&scene->trouble, SCREE_NO_MEMORY, NULL, "no memory for trial impacts");
    for (int k = 0; k < scene->contacts.rules; k++) trial[k].pair[0] = -1;
    scene->plan.trial = trial;
    return SCREE_OK;
}

static double automatic_step(struct scree_scene *scene) {
    const struct scree_time_def *time = &scene->time;
    struct scree_step_choice *choice = &scene->plan.choice;
    double step = time->accuracy > 0.0 ? choice->accurate : choice->duration / steps_per_contact;
    double most = stable_share(scene);
    choice->bound_by_damping = most < step;
    if (choice->bound_by_damping) step = most;
    if (!(step < HUGE_VAL)) step = time->divide > 0.0 ? time->divide / 100.0 : 1e-3; /* nothing can touch */
    if (time->divide > 0.0) step = time->divide / ceil(time->divide / step);
    return step;
}

/* No step: who is to blame. */
static scree_status too_stiff(struct scree_scene *scene, const int pair[2]) {
    const struct scree_rule *rule = scree_contacts_rule(&scene->contacts, &scene->bodies, pair[0], pair[1], NULL);
    return scree_report(&scene->trouble, SCREE_BAD_INPUT, "step",
                        "the contact of \"%s\" with \"%s\" (%s, %s%s%s) is so stiff or so damped at %g m/s that no "
                        "step is short enough",
                        scree_name_of(scene, pair[0]).text, scree_name_of(scene, pair[1]).text,
                        scree_normal_laws[rule->normal]->text.name,
                        rule->friction >= 0 ? scree_friction_laws[rule->friction]->text.name : "frictionless",
                        rule->rolling >= 0 ? ", rolling " : "",
                        rule->rolling >= 0 ? scree_rolling_laws[rule->rolling]->text.name : "",
                        scene->plan.choice.speed);
}

scree_status scree_choose_step(struct scree_scene *scene, const struct scree_species *species) {
    struct scree_step_choice *choice = &scene->plan.choice;
    const struct scree_time_def *time = &scene->time;
    scene->plan.any_integrator = time->integrator == SCREE_ANY_INTEGRATOR;
    if (scene->plan.any_integrator)
        scene->time.integrator = scene->time.sleep > 0.0 ? SCREE_VERLET : integrator_for(scene);
    choice->speed_given = time->speed > 0.0;
    choice->speed = choice->speed_given ? time->speed : scree_estimate_speed(scene);
    if (!isfinite(choice->speed * choice->speed))
        return scree_report(&scene->trouble, SCREE_BAD_INPUT, "speed",
                            "the speed to reckon with, %g m/s, is beyond what numbers hold: bodies, their tips or "
                            "motions are too fast, or fall from too high",
                            choice->speed);
    scree_status status = time->accuracy > 0.0 ? make_trials(scene) : SCREE_OK;
    if (status) return status;
    scree_find_limits(scene, species, choice);
    if (time->accuracy > 0.0) status = choose_by_accuracy(scene, species);
    if (status) return status;
    choice->automatic = time->step == 0.0;
    choice->step = choice->automatic ? automatic_step(scene) : time->step;
    int adaptive = time->integrator == SCREE_ADAPTIVE;
    const int *blame = choice->bound_by_damping ? choice->limit_pair : choice->shortest_pair;
    if (choice->automatic && !adaptive && !isnormal(choice->step) && blame[0] >= 0) return too_stiff(scene, blame);
    if (adaptive && choice->automatic) choice->step = time->divide > 0.0 ? time->divide : 1e-3;
    scene->step = choice->step;
    if (adaptive) return SCREE_OK; /* its own steps are as small as they must be */
    if (choice->step <= choice->limit || time->force) return SCREE_OK;
    return scree_report(
        &scene->trouble, SCREE_BAD_INPUT, "step",
        "a step of %g s is beyond the stability limit of the stiffest contact, %g s (\"%s\" with \"%s\" at "
        "%g m/s); take a smaller one or step = \"auto\", or set force = true",
        choice->step, choice->limit, scree_name_of(scene, choice->limit_pair[0]).text,
        scree_name_of(scene, choice->limit_pair[1]).text, choice->speed);
}
