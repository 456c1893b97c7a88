/* Motion profiles: polynomial segments joined end to end. */
#include "solver/profile.h"

#include <math.h>
#include <string.h>

enum { DEGREE = SCREE_SEGMENT_TERMS - 1 };

struct scree_segment scree_velocity_segment(double duration, double x, struct scree_kinematics from,
                                            struct scree_kinematics to) {
    double d = duration, d2 = d * d;
    /* Coefficients of v(u): 1, 10u^3 - 15u^4 + 6u^5, u - 6u^3 + 8u^4 - 3u^5, … belong to v, a, j at the ends. */
    double v[6] = {from.v, d * from.a, 0.5 * d2 * from.j, 0.0, 0.0, 0.0};
    double rise = to.v - from.v;
    v[3] = 10.0 * rise - d * (6.0 * from.a + 4.0 * to.a) - d2 * (1.5 * from.j - 0.5 * to.j);
    v[4] = -15.0 * rise + d * (8.0 * from.a + 7.0 * to.a) + d2 * (1.5 * from.j - to.j);
    v[5] = 6.0 * rise - 3.0 * d * (from.a + to.a) - 0.5 * d2 * (from.j - to.j);
    struct scree_segment segment = {.duration = d, .c = {x}};
    for (int k = 0; k < 6; k++) segment.c[k + 1] = d * v[k] / (k + 1);
    return segment;
}

struct scree_segment scree_position_segment(double duration, struct scree_kinematics from, struct scree_kinematics to) {
    double d = duration, d2 = d * d, rise = to.x - from.x;
    struct scree_segment segment = {.duration = d, .c = {from.x, d * from.v, 0.5 * d2 * from.a}};
    segment.c[3] = 10.0 * rise - d * (6.0 * from.v + 4.0 * to.v) - d2 * (1.5 * from.a - 0.5 * to.a);
    segment.c[4] = -15.0 * rise + d * (8.0 * from.v + 7.0 * to.v) + d2 * (1.5 * from.a - to.a);
    segment.c[5] = 6.0 * rise - 3.0 * d * (from.v + to.v) - 0.5 * d2 * (from.a - to.a);
    return segment;
}

double scree_polynomial(int degree, const double *c, double u) {
    double sum = c[degree];
    for (int k = degree - 1; k >= 0; k--) sum = sum * u + c[k];
    return sum;
}

/* Coefficients of the derivative; returns its degree. */
static int derive(int degree, const double *c, double *to) {
    if (degree == 0) {
        to[0] = 0.0;
        return 0;
    }
    for (int k = 1; k <= degree; k++) to[k - 1] = k * c[k];
    return degree - 1;
}

/* Coefficients in u of x, v, a, j and of the derivative of j (for the extrema of j), in m and s, into rows. */
static void derivatives(const struct scree_segment *segment, double rows[5][SCREE_SEGMENT_TERMS]) {
    memcpy(rows[0], segment->c, sizeof segment->c);
    for (int order = 1; order < 5; order++) {
        derive(DEGREE + 1 - order, rows[order - 1], rows[order]);
        for (int k = 0; k < SCREE_SEGMENT_TERMS; k++)
            rows[order][k] = k <= DEGREE - order ? rows[order][k] / segment->duration : 0.0;
    }
}

struct scree_kinematics scree_segment_at(const struct scree_segment *segment, double t) {
    double rows[5][SCREE_SEGMENT_TERMS], u = t / segment->duration;
    derivatives(segment, rows);
    return (struct scree_kinematics){scree_polynomial(DEGREE, rows[0], u), scree_polynomial(DEGREE - 1, rows[1], u),
                                     scree_polynomial(DEGREE - 2, rows[2], u),
                                     scree_polynomial(DEGREE - 3, rows[3], u)};
}

void scree_segment_taylor(const struct scree_segment *segment, double t, double terms[SCREE_SEGMENT_TERMS]) {
    double row[SCREE_SEGMENT_TERMS], factor = 1.0, u = t / segment->duration;
    int degree = DEGREE;
    memcpy(row, segment->c, sizeof row);
    for (int k = 0; k <= DEGREE; k++) {
        terms[k] = scree_polynomial(degree, row, u) * factor;
        degree = derive(degree, row, row);
        factor /= (k + 1) * segment->duration;
    }
}

/* The root between low and high, where the polynomial has opposite signs. */
static double bisect(int degree, const double *c, double low, double high) {
    int rising = scree_polynomial(degree, c, low) < 0.0;
    for (int k = 0; k < 200; k++) {
        double middle = 0.5 * (low + high);
        if (middle <= low || middle >= high) break;
        if ((scree_polynomial(degree, c, middle) < 0.0) == rising)
            low = middle;
        else
            high = middle;
    }
    return 0.5 * (low + high);
}

int scree_polynomial_roots(int degree, const double *c, double low, double high, double *roots) {
    while (degree > 0 && c[degree] == 0.0) degree--;
    if (degree == 0) return 0;
    double slope[DEGREE + 1], turns[DEGREE + 2];
    int turning = scree_polynomial_roots(derive(degree, c, slope), slope, low, high, turns), found = 0;
    double from = low;
    for (int k = 0; k <= turning; k++) {
        double to = k < turning ? turns[k] : high;
        double a = scree_polynomial(degree, c, from), b = scree_polynomial(degree, c, to);
        if ((a < 0.0 && b > 0.0) || (a > 0.0 && b < 0.0)) roots[found++] = bisect(degree, c, from, to);
        from = to;
    }
    return found;
}

double scree_segment_first(const struct scree_segment *segment, double wanted) {
    double rows[5][SCREE_SEGMENT_TERMS], roots[DEGREE + 1];
    derivatives(segment, rows);
    rows[2][0] -= wanted;
    if (rows[2][0] == 0.0) return 0.0;
    return scree_polynomial_roots(DEGREE - 2, rows[2], 0.0, 1.0, roots) ? roots[0] * segment->duration : -1.0;
}

int scree_profile_append(struct scree_profile *profile, const struct scree_segment *segment) {
    if (profile->count == SCREE_PROFILE_SEGMENTS) return 1;
    profile->segment[profile->count] = *segment;
    profile->start[profile->count + 1] = profile->start[profile->count] + segment->duration;
    profile->count++;
    return 0;
}

double scree_profile_duration(const struct scree_profile *profile) {
    return profile->start[profile->count] - profile->start[0];
}

int scree_profile_segment(const struct scree_profile *profile, double time) {
    int k = 0;
    while (k < profile->count - 1 && time >= profile->start[k + 1]) k++;
    return k;
}

struct scree_kinematics scree_profile_at(const struct scree_profile *profile, double time) {
    int k = scree_profile_segment(profile, time);
    const struct scree_segment *segment = &profile->segment[k];
    if (time < profile->start[0]) return (struct scree_kinematics){.x = scree_segment_at(segment, 0.0).x};
    if (time > profile->start[profile->count])
        return (struct scree_kinematics){.x = scree_segment_at(segment, segment->duration).x};
    return scree_segment_at(segment, time - profile->start[k]);
}

struct scree_profile scree_profile_scaled(const struct scree_profile *profile, double duration) {
    struct scree_profile scaled = *profile;
    double ratio = duration / scree_profile_duration(profile);
    for (int k = 0; k < profile->count; k++) scaled.segment[k].duration *= ratio;
    for (int k = 0; k <= profile->count; k++) scaled.start[k] *= ratio;
    return scaled;
}

static void widen(double x, double *least, double *largest) {
    *least = fmin(*least, x);
    *largest = fmax(*largest, x);
}

struct scree_extrema scree_profile_extrema(const struct scree_profile *profile) {
    double least[4], largest[4];
    for (int order = 0; order < 4; order++) {
        least[order] = HUGE_VAL;
        largest[order] = -HUGE_VAL;
    }
    for (int k = 0; k < profile->count; k++) {
        double rows[5][SCREE_SEGMENT_TERMS], roots[DEGREE + 1];
        derivatives(&profile->segment[k], rows);
        for (int order = 0; order < 4; order++) {
            widen(scree_polynomial(DEGREE - order, rows[order], 0.0), &least[order], &largest[order]);
            widen(scree_polynomial(DEGREE - order, rows[order], 1.0), &least[order], &largest[order]);
            int found = scree_polynomial_roots(DEGREE - order - 1, rows[order + 1], 0.0, 1.0, roots);
            for (int r = 0; r < found; r++)
                widen(scree_polynomial(DEGREE - order, rows[order], roots[r]), &least[order], &largest[order]);
        }
    }
    return (struct scree_extrema){{least[0], least[1], least[2], least[3]},
                                  {largest[0], largest[1], largest[2], largest[3]}};
}

double scree_extrema_acceleration(const struct scree_extrema *extrema) {
    return fmax(fabs(extrema->least.a), fabs(extrema->largest.a));
}

double scree_extrema_jerk(const struct scree_extrema *extrema) {
    return fmax(fabs(extrema->least.j), fabs(extrema->largest.j));
}

/* Whether segment b continues the polynomial of a: a's Taylor terms at its end, in b's normalised time, are b's. */
static int continues(const struct scree_segment *a, const struct scree_segment *b, double tolerance) {
    double terms[SCREE_SEGMENT_TERMS], factor = 1.0;
    scree_segment_taylor(a, a->duration, terms);
    for (int k = 0; k < SCREE_SEGMENT_TERMS; k++, factor *= b->duration)
        if (!(fabs(terms[k] * factor - b->c[k]) <= tolerance)) return 0;
    return 1;
}

int scree_profile_merge(struct scree_profile *profile, double tolerance) {
    int kept = 0;
    for (int k = 1; k < profile->count; k++) {
        struct scree_segment *a = &profile->segment[kept];
        const struct scree_segment *b = &profile->segment[k];
        if (continues(a, b, tolerance)) {
            double ratio = (a->duration + b->duration) / a->duration, factor = 1.0;
            for (int term = 0; term < SCREE_SEGMENT_TERMS; term++, factor *= ratio) a->c[term] *= factor;
            a->duration += b->duration;
        } else {
            profile->segment[++kept] = *b;
            profile->start[kept] = profile->start[k];
        }
    }
    double end = profile->start[profile->count];
    profile->count = profile->count ? kept + 1 : 0;
    profile->start[profile->count] = end;
    return profile->count;
}

struct scree_kinematics scree_profile_jumps(const struct scree_profile *profile) {
    struct scree_kinematics largest = {0};
    for (int k = 1; k < profile->count; k++) {
        struct scree_kinematics a = scree_segment_at(&profile->segment[k - 1], profile->segment[k - 1].duration);
        struct scree_kinematics b = scree_segment_at(&profile->segment[k], 0.0);
        largest.x = fmax(largest.x, fabs(b.x - a.x));
        largest.v = fmax(largest.v, fabs(b.v - a.v));
        largest.a = fmax(largest.a, fabs(b.a - a.a));
        largest.j = fmax(largest.j, fabs(b.j - a.j));
    }
    return largest;
}
