/* scree-bench skips: what it saves to leave out what a scene doesn't need, and that the result is the same. */
#include "bench/bench.h"

#include <math.h>
#include <stdlib.h>

static const char help[] =
    "usage: scree-bench skips [--repeats N]\n"
    "\n"
    "Small scenes with and without what the engine leaves out of them. Without the skip, the scene asks for the work\n"
    "in a way that changes nothing: friction with a coefficient of zero, a fixed wall that is driven at speed zero, "
    "lists\n"
    "made in every step. Both take turns; medians. Columns: what is skipped, scene,\n"
    "nanoseconds per step with and without the skip, what it saves in per cent, and the largest difference of\n"
    "positions at the end (m): 0 but for sleep.\n"
    "Unless given: --repeats 5.\n"
    "\n"
    "example: scree-bench skips --repeats 9\n";

#define MATERIALS "[[material]]\nname = \"ball\"\ndensity = 2000\n[[material]]\nname = \"wall\"\n"
#define MOTION    "[[motion]]\nname = \"still\"\nkind = \"velocity\"\nvelocity = 0.0\n"
#define TIME      "gravity = [0, 0, -9.81]\n[time]\nintegrator = \"verlet\"\nend = 1.0\nstep = 2e-5\n[output]\nwrite = []\n"
#define CONTACTS                                                                                                       \
    "[[contact]]\nbetween = [\"ball\", \"ball\"]\nnormal = { law = \"linear-cut\", stiffness = 5e3, restitution = "    \
    "0.6 }\n"                                                                                                          \
    "[[contact]]\nbetween = [\"ball\", \"wall\"]\nnormal = { law = \"linear-cut\", stiffness = 5e3, restitution = "    \
    "0.6 }\n"
#define FLOOR "[[body]]\nname = \"floor\"\nshape = { plane = true }\nmaterial = \"wall\"\njoint = \"fixed\"\n"

/* A ball that bounces, or a heap of 216 that settles between four walls. To be freed. */
static char *scene_text(int heap) {
    enum { EDGE = 6 };
    size_t size = 1 << 16, used;
    char *text = malloc(size);
    if (!text) exit(EXIT_MISSED);
    used = (size_t)snprintf(text, size, "%s", TIME MATERIALS MOTION CONTACTS FLOOR);
    static const char *const turns[] = {"axis = [0, 1, 0], degrees = 90", "axis = [0, 1, 0], degrees = -90",
                                        "axis = [1, 0, 0], degrees = -90", "axis = [1, 0, 0], degrees = 90"};
    static const char *const places[] = {"[-0.006, 0, 0]", "[0.061, 0, 0]", "[0, -0.006, 0]", "[0, 0.061, 0]"};
    for (int k = 0; heap && k < 4; k++)
        used += (size_t)snprintf(text + used, size - used,
                                 "[[body]]\nname = \"wall%d\"\nshape = { plane = true }\nmaterial = \"wall\"\n"
                                 "joint = \"fixed\"\norientation = { %s }\nposition = %s\n",
                                 k, turns[k], places[k]);
    for (int k = 0; k < (heap ? EDGE * EDGE * EDGE : 1); k++)
        used += (size_t)snprintf(text + used, size - used,
                                 "[[body]]\nname = \"b%d\"\nshape = { sphere = 0.005 }\nmaterial = \"ball\"\n"
                                 "position = [%g, %g, %g]\n",
                                 k, 0.011 * (k % EDGE) + 1e-4 * (k * 7 % 11),
                                 0.011 * (k / EDGE % EDGE) + 1e-4 * (k % 13), 0.006 + 0.011 * (k / (EDGE * EDGE)));
    return text;
}

/* What is left out, and the changes that put it back; `near` puts the search back, every other step or so. */
static const struct skip {
    const char *name;
    int near, changes;
    const char *change[3];
} skips[] = {
    {"search for contacts while nothing has moved far", 1, 0, {NULL}},
    {"friction of frictionless contacts",
     0,
     2,
     {"contact.0.friction={law=\"ramp\", kinetic=0.0, threshold=0.01}",
      "contact.1.friction={law=\"ramp\", kinetic=0.0, threshold=0.01}"}},
    {"friction and its memory",
     0,
     2,
     {"contact.0.friction={law=\"coulomb\", static=0.0, kinetic=0.0, stiffness=1e3}",
      "contact.1.friction={law=\"coulomb\", static=0.0, kinetic=0.0, stiffness=1e3}"}},
    {"rolling resistance",
     0,
     2,
     {"contact.0.rolling={law=\"constant\", rolling=0.0}", "contact.1.rolling={law=\"constant\", rolling=0.0}"}},
    {"energy books", 0, 1, {"output.write=[\"energy.csv\"]"}},
    {"motion of what is fixed", 0, 1, {"body.floor.joint={z=\"still\", others=\"fixed\"}"}},
    {"tilting of gravity", 0, 1, {"gravity={vector=[0.0,0.0,-9.81], tilt=\"still\", axis=[0.0,1.0,0.0]}"}},
};

enum { SKIPS = sizeof skips / sizeof skips[0], REPEATS = 99, STEPS = 2000 };

/* Nanoseconds per step; the scene is left for its state to be looked at. */
static double run(const char *text, const struct skip *skip, int with, scree_scene **scene) {
    *scene = bench_scene_text(text, skip->change, with ? 0 : skip->changes);
    int search = skip->near && !with;
    double begin = bench_now();
    for (int k = 0; search && k < STEPS; k++) {
        if (scree_contacts_list(&(*scene)->contacts, &(*scene)->bodies, 1, &(*scene)->trouble)) exit(EXIT_MISSED);
        bench_step(*scene, 1);
    }
    if (!search) bench_step(*scene, STEPS);
    return (bench_now() - begin) / STEPS * 1e9;
}

/* Largest difference of positions, m. */
static double difference(const scree_scene *a, const scree_scene *b) {
    double largest = 0.0;
    for (int k = 0; k < scree_scene_bodies(a); k++) {
        scree_body_state x = scree_scene_body(a, k), y = scree_scene_body(b, k);
        for (int i = 0; i < 3; i++) largest = scree_most(largest, fabs(x.position[i] - y.position[i]));
    }
    return largest;
}

static void measure(const struct skip *skip, int heap, int repeats) {
    char *text = scene_text(heap);
    double with[REPEATS], without[REPEATS];
    double off = 0.0;
    for (int r = 0; r < repeats; r++) {
        scree_scene *lean, *full;
        with[r] = run(text, skip, 1, &lean);
        without[r] = run(text, skip, 0, &full);
        off = scree_most(off, difference(lean, full));
        scree_scene_destroy(lean);
        scree_scene_destroy(full);
    }
    double lean = bench_median(with, repeats), full = bench_median(without, repeats);
    printf("%s,%s,%.1f,%.1f,%.0f,%.2g\n", skip->name, heap ? "heap of 216 balls" : "one ball", lean, full,
           100.0 * (1.0 - lean / full), off);
    free(text);
}

/* ---- sleep ---- */

/* Balls of soft glass that lie in a box, and come to rest by their dashpots. */
static const char bed[] =
    "gravity = [0, 0, -9.81]\n[time]\nintegrator = \"verlet\"\nend = 100.0\nstep = 1e-5\n[output]\nwrite = []\n"
    "[[material]]\nname = \"glass\"\ndensity = 2500\nyoung = 1e7\npoisson = 0.25\n"
    "[[contact]]\nbetween = [\"glass\", \"glass\"]\nnormal = { law = \"tsuji\", restitution = 0.6 }\n"
    "friction = { law = \"mindlin\", static = 0.5, kinetic = 0.5, damping = 0.15 }\n"
    "[[body]]\nname = \"floor\"\nshape = { plane = true }\nmaterial = \"glass\"\njoint = \"fixed\"\n"
    "[[body]]\nname = \"left\"\nshape = { plane = true }\nmaterial = \"glass\"\njoint = \"fixed\"\n"
    "orientation = { axis = [0, 1, 0], degrees = 90 }\n"
    "[[body]]\nname = \"right\"\nshape = { plane = true }\nmaterial = \"glass\"\njoint = \"fixed\"\n"
    "orientation = { axis = [0, 1, 0], degrees = -90 }\nposition = [0.032, 0, 0]\n"
    "[[body]]\nname = \"front\"\nshape = { plane = true }\nmaterial = \"glass\"\njoint = \"fixed\"\n"
    "orientation = { axis = [1, 0, 0], degrees = -90 }\n"
    "[[body]]\nname = \"back\"\nshape = { plane = true }\nmaterial = \"glass\"\njoint = \"fixed\"\n"
    "orientation = { axis = [1, 0, 0], degrees = 90 }\nposition = [0, 0.032, 0]\n"
    "[[generate]]\nname = \"grain\"\nkind = \"lattice\"\nmaterial = \"glass\"\nradius = 0.001\nspacing = 0.0022\n"
    "jitter = 8e-5\nmin = [0, 0, 0]\nmax = [0.032, 0.032, 0.05]\ncount = 2000\nseed = 7\n";

static double time_steps(scree_scene *scene) {
    double begin = bench_now();
    bench_step(scene, STEPS);
    return (bench_now() - begin) / STEPS * 1e9;
}

static void measure_sleep(int repeats) {
    enum { TO_REST = 100000 };
    const char *sleep = "time.sleep=1e-5";
    double with[REPEATS], without[REPEATS];
    scree_scene *lean = bench_scene_text(bed, &sleep, 1), *full = bench_scene_text(bed, NULL, 0);
    bench_step(lean, TO_REST);
    bench_step(full, TO_REST);
    for (int r = 0; r < repeats; r++) {
        with[r] = time_steps(lean);
        without[r] = time_steps(full);
    }
    double slim = bench_median(with, repeats), whole = bench_median(without, repeats);
    printf("bodies at rest (sleep = 1e-5; %d of 2000 asleep),bed of 2000 balls,%.1f,%.1f,%.1f,%.2g\n",
           scree_scene_asleep(lean), slim, whole, 100.0 * (1.0 - slim / whole), difference(lean, full));
    scree_scene_destroy(lean);
    scree_scene_destroy(full);
}

int bench_skips(int count, char **words) {
    const char *repeats = NULL;
    const struct cli_option options[] = {{.name = "--repeats", .value = &repeats}, {0}};
    int code = bench_parse(count, words, options, help);
    if (code) return code < 0 ? EXIT_GOOD : code;
    int repeat_count = repeats ? cli_whole_number(repeats, "--repeats", REPEATS) : 5;
    if (!repeat_count) return EXIT_USAGE;
    bench_describe_machine();
    printf("skipped,scene,ns_per_step_with_skip,ns_per_step_without,saved_percent,largest_difference_m\n");
    for (int k = 0; k < SKIPS; k++)
        for (int heap = skips[k].near; heap < 2; heap++) measure(&skips[k], heap, repeat_count);
    measure_sleep(repeat_count);
    return EXIT_GOOD;
}
