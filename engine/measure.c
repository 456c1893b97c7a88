/* Measurements: they read the scene and change nothing but the copy of the records that they look at. */
#include "engine/hash.h"
#include "engine/scene.h"

#include <math.h>
#include <string.h>

int scree_scene_bodies(const scree_scene *scene) { return scene->defs; }

static int is_body(const scree_scene *scene, int index) { return index >= 0 && index < scene->defs; }

/* Whether bodies were made of the definitions. */
static int is_made(const scree_scene *scene) { return scene->bodies.count > 0 && !scene->group; }

scree_name scree_scene_body_name(const scree_scene *scene, int index) {
    return is_body(scene, index) ? scree_names_at(&scene->names, index) : (scree_name){""};
}

scree_shape scree_scene_body_shape(const scree_scene *scene, int index) {
    if (!is_body(scene, index)) return (scree_shape){0};
    return is_made(scene) ? scree_kind_of(&scene->bodies, scene->bodies.place[index])->shape
                          : scree_scene_definition(scene, index).shape;
}

const char *scree_scene_body_material(const scree_scene *scene, int index) {
    if (!is_body(scene, index)) return NULL;
    int material = is_made(scene) ? scree_kind_of(&scene->bodies, scene->bodies.place[index])->material
                                  : scree_scene_definition(scene, index).material;
    return scene->material[material].name;
}

double scree_scene_body_mass(const scree_scene *scene, int index) {
    if (!is_body(scene, index)) return 0.0;
    if (is_made(scene)) return scree_kind_of(&scene->bodies, scene->bodies.place[index])->inertia.mass;
    scree_body_def def = scree_scene_definition(scene, index);
    return scree_body_mass(&def, scene->material[def.material].density);
}

int scree_has_own_mass(const struct scree_scene *scene, int index) {
    const struct scree_kind *kind = scree_kind_of(&scene->bodies, scene->bodies.place[index]);
    scree_body_def def = {.shape = kind->shape};
    return kind->inertia.mass != scree_body_mass(&def, scene->material[kind->material].density);
}

int scree_scene_body_moves(const scree_scene *scene, int index) {
    if (!is_body(scene, index)) return 0;
    scree_joint joint = is_made(scene) ? scree_kind_of(&scene->bodies, scene->bodies.place[index])->joint
                                       : scree_scene_definition(scene, index).joint;
    return !scree_joint_is_fixed(&joint);
}

/* Where a point is that may be outside of the periodic box. */
static void put_into_box(const struct scree_bodies *bodies, const double x[3], double inside[3]) {
    for (int axis = 0; axis < 3; axis++) {
        double period = bodies->period[axis];
        inside[axis] = x[axis] - period * scree_periods_off(bodies, x[axis], axis);
        if (period > 0.0 && inside[axis] >= bodies->low[axis] + period)
            inside[axis] = bodies->low[axis]; /* rounded up */
    }
}

scree_body_state scree_scene_body(const scree_scene *scene, int index) {
    const struct scree_bodies *bodies = &scene->bodies;
    scree_body_state state = {.orientation = {1.0, 0.0, 0.0, 0.0}};
    if (!is_body(scene, index)) return state;
    if (!is_made(scene)) {
        scree_body_def def = scree_scene_definition(scene, index);
        memcpy(state.position, def.position, sizeof state.position);
        memcpy(state.velocity, def.velocity, sizeof state.velocity);
        memcpy(state.spin, def.spin, sizeof state.spin);
        quat_store(scree_start_attitude(&def), state.orientation);
        return state;
    }
    int place = bodies->place[index];
    put_into_box(bodies, bodies->position[place], state.position);
    memcpy(state.velocity, bodies->state[place].v, sizeof state.velocity);
    vec_store(scree_bodies_spin(bodies, place, scree_scene_time(scene)), state.spin);
    if (scree_kind_of(bodies, place)->slot >= 0)
        memcpy(state.orientation, scree_attitude_of(bodies, place)->q, sizeof state.orientation);
    return state;
}

scree_status scree_scene_look_now(struct scree_scene *scene) {
    scree_status status = SCREE_OK;
    if (!scene->shadow.record) status = scree_bodies_shadow(&scene->bodies, &scene->shadow, &scene->trouble);
    if (!status && scene->contacts.broken)
        status = scree_contacts_list(&scene->contacts, &scene->bodies, 1, &scene->trouble);
    if (!status) scree_bodies_look_now(&scene->bodies, scree_scene_time(scene), &scene->shadow);
    return status;
}

/* Only what forces can change counts: free directions and free turns. */
static void add_body_energy(const scree_scene *scene, int k, const double gravity[3], scree_energy *energy) {
    const struct scree_bodies *bodies = &scene->bodies;
    const struct scree_state *state = &bodies->state[k];
    const scree_joint *joint = &scree_kind_of(bodies, k)->joint;
    double mass = scree_kind_of(bodies, k)->inertia.mass;
    for (int axis = 0; axis < 3; axis++) {
        if (joint->along[axis] != SCREE_FREE) continue;
        energy->kinetic += 0.5 * mass * state->v[axis] * state->v[axis];
        energy->potential -= mass * gravity[axis] * bodies->position[k][axis];
    }
    if (joint->turn == SCREE_FREE)
        energy->rotational += 0.5 * vec_dot(scree_bodies_spin(bodies, k, scree_scene_time(scene)), vec_from(state->l));
}

/* What the terms come to so far is a number. */
static int is_number(const scree_energy *energy) {
    return isfinite(energy->kinetic + energy->rotational + energy->potential + energy->stored);
}

static scree_status beyond_numbers(struct scree_scene *scene, int body, int other) {
    return scree_scene_stop(scene, scree_scene_time(scene), body, other, "its energy is beyond what numbers hold");
}

static scree_status add_bodies_energy(struct scree_scene *scene, scree_energy *energy) {
    double gravity[3];
    scree_gravity_at(scene, scree_scene_time(scene), gravity);
    for (int k = 0; k < scene->bodies.count; k++) {
        add_body_energy(scene, k, gravity, energy);
        if (!is_number(energy)) return beyond_numbers(scene, scene->bodies.number[k], -1);
    }
    for (int axis = 0; axis < 3; axis++) energy->potential -= gravity[axis] * scene->carried[axis];
    return SCREE_OK;
}

static scree_status add_contacts_energy(struct scree_scene *scene, scree_energy *energy, double *stored_in_friction) {
    const struct scree_contacts *contacts = &scene->contacts;
    for (int b = 0; b < contacts->batches; b++) {
        for (int k = scree_first(&contacts->batch[b]); k >= 0; k = scree_next(&contacts->batch[b], k)) {
            struct scree_touch touch;
            if (!scree_contacts_measure(contacts, &scene->shadow, b, k, &touch)) continue;
            energy->stored += touch.stored + touch.stored_in_friction;
            *stored_in_friction += touch.stored_in_friction;
            if (!is_number(energy))
                return beyond_numbers(scene, scene->bodies.number[touch.ball], scene->bodies.number[touch.host]);
        }
    }
    return SCREE_OK;
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
    double stored_in_friction = 0.0;
    status = add_bodies_energy(scene, energy);
    if (!status) status = add_contacts_energy(scene, energy, &stored_in_friction);
    if (status) return status;
    if (!scene->time.energy) return SCREE_OK;
    energy->lost_normal = contacts->lost_normal;
    energy->lost_tangential = contacts->work_tangential - stored_in_friction;
    energy->driven = scene->driven;
    energy->balance = energy->kinetic + energy->rotational + energy->potential + energy->stored + energy->lost_normal +
                      energy->lost_tangential - energy->driven - scene->first_energy;
    if (isfinite(energy->balance)) return SCREE_OK;
    return scree_scene_stop(scene, scree_scene_time(scene), -1, -1,
                            "what contacts took or drives gave is beyond what numbers hold");
}

static scree_contact_state contact_state(const scree_scene *scene, const struct scree_touch *touch) {
    scree_contact_state state = {.ball = scene->bodies.number[touch->ball],
                                 .host = scene->bodies.number[touch->host],
                                 .sliding = touch->sliding};
    state.corner = touch->corner ? touch->corner - 1 - 8 * scree_kind_of(&scene->bodies, touch->ball)->slot : -1;
    if (touch->edges) state.corner = 7 + touch->corner;
    double point[3];
    vec_store(touch->point, point);
    put_into_box(&scene->bodies, point, state.point);
    vec_store(touch->normal, state.normal);
    vec_store(touch->slip, state.slip);
    vec_store(touch->tangential, state.friction);
    struct vec straight = vec_axpy(touch->tangential, touch->normal_force, touch->normal);
    vec_store(vec_axpy(straight, touch->normal_force, touch->lean.force), state.force);
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
        for (int k = scree_first(&contacts->batch[b]); k >= 0; k = scree_next(&contacts->batch[b], k)) {
            struct scree_touch touch;
            if (!scree_contacts_measure(contacts, &scene->shadow, b, k, &touch)) continue;
            if (states && *count < capacity) states[*count] = contact_state(scene, &touch);
            (*count)++;
        }
    }
    return SCREE_OK;
}

scree_effort scree_scene_effort(const scree_scene *scene) { return scene->effort; }

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

static uint64_t hash_contact(uint64_t hash, const struct scree_bodies *bodies, struct scree_contact contact) {
    int numbers[3] = {bodies->number[contact.ball], bodies->number[contact.host], contact.corner};
    return scree_hash_on(hash, numbers, sizeof numbers);
}

/* Contacts that keep nothing are left out: whether they are listed is no part of the state. */
static uint64_t hash_memory(uint64_t hash, const struct scree_bodies *bodies, const struct scree_batch *batch) {
    for (int k = batch->memory ? scree_first(batch) : -1; k >= 0; k = scree_next(batch, k)) {
        double kept[SCREE_MEMORY];
        int something = 0;
        for (int m = 0; m < batch->memory; m++) {
            kept[m] = scree_kept(batch, m, k);
            something |= kept[m] != 0.0;
        }
        if (!something) continue;
        hash = hash_contact(hash, bodies, scree_contact_at(batch, k));
        hash = scree_hash_on(hash, kept, (size_t)batch->memory * sizeof *kept);
    }
    return hash;
}

/* The impulses that pair impulses look back on. */
static uint64_t hash_past(uint64_t hash, const struct scree_bodies *bodies, const struct scree_batch *batch) {
    for (int k = batch->impulses ? scree_first(batch) : -1; k >= 0; k = scree_next(batch, k)) {
        double past[SCREE_PAST];
        int something = 0;
        for (int m = 0; m < SCREE_PAST; m++) {
            past[m] = batch->past[m][k];
            something |= past[m] != 0.0;
        }
        if (!something) continue;
        hash = hash_contact(hash, bodies, scree_contact_at(batch, k));
        hash = scree_hash_on(hash, past, sizeof past);
    }
    return hash;
}

uint64_t scree_scene_hash(const scree_scene *scene) {
    const struct scree_bodies *bodies = &scene->bodies;
    uint64_t hash = scree_hash_start, steps = (uint64_t)scene->steps;
    hash = scree_hash_on(hash, &steps, sizeof steps);
    for (int number = 0; number < bodies->count; number++) {
        int k = bodies->place[number];
        hash = scree_hash_on(hash, bodies->position[k], sizeof bodies->position[k]);
        hash = scree_hash_on(hash, bodies->state[k].v, sizeof bodies->state[k].v);
        hash = scree_hash_on(hash, bodies->state[k].l, sizeof bodies->state[k].l);
        if (scree_kind_of(bodies, k)->slot >= 0)
            hash = scree_hash_on(hash, scree_attitude_of(bodies, k)->q, sizeof bodies->attitude[0].q);
        if (!bodies->past) continue;
        hash = scree_hash_on(hash, bodies->past[k].impulse, sizeof bodies->past[k].impulse);
        hash = scree_hash_on(hash, bodies->past[k].turn, sizeof bodies->past[k].turn);
    }
    for (int b = 0; b < scene->contacts.batches; b++) {
        hash = hash_memory(hash, bodies, &scene->contacts.batch[b]);
        hash = hash_past(hash, bodies, &scene->contacts.batch[b]);
    }
    return hash;
}
