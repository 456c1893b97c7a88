/* Two bodies meet at one point, obliquely and spinning: what the laws of their contact make of it, apart from any
 * scene.
 *
 * Normal and lever arms stay as they are at the first touch (exact in the limit of small overlaps), so that impulse J
 * and relative velocity u of the contact points are tied by one constant matrix, u = u0 + W J, and all that is
 * integrated is
 *   d(overlap)/dt = -u.n,  dJ/dt = F(overlap, u, memory),
 * the memory of friction, and the work done. Laws are used through their descriptions only. Their forces are those of
 * an instant (half = 0); the rate of friction's memory is the difference of what the law's own stepping rule makes of a
 * tiny step and of a tiny step back. A slider that caps a spring has a memory that follows the cap without a rate of
 * its own: there the spring is stretched as if it stuck, the law cuts it, and each step ends by keeping what the law
 * has left. Bristles have their rate (contact/bristle.h).
 *
 * Dormand & Prince's pair of orders 5 and 4 (J. Comput. Appl. Math. 6 (1980) 19) chooses its steps by its error, which
 * also carries it through the roots d^(1/4), d^(1/2) at first touch; steps end where the bodies turn round, stick, slip
 * or part, so that nothing within a step has a kink. An extrapolation of the loop's stepping rule would have needed no
 * rates, but that rule takes a step to notice a slider's turns, which leaves no power series in the step to
 * extrapolate. */
#ifndef SCREE_CONTACT_ENCOUNTER_H
#define SCREE_CONTACT_ENCOUNTER_H

#include "bodies/quat.h"
#include "bodies/shape.h"
#include "contact/catalogue.h"

/* One of the two: how it yields to impulses, and how it moves. World axes. All zero: a body that stays where it is. */
struct scree_partner {
    double inverse_mass;       /* 1/kg */
    struct mat axes;           /* principal axes */
    double inverse_moments[3]; /* about them, 1/(kg m^2) */
    struct vec arm;            /* from the centre to the contact, m */
    struct vec velocity, spin; /* m/s, rad/s */
};

struct scree_encounter {
    struct scree_partner ball, host;
    struct vec normal; /* unit, from the host towards the ball */
    double radius;     /* effective radius for the laws, m (their effective mass is that of the centres) */
    double tolerance;  /* of a step, relative; 0: 1e-12 */
};

/* A moment of the contact. */
struct scree_moment {
    double time;             /* since the first touch, s */
    double overlap, closing; /* m, m/s */
    double force;            /* normal, N */
    struct vec slip;         /* of the ball's contact point against the host's, m/s */
    struct vec friction;     /* on the ball, N */
};

enum scree_ending {
    SCREE_PARTED,
    SCREE_STAYED,    /* still in touch after 300 times the time in which the spring would stop the bodies, or 200 turns
                        round */
    SCREE_UNFINISHED /* the laws change faster than a million steps can follow, or numbers are too large or too small
                        to be followed: only the energy before counts */
};

struct scree_outcome_of_impact {
    enum scree_ending ending;
    double restitution;     /* normal speed of parting over that of meeting, of the contact points; 0 if they stayed */
    double duration;        /* s */
    double deepest, force;  /* largest overlap (m) and normal force (N) */
    double friction;        /* largest friction force, N */
    double energy;          /* kinetic energy of both before, J */
    double lost_normal;     /* work that the normal force took and didn't give back, J */
    double lost_tangential; /* the same for friction */
    struct vec impulse;     /* on the ball, N s */
    struct scree_partner ball, host; /* as they part */
    long steps;
};

typedef void scree_encounter_watch(void *context, const struct scree_moment *moment);

/* A body for an encounter at rest: `towards` points from it to the other (unit). A sphere of radius and mass; a plane
 * of infinite mass; a box by its lowest corner along `towards`, whose rounding is the radius of that corner. `mass` 0:
 * one that can't be moved. */
struct scree_partner scree_partner_of(const scree_shape *shape, double mass, struct quat attitude, struct vec towards);

/* Velocity of the ball's contact point against the host's, m/s. */
struct vec scree_approach(const struct scree_encounter *encounter);

/* Let them meet; they must approach (closing speed > 0) and one of them must be movable. `watch` may be NULL; it is
 * called after each step. Relative error of velocities about 1e-10 at the default tolerance (1e-6 for friction with
 * bristles, which are left at rest below a ten-thousandth of the load). */
struct scree_outcome_of_impact scree_meet(const struct scree_encounter *encounter, const struct scree_rule *rule,
                                          scree_encounter_watch *watch, void *context);

#endif
