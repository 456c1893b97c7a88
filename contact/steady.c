/* Contacts that hardly change, in a step of the pair-impulse method. Most contacts of a bed at rest bear a load that
 * others balance, and swing about it a little. Such a one needs its laws once, in the middle of the step where the
 * accelerations of the last two steps take its bodies (bodies/pushed.h), not some ten times on its way through it:
 *
 *   J = h F + (h F - 2 J_1 + J_2)/24,  M = h J/2 - h (J - J_1)/12
 *
 * with F the force in the middle, J_1 and J_2 the impulses of the last step and of the one before: the midpoint rule
 * and what its error and the moment depend on, the second and first derivative of F, as those impulses tell them.
 *
 * Steady is what swings by a part q of its load at most:
 *
 *   |h F - J_1| <= q w h |h F|,  |h F - 2 J_1 + J_2| <= q (w h)^2 |h F|
 *
 * with w the angular frequency of the pair. That measure has no step in it: whether a contact is steady is no question
 * of how finely it is resolved, and no impact is, in which nothing balances the force (F'' = -w^2 F). Friction must
 * hold, with some room. For steps so long, or contacts so damped, that forces extrapolated from the last steps might
 * grow, there is the other way (smooth.c), which solves for the pair's own force.
 *
 * Of the others in a block those that can't touch in this step are done with, too.
 *
 * Which contacts are steady is decided for each by its own numbers, as in smooth.c. Compiled once for each kind of
 * processor, as loop.c is. */
#include "contact/law_list.h"
#include "contact/loop.h"
#include "contact/meeting.h"

#include <string.h>

/* Columns of a block. */
struct steady {
    struct block b;
    double stretch[3][SCREE_LANES];               /* m */
    double damping[SCREE_LANES];                  /* of the normal law, N s/m */
    double drag[SCREE_LANES], stiff[SCREE_LANES]; /* of friction: dashpot and spring, N s/m, N/m */
    double is[SCREE_LANES];                       /* 1: steady */
};

/* What all contacts of a batch have in common; columns of those from the first of the block on. */
struct steady_work {
    const struct scree_rule *rule;
    double step;
    struct sizes sizes;
    int balls, rubs, takes_roots;
    const double *pair[SCREE_PAIR_COLUMNS];
};

/* ---- laws ---- */

/* A step hears of a law once: it has one formula, and no memory; and no force beyond the touch. */
static inline int is_steady_law(const struct scree_normal_law *law) {
    return !law->reach && !law->memory && !law->bends && law->turns_smoothly;
}

/* Which pairs are on the safe side, by 2 z w h of the damping and (w h)^2 of the stiffness. In the densest packing,
 * twelve neighbours each, with friction as stiff and as damped as the normal law, motion grows from 2 z w h = 0.64 on
 * at w h = 0.5, from 0.92 on at 0.3; without `relaxed`, by the modes of that packing, from about 0.1 on. */
static SCREE_INLINE int is_tame(double damped, double stiff) { return (damped <= 0.5) & (stiff <= 0.2); }

/* By what the force in the middle differs from what the last two steps foretell, velocities there differ, too, and
 * dashpots make the difference less; so do those of the other contacts of both bodies. As if all of these did alike it
 * counts by this share. */
static SCREE_INLINE double relaxed(double damped) {
    const double neighbours = 2.5;
    return 1.0 / (1.0 + neighbours * damped);
}

typedef void steady_pass(struct steady *s, int count, const struct steady_work *w);

#define STEADY_NORMAL(word)                                                                                            \
    static SCREE_INLINE void press_##word(struct steady *s, int k, const struct scree_law_constants *constants,        \
                                          const double *const *pair) {                                                 \
        struct block *b = &s->b;                                                                                       \
        struct scree_pair_constants of_pair = {{pair[0][k], pair[1][k], pair[2][k], pair[3][k]}};                      \
        struct scree_pressing at = scree_pressed(b->overlap[k], b->closing[k], 0.0, 0.0);                              \
        if (scree_normal_##word.takes_roots) at.roots = roots_at(b, k);                                                \
        struct scree_normal_force f = normal_##word##_force(constants, of_pair, at);                                   \
        b->force[k] = f.elastic + f.damping * at.closing;                                                              \
        b->reversible[k] = f.reversible;                                                                               \
        s->damping[k] = f.damping;                                                                                     \
    }                                                                                                                  \
    static void normal_##word(struct steady *s, int count, const struct steady_work *w) {                              \
        struct scree_law_constants own = w->rule->normal_constants;                                                    \
        if (!is_steady_law(&scree_normal_##word)) return;                                                              \
        SCREE_FOR_EXPONENT(scree_normal_##word.raises, own,                                                            \
                           _Pragma("omp simd") for (int k = 0; k < padded(count); k++)                                 \
                               press_##word(s, k, &own, w->pair););                                                    \
    }
SCREE_NORMAL_LAWS(STEADY_NORMAL)

/* Sliders that keep a stretch. */
#define STEADY_SLIDERS(LAW) LAW(coulomb) LAW(mindlin)

/* A slider that holds: its force in the middle of the step, its stretch at the end. */
static SCREE_INLINE void hold(struct steady *s, int k, double step, struct scree_slider slider) {
    struct block *b = &s->b;
    struct vec stretch = get(s->stretch, k), slip = slip_at(b, k);
    struct vec trial = scree_slider_trial(slider.k, slider.drag, stretch, slip);
    double holds = 0.95 * slider.bears.holds;
    put(b->friction, k, vec_scale(-1.0, trial));
    put(s->stretch, k, vec_axpy(stretch, step, slip));
    s->drag[k] = slider.drag - 0.5 * step * slider.k;
    s->stiff[k] = slider.k;
    s->is[k] = vec_norm2(trial) <= holds * holds ? 1.0 : 0.0;
}

#define STEADY_SLIDER(word)                                                                                            \
    static SCREE_INLINE void rub_##word(struct steady *s, int k, const struct scree_law_constants *constants,          \
                                        const struct steady_work *w) {                                                 \
        struct block *b = &s->b;                                                                                       \
        struct scree_pair_constants of_pair = {                                                                        \
            {w->pair[SCREE_PAIR_FRICTION][k], w->pair[SCREE_PAIR_FRICTION + 1][k], 0.0, 0.0}};                         \
        struct scree_sliding at = {                                                                                    \
            .normal = b->force[k] > 0.0 ? b->force[k] : 0.0, .overlap = b->overlap[k], .half = 0.5 * w->step};         \
        if (scree_friction_##word.takes_roots) at.roots = roots_at(b, k);                                              \
        hold(s, k, w->step, scree_friction_##word.grip(constants, of_pair, at));                                       \
    }                                                                                                                  \
    static void slider_##word(struct steady *s, int count, const struct steady_work *w) {                              \
        const struct scree_law_constants own = w->rule->friction_constants;                                            \
        _Pragma("omp simd")                                                                                            \
        for (int k = 0; k < padded(count); k++) rub_##word(s, k, &own, w);                                             \
    }
STEADY_SLIDERS(STEADY_SLIDER)

#define ENTRY(word) normal_##word,
static steady_pass *normal_of(int normal) {
    static steady_pass *const passes[] = {SCREE_NORMAL_LAWS(ENTRY)};
    return is_steady_law(scree_normal_laws[normal]) ? passes[normal] : NULL;
}
#undef ENTRY

#define ENTRY(word) {FRICTION_##word, slider_##word},
static steady_pass *slider_of(int friction) {
    static const struct {
        int friction;
        steady_pass *pass;
    } sliders[] = {STEADY_SLIDERS(ENTRY)};
    for (size_t k = 0; k < sizeof sliders / sizeof *sliders; k++)
        if (sliders[k].friction == friction) return sliders[k].pass;
    return NULL;
}
#undef ENTRY

/* ---- a block ---- */

/* How many may be steady, by their impulses so far. */
static int count_candidates(const struct scree_batch *batch, int first, int count) {
    const double *past[SCREE_PAST];
    for (int m = 0; m < SCREE_PAST; m++) past[m] = batch->past[m] + first;
    double some = 0.0;
    _Pragma("omp simd reduction(+ : some)")
    for (int k = 0; k < count; k++) {
        struct vec last = vec(past[0][k], past[1][k], past[2][k]);
        struct vec before = vec(past[SCREE_PAST_STEP][k], past[SCREE_PAST_STEP + 1][k], past[SCREE_PAST_STEP + 2][k]);
        some += vec_norm2(vec_sub(last, before)) < 0.25 * vec_norm2(last) ? 1.0 : 0.0;
    }
    return (int)some;
}

static struct steady_work work_on(const struct scree_contacts *contacts, const struct scree_bodies *bodies,
                                  const struct scree_batch *batch, int first, double step) {
    const struct scree_rule *rule = &contacts->rule[batch->rule];
    int balls = batch->geometry == SCREE_BALL_BALL || batch->geometry == SCREE_BALL_IMAGE, rubs = rule->friction >= 0;
    struct steady_work w = {
        .rule = rule,
        .step = step,
        .balls = balls,
        .rubs = rubs,
        .sizes = {balls && rubs && bodies->even > 0.0, bodies->even + bodies->even,
                  bodies->spin[batch->ends[first].ball].limit},
        .takes_roots =
            scree_normal_laws[rule->normal]->takes_roots || (rubs && scree_friction_laws[rule->friction]->takes_roots),
    };
    for (int c = 0; c < SCREE_PAIR_COLUMNS; c++) w.pair[c] = batch->pair[c] + (batch->uniform ? 0 : first);
    return w;
}

/* From the bodies in the middle of the step to how they meet and slide. */
static void gather_steady(const struct scree_bodies *bodies, const struct scree_batch *batch, int first, int count,
                          const struct steady_work *w, struct steady *s) {
    struct block *b = &s->b;
    struct scree_contact contact[SCREE_LANES];
    struct ends ends;
    struct wants wants = {.step = w->step, .sizes = w->sizes, .takes_roots = w->takes_roots, .remembers = w->rubs};
    double *stretch[3] = {s->stretch[0], s->stretch[1], s->stretch[2]};
    name_contacts(batch, first, count, contact);
    find_ends(bodies->record, bodies->spin, &batch->ends[first], count, &ends);
    fetch_motions(&ends, count, w->balls, w->sizes.even, b);
    for (int m = 0; w->rubs && m < 3; m++)
        memcpy(s->stretch[m], batch->kept[m] + first, (size_t)padded(count) * sizeof(double));
    if (batch->geometry == SCREE_BALL_IMAGE) bring_images(bodies, contact, count, b);
    if (w->balls) {
        meet_balls(b, count, wants);
        if (w->rubs) slide_balls(b, count, stretch, wants);
        if (!w->rubs && w->takes_roots) find_fourth_roots(b, count);
        return;
    }
    meet_planes(bodies, batch, contact, &ends, count, b);
    move_all(count, b);
    see(b, count, wants);
    if (w->rubs) turn_stretches(b, count, w->step, stretch);
}

/* What a contact yields, and whether it is steady. */
static SCREE_INLINE void yield_steady(struct steady *s, int k, const struct steady_work *w, int balls, int rubs,
                                      int even, double *const *past, int first, struct scree_yield *yield,
                                      struct scree_moments *moments) {
    const double most = 0.2; /* q */
    struct block *b = &s->b;
    struct sizes sizes = sizes_if(w->sizes, even);
    double step = w->step, d = b->overlap[k], give = b->rush[3][k];
    struct vec n = normal_at(b, k), force = vec_scale(b->force[k], n);
    if (rubs) force = vec_add(force, get(b->friction, k));
    struct vec j = vec_scale(step, force), last = get_kept(past, first + k);
    struct vec change = vec_sub(j, last), before = vec_sub(last, get_kept(past + SCREE_PAST_STEP, first + k));
    struct vec bend = vec_sub(change, before);
    double square = vec_norm2(j), stiff = step * step * give * 1.5 * b->reversible[k]; /* (w h)^2 d */
    double swing = most * stiff, damped = step * give * s->damping[k];
    double changes = vec_norm2(change) * d, bends = vec_norm2(bend) * (d * d);
    int tame = is_tame(damped, stiff / d);
    int steady = (d > 0.0) & (b->force[k] > 0.0) & (swing > 0.0) & (changes <= most * swing * square) &
                 (bends <= swing * swing * square) & tame;
    double straight = vec_dot(bend, n);
    struct vec aside = vec_axpy(bend, -straight, n);
    if (rubs) {
        double aside_give = 3.5 * give, dragged = step * aside_give * s->drag[k]; /* of balls */
        tame = is_tame(dragged, step * step * aside_give * s->stiff[k]);
        steady &= (s->is[k] > 0.0) & tame;
        aside = vec_scale(relaxed(dragged), aside);
    }
    bend = vec_axpy(aside, straight * relaxed(damped), n);
    s->is[k] = steady ? 1.0 : 0.0;
    j = vec_axpy(vec_add(last, before), 25.0 / 24.0, bend);
    put(yield->impulse, k, j);
    put(moments->impulse, k, vec_scale(step, vec_axpy(vec_scale(0.5, j), -1.0 / 12.0, vec_sub(j, last))));
    yield->depth[k] = d / limit_of(b, k, sizes);
    yield->steep[k] = 0.0;
    yield->lasts[k] = 1.0;
    if (!rubs) return;
    if (balls) {
        struct vec turn = vec_cross(j, n);
        put(yield->turn_ball, k, vec_scale(b->lever[0][k], turn));
        put(yield->turn_host, k, vec_scale(b->lever[1][k], turn));
    } else {
        struct vec arm = get(b->arm, k);
        put(yield->turn_ball, k, vec_cross(arm, j));
        put(yield->turn_host, k, vec_cross(j, vec_add(arm, shift_at(b, k))));
    }
}

static void yield_all(struct steady *s, int count, const struct steady_work *w, const struct scree_batch *batch,
                      int first, struct scree_yield *yield, struct scree_moments *moments) {
    double *const *past = batch->past;
#define YIELD(balls, rubs, even)                                                                                       \
    _Pragma("omp simd")                                                                                                \
    for (int k = 0; k < padded(count); k++) yield_steady(s, k, w, balls, rubs, even, past, first, yield, moments)
    if (w->sizes.even)
        YIELD(1, 1, 1);
    else if (w->balls && w->rubs)
        YIELD(1, 1, 0);
    else if (w->balls)
        YIELD(1, 0, 0);
    else if (w->rubs)
        YIELD(0, 1, 0);
    else
        YIELD(0, 0, 0);
#undef YIELD
}

/* Whether other contacts push a free ball, too: all impulses of the last step aren't this one's, of that sign. Or it is
 * frozen. */
static inline int has_others(const struct scree_bodies *bodies, int k, struct vec own, double sign) {
    if (bodies->class[k] != SCREE_CLASS_BALL) return bodies->class[k] == SCREE_CLASS_FIXED;
    if (bodies->glance[k].trace != scree_trace_of(own.x)) return 1;
    const double *all = bodies->past[k].impulse[0];
    return all[0] != sign * own.x || all[1] != sign * own.y || all[2] != sign * own.z;
}

/* What is left of the steady lanes if their sliders haven't slid. */
static void drop_sliding(const unsigned char *slides, int count, struct steady *s) {
    _Pragma("omp simd")
    for (int k = 0; k < count; k++) s->is[k] = slides[k] ? 0.0 : s->is[k];
}

/* And if others push both bodies: free balls, that is, or frozen ones. */
static void drop_lonely(const struct scree_bodies *bodies, const struct scree_batch *batch, int first, int count,
                        struct steady *s) {
    const struct scree_ends *ends = batch->ends + first;
    const struct scree_glance *glance = bodies->glance;
    const double *last = batch->past[0] + first;
    for (int k = 0; k < count; k++) {
        uint32_t own = scree_trace_of(last[k]); /* of both signs */
        if (!bodies->some_driven && glance[ends[k].ball].trace != own && glance[ends[k].host].trace != own) continue;
        struct vec all = get_kept(batch->past, first + k);
        if (!has_others(bodies, ends[k].ball, all, 1.0) || !has_others(bodies, ends[k].host, all, -1.0)) s->is[k] = 0.0;
    }
}

/* Bits of the steady lanes. */
static uint32_t steady_lanes(const struct scree_bodies *bodies, const struct scree_batch *batch, int first, int count,
                             struct steady *s) {
    uint32_t lanes = 0;
    if (batch->slides) drop_sliding(batch->slides + first, count, s);
    drop_lonely(bodies, batch, first, count, s);
    _Pragma("omp simd reduction(| : lanes)")
    for (int k = 0; k < SCREE_LANES; k++) {
        s->is[k] = k < count ? s->is[k] : 0.0;
        lanes |= s->is[k] > 0.0 ? (uint32_t)1 << k : 0;
    }
    return lanes;
}

/* Nothing can happen to contacts in this step that are farther apart in its middle than bodies go, and of which nothing
 * is kept. (smooth.c comes to the same, once it knows where balls start from, which is within a quarter of their ways
 * from there; those near the bound, or within rounding of it, are left to it.) */
static inline int is_idle(const struct scree_bodies *bodies, const struct scree_batch *batch, int index,
                          double overlap) {
    const struct scree_ends *ends = &batch->ends[index];
    double ways = (double)bodies->glance[ends->ball].way + (double)bodies->glance[ends->host].way;
    return overlap + 2.0 * ways < -1e-9 * bodies->record[ends->ball].radius && !scree_keeps_something(batch, index);
}

/* Bits of those lanes, which yield nothing. */
static uint32_t idle_lanes(const struct scree_bodies *bodies, const struct scree_batch *batch, int first, int count,
                           const struct steady *s, struct scree_yield *yield, struct scree_moments *moments) {
    uint32_t lanes = 0;
    for (int k = 0; k < count; k++) {
        if (!(s->b.overlap[k] < 0.0) || !is_idle(bodies, batch, first + k, s->b.overlap[k])) continue;
        yield_nothing(yield, moments, k);
        lanes |= (uint32_t)1 << k;
    }
    return lanes;
}

/* What is kept of the steady lanes. */
static void keep_steady(struct steady *s, const struct scree_batch *batch, int first, int count, int rubs,
                        const struct scree_yield *yield) {
    for (int m = 0; m < (rubs ? SCREE_PAST_STEP : SCREE_PAST_DEPTH); m++) {
        double *to = batch->past[SCREE_PAST_STEP + m] + first;
        const double *now = m == SCREE_PAST_DEPTH ? s->b.overlap : yield->impulse[m];
        _Pragma("omp simd")
        for (int k = 0; k < padded(count); k++) to[k] = s->is[k] > 0.0 ? now[k] + 0.0 : to[k]; /* zeros have no sign */
    }
    for (int m = 0; rubs && m < 3; m++) {
        double *kept = batch->kept[m] + first;
        _Pragma("omp simd")
        for (int k = 0; k < padded(count); k++) kept[k] = s->is[k] > 0.0 ? s->stretch[m][k] + 0.0 : kept[k];
    }
}

static void book_steady(struct steady *s, int count, const struct steady_work *w, struct scree_yield *yield) {
    const struct block *b = &s->b;
    for (int k = 0; k < count; k++) {
        if (!(s->is[k] > 0.0)) continue;
        yield->lost.normal[k] = w->step * (b->force[k] - b->reversible[k]) * b->closing[k];
        yield->lost.tangential[k] = w->rubs ? -w->step * vec_dot(get(s->b.friction, k), slip_at(b, k)) : 0.0;
    }
}

uint32_t SCREE_PART(hold_steady)(const struct scree_contacts *contacts, const struct scree_bodies *bodies,
                                 const struct scree_batch *batch, int first, int count, double step,
                                 struct scree_yield *yield, struct scree_moments *moments) {
    int balls = batch->geometry == SCREE_BALL_BALL || batch->geometry == SCREE_BALL_IMAGE;
    if ((!balls && batch->geometry != SCREE_BALL_PLANE) || contacts->substeps > 0) return 0;
    struct steady_work w = work_on(contacts, bodies, batch, first, step);
    steady_pass *normal = normal_of(w.rule->normal), *slider = w.rubs ? slider_of(w.rule->friction) : NULL;
    if (!normal || (w.rubs && !slider) || !count_candidates(batch, first, count)) return 0;
    struct steady s;
    gather_steady(bodies, batch, first, count, &w, &s);
    normal(&s, count, &w);
    if (slider) slider(&s, count, &w);
    yield_all(&s, count, &w, batch, first, yield, moments);
    uint32_t lanes = steady_lanes(bodies, batch, first, count, &s);
    if (!lanes) return 0;
    keep_steady(&s, batch, first, count, w.rubs, yield);
    if (contacts->measured) book_steady(&s, count, &w, yield);
    return lanes | idle_lanes(bodies, batch, first, count, &s, yield, moments);
}
