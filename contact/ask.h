/* Asked for and got: the restitution that a law delivers, the parameter that delivers a wanted one, and how far a law's
 * own `restitution` can be trusted. */
#ifndef SCREE_CONTACT_ASK_H
#define SCREE_CONTACT_ASK_H

#include "contact/choice.h"
#include "contact/impact.h"

/* The value >= 0 at which the restitution `e`, which falls with it, takes the value `wanted`: within `tolerance` (of
 * the restitution), or as close as doubles come. `guess` > 0 is where the search begins. NAN if there is none up to
 * 1e60 times as much or as little. */
double scree_ask_falling(double (*e)(void *context, double value), void *context, double wanted, double guess,
                         double tolerance);

/* What is asked of an impact: restitution in (0, 1], m/s, kg (effective), m (effective), tolerance of the
 * restitution. */
struct scree_wish {
    double restitution, speed, mass, radius, tolerance;
};

struct scree_elastic;

/* The value of the parameter `parameter` of a normal law (a damping: the restitution must fall with it) that delivers
 * the wish, all other parameters as in `choice`, which doesn't give this one; `elastic` may be NULL. One to some dozens
 * of impacts are integrated where the law has no closed form. SCREE_BAD_INPUT: the choice is wrong, or no value
 * delivers it. */
scree_status scree_ask(const scree_law_choice *choice, const struct scree_elastic *elastic, const char *parameter,
                       const struct scree_wish *wish, double *value, scree_trouble *trouble);

/* How well a law delivers the restitution it is asked for by its parameter `restitution`, every other parameter at its
 * fallback or 1: of bodies of 1 kg and 1 m (effective) that meet at 1 m/s. */
struct scree_validity {
    int asked;       /* 0: the law has no such parameter, and the rest says nothing */
    double from;     /* the error stays within the tolerance for `restitution` from this on; 0: everywhere */
    double worst;    /* largest error */
    double worst_at; /* where */
};

/* `tolerance`: of the restitution, absolute. */
struct scree_validity scree_validity_of(const struct scree_normal_law *law, double tolerance);

#endif
