/* The fixed-step integrators: largest errors over phases of first touch with steps that don't divide the contact's
 * duration (whole numbers flatter: touch and release are then complementary), orders, rest, books, restart, threads.
 *
 * The bounds are those of prototypes of the method, as documented where they are used; they are met with room for laws
 * that are smooth inside the contact. "N" is the number of steps in the duration of the contact. */
#include "contact/impact.h"
#include "tests/steps.h"

enum { PHASES = 64 };

/* ---- two bodies ---- */

struct binary {
    const char *law;
    double restitution;
    /* That theory promises for the rms over the phases: Runge-Kutta's, 4, and 5 where the elastic terms of that order
     * cancel. 0: the law isn't smooth where contact begins, errors are below 1e-6 and no single power. */
    double order;
};

static double rebound(const char *law, const char *integrator, double step, long *touching) {
    char text[1024];
    snprintf(text, sizeof text, "%snormal = { %s }\n", ball_on_wall, law);
    scree_scene *scene = scene_with(text, step, integrator, 0);
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

static struct spread spread_of(const struct binary *b, const char *integrator, double duration, double n) {
    struct spread spread = {0.0, 0.0};
    for (int phase = 0; phase < PHASES; phase++) {
        long ignored;
        double step = duration / (n - 0.5 + (phase + 0.5) / PHASES);
        double error = fabs(rebound(b->law, integrator, step, &ignored) - b->restitution);
        spread.largest = scree_most(spread.largest, error);
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
        {"law=\"hunt-crossley\", stiffness=5e6, restitution=0.5, speed=1.0", 0.5, 0.0},
        {"law=\"hertz\", stiffness=5e6", 1.0, 0.0},
        {"law=\"tsuji\", stiffness=5e6, restitution=0.5", 0.5, 0.0},
        {"law=\"tsuji-cut\", stiffness=5e6, restitution=0.5", 0.5, 0.0},
        {"law=\"kuwabara-kono\", stiffness=5e6, restitution=0.5, speed=1.0", 0.5, 0.0},
        {"law=\"kuwabara-kono-cut\", stiffness=5e6, restitution=0.5, speed=1.0", 0.5, 0.0},
    };
    for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++) {
        long touching;
        rebound(cases[k].law, pair_impulse, 1e-6, &touching);
        double duration = 1e-6 * (double)touching;
        struct spread at20 = spread_of(&cases[k], pair_impulse, duration, 20.0),
                      at50 = spread_of(&cases[k], pair_impulse, duration, 50.0);
        struct spread at200 = spread_of(&cases[k], pair_impulse, duration, 200.0);
        double order = log(at50.rms / at200.rms) / log(4.0);
        show("binary", cases[k].law, at20.largest, at50.largest);
        NEAR(at20.largest, 0.0, 3e-5);
        NEAR(at50.largest, 0.0, 3e-6);
        if (cases[k].order > 0.0) NEAR(order, cases[k].order, 0.2);
    }
}

/* What the integrator of impacts makes of a law, apart from any scene (1e-12). */
static struct scree_impact exactly(const char *law) {
    char text[1024];
    snprintf(text, sizeof text, "%snormal = { %s }\n", ball_on_wall, law);
    scree_scene *scene = scene_with(text, 1e-6, NULL, 0);
    const struct scree_rule *rule = &scene->contacts.rule[0];
    const struct scree_normal_law *normal = scree_normal_laws[rule->normal];
    struct scree_pair_constants pair = normal->pair(&rule->normal_constants, 0.03, 0.01);
    struct scree_impact impact = scree_impact(normal, &rule->normal_constants, pair, 0.03, 1.0, 0.0, NULL, NULL);
    scree_scene_destroy(scene);
    return impact;
}

/* The bounds of test_binary hold for every law of the catalogue, with its example, and where its formula changes inside
 * the contact. */
static void test_every_law(void) {
    static const char *const more[] = {
        "law=\"thornton\", modulus=1e8, yield=2e6",
        "law=\"thornton\", modulus=1e8, yield=6517944.039433037",
        "law=\"thornton\", modulus=1e8, yield=2e7", /* hardly yields */
        "law=\"walton-braun\", stiffness=1e5, restitution=0.5",
        "law=\"walton-braun-variable\", stiffness=1e5, slope=500.0",
        "law=\"jkr\", modulus=1e8, adhesion=1.0",
        "law=\"dmt\", modulus=1e8, adhesion=1.0",
        "law=\"table\", rows=[[0, 0], [1e-4, 2], [2e-4, 10], [3.5e-4, 40], [1e-3, 200]]",
        /* beyond whose end a dashpot that went on fading would drive the ball through the wall */
        ("law=\"table\", rows=[[0,-1,-10], [0,0,0], [0,1,10], [1e-4,-1,0], [1e-4,0,10], [1e-4,1,20], [2e-4,-1,15], "
         "[2e-4,0,20], [2e-4,1,25]]"),
        "law=\"impact\", stiffness=5e6, exponent=1.5, damping=30.0, full=1e-4",
        "law=\"blend\", stiffness=1e5, damping=65.4, full=4e-4",
    };
    int laws = 0, rows = (int)(sizeof more / sizeof more[0]);
    while (scree_normal_laws[laws]) laws++;
    for (int k = 0; k < laws + rows; k++) {
        char law[512];
        if (k < laws)
            snprintf(law, sizeof law, "law=\"%s\", %s", scree_normal_laws[k]->text.name,
                     scree_normal_laws[k]->text.example);
        else
            snprintf(law, sizeof law, "%s", more[k - laws]);
        struct scree_impact impact = exactly(law);
        struct binary b = {law, impact.restitution, 0.0};
        struct spread at20 = spread_of(&b, pair_impulse, impact.duration, 20.0),
                      at50 = spread_of(&b, pair_impulse, impact.duration, 50.0);
        show("every law", law, at20.largest, at50.largest);
        NEAR(at20.largest, 0.0, 3e-5);
        NEAR(at50.largest, 0.0, 3e-6);
    }
}

/* Verlet's method with laws that pull at once, so strongly that the pull, not the spring, makes the error: of second
 * order where the jump gets its share of the step, of order 3/2 where the force has an infinite slope (JKR lets go like
 * a root); without shares it was the first, and 17 and 4 times as large at 50 steps a contact. */
static void test_jumps(void) {
    static const struct binary cases[] = {{"law=\"dmt\", modulus=1e8, adhesion=20.0", 0.0, 2.0},
                                          {"law=\"jkr\", modulus=1e8, adhesion=20.0", 0.0, 1.5}};
    for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++) {
        struct scree_impact impact = exactly(cases[k].law);
        struct binary b = {cases[k].law, impact.restitution, cases[k].order};
        struct spread at50 = spread_of(&b, "time.integrator=\"verlet\"", impact.duration, 50.0);
        struct spread at200 = spread_of(&b, "time.integrator=\"verlet\"", impact.duration, 200.0);
        double order = log(at50.rms / at200.rms) / log(4.0);
        show("jumps", b.law, at50.largest, at200.largest);
        CHECK(order > b.order - 0.2);
    }
}

/* Laws that remember, attach, or let go in a jump, beside Verlet's limit (2e-3 at 20 steps a contact, so 2e-7 at 2000);
 * the books lack as little as the path errs. */
static void test_remembering(void) {
    static const char *const laws[] = {
        "law=\"walton-braun\", stiffness=1e5, restitution=0.5",
        "law=\"walton-braun-variable\", stiffness=1e5, slope=500.0",
        "law=\"thornton\", modulus=1e8, yield=2e6",
        "law=\"jkr\", modulus=1e8, adhesion=1.0",
        "law=\"dmt\", modulus=1e8, adhesion=1.0",
    };
    for (size_t k = 0; k < sizeof laws / sizeof laws[0]; k++) {
        char text[1024];
        double reference = 0.0, worst[2] = {0.0, 0.0}, lacking = 0.0, duration = exactly(laws[k]).duration;
        snprintf(text, sizeof text, "%snormal = { %s }\n[output]\nwrite = [\"energy.csv\"]\n", ball_on_wall, laws[k]);
        for (int phase = -1; phase < 2 * 16; phase++) {
            double part = (phase / 2 + 0.5) / 16.0, n = phase < 0 ? 2000.0 : (phase % 2 ? 50.0 : 20.0) - 0.5 + part;
            double step = duration / n, speed;
            scree_scene *scene = scene_with(text, step, phase < 0 ? NULL : pair_impulse, 0);
            scree_energy energy;
            go(scene, (long)(6e-3 / step));
            CHECK(touches(scene) == 0);
            CHECK(scree_scene_energy(scene, &energy) == SCREE_OK);
            speed = state_of(scene, "ball").velocity[2];
            scree_scene_destroy(scene);
            if (phase < 0) reference = speed;
            if (phase < 0) continue;
            worst[phase % 2] = scree_most(worst[phase % 2], fabs(speed - reference));
            lacking = scree_most(lacking, fabs(energy.balance));
        }
        show("remembering", laws[k], worst[0], worst[1]);
        NEAR(worst[0], 0.0, 3e-5);
        NEAR(worst[1], 0.0, 3e-6);
        NEAR(lacking, 0.0, 3e-5 * 0.015);
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

/* Time for which two of these spheres touch, s. */
static double duration_of(const char *law) {
    double step = 1e-6;
    long touching = 0;
    scree_scene *scene = row_of(2, law, 0.5 * step, step, pair_impulse);
    while (scree_scene_steps(scene) < 20 || touches(scene)) {
        go(scene, 1);
        touching += touches(scene);
    }
    scree_scene_destroy(scene);
    return step * (double)touching;
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
        for (int k = 0; k < count; k++) worst = scree_most(worst, fabs(speed[k] - reference[k]));
    }
    return worst;
}

/* Second order, from the extrapolated accelerations. The bounds are those that the prototypes of the method attained
 * with the worst of these laws. */
static void test_rows(void) {
    static const char *const laws[] = {
        "law=\"linear-cut\", stiffness=1e6, restitution=0.5",
        "law=\"linear\", stiffness=1e6, restitution=0.5",
        "law=\"tsuji-cut\", stiffness=1e8, restitution=0.5",
        "law=\"hunt-crossley\", stiffness=1e8, restitution=0.5, speed=1.0",
        "law=\"kuwabara-kono-cut\", stiffness=1e8, restitution=0.5, speed=1.0",
    };
    for (size_t k = 0; k < sizeof laws / sizeof laws[0]; k++) {
        double fine[3], other[3], duration = duration_of(laws[k]), step = duration / 3000.0;
        run_row(3, laws[k], 0.3, step, pair_impulse, fine);
        run_row(3, laws[k], 0.3, step, NULL, other);
        /* Verlet is an independent reference: at most 1e-2 at 20 steps a contact, and of order 1.6 with roots. */
        for (int b = 0; b < 3; b++) NEAR(other[b], fine[b], 1e-2 * pow(20.0 / 3000.0, 1.6));
        double at20 = worst_row(3, laws[k], duration, 20.0, fine), at50 = worst_row(3, laws[k], duration, 50.0, fine);
        double at100 = worst_row(3, laws[k], duration, 100.0, fine);
        show("row of 3", laws[k], at20, at50);
        NEAR(at20, 0.0, 3.5e-4);
        NEAR(at50, 0.0, 4e-5);
        NEAR(log(at50 / at100) / log(2.0), 2.0, 0.2);
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
        double duration = duration_of(law);
        double at20 = worst_row(count, law, duration, 20.0, reference);
        double at50 = worst_row(count, law, duration, 50.0, reference);
        show("cradle", check_text(table, row, "N"), at20, at50);
        NEAR(at20, 0.0, 3.5e-4);
        NEAR(at50, 0.0, 4e-5);
    }
    free(table);
}

/* ---- rolling ---- */

/* A ball that slips, rolls, twists and is brought to rest by rolling resistance. */
static void roll(double step, const char *integrator, double numbers[3], double *imbalance) {
    static const char text[] =
        "gravity = [0, 0, -9.81]\n[time]\nend = 10.0\nforce = true\n[[material]]\nname = \"m\"\n"
        "[[body]]\nname = \"wall\"\nshape = { plane = true }\nmaterial = \"m\"\njoint = \"fixed\"\n"
        "[[body]]\nname = \"ball\"\nshape = { sphere = 0.01 }\nmaterial = \"m\"\nmass = 0.03\n"
        "velocity = [0.3, 0, 0]\nspin = [0, 10, 5]\nposition = [0, 0, 0.01]\n[output]\nwrite = [\"energy.csv\"]\n"
        "[[contact]]\nbetween = [\"m\", \"m\"]\n"
        "normal = { law = \"linear-cut\", stiffness = 1e4, restitution = 0.5 }\n"
        "friction = { law = \"coulomb\", static = 0.4, kinetic = 0.3, stiffness = 8e3, damping = 2.0 }\n"
        "rolling = { law = \"spring-dashpot\", rolling = 0.05, twisting = 0.02, stiffness = 4e3, damping = 2.0 }\n";
    scree_scene *scene = scene_with(text, step, integrator, 0);
    go(scene, lround(0.05 / step));
    scree_body_state ball = state_of(scene, "ball");
    numbers[0] = 0.01 * ball.spin[1];
    numbers[1] = 0.01 * ball.spin[2];
    go(scene, lround(0.95 / step));
    numbers[2] = state_of(scene, "ball").position[0];
    scree_energy energy;
    CHECK(scree_scene_energy(scene, &energy) == SCREE_OK);
    *imbalance = energy.balance;
    scree_scene_destroy(scene);
}

/* The resistance is evaluated once a step, at its middle: second order, so a quarter of the error with half the step,
 * and the same limit as the other integrator's. */
static void test_rolling(void) {
    double fine[3], coarse[3], half[3], verlet[3], ignored, imbalance;
    roll(1e-6, pair_impulse, fine, &ignored);
    roll(1e-6, "time.integrator=\"verlet\"", verlet, &ignored);
    roll(1e-4, pair_impulse, coarse, &imbalance);
    roll(5e-5, pair_impulse, half, &ignored);
    for (int k = 0; k < 3; k++) {
        NEAR(fine[k], verlet[k], 1e-9); /* verlet at 1/5400 of a contact */
        NEAR(coarse[k], fine[k], 1e-7);
        NEAR(half[k], fine[k], 0.25 * 1e-7);
    }
    NEAR(imbalance, 0.0, 1e-9); /* of 1.4e-3 J */
}

/* A spinning ball falls on a plate and rebounds, with a spring that resists rolling and twisting, and no dashpot beside
 * it: the spin then, as speeds, m/s. Contact lasts for 3 ms. */
static void rebound_rolling(const char *normal, double step, const char *integrator, double spin[3]) {
    char text[1024];
    snprintf(text, sizeof text,
             "[time]\nend = 1.0\nforce = true\nspeed = 0.5\n[[material]]\nname = \"m\"\n"
             "[[body]]\nname = \"wall\"\nshape = { plane = true }\nmaterial = \"m\"\njoint = \"fixed\"\n"
             "[[body]]\nname = \"ball\"\nshape = { sphere = 0.02 }\nmaterial = \"m\"\nmass = 0.1\n"
             "position = [0, 0, 0.0201]\nvelocity = [0, 0, -0.5]\nspin = [0, 20, 15]\n"
             "[[contact]]\nbetween = [\"m\", \"m\"]\nnormal = %s\n"
             "rolling = { law = \"spring-dashpot\", rolling = 0.05, twisting = 0.02, stiffness = 3e3 }\n",
             normal);
    scree_scene *scene = scene_with(text, step, integrator, 0);
    go(scene, lround(4.8e-3 / step));
    CHECK(touches(scene) == 0);
    for (int k = 0; k < 3; k++) spin[k] = 0.02 * state_of(scene, "ball").spin[k];
    scree_scene_destroy(scene);
}

/* The spring is stretched from the touch on, wherever in a step that is (here also in its middle), and bears nothing
 * while the normal force pulls. So it is of second order: a load that is linear over the step, or that of its middle,
 * errs by (w h)^2/12 of it at most, w = pi over the contact's duration; and by as much where the spring meets its
 * limit. Verlet's loads err by 0.2 (w h)^2 where contacts begin and end. Under adhesion friction begins inside a step,
 * where the force has stopped to pull, which fixed steps don't look for: an error of a step. The adaptive integrator is
 * at its tolerance. */
static void test_rolling_begins(void) {
    static const char *const laws[] = {"{ law = \"linear\", stiffness = 1e5, restitution = 0.5 }",
                                       "{ law = \"linear-cut\", stiffness = 1e5, restitution = 0.5 }",
                                       "{ law = \"jkr\", modulus = 3e7, adhesion = 20.0 }"};
    static const char *const integrators[] = {"time.integrator=\"verlet\"", pair_impulse};
    static const double errs[] = {1.0 / 6.0 + 0.2, 1.0 / 6.0};
    for (int l = 0; l < 3; l++) {
        double fine[3], coarse[3];
        rebound_rolling(laws[l], 2e-4, "time.integrator=\"adaptive\"", fine);
        double changed = hypot(0.4 - fine[1], 0.3 - fine[2]);
        CHECK(changed > 0.05);
        for (int i = 0; i < 2; i++)
            for (double step = 8e-5; step > 4e-6; step *= 0.25) {
                rebound_rolling(laws[l], step, integrators[i], coarse);
                double wrong = hypot(coarse[1] - fine[1], coarse[2] - fine[2]), part = 3.14159 * step / 3e-3;
                show("rolling begins", laws[l] + 8, step, wrong / changed);
                NEAR(wrong, 0.0, (l < 2 ? errs[i] * part * part : part / 3.14159) * changed);
            }
    }
}

/* A sphere bounces off the face of a rectangle, and of a box, as it does off a plane, though nobody measures on the
 * way: what its partner asks of it at the start of a step must be at hand all the same. All err by 2e-6 of the speed
 * and less (test_binary at 20 steps a contact). */
static void test_partners(void) {
    static const char *const shapes[] = {"{ plane = true }", "{ rectangle = [0.2, 0.1] }",
                                         "{ box = [0.2, 0.1, 0.02], rounding = 1e-4 }"};
    struct vec after[3], spin[3];
    for (int k = 0; k < 3; k++) {
        char text[1024];
        snprintf(text, sizeof text,
                 "[time]\nend = 1.0\nforce = true\n[[material]]\nname = \"m\"\n[[contact]]\nbetween = [\"m\", "
                 "\"m\"]\nnormal = { law = \"linear-cut\", stiffness = 1e5, restitution = 0.5 }\nfriction = { law = "
                 "\"coulomb\", static = 0.3, kinetic = 0.3, stiffness = 8e4 }\n[[body]]\nname = \"wall\"\nshape = "
                 "%s\nmaterial = \"m\"\nposition = [0, 0, %g]\njoint = \"fixed\"\n[[body]]\nname = \"ball\"\n"
                 "shape = { sphere = 0.01 }\nmaterial = \"m\"\nmass = 0.03\nposition = [0, 0, 0.0101]\n"
                 "velocity = [0.3, 0.1, -1]\n",
                 shapes[k], k == 2 ? -0.01 : 0.0);
        scree_scene *scene = scene_with(text, 2e-5, pair_impulse, 0);
        go(scene, 200);
        after[k] = vec_from(state_of(scene, "ball").velocity);
        spin[k] = vec_from(state_of(scene, "ball").spin);
        scree_scene_destroy(scene);
        show("partner", shapes[k], vec_norm(vec_sub(after[k], after[0])), vec_norm(vec_sub(spin[k], spin[0])));
        NEAR(after[k].z, 0.5, 2e-6);
        NEAR(vec_norm(vec_sub(after[k], after[0])), 0.0, 4e-6);
        NEAR(0.01 * vec_norm(vec_sub(spin[k], spin[0])), 0.0, 4e-6);
    }
}

/* ---- boxes ---- */

/* A corner of a box slips on a floor that moves to and fro, and sticks again: when it does depends on how the load
 * changes, and that on friction, too, which turns the box. */
static void test_box_sticks_again(void) {
    static const char text[] =
        "[time]\nend = 2e-3\n[[motion]]\nname = \"to and fro\"\nkind = \"sine\"\namplitude = 1e-3\nfrequency = 200\n"
        "[[material]]\nname = \"box\"\n[[material]]\nname = \"floor\"\n"
        "[[contact]]\nbetween = [\"box\", \"floor\"]\n"
        "normal = { law = \"linear-cut\", stiffness = 1e5, restitution = 0.5 }\n"
        "friction = { law = \"coulomb\", static = 0.7, kinetic = 0.7, stiffness = 5e4 }\n"
        "[[body]]\nname = \"box\"\nshape = { box = [0.03, 0.02, 0.01], rounding = 0.003 }\nmaterial = \"box\"\n"
        "mass = 0.01\nposition = [0, 0, 0.02]\norientation = { axis = [0.31, -0.78, -0.54], angle = 1.16 }\n"
        "velocity = [0.9, 0, -1]\nspin = [-16, 45, 54]\n"
        "[[body]]\nname = \"floor\"\nshape = { plane = true }\nmaterial = \"floor\"\nposition = [0, 0, 0.004682]\n"
        "joint = { x = \"to and fro\", others = \"fixed\" }\n";
    static const double step[] = {2e-3, 1e-5, 2.5e-6};
    double way[3], error[2];
    for (int k = 0; k < 3; k++) {
        scree_scene *scene = scene_with(text, step[k], k ? pair_impulse : "time.integrator=\"adaptive\"", 0);
        go(scene, lround(2e-3 / step[k]));
        scree_body_state box = state_of(scene, "box");
        way[k] = box.velocity[0] + box.velocity[1] + 0.01 * (box.spin[0] + box.spin[1] + box.spin[2]);
        scree_scene_destroy(scene);
    }
    for (int k = 0; k < 2; k++) error[k] = fabs(way[k + 1] - way[0]);
    show("box", "sticks again", error[0], error[1]);
    CHECK(error[0] < 1e-4 && error[1] < error[0] / 8.0); /* of second order; 1.2 m/s are the speeds */
}

/* ---- rest ---- */

/* Fastest motion and largest displacement of the bodies in `steps` steps, looked at every 100. */
static void watch(scree_scene *scene, long steps, double *speed, double *way) {
    scree_body_state start[16];
    int count = scree_scene_bodies(scene);
    for (int k = 0; k < count; k++) start[k] = scree_scene_body(scene, k);
    *speed = *way = 0.0;
    for (long n = 0; n < steps; n += 100) {
        go(scene, 100);
        for (int k = 0; k < count; k++) {
            scree_body_state now = scree_scene_body(scene, k);
            struct vec moved = vec_sub(vec_from(now.position), vec_from(start[k].position));
            *speed = scree_most(*speed, vec_norm(vec_from(now.velocity)));
            *way = scree_most(*way, vec_norm(moved));
        }
    }
}

/* Ten spheres on each other, each overlap that of the weight above. Speeds are rounding: a position of 0.2 m can't
 * balance forces better than to its last digit, 2.8e-17 m, and is moved by one such digit within a step of 6 ms. */
static void check_stack(const char *integrator) {
    enum { COUNT = 10 };
    char text[4096];
    double mass = 1.0, gravity = 0.01, stiffness = 100.0, radius = 0.01, top = 0.0;
    int n = snprintf(text, sizeof text, "gravity = [0, 0, -%.17g]\n[time]\nend = 1e4\nstep = 6e-3\n", gravity);
    n += snprintf(text + n, sizeof text - (size_t)n,
                  "[[material]]\nname = \"m\"\n[[contact]]\nbetween = [\"m\", \"m\"]\n"
                  "normal = { law = \"linear-cut\", stiffness = %.17g, restitution = 0.5 }\n"
                  "[[body]]\nname = \"floor\"\nshape = { plane = true }\nmaterial = \"m\"\njoint = \"fixed\"\n",
                  stiffness);
    for (int k = 0; k < COUNT; k++) {
        double overlap = (COUNT - k) * mass * gravity / stiffness;
        top += (k ? 2.0 : 1.0) * radius - overlap;
        n += snprintf(
            text + n, sizeof text - (size_t)n,
            "[[body]]\nname = \"%d\"\nshape = { sphere = %.17g }\nmaterial = \"m\"\nmass = %.17g\nposition = [0, "
            "0, %.17g]\n",
            k, radius, mass, top);
    }
    scree_scene *scene = scene_from(text, &integrator, 1, 1);
    double speed, way;
    watch(scene, 100000, &speed, &way);
    show("stack", "speed, way", speed, way);
    NEAR(speed, 0.0, 1e-14);
    NEAR(way, 0.0, 10 * 2.8e-17);
    scree_scene_destroy(scene);
}

static void test_stack(void) {
    check_stack(pair_impulse);
    check_stack("time.integrator=\"verlet\"");
}

/* A sphere in the notch of two fixed ones, with friction: placed at rest, and dropped into it. */
static void test_notch(void) {
    static const char text[] =
        "gravity = [0, 0, -0.01]\n[time]\nend = 1e4\nstep = 6e-3\n[[material]]\nname = \"m\"\n"
        "[[contact]]\nbetween = [\"m\", \"m\"]\n"
        "normal = { law = \"linear-cut\", stiffness = 100.0, restitution = 0.5 }\n"
        "friction = { law = \"coulomb\", static = 0.5, kinetic = 0.4, stiffness = 80.0 }\n"
        "[[body]]\nname = \"left\"\nshape = { sphere = 0.01 }\nmaterial = \"m\"\nposition = [-0.012, 0, 0]\n"
        "joint = \"fixed\"\n"
        "[[body]]\nname = \"right\"\nshape = { sphere = 0.01 }\nmaterial = \"m\"\nposition = [0.012, 0, 0]\n"
        "joint = \"fixed\"\n"
        "[[body]]\nname = \"disc\"\nshape = { sphere = 0.01 }\nmaterial = \"m\"\nmass = 1.0\n";
    /* At the height z the two forces 100 d z/r hold the weight, d = 0.02 - r, r^2 = z^2 + 0.012^2. */
    double low = 0.012, high = 0.016;
    for (int k = 0; k < 200; k++) {
        double z = 0.5 * (low + high), r = sqrt(z * z + 0.012 * 0.012);
        if (2.0 * 100.0 * (0.02 - r) * z / r > 0.01)
            low = z;
        else
            high = z;
    }
    for (int dropped = 0; dropped < 2; dropped++) {
        char position[96];
        snprintf(position, sizeof position, "body.2.position=[%.17g, 0, %.17g]", dropped ? 1e-5 : 0.0,
                 low + dropped * 1e-3);
        const char *changes[] = {pair_impulse, position};
        scree_scene *scene = scene_from(text, changes, 2, 1);
        if (dropped) go(scene, 100000); /* until it is at rest */
        double speed, way;
        watch(scene, 100000, &speed, &way);
        show("notch", dropped ? "dropped: speed, way" : "placed: speed, way", speed, way);
        NEAR(speed, 0.0, 1e-14);
        NEAR(way, 0.0, 1e-16);
        scree_scene_destroy(scene);
    }
}

/* A column that is shaken calms down at 0.9 of the step limit, and not at 4 times: the limit is that of blocks with
 * twelve neighbours each, so columns bear up to three times as much. */
static void test_limit(void) {
    static const double restitution[] = {0.95, 0.85, 0.5, 0.2, 0.02}, part[] = {0.9, 4.0};
    for (int k = 0; k < 10; k++) {
        char text[4096], change[64];
        double top = 0.0, fastest = 0.0;
        int n = snprintf(text, sizeof text,
                         "gravity = [0, 0, -0.01]\n[time]\nend = 1e4\nforce = true\nintegrator = \"pair-impulse\"\n"
                         "[[material]]\nname = \"m\"\n[[contact]]\nbetween = [\"m\", \"m\"]\n"
                         "normal = { law = \"linear-cut\", stiffness = 100.0, restitution = %g }\n"
                         "[[body]]\nname = \"floor\"\nshape = { plane = true }\nmaterial = \"m\"\njoint = \"fixed\"\n",
                         restitution[k / 2]);
        for (int b = 0; b < 10; b++) {
            top += (b ? 2.0 : 1.0) * 0.01 - (10 - b) * 1e-4;
            n +=
                snprintf(text + n, sizeof text - (size_t)n,
                         "[[body]]\nname = \"%d\"\nshape = { sphere = 0.01 }\nmaterial = \"m\"\nmass = 1.0\nposition = "
                         "[0, 0, %.17g]\nvelocity = [0, 0, %g]\n",
                         b, top, b % 2 ? 1e-4 : -1e-4);
        }
        scree_scene *scene = scene_from(text, NULL, 0, 1);
        snprintf(change, sizeof change, "time.step=%.17g", part[k % 2] * scene->plan.choice.limit);
        scree_scene_destroy(scene);
        const char *changes[] = {change};
        scene = scene_from(text, changes, 1, 1);
        if (scree_scene_step(scene, 3000)) fastest = 1.0; /* stopped: spheres in each other */
        for (int b = 0; b < 11; b++) fastest = scree_most(fastest, fabs(scree_scene_body(scene, b).velocity[2]));
        CHECK(k % 2 ? fastest > 1e-4 : fastest < 2e-5);
        scree_scene_destroy(scene);
    }
}

/* ---- books ---- */

/* A box that falls on a corner, rolls over and slides, with a dashpot in friction: the books are sums over the stages,
 * so they close as well as the path is followed. Of that friction a box's contacts don't locate where they slide or
 * hold, so its way (6 cm, through several impacts) is of first order. A slider that breaks loose unseen errs by k v h
 * over a step, by k v h^2/m x 0.1 s = 7e-6 m of the way at the largest step and less at others; there are some of
 * either sign. */
static void test_books(void) {
    static const char text[] =
        "gravity = [0, 0, -9.81]\n[time]\nend = 0.2\n[[material]]\nname = \"m\"\ndensity = 1000\n"
        "[[contact]]\nbetween = [\"m\", \"m\"]\n"
        "normal = { law = \"linear-cut\", stiffness = 1e4, restitution = 0.6 }\n"
        "friction = { law = \"coulomb\", static = 0.4, kinetic = 0.3, stiffness = 8e3, damping = 0.5 }\n"
        "[[body]]\nname = \"floor\"\nshape = { plane = true }\nmaterial = \"m\"\njoint = \"fixed\"\n"
        "[[body]]\nname = \"box\"\nshape = { box = [0.03, 0.05, 0.012], rounding = 0.001 }\nmaterial = \"m\"\n"
        "position = [0, 0, 0.04]\norientation = { axis = [1, 2, 0.5], angle = 0.7 }\nvelocity = [0.4, 0.1, 0]\nspin = "
        "[3, "
        "-5, 8]\n[output]\nwrite = [\"energy.csv\"]\n";
    double worst = 0.0, way[4];
    for (int k = 0; k < 4; k++) {
        scree_scene *scene = scene_with(text, 2e-5 / (k < 3 ? 1 << k : 16), pair_impulse, 0);
        scree_energy energy;
        for (long n = 0; n < 10000L * (k < 3 ? 1 << k : 16); n += 50) {
            go(scene, 50);
            CHECK(scree_scene_energy(scene, &energy) == SCREE_OK);
            worst = scree_most(worst, fabs(energy.balance));
        }
        CHECK(energy.lost_normal > 1e-3 && energy.lost_tangential > 1e-4);
        way[k] = state_of(scene, "box").position[0];
        scree_scene_destroy(scene);
    }
    show("box", "balance, way", worst, way[0] - way[3]);
    NEAR(worst, 0.0, 1e-8); /* of 1e-2 J */
    for (int k = 0; k < 3; k++) NEAR(way[k], way[3], 1e-5 / (1 << k));
}

/* ---- same bits ---- */

/* What is saved of two scenes, which aren't of the same past, is the same. */
static int saved_alike(scree_scene *scene, scree_scene *other) {
    FILE *file = tmpfile(), *another = tmpfile();
    CHECK(scree_scene_save(scene, file, "one") == SCREE_OK && scree_scene_save(other, another, "other") == SCREE_OK);
    rewind(file);
    rewind(another);
    int one, two;
    do {
        one = getc(file);
        two = getc(another);
    } while (one == two && one != EOF);
    fclose(file);
    fclose(another);
    return one == two;
}

static void test_same_bits(void) {
    char *text = heap_text();
    static const char *const changes[] = {pair_impulse, "time.step=3.4e-5", "output={write=[\"energy.csv\"]}"};
    static const int threads[] = {1, 2, 3, 1};
    uint64_t hash[4];
    for (int k = 0; k < 4; k++) {
        scree_scene *scene = scene_from(text, changes, k == 3 ? 3 : 2, threads[k]);
        go(scene, 1000);
        hash[k] = scree_scene_hash(scene);
        CHECK(hash[k] == hash[0]); /* 3: with measurements */
        if (k == 0) CHECK(touches(scene) > 100 && scene->contacts.rebuilds > 1);
        scree_scene_destroy(scene);
    }
    /* Saved in the middle and restored into a new scene; and into one that steps otherwise. */
    scree_scene *scene = scene_from(text, changes, 2, 1), *other = scene_from(text, changes, 2, 2);
    scree_scene *verlet = scene_from(text, changes + 1, 1, 1);
    FILE *file = tmpfile();
    go(scene, 700);
    CHECK(scree_scene_save(scene, file, "memory") == SCREE_OK);
    rewind(file);
    CHECK(scree_scene_restore(other, file, "memory") == SCREE_OK);
    CHECK(scree_scene_hash(other) == scree_scene_hash(scene));
    go(other, 300);
    CHECK(scree_scene_hash(other) == hash[0]);
    go(scene, 300);
    CHECK(saved_alike(scene, other)); /* whatever is listed besides contacts */
    rewind(file);
    CHECK(scree_scene_restore(verlet, file, "memory") == SCREE_BAD_INPUT);
    CONTAINS(scree_scene_trouble(verlet)->text, "integrator");
    fclose(file);
    scree_scene_destroy(scene);
    scree_scene_destroy(other);
    scree_scene_destroy(verlet);
    free(text);
}

/* Balls that each graze a frozen one of their own: GRAZING in one scene (-1), whose contacts go through the step in one
 * block, or one of them alone. */
enum { GRAZING = 12 };

static scree_scene *grazing_pairs(const char *laws, int alone) {
    char text[8192];
    uint64_t seed = 3;
    int used = snprintf(text, sizeof text,
                        "[time]\nend = 1\nstep = 2e-6\nintegrator = \"pair-impulse\"\nforce = true\n"
                        "[[material]]\nname = \"m\"\ndensity = 2500\n[[contact]]\nbetween = [\"m\", \"m\"]\n%s\n",
                        laws);
    for (int k = 0; k < GRAZING; k++) {
        double v[3];
        check_draw(&seed, -0.7, 0.7, 3, v);
        if (alone < 0 || alone == k)
            used += snprintf(text + used, sizeof text - (size_t)used,
                             "[[body]]\nname = \"held %d\"\nshape = { sphere = 0.001 }\nmaterial = \"m\"\n"
                             "joint = \"fixed\"\nposition = [%g, 0, 0]\n[[body]]\nname = \"ball %d\"\n"
                             "shape = { sphere = 0.0003 }\nmaterial = \"m\"\nposition = [%g, 0, 0.001303]\n"
                             "velocity = [%.17g, %.17g, %.17g]\n",
                             k, 0.02 * k, k, 0.02 * k, v[0], v[1], -0.3 - 0.5 * fabs(v[2]));
    }
    return scene_from(text, NULL, 0, 1);
}

/* No bit depends on the neighbours in the list: some need more pieces of the step than others where the force sets in
 * as a root, and those that are through wait without being changed. */
static void test_neighbours(void) {
    static const char *const laws[] = {
        "normal = { law = \"hertz\", modulus = 7e7 }\n"
        "friction = { law = \"mindlin\", static = 0.5, kinetic = 0.5, shear_modulus = 3.5e7 }",
        "normal = { law = \"tsuji-cut\", modulus = 7e7, restitution = 0.7 }\n"
        "friction = { law = \"mindlin\", static = 0.5, kinetic = 0.3, shear_modulus = 3.5e7, damping = 0.1 }",
        "normal = { law = \"hertz\", modulus = 7e7 }\n"
        "friction = { law = \"coulomb\", static = 0.5, kinetic = 0.5, stiffness = 1e4 }",
        "normal = { law = \"kuwabara-kono-cut\", modulus = 7e7, restitution = 0.7, speed = 0.5 }\n"
        "friction = { law = \"tanh\", kinetic = 0.5, threshold = 0.1 }",
        "normal = { law = \"hunt-crossley\", stiffness = 1e6, exponent = 1.4, restitution = 0.7, speed = 0.5 }\n"
        "friction = { law = \"mindlin\", static = 0.5, kinetic = 0.3, shear_modulus = 3.5e7 }",
        "normal = { law = \"flores\", stiffness = 1e6, exponent = 1.4, restitution = 0.7 }\n"
        "friction = { law = \"coulomb\", static = 0.5, kinetic = 0.3, stiffness = 1e4 }",
        "normal = { law = \"walton-braun\", stiffness = 1e4, restitution = 0.7 }\n"
        "friction = { law = \"mindlin\", static = 0.5, kinetic = 0.3, shear_modulus = 3.5e7, damping = 0.1 }",
        "normal = { law = \"thornton\", modulus = 7e7, yield = 2e6 }\n"
        "friction = { law = \"coulomb\", static = 0.5, kinetic = 0.5, stiffness = 1e4 }",
        "normal = { law = \"linear-loading\", stiffness = 1e4, restitution = 0.7 }\n"
        "friction = { law = \"mindlin\", static = 0.5, kinetic = 0.5, shear_modulus = 3.5e7 }",
        "normal = { law = \"hertz\", modulus = 7e7 }\n"
        "friction = { law = \"mindlin-incremental\", static = 0.5, kinetic = 0.5, shear_modulus = 3.5e7 }",
        "normal = { law = \"tsuji\", modulus = 7e7, restitution = 0.7 }\n"
        "friction = { law = \"mindlin-rescaled\", static = 0.5, kinetic = 0.3, shear_modulus = 3.5e7, damping = 0.1 "
        "}"};
    for (size_t l = 0; l < sizeof laws / sizeof laws[0]; l++) {
        scree_scene *together = grazing_pairs(laws[l], -1);
        go(together, 30);
        for (int k = 0; k < GRAZING; k++) {
            char name[24];
            snprintf(name, sizeof name, "ball %d", k);
            scree_scene *alone = grazing_pairs(laws[l], k);
            go(alone, 30);
            scree_body_state one = state_of(alone, name), other = state_of(together, name);
            CHECK(memcmp(one.velocity, other.velocity, sizeof one.velocity) == 0);
            CHECK(memcmp(one.spin, other.spin, sizeof one.spin) == 0 && one.spin[0] * one.spin[1] != 0.0);
            scree_scene_destroy(alone);
        }
        scree_scene_destroy(together);
    }
}

/* The place of a driven body after n steps is reckoned from n - 1 and one more, and rounded so: a state keeps it. Saved
 * after each step, restored, and taken on. */
static void test_driven_restored(void) {
    static const char text[] =
        "gravity = [0, 0, -9.81]\n[time]\nend = 1.0\nstep = 2.9e-5\n[[material]]\nname = \"m\"\ndensity = 2500\n"
        "[[motion]]\nname = \"shake\"\nkind = \"sine\"\namplitude = 2e-4\nfrequency = 50\n"
        "[[body]]\nname = \"floor\"\nshape = { plane = true }\nmaterial = \"m\"\n"
        "joint = { z = \"shake\", others = \"fixed\" }\n"
        "[[body]]\nname = \"flap\"\nshape = { rectangle = [0.01, 0.01] }\nmaterial = \"m\"\n"
        "position = [0.1, 0, 0.002]\njoint = { turn = { axis = [0, 1, 0], motion = \"shake\" }, others = \"fixed\" }\n"
        "[[generate]]\nname = \"ball\"\nkind = \"lattice\"\nmaterial = \"m\"\nradius = 0.001\nmin = [0, 0, 0]\n"
        "max = [0.003, 0.003, 0.003]\ncount = 1\n"
        "[[contact]]\nbetween = [\"m\", \"m\"]\nnormal = { law = \"linear\", stiffness = 100, restitution = 0.7 }\n";
    static const char *const integrators[] = {pair_impulse, "time.integrator=\"verlet\""};
    for (int which = 0; which < 2; which++) {
        scree_scene *scene = scene_from(text, &integrators[which], 1, 1);
        for (int k = 0; k < 800; k++) {
            scree_scene *other = scene_from(text, &integrators[which], 1, 1);
            FILE *file = tmpfile();
            CHECK(scree_scene_save(scene, file, "memory") == SCREE_OK);
            rewind(file);
            CHECK(scree_scene_restore(other, file, "memory") == SCREE_OK);
            CHECK(scree_scene_hash(other) == scree_scene_hash(scene));
            go(scene, 1);
            go(other, 1);
            CHECK(scree_scene_hash(other) == scree_scene_hash(scene));
            fclose(file);
            scree_scene_destroy(other);
        }
        CHECK(scene->contacts.deepest > 0.0);
        scree_scene_destroy(scene);
    }
}

/* `balls` balls fall on a wall obliquely, each at its own time and far from the others, and the last third of them in
 * pairs on each other. */
static char *rain_text(int balls, const char *laws) {
    char *text = malloc((size_t)balls * 320 + 1024);
    int used = sprintf(
        text, "gravity = [0, 0, -9.81]\n[time]\nend = 1.0\nforce = true\n[[material]]\nname = \"m\"\n[[body]]\nname = "
              "\"wall\"\nshape = { plane = true }\nmaterial = \"m\"\njoint = \"fixed\"\n");
    for (int k = 0; k < balls; k++) {
        double height = 0.0101 + 0.0003 * k, x = 0.05 * k;
        if (k % 3 == 2 && k > 2) { /* on the one before */
            height += 0.0208;
            x -= 0.048;
        }
        used += sprintf(
            text + used,
            "[[body]]\nname = \"%d\"\nshape = { sphere = 0.01 }\nmaterial = \"m\"\nmass = 0.03\nposition = [%.17g, "
            "0, %.17g]\nvelocity = [%.17g, 0.1, -1]\nspin = [0, %d, 3]\n",
            k, x, height, 0.2 + 0.01 * k, 7 * k);
    }
    sprintf(text + used, "[[contact]]\nbetween = [\"m\", \"m\"]\n%s\n", laws);
    return text;
}

/* What becomes of a contact doesn't depend on those that are reckoned with it, nor on how many are at once. */
static void test_alone(void) {
    static const char *const laws[] = {
        "normal = { law=\"linear\", stiffness=1e5, restitution=0.5 }",
        "normal = { law=\"tsuji-cut\", stiffness=5e6, restitution=0.5 }",
        "normal = { law=\"linear-cut\", stiffness=1e5, restitution=0.5 }\n"
        "friction = { law=\"coulomb\", static=0.3, kinetic=0.3, stiffness=8e4 }",
        "normal = { law=\"tsuji\", stiffness=5e6, restitution=0.5 }\n"
        "friction = { law=\"mindlin\", static=0.4, kinetic=0.3, shear_modulus=8e6, damping=0.1 }",
        "normal = { law=\"hertz\", stiffness=5e6 }\n"
        "friction = { law=\"mindlin\", static=0.4, kinetic=0.3, shear_modulus=8e6 }",
        "normal = { law=\"linear\", stiffness=1e5, restitution=0.5 }\n"
        "rolling = { law=\"viscous\", rolling=0.05, twisting=0.02 }",
        "normal = { law=\"tsuji\", stiffness=5e6, restitution=0.5 }\n"
        "friction = { law=\"mindlin\", static=0.4, kinetic=0.3, shear_modulus=8e6, damping=0.1 }\n"
        "rolling = { law=\"spring-dashpot\", rolling=0.05, twisting=0.02, stiffness=1e4, damping=2 }",
    };
    static const char *const isa[] = {"baseline", "avx2", "avx512"};
    const char *before = getenv("SCREE_ISA");
    for (size_t l = 0; l < sizeof laws / sizeof laws[0]; l++) {
        uint64_t hash[3];
        for (int i = 0; i < 3; i++) {
            char *few_text = rain_text(2, laws[l]), *many_text = rain_text(90, laws[l]);
            setenv("SCREE_ISA", isa[i], 1);
            scree_scene *few = scene_with(few_text, 5e-5, pair_impulse, 0),
                        *many = scene_with(many_text, 5e-5, pair_impulse, 0);
            go(few, 1000);
            go(many, 1000);
            for (int k = 0; k < 2; k++) {
                scree_body_state one = scree_scene_body(few, 1 + k), same = scree_scene_body(many, 1 + k);
                CHECK(memcmp(&one, &same, sizeof one) == 0);
                CHECK(one.velocity[2] > 0.0); /* it has been on the wall */
            }
            hash[i] = scree_scene_hash(many);
            CHECK(hash[i] == hash[0]);
            scree_scene_destroy(few);
            scree_scene_destroy(many);
            free(few_text);
            free(many_text);
        }
    }
    if (before)
        setenv("SCREE_ISA", before, 1);
    else
        unsetenv("SCREE_ISA");
}

/* Pairs of spheres that press on each other across the border of a periodic domain. In every third one sphere is held
 * along the axis, so that it is no ball to the method. Less than sixteen are balls, so that bodies aren't sorted: for
 * then those held came first, and a block whose first contact isn't one of balls doesn't go straight. More than eight
 * pairs go by the widest loop. */
enum { PAIRS = 9 };

static int has_held(int pair) { return pair % 3 == 2; }

/* The second body of pairs 2 and 8, the first of pair 5. */
static int is_held(int pair, int second) { return has_held(pair) && second == (pair != 5); }

/* `all` 0: the pairs with such spheres alone. */
static scree_scene *pairs_across(int all, const char *friction, double second_radius) {
    char text[8192];
    size_t used = (size_t)snprintf(
        text, sizeof text,
        "[time]\nend = 1.0\nforce = true\nstep = 1e-5\nintegrator = \"pair-impulse\"\n"
        "[domain]\nmin = [0, 0, 0]\nmax = [0.2, 1, 1]\nperiodic = [\"x\"]\n[[material]]\nname = \"m\"\n[[contact]]\n"
        "between = [\"m\", \"m\"]\nnormal = { law = \"tsuji\", stiffness = 5e6, restitution = 0.6 }\n%s",
        friction);
    for (int k = 0; k < PAIRS; k++)
        for (int second = 0; second < 2 && (all || has_held(k)); second++)
            used += (size_t)snprintf(text + used, sizeof text - used,
                                     "[[body]]\nname = \"%c%d\"\nshape = { sphere = %g }\nmaterial = \"m\"\n"
                                     "mass = 0.01\nposition = [%.17g, %.17g, 0.5]\nvelocity = [0, 0, %.17g]\n%s",
                                     second ? 'b' : 'a', k, second ? second_radius : 0.01,
                                     second ? 0.2 - 0.0049 - second_radius : 0.005, 0.04 + 0.05 * k,
                                     second ? 0.1 + 0.01 * k : 0.0,
                                     is_held(k, second) ? "joint = { x = \"fixed\" }\n" : "");
    return scene_from(text, NULL, 0, 1);
}

/* A contact of what isn't a ball among such as go straight through the step: they are reckoned in other ways where
 * radii are equal, and without friction. */
static void check_held_among_balls(const char *friction, double second_radius) {
    scree_scene *among = pairs_across(1, friction, second_radius), *alone = pairs_across(0, friction, second_radius);
    CHECK(among->bodies.order.slabs == 0);
    go(among, 100);
    go(alone, 100);
    for (int k = 2; k < PAIRS; k += 3)
        for (int second = 0; second < 2; second++) {
            char name[16];
            snprintf(name, sizeof name, "%c%d", second ? 'b' : 'a', k);
            scree_body_state one = state_of(among, name), same = state_of(alone, name);
            CHECK(memcmp(&one, &same, sizeof one) == 0);
            CHECK((one.spin[1] != 0.0) == (friction[0] != 0)); /* they have rubbed */
            CHECK(is_held(k, second) ? one.velocity[0] == 0.0 : (second ? -1.0 : 1.0) * one.velocity[0] > 0.0);
        }
    scree_scene_destroy(among);
    scree_scene_destroy(alone);
}

static void test_held_among_balls(void) {
    static const char mindlin[] =
        "friction = { law = \"mindlin\", static = 0.5, kinetic = 0.5, shear_modulus = 8e6 }\n";
    check_held_among_balls(mindlin, 0.01);
    check_held_among_balls(mindlin, 0.012);
    check_held_among_balls("", 0.01);
}

/* Spheres that are put in another order before the first step, walls before them: where nothing touches, nothing
 * pushes, and they fall as one. */
static void test_sorted_start(void) {
    char text[8192];
    size_t used =
        (size_t)snprintf(text, sizeof text,
                         "gravity = [0, 0, -9.81]\n[time]\nintegrator = \"pair-impulse\"\nend = 1.0\nstep = 6e-5\n"
                         "[[material]]\nname = \"m\"\ndensity = 2500\n[[contact]]\nbetween = [\"m\", \"m\"]\n"
                         "normal = { law = \"linear-cut\", stiffness = 5e3, restitution = 0.5 }\n");
    for (int k = 0; k < 27; k++)
        used +=
            (size_t)snprintf(text + used, sizeof text - used,
                             "[[body]]\nname = \"%d\"\nshape = { sphere = 0.005 }\nmaterial = \"m\"\n"
                             "position = [%g, %g, %g]\nvelocity = [0, 0, -0.3]\n",
                             k, 0.006 + 0.01001 * (k % 3), 0.006 + 0.01001 * (k / 3 % 3), 0.0055 + 0.01001 * (k / 9));
    snprintf(text + used, sizeof text - used,
             "[[body]]\nname = \"floor\"\nshape = { plane = true }\nmaterial = \"m\"\njoint = \"fixed\"\n"
             "[[body]]\nname = \"wall\"\nshape = { plane = true }\nmaterial = \"m\"\njoint = \"fixed\"\n"
             "position = [0.0311, 0, 0]\norientation = { axis = [0, 1, 0], degrees = -90 }\n");
    scree_scene *scene = scene_from(text, NULL, 0, 1);
    CHECK(scene->bodies.order.slabs > 0);
    go(scene, 20);
    for (int k = 0; k < 27; k++) {
        scree_body_state ball = scree_scene_body(scene, k);
        CHECK(ball.velocity[0] == 0.0 && ball.velocity[1] == 0.0);
        NEAR(ball.velocity[2], -0.3 - 9.81 * 20 * 6e-5, 20 * 0x1p-53); /* a rounding in each step */
    }
    scree_scene_destroy(scene);
}

static void test_golden(void) {
    static const char *const changes[] = {pair_impulse};
    check_golden("pair_impulse.txt", changes, 1, NULL, 5);
}

int main(void) {
    test_binary();
    test_every_law();
    if (getenv("SCREE_ONLY")) return 0;
    test_jumps();
    test_remembering();
    test_rows();
    test_cradle();
    test_rolling();
    test_rolling_begins();
    test_partners();
    test_box_sticks_again();
    test_stack();
    test_notch();
    test_limit();
    test_books();
    test_same_bits();
    test_neighbours();
    test_driven_restored();
    test_alone();
    test_held_among_balls();
    test_sorted_start();
    test_golden();
    return check_report();
}
