/* A transport file: the task that `scree plan` works on. */
#include "engine/cli/transport_file.h"

#include "engine/reader.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_SPEEDS = 10000 };

static double read_positive(struct scree_reader *r, const struct scree_toml *table, const char *key, double fallback) {
    double value = scree_read_number(r, table, key, fallback);
    const struct scree_toml *node = scree_toml_get(table, key);
    if (node && !(value > 0.0)) scree_complain(r, node, "%s must be positive, got %g", key, value);
    return value;
}

static double read_needed(struct scree_reader *r, const struct scree_toml *table, const char *key, const char *what) {
    if (!scree_toml_get(table, key)) scree_complain(r, table, "[transport] needs %s (%s)", key, what);
    return read_positive(r, table, key, 0.0);
}

static int read_count(struct scree_reader *r, const struct scree_toml *table, const char *key, int fallback) {
    double count = scree_read_number(r, table, key, fallback);
    if (count >= 2.0 && count <= MOST_SPEEDS && count == floor(count)) return (int)count;
    scree_complain(r, scree_toml_get(table, key), "%s must be a whole number from 2 to %d", key, MOST_SPEEDS);
    return 2;
}

/* from < to, both positive. */
static void read_range(struct scree_reader *r, const struct scree_toml *table, double *from, double *to) {
    *from = read_positive(r, table, "from", 0.0);
    *to = read_positive(r, table, "to", 0.0);
    if (!(*from > 0.0 && *from < *to))
        scree_complain(r, table, "a range of speeds needs from and to (cycles a minute), from < to; got %g and %g",
                       *from, *to);
}

/* ---- tables of the file ---- */

static void read_task(struct scree_reader *r, struct transport_file *f) {
    static const char *const keys[] = {"distance", "gap",   "width",    "friction", "gravity",
                                       "share",    "times", "optimise", NULL};
    static const char *const rules[] = {"acceleration", "jerk", "catch", NULL};
    const struct scree_toml *table = scree_read_table(r, r->root, "transport");
    if (!table) {
        scree_complain(r, NULL, "a transport file needs [transport] with distance, gap, width and friction");
        return;
    }
    scree_check_keys(r, table, "[transport]", keys);
    f->task = (scree_transport){.distance = read_needed(r, table, "distance", "m, of the product"),
                                .gap = read_needed(r, table, "gap", "m, between rear and front tines"),
                                .width = read_needed(r, table, "width", "m, of the product along the way"),
                                .friction = read_needed(r, table, "friction", "kinetic coefficient on the surface"),
                                .gravity = read_positive(r, table, "gravity", 9.81),
                                .share = read_positive(r, table, "share", 0.5),
                                .fractions = {0.25, 0.5, 0.75}};
    scree_read_numbers(r, table, "times", 3, f->task.fractions);
    const struct scree_toml *optimise = scree_toml_get(table, "optimise");
    f->optimised = optimise != NULL;
    if (optimise) f->shares = (enum scree_shares_rule)scree_choose(r, optimise, "optimise", rules);
    scree_plan plan;
    scree_plan_make(&f->task, 100.0, NULL, &plan); /* any speed: does the task make sense? */
    if (plan.state == SCREE_PLAN_BAD_TASK) scree_complain(r, table, "%s", plan.text);
    const struct scree_toml *drive = scree_read_table(r, r->root, "drive");
    if (!drive) return;
    static const char *const limits[] = {"acceleration", "jerk", NULL};
    scree_check_keys(r, drive, "[drive]", limits);
    f->task.largest_acceleration = read_positive(r, drive, "acceleration", 0.0);
    f->task.largest_jerk = read_positive(r, drive, "jerk", 0.0);
}

static void load_model(struct scree_reader *r, const struct scree_toml *node, struct transport_file *f) {
    char *path = scree_read_path_beside(r, node);
    if (path && process_load(&f->process, path, &f->task, r->trouble)) scree_tell_place(r, node);
    free(path);
}

static void read_model(struct scree_reader *r, struct transport_file *f) {
    static const char *const keys[] = {"scene",
                                       "mass",
                                       "depth",
                                       "height",
                                       "start",
                                       "static",
                                       "threshold",
                                       "tine_stiffness",
                                       "step",
                                       "tine_restitution",
                                       "surface_stiffness",
                                       NULL};
    const struct scree_toml *table = scree_read_table(r, r->root, "model");
    if (!table) return;
    scree_check_keys(r, table, "[model]", keys);
    const struct scree_toml *scene = scree_toml_get(table, "scene");
    if (!scree_read_string(r, table, "scene"))
        scree_complain(r, table, "[model] needs scene = \"…\", the scene file of the process model");
    if (r->status) return;
    load_model(r, scene, f);
    if (r->status) return;
    struct process *p = &f->process;
    f->modelled = 1;
    p->mass = read_positive(r, table, "mass", p->mass);
    p->depth = read_positive(r, table, "depth", p->depth);
    p->height = read_positive(r, table, "height", p->height);
    p->start = scree_read_number(r, table, "start", p->start);
    p->static_friction = read_positive(r, table, "static", fmax(p->static_friction, p->kinetic_friction));
    p->threshold = read_positive(r, table, "threshold", p->threshold);
    p->tine_stiffness = read_positive(r, table, "tine_stiffness", p->tine_stiffness);
    p->tine_restitution = read_positive(r, table, "tine_restitution", p->tine_restitution);
    p->surface_stiffness = read_positive(r, table, "surface_stiffness", p->surface_stiffness);
    p->step = read_positive(r, table, "step", p->step);
    if (p->static_friction < p->kinetic_friction)
        scree_complain(r, scree_toml_get(table, "static"),
                       "static friction (%g) must not be below kinetic friction (%g)", p->static_friction,
                       p->kinetic_friction);
    if (!(p->start >= 0.0 && p->start < scree_transport_play(&f->task)))
        scree_complain(r, scree_toml_get(table, "start"), "start must be from 0 to below the play of %g m, got %g",
                       scree_transport_play(&f->task), p->start);
    scree_trouble cause = {0};
    if (!r->status && process_check(p, &cause))
        scree_complain(r, table, "the process model, whose step is `step` here, can't run: %s", cause.text);
}

/* speeds = [300, 500] or { from, to, count } */
static void read_speeds(struct scree_reader *r, const struct scree_toml *table, struct transport_file *f) {
    const struct scree_toml *node = scree_toml_get(table, "speeds");
    if (!node || (node->type != SCREE_TOML_ARRAY && node->type != SCREE_TOML_TABLE) ||
        (node->type == SCREE_TOML_ARRAY && (node->count < 1 || node->count > MOST_SPEEDS))) {
        scree_complain(
            r, node ? node : table,
            "[plan] needs speeds = [500, …] or speeds = { from = 300, to = 700, count = 41 } in cycles a minute");
        return;
    }
    double from = 0.0, to = 0.0;
    int range = node->type == SCREE_TOML_TABLE;
    if (range) {
        static const char *const keys[] = {"from", "to", "count", NULL};
        scree_check_keys(r, node, "speeds", keys);
        read_range(r, node, &from, &to);
    }
    int count = range ? read_count(r, node, "count", 41) : node->count;
    if (r->status) return;
    f->speed = malloc((size_t)count * sizeof *f->speed);
    if (!f->speed) {
        r->status = scree_report(r->trouble, SCREE_NO_MEMORY, NULL, "no memory for %d speeds", count);
        return;
    }
    f->speeds = count;
    const struct scree_toml *entry = node->first;
    for (int k = 0; k < count; k++) {
        f->speed[k] = range ? from + (to - from) * k / (count - 1) : scree_number_of(r, entry, "an operating speed");
        if (!(f->speed[k] > 0.0)) scree_complain(r, entry, "an operating speed must be positive, got %g", f->speed[k]);
        if (!range) entry = entry->next;
    }
}

static void read_plan(struct scree_reader *r, struct transport_file *f) {
    static const char *const keys[] = {"speeds", "formulation", "clearance", NULL};
    static const char *const formulations[] = {"A", "B", "C", NULL};
    const struct scree_toml *table = scree_read_table(r, r->root, "plan");
    if (!table) {
        scree_complain(r, NULL, "a transport file needs [plan] with speeds");
        return;
    }
    scree_check_keys(r, table, "[plan]", keys);
    read_speeds(r, table, f);
    f->clearance = read_positive(r, table, "clearance", 1e-6);
    f->formulation = f->modelled ? SCREE_PLAN_C : SCREE_PLAN_B;
    const struct scree_toml *formulation = scree_toml_get(table, "formulation");
    if (formulation) f->formulation = (enum scree_formulation)scree_choose(r, formulation, "formulation", formulations);
    if (f->formulation == SCREE_PLAN_C && !f->modelled) scree_complain(r, formulation, "formulation C needs a [model]");
    if (f->optimised && f->shares == SCREE_LEAST_CATCH && !f->modelled)
        scree_complain(r, scree_toml_nearest(r->root, "transport.optimise"), "optimise = \"catch\" needs a [model]");
}

/* How long friction takes to stop the product, a rigid plan's velocities tell beforehand. */
static void check_lengths(struct scree_reader *r, const struct transport_file *f) {
    for (int k = 0; k < f->speeds; k++) {
        double v[3] = {0.0};
        scree_trouble cause = {0};
        scree_plan_rigid(&f->task, f->speed[k], v);
        if (process_check_length(&f->process, scree_transport_time(&f->task, f->speed[k]), fabs(v[0]), &cause))
            scree_complain(
                r, scree_toml_nearest(r->root, "transport.gravity"),
                "at %g cycles/min %s; expected more friction or gravity, a smaller `threshold` or a larger `step`",
                f->speed[k], cause.text);
    }
}

static void read_map(struct scree_reader *r, struct transport_file *f) {
    static const char *const keys[] = {"from", "to", "bound", "weight", NULL};
    const struct scree_toml *table = scree_read_table(r, r->root, "map");
    if (!table) return;
    scree_check_keys(r, table, "[map]", keys);
    f->mapped = 1;
    read_range(r, table, &f->map.low, &f->map.high);
    f->map.bound = read_positive(r, table, "bound", 1e-5);
    const char *names[SCREE_MAP_WEIGHTS + 1] = {0};
    for (int k = 0; k < SCREE_MAP_WEIGHTS; k++) names[k] = scree_map_names[k];
    const struct scree_toml *weight = scree_toml_get(table, "weight");
    if (weight) f->weight = (enum scree_map_weight)scree_choose(r, weight, "weight", names);
}

static void read_curves(struct scree_reader *r, struct transport_file *f) {
    static const char *const keys[] = {"from", "to", "count", "design", "tolerance", NULL};
    const struct scree_toml *table = scree_read_table(r, r->root, "curves");
    f->tolerance = 1e-3;
    if (!table) return;
    scree_check_keys(r, table, "[curves]", keys);
    read_range(r, table, &f->from, &f->to);
    f->curves = read_count(r, table, "count", 41);
    f->design = read_positive(r, table, "design", 0.5 * (f->from + f->to));
    f->tolerance = read_positive(r, table, "tolerance", 1e-3);
}

static void read_servo(struct scree_reader *r, struct transport_file *f) {
    static const char *const keys[] = {"rate", "angle", "lift", "map", NULL};
    const struct scree_toml *table = scree_read_table(r, r->root, "servo");
    if (!table) return;
    scree_check_keys(r, table, "[servo]", keys);
    f->rate = read_positive(r, table, "rate", 1000.0);
    f->angle = scree_read_boolean(r, table, "angle");
    f->from_map = scree_read_boolean(r, table, "map");
    for (int k = 0; f->from_map && k < f->speeds; k++)
        if (!f->mapped || f->speed[k] < f->map.low || f->speed[k] > f->map.high)
            scree_complain(r, scree_toml_get(table, "map"),
                           "tables from the map need a [map] whose range holds all speeds, got %g cycles/min",
                           f->speed[k]);
    f->lift = scree_read_number(r, table, "lift", 0.0);
    double slowest = HUGE_VAL, most = 1e7;
    for (int k = 0; k < f->speeds; k++) slowest = fmin(slowest, f->speed[k]);
    double rows = f->rate * 60.0 * (f->lift != 0.0 ? 1.0 : f->task.share) / slowest;
    if (!(rows <= most))
        scree_complain(r, scree_toml_nearest(table, "rate"),
                       "at %g rows a second a table for %g cycles/min has %g rows; the most is %g", f->rate, slowest,
                       rows, most);
    if (f->lift != 0.0 && f->task.share >= 1.0)
        scree_complain(r, scree_toml_get(table, "lift"),
                       "transport takes the whole cycle (share = %g): no time for the return stroke", f->task.share);
}

static void read_root(struct scree_reader *r) {
    static const char *const keys[] = {"title", "transport", "drive", "model", "plan", "map", "curves", "servo", NULL};
    struct transport_file *f = r->into;
    scree_check_keys(r, r->root, "the transport file", keys);
    const char *title = scree_read_string(r, r->root, "title");
    f->title = strdup(title ? title : "");
    read_task(r, f);
    if (!r->status) read_model(r, f);
    if (!r->status) read_plan(r, f);
    if (!r->status && f->modelled) check_lengths(r, f);
    if (!r->status) read_map(r, f);
    if (!r->status) read_curves(r, f);
    if (!r->status) read_servo(r, f);
    if (!f->title) r->status = scree_report(r->trouble, SCREE_NO_MEMORY, NULL, "no memory for the title");
}

scree_status transport_file_read(const char *path, const char *const *assignments, int count,
                                 struct transport_file *transport, scree_trouble *trouble) {
    *transport = (struct transport_file){.title = NULL};
    return scree_read_toml(path, assignments, count, read_root, transport, trouble);
}

void transport_file_free(struct transport_file *transport) {
    process_free(&transport->process);
    free(transport->title);
    free(transport->speed);
}
