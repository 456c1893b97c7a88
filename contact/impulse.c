/* The pair-impulse method: every contact integrates the motion of its own two bodies against each other over the step,
 * from the state at its start, and returns the impulse J = int F dt and its first moment M = int (h - t) F dt about the
 * end of the step; the bodies gather J and M and move by them (bodies/moments.c). Inside the step
 *
 *   d' = u,  w' = a + W F(d, w)
 *
 * with the relative velocity w of the ball at the contact point in axes that turn with the normal, its closing part
 * u = -w.n, and the matrix W of accelerations per unit of force. All that the pair can't know is in a: gravity, drives,
 * the turning of the axes, and the other contacts of both bodies, whose mean accelerations of the last two steps are
 * extrapolated. Where contact begins, where the dashpot turns round (u = 0), where a slider breaks loose and where
 * contact ends is located inside the step: that is what fixed steps otherwise lose their order to. within.c does that;
 * here is what makes a pair of two bodies, and impulses of what it yields.
 *
 * The directions of J and M are those at mid-step. Everything is a function of one contact and its two bodies, summed
 * in the order of the list: the same bits for any number of threads. */
#include "bodies/pushed.h"
#include "contact/ahead.h"
#include "contact/loop.h"
#include "contact/meet.h"
#include "contact/within.h"

#include <string.h>

/* One body as a contact sees it. */
struct side {
    const struct scree_past *past;
    struct vec velocity, spin, known_turn, inverse_mass;
    struct mat inverse_inertia;
    struct vec arm; /* from its centre to the contact, m */
    double sign;    /* of the contact's force on it */
    int turns;      /* the contact can turn it */
    /* Of boxes, where a normal force of 1 N pushes elsewhere too (crossing.h): that, and its torque; both for a force
     * of the ball's sign. */
    int leans;
    struct vec n, lean, lean_turn;
};

static struct side side_of(const struct scree_bodies *bodies, const struct scree_bodies *now, int index, struct vec arm,
                           double sign, int turns) {
    return (struct side){.past = &bodies->past[index],
                         .velocity = scree_start_velocity(bodies, now, index),
                         .spin = scree_start_spin(bodies, now, index),
                         .known_turn = scree_kind_of(bodies, index)->slot < 0
                                           ? vec(0.0, 0.0, 0.0)
                                           : vec_from(scree_attitude_of(bodies, index)->known_turn),
                         .inverse_mass = vec_from(scree_kind_of(bodies, index)->inertia.inverse_mass),
                         .inverse_inertia = scree_bodies_inverse_inertia(now, index),
                         .arm = arm,
                         .sign = sign,
                         .turns = turns};
}

/* What a force on the ball at the contact does to a body: force and torque, for the ball's sign. */
static struct vec force_of(const struct side *side, struct vec force) {
    return side->leans ? vec_axpy(force, vec_dot(force, side->n), side->lean) : force;
}

static struct vec torque_of(const struct side *side, struct vec force) {
    struct vec torque = vec_cross(side->arm, force);
    return side->leans ? vec_axpy(torque, vec_dot(force, side->n), side->lean_turn) : torque;
}

/* And what the contact sees of a body that moves, turns so. */
static struct vec seen(const struct side *side, struct vec moves, struct vec turns) {
    struct vec at_contact = vec_add(moves, vec_cross(turns, side->arm));
    if (!side->leans) return at_contact;
    return vec_axpy(at_contact, vec_dot(side->lean, moves) + vec_dot(side->lean_turn, turns), side->n);
}

/* Acceleration of the body at the contact per force on the ball there. */
static struct vec give(const struct side *side, struct vec force) {
    struct vec along = vec_times(side->inverse_mass, force_of(side, force));
    if (!side->turns) return along;
    return seen(side, along, mat_apply(&side->inverse_inertia, torque_of(side, force)));
}

/* The impulses of the last two steps, extrapolated by weight `more`. */
static struct vec ahead(const double past[2][3], double more) {
    return vec_axpy(vec_from(past[0]), more, vec_sub(vec_from(past[0]), vec_from(past[1])));
}

/* What all but the pair itself is expected to do to the body at the contact, m/s^2; `own`: the pair's impulse,
 * extrapolated alike. */
static struct vec acceleration(const struct side *side, struct vec own, double more, double step) {
    struct vec push = vec_axpy(ahead(side->past->impulse, more), -side->sign, force_of(side, own));
    struct vec twist = ahead(side->past->turn, more);
    if (side->turns) twist = vec_axpy(twist, -side->sign, torque_of(side, own));
    struct vec along = vec_axpy(vec_from(side->past->known), 1.0 / step, vec_times(side->inverse_mass, push));
    struct vec turn = vec_axpy(side->known_turn, 1.0 / step, mat_apply(&side->inverse_inertia, twist));
    return seen(side, along, turn);
}

/* Geometry of a contact as records have it. */
struct view {
    struct vec normal, arm, apart;
    double overlap;
    int leans;                  /* of edges on edges, and of corners of boxes that are deep: */
    struct scree_gradient lean; /* scree_lean_of; */
    double borne;               /* scree_borne, */
    double muffled;             /* scree_muffled, else 1 */
};

/* Two boxes as the contacts before had them: a pair's contacts follow one another. */
struct pair_of_boxes {
    int ball, host; /* -1: none yet */
    int rectangles; /* whether they meet as rectangles; -1: not looked at yet */
    struct scree_two_boxes boxes;
};

static void bring_boxes(const struct scree_bodies *bodies, const struct scree_contact *contact,
                        struct pair_of_boxes *pair) {
    if (pair->ball == contact->ball && pair->host == contact->host) return;
    *pair = (struct pair_of_boxes){contact->ball, contact->host, -1, scree_deep_boxes_of(bodies, contact)};
}

static struct view view_of_crossing(const struct scree_bodies *bodies, const struct scree_contact *contact,
                                    enum scree_geometry geometry, struct pair_of_boxes *pair) {
    const struct scree_two_boxes *boxes = &pair->boxes;
    struct scree_crossing c = {.meeting = {vec(0.0, 0.0, 1.0), SCREE_OUTSIDE}};
    if (geometry == SCREE_EDGE_EDGE && pair->rectangles < 0)
        pair->rectangles = scree_meet_as_rectangles(boxes, (struct scree_rectangles){0, 0, 1});
    if (geometry == SCREE_BALL_BOX || !pair->rectangles) c = scree_cross(boxes, contact, geometry);
    struct view view = {.normal = c.meeting.normal,
                        .arm = c.point,
                        .apart = boxes->apart,
                        .overlap = c.meeting.overlap,
                        .leans = 1,
                        .borne = 1.0,
                        .muffled = 1.0};
    if (!(view.overlap > 0.0)) return view;
    view.lean = scree_lean_of(&c, boxes->apart);
    view.borne = scree_borne(&c, &view.lean, boxes->inset.by > 0.0);
    view.muffled = scree_muffled(bodies, contact, &c);
    return view;
}

/* Where its velocity at the start takes a free ball by the middle of the step, or (`half` 0) where it starts. (Records
 * show it where it is foreseen to be, pushed.h; the drift of a contact is no acceleration.) Any other: where `at` has
 * it. */
static struct vec centre_of(const struct scree_bodies *bodies, const struct scree_bodies *at, int k, double half) {
    if (bodies->class[k] != SCREE_CLASS_BALL) return vec_from(at->record[k].x);
    return vec_axpy(vec_from(bodies->position[k]), half, vec_from(bodies->state[k].v));
}

/* `at`: `bodies` itself, half a step ahead, or the start of the step, and then `half` is 0. */
static struct view view_of(const struct scree_bodies *bodies, const struct scree_bodies *at, double half,
                           const struct scree_contact *contact, enum scree_geometry geometry,
                           struct pair_of_boxes *pair) {
    if (geometry == SCREE_EDGE_EDGE || (geometry == SCREE_BALL_BOX && contact->corner > 0)) {
        bring_boxes(at, contact, pair);
        if (geometry == SCREE_EDGE_EDGE || pair->boxes.inset.by > 0.0)
            return view_of_crossing(at, contact, geometry, pair);
    }
    const struct scree_record *ball = &bodies->record[contact->ball];
    const struct scree_record *host = &bodies->record[contact->host];
    struct vec corner = scree_corner_of(at, contact, geometry);
    struct vec centre = centre_of(bodies, at, contact->ball, half), other = centre_of(bodies, at, contact->host, half);
    struct vec shift = scree_shift_of(bodies, contact, geometry);
    struct scree_meeting m =
        geometry == SCREE_BALL_BALL || geometry == SCREE_BALL_IMAGE
            ? scree_meet_ball(vec_sub(vec_add(centre, corner), shift), ball->radius, other, host->radius)
            : scree_meet_at(at, contact, geometry, vec_add(centre, corner), ball->radius);
    return (struct view){.normal = m.normal,
                         .arm = vec_axpy(corner, 0.5 * m.overlap - ball->radius, m.normal),
                         .apart = vec_sub(vec_sub(centre, other), shift),
                         .overlap = m.overlap,
                         .borne = 1.0,
                         .muffled = 1.0};
}

/* Turn a vector as the normal turns from `a` to `b`. */
static struct vec turn_along(struct vec v, struct vec a, struct vec b) {
    struct vec axis = vec_cross(a, b), once = vec_cross(axis, v);
    return vec_axpy(vec_add(v, once), 1.0 / (1.0 + vec_dot(a, b)), vec_cross(axis, once));
}

/* A contact in the loop: where it is in its batch, and where its yield goes. */
struct place {
    const struct scree_batch *batch;
    int index, lane; /* in the batch; in what follows */
    struct scree_yield *yield;
    struct scree_moments *moments;
    struct pair_of_boxes *pair; /* two: at the start of the step, and in its middle */
};

static struct scree_pair_motion laws_of(const struct scree_contacts *contacts, struct place at) {
    const struct scree_rule *rule = &contacts->rule[at.batch->rule];
    struct scree_pair_motion p = {.normal = scree_normal_laws[rule->normal],
                                  .friction = rule->friction >= 0 ? scree_friction_laws[rule->friction] : NULL,
                                  .normal_law = &rule->normal_constants,
                                  .friction_law = &rule->friction_constants};
    for (int c = 0; c < SCREE_PAIR_CONSTANTS; c++) p.normal_pair.c[c] = scree_pair(at.batch, c, at.index);
    for (int c = SCREE_PAIR_FRICTION; c < SCREE_PAIR_COLUMNS; c++)
        p.friction_pair.c[c - SCREE_PAIR_FRICTION] = scree_pair(at.batch, c, at.index);
    p.reach = p.normal->reach ? p.normal->reach(p.normal_law, p.normal_pair) : 0.0;
    p.root = p.reach > 0.0 ? 2 : p.normal->root; /* the radius of an adhesive contact ends like a root */
    if (p.friction && p.friction->root > p.root) p.root = p.friction->root;
    p.slider = p.friction && p.friction->hold;
    p.bare = p.slider && scree_is_bare(p.friction, p.friction_law, p.friction_pair);
    p.turns = !p.normal->turns_smoothly || (p.friction && p.friction->rescaled);
    p.books = contacts->measured;
    return p;
}

static void set_give(struct scree_pair_motion *p, const struct side *ball, const struct side *host) {
    double trace = 0.0;
    for (int k = 0; k < 3; k++) {
        struct vec unit = vec(k == 0, k == 1, k == 2);
        p->give.column[k] = vec_add(give(ball, unit), give(host, unit));
        trace += k == 0 ? p->give.column[k].x : k == 1 ? p->give.column[k].y : p->give.column[k].z;
    }
    p->normal_give = vec_dot(p->n, mat_apply(&p->give, p->n));
    p->sideways_give = trace - p->normal_give;
}

/* How far to extrapolate the accelerations of the last two steps: fully, as long as damping leaves room for it; a
 * coupled set of heavily damped contacts would grow. (Largest stable steps for 12 neighbours each.) */
static double extrapolation(const struct scree_pair_motion *p, const struct scree_pair_instant *at) {
    struct scree_pair_instant touching = *at;
    struct scree_pair_load load;
    if (touching.overlap < 0.0) touching.overlap = 0.0;
    scree_pair_press(p, &touching, &load);
    double rate = load.damping * p->normal_give;
    if (p->friction) {
        double normal = load.normal > 0.0 ? load.normal : 0.0;
        double slope = p->friction->slope(p->friction_law) * normal +
                       p->friction->damping(p->friction_law, p->friction_pair, touching.overlap);
        rate = fmax(rate, slope * p->sideways_give);
    }
    return fmin(fmax((0.15 - 0.5 * rate * p->step) / 0.06, 0.0), 1.0);
}

/* Pieces of a step for a stiff contact, as in lane.h: a quarter of 1/w at most. */
static int pieces_for(const struct scree_pair_motion *p, const struct scree_pair_instant *at) {
    struct scree_pair_instant touching = *at;
    struct scree_pair_load load;
    double closing = -vec_dot(at->velocity, p->n);
    if (!(touching.overlap > 0.0)) touching.overlap = p->step * fabs(closing) + SCREE_NO_SPEED;
    scree_pair_press(p, &touching, &load);
    double damped = load.damping * p->normal_give, elastic = fabs(load.normal - load.damping * closing);
    double stiff = fmax(damped * damped, 1.5 * elastic / touching.overlap * p->normal_give);
    if (p->friction) {
        double spring = p->friction->stiffness(p->friction_law, p->friction_pair, touching.overlap);
        double drag = p->friction->slope(p->friction_law) * elastic +
                      p->friction->damping(p->friction_law, p->friction_pair, touching.overlap);
        stiff = fmax(stiff, fmax(spring, drag * drag * p->sideways_give) * p->sideways_give);
    }
    return 1 + (int)fmin(4.0 * p->step * sqrt(stiff), 63.0);
}

/* `spins`: of both bodies together. */
static struct scree_pair_instant instant_of(const struct scree_pair_motion *p, struct place place, struct view now,
                                            struct vec velocity, struct vec spins) {
    struct scree_pair_instant at = {.overlap = now.overlap, .velocity = velocity};
    double *const *kept = place.batch->kept;
    int k = place.index;
    if (p->normal->memory) {
        at.first = kept[SCREE_KEPT_NORMAL][k];
        at.second = kept[SCREE_KEPT_NORMAL + 1][k];
    }
    if (p->friction && p->friction->memory) {
        struct vec stretch = vec(kept[0][k], kept[1][k], kept[2][k]);
        at.stretch = scree_turned(stretch, now.normal, spins, p->step);
        at.sliding = scree_kept(place.batch, SCREE_KEPT_STATE, k);
    }
    return at;
}

static void keep(const struct scree_pair_motion *p, struct place place, const struct scree_pair_instant *at) {
    double *const *kept = place.batch->kept;
    int k = place.index;
    if (p->normal->memory) {
        kept[SCREE_KEPT_NORMAL][k] = at->first;
        kept[SCREE_KEPT_NORMAL + 1][k] = at->second;
    }
    if (p->friction && p->friction->memory) {
        kept[0][k] = at->stretch.x + 0.0; /* zeros have no sign */
        kept[1][k] = at->stretch.y + 0.0;
        kept[2][k] = at->stretch.z + 0.0;
        scree_keep(place.batch, SCREE_KEPT_STATE, k, at->sliding);
    }
}

static void put(double column[3][SCREE_LANES], int lane, struct vec a) {
    column[0][lane] = a.x;
    column[1][lane] = a.y;
    column[2][lane] = a.z;
}

static struct vec taken(double column[3][SCREE_LANES], int lane) {
    return vec(column[0][lane], column[1][lane], column[2][lane]);
}

static struct vec past_of(const struct scree_batch *batch, int step, int k) {
    double *const *past = batch->past + SCREE_PAST_STEP * step;
    return vec(past[0][k], past[1][k], past[2][k]);
}

static void keep_past(const struct scree_batch *batch, int step, int k, struct vec impulse, double depth) {
    double *const *past = batch->past + SCREE_PAST_STEP * step;
    past[SCREE_PAST_DEPTH][k] = depth;
    past[0][k] = impulse.x + 0.0; /* zeros have no sign */
    past[1][k] = impulse.y + 0.0;
    past[2][k] = impulse.z + 0.0;
}

/* Impulse and moment on both bodies, in the directions of mid-step. */
static void write_yield(const struct scree_pair_yield *sum, struct view middle, struct vec impulse, struct vec moment,
                        int rubs, struct place place) {
    struct scree_yield *yield = place.yield;
    struct scree_moments *moments = place.moments;
    int lane = place.lane;
    struct vec host_arm = vec_add(middle.arm, middle.apart);
    double j = 0.0, m = 0.0;
    if (middle.leans) {
        j = vec_dot(impulse, middle.normal);
        m = vec_dot(moment, middle.normal);
    }
    put(yield->impulse, lane, vec_axpy(impulse, j, middle.lean.force));
    put(yield->turn_ball, lane, vec_axpy(vec_cross(middle.arm, impulse), j, middle.lean.turn_a));
    put(yield->turn_host, lane, vec_axpy(vec_cross(impulse, host_arm), j, middle.lean.turn_b));
    put(moments->impulse, lane, vec_axpy(moment, m, middle.lean.force));
    put(moments->turn_ball, lane, vec_axpy(vec_cross(middle.arm, moment), m, middle.lean.turn_a));
    put(moments->turn_host, lane, vec_axpy(vec_cross(moment, host_arm), m, middle.lean.turn_b));
    keep_past(place.batch, 1, place.index, impulse, rubs && vec_norm2(impulse) > 0.0 ? middle.overlap : 0.0);
    yield->lost.normal[lane] = sum->lost;
    yield->lost.tangential[lane] = sum->rubbed;
}

/* The velocity of the ball against its host at the contact. */
static struct vec slip_of(const struct side *ball, const struct side *host) {
    if (ball->leans) return vec_sub(seen(ball, ball->velocity, ball->spin), seen(host, host->velocity, host->spin));
    struct vec velocity = vec_sub(ball->velocity, host->velocity);
    velocity = vec_add(velocity, vec_cross(ball->spin, ball->arm));
    return vec_sub(velocity, vec_cross(host->spin, host->arm));
}

/* What the velocity at the contact gains because arms and normal turn while the bodies go on as they are. */
static struct vec drift(const struct side *ball, const struct side *host, struct view now, struct view middle,
                        struct vec velocity, double step) {
    struct vec arm = vec_scale(2.0 / step, vec_sub(middle.arm, now.arm));
    struct vec apart = vec_scale(2.0 / step, vec_sub(middle.apart, now.apart));
    struct vec normal = vec_scale(2.0 / step, vec_sub(middle.normal, now.normal));
    struct vec gain = vec_cross(ball->spin, arm);
    gain = vec_sub(gain, vec_cross(host->spin, vec_add(arm, apart)));
    if (ball->leans) {
        struct vec between = vec_sub(ball->velocity, host->velocity);
        double more = vec_dot(vec_sub(middle.lean.force, now.lean.force), between) +
                      vec_dot(vec_sub(middle.lean.turn_a, now.lean.turn_a), ball->spin) +
                      vec_dot(vec_sub(middle.lean.turn_b, now.lean.turn_b), host->spin);
        gain = vec_axpy(gain, 2.0 / step * more, now.normal);
    }
    return vec_sub(gain, vec_cross(vec_cross(now.normal, normal), velocity));
}

static void add_to(double column[3][SCREE_LANES], int lane, struct vec a) {
    column[0][lane] += a.x;
    column[1][lane] += a.y;
    column[2][lane] += a.z;
}

/* How rolling laws expect a body to move in the middle of the step: as the last step goes on. They are dashpots, and
 * what is extrapolated from two steps would bear but half as much of them as what is from one. */
static struct vec expected_velocity(const struct scree_bodies *bodies, int k, double step) {
    const struct scree_past *past = &bodies->past[k];
    if (bodies->class[k] != SCREE_CLASS_BALL) return vec_from(bodies->record[k].v);
    struct vec kick = vec_add(vec_scale(bodies->record[k].inverse_mass, vec_from(past->impulse[0])),
                              vec_scale(step, vec_from(past->known)));
    return vec_axpy(vec_from(bodies->state[k].v), 0.5, kick);
}

static struct vec expected_spin(const struct scree_bodies *bodies, int k) {
    if (bodies->class[k] != SCREE_CLASS_BALL) return scree_spin_of(bodies, k);
    struct vec momentum = vec_axpy(vec_from(bodies->state[k].l), 0.5, vec_from(bodies->past[k].turn[0]));
    return vec_scale(bodies->record[k].inverse_moment, momentum);
}

/* The part of the step that is left where a contact begins in it: 1 in any other step. */
static double part_left(const struct scree_bodies *bodies, struct place place, struct view middle, double step) {
    if (vec_norm2(past_of(place.batch, 0, place.index)) > 0.0) return 1.0;
    const struct scree_ends *contact = &place.batch->ends[place.index];
    struct vec ball = expected_velocity(bodies, contact->ball, step);
    struct vec host = expected_velocity(bodies, contact->host, step);
    double closing = -vec_dot(vec_sub(ball, host), middle.normal);
    if (!(closing > 0.0)) return 1.0;
    return fmax(scree_share_of(scree_half_steps_in(middle.overlap, closing, step)), 1e-6);
}

/* Rolling and twisting as their law sees them, at mid-step and at the predicted spins. A stretch counts from the touch
 * (scree_since_touch): of the step in which bodies meet the law sees the `time` after it. */
struct turning {
    struct scree_sliding rolling, twisting;
    double time;
};

static struct turning turning_of(const struct scree_bodies *bodies, struct place place, struct view middle,
                                 double impulse, double *const *own, double step) {
    const struct scree_ends *contact = &place.batch->ends[place.index];
    int k = place.index;
    struct vec ball = expected_spin(bodies, contact->ball), host = expected_spin(bodies, contact->host);
    struct vec velocity = vec_scale(scree_pair(place.batch, SCREE_PAIR_LEVER, k), vec_sub(ball, host));
    struct vec n = middle.normal;
    double along = vec_dot(velocity, n), time = step * part_left(bodies, place, middle, step);
    struct scree_sliding at = {
        .normal = impulse > 0.0 ? impulse / time : 0.0, .overlap = middle.overlap, .half = 0.5 * time};
    struct turning t = {at, at, time};
    t.rolling.velocity = vec_axpy(velocity, -along, n);
    t.twisting.velocity = vec(along, 0.0, 0.0);
    if (!own) return t;
    t.rolling.stretch = scree_turned(vec(own[0][k], own[1][k], own[2][k]), n, vec_add(ball, host), step);
    t.rolling.sliding = own[3][k];
    t.twisting.stretch = vec(own[4][k], 0.0, 0.0);
    t.twisting.sliding = own[5][k];
    return t;
}

/* One evaluation of the law. What slides behind a spring keeps a stretch that is late by half of what the law has seen,
 * or by a part of that (contact/slider.h), and will be taken to be late by that of a whole step. */
static struct scree_tangential resist(const struct scree_rolling_law *law, const struct scree_law_constants *constants,
                                      double coefficient, struct scree_sliding at, double step) {
    struct scree_tangential f = law->resist(constants, coefficient, at);
    double more = at.half - 0.5 * step;
    if (!(more < 0.0) || !(f.sliding > 0.0)) return f;
    double stiff = at.half * law->stiffness(constants), late = stiff / (law->damping(constants) + stiff);
    f.stretch = vec_axpy(f.stretch, more * late, at.velocity);
    return f;
}

static void keep_turning(double *const *own, int k, int touches, struct scree_tangential r, struct scree_tangential s) {
    own[0][k] = touches * r.stretch.x + 0.0; /* zeros have no sign */
    own[1][k] = touches * r.stretch.y + 0.0;
    own[2][k] = touches * r.stretch.z + 0.0;
    own[3][k] = touches * r.sliding;
    own[4][k] = touches * s.stretch.x + 0.0;
    own[5][k] = touches * s.sliding;
}

/* The rolling law of a contact that pressed with an impulse, by the rule of loop.c. */
static void roll(const struct scree_contacts *contacts, const struct scree_bodies *bodies, struct place place,
                 struct view middle, double impulse, int touches, double step) {
    const struct scree_rule *rule = &contacts->rule[place.batch->rule];
    if (rule->rolling < 0) return;
    const struct scree_rolling_law *law = scree_rolling_laws[rule->rolling];
    const struct scree_law_constants *constants = &rule->rolling_constants;
    struct scree_yield *yield = place.yield;
    struct scree_moments *moments = place.moments;
    double *const *own = law->memory ? place.batch->kept + SCREE_KEPT_ROLLING : NULL;
    int lane = place.lane;
    struct turning t = turning_of(bodies, place, middle, impulse, own, step);
    struct scree_tangential r = resist(law, constants, constants->c[SCREE_ROLLING_COEFFICIENT], t.rolling, step);
    struct scree_tangential s = resist(law, constants, constants->c[SCREE_TWISTING_COEFFICIENT], t.twisting, step);
    double lever = scree_pair(place.batch, SCREE_PAIR_LEVER, place.index);
    struct vec turn = vec_scale(t.time * lever, vec_axpy(r.force, s.force.x, middle.normal));
    struct vec moment = vec_scale(0.5 * t.time, turn);
    add_to(yield->turn_ball, lane, turn);
    add_to(yield->turn_host, lane, vec_scale(-1.0, turn));
    add_to(moments->turn_ball, lane, moment);
    add_to(moments->turn_host, lane, vec_scale(-1.0, moment));
    double power = vec_dot(r.force, t.rolling.velocity) + s.force.x * t.twisting.velocity.x;
    if (contacts->measured) yield->lost.tangential[lane] -= t.time * power;
    if (own) keep_turning(own, place.index, touches, r, s);
}

/* The same of a contact of balls, or of one and a plane, that went several at once. */
static void roll_on(const struct scree_contacts *contacts, const struct scree_bodies *bodies, struct place place,
                    double step) {
    const struct scree_batch *batch = place.batch;
    struct scree_contact contact = scree_contact_at(batch, place.index);
    struct view middle = view_of(bodies, bodies, 0.5 * step, &contact, batch->geometry, &place.pair[1]);
    struct scree_yield *yield = place.yield;
    struct vec zero = {0.0, 0.0, 0.0};
    if (contacts->rule[batch->rule].friction < 0) {
        put(yield->turn_ball, place.lane, zero);
        put(yield->turn_host, place.lane, zero);
    }
    put(place.moments->turn_ball, place.lane, zero);
    put(place.moments->turn_host, place.lane, zero);
    double impulse = vec_dot(taken(yield->impulse, place.lane), middle.normal);
    roll(contacts, bodies, place, middle, impulse, yield->lasts[place.lane] > 0.0, step);
}

static double range_of(const struct scree_bodies *bodies, int k, double step) {
    return bodies->class[k] == SCREE_CLASS_BALL ? scree_ball_range_of(bodies, k, step) : bodies->past[k].range;
}

/* Nothing can happen in this step: too far apart, and nothing kept of an earlier touch. */
static int idle(const struct scree_bodies *bodies, struct place place, double overlap, double step) {
    const struct scree_batch *batch = place.batch;
    const struct scree_ends *contact = &batch->ends[place.index];
    double ball = range_of(bodies, contact->ball, step), host = range_of(bodies, contact->host, step);
    if (!(overlap + ball + host < 0.0)) return 0;
    return !scree_keeps_something(batch, place.index);
}

static void write_nothing(struct place place) {
    struct scree_yield *yield = place.yield;
    struct scree_moments *moments = place.moments;
    for (int k = 0; k < 3; k++) {
        yield->impulse[k][place.lane] = yield->turn_ball[k][place.lane] = yield->turn_host[k][place.lane] = 0.0;
        moments->impulse[k][place.lane] = moments->turn_ball[k][place.lane] = moments->turn_host[k][place.lane] = 0.0;
    }
    yield->steep[place.lane] = yield->lost.normal[place.lane] = yield->lost.tangential[place.lane] = 0.0;
}

/* What becomes of a contact in a step. */
struct outcome {
    struct scree_pair_motion p;
    struct scree_pair_instant at; /* at the end */
    struct scree_pair_yield sum;
    struct view now, middle;
};

/* One contact through one step, without a trace. Returns 0 if nothing can happen. */
static int reckon(const struct scree_contacts *contacts, const struct scree_bodies *bodies,
                  const struct scree_bodies *bodies_now, struct place place, double step, struct outcome *o) {
    const struct scree_batch *batch = place.batch;
    struct scree_contact named = scree_contact_at(batch, place.index), *contact = &named;
    struct view now = o->now = view_of(bodies, bodies_now, 0.0, contact, batch->geometry, &place.pair[0]);
    if (idle(bodies, place, now.overlap, step)) return 0;
    struct view middle = view_of(bodies, bodies, 0.5 * step, contact, batch->geometry, &place.pair[1]);
    /* Beyond an edge the normal may jump, or the partner be out of sight at mid-step: then the start of the step
     * counts. */
    if (vec_dot(now.normal, middle.normal) < 0.9 || middle.overlap < 0.5 * SCREE_OUTSIDE) middle = now;
    o->middle = middle;
    int turns = scree_contact_turns(batch, contact);
    struct side ball = side_of(bodies, bodies_now, contact->ball, now.arm, 1.0, turns);
    struct side host = side_of(bodies, bodies_now, contact->host, vec_add(now.arm, now.apart), -1.0, turns);
    if (now.leans) {
        ball.leans = host.leans = 1;
        ball.n = host.n = now.normal;
        ball.lean = host.lean = now.lean.force;
        ball.lean_turn = now.lean.turn_a;
        host.lean_turn = vec_scale(-1.0, now.lean.turn_b);
    }

    struct scree_pair_motion *p = &o->p;
    *p = laws_of(contacts, place);
    p->n = now.normal;
    int at_now = !(middle.overlap > 0.0);
    p->muffled = at_now ? now.muffled : middle.muffled;
    p->borne = at_now ? now.borne : middle.borne;
    if (p->friction && batch->geometry == SCREE_BALL_BOX && scree_may_be_relieved(bodies, contact))
        p->relief = scree_relief(at_now ? bodies_now : bodies, &contacts->rule[batch->rule], contact,
                                 &place.pair[!at_now].boxes);
    p->step = step;
    set_give(p, &ball, &host);
    struct vec velocity = slip_of(&ball, &host);
    o->at = instant_of(p, place, now, velocity, vec_add(ball.spin, host.spin));
    o->sum = (struct scree_pair_yield){.lost = 0.0};
    /* Corners bear all; the plain normal would foretell a touch. */
    int covered = batch->geometry == SCREE_EDGE_EDGE && now.overlap == 0.0;
    if (now.overlap > 0.5 * SCREE_OUTSIDE && p->normal_give > 0.0 && !covered) {
        double more = extrapolation(p, &o->at);
        int pieces = pieces_for(p, &o->at);
        p->substeps = contacts->substeps                                ? contacts->substeps * pieces
                      : (p->friction || p->normal->bends) && pieces < 2 ? 2
                                                                        : pieces;
        struct vec last = past_of(batch, 0, place.index);
        struct vec own = vec_axpy(last, more, vec_sub(last, past_of(batch, 1, place.index)));
        p->a = vec_sub(acceleration(&ball, own, more, step), acceleration(&host, own, more, step));
        p->a = vec_add(p->a, drift(&ball, &host, now, middle, velocity, step));
        o->sum = scree_pair_act(p, &o->at);
    }
    if (covered) o->at = (struct scree_pair_instant){.overlap = 0.0};
    return 1;
}

/* One contact through one step. */
static void impel(const struct scree_contacts *contacts, const struct scree_bodies *bodies,
                  const struct scree_bodies *bodies_now, struct place place, double step) {
    const struct scree_batch *batch = place.batch;
    const struct scree_ends *contact = &batch->ends[place.index];
    const struct scree_record *a = &bodies->record[contact->ball], *b = &bodies->record[contact->host];
    double limit = fmin(bodies->spin[contact->ball].limit, bodies->spin[contact->host].limit);
    struct outcome o;
    int acts = reckon(contacts, bodies, bodies_now, place, step, &o);
    place.yield->depth[place.lane] = o.now.overlap / limit;
    if (!acts) {
        write_nothing(place);
        return;
    }
    keep(&o.p, place, &o.at);
    struct vec now = o.now.normal, middle = o.middle.normal, impulse = turn_along(o.sum.impulse, now, middle);
    write_yield(&o.sum, o.middle, impulse, turn_along(o.sum.moment, now, middle), o.p.friction != NULL, place);
    roll(contacts, bodies, place, o.middle, vec_dot(impulse, middle), o.at.overlap > 0.0, step);
    place.yield->steep[place.lane] =
        scree_steepness(vec_dot(impulse, middle), batch->slope, a->inverse_mass + b->inverse_mass);
}

/* What will be shown of a body: by then it is at hand. */
static void prefetch_start(const struct scree_bodies *bodies, int k) {
    scree_prefetch_line(&bodies->state[k]);
    scree_prefetch_line(&bodies->position[k]);
    SCREE_PREFETCH(bodies->past, k, k + 1);
}

/* Those of a block that go several at once; the others become lanes `base` … of a window. Returns how many. */
static int impel_block(const struct scree_contacts *contacts, const struct scree_bodies *bodies,
                       const struct scree_bodies *now, const struct scree_batch *batch, int first, int count,
                       double step, int base, int *lane, struct scree_starts *starts, struct scree_yield *yield,
                       struct scree_moments *moments) {
    const struct scree_loop *loop = count <= 8 ? contacts->loop_for_few : contacts->loop;
    const struct scree_ends *own = batch->ends + first;
    struct scree_ends *slot = starts->slot + base;
    int left = 0;
    yield->silent = 0;
    uint32_t done = loop->hold_steady(contacts, bodies, batch, first, count, step, yield, moments);
    if (!done) {
        loop->show(bodies, now, own, NULL, count, step, slot, starts);
        done = loop->impel(contacts, now, starts, slot, batch, first, count, step, yield, moments);
    }
    for (int k = 0; k < count; k++) {
        if (done >> k & 1) continue;
        lane[left++] = base + k;
        prefetch_start(bodies, own[k].ball);
        prefetch_start(bodies, own[k].host);
    }
    return left;
}

/* Where a lane of a window is. */
static struct place place_of(const struct scree_batch *batch, int first, int lane, struct scree_yield *yield,
                             struct scree_moments *moments, struct pair_of_boxes *pair) {
    int block = lane / SCREE_LANES;
    return (struct place){batch, first + lane, lane % SCREE_LANES, &yield[block], &moments[block], pair};
}

void scree_impel_window(const struct scree_contacts *contacts, const struct scree_bodies *bodies,
                        const struct scree_bodies *now, const struct scree_batch *batch, int first, int count,
                        double step, struct scree_yield *yield, struct scree_moments *moments, uint32_t *odd) {
    int lane[SCREE_WINDOW_LANES], left = 0, rolls = contacts->rule[batch->rule].rolling >= 0;
    struct pair_of_boxes pair[2] = {{.ball = -1}, {.ball = -1}};
    struct scree_starts starts;
    scree_begin_starts(&starts);
    for (int from = 0, block = 0; from < count; from += SCREE_LANES, block++) {
        int here = count - from < SCREE_LANES ? count - from : SCREE_LANES;
        odd[block] = 0;
        left += impel_block(contacts, bodies, now, batch, first + from, here, step, from, &lane[left], &starts,
                            &yield[block], &moments[block]);
    }
    const struct scree_loop *loop = left <= 4 ? contacts->loop_for_few : contacts->loop;
    if (left) {
        loop->show(bodies, now, batch->ends + first, lane, left, step, starts.slot, &starts);
        left = loop->impel_few(contacts, now, &starts, batch, first, lane, left, step, yield, moments);
    }
    for (int i = 0; i < left; i++) {
        odd[lane[i] / SCREE_LANES] |= (uint32_t)1 << lane[i] % SCREE_LANES;
        impel(contacts, bodies, now, place_of(batch, first, lane[i], yield, moments, pair), step);
    }
    for (int k = 0; rolls && k < count; k++)
        if (!(odd[k / SCREE_LANES] >> k % SCREE_LANES & 1))
            roll_on(contacts, bodies, place_of(batch, first, k, yield, moments, pair), step);
}

void scree_contacts_keep_impulses(struct scree_contacts *contacts, int substeps) {
    for (int k = 0; k < contacts->batches; k++) contacts->batch[k].impulses = 1;
    contacts->substeps = substeps;
}

void scree_contacts_begin_past(struct scree_contacts *contacts, struct scree_bodies *bodies,
                               const struct scree_bodies *now, double step) {
    for (int k = 0; k < bodies->count; k++) memset(&bodies->past[k], 0, sizeof bodies->past[k]);
    for (int b = 0; b < contacts->batches; b++) {
        struct scree_batch *batch = &contacts->batch[b];
        for (int k = scree_first(batch); k >= 0; k = scree_next(batch, k)) {
            struct scree_kick kick = scree_kick_now(contacts, now, b, k, step);
            if (kick.ball < 0) continue;
            for (int s = 0; s < 2; s++) {
                struct scree_past *ball = &bodies->past[kick.ball], *host = &bodies->past[kick.host];
                vec_store(vec_add(vec_from(ball->impulse[s]), kick.impulse), ball->impulse[s]);
                vec_store(vec_sub(vec_from(host->impulse[s]), kick.impulse), host->impulse[s]);
                vec_store(vec_add(vec_from(ball->turn[s]), kick.turn_ball), ball->turn[s]);
                vec_store(vec_add(vec_from(host->turn[s]), kick.turn_host), host->turn[s]);
                keep_past(batch, s, k, kick.straight, contacts->rule[batch->rule].friction >= 0 ? kick.overlap : 0.0);
            }
        }
    }
}
