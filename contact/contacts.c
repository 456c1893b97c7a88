/* Contacts: the table of rules and batches, and what the laws need to know of a pair of bodies. */
#include "bodies/memory.h"
#include "contact/slabs.h"

#include <stdlib.h>

static scree_status make_batches(struct scree_contacts *contacts, const struct scree_rule *rules) {
    int capacity = contacts->rules * SCREE_GEOMETRIES;
    contacts->batch = calloc((size_t)capacity + 1, sizeof *contacts->batch);
    contacts->batch_of = malloc(((size_t)capacity + 1) * sizeof *contacts->batch_of);
    contacts->busy = malloc(((size_t)capacity + 1) * sizeof *contacts->busy);
    if (!contacts->batch || !contacts->batch_of || !contacts->busy) return SCREE_NO_MEMORY;
    for (int rule = 0; rule < contacts->rules; rule++) {
        contacts->rule[rule] = rules[rule];
        int friction = rules[rule].friction;
        const struct scree_friction_law *law = friction >= 0 ? scree_friction_laws[friction] : NULL;
        const struct scree_rolling_law *rolling =
            rules[rule].rolling >= 0 ? scree_rolling_laws[rules[rule].rolling] : NULL;
        for (int geometry = 0; geometry < SCREE_GEOMETRIES; geometry++) {
            struct scree_batch *batch = &contacts->batch[contacts->batches];
            batch->geometry = (enum scree_geometry)geometry;
            batch->segment = scree_memory(SCREE_SEGMENTS * sizeof *batch->segment);
            if (!batch->segment) return SCREE_NO_MEMORY;
            batch->rule = rule;
            int keeps = scree_normal_laws[rules[rule].normal]->memory || (law && law->memory);
            batch->memory = rolling && rolling->memory ? SCREE_MEMORY : keeps ? SCREE_KEPT_ROLLING : 0;
            for (int m = 0; m < SCREE_MEMORY; m++)
                batch->keeps[m] =
                    (unsigned char)(m < SCREE_KEPT_NORMAL    ? law && law->memory
                                    : m < SCREE_KEPT_ROLLING ? scree_normal_laws[rules[rule].normal]->memory
                                                             : rolling && rolling->memory);
            batch->corners = geometry == SCREE_BALL_IMAGE || geometry == SCREE_EDGE_EDGE;
            batch->turns = law || rolling || geometry == SCREE_BALL_BOX || geometry == SCREE_BALL_RECTANGLE ||
                           geometry == SCREE_EDGE_EDGE;
            batch->slope = law ? law->slope(&rules[rule].friction_constants) : 0.0;
            if (rolling) batch->slope += rolling->slope(&rules[rule].rolling_constants);
            contacts->batch_of[rule * SCREE_GEOMETRIES + geometry] = contacts->batches++;
        }
    }
    return SCREE_OK;
}

static scree_status make_numbers(struct scree_contacts *contacts, size_t bodies) {
    contacts->spare = scree_memory((bodies + 1) * sizeof *contacts->spare);
    contacts->widest = scree_memory((bodies + 1) * sizeof *contacts->widest);
    contacts->plane = scree_memory((bodies + 1) * sizeof *contacts->plane);
    contacts->lent = scree_memory(bodies + 1);
    contacts->gate = scree_memory((bodies / SCREE_SHORTEST_STRIP + SCREE_SLABS) * sizeof *contacts->gate);
    int ok = contacts->spare && contacts->widest && contacts->plane && contacts->lent && contacts->gate;
    return ok ? SCREE_OK : SCREE_NO_MEMORY;
}

scree_status scree_contacts_create(struct scree_contacts *contacts, int bodies, int materials,
                                   const struct scree_rule *rules, int rule_count, scree_trouble *trouble) {
    *contacts = (struct scree_contacts){.loop = scree_choose_loop(),
                                        .loop_for_few = scree_choose_loop_for_few(),
                                        .in_hand = scree_sums_in_hand(),
                                        .cached = scree_bodies_in_cache(),
                                        .materials = materials,
                                        .rules = rule_count,
                                        .deepest_ball = -1,
                                        .deepest_host = -1,
                                        .steepest_ball = -1,
                                        .steepest_host = -1};
    size_t cells = (size_t)materials * (size_t)materials;
    contacts->rule = malloc(((size_t)rule_count + 1) * sizeof *contacts->rule);
    contacts->rule_of = malloc((cells + 1) * sizeof *contacts->rule_of);
    if (!contacts->rule || !contacts->rule_of || make_numbers(contacts, (size_t)bodies) ||
        make_batches(contacts, rules)) {
        scree_contacts_destroy(contacts);
        return scree_report(trouble, SCREE_NO_MEMORY, NULL, "no memory for %d contact rules", rule_count);
    }
    for (size_t k = 0; k < cells; k++) contacts->rule_of[k] = -1;
    for (int k = 0; k < rule_count; k++) {
        int a = rules[k].material[0], b = rules[k].material[1];
        contacts->rule_of[a * materials + b] = contacts->rule_of[b * materials + a] = k;
    }
    return SCREE_OK;
}

void scree_contacts_destroy(struct scree_contacts *contacts) {
    for (int k = 0; k < contacts->batches; k++) {
        struct scree_batch *batch = &contacts->batch[k];
        scree_memory_free(batch->ends);
        scree_memory_free(batch->corner);
        scree_memory_free(batch->yield);
        scree_memory_free(batch->segment);
        scree_memory_free(batch->moments);
        for (int m = 0; m < SCREE_PAIR_COLUMNS; m++) scree_memory_free(batch->pair[m]);
        for (int m = 0; m < SCREE_MEMORY; m++) scree_memory_free(batch->kept[m]);
        scree_memory_free(batch->slides);
        for (int m = 0; m < SCREE_PAST; m++) scree_memory_free(batch->past[m]);
        scree_memory_free(batch->run);
        scree_memory_free(batch->first_run);
        scree_memory_free(batch->works);
        scree_memory_free(batch->holds);
        scree_memory_free(batch->stirring);
    }
    scree_contacts_free_scratch(contacts);
    scree_memory_free(contacts->spare);
    scree_memory_free(contacts->gate);
    scree_memory_free(contacts->widest);
    free(contacts->rule);
    free(contacts->rule_of);
    free(contacts->batch);
    free(contacts->batch_of);
    free(contacts->busy);
    scree_memory_free(contacts->listed.memory);
    scree_memory_free(contacts->rough.memory);
    scree_memory_free(contacts->boxes.memory);
    scree_memory_free(contacts->plane);
    scree_memory_free(contacts->lent);
    scree_memory_free(contacts->rest.border);
    scree_memory_free(contacts->rest.on_border);
    free(contacts->returned);
    scree_memory_free(contacts->moving);
    *contacts = (struct scree_contacts){0};
}

static int has_ball(scree_shape_kind kind) { return kind == SCREE_SPHERE || kind == SCREE_BOX; }

const struct scree_rule *scree_contacts_rule(const struct scree_contacts *contacts, const struct scree_bodies *bodies,
                                             int i, int j, int *missing) {
    if (!scree_joint_can_move(&scree_kind_of(bodies, i)->joint) &&
        !scree_joint_can_move(&scree_kind_of(bodies, j)->joint))
        return NULL;
    if (!has_ball(scree_kind_of(bodies, i)->shape.kind) && !has_ball(scree_kind_of(bodies, j)->shape.kind)) return NULL;
    int rule =
        contacts
            ->rule_of[scree_kind_of(bodies, i)->material * contacts->materials + scree_kind_of(bodies, j)->material];
    if (rule < 0 && missing) *missing = 1;
    if (rule < 0 || !contacts->rule[rule].touches) return NULL;
    return &contacts->rule[rule];
}

double scree_effective_mass(const struct scree_bodies *bodies, int i, int j) {
    double inverse = bodies->record[i].inverse_mass + bodies->record[j].inverse_mass;
    return inverse > 0.0 ? 1.0 / inverse : 0.0;
}

double scree_effective_radius(const struct scree_bodies *bodies, int ball, int host, enum scree_geometry geometry) {
    double r = bodies->record[ball].radius, other = bodies->record[host].radius;
    if (geometry == SCREE_EDGE_EDGE) return sqrt(r * other); /* crossed cylinders, as if at right angles */
    return geometry == SCREE_BALL_BALL || geometry == SCREE_BALL_IMAGE ? r * other / (r + other) : r;
}
