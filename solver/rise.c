/* Rise-to-dwell laws of cams. */
#include "solver/rise.h"

#include <math.h>

static const double pi = 3.14159265358979323846;

const char *const scree_cam_names[SCREE_CAM_LAWS] = {"quintic", "cycloid", "modified-sine"};

static struct scree_kinematics quintic(double u) {
    return (struct scree_kinematics){u * u * u * (10.0 - u * (15.0 - 6.0 * u)), 30.0 * u * u * (1.0 - u) * (1.0 - u),
                                     60.0 * u * (1.0 - u) * (1.0 - 2.0 * u), 60.0 * (1.0 - 6.0 * u * (1.0 - u))};
}

static struct scree_kinematics cycloid(double u) {
    double angle = 2.0 * pi * u, s = sin(angle), c = cos(angle);
    return (struct scree_kinematics){u - s / (2.0 * pi), 1.0 - c, 2.0 * pi * s, 4.0 * pi * pi * c};
}

/* E. H. Schmidt, Continuous cam curves, Machine Design 32 (1960) no. 1, 127-132; the formulas as in Rothbart, Cam
 * Design Handbook (2004), p. 75: acceleration peak sin(4 pi u) up to u = 1/8, peak cos(4 pi u/3 - pi/6) up to 7/8, with
 * peak = 4 pi^2/(4 + pi) = 5.528. */
static struct scree_kinematics modified_sine(double u) {
    double slope = pi / (4.0 + pi), peak = 4.0 * pi * slope;
    if (u > 0.875) { /* the first eighth backwards */
        struct scree_kinematics start = modified_sine(1.0 - u);
        return (struct scree_kinematics){1.0 - start.x, start.v, -start.a, start.j};
    }
    if (u < 0.125) {
        double angle = 4.0 * pi * u, s = sin(angle), c = cos(angle);
        return (struct scree_kinematics){slope * (u - s / (4.0 * pi)), slope * (1.0 - c), peak * s,
                                         4.0 * pi * peak * c};
    }
    double angle = 4.0 * pi * u / 3.0 - pi / 6.0, s = sin(angle), c = cos(angle);
    return (struct scree_kinematics){slope * (2.0 / pi + u - 9.0 * c / (4.0 * pi)), slope * (1.0 + 3.0 * s), peak * c,
                                     -4.0 / 3.0 * pi * peak * s};
}

struct scree_kinematics scree_cam_at(enum scree_cam_law law, double u) {
    if (!(u >= 0.0)) return (struct scree_kinematics){0};
    if (u > 1.0) return (struct scree_kinematics){.x = 1.0};
    switch (law) {
    case SCREE_CAM_CYCLOID:
        return cycloid(u);
    case SCREE_CAM_MODIFIED_SINE:
        return modified_sine(u);
    default:
        return quintic(u);
    }
}

struct scree_kinematics scree_cam_peaks(enum scree_cam_law law) {
    double slope = pi / (4.0 + pi);
    switch (law) {
    case SCREE_CAM_CYCLOID:
        return (struct scree_kinematics){0.75, 2.0, 2.0 * pi, 4.0 * pi * pi};
    case SCREE_CAM_MODIFIED_SINE:
        return (struct scree_kinematics){0.875, 4.0 * slope, 4.0 * pi * slope, 16.0 * pi * pi * slope};
    default:
        return (struct scree_kinematics){0.5 + sqrt(3.0) / 6.0, 1.875, 10.0 / sqrt(3.0), 60.0};
    }
}
