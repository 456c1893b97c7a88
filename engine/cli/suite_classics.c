/* Textbook cases that engines are judged by: inclines, sliding, rolling, rows and stacks of spheres. */
#include "bodies/quat.h"
#include "engine/cli/figures.h"

#include <math.h>
#include <string.h>

static const double gravity = 9.81, pi = 3.14159265358979323846;

#define HEAD                                                                                                           \
    "[output]\nwrite = []\n[[material]]\nname = \"m\"\n[[material]]\nname = \"w\"\n"                                   \
    "[[body]]\nname = \"floor\"\nshape = { plane = true }\nmaterial = \"w\"\njoint = \"fixed\"\n"

/* ---- inclined plane: gravity leans instead ---- */

struct slope {
    int box;
    double angle, mu;
};

/* Acceleration along the slope, m/s^2, between 0.1 s and 0.2 s after the start: the springs have come to rest by
 * then. */
static scree_status slope_acceleration(struct figures *figures, const struct slope *s, double *along) {
    char text[1536];
    snprintf(
        text, sizeof text,
        "gravity = [%.17g, 0, %.17g]\n[time]\nend = 0.1\nspeed = 0.01\n" HEAD
        "[[contact]]\nbetween = [\"m\", \"w\"]\nnormal = { law = \"linear-cut\", stiffness = 1e8, restitution = 0.1 }\n"
        "friction = { law = \"coulomb\", static = %.17g, kinetic = %.17g, stiffness = 8e7, damping = 1200 }\n%s"
        "[[body]]\nname = \"it\"\nmaterial = \"m\"\nmass = 0.05\n%s",
        gravity * sin(s->angle), -gravity * cos(s->angle), s->mu, s->mu, s->box ? "shared_by = 4\n" : "",
        s->box ? "shape = { box = [0.04, 0.04, 0.01], rounding = 0.001 }\nposition = [0, 0, 0.005]\n"
               : "shape = { sphere = 0.01 }\nposition = [0, 0, 0.01]\n");
    scree_scene *scene = figures_scene_text(figures, text);
    if (!scene) return figures->trouble.status;
    long steps = lround(0.1 / scree_scene_step_length(scene));
    scree_status status = figures_step(figures, scene, steps);
    double before = scree_scene_body(scene, 1).velocity[0];
    if (!status) status = figures_step(figures, scene, steps);
    *along = (scree_scene_body(scene, 1).velocity[0] - before) / 0.1;
    scree_scene_destroy(scene);
    return status;
}

/* A sphere's lever is shorter than its radius by half the overlap, 2.5e-7 of it. */
scree_status suite_incline(struct figures *figures) {
    double worst[2] = {0.0}, creep = 0.0;
    static const double mus[] = {0.1, 0.15, 0.3, 0.5};
    for (int box = 0; box < 2; box++)
        for (double degrees = 5.0; degrees < 46.0; degrees += 5.0)
            for (int m = 0; m < 4; m++) {
                struct slope s = {box, degrees * pi / 180.0, mus[m]};
                double along, slides = gravity * (sin(s.angle) - s.mu * cos(s.angle)), expected;
                scree_status status = slope_acceleration(figures, &s, &along);
                if (status) return status;
                expected = box                          ? fmax(slides, 0.0)
                           : tan(s.angle) <= 3.5 * s.mu ? 5.0 / 7.0 * gravity * sin(s.angle)
                                                        : slides;
                if (expected > 0.0)
                    worst[box] = scree_most(worst[box], fabs(along / expected - 1.0));
                else
                    creep = scree_most(creep, fabs(along));
            }
    figures_report(figures, "incline", "acceleration of a sphere, worst of 36 (MuJoCo 5e-5)", 0.0, worst[0], 2.5e-7);
    figures_report(figures, "incline", "acceleration of a block that slides, worst", 0.0, worst[1], 1e-6);
    figures_report(figures, "incline", "acceleration of a block that sticks (m/s^2)", 0.0, creep, 1e-10);
    return SCREE_OK;
}

/* Stop distance v^2/(2 mu g) of a box that is kept from pitching. */
scree_status suite_slide(struct figures *figures) {
    static const char text[] =
        "gravity = [0, 0, -9.81]\n[time]\nend = 10\nspeed = 0.01\n" HEAD
        "[[contact]]\nbetween = [\"m\", \"w\"]\nnormal = { law = \"linear-cut\", stiffness = 1e6, restitution = 0.1 }\n"
        "shared_by = 4\nfriction = { law = \"coulomb\", static = 0.5, kinetic = 0.5, stiffness = 1e6, damping = 100 }\n"
        "[[body]]\nname = \"it\"\nmaterial = \"m\"\nmass = 1\nshape = { box = [0.5, 0.5, 0.5], rounding = 0.01 }\n"
        "position = [0, 0, 0.24999019]\nvelocity = [5, 0, 0]\njoint = { turn = \"fixed\" }\n";
    scree_scene *scene = figures_scene_text(figures, text);
    if (!scene) return figures->trouble.status;
    scree_status status = figures_step(figures, scene, lround(2.0 / scree_scene_step_length(scene)));
    double way = scree_scene_body(scene, 1).position[0];
    scree_scene_destroy(scene);
    /* The spring is stretched by mu m g/k = 5e-6 m at the end, and comes back by that. */
    if (!status)
        figures_report(figures, "slide", "stop distance from 5 m/s (m) (Chrono 5e-3)", 25.0 / (2.0 * 0.5 * 9.81), way,
                       5e-6);
    return status;
}

/* Deceleration 5/7 mu_r g (Ai et al. 2011, type A), and rest in the end. */
scree_status suite_rolling(struct figures *figures) {
    double worst = 0.0, spin = 0.0, way = 0.0;
    static const double rolls[] = {0.01, 0.05, 0.1, 0.2};
    for (int k = 0; k < 4; k++) {
        char text[1536];
        snprintf(text, sizeof text,
                 "gravity = [0, 0, -9.81]\n[time]\nend = 10\nspeed = 0.01\n" HEAD
                 "[[contact]]\nbetween = [\"m\", \"w\"]\nnormal = { law = \"linear-cut\", stiffness = 1e6, restitution "
                 "= 0.1 }\n"
                 "friction = { law = \"coulomb\", static = 0.8, kinetic = 0.8, stiffness = 8e5, damping = 100 }\n"
                 "rolling = { law = \"spring-dashpot\", rolling = %g, stiffness = 1e5, damping = 20 }\n"
                 "[[body]]\nname = \"it\"\nmaterial = \"m\"\nmass = 0.05\nshape = { sphere = 0.1 }\n"
                 "position = [0, 0, 0.09999951]\nvelocity = [0.1, 0, 0]\nspin = [0, 1, 0]\n",
                 rolls[k]);
        scree_scene *scene = figures_scene_text(figures, text);
        if (!scene) return figures->trouble.status;
        double rate = 5.0 / 7.0 * rolls[k] * gravity, stop = 0.1 / rate, step = scree_scene_step_length(scene);
        scree_status status = figures_step(figures, scene, lround(0.5 * stop / step));
        worst = scree_most(worst,
                           fabs((0.1 - scree_scene_body(scene, 1).velocity[0]) / scree_scene_time(scene) / rate - 1.0));
        if (!status) status = figures_step(figures, scene, lround((0.8 * stop + 1.0) / step));
        spin = scree_most(spin, fabs(scree_scene_body(scene, 1).spin[1]));
        way = scree_most(way, fabs(scree_scene_body(scene, 1).position[0] / (0.05 * stop) - 1.0));
        scree_scene_destroy(scene);
        if (status) return status;
    }
    /* The rolling spring takes mu_r m g/k to stretch, a thousandth of the way at most. */
    figures_report(figures, "rolling", "deceleration, worst of 4 coefficients", 0.0, worst, 1e-3);
    figures_report(figures, "rolling", "distance when stopped, worst of 4", 0.0, way, 1e-3);
    figures_report(figures, "rolling", "spin when stopped (rad/s) (Chrono 1e-3)", 0.0, spin, 1e-5);
    return SCREE_OK;
}

/* ---- rows and stacks ---- */

/* Spheres of radius 1/2 and mass 1 in a row along x, just touching, the first with speed 1. */
static scree_scene *row(struct figures *figures, int count, const char *normal, double step, const char *integrator) {
    static char text[65536];
    int n = snprintf(text, sizeof text,
                     "[time]\nend = 1000\nstep = %.17g\nintegrator = %s\n[output]\nwrite = []\n"
                     "[[material]]\nname = \"m\"\n[[contact]]\nbetween = [\"m\", \"m\"]\nnormal = { %s }\n",
                     step, integrator, normal);
    for (int k = 0; k < count; k++)
        n += snprintf(
            text + n, sizeof text - (size_t)n,
            "[[body]]\nname = \"%d\"\nshape = { sphere = 0.5 }\nmaterial = \"m\"\nmass = 1\nposition = [%d, 0, 0]\n"
            "velocity = [%d, 0, 0]\n",
            k, k, k == 0);
    return figures_scene_text(figures, text);
}

/* Speeds of three balls, of one unit of mass, after all contacts have opened (Herrmann & Seitz 1982), to 12 digits. */
static const struct cradle {
    const char *name, *law;
    double duration, expected[3];
} cradles[] = {
    {"linear",
     "law = \"linear\", stiffness = 1e6, damping = 0.0",
     2.2e-3,
     {-0.130261695065, 0.150229569434, 0.980032125631}},
    {"Hertz", "law = \"hertz\", stiffness = 1e6", 9.7e-3, {-0.070952353651, 0.076403039071, 0.994549314580}}};

static scree_status cradle_error(struct figures *figures, const struct cradle *cradle, int exact, double *worst) {
    double step = cradle->duration / (exact ? 1.0 : 500.3);
    scree_scene *scene = row(figures, 3, cradle->law, step,
                             exact ? "\"adaptive\"\ntolerance = 1e-12" : "\"pair-impulse\"\nforce = true");
    if (!scene) return figures->trouble.status;
    scree_status status = figures_step(figures, scene, exact ? 6 : 3000);
    for (int k = 0; k < 3; k++)
        *worst = scree_most(*worst, fabs(scree_scene_body(scene, k).velocity[0] - cradle->expected[k]));
    scree_scene_destroy(scene);
    return status;
}

scree_status suite_cradle(struct figures *figures) {
    for (int c = 0; c < 2; c++)
        for (int exact = 0; exact < 2; exact++) {
            double worst = 0.0;
            scree_status status = cradle_error(figures, &cradles[c], exact, &worst);
            if (status) return status;
            char quantity[64];
            snprintf(quantity, sizeof quantity, "%s contacts, three speeds, %s", cradles[c].name,
                     exact ? "adaptive" : "pair impulses");
            /* Second order in the step, 500 in a contact; the table's twelve digits. */
            figures_report(figures, "cradle", quantity, 0.0, worst, exact ? 1e-11 : 1e-6);
        }
    return SCREE_OK;
}

/* The largest speed of the balls that the solitary wave passes, in parts of the first one's: 0.68163. */
scree_status suite_chain(struct figures *figures) {
    scree_scene *scene = row(figures, 100, "law = \"hertz\", stiffness = 1e6", 2e-5, "\"pair-impulse\"\nforce = true");
    if (!scene) return figures->trouble.status;
    double largest = 0.0, y[3] = {0.0};
    scree_status status = SCREE_OK;
    for (long n = 0; n < 40000 && !status; n++) {
        status = figures_step(figures, scene, 1);
        memmove(y, y + 1, 2 * sizeof *y);
        y[2] = scree_scene_body(scene, 60).velocity[0];
        if (y[1] > y[0] && y[1] >= y[2]) {
            double bend = y[0] - 2.0 * y[1] + y[2], rise = 0.5 * (y[2] - y[0]);
            largest = scree_most(largest, y[1] - 0.5 * rise * rise / bend);
        }
    }
    scree_scene_destroy(scene);
    if (!status) figures_report(figures, "chain", "largest speed of ball 61 of 100", 0.68163, largest, 1e-5);
    return status;
}

/* Overlap under each of ten spheres: (n m g/K)^(2/3), after they have been dropped onto each other. */
scree_status suite_stack(struct figures *figures) {
    char text[8192];
    int n = snprintf(
        text, sizeof text,
        "gravity = [0, 0, -9.81]\n[time]\nend = 1000\nspeed = 0.1\n" HEAD
        "[[contact]]\nbetween = [\"m\", \"w\"]\nnormal = { law = \"tsuji-cut\", stiffness = 1e6, restitution = 0.1 }\n"
        "[[contact]]\nbetween = [\"m\", \"m\"]\nnormal = { law = \"tsuji-cut\", stiffness = 1e6, restitution = 0.1 "
        "}\n");
    for (int k = 0; k < 10; k++)
        n += snprintf(text + n, sizeof text - (size_t)n,
                      "[[body]]\nname = \"%d\"\nshape = { sphere = 0.01 }\nmaterial = \"m\"\nmass = 0.01\nposition = "
                      "[0, 0, %.17g]\n",
                      k, 0.01 + 0.02 * k);
    scree_scene *scene = figures_scene_text(figures, text);
    if (!scene) return figures->trouble.status;
    scree_status status = figures_step(figures, scene, lround(20.0 / scree_scene_step_length(scene)));
    double worst = 0.0, speed = 0.0;
    for (int k = 0; k < 10 && !status; k++) {
        double below = k ? scree_scene_body(scene, k).position[2] : -0.01,
               z = scree_scene_body(scene, k + 1).position[2];
        double overlap = 0.02 - (z - below), expected = pow((10 - k) * 0.01 * gravity / 1e6, 2.0 / 3.0);
        worst = scree_most(worst, fabs(overlap / expected - 1.0));
        speed = scree_most(speed, fabs(scree_scene_body(scene, k + 1).velocity[2]));
    }
    scree_scene_destroy(scene);
    /* Heights of 0.2 m are held to 2.8e-17 m, which is 1e-11 of the overlaps. */
    if (!status)
        figures_report(figures, "stack", "overlaps under ten spheres, worst relative error", 0.0, worst, 1e-10);
    if (!status) figures_report(figures, "stack", "fastest motion after 20 s (m/s)", 0.0, speed, 1e-12);
    return status;
}

/* A box of 0.1 m x 0.2 m x 0.3 m turns freely: spin in its own axes and attitude after 20 s, twelve turns, to 15 digits
 * (Jacobi's elliptic functions; data/reference/torque_free_top.csv). About its middle axis it flips over again and
 * again, which multiplies rounding by 1e8. */
scree_status suite_top(struct figures *figures) {
    static const struct {
        const char *quantity, *spin;
        double w[3], q[4], bound;
    } tops[] = {{"spin and attitude after 20 s",
                 "1, 2, 3",
                 {-0.523780028901695, -2.34720287175041, 2.80499180197286},
                 {-0.0750559492305227, -0.0987465899270472, 0.0672012690134506, -0.989999850962548},
                 1e-11},
                {"the same, about the middle axis",
                 "0.01, 5, 0.01",
                 {0.0429148853609997, -4.99963771589883, -0.0530757225240928},
                 {-0.00241363519974475, -0.999266502410429, -0.00415612984510978, -0.0379915531435783},
                 5e-8}};
    for (int k = 0; k < 2; k++) {
        char text[512];
        snprintf(text, sizeof text,
                 "[time]\nend = 20\nstep = 0.5\nintegrator = \"adaptive\"\ntolerance = 1e-13\n[output]\nwrite = []\n"
                 "[[material]]\nname = \"m\"\ndensity = 1000\n"
                 "[[body]]\nname = \"top\"\nmaterial = \"m\"\nshape = { box = [0.1, 0.2, 0.3] }\nspin = [%s]\n",
                 tops[k].spin);
        scree_scene *scene = figures_scene_text(figures, text);
        if (!scene) return figures->trouble.status;
        scree_status status = figures_step(figures, scene, 40);
        scree_body_state top = scree_scene_body(scene, 0);
        scree_scene_destroy(scene);
        if (status) return status;
        struct mat frame = quat_to_mat(quat_from(top.orientation));
        struct vec w = mat_undo(&frame, vec_from(top.spin));
        const double got[3] = {w.x, w.y, w.z}, *q = tops[k].q;
        double along = 0.0, worst = 0.0;
        for (int i = 0; i < 4; i++) along += top.orientation[i] * q[i];
        for (int i = 0; i < 3; i++) worst = scree_most(worst, fabs(got[i] - tops[k].w[i]));
        for (int i = 0; i < 4; i++) worst = scree_most(worst, fabs(copysign(1.0, along) * top.orientation[i] - q[i]));
        figures_report(figures, "top", tops[k].quantity, 0.0, worst, tops[k].bound);
    }
    return SCREE_OK;
}

/* Restitution of a viscoelastic sphere over b = 3/2 A (K/m)^(2/5) v^(1/5), the one number that it depends on: here K =
 * m = v = 1 (data/reference/restitution_viscoelastic_kuwabara_kono.csv, contacts that end with the force). */
scree_status suite_viscoelastic(struct figures *figures) {
    static const double table[][2] = {{0.001, 0.998847357304096}, {0.01, 0.988547439642729}, {0.1, 0.892858875506553},
                                      {0.2, 0.800965468135765},   {0.5, 0.595251501135127},  {1.0, 0.393930603229873},
                                      {2.0, 0.211646054603643},   {5.0, 0.0688996576792389}};
    double worst = 0.0, coarse = 0.0;
    for (size_t k = 0; k < sizeof table / sizeof table[0]; k++)
        for (int exact = 0; exact < 2; exact++) {
            char text[1024];
            snprintf(text, sizeof text,
                     "[time]\nend = 20\nstep = %s\n[output]\nwrite = []\n[[material]]\nname = \"m\"\n"
                     "[[contact]]\nbetween = [\"m\", \"m\"]\n"
                     "normal = { law = \"kuwabara-kono-cut\", stiffness = 1, relaxation = %.17g }\n"
                     "[[body]]\nname = \"floor\"\nshape = { plane = true }\nmaterial = \"m\"\njoint = \"fixed\"\n"
                     "[[body]]\nname = \"ball\"\nshape = { sphere = 10 }\nmaterial = \"m\"\nmass = 1\n"
                     "position = [0, 0, 10.0001]\nvelocity = [0, 0, -1]\n",
                     exact ? "10\nintegrator = \"adaptive\"\ntolerance = 1e-12"
                           : "0.06436\nintegrator = \"pair-impulse\"",
                     table[k][0] / 1.5);
            scree_scene *scene = figures_scene_text(figures, text);
            if (!scene) return figures->trouble.status;
            scree_status status = figures_step(figures, scene, exact ? 1 : 155);
            double error = fabs(scree_scene_body(scene, 1).velocity[2] - table[k][1]);
            scree_scene_destroy(scene);
            if (status) return status;
            if (exact)
                worst = scree_most(worst, error);
            else
                coarse = scree_most(coarse, error);
        }
    figures_report(figures, "viscoelastic", "restitution, adaptive integrator, worst of 8", 0.0, worst, 1e-10);
    /* 50 steps in an elastic contact, which is 3.218 long. */
    figures_report(figures, "viscoelastic", "restitution, pair impulses, 50 steps, worst of 8", 0.0, coarse, 1e-5);
    return SCREE_OK;
}
