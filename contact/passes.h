/* The passes of a block of contacts through its laws: each is one loop over the lanes, made from the inline functions
 * of the laws, so that there are as many loops as laws, not as products of laws. A law that says so (a slider) goes
 * through several: what one of them divides, or takes the root of, the next one needs. Part of loop.c. */
#ifndef SCREE_CONTACT_PASSES_H
#define SCREE_CONTACT_PASSES_H

#include "contact/block.h"
#include "contact/law_list.h"
#include "contact/slider.h"

/* ---- normal and friction laws ---- */

typedef void law_pass(struct block *b, int count, const struct scree_law_constants *law, const double *const *pair,
                      double *const *kept, double step);

/* What a force that is there at once, not growing from zero, adds in a step in which bodies meet or part: its share of
 * the step, less what the law says of the middle of the step (`touching`). */
static SCREE_INLINE double jump_of(const struct scree_normal_law *normal, const struct scree_law_constants *constants,
                                   struct scree_pair_constants pair, struct scree_pressing at, double touching,
                                   double share, double step) {
    int held = normal->reach && at.second > 0.0; /* parting is farther off then */
    if (normal->reach && held == (at.closing > 0.0)) return 0.0;
    if (held)
        share = scree_share_of(scree_half_steps_in(at.overlap + normal->reach(constants, pair), at.closing, step));
    return (share - touching) * normal->jump(constants, pair, held);
}

/* One pass per normal law, from its inline function. A dashpot acts at full strength from the first touch on, so a step
 * in which bodies meet or part gets the share of it that they touch: without this the scheme is of first order. The
 * spring is left as it is: there the mid-step rule is of second order already, and reversible. What touches is looked
 * up, not compared again: a second comparison would make a branch of the law, and no vector. Where a law that never
 * pulls has let go, contact is over: what friction and rolling have kept is forgotten. */
#define NORMAL_PASS(word)                                                                                              \
    static SCREE_INLINE void normal_at_##word(struct block *b, int k, const struct scree_law_constants *constants,     \
                                              const double *const *pair, double *const *kept, double step) {           \
        double *const *own = kept + SCREE_KEPT_NORMAL;                                                                 \
        struct scree_pair_constants of_pair = {{pair[0][k], pair[1][k], pair[2][k], pair[3][k]}};                      \
        struct scree_pressing at = scree_pressed(b->overlap[k], b->closing[k], 0.0, 0.0);                              \
        if (scree_normal_##word.takes_roots) at.roots = roots_at(b, k);                                                \
        if (scree_normal_##word.memory) {                                                                              \
            at.first = own[0][k];                                                                                      \
            at.second = own[1][k];                                                                                     \
        }                                                                                                              \
        struct scree_normal_force f = normal_##word##_force(constants, of_pair, at);                                   \
        if (scree_normal_##word.memory) {                                                                              \
            own[0][k] = f.first;                                                                                       \
            own[1][k] = f.second;                                                                                      \
        }                                                                                                              \
        if (scree_normal_##word.reach) {                                                                               \
            b->touching[k] = f.second > 0.0 ? 1.0 : 0.0;                                                               \
            b->snap[k] =                                                                                               \
                b->touching[k] > at.second ? scree_snap_energy(scree_normal_##word.stored, constants, of_pair) : 0.0;  \
        }                                                                                                              \
        double touching = b->touching[k], share = b->share[k], spring = touching * f.elastic;                          \
        b->reversible[k] = touching * f.reversible;                                                                    \
        if (scree_normal_##word.jump) {                                                                                \
            double jump = jump_of(&scree_normal_##word, constants, of_pair, at, touching, share, step);                \
            spring += jump;                                                                                            \
            b->reversible[k] += jump;                                                                                  \
        }                                                                                                              \
        double force = spring + share * f.damping * at.closing;                                                        \
        b->force[k] = scree_normal_##word.cut && force < 0.0 ? 0.0 : force;                                            \
        if (scree_normal_##word.cut) b->touching[k] = force > 0.0 ? touching : 0.0;                                    \
    }                                                                                                                  \
    static void normal_pass_##word(struct block *b, int count, const struct scree_law_constants *law,                  \
                                   const double *const *pair, double *const *kept, double step) {                      \
        struct scree_law_constants constants = *law;                                                                   \
        SCREE_FOR_EXPONENT(scree_normal_##word.raises, constants,                                                      \
                           _Pragma("omp simd") for (int k = 0; k < padded(count); k++)                                 \
                               normal_at_##word(b, k, &constants, pair, kept, step););                                 \
    }
SCREE_NORMAL_LAWS(NORMAL_PASS)

/* A contact as a friction law sees it: its memory belongs to the ends of steps, the velocity to their middle. */
static SCREE_INLINE struct scree_sliding sliding_at(const struct block *b, int k, int memory, double *const *kept,
                                                    double half) {
    struct scree_sliding at = {.normal = b->force[k] > 0.0 ? b->force[k] : 0.0, .overlap = b->overlap[k], .half = half};
    at.closing = b->closing[k];
    at.apart = 1.0 - b->share[k];
    at.velocity = slip_at(b, k);
    if (!memory) return at;
    at.stretch = get_kept(kept, k);
    at.sliding = b->state[k];
    return at;
}

static SCREE_INLINE struct scree_pair_constants friction_pair_at(const double *const *pair, int k) {
    return (struct scree_pair_constants){{pair[SCREE_PAIR_FRICTION][k], pair[SCREE_PAIR_FRICTION + 1][k], 0.0, 0.0}};
}

/* What is kept of a contact while it lasts. Of zeros the sign is not: nothing is saved of a contact that keeps none but
 * these, and it begins at +0 again. */
static SCREE_INLINE struct vec kept_while(double touching, struct vec a) {
    return vec(touching * a.x + 0.0, touching * a.y + 0.0, touching * a.z + 0.0);
}

static inline void put_friction(struct block *b, int k, double *const *kept, int memory, struct scree_tangential f) {
    put(b->friction, k, f.force);
    if (!memory) return;
    put_kept(kept, k, kept_while(b->touching[k], f.stretch));
    b->state[k] = b->touching[k] * f.sliding;
}

static inline void put_slider(struct block *b, int k, struct scree_slider slider) {
    b->k[k] = slider.k;
    b->drag[k] = slider.drag;
    b->gone[k] = slider.gone;
    b->goes[k] = slider.goes;
    b->stays[k] = slider.stays;
    b->holds[k] = slider.bears.holds;
    b->slides[k] = slider.bears.slides;
}

/* One pass per friction law; of those that say what their slider is, the first of several. */
#define FRICTION_PASS(word)                                                                                            \
    static SCREE_INLINE void friction_at_##word(struct block *b, int k, const struct scree_law_constants *constants,   \
                                                const double *const *pair, double *const *kept, double half,           \
                                                int bare) {                                                            \
        struct scree_pair_constants of_pair = friction_pair_at(pair, k);                                               \
        struct scree_sliding at = sliding_at(b, k, scree_friction_##word.memory, kept, half);                          \
        at.bare = bare;                                                                                                \
        if (scree_friction_##word.takes_roots) at.roots = roots_at(b, k);                                              \
        if (scree_friction_##word.grip)                                                                                \
            put_slider(b, k, scree_friction_##word.grip(constants, of_pair, at));                                      \
        else                                                                                                           \
            put_friction(b, k, kept, scree_friction_##word.memory, friction_##word##_force(constants, of_pair, at));   \
    }                                                                                                                  \
    static void friction_pass_##word(struct block *b, int count, const struct scree_law_constants *law,                \
                                     const double *const *pair, double *const *kept, double step) {                    \
        const struct scree_friction_law *own = &scree_friction_##word;                                                 \
        struct scree_law_constants constants = *law;                                                                   \
        double half = 0.5 * step;                                                                                      \
        if (own->grip && scree_is_bare(own, law, friction_pair_at(pair, 0))) {                                         \
            _Pragma("omp simd")                                                                                        \
            for (int k = 0; k < padded(count); k++) friction_at_##word(b, k, &constants, pair, kept, half, 1);         \
            return;                                                                                                    \
        }                                                                                                              \
        _Pragma("omp simd")                                                                                            \
        for (int k = 0; k < padded(count); k++) friction_at_##word(b, k, &constants, pair, kept, half, 0);             \
    }
SCREE_FRICTION_LAWS(FRICTION_PASS)

/* ---- sliders, behind their first pass ---- */

/* Those that begin in this step count from the touch (scree_since_touch). */
static void begin_stretches(const struct block *b, int count, double step, double *const *kept) {
    _Pragma("omp simd")
    for (int k = 0; k < padded(count); k++) {
        struct vec s = get_kept(kept, k), slip = slip_at(b, k);
        double since = scree_since_touch(b->half_steps_in[k], b->closing[k], step);
        since = fabs(s.x) + fabs(s.y) + fabs(s.z) > 0.0 ? 0.0 : since;
        put_kept(kept, k, vec_axpy(s, since, slip));
    }
}

static void try_sliders(struct block *b, int count, double *const *kept) {
    _Pragma("omp simd")
    for (int k = 0; k < padded(count); k++) {
        struct vec trial = scree_slider_trial(b->k[k], b->drag[k], get_kept(kept, k), get(b->slip, k));
        put(b->trial, k, trial);
        b->size[k] = vec_norm(trial);
    }
}

static void end_sliders(struct block *b, int count, double *const *kept) {
    _Pragma("omp simd")
    for (int k = 0; k < padded(count); k++) {
        struct scree_slider slider = {
            .gone = b->gone[k], .goes = b->goes[k], .stays = b->stays[k], .bears = {b->holds[k], 0.0}};
        double size = b->size[k], share = scree_slider_share(b->slides[k], size);
        put_friction(b, k, kept, 1,
                     scree_slider_end(slider, get(b->trial, k), size, share, get_kept(kept, k), get(b->slip, k)));
    }
}

/* ---- rolling ---- */

/* Columns for the rolling laws: lever x angular velocity of the ball against the host, m/s. */
static inline struct vec turning_at(const struct block *b, int k, double lever) {
    return vec_scale(lever, vec(b->ball_spin[0][k] - b->host_spin[0][k], b->ball_spin[1][k] - b->host_spin[1][k],
                                b->ball_spin[2][k] - b->host_spin[2][k]));
}

/* As begin_stretches; `own`: what rolling laws keep. */
static void begin_turning(const struct block *b, int count, double step, const double *const *pair,
                          double *const *own) {
    _Pragma("omp simd")
    for (int k = 0; k < padded(count); k++) {
        struct vec s = get_kept(own, k), n = normal_at(b, k);
        struct vec velocity = turning_at(b, k, pair[SCREE_PAIR_LEVER][k]);
        double since = scree_since_touch(b->half_steps_in[k], b->closing[k], step), along = vec_dot(velocity, n);
        since = fabs(s.x) + fabs(s.y) + fabs(s.z) + fabs(own[4][k]) > 0.0 ? 0.0 : since;
        put_kept(own, k, vec_axpy(s, since, vec_axpy(velocity, -along, n)));
        own[4][k] += since * along;
    }
}

/* One pass per rolling law: rolling, then twisting, at the lever of the pair. */
#define ROLLING_PASS(word)                                                                                             \
    static SCREE_INLINE void rolling_at_##word(struct block *b, int k, const struct scree_law_constants *constants,    \
                                               double lever, double *const *own, double half, int bare) {              \
        struct vec n = normal_at(b, k), velocity = turning_at(b, k, lever);                                            \
        double along = vec_dot(velocity, n);                                                                           \
        struct scree_sliding rolling = {.normal = b->force[k] > 0.0 ? b->force[k] : 0.0,                               \
                                        .overlap = b->overlap[k],                                                      \
                                        .half = half,                                                                  \
                                        .apart = 1.0 - b->share[k],                                                    \
                                        .velocity = vec_axpy(velocity, -along, n),                                     \
                                        .bare = bare};                                                                 \
        struct scree_sliding twisting = rolling;                                                                       \
        twisting.velocity = vec(along, 0.0, 0.0);                                                                      \
        if (scree_rolling_##word.memory) {                                                                             \
            rolling.stretch = turned_stretch(b, k, own, half + half);                                                  \
            rolling.sliding = own[3][k];                                                                               \
            twisting.stretch = vec(own[4][k], 0.0, 0.0);                                                               \
            twisting.sliding = own[5][k];                                                                              \
        }                                                                                                              \
        struct scree_tangential r =                                                                                    \
            rolling_##word##_resist(constants, constants->c[SCREE_ROLLING_COEFFICIENT], rolling);                      \
        struct scree_tangential s =                                                                                    \
            rolling_##word##_resist(constants, constants->c[SCREE_TWISTING_COEFFICIENT], twisting);                    \
        put(b->torque, k, vec_scale(lever, vec_axpy(r.force, s.force.x, n)));                                          \
        b->power[k] = -(vec_dot(r.force, rolling.velocity) + s.force.x * along);                                       \
        if (scree_rolling_##word.memory) {                                                                             \
            put_kept(own, k, kept_while(b->touching[k], r.stretch));                                                   \
            own[3][k] = b->touching[k] * r.sliding;                                                                    \
            own[4][k] = b->touching[k] * s.stretch.x + 0.0;                                                            \
            own[5][k] = b->touching[k] * s.sliding;                                                                    \
        }                                                                                                              \
    }                                                                                                                  \
    static void rolling_pass_##word(struct block *b, int count, const struct scree_law_constants *law,                 \
                                    const double *const *pair, double *const *kept, double step) {                     \
        struct scree_law_constants constants = *law;                                                                   \
        double *const *own = kept + SCREE_KEPT_ROLLING;                                                                \
        const double *lever = pair[SCREE_PAIR_LEVER], half = 0.5 * step;                                               \
        if (scree_rolling_##word.memory && scree_rolling_##word.damping(law) == 0.0) {                                 \
            _Pragma("omp simd")                                                                                        \
            for (int k = 0; k < padded(count); k++) rolling_at_##word(b, k, &constants, lever[k], own, half, 1);       \
            return;                                                                                                    \
        }                                                                                                              \
        _Pragma("omp simd")                                                                                            \
        for (int k = 0; k < padded(count); k++) rolling_at_##word(b, k, &constants, lever[k], own, half, 0);           \
    }
SCREE_ROLLING_LAWS(ROLLING_PASS)

#define ENTRY(word) rolling_pass_##word,
static law_pass *const rolling_passes[] = {SCREE_ROLLING_LAWS(ENTRY)};
#undef ENTRY
#define ENTRY(word) normal_pass_##word,
static law_pass *const normal_passes[] = {SCREE_NORMAL_LAWS(ENTRY)};
#undef ENTRY
#define ENTRY(word) friction_pass_##word,
static law_pass *const friction_passes[] = {SCREE_FRICTION_LAWS(ENTRY)};
#undef ENTRY

/* ---- all of them ---- */

/* Friction's state, kept in bytes, to a column and back. */
#ifdef __AVX512F__
static void unpack(const unsigned char *slides, int count, double *state) {
    for (int lane = 0; lane < padded(count); lane += WIDTH) wide_from_bytes(slides + lane, state + lane);
}

static void pack(const double *state, int count, unsigned char *slides) {
    for (int lane = 0; lane < padded(count); lane += WIDTH) wide_to_bytes(state + lane, slides + lane);
}
#else
static void unpack(const unsigned char *slides, int count, double *state) {
    _Pragma("omp simd")
    for (int k = 0; k < padded(count); k++) state[k] = slides[k];
}

static void pack(const double *state, int count, unsigned char *slides) {
    _Pragma("omp simd")
    for (int k = 0; k < padded(count); k++) slides[k] = (unsigned char)state[k];
}
#endif

/* What of the normal forces in a block friction and rolling count from: a part of each (scree_borne), less what
 * crossings take off (scree_relief), N. */
struct bearing {
    double borne[SCREE_LANES], relief[SCREE_LANES];
};

/* What is the same for all blocks of a run of contacts, and where the columns of the next block are. */
struct work {
    const struct scree_batch *batch;
    const struct scree_rule *rule;
    struct wants wants;
    int balls;                     /* both are balls */
    int rubs;                      /* with friction or rolling */
    int slides;                    /* friction goes through the passes of a slider */
    int in_force;                  /* friction keeps a force */
    int bends;                     /* friction keeps what bristles are bent by */
    const struct bearing *bearing; /* of a block of boxes, what of normal forces friction counts from; NULL: all */
    const double *pair[SCREE_PAIR_COLUMNS];
    double *kept[SCREE_MEMORY];
};

/* `first` is one of the contacts. */
static inline struct work work_on(const struct scree_contacts *contacts, const struct scree_bodies *bodies,
                                  const struct scree_batch *batch, int first, double step) {
    const struct scree_rule *rule = &contacts->rule[batch->rule];
    const struct scree_friction_law *friction = rule->friction >= 0 ? scree_friction_laws[rule->friction] : NULL;
    struct sizes sizes = {scree_goes_even(bodies, batch, rule->rolling >= 0), bodies->even + bodies->even,
                          bodies->spin[batch->ends[first].ball].limit};
    return (struct work){
        .batch = batch,
        .rule = rule,
        .wants = {.step = step,
                  .sizes = sizes,
                  .takes_roots = scree_normal_laws[rule->normal]->takes_roots || (friction && friction->takes_roots),
                  .remembers = friction && friction->memory},
        .balls = batch->geometry == SCREE_BALL_BALL || batch->geometry == SCREE_BALL_IMAGE,
        .rubs = friction || rule->rolling >= 0,
        .slides = friction && friction->grip,
        .in_force = friction && friction->in_force,
        .bends = friction && friction->rate};
}

/* Contacts from `first` on. */
static inline void begin_at(struct work *w, int first) {
    const struct scree_batch *batch = w->batch;
    for (int c = 0; c < SCREE_PAIR_COLUMNS; c++) w->pair[c] = batch->pair[c] + (batch->uniform ? 0 : first);
    for (int m = 0; m < SCREE_MEMORY; m++) w->kept[m] = batch->kept[m] ? batch->kept[m] + first : NULL;
}

/* ---- what is kept is a force ---- */

/* Stiffness of friction `later` half steps after mid-step, N/m. */
static double stiffness_at(const struct work *w, const struct block *b, int k, double later) {
    double overlap = b->overlap[k] + later * 0.5 * w->wants.step * b->closing[k];
    const struct scree_friction_law *law = scree_friction_laws[w->rule->friction];
    return law->stiffness(&w->rule->friction_constants, friction_pair_at(w->pair, k), overlap);
}

/* The force since a touch over what the last stiffness would make of the way since then, where it grows with the
 * overlap like a root, at constant speeds. */
static double grown_share(const struct work *w) {
    double root = scree_friction_laws[w->rule->friction]->root;
    return root / (root + 1.0);
}

/* As begin_stretches: before the law, which adds what the stiffness in the middle of the first half makes of that half.
 * A slider that should hold would break loose by mistake without this, at any step. Returns the lanes that begin. */
static uint32_t begin_forces(const struct work *w, struct block *b, int count) {
    double half = 0.5 * w->wants.step, share = grown_share(w);
    uint32_t begins = 0;
    for (int k = 0; k < count; k++) {
        double met = b->half_steps_in[k];
        if (!(met > 0.0 && met <= 2.0 && b->closing[k] > 0.0) || vec_norm2(get_kept(w->kept, k)) > 0.0) continue;
        double since_touch = share * met * stiffness_at(w, b, k, 0.0), by_law = stiffness_at(w, b, k, -0.5);
        put_kept(w->kept, k, vec_scale(half * (since_touch - by_law), get(b->slip, k)));
        begins |= (uint32_t)1 << k;
    }
    return begins;
}

/* What they keep at the end of the step if they hold. */
static void end_forces(const struct work *w, struct block *b, int count, uint32_t begins) {
    double half = 0.5 * w->wants.step, share = grown_share(w);
    for (int k = 0; k < count; k++)
        if (begins >> k & 1 && b->touching[k] > 0.0 && !(b->state[k] > 0.0))
            put_kept(
                w->kept, k,
                kept_while(half * share * (b->half_steps_in[k] + 1.0) * stiffness_at(w, b, k, 1.0), get(b->slip, k)));
}

/* All of the normal forces is kept in `whole`. */
static void bear_in_part(struct block *b, int count, const struct bearing *bearing, double *whole) {
    for (int k = 0; k < padded(count); k++) {
        whole[k] = b->force[k];
        b->force[k] = whole[k] * bearing->borne[k] - bearing->relief[k];
    }
}

/* From gathered columns on, all passes but the last; `events`: as seen in meeting. */
static void press(struct work *w, int first, int count, int events, struct block *b) {
    const struct scree_rule *rule = w->rule;
    const struct scree_batch *batch = w->batch;
    double step = w->wants.step;
    if (batch->slides) unpack(batch->slides + first, count, b->state);
    if (events & CHANGES) share_out(count, step, b);
    if (w->balls && w->rubs)
        slide_balls(b, count, w->kept, w->wants);
    else if (w->balls && w->wants.takes_roots)
        find_fourth_roots(b, count);
    else if (w->wants.remembers)
        turn_stretches(b, count, step, w->kept);
    normal_passes[rule->normal](b, count, &rule->normal_constants, w->pair, w->kept, step);
    double whole[SCREE_LANES];
    if (w->bearing) bear_in_part(b, count, w->bearing, whole);
    if (w->bends && events & CHANGES) begin_stretches(b, count, step, w->kept);
    uint32_t begins = w->in_force && events & CHANGES ? begin_forces(w, b, count) : 0;
    if (rule->friction >= 0)
        friction_passes[rule->friction](b, count, &rule->friction_constants, w->pair, w->kept, step);
    if (begins) end_forces(w, b, count, begins);
    if (w->slides) {
        if (events & CHANGES) begin_stretches(b, count, step, w->kept);
        try_sliders(b, count, w->kept);
        end_sliders(b, count, w->kept);
    }
    if (rule->rolling >= 0 && events & CHANGES && scree_rolling_laws[rule->rolling]->memory)
        begin_turning(b, count, step, w->pair, w->kept + SCREE_KEPT_ROLLING);
    if (rule->rolling >= 0) rolling_passes[rule->rolling](b, count, &rule->rolling_constants, w->pair, w->kept, step);
    if (batch->slides) pack(b->state, count, batch->slides + first);
    if (w->bearing) memcpy(b->force, whole, (size_t)padded(count) * sizeof *whole);
}

#endif
