/* A transport file: the task that `scree plan` works on (TOML). README.md, section "Planning", is the user's page. */
#ifndef SCREE_CLI_TRANSPORT_FILE_H
#define SCREE_CLI_TRANSPORT_FILE_H

#include "engine/cli/process.h"
#include "solver/map.h"

struct transport_file {
    char *title; /* owned; "" if none */
    scree_transport task;
    int modelled; /* there is a process model */
    struct process process;
    enum scree_formulation formulation;
    double clearance;              /* wanted at the catch, m */
    int optimised;                 /* the times are to be chosen */
    enum scree_shares_rule shares; /* by this rule */
    int speeds;
    double *speed; /* to plan for, 1/min; owned */

    int mapped;
    scree_map_options map; /* low, high, bound */
    enum scree_map_weight weight;

    int curves; /* number of speeds, 0: no curves */
    double from, to, design, tolerance;

    double rate;  /* rows a second of servo tables, 0: none */
    int angle;    /* machine angle instead of time */
    int from_map; /* what the map gives at the speeds, not what is planned for them */
    double lift;  /* of the return stroke, m; 0: the forward stroke alone */
};

/* Read a file, changed by `assignments` (see scree_toml_set); "-" is standard input. Free the result in any case. */
scree_status transport_file_read(const char *path, const char *const *assignments, int count,
                                 struct transport_file *transport, scree_trouble *trouble);
void transport_file_free(struct transport_file *transport);

#endif
