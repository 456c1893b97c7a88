/* The bodies of a scene: making them from definitions, and their copies for measurements. */
#include "bodies/bodies.h"
#include "bodies/memory.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Stands for "no limit" where an infinity would turn into a NaN (0 x infinity). */
static const double unlimited = 1e300;

static void *zeroed(size_t count, size_t size) {
    return count <= SIZE_MAX / 2 / size ? scree_memory(count * size) : NULL;
}

scree_status scree_bodies_create(struct scree_bodies *bodies, int count, struct scree_motion *motion, int motions,
                                 scree_trouble *trouble) {
    size_t n = (size_t)count;
    *bodies = (struct scree_bodies){.count = count, .motion = motion, .motions = motions};
    bodies->moved = zeroed((size_t)motions, sizeof *bodies->moved);
    bodies->record = zeroed(n, sizeof *bodies->record);
    bodies->spin = zeroed(n, sizeof *bodies->spin);
    bodies->state = zeroed(n, sizeof *bodies->state);
    bodies->position = zeroed(n, sizeof *bodies->position);
    bodies->path = zeroed(n, sizeof *bodies->path);
    bodies->class = zeroed(n, sizeof *bodies->class);
    bodies->kind_of = zeroed(n, sizeof *bodies->kind_of);
    bodies->number = zeroed(n, sizeof *bodies->number);
    bodies->place = zeroed(n, sizeof *bodies->place);
    bodies->slab = zeroed(n, sizeof *bodies->slab);
    if (bodies->record && bodies->spin && bodies->state && bodies->path && bodies->position && bodies->class &&
        bodies->kind_of && bodies->number && bodies->place && bodies->slab && bodies->moved) {
        for (int k = 0; k < count; k++) bodies->number[k] = bodies->place[k] = k;
        memset(bodies->slab, -1, n);
        return SCREE_OK;
    }
    scree_bodies_destroy(bodies);
    return scree_report(trouble, SCREE_NO_MEMORY, NULL, "no memory for %d bodies", count);
}

void scree_bodies_destroy(struct scree_bodies *bodies) {
    for (int k = 0; k < bodies->motions; k++) scree_motion_free(&bodies->motion[k]);
    scree_memory_free(bodies->record);
    scree_memory_free(bodies->spin);
    scree_memory_free(bodies->state);
    scree_memory_free(bodies->flight);
    scree_memory_free(bodies->path);
    scree_memory_free(bodies->position);
    scree_memory_free(bodies->class);
    scree_memory_free(bodies->kind_of);
    free(bodies->kind);
    scree_memory_free(bodies->attitude);
    scree_memory_free(bodies->corner);
    free(bodies->motion);
    scree_memory_free(bodies->moved);
    scree_memory_free(bodies->number);
    scree_memory_free(bodies->place);
    scree_memory_free(bodies->slab);
    scree_memory_free(bodies->past);
    scree_memory_free(bodies->glance);
    scree_memory_free(bodies->calm);
    scree_memory_free(bodies->moment);
    *bodies = (struct scree_bodies){0};
}

static enum scree_body_class classify(const scree_body_def *def) {
    if (scree_joint_is_fixed(&def->joint)) return SCREE_CLASS_FIXED;
    const scree_joint *joint = &def->joint;
    int free_axes = !joint->along[0] && !joint->along[1] && !joint->along[2] && !joint->turn;
    int hinged = joint->axis[0] != 0.0 || joint->axis[1] != 0.0 || joint->axis[2] != 0.0;
    return def->shape.kind == SCREE_SPHERE && free_axes && !hinged ? SCREE_CLASS_BALL : SCREE_CLASS_GENERAL;
}

double scree_body_mass(const scree_body_def *def, double density) {
    return def->mass > 0.0 ? def->mass : density * scree_shape_volume(&def->shape);
}

static void set_inertia(struct scree_inertia *inertia, const scree_body_def *def, double density) {
    double mass = scree_body_mass(def, density), moments[3];
    scree_shape_inertia(&def->shape, moments);
    inertia->mass = mass;
    for (int k = 0; k < 3; k++) {
        inertia->inverse_mass[k] = def->joint.along[k] == SCREE_FREE ? 1.0 / mass : 0.0;
        inertia->moments[k] = mass * moments[k];
        inertia->inverse_moments[k] = def->joint.turn == SCREE_FREE ? 1.0 / inertia->moments[k] : 0.0;
    }
}

/* ---- kinds ---- */

static int is_ball(const struct scree_kind *kind, enum scree_body_class class) {
    return kind->shape.kind == SCREE_SPHERE && class != SCREE_CLASS_GENERAL;
}

/* Two balls in all that a kind says. */
static int are_alike(const struct scree_kind *a, const struct scree_kind *b) {
    return a->slot == b->slot && a->material == b->material && a->inertia.mass == b->inertia.mass &&
           a->shape.kind == b->shape.kind && a->shape.radius == b->shape.radius &&
           a->shape.rounding == b->shape.rounding && memcmp(a->shape.edge, b->shape.edge, sizeof a->shape.edge) == 0 &&
           memcmp(&a->joint, &b->joint, sizeof a->joint) == 0;
}

/* Balls come in groups: one that is alike is among the last few, if there is one. */
static int find_alike(const struct scree_bodies *bodies, const struct scree_kind *kind) {
    enum { FEW = 16 };
    for (int k = bodies->kinds - 1; k >= 0 && k >= bodies->kinds - FEW; k--)
        if (are_alike(&bodies->kind[k], kind)) return k;
    return -1;
}

/* Give the body its kind. */
static scree_status choose_kind(struct scree_bodies *bodies, int index, const struct scree_kind *kind,
                                scree_trouble *trouble) {
    int alike = kind->slot < 0 ? find_alike(bodies, kind) : -1;
    bodies->kind_of[index] = alike >= 0 ? alike : bodies->kinds;
    if (alike >= 0) return SCREE_OK;
    if (bodies->kinds == bodies->kind_capacity) {
        int capacity = bodies->kinds + bodies->kinds / 4 + 8;
        struct scree_kind *grown = realloc(bodies->kind, (size_t)capacity * sizeof *grown);
        if (!grown) return scree_report(trouble, SCREE_NO_MEMORY, NULL, "no memory for %d kinds of bodies", capacity);
        bodies->kind = grown;
        bodies->kind_capacity = capacity;
    }
    bodies->kind[bodies->kinds++] = *kind;
    return SCREE_OK;
}

scree_status scree_bodies_set(struct scree_bodies *bodies, int index, const scree_body_def *def, double density,
                              scree_trouble *trouble) {
    struct scree_record *record = &bodies->record[index];
    struct scree_state *state = &bodies->state[index];
    struct scree_kind kind = {.shape = def->shape, .joint = def->joint, .material = def->material, .slot = -1};
    bodies->class[index] = (unsigned char)classify(def);
    set_inertia(&kind.inertia, def, density);
    if (!is_ball(&kind, bodies->class[index])) {
        kind.slot = bodies->attitudes++;
        memcpy(kind.origin, def->position, sizeof kind.origin);
    }
    for (int k = 0; k < 3; k++) {
        bodies->position[index][k] = record->x[k] = def->position[k];
        state->v[k] = def->velocity[k];
        state->l[k] = kind.inertia.moments[0] * def->spin[k]; /* right for balls; finish does the others */
    }
    const struct scree_inertia *inertia = &kind.inertia;
    record->inverse_mass = fmax(inertia->inverse_mass[0], fmax(inertia->inverse_mass[1], inertia->inverse_mass[2]));
    record->inverse_moment = inertia->inverse_moments[0];
    record->radius = def->shape.kind == SCREE_SPHERE ? def->shape.radius : 0.0;
    if (def->shape.kind == SCREE_BOX) record->radius = def->shape.rounding;
    bodies->spin[index].limit = fmin(0.5 * scree_shape_half_width(&def->shape), unlimited);
    record->bound = fmin(scree_shape_bound(&def->shape), unlimited);
    return choose_kind(bodies, index, &kind, trouble);
}

struct quat scree_start_attitude(const scree_body_def *def) {
    const double *q = def->orientation;
    if (q[0] == 0.0 && q[1] == 0.0 && q[2] == 0.0 && q[3] == 0.0) return (struct quat){1.0, 0.0, 0.0, 0.0};
    return quat_normalise(quat_from(q));
}

static void set_attitude(struct scree_bodies *bodies, int index, const scree_body_def *def) {
    struct scree_attitude *attitude = scree_attitude_of(bodies, index);
    const struct scree_inertia *inertia = &scree_kind_of(bodies, index)->inertia;
    struct quat q = scree_start_attitude(def);
    attitude->ahead = q;
    attitude->frame = quat_to_mat(q);
    quat_store(q, attitude->q);
    quat_store(q, attitude->start);
    double core = def->shape.kind == SCREE_BOX ? def->shape.rounding : 0.0;
    for (int k = 0; k < 3; k++) attitude->half[k] = 0.5 * def->shape.edge[k] - core;
    if (def->shape.kind == SCREE_SPHERE) attitude->half[0] = attitude->half[1] = attitude->half[2] = 0.0;

    struct vec moments = vec_from(inertia->moments), axis = vec_from(def->joint.axis), spin = vec_from(def->spin);
    if (vec_norm2(axis) > 0.0) {
        axis = vec_scale(1.0 / vec_norm(axis), axis);
        struct vec body_axis = mat_undo(&attitude->frame, axis);
        double moment = vec_dot(vec_times(body_axis, body_axis), moments);
        vec_store(axis, attitude->axis);
        attitude->inverse_hinge = def->joint.turn == SCREE_FREE ? 1.0 / moment : 0.0;
        vec_store(vec_scale(moment * vec_dot(axis, spin), axis), bodies->state[index].l);
        return;
    }
    struct vec body_spin = mat_undo(&attitude->frame, spin);
    vec_store(mat_apply(&attitude->frame, vec_times(moments, body_spin)), bodies->state[index].l);
}

static double common_radius(const struct scree_bodies *bodies) {
    double radius = 0.0;
    for (int k = 0; k < bodies->kinds; k++) {
        const scree_shape *shape = &bodies->kind[k].shape;
        if (shape->kind != SCREE_SPHERE) continue;
        if (radius > 0.0 && shape->radius != radius) return 0.0;
        radius = shape->radius;
    }
    return radius;
}

scree_status scree_bodies_finish(struct scree_bodies *bodies, scree_body_def (*def)(const void *context, int index),
                                 const void *context, scree_trouble *trouble) {
    size_t attitudes = (size_t)bodies->attitudes;
    bodies->even = common_radius(bodies);
    bodies->attitude = zeroed(attitudes, sizeof *bodies->attitude);
    bodies->corner = zeroed(1 + 8 * attitudes, sizeof *bodies->corner);
    if (!bodies->attitude || !bodies->corner)
        return scree_report(trouble, SCREE_NO_MEMORY, NULL, "no memory for the attitudes of %zu bodies", attitudes);
    for (int k = 0; k < bodies->count; k++) {
        if (scree_kind_of(bodies, k)->slot < 0) continue;
        scree_body_def one = def(context, k);
        set_attitude(bodies, k, &one);
    }
    return SCREE_OK;
}

scree_status scree_bodies_keep_past(struct scree_bodies *bodies, scree_trouble *trouble) {
    bodies->past = zeroed((size_t)bodies->count, sizeof *bodies->past);
    bodies->glance = zeroed((size_t)bodies->count, sizeof *bodies->glance);
    bodies->moment = zeroed((size_t)bodies->count, sizeof *bodies->moment);
    if (bodies->past && bodies->glance && bodies->moment) return SCREE_OK;
    return scree_report(trouble, SCREE_NO_MEMORY, NULL, "no memory for the past of %d bodies", bodies->count);
}

scree_status scree_bodies_shadow(const struct scree_bodies *bodies, struct scree_bodies *shadow,
                                 scree_trouble *trouble) {
    *shadow = *bodies;
    shadow->record = zeroed((size_t)bodies->count, sizeof *shadow->record);
    shadow->spin = zeroed((size_t)bodies->count, sizeof *shadow->spin);
    shadow->attitude = zeroed((size_t)bodies->attitudes, sizeof *shadow->attitude);
    shadow->corner = zeroed(1 + 8 * (size_t)bodies->attitudes, sizeof *shadow->corner);
    if (shadow->record && shadow->spin && shadow->attitude && shadow->corner) return SCREE_OK;
    scree_bodies_free_shadow(shadow);
    return scree_report(trouble, SCREE_NO_MEMORY, NULL, "no memory for a copy of %d bodies", bodies->count);
}

void scree_bodies_free_shadow(struct scree_bodies *shadow) {
    scree_memory_free(shadow->record);
    scree_memory_free(shadow->spin);
    scree_memory_free(shadow->attitude);
    scree_memory_free(shadow->corner);
    *shadow = (struct scree_bodies){0};
}
