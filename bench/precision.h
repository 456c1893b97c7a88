/* The cases of scree-bench precision: what happens, for how long, what is looked at and what is right. */
#ifndef SCREE_BENCH_PRECISION_H
#define SCREE_BENCH_PRECISION_H

#include "bench/bench.h"

enum { PRECISION_NUMBERS = 3000 };

/* Numbers are in parts of what they are errors of (an impact speed, a path), so that they have no unit. */
struct precision_case {
    const char *name;
    const char *scene;                                /* TOML; NULL: `make`, and without that `file` */
    const char *file;                                 /* of the data folder */
    char *(*make)(const struct precision_case *self); /* TOML to be freed */
    double duration;     /* of a contact (of a turn, where nothing touches), s: what steps are counted in */
    double time;         /* of the event, s */
    int timed;           /* the numbers change with time: a whole number of steps must make it up */
    const char *arrives; /* path of the body whose place makes phases of first touch, "body.1"; NULL: steps alone */
    double touch[3];     /* where it touches, m */
    double velocity[3];  /* with which velocity, m/s */
    int phases;          /* most that are worth the time; 0: any */
    int many;            /* --many takes it: a ball of 10 mm on a plane, last but for the laws */
    double fine;         /* steps per contact of the reference, where that is a run; 0: 5000 */
    int numbers;         /* that are compared, at most PRECISION_NUMBERS */
    void (*look)(const struct precision_case *self, const scree_scene *scene, double *numbers);
    const double *right; /* the right numbers; NULL: `solve`, and without that a fine run */
    void (*solve)(const struct precision_case *self, double *numbers);
    const void *of; /* whatever make, look and solve need to know */
};

extern const struct precision_case precision_cases[];
extern const int precision_case_count;

/* A sphere set on a slope `alpha` (rad) with `speed` (m/s) down it, without spin, on the overlap of its weight: spring
 * k (N/m) and sliding limit mu; friction is a spring k_t with that limit. */
struct precision_ball {
    double radius, mass, gravity, alpha, k, k_t, mu, speed, time;
};

/* Its way (m), velocity (m/s) and velocity of rolling (spin times radius, m/s) after `time`: exact. */
void precision_roll(const struct precision_ball *ball, double numbers[3]);

/* Height above touch (m) and velocity (m/s), at `time`, of a ball that falls with `speed` from touch on a spring of
 * stiffness k that may pull, damping ratio zeta; returns the bounces until then. Exact but for the roots, found to
 * rounding. */
int precision_bounce(double mass, double gravity, double k, double zeta, double speed, double time, double numbers[2]);

#endif
