/* A contact as it is at one instant, measured without changing anything: by the laws' descriptions, apart from the
 * loop. */
#include "contact/meet.h"
#include "contact/slider.h"

/* A stretch as it is at the end of a step, which has turned it as far as its middle (contact/law.h). */
static struct vec stretch_now(const struct scree_contacts *contacts, const struct scree_bodies *bodies, struct vec kept,
                              const struct scree_touch *touch) {
    struct vec spins = vec_add(scree_spin_of(bodies, touch->ball), scree_spin_of(bodies, touch->host));
    return scree_turned(kept, touch->normal, spins, 0.5 * contacts->step);
}

/* A slider that holds, as it was kept: what it bears beyond that is an error of the step, no slip yet. */
static struct scree_tangential measure_held(const struct scree_rule *rule, struct scree_pair_constants pair,
                                            struct scree_sliding at) {
    const struct scree_friction_law *friction = scree_friction_laws[rule->friction];
    const struct scree_law_constants *law = &rule->friction_constants;
    double k = friction->in_force ? 1.0 : friction->stiffness(law, pair, at.overlap);
    double c = friction->damping(law, pair, at.overlap), holds = friction->hold(law, at).holds;
    struct vec trial = scree_slider_trial(k, c, at.stretch, at.velocity);
    double size = vec_norm(trial);
    return (struct scree_tangential){vec_scale(size > holds ? -holds / size : -1.0, trial), at.stretch, 0.0};
}

/* Friction at this instant, and what its spring holds. */
static void measure_friction(const struct scree_contacts *contacts, const struct scree_bodies *bodies,
                             struct scree_pair_constants pair, const struct scree_batch *batch, int index,
                             struct scree_touch *touch) {
    const struct scree_rule *rule = &contacts->rule[batch->rule];
    const struct scree_friction_law *friction = scree_friction_laws[rule->friction];
    struct scree_sliding at = {.normal = touch->load, .overlap = touch->overlap, .velocity = touch->slip};
    if (friction->memory) {
        struct vec kept = vec(scree_kept(batch, 0, index), scree_kept(batch, 1, index), scree_kept(batch, 2, index));
        at.stretch = stretch_now(contacts, bodies, kept, touch);
        at.sliding = scree_kept(batch, 3, index);
    }
    int held = friction->hold && !(at.sliding > 0.0);
    struct scree_tangential t =
        held ? measure_held(rule, pair, at) : friction->force(&rule->friction_constants, pair, at);
    touch->tangential = t.force;
    touch->stretch = t.stretch;
    touch->sliding = at.sliding > 0.0; /* as kept: asked again, a force that is just what holds goes by its rounding */
    at.stretch = t.stretch;
    touch->stored_in_friction = friction->stored(&rule->friction_constants, pair, at);
}

/* Torque of the rolling law at this instant, and what its springs hold. */
static void measure_turning(const struct scree_contacts *contacts, const struct scree_bodies *bodies,
                            const struct scree_rule *rule, double lever, const double kept[6],
                            struct scree_touch *touch) {
    const struct scree_rolling_law *law = scree_rolling_laws[rule->rolling];
    const struct scree_law_constants *constants = &rule->rolling_constants;
    struct vec n = touch->normal;
    struct vec spin = vec_sub(scree_spin_of(bodies, touch->ball), scree_spin_of(bodies, touch->host));
    struct vec velocity = vec_scale(lever, spin);
    double along = vec_dot(velocity, n);
    struct scree_sliding at = {
        .normal = touch->load, .overlap = touch->overlap, .velocity = vec_axpy(velocity, -along, n)};
    at.stretch = stretch_now(contacts, bodies, vec_from(kept), touch);
    at.sliding = kept[3];
    struct scree_tangential r = law->resist(constants, constants->c[SCREE_ROLLING_COEFFICIENT], at);
    at.velocity = vec(along, 0.0, 0.0);
    at.stretch = vec(kept[4], 0.0, 0.0);
    at.sliding = kept[5];
    struct scree_tangential s = law->resist(constants, constants->c[SCREE_TWISTING_COEFFICIENT], at);
    touch->torque = vec_scale(lever, vec_axpy(r.force, s.force.x, n));
    touch->stored_in_friction += 0.5 * law->stiffness(constants) * (vec_norm2(r.stretch) + s.stretch.x * s.stretch.x);
}

/* Where and how a contact moves; `m` receives normal and overlap, `lean` what boxes do besides,
 * `borne` the part of the normal force that friction counts from. */
static struct scree_gait gait_of(const struct scree_contacts *contacts, const struct scree_bodies *bodies,
                                 const struct scree_contact *contact, const struct scree_batch *batch,
                                 struct scree_meeting *m, struct scree_gradient *lean, double *borne) {
    enum scree_geometry geometry = batch->geometry;
    int rolls = contacts->rule[batch->rule].rolling >= 0;
    const struct scree_record *ball = &bodies->record[contact->ball], *host = &bodies->record[contact->host];
    if (geometry == SCREE_EDGE_EDGE || (geometry == SCREE_BALL_BOX && contact->corner > 0)) {
        struct scree_two_boxes boxes = scree_deep_boxes_of(bodies, contact);
        int steps = contacts->step > 0.0; /* the adaptive integrator takes corners as they are, however deep */
        if (geometry == SCREE_EDGE_EDGE || (steps && boxes.inset.by > 0.0)) {
            struct scree_crossing crossing = scree_cross(&boxes, contact, geometry);
            *m = crossing.meeting;
            *lean = scree_lean_of(&crossing, boxes.apart);
            *borne = scree_borne(&crossing, lean, boxes.inset.by > 0.0);
            return scree_gait_on_edges(bodies, contact, &crossing);
        }
    }
    struct vec corner = scree_corner_of(bodies, contact, geometry);
    *m = scree_meet(bodies, contact, geometry, vec_add(vec_from(ball->x), corner));
    struct vec velocity = vec_sub(vec_from(ball->v), vec_from(host->v)), none = {0.0, 0.0, 0.0};
    struct vec ball_spin = scree_spin_of(bodies, contact->ball), host_spin = scree_spin_of(bodies, contact->host);
    if (geometry == SCREE_BALL_BALL || geometry == SCREE_BALL_IMAGE) {
        double radii = ball->radius + host->radius, closing = -vec_dot(velocity, m->normal);
        struct scree_roll roll =
            scree_goes_even(bodies, batch, rolls)
                ? scree_roll_even(m->normal, m->overlap, radii, velocity, closing, vec_add(ball_spin, host_spin))
                : scree_roll_of(m->normal, m->overlap, ball->radius, radii, velocity, closing, ball_spin, host_spin);
        return (struct scree_gait){vec_axpy(none, -roll.lever, m->normal), roll.slip, closing, 0.0};
    }
    return scree_gait_of(m->normal, m->overlap, ball->radius, corner, scree_apart(bodies, contact, geometry), velocity,
                         ball_spin, host_spin);
}

/* What crossings take off the corner of a box, N. */
static double relief_of(const struct scree_bodies *bodies, const struct scree_rule *rule,
                        const struct scree_contact *contact) {
    struct scree_two_boxes boxes = scree_deep_boxes_of(bodies, contact);
    return scree_relief(bodies, rule, contact, &boxes);
}

static int are_rectangles(const struct scree_bodies *bodies, const struct scree_contact *contact) {
    struct scree_two_boxes boxes = scree_two_boxes_of(bodies, contact->ball, contact->host);
    return scree_meet_as_rectangles(&boxes, (struct scree_rectangles){0, 0, 1});
}

int scree_contacts_measure(const struct scree_contacts *contacts, const struct scree_bodies *bodies, int batch_index,
                           int index, struct scree_touch *touch) {
    const struct scree_batch *batch = &contacts->batch[batch_index];
    struct scree_contact own = scree_contact_at(batch, index), *contact = &own;
    const struct scree_rule *rule = &contacts->rule[batch->rule];
    const struct scree_record *ball = &bodies->record[contact->ball];
    if (batch->geometry == SCREE_EDGE_EDGE && are_rectangles(bodies, contact)) return 0; /* corners bear all */
    struct scree_meeting m;
    struct vec none = {0.0, 0.0, 0.0};
    struct scree_gradient lean = {none, none, none};
    double borne = 1.0, relief = 0.0;
    struct scree_gait gait = gait_of(contacts, bodies, contact, batch, &m, &lean, &borne);
    const struct scree_normal_law *normal = scree_normal_laws[rule->normal];
    struct scree_pressing pressing = scree_pressed(m.overlap, gait.closing, 0.0, 0.0);
    if (normal->memory) {
        pressing.first = scree_kept(batch, SCREE_KEPT_NORMAL, index);
        pressing.second = scree_kept(batch, SCREE_KEPT_NORMAL + 1, index);
    }
    struct scree_pair_constants pair, tangential_pair = {{0.0}};
    for (int c = 0; c < SCREE_PAIR_CONSTANTS; c++) pair.c[c] = scree_pair(batch, c, index);
    for (int c = SCREE_PAIR_FRICTION; c < SCREE_PAIR_LEVER; c++)
        tangential_pair.c[c - SCREE_PAIR_FRICTION] = scree_pair(batch, c, index);
    struct scree_normal_force f = normal->force(&rule->normal_constants, pair, pressing);
    if (!(normal->reach ? f.second > 0.0 : m.overlap > 0.0)) return 0;
    /* Until the loop has booked what attaching costs, the contact hasn't cost it. */
    int unbooked = normal->reach && !(pressing.second > 0.0);
    double force = f.elastic + f.damping * gait.closing;
    pressing.first = f.first;
    pressing.second = f.second;
    *touch = (struct scree_touch){.ball = contact->ball,
                                  .host = contact->host,
                                  .corner = batch->geometry == SCREE_BALL_IMAGE ? 0 : contact->corner};
    touch->edges = batch->geometry == SCREE_EDGE_EDGE;
    touch->overlap = m.overlap;
    touch->closing = gait.closing + gait.untold;
    touch->normal_force = normal->cut && force < 0.0 ? 0.0 : force;
    int rubs = rule->friction >= 0 || rule->rolling >= 0;
    if (rubs && contacts->step > 0.0 && scree_may_be_relieved(bodies, contact) && batch->geometry == SCREE_BALL_BOX)
        relief = relief_of(bodies, rule, contact);
    touch->load = touch->normal_force > 0.0 ? fmax(touch->normal_force * borne - relief, 0.0) : 0.0;
    touch->stored = normal->stored(&rule->normal_constants, pair, pressing);
    if (unbooked) touch->stored += scree_snap_energy(normal->stored, &rule->normal_constants, pair);
    touch->normal = m.normal;
    touch->lean = lean;
    touch->point = vec_add(vec_from(ball->x), gait.arm);
    touch->slip = gait.slip;
    if (rule->friction >= 0) measure_friction(contacts, bodies, tangential_pair, batch, index, touch);
    if (rule->rolling < 0) return 1;
    double turned[6] = {0.0};
    for (int k = 0; scree_rolling_laws[rule->rolling]->memory && k < 6; k++)
        turned[k] = scree_kept(batch, SCREE_KEPT_ROLLING + k, index);
    measure_turning(contacts, bodies, rule, scree_pair(batch, SCREE_PAIR_LEVER, index), turned, touch);
    return 1;
}

struct scree_kick scree_kick_now(const struct scree_contacts *contacts, const struct scree_bodies *bodies,
                                 int batch_index, int index, double step) {
    const struct scree_batch *batch = &contacts->batch[batch_index];
    struct scree_kick kick = {.ball = -1};
    struct scree_touch touch;
    if (!scree_contacts_measure(contacts, bodies, batch_index, index, &touch)) return kick;
    struct vec arm = vec_sub(touch.point, vec_from(bodies->record[touch.ball].x));
    struct scree_contact own = scree_contact_at(batch, index);
    struct vec host_arm = vec_add(arm, scree_apart(bodies, &own, batch->geometry));
    int turns = scree_contact_turns(batch, &own);
    kick.ball = touch.ball;
    kick.host = touch.host;
    kick.overlap = touch.overlap;
    double j = step * touch.normal_force;
    kick.straight = vec_scale(step, vec_axpy(touch.tangential, touch.normal_force, touch.normal));
    kick.impulse = vec_axpy(kick.straight, j, touch.lean.force);
    kick.turn_ball = vec_scale(turns, vec_axpy(vec_cross(arm, kick.straight), j, touch.lean.turn_a));
    kick.turn_host = vec_scale(turns, vec_axpy(vec_cross(kick.straight, host_arm), j, touch.lean.turn_b));
    return kick;
}

void scree_contacts_begin(const struct scree_contacts *contacts, struct scree_bodies *bodies, double step) {
    for (int b = 0; b < contacts->batches; b++) {
        const struct scree_batch *batch = &contacts->batch[b];
        for (int k = scree_first(batch); k >= 0; k = scree_next(batch, k)) {
            struct scree_kick kick = scree_kick_now(contacts, bodies, b, k, step);
            if (kick.ball < 0) continue;
            struct scree_record *ball = &bodies->record[kick.ball], *host = &bodies->record[kick.host];
            vec_store(vec_add(vec_from(ball->impulse), kick.impulse), ball->impulse);
            vec_store(vec_sub(vec_from(host->impulse), kick.impulse), host->impulse);
            vec_store(vec_add(vec_from(ball->turn), kick.turn_ball), ball->turn);
            vec_store(vec_add(vec_from(host->turn), kick.turn_host), host->turn);
        }
    }
}
