/* scree: a discrete-element engine for spheres and boxes that touch, slide, stick, bounce and come to rest.
 *
 * A scene is defined (materials, contacts between them, motions, bodies, gravity, time), baked, and stepped. SI units
 * throughout: m, kg, s, N, rad. Definitions are plain structs whose zero means the default. What can fail returns a
 * scree_status and leaves the details in the scene's trouble record. Nothing prints, exits or keeps globals; several
 * scenes can run in several threads at once, one thread a scene. Strings and arrays given in are copied. A pointer may
 * be NULL only where that is said.
 *
 * The state after a run is the same in every bit for any number of threads, with and without measurements, and
 * after save and restore; and on every processor: of the loops for its instructions the widest that it has is taken
 * when a scene is baked, or the one that the environment variable SCREE_ISA names (baseline, avx2, avx512). */
#ifndef SCREE_H
#define SCREE_H

#include "bodies/body.h"
#include "bodies/motion.h"
#include "bodies/trouble.h"
#include "contact/choice.h"

#include <stdint.h>
#include <stdio.h>

#ifdef __cplusplus
extern "C" {
#endif

#define SCREE_VERSION "0.1.0"

typedef struct scree_scene scree_scene;

typedef struct scree_material_def {
    const char *name; /* unique, not empty */
    double density;   /* kg/m^3; 0: bodies of this material need a mass of their own (or can't be moved by forces) */
    double young;     /* Young's modulus, Pa, for laws that take it from the materials; HUGE_VAL: rigid; 0: unknown */
    double poisson;   /* Poisson's ratio, -1 < nu <= 1/2 */
} scree_material_def;

typedef struct scree_gravity_def {
    double vector[3]; /* m/s^2; zero: none */
    int tilts;        /* turn the vector about `axis` by the angle (rad) that motion `tilt` prescribes */
    int tilt;         /* index of the motion */
    double axis[3];   /* right-handed; need not be normalised */
} scree_gravity_def;

typedef enum scree_integrator {
    /* Baking chooses. With an accuracy: Verlet or pair impulses, whichever needs less time for it; else pair impulses
     * if all that forces move are spheres, 1000 at most (few bodies whose every impact counts), and Verlet otherwise,
     * or if bodies may sleep. */
    SCREE_ANY_INTEGRATOR = 0,
    SCREE_VERLET,       /* position Verlet with predicted velocities (Tuckerman, Berne & Martyna, J. Chem. Phys. 97
                           (1992) 1990); second order */
    SCREE_PAIR_IMPULSE, /* each contact integrates its own motion inside the step, its begin and end located: more
                           digits from the same step for damped contacts, at several times the cost; second order */
    SCREE_ADAPTIVE,     /* the whole scene to a tolerance, every event located, by Dormand & Prince's method of order 8
                           (Hairer, Norsett & Wanner, Solving Ordinary Differential Equations I, II.10): for small
                           scenes */
} scree_integrator;

/* What becomes of a run that goes wrong (scree_scene_step says when). */
typedef enum scree_watch {
    SCREE_WATCH_STOP = 0, /* it stops */
    SCREE_WATCH_HALVE, /* it goes back to where it was last kept in memory (where scree_scene_step was called, or up to
                          1000 steps before), halves the step and goes on; after 10 halvings it stops. The energy books
                          are kept, and books that are off by 10 % of what was turned over are a reason too. Each call
                          of scree_scene_step keeps the state, so that calls of single steps cost more. */
} scree_watch;

enum { SCREE_MOST_SUBSTEPS = 64, SCREE_MOST_THREADS = 1024 };

typedef struct scree_time_def {
    double step;   /* s, >= 0; 0: chosen from the stiffest possible contact (1/50 of its duration), less so that
                     `divide` is a whole number of steps. SCREE_ADAPTIVE chooses its own steps within this one: 0 makes it
                     `divide`, the time between rows */
    double divide; /* s, >= 0; 0: no such wish */
    /* Instead of a step: the largest error of a rebound velocity (normal, and of the contact point sideways) of one
     * impact of a sphere, in parts of the impact speed, over phases of first touch; 1e-6 to 0.1, 0: no such wish. Trial
     * impacts at `speed` find the step for every contact that bodies of the scene can meet under. Refused together with
     * a step, and with SCREE_ADAPTIVE. */
    double accuracy;
    scree_integrator integrator;
    /* Of each contact in a step, for SCREE_PAIR_IMPULSE: 1 to SCREE_MOST_SUBSTEPS times as many as its stiffness asks
     * for; 0: once as many, with friction twice where needed. */
    int substeps;
    double speed;     /* m/s, >= 0, largest impact speed to reckon with; 0: by velocities, motions and heights */
    double tolerance; /* for SCREE_ADAPTIVE: of a step, relative; 1e-13 to 1e-3; 0: 1e-10 */
    int no_flight;    /* for SCREE_ADAPTIVE: integrate free flight too, instead of going to the next possible touch at
                         once */
    /* m/s, with SCREE_VERLET: free balls and boxes that have been slower for a while, and balanced, are left alone
     * until somebody pushes them; accelerations up to 4 pi times this over the duration of the shortest contact (at
     * most a 25th of gravity's) go unnoticed then. 0: none sleeps */
    double sleep;
    int force; /* accept a step beyond the stability limit */
    scree_watch watch;
    int threads; /* 1 to SCREE_MOST_THREADS; 0: 1 */
    int energy;  /* keep the energy books (scree_scene_energy) */
} scree_time_def;

/* Many spheres at once, alike but for what the arrays say. */
typedef struct scree_spheres_def {
    const char *name; /* they are called "name 1", "name 2", … */
    int first_number; /* … or from this number on, > 0; 0: 1 */
    int material;     /* index returned by scree_scene_add_material */
    scree_joint joint;
    int count;                                  /* >= 1; each array has so many entries */
    const double (*positions)[3];               /* of the centres, m; needed */
    double radius;                              /* m; counts without `radii` */
    const double *radii;                        /* m; NULL: all have `radius` */
    const double *masses;                       /* kg; 0: by the material's density. NULL: all are by that */
    const double *velocity;                     /* of all, m/s; NULL: at rest */
    const double (*velocities)[3], (*spins)[3]; /* of each, m/s and rad/s; NULL: as said by `velocity`; no spin */
    const char *const *names;                   /* NULL: numbered as above */
} scree_spheres_def;

typedef enum scree_generator {
    /* In the middles of cubic cells, row by row from `min` on: x first, then y, then z. Spheres that don't move may be
     * wider than their cells, and then reach out of the box. */
    SCREE_LATTICE = 0,
    SCREE_RANDOM, /* anywhere in the box, one after the other, the largest first, so that none overlap: neither each
                     other nor spheres that the scene has already, nor images of them in a domain that it has */
} scree_generator;

typedef enum scree_radii {
    SCREE_RADII_UNIFORM = 0, /* any radius is as likely as any other */
    SCREE_RADII_MASS,        /* all ranges of radii of one width have the same mass */
} scree_radii;

/* Spheres that are made by rule. The same definition makes the same spheres on any machine. */
typedef struct scree_generate_def {
    const char *name; /* they are called "name 1", "name 2", … */
    scree_generator kind;
    int material; /* index returned by scree_scene_add_material */
    scree_joint joint;
    double min[3], max[3]; /* the box that holds them all, m */
    double radius[2];      /* least and largest, m; the second 0: all have the first */
    scree_radii radii;     /* how radii are spread between the two */
    int count;             /* >= 0; 0: as many as the lattice has whole cells in the box; SCREE_RANDOM: >= 1 */
    double spacing; /* of a lattice, the width of its cells, m, >= 0; 0: the largest diameter and twice the jitter */
    double jitter;  /* m by which each coordinate is off the middle of the cell, at most; >= 0 */
    uint64_t seed;  /* of jitter, radii and random places */
    double velocity[3]; /* m/s */
} scree_generate_def;

/* The box in which bodies start (their centres), and the axes along which it repeats itself for ever: what leaves on
 * one side comes in on the other, and spheres near one side meet the images of those near the other. Only spheres and
 * planes (along such an axis) may be in a periodic scene. They may start up to half a period beyond such a side.
 * Positions are reported inside of the box; velocities are as they are. */
typedef struct scree_domain_def {
    double min[3], max[3]; /* m */
    int periodic[3];       /* along x, y, z; at least two of the largest diameters long then */
} scree_domain_def;

/* An empty scene, NULL if there is no memory. The caller destroys it; NULL may be destroyed too. */
SCREE_API scree_scene *scree_scene_create(void);
SCREE_API void scree_scene_destroy(scree_scene *scene);

/* Details of the last function that failed on this scene. Belongs to the scene. */
SCREE_API const scree_trouble *scree_scene_trouble(const scree_scene *scene);

/* Definitions, before baking. `index` (may be NULL) receives the number that other definitions refer to.
 * SCREE_BAD_INPUT: names doubled or missing, numbers that aren't finite or out of range, unknown laws. */
SCREE_API scree_status scree_scene_add_material(scree_scene *scene, const scree_material_def *def, int *index);
SCREE_API scree_status scree_scene_add_motion(scree_scene *scene, const scree_motion_def *def, int *index);
SCREE_API scree_status scree_scene_add_contact(scree_scene *scene, const scree_contact_def *def);
SCREE_API scree_status scree_scene_add_body(scree_scene *scene, const scree_body_def *def, int *index);
/* `first` (may be NULL) receives the index of the first of them; the others follow. SCREE_BAD_INPUT without
 * positions, or for a sphere that can't be: the trouble record's `body` tells which, counted from 0; no sphere is added
 * then. SCREE_NO_MEMORY. */
SCREE_API scree_status scree_scene_add_spheres(scree_scene *scene, const scree_spheres_def *def, int *first);
/* SCREE_BAD_INPUT: they don't fit into the box without overlaps; lattice points of free spheres closer than a diameter;
 * SCREE_NO_MEMORY: more than the machine has memory for. */
SCREE_API scree_status scree_scene_generate(scree_scene *scene, const scree_generate_def *def, int *first);
SCREE_API scree_status scree_scene_set_gravity(scree_scene *scene, const scree_gravity_def *def);
SCREE_API scree_status scree_scene_set_domain(scree_scene *scene, const scree_domain_def *def);
SCREE_API scree_status scree_scene_set_time(scree_scene *scene, const scree_time_def *def);

/* Index of a material, motion or body by name; -1 if there is none. */
SCREE_API int scree_scene_find_material(const scree_scene *scene, const char *name);
SCREE_API int scree_scene_find_motion(const scree_scene *scene, const char *name);
SCREE_API int scree_scene_find_body(const scree_scene *scene, const char *name);

/* Check the whole scene and make the plan; after it definitions can't change. SCREE_BAD_INPUT: bodies whose materials
 * could meet without a contact between them, bodies overlapping by more than half a half-width or so far from the
 * origin that places are too coarse there (a millionth of a half-width), a step beyond the stability limit of the
 * stiffest contact, an accuracy that steps can't reach, no bodies, rolling laws between bodies that aren't spheres or
 * walls, sleep while gravity tilts, SCREE_ADAPTIVE in a periodic domain or with laws or edges that it can't follow, a
 * scene baked before; SCREE_NO_MEMORY. A scene whose baking has failed can only be
 * destroyed. */
SCREE_API scree_status scree_scene_bake(scree_scene *scene);

/* Write the plan of a baked scene for people: what runs, what is skipped and why, the step and what dictated it. Of any
 * other: that there is none. */
SCREE_API void scree_scene_describe(const scree_scene *scene, FILE *file);

/* How many bodies sleep. */
SCREE_API int scree_scene_asleep(const scree_scene *scene);

/* Advance by `steps` steps, 0 to 1e15. SCREE_BAD_INPUT: so many aren't allowed, or the scene isn't baked. SCREE_FAILED:
 * a number that isn't finite, an overlap beyond half a half-width, a body faster than the list can follow; the trouble
 * record names body, partner, time and cause, and the state is as it was then, positions to their last digit but one.
 * SCREE_NO_MEMORY: so it is then too; tried again, the step comes out as if nothing had happened, and until then the
 * scene can't be saved. A scene of balls that no cache of the processor holds may go through up to four steps at once:
 * where it stops, some or all of its balls are up to three steps later, and after SCREE_NO_MEMORY it goes on to the end
 * of these steps at least. If the watch has halved the step meanwhile, the time reached is the same, after as many more
 * steps. */
SCREE_API scree_status scree_scene_step(scree_scene *scene, long steps);

/* A halving of the step: when the run went wrong and to where it went back, s; the new step, s; and the cause in
 * words. */
typedef struct scree_halving {
    double failed, back, step;
    scree_trouble cause;
} scree_halving;
enum { SCREE_HALVINGS = 10 };

/* Halvings so far, those before a restored state among them; and each of them (0 … halvings - 1; all zero for those;
 * NULL: there is none). Belongs to the scene. */
SCREE_API int scree_scene_halvings(const scree_scene *scene);
SCREE_API const scree_halving *scree_scene_halving(const scree_scene *scene, int index);

/* Time reached (s), length of a step (s), steps taken, number of bodies. */
SCREE_API double scree_scene_time(const scree_scene *scene);
SCREE_API double scree_scene_step_length(const scree_scene *scene);
SCREE_API long scree_scene_steps(const scree_scene *scene);
SCREE_API int scree_scene_bodies(const scree_scene *scene);

typedef struct scree_body_state {
    double position[3], orientation[4], velocity[3], spin[3]; /* as in scree_body_def */
} scree_body_state;

/* Names have at most so many bytes. */
enum { SCREE_NAME_LENGTH = 255 };
typedef struct scree_name {
    char text[SCREE_NAME_LENGTH + 1];
} scree_name;

/* State, name, shape, material's name (it belongs to the scene), mass (kg; 0: none) and mobility (1: free or driven in
 * some direction) of body `index`, 0 … count - 1. Of any other: all zero, with the orientation of the axes; an empty
 * name; NULL. */
SCREE_API scree_body_state scree_scene_body(const scree_scene *scene, int index);
SCREE_API scree_name scree_scene_body_name(const scree_scene *scene, int index);
SCREE_API scree_shape scree_scene_body_shape(const scree_scene *scene, int index);
SCREE_API const char *scree_scene_body_material(const scree_scene *scene, int index);
SCREE_API double scree_scene_body_mass(const scree_scene *scene, int index);
SCREE_API int scree_scene_body_moves(const scree_scene *scene, int index);

/* Energy in J since the start. `balance` is what the books lack: kinetic + rotational + potential + stored +
 * lost_normal + lost_tangential - driven, less its value at the start; the error of the integration. */
typedef struct scree_energy {
    double kinetic, rotational, potential; /* of what forces can change: driven and fixed directions are left out */
    double stored;                         /* in springs of contacts */
    double lost_normal, lost_tangential;   /* dissipated in contacts; tangential: by friction and rolling resistance */
    double driven;                         /* put in by prescribed motions and by tilting gravity */
    double balance;
} scree_energy;

/* All zero but kinetic, rotational, potential and stored unless scree_time_def.energy was set. SCREE_BAD_INPUT: the
 * scene isn't baked; SCREE_NO_MEMORY; SCREE_FAILED if numbers don't hold them. */
SCREE_API scree_status scree_scene_energy(scree_scene *scene, scree_energy *energy);

/* A contact that touches now. */
typedef struct scree_contact_state {
    int ball, host; /* bodies: the ball (a sphere or the corner of a box) and its partner */
    int corner;     /* 0 … 7: bits for +x, +y, +z; -1: a sphere; 8 + 12 i + j: edge i of the ball on edge j of
                     * its partner, 4 along each axis, bits for the signs along the two that follow it */
    double point[3], normal[3];       /* m; from the host to the ball, unit length */
    double overlap, closing, slip[3]; /* m, m/s, m/s of the ball against the host */
    double normal_force, friction[3]; /* N, on the ball: along the normal, and across it; */
    double force[3];                  /* N, on the ball, all of it: where edges of boxes, or corners deeper than their
                                       * roundings, bear together, a normal force pushes sideways, too */
    double rolling[3];                /* torque of the rolling law on the ball, N m */
    int sliding;                      /* 1: it slides, by a law with memory; 0: it holds, or the law has none */
} scree_contact_state;

/* Contacts that touch now, at most `capacity` of them into `contacts` (may be NULL); `count` receives how many there
 * are. SCREE_BAD_INPUT: the scene isn't baked; SCREE_NO_MEMORY. */
SCREE_API scree_status scree_scene_contacts(scree_scene *scene, scree_contact_state *contacts, int capacity,
                                            int *count);

/* Largest overlap so far in parts of the tolerable one (half a half-width); the bodies (-1: none), any may be NULL. */
SCREE_API double scree_scene_deepest(const scree_scene *scene, int *ball, int *host);

/* Largest product so far of four times the step (s), the normal force (N), the sum of both inverse masses (1/kg) and
 * the slope (s/m) of a velocity-regularised friction or rolling law: beyond 1 friction overshoots within a step and the
 * sliding velocity chatters about zero. 0 without such laws. The bodies (-1: none), any may be NULL. */
SCREE_API double scree_scene_steepest(const scree_scene *scene, int *ball, int *host);

/* What SCREE_ADAPTIVE has done so far: steps within the scene's own ones, those that were tried in vain, events (touch,
 * end of contact, stick to slip, changes of a law), evaluations of all forces, flights in closed form. Zero with other
 * integrators. */
typedef struct scree_effort {
    long steps, rejected, events, evaluations, flights;
} scree_effort;
SCREE_API scree_effort scree_scene_effort(const scree_scene *scene);

/* 64-bit hash (FNV-1a) of the state: steps, positions, velocities, angular momenta, attitudes, contact memory;
 * with SCREE_PAIR_IMPULSE also the impulses of the last two steps. */
SCREE_API uint64_t scree_scene_hash(const scree_scene *scene);

/* Write the state to a file (`name` for messages), and read it into a baked scene of the same definition, which then
 * goes on as if never interrupted: an automatic step is taken from the state; energy books that the state doesn't hold
 * begin with it. SCREE_NO_FILE, also where `file` is NULL; SCREE_BAD_INPUT for a file of another scene (the message
 * says what differs) or a damaged one (the scene stays as it was); SCREE_NO_MEMORY: it stays so, or has the state and
 * asks for the memory of its lists again in the next step. */
SCREE_API scree_status scree_scene_save(scree_scene *scene, FILE *file, const char *name);
SCREE_API scree_status scree_scene_restore(scree_scene *scene, FILE *file, const char *name);

#ifdef __cplusplus
}
#endif

#endif
