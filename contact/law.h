/* What a contact law is: a description that people and programs read, and inline functions from values to values.
 *
 * A normal law lives in one header normal_<word>.h, a friction law in friction_<word>.h, a rolling law in
 * rolling_<word>.h; the word stands in one list in contact/meson.build. Everything else follows from that list. The
 * functions hold no state and touch no memory: the loop loads, calls, stores. They use + - x / sqrt, comparisons and
 * bodies/elementary.h only, so that they give the same bits everywhere and the compiler can evaluate several contacts
 * at once.
 *
 * Signs: overlap d > 0 while touching; closing speed u > 0 while approaching; forces on the ball of the pair. */
#ifndef SCREE_CONTACT_LAW_H
#define SCREE_CONTACT_LAW_H

#include "bodies/elementary.h"
#include "bodies/trouble.h"
#include "bodies/vec.h"
#include "contact/choice.h"

enum { SCREE_LAW_CONSTANTS = 12, SCREE_PAIR_CONSTANTS = 4, SCREE_PARAMETERS = SCREE_SETTINGS_MAX };

/* What is kept of a contact between steps, if a law asks for it: friction's stretch and state, two numbers of the
 * normal law, and stretch and state of rolling and of twisting. All zero when a contact begins. Stretches turn with
 * the contact from the middle of a step to that of the next, so that what is kept at its end lacks half a step's turn
 * (contact/measure.c adds it), except under the adaptive integrator. */
enum {
    SCREE_KEPT_FRICTION = 0,
    SCREE_KEPT_STATE = 3,
    SCREE_KEPT_NORMAL = 4,
    SCREE_KEPT_ROLLING = 6,
    SCREE_MEMORY = 12
};

/* Which numbers a parameter may take. */
enum scree_range {
    SCREE_ANY_POSITIVE,  /* > 0 */
    SCREE_NOT_NEGATIVE,  /* >= 0 */
    SCREE_FRACTION,      /* 0 < value <= 1 */
    SCREE_AT_LEAST_ONE,  /* >= 1 */
    SCREE_FROM_ONE_TO_3, /* 1 … 3 */
    SCREE_ZERO_OR_ONE,   /* 0 or 1: a switch */
};

/* What two materials say of a contact between them. */
enum scree_material_value {
    SCREE_FROM_CONTACT = 0, /* nothing: the parameter is given with the contact */
    SCREE_FROM_MODULUS,     /* 1/E* = (1 - nu1^2)/E1 + (1 - nu2^2)/E2 (Hertz 1882) */
    SCREE_FROM_SHEAR        /* 1/G* = (2 - nu1)/G1 + (2 - nu2)/G2 (Mindlin 1949) */
};

struct scree_parameter {
    const char *name, *unit, *meaning;
    enum scree_range range;
    const char *instead_of; /* name of another parameter: exactly one of the two must be given */
    double fallback;        /* counts if the parameter isn't given and `optional` is set */
    int optional;
    enum scree_material_value material; /* taken from the two materials if it isn't given */
    int shared;                         /* divided by the number of contacts that share one load */
};

/* Values of the parameters in the order of their list; NAN where not given. */
struct scree_values {
    double v[SCREE_PARAMETERS];
};

/* A power x^p: of the exponents that laws use most, x (one + half sqrt(x) + two x), in which one number is 1 and the
 * others are zero; `known` tells whether p is one of them. */
struct scree_exponent {
    int known;
    double one, half, two;
};

/* Constants of a law for one pair of materials, made once from the parameters. */
struct scree_law_constants {
    double c[SCREE_LAW_CONSTANTS];
    struct scree_exponent exponent;        /* of a power that the law takes */
    const struct scree_force_table *table; /* of the law "table"; belongs to the rule */
};

/* Constants of a law for one pair of bodies: they depend on effective mass and radius too. */
struct scree_pair_constants {
    double c[SCREE_PAIR_CONSTANTS];
};

/* Square and fourth root of an overlap, 0 where there is none, for laws that need them (`takes_roots`): the loop has
 * found them before; where they aren't known the law does. */
struct scree_roots {
    int known;
    double square, fourth;
};

static SCREE_INLINE double scree_square_root(struct scree_roots roots, double overlap) {
    return roots.known ? roots.square : sqrt(overlap > 0.0 ? overlap : 0.0);
}

static SCREE_INLINE double scree_fourth_root(struct scree_roots roots, double overlap) {
    return roots.known ? roots.fourth : sqrt(scree_square_root(roots, overlap));
}

/* A contact as a normal law sees it, with the two numbers that the law has kept of it (zero when it begins). */
struct scree_pressing {
    double overlap, closing, first, second;
    struct scree_roots roots;
};

static SCREE_INLINE struct scree_pressing scree_pressed(double overlap, double closing, double first, double second) {
    return (struct scree_pressing){.overlap = overlap, .closing = closing, .first = first, .second = second};
}

/* F = elastic + damping u, cut to F >= 0 if the law says so. `reversible` is dU/dd, the part of the force that is
 * stored in the contact; the power lost is (F - reversible) u. `first` and `second` are kept; a law forgets them by
 * itself where the contact has ended. */
struct scree_normal_force {
    double elastic, damping, reversible, first, second;
};

/* Description common to all laws. Texts are plain sentences; parameters end with a NULL name. `example` gives
 * parameters as in a scene file, for figures 8 and 9 and for tests: a normal law's for 0.03 kg at 1 m/s, a friction
 * law's for speeds up to 5 mm/s under 0.03 kg x g. */
struct scree_law_text {
    const char *name, *formula, *source, *note, *example;
    const struct scree_parameter *parameters;
};

struct scree_normal_law {
    struct scree_law_text text;
    int cut;            /* force never pulls: F = max(0, F); the contact ends where F = 0 */
    int memory;         /* keeps numbers of the contact */
    int turns_smoothly; /* one formula holds while bodies approach and part */
    int takes_roots;    /* takes scree_roots */
    int raises;         /* takes a power whose exponent is a parameter; `bake` says which (scree_exponent_of) */
    int root; /* the dashpot sets in like this root of the overlap (4, 2); 0: like a whole power, or at once */
    /* Check what ranges can't say and compute the law's constants. `values` are within their ranges. */
    scree_status (*bake)(const struct scree_values *values, struct scree_law_constants *law, scree_trouble *trouble);
    /* `mass` effective mass m1 m2/(m1 + m2), kg; `radius` effective radius R1 R2/(R1 + R2), m. */
    struct scree_pair_constants (*pair)(const struct scree_law_constants *law, double mass, double radius);
    struct scree_normal_force (*force)(const struct scree_law_constants *law, struct scree_pair_constants pair,
                                       struct scree_pressing at);
    /* Energy that the contact gives back, J. */
    double (*stored)(const struct scree_law_constants *law, struct scree_pair_constants pair, struct scree_pressing at);
    /* Whether the formula changes between two instants of a contact, other than because approach turns into parting: at
     * an overlap, a speed, where it yields. NULL: it doesn't. Both have the memory of the first. */
    int (*bends)(const struct scree_law_constants *law, struct scree_pair_constants pair, struct scree_pressing from,
                 struct scree_pressing to);
    /* Largest gap at which bodies that have touched still pull each other, m; NULL: none. Such a law keeps in `second`
     * whether they do (> 0). */
    double (*reach)(const struct scree_law_constants *law, struct scree_pair_constants pair);
    /* Force that is there at once, not growing from zero, where contact begins, or where it ends, N. NULL: none. */
    double (*jump)(const struct scree_law_constants *law, struct scree_pair_constants pair, int ends);
    /* The law whose `force`, `stored` and `bends` do the same, with constants of their own; NULL: there is none, or it
     * is this one. Loops are compiled once for both. */
    const struct scree_normal_law *like;
    /* Closed form of the restitution of two bodies of effective mass `mass` that meet at `speed`; NULL if none. */
    double (*restitution)(const struct scree_law_constants *law, struct scree_pair_constants pair, double mass,
                          double speed);
};

/* A contact as a friction law sees it in the middle of a step: normal force (>= 0, N), tangential velocity of the ball
 * against its partner (m/s), overlap (m) and closing speed (m/s), and the memory as it was `half` a step (s) before:
 * the tangential stretch (m; N of a law that is `in_force`), and whether the contact was sliding. With half = 0
 * everything is of one instant. `apart`: the share of the step in which the bodies don't touch, and no dashpot acts. */
struct scree_sliding {
    double normal, overlap, closing, half, apart;
    struct vec velocity, stretch;
    double sliding;
    struct scree_roots roots;
    int bare; /* a slider is known to have no dashpot */
};

/* Force on the ball in the middle of the step, N, and the memory at its end. */
struct scree_tangential {
    struct vec force, stretch;
    double sliding;
};

/* What a slider bears: the largest force that it holds as it is, and with which it slides, N. */
struct scree_hold {
    double holds, slides;
};

/* A slider with spring and dashpot behind it, in a step (slider.h): its trial force is k s + drag v; a step that sticks
 * takes the stretch on by `stays` v, one that slides keeps 1 - `gone` of it but for what the force carries, and takes
 * it on by `goes` v times the force over the trial force. */
struct scree_slider {
    double k, drag, gone, goes, stays; /* N/m, N s/m, 1, s, s */
    struct scree_hold bears;
};

struct scree_friction_law {
    struct scree_law_text text;
    int memory;      /* keeps state, and stretch of a spring behind a slider (`hold`) or of a bristle (`rate`) */
    int in_force;    /* of a slider: what is kept isn't the stretch but the force of its spring, N */
    int rescaled;    /* of such a force: it falls with the stiffness, sqrt(d), while the overlap does */
    int takes_roots; /* `grip` takes scree_roots */
    int root;        /* the stiffness sets in like this root of the overlap; 0: otherwise */
    scree_status (*bake)(const struct scree_values *values, struct scree_law_constants *law, scree_trouble *trouble);
    /* As for normal laws; only the first two constants count. NULL: there are none. */
    struct scree_pair_constants (*pair)(const struct scree_law_constants *law, double mass, double radius);
    struct scree_tangential (*force)(const struct scree_law_constants *law, struct scree_pair_constants pair,
                                     struct scree_sliding at);
    /* Of a slider whose memory is its stretch: what it is in a step. `force` is scree_slide of that, and the loop does
     * it in several passes. NULL: it isn't one. */
    struct scree_slider (*grip)(const struct scree_law_constants *law, struct scree_pair_constants pair,
                                struct scree_sliding at);
    /* What a law with memory makes of it at an instant, for those who integrate it in time; exactly one of the two:
     * that of a slider behind a spring, whose stretch `force` with half = 0 cuts to what it holds, or the rate (m/s) at
     * which the stretch of a bristle changes. NULL: it is the other, or keeps nothing. */
    struct scree_hold (*hold)(const struct scree_law_constants *law, struct scree_sliding at);
    struct vec (*rate)(const struct scree_law_constants *law, struct scree_pair_constants pair,
                       struct scree_sliding at);
    /* Of `rate`: the most that the bristles' springs bear under a load, N; as it falls they give up what is beyond. */
    double (*bears)(const struct scree_law_constants *law, struct scree_sliding at);
    /* Of `hold`: the sliding speed (m/s) at which what the slider holds jumps. NULL: nowhere. */
    double (*band)(const struct scree_law_constants *law);
    /* Energy in the stretch, J. */
    double (*stored)(const struct scree_law_constants *law, struct scree_pair_constants pair, struct scree_sliding at);
    /* Steepest rise of the coefficient with speed, s/m, and stiffness (N/m) and damping (N s/m) of a tangential
     * spring at an overlap: what limits the step. Zero where there is none. */
    double (*slope)(const struct scree_law_constants *law);
    double (*stiffness)(const struct scree_law_constants *law, struct scree_pair_constants pair, double overlap);
    double (*damping)(const struct scree_law_constants *law, struct scree_pair_constants pair, double overlap);
};

/* What a slider whose hold jumps at a speed holds on one side of the jump, whatever its speed is: for those who locate
 * where it passes to the other. */
static inline struct scree_hold scree_hold_on(const struct scree_friction_law *friction,
                                              const struct scree_law_constants *law, struct scree_sliding at,
                                              int inside) {
    if (!friction->band) return friction->hold(law, at);
    double band = friction->band(law);
    if ((vec_norm(at.velocity) < band) != inside) at.velocity = vec(inside ? 0.5 * band : 2.0 * band, 0.0, 0.0);
    return friction->hold(law, at);
}

/* A slider behind a bare spring? Whether there is a dashpot is a matter of the law, not of the pair or the overlap. */
static inline int scree_is_bare(const struct scree_friction_law *friction, const struct scree_law_constants *law,
                                struct scree_pair_constants pair) {
    return friction->hold && friction->damping(law, pair, 1.0) == 0.0;
}

/* A rolling law resists the relative turning of two bodies: rolling, about axes across the normal, and twisting, about
 * the normal. It sees both as if they were sliding, at the lever R, the effective radius: velocities are R times the
 * relative angular velocity of the ball, along its axis, and the forces that it returns are torques over R. One
 * function serves both, with the coefficient of the one or the other. */
struct scree_rolling_law {
    struct scree_law_text text;
    int memory; /* keeps stretch and state, of rolling and of twisting */
    /* The first two constants are the coefficients of rolling and of twisting. */
    scree_status (*bake)(const struct scree_values *values, struct scree_law_constants *law, scree_trouble *trouble);
    struct scree_tangential (*resist)(const struct scree_law_constants *law, double coefficient,
                                      struct scree_sliding at);
    /* As for friction laws, at the lever R; stiffness/2 x stretch^2 is the energy stored. */
    double (*slope)(const struct scree_law_constants *law);
    double (*stiffness)(const struct scree_law_constants *law);
    double (*damping)(const struct scree_law_constants *law);
};
enum { SCREE_ROLLING_COEFFICIENT, SCREE_TWISTING_COEFFICIENT, SCREE_ROLLING_OWN };

/* Added to speeds before they divide: changes no speed above 1e-290 m/s. */
#define SCREE_NO_SPEED 1e-300

/* Friction of coefficient `mu` against the velocity; no memory. */
static inline struct scree_tangential scree_against(struct scree_sliding at, double mu, double speed) {
    double s = -mu * at.normal / (speed + SCREE_NO_SPEED);
    return (struct scree_tangential){vec_scale(s, at.velocity), {0.0, 0.0, 0.0}, 0.0};
}

/* Static friction must not be below kinetic friction. */
static inline scree_status scree_check_static(double holds, double slides, scree_trouble *trouble) {
    if (holds >= slides) return SCREE_OK;
    return scree_report(trouble, SCREE_BAD_INPUT, "static",
                        "static friction (%g) must not be below kinetic friction (%g)", holds, slides);
}

static inline double scree_no_store(const struct scree_law_constants *law, struct scree_pair_constants pair,
                                    struct scree_sliding at) {
    (void)law;
    (void)pair;
    (void)at;
    return 0.0;
}

static inline double scree_no_stiffness(const struct scree_law_constants *law, struct scree_pair_constants pair,
                                        double overlap) {
    (void)law;
    (void)pair;
    (void)overlap;
    return 0.0;
}

/* For normal laws whose constants don't depend on the pair of bodies. */
static inline struct scree_pair_constants scree_any_pair(const struct scree_law_constants *law, double mass,
                                                         double radius) {
    (void)law;
    (void)mass;
    (void)radius;
    return (struct scree_pair_constants){{0.0}};
}

static inline double scree_zero(const struct scree_law_constants *law) {
    (void)law;
    return 0.0;
}

static inline struct scree_exponent scree_exponent_of(double p) {
    int one = p == 1.0, half = p == 1.5, two = p == 2.0;
    return (struct scree_exponent){one || half || two, one, half, two};
}

/* x^p for x >= 0. */
static SCREE_INLINE double scree_power(double x, double p, struct scree_exponent exponent) {
    if (!exponent.known) return scree_pow(x, p);
    return x * (exponent.one + exponent.half * sqrt(x) + exponent.two * x);
}

/* A loop over contacts with the constants of a law, a copy that tells the compiler whether the exponent is known: a
 * choice inside the loop would keep it from making vectors. */
#define SCREE_FOR_EXPONENT(raises, constants, ...)                                                                     \
    do {                                                                                                               \
        if ((raises) && (constants).exponent.known) {                                                                  \
            (constants).exponent.known = 1;                                                                            \
            __VA_ARGS__                                                                                                \
        } else {                                                                                                       \
            (constants).exponent.known = 0;                                                                            \
            __VA_ARGS__                                                                                                \
        }                                                                                                              \
    } while (0)

/* Whether `x` lies between two numbers. */
static inline int scree_between(double one, double other, double x) { return (one < x) != (other < x); }

/* Adams' STEP from 0 (w <= 0) to 1 (w >= 1): 3 w^2 - 2 w^3. */
static inline double scree_step(double w) {
    w = w < 0.0 ? 0.0 : w;
    w = w > 1.0 ? 1.0 : w;
    return w * w * (3.0 - 2.0 * w);
}

#endif
