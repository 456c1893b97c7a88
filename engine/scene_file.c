/* A scene from a file. Each table of the file has a function that lists the keys it knows, reads them and hands a
 * definition to the library; whatever the library refuses is reported at the key that it is about. */
#include "engine/scene_file.h"

#include "engine/c_locale.h"
#include "engine/file.h"
#include "engine/scene.h"
#include "engine/scene_reader.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static struct scree_scene_target *into(struct scree_reader *r) { return r->into; }

void scree_pass_on(struct scree_reader *r, scree_status status, const struct scree_toml *table) {
    if (!status || r->status) return;
    const scree_trouble *cause = scree_scene_trouble(into(r)->scene);
    scree_complain(r, table ? scree_toml_nearest(table, cause->field) : NULL, "%s", cause->text);
    r->status = r->trouble->status = status;
}

double scree_read_positive(struct scree_reader *r, const struct scree_toml *table, const char *key, const char *unit) {
    double value = scree_read_number(r, table, key, 0.0);
    const struct scree_toml *node = scree_toml_get(table, key);
    if (node && !(value > 0.0)) scree_complain(r, node, "%s must be > 0%s, got %g", key, unit, value);
    return value;
}

/* ---- names of materials, motions, bodies ---- */

struct scree_hint scree_hint_of(const struct scree_reader *r, const char *what, const char *wrong) {
    enum { MOST = 64 };
    const char *names[MOST + 1] = {0};
    int count = 0;
    const struct scree_toml *siblings = scree_toml_get(r->root, what);
    for (const struct scree_toml *s = siblings ? siblings->first : NULL; s && count < MOST; s = s->next) {
        const struct scree_toml *name = scree_toml_get(s, "name");
        if (name && name->type == SCREE_TOML_STRING) names[count++] = name->string;
    }
    return scree_hint(wrong, names);
}

int scree_find_named(struct scree_reader *r, const struct scree_toml *node, const char *what, scree_finder *find) {
    if (node->type != SCREE_TOML_STRING) {
        scree_complain(r, node, "the name of a %s must be a string, not %s", what, scree_toml_type_name(node->type));
        return 0;
    }
    int index = find(into(r)->scene, node->string);
    if (index >= 0) return index;
    scree_complain(r, node, "there is no %s called \"%s\"%s", what, node->string,
                   scree_hint_of(r, what, node->string).text);
    return 0;
}

/* ---- tables of the file ---- */

static void read_material(struct scree_reader *r, const struct scree_toml *table) {
    static const char *const keys[] = {"name", "density", "young", "poisson", "rigid", NULL};
    scree_check_keys(r, table, "[[material]]", keys);
    scree_material_def def = {.name = scree_read_string(r, table, "name"),
                              .density = scree_read_positive(r, table, "density", " kg/m^3"),
                              .young = scree_read_number(r, table, "young", 0.0),
                              .poisson = scree_read_number(r, table, "poisson", 0.0)};
    const struct scree_toml *young = scree_toml_get(table, "young");
    if (scree_read_boolean(r, table, "rigid")) {
        if (young) scree_complain(r, young, "a rigid material has no Young's modulus");
        def.young = HUGE_VAL;
    }
    if (young && def.young == 0.0) scree_complain(r, young, "Young's modulus must be positive (Pa)");
    if (young && !scree_toml_get(table, "poisson")) scree_complain(r, table, "Young's modulus needs poisson beside it");
    if (!r->status) scree_pass_on(r, scree_scene_add_material(into(r)->scene, &def, NULL), table);
}

/* { law = "…", parameter = number, … } */
static void read_law(struct scree_reader *r, const struct scree_toml *table, const char *key,
                     scree_law_choice *choice) {
    const struct scree_toml *law = scree_read_table(r, table, key);
    if (!law) return;
    choice->law = scree_read_string(r, law, "law");
    if (!choice->law) {
        static const char *const examples[][2] = {{"friction", "coulomb"}, {"rolling", "constant"}};
        const char *example = "linear";
        for (int k = 0; k < 2; k++)
            if (strcmp(key, examples[k][0]) == 0) example = examples[k][1];
        scree_check_misspelt(r, law, key, "law");
        scree_complain(r, law, "%s needs a law, such as { law = \"%s\", … }; `scree laws` lists them", key, example);
        return;
    }
    if (strcmp(choice->law, "table") == 0) { /* measured: see read_forces */
        static const char *const keys[] = {"law", "rows", "file", NULL};
        scree_check_keys(r, law, "the law \"table\"", keys);
        return;
    }
    for (const struct scree_toml *child = law->first; child && !r->status; child = child->next) {
        if (strcmp(child->key, "law") == 0) continue;
        if (choice->settings == SCREE_SETTINGS_MAX) {
            scree_complain(r, child, "no law has more than %d parameters", SCREE_SETTINGS_MAX);
            return;
        }
        choice->setting[choice->settings++] = (scree_setting){child->key, scree_number_of(r, child, child->key)};
    }
}

/* Measured forces while they are read: rows of overlap, closing speed and force, then the grid that they fill. */
struct forces {
    struct scree_table columns;
    const double *d, *u, *force; /* those of overlap, closing speed (NULL: none) and force */
    double *speed;
    double *overlap;
    scree_force_table grid;
};

static const struct scree_column force_columns[] = {{{"overlap_m"}}, {{"closing_m_s"}}, {{"force_N"}}};

/* The grid of a list of rows: every overlap with every speed, by rising overlap, then speed. */
static void fill_grid(struct scree_reader *r, const struct scree_toml *node, struct forces *f) {
    const double *d = f->d, *u = f->u;
    size_t rows = f->columns.rows, speeds = 1;
    while (u && speeds < rows && d[speeds] == d[0]) speeds++;
    int whole = rows >= 2 * speeds && rows % speeds == 0;
    for (size_t k = 0; whole && k < rows; k++) whole = d[k] == d[k - k % speeds] && (!u || u[k] == u[k % speeds]);
    if (!whole) {
        scree_complain(r, node,
                       "measured forces must form a grid: every overlap (two at least) with every closing speed, "
                       "ordered by overlap, then speed");
        return;
    }
    f->overlap = malloc(rows / speeds * sizeof(double));
    f->speed = malloc(speeds * sizeof(double));
    if (!f->overlap || !f->speed) {
        r->status = scree_report(r->trouble, SCREE_NO_MEMORY, NULL, "no memory for a force table");
        return;
    }
    for (size_t k = 0; k < rows / speeds; k++) f->overlap[k] = d[k * speeds];
    for (size_t k = 0; k < speeds; k++) f->speed[k] = u ? u[k] : 0.0;
    f->grid = (scree_force_table){(int)(rows / speeds), (int)speeds, f->overlap, f->speed, f->force};
}

/* Of a file, or of rows (`path` NULL), whose columns can be but right. */
static void find_force_columns(struct scree_reader *r, const char *path, struct forces *f) {
    int at[3];
    scree_find_columns(r, path, &f->columns, force_columns, 3,
                       "a force table: it has overlap_m, force_N and, if wanted, closing_m_s", at);
    if (at[0] < 0 || at[2] < 0)
        scree_complain_in_table(r, path, f->columns.header, 1, "a force table needs the columns overlap_m and force_N");
    f->d = scree_table_column(&f->columns, at[0]);
    f->u = scree_table_column(&f->columns, at[1]);
    f->force = scree_table_column(&f->columns, at[2]);
}

/* Of forces at one closing speed; what isn't a grid is told by fill_grid. */
static void check_rise(struct scree_reader *r, const char *path, const struct scree_toml *rows,
                       const struct forces *f) {
    static const char text[] = "the overlaps of a force table must rise: row %zu has %g m after %g m";
    const double *d = f->d;
    const struct scree_toml *row = rows ? rows->first : NULL;
    for (size_t k = 1; k < f->columns.rows && !f->u && !r->status; k++) {
        if (row) row = row->next;
        if (d[k] > d[k - 1]) continue;
        if (path)
            scree_complain_in_table(r, path, 0, 0, text, k + 1, d[k], d[k - 1]);
        else
            scree_complain(r, row, text, k + 1, d[k], d[k - 1]);
    }
}

static void read_forces(struct scree_reader *r, const struct scree_toml *law, struct forces *f) {
    static const char *const two[] = {"overlap_m", "force_N", NULL};
    static const char *const three[] = {"overlap_m", "closing_m_s", "force_N", NULL};
    const struct scree_toml *file = scree_toml_get(law, "file"), *rows = scree_toml_get(law, "rows");
    if (!file == !rows) {
        scree_complain(r, law,
                       "the law \"table\" needs either rows = [[overlap, force], …] (or [[overlap, closing speed, "
                       "force], …]) or file = \"….csv\"");
        return;
    }
    if (file && !scree_read_string(r, law, "file")) return;
    int columns = rows && rows->first && rows->first->type == SCREE_TOML_ARRAY ? rows->first->count : 2;
    char *path = file ? scree_read_table_file(r, file, NULL, &f->columns) : NULL;
    if (!file)
        scree_read_rows(r, rows, columns == 3 ? three : two, 2, "[overlap, force] or [overlap, closing speed, force]",
                        &f->columns);
    if (!r->status) find_force_columns(r, path, f);
    if (!r->status) check_rise(r, path, rows, f);
    free(path);
    if (!r->status) fill_grid(r, file ? file : rows, f);
}

static void free_forces(struct forces *f) {
    scree_table_free(&f->columns);
    free(f->speed);
    free(f->overlap);
}

static void read_contact(struct scree_reader *r, const struct scree_toml *table) {
    static const char *const keys[] = {"between",   "normal", "friction", "rolling",
                                       "shared_by", "none",   "corners",  NULL};
    scree_check_keys(r, table, "[[contact]]", keys);
    scree_contact_def def = {0};
    const struct scree_toml *between = scree_toml_get(table, "between");
    if (!between || between->type != SCREE_TOML_ARRAY || between->count != 2)
        scree_complain(r, between ? between : table, "a contact needs between = [\"one material\", \"another\"]");
    else {
        def.between[0] = scree_find_named(r, between->first, "material", scree_scene_find_material);
        def.between[1] = scree_find_named(r, between->last, "material", scree_scene_find_material);
    }
    read_law(r, table, "normal", &def.normal);
    read_law(r, table, "friction", &def.friction);
    read_law(r, table, "rolling", &def.rolling);
    def.shared_by = (int)scree_read_whole(r, table, "shared_by", 1.0, 1e6);
    def.none = scree_read_boolean(r, table, "none");
    def.corners = scree_read_boolean(r, table, "corners");
    struct forces forces = {.speed = NULL};
    if (!r->status && def.normal.law && strcmp(def.normal.law, "table") == 0) {
        read_forces(r, scree_toml_get(table, "normal"), &forces);
        def.table = &forces.grid;
    }
    if (!r->status) scree_pass_on(r, scree_scene_add_contact(into(r)->scene, &def), table);
    free_forces(&forces);
}

/* [x, y, z] or { vector = […], axis = […], tilt = "motion" } */
static void read_gravity(struct scree_reader *r) {
    const struct scree_toml *node = scree_toml_get(r->root, "gravity");
    if (!node) return;
    scree_gravity_def def = {0};
    if (node->type == SCREE_TOML_TABLE) {
        static const char *const keys[] = {"vector", "axis", "tilt", NULL};
        scree_check_keys(r, node, "gravity", keys);
        if (!scree_read_numbers(r, node, "vector", 3, def.vector))
            scree_complain(r, node, "gravity needs a vector = [x, y, z] in m/s^2");
        scree_read_numbers(r, node, "axis", 3, def.axis);
        const struct scree_toml *tilt = scree_toml_get(node, "tilt");
        def.tilts = tilt != NULL;
        if (tilt) def.tilt = scree_read_driver(r, tilt, "a tilt", SCREE_RADIANS);
        if (!tilt && scree_toml_get(node, "axis"))
            scree_complain(r, scree_toml_get(node, "axis"),
                           "gravity has an axis only to tilt about: add tilt = \"motion\"");
    } else
        scree_read_numbers(r, r->root, "gravity", 3, def.vector);
    if (!r->status) scree_pass_on(r, scree_scene_set_gravity(into(r)->scene, &def), node);
}

static void read_shape(struct scree_reader *r, const struct scree_toml *body, scree_shape *shape) {
    static const char *const keys[] = {"sphere", "box", "rounding", "plane", "rectangle", NULL};
    const struct scree_toml *table = scree_read_table(r, body, "shape");
    if (!table) {
        scree_complain(r, body,
                       "a body needs a shape: { sphere = radius }, { box = [x, y, z], rounding = radius }, "
                       "{ plane = true } or { rectangle = [x, y] }");
        return;
    }
    scree_check_keys(r, table, "shape", keys);
    int kinds = 0;
    for (int k = 0; keys[k]; k++) kinds += strcmp(keys[k], "rounding") != 0 && scree_toml_get(table, keys[k]);
    if (kinds != 1) scree_complain(r, table, "a shape is just one of sphere, box, plane, rectangle");
    if (scree_toml_get(table, "sphere")) {
        shape->kind = SCREE_SPHERE;
        shape->radius = scree_read_number(r, table, "sphere", 0.0);
    } else if (scree_read_numbers(r, table, "box", 3, shape->edge)) {
        shape->kind = SCREE_BOX;
        shape->rounding = scree_read_number(r, table, "rounding", 0.0);
    } else if (scree_read_numbers(r, table, "rectangle", 2, shape->edge))
        shape->kind = SCREE_RECTANGLE;
    else {
        shape->kind = SCREE_PLANE;
        if (!scree_read_boolean(r, table, "plane")) scree_complain(r, table, "write plane = true");
    }
    if (shape->kind != SCREE_BOX && scree_toml_get(table, "rounding"))
        scree_complain(r, scree_toml_get(table, "rounding"), "only a box has a rounding");
}

/* [w, x, y, z] or { axis = […], angle = rad } or { axis = […], degrees = number } */
static void read_orientation(struct scree_reader *r, const struct scree_toml *body, double q[4]) {
    static const char *const keys[] = {"axis", "angle", "degrees", NULL};
    const struct scree_toml *node = scree_toml_get(body, "orientation");
    if (!node) return;
    if (node->type != SCREE_TOML_TABLE) {
        scree_read_numbers(r, body, "orientation", 4, q);
        if (!r->status && q[0] == 0.0 && q[1] == 0.0 && q[2] == 0.0 && q[3] == 0.0)
            scree_complain(r, node, "the quaternion [w, x, y, z] must not be zero");
        return;
    }
    scree_check_keys(r, node, "orientation", keys);
    double axis[3] = {0}, angle = scree_read_number(r, node, "angle", 0.0) +
                                  scree_read_number(r, node, "degrees", 0.0) * (3.14159265358979323846 / 180.0);
    if (!scree_read_numbers(r, node, "axis", 3, axis) ||
        (!scree_toml_get(node, "angle") == !scree_toml_get(node, "degrees")))
        scree_complain(r, node, "an orientation is [w, x, y, z] or { axis = [x, y, z], angle = rad } (or degrees = …)");
    double length = sqrt(axis[0] * axis[0] + axis[1] * axis[1] + axis[2] * axis[2]);
    if (!(length > 1e-100 && length < 1e100))
        scree_complain(r, node, "the axis must not be zero, nor its length beyond 1e-100 to 1e100");
    if (r->status) return;
    q[0] = cos(0.5 * angle);
    for (int k = 0; k < 3; k++) q[1 + k] = sin(0.5 * angle) * axis[k] / length;
}

/* "free", "fixed" or the name of a motion. */
static scree_freedom read_freedom(struct scree_reader *r, const struct scree_toml *node, const char *what,
                                  enum scree_motion_unit unit, int *motion) {
    if (node->type != SCREE_TOML_STRING)
        scree_complain(r, node, "%s must be \"free\", \"fixed\" or the name of a motion, not %s", what,
                       scree_toml_type_name(node->type));
    if (r->status || strcmp(node->string, "free") == 0) return SCREE_FREE;
    if (strcmp(node->string, "fixed") == 0) return SCREE_FIXED;
    *motion = scree_read_driver(r, node, what, unit);
    return SCREE_DRIVEN;
}

/* turn = "free", "fixed", { hinge = axis } or { axis = axis, motion = "name" } */
static void read_turn(struct scree_reader *r, const struct scree_toml *node, scree_joint *joint) {
    static const char *const keys[] = {"hinge", "axis", "motion", NULL};
    static const char forms[] =
        "turn is \"free\", \"fixed\", { hinge = [x, y, z] } or { axis = [x, y, z], motion = \"name\" }";
    if (node->type != SCREE_TOML_TABLE && node->type != SCREE_TOML_STRING) scree_complain(r, node, forms);
    if (node->type != SCREE_TOML_TABLE) {
        joint->turn = read_freedom(r, node, "a turn", SCREE_RADIANS, &joint->turn_motion);
        if (!r->status && joint->turn == SCREE_DRIVEN)
            scree_complain(r, node, "a driven turn needs its axis: turn = { axis = [x, y, z], motion = \"%s\" }",
                           node->string);
        return;
    }
    scree_check_keys(r, node, "turn", keys);
    const struct scree_toml *motion = scree_toml_get(node, "motion"), *hinge = scree_toml_get(node, "hinge");
    if (scree_read_numbers(r, node, "hinge", 3, joint->axis)) {
        joint->turn = SCREE_FREE;
        if (motion || scree_toml_get(node, "axis"))
            scree_complain(r, node, "a turn has either a hinge, about which it is free, or an axis and a motion");
        if (joint->axis[0] == 0.0 && joint->axis[1] == 0.0 && joint->axis[2] == 0.0)
            scree_complain(r, hinge, "the axis of a hinge must not be zero (turn = \"free\" turns about any axis)");
        return;
    }
    if (!scree_read_numbers(r, node, "axis", 3, joint->axis) || !motion) {
        scree_complain(r, node, forms);
        return;
    }
    joint->turn = SCREE_DRIVEN;
    joint->turn_motion = scree_read_driver(r, motion, "a turn", SCREE_RADIANS);
}

void scree_read_joint(struct scree_reader *r, const struct scree_toml *body, scree_joint *joint) {
    static const char *const keys[] = {"x", "y", "z", "turn", "others", NULL};
    static const char *const words[] = {"free", "fixed", NULL};
    const struct scree_toml *node = scree_toml_get(body, "joint");
    if (!node) return;
    const struct scree_toml *others = node->type == SCREE_TOML_TABLE ? scree_toml_get(node, "others") : node;
    const char *what = others == node ? "joint, unless it is a table { x, y, z, turn, others }," : "others";
    scree_freedom freedom = others ? (scree_freedom)scree_choose(r, others, what, words) : SCREE_FREE;
    for (int k = 0; k < 3; k++) joint->along[k] = freedom;
    joint->turn = freedom;
    if (node->type != SCREE_TOML_TABLE) return;
    scree_check_keys(r, node, "joint", keys);
    for (int k = 0; k < 3; k++) {
        const struct scree_toml *along = scree_toml_get(node, keys[k]);
        if (along) joint->along[k] = read_freedom(r, along, keys[k], SCREE_METRES, &joint->along_motion[k]);
    }
    const struct scree_toml *turn = scree_toml_get(node, "turn");
    if (turn) read_turn(r, turn, joint);
}

static void read_body(struct scree_reader *r, const struct scree_toml *table) {
    static const char *const keys[] = {"name",        "shape",    "material", "mass",  "position",
                                       "orientation", "velocity", "spin",     "joint", NULL};
    scree_check_keys(r, table, "[[body]]", keys);
    scree_body_def def = {.name = scree_read_string(r, table, "name"),
                          .mass = scree_read_positive(r, table, "mass", " kg")};
    const struct scree_toml *material = scree_toml_get(table, "material");
    if (!material) scree_complain(r, table, "a body needs a material");
    if (r->status) return;
    def.material = scree_find_named(r, material, "material", scree_scene_find_material);
    read_shape(r, table, &def.shape);
    scree_read_numbers(r, table, "position", 3, def.position);
    scree_read_numbers(r, table, "velocity", 3, def.velocity);
    scree_read_numbers(r, table, "spin", 3, def.spin);
    read_orientation(r, table, def.orientation);
    scree_read_joint(r, table, &def.joint);
    if (!r->status) scree_pass_on(r, scree_scene_add_body(into(r)->scene, &def, NULL), table);
}

/* The largest whole share of `every`, down to a thousandth, of which `end` is a whole multiple. 1e-9: the quotient of
 * two numbers given in decimals. */
static double whole_share(double end, double every) {
    for (int parts = 1; parts < 1000; parts++) {
        double times = end / every * parts;
        if (fabs(times - floor(times + 0.5)) <= 1e-9 * times) return every / parts;
    }
    return every / 1000.0;
}

/* A number of seconds, or "auto". */
static void read_step(struct scree_reader *r, const struct scree_toml *table, scree_time_def *def) {
    const struct scree_toml *step = scree_toml_get(table, "step");
    if (!step || step->type != SCREE_TOML_STRING)
        def->step = scree_read_positive(r, table, "step", " s (or \"auto\")");
    else if (strcmp(step->string, "auto") != 0)
        scree_complain(r, step, "step must be a number of seconds or \"auto\"");
}

/* Who steps, and what belongs to one of them alone. What doesn't fit together the library says. */
static void read_integrator(struct scree_reader *r, const struct scree_toml *table, scree_time_def *def) {
    static const char *const integrators[] = {"auto", "verlet", "pair-impulse", "adaptive", NULL};
    const struct scree_toml *integrator = scree_toml_get(table, "integrator"),
                            *flight = scree_toml_get(table, "flight");
    if (integrator) def->integrator = (scree_integrator)scree_choose(r, integrator, "integrator", integrators);
    if (def->integrator == SCREE_ADAPTIVE) def->divide = whole_share(into(r)->end, def->divide);
    def->tolerance = scree_read_positive(r, table, "tolerance", "");
    def->substeps = (int)scree_read_whole(r, table, "substeps", 1.0, SCREE_MOST_SUBSTEPS);
    def->sleep = scree_read_positive(r, table, "sleep", " m/s");
    def->no_flight = flight && !scree_read_boolean(r, table, "flight");
    if (flight && def->integrator != SCREE_ADAPTIVE)
        scree_complain(r, flight, "flight goes with the integrator adaptive; it would be without effect");
}

static void read_time(struct scree_reader *r) {
    static const char *const keys[] = {"end",   "step",    "accuracy",  "integrator", "substeps", "speed", "force",
                                       "watch", "threads", "tolerance", "flight",     "sleep",    NULL};
    static const char *const watches[] = {"stop", "halve", NULL};
    const struct scree_toml *table = scree_read_table(r, r->root, "time");
    if (!table) {
        scree_complain(r, NULL, "the scene needs a table [time] with its end (s)");
        return;
    }
    scree_check_keys(r, table, "[time]", keys);
    const struct scree_toml *end = scree_toml_get(table, "end"), *watch = scree_toml_get(table, "watch");
    into(r)->end = scree_read_positive(r, table, "end", " s");
    if (!end) scree_complain(r, table, "[time] needs end = the simulated time in s, > 0");
    int rows = into(r)->every > 0.0 && into(r)->every < into(r)->end;
    scree_time_def def = {.divide = rows ? into(r)->every : into(r)->end,
                          .accuracy = scree_read_positive(r, table, "accuracy", ""),
                          .speed = scree_read_positive(r, table, "speed", " m/s"),
                          .force = scree_read_boolean(r, table, "force"),
                          .energy = (into(r)->request->write & SCREE_WRITE_ENERGY) != 0};
    read_step(r, table, &def);
    read_integrator(r, table, &def);
    if (watch) def.watch = (scree_watch)scree_choose(r, watch, "watch", watches);
    def.threads = (int)scree_read_whole(r, table, "threads", 1.0, SCREE_MOST_THREADS);
    if (into(r)->threads > 0) def.threads = into(r)->threads;
    if (!r->status) scree_pass_on(r, scree_scene_set_time(into(r)->scene, &def), table);
}

static void read_write_list(struct scree_reader *r, const struct scree_toml *list) {
    static const char *const words[] = {"bodies.csv", "contacts.csv", "energy.csv", "vtk", "spheres.csv", NULL};
    if (list->type != SCREE_TOML_ARRAY) {
        scree_complain(r, list, "write must be an array such as [\"bodies.csv\", \"vtk\"]");
        return;
    }
    into(r)->request->write = 0;
    for (const struct scree_toml *entry = list->first; entry; entry = entry->next)
        into(r)->request->write |= 1u << scree_choose(r, entry, "an entry of write", words);
}

static void read_output(struct scree_reader *r) {
    static const char *const keys[] = {"every", "write", "bodies", NULL};
    const struct scree_toml *table = scree_read_table(r, r->root, "output");
    into(r)->request->write = SCREE_WRITE_BODIES;
    if (!table) return;
    scree_check_keys(r, table, "[output]", keys);
    const struct scree_toml *write = scree_toml_get(table, "write");
    into(r)->every = scree_read_positive(r, table, "every", " s");
    if (write) read_write_list(r, write);
}

/* [output] bodies, once the bodies are known. */
static void read_output_bodies(struct scree_reader *r) {
    const struct scree_toml *list = scree_toml_get(scree_toml_get(r->root, "output"), "bodies");
    if (!list) return;
    if (list->type != SCREE_TOML_ARRAY) scree_complain(r, list, "bodies must be an array of names");
    if (!r->status && list->count == 0)
        scree_complain(
            r, list,
            "bodies = [] would write none: leave bodies out for all that move, or bodies.csv out of write for none");
    if (r->status) return;
    into(r)->request->body = malloc(((size_t)list->count + 1) * sizeof *into(r)->request->body);
    if (!into(r)->request->body) {
        r->status = scree_report(r->trouble, SCREE_NO_MEMORY, NULL, "no memory for a list of bodies");
        return;
    }
    for (const struct scree_toml *entry = list->first; entry; entry = entry->next)
        into(r)->request->body[into(r)->request->bodies++] = scree_find_named(r, entry, "body", scree_scene_find_body);
}

static void read_root(struct scree_reader *r) {
    static const char *const keys[] = {"title",  "gravity", "time",    "domain",   "material", "contact",
                                       "motion", "body",    "spheres", "generate", "output",   NULL};
    scree_check_keys(r, r->root, "the scene", keys);
    const char *title = scree_read_string(r, r->root, "title");
    into(r)->request->title = strdup(title ? title : "");
    if (!into(r)->request->title)
        r->status = scree_report(r->trouble, SCREE_NO_MEMORY, NULL, "no memory for the title");
    read_output(r);
    if (!r->status) read_time(r);
    scree_read_each(r, r->root, "material", read_material);
    scree_read_each(r, r->root, "contact", read_contact);
    scree_read_each(r, r->root, "motion", scree_read_motion);
    if (!r->status) read_gravity(r);
    if (!r->status) scree_read_domain(r);
    scree_read_each(r, r->root, "body", read_body);
    scree_read_each(r, r->root, "spheres", scree_read_spheres);
    scree_read_each(r, r->root, "generate", scree_read_generate);
    if (!r->status) read_output_bodies(r);
    into(r)->request->end = into(r)->end;
    into(r)->request->every = into(r)->every;
}

/* ---- the whole ---- */

/* Steps that a run may have: up to here their number, and any time as a multiple of the step, is exact to rounding. */
static const double most_steps = 1e15;

long scree_steps_to(const scree_scene *scene, double time) {
    return (long)ceil(time / scree_scene_step_length(scene) * (1.0 - 1e-12));
}

/* "; the stiffest contact is …", where it may have set the step. */
struct blame {
    char text[600];
};

static struct blame stiffest_contact(const scree_scene *scene) {
    const struct scree_step_choice *choice = &scene->plan.choice;
    struct blame blame = {""};
    if (choice->automatic && choice->limit_pair[0] >= 0)
        snprintf(blame.text, sizeof blame.text, "; the stiffest contact is that of \"%s\" with \"%s\"",
                 scree_name_of(scene, choice->limit_pair[0]).text, scree_name_of(scene, choice->limit_pair[1]).text);
    return blame;
}

/* Their numbers have six digits. */
static const double most_frames = 999999.0;

static void check_frames(struct scree_reader *r, const struct scree_toml *every) {
    double frames = into(r)->end / into(r)->every;
    if (into(r)->request->write & SCREE_WRITE_VTK && into(r)->every > 0.0 && frames > most_frames)
        scree_complain(r, every, "frames for ParaView every %g s would be %.3g; the most is %.0f", into(r)->every,
                       frames, most_frames);
}

static void check_length(struct scree_reader *r) {
    double step = scree_scene_step_length(into(r)->scene);
    const struct scree_toml *every = scree_toml_get(scree_toml_get(r->root, "output"), "every");
    const struct scree_toml *end = scree_toml_get(scree_toml_get(r->root, "time"), "end");
    int too_many = into(r)->end / step > most_steps, by_rows = fabs(step - into(r)->every) <= 1e-9 * into(r)->every;
    if (too_many && by_rows)
        scree_complain(r, every, "rows every %g s up to t = %g s ask for %.3g steps; the most is %g", into(r)->every,
                       into(r)->end, into(r)->end / into(r)->every, most_steps);
    else if (too_many)
        scree_complain(r, end, "up to t = %g s it would take %.3g steps of %g s; the most is %g%s", into(r)->end,
                       into(r)->end / step, step, most_steps, stiffest_contact(into(r)->scene).text);
    /* 1e-9: the quotient of two numbers given in decimals. */
    if (into(r)->every > 0.0 && into(r)->every < step * (1.0 - 1e-9))
        scree_complain(r, every, "rows every %g s are closer than the step of %g s", into(r)->every, step);
    check_frames(r, every);
}

static void define(struct scree_reader *r, struct scree_toml_document *document, const char *text, size_t size,
                   const char *const *assignments, int assignment_count) {
    r->status = scree_toml_parse(text, size, r->name, document, r->trouble);
    for (int k = 0; k < assignment_count && !r->status; k++)
        r->status = scree_toml_set(document, assignments[k], r->trouble);
    if (r->status) return;
    r->root = document->root;
    into(r)->scene = scree_scene_create();
    if (!into(r)->scene)
        r->status = scree_report(r->trouble, SCREE_NO_MEMORY, NULL, "no memory for a scene");
    else
        read_root(r);
    if (r->status) return;
    scree_status status = scree_scene_bake(into(r)->scene);
    if (!status) {
        check_length(r);
        return;
    }
    /* Of what baking refuses, only keys of [time] and the domain stand in one place of the file. */
    const char *field = scree_scene_trouble(into(r)->scene)->field;
    const struct scree_toml *time = scree_toml_get(r->root, "time");
    if (strcmp(field, "domain") == 0)
        scree_pass_on(r, status, scree_toml_get(r->root, field));
    else
        scree_pass_on(r, status, strcmp(field, "step") == 0 || scree_toml_get(time, field) ? time : NULL);
}

scree_status scree_read_scene(const char *text, size_t size, const char *name, const char *const *assignments,
                              int assignment_count, int threads, scree_scene **scene, struct scree_run_request *request,
                              scree_trouble *trouble) {
    *request = (struct scree_run_request){0};
    *scene = NULL;
    struct scree_scene_target target = {.request = request, .threads = threads};
    struct scree_reader r = {.name = name, .trouble = trouble, .into = &target, .beside = &request->inputs};
    struct scree_toml_document document;
    struct scree_c_locale locale = scree_enter_c_locale();
    define(&r, &document, text, size, assignments, assignment_count);
    scree_toml_free(&document);
    free(target.motion_unit);
    scree_leave_c_locale(locale);
    if (r.status)
        scree_scene_destroy(target.scene);
    else
        *scene = target.scene;
    return r.status;
}

scree_status scree_load_scene(const char *path, const char *const *assignments, int assignment_count, int threads,
                              scree_scene **scene, struct scree_run_request *request, scree_trouble *trouble) {
    *request = (struct scree_run_request){0};
    *scene = NULL;
    size_t size;
    char *text = scree_read_file(path, SCREE_TOML_LARGEST, &size, trouble);
    if (!text) return trouble->status;
    scree_status status = scree_read_scene(text, size, strcmp(path, "-") ? path : "standard input", assignments,
                                           assignment_count, threads, scene, request, trouble);
    free(text);
    if (status || strcmp(path, "-") == 0) return status;
    status = scree_add_path(&request->inputs, path, trouble);
    if (!status) return SCREE_OK;
    scree_scene_destroy(*scene);
    *scene = NULL;
    return status;
}

void scree_free_request(struct scree_run_request *request) {
    free(request->title);
    free(request->body);
    scree_free_paths(&request->inputs);
    *request = (struct scree_run_request){0};
}
