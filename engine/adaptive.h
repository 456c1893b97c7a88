/* The integrator for small scenes: the whole scene as one system of differential equations, integrated with Dormand &
 * Prince's method of order 8 (dop853.h) to a tolerance, and stopped wherever a law changes.
 *
 *   course.c    the course of a step of the scene
 *   adaptive.c  unknowns, rates, contacts
 *   misfit.c    the size of an error
 *   events.c    what ends a step early: switch functions (contact/grip.h), located on the step; clocks of pairs
 *   flight.c    nothing touches: straight to the next possible touch
 *
 * A step of the scene (scene->step, the time between rows of output) begins and ends with bodies and contact memory as
 * every other integrator leaves them, and phases are made anew from these; beside them only the length of the next step
 * is kept. So a run that was saved and resumed goes on with the same bits. Unknowns are, for each body that moves,
 * position, velocity, angular momentum and attitude; for each contact its memory; and the sums of the energy books,
 * which have no say in the steps. */
#ifndef SCREE_ENGINE_ADAPTIVE_H
#define SCREE_ENGINE_ADAPTIVE_H

#include "contact/grip.h"
#include "engine/dop853.h"
#include "engine/scene.h"

/* The first unknowns; then come the bodies', then the contacts'. */
enum { Y_TIME, Y_CLOCK, Y_WORK, Y_RUBBED, Y_DRIVEN, Y_BODIES }; /* the energy books (J) are measured by one error */

/* Numbers of a body: position, velocity, angular momentum, attitude. */
enum { OF_X = 0, OF_V = 3, OF_L = 6, OF_Q = 9, BALL_SIZE = 9, GENERAL_SIZE = 13 };

/* How the error of a body is measured. */
struct scree_measure {
    double speed; /* m/s */
    double pace;  /* m/s: errors of velocity are relative to it */
    double push;  /* m/s^2: accelerations of all contacts and gravity, added up regardless of their directions */
    double noise; /* 1/s: rounding of positions makes this times the step of noise in the velocity, over eps m */
};

struct scree_adaptive {
    struct scree_dop853 work;
    double *unknowns;    /* owns the three arrays below */
    double *y;           /* unknowns at the start of a step */
    double *arrived;     /* unknowns at its end */
    double *next;        /* rates there */
    double *begun;       /* unknowns of the bodies at the start of the scene's step */
    int *at;             /* first unknown of each body, -1 where nothing can change */
    int *place;          /* of each contact's memory in y */
    int nowhere;         /* zeros in y: the memory of contacts that are apart or have none */
    double *closing;     /* of each contact at the start of the step */
    int *due;            /* of each contact, switches whose time has come */
    int *held;           /* for each body, whether it touches something */
    double *spin_energy; /* of each body while nothing touches it, J; -1: not looked at yet */
    struct scree_measure *measure;
    int grips, grip_capacity;           /* contacts of the list; room for them */
    struct scree_grip *grip, *old_grip; /* those; and those that touched before the list was made anew */
    /* What they are like: at y; a little before and behind; in the middle of the step tried. */
    struct scree_grip_view *view, *sooner, *later, *halfway;
    /* Switch functions at the end of that step, and at its start. */
    double (*value)[SCREE_SWITCHES], (*before)[SCREE_SWITCHES];
    double start;           /* time at y[Y_TIME] = 0, s */
    double earliest, limit; /* motions are looked at between these times: between two of their breaks */
    int clock, root;        /* the contact whose overlap is the clock, -1: time itself; d = s^root - offset */
    int parting;            /* it runs towards zero */
    int banned;             /* no clocks for now: time has to end the step */
    double offset, goal;    /* value of s at which that clock stops */
    int every;              /* rates also look at contacts that are apart */
    int worst;              /* body with the largest error of the last step */
    int stalled;            /* events one after the other at one instant */
    double tick;            /* length of the next step by the clock, in its unit */
};

/* How many unknowns the memory of a contact takes. */
static inline int scree_adaptive_memory_size(const struct scree_grip *grip) {
    return (grip->friction && grip->friction->memory) || (grip->rolling && grip->rolling->memory) ? SCREE_GRIP_MEMORY
                                                                                                  : 0;
}

/* Where the contact's memory is. */
static inline double *scree_adaptive_memory(struct scree_adaptive *a, int grip) { return a->y + a->place[grip]; }

/* ---- adaptive.c ---- */

/* Rates at y (a scree_dop853_rates on the scene); fills the views of contacts. */
void scree_adaptive_rates(void *context, const double *y, double *rates);

/* Bodies and records at y. */
void scree_adaptive_place(struct scree_scene *scene, const double *y);

/* Make the list of contacts anew at y; phases and memory of contacts stay. */
scree_status scree_adaptive_list(struct scree_scene *scene);

/* A place in y for the memory of a contact that begins. */
void scree_adaptive_claim(struct scree_adaptive *a, int grip);

/* Everything anew from bodies and kept memory, at the start of a step of the scene; the bodies back to that start; and
 * contact memory back, from the views. */
scree_status scree_adaptive_begin_step(struct scree_scene *scene);
void scree_adaptive_go_back(struct scree_scene *scene);
void scree_adaptive_keep(struct scree_scene *scene);

/* Set what errors of the coming step are measured by, from the views of its start. */
void scree_adaptive_measure(struct scree_scene *scene);

/* The error of the step that was just tried, in parts of what is tolerable. */
double scree_adaptive_error(struct scree_scene *scene, double time);

/* ---- course.c ---- */

/* Integrate attitudes alone, for so many seconds in which nothing touches; nonzero, and reported, if that can't be
 * done. */
int scree_adaptive_turn(struct scree_scene *scene, double time);

/* ---- events.c ---- */

/* Switch functions at y, whose rates and views are those of `rates`, into `value`. */
void scree_adaptive_switches(struct scree_scene *scene, const double *y, const double *rates,
                             double (*value)[SCREE_SWITCHES]);

/* Begin what touches at y and closes in. Returns how many. */
int scree_adaptive_begin(struct scree_scene *scene);

/* Where a slider that sticks, or slips, at both ends of the step of length h that was just tried, or a contact that
 * lasts, may have done otherwise in between, in the variable of the step since its start: where the parabola of its
 * switch function through both ends and the middle of a cubic is least, if that is near zero; and where a law that has
 * let go changes its formula. 0: nowhere. One evaluation, where something slips three. */
double scree_adaptive_doubt(struct scree_scene *scene, double h);

/* The change of a phase that comes first: of which contact (-1: of none), by which of its switch functions. */
struct scree_event {
    int grip, which;
};

/* The first change in the step of length h that was just tried, and of what is due to change with it. If there is one,
 * the step is repeated up to there; *h becomes the length, 0: it is at the start. */
struct scree_event scree_adaptive_event(struct scree_scene *scene, double *h);

/* Make the change that the step led to. */
void scree_adaptive_change(struct scree_scene *scene, struct scree_event event);

/* Choose the clock of the next step: 1 if it has changed. `left`: s until the step must end. */
int scree_adaptive_clock(struct scree_scene *scene, double left);

/* ---- flight.c ---- */

/* Whether scenes like this one can be advanced in closed form while nothing touches. */
int scree_adaptive_can_fly(const struct scree_scene *scene);

/* A time in which nothing can touch, at most `most`, s. */
double scree_adaptive_safe_time(const struct scree_scene *scene, double most);

/* Let y fly for so long; nonzero if that can't be done. */
int scree_adaptive_fly(struct scree_scene *scene, double time);

#endif
