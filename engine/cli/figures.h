/* What the figures of `scree reproduce` share: scenes with changes, tables, plots, and the report of expected against
 * simulated values. */
#ifndef SCREE_CLI_FIGURES_H
#define SCREE_CLI_FIGURES_H

#include "bodies/elementary.h"
#include "engine/cli/process.h"
#include "engine/file.h"

struct figures {
    const char *folder; /* where everything is written */
    const char *data;   /* folder of the scenes */
    int plots;          /* gnuplot can be run; cleared when it turns out that it can't */
    int threads;
    enum process_contact contacts; /* of product and tines */
    int verlet; /* scenes of the suites go by Verlet's method, but for those that ask for the adaptive one */
    int silent; /* rows of the report go into the table only */
    int rows, missed;
    int unplotted; /* plots that gnuplot failed on */
    FILE *summary; /* table of the report, CSV */
    scree_trouble trouble;
};

/* The task of the worked example: 80 mm with 20 mm of play, half of the cycle, quarter shares. */
extern const scree_transport figures_task;

/* The process model of that task; to be freed with process_free, whether or not this fails. */
scree_status figures_process(struct figures *figures, struct process *process);

/* Each makes one figure: data, plot, rows of the report. */
scree_status figure_5a(struct figures *figures);
scree_status figure_5b(struct figures *figures);
scree_status figure_6a(struct figures *figures);
scree_status figure_6b(struct figures *figures);
scree_status figure_7(struct figures *figures);
scree_status figure_8(struct figures *figures);
scree_status figure_9(struct figures *figures);
scree_status figure_10(struct figures *figures);
scree_status figure_11b(struct figures *figures);
scree_status figure_12(struct figures *figures);
scree_status figure_13(struct figures *figures);
scree_status figure_14(struct figures *figures);
scree_status figure_15(struct figures *figures);
scree_status figure_16(struct figures *figures);
scree_status figure_forces(struct figures *figures);
scree_status figure_family(struct figures *figures);

/* Cases of the suites that other codes are judged by. */
scree_status suite_dem01(struct figures *figures);
scree_status suite_dem02(struct figures *figures);
scree_status suite_dem03(struct figures *figures);
scree_status suite_dem04(struct figures *figures);
scree_status suite_dem05(struct figures *figures);
scree_status suite_chung_ooi_elastic(struct figures *figures);
scree_status suite_chung_ooi_restitution(struct figures *figures);
scree_status suite_chung_ooi_oblique(struct figures *figures);
scree_status suite_chung_ooi_spin(struct figures *figures);
scree_status suite_incline(struct figures *figures);
scree_status suite_slide(struct figures *figures);
scree_status suite_rolling(struct figures *figures);
scree_status suite_cradle(struct figures *figures);
scree_status suite_stack(struct figures *figures);
scree_status suite_chain(struct figures *figures);
scree_status suite_top(struct figures *figures);
scree_status suite_viscoelastic(struct figures *figures);
scree_status suite_edge(struct figures *figures);
scree_status suite_corner(struct figures *figures);
scree_status suite_rocking(struct figures *figures);
scree_status suite_domino(struct figures *figures);
scree_status suite_dominoes(struct figures *figures);
scree_status suite_wall(struct figures *figures);
scree_status suite_cards(struct figures *figures);
scree_status suite_painleve(struct figures *figures);
scree_status suite_stick_slip(struct figures *figures);
scree_status suite_haff(struct figures *figures);
scree_status suite_tines(struct figures *figures);
scree_status suite_tines_all(struct figures *figures);
scree_status suite_silo(struct figures *figures);
scree_status suite_column(struct figures *figures);
scree_status suite_heap(struct figures *figures);
scree_status suite_drum(struct figures *figures);
scree_status suite_crater(struct figures *figures);

/* A row of the report. The error is relative to `expected`, or absolute where that is 0; it passes if it is at most
 * `bound`. */
void figures_report(struct figures *figures, const char *figure, const char *quantity, double expected,
                    double simulated, double bound);

/* A scene file from the data folder, changed by `count` assignments and baked; NULL after filling the trouble record.
 * May be called from several threads, each with a trouble record of its own. */
scree_scene *figures_scene(const struct figures *figures, const char *file, const char *const *assignments, int count,
                           scree_trouble *trouble);

/* The same from the text of a scene file. */
scree_scene *figures_scene_text(struct figures *figures, const char *text);

/* Do jobs 0 to count - 1, several at a time. Of those that fail the first, by its number, is the failure of all. */
typedef scree_status figures_job(const struct figures *figures, void *jobs, int k, scree_trouble *trouble);
scree_status figures_do(struct figures *figures, figures_job *job, void *jobs, int count);

/* Step; the reason of a failure goes into the trouble record. */
scree_status figures_step(struct figures *figures, scree_scene *scene, long steps);

/* How many contacts of the product are with bodies from index `first` on (the tines come last in the scenes). */
scree_status figures_contacts_from(scree_scene *scene, int first, int *count);

/* Open NAME.csv. */
scree_status figures_open(struct figures *figures, const char *name, struct scree_out *out);

/* Open NAME.csv with a header line. */
scree_status figures_table(struct figures *figures, const char *name, const char *header, struct scree_out *out);

/* Tables that belong together: all are whole before the first takes its name. */
struct figures_tables {
    struct scree_out *out; /* room for all, zeroed; to be freed by who made it */
    int count;
};

/* The next of them, with a header line unless that is NULL; NULL after filling the trouble record. Then its end. */
FILE *figures_begin(struct figures *figures, const char *name, const char *header, struct figures_tables *tables);
scree_status figures_end(struct figures *figures, struct figures_tables *tables);

/* Give them their names, unless `status` says that some failed: then none is left. */
scree_status figures_keep(struct figures *figures, struct figures_tables *tables, scree_status status);

/* Write NAME.gp (a fixed head, then `script`) and let gnuplot draw NAME.svg by it. The script stays beside the data. */
scree_status figures_plot(struct figures *figures, const char *name, const char *script);

/* How many plots gnuplot failed on; if any, it complains. */
int figures_unplotted(const struct figures *figures);

#endif
