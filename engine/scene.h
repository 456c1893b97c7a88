/* A scene from the inside: definitions until it is baked, then the plan and the running state. */
#ifndef SCREE_ENGINE_SCENE_H
#define SCREE_ENGINE_SCENE_H

#include "contact/contacts.h"
#include "engine/names.h"
#include "engine/scree.h"
#include "engine/trial.h"

/* Bodies as they are defined, one or many that are alike but for the arrays. Arrays are owned. */
struct scree_body_group {
    int first, count;    /* which bodies */
    scree_body_def like; /* without name */
    double (*place)[5];  /* position, radius, mass; NULL: `like` says them */
    double (*motion)[6]; /* velocity, spin; NULL: `like` says them */
};

/* How the step was chosen, and what limits it. */
struct scree_step_choice {
    double step;
    double limit;      /* s: the scheme is unstable beyond it */
    int limit_pair[2]; /* bodies of the contact that sets the limit; -1: nothing limits */
    double duration;   /* s: of the shortest contact */
    int shortest_pair[2];
    double reach; /* m: farthest that a normal law holds bodies beyond touch */
    double speed; /* m/s reckoned with */
    int speed_given;
    int automatic;
    double accurate;      /* s: the longest step that is accurate enough, if an accuracy was asked for */
    int bound_by_damping; /* the automatic step is below that, or 1/50 of a contact, because of damping or friction */
};

/* Trial impacts for one contact rule, if an accuracy was asked for. */
struct scree_rule_trial {
    int pair[2];     /* bodies whose contact is the shortest; -1: none can meet */
    double duration; /* of it, s */
    struct scree_trial impact;
    struct scree_trial_result result[SCREE_PAIR_IMPULSE + 1]; /* by the integrators that were tried */
};

/* What the plan says about the scene. */
struct scree_scene_plan {
    struct scree_step_choice choice;
    int any_integrator;             /* the scene has left it to the plan */
    struct scree_rule_trial *trial; /* owned; one a rule; NULL: no accuracy was asked for */
    int free, driven, fixed;        /* bodies */
    int balls, general;             /* free or driven ones, by class */
    long pairs_all, pairs_meeting;  /* pairs of bodies */
    long pairs_still, pairs_none;   /* skipped: forces move neither; materials or shapes that pass through each other */
    double start_overlap,
        start_share;            /* the deepest at the start, m, and in parts of the tolerable; 0: nothing touches */
    int start_ball, start_host; /* whose */
};

/* The state to which a run goes back to halve its step, as save.c writes it, and what no state holds. */
struct scree_checkpoint {
    char *state; /* owned */
    size_t size;
    double hasty;
    int hastiest, books_begun;
};

/* What the watch knows of the run so far: halvings, and the books at the start or the last halving and the largest
 * energy of motion and the least and most that was stored since then; J. */
struct scree_watched {
    int halvings, begun; /* the books are */
    double since;        /* when, s */
    double balance, lost, driven;
    double motion, least_stored, most_stored;
    double lacking; /* by which share of what was turned over the books were off before, summed over all halvings */
};

/* A scene, from its definitions to the last step. */
struct scree_scene {
    scree_trouble trouble;
    int baked; /* 0: still being defined, 1: ready, -1: baking failed */

    /* Definitions. Strings and arrays in them are owned. */
    int materials, motions, rules, groups;
    int material_capacity, motion_capacity, rule_capacity, group_capacity;
    scree_material_def *material;
    struct scree_motion *motion; /* handed over to `bodies` when baked */
    char **motion_name;
    struct scree_rule *rule;
    int defs;                       /* bodies */
    struct scree_body_group *group; /* given up once the bodies are made */
    struct scree_names names;       /* of the bodies */
    uint64_t start;                 /* fingerprint of where and how bodies start, made with them */
    scree_gravity_def gravity;
    scree_time_def time;
    int bounded; /* there is a domain */
    scree_domain_def domain;

    /* The running scene. */
    struct scree_scene_plan plan;
    struct scree_bodies bodies;
    struct scree_bodies shadow; /* records at the instant of the state, made when first measured */
    struct scree_contacts contacts;
    double step; /* s */
    long steps;
    int ahead;           /* members of slabs (bodies/order.c) are at the middle of the next step already, */
    int too_far;         /* and one of them has outgrown its margin there */
    int waits;           /* all records are at the middle of the next step, for whose lists there was no memory */
    double carried[3];   /* kg m, mass times way of all bodies' returns into the periodic box, against it */
    double driven;       /* J put in by drives and tilting so far */
    double first_energy; /* J at the start */
    double hasty;        /* longest way of a body in one step, in parts of what the list looks ahead */
    int hastiest;        /* which body */
    int books_begun;     /* the energy books begin at the state that was restored, which held none */
    struct scree_watched watched;
    struct scree_checkpoint checkpoint;
    scree_halving halving[SCREE_HALVINGS];
    struct scree_adaptive *adaptive; /* NULL with other integrators */
    scree_effort effort;
    double inner_step; /* s: that the adaptive integrator tries next; 0: none yet */
};

/* Steps without and with the watch that halves the step. */
scree_status scree_step_plainly(struct scree_scene *scene, long steps);
scree_status scree_step_watched(struct scree_scene *scene, long steps);

/* How many steps the scene may go through in one sweep (scree_most_in_sweep), at most. */
int scree_scene_most_in_sweep(const scree_scene *scene);

/* By which share of what was turned over the books are off with watch = "halve": the shares kept at each halving, and
 * that since the last, added up. 0 if there is no memory to reckon it. */
double scree_books_lack(scree_scene *scene);

/* J turned over since the books are watched (all 0: since the start): the most that moved, or was stored and released,
 * what contacts took and drives gave. What is stored all the time since then, as in a load at rest, isn't. */
double scree_turned_over(struct scree_watched *watched, const scree_energy *energy);

/* The share of what was turned over by which the books may be off. */
extern const double scree_tolerable_gap;

/* J that are too little to judge the books by. */
double scree_too_little(const scree_scene *scene, const scree_energy *energy);

/* Definition of body k, which must not be baked yet, without its name. */
scree_body_def scree_scene_definition(const struct scree_scene *scene, int k);

/* Of a baked scene: whether a body's mass is given, not that of its material's density. */
int scree_has_own_mass(const struct scree_scene *scene, int index);

/* Give up the definitions of bodies. */
void scree_scene_free_groups(struct scree_scene *scene);

/* Gravity at a time, m/s^2. */
void scree_gravity_at(const struct scree_scene *scene, double time, double gravity[3]);

/* Bring the shadow to the state; SCREE_NO_MEMORY. */
scree_status scree_scene_look_now(struct scree_scene *scene);

/* scree_scene_energy for a scene that is just being baked; SCREE_NO_MEMORY, SCREE_FAILED if numbers don't hold them. */
scree_status scree_energy_now(struct scree_scene *scene, scree_energy *energy);

/* Effective radius of two bodies for their laws, whichever of them is the ball: the rounder one of two boxes; m. */
double scree_radius_of_pair(const struct scree_bodies *bodies, int i, int j);

/* Whether all three numbers are finite. */
int scree_is_finite(const double a[3]);

/* Report that the run went wrong in body `body` (and `other`; -1: none) at `time`; SCREE_FAILED. */
scree_status scree_scene_stop(struct scree_scene *scene, double time, int body, int other, const char *cause);

/* Stop if some overlap has grown too large. */
scree_status scree_check_depth(struct scree_scene *scene, double time);

/* The adaptive integrator (adaptive.h): make and free it; one step of the scene. */
scree_status scree_adaptive_create(struct scree_scene *scene);
void scree_adaptive_destroy(struct scree_scene *scene);
scree_status scree_adaptive_step(struct scree_scene *scene);

/* Name of body number k for messages. */
static inline scree_name scree_name_of(const struct scree_scene *scene, int k) {
    return k >= 0 && k < scene->names.count ? scree_names_at(&scene->names, k) : (scree_name){"nothing"};
}

#endif
