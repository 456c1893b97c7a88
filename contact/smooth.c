/* Contacts of two spheres, or of one with a plane or a frozen sphere, that go through a step of the pair-impulse method
 * several at once. What they do is what within.c does, in numbers instead of matrices (lane.h): contact begins, breaks
 * loose, turns round, ends and begins again inside the step, and each of these instants is located (march.h). Every
 * normal law that doesn't reach beyond the touch goes so, alone or with a friction law that keeps nothing or is a
 * slider (SMOOTH_SLIDERS).
 *
 * Most contacts of a bed touch all through the step, and nothing happens to them: these go straight, in loops from the
 * bodies to what is yielded. The others are drawn together. Few are left to within.c: contacts that may be pushed
 * together again after their end, those that are thrown back before they touch, and those whose law changes its formula
 * in the step other than by a turn. Rolling laws come behind, from the impulses (impulse.c). Which contacts are left,
 * and all that becomes of the others, is decided for each by its own numbers, so that no bit depends on its neighbours
 * in the list, on threads or on the processor. Compiled once for each kind of processor, as loop.c is.
 */
#include "contact/law_list.h"
#include "contact/loop.h"
#include "contact/march.h"
#include "contact/meeting.h"

#include <string.h>

/* ---- loops with a law in them ---- */

/* What reaches beyond the touch isn't smooth; what is like another law goes through the loops of that one. */
#define SMOOTH_NOT(law) ((law).reach != NULL || (law).like != NULL)

#define NORMAL_OF(word)                                                                                                \
    {                                                                                                                  \
        .press = normal_##word##_force, .stored = scree_normal_##word.stored, .cut = scree_normal_##word.cut,          \
        .memory = scree_normal_##word.memory, .raises = scree_normal_##word.raises,                                    \
        .bends = scree_normal_##word.bends, .none = SMOOTH_NOT(scree_normal_##word)                                    \
    }
#define SMOOTH_NORMAL(word)                                                                                            \
    __attribute__((flatten)) static void go_##word(const struct scree_rule *rule, const struct lane_constants *m,      \
                                                   int from, double step, struct course *c, struct rk_step *to,        \
                                                   struct squeezes *by) {                                              \
        const struct smooth_normal laws = NORMAL_OF(word);                                                             \
        struct scree_rule own = *rule;                                                                                 \
        if (laws.none) return;                                                                                         \
        SCREE_FOR_EXPONENT(laws.raises, own.normal_constants,                                                          \
                           SMOOTH_VECTOR(squeeze_step(laws, &own, m, k, step, c, to, by);));                           \
    }                                                                                                                  \
    __attribute__((flatten)) static void tick_##word(const struct scree_rule *rule, const struct lane_constants *m,    \
                                                     int from, double step, double root, struct course *c,             \
                                                     struct rk_step *to, struct squeezes *by) {                        \
        const struct smooth_normal laws = NORMAL_OF(word);                                                             \
        struct scree_rule own = *rule;                                                                                 \
        if (laws.none) return;                                                                                         \
        SCREE_FOR_EXPONENT(laws.raises, own.normal_constants,                                                          \
                           SMOOTH_VECTOR(squeeze_by_clock(laws, &own, m, k, step, root, c, to, by);));                 \
    }                                                                                                                  \
    __attribute__((flatten)) static void soon_##word(const struct scree_rule *rule, const struct lane_constants *m,    \
                                                     int from, double step, struct course *c, struct squeezes *by) {   \
        const struct smooth_normal laws = NORMAL_OF(word);                                                             \
        struct scree_rule own = *rule;                                                                                 \
        if (laws.none) return;                                                                                         \
        SCREE_FOR_EXPONENT(laws.raises, own.normal_constants, {                                                        \
            SMOOTH_VECTOR(squeeze_soon(laws, &own, m, k, step, c, SOON, by);)                                          \
            SMOOTH_VECTOR(squeeze_soon(laws, &own, m, k, step, c, SOON + 1, by);)                                      \
        });                                                                                                            \
    }                                                                                                                  \
    __attribute__((flatten)) static void rate_##word(const struct scree_rule *rule, struct lane_constants *m,          \
                                                     int from, double step, struct course *c, struct softness *to) {   \
        const struct smooth_normal laws = NORMAL_OF(word);                                                             \
        struct scree_rule own = *rule;                                                                                 \
        if (laws.none) return;                                                                                         \
        SCREE_FOR_EXPONENT(laws.raises, own.normal_constants, {                                                        \
            SMOOTH_VECTOR(soften(laws, &own, step, 0, k, c, m, to);)                                                   \
            if (any_of(to->may_deepen, from)) SMOOTH_VECTOR(soften(laws, &own, step, 1, k, c, m, to);)                 \
        });                                                                                                            \
    }                                                                                                                  \
    __attribute__((flatten)) static void store_##word(const struct scree_rule *rule, const struct lane_constants *m,   \
                                                      int from, const kept_columns kept, const double *overlap,        \
                                                      const double *closing, double *energy) {                         \
        const struct smooth_normal laws = NORMAL_OF(word);                                                             \
        struct scree_rule own = *rule;                                                                                 \
        if (laws.none) return;                                                                                         \
        SCREE_FOR_EXPONENT(laws.raises, own.normal_constants,                                                          \
                           SMOOTH_VECTOR(energy[k] = stored_at(laws, &own, m, kept, k, overlap[k], closing[k]);));     \
    }                                                                                                                  \
    __attribute__((flatten)) static void recall_##word(const struct scree_rule *rule, const struct lane_constants *m,  \
                                                       int from, int meets, struct course *c) {                        \
        const struct smooth_normal laws = NORMAL_OF(word);                                                             \
        struct scree_rule own = *rule;                                                                                 \
        if (laws.none || !laws.memory) return;                                                                         \
        SCREE_FOR_EXPONENT(laws.raises, own.normal_constants, SMOOTH_VECTOR(recall(laws, &own, m, meets, k, c);));     \
    }
SCREE_NORMAL_LAWS(SMOOTH_NORMAL)

/* Sliders that hold the same at every speed; what remembers nothing is smooth, too. What differs from mindlin_rescaled
 * by that word alone goes through its loops. */
#define SMOOTH_SLIDERS(LAW) LAW(coulomb) LAW(mindlin) LAW(mindlin_rescaled)

#define SLIDER_OF(word, is_bare, sticks)                                                                               \
    {                                                                                                                  \
        .hold = scree_friction_##word.hold, .stiffness = scree_friction_##word.stiffness,                              \
        .damping = scree_friction_##word.damping, .bare = is_bare, .all_stick = sticks,                                \
        .in_force = scree_friction_##word.in_force, .rescales = scree_friction_laws[rule->friction]->rescaled          \
    }
#define RUB_OF(word)                                                                                                   \
    {                                                                                                                  \
        .rub = friction_##word##_force, .stiffness = scree_friction_##word.stiffness,                                  \
        .damping = scree_friction_##word.damping, .all_stick = 1, .none = scree_friction_##word.memory                 \
    }

/* Loops of a kind of friction. */
#define SMOOTH_FRICTION(name, ...)                                                                                     \
    __attribute__((flatten)) static void go_##name(const struct scree_rule *rule, const struct lane_constants *m,      \
                                                   int from, double step, struct course *c, struct rk_step *to,        \
                                                   const struct squeezes *by) {                                        \
        const struct smooth_friction laws = __VA_ARGS__;                                                               \
        const struct scree_rule own = *rule;                                                                           \
        if (laws.none) return;                                                                                         \
        SMOOTH_VECTOR(rub_step(laws, &own, m, k, step, c, to, by);)                                                    \
    }                                                                                                                  \
    __attribute__((flatten)) static void tick_##name(const struct scree_rule *rule, const struct lane_constants *m,    \
                                                     int from, double step, struct course *c, struct rk_step *to,      \
                                                     const struct squeezes *by) {                                      \
        const struct smooth_friction laws = __VA_ARGS__;                                                               \
        const struct scree_rule own = *rule;                                                                           \
        if (laws.none) return;                                                                                         \
        SMOOTH_VECTOR(rub_by_clock(laws, &own, m, k, step, c, to, by);)                                                \
    }                                                                                                                  \
    __attribute__((flatten)) static void rate_##name(const struct scree_rule *rule, struct lane_constants *m,          \
                                                     int from, double slope, struct softness *to) {                    \
        const struct smooth_friction laws = __VA_ARGS__;                                                               \
        const struct scree_rule own = *rule;                                                                           \
        if (laws.none) return;                                                                                         \
        SMOOTH_VECTOR(stiffen(laws, &own, slope, k, m, to);)                                                           \
    }
#define SMOOTH_SLIDER(word)                                                                                            \
    SMOOTH_FRICTION(word##_damped, SLIDER_OF(word, 0, 0))                                                              \
    SMOOTH_FRICTION(word##_damped_stuck, SLIDER_OF(word, 0, 1))                                                        \
    SMOOTH_FRICTION(word##_bare, SLIDER_OF(word, 1, 0))                                                                \
    SMOOTH_FRICTION(word##_bare_stuck, SLIDER_OF(word, 1, 1))
#define SMOOTH_RUB(word) SMOOTH_FRICTION(word, RUB_OF(word))
SMOOTH_SLIDERS(SMOOTH_SLIDER)
SCREE_FRICTION_LAWS(SMOOTH_RUB)

#define ENTRY(word) {go_##word, tick_##word, soon_##word, rate_##word, store_##word, recall_##word},
static const struct normal_loops smooth_normals[] = {SCREE_NORMAL_LAWS(ENTRY)};
#undef ENTRY
#define LOOPS(name)                                                                                                    \
    { go_##name, tick_##name, rate_##name }
#define ENTRY(word) LOOPS(word),
static const struct friction_loops smooth_rubs[] = {SCREE_FRICTION_LAWS(ENTRY)};
#undef ENTRY
#define ENTRY(word)                                                                                                    \
    {FRICTION_##word,                                                                                                  \
     {{LOOPS(word##_damped), LOOPS(word##_damped_stuck)}, {LOOPS(word##_bare), LOOPS(word##_bare_stuck)}}},
static const struct {
    int friction;
    struct friction_loops loops[2][2]; /* with a dashpot; without; and where all sliders stick */
} smooth_sliders[] = {SMOOTH_SLIDERS(ENTRY)};
#undef ENTRY

/* NULL: there are none. `stuck`: no slider slides. */
static const struct friction_loops *friction_loops_of(int friction, int bare, int stuck) {
    if (!scree_friction_laws[friction]->memory) return &smooth_rubs[friction];
    int like = friction == FRICTION_mindlin_incremental ? FRICTION_mindlin_rescaled : friction;
    for (size_t k = 0; k < sizeof smooth_sliders / sizeof *smooth_sliders; k++)
        if (smooth_sliders[k].friction == like) return &smooth_sliders[k].loops[bare][stuck];
    return NULL;
}

/* The loops that a law goes through; NULL: none. */
static const struct normal_loops *normal_loops_of(int normal) {
    const struct scree_normal_law *law = scree_normal_laws[normal];
    int k = law->like ? 0 : normal;
    while (law->like && scree_normal_laws[k] != law->like) k++;
    return SMOOTH_NOT(*scree_normal_laws[k]) ? NULL : &smooth_normals[k];
}

static int is_bare(const struct scree_rule *rule, const struct scree_batch *batch, int first) {
    const struct scree_friction_law *friction = scree_friction_laws[rule->friction];
    struct scree_pair_constants pair = {
        {scree_pair(batch, SCREE_PAIR_FRICTION, first), scree_pair(batch, SCREE_PAIR_FRICTION + 1, first), 0.0, 0.0}};
    return scree_is_bare(friction, &rule->friction_constants, pair);
}

static struct smooth_pass smooth_pass_of(const struct scree_contacts *contacts, const struct scree_batch *batch,
                                         int first, double step) {
    const struct scree_rule *rule = &contacts->rule[batch->rule];
    const struct scree_normal_law *normal = scree_normal_laws[rule->normal];
    struct smooth_pass pass = {
        .rule = rule, .step = step, .asked = contacts->substeps > 0, .books = contacts->measured};
    int rubs = pass.rubs = rule->friction >= 0;
    pass.normal = normal_loops_of(rule->normal);
    if (!pass.normal) return pass;
    pass.cut = normal->cut;
    pass.turns = !normal->turns_smoothly;
    pass.pulls = rubs && !normal->cut;
    pass.changes = normal->memory || normal->bends || pass.turns;
    pass.pieces = pass.asked ? contacts->substeps : normal->bends ? 2 : 1;
    pass.root = normal->root;
    if (!rubs) return pass;
    const struct scree_friction_law *friction = scree_friction_laws[rule->friction];
    int slider = friction->hold != NULL, bare = slider && is_bare(rule, batch, first);
    for (int stuck = 0; stuck < 2; stuck++) pass.friction[stuck] = friction_loops_of(rule->friction, bare, stuck);
    if (!pass.friction[0]) pass.normal = NULL;
    pass.turns |= friction->rescaled;
    pass.changes |= friction->rescaled;
    pass.damped = slider && !bare;
    pass.bare = slider && bare;
    pass.slope = friction->slope(&rule->friction_constants);
    if (friction->root > pass.root) pass.root = friction->root;
    return pass;
}

/* ---- a block ---- */

/* Contacts of a kind: whether both bodies are balls, friction turns them, and they are of one size. */
struct smooth_kind {
    int balls, turns;
    struct sizes sizes;
};

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

/* Contacts of a batch in a step. */
struct smooth_work {
    const struct scree_bodies *now;
    struct scree_starts *starts;
    const struct scree_ends *slot; /* of each lane */
    const struct scree_batch *batch;
    struct smooth_pass pass;
    struct smooth_kind kind;
    int first;
};

/* Lanes 0 … count - 1, or (`lane`) some here and there. */
static void gather_smooth(const struct smooth_work *w, const int *lane, int count, struct smooth_block *s) {
    struct scree_contact contact[SCREE_LANES];
    struct scree_ends own[SCREE_LANES];
    struct ends ends;
    const struct scree_batch *batch = w->batch;
    const struct scree_ends *slot = lane ? own : w->slot;
    int index[SCREE_LANES] = {0}, turns = w->pass.rubs, even = w->kind.sizes.even;
    for (int k = 0; k < count; k++) index[k] = w->first + (lane ? lane[k] : k);
    for (int k = 0; lane && k < count; k++) own[k] = w->slot[lane[k]];
    for (int k = 0; batch->geometry != SCREE_BALL_BALL && k < count; k++)
        contact[k] = scree_contact_at(batch, index[k]);
    find_ends(w->starts->record, w->starts->spin, slot, count, &ends);
    fetch_motions(&ends, count, batch->geometry != SCREE_BALL_PLANE, even, &s->b);
    if (batch->geometry == SCREE_BALL_IMAGE) bring_images(w->now, contact, count, &s->b);
    if (batch->geometry == SCREE_BALL_PLANE) meet_planes(w->now, batch, contact, &ends, count, &s->b);
    fetch_pushes(w->starts->push, slot, count, turns, even, &s->at);
    fetch_kept(batch, w->first, lane ? index : NULL, count, turns, &s->at, &s->x.c, &s->x.m);
}

/* CALL(balls, turns, even): a loop of its own for each kind of contact. */
#define FOR_KIND(kind, CALL)                                                                                           \
    do {                                                                                                               \
        if ((kind).sizes.even)                                                                                         \
            CALL(1, 1, 1);                                                                                             \
        else if ((kind).balls && (kind).turns)                                                                         \
            CALL(1, 1, 0);                                                                                             \
        else if ((kind).balls)                                                                                         \
            CALL(1, 0, 0);                                                                                             \
        else if ((kind).turns)                                                                                         \
            CALL(0, 1, 0);                                                                                             \
        else                                                                                                           \
            CALL(0, 0, 0);                                                                                             \
    } while (0)

static void meet_smooth(struct smooth_block *s, int count, double step, struct smooth_kind kind) {
#define MEET(balls, turns, even)                                                                                       \
    SMOOTH_LOOP(meet_lane(&s->b, k, step, balls, turns, sizes_if(kind.sizes, even), &s->at, &s->x.c, &s->x.m))
    FOR_KIND(kind, MEET);
#undef MEET
}

static void drive_smooth(struct smooth_block *s, int count, double step, struct smooth_kind kind) {
#define DRIVE(balls, turns, even) SMOOTH_LOOP(drive_lane(&s->b, k, step, turns, even, &s->at, &s->x.m))
    FOR_KIND(kind, DRIVE);
#undef DRIVE
}

/* What contacts have lost: the work done against them, which the motion tells (d'' = a - N/m), less what they have
 * stored by it. What is stored in an overlap whose force is over is lost by the time that it has gone. */
static void book_losses(const struct smooth_pass *pass, struct smooth_block *s, int count, struct scree_yield *yield) {
    const struct course *c = &s->x.c;
    const struct lane_constants *m = &s->x.m;
    double closing[SCREE_LANES] = {0.0}, before[SCREE_LANES] = {0.0}, after[SCREE_LANES] = {0.0};
    if (!pass->books) return;
    SMOOTH_LOOP(closing[k] = -vec_dot(get(s->b.rush, k), get(s->b.n, k));)
    for (int from = 0; from < padded(count); from += WIDTH) {
        pass->normal->store(pass->rule, m, from, s->at.kept, s->b.overlap, closing, before);
        pass->normal->store(pass->rule, m, from, s->x.c.kept, c->d, c->u, after);
    }
    SMOOTH_LOOP({
        double d = s->b.overlap[k], u = closing[k];
        double work = (m->closing[k] * (c->d[k] - d) - 0.5 * (c->u[k] - u) * (c->u[k] + u)) / m->give[k];
        yield->lost.normal[k] = work - (after[k] - before[k]);
        yield->lost.tangential[k] = pass->rubs ? c->rubbed[k] : 0.0;
    })
}

/* Depths, slopes, and levers. */
static SCREE_INLINE void rate_contact(struct smooth_block *s, int k, int turns, struct sizes sizes, double slope,
                                      struct scree_yield *yield) {
    double impulse = vec_dot(get(yield->impulse, k), get(s->at.later_n, k));
    yield->depth[k] = s->b.overlap[k] / limit_of(&s->b, k, sizes);
    yield->steep[k] = slope > 0.0 ? scree_steepness(impulse, slope, s->b.rush[3][k]) : 0.0;
    yield->lasts[k] = s->x.c.d[k] > 0.0 ? 1.0 : 0.0;
    if (!turns) return;
    struct vec rub = get(s->x.c.rub, k);
    double square = vec_norm2(rub), deep = vec_dot(get(s->x.c.deep, k), rub) / (square + SCREE_NO_SPEED);
    s->depth[k] = square > 0.0 ? s->b.overlap[k] + deep : 0.0;
}

/* What a contact yields, unless its normal has jumped. */
static SCREE_INLINE void finish_lane(struct smooth_block *s, int k, int balls, int turns, struct sizes sizes,
                                     double slope, struct scree_yield *yield, struct scree_moments *moments) {
    yield_lane(&s->b, k, balls, turns, sizes.even, &s->at, &s->x.c, yield, moments);
    rate_contact(s, k, turns, sizes, slope, yield);
    double steady = vec_dot(get(s->b.n, k), get(s->at.later_n, k));
    int plain = (steady >= 0.9) & (s->x.m.give[k] > 0.0);
    s->x.c.odd[k] = plain ? s->x.c.odd[k] : 1.0;
}

static void yield_smooth(struct smooth_block *s, int count, struct smooth_kind kind, double slope,
                         struct scree_yield *yield, struct scree_moments *moments) {
#define FINISH(balls, turns, even)                                                                                     \
    SMOOTH_LOOP(finish_lane(s, k, balls, turns, sizes_if(kind.sizes, even), slope, yield, moments))
    FOR_KIND(kind, FINISH);
#undef FINISH
}

/* What is kept of contacts one after the other. */
static void keep_all(const struct scree_batch *batch, struct smooth_block *s, int first, int count, int turns,
                     struct scree_yield *yield) {
    for (int m = 0; m < (turns ? SCREE_PAST_STEP : SCREE_PAST_DEPTH); m++) {
        double *to = batch->past[SCREE_PAST_STEP + m] + first;
        const double *now = m == SCREE_PAST_DEPTH ? s->depth : yield->impulse[m];
        SMOOTH_LOOP({
            to[k] = s->x.c.odd[k] > 0.0 ? to[k] : now[k] + 0.0; /* zeros have no sign */
        })
    }
    for (int m = 0; batch->kept[SCREE_KEPT_NORMAL] && m < 2; m++) {
        double *kept = batch->kept[SCREE_KEPT_NORMAL + m] + first;
        SMOOTH_LOOP({ kept[k] = s->x.c.odd[k] > 0.0 ? kept[k] : s->x.c.kept[m][k]; })
    }
    if (!turns || !batch->kept[0]) return;
    for (int axis = 0; axis < 3; axis++) {
        double *kept = batch->kept[axis] + first;
        SMOOTH_LOOP({ kept[k] = s->x.c.odd[k] > 0.0 ? kept[k] : s->x.c.s[axis][k] + 0.0; }) /* zeros have no sign */
    }
    unsigned char *slides = batch->slides + first;
    double most = 0.0; /* no slider slides, or has slid: so it is with most blocks */
    _Pragma("omp simd reduction(max : most)")
    for (int k = 0; k < padded(count); k++) {
        double slid = (double)slides[k] + s->x.c.slides[k];
        most = slid > most ? slid : most;
    }
    for (int k = 0; most > 0.0 && k < padded(count); k++)
        if (!(s->x.c.odd[k] > 0.0)) slides[k] = s->x.c.slides[k] > 0.0;
}

/* The same of one contact here or there, whose yield goes to a lane of one of several blocks. */
static void hand_over(const struct scree_batch *batch, struct smooth_block *s, int i, int index, int lane, int turns,
                      struct scree_yield *from, struct scree_moments *moments_from, struct scree_yield *yield,
                      struct scree_moments *moments) {
    yield += lane / SCREE_LANES, moments += lane / SCREE_LANES, lane %= SCREE_LANES;
    for (int axis = 0; axis < 3; axis++) {
        yield->impulse[axis][lane] = from->impulse[axis][i];
        moments->impulse[axis][lane] = moments_from->impulse[axis][i];
        yield->turn_ball[axis][lane] = turns ? from->turn_ball[axis][i] : 0.0;
        yield->turn_host[axis][lane] = turns ? from->turn_host[axis][i] : 0.0;
    }
    for (int m = 0; m < (turns ? SCREE_PAST_STEP : SCREE_PAST_DEPTH); m++)
        batch->past[SCREE_PAST_STEP + m][index] = (m == SCREE_PAST_DEPTH ? s->depth[i] : from->impulse[m][i]) + 0.0;
    yield->depth[lane] = from->depth[i];
    yield->steep[lane] = from->steep[i];
    yield->lasts[lane] = from->lasts[i];
    yield->lost.normal[lane] = from->lost.normal[i];
    yield->lost.tangential[lane] = from->lost.tangential[i];
    for (int m = 0; batch->kept[SCREE_KEPT_NORMAL] && m < 2; m++)
        batch->kept[SCREE_KEPT_NORMAL + m][index] = s->x.c.kept[m][i];
    if (!turns || !batch->kept[0]) return;
    for (int axis = 0; axis < 3; axis++) batch->kept[axis][index] = s->x.c.s[axis][i] + 0.0;
    scree_keep(batch, SCREE_KEPT_STATE, index, s->x.c.slides[i]);
}

/* How many have touched in the step before: most. */
static int count_touched(const struct scree_batch *batch, int first, int count) {
    const double *x = batch->past[0] + first, *y = batch->past[1] + first, *z = batch->past[2] + first;
    double touched = 0.0;
    _Pragma("omp simd reduction(+ : touched)")
    for (int k = 0; k < count; k++) touched += x[k] * x[k] + y[k] * y[k] + z[k] * z[k] > 0.0 ? 1.0 : 0.0;
    return (int)touched;
}

/* Nothing can happen in this step: too far apart, and nothing kept of an earlier touch. */
static int far_apart(const struct smooth_work *w, int lane) {
    if (scree_keeps_something(w->batch, w->first + lane)) return 0;
    enum scree_geometry geometry = w->batch->geometry;
    struct scree_contact contact = scree_contact_at(w->batch, w->first + lane);
    struct scree_ends slot = w->slot[lane];
    const struct scree_record *ball = &w->starts->record[slot.ball], *host = &w->starts->record[slot.host];
    double range = w->starts->push[slot.ball].along[3] + w->starts->push[slot.host].along[3];
    struct vec centre = vec_from(ball->x);
    if (geometry == SCREE_BALL_PLANE) {
        double overlap = scree_meet_at(w->now, &contact, geometry, centre, ball->radius).overlap;
        if (!(overlap + range < 0.0)) return 0;
    } else {
        struct vec apart = vec_sub(centre, vec_from(host->x));
        if (geometry == SCREE_BALL_IMAGE) apart = vec_sub(apart, scree_shift_of(w->now, &contact, geometry));
        double reach = ball->radius + host->radius, square = vec_norm2(apart);
        if (!(square > reach * reach) || !(square > (reach + range) * (reach + range))) return 0;
    }
    return 1;
}

/* From the bodies up to what drives the lanes. */
static void begin_smooth(const struct smooth_work *w, const int *lane, int count, struct smooth_block *s) {
    const struct smooth_pass *pass = &w->pass;
    gather_smooth(w, lane, count, s);
    meet_smooth(s, count, pass->step, w->kind);
    rate_lanes(pass, count, &s->x.c, &s->x.m);
    drive_smooth(s, count, pass->step, w->kind);
    s->x.by_clock = 0;
}

static struct smooth_work work_on(const struct scree_contacts *contacts, const struct scree_bodies *now,
                                  struct scree_starts *starts, const struct scree_ends *slot, int lane,
                                  const struct scree_batch *batch, int first, double step) {
    int balls = batch->geometry == SCREE_BALL_BALL || batch->geometry == SCREE_BALL_IMAGE;
    struct smooth_pass pass = smooth_pass_of(contacts, batch, first, step);
    struct sizes sizes = {balls && pass.rubs && now->even > 0.0, now->even + now->even,
                          starts->spin[slot[lane].ball].limit};
    return (struct smooth_work){now, starts, slot, batch, pass, {balls, pass.rubs, sizes}, first};
}

/* One step of Runge-Kutta of a lane; `anew`: the first one. */
static SCREE_INLINE void accept_straight(const struct smooth_pass *pass, double by_control, int rubs, int changes,
                                         int anew, int k, struct march *x) {
    struct seen seen = see_lane(pass, rubs, changes, by_control, k, x);
    double some = seen.coarse + seen.dips + seen.turns + seen.presses + seen.pulls + seen.slips;
    some += seen.ends + seen.leaves + seen.odd;
    accept_lane(rubs, changes, 1, anew, k, x);
    x->c.odd[k] = some > 0.0 ? 1.0 : x->c.odd[k];
}

/* All lanes through one of the pieces that are left. */
static void go_straight(const struct smooth_pass *pass, int count, int pieces_left, struct march *x) {
    double by_control = is_controlled(pass) ? 1.0 : 0.0;
    int anew = pieces_left == pass->pieces;
    SMOOTH_LOOP(try_piece(pass, k, pieces_left, x);)
    step_lanes(pass, &x->m, count, &x->c, &x->to);
#define ACCEPT(rubs, changes) SMOOTH_LOOP(accept_straight(pass, by_control, rubs, changes, anew, k, x);)
    FOR_DOINGS(pass, ACCEPT);
#undef ACCEPT
}

/* All lanes straight through the step. Those to which something happens in it, or may, are left as they were. Returns
 * bits of the others. */
static uint32_t go_all_straight(const struct smooth_work *w, int count, struct scree_yield *yield,
                                struct scree_moments *moments) {
    const struct smooth_pass *pass = &w->pass;
    struct smooth_block s;
    uint32_t done = 0;
    begin_smooth(w, NULL, count, &s);
    SMOOTH_LOOP({
        s.x.c.odd[k] = s.at.more[3][k] > 0.0 ? 1.0 : s.x.c.odd[k];
        try_lane(pass, k, &s.x);
    })
    for (int pieces = pass->pieces; pieces > 0; pieces--) go_straight(pass, count, pieces, &s.x);
    yield_smooth(&s, count, w->kind, w->batch->slope, yield, moments);
    book_losses(pass, &s, count, yield);
    keep_all(w->batch, &s, w->first, count, pass->rubs, yield);
    for (int k = 0; k < count; k++) done |= (uint32_t) !(s.x.c.odd[k] > 0.0) << k;
    return done;
}

/* Whether contacts are of two spheres, or of one with a plane, under laws that have their loops. */
static int are_smooth(const struct smooth_work *w) {
    return w->pass.normal && (w->kind.balls || w->batch->geometry == SCREE_BALL_PLANE);
}

uint32_t SCREE_PART(impel)(const struct scree_contacts *contacts, const struct scree_bodies *now,
                           struct scree_starts *starts, const struct scree_ends *slot, const struct scree_batch *batch,
                           int first, int count, double step, struct scree_yield *yield,
                           struct scree_moments *moments) {
    const struct smooth_work work = work_on(contacts, now, starts, slot, 0, batch, first, step);
    int most_touched = 2 * count_touched(batch, first, count) >= count;
    if (!are_smooth(&work) || !most_touched || !is_plain(now, &batch->ends[first])) /* as the others, mostly */
        return 0;
    return go_all_straight(&work, count, yield, moments);
}

/* ---- some of them ---- */

/* Lanes of several blocks, as many as one has, drawn together, past whatever happens to them. Those that are left to
 * within.c become the first ones of `left`; returns how many there are. */
static int march_some(const struct smooth_work *w, const int *lane, int count, int *left, struct scree_yield *yield,
                      struct scree_moments *moments) {
    struct smooth_block s;
    struct scree_yield few;
    struct scree_moments few_moments;
    int begins[SCREE_LANES] = {0}, turns = w->pass.rubs, touching = 0, odd = 0;
    double step = w->pass.step;
    begin_smooth(w, lane, count, &s);
    begin_course(&s.x.c);
    SMOOTH_LOOP(s.flight[k] = s.x.c.d[k] + (step * s.x.c.u[k] + 0.5 * step * step * s.x.m.closing[k]);)
    begin_lanes(count, step, turns, s.flight, &s.x);
    for (int k = 0; k < padded(count); k++) begins[k] = s.x.c.d[k] == 0.0 && s.x.c.rest[k] > 0.0;
    meet_lanes(&w->pass, count, begins, &s.x);
    for (int k = 0; k < count; k++) touching |= s.x.c.rest[k] > 0.0;
    if (touching) march_on(&w->pass, count, &s.x);
    recall_lanes(&w->pass, &s.x.m, count, 0, &s.x.c);
    yield_smooth(&s, count, w->kind, w->batch->slope, &few, &few_moments);
    book_losses(&w->pass, &s, count, &few);
    for (int i = 0; i < count; i++)
        if (s.x.c.odd[i] > 0.0)
            left[odd++] = lane[i];
        else
            hand_over(w->batch, &s, i, w->first + lane[i], lane[i], turns, &few, &few_moments, yield, moments);
    return odd;
}

/* Lanes that slide come first: those that hold take fewer operations where none beside them slides. */
static void sliding_first(const struct scree_batch *batch, int first, int *lane, int count) {
    int slide = 0;
    for (int i = 0; batch->slides && i < count; i++) {
        if (!batch->slides[first + lane[i]]) continue;
        int holds = lane[slide];
        lane[slide++] = lane[i];
        lane[i] = holds;
    }
}

/* Of lanes those to which something can happen, into `acting`; the others have no yield, or are left to within.c: the
 * first ones of `lane`. Returns how many these are. */
static int sort_out(const struct smooth_work *w, int *lane, int count, int *acting, int *acts,
                    struct scree_yield *yield, struct scree_moments *moments) {
    int odd = 0;
    *acts = 0;
    for (int i = 0; i < count; i++)
        if (!is_plain(w->now, &w->batch->ends[w->first + lane[i]]))
            lane[odd++] = lane[i];
        else if (far_apart(w, lane[i]))
            yield_nothing(&yield[lane[i] / SCREE_LANES], &moments[lane[i] / SCREE_LANES], lane[i] % SCREE_LANES);
        else
            acting[(*acts)++] = lane[i];
    return odd;
}

int SCREE_PART(impel_few)(const struct scree_contacts *contacts, const struct scree_bodies *now,
                          struct scree_starts *starts, const struct scree_batch *batch, int first, int *lane, int count,
                          double step, struct scree_yield *yield, struct scree_moments *moments) {
    const struct smooth_work work = work_on(contacts, now, starts, starts->slot, lane[0], batch, first, step);
    int acting[SCREE_WINDOW * SCREE_LANES], acts;
    if (!are_smooth(&work)) return count;
    int odd = sort_out(&work, lane, count, acting, &acts, yield, moments);
    sliding_first(batch, first, acting, acts);
    for (int done = 0, some; done < acts; done += some) {
        some = acts - done < SCREE_LANES ? acts - done : SCREE_LANES;
        odd += march_some(&work, &acting[done], some, &lane[odd], yield, moments);
    }
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

/* Few blocks have what is deeper or steeper than any before. */
static int stands_out(const struct scree_yield *yield, int count, const struct scree_tally *tally) {
    double deepest = tally->deepest, steepest = tally->steepest, more = 0.0;
    _Pragma("omp simd reduction(+ : more)")
    for (int k = 0; k < count; k++) more += ((yield->depth[k] <= deepest) & (yield->steep[k] <= steepest)) ? 0.0 : 1.0;
    return more > 0.0;
}

/* Impulses of a block and their moments into the bodies, whose attitudes don't turn by them. */
int SCREE_PART(add_up)(struct scree_bodies *bodies, const struct scree_ends *contact, int count, int turns, int hosts,
                       struct scree_yield *yield, struct scree_moments *moments, const struct scree_tally *tally) {
#ifdef __AVX__
    for (int lane = 0; lane < count; lane += 4) {
        scree_row impulse[4], moment[4], turn_ball[4], turn_host[4];
        load_rows(yield->impulse, lane, impulse);
        load_rows(moments->impulse, lane, moment);
        if (turns) load_rows(yield->turn_ball, lane, turn_ball);
        if (turns && hosts) load_rows(yield->turn_host, lane, turn_host);
        for (int i = 0; i < 4 && lane + i < count; i++) {
            int ball = contact[lane + i].ball, host = contact[lane + i].host;
            *(scree_row *)bodies->record[ball].impulse += impulse[i];
            *(scree_row *)bodies->moment[ball] += moment[i];
            if (turns) *(scree_row *)bodies->record[ball].turn += turn_ball[i];
            if (!hosts) continue;
            *(scree_row *)bodies->record[host].impulse -= impulse[i];
            *(scree_row *)bodies->moment[host] -= moment[i];
            if (turns) *(scree_row *)bodies->record[host].turn += turn_host[i];
        }
    }
#else
    for (int lane = 0; lane < count; lane++) {
        int ball = contact[lane].ball, host = contact[lane].host;
        for (int k = 0; k < 3; k++) {
            bodies->record[ball].impulse[k] += yield->impulse[k][lane];
            bodies->moment[ball][k] += moments->impulse[k][lane];
            if (turns) bodies->record[ball].turn[k] += yield->turn_ball[k][lane];
            if (!hosts) continue;
            bodies->record[host].impulse[k] -= yield->impulse[k][lane];
            bodies->moment[host][k] -= moments->impulse[k][lane];
            if (turns) bodies->record[host].turn[k] += yield->turn_host[k][lane];
        }
    }
#endif
    return stands_out(yield, count, tally);
}
