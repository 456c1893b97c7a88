/* Trial impacts (trial.h): the reference, and the search along a ladder of steps. */
#include "engine/trial.h"

#include "bodies/elementary.h"
#include "contact/impact.h"
#include "engine/scene.h"

#include <math.h>
#include <stdlib.h>

/* Steps per contact of the ladder: from `coarsest` on, each sqrt(2) times those before. */
enum { RUNGS = 18, PHASES = 8 };
static const double coarsest = 10.3, root2 = 1.41421356237309504880;

/* The largest error over all phases of touch is above that over the eight tried ones. */
static const double margin = 1.25;

/* The tangential reference: pair impulses of four substeps. They are of second order there, so that a step twice as
 * long changes the result by three times its error. */
static const double reference_steps = 2000.0;
enum { REFERENCE_SUBSTEPS = 4 };

static const double cosine[SCREE_TRIAL_ANGLES] = {1.0, 0.86602540378443864676, 0.5};
static const double sine[SCREE_TRIAL_ANGLES] = {0.0, 0.5, 0.86602540378443864676};

/* One run: how it is stepped, and where in a step the sphere touches. */
struct throw {
    scree_integrator integrator;
    int substeps;
    double step, phase;
    int angle;
};

struct rebound {
    double normal, tangential; /* m/s; NAN: the run has stopped */
};

/* The scene, sphere before the plane, not yet baked. The rule lends its force table. */
static scree_status define(const struct scree_trial *trial, const struct throw *throw, scree_scene *scene) {
    double vn = trial->speed * cosine[throw->angle], gap = throw->phase * throw->step * vn;
    scree_status status = scree_scene_add_material(scene, &(scree_material_def){.name = "ball"}, NULL);
    if (!status) status = scree_scene_add_material(scene, &(scree_material_def){.name = "plane"}, NULL);
    const scree_body_def plane = {.name = "plane",
                                  .shape = {.kind = SCREE_PLANE},
                                  .material = 1,
                                  .joint = {.along = {SCREE_FIXED, SCREE_FIXED, SCREE_FIXED}, .turn = SCREE_FIXED}};
    const scree_body_def ball = {.name = "ball",
                                 .shape = {.kind = SCREE_SPHERE, .radius = trial->radius},
                                 .mass = trial->mass,
                                 .position = {0.0, 0.0, trial->radius + gap},
                                 .velocity = {trial->speed * sine[throw->angle], 0.0, -vn}};
    const scree_time_def time = {
        .step = throw->step, .integrator = throw->integrator, .substeps = throw->substeps, .force = 1};
    if (!status) status = scree_scene_add_body(scene, &plane, NULL);
    if (!status) status = scree_scene_add_body(scene, &ball, NULL);
    if (!status) status = scree_scene_set_time(scene, &time);
    if (status) return status;
    scene->rule = malloc(sizeof *scene->rule);
    if (!scene->rule) return scree_report(&scene->trouble, SCREE_NO_MEMORY, NULL, "no memory for a trial impact");
    scene->rule[0] = *trial->rule;
    scene->rule[0].material[0] = 0;
    scene->rule[0].material[1] = 1;
    scene->rule[0].share = trial->mass / trial->law_mass;
    scene->rules = scene->rule_capacity = 1;
    return SCREE_OK;
}

/* The sphere stays within sight from beginning to end, and may be pressed in as deep as it will: what limits the scene
 * proper is watched there. */
static scree_status widen(scree_scene *scene, double way) {
    scene->contacts.skin = fmax(scene->contacts.skin, 10.0 * way);
    scene->contacts.chosen_skin = scene->contacts.skin;
    scene->bodies.spin[1].limit = HUGE_VAL;
    return scree_contacts_list(&scene->contacts, &scene->bodies, 1, &scene->trouble);
}

static scree_status fly(const struct scree_trial *trial, const struct throw *throw, scree_scene *scene,
                        struct rebound *rebound) {
    long steps = (long)(1.05 * trial->duration[throw->angle] / throw->step) + 4;
    scree_status status = scree_scene_bake(scene);
    if (!status) status = widen(scene, trial->speed * throw->step * (double)(steps + 4));
    if (status) return status;
    *rebound = (struct rebound){NAN, NAN};
    status = scree_scene_step(scene, steps);
    if (status) return status == SCREE_FAILED ? SCREE_OK : status;
    scree_body_state end = scree_scene_body(scene, 1);
    *rebound = (struct rebound){end.velocity[2], end.velocity[0] - trial->radius * end.spin[1]};
    return SCREE_OK;
}

static scree_status strike(const struct scree_trial *trial, const struct throw *throw, struct rebound *rebound,
                           scree_trouble *trouble) {
    scree_scene *scene = scree_scene_create();
    if (!scene) return scree_report(trouble, SCREE_NO_MEMORY, NULL, "no memory for a trial impact");
    scree_status status = define(trial, throw, scene);
    if (!status) status = fly(trial, throw, scene, rebound);
    if (status) *trouble = *scree_scene_trouble(scene);
    if (scene->rules) scene->rule[0].normal_constants.table = NULL; /* was lent */
    scree_scene_destroy(scene);
    return status;
}

/* ---- the reference ---- */

/* The normal motion on a plane is the head-on impact's at that speed, whatever friction does. */
static void end_normally(struct scree_trial *trial, int angle) {
    const struct scree_normal_law *law = scree_normal_laws[trial->rule->normal];
    const struct scree_law_constants *constants = &trial->rule->normal_constants;
    struct scree_pair_constants pair = law->pair(constants, trial->law_mass, trial->radius);
    double speed = trial->speed * cosine[angle];
    struct scree_impact impact = scree_impact(law, constants, pair, trial->mass, speed, 0.0, NULL, NULL);
    trial->normal[angle] = impact.restitution * speed;
    trial->duration[angle] = impact.duration;
    trial->stays |= !(impact.restitution > 0.0);
}

static scree_status end_tangentially(struct scree_trial *trial, int angle, scree_trouble *trouble) {
    struct throw throw = {SCREE_PAIR_IMPULSE, REFERENCE_SUBSTEPS, trial->duration[0] / reference_steps, 0.3, angle};
    struct rebound fine, coarse;
    scree_status status = strike(trial, &throw, &fine, trouble);
    throw.step *= 2.0;
    if (!status) status = strike(trial, &throw, &coarse, trouble);
    if (status) return status;
    trial->tangential[angle] = fine.tangential;
    trial->doubt = scree_most(trial->doubt, fabs(fine.tangential - coarse.tangential) / 3.0);
    return SCREE_OK;
}

scree_status scree_trial_prepare(struct scree_trial *trial, scree_trouble *trouble) {
    scree_status status = SCREE_OK;
    trial->angles = trial->rule->friction >= 0 ? SCREE_TRIAL_ANGLES : 1;
    trial->stays = 0;
    trial->doubt = 0.0;
    for (int angle = 0; angle < trial->angles; angle++) end_normally(trial, angle);
    trial->tangential[0] = 0.0; /* head-on */
    for (int angle = 1; angle < trial->angles && !trial->stays && !status; angle++)
        status = end_tangentially(trial, angle, trouble);
    return status;
}

/* ---- the search ---- */

/* Phase and number of steps per contact of a throw: both go through a step, in different order, so that touch and
 * parting fall everywhere. */
static struct throw throw_of(const struct scree_trial *trial, scree_integrator integrator, int substeps,
                             double per_contact, int number) {
    double phase = (number + 0.5) / PHASES, shift = 0.6180339887498949 * (number + 0.5);
    double steps = per_contact - 0.5 + (shift - floor(shift));
    return (struct throw){integrator, substeps, trial->duration[0] / steps, phase, 0};
}

/* Largest error at so many steps per contact, in parts of the impact speed; the search for it ends beyond `enough`. */
static scree_status find_error(const struct scree_trial *trial, scree_integrator integrator, int substeps,
                               double per_contact, double enough, double *worst, scree_trouble *trouble) {
    *worst = 0.0;
    for (int number = 0; number < PHASES; number++)
        for (int angle = 0; angle < trial->angles; angle++) {
            struct throw throw = throw_of(trial, integrator, substeps, per_contact, number);
            struct rebound end;
            throw.angle = angle;
            scree_status status = strike(trial, &throw, &end, trouble);
            if (status) return status;
            double error = fabs(end.normal - trial->normal[angle]);
            if (trial->angles > 1)
                error = scree_most(error, fabs(end.tangential - trial->tangential[angle]) + trial->doubt);
            error *= margin / trial->speed;
            if (!(error < HUGE_VAL)) error = HUGE_VAL; /* or no number */
            *worst = fmax(*worst, error);
            if (*worst > enough) return SCREE_OK;
        }
    return SCREE_OK;
}

scree_status scree_trial_search(const struct scree_trial *trial, scree_integrator integrator, int substeps,
                                double accuracy, struct scree_trial_result *result, scree_trouble *trouble) {
    double per_contact = coarsest, error, before = HUGE_VAL;
    for (int rung = 0; rung < RUNGS; rung++, per_contact *= root2) {
        double enough = rung == RUNGS - 1 ? HUGE_VAL : accuracy;
        scree_status status = find_error(trial, integrator, substeps, per_contact, enough, &error, trouble);
        if (status) return status;
        *result = (struct scree_trial_result){0, trial->duration[0] / per_contact, per_contact, error};
        if (before <= accuracy && error <= accuracy) {
            *result = (struct scree_trial_result){1, root2 * result->step, per_contact / root2, before};
            return SCREE_OK;
        }
        before = error;
    }
    return SCREE_OK;
}
