/* What the figures of `scree reproduce` share. */
#include "engine/cli/figures.h"

#include "engine/cli/cli.h"
#include "engine/scene.h"
#include "engine/scene_file.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

const scree_transport figures_task = {.distance = 0.08,
                                      .gap = 0.05,
                                      .width = 0.03,
                                      .friction = 0.3,
                                      .gravity = 9.81,
                                      .share = 0.5,
                                      .fractions = {0.25, 0.5, 0.75}};

scree_status figures_process(struct figures *figures, struct process *process) {
    *process = (struct process){0};
    char *path = scree_join(figures->data, "transport.toml");
    if (!path) return scree_report(&figures->trouble, SCREE_NO_MEMORY, NULL, "no memory for a file name");
    scree_status status = process_load(process, path, &figures_task, &figures->trouble);
    process->contacts = figures->contacts;
    free(path);
    return status;
}

void figures_report(struct figures *figures, const char *figure, const char *quantity, double expected,
                    double simulated, double bound) {
    double error = fabs(simulated - expected) / (expected != 0.0 ? fabs(expected) : 1.0);
    int pass = error <= bound;
    figures->rows++;
    figures->missed += !pass;
    if (!figures->silent)
        printf("%-4s %-58s %14.9g %14.9g %9.2e %9.2e  %s\n", figure, quantity, expected, simulated, error, bound,
               pass ? "pass" : "MISS");
    fprintf(figures->summary, "%s,\"%s\",%.17g,%.17g,%.17g,%.17g,%s\n", figure, quantity, expected, simulated, error,
            bound, pass ? "pass" : "miss");
}

/* Tines of the scenes, and where they stand, m. */
static const struct {
    const char *file, *name;
    double x, y;
} tines[] = {
    {"transport.toml", "left rear tine", -0.015, 0.012},   {"transport.toml", "right rear tine", -0.015, -0.012},
    {"transport.toml", "left front tine", 0.065, 0.012},   {"transport.toml", "right front tine", 0.065, -0.012},
    {"restitution.toml", "left tine", -0.015, 0.012},      {"restitution.toml", "right tine", -0.015, -0.012},
    {"impact_and_slide.toml", "left tine", -0.016, 0.012}, {"impact_and_slide.toml", "right tine", -0.016, -0.012}};

enum { TINES = sizeof tines / sizeof tines[0], CHANGES = 32, LONGEST_CHANGE = 160 };

/* Add what lets the product meet the tines of `file` as the figures want it; as process.c does. */
static int change_contacts(enum process_contact contacts, const char *file, const char *list[CHANGES], int count,
                           char text[CHANGES][LONGEST_CHANGE]) {
    if (contacts == PROCESS_BOXES || strcmp(file, "incline.toml") == 0) return count;
    list[count++] = contacts == PROCESS_CORNERS ? "contact.1.corners=true" : "contact.1.shared_by=8";
    for (int k = 0; contacts == PROCESS_EDGES && k < TINES; k++) {
        if (strcmp(tines[k].file, file) != 0) continue;
        snprintf(text[count], LONGEST_CHANGE, "body.\"%s\".shape={box=[0.03,0.01,0.025]}", tines[k].name);
        list[count] = text[count];
        count++;
        snprintf(text[count], LONGEST_CHANGE, "body.\"%s\".position=[%g,%g,0.0075]", tines[k].name, tines[k].x,
                 tines[k].y);
        list[count] = text[count];
        count++;
    }
    return count;
}

scree_scene *figures_scene(const struct figures *figures, const char *file, const char *const *assignments, int count,
                           scree_trouble *trouble) {
    struct scree_run_request request = {0};
    scree_scene *scene = NULL;
    const char *changes[CHANGES];
    char text[CHANGES][LONGEST_CHANGE];
    for (int k = 0; k < count; k++) changes[k] = assignments[k];
    count = change_contacts(figures->contacts, file, changes, count, text);
    char *path = scree_join(figures->data, file);
    if (path)
        scree_load_scene(path, changes, count, 1, &scene, &request, trouble);
    else
        scree_report(trouble, SCREE_NO_MEMORY, NULL, "no memory for a file name");
    scree_free_request(&request);
    free(path);
    return scene;
}

scree_scene *figures_scene_text(struct figures *figures, const char *text) {
    struct scree_run_request request = {0};
    scree_scene *scene = NULL;
    const char *verlet = "time.integrator=\"verlet\"";
    int change = figures->verlet && !strstr(text, "\"adaptive\"");
    scree_read_scene(text, strlen(text), "suite", &verlet, change, 1, &scene, &request, &figures->trouble);
    scree_free_request(&request);
    return scene;
}

scree_status figures_do(struct figures *figures, figures_job *job, void *jobs, int count) {
    int first = count;
    scree_status status = SCREE_OK;
#pragma omp parallel for schedule(dynamic) num_threads(figures->threads)
    for (int k = 0; k < count; k++) {
        scree_trouble trouble = {0};
        scree_status own = job(figures, jobs, k, &trouble);
#pragma omp critical
        if (own && k < first) {
            first = k;
            status = own;
            figures->trouble = trouble;
        }
    }
    return status;
}

scree_status figures_step(struct figures *figures, scree_scene *scene, long steps) {
    scree_status status = scree_scene_step(scene, steps);
    if (status) figures->trouble = *scree_scene_trouble(scene);
    return status;
}

scree_status figures_contacts_from(scree_scene *scene, int first, int *count) {
    enum { MOST_CONTACTS = 32 };
    scree_contact_state contact[MOST_CONTACTS];
    int all = 0;
    scree_status status = scree_scene_contacts(scene, contact, MOST_CONTACTS, &all);
    if (!status && all > MOST_CONTACTS)
        status = scree_scene_stop(scene, scree_scene_time(scene), -1, -1, "more contacts than the figure has");
    *count = 0;
    for (int k = 0; !status && k < all; k++) *count += contact[k].host >= first;
    return status;
}

static char *file_name(const struct figures *figures, const char *name, const char *ending) {
    size_t size = strlen(figures->folder) + strlen(name) + strlen(ending) + 2;
    char *path = malloc(size);
    if (path) snprintf(path, size, "%s/%s%s", figures->folder, name, ending);
    return path;
}

scree_status figures_open(struct figures *figures, const char *name, struct scree_out *out) {
    char *path = file_name(figures, name, ".csv");
    if (!path) return scree_report(&figures->trouble, SCREE_NO_MEMORY, NULL, "no memory for a file name");
    scree_status status = scree_out_open(out, path, &figures->trouble);
    free(path);
    return status;
}

scree_status figures_table(struct figures *figures, const char *name, const char *header, struct scree_out *out) {
    scree_status status = figures_open(figures, name, out);
    if (!status) fprintf(out->file, "%s\n", header);
    return status;
}

FILE *figures_begin(struct figures *figures, const char *name, const char *header, struct figures_tables *tables) {
    struct scree_out *out = &tables->out[tables->count];
    if (figures_open(figures, name, out)) return NULL;
    tables->count++;
    if (header) fprintf(out->file, "%s\n", header);
    return out->file;
}

scree_status figures_end(struct figures *figures, struct figures_tables *tables) {
    return scree_out_finish(&tables->out[tables->count - 1], &figures->trouble);
}

scree_status figures_keep(struct figures *figures, struct figures_tables *tables, scree_status status) {
    for (int k = 0; k < tables->count && !status; k++) status = scree_out_keep(&tables->out[k], &figures->trouble);
    for (int k = 0; k < tables->count; k++) scree_out_drop(&tables->out[k], 0);
    return status;
}

/* Run gnuplot in the folder; the exit status, 127 if it can't be started. */
static int run_gnuplot(const char *folder, const char *script) {
    fflush(NULL);
    pid_t child = fork();
    if (child < 0) return 127;
    if (child == 0) {
        if (chdir(folder) == 0) execlp("gnuplot", "gnuplot", script, (char *)NULL);
        _exit(127);
    }
    int status = 0;
    while (waitpid(child, &status, 0) < 0 && errno == EINTR) continue;
    return WIFEXITED(status) ? WEXITSTATUS(status) : 1;
}

/* gnuplot doesn't mind a full disk. */
static int is_whole_plot(const char *path) {
    char end[32] = "";
    FILE *file = fopen(path, "rb");
    size_t length = file && fseek(file, 1 - (long)sizeof end, SEEK_END) == 0 ? fread(end, 1, sizeof end - 1, file) : 0;
    if (file) fclose(file);
    end[length] = '\0';
    return strstr(end, "</svg>") != NULL;
}

scree_status figures_plot(struct figures *figures, const char *name, const char *script) {
    char *path = file_name(figures, name, ".gp");
    struct scree_out out = {0};
    scree_status status = path ? scree_out_open(&out, path, &figures->trouble)
                               : scree_report(&figures->trouble, SCREE_NO_MEMORY, NULL, "no memory for a file name");
    if (!status) {
        fprintf(out.file,
                "# Draws %s.svg from %s.csv: run gnuplot on this file in its folder.\n"
                "set terminal svg size 760,520 enhanced font 'Helvetica,14' background rgb 'white'\n"
                "set output '%s.svg'\n"
                "set datafile separator ','\n"
                "set datafile columnheaders\n"
                "set grid lc rgb '#dddddd'\n"
                "set key box lc rgb '#bbbbbb' opaque\n"
                "# Told apart in grey too: by dash and point as well as by colour.\n"
                "set style line 1 lc rgb '#000000' lw 2 dt 1 pt 6\n"
                "set style line 2 lc rgb '#c03020' lw 2 dt 2 pt 2\n"
                "set style line 3 lc rgb '#2060a0' lw 2 dt 4 pt 4\n"
                "set style line 4 lc rgb '#208040' lw 2 dt 3 pt 8\n"
                "set style line 5 lc rgb '#a06000' lw 2 dt 5 pt 10\n"
                "set style line 6 lc rgb '#704090' lw 2 dt 6 pt 12\n"
                "set style line 7 lc rgb '#707070' lw 2 dt 7 pt 1\n"
                "%s",
                name, name, name, script);
        status = scree_out_keep(&out, &figures->trouble);
    }
    /* The plot of other data isn't left beside these. */
    char *plot = status ? NULL : file_name(figures, name, ".svg");
    if (plot) remove(plot);
    if (!status && figures->plots) {
        const char *base = strrchr(path, '/') + 1;
        int code = run_gnuplot(figures->folder, base);
        if (!code && plot && !is_whole_plot(plot)) code = 1;
        if (code && plot) remove(plot); /* half of one */
        if (code == 127) {
            figures->plots = 0;
            printf("gnuplot can't be started: the data (.csv) and the plot scripts (.gp) are there, the "
                   "plots aren't\n");
        } else if (code) {
            figures->unplotted++;
            printf("gnuplot failed on %s\n", path);
        }
    }
    free(plot);
    free(path);
    return status;
}

int figures_unplotted(const struct figures *figures) {
    if (figures->unplotted)
        cli_complain("gnuplot failed on %d of the plots: their data and scripts are there", figures->unplotted);
    return figures->unplotted;
}
