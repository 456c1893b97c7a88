/* scree check: validate a scene file and print its plan. */
#include "engine/cli/cli.h"
#include "engine/scene.h"
#include "engine/scene_file.h"

static const char help[] = "usage: scree check SCENE [--set KEY=VALUE …] [--threads N]\n"
                           "\n"
                           "Validate a scene file (\"-\": standard input) and print what would run: bodies, "
                           "contacts, what is skipped and why, the\n"
                           "step and the contact that dictated it. Exit status 2 if the scene isn't valid.\n"
                           "\n"
                           "example: scree check data/scenes/transport.toml\n";

/* The last step goes beyond the end, where that isn't a whole number of steps. */
static void print_end(const scree_scene *scene, const struct scree_run_request *request) {
    long steps = scree_steps_to(scene, request->end);
    double reached = (double)steps * scree_scene_step_length(scene);
    printf("end: %.9g s, %ld steps", request->end, steps);
    if (reached > request->end * (1.0 + 1e-9)) printf(" (to %.9g s)", reached);
    printf("%s\n", scene->time.integrator == SCREE_ADAPTIVE ? ", and within them as many as it takes" : "");
}

int cli_check(int count, char **words) {
    const char *threads = NULL, *assignments[256];
    int assignment_count = 0;
    const struct cli_option options[] = {
        {.name = "--threads", .value = &threads},
        {.name = "--set", .list = assignments, .list_count = &assignment_count, .list_capacity = 256},
        {0}};
    int code = cli_parse(&count, words, options, help);
    if (code) return code < 0 ? EXIT_GOOD : code;
    if (count != 1) return cli_complain("check takes one scene file (see scree check --help)");
    int thread_count = threads ? cli_whole_number(threads, "--threads", SCREE_MOST_THREADS) : 0;
    if (threads && !thread_count) return EXIT_USAGE;

    scree_scene *scene;
    struct scree_run_request request;
    scree_trouble trouble;
    scree_status status =
        scree_load_scene(words[0], assignments, assignment_count, thread_count, &scene, &request, &trouble);
    if (status)
        cli_complain("%s", trouble.text);
    else {
        if (request.title[0]) printf("%s\n", scree_shown(request.title).text);
        scree_scene_describe(scene, stdout);
        print_end(scene, &request);
    }
    scree_scene_destroy(scene);
    scree_free_request(&request);
    return cli_exit_code(status);
}
