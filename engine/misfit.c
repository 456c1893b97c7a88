/* How large the error of a step of the adaptive integrator is, in parts of what is tolerable. */
#include "bodies/elementary.h"
#include "engine/adaptive.h"

#include <math.h>

/* Errors of a body are measured by its speed. One at rest has none: what its contacts would do to it within the step
 * serves instead. */
void scree_adaptive_measure(struct scree_scene *scene) {
    struct scree_adaptive *a = scene->adaptive;
    const struct scree_bodies *bodies = &scene->bodies;
    double gravity = vec_norm(vec_from(scene->gravity.vector));
    for (int k = 0; k < bodies->count; k++) {
        a->measure[k] = (struct scree_measure){vec_norm(vec_from(bodies->record[k].v)), 0.0, gravity, 0.0};
        a->held[k] = 0;
    }
    for (int k = 0; k < a->grips; k++) {
        const struct scree_grip *grip = &a->grip[k];
        const struct scree_grip_view *view = &a->view[k];
        if (grip->state != SCREE_GRIP_HELD) continue;
        double push = vec_norm(view->push), speed = sqrt(view->closing * view->closing + vec_norm2(view->slip));
        double slope =
            fabs(view->whole - view->damping * view->closing) / fmax(fabs(view->overlap), 1e-3 * grip->depth);
        double size = scree_grip_size(grip, bodies);
        for (int side = 0; side < 2; side++) {
            int body = side ? grip->contact.host : grip->contact.ball;
            struct scree_measure *m = &a->measure[body];
            double inverse = bodies->record[body].inverse_mass;
            m->speed = fmax(m->speed, speed);
            m->push += push * inverse;
            m->noise += slope * inverse * size;
            a->held[body] = 1;
        }
    }
}

/* Paces for a step of so many seconds. */
static void set_paces(struct scree_scene *scene, double step) {
    struct scree_adaptive *a = scene->adaptive;
    double fastest = 0.0;
    for (int k = 0; k < scene->bodies.count; k++) {
        a->measure[k].pace = fmax(a->measure[k].speed, step * a->measure[k].push);
        fastest = fmax(fastest, a->measure[k].pace);
    }
    for (int k = 0; k < scene->bodies.count; k++) a->measure[k].pace = fmax(a->measure[k].pace, 1e-3 * fastest);
}

static double length3(const double *v) { return vec_norm(vec_from(v)); }

/* The larger of `worst` and the error of one quantity, three numbers of it from `at`, in parts of `scale`. Both
 * estimates belong to the same quantity: one whose rates are a mere power of the variable would hide the error of the
 * others. */
static double larger(double worst, const struct scree_adaptive *a, int at, double scale) {
    double error = scree_dop853_error(length3(a->work.error5 + at) / scale, length3(a->work.error3 + at) / scale);
    return scree_most(worst, error);
}

/* The largest of a body's errors in parts of what is tolerable. */
static double body_misfit(const struct scree_scene *scene, int k, double step) {
    const struct scree_adaptive *a = scene->adaptive;
    const struct scree_bodies *bodies = &scene->bodies;
    const struct scree_measure *m = &a->measure[k];
    const double *moments = scree_kind_of(bodies, k)->inertia.moments;
    double tolerance = scene->time.tolerance, noise = 1e-15 * m->noise * step, tiny = 1e-290;
    double bound = bodies->record[k].bound, moment = fmax(moments[0], fmax(moments[1], moments[2]));
    double worst = larger(0.0, a, a->at[k] + OF_V, tolerance * m->pace + noise + tiny);
    worst = larger(worst, a, a->at[k] + OF_X, step * (tolerance * m->pace + noise) + tiny);
    double spin = fmax(length3(bodies->state[k].l), moment * m->pace / bound);
    worst = larger(worst, a, a->at[k] + OF_L, tolerance * spin + noise * moment / bound + tiny);
    if (scree_kind_of(bodies, k)->slot < 0) return worst;
    double scale = 0.5 * step * tolerance * (length3(bodies->spin[k].w) + m->pace / bound) + 1e-15;
    worst = larger(worst, a, a->at[k] + OF_Q, scale);
    return larger(worst, a, a->at[k] + OF_Q + 1, scale);
}

static double grip_misfit(const struct scree_scene *scene, int k, double step) {
    const struct scree_adaptive *a = scene->adaptive;
    const struct scree_grip_view *view = &a->view[k];
    double worst = 0.0, tolerance = scene->time.tolerance;
    for (int way = 0; way < SCREE_GRIP_WAYS; way++) {
        double stretch = length3(a->y + a->place[k] + 3 * way), rate = vec_norm(view->rate[way]);
        double unit = scree_grip_stiffness(&a->grip[k], way, 0.5 * a->grip[k].depth);
        /* Memory begins with nothing, like a power of time: relative errors would stay as they are however short the
         * step. So they would where it ends under a force that pulls, and then it bears nothing. */
        double part = a->grip[k].pulling ? 1.0 : 1e-2;
        double least = unit > 0.0 ? part * a->grip[k].load / unit : 0.0;
        worst = larger(worst, a, a->place[k] + 3 * way, tolerance * fmax(fmax(stretch, step * rate), least) + 1e-290);
    }
    return worst;
}

double scree_adaptive_error(struct scree_scene *scene, double step) {
    struct scree_adaptive *a = scene->adaptive;
    double worst = 0.0, energy = 0.0;
    set_paces(scene, step);
    for (int k = 0; k < a->grips; k++)
        if (a->grip[k].state == SCREE_GRIP_HELD) energy += a->grip[k].load * a->grip[k].depth;
    if (energy > 0.0) worst = larger(0.0, a, Y_WORK, scene->time.tolerance * energy); /* kept or not: the same steps */
    for (int k = 0; k < scene->bodies.count; k++) {
        if (a->at[k] < 0) continue;
        double misfit = body_misfit(scene, k, step);
        if (misfit <= worst) continue;
        worst = misfit;
        a->worst = k;
    }
    for (int k = 0; k < a->grips; k++) {
        if (a->grip[k].state != SCREE_GRIP_HELD || !scree_adaptive_memory_size(&a->grip[k])) continue;
        double misfit = grip_misfit(scene, k, step);
        if (misfit <= worst) continue;
        worst = misfit;
        a->worst = a->grip[k].contact.ball;
    }
    return worst;
}
