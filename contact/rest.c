/* Who sleeps, and which contacts are left out for it. */
#include "contact/rest.h"

#include "bodies/balls.h"
#include "bodies/memory.h"
#include "contact/loop.h"

#include <string.h>

/* Bodies are looked at every so many steps; who has rested so often falls asleep, and one look later has shown its
 * balance. */
enum { LOOK = 64, ENOUGH = 16, SETTLED = ENOUGH + 1 };

int scree_rest_is_look(long steps) { return steps % LOOK == 0; }

scree_status scree_rest_allow(struct scree_contacts *contacts, struct scree_bodies *bodies, double speed, double pull,
                              scree_trouble *trouble) {
    size_t count = (size_t)bodies->count + 1;
    struct scree_rest *rest = &contacts->rest;
    rest->speed = speed;
    rest->pull = pull;
    rest->border = scree_memory(count * sizeof *rest->border);
    rest->on_border = scree_memory(count * sizeof *rest->on_border);
    bodies->calm = scree_memory(count);
    if (rest->border && rest->on_border && bodies->calm) return SCREE_OK;
    return scree_report(trouble, SCREE_NO_MEMORY, NULL, "no memory for %d bodies that may sleep", bodies->count);
}

static int moves(const struct scree_bodies *bodies, int k) {
    return bodies->class[k] == SCREE_CLASS_BALL || bodies->class[k] == SCREE_CLASS_GENERAL;
}

/* ---- the border ---- */

/* Those who are awake may push their partners; those who have just fallen asleep have yet to show their balance. */
static int stirs(const struct scree_bodies *bodies, int k) {
    return moves(bodies, k) || (bodies->class[k] == SCREE_CLASS_ASLEEP && bodies->calm[k] != SETTLED);
}

static void put_on_border(struct scree_rest *rest, const struct scree_bodies *bodies, int k) {
    if (bodies->class[k] != SCREE_CLASS_ASLEEP || rest->on_border[k]) return;
    rest->border[rest->borderers++] = (struct scree_borderer){.body = k};
    rest->on_border[k] = rest->borderers;
}

static void find_border(struct scree_contacts *contacts, const struct scree_bodies *bodies) {
    struct scree_rest *rest = &contacts->rest;
    for (int n = 0; n < rest->borderers; n++) rest->on_border[rest->border[n].body] = 0;
    rest->borderers = 0;
    for (int k = 0; k < bodies->count; k++)
        if (stirs(bodies, k)) put_on_border(rest, bodies, k);
    for (int n = 0; n < contacts->busy_batches; n++) {
        const struct scree_batch *batch = &contacts->batch[contacts->busy[n]];
        for (int s = 0; s < SCREE_SEGMENTS; s++) {
            const struct scree_ends *contact = batch->ends + batch->segment[s].first;
            for (int k = 0; k < batch->segment[s].count; k++) {
                if (stirs(bodies, contact[k].ball)) put_on_border(rest, bodies, contact[k].host);
                if (stirs(bodies, contact[k].host)) put_on_border(rest, bodies, contact[k].ball);
            }
        }
    }
}

static void add_load(struct scree_rest *rest, int body, double sign, struct vec impulse, struct vec turn) {
    if (!rest->on_border[body]) return;
    struct scree_borderer *one = &rest->border[rest->on_border[body] - 1];
    vec_store(vec_axpy(vec_from(one->impulse), sign, impulse), one->impulse);
    vec_store(vec_add(vec_from(one->turn), turn), one->turn);
}

/* What a still contact presses. */
static void load_border(struct scree_contacts *contacts, const struct scree_bodies *bodies, int batch, int index,
                        double step) {
    const struct scree_ends *contact = &contacts->batch[batch].ends[index];
    if (!contacts->rest.on_border[contact->ball] && !contacts->rest.on_border[contact->host]) return;
    struct scree_kick kick = scree_kick_now(contacts, bodies, batch, index, step);
    if (kick.ball < 0) return;
    add_load(&contacts->rest, kick.ball, 1.0, kick.impulse, kick.turn_ball);
    add_load(&contacts->rest, kick.host, -1.0, kick.impulse, kick.turn_host);
}

/* ---- which contacts aren't still ---- */

static scree_status no_memory(int count, scree_trouble *trouble) {
    return scree_report(trouble, SCREE_NO_MEMORY, NULL, "no memory for what %d contacts at rest keep", count);
}

static scree_status keep_still(struct scree_batch *batch, int index, scree_trouble *trouble) {
    if (batch->held == batch->held_capacity) {
        int more = 2 * batch->held_capacity + 256;
        if (!scree_enlarge(&batch->holds, batch->held_capacity, more, sizeof *batch->holds))
            return no_memory(more, trouble);
        batch->held_capacity = more;
    }
    struct scree_held *held = &batch->holds[batch->held++];
    held->index = index;
    for (int m = 0; m < SCREE_MEMORY; m++) held->kept[m] = scree_kept(batch, m, index);
    return SCREE_OK;
}

static scree_status mark_blocks(struct scree_batch *batch, const struct scree_bodies *bodies, scree_trouble *trouble) {
    const struct scree_part *loose = &batch->segment[0];
    int blocks = (loose->count + SCREE_LANES - 1) / SCREE_LANES;
    scree_status status = SCREE_OK;
    if (blocks > batch->works_capacity) {
        if (!scree_enlarge(&batch->works, batch->works_capacity, 2 * blocks, 1)) return no_memory(blocks, trouble);
        batch->works_capacity = 2 * blocks;
    }
    if (blocks) memset(batch->works, 0, (size_t)blocks);
    for (int k = 0; k < loose->count; k++)
        batch->works[k / SCREE_LANES] |= (unsigned char)!scree_is_still(bodies, &batch->ends[loose->first + k]);
    batch->held = 0;
    for (int k = loose->first; k < loose->first + loose->count && !status; k++)
        if (batch->works[(k - loose->first) / SCREE_LANES] && scree_is_still(bodies, &batch->ends[k]))
            status = keep_still(batch, k, trouble);
    return status;
}

static scree_status mark_slabs(struct scree_batch *batch, const struct scree_bodies *bodies, scree_trouble *trouble) {
    int used = 0;
    if (batch->capacity > batch->stirring_capacity) {
        if (!scree_enlarge(&batch->stirring, batch->stirring_capacity, batch->capacity, sizeof *batch->stirring))
            return no_memory(batch->capacity, trouble);
        batch->stirring_capacity = batch->capacity;
    }
    for (int s = 1; s < SCREE_SEGMENTS; s++) {
        struct scree_part *segment = &batch->segment[s];
        segment->stirring_first = used;
        for (int k = segment->first; k < segment->first + segment->count; k++)
            if (!scree_is_still(bodies, &batch->ends[k])) batch->stirring[used++] = k;
        segment->stirring_end = used;
    }
    return SCREE_OK;
}

static scree_status mark(struct scree_contacts *contacts, const struct scree_bodies *bodies, int index, double step,
                         scree_trouble *trouble) {
    struct scree_batch *batch = &contacts->batch[index];
    scree_status status = mark_blocks(batch, bodies, trouble);
    if (!status) status = mark_slabs(batch, bodies, trouble);
    for (int s = 0; s < SCREE_SEGMENTS && !status; s++)
        for (int k = batch->segment[s].first; k < batch->segment[s].first + batch->segment[s].count; k++)
            if (scree_is_still(bodies, &batch->ends[k])) load_border(contacts, bodies, index, k, step);
    return status;
}

scree_status scree_rest_prepare(struct scree_contacts *contacts, struct scree_bodies *bodies, double step,
                                scree_trouble *trouble) {
    struct scree_rest *rest = &contacts->rest;
    if (rest->asleep == 0) return SCREE_OK;
    if (rest->stale) find_border(contacts, bodies);
    for (int n = 0; rest->stale && n < contacts->busy_batches; n++) {
        scree_status status = mark(contacts, bodies, contacts->busy[n], step, trouble);
        if (status) return status;
    }
    rest->stale = 0;
    for (int n = 0; n < rest->borderers; n++) {
        struct scree_record *record = &bodies->record[rest->border[n].body];
        memcpy(record->impulse, rest->border[n].impulse, sizeof record->impulse);
        memcpy(record->turn, rest->border[n].turn, sizeof record->turn);
    }
    return SCREE_OK;
}

void scree_rest_give_back(const struct scree_batch *batch) {
    for (int n = 0; n < batch->held; n++)
        for (int m = 0; m < SCREE_MEMORY; m++) scree_keep(batch, m, batch->holds[n].index, batch->holds[n].kept[m]);
}

/* A block of contacts that lie scattered in a batch, as a batch of its own. */
struct gathered {
    struct scree_batch batch;
    struct scree_ends ends[SCREE_LANES];
    int corner[SCREE_LANES];
    double kept[SCREE_MEMORY][SCREE_LANES], pair[SCREE_PAIR_COLUMNS][SCREE_LANES];
    unsigned char slides[SCREE_LANES];
};

static void gather(const struct scree_batch *batch, const int *index, int count, struct gathered *g) {
    int padded = scree_padded(count);
    for (int k = 0; k < count; k++) scree_put_contact(&g->batch, k, scree_contact_at(batch, index[k]));
    for (int m = 0; m < SCREE_MEMORY; m++)
        for (int k = 0; batch->kept[m] && k < padded; k++) g->kept[m][k] = k < count ? batch->kept[m][index[k]] : 0.0;
    for (int k = 0; batch->slides && k < padded; k++) g->slides[k] = k < count ? batch->slides[index[k]] : 0;
    for (int c = 0; c < SCREE_PAIR_COLUMNS && !batch->uniform; c++)
        for (int k = 0; k < padded; k++) g->pair[c][k] = batch->pair[c][index[k < count ? k : count - 1]];
}

/* What is kept of them, back to where they lie. */
static void put_back(const struct gathered *g, const int *index, int count, const struct scree_batch *batch) {
    for (int m = 0; m < SCREE_MEMORY; m++)
        for (int k = 0; batch->kept[m] && k < count; k++) batch->kept[m][index[k]] = g->kept[m][k];
    for (int k = 0; batch->slides && k < count; k++) batch->slides[index[k]] = g->slides[k];
}

void scree_rest_act(const struct scree_contacts *contacts, struct scree_bodies *bodies, const struct scree_batch *batch,
                    const struct scree_part *segment, double step, struct scree_tally *tally) {
    if (segment->stirring_first == segment->stirring_end) return;
    struct gathered g; /* all that is read of it is set: to clear it would take longer than a few contacts */
    g.batch = *batch;
    g.batch.ends = g.ends;
    g.batch.corner = batch->corner ? g.corner : NULL;
    for (int m = 0; m < SCREE_MEMORY; m++) g.batch.kept[m] = batch->kept[m] ? g.kept[m] : NULL;
    g.batch.slides = batch->slides ? g.slides : NULL;
    for (int c = 0; c < SCREE_PAIR_COLUMNS && !batch->uniform; c++) g.batch.pair[c] = g.pair[c];
    for (int done = segment->stirring_first; done < segment->stirring_end; done += SCREE_LANES) {
        const int *index = batch->stirring + done;
        int count = segment->stirring_end - done < SCREE_LANES ? segment->stirring_end - done : SCREE_LANES;
        gather(batch, index, count, &g);
        contacts->loop->act_straight(contacts, bodies, &g.batch, 0, count, step, tally, &(struct scree_trail){0});
        put_back(&g, index, count, batch);
    }
}

/* ---- falling asleep and waking ---- */

/* By how much the forces on a free body aren't balanced, m/s^2 of its fastest point. */
static double imbalance(const struct scree_bodies *bodies, int k, double step, const double gravity[3]) {
    const struct scree_record *record = &bodies->record[k];
    const double *inverse = scree_kind_of(bodies, k)->inertia.inverse_moments;
    double lightest = fmax(inverse[0], fmax(inverse[1], inverse[2]));
    struct vec pull = vec_axpy(vec_from(gravity), record->inverse_mass / step, vec_from(record->impulse));
    return vec_norm(pull) + vec_norm(vec_from(record->turn)) / step * lightest * record->bound;
}

static int may_sleep(const struct scree_bodies *bodies, int k) {
    const scree_joint *joint = &scree_kind_of(bodies, k)->joint;
    int box = scree_kind_of(bodies, k)->shape.kind == SCREE_BOX;
    int held = joint->along[0] || joint->along[1] || joint->along[2] || joint->turn || joint->axis[0] != 0.0 ||
               joint->axis[1] != 0.0 || joint->axis[2] != 0.0;
    return bodies->class[k] == SCREE_CLASS_BALL || (bodies->class[k] == SCREE_CLASS_GENERAL && box && !held);
}

/* Where the contacts of the step have seen it. */
static void fall_asleep(struct scree_contacts *contacts, struct scree_bodies *bodies, int k) {
    struct scree_state *state = &bodies->state[k];
    struct scree_record *record = &bodies->record[k];
    memcpy(bodies->position[k], record->x, sizeof record->x);
    memset(state->v, 0, sizeof state->v);
    memset(state->l, 0, sizeof state->l);
    memset(record->v, 0, sizeof record->v);
    memset(bodies->spin[k].w, 0, sizeof bodies->spin[k].w);
    if (bodies->class[k] == SCREE_CLASS_GENERAL)
        quat_store(scree_attitude_of(bodies, k)->ahead, scree_attitude_of(bodies, k)->q);
    bodies->class[k] = SCREE_CLASS_ASLEEP;
    contacts->rest.asleep++;
    contacts->rest.stale = 1;
}

/* The next step predicts its speeds from balanced forces. */
static void wake(struct scree_contacts *contacts, struct scree_bodies *bodies, int k, double step,
                 const double gravity[3]) {
    struct scree_record *record = &bodies->record[k];
    for (int axis = 0; axis < 3; axis++) {
        record->impulse[axis] = -step * gravity[axis] * scree_kind_of(bodies, k)->inertia.mass;
        record->turn[axis] = 0.0;
    }
    bodies->class[k] = scree_awake_class(bodies, k);
    bodies->calm[k] = 0;
    contacts->rest.asleep--;
    contacts->rest.stale = 1;
}

void scree_rest_wake(struct scree_contacts *contacts, struct scree_bodies *bodies, double step, const double gravity[3],
                     int ahead) {
    const struct scree_rest *rest = &contacts->rest;
    for (int n = 0; n < rest->borderers; n++) {
        int k = rest->border[n].body;
        if (bodies->class[k] != SCREE_CLASS_ASLEEP || imbalance(bodies, k, step, gravity) <= 4.0 * rest->pull) continue;
        wake(contacts, bodies, k, step, gravity);
        if (ahead && bodies->slab[k] >= 0) /* as all members are already */
            scree_ball_look_ahead(&bodies->record[k], &bodies->spin[k],
                                  scree_ball_rows(&bodies->state[k], bodies->position[k]), step, scree_row_of(gravity),
                                  scree_flight_row(bodies, k));
    }
}

void scree_rest_look(struct scree_contacts *contacts, struct scree_bodies *bodies, double step,
                     const double gravity[3]) {
    const struct scree_rest *rest = &contacts->rest;
    for (int k = 0; k < bodies->count; k++) {
        if (bodies->class[k] == SCREE_CLASS_ASLEEP && bodies->calm[k] < SETTLED) {
            bodies->calm[k]++;
            contacts->rest.stale = 1;
        }
        if (!may_sleep(bodies, k)) continue;
        const struct scree_record *record = &bodies->record[k];
        double speed = scree_fastest_point(bodies, k);
        int drifts = speed > 0.0 && vec_norm2(vec_from(record->impulse)) == 0.0; /* nothing holds it */
        int calm = speed < rest->speed && !drifts ? bodies->calm[k] + 1 : 0;
        bodies->calm[k] = (unsigned char)(calm < ENOUGH ? calm : ENOUGH);
        if (calm >= ENOUGH && imbalance(bodies, k, step, gravity) < rest->pull) fall_asleep(contacts, bodies, k);
    }
}
