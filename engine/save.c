/* Save and restore: the whole state of a run, so that what follows is the same in every bit as without the break.
 *
 * The file: a line of text, a mark of the machine's byte order, fingerprints of the scene, then the state as it stands
 * in memory, and a hash of all that went before. */
#include "engine/hash.h"
#include "engine/scene.h"

#include <errno.h>
#include <limits.h>
#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

static const char magic[24] = "scree state 7\n";
static const uint64_t byte_order_mark = 0x0102030405060708u;

/* One remembered contact. */
struct memory {
    struct scree_contact contact;
    int batch;
    double kept[SCREE_MEMORY], past[SCREE_PAST];
};

/* The scene's scalars that change while it runs. */
struct scalars {
    long steps;
    double step;
    double carried[3], driven, first_energy, lost_normal, work_tangential, deepest, steepest;
    int deepest_ball, deepest_host, steepest_ball, steepest_host;
    int energy; /* the books were kept */
    struct scree_watched watched;
    double inner_step;
    scree_effort effort;
};

struct stream {
    FILE *file;
    uint64_t hash;
    int failed;
};

static void put(struct stream *s, const void *data, size_t size) {
    s->hash = scree_hash_on(s->hash, data, size);
    s->failed |= fwrite(data, 1, size, s->file) != size;
}

static void get(struct stream *s, void *data, size_t size) {
    memset(data, 0, size);
    s->failed |= !s->failed && fread(data, 1, size, s->file) != size;
    s->hash = scree_hash_on(s->hash, data, size);
}

/* ---- what makes a state belong to a scene ---- */

/* Fingerprints of all that decides how the state goes on, part by part, so that a message can say what differs. Output,
 * the time at which a run ends, and threads are free to change; the step is looked at apart. */
enum {
    PRINT_BODIES,
    PRINT_START,
    PRINT_CONTACTS,
    PRINT_MOTIONS,
    PRINT_GRAVITY,
    PRINT_INTEGRATOR,
    PRINT_DOMAIN,
    PRINTS
};

static const char *const print_names[PRINTS] = {
    "bodies or their joints", "start positions or velocities", "contacts", "motions", "gravity", "integrator",
    "periodic domain"};

struct prints {
    uint64_t of[PRINTS];
};

#define HASH_ON(hash, value) ((hash) = scree_hash_on((hash), &(value), sizeof(value)))

static uint64_t hash_name(uint64_t hash, const char *name) { return scree_hash_on(hash, name, strlen(name) + 1); }

static uint64_t print_bodies(const scree_scene *scene) {
    const struct scree_bodies *bodies = &scene->bodies;
    uint64_t hash = scree_hash_start;
    HASH_ON(hash, bodies->count);
    for (int number = 0; number < bodies->count; number++) {
        int k = bodies->place[number];
        const scree_joint *joint = &scree_kind_of(bodies, k)->joint;
        const scree_shape *shape = &scree_kind_of(bodies, k)->shape;
        hash = hash_name(hash, scree_name_of(scene, number).text);
        hash = hash_name(hash, scene->material[scree_kind_of(bodies, k)->material].name);
        HASH_ON(hash, shape->kind);
        HASH_ON(hash, shape->radius);
        HASH_ON(hash, shape->edge);
        HASH_ON(hash, shape->rounding);
        HASH_ON(hash, scree_kind_of(bodies, k)->inertia.inverse_mass);
        HASH_ON(hash, scree_kind_of(bodies, k)->inertia.moments);
        HASH_ON(hash, joint->along);
        for (int axis = 0; axis < 3; axis++)
            if (joint->along[axis] == SCREE_DRIVEN) HASH_ON(hash, joint->along_motion[axis]);
        HASH_ON(hash, joint->turn);
        if (joint->turn == SCREE_DRIVEN) HASH_ON(hash, joint->turn_motion);
        HASH_ON(hash, joint->axis);
    }
    return hash;
}

static uint64_t hash_table(uint64_t hash, const struct scree_force_table *table) {
    if (!table) return hash;
    size_t overlaps = (size_t)table->overlaps, speeds = (size_t)table->speeds;
    hash = scree_hash_on(hash, table->overlap, overlaps * sizeof(double));
    hash = scree_hash_on(hash, table->speed, speeds * sizeof(double));
    return scree_hash_on(hash, table->force, overlaps * speeds * sizeof(double));
}

static uint64_t print_contacts(const scree_scene *scene) {
    uint64_t hash = scree_hash_start;
    for (int k = 0; k < scene->contacts.rules; k++) {
        const struct scree_rule *rule = &scene->contacts.rule[k];
        hash = hash_name(hash, scene->material[rule->material[0]].name);
        hash = hash_name(hash, scene->material[rule->material[1]].name);
        HASH_ON(hash, rule->touches);
        if (!rule->touches) continue;
        hash = hash_name(hash, scree_normal_laws[rule->normal]->text.name);
        hash = hash_name(hash, rule->friction >= 0 ? scree_friction_laws[rule->friction]->text.name : "");
        HASH_ON(hash, rule->share);
        if (rule->corners) HASH_ON(hash, rule->corners);
        HASH_ON(hash, rule->normal_constants.c);
        HASH_ON(hash, rule->friction_constants.c);
        hash = hash_table(hash, rule->normal_constants.table);
        hash = hash_name(hash, rule->rolling >= 0 ? scree_rolling_laws[rule->rolling]->text.name : "");
        HASH_ON(hash, rule->rolling_constants.c);
    }
    return hash;
}

static uint64_t print_motions(const scree_scene *scene) {
    uint64_t hash = scree_hash_start;
    for (int k = 0; k < scene->bodies.motions; k++) {
        const struct scree_motion *motion = &scene->bodies.motion[k];
        HASH_ON(hash, motion->count);
        hash = scree_hash_on(hash, motion->pieces, (size_t)motion->count * sizeof *motion->pieces);
    }
    return hash;
}

static uint64_t print_gravity(const scree_scene *scene) {
    const scree_gravity_def *gravity = &scene->gravity;
    uint64_t hash = scree_hash_start;
    HASH_ON(hash, gravity->vector);
    HASH_ON(hash, gravity->tilts);
    if (!gravity->tilts) return hash;
    HASH_ON(hash, gravity->tilt);
    HASH_ON(hash, gravity->axis);
    return hash;
}

static uint64_t print_integrator(const scree_scene *scene) {
    uint64_t hash = (uint64_t)scene->time.integrator + ((uint64_t)scene->time.substeps << 8);
    if (scene->time.sleep > 0.0) HASH_ON(hash, scene->time.sleep);
    if (scene->time.integrator != SCREE_ADAPTIVE) return hash;
    HASH_ON(hash, scene->time.tolerance);
    HASH_ON(hash, scene->time.no_flight);
    return hash;
}

/* Where the domain begins and ends counts only along periodic axes. */
static uint64_t print_domain(const scree_scene *scene) {
    uint64_t hash = scree_hash_start;
    HASH_ON(hash, scene->bodies.low);
    HASH_ON(hash, scene->bodies.period);
    return hash;
}

static struct prints prints_of(const scree_scene *scene) {
    struct prints prints = {{0}};
    prints.of[PRINT_BODIES] = print_bodies(scene);
    prints.of[PRINT_START] = scene->start;
    prints.of[PRINT_CONTACTS] = print_contacts(scene);
    prints.of[PRINT_MOTIONS] = print_motions(scene);
    prints.of[PRINT_GRAVITY] = print_gravity(scene);
    prints.of[PRINT_INTEGRATOR] = print_integrator(scene);
    prints.of[PRINT_DOMAIN] = print_domain(scene);
    return prints;
}

/* SCREE_BAD_INPUT if the state is of another scene, with what differs. */
static scree_status compare(scree_scene *scene, const struct prints *stored, const char *name) {
    struct prints own = prints_of(scene);
    char differs[256] = "";
    for (int k = 0; k < PRINTS; k++) {
        if (stored->of[k] == own.of[k]) continue;
        size_t length = strlen(differs);
        snprintf(differs + length, sizeof differs - length, "%s%s", length ? ", " : "", print_names[k]);
    }
    if (!differs[0]) return SCREE_OK;
    return scree_report(&scene->trouble, SCREE_BAD_INPUT, NULL,
                        "%s: this state belongs to another scene; what differs: %s", name, differs);
}

/* The same of the step that the state began with: halving takes the one given down, in the state or in the scene that
 * goes back to it. */
static scree_status compare_steps(scree_scene *scene, const struct scalars *scalars, const char *name) {
    double step = ldexp(scalars->step, scalars->watched.halvings);
    double own_step = ldexp(scene->step, scene->watched.halvings);
    if (scene->plan.choice.automatic || step == own_step) return SCREE_OK;
    return scree_report(&scene->trouble, SCREE_BAD_INPUT, NULL,
                        "%s: this state belongs to another scene: its step is %.17g s, not %.17g s", name, step,
                        own_step);
}

/* ---- contact memory as a list ---- */

static int remembers(const struct scree_batch *batch) { return batch->memory || batch->impulses; }

/* Only what is kept: which contacts are listed besides is a matter of when lists were made. */
static int next_memory(const struct scree_batch *batch, int k) {
    while (k >= 0 && !scree_keeps_something(batch, k)) k = scree_next(batch, k);
    return k;
}

static int first_memory(const struct scree_batch *batch) {
    return remembers(batch) ? next_memory(batch, scree_first(batch)) : -1;
}

static int memory_after(const struct scree_batch *batch, int k) { return next_memory(batch, scree_next(batch, k)); }

static long count_memories(const scree_scene *scene) {
    long count = 0;
    for (int b = 0; b < scene->contacts.batches; b++) {
        const struct scree_batch *batch = &scene->contacts.batch[b];
        for (int k = first_memory(batch); k >= 0; k = memory_after(batch, k)) count++;
    }
    return count;
}

static void put_memories(struct stream *s, const scree_scene *scene) {
    for (int b = 0; b < scene->contacts.batches; b++) {
        const struct scree_batch *batch = &scene->contacts.batch[b];
        for (int k = first_memory(batch); k >= 0; k = memory_after(batch, k)) {
            struct memory memory;
            memset(&memory, 0, sizeof memory);
            memory.contact = scree_contact_at(batch, k);
            memory.batch = b;
            for (int m = 0; m < SCREE_MEMORY; m++) memory.kept[m] = scree_kept(batch, m, k);
            for (int m = 0; batch->impulses && m < SCREE_PAST; m++) memory.past[m] = batch->past[m][k];
            put(s, &memory, sizeof memory);
        }
    }
}

/* Room for the remembered contacts. */
static scree_status make_room(scree_scene *scene, const struct memory *memory, long count) {
    struct scree_contacts *contacts = &scene->contacts;
    scree_status status = SCREE_OK;
    for (int b = 0; b < contacts->batches && !status; b++) {
        int own = 0, corners = 0;
        for (long n = 0; n < count; n++) {
            if (memory[n].batch != b) continue;
            own++;
            corners |= memory[n].contact.corner != 0;
        }
        if (own) status = scree_contacts_reserve(&contacts->batch[b], own, corners, &scene->trouble);
    }
    return status;
}

/* Let the lists hold just the remembered contacts; making the list anew then carries their memory over as ever. */
static scree_status remember(scree_scene *scene, const struct memory *memory, long count) {
    struct scree_contacts *contacts = &scene->contacts;
    scree_contacts_forget(contacts);
    for (long n = 0; n < count; n++)
        scree_contacts_remember(&contacts->batch[memory[n].batch], &scene->bodies, &memory[n].contact, memory[n].kept,
                                memory[n].past);
    return scree_contacts_list(contacts, &scene->bodies, 1, &scene->trouble);
}

/* ---- the whole ---- */

/* The part of the body at a place (the order of bodies is state, since sums follow it): the impulses of the last step
 * are state too, since velocities are predicted from them; pair impulses look back by two. */
struct body_part {
    int number, calm; /* asleep: ~calm */
    double x[3], v[3], l[3];
    double q[4], impulse[3], turn[3], past_impulse[2][3], past_turn[2][3];
};

static struct body_part body_part(const struct scree_bodies *bodies, int k) {
    struct body_part part = {.number = bodies->number[k]};
    if (bodies->calm) part.calm = bodies->class[k] == SCREE_CLASS_ASLEEP ? ~bodies->calm[k] : bodies->calm[k];
    memcpy(part.x, bodies->position[k], sizeof part.x);
    memcpy(part.v, bodies->state[k].v, sizeof part.v);
    memcpy(part.l, bodies->state[k].l, sizeof part.l);
    if (scree_kind_of(bodies, k)->slot >= 0) memcpy(part.q, scree_attitude_of(bodies, k)->q, sizeof part.q);
    memcpy(part.impulse, bodies->record[k].impulse, sizeof part.impulse);
    memcpy(part.turn, bodies->record[k].turn, sizeof part.turn);
    if (!bodies->past) return part;
    memcpy(part.past_impulse, bodies->past[k].impulse, sizeof part.past_impulse);
    memcpy(part.past_turn, bodies->past[k].turn, sizeof part.past_turn);
    return part;
}

static struct scalars scalars_of(const scree_scene *scene) {
    const struct scree_contacts *contacts = &scene->contacts;
    struct scalars scalars;
    memset(&scalars, 0, sizeof scalars);
    scalars.steps = scene->steps;
    scalars.inner_step = scene->inner_step;
    scalars.effort = scene->effort;
    scalars.step = scene->step;
    scalars.energy = scene->time.energy;
    scalars.watched = scene->watched; /* two whole numbers, then doubles: no padding */
    memcpy(scalars.carried, scene->carried, sizeof scalars.carried);
    scalars.driven = scene->driven;
    scalars.first_energy = scene->first_energy;
    scalars.lost_normal = contacts->lost_normal;
    scalars.work_tangential = contacts->work_tangential;
    scalars.deepest = contacts->deepest;
    scalars.steepest = contacts->steepest;
    scalars.deepest_ball = contacts->deepest_ball;
    scalars.deepest_host = contacts->deepest_host;
    scalars.steepest_ball = contacts->steepest_ball;
    scalars.steepest_host = contacts->steepest_host;
    return scalars;
}

static void set_scalars(scree_scene *scene, const struct scalars *scalars) {
    struct scree_contacts *contacts = &scene->contacts;
    scene->steps = scalars->steps;
    scene->inner_step = scalars->inner_step;
    scene->effort = scalars->effort;
    scene->step = scene->plan.choice.step = scalars->step;
    scene->watched = scalars->watched;
    memcpy(scene->carried, scalars->carried, sizeof scene->carried);
    scene->driven = scalars->driven;
    scene->first_energy = scalars->first_energy;
    contacts->lost_normal = scalars->lost_normal;
    contacts->work_tangential = scalars->work_tangential;
    contacts->deepest = scalars->deepest;
    contacts->steepest = scalars->steepest;
    contacts->deepest_ball = scalars->deepest_ball;
    contacts->deepest_host = scalars->deepest_host;
    contacts->steepest_ball = scalars->steepest_ball;
    contacts->steepest_host = scalars->steepest_host;
}

scree_status scree_scene_save(scree_scene *scene, FILE *file, const char *name) {
    if (scene->baked != 1)
        return scree_report(&scene->trouble, SCREE_BAD_INPUT, NULL, "only a scene that has been baked can be saved");
    if (!file) return scree_report(&scene->trouble, SCREE_NO_FILE, NULL, "%s: the file isn't open", name);
    if (scene->waits) /* the impulses of its last step, which are state, have gone into predicted velocities */
        return scree_report(&scene->trouble, SCREE_NO_MEMORY, NULL,
                            "%s: the scene has begun a step for which there was no memory; it can be saved after it",
                            name);
    struct stream s = {.file = file, .hash = scree_hash_start};
    struct scalars scalars = scalars_of(scene);
    struct prints prints = prints_of(scene);
    long memories = count_memories(scene);
    errno = 0;
    put(&s, magic, sizeof magic);
    put(&s, &byte_order_mark, sizeof byte_order_mark);
    put(&s, &prints, sizeof prints);
    put(&s, &scalars, sizeof scalars);
    put(&s, &memories, sizeof memories);
    put(&s, &scene->bodies.order, sizeof scene->bodies.order);
    for (int k = 0; k < scene->bodies.count; k++) {
        struct body_part part = body_part(&scene->bodies, k);
        put(&s, &part, sizeof part);
    }
    put_memories(&s, scene);
    uint64_t hash = s.hash;
    put(&s, &hash, sizeof hash);
    if (s.failed || fflush(file) != 0)
        return scree_report(&scene->trouble, SCREE_NO_FILE, NULL, "%s: %s", name,
                            errno ? strerror(errno) : "can't be written");
    return SCREE_OK;
}

/* Books that the state doesn't hold begin with it. */
static scree_status begin_books(scree_scene *scene) {
    struct scree_contacts *contacts = &scene->contacts;
    scree_energy energy;
    scene->driven = scene->first_energy = contacts->lost_normal = contacts->work_tangential = 0.0;
    scree_status status = scree_scene_energy(scene, &energy);
    if (status) return status;
    contacts->work_tangential = -energy.lost_tangential; /* what tangential springs hold now isn't lost */
    status = scree_scene_energy(scene, &energy);
    scene->first_energy = energy.balance;
    scene->watched = (struct scree_watched){.halvings = scene->watched.halvings};
    return status;
}

/* Put the bodies where the state has them. */
static void take_places(struct scree_scene *scene, const struct scree_order *order, const struct body_part *part) {
    struct scree_bodies *bodies = &scene->bodies;
    int *from = scene->contacts.rough.memory; /* lists have been made */
    for (int k = 0; k < bodies->count; k++) from[k] = bodies->place[part[k].number];
    scree_bodies_permute(bodies, from);
    bodies->order = *order;
    scree_bodies_mark_slabs(bodies);
}

/* Who slept, sleeps on; the others are awake. */
static void take_sleepers(struct scree_scene *scene, const struct body_part *part) {
    struct scree_bodies *bodies = &scene->bodies;
    struct scree_rest *rest = &scene->contacts.rest;
    rest->asleep = 0;
    rest->stale = 1;
    for (int k = 0; k < bodies->count; k++) {
        int asleep = part[k].calm < 0;
        bodies->calm[k] = (unsigned char)(asleep ? ~part[k].calm : part[k].calm);
        if (bodies->class[k] == SCREE_CLASS_ASLEEP) bodies->class[k] = scree_awake_class(bodies, k);
        if (asleep) bodies->class[k] = SCREE_CLASS_ASLEEP;
        rest->asleep += asleep;
    }
}

static scree_status apply(scree_scene *scene, const struct scalars *scalars, const struct scree_order *order,
                          const struct body_part *part, const struct memory *memory, long memories) {
    struct scree_bodies *bodies = &scene->bodies;
    set_scalars(scene, scalars);
    scene->ahead = scene->too_far = scene->waits = scene->contacts.sweep.steps = 0;
    take_places(scene, order, part);
    for (int k = 0; k < bodies->count; k++) {
        memcpy(bodies->position[k], part[k].x, sizeof part[k].x);
        memcpy(bodies->state[k].v, part[k].v, sizeof part[k].v);
        memcpy(bodies->state[k].l, part[k].l, sizeof part[k].l);
        if (scree_kind_of(bodies, k)->slot >= 0) memcpy(scree_attitude_of(bodies, k)->q, part[k].q, sizeof part[k].q);
    }
    scree_bodies_look_now(bodies, scree_scene_time(scene), bodies); /* driven ones too are as saved */
    scree_status status = remember(scene, memory, memories);
    for (int k = 0; k < bodies->count; k++) {
        memcpy(bodies->record[k].impulse, part[k].impulse, sizeof part[k].impulse);
        memcpy(bodies->record[k].turn, part[k].turn, sizeof part[k].turn);
        if (!bodies->past) continue;
        memcpy(bodies->past[k].impulse, part[k].past_impulse, sizeof part[k].past_impulse);
        memcpy(bodies->past[k].turn, part[k].past_turn, sizeof part[k].past_turn);
    }
    if (bodies->calm) take_sleepers(scene, part);
    scene->books_begun = scene->time.energy && !scalars->energy;
    if (!status && scene->books_begun) status = begin_books(scene);
    return status;
}

/* So many contacts' memory, to be freed; NULL: there is no room for it. A damaged number isn't believed: room is made
 * for what comes. */
static struct memory *get_memories(const scree_scene *scene, struct stream *s, long memories) {
    long room = memories < 4096 ? memories + 1 : 4096;
    struct memory *memory = malloc((size_t)room * sizeof *memory);
    for (long k = 0; k < memories && memory && !s->failed; k++) {
        if (k == room) {
            struct memory *more = realloc(memory, 2 * (size_t)room * sizeof *memory);
            if (!more) free(memory);
            memory = more;
            room *= 2;
        }
        if (!memory) break;
        get(s, &memory[k], sizeof memory[k]);
        s->failed |= memory[k].batch < 0 || memory[k].batch >= scene->contacts.batches ||
                     !remembers(&scene->contacts.batch[memory[k].batch]);
    }
    return memory;
}

/* ---- whether a state makes sense, whatever its hash says ---- */

static int all_finite(const void *data, size_t from, size_t end) {
    for (; from < end; from += sizeof(double)) {
        double number;
        memcpy(&number, (const char *)data + from, sizeof number);
        if (!isfinite(number)) return 0;
    }
    return 1;
}

static int is_body(const scree_scene *scene, int number) { return number >= 0 && number < scene->bodies.count; }

static int scalars_hold(const scree_scene *scene, const struct scalars *scalars) {
    const struct scree_watched *watched = &scalars->watched;
    const int pairs[] = {scalars->deepest_ball, scalars->deepest_host, scalars->steepest_ball, scalars->steepest_host};
    for (int k = 0; k < 4; k++)
        if (pairs[k] != -1 && !is_body(scene, pairs[k])) return 0;
    return scalars->steps >= 0 && scalars->step > 0.0 && watched->halvings >= 0 &&
           watched->halvings <= SCREE_HALVINGS && isfinite(scalars->inner_step) &&
           all_finite(scalars, offsetof(struct scalars, step), offsetof(struct scalars, deepest_ball)) &&
           all_finite(watched, offsetof(struct scree_watched, since), sizeof *watched);
}

static int order_holds(const struct scree_order *order, int count) {
    int last = 0;
    if (order->slabs < 0 || order->slabs > SCREE_SLABS || order->members < 0 || order->members > count) return 0;
    if (order->slabs == 0) return 1; /* the rest isn't looked at */
    for (int slab = 0; slab <= order->slabs; slab++) {
        if (order->start[slab] < last || order->start[slab] > count) return 0;
        last = order->start[slab];
    }
    for (int k = 0; k < 3; k++)
        if (order->axis[k] < 0 || order->axis[k] > 2) return 0;
    return all_finite(order, offsetof(struct scree_order, low), sizeof *order);
}

/* Numbers of bodies come once each. */
static int parts_hold(const scree_scene *scene, const struct body_part *part) {
    int count = scene->bodies.count, *seen = scene->contacts.rough.memory; /* as in take_places */
    memset(seen, 0, (size_t)count * sizeof *seen);
    for (int k = 0; k < count; k++) {
        int number = part[k].number;
        if (!is_body(scene, number) || seen[number]++) return 0;
        if (!all_finite(&part[k], offsetof(struct body_part, x), sizeof part[k])) return 0;
    }
    return 1;
}

static int memory_holds(const scree_scene *scene, const struct memory *memory) {
    const struct scree_contact *contact = &memory->contact;
    enum scree_geometry geometry = scene->contacts.batch[memory->batch].geometry;
    int corners = 1 + 8 * scene->bodies.attitudes;
    if (geometry == SCREE_BALL_IMAGE) corners = INT_MAX;
    if (geometry == SCREE_EDGE_EDGE) corners = 1 + SCREE_EDGES * SCREE_EDGES;
    return is_body(scene, contact->ball) && is_body(scene, contact->host) && contact->corner >= 0 &&
           contact->corner < corners && all_finite(memory, offsetof(struct memory, kept), sizeof *memory);
}

static int state_holds(const scree_scene *scene, const struct scree_order *order, const struct body_part *part,
                       const struct memory *memory, long memories) {
    if (!order_holds(order, scene->bodies.count) || !parts_hold(scene, part)) return 0;
    for (long k = 0; k < memories; k++)
        if (!memory_holds(scene, &memory[k])) return 0;
    return 1;
}

/* The arrays behind the head, and the hash; nothing is changed yet. */
static scree_status read_rest(scree_scene *scene, struct stream *s, const char *name, struct scree_order *order,
                              struct body_part *part, struct memory **memory, long memories) {
    get(s, order, sizeof *order);
    for (int k = 0; part && k < scene->bodies.count; k++) get(s, &part[k], sizeof part[k]);
    if (part) *memory = get_memories(scene, s, memories);
    if (!*memory) return scree_report(&scene->trouble, SCREE_NO_MEMORY, NULL, "%s: no memory for the state", name);
    uint64_t hash = s->hash, stored = 0;
    get(s, &stored, sizeof stored);
    if (s->failed || hash != stored || !state_holds(scene, order, part, *memory, memories))
        return scree_report(&scene->trouble, SCREE_BAD_INPUT, NULL, "%s: this state file is damaged or incomplete",
                            name);
    return SCREE_OK;
}

scree_status scree_scene_restore(scree_scene *scene, FILE *file, const char *name) {
    if (scene->baked != 1)
        return scree_report(&scene->trouble, SCREE_BAD_INPUT, NULL, "only a scene that has been baked can be restored");
    if (!file) return scree_report(&scene->trouble, SCREE_NO_FILE, NULL, "%s: the file isn't open", name);
    struct stream s = {.file = file, .hash = scree_hash_start};
    char head[sizeof magic];
    uint64_t mark = 0;
    struct prints prints;
    struct scalars scalars;
    long memories = 0;
    get(&s, head, sizeof head);
    get(&s, &mark, sizeof mark);
    if (ferror(file))
        return scree_report(&scene->trouble, SCREE_NO_FILE, NULL, "%s: can't be read: %s", name, strerror(errno));
    if (s.failed || memcmp(head, magic, sizeof magic) != 0 || mark != byte_order_mark)
        return scree_report(&scene->trouble, SCREE_BAD_INPUT, NULL,
                            "%s: this is no state file of this version of scree and this kind of machine", name);
    get(&s, &prints, sizeof prints);
    get(&s, &scalars, sizeof scalars);
    get(&s, &memories, sizeof memories);
    scree_status status = s.failed ? SCREE_OK : compare(scene, &prints, name);
    if (status) return status;
    if (s.failed || !scalars_hold(scene, &scalars))
        return scree_report(&scene->trouble, SCREE_BAD_INPUT, NULL, "%s: this state file is damaged or incomplete",
                            name);
    status = compare_steps(scene, &scalars, name);
    if (status) return status;
    if (memories < 0 || memories > 2000000000L) memories = 0; /* damaged: the hash will tell */
    struct body_part *part = calloc((size_t)scene->bodies.count + 1, sizeof *part);
    struct memory *memory = NULL;
    struct scree_order order;
    status = read_rest(scene, &s, name, &order, part, &memory, memories);
    if (!status) status = make_room(scene, memory, memories);
    if (!status) memset(scene->halving, 0, sizeof scene->halving); /* the state's own aren't in it */
    if (!status) status = apply(scene, &scalars, &order, part, memory, memories);
    free(part);
    free(memory);
    return status;
}
