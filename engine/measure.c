/* Measurements: they read the scene and change nothing but the copy of the records that they look at. */
#include "engine/hash.h"
#include "engine/scene.h"

#include <string.h>

int scree_scene_bodies(const scree_scene *scene) { return scene->baked == 1 ? scene->bodies.count : scene->defs; }

/* The definition of body `index`; one that is all zero where there is no such body. */
static const scree_body_def *definition(const scree_scene *scene, int index) {
    static const scree_body_def none = {.name = NULL};
    return index >= 0 && index < scene->defs ? &scene->def[index] : &none;
}

const char *scree_scene_body_name(const scree_scene *scene, int index) { return definition(scene, index)->name; }

scree_shape scree_scene_body_shape(const scree_scene *scene, int index) { return definition(scene, index)->shape; }

double scree_scene_body_mass(const scree_scene *scene, int index) {
    const scree_body_def *def = definition(scene, index);
    return def->name ? scree_body_mass(def, scene->material[def->material].density) : 0.0;
}

int scree_scene_body_moves(const scree_scene *scene, int index) {
    const scree_body_def *def = definition(scene, index);
    return def->name && !scree_joint_is_fixed(&def->joint);
}

scree_body_state scree_scene_body(const scree_scene *scene, int index) {
    const struct scree_bodies *bodies = &scene->bodies;
    const scree_body_def *def = definition(scene, index);
    scree_body_state state = {.orientation = {1.0, 0.0, 0.0, 0.0}};
    if (scene->baked != 1 || !def->name) {
        memcpy(state.position, def->position, sizeof state.position);
        memcpy(state.velocity, def->velocity, sizeof state.velocity);
        memcpy(state.spin, def->spin, sizeof state.spin);
        quat_store(scree_start_attitude(def), state.orientation);
        return state;
    }
    memcpy(state.position, bodies->state[index].x, sizeof state.position);
    memcpy(state.velocity, bodies->state[index].v, sizeof state.velocity);
    vec_store(scree_bodies_spin(bodies, index, scree_scene_time(scene)), state.spin);
    if (bodies->slot[index] >= 0)
        memcpy(state.orientation, bodies->attitude[bodies->slot[index]].q, sizeof state.orientation);
    return state;
}

scree_status scree_scene_look_now(struct scree_scene *scene) {
    if (!scene->shadow.record) {
        scree_status status = scree_bodies_shadow(&scene->bodies, &scene->shadow, &scene->trouble);
        if (status) return status;
    }
    scree_bodies_look_now(&scene->bodies, scree_scene_time(scene), &scene->shadow);
    return SCREE_OK;
}

/* Only what forces can change counts: free directions and free turns. */
static void add_body_energy(const scree_scene *scene, int k, const double gravity[3], scree_energy *energy) {
    const struct scree_bodies *bodies = &scene->bodies;
    const struct scree_state *state = &bodies->state[k];
    const scree_joint *joint = &bodies->joint[k];
    double mass = bodies->inertia[k].mass;
    for (int axis = 0; axis < 3; axis++) {
        if (joint->along[axis] != SCREE_FREE) continue;
        energy->kinetic += 0.5 * mass * state->v[axis] * state->v[axis];
        energy->potential -= mass * gravity[axis] * state->x[axis];
    }
    if (joint->turn == SCREE_FREE)
        energy->rotational += 0.5 * vec_dot(scree_bodies_spin(bodies, k, scree_scene_time(scene)), vec_from(state->l));
}

static scree_status check_baked(scree_scene *scene) {
    if (scene->baked == 1) return SCREE_OK;
    return scree_report(&scene->trouble, SCREE_BAD_INPUT, NULL, "only a scene that has been baked can be measured");
}

scree_status scree_scene_energy(scree_scene *scene, scree_energy *energy) {
    *energy = (scree_energy){0};
    scree_status status = check_baked(scene);
    return status ? status : scree_energy_now(scene, energy);
}

scree_status scree_energy_now(struct scree_scene *scene, scree_energy *energy) {
    *energy = (scree_energy){0};
    scree_status status = scree_scene_look_now(scene);
    if (status) return status;
    const struct scree_contacts *contacts = &scene->contacts;
    double gravity[3], stored_in_friction = 0.0;
    scree_gravity_at(scene, scree_scene_time(scene), gravity);
    for (int k = 0; k < scene->bodies.count; k++) add_body_energy(scene, k, gravity, energy);
    for (int b = 0; b < contacts->batches; b++) {
        for (int k = 0; k < contacts->batch[b].count; k++) {
            struct scree_touch touch;
            if (!scree_contacts_measure(contacts, &scene->shadow, b, k, &touch)) continue;
            energy->stored += touch.stored + touch.stored_in_friction;
            stored_in_friction += touch.stored_in_friction;
        }
    }
    if (!scene->time.energy) return SCREE_OK;
    energy->lost_normal = contacts->lost_normal;
    energy->lost_tangential = contacts->work_tangential - stored_in_friction;
    energy->driven = scene->driven;
    energy->balance = energy->kinetic + energy->rotational + energy->potential + energy->stored + energy->lost_normal +
                      energy->lost_tangential - energy->driven - scene->first_energy;
    return SCREE_OK;
}

static scree_contact_state contact_state(const scree_scene *scene, const struct scree_touch *touch) {
    scree_contact_state state = {.ball = touch->ball, .host = touch->host, .sliding = touch->sliding};
    state.corner = touch->corner ? touch->corner - 1 - 8 * scene->bodies.slot[touch->ball] : -1;
    if (touch->edges) state.corner = 7 + touch->corner;
    vec_store(touch->point, state.point);
    vec_store(touch->normal, state.normal);
    vec_store(touch->slip, state.slip);
    vec_store(touch->tangential, state.friction);
    vec_store(touch->torque, state.rolling);
    state.overlap = touch->overlap;
    state.closing = touch->closing;
    state.normal_force = touch->normal_force;
    return state;
}

scree_status scree_scene_contacts(scree_scene *scene, scree_contact_state *states, int capacity, int *count) {
    *count = 0;
    scree_status status = check_baked(scene);
    if (!status) status = scree_scene_look_now(scene);
    if (status) return status;
    const struct scree_contacts *contacts = &scene->contacts;
    for (int b = 0; b < contacts->batches; b++) {
        for (int k = 0; k < contacts->batch[b].count; k++) {
            struct scree_touch touch;
            if (!scree_contacts_measure(contacts, &scene->shadow, b, k, &touch)) continue;
            if (states && *count < capacity) states[*count] = contact_state(scene, &touch);
            (*count)++;
        }
    }
    return SCREE_OK;
}

double scree_scene_deepest(const scree_scene *scene, int *ball, int *host) {
    if (ball) *ball = scene->contacts.deepest_ball;
    if (host) *host = scene->contacts.deepest_host;
    return scene->contacts.deepest;
}

double scree_scene_steepest(const scree_scene *scene, int *ball, int *host) {
    if (ball) *ball = scene->contacts.steepest_ball;
    if (host) *host = scene->contacts.steepest_host;
    return scene->contacts.steepest;
}

/* Contacts that keep nothing are left out: whether they are listed is no part of the state. */
static uint64_t hash_memory(uint64_t hash, const struct scree_batch *batch) {
    for (int k = 0; batch->memory && k < batch->count; k++) {
        double kept[SCREE_MEMORY];
        int something = 0;
        for (int m = 0; m < batch->memory; m++) {
            kept[m] = batch->kept[k / SCREE_LANES][m][k % SCREE_LANES];
            something |= kept[m] != 0.0;
        }
        if (!something) continue;
        hash = scree_hash_on(hash, &batch->contact[k], sizeof batch->contact[k]);
        hash = scree_hash_on(hash, kept, (size_t)batch->memory * sizeof *kept);
    }
    return hash;
}

/* The impulses that pair impulses look back on. */
static uint64_t hash_past(uint64_t hash, const struct scree_batch *batch) {
    for (int k = 0; batch->impulses && k < batch->count; k++) {
        double past[SCREE_PAST];
        int something = 0;
        for (int m = 0; m < SCREE_PAST; m++) {
            past[m] = batch->past[k / SCREE_LANES][m][k % SCREE_LANES];
            something |= past[m] != 0.0;
        }
        if (!something) continue;
        hash = scree_hash_on(hash, &batch->contact[k], sizeof batch->contact[k]);
        hash = scree_hash_on(hash, past, sizeof past);
    }
    return hash;
}

uint64_t scree_scene_hash(const scree_scene *scene) {
    const struct scree_bodies *bodies = &scene->bodies;
    uint64_t hash = scree_hash_start, steps = (uint64_t)scene->steps;
    hash = scree_hash_on(hash, &steps, sizeof steps);
    for (int k = 0; k < bodies->count; k++) {
        hash = scree_hash_on(hash, &bodies->state[k], sizeof bodies->state[k]);
        if (bodies->slot[k] >= 0)
            hash = scree_hash_on(hash, bodies->attitude[bodies->slot[k]].q, sizeof bodies->attitude[0].q);
        if (!bodies->past) continue;
        hash = scree_hash_on(hash, bodies->past[k].f, sizeof bodies->past[k].f);
        hash = scree_hash_on(hash, bodies->past[k].t, sizeof bodies->past[k].t);
    }
    for (int b = 0; b < scene->contacts.batches; b++) {
        hash = hash_memory(hash, &scene->contacts.batch[b]);
        hash = hash_past(hash, &scene->contacts.batch[b]);
    }
    return hash;
}
