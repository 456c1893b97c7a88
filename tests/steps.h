/* Scenes with a step and a fixed-step integrator, for tests of the errors that these make. */
#ifndef SCREE_TESTS_STEPS_H
#define SCREE_TESTS_STEPS_H

#include "tests/scenes.h"

static const char pair_impulse[] = "time.integrator=\"pair-impulse\"";

/* A scene with a step and an integrator. */
static inline scree_scene *scene_with(const char *text, double step, const char *integrator, int substeps) {
    char at[64], pieces[64];
    snprintf(at, sizeof at, "time.step=%.17g", step);
    snprintf(pieces, sizeof pieces, "time.substeps=%d", substeps);
    const char *changes[] = {at, integrator, pieces};
    return scene_from(text, changes, substeps ? 3 : integrator ? 2 : 1, 1);
}

/* What was measured, for who wants to see it. */
static inline void show(const char *what, const char *which, double at20, double at50) {
    if (getenv("SCREE_SHOW")) printf("%-12s %-50.50s %.2e %.2e\n", what, which, at20, at50);
}

static inline int touches(scree_scene *scene) {
    int count;
    CHECK(scree_scene_contacts(scene, NULL, 0, &count) == SCREE_OK);
    return count;
}

/* A ball of 0.03 kg that meets a wall at 1 m/s; the laws of its contact follow. */
static const char ball_on_wall[] =
    "[time]\nend = 1.0\nforce = true\n[[material]]\nname = \"ball\"\n[[material]]\nname = \"wall\"\n"
    "[[body]]\nname = \"wall\"\nshape = { plane = true }\nmaterial = \"wall\"\njoint = \"fixed\"\n"
    "[[body]]\nname = \"ball\"\nshape = { sphere = 0.01 }\nmaterial = \"ball\"\nmass = 0.03\n"
    "position = [0, 0, 0.0105]\nvelocity = [0, 0, -1]\n"
    "[[contact]]\nbetween = [\"ball\", \"wall\"]\n";

#endif
