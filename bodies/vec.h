/* Vectors and 3x3 matrices of doubles, by value. Column conventions: a matrix maps body to world axes and
 * its columns are the body's axes seen in the world. */
#ifndef SCREE_BODIES_VEC_H
#define SCREE_BODIES_VEC_H

#include <math.h>

/* For what is called several times in one pass of the loop: what isn't inlined isn't vectorised. */
#define SCREE_INLINE inline __attribute__((always_inline))

/* x, or the end of [-half, half] beyond which it is. fmin and fmax are calls: they mind NaNs and signs of zeros. */
static SCREE_INLINE double scree_clamp(double x, double half) { return x < -half ? -half : x > half ? half : x; }

struct vec {
    double x, y, z;
};

/* Columns: column[0] is the body's x axis in world coordinates. */
struct mat {
    struct vec column[3];
};

static SCREE_INLINE struct vec vec(double x, double y, double z) { return (struct vec){x, y, z}; }
static SCREE_INLINE struct vec vec_from(const double a[3]) { return vec(a[0], a[1], a[2]); }
static SCREE_INLINE struct vec vec_add(struct vec a, struct vec b) { return vec(a.x + b.x, a.y + b.y, a.z + b.z); }
static SCREE_INLINE struct vec vec_sub(struct vec a, struct vec b) { return vec(a.x - b.x, a.y - b.y, a.z - b.z); }
static SCREE_INLINE struct vec vec_scale(double s, struct vec a) { return vec(s * a.x, s * a.y, s * a.z); }
static SCREE_INLINE struct vec vec_times(struct vec a, struct vec b) { return vec(a.x * b.x, a.y * b.y, a.z * b.z); }
static SCREE_INLINE double vec_dot(struct vec a, struct vec b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
static SCREE_INLINE double vec_norm2(struct vec a) { return vec_dot(a, a); }
static SCREE_INLINE double vec_norm(struct vec a) { return sqrt(vec_norm2(a)); }

/* a + s b */
static SCREE_INLINE struct vec vec_axpy(struct vec a, double s, struct vec b) {
    return vec(a.x + s * b.x, a.y + s * b.y, a.z + s * b.z);
}

static SCREE_INLINE struct vec vec_cross(struct vec a, struct vec b) {
    return vec(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
}

static inline void vec_store(struct vec a, double to[3]) {
    to[0] = a.x;
    to[1] = a.y;
    to[2] = a.z;
}

/* World coordinates of a vector given in body axes. */
static inline struct vec mat_apply(const struct mat *m, struct vec a) {
    return vec(m->column[0].x * a.x + m->column[1].x * a.y + m->column[2].x * a.z,
               m->column[0].y * a.x + m->column[1].y * a.y + m->column[2].y * a.z,
               m->column[0].z * a.x + m->column[1].z * a.y + m->column[2].z * a.z);
}

/* Body coordinates of a vector given in world axes (the transpose, as the columns are orthonormal). */
static inline struct vec mat_undo(const struct mat *m, struct vec a) {
    return vec(vec_dot(m->column[0], a), vec_dot(m->column[1], a), vec_dot(m->column[2], a));
}

#endif
