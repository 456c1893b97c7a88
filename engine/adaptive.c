/* The adaptive integrator: unknowns, rates, contacts. */
#include "engine/adaptive.h"

#include "bodies/elementary.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static int body_size(const struct scree_bodies *bodies, int k) {
    if (bodies->class[k] == SCREE_CLASS_FIXED) return 0;
    return bodies->class[k] == SCREE_CLASS_BALL ? BALL_SIZE : GENERAL_SIZE;
}

/* ---- making and freeing ---- */

scree_status scree_adaptive_create(struct scree_scene *scene) {
    struct scree_adaptive *a = calloc(1, sizeof *a);
    scene->adaptive = a;
    size_t bodies = (size_t)scene->bodies.count + 1, size = Y_BODIES;
    for (int k = 0; k < scene->bodies.count; k++) size += (size_t)body_size(&scene->bodies, k);
    if (a) {
        a->clock = -1;
        a->at = calloc(bodies, sizeof *a->at);
        a->held = calloc(bodies, sizeof *a->held);
        a->measure = calloc(bodies, sizeof *a->measure);
        a->spin_energy = calloc(bodies, sizeof *a->spin_energy);
        a->begun = calloc(size, sizeof *a->begun);
    }
    if (a && a->at && a->held && a->measure && a->spin_energy && a->begun) return SCREE_OK;
    return scree_report(&scene->trouble, SCREE_NO_MEMORY, NULL, "no memory for the unknowns");
}

void scree_adaptive_destroy(struct scree_scene *scene) {
    struct scree_adaptive *a = scene->adaptive;
    if (!a) return;
    scree_dop853_free(&a->work);
    free(a->unknowns);
    free(a->at);
    free(a->place);
    free(a->due);
    free(a->closing);
    free(a->held);
    free(a->measure);
    free(a->spin_energy);
    free(a->begun);
    free(a->grip);
    free(a->old_grip);
    free(a->view);
    free(a->sooner);
    free(a->later);
    free(a->halfway);
    free(a->value);
    free(a->before);
    free(a);
    scene->adaptive = NULL;
}

static void *grown(void *old, size_t count, size_t size, int *failed) {
    void *memory = realloc(old, count * size);
    if (!memory) *failed = 1;
    return memory ? memory : old;
}

/* Room for so many contacts. */
static scree_status make_room(struct scree_scene *scene, int grips) {
    struct scree_adaptive *a = scene->adaptive;
    if (grips < a->grip_capacity) return SCREE_OK;
    size_t capacity = (size_t)grips + (size_t)grips / 2 + 16;
    int failed = 0;
    a->place = grown(a->place, capacity, sizeof *a->place, &failed);
    a->closing = grown(a->closing, capacity, sizeof *a->closing, &failed);
    a->due = grown(a->due, capacity, sizeof *a->due, &failed);
    a->grip = grown(a->grip, capacity, sizeof *a->grip, &failed);
    a->old_grip = grown(a->old_grip, capacity, sizeof *a->old_grip, &failed);
    a->view = grown(a->view, capacity, sizeof *a->view, &failed);
    a->sooner = grown(a->sooner, capacity, sizeof *a->sooner, &failed);
    a->later = grown(a->later, capacity, sizeof *a->later, &failed);
    a->halfway = grown(a->halfway, capacity, sizeof *a->halfway, &failed);
    a->value = grown(a->value, capacity, sizeof *a->value, &failed);
    a->before = grown(a->before, capacity, sizeof *a->before, &failed);
    if (failed) return scree_report(&scene->trouble, SCREE_NO_MEMORY, NULL, "no memory for %d contacts", grips);
    a->grip_capacity = (int)capacity;
    return SCREE_OK;
}

/* Room for so many unknowns; y keeps its first `kept`. */
static scree_status resize(struct scree_scene *scene, size_t size, size_t kept) {
    struct scree_adaptive *a = scene->adaptive;
    double *y = calloc(3 * size, sizeof *y);
    if (!y || scree_dop853_resize(&a->work, size)) {
        free(y);
        return scree_report(&scene->trouble, SCREE_NO_MEMORY, NULL, "no memory for %zu unknowns", size);
    }
    if (kept) memcpy(y, a->y, kept * sizeof *y);
    free(a->unknowns);
    a->unknowns = a->y = y;
    a->arrived = y + size;
    a->next = y + 2 * size;
    return SCREE_OK;
}

/* ---- unknowns ---- */

static void pack(struct scree_scene *scene) {
    struct scree_adaptive *a = scene->adaptive;
    for (int k = 0; k < scene->bodies.count; k++) {
        const struct scree_state *state = &scene->bodies.state[k];
        if (a->at[k] < 0) continue;
        double *y = a->y + a->at[k];
        memcpy(y + OF_X, scene->bodies.position[k], sizeof *scene->bodies.position);
        memcpy(y + OF_V, state->v, sizeof state->v);
        memcpy(y + OF_L, state->l, sizeof state->l);
        int slot = scree_kind_of(&scene->bodies, k)->slot;
        if (slot >= 0) memcpy(y + OF_Q, scene->bodies.attitude[slot].q, sizeof scene->bodies.attitude[slot].q);
    }
}

/* Time for motions: they jump at their breaks, and the last stages of a step that ends there mustn't see it. */
static double time_at(const struct scree_adaptive *a, const double *y) {
    return fmax(fmin(a->start + y[Y_TIME], a->limit), a->earliest);
}

void scree_adaptive_place(struct scree_scene *scene, const double *y) {
    struct scree_adaptive *a = scene->adaptive;
    struct scree_bodies *bodies = &scene->bodies;
    for (int k = 0; k < bodies->count; k++) {
        if (a->at[k] < 0) continue;
        const double *own = y + a->at[k];
        struct scree_state *state = &bodies->state[k];
        memcpy(bodies->position[k], own + OF_X, sizeof *bodies->position);
        memcpy(state->v, own + OF_V, sizeof state->v);
        memcpy(state->l, own + OF_L, sizeof state->l);
        if (scree_kind_of(bodies, k)->slot >= 0)
            memcpy(scree_attitude_of(bodies, k)->q, own + OF_Q, sizeof bodies->attitude[0].q);
    }
    scree_bodies_start(bodies, time_at(a, y));
}

/* ---- rates ---- */

/* Records have what acts in a second instead of a step: forces, N, and torques, N m. */
static void add_load(struct scree_bodies *bodies, const struct scree_grip *grip, const struct scree_grip_view *view) {
    struct scree_record *ball = &bodies->record[grip->contact.ball], *host = &bodies->record[grip->contact.host];
    vec_store(vec_add(vec_from(ball->impulse), view->push), ball->impulse);
    vec_store(vec_sub(vec_from(host->impulse), view->push), host->impulse);
    if (!grip->turns) return;
    struct vec ball_turn = vec_add(vec_cross(view->arm, view->push), view->torque);
    struct vec host_turn = vec_add(vec_cross(view->host_arm, view->push), view->torque);
    vec_store(vec_add(vec_from(ball->turn), ball_turn), ball->turn);
    vec_store(vec_sub(vec_from(host->turn), host_turn), host->turn);
}

/* Forces of all contacts into the records, and what they do to the books. */
static void act(struct scree_scene *scene, const double *y, double *rates) {
    struct scree_adaptive *a = scene->adaptive;
    for (int k = 0; k < a->grips; k++) {
        struct scree_grip *grip = &a->grip[k];
        int held = grip->state == SCREE_GRIP_HELD;
        if (!held && !a->every) continue;
        double overlap = k == a->clock ? scree_whole_power(y[Y_CLOCK], a->root) - a->offset : NAN;
        scree_grip_meet(grip, &scene->bodies, overlap, &a->view[k]);
        scree_grip_press(grip, &scene->bodies, y + a->place[k], &a->view[k]);
        if (!held) continue;
        add_load(&scene->bodies, grip, &a->view[k]);
        rates[Y_WORK] += a->view[k].force * a->view[k].closing;
        rates[Y_RUBBED] += a->view[k].rubbing;
        for (int m = 0; scree_adaptive_memory_size(grip) && m < SCREE_GRIP_WAYS; m++)
            vec_store(a->view[k].rate[m], rates + a->place[k] + 3 * m);
    }
}

/* How gravity turns while it tilts, m/s^3. */
static struct vec gravity_rate(const struct scree_scene *scene, double time, struct vec gravity) {
    if (!scene->gravity.tilts) return vec(0.0, 0.0, 0.0);
    double speed = scree_motion_at(&scene->bodies.motion[scene->gravity.tilt], time).velocity;
    struct vec axis = vec_from(scene->gravity.axis);
    return vec_scale(speed / vec_norm(axis), vec_cross(axis, gravity));
}

static void move_body(const struct scree_bodies *bodies, int k, const double gravity[3], struct vec tilting,
                      double *rates, double *driven) {
    const struct scree_record *record = &bodies->record[k];
    const struct scree_inertia *inertia = &scree_kind_of(bodies, k)->inertia;
    const scree_joint *joint = &scree_kind_of(bodies, k)->joint;
    const double turn[3] = {tilting.x, tilting.y, tilting.z};
    for (int axis = 0; axis < 3; axis++) {
        rates[OF_X + axis] = rates[OF_V + axis] = 0.0;
        if (joint->along[axis] == SCREE_DRIVEN) *driven -= record->impulse[axis] * record->v[axis];
        if (joint->turn == SCREE_DRIVEN) *driven -= record->turn[axis] * bodies->spin[k].w[axis];
        rates[OF_L + axis] = joint->turn == SCREE_FREE ? record->turn[axis] : 0.0;
        if (joint->along[axis] != SCREE_FREE) continue;
        rates[OF_X + axis] = record->v[axis];
        rates[OF_V + axis] = inertia->inverse_mass[axis] * record->impulse[axis] + gravity[axis];
        *driven -= inertia->mass * turn[axis] * record->x[axis];
    }
    if (scree_kind_of(bodies, k)->slot < 0) return;
    struct quat q = quat_from(scree_attitude_of(bodies, k)->q), rate = {0.0, 0.0, 0.0, 0.0};
    if (joint->turn == SCREE_FREE) {
        const double *w = bodies->spin[k].w;
        struct quat spin = {0.0, 0.5 * w[0], 0.5 * w[1], 0.5 * w[2]};
        rate = quat_multiply(spin, q);
    }
    quat_store(rate, rates + OF_Q);
}

void scree_adaptive_rates(void *context, const double *y, double *rates) {
    struct scree_scene *scene = context;
    struct scree_adaptive *a = scene->adaptive;
    scene->effort.evaluations++;
    memset(rates, 0, a->work.size * sizeof *rates);
    scree_adaptive_place(scene, y);
    act(scene, y, rates);
    double gravity[3], time = time_at(a, y);
    scree_gravity_at(scene, time, gravity);
    struct vec tilting = gravity_rate(scene, time, vec_from(gravity));
    for (int k = 0; k < scene->bodies.count; k++)
        if (a->at[k] >= 0) move_body(&scene->bodies, k, gravity, tilting, rates + a->at[k], &rates[Y_DRIVEN]);
    rates[Y_TIME] = 1.0;
    if (a->clock < 0) return;
    /* All rates by the clock instead of by time: d = s^p - offset, d(d)/dt = closing. */
    double s = y[Y_CLOCK], by_clock = a->root * scree_whole_power(s, a->root - 1) / a->view[a->clock].closing;
    for (size_t i = 0; i < a->work.size; i++) rates[i] *= by_clock;
    rates[Y_CLOCK] = 1.0;
}

/* ---- contacts ---- */

static int same_contact(const struct scree_contact *a, const struct scree_contact *b) {
    return a->ball == b->ball && a->host == b->host && a->corner == b->corner;
}

/* Contacts of the list, in its order, apart. The bodies' part of y stays. */
static scree_status take_list(struct scree_scene *scene) {
    struct scree_adaptive *a = scene->adaptive;
    struct scree_contacts *contacts = &scene->contacts;
    int grips = 0;
    for (int b = 0; b < contacts->batches; b++)
        if (contacts->batch[b].geometry != SCREE_EDGE_EDGE) grips += contacts->batch[b].count;
    scree_status status = make_room(scene, grips);
    if (status) return status;
    a->grips = 0;
    for (int b = 0; b < contacts->batches; b++) {
        if (contacts->batch[b].geometry == SCREE_EDGE_EDGE) continue; /* watched by stop_at_edges */
        for (int k = scree_first(&contacts->batch[b]); k >= 0; k = scree_next(&contacts->batch[b], k))
            scree_grip_make(&a->grip[a->grips++], contacts, &scene->bodies, b, k);
    }
    size_t size = Y_BODIES;
    for (int k = 0; k < scene->bodies.count; k++) {
        int own = body_size(&scene->bodies, k);
        a->at[k] = own ? (int)size : -1;
        size += (size_t)own;
    }
    size_t kept = a->y ? size : 0, most = size + SCREE_GRIP_MEMORY;
    a->nowhere = (int)size;
    for (int k = 0; k < a->grips; k++) {
        a->place[k] = a->nowhere;
        most += (size_t)scree_adaptive_memory_size(&a->grip[k]);
    }
    scree_status room = resize(scene, most, kept);
    a->work.size = size + SCREE_GRIP_MEMORY;
    return room;
}

void scree_adaptive_claim(struct scree_adaptive *a, int grip) {
    if (a->place[grip] != a->nowhere || !scree_adaptive_memory_size(&a->grip[grip])) return;
    a->place[grip] = (int)a->work.size;
    a->work.size += (size_t)scree_adaptive_memory_size(&a->grip[grip]);
    memset(a->y + a->place[grip], 0, SCREE_GRIP_MEMORY * sizeof *a->y);
    memset(a->arrived + a->place[grip], 0, SCREE_GRIP_MEMORY * sizeof *a->y);
}

scree_status scree_adaptive_list(struct scree_scene *scene) {
    struct scree_adaptive *a = scene->adaptive;
    scree_adaptive_place(scene, a->y);
    scree_status status = scree_contacts_list(&scene->contacts, &scene->bodies, 1, &scene->trouble);
    if (status) return status;
    int old = 0;
    for (int k = 0; k < a->grips; k++)
        if (a->grip[k].state != SCREE_GRIP_APART) a->old_grip[old++] = a->grip[k];
    double *memory = malloc(((size_t)old * SCREE_GRIP_MEMORY + 1) * sizeof *memory);
    if (!memory) return scree_report(&scene->trouble, SCREE_NO_MEMORY, NULL, "no memory for %d contacts", old);
    for (int k = 0, n = 0; k < a->grips; k++)
        if (a->grip[k].state != SCREE_GRIP_APART)
            memcpy(memory + SCREE_GRIP_MEMORY * (size_t)n++, a->y + a->place[k], SCREE_GRIP_MEMORY * sizeof *memory);
    struct scree_contact clock = {-1, -1, -1};
    if (a->clock >= 0) clock = a->grip[a->clock].contact;
    status = take_list(scene);
    for (int k = 0; k < a->grips && !status; k++) {
        for (int n = 0; n < old; n++) {
            struct scree_grip *now = &a->grip[k];
            const struct scree_grip *was = &a->old_grip[n];
            if (now->batch != was->batch || !same_contact(&now->contact, &was->contact)) continue;
            int index = now->index;
            *now = *was;
            now->index = index;
            scree_adaptive_claim(a, k);
            if (scree_adaptive_memory_size(now))
                memcpy(a->y + a->place[k], memory + SCREE_GRIP_MEMORY * (size_t)n, SCREE_GRIP_MEMORY * sizeof *memory);
        }
        if (a->clock >= 0 && same_contact(&a->grip[k].contact, &clock)) a->clock = k;
    }
    free(memory);
    return status;
}

/* Numbers kept of a contact into `kept`; NULL if it keeps none. */
static double *kept_of(const struct scree_scene *scene, const struct scree_grip *grip, double kept[SCREE_MEMORY]) {
    const struct scree_batch *batch = &scene->contacts.batch[grip->batch];
    if (!batch->memory) return NULL;
    for (int m = 0; m < SCREE_MEMORY; m++) kept[m] = scree_kept(batch, m, grip->index);
    return kept;
}

scree_status scree_adaptive_begin_step(struct scree_scene *scene) {
    struct scree_adaptive *a = scene->adaptive;
    a->start = scree_scene_time(scene);
    a->earliest = a->start;
    a->limit = HUGE_VAL;
    a->clock = -1;
    for (int k = 0; k < scene->bodies.count; k++) a->spin_energy[k] = -1.0;
    scree_bodies_start(&scene->bodies, a->start);
    scree_status status = scree_contacts_list(&scene->contacts, &scene->bodies, 1, &scene->trouble);
    if (!status) status = take_list(scene);
    if (status) return status;
    memset(a->y, 0, a->work.size * sizeof *a->y);
    pack(scene);
    memcpy(a->begun, a->y, (size_t)a->nowhere * sizeof *a->begun);
    for (int k = 0; k < a->grips; k++) {
        double kept[SCREE_MEMORY];
        struct scree_grip *grip = &a->grip[k];
        scree_grip_meet(grip, &scene->bodies, NAN, &a->view[k]);
        double memory[SCREE_GRIP_MEMORY];
        scree_grip_recall(grip, &a->view[k], kept_of(scene, grip, kept), memory);
        if (grip->state == SCREE_GRIP_APART) continue;
        scree_adaptive_claim(a, k);
        if (scree_adaptive_memory_size(grip)) memcpy(a->y + a->place[k], memory, sizeof memory);
    }
    return SCREE_OK;
}

void scree_adaptive_go_back(struct scree_scene *scene) {
    struct scree_adaptive *a = scene->adaptive;
    a->earliest = a->start;
    a->limit = HUGE_VAL;
    scree_adaptive_place(scene, a->begun);
    scene->contacts.broken = 1; /* lists are those of a later time */
}

void scree_adaptive_keep(struct scree_scene *scene) {
    struct scree_adaptive *a = scene->adaptive;
    for (int k = 0; k < a->grips; k++) {
        struct scree_grip *grip = &a->grip[k];
        struct scree_batch *batch = &scene->contacts.batch[grip->batch];
        double kept[SCREE_MEMORY];
        if (!batch->memory) continue;
        scree_grip_keep(grip, &a->view[k], a->y + a->place[k], kept);
        for (int m = 0; m < SCREE_MEMORY; m++) scree_keep(batch, m, grip->index, kept[m]);
    }
}
