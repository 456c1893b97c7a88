/* scree run: simulate a scene file. */
#include "engine/cli/cli.h"
#include "engine/output.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

static const char help[] =
    "usage: scree run SCENE [-o DIR] [--set KEY=VALUE …] [--threads N] [--resume STATE] [--quiet]\n"
    "\n"
    "Simulate a scene file (\"-\": standard input). Tables and frames go into DIR (default: the name of the "
    "scene without\n"
    ".toml), with the state at the end in DIR/final.state. Progress is shown on a terminal.\n"
    "\n"
    "  -o DIR           where to write\n"
    "  --set KEY=VALUE  change the scene: time.end=2.0, body.product.velocity=[1,0,0], "
    "contact.0.friction.kinetic=0.2\n"
    "  --threads N      threads; the result is the same for any number\n"
    "  --resume STATE   go on from a final.state of the same scene, up to the scene's end\n"
    "  --quiet          no progress and no summary\n"
    "\n"
    "example: scree run data/scenes/incline.toml -o /tmp/incline --set time.end=0.5\n";

struct run {
    scree_scene *scene;
    struct scree_run_request request;
    struct scree_output output;
    scree_trouble trouble;
    int quiet;
    time_t shown;
};

/* "scenes/drop.toml" -> "drop"; to be freed. */
static char *default_folder(const char *scene) {
    const char *slash = strrchr(scene, '/');
    char *folder = strdup(strcmp(scene, "-") == 0 ? "scene" : slash ? slash + 1 : scene);
    char *dot = folder ? strrchr(folder, '.') : NULL;
    if (dot && dot > folder) *dot = '\0';
    return folder;
}

static void show_progress(struct run *run, long done, long all) {
    if (run->quiet || !isatty(STDERR_FILENO) || (time(NULL) == run->shown && done < all)) return;
    run->shown = time(NULL);
    fprintf(stderr, "\r%5.1f %%  t = %-12.6g s", 100.0 * (double)done / (double)all, scree_scene_time(run->scene));
    if (done >= all) fprintf(stderr, "\n");
}

/* Steps from t = 0 to a time, by rounding up: the last row is never before the time asked for. */
static long steps_to(const scree_scene *scene, double time) {
    return (long)ceil(time / scree_scene_step_length(scene) * (1.0 - 1e-12));
}

static scree_status simulate(struct run *run) {
    const struct scree_run_request *request = &run->request;
    long last = steps_to(run->scene, request->end);
    scree_status status = scree_output_row(&run->output, run->scene, &run->trouble);
    for (long row = 1; !status && scree_scene_steps(run->scene) < last;) {
        long target = request->every > 0.0 ? steps_to(run->scene, (double)row * request->every) : last;
        row++;
        if (target <= scree_scene_steps(run->scene)) continue;
        if (target > last) target = last;
        while (!status && scree_scene_steps(run->scene) < target) {
            long chunk = target - scree_scene_steps(run->scene);
            status = scree_scene_step(run->scene, chunk < 1000 ? chunk : 1000);
            show_progress(run, scree_scene_steps(run->scene), last);
        }
        if (status)
            run->trouble = *scree_scene_trouble(run->scene);
        else
            status = scree_output_row(&run->output, run->scene, &run->trouble);
    }
    return status;
}

static void warn_of_chatter(const scree_scene *scene) {
    int ball, host;
    double steepest = scree_scene_steepest(scene, &ball, &host);
    if (steepest <= 1.0) return;
    cli_complain("warning: the friction between \"%s\" and \"%s\" was too steep for the step (by a factor of "
                 "%.3g): sliding speeds "
                 "may chatter about zero; a larger threshold or a step below %.3g s avoids it",
                 scree_scene_body_name(scene, ball), scree_scene_body_name(scene, host), steepest,
                 scree_scene_step_length(scene) / steepest);
}

static void summarise(const struct run *run, const char *folder, double seconds, long steps) {
    int ball, host;
    double deepest = scree_scene_deepest(run->scene, &ball, &host);
    fprintf(stderr, "%ld steps of %.6g s in %.3g s (%.3g steps/s)\n", steps, scree_scene_step_length(run->scene),
            seconds, (double)steps / (seconds > 0.0 ? seconds : 1e-9));
    if (ball >= 0)
        fprintf(stderr, "deepest overlap: %.3g of the tolerable, \"%s\" with \"%s\"\n", deepest,
                scree_scene_body_name(run->scene, ball), scree_scene_body_name(run->scene, host));
    fprintf(stderr, "state hash: %016llx\n", (unsigned long long)scree_scene_hash(run->scene));
    fprintf(stderr, "written to %s\n", folder);
}

static scree_status resume(struct run *run, const char *path) {
    FILE *file = fopen(path, "rb");
    if (!file) return scree_report(&run->trouble, SCREE_NO_FILE, NULL, "%s: %s", path, strerror(errno));
    scree_status status = scree_scene_restore(run->scene, file, path);
    if (status) run->trouble = *scree_scene_trouble(run->scene);
    fclose(file);
    return status;
}

static scree_status run_loaded(struct run *run, const char *folder, const char *state) {
    scree_status status = state ? resume(run, state) : SCREE_OK;
    if (!status) status = scree_output_open(&run->output, folder, &run->request, &run->trouble);
    if (status) return status;
    struct timespec start, end;
    long before = scree_scene_steps(run->scene);
    clock_gettime(CLOCK_MONOTONIC, &start);
    status = simulate(run);
    clock_gettime(CLOCK_MONOTONIC, &end);
    if (!status) status = scree_output_keep(&run->output, run->scene, &run->trouble);
    scree_output_drop(&run->output);
    warn_of_chatter(run->scene);
    if (!status && !run->quiet)
        summarise(run, folder, (double)(end.tv_sec - start.tv_sec) + 1e-9 * (double)(end.tv_nsec - start.tv_nsec),
                  scree_scene_steps(run->scene) - before);
    if (status == SCREE_FAILED) fprintf(stderr, "scree: rows up to the stop are left in %s/*.part\n", folder);
    return status;
}

int cli_run(int count, char **words) {
    const char *folder = NULL, *threads = NULL, *state = NULL, *assignments[256];
    int assignment_count = 0;
    struct run run = {0};
    const struct cli_option options[] = {
        {.name = "-o", .value = &folder},
        {.name = "--threads", .value = &threads},
        {.name = "--resume", .value = &state},
        {.name = "--quiet", .flag = &run.quiet},
        {.name = "--set", .list = assignments, .list_count = &assignment_count, .list_capacity = 256},
        {0}};
    int code = cli_parse(&count, words, options, help);
    if (code) return code < 0 ? EXIT_GOOD : code;
    if (count != 1) return cli_complain("run takes one scene file (see scree run --help)");
    int thread_count = threads ? cli_whole_number(threads, "--threads", 1024) : 0;
    if (threads && !thread_count) return EXIT_USAGE;

    char *named = folder ? NULL : default_folder(words[0]);
    scree_status status =
        scree_load_scene(words[0], assignments, assignment_count, thread_count, &run.scene, &run.request, &run.trouble);
    if (!status) status = run_loaded(&run, folder ? folder : named, state);
    if (status) cli_complain("%s", run.trouble.text);
    scree_scene_destroy(run.scene);
    scree_free_request(&run.request);
    free(named);
    return cli_exit_code(status);
}
