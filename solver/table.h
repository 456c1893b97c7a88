/* Tables that a motion controller can read: comma-separated rows of time, position, velocity, acceleration, jerk. */
#ifndef SCREE_SOLVER_TABLE_H
#define SCREE_SOLVER_TABLE_H

#include "solver/cycle.h"

#include <stdio.h>

/* Zero means the default, where there is one. */
typedef struct scree_table_options {
    double rate;    /* rows a second, > 0; further rows stand where segments meet and at the end */
    double cycles;  /* operating speed, 1/min; above 0: the first column is the machine's angle (degrees, 360 a cycle),
                       not the time */
    int both_sides; /* where acceleration or jerk jump, write a row for either side; else only for the later one, so
                       that times rise strictly */
} scree_table_options;

/* Columns time_s (or angle_deg), position_m, velocity_m_s, acceleration_m_s2, jerk_m_s3, as motion tables of scenes
 * have them; numbers with 17 digits, which read back as the same bits (in the locale of the thread: "C" unless the
 * program sets another); first row at the profile's start, last one exactly at its end.
 *
 * The travel between two rows of one segment is h (v0 + v1)/2 + h^2 (a0 - a1)/10 + h^3 (j0 + j1)/120 without error but
 * rounding (Hermite's quadrature of the quintic through both rows), so the sum over all rows gives the end position
 * back; over jumps, with `both_sides`. Returns 0, or 1 if the rate makes no sense or writing failed (errno). */
int scree_table_write(FILE *file, const struct scree_profile *profile, const scree_table_options *options);

/* The same for both coordinates of a cycle: columns lift_position_m, lift_velocity_m_s, lift_acceleration_m_s2,
 * lift_jerk_m_s3 follow. */
int scree_table_write_cycle(FILE *file, const scree_cycle *cycle, const scree_table_options *options);

#endif
