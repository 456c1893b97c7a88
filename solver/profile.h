/* Motion profiles: segments whose position is a polynomial in their own normalised time u = 0 … 1, joined end to
 * end. */
#ifndef SCREE_SOLVER_PROFILE_H
#define SCREE_SOLVER_PROFILE_H

enum { SCREE_PROFILE_SEGMENTS = 16, SCREE_SEGMENT_TERMS = 7 };

/* Position, velocity, acceleration, jerk: m, m/s, m/s^2, m/s^3. */
struct scree_kinematics {
    double x, v, a, j;
};

/* x(u) = sum of c[k] u^k, u = t/duration. */
struct scree_segment {
    double duration; /* s, > 0 */
    double c[SCREE_SEGMENT_TERMS];
};

struct scree_profile {
    int count;
    double start[SCREE_PROFILE_SEGMENTS + 1]; /* s; start[count] is the end */
    struct scree_segment segment[SCREE_PROFILE_SEGMENTS];
};

/* Smallest and largest velocity, acceleration and jerk. */
struct scree_extrema {
    struct scree_kinematics least, largest; /* x too */
};

/* The segment whose velocity is the quintic in t with the given velocity, acceleration and jerk at both ends; from
 * position x (Troll et al., Adv. Mech. Eng. (2018), doi 10.1177/1687814018754953: six parameters, jerk continuous). */
struct scree_segment scree_velocity_segment(double duration, double x, struct scree_kinematics from,
                                            struct scree_kinematics to);

/* The segment whose position is the quintic in t with the given position, velocity and acceleration at both ends. */
struct scree_segment scree_position_segment(double duration, struct scree_kinematics from, struct scree_kinematics to);

/* State at time t within the segment (0 … duration). */
struct scree_kinematics scree_segment_at(const struct scree_segment *segment, double t);

/* Taylor terms of the position about time t within the segment: x(t + tau) = sum of terms[k] tau^k, tau in s; exact. */
void scree_segment_taylor(const struct scree_segment *segment, double t, double terms[SCREE_SEGMENT_TERMS]);

/* First time in the segment at which the acceleration equals `value`; -1 if there is none. */
double scree_segment_first(const struct scree_segment *segment, double value);

/* Append a segment; returns 0, or 1 if there is no room. */
int scree_profile_append(struct scree_profile *profile, const struct scree_segment *segment);

/* State at any time; at rest before the start and after the end, as there. */
struct scree_kinematics scree_profile_at(const struct scree_profile *profile, double time);

/* Number of the segment that holds at `time`, the later one where two meet. */
int scree_profile_segment(const struct scree_profile *profile, double time);

/* Duration, s. */
double scree_profile_duration(const struct scree_profile *profile);

/* The same motion in another duration: velocity, acceleration and jerk scale by powers of the ratio. */
struct scree_profile scree_profile_scaled(const struct scree_profile *profile, double duration);

/* Exact extrema: at the roots of the next derivative and at the ends of segments. */
struct scree_extrema scree_profile_extrema(const struct scree_profile *profile);

/* Merge neighbouring segments that are one polynomial to within `tolerance` (m); returns how many segments are left. */
int scree_profile_merge(struct scree_profile *profile, double tolerance);

/* Largest jump of position (m), velocity, acceleration and jerk between neighbouring segments. */
struct scree_kinematics scree_profile_jumps(const struct scree_profile *profile);

/* Largest |a| and |j| of extrema: what a drive has to give. */
double scree_extrema_acceleration(const struct scree_extrema *extrema);
double scree_extrema_jerk(const struct scree_extrema *extrema);

/* Value of the polynomial c[0] + … + c[degree] u^degree. */
double scree_polynomial(int degree, const double *c, double u);

/* Real roots in (low, high) of the polynomial with coefficients c[0 … degree], degree <= 6, ascending, into `roots`
 * (degree entries), in rising order; returns how many. Roots are found between those of the derivative, by bisection to
 * rounding; double roots may be missed. */
int scree_polynomial_roots(int degree, const double *c, double low, double high, double *roots);

#endif
