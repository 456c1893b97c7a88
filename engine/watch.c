/* The watch that halves the step: a run that goes wrong goes back to where it was last kept in memory, and on with half
 * the step.
 *
 * The state is kept where a call of scree_scene_step begins, so that nothing that a caller has seen is taken back, and
 * every so many steps. Times are whole numbers of steps, and half a step is exact in binary: twice the number of half
 * the step is the same instant in every bit. */
#include "engine/scene.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { STEPS_KEPT = 1000, FIRST_STEPS = 2 };

const double scree_tolerable_gap = 0.1;

/* A state that the next step would stop at isn't worth keeping. */
static scree_status check_state(scree_scene *scene) {
    for (int k = 0; k < scene->bodies.count; k++) {
        int number = scene->bodies.number[k];
        const struct scree_state *state = &scene->bodies.state[k];
        double way = vec_norm(vec_from(state->v)) * scene->step;
        int is_number = scree_is_finite(scene->bodies.position[k]) && scree_is_finite(state->l);
        if (is_number && way <= scene->contacts.chosen_skin) continue;
        return scree_scene_stop(scene, scree_scene_time(scene), number, -1,
                                "it is no longer where numbers reach, or moves too far in a step to be watched; the "
                                "step is too large or a contact too stiff");
    }
    return SCREE_OK;
}

/* ---- the books ---- */

static double lost(const scree_energy *energy) { return energy->lost_normal + energy->lost_tangential; }

static double moving(const scree_energy *energy) { return energy->kinetic + energy->rotational; }

/* Look at the books from here on. */
static scree_status begin_watch(scree_scene *scene) {
    struct scree_watched *watched = &scene->watched;
    scree_energy energy;
    scree_status status = scree_scene_energy(scene, &energy);
    if (status) return status;
    *watched = (struct scree_watched){.halvings = watched->halvings,
                                      .lacking = watched->lacking,
                                      .begun = 1,
                                      .since = scree_scene_time(scene),
                                      .balance = energy.balance,
                                      .lost = lost(&energy),
                                      .driven = energy.driven,
                                      .motion = moving(&energy),
                                      .least_stored = energy.stored,
                                      .most_stored = energy.stored};
    return SCREE_OK;
}

double scree_turned_over(struct scree_watched *watched, const scree_energy *energy) {
    watched->motion = fmax(watched->motion, moving(energy));
    watched->least_stored = fmin(watched->least_stored, energy->stored);
    watched->most_stored = fmax(watched->most_stored, energy->stored);
    return fmax(watched->motion, watched->most_stored - watched->least_stored) + fabs(lost(energy) - watched->lost) +
           fabs(energy->driven - watched->driven);
}

/* Rounding, and a millionth of the fastest impact's energy, since what was turned over since a first touch begins with
 * nothing. */
double scree_too_little(const scree_scene *scene, const scree_energy *energy) {
    const struct scree_step_choice *choice = &scene->plan.choice;
    const int *pair = choice->shortest_pair, *place = scene->bodies.place;
    double mass = pair[0] >= 0 ? scree_effective_mass(&scene->bodies, place[pair[0]], place[pair[1]]) : 0.0;
    return 0.5e-6 * mass * choice->speed * choice->speed +
           1e-11 * (energy->stored + fabs(energy->potential) + fabs(lost(energy)) + fabs(energy->driven));
}

/* Books are judged after a contact's time at the earliest. */
static int can_judge(const scree_scene *scene) {
    return scree_scene_time(scene) - scene->watched.since >= scene->plan.choice.duration;
}

/* The share by which they are off; 0 if that is too early or too little to say. */
static double gap_of(scree_scene *scene, const scree_energy *energy) {
    double turned = scree_turned_over(&scene->watched, energy), gap = fabs(energy->balance - scene->watched.balance);
    return can_judge(scene) && !(gap <= scree_too_little(scene, energy)) ? gap / turned : 0.0;
}

double scree_books_lack(scree_scene *scene) {
    scree_energy energy;
    if (scree_scene_energy(scene, &energy)) return 0.0;
    return scene->watched.lacking + gap_of(scene, &energy);
}

/* SCREE_FAILED if the books are off, since the start or the last halving, by too large a share of what was turned
 * over. */
static scree_status check_books(scree_scene *scene) {
    scree_energy energy;
    scree_status status = scree_scene_energy(scene, &energy);
    if (status) return status;
    double gap = energy.balance - scene->watched.balance, share = gap_of(scene, &energy);
    if (share <= scree_tolerable_gap) return SCREE_OK; /* a NaN isn't */
    char cause[160];
    snprintf(cause, sizeof cause, "%.3g J of energy have %s, %.3g %% of what was turned over: too long a step",
             fabs(gap), gap < 0.0 ? "vanished" : "come from nowhere", 100.0 * share);
    return scree_scene_stop(scene, scree_scene_time(scene), -1, -1, cause);
}

/* ---- back and on ---- */

static scree_status keep(scree_scene *scene) {
    struct scree_checkpoint *kept = &scene->checkpoint;
    free(kept->state);
    *kept = (struct scree_checkpoint){
        .hasty = scene->hasty, .hastiest = scene->hastiest, .books_begun = scene->books_begun};
    FILE *file = open_memstream(&kept->state, &kept->size);
    if (!file) return scree_report(&scene->trouble, SCREE_NO_MEMORY, NULL, "no memory to keep the state");
    scree_status status = scree_scene_save(scene, file, "memory");
    if (fclose(file) == 0 && !status) return SCREE_OK;
    return scree_report(&scene->trouble, SCREE_NO_MEMORY, NULL, "no memory to keep the state");
}

/* The impulses of two steps that end now, J and before them K, as they would have been of half the step: forces lie on
 * a line through the middles of the steps. */
static void halve_past(double *last, double *before) {
    double bend = 0.25 * (*last - *before), now = *last;
    *last = 0.5 * (now + bend);
    *before = 0.5 * (now - bend);
}

static void halve_bodies(struct scree_bodies *bodies) {
    for (int k = 0; k < bodies->count; k++)
        for (int axis = 0; axis < 3; axis++) {
            bodies->record[k].impulse[axis] *= 0.5;
            bodies->record[k].turn[axis] *= 0.5;
            if (!bodies->past) continue;
            halve_past(&bodies->past[k].impulse[0][axis], &bodies->past[k].impulse[1][axis]);
            halve_past(&bodies->past[k].turn[0][axis], &bodies->past[k].turn[1][axis]);
        }
}

static void halve_contacts(struct scree_contacts *contacts) {
    for (int b = 0; b < contacts->batches; b++) {
        struct scree_batch *batch = &contacts->batch[b];
        for (int k = batch->impulses ? scree_first(batch) : -1; k >= 0; k = scree_next(batch, k))
            for (int axis = 0; axis < 3; axis++)
                halve_past(&batch->past[axis][k], &batch->past[SCREE_PAST_STEP + axis][k]);
    }
}

static scree_status restore(scree_scene *scene) {
    const struct scree_checkpoint *kept = &scene->checkpoint;
    FILE *file = fmemopen(kept->state, kept->size, "rb");
    if (!file) return scree_report(&scene->trouble, SCREE_NO_MEMORY, NULL, "no memory to go back to the state kept");
    scree_halving halving[SCREE_HALVINGS];
    memcpy(halving, scene->halving, sizeof halving);
    scree_status status = scree_scene_restore(scene, file, "memory");
    fclose(file);
    memcpy(scene->halving, halving, sizeof halving);
    scene->hasty = kept->hasty;
    scene->hastiest = kept->hastiest;
    scene->books_begun = kept->books_begun;
    return status;
}

/* From a run that has failed to the state kept, with half the step. */
static scree_status halve(scree_scene *scene) {
    scree_trouble cause = scene->trouble;
    scree_status status = restore(scene);
    if (status) return status;
    struct scree_watched *watched = &scene->watched;
    if (watched->begun) watched->lacking = scree_books_lack(scene);
    scene->step = scene->plan.choice.step = 0.5 * scene->step;
    scene->contacts.step = scene->step;
    scene->steps *= 2;
    halve_bodies(&scene->bodies);
    halve_contacts(&scene->contacts);
    scree_halving *halving = &scene->halving[watched->halvings++];
    *halving =
        (scree_halving){.step = scene->step, .failed = cause.time, .back = scree_scene_time(scene), .cause = cause};
    return begin_watch(scene);
}

/* What it says when halving doesn't help. */
static scree_status give_up(scree_scene *scene) {
    scree_trouble cause = scene->trouble;
    scree_report(&scene->trouble, SCREE_FAILED, NULL, "%s; the step was halved %d times before, to %.3g s", cause.text,
                 scene->watched.halvings, scene->step);
    scene->trouble.time = cause.time;
    scene->trouble.body = cause.body;
    scene->trouble.other = cause.other;
    return SCREE_FAILED;
}

/* Whoever begins at rest under gravity feels the forces that balance it a step late, and keeps a part of what it gives
 * in a step. That isn't the step's fault: the books are looked at from there on. What came in beyond that counts from
 * the start. */
static scree_status begin_at_start(scree_scene *scene) {
    double kick2 = scene->step * scene->step * vec_norm2(vec_from(scene->gravity.vector)), mass = 0.0;
    for (int k = 0; k < scene->bodies.count; k++)
        if (scree_joint_can_move(&scree_kind_of(&scene->bodies, k)->joint))
            mass += scree_kind_of(&scene->bodies, k)->inertia.mass;
    scree_status status = begin_watch(scene);
    if (!status && fabs(scene->watched.balance) > 0.5 * mass * kick2) scene->watched.balance = 0.0;
    return status;
}

/* Look whether all is well where steps have led. */
static scree_status look(scree_scene *scene) {
    scree_status status = check_state(scene);
    if (!status && !scene->watched.begun) status = begin_at_start(scene);
    return status ? status : check_books(scene);
}

scree_status scree_step_watched(struct scree_scene *scene, long steps) {
    long target = scene->steps + steps;
    scree_status status = keep(scene);
    while (!status && scene->steps < target) {
        long next = (scene->steps / STEPS_KEPT + 1) * STEPS_KEPT;
        if (!scene->watched.begun) next = scene->steps + FIRST_STEPS;
        status = scree_step_plainly(scene, (next < target ? next : target) - scene->steps);
        if (!status) status = look(scene);
        if (!status && (!can_judge(scene) || scene->steps >= target))
            continue; /* what isn't known to be good isn't kept */
        if (status == SCREE_FAILED) {
            if (scene->watched.halvings >= SCREE_HALVINGS) return give_up(scene);
            status = halve(scene);
            target *= 2;
        }
        if (!status) status = keep(scene);
    }
    return status;
}

int scree_scene_halvings(const scree_scene *scene) { return scene->watched.halvings; }

const scree_halving *scree_scene_halving(const scree_scene *scene, int index) {
    return index >= 0 && index < scene->watched.halvings ? &scene->halving[index] : NULL;
}
