/* Scenes from text, for tests. */
#ifndef SCREE_TESTS_SCENES_H
#define SCREE_TESTS_SCENES_H

#include "engine/scene.h"
#include "engine/scene_file.h"

#include "tests/check.h"

/* A scene that must be valid; ends the test program if it isn't. `threads` 0: as the text says. */
static inline scree_scene *scene_from(const char *text, const char *const *changes, int count, int threads) {
    scree_scene *scene;
    struct scree_run_request request;
    scree_trouble trouble;
    if (scree_read_scene(text, strlen(text), "test.toml", changes, count, threads, &scene, &request, &trouble)) {
        printf("%s\n", trouble.text);
        exit(1);
    }
    scree_free_request(&request);
    return scene;
}

/* The same, by the adaptive integrator; at most six changes. */
static inline scree_scene *adaptive(const char *text, double tolerance, const char *const *changes, int count) {
    char at[64];
    snprintf(at, sizeof at, "time.tolerance=%g", tolerance);
    const char *all[8] = {"time.integrator=\"adaptive\"", at};
    for (int k = 0; k < count; k++) all[2 + k] = changes[k];
    return scene_from(text, all, 2 + count, 1);
}

/* A scene of the repository. */
static inline scree_scene *scene_file(const char *name, const char *const *changes, int count) {
    char path[512];
    scree_scene *scene;
    struct scree_run_request request;
    scree_trouble trouble;
    snprintf(path, sizeof path, "%s/scenes/%s", SCREE_DATA, name);
    if (scree_load_scene(path, changes, count, 0, &scene, &request, &trouble)) {
        printf("%s\n", trouble.text);
        exit(1);
    }
    scree_free_request(&request);
    return scene;
}

/* Step; ends the test program if the simulation stops. */
static inline void go(scree_scene *scene, long steps) {
    if (scree_scene_step(scene, steps)) {
        printf("%s\n", scree_scene_trouble(scene)->text);
        exit(1);
    }
}

static inline scree_body_state state_of(const scree_scene *scene, const char *name) {
    return scree_scene_body(scene, scree_scene_find_body(scene, name));
}

/* The hashes of a file of data/golden, which every build must reproduce: scene, steps, hash a row. The scenes are
 * changed, but for the one called `unchanged` (may be NULL). */
static inline void check_golden(const char *name_of_file, const char *const *changes, int count, const char *unchanged,
                                int expected_rows) {
    char path[512], name[64];
    unsigned long long golden;
    long steps;
    int rows = 0;
    snprintf(path, sizeof path, "%s/golden/%s", SCREE_DATA, name_of_file);
    FILE *file = fopen(path, "r");
    while (file && fscanf(file, "%63s %ld %llx", name, &steps, &golden) == 3) {
        char scene_name[80];
        snprintf(scene_name, sizeof scene_name, "%s.toml", name);
        scree_scene *scene = scene_file(scene_name, changes, unchanged && strcmp(name, unchanged) == 0 ? 0 : count);
        go(scene, steps);
        unsigned long long hash = scree_scene_hash(scene);
        if (hash != golden) printf("%s %ld %016llx\n", name, steps, hash);
        CHECK(hash == golden);
        scree_scene_destroy(scene);
        rows++;
    }
    if (file) fclose(file);
    CHECK(rows == expected_rows);
}

/* Between two places, or the nearest images of them. */
static inline double distance_between(const struct scree_bodies *bodies, const double a[3], const double b[3]) {
    double apart[3];
    for (int axis = 0; axis < 3; axis++) {
        double period = bodies->period[axis];
        apart[axis] = period > 0.0 ? remainder(a[axis] - b[axis], period) : a[axis] - b[axis];
    }
    return vec_norm(vec_from(apart));
}

/* 1500 spheres and some boxes falling into a heap: enough for teams of threads. To be freed. */
static inline char *heap_text(void) {
    enum { COUNT = 1500 };
    char *text = malloc(COUNT * 256 + 4096);
    int used =
        sprintf(text, "%s",
                "gravity = [0, 0, -9.81]\n[time]\nintegrator = \"verlet\"\nend = 1.0\nstep = 2e-5\n"
                "[[material]]\nname = \"ball\"\ndensity = 2000\n[[material]]\nname = \"wall\"\n"
                "[[contact]]\nbetween = [\"ball\", \"ball\"]\n"
                "normal = { law = \"linear-cut\", stiffness = 5e3, restitution = 0.6 }\n"
                "friction = { law = \"coulomb\", static = 0.5, kinetic = 0.4, stiffness = 4e3 }\n"
                "[[contact]]\nbetween = [\"ball\", \"wall\"]\n"
                "normal = { law = \"linear-loading\", stiffness = 5e3, restitution = 0.6 }\n"
                "friction = { law = \"coulomb\", static = 0.5, kinetic = 0.4, stiffness = 4e3 }\n"
                "[[body]]\nname = \"floor\"\nshape = { plane = true }\nmaterial = \"wall\"\njoint = \"fixed\"\n");
    uint64_t seed = 5;
    for (int k = 0; k < COUNT; k++) {
        double x = 0.0115 * (k % 12), y = 0.0115 * (k / 12 % 12), z = 0.006 + 0.0115 * (k / 144);
        double off[2];
        check_draw(&seed, -5e-4, 5e-4, 2, off);
        used += sprintf(
            text + used,
            "[[body]]\nname = \"b%d\"\nmaterial = \"ball\"\nshape = { %s }\nposition = [%.17g, %.17g, %.17g]\n", k,
            k % 50 ? "sphere = 0.005" : "box = [0.006, 0.007, 0.008], rounding = 0.001", x + off[0], y + off[1], z);
    }
    return text;
}

#endif
