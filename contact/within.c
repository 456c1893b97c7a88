/* One contact inside one step of the pair-impulse method: where contact begins, where the dashpot turns round, where
 * the law changes its formula, where a slider breaks loose or holds again and where contact ends is located; between
 * these points classical Runge-Kutta, whose variables are overlap and velocity, so that a contact at rest is a fixed
 * point of it to rounding. */
#include "contact/within.h"

#include "contact/slider.h"

/* Of the searches for an event inside a step, each at least halves its bracket every third time. A ball that bounces to
 * rest within a step touches a few times; its contacts last, so there is an end to them. A slider that would break
 * loose and hold again more often stays as it is. */
enum { TRIES = 16, MOST_TOUCHES = 64, MOST_SLIPS = 8 };

static inline double closing_of(const struct scree_pair_motion *p, const struct scree_pair_instant *at) {
    return -vec_dot(at->velocity, p->n);
}

/* As laws are told of it. */
static inline double told_of(const struct scree_pair_motion *p, const struct scree_pair_instant *at) {
    return closing_of(p, at) / p->muffled;
}

void scree_pair_press(const struct scree_pair_motion *p, const struct scree_pair_instant *at,
                      struct scree_pair_load *load) {
    double closing = told_of(p, at);
    struct scree_pressing pressing = scree_pressed(at->overlap, closing, at->first, at->second);
    struct scree_normal_force f = p->normal->force(p->normal_law, p->normal_pair, pressing);
    load->normal = f.elastic + f.damping * closing;
    load->damping = f.damping / p->muffled;
    load->first = f.first;
    load->second = f.second;
    load->force = vec_scale(load->normal, p->n);
}

/* Positive while the contact lasts, zero where it ends. Where the law is cut, the force over its damping rather than
 * the force: k d/c + u has no root of d in it. */
static double lasting(const struct scree_pair_motion *p, const struct scree_pair_instant *at) {
    if (p->normal->reach || !p->normal->cut) return at->overlap + p->reach;
    double closing = closing_of(p, at);
    if (at->overlap <= 0.0) return closing < 0.0 ? closing : at->overlap / p->step;
    struct scree_pair_load load;
    scree_pair_press(p, at, &load);
    return load.normal / (load.damping + 1e-6 / (p->normal_give * p->step));
}

/* A dashpot that still pushes apart what doesn't touch any more, in a step beyond its end, bears no friction. */
static struct scree_sliding sliding_of(const struct scree_pair_motion *p, const struct scree_pair_instant *at,
                                       double normal) {
    double load = at->overlap + p->reach < 0.0 ? 0.0 : normal * p->borne - p->relief;
    struct scree_sliding sliding = {.normal = load > 0.0 ? load : 0.0, .overlap = at->overlap};
    double closing = closing_of(p, at);
    sliding.closing = closing / p->muffled;
    sliding.velocity = vec_axpy(at->velocity, closing, p->n);
    sliding.stretch = at->stretch;
    sliding.sliding = at->sliding;
    return sliding;
}

/* Friction of a law that isn't a slider, added to the load of an instant; what the law makes of its memory there is
 * kept. */
static void rub(const struct scree_pair_motion *p, struct scree_pair_instant *at, struct scree_pair_load *load) {
    struct scree_sliding sliding = sliding_of(p, at, load->normal);
    struct scree_tangential f = p->friction->force(p->friction_law, p->friction_pair, sliding);
    load->force = vec_add(load->force, f.force);
    load->rubbing = -vec_dot(f.force, sliding.velocity);
    if (!p->friction->memory) return;
    at->stretch = f.stretch;
    at->sliding = f.sliding;
}

static int has_bristles(const struct scree_pair_motion *p) { return p->friction && p->friction->memory && !p->slider; }

/* The memory of such a law after `time` at the velocity and overlap of `at` and under a load, by its own rule, into
 * `to`. Returns the force of that time, N. */
static struct vec drag(const struct scree_pair_motion *p, const struct scree_pair_instant *from,
                       const struct scree_pair_instant *at, double normal, double time, struct scree_pair_instant *to) {
    struct scree_sliding sliding = sliding_of(p, at, normal);
    sliding.stretch = from->stretch;
    sliding.sliding = from->sliding;
    sliding.half = 0.5 * time;
    struct scree_tangential f = p->friction->force(p->friction_law, p->friction_pair, sliding);
    to->stretch = f.stretch;
    to->sliding = f.sliding;
    return f.force;
}

/* A slider at an instant whose overlap, velocity and normal force are set: spring, dashpot and what it bears. */
static struct scree_drawn brace(const struct scree_pair_motion *p, const struct scree_pair_instant *at, double normal) {
    struct scree_sliding sliding = sliding_of(p, at, normal);
    double overlap = at->overlap > 0.0 ? at->overlap : 0.0;
    struct scree_hold hold = scree_hold_on(p->friction, p->friction_law, sliding, at->inside);
    return (struct scree_drawn){.k = p->friction->stiffness(p->friction_law, p->friction_pair, overlap),
                                .drag = p->friction->damping(p->friction_law, p->friction_pair, overlap),
                                .limit = hold.slides,
                                .slip = sliding.velocity,
                                .holds = hold.holds};
}

/* What spring and dashpot would bear if the slider held, N. */
static struct vec trial_of(const struct scree_drawn *drawn) {
    return vec_axpy(vec_scale(drawn->k, drawn->stretch), drawn->drag, drawn->slip);
}

/* What the normal law remembers at the end of a piece. */
static void remember(const struct scree_pair_motion *p, struct scree_pair_instant *at) {
    struct scree_pair_load load;
    if (!p->normal->memory) return;
    scree_pair_press(p, at, &load);
    at->first = load.first;
    at->second = load.second;
}

/* Energy in the normal direction that the contact gives back, J; only reckoned if the books are kept. */
static double stored(const struct scree_pair_motion *p, const struct scree_pair_instant *at) {
    if (!p->books || (at->overlap <= 0.0 && !(at->second > 0.0))) return 0.0;
    struct scree_pressing pressing = scree_pressed(at->overlap, told_of(p, at), at->first, at->second);
    return p->normal->stored(p->normal_law, p->normal_pair, pressing);
}

/* The four stages of one Runge-Kutta step: times since the first, s; `along` is dt/d(variable) at each. Of a slider,
 * what it is at the first; what it remembers is its force or, if `in_stretch`, its stretch, which goes on at `rate`,
 * N/s or m/s. */
struct stages {
    struct scree_pair_instant at[4];
    struct scree_pair_load load[4];
    double time[4], along[4];
    struct scree_drawn first;
    struct vec rate[4];
    double left[4]; /* how far from changing (scree_left) */
    int in_stretch;
};

static const double weight[4] = {1.0 / 6.0, 2.0 / 6.0, 2.0 / 6.0, 1.0 / 6.0}, node[4] = {0.0, 0.5, 0.5, 1.0};

/* Whether the slider of a step that begins with `at` goes by its stretch: so does a force that falls with the stiffness
 * while the overlap does, which it does throughout a piece or not at all. */
static int goes_by_stretch(const struct scree_pair_motion *p, const struct scree_pair_instant *at, double normal,
                           double time) {
    if (!p->friction->rescaled) return !p->friction->in_force;
    double speeding = -vec_dot(p->a, p->n) - p->normal_give * normal;
    return closing_of(p, at) + 0.5 * time * speeding < 0.0;
}

static void push_back(const struct scree_drawn *drawn, struct scree_pair_load *load) {
    load->force = vec_sub(load->force, drawn->carries);
    load->rubbing = vec_dot(drawn->carries, drawn->slip);
}

/* A slider where a step begins. A bare spring that slides has the stretch of its force. */
static void grip_first(const struct scree_pair_motion *p, struct stages *s, double time) {
    struct scree_pair_instant *at = &s->at[0];
    struct scree_drawn *drawn = &s->first;
    *drawn = brace(p, at, s->load[0].normal);
    s->in_stretch = goes_by_stretch(p, at, s->load[0].normal, time);
    drawn->stretch = p->friction->in_force ? vec_scale(1.0 / drawn->k, at->stretch) : at->stretch;
    struct vec trial = trial_of(drawn);
    double scale = at->sliding > 0.0 ? drawn->limit / (vec_norm(trial) + SCREE_NO_SPEED) : 1.0;
    drawn->carries = vec_scale(scale, trial);
    if (p->bare) drawn->stretch = vec_scale(scale, drawn->stretch);
    at->stretch = vec_scale(s->in_stretch ? 1.0 : drawn->k, drawn->stretch);
    s->rate[0] = vec_scale(s->in_stretch ? 1.0 : drawn->k, drawn->slip);
}

/* A slider at an instant `time` after the first stage; `remembers` is what it has kept if it has held since. What it
 * keeps is put there. */
static struct scree_drawn grip_later(const struct scree_pair_motion *p, const struct stages *s, double time,
                                     struct vec remembers, double normal, struct scree_pair_instant *at) {
    struct scree_drawn drawn = brace(p, at, normal), first = s->first;
    double share = s->in_stretch ? 1.0 : first.k / drawn.k, unit = s->in_stretch ? 1.0 : drawn.k;
    if (at->sliding > 0.0) {
        if (!s->in_stretch) first.stretch = vec_scale(1.0 / drawn.k, s->at[0].stretch);
        scree_draw_on(&first, share, time, p->bare, &drawn);
    } else {
        drawn.stretch = vec_scale(1.0 / unit, remembers);
        drawn.carries = trial_of(&drawn);
    }
    at->stretch = vec_scale(unit, drawn.stretch);
    return drawn;
}

static double left_of(const struct scree_pair_motion *p, const struct scree_pair_instant *at,
                      const struct scree_drawn *drawn) {
    return scree_left(p->bare, at->sliding, vec_norm2(trial_of(drawn)), drawn->holds, drawn->limit);
}

/* Forces at stage k, whose time, overlap and velocity are set; `size` is that of the step in its variable, which ends
 * after `time`. */
static void load_stage(const struct scree_pair_motion *p, struct stages *s, int k, double size, double time) {
    struct scree_pair_instant *at = &s->at[k];
    struct scree_pair_load *load = &s->load[k];
    double share = k > 0 ? node[k] * size * s->along[k - 1] : 0.0;
    scree_pair_press(p, at, load);
    load->rubbing = 0.0;
    if (p->slider && k == 0) {
        grip_first(p, s, time);
        s->left[0] = left_of(p, at, &s->first);
        push_back(&s->first, load);
    } else if (p->slider) {
        struct vec remembers = vec_axpy(s->at[0].stretch, share, s->rate[k - 1]);
        struct scree_drawn drawn = grip_later(p, s, s->time[k], remembers, load->normal, at);
        s->rate[k] = vec_scale(s->in_stretch ? 1.0 : drawn.k, drawn.slip);
        s->left[k] = left_of(p, at, &drawn);
        push_back(&drawn, load);
    } else if (p->friction) {
        double between = 0.5 * (s->load[0].normal + load->normal); /* on the way there */
        if (p->friction->memory && k > 0) drag(p, &s->at[0], &s->at[k - 1], between, share, at);
        rub(p, at, load);
    }
}

/* What a slider remembers at the end, whose overlap and velocity are set, and whether it may have changed. */
static void finish_slider(const struct scree_pair_motion *p, const struct stages *s, double size, double time,
                          struct scree_pair_instant *end, struct scree_pair_yield *yield) {
    struct scree_pair_load load;
    struct vec remembers = s->at[0].stretch;
    for (int k = 0; k < 4; k++) remembers = vec_axpy(remembers, weight[k] * size * s->along[k], s->rate[k]);
    scree_pair_press(p, end, &load);
    struct scree_drawn drawn = grip_later(p, s, time, remembers, load.normal, end);
    if (p->friction->in_force && s->in_stretch) end->stretch = vec_scale(drawn.k, end->stretch);
    double last = left_of(p, end, &drawn);
    yield->dips = scree_dips(s->left[0], 0.5 * (s->left[1] + s->left[2]), last, s->first.limit) > 0.0;
    yield->below = last < 0.0;
}

/* Of the four stages, at a quarter and at three quarters of the step in its variable: on the parabola through its ends
 * and its middle. */
static const double at_quarter[2][4] = {{0.375, 0.375, 0.375, -0.125}, {-0.125, 0.375, 0.375, 0.375}};

/* Bristles through a step of length `time`, by their own rule in two halves; the stages tell how they are dragged. At
 * an instant they may be anywhere around where they settle, if that is stiff: what they bear on an average takes the
 * place of what the stages have, whose forces are those of the normal law then. */
static struct scree_pair_yield bend_through(const struct scree_pair_motion *p, struct stages *s, double time,
                                            struct scree_pair_instant *end) {
    struct scree_pair_yield sum = {.lost = 0.0};
    struct scree_pair_instant now = s->at[0];
    double left = time;
    for (int late = 0; late < 2; late++) {
        double part = late ? time - s->time[1] : s->time[1];
        struct scree_pair_instant at = {.overlap = 0.0};
        double normal = 0.0;
        for (int k = 0; k < 4; k++) {
            at.overlap += at_quarter[late][k] * s->at[k].overlap;
            at.velocity = vec_axpy(at.velocity, at_quarter[late][k], s->at[k].velocity);
            normal += at_quarter[late][k] * s->load[k].normal;
        }
        struct vec bears = drag(p, &now, &at, normal, part, &now);
        sum.impulse = vec_axpy(sum.impulse, part, bears);
        sum.moment = vec_axpy(sum.moment, part * (left - 0.5 * part), bears);
        sum.rubbed -= part * vec_dot(bears, at.velocity);
        left -= part;
    }
    for (int k = 0; k < 4; k++) {
        s->load[k].force = vec_scale(s->load[k].normal, p->n);
        s->load[k].rubbing = 0.0;
    }
    end->stretch = now.stretch;
    end->sliding = now.sliding;
    return sum;
}

/* The memories at the end of a step of length `time`, whose overlap and velocity are set, and the work done in it. */
static void finish_stages(const struct scree_pair_motion *p, const struct stages *s, double size, double time,
                          struct scree_pair_instant *end, struct scree_pair_yield *yield) {
    yield->lost = 0.0;
    for (int k = 0; k < 4; k++) {
        double share = weight[k] * size * s->along[k];
        yield->lost += share * s->load[k].normal * closing_of(p, &s->at[k]);
        yield->rubbed += share * s->load[k].rubbing;
    }
    yield->dips = yield->below = 0;
    if (p->slider) finish_slider(p, s, size, time, end, yield);
    remember(p, end);
    yield->lost -= stored(p, end) - stored(p, &s->at[0]); /* the work of the force that isn't there any more */
}

/* One Runge-Kutta step over `time`. */
static struct scree_pair_instant move(const struct scree_pair_motion *p, const struct scree_pair_instant *from,
                                      double time, struct scree_pair_yield *yield) {
    struct stages s = {.at = {*from, *from, *from, *from}, .along = {1.0, 1.0, 1.0, 1.0}};
    load_stage(p, &s, 0, time, time);
    for (int k = 1; k < 4; k++) {
        s.time[k] = node[k] * time;
        struct vec pull = vec_add(p->a, mat_apply(&p->give, s.load[k - 1].force));
        s.at[k].overlap = from->overlap + node[k] * time * closing_of(p, &s.at[k - 1]);
        s.at[k].velocity = vec_axpy(from->velocity, node[k] * time, pull);
        s.at[k].stretch = s.at[0].stretch;
        load_stage(p, &s, k, time, time);
    }
    struct scree_pair_instant end = s.at[0];
    struct scree_pair_yield bristles = {.lost = 0.0};
    if (has_bristles(p)) bristles = bend_through(p, &s, time, &end);
    struct vec ends = vec_add(s.load[0].force, s.load[3].force), inner = vec_add(s.load[1].force, s.load[2].force);
    yield->impulse = vec_axpy(bristles.impulse, time / 6.0, vec_axpy(ends, 2.0, inner));
    yield->moment = vec_axpy(bristles.moment, time * time / 6.0, vec_add(s.load[0].force, inner));
    yield->rubbed = bristles.rubbed;
    struct vec kick = vec_axpy(mat_apply(&p->give, yield->impulse), time, p->a);
    struct vec shift = vec_axpy(mat_apply(&p->give, yield->moment), 0.5 * time * time, p->a);
    shift = vec_axpy(shift, time, from->velocity);
    end.velocity = vec_add(from->velocity, kick);
    end.overlap = from->overlap - vec_dot(shift, p->n);
    finish_stages(p, &s, time, time, &end, yield);
    return end;
}

/* ---- where the force sets in, or ends, as a root of the overlap ---- */

/* How near, in time, a piece is to an overlap of zero: since the one behind, until the one ahead; negative: too far to
 * matter. */
struct nearness {
    double since, until;
};

static const struct nearness far = {-1.0, -1.0};

static struct nearness nearness_of(const struct scree_pair_motion *p, const struct scree_pair_instant *at,
                                   double time) {
    struct nearness near = far;
    double closing = closing_of(p, at);
    double left = at->overlap + p->reach;
    if (p->root < 2 || closing == 0.0 || left < 0.0) return near;
    double distance = left / fabs(closing);
    if (closing > 0.0 && distance < 6.0 * time && p->reach == 0.0) near.since = distance;
    if (closing < 0.0 && distance < 7.0 * time && !p->normal->cut) near.until = distance;
    return near;
}

/* The state after the time `t` since `from`, in which the contact has yielded so much. */
static void place(const struct scree_pair_motion *p, const struct scree_pair_instant *from, double t,
                  const struct scree_pair_yield *yield, struct scree_pair_instant *at) {
    struct vec shift = vec_axpy(mat_apply(&p->give, yield->moment), 0.5 * t * t, p->a);
    at->velocity = vec_add(from->velocity, vec_axpy(mat_apply(&p->give, yield->impulse), t, p->a));
    at->overlap = from->overlap - vec_dot(vec_axpy(shift, t, from->velocity), p->n);
}

/* Time as the p-th power of a variable that runs from `first` by `size` to its end, so that force and motion are smooth
 * in it: t = sigma^p span - since behind a begin, until - span (1 - sigma)^p before an end. */
struct clock {
    double since, until, span, first, size, time;
    int root, pieces, backwards;
};

static struct clock clock_for(const struct scree_pair_motion *p, struct nearness near, double time) {
    struct clock c = {.root = p->root, .time = time, .backwards = near.since < 0.0};
    double rest = c.backwards ? fmax(near.until - time, 0.0) : near.since;
    c.since = near.since;
    c.until = time + rest;
    c.span = time + rest;
    double nearest = c.span > 0.0 ? scree_whole_root(rest / c.span, c.root) : 0.0;
    c.pieces = rest < 1.5 * time ? 4 : 1;
    if (c.pieces < p->substeps) c.pieces = p->substeps;
    c.first = c.backwards ? 0.0 : nearest;
    c.size = (1.0 - nearest) / c.pieces;
    return c;
}

/* Time after `ticks` of `size`, and its derivative by the variable. */
static double clock_time(const struct clock *c, double ticks, double *along) {
    double sigma = c->first + c->size * ticks, x = c->backwards ? 1.0 - sigma : sigma;
    double lower = scree_whole_power(x, c->root - 1);
    *along = c->span * c->root * lower;
    if (ticks == c->pieces) return c->time;
    if (ticks == 0.0) return 0.0;
    return c->backwards ? c->until - c->span * lower * x : c->span * lower * x - c->since;
}

/* One Runge-Kutta step of `move_by_clock`: J and M themselves are the states. */
static void tick(const struct scree_pair_motion *p, const struct clock *c, const struct scree_pair_instant *from,
                 int piece, struct scree_pair_instant *now, struct scree_pair_yield *yield) {
    struct stages s = {.at = {*now, *now, *now, *now}};
    struct scree_pair_yield sum = *yield, bristles = {.lost = 0.0}, part = bristles;
    struct vec impulse[4];
    double size = c->size, ignored;
    double before = clock_time(c, piece, &ignored), after = clock_time(c, piece + 1, &ignored);
    for (int k = 0; k < 4; k++) {
        double t = clock_time(c, piece + node[k], &s.along[k]);
        s.time[k] = t - before;
        struct scree_pair_yield state = *yield;
        if (k > 0) {
            double share = node[k] * size * s.along[k - 1];
            state.impulse = vec_axpy(yield->impulse, share, s.load[k - 1].force);
            state.moment = vec_axpy(yield->moment, share, impulse[k - 1]);
            place(p, from, t, &state, &s.at[k]);
            s.at[k].stretch = s.at[0].stretch;
            s.at[k].sliding = s.at[0].sliding;
        }
        impulse[k] = state.impulse;
        load_stage(p, &s, k, size, after - before);
    }
    *now = s.at[0];
    if (has_bristles(p)) {
        bristles = bend_through(p, &s, after - before, now);
        for (int k = 1; k < 4; k++)
            impulse[k] = vec_axpy(yield->impulse, node[k] * size * s.along[k - 1], s.load[k - 1].force);
    }
    for (int k = 0; k < 4; k++) {
        sum.impulse = vec_axpy(sum.impulse, weight[k] * size * s.along[k], s.load[k].force);
        sum.moment = vec_axpy(sum.moment, weight[k] * size * s.along[k], impulse[k]);
    }
    sum.impulse = vec_add(sum.impulse, bristles.impulse);
    sum.moment = vec_add(sum.moment, bristles.moment);
    part.rubbed = bristles.rubbed;
    place(p, from, after, &sum, now);
    finish_stages(p, &s, size, after - before, now, &part);
    sum.lost += part.lost;
    sum.rubbed += part.rubbed;
    sum.dips |= sum.below; /* its pieces are short; what begins like a root's tenth power is no parabola */
    sum.below = part.below;
    *yield = sum;
}

/* As move, near the begin or end of a contact whose force isn't smooth there. */
static struct scree_pair_instant move_by_clock(const struct scree_pair_motion *p, const struct scree_pair_instant *from,
                                               struct nearness near, double time, struct scree_pair_yield *yield) {
    struct clock c = clock_for(p, near, time);
    struct scree_pair_instant now = *from;
    *yield = (struct scree_pair_yield){.lost = 0.0};
    for (int piece = 0; piece < c.pieces; piece++) tick(p, &c, from, piece, &now, yield);
    return now;
}

/* One piece of a step, by whichever variable suits. */
static struct scree_pair_instant go(const struct scree_pair_motion *p, const struct scree_pair_instant *from,
                                    struct nearness near, double time, struct scree_pair_yield *yield) {
    int smooth = near.since < 0.0 && near.until < 0.0;
    return smooth ? move(p, from, time, yield) : move_by_clock(p, from, near, time, yield);
}

/* ---- events inside a step ---- */

enum event { TURNS, PRESSES, ENDS, SLIPS, CROSSES };

/* The contact a little later, whose force is known; only overlap and velocity. */
static struct scree_pair_instant soon_after(const struct scree_pair_motion *p, const struct scree_pair_instant *at,
                                            struct vec force, double time) {
    struct scree_pair_instant next = *at;
    struct vec pull = vec_add(p->a, mat_apply(&p->give, force));
    next.overlap += time * closing_of(p, at);
    next.velocity = vec_axpy(at->velocity, time, pull);
    return next;
}

/* What a slider that holds could still bear, N; by how much more (N) one that slides would have to bear if it held; the
 * force of a bare spring can't be more than what it slides with: by how much faster (m/s) it is dragged than what it
 * remembers grows as its load allows. `from`: where the piece began that ends here; NULL: here one begins, and what
 * is nearly so counts as so. */
static double gripping(const struct scree_pair_motion *p, const struct scree_pair_instant *at,
                       const struct scree_pair_instant *from) {
    struct scree_pair_load load;
    scree_pair_press(p, at, &load);
    struct scree_drawn drawn = brace(p, at, load.normal);
    drawn.stretch = p->friction->in_force ? vec_scale(1.0 / drawn.k, at->stretch) : at->stretch;
    double bears = vec_norm(trial_of(&drawn)), soon = (from ? -SCREE_SO_SOON : SCREE_SO_SOON) * p->step;
    double nearly = from ? 0.0 : scree_nearly(p->bare, at->sliding, drawn.limit, drawn.k, p->step);
    if (!(at->sliding > 0.0)) return drawn.holds - bears + nearly;
    if (!p->bare) return bears - drawn.limit + nearly;
    struct vec along = vec_axpy(drawn.stretch, 1e-12 * p->step, drawn.slip); /* no stretch yet at the very begin */
    along = vec_scale(1.0 / (vec_norm(along) + SCREE_NO_SPEED), along);
    struct scree_pair_instant later = soon_after(p, at, vec_axpy(load.force, -drawn.limit, along), soon);
    later.first = from ? from->first : at->first;
    later.second = from ? from->second : at->second;
    int in_stretch = goes_by_stretch(p, at, load.normal, 0.0);
    scree_pair_press(p, &later, &load);
    struct scree_drawn next = brace(p, &later, load.normal);
    double growth = (next.limit / (in_stretch ? next.k : drawn.k) - drawn.limit / drawn.k) / soon;
    return vec_dot(drawn.slip, along) - growth + nearly;
}

/* Of a slider whose hold jumps at a speed: how far it is from there, m/s. */
static double keeping(const struct scree_pair_motion *p, const struct scree_pair_instant *at) {
    double left = p->friction->band(p->friction_law) - vec_norm(sliding_of(p, at, 0.0).velocity);
    return at->inside ? left : -left;
}

static double pulling(const struct scree_pair_motion *p, const struct scree_pair_instant *at) {
    struct scree_pair_load load;
    scree_pair_press(p, at, &load);
    return -load.normal;
}

/* How fast bodies go on approaching, or parting, as they did at the begin of the piece, m/s. */
static double turning(const struct scree_pair_motion *p, const struct scree_pair_instant *at,
                      const struct scree_pair_instant *from) {
    return closing_of(p, from) < 0.0 ? -closing_of(p, at) : closing_of(p, at);
}

/* Positive before an event; `from` as in gripping. */
static double still(const struct scree_pair_motion *p, enum event event, const struct scree_pair_instant *at,
                    const struct scree_pair_instant *from) {
    return event == TURNS     ? turning(p, at, from ? from : at)
           : event == PRESSES ? pulling(p, at)
           : event == ENDS    ? lasting(p, at)
           : event == SLIPS   ? gripping(p, at, from)
                              : keeping(p, at);
}

/* Shorten a piece of length *time, over whose course an event happens, so that it ends there: regula falsi (Illinois),
 * and bisection where that is slow. What should have happened before the piece begins happens where it does; from a
 * value of zero a slider may grip better first, but not for less than a millionth of the step. `to` and `yield` are
 * those of the whole piece and become those of the part. */
static void shorten(const struct scree_pair_motion *p, enum event event, const struct scree_pair_instant *from,
                    struct nearness near, double *time, struct scree_pair_instant *to, struct scree_pair_yield *yield) {
    double low = 0.0, high = *time, at_low = still(p, event, from, NULL), at_high = still(p, event, to, from);
    double size = fabs(at_low - at_high);
    int slips = event == SLIPS, tried = !slips || at_low > 0.0;
    for (int k = 0, kept = 0; k < TRIES && (at_low > 0.0 || slips); k++) {
        double t = high - at_high * (high - low) / (at_high - at_low);
        if (k % 4 == 3) t = 0.5 * (low + high);
        if (!tried) t = fmin(1e-6 * p->step, high);
        if (event == ENDS && near.until >= 0.0) near.until = t; /* there is the singular point */
        *to = go(p, from, near, t, yield);
        *time = t;
        double value = still(p, event, to, from);
        if (fabs(value) <= 1e-13 * size || (!tried && !(value > 0.0))) return;
        tried = 1;
        if (value > 0.0) {
            low = t;
            at_low = value;
            if (kept > 0) at_high *= 0.5;
            kept = 1;
        } else {
            high = t;
            at_high = value;
            if (kept < 0) at_low *= 0.5;
            kept = -1;
        }
    }
}

static int bends(const struct scree_pair_motion *p, const struct scree_pair_instant *from,
                 const struct scree_pair_instant *to) {
    if (!p->normal->bends) return 0;
    struct scree_pressing first = scree_pressed(from->overlap, told_of(p, from), from->first, from->second);
    struct scree_pressing then = scree_pressed(to->overlap, told_of(p, to), from->first, from->second);
    return p->normal->bends(p->normal_law, p->normal_pair, first, then);
}

/* Where the law changes its formula within the piece, which is shortened to end just beyond. Returns whether it does;
 * where nothing moves to speak of, no force changes either. */
static int shorten_to_bend(const struct scree_pair_motion *p, const struct scree_pair_instant *from,
                           struct nearness near, double *time, struct scree_pair_instant *to,
                           struct scree_pair_yield *yield) {
    if (!bends(p, from, to) || !(fabs(to->overlap - from->overlap) > 1e-12 * from->overlap)) return 0;
    double low = 0.0, high = *time;
    for (int k = 0; k < TRIES; k++) {
        double t = 0.5 * (low + high);
        *to = go(p, from, near, t, yield);
        if (bends(p, from, to))
            high = t;
        else
            low = t;
    }
    *to = go(p, from, near, high, yield);
    *time = high;
    return 1;
}

/* Where a contact with friction that pulls begins to press within the piece, which is shortened to end there: friction
 * begins. Returns whether it does. */
static int shorten_to_press(const struct scree_pair_motion *p, const struct scree_pair_instant *from,
                            struct nearness near, double *time, struct scree_pair_instant *to,
                            struct scree_pair_yield *yield) {
    if (!p->friction || p->normal->cut) return 0;
    double before = pulling(p, from), after = pulling(p, to);
    if (!(after < 0.0 && before > -1e-10 * after)) return 0;
    shorten(p, PRESSES, from, near, time, to, yield);
    return 1;
}

/* Where a slider breaks loose or holds again within the piece, which is shortened to end there. Returns whether it
 * does. It may have to at once: where a piece has ended with a turn what it bears goes on otherwise, and forces jump
 * where others do. A bare spring that slides has the stretch of its force, which it takes over then. */
static int shorten_to_slip(const struct scree_pair_motion *p, const struct scree_pair_instant *from,
                           struct nearness near, double *time, struct scree_pair_instant *to,
                           struct scree_pair_yield *yield) {
    if (!p->slider) return 0;
    if (gripping(p, from, NULL) < 0.0) {
        *to = p->bare && from->sliding > 0.0 ? move(p, from, 0.0, yield) : *from;
        *yield = (struct scree_pair_yield){.lost = 0.0};
        *time = 0.0;
        return 1;
    }
    if (!(gripping(p, to, from) < 0.0)) return 0;
    shorten(p, SLIPS, from, near, time, to, yield);
    return 1;
}

/* Where the speed passes that at which the slider's hold jumps, within the piece, which is shortened to end there.
 * Returns whether it does. */
static int shorten_to_crossing(const struct scree_pair_motion *p, const struct scree_pair_instant *from,
                               struct nearness near, double *time, struct scree_pair_instant *to,
                               struct scree_pair_yield *yield) {
    if (!p->slider || !p->friction->band || !(keeping(p, to) < 0.0)) return 0;
    shorten(p, CROSSES, from, near, time, to, yield);
    return 1;
}

/* Beyond it: what slides holds at once if it may bear more now than it does, what holds breaks loose if it bears more
 * than it may. */
static void cross(const struct scree_pair_motion *p, struct scree_pair_instant *at) {
    struct scree_pair_load load;
    scree_pair_press(p, at, &load);
    struct scree_drawn drawn = brace(p, at, load.normal);
    drawn.stretch = p->friction->in_force ? vec_scale(1.0 / drawn.k, at->stretch) : at->stretch;
    double bears = vec_norm(trial_of(&drawn));
    if (p->bare && at->sliding > 0.0) bears = drawn.limit;
    at->inside = !at->inside;
    double holds = scree_hold_on(p->friction, p->friction_law, sliding_of(p, at, load.normal), at->inside).holds;
    if (at->sliding > 0.0 ? bears < holds : bears > holds) at->sliding = at->sliding > 0.0 ? 0.0 : 1.0;
}

/* Where bodies that part first and approach at the end have left each other within the piece: it is shortened to where
 * they are farthest apart by the parabola with their speeds, so that the end of their contact is to be seen there.
 * Returns whether they have. (Where the law is cut they may have, too: it pulls then for so long.) */
static int turn_back(const struct scree_pair_motion *p, const struct scree_pair_instant *from, struct nearness near,
                     double *time, struct scree_pair_instant *to, struct scree_pair_yield *yield) {
    double before = closing_of(p, from), after = closing_of(p, to);
    int leaves = before < 0.0 && after > 0.0 && 2.0 * from->overlap * (after - before) < before * before * *time;
    if (!leaves || p->normal->cut || p->normal->reach) return 0;
    *time *= before / (before - after);
    *to = go(p, from, near, *time, yield);
    return 1;
}

static void add(struct scree_pair_yield *sum, const struct scree_pair_yield *part, double left) {
    sum->moment = vec_add(sum->moment, vec_axpy(part->moment, left, part->impulse));
    sum->impulse = vec_add(sum->impulse, part->impulse);
    sum->lost += part->lost;
    sum->rubbed += part->rubbed;
}

/* Free flight: what is stored in an overlap without force is lost. */
static void fly(const struct scree_pair_motion *p, struct scree_pair_instant *at, double time,
                struct scree_pair_yield *sum) {
    struct scree_pair_yield nothing = {.lost = 0.0};
    double before = stored(p, at);
    struct scree_pair_instant from = *at;
    place(p, &from, time, &nothing, at);
    at->stretch = vec(0.0, 0.0, 0.0);
    at->sliding = 0.0;
    remember(p, at);
    sum->lost += before - stored(p, at);
}

/* From `start` on, of a contact that touches. Returns when it ends, or that of the step. */
static double touch(const struct scree_pair_motion *p, struct scree_pair_instant *at, double start,
                    struct scree_pair_yield *sum) {
    double time = start, grid = (p->step - start) / p->substeps;
    at->inside = p->slider && p->friction->band &&
                 vec_norm(sliding_of(p, at, 0.0).velocity) < p->friction->band(p->friction_law);
    for (int k = 0, turned = 0, slipped = 0; time < p->step && k < p->substeps;) {
        struct scree_pair_yield part;
        struct nearness near = nearness_of(p, at, p->step - time);
        int last = near.since >= 0.0 || near.until >= 0.0 || k == p->substeps - 1;
        double goal = last ? p->step : start + grid * (k + 1), piece = goal - time;
        if (!(piece > 0.0)) { /* the piece before went further than its own goal */
            k++;
            continue;
        }
        struct scree_pair_instant to = go(p, at, near, piece, &part);
        int parted = turn_back(p, at, near, &piece, &to, &part);
        for (; part.dips && !part.below && piece > p->step / SCREE_FINEST && !(gripping(p, at, NULL) < 0.0);
             parted = 1) {
            piece *= 0.5;
            to = go(p, at, near, piece, &part);
        }
        /* Where nothing moves to speak of, no force changes either. */
        int turns =
            p->turns && !turned && turning(p, &to, at) < 0.0 && turning(p, at, at) * piece > 1e-12 * at->overlap;
        if (turns) shorten(p, TURNS, at, near, &piece, &to, &part);
        if (turns && closing_of(p, at) < 0.0 && lasting(p, &to) < 0.0) turns = 0; /* what parts ends before */
        int bent = shorten_to_bend(p, at, near, &piece, &to, &part);
        if (bent) turns = 0;
        int presses = shorten_to_press(p, at, near, &piece, &to, &part);
        if (presses) turns = bent = 0;
        int ends = !turns && lasting(p, &to) < 0.0;
        if (ends) shorten(p, ENDS, at, near, &piece, &to, &part);
        if (ends && !(lasting(p, at) > 0.0)) return time; /* it ends before it begins */
        int crosses = slipped < MOST_SLIPS && shorten_to_crossing(p, at, near, &piece, &to, &part);
        if (crosses) turns = bent = presses = ends = 0;
        int slips = slipped < MOST_SLIPS && shorten_to_slip(p, at, near, &piece, &to, &part);
        if (slips) turns = bent = presses = ends = crosses = 0;
        slipped += slips + crosses;
        time = parted || turns || bent || presses || ends || slips || crosses ? time + piece : goal;
        if (!(time < p->step)) time = p->step;
        add(sum, &part, p->step - time);
        *at = to;
        if (slips) at->sliding = at->sliding > 0.0 ? 0.0 : 1.0;
        if (crosses) cross(p, at);
        turned = turns;
        if (ends) return time;
        if (time == goal) k = last ? p->substeps : k + 1;
    }
    return p->step;
}

/* ---- the beginning ---- */

/* When contact begins within the step, in which it is `time` now, on the parabola of free flight; the step's end if it
 * doesn't. `at` is moved there. */
static double begin(const struct scree_pair_motion *p, double time, struct scree_pair_instant *at,
                    struct scree_pair_yield *sum) {
    struct scree_pair_instant from = *at, end = *at;
    struct scree_pair_yield nothing = {.lost = 0.0};
    double left = p->step - time, closing = closing_of(p, at), speeding = -vec_dot(p->a, p->n), start = 0.0;
    place(p, &from, left, &nothing, &end);
    if (!(lasting(p, &end) > 0.0) || end.overlap <= 0.0) return p->step;
    if (from.overlap <= 0.0) {
        double speed = sqrt(fmax(closing * closing - 2.0 * speeding * from.overlap, 0.0));
        if (closing < 0.0 && speeding > 0.0)
            start = fmin((speed - closing) / speeding, left); /* it comes back */
        else if (closing + speed > 0.0)
            start = fmin(-2.0 * from.overlap / (closing + speed), left);
    } else { /* overlapping still after its force was cut */
        double low = 0.0, high = left;
        for (int k = 0; k < 50; k++) {
            start = 0.5 * (low + high);
            place(p, &from, start, &nothing, &end);
            if (lasting(p, &end) > 0.0)
                high = start;
            else
                low = start;
        }
    }
    struct scree_pair_yield flight = nothing;
    fly(p, at, start, &flight);
    if (from.overlap <= 0.0) at->overlap = 0.0;
    sum->lost += flight.lost;
    return time + start;
}

/* What the normal law remembers of the touch itself: that there is one, how fast they met. A bare spring whose load
 * grows like a higher power of time than its stretch slides from the touch on, until the load has overtaken it, which
 * may be over by the end of the step. */
static void meet(const struct scree_pair_motion *p, struct scree_pair_instant *at) {
    struct scree_pair_instant touching = *at;
    touching.overlap = SCREE_NO_SPEED; /* m, too */
    remember(p, &touching);
    at->first = touching.first;
    at->second = touching.second;
    if (!p->bare) return;
    double soon = SCREE_SO_SOON * p->step;
    struct scree_pair_instant later = soon_after(p, at, vec(0.0, 0.0, 0.0), soon);
    struct scree_pair_load load;
    scree_pair_press(p, &later, &load);
    struct scree_drawn drawn = brace(p, &later, load.normal);
    at->sliding = drawn.k * soon * vec_norm(drawn.slip) > drawn.limit;
}

struct scree_pair_yield scree_pair_act(const struct scree_pair_motion *p, struct scree_pair_instant *at) {
    struct scree_pair_yield sum = {.lost = 0.0};
    int touches = at->overlap > 0.0;
    if (p->normal->reach)
        touches = touches || at->second > 0.0;
    else if (p->normal->cut)
        touches = touches && lasting(p, at) > 0.0;
    double time = 0.0;
    for (int k = 0; k < MOST_TOUCHES && time < p->step; k++, touches = 0) {
        double start = touches ? 0.0 : begin(p, time, at, &sum);
        if (!(start < p->step)) break;
        if (p->normal->reach && !(at->second > 0.0)) { /* bodies that attach are bound at once; books as in loop.c */
            struct scree_pressing attached = scree_pressed(0.0, 0.0, 0.0, 1.0);
            sum.lost -= p->normal->stored(p->normal_law, p->normal_pair, attached);
        }
        if (at->overlap == 0.0) meet(p, at);
        time = touch(p, at, start, &sum);
    }
    if (time < p->step) fly(p, at, p->step - time, &sum);
    return sum;
}
