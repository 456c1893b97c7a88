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

#endif
