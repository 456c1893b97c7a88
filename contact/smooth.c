/* Contacts that go through a step of the pair-impulse method without an event, several at once: both bodies are spheres, or one is
 * frozen, they touch at the start of the step and at its end, nothing begins, ends, turns round or breaks loose in it, and force
 * is smooth all along. What they do then is what within.c does, in numbers instead of matrices: of two spheres
 *
 *   W F = (1/m_a + 1/m_b) F + (l_a^2/I_a + l_b^2/I_b) F_t,    l: from the centre to the contact, F_t: F in the tangent plane.
 *
 * All others are left to within.c. Which they are is decided for each contact by its own numbers, so that no bit depends on its
 * neighbours in the list, on threads or on the processor. Compiled once for each kind of processor, as loop.c is. */
#include "contact/block.h"
#include "contact/law_list.h"
#include "contact/loop.h"

#include <stddef.h>
#include <string.h>

typedef struct scree_normal_force press_law(const struct scree_law_constants *law, struct scree_pair_constants pair,
                                            struct scree_pressing at);
typedef struct scree_tangential rub_law(const struct scree_law_constants *law, struct scree_pair_constants pair,
                                        struct scree_sliding at);
typedef double at_overlap(const struct scree_law_constants *law, struct scree_pair_constants pair, double overlap);

/* The laws of a pass: constants where it is called, so that each pass is a loop of its own. */
struct smooth_laws {
    press_law *press;
    rub_law *rub; /* NULL: no friction */
    at_overlap *stiffness, *damping;
    int cut, root, memory, turns_smoothly;
    int bare; /* friction is a slider behind a bare spring */
};

/* Columns of what stays during a step. */
struct motion {
    double closing[SCREE_LANES];  /* acceleration that isn't the pair's own: closing, m/s^2 */
    double aside[3][SCREE_LANES]; /* and in the tangent plane */
    double give[SCREE_LANES],
        give_aside[SCREE_LANES]; /* acceleration per force, along the normal and across it, 1/kg */
    double rate[SCREE_LANES];    /* of damping, 1/s */
    double pair[SCREE_PAIR_LEVER][SCREE_LANES];
};

/* Columns of what goes on: the state, what the contact has yielded so far (along the normal, and in the tangent plane), and
 * what is to be said of it. */
struct course {
    double d[SCREE_LANES], u[SCREE_LANES];       /* overlap, m; closing speed, m/s */
    double v[3][SCREE_LANES], s[3][SCREE_LANES]; /* tangential velocity of the ball, m/s; friction's memory */
    double slides[SCREE_LANES];
    double press[SCREE_LANES], press_moment[SCREE_LANES];   /* N s, N s^2 */
    double rub[3][SCREE_LANES], rub_moment[3][SCREE_LANES]; /* N s, N s^2 */
    double odd[SCREE_LANES];                                /* 1: there is an event */
    double coarse[SCREE_LANES];                             /* 1: one step of Runge-Kutta isn't enough */
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

/* ---- one step of Runge and Kutta ---- */

/* An instant inside the step. */
struct stage {
    double d, u, normal;
    struct vec v, s, force;
    double slides;
};

static SCREE_INLINE struct scree_sliding sliding_at(const struct stage *at, double normal, double time) {
    return (struct scree_sliding){.normal = normal > 0.0 ? normal : 0.0,
                                  .overlap = at->d,
                                  .closing = at->u,
                                  .half = 0.5 * time,
                                  .velocity = at->v,
                                  .stretch = at->s,
                                  .sliding = at->slides};
}

/* One lane's laws with their constants. */
struct smooth_lane {
    const struct scree_law_constants *normal, *friction;
    struct scree_pair_constants normal_pair, friction_pair;
};

static SCREE_INLINE void press_stage(struct smooth_laws laws, const struct smooth_lane *lane, struct stage *at) {
    struct scree_pressing pressing = {at->d, at->u, 0.0, 0.0};
    struct scree_normal_force f = laws.press(lane->normal, lane->normal_pair, pressing);
    at->normal = f.elastic + f.damping * at->u;
}

/* Friction at a stage, whose own memory is cut to what holds there. */
static SCREE_INLINE void rub_stage(struct smooth_laws laws, const struct smooth_lane *lane, struct stage *at) {
    struct scree_tangential f = laws.rub(lane->friction, lane->friction_pair, sliding_at(at, at->normal, 0.0));
    at->force = f.force;
    if (!laws.memory) return;
    at->s = f.stretch;
    at->slides = f.sliding;
}

/* The memory of friction that was that of `from`, after `time` at the velocity and overlap of `at`. */
static SCREE_INLINE void drag_stage(struct smooth_laws laws, const struct smooth_lane *lane, const struct stage *from,
                                    const struct stage *at, double normal, double time, struct stage *to) {
    if (!laws.memory) return;
    struct scree_sliding sliding = sliding_at(at, laws.bare ? 1e200 : normal, time);
    sliding.stretch = from->s;
    sliding.sliding = laws.bare ? 0.0 : from->slides;
    struct scree_tangential f = laws.rub(lane->friction, lane->friction_pair, sliding);
    to->s = f.stretch;
    to->slides = laws.bare ? from->slides : f.sliding;
}

/* The stage that follows from the rates of `at`. */
static SCREE_INLINE struct stage go_stage(struct smooth_laws laws, const struct smooth_lane *lane, struct motion *m,
                                          int k, const struct stage *first, const struct stage *at, double time) {
    struct stage to = *first;
    to.d = first->d + time * at->u;
    to.u = first->u + time * (m->closing[k] - m->give[k] * at->normal);
    press_stage(laws, lane, &to);
    if (!laws.rub) return to;
    to.v = vec_axpy(first->v, time, vec_axpy(get(m->aside, k), m->give_aside[k], at->force));
    drag_stage(laws, lane, first, at, to.normal, time, &to);
    rub_stage(laws, lane, &to);
    return to;
}

/* What friction remembers at the end, whose overlap and speeds are set. */
static SCREE_INLINE void finish_stage(struct smooth_laws laws, const struct smooth_lane *lane, const struct stage *a,
                                      const struct stage *b, const struct stage *c, const struct stage *d, double time,
                                      struct stage *end) {
    if (!laws.memory) return;
    if (laws.bare) { /* Runge-Kutta's sum, with the stiffness of each stage */
        drag_stage(laws, lane, end, a, 0.0, time / 6.0, end);
        drag_stage(laws, lane, end, b, 0.0, time / 3.0, end);
        drag_stage(laws, lane, end, c, 0.0, time / 3.0, end);
        drag_stage(laws, lane, end, d, 0.0, time / 6.0, end);
        return;
    }
    struct stage mean = *c;
    mean.u = (a->u + 2.0 * (b->u + c->u) + d->u) / 6.0;
    mean.v = vec_scale(1.0 / 6.0, vec_axpy(vec_add(a->v, d->v), 2.0, vec_add(b->v, c->v)));
    drag_stage(laws, lane, a, &mean, c->normal, time, end);
}

/* Whether one step of Runge-Kutta isn't enough for 1e-7 of the speed of the contact: an oscillation of angular frequency w errs by about
 * (w h)^3/60 times the change of acceleration x h from the first stage to the second. What slides keeps its two: its memory is of lower order. */
static SCREE_INLINE double coarse_at(struct smooth_laws laws, const struct smooth_lane *lane, struct motion *m, int k,
                                     const struct stage *a, const struct stage *b, const struct stage *c,
                                     const struct stage *d, const struct stage *end, double time) {
    const double tolerance = 60.0 * 1e-7;
    double damped = m->rate[k] * time, deep = a->d + SCREE_NO_SPEED;
    double stiff = time * time * (m->give[k] * 1.5 * fabs(a->normal) / deep);
    double across = time * time * m->give_aside[k] * laws.stiffness(lane->friction, lane->friction_pair, a->d);
    stiff = across > stiff ? across : stiff;
    stiff = damped * damped > stiff ? damped * damped : stiff;
    double first = time * m->give[k] * (b->normal - a->normal), then = time * m->give[k] * (c->normal - b->normal);
    double change = first * first + then * then +
                    time * time * m->give_aside[k] * m->give_aside[k] *
                        (vec_norm2(vec_sub(b->force, a->force)) + vec_norm2(vec_sub(c->force, b->force)));
    double speed = a->u * a->u + vec_norm2(a->v) + a->d * a->d * (stiff / (time * time));
    int fine = stiff * stiff * stiff * change <= tolerance * tolerance * speed;
    double slides = a->slides + b->slides + c->slides + d->slides + end->slides;
    fine &= !(slides > 0.0);
    return fine ? 0.0 : 1.0;
}

/* One lane goes on by `time`; `left` is left after it. */
static SCREE_INLINE void step_lane(struct smooth_laws laws, const struct scree_rule *rule, struct motion *m, int k,
                                   double time, double left, struct course *c) {
    struct smooth_lane lane = {
        .normal = &rule->normal_constants,
        .friction = &rule->friction_constants,
        .normal_pair = {{m->pair[0][k], m->pair[1][k], m->pair[2][k], m->pair[3][k]}},
        .friction_pair = {{m->pair[SCREE_PAIR_FRICTION][k], m->pair[SCREE_PAIR_FRICTION + 1][k], 0.0, 0.0}}};
    struct stage first = {.d = c->d[k], .u = c->u[k]};
    if (laws.rub) {
        first.v = get(c->v, k);
        first.s = get(c->s, k);
        first.slides = c->slides[k];
    }
    double slid = first.slides;
    press_stage(laws, &lane, &first);
    if (laws.rub) rub_stage(laws, &lane, &first);
    struct stage second = go_stage(laws, &lane, m, k, &first, &first, 0.5 * time);
    struct stage third = go_stage(laws, &lane, m, k, &first, &second, 0.5 * time);
    struct stage fourth = go_stage(laws, &lane, m, k, &first, &third, time);
    double inner = second.normal + third.normal, share = time * (1.0 / 6.0);
    double impulse = share * ((first.normal + fourth.normal) + 2.0 * inner);
    double moment = share * time * (first.normal + inner);
    struct stage end = first;
    end.u = first.u + (time * m->closing[k] - m->give[k] * impulse);
    end.d = first.d + (time * first.u + (0.5 * time * time * m->closing[k] - m->give[k] * moment));
    c->press_moment[k] += moment + left * impulse;
    c->press[k] += impulse;
    int odd = !(end.d > 0.0) | !(first.d > 0.0);
    if (!laws.turns_smoothly) odd |= (first.u > 0.0) & (end.u < 0.0) & (first.u * time > 1e-12 * first.d);
    if (laws.cut) odd |= !(first.normal > 0.0);
    if (laws.root >= 2) { /* near a begin or an end, where force isn't smooth */
        double rest = time + left;
        odd |= (first.u > 0.0) & (first.d < 6.0 * rest * first.u);
        if (!laws.cut) odd |= (first.u < 0.0) & (first.d < -7.0 * rest * first.u);
    }
    if (laws.rub) {
        struct vec between = vec_add(second.force, third.force);
        struct vec rub = vec_scale(share, vec_axpy(vec_add(first.force, fourth.force), 2.0, between));
        struct vec rub_moment = vec_scale(share * time, vec_add(first.force, between));
        end.v = vec_add(first.v, vec_axpy(vec_scale(time, get(m->aside, k)), m->give_aside[k], rub));
        finish_stage(laws, &lane, &first, &second, &third, &fourth, time, &end);
        put(c->rub_moment, k, vec_add(get(c->rub_moment, k), vec_axpy(rub_moment, left, rub)));
        put(c->rub, k, vec_add(get(c->rub, k), rub));
        put(c->v, k, end.v);
        put(c->s, k, end.s);
        c->slides[k] = end.slides;
        c->coarse[k] = coarse_at(laws, &lane, m, k, &first, &second, &third, &fourth, &end, time);
    }
    if (laws.cut || laws.bare) press_stage(laws, &lane, &end);
    if (laws.cut) odd |= end.normal < 0.0;
    if (laws.bare) {
        rub_stage(laws, &lane, &end); /* a slider that has held doesn't any more */
        odd |= end.slides > slid;
    }
    c->d[k] = end.d;
    c->u[k] = end.u;
    c->odd[k] = odd ? 1.0 : c->odd[k];
}

/* The rate at which the contact damps at its start. */
static SCREE_INLINE void rate_lane(struct smooth_laws laws, const struct scree_rule *rule, double slope, int k,
                                   struct course *c, struct motion *m) {
    struct scree_pair_constants normal = {{m->pair[0][k], m->pair[1][k], m->pair[2][k], m->pair[3][k]}};
    struct scree_pair_constants friction = {
        {m->pair[SCREE_PAIR_FRICTION][k], m->pair[SCREE_PAIR_FRICTION + 1][k], 0.0, 0.0}};
    double d = c->d[k] > 0.0 ? c->d[k] : 0.0, u = c->u[k];
    struct scree_normal_force f = laws.press(&rule->normal_constants, normal, (struct scree_pressing){d, u, 0.0, 0.0});
    double force = f.elastic + f.damping * u, rate = f.damping * m->give[k];
    if (laws.rub) {
        double steep = slope * (force > 0.0 ? force : 0.0) + laws.damping(&rule->friction_constants, friction, d);
        double across = 2.0 * m->give_aside[k] * steep;
        rate = across > rate ? across : rate;
    }
    m->rate[k] = rate;
}

/* ---- passes ---- */

struct smooth_pass {
    void (*rates)(const struct scree_rule *rule, double slope, int count, struct course *c, struct motion *m);
    void (*step)(const struct scree_rule *rule, struct motion *m, int count, double time, double left,
                 struct course *c);
};

#define SMOOTH_PASS(name, ...)                                                                                         \
    __attribute__((flatten)) static void smooth_rates_##name(const struct scree_rule *rule, double slope, int count,   \
                                                             struct course *c, struct motion *m) {                     \
        _Pragma("omp simd")                                                                                            \
        for (int k = 0; k < padded(count); k++) rate_lane((struct smooth_laws){__VA_ARGS__}, rule, slope, k, c, m);    \
    }                                                                                                                  \
    __attribute__((flatten)) static void smooth_step_##name(const struct scree_rule *rule, struct motion *m,           \
                                                            int count, double time, double left, struct course *c) {   \
        struct scree_rule constants = *rule;                                                                           \
        _Pragma("omp simd")                                                                                            \
        for (int k = 0; k < padded(count); k++)                                                                        \
            step_lane((struct smooth_laws){__VA_ARGS__}, &constants, m, k, time, left, c);                             \
    }

#define SMOOTH_ALONE(word)                                                                                             \
    SMOOTH_PASS(word, .press = normal_##word##_force, .cut = scree_normal_##word.cut,                                  \
                .root = scree_normal_##word.root, .turns_smoothly = scree_normal_##word.turns_smoothly)
SCREE_NORMAL_LAWS(SMOOTH_ALONE)

/* Laws that go together get a pass; of others every contact is left to within.c. */
#define SMOOTH_PAIRS(PAIR)                                                                                             \
    PAIR(linear, coulomb)                                                                                              \
    PAIR(linear_cut, coulomb)                                                                                          \
    PAIR(hertz, mindlin)                                                                                               \
    PAIR(tsuji, mindlin)                                                                                               \
    PAIR(tsuji_cut, mindlin)
#define LARGER_ROOT(one, other) (one > other ? one : other)
#define SMOOTH_TOGETHER(one, other, how, is_bare)                                                                      \
    SMOOTH_PASS(                                                                                                       \
        one##_##other##how, .press = normal_##one##_force, .rub = friction_##other##_force,                            \
        .stiffness = scree_friction_##other.stiffness, .damping = scree_friction_##other.damping,                      \
        .cut = scree_normal_##one.cut, .root = LARGER_ROOT(scree_normal_##one.root, scree_friction_##other.root),      \
        .memory = scree_friction_##other.memory,                                                                       \
        .turns_smoothly = scree_normal_##one.turns_smoothly && !scree_friction_##other.rescaled, .bare = is_bare)
#define SMOOTH_BOTH(one, other) SMOOTH_TOGETHER(one, other, _bare, 1) SMOOTH_TOGETHER(one, other, _damped, 0)
SMOOTH_PAIRS(SMOOTH_BOTH)

#define ENTRY(word) {smooth_rates_##word, smooth_step_##word},
static const struct smooth_pass smooth_alone[] = {SCREE_NORMAL_LAWS(ENTRY)};
#undef ENTRY
#define ENTRY(one, other)                                                                                              \
    {NORMAL_##one,                                                                                                     \
     FRICTION_##other,                                                                                                 \
     {{smooth_rates_##one##_##other##_damped, smooth_step_##one##_##other##_damped},                                   \
      {smooth_rates_##one##_##other##_bare, smooth_step_##one##_##other##_bare}}},
static const struct {
    int normal, friction;
    struct smooth_pass pass[2]; /* with a dashpot; without */
} smooth_pairs[] = {SMOOTH_PAIRS(ENTRY)};
#undef ENTRY

/* NULL: there is none. Whether these frictions have a dashpot is a matter of the law, not of the pair. */
static const struct smooth_pass *smooth_pass_of(const struct scree_rule *rule, const struct scree_batch *batch,
                                                int first) {
    const struct scree_normal_law *normal = scree_normal_laws[rule->normal];
    if (normal->memory || normal->reach || normal->bends) return NULL;
    if (rule->friction < 0) return &smooth_alone[rule->normal];
    const struct scree_friction_law *friction = scree_friction_laws[rule->friction];
    struct scree_pair_constants pair = {
        {scree_pair(batch, SCREE_PAIR_FRICTION, first), scree_pair(batch, SCREE_PAIR_FRICTION + 1, first), 0.0, 0.0}};
    int bare = friction->slider && friction->damping(&rule->friction_constants, pair, 1.0) == 0.0;
    for (size_t k = 0; k < sizeof smooth_pairs / sizeof *smooth_pairs; k++)
        if (smooth_pairs[k].normal == rule->normal && smooth_pairs[k].friction == rule->friction)
            return &smooth_pairs[k].pass[bare];
    return NULL;
}

/* ---- gather ---- */

/* Where contacts are, and what bodies do by themselves (scree_push; differences of ball and host where that is enough). */
struct meeting {
    double later_n[3][SCREE_LANES];                 /* normal in the middle of the step */
    double arm[SCREE_LANES], host_arm[SCREE_LANES]; /* from the centres to the contact at the start, m */
    double later_arm[SCREE_LANES], later_host_arm[SCREE_LANES];
    double last[3][SCREE_LANES], before[3][SCREE_LANES];         /* impulses of the last two steps, N s */
    double along[4][SCREE_LANES], more[4][SCREE_LANES];          /* m/s^2 */
    double ball_turn[4][SCREE_LANES], host_turn[4][SCREE_LANES]; /* rad/s^2; 1/(kg m^2) */
    double ball_more[4][SCREE_LANES], host_more[4][SCREE_LANES];
};

#ifdef __AVX__
static inline void fetch_pushes(const struct scree_push *push, const struct scree_contact *const contact[4], int lane,
                                int turns, struct meeting *to) {
    scree_row row[6][4];
    for (int i = 0; i < 4; i++) {
        const struct scree_push *ball = &push[contact[i]->ball], *host = &push[contact[i]->host];
        row[0][i] = *(const scree_row *)ball->along - *(const scree_row *)host->along;
        row[1][i] = *(const scree_row *)ball->more - *(const scree_row *)host->more;
        if (!turns) continue;
        row[2][i] = *(const scree_row *)ball->turn;
        row[3][i] = *(const scree_row *)ball->turn_more;
        row[4][i] = *(const scree_row *)host->turn;
        row[5][i] = *(const scree_row *)host->turn_more;
    }
    store_columns(row[0], to->along, lane);
    store_columns(row[1], to->more, lane);
    if (!turns) return;
    store_columns(row[2], to->ball_turn, lane);
    store_columns(row[3], to->ball_more, lane);
    store_columns(row[4], to->host_turn, lane);
    store_columns(row[5], to->host_more, lane);
}
#else
static inline void fetch_pushes(const struct scree_push *push, const struct scree_contact *const contact[4], int lane,
                                int turns, struct meeting *to) {
    for (int i = 0; i < 4; i++) {
        const struct scree_push *ball = &push[contact[i]->ball], *host = &push[contact[i]->host];
        for (int k = 0; k < 3; k++) {
            to->along[k][lane + i] = ball->along[k] - host->along[k];
            to->more[k][lane + i] = ball->more[k] - host->more[k];
        }
        for (int k = 0; turns && k < 4; k++) {
            to->ball_turn[k][lane + i] = ball->turn[k];
            to->ball_more[k][lane + i] = ball->turn_more[k];
            to->host_turn[k][lane + i] = host->turn[k];
            to->host_more[k][lane + i] = host->turn_more[k];
        }
    }
}
#endif

/* Numbers of one column, of contacts one after the other (`index` NULL) or here and there. */
static inline void fetch_column(const double *column, int first, const int *index, int count, double *to) {
    if (index) {
        for (int k = 0; k < count; k++) to[k] = column[index[k]];
    } else {
        _Pragma("omp simd")
        for (int k = 0; k < padded(count); k++) to[k] = column[first + k];
    }
}

/* What is kept of the contacts. */
static void fetch_kept(const struct scree_batch *batch, int first, const int *index, int count, int turns,
                       struct block *b, struct meeting *to, struct course *c, struct motion *m) {
    for (int axis = 0; axis < 3; axis++) {
        fetch_column(batch->past[axis], first, index, count, to->last[axis]);
        fetch_column(batch->past[3 + axis], first, index, count, to->before[axis]);
    }
    int columns = turns ? SCREE_PAIR_LEVER : SCREE_PAIR_FRICTION;
    for (int column = 0; column < columns; column++)
        fetch_column(batch->pair[column], batch->uniform ? 0 : first, batch->uniform ? NULL : index, count,
                     m->pair[column]);
    if (!turns) return;
    if (!batch->kept[0]) {
        memset(c->s, 0, sizeof c->s);
        memset(c->slides, 0, sizeof c->slides);
        return;
    }
    for (int axis = 0; axis < 3; axis++) fetch_column(batch->kept[axis], first, index, count, c->s[axis]);
    fetch_column(batch->kept[3], first, index, count, c->slides);
    _Pragma("omp simd")
    for (int k = 0; k < padded(count); k++) put(c->s, k, scree_into_tangent_plane(get(c->s, k), get(b->n, k)));
}

/* Arms and speeds at the start, arms and normal in the middle. */
static SCREE_INLINE void meet_lane(struct block *b, int k, double step, int balls, int turns, struct meeting *to,
                                   struct course *c, struct motion *m) {
    struct vec n = get(b->n, k), shift = get(b->shift, k), rush = get(b->rush, k), later_n = n;
    double d = b->overlap[k], along = vec_dot(rush, n), later_d = d - 0.5 * step * along;
    double apart = balls ? b->shift[3][k] - d : vec_dot(shift, n), later_apart = apart + 0.5 * step * along;
    if (balls) {
        const struct vec origin = {0.0, 0.0, 0.0};
        struct scree_meeting later = scree_meet_ball(vec_axpy(shift, 0.5 * step, rush), b->shift[3][k], origin, 0.0);
        later_n = later.normal;
        later_d = later.overlap;
        later_apart = b->shift[3][k] - later_d;
    }
    put(to->later_n, k, later_n);
    to->arm[k] = b->radius[k] - 0.5 * d;
    to->host_arm[k] = apart - to->arm[k];
    to->later_arm[k] = b->radius[k] - 0.5 * later_d;
    to->later_host_arm[k] = later_apart - to->later_arm[k];
    c->d[k] = d;
    c->u[k] = -along;
    m->give[k] = b->rush[3][k];
    m->give_aside[k] = m->give[k];
    if (!turns) return;
    struct vec around = vec_axpy(vec_scale(to->arm[k], get(b->ball_spin, k)), to->host_arm[k], get(b->host_spin, k));
    struct vec slip = vec_sub(rush, vec_cross(around, n));
    put(c->v, k, vec_axpy(slip, -vec_dot(slip, n), n));
    m->give_aside[k] +=
        to->arm[k] * to->arm[k] * to->ball_turn[3][k] + to->host_arm[k] * to->host_arm[k] * to->host_turn[3][k];
}

/* The acceleration that isn't the pair's own: the rest of what the bodies do, and the turning of arms and normal. */
static SCREE_INLINE void drive_lane(struct block *b, int k, double step, int turns, struct meeting *to,
                                    struct motion *m) {
    struct vec n = get(b->n, k), later_n = get(to->later_n, k), rush = get(b->rush, k), last = get(to->last, k);
    double more = (0.15 - 0.5 * m->rate[k] * step) / 0.06, per_step = 1.0 / step;
    more = more > 0.0 ? more : 0.0;
    more = more < 1.0 ? more : 1.0;
    struct vec own = vec_axpy(last, more, vec_sub(last, get(to->before, k)));
    struct vec a = vec_axpy(get(to->along, k), more, get(to->more, k));
    struct vec sweep = vec_scale(2.0 * per_step, vec_sub(later_n, n)), slip = rush, gain = {0.0, 0.0, 0.0};
    a = vec_axpy(a, -m->give[k] * per_step, own);
    if (turns) {
        struct vec ball = vec_axpy(get(to->ball_turn, k), more, get(to->ball_more, k));
        struct vec host = vec_axpy(get(to->host_turn, k), more, get(to->host_more, k));
        a = vec_sub(a, vec_cross(vec_axpy(vec_scale(to->arm[k], ball), to->host_arm[k], host), n));
        a = vec_axpy(a, (m->give[k] - m->give_aside[k]) * per_step, vec_axpy(own, -vec_dot(own, n), n));
        struct vec w = get(b->ball_spin, k), other = get(b->host_spin, k);
        struct vec before = vec_cross(vec_axpy(vec_scale(to->arm[k], w), to->host_arm[k], other), n);
        struct vec after = vec_cross(vec_axpy(vec_scale(to->later_arm[k], w), to->later_host_arm[k], other), later_n);
        gain = vec_scale(-2.0 * per_step, vec_sub(after, before));
        slip = vec_sub(rush, before);
    }
    /* (n x n') x v */
    gain = vec_sub(gain, vec_axpy(vec_scale(vec_dot(n, slip), sweep), -vec_dot(sweep, slip), n));
    a = vec_add(a, gain);
    m->closing[k] = -vec_dot(a, n);
    if (turns) put(m->aside, k, vec_axpy(a, m->closing[k], n));
}

/* ---- scatter ---- */

/* A vector of the tangent plane turns with the normal, from n to `later`. */
static SCREE_INLINE struct vec turn_over(struct vec v, struct vec axis, double cosine) {
    struct vec once = vec_cross(axis, v);
    return vec_axpy(vec_add(v, once), 1.0 / (1.0 + cosine), vec_cross(axis, once));
}

/* Impulses in the directions of mid-step; zero where there is no touch. */
static SCREE_INLINE void yield_lane(struct block *b, int k, int balls, int turns, struct meeting *at, struct course *c,
                                    struct scree_yield *yield, struct scree_moments *moments) {
    struct vec later = get(at->later_n, k), none = {0.0, 0.0, 0.0};
    int acts = (c->d[k] > 0.0) & (b->overlap[k] > 0.0);
    struct vec j = vec_scale(c->press[k], later), m = vec_scale(c->press_moment[k], later);
    if (turns) {
        struct vec rub = get(c->rub, k), rub_moment = get(c->rub_moment, k);
        if (balls) {
            struct vec n = get(b->n, k), axis = vec_cross(n, later);
            double cosine = vec_dot(n, later);
            rub = turn_over(rub, axis, cosine);
            rub_moment = turn_over(rub_moment, axis, cosine);
        }
        struct vec around = vec_cross(rub, later);
        j = vec_add(j, rub);
        m = vec_add(m, rub_moment);
        put(yield->turn_ball, k, acts ? vec_scale(at->later_arm[k], around) : none);
        put(yield->turn_host, k, acts ? vec_scale(at->later_host_arm[k], around) : none);
    }
    put(yield->impulse, k, acts ? j : none);
    put(moments->impulse, k, acts ? m : none);
}

/* ---- a block ---- */

/* Columns of a block on its way. */
struct smooth_block {
    struct block b;
    struct meeting at;
    struct motion m;
    struct course c;
    double flight[SCREE_LANES]; /* overlap at the end of the step if nothing acts, m */
};

/* Nothing has been yielded yet. */
static void begin_course(struct course *c) {
    memset(c->press, 0, offsetof(struct course, coarse) - offsetof(struct course, press));
}

/* Steps of Runge-Kutta: as many as asked for; else one, and with friction two where one isn't enough. */
static void go_on(const struct smooth_pass *pass, const struct scree_rule *rule, int substeps, int count, double step,
                  struct smooth_block *s) {
    int asked = substeps > 0 ? substeps : 1, control = rule->friction >= 0 && !substeps;
    int coarse[SCREE_LANES], others = 0;
    struct motion few;
    struct course start, again;
    if (control) memcpy(&start, &s->c, offsetof(struct course, press));
    for (int k = 0; k < asked; k++) pass->step(rule, &s->m, count, step / asked, step / asked * (asked - 1 - k), &s->c);
    for (int k = 0; control && k < count; k++)
        if (s->c.coarse[k] > 0.0 && s->b.overlap[k] > 0.0) coarse[others++] = k;
    if (!others) return;
    int lanes = padded(others);
    for (int k = others; k < lanes; k++) coarse[k] = coarse[others - 1];
    pick_lanes(&s->m, coarse, lanes, sizeof few, &few);
    pick_lanes(&start, coarse, lanes, offsetof(struct course, press), &again);
    begin_course(&again);
    for (int k = 0; k < 2; k++) pass->step(rule, &few, others, 0.5 * step, k ? 0.0 : 0.5 * step, &again);
    return_lanes(&again, coarse, others, sizeof again, &s->c);
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
    begin_course(&s->c);
    fetch_kept(batch, first, index, count, turns, &s->b, &s->at, &s->c, &s->m);
}

/* A loop of its own for each kind of contact. */
#define FOR_LANES(lane_of)                                                                                             \
    _Pragma("omp simd")                                                                                                \
    for (int k = 0; k < padded(count); k++) lane_of

static void meet_smooth(struct smooth_block *s, int count, double step, int balls, int turns) {
    if (balls && turns) {
        FOR_LANES(meet_lane(&s->b, k, step, 1, 1, &s->at, &s->c, &s->m);)
    } else if (balls) {
        FOR_LANES(meet_lane(&s->b, k, step, 1, 0, &s->at, &s->c, &s->m);)
    } else if (turns) {
        FOR_LANES(meet_lane(&s->b, k, step, 0, 1, &s->at, &s->c, &s->m);)
    } else {
        FOR_LANES(meet_lane(&s->b, k, step, 0, 0, &s->at, &s->c, &s->m);)
    }
}

static void drive_smooth(struct smooth_block *s, int count, double step, int turns) {
    if (turns) {
        FOR_LANES(drive_lane(&s->b, k, step, 1, &s->at, &s->m);)
    } else {
        FOR_LANES(drive_lane(&s->b, k, step, 0, &s->at, &s->m);)
    }
    FOR_LANES(s->flight[k] = s->c.d[k] + (step * s->c.u[k] + 0.5 * step * step * s->m.closing[k]);)
}

static void yield_smooth(struct smooth_block *s, int count, int balls, int turns, struct scree_yield *yield,
                         struct scree_moments *moments) {
    if (balls && turns) {
        FOR_LANES(yield_lane(&s->b, k, 1, 1, &s->at, &s->c, yield, moments);)
    } else if (balls) {
        FOR_LANES(yield_lane(&s->b, k, 1, 0, &s->at, &s->c, yield, moments);)
    } else if (turns) {
        FOR_LANES(yield_lane(&s->b, k, 0, 1, &s->at, &s->c, yield, moments);)
    } else {
        FOR_LANES(yield_lane(&s->b, k, 0, 0, &s->at, &s->c, yield, moments);)
    }
    FOR_LANES({
        double steady = s->b.n[0][k] * s->at.later_n[0][k] + s->b.n[1][k] * s->at.later_n[1][k] +
                        s->b.n[2][k] * s->at.later_n[2][k];
        double odd = s->b.overlap[k] > 0.0 ? s->c.odd[k] : s->flight[k] > 0.0 ? 1.0 : 0.0;
        int plain = (steady >= 0.9) & (s->m.give[k] > 0.0);
        s->c.odd[k] = plain ? odd : 1.0;
    })
}

/* Depths and slopes. */
static void rate_contacts(struct smooth_block *s, int count, double slope, struct scree_yield *yield) {
    FOR_LANES(yield->depth[k] = s->b.overlap[k] / limit_of(&s->b, k);)
    if (slope == 0.0)
        FOR_LANES(yield->steep[k] = 0.0;)
    else
        FOR_LANES(yield->steep[k] =
                      slope * 4.0 * s->b.rush[3][k] * vec_dot(get(yield->impulse, k), get(s->at.later_n, k));)
}

/* What is kept of contacts one after the other. */
static void keep_all(const struct scree_batch *batch, struct smooth_block *s, int first, int count, int turns,
                     struct scree_yield *yield) {
    for (int axis = 0; axis < 3; axis++) {
        double *last = batch->past[axis] + first, *before = batch->past[3 + axis] + first;
        const double *now = yield->impulse[axis];
        FOR_LANES({
            before[k] = s->c.odd[k] > 0.0 ? before[k] : last[k];
            last[k] = s->c.odd[k] > 0.0 ? last[k] : now[k];
        })
    }
    if (!turns || !batch->kept[0]) return;
    for (int m = 0; m < 4; m++) {
        double *kept = batch->kept[m] + first, *now = m < 3 ? s->c.s[m] : s->c.slides;
        FOR_LANES({
            double new = s->b.overlap[k] > 0.0 ? now[k] : 0.0;
            kept[k] = s->c.odd[k] > 0.0 ? kept[k] : new;
        })
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
        batch->past[3 + axis][index] = batch->past[axis][index];
        batch->past[axis][index] = from->impulse[axis][i];
    }
    yield->depth[lane] = from->depth[i];
    yield->steep[lane] = from->steep[i];
    for (int m = 0; turns && batch->kept[0] && m < 4; m++) {
        double now = m < 3 ? s->c.s[m][i] : s->c.slides[i];
        batch->kept[m][index] = s->b.overlap[i] > 0.0 ? now : 0.0;
    }
}

/* Nothing can happen in this step: too far apart, and nothing kept of an earlier touch. */
static int far_apart(const struct scree_bodies *now, const struct scree_batch *batch,
                     const struct scree_contact *contact, int index) {
    const struct scree_record *ball = &now->record[contact->ball], *host = &now->record[contact->host];
    double range = now->push[contact->ball].along[3] + now->push[contact->host].along[3];
    if (batch->geometry == SCREE_BALL_PLANE) {
        if (!(scree_meet(now, contact, SCREE_BALL_PLANE, vec_from(ball->x)).overlap + range < 0.0)) return 0;
    } else {
        double reach = ball->radius + host->radius;
        double square = vec_norm2(scree_apart(now, contact, batch->geometry));
        if (!(square > reach * reach) || !(square > (reach + range) * (reach + range))) return 0;
    }
    for (int m = 0; m < SCREE_PAST; m++)
        if (batch->past[m][index] != 0.0) return 0;
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
    pass->rates(rule, batch->slope, count, &s->c, &s->m);
    drive_smooth(s, count, step, turns);
    for (int k = 0; k < count; k++) touching |= s->b.overlap[k] > 0.0;
    if (touching) go_on(pass, rule, contacts->substeps, count, step, s);
    yield_smooth(s, count, balls, turns, yield, moments);
    rate_contacts(s, count, batch->slope, yield);
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
        if (s.c.odd[i] > 0.0)
            odd |= (uint32_t)1 << lane[i];
        else
            hand_over(batch, &s, i, index[i], lane[i], turns, &few, &few_moments, yield, moments);
    return odd;
}

uint32_t SCREE_PART(impel)(const struct scree_contacts *contacts, const struct scree_bodies *now,
                           const struct scree_batch *batch, int first, int count, double step,
                           struct scree_yield *yield, struct scree_moments *moments) {
    const struct scree_rule *rule = &contacts->rule[batch->rule];
    const struct smooth_pass *pass = smooth_pass_of(rule, batch, first);
    enum scree_geometry geometry = batch->geometry;
    int balls = geometry == SCREE_BALL_BALL || geometry == SCREE_BALL_IMAGE, lane[SCREE_LANES], acting = 0;
    uint32_t odd = 0;
    if (!pass || rule->rolling >= 0 || !(balls || geometry == SCREE_BALL_PLANE)) return ~(uint32_t)0;
    for (int k = 0; k < count; k++) {
        const struct scree_contact *one = &batch->contact[first + k];
        if (!is_plain(now, one))
            odd |= (uint32_t)1 << k;
        else if (!far_apart(now, batch, one, first + k))
            lane[acting++] = k;
    }
    if (2 * acting < count || odd) {
        for (int k = 0; k < count; k++) hand_nothing(yield, moments, k);
        if (acting) odd |= impel_few(contacts, now, batch, pass, first, lane, acting, step, yield, moments);
        return odd;
    }
    struct smooth_block s;
    run_smooth(contacts, now, batch, pass, batch->contact + first, first, NULL, count, step, &s, yield, moments);
    keep_all(batch, &s, first, count, rule->friction >= 0, yield);
    for (int k = 0; k < count; k++) odd |= (uint32_t)(s.c.odd[k] > 0.0) << k;
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
