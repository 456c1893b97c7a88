/* A contact at one instant: forces, rates of its memory, phases. */
#include "contact/grip.h"

#include "contact/bristle.h"
#include "contact/meet.h"

#include <string.h>

/* Closing speed that stands for "approaching, barely". */
#define BARELY 1e-300

int scree_grip_is_slider(const struct scree_grip *grip, int way) {
    if (way == SCREE_GRIP_FRICTION) return grip->friction && grip->friction->hold;
    return grip->rolling && grip->rolling->memory;
}

int scree_grip_may_slip(const struct scree_grip *grip, int way) {
    return scree_grip_is_slider(grip, way) || (way == SCREE_GRIP_FRICTION && grip->friction && grip->friction->rate);
}

const char *scree_grip_refuses(const struct scree_rule *rule) {
    if (!rule->touches) return NULL;
    const struct scree_friction_law *friction = rule->friction >= 0 ? scree_friction_laws[rule->friction] : NULL;
    const struct scree_rolling_law *rolling = rule->rolling >= 0 ? scree_rolling_laws[rule->rolling] : NULL;
    if (friction && friction->memory && !friction->hold && !friction->rate) return friction->text.name;
    if (!rolling || rolling->memory) return NULL;
    /* A torque that jumps where the rolling stops: no step ends there. */
    struct scree_sliding slow = {.normal = 1.0, .velocity = {1e-30, 0.0, 0.0}};
    const struct scree_law_constants *constants = &rule->rolling_constants;
    double largest = fmax(constants->c[SCREE_ROLLING_COEFFICIENT], constants->c[SCREE_TWISTING_COEFFICIENT]);
    double jump = vec_norm(rolling->resist(constants, largest, slow).force);
    return largest > 0.0 && jump > 1e-12 * largest ? rolling->text.name : NULL;
}

double scree_grip_stiffness(const struct scree_grip *grip, int way, double overlap) {
    if (way != SCREE_GRIP_FRICTION)
        return grip->rolling && grip->rolling->memory ? grip->rolling->stiffness(&grip->rule->rolling_constants) : 0.0;
    if (!grip->friction || !grip->friction->memory) return 0.0;
    if (grip->friction->in_force) return 1.0;
    return grip->friction->stiffness(&grip->rule->friction_constants, grip->of_friction, overlap);
}

/* ---- setting up ---- */

static struct scree_normal_force law_of(const struct scree_grip *grip, double overlap, double closing, double first) {
    struct scree_pressing at = scree_pressed(overlap, closing, first, grip->second);
    return grip->normal->force(&grip->rule->normal_constants, grip->of_normal, at);
}

/* Whether the law is another one while the bodies part. What it remembers stands far off. */
static int tells_directions(const struct scree_grip *grip) {
    for (double d = 1e-6; d < 1e-3; d *= 30.0) {
        struct scree_normal_force on = law_of(grip, d, BARELY, 1.0), off = law_of(grip, d, -BARELY, 1.0);
        if (on.elastic != off.elastic || on.damping != off.damping) return 1;
    }
    return 0;
}

/* Whether a law that is cut lets go at a speed, whatever the overlap: its dashpot grows like its spring. */
static int lets_go_by_speed(const struct scree_grip *grip) {
    if (!grip->normal->cut || grip->normal->bends) return 0;
    struct scree_normal_force small = law_of(grip, 1e-6, BARELY, 1.0), large = law_of(grip, 1e-3, BARELY, 1.0);
    double straight = small.damping * large.elastic, across = large.damping * small.elastic;
    return straight > 0.0 && fabs(across / straight - 1.0) < 1e-9;
}

/* The root of the overlap in which the spring is a whole power: 1 for whole exponents, 2 for halves, else 4. */
static int root_of_spring(const struct scree_grip *grip) {
    double d = 1e-12, once = law_of(grip, d, BARELY, 0.0).elastic, twice = law_of(grip, 2.0 * d, BARELY, 0.0).elastic;
    if (!(once > 0.0 && twice > once)) return 1;
    double exponent = scree_log(twice / once) / scree_log(2.0);
    for (int root = 1; root <= 2; root++)
        if (fabs(root * exponent - floor(root * exponent + 0.5)) < 1e-4) return root;
    return 4;
}

/* Forces set in as the spring, the dashpot and friction do; a law of its own for parting has no dashpot of that root at
 * the end. The radius of an adhesive contact ends like a root. */
static void set_roots(struct scree_grip *grip) {
    int spring = grip->reach > 0.0 ? 1 : root_of_spring(grip), dashpot = grip->normal->root;
    if (grip->friction && grip->friction->root > spring) spring = grip->friction->root;
    grip->root = dashpot > spring ? dashpot : spring;
    grip->end_root = grip->reach > 0.0 ? 2 : grip->directional ? spring : grip->root;
}

/* Whether friction is a slider that bears no force under any load: its spring would turn without end. */
static int bears_nothing(const struct scree_rule *rule, const struct scree_friction_law *friction) {
    if (!friction || !friction->hold) return 0;
    struct scree_hold hold = friction->hold(&rule->friction_constants, (struct scree_sliding){.normal = 1.0});
    return hold.holds == 0.0 && hold.slides == 0.0;
}

void scree_grip_make(struct scree_grip *grip, const struct scree_contacts *contacts, const struct scree_bodies *bodies,
                     int batch_index, int index) {
    const struct scree_batch *batch = &contacts->batch[batch_index];
    memset(grip, 0, sizeof *grip);
    for (int k = 0; k < SCREE_GRIP_CHANGES; k++) grip->since[k] = -HUGE_VAL;
    grip->batch = batch_index;
    grip->index = index;
    grip->contact = scree_contact_at(batch, index);
    grip->geometry = batch->geometry;
    grip->rule = &contacts->rule[batch->rule];
    grip->normal = scree_normal_laws[grip->rule->normal];
    if (grip->rule->friction >= 0) grip->friction = scree_friction_laws[grip->rule->friction];
    if (bears_nothing(grip->rule, grip->friction)) grip->friction = NULL;
    if (grip->rule->rolling >= 0) grip->rolling = scree_rolling_laws[grip->rule->rolling];
    for (int c = 0; c < SCREE_PAIR_CONSTANTS; c++) grip->of_normal.c[c] = scree_pair(batch, c, index);
    for (int c = SCREE_PAIR_FRICTION; c < SCREE_PAIR_LEVER; c++)
        grip->of_friction.c[c - SCREE_PAIR_FRICTION] = scree_pair(batch, c, index);
    grip->lever = scree_pair(batch, SCREE_PAIR_LEVER, index);
    grip->turns = scree_contact_turns(batch, &grip->contact);
    if (grip->normal->reach) grip->reach = grip->normal->reach(&grip->rule->normal_constants, grip->of_normal);
    grip->mass = scree_effective_mass(bodies, grip->contact.ball, grip->contact.host);
    for (int side = 0; side < 2 && !(grip->mass > 0.0); side++) { /* bodies that only turn */
        int k = side ? grip->contact.host : grip->contact.ball;
        double bound = bodies->record[k].bound;
        if (scree_kind_of(bodies, k)->inertia.inverse_moments[0] > 0.0)
            grip->mass = scree_kind_of(bodies, k)->inertia.moments[0] / (bound * bound);
    }
    grip->directional = tells_directions(grip);
    grip->by_speed = lets_go_by_speed(grip);
    set_roots(grip);
}

/* ---- geometry ---- */

/* How fast the normal turns: of the ball's centre around the other's, or with the face that it belongs to. */
static struct vec normal_rate(const struct scree_grip *grip, const struct scree_bodies *bodies, struct vec centre,
                              struct vec centre_velocity, struct vec n) {
    const struct scree_record *ball = &bodies->record[grip->contact.ball], *host = &bodies->record[grip->contact.host];
    struct vec origin = vec_from(host->x), spin = scree_spin_of(bodies, grip->contact.host);
    if (grip->geometry == SCREE_BALL_PLANE) return vec_cross(spin, n);
    if (grip->geometry == SCREE_BALL_BALL) {
        struct vec past = vec_sub(centre_velocity, vec_from(host->v));
        double distance = vec_norm(vec_sub(centre, origin));
        return vec_scale(distance > 0.0 ? 1.0 / distance : 0.0, vec_axpy(past, -vec_dot(past, n), n));
    }
    /* A box or a plate: faces, edges and corners; seen from it, the ball's centre moves a little. */
    struct vec past = vec_sub(vec_sub(centre_velocity, vec_from(host->v)), vec_cross(spin, vec_sub(centre, origin)));
    double little = 1e-5 * ball->bound / (vec_norm(past) + SCREE_NO_SPEED);
    struct scree_meeting later = scree_meet(bodies, &grip->contact, grip->geometry, vec_axpy(centre, little, past));
    struct scree_meeting sooner = scree_meet(bodies, &grip->contact, grip->geometry, vec_axpy(centre, -little, past));
    struct vec turn = vec_cross(spin, n);
    if (vec_dot(later.normal, n) < 0.9 || vec_dot(sooner.normal, n) < 0.9) return turn;
    return vec_axpy(turn, 0.5 / little, vec_sub(later.normal, sooner.normal));
}

void scree_grip_meet(const struct scree_grip *grip, const struct scree_bodies *bodies, double overlap,
                     struct scree_grip_view *view) {
    const struct scree_record *ball = &bodies->record[grip->contact.ball], *host = &bodies->record[grip->contact.host];
    struct vec corner = vec_from(bodies->corner[grip->contact.corner]), x = vec_from(ball->x);
    struct scree_meeting m = scree_meet(bodies, &grip->contact, grip->geometry, vec_add(x, corner));
    view->overlap = isnan(overlap) ? m.overlap : overlap;
    view->normal = m.normal;
    view->arm = vec_axpy(corner, 0.5 * m.overlap - ball->radius, m.normal);
    view->host_arm = vec_add(view->arm, vec_sub(x, vec_from(host->x)));
    struct vec velocity = vec_sub(vec_from(ball->v), vec_from(host->v));
    velocity = vec_add(velocity, vec_cross(scree_spin_of(bodies, grip->contact.ball), view->arm));
    velocity = vec_sub(velocity, vec_cross(scree_spin_of(bodies, grip->contact.host), view->host_arm));
    view->closing = -vec_dot(velocity, m.normal);
    view->slip = vec_axpy(velocity, view->closing, m.normal);
}

double scree_grip_size(const struct scree_grip *grip, const struct scree_bodies *bodies) {
    const struct scree_record *ball = &bodies->record[grip->contact.ball], *host = &bodies->record[grip->contact.host];
    double size = vec_norm(vec_from(ball->x)) + ball->radius;
    if (grip->geometry != SCREE_BALL_PLANE) size += vec_norm(vec_from(host->x)) + host->radius;
    return size;
}

/* ---- forces ---- */

/* A slider with a spring and a dashpot behind it (contact/slider.h), at an instant; `in_force`: what is kept is the
 * spring's force. */
struct slider {
    double k, c;
    struct scree_hold hold;
    int slips, in_force;
    double falls; /* at which rate the force falls with the stiffness, 1/s */
    double longest;
};

struct dragged {
    struct vec force, elastic, rate;
    double grows; /* N/s, of `elastic` if it slipped without a dashpot and the load stayed */
};

static struct dragged drag(const struct slider *s, struct vec memory, struct vec v) {
    struct dragged d = {.grows = 0.0};
    double unit = s->in_force ? s->k : 1.0; /* of the memory per metre of stretch */
    d.elastic = vec_scale(s->k / unit, memory);
    struct vec trial = vec_axpy(d.elastic, s->c, v);
    if (!s->slips) {
        d.force = vec_scale(-1.0, trial);
        d.rate = vec_axpy(vec_scale(unit, v), s->falls, memory);
    } else if (s->c > 0.0) {
        double size = vec_norm(trial);
        d.force = vec_scale(-s->hold.slides / (size + SCREE_NO_SPEED), trial);
        d.rate = vec_axpy(vec_scale(-unit / s->c, vec_add(d.force, d.elastic)), s->falls, memory);
    } else {
        /* It turns towards the slip over the way that the spring is stretched by; under next to no load at once, which
         * no explicit step follows and none has to: there, over a thousandth of the longest such way. What bears
         * nothing has been turned already (scree_grip_settle), and unwinds nothing. */
        double slides = s->hold.slides, way = fmax(slides / s->k, 1e-3 * s->longest) + SCREE_NO_SPEED;
        struct vec towards = scree_direction_of(memory, v);
        double along = vec_dot(v, towards), pace = slides > 0.0 ? vec_norm(memory) / way : 0.0;
        d.force = vec_scale(-slides, towards);
        d.elastic = vec_scale(slides, towards);
        d.rate = vec_scale(pace, vec_axpy(v, -along, towards));
        d.grows = s->k * (slides > 0.0 ? along : fmax(along, 0.0));
    }
    return d;
}

static struct slider slider_of(const struct scree_grip *grip, int way, double normal, double overlap, struct vec v) {
    struct slider s = {.slips = grip->slips[way], .longest = grip->longest[way]};
    struct scree_sliding at = {.normal = normal, .overlap = overlap, .velocity = v, .sliding = s.slips};
    if (way == SCREE_GRIP_FRICTION) {
        const struct scree_law_constants *law = &grip->rule->friction_constants;
        s.k = grip->friction->stiffness(law, grip->of_friction, overlap);
        s.c = grip->friction->damping(law, grip->of_friction, overlap);
        s.hold = scree_hold_on(grip->friction, law, at, grip->inside);
        s.in_force = grip->friction->in_force;
        return s;
    }
    const struct scree_law_constants *law = &grip->rule->rolling_constants;
    double coefficient = law->c[way == SCREE_GRIP_ROLLING ? SCREE_ROLLING_COEFFICIENT : SCREE_TWISTING_COEFFICIENT];
    s.k = grip->rolling->stiffness(law);
    s.c = grip->rolling->damping(law);
    s.hold = (struct scree_hold){coefficient * normal, coefficient * normal};
    return s;
}

double scree_grip_slides(const struct scree_grip *grip, int way, double load) {
    return slider_of(grip, way, load, 0.5 * grip->depth, vec(0.0, 0.0, 0.0)).hold.slides;
}

static void tell(const struct dragged *d, int way, struct scree_grip_view *view) {
    view->rate[way] = d->rate;
    view->elastic[way] = d->elastic;
    view->grows[way] = d->grows;
}

/* The force against the velocity of one way, and the rate of its memory. */
static struct vec resist(const struct scree_grip *grip, int way, double normal, struct vec memory,
                         struct scree_grip_view *view) {
    struct vec v = view->velocity[way];
    struct scree_sliding at = {.normal = normal, .overlap = view->overlap, .velocity = v, .stretch = memory};
    if (scree_grip_is_slider(grip, way)) {
        struct slider s = slider_of(grip, way, normal, view->overlap, v);
        if (way == SCREE_GRIP_FRICTION && grip->friction->rescaled && view->closing < 0.0 && view->overlap > 0.0)
            s.falls = 0.5 * view->closing / view->overlap;
        struct dragged d = drag(&s, memory, v);
        tell(&d, way, view);
        view->stiffness[way] = s.k;
        view->damping_of[way] = s.c;
        view->holds[way] = s.hold.holds;
        view->slides[way] = s.hold.slides;
        return d.force;
    }
    if (way != SCREE_GRIP_FRICTION) {
        const struct scree_law_constants *law = &grip->rule->rolling_constants;
        int which = way == SCREE_GRIP_ROLLING ? SCREE_ROLLING_COEFFICIENT : SCREE_TWISTING_COEFFICIENT;
        return grip->rolling->resist(law, law->c[which], at).force;
    }
    const struct scree_law_constants *law = &grip->rule->friction_constants;
    if (!grip->friction->rate) return grip->friction->force(law, grip->of_friction, at).force;
    struct scree_bent b = scree_bend(grip->friction, law, grip->of_friction, at, grip->slips[way], 1e-5 * grip->load);
    tell(&(struct dragged){b.force, b.elastic, b.rate, b.grows}, way, view);
    view->stiffness[way] = b.k;
    view->holds[way] = view->slides[way] = b.bears;
    return b.force;
}

static void press_normal(const struct scree_grip *grip, struct scree_grip_view *view) {
    double closing = view->closing;
    if (grip->directional) closing = grip->approaching ? fmax(closing, BARELY) : fmin(closing, -BARELY);
    /* What is being renewed isn't there yet: a little sooner the law was on the same branch. */
    struct scree_normal_force f = law_of(grip, view->overlap, closing, grip->advancing ? 0.0 : grip->first);
    view->whole = f.elastic + f.damping * view->closing;
    view->damping = f.damping;
    view->force = grip->state == SCREE_GRIP_HELD ? view->whole : 0.0;
}

/* What each way resists, also of a contact that is about to begin. */
static void set_velocities(const struct scree_grip *grip, const struct scree_bodies *bodies,
                           struct scree_grip_view *view) {
    view->velocity[SCREE_GRIP_FRICTION] = view->slip;
    view->velocity[SCREE_GRIP_ROLLING] = view->velocity[SCREE_GRIP_TWISTING] = vec(0.0, 0.0, 0.0);
    if (!grip->rolling) return;
    struct vec spin = vec_sub(scree_spin_of(bodies, grip->contact.ball), scree_spin_of(bodies, grip->contact.host));
    struct vec velocity = vec_scale(grip->lever, spin);
    double along = vec_dot(velocity, view->normal);
    view->velocity[SCREE_GRIP_ROLLING] = vec_axpy(velocity, -along, view->normal);
    view->velocity[SCREE_GRIP_TWISTING] = vec(along, 0.0, 0.0);
}

/* How fast a stretch turns: with the normal, and about it. */
static struct vec turning_rate(struct vec stretch, struct vec n, struct vec turning, double twirling) {
    return vec_axpy(vec_scale(-vec_dot(stretch, turning), n), twirling, vec_cross(n, stretch));
}

void scree_grip_press(const struct scree_grip *grip, const struct scree_bodies *bodies, const double *memory,
                      struct scree_grip_view *view) {
    struct vec n = view->normal, zero = {0.0, 0.0, 0.0};
    press_normal(grip, view);
    view->push = vec_scale(view->force, n);
    view->torque = zero;
    view->rubbing = 0.0;
    for (int way = 0; way < SCREE_GRIP_WAYS; way++) {
        view->rate[way] = view->elastic[way] = zero;
        view->stiffness[way] = view->damping_of[way] = view->holds[way] = view->slides[way] = view->grows[way] = 0.0;
    }
    set_velocities(grip, bodies, view);
    if (grip->state != SCREE_GRIP_HELD || (!grip->friction && !grip->rolling)) return;
    double normal = grip->pulling ? 0.0 : fmax(view->force, 0.0);
    const struct scree_record *ball = &bodies->record[grip->contact.ball];
    struct vec ball_spin = scree_spin_of(bodies, grip->contact.ball);
    struct vec centre_velocity =
        vec_add(vec_from(ball->v), vec_cross(ball_spin, vec_from(bodies->corner[grip->contact.corner])));
    struct vec centre = vec_add(vec_from(ball->x), vec_from(bodies->corner[grip->contact.corner])), turning = zero;
    double twirling = scree_twirl_angle(n, vec_add(ball_spin, scree_spin_of(bodies, grip->contact.host)), 1.0);
    if (scree_grip_is_slider(grip, SCREE_GRIP_FRICTION) || scree_grip_is_slider(grip, SCREE_GRIP_ROLLING) ||
        (grip->friction && grip->friction->rate))
        turning = normal_rate(grip, bodies, centre, centre_velocity, n);
    if (grip->friction) {
        struct vec stretch = vec_from(memory + 3 * SCREE_GRIP_FRICTION);
        struct vec force = resist(grip, SCREE_GRIP_FRICTION, normal, scree_into_tangent_plane(stretch, n), view);
        view->push = vec_add(view->push, force);
        view->rubbing -= vec_dot(force, view->slip);
        view->rate[SCREE_GRIP_FRICTION] =
            vec_add(view->rate[SCREE_GRIP_FRICTION], turning_rate(stretch, n, turning, twirling));
    }
    if (!grip->rolling) return;
    struct vec stretch = vec_from(memory + 3 * SCREE_GRIP_ROLLING);
    struct vec rolling = resist(grip, SCREE_GRIP_ROLLING, normal, scree_into_tangent_plane(stretch, n), view);
    struct vec twisting = resist(grip, SCREE_GRIP_TWISTING, normal, vec_from(memory + 3 * SCREE_GRIP_TWISTING), view);
    view->rate[SCREE_GRIP_ROLLING] =
        vec_add(view->rate[SCREE_GRIP_ROLLING], turning_rate(stretch, n, turning, twirling));
    view->torque = vec_scale(grip->lever, vec_axpy(rolling, twisting.x, n));
    view->rubbing -= vec_dot(rolling, view->velocity[SCREE_GRIP_ROLLING]);
    view->rubbing -= twisting.x * view->velocity[SCREE_GRIP_TWISTING].x;
}

double scree_grip_peak(const struct scree_grip *grip, const struct scree_grip_view *view) {
    return law_of(grip, view->overlap, view->closing, 0.0).first;
}
