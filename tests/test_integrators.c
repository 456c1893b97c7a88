/* The fixed-step integrators: largest errors over phases of first touch with steps that don't divide the contact's duration
 * (whole numbers flatter: touch and release are then complementary), orders, rest, books, restart, threads.
 *
 * The bounds are those of prototypes of the method, as documented where they are used; they are met with room for laws that
 * are smooth inside the contact. "N" is the number of steps in the duration of the contact. */
#include "tests/scenes.h"

enum { PHASES = 64 };

static const char pair_impulse[] = "time.integrator=\"pair-impulse\"";

/* A scene with a step and an integrator. */
static scree_scene *scene_with(const char *text, double step, const char *integrator, int substeps) {
    char at[64], pieces[64];
    snprintf(at, sizeof at, "time.step=%.17g", step);
    snprintf(pieces, sizeof pieces, "time.substeps=%d", substeps);
    const char *changes[] = {at, integrator, pieces};
    return scene_from(text, changes, substeps ? 3 : integrator ? 2 : 1, 1);
}

static int touches(scree_scene *scene) {
    int count;
    CHECK(scree_scene_contacts(scene, NULL, 0, &count) == SCREE_OK);
    return count;
}

/* ---- two bodies ---- */

static const char ball_on_wall[] =
    "[time]\nend = 1.0\nforce = true\n[[material]]\nname = \"ball\"\n[[material]]\nname = \"wall\"\n"
    "[[body]]\nname = \"wall\"\nshape = { plane = true }\nmaterial = \"wall\"\njoint = \"fixed\"\n"
    "[[body]]\nname = \"ball\"\nshape = { sphere = 0.01 }\nmaterial = \"ball\"\nmass = 0.03\n"
    "position = [0, 0, 0.0105]\nvelocity = [0, 0, -1]\n"
    "[[contact]]\nbetween = [\"ball\", \"wall\"]\n";

struct binary {
    const char *law;
    double restitution;
    double order; /* that theory promises for the rms over the phases; 0: not looked at */
};

static double rebound(const char *law, double step, long *touching) {
    char text[1024];
    snprintf(text, sizeof text, "%snormal = { %s }\n", ball_on_wall, law);
    scree_scene *scene = scene_with(text, step, pair_impulse, 0);
    *touching = 0;
    for (int met = 0; scree_scene_steps(scene) < 100000; met |= touches(scene) > 0) {
        go(scene, 1);
        *touching += touches(scene);
        if (met && touches(scene) == 0) break;
    }
    go(scene, 2);
    double speed = state_of(scene, "ball").velocity[2];
    scree_scene_destroy(scene);
    return speed;
}

struct spread {
    double largest, rms;
};

static struct spread spread_of(const struct binary *b, double duration, double n) {
    struct spread spread = {0.0, 0.0};
    for (int phase = 0; phase < PHASES; phase++) {
        long ignored;
        double step = duration / (n - 0.5 + (phase + 0.5) / PHASES);
        double error = fabs(rebound(b->law, step, &ignored) - b->restitution);
        spread.largest = fmax(spread.largest, error);
        spread.rms += error * error / PHASES;
    }
    spread.rms = sqrt(spread.rms);
    return spread;
}

static void test_binary(void) {
    static const struct binary cases[] = {
        {"law=\"linear\", stiffness=1e5, damping=0.0", 1.0, 5.0},
        {"law=\"linear\", stiffness=1e5, restitution=0.5", 0.5, 4.0},
        {"law=\"linear-cut\", stiffness=1e5, restitution=0.5", 0.5, 4.0},
        {"law=\"linear-loading\", stiffness=1e5, restitution=0.5", 0.5, 4.0},
        {"law=\"hunt-crossley\", stiffness=1e5, exponent=1.0, restitution=0.5, speed=1.0", 0.5, 0.0},
        {"law=\"hunt-crossley\", stiffness=5e6, restitution=0.5, speed=1.0", 0.5, 2.5},
        {"law=\"hertz\", stiffness=5e6", 1.0, 2.5},
        {"law=\"tsuji\", stiffness=5e6, restitution=0.5", 0.5, 0.0},
        {"law=\"tsuji-cut\", stiffness=5e6, restitution=0.5", 0.5, 0.0},
        {"law=\"kuwabara-kono\", stiffness=5e6, restitution=0.5, speed=1.0", 0.5, 4.0},
        {"law=\"kuwabara-kono-cut\", stiffness=5e6, restitution=0.5, speed=1.0", 0.5, 4.0},
    };
    for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++) {
        long touching;
        rebound(cases[k].law, 1e-6, &touching);
        double duration = 1e-6 * (double)touching;
        struct spread at20 = spread_of(&cases[k], duration, 20.0), at50 = spread_of(&cases[k], duration, 50.0);
        struct spread at200 = spread_of(&cases[k], duration, 200.0);
        double order = log(at50.rms / at200.rms) / log(4.0);
        printf("  %-80.80s T %.3g  %.2e %.2e order %.2f\n", cases[k].law, duration, at20.largest, at50.largest, order);
        NEAR(at20.largest, 0.0, 3e-5);
        NEAR(at50.largest, 0.0, 3e-6);
        if (cases[k].order > 0.0) NEAR(order, cases[k].order, 0.2);
    }
}

/* ---- rows of spheres ---- */

/* `count` spheres of 1 kg in a row, just touching; the first arrives at 1 m/s from `gap` away. */
static scree_scene *row_of(int count, const char *law, double gap, double step, const char *integrator) {
    static char text[4096];
    int n = snprintf(text, sizeof text,
                     "[time]\nend = 10.0\nforce = true\n[[material]]\nname = \"m\"\n[[contact]]\nbetween = [\"m\", "
                     "\"m\"]\nnormal = { %s }\n",
                     law);
    for (int k = 0; k < count; k++)
        n += snprintf(text + n, sizeof text - (size_t)n,
                      "[[body]]\nname = \"%d\"\nshape = { sphere = 0.5 }\nmaterial = \"m\"\nmass = 1.0\nposition = "
                      "[%.17g, 0, 0]\nvelocity = [%d, 0, 0]\n",
                      k + 1, k ? (double)k : -gap, k == 0);
    return scene_with(text, step, integrator, 0);
}

/* Velocities at the end of the row's impacts. */
static void run_row(int count, const char *law, double phase, double step, const char *integrator, double *speed) {
    scree_scene *scene = row_of(count, law, phase * step, step, integrator);
    long most = (long)(0.1 / step) + 10;
    while (scree_scene_steps(scene) < most) go(scene, 1);
    CHECK(touches(scene) == 0);
    for (int k = 0; k < count; k++) speed[k] = scree_scene_body(scene, k).velocity[0];
    scree_scene_destroy(scene);
}

static double worst_row(int count, const char *law, double duration, double n, const double *reference) {
    double worst = 0.0, speed[5];
    for (int phase = 0; phase < PHASES; phase++) {
        double part = (phase + 0.5) / PHASES, step = duration / (n - 0.5 + part);
        run_row(count, law, fmod(7.3 * part, 1.0), step, pair_impulse, speed);
        for (int k = 0; k < count; k++) worst = fmax(worst, fabs(speed[k] - reference[k]));
    }
    return worst;
}

/* The bounds are twice the prototype's 1.9e-4 and 3.2e-4 at N = 20: 3.5e-4, and 4e-5 at N = 50. */
static void test_rows(void) {
    static const struct {
        const char *law;
        double duration; /* of a contact of two, pi sqrt(m/k) or what corresponds, s */
    } cases[] = {
        {"law=\"linear-cut\", stiffness=1e6, restitution=0.5", 2.2214e-3},
        {"law=\"linear\", stiffness=1e6, restitution=0.5", 2.2214e-3},
        {"law=\"tsuji-cut\", stiffness=1e8, restitution=0.5", 2.3e-3},
        {"law=\"hunt-crossley\", stiffness=1e8, restitution=0.5, speed=1.0", 2.3e-3},
        {"law=\"kuwabara-kono-cut\", stiffness=1e8, restitution=0.5, speed=1.0", 2.3e-3},
    };
    for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++) {
        double fine[3], other[3], step = cases[k].duration / 4000.0;
        run_row(3, cases[k].law, 0.3, step, pair_impulse, fine);
        run_row(3, cases[k].law, 0.3, step, NULL, other); /* an independent method */
        double at20 = worst_row(3, cases[k].law, cases[k].duration, 20.0, fine);
        double at50 = worst_row(3, cases[k].law, cases[k].duration, 50.0, fine);
        printf("  row %-70.70s %.2e %.2e  (%g %g %g; verlet differs %.2g)\n", cases[k].law, at20, at50, fine[0], fine[1],
               fine[2], fabs(other[0] - fine[0]));
        NEAR(at20, 0.0, 3.5e-4);
        NEAR(at50, 0.0, 4e-5);
        for (int b = 0; b < 3; b++) NEAR(other[b], fine[b], 2e-6);
    }
}

static void test_cradle(void) {
    struct check_table *table = check_read("newtons_cradle.csv");
    static const char *const columns[] = {"v1", "v2", "v3", "v4", "v5"};
    for (int row = 0; row < table->rows; row++) {
        double p = check_number(table, row, "p"), reference[5];
        int count = (int)check_number(table, row, "N");
        if (p == 2.0 || count == 2 || count == 4) continue;
        for (int k = 0; k < count; k++) reference[k] = check_number(table, row, columns[k]);
        const char *law = p == 1.0 ? "law=\"linear\", stiffness=1e6, damping=0.0" : "law=\"hertz\", stiffness=1e8";
        double duration = p == 1.0 ? 2.2214e-3 : 2.0e-3;
        double at20 = worst_row(count, law, duration, 20.0, reference);
        double at50 = worst_row(count, law, duration, 50.0, reference);
        printf("  cradle p %g N %d: %.2e %.2e\n", p, count, at20, at50);
        NEAR(at20, 0.0, 3.5e-4);
        NEAR(at50, 0.0, 4e-5);
    }
    free(table);
}

/* ---- oblique impacts ---- */

static void strike(double degrees, const char *laws, double step, double phase, const char *integrator, int substeps,
                   double *velocity) {
    char text[2048];
    double angle = degrees * 3.14159265358979323846 / 180.0;
    snprintf(text, sizeof text,
             "[time]\nend = 1.0\nforce = true\n[[material]]\nname = \"ball\"\n[[material]]\nname = \"wall\"\n"
             "[[body]]\nname = \"wall\"\nshape = { plane = true }\nmaterial = \"wall\"\njoint = \"fixed\"\n"
             "[[body]]\nname = \"ball\"\nshape = { sphere = 0.01 }\nmaterial = \"ball\"\nmass = 0.03\n"
             "position = [0, 0, %.17g]\nvelocity = [%.17g, 0, %.17g]\n[[contact]]\nbetween = [\"ball\", "
             "\"wall\"]\n%s\n",
             0.01 + phase * step * cos(angle), sin(angle), -cos(angle), laws);
    scree_scene *scene = scene_with(text, step, integrator, substeps);
    long most = (long)(6e-3 / step) + 10;
    while (scree_scene_steps(scene) < most) go(scene, 1);
    CHECK(touches(scene) == 0);
    scree_body_state state = state_of(scene, "ball");
    velocity[0] = state.velocity[2];
    velocity[1] = state.velocity[0] - 0.01 * state.spin[1]; /* at the contact */
    scree_scene_destroy(scene);
}

/* Bounds: those of the prototype's worst law, 1.6e-3 and 2.4e-4 with two substeps, 4.3e-4 and 6.6e-5 with four. */
static void test_oblique(void) {
    static const struct {
        const char *laws;
        double duration;
    } cases[] = {
        {"normal = { law=\"linear-cut\", stiffness=1e5, restitution=0.5 }\nfriction = { law=\"coulomb\", static=0.3, "
         "kinetic=0.3, stiffness=8e4 }",
         1.72072e-3},
        {"normal = { law=\"tsuji-cut\", stiffness=5e6, restitution=0.5 }\nfriction = { law=\"coulomb\", static=0.3, "
         "kinetic=0.3, stiffness=8e4 }",
         1.7e-3},
    };
    for (size_t c = 0; c < sizeof cases / sizeof cases[0]; c++) {
        double worst[2][2] = {{0.0}}; /* substeps 2 and 4; N = 20 and 50 */
        for (int degrees = 5; degrees <= 60; degrees += 5) {
            double fine[2], other[2], v[2], small = cases[c].duration / 4000.0;
            strike(degrees, cases[c].laws, small, 0.3, pair_impulse, 4, fine);
            strike(degrees, cases[c].laws, small, 0.3, NULL, 0, other);
            /* Verlet's memory lags by half a step where friction slides: first order */
            NEAR(other[0], fine[0], 2e-6);
            NEAR(other[1], fine[1], 2e-4);
            for (int phase = 0; phase < 16; phase++)
                for (int s = 0; s < 2; s++)
                    for (int n = 0; n < 2; n++) {
                        double part = (phase + 0.5) / 16.0, step = cases[c].duration / ((n ? 50.0 : 20.0) - 0.5 + part);
                        strike(degrees, cases[c].laws, step, fmod(7.3 * part, 1.0), pair_impulse, s ? 4 : 0, v);
                        double error = fmax(fabs(v[0] - fine[0]), fabs(v[1] - fine[1]));
                        worst[s][n] = fmax(worst[s][n], error);
                    }
        }
        printf("  oblique %.40s: x2 %.2e %.2e  x4 %.2e %.2e\n", cases[c].laws, worst[0][0], worst[0][1], worst[1][0],
               worst[1][1]);
        NEAR(worst[0][0], 0.0, 1.6e-3);
        NEAR(worst[0][1], 0.0, 2.5e-4);
        NEAR(worst[1][0], 0.0, 5e-4);
        NEAR(worst[1][1], 0.0, 7e-5);
    }
}

int main(void) {
    test_binary();
    test_rows();
    test_cradle();
    test_oblique();
    return check_report();
}
