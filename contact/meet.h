/* What every way of stepping a contact needs: where its ball meets its partner, and how a stretch follows the
 * normal. */
#ifndef SCREE_CONTACT_MEET_H
#define SCREE_CONTACT_MEET_H

#include "contact/contacts.h"

/* How many half steps ago bodies have met that close in, or for how many they still touch that part: from the overlap
 * in the middle of a step. */
static SCREE_INLINE double scree_half_steps_in(double overlap, double closing, double step) {
    return overlap / (0.5 * step * fabs(closing) + SCREE_NO_SPEED);
}

/* Share of the step during which the bodies touch, from that: 1 or 0, but for the steps in which they meet or part. */
static SCREE_INLINE double scree_share_of(double half_steps_in) {
    double share = 0.5 + 0.5 * half_steps_in;
    share = share < 1.0 ? share : 1.0;
    return share > 0.0 ? share : 0.0;
}

/* A contact counts as new where its overlap is less than so many ways of half a step: bodies that have met since the
 * middle of the step before are in each other by two, but a dashpot has slowed them down since. */
#define SCREE_NEW 2.5

/* For those two it is, at most. */
static SCREE_INLINE double scree_met_lately(double met) { return met > 2.0 && met < SCREE_NEW ? 2.0 : met; }

/* A stretch counts from the touch, not from the beginning of the step in which bodies meet: without this sliders are of
 * first order. What it has then at the beginning of that step, as time at its velocity, s: until the middle of the
 * step, to which the laws add half of it, that is overlap/closing. In any other step 0. */
static SCREE_INLINE double scree_since_touch(double met, double closing, double step) {
    double since = 0.5 * step * (met - 1.0);
    since = closing > 0.0 ? since : 0.0;
    since = met > 0.0 ? since : 0.0;
    return met <= 2.0 ? since : 0.0;
}

/* Where the partner that is met stands off its record: whole periods; constant zeros but for images. */
static inline struct vec scree_shift_of(const struct scree_bodies *bodies, const struct scree_contact *contact,
                                        enum scree_geometry geometry) {
    if (geometry != SCREE_BALL_IMAGE) return vec(0.0, 0.0, 0.0);
    return vec(scree_periods_of(contact->corner, 0) * bodies->period[0],
               scree_periods_of(contact->corner, 1) * bodies->period[1],
               scree_periods_of(contact->corner, 2) * bodies->period[2]);
}

/* The ball's centre from that of its body. */
static inline struct vec scree_corner_of(const struct scree_bodies *bodies, const struct scree_contact *contact,
                                         enum scree_geometry geometry) {
    if (geometry == SCREE_BALL_IMAGE) return vec(0.0, 0.0, 0.0);
    return vec_from(bodies->corner[contact->corner]);
}

/* From the partner's centre to that of the ball's body. */
static inline struct vec scree_apart(const struct scree_bodies *bodies, const struct scree_contact *contact,
                                     enum scree_geometry geometry) {
    struct vec apart = vec_sub(vec_from(bodies->record[contact->ball].x), vec_from(bodies->record[contact->host].x));
    if (geometry != SCREE_BALL_IMAGE) return apart;
    return vec_sub(apart, scree_shift_of(bodies, contact, geometry));
}

/* Normal and overlap of a contact whose ball, of this radius, has its centre at `centre`. Nothing else is asked of a
 * sphere: `bodies` may be a shadow in which those that are free aren't shown. */
static inline struct scree_meeting scree_meet_at(const struct scree_bodies *bodies, const struct scree_contact *contact,
                                                 enum scree_geometry geometry, struct vec centre, double radius) {
    const struct scree_record *host = &bodies->record[contact->host];
    struct vec origin = vec_from(host->x);
    if (geometry == SCREE_BALL_BALL) return scree_meet_ball(centre, radius, origin, host->radius);
    if (geometry == SCREE_BALL_IMAGE) {
        struct vec nearer = vec_sub(centre, scree_shift_of(bodies, contact, geometry));
        return scree_meet_ball(nearer, radius, origin, host->radius);
    }
    const struct scree_attitude *attitude = scree_attitude_of(bodies, contact->host);
    if (geometry == SCREE_BALL_PLANE) return scree_meet_plane(centre, radius, origin, &attitude->frame);
    struct scree_whole whole = scree_whole_of(bodies, contact->ball, contact->corner, centre);
    if (geometry == SCREE_BALL_RECTANGLE)
        return scree_meet_rectangle(centre, radius, whole, origin, &attitude->frame, attitude->half,
                                    scree_thickness(bodies, contact->ball, contact->corner, radius));
    return scree_meet_box(centre, radius, whole, origin, &attitude->frame, attitude->half, host->radius);
}

static inline struct scree_meeting scree_meet(const struct scree_bodies *bodies, const struct scree_contact *contact,
                                              enum scree_geometry geometry, struct vec centre) {
    return scree_meet_at(bodies, contact, geometry, centre, bodies->record[contact->ball].radius);
}

/* How the ball moves at the contact, seen from its partner. */
struct scree_gait {
    struct vec arm;  /* from the ball body's centre to the middle of the overlap, m */
    struct vec slip; /* tangential velocity of the ball, m/s */
    double closing;  /* m/s, as laws are told of it; */
    double untold;   /* and what it is more, of boxes (scree_muffled) */
};

/* From the normal and the overlap; the ball's radius, and its place from its body's centre; centre, velocity of the
 * centre of the ball's body against its partner's; both spins. Both bodies are acted on at one point, the middle of the
 * overlap, so that angular momentum is kept. */
static inline struct scree_gait scree_gait_of(struct vec n, double overlap, double radius, struct vec corner,
                                              struct vec apart, struct vec velocity, struct vec ball_spin,
                                              struct vec host_spin) {
    struct vec arm = vec_axpy(corner, 0.5 * overlap - radius, n);
    velocity = vec_add(velocity, vec_cross(ball_spin, arm));
    velocity = vec_sub(velocity, vec_cross(host_spin, vec_add(arm, apart)));
    double closing = -vec_dot(velocity, n);
    return (struct scree_gait){arm, vec_axpy(velocity, closing, n), closing, 0.0};
}

/* How two balls move at the middle of their overlap. Both arms are along the normal, so spins add up before they are
 * crossed with it, and friction alone turns: fewer operations and roundings than scree_gait_of. */
struct scree_roll {
    struct vec slip, aside; /* tangential velocity of the ball, and of its centre, m/s */
    double lever, other;    /* from the centres of ball and partner, m */
};

/* `turning`: the sum of levers times spins. */
static SCREE_INLINE struct scree_roll scree_roll_by(struct vec n, struct vec velocity, double closing,
                                                    struct vec turning, double lever, double other) {
    struct vec aside = vec_axpy(velocity, closing, n);
    return (struct scree_roll){vec_add(aside, vec_cross(n, turning)), aside, lever, other};
}

/* `radii`: of both together. */
static SCREE_INLINE struct scree_roll scree_roll_of(struct vec n, double overlap, double radius, double radii,
                                                    struct vec velocity, double closing, struct vec ball_spin,
                                                    struct vec host_spin) {
    double lever = radius - 0.5 * overlap, other = radii - radius - 0.5 * overlap;
    struct vec turning = vec_axpy(vec_scale(lever, ball_spin), other, host_spin);
    return scree_roll_by(n, velocity, closing, turning, lever, other);
}

/* The same of two balls of one size, in fewer operations. `spins`: of both together. */
static SCREE_INLINE struct scree_roll scree_roll_even(struct vec n, double overlap, double radii, struct vec velocity,
                                                      double closing, struct vec spins) {
    double lever = 0.5 * (radii - overlap);
    return scree_roll_by(n, velocity, closing, vec_scale(lever, spins), lever, lever);
}

/* Energy that is lost when bodies attach whose law reaches beyond touch: it binds them at once, and counts from the
 * end. */
static inline double scree_snap_energy(double (*stored)(const struct scree_law_constants *, struct scree_pair_constants,
                                                        struct scree_pressing),
                                       const struct scree_law_constants *law, struct scree_pair_constants pair) {
    return -stored(law, pair, scree_pressed(0.0, 0.0, 0.0, 1.0));
}

static inline struct scree_two_boxes scree_two_boxes_of(const struct scree_bodies *bodies, int ball, int host) {
    const struct scree_record *a = &bodies->record[ball], *b = &bodies->record[host];
    return (struct scree_two_boxes){scree_attitude_of(bodies, ball),
                                    scree_attitude_of(bodies, host),
                                    vec_sub(vec_from(a->x), vec_from(b->x)),
                                    a->radius,
                                    b->radius,
                                    {.factor = 1.0}};
}

/* The boxes of a contact, drawn in where they are deep. */
static inline struct scree_two_boxes scree_deep_boxes_of(const struct scree_bodies *bodies,
                                                         const struct scree_contact *contact) {
    struct scree_two_boxes boxes = scree_two_boxes_of(bodies, contact->ball, contact->host);
    scree_draw_in(&boxes);
    return boxes;
}

/* A contact of two edges, or of a corner with a box. */
static inline struct scree_crossing scree_cross(const struct scree_two_boxes *boxes,
                                                const struct scree_contact *contact, enum scree_geometry geometry) {
    int code = contact->corner - 1;
    if (geometry == SCREE_BALL_BOX) return scree_meet_corner(boxes, code % 8);
    return scree_meet_edges(boxes, code / SCREE_EDGES, code % SCREE_EDGES);
}

/* A gradient that turns a body more than a force at its farthest point would is too steep for an explicit dashpot: what
 * laws are told of the closing speed is less by this, the square, as if its lever ended there. 1: it isn't. */
static inline double scree_muffled(const struct scree_bodies *bodies, const struct scree_contact *contact,
                                   const struct scree_crossing *c) {
    double ball = bodies->record[contact->ball].bound, host = bodies->record[contact->host].bound;
    double lever = fmax(vec_norm(c->turn_a) / ball, vec_norm(c->turn_b) / host);
    return lever > 1.0 ? lever * lever : 1.0;
}

/* What one newton of the normal force does besides pushing along the normal at the middle of the overlap. */
static inline struct scree_gradient scree_lean_of(const struct scree_crossing *c, struct vec apart) {
    struct vec n = c->meeting.normal;
    return (struct scree_gradient){vec_sub(c->force, n), vec_sub(c->turn_a, vec_cross(c->point, n)),
                                   vec_add(c->turn_b, vec_cross(vec_add(c->point, apart), n))};
}

/* What of one newton of a crossing's force friction counts from: what it does at the crossing itself, without what it
 * takes off the corners beside it (scree_relief); of boxes that are drawn in, what it does along the normal instead,
 * and these corners apart. Nothing where that pulls. `lean`: scree_lean_of. */
static inline double scree_borne(const struct scree_crossing *c, const struct scree_gradient *lean, int drawn_in) {
    double all = 1.0 + vec_dot(lean->force, c->meeting.normal);
    for (int k = 0; k < 4; k++) all += c->handed[k];
    if (!drawn_in) return c->own;
    return all > 0.0 ? all : 0.0;
}

/* How two edges move at their crossing; they close in as fast as their overlap grows. */
static inline struct scree_gait scree_gait_on_edges(const struct scree_bodies *bodies,
                                                    const struct scree_contact *contact,
                                                    const struct scree_crossing *c) {
    const struct scree_record *ball = &bodies->record[contact->ball], *host = &bodies->record[contact->host];
    struct vec n = c->meeting.normal, apart = vec_sub(vec_from(ball->x), vec_from(host->x));
    struct vec ball_spin = scree_spin_of(bodies, contact->ball), host_spin = scree_spin_of(bodies, contact->host);
    struct vec between = vec_sub(vec_from(ball->v), vec_from(host->v));
    struct vec velocity = vec_add(between, vec_cross(ball_spin, c->point));
    velocity = vec_sub(velocity, vec_cross(host_spin, vec_add(c->point, apart)));
    double closing = -vec_dot(c->force, between) - vec_dot(c->turn_a, ball_spin) - vec_dot(c->turn_b, host_spin);
    double told = closing / scree_muffled(bodies, contact, c);
    return (struct scree_gait){c->point, vec_axpy(velocity, -vec_dot(velocity, n), n), told, closing - told};
}

/* Bring a stretch into the tangent plane without changing its length: the normal has turned since it was stored. Of its
 * square A the part s was along the normal, and 1/sqrt(1 - s/A) is taken as its Pade approximant of orders 2 and 2,
 * which errs by (s/A)^5/512: by rounding while the normal turns by less than 0.05 in a step, and by 3e-4 for an eighth
 * of a turn. The threshold keeps rounding from doing anything where the normal stands still. */
static SCREE_INLINE struct vec scree_into_tangent_plane(struct vec stretch, struct vec normal) {
    double along = vec_dot(stretch, normal), square = vec_norm2(stretch), s = along * along;
    struct vec flat = vec_axpy(stretch, -along, normal);
    double above = square * square + s * (0.0625 * s - 0.75 * square);
    double below = square * square + s * (0.3125 * s - 1.25 * square);
    double scale = s > 1e-24 * square && below > 0.0 ? above / below : 1.0;
    return vec_scale(scale, flat);
}

/* The angle in `time` by which a stretch turns about the normal: the mean of both bodies. Without it friction would
 * depend on who looks at it: turned as a whole, bodies that hold each other would slip (Kuhn, Suzuki & Daouadji,
 * "Linear-frictional contact model for 3D discrete element simulations of granular systems", 2020: twirling). `spins`:
 * of both together. */
static SCREE_INLINE double scree_twirl_angle(struct vec normal, struct vec spins, double time) {
    return 0.5 * time * vec_dot(normal, spins);
}

/* A stretch in the tangent plane, turned by that. Errs by the third order of the angle, in its length by the fourth. */
static SCREE_INLINE struct vec scree_twirl(struct vec stretch, struct vec normal, double angle) {
    return vec_axpy(vec_scale(1.0 - 0.5 * angle * angle, stretch), angle, vec_cross(normal, stretch));
}

/* Both: a stretch that was kept `time` ago. */
static SCREE_INLINE struct vec scree_turned(struct vec stretch, struct vec normal, struct vec spins, double time) {
    return scree_twirl(scree_into_tangent_plane(stretch, normal), normal, scree_twirl_angle(normal, spins, time));
}

/* Both of two balls, whose normal turns as their centres go round each other, by w = h v/r in a step, where v is their
 * relative velocity across the normal: s - (s.n)(n - w/2). Errs by the third order of both angles, and takes no
 * division. `per`: h/r, s/m. */
static SCREE_INLINE struct vec scree_turn_along(struct vec stretch, struct vec normal, struct vec aside, double per,
                                                double twirl) {
    struct vec upright = vec_axpy(normal, -0.5 * per, aside);
    return vec_axpy(scree_twirl(stretch, normal, twirl), -vec_dot(stretch, normal), upright);
}

#endif
