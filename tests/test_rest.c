/* Bodies that sleep: who does, who wakes, and what can't. (A whole bed: test_sleeping_bed.c.) */
#include "contact/rest.h"
#include "tests/scenes.h"

#include <string.h>

/* ---- who wakes ---- */

static const char stacks[] =
    "gravity = [0, 0, -9.81]\n[time]\nend = 10.0\nstep = 5e-5\n"
    "[[material]]\nname = \"m\"\ndensity = 1000\n"
    "[[contact]]\nbetween = [\"m\", \"m\"]\nnormal = { law = \"linear\", stiffness = 1e3, restitution = 0.2 }\n"
    "friction = { law = \"coulomb\", static = 0.5, kinetic = 0.5, stiffness = 1e3, damping = 0.5 }\n"
    "[[body]]\nname = \"floor\"\nshape = { plane = true }\nmaterial = \"m\"\njoint = \"fixed\"\n"
    "[[body]]\nname = \"a1\"\nshape = { box = [0.02, 0.02, 0.01], rounding = 0.001 }\nmaterial = \"m\"\nposition = [0, "
    "0, 0.005]\n"
    "[[body]]\nname = \"a2\"\nshape = { box = [0.02, 0.02, 0.01], rounding = 0.001 }\nmaterial = \"m\"\nposition = [0, "
    "0, 0.015]\n"
    "[[body]]\nname = \"a3\"\nshape = { sphere = 0.005 }\nmaterial = \"m\"\nposition = [0, 0, 0.0249]\n"
    "[[body]]\nname = \"b1\"\nshape = { box = [0.02, 0.02, 0.01], rounding = 0.001 }\nmaterial = \"m\"\nposition = "
    "[0.0, 0.1, 0.005]\n"
    "[[body]]\nname = \"b2\"\nshape = { sphere = 0.005 }\nmaterial = \"m\"\nposition = [0.0, 0.1, 0.0149]\n"
    "[[motion]]\nname = \"push\"\nkind = \"rise\"\nstroke = 0.02\nstart = 0.5\nduration = 0.2\n"
    "[[body]]\nname = \"ram\"\nshape = { box = [0.02, 0.02, 0.006], rounding = 0.001 }\nmaterial = \"m\"\n"
    "position = [-0.025, 0, 0.006]\njoint = { x = \"push\", others = \"fixed\" }\n";

static int sleeps(const scree_scene *scene, const char *name) {
    return scene->bodies.class[scene->bodies.place[scree_scene_find_body(scene, name)]] == SCREE_CLASS_ASLEEP;
}

/* Back to where it is. */
static void restore_itself(scree_scene *scene) {
    FILE *file = tmpfile();
    CHECK(scree_scene_save(scene, file, "file") == SCREE_OK);
    rewind(file);
    CHECK(scree_scene_restore(scene, file, "file") == SCREE_OK);
    fclose(file);
}

/* Two stacks come to rest and sleep; a ram pushes one of them along the floor. It wakes, and goes where it goes without
 * sleep; the other one sleeps on. Where friction lets go is told by its springs, which what went unnoticed shifts by a
 * part of their whole stretch: that under both boxes is mu m g/k = 4e-5 m. */
static void test_push(void) {
    const char *sleep = "time.sleep=1e-5";
    scree_scene *lean = scene_from(stacks, &sleep, 1, 1), *full = scene_from(stacks, NULL, 0, 1);
    CHECK(lean->time.integrator == SCREE_VERLET);
    go(lean, 9900);
    go(full, 9900);
    CHECK(scree_scene_asleep(lean) == 5);
    restore_itself(lean);
    CHECK(scree_scene_asleep(lean) == 5);
    int woke = 0;
    for (int k = 0; k < 100; k++) {
        go(lean, 100);
        go(full, 100);
        woke |= !sleeps(lean, "a1") && !sleeps(lean, "a2") && !sleeps(lean, "a3");
        CHECK(sleeps(lean, "b1") && sleeps(lean, "b2"));
    }
    CHECK(woke);
    static const char *const names[] = {"a1", "a2", "a3", "b1", "b2"};
    for (int n = 0; n < 5; n++) {
        scree_body_state a = state_of(lean, names[n]), b = state_of(full, names[n]);
        CHECK(vec_norm(vec_sub(vec_from(a.position), vec_from(b.position))) < 4e-5);
    }
    CHECK(state_of(lean, "a1").position[0] > 0.014);
    go(lean, 20000);
    CHECK(sleeps(lean, "a1") && sleeps(lean, "a2")); /* the ball on them rolls on */
    scree_scene_destroy(lean);
    scree_scene_destroy(full);
}

/* Boxes that wake beside balls that lie sorted: these hurry on to the middle of the next step, boxes don't. Single
 * steps, in which nobody does, make the same bits. */
static void test_waking_beside_sorted(void) {
    char text[4096];
    snprintf(text, sizeof text,
             "%s[[generate]]\nname = \"grain\"\nkind = \"lattice\"\nradius = 0.005\nspacing = 0.012\ncount = 20\n"
             "min = [0.1, 0, 0]\nmax = [0.2, 0.1, 0.05]\nmaterial = \"m\"\n",
             stacks);
    const char *sleep = "time.sleep=1e-5";
    scree_scene *hurried = scene_from(text, &sleep, 1, 1), *stepped = scene_from(text, &sleep, 1, 1);
    CHECK(hurried->bodies.order.slabs > 0);
    go(hurried, 9900);
    go(stepped, 9900);
    CHECK(sleeps(hurried, "a1") && sleeps(hurried, "a2"));
    go(hurried, 2000);
    for (int k = 0; k < 2000; k++) go(stepped, 1);
    CHECK(!sleeps(hurried, "a1") && !sleeps(hurried, "a2"));
    CHECK(scree_scene_hash(hurried) == scree_scene_hash(stepped));
    scree_scene_destroy(hurried);
    scree_scene_destroy(stepped);
}

/* A floor that rises more slowly than what counts as rest takes a sleeping ball along: it wakes whenever it is pressed
 * in. */
static void test_carried(void) {
    static const char text[] =
        "gravity = [0, 0, -9.81]\n[time]\nend = 100.0\nstep = 5e-5\nsleep = 1e-5\n"
        "[[material]]\nname = \"m\"\ndensity = 1000\n"
        "[[contact]]\nbetween = [\"m\", \"m\"]\nnormal = { law = \"linear\", stiffness = 1e3, restitution = 0.2 }\n"
        "[[motion]]\nname = \"up\"\nkind = \"velocity\"\nvelocity = 5e-6\n"
        "[[body]]\nname = \"floor\"\nshape = { plane = true }\nmaterial = \"m\"\n"
        "joint = { z = \"up\", others = \"fixed\" }\n"
        "[[body]]\nname = \"ball\"\nshape = { sphere = 0.01 }\nmaterial = \"m\"\nposition = [0, 0, 0.00999]\n";
    scree_scene *scene = scene_from(text, NULL, 0, 1);
    double mass = 1000.0 * 4.0 / 3.0 * 3.14159265358979 * 1e-6, slept = 0.0;
    go(scene, 20000);
    for (int k = 0; k < 100; k++) {
        go(scene, 1000);
        double height = state_of(scene, "ball").position[2] - 5e-6 * scree_scene_time(scene);
        NEAR(height, 0.01 - mass * 9.81 / 1e3, 1.1 * 4.0 * scene->contacts.rest.pull * mass / 1e3);
        slept += scree_scene_asleep(scene);
    }
    CHECK(slept > 10.0);
    scree_scene_destroy(scene);
}

/* A ball that sinks into a contact of thirty times the critical damping, so slowly at last that it falls asleep, half
 * borne by the dashpot. Asleep it doesn't sink, and wakes, no faster than it was: until the spring bears all but what
 * may go unnoticed. */
static void test_sinking(void) {
    static const char text[] =
        "gravity = [0, 0, -9.81]\n[time]\nend = 100.0\nstep = 2e-5\nsleep = 1e-5\n"
        "[[material]]\nname = \"m\"\n"
        "[[contact]]\nbetween = [\"m\", \"m\"]\nnormal = { law = \"linear\", stiffness = 1e3, damping = 120.0 }\n"
        "[[body]]\nname = \"floor\"\nshape = { plane = true }\nmaterial = \"m\"\njoint = \"fixed\"\n"
        "[[body]]\nname = \"ball\"\nshape = { sphere = 0.01 }\nmaterial = \"m\"\nmass = 0.004\nposition = [0, 0, "
        "0.01]\n";
    scree_scene *scene = scene_from(text, NULL, 0, 1);
    double seen = 4.0 * scene->contacts.rest.pull;
    CHECK(120.0 * 0.5e-5 / 0.004 > 4.0 * seen); /* what the dashpot bears at half of the speed of sleepers */
    double fastest = 0.0;
    for (int k = 0, slept = 0; k < 100000; k++) {
        go(scene, 1);
        slept |= sleeps(scene, "ball");
        if (slept) fastest = scree_most(fastest, fabs(state_of(scene, "ball").velocity[2]));
    }
    CHECK(sleeps(scene, "ball") && fastest > 0.0 && fastest < 1e-5);
    NEAR(state_of(scene, "ball").position[2], 0.01 - 0.004 * 9.81 / 1e3, seen * 0.004 / 1e3);
    scree_scene_destroy(scene);
}

/* ---- what can't sleep ---- */

static void refused(const char *change, const char *other, const char *part) {
    const char *changes[] = {change, other};
    scree_scene *scene = NULL;
    struct scree_run_request request;
    scree_trouble trouble;
    CHECK(scree_read_scene(stacks, strlen(stacks), "s.toml", changes, 2, 1, &scene, &request, &trouble) ==
          SCREE_BAD_INPUT);
    CONTAINS(trouble.text, part);
    scree_scene_destroy(scene);
    scree_free_request(&request);
}

static void test_refused(void) {
    refused("time.sleep=1e-5", "time.integrator=\"pair-impulse\"", "sleep goes with the integrator verlet");
    refused("time.sleep=-1", "time.force=false", "sleep must be");
    refused("time.sleep=1e-5", "gravity={vector=[0,0,-9.81], tilt=\"push\", axis=[0,1,0]}", "while gravity tilts");
}

/* However slow, what nothing holds goes on. */
static void test_drifting(void) {
    scree_scene *scene = scene_from(
        "gravity = [0, 0, 0]\n[time]\nend = 100.0\nstep = 5e-5\nsleep = 0.2\n[[material]]\nname = \"m\"\ndensity = "
        "1000\n"
        "[[contact]]\nbetween = [\"m\", \"m\"]\nnormal = { law = \"linear\", stiffness = 1e3, restitution = 0.2 }\n"
        "[[body]]\nname = \"a\"\nshape = { sphere = 0.01 }\nmaterial = \"m\"\nvelocity = [0.1, 0, 0]\n"
        "[[body]]\nname = \"b\"\nshape = { sphere = 0.01 }\nmaterial = \"m\"\nposition = [0.5, 0, 0]\n",
        NULL, 0, 1);
    go(scene, 4000);
    CHECK(!sleeps(scene, "a"));
    NEAR(state_of(scene, "a").position[0], 0.02, 4000 * 2e-16 * 0.02);
    scree_scene_destroy(scene);
}

/* Only free bodies sleep, at rest as they may be. */
static void test_held(void) {
    scree_scene *scene = scene_from(
        "gravity = [0, 0, -9.81]\n[time]\nend = 100.0\nstep = 5e-5\nsleep = 1e-5\n"
        "[[material]]\nname = \"m\"\ndensity = 1000\n"
        "[[contact]]\nbetween = [\"m\", \"m\"]\nnormal = { law = \"linear\", stiffness = 1e3, restitution = 0.2 }\n"
        "[[body]]\nname = \"floor\"\nshape = { plane = true }\nmaterial = \"m\"\njoint = \"fixed\"\n"
        "[[body]]\nname = \"ball\"\nshape = { sphere = 0.01 }\nmaterial = \"m\"\nposition = [0, 0, 0.01]\n"
        "joint = { x = \"fixed\" }\n"
        "[[body]]\nname = \"box\"\nshape = { box = [0.02, 0.02, 0.02], rounding = 0.002 }\nmaterial = \"m\"\n"
        "position = [0.1, 0, 0.01]\njoint = { turn = \"fixed\" }\n"
        "[[body]]\nname = \"free\"\nshape = { box = [0.02, 0.02, 0.02], rounding = 0.002 }\nmaterial = \"m\"\n"
        "position = [0.2, 0, 0.01]\n",
        NULL, 0, 1);
    go(scene, 10000);
    CHECK(sleeps(scene, "free") && !sleeps(scene, "ball") && !sleeps(scene, "box"));
    scree_scene_destroy(scene);
}

/* A box that edges bear, with corners in reach, sleeps on while a light ball glides over it: what it rests on counts
 * with all that leans (scree_lean_of), else it would be off balance by 8 %. */
static void test_on_edges(void) {
    scree_scene *scene = scene_from(
        "gravity = [0, 0, -9.81]\n[time]\nend = 1.0\nstep = 1e-5\nintegrator = \"verlet\"\nsleep = 1e-4\n"
        "[[material]]\nname = \"m\"\ndensity = 1000\n[[material]]\nname = \"g\"\ndensity = 1000\n"
        "[[contact]]\nbetween = [\"m\", \"m\"]\nnormal = { law = \"linear\", stiffness = 1e4, restitution = 0.2 }\n"
        "friction = { law = \"coulomb\", static = 0.5, kinetic = 0.5, stiffness = 1e4, damping = 20 }\n"
        "[[contact]]\nbetween = [\"m\", \"g\"]\nnormal = { law = \"linear\", stiffness = 1e3, restitution = 0.2 }\n"
        "[[body]]\nname = \"below\"\nmaterial = \"m\"\nshape = { box = [0.04, 0.03, 0.02], rounding = 0.003 }\n"
        "joint = \"fixed\"\n"
        "[[body]]\nname = \"above\"\nmaterial = \"m\"\nshape = { box = [0.04, 0.03, 0.02], rounding = 0.003 }\n"
        "position = [0.004, 0, 0.02]\norientation = { axis = [0, 0, 1], angle = 0.05 }\n"
        "[[body]]\nname = \"ball\"\nmaterial = \"g\"\nshape = { sphere = 0.002 }\nposition = [0, 0, 0.032]\n"
        "velocity = [0.02, 0, 0]\n",
        NULL, 0, 1);
    go(scene, 10000);
    for (int look = 0; look < 100; look++) {
        go(scene, 100);
        CHECK(sleeps(scene, "above") && !sleeps(scene, "ball"));
    }
    scree_scene_destroy(scene);
}

int main(void) {
    test_on_edges();
    test_push();
    test_drifting();
    test_held();
    test_waking_beside_sorted();
    test_carried();
    test_sinking();
    test_refused();
    return check_report();
}
