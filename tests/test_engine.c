/* engine/: accuracy and its order, energy, rest, what doesn't change a result, and what stops a run. */
#include "contact/impact.h"
#include "engine/plan.h"
#include "solver/conventional.h"
#include "tests/scenes.h"

#include <limits.h>
#include <unistd.h>

/* ---- impacts: order of the method ---- */

static const char impact_head[] =
    "[time]\nintegrator = \"verlet\"\nend = 1.0\n"
    "[[material]]\nname = \"ball\"\n"
    "[[material]]\nname = \"wall\"\n"
    "[[body]]\nname = \"wall\"\nshape = { plane = true }\nmaterial = \"wall\"\njoint = \"fixed\"\n"
    "[[body]]\nname = \"ball\"\nshape = { sphere = 0.01 }\nmaterial = \"ball\"\nmass = 0.03\n"
    "position = [0, 0, 0.011]\nvelocity = [0, 0, -1]\n"
    "[[contact]]\nbetween = [\"ball\", \"wall\"]\n";

/* Root mean square error of the rebound speed over phases of first touch, at `steps` steps in the time pi sqrt(m/k) (m
 * = 0.03 kg, k = 1e5 N/m); the step is varied as well, so that steps per contact aren't whole numbers. */
static double rebound_error(const char *law, double expected, double steps) {
    enum { PHASES = 60 };
    double sum = 0.0;
    for (int phase = 0; phase < PHASES; phase++) {
        char text[2048], change[128];
        double h = 3.14159265358979 * sqrt(0.03 / 1e5) / (steps - 0.5 + phase / (double)PHASES);
        snprintf(text, sizeof text, "%snormal = { %s }\n", impact_head, law);
        snprintf(change, sizeof change, "time.step=%.17g", h);
        const char *changes[] = {change};
        scree_scene *scene = scene_from(text, changes, 1, 0);
        int ball = scree_scene_find_body(scene, "ball");
        scree_body_state state;
        do {
            go(scene, 1);
            state = scree_scene_body(scene, ball);
        } while (state.velocity[2] < 0.0 || state.position[2] < 0.01);
        go(scene, 2);
        double error = scree_scene_body(scene, ball).velocity[2] - expected;
        sum += error * error;
        scree_scene_destroy(scene);
    }
    return sqrt(sum / PHASES);
}

static void test_impact_order(void) {
    static const struct {
        const char *law;
        double restitution;
    } laws[] = {{"law = \"linear\", stiffness = 1e5, restitution = 0.5", 0.5},
                {"law = \"linear-cut\", stiffness = 1e5, restitution = 0.5", 0.5},
                {"law = \"linear-loading\", stiffness = 1e5, restitution = 0.5", 0.5},
                {"law = \"linear\", stiffness = 1e5, damping = 0.0", 1.0},
                {"law = \"hunt-crossley\", stiffness = 1e5, exponent = 1.0, restitution = 0.5, speed = 1.0", 0.5}};
    for (size_t l = 0; l < sizeof laws / sizeof laws[0]; l++) {
        double coarse = rebound_error(laws[l].law, laws[l].restitution, 50.0);
        double fine = rebound_error(laws[l].law, laws[l].restitution, 200.0);
        NEAR(log(coarse / fine) / log(4.0), 2.0, 0.2);
        CHECK(coarse < 1.2e-3); /* about 3 (h/tc)^2 */
        CHECK(rebound_error(laws[l].law, laws[l].restitution, 1000.0) < 1e-5);
    }
}

/* ---- the check values of the process model ---- */

static void test_incline(void) {
    const char *steady[] = {"motion.slope.velocity=0", "motion.slope.offset=0.36651914291880921"};
    scree_scene *scene = scene_file("incline.toml", steady, 2);
    go(scene, 20000);
    CLOSE(state_of(scene, "product").velocity[0], 0.95966e-3, 1e-5); /* five digits are given */
    CLOSE(state_of(scene, "product").velocity[0], 1e-3 * tan(0.36651914291880921) / 0.4, 1e-10);
    scree_scene_destroy(scene);

    /* The slope at the first of samples 2 ms apart at which the product is faster: the tabulated values. */
    static const double speed[] = {1.5e-3, 5e-3, 10e-3}, slope[] = {21.812, 21.820, 21.832};
    scene = scene_file("incline.toml", NULL, 0);
    int passed = 0;
    for (int sample = 1; passed < 3; sample++) {
        go(scene, 200);
        if (state_of(scene, "product").velocity[0] < speed[passed]) continue;
        NEAR(20.0 + 2.0 * 2e-3 * sample, slope[passed], 1e-9);
        passed++;
    }
    scree_scene_destroy(scene);
}

/* Sliding distance of the product alone (it can't pitch) from a speed to rest. */
static double slide_from(double speed, double threshold) {
    char start[80], limit[80];
    snprintf(start, sizeof start, "body.product.velocity=[%.17g, 0.0, 0.0]", speed);
    snprintf(limit, sizeof limit, "contact.0.friction.threshold=%.17g", threshold);
    const char *changes[] = {start, limit, "motion.stroke.velocity=0.0", "body.product.joint={turn=\"fixed\"}"};
    scree_scene *scene = scene_file("impact_and_slide.toml", changes, 4);
    do {
        go(scene, 500);
    } while (state_of(scene, "product").velocity[0] > 1e-12);
    double distance = state_of(scene, "product").position[0] - 0.015;
    scree_scene_destroy(scene);
    return distance;
}

static void test_sliding_distance(void) {
    /* (v^2 - (1.5 v_th)^2)/(2 mu_k g) + integral of v dv/(mu g) between v_th and 1.5 v_th + v_th^2/(mu_s g), the
     * integral by Simpson's rule, whose error here is below 1e-10 of it. */
    const double g = 9.81, mu_s = 0.4, mu_k = 0.3;
    for (int k = 0; k < 4; k++) {
        double v = k % 2 ? 1.0 : 0.1, threshold = k / 2 ? 1e-2 : 1e-3, middle = 0.0;
        for (int n = 0; n <= 200; n++) {
            double w = 1.0 + 0.5 * n / 200.0, weight = n == 0 || n == 200 ? 1.0 : n % 2 ? 4.0 : 2.0;
            middle += weight * w / (mu_s - (mu_s - mu_k) * 2.0 * (w - 1.0));
        }
        middle *= threshold * threshold * 0.5 / 200.0 / 3.0 / g;
        double exact =
            (v * v - 2.25 * threshold * threshold) / (2.0 * mu_k * g) + middle + threshold * threshold / (mu_s * g);
        CLOSE(slide_from(v, threshold), exact,
              1e-6); /* second order in 5e-6 s x mu_s g/threshold = 2e-2 of the last part */
    }
    NEAR(0.1 * 0.1 / (2.0 * mu_k * g), 1.69895e-3, 5e-9);
    NEAR(1.0 / (2.0 * mu_k * g), 169.8947e-3, 5e-8);
}

/* Velocity of the product after the driven tines have met it. */
static double met_at(double speed, int friction) {
    char velocity[80];
    snprintf(velocity, sizeof velocity, "motion.stroke.velocity=%.17g", speed);
    const char *changes[] = {velocity,
                             "contact.0.friction={law=\"stick-slip\", static=0.3, kinetic=0.3, threshold=1e-4}"};
    scree_scene *scene = scene_file("restitution.toml", changes, friction ? 2 : 1);
    double apart;
    do {
        go(scene, 1);
        apart = state_of(scene, "product").position[0] - state_of(scene, "left tine").position[0] - 0.03;
    } while (apart < 0.0);
    double v = state_of(scene, "product").velocity[0];
    scree_scene_destroy(scene);
    return v;
}

/* A ball that slides all the time is said to slide, whatever the last digit of its friction. */
static void test_sliding_is_told(void) {
    static const char *const integrators[] = {"time.integrator=\"verlet\"", "time.integrator=\"pair-impulse\"",
                                              "time.integrator=\"adaptive\""};
    const char *text = "gravity = [0, 0, -9.81]\n[time]\nend = 0.1\nstep = 1e-4\n[[material]]\nname = \"m\"\n"
                       "density = 1000\n[[contact]]\nbetween = [\"m\", \"m\"]\n"
                       "normal = { law = \"linear\", stiffness = 1e4, restitution = 0.3 }\n"
                       "friction = { law = \"coulomb\", static = 0.3, kinetic = 0.2, stiffness = 1e4 }\n"
                       "[[body]]\nname = \"floor\"\nmaterial = \"m\"\nshape = { plane = true }\njoint = \"fixed\"\n"
                       "[[body]]\nname = \"ball\"\nmaterial = \"m\"\nshape = { sphere = 0.01 }\n"
                       "position = [0, 0, 0.009996]\nvelocity = [3, 0, 0]\n";
    for (size_t k = 0; k < sizeof integrators / sizeof *integrators; k++) {
        scree_scene *scene = scene_from(text, &integrators[k], 1, 1);
        for (int turn = 0; turn < 40; turn++) {
            scree_contact_state contact;
            int count = 0;
            go(scene, 25);
            CHECK(scree_scene_contacts(scene, &contact, 1, &count) == SCREE_OK && count == 1 && contact.sliding == 1);
        }
        CHECK(scree_scene_body(scene, 1).velocity[0] > 2.5);
        scree_scene_destroy(scene);
    }
}

/* What is measured of a slider that just still holds is what it bears, up to mu_s N, and not what it would slide with:
 * between rows force and losses don't fall and come back. Seen in an impact that gets within 1e-3 of the limit. */
static void test_holding_is_told(void) {
    const char *text = "[time]\nend = 0.00046\nintegrator = \"verlet\"\nstep = 2e-5\nspeed = 3\n[[material]]\n"
                       "name = \"m\"\n[[contact]]\nbetween = [\"m\", \"m\"]\n"
                       "normal = { law = \"linear\", stiffness = 1e5, damping = 4 }\n"
                       "friction = { law = \"coulomb\", static = 0.4, kinetic = 0.3, stiffness = 4e4 }\n"
                       "[[body]]\nname = \"a\"\nshape = { sphere = 0.01 }\nmaterial = \"m\"\nmass = 0.01\n"
                       "position = [0, 0, 0.01003]\nvelocity = [0.12984341200730343, -0.4883928071453813, -1]\n"
                       "spin = [111.66026569466669, 101.75433640243062, -7.886717232726255]\n"
                       "[[body]]\nname = \"b\"\nshape = { plane = true }\nmaterial = \"m\"\njoint = \"fixed\"\n"
                       "[output]\nwrite = [\"energy.csv\"]\n";
    scree_scene *scene = scene_from(text, NULL, 0, 1);
    double most = 0.0, lost = 0.0;
    int held = 0;
    for (int k = 0; k < 22; k++) {
        scree_contact_state contact;
        scree_energy energy;
        int count = 0;
        go(scene, 1);
        CHECK(scree_scene_contacts(scene, &contact, 1, &count) == SCREE_OK);
        CHECK(scree_scene_energy(scene, &energy) == SCREE_OK);
        if (!count || contact.sliding || contact.normal_force < 1.0) continue;
        double bears = vec_norm(vec_from(contact.friction)) / contact.normal_force;
        held += bears > 0.39;
        CHECK(!(most > 0.39) || bears > 0.35); /* the load falls by less than a tenth from row to row */
        most = fmax(most, bears);
        CHECK(energy.lost_tangential < lost + 1e-4);
        lost = energy.lost_tangential;
    }
    CHECK(held > 3);
    scree_scene_destroy(scene);
}

static void test_restitution(void) {
    CLOSE(met_at(0.1, 0), 0.15, 1e-5);
    CLOSE(met_at(1.0, 0), 1.5, 1e-5);
    CLOSE(met_at(2.0, 0), 3.0, 1e-5);
    /* With friction on the floor the pair's own equation of motion says what is lost: 0.655 % at 0.1 m/s, 0.0643 % at 1
     * m/s. */
    const struct scree_normal_law *law = scree_normal_laws[scree_find_normal_law("linear-loading")];
    scree_contact_def def = {.normal = {"linear-loading", 2, {{"stiffness", 1e5}, {"restitution", 0.5}}}};
    struct scree_rule rule;
    CHECK(scree_bake_rule(&def, NULL, &rule, NULL) == SCREE_OK);
    struct scree_pair_constants pair = law->pair(&rule.normal_constants, 0.03, 0.0);
    for (int n = 0; n < 2; n++) {
        double speed = n ? 1.0 : 0.1;
        struct scree_impact impact =
            scree_impact(law, &rule.normal_constants, pair, 0.03, speed, 0.3 * 0.03 * 9.81, NULL, NULL);
        NEAR(100.0 * (0.5 - impact.restitution) / 1.5, n ? 0.0643 : 0.655, n ? 5e-5 : 5e-4);
        /* Velocities are predicted from the last step, so friction sets in up to two steps late; and the parting is
         * noticed up to a step late: three steps of mu_k g. */
        NEAR(met_at(speed, 1), (1.0 + impact.restitution) * speed, 3.0 * 1e-6 * 0.3 * 9.81);
    }
}

static void test_conventional(void) {
    struct scree_conventional motion = {.stroke = 0.08, .share = 0.5, .friction = 0.3, .gravity = 9.81};
    NEAR(scree_conventional_limit(&motion), 75.727, 5e-4);
    NEAR(1e3 * scree_conventional_error(&motion, 80.0), 0.499, 5e-4);
    NEAR(1e3 * scree_conventional_error(&motion, 90.0), 4.779, 5e-4);
    NEAR(1e3 * scree_conventional_error(&motion, 100.0), 10.827, 5e-4);
    NEAR(1e3 * scree_conventional_error(&motion, 120.0), 26.934, 5e-4);
    NEAR(scree_conventional_critical(&motion, 1e-3), 81.50, 5e-3);
    NEAR(scree_conventional_critical(&motion, 1e-15) / scree_conventional_limit(&motion), 1.03377, 5e-6);
    CHECK(scree_conventional_error(&motion, 75.0) == 0.0 && scree_conventional_error(&motion, 77.0) == 0.0);
    CHECK(scree_conventional_detachment(&motion, 60.0) == 0.5);
}

/* ---- energy ---- */

static const char bounce_text[] =
    "gravity = [0, 0, -9.81]\n[time]\nintegrator = \"verlet\"\nend = 1.0\nstep = 1e-4\n"
    "[[material]]\nname = \"ball\"\ndensity = 1000\n[[material]]\nname = \"wall\"\n"
    "[[contact]]\nbetween = [\"ball\", \"ball\"]\nnormal = { law = \"linear-cut\", stiffness = 5e3, restitution = 0.7 "
    "}\n"
    "friction = { law = \"coulomb\", static = 0.5, kinetic = 0.4, stiffness = 4e3 }\n"
    "[[contact]]\nbetween = [\"ball\", \"wall\"]\nnormal = { law = \"hunt-crossley\", stiffness = 1e5, factor = 0.3 }\n"
    "friction = { law = \"tanh\", kinetic = 0.3, threshold = 0.05 }\n"
    "[[motion]]\nname = \"shake\"\nkind = \"sine\"\namplitude = 0.001\nfrequency = 20\n"
    "[[body]]\nname = \"floor\"\nshape = { plane = true }\nmaterial = \"wall\"\njoint = { x = \"shake\", z = "
    "\"shake\", others = \"fixed\" }\n"
    "[[body]]\nname = \"a\"\nshape = { sphere = 0.02 }\nmaterial = \"ball\"\nposition = [0, 0, 0.03]\nvelocity = [0.2, "
    "0.1, 0]\nspin = [0, 9, 3]\n"
    "[[body]]\nname = \"b\"\nshape = { box = [0.03, 0.04, 0.05], rounding = 0.004 }\nmaterial = \"ball\"\nposition = "
    "[0.004, 0.002, 0.09]\n"
    "spin = [3, 1, 2]\n"
    "[output]\nwrite = [\"energy.csv\"]\n";

/* What the books lack after 0.05 s (some impacts, still in flight), relative to the energy turned over. */
static double energy_gap(double step) {
    char change[64];
    snprintf(change, sizeof change, "time.step=%.17g", step);
    const char *changes[] = {change};
    scree_scene *scene = scene_from(bounce_text, changes, 1, 0);
    double worst = 0.0, turned = 0.0;
    for (int k = 0; k < 50; k++) {
        go(scene, lround(2e-3 / step));
        scree_energy energy;
        CHECK(scree_scene_energy(scene, &energy) == SCREE_OK);
        worst = scree_most(worst, fabs(energy.balance));
        turned = scree_most(turned, energy.kinetic);
        CHECK(energy.lost_normal >= -1e-9 && energy.lost_tangential >= -1e-9);
    }
    scree_scene_destroy(scene);
    return worst / turned;
}

static void test_energy(void) {
    double coarse = energy_gap(2e-5), fine = energy_gap(2.5e-6);
    CHECK(coarse < 3e-3);
    /* Books and motion are of second order each; contacts that begin and end inside steps make the gap uneven. */
    CHECK(fine < coarse / 16.0);
}

/* Worst balance of the books against the largest energy turned over, and whether friction ever gave energy back. */
static double worst_balance(const char *text, const char *const *changes, int count, long steps, int every) {
    scree_scene *scene = scene_from(text, changes, count, 0);
    double worst = 0.0, turned = 0.0, lost = 0.0;
    for (long k = 0; k < steps; k += every) {
        scree_energy energy;
        go(scene, every);
        CHECK(scree_scene_energy(scene, &energy) == SCREE_OK);
        turned = scree_most(turned, energy.kinetic);
        worst = scree_most(worst, fabs(energy.balance));
        CHECK(energy.lost_tangential >= lost - 1e-12 * turned);
        lost = energy.lost_tangential;
    }
    scree_scene_destroy(scene);
    return worst / turned;
}

/* A sphere that is thrown at a floor slantwise, with a dashpot in the friction law: friction only takes energy, and
 * what is left doesn't hang on the step. */
static void test_friction_takes_energy(void) {
    static const char text[] =
        "[time]\nintegrator = \"verlet\"\nend = 1.0\nstep = 1e-6\n[output]\nwrite = [\"energy.csv\"]\n"
        "[[material]]\nname = \"m\"\ndensity = 1000\n"
        "[[contact]]\nbetween = [\"m\", \"m\"]\nnormal = { law = \"linear\", stiffness = 1e5, restitution = 1.0 }\n"
        "friction = { law = \"coulomb\", static = 0.5, kinetic = 0.5, stiffness = 2e4, damping = 0.1 }\n"
        "[[body]]\nname = \"floor\"\nmaterial = \"m\"\nshape = { plane = true }\njoint = \"fixed\"\n"
        "[[body]]\nname = \"ball\"\nmaterial = \"m\"\nshape = { sphere = 0.02 }\nposition = [0, 0, 0.0205]\n"
        "velocity = [0.2, 0, -1]\n";
    static const char *const steps[] = {"time.step=2e-6", "time.step=1e-6", "time.step=5e-7"};
    double left[3];
    for (int k = 0; k < 3; k++) {
        scree_scene *scene = scene_from(text, &steps[k], 1, 0);
        go(scene, (long)(4e-3 / scree_scene_step_length(scene) + 0.5));
        left[k] = state_of(scene, "ball").velocity[0];
        scree_scene_destroy(scene);
    }
    /* First order in the step: within what friction does in one step at its strongest, mu v sqrt(k/m) h. */
    double one_step = 0.5 * sqrt(1e5 / (1000.0 * 4.0 / 3.0 * acos(-1.0) * 8e-6));
    NEAR(left[0], left[1], one_step * 2e-6);
    NEAR(left[1], left[2], one_step * 1e-6);
    CHECK(worst_balance(text, NULL, 0, 4000, 1) < 1e-5);
}

/* Borders and edges give no energy away: a ball against a step, rolling over a border, and rising from beneath. */
static void test_borders(void) {
    static const char text[] =
        "gravity = [0, 0, -9.81]\n[time]\nintegrator = \"verlet\"\nend = 1.0\nstep = 1e-6\n[output]\nwrite = "
        "[\"energy.csv\"]\n"
        "[[material]]\nname = \"m\"\ndensity = 1000\n"
        "[[contact]]\nbetween = [\"m\", \"m\"]\nnormal = { law = \"linear\", stiffness = 1e5, damping = 0.0 }\n"
        "[[body]]\nname = \"floor\"\nmaterial = \"m\"\nshape = { plane = true }\njoint = \"fixed\"\n"
        "[[body]]\nname = \"plate\"\nmaterial = \"m\"\nshape = { rectangle = [0.2, 0.2] }\njoint = \"fixed\"\n"
        "position = [0.15, 0, 0.008]\n"
        "[[body]]\nname = \"ball\"\nmaterial = \"m\"\nshape = { sphere = 0.01 }\nposition = [0, 0, 0.00999]\n"
        "velocity = [0.5, 0, 0]\n";
    static const char *const over[] = {"body.ball.position=[0.23, 0, 0.018]"};
    static const char *const beneath[] = {"body.ball.position=[0.25, 0, 0.0101]", "body.ball.velocity=[-0.5, 0, 0]",
                                          "body.plate.position=[0.15, 0, 0.03]", "body.ball.shape={sphere=0.009}"};
    /* The step resolves a contact of 2 ms by 2000 steps: the books are right to some (pi/2000)^2/12 of what they turn
     * over, and to first order in the share of a step where contacts begin. */
    CHECK(worst_balance(text, NULL, 0, 120000, 20) < 1e-4);
    CHECK(worst_balance(text, over, 1, 120000, 20) < 1e-4);
    CHECK(worst_balance(text, beneath, 4, 120000, 20) < 1e-4);
    /* A bar that slides off a plate tips over its border: corners stay above while the bar's centre is below. */
    static const char *const bar[] = {"body.ball.shape={box=[0.03, 0.05, 0.012], rounding=0.002}",
                                      "body.ball.position=[0.23, 0, 0.014]", "body.ball.velocity=[0.3, 0, 0]",
                                      "body.floor.position=[0, 0, -1]"};
    CHECK(worst_balance(text, bar, 4, 200000, 20) < 1e-6);
}

/* Cubes that are just as large stand on each other, and bounce off each other edge on edge; too fast ones don't pass
 * unnoticed. */
static void test_cubes(void) {
    static const char text[] =
        "gravity = [0, 0, -9.81]\n[time]\nintegrator = \"verlet\"\nend = 1.0\nstep = 1e-5\n"
        "[[material]]\nname = \"m\"\ndensity = 1000\n"
        "[[contact]]\nbetween = [\"m\", \"m\"]\n"
        "normal = { law = \"linear-cut\", stiffness = 1e5, restitution = 0.3 }\nshared_by = 4\n"
        "[[body]]\nname = \"lower\"\nmaterial = \"m\"\nshape = { box = [0.1, 0.1, 0.1] }\njoint = \"fixed\"\n"
        "[[body]]\nname = \"upper\"\nmaterial = \"m\"\nshape = { box = [0.1, 0.1, 0.1] }\nposition = [0, 0, 0.101]\n";
    scree_scene *scene = scene_from(text, NULL, 0, 0);
    go(scene, 100000);
    /* Upper corners on the lower cube and lower corners on the upper one share the weight: eight springs of k/4. */
    NEAR(state_of(scene, "upper").position[2], 0.1 - 1.0 * 9.81 / 2e5, 1e-9);
    scree_scene_destroy(scene);

    static const char *crossed[] = {"body.upper.position=[0, 0, 0.145]",
                                    "body.lower.orientation={axis=[1, 0, 0], degrees=45}",
                                    "body.upper.orientation={axis=[0, 1, 0], degrees=45}",
                                    "gravity=[0, 0, 0]",
                                    "contact.0.shared_by=1",
                                    "body.upper.velocity=[0, 0, -1]"};
    scene = scene_from(text, crossed, 6, 0);
    go(scene, 4000);
    /* The centres are above each other, so nothing turns. Of second order: 1000 steps in pi sqrt(m/k). */
    NEAR(state_of(scene, "upper").velocity[2], 0.3, 1e-5);
    NEAR(vec_norm(vec_from(state_of(scene, "upper").spin)), 0.0, 1e-12);
    scree_scene_destroy(scene);

    crossed[5] = "body.upper.velocity=[0, 0, -20]"; /* v sqrt(m/k) is 63 mm, and 25 are tolerable */
    scene = scene_from(text, crossed, 6, 0);
    CHECK(scree_scene_step(scene, 100000) == SCREE_FAILED);
    CONTAINS(scree_scene_trouble(scene)->text, "\"upper\"");
    scree_scene_destroy(scene);
}

/* ---- rest ---- */

static void test_rest(void) {
    /* A product that sticks on a slope below the critical angle doesn't creep: no motion beyond rounding in 1e6
     * steps. */
    const char *sticks[] = {
        "contact.0.friction={law=\"coulomb\", static=0.4, kinetic=0.3, stiffness=4e5, damping=250.0}",
        "motion.slope.velocity=0", "motion.slope.offset=0.25"};
    scree_scene *scene = scene_file("incline.toml", sticks, 3);
    go(scene, 100000);
    double x = state_of(scene, "product").position[0];
    go(scene, 1000000);
    NEAR(state_of(scene, "product").position[0], x, 1e-15);
    CHECK(fabs(state_of(scene, "product").velocity[0]) < 1e-15);
    /* Along z a velocity of less than half a unit of the position's last place a step, 4e-19 m/1e-5 s, moves
     * nothing. */
    CHECK(fabs(state_of(scene, "product").velocity[2]) < 1e-13);
    scree_scene_destroy(scene);
}

/* ---- what doesn't change the result ---- */

static void test_same_bits(void) {
    char *text = heap_text();
    static const char *const energy[] = {"output={write=[\"energy.csv\"]}"};
    uint64_t hash[5];
    int threads[] = {1, 2, 3, 7, 1};
    for (int k = 0; k < 5; k++) {
        scree_scene *scene = scene_from(text, energy, k == 4, threads[k]);
        go(scene, 1500);
        hash[k] = scree_scene_hash(scene);
        if (k == 0) CHECK(scene->contacts.rebuilds > 1);
        scree_scene_destroy(scene);
    }
    for (int k = 1; k < 5; k++) CHECK(hash[k] == hash[0]); /* 4: with measurements */

    /* Saved in the middle and restored into a new scene. */
    scree_scene *scene = scene_from(text, NULL, 0, 0), *other = scene_from(text, NULL, 0, 2);
    FILE *file = tmpfile();
    go(scene, 700);
    CHECK(scree_scene_save(scene, file, "memory") == SCREE_OK);
    rewind(file);
    CHECK(scree_scene_restore(other, file, "memory") == SCREE_OK);
    CHECK(scree_scene_hash(other) == scree_scene_hash(scene));
    CHECK(scree_scene_steps(other) == 700);
    go(other, 800);
    CHECK(scree_scene_hash(other) == hash[0]);
    CHECK(scree_scene_step(other, -1) == SCREE_BAD_INPUT);
    CHECK(scree_scene_hash(other) == hash[0]);
    FILE *full = fopen("/dev/full", "wb");
    CHECK(!full || scree_scene_save(scene, full, "full") == SCREE_NO_FILE);
    if (full) fclose(full);
    FILE *folder = fopen("/", "rb");
    CHECK(!folder || scree_scene_restore(other, folder, "folder") == SCREE_NO_FILE);
    if (folder) fclose(folder);
    CHECK(scree_scene_step(other, LONG_MIN) == SCREE_BAD_INPUT && scree_scene_step(other, LONG_MAX) == SCREE_BAD_INPUT);

    /* A damaged file, a cut one, and one of another scene change nothing. */
    uint64_t before = scree_scene_hash(other);
    fseek(file, 5000, SEEK_SET);
    fputc(0x5a, file);
    rewind(file);
    CHECK(scree_scene_restore(other, file, "memory") == SCREE_BAD_INPUT);
    CONTAINS(scree_scene_trouble(other)->text, "damaged");
    for (long at = 0; at < 400; at++) { /* the head, with the number of contacts that follow */
        fseek(file, at, SEEK_SET);
        int byte = fgetc(file);
        fseek(file, at, SEEK_SET);
        fputc(byte ^ 0x40, file);
        rewind(file);
        CHECK(scree_scene_restore(other, file, "memory") == SCREE_BAD_INPUT);
        fseek(file, at, SEEK_SET);
        fputc(byte, file);
    }
    CHECK(ftruncate(fileno(file), 9000) == 0);
    rewind(file);
    CHECK(scree_scene_restore(other, file, "memory") == SCREE_BAD_INPUT);
    scree_scene *foreign = scene_file("incline.toml", NULL, 0);
    rewind(file);
    CHECK(scree_scene_restore(foreign, file, "memory") == SCREE_BAD_INPUT);
    CONTAINS(scree_scene_trouble(foreign)->text, "another scene");
    CHECK(scree_scene_hash(other) == before);
    fclose(file);
    scree_scene_destroy(foreign);
    scree_scene_destroy(scene);
    scree_scene_destroy(other);
    free(text);
}

/* ---- what a state belongs to ---- */

/* A scene with every part that decides how it goes on: contacts that remember, a drive, a hinge, tilting gravity. */
static const char parts_text[] =
    "gravity = { vector = [0, 0, -9.81], axis = [0, 1, 0], tilt = \"tip\" }\n[time]\nintegrator = \"verlet\"\nend = "
    "0.1\n"
    "[[material]]\nname = \"ball\"\ndensity = 1000\n[[material]]\nname = \"wall\"\n"
    "[[contact]]\nbetween = [\"ball\", \"ball\"]\nnone = true\n"
    "[[contact]]\nbetween = [\"ball\", \"wall\"]\nnormal = { law = \"linear-cut\", stiffness = 5e3, damping = 2.0 "
    "}\n"
    "friction = { law = \"coulomb\", static = 0.5, kinetic = 0.4, stiffness = 4e3 }\n"
    "[[motion]]\nname = \"tip\"\nkind = \"velocity\"\nvelocity = 0.3\n"
    "[[motion]]\nname = \"shake\"\nkind = \"sine\"\namplitude = 1e-4\nfrequency = 20\n"
    "[[body]]\nname = \"floor\"\nshape = { plane = true }\nmaterial = \"wall\"\njoint = { x = \"shake\", others = "
    "\"fixed\" }\n"
    "[[body]]\nname = \"a\"\nshape = { sphere = 0.02 }\nmaterial = \"ball\"\nposition = [0, 0, 0.0199]\n"
    "velocity = [0.2, 0, 0]\n"
    "[[body]]\nname = \"b\"\nshape = { box = [0.03, 0.04, 0.05] }\nmaterial = \"ball\"\nposition = [0.3, 0, 0.1]\n"
    "joint = { turn = { hinge = [0, 0, 1] }, others = \"fixed\" }\nspin = [0, 0, 2]\n"
    "[[material]]\nname = \"shelf\"\n[[contact]]\nbetween = [\"ball\", \"shelf\"]\nnone = true\n"
    "[[body]]\nname = \"shelf\"\nshape = { box = [0.1, 0.1, 0.1], rounding = 0.01 }\nmaterial = \"shelf\"\n"
    "joint = \"fixed\"\nposition = [-1, 0, 0]\n";

/* Restore a saved state into the scene as changed; the scene, for further looks. */
static scree_scene *restore_into(FILE *file, const char *change, scree_status expected) {
    scree_scene *scene = scene_from(parts_text, &change, change ? 1 : 0, 0);
    rewind(file);
    CHECK(scree_scene_restore(scene, file, "memory") == expected);
    return scene;
}

static void test_other_scenes(void) {
    static const char *const refused[][2] = {
        {"gravity.vector=[0.0, 0.0, -9.8]", "what differs: gravity"},
        {"gravity.axis=[1, 0, 0]", "what differs: gravity"},
        {"gravity=[0.0, 0.0, -9.81]", "what differs: gravity"},
        {"motion.tip.velocity=0.2", "what differs: motions"},
        {"motion.shake.phase=0.1", "what differs: motions"},
        {"contact.0={between=[\"ball\", \"ball\"], normal={law=\"linear-cut\", stiffness=5e3, restitution=0.7}}",
         "what differs: contacts"},
        {"contact.1.none=true", "what differs: contacts"},
        {"contact.1.shared_by=2", "what differs: contacts"},
        {"contact.1.corners=true", "what differs: contacts"},
        {"contact.1.normal.law=\"linear\"", "what differs: contacts"},
        {"body.b.joint.turn.hinge=[0, 0, -1]", "what differs: bodies or their joints"},
        {"body.b.mass=3.0", "what differs: bodies or their joints"},
        {"body.b.shape.rounding=0.001", "what differs: bodies or their joints"},
        {"body.floor.joint.x=\"tip\"", "what differs: bodies or their joints"},
        {"body.shelf.shape.rounding=0.02", "what differs: bodies or their joints"},
        {"body.shelf.shape.box=[0.1, 0.1, 0.2]", "what differs: bodies or their joints"},
        {"body.b.orientation={axis=[0, 0, 1], angle=0.1}", "what differs: start positions"},
        {"body.floor.position=[0.1, 0.0, 0.0]", "what differs: start positions"},
        {"time.step=1e-5", "its step is"},
    };
    scree_scene *scene = scene_from(parts_text, NULL, 0, 0);
    FILE *file = tmpfile();
    go(scene, 50);
    CHECK(scree_scene_save(scene, file, "memory") == SCREE_OK);
    for (size_t k = 0; k < sizeof refused / sizeof refused[0]; k++) {
        scree_scene *other = restore_into(file, refused[k][0], SCREE_BAD_INPUT);
        CONTAINS(scree_scene_trouble(other)->text, "another scene");
        CONTAINS(scree_scene_trouble(other)->text, refused[k][1]);
        scree_scene_destroy(other);
    }
    /* What may change: the end (here the automatic step would change with it), the output, the threads. */
    static const char *const allowed[] = {NULL, "time.end=0.17", "output={write=[], every=0.0123}", "time.threads=2",
                                          "title=\"x\""};
    go(scene, 200);
    for (size_t k = 0; k < sizeof allowed / sizeof allowed[0]; k++) {
        scree_scene *other = restore_into(file, allowed[k], SCREE_OK);
        CHECK(scree_scene_step_length(other) == scree_scene_step_length(scene));
        go(other, 200);
        CHECK(scree_scene_hash(other) == scree_scene_hash(scene));
        scree_scene_destroy(other);
    }
    fclose(file);
    scree_scene_destroy(scene);
}

/* So is one of a larger scene, though what it tells of its bodies makes no sense in the smaller one; and what isn't
 * open is no file. */
static void test_larger_scene(void) {
    scree_scene *large = scene_file("bed.toml", NULL, 0), *small = scene_file("bounce.toml", NULL, 0);
    FILE *file = tmpfile();
    int ball, host;
    go(large, 3000);
    scree_scene_deepest(large, &ball, &host);
    CHECK(ball >= scree_scene_bodies(small) || host >= scree_scene_bodies(small));
    CHECK(scree_scene_save(large, file, "memory") == SCREE_OK);
    rewind(file);
    CHECK(scree_scene_restore(small, file, "memory") == SCREE_BAD_INPUT);
    CONTAINS(scree_scene_trouble(small)->text, "another scene");
    CHECK(scree_scene_restore(small, NULL, "lost.state") == SCREE_NO_FILE);
    CONTAINS(scree_scene_trouble(small)->text, "lost.state");
    CHECK(scree_scene_save(small, NULL, "lost.state") == SCREE_NO_FILE);
    fclose(file);
    scree_scene_destroy(large);
    scree_scene_destroy(small);
}

static int same_files(FILE *one, FILE *other) {
    int c = 0;
    rewind(one);
    rewind(other);
    while (c != EOF && (c = fgetc(one)) == fgetc(other)) continue;
    return c == EOF;
}

/* What a state holds is all restored, the books and what is told of contacts too: saved again, it is the same file. */
static void test_saved_again(void) {
    static const char *const integrators[] = {"time.integrator=\"verlet\"", "time.integrator=\"pair-impulse\"",
                                              "time.integrator=\"adaptive\""};
    for (int k = 0; k < 3; k++) {
        const char *changes[] = {integrators[k], "output={write=[\"energy.csv\"]}",
                                 "contact.1.friction={law=\"ramp\", kinetic=0.4, threshold=1e-2}"};
        scree_scene *scene = scene_from(parts_text, changes, 3, 0), *other = scene_from(parts_text, changes, 3, 0);
        FILE *file = tmpfile(), *again = tmpfile();
        scree_energy energy;
        go(scene, 50);
        CHECK(scree_scene_energy(scene, &energy) == SCREE_OK && energy.lost_tangential > 0.0 && energy.driven != 0.0);
        CHECK(scree_scene_steepest(scene, NULL, NULL) > 0.0 || k == 2);
        CHECK(scree_scene_save(scene, file, "first") == SCREE_OK);
        rewind(file);
        CHECK(scree_scene_restore(other, file, "first") == SCREE_OK);
        CHECK(scree_scene_save(other, again, "again") == SCREE_OK);
        CHECK(same_files(file, again));
        fclose(file);
        fclose(again);
        scree_scene_destroy(scene);
        scree_scene_destroy(other);
    }
}

/* What makes no sense in a state is refused though its hash is right; it is there while the scene is saved. */
static void test_senseless_states(void) {
    static const int numbers[] = {99999999, 0, -1, 4, 65};
    static const long steps = -5;
    static const double nan = NAN;
    scree_scene *scene = scene_from(parts_text, NULL, 0, 0);
    go(scene, 50);
    struct scree_bodies *bodies = &scene->bodies;
    struct scree_batch *batch = scene->contacts.batch;
    while (!batch->count) batch++;
    const struct {
        void *place;
        const void *bad;
        size_t size;
    } cases[] = {{&bodies->number[1], &numbers[0], sizeof(int)},
                 {&bodies->number[1], &numbers[1], sizeof(int)},
                 {&bodies->number[1], &numbers[2], sizeof(int)},
                 {&bodies->order.slabs, &numbers[4], sizeof(int)},
                 {&batch->ends[0].ball, &numbers[3], sizeof(int)},
                 {&batch->ends[0].host, &numbers[2], sizeof(int)},
                 {&scene->contacts.deepest_host, &numbers[3], sizeof(int)},
                 {&scene->steps, &steps, sizeof(long)},
                 {&bodies->position[1][2], &nan, sizeof(double)},
                 {&bodies->record[2].turn[1], &nan, sizeof(double)},
                 {&scene->driven, &nan, sizeof(double)},
                 {&scene->watched.motion, &nan, sizeof(double)},
                 {&batch->kept[0][0], &nan, sizeof(double)}};
    for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++) {
        char good[sizeof(double)];
        FILE *file = tmpfile();
        memcpy(good, cases[k].place, cases[k].size);
        memcpy(cases[k].place, cases[k].bad, cases[k].size);
        CHECK(scree_scene_save(scene, file, "memory") == SCREE_OK);
        memcpy(cases[k].place, good, cases[k].size);
        scree_scene *other = restore_into(file, NULL, SCREE_BAD_INPUT);
        CONTAINS(scree_scene_trouble(other)->text, "damaged");
        scree_scene_destroy(other);
        fclose(file);
    }
    scree_scene_destroy(scene);
}

/* Books that begin at a state which holds none are those of a run that starts there: they close. */
static void test_books_begin(void) {
    const char *energy = "output={write=[\"energy.csv\"]}";
    scree_scene *plain = scene_from(parts_text, NULL, 0, 0), *kept = scene_from(parts_text, &energy, 1, 0);
    FILE *file = tmpfile();
    go(plain, 300);
    go(kept, 300);
    CHECK(scree_scene_save(plain, file, "memory") == SCREE_OK);
    scree_scene *begun = restore_into(file, energy, SCREE_OK);
    scree_energy before, after, now;
    CHECK(begun->books_begun);
    CHECK(scree_scene_energy(begun, &now) == SCREE_OK && scree_scene_energy(kept, &before) == SCREE_OK);
    CHECK(now.stored > 0.0 && now.lost_normal == 0.0 && now.lost_tangential == 0.0 && now.driven == 0.0 &&
          now.balance == 0.0);
    go(begun, 300);
    go(kept, 300);
    CHECK(scree_scene_energy(begun, &now) == SCREE_OK && scree_scene_energy(kept, &after) == SCREE_OK);
    /* Both sum up the same terms, from other starts: rounding of some hundred sums of about 0.1 J. */
    NEAR(now.lost_normal, after.lost_normal - before.lost_normal, 1e-14);
    NEAR(now.lost_tangential, after.lost_tangential - before.lost_tangential, 1e-14);
    NEAR(now.driven, after.driven - before.driven, 1e-14);
    NEAR(now.balance, after.balance - before.balance, 1e-14);
    CHECK(fabs(after.lost_tangential - before.lost_tangential) > 1e-12);

    /* And go on from where they began. */
    rewind(file);
    CHECK(scree_scene_save(begun, file, "memory") == SCREE_OK);
    scree_scene_destroy(begun);
    begun = restore_into(file, energy, SCREE_OK);
    CHECK(!begun->books_begun && scree_scene_energy(begun, &after) == SCREE_OK);
    CHECK(memcmp(&after, &now, sizeof now) == 0);

    /* Kept books go on without a break. */
    rewind(file);
    CHECK(scree_scene_save(kept, file, "memory") == SCREE_OK);
    scree_scene_destroy(begun);
    begun = restore_into(file, energy, SCREE_OK);
    CHECK(!begun->books_begun && scree_scene_energy(begun, &now) == SCREE_OK);
    CHECK(scree_scene_energy(kept, &after) == SCREE_OK && memcmp(&after, &now, sizeof now) == 0);
    fclose(file);
    scree_scene_destroy(begun);
    scree_scene_destroy(plain);
    scree_scene_destroy(kept);
}

/* What was listed before, and is no longer after restoring, leaves no trace: a box was near, the spheres' arms turn
 * nothing. */
static void test_restore_forgets_lists(void) {
    static const char text[] =
        "gravity = [0, 0.3, -9.81]\n[time]\nintegrator = \"verlet\"\nend = 1.0\nstep = 1e-4\n"
        "[[material]]\nname = \"m\"\ndensity = 1000\n"
        "[[contact]]\nbetween = [\"m\", \"m\"]\nnormal = { law = \"linear\", stiffness = 1e5, damping = 0.0 }\n"
        "[[body]]\nname = \"floor\"\nmaterial = \"m\"\nshape = { plane = true }\njoint = \"fixed\"\n"
        "orientation = { axis = [1, 2, 0], degrees = 3 }\n"
        "[[body]]\nname = \"ball\"\nmaterial = \"m\"\nshape = { sphere = 0.02 }\nposition = [0, 0, 0.0203]\n"
        "spin = [3, 1, 2]\n"
        "[[body]]\nname = \"box\"\nmaterial = \"m\"\nshape = { box = [0.05, 0.05, 0.05] }\nposition = [1, 0, 0.12]\n"
        "velocity = [0, 0, 5]\n";
    scree_scene *scene = scene_from(text, NULL, 0, 0), *other = scene_from(text, NULL, 0, 0);
    go(scene, 3000);
    FILE *file = tmpfile();
    CHECK(scree_scene_save(scene, file, "file") == SCREE_OK);
    rewind(file);
    CHECK(scree_scene_restore(other, file, "file") == SCREE_OK);
    fclose(file);
    go(scene, 1000);
    go(other, 1000);
    CHECK(scree_scene_hash(scene) == scree_scene_hash(other));
    scree_scene_destroy(scene);
    scree_scene_destroy(other);
}

/* What is remembered of a box's corners goes to a scene that has listed none of them yet: at its start the box is far
 * from the floor on which it slides at last. */
static void test_restored_corners(void) {
    static const char text[] =
        "gravity = [2, 0.5, -9.81]\n[time]\nintegrator = \"verlet\"\nend = 1.0\nstep = 5e-5\n"
        "[[material]]\nname = \"m\"\ndensity = 1000\n"
        "[[contact]]\nbetween = [\"m\", \"m\"]\nnormal = { law = \"linear\", stiffness = 1e4, restitution = 0.2 }\n"
        "friction = { law = \"coulomb\", static = 0.5, kinetic = 0.4, stiffness = 8e3, damping = 2.0 }\n"
        "[[body]]\nname = \"floor\"\nmaterial = \"m\"\nshape = { plane = true }\njoint = \"fixed\"\n"
        "[[body]]\nname = \"box\"\nmaterial = \"m\"\nshape = { box = [0.05, 0.04, 0.03], rounding = 0.004 }\n"
        "position = [0, 0, 0.2]\n";
    scree_scene *scene = scene_from(text, NULL, 0, 0), *other = scene_from(text, NULL, 0, 0);
    const struct scree_batch *floor = scree_batch_for(&other->contacts, other->contacts.rule, SCREE_BALL_PLANE);
    CHECK(!floor->corners);
    go(scene, 8000);
    FILE *file = tmpfile();
    CHECK(scree_scene_save(scene, file, "file") == SCREE_OK);
    rewind(file);
    CHECK(scree_scene_restore(other, file, "file") == SCREE_OK);
    fclose(file);
    CHECK(scree_scene_hash(scene) == scree_scene_hash(other));
    go(scene, 100);
    go(other, 100);
    CHECK(scree_scene_hash(scene) == scree_scene_hash(other));
    int touching;
    CHECK(scree_scene_contacts(scene, NULL, 0, &touching) == SCREE_OK && touching == 4);
    scree_scene_destroy(scene);
    scree_scene_destroy(other);
}

/* Hashes that must come out the same from every compiler, at every optimisation, for every instruction set. The scenes
 * use no function of the maths library but the square root. */
static void test_golden(void) {
    static const char *const changes[] = {"contact.1.normal={law=\"linear-loading\", stiffness=1e5, damping=65.4356}",
                                          "time.step=5e-6"};
    check_golden("hashes.txt", changes, 2, "incline", 3);
}

/* ---- the step and the plan ---- */

static char *plan_of(scree_scene *scene) {
    char *text = calloc(1, 8192);
    FILE *file = fmemopen(text, 8191, "w");
    scree_scene_describe(scene, file);
    fclose(file);
    return text;
}

static void test_plan(void) {
    scree_scene *scene = scene_file("transport.toml", NULL, 0);
    char *plan = plan_of(scene);
    CONTAINS(plan, "bodies: 7 (1 moved by forces, 4 driven, 2 fixed)");
    CONTAINS(plan, "pairs of bodies: 21, of which 4 can meet");
    CONTAINS(plan, "skipped: 15, since forces move neither body");
    CONTAINS(plan, "skipped: 2, since the bodies pass through each other");
    CONTAINS(plan, "linear-loading, stick-slip, stiffness and damping shared by 4 contacts");
    CONTAINS(plan, "creeps at 0.0005 m/s under half");
    CONTAINS(plan, "\"product\" with \"front tine\": none");
    CONTAINS(plan, "4 ball on rectangle");
    CONTAINS(plan,
             "deepest overlap at the start: 7.358e-07 m, 0.00025 of the tolerable, \"product\" with \"left surface\"");
    CONTAINS(plan, "contact memory: no law keeps any");
    CONTAINS(plan, "tilting of gravity");
    CONTAINS(plan, "automatic");
    CONTAINS(plan, "lowered so that 0.001 s (between rows, or of the whole run) is a whole number of steps");
    CHECK(scene->plan.choice.step < scene->plan.choice.limit);
    free(plan);
    scree_scene_destroy(scene);

    const char *alone[] = {"time.step=\"auto\"", "contact.0.none=true"};
    scene = scene_from(bounce_text, alone, 1, 0);
    const struct scree_step_choice *choice = &scene->plan.choice;
    CHECK(choice->step <= choice->duration / 50.0 * (1.0 + 1e-12) &&
          choice->step <= 0.2 * choice->limit * (1.0 + 1e-12));
    NEAR(1.0 / choice->step, round(1.0 / choice->step), 1e-9); /* divides the end */
    scree_scene_destroy(scene);
}

/* A ball on a spring: its largest swing after 1000 steps of `factor` times the limit; 0: the automatic step. */
static double swing_at(double factor, double damping, int *refused) {
    char text[2048], change[64], dashpot[64];
    snprintf(text, sizeof text, "%snormal = { law = \"linear\", stiffness = 1e5, damping = 0.0 }\n", impact_head);
    double c = damping * sqrt(1e5 * 0.03), limit = 2.0 * sqrt(0.03 / 1e5) * (sqrt(1.0 + damping * damping) - damping);
    snprintf(dashpot, sizeof dashpot, "contact.0.normal.damping=%.17g", c);
    snprintf(change, sizeof change, "time.step=%.17g", factor * limit);
    if (factor == 0.0) strcpy(change, "time.step=\"auto\"");
    /* Deep in the plane, so that the contact never opens. */
    const char *changes[] = {dashpot,
                             change,
                             "body.ball.position=[0.0, 0.0, 0.009]",
                             "body.ball.velocity=[0.0, 0.0, 0.0]",
                             "gravity=[0.0, 0.0, -3330.0]",
                             "body.ball.position=[0.0, 0.0, 0.00900001]",
                             "time.force=true"};
    scree_scene *scene;
    struct scree_run_request request;
    scree_trouble trouble;
    *refused = scree_read_scene(text, strlen(text), "t", changes, 6, 0, &scene, &request, &trouble) != SCREE_OK;
    if (*refused) CONTAINS(trouble.text, "stability limit");
    scree_scene_destroy(scene);
    scree_free_request(&request);
    scene = scene_from(text, changes, 7, 0);
    double largest = 0.0, rest = 0.01 - 0.03 * 3330.0 / 1e5;
    for (int k = 0; k < 2000 && largest < 1e-4; k++) {
        if (scree_scene_step(scene, 1)) {
            largest = 1.0;
            break;
        }
        if (k > 1000) largest = scree_most(largest, fabs(state_of(scene, "ball").position[2] - rest));
    }
    scree_scene_destroy(scene);
    return largest;
}

/* Stable 2 % below the limit, unstable 2 % above, where the swing grows or falls by at least 0.5 % a step: by e^5 and
 * more in 1000 steps, from the kick of some 1e-5 m that the first step gives a ball on a dashpot. */
static void test_stability_limit(void) {
    static const double damping[] = {0.0, 0.1, 0.25, 0.5, 1.0, 1.5, 2.0, 3.0, 4.0}; /* 2 zeta */
    for (size_t k = 0; k < sizeof damping / sizeof damping[0]; k++) {
        int refused;
        CHECK(swing_at(0.98, damping[k], &refused) < 1e-6);
        CHECK(!refused);
        CHECK(swing_at(1.02, damping[k], &refused) > 1e-5);
        CHECK(refused);
        CHECK(swing_at(0.0, damping[k], &refused) < 1e-6);
        CHECK(!refused);
    }
}

/* A ball that can't turn swings sideways on a friction spring, 1 kg at 1000 rad/s; the normal spring is soft. What the
 * logarithm of its amplitude grows by in a step; NAN if the step is refused. */
static double growth_of_stretch(double turn, double ratio) {
    char text[2048];
    snprintf(
        text, sizeof text,
        "gravity = [0, 0, -10]\n[time]\nintegrator = \"verlet\"\nend = 1.0\nstep = %.17g\n[[material]]\nname = \"m\"\n"
        "[[body]]\nname = \"wall\"\nshape = { plane = true }\nmaterial = \"m\"\njoint = \"fixed\"\n"
        "[[body]]\nname = \"ball\"\nshape = { sphere = 0.01 }\nmaterial = \"m\"\nmass = 1.0\n"
        "position = [0, 0, 0.009]\nvelocity = [1e-4, 0, 0]\njoint = { turn = \"fixed\" }\n"
        "[[contact]]\nbetween = [\"m\", \"m\"]\nnormal = { law = \"linear\", stiffness = 1e4, damping = 0.0 }\n"
        "friction = { law = \"coulomb\", static = 10.0, kinetic = 10.0, stiffness = 1e6, damping = %.17g }\n",
        turn * 1e-3, 2e3 * ratio);
    scree_scene *scene = NULL;
    struct scree_run_request request;
    scree_trouble trouble;
    double growth = NAN;
    if (scree_read_scene(text, strlen(text), "t", NULL, 0, 1, &scene, &request, &trouble) == SCREE_OK) {
        /* The largest speed in two periods, at the start and 800 steps later. */
        double first = 0.0, last = 0.0;
        long period = lround(2.0 * acos(-1.0) / turn);
        for (long k = 0; k < 800 + 2 * period; k++) {
            double speed = fabs(state_of(scene, "ball").velocity[0]);
            if (k < 2 * period) first = scree_most(first, speed);
            if (k >= 800) last = scree_most(last, speed);
            go(scene, 1);
        }
        growth = log(last / first) / 800.0;
    } else
        CONTAINS(trouble.text, "stability limit");
    scree_scene_destroy(scene);
    scree_free_request(&request);
    return growth;
}

/* Friction springs gain energy of themselves, by the fourth power of the step; what gains 0.2 % a step is refused. */
static void test_growth_of_stretch(void) {
    /* Of leading order: the next is (omega h)^2 beside it. */
    CLOSE(growth_of_stretch(0.2, 0.0), pow(0.2, 4.0) / 8.0, 0.1);
    CLOSE(growth_of_stretch(0.3, 0.0), pow(0.3, 4.0) / 8.0, 0.15);
    CHECK(growth_of_stretch(0.35, 0.0) > 1e-3); /* (8 x 0.002)^(1/4) = 0.3557 is the limit */
    CHECK(isnan(growth_of_stretch(0.36, 0.0)));
    CHECK(isnan(growth_of_stretch(1.0, 0.05)));
    CHECK(growth_of_stretch(0.06, 0.001) < 0.0); /* a little damping outweighs it */
}

/* ---- what stops a run ---- */

static void test_stops(void) {
    char text[2048];
    snprintf(text, sizeof text, "%snormal = { law = \"linear\", stiffness = 1e2, damping = 0.0 }\n", impact_head);
    const char *step[] = {"time.step=1e-5", "body.ball.velocity=[0.0, 0.0, -5.0]"};
    scree_scene *scene = scene_from(text, step, 2, 0);
    CHECK(scree_scene_step(scene, 100000) == SCREE_FAILED);
    const scree_trouble *trouble = scree_scene_trouble(scene);
    CONTAINS(trouble->text, "\"ball\" with \"wall\"");
    CONTAINS(trouble->text, "overlap");
    CHECK(trouble->time > 1e-4 && trouble->time < 0.01);
    CHECK(trouble->time == scree_scene_time(scene)); /* the end of the step */
    CHECK(trouble->body == scree_scene_find_body(scene, "ball") &&
          trouble->other == scree_scene_find_body(scene, "wall"));
    scree_scene_destroy(scene);

    const char *fast[] = {"time.step=1e-4", "body.ball.velocity=[0.0, 0.0, 200.0]"};
    scene = scene_from(text, fast, 2, 0);
    CHECK(scree_scene_step(scene, 100) == SCREE_FAILED);
    CONTAINS(scree_scene_trouble(scene)->text, "pass through others unnoticed");
    scree_scene_destroy(scene);

    /* The tips of a thing that turns count too. */
    const char *whirl[] = {"time.step=1e-4", "body.ball.shape={box=[0.2, 0.02, 0.02]}", "body.ball.spin=[0, 0, 2000]",
                           "body.ball.position=[0, 0, 0.2]", "body.ball.velocity=[0, 0, 0]"};
    scene = scene_from(text, whirl, 5, 0);
    CHECK(scree_scene_step(scene, 100) == SCREE_FAILED);
    CONTAINS(scree_scene_trouble(scene)->text, "tips");
    scree_scene_destroy(scene);

    scene = scene_from(text, step, 1, 0);
    scene->bodies.state[scree_scene_find_body(scene, "ball")].v[1] = NAN;
    CHECK(scree_scene_step(scene, 100) == SCREE_FAILED);
    CONTAINS(scree_scene_trouble(scene)->text, "no longer a finite number");
    CONTAINS(scree_scene_trouble(scene)->text, "\"ball\"");
    scree_scene_destroy(scene);
}

/* A contact for which no step is short enough is named, with its laws. */
static void test_too_stiff(void) {
    static const char *const cases[][3] = {{"contact.0.normal={law=\"linear\", stiffness=1e5, damping=1e308}",
                                            "\"ball\"", "(linear, frictionless) is so stiff"},
                                           {"contact.0.normal={law=\"linear\", stiffness=1e5, damping=1e100}",
                                            "\"ball\"", "; the stiffest contact is that of"}};
    char text[2048];
    snprintf(text, sizeof text, "%snormal = { law = \"linear\", stiffness = 1e2, damping = 0.0 }\n", impact_head);
    for (int k = 0; k < 2; k++) {
        scree_scene *scene;
        struct scree_run_request request;
        scree_trouble trouble = {0};
        CHECK(scree_read_scene(text, strlen(text), "t", cases[k], 1, 0, &scene, &request, &trouble) == SCREE_BAD_INPUT);
        CONTAINS(trouble.text, cases[k][1]);
        CONTAINS(trouble.text, cases[k][2]);
        scree_free_request(&request);
    }
}

/* Speeds and energies beyond what numbers hold are told, at the start and on the way. */
static void test_beyond_numbers(void) {
    static const char text[] = "[time]\nend = 1.0\n[output]\nwrite = [\"energy.csv\"]\n"
                               "[[material]]\nname = \"m\"\ndensity = 1000\n"
                               "[[body]]\nname = \"ball\"\nmaterial = \"m\"\nshape = { sphere = 0.01 }\n";
    static const char *const cases[][2] = {
        {"body.ball.spin=[0, 0, 1e160]", "the speed to reckon with, inf m/s"},
        {"time.speed=1e200", "the speed to reckon with, 1e+200 m/s"},
        {"body.ball={name=\"ball\", material=\"m\", shape={sphere=0.01}, mass=1e303, velocity=[1e4, 0, 0]}",
         "body \"ball\": its energy is beyond"}};
    for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++) {
        scree_scene *scene;
        struct scree_run_request request;
        scree_trouble trouble = {0};
        CHECK(scree_read_scene(text, strlen(text), "t", cases[k], 1, 0, &scene, &request, &trouble) != SCREE_OK);
        CONTAINS(trouble.text, cases[k][1]);
        scree_scene_destroy(scene);
        scree_free_request(&request);
    }
    scree_scene *scene = scene_from(text, NULL, 0, 0);
    scree_energy energy;
    scene->bodies.state[0].v[0] = 1e200;
    CHECK(scree_scene_energy(scene, &energy) == SCREE_FAILED);
    CONTAINS(scree_scene_trouble(scene)->text, "\"ball\"");
    scene->bodies.state[0].v[0] = 0.0;
    scene->contacts.lost_normal = NAN;
    CHECK(scree_scene_energy(scene, &energy) == SCREE_FAILED);
    CONTAINS(scree_scene_trouble(scene)->text, "what contacts took or drives gave");
    scree_scene_destroy(scene);
}

/* ---- definitions in C ---- */

/* A scene that isn't baked, or can't be, answers every question without a crash. */
static void check_unbaked(scree_scene *scene) {
    scree_energy energy;
    int count = 5;
    char plan[200] = "";
    FILE *file = fmemopen(plan, sizeof plan, "w");
    CHECK(scree_scene_energy(scene, &energy) == SCREE_BAD_INPUT && energy.kinetic == 0.0);
    CHECK(scree_scene_contacts(scene, NULL, 0, &count) == SCREE_BAD_INPUT && count == 0);
    CHECK(scree_scene_body(scene, 0).position[2] == 0.2);
    CHECK(scree_scene_body(scene, 99).orientation[0] == 1.0);
    CHECK(scree_scene_body_name(scene, -1).text[0] == 0 && scree_scene_body_moves(scene, 99) == 0);
    CLOSE(scree_scene_body_mass(scene, 0), 4.0 / 3.0 * acos(-1.0), 1e-15);
    scree_scene_describe(scene, file);
    CHECK(scree_scene_save(scene, file, "memory") == SCREE_BAD_INPUT);
    CHECK(scree_scene_restore(scene, file, "memory") == SCREE_BAD_INPUT);
    fclose(file);
    CONTAINS(plan, "no plan");
}

/* What impacts come to, against the closed forms of a spring without dashpot: e = 1, pi sqrt(m/k), v sqrt(m/k). */
static void test_plan_of_impacts(void) {
    const char *changes[] = {"contact.0.normal={law=\"linear\", stiffness=5e4, restitution=1.0}", "time.speed=2.0"};
    scree_scene *scene = scene_file("bounce.toml", changes, 2);
    char *plan = plan_of(scene), line[160];
    double ball = sqrt(scree_scene_body_mass(scene, 0) / 5e4);
    for (double speed = 0.02; speed < 3.0; speed *= 10.0) {
        snprintf(line, sizeof line, "at %.3g m/s: restitution 1.0000, contact time %.4g s, overlap %.4g m", speed,
                 acos(-1.0) * ball, speed * ball);
        CONTAINS(plan, line);
    }
    free(plan);
    scree_scene_destroy(scene);
}

/* The softest body isn't always the lightest: a long thin rod is moved more easily at its end than a lighter ball. */
static void test_softest(void) {
    static const char text[] =
        "[time]\nintegrator = \"verlet\"\nend = 1.0\n[[material]]\nname = \"m\"\n"
        "[[contact]]\nbetween = [\"m\", \"m\"]\n"
        "normal = { law = \"linear\", stiffness = 1e5, damping = 0 }\n"
        "[[body]]\nname = \"floor\"\nmaterial = \"m\"\nshape = { plane = true }\njoint = \"fixed\"\n"
        "[[body]]\nname = \"light\"\nmaterial = \"m\"\nmass = 0.01\nshape = { box = [0.1, 0.1, 0.1] }\n"
        "position = [0, 0, 0.1]\n"
        "[[body]]\nname = \"soft\"\nmaterial = \"m\"\nmass = 0.0101\nshape = { box = [0.001, 0.001, 0.1] }\n"
        "position = [1, 0, 0.1]\n";
    scree_scene *scene = scene_from(text, NULL, 0, 0);
    const int *pair = scene->plan.choice.limit_pair;
    CHECK(strcmp(scree_name_of(scene, pair[0]).text, "soft") == 0 ||
          strcmp(scree_name_of(scene, pair[1]).text, "soft") == 0);
    scree_scene_destroy(scene);

    /* Bodies that only turn: a step all the same, and no restitution. */
    const char *hinged[] = {"body.light.joint={turn={hinge=[0, 1, 0]}, others=\"fixed\"}",
                            "body.soft.joint={turn={hinge=[0, 1, 0]}, others=\"fixed\"}"};
    scene = scene_from(text, hinged, 2, 0);
    /* The rod turns about its middle: 1/m = h^2/I at its end, so pi sqrt(I/(h^2 k))/50 at most. */
    CHECK(scene->step < acos(-1.0) * sqrt(0.0101 / 3.0 / 1e5) / 50.0);
    scree_scene_destroy(scene);
    const char *restitution[] = {hinged[0], hinged[1],
                                 "contact.0.normal={law=\"linear\", stiffness=1e5, restitution=0.5}"};
    struct scree_run_request request;
    scree_trouble trouble;
    CHECK(scree_read_scene(text, strlen(text), "t", restitution, 3, 0, &scene, &request, &trouble) == SCREE_BAD_INPUT);
    CONTAINS(trouble.text, "give a damping instead");
    scree_scene_destroy(scene);
    scree_free_request(&request);
}

static void check_bad_materials(scree_scene *scene) {
    CHECK(scree_scene_add_material(scene, &(scree_material_def){.name = "a"}, NULL) == SCREE_BAD_INPUT);
    CONTAINS(scree_scene_trouble(scene)->text, "two of the material");
    CHECK(scree_scene_add_material(scene, &(scree_material_def){.name = ""}, NULL) == SCREE_BAD_INPUT);
    CHECK(scree_scene_add_material(scene, &(scree_material_def){.name = "x", .density = -1.0}, NULL) ==
          SCREE_BAD_INPUT);
}

/* `good` has been added; the others are between material b and itself. */
static void check_bad_contacts(scree_scene *scene, scree_contact_def good, int b) {
    CHECK(scree_scene_add_contact(scene, &(scree_contact_def){.between = {0, 7}}) == SCREE_BAD_INPUT);
    CHECK(scree_scene_add_contact(scene, &good) == SCREE_BAD_INPUT);
    good.between[0] = b;
    scree_contact_def unnamed = good, crowded = good, doubled = good, empty = good;
    unnamed.normal.setting[1].name = NULL;
    crowded.normal.settings = SCREE_SETTINGS_MAX + 1;
    doubled.normal.setting[1] = doubled.normal.setting[0];
    empty.normal = (scree_law_choice){.law = "table"};
    empty.table = &(scree_force_table){.overlaps = 2, .speeds = 1};
    CHECK(scree_scene_add_contact(scene, &unnamed) == SCREE_BAD_INPUT);
    CHECK(scree_scene_add_contact(scene, &crowded) == SCREE_BAD_INPUT);
    CHECK(scree_scene_add_contact(scene, &doubled) == SCREE_BAD_INPUT);
    CONTAINS(scree_scene_trouble(scene)->text, "given twice");
    CHECK(scree_scene_add_contact(scene, &empty) == SCREE_BAD_INPUT);
    CONTAINS(scree_scene_trouble(scene)->text, "needs overlaps, speeds and forces");
}

/* A ball with one fault each; `heavy`: a material without a density. */
static void check_bad_bodies(scree_scene *scene, scree_body_def ball, int heavy, int motion) {
    scree_body_def bad[15];
    for (int k = 0; k < 15; k++) bad[k] = ball;
    bad[0].material = 5;
    bad[1].position[1] = NAN;
    bad[2].mass = -1.0;
    bad[3].material = heavy; /* no density and no mass */
    bad[4].shape.radius = 0.0;
    bad[5].orientation[0] = INFINITY;
    bad[6].joint.along[0] = SCREE_DRIVEN;
    bad[6].joint.along_motion[0] = 3;
    bad[7].joint.along[0] = SCREE_FIXED;
    bad[7].velocity[0] = 1.0;
    bad[8].joint.turn = SCREE_FIXED;
    bad[8].spin[2] = 1.0;
    bad[9].joint.turn = SCREE_DRIVEN;
    bad[9].joint.turn_motion = motion; /* no axis */
    bad[10].shape = (scree_shape){.kind = SCREE_PLANE};
    bad[11].shape = (scree_shape){.kind = SCREE_PLANE};
    for (int k = 0; k < 3; k++) bad[11].joint.along[k] = SCREE_FIXED;
    bad[11].joint.turn = SCREE_DRIVEN;
    bad[11].joint.turn_motion = motion;
    bad[11].joint.axis[0] = 1.0; /* not its normal */
    bad[12].joint.along[1] = (scree_freedom)9;
    bad[13].joint.axis[0] = 1e-200; /* no direction left */
    bad[14].shape.radius = 1e-110;  /* its mass vanishes */
    for (int k = 0; k < 15; k++) {
        CHECK(scree_scene_add_body(scene, &bad[k], NULL) == SCREE_BAD_INPUT);
        CHECK(scree_scene_trouble(scene)->text[0] != '\0' && scree_scene_trouble(scene)->field[0] != '\0');
    }
}

static void test_definitions(void) {
    scree_scene *scene = scree_scene_create();
    int a, b, motion;
    CHECK(scree_scene_step(scene, 1) == SCREE_BAD_INPUT);
    CHECK(scree_scene_bake(scene) == SCREE_BAD_INPUT);
    CHECK(scree_scene_add_material(scene, &(scree_material_def){.name = "a", .density = 1000.0}, &a) == SCREE_OK);
    check_bad_materials(scene);
    CHECK(scree_scene_add_material(scene, &(scree_material_def){.name = "b"}, &b) == SCREE_OK);
    CHECK(scree_scene_add_motion(scene, &(scree_motion_def){.name = "turn", .velocity = 1.0}, &motion) == SCREE_OK);
    scree_contact_def contact = {.between = {a, b}, .normal = {"linear", 2, {{"stiffness", 1e4}, {"damping", 0.0}}}};
    CHECK(scree_scene_add_contact(scene, &contact) == SCREE_OK);
    check_bad_contacts(scene, contact, b);
    CHECK(scree_scene_set_time(scene, &(scree_time_def){.integrator = (scree_integrator)7}) == SCREE_BAD_INPUT);

    scree_body_def ball = {
        .name = "ball", .shape = {.kind = SCREE_SPHERE, .radius = 0.1}, .material = a, .position = {0, 0, 0.2}};
    check_bad_bodies(scene, ball, b, motion);
    CHECK(scree_scene_add_body(scene, &ball, NULL) == SCREE_OK);
    CHECK(scree_scene_add_body(scene, &ball, NULL) == SCREE_BAD_INPUT);
    ball.name = "second";
    ball.position[0] = 0.5;
    CHECK(scree_scene_add_body(scene, &ball, NULL) == SCREE_OK);
    check_unbaked(scene);
    CHECK(scree_scene_bake(scene) == SCREE_BAD_INPUT); /* no contact between a and a */
    CONTAINS(scree_scene_trouble(scene)->text, "\"a\" and \"a\"");
    check_unbaked(scene);
    CHECK(scree_scene_bake(scene) == SCREE_BAD_INPUT);
    CONTAINS(scree_scene_trouble(scene)->text, "anew");
    CHECK(scree_scene_step(scene, 1) == SCREE_BAD_INPUT);
    CHECK(scree_scene_add_body(scene, &ball, NULL) == SCREE_BAD_INPUT);
    scree_scene_destroy(scene);
    scree_scene_destroy(NULL);
}

/* ---- lists leave no trace ---- */

/* Two boxes that come deep into each other, more than their contacts say; and streams of spheres that speed up until
 * one crosses in a step what lists look ahead. */
static const char deep_boxes[] =
    "gravity = [0, 0, -9.81]\n[time]\nend = 0.01\nstep = 2e-5\nintegrator = \"verlet\"\n"
    "[[material]]\nname = \"a\"\ndensity = 1000\n"
    "[[contact]]\nbetween = [\"a\", \"a\"]\nnormal = { law = \"linear\", stiffness = 1000, restitution = 0.5 }\n"
    "[[body]]\nname = \"lower\"\nshape = { box = [0.03, 0.03, 0.02], rounding = 0.002 }\nmaterial = \"a\"\n"
    "joint = \"fixed\"\n"
    "[[body]]\nname = \"upper\"\nshape = { box = [0.024, 0.028, 0.02], rounding = 0.002 }\nmaterial = \"a\"\n"
    "position = [0.005, 0.005, 0.028]\norientation = { axis = [1, 1, 0], degrees = 20 }\nvelocity = [0, 0, -1.5]\n";

static const char fast_stream[] =
    "gravity = [400, 0, 0]\n[time]\nend = 0.01\nstep = 1e-4\nintegrator = \"verlet\"\n"
    "[[material]]\nname = \"a\"\ndensity = 1000\n"
    "[[contact]]\nbetween = [\"a\", \"a\"]\nnormal = { law = \"linear\", stiffness = 1e3, restitution = 0.9 }\n"
    "[[generate]]\nname = \"g\"\nkind = \"lattice\"\nmin = [0, 0, 0]\nmax = [0.4, 0.2, 0.1]\nradius = 0.01\n"
    "material = \"a\"\nspacing = 0.021\ncount = 150\nvelocity = [38.5, 0, 0]\n"
    "[[generate]]\nname = \"h\"\nkind = \"lattice\"\nmin = [0, 0, 0.2]\nmax = [0.4, 0.2, 0.4]\nradius = 0.01\n"
    "material = \"a\"\nspacing = 0.021\ncount = 150\nvelocity = [39, 0, 0]\n";

/* Up to `steps` steps, lists made anew in some of them. */
static long run_with_lists(const char *text, long steps, long lists_every, double *deepest, uint64_t *hash) {
    scree_scene *scene = scene_from(text, NULL, 0, 1);
    scree_status status = SCREE_OK;
    while (!status && scree_scene_steps(scene) < steps) {
        if (lists_every && scree_scene_steps(scene) % lists_every == 0)
            CHECK(scree_contacts_list(&scene->contacts, &scene->bodies, 1, NULL) == SCREE_OK);
        status = scree_scene_step(scene, 1);
    }
    long done = scree_scene_steps(scene);
    *deepest = scree_scene_deepest(scene, NULL, NULL);
    *hash = scree_scene_hash(scene);
    scree_scene_destroy(scene);
    return done;
}

/* Neither how deep bodies were nor when a run stops depends on when lists happen to be made, as after a break. */
static void test_lists_leave_no_trace(void) {
    static const char *const texts[] = {deep_boxes, fast_stream};
    for (int t = 0; t < 2; t++) {
        double deepest[3];
        uint64_t hash[3];
        long done[3];
        for (int way = 0; way < 3; way++)
            done[way] = run_with_lists(texts[t], 800, way ? 10 * way - 9 : 0, &deepest[way], &hash[way]);
        CHECK(t == 0 ? done[0] == 800 && deepest[0] > 0.5 : done[0] < 100);
        for (int way = 1; way < 3; way++)
            CHECK(done[way] == done[0] && deepest[way] == deepest[0] && hash[way] == hash[0]);
    }
}

static int signed_zeros(const double *value, int first, int count) {
    int found = 0;
    for (int k = first; value && k < first + count; k++) found += value[k] == 0.0 && signbit(value[k]);
    return found;
}

/* What contacts keep that have parted: zeros without a sign, as those begin with that are listed anew. */
static void test_kept_zeros(void) {
    static const char text[] =
        "[time]\nend = 0.01\nstep = 1e-5\n[[material]]\nname = \"a\"\ndensity = 1000\n"
        "[[contact]]\nbetween = [\"a\", \"a\"]\nnormal = { law = \"hertz\", stiffness = 1e6 }\n"
        "friction = { law = \"mindlin\", static = 0.4, kinetic = 0.3, shear_modulus = 1e7 }\n"
        "rolling = { law = \"spring-dashpot\", rolling = 0.05, twisting = 0.02, stiffness = 1e3 }\n"
        "[[body]]\nname = \"left\"\nshape = { sphere = 0.01 }\nmaterial = \"a\"\nvelocity = [0.3, 0, 0.1]\n"
        "spin = [30, 20, 10]\nposition = [-0.01005, 0, 0]\n"
        "[[body]]\nname = \"right\"\nshape = { sphere = 0.01 }\nmaterial = \"a\"\nvelocity = [-0.3, 0.1, 0]\n"
        "spin = [-30, 20, -10]\nposition = [0.01005, 0, 0]\n";
    static const char *const integrators[] = {"time.integrator=\"verlet\"", "time.integrator=\"pair-impulse\""};
    for (int i = 0; i < 2; i++) {
        scree_scene *scene = scene_from(text, &integrators[i], 1, 1);
        int found = 0, looked = 0, touched = 0;
        for (int step = 0; step < 200; step++) {
            go(scene, 1);
            for (int b = 0; b < scene->contacts.batches; b++) {
                const struct scree_batch *batch = &scene->contacts.batch[b];
                int first = scree_first(batch);
                if (first < 0) continue;
                looked++;
                for (int m = 0; m < SCREE_MEMORY; m++) found += signed_zeros(batch->kept[m], first, 1);
                for (int m = 0; m < SCREE_PAST; m++) found += signed_zeros(batch->past[m], first, 1);
                touched += batch->kept[0][first] != 0.0;
            }
        }
        CHECK(found == 0 && touched > 10 && touched < looked - 10);
        scree_scene_destroy(scene);
    }
}

static const char box_on_floor[] =
    "[time]\nend = 1\n[[material]]\nname = \"m\"\n[[contact]]\nbetween = [\"m\", \"m\"]\n"
    "normal = { law = \"linear\", stiffness = 1e4, restitution = 0.5 }\n"
    "[[body]]\nname = \"product\"\nmaterial = \"m\"\nshape = { box = [1, 1, 1] }\nmass = 0.03\n"
    "position = [0, 0, 1]\n"
    "[[body]]\nname = \"floor\"\nmaterial = \"m\"\nshape = { plane = true }\njoint = \"fixed\"\n";

/* What limits the step of a box: at least what any one corner gives way to a force in any direction, at most what four
 * corners of a solid box do together, however elongated it is: 4 (1/m + 3/m) sideways, with tilting, less than 16/m. */
static void test_softness_of_boxes(void) {
    uint64_t seed = 5;
    for (int n = 0; n < 50; n++) {
        double edge[3];
        for (int k = 0; k < 3; k++) edge[k] = 0.01 * exp(check_between(&seed, -2.0, 2.0));
        char shape[160];
        snprintf(shape, sizeof shape, "body.product.shape={box=[%.17g,%.17g,%.17g]}", edge[0], edge[1], edge[2]);
        const char *changes[] = {shape, "time.step=1e-9", "time.force=true"};
        scree_scene *scene = scene_from(box_on_floor, changes, 3, 1);
        const struct scree_bodies *bodies = &scene->bodies;
        int box = bodies->place[scree_scene_find_body(scene, "product")];
        double softest = fmax(scree_softness(bodies, box, 0), scree_softness(bodies, box, 1));
        const double *w = scree_kind_of(bodies, box)->inertia.inverse_moments,
                     centre = bodies->record[box].inverse_mass;
        struct vec corner = {0.5 * edge[0], 0.5 * edge[1], 0.5 * edge[2]};
        for (int k = 0; k < 200; k++) {
            struct vec force = {check_between(&seed, -1.0, 1.0), check_between(&seed, -1.0, 1.0),
                                check_between(&seed, -1.0, 1.0)};
            force = vec_scale(1.0 / vec_norm(force), force);
            struct vec torque = vec_cross(corner, force);
            CHECK(centre + torque.x * torque.x * w[0] + torque.y * torque.y * w[1] + torque.z * torque.z * w[2] <=
                  softest * (1.0 + 1e-12));
        }
        CHECK(softest < 16.0 * centre);
        scree_scene_destroy(scene);
    }
}

int main(void) {
    test_lists_leave_no_trace();
    test_kept_zeros();
    test_impact_order();
    test_incline();
    test_sliding_distance();
    test_sliding_is_told();
    test_holding_is_told();
    test_restitution();
    test_conventional();
    test_energy();
    test_friction_takes_energy();
    test_borders();
    test_cubes();
    test_rest();
    test_same_bits();
    test_restore_forgets_lists();
    test_restored_corners();
    test_other_scenes();
    test_larger_scene();
    test_saved_again();
    test_senseless_states();
    test_books_begin();
    test_golden();
    test_plan();
    test_plan_of_impacts();
    test_stability_limit();
    test_growth_of_stretch();
    test_stops();
    test_too_stiff();
    test_beyond_numbers();
    test_definitions();
    test_softest();
    test_softness_of_boxes();
    return check_report();
}
