/* A scene from the inside: definitions until it is baked, then the plan and the running state. */
#ifndef SCREE_ENGINE_SCENE_H
#define SCREE_ENGINE_SCENE_H

#include "contact/contacts.h"
#include "engine/names.h"
#include "engine/scree.h"

/* Bodies as they are defined, one or many that are alike but for the arrays. Arrays are owned. */
struct scree_body_group {
    int first, count;    /* which bodies */
    scree_body_def like; /* without name */
    double (*place)[4];  /* position, radius; NULL: `like` says them */
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
    int bound_by_damping; /* the automatic step is below 1/50 of a contact because of damping or friction */
};

/* What the plan says about the scene. */
struct scree_scene_plan {
    struct scree_step_choice choice;
    int free, driven, fixed;       /* bodies */
    int balls, general;            /* free or driven ones, by class */
    long pairs_all, pairs_meeting; /* pairs of bodies */
    long pairs_still, pairs_none;  /* skipped: forces move neither; materials or shapes that pass through each other */
};

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
    double step;
    long steps;
    int ahead;           /* members of slabs (bodies/order.c) are at the middle of the next step already, */
    int too_far;         /* and one of them has outgrown its margin there */
    double carried[3];   /* kg m, mass times way of all bodies' returns into the periodic box, against it */
    double driven;       /* J put in by drives and tilting so far */
    double first_energy; /* J at the start */
    double hasty;        /* longest way of a body in one step, in parts of what the list looks ahead */
    int hastiest;        /* which body */
    int books_begun;     /* the energy books begin at the state that was restored, which held none */
};

/* Definition of body k, which must not be baked yet. */
scree_body_def scree_scene_definition(const struct scree_scene *scene, int k);

/* Give up the definitions of bodies. */
void scree_scene_free_groups(struct scree_scene *scene);

/* Gravity at a time, m/s^2. */
void scree_gravity_at(const struct scree_scene *scene, double time, double gravity[3]);

/* Bring the shadow to the state; SCREE_NO_MEMORY. */
scree_status scree_scene_look_now(struct scree_scene *scene);

/* scree_scene_energy for a scene that is just being baked. */
scree_status scree_energy_now(struct scree_scene *scene, scree_energy *energy);

/* Effective radius of two bodies for their laws, whichever of them is the ball: the rounder one of two boxes; m. */
double scree_radius_of_pair(const struct scree_bodies *bodies, int i, int j);

/* Name of body number k for messages. */
static inline const char *scree_name(const struct scree_scene *scene, int k) {
    return k >= 0 && k < scene->names.count ? scene->names.name[k] : "nothing";
}

#endif
