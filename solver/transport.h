/* Planning the new motion of a comb: it pushes a product, brakes away from it on purpose, lets it slide, and catches it
 * with its front tines without impact. Events: 0 start (rest), 1 end of push, 2 velocity minimum of the comb, 3 catch,
 * 4 rest.
 *
 * Everything is stated in the frame of the surfaces, x = 0 where comb and product start. The comb's stroke is the
 * transport distance less the play; the product slides under Coulomb friction. Troll et al., Adv. Mech. Eng. (2018),
 * doi 10.1177/1687814018754953. */
#ifndef SCREE_SOLVER_TRANSPORT_H
#define SCREE_SOLVER_TRANSPORT_H

#include "solver/lm.h"
#include "solver/profile.h"

/* The task. SI units. */
typedef struct scree_transport {
    double distance;     /* transport distance s_P of the product, m */
    double gap;          /* clear distance G between rear and front tines, m */
    double width;        /* of the product along x, m; less than the gap */
    double friction;     /* kinetic coefficient mu_k between product and surface */
    double gravity;      /* m/s^2 */
    double share;        /* r: part of the cycle that is used for transport, 0 … 1 */
    double fractions[3]; /* times of events 1, 2, 3 in parts of the transport time, increasing, inside 0 … 1 */
    double largest_acceleration, largest_jerk; /* of the drive; 0: no limit */
} scree_transport;

/* Play: how far the product can move between the tines. */
static inline double scree_transport_play(const scree_transport *t) { return t->gap - t->width; }

/* Transport time at n cycles a minute, s. */
static inline double scree_transport_time(const scree_transport *t, double cycles) { return 60.0 * t->share / cycles; }

/* Deceleration of the sliding product, m/s^2. */
static inline double scree_transport_slowing(const scree_transport *t) { return t->friction * t->gravity; }

enum scree_plan_state {
    SCREE_PLAN_GOOD = 0,
    SCREE_PLAN_BAD_TASK,      /* numbers that make no sense: which, the text says */
    SCREE_PLAN_NO_DETACHMENT, /* the comb never brakes harder than friction: too slow an operating speed for these time
                                 shares */
    SCREE_PLAN_EARLY_DETACHMENT,  /* the comb brakes harder than friction before event 1 */
    SCREE_PLAN_EARLY_CONTACT,     /* the product meets a tine again before event 3 */
    SCREE_PLAN_SECOND_SEPARATION, /* after the catch the comb brakes too softly, well before it rests: the product
                                     leaves the front tine */
    SCREE_PLAN_BACKWARDS,         /* the comb would have to move backwards during the transport */
    SCREE_PLAN_ACCELERATION,      /* beyond the drive's acceleration */
    SCREE_PLAN_JERK,              /* beyond the drive's jerk */
    SCREE_PLAN_NO_SOLUTION,       /* the least-squares solver found none: the text says why */
    SCREE_PLAN_MODEL_FAILED       /* the process model couldn't be evaluated */
};

/* "good", "no detachment", … */
const char *scree_plan_state_name(enum scree_plan_state state);

/* A planned motion. */
typedef struct scree_plan {
    enum scree_plan_state state;
    char text[600];                   /* what is wrong, "" if nothing */
    double cycles, duration;          /* 1/min, s */
    double time[5];                   /* of the events, s */
    struct scree_kinematics event[5]; /* of the comb at the events */
    struct scree_profile profile;     /* of the comb */
    double detached;                  /* time at which the product leaves the rear tines, s */
    double detached_velocity;         /* m/s */
    struct scree_extrema extrema;
    scree_lm_outcome solver; /* of formulations B and C */
    int simulations;         /* calls of the process model (C) */
} scree_plan;

/* How the plan is made.
 *   A  rigid product, detachment at event 1; linear for given time shares
 *   B  rigid product, detachment where the comb's deceleration first exceeds friction
 *   C  process model in the loop: residuals from a simulation up to event 3, front tines off */
enum scree_formulation { SCREE_PLAN_A, SCREE_PLAN_B, SCREE_PLAN_C };

/* What the process model tells of the catch, at event 3 with the front tines off. */
typedef struct scree_catch {
    double clearance;    /* between product and front tines, m; negative: they would overlap */
    double velocity;     /* of the product, m/s */
    double acceleration; /* of the product, m/s^2 */
    char cause[400];     /* why it couldn't tell; "" if it did, or doesn't say */
} scree_catch;

/* The process model: simulate the comb's `profile` up to time `until`. Nonzero: it couldn't; `cause` may say why. */
typedef int scree_process(void *context, const struct scree_profile *profile, double until, scree_catch *result);

typedef struct scree_plan_options {
    enum scree_formulation formulation;
    scree_process *process; /* C only */
    void *context;
    double clearance;    /* C: largest residual clearance, m; 0: 1e-7 */
    const double *guess; /* v1, v2, v3, a3 to start from (B, C); NULL: A, then B */
    int iterations;      /* C: most simulations; 0: 60 */
    int (*callback)(void *context, const scree_lm_progress *progress); /* after each iteration; nonzero stops */
    void *callback_context;
} scree_plan_options;

/* Plan for one operating speed. The outcome is in `plan->state`. */
void scree_plan_make(const scree_transport *transport, double cycles, const scree_plan_options *options,
                     scree_plan *plan);

/* The comb's profile from the velocities at events 1 to 3 and the accelerations there. */
struct scree_profile scree_plan_profile(const double time[5], const double v[3], const double a[3]);

/* Admissibility of a plan for a rigid product; sets state and text, unless they tell of a failure already. */
void scree_plan_check(const scree_transport *transport, scree_plan *plan);

/* Velocities and accelerations of formulation A (v1, v2, v3; all accelerations follow from friction). 0, or 1 if the
 * task makes no sense. For quarter shares: v1 = 4 s/(3 T) + mu g T/4, v3 = 4 s/(3 T) - mu g T/4, v2 = 4 (s/3 -
 * play)/T. */
int scree_plan_rigid(const scree_transport *transport, double cycles, double v[3]);

/* Formulation A as nine equations for nine unknowns (v, a at events 1 to 3; times 1 to 3), by least squares: checks the
 * closed form and takes other rules for the times. Returns the solver's outcome; the plan receives the profile. */
scree_lm_outcome scree_plan_nine(const scree_transport *transport, double cycles, scree_plan *plan);

/* What to minimise over the time shares. */
enum scree_shares_rule { SCREE_LEAST_ACCELERATION, SCREE_LEAST_JERK, SCREE_LEAST_CATCH };

/* Cost of a plan for scree_plan_shares: HUGE_VAL where it isn't admissible. */
typedef double scree_plan_cost(void *context, const scree_plan *plan);

/* Change transport->fractions so that the cost of the plan is least (simplex search of Nelder & Mead 1965; a local
 * minimum, from shares whose plan is admissible or nearly so: where no plan is near, the shares stay about what they
 * were). `cost`, if it is given, counts instead of the rule; SCREE_LEAST_CATCH needs it (what the catch costs, by
 * simulation). `plan` receives the plan; SCREE_PLAN_BAD_TASK without that. */
void scree_plan_shares(scree_transport *transport, double cycles, const scree_plan_options *options,
                       enum scree_shares_rule rule, scree_plan_cost *cost, void *context, scree_plan *plan);

/* ---- operating speeds ---- */

/* Profile designed for one speed and scaled to another: clearance at event 3 for a rigid product, m (positive: the
 * product is late); HUGE_VAL if the product doesn't leave the rear tines before. About mu g (L^2 - L_d^2)/2 with L the
 * time between events 1 and 3, as if the product always left at event 1; a slower profile loses it later, and a faster
 * one before. */
double scree_scaled_clearance(const scree_transport *transport, const scree_plan *design, double cycles);

/* The design's plan, scaled to another speed and checked there. */
void scree_plan_scaled(const scree_transport *transport, const scree_plan *design, double cycles, scree_plan *plan);

/* A rigid product under a profile of a comb that doesn't move backwards. First time at which the comb brakes harder
 * than `deceleration` (> 0, m/s^2), so that the product leaves the rear tines; negative if it never does. */
double scree_slide_detachment(const struct scree_profile *profile, double deceleration);

/* First time, not before `from`, at which it brakes softer than that, so that a caught product leaves the front tines;
 * negative if it never does. */
double scree_slide_release(const struct scree_profile *profile, double deceleration, double from);

/* What a product that leaves at `left` has at `until`, if nothing is in its way and it still moves then. */
scree_catch scree_slide_catch(const scree_transport *transport, const struct scree_profile *profile, double left,
                              double until);

/* First time between `left` and `until` at which that product is outside of the play by more than `slack` (m); negative
 * if never. */
double scree_slide_leaves(const scree_transport *transport, const struct scree_profile *profile, double left,
                          double until, double slack);

/* The whole motion until the product rests, with tines that act as plastic (`restitution` 0) to elastic (1) stops. */
typedef struct scree_slide {
    double error;         /* final position beyond the target, m */
    double first_contact; /* relative speed at the first meeting with the front tines, m/s; 0 if there is none */
    int detached;         /* the product left the rear tines */
    int impacts;          /* meetings with tines, the small last ones of a bouncing product too */
    int unfinished;       /* given up after 20000 events: a restitution of nearly 1 */
} scree_slide;
scree_slide scree_slide_simulate(const scree_transport *transport, const struct scree_profile *profile,
                                 double restitution);

/* The same for a product that rests at first, `lead` (0 … play, m) before the rear tines. */
scree_slide scree_slide_from(const scree_transport *transport, const struct scree_profile *profile, double restitution,
                             double lead);

/* Limits of the new motion, cycles a minute. A scaled profile loses its product only above n_det: */
double scree_limit_detachment(const scree_transport *transport, const scree_plan *design);
/* a freshly planned one (formulation A) keeps it caught only above n_low = 60 r sqrt(0.3 mu g/s_P) (quarter shares): */
double scree_limit_low(const scree_transport *transport);
/* and the drive's limits are met at this speed between low and high (HUGE_VAL: they aren't; `low`: already there). */
double scree_limit_drive(const scree_transport *transport, double low, double high);

/* Range of speeds around the design in which the scaled profile's error stays within `tolerance` (m). */
void scree_limit_range(const scree_transport *transport, const scree_plan *design, double restitution, double tolerance,
                       double *least, double *most);

#endif
