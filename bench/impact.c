/* scree-bench impact: error of the restitution against the step. */
#include "bench/bench.h"

#include <math.h>

static const char help[] = "usage: scree-bench impact [--phases N]\n"
                           "\n"
                           "A ball of 0.03 kg meets a plane at 1 m/s, e = 0.5 (and 1): largest error of the rebound "
                           "speed over phases of first touch,\n"
                           "against the number of steps in the time pi sqrt(m/k), which is not kept a whole number. "
                           "Columns: law, steps per contact,\n"
                           "step (s), largest error, observed order since the row before, nanoseconds per step.\n"
                           "Unless given: --phases 64.\n"
                           "\n"
                           "example: scree-bench impact --phases 64\n";

enum { LAWS = 5, ROWS = 9 };
static const double contact_time = 1.7207211613e-3; /* pi sqrt(m/k) for 0.03 kg and 1e5 N/m, s */

static const struct {
    const char *name, *choice;
    double restitution;
} laws[LAWS] = {
    {"linear", "law=\"linear\", stiffness=1e5, restitution=0.5", 0.5},
    {"linear-cut", "law=\"linear-cut\", stiffness=1e5, restitution=0.5", 0.5},
    {"linear-loading", "law=\"linear-loading\", stiffness=1e5, restitution=0.5", 0.5},
    {"linear elastic", "law=\"linear\", stiffness=1e5, damping=0.0", 1.0},
    {"hunt-crossley", "law=\"hunt-crossley\", stiffness=1e5, exponent=1.0, restitution=0.5, speed=1.0", 0.5},
};

static const char scene_text[] =
    "[time]\nintegrator = \"verlet\"\nend = 1.0\n[[material]]\nname = \"ball\"\n[[material]]\nname = \"wall\"\n"
    "[[body]]\nname = \"wall\"\nshape = { plane = true }\nmaterial = \"wall\"\njoint = \"fixed\"\n"
    "[[body]]\nname = \"ball\"\nshape = { sphere = 0.01 }\nmaterial = \"ball\"\nmass = 0.03\n"
    "position = [0, 0, 0.0105]\nvelocity = [0, 0, -1]\n"
    "[[contact]]\nbetween = [\"ball\", \"wall\"]\n";

/* Rebound speed at a step; adds the steps that it took. */
static double rebound(const char *choice, double step, long *steps) {
    char change[64], text[1024];
    snprintf(text, sizeof text, "%snormal = { %s }\n", scene_text, choice);
    snprintf(change, sizeof change, "time.step=%.17g", step);
    const char *changes[] = {change};
    scree_scene *scene = bench_scene_text(text, changes, 1);
    int ball = scree_scene_find_body(scene, "ball");
    scree_body_state state;
    do {
        bench_step(scene, 1);
        state = scree_scene_body(scene, ball);
    } while (state.velocity[2] < 0.0 || state.position[2] < 0.01);
    bench_step(scene, 2);
    double speed = scree_scene_body(scene, ball).velocity[2];
    *steps += scree_scene_steps(scene);
    scree_scene_destroy(scene);
    return speed;
}

static void measure(int law, int phases) {
    static const double per_contact[ROWS] = {10, 20, 50, 100, 200, 500, 1000, 2000, 5000};
    double before = 0.0;
    for (int row = 0; row < ROWS; row++) {
        double worst = 0.0, start = bench_now();
        long steps = 0;
        for (int phase = 0; phase < phases; phase++) {
            double step = contact_time / (per_contact[row] - 0.5 + (phase + 0.5) / phases);
            worst = scree_most(worst, fabs(rebound(laws[law].choice, step, &steps) - laws[law].restitution));
        }
        double ns = (bench_now() - start) / (double)steps * 1e9;
        printf("%s,%g,%.4g,%.3g,", laws[law].name, per_contact[row], contact_time / per_contact[row], worst);
        if (row) printf("%.2f", log(before / worst) / log(per_contact[row] / per_contact[row - 1]));
        printf(",%.0f\n", ns);
        before = worst;
    }
}

int bench_impact(int count, char **words) {
    const char *phases = NULL;
    const struct cli_option options[] = {{.name = "--phases", .value = &phases}, {0}};
    int code = bench_parse(count, words, options, help);
    if (code) return code < 0 ? EXIT_GOOD : code;
    int phase_count = phases ? cli_whole_number(phases, "--phases", 10000) : 64;
    if (!phase_count) return EXIT_USAGE;
    bench_describe_machine();
    printf("law,steps_per_contact,step_s,largest_error,order,ns_per_step\n");
    for (int law = 0; law < LAWS; law++) measure(law, phase_count);
    return EXIT_GOOD;
}
