/* Free flight: where nothing touches and only gravity acts, bodies go straight to the next possible touch.
 *
 * For spheres among each other, and on planes, that is the root of a quadratic: free bodies fall alike, so their
 * relative motion is straight. For all else it is a time in which no two can meet: their gap over the largest speed at
 * which it can close, from which the flight goes on; close to each other, steps with their search for the touch take
 * over. */
#include "engine/adaptive.h"

#include "contact/meet.h"

#include <math.h>

int scree_adaptive_can_fly(const struct scree_scene *scene) {
    if (scene->gravity.tilts) return 0;
    for (int k = 0; k < scene->bodies.count; k++) {
        const scree_joint *joint = &scree_kind_of(&scene->bodies, k)->joint;
        int driven = joint->turn == SCREE_DRIVEN;
        for (int axis = 0; axis < 3; axis++) driven |= joint->along[axis] == SCREE_DRIVEN;
        if (driven) return 0;
    }
    return 1;
}

/* Acceleration of a body that nothing touches. */
static struct vec falls(const struct scree_scene *scene, int k) {
    const double *g = scene->gravity.vector;
    const scree_freedom *along = scree_kind_of(&scene->bodies, k)->joint.along;
    return vec(along[0] == SCREE_FREE ? g[0] : 0.0, along[1] == SCREE_FREE ? g[1] : 0.0,
               along[2] == SCREE_FREE ? g[2] : 0.0);
}

/* The first time at which a gap g + v t + a t^2/2 (g > 0, or g >= 0 and opening) is zero; HUGE_VAL: never. */
static double first_root(double gap, double rate, double curve) {
    double square = rate * rate - 2.0 * curve * gap;
    if (square < 0.0) return HUGE_VAL;
    double root = sqrt(square);
    if (gap <= 0.0) { /* just parted, or lying there */
        if (rate < 0.0 || (rate == 0.0 && curve < 0.0)) return 0.0;
        return curve < 0.0 ? (rate + root) / -curve : HUGE_VAL;
    }
    if (rate < root) return 2.0 * gap / (root - rate) > 0.0 ? 2.0 * gap / (root - rate) : HUGE_VAL;
    return HUGE_VAL;
}

/* Two spheres in straight relative motion. */
static double time_of_balls(struct vec apart, struct vec velocity, double reach) {
    double distance = vec_norm(apart), gap = distance - reach, along = vec_dot(apart, velocity);
    double square = vec_norm2(velocity);
    /* |apart + v t| = reach: v^2 t^2 + 2 along t + (distance + reach) gap = 0 */
    if (along >= 0.0 || square == 0.0) return HUGE_VAL;
    if (gap <= 0.0) return 0.0;
    double product = (distance + reach) * gap, root = along * along - square * product;
    return root < 0.0 ? HUGE_VAL : product / (-along + sqrt(root));
}

/* A gap of two bodies that is not above the true one, by corners and faces; 0 where that can't be told. */
static double gap_between(const struct scree_bodies *bodies, int i, int j) {
    const struct scree_record *a = &bodies->record[i], *b = &bodies->record[j];
    int plane =
        scree_kind_of(bodies, i)->shape.kind == SCREE_PLANE || scree_kind_of(bodies, j)->shape.kind == SCREE_PLANE;
    double outside = plane ? -1.0 : vec_norm(vec_sub(vec_from(a->x), vec_from(b->x))) - a->bound - b->bound;
    double least = HUGE_VAL;
    if (scree_kind_of(bodies, i)->shape.kind == SCREE_BOX &&
        scree_kind_of(bodies, j)->shape.kind == SCREE_BOX) { /* edges may be nearer than corners */
        struct scree_two_boxes boxes = scree_two_boxes_of(bodies, i, j);
        return fmax(fmax(outside, scree_cores_apart(&boxes) - a->radius - b->radius), 0.0);
    }
    for (int side = 0; side < 2; side++) {
        int ball = side ? j : i, host = side ? i : j, box = scree_kind_of(bodies, ball)->shape.kind == SCREE_BOX;
        int sphere = scree_kind_of(bodies, ball)->shape.kind == SCREE_SPHERE,
            flat = scree_kind_of(bodies, host)->shape.kind != SCREE_SPHERE;
        if (!box && !sphere) continue;
        if (!flat && !(sphere && scree_kind_of(bodies, host)->shape.kind == SCREE_SPHERE)) continue;
        enum scree_geometry geometry = scree_kind_of(bodies, host)->shape.kind == SCREE_PLANE ? SCREE_BALL_PLANE
                                       : scree_kind_of(bodies, host)->shape.kind == SCREE_RECTANGLE
                                           ? SCREE_BALL_RECTANGLE
                                       : scree_kind_of(bodies, host)->shape.kind == SCREE_BOX ? SCREE_BALL_BOX
                                                                                              : SCREE_BALL_BALL;
        for (int c = 0; c < (box ? 8 : 1); c++) {
            struct scree_contact contact = {ball, host, box ? 1 + 8 * scree_kind_of(bodies, ball)->slot + c : 0};
            struct vec centre = vec_add(vec_from(bodies->record[ball].x), vec_from(bodies->corner[contact.corner]));
            double overlap = scree_meet(bodies, &contact, geometry, centre).overlap;
            least = fmin(least, overlap < 0.5 * SCREE_OUTSIDE ? 0.0 : -overlap);
        }
    }
    return fmax(fmax(outside, least < HUGE_VAL ? least : 0.0), 0.0);
}

/* The largest speed about its centre that a point of a freely turning body can have: |w| <= |l|/least moment. */
static double rim_speed_bound(const struct scree_bodies *bodies, int k) {
    const double *inverse = scree_kind_of(bodies, k)->inertia.inverse_moments;
    double most = fmax(inverse[0], fmax(inverse[1], inverse[2]));
    if (scree_kind_of(bodies, k)->slot >= 0) most = fmax(most, scree_attitude_of(bodies, k)->inverse_hinge);
    return bodies->record[k].bound * most * vec_norm(vec_from(bodies->state[k].l));
}

static double time_of_pair(const struct scree_scene *scene, int i, int j) {
    const struct scree_bodies *bodies = &scene->bodies;
    const struct scree_record *a = &bodies->record[i], *b = &bodies->record[j];
    scree_shape_kind shape = scree_kind_of(bodies, i)->shape.kind, other = scree_kind_of(bodies, j)->shape.kind;
    struct vec velocity = vec_sub(vec_from(a->v), vec_from(b->v)), fall = vec_sub(falls(scene, i), falls(scene, j));
    struct vec apart = vec_sub(vec_from(a->x), vec_from(b->x));
    if (shape == SCREE_SPHERE && other == SCREE_SPHERE && vec_norm2(fall) == 0.0)
        return time_of_balls(apart, velocity, a->radius + b->radius);
    int plane = other == SCREE_PLANE;
    if ((shape == SCREE_SPHERE && plane) || (shape == SCREE_PLANE && other == SCREE_SPHERE)) {
        const struct scree_attitude *attitude = scree_attitude_of(bodies, plane ? j : i);
        struct vec n = vec_scale(plane ? 1.0 : -1.0, attitude->frame.column[2]);
        double radius = plane ? a->radius : b->radius;
        return first_root(vec_dot(n, apart) - radius, vec_dot(n, velocity), vec_dot(n, fall));
    }
    double speed = vec_norm(velocity), pull = vec_norm(fall), gap = gap_between(bodies, i, j);
    if (shape != SCREE_SPHERE && shape != SCREE_PLANE) speed += rim_speed_bound(bodies, i);
    if (other != SCREE_SPHERE && other != SCREE_PLANE) speed += rim_speed_bound(bodies, j);
    double root = speed + sqrt(speed * speed + 2.0 * pull * gap);
    return root > 0.0 ? 2.0 * gap / root * (1.0 - 1e-12) : HUGE_VAL;
}

double scree_adaptive_safe_time(const struct scree_scene *scene, double most) {
    for (int i = 0; i < scene->bodies.count; i++)
        for (int j = i + 1; j < scene->bodies.count; j++)
            if (scree_contacts_rule(&scene->contacts, &scene->bodies, i, j, NULL))
                most = fmin(most, time_of_pair(scene, i, j));
    return most;
}

/* Whether a body's attitude changes in flight in a way that has no short formula. */
static int turns_freely(const struct scree_bodies *bodies, int k) {
    return scree_kind_of(bodies, k)->slot >= 0 && scree_kind_of(bodies, k)->joint.turn == SCREE_FREE &&
           vec_norm2(vec_from(bodies->state[k].l)) > 0.0;
}

int scree_adaptive_fly(struct scree_scene *scene, double time) {
    struct scree_adaptive *a = scene->adaptive;
    int turns = 0;
    for (int k = 0; k < scene->bodies.count; k++) turns |= a->at[k] >= 0 && turns_freely(&scene->bodies, k);
    if (turns && scree_adaptive_turn(scene, time)) return -1;
    for (int k = 0; k < scene->bodies.count; k++) {
        if (a->at[k] < 0) continue;
        struct vec g = falls(scene, k), v = vec_from(a->y + a->at[k] + OF_V);
        struct vec way = vec_axpy(vec_scale(time, v), 0.5 * time * time, g);
        vec_store(vec_add(vec_from(a->y + a->at[k]), way), a->y + a->at[k]);
        vec_store(vec_axpy(v, time, g), a->y + a->at[k] + OF_V);
    }
    a->y[Y_TIME] += time;
    return 0;
}
