/* What the no-slip laws of Mindlin share: parameters, constants, stiffness and damping.
 *
 *   k_t = 8 G* a,  a = sqrt(R d) the radius of the contact,  1/G* = (2 - nu1)/G1 + (2 - nu2)/G2
 *   c_t = 2 zeta sqrt(m k_t)
 *
 * k_t: R. D. Mindlin, "Compliance of elastic bodies in contact", J. Appl. Mech. 16 (1949) 259, no slip, constant load;
 * c_t: as in the damping of Tsuji, Tanaka & Ishida, Powder Technol. 71 (1992) 239. "No slip" says that the micro-slip
 * at the border of the contact (Mindlin & Deresiewicz 1953) is left out: the contact sticks as a whole or slides as a
 * whole. m is the effective mass of the pair, R its effective radius. */
#ifndef SCREE_CONTACT_MINDLIN_H
#define SCREE_CONTACT_MINDLIN_H

#include "contact/law.h"

enum { MINDLIN_STATIC, MINDLIN_KINETIC, MINDLIN_SHEAR, MINDLIN_ZETA };
enum { MINDLIN_SPRING, MINDLIN_DASHPOT }; /* pair constants: K = 8 G* sqrt(R); 2 zeta sqrt(m K) */

static const struct scree_parameter mindlin_parameters[] = {
    {.name = "static", .unit = "1", .meaning = "coefficient mu_s while sticking", .range = SCREE_NOT_NEGATIVE},
    {.name = "kinetic", .unit = "1", .meaning = "coefficient mu_k while sliding", .range = SCREE_NOT_NEGATIVE},
    {.name = "shear_modulus",
     .unit = "Pa",
     .meaning = "effective G* of the two materials",
     .range = SCREE_ANY_POSITIVE,
     .material = SCREE_FROM_SHEAR,
     .shared = 1},
    {.name = "damping",
     .unit = "1",
     .meaning = "damping ratio zeta of a dashpot beside the spring",
     .range = SCREE_NOT_NEGATIVE,
     .optional = 1,
     .fallback = 0.0},
    {0}};

static inline scree_status mindlin_bake(const struct scree_values *values, struct scree_law_constants *law,
                                        scree_trouble *trouble) {
    for (int k = 0; k < 4; k++) law->c[k] = values->v[k];
    return scree_check_static(law->c[MINDLIN_STATIC], law->c[MINDLIN_KINETIC], trouble);
}

static inline struct scree_pair_constants mindlin_pair(const struct scree_law_constants *law, double mass,
                                                       double radius) {
    double spring = 8.0 * law->c[MINDLIN_SHEAR] * sqrt(radius);
    return (struct scree_pair_constants){{spring, 2.0 * law->c[MINDLIN_ZETA] * sqrt(mass * spring)}};
}

/* Never zero, so that it can divide, and large enough for the squares of its forces: 1e-100 N/m are no stiffness.
 * `root`: of the overlap. */
static SCREE_INLINE double mindlin_spring(struct scree_pair_constants pair, double root) {
    return pair.c[MINDLIN_SPRING] * root + 1e-100;
}

/* 2 zeta sqrt(m k_t); the fourth root of the overlap is one that Tsuji's dashpot takes too. */
static SCREE_INLINE double mindlin_dashpot(struct scree_pair_constants pair, double fourth_root) {
    return pair.c[MINDLIN_DASHPOT] * fourth_root;
}

static inline double mindlin_stiffness(const struct scree_law_constants *law, struct scree_pair_constants pair,
                                       double overlap) {
    (void)law;
    return mindlin_spring(pair, sqrt(overlap > 0.0 ? overlap : 0.0));
}

static inline double mindlin_damping(const struct scree_law_constants *law, struct scree_pair_constants pair,
                                     double overlap) {
    (void)law;
    return mindlin_dashpot(pair, sqrt(sqrt(overlap > 0.0 ? overlap : 0.0)));
}

static inline struct scree_hold mindlin_hold(const struct scree_law_constants *law, struct scree_sliding at) {
    double kinetic = law->c[MINDLIN_KINETIC] * at.normal;
    return (struct scree_hold){at.sliding > 0.0 ? kinetic : law->c[MINDLIN_STATIC] * at.normal, kinetic};
}

#endif
