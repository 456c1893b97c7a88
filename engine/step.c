/* One time step from top to bottom, and what stops a run. */
#include "contact/rest.h"
#include "engine/scene.h"

#include <math.h>
#include <string.h>

double scree_scene_time(const scree_scene *scene) { return (double)scene->steps * scene->step; }
double scree_scene_step_length(const scree_scene *scene) { return scene->step; }
int scree_scene_asleep(const scree_scene *scene) { return scene->contacts.rest.asleep; }
long scree_scene_steps(const scree_scene *scene) { return scene->steps; }

scree_status scree_scene_stop(struct scree_scene *scene, double time, int body, int other, const char *cause) {
    char who[480] = "", with[160] = "";
    if (other >= 0) snprintf(with, sizeof with, " with \"%.120s\"", scree_name_of(scene, other).text);
    if (body >= 0) snprintf(who, sizeof who, "body \"%s\"%s: ", scree_name_of(scene, body).text, with);
    scree_report(&scene->trouble, SCREE_FAILED, NULL, "stopped at t = %.9g s: %s%s", time, who, cause);
    scene->trouble.time = time;
    scene->trouble.body = body;
    scene->trouble.other = other;
    return SCREE_FAILED;
}

static scree_status stop(scree_scene *scene, int body, int other, const char *cause) {
    int ahead = body >= 0 ? scree_steps_ahead(&scene->contacts, &scene->bodies, scene->bodies.place[body]) : 0;
    return scree_scene_stop(scene, (double)(scene->steps + ahead) * scene->step, body, other, cause);
}

int scree_is_finite(const double a[3]) { return isfinite(a[0]) && isfinite(a[1]) && isfinite(a[2]); }

static int threads_of(const scree_scene *scene) { return scene->time.threads > 0 ? scene->time.threads : 1; }

/* ---- what stops a run ---- */

static int has_numbers(const struct scree_bodies *bodies, int k) {
    const struct scree_record *record = &bodies->record[k];
    return scree_is_finite(record->x) && scree_is_finite(record->v) && scree_is_finite(bodies->spin[k].w);
}

/* Before lists help bodies that moved: those at `place`, or all of them (NULL). */
static scree_status check_numbers(scree_scene *scene, const int *place, int count) {
    const struct scree_bodies *bodies = &scene->bodies;
    int threads = threads_of(scene), lost = 0, first = 0;
    (void)threads; /* without OpenMP */
#pragma omp parallel for schedule(static) num_threads(threads) if (threads > 1 && !place)
    for (int k = 0; k < count; k++)
        if (!has_numbers(bodies, place ? place[k] : k)) __atomic_store_n(&lost, 1, __ATOMIC_RELAXED);
    if (!lost) return SCREE_OK;
    while (has_numbers(bodies, place ? place[first] : first)) first++;
    return stop(scene, bodies->number[place ? place[first] : first], -1,
                "its position or velocity is no longer a finite number; the step is too large or a contact too stiff");
}

/* Looked at from time to time: bodies that are too fast, where they are few in every step, and boxes that are deep in
 * each other. When is a function of the state, not of the lists, or else breaks and outputs would decide whether a run
 * stops. */
enum { STEPS_TO_LOOK = 16, LOOKED_AT_EVERY_STEP = 64 };

static int is_look(const scree_scene *scene) { return scene->steps % STEPS_TO_LOOK == 0; }

/* Whether a point of a body may go farther in a step than that, m: sure if not, and found without root or quotient. */
static int may_exceed(const struct scree_bodies *bodies, const struct scree_bodies *now, int k, double step,
                      double way) {
    double lever = bodies->record[k].bound, around = vec_norm2(scree_start_spin(bodies, now, k)) * lever * lever;
    double square = vec_norm2(scree_start_velocity(bodies, now, k)) + around;
    return bodies->class[k] != SCREE_CLASS_FIXED && !(2.0 * square * step * step < way * way);
}

/* The most that a point of a body goes in a second, m. */
static double speed_of(const struct scree_bodies *bodies, const struct scree_bodies *now, int k) {
    int plane = scree_kind_of(bodies, k)->shape.kind == SCREE_PLANE; /* turns about its normal only */
    double around = plane ? 0.0 : vec_norm(scree_start_spin(bodies, now, k)) * bodies->record[k].bound;
    return vec_norm(scree_start_velocity(bodies, now, k)) + around;
}

/* The longest way of a body in one step, in parts of what the list looks ahead, and which body that is. */
struct haste {
    double most;
    int body;
};

/* Of the bodies from place `from` to `to` - 1 and one before them. */
static struct haste hastiest(const scree_scene *scene, const struct scree_bodies *now, int from, int to,
                             struct haste before) {
    const struct scree_bodies *bodies = &scene->bodies;
    double step = scene->step, seen = scene->contacts.chosen_skin, way = before.most * seen;
    for (int k = from; k < to; k++) {
        if (!may_exceed(bodies, now, k, step, way)) continue;
        double hasty = speed_of(bodies, now, k) * step / seen;
        if (hasty > before.most) before = (struct haste){hasty, bodies->number[k]};
    }
    return before;
}

/* Of all bodies: in parts, by threads. Of two that go as far it is the first one, as without. */
static struct haste hastiest_of_many(const scree_scene *scene, const struct scree_bodies *now, struct haste before) {
    const struct scree_bodies *bodies = &scene->bodies;
    struct haste found[SCREE_PARTS];
    int threads = threads_of(scene);
    (void)threads; /* without OpenMP */
#pragma omp parallel for schedule(static) num_threads(threads) if (threads > 1)
    for (int part = 0; part < SCREE_PARTS; part++)
        found[part] = hastiest(scene, now, scree_part_begin(bodies, part), scree_part_begin(bodies, part + 1), before);
    for (int part = 0; part < SCREE_PARTS; part++)
        if (found[part].most > before.most) before = found[part];
    return before;
}

/* A body that crosses in one step, at its speed of `now`, what a new list keeps watch over. */
static scree_status check_haste(scree_scene *scene, const struct scree_bodies *now) {
    struct haste most = {scene->hasty, scene->hastiest};
    int count = scene->bodies.count;
    most = count > LOOKED_AT_EVERY_STEP ? hastiest_of_many(scene, now, most) : hastiest(scene, now, 0, count, most);
    scene->hasty = most.most;
    scene->hastiest = most.body;
    if (!(scene->hasty > 1.0)) return SCREE_OK;
    char cause[200];
    snprintf(cause, sizeof cause,
             "it moves, or its tips do, %.3g m in one step, more than the list of contacts looks ahead (%.3g m): "
             "it could pass through others unnoticed; take a smaller step",
             scene->hasty * scene->contacts.chosen_skin, scene->contacts.chosen_skin);
    return stop(scene, scene->hastiest, -1, cause);
}

/* For bodies that have outgrown their margins: for a few of them alone, or for all bodies. */
static scree_status renew_list(scree_scene *scene) {
    int asking[SCREE_ASKING];
    int count = scree_contacts_asking(&scene->contacts, &scene->bodies, threads_of(scene), asking);
    scree_status status = check_numbers(scene, count ? asking : NULL, count ? count : scene->bodies.count);
    if (status) return status;
    if (count)
        return scree_contacts_answer(&scene->contacts, &scene->bodies, asking, count, threads_of(scene),
                                     &scene->trouble);
    return scree_contacts_renew(&scene->contacts, &scene->bodies, threads_of(scene), &scene->trouble);
}

static int checks_haste(const scree_scene *scene) {
    return is_look(scene) || scene->bodies.count <= LOOKED_AT_EVERY_STEP;
}

/* Lists that hold in this step; `now`: bodies whose speeds are no guesses. */
static scree_status keep_lists(scree_scene *scene, const struct scree_bodies *now, int outgrown) {
    scree_status status = checks_haste(scene) ? check_haste(scene, now) : SCREE_OK;
    if (!status && outgrown) status = renew_list(scene);
    if (!status && is_look(scene)) scree_contacts_note_boxes(&scene->contacts, &scene->bodies);
    return status;
}

/* Bodies that have left the periodic box return into it at certain steps, whatever lists are made when: so the state,
 * rounding included, depends on neither lists nor breaks. In between they may be outside; by less than their width,
 * they may be so for long. */
enum { STEPS_TO_RETURN = 512 };

static scree_status put_back(scree_scene *scene) {
    struct scree_bodies *bodies = &scene->bodies;
    if (!bodies->periodic || scene->steps % STEPS_TO_RETURN != 0) return SCREE_OK;
    scree_status status = scree_contacts_return(&scene->contacts, bodies, threads_of(scene), &scene->trouble);
    for (int n = 0; n < scene->contacts.returns && !status; n++) {
        const struct scree_return *out = &scene->contacts.returned[n];
        for (int axis = 0; axis < 3; axis++)
            scene->carried[axis] +=
                scree_kind_of(bodies, out->body)->inertia.mass * out->periods[axis] * bodies->period[axis];
    }
    return status;
}

scree_status scree_check_depth(struct scree_scene *scene, double time) {
    const struct scree_contacts *contacts = &scene->contacts;
    if (contacts->deepest <= 1.0) return SCREE_OK;
    char cause[160];
    int ball = scene->bodies.place[contacts->deepest_ball], host = scene->bodies.place[contacts->deepest_host];
    double limit = fmin(scene->bodies.spin[ball].limit, scene->bodies.spin[host].limit);
    snprintf(cause, sizeof cause,
             "overlap of %.6g m, beyond half a half-width (%.6g m): too soft, too fast or too long a step",
             contacts->deepest * limit, limit);
    return scree_scene_stop(scene, time, contacts->deepest_ball, contacts->deepest_host, cause);
}

/* Whether members of slabs move on right behind their contacts. Not where gravity's work on them is booked as it tilts:
 * that is done by where they are in the middle of the step. */
static int moves_at_once(const scree_scene *scene) {
    return scene->bodies.order.slabs > 0 && !(scene->time.energy && scene->gravity.tilts);
}

/* Work of the drives on their bodies during the step, and of gravity's tilting. Members of slabs have no drives. */
static void book_drives(scree_scene *scene, double time) {
    const struct scree_bodies *bodies = &scene->bodies;
    int count = moves_at_once(scene) ? bodies->order.members : bodies->count;
    double before[3], after[3];
    scree_gravity_at(scene, time, before);
    scree_gravity_at(scene, time + scene->step, after);
    for (int axis = 0; axis < 3 && scene->gravity.tilts; axis++)
        scene->driven -= scene->carried[axis] * (after[axis] - before[axis]);
    for (int k = 0; k < count; k++) {
        const struct scree_record *record = &bodies->record[k];
        const scree_joint *joint = &scree_kind_of(bodies, k)->joint;
        for (int axis = 0; axis < 3; axis++) {
            if (joint->along[axis] == SCREE_DRIVEN) scene->driven -= record->impulse[axis] * record->v[axis];
            if (joint->along[axis] == SCREE_FREE && scene->gravity.tilts)
                scene->driven -=
                    scree_kind_of(bodies, k)->inertia.mass * (after[axis] - before[axis]) * record->x[axis];
            if (joint->turn == SCREE_DRIVEN) scene->driven -= record->turn[axis] * bodies->spin[k].w[axis];
        }
    }
}

/* From time to time the bodies are put in order; when, is a function of the state. */
enum { STEPS_TO_ORDER = 512 };

static scree_status keep_order(scree_scene *scene) {
    if (scene->steps % STEPS_TO_ORDER != 0 || scene->steps == 0) return SCREE_OK;
    return scree_contacts_keep_order(&scene->contacts, &scene->bodies, threads_of(scene), &scene->trouble);
}

static int goes_by_impulses(const scree_scene *scene) { return scene->time.integrator == SCREE_PAIR_IMPULSE; }

/* Bring the records to the middle of the step; members of slabs that are there already stay. Nonzero: lists must be
 * looked at. */
static int look_ahead(scree_scene *scene, const double gravity[3]) {
    struct scree_bodies *bodies = &scene->bodies;
    if (scene->waits) return 1;
    int count = scene->ahead ? bodies->order.members : bodies->count, too_far = scene->ahead && scene->too_far;
    scene->ahead = 0;
    if (goes_by_impulses(scene))
        return too_far | scene->contacts.broken |
               scree_contacts_look_both(&scene->contacts, bodies, count, scree_scene_time(scene), scene->step, gravity,
                                        0.5 * scene->contacts.skin, &scene->shadow, threads_of(scene));
    too_far |= scene->contacts.broken | scree_flights_over(&scene->contacts);
    return too_far | scree_bodies_look_ahead(bodies, count, scree_scene_time(scene), scene->step, gravity,
                                             0.5 * scene->contacts.skin);
}

/* Contacts, and members of slabs behind them. Returns whether one of these has outgrown its margin. */
static int act(scree_scene *scene, const struct scree_departure *go) {
    struct scree_bodies *bodies = &scene->bodies, *now = &scene->shadow;
    struct scree_contacts *contacts = &scene->contacts;
    int threads = threads_of(scene);
    return goes_by_impulses(scene) ? scree_contacts_impel(contacts, bodies, now, scene->step, threads, go)
                                   : scree_contacts_act(contacts, bodies, scene->step, threads, go);
}

/* Contacts, and then bodies: members of slabs move on while they are at hand, as far as the middle of the next step if
 * there is one (`more`). Lists are renewed where a sweep stops for them on its way. */
static scree_status act_and_advance(scree_scene *scene, const double gravity[3], int steps, int more) {
    struct scree_bodies *bodies = &scene->bodies;
    struct scree_contacts *contacts = &scene->contacts;
    double time = scree_scene_time(scene), step = scene->step;
    struct scree_departure go = {.step = step,
                                 .steps = steps,
                                 .ahead = contacts->sweep.steps ? contacts->sweep.ahead : more,
                                 .by_moments = goes_by_impulses(scene)};
    int at_once = moves_at_once(scene);
    go.to_come = steps > 1 ? SCREE_SWEEP - 0.5 : 0.5; /* so that the next sweep needn't stop on its way */
    memcpy(go.gravity, gravity, sizeof go.gravity);
    scree_gravity_at(scene, (double)(scene->steps + 1) * step + 0.5 * step, go.next_gravity);
    do {
        scree_status status = contacts->sweep.steps ? renew_list(scene) : SCREE_OK;
        if (status) return status;
        go.margin = 0.5 * contacts->skin;
        scene->too_far = act(scene, at_once ? &go : NULL);
    } while (contacts->sweep.steps);
    scene->ahead = at_once && go.ahead;
    if (scene->time.energy) book_drives(scene, time);
    int others = at_once ? bodies->order.members : bodies->count;
    if (go.by_moments)
        scree_contacts_advance_by_moments(contacts, bodies, others, time, step, gravity, threads_of(scene));
    else
        scree_bodies_advance(bodies, others, time, step, gravity);
    return SCREE_OK;
}

/* Not where each step has books of its own, or a gravity; nor where threads share the slabs. */
static int may_sweep(const scree_scene *scene) {
    return scene->time.integrator != SCREE_ADAPTIVE && threads_of(scene) == 1 && !scene->time.energy &&
           !scene->gravity.tilts;
}

int scree_scene_most_in_sweep(const scree_scene *scene) {
    return may_sweep(scene) ? scree_most_in_sweep(&scene->contacts, &scene->bodies) : 1;
}

/* How many steps are done in one sweep, of `left`: none before which all bodies are looked at, or put in order, begins
 * within it. */
static int steps_of_sweep(scree_scene *scene, long left) {
    struct scree_contacts *contacts = &scene->contacts;
    if (contacts->sweep.steps) return contacts->sweep.steps; /* for which there was no memory to go on */
    int most = may_sweep(scene) ? scree_steps_in_sweep(contacts, &scene->bodies) : 1;
    int steps = most - (int)(scene->steps % most);
    return left < steps ? (int)left : steps;
}
_Static_assert(STEPS_TO_LOOK % SCREE_SWEEP == 0 && STEPS_TO_ORDER % SCREE_SWEEP == 0,
               "sweeps end where bodies are seen to");

/* Bodies that may have to return first don't go to the middle of the next step at once: that would round otherwise than
 * after a break. Nor those that may fall asleep where they are, or be put in the order of their positions. */
static int may_hurry(const scree_scene *scene, long next) {
    return next % STEPS_TO_ORDER != 0 && !(scene->bodies.periodic && next % STEPS_TO_RETURN == 0) &&
           !(scene->time.sleep > 0.0 && scree_rest_is_look(next));
}

static void wake_or_rest(scree_scene *scene, const double gravity[3]) {
    scree_rest_wake(&scene->contacts, &scene->bodies, scene->step, gravity, scene->ahead);
    if (scree_rest_is_look(scene->steps)) scree_rest_look(&scene->contacts, &scene->bodies, scene->step, gravity);
}

/* By Verlet's method, or by pair impulses, which keep positions on the way, too: several steps in one sweep, if there
 * are so many `left`. */
static scree_status step_by_sweeps(scree_scene *scene, long left) {
    struct scree_contacts *contacts = &scene->contacts;
    scree_status status = SCREE_OK;
    double gravity[3];
    scree_gravity_at(scene, scree_scene_time(scene) + 0.5 * scene->step, gravity);
    if (!contacts->sweep.steps)
        status =
            keep_lists(scene, goes_by_impulses(scene) ? &scene->shadow : &scene->bodies, look_ahead(scene, gravity));
    if (!status) status = scree_rest_prepare(contacts, &scene->bodies, scene->step, &scene->trouble);
    int steps = status ? 0 : steps_of_sweep(scene, left);
    long end = scene->steps + steps;
    if (!status) status = act_and_advance(scene, gravity, steps, left > steps && may_hurry(scene, end));
    scene->waits = status == SCREE_NO_MEMORY;
    if (status) return status;
    double deep = (double)(scene->steps + contacts->sweep.told) * scene->step;
    scene->steps = end;
    if (scene->time.sleep > 0.0) wake_or_rest(scene, gravity);
    return scree_check_depth(scene, deep);
}

/* A step, or some of those that are `left`. */
static scree_status step_on(scree_scene *scene, long left) {
    if (scene->contacts.sweep.steps) return step_by_sweeps(scene, left); /* where it stopped on its way */
    scree_status status = put_back(scene);
    if (!status) status = keep_order(scene);
    if (status) return status;
    if (scene->time.integrator == SCREE_ADAPTIVE) {
        status = scree_adaptive_step(scene);
        if (!status) scree_contacts_note_boxes(&scene->contacts, &scene->bodies);
        return status ? status : scree_check_depth(scene, scree_scene_time(scene));
    }
    return step_by_sweeps(scene, left);
}

scree_status scree_scene_step(scree_scene *scene, long steps) {
    if (scene->baked != 1)
        return scree_report(&scene->trouble, SCREE_BAD_INPUT, NULL, "only a scene that has been baked can step");
    if (steps < 0 || steps > 1000000000000000)
        return scree_report(&scene->trouble, SCREE_BAD_INPUT, NULL, "a scene goes on by 0 to 1e15 steps, not %ld",
                            steps);
    return scene->time.watch == SCREE_WATCH_HALVE ? scree_step_watched(scene, steps) : scree_step_plainly(scene, steps);
}

/* Where a run has stopped: of members that are at the middle of their next step, but of those that are at the end of a
 * sweep behind which there is none. */
static void find_positions(scree_scene *scene, int ahead) {
    const struct scree_sweep *sweep = &scene->contacts.sweep;
    struct scree_bodies *bodies = &scene->bodies;
    for (int slab = 0; slab < bodies->order.slabs && (ahead || sweep->steps); slab++) {
        const int *start = &bodies->order.start[slab];
        int arrived = sweep->steps && scree_steps_ahead(&scene->contacts, bodies, start[0]) == sweep->steps;
        if (!arrived || sweep->ahead) scree_bodies_find_positions(bodies, start[0], start[1], scene->step);
    }
}

scree_status scree_step_plainly(struct scree_scene *scene, long steps) {
    for (long end = scene->steps + steps; scene->steps < end;) {
        long before = scene->steps;
        int ahead = scene->ahead;
        scree_status status = step_on(scene, end - before);
        if (!status) continue;
        if (scene->time.integrator == SCREE_VERLET) find_positions(scene, scene->steps > before ? scene->ahead : ahead);
        return status;
    }
    return SCREE_OK;
}
