/* scree-bench process: time of a step in small scenes, and where it goes.
 *
 * Each stage of the step is also run alone, over and over on the scene as it is then; the stages alone add up to about
 * the whole, or less where the processor overlaps them. */
#include "bench/bench.h"

static const char help[] =
    "usage: scree-bench process [--steps N] [--repeats N]\n"
    "\n"
    "Time a step of small scenes on one thread, no output: a box that slides on one plane, the same without friction, "
    "a box\n"
    "on two rectangles (inclined plane), the process model while the comb pushes. Columns: nanoseconds per step "
    "(median of\n"
    "the repeats) and million steps per second; then, for the stages of the step run alone, nanoseconds: look ahead,\n"
    "contacts, advance; near contacts listed.\n"
    "Unless given: --steps 20000 --repeats 9.\n"
    "\n"
    "example: scree-bench process --repeats 9\n";

enum { SCENES = 4 };

static const struct {
    const char *name, *file;
    const char *changes[8];
    int count;
} scenes[SCENES] = {
    {"box sliding on a plane",
     "incline.toml",
     {"body.0.velocity=[1.0, 0.0, 0.0]", "body.1.shape={plane=true}", "body.2.position=[0.0, 5.0, 0.0]",
      "gravity=[0.0, 0.0, -9.81]", "output.write=[]"},
     5},
    {"the same, frictionless",
     "incline.toml",
     {"body.0.velocity=[1.0, 0.0, 0.0]", "body.1.shape={plane=true}", "body.2.position=[0.0, 5.0, 0.0]",
      "gravity=[0.0, 0.0, -9.81]",
      "contact.0={between=[\"product\", \"surface\"], normal={law=\"linear-loading\", stiffness=4e5, "
      "damping=261.6}, shared_by=4}",
      "output.write=[]"},
     6},
    {"inclined plane, two rectangles", "incline.toml", {"output.write=[]"}, 1},
    {"process model, comb pushing", "transport.toml", {"time.step=5e-6", "output.write=[]"}, 2},
};

/* Nanoseconds per call of a stage, each repeated `steps` times on copies of nothing: the scene is left where it is. */
static double stage_look_ahead(scree_scene *scene, long steps) {
    double gravity[3], start = bench_now();
    for (long k = 0; k < steps; k++) {
        scree_gravity_at(scene, scree_scene_time(scene), gravity);
        scree_bodies_look_ahead(&scene->bodies, scene->bodies.count, scree_scene_time(scene), scene->step, gravity,
                                1e300);
    }
    return (bench_now() - start) / (double)steps * 1e9;
}

static double stage_contacts(scree_scene *scene, long steps) {
    double start = bench_now();
    for (long k = 0; k < steps; k++) scree_contacts_act(&scene->contacts, &scene->bodies, scene->step, 1, NULL);
    return (bench_now() - start) / (double)steps * 1e9;
}

static double stage_advance(scree_scene *scene, long steps) {
    double gravity[3] = {0.0, 0.0, 0.0}, start = bench_now();
    for (int k = 0; k < scene->bodies.count; k++) /* nothing moves, so the state stays */
        for (int axis = 0; axis < 3; axis++)
            scene->bodies.record[k].impulse[axis] = scene->bodies.record[k].turn[axis] = 0.0;
    for (long k = 0; k < steps; k++)
        scree_bodies_advance(&scene->bodies, scene->bodies.count, scree_scene_time(scene), scene->step, gravity);
    return (bench_now() - start) / (double)steps * 1e9;
}

enum { MOST_REPEATS = 100 };

static void time_scene(int n, long steps, int repeats) {
    double whole[MOST_REPEATS], ahead[MOST_REPEATS], contacts[MOST_REPEATS], advance[MOST_REPEATS];
    int near = 0;
    for (int k = 0; k < repeats; k++) {
        scree_scene *scene = bench_scene(scenes[n].file, scenes[n].changes, scenes[n].count);
        bench_step(scene, 10000);
        double start = bench_now();
        bench_step(scene, steps);
        whole[k] = (bench_now() - start) / (double)steps * 1e9;
        near = 0;
        for (int b = 0; b < scene->contacts.batches; b++) near += scene->contacts.batch[b].count;
        ahead[k] = stage_look_ahead(scene, steps);
        contacts[k] = stage_contacts(scene, steps);
        advance[k] = stage_advance(scene, steps);
        scree_scene_destroy(scene);
    }
    double ns = bench_median(whole, repeats);
    printf("%s,%.1f,%.3f,%.1f,%.1f,%.1f,%d\n", scenes[n].name, ns, 1e3 / ns, bench_median(ahead, repeats),
           bench_median(contacts, repeats), bench_median(advance, repeats), near);
}

int bench_process(int count, char **words) {
    const char *steps = NULL, *repeats = NULL;
    const struct cli_option options[] = {
        {.name = "--steps", .value = &steps}, {.name = "--repeats", .value = &repeats}, {0}};
    int code = bench_parse(count, words, options, help);
    if (code) return code < 0 ? EXIT_GOOD : code;
    int step_count = steps ? cli_whole_number(steps, "--steps", 100000000) : 20000;
    int repeat_count = repeats ? cli_whole_number(repeats, "--repeats", MOST_REPEATS) : 9;
    if (!step_count || !repeat_count) return EXIT_USAGE;
    bench_describe_machine();
    printf("scene,step_ns,million_steps_per_s,look_ahead_ns,contacts_ns,advance_ns,near_contacts\n");
    for (int n = 0; n < SCENES; n++) time_scene(n, step_count, repeat_count);
    return EXIT_GOOD;
}
