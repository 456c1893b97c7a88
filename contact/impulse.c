/* The pair-impulse method: every contact integrates the motion of its own two bodies against each other over the step, from
 * the state at its start, and returns the impulse J = int F dt and its first moment M = int (h - t) F dt about the end of the
 * step; the bodies gather J and M and move by them (bodies/moments.c). Inside the step
 *
 *   d' = u,  w' = a + W F(d, w)
 *
 * with the relative velocity w of the ball at the contact point in axes that turn with the normal, its closing part
 * u = -w.n, and the matrix W of accelerations per unit of force. All that the pair can't know is in a: gravity, drives, the
 * turning of the axes, and the other contacts of both bodies, whose mean accelerations of the last two steps are
 * extrapolated. Where contact begins, where the dashpot turns round (u = 0) and where contact ends is located inside the step:
 * that is what fixed steps otherwise lose their order to. Classical Runge-Kutta between these points; (d, w) are its
 * variables, so that a contact at rest is a fixed point of it to rounding.
 *
 * The directions of J and M are those at mid-step. Everything is a function of one contact and its two bodies, summed in
 * the order of the list: the same bits for any number of threads. */
#include "contact/contacts.h"
#include "contact/meet.h"

#include <string.h>

enum { TRIES = 16 }; /* of the searches for an event inside a step; each at least halves its bracket every third time */

/* A contact during one step: what stays. */
struct pair {
    const struct scree_normal_law *normal;
    const struct scree_friction_law *friction; /* NULL: none */
    const struct scree_law_constants *normal_law, *friction_law;
    struct scree_pair_constants normal_pair, friction_pair;
    struct vec n;         /* from the host to the ball, at the start of the step */
    struct mat give;      /* W: acceleration of the ball against its host per unit of force on it, 1/kg */
    struct vec a;         /* acceleration that isn't the pair's own, m/s^2 */
    double normal_give;   /* n.W n, 1/kg */
    double sideways_give; /* the largest that W gives in the tangent plane, or more, 1/kg */
    double reach;         /* largest gap that a pulling contact bridges, m */
    double step;
    int root, substeps;
    int trial; /* friction is a slider behind a bare spring */
    int holds; /* reckon as if that slider held whatever comes */
    int books; /* energy is looked at */
};

/* A contact at one instant. */
struct instant {
    double overlap;
    struct vec velocity;
    double first, second; /* memory of the normal law */
    struct vec stretch;   /* memory of the friction law */
    double sliding;
};

/* Forces at one instant. */
struct load {
    struct vec force; /* on the ball, N */
    double normal, damping;
    double rubbing; /* power lost to friction, W */
    double first, second;
};

/* What a stretch of time has yielded: impulse and its moment about the end of that time; work lost. */
struct yield {
    struct vec impulse, moment;
    double lost, rubbed;
};

static inline double closing_of(const struct pair *p, const struct instant *at) { return -vec_dot(at->velocity, p->n); }

/* The normal law as it is, without its cut: so its force is smooth up to the end of the contact and beyond. */
static void press(const struct pair *p, const struct instant *at, struct load *load) {
    double closing = closing_of(p, at);
    struct scree_pressing pressing = {at->overlap, closing, at->first, at->second};
    struct scree_normal_force f = p->normal->force(p->normal_law, p->normal_pair, pressing);
    load->normal = f.elastic + f.damping * closing;
    load->damping = f.damping;
    load->first = f.first;
    load->second = f.second;
    load->force = vec_scale(load->normal, p->n);
}

/* Positive while the contact lasts, zero where it ends. Where the law is cut, the force over its damping rather than the
 * force: k d/c + u has no root of d in it. */
static double lasting(const struct pair *p, const struct instant *at) {
    if (p->normal->reach || !p->normal->cut) return at->overlap + p->reach;
    double closing = closing_of(p, at);
    if (at->overlap <= 0.0) return closing < 0.0 ? closing : at->overlap / p->step;
    struct load load;
    press(p, at, &load);
    return load.normal / (load.damping + 1e-6 / (p->normal_give * p->step));
}

static struct scree_sliding sliding_of(const struct pair *p, const struct instant *at, double normal) {
    struct scree_sliding sliding = {.normal = normal > 0.0 ? normal : 0.0, .overlap = at->overlap};
    sliding.closing = closing_of(p, at);
    sliding.velocity = vec_axpy(at->velocity, sliding.closing, p->n);
    sliding.stretch = at->stretch;
    sliding.sliding = at->sliding;
    return sliding;
}

/* Add friction to the load of an instant; what the law makes of its memory at that instant (a stretch beyond what the normal
 * force can hold) is kept. */
static void rub(const struct pair *p, struct instant *at, struct load *load) {
    load->rubbing = 0.0;
    if (!p->friction) return;
    struct scree_sliding sliding = sliding_of(p, at, p->holds ? 1e200 : load->normal);
    struct scree_tangential f = p->friction->force(p->friction_law, p->friction_pair, sliding);
    load->force = vec_add(load->force, f.force);
    load->rubbing = -vec_dot(f.force, sliding.velocity);
    if (!p->friction->memory) return;
    at->stretch = f.stretch;
    at->sliding = f.sliding;
}

/* The memory of friction after `time` at the velocity and overlap of `at`, by the law's own rule, into `to`. */
static void drag(const struct pair *p, const struct instant *from, const struct instant *at, double normal, double time,
                 struct instant *to) {
    if (!p->friction || !p->friction->memory) return;
    struct scree_sliding sliding = sliding_of(p, at, normal);
    sliding.stretch = from->stretch;
    sliding.sliding = from->sliding;
    sliding.half = 0.5 * time;
    if (p->trial) { /* the whole stretch; `rub` cuts it to what holds at its end, not in its middle */
        sliding.normal = 1e200;
        sliding.sliding = 0.0;
    }
    struct scree_tangential f = p->friction->force(p->friction_law, p->friction_pair, sliding);
    to->stretch = f.stretch;
    to->sliding = p->trial ? from->sliding : f.sliding;
}

/* What the normal law remembers at the end of a piece. */
static void remember(const struct pair *p, struct instant *at) {
    struct load load;
    if (!p->normal->memory) return;
    press(p, at, &load);
    at->first = load.first;
    at->second = load.second;
}

/* Energy in the normal direction that the contact gives back, J; only reckoned if the books are kept. */
static double stored(const struct pair *p, const struct instant *at) {
    if (!p->books || (at->overlap <= 0.0 && !(at->second > 0.0))) return 0.0;
    struct scree_pressing pressing = {at->overlap, closing_of(p, at), at->first, at->second};
    return p->normal->stored(p->normal_law, p->normal_pair, pressing);
}

/* The four stages of one Runge-Kutta step; `along` is dt/d(variable) at each. */
struct stages {
    struct instant at[4];
    struct load load[4];
    double along[4];
};

static const double weight[4] = {1.0 / 6.0, 2.0 / 6.0, 2.0 / 6.0, 1.0 / 6.0}, node[4] = {0.0, 0.5, 0.5, 1.0};

/* Forces at stage k, whose overlap and velocity are set; `size` is that of the step in its variable. */
static void load_stage(const struct pair *p, struct stages *s, int k, double size) {
    struct instant *at = &s->at[k];
    press(p, at, &s->load[k]);
    if (k > 0) drag(p, &s->at[0], &s->at[k - 1], s->load[k].normal, node[k] * size * s->along[k - 1], at);
    rub(p, at, &s->load[k]);
}

/* The memories at the end of a step of length `time`, whose overlap and velocity are set, and the work done in it. */
static void finish_stages(const struct pair *p, const struct stages *s, double size, double time, struct instant *end,
                          struct yield *yield) {
    struct instant mean = s->at[2];
    struct vec way = {0.0, 0.0, 0.0};
    yield->lost = yield->rubbed = 0.0;
    for (int k = 0; k < 4; k++) {
        double share = weight[k] * size * s->along[k];
        way = vec_axpy(way, share, s->at[k].velocity);
        yield->lost += share * s->load[k].normal * closing_of(p, &s->at[k]);
        yield->rubbed += share * s->load[k].rubbing;
        if (p->trial)
            drag(p, end, &s->at[k], 0.0, share, end); /* Runge-Kutta's sum, with the stiffness of each stage */
    }
    remember(p, end);
    yield->lost -= stored(p, end) - stored(p, &s->at[0]); /* the work of the force that isn't there any more */
    if (p->trial || !p->friction || !p->friction->memory || time == 0.0) return;
    mean.velocity = vec_scale(1.0 / time, way);
    drag(p, &s->at[0], &mean, s->load[2].normal, time, end);
}

/* One Runge-Kutta step over `time`. */
static struct instant move(const struct pair *p, const struct instant *from, double time, struct yield *yield) {
    struct stages s = {.at = {*from, *from, *from, *from}, .along = {1.0, 1.0, 1.0, 1.0}};
    load_stage(p, &s, 0, time);
    for (int k = 1; k < 4; k++) {
        struct vec pull = vec_add(p->a, mat_apply(&p->give, s.load[k - 1].force));
        s.at[k].overlap = from->overlap + node[k] * time * closing_of(p, &s.at[k - 1]);
        s.at[k].velocity = vec_axpy(from->velocity, node[k] * time, pull);
        s.at[k].stretch = s.at[0].stretch;
        load_stage(p, &s, k, time);
    }
    struct vec ends = vec_add(s.load[0].force, s.load[3].force), inner = vec_add(s.load[1].force, s.load[2].force);
    yield->impulse = vec_scale(time / 6.0, vec_axpy(ends, 2.0, inner));
    yield->moment = vec_scale(time * time / 6.0, vec_add(s.load[0].force, inner));
    struct instant end = s.at[0];
    struct vec kick = vec_axpy(mat_apply(&p->give, yield->impulse), time, p->a);
    struct vec shift = vec_axpy(mat_apply(&p->give, yield->moment), 0.5 * time * time, p->a);
    shift = vec_axpy(shift, time, from->velocity);
    end.velocity = vec_add(from->velocity, kick);
    end.overlap = from->overlap - vec_dot(shift, p->n);
    finish_stages(p, &s, time, time, &end, yield);
    return end;
}

/* ---- where the force sets in, or ends, as a root of the overlap ---- */

/* How near, in time, a piece is to an overlap of zero: since the one behind, until the one ahead; negative: too far to matter. */
struct nearness {
    double since, until;
};

static const struct nearness far = {-1.0, -1.0};

static struct nearness nearness_of(const struct pair *p, const struct instant *at, double time) {
    struct nearness near = far;
    double closing = closing_of(p, at);
    if (p->root < 2 || closing == 0.0 || at->overlap < 0.0) return near;
    double distance = at->overlap / fabs(closing);
    if (closing > 0.0 && distance < 6.0 * time) near.since = distance;
    if (closing < 0.0 && distance < 7.0 * time && !p->normal->cut) near.until = distance;
    return near;
}

static double whole_power(double x, int power) {
    double y = 1.0;
    for (int k = 0; k < power; k++) y *= x;
    return y;
}

/* The state after the time `t` since `from`, in which the contact has yielded so much. */
static void place(const struct pair *p, const struct instant *from, double t, const struct yield *yield,
                  struct instant *at) {
    struct vec shift = vec_axpy(mat_apply(&p->give, yield->moment), 0.5 * t * t, p->a);
    at->velocity = vec_add(from->velocity, vec_axpy(mat_apply(&p->give, yield->impulse), t, p->a));
    at->overlap = from->overlap - vec_dot(vec_axpy(shift, t, from->velocity), p->n);
}

/* Time as the p-th power of a variable that runs from `first` by `size` to its end, so that force and motion are smooth in it:
 * t = sigma^p span - since behind a begin, until - span (1 - sigma)^p before an end. */
struct clock {
    double since, until, span, first, size, time;
    int root, pieces, backwards;
};

static double whole_root(double x, int root) {
    return root == 2 ? sqrt(x) : root == 4 ? sqrt(sqrt(x)) : scree_power(x, 1.0 / root);
}

static struct clock clock_for(const struct pair *p, struct nearness near, double time) {
    struct clock c = {.root = p->root, .time = time, .backwards = near.since < 0.0};
    double rest = c.backwards ? fmax(near.until - time, 0.0) : near.since;
    c.since = near.since;
    c.until = time + rest;
    c.span = time + rest;
    double nearest = whole_root(rest / c.span, c.root);
    c.pieces = rest < 1.5 * time ? 4 : 1;
    if (c.pieces < p->substeps) c.pieces = p->substeps;
    c.first = c.backwards ? 0.0 : nearest;
    c.size = (1.0 - nearest) / c.pieces;
    return c;
}

/* Time after `ticks` of `size`, and its derivative by the variable. */
static double clock_time(const struct clock *c, double ticks, double *along) {
    double sigma = c->first + c->size * ticks, x = c->backwards ? 1.0 - sigma : sigma;
    double lower = whole_power(x, c->root - 1);
    *along = c->span * c->root * lower;
    if (ticks == c->pieces) return c->time;
    if (ticks == 0.0) return 0.0;
    return c->backwards ? c->until - c->span * lower * x : c->span * lower * x - c->since;
}

/* One Runge-Kutta step of `move_by_clock`: J and M themselves are the states. */
static void tick(const struct pair *p, const struct clock *c, const struct instant *from, int piece,
                 struct instant *now, struct yield *yield) {
    struct stages s = {.at = {*now, *now, *now, *now}};
    struct yield sum = *yield, part;
    struct vec impulse[4];
    double size = c->size, ignored;
    for (int k = 0; k < 4; k++) {
        double t = clock_time(c, piece + node[k], &s.along[k]);
        struct yield state = *yield;
        if (k > 0) {
            double share = node[k] * size * s.along[k - 1];
            state.impulse = vec_axpy(yield->impulse, share, s.load[k - 1].force);
            state.moment = vec_axpy(yield->moment, share, impulse[k - 1]);
            place(p, from, t, &state, &s.at[k]);
            s.at[k].stretch = s.at[0].stretch;
            s.at[k].sliding = s.at[0].sliding;
        }
        impulse[k] = state.impulse;
        load_stage(p, &s, k, size);
        sum.impulse = vec_axpy(sum.impulse, weight[k] * size * s.along[k], s.load[k].force);
        sum.moment = vec_axpy(sum.moment, weight[k] * size * s.along[k], impulse[k]);
    }
    double before = clock_time(c, piece, &ignored), after = clock_time(c, piece + 1, &ignored);
    *now = s.at[0];
    place(p, from, after, &sum, now);
    finish_stages(p, &s, size, after - before, now, &part);
    sum.lost += part.lost;
    sum.rubbed += part.rubbed;
    *yield = sum;
}

/* As move, near the begin or end of a contact whose force isn't smooth there. */
static struct instant move_by_clock(const struct pair *p, const struct instant *from, struct nearness near, double time,
                                    struct yield *yield) {
    struct clock c = clock_for(p, near, time);
    struct instant now = *from;
    *yield = (struct yield){{0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}, 0.0, 0.0};
    for (int piece = 0; piece < c.pieces; piece++) tick(p, &c, from, piece, &now, yield);
    return now;
}

/* One piece of a step, by whichever variable suits. */
static struct instant go(const struct pair *p, const struct instant *from, struct nearness near, double time,
                         struct yield *yield) {
    int smooth = near.since < 0.0 && near.until < 0.0;
    return smooth ? move(p, from, time, yield) : move_by_clock(p, from, near, time, yield);
}

/* ---- events inside a step ---- */

enum event { TURNS, ENDS };

static double still(const struct pair *p, enum event event, const struct instant *at) {
    return event == TURNS ? closing_of(p, at) : lasting(p, at);
}

/* Shorten a piece of length *time, over whose course an event happens, so that it ends there: regula falsi (Illinois), and
 * bisection where that is slow. `to` and `yield` are those of the whole piece and become those of the part. */
static void shorten(const struct pair *p, enum event event, const struct instant *from, struct nearness near,
                    double *time, struct instant *to, struct yield *yield) {
    double low = 0.0, high = *time, at_low = still(p, event, from), at_high = still(p, event, to), size = at_low;
    for (int k = 0; k < TRIES && at_low > 0.0; k++) {
        double t = high - at_high * (high - low) / (at_high - at_low);
        if (k % 4 == 3) t = 0.5 * (low + high);
        if (event == ENDS && near.until >= 0.0) near.until = t; /* there is the singular point */
        *to = go(p, from, near, t, yield);
        *time = t;
        double value = still(p, event, to);
        if (fabs(value) <= 1e-13 * size) return;
        if (value > 0.0) {
            low = t;
            at_low = value;
            at_high *= 0.5;
        } else {
            high = t;
            at_high = value;
            at_low *= 0.5;
        }
    }
}

/* A slider that has held until now doesn't any more. */
static int breaks_loose(const struct pair *p, const struct instant *at) {
    struct instant now = *at;
    struct load load;
    press(p, &now, &load);
    rub(p, &now, &load);
    return now.sliding > 0.0 && !(at->sliding > 0.0);
}

/* Where a slider breaks loose its force leaves that of the spring, with a kink or a jump. If it does within the piece, the piece
 * is shortened to end there, as if it held up to then. */
static int shorten_to_slip(const struct pair *p, const struct instant *from, struct nearness near, double *time,
                           struct instant *to, struct yield *yield) {
    if (!p->trial || from->sliding > 0.0 || !breaks_loose(p, to) || breaks_loose(p, from)) return 0;
    struct pair holding = *p;
    holding.holds = 1;
    double low = 0.0, high = *time;
    for (int k = 0; k < TRIES; k++) {
        double t = 0.5 * (low + high);
        *to = go(&holding, from, near, t, yield);
        *(breaks_loose(p, to) ? &high : &low) = t;
    }
    *to = go(&holding, from, near, high, yield);
    *time = high;
    return 1;
}

static void add(struct yield *sum, const struct yield *part, double left) {
    sum->moment = vec_add(sum->moment, vec_axpy(part->moment, left, part->impulse));
    sum->impulse = vec_add(sum->impulse, part->impulse);
    sum->lost += part->lost;
    sum->rubbed += part->rubbed;
}

/* Free flight: what is stored in an overlap without force is lost. */
static void fly(const struct pair *p, struct instant *at, double time, struct yield *sum) {
    struct yield nothing = {{0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}, 0.0, 0.0};
    double before = stored(p, at);
    struct instant from = *at;
    place(p, &from, time, &nothing, at);
    at->stretch = vec(0.0, 0.0, 0.0);
    at->sliding = 0.0;
    remember(p, at);
    sum->lost += before - stored(p, at);
}

/* The rest of a step, from `start` on, of a contact that touches. */
static void touch(const struct pair *p, struct instant *at, double start, struct yield *sum) {
    double time = start, grid = (p->step - start) / p->substeps;
    for (int k = 0, turned = 0; time < p->step && k < p->substeps;) {
        struct yield part;
        struct nearness near = nearness_of(p, at, p->step - time);
        int last = near.since >= 0.0 || near.until >= 0.0 || k == p->substeps - 1;
        double goal = last ? p->step : start + grid * (k + 1), piece = goal - time;
        if (!(piece > 0.0)) { /* the piece before went further than its own goal */
            k++;
            continue;
        }
        struct instant to = go(p, at, near, piece, &part);
        double closing = closing_of(p, at);
        /* Laws may change where approach turns into parting; where nothing moves to speak of, no force does either. */
        int turns = !turned && closing > 0.0 && closing_of(p, &to) < 0.0 && closing * piece > 1e-12 * at->overlap;
        int ends = !turns && lasting(p, &to) < 0.0;
        if (turns || ends) shorten(p, turns ? TURNS : ENDS, at, near, &piece, &to, &part);
        if (ends && !(lasting(p, at) > 0.0)) { /* it ends before it begins */
            fly(p, at, p->step - time, sum);
            return;
        }
        int slips = shorten_to_slip(p, at, near, &piece, &to, &part);
        if (slips) turns = ends = 0;
        time = turns || ends || slips ? time + piece : goal;
        if (!(time < p->step)) time = p->step;
        add(sum, &part, p->step - time);
        *at = to;
        if (slips) at->sliding = 1.0;
        turned = turns;
        if (ends) {
            fly(p, at, p->step - time, sum);
            return;
        }
        if (time == goal) k = last ? p->substeps : k + 1;
    }
}

/* ---- the beginning ---- */

/* Time at which contact begins within the step, on the parabola of free flight; the step's length if it doesn't. `at` is moved
 * there. */
static double begin(const struct pair *p, struct instant *at, struct yield *sum) {
    struct instant from = *at, end = *at;
    struct yield nothing = {{0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}, 0.0, 0.0};
    double h = p->step, closing = closing_of(p, at), speeding = -vec_dot(p->a, p->n);
    place(p, &from, h, &nothing, &end);
    if (!(lasting(p, &end) > 0.0) || end.overlap <= 0.0) return h;
    double start = 0.0;
    if (from.overlap <= 0.0) {
        double root = closing + sqrt(fmax(closing * closing - 2.0 * speeding * from.overlap, 0.0));
        start = root > 0.0 ? fmin(-2.0 * from.overlap / root, h) : 0.0;
    } else { /* overlapping still after its force was cut */
        double low = 0.0, high = h;
        for (int k = 0; k < 50; k++) {
            start = 0.5 * (low + high);
            place(p, &from, start, &nothing, &end);
            if (lasting(p, &end) > 0.0)
                high = start;
            else
                low = start;
        }
    }
    struct yield flight = nothing;
    fly(p, at, start, &flight);
    if (from.overlap <= 0.0) at->overlap = 0.0;
    sum->lost += flight.lost;
    return start;
}

static struct yield act(const struct pair *p, struct instant *at) {
    struct yield sum = {{0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}, 0.0, 0.0};
    int touches = at->overlap > 0.0;
    if (p->normal->reach)
        touches = touches || at->second > 0.0;
    else if (p->normal->cut)
        touches = touches && lasting(p, at) > 0.0;
    double start = touches ? 0.0 : begin(p, at, &sum);
    if (start < p->step && p->normal->reach &&
        !(at->second > 0.0)) { /* bodies that attach are bound at once; books as in loop.c */
        struct scree_pressing attached = {0.0, 0.0, 0.0, 1.0};
        sum.lost -= p->normal->stored(p->normal_law, p->normal_pair, attached);
    }
    if (start < p->step)
        touch(p, at, start, &sum);
    else
        fly(p, at, p->step, &sum);
    return sum;
}

/* ---- from bodies to pairs ---- */

/* One body as a contact sees it. */
struct side {
    const struct scree_record *record;
    const struct scree_past *past;
    struct vec inverse_mass;
    struct mat inverse_inertia;
    struct vec arm; /* from its centre to the contact, m */
    double sign;    /* of the contact's force on it */
    int turns;      /* the contact can turn it */
    /* Of edges on edges, where a normal force of 1 N pushes elsewhere too (crossing.h): that, and its torque; both for a force of the
     * ball's sign. */
    int leans;
    struct vec n, lean, lean_turn;
};

static struct side side_of(const struct scree_bodies *bodies, const struct scree_bodies *now, int index, struct vec arm,
                           double sign, int turns) {
    return (struct side){.record = &now->record[index],
                         .past = &bodies->past[index],
                         .inverse_mass = vec_from(bodies->inertia[index].inverse_mass),
                         .inverse_inertia = scree_bodies_inverse_inertia(now, index),
                         .arm = arm,
                         .sign = sign,
                         .turns = turns};
}

/* What a force on the ball at the contact does to a body: force and torque, for the ball's sign. */
static struct vec force_of(const struct side *side, struct vec force) {
    return side->leans ? vec_axpy(force, vec_dot(force, side->n), side->lean) : force;
}

static struct vec torque_of(const struct side *side, struct vec force) {
    struct vec torque = vec_cross(side->arm, force);
    return side->leans ? vec_axpy(torque, vec_dot(force, side->n), side->lean_turn) : torque;
}

/* And what the contact sees of a body that moves, turns so. */
static struct vec seen(const struct side *side, struct vec moves, struct vec turns) {
    struct vec at_contact = vec_add(moves, vec_cross(turns, side->arm));
    if (!side->leans) return at_contact;
    return vec_axpy(at_contact, vec_dot(side->lean, moves) + vec_dot(side->lean_turn, turns), side->n);
}

/* Acceleration of the body at the contact per force on the ball there. */
static struct vec give(const struct side *side, struct vec force) {
    struct vec along = vec_times(side->inverse_mass, force_of(side, force));
    if (!side->turns) return along;
    return seen(side, along, mat_apply(&side->inverse_inertia, torque_of(side, force)));
}

/* What the pair's own past would do to the body, and the rest of the body's past: extrapolated by weight `more`. */
static struct vec ahead(const double past[2][3], double more) {
    return vec_axpy(vec_from(past[0]), more, vec_sub(vec_from(past[0]), vec_from(past[1])));
}

static struct vec acceleration(const struct side *side, struct vec own, double more, double step) {
    struct vec push = vec_axpy(ahead(side->past->f, more), -side->sign, force_of(side, own));
    struct vec twist = ahead(side->past->t, more);
    if (side->turns) twist = vec_axpy(twist, -side->sign, torque_of(side, own));
    struct vec along = vec_axpy(vec_from(side->past->known), 1.0 / step, vec_times(side->inverse_mass, push));
    struct vec turn = vec_axpy(vec_from(side->past->known_turn), 1.0 / step, mat_apply(&side->inverse_inertia, twist));
    return seen(side, along, turn);
}

/* Geometry of a contact as records have it. */
struct view {
    struct vec normal, arm, apart;
    double overlap;
    struct vec lean, turn_ball,
        turn_host; /* of edges on edges: beyond what the normal force does at the arm, per 1 N */
};

static struct view view_of_edges(const struct scree_bodies *bodies, const struct scree_contact *contact) {
    struct scree_two_boxes boxes = scree_two_boxes_of(bodies, contact->ball, contact->host);
    struct scree_crossing c = {.meeting = {vec(0.0, 0.0, 1.0), SCREE_OUTSIDE}};
    if (!scree_meet_as_rectangles(&boxes, (struct scree_rectangles){0, 0, 1})) c = scree_cross(bodies, contact);
    struct vec n = c.meeting.normal, apart = boxes.apart;
    struct view view = {.normal = n, .arm = c.point, .apart = apart, .overlap = c.meeting.overlap};
    if (!(view.overlap > 0.0)) return view;
    view.lean = vec_sub(c.force, n);
    view.turn_ball = vec_sub(c.turn_a, vec_cross(c.point, n));
    view.turn_host = vec_add(c.turn_b, vec_cross(vec_add(c.point, apart), n));
    return view;
}

static struct view view_of(const struct scree_bodies *bodies, const struct scree_contact *contact,
                           enum scree_geometry geometry) {
    if (geometry == SCREE_EDGE_EDGE) return view_of_edges(bodies, contact);
    const struct scree_record *ball = &bodies->record[contact->ball];
    struct vec corner = scree_corner_of(bodies, contact, geometry);
    struct scree_meeting m = scree_meet(bodies, contact, geometry, vec_add(vec_from(ball->x), corner));
    return (struct view){.normal = m.normal,
                         .arm = vec_axpy(corner, 0.5 * m.overlap - ball->radius, m.normal),
                         .apart = scree_apart(bodies, contact, geometry),
                         .overlap = m.overlap};
}

/* Turn a vector as the normal turns from `a` to `b`. */
static struct vec turn_along(struct vec v, struct vec a, struct vec b) {
    struct vec axis = vec_cross(a, b), once = vec_cross(axis, v);
    return vec_axpy(vec_add(v, once), 1.0 / (1.0 + vec_dot(a, b)), vec_cross(axis, once));
}

/* A contact in the loop: where it is in its batch, and where its yield goes. */
struct place {
    const struct scree_batch *batch;
    int index, lane; /* in the batch; in what follows */
    struct scree_yield *yield;
    struct scree_moments *moments;
};

static struct pair laws_of(const struct scree_contacts *contacts, struct place at) {
    const struct scree_rule *rule = &contacts->rule[at.batch->rule];
    struct pair p = {.normal = scree_normal_laws[rule->normal],
                     .friction = rule->friction >= 0 ? scree_friction_laws[rule->friction] : NULL,
                     .normal_law = &rule->normal_constants,
                     .friction_law = &rule->friction_constants};
    for (int c = 0; c < SCREE_PAIR_CONSTANTS; c++) p.normal_pair.c[c] = scree_pair(at.batch, c, at.index);
    for (int c = SCREE_PAIR_FRICTION; c < SCREE_PAIR_COLUMNS; c++)
        p.friction_pair.c[c - SCREE_PAIR_FRICTION] = scree_pair(at.batch, c, at.index);
    p.reach = p.normal->reach ? p.normal->reach(p.normal_law, p.normal_pair) : 0.0;
    p.root = p.normal->root;
    if (p.friction && p.friction->root > p.root) p.root = p.friction->root;
    p.trial = p.friction && p.friction->slider && p.friction->damping(p.friction_law, p.friction_pair, 0.0) == 0.0;
    p.books = contacts->measured;
    p.substeps = contacts->substeps ? contacts->substeps : p.friction ? 2 : 1;
    return p;
}

static void set_give(struct pair *p, const struct side *ball, const struct side *host) {
    double trace = 0.0;
    for (int k = 0; k < 3; k++) {
        struct vec unit = vec(k == 0, k == 1, k == 2);
        p->give.column[k] = vec_add(give(ball, unit), give(host, unit));
        trace += k == 0 ? p->give.column[k].x : k == 1 ? p->give.column[k].y : p->give.column[k].z;
    }
    p->normal_give = vec_dot(p->n, mat_apply(&p->give, p->n));
    p->sideways_give = trace - p->normal_give;
}

/* How far to extrapolate the accelerations of the last two steps: fully, as long as damping leaves room for it; a coupled
 * set of heavily damped contacts would grow. (Largest stable steps for 12 neighbours each.) */
static double extrapolation(const struct pair *p, const struct instant *at) {
    struct instant touching = *at;
    struct load load;
    if (touching.overlap < 0.0) touching.overlap = 0.0;
    press(p, &touching, &load);
    double rate = load.damping * p->normal_give;
    if (p->friction) {
        double normal = load.normal > 0.0 ? load.normal : 0.0;
        double slope = p->friction->slope(p->friction_law) * normal +
                       p->friction->damping(p->friction_law, p->friction_pair, touching.overlap);
        rate = fmax(rate, slope * p->sideways_give);
    }
    return fmin(fmax((0.15 - 0.5 * rate * p->step) / 0.06, 0.0), 1.0);
}

static struct instant instant_of(const struct pair *p, struct place place, struct view now, struct vec velocity) {
    struct instant at = {.overlap = now.overlap, .velocity = velocity};
    double *const *kept = place.batch->kept;
    int k = place.index;
    if (p->normal->memory) {
        at.first = kept[SCREE_KEPT_NORMAL][k];
        at.second = kept[SCREE_KEPT_NORMAL + 1][k];
    }
    if (p->friction && p->friction->memory) {
        struct vec stretch = vec(kept[0][k], kept[1][k], kept[2][k]);
        at.stretch = scree_into_tangent_plane(stretch, now.normal);
        at.sliding = kept[3][k];
    }
    return at;
}

static void keep(const struct pair *p, struct place place, const struct instant *at) {
    double *const *kept = place.batch->kept;
    int k = place.index;
    if (p->normal->memory) {
        kept[SCREE_KEPT_NORMAL][k] = at->first;
        kept[SCREE_KEPT_NORMAL + 1][k] = at->second;
    }
    if (p->friction && p->friction->memory) {
        kept[0][k] = at->stretch.x;
        kept[1][k] = at->stretch.y;
        kept[2][k] = at->stretch.z;
        kept[3][k] = at->sliding;
    }
}

static void put(double column[3][SCREE_LANES], int lane, struct vec a) {
    column[0][lane] = a.x;
    column[1][lane] = a.y;
    column[2][lane] = a.z;
}

static struct vec past_of(const struct scree_batch *batch, int step, int k) {
    double *const *past = batch->past + 3 * step;
    return vec(past[0][k], past[1][k], past[2][k]);
}

static void keep_past(const struct scree_batch *batch, int step, int k, struct vec impulse) {
    double *const *past = batch->past + 3 * step;
    past[0][k] = impulse.x;
    past[1][k] = impulse.y;
    past[2][k] = impulse.z;
}

/* Impulse and moment on both bodies, in the directions of mid-step. */
static void write_yield(const struct yield *sum, struct view middle, struct vec impulse, struct vec moment,
                        struct place place) {
    struct scree_yield *yield = place.yield;
    struct scree_moments *moments = place.moments;
    int lane = place.lane;
    struct vec host_arm = vec_add(middle.arm, middle.apart);
    double j = 0.0, m = 0.0;
    if (place.batch->geometry == SCREE_EDGE_EDGE) {
        j = vec_dot(impulse, middle.normal);
        m = vec_dot(moment, middle.normal);
    }
    put(yield->impulse, lane, vec_axpy(impulse, j, middle.lean));
    put(yield->turn_ball, lane, vec_axpy(vec_cross(middle.arm, impulse), j, middle.turn_ball));
    put(yield->turn_host, lane, vec_axpy(vec_cross(impulse, host_arm), j, middle.turn_host));
    put(moments->impulse, lane, vec_axpy(moment, m, middle.lean));
    put(moments->turn_ball, lane, vec_axpy(vec_cross(middle.arm, moment), m, middle.turn_ball));
    put(moments->turn_host, lane, vec_axpy(vec_cross(moment, host_arm), m, middle.turn_host));
    keep_past(place.batch, 1, place.index, past_of(place.batch, 0, place.index));
    keep_past(place.batch, 0, place.index, impulse);
    yield->lost_normal += sum->lost;
    yield->work_tangential += sum->rubbed;
}

/* The velocity of the ball against its host at the contact. */
static struct vec slip_of(const struct side *ball, const struct side *host) {
    if (ball->leans)
        return vec_sub(seen(ball, vec_from(ball->record->v), vec_from(ball->record->w)),
                       seen(host, vec_from(host->record->v), vec_from(host->record->w)));
    struct vec velocity = vec_sub(vec_from(ball->record->v), vec_from(host->record->v));
    velocity = vec_add(velocity, vec_cross(vec_from(ball->record->w), ball->arm));
    return vec_sub(velocity, vec_cross(vec_from(host->record->w), host->arm));
}

/* What the velocity at the contact gains because arms and normal turn while the bodies go on as they are. */
static struct vec drift(const struct side *ball, const struct side *host, struct view now, struct view middle,
                        struct vec velocity, double step) {
    struct vec arm = vec_scale(2.0 / step, vec_sub(middle.arm, now.arm));
    struct vec apart = vec_scale(2.0 / step, vec_sub(middle.apart, now.apart));
    struct vec normal = vec_scale(2.0 / step, vec_sub(middle.normal, now.normal));
    struct vec gain = vec_cross(vec_from(ball->record->w), arm);
    gain = vec_sub(gain, vec_cross(vec_from(host->record->w), vec_add(arm, apart)));
    if (ball->leans) {
        struct vec between = vec_sub(vec_from(ball->record->v), vec_from(host->record->v));
        double more = vec_dot(vec_sub(middle.lean, now.lean), between) +
                      vec_dot(vec_sub(middle.turn_ball, now.turn_ball), vec_from(ball->record->w)) +
                      vec_dot(vec_sub(middle.turn_host, now.turn_host), vec_from(host->record->w));
        gain = vec_axpy(gain, 2.0 / step * more, now.normal);
    }
    return vec_sub(gain, vec_cross(vec_cross(now.normal, normal), velocity));
}

static void add_to(double column[3][SCREE_LANES], int lane, struct vec a) {
    column[0][lane] += a.x;
    column[1][lane] += a.y;
    column[2][lane] += a.z;
}

/* The rolling law of a contact that pressed with the mean force of `sum`, by the rule of loop.c: one evaluation at mid-step, at the
 * predicted spins. */
static void roll(const struct scree_contacts *contacts, const struct scree_bodies *bodies, struct place place,
                 struct view middle, double normal, int touches, double step) {
    const struct scree_rule *rule = &contacts->rule[place.batch->rule];
    if (rule->rolling < 0) return;
    const struct scree_rolling_law *law = scree_rolling_laws[rule->rolling];
    const struct scree_law_constants *constants = &rule->rolling_constants;
    const struct scree_contact *contact = &place.batch->contact[place.index];
    struct scree_yield *yield = place.yield;
    struct scree_moments *moments = place.moments;
    double *const *own = law->memory ? place.batch->kept + SCREE_KEPT_ROLLING : NULL;
    double lever = scree_pair(place.batch, SCREE_PAIR_LEVER, place.index);
    int lane = place.lane, k = place.index;
    struct vec spin = vec_sub(vec_from(bodies->record[contact->ball].w), vec_from(bodies->record[contact->host].w));
    struct vec velocity = vec_scale(lever, spin), n = middle.normal;
    double along = vec_dot(velocity, n);
    struct scree_sliding rolling = {.normal = normal > 0.0 ? normal : 0.0,
                                    .overlap = middle.overlap,
                                    .half = 0.5 * step,
                                    .velocity = vec_axpy(velocity, -along, n)};
    struct scree_sliding twisting = rolling;
    twisting.velocity = vec(along, 0.0, 0.0);
    if (own) {
        rolling.stretch = scree_into_tangent_plane(vec(own[0][k], own[1][k], own[2][k]), n);
        rolling.sliding = own[3][k];
        twisting.stretch = vec(own[4][k], 0.0, 0.0);
        twisting.sliding = own[5][k];
    }
    struct scree_tangential r = law->resist(constants, constants->c[SCREE_ROLLING_COEFFICIENT], rolling);
    struct scree_tangential s = law->resist(constants, constants->c[SCREE_TWISTING_COEFFICIENT], twisting);
    struct vec turn = vec_scale(step * lever, vec_axpy(r.force, s.force.x, n));
    struct vec moment = vec_scale(0.5 * step, turn);
    add_to(yield->turn_ball, lane, turn);
    add_to(yield->turn_host, lane, vec_scale(-1.0, turn));
    add_to(moments->turn_ball, lane, moment);
    add_to(moments->turn_host, lane, vec_scale(-1.0, moment));
    yield->work_tangential -= step * (vec_dot(r.force, rolling.velocity) + s.force.x * along);
    if (!own) return;
    own[0][k] = touches * r.stretch.x;
    own[1][k] = touches * r.stretch.y;
    own[2][k] = touches * r.stretch.z;
    own[3][k] = touches * r.sliding;
    own[4][k] = touches * s.stretch.x;
    own[5][k] = touches * s.sliding;
}

/* Nothing can happen in this step: too far apart, and nothing kept of an earlier touch. */
static int idle(const struct scree_bodies *bodies, struct place place, double overlap) {
    const struct scree_batch *batch = place.batch;
    const struct scree_contact *contact = &batch->contact[place.index];
    if (!(overlap + bodies->past[contact->ball].range + bodies->past[contact->host].range < 0.0)) return 0;
    for (int m = 0; m < SCREE_PAST; m++)
        if (batch->past[m][place.index] != 0.0) return 0;
    for (int m = 0; m < SCREE_MEMORY; m++)
        if (scree_kept(batch, m, place.index) != 0.0) return 0;
    return 1;
}

static void write_nothing(struct place place) {
    struct scree_yield *yield = place.yield;
    struct scree_moments *moments = place.moments;
    for (int k = 0; k < 3; k++) {
        yield->impulse[k][place.lane] = yield->turn_ball[k][place.lane] = yield->turn_host[k][place.lane] = 0.0;
        moments->impulse[k][place.lane] = moments->turn_ball[k][place.lane] = moments->turn_host[k][place.lane] = 0.0;
    }
    yield->steep[place.lane] = 0.0;
}

/* One contact through one step. */
static void impel(const struct scree_contacts *contacts, const struct scree_bodies *bodies,
                  const struct scree_bodies *bodies_now, struct place place, double step) {
    const struct scree_batch *batch = place.batch;
    const struct scree_contact *contact = &batch->contact[place.index];
    struct view now = view_of(bodies_now, contact, batch->geometry);
    const struct scree_record *a = &bodies->record[contact->ball], *b = &bodies->record[contact->host];
    place.yield->depth[place.lane] = now.overlap / (a->limit < b->limit ? a->limit : b->limit);
    if (idle(bodies, place, now.overlap)) {
        write_nothing(place);
        return;
    }
    struct view middle = view_of(bodies, contact, batch->geometry);
    /* Beyond an edge the normal may jump, or the partner be out of sight at mid-step: then the start of the step counts. */
    if (vec_dot(now.normal, middle.normal) < 0.9 || middle.overlap < 0.5 * SCREE_OUTSIDE) middle = now;
    int turns = scree_contact_turns(batch, contact);
    struct side ball = side_of(bodies, bodies_now, contact->ball, now.arm, 1.0, turns);
    struct side host = side_of(bodies, bodies_now, contact->host, vec_add(now.arm, now.apart), -1.0, turns);
    if (batch->geometry == SCREE_EDGE_EDGE) {
        ball.leans = host.leans = 1;
        ball.n = host.n = now.normal;
        ball.lean = host.lean = now.lean;
        ball.lean_turn = now.turn_ball;
        host.lean_turn = vec_scale(-1.0, now.turn_host);
    }

    struct pair p = laws_of(contacts, place);
    p.n = now.normal;
    p.step = step;
    set_give(&p, &ball, &host);
    struct vec velocity = slip_of(&ball, &host);
    struct instant at = instant_of(&p, place, now, velocity);
    struct yield sum = {{0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}, 0.0, 0.0};
    int covered = ball.leans && now.overlap == 0.0; /* corners bear all; the plain normal would foretell a touch */
    if (now.overlap > 0.5 * SCREE_OUTSIDE && p.normal_give > 0.0 && !covered) {
        double more = extrapolation(&p, &at);
        struct vec last = past_of(batch, 0, place.index);
        struct vec own = vec_axpy(last, more, vec_sub(last, past_of(batch, 1, place.index)));
        p.a = vec_sub(acceleration(&ball, own, more, step), acceleration(&host, own, more, step));
        p.a = vec_add(p.a, drift(&ball, &host, now, middle, velocity, step));
        sum = act(&p, &at);
    }
    if (covered) at = (struct instant){.overlap = 0.0};
    keep(&p, place, &at);
    struct vec impulse = turn_along(sum.impulse, now.normal, middle.normal);
    write_yield(&sum, middle, impulse, turn_along(sum.moment, now.normal, middle.normal), place);
    roll(contacts, bodies, place, middle, vec_dot(impulse, middle.normal) / step, at.overlap > 0.0, step);
    double steep = batch->slope * vec_dot(impulse, middle.normal) * 4.0 * (a->inverse_mass + b->inverse_mass);
    place.yield->steep[place.lane] = steep;
}

static int contacts_in_block(const struct scree_batch *batch, int block) {
    int left = batch->segment[0].count - block * SCREE_LANES;
    return left < SCREE_LANES ? left : SCREE_LANES;
}

static void impel_block(const struct scree_contacts *contacts, const struct scree_bodies *bodies,
                        const struct scree_bodies *now, const struct scree_batch *batch, int block, double step) {
    batch->yield[block].lost_normal = batch->yield[block].work_tangential = 0.0;
    batch->yield[block].silent = 0;
    for (int lane = 0; lane < contacts_in_block(batch, block); lane++) {
        int index = batch->segment[0].first + block * SCREE_LANES + lane;
        impel(contacts, bodies, now, (struct place){batch, index, lane, &batch->yield[block], &batch->moments[block]},
              step);
    }
}

/* `hosts` 0: the partner is frozen. */
static void add_moments(struct scree_bodies *bodies, const struct scree_contact *contact,
                        const struct scree_moments *moments, int lane, int turns, int hosts) {
    struct scree_past *ball = &bodies->past[contact->ball], *host = &bodies->past[contact->host];
    for (int k = 0; k < 3; k++) {
        ball->moment[k] += moments->impulse[k][lane];
        if (hosts) host->moment[k] -= moments->impulse[k][lane];
        if (!turns) continue;
        ball->turn_moment[k] += moments->turn_ball[k][lane];
        if (hosts) host->turn_moment[k] += moments->turn_host[k][lane];
    }
}

static void add_impulses(struct scree_bodies *bodies, const struct scree_contact *contact,
                         const struct scree_yield *yield, int turns, int hosts) {
    struct scree_record *ball = &bodies->record[contact->ball], *host = &bodies->record[contact->host];
    for (int k = 0; k < 3; k++) {
        ball->f[k] += yield->impulse[k][0];
        if (hosts) host->f[k] -= yield->impulse[k][0];
        if (!turns) continue;
        ball->t[k] += yield->turn_ball[k][0];
        if (hosts) host->t[k] += yield->turn_host[k][0];
    }
}

static void tally_up(const struct scree_contact *contact, const struct scree_yield *yield, struct scree_tally *tally) {
    tally->lost_normal += yield->lost_normal;
    tally->work_tangential += yield->work_tangential;
    if (!(yield->depth[0] <= tally->deepest)) {
        tally->deepest = yield->depth[0];
        tally->deepest_ball = contact->ball;
        tally->deepest_host = contact->host;
    }
    if (!(yield->steep[0] <= tally->steepest)) {
        tally->steepest = yield->steep[0];
        tally->steepest_ball = contact->ball;
        tally->steepest_host = contact->host;
    }
}

/* One step's arguments, for slabs. */
struct stride {
    const struct scree_bodies *now;
};

static void impel_segment(void *context, struct scree_contacts *contacts, struct scree_bodies *bodies,
                          const struct scree_batch *batch, const struct scree_part *segment, double step,
                          struct scree_tally *tally) {
    const struct stride *stride = context;
    struct scree_yield yield;
    struct scree_moments moments;
    int hosts = batch->geometry == SCREE_BALL_BALL;
    for (int k = segment->first; k < segment->first + segment->count; k++) {
        const struct scree_contact *contact = &batch->contact[k];
        int turns = scree_contact_turns(batch, contact);
        yield.lost_normal = yield.work_tangential = 0.0;
        impel(contacts, bodies, stride->now, (struct place){batch, k, 0, &yield, &moments}, step);
        add_impulses(bodies, contact, &yield, turns, hosts);
        add_moments(bodies, contact, &moments, 0, turns, hosts);
        tally_up(contact, &yield, tally);
    }
}

static void impel_loose(struct scree_contacts *contacts, struct scree_bodies *bodies, const struct scree_bodies *now,
                        const struct scree_batch *batch, double step, int threads) {
    int blocks = (batch->segment[0].count + SCREE_LANES - 1) / SCREE_LANES;
    if (threads > 1 && blocks > 8) {
#pragma omp parallel for schedule(static) num_threads(threads)
        for (int block = 0; block < blocks; block++) impel_block(contacts, bodies, now, batch, block, step);
    } else {
        for (int block = 0; block < blocks; block++) impel_block(contacts, bodies, now, batch, block, step);
    }
    for (int block = 0; block < blocks; block++) {
        scree_contacts_collect(contacts, bodies, batch, block);
        for (int lane = 0; lane < contacts_in_block(batch, block); lane++) {
            const struct scree_contact *contact = &batch->contact[batch->segment[0].first + block * SCREE_LANES + lane];
            add_moments(bodies, contact, &batch->moments[block], lane, scree_contact_turns(batch, contact), 1);
        }
    }
}

void scree_contacts_impel(struct scree_contacts *contacts, struct scree_bodies *bodies, const struct scree_bodies *now,
                          double step, int threads) {
    struct stride stride = {now};
    for (int k = 0; k < contacts->busy_batches; k++)
        impel_loose(contacts, bodies, now, &contacts->batch[contacts->busy[k]], step, threads);
    scree_contacts_by_slabs(contacts, bodies, step, threads, impel_segment, &stride);
}

void scree_contacts_keep_impulses(struct scree_contacts *contacts, int substeps) {
    for (int k = 0; k < contacts->batches; k++) contacts->batch[k].impulses = 1;
    contacts->substeps = substeps;
}

void scree_contacts_begin_past(struct scree_contacts *contacts, struct scree_bodies *bodies,
                               const struct scree_bodies *now, double step) {
    for (int k = 0; k < bodies->count; k++) memset(&bodies->past[k], 0, sizeof bodies->past[k]);
    for (int b = 0; b < contacts->batches; b++) {
        struct scree_batch *batch = &contacts->batch[b];
        for (int k = scree_first(batch); k >= 0; k = scree_next(batch, k)) {
            struct scree_touch touch;
            if (!scree_contacts_measure(contacts, now, b, k, &touch)) continue;
            struct vec force = vec_axpy(touch.tangential, touch.normal_force, touch.normal);
            struct vec impulse = vec_scale(step, force);
            struct vec ball_arm = vec_sub(touch.point, vec_from(now->record[touch.ball].x));
            struct vec host_arm = vec_add(ball_arm, scree_apart(now, &batch->contact[k], batch->geometry));
            int turns = scree_contact_turns(batch, &batch->contact[k]);
            struct vec ball_turn = vec_scale(turns, vec_cross(ball_arm, impulse));
            struct vec host_turn = vec_scale(turns, vec_cross(impulse, host_arm));
            for (int s = 0; s < 2; s++) {
                struct scree_past *ball = &bodies->past[touch.ball], *host = &bodies->past[touch.host];
                vec_store(vec_add(vec_from(ball->f[s]), impulse), ball->f[s]);
                vec_store(vec_sub(vec_from(host->f[s]), impulse), host->f[s]);
                vec_store(vec_add(vec_from(ball->t[s]), ball_turn), ball->t[s]);
                vec_store(vec_add(vec_from(host->t[s]), host_turn), host->t[s]);
                keep_past(batch, s, k, impulse);
            }
        }
    }
}
