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
typedef struct scree_tangential rub_law(const struct scree_law_constants *law, struct scree_pair_constants pair,
                                        struct scree_sliding at);
typedef double stored_law(const struct scree_law_constants *law, struct scree_pair_constants pair,
                          struct scree_pressing at);
typedef int bends_law(const struct scree_law_constants *law, struct scree_pair_constants pair,
                      struct scree_pressing from, struct scree_pressing to);
typedef double at_overlap(const struct scree_law_constants *law, struct scree_pair_constants pair, double overlap);

/* The laws of a loop: constants where it is called, so that each is a loop of its own. What a normal law makes of a
 * step doesn't depend on friction, so each of the two has its loop, friction's behind the other one's: every normal law
 * goes with every friction law, and none is compiled for a pair of them. */
struct smooth_normal {
    press_law *press;
    stored_law *stored;
    bends_law *bends; /* NULL: one formula holds, but for a turn */
    int cut;
    int memory;
    int raises; /* takes a power whose exponent is a parameter */
    int none;   /* it isn't smooth */
};

/* Friction is a slider behind a spring and a dashpot (slider.h), or a force that remembers nothing. */
struct smooth_friction {
    rub_law *rub; /* NULL: it is a slider */
    hold_law *hold;
    at_overlap *stiffness, *damping;
    int bare;        /* the spring has no dashpot beside it */
    int all_stick;   /* no slider of the loop slides: how one does isn't reckoned */
    int in_force;    /* what is kept is the force of the spring; */
    double rescales; /* 1: it falls with the stiffness while the overlap does */
    int none;
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
    double v[3][SCREE_LANES], q[3][SCREE_LANES], s[3][SCREE_LANES]; /* m/s; 1/s; friction's memory, m or N */
    double slides[SCREE_LANES];
    double kept[2][SCREE_LANES];                          /* what the normal law remembers */
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
    double turns[2][SCREE_LANES]; /* the closing speed, m/s: approach and parting change where it passes zero */
    double pulls[2][SCREE_LANES]; /* until the contact pulls, where friction ends, N */
    double bends[SCREE_LANES];    /* 1: the normal law changes its formula on the way */
    double kept[2][SCREE_LANES];  /* what it remembers at the end */
    double d[SCREE_LANES], u[SCREE_LANES], v[3][SCREE_LANES], q[3][SCREE_LANES], s[3][SCREE_LANES];
    double slides[SCREE_LANES];
    double press[SCREE_LANES], press_moment[SCREE_LANES];
    double rub[3][SCREE_LANES], rub_moment[3][SCREE_LANES], deep[3][SCREE_LANES];
    double rubbed[SCREE_LANES];
    double coarse[SCREE_LANES]; /* 1: too long a step */
    double dips[SCREE_LANES];   /* 1: a slider may have changed twice */
    /* The clock of a root, t = offset + span sigma^p: where it stands, and its step. */
    double offset[SCREE_LANES], span[SCREE_LANES], sigma[SCREE_LANES], size[SCREE_LANES];
};

/* Columns of the instants of a step: its four stages and its end, then one soon behind its begin and one shortly before
 * its end; as the normal law makes them, which is done before friction is. */
enum { STAGES = 5, SOON = STAGES, INSTANTS = STAGES + 2 };
struct squeezes {
    double d[INSTANTS][SCREE_LANES], u[INSTANTS][SCREE_LANES], normal[INSTANTS][SCREE_LANES]; /* m, m/s, N */
    /* Of a step by the clock of a root: since its begin, s, and the time that its step would take at the pace of the
     * stage, s. */
    double since[STAGES][SCREE_LANES], along[STAGES][SCREE_LANES];
};

/* Before the step: what of the normal law friction adds to. */
struct softness {
    double may_deepen[SCREE_LANES];                 /* 1: it may get deeper than it is */
    double d[SCREE_LANES], deep[SCREE_LANES];       /* overlap at the start, and at most, m */
    double force[SCREE_LANES], most[SCREE_LANES];   /* at the start, and at most but for damping, N */
    double stiff[SCREE_LANES], damped[SCREE_LANES]; /* 1/s^2, 1/s */
};

/* ---- along the normal ---- */

/* What the normal law remembers, of course or step: a piece of a step has the memory of its begin all along. */
typedef double (*kept_columns)[SCREE_LANES];

/* An instant inside the step; what the law would remember of it. */
struct squeeze {
    double d, u, normal, damping, first, second;
};

static SCREE_INLINE struct scree_pair_constants normal_pair_of(const struct lane_constants *m, int k) {
    return (struct scree_pair_constants){{m->pair[0][k], m->pair[1][k], m->pair[2][k], m->pair[3][k]}};
}

static SCREE_INLINE struct scree_pressing pressing_at(struct smooth_normal laws, const kept_columns kept, int k,
                                                      double d, double u) {
    if (!laws.memory) return scree_pressed(d, u, 0.0, 0.0);
    return scree_pressed(d, u, kept[0][k], kept[1][k]);
}

static SCREE_INLINE struct scree_normal_force press_at(struct smooth_normal laws, const struct scree_rule *rule,
                                                       const struct lane_constants *m, const kept_columns kept, int k,
                                                       double d, double u) {
    return laws.press(&rule->normal_constants, normal_pair_of(m, k), pressing_at(laws, kept, k, d, u));
}

static SCREE_INLINE struct squeeze squeeze_at(struct smooth_normal laws, const struct scree_rule *rule,
                                              const struct lane_constants *m, const kept_columns kept, int k, double d,
                                              double u) {
    struct scree_normal_force f = press_at(laws, rule, m, kept, k, d, u);
    return (struct squeeze){d, u, f.elastic + f.damping * u, f.damping, f.first, f.second};
}

/* Where the rates of `at` lead in that time from the first stage. */
static SCREE_INLINE struct squeeze squeeze_on(struct smooth_normal laws, const struct scree_rule *rule,
                                              const struct lane_constants *m, const kept_columns kept, int k,
                                              const struct squeeze *first, const struct squeeze *at, double time) {
    double d = first->d + time * at->u, u = first->u + time * (m->closing[k] - m->give[k] * at->normal);
    return squeeze_at(laws, rule, m, kept, k, d, u);
}

static SCREE_INLINE void put_squeeze(const struct squeeze *at, int i, int k, struct squeezes *to) {
    to->d[i][k] = at->d;
    to->u[i][k] = at->u;
    to->normal[i][k] = at->normal;
}

/* Positive while the contact lasts, zero where it ends. Where the law is cut, the force over its damping rather than
 * the force: k d/c + u has no root of d in it. */
static SCREE_INLINE double lasts_at(int cut, double give, double step, const struct squeeze *at) {
    if (!cut) return at->d;
    double beyond = at->u < 0.0 ? at->u : at->d / step, within = at->normal / (at->damping + 1e-6 / (give * step));
    return at->d > 0.0 ? within : beyond;
}

/* From an instant to the one that is asked for once more, s. */
static SCREE_INLINE double soon_after(int soon, double step) {
    return soon == SOON ? SCREE_SO_SOON * step : -SCREE_SO_SOON * step;
}

static SCREE_INLINE void squeeze_soon(struct smooth_normal laws, const struct scree_rule *rule,
                                      const struct lane_constants *m, int k, double step, struct course *c, int soon,
                                      struct squeezes *by) {
    int i = soon == SOON ? 0 : STAGES - 1;
    struct squeeze at = {.d = by->d[i][k], .u = by->u[i][k], .normal = by->normal[i][k]};
    struct squeeze next = squeeze_on(laws, rule, m, c->kept, k, &at, &at, soon_after(soon, step));
    put_squeeze(&next, soon, k, by);
}

/* Where a lane has come to, `at`, from the state of `c`: what the law remembers, and whether it has changed its formula
 * on the way; where nothing moves to speak of, no force changes either. */
static SCREE_INLINE void remember_squeeze(struct smooth_normal laws, const struct scree_rule *rule,
                                          const struct lane_constants *m, int k, struct course *c,
                                          const struct squeeze *at, struct rk_step *to) {
    double d = c->d[k];
    to->bends[k] = 0.0;
    if (laws.bends) {
        int bends = laws.bends(&rule->normal_constants, normal_pair_of(m, k), pressing_at(laws, c->kept, k, d, c->u[k]),
                               pressing_at(laws, c->kept, k, at->d, at->u));
        to->bends[k] = (bends & (fabs(at->d - d) > 1e-12 * d)) ? 1.0 : 0.0;
    }
    if (!laws.memory) return;
    to->kept[0][k] = at->first;
    to->kept[1][k] = at->second;
}

/* One lane goes on by its time. */
static SCREE_INLINE void squeeze_step(struct smooth_normal laws, const struct scree_rule *rule,
                                      const struct lane_constants *m, int k, double step, struct course *c,
                                      struct rk_step *to, struct squeezes *by) {
    double time = to->time[k], share = time * (1.0 / 6.0);
    struct squeeze first = squeeze_at(laws, rule, m, c->kept, k, c->d[k], c->u[k]);
    struct squeeze second = squeeze_on(laws, rule, m, c->kept, k, &first, &first, 0.5 * time);
    struct squeeze third = squeeze_on(laws, rule, m, c->kept, k, &first, &second, 0.5 * time);
    struct squeeze fourth = squeeze_on(laws, rule, m, c->kept, k, &first, &third, time);
    double inner = second.normal + third.normal;
    double impulse = share * ((first.normal + fourth.normal) + 2.0 * inner);
    double moment = share * time * (first.normal + inner);
    double u = first.u + (time * m->closing[k] - m->give[k] * impulse);
    double d = first.d + (time * first.u + (0.5 * time * time * m->closing[k] - m->give[k] * moment));
    struct squeeze end = squeeze_at(laws, rule, m, c->kept, k, d, u);
    remember_squeeze(laws, rule, m, k, c, &end, to);
    to->press[k] = impulse;
    to->press_moment[k] = moment;
    to->d[k] = d;
    to->u[k] = u;
    to->lasts[0][k] = lasts_at(laws.cut, m->give[k], step, &first);
    to->lasts[1][k] = lasts_at(laws.cut, m->give[k], step, &end);
    to->turns[0][k] = first.u;
    to->turns[1][k] = u;
    put_squeeze(&first, 0, k, by);
    put_squeeze(&second, 1, k, by);
    put_squeeze(&third, 2, k, by);
    put_squeeze(&fourth, 3, k, by);
    put_squeeze(&end, 4, k, by);
}

/* ---- across it ---- */

/* An instant inside the step. */
struct stage {
    double d, u, normal;
    struct vec v, q, s, force;
    struct vec slip; /* v + (d - start) q */
    double slides;
    double stiffness, drag; /* of spring and dashpot, N/m, N s/m */
    double limit, holds;    /* with which the slider slides, and what it holds, N */
    double stretched;       /* of a spring whose force is kept: 1: in this step it is its stretch that goes on */
};

static SCREE_INLINE struct scree_pair_constants friction_pair_of(const struct lane_constants *m, int k) {
    return (struct scree_pair_constants){
        {m->pair[SCREE_PAIR_FRICTION][k], m->pair[SCREE_PAIR_FRICTION + 1][k], 0.0, 0.0}};
}

/* A dashpot that still pushes apart what doesn't touch any more, in a step beyond its end, bears no friction. */
static SCREE_INLINE struct scree_sliding sliding_at(const struct stage *at) {
    return (struct scree_sliding){.normal = ((at->normal > 0.0) & (at->d >= 0.0)) ? at->normal : 0.0,
                                  .overlap = at->d,
                                  .closing = at->u,
                                  .velocity = at->slip,
                                  .stretch = at->s,
                                  .sliding = at->slides};
}

/* What a slider is made of at a stage whose overlap and normal force are set. */
static SCREE_INLINE void brace_stage(struct smooth_friction laws, const struct scree_rule *rule,
                                     const struct lane_constants *m, int k, struct stage *at) {
    const struct scree_law_constants *law = &rule->friction_constants;
    struct scree_pair_constants pair = friction_pair_of(m, k);
    struct scree_hold hold = laws.hold(law, sliding_at(at));
    at->stiffness = laws.stiffness(law, pair, at->d);
    at->drag = laws.bare ? 0.0 : laws.damping(law, pair, at->d);
    at->limit = hold.slides;
    at->holds = hold.holds;
}

/* The force that remembers nothing. */
static SCREE_INLINE void rub_stage(struct smooth_friction laws, const struct scree_rule *rule,
                                   const struct lane_constants *m, int k, struct stage *at) {
    at->force = laws.rub(&rule->friction_constants, friction_pair_of(m, k), sliding_at(at)).force;
    at->stiffness = at->drag = at->limit = at->holds = 0.0;
}

static SCREE_INLINE struct stage stage_of(const struct squeezes *by, int i, int k) {
    return (struct stage){.d = by->d[i][k], .u = by->u[i][k], .normal = by->normal[i][k]};
}

/* What spring and dashpot would bear if the slider held, N. */
static SCREE_INLINE struct vec trial_at(const struct stage *at) {
    return vec_axpy(vec_scale(at->stiffness, at->s), at->drag, at->slip);
}

/* What goes on through a step is the stretch, m, or, of a spring whose force is kept and doesn't fall with the
 * stiffness, that force, N: so much of it to a stretch of 1 m. */
static SCREE_INLINE double unit_at(struct smooth_friction laws, const struct stage *at) {
    if (!laws.in_force) return 1.0;
    return at->stretched > 0.0 ? 1.0 : at->stiffness;
}

/* Between two stages: stretches that carry one force, the later over the earlier. */
static SCREE_INLINE double share_of(struct smooth_friction laws, double before, const struct stage *at) {
    return laws.in_force ? before / unit_at(laws, at) : 1.0;
}

/* How a spring goes through the step of `time` that begins here: where the overlap is about to fall, by its stretch. */
static SCREE_INLINE double stretched_at(struct smooth_friction laws, const struct lane_constants *m, int k, double time,
                                        const struct stage *at) {
    double later = at->u + 0.5 * time * (m->closing[k] - m->give[k] * at->normal);
    return later < 0.0 ? laws.rescales : 0.0;
}

/* Friction at the first stage of a step of `time`, whose memory is known. A slider holds or slides whatever comes,
 * until the step ends where it shouldn't any more; a bare spring that slides has the stretch of its force. */
static SCREE_INLINE void hold_stage(struct smooth_friction laws, const struct scree_rule *rule,
                                    const struct lane_constants *m, int k, double time, struct stage *at) {
    if (laws.rub) {
        rub_stage(laws, rule, m, k, at);
        return;
    }
    brace_stage(laws, rule, m, k, at);
    if (laws.in_force) {
        at->stretched = stretched_at(laws, m, k, time, at);
        at->s = vec_scale(1.0 / at->stiffness, at->s);
    }
    struct vec trial = trial_at(at);
    at->force = vec_scale(-1.0, trial);
    if (laws.all_stick) return;
    double scale = at->slides > 0.0 ? at->limit / (vec_norm(trial) + SCREE_NO_SPEED) : 1.0;
    at->force = vec_scale(-scale, trial);
    if (laws.bare) at->s = vec_scale(scale, at->s);
}

/* Friction at a stage `time` after the first one, where a slider that holds has kept so much. */
static SCREE_INLINE void grip_stage(struct smooth_friction laws, const struct scree_rule *rule,
                                    const struct lane_constants *m, int k, const struct stage *first, double time,
                                    struct stage *at) {
    if (laws.rub) {
        rub_stage(laws, rule, m, k, at);
        return;
    }
    brace_stage(laws, rule, m, k, at);
    at->stretched = first->stretched;
    if (laws.in_force) at->s = vec_scale(1.0 / unit_at(laws, at), at->s);
    at->force = vec_scale(-1.0, trial_at(at));
    if (laws.all_stick) return;
    double share = share_of(laws, unit_at(laws, first), at);
    struct scree_drawn before = {.k = first->stiffness,
                                 .drag = first->drag,
                                 .limit = first->limit,
                                 .slip = first->slip,
                                 .carries = vec_scale(-1.0, first->force),
                                 .stretch = vec_scale(share, first->s)};
    struct scree_drawn drawn = {.k = at->stiffness, .drag = at->drag, .limit = at->limit, .slip = at->slip};
    scree_draw_on(&before, share, time, laws.bare, &drawn);
    at->s = at->slides > 0.0 ? drawn.stretch : at->s;
    at->force = at->slides > 0.0 ? vec_scale(-1.0, drawn.carries) : at->force;
}

static SCREE_INLINE struct vec vec_middle(struct vec a, struct vec b) { return vec_scale(0.5, vec_add(a, b)); }

/* The stretch behind a dashpot at the end of a step, reached from the first stage in one go, once more by way of its
 * middle: what both err by goes like the third power of their parts (Richardson's extrapolation). The middle is that of
 * the two inner stages, either of which errs by as much to its own side. A step in which the stretch relaxes to less
 * than e^-4 is too long for that: from e^-8 on it would be led past where it relaxes to, and a slider that has just
 * broken loose would hold again. */
static SCREE_INLINE void redraw(struct smooth_friction laws, const struct stage *second, const struct stage *third,
                                double early, double time, struct stage *at) {
    if (laws.rub || laws.bare || laws.all_stick) return;
    double stiffness = 0.5 * (second->stiffness + third->stiffness);
    double share = share_of(laws, at->stretched > 0.0 ? 1.0 : stiffness, at);
    struct scree_drawn before = {.k = stiffness,
                                 .drag = 0.5 * (second->drag + third->drag),
                                 .limit = 0.5 * (second->limit + third->limit),
                                 .slip = vec_middle(second->slip, third->slip),
                                 .carries = vec_scale(-1.0, vec_middle(second->force, third->force)),
                                 .stretch = vec_scale(share, vec_middle(second->s, third->s))};
    struct scree_drawn drawn = {.k = at->stiffness, .drag = at->drag, .limit = at->limit, .slip = at->slip};
    double late = time - early, parts = early * early * early + late * late * late;
    scree_draw_on(&before, share, late, 0, &drawn);
    double more = parts / (time * time * time - parts + SCREE_NO_SPEED); /* s^3, too */
    more = time * at->stiffness < 4.0 * at->drag ? more : 0.0;
    struct vec better = vec_axpy(drawn.stretch, more, vec_sub(drawn.stretch, at->s));
    at->s = at->slides > 0.0 ? better : at->s;
}

/* What a spring has kept, of one whose force is kept as it goes through the step. */
static SCREE_INLINE struct vec kept_at(struct smooth_friction laws, const struct stage *at) {
    return vec_scale(unit_at(laws, at), at->s);
}

/* How that grows, m/s or N/s. */
static SCREE_INLINE struct vec grows_at(struct smooth_friction laws, const struct stage *at) {
    return vec_scale(unit_at(laws, at), at->slip);
}

/* What the spring keeps beyond the step. */
static SCREE_INLINE struct vec keeps_at(struct smooth_friction laws, const struct stage *at) {
    return laws.in_force ? vec_scale(at->stiffness, at->s) : at->s;
}

/* Where the rates of `at` lead in that time from the first stage. */
static SCREE_INLINE void rub_on(struct smooth_friction laws, const struct scree_rule *rule,
                                const struct lane_constants *m, int k, const struct stage *first,
                                const struct stage *at, double time, struct stage *to) {
    struct vec aside = vec(m->aside[0][k], m->aside[1][k], m->aside[2][k]);
    double shorter = 0.5 * (at->d - m->start[k]);
    to->v = vec_axpy(first->v, time, vec_axpy(aside, m->give_aside[k] - shorter * m->lever[0][k], at->force));
    to->q = vec_axpy(first->q, -0.5 * time * (m->lever[0][k] - shorter * m->lever[1][k]), at->force);
    to->slip = vec_axpy(to->v, to->d - m->start[k], to->q);
    to->s = vec_axpy(kept_at(laws, first), time, grows_at(laws, at));
    to->slides = first->slides;
    grip_stage(laws, rule, m, k, first, time, to);
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

/* What a slider that holds could still bear, N; by how much more (N) one that slides would have to bear if it held; the
 * force of a bare spring can't be more than what it slides with: by how much faster (m/s) it is dragged than the
 * stretch grows that its load, `soon`, allows. */
static SCREE_INLINE double holds_at(struct smooth_friction laws, const struct scree_rule *rule,
                                    const struct lane_constants *m, int k, double step, const struct stage *at,
                                    const struct squeezes *by, int soon) {
    if (laws.rub) return 1.0;
    double bears = vec_norm(trial_at(at)), left = at->holds - bears;
    if (laws.all_stick) return left;
    if (!laws.bare) return at->slides > 0.0 ? bears - at->limit : left;
    struct stage next = stage_of(by, soon, k);
    brace_stage(laws, rule, m, k, &next);
    double unit = next.stiffness;
    if (laws.in_force) unit = stretched_at(laws, m, k, 0.0, at) > 0.0 ? next.stiffness : at->stiffness;
    double growth = (next.limit / unit - at->limit / at->stiffness) / soon_after(soon, step);
    struct vec towards = vec_axpy(at->s, 1e-12 * step, at->slip); /* nothing is stretched yet at the very begin */
    double dragged = vec_dot(at->slip, towards) / (vec_norm(towards) + SCREE_NO_SPEED);
    return at->slides > 0.0 ? dragged - growth : left;
}

/* As holds_at, but for a bare spring that slides, in squares. */
static SCREE_INLINE double holds_squared(struct smooth_friction laws, const struct stage *at) {
    if (laws.all_stick) return at->holds * at->holds - vec_norm2(at->force);
    return scree_left(laws.bare, at->slides, vec_norm2(trial_at(at)), at->holds, at->limit);
}

/* 1: a slider may have changed twice on the way from the first stage to the end. */
static SCREE_INLINE double dips_at(struct smooth_friction laws, const struct stage *first, const struct stage *second,
                                   const struct stage *third, const struct stage *end) {
    if (laws.rub) return 0.0;
    double middle = 0.5 * (holds_squared(laws, second) + holds_squared(laws, third));
    return scree_dips(holds_squared(laws, first), middle, holds_squared(laws, end), first->limit);
}

/* What friction makes of the same step. */
static SCREE_INLINE void rub_step(struct smooth_friction laws, const struct scree_rule *rule,
                                  const struct lane_constants *m, int k, double step, struct course *c,
                                  struct rk_step *to, const struct squeezes *by) {
    double time = to->time[k], share = time * (1.0 / 6.0);
    struct stage first = stage_of(by, 0, k), second = stage_of(by, 1, k), third = stage_of(by, 2, k);
    struct stage fourth = stage_of(by, 3, k), end = stage_of(by, 4, k);
    first.v = get(c->v, k);
    first.q = get(c->q, k);
    first.slip = vec_axpy(first.v, first.d - m->start[k], first.q);
    first.s = get(c->s, k);
    first.slides = end.slides = c->slides[k];
    hold_stage(laws, rule, m, k, time, &first);
    rub_on(laws, rule, m, k, &first, &first, 0.5 * time, &second);
    rub_on(laws, rule, m, k, &first, &second, 0.5 * time, &third);
    rub_on(laws, rule, m, k, &first, &third, time, &fourth);
    struct vec between = vec_add(second.force, third.force);
    struct vec rub = vec_scale(share, vec_axpy(vec_add(first.force, fourth.force), 2.0, between));
    /* The impulse times the depth: levers are half of it shorter. */
    struct vec inner_deep =
        vec_axpy(vec_scale(second.d - m->start[k], second.force), third.d - m->start[k], third.force);
    struct vec outer_deep =
        vec_axpy(vec_scale(first.d - m->start[k], first.force), fourth.d - m->start[k], fourth.force);
    struct vec deep = vec_scale(share, vec_axpy(outer_deep, 2.0, inner_deep));
    struct vec aside = vec(m->aside[0][k], m->aside[1][k], m->aside[2][k]);
    end.v = vec_axpy(vec_axpy(first.v, time, aside), m->give_aside[k], rub);
    end.v = vec_axpy(end.v, -0.5 * m->lever[0][k], deep);
    end.q = vec_axpy(first.q, -0.5 * m->lever[0][k], rub);
    end.q = vec_axpy(end.q, 0.25 * m->lever[1][k], deep);
    end.slip = vec_axpy(end.v, end.d - m->start[k], end.q);
    struct vec inner = vec_add(grows_at(laws, &second), grows_at(laws, &third));
    struct vec grows = vec_axpy(vec_add(grows_at(laws, &first), grows_at(laws, &fourth)), 2.0, inner);
    end.s = vec_axpy(kept_at(laws, &first), share, grows);
    grip_stage(laws, rule, m, k, &first, time, &end);
    redraw(laws, &second, &third, 0.5 * time, time, &end);
    put(to->v, k, end.v);
    put(to->q, k, end.q);
    put(to->s, k, keeps_at(laws, &end));
    put(to->deep, k, deep);
    put(to->rub, k, rub);
    put(to->rub_moment, k, vec_scale(share * time, vec_add(first.force, between)));
    double outer_rubbing = vec_dot(first.force, first.slip) + vec_dot(fourth.force, fourth.slip);
    double inner_rubbing = vec_dot(second.force, second.slip) + vec_dot(third.force, third.slip);
    to->rubbed[k] = -share * (outer_rubbing + 2.0 * inner_rubbing);
    to->slides[k] = end.slides;
    to->pulls[0][k] = first.normal;
    to->pulls[1][k] = end.normal;
    double nearly = scree_nearly(laws.bare, laws.all_stick ? 0.0 : first.slides, first.limit, first.stiffness, step);
    to->holds[0][k] = holds_at(laws, rule, m, k, step, &first, by, SOON) + nearly;
    to->holds[1][k] = holds_at(laws, rule, m, k, step, &end, by, SOON + 1);
    to->coarse[k] = coarse_at(m, k, &first, &second, &third, time);
    to->dips[k] = dips_at(laws, &first, &second, &third, &end);
}

/* ---- where the force sets in as a root of the overlap ---- */

/* What a contact has yielded along the normal since a time: impulse, N s, and its integral, N s^2. */
struct pressed {
    double press, moment;
};

/* Behind a begin or before an end time goes like sigma^p, so that force and motion are smooth in sigma; impulses and
 * their moments themselves are the states. One step in sigma; of size 0: nothing. A stage at so much of it;
 * `root`: p, 2 or 4. */
static SCREE_INLINE struct squeeze squeeze_tick(struct smooth_normal laws, const struct scree_rule *rule,
                                                const struct lane_constants *m, int k, double root,
                                                const struct course *c, struct rk_step *to, double node,
                                                struct pressed now, int i, struct squeezes *by) {
    double cubic = root > 3.0 ? 1.0 : 0.0, sigma = to->sigma[k] + node * to->size[k];
    double lower = (cubic * (sigma * sigma) + (1.0 - cubic)) * sigma; /* sigma^(p-1) */
    double t = to->offset[k] + to->span[k] * lower * sigma;
    double u = c->u[k] + (t * m->closing[k] - m->give[k] * now.press);
    double d = c->d[k] + (t * c->u[k] + (0.5 * t * t * m->closing[k] - m->give[k] * now.moment));
    struct squeeze at = squeeze_at(laws, rule, m, to->kept, k, d, u);
    by->since[i][k] = t;
    by->along[i][k] = to->size[k] * to->span[k] * root * lower;
    put_squeeze(&at, i, k, by);
    return at;
}

/* What follows from the rates at a stage, `now`, by a share of the step. */
static SCREE_INLINE struct pressed press_on(struct pressed from, double share, const struct squeeze *at,
                                            struct pressed now) {
    return (struct pressed){from.press + share * at->normal, from.moment + share * now.press};
}

static SCREE_INLINE void squeeze_by_clock(struct smooth_normal laws, const struct scree_rule *rule,
                                          const struct lane_constants *m, int k, double step, double root,
                                          struct course *c, struct rk_step *to, struct squeezes *by) {
    const double sixth = 1.0 / 6.0, third = 2.0 / 6.0;
    struct pressed start = {to->press[k], to->press_moment[k]}, end, first, second, last;
    struct squeeze at = squeeze_tick(laws, rule, m, k, root, c, to, 0.0, start, 0, by);
    end = press_on(start, sixth * by->along[0][k], &at, start);
    first = press_on(start, 0.5 * by->along[0][k], &at, start);
    at = squeeze_tick(laws, rule, m, k, root, c, to, 0.5, first, 1, by);
    end = press_on(end, third * by->along[1][k], &at, first);
    second = press_on(start, 0.5 * by->along[1][k], &at, first);
    at = squeeze_tick(laws, rule, m, k, root, c, to, 0.5, second, 2, by);
    end = press_on(end, third * by->along[2][k], &at, second);
    last = press_on(start, by->along[2][k], &at, second);
    at = squeeze_tick(laws, rule, m, k, root, c, to, 1.0, last, 3, by);
    end = press_on(end, sixth * by->along[3][k], &at, last);
    at = squeeze_tick(laws, rule, m, k, root, c, to, 1.0, end, 4, by);
    remember_squeeze(laws, rule, m, k, c, &at, to);
    to->d[k] = at.d;
    to->u[k] = at.u;
    to->press[k] = end.press;
    to->press_moment[k] = end.moment;
    to->lasts[1][k] = lasts_at(laws.cut, m->give[k], step, &at);
    to->turns[1][k] = at.u;
}

/* What friction has yielded since a time: impulses and their integrals, and where its slider is. */
struct yields {
    double rubbed;
    struct vec rub, rub_moment, deep, s;
};

static SCREE_INLINE struct yields add_yields(struct yields a, double share, const struct yields *rate) {
    a.rubbed += share * rate->rubbed;
    a.rub = vec_axpy(a.rub, share, rate->rub);
    a.rub_moment = vec_axpy(a.rub_moment, share, rate->rub_moment);
    a.deep = vec_axpy(a.deep, share, rate->deep);
    a.s = vec_axpy(a.s, share, rate->s);
    return a;
}

/* A stage of friction, and the rates of what it yields there. `first`: the first stage; NULL: this is it. */
static SCREE_INLINE struct yields rub_tick(struct smooth_friction laws, const struct scree_rule *rule,
                                           const struct lane_constants *m, int k, struct course *c,
                                           const struct yields *so_far, const struct squeezes *by, int i,
                                           const struct stage *first, struct stage *at) {
    *at = stage_of(by, i, k);
    double t = by->since[i][k], lever = m->lever[0][k], deep = at->d - m->start[k];
    struct vec aside = vec(m->aside[0][k], m->aside[1][k], m->aside[2][k]);
    at->v = vec_axpy(vec_axpy(get(c->v, k), t, aside), m->give_aside[k], so_far->rub);
    at->v = vec_axpy(at->v, -0.5 * lever, so_far->deep);
    at->q = vec_axpy(vec_axpy(get(c->q, k), -0.5 * lever, so_far->rub), 0.25 * m->lever[1][k], so_far->deep);
    at->slip = vec_axpy(at->v, deep, at->q);
    at->s = so_far->s;
    at->slides = c->slides[k];
    if (first)
        grip_stage(laws, rule, m, k, first, t - by->since[0][k], at);
    else
        hold_stage(laws, rule, m, k, by->since[STAGES - 1][k] - t, at);
    return (struct yields){-vec_dot(at->force, at->slip), at->force, so_far->rub, vec_scale(deep, at->force),
                           grows_at(laws, at)};
}

static SCREE_INLINE void rub_by_clock(struct smooth_friction laws, const struct scree_rule *rule,
                                      const struct lane_constants *m, int k, double step, struct course *c,
                                      struct rk_step *to, const struct squeezes *by) {
    const double sixth = 1.0 / 6.0, two_sixths = 2.0 / 6.0;
    struct yields start = {to->rubbed[k], get(to->rub, k), get(to->rub_moment, k), get(to->deep, k), get(to->s, k)};
    struct stage first, second, third, at;
    struct yields rate = rub_tick(laws, rule, m, k, c, &start, by, 0, NULL, &first);
    struct vec kept = start.s;
    if (laws.in_force) start.s = kept_at(laws, &first);
    struct yields end = add_yields(start, sixth * by->along[0][k], &rate);
    struct yields now = add_yields(start, 0.5 * by->along[0][k], &rate);
    rate = rub_tick(laws, rule, m, k, c, &now, by, 1, &first, &second);
    end = add_yields(end, two_sixths * by->along[1][k], &rate);
    now = add_yields(start, 0.5 * by->along[1][k], &rate);
    rate = rub_tick(laws, rule, m, k, c, &now, by, 2, &first, &third);
    end = add_yields(end, two_sixths * by->along[2][k], &rate);
    now = add_yields(start, by->along[2][k], &rate);
    rate = rub_tick(laws, rule, m, k, c, &now, by, 3, &first, &at);
    end = add_yields(end, sixth * by->along[3][k], &rate);
    rub_tick(laws, rule, m, k, c, &end, by, 4, &first, &at);
    redraw(laws, &second, &third, by->since[2][k] - by->since[0][k], by->since[4][k] - by->since[0][k], &at);
    put(to->v, k, at.v);
    put(to->q, k, at.q);
    put(to->s, k, to->size[k] == 0.0 ? kept : keeps_at(laws, &at)); /* rounded, and scaled to its limit: not twice */
    put(to->rub, k, end.rub);
    put(to->rub_moment, k, end.rub_moment);
    put(to->deep, k, end.deep);
    double changed = to->holds[1][k] < 0.0 ? 1.0 : 0.0; /* by the end of the piece before */
    to->dips[k] = to->size[k] != 0.0 ? to->dips[k] + changed : to->dips[k];
    to->rubbed[k] = end.rubbed;
    to->slides[k] = at.slides;
    to->pulls[1][k] = at.normal;
    double holds = holds_at(laws, rule, m, k, step, &at, by, SOON + 1);
    to->holds[1][k] = to->size[k] == 0.0 ? to->holds[1][k] : holds; /* likewise */
}

/* ---- before the step ---- */

/* How stiff the normal law is, and the rate at which it damps at the start. It gets as deep as the step takes it, or as
 * far as its speed can press a spring between linear and Hertz's: no deeper than it is if that is more than it can
 * press along all of its way with the force that it has now. `deepens` 0: as if it got no deeper than it is; tells
 * where it may. Odd are contacts that overlap still after their end. */
static SCREE_INLINE void soften(struct smooth_normal laws, const struct scree_rule *rule, double step, int deepens,
                                int k, struct course *c, struct lane_constants *m, struct softness *to) {
    double d = (c->d[k] > 0.0 ? c->d[k] : 0.0) + SCREE_NO_SPEED, u = c->u[k], way = d + step * fabs(u), deep = d;
    struct scree_normal_force f = press_at(laws, rule, m, c->kept, k, d, u), g = f;
    double force = f.elastic + f.damping * u, can = 1.25 * u * u;
    double more = ((u > 0.0) & (way * can > d * d * (m->give[k] * f.elastic))) ? 1.0 : 0.0;
    if (deepens) {
        double most = press_at(laws, rule, m, c->kept, k, way, u).elastic;
        double needs = m->give[k] * most * way + SCREE_NO_SPEED, pressed = needs > can ? way * sqrt(can / needs) : way;
        deep = ((more > 0.0) & (pressed > d)) ? pressed : d;
        g = press_at(laws, rule, m, c->kept, k, deep, u);
    }
    m->rate[k] = f.damping * m->give[k];
    to->d[k] = d;
    to->deep[k] = deep;
    to->force[k] = force;
    to->most[k] = g.elastic;
    to->damped[k] = g.damping * m->give[k];
    to->stiff[k] = m->give[k] * 1.5 * fabs(g.elastic) / deep;
    c->odd[k] = 0.0;
    m->pushes[0][k] = m->pushes[1][k] = 0.0;
    to->may_deepen[k] = more;
    if (!laws.cut) return;
    double later = d + step * u, deeper = later > 0.0 ? later : 0.0;
    struct scree_normal_force then = press_at(laws, rule, m, c->kept, k, deeper, u);
    double softness = 1.5 * then.elastic / (deeper + SCREE_NO_SPEED);
    m->pushes[0][k] = then.elastic + then.damping * u;
    m->pushes[1][k] = step * (then.damping + step * softness);
    c->odd[k] = c->d[k] > 0.0 && !(force > 0.0) ? 1.0 : 0.0;
}

/* The same of friction, which has the slope (s/m): whichever is more. */
static SCREE_INLINE void stiffen(struct smooth_friction laws, const struct scree_rule *rule, double slope, int k,
                                 struct lane_constants *m, struct softness *to) {
    const struct scree_law_constants *law = &rule->friction_constants;
    struct scree_pair_constants pair = friction_pair_of(m, k);
    double force = to->force[k], rate = m->rate[k], stiff = to->stiff[k], damped = to->damped[k];
    double steep = slope * (force > 0.0 ? force : 0.0) + laws.damping(law, pair, to->d[k]);
    double across = 2.0 * m->give_aside[k] * steep;
    double spring = m->give_aside[k] * laws.stiffness(law, pair, to->deep[k]);
    double drag = m->give_aside[k] * (slope * fabs(to->most[k]) + laws.damping(law, pair, to->deep[k]));
    m->rate[k] = across > rate ? across : rate;
    to->stiff[k] = spring > stiff ? spring : stiff;
    to->damped[k] = drag > damped ? drag : damped;
}

/* The steps that Runge and Kutta's method needs: a quarter of 1/w at most, with which a contact errs by 1e-5 of its
 * speed, and so many `pieces` at least; `asked`: so many times as many. */
static SCREE_INLINE void rule_grid(double step, int asked, int pieces, int k, const struct softness *by,
                                   struct lane_constants *m) {
    double stiff = by->stiff[k], damped = by->damped[k];
    stiff = damped * damped > stiff ? damped * damped : stiff;
    double steps = 4.0 * step * sqrt(stiff), least = pieces, times = asked ? least : 1.0;
    steps = steps < 63.0 ? steps : 63.0; /* NaN too */
    steps = (double)(1 + (int)steps) * times;
    m->grid[k] = step / (steps < least ? least : steps);
}

/* Energy in the normal direction that a contact gives back, J. */
static SCREE_INLINE double stored_at(struct smooth_normal laws, const struct scree_rule *rule,
                                     const struct lane_constants *m, const kept_columns kept, int k, double overlap,
                                     double closing) {
    struct scree_pressing at = pressing_at(laws, kept, k, overlap, closing);
    double stored = laws.stored(&rule->normal_constants, normal_pair_of(m, k), at);
    return overlap > 0.0 ? stored : 0.0;
}

/* What the law remembers where a lane is. `meets`: only of those that begin to touch there, which have had no memory;
 * the law is told that there is a touch. */
static SCREE_INLINE void recall(struct smooth_normal laws, const struct scree_rule *rule,
                                const struct lane_constants *m, int meets, int k, struct course *c) {
    double d = c->d[k], u = c->u[k];
    double begins = ((d == 0.0) & (c->rest[k] > 0.0)) ? 1.0 : 0.0, takes = meets ? begins : 1.0;
    struct scree_pressing at = scree_pressed(SCREE_NO_SPEED, u, 0.0, 0.0); /* m, too */
    if (!meets) at = pressing_at(laws, c->kept, k, d, u);
    struct scree_normal_force f = laws.press(&rule->normal_constants, normal_pair_of(m, k), at);
    c->kept[0][k] = takes > 0.0 ? f.first : c->kept[0][k];
    c->kept[1][k] = takes > 0.0 ? f.second : c->kept[1][k];
}

#endif
