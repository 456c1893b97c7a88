/* Unit quaternions (scalar first, body to world) and their rotation matrices. */
#ifndef SCREE_BODIES_QUAT_H
#define SCREE_BODIES_QUAT_H

#include "bodies/vec.h"

struct quat {
    double w, x, y, z;
};

static inline struct quat quat_from(const double a[4]) { return (struct quat){a[0], a[1], a[2], a[3]}; }

static inline void quat_store(struct quat q, double to[4]) {
    to[0] = q.w;
    to[1] = q.x;
    to[2] = q.y;
    to[3] = q.z;
}

static inline struct quat quat_multiply(struct quat a, struct quat b) {
    return (struct quat){a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z, a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y,
                         a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x, a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w};
}

static inline struct quat quat_normalise(struct quat q) {
    double s = 1.0 / sqrt(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z);
    return (struct quat){s * q.w, s * q.x, s * q.y, s * q.z};
}

static inline struct mat quat_to_mat(struct quat q) {
    double xx = q.x * q.x, yy = q.y * q.y, zz = q.z * q.z;
    double xy = q.x * q.y, xz = q.x * q.z, yz = q.y * q.z;
    double wx = q.w * q.x, wy = q.w * q.y, wz = q.w * q.z;
    return (struct mat){{{1.0 - 2.0 * (yy + zz), 2.0 * (xy + wz), 2.0 * (xz - wy)},
                         {2.0 * (xy - wz), 1.0 - 2.0 * (xx + zz), 2.0 * (yz + wx)},
                         {2.0 * (xz + wy), 2.0 * (yz - wx), 1.0 - 2.0 * (xx + yy)}}};
}

#endif
