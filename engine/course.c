/* The course of a step of the scene with the adaptive integrator: flights, steps to a tolerance, events. */
#include "engine/adaptive.h"

#include "contact/meet.h"

#include <math.h>
#include <string.h>

/* Share of the list's skin that a body may move in one step; the list is made anew before it has moved as much. */
static const double longest_way = 0.25;

/* ---- where a step has to end ---- */

/* The next instant after `time` at which a motion changes its formula, s; HUGE_VAL: none. */
static double next_break(const struct scree_scene *scene, double time) {
    double next = HUGE_VAL;
    for (int m = 0; m < scene->bodies.motions; m++) {
        const struct scree_motion *motion = &scene->bodies.motion[m];
        int low = 0, high = motion->count; /* pieces that begin after `time` are from `high` on */
        while (low < high) {
            int middle = low + (high - low) / 2;
            if (motion->pieces[middle].start > time)
                high = middle;
            else
                low = middle + 1;
        }
        if (high < motion->count) next = fmin(next, motion->pieces[high].start);
    }
    return next;
}

/* The largest part of the tolerable way that a body would make in a second. */
static double haste(const struct scree_scene *scene) {
    const struct scree_bodies *bodies = &scene->bodies;
    double fastest = 0.0;
    for (int k = 0; k < bodies->count; k++) {
        if (bodies->class[k] == SCREE_CLASS_FIXED) continue;
        const struct scree_record *record = &bodies->record[k];
        double reach = scree_kind_of(bodies, k)->shape.kind == SCREE_PLANE ? 0.0 : record->bound;
        fastest = fmax(fastest, vec_norm(vec_from(record->v)) + reach * vec_norm(scree_spin_of(bodies, k)));
    }
    return fastest / (longest_way * scene->contacts.skin);
}

/* Paths since the list was made, as they are after a step of `time`; their largest. */
static double lengthen_paths(struct scree_scene *scene, double time, const double *from, const double *to, int keep) {
    const struct scree_adaptive *a = scene->adaptive;
    double longest = 0.0;
    for (int k = 0; k < scene->bodies.count; k++) {
        if (a->at[k] < 0) continue;
        struct scree_record *record = &scene->bodies.record[k];
        double reach = scree_kind_of(&scene->bodies, k)->shape.kind == SCREE_PLANE ? 0.0 : record->bound;
        struct vec moved = vec_sub(vec_from(to + a->at[k]), vec_from(from + a->at[k]));
        const scree_joint *joint = &scree_kind_of(&scene->bodies, k)->joint;
        double way = vec_norm(moved) + time * reach * vec_norm(scree_spin_of(&scene->bodies, k));
        for (int axis = 0; axis < 3; axis++)
            if (joint->along[axis] == SCREE_DRIVEN) way += time * fabs(record->v[axis]);
        longest = fmax(longest, way + (keep ? scene->bodies.path[k] : 0.0));
        if (keep) scene->bodies.path[k] += way;
    }
    return longest;
}

/* ---- the state at the start of a step ---- */

static void set_advancing(struct scree_scene *scene) {
    struct scree_adaptive *a = scene->adaptive;
    for (int k = 0; k < a->grips; k++) {
        if (!a->grip[k].fresh) continue;
        scree_grip_set_advancing(&a->grip[k], &a->sooner[k], &a->later[k]);
        a->grip[k].fresh = 0;
    }
}

/* Rates, views and switch functions at the start of a step, after something has changed. */
static void look_at_start(struct scree_scene *scene) {
    struct scree_adaptive *a = scene->adaptive;
    a->every = 1;
    scree_adaptive_rates(scene, a->y, a->work.k[0]);
    if (scree_adaptive_begin(scene)) {
        for (int k = 0; k < a->grips; k++)
            if (a->grip[k].fresh)
                scene->inner_step = fmin(scene->inner_step, 0.1 * a->grip[k].depth / a->grip[k].speed);
        scree_adaptive_rates(scene, a->y, a->work.k[0]);
    }
    a->every = 0;
    scree_adaptive_switches(scene, a->y, a->work.k[0], a->before);
    int fresh = 0;
    for (int k = 0; k < a->grips; k++) fresh |= a->grip[k].fresh;
    if (!fresh) return;
    set_advancing(scene);
    scree_adaptive_switches(scene, a->y, a->work.k[0], a->before);
}

static int touching(const struct scree_adaptive *a) {
    for (int k = 0; k < a->grips; k++)
        if (a->grip[k].state != SCREE_GRIP_APART) return 1;
    return 0;
}

/* ---- one step ---- */

/* At the time reached; bodies by their places. */
static scree_status stop_at(struct scree_scene *scene, int body, int other, const char *cause) {
    const int *number = scene->bodies.number;
    double time = scene->adaptive->start + scene->adaptive->y[Y_TIME];
    return scree_scene_stop(scene, time, number[body], other >= 0 ? number[other] : -1, cause);
}

static scree_status give_up(struct scree_scene *scene, double step) {
    struct scree_adaptive *a = scene->adaptive;
    int body = a->worst, other = -1;
    double load = 0.0;
    char cause[300], contact[100] = "";
    for (int k = 0; k < a->grips; k++) {
        const struct scree_contact *c = &a->grip[k].contact;
        if (a->grip[k].state != SCREE_GRIP_HELD || (c->ball != body && c->host != body)) continue;
        if (a->grip[k].load <= load) continue;
        load = a->grip[k].load;
        other = c->ball == body ? c->host : c->ball;
        snprintf(contact, sizeof contact, " in the contact by %s%s%s", a->grip[k].normal->text.name,
                 a->grip[k].friction ? ", " : "", a->grip[k].friction ? a->grip[k].friction->text.name : "");
    }
    snprintf(cause, sizeof cause,
             "the tolerance of %.3g can't be reached%s: the step has fallen to %.3g s; a law jumps here, or the "
             "tolerance is below rounding",
             scene->time.tolerance, contact, step);
    return stop_at(scene, body, other, cause);
}

static double spin_energy(const struct scree_inertia *inertia, const double *own) {
    struct mat frame = quat_to_mat(quat_normalise(quat_from(own + OF_Q)));
    struct vec m = mat_undo(&frame, vec_from(own + OF_L));
    return 0.5 * vec_dot(m, vec_times(vec_from(inertia->inverse_moments), m));
}

/* A body that nothing touches turns at constant energy: what the step has lost of it is put back by the smallest turn
 * that does (a projection: Hairer, Lubich & Wanner, Geometric Numerical Integration, 2nd ed. 2006, section IV.4). Its
 * angular momentum is an unknown and stays as it is. Close to a principal axis turns change next to no energy, and none
 * is put back; nor is rounding, which would be a larger turn there than any error. */
static void restore_spin(const struct scree_inertia *inertia, double energy, double *own) {
    struct vec l = vec_from(own + OF_L);
    struct quat q = quat_normalise(quat_from(own + OF_Q));
    struct mat frame = quat_to_mat(q);
    struct vec m = mat_undo(&frame, l), w = vec_times(vec_from(inertia->inverse_moments), m), slope = vec_cross(w, m);
    double size = vec_norm2(slope), lost = energy - 0.5 * vec_dot(m, w);
    if (size > 1e-10 * vec_norm2(w) * vec_norm2(m) && fabs(lost) > 2e-15 * energy) {
        struct vec turn = vec_scale(0.5 * lost / size, slope);
        q = quat_normalise(quat_multiply(q, (struct quat){1.0, turn.x, turn.y, turn.z}));
    }
    quat_store(q, own + OF_Q);
}

static void tidy_attitudes(struct scree_scene *scene) {
    struct scree_adaptive *a = scene->adaptive;
    const struct scree_bodies *bodies = &scene->bodies;
    for (int k = 0; k < bodies->count; k++) {
        if (a->at[k] < 0 || scree_kind_of(bodies, k)->slot < 0 || scree_kind_of(bodies, k)->joint.turn != SCREE_FREE)
            continue;
        double *own = a->arrived + a->at[k];
        if (a->held[k] || scree_attitude_of(bodies, k)->inverse_hinge != 0.0) {
            a->spin_energy[k] = -1.0;
            quat_store(quat_normalise(quat_from(own + OF_Q)), own + OF_Q);
        } else {
            if (a->spin_energy[k] < 0.0)
                a->spin_energy[k] = spin_energy(&scree_kind_of(bodies, k)->inertia, a->y + a->at[k]);
            restore_spin(&scree_kind_of(bodies, k)->inertia, a->spin_energy[k], own);
        }
    }
}

static void note_depths(struct scree_scene *scene) {
    const struct scree_adaptive *a = scene->adaptive;
    struct scree_contacts *contacts = &scene->contacts;
    for (int k = 0; k < a->grips; k++) {
        const struct scree_contact *c = &a->grip[k].contact;
        double limit = fmin(scene->bodies.spin[c->ball].limit, scene->bodies.spin[c->host].limit);
        double depth = a->view[k].overlap / limit;
        if (depth <= contacts->deepest) continue;
        contacts->deepest = depth;
        contacts->deepest_ball = scene->bodies.number[c->ball];
        contacts->deepest_host = scene->bodies.number[c->host];
    }
}

/* Whether a contact of two boxes edge on edge touches, and corners don't bear it. */
static int edges_touch(const struct scree_bodies *bodies, const struct scree_batch *batch, int run) {
    int first = batch->segment[0].first, start = first + batch->run[run].start;
    int end = first + (run + 1 < batch->runs ? batch->run[run + 1].start : batch->segment[0].count);
    struct scree_two_boxes boxes = scree_two_boxes_of(bodies, batch->ends[start].ball, batch->ends[start].host);
    if (scree_meet_as_rectangles(&boxes, batch->run[run].first)) return 0;
    scree_draw_in(&boxes);
    for (int k = start; k < end; k++) {
        struct scree_contact contact = scree_contact_at(batch, k);
        if (scree_cross(&boxes, &contact, SCREE_EDGE_EDGE).meeting.overlap > 0.0) return 1;
    }
    return 0;
}

/* Edges on edges aren't followed: where two touch, the run can't go on. */
static scree_status stop_at_edges(struct scree_scene *scene) {
    struct scree_adaptive *a = scene->adaptive;
    const struct scree_contacts *contacts = &scene->contacts;
    for (int b = 0; b < contacts->batches; b++) {
        const struct scree_batch *batch = &contacts->batch[b];
        if (batch->geometry != SCREE_EDGE_EDGE || batch->count == 0) continue;
        scree_adaptive_place(scene, a->y);
        for (int run = 0; run < batch->runs; run++) {
            const struct scree_ends *ends = &batch->ends[batch->segment[0].first + batch->run[run].start];
            if (edges_touch(&scene->bodies, batch, run))
                return stop_at(scene, ends->ball, ends->host,
                               "an edge touches an edge, which the integrator \"adaptive\" doesn't know; take "
                               "\"verlet\"");
        }
    }
    return SCREE_OK;
}

/* Bodies that come near within the step and part again may touch unseen: where the gap is least on the cubic through
 * both ends, s after the start; 0 where none is in doubt. */
static double doubtful(const struct scree_adaptive *a, double h) {
    for (int k = 0; k < a->grips && a->clock < 0; k++) {
        double d0 = -a->before[k][SCREE_SWITCH_OVERLAP], d1 = a->view[k].overlap, c0 = a->closing[k],
               c1 = a->view[k].closing;
        if (a->grip[k].state != SCREE_GRIP_APART || !(c0 > 0.0 && c1 < 0.0) || d1 > 0.0 || d0 > 0.0) continue;
        double peak = d0 + 0.5 * c0 * c0 / (c0 - c1) * h;
        if (peak > -0.2 * (fabs(d0) + fabs(d1)) && c0 * h > 1e-9 * fabs(d0)) return h * c0 / (c0 - c1);
    }
    return 0.0;
}

struct course {
    double end, segment; /* of the step of the scene; of the time up to the next break, s since the start */
    int fresh;           /* rates and switch functions at y must be reckoned anew */
    int looks;           /* how often a doubtful step was cut already */
};

/* The length to try, in the variable of the step. */
static double length_of(struct scree_scene *scene, const struct course *c) {
    struct scree_adaptive *a = scene->adaptive;
    if (a->clock >= 0) {
        double left = a->goal - a->y[Y_CLOCK];
        return fabs(a->tick) < fabs(left) * 0.999 ? a->tick : left;
    }
    double left = c->segment - a->y[Y_TIME], h = scene->inner_step > 0.0 ? scene->inner_step : 1e-3 * scene->step;
    double hasty = haste(scene), gravity = vec_norm(vec_from(scene->gravity.vector));
    if (hasty * h > 1.0) h = 1.0 / hasty;
    double fall = sqrt(longest_way * scene->contacts.skin / (gravity + SCREE_NO_SPEED));
    if (h > fall) h = fall;
    if (h >= left * (1.0 - 1e-12)) return left;
    return h > 0.5 * left ? 0.5 * left : h;
}

/* Forget the clock: its rates are per its own unit. */
static void drop_clock(struct scree_scene *scene, struct course *c) {
    struct scree_adaptive *a = scene->adaptive;
    a->clock = -1;
    a->y[Y_CLOCK] = 0.0;
    c->fresh = 1;
}

/* A step that was tried. */
struct trial {
    double whole, h;    /* in the variable of the step; up to the first event in it */
    double time, error; /* of the whole: s; in parts of what is tolerable */
    struct scree_event event;
    int tries;
};

/* A slider that isn't asked for a step must not go far in it. */
static void hurry_wary(struct scree_scene *scene) {
    const struct scree_adaptive *a = scene->adaptive;
    for (int k = 0; k < a->grips; k++)
        for (int way = 0; way < SCREE_GRIP_WAYS; way++)
            if (a->grip[k].wary[way])
                scene->inner_step = fmin(scene->inner_step, 1e-3 * a->grip[k].depth / a->grip[k].speed);
}

/* Steps so short, one after the other, lead nowhere, s: a contact hasn't moved then. */
static double next_to_nothing(const struct scree_adaptive *a) {
    double shortest = HUGE_VAL;
    for (int k = 0; k < a->grips; k++)
        if (a->grip[k].state != SCREE_GRIP_APART) shortest = fmin(shortest, a->grip[k].depth / a->grip[k].speed);
    return shortest < HUGE_VAL ? 1e-8 * shortest : 0.0;
}

/* The step is right; take it, up to the first event in it. */
static scree_status take(struct scree_scene *scene, struct course *c, const struct trial *trial) {
    struct scree_adaptive *a = scene->adaptive;
    double h = trial->h, time = a->arrived[Y_TIME] - a->y[Y_TIME];
    double more = trial->error > 0.0 ? 0.9 * scree_pow(trial->error, -0.125) : 6.0;
    more = fmin(fmax(more, 0.3), 6.0);
    int event = trial->event.grip >= 0, landed = a->clock >= 0 && trial->whole == h && a->y[Y_CLOCK] + h == a->goal;
    int parted = landed && a->parting && !event;
    if (event) scree_adaptive_change(scene, trial->event);
    if (a->clock < 0 && !event && a->y[Y_TIME] + h >= c->segment * (1.0 - 1e-15)) a->arrived[Y_TIME] = c->segment;
    if (a->clock >= 0) a->tick = trial->whole * more;
    /* A step that was short because time was up says nothing against longer ones. */
    double next = trial->time * more;
    scene->inner_step = trial->tries == 0 && a->clock < 0 ? fmax(next, fmin(scene->inner_step, 1e3 * next)) : next;
    hurry_wary(scene);
    lengthen_paths(scene, time, a->y, a->arrived, 1);
    tidy_attitudes(scene);
    if (parted) {
        scree_grip_switch(&a->grip[a->clock], SCREE_SWITCH_OVERLAP, &a->view[a->clock],
                          a->arrived + a->place[a->clock]);
        scene->effort.events++;
    }
    note_depths(scene);
    c->fresh |= event || landed;
    for (int k = 0; k < a->grips; k++) scree_grip_settle(&a->grip[k], &a->view[k], a->arrived + a->place[k]);
    double *y = a->y;
    a->y = a->arrived;
    a->arrived = y;
    scene->effort.steps++;
    c->looks = 0;
    if (landed || (event && a->clock >= 0)) drop_clock(scene, c);
    if (!c->fresh) {
        memcpy(a->work.k[0], a->next, a->work.size * sizeof *a->next);
        double(*value)[SCREE_SWITCHES] = a->before;
        a->before = a->value;
        a->value = value;
    }
    a->stalled = time > next_to_nothing(a) ? 0 : a->stalled + 1;
    if (a->stalled > 300)
        return stop_at(scene, a->worst, -1,
                       "contacts near it get nowhere in hundreds of steps: their laws jump where they should be "
                       "continuous, or they are so far from the origin that their overlaps are rounding");
    scree_status status = scree_check_depth(scene, a->start + a->y[Y_TIME]);
    return status ? status : stop_at_edges(scene);
}

/* A step that is cut where it is in doubt is known better: so often it is looked at again. */
enum { MOST_LOOKS = 4 };

/* One step that keeps the tolerance, shortened until it does. */
static scree_status make_step(struct scree_scene *scene, struct course *c) {
    struct scree_adaptive *a = scene->adaptive;
    if (scree_adaptive_clock(scene, c->segment - a->y[Y_TIME])) {
        scree_adaptive_rates(scene, a->y, a->work.k[0]);
        /* Near the begin powers of the clock cancel in the estimates of the error: they can't be trusted with a long
         * step. */
        if (a->clock >= 0) a->tick = (a->goal - a->y[Y_CLOCK]) / (a->parting ? 3.0 : 100.0);
    }
    scree_adaptive_measure(scene);
    for (int k = 0; k < a->grips; k++) a->closing[k] = a->view[k].closing;
    double h = length_of(scene, c);
    for (int tries = 0; tries < 200; tries++) {
        scree_dop853_step(&a->work, scree_adaptive_rates, scene, a->y, h);
        double time = a->work.end[Y_TIME] - a->y[Y_TIME];
        if (a->clock >= 0 && !(time > 0.0 && a->work.end[Y_TIME] <= c->segment)) {
            a->banned = 1;
            drop_clock(scene, c);
            return SCREE_OK;
        }
        double error = scree_adaptive_error(scene, time);
        int far = !(lengthen_paths(scene, time, a->y, a->work.end, 0) <= 2.0 * longest_way * scene->contacts.skin);
        if (error <= 1.0 && !far) {
            memcpy(a->arrived, a->work.end, a->work.size * sizeof *a->arrived);
            a->every = 1;
            scree_adaptive_rates(scene, a->arrived, a->next);
            a->every = 0;
            struct trial trial = {.whole = h, .time = time, .error = error, .tries = tries, .event = {-1, 0}};
            double sooner = c->looks ? 0.0 : doubtful(a, h);
            if (sooner == 0.0) {
                scree_adaptive_switches(scene, a->arrived, a->next, a->value);
                trial.event = scree_adaptive_event(scene, &h);
                trial.h = h;
                /* Cut shorter than rounding of the time, steps would never pass an event. */
                int passes = a->y[Y_TIME] + 0.1 * fabs(a->arrived[Y_TIME] - a->y[Y_TIME]) > a->y[Y_TIME];
                sooner = c->looks < MOST_LOOKS && h != 0.0 && passes ? scree_adaptive_doubt(scene, h) : 0.0;
            }
            if (sooner != 0.0) { /* a clock may run backwards */
                c->looks++;
                h = sooner;
                scene->effort.rejected++;
                continue;
            }
            /* Far beyond an event nothing may act any more: only the step up to there tells how wrong that is. */
            time = a->arrived[Y_TIME] - a->y[Y_TIME];
            if (trial.event.grip >= 0 && h != 0.0) error = scree_adaptive_error(scene, time);
            if (error <= 1.0) return take(scene, c, &trial);
        }
        scene->effort.rejected++;
        double less = far ? 0.5 : error < 1e8 ? fmax(0.1, 0.9 * scree_pow(error, -0.125)) : 0.1;
        h *= fmin(less, 0.9);
        if (a->y[Y_TIME] + 0.1 * fabs(time) == a->y[Y_TIME] || !(fabs(h) > 1e-300)) break;
    }
    return give_up(scene, fabs(a->work.end[Y_TIME] - a->y[Y_TIME]));
}

/* ---- flights ---- */

int scree_adaptive_turn(struct scree_scene *scene, double time) {
    struct scree_adaptive *a = scene->adaptive;
    size_t bytes = a->work.size * sizeof *a->y;
    double h = scene->inner_step > 0.0 ? scene->inner_step : time, done = 0.0;
    memcpy(a->next, a->y, bytes);
    for (int tries = 0; done < time;) {
        double left = time - done, taken = h < left ? h : left;
        scree_adaptive_rates(scene, a->y, a->work.k[0]);
        scree_adaptive_measure(scene);
        scree_dop853_step(&a->work, scree_adaptive_rates, scene, a->y, taken);
        double error = scree_adaptive_error(scene, taken);
        int good = error <= 1.0;
        if (!good && ++tries > 1000) {
            give_up(scene, taken);
            return -1;
        }
        h = taken * (error > 0.0 ? fmin(fmax(0.9 * scree_pow(error, -0.125), 0.1), 6.0) : good ? 6.0 : 0.1);
        scene->effort.steps += good;
        scene->effort.rejected += !good;
        if (!good) continue;
        memcpy(a->arrived, a->work.end, bytes);
        tidy_attitudes(scene);
        memcpy(a->y, a->arrived, bytes);
        done = taken == left ? time : done + taken;
        if (taken < left) scene->inner_step = h;
    }
    for (int k = 0; k < scene->bodies.count; k++)
        if (a->at[k] >= 0) memcpy(a->y + a->at[k], a->next + a->at[k], OF_L * sizeof *a->y);
    a->y[Y_TIME] = a->next[Y_TIME];
    return 0;
}

/* Where nothing touches and only gravity acts. 1: flown, 0: not worth it, -1: it went wrong, as reported. */
static int fly(struct scree_scene *scene, struct course *c) {
    struct scree_adaptive *a = scene->adaptive;
    if (scene->time.no_flight || !scree_adaptive_can_fly(scene) || touching(a)) return 0;
    double left = c->segment - a->y[Y_TIME], safe = scree_adaptive_safe_time(scene, left);
    if (!(safe > 0.0) || (safe < left && safe * haste(scene) < 1.0)) return 0;
    if (scree_adaptive_fly(scene, safe)) return -1;
    if (safe == left) a->y[Y_TIME] = c->segment;
    scene->effort.flights++;
    c->fresh = 1;
    return scree_adaptive_list(scene) ? -1 : 1;
}

/* ---- the step of the scene ---- */

/* What contacts store now, in normal direction, J. */
static scree_status stored_now(struct scree_scene *scene, double *stored) {
    *stored = 0.0;
    if (!scene->time.energy) return SCREE_OK;
    scree_status status = scree_scene_look_now(scene);
    for (int b = 0; b < scene->contacts.batches && !status; b++) {
        const struct scree_batch *batch = &scene->contacts.batch[b];
        for (int k = scree_first(batch); k >= 0; k = scree_next(batch, k)) {
            struct scree_touch touch;
            if (scree_contacts_measure(&scene->contacts, &scene->shadow, b, k, &touch)) *stored += touch.stored;
        }
    }
    return status;
}

static void begin_segment(struct scree_scene *scene, struct course *c) {
    struct scree_adaptive *a = scene->adaptive;
    double now = a->start + a->y[Y_TIME];
    if (now < a->earliest) now = a->earliest;
    double next = next_break(scene, now);
    c->segment = fmin(c->end, next - a->start);
    a->limit = nextafter(next, 0.0);
    a->banned = 0;
    c->fresh = 1;
}

static scree_status integrate(struct scree_scene *scene) {
    struct scree_adaptive *a = scene->adaptive;
    struct course c = {.end = scene->step};
    a->earliest = a->start;
    begin_segment(scene, &c);
    scree_status status = SCREE_OK;
    while (!status && a->y[Y_TIME] < c.end) {
        if (a->y[Y_TIME] >= c.segment) {
            a->earliest = fmax(a->start + c.segment, nextafter(a->limit, HUGE_VAL));
            begin_segment(scene, &c);
        }
        if (c.fresh) look_at_start(scene);
        c.fresh = 0;
        int flown = fly(scene, &c);
        if (flown < 0) status = scene->trouble.status;
        if (flown) continue;
        double longest = 0.0;
        for (int k = 0; k < scene->bodies.count; k++)
            if (scene->adaptive->at[k] >= 0) longest = fmax(longest, scene->bodies.path[k]);
        if (longest > longest_way * scene->contacts.skin) {
            status = scree_adaptive_list(scene);
            c.fresh = 1;
            continue;
        }
        status = make_step(scene, &c);
    }
    return status;
}

scree_status scree_adaptive_step(struct scree_scene *scene) {
    struct scree_adaptive *a = scene->adaptive;
    struct scree_contacts *contacts = &scene->contacts;
    double before, after, inner_step = scene->inner_step;
    scree_status status = stored_now(scene, &before);
    if (!status) status = scree_adaptive_begin_step(scene);
    if (status) return status;
    status = integrate(scene);
    if (status == SCREE_NO_MEMORY) {
        scree_adaptive_go_back(scene);
        scene->inner_step = inner_step;
    }
    if (status) return status;
    a->clock = -1;
    a->every = 1;
    a->limit = HUGE_VAL;
    scree_adaptive_rates(scene, a->y, a->next);
    a->every = 0;
    scree_adaptive_keep(scene);
    scene->steps++;
    scree_bodies_start(&scene->bodies, scree_scene_time(scene));
    status = stored_now(scene, &after);
    if (!scene->time.energy) return status;
    contacts->lost_normal += a->y[Y_WORK] - (after - before);
    contacts->work_tangential += a->y[Y_RUBBED];
    scene->driven += a->y[Y_DRIVEN];
    return status;
}
