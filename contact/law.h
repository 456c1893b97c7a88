/* What a contact law is: a description that people and programs read, and inline functions from values to values.
 *
 * A normal law lives in one header normal_<word>.h, a friction law in friction_<word>.h; the word stands in one
 * list in contact/meson.build. Everything else follows from that list. The functions hold no state and touch no
 * memory: the loop loads, calls, stores. They use + - x / sqrt, comparisons and bodies/elementary.h only, so that
 * they give the same bits everywhere and the compiler can evaluate several contacts at once.
 *
 * Signs: overlap d > 0 while touching; closing speed u > 0 while approaching; forces on the ball of the pair. */
#ifndef SCREE_CONTACT_LAW_H
#define SCREE_CONTACT_LAW_H

#include "bodies/elementary.h"
#include "bodies/trouble.h"
#include "bodies/vec.h"

enum { SCREE_LAW_CONSTANTS = 8, SCREE_PAIR_CONSTANTS = 4, SCREE_PARAMETERS = 8, SCREE_MEMORY = 4 };

/* Which numbers a parameter may take. */
enum scree_range {
    SCREE_ANY_POSITIVE,  /* > 0 */
    SCREE_NOT_NEGATIVE,  /* >= 0 */
    SCREE_FRACTION,      /* 0 < value <= 1 */
    SCREE_AT_LEAST_ONE,  /* >= 1 */
    SCREE_FROM_ONE_TO_3, /* 1 … 3 */
};

struct scree_parameter {
    const char *name, *unit, *meaning;
    enum scree_range range;
    const char *instead_of; /* name of another parameter: exactly one of the two must be given */
    double fallback;        /* counts if the parameter isn't given and `optional` is set */
    int optional;
    int shared; /* divided by the number of contacts that share one load */
};

/* Values of the parameters in the order of their list; NAN where not given. */
struct scree_values {
    double v[SCREE_PARAMETERS];
};

/* Constants of a law for one pair of materials, made once from the parameters. */
struct scree_law_constants {
    double c[SCREE_LAW_CONSTANTS];
};

/* Constants of a law for one pair of bodies: they depend on effective mass and radius too. */
struct scree_pair_constants {
    double c[SCREE_PAIR_CONSTANTS];
};

/* F = elastic + damping u, cut to F >= 0 if the law says so. `reversible` is dU/dd, the part of the force that is
 * stored in the contact; the power lost is (F - reversible) u. */
struct scree_normal_force {
    double elastic, damping, reversible;
};

/* Description common to all laws. Texts are plain sentences; parameters end with a NULL name. */
struct scree_law_text {
    const char *name, *formula, *source, *note;
    const struct scree_parameter *parameters;
};

struct scree_normal_law {
    struct scree_law_text text;
    int cut; /* force never pulls: F = max(0, F); the contact ends where F = 0 */
    /* Check what ranges can't say and compute the law's constants. `values` are within their ranges. */
    scree_status (*bake)(const struct scree_values *values, struct scree_law_constants *law, scree_trouble *trouble);
    /* `mass` effective mass m1 m2/(m1 + m2), kg; `radius` effective radius R1 R2/(R1 + R2), m. */
    struct scree_pair_constants (*pair)(const struct scree_law_constants *law, double mass, double radius);
    struct scree_normal_force (*force)(const struct scree_law_constants *law, struct scree_pair_constants pair,
                                       double overlap, double closing);
    double (*stored)(const struct scree_law_constants *law, struct scree_pair_constants pair, double overlap);
    /* Closed form of the restitution of two bodies of effective mass `mass` that meet at `speed`; NULL if none. */
    double (*restitution)(const struct scree_law_constants *law, struct scree_pair_constants pair, double mass,
                          double speed);
};

/* A contact as a friction law sees it in the middle of a step: normal force (>= 0), tangential velocity of the ball against
 * its partner, and the memory as it was `half` a step (s) before: the tangential stretch, and whether the contact was
 * sliding. With half = 0 everything is of one instant. */
struct scree_sliding {
    double normal, half;
    struct vec velocity, stretch;
    double sliding;
};

/* Force on the ball in the middle of the step, and the memory at its end. */
struct scree_tangential {
    struct vec force, stretch;
    double sliding;
};

struct scree_friction_law {
    struct scree_law_text text;
    int memory; /* doubles kept per contact between steps: 0 or SCREE_MEMORY */
    scree_status (*bake)(const struct scree_values *values, struct scree_law_constants *law, scree_trouble *trouble);
    struct scree_tangential (*force)(const struct scree_law_constants *law, struct scree_sliding at);
    double (*stored)(const struct scree_law_constants *law, struct vec stretch);
    /* Steepest rise of the coefficient with speed, s/m, and stiffness (N/m) and damping (N s/m) of a tangential
     * spring: what limits the step. Zero where there is none. */
    double (*slope)(const struct scree_law_constants *law);
    double (*stiffness)(const struct scree_law_constants *law);
    double (*damping)(const struct scree_law_constants *law);
};

/* Added to speeds before they divide: changes no speed above 1e-290 m/s. */
#define SCREE_NO_SPEED 1e-300

/* Friction of coefficient `mu` against the velocity; no memory. */
static inline struct scree_tangential scree_against(struct scree_sliding at, double mu, double speed) {
    double s = -mu * at.normal / (speed + SCREE_NO_SPEED);
    return (struct scree_tangential){vec_scale(s, at.velocity), {0.0, 0.0, 0.0}, 0.0};
}

static inline double scree_no_store(const struct scree_law_constants *law, struct vec stretch) {
    (void)law;
    (void)stretch;
    return 0.0;
}

static inline double scree_zero(const struct scree_law_constants *law) {
    (void)law;
    return 0.0;
}

/* x^p for x >= 0; the exponents that laws use most take the short way. */
static inline double scree_power(double x, double p) {
    if (p == 1.0) return x;
    if (p == 1.5) return x * sqrt(x);
    return scree_pow(x, p);
}

/* Adams' STEP from 0 (w <= 0) to 1 (w >= 1): 3 w^2 - 2 w^3. */
static inline double scree_step(double w) {
    w = w < 0.0 ? 0.0 : w;
    w = w > 1.0 ? 1.0 : w;
    return w * w * (3.0 - 2.0 * w);
}

#endif
