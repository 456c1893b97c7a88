/* scree-bench boxes: time of the contacts of boxes, boxes poured, and a tower that stands. */
#include "bench/bench.h"

#include "tests/boxes_oracle.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

static const char help[] =
    "usage: scree-bench boxes [--pairs] [--count N] [--seconds N] [--tower N] [--threads N]\n"
    "\n"
    "--pairs: time of the contact stage for pairs of boxes that are pressed together: pair, "
    "contacts listed and touching of a pair,\n"
    "ns per pair, per touching contact.\n"
    "--count N: boxes of six shapes poured into a shaft, which is filled once its cells are, "
    "for --seconds (3) tenths of a second:\n"
    "boxes, steps, length of a step in us, ns per box and step; touching contacts at the end, ns of a step per one of "
    "them, over the last hundredth of the run;\n"
    "kinetic energy over the largest before, largest overlap over the tolerable.\n"
    "--tower N: towers of 20 boxes for N seconds, of rounded and of sharp ones: how far "
    "any box has moved after the first second,\n"
    "over a side; kinetic energy over the tower's potential energy. Then a box on a slope of "
    "0.999 of the critical angle: the same,\n"
    "over its length; and of 1.001: its acceleration over g (sin a - mu cos a), less 1.\n"
    "Without any of them: all, of small sizes.\n"
    "Unless given: --count 1000 --seconds 3 --tower 4 --threads 1.\n"
    "\n"
    "example: scree-bench boxes --tower 100\n";

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

/* `step` 0: automatic; `rub`: damping of the friction law, N s/m. */
static struct text begin(double gravity, double step, double stiffness, double restitution, double rub, int threads) {
    struct text text = {.at = calloc(65536, 1), .size = 65536};
    if (!text.at) exit(EXIT_MISSED);
    char steps[32] = "\"auto\"";
    if (step > 0.0) snprintf(steps, sizeof steps, "%.17g", step);
    add(&text,
        "gravity = [0, 0, %.17g]\n[time]\nend = 1000.0\nstep = %s\nthreads = %d\n[[material]]\nname = \"m\"\n"
        "density = 1000\n[[contact]]\nbetween = [\"m\", \"m\"]\n"
        "normal = { law = \"linear-cut\", stiffness = %.17g, restitution = %.17g }\n"
        "friction = { law = \"coulomb\", static = 0.5, kinetic = 0.4, stiffness = %.17g, damping = %.17g }\n",
        -gravity, steps, threads, stiffness, restitution, 0.3 * stiffness, rub);
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
    struct text text = begin(0.0, 1e-6, 1e5, 0.5, 5.0, 1);
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
        for (int k = 0; k < 100; k++) scree_contacts_act(&scene->contacts, &scene->bodies, scene->step, 1, NULL);
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

/* Walls of a shaft as wide as `width`, and its floor. */
static void add_shaft(struct text *text, double width) {
    static const struct {
        double x, y;
        const char *turn;
    } walls[] = {{0.0, 0.0, "{ axis = [1, 0, 0], degrees = 0 }"},
                 {-0.5, 0.0, "{ axis = [0, 1, 0], degrees = 90 }"},
                 {0.5, 0.0, "{ axis = [0, 1, 0], degrees = -90 }"},
                 {0.0, -0.5, "{ axis = [1, 0, 0], degrees = -90 }"},
                 {0.0, 0.5, "{ axis = [1, 0, 0], degrees = 90 }"}};
    for (int k = 0; k < 5; k++)
        add(text,
            "[[body]]\nname = \"wall %d\"\nmaterial = \"m\"\nshape = { plane = true }\njoint = \"fixed\"\nposition = "
            "[%.17g, %.17g, 0]\norientation = %s\n",
            k, walls[k].x * width, walls[k].y * width, walls[k].turn);
}

/* A contact bears the heaviest box, a cube, at the speed of the longest fall, on the thinnest one: its overlap stays
 * below the tolerable one, half a half-width. Friction's spring is damped by half of what is critical for two of the
 * lightest. The step is a twentieth of the shortest contact, with all that can bear upon it: 2.5 automatic ones, and
 * below half of what is stable. */
static scree_scene *shaft_of_boxes(int count, int threads) {
    const double size = 0.01, cell = 1.65 * size, thinnest = 0.2; /* a cell is as wide as the longest diagonal */
    int row = (int)fmax(6.0, ceil(cbrt(8.0 * count)));
    double start = 0.5, fall = (count / row / row + 1) * cell, speed2 = start * start + 2.0 * 9.81 * fall;
    double heaviest = 1000.0 * size * size * size, lightest = heaviest * thinnest * thinnest,
           limit = 0.25 * thinnest * size;
    double stiffness = heaviest * speed2 / (limit * limit);
    struct text text = begin(9.81, 0.0, stiffness, 0.5, sqrt(0.3 * stiffness * 0.5 * lightest), threads);
    add_shaft(&text, row * cell);
    uint64_t seed = 1;
    for (int k = 0; k < count; k++) {
        int shape = k % ORACLE_SHAPES;
        double edge[3], half = 0.5 * row;
        for (int axis = 0; axis < 3; axis++) edge[axis] = size * fmax(oracle_edges[shape][axis], thinnest);
        struct vec at =
            vec((k % row + 0.5 - half) * cell, (k / row % row + 0.5 - half) * cell, (k / row / row + 0.6) * cell);
        add_box(&text, k, edge, 0.05 * size, at, oracle_attitude(&seed), "velocity = [0, 0, -0.5]");
    }
    scree_scene *scene = bench_scene_text(text.at, NULL, 0);
    char step[64];
    snprintf(step, sizeof step, "time.step=%.17g", 2.5 * scree_scene_step_length(scene));
    scree_scene_destroy(scene);
    const char *changes[] = {step};
    scene = bench_scene_text(text.at, changes, 1);
    free(text.at);
    return scene;
}

static void pour(int count, double seconds, int threads) {
    scree_scene *scene = shaft_of_boxes(count, threads);
    long steps = lround(seconds / scree_scene_step_length(scene)), done = 0, last = steps - steps / 100;
    double most = 0.0, start = bench_now(), late = start;
    while (done < steps) {
        if (done < last && done + 100 >= last) late = bench_now();
        bench_step(scene, 100);
        done += 100;
        if (done % 1000 == 0) most = scree_most(most, energy_of(scene));
    }
    double end = bench_now(), ns = (end - start) * 1e9 / ((double)done * count);
    int touching = 0;
    scree_scene_contacts(scene, NULL, 0, &touching);
    printf("%d,%ld,%.3g,%.0f,%d,%.0f,%.3g,%.3g\n", count, done, scree_scene_step_length(scene) * 1e6, ns, touching,
           (end - late) * 1e9 / ((double)(steps - last) * touching), energy_of(scene) / most,
           scree_scene_deepest(scene, NULL, NULL));
    scree_scene_destroy(scene);
}

/* ---- what stands ---- */

enum { MOST_BODIES = 32 };

/* How far any body moves during `steps`. */
static double way_of(scree_scene *scene, int bodies, long steps) {
    struct vec before[MOST_BODIES];
    double most = 0.0;
    for (int k = 0; k < bodies; k++) before[k] = vec_from(scree_scene_body(scene, k).position);
    bench_step(scene, steps);
    for (int k = 0; k < bodies; k++)
        most = scree_most(most, vec_norm(vec_sub(vec_from(scree_scene_body(scene, k).position), before[k])));
    return most;
}

static const struct {
    const char *name;
    double rounding; /* m */
} towers[] = {{"tower", 0.005}, {"tower of sharp boxes", 0.0}};

static void build_tower(int kind, double seconds) {
    enum { HEIGHT = 20 };
    const double edge[3] = {0.1, 0.1, 0.1};
    struct text text = begin(9.81, 2e-5, 1e6, 0.2, 50.0, 1);
    double potential = 0.0;
    add(&text, "[[body]]\nname = \"floor\"\nmaterial = \"m\"\nshape = { plane = true }\njoint = \"fixed\"\n");
    for (int k = 0; k < HEIGHT; k++)
        add_box(&text, k, edge, towers[kind].rounding, vec(0.0, 0.0, 0.05 + 0.1 * k), (struct quat){1.0, 0.0, 0.0, 0.0},
                "");
    scree_scene *scene = scene_of(&text);
    long second = lround(1.0 / scree_scene_step_length(scene));
    bench_step(scene, second);
    double most = way_of(scene, HEIGHT + 1, (long)((seconds - 1.0) * (double)second));
    for (int k = 1; k <= HEIGHT; k++)
        potential += 9.81 * scree_scene_body_mass(scene, k) * scree_scene_body(scene, k).position[2];
    printf("%s,%g,%.3g,%.3g\n", towers[kind].name, seconds, most / edge[0], energy_of(scene) / potential);
    fflush(stdout);
    scree_scene_destroy(scene);
}

/* A box on a slope of another box, by a factor of the critical angle. */
static void lay_on_slope(double factor, double seconds) {
    const double slope[3] = {4.0, 0.5, 0.1}, block[3] = {0.2, 0.2, 0.04};
    double angle = factor * atan(0.5);
    struct quat level = {1.0, 0.0, 0.0, 0.0};
    struct text text = {.at = calloc(65536, 1), .size = 65536};
    if (!text.at) exit(EXIT_MISSED);
    add(&text,
        "gravity = [%.17g, 0, %.17g]\n[time]\nend = 1000.0\nstep = 2e-5\n[[material]]\nname = \"m\"\n"
        "density = 1000\n[[contact]]\nbetween = [\"m\", \"m\"]\nnormal = { law = \"linear-cut\", stiffness = 1e6, "
        "restitution = 0.2 }\nfriction = { law = \"coulomb\", static = 0.5, kinetic = 0.5, stiffness = 1e5, damping = "
        "200 }\n",
        9.81 * sin(angle), -9.81 * cos(angle));
    add_box(&text, 0, slope, 0.004, vec(1.5, 0.0, -0.05), level, "joint = \"fixed\"");
    add_box(&text, 1, block, 0.004, vec(0.0, 0.0, 0.02), level, "");
    scree_scene *scene = scene_of(&text);
    long second = lround(1.0 / scree_scene_step_length(scene));
    bench_step(scene, 3 * second); /* the start pushes it off, and it slows down by 5 mm/s^2 only */
    if (factor < 1.0) {
        double way = way_of(scene, 2, (long)((seconds - 3.0) * (double)second));
        printf("slope of %g,%g,%.3g,%.3g\n", factor, seconds, way / block[0], energy_of(scene));
    } else {
        double before = scree_scene_body(scene, 1).velocity[0];
        bench_step(scene, 5 * second);
        double along = (scree_scene_body(scene, 1).velocity[0] - before) / 5.0;
        printf("slope of %g,8,%.3g,\n", factor, along / (9.81 * (sin(angle) - 0.5 * cos(angle))) - 1.0);
    }
    scree_scene_destroy(scene);
}

static void stand(double seconds) {
    printf("standing,seconds,moved,kinetic\n");
    for (int kind = 0; kind < (int)(sizeof towers / sizeof towers[0]); kind++) build_tower(kind, seconds);
    lay_on_slope(0.999, seconds);
    lay_on_slope(1.001, seconds);
}

int bench_boxes(int count, char **words) {
    const char *boxes = NULL, *seconds = NULL, *tower = NULL, *threads = NULL;
    int only_pairs = 0;
    const struct cli_option options[] = {{.name = "--pairs", .flag = &only_pairs}, {.name = "--count", .value = &boxes},
                                         {.name = "--seconds", .value = &seconds}, {.name = "--tower", .value = &tower},
                                         {.name = "--threads", .value = &threads}, {0}};
    int code = bench_parse(count, words, options, help);
    if (code) return code < 0 ? EXIT_GOOD : code;
    int all = !only_pairs && !boxes && !tower;
    int box_count = boxes ? cli_whole_number(boxes, "--count", 10000000) : 1000;
    int tenths = seconds ? cli_whole_number(seconds, "--seconds", 100000) : 3;
    int last = tower ? cli_whole_number(tower, "--tower", 100000) : 4;
    int team = threads ? cli_whole_number(threads, "--threads", 1024) : 1;
    if (!box_count || !tenths || !last || !team) return EXIT_USAGE;
    if (last < 4) return cli_complain("--tower takes 4 s or more: the block on the slope needs 3 to come to rest");
    bench_describe_machine();
    if (all || only_pairs) {
        printf("pair,listed,touching,pair_ns,contact_ns\n");
        for (int kind = 0; kind < (int)(sizeof pairs / sizeof pairs[0]); kind++) time_pairs(kind);
    }
    if (all || boxes) {
        printf("boxes_poured,steps,step_us,box_step_ns,touching,contact_ns,kinetic,deepest\n");
        pour(box_count, 0.1 * tenths, team);
    }
    if (all || tower) stand(last);
    return EXIT_GOOD;
}
