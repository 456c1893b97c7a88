/* The process model with the contact of whole boxes between product and tines, against the one with corner spheres that
 * the article has (Troll et al. 2018). The figures are made three times: by boxes, by corner spheres, and with tines
 * that stand between the product's corners, so that only edges on edges bear. All of their tables are compared, number
 * by number. */
#include "engine/cli/figures.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Figures in which a tine meets the product, with their tables; `bounces`: slow runs in which the product flies to and
 * fro between tines for dozens of impacts. */
struct figure {
    const char *name;
    scree_status (*make)(struct figures *figures);
    const char *tables[2];
    int bounces;
};

static const struct figure all[] = {
    {"5a", figure_5a, {"fig_5a"}, 0},
    {"5b", figure_5b, {"fig_5b"}, 0},
    {"15", figure_15, {"fig_15"}, 0},
    {"12", figure_12, {"fig_12"}, 0},
    {"6a", figure_6a, {"fig_6a"}, 0},
    {"6b", figure_6b, {"fig_6b"}, 1},
    {"13", figure_13, {"fig_13"}, 0},
    {"16", figure_16, {"fig_16", "fig_16_knots"}, 0},
    {"forces", figure_forces, {"fig_forces"}, 1},
};

enum { FIGURES = sizeof all / sizeof all[0], QUICK = 3, WAYS = 3, COLUMNS = 16 };

/* ---- tables beside each other ---- */

struct column {
    double largest, apart; /* magnitudes, of the numbers and of their differences */
};

/* The next cell of a table: a number, or NAN for words. Returns 0 at its end; `*first` tells whether it begins a
 * row. */
static int next_cell(const char **at, int *first, double *value) {
    *first = 0;
    while (**at == '\n') (*at)++, *first = 1;
    if (!**at) return 0;
    char *end;
    *value = strtod(*at, &end);
    if (end == *at || (*end && !strchr(",\n", *end))) *value = NAN;
    *at += strcspn(*at, ",\n");
    if (**at == ',') (*at)++;
    return 1;
}

/* Returns the number of rows, -1 if there are more in one than in the other. */
static int compare(const char *one, const char *other, struct column columns[COLUMNS]) {
    int rows = 0, column = 0;
    for (;;) {
        int first[2];
        double value[2];
        int more = next_cell(&one, &first[0], &value[0]), as_well = next_cell(&other, &first[1], &value[1]);
        if (more != as_well || first[0] != first[1]) return -1;
        if (!more) return rows;
        column = first[0] ? 0 : column + 1;
        rows += first[0];
        if (column >= COLUMNS || (isnan(value[0]) && isnan(value[1]))) continue;
        double apart = fabs(value[0] - value[1]);
        columns[column].apart = scree_most(columns[column].apart, isnan(apart) ? HUGE_VAL : apart);
        columns[column].largest = scree_most(columns[column].largest, fabs(value[0]));
    }
}

static scree_status read_table(struct figures *figures, const char *folder, const char *table, char **text) {
    char name[64];
    size_t size;
    snprintf(name, sizeof name, "%s.csv", table);
    char *path = scree_join(folder, name);
    *text = path ? scree_read_file(path, 1 << 24, &size, &figures->trouble) : NULL;
    free(path);
    return *text ? SCREE_OK : figures->trouble.status;
}

/* The largest difference in a table, over the largest number of its column. */
static scree_status difference(struct figures *figures, char *const folders[2], const char *table, double *worst) {
    struct column columns[COLUMNS] = {{0.0, 0.0}};
    char *text[2] = {NULL, NULL};
    scree_status status = read_table(figures, folders[0], table, &text[0]);
    if (!status) status = read_table(figures, folders[1], table, &text[1]);
    if (!status && compare(text[0], text[1], columns) < 0) *worst = HUGE_VAL;
    for (int k = 0; k < COLUMNS; k++)
        if (columns[k].apart > 0.0) *worst = scree_most(*worst, columns[k].apart / columns[k].largest);
    free(text[0]);
    free(text[1]);
    return status;
}

/* ---- the figures, three times ---- */

/* Make the figures in a folder of their own; how many rows of their report miss their bounds. */
static scree_status make_all(struct figures *figures, enum process_contact contacts, int count, const char *folder,
                             int *missed) {
    struct figures own = *figures;
    struct scree_out report = {0};
    own.folder = folder;
    own.contacts = contacts;
    own.silent = 1;
    own.plots = own.rows = own.missed = 0;
    scree_status status = scree_make_folder(folder, &own.trouble);
    if (!status)
        status = figures_table(&own, "report", "figure,quantity,expected,simulated,error,bound,verdict", &report);
    own.summary = report.file;
    for (int k = 0; k < count && !status; k++) status = all[k].make(&own);
    if (!status) status = scree_out_keep(&report, &own.trouble);
    scree_out_drop(&report, 0);
    *missed = own.missed;
    figures->trouble = own.trouble;
    return status;
}

/* Corner spheres: the same contacts bear, no edge does, so there is nothing to differ but the order of sums, 1e-16 of
 * the forces, a thousandfold after some impacts. Edges: eight springs of half the stiffness at other places, whose sums
 * are rounded otherwise at every step: 1e-12 a run, and up to a thousand times that where a table has differences of
 * nearly equal numbers. Dozens of impacts make any last digit grow: by then the places differ by up to 1e-4 m of 0.02
 * m. */
static double bound_of(const struct figure *figure, int way) {
    return way == 1 ? 1e-12 : figure->bounces ? 1e-2 : 1e-8;
}

static scree_status compare_ways(struct figures *figures, int count) {
    static const char *const ways[WAYS] = {"boxes", "corners", "edges"};
    char *folders[WAYS] = {NULL};
    int missed[WAYS] = {0};
    scree_status status = SCREE_OK;
    for (int way = 0; way < WAYS && !status; way++) {
        folders[way] = scree_join(figures->folder, ways[way]);
        status = folders[way] ? make_all(figures, (enum process_contact)way, count, folders[way], &missed[way])
                              : scree_report(&figures->trouble, SCREE_NO_MEMORY, NULL, "no memory for a file name");
    }
    for (int way = 1; way < WAYS && !status; way++)
        for (int k = 0; k < count && !status; k++) {
            double worst = 0.0;
            for (int table = 0; table < 2 && all[k].tables[table] && !status; table++)
                status = difference(figures, (char *const[]){folders[way], folders[0]}, all[k].tables[table], &worst);
            char quantity[96];
            snprintf(quantity, sizeof quantity, "figure %s: boxes less %s", all[k].name,
                     way == 1 ? "corner spheres" : "edges alone");
            if (!status) figures_report(figures, "tines", quantity, 0.0, worst, bound_of(&all[k], way));
        }
    for (int way = 0; way < WAYS; way++) free(folders[way]);
    if (status) return status;
    figures_report(figures, "tines", "rows of these figures that miss, by corner spheres", 0.0, missed[1], 0.0);
    figures_report(figures, "tines", "rows of these figures that miss, by edges alone", 0.0, missed[2], 0.0);
    return SCREE_OK;
}

scree_status suite_tines(struct figures *figures) { return compare_ways(figures, QUICK); }

scree_status suite_tines_all(struct figures *figures) { return compare_ways(figures, FIGURES); }
