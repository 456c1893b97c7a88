/* Characteristic map of a motion: plans at some operating speeds (knots), and profiles at all speeds between them by
 * interpolation. Times count in parts of the transport time T, velocities as v T and accelerations as a T^2 (m), so
 * that equal values mean the same motion in another time. */
#ifndef SCREE_SOLVER_MAP_H
#define SCREE_SOLVER_MAP_H

#include "solver/transport.h"

/* In which variable the weights of the two neighbours are linear. The rigid plan (formulation A) is affine in 1/n^2 for
 * fixed time shares, so that this one is exact for it. */
enum scree_map_weight { SCREE_MAP_INVERSE_SQUARE = 0, SCREE_MAP_INVERSE, SCREE_MAP_LINEAR, SCREE_MAP_WEIGHTS };

/* "1/n^2", "1/n", "n", in the order of scree_map_weight. */
extern const char *const scree_map_names[SCREE_MAP_WEIGHTS];

typedef struct scree_map_knot {
    double cycles;       /* n, 1/min */
    double fractions[3]; /* times of events 1 to 3 over T */
    double v[3], a[3];   /* of the comb at events 1 to 3: v T and a T^2, m */
    double error;        /* largest |error| between this knot and the next, filled by scree_map_place; */
    double at;           /* and the speed where that is, 1/min */
} scree_map_knot;

typedef struct scree_map {
    enum scree_map_weight weight;
    double stroke; /* of the comb, m */
    double share;  /* of the cycle used for transport */
    int count, capacity;
    scree_map_knot *knots; /* the caller's, `capacity` of them; in order of rising speed */
} scree_map;

enum scree_map_state {
    SCREE_MAP_GOOD = 0,
    SCREE_MAP_OUTSIDE,  /* the speed is below the first or above the last knot, or isn't a number: there is no
                           extrapolation */
    SCREE_MAP_EMPTY,    /* no knot */
    SCREE_MAP_FULL,     /* the caller's memory is used up before the bound is met; the map is usable, its error is
                           reported */
    SCREE_MAP_BAD_PLAN, /* a knot has no admissible plan: which and why, the report says */
    SCREE_MAP_BAD_INPUT
};

/* A text for people. */
const char *scree_map_text(enum scree_map_state state);

/* Put a plan's knot in its place; one of the same speed is replaced. The first sets stroke and share of the map. */
enum scree_map_state scree_map_add(scree_map *map, const scree_plan *plan);

/* Blended values at `cycles`. Blending keeps the stroke to rounding as long as both neighbours have the same time
 * shares; else velocities and accelerations are scaled by the missing part, which is of second order in the difference
 * of the shares. */
enum scree_map_state scree_map_blend(const scree_map *map, double cycles, scree_map_knot *blend);

/* The comb's profile at `cycles`. */
enum scree_map_state scree_map_profile(const scree_map *map, double cycles, struct scree_profile *profile);

/* Error of a profile at a speed, in whatever unit the bound has; not finite: worse than any. */
typedef double scree_map_error(void *context, const struct scree_profile *profile, double cycles);

typedef struct scree_map_options {
    double low, high; /* range of speeds, 1/min */
    double bound;     /* on |error|, > 0 */
    int samples;      /* speeds between neighbouring knots at which the error is evaluated, evenly spaced; 0: 3 */
    scree_map_error *error;
    void *context;
} scree_map_options;

typedef struct scree_map_report {
    enum scree_map_state state;
    double error, at; /* largest |error| over all sample speeds, and the speed where */
    int evaluations;  /* calls of the error function */
    scree_plan plan;  /* the last one made: with BAD_PLAN, the one that failed */
} scree_map_report;

/* Fill the map with plans: at both ends of the range, then in the middle of the interval with the largest error, until
 * every |error| at the sample speeds is within the bound. `plan` as for scree_plan_make, at every knot. */
scree_map_report scree_map_place(scree_map *map, const scree_transport *transport, const scree_plan_options *plan,
                                 const scree_map_options *options);

/* Error at a scaled profile's or blended profile's catch for a rigid product, m (see scree_scaled_clearance): an error
 * function whose context is the const scree_transport. */
double scree_map_clearance(void *transport, const struct scree_profile *profile, double cycles);

#endif
