/* A contact at one instant, for methods that integrate a whole scene in time and stop where a law changes: what its
 * laws make of positions, velocities and memory there, the rates of its memory, and the switch functions whose zeros
 * end the present phase.
 *
 * Within a phase all of it is smooth: the normal law is used without its cut; approach and parting are told apart by
 * the phase, not by the sign of the speed; a slider either sticks or slips. A slider without a dashpot that slips has
 * no rate of its own: its stretch is that of the force that it slides with, and only its direction is integrated. The
 * same goes for bristles while the load falls too fast for what they bear. */
#ifndef SCREE_CONTACT_GRIP_H
#define SCREE_CONTACT_GRIP_H

#include "contact/contacts.h"

enum scree_grip_state {
    SCREE_GRIP_APART,
    SCREE_GRIP_SPENT, /* overlaps, but the law that never pulls has let go */
    SCREE_GRIP_HELD
};

/* What resists sideways: friction, rolling, twisting. */
enum { SCREE_GRIP_FRICTION, SCREE_GRIP_ROLLING, SCREE_GRIP_TWISTING, SCREE_GRIP_WAYS };

/* What rounding may change to and fro: each way, whether it slips; and whether the slip grows. */
enum { SCREE_GRIP_GROWTH = SCREE_GRIP_WAYS, SCREE_GRIP_CHANGES };

/* Numbers of memory that are integrated: three for each way. */
enum { SCREE_GRIP_MEMORY = 3 * SCREE_GRIP_WAYS };

struct scree_grip {
    int batch, index;
    struct scree_contact contact;
    enum scree_geometry geometry;
    const struct scree_rule *rule;
    const struct scree_normal_law *normal;
    const struct scree_friction_law *friction; /* NULL: none */
    const struct scree_rolling_law *rolling;   /* NULL: none */
    struct scree_pair_constants of_normal, of_friction;
    double lever, mass, reach; /* of rolling, m; effective, kg; of the normal law, m */
    int turns;                 /* the contact can turn its bodies */
    int directional;           /* the normal law tells approach from parting */
    int by_speed;              /* it lets go at a speed, whatever the overlap */
    int root;                  /* forces set in like this root of the overlap (2, 4); 1: smoothly */
    int end_root;              /* the same where they end, at an overlap of -reach */
    /* The phase. */
    enum scree_grip_state state;
    int approaching, pulling;
    int advancing; /* what the normal law remembers is being renewed */
    int fresh;     /* whether it is hasn't been looked at since the contact began */
    int inside;    /* friction's slider is slower than where its hold jumps */
    int recedes;   /* its slip grows, where that is watched */
    int slips[SCREE_GRIP_WAYS];
    int wary[SCREE_GRIP_CHANGES];     /* steps for which it stays as it is: it has just changed twice at once */
    double since[SCREE_GRIP_CHANGES]; /* time of its last change, s */
    double first, second;
    /* Scales: overlap, speed, force; the longest stretch with which a way has slipped. */
    double depth, speed, load, longest[SCREE_GRIP_WAYS];
};

struct scree_grip_view {
    struct vec normal, arm, host_arm, slip;
    double overlap, closing;
    double force;                                                /* normal as it acts, N */
    double whole, damping;                                       /* the law's without its cut, N; its dashpot, N s/m */
    struct vec push;                                             /* on the ball, N */
    struct vec torque;                                           /* on the ball, of the rolling law, N m */
    double rubbing;                                              /* power taken sideways, W */
    struct vec velocity[SCREE_GRIP_WAYS], rate[SCREE_GRIP_WAYS]; /* of each way; of its memory */
    struct vec elastic[SCREE_GRIP_WAYS];                         /* force of its spring, N */
    double grows[SCREE_GRIP_WAYS]; /* N/s: how fast that would grow where it slips without a dashpot */
    double stiffness[SCREE_GRIP_WAYS], damping_of[SCREE_GRIP_WAYS], holds[SCREE_GRIP_WAYS], slides[SCREE_GRIP_WAYS];
};

/* Set up contact `index` of batch `batch`, apart, with nothing remembered. */
void scree_grip_make(struct scree_grip *grip, const struct scree_contacts *contacts, const struct scree_bodies *bodies,
                     int batch, int index);

/* Whether a way is a slider behind a spring; and whether it may slip, as these and bristles do. */
int scree_grip_is_slider(const struct scree_grip *grip, int way);
int scree_grip_may_slip(const struct scree_grip *grip, int way);

/* Force per unit of a way's memory at an overlap, N/m; 1 where the force itself is kept, 0 where nothing is. */
double scree_grip_stiffness(const struct scree_grip *grip, int way, double overlap);

/* Force with which a slider slips under a load, N. */
double scree_grip_slides(const struct scree_grip *grip, int way, double load);

/* Where the ball is on its partner, as the records have it: fills normal, arms, overlap, closing and slip. `overlap`
 * replaces the overlap unless it is NAN. */
void scree_grip_meet(const struct scree_grip *grip, const struct scree_bodies *bodies, double overlap,
                     struct scree_grip_view *view);

/* Size of the numbers whose difference the overlap is, m: it is rounded as they are. */
double scree_grip_size(const struct scree_grip *grip, const struct scree_bodies *bodies);

/* The forces of a contact that has met its partner, and the rates of its memory. */
void scree_grip_press(const struct scree_grip *grip, const struct scree_bodies *bodies, const double *memory,
                      struct scree_grip_view *view);

/* What the normal law would remember as `first` of this instant alone. */
double scree_grip_peak(const struct scree_grip *grip, const struct scree_grip_view *view);

/* Phase and memory from what the contact has kept (SCREE_MEMORY numbers, NULL if it keeps nothing), and back. */
void scree_grip_recall(struct scree_grip *grip, const struct scree_grip_view *view, const double *kept, double *memory);
void scree_grip_keep(const struct scree_grip *grip, const struct scree_grip_view *view, const double *memory,
                     double *kept);

/* ---- switch functions: positive while the phase lasts ---- */

enum scree_switch {
    SCREE_SWITCH_OVERLAP, /* touch, or the end at the end of the overlap */
    SCREE_SWITCH_FORCE,   /* a law that is cut lets go, or takes hold again */
    SCREE_SWITCH_TURN,    /* approach becomes parting, or the other way round */
    SCREE_SWITCH_PULL,    /* a law that may pull does, or pushes again: friction begins and ends there */
    SCREE_SWITCH_PEAK,    /* what the normal law remembers stops growing, or grows again */
    SCREE_SWITCH_BAND,    /* friction's slider passes the speed at which its hold jumps */
    SCREE_SWITCH_NEAREST, /* beyond, and of bristles, the slip is as slow or as fast as it gets: nothing changes, but a
                             step ends there, for it may pass through the band and out again within one, or turn */
    SCREE_SWITCH_SLIDE,   /* one for each way: sticks or slips */
    SCREE_SWITCHES = SCREE_SWITCH_SLIDE + SCREE_GRIP_WAYS
};

/* Whether some switch function is the derivative of something, so that `scree_grip_switches` needs views before and
 * after. */
int scree_grip_needs_rates(const struct scree_grip *grip);

/* The values of all switch functions, +1 where there is none, each in parts of its own scale. `sooner` and `later` are
 * views of the time `apart` before and after each other along the motion, NULL where they aren't needed. */
void scree_grip_switches(const struct scree_grip *grip, const struct scree_grip_view *view,
                         const struct scree_grip_view *sooner, const struct scree_grip_view *later, double apart,
                         double values[SCREE_SWITCHES]);

/* Enter the phase behind a switch function that has come to zero. */
void scree_grip_switch(struct scree_grip *grip, enum scree_switch which, const struct scree_grip_view *view,
                       double *memory);

/* Whether what is remembered, and the slip, grow now: after a switch, and at the start. */
void scree_grip_set_advancing(struct scree_grip *grip, const struct scree_grip_view *sooner,
                              const struct scree_grip_view *later);

/* At the end of a step: remember; and a spring that slips under no load is one that has just begun to. */
void scree_grip_settle(struct scree_grip *grip, const struct scree_grip_view *view, double *memory);

/* Names the law that this file can't follow in time, with the reason; NULL if all can be. */
const char *scree_grip_refuses(const struct scree_rule *rule);

#endif
