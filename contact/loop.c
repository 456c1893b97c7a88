/* The contact loop: blocks of contacts go through short passes over columns that stay in the L1 cache,
 *   gather     body records -> normal, overlap, arms, relative velocity
 *   normal     the normal law
 *   friction   the friction law with its memory
 *   rolling    the rolling law with its memory, where there is one
 *   yield      impulses on both bodies
 * and the impulses are added to the bodies in the order of the list, whatever the number of threads. Each law makes one
 * pass from its inline function, so there are as many loops as laws, not as products of laws; choices are made per
 * batch, never per contact. */
#include "contact/law_list.h"
#include "contact/meet.h"

#include <string.h>

/* Columns of one block of contacts. */
struct block {
    double n[3][SCREE_LANES];        /* unit normal, from the host towards the ball */
    double arm[3][SCREE_LANES];      /* from the ball body's centre to the middle of the overlap, m */
    double apart[3][SCREE_LANES];    /* from the host's centre to the ball body's, m */
    double overlap[SCREE_LANES];     /* m */
    double limit[SCREE_LANES];       /* largest tolerable overlap, m */
    double softness[SCREE_LANES];    /* velocity that a tangential impulse gives the pair, 1/kg */
    double closing[SCREE_LANES];     /* m/s */
    double slip[3][SCREE_LANES];     /* tangential velocity of the ball, m/s */
    double force[SCREE_LANES];       /* normal, N */
    double reversible[SCREE_LANES];  /* part of it that is stored, N */
    double touching[SCREE_LANES];    /* 1 while the contact lasts, else 0 */
    double snap[SCREE_LANES];        /* lost where bodies attach, J; only laws that reach beyond touch write it */
    double friction[3][SCREE_LANES]; /* N */
};

/* Passes run over full vectors: the count of contacts rounded up to a multiple of 4. */
static int padded(int count) { return (count + 3) & ~3; }

static inline void put(double column[3][SCREE_LANES], int lane, struct vec a) {
    column[0][lane] = a.x;
    column[1][lane] = a.y;
    column[2][lane] = a.z;
}

static inline struct vec get(double (*column)[SCREE_LANES], int lane) {
    return vec(column[0][lane], column[1][lane], column[2][lane]);
}

/* Geometry and relative velocity of one contact, into lane `lane`. */
static inline void gather_one(const struct scree_bodies *bodies, const struct scree_contact *contact,
                              enum scree_geometry geometry, struct block *b, int lane) {
    const struct scree_record *ball = &bodies->record[contact->ball], *host = &bodies->record[contact->host];
    struct vec corner = vec_from(bodies->corner[contact->corner]);
    struct vec centre = vec_add(vec_from(ball->x), corner);
    struct scree_meeting m = scree_meet(bodies, contact, geometry, centre);
    /* Both bodies are acted on at one point, the middle of the overlap, so that angular momentum is kept. */
    struct vec arm = vec_axpy(corner, 0.5 * m.overlap - ball->radius, m.normal);
    struct vec apart = vec_sub(vec_from(ball->x), vec_from(host->x));
    struct vec velocity = vec_sub(vec_from(ball->v), vec_from(host->v));
    velocity = vec_add(velocity, vec_cross(vec_from(ball->w), arm));
    velocity = vec_sub(velocity, vec_cross(vec_from(host->w), vec_add(arm, apart)));
    double closing = -vec_dot(velocity, m.normal);
    put(b->n, lane, m.normal);
    put(b->arm, lane, arm);
    put(b->apart, lane, apart);
    put(b->slip, lane, vec_axpy(velocity, closing, m.normal));
    b->overlap[lane] = m.overlap;
    b->touching[lane] = m.overlap > 0.0 ? 1.0 : 0.0;
    b->limit[lane] = ball->limit < host->limit ? ball->limit : host->limit;
    b->closing[lane] = closing;
    /* A ball's rotation makes it 3.5 times as soft as its mass, four corners that share a load four times. */
    b->softness[lane] = 4.0 * (ball->inverse_mass + host->inverse_mass);
}

/* What edges on edges do besides pushing at the middle of their overlap, per newton of the normal force. */
struct lean {
    double force[3][SCREE_LANES], turn_ball[3][SCREE_LANES], turn_host[3][SCREE_LANES];
};

/* As gather_one, for an edge on an edge; `lean` may be NULL. */
static void gather_crossing(const struct scree_bodies *bodies, const struct scree_contact *contact, struct block *b,
                            int lane, struct lean *lean) {
    const struct scree_record *ball = &bodies->record[contact->ball], *host = &bodies->record[contact->host];
    struct scree_crossing c = scree_cross(bodies, contact);
    struct vec n = c.meeting.normal, apart = vec_sub(vec_from(ball->x), vec_from(host->x));
    struct vec between = vec_sub(vec_from(ball->v), vec_from(host->v)), host_arm = vec_add(c.point, apart);
    struct vec velocity = vec_add(between, vec_cross(vec_from(ball->w), c.point));
    velocity = vec_sub(velocity, vec_cross(vec_from(host->w), host_arm));
    put(b->n, lane, n);
    put(b->arm, lane, c.point);
    put(b->apart, lane, apart);
    put(b->slip, lane, vec_axpy(velocity, -vec_dot(velocity, n), n));
    b->overlap[lane] = c.meeting.overlap;
    b->touching[lane] = c.meeting.overlap > 0.0 ? 1.0 : 0.0;
    b->limit[lane] = ball->limit < host->limit ? ball->limit : host->limit;
    b->closing[lane] =
        -vec_dot(c.force, between) - vec_dot(c.turn_a, vec_from(ball->w)) - vec_dot(c.turn_b, vec_from(host->w));
    b->softness[lane] = 4.0 * (ball->inverse_mass + host->inverse_mass);
    if (!lean) return;
    put(lean->force, lane, vec_sub(c.force, n));
    put(lean->turn_ball, lane, vec_sub(c.turn_a, vec_cross(c.point, n)));
    put(lean->turn_host, lane, vec_add(c.turn_b, vec_cross(host_arm, n)));
}

/* Whether two boxes may touch edge on edge in this step. Where they can't, all would come out as zero. */
static int may_cross(const struct scree_bodies *bodies, const struct scree_contact *contact,
                     const struct scree_run *run) {
    const struct scree_record *a = &bodies->record[contact->ball], *b = &bodies->record[contact->host];
    if (2.0 * (a->path + b->path) < run->clear) return 0; /* twice: the step's own way, wherever it is within it */
    struct scree_two_boxes boxes = scree_two_boxes_of(bodies, contact->ball, contact->host);
    return !scree_meet_as_rectangles(&boxes, run->first);
}

static void gather_nothing(struct block *b, int lane, struct lean *lean) {
    struct vec zero = {0.0, 0.0, 0.0};
    put(b->n, lane, vec(0.0, 0.0, 1.0));
    put(b->arm, lane, zero);
    put(b->apart, lane, zero);
    put(b->slip, lane, zero);
    b->overlap[lane] = SCREE_OUTSIDE;
    b->touching[lane] = b->closing[lane] = b->softness[lane] = 0.0;
    b->limit[lane] = 1.0;
    put(lean->force, lane, zero);
    put(lean->turn_ball, lane, zero);
    put(lean->turn_host, lane, zero);
}

/* Returns 0 if nothing can touch; then nothing is gathered. */
static int gather_crossings(const struct scree_bodies *bodies, const struct scree_batch *batch, int block, int count,
                            struct block *b, struct lean *lean) {
    int start = block * SCREE_LANES, first = batch->first_run[block], runs = 0, any = 0, may[SCREE_LANES];
    for (; first + runs < batch->runs && batch->run[first + runs].start < start + count; runs++) {
        const struct scree_run *run = &batch->run[first + runs];
        any |= may[runs] = may_cross(bodies, &batch->contact[run->start], run);
    }
    if (!any) return 0;
    for (int lane = 0, run = 0; lane < padded(count); lane++) {
        if (run + 1 < runs && start + lane == batch->run[first + run + 1].start) run++;
        if (lane < count && may[run])
            gather_crossing(bodies, &batch->contact[start + lane], b, lane, lean);
        else
            gather_nothing(b, lane, lean);
    }
    return 1;
}

/* A block without touch: laws forget what they have kept. */
static void stay_silent(const struct scree_batch *batch, int block) {
    struct scree_yield *yield = &batch->yield[block];
    yield->lost_normal = yield->work_tangential = 0.0;
    if (batch->memory) memset(batch->kept[block], 0, sizeof *batch->kept);
}

static void gather(const struct scree_bodies *bodies, const struct scree_contact *contact, int count,
                   enum scree_geometry geometry, struct block *b) {
    for (int lane = 0; lane < padded(count); lane++) {
        const struct scree_contact *one = &contact[lane < count ? lane : count - 1];
        switch (geometry) { /* constant arguments: each case becomes a loop body of its own */
        case SCREE_BALL_BALL:
            gather_one(bodies, one, SCREE_BALL_BALL, b, lane);
            break;
        case SCREE_BALL_PLANE:
            gather_one(bodies, one, SCREE_BALL_PLANE, b, lane);
            break;
        case SCREE_BALL_RECTANGLE:
            gather_one(bodies, one, SCREE_BALL_RECTANGLE, b, lane);
            break;
        default:
            gather_one(bodies, one, SCREE_BALL_BOX, b, lane);
            break;
        }
    }
}

typedef void law_pass(struct block *b, int count, const struct scree_law_constants *law, double (*pair)[SCREE_LANES],
                      double (*kept)[SCREE_LANES], double step);

/* Share of the step during which the bodies touch: 1 or 0, but for the steps in which they meet or part. */
static inline double share_in_touch(double overlap, double closing, double step) {
    double way = 0.5 * step * fabs(closing) + SCREE_NO_SPEED;
    double share = 0.5 + 0.5 * (overlap / way);
    share = share < 1.0 ? share : 1.0;
    return share > 0.0 ? share : 0.0;
}

/* Energy that is lost when bodies attach whose law reaches beyond touch: it binds them at once, and counts from the end. */
static inline double snap_energy(double (*stored)(const struct scree_law_constants *, struct scree_pair_constants,
                                                  struct scree_pressing),
                                 const struct scree_law_constants *law, struct scree_pair_constants pair) {
    return -stored(law, pair, (struct scree_pressing){0.0, 0.0, 0.0, 1.0});
}

/* One pass per normal law, from its inline function. A dashpot acts at full strength from the first touch on, so a step in
 * which bodies meet or part gets the share of it that they touch: without this the scheme is of first order. The spring
 * is left as it is: there the mid-step rule is of second order already, and reversible. What touches is looked up, not
 * compared again: a second comparison would make a branch of the law, and no vector. */
#define NORMAL_PASS(word)                                                                                              \
    static void normal_pass_##word(struct block *b, int count, const struct scree_law_constants *law,                  \
                                   double(*pair)[SCREE_LANES], double(*kept)[SCREE_LANES], double step) {              \
        struct scree_law_constants constants = *law;                                                                   \
        double(*own)[SCREE_LANES] = kept ? kept + SCREE_KEPT_NORMAL : NULL;                                            \
        _Pragma("omp simd")                                                                                            \
        for (int k = 0; k < padded(count); k++) {                                                                      \
            struct scree_pair_constants of_pair = {{pair[0][k], pair[1][k], pair[2][k], pair[3][k]}};                  \
            struct scree_pressing at = {b->overlap[k], b->closing[k], 0.0, 0.0};                                       \
            if (scree_normal_##word.memory) {                                                                          \
                at.first = own[0][k];                                                                                  \
                at.second = own[1][k];                                                                                 \
            }                                                                                                          \
            struct scree_normal_force f = normal_##word##_force(&constants, of_pair, at);                              \
            if (scree_normal_##word.memory) {                                                                          \
                own[0][k] = f.first;                                                                                   \
                own[1][k] = f.second;                                                                                  \
            }                                                                                                          \
            double touching = b->touching[k], share = share_in_touch(at.overlap, at.closing, step);                    \
            if (scree_normal_##word.reach) {                                                                           \
                touching = share = f.second > 0.0 ? 1.0 : 0.0;                                                         \
                b->snap[k] =                                                                                           \
                    touching > at.second ? snap_energy(scree_normal_##word.stored, &constants, of_pair) : 0.0;         \
                b->touching[k] = touching;                                                                             \
            }                                                                                                          \
            double force = touching * f.elastic + share * f.damping * at.closing;                                      \
            force = scree_normal_##word.cut && force < 0.0 ? 0.0 : force;                                              \
            b->force[k] = force;                                                                                       \
            b->reversible[k] = touching * f.reversible;                                                                \
        }                                                                                                              \
    }
SCREE_NORMAL_LAWS(NORMAL_PASS)

/* One pass per friction law. The memory belongs to the ends of steps, the velocity to their middle. */
#define FRICTION_PASS(word)                                                                                            \
    static void friction_pass_##word(struct block *b, int count, const struct scree_law_constants *law,                \
                                     double(*pair)[SCREE_LANES], double(*kept)[SCREE_LANES], double step) {            \
        struct scree_law_constants constants = *law;                                                                   \
        double half = 0.5 * step;                                                                                      \
        _Pragma("omp simd")                                                                                            \
        for (int k = 0; k < padded(count); k++) {                                                                      \
            double normal = b->force[k] > 0.0 ? b->force[k] : 0.0;                                                     \
            struct scree_pair_constants of_pair = {                                                                    \
                {pair[SCREE_PAIR_FRICTION][k], pair[SCREE_PAIR_FRICTION + 1][k], 0.0, 0.0}};                           \
            struct scree_sliding at = {                                                                                \
                .normal = normal, .overlap = b->overlap[k], .half = half, .velocity = get(b->slip, k)};                \
            if (scree_friction_##word.memory) {                                                                        \
                at.stretch = scree_into_tangent_plane(get(kept, k), get(b->n, k));                                     \
                at.sliding = kept[3][k];                                                                               \
            }                                                                                                          \
            struct scree_tangential f = friction_##word##_force(&constants, of_pair, at);                              \
            put(b->friction, k, f.force);                                                                              \
            if (scree_friction_##word.memory) {                                                                        \
                put(kept, k, vec_scale(b->touching[k], f.stretch));                                                    \
                kept[3][k] = b->touching[k] * f.sliding;                                                               \
            }                                                                                                          \
        }                                                                                                              \
    }
SCREE_FRICTION_LAWS(FRICTION_PASS)

/* Columns of the relative turning, at the lever of the rolling law. */
struct turning {
    double rolling[3][SCREE_LANES],
        twisting[SCREE_LANES];     /* lever x angular velocity of the ball against the host, m/s */
    double torque[3][SCREE_LANES]; /* on the ball, N m */
    double power[SCREE_LANES];     /* taken from the motion, W */
};

static inline void gather_turning(const struct scree_bodies *bodies, const struct scree_contact *contact, int count,
                                  const struct block *b, double (*pair)[SCREE_LANES], struct turning *t) {
    for (int lane = 0; lane < padded(count); lane++) {
        const struct scree_contact *one = &contact[lane < count ? lane : count - 1];
        struct vec spin = vec_sub(vec_from(bodies->record[one->ball].w), vec_from(bodies->record[one->host].w));
        struct vec velocity = vec_scale(pair[SCREE_PAIR_LEVER][lane], spin),
                   n = get((double(*)[SCREE_LANES])b->n, lane);
        t->twisting[lane] = vec_dot(velocity, n);
        put(t->rolling, lane, vec_axpy(velocity, -t->twisting[lane], n));
    }
}

typedef void rolling_pass(const struct block *b, struct turning *t, int count, const struct scree_law_constants *law,
                          double (*pair)[SCREE_LANES], double (*kept)[SCREE_LANES], double step);

/* One pass per rolling law: rolling, then twisting. */
#define ROLLING_PASS(word)                                                                                             \
    static void rolling_pass_##word(const struct block *b, struct turning *t, int count,                               \
                                    const struct scree_law_constants *law, double(*pair)[SCREE_LANES],                 \
                                    double(*kept)[SCREE_LANES], double step) {                                         \
        struct scree_law_constants constants = *law;                                                                   \
        double(*own)[SCREE_LANES] = kept ? kept + SCREE_KEPT_ROLLING : NULL;                                           \
        _Pragma("omp simd")                                                                                            \
        for (int k = 0; k < padded(count); k++) {                                                                      \
            double lever = pair[SCREE_PAIR_LEVER][k];                                                                  \
            struct vec n = vec(b->n[0][k], b->n[1][k], b->n[2][k]);                                                    \
            struct scree_sliding rolling = {.normal = b->force[k] > 0.0 ? b->force[k] : 0.0,                           \
                                            .overlap = b->overlap[k],                                                  \
                                            .half = 0.5 * step,                                                        \
                                            .velocity = get(t->rolling, k)};                                           \
            struct scree_sliding twisting = rolling;                                                                   \
            twisting.velocity = vec(t->twisting[k], 0.0, 0.0);                                                         \
            if (scree_rolling_##word.memory) {                                                                         \
                rolling.stretch = scree_into_tangent_plane(get(own, k), n);                                            \
                rolling.sliding = own[3][k];                                                                           \
                twisting.stretch = vec(own[4][k], 0.0, 0.0);                                                           \
                twisting.sliding = own[5][k];                                                                          \
            }                                                                                                          \
            struct scree_tangential r =                                                                                \
                rolling_##word##_resist(&constants, constants.c[SCREE_ROLLING_COEFFICIENT], rolling);                  \
            struct scree_tangential s =                                                                                \
                rolling_##word##_resist(&constants, constants.c[SCREE_TWISTING_COEFFICIENT], twisting);                \
            put(t->torque, k, vec_scale(lever, vec_axpy(r.force, s.force.x, n)));                                      \
            t->power[k] = -(vec_dot(r.force, rolling.velocity) + s.force.x * t->twisting[k]);                          \
            if (scree_rolling_##word.memory) {                                                                         \
                put(own, k, vec_scale(b->touching[k], r.stretch));                                                     \
                own[3][k] = b->touching[k] * r.sliding;                                                                \
                own[4][k] = b->touching[k] * s.stretch.x;                                                              \
                own[5][k] = b->touching[k] * s.sliding;                                                                \
            }                                                                                                          \
        }                                                                                                              \
    }
SCREE_ROLLING_LAWS(ROLLING_PASS)

#define ENTRY(word) rolling_pass_##word,
static rolling_pass *const rolling_passes[] = {SCREE_ROLLING_LAWS(ENTRY)};
#undef ENTRY
#define ENTRY(word) normal_pass_##word,
static law_pass *const normal_passes[] = {SCREE_NORMAL_LAWS(ENTRY)};
#undef ENTRY
#define ENTRY(word) friction_pass_##word,
static law_pass *const friction_passes[] = {SCREE_FRICTION_LAWS(ENTRY)};
#undef ENTRY

/* Impulses on both bodies. Without friction a ball at the centre of its body can't turn it. */
static void write_yield(const struct block *b, int count, double step, int friction, int turns, double slope,
                        struct scree_yield *yield) {
    _Pragma("omp simd")
    for (int k = 0; k < padded(count); k++) {
        double f = step * b->force[k];
        double jx = f * b->n[0][k], jy = f * b->n[1][k], jz = f * b->n[2][k];
        if (friction) {
            jx += step * b->friction[0][k];
            jy += step * b->friction[1][k];
            jz += step * b->friction[2][k];
        }
        yield->impulse[0][k] = jx;
        yield->impulse[1][k] = jy;
        yield->impulse[2][k] = jz;
        yield->depth[k] = b->overlap[k] / b->limit[k];
        yield->steep[k] = step * slope * b->force[k] * b->softness[k];
        if (!turns) continue;
        double ax = b->arm[0][k], ay = b->arm[1][k], az = b->arm[2][k];
        yield->turn_ball[0][k] = ay * jz - az * jy;
        yield->turn_ball[1][k] = az * jx - ax * jz;
        yield->turn_ball[2][k] = ax * jy - ay * jx;
        ax += b->apart[0][k];
        ay += b->apart[1][k];
        az += b->apart[2][k];
        yield->turn_host[0][k] = az * jy - ay * jz;
        yield->turn_host[1][k] = ax * jz - az * jx;
        yield->turn_host[2][k] = ay * jx - ax * jy;
    }
}

/* What the contacts took out of the motion during the step. Summed lane by lane: a fixed order. */
static void measure_losses(const struct block *b, int count, double step, int friction, int snaps,
                           struct scree_yield *yield) {
    double normal = 0.0, tangential = 0.0;
    for (int k = 0; k < count; k++) {
        normal += step * (b->force[k] - b->reversible[k]) * b->closing[k];
        if (snaps) normal += b->snap[k];
        if (friction)
            tangential -= step * (b->friction[0][k] * b->slip[0][k] + b->friction[1][k] * b->slip[1][k] +
                                  b->friction[2][k] * b->slip[2][k]);
    }
    yield->lost_normal = normal;
    yield->work_tangential = tangential;
}

static int contacts_in_block(const struct scree_batch *batch, int block) {
    int left = batch->count - block * SCREE_LANES;
    return left < SCREE_LANES ? left : SCREE_LANES;
}

/* The rolling law of a block: torques on both bodies, equal and opposite, on top of what the forces yield. */
static void act_turning(const struct scree_contacts *contacts, const struct scree_bodies *bodies,
                        const struct scree_batch *batch, int block, const struct block *b, double step) {
    struct turning t;
    const struct scree_rule *rule = &contacts->rule[batch->rule];
    struct scree_yield *yield = &batch->yield[block];
    double(*pair)[SCREE_LANES] = batch->pair[batch->uniform ? 0 : block];
    int count = contacts_in_block(batch, block);
    gather_turning(bodies, batch->contact + block * SCREE_LANES, count, b, pair, &t);
    rolling_passes[rule->rolling](b, &t, count, &rule->rolling_constants, pair,
                                  batch->memory ? batch->kept[block] : NULL, step);
    for (int axis = 0; axis < 3; axis++)
        for (int k = 0; k < count; k++) {
            yield->turn_ball[axis][k] += step * t.torque[axis][k];
            yield->turn_host[axis][k] -= step * t.torque[axis][k];
        }
    for (int k = 0; contacts->measured && k < count; k++) yield->work_tangential += step * t.power[k];
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

/* From the gathered columns to the yield. */
static inline void act_gathered(const struct scree_contacts *contacts, const struct scree_bodies *bodies,
                                const struct scree_batch *batch, int block, struct block *b, double step) {
    const struct scree_rule *rule = &contacts->rule[batch->rule];
    int count = contacts_in_block(batch, block), friction = rule->friction >= 0;
    double(*pair)[SCREE_LANES] = batch->pair[batch->uniform ? 0 : block];
    double(*kept)[SCREE_LANES] = batch->memory ? batch->kept[block] : NULL;
    normal_passes[rule->normal](b, count, &rule->normal_constants, pair, kept, step);
    if (friction) friction_passes[rule->friction](b, count, &rule->friction_constants, pair, kept, step);
    write_yield(b, count, step, friction, batch->any_turns, batch->slope, &batch->yield[block]);
    int snaps = scree_normal_laws[rule->normal]->reach != NULL;
    if (contacts->measured) measure_losses(b, count, step, friction, snaps, &batch->yield[block]);
    if (rule->rolling >= 0) act_turning(contacts, bodies, batch, block, b, step);
}

/* A block of edges on edges. */
static void act_edges(const struct scree_contacts *contacts, const struct scree_bodies *bodies,
                      const struct scree_batch *batch, int block, double step) {
    struct block b;
    struct lean lean;
    int count = contacts_in_block(batch, block);
    batch->yield[block].silent = !gather_crossings(bodies, batch, block, count, &b, &lean);
    if (batch->yield[block].silent) {
        stay_silent(batch, block);
        return;
    }
    act_gathered(contacts, bodies, batch, block, &b, step);
    act_leaning(&b, &lean, count, step, &batch->yield[block]);
}

static void act_block(const struct scree_contacts *contacts, const struct scree_bodies *bodies,
                      const struct scree_batch *batch, int block, double step) {
    struct block b;
    if (batch->geometry == SCREE_EDGE_EDGE) {
        act_edges(contacts, bodies, batch, block, step);
        return;
    }
    gather(bodies, batch->contact + block * SCREE_LANES, contacts_in_block(batch, block), batch->geometry, &b);
    act_gathered(contacts, bodies, batch, block, &b, step);
}

static void add_to_bodies(struct scree_bodies *bodies, const struct scree_contact *contact,
                          const struct scree_yield *yield, int lane, int turns) {
    struct scree_record *ball = &bodies->record[contact->ball], *host = &bodies->record[contact->host];
    for (int k = 0; k < 3; k++) {
        ball->f[k] += yield->impulse[k][lane];
        host->f[k] -= yield->impulse[k][lane];
    }
    for (int k = 0; turns && k < 3; k++) {
        ball->t[k] += yield->turn_ball[k][lane];
        host->t[k] += yield->turn_host[k][lane];
    }
}

/* Keep the largest value so far, and whose it was. */
static inline void note(double value, const struct scree_contact *contact, double *largest, int *ball, int *host) {
    if (value <= *largest) return;
    *largest = value;
    *ball = contact->ball;
    *host = contact->host;
}

static inline void collect(struct scree_contacts *contacts, struct scree_bodies *bodies,
                           const struct scree_batch *batch, int block) {
    const struct scree_contact *contact = batch->contact + block * SCREE_LANES;
    const struct scree_yield *yield = &batch->yield[block];
    if (batch->geometry == SCREE_EDGE_EDGE && yield->silent) return;
    for (int lane = 0; lane < contacts_in_block(batch, block); lane++) {
        add_to_bodies(bodies, &contact[lane], yield, lane, scree_contact_turns(batch, &contact[lane]));
        note(yield->depth[lane], &contact[lane], &contacts->deepest, &contacts->deepest_ball, &contacts->deepest_host);
        note(yield->steep[lane], &contact[lane], &contacts->steepest, &contacts->steepest_ball,
             &contacts->steepest_host);
    }
    if (contacts->measured) {
        contacts->lost_normal += yield->lost_normal;
        contacts->work_tangential += yield->work_tangential;
    }
}

void scree_contacts_collect(struct scree_contacts *contacts, struct scree_bodies *bodies,
                            const struct scree_batch *batch, int block) {
    collect(contacts, bodies, batch, block);
}

/* Blocks are independent of each other; a team of threads pays from some dozens of them on. */
static void act_blocks(struct scree_contacts *contacts, struct scree_bodies *bodies, const struct scree_batch *batch,
                       int blocks, double step, int threads) {
    if (threads > 1 && blocks > 64) {
#pragma omp parallel for schedule(static) num_threads(threads)
        for (int block = 0; block < blocks; block++) act_block(contacts, bodies, batch, block, step);
    } else {
        for (int block = 0; block < blocks; block++) act_block(contacts, bodies, batch, block, step);
    }
}

void scree_contacts_act(struct scree_contacts *contacts, struct scree_bodies *bodies, double step, int threads) {
    for (int k = 0; k < contacts->busy_batches; k++) {
        const struct scree_batch *batch = &contacts->batch[contacts->busy[k]];
        int blocks = (batch->count + SCREE_LANES - 1) / SCREE_LANES;
        act_blocks(contacts, bodies, batch, blocks, step, threads);
        for (int block = 0; block < blocks; block++) collect(contacts, bodies, batch, block);
    }
}

/* Friction at this instant, and what its spring holds. */
static void measure_friction(const struct scree_rule *rule, struct scree_pair_constants pair,
                             double (*kept)[SCREE_LANES], int lane, struct scree_touch *touch) {
    const struct scree_friction_law *friction = scree_friction_laws[rule->friction];
    struct scree_sliding at = {.normal = touch->normal_force > 0.0 ? touch->normal_force : 0.0,
                               .overlap = touch->overlap,
                               .velocity = touch->slip};
    if (friction->memory) {
        at.stretch = scree_into_tangent_plane(get(kept, lane), touch->normal);
        at.sliding = kept[3][lane];
    }
    struct scree_tangential t = friction->force(&rule->friction_constants, pair, at);
    touch->tangential = t.force;
    touch->stretch = t.stretch;
    touch->sliding = t.sliding > 0.0;
    at.stretch = t.stretch;
    touch->stored_in_friction = friction->stored(&rule->friction_constants, pair, at);
}

/* Torque of the rolling law at this instant, and what its springs hold. */
static void measure_turning(const struct scree_rule *rule, const struct scree_bodies *bodies, double lever,
                            const double kept[6], struct scree_touch *touch) {
    const struct scree_rolling_law *law = scree_rolling_laws[rule->rolling];
    const struct scree_law_constants *constants = &rule->rolling_constants;
    struct vec n = touch->normal;
    struct vec spin = vec_sub(vec_from(bodies->record[touch->ball].w), vec_from(bodies->record[touch->host].w));
    struct vec velocity = vec_scale(lever, spin);
    double along = vec_dot(velocity, n);
    struct scree_sliding at = {.normal = touch->normal_force > 0.0 ? touch->normal_force : 0.0,
                               .overlap = touch->overlap,
                               .velocity = vec_axpy(velocity, -along, n)};
    at.stretch = scree_into_tangent_plane(vec_from(kept), n);
    at.sliding = kept[3];
    struct scree_tangential r = law->resist(constants, constants->c[SCREE_ROLLING_COEFFICIENT], at);
    at.velocity = vec(along, 0.0, 0.0);
    at.stretch = vec(kept[4], 0.0, 0.0);
    at.sliding = kept[5];
    struct scree_tangential s = law->resist(constants, constants->c[SCREE_TWISTING_COEFFICIENT], at);
    touch->torque = vec_scale(lever, vec_axpy(r.force, s.force.x, n));
    touch->stored_in_friction += 0.5 * law->stiffness(constants) * (vec_norm2(r.stretch) + s.stretch.x * s.stretch.x);
}

int scree_contacts_measure(const struct scree_contacts *contacts, const struct scree_bodies *bodies, int batch_index,
                           int index, struct scree_touch *touch) {
    const struct scree_batch *batch = &contacts->batch[batch_index];
    const struct scree_contact *contact = &batch->contact[index];
    const struct scree_rule *rule = &contacts->rule[batch->rule];
    int block = index / SCREE_LANES, lane = index % SCREE_LANES;
    struct block b;
    if (batch->geometry == SCREE_EDGE_EDGE)
        gather_crossing(bodies, contact, &b, 0, NULL);
    else
        gather(bodies, contact, 1, batch->geometry, &b);
    const struct scree_normal_law *normal = scree_normal_laws[rule->normal];
    struct scree_pressing pressing = {b.overlap[0], b.closing[0], 0.0, 0.0};
    double(*kept)[SCREE_LANES] = batch->memory ? batch->kept[block] : NULL;
    if (normal->memory) {
        pressing.first = kept[SCREE_KEPT_NORMAL][lane];
        pressing.second = kept[SCREE_KEPT_NORMAL + 1][lane];
    }
    double(*columns)[SCREE_LANES] = batch->pair[batch->uniform ? 0 : block];
    struct scree_pair_constants pair, tangential_pair = {{0.0}};
    for (int c = 0; c < SCREE_PAIR_CONSTANTS; c++) pair.c[c] = columns[c][lane];
    for (int c = SCREE_PAIR_FRICTION; c < SCREE_PAIR_LEVER; c++)
        tangential_pair.c[c - SCREE_PAIR_FRICTION] = columns[c][lane];
    struct scree_normal_force f = normal->force(&rule->normal_constants, pair, pressing);
    if (!(normal->reach ? f.second > 0.0 : b.overlap[0] > 0.0)) return 0;
    /* Until the loop has booked what attaching costs, the contact hasn't cost it. */
    int unbooked = normal->reach && !(pressing.second > 0.0);
    double force = f.elastic + f.damping * b.closing[0];
    pressing.first = f.first;
    pressing.second = f.second;
    *touch = (struct scree_touch){.ball = contact->ball, .host = contact->host, .corner = contact->corner};
    touch->edges = batch->geometry == SCREE_EDGE_EDGE;
    touch->overlap = b.overlap[0];
    touch->closing = b.closing[0];
    touch->normal_force = normal->cut && force < 0.0 ? 0.0 : force;
    touch->stored = normal->stored(&rule->normal_constants, pair, pressing);
    if (unbooked) touch->stored += snap_energy(normal->stored, &rule->normal_constants, pair);
    touch->normal = get(b.n, 0);
    touch->point = vec_add(vec_from(bodies->record[contact->ball].x), get(b.arm, 0));
    touch->slip = get(b.slip, 0);
    if (rule->friction >= 0) measure_friction(rule, tangential_pair, kept, lane, touch);
    if (rule->rolling < 0) return 1;
    double turned[6] = {0.0};
    for (int m = 0; scree_rolling_laws[rule->rolling]->memory && m < 6; m++)
        turned[m] = kept[SCREE_KEPT_ROLLING + m][lane];
    measure_turning(rule, bodies, columns[SCREE_PAIR_LEVER][lane], turned, touch);
    return 1;
}
