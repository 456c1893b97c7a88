/* Rise-to-dwell laws of cams: from rest to rest over a unit stroke in unit time. */
#ifndef SCREE_SOLVER_RISE_H
#define SCREE_SOLVER_RISE_H

#include "solver/profile.h"

enum scree_cam_law {
    SCREE_CAM_QUINTIC = 0,   /* 10 u^3 - 15 u^4 + 6 u^5 ("3-4-5"): peaks 1.875, 5.774, 60 */
    SCREE_CAM_CYCLOID,       /* u - sin(2 pi u)/(2 pi) (Bestehorn's inclined sine): 2, 6.283, 39.5 */
    SCREE_CAM_MODIFIED_SINE, /* a quarter of a fast sine, half of a slow one, a quarter of the fast
                                one: 1.760, 5.528, 69.5 */
    SCREE_CAM_LAWS
};

/* "quintic", "cycloid", "modified-sine", in the order of scree_cam_law. */
extern const char *const scree_cam_names[SCREE_CAM_LAWS];

/* Position, velocity, acceleration and jerk at u = t/T; at rest outside of 0 … 1. To scale: times s, s/T, s/T^2,
 * s/T^3. */
struct scree_kinematics scree_cam_at(enum scree_cam_law law, double u);

/* Largest |velocity|, |acceleration| and |jerk|, closed forms; `x`: the u > 1/2 of the hardest deceleration. All laws
 * are symmetric about u = 1/2, and decelerate ever harder from there to that u. */
struct scree_kinematics scree_cam_peaks(enum scree_cam_law law);

#endif
