/* Contacts of smooth.c on their way through a step: lanes go on by steps of Runge and Kutta, each of its own length.
 * What happens in one (contact ends, a slider breaks loose or holds again, approach and parting change) is located;
 * lanes to which something happens wait until nothing else goes on in their block, and go past it together. */
#ifndef SCREE_CONTACT_MARCH_H
#define SCREE_CONTACT_MARCH_H

#include "contact/lane.h"

#include <stddef.h>

/* Loops over the lanes of a vector, `from` on, with a normal law in them. */
struct normal_loops {
    void (*go)(const struct scree_rule *rule, const struct lane_constants *m, int from, double step, struct course *c,
               struct rk_step *to, struct squeezes *by);
    void (*tick)(const struct scree_rule *rule, const struct lane_constants *m, int from, double step, double root,
                 struct course *c, struct rk_step *to, struct squeezes *by);
    void (*soon)(const struct scree_rule *rule, const struct lane_constants *m, int from, double step, struct course *c,
                 struct squeezes *by);
    void (*rate)(const struct scree_rule *rule, struct lane_constants *m, int from, double step, struct course *c,
                 struct softness *to);
    void (*store)(const struct scree_rule *rule, const struct lane_constants *m, int from, const kept_columns kept,
                  const double *overlap, const double *closing, double *energy);
    void (*recall)(const struct scree_rule *rule, const struct lane_constants *m, int from, int meets,
                   struct course *c);
};

/* With a friction law in them, behind those. */
struct friction_loops {
    void (*go)(const struct scree_rule *rule, const struct lane_constants *m, int from, double step, struct course *c,
               struct rk_step *to, const struct squeezes *by);
    void (*tick)(const struct scree_rule *rule, const struct lane_constants *m, int from, double step, struct course *c,
                 struct rk_step *to, const struct squeezes *by);
    void (*rate)(const struct scree_rule *rule, struct lane_constants *m, int from, double slope, struct softness *to);
};

/* Flags in such a loop are numbers, 0 or 1: negations of ints beside doubles keep gcc from making vectors. */
#define SMOOTH_LOOP(...)                                                                                               \
    _Pragma("omp simd")                                                                                                \
    for (int k = 0; k < padded(count); k++) __VA_ARGS__

/* The same of the lanes of one vector, `from` on. */
#define SMOOTH_VECTOR(...)                                                                                             \
    _Pragma("omp simd")                                                                                                \
    for (int k = from; k < from + WIDTH; k++) __VA_ARGS__

/* The contacts of a rule in a step. */
struct smooth_pass {
    const struct normal_loops *normal;        /* NULL: the laws aren't smooth, all contacts are left to within.c */
    const struct friction_loops *friction[2]; /* the second: where no slider slides; most stick in a bed */
    const struct scree_rule *rule;
    double step;
    double slope; /* of the friction law, s/m */
    int pieces;   /* of a step, at least: as asked for, or two where the normal law changes its formula, or one */
    int asked;    /* they are asked for; else as many as needed */
    int cut, root, rubs;
    int turns;   /* the normal law changes its formula where approach turns into parting */
    int pulls;   /* friction ends where a contact begins to pull, and it may */
    int changes; /* the normal law remembers, or changes its formula */
    int damped;  /* friction's slider is behind a spring and a dashpot */
    int bare;    /* it is behind a bare spring */
    int books;   /* energy is looked at */
};

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

/* ---- on the way ---- */

/* Whether there is a one in a vector of lanes. */
static int any_of(const double column[SCREE_LANES], int from) {
    int any = 0;
    for (int k = from; k < from + WIDTH; k++) any |= column[k] > 0.0;
    return any;
}

/* Of a step that normal laws have made: what friction makes of it. Only bare springs that slide ask what comes soon. */
static const struct friction_loops *friction_of(const struct smooth_pass *pass, const struct lane_constants *m,
                                                int from, struct course *c, struct squeezes *by) {
    int slide = any_of(c->slides, from);
    if (slide && !pass->damped) pass->normal->soon(pass->rule, m, from, pass->step, c, by);
    return pass->friction[!slide];
}

/* All lanes go on by their times. */
static void step_lanes(const struct smooth_pass *pass, const struct lane_constants *m, int count, struct course *c,
                       struct rk_step *to) {
    struct squeezes by;
    for (int from = 0; from < padded(count); from += WIDTH) {
        pass->normal->go(pass->rule, m, from, pass->step, c, to, &by);
        if (pass->rubs) friction_of(pass, m, from, c, &by)->go(pass->rule, m, from, pass->step, c, to, &by);
    }
}

/* The same in one step by the clock of a root. */
static void tick_lanes(const struct smooth_pass *pass, const struct lane_constants *m, int count, struct course *c,
                       struct rk_step *to) {
    struct squeezes by;
    for (int from = 0; from < padded(count); from += WIDTH) {
        pass->normal->tick(pass->rule, m, from, pass->step, pass->root, c, to, &by);
        if (pass->rubs) friction_of(pass, m, from, c, &by)->tick(pass->rule, m, from, pass->step, c, to, &by);
        for (int k = from; k < from + WIDTH; k++) to->sigma[k] += to->size[k];
    }
}

/* Before the step: rates of damping, and grids. */
static void rate_lanes(const struct smooth_pass *pass, int count, struct course *c, struct lane_constants *m) {
    struct softness by;
    for (int from = 0; from < padded(count); from += WIDTH) {
        pass->normal->rate(pass->rule, m, from, pass->step, c, &by);
        if (pass->rubs) pass->friction[0]->rate(pass->rule, m, from, pass->slope, &by);
    }
    SMOOTH_LOOP(rule_grid(pass->step, pass->asked, pass->pieces, k, &by, m);)
}

/* What normal laws remember where lanes are; `meets`: of those that begin to touch (recall). */
static void recall_lanes(const struct smooth_pass *pass, const struct lane_constants *m, int count, int meets,
                         struct course *c) {
    for (int from = 0; pass->changes && from < padded(count); from += WIDTH)
        pass->normal->recall(pass->rule, m, from, meets, c);
}

/* Contacts on their way. */
struct march {
    struct lane_constants m;
    struct course c;
    struct rk_step to;
    int by_clock; /* steps by the clock of a root of the overlap: all are behind its begin (1) or before its end (-1);
                     0: they aren't */
};

/* Of lanes that begin to touch: what normal laws remember of that, and which bare springs slide from the first on. One
 * whose load grows like a higher power of time than its stretch slides until the load has overtaken it, which may be
 * over by the end of the step. */
static void meet_lanes(const struct smooth_pass *pass, int count, const int *begins, struct march *x) {
    int any = 0;
    recall_lanes(pass, &x->m, count, 1, &x->c);
    for (int k = 0; k < padded(count); k++) {
        x->to.time[k] = begins[k] ? SCREE_SO_SOON * pass->step : 0.0;
        any |= begins[k];
    }
    if (!any || !pass->bare) return;
    step_lanes(pass, &x->m, count, &x->c, &x->to);
    for (int k = 0; k < padded(count); k++)
        if (begins[k] && x->to.holds[1][k] < 0.0) x->c.slides[k] = 1.0;
}

/* What happens in a step of Runge-Kutta: nothing; it is too long; approach turns into parting, or parting into
 * approach, where the law isn't smooth there; a contact with friction begins to press, or to pull; a slider breaks
 * loose, or holds again; contact ends; or what is left to within.c. */
enum { NOTHING, COARSE, TURNS, PRESSES, PULLS, SLIPS, ENDS, ODD };

/* So many events of a contact are gone past in a step, what has more is left to within.c; so many tries find one. */
enum { MOST_EVENTS = 8, TRIES = 40 };

/* Free flight up to the touch, on a parabola, of what touches in the step; `rest` of all others is zero. */
static SCREE_INLINE void begin_lane(int k, double step, double flight, int rubs, struct lane_constants *m,
                                    struct course *c) {
    double d = c->d[k], u = c->u[k], a = m->closing[k], square = u * u - 2.0 * a * d;
    double root = u + sqrt(square > 0.0 ? square : 0.0), start = -2.0 * d / (root + SCREE_NO_SPEED);
    double touches = d > 0.0 ? 1.0 : 0.0, begins = flight > 0.0 ? 1.0 - touches : 0.0;
    double thrown_back = ((root > 0.0) & (u + step * a > 0.0)) ? 0.0 : begins;
    /* What overlaps still after its end flies on, unless it may be pushed together again. */
    double pushed = a > 0.0 ? m->pushes[0][k] + 2.0 * a * m->pushes[1][k] : m->pushes[0][k];
    double ended = c->odd[k], flies = ((u + step * a < 0.0) & (u < 0.0) & (pushed < 0.0)) ? ended : 0.0;
    double odd = thrown_back + (ended - flies), acts = (touches + begins) - (ended + odd);
    start = start < step ? start : step;
    start = touches > 0.0 ? 0.0 : start;
    c->odd[k] = odd;
    c->rest[k] = acts > 0.0 ? step - start : 0.0;
    c->d[k] = begins > 0.0 ? 0.0 : flies > 0.0 ? flight : d;
    c->u[k] = begins > 0.0 ? u + start * a : flies > 0.0 ? u + step * a : u;
    if (!rubs) return;
    double holds = touches - flies;
    struct vec none = {0.0, 0.0, 0.0}, v = get(c->v, k), flown = vec_axpy(v, start, get(m->aside, k));
    put(c->v, k, begins > 0.0 ? flown : v);
    put(c->s, k, holds > 0.0 ? get(c->s, k) : none);
    c->slides[k] = holds > 0.0 ? c->slides[k] : 0.0;
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

static SCREE_INLINE int is_near(const struct march *x, int k, int side) {
    double rest = x->c.rest[k], grid = x->m.grid[k], d = x->c.d[k], u = side * x->c.u[k];
    double within = side < 0 ? 7.0 * rest : clocked * (rest < grid ? rest : grid);
    return (rest > 0.0) & (u > 0.0) & (d < within * u);
}

/* The next step: what is left, in equal parts no longer than the grid's. */
static void stride_out(int count, struct march *x) {
    SMOOTH_LOOP({
        double rest = x->c.rest[k];
        int parts = 1 + (int)(rest / x->m.grid[k] * (1.0 - 1e-12));
        x->to.time[k] = x->by_clock ? way_by_clock(x, k) : rest / parts;
    })
}

/* With friction, a step over the whole grid may be too long. */
static int is_controlled(const struct smooth_pass *pass) { return pass->rubs && !pass->asked; }

/* What may have happened in the step of a lane; each 1 if it has, else 0. `odd`: the overlap isn't one any more, or
 * the normal law has another formula. */
struct seen {
    double coarse, dips, turns, presses, pulls, slips, ends, leaves, odd;
};

/* Whether bodies that part first and approach at the end have left each other in between: whether the parabola with
 * their speeds falls below an overlap of zero. (Where the law is cut they may have, too: it pulls then for so long.) */
static SCREE_INLINE double leaves_lane(const struct smooth_pass *pass, int k, const struct march *x) {
    double d = x->c.d[k], u = x->c.u[k], after = x->to.u[k], uncut = pass->cut ? 0.0 : 1.0;
    return ((u < 0.0) & (after > 0.0) & (2.0 * d * (after - u) < u * u * x->to.time[k])) ? uncut : 0.0;
}

/* From what is positive before an event to what is negative behind it. */
static SCREE_INLINE int passes(double before, double after) { return (after < 0.0) & (before > -1e-10 * after); }

/* Approach turns into parting, or the other way round: positive before, negative behind. */
static SCREE_INLINE double turning(const struct march *x, int k, int end) {
    double u = x->to.turns[end][k];
    return x->c.u[k] < 0.0 ? -u : u;
}

static SCREE_INLINE struct seen see_lane(const struct smooth_pass *pass, int rubs, int changes, double by_control,
                                         int k, const struct march *x) {
    const struct course *c = &x->c;
    const struct rk_step *to = &x->to;
    double coarse = rubs ? by_control * to->coarse[k] : 0.0;
    struct seen seen = {.coarse = x->m.grid[k] > 0.75 * pass->step ? coarse : 0.0,
                        .ends = to->lasts[1][k] < 0.0 ? 1.0 : 0.0,
                        .leaves = leaves_lane(pass, k, x),
                        .odd = c->d[k] >= 0.0 ? 0.0 : 1.0};
    if (changes) {
        double moves = fabs(c->u[k]) * to->time[k] > 1e-12 * c->d[k] ? 1.0 : 0.0; /* rest isn't a turn */
        double turns = passes(turning(x, k, 0), turning(x, k, 1)) ? moves : 0.0;
        double before = c->u[k] < 0.0 ? 1.0 - seen.ends : 1.0; /* what parts ends before it approaches */
        seen.turns = pass->turns ? before * turns : 0.0;
        seen.odd = to->bends[k] > 0.0 ? 1.0 : seen.odd;
    }
    if (rubs) {
        double by_pull = pass->pulls ? 1.0 : 0.0;
        seen.presses = passes(-to->pulls[0][k], -to->pulls[1][k]) ? by_pull : 0.0;
        seen.pulls = passes(to->pulls[0][k], to->pulls[1][k]) ? by_pull : 0.0;
        double dips = x->m.grid[k] > pass->step / SCREE_FINEST ? to->dips[k] : 0.0;
        seen.slips = ((to->holds[0][k] < 0.0) | (to->holds[1][k] < 0.0)) ? 1.0 : 0.0;
        seen.dips = seen.slips > 0.0 ? 0.0 : dips;
    }
    return seen;
}

/* What has. */
static SCREE_INLINE double look_lane(const struct smooth_pass *pass, int rubs, int changes, double by_control, int k,
                                     const struct march *x) {
    struct seen seen = see_lane(pass, rubs, changes, by_control, k, x);
    double what = x->to.lasts[0][k] > 0.0 ? ENDS : ODD;
    what = seen.ends > 0.0 ? what : NOTHING;
    what = seen.pulls > 0.0 ? PULLS : what;
    what = seen.slips > 0.0 ? SLIPS : what;
    what = seen.presses > 0.0 ? PRESSES : what; /* first of all: sliders are looked at once more up to there */
    what = seen.turns > 0.0 ? TURNS : what;
    what = ((seen.coarse + seen.dips > 0.0) & (what < ODD)) ? COARSE : what;
    what = seen.odd > 0.0 ? ODD : what;
    return x->to.time[k] > 0.0 ? what : NOTHING;
}

/* CALL(rubs, changes): a loop of its own for each. */
#define FOR_DOINGS(pass, CALL)                                                                                         \
    do {                                                                                                               \
        if ((pass)->rubs && (pass)->changes) {                                                                         \
            CALL(1, 1);                                                                                                \
        } else if ((pass)->rubs) {                                                                                     \
            CALL(1, 0);                                                                                                \
        } else if ((pass)->changes) {                                                                                  \
            CALL(0, 1);                                                                                                \
        } else {                                                                                                       \
            CALL(0, 0);                                                                                                \
        }                                                                                                              \
    } while (0)

/* The same of all lanes. Returns whether anything has happened. */
static int look(const struct smooth_pass *pass, int count, const struct march *x, double *event) {
    double by_control = is_controlled(pass) && !x->by_clock ? 1.0 : 0.0, most = 0.0;
#define LOOK(rubs, changes) SMOOTH_LOOP(event[k] = look_lane(pass, rubs, changes, by_control, k, x);)
    FOR_DOINGS(pass, LOOK);
#undef LOOK
    _Pragma("omp simd reduction(max : most)")
    for (int k = 0; k < padded(count); k++) most = event[k] > most ? event[k] : most;
    return most > 0.0;
}

/* One axis of what friction does in it. */
static SCREE_INLINE void accept_axis(int axis, int takes, int anew, int k, double left, const struct rk_step *to,
                                     struct course *c) {
    double rub = to->rub[axis][k], rub_moment = to->rub_moment[axis][k] + left * rub;
    c->rub[axis][k] = (anew ? 0.0 : c->rub[axis][k]) + (takes ? rub : 0.0);
    c->rub_moment[axis][k] = (anew ? 0.0 : c->rub_moment[axis][k]) + (takes ? rub_moment : 0.0);
    c->deep[axis][k] = (anew ? 0.0 : c->deep[axis][k]) + (takes ? to->deep[axis][k] : 0.0);
    c->v[axis][k] = takes ? to->v[axis][k] : c->v[axis][k];
    c->q[axis][k] = takes ? to->q[axis][k] : c->q[axis][k];
    c->s[axis][k] = takes ? to->s[axis][k] : c->s[axis][k];
}

/* Take the step of a lane, if `takes`; `anew`: nothing has been yielded before. */
static SCREE_INLINE void accept_lane(int rubs, int changes, int takes, int anew, int k, struct march *x) {
    struct course *c = &x->c;
    const struct rk_step *to = &x->to;
    double left = c->rest[k] - to->time[k], press = to->press[k], moment = to->press_moment[k] + left * press;
    c->press[k] = (anew ? 0.0 : c->press[k]) + (takes ? press : 0.0);
    c->press_moment[k] = (anew ? 0.0 : c->press_moment[k]) + (takes ? moment : 0.0);
    c->d[k] = takes ? to->d[k] : c->d[k];
    c->u[k] = takes ? to->u[k] : c->u[k];
    left = c->rest[k] = takes ? left : c->rest[k];
    if (changes) {
        c->kept[0][k] = takes ? to->kept[0][k] : c->kept[0][k];
        c->kept[1][k] = takes ? to->kept[1][k] : c->kept[1][k];
    }
    if (!rubs) return;
    accept_axis(0, takes, anew, k, left, to, c);
    accept_axis(1, takes, anew, k, left, to, c);
    accept_axis(2, takes, anew, k, left, to, c);
    c->rubbed[k] = (anew ? 0.0 : c->rubbed[k]) + (takes ? to->rubbed[k] : 0.0);
    c->slides[k] = takes ? to->slides[k] : c->slides[k];
}

/* The same of the lanes in which nothing has happened. */
static void accept(const struct smooth_pass *pass, int count, const double *event, struct march *x) {
#define ACCEPT(rubs, changes)                                                                                          \
    SMOOTH_LOOP(accept_lane(rubs, changes, (event[k] == NOTHING) & (x->to.time[k] > 0.0), 0, k, x);)
    FOR_DOINGS(pass, ACCEPT);
#undef ACCEPT
}

/* Set the clock of a lane for its step: time since the begin of the root, or until its end, which is reckoned with the
 * speed of now unless it is known to be that of the step. Returns the number of its own steps, for a root that is near
 * and one that isn't. */
static int set_clock(const struct smooth_pass *pass, int k, int ends, struct march *x) {
    struct rk_step *to = &x->to;
    double time = to->time[k], away = fabs(x->c.d[k] / x->c.u[k]), over = away - time, way = way_by_clock(x, k);
    over = ends || !(over > 0.0) ? 0.0 : over;
    double other = x->by_clock > 0 ? away : over, near = scree_whole_root(other / (time + other), pass->root);
    int parts = 1 + (int)(way / x->m.grid[k] * (1.0 - 1e-12)), pieces = other < 1.5 * way ? 2 + 2 * parts : parts;
    to->span[k] = x->by_clock * (time + other);
    to->offset[k] = x->by_clock > 0 ? -other : time + other;
    to->sigma[k] = x->by_clock > 0 ? near : 1.0;
    to->size[k] = x->by_clock * (1.0 - near) / pieces;
    return pieces;
}

/* What tells events, at the begin of the step; of a slider soon behind it: at the very begin there may be no forces yet
 * to compare. */
static void look_at_begin(const struct smooth_pass *pass, int count, struct march *x) {
    double time[SCREE_LANES], soon = pass->damped ? SCREE_SO_SOON : 0.0;
    memcpy(time, x->to.time, sizeof time);
    for (int k = 0; k < padded(count); k++) x->to.time[k] *= soon;
    step_lanes(pass, &x->m, count, &x->c, &x->to);
    if (pass->damped) memcpy(x->to.holds[0], x->to.holds[1], sizeof x->to.holds[0]);
    memcpy(x->to.time, time, sizeof time);
}

/* Nothing has been yielded yet. */
static SCREE_INLINE void begin_tick(int rubs, int changes, int k, struct march *x) {
    const struct vec none = {0.0, 0.0, 0.0};
    x->to.press[k] = x->to.press_moment[k] = x->to.dips[k] = 0.0;
    x->to.holds[1][k] = 1.0;
    if (changes) {
        x->to.kept[0][k] = x->c.kept[0][k];
        x->to.kept[1][k] = x->c.kept[1][k];
    }
    if (!rubs) return;
    put(x->to.rub, k, none);
    put(x->to.rub_moment, k, none);
    put(x->to.deep, k, none);
    put(x->to.s, k, get(x->c.s, k));
    x->to.rubbed[k] = 0.0;
}

/* The step of all lanes by the clock of a root; `ends` as below. */
static void tick(const struct smooth_pass *pass, int count, const int *ends, struct march *x) {
    int pieces[SCREE_LANES], most = 0;
    for (int k = 0; k < padded(count); k++) {
        pieces[k] = set_clock(pass, k, ends && ends[k], x);
        if (pieces[k] > most) most = pieces[k];
    }
    if (!ends) look_at_begin(pass, count, x);
#define BEGIN_TICK(rubs, changes) SMOOTH_LOOP(begin_tick(rubs, changes, k, x);)
    FOR_DOINGS(pass, BEGIN_TICK);
#undef BEGIN_TICK
    for (int piece = 0; piece < most; piece++) {
        for (int k = 0; k < padded(count); k++)
            if (piece == pieces[k]) x->to.size[k] = 0.0;
        tick_lanes(pass, &x->m, count, &x->c, &x->to);
    }
}

/* `ends`: lanes in which contact is to end with the step; NULL: none, and they haven't gone from where they are before.
 */
static void go(const struct smooth_pass *pass, int count, const int *ends, struct march *x) {
    if (x->by_clock)
        tick(pass, count, ends, x);
    else
        step_lanes(pass, &x->m, count, &x->c, &x->to);
}

/* What is positive before an event and negative behind it, at the begin (0) or the end (1) of the step. */
static double still(const struct march *x, int k, int event, int end) {
    if (event == TURNS) return turning(x, k, end);
    if (event == PULLS) return x->to.pulls[end][k];
    if (event == PRESSES) return -x->to.pulls[end][k];
    return event == SLIPS ? x->to.holds[end][k] : x->to.lasts[end][k];
}

/* An event between two times, and the values there; `kept`: which end has been kept in the try before. */
struct bracket {
    double low, high, at_low, at_high;
    int kept;
};

/* Regula falsi with the weights of Anderson & Bjoerck, BIT 13 (1973) 253: the value of an end that is kept twice is cut
 * by as much as the other one has fallen. */
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

/* Shorten the steps over whose course events happen, so that they end there. What should have happened before they
 * begin happens where they do; from a value of zero it may have risen first, but not for less than a millionth of the
 * step. */
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
    double rest = c->rest[k];
    int touches = a > 0.0 && u < 0.0 && back > 0.0 && flight < rest;
    c->rest[k] = touches ? rest - flight : 0.0;
    c->d[k] = touches ? 0.0 : d + rest * (u + 0.5 * rest * a);
    c->u[k] = touches ? back : u + rest * a;
    if (!rubs) return;
    if (touches) put(c->v, k, vec_axpy(get(c->v, k), flight, get(x->m.aside, k)));
    put(c->s, k, vec(0.0, 0.0, 0.0));
    c->slides[k] = 0.0;
}

/* A bare spring that slides has the stretch of its force. One that holds from the very begin of a step on takes that
 * over: the force has jumped there, as far as the other contacts of the bodies weren't foreseen; what bears more than
 * it may would break loose at once. */
static void take_over(const struct smooth_pass *pass, int count, const double *event, struct march *x) {
    int takes[SCREE_LANES], any = 0;
    for (int k = 0; k < padded(count); k++)
        any |= takes[k] = event[k] == SLIPS && x->c.slides[k] > 0.0 && x->to.time[k] == 0.0;
    if (!any || !pass->bare) return;
    memset(x->to.time, 0, sizeof x->to.time);
    step_lanes(pass, &x->m, count, &x->c, &x->to);
    for (int k = 0; k < padded(count); k++)
        if (takes[k]) put(x->c.s, k, get(x->to.s, k));
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

/* Whether a lane can go through all of the step in as few pieces as there must be: it touches, and the grid is no
 * finer. `odd` is 1 of all others, */
static SCREE_INLINE void try_lane(const struct smooth_pass *pass, int k, struct march *x) {
    double left = x->c.odd[k], step = pass->step;
    left = x->c.d[k] > 0.0 ? left : 1.0;
    left = x->m.grid[k] == step / pass->pieces ? left : 1.0;
    x->c.rest[k] = step;
    x->c.odd[k] = left;
}

/* and of those to which the force sets in as a root nearby. The next of so many pieces. */
static SCREE_INLINE void try_piece(const struct smooth_pass *pass, int k, int pieces, struct march *x) {
    double left = pass->root >= 2 && is_near(x, k, 1) ? 1.0 : x->c.odd[k];
    x->c.odd[k] = pass->root >= 2 && !pass->cut && is_near(x, k, -1) ? 1.0 : left;
    x->to.time[k] = pieces > 1 ? x->c.rest[k] / pieces : x->c.rest[k];
}

/* Steps by the clock don't tell whether they are too long: those over the whole grid always are. (Impacts under Tsuji's
 * law with Mindlin's friction err four times as much by them.) Returns whether a lane is still near a root then. */
static int refine(const struct smooth_pass *pass, int k, int side, struct march *x) {
    if (!is_controlled(pass) || !(x->m.grid[k] > 0.75 * pass->step)) return 1;
    x->m.grid[k] *= 0.5;
    return is_near(x, k, side);
}

/* Lanes near the begin of a root of the overlap (side 1), or near its end (-1). */
static int lanes_near(const struct smooth_pass *pass, int count, int side, struct march *x, int *near) {
    int nears = 0, any = 0;
    if (side < 0 && pass->cut) return 0;
    _Pragma("omp simd reduction(| : any)")
    for (int k = 0; k < padded(count); k++) any |= is_near(x, k, side);
    for (int k = 0; any && k < count; k++)
        if (is_near(x, k, side) && refine(pass, k, side, x)) near[nears++] = k;
    return nears;
}

/* In a step that ends with an event, what happens before: parting, sliding, or pressing, may go on until there is no
 * contact any more; a slider may slip before the law, or what it bears, changes its formula. */
static double what_first(const struct smooth_pass *pass, int k, double event, const struct march *x) {
    int until_end = pass->rubs && (event == PULLS || (event == SLIPS && x->c.slides[k] > 0.0));
    until_end |= event == TURNS && x->c.u[k] < 0.0;
    if (until_end && x->to.lasts[1][k] <= 0.0) return ENDS;
    return (event == TURNS || event == PRESSES) && see_lane(pass, pass->rubs, 0, 0.0, k, x).slips > 0.0 ? SLIPS
                                                                                                        : NOTHING;
}

/* Past the events of the step that was tried; lanes without one stay where they are. */
static void go_past(const struct smooth_pass *pass, int count, const double *event, struct march *x) {
    const double none[SCREE_LANES] = {0.0};
    double own[SCREE_LANES] = {0.0}, first[SCREE_LANES];
    int again = 0, begins[SCREE_LANES] = {0};
    for (int k = 0; k < padded(count); k++) {
        own[k] = event[k] >= TURNS && event[k] <= ENDS && x->c.rest[k] > 0.0 ? event[k] : NOTHING;
        if (own[k] == NOTHING) x->to.time[k] = 0.0;
    }
    shorten(pass, count, own, x);
    for (int k = 0; k < padded(count); k++) {
        first[k] = what_first(pass, k, own[k], x);
        again |= first[k] != NOTHING;
        own[k] = first[k] != NOTHING ? first[k] : own[k];
    }
    if (again) shorten(pass, count, first, x);
    accept(pass, count, none, x);
    take_over(pass, count, own, x);
    pass_event(count, pass->rubs, own, x);
    for (int k = 0; k < padded(count); k++) begins[k] = own[k] == ENDS && x->c.rest[k] > 0.0;
    meet_lanes(pass, count, begins, x);
    for (int k = 0; k < padded(count); k++) x->c.events[k] += own[k] != NOTHING;
}

/* Steps in which bodies leave each other and touch again end where they are farthest apart: the end of their contact is
 * to be seen there. */
static void turn_back(const struct smooth_pass *pass, int count, struct march *x) {
    double any = 0.0;
    _Pragma("omp simd reduction(max : any)")
    for (int k = 0; k < padded(count); k++) {
        double leaves = leaves_lane(pass, k, x);
        any = leaves > any ? leaves : any;
    }
    if (!(any > 0.0)) return;
    for (int k = 0; k < padded(count); k++)
        if (leaves_lane(pass, k, x) > 0.0) x->to.time[k] *= x->c.u[k] / (x->c.u[k] - x->to.u[k]);
    go(pass, count, NULL, x);
}

/* One step of all lanes. Where something happens, lanes wait until nothing else goes on any more: then they all go past
 * it. */
static void advance(const struct smooth_pass *pass, int count, struct march *x) {
    double event[SCREE_LANES] = {0.0};
    int goes_on = 0;
    stride_out(count, x);
    go(pass, count, NULL, x);
    if (!pass->cut) turn_back(pass, count, x);
    int any = look(pass, count, x, event);
    accept(pass, count, event, x);
    if (!any) return;
    for (int k = 0; k < padded(count); k++) {
        int odd = event[k] == ODD || (event[k] >= TURNS && x->c.events[k] >= MOST_EVENTS);
        if (odd) leave(k, x);
        if (event[k] == COARSE) x->m.grid[k] *= 0.5;
        goes_on |= event[k] <= COARSE && x->c.rest[k] > 0.0;
    }
    if (!goes_on || x->by_clock) go_past(pass, count, event, x);
}

/* Lanes that aren't at the end of the step yet. */
static int lanes_left(int count, const struct march *x, int *lane) {
    int left = 0;
    for (int k = 0; k < count; k++)
        if (x->c.rest[k] > 0.0) lane[left++] = k;
    return left;
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
        if (!lanes_left(count, x, lane)) return;
        advance(pass, count, x);
        some = lanes_left(count, x, lane);
        if (!some) return;
        if (2 * some > count) continue;
        split_off(x, lane, some, &few);
        march_on(pass, some, &few);
        join(&few, lane, some, x);
        return;
    }
}

#endif
