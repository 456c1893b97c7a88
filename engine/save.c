/* Save and restore: the whole state of a run, so that what follows is the same in every bit as without the break.
 *
 * The file: a line of text, a mark of the machine's byte order, a fingerprint of the scene, then the state as it stands in
 * memory, and a hash of all that went before. */
#include "engine/hash.h"
#include "engine/scene.h"

#include <stdlib.h>
#include <string.h>

static const char magic[24] = "scree state 1\n";
static const uint64_t byte_order_mark = 0x0102030405060708u;

/* One remembered contact. */
struct memory {
    struct scree_contact contact;
    int batch;
    double kept[SCREE_MEMORY];
};

/* The scene's scalars that change while it runs. */
struct scalars {
    long steps;
    double driven, first_energy, lost_normal, work_tangential, deepest, steepest;
    int deepest_ball, deepest_host, steepest_ball, steepest_host;
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
    if (s->failed) memset(data, 0, size);
    s->failed |= !s->failed && fread(data, 1, size, s->file) != size;
    s->hash = scree_hash_on(s->hash, data, size);
}

/* What makes a state belong to a scene: bodies, laws, step. */
static uint64_t fingerprint(const scree_scene *scene) {
    const struct scree_bodies *bodies = &scene->bodies;
    uint64_t hash = scree_hash_on(scree_hash_start, &scene->step, sizeof scene->step);
    hash = scree_hash_on(hash, &bodies->count, sizeof bodies->count);
    for (int k = 0; k < bodies->count; k++) {
        const scree_joint *joint = &bodies->joint[k];
        hash = scree_hash_on(hash, bodies->name[k], strlen(bodies->name[k]) + 1);
        hash = scree_hash_on(hash, bodies->inertia[k].inverse_mass, sizeof bodies->inertia[k].inverse_mass);
        hash = scree_hash_on(hash, bodies->inertia[k].moments, sizeof bodies->inertia[k].moments);
        hash = scree_hash_on(hash, joint->along, sizeof joint->along);
        hash = scree_hash_on(hash, &joint->turn, sizeof joint->turn);
        hash = scree_hash_on(hash, &bodies->shape[k].kind, sizeof bodies->shape[k].kind);
        hash = scree_hash_on(hash, bodies->shape[k].edge, sizeof bodies->shape[k].edge);
        hash = scree_hash_on(hash, &bodies->record[k].radius, sizeof bodies->record[k].radius);
        hash = scree_hash_on(hash, &bodies->material[k], sizeof bodies->material[k]);
    }
    for (int k = 0; k < scene->contacts.rules; k++) {
        const struct scree_rule *rule = &scene->contacts.rule[k];
        hash = scree_hash_on(hash, &rule->normal, sizeof rule->normal);
        hash = scree_hash_on(hash, &rule->friction, sizeof rule->friction);
        hash = scree_hash_on(hash, &rule->normal_constants, sizeof rule->normal_constants);
        hash = scree_hash_on(hash, &rule->friction_constants, sizeof rule->friction_constants);
    }
    return hash;
}

/* ---- contact memory as a list ---- */

static long count_memories(const scree_scene *scene) {
    long count = 0;
    for (int b = 0; b < scene->contacts.batches; b++)
        if (scene->contacts.batch[b].memory) count += scene->contacts.batch[b].count;
    return count;
}

static void put_memories(struct stream *s, const scree_scene *scene) {
    for (int b = 0; b < scene->contacts.batches; b++) {
        const struct scree_batch *batch = &scene->contacts.batch[b];
        for (int k = 0; batch->memory && k < batch->count; k++) {
            struct memory memory;
            memset(&memory, 0, sizeof memory);
            memory.contact = batch->contact[k];
            memory.batch = b;
            for (int m = 0; m < SCREE_MEMORY; m++) memory.kept[m] = batch->kept[k / SCREE_LANES][m][k % SCREE_LANES];
            put(s, &memory, sizeof memory);
        }
    }
}

/* Let the lists hold just the remembered contacts; making the list anew then carries their memory over as ever. */
static scree_status remember(scree_scene *scene, const struct memory *memory, long count) {
    struct scree_contacts *contacts = &scene->contacts;
    for (int b = 0; b < contacts->batches; b++) contacts->batch[b].count = 0;
    for (long n = 0; n < count; n++) {
        scree_status status = scree_contacts_remember(&contacts->batch[memory[n].batch], &memory[n].contact,
                                                      memory[n].kept, &scene->trouble);
        if (status) return status;
    }
    return scree_contacts_list(contacts, &scene->bodies, &scene->trouble);
}

/* ---- the whole ---- */

/* A body's part: the impulses of the last step are state too, since velocities are predicted from them. */
struct body_part {
    struct scree_state state;
    double q[4], f[3], t[3];
};

static struct body_part body_part(const struct scree_bodies *bodies, int k) {
    struct body_part part = {.state = bodies->state[k]};
    if (bodies->slot[k] >= 0) memcpy(part.q, bodies->attitude[bodies->slot[k]].q, sizeof part.q);
    memcpy(part.f, bodies->record[k].f, sizeof part.f);
    memcpy(part.t, bodies->record[k].t, sizeof part.t);
    return part;
}

static struct scalars scalars_of(const scree_scene *scene) {
    const struct scree_contacts *contacts = &scene->contacts;
    struct scalars scalars;
    memset(&scalars, 0, sizeof scalars);
    scalars.steps = scene->steps;
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
    struct stream s = {.file = file, .hash = scree_hash_start};
    struct scalars scalars = scalars_of(scene);
    uint64_t print = fingerprint(scene);
    long memories = count_memories(scene);
    put(&s, magic, sizeof magic);
    put(&s, &byte_order_mark, sizeof byte_order_mark);
    put(&s, &print, sizeof print);
    put(&s, &scalars, sizeof scalars);
    put(&s, &memories, sizeof memories);
    for (int k = 0; k < scene->bodies.count; k++) {
        struct body_part part = body_part(&scene->bodies, k);
        put(&s, &part, sizeof part);
    }
    put_memories(&s, scene);
    uint64_t hash = s.hash;
    put(&s, &hash, sizeof hash);
    if (s.failed) return scree_report(&scene->trouble, SCREE_NO_FILE, NULL, "%s: can't be written", name);
    return SCREE_OK;
}

static scree_status apply(scree_scene *scene, const struct scalars *scalars, const struct body_part *part,
                          const struct memory *memory, long memories) {
    struct scree_bodies *bodies = &scene->bodies;
    set_scalars(scene, scalars);
    for (int k = 0; k < bodies->count; k++) {
        bodies->state[k] = part[k].state;
        if (bodies->slot[k] >= 0) memcpy(bodies->attitude[bodies->slot[k]].q, part[k].q, sizeof part[k].q);
    }
    scree_bodies_start(bodies, scree_scene_time(scene));
    scree_status status = remember(scene, memory, memories);
    for (int k = 0; k < bodies->count; k++) {
        memcpy(bodies->record[k].f, part[k].f, sizeof part[k].f);
        memcpy(bodies->record[k].t, part[k].t, sizeof part[k].t);
    }
    return status;
}

/* The arrays behind the head, and the hash; nothing is changed yet. */
static scree_status read_rest(scree_scene *scene, struct stream *s, const char *name, struct body_part *part,
                              struct memory *memory, long memories) {
    if (!part || !memory)
        return scree_report(&scene->trouble, SCREE_NO_MEMORY, NULL, "%s: no memory for the state", name);
    for (int k = 0; k < scene->bodies.count; k++) get(s, &part[k], sizeof part[k]);
    for (long k = 0; k < memories && !s->failed; k++) {
        get(s, &memory[k], sizeof memory[k]);
        if (memory[k].batch < 0 || memory[k].batch >= scene->contacts.batches ||
            !scene->contacts.batch[memory[k].batch].memory)
            s->failed = 1;
    }
    uint64_t hash = s->hash, stored = 0;
    get(s, &stored, sizeof stored);
    if (s->failed || hash != stored)
        return scree_report(&scene->trouble, SCREE_BAD_INPUT, NULL, "%s: this state file is damaged or incomplete",
                            name);
    return SCREE_OK;
}

scree_status scree_scene_restore(scree_scene *scene, FILE *file, const char *name) {
    if (scene->baked != 1)
        return scree_report(&scene->trouble, SCREE_BAD_INPUT, NULL, "only a scene that has been baked can be restored");
    struct stream s = {.file = file, .hash = scree_hash_start};
    char head[sizeof magic];
    uint64_t mark = 0, print = 0;
    struct scalars scalars;
    long memories = 0;
    get(&s, head, sizeof head);
    get(&s, &mark, sizeof mark);
    if (s.failed || memcmp(head, magic, sizeof magic) != 0 || mark != byte_order_mark)
        return scree_report(&scene->trouble, SCREE_BAD_INPUT, NULL,
                            "%s: this is no state file of this version of scree and this kind of machine", name);
    get(&s, &print, sizeof print);
    get(&s, &scalars, sizeof scalars);
    get(&s, &memories, sizeof memories);
    if (!s.failed && print != fingerprint(scene))
        return scree_report(&scene->trouble, SCREE_BAD_INPUT, NULL,
                            "%s: this state belongs to another scene (other bodies, laws or step)", name);
    if (memories < 0 || memories > 2000000000L) memories = 0; /* damaged: the hash will tell */
    struct body_part *part = calloc((size_t)scene->bodies.count + 1, sizeof *part);
    struct memory *memory = calloc((size_t)memories + 1, sizeof *memory);
    scree_status status = read_rest(scene, &s, name, part, memory, memories);
    if (!status) status = apply(scene, &scalars, part, memory, memories);
    free(part);
    free(memory);
    return status;
}
