/* How a user names laws for a pair of materials. */
#ifndef SCREE_CONTACT_CHOICE_H
#define SCREE_CONTACT_CHOICE_H

/* Parameters that a law can have. */
#define SCREE_SETTINGS_MAX 12

/* One parameter of a law, by the name that `scree laws` prints, in the unit that it prints. */
typedef struct scree_setting {
    const char *name;
    double value;
} scree_setting;

/* A law and its parameters. A NULL or empty `law` means: no such force. */
typedef struct scree_law_choice {
    const char *law; /* as `scree laws` prints it */
    int settings;    /* 0 … SCREE_SETTINGS_MAX: so many entries of `setting` count */
    scree_setting setting[SCREE_SETTINGS_MAX];
} scree_law_choice;

/* Measured forces on a grid of overlaps and closing speeds, for the normal law "table". */
typedef struct scree_force_table {
    int overlaps, speeds;  /* >= 2; >= 1: with one, which is 0, the force doesn't depend on the speed */
    const double *overlap; /* m, rising from 0 */
    const double *speed;   /* m/s, rising, 0 among them; positive while the bodies approach */
    const double *force;   /* N, force[k * speeds + s] */
} scree_force_table;

/* The contact between two materials (indices returned by scree_scene_add_material, in either order). */
typedef struct scree_contact_def {
    int between[2];
    scree_law_choice normal;        /* required unless `none` is set */
    scree_law_choice friction;      /* optional: without it the contact is frictionless */
    scree_law_choice rolling;       /* optional: resistance to rolling and twisting; for spheres on whatever partner */
    const scree_force_table *table; /* of the normal law "table"; copied */
    int shared_by; /* contacts that share one load: stiffness and damping are totals, divided by it; 0 means 1 */
    int none;      /* bodies of these materials pass through each other */
    int corners;   /* boxes meet each other with their corner spheres alone, not edge on edge */
} scree_contact_def;

#endif
