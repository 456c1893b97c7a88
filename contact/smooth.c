/* Contacts of two spheres, or of one with a plane or a frozen sphere, that go through a step of the pair-impulse method several at
 * once. What they do is what within.c does, in numbers instead of matrices (lane.h): contact begins, breaks loose, turns round and
 * ends inside the step, and each of these instants is located; those to which one of them happens are drawn together and go on by
 * themselves.
 *
 * Few are left to within.c: contacts that may be pushed together again after their end, that are thrown back before they touch, and of
 * friction with a dashpot those where a root begins or ends. Which they are, and all that becomes of the others, is decided for each contact by its own numbers, so
 * that no bit depends on its neighbours in the list, on threads or on the processor. Compiled once for each kind of processor, as
 * loop.c is. */
#include "contact/lane.h"
#include "contact/law_list.h"
#include "contact/loop.h"
#include "contact/meeting.h"

#include <stddef.h>
#include <string.h>

/* Copies lanes of columns. */
static void pick_lanes(const void *from, const int *lane, int count, size_t size, void *to) {
    const double *source = from;
    double *target = to;
    for (size_t c = 0; c < size / sizeof(double); c += SCREE_LANES)
        for (int i = 0; i < count; i++) target[c + (size_t)i] = source[c + (size_t)lane[i]];
}

static void return_lanes(const void *from, const int *lane, int count, size_t size, void *to) {
    const double *source = from;
    double *target = to;
    for (size_t c = 0; c < size / sizeof(double); c += SCREE_LANES)
        for (int i = 0; i < count; i++) target[c + (size_t)lane[i]] = source[c + (size_t)i];
}

/* ---- passes ---- */

/* Loops over lanes with the laws in them. */
struct smooth_loops {
    void (*rates)(const struct scree_rule *rule, double slope, double step, int asked, int count, struct course *c,
                  struct motion *m);
    void (*go)(const struct scree_rule *rule, struct motion *m, int count, double step, struct course *c,
               struct stride *to);
    void (*tick)(const struct scree_rule *rule, struct motion *m, int count, double step, struct course *c,
                 struct stride *to);
};

#define SMOOTH_LOOP(...)                                                                                               \
    _Pragma("omp simd")                                                                                                \
    for (int k = 0; k < padded(count); k++) __VA_ARGS__
#define SMOOTH_PASS(name, ...)                                                                                         \
    __attribute__((flatten)) static void smooth_rates_##name(const struct scree_rule *rule, double slope, double step, \
                                                             int asked, int count, struct course *c,                   \
                                                             struct motion *m) {                                       \
        const struct smooth_laws laws = {__VA_ARGS__};                                                                 \
        if (laws.none) return;                                                                                         \
        SMOOTH_LOOP(rate_lane(laws, rule, slope, step, asked, k, c, m);)                                               \
    }                                                                                                                  \
    __attribute__((flatten)) static void smooth_go_##name(const struct scree_rule *rule, struct motion *m, int count,  \
                                                          double step, struct course *c, struct stride *to) {          \
        const struct smooth_laws laws = {__VA_ARGS__};                                                                 \
        struct scree_rule constants = *rule;                                                                           \
        if (laws.none) return;                                                                                         \
        SMOOTH_LOOP(step_lane(laws, &constants, m, k, step, c, to);)                                                   \
    }                                                                                                                  \
    __attribute__((flatten)) static void smooth_tick_##name(const struct scree_rule *rule, struct motion *m,           \
                                                            int count, double step, struct course *c,                  \
                                                            struct stride *to) {                                       \
        const struct smooth_laws laws = {__VA_ARGS__};                                                                 \
        struct scree_rule constants = *rule;                                                                           \
        if (laws.none || laws.root < 2 || (laws.rub && !laws.bare)) return;                                            \
        SMOOTH_LOOP(tick_lane(laws, &constants, m, k, step, c, to);)                                                   \
    }

/* What keeps numbers, reaches beyond the touch or changes its formula inside a contact isn't smooth. */
#define SMOOTH_NOT(law) (law.memory || law.reach || law.bends)
#define SMOOTH_ALONE(word)                                                                                             \
    SMOOTH_PASS(word, .press = normal_##word##_force, .cut = scree_normal_##word.cut,                                  \
                .root = scree_normal_##word.root, .none = SMOOTH_NOT(scree_normal_##word))
SCREE_NORMAL_LAWS(SMOOTH_ALONE)

/* Laws that go together get a pass; of others every contact is left to within.c. */
#define SMOOTH_PAIRS(PAIR)                                                                                             \
    PAIR(linear, coulomb)                                                                                              \
    PAIR(linear_cut, coulomb)                                                                                          \
    PAIR(hertz, coulomb)                                                                                               \
    PAIR(hunt_crossley, coulomb)                                                                                       \
    PAIR(tsuji_cut, coulomb)                                                                                           \
    PAIR(hertz, mindlin)                                                                                               \
    PAIR(tsuji, mindlin)                                                                                               \
    PAIR(tsuji_cut, mindlin)
#define LARGER_ROOT(one, other) (one > other ? one : other)
#define SMOOTH_TOGETHER(one, other, how, is_bare)                                                                      \
    SMOOTH_PASS(one##_##other##how, .press = normal_##one##_force, .rub = friction_##other##_force,                    \
                .hold = other##_hold, .stiffness = scree_friction_##other.stiffness,                                   \
                .damping = scree_friction_##other.damping, .cut = scree_normal_##one.cut,                              \
                .root = LARGER_ROOT(scree_normal_##one.root, scree_friction_##other.root),                             \
                .memory = scree_friction_##other.memory, .bare = is_bare)
#define SMOOTH_BOTH(one, other) SMOOTH_TOGETHER(one, other, _bare, 1) SMOOTH_TOGETHER(one, other, _damped, 0)
SMOOTH_PAIRS(SMOOTH_BOTH)

#define ENTRY(word) {smooth_rates_##word, smooth_go_##word, smooth_tick_##word},
static const struct smooth_loops smooth_alone[] = {SCREE_NORMAL_LAWS(ENTRY)};
#undef ENTRY
#define ENTRY(one, other)                                                                                              \
    {NORMAL_##one,                                                                                                     \
     FRICTION_##other,                                                                                                 \
     {{smooth_rates_##one##_##other##_damped, smooth_go_##one##_##other##_damped,                                      \
       smooth_tick_##one##_##other##_damped},                                                                          \
      {smooth_rates_##one##_##other##_bare, smooth_go_##one##_##other##_bare, smooth_tick_##one##_##other##_bare}}},
static const struct {
    int normal, friction;
    struct smooth_loops loops[2]; /* with a dashpot; without */
} smooth_pairs[] = {SMOOTH_PAIRS(ENTRY)};
#undef ENTRY

/* The contacts of a rule in a step. */
struct smooth_pass {
    const struct smooth_loops *loops; /* NULL: there are none */
    const struct scree_rule *rule;
    double step;
    int substeps; /* as asked for; 0: as many as needed */
    int cut, turns, root, rubs;
    int ticks; /* there are steps by the clock of a root */
};

/* A slider behind a bare spring? Whether these frictions have a dashpot is a matter of the law, not of the pair. */
static int is_bare(const struct scree_rule *rule, const struct scree_batch *batch, int first) {
    const struct scree_friction_law *friction = scree_friction_laws[rule->friction];
    struct scree_pair_constants pair = {
        {scree_pair(batch, SCREE_PAIR_FRICTION, first), scree_pair(batch, SCREE_PAIR_FRICTION + 1, first), 0.0, 0.0}};
    return friction->slider && friction->damping(&rule->friction_constants, pair, 1.0) == 0.0;
}

static const struct smooth_loops *smooth_loops_of(const struct scree_rule *rule, int bare) {
    if (rule->friction < 0) return &smooth_alone[rule->normal];
    for (size_t k = 0; k < sizeof smooth_pairs / sizeof *smooth_pairs; k++)
        if (smooth_pairs[k].normal == rule->normal && smooth_pairs[k].friction == rule->friction)
            return &smooth_pairs[k].loops[bare];
    return NULL;
}

static struct smooth_pass smooth_pass_of(const struct scree_contacts *contacts, const struct scree_batch *batch,
                                         int first, double step) {
    const struct scree_rule *rule = &contacts->rule[batch->rule];
    const struct scree_normal_law *normal = scree_normal_laws[rule->normal];
    struct smooth_pass pass = {.rule = rule, .step = step, .substeps = contacts->substeps};
    if (SMOOTH_NOT((*normal))) return pass;
    int rubs = pass.rubs = rule->friction >= 0, bare = rubs && is_bare(rule, batch, first);
    pass.loops = smooth_loops_of(rule, bare);
    pass.ticks = !rubs || bare;
    pass.cut = normal->cut;
    pass.turns = rubs ? !normal->cut : !normal->turns_smoothly;
    pass.root = normal->root;
    if (rubs && scree_friction_laws[rule->friction]->root > pass.root)
        pass.root = scree_friction_laws[rule->friction]->root;
    return pass;
}

/* ---- through the step ---- */

/* Contacts on their way. */
struct march {
    struct motion m;
    struct course c;
    struct stride to;
    int by_clock; /* steps by the clock of a root of the overlap: all are behind its begin (1) or before its end (-1); 0: they aren't */
};

/* What happens in a step of Runge-Kutta: nothing; it is too long; approach turns into parting where the law isn't smooth there; a
 * slider breaks loose, or holds again; contact ends; or what is left to within.c. */
enum { NOTHING, COARSE, TURNS, SLIPS, ENDS, ODD };

/* So many events of a contact are gone past in a step, what has more is left to within.c; so many tries find one. */
enum { MOST_EVENTS = 8, TRIES = 40 };

/* Free flight up to the touch, on a parabola, of what touches in the step; `rest` of all others is zero. */
static SCREE_INLINE void begin_lane(int k, double step, double flight, int rubs, struct motion *m, struct course *c) {
    double d = c->d[k], u = c->u[k], a = m->closing[k], square = u * u - 2.0 * a * d;
    double root = u + sqrt(square > 0.0 ? square : 0.0), start = -2.0 * d / (root + SCREE_NO_SPEED);
    int touches = d > 0.0, begins = !touches & (flight > 0.0), thrown_back = !(root > 0.0) | (u + step * a <= 0.0);
    /* What overlaps still after its end flies on, unless it may be pushed together again. */
    double pushed = a > 0.0 ? m->pushes[0][k] + 2.0 * a * m->pushes[1][k] : m->pushes[0][k];
    int ended = c->odd[k] > 0.0, flies = ended & (u + step * a < 0.0) & (u < 0.0) & (pushed < 0.0);
    double odd = ((begins & thrown_back) | (ended & !flies)) ? 1.0 : 0.0;
    start = start < step ? start : step;
    start = touches ? 0.0 : start;
    c->odd[k] = odd;
    c->rest[k] = ((touches | begins) & !ended & !(odd > 0.0)) ? step - start : 0.0;
    c->d[k] = begins ? 0.0 : d;
    c->u[k] = begins ? u + start * a : u;
    if (!rubs) return;
    int holds = touches & !flies;
    struct vec none = {0.0, 0.0, 0.0}, v = get(c->v, k), flown = vec_axpy(v, start, get(m->aside, k));
    put(c->v, k, begins ? flown : v);
    put(c->s, k, holds ? get(c->s, k) : none);
    c->slides[k] = holds ? c->slides[k] : 0.0;
}

static void begin_lanes(int count, double step, int rubs, const double *flight, struct march *x) {
    if (rubs)
        SMOOTH_LOOP(begin_lane(k, step, flight[k], 1, &x->m, &x->c);)
    else
        SMOOTH_LOOP(begin_lane(k, step, flight[k], 0, &x->m, &x->c);)
    for (int k = count; k < padded(count); k++) x->c.rest[k] = 0.0;
}

/* So many steps of the grid behind a begin go by the clock; further on the force is smooth enough without. */
static const double clocked = 3.0;

/* The way that the clock goes: behind a begin that far, before an end up to that of the step. */
static SCREE_INLINE double way_by_clock(const struct march *x, int k) {
    double rest = x->c.rest[k], most = clocked * x->m.grid[k];
    return x->by_clock > 0 && most < rest ? most : rest;
}

/* The next step: what is left, in equal parts no longer than the grid's. */
static void stride_out(int count, struct march *x) {
    SMOOTH_LOOP({
        double rest = x->c.rest[k];
        int parts = 1 + (int)(rest / x->m.grid[k] * (1.0 - 1e-12));
        x->to.time[k] = x->by_clock ? way_by_clock(x, k) : rest / parts;
    })
}

/* What has happened in it. Returns whether anything has. With friction, a step may be too long. */
static int look(const struct smooth_pass *pass, int count, const struct march *x, double *event) {
    const struct course *c = &x->c;
    const struct stride *to = &x->to;
    int turning = pass->turns, rubs = pass->rubs, control = rubs && !pass->substeps, any = 0;
    _Pragma("omp simd reduction(| : any)")
    for (int k = 0; k < padded(count); k++) {
        double time = to->time[k];
        int coarse = control & (to->coarse[k] > 0.0) & (x->m.grid[k] > 0.75 * pass->step);
        double before = to->turns[0][k], after = to->turns[1][k];
        int moves = rubs | (c->u[k] * time > 1e-12 * c->d[k]); /* rest isn't a turn */
        int turns = turning & (after < 0.0) & (before > -1e-10 * after) & moves;
        int slips = rubs & (to->holds[1][k] < 0.0), ends = to->lasts[1][k] < 0.0;
        int odd = (ends & !turns & !slips & !(to->lasts[0][k] > 0.0)) | !(c->d[k] >= 0.0);
        double what = ends ? ENDS : NOTHING;
        what = turns ? TURNS : what;
        what = slips ? SLIPS : what;
        what = coarse ? COARSE : what;
        what = odd ? ODD : what;
        event[k] = time > 0.0 ? what : NOTHING;
        any |= event[k] > 0.0;
    }
    return any;
}

/* Take the step in lanes in which nothing has happened. */
static void accept(int count, int rubs, const double *event, struct march *x) {
    struct course *c = &x->c;
    const struct stride *to = &x->to;
    SMOOTH_LOOP({
        int takes = (event[k] == NOTHING) & (to->time[k] > 0.0);
        double left = c->rest[k] - to->time[k], press = to->press[k], moment = to->press_moment[k] + left * press;
        c->press[k] += takes ? press : 0.0;
        c->press_moment[k] += takes ? moment : 0.0;
        c->d[k] = takes ? to->d[k] : c->d[k];
        c->u[k] = takes ? to->u[k] : c->u[k];
        c->rest[k] = takes ? left : c->rest[k];
    })
    if (!rubs) return;
    SMOOTH_LOOP({
        int takes = (event[k] == NOTHING) & (to->time[k] > 0.0);
        double left = c->rest[k]; /* set above */
        for (int i = 0; i < 3; i++) {
            double rub = to->rub[i][k], moment = to->rub_moment[i][k] + left * rub;
            c->rub[i][k] += takes ? rub : 0.0;
            c->rub_moment[i][k] += takes ? moment : 0.0;
            c->deep[i][k] += takes ? to->deep[i][k] : 0.0;
            c->v[i][k] = takes ? to->v[i][k] : c->v[i][k];
            c->q[i][k] = takes ? to->q[i][k] : c->q[i][k];
            c->s[i][k] = takes ? to->s[i][k] : c->s[i][k];
        }
        c->slides[k] = takes ? to->slides[k] : c->slides[k];
    })
}

/* Set the clock of a lane for its step: time since the begin of the root, or until its end, which is reckoned with the speed of now unless
 * it is known to be that of the step. Returns the number of its own steps, for a root that is near and one that isn't. */
static int set_clock(const struct smooth_pass *pass, int k, int ends, struct march *x) {
    struct stride *to = &x->to;
    double time = to->time[k], away = fabs(x->c.d[k] / x->c.u[k]), over = away - time, way = way_by_clock(x, k);
    over = ends || !(over > 0.0) ? 0.0 : over;
    double other = x->by_clock > 0 ? away : over, near = sqrt(other / (time + other));
    if (pass->root == 4) near = sqrt(near);
    int parts = 1 + (int)(way / x->m.grid[k] * (1.0 - 1e-12)), pieces = other < 1.5 * way ? 2 + 2 * parts : parts;
    to->span[k] = x->by_clock * (time + other);
    to->offset[k] = x->by_clock > 0 ? -other : time + other;
    to->sigma[k] = x->by_clock > 0 ? near : 1.0;
    to->size[k] = x->by_clock * (1.0 - near) / pieces;
    return pieces;
}

/* The step of all lanes by the clock of a root. */
static void tick(const struct smooth_pass *pass, int count, const int *ends, struct march *x) {
    struct stride *to = &x->to;
    int pieces[SCREE_LANES], most = 0;
    double time[SCREE_LANES];
    for (int k = 0; k < padded(count); k++) {
        pieces[k] = set_clock(pass, k, ends && ends[k], x);
        if (pieces[k] > most) most = pieces[k];
    }
    memcpy(time, to->time, sizeof time);
    memset(to->time, 0, sizeof to->time); /* what is at the begin; nothing has been yielded */
    pass->loops->go(pass->rule, &x->m, count, pass->step, &x->c, to);
    memcpy(to->time, time, sizeof time);
    for (int piece = 0; piece < most; piece++) {
        for (int k = 0; k < padded(count); k++)
            if (piece == pieces[k]) to->size[k] = 0.0;
        pass->loops->tick(pass->rule, &x->m, count, pass->step, &x->c, to);
    }
}

/* `ends`: lanes in which contact is to end with the step; NULL: none. */
static void go(const struct smooth_pass *pass, int count, const int *ends, struct march *x) {
    if (x->by_clock)
        tick(pass, count, ends, x);
    else
        pass->loops->go(pass->rule, &x->m, count, pass->step, &x->c, &x->to);
}

/* What is positive before an event and negative behind it, at the begin (0) or the end (1) of the step. */
static double still(const struct march *x, int k, int event, int end) {
    if (event == TURNS) return x->to.turns[end][k];
    return event == SLIPS ? x->to.holds[end][k] : x->to.lasts[end][k];
}

/* An event between two times, and the values there; `kept`: which end has been kept in the try before. */
struct bracket {
    double low, high, at_low, at_high;
    int kept;
};

/* Regula falsi with the weights of Anderson & Bjoerck, BIT 13 (1973) 253: the value of an end that is kept twice is cut by as much as the
 * other one has fallen. */
static double cut_of(double value, double before) {
    double cut = 1.0 - value / before;
    return cut > 0.0 ? cut : 0.5;
}

static void narrow(double t, double value, struct bracket *in) {
    if (value > 0.0) {
        if (in->kept > 0 && in->at_low > 0.0) in->at_high *= cut_of(value, in->at_low);
        in->low = t;
        in->at_low = value;
        in->kept = 1;
    } else {
        if (in->kept < 0 && in->at_high < 0.0) in->at_low *= cut_of(value, in->at_high);
        in->high = t;
        in->at_high = value;
        in->kept = -1;
    }
}

static double guess(const struct bracket *in, int bisect) {
    double t = in->high - in->at_high * (in->high - in->low) / (in->at_high - in->at_low);
    return !bisect && t > in->low && t < in->high ? t : 0.5 * (in->low + in->high);
}

/* Shorten the steps over whose course events happen, so that they end there. What should have happened before they begin happens where they
 * do; from a value of zero it may have risen first, but not for less than a millionth of the step. */
static void shorten(const struct smooth_pass *pass, int count, const double *event, struct march *x) {
    struct bracket in[SCREE_LANES];
    double size[SCREE_LANES];
    int open = 0, anew = 0, is_open[SCREE_LANES], what[SCREE_LANES], ends[SCREE_LANES];
    for (int k = 0; k < padded(count); k++) {
        what[k] = (int)event[k];
        ends[k] = what[k] == ENDS;
        in[k] = (struct bracket){0.0, x->to.time[k], still(x, k, what[k], 0), still(x, k, what[k], 1), 0};
        size[k] = in[k].at_low - in[k].at_high;
        open |= is_open[k] = what[k] != NOTHING && in[k].at_low >= 0.0;
        if (what[k] == NOTHING || is_open[k]) continue;
        x->to.time[k] = 0.0;
        anew = 1;
    }
    for (int try = 0; open && try < TRIES; try++) {
        open = 0;
        for (int k = 0; k < padded(count); k++)
            if (is_open[k]) x->to.time[k] = guess(&in[k], try % 6 == 5);
        go(pass, count, ends, x);
        for (int k = 0; k < padded(count); k++) {
            if (!is_open[k]) continue;
            double value = still(x, k, what[k], 1);
            int found = fabs(value) <= 1e-11 * size[k];
            narrow(x->to.time[k], value, &in[k]);
            if (in[k].high - in[k].low > (in[k].at_low > 0.0 ? 1e-14 : 1e-6) * pass->step) {
                open |= is_open[k] = !found;
            } else {
                anew |= x->to.time[k] != in[k].high;
                x->to.time[k] = in[k].high;
                is_open[k] = 0;
            }
        }
    }
    for (int k = 0; k < padded(count); k++) {
        if (!is_open[k]) continue;
        x->to.time[k] = in[k].high;
        anew = 1;
    }
    if (anew) go(pass, count, ends, x);
}

/* After its end a contact flies; if that leads back to the touch within the step, it goes on from there. */
static void fly_on(int k, int rubs, struct march *x) {
    struct course *c = &x->c;
    double d = c->d[k], u = c->u[k], a = x->m.closing[k], square = u * u - 2.0 * a * d;
    double back = square > 0.0 ? sqrt(square) : 0.0, flight = (back - u) / a;
    int touches = a > 0.0 && u < 0.0 && back > 0.0 && flight < c->rest[k];
    c->rest[k] = touches ? c->rest[k] - flight : 0.0;
    c->d[k] = touches ? 0.0 : d;
    c->u[k] = touches ? back : u;
    if (!rubs) return;
    if (touches) put(c->v, k, vec_axpy(get(c->v, k), flight, get(x->m.aside, k)));
    put(c->s, k, vec(0.0, 0.0, 0.0));
    c->slides[k] = 0.0;
}

/* What an event changes. */
static void pass_event(int count, int rubs, const double *event, struct march *x) {
    struct course *c = &x->c;
    for (int k = 0; k < padded(count); k++) {
        if (event[k] == ENDS) fly_on(k, rubs, x);
        if (event[k] == SLIPS) c->slides[k] = c->slides[k] > 0.0 ? 0.0 : 1.0;
    }
}

/* Some of the lanes by themselves, and back; padding repeats the last. */
static void split_off(const struct march *x, int *lane, int count, struct march *few) {
    for (int k = count; k < padded(count); k++) lane[k] = lane[count - 1];
    pick_lanes(x, lane, padded(count), offsetof(struct march, to), few);
    few->by_clock = 0;
}

static void join(const struct march *few, const int *lane, int count, struct march *x) {
    return_lanes(&few->m.grid, lane, count, sizeof few->m.grid, &x->m.grid);
    return_lanes(&few->c, lane, count, sizeof few->c, &x->c);
}

static void leave(int k, struct march *x) {
    x->c.odd[k] = 1.0;
    x->c.rest[k] = 0.0;
}

/* Lanes near the begin of a root of the overlap (side 1), or near its end (-1); left where the laws have no clock. */
static int lanes_near(const struct smooth_pass *pass, int count, int side, struct march *x, int *near) {
    int nears = 0;
    if (side < 0 && pass->cut) return 0;
    for (int k = 0; k < count; k++) {
        double rest = x->c.rest[k], grid = x->m.grid[k], d = x->c.d[k], u = side * x->c.u[k];
        double within = side < 0 ? 7.0 * rest : clocked * (rest < grid ? rest : grid);
        if (rest > 0.0 && u > 0.0 && d < within * u) near[nears++] = k;
    }
    if (pass->ticks) return nears;
    for (int i = 0; i < nears; i++) leave(near[i], x);
    return 0;
}

/* Past the events of the step that was tried; lanes without one stay where they are. */
static void go_past(const struct smooth_pass *pass, int count, const double *event, struct march *x) {
    const double none[SCREE_LANES] = {0.0};
    double own[SCREE_LANES], first[SCREE_LANES];
    int again = 0;
    for (int k = 0; k < padded(count); k++) {
        own[k] = event[k] >= TURNS && event[k] <= ENDS && x->c.rest[k] > 0.0 ? event[k] : NOTHING;
        if (own[k] == NOTHING) x->to.time[k] = 0.0;
    }
    shorten(pass, count, own, x);
    for (int k = 0; k < padded(count); k++) { /* sliding, or pressing, may go on until there is no contact any more */
        int until_end = pass->rubs && (own[k] == TURNS || (own[k] == SLIPS && x->c.slides[k] > 0.0));
        int ended = until_end && x->to.lasts[1][k] <= 0.0;
        again |= ended;
        own[k] = ended ? ENDS : own[k];
        first[k] = ended ? ENDS : NOTHING;
    }
    if (again) shorten(pass, count, first, x);
    accept(count, pass->rubs, none, x);
    pass_event(count, pass->rubs, own, x);
    for (int k = 0; k < padded(count); k++) x->c.events[k] += own[k] != NOTHING;
}

/* One step of all lanes. Where something happens, lanes wait until nothing else goes on any more: then they all go past it. */
static void advance(const struct smooth_pass *pass, int count, struct march *x) {
    double event[SCREE_LANES] = {0.0};
    int goes_on = 0;
    stride_out(count, x);
    go(pass, count, NULL, x);
    int any = look(pass, count, x, event);
    accept(count, pass->rubs, event, x);
    if (!any) return;
    for (int k = 0; k < padded(count); k++) {
        int odd = event[k] == ODD || (event[k] >= TURNS && x->c.events[k] >= MOST_EVENTS);
        if (odd) leave(k, x);
        if (event[k] == COARSE) x->m.grid[k] *= 0.5;
        goes_on |= event[k] <= COARSE && x->c.rest[k] > 0.0;
    }
    if (!goes_on || x->by_clock) go_past(pass, count, event, x);
}

/* All lanes to the end of the step. */
static void march_on(const struct smooth_pass *pass, int count, struct march *x) {
    struct march few;
    int lane[SCREE_LANES], some;
    for (;;) {
        for (int side = 1; side >= -1 && pass->root >= 2; side -= 2) {
            while ((some = lanes_near(pass, count, side, x, lane))) {
                split_off(x, lane, some, &few);
                few.by_clock = side;
                advance(pass, some, &few);
                join(&few, lane, some, x);
            }
        }
        advance(pass, count, x);
        some = 0;
        for (int k = 0; k < count; k++)
            if (x->c.rest[k] > 0.0) lane[some++] = k;
        if (!some) return;
        if (2 * some > count) continue;
        split_off(x, lane, some, &few);
        march_on(pass, some, &few);
        join(&few, lane, some, x);
        return;
    }
}

/* ---- a block ---- */

/* Columns of a block on its way. */
struct smooth_block {
    struct block b;
    struct meeting at;
    struct march x;
    double flight[SCREE_LANES]; /* overlap at the end of the step if nothing acts, m */
    double depth[SCREE_LANES];  /* overlap that friction had on the mean, m; 0: none */
};

/* Nothing has been yielded yet. */
static void begin_course(struct course *c) {
    memset(c->press, 0, offsetof(struct course, odd) - offsetof(struct course, press));
}

static void gather_smooth(const struct scree_bodies *now, const struct scree_batch *batch,
                          const struct scree_contact *contact, int first, const int *index, int count, int turns,
                          struct smooth_block *s) {
    struct ends ends;
    find_ends(now, contact, count, &ends);
    gather(now, contact, &ends, count, batch->geometry, &s->b);
    for (int lane = 0; lane < padded(count); lane += 4) {
        const struct scree_contact *four[4];
        for (int i = 0; i < 4; i++) four[i] = &contact[lane + i < count ? lane + i : count - 1];
        fetch_pushes(now->push, four, lane, turns, &s->at);
    }
    begin_course(&s->x.c);
    fetch_kept(batch, first, index, count, turns, &s->b, &s->at, &s->x.c, &s->x.m);
}

/* A loop of its own for each kind of contact. */
static void meet_smooth(struct smooth_block *s, int count, double step, int balls, int turns) {
    if (balls && turns) {
        SMOOTH_LOOP(meet_lane(&s->b, k, step, 1, 1, &s->at, &s->x.c, &s->x.m);)
    } else if (balls) {
        SMOOTH_LOOP(meet_lane(&s->b, k, step, 1, 0, &s->at, &s->x.c, &s->x.m);)
    } else if (turns) {
        SMOOTH_LOOP(meet_lane(&s->b, k, step, 0, 1, &s->at, &s->x.c, &s->x.m);)
    } else {
        SMOOTH_LOOP(meet_lane(&s->b, k, step, 0, 0, &s->at, &s->x.c, &s->x.m);)
    }
}

static void drive_smooth(struct smooth_block *s, int count, double step, int turns) {
    if (turns) {
        SMOOTH_LOOP(drive_lane(&s->b, k, step, 1, &s->at, &s->x.m);)
    } else {
        SMOOTH_LOOP(drive_lane(&s->b, k, step, 0, &s->at, &s->x.m);)
    }
    SMOOTH_LOOP(s->flight[k] = s->x.c.d[k] + (step * s->x.c.u[k] + 0.5 * step * step * s->x.m.closing[k]);)
}

static void yield_smooth(struct smooth_block *s, int count, int balls, int turns, struct scree_yield *yield,
                         struct scree_moments *moments) {
    if (balls && turns) {
        SMOOTH_LOOP(yield_lane(&s->b, k, 1, 1, &s->at, &s->x.c, yield, moments);)
    } else if (balls) {
        SMOOTH_LOOP(yield_lane(&s->b, k, 1, 0, &s->at, &s->x.c, yield, moments);)
    } else if (turns) {
        SMOOTH_LOOP(yield_lane(&s->b, k, 0, 1, &s->at, &s->x.c, yield, moments);)
    } else {
        SMOOTH_LOOP(yield_lane(&s->b, k, 0, 0, &s->at, &s->x.c, yield, moments);)
    }
    SMOOTH_LOOP({
        double steady = s->b.n[0][k] * s->at.later_n[0][k] + s->b.n[1][k] * s->at.later_n[1][k] +
                        s->b.n[2][k] * s->at.later_n[2][k];
        int plain = (steady >= 0.9) & (s->x.m.give[k] > 0.0);
        s->x.c.odd[k] = plain ? s->x.c.odd[k] : 1.0;
    })
}

/* Depths, slopes, and levers. */
static void rate_contacts(struct smooth_block *s, int count, double slope, int turns, struct scree_yield *yield) {
    SMOOTH_LOOP(yield->depth[k] = s->b.overlap[k] / limit_of(&s->b, k);)
    if (turns)
        SMOOTH_LOOP({
            struct vec rub = get(s->x.c.rub, k);
            double square = vec_norm2(rub), deep = vec_dot(get(s->x.c.deep, k), rub) / (square + SCREE_NO_SPEED);
            s->depth[k] = square > 0.0 ? s->b.overlap[k] + deep : 0.0;
        })
    if (slope == 0.0)
        SMOOTH_LOOP(yield->steep[k] = 0.0;)
    else
        SMOOTH_LOOP(yield->steep[k] =
                        slope * 4.0 * s->b.rush[3][k] * vec_dot(get(yield->impulse, k), get(s->at.later_n, k));)
}

/* What is kept of contacts one after the other. */
static void keep_all(const struct scree_batch *batch, struct smooth_block *s, int first, int count, int turns,
                     struct scree_yield *yield) {
    for (int m = 0; m < (turns ? SCREE_PAST_STEP : SCREE_PAST_DEPTH); m++) {
        double *last = batch->past[m] + first, *before = batch->past[SCREE_PAST_STEP + m] + first;
        const double *now = m == SCREE_PAST_DEPTH ? s->depth : yield->impulse[m];
        SMOOTH_LOOP({
            before[k] = s->x.c.odd[k] > 0.0 ? before[k] : last[k];
            last[k] = s->x.c.odd[k] > 0.0 ? last[k] : now[k];
        })
    }
    if (!turns || !batch->kept[0]) return;
    for (int m = 0; m < 4; m++) {
        double *kept = batch->kept[m] + first, *now = m < 3 ? s->x.c.s[m] : s->x.c.slides;
        SMOOTH_LOOP({ kept[k] = s->x.c.odd[k] > 0.0 ? kept[k] : now[k]; })
    }
}

/* The same of one contact here or there, whose yield goes to another lane. */
static void hand_over(const struct scree_batch *batch, struct smooth_block *s, int i, int index, int lane, int turns,
                      struct scree_yield *from, struct scree_moments *moments_from, struct scree_yield *yield,
                      struct scree_moments *moments) {
    for (int axis = 0; axis < 3; axis++) {
        yield->impulse[axis][lane] = from->impulse[axis][i];
        moments->impulse[axis][lane] = moments_from->impulse[axis][i];
        yield->turn_ball[axis][lane] = turns ? from->turn_ball[axis][i] : 0.0;
        yield->turn_host[axis][lane] = turns ? from->turn_host[axis][i] : 0.0;
    }
    for (int m = 0; m < (turns ? SCREE_PAST_STEP : SCREE_PAST_DEPTH); m++) {
        batch->past[SCREE_PAST_STEP + m][index] = batch->past[m][index];
        batch->past[m][index] = m == SCREE_PAST_DEPTH ? s->depth[i] : from->impulse[m][i];
    }
    yield->depth[lane] = from->depth[i];
    yield->steep[lane] = from->steep[i];
    for (int m = 0; turns && batch->kept[0] && m < 4; m++) {
        batch->kept[m][index] = m < 3 ? s->x.c.s[m][i] : s->x.c.slides[i];
    }
}

/* Nothing can happen in this step: too far apart, and nothing kept of an earlier touch. */
static int far_apart(const struct scree_bodies *now, const struct scree_batch *batch,
                     const struct scree_contact *contact, int index) {
    for (int m = 0; m < SCREE_PAST; m++)
        if (batch->past[m][index] != 0.0) return 0;
    const struct scree_record *ball = &now->record[contact->ball], *host = &now->record[contact->host];
    double range = now->push[contact->ball].along[3] + now->push[contact->host].along[3];
    if (batch->geometry == SCREE_BALL_PLANE) {
        if (!(scree_meet(now, contact, SCREE_BALL_PLANE, vec_from(ball->x)).overlap + range < 0.0)) return 0;
    } else {
        double reach = ball->radius + host->radius;
        double square = vec_norm2(scree_apart(now, contact, batch->geometry));
        if (!(square > reach * reach) || !(square > (reach + range) * (reach + range))) return 0;
    }
    for (int m = 0; m < SCREE_MEMORY; m++)
        if (scree_kept(batch, m, index) != 0.0) return 0;
    return 1;
}

static void hand_nothing(struct scree_yield *yield, struct scree_moments *moments, int lane) {
    struct vec zero = {0.0, 0.0, 0.0};
    put(yield->impulse, lane, zero);
    put(yield->turn_ball, lane, zero);
    put(yield->turn_host, lane, zero);
    put(moments->impulse, lane, zero);
    yield->depth[lane] = yield->steep[lane] = 0.0;
}

/* Both bodies are balls, or one is frozen. */
static int is_plain(const struct scree_bodies *bodies, const struct scree_contact *contact) {
    enum scree_body_class ball = bodies->class[contact->ball], host = bodies->class[contact->host];
    return (ball == SCREE_CLASS_BALL && host != SCREE_CLASS_GENERAL) ||
           (ball == SCREE_CLASS_FIXED && host == SCREE_CLASS_BALL);
}

/* From gathered lanes to their yield. */
static void run_smooth(const struct scree_contacts *contacts, const struct scree_bodies *now,
                       const struct scree_batch *batch, const struct smooth_pass *pass,
                       const struct scree_contact *contact, int first, const int *index, int count, double step,
                       struct smooth_block *s, struct scree_yield *yield, struct scree_moments *moments) {
    const struct scree_rule *rule = &contacts->rule[batch->rule];
    int balls = batch->geometry != SCREE_BALL_PLANE, turns = rule->friction >= 0, touching = 0;
    gather_smooth(now, batch, contact, first, index, count, turns, s);
    meet_smooth(s, count, step, balls, turns);
    pass->loops->rates(rule, batch->slope, step, pass->substeps, count, &s->x.c, &s->x.m);
    drive_smooth(s, count, step, turns);
    begin_lanes(count, step, turns, s->flight, &s->x);
    s->x.by_clock = 0;
    for (int k = 0; k < count; k++) touching |= s->x.c.rest[k] > 0.0;
    if (touching) march_on(pass, count, &s->x);
    yield_smooth(s, count, balls, turns, yield, moments);
    rate_contacts(s, count, batch->slope, turns, yield);
}

/* Where only few of the contacts act, these are drawn together. */
static uint32_t impel_few(const struct scree_contacts *contacts, const struct scree_bodies *now,
                          const struct scree_batch *batch, const struct smooth_pass *pass, int first, const int *lane,
                          int count, double step, struct scree_yield *yield, struct scree_moments *moments) {
    struct smooth_block s;
    struct scree_yield few;
    struct scree_moments few_moments;
    struct scree_contact contact[SCREE_LANES];
    int index[SCREE_LANES], turns = contacts->rule[batch->rule].friction >= 0;
    uint32_t odd = 0;
    for (int i = 0; i < count; i++) contact[i] = batch->contact[index[i] = first + lane[i]];
    run_smooth(contacts, now, batch, pass, contact, first, index, count, step, &s, &few, &few_moments);
    for (int i = 0; i < count; i++)
        if (s.x.c.odd[i] > 0.0)
            odd |= (uint32_t)1 << lane[i];
        else
            hand_over(batch, &s, i, index[i], lane[i], turns, &few, &few_moments, yield, moments);
    return odd;
}

uint32_t SCREE_PART(impel)(const struct scree_contacts *contacts, const struct scree_bodies *now,
                           const struct scree_batch *batch, int first, int count, double step,
                           struct scree_yield *yield, struct scree_moments *moments) {
    const struct scree_rule *rule = &contacts->rule[batch->rule];
    const struct smooth_pass pass = smooth_pass_of(contacts, batch, first, step);
    enum scree_geometry geometry = batch->geometry;
    int balls = geometry == SCREE_BALL_BALL || geometry == SCREE_BALL_IMAGE, lane[SCREE_LANES], acting = 0;
    uint32_t odd = 0;
    if (!pass.loops || rule->rolling >= 0 || !(balls || geometry == SCREE_BALL_PLANE)) return ~(uint32_t)0;
    for (int k = 0; k < count; k++) {
        const struct scree_contact *one = &batch->contact[first + k];
        if (!is_plain(now, one))
            odd |= (uint32_t)1 << k;
        else if (!far_apart(now, batch, one, first + k))
            lane[acting++] = k;
    }
    if (2 * acting < count || odd) {
        for (int k = 0; k < count; k++) hand_nothing(yield, moments, k);
        if (acting) odd |= impel_few(contacts, now, batch, &pass, first, lane, acting, step, yield, moments);
        return odd;
    }
    struct smooth_block s;
    run_smooth(contacts, now, batch, &pass, batch->contact + first, first, NULL, count, step, &s, yield, moments);
    keep_all(batch, &s, first, count, rule->friction >= 0, yield);
    for (int k = 0; k < count; k++) odd |= (uint32_t)(s.x.c.odd[k] > 0.0) << k;
    return odd;
}

#ifdef __AVX__
/* Columns of three numbers as rows; their fourth numbers are zero. */
static inline void load_rows(double (*column)[SCREE_LANES], int lane, scree_row r[4]) {
    for (int i = 0; i < 3; i++) r[i] = *(const scree_row *)&column[i][lane];
    r[3] = (scree_row){0.0, 0.0, 0.0, 0.0};
    transpose(r);
}
#endif

/* Impulses of a block and their moments into the bodies, whose attitudes don't turn by them. */
void SCREE_PART(add_up)(struct scree_bodies *bodies, const struct scree_contact *contact, int count, int turns,
                        int hosts, struct scree_yield *yield, struct scree_moments *moments) {
#ifdef __AVX__
    for (int lane = 0; lane < count; lane += 4) {
        scree_row impulse[4], moment[4], turn_ball[4], turn_host[4];
        load_rows(yield->impulse, lane, impulse);
        load_rows(moments->impulse, lane, moment);
        if (turns) load_rows(yield->turn_ball, lane, turn_ball);
        if (turns && hosts) load_rows(yield->turn_host, lane, turn_host);
        for (int i = 0; i < 4 && lane + i < count; i++) {
            int ball = contact[lane + i].ball, host = contact[lane + i].host;
            *(scree_row *)bodies->record[ball].f += impulse[i];
            *(scree_row *)bodies->push[ball].moment += moment[i];
            if (turns) *(scree_row *)bodies->record[ball].t += turn_ball[i];
            if (!hosts) continue;
            *(scree_row *)bodies->record[host].f -= impulse[i];
            *(scree_row *)bodies->push[host].moment -= moment[i];
            if (turns) *(scree_row *)bodies->record[host].t += turn_host[i];
        }
    }
#else
    for (int lane = 0; lane < count; lane++) {
        int ball = contact[lane].ball, host = contact[lane].host;
        for (int k = 0; k < 3; k++) {
            bodies->record[ball].f[k] += yield->impulse[k][lane];
            bodies->push[ball].moment[k] += moments->impulse[k][lane];
            if (turns) bodies->record[ball].t[k] += yield->turn_ball[k][lane];
            if (!hosts) continue;
            bodies->record[host].f[k] -= yield->impulse[k][lane];
            bodies->push[host].moment[k] -= moments->impulse[k][lane];
            if (turns) bodies->record[host].t[k] += yield->turn_host[k][lane];
        }
    }
#endif
}
