/* The conventional motion of a comb and a rigid product. */
#include "solver/conventional.h"

#include <math.h>

double scree_conventional_duration(const struct scree_conventional *motion, double cycles) {
    return 60.0 * motion->share / cycles;
}

void scree_conventional_at(const struct scree_conventional *motion, double cycles, double time, double *position,
                           double *velocity, double *acceleration) {
    double duration = scree_conventional_duration(motion, cycles), s = motion->stroke;
    struct scree_kinematics at = scree_cam_at(motion->law, fmin(fmax(time / duration, 0.0), 1.0));
    *position = s * at.x;
    *velocity = s / duration * at.v;
    *acceleration = s / (duration * duration) * at.a;
}

double scree_conventional_limit(const struct scree_conventional *motion) {
    double largest = scree_cam_peaks(motion->law).a; /* of |a| T^2/s */
    return 60.0 * motion->share * sqrt(motion->friction * motion->gravity / (largest * motion->stroke));
}

double scree_conventional_detachment(const struct scree_conventional *motion, double cycles) {
    double duration = scree_conventional_duration(motion, cycles);
    if (cycles <= scree_conventional_limit(motion)) return duration;
    /* The deceleration grows from u = 1/2 to its largest value: one root in between. */
    double low = 0.5, high = scree_cam_peaks(motion->law).x, x, v, a;
    for (int k = 0; k < 100; k++) {
        double middle = 0.5 * (low + high);
        scree_conventional_at(motion, cycles, middle * duration, &x, &v, &a);
        if (a > -motion->friction * motion->gravity)
            low = middle;
        else
            high = middle;
    }
    return 0.5 * (low + high) * duration;
}

double scree_conventional_error(const struct scree_conventional *motion, double cycles) {
    if (cycles <= scree_conventional_limit(motion)) return 0.0;
    double x, v, a;
    scree_conventional_at(motion, cycles, scree_conventional_detachment(motion, cycles), &x, &v, &a);
    return fmax(0.0, x + v * v / (2.0 * motion->friction * motion->gravity) - motion->stroke);
}

double scree_conventional_critical(const struct scree_conventional *motion, double tolerance) {
    double slowing = motion->friction * motion->gravity;
    if (!(slowing > 0.0 && motion->stroke > 0.0 && motion->share > 0.0 && tolerance > 0.0 && isfinite(tolerance)))
        return NAN;
    double low = scree_conventional_limit(motion), high = 2.0 * low;
    while (scree_conventional_error(motion, high) < tolerance) high *= 2.0;
    for (int k = 0; k < 100; k++) {
        double middle = 0.5 * (low + high);
        if (scree_conventional_error(motion, middle) < tolerance)
            low = middle;
        else
            high = middle;
    }
    return 0.5 * (low + high);
}
