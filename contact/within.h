/* One contact inside one step of the pair-impulse method (impulse.c): what it is given, what becomes of it, what it
 * yields. */
#ifndef SCREE_CONTACT_WITHIN_H
#define SCREE_CONTACT_WITHIN_H

#include "contact/catalogue.h"

/* A contact during one step: what stays. */
struct scree_pair_motion {
    const struct scree_normal_law *normal;
    const struct scree_friction_law *friction; /* NULL: none */
    const struct scree_law_constants *normal_law, *friction_law;
    struct scree_pair_constants normal_pair, friction_pair;
    struct vec n;         /* from the host to the ball, at the start of the step */
    struct mat give;      /* W: acceleration of the ball against its host per unit of force on it, 1/kg */
    struct vec a;         /* acceleration that isn't the pair's own, m/s^2 */
    double normal_give;   /* n.W n, 1/kg */
    double sideways_give; /* the largest that W gives in the tangent plane, or more, 1/kg */
    double reach;         /* largest gap that a pulling contact bridges, m */
    double step;
    int root, substeps;
    int slider;     /* friction is a slider behind a spring */
    int bare;       /* which has no dashpot beside it */
    int turns;      /* force may change its formula where approach turns into parting */
    int books;      /* energy is looked at */
    double borne;   /* part of the normal force that friction counts from (scree_borne), */
    double relief;  /* less this, N (scree_relief) */
    double muffled; /* how many times slower the normal law is told that they close in (scree_muffled) */
};

/* A contact at one instant. */
struct scree_pair_instant {
    double overlap;
    struct vec velocity;
    double first, second; /* memory of the normal law */
    struct vec stretch;   /* memory of the friction law */
    double sliding;
    int inside; /* of a slider whose hold jumps at a speed: it is below that */
};

/* Forces at one instant. */
struct scree_pair_load {
    struct vec force; /* on the ball, N */
    double normal, damping;
    double rubbing; /* power lost to friction, W */
    double first, second;
};

/* What a stretch of time has yielded: impulse and its moment about the end of that time; work lost. */
struct scree_pair_yield {
    struct vec impulse, moment;
    double lost, rubbed;
    int dips, below; /* of a piece: a slider may have changed twice in it; it has changed by the end */
};

/* The normal law as it is, without its cut: so its force is smooth up to the end of the contact and beyond. */
void scree_pair_press(const struct scree_pair_motion *p, const struct scree_pair_instant *at,
                      struct scree_pair_load *load);

/* Through the whole step, from `at`, which is moved to its end. Returns impulse and moment on the ball, along the axes
 * of the start. */
struct scree_pair_yield scree_pair_act(const struct scree_pair_motion *p, struct scree_pair_instant *at);

#endif
