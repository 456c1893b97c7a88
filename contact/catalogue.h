/* The law catalogue: every law by name, and the reading of a user's choice. */
#ifndef SCREE_CONTACT_CATALOGUE_H
#define SCREE_CONTACT_CATALOGUE_H

#include "contact/choice.h"
#include "contact/law.h"

/* Laws in the order of the lists in contact/meson.build; NULL at the end. */
extern const struct scree_normal_law *const scree_normal_laws[];
extern const struct scree_friction_law *const scree_friction_laws[];
extern const struct scree_rolling_law *const scree_rolling_laws[];

/* The laws of one pair of materials, ready for use. */
struct scree_rule {
    int material[2];
    int touches;  /* 0: the materials pass through each other */
    int normal;   /* index in scree_normal_laws */
    int friction; /* index in scree_friction_laws, -1 for none */
    int rolling;  /* index in scree_rolling_laws, -1 for none */
    int corners;  /* no edges on edges */
    double share; /* contacts that share one load */
    struct scree_law_constants normal_constants, friction_constants, rolling_constants;
};

/* Free what a rule owns (its force table). */
void scree_free_rule(struct scree_rule *rule);

/* Index of the law called `name`, -1 if there is none. */
int scree_find_normal_law(const char *name);
int scree_find_friction_law(const char *name);
int scree_find_rolling_law(const char *name);

/* What the two materials of a contact are made of: effective moduli, Pa; 0 where they don't say. */
struct scree_elastic {
    double modulus, shear;
};

/* Effective moduli of two materials by Young's moduli (Pa; HUGE_VAL: rigid; 0: unknown) and Poisson's ratios. */
struct scree_elastic scree_elastic_of(const double young[2], const double poisson[2]);

/* Turn a definition into a rule, to be freed with scree_free_rule; `elastic` may be NULL. SCREE_BAD_INPUT names the
 * law, the parameter and its range: unknown law or parameter, one missing, out of its range, or two that contradict
 * each other. */
scree_status scree_bake_rule(const scree_contact_def *def, const struct scree_elastic *elastic, struct scree_rule *rule,
                             scree_trouble *trouble);

/* The example of a law's description as a choice of that law (the process must write numbers as the C locale does). The
 * names are the description's own. */
scree_law_choice scree_example(const struct scree_law_text *text);

/* "> 0", ">= 0" and so on, for people. */
const char *scree_range_text(enum scree_range range);

/* Speed at which a friction law without memory balances a tangential load, given as load/normal force: the creep speed
 * of a body that should rest, m/s. 0 for laws that stick, HUGE_VAL if the law can't hold that load. */
double scree_creep_speed(const struct scree_friction_law *law, const struct scree_law_constants *constants,
                         double load_over_normal);

/* The coefficient at its first top as speed rises: the largest load/normal force that such a law holds at a creep. A
 * viscous part that has no top counts up to 1e4 times the speed at which the ramp would reach 1. */
double scree_largest_coefficient(const struct scree_friction_law *law, const struct scree_law_constants *constants);

#endif
