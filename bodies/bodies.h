/* The bodies of a scene while it runs: state split by temperature, and how each body moves alone.
 *
 * Four temperatures:
 *   record   what contacts read and write, every step, two bodies a contact: four rows of doubles, the spin apart;
 *   state    momenta at the end of the last step, read and written once a step;
 *   position at the end of the last step, for those who look: while steps follow one another it isn't written;
 *   the rest mass properties, joints, shapes: once for all balls that are alike; attitudes of bodies that have one.
 *
 * The step is Verlet's in its position form (drift, kick, drift: Tuckerman, Berne & Martyna 1992): contacts are
 * evaluated half a step ahead of the state, where positions are x + h v/2 and velocities are predicted from the
 * last step's impulse, v + dv/2. So elastic, damping and friction forces all see one and the same instant, and the
 * method is of second order for forces that depend on velocity too. Between steps positions and velocities
 * belong to the same instant again. */
#ifndef SCREE_BODIES_BODIES_H
#define SCREE_BODIES_BODIES_H

#include "bodies/body.h"
#include "bodies/motion.h"
#include "bodies/quat.h"

#include <stdint.h>
#include <string.h>

/* What the contact loop reads (x, v and the spin: half a step ahead) and adds to (impulse, turn). The fourth lane of
 * each row is free in a record of doubles fit for four-wide loads, and carries what contacts need besides. Two rows
 * that are used together fill a line of the cache, and never lie across two: so the spin, the odd row, has an array of
 * its own. */
struct scree_record {
    double x[3], radius;               /* centre, m; radius of the ball at the centre or at each corner, m */
    double v[3], inverse_mass;         /* m/s; 1/kg, 0 if forces can't move the centre */
    double impulse[3], inverse_moment; /* of the step, N s; of a ball 1/(kg m^2) */
    double turn[3], bound;             /* angular impulse of the step, N m s; radius about the centre, m */
};

_Static_assert(sizeof(struct scree_record) == 2 * 64, "two lines of the cache");

struct scree_spin {
    double w[3], limit; /* rad/s; largest tolerable overlap, m */
};

struct scree_state {
    double v[3]; /* m/s */
    double l[3]; /* angular momentum about the centre, world axes, kg m^2/s */
};

struct scree_inertia {
    double inverse_mass[3];    /* 1/kg along the world axes; 0 where the joint holds */
    double mass;               /* kg */
    double moments[3];         /* principal moments, kg m^2 */
    double inverse_moments[3]; /* 1/(kg m^2); 0 where the joint holds */
};

/* A body that is not a mere ball: attitude, and what follows from it half a step ahead. */
struct scree_attitude {
    double q[4];     /* at the end of the last step, scalar first, body to world */
    double start[4]; /* at the start of the simulation (driven turns count from here) */
    struct quat ahead;
    struct mat frame;     /* the body's axes half a step ahead */
    double half[3];       /* half-lengths of the core (box) or of the face (rectangle), m */
    double axis[3];       /* of a hinge or of a driven turn, unit length; zero if there is none */
    double inverse_hinge; /* 1/(moment about a hinge) */
    /* Of the pair-impulse method: acceleration that no contact causes (drives, gyration), rad/s^2; first moment of the
     * step's angular impulses about its end, N m s^2. */
    double known_turn[3], turn_moment[3];
};

/* What the pair-impulse method (contact/impulse.c) keeps of a body, beside its record and state: two lines of the
 * cache. */
struct scree_past {
    double impulse[2][3], turn[2][3]; /* of the last step and of the one before it, N s, N m s */
    double known[3];                  /* acceleration that no contact causes: gravity, drives, m/s^2 */
    double range; /* bound of the way that any point of the body makes in the step, m; not of free balls */
};

/* What contacts that hardly change ask of the past of a ball, mostly: so small that it stays in the caches. */
struct scree_glance {
    float way;      /* a bound of the way that it makes in the step, m; infinite of what is neither ball nor fixed */
    uint32_t trace; /* scree_trace_of its impulse of the last step along the first axis: if an impulse hasn't this one,
                       it isn't all that the ball has got */
};

/* The last digits of a number, which no other is likely to share, whatever its size; without its sign. */
static inline uint32_t scree_trace_of(double impulse) {
    uint64_t bits;
    memcpy(&bits, &impulse, sizeof bits);
    return (uint32_t)(bits & UINT32_MAX);
}

/* What contacts of balls read of it where they ask for it (contact/starts.h), in rows fit for four-wide loads: two
 * lines, too. All zero of fixed bodies. */
struct scree_push {
    double along[4]; /* acceleration if all goes on as in the last step, m/s^2; bound of the way, m */
    double more[4];  /* what extrapolation from the last two steps adds to it, m/s^2; 1 of what isn't a ball, else 0 */
    double turn[4];  /* the same of rotation, rad/s^2; 1/moment of inertia of a ball, 1/(kg m^2) */
    double turn_more[4]; /* rad/s^2 */
};

_Static_assert(sizeof(struct scree_past) == 2 * 64 && sizeof(struct scree_push) == 2 * 64, "two lines of the cache");

/* What doesn't change while the scene runs. Balls that are alike share one; every other body has its own. */
struct scree_kind {
    scree_shape shape;
    scree_joint joint;
    struct scree_inertia inertia;
    double origin[3]; /* start position, from which driven coordinates count, m; of balls zero */
    int material;
    int slot; /* row in `attitude`, -1 for balls */
};

enum scree_body_class {
    SCREE_CLASS_FIXED,   /* never moves */
    SCREE_CLASS_BALL,    /* a free sphere: no attitude is kept */
    SCREE_CLASS_GENERAL, /* everything else */
    SCREE_CLASS_ASLEEP   /* a ball or box left alone for a while (contact/rest.h) */
};

/* Where bodies lie in memory. A scene of many balls keeps them sorted in space: in slabs across its longest extent, of
 * about as many balls each, within a slab in rows. Two balls of slabs that aren't neighbours don't touch as long as the
 * order holds. Walls, boxes, driven and very large bodies are no members; they come first, in the order of their
 * numbers. */
enum { SCREE_SLABS = 64 };
struct scree_order {
    int slabs;                  /* 0: bodies lie in the order of their numbers */
    int members;                /* place of the first member */
    int start[SCREE_SLABS + 1]; /* place where each slab begins, and where the last one ends */
    int axis[3];                /* across slabs, across rows, along rows */
    double low[3], width[3];    /* where rows, and places in them, are counted from, and how wide they are, m */
    double end[SCREE_SLABS];    /* where slabs end along their axis, m; of all but the last one */
};

struct scree_bodies {
    int count;
    struct scree_order order;
    int mixed;         /* members are of several materials */
    int *number;       /* [place]: number of the body there, as it was defined */
    int *place;        /* [number] */
    signed char *slab; /* [place]: -1: no member */
    struct scree_record *record;
    struct scree_spin *spin;
    struct scree_state *state;
    double *path;          /* way off the flight since the last list, m */
    float (*flight)[4];    /* see scree_flight_row; three of four numbers count (contact/flight.c). NULL: all zero */
    double (*position)[3]; /* at the end of the last step, m; not of members that hurry on to the next one */
    unsigned char *class;  /* enum scree_body_class */
    int *kind_of;          /* row in `kind`: see scree_kind_of */
    int kinds, kind_capacity;
    struct scree_kind *kind;
    double even; /* radius of all spheres, m; 0 if they aren't of one size */
    int attitudes;
    struct scree_attitude *attitude;
    double (*corner)[4]; /* row 0 is zero (a sphere's ball); row 1 + 8 slot + c: corner c from the centre, world axes */
    struct scree_motion *motion; /* owned; joints refer to them by index */
    int motions;
    struct scree_motion_value *moved; /* where each motion is at the instant being set; several bodies share a motion */
    unsigned char *calm;              /* how often it was seen at rest (contact/rest.h); NULL: none ever sleeps */
    struct scree_past *past;          /* NULL unless scree_bodies_keep_past was called */
    struct scree_glance *glance;      /* likewise */
    int some_driven;                  /* some bodies are neither balls nor fixed; likewise */
    double (*moment)[4];              /* first moment of the step's impulses about its end, N s^2: contacts add to it */
    int periodic;                     /* along some axis */
    double low[3], period[3];         /* where the box begins and after what length all repeats, m; 0: never */
};

/* The spin of a body as contacts see it, half a step ahead, rad/s. */
static inline struct vec scree_spin_of(const struct scree_bodies *bodies, int index) {
    return vec_from(bodies->spin[index].w);
}

/* A bound of the speed of a body's points, m/s. */
static inline double scree_fastest_point(const struct scree_bodies *bodies, int index) {
    const struct scree_record *record = &bodies->record[index];
    return vec_norm(vec_from(record->v)) + vec_norm(scree_spin_of(bodies, index)) * record->bound;
}

static inline struct scree_kind *scree_kind_of(const struct scree_bodies *bodies, int index) {
    return &bodies->kind[bodies->kind_of[index]];
}

/* The velocity off which the path of a body counts, m/s. */
static inline const float *scree_flight_row(const struct scree_bodies *bodies, int index) {
    static const float still[4] = {0.0F, 0.0F, 0.0F, 0.0F};
    return bodies->flight ? bodies->flight[index] : still;
}

/* What a body that sleeps is when it is awake. */
static inline unsigned char scree_awake_class(const struct scree_bodies *bodies, int index) {
    return scree_kind_of(bodies, index)->slot < 0 ? SCREE_CLASS_BALL : SCREE_CLASS_GENERAL;
}

/* Of a body that isn't a ball. */
static inline struct scree_attitude *scree_attitude_of(const struct scree_bodies *bodies, int index) {
    return &bodies->attitude[scree_kind_of(bodies, index)->slot];
}

/* Space for `count` bodies, zeroed; SCREE_NO_MEMORY leaves nothing behind. Takes over `motions` motions. */
scree_status scree_bodies_create(struct scree_bodies *bodies, int count, struct scree_motion *motion, int motions,
                                 scree_trouble *trouble);
void scree_bodies_destroy(struct scree_bodies *bodies);

/* Mass of a body as defined, kg; `density` in kg/m^3 counts where the definition gives no mass. */
double scree_body_mass(const scree_body_def *def, double density);

/* Attitude that a definition asks for, normalised. */
struct quat scree_start_attitude(const scree_body_def *def);

/* Fill body `index` from a checked definition; `density` in kg/m^3 counts where the definition gives no mass.
 * SCREE_NO_MEMORY. */
scree_status scree_bodies_set(struct scree_bodies *bodies, int index, const scree_body_def *def, double density,
                              scree_trouble *trouble);

/* Give every body that isn't a ball its attitude, from its definition; call once after all bodies are set. */
scree_status scree_bodies_finish(struct scree_bodies *bodies, scree_body_def (*def)(const void *context, int index),
                                 const void *context, scree_trouble *trouble);

/* Put driven bodies where their motions have them at `time`, and bring every record to the instant of the state. */
void scree_bodies_start(struct scree_bodies *bodies, double time);

/* Bring the records of the first `count` bodies to time + step/2: predicted velocities there, impulses cleared, `path`
 * lengthened by the way off the flight since the last call. Returns 1 if some body's path has outgrown `margin` (or is
 * not a number), so that lists must be made anew, else 0. */
int scree_bodies_look_ahead(struct scree_bodies *bodies, int count, double time, double step, const double gravity[3],
                            double margin);

/* Kick the first `count` bodies by the impulses that contacts left in their records and by gravity at mid-step, then
 * drift to time + step. */
void scree_bodies_advance(struct scree_bodies *bodies, int count, double time, double step, const double gravity[3]);

/* Positions of members at places from … to - 1 that were to hurry on but don't, from their records in the middle of the
 * next step; to rounding. */
void scree_bodies_find_positions(struct scree_bodies *bodies, int from, int to, double step);

/* Records, attitudes and corners at the instant of the state itself, for measurements: written into `shadow`, made
 * by scree_bodies_shadow (or `bodies` itself). */
void scree_bodies_look_now(const struct scree_bodies *bodies, double time, struct scree_bodies *shadow);

/* The same of one body, after drive_to(bodies, time); scree_body_look_ahead: of one that isn't a ball. */
void scree_body_look_now(const struct scree_bodies *bodies, int index, double time, struct scree_bodies *shadow);
int scree_body_look_ahead(struct scree_bodies *bodies, int index, double step, const double gravity[3], double margin);

/* How many periods a coordinate is beyond the box. */
static inline double scree_periods_off(const struct scree_bodies *bodies, double x, int axis) {
    double period = bodies->period[axis];
    return period > 0.0 ? floor((x - bodies->low[axis]) / period) : 0.0;
}

/* A second set of records, attitudes and corners beside the shared rest of `bodies`, which must outlive it. Free it
 * with scree_bodies_free_shadow. SCREE_NO_MEMORY: there is nothing to free. */
scree_status scree_bodies_shadow(const struct scree_bodies *bodies, struct scree_bodies *shadow,
                                 scree_trouble *trouble);
void scree_bodies_free_shadow(struct scree_bodies *shadow);

/* ---- order ---- */

/* Sort the bodies by the positions of their states, if 16 of them or more go into slabs; `range` is the largest gap
 * that matters, m. `key` and `from` are scratch for a number per body. */
void scree_bodies_sort(struct scree_bodies *bodies, double range, uint64_t *key, int *from);

/* Whether so many bodies have left their places that sorting pays. It depends on the state alone. */
int scree_bodies_disordered(const struct scree_bodies *bodies);

/* Permute an array of things of `size` bytes (at most those of a scree_past): what is at from[k] goes to k. NULL is
 * left alone. */
void scree_permute(void *array, size_t size, int *from, int count);

/* Put the bodies in a given order: the body at place from[k] goes to place k. */
void scree_bodies_permute(struct scree_bodies *bodies, int *from);

/* Slabs after `order` has been set. */
void scree_bodies_mark_slabs(struct scree_bodies *bodies);

/* ---- for the pair-impulse method ----
 *
 * Pairs integrate their own motion inside the step, from the state at its start, and return impulses and their first
 * moments about the end of the step: v += g h + sum J/m, x += h v + g h^2/2 + sum M/m. Rotation likewise: a box turns
 * for the first half of the step at the angular momentum l of its start, for the second at l + 2 M/h, which under a
 * constant torque is that of its end; second order, and angular momentum is kept to rounding. */

/* Space for what that method keeps, freed with the bodies; SCREE_NO_MEMORY. */
scree_status scree_bodies_keep_past(struct scree_bodies *bodies, scree_trouble *trouble);

/* As scree_bodies_look_ahead, and bring the shadow `now` to the start of the step. Of all bodies but free balls, which
 * pushed.h moves. */
int scree_bodies_look_both(struct scree_bodies *bodies, double time, double step, const double gravity[3],
                           double margin, struct scree_bodies *now);

/* Velocity and spin at the start of a step: by pair impulses the state tells those of free balls, the shadow `now` of
 * all else; by Verlet's method `now` is the bodies themselves, m/s, rad/s. */
static inline int scree_starts_in_state(const struct scree_bodies *bodies, int k) {
    return bodies->past && bodies->class[k] == SCREE_CLASS_BALL;
}

static inline struct vec scree_start_velocity(const struct scree_bodies *bodies, const struct scree_bodies *now,
                                              int k) {
    return vec_from(scree_starts_in_state(bodies, k) ? bodies->state[k].v : now->record[k].v);
}

static inline struct vec scree_start_spin(const struct scree_bodies *bodies, const struct scree_bodies *now, int k) {
    if (!scree_starts_in_state(bodies, k)) return scree_spin_of(now, k);
    return vec_scale(bodies->record[k].inverse_moment, vec_from(bodies->state[k].l));
}

/* What contacts of balls read of the past of one of these. */
struct scree_push scree_body_push(const struct scree_bodies *bodies, int index, double step);

/* Advance these by the impulses in the records and their moments, both of which then become past. */
void scree_bodies_advance_by_moments(struct scree_bodies *bodies, double time, double step, const double gravity[3]);

/* Spin (rad/s) that an angular impulse of 1 N m s about each world axis gives a body as its attitude is; columns. */
struct mat scree_bodies_inverse_inertia(const struct scree_bodies *bodies, int index);

/* Spin in the world, rad/s, of the state at `time`. */
struct vec scree_bodies_spin(const struct scree_bodies *bodies, int index, double time);

#endif
