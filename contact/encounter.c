/* Two bodies meet obliquely: Dormand-Prince steps that end at every event. */
#include "contact/encounter.h"

#include "contact/bristle.h"

#include <stddef.h>

/* What is integrated. */
enum { OVERLAP, IMPULSE, STRETCH = IMPULSE + 3, WORK_NORMAL = STRETCH + 3, WORK_TANGENTIAL, SIZE };

struct state {
    double y[SIZE];
};

/* Everything about the encounter that doesn't change, and its scales. */
struct pair {
    const struct scree_normal_law *normal;
    const struct scree_friction_law *friction; /* NULL: none */
    const struct scree_rule *rule;
    struct scree_pair_constants of_normal, of_friction;
    struct vec n, u0;
    struct vec softness[3];          /* W, 1/kg */
    double time, length, push, load; /* scales of time, overlap, impulse, force */
    double tolerance, stretch;       /* the longest stretch so far */
    int projects; /* friction cuts its memory down to what its slider holds: it is behind a bare spring */
    int bristles; /* friction remembers what those are bent by */
};

/* What the laws keep, and the phase of the contact: constant within a step. */
struct phase {
    double first, second; /* memory of the normal law */
    int approaching, sliding, over;
};

/* ---- forces at an instant ---- */

struct instant {
    double closing, force;
    struct scree_normal_force law;
    struct vec slip;
    struct scree_sliding at; /* what friction sees */
    struct scree_tangential friction;
    struct scree_bent bent; /* bristles */
};

static struct vec velocity(const struct pair *p, const struct state *s) {
    const double *j = &s->y[IMPULSE];
    return vec(p->u0.x + vec_dot(p->softness[0], vec_from(j)), p->u0.y + vec_dot(p->softness[1], vec_from(j)),
               p->u0.z + vec_dot(p->softness[2], vec_from(j)));
}

static struct scree_tangential rub(const struct pair *p, struct scree_sliding at) {
    return p->friction->force(&p->rule->friction_constants, p->of_friction, at);
}

/* Bristles under next to no load rest, and stay as they are: a heavily damped contact may take its time to end, with
 * less and less load, and no explicit step follows what gives way at once. That leaves out some 1e-7 of friction's
 * impulse. */
static double no_load(const struct pair *p) { return 1e-4 * p->load; }

static struct instant look(const struct pair *p, const struct phase *phase, const struct state *s) {
    struct instant now = {.friction = {.sliding = 0.0}};
    struct vec u = velocity(p, s);
    now.closing = -vec_dot(u, p->n);
    now.slip = vec_axpy(u, now.closing, p->n);
    struct scree_pressing at = scree_pressed(s->y[OVERLAP], now.closing, phase->first, phase->second);
    /* At the turning point rounding must not pick the other branch of a law that tells approach from parting. */
    at.closing = phase->approaching ? fmax(at.closing, 1e-300) : fmin(at.closing, -1e-300);
    now.law = p->normal->force(&p->rule->normal_constants, p->of_normal, at);
    now.force = now.law.elastic + now.law.damping * now.closing;
    if (!p->friction) return now;
    now.at = (struct scree_sliding){.normal = fmax(now.force, 0.0), .overlap = s->y[OVERLAP], .velocity = now.slip};
    now.at.closing = at.closing;
    now.at.stretch = vec_from(&s->y[STRETCH]);
    now.at.sliding = phase->sliding ? 1.0 : 0.0;
    if (!p->bristles) {
        now.friction = rub(p, now.at);
        return now;
    }
    now.bent =
        scree_bend(p->friction, &p->rule->friction_constants, p->of_friction, now.at, phase->sliding, no_load(p));
    now.friction.force = now.bent.force;
    now.friction.stretch = vec_scale(1.0 / now.bent.k, now.bent.elastic);
    return now;
}

/* ---- the rate of friction's memory ---- */

/* Under a load that holds whatever there is. */
static double holding_load(const struct pair *p, double normal) { return fmax(normal, p->load) * 1e6; }

/* As if nothing slid: what a tiny step makes of no stretch under a load that holds it. */
static struct vec sticking_rate(const struct pair *p, struct scree_sliding at) {
    at.half = 1e-6 * p->time;
    at.stretch = vec(0.0, 0.0, 0.0);
    at.sliding = at.closing = 0.0; /* without a stretch a change of load changes nothing */
    at.normal = holding_load(p, at.normal);
    return vec_scale(0.5 / at.half, rub(p, at).stretch);
}

/* While a slider slips the stretch may grow beyond the cap within a step, but turns as the cut one does. */
static struct vec slipping_rate(const struct pair *p, const struct instant *now) {
    struct vec stretch = now->at.stretch, rate = sticking_rate(p, now->at);
    double size2 = vec_norm2(stretch), cut2 = vec_norm2(now->friction.stretch);
    if (!(cut2 > 0.0) || !(size2 > 0.0)) return rate;
    double along = vec_dot(rate, stretch) / size2;
    /* Where the slider carries next to nothing it turns at once: no explicit step follows that, and none has to. */
    double faster = fmin(sqrt(size2 / cut2), 2.0);
    return vec_axpy(vec_scale(faster, vec_axpy(rate, -along, stretch)), along, stretch);
}

/* A step so short that a stiff memory changes in proportion to it. */
static double tiny_step(const struct pair *p, struct scree_sliding at) {
    double half = 1e-6 * p->time;
    for (int k = 0; !p->projects && k < 8; k++, half *= 0.1) {
        at.half = half;
        struct vec once = vec_sub(rub(p, at).stretch, at.stretch);
        at.half = 2.0 * half;
        struct vec twice = vec_sub(rub(p, at).stretch, at.stretch);
        if (vec_norm(vec_axpy(twice, -2.0, once)) <= 0.01 * vec_norm(once)) break;
    }
    return half;
}

static struct vec memory_rate(const struct pair *p, const struct instant *now) {
    if (p->bristles) return now->force > no_load(p) ? now->bent.rate : vec(0.0, 0.0, 0.0);
    double half = tiny_step(p, now->at);
    if (p->projects && (now->at.sliding > 0.0 || now->friction.sliding > 0.0)) return slipping_rate(p, now);
    struct scree_sliding later = now->at, sooner = now->at;
    later.half = half;
    sooner.half = -half;
    struct scree_tangential a = rub(p, later), b = rub(p, sooner);
    /* Close to sticking or slipping only one side is of this phase, close to the first touch perhaps neither. */
    int after = (a.sliding > 0.0) == (now->friction.sliding > 0.0);
    int before = (b.sliding > 0.0) == (now->friction.sliding > 0.0);
    if (after && before) return vec_scale(0.25 / half, vec_sub(a.stretch, b.stretch));
    if (after) return vec_scale(0.5 / half, vec_sub(a.stretch, now->friction.stretch));
    if (before) return vec_scale(0.5 / half, vec_sub(now->friction.stretch, b.stretch));
    return sticking_rate(p, now->at);
}

/* While a slider holds it holds throughout a step: a force that jumped within it, where static friction is the larger,
 * would be met by ever shorter steps. That it should slide is seen at the end. */
static void hold_on(const struct pair *p, struct instant *now) {
    now->at.normal = holding_load(p, now->at.normal);
    now->friction = rub(p, now->at);
}

static struct state rates(const struct pair *p, const struct phase *phase, const struct state *s) {
    struct instant now = look(p, phase, s);
    if (p->friction && p->friction->hold && !phase->sliding) hold_on(p, &now);
    struct state rate = {{0.0}};
    double force = p->normal->cut && now.force < 0.0 ? 0.0 : now.force;
    struct vec total = vec_axpy(now.friction.force, force, p->n);
    rate.y[OVERLAP] = now.closing;
    vec_store(total, &rate.y[IMPULSE]);
    if (p->friction && p->friction->memory) vec_store(memory_rate(p, &now), &rate.y[STRETCH]);
    rate.y[WORK_NORMAL] = force * now.closing;
    rate.y[WORK_TANGENTIAL] = -vec_dot(now.friction.force, now.slip);
    return rate;
}

/* ---- one step ---- */

static double length3(const double *a) { return vec_norm(vec_from(a)); }

/* Error of a step over what is tolerable. Roots at the first touch need scales that don't vanish there. */
static double misfit(const struct pair *p, const struct state *error, const struct state *end,
                     const struct state *rate) {
    double speed = p->length / p->time, worst = fabs(error->y[OVERLAP]) / p->length;
    double stretch = fmax(fmax(p->stretch, length3(&end->y[STRETCH])), p->time * length3(&rate->y[STRETCH]));
    worst = fmax(worst, length3(&error->y[IMPULSE]) / p->push);
    worst = fmax(worst, length3(&error->y[STRETCH]) / (stretch + 1e-300));
    worst = fmax(worst, fabs(error->y[WORK_NORMAL]) / (p->push * speed));
    return worst / p->tolerance;
}

/* A step of length h from `s`, whose rate is known; `error` (may be NULL) receives its misfit. */
static struct state step(const struct pair *p, const struct phase *phase, const struct state *s,
                         const struct state *rate, double h, double *error) {
    static const double a[7][6] = {{0.0},
                                   {1.0 / 5.0},
                                   {3.0 / 40.0, 9.0 / 40.0},
                                   {44.0 / 45.0, -56.0 / 15.0, 32.0 / 9.0},
                                   {19372.0 / 6561.0, -25360.0 / 2187.0, 64448.0 / 6561.0, -212.0 / 729.0},
                                   {9017.0 / 3168.0, -355.0 / 33.0, 46732.0 / 5247.0, 49.0 / 176.0, -5103.0 / 18656.0},
                                   {35.0 / 384.0, 0.0, 500.0 / 1113.0, 125.0 / 192.0, -2187.0 / 6784.0, 11.0 / 84.0}};
    static const double e[7] = {71.0 / 57600.0,      0.0,          -71.0 / 16695.0, 71.0 / 1920.0,
                                -17253.0 / 339200.0, 22.0 / 525.0, -1.0 / 40.0};
    struct state k[7] = {*rate}, end = *s, wrong = {{0.0}};
    for (int stage = 1; stage < 7; stage++) {
        end = *s;
        for (int c = 0; c < stage; c++)
            for (int i = 0; i < SIZE; i++) end.y[i] += h * a[stage][c] * k[c].y[i];
        if (stage < 6 || error) k[stage] = rates(p, phase, &end);
    }
    if (!error) return end;
    for (int stage = 0; stage < 7; stage++)
        for (int i = 0; i < SIZE; i++) wrong.y[i] += h * e[stage] * k[stage].y[i];
    *error = misfit(p, &wrong, &end, &k[6]);
    return end;
}

/* ---- phases ---- */

/* With the memory cut to what the slider holds now: would it slide on? */
static int slides_on(const struct pair *p, const struct phase *phase, const struct state *s,
                     const struct instant *now) {
    double half = 1e-6 * p->time;
    struct state soon = *s, rate;
    vec_store(now->friction.stretch, &soon.y[STRETCH]);
    rate = rates(p, phase, &soon);
    for (int i = 0; i < STRETCH; i++) soon.y[i] += half * rate.y[i];
    struct scree_sliding at = look(p, phase, &soon).at;
    at.stretch = now->friction.stretch;
    at.half = 0.5 * half; /* a slider that slides looks a whole step ahead (slider.h) */
    return rub(p, at).sliding > 0.0;
}

/* Whether the load falls, or goes on falling, too fast for what bristles bear. */
static int give_way(const struct pair *p, const struct phase *phase, const struct state *s, const struct instant *now) {
    const double half = 1e-6 * p->time;
    if (!(now->force > no_load(p))) return phase->sliding;
    if (!phase->sliding) return vec_norm(now->bent.elastic) > now->bent.bears * (1.0 + 1e-13);
    struct state soon = *s, rate = rates(p, phase, s);
    for (int i = 0; i < SIZE; i++) soon.y[i] += half * rate.y[i];
    return now->bent.bears + half * now->bent.grows > look(p, phase, &soon).bent.bears;
}

/* The phase that a state at the end of a step belongs to. */
static struct phase phase_at(const struct pair *p, const struct phase *phase, const struct state *s) {
    struct instant now = look(p, phase, s);
    struct phase next = {now.law.first, now.law.second, now.closing > 0.0, 0, 0};
    double overlap = s->y[OVERLAP];
    int apart = p->normal->reach ? !(now.law.second > 0.0) : !(overlap > 0.0);
    next.over = now.closing < 0.0 && (apart || (p->normal->cut && !(now.force > 0.0)));
    next.sliding = now.friction.sliding > 0.0;
    if (next.sliding && phase->sliding && p->projects) next.sliding = slides_on(p, phase, s, &now);
    if (p->bristles) next.sliding = give_way(p, phase, s, &now);
    return next;
}

static int same_phase(const struct phase *a, const struct phase *b) {
    return a->approaching == b->approaching && a->sliding == b->sliding && a->over == b->over;
}

/* The phase as one step after another has changed it, and the memory as the laws leave it. */
static void settle(const struct pair *p, struct phase *phase, struct phase next, struct state *s) {
    if (p->friction && p->friction->memory) {
        struct phase as_it_slides = *phase;
        as_it_slides.sliding = phase->sliding || next.sliding;
        vec_store(look(p, &as_it_slides, s).friction.stretch, &s->y[STRETCH]);
    }
    *phase = next;
}

/* Length of the step after which the phase is just over. */
static double locate(const struct pair *p, const struct phase *phase, const struct state *s, const struct state *rate,
                     double h) {
    double low = 0.0, high = h;
    for (int k = 0; k < 60 && high - low > 1e-16 * p->time; k++) {
        double middle = 0.5 * (low + high);
        struct state end = step(p, phase, s, rate, middle, NULL);
        struct phase next = phase_at(p, phase, &end);
        if (same_phase(phase, &next))
            low = middle;
        else
            high = middle;
    }
    return high;
}

/* ---- largest values on the way ---- */

static double force_rises(const struct pair *p, const struct phase *phase, const struct state *s) {
    struct state rate = rates(p, phase, s), soon = *s, gone = *s;
    double half = 1e-5 * p->time;
    for (int i = 0; i < SIZE; i++) {
        soon.y[i] += half * rate.y[i];
        gone.y[i] -= half * rate.y[i];
    }
    return look(p, phase, &soon).force - look(p, phase, &gone).force;
}

/* The largest force within a step at whose beginning it rose and at whose end it falls. */
static double peak_within(const struct pair *p, const struct phase *phase, const struct state *s,
                          const struct state *rate, double h) {
    double low = 0.0, high = h;
    for (int k = 0; k < 30; k++) {
        double middle = 0.5 * (low + high);
        struct state end = step(p, phase, s, rate, middle, NULL);
        if (force_rises(p, phase, &end) > 0.0)
            low = middle;
        else
            high = middle;
    }
    struct state end = step(p, phase, s, rate, 0.5 * (low + high), NULL);
    return look(p, phase, &end).force;
}

/* ---- the encounter ---- */

/* Impulse -> velocity of the contact point of one body. */
static void add_softness(struct vec w[3], const struct scree_partner *body) {
    for (int column = 0; column < 3; column++) {
        struct vec unit = vec(column == 0, column == 1, column == 2);
        struct vec turn = mat_undo(&body->axes, vec_cross(body->arm, unit));
        turn = mat_apply(&body->axes, vec_times(turn, vec_from(body->inverse_moments)));
        struct vec moved = vec_axpy(vec_cross(turn, body->arm), body->inverse_mass, unit);
        w[column] = vec_add(w[column], moved); /* symmetric: its rows are its columns */
    }
}

struct vec scree_approach(const struct scree_encounter *e) {
    struct vec ball = vec_add(e->ball.velocity, vec_cross(e->ball.spin, e->ball.arm));
    return vec_sub(ball, vec_add(e->host.velocity, vec_cross(e->host.spin, e->host.arm)));
}

/* What the elastic force does on a way as long as the overlap. */
static double press_by(const struct pair *p, double overlap) {
    struct scree_pressing at = scree_pressed(overlap, 1e-300, 0.0, 0.0);
    return p->normal->force(&p->rule->normal_constants, p->of_normal, at).elastic * overlap;
}

enum { LONGEST = 1000 }; /* m: what goes deeper isn't followed */

/* Overlap at which the elastic force alone has stopped the bodies, m. */
static double elastic_overlap(const struct pair *p, double energy) {
    double work = 0.0, overlap = 1e-15;
    while (press_by(p, overlap) > 1e-4 * energy && overlap > 1e-150) overlap *= 1e-3;
    for (; work < energy && overlap < LONGEST; overlap *= 1.02) work += 0.02 * press_by(p, overlap);
    return overlap;
}

static int can_follow(const struct pair *p) {
    return p->length < LONGEST && p->time > 0.0 && isfinite(p->time) && p->push > 0.0 && isfinite(p->load);
}

static struct pair make_pair(const struct scree_encounter *e, const struct scree_rule *rule) {
    struct pair p = {.rule = rule, .n = e->normal, .u0 = scree_approach(e)};
    double mass = 1.0 / ((e->ball.inverse_mass + e->host.inverse_mass) * rule->share);
    p.normal = scree_normal_laws[rule->normal];
    p.of_normal = p.normal->pair(&rule->normal_constants, mass, e->radius);
    p.tolerance = e->tolerance > 0.0 ? e->tolerance : 1e-12;
    add_softness(p.softness, &e->ball);
    add_softness(p.softness, &e->host);
    struct vec wn = vec(vec_dot(p.softness[0], p.n), vec_dot(p.softness[1], p.n), vec_dot(p.softness[2], p.n));
    double closing = -vec_dot(p.u0, p.n), soft = vec_dot(wn, p.n);
    double energy = 0.5 * closing * closing / soft;
    p.length = isnormal(energy) ? elastic_overlap(&p, energy) : 0.0;
    p.time = p.length / closing;
    p.push = closing / soft;
    p.load = p.push / p.time;
    if (rule->friction < 0) return p;
    p.friction = scree_friction_laws[rule->friction];
    if (p.friction->pair) p.of_friction = p.friction->pair(&rule->friction_constants, mass, e->radius);
    p.bristles = p.friction->rate != NULL;
    p.projects = p.friction->hold && scree_is_bare(p.friction, &rule->friction_constants, p.of_friction);
    return p;
}

static double energy_of(const struct scree_partner *body) {
    struct vec spin = mat_undo(&body->axes, body->spin);
    double energy = body->inverse_mass > 0.0 ? 0.5 * vec_norm2(body->velocity) / body->inverse_mass : 0.0;
    const double *w = body->inverse_moments;
    if (w[0] > 0.0) energy += 0.5 * spin.x * spin.x / w[0];
    if (w[1] > 0.0) energy += 0.5 * spin.y * spin.y / w[1];
    if (w[2] > 0.0) energy += 0.5 * spin.z * spin.z / w[2];
    return energy;
}

static struct scree_partner pushed(struct scree_partner body, struct vec impulse) {
    struct vec turn = mat_undo(&body.axes, vec_cross(body.arm, impulse));
    turn = mat_apply(&body.axes, vec_times(turn, vec_from(body.inverse_moments)));
    body.velocity = vec_axpy(body.velocity, body.inverse_mass, impulse);
    body.spin = vec_add(body.spin, turn);
    return body;
}

/* Take what a finished step has to say into the result. */
static void record(const struct pair *p, const struct phase *phase, const struct state *s, double time,
                   struct scree_outcome_of_impact *result, scree_encounter_watch *watch, void *context) {
    struct instant now = look(p, phase, s);
    if (p->normal->cut) now.force = fmax(now.force, 0.0);
    result->duration = time;
    result->deepest = fmax(result->deepest, s->y[OVERLAP]);
    result->force = fmax(result->force, now.force);
    result->friction = fmax(result->friction, vec_norm(now.friction.force));
    struct scree_moment moment = {time, s->y[OVERLAP], now.closing, now.force, now.slip, now.friction.force};
    if (watch) watch(context, &moment);
}

/* Events that follow each other at once are taken as one from so many on: the phase may then change within a short
 * step. */
enum { MOST_RAPID = 20 };

static int count_rapid(const struct pair *p, double taken, int rapid) { return taken < 1e-9 * p->time ? rapid + 1 : 0; }

/* What the bodies do behind the contact, or where it has stayed. */
static void finish(const struct pair *p, const struct scree_encounter *e, const struct state *s, int over,
                   struct scree_outcome_of_impact *result) {
    if (over) result->ending = SCREE_PARTED;
    result->impulse = vec_from(&s->y[IMPULSE]);
    result->ball = pushed(e->ball, result->impulse);
    result->host = pushed(e->host, vec_scale(-1.0, result->impulse));
    result->lost_normal = s->y[WORK_NORMAL];
    result->lost_tangential = s->y[WORK_TANGENTIAL];
    double parting = vec_dot(velocity(p, s), p->n);
    if (over) result->restitution = parting * p->time / p->length;
}

struct scree_outcome_of_impact scree_meet(const struct scree_encounter *e, const struct scree_rule *rule,
                                          scree_encounter_watch *watch, void *context) {
    enum { MOST_STEPS = 1000000, MOST_TURNS = 200 }; /* what turns round so often has stayed */
    struct pair p = make_pair(e, rule);
    struct phase phase = {.approaching = 1};
    struct state s = {{0.0}};
    struct scree_outcome_of_impact result = {.ending = SCREE_UNFINISHED,
                                             .ball = e->ball,
                                             .host = e->host,
                                             .energy = energy_of(&e->ball) + energy_of(&e->host)};
    double time = 0.0, h = 1e-3 * p.time;
    struct state touch = {{1e-30 * p.length}}; /* a law may keep the speed of the first touch */
    struct scree_normal_force first = look(&p, &phase, &touch).law;
    phase.first = first.first;
    phase.second = first.second;
    int rapid = 0, turns = 0;
    if (!can_follow(&p) || !isfinite(result.energy)) return result;
    record(&p, &phase, &s, time, &result, watch, context);
    while (result.steps < MOST_STEPS && !phase.over) {
        double error, taken = h;
        struct state rate = rates(&p, &phase, &s), end = step(&p, &phase, &s, &rate, h, &error);
        result.steps++;
        if (!(error <= 1.0)) {
            h *= error < 1e6 ? fmax(0.2, 0.9 * scree_pow(error, -0.2)) : 0.1;
            continue;
        }
        struct phase next = phase_at(&p, &phase, &end);
        if (!same_phase(&phase, &next) && rapid <= MOST_RAPID) {
            taken = locate(&p, &phase, &s, &rate, h);
            end = step(&p, &phase, &s, &rate, taken, NULL);
            next = phase_at(&p, &phase, &end);
        }
        if (force_rises(&p, &phase, &s) > 0.0 && force_rises(&p, &phase, &end) < 0.0)
            result.force = fmax(result.force, peak_within(&p, &phase, &s, &rate, taken));
        time += taken;
        turns += next.approaching != phase.approaching;
        settle(&p, &phase, next, &end);
        s = end;
        p.stretch = fmax(p.stretch, length3(&s.y[STRETCH]));
        rapid = count_rapid(&p, taken, rapid);
        record(&p, &phase, &s, time, &result, watch, context);
        h = fmin(h * (error > 0.0 ? fmin(4.0, 0.9 * scree_pow(error, -0.2)) : 4.0), 0.02 * p.time);
        if (turns >= MOST_TURNS || time > 300.0 * p.time) {
            result.ending = SCREE_STAYED;
            break;
        }
    }
    finish(&p, e, &s, phase.over, &result);
    return result;
}

struct scree_partner scree_partner_of(const scree_shape *shape, double mass, struct quat attitude, struct vec towards) {
    struct scree_partner body = {.axes = quat_to_mat(attitude)};
    double radius = shape->kind == SCREE_SPHERE ? shape->radius : shape->kind == SCREE_BOX ? shape->rounding : 0.0;
    double moments[3];
    scree_shape_inertia(shape, moments);
    for (int k = 0; mass > 0.0 && k < 3 && moments[k] > 0.0; k++) body.inverse_moments[k] = 1.0 / (mass * moments[k]);
    body.inverse_mass = mass > 0.0 ? 1.0 / mass : 0.0;
    if (shape->kind == SCREE_BOX) {
        struct vec along = mat_undo(&body.axes, towards);
        struct vec corner =
            vec(copysign(0.5 * shape->edge[0] - radius, along.x), copysign(0.5 * shape->edge[1] - radius, along.y),
                copysign(0.5 * shape->edge[2] - radius, along.z));
        body.arm = mat_apply(&body.axes, corner);
    }
    body.arm = vec_axpy(body.arm, radius, towards);
    return body;
}
