/* scree-bench boxes: time of the contacts of boxes, boxes poured, and a tower that stands. */
#include "bench/bench.h"

#include "engine/cli/cli.h"
#include "tests/boxes_oracle.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

static const char help[] = "usage: scree-bench boxes [--count N] [--seconds N] [--tower N] [--threads N]\n"
                           "\n"
                           "Time of the contact stage for pairs of boxes that are pressed together: pair, contacts "
                           "listed and touching of a pair,\n"
                           "ns per pair, per touching contact. Then N boxes (1000) of six shapes poured into a shaft, "
                           "for a tenth of --seconds (3):\n"
                           "boxes, steps, ns per box and step, contacts that touch at the end, kinetic energy over the "
                           "largest before, largest\n"
                           "overlap over the tolerable. Then a tower of 20 boxes for --tower seconds (1): how far any "
                           "has moved in the last half\n"
                           "of it, over a side; kinetic energy over the tower's potential energy.\n"
                           "\n"
                           "example: scree-bench boxes --count 10000 --tower 100\n";

struct text {
    char *at;
    size_t size, used;
};

__attribute__((format(printf, 2, 3))) static void add(struct text *text, const char *format, ...) {
    for (;;) {
        va_list arguments;
        va_start(arguments, format);
        int more = vsnprintf(text->at + text->used, text->size - text->used, format, arguments);
        va_end(arguments);
        if ((size_t)more < text->size - text->used) {
            text->used += (size_t)more;
            return;
        }
        text->size = 2 * text->size + 65536;
        text->at = realloc(text->at, text->size);
        if (!text->at) exit(EXIT_MISSED);
    }
}

static struct text begin(double gravity, double step, double stiffness, double restitution, int threads) {
    struct text text = {.at = calloc(65536, 1), .size = 65536};
    if (!text.at) exit(EXIT_MISSED);
    add(&text,
        "gravity = [0, 0, %.17g]\n[time]\nend = 1000.0\nstep = %.17g\nthreads = %d\n[[material]]\nname = \"m\"\n"
        "density = 1000\n[[contact]]\nbetween = [\"m\", \"m\"]\n"
        "normal = { law = \"linear-cut\", stiffness = %.17g, restitution = %.17g }\n"
        "friction = { law = \"coulomb\", static = 0.5, kinetic = 0.4, stiffness = %.17g, damping = %.17g }\n",
        -gravity, step, threads, stiffness, restitution, 0.3 * stiffness, 5e-5 * stiffness);
    return text;
}

static void add_box(struct text *text, int number, const double edge[3], double rounding, struct vec at, struct quat q,
                    const char *more) {
    add(text,
        "[[body]]\nname = \"b%d\"\nmaterial = \"m\"\nshape = { box = [%.17g, %.17g, %.17g], rounding = %.17g }\n"
        "position = [%.17g, %.17g, %.17g]\norientation = [%.17g, %.17g, %.17g, %.17g]\n%s\n",
        number, edge[0], edge[1], edge[2], rounding, at.x, at.y, at.z, q.w, q.x, q.y, q.z, more);
}

static scree_scene *scene_of(struct text *text) {
    scree_scene *scene = bench_scene_text(text->at, NULL, 0);
    free(text->at);
    return scene;
}

/* ---- time of a contact ---- */

enum { PAIRS = 200, REPEATS = 9 };

static const struct {
    const char *name;
    double small, height, turn; /* edge of the upper box, height of its centre, turn about the vertical, degrees */
    int on_edge;
} pairs[] = {{"small box on a large one", 0.06, 0.08, 10.0, 0},
             {"equal cubes, turned by 45 degrees", 0.1, 0.1, 45.0, 0},
             {"equal cubes, edge on edge", 0.1, 0.1414, 0.0, 1}};

static void time_pairs(int kind) {
    struct text text = begin(0.0, 1e-6, 1e5, 0.5, 1);
    const double large[3] = {0.1, 0.1, 0.1}, small[3] = {pairs[kind].small, pairs[kind].small, pairs[kind].small};
    double half = pairs[kind].turn * 3.14159265358979 / 360.0, quarter = 3.14159265358979 / 8.0;
    for (int k = 0; k < PAIRS; k++) {
        struct quat upper = {cos(half), 0.0, 0.0, sin(half)}, lower = {1.0, 0.0, 0.0, 0.0};
        double sunk = 1e-4, rounding = 0.004, edge = pairs[kind].on_edge ? 2.0 * rounding * (sqrt(2.0) - 1.0) : 0.0;
        if (pairs[kind].on_edge) {
            lower = (struct quat){cos(quarter), sin(quarter), 0.0, 0.0};
            upper = (struct quat){cos(quarter), 0.0, sin(quarter), 0.0};
        }
        add_box(&text, 2 * k, large, rounding, vec(0.5 * k, 0.0, 0.0), lower, "joint = \"fixed\"");
        add_box(&text, 2 * k + 1, small, rounding, vec(0.5 * k, 0.0, pairs[kind].height - sunk - edge), upper, "");
    }
    scree_scene *scene = scene_of(&text);
    double ns[REPEATS];
    int listed = 0, touching = 0;
    bench_step(scene, 1);
    scree_scene_contacts(scene, NULL, 0, &touching);
    for (int b = 0; b < scene->contacts.batches; b++) listed += scene->contacts.batch[b].count;
    for (int r = 0; r < REPEATS; r++) {
        double start = bench_now();
        for (int k = 0; k < 100; k++) scree_contacts_act(&scene->contacts, &scene->bodies, scene->step, 1);
        ns[r] = (bench_now() - start) * 1e9 / (100.0 * PAIRS);
    }
    double median = bench_median(ns, REPEATS);
    printf("%s,%g,%g,%.0f,%.0f\n", pairs[kind].name, (double)listed / PAIRS, (double)touching / PAIRS, median,
           median * PAIRS / touching);
    scree_scene_destroy(scene);
}

/* ---- poured ---- */

static double energy_of(scree_scene *scene) {
    scree_energy energy;
    if (scree_scene_energy(scene, &energy)) exit(EXIT_MISSED);
    return energy.kinetic + energy.rotational;
}

static void pour(int count, double seconds, int threads) {
    const double size = 0.01, width = 0.1;
    struct text text = begin(9.81, 5e-6, 500.0, 0.5, threads);
    static const char *const walls[] = {"[0, 0, 0]\norientation = { axis = [1, 0, 0], degrees = 0 }",
                                        "[-0.05, 0, 0]\norientation = { axis = [0, 1, 0], degrees = 90 }",
                                        "[0.05, 0, 0]\norientation = { axis = [0, 1, 0], degrees = -90 }",
                                        "[0, -0.05, 0]\norientation = { axis = [1, 0, 0], degrees = -90 }",
                                        "[0, 0.05, 0]\norientation = { axis = [1, 0, 0], degrees = 90 }"};
    for (int k = 0; k < 5; k++)
        add(&text,
            "[[body]]\nname = \"wall %d\"\nmaterial = \"m\"\nshape = { plane = true }\njoint = \"fixed\"\nposition = "
            "%s\n",
            k, walls[k]);
    uint64_t seed = 1;
    for (int k = 0; k < count; k++) { /* on a grid as wide as the longest diagonal */
        int row = (int)(width / (1.6 * size)), shape = k % ORACLE_SHAPES;
        double cell = width / row, edge[3];
        for (int axis = 0; axis < 3; axis++) edge[axis] = size * fmax(oracle_edges[shape][axis], 0.2);
        struct vec at = vec((k % row + 0.5) * cell - 0.5 * width, (k / row % row + 0.5) * cell - 0.5 * width,
                            (k / row / row + 0.6) * cell);
        add_box(&text, k, edge, 0.05 * size, at, oracle_attitude(&seed), "velocity = [0, 0, -0.5]");
    }
    scree_scene *scene = scene_of(&text);
    long steps = (long)(seconds / scree_scene_step_length(scene)), done = 0;
    double most = 0.0, start = bench_now();
    while (done < steps) {
        bench_step(scene, 100);
        done += 100;
        most = fmax(most, energy_of(scene));
    }
    double ns = (bench_now() - start) * 1e9 / ((double)done * count);
    int touching = 0;
    scree_scene_contacts(scene, NULL, 0, &touching);
    printf("%d,%ld,%.0f,%d,%.3g,%.3g\n", count, done, ns, touching, energy_of(scene) / most,
           scree_scene_deepest(scene, NULL, NULL));
    scree_scene_destroy(scene);
}

/* ---- a tower ---- */

static void build_tower(double seconds) {
    enum { HEIGHT = 20 };
    const double edge[3] = {0.1, 0.1, 0.1};
    struct text text = begin(9.81, 2e-5, 1e6, 0.2, 1);
    struct vec before[HEIGHT + 1];
    double most = 0.0;
    add(&text, "[[body]]\nname = \"floor\"\nmaterial = \"m\"\nshape = { plane = true }\njoint = \"fixed\"\n");
    for (int k = 0; k < HEIGHT; k++)
        add_box(&text, k, edge, 0.005, vec(0.0, 0.0, 0.05 + 0.1 * k), (struct quat){1.0, 0.0, 0.0, 0.0}, "");
    scree_scene *scene = scene_of(&text);
    long half = (long)(0.5 * seconds / scree_scene_step_length(scene));
    bench_step(scene, half);
    for (int k = 0; k <= HEIGHT; k++) before[k] = vec_from(scree_scene_body(scene, k).position);
    bench_step(scene, half);
    double potential = 0.0;
    for (int k = 1; k <= HEIGHT; k++) {
        struct vec now = vec_from(scree_scene_body(scene, k).position);
        most = fmax(most, vec_norm(vec_sub(now, before[k])) / edge[0]);
        potential += 9.81 * scree_scene_body_mass(scene, k) * now.z;
    }
    printf("%g,%.3g,%.3g\n", seconds, most, energy_of(scene) / potential);
    scree_scene_destroy(scene);
}

int bench_boxes(int count, char **words) {
    const char *boxes = NULL, *seconds = NULL, *tower = NULL, *threads = NULL;
    const struct cli_option options[] = {{.name = "--count", .value = &boxes},
                                         {.name = "--seconds", .value = &seconds},
                                         {.name = "--tower", .value = &tower},
                                         {.name = "--threads", .value = &threads},
                                         {0}};
    int code = cli_parse(&count, words, options, help);
    if (code) return code < 0 ? EXIT_GOOD : code;
    int box_count = boxes ? cli_whole_number(boxes, "--count", 10000000) : 1000;
    int tenths = seconds ? cli_whole_number(seconds, "--seconds", 100000) : 3;
    int stand = tower ? cli_whole_number(tower, "--tower", 100000) : 1;
    int team = threads ? cli_whole_number(threads, "--threads", 1024) : 1;
    if (!box_count || !tenths || !stand || !team) return EXIT_USAGE;
    bench_describe_machine();
    printf("pair,listed,touching,pair_ns,contact_ns\n");
    for (int kind = 0; kind < (int)(sizeof pairs / sizeof pairs[0]); kind++) time_pairs(kind);
    printf("boxes_poured,steps,box_step_ns,touching,kinetic,deepest\n");
    pour(box_count, 0.1 * tenths, team);
    printf("tower_s,moved,kinetic\n");
    build_tower(stand);
    return EXIT_GOOD;
}
