/* Several steps in one sweep through the slabs (contact/sweep.c): the same bits as one after the other, errors too. */
#include "tests/allocations.h"
#include "tests/scenes.h"

#include <limits.h>
#include <string.h>

/* Balls of a few sizes that fall onto others in a long trough, and rub; `mixed`: of two materials. Now and then one is
 * frozen. */
static char *trough_text(int mixed) {
    static const char *const wall[][2] = {{"[0, 0, 0]", "[1, 0, 0, 0]"},
                                          {"[0, 0, 0]", "[0.7071067811865476, 0, 0.7071067811865476, 0]"},
                                          {"[0.4, 0, 0]", "[0.7071067811865476, 0, -0.7071067811865476, 0]"},
                                          {"[0, 0, 0]", "[0.7071067811865476, -0.7071067811865476, 0, 0]"},
                                          {"[0, 0.06, 0]", "[0.7071067811865476, 0.7071067811865476, 0, 0]"}};
    enum { COUNT = 1600 };
    char *text = malloc(COUNT * 300 + 8192);
    int used = sprintf(text, "%s",
                       "gravity = [0, 0, -3]\n[time]\nintegrator = \"verlet\"\nend = 1.0\nstep = 4e-6\n"
                       "[[material]]\nname = \"ball\"\ndensity = 2000\nyoung = 1e6\npoisson = 0.25\n"
                       "[[contact]]\nbetween = [\"ball\", \"ball\"]\nnormal = { law = \"tsuji\", restitution = 0.4 }\n"
                       "friction = { law = \"mindlin\", static = 0.5, kinetic = 0.4 }\n"
                       "[[motion]]\nname = \"lean\"\nkind = \"velocity\"\nvelocity = 0.1\n"
                       "[[material]]\nname = \"other\"\ndensity = 2500\nyoung = 2e6\npoisson = 0.25\n"
                       "[[contact]]\nbetween = [\"ball\", \"other\"]\nnormal = { law = \"hertz\" }\n"
                       "[[contact]]\nbetween = [\"other\", \"other\"]\nnormal = { law = \"hertz\" }\n");
    for (size_t w = 0; w < sizeof wall / sizeof *wall; w++)
        used += sprintf(text + used,
                        "[[body]]\nname = \"wall%zu\"\nshape = { plane = true }\nmaterial = \"ball\"\njoint = "
                        "\"fixed\"\nposition = %s\norientation = %s\n",
                        w, wall[w][0], wall[w][1]);
    uint64_t seed = 17;
    for (int k = 0; k < COUNT; k++) {
        int x = k % 38, y = k / 38 % 5, z = k / (38 * 5);
        double off[2], v[3];
        check_draw(&seed, -2e-4, 2e-4, 2, off);
        check_draw(&seed, -0.03, 0.03, 3, v);
        used +=
            sprintf(text + used,
                    "[[body]]\nname = \"b%d\"\nmaterial = \"%s\"\nshape = { sphere = %s }\nposition = [%.17g, %.17g, "
                    "%.17g]\n",
                    k, mixed && k % 7 == 3 ? "other" : "ball", k % 3 ? "0.005" : "0.0045", 0.0105 + 0.0102 * x + off[0],
                    0.0095 + 0.0102 * y + off[1], 0.006 + 0.0104 * z);
        if (k % 150 == 5)
            used += sprintf(text + used, "joint = \"fixed\"\n");
        else
            used += sprintf(text + used, "velocity = [%.17g, %.17g, %.17g]\n", v[0], v[1], v[2]);
    }
    return text;
}

/* A scene that sweeps as if it were too large for the third cache, but not by much; or that doesn't. */
static scree_scene *scene_of(const char *text, const char *const *changes, int count, int sweeps) {
    scree_scene *scene = scene_from(text, changes, count, 1);
    scene->contacts.cached = sweeps ? scene->bodies.count / 2 : INT_MAX;
    return scene;
}

enum { STEPS = 2100, PART = 1025 };

/* Steps of a scene in which some body or other has all but outgrown its margin now and then. */
static void go_hindered(scree_scene *scene, int steps) {
    struct scree_bodies *bodies = &scene->bodies;
    uint64_t seed = 5;
    for (int done = 0, some; done < steps; done += some) {
        double draw[2];
        check_draw(&seed, 0.0, 1.0, 2, draw);
        int k = bodies->order.members + (int)(draw[0] * (bodies->count - bodies->order.members));
        double way = scene->step * vec_norm(vec_from(bodies->state[k].v));
        bodies->path[k] = 0.5 * scene->contacts.skin - 16.0 * draw[1] * way;
        some = steps - done < 16 ? steps - done : 16;
        go(scene, some);
    }
}

/* Whatever steps are done at a time, and wherever lists are renewed on the way. */
static void test_same_bits(int mixed, const char *const *changes, int count) {
    char *text = trough_text(mixed);
    scree_scene *plain = scene_of(text, changes, count, 0), *swept = scene_of(text, changes, count, 1),
                *parted = scene_of(text, changes, count, 1);
    CHECK(plain->bodies.order.slabs >= 8);
    for (int done = 0; done < STEPS; done += PART) {
        int steps = STEPS - done < PART ? STEPS - done : PART;
        go(plain, steps);
        go_hindered(swept, steps);
        for (int k = 0; k < steps; k += 7) go(parted, steps - k < 7 ? steps - k : 7);
        CHECK(scree_scene_steps(swept) == scree_scene_steps(plain));
        CHECK(scree_scene_hash(swept) == scree_scene_hash(plain) &&
              scree_scene_hash(parted) == scree_scene_hash(plain));
    }
    const struct scree_sweep *sweep = &swept->contacts.sweep;
    CHECK(plain->contacts.sweep.made == 0 && sweep->made > STEPS / SCREE_SWEEP / 2 && sweep->stops > 20);
    CHECK(plain->contacts.deepest == swept->contacts.deepest);
    CHECK(plain->contacts.deepest_ball == swept->contacts.deepest_ball);
    CHECK(plain->contacts.deepest_host == swept->contacts.deepest_host);
    scree_scene_destroy(plain);
    scree_scene_destroy(swept);
    scree_scene_destroy(parted);
    free(text);
}

/* A state that is saved between sweeps goes on by others. */
static void test_restored(const char *const *changes, int count) {
    char *text = trough_text(0);
    scree_scene *scene = scene_of(text, changes, count, 1), *other = scene_of(text, changes, count, 1);
    FILE *file = tmpfile();
    go(scene, 530);
    CHECK(scree_scene_save(scene, file, "memory") == SCREE_OK);
    rewind(file);
    CHECK(scree_scene_restore(other, file, "memory") == SCREE_OK);
    fclose(file);
    go(scene, 570);
    go(other, 570);
    CHECK(scree_scene_hash(scene) == scree_scene_hash(other) && other->contacts.sweep.made > 50);
    scree_scene_destroy(scene);
    scree_scene_destroy(other);
    free(text);
}

/* Where it makes a difference when something happens, a scene doesn't sweep. */
static void test_not_swept(void) {
    static const char *const changes[][2] = {
        {"body.b0.joint={x=\"fixed\",others=\"free\"}", "body.b0.velocity=[0,0,0]"},
        {"gravity={vector=[0,0,-3],axis=[0,1,0],tilt=\"lean\"}", NULL},
        {"output={write=[\"energy.csv\"]}", NULL},
        {"time.sleep=0.1", NULL},
    };
    char *text = trough_text(0);
    for (size_t k = 0; k < sizeof changes / sizeof *changes; k++) {
        scree_scene *scene = scene_of(text, changes[k], changes[k][1] ? 2 : 1, 1);
        CHECK(scree_scene_most_in_sweep(scene) == 1);
        go(scene, 40);
        CHECK(scene->contacts.sweep.made == 0);
        scree_scene_destroy(scene);
    }
    scree_scene *scene = scene_of(text, NULL, 0, 1);
    go(scene, 40);
    CHECK(scene->contacts.sweep.made == 10);
    scree_scene_destroy(scene);
    free(text);
}

/* The first contact of two balls that rub loses its number. */
static void lose_number(scree_scene *scene) {
    const struct scree_contacts *contacts = &scene->contacts;
    const struct scree_batch *batch = scree_batch_for(contacts, contacts->rule, SCREE_BALL_BALL);
    int k = scree_first(batch);
    while (k >= 0 && scree_kept(batch, 0, k) == 0.0) k = scree_next(batch, k);
    CHECK(k >= 0);
    if (k >= 0) scree_keep(batch, 0, k, NAN);
}

/* A ball that is shot through slabs of others, or too fast; or, after `steps`, one that becomes no number in the first
 * step of a sweep: what happens, and what is said, is the same. */
static void test_shot(const char *const *changes, int count, int steps, double speed, int fails) {
    char *text = trough_text(0);
    scree_scene *scene[2];
    for (int sweeps = 0; sweeps < 2; sweeps++) {
        scene[sweeps] = scene_of(text, changes, count, sweeps);
        go(scene[sweeps], steps);
        if (isnan(speed)) lose_number(scene[sweeps]);
        int place = scene[sweeps]->bodies.place[scree_scene_find_body(scene[sweeps], "b600")];
        if (!isnan(speed)) scene[sweeps]->bodies.state[place].v[0] = speed;
        scree_status status = scree_scene_step(scene[sweeps], 1600);
        CHECK(status == (fails ? SCREE_FAILED : SCREE_OK));
    }
    CHECK(scene[1]->contacts.sweep.made > 50);
    if (isnan(speed))
        CHECK(scene[1]->contacts.sweep.steps &&
              strstr(scree_scene_trouble(scene[1])->text, "no longer a finite number"));
    if (fails) {
        CHECK(strcmp(scree_scene_trouble(scene[0])->text, scree_scene_trouble(scene[1])->text) == 0);
        CHECK(scree_scene_trouble(scene[0])->time == scree_scene_trouble(scene[1])->time);
    } else
        CHECK(scree_scene_hash(scene[0]) == scree_scene_hash(scene[1]));
    scree_scene_destroy(scene[0]);
    scree_scene_destroy(scene[1]);
    free(text);
}

/* A sweep on whose way all bodies outgrow their margins, while lists have to ask for memory, which is refused them: the
 * scene can't be saved meanwhile, and goes on where it was. Returns how often. */
static int sweep_refused(scree_scene *scene) {
    struct scree_bodies *bodies = &scene->bodies;
    struct scree_space *rough = &scene->contacts.rough; /* which nobody needs between steps */
    FILE *file = tmpfile();
    long done = scree_scene_steps(scene);
    int refusals = 0;
    for (int k = bodies->order.members; k < bodies->count; k++) {
        double way = scene->step * vec_norm(vec_from(bodies->state[k].v));
        bodies->path[k] = 0.5 * scene->contacts.skin - 2.5 * way;
        scene->contacts.spare[k] = 0.0f;
    }
    scree_memory_free(rough->memory);
    *rough = (struct scree_space){NULL, 0};
    for (scree_status status = SCREE_NO_MEMORY; status && refusals < 100; refusals += status != SCREE_OK) {
        refused = 1 + refusals;
        status = scree_scene_step(scene, SCREE_SWEEP);
        int met = refused == 0;
        refused = 0;
        if (status == SCREE_OK) continue;
        CHECK(met && status == SCREE_NO_MEMORY && scene->contacts.sweep.steps == SCREE_SWEEP);
        CHECK(scree_scene_steps(scene) == done && scree_scene_save(scene, file, "memory") == SCREE_NO_MEMORY);
    }
    CHECK(scree_scene_steps(scene) == done + SCREE_SWEEP);
    fclose(file);
    return refusals;
}

static void test_refused(const char *const *changes, int count) {
    char *text = trough_text(0);
    scree_scene *scene = scene_of(text, changes, count, 1), *other = scene_of(text, changes, count, 0);
    int refusals = 0;
    for (int k = 0; k < 50; k++) {
        refusals += sweep_refused(scene);
        go(scene, 8);
        go(other, 12);
    }
    CHECK(refusals >= 50);
    CHECK(scree_scene_hash(scene) == scree_scene_hash(other));
    scree_scene_destroy(scene);
    scree_scene_destroy(other);
    free(text);
}

/* As many steps as leave what is under way in the third cache. */
static void test_steps_in_sweep(void) {
    char *text = trough_text(0);
    scree_scene *scene = scene_of(text, NULL, 0, 1);
    struct scree_contacts *contacts = &scene->contacts;
    char *plan = NULL;
    size_t size;
    FILE *file = open_memstream(&plan, &size);
    scree_scene_describe(scene, file);
    fclose(file);
    CHECK(strstr(plan, "slabs across x, up to 4 steps in one sweep"));
    free(plan);
    go(scene, 4);
    CHECK(scree_steps_in_sweep(contacts, &scene->bodies) == SCREE_SWEEP);
    int before = SCREE_SWEEP, steps = 0;
    for (contacts->cached = scene->bodies.count; contacts->cached > 0; contacts->cached--, before = steps) {
        steps = scree_steps_in_sweep(contacts, &scene->bodies);
        CHECK(SCREE_SWEEP % steps == 0 && steps <= before);
    }
    CHECK(steps == 1);
    contacts->cached = scene->bodies.count + 1;
    CHECK(scree_steps_in_sweep(contacts, &scene->bodies) == 1);
    scree_scene_destroy(scene);
    free(text);
}

int main(void) {
    static const char *const dry[] = {"material.ball.young=1e7"};
    static const char *const impulses[] = {"time.integrator=\"pair-impulse\""};
    test_same_bits(0, NULL, 0);
    test_same_bits(1, dry, 1);
    test_same_bits(0, impulses, 1);
    test_restored(NULL, 0);
    test_restored(impulses, 1);
    test_not_swept();
    for (int count = 0; count < 2; count++) {
        test_shot(impulses, count, 400, 1.0, 0);
        test_shot(impulses, count, 400, 3.0, 0);
        for (int speed = 20; speed < 60; speed += 4) test_shot(impulses, count, 400, speed, 1);
        test_shot(impulses, count, 400, 500.0, 1);
        for (int steps = 400; steps < 403; steps++) test_shot(impulses, count, steps, NAN, 1);
        test_refused(impulses, count);
    }
    test_steps_in_sweep();
    return check_report();
}
