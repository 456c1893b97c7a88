/* Tables for motion controllers. */
#include "solver/table.h"

#include <math.h>

struct writer {
    FILE *file;
    const struct scree_profile *axis[2];
    int axes;
    const scree_table_options *options;
};

/* State at a time, on the earlier side (-1) of a border between segments or the later one (1). */
static struct scree_kinematics at_side(const struct scree_profile *profile, double time, int side) {
    int k = scree_profile_segment(profile, time);
    if (side < 0 && k > 0 && time == profile->start[k]) k--;
    const struct scree_segment *segment = &profile->segment[k];
    double t = time - profile->start[k];
    /* The end of a segment is where it says, not where the sum of durations is rounded to. */
    if (time == profile->start[k + 1] || t > segment->duration) t = segment->duration;
    return scree_segment_at(segment, t);
}

static int row(const struct writer *w, double time, int side) {
    double first = w->options->cycles > 0.0 ? time * w->options->cycles * 6.0 : time;
    int wrong = fprintf(w->file, "%.17g", first) < 0;
    for (int k = 0; k < w->axes; k++) {
        struct scree_kinematics at = at_side(w->axis[k], time, side);
        wrong |= fprintf(w->file, ",%.17g,%.17g,%.17g,%.17g", at.x, at.v, at.a, at.j) < 0;
    }
    return wrong | (fputc('\n', w->file) == EOF);
}

/* Whether acceleration or jerk differ on both sides, by more than rounding. */
static int jumps(const struct writer *w, double time) {
    for (int k = 0; k < w->axes; k++) {
        struct scree_kinematics a = at_side(w->axis[k], time, -1), b = at_side(w->axis[k], time, 1);
        struct scree_extrema size = scree_profile_extrema(w->axis[k]);
        if (fabs(a.a - b.a) > 1e-9 * scree_extrema_acceleration(&size)) return 1;
        if (fabs(a.j - b.j) > 1e-9 * scree_extrema_jerk(&size)) return 1;
    }
    return 0;
}

/* The next border of any axis after `time`. */
static double border(const struct writer *w, double time) {
    double next = HUGE_VAL;
    for (int k = 0; k < w->axes; k++)
        for (int i = 0; i <= w->axis[k]->count; i++)
            if (w->axis[k]->start[i] > time) next = fmin(next, w->axis[k]->start[i]);
    return next;
}

/* Rows of an evenly spaced grid and of all borders; grid times next to a border give way to it. */
static int write_rows(const struct writer *w) {
    double start = w->axis[0]->start[0], end = w->axis[0]->start[w->axis[0]->count], rate = w->options->rate;
    if (!(rate > 0.0) || !isfinite(rate) || !((end - start) * rate < 1e9)) return 1;
    int wrong = row(w, start, 1);
    long grid = 1;
    for (double time = start; time < end && !wrong;) {
        double next = border(w, time), step = start + (double)grid / rate;
        if (step < next - 1e-6 / rate) {
            grid++;
            if (step <= time + 1e-6 / rate) continue;
            time = step;
            wrong = row(w, time, 1);
        } else {
            time = next;
            int twice = w->options->both_sides && time < end && jumps(w, time);
            wrong = row(w, time, twice || time >= end ? -1 : 1);
            if (twice) wrong |= row(w, time, 1);
        }
    }
    return wrong || fflush(w->file) != 0 || ferror(w->file);
}

static const char *first_column(const scree_table_options *options) {
    return options->cycles > 0.0 ? "angle_deg" : "time_s";
}

int scree_table_write(FILE *file, const struct scree_profile *profile, const scree_table_options *options) {
    struct writer w = {file, {profile, NULL}, 1, options};
    if (profile->count == 0) return 1;
    if (fprintf(file, "%s,position_m,velocity_m_s,acceleration_m_s2,jerk_m_s3\n", first_column(options)) < 0) return 1;
    return write_rows(&w);
}

int scree_table_write_cycle(FILE *file, const scree_cycle *cycle, const scree_table_options *options) {
    struct writer w = {file, {&cycle->x, &cycle->z}, 2, options};
    if (cycle->x.count == 0) return 1;
    if (fprintf(file,
                "%s,position_m,velocity_m_s,acceleration_m_s2,jerk_m_s3,lift_position_m,lift_velocity_m_s,"
                "lift_acceleration_m_s2,lift_jerk_m_s3\n",
                first_column(options)) < 0)
        return 1;
    return write_rows(&w);
}
