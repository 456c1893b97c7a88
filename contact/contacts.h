/* The contacts of a scene: which pairs of bodies may touch, which contacts are near, and the one loop that turns
 * body records into impulses.
 *
 *   candidates   pairs of bodies that may touch before the list is made anew (candidates.c)
 *   list         their contacts within reach, one batch per geometry and pair of materials (list.c)
 *   loop         blocks of contacts through short passes; impulses into the bodies (loop.c)
 *
 * A contact is a ball (a sphere, or the corner of a rounded box) on a partner: another ball, a plane, a rectangle
 * or a box; or an edge on an edge (crossing.h). Whatever it is, it becomes a normal, an overlap and two arms, and goes
 * through the same laws. Every listed contact is computed, or known to give zero, as those out of touch do: so the result
 * doesn't depend on when lists are made. */
#ifndef SCREE_CONTACT_CONTACTS_H
#define SCREE_CONTACT_CONTACTS_H

#include "bodies/bodies.h"
#include "contact/catalogue.h"
#include "contact/crossing.h"

#include <stdint.h>

enum { SCREE_LANES = 16 }; /* contacts in a block: their work columns stay in the L1 cache */

/* Columns of pair constants: those of the normal law, then two of the friction law, then the lever of the rolling law, m. */
enum {
    SCREE_PAIR_FRICTION = SCREE_PAIR_CONSTANTS,
    SCREE_PAIR_LEVER = SCREE_PAIR_FRICTION + 2,
    SCREE_PAIR_COLUMNS = SCREE_PAIR_LEVER + 1
};

enum scree_geometry {
    SCREE_BALL_BALL,
    SCREE_BALL_PLANE,
    SCREE_BALL_RECTANGLE,
    SCREE_BALL_BOX,
    SCREE_EDGE_EDGE,
    SCREE_GEOMETRIES
};

/* One contact: ball on body `ball`, partner body `host`; `corner` is a row of the bodies' corner table (0: the ball is the
 * body's centre), or with SCREE_EDGE_EDGE tells both edges (scree_crossing_code). Lists are sorted by (ball, host, corner),
 * which is also what tells a contact again in the next list. */
struct scree_contact {
    int ball, host, corner;
};

/* What a block of contacts yields. Impulses on the ball in N s, angular impulses on both bodies in N m s. */
struct scree_yield {
    double impulse[3][SCREE_LANES], turn_ball[3][SCREE_LANES], turn_host[3][SCREE_LANES];
    double depth[SCREE_LANES]; /* overlap over the largest tolerable overlap */
    double
        steep[SCREE_LANES]; /* step x slope of the friction law x normal force x softness: friction chatters beyond 1 */
    int silent;             /* only edges on edges: nothing touches, the rest isn't filled in */
    double lost_normal;     /* J dissipated in normal direction during the step (if measured) */
    double work_tangential; /* J done against friction during the step (if measured) */
};

/* What the pair-impulse method yields beside it, and keeps of each contact: the impulses of the last two steps, N s. */
enum { SCREE_PAST = 6 };

struct scree_moments {
    double impulse[3][SCREE_LANES], turn_ball[3][SCREE_LANES], turn_host[3][SCREE_LANES]; /* N s^2, N m s^2 */
};

/* The contacts of two boxes edge on edge, a run of their batch. */
struct scree_run {
    int start;    /* its first contact in the batch */
    double clear; /* how far the boxes may move, m, their ways since the list added up, and not touch */
    struct scree_rectangles first; /* where to look first whether corners bear all */
};

/* Contacts of one geometry between one pair of materials. Owns its arrays; they grow and never shrink. */
struct scree_batch {
    enum scree_geometry geometry;
    int rule;   /* index of the laws */
    int memory; /* how many numbers of each contact laws may keep, from the first on */
    int turns;  /* all contacts can turn bodies: friction, rolling, or a box as partner; else only those of corners */
    int any_turns; /* some do */
    double slope;  /* of friction and rolling laws, s/m; 0 if none is regularised by velocity */
    int uniform;   /* one set of pair constants serves all (made for the first block) */
    int count, capacity;
    struct scree_contact *contact;
    double (*pair)[SCREE_PAIR_COLUMNS][SCREE_LANES]; /* per block, or one if uniform */
    double (*kept)[SCREE_MEMORY][SCREE_LANES];       /* contact memory per block; NULL without */
    struct scree_yield *yield;                       /* per block */
    /* Only of edges on edges: the runs, and of each block the run of its first contact. */
    int runs;
    struct scree_run *run;
    int *first_run;
    /* For the pair-impulse method; NULL without it. */
    int impulses;
    double (*past)[SCREE_PAST][SCREE_LANES];
    struct scree_moments *moments;
    /* The list before this one, from which memory is carried over. */
    int old_count;
    struct scree_contact *old_contact;
    double (*old_kept)[SCREE_MEMORY][SCREE_LANES];
    double (*old_past)[SCREE_PAST][SCREE_LANES];
};

struct scree_body_pair {
    int i, j; /* i < j */
};

struct scree_contacts {
    int materials;
    int rules;
    struct scree_rule *rule;
    int *rule_of; /* [materials x materials]: index of the rule, -1 if none is defined */
    int batches;
    struct scree_batch *batch;
    int *batch_of; /* [rules x SCREE_GEOMETRIES]: index of the batch */
    int *busy;     /* indices of the batches that hold contacts, in order */
    int busy_batches;

    int pairs, pair_capacity;
    struct scree_body_pair *pair, *sorted;
    /* Cells of the broad phase (candidates.c): per body its grid, its cell's key and the next body of the chain; the first body
     * of each chain; scratch for sorting. */
    unsigned char *level;
    uint64_t *key;
    int *next, *place, *start;
    size_t last_place; /* number of places, a power of two, less one */
    double skin;       /* contacts with a gap up to this are listed, m */
    long rebuilds;

    int substeps;           /* of the pair-impulse method */
    int measured;           /* sum up dissipation */
    double lost_normal;     /* J dissipated in normal direction so far */
    double work_tangential; /* J done against friction and rolling resistance so far */

    double deepest; /* largest overlap over tolerable overlap so far */
    int deepest_ball, deepest_host;
    double steepest; /* largest scree_yield.steep so far */
    int steepest_ball, steepest_host;
};

/* For a scene of so many bodies and materials; the rules are copied. */
scree_status scree_contacts_create(struct scree_contacts *contacts, int bodies, int materials,
                                   const struct scree_rule *rules, int rule_count, scree_trouble *trouble);
void scree_contacts_destroy(struct scree_contacts *contacts);

/* The rule for two bodies, NULL if forces can move neither, if their shapes never meet, or if their materials pass
 * through each other. `missing` (may be NULL) is set to 1 if the two could meet and no rule is defined. */
const struct scree_rule *scree_contacts_rule(const struct scree_contacts *contacts, const struct scree_bodies *bodies,
                                             int i, int j, int *missing);

/* Make the list of near contacts from the records as they are; carries contact memory over, clears the paths.
 * SCREE_NO_MEMORY keeps the old list. */
scree_status scree_contacts_list(struct scree_contacts *contacts, struct scree_bodies *bodies, scree_trouble *trouble);

/* Append a contact with its memory to the list of a batch, in the list's order (for a restored state; the next list
 * carries it over). `kept` counts if the batch has memory, `past` if it keeps impulses. */
scree_status scree_contacts_remember(struct scree_batch *batch, const struct scree_contact *contact, const double *kept,
                                     const double *past, scree_trouble *trouble);

/* All near contacts through the loop for one step of length `step`: impulses are added into the bodies' records. */
void scree_contacts_act(struct scree_contacts *contacts, struct scree_bodies *bodies, double step, int threads);

/* Step by pair impulses (impulse.c) instead: call it before the first list. `substeps` per step and contact, 0: one, two with
 * friction. */
void scree_contacts_keep_impulses(struct scree_contacts *contacts, int substeps);

/* Give contacts and bodies the past of a state at rest: the forces of `now` for two steps. For the start of a run. */
void scree_contacts_begin_past(struct scree_contacts *contacts, struct scree_bodies *bodies,
                               const struct scree_bodies *now, double step);

/* All near contacts through one step by pair impulses: `bodies` half a step ahead, `now` at its start (scree_bodies_look_both).
 * Impulses are added into the bodies' records, moments into their past. */
void scree_contacts_impel(struct scree_contacts *contacts, struct scree_bodies *bodies, const struct scree_bodies *now,
                          double step, int threads);

/* A contact as measured at the instant of the records, without changing anything. Vectors in the world. */
struct scree_touch {
    int ball, host, corner;
    int edges;                         /* `corner` is the code of two edges */
    double overlap, closing;           /* m, m/s */
    double normal_force;               /* N */
    double stored, stored_in_friction; /* J, in normal direction; in the springs of friction and rolling */
    struct vec normal;                 /* from the host towards the ball */
    struct vec point;                  /* middle of the overlap, m */
    struct vec slip;                   /* tangential velocity of the ball, m/s */
    struct vec tangential;             /* friction force on the ball, N */
    struct vec torque;                 /* of the rolling law on the ball, N m */
    struct vec stretch;                /* of the tangential spring, m */
    int sliding;
};

/* Measure contact `index` of batch `batch`; returns 1 if it touches, else 0. `bodies` may be a shadow. */
int scree_contacts_measure(const struct scree_contacts *contacts, const struct scree_bodies *bodies, int batch,
                           int index, struct scree_touch *touch);

/* Effective mass and radius of a pair of bodies, for law constants: of the ball and its partner. */
double scree_effective_mass(const struct scree_bodies *bodies, int i, int j);
double scree_effective_radius(const struct scree_bodies *bodies, int ball, int host, enum scree_geometry geometry);

/* ---- between the files of this folder ---- */

/* How deep the ball of a body can be in a rectangle before the whole body is below it, m. */
static inline double scree_thickness(const struct scree_record *ball) { return ball->radius + 2.0 * ball->limit; }

/* Whether the contact can turn its bodies. It depends on the contact alone: what else is listed must not change a bit. */
static inline int scree_contact_turns(const struct scree_batch *batch, const struct scree_contact *contact) {
    return batch->turns || contact->corner > 0;
}

/* Add what a block has yielded to its bodies and to the scene's sums, contact by contact. */
void scree_contacts_collect(struct scree_contacts *contacts, struct scree_bodies *bodies,
                            const struct scree_batch *batch, int block);

/* Pairs of bodies whose bounds come within `skin`, sorted by (i, j). */
scree_status scree_candidates(struct scree_contacts *contacts, const struct scree_bodies *bodies,
                              scree_trouble *trouble);

/* Batch for a rule and a geometry. */
static inline struct scree_batch *scree_batch_for(const struct scree_contacts *contacts, const struct scree_rule *rule,
                                                  enum scree_geometry geometry) {
    long index = rule - contacts->rule;
    return &contacts->batch[contacts->batch_of[index * SCREE_GEOMETRIES + geometry]];
}

#endif
