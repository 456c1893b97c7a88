/* The contact loop: blocks of contacts go through short passes over columns that stay in the L1 cache,
 *   fetch      body records, subtracted row by row
 *   meet       normal and overlap
 *   move       arms, relative velocity (two balls: with `meet`)
 *   normal     the normal law
 *   friction   the friction law with its memory
 *   rolling    the rolling law with its memory, where there is one
 *   yield      impulses on both bodies
 * Each law makes one pass from its inline function, so there are as many loops as laws, not as products of laws;
 * choices are made per batch, never per contact. This file is compiled once for each kind of processor
 * (contact/meson.build), and uses nothing that could make a difference in a bit. */
#include "contact/loop.h"
#include "contact/block.h"
#include "contact/law_list.h"

#include <string.h>

/* ---- laws ---- */

typedef void law_pass(struct block *b, int count, const struct scree_law_constants *law, const double *const *pair,
                      double *const *kept, double step);

/* What a force that is there at once, not growing from zero, adds in a step in which bodies meet or part: its share of
 * the step, less what the law says of the middle of the step (`touching`). */
static SCREE_INLINE double jump_of(const struct scree_normal_law *normal, const struct scree_law_constants *constants,
                                   struct scree_pair_constants pair, struct scree_pressing at, double touching,
                                   double share, double step) {
    int held = normal->reach && at.second > 0.0; /* parting is farther off then */
    if (normal->reach && held == (at.closing > 0.0)) return 0.0;
    if (held) share = share_of(at.overlap + normal->reach(constants, pair), at.closing, step);
    return (share - touching) * normal->jump(constants, pair, held);
}

/* One pass per normal law, from its inline function. A dashpot acts at full strength from the first touch on, so a step
 * in which bodies meet or part gets the share of it that they touch: without this the scheme is of first order. The
 * spring is left as it is: there the mid-step rule is of second order already, and reversible. What touches is looked
 * up, not compared again: a second comparison would make a branch of the law, and no vector. */
#define NORMAL_PASS(word)                                                                                              \
    static SCREE_INLINE void normal_at_##word(struct block *b, int k, const struct scree_law_constants *constants,     \
                                              const double *const *pair, double *const *kept, double step) {           \
        double *const *own = kept + SCREE_KEPT_NORMAL;                                                                 \
        struct scree_pair_constants of_pair = {{pair[0][k], pair[1][k], pair[2][k], pair[3][k]}};                      \
        struct scree_pressing at = {b->overlap[k], b->closing[k], 0.0, 0.0};                                           \
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
    }                                                                                                                  \
    static void normal_pass_##word(struct block *b, int count, const struct scree_law_constants *law,                  \
                                   const double *const *pair, double *const *kept, double step) {                      \
        struct scree_law_constants constants = *law;                                                                   \
        _Pragma("omp simd")                                                                                            \
        for (int k = 0; k < padded(count); k++) normal_at_##word(b, k, &constants, pair, kept, step);                  \
    }
SCREE_NORMAL_LAWS(NORMAL_PASS)

/* One pass per friction law. The memory belongs to the ends of steps, the velocity to their middle. */
#define FRICTION_PASS(word)                                                                                            \
    static SCREE_INLINE void friction_at_##word(struct block *b, int k, const struct scree_law_constants *constants,   \
                                                const double *const *pair, double *const *kept, double half) {         \
        double normal = b->force[k] > 0.0 ? b->force[k] : 0.0;                                                         \
        struct scree_pair_constants of_pair = {                                                                        \
            {pair[SCREE_PAIR_FRICTION][k], pair[SCREE_PAIR_FRICTION + 1][k], 0.0, 0.0}};                               \
        struct scree_sliding at = {.normal = normal, .overlap = b->overlap[k], .half = half};                          \
        at.closing = b->closing[k];                                                                                    \
        at.velocity = get(b->slip, k);                                                                                 \
        if (scree_friction_##word.memory) {                                                                            \
            at.stretch = scree_into_tangent_plane(vec(kept[0][k], kept[1][k], kept[2][k]), get(b->n, k));              \
            at.sliding = kept[3][k];                                                                                   \
        }                                                                                                              \
        struct scree_tangential f = friction_##word##_force(constants, of_pair, at);                                   \
        put(b->friction, k, f.force);                                                                                  \
        if (scree_friction_##word.memory) {                                                                            \
            put_kept(kept, k, vec_scale(b->touching[k], f.stretch));                                                   \
            kept[3][k] = b->touching[k] * f.sliding;                                                                   \
        }                                                                                                              \
    }                                                                                                                  \
    static void friction_pass_##word(struct block *b, int count, const struct scree_law_constants *law,                \
                                     const double *const *pair, double *const *kept, double step) {                    \
        struct scree_law_constants constants = *law;                                                                   \
        double half = 0.5 * step;                                                                                      \
        _Pragma("omp simd")                                                                                            \
        for (int k = 0; k < padded(count); k++) friction_at_##word(b, k, &constants, pair, kept, half);                \
    }
SCREE_FRICTION_LAWS(FRICTION_PASS)

/* Pairs of laws that often go together make one pass more, in which they share what both need (the root of the
 * overlap). */
#define COMMON_PAIRS(PAIR) PAIR(tsuji, mindlin) PAIR(tsuji_cut, mindlin) PAIR(hertz, mindlin)
#define COMMON_PASS(one, other)                                                                                        \
    static void common_pass_##one##_##other(struct block *b, int count, const struct scree_rule *rule,                 \
                                            const double *const *pair, double *const *kept, double step) {             \
        struct scree_law_constants normal = rule->normal_constants, friction = rule->friction_constants;               \
        double half = 0.5 * step;                                                                                      \
        _Pragma("omp simd")                                                                                            \
        for (int k = 0; k < padded(count); k++) {                                                                      \
            normal_at_##one(b, k, &normal, pair, kept, step);                                                          \
            friction_at_##other(b, k, &friction, pair, kept, half);                                                    \
        }                                                                                                              \
    }
COMMON_PAIRS(COMMON_PASS)

#define ENTRY(one, other) {NORMAL_##one, FRICTION_##other, common_pass_##one##_##other},
static const struct {
    int normal, friction;
    void (*pass)(struct block *b, int count, const struct scree_rule *rule, const double *const *pair,
                 double *const *kept, double step);
} common[] = {COMMON_PAIRS(ENTRY)};
#undef ENTRY

/* Columns for the rolling laws: lever x angular velocity of the ball against the host, m/s. */
static inline struct vec turning_at(const struct block *b, int k, double lever) {
    return vec_scale(lever, vec(b->ball_spin[0][k] - b->host_spin[0][k], b->ball_spin[1][k] - b->host_spin[1][k],
                                b->ball_spin[2][k] - b->host_spin[2][k]));
}

/* One pass per rolling law: rolling, then twisting, at the lever of the pair. */
#define ROLLING_PASS(word)                                                                                             \
    static void rolling_pass_##word(struct block *b, int count, const struct scree_law_constants *law,                 \
                                    const double *const *pair, double *const *kept, double step) {                     \
        struct scree_law_constants constants = *law;                                                                   \
        double *const *own = kept + SCREE_KEPT_ROLLING;                                                                \
        _Pragma("omp simd")                                                                                            \
        for (int k = 0; k < padded(count); k++) {                                                                      \
            double lever = pair[SCREE_PAIR_LEVER][k];                                                                  \
            struct vec n = vec(b->n[0][k], b->n[1][k], b->n[2][k]), velocity = turning_at(b, k, lever);                \
            double along = vec_dot(velocity, n);                                                                       \
            struct scree_sliding rolling = {.normal = b->force[k] > 0.0 ? b->force[k] : 0.0,                           \
                                            .overlap = b->overlap[k],                                                  \
                                            .half = 0.5 * step,                                                        \
                                            .velocity = vec_axpy(velocity, -along, n)};                                \
            struct scree_sliding twisting = rolling;                                                                   \
            twisting.velocity = vec(along, 0.0, 0.0);                                                                  \
            if (scree_rolling_##word.memory) {                                                                         \
                rolling.stretch = scree_into_tangent_plane(vec(own[0][k], own[1][k], own[2][k]), n);                   \
                rolling.sliding = own[3][k];                                                                           \
                twisting.stretch = vec(own[4][k], 0.0, 0.0);                                                           \
                twisting.sliding = own[5][k];                                                                          \
            }                                                                                                          \
            struct scree_tangential r =                                                                                \
                rolling_##word##_resist(&constants, constants.c[SCREE_ROLLING_COEFFICIENT], rolling);                  \
            struct scree_tangential s =                                                                                \
                rolling_##word##_resist(&constants, constants.c[SCREE_TWISTING_COEFFICIENT], twisting);                \
            put(b->torque, k, vec_scale(lever, vec_axpy(r.force, s.force.x, n)));                                      \
            b->power[k] = -(vec_dot(r.force, rolling.velocity) + s.force.x * along);                                   \
            if (scree_rolling_##word.memory) {                                                                         \
                put_kept(own, k, vec_scale(b->touching[k], r.stretch));                                                \
                own[3][k] = b->touching[k] * r.sliding;                                                                \
                own[4][k] = b->touching[k] * s.stretch.x;                                                              \
                own[5][k] = b->touching[k] * s.sliding;                                                                \
            }                                                                                                          \
        }                                                                                                              \
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

/* ---- what comes out ---- */

/* What a contact does to its bodies: a constant for each loop over contacts. */
enum { RUBS = 1, TURNS = 2, ROLLS = 4, BALLS = 8 };

static inline int deeds_of(const struct scree_batch *batch, const struct scree_rule *rule) {
    int balls = batch->geometry == SCREE_BALL_BALL || batch->geometry == SCREE_BALL_IMAGE ? BALLS : 0;
    if (rule->rolling >= 0) return balls | TURNS | ROLLS | (rule->friction >= 0 ? RUBS : 0);
    if (rule->friction >= 0) return balls | TURNS | RUBS;
    return batch->any_turns ? TURNS : 0; /* without friction a ball at the centre of its body can't turn it */
}

/* Impulse and angular impulses of one contact. */
struct kick {
    struct vec impulse, turn_ball, turn_host;
};

static SCREE_INLINE struct kick kick_of(const struct block *b, int k, double step, int deeds) {
    struct kick kick = {{0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}};
    struct vec n = vec(b->n[0][k], b->n[1][k], b->n[2][k]), j = vec_scale(step * b->force[k], n);
    if (deeds & RUBS) j = vec_axpy(j, step, vec(b->friction[0][k], b->friction[1][k], b->friction[2][k]));
    kick.impulse = j;
    if (deeds & TURNS && deeds & BALLS) {
        struct vec turn = vec_cross(n, j);
        kick.turn_ball = vec_scale(-b->lever[0][k], turn);
        kick.turn_host = vec_scale(-b->lever[1][k], turn);
    } else if (deeds & TURNS) {
        struct vec arm = vec(b->arm[0][k], b->arm[1][k], b->arm[2][k]);
        struct vec reach = vec_add(arm, vec(b->shift[0][k], b->shift[1][k], b->shift[2][k]));
        kick.turn_ball = vec_cross(arm, j);
        kick.turn_host = vec_cross(j, reach);
    }
    if (deeds & ROLLS) {
        struct vec torque = vec(b->torque[0][k], b->torque[1][k], b->torque[2][k]);
        kick.turn_ball = vec_axpy(kick.turn_ball, step, torque);
        kick.turn_host = vec_sub(kick.turn_host, vec_scale(step, torque));
    }
    return kick;
}

/* CALL(deeds), with each value that these can have as a constant. */
#define FOR_DEEDS(deeds, CALL)                                                                                         \
    switch (deeds) {                                                                                                   \
    case 0:                                                                                                            \
        CALL(0);                                                                                                       \
        break;                                                                                                         \
    case TURNS:                                                                                                        \
        CALL(TURNS);                                                                                                   \
        break;                                                                                                         \
    case RUBS | TURNS:                                                                                                 \
        CALL(RUBS | TURNS);                                                                                            \
        break;                                                                                                         \
    case RUBS | TURNS | BALLS:                                                                                         \
        CALL(RUBS | TURNS | BALLS);                                                                                    \
        break;                                                                                                         \
    case TURNS | ROLLS:                                                                                                \
        CALL(TURNS | ROLLS);                                                                                           \
        break;                                                                                                         \
    case TURNS | ROLLS | BALLS:                                                                                        \
        CALL(TURNS | ROLLS | BALLS);                                                                                   \
        break;                                                                                                         \
    case RUBS | TURNS | ROLLS:                                                                                         \
        CALL(RUBS | TURNS | ROLLS);                                                                                    \
        break;                                                                                                         \
    default:                                                                                                           \
        CALL(RUBS | TURNS | ROLLS | BALLS);                                                                            \
        break;                                                                                                         \
    }

static SCREE_INLINE void write_kicks(const struct block *b, int count, double step, int deeds,
                                     struct scree_yield *yield) {
    _Pragma("omp simd")
    for (int k = 0; k < padded(count); k++) {
        struct kick kick = kick_of(b, k, step, deeds);
        put(yield->impulse, k, kick.impulse);
        if (!(deeds & TURNS)) continue;
        put(yield->turn_ball, k, kick.turn_ball);
        put(yield->turn_host, k, kick.turn_host);
    }
}

static void write_yield(const struct block *b, int count, const struct scree_batch *batch, int deeds, double step,
                        struct scree_yield *yield) {
#define WRITE(constant) write_kicks(b, count, step, constant, yield)
    FOR_DEEDS(deeds, WRITE)
#undef WRITE
    _Pragma("omp simd")
    for (int k = 0; k < padded(count); k++) {
        double limit = b->ball_spin[3][k] < b->host_spin[3][k] ? b->ball_spin[3][k] : b->host_spin[3][k];
        yield->depth[k] = b->overlap[k] / limit;
        /* A ball's rotation makes it 3.5 times as soft as its mass, four corners that share a load four times. */
        yield->steep[k] = step * batch->slope * b->force[k] * (4.0 * b->rush[3][k]);
    }
}

static void measure_losses(const struct block *b, int count, const struct scree_rule *rule, double step,
                           struct scree_losses *lost) {
    for (int k = 0; k < count; k++) {
        lost->normal[k] = step * (b->force[k] - b->reversible[k]) * b->closing[k];
        lost->tangential[k] = 0.0;
    }
    for (int k = 0; scree_normal_laws[rule->normal]->reach && k < count; k++) lost->normal[k] += b->snap[k];
    for (int k = 0; rule->friction >= 0 && k < count; k++)
        lost->tangential[k] -= step * (b->friction[0][k] * b->slip[0][k] + b->friction[1][k] * b->slip[1][k] +
                                       b->friction[2][k] * b->slip[2][k]);
    for (int k = 0; rule->rolling >= 0 && k < count; k++) lost->tangential[k] += step * b->power[k];
}

static void press_and_rub(struct block *b, int count, const struct scree_rule *rule, const double *const *pair,
                          double *const *kept, double step) {
    for (size_t c = 0; c < sizeof common / sizeof *common; c++)
        if (common[c].normal == rule->normal && common[c].friction == rule->friction) {
            common[c].pass(b, count, rule, pair, kept, step);
            return;
        }
    normal_passes[rule->normal](b, count, &rule->normal_constants, pair, kept, step);
    if (rule->friction >= 0) friction_passes[rule->friction](b, count, &rule->friction_constants, pair, kept, step);
}

/* The stretch of a slider's spring counts from the touch, not from the beginning of the step in which bodies meet:
 * without this friction is of first order. Until the middle of the step, to which the laws add half of it, that is
 * overlap/closing. */
static void begin_stretches(const struct block *b, int count, double step, double *const *kept) {
    for (int k = 0; k < count; k++) {
        if (!(b->overlap[k] > 0.0 && b->overlap[k] < step * b->closing[k])) continue;
        if (kept[0][k] != 0.0 || kept[1][k] != 0.0 || kept[2][k] != 0.0) continue;
        double since = b->overlap[k] / b->closing[k] - 0.5 * step;
        for (int axis = 0; axis < 3; axis++) kept[axis][k] = since * b->slip[axis][k];
    }
}

/* Friction's state, kept in bytes, to a column and back. */
static void unpack(const unsigned char *slides, int count, double *state) {
    _Pragma("omp simd")
    for (int k = 0; k < padded(count); k++) state[k] = slides[k];
}

static void pack(const double *state, int count, unsigned char *slides) {
    _Pragma("omp simd")
    for (int k = 0; k < padded(count); k++) slides[k] = (unsigned char)state[k];
}

/* From gathered columns on, all passes but the last. */
static void press_gathered(const struct scree_contacts *contacts, const struct scree_batch *batch, int first, int count,
                           double step, struct block *b) {
    const struct scree_rule *rule = &contacts->rule[batch->rule];
    const double *pair[SCREE_PAIR_COLUMNS];
    double *kept[SCREE_MEMORY];
    for (int c = 0; c < SCREE_PAIR_COLUMNS; c++) pair[c] = batch->pair[c] + (batch->uniform ? 0 : first);
    for (int m = 0; m < SCREE_MEMORY; m++) kept[m] = batch->kept[m] ? batch->kept[m] + first : NULL;
    if (batch->slides) unpack(batch->slides + first, count, kept[SCREE_KEPT_STATE] = b->state);
    if (some_meet_or_part(b, count, step)) {
        const struct scree_friction_law *friction = rule->friction >= 0 ? scree_friction_laws[rule->friction] : NULL;
        share_out(count, step, b);
        if (friction && friction->slider && !friction->in_force) begin_stretches(b, count, step, kept);
    }
    press_and_rub(b, count, rule, pair, kept, step);
    if (rule->rolling >= 0) rolling_passes[rule->rolling](b, count, &rule->rolling_constants, pair, kept, step);
    if (batch->slides) pack(b->state, count, batch->slides + first);
}

/* The last pass. */
static void finish(const struct scree_contacts *contacts, const struct scree_batch *batch, const struct block *b,
                   int count, double step, struct scree_yield *yield) {
    const struct scree_rule *rule = &contacts->rule[batch->rule];
    write_yield(b, count, batch, deeds_of(batch, rule), step, yield);
    if (contacts->measured) measure_losses(b, count, rule, step, &yield->lost);
}

/* ---- edges on edges ---- */

/* A block without touch: laws forget what they have kept. */
static void stay_silent(const struct scree_batch *batch, int first, int count) {
    for (int m = 0; m < SCREE_MEMORY; m++)
        if (batch->kept[m]) memset(batch->kept[m] + first, 0, (size_t)padded(count) * sizeof(double));
    if (batch->slides) memset(batch->slides + first, 0, (size_t)padded(count));
}

/* The rest of what edges on edges do, on top of what the middle of the overlap yields. */
static void act_leaning(const struct block *b, const struct lean *lean, int count, double step,
                        struct scree_yield *yield) {
    for (int axis = 0; axis < 3; axis++)
        for (int k = 0; k < count; k++) {
            double f = step * b->force[k];
            if (f == 0.0) continue;
            yield->impulse[axis][k] += f * lean->force[axis][k];
            yield->turn_ball[axis][k] += f * lean->turn_ball[axis][k];
            yield->turn_host[axis][k] += f * lean->turn_host[axis][k];
        }
}

static void act_edges(const struct scree_contacts *contacts, const struct scree_bodies *bodies,
                      const struct scree_batch *batch, int first, int count, double step, struct scree_yield *yield) {
    struct block b;
    struct lean lean;
    yield->silent = !gather_crossings(bodies, batch, first, count, step, &b, &lean);
    if (yield->silent) {
        stay_silent(batch, first, count);
        return;
    }
    press_gathered(contacts, batch, first, count, step, &b);
    finish(contacts, batch, &b, count, step, yield);
    act_leaning(&b, &lean, count, step, yield);
}

static void act(const struct scree_contacts *contacts, const struct scree_bodies *bodies,
                const struct scree_batch *batch, int first, int count, double step, struct scree_yield *yield) {
    struct block b;
    struct lean lean;
    if (batch->geometry == SCREE_EDGE_EDGE) {
        act_edges(contacts, bodies, batch, first, count, step, yield);
        return;
    }
    struct ends ends;
    struct scree_contact contact[SCREE_LANES];
    name_contacts(batch, first, count, contact);
    find_ends(bodies, batch->ends + first, count, &ends);
    gather(bodies, contact, &ends, count, batch->geometry, &b);
    int deep = batch->geometry == SCREE_BALL_BOX && deepen_corners(bodies, contact, count, &b, &lean);
    press_gathered(contacts, batch, first, count, step, &b);
    finish(contacts, batch, &b, count, step, yield);
    if (deep) act_leaning(&b, &lean, count, step, yield);
}

/* ---- straight into the bodies ---- */

/* Columns of impulses and angular impulses on the ball, and what is taken from the host: angular impulses with the
 * other sign. Fourth columns are zero. */
struct kicks {
    _Alignas(64) double impulse[4][SCREE_LANES];
    double turn_ball[4][SCREE_LANES], turn_host[4][SCREE_LANES];
};

/* Two balls that don't roll on torques of their own are turned along one direction, each by its lever: `turn_ball` is
 * that. */
static inline int by_levers(int deeds) { return deeds & TURNS && deeds & BALLS && !(deeds & ROLLS); }

static SCREE_INLINE void make_kicks(const struct block *b, int count, double step, int deeds, struct kicks *kicks) {
    _Pragma("omp simd")
    for (int k = 0; k < padded(count); k++) {
        struct kick kick = kick_of(b, k, step, deeds);
        put(kicks->impulse, k, kick.impulse);
        struct vec n = vec(b->n[0][k], b->n[1][k], b->n[2][k]);
        put(kicks->turn_ball, k, by_levers(deeds) ? vec_cross(n, kick.impulse) : kick.turn_ball);
        if (!by_levers(deeds)) put(kicks->turn_host, k, vec_scale(-1.0, kick.turn_host));
    }
}

/* Add the kicks of a block to its bodies. `hosts`: partners are pushed too; else they are frozen, and several slabs
 * have them in common. */
#if defined __AVX512F__
static SCREE_INLINE void load_kicks(double (*impulse)[SCREE_LANES], double (*turn)[SCREE_LANES], int lane,
                                    wide_row r[8]) {
    const wide_row none = {0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0};
    for (int i = 0; i < 3; i++) r[i] = *(const wide_row *)&impulse[i][lane];
    for (int i = 0; i < 3; i++) r[4 + i] = *(const wide_row *)&turn[i][lane];
    r[3] = r[7] = none;
    transpose_wide(r);
}

static SCREE_INLINE wide_row with_lever(double lever) {
    return (wide_row){1.0, 1.0, 1.0, 1.0, lever, lever, lever, lever};
}

static SCREE_INLINE void add_kicks(const struct ends *ends, const struct block *b, int count, int hosts, int deeds,
                                   struct kicks *kicks) {
    for (int lane = 0; lane < count; lane += 8) {
        wide_row on_ball[8], on_host[8];
        load_kicks(kicks->impulse, kicks->turn_ball, lane, on_ball);
        if (hosts && !by_levers(deeds)) load_kicks(kicks->impulse, kicks->turn_host, lane, on_host);
        for (int i = 0; i < 8 && lane + i < count; i++) {
            wide_row *ball = (wide_row *)ends->ball[lane + i]->f, *host = (wide_row *)ends->host[lane + i]->f;
            if (by_levers(deeds)) {
                *ball += on_ball[i] * with_lever(-b->lever[0][lane + i]);
                if (hosts) *host -= on_ball[i] * with_lever(b->lever[1][lane + i]);
            } else {
                *ball += on_ball[i];
                if (hosts) *host -= on_host[i];
            }
        }
    }
}
#elif defined __AVX__
static SCREE_INLINE void load_kicks(double (*column)[SCREE_LANES], int lane, scree_row r[4]) {
    for (int i = 0; i < 3; i++) r[i] = *(scree_row *)&column[i][lane];
    r[3] = (scree_row){0.0, 0.0, 0.0, 0.0};
    transpose(r);
}

static SCREE_INLINE void add_kicks(const struct ends *ends, const struct block *b, int count, int hosts, int deeds,
                                   struct kicks *kicks) {
    for (int lane = 0; lane < count; lane += 4) {
        scree_row impulse[4], turn_ball[4], turn_host[4];
        load_kicks(kicks->impulse, lane, impulse);
        if (deeds & TURNS) load_kicks(kicks->turn_ball, lane, turn_ball);
        if (deeds & TURNS && hosts && !by_levers(deeds)) load_kicks(kicks->turn_host, lane, turn_host);
        for (int i = 0; i < 4 && lane + i < count; i++) {
            struct scree_record *ball = ends->ball[lane + i], *host = ends->host[lane + i];
            *(scree_row *)ball->f += impulse[i];
            if (hosts) *(scree_row *)host->f -= impulse[i];
            if (by_levers(deeds)) {
                *(scree_row *)ball->t += scree_row_times(-b->lever[0][lane + i], turn_ball[i]);
                if (hosts) *(scree_row *)host->t -= scree_row_times(b->lever[1][lane + i], turn_ball[i]);
            } else if (deeds & TURNS) {
                *(scree_row *)ball->t += turn_ball[i];
                if (hosts) *(scree_row *)host->t -= turn_host[i];
            }
        }
    }
}
#else
static SCREE_INLINE void add_kicks(const struct ends *ends, const struct block *b, int count, int hosts, int deeds,
                                   struct kicks *kicks) {
    for (int lane = 0; lane < count; lane++) {
        struct scree_record *ball = ends->ball[lane], *host = ends->host[lane];
        for (int k = 0; k < 3; k++) {
            ball->f[k] += kicks->impulse[k][lane];
            if (hosts) host->f[k] -= kicks->impulse[k][lane];
            if (by_levers(deeds)) {
                ball->t[k] += -b->lever[0][lane] * kicks->turn_ball[k][lane];
                if (hosts) host->t[k] -= b->lever[1][lane] * kicks->turn_ball[k][lane];
            } else if (deeds & TURNS) {
                ball->t[k] += kicks->turn_ball[k][lane];
                if (hosts) host->t[k] -= kicks->turn_host[k][lane];
            }
        }
    }
}
#endif

static SCREE_INLINE void push_as(const struct ends *ends, const struct block *b, int count, int hosts, int deeds,
                                 double step) {
    struct kicks kicks;
    make_kicks(b, count, step, deeds, &kicks);
    if (hosts)
        add_kicks(ends, b, count, 1, deeds, &kicks);
    else
        add_kicks(ends, b, count, 0, deeds, &kicks);
}

static void push(const struct ends *ends, const struct block *b, int count, const struct scree_batch *batch, int deeds,
                 double step) {
    int hosts = batch->geometry == SCREE_BALL_BALL;
#define PUSH(constant) push_as(ends, b, count, hosts, constant, step)
    FOR_DEEDS(deeds, PUSH)
#undef PUSH
}

/* The deepest overlap; a block without one that can be deeper than those before is done with quickly. */
static void note_depths(const struct block *b, const struct scree_ends *own, int count, struct scree_tally *tally) {
    double most = tally->deepest * (1.0 - 1e-14); /* below it, rounding included, nothing is deeper */
    int deeper = 0;
    _Pragma("omp simd reduction(| : deeper)")
    for (int k = 0; k < padded(count); k++) deeper |= !(b->overlap[k] <= most * limit_of(b, k));
    for (int k = 0; deeper && k < count; k++) {
        double depth = b->overlap[k] / limit_of(b, k);
        if (depth <= tally->deepest) continue;
        tally->deepest = depth;
        tally->deepest_ball = own[k].ball;
        tally->deepest_host = own[k].host;
    }
}

static void note_losses(const struct block *b, int count, const struct scree_rule *rule, double step,
                        struct scree_tally *tally) {
    struct scree_losses lost;
    measure_losses(b, count, rule, step, &lost);
    scree_tally_losses(tally, &lost, count);
}

/* The steepest friction, of laws that have a slope. */
static void note_slopes(const struct block *b, const struct scree_ends *own, int count, double slope, double step,
                        struct scree_tally *tally) {
    for (int k = 0; k < count; k++) {
        double steep = step * slope * b->force[k] * (4.0 * b->rush[3][k]);
        if (steep <= tally->steepest) continue;
        tally->steepest = steep;
        tally->steepest_ball = own[k].ball;
        tally->steepest_host = own[k].host;
    }
}

/* So that it is at hand later. */
static SCREE_INLINE void call(const void *array, size_t offset, size_t size) {
    for (size_t line = 0; line < size; line += 64)
        __builtin_prefetch((const void *)((uintptr_t)array + offset + line), 1);
}

/* A quarter of what the blocks to come need is asked for after each pass: bodies of the next one, contacts and memory
 * of the one after. Asked for at once it would wait in a queue, and the passes behind it. */
enum { QUARTER = SCREE_LANES / 4 };
static SCREE_INLINE void call_ahead(const struct scree_batch *batch, int first, const struct ends *next, int left,
                                    int quarter) {
    int from = quarter * QUARTER, to = left < from + QUARTER ? left : from + QUARTER;
    size_t later = (size_t)(first + 2 * SCREE_LANES + from);
    for (int k = from; k < to; k++) {
        call(next->host[k], 0, sizeof *next->host[k]);
        call(next->ball[k], 0, sizeof *next->ball[k]);
    }
    call(batch->ends, later * sizeof *batch->ends, QUARTER * sizeof *batch->ends);
    for (int m = 0; m < SCREE_MEMORY; m++)
        if (batch->kept[m]) call(batch->kept[m], later * sizeof(double), QUARTER * sizeof(double));
    if (batch->slides && quarter == 0) call(batch->slides, later, 1);
}

/* ---- bodies ---- */

enum { FAR = 24 }; /* bodies between one that moves and the one whose state is asked for; records are at hand */

/* In two passes over some bodies at a time: a root at the end of each body's chain would hold up the next. */
static int move_some(struct scree_bodies *bodies, int from, int count, const struct scree_departure *go) {
    double square[SCREE_LANES], way[SCREE_LANES];
    scree_row gravity = scree_row_of(go->gravity), next = scree_row_of(go->next_gravity);
    int too_far = 0;
    for (int k = 0; k < count; k++) {
        struct scree_record *record = &bodies->record[from + k];
        call(&bodies->state[from + k], FAR * sizeof *bodies->state, sizeof *bodies->state);
        square[k] = 0.0;
        if (bodies->class[from + k] == SCREE_CLASS_ASLEEP) continue;
        if (bodies->class[from + k] != SCREE_CLASS_BALL) {
            memset(record->f, 0, sizeof record->f);
            memset(record->t, 0, sizeof record->t);
            continue;
        }
        struct scree_state *state = &bodies->state[from + k];
        struct scree_ball_rows rows = scree_ball_advance(record, state, go->step, gravity);
        if (go->ahead)
            square[k] = scree_ball_look_ahead(record, rows, go->step, next, scree_flight_row(bodies, from + k));
        else
            scree_ball_stay(rows, bodies->position[from + k]);
    }
    if (!go->ahead) return 0;
    _Pragma("omp simd")
    for (int k = 0; k < count; k++) way[k] = go->step * sqrt(square[k]);
    for (int k = 0; k < count; k++) too_far |= scree_outgrown(&bodies->record[from + k], way[k], go->margin);
    return too_far;
}

static int all_sleep(const struct scree_bodies *bodies, int from, int count) {
    int awake = 0;
    for (int k = from; k < from + count; k++) awake |= bodies->class[k] != SCREE_CLASS_ASLEEP;
    return !awake;
}

static int move(struct scree_bodies *bodies, int from, int to, const struct scree_departure *go) {
    int too_far = 0;
    for (int k = from; k < to; k += SCREE_LANES) {
        int count = to - k < SCREE_LANES ? to - k : SCREE_LANES;
        if (!bodies->calm || !all_sleep(bodies, k, count)) too_far |= move_some(bodies, k, count, go);
    }
    return too_far;
}

/* ---- one slab ---- */

/* Bodies before place `first` move on, a block of them at a time. Inlined, it would take registers from the
 * contacts. */
static __attribute__((noinline)) void follow(struct scree_bodies *bodies, int first, struct scree_trail *trail,
                                             struct scree_tally *tally) {
    for (; trail->next + SCREE_LANES <= first; trail->next += SCREE_LANES)
        tally->too_far |= move_some(bodies, trail->next, SCREE_LANES, trail->go);
}

static void act_straight(const struct scree_contacts *contacts, struct scree_bodies *bodies,
                         const struct scree_batch *batch, int first, int count, double step, struct scree_tally *tally,
                         struct scree_trail *trail) {
    struct block b;
    struct ends ends[2];
    const struct scree_rule *rule = &contacts->rule[batch->rule];
    const struct scree_ends *own = batch->ends + first;
    struct scree_contact contact[SCREE_LANES];
    int deeds = deeds_of(batch, rule), turn = 0;
    find_ends(bodies, own, count < SCREE_LANES ? count : SCREE_LANES, &ends[turn]);
    for (int done = 0; done < count; done += SCREE_LANES, own += SCREE_LANES, turn = !turn) {
        int here = count - done < SCREE_LANES ? count - done : SCREE_LANES;
        int left = count - done - here < SCREE_LANES ? count - done - here : SCREE_LANES;
        const struct ends *next = &ends[!turn];
        if (left) find_ends(bodies, own + here, left, &ends[!turn]);
        call_ahead(batch, first + done, next, left, 0);
        name_contacts(batch, first + done, here, contact);
        gather(bodies, contact, &ends[turn], here, batch->geometry, &b);
        call_ahead(batch, first + done, next, left, 1);
        press_gathered(contacts, batch, first + done, here, step, &b);
        call_ahead(batch, first + done, next, left, 2);
        push(&ends[turn], &b, here, batch, deeds, step);
        call_ahead(batch, first + done, next, left, 3);
        note_depths(&b, own, here, tally);
        if (batch->slope != 0.0) note_slopes(&b, own, here, batch->slope, step, tally);
        if (contacts->measured) note_losses(&b, here, rule, step, tally);
        if (trail && left)
            follow(bodies, own[here].ball < own[here].host ? own[here].ball : own[here].host, trail, tally);
    }
}

#define NAME_OF(loop) #loop
#define NAMED(loop)   NAME_OF(loop)
#define PREFIX        (sizeof "scree_loop_" - 1)
const struct scree_loop SCREE_LOOP = {&NAMED(SCREE_LOOP)[PREFIX], act, act_straight, move, SCREE_PART(impel),
                                      SCREE_PART(add_up)};
