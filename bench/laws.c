/* scree-bench laws: time of a contact in the loop, for every law of the catalogue. */
#include "bench/bench.h"

#include <stdlib.h>
#include <string.h>

static const char help[] =
    "usage: scree-bench laws [--repeats N] [--integrator NAME]\n"
    "\n"
    "Time the contact loop with each law of the catalogue, its example's parameters, on one "
    "thread: 512 pairs of spheres\n"
    "that touch, slide and turn, all in the cache. Normal laws without friction; friction and "
    "rolling laws with the law\n"
    "\"linear\". Columns: kind, law, nanoseconds per contact (median of the repeats), and what "
    "of that isn't the gathering of\n"
    "bodies and the adding up of impulses, which \"linear\" without friction stands for.\n"
    "--integrator pair-impulse: the same of pair impulses, which follow each contact through its step.\n"
    "Unless given: --repeats 9 --integrator verlet.\n"
    "\n"
    "example: scree-bench laws --repeats 9 --integrator pair-impulse\n";

enum { PAIRS = 512, ROUNDS = 200, MOST_TEXT = PAIRS * 640 + 4096 };

static const char linear[] = "law = \"linear\", stiffness = 1e4, restitution = 0.5";

/* Pairs of spheres a little way into each other, far from other pairs. */
static scree_scene *make_scene(const char *integrator, const char *normal, const char *kind, const char *law) {
    char *text = malloc(MOST_TEXT);
    if (!text) exit(EXIT_MISSED);
    size_t used = (size_t)snprintf(text, MOST_TEXT,
                                   "[time]\nintegrator = \"%s\"\nend = 1.0\nstep = 1e-6\nforce = "
                                   "true\n[output]\nwrite = []\n[[material]]\nname = "
                                   "\"m\"\ndensity = 1000\n[[contact]]\nbetween = [\"m\", \"m\"]\nnormal = { %s }\n",
                                   integrator, normal);
    if (kind) used += (size_t)snprintf(text + used, MOST_TEXT - used, "%s = { %s }\n", kind, law);
    for (int k = 0; k < 2 * PAIRS; k++)
        used += (size_t)snprintf(text + used, MOST_TEXT - used,
                                 "[[body]]\nname = \"b%d\"\nmaterial = \"m\"\nshape = { sphere = 0.01 }\n"
                                 "position = [%g, %g, 0]\nvelocity = [%g, 0.1, %g]\nspin = [1, %d, 3]\n",
                                 k, 0.1 * (k / 2 % 32) + 0.01999 * (k % 2), 0.1 * (k / 64), 0.1 * (k % 3),
                                 0.05 * (k % 5), k % 7);
    scree_scene *scene = bench_scene_text(text, NULL, 0);
    free(text);
    return scene;
}

/* Nanoseconds per contact of one round: the same step over and over. */
static double round_of(scree_scene *scene) {
    const double none[3] = {0.0, 0.0, 0.0};
    double step = scree_scene_step_length(scene), begin;
    int impulses = scene->time.integrator == SCREE_PAIR_IMPULSE;
    if (impulses)
        scree_contacts_look_both(&scene->contacts, &scene->bodies, scene->bodies.count, 0.0, step, none, 1.0,
                                 &scene->shadow, 1);
    begin = bench_now();
    for (int k = 0; k < ROUNDS; k++)
        if (impulses)
            scree_contacts_impel(&scene->contacts, &scene->bodies, &scene->shadow, step, 1, NULL);
        else
            scree_contacts_act(&scene->contacts, &scene->bodies, step, 1, NULL);
    return (bench_now() - begin) / (ROUNDS * PAIRS) * 1e9;
}

/* The law and the plainest one take turns. */
static void row(const char *integrator, const char *kind, const struct scree_law_text *text, int repeats) {
    char law[512];
    snprintf(law, sizeof law, "law = \"%s\", %s", text->name, text->example ? text->example : "");
    int normal = strcmp(kind, "normal") == 0;
    scree_scene *plain = make_scene(integrator, linear, NULL, NULL);
    scree_scene *scene = make_scene(integrator, normal ? law : linear, normal ? NULL : kind, law);
    double *times = malloc((size_t)repeats * sizeof *times), *more = malloc((size_t)repeats * sizeof *more);
    if (!times || !more) exit(EXIT_MISSED);
    for (int r = -1; r < repeats; r++) { /* once to warm up */
        double base = round_of(plain), time = round_of(scene);
        if (r < 0) continue;
        times[r] = time;
        more[r] = time - base;
    }
    printf("%s,%s,%.2f,%.2f\n", kind, text->name, bench_median(times, repeats), bench_median(more, repeats));
    free(times);
    free(more);
    scree_scene_destroy(plain);
    scree_scene_destroy(scene);
}

int bench_laws(int count, char **words) {
    const char *repeats_text = NULL, *integrator = "verlet";
    const struct cli_option options[] = {
        {.name = "--repeats", .value = &repeats_text}, {.name = "--integrator", .value = &integrator}, {0}};
    int code = bench_parse(count, words, options, help);
    if (code) return code < 0 ? EXIT_GOOD : code;
    int repeats = repeats_text ? cli_whole_number(repeats_text, "--repeats", 1000) : 9;
    if (!repeats) return EXIT_USAGE;
    if (strcmp(integrator, "pair-impulse") != 0 && strcmp(integrator, "verlet") != 0)
        return cli_complain("--integrator is verlet or pair-impulse, not \"%s\"", integrator);
    bench_describe_machine();
    printf("kind,law,ns_per_contact,ns_beyond_linear\n");
    for (int k = 0; scree_normal_laws[k]; k++) row(integrator, "normal", &scree_normal_laws[k]->text, repeats);
    for (int k = 0; scree_friction_laws[k]; k++) row(integrator, "friction", &scree_friction_laws[k]->text, repeats);
    for (int k = 0; scree_rolling_laws[k]; k++) row(integrator, "rolling", &scree_rolling_laws[k]->text, repeats);
    return EXIT_GOOD;
}
