/* scree run: simulate a scene file. */
#include "engine/cli/cli.h"
#include "engine/output.h"
#include "engine/scene.h"

#include <errno.h>
#include <math.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

static const char help[] =
    "usage: scree run SCENE [-o DIR] [--set KEY=VALUE …] [--threads N] [--resume STATE] [--quiet]\n"
    "\n"
    "Simulate a scene file (\"-\": standard input). Tables and frames go into DIR (default: the scene's name without\n"
    ".toml; NAME-resumed with --resume), with the state at the end in DIR/final.state. Files get their names when all "
    "are\n"
    "whole: a run that is stopped leaves earlier results as they were, and its own as *.part; interrupted (Ctrl-C), "
    "also\n"
    "its state, final.state.part, from which --resume goes on. What can't be written is removed. Progress is shown on "
    "a\n"
    "terminal.\n"
    "\n"
    "  -o DIR           where to write\n"
    "  --set KEY=VALUE  change the scene: time.end=2.0, body.product.velocity=[1,0,0], "
    "contact.0.friction.kinetic=0.2\n"
    "  --threads N      threads; the result is the same for any number. No more than processors are free: beside "
    "other\n"
    "                   work they are slower than one, unless OMP_WAIT_POLICY=passive is set\n"
    "  --resume STATE   go on from a final.state of the same scene (its end and its output may differ), up to the "
    "scene's\n"
    "                   end, into another folder than that of STATE\n"
    "  --quiet          no progress and no summary\n"
    "\n"
    "example: scree run data/scenes/incline.toml -o /tmp/incline --set time.end=0.5\n";

struct run {
    scree_scene *scene;
    struct scree_run_request request;
    struct scree_output output;
    scree_trouble trouble;
    int quiet;
    time_t shown, began; /* progress last, and the run, at the step `from` */
    long from;
    scree_effort before; /* what came with a state */
    /* Energy books, if they are kept, since the start; and where the balance was worst beside what was turned over. */
    struct scree_watched books;
    double worst, worst_of, worst_time;
    int halvings;   /* told so far */
    int broken_off; /* by a signal, before its end */
};

/* Set by the signals that interrupt a run, unless they are to be ignored (in the background of a script); a second one
 * kills it. */
static volatile sig_atomic_t interrupted;

static void note_signal(int signal) { interrupted = signal; }

static void heed(int signal) {
    struct sigaction before, action = {.sa_handler = note_signal, .sa_flags = (int)SA_RESETHAND};
    if (sigaction(signal, NULL, &before) == 0 && before.sa_handler != SIG_IGN) sigaction(signal, &action, NULL);
}

/* What is left of the run if it goes on as it went so far; nothing before that can be told. */
static void show_left(const struct run *run, long done, long all) {
    double gone = difftime(run->shown, run->began), left = gone * (double)(all - done) / (double)(done - run->from);
    double unit = left < 120.0 ? 1.0 : left < 7200.0 ? 60.0 : left < 172800.0 ? 3600.0 : 86400.0;
    const char *name = unit == 1.0 ? "s" : unit == 60.0 ? "min" : unit == 3600.0 ? "h" : "days";
    if (gone >= 2.0 && done > run->from) fprintf(stderr, "  %.0f %s left   ", left / unit, name);
}

static void show_progress(struct run *run, long done, long all) {
    if (run->quiet || !isatty(STDERR_FILENO) || (time(NULL) == run->shown && done < all)) return;
    run->shown = time(NULL);
    fprintf(stderr, "\r%5.1f %%  t = %-12.6g s", 100.0 * (double)done / (double)all, scree_scene_time(run->scene));
    show_left(run, done, all);
    if (done >= all) fprintf(stderr, "\n");
}

/* The step after which the next row is due: the first that isn't before a multiple of `every`; at most `last`. */
static long next_row(const struct run *run, long last) {
    double every = run->request.every, step = scree_scene_step_length(run->scene);
    long steps = scree_scene_steps(run->scene);
    if (!(every > 0.0)) return last;
    if (every <= step) return steps + 1;
    for (double row = fmax(1.0, floor((double)steps * step / every)); row * every < run->request.end; row++) {
        long target = scree_steps_to(run->scene, row * every);
        if (target > steps) return target < last ? target : last;
    }
    return last;
}

/* The worst share by which the books were off. */
static scree_status watch_books(struct run *run) {
    if (!run->scene->time.energy) return SCREE_OK;
    scree_energy energy;
    scree_status status = scree_scene_energy(run->scene, &energy);
    if (status) {
        run->trouble = *scree_scene_trouble(run->scene);
        return status;
    }
    double turned = scree_turned_over(&run->books, &energy);
    int judge = !(fabs(energy.balance) <= scree_too_little(run->scene, &energy));
    double gap = judge ? fabs(energy.balance) / turned : 0.0;
    if (run->worst_of < 1e-9 * turned) run->worst = 0.0; /* of a motion that was nothing beside this */
    if (gap > run->worst) {
        run->worst = gap;
        run->worst_of = turned;
        run->worst_time = scree_scene_time(run->scene);
    }
    return SCREE_OK;
}

/* What the watch has done since it was last asked. */
static void tell_halvings(struct run *run) {
    for (; run->halvings < scree_scene_halvings(run->scene); run->halvings++) {
        const scree_halving *halving = scree_scene_halving(run->scene, run->halvings);
        if (run->shown) fputc('\n', stderr); /* ends the line of the progress */
        cli_complain("%s; went back to t = %.9g s, and on with half the step, %.6g s", halving->cause.text,
                     halving->back, halving->step);
    }
}

static long last_step(const struct run *run) { return scree_steps_to(run->scene, run->request.end); }

/* Steps at once: about half a second of a large scene, for whoever watches or interrupts it. A watch goes back to where
 * they began. */
static long most_steps(const struct run *run) {
    double few = 1e7 / scree_scene_bodies(run->scene);
    return run->scene->time.watch == SCREE_WATCH_HALVE || few >= 1000.0 ? 1000 : few < 1.0 ? 1 : (long)few;
}

/* Up to the next row. Where the step is halved on the way, twice as many lead to the same instant. */
static scree_status step_to_row(struct run *run) {
    scree_status status = SCREE_OK;
    long target = next_row(run, last_step(run));
    while (!status && !interrupted && scree_scene_steps(run->scene) < target) {
        long chunk = target - scree_scene_steps(run->scene), most = most_steps(run);
        int halvings = scree_scene_halvings(run->scene);
        status = scree_scene_step(run->scene, chunk < most ? chunk : most);
        target <<= scree_scene_halvings(run->scene) - halvings;
        tell_halvings(run);
        if (status) run->trouble = *scree_scene_trouble(run->scene);
        if (!status) status = watch_books(run);
        show_progress(run, scree_scene_steps(run->scene), last_step(run));
    }
    return status;
}

static scree_status simulate(struct run *run) {
    run->halvings = scree_scene_halvings(run->scene); /* of the state resumed from */
    run->began = time(NULL);
    run->from = scree_scene_steps(run->scene);
    scree_status status = scree_output_row(&run->output, run->scene, &run->trouble);
    if (!status) status = watch_books(run);
    while (!status && !interrupted && scree_scene_steps(run->scene) < last_step(run)) {
        status = step_to_row(run);
        if (!status && !interrupted) status = scree_output_row(&run->output, run->scene, &run->trouble);
    }
    return status;
}

static void warn_of_chatter(const scree_scene *scene) {
    int ball, host;
    double steepest = scree_scene_steepest(scene, &ball, &host);
    if (steepest <= 1.0) return;
    cli_complain("warning: the friction or rolling resistance between \"%s\" and \"%s\" was too steep for the step (by "
                 "a factor of "
                 "%.3g): sliding speeds "
                 "may chatter about zero; a larger threshold or a step below %.3g s avoids it",
                 scree_shown(scree_scene_body_name(scene, ball).text).text,
                 scree_shown(scree_scene_body_name(scene, host).text).text, steepest,
                 scree_scene_step_length(scene) / steepest);
}

/* What was off before each halving stays in the result. */
static void warn_of_halvings(const struct run *run) {
    double lack = run->halvings > 0 ? scree_books_lack(run->scene) : 0.0;
    if (lack <= scree_tolerable_gap) return;
    cli_complain("warning: over all halvings the energy books were off by %.3g %% of what was turned over: the result "
                 "is wrong by up to as much; to begin with a step of %.3g s avoids it",
                 100.0 * lack, scree_scene_step_length(run->scene));
}

static void warn_of_books(const struct run *run) {
    if (run->worst <= scree_tolerable_gap) {
        warn_of_halvings(run);
        return;
    }
    if (run->scene->time.integrator == SCREE_ADAPTIVE) {
        cli_complain(
            "warning: the energy books lack %.3g %% of what was turned over (worst at t = %.6g s): the result is "
            "wrong by as much; a smaller tolerance than %.3g avoids it",
            100.0 * run->worst, run->worst_time, run->scene->time.tolerance);
        return;
    }
    const char *other = !run->scene->plan.choice.automatic ? " or step = \"auto\" avoids it"
                        : run->scene->time.integrator == SCREE_PAIR_IMPULSE
                            ? " avoids it"
                            : " or integrator = \"pair-impulse\" avoids it";
    cli_complain("warning: the energy books lack %.3g %% of what was turned over (worst at t = %.6g s): the result "
                 "is wrong by as much; a smaller step than %.3g s%s",
                 100.0 * run->worst, run->worst_time, scree_scene_step_length(run->scene), other);
}

/* Ten steps follow a contact to some 0.2 % of the speed, five to 2 %. Pair impulses follow that of two spheres however
 * long they are. */
static void warn_of_coarse_step(const struct run *run) {
    const struct scree_step_choice *choice = &run->scene->plan.choice;
    double step = scree_scene_step_length(run->scene);
    if (!(step > choice->duration / 10.0) || run->scene->time.integrator == SCREE_ADAPTIVE) return;
    const char *which = run->scene->time.integrator == SCREE_PAIR_IMPULSE
                            ? "impacts of boxes, and of more than two bodies at a time, come out wrong by percents"
                            : "impacts come out wrong by percents";
    cli_complain("warning: the step of %.3g s is more than a tenth of the shortest contact that can happen (%.3g s, "
                 "\"%s\" with \"%s\"): %s",
                 step, choice->duration,
                 scree_shown(scree_scene_body_name(run->scene, choice->shortest_pair[0]).text).text,
                 scree_shown(scree_scene_body_name(run->scene, choice->shortest_pair[1]).text).text, which);
}

/* At 0.3 half-widths a step two balls that graze each other are off by 1 % of what they exchange, at 0.95 by 16 %. */
static void warn_of_haste(const struct run *run) {
    const scree_scene *scene = run->scene;
    if (scene->hasty <= 0.25) return;
    cli_complain("warning: \"%s\" moved, or its tips did, up to %.3g m in one step, %.2g of what the list of contacts "
                 "looks ahead: "
                 "contacts that it only grazes come out wrong by percents",
                 scree_shown(scree_scene_body_name(scene, scene->hastiest).text).text,
                 scene->hasty * scene->contacts.chosen_skin, scene->hasty);
}

static void summarise_effort(const struct run *run, double seconds) {
    scree_effort effort = scree_scene_effort(run->scene);
    fprintf(stderr,
            "%ld adaptive steps in %.3g s, %ld more tried in vain; %ld events, %ld flights in closed form; all forces "
            "evaluated %ld times\n",
            effort.steps - run->before.steps, seconds, effort.rejected - run->before.rejected,
            effort.events - run->before.events, effort.flights - run->before.flights,
            effort.evaluations - run->before.evaluations);
}

static void summarise(const struct run *run, const char *folder, double seconds, long steps) {
    int ball, host;
    double deepest = scree_scene_deepest(run->scene, &ball, &host);
    if (run->scene->time.integrator == SCREE_ADAPTIVE)
        summarise_effort(run, seconds);
    else
        fprintf(stderr, "%ld steps of %.6g s in %.3g s (%.3g steps/s)\n", steps, scree_scene_step_length(run->scene),
                seconds, (double)steps / (seconds > 0.0 ? seconds : 1e-9));
    if (ball >= 0)
        fprintf(stderr, "deepest overlap: %.3g of the tolerable, \"%s\" with \"%s\"\n", deepest,
                scree_shown(scree_scene_body_name(run->scene, ball).text).text,
                scree_shown(scree_scene_body_name(run->scene, host).text).text);
    if (run->scene->time.sleep > 0.0)
        fprintf(stderr, "asleep: %d of %d that forces move\n", scree_scene_asleep(run->scene), run->scene->plan.free);
    fprintf(stderr, "state hash: %016llx\n", (unsigned long long)scree_scene_hash(run->scene));
    fprintf(stderr, "written to %s\n", folder);
}

/* The results that came with a state are the first half of the whole: they aren't written over. The folder is made
 * first, for a name such as new/.. leads nowhere before. */
static scree_status check_folder(struct run *run, const char *folder, const char *state) {
    scree_status status = scree_make_folder(folder, &run->trouble);
    if (status || !scree_is_in(folder, state)) return status;
    return scree_report(&run->trouble, SCREE_BAD_INPUT, NULL,
                        "%s: the results up to this state are in the same folder, and would be overwritten; name "
                        "another one with -o",
                        state);
}

static scree_status resume(struct run *run, const char *path) {
    FILE *file = fopen(path, "rb");
    if (!file) return scree_report(&run->trouble, SCREE_NO_FILE, NULL, "%s: %s", path, strerror(errno));
    scree_status status = scree_scene_restore(run->scene, file, path);
    if (status) run->trouble = *scree_scene_trouble(run->scene);
    if (!status && fgetc(file) != EOF)
        status = scree_report(&run->trouble, SCREE_BAD_INPUT, NULL, "%s: damaged: it goes on behind its end", path);
    fclose(file);
    if (status) return status;
    if (scree_scene_steps(run->scene) >= scree_steps_to(run->scene, run->request.end))
        return scree_report(
            &run->trouble, SCREE_BAD_INPUT, NULL,
            "%s: this state is at t = %.9g s, and the scene ends at %.9g s: nothing is left to simulate; "
            "set time.end to go on",
            path, scree_scene_time(run->scene), run->request.end);
    return SCREE_OK;
}

static void tell_resumed(const struct run *run, double own_step) {
    double kept = scree_scene_step_length(run->scene);
    if (kept != own_step)
        fprintf(stderr, "the step is %.9g s, as it was up to the state (alone, this scene would take %.9g s)\n", kept,
                own_step);
    if (run->scene->books_begun)
        fprintf(stderr, "the energy books begin at t = %.9g s: the state holds none\n", scree_scene_time(run->scene));
}

/* Tables that the folder holds of another run, which look as if they belonged to this one. */
static void warn_of_others(const struct run *run, const char *folder) {
    char others[96] = "";
    for (unsigned k = 0; k < SCREE_TABLES; k++) {
        if (run->request.write & scree_output_tables[k].write) continue;
        char *path = scree_join(folder, scree_output_tables[k].name);
        size_t length = strlen(others);
        if (path && access(path, F_OK) == 0)
            snprintf(others + length, sizeof others - length, "%s%s", length ? ", " : "", scree_output_tables[k].name);
        free(path);
    }
    if (others[0]) cli_complain("warning: %s also holds what this run hasn't written: %s", folder, others);
}

/* Says itself what went wrong. */
static scree_status run_loaded(struct run *run, const char *folder, const char *state) {
    double own_step = scree_scene_step_length(run->scene);
    scree_status status = state ? resume(run, state) : SCREE_OK;
    if (!status && state) status = check_folder(run, folder, state);
    if (!status) status = scree_output_open(&run->output, folder, &run->request, &run->trouble);
    if (status) {
        cli_complain("%s", run->trouble.text);
        return status;
    }
    if (state && !run->quiet) tell_resumed(run, own_step);
    struct timespec start, end;
    run->before = scree_scene_effort(run->scene);
    long before = scree_scene_steps(run->scene);
    int halved = scree_scene_halvings(run->scene);
    clock_gettime(CLOCK_MONOTONIC, &start);
    status = simulate(run);
    clock_gettime(CLOCK_MONOTONIC, &end);
    int broken_off = run->broken_off = !status && scree_scene_steps(run->scene) < last_step(run);
    if (broken_off) status = scree_output_state(&run->output, run->scene, &run->trouble);
    if (!status && !broken_off) status = scree_output_keep(&run->output, run->scene, &run->trouble);
    /* What a stopped run has written may tell why; what couldn't be written is of no use. */
    int stopped = broken_off || status == SCREE_FAILED || status == SCREE_NO_MEMORY;
    scree_output_drop(&run->output, !status && broken_off ? SCREE_LEAVE_STATE : stopped ? SCREE_LEAVE : SCREE_REMOVE);
    if (status && run->shown) fputc('\n', stderr); /* ends the line of the progress */
    if (status) cli_complain("%s", run->trouble.text);
    if (!status && broken_off)
        cli_complain("interrupted at t = %.17g s; --resume %s/final.state.part goes on from there",
                     scree_scene_time(run->scene), folder);
    if (stopped && run->request.write) cli_complain("what was written up to then is left in %s/*.part", folder);
    warn_of_chatter(run->scene);
    warn_of_coarse_step(run);
    warn_of_haste(run);
    warn_of_books(run);
    if (!status && !broken_off) warn_of_others(run, folder);
    if (!status && !broken_off && !run->quiet)
        summarise(run, folder, (double)(end.tv_sec - start.tv_sec) + 1e-9 * (double)(end.tv_nsec - start.tv_nsec),
                  scree_scene_steps(run->scene) - (before << (scree_scene_halvings(run->scene) - halved)));
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
    int thread_count = threads ? cli_whole_number(threads, "--threads", SCREE_MOST_THREADS) : 0;
    if (threads && !thread_count) return EXIT_USAGE;

    char *named = folder ? NULL : cli_default_folder(words[0], "scene", state ? "-resumed" : "");
    scree_status status =
        scree_load_scene(words[0], assignments, assignment_count, thread_count, &run.scene, &run.request, &run.trouble);
    if (!status && !folder && !named)
        status = scree_report(&run.trouble, SCREE_NO_MEMORY, NULL, "no memory for a file name");
    if (status)
        cli_complain("%s", run.trouble.text);
    else {
        heed(SIGINT);
        heed(SIGTERM);
        status = run_loaded(&run, folder ? folder : named, state);
    }
    scree_scene_destroy(run.scene);
    scree_free_request(&run.request);
    free(named);
    return !status && run.broken_off ? 128 + interrupted : cli_exit_code(status);
}
