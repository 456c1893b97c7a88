/* scree reproduce: the verification experiments and the figures of the process model. */
#include "engine/cli/cli.h"
#include "engine/cli/figures.h"

#include <stdio.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

static const char help[] =
    "usage: scree reproduce [-o DIR] [--data DIR] [--threads N] [--list] [--verlet] [--suite NAME | FIGURE …]\n"
    "\n"
    "Simulate the verification experiments and the figures of the process model (all, or those named: see "
    "--list). For\n"
    "each: FIGURE.csv, FIGURE.svg drawn by gnuplot from FIGURE.gp, and rows of a table: quantity, expected, "
    "simulated, error\n"
    "(relative; absolute where 0 is expected), bound. The table is printed and written to DIR/report.csv, that of the\n"
    "last run. Exit status 1 if a bound is missed. Without gnuplot data and scripts are written all the same.\n"
    "\n"
    "  --suite NAME the cases of a suite that other codes are judged by, instead of the figures: mfix, chung-ooi,\n"
    "               classics, process, bulk (these three take minutes; \"all\": each of them, and the figures)\n"
    "  --verlet     the suites' scenes go by Verlet's method, but for those that ask for the adaptive one; bounds "
    "stay\n"
    "               those of pair impulses, which few spheres have by default\n"
    "  -o DIR       where to write (default: figures)\n"
    "  --data DIR   folder of the scenes (default: the one this program was built or installed with)\n"
    "  --threads N  simulations at the same time (default: the number of processors)\n"
    "\n"
    "example: scree reproduce -o /tmp/figures 11b 12 13\n";

static const struct {
    const char *suite, *name, *title; /* suite NULL: a figure of the process model */
    scree_status (*make)(struct figures *figures);
} list[] = {
    {NULL, "5a", "velocity of comb and product over the path, conventional motion", figure_5a},
    {NULL, "5b", "velocity of comb and product over the path, new motion", figure_5b},
    {NULL, "6a", "positioning error over operating speed, conventional motion", figure_6a},
    {NULL, "6b", "positioning error over operating speed, a scaled new profile", figure_6b},
    {NULL, "7", "the scene: bodies", figure_7},
    {NULL, "8", "normal force over overlap, for each normal law", figure_8},
    {NULL, "9", "friction coefficient over relative velocity, for each friction law", figure_9},
    {NULL, "10", "the scene: contacts", figure_10},
    {NULL, "11b", "inclined plane: product velocity over inclination", figure_11b},
    {NULL, "12", "impact and slide: sliding distance over collision velocity", figure_12},
    {NULL, "13", "restitution: product velocity over collision velocity", figure_13},
    {NULL, "14", "the planned velocity profile with its events", figure_14},
    {NULL, "15", "residuals of the iterative solver, simulation by simulation", figure_15},
    {NULL, "16", "characteristic map: comb velocity over time and operating speed", figure_16},
    {NULL, "forces", "force and impact speed at the front tines, conventional beside new", figure_forces},
    {NULL, "restitution_family", "restitution delivered over restitution asked, factors as published", figure_family},
    {"mfix", "dem01", "a sphere falls on a spring and dashpot", suite_dem01},
    {"mfix", "dem02", "a bouncing sphere", suite_dem02},
    {"mfix", "dem03", "two spheres pressed between walls", suite_dem03},
    {"mfix", "dem04", "a ball slips, then rolls", suite_dem04},
    {"mfix", "dem05", "oblique impacts", suite_dem05},
    {"chung-ooi", "1-2", "elastic impacts of two spheres and with a plane", suite_chung_ooi_elastic},
    {"chung-ooi", "3", "restitution got over restitution asked", suite_chung_ooi_restitution},
    {"chung-ooi", "4-5", "oblique impacts", suite_chung_ooi_oblique},
    {"chung-ooi", "6-8", "impacts with spin: on a plane, of equal and unequal spheres", suite_chung_ooi_spin},
    {"classics", "incline", "block and sphere on an inclined plane", suite_incline},
    {"classics", "slide", "a box slides to rest", suite_slide},
    {"classics", "rolling", "rolling resistance", suite_rolling},
    {"classics", "cradle", "Newton's cradle", suite_cradle},
    {"classics", "stack", "overlaps in a stack of spheres", suite_stack},
    {"classics", "chain", "solitary wave in a chain of Hertz's contacts", suite_chain},
    {"classics", "top", "a free top", suite_top},
    {"classics", "viscoelastic", "restitution of Kuwabara and Kono's law over the speed", suite_viscoelastic},
    {"classics", "edge", "a box meets a plane with an edge", suite_edge},
    {"classics", "corner", "a box meets a plane with a corner", suite_corner},
    {"classics", "rocking", "a block rocks from edge to edge", suite_rocking},
    {"classics", "domino", "a domino topples", suite_domino},
    {"classics", "dominoes", "a row of dominoes", suite_dominoes},
    {"classics", "wall", "a wall of bricks stands", suite_wall},
    {"classics", "cards", "two cards lean on each other", suite_cards},
    {"classics", "painleve", "Painleve's rod jams", suite_painleve},
    {"classics", "stick-slip", "a mass on a belt sticks and slips", suite_stick_slip},
    {"classics", "haff", "a granular gas cools down", suite_haff},
    {"process", "tines", "the process model by corner spheres, by boxes and by edges alone", suite_tines},
    {"process", "tines-all", "the same, all of its figures", suite_tines_all},
    {"bulk", "silo", "a silo empties through a hole", suite_silo},
    {"bulk", "column", "load of a column between walls", suite_column},
    {"bulk", "heap", "angle of repose", suite_heap},
    {"bulk", "drum", "a drum turns", suite_drum},
    {"bulk", "crater", "a ball falls on a bed", suite_crater},
};

enum { FIGURES = sizeof list / sizeof list[0] };

/* The folder with the scenes: an installed program has its own, another one that beside the sources, if they are
 * there. */
static const char *find_data(void) {
    char own[sizeof SCREE_INSTALLED + 1] = "";
    ssize_t length = readlink("/proc/self/exe", own, sizeof own - 1);
    int installed = length > 0 && strcmp(own, SCREE_INSTALLED) == 0;
    return !installed && access(SCREE_SOURCE_DATA "/scenes/incline.toml", R_OK) == 0 ? SCREE_SOURCE_DATA "/scenes"
                                                                                     : SCREE_INSTALLED_DATA "/scenes";
}

static int find_figure(const char *name) {
    for (int k = 0; k < FIGURES; k++)
        if (strcmp(list[k].name, name) == 0) return k;
    return -1;
}

static int is_suite(const char *name) {
    for (int k = 0; k < FIGURES; k++)
        if (list[k].suite && strcmp(list[k].suite, name) == 0) return 1;
    return 0;
}

/* Those of a suite (NULL: the figures of the process model, "all": everything), or those named. */
static int select_figures(int count, char **words, const char *suite, int wanted[FIGURES]) {
    const char *suites[FIGURES + 2] = {"all"}, *names[FIGURES + 1] = {NULL};
    int known = suite == NULL || strcmp(suite, "all") == 0;
    for (int k = 0, n = 1; k < FIGURES; k++) {
        int of_suite = suite && list[k].suite && strcmp(suite, list[k].suite) == 0;
        known |= of_suite;
        names[k] = list[k].name;
        wanted[k] = count == 0 && (suite == NULL ? list[k].suite == NULL : of_suite || strcmp(suite, "all") == 0);
        if (list[k].suite && strcmp(list[k].suite, suites[n - 1]) != 0) suites[n++] = list[k].suite;
    }
    if (!known)
        return cli_complain("there is no suite \"%s\"%s; scree reproduce --list names them", suite,
                            scree_hint(suite, suites).text);
    if (suite && count) return cli_complain("either --suite or names of figures or cases");
    for (int n = 0; n < count; n++) {
        int k = find_figure(words[n]);
        if (k < 0 && is_suite(words[n])) return cli_complain("\"%s\" is a suite: --suite %s", words[n], words[n]);
        if (k < 0)
            return cli_complain("there is no figure \"%s\"%s; scree reproduce --list names them", words[n],
                                scree_hint(words[n], names).text);
        wanted[k] = 1;
    }
    return EXIT_GOOD;
}

static void print_list(const int wanted[FIGURES], int all) {
    for (int k = 0; k < FIGURES; k++)
        if (all || wanted[k])
            printf("%-10s %-18s %s\n", list[k].suite ? list[k].suite : "", list[k].name, list[k].title);
}

static scree_status make_figures(struct figures *figures, const int wanted[FIGURES]) {
    struct scree_out summary = {0};
    scree_status status = scree_make_folder(figures->folder, &figures->trouble);
    if (!status)
        status = figures_table(figures, "report", "figure,quantity,expected,simulated,error,bound,verdict", &summary);
    if (status) return status;
    figures->summary = summary.file;
    printf("%-4s %-58s %14s %14s %9s %9s\n", "fig", "quantity", "expected", "simulated", "error", "bound");
    for (int k = 0; k < FIGURES && !status; k++)
        if (wanted[k]) status = list[k].make(figures);
    if (status) {
        scree_out_drop(&summary, 0);
        return status;
    }
    return scree_out_keep(&summary, &figures->trouble);
}

int cli_reproduce(int count, char **words) {
    const char *folder = "figures", *data = NULL, *threads = NULL, *suite = NULL;
    int only_list = 0, verlet = 0, wanted[FIGURES];
    const struct cli_option options[] = {{.name = "-o", .value = &folder},
                                         {.name = "--data", .value = &data},
                                         {.name = "--suite", .value = &suite},
                                         {.name = "--threads", .value = &threads},
                                         {.name = "--list", .flag = &only_list},
                                         {.name = "--verlet", .flag = &verlet},
                                         {0}};
    int code = cli_parse(&count, words, options, help);
    if (code) return code < 0 ? EXIT_GOOD : code;
    code = select_figures(count, words, suite, wanted);
    if (code) return code;
    if (only_list) {
        print_list(wanted, suite == NULL && count == 0);
        return EXIT_GOOD;
    }

    int thread_count = cli_threads(threads);
    if (!thread_count) return EXIT_USAGE;
    struct figures figures = {
        .folder = folder, .data = data ? data : find_data(), .plots = 1, .threads = thread_count, .verlet = verlet};
    struct timespec begin, end;
    clock_gettime(CLOCK_MONOTONIC, &begin);
    scree_status status = make_figures(&figures, wanted);
    clock_gettime(CLOCK_MONOTONIC, &end);
    if (status) {
        cli_complain("%s", figures.trouble.text);
        return cli_exit_code(status);
    }
    double seconds = (double)(end.tv_sec - begin.tv_sec) + 1e-9 * (double)(end.tv_nsec - begin.tv_nsec);
    printf("%d of %d bounds met, in %.1f s; written to %s\n", figures.rows - figures.missed, figures.rows, seconds,
           folder);
    return figures_unplotted(&figures) || figures.missed ? EXIT_MISSED : EXIT_GOOD;
}
