/* Prescribed motions: one coordinate (m or rad) as a function of time, with its velocity and acceleration. */
#ifndef SCREE_BODIES_MOTION_H
#define SCREE_BODIES_MOTION_H

#include "bodies/trouble.h"

#include <stddef.h>

typedef enum scree_motion_kind {
    SCREE_MOTION_VELOCITY = 0, /* constant velocity */
    SCREE_MOTION_RISE,         /* from rest to rest over a stroke, then dwell */
    SCREE_MOTION_SINE,         /* amplitude sin(2 pi frequency (t - start) + phase) */
    SCREE_MOTION_TABLE         /* through given points */
} scree_motion_kind;

typedef enum scree_rise_law {
    SCREE_RISE_QUINTIC = 0, /* 10 u^3 - 15 u^4 + 6 u^5: no jump in velocity or acceleration */
    SCREE_RISE_CYCLOID      /* u - sin(2 pi u)/(2 pi): harmonic acceleration */
} scree_rise_law;

typedef enum scree_table_law {
    SCREE_TABLE_LINEAR = 0,      /* straight between the points: the velocity jumps there */
    SCREE_TABLE_SPLINE,          /* natural cubic spline: acceleration without jumps, zero at both ends */
    SCREE_TABLE_CUBIC,           /* cubic pieces through position and velocity */
    SCREE_TABLE_QUINTIC,         /* quintic pieces through position, velocity and acceleration */
    SCREE_TABLE_VELOCITY_QUINTIC /* velocity in quintic pieces through velocity, acceleration and jerk; the positions
                                    must be its integral */
} scree_table_law;

/* A motion rests where it begins (at `offset`; SINE: where its phase says; TABLE: at its first row) until `start`
 * (TABLE: until the time of that row); after its end it keeps its last position. Angles count in rad, lengths in m. The
 * arrays of a table are copied by scree_scene_add_motion. */
typedef struct scree_motion_def {
    const char *name; /* unique, not empty, at most 255 bytes; copied */
    scree_motion_kind kind;
    double offset;               /* m or rad; every kind but TABLE adds it */
    double start;                /* s */
    double duration;             /* s; VELOCITY and SINE: 0 means for ever; RISE: > 0 */
    double velocity;             /* VELOCITY: 1/s of the coordinate's unit */
    double stroke;               /* RISE: m or rad */
    scree_rise_law rise;         /* RISE */
    double amplitude;            /* SINE: m or rad */
    double frequency;            /* SINE: Hz, > 0 */
    double phase;                /* SINE: rad */
    scree_table_law table;       /* TABLE: which of the columns below count */
    size_t rows;                 /* TABLE: >= 2 */
    const double *times;         /* TABLE: s, strictly increasing */
    const double *positions;     /* TABLE: m or rad; here and below `rows` entries */
    const double *velocities;    /* TABLE: CUBIC and the quintics, 1/s of that */
    const double *accelerations; /* TABLE: both quintics, 1/s^2 of that */
    const double *jerks;         /* TABLE: VELOCITY_QUINTIC, 1/s^3 of that */
} scree_motion_def;

/* ---- inside the library and its programs; the shared library keeps these to itself ---- */

struct scree_motion_piece {
    double start;
    double c[7];                   /* position = sum of c[k] (t - start)^k + … */
    double amplitude, rate, phase; /* … + amplitude sin(rate (t - start) + phase) */
};

/* A motion ready for use: polynomial (and sine) pieces in time order. Owns `pieces`. */
struct scree_motion {
    int count;
    struct scree_motion_piece *pieces;
};

/* Of what the motion drives, m or rad, and its derivatives by the time in s. */
struct scree_motion_value {
    double position, velocity, acceleration;
};

/* SCREE_BAD_INPUT for numbers that aren't finite or lead to others, times that don't increase, a missing column. The
 * caller frees the result with scree_motion_free. */
scree_status scree_motion_bake(const scree_motion_def *def, struct scree_motion *motion, scree_trouble *trouble);
void scree_motion_free(struct scree_motion *motion);

/* At any `time`, s. */
struct scree_motion_value scree_motion_at(const struct scree_motion *motion, double time);

#endif
