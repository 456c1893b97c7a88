/* The verification cases DEM01 to DEM05 of MFiX-DEM (Garg et al., MFIX-DEM documentation 2012-1), against exact
 * solutions. */
#include "engine/cli/figures.h"

#include <math.h>

static const double gravity = 9.80665, pi = 3.14159265358979323846;

/* ---- a sphere on a linear spring and dashpot, under gravity all the while: exact ---- */

struct fall {
    double stiffness, damping, mass; /* N/m, N s/m, kg */
    int cut;                         /* contact ends where the force does, not where the overlap does */
};

struct rebound {
    double time;    /* s since the touch */
    double overlap; /* m, at the end */
    double speed;   /* m/s upwards */
};

/* Overlap x and its rate after the time t: x = g/w^2 + exp(-z w t)(A cos q t + B sin q t), x(0) = 0, x'(0) = speed. */
static void overlap_at(const struct fall *f, double speed, double t, double *x, double *rate) {
    double w = sqrt(f->stiffness / f->mass), z = f->damping / (2.0 * sqrt(f->stiffness * f->mass));
    double q = w * sqrt(1.0 - z * z), rest = gravity / (w * w), a = -rest, b = (speed + z * w * a) / q;
    double decay = exp(-z * w * t), c = cos(q * t), s = sin(q * t);
    *x = rest + decay * (a * c + b * s);
    *rate = decay * ((q * b - z * w * a) * c - (q * a + z * w * b) * s);
}

static double holds(const struct fall *f, double speed, double t) {
    double x, rate;
    overlap_at(f, speed, t, &x, &rate);
    return f->cut ? f->stiffness * x + f->damping * rate : x;
}

static struct rebound exact_rebound(const struct fall *f, double speed) {
    double part = pi / sqrt(f->stiffness / f->mass) / 1000.0, low = part, high, rate;
    while (holds(f, speed, low + part) > 0.0) low += part;
    high = low + part;
    for (int k = 0; k < 60; k++) {
        double middle = 0.5 * (low + high);
        *(holds(f, speed, middle) > 0.0 ? &low : &high) = middle;
    }
    struct rebound r = {.time = low};
    overlap_at(f, speed, low, &r.overlap, &rate);
    r.speed = -rate;
    return r;
}

/* Height of the next apex above the point of touch. */
static double exact_apex(const struct fall *f, double speed) {
    struct rebound r = exact_rebound(f, speed);
    return r.speed * r.speed / (2.0 * gravity) - r.overlap;
}

/* Height of the centre above the floor at a time before the second touch. */
static double exact_height(const struct fall *f, double start, double radius, double time) {
    double fallen = sqrt(2.0 * (start - radius) / gravity), speed = gravity * fallen, since = time - fallen, x, rate;
    struct rebound r = exact_rebound(f, speed);
    if (since <= 0.0) return start - 0.5 * gravity * time * time;
    overlap_at(f, speed, since, &x, &rate);
    if (since <= r.time) return radius - x;
    since -= r.time;
    return radius - r.overlap + r.speed * since - 0.5 * gravity * since * since;
}

/* ---- the same in the engine ---- */

static const double radius = 0.1, height = 0.5;

static double sphere_mass(void) { return 4.0 / 3.0 * pi * radius * radius * radius * 2600.0; }

static struct fall make_fall(double stiffness, double restitution, int cut) {
    double lost = log(restitution), z = -lost / sqrt(pi * pi + lost * lost), mass = sphere_mass();
    return (struct fall){stiffness, 2.0 * z * sqrt(stiffness * mass), mass, cut};
}

static scree_scene *falling_sphere(struct figures *figures, const struct fall *f) {
    char text[1024];
    snprintf(
        text, sizeof text,
        "gravity = [0, 0, -%.17g]\n[time]\nend = 100\n[output]\nwrite = []\n"
        "[[material]]\nname = \"m\"\n[[contact]]\nbetween = [\"m\", \"m\"]\n"
        "normal = { law = \"%s\", stiffness = %.17g, damping = %.17g }\n"
        "[[body]]\nname = \"floor\"\nshape = { plane = true }\nmaterial = \"m\"\njoint = \"fixed\"\n"
        "[[body]]\nname = \"ball\"\nshape = { sphere = %g }\nmaterial = \"m\"\nmass = %.17g\nposition = [0, 0, %g]\n",
        gravity, f->cut ? "linear-cut" : "linear", f->stiffness, f->damping, radius, f->mass, height);
    return figures_scene_text(figures, text);
}

/* Go on until the ball has met the floor and left it again: speed and time of the moment at which it left. */
static scree_status bounce(struct figures *figures, scree_scene *scene, scree_body_state *after) {
    int met = 0;
    for (long n = 0; n < 100000000; n++) {
        int touches = 0;
        scree_status status = figures_step(figures, scene, 1);
        if (!status) status = scree_scene_contacts(scene, NULL, 0, &touches);
        if (status) return status;
        met |= touches > 0;
        *after = scree_scene_body(scene, 1);
        if (met && !touches && after->velocity[2] > 0.0) return SCREE_OK;
    }
    return SCREE_OK;
}

/* Largest error of the height in the first half second, over the height. */
static scree_status height_error(struct figures *figures, const struct fall *f, double *worst) {
    scree_scene *scene = falling_sphere(figures, f);
    if (!scene) return figures->trouble.status;
    scree_status status = SCREE_OK;
    while (scree_scene_time(scene) < 0.5 && !status) {
        status = figures_step(figures, scene, 1);
        double exact = exact_height(f, height, radius, scree_scene_time(scene));
        *worst = scree_most(*worst, fabs(scree_scene_body(scene, 1).position[2] / exact - 1.0));
    }
    scree_scene_destroy(scene);
    return status;
}

static double apex_after(const scree_body_state *state) {
    return state->position[2] - radius + state->velocity[2] * state->velocity[2] / (2.0 * gravity);
}

/* The step is 1/50 of a contact, or less: a lone contact is right to (pi/50)^4/120 of itself, 1e-7, ten times that
 * where gravity and a long contact share. MFiX has 1e4 and 2.5e4 N/m as well, where the sphere sinks in by more than
 * half its radius. */
scree_status suite_dem01(struct figures *figures) {
    static const double stiffness[] = {5e4, 1e5}, restitution[] = {0.9999999, 0.9, 0.8, 0.7, 0.6};
    double worst[2] = {0.0}, late[2] = {0.0}, place = 0.0;
    for (int cut = 0; cut < 2; cut++)
        for (int k = 0; k < 2; k++)
            for (int e = 0; e < 5; e++) {
                struct fall f = make_fall(stiffness[k], restitution[e], cut);
                scree_scene *scene = falling_sphere(figures, &f);
                scree_body_state after;
                if (!scene) return figures->trouble.status;
                scree_status status = bounce(figures, scene, &after);
                double time = scree_scene_time(scene);
                scree_scene_destroy(scene);
                if (!status) status = height_error(figures, &f, &place);
                if (status) return status;
                double fallen = sqrt(2.0 * (height - radius) / gravity), speed = gravity * fallen;
                struct rebound exact = exact_rebound(&f, speed);
                worst[cut] = scree_most(worst[cut], fabs(apex_after(&after) / exact_apex(&f, speed) - 1.0));
                double left = sqrt(after.velocity[2] * after.velocity[2] +
                                   2.0 * gravity * (after.position[2] - radius + exact.overlap));
                double when = time - (left - after.velocity[2]) / gravity;
                late[cut] = scree_most(late[cut], fabs(when / (fallen + exact.time) - 1.0));
            }
    figures_report(figures, "dem01", "height all through 0.5 s, worst of 20 runs (MFiX 3.2e-4 to 1.2e-1)", 0.0, place,
                   3.2e-6);
    figures_report(figures, "dem01", "next apex, worst of 10 relative errors (MFiX 3.2e-4)", 0.0, worst[0], 3e-6);
    figures_report(figures, "dem01", "end of contact, worst of 10 (s/s)", 0.0, late[0], 3e-6);
    figures_report(figures, "dem01", "next apex, contact without tension", 0.0, worst[1], 3e-6);
    figures_report(figures, "dem01", "end of contact without tension (s/s)", 0.0, late[1], 3e-6);
    return SCREE_OK;
}

/* The apex after 16 bounces without loss, less the first. */
static scree_status drift(struct figures *figures, double stiffness, double *worst) {
    struct fall f = make_fall(stiffness, 1.0, 0);
    scree_scene *scene = falling_sphere(figures, &f);
    if (!scene) return figures->trouble.status;
    scree_status status = SCREE_OK;
    scree_body_state after = {.position = {0.0}};
    for (int n = 0; n < 16 && !status; n++) status = bounce(figures, scene, &after);
    scree_scene_destroy(scene);
    *worst = scree_most(*worst, fabs(apex_after(&after) / (height - radius) - 1.0));
    return status;
}

/* Ten apexes; the errors of ten impacts add up, and what the first ones have wrong the later ones start from. */
scree_status suite_dem02(struct figures *figures) {
    static const double stiffness[] = {5e4, 5e5, 5e6}, restitution[] = {0.9999999, 0.9, 0.8, 0.7, 0.6};
    double worst = 0.0, rigid = 0.0, drifted = 0.0;
    for (int k = 0; k < 3; k++) {
        scree_status drifts = drift(figures, stiffness[k], &drifted);
        if (drifts) return drifts;
        for (int e = 0; e < 5; e++) {
            struct fall f = make_fall(stiffness[k], restitution[e], 0);
            scree_scene *scene = falling_sphere(figures, &f);
            if (!scene) return figures->trouble.status;
            double apex = height - radius, hard = apex;
            scree_status status = SCREE_OK;
            /* Lower bounces don't leave a soft floor any more. */
            for (int n = 0; n < 10 && apex > 10.0 * f.mass * gravity / f.stiffness && !status; n++) {
                scree_body_state after;
                status = bounce(figures, scene, &after);
                apex = exact_apex(&f, sqrt(2.0 * gravity * apex));
                hard *= restitution[e] * restitution[e];
                worst = scree_most(worst, fabs(apex_after(&after) - apex) / height);
                if (k == 2 && n == 0) rigid = scree_most(rigid, fabs(apex_after(&after) - hard) / (radius + hard));
            }
            scree_scene_destroy(scene);
            if (status) return status;
        }
    }
    figures_report(figures, "dem02", "apex after 16 bounces without loss, worst of 3 (MFiX 9e-4)", 0.0, drifted, 9e-6);
    figures_report(figures, "dem02", "apexes 1 to 10 less exact, worst of 15 runs, over the drop", 0.0, worst, 1e-5);
    /* Soft contacts aren't rigid: they are longer and carry the weight meanwhile. MFiX differs as much. */
    figures_report(figures, "dem02", "first apex less that of rigid bodies, 5e6 N/m (MFiX 1.1e-2)", 0.0, rigid, 1.1e-2);
    return SCREE_OK;
}

/* ---- DEM03: linear while all contacts stay closed, so small Runge-Kutta steps are exact to rounding ---- */

struct press {
    double mass[2], damping[3];
};

static void press_rate(const struct press *p, const double y[4], double rate[4]) {
    static const double r = 5e-4, top = 1.8e-3, k = 1000.0;
    double floor = k * (r - y[0]) - p->damping[0] * y[2];
    double pair = k * (2.0 * r - (y[1] - y[0])) - p->damping[1] * (y[3] - y[2]);
    double roof = k * (r - (top - y[1])) + p->damping[2] * y[3];
    rate[0] = y[2];
    rate[1] = y[3];
    rate[2] = (floor - pair) / p->mass[0] - gravity;
    rate[3] = (pair - roof) / p->mass[1] - gravity;
}

static void press_exactly(const struct press *p, double time, double y[4]) {
    enum { STEPS = 20000 };
    double h = time / STEPS, k[4][4], at[4];
    for (int n = 0; n < STEPS; n++) {
        for (int stage = 0; stage < 4; stage++) {
            double part = stage == 0 ? 0.0 : stage == 3 ? h : 0.5 * h;
            for (int i = 0; i < 4; i++) at[i] = y[i] + (stage ? part * k[stage - 1][i] : 0.0);
            press_rate(p, at, k[stage]);
        }
        for (int i = 0; i < 4; i++) y[i] += h / 6.0 * (k[0][i] + 2.0 * k[1][i] + 2.0 * k[2][i] + k[3][i]);
    }
}

/* Ten thousandths of a second, five swings. Coupled contacts are of second order at a fiftieth of the shortest. */
scree_status suite_dem03(struct figures *figures) {
    double worst[2] = {0.0};
    for (double e = 1.0; e > 0.55; e -= 0.1) {
        double volume = 4.0 / 3.0 * pi * 1.25e-10, lost = e < 1.0 ? -log(e) : 0.0,
               z = lost / sqrt(pi * pi + lost * lost);
        struct press p = {.mass = {20000.0 * volume, 10000.0 * volume}};
        double pair_mass = p.mass[0] * p.mass[1] / (p.mass[0] + p.mass[1]);
        double masses[3] = {p.mass[0], pair_mass, p.mass[1]}, y[4] = {4.5e-4, 1.35e-3, 0.0, 0.0};
        char text[2048];
        int n = snprintf(text, sizeof text,
                         "gravity = [0, 0, -%.17g]\n[time]\nend = 1\n[output]\nwrite = []\n"
                         "[[material]]\nname = \"w\"\n[[material]]\nname = \"a\"\n[[material]]\nname = \"b\"\n"
                         "[[contact]]\nbetween = [\"w\", \"w\"]\nnone = true\n",
                         gravity);
        static const char *const between[3] = {"\"w\", \"a\"", "\"a\", \"b\"", "\"w\", \"b\""};
        for (int c = 0; c < 3; c++) {
            p.damping[c] = 2.0 * z * sqrt(1000.0 * masses[c]);
            n += snprintf(
                text + n, sizeof text - (size_t)n,
                "[[contact]]\nbetween = [%s]\nnormal = { law = \"linear\", stiffness = 1000, damping = %.17g }\n",
                between[c], p.damping[c]);
        }
        snprintf(text + n, sizeof text - (size_t)n,
                 "[[body]]\nname = \"floor\"\nshape = { plane = true }\nmaterial = \"w\"\njoint = \"fixed\"\n"
                 "[[body]]\nname = \"roof\"\nshape = { plane = true }\nmaterial = \"w\"\njoint = \"fixed\"\n"
                 "position = [0, 0, 0.0018]\norientation = [0, 1, 0, 0]\n"
                 "[[body]]\nname = \"lower\"\nshape = { sphere = 5e-4 }\nmaterial = \"a\"\nmass = %.17g\nposition = "
                 "[0, 0, %.17g]\n"
                 "[[body]]\nname = \"upper\"\nshape = { sphere = 5e-4 }\nmaterial = \"b\"\nmass = %.17g\nposition = "
                 "[0, 0, %.17g]\n",
                 p.mass[0], y[0], p.mass[1], y[1]);
        scree_scene *scene = figures_scene_text(figures, text);
        if (!scene) return figures->trouble.status;
        scree_status status = SCREE_OK;
        for (int k = 0; k < 10 && !status; k++) {
            double time = scree_scene_time(scene);
            status = figures_step(figures, scene, lround(1e-4 / scree_scene_step_length(scene)));
            press_exactly(&p, scree_scene_time(scene) - time, y);
            for (int b = 0; b < 2; b++)
                worst[b] = scree_most(worst[b], fabs(scree_scene_body(scene, 2 + b).position[2] / y[b] - 1.0));
        }
        scree_scene_destroy(scene);
        if (status) return status;
    }
    figures_report(figures, "dem03", "height of the lower, worst of 50 (MFiX 2.7e-4)", 0.0, worst[0], 2.7e-6);
    figures_report(figures, "dem03", "height of the upper, worst of 50 (MFiX 8.7e-4)", 0.0, worst[1], 8.7e-6);
    return SCREE_OK;
}

/* ---- DEM04 ---- */

/* The lever is shorter than the radius by half the overlap under the weight, 1e-5 of it, and friction's spring takes
 * mu m g/k_t = 5e-10 m of way before it holds what it should, 1.2e-5 of the way that the time of slipping is taken
 * from. */
scree_status suite_dem04(struct figures *figures) {
    double speed = 0.0, spin = 0.0, slip = 0.0;
    for (double mu = 0.2; mu < 1.05; mu += 0.1) {
        double r = 5e-4, u0 = 0.1, mass = 4.0 / 3.0 * pi * r * r * r * 1e4, sunk = mass * gravity / 1e4;
        char text[1024];
        snprintf(text, sizeof text,
                 "gravity = [0, 0, -%.17g]\n[time]\nend = 1\n[output]\nwrite = []\n"
                 "[[material]]\nname = \"m\"\n[[contact]]\nbetween = [\"m\", \"m\"]\n"
                 "normal = { law = \"linear-cut\", stiffness = 1e4, restitution = 0.5 }\n"
                 "friction = { law = \"coulomb\", static = %.17g, kinetic = %.17g, stiffness = 1e5, damping = 0.15 }\n"
                 "[[body]]\nname = \"floor\"\nshape = { plane = true }\nmaterial = \"m\"\njoint = \"fixed\"\n"
                 "[[body]]\nname = \"ball\"\nshape = { sphere = 5e-4 }\nmaterial = \"m\"\nmass = %.17g\n"
                 "position = [0, 0, %.17g]\nvelocity = [0.1, 0, 0]\n",
                 gravity, mu, mu, mass, r - sunk);
        scree_scene *scene = figures_scene_text(figures, text);
        if (!scene) return figures->trouble.status;
        scree_status status = figures_step(figures, scene, lround(0.02 / scree_scene_step_length(scene)));
        scree_body_state ball = scree_scene_body(scene, 1);
        double time = scree_scene_time(scene);
        scree_scene_destroy(scene);
        if (status) return status;
        speed = scree_most(speed, fabs(ball.velocity[0] / u0 - 5.0 / 7.0) * 7.0 / 5.0);
        spin = scree_most(spin, fabs(r * ball.spin[1] / u0 - 5.0 / 7.0) * 7.0 / 5.0);
        /* x = u (T - t_s) + 12 u0^2/(49 mu g) with t_s = 2 u0/(7 mu g). */
        double end = 2.0 * u0 * u0 / (49.0 * gravity * (ball.position[0] - ball.velocity[0] * time)) / mu;
        slip = scree_most(slip, fabs(end - 1.0));
    }
    figures_report(figures, "dem04", "speed while rolling, worst of 9 (MFiX 4.2e-4)", 0.0, speed, 4.2e-6);
    figures_report(figures, "dem04", "spin while rolling, worst of 9 (MFiX 4.2e-4)", 0.0, spin, 4.2e-6);
    figures_report(figures, "dem04", "time of slipping, worst of 9 (MFiX 5.7e-3)", 0.0, slip, 5.7e-5);
    return SCREE_OK;
}

/* ---- DEM05 ---- */

/* Tangential restitution at 0.5 to 65 degrees, with 1 sticking and sliding, by Cundall & Strack's spring, to 40 digits
 * (data/reference/oblique_lsd_mfix_dem05.csv). */
static const double oblique[21][2] = {{0.5, 0.900117203141529},
                                      {1, 0.892621587590697},
                                      {2.5, 0.865116609951392},
                                      {5, 0.806424679203837},
                                      {7.5, 0.726164909438164},
                                      {10, 0.65181261886089},
                                      {12.5, 0.612249127252205},
                                      {15, 0.594091174097291},
                                      {17.5, 0.589128617026388},
                                      {20, 0.593121858588747},
                                      {22.5, 0.604106952002083},
                                      {25, 0.621716132816114},
                                      {27.5, 0.64750741702365},
                                      {30, 0.681302651407327},
                                      {35, 0.737220766759451},
                                      {40, 0.780717338962665},
                                      {45, 0.816},
                                      {50, 0.84560566786338},
                                      {55, 0.871161812969413},
                                      {60, 0.893767550469109},
                                      {65, 0.91419939089948}};

/* A ball of aluminium oxide, 3.9 m/s, springs of MFiX. */
static scree_status strike(struct figures *figures, double degrees, scree_body_state *ball) {
    double r = 2.5e-3, mu = 0.092, angle = degrees * pi / 180.0, vn = 3.9 * cos(angle), vt = 3.9 * sin(angle);
    char text[1024];
    snprintf(text, sizeof text,
             "[time]\nend = 1\nspeed = 3.9\n[output]\nwrite = []\n"
             "[[material]]\nname = \"m\"\ndensity = 4000\n[[contact]]\nbetween = [\"m\", \"m\"]\n"
             "normal = { law = \"linear\", stiffness = 1.72e11, damping = 0.0 }\n"
             "friction = { law = \"coulomb\", static = %g, kinetic = %g, stiffness = 1.48e11 }\n"
             "[[body]]\nname = \"floor\"\nshape = { plane = true }\nmaterial = \"m\"\njoint = \"fixed\"\n"
             "[[body]]\nname = \"ball\"\nshape = { sphere = %g }\nmaterial = \"m\"\nposition = [0, 0, %.17g]\n"
             "velocity = [%.17g, 0, %.17g]\n",
             mu, mu, r, r + 1e-9, vt, -vn);
    scree_scene *scene = figures_scene_text(figures, text);
    if (!scene) return figures->trouble.status;
    scree_status status = bounce(figures, scene, ball);
    scree_scene_destroy(scene);
    return status;
}

/* Where a sphere slides all along the contact: e_t = 1 - mu (1 + e)/tan(angle), R w = 5/2 mu (1 + e) v_n (Walton 1993).
 * The lever is shorter than R by half the overlap, sqrt(m/k) v_n/2 = 1e-5 R. */
scree_status suite_dem05(struct figures *figures) {
    static const double r = 2.5e-3, mu = 0.092;
    double tangential = 0.0, spin = 0.0, sticks = 0.0;
    scree_body_state ball;
    for (double degrees = 30.0; degrees < 86.0; degrees += 5.0) {
        scree_status status = strike(figures, degrees, &ball);
        if (status) return status;
        double angle = degrees * pi / 180.0, vn = 3.9 * cos(angle), vt = 3.9 * sin(angle);
        tangential = scree_most(tangential, fabs(ball.velocity[0] / vt / (1.0 - 2.0 * mu * vn / vt) - 1.0));
        spin = scree_most(spin, fabs(r * ball.spin[1] / (5.0 * mu * vn) - 1.0));
    }
    for (int k = 0; k < 21; k++) {
        scree_status status = strike(figures, oblique[k][0], &ball);
        if (status) return status;
        sticks = scree_most(sticks, fabs(ball.velocity[0] / (3.9 * sin(oblique[k][0] * pi / 180.0)) - oblique[k][1]));
    }
    figures_report(figures, "dem05", "tangential restitution, 30 to 85 deg, worst of 12 (MFiX 5e-3)", 0.0, tangential,
                   5e-5);
    figures_report(figures, "dem05", "spin, worst of 12 (MFiX 5e-3)", 0.0, spin, 5e-5);
    figures_report(figures, "dem05", "tangential restitution, 0.5 to 65 deg, worst of 21 (MFiX 5e-3)", 0.0, sticks,
                   5e-5);
    return SCREE_OK;
}
