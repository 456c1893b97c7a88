/* One lane of smooth.c: a contact of two spheres, or of one and a plane, as numbers instead of vectors and matrices,
 * and one step of Runge and Kutta of it, with what tells events in that step. W, the acceleration of the ball against
 * its host per unit of force on the ball (impulse.c), is of two spheres
 *   W F = (1/m_a + 1/m_b) F + (l_a^2/I_a + l_b^2/I_b) F_t
 * with l from the centre to the contact and F_t the part of F in the tangent plane.
 *
 * Everything is a function of one lane, so that no bit depends on its neighbours. */
#ifndef SCREE_CONTACT_LANE_H
#define SCREE_CONTACT_LANE_H

#include "contact/block.h"
#include "contact/slider.h"

typedef struct scree_normal_force press_law(const struct scree_law_constants *law, struct scree_pair_constants pair,
                                            struct scree_pressing at);
typedef struct scree_hold hold_law(const struct scree_law_constants *law, struct scree_sliding at);
typedef double stored_law(const struct scree_law_constants *law, struct scree_pair_constants pair,
                          struct scree_pressing at);
typedef double at_overlap(const struct scree_law_constants *law, struct scree_pair_constants pair, double overlap);

/* The laws of a pass: constants where it is called, so that each pass is a loop of its own. */
struct smooth_laws {
    press_law *press;
    hold_law *hold; /* friction is a slider behind a spring and a dashpot (slider.h); NULL: there is none */
    at_overlap *stiffness, *damping;
    stored_law *stored; /* in the normal direction */
    int cut, root;
    int raises;    /* of the normal law: takes a power whose exponent is a parameter */
    int bare;      /* the spring has no dashpot beside it */
    int all_stick; /* no slider of the loop slides: how one does isn't reckoned */
    int none;      /* there is no such pass */
};

/* Columns of what stays during a step. */
struct lane_constants {
    double closing[SCREE_LANES];                       /* acceleration that isn't the pair's own: closing, m/s^2 */
    double aside[3][SCREE_LANES];                      /* and in the tangent plane */
    double give[SCREE_LANES], give_aside[SCREE_LANES]; /* W along the normal and across it, 1/kg */
    double start[SCREE_LANES];                         /* overlap at the start of the step, m */
    /* The levers there over the moments of inertia, summed, 1/(kg m); 1 over these, summed, 1/(kg m^2). */
    double lever[2][SCREE_LANES];
    double rate[SCREE_LANES]; /* of damping, 1/s */
    double grid[SCREE_LANES]; /* longest step of Runge-Kutta, s */
    /* Of laws that are cut: force after a free flight, N, and what closing adds to it, N s^2/m. */
    double pushes[2][SCREE_LANES];
    double pair[SCREE_PAIR_LEVER][SCREE_LANES]; /* pair constants of the normal law, then of the friction law */
};

/* Columns of what goes on: the state, and what the contact has yielded so far (along the normal, and in the tangent
 * plane). Levers become shorter by half the overlap; so the tangential velocity of the ball is v + (d - start) q, q =
 * (w_a + w_b) x n/2, where v is that at the levers of the start. */
struct course {
    double d[SCREE_LANES], u[SCREE_LANES];                          /* overlap, m; closing speed, m/s */
    double v[3][SCREE_LANES], q[3][SCREE_LANES], s[3][SCREE_LANES]; /* m/s; 1/s; friction's memory */
    double slides[SCREE_LANES];
    double rest[SCREE_LANES];                             /* of the step, that the contact still has before it, s */
    double press[SCREE_LANES], press_moment[SCREE_LANES]; /* N s, N s^2, about the end of the step */
    double rub[3][SCREE_LANES], rub_moment[3][SCREE_LANES];
    double deep[3][SCREE_LANES]; /* integral of (d - start) F_t, N s m */
    double rubbed[SCREE_LANES];  /* work against friction, J */
    double events[SCREE_LANES];  /* that it has gone past */
    double odd[SCREE_LANES];     /* 1: left to within.c */
};

/* Columns of one step of Runge-Kutta: its length and how it is to be made; where it leads, what it yields (moments:
 * about its own end), and what tells events: numbers that are positive before them and negative behind. */
struct rk_step {
    double time[SCREE_LANES];
    double lasts[2][SCREE_LANES]; /* at its begin and at its end: until contact ends */
    /* Until a slider that holds breaks loose, N, or one that slides holds, N or, of a bare spring, m/s; 1: there is
     * none. */
    double holds[2][SCREE_LANES];
    double turns[2][SCREE_LANES]; /* until a law that isn't smooth there turns to another formula */
    double d[SCREE_LANES], u[SCREE_LANES], v[3][SCREE_LANES], q[3][SCREE_LANES], s[3][SCREE_LANES];
    double slides[SCREE_LANES];
    double press[SCREE_LANES], press_moment[SCREE_LANES];
    double rub[3][SCREE_LANES], rub_moment[3][SCREE_LANES], deep[3][SCREE_LANES];
    double rubbed[SCREE_LANES];
    double coarse[SCREE_LANES]; /* 1: too long a step */
    /* The clock of a root, t = offset + span sigma^p: where it stands, and its step. */
    double offset[SCREE_LANES], span[SCREE_LANES], sigma[SCREE_LANES], size[SCREE_LANES];
};

/* ---- one step of Runge and Kutta ---- */

/* An instant inside the step. */
struct stage {
    double d, u, normal, damping;
    struct vec v, q, s, force;
    struct vec slip; /* v + (d - start) q */
    double slides;
    double stiffness, drag, limit; /* of spring and dashpot, N/m, N s/m; with which the slider slides, N */
};

static SCREE_INLINE struct scree_sliding sliding_at(const struct stage *at) {
    return (struct scree_sliding){.normal = at->normal > 0.0 ? at->normal : 0.0,
                                  .overlap = at->d,
                                  .closing = at->u,
                                  .velocity = at->slip,
                                  .stretch = at->s,
                                  .sliding = at->slides};
}

/* One lane's laws with their constants. */
struct smooth_lane {
    const struct scree_law_constants *normal, *friction;
    struct scree_pair_constants normal_pair, friction_pair;
};

static SCREE_INLINE struct smooth_lane lane_of(const struct scree_rule *rule, const struct lane_constants *m, int k) {
    return (struct smooth_lane){
        .normal = &rule->normal_constants,
        .friction = &rule->friction_constants,
        .normal_pair = {{m->pair[0][k], m->pair[1][k], m->pair[2][k], m->pair[3][k]}},
        .friction_pair = {{m->pair[SCREE_PAIR_FRICTION][k], m->pair[SCREE_PAIR_FRICTION + 1][k], 0.0, 0.0}}};
}

static SCREE_INLINE void press_stage(struct smooth_laws laws, const struct smooth_lane *lane, struct stage *at) {
    struct scree_pressing pressing = scree_pressed(at->d, at->u, 0.0, 0.0);
    struct scree_normal_force f = laws.press(lane->normal, lane->normal_pair, pressing);
    at->normal = f.elastic + f.damping * at->u;
    at->damping = f.damping;
}

/* What friction is made of at a stage whose overlap and normal force are set. */
static SCREE_INLINE void brace_stage(struct smooth_laws laws, const struct smooth_lane *lane, struct stage *at) {
    at->stiffness = laws.stiffness(lane->friction, lane->friction_pair, at->d);
    at->drag = laws.bare ? 0.0 : laws.damping(lane->friction, lane->friction_pair, at->d);
    at->limit = laws.hold(lane->friction, sliding_at(at)).slides;
}

/* What spring and dashpot would bear if the slider held, N. */
static SCREE_INLINE struct vec trial_at(const struct stage *at) {
    return vec_axpy(vec_scale(at->stiffness, at->s), at->drag, at->slip);
}

/* Friction at a stage whose stretch is known. A slider holds or slides whatever comes, until the step ends where it
 * shouldn't any more; a bare spring that slides has the stretch of its force. */
static SCREE_INLINE void hold_stage(struct smooth_laws laws, const struct smooth_lane *lane, struct stage *at) {
    brace_stage(laws, lane, at);
    struct vec trial = trial_at(at);
    at->force = vec_scale(-1.0, trial);
    if (laws.all_stick) return;
    double scale = at->slides > 0.0 ? at->limit / (vec_norm(trial) + SCREE_NO_SPEED) : 1.0;
    at->force = vec_scale(-scale, trial);
    if (laws.bare) at->s = vec_scale(scale, at->s);
}

/* Friction at a stage `time` after the first one, whose stretch is that of a slider that holds. */
static SCREE_INLINE void grip_stage(struct smooth_laws laws, const struct smooth_lane *lane, const struct stage *first,
                                    double time, struct stage *at) {
    brace_stage(laws, lane, at);
    at->force = vec_scale(-1.0, trial_at(at));
    if (laws.all_stick) return;
    struct scree_drawn before = {
        first->stiffness, first->drag, first->limit, first->slip, vec_scale(-1.0, first->force), first->s};
    struct scree_drawn drawn = {.k = at->stiffness, .drag = at->drag, .limit = at->limit, .slip = at->slip};
    scree_draw_on(&before, 1.0, time, laws.bare, &drawn);
    at->s = at->slides > 0.0 ? drawn.stretch : at->s;
    at->force = at->slides > 0.0 ? vec_scale(-1.0, drawn.carries) : at->force;
}

/* The stage that follows from the rates of `at`. */
static SCREE_INLINE struct stage go_stage(struct smooth_laws laws, const struct smooth_lane *lane,
                                          const struct lane_constants *m, int k, const struct stage *first,
                                          const struct stage *at, double time) {
    struct stage to = *first;
    to.d = first->d + time * at->u;
    to.u = first->u + time * (m->closing[k] - m->give[k] * at->normal);
    press_stage(laws, lane, &to);
    if (!laws.hold) return to;
    struct vec aside = vec(m->aside[0][k], m->aside[1][k], m->aside[2][k]);
    double shorter = 0.5 * (at->d - m->start[k]);
    to.v = vec_axpy(first->v, time, vec_axpy(aside, m->give_aside[k] - shorter * m->lever[0][k], at->force));
    to.q = vec_axpy(first->q, -0.5 * time * (m->lever[0][k] - shorter * m->lever[1][k]), at->force);
    to.slip = vec_axpy(to.v, to.d - m->start[k], to.q);
    to.s = vec_axpy(first->s, time, at->slip);
    grip_stage(laws, lane, first, time, &to);
    return to;
}

/* What friction remembers at the end, whose overlap and speeds are set. */
static SCREE_INLINE void finish_stage(struct smooth_laws laws, const struct smooth_lane *lane, const struct stage *a,
                                      const struct stage *b, const struct stage *c, const struct stage *d, double time,
                                      struct stage *end) {
    struct vec inner = vec_add(b->slip, c->slip), slip = vec_axpy(vec_add(a->slip, d->slip), 2.0, inner);
    end->s = vec_axpy(a->s, time * (1.0 / 6.0), slip);
    grip_stage(laws, lane, a, time, end);
}

/* Whether one step of Runge-Kutta isn't enough for 1e-7 of the speed of the contact: an oscillation of angular
 * frequency w errs by about (w h)^3/60 times the change of acceleration x h from the first stage to the second. */
static SCREE_INLINE double coarse_at(const struct lane_constants *m, int k, const struct stage *a,
                                     const struct stage *b, const struct stage *c, double time) {
    const double tolerance = 60.0 * 1e-7;
    double damped = m->rate[k] * time, deep = a->d + SCREE_NO_SPEED;
    double stiff = time * time * (m->give[k] * 1.5 * fabs(a->normal) / deep);
    double across = time * time * m->give_aside[k] * a->stiffness;
    stiff = across > stiff ? across : stiff;
    stiff = damped * damped > stiff ? damped * damped : stiff;
    double first = time * m->give[k] * (b->normal - a->normal), then = time * m->give[k] * (c->normal - b->normal);
    double change = first * first + then * then +
                    time * time * m->give_aside[k] * m->give_aside[k] *
                        (vec_norm2(vec_sub(b->force, a->force)) + vec_norm2(vec_sub(c->force, b->force)));
    double speed = a->u * a->u + vec_norm2(a->slip) + a->d * a->d * (stiff / (time * time));
    return stiff * stiff * stiff * change <= tolerance * tolerance * speed ? 0.0 : 1.0;
}

/* Positive while the contact lasts, zero where it ends. Where the law is cut, the force over its damping rather than
 * the force: k d/c + u has no root of d in it. */
static SCREE_INLINE double lasts_at(struct smooth_laws laws, double give, double step, const struct stage *at) {
    if (!laws.cut) return at->d;
    double beyond = at->u < 0.0 ? at->u : at->d / step, within = at->normal / (at->damping + 1e-6 / (give * step));
    return at->d > 0.0 ? within : beyond;
}

/* What a slider that holds could still bear, N; by how much more (N) one that slides would have to bear if it held; the
 * force of a bare spring can't be more than what it slides with: by how much faster (m/s) it is dragged than the
 * stretch grows that its load allows. */
static SCREE_INLINE double holds_at(struct smooth_laws laws, const struct smooth_lane *lane,
                                    const struct lane_constants *m, int k, double step, const struct stage *at) {
    double bears = vec_norm(trial_at(at)), left = laws.hold(lane->friction, sliding_at(at)).holds - bears;
    if (!laws.bare) return at->slides > 0.0 ? bears - at->limit : left;
    const double soon = 1e-5 * step;
    struct stage next = {.d = at->d + soon * at->u, .u = at->u + soon * (m->closing[k] - m->give[k] * at->normal)};
    press_stage(laws, lane, &next);
    brace_stage(laws, lane, &next);
    double growth = (next.limit / next.stiffness - at->limit / at->stiffness) / soon;
    struct vec towards = vec_axpy(at->s, 1e-12 * step, at->slip); /* nothing is stretched yet at the very begin */
    double dragged = vec_dot(at->slip, towards) / (vec_norm(towards) + SCREE_NO_SPEED);
    return at->slides > 0.0 ? dragged - growth : left;
}

/* What friction makes of the same step, and where it ends: `end` has its overlap and normal force. */
static SCREE_INLINE void end_sideways(struct smooth_laws laws, const struct smooth_lane *lane, struct lane_constants *m,
                                      int k, double step, const struct stage *first, const struct stage *second,
                                      const struct stage *third, const struct stage *fourth, double time,
                                      struct stage *end, struct rk_step *to) {
    double share = time * (1.0 / 6.0);
    struct vec between = vec_add(second->force, third->force);
    struct vec rub = vec_scale(share, vec_axpy(vec_add(first->force, fourth->force), 2.0, between));
    /* The impulse times the depth: levers are half of it shorter. */
    struct vec inner_deep =
        vec_axpy(vec_scale(second->d - m->start[k], second->force), third->d - m->start[k], third->force);
    struct vec outer_deep =
        vec_axpy(vec_scale(first->d - m->start[k], first->force), fourth->d - m->start[k], fourth->force);
    struct vec deep = vec_scale(share, vec_axpy(outer_deep, 2.0, inner_deep));
    end->v = vec_axpy(vec_axpy(first->v, time, get(m->aside, k)), m->give_aside[k], rub);
    end->v = vec_axpy(end->v, -0.5 * m->lever[0][k], deep);
    end->q = vec_axpy(first->q, -0.5 * m->lever[0][k], rub);
    end->q = vec_axpy(end->q, 0.25 * m->lever[1][k], deep);
    end->slip = vec_axpy(end->v, end->d - m->start[k], end->q);
    put(to->q, k, end->q);
    put(to->deep, k, deep);
    finish_stage(laws, lane, first, second, third, fourth, time, end);
    put(to->rub, k, rub);
    put(to->rub_moment, k, vec_scale(share * time, vec_add(first->force, between)));
    double outer_rubbing = vec_dot(first->force, first->slip) + vec_dot(fourth->force, fourth->slip);
    double inner_rubbing = vec_dot(second->force, second->slip) + vec_dot(third->force, third->slip);
    to->rubbed[k] = -share * (outer_rubbing + 2.0 * inner_rubbing);
    put(to->v, k, end->v);
    put(to->s, k, end->s);
    to->slides[k] = end->slides;
    to->holds[1][k] = holds_at(laws, lane, m, k, step, end);
    to->coarse[k] = coarse_at(m, k, first, second, third, time);
}

/* One lane goes on by its time. */
static SCREE_INLINE void step_lane(struct smooth_laws laws, const struct scree_rule *rule, struct lane_constants *m,
                                   int k, double step, struct course *c, struct rk_step *to) {
    struct smooth_lane lane = lane_of(rule, m, k);
    struct stage first = {.d = c->d[k], .u = c->u[k]};
    double time = to->time[k];
    press_stage(laws, &lane, &first);
    to->lasts[0][k] = lasts_at(laws, m->give[k], step, &first);
    to->turns[0][k] = laws.hold ? first.normal : first.u; /* friction ends where a contact begins to pull */
    to->holds[0][k] = 1.0;
    if (laws.hold) {
        first.v = get(c->v, k);
        first.q = get(c->q, k);
        first.slip = vec_axpy(first.v, first.d - m->start[k], first.q);
        first.s = get(c->s, k);
        first.slides = c->slides[k];
        hold_stage(laws, &lane, &first);
        to->holds[0][k] = holds_at(laws, &lane, m, k, step, &first) + (laws.bare ? 0.0 : 1e-9 * first.limit);
    }
    struct stage second = go_stage(laws, &lane, m, k, &first, &first, 0.5 * time);
    struct stage third = go_stage(laws, &lane, m, k, &first, &second, 0.5 * time);
    struct stage fourth = go_stage(laws, &lane, m, k, &first, &third, time);
    double inner = second.normal + third.normal, share = time * (1.0 / 6.0);
    double impulse = share * ((first.normal + fourth.normal) + 2.0 * inner);
    double moment = share * time * (first.normal + inner);
    struct stage end = first;
    end.u = first.u + (time * m->closing[k] - m->give[k] * impulse);
    end.d = first.d + (time * first.u + (0.5 * time * time * m->closing[k] - m->give[k] * moment));
    to->press[k] = impulse;
    to->press_moment[k] = moment;
    to->d[k] = end.d;
    to->u[k] = end.u;
    press_stage(laws, &lane, &end);
    to->lasts[1][k] = lasts_at(laws, m->give[k], step, &end);
    to->turns[1][k] = laws.hold ? end.normal : end.u;
    to->holds[1][k] = 1.0;
    to->coarse[k] = 0.0;
    if (laws.hold) end_sideways(laws, &lane, m, k, step, &first, &second, &third, &fourth, time, &end, to);
}

/* ---- where the force sets in as a root of the overlap ---- */

/* What a contact has yielded since a time: impulses and their integrals, and where its slider is. */
struct yields {
    double press, press_moment, rubbed;
    struct vec rub, rub_moment, deep, s;
};

static SCREE_INLINE struct yields add_yields(struct yields a, double share, const struct yields *rate) {
    a.press += share * rate->press;
    a.press_moment += share * rate->press_moment;
    a.rubbed += share * rate->rubbed;
    a.rub = vec_axpy(a.rub, share, rate->rub);
    a.rub_moment = vec_axpy(a.rub_moment, share, rate->rub_moment);
    a.deep = vec_axpy(a.deep, share, rate->deep);
    a.s = vec_axpy(a.s, share, rate->s);
    return a;
}

/* The instant `t` after that of the lane, and the rates of what it yields then. It is the first of its step, or `since`
 * it (s). */
static SCREE_INLINE struct yields tick_stage(struct smooth_laws laws, const struct smooth_lane *lane,
                                             struct lane_constants *m, int k, struct course *c, double t,
                                             const struct yields *so_far, const struct stage *first, double since,
                                             struct stage *at) {
    struct yields rate = {.press_moment = so_far->press, .rub_moment = so_far->rub};
    at->u = c->u[k] + (t * m->closing[k] - m->give[k] * so_far->press);
    at->d = c->d[k] + (t * c->u[k] + (0.5 * t * t * m->closing[k] - m->give[k] * so_far->press_moment));
    press_stage(laws, lane, at);
    rate.press = at->normal;
    if (!laws.hold) return rate;
    double lever = m->lever[0][k], deep = at->d - m->start[k];
    at->v = vec_axpy(vec_axpy(get(c->v, k), t, get(m->aside, k)), m->give_aside[k], so_far->rub);
    at->v = vec_axpy(at->v, -0.5 * lever, so_far->deep);
    at->q = vec_axpy(vec_axpy(get(c->q, k), -0.5 * lever, so_far->rub), 0.25 * m->lever[1][k], so_far->deep);
    at->slip = vec_axpy(at->v, deep, at->q);
    at->s = so_far->s;
    if (first)
        grip_stage(laws, lane, first, since, at);
    else
        hold_stage(laws, lane, at);
    rate.rub = at->force;
    rate.rubbed = -vec_dot(at->force, at->slip);
    rate.deep = vec_scale(deep, at->force);
    rate.s = at->slip;
    return rate;
}

/* A step in sigma on its way: what has been yielded before it, and by what comes of it so far; the rates of its last
 * stage, and the time per unit of its step that goes with them; its first stage and when that is; its last. */
struct ticking {
    struct yields start, end, rate;
    double along, began;
    struct stage first, at;
};

/* The stage at so much of the step, `weight` of which counts. A function for each stage instead of a loop over them:
 * compilers make no vectors of lanes that have a loop inside. */
static SCREE_INLINE void tick_on(struct smooth_laws laws, const struct smooth_lane *lane, struct lane_constants *m,
                                 int k, struct course *c, const struct rk_step *to, int is_first, double node,
                                 double weight, struct ticking *on) {
    double span = to->span[k], size = to->size[k];
    double sigma = to->sigma[k] + node * size, lower = scree_whole_power(sigma, laws.root - 1);
    double t = to->offset[k] + span * lower * sigma;
    struct yields now = weight > 0.0 ? add_yields(on->start, node * on->along, &on->rate) : on->end;
    if (is_first) on->began = t;
    on->rate = tick_stage(laws, lane, m, k, c, t, &now, is_first ? NULL : &on->first, t - on->began, &on->at);
    if (is_first) on->first = on->at;
    on->along = size * span * laws.root * lower;
    if (weight > 0.0) on->end = add_yields(on->end, weight * on->along, &on->rate);
}

/* Behind a begin or before an end time goes like sigma^p, so that force and motion are smooth in sigma; impulses and
 * their moments themselves are the states. One step in sigma; of size 0: nothing. */
static SCREE_INLINE void tick_lane(struct smooth_laws laws, const struct scree_rule *rule, struct lane_constants *m,
                                   int k, double step, struct course *c, struct rk_step *to) {
    struct smooth_lane lane = lane_of(rule, m, k);
    double size = to->size[k];
    struct yields start = {.press = to->press[k], .press_moment = to->press_moment[k]};
    if (laws.hold) {
        start.rubbed = to->rubbed[k];
        start.rub = get(to->rub, k);
        start.rub_moment = get(to->rub_moment, k);
        start.deep = get(to->deep, k);
        start.s = get(to->s, k);
    }
    struct ticking on = {.start = start, .end = start, .at = {.slides = laws.hold ? c->slides[k] : 0.0}};
    tick_on(laws, &lane, m, k, c, to, 1, 0.0, 1.0 / 6.0, &on);
    tick_on(laws, &lane, m, k, c, to, 0, 0.5, 2.0 / 6.0, &on);
    tick_on(laws, &lane, m, k, c, to, 0, 0.5, 2.0 / 6.0, &on);
    tick_on(laws, &lane, m, k, c, to, 0, 1.0, 1.0 / 6.0, &on);
    tick_on(laws, &lane, m, k, c, to, 0, 1.0, 0.0, &on); /* the end */
    struct stage at = on.at;
    struct yields end = on.end;
    to->sigma[k] += size;
    to->d[k] = at.d;
    to->u[k] = at.u;
    to->press[k] = end.press;
    to->press_moment[k] = end.press_moment;
    to->lasts[1][k] = lasts_at(laws, m->give[k], step, &at);
    to->turns[1][k] = laws.hold ? at.normal : at.u;
    to->holds[1][k] = 1.0;
    if (!laws.hold) return;
    at.s = size == 0.0 ? start.s : at.s; /* a slider's stretch is scaled to its limit: once more would be another bit */
    put(to->v, k, at.v);
    put(to->q, k, at.q);
    put(to->s, k, at.s);
    put(to->rub, k, end.rub);
    put(to->rub_moment, k, end.rub_moment);
    put(to->deep, k, end.deep);
    to->rubbed[k] = end.rubbed;
    to->slides[k] = at.slides;
    to->holds[1][k] = holds_at(laws, &lane, m, k, step, &at);
}

/* ---- before the step ---- */

/* The rate at which the contact damps at its start, and the steps that Runge and Kutta's method needs for its
 * stiffness: a quarter of 1/w at most, with which a contact errs by 1e-5 of its speed. `asked` > 0: so many times as
 * many. Odd are contacts that overlap still after their end. `deepens` 0: as if it got no deeper than it is; returns 1
 * where it may. */
static SCREE_INLINE double rate_lane(struct smooth_laws laws, const struct scree_rule *rule, double slope, double step,
                                     int asked, int deepens, int k, struct course *c, struct lane_constants *m) {
    struct smooth_lane lane = lane_of(rule, m, k);
    double d = (c->d[k] > 0.0 ? c->d[k] : 0.0) + SCREE_NO_SPEED, u = c->u[k], way = d + step * fabs(u), deep = d;
    struct scree_normal_force f = laws.press(lane.normal, lane.normal_pair, scree_pressed(d, u, 0.0, 0.0)), g = f;
    double force = f.elastic + f.damping * u, rate = f.damping * m->give[k];
    /* It gets as deep as the step takes it, or as far as its speed can press a spring between linear and Hertz's: no
     * deeper than it is if that is more than it can press along all of its way with the force that it has now. */
    double can = 1.25 * u * u, more = ((u > 0.0) & (way * can > d * d * (m->give[k] * f.elastic))) ? 1.0 : 0.0;
    if (deepens) {
        double most = laws.press(lane.normal, lane.normal_pair, scree_pressed(way, u, 0.0, 0.0)).elastic;
        double needs = m->give[k] * most * way + SCREE_NO_SPEED, pressed = needs > can ? way * sqrt(can / needs) : way;
        deep = ((more > 0.0) & (pressed > d)) ? pressed : d;
        g = laws.press(lane.normal, lane.normal_pair, scree_pressed(deep, u, 0.0, 0.0));
    }
    double damped = g.damping * m->give[k], stiff = m->give[k] * 1.5 * fabs(g.elastic) / deep;
    if (laws.hold) {
        double steep = slope * (force > 0.0 ? force : 0.0) + laws.damping(lane.friction, lane.friction_pair, d);
        double across = 2.0 * m->give_aside[k] * steep;
        rate = across > rate ? across : rate;
        double spring = m->give_aside[k] * laws.stiffness(lane.friction, lane.friction_pair, deep);
        stiff = spring > stiff ? spring : stiff;
        double drag = slope * fabs(g.elastic) + laws.damping(lane.friction, lane.friction_pair, deep);
        damped = m->give_aside[k] * drag > damped ? m->give_aside[k] * drag : damped;
    }
    m->rate[k] = rate;
    stiff = damped * damped > stiff ? damped * damped : stiff;
    double steps = 4.0 * step * sqrt(stiff);
    double times = asked > 0 ? (double)asked : 1.0;
    steps = steps < 63.0 ? steps : 63.0; /* NaN too */
    m->grid[k] = step / ((double)(1 + (int)steps) * times);
    c->odd[k] = 0.0;
    m->pushes[0][k] = m->pushes[1][k] = 0.0;
    if (!laws.cut) return more;
    double later = d + step * u, deeper = later > 0.0 ? later : 0.0;
    struct scree_normal_force then = laws.press(lane.normal, lane.normal_pair, scree_pressed(deeper, u, 0.0, 0.0));
    double softness = 1.5 * then.elastic / (deeper + SCREE_NO_SPEED);
    m->pushes[0][k] = then.elastic + then.damping * u;
    m->pushes[1][k] = step * (then.damping + step * softness);
    c->odd[k] = c->d[k] > 0.0 && !(force > 0.0) ? 1.0 : 0.0;
    return more;
}

/* Energy in the normal direction that a contact gives back, J. */
static SCREE_INLINE double stored_at(struct smooth_laws laws, const struct scree_rule *rule,
                                     const struct lane_constants *m, int k, double overlap, double closing) {
    struct smooth_lane lane = lane_of(rule, m, k);
    double stored = laws.stored(lane.normal, lane.normal_pair, scree_pressed(overlap, closing, 0.0, 0.0));
    return overlap > 0.0 ? stored : 0.0;
}

#endif
