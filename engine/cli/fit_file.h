/* A fit file: the task that `scree fit` works on (TOML): records of measurements, the scenes that simulate them, and
 * the parameters that are looked for. README.md, section "Fitting parameters to measurements", is the user's page. */
#ifndef SCREE_CLI_FIT_FILE_H
#define SCREE_CLI_FIT_FILE_H

#include "bodies/trouble.h"

#include <stddef.h>

/* What of a body can be fitted: columns of bodies.csv. */
enum fit_quantity { FIT_X, FIT_Y, FIT_Z, FIT_VX, FIT_VY, FIT_VZ, FIT_WX, FIT_WY, FIT_WZ, FIT_QUANTITIES };
extern const char *const fit_quantity_name[FIT_QUANTITIES + 1]; /* "x_m", …; ended by NULL */

struct fit_parameter {
    char *name; /* owned */
    double start, low, high;
    double difference; /* over which derivatives are taken; 0: a share of the value */
};

/* One record, and the scene that is to follow it. All is owned. */
struct fit_experiment {
    char place[128];    /* of its table, "fit.toml:12:1", for messages */
    char *scene, *text; /* the scene file's path and content */
    size_t size;
    int changes;
    char **change; /* assignments to the scene; {name} stands for a parameter's value */
    char *body;
    char *record; /* the record's path */
    int columns;
    int quantity[FIT_QUANTITIES];     /* enum fit_quantity */
    double deviation[FIT_QUANTITIES]; /* of one reading; 1 where none was given */
    size_t rows;
    double *time; /* s, of the record's clock; rising */
    double *reading[FIT_QUANTITIES];
    double delay;        /* s by which that clock is ahead of the scene's, */
    int delay_parameter; /* or the parameter that says it; -1: none */
};

struct fit_file {
    char *title; /* owned; "" if none */
    double confidence;
    int weighted; /* deviations were given */
    int parameters;
    struct fit_parameter *parameter; /* owned */
    int experiments;
    struct fit_experiment *experiment; /* owned */
    size_t readings;                   /* of all experiments */
};

/* Read a file, changed by `assignments` (see scree_toml_set); "-" is standard input. Free the result in any case. */
scree_status fit_file_read(const char *path, const char *const *assignments, int count, struct fit_file *file,
                           scree_trouble *trouble);
void fit_file_free(struct fit_file *file);

/* The place of the next "{word}" at or behind `text`, where `length` receives that of the word; NULL: there is none. An
 * inline table has a "=" where the word ends, and is none. */
const char *fit_next_place(const char *text, size_t *length);

/* Which parameter is called so; -1: none. */
int fit_find_parameter(const struct fit_file *file, const char *name, size_t length);

/* Whether an experiment depends on a parameter. */
int fit_uses(const struct fit_file *file, int experiment, int parameter);

#endif
