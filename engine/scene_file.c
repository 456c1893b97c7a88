/* A scene from a file. Each table of the file has a function that lists the keys it knows, reads them and hands a
 * definition to the library; whatever the library refuses is reported at the key that it is about. */
#include "engine/scene_file.h"

#include "engine/c_locale.h"
#include "engine/file.h"
#include "engine/table.h"
#include "engine/toml.h"

#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

/* What the functions below share while one file is read. */
struct reader {
    const char *name; /* of the file */
    const struct scree_toml *root;
    scree_scene *scene;
    struct scree_run_request *request;
    scree_trouble *trouble;
    scree_status status; /* the first failure; everything after it does nothing */
    int threads;
    double end, every;
};

/* ---- messages ---- */

SCREE_PRINTF(3, 4)
static void complain(struct reader *r, const struct scree_toml *node, const char *format, ...) {
    va_list arguments;
    if (r->status) return;
    va_start(arguments, format);
    r->status = scree_report_at(r->trouble, SCREE_BAD_INPUT, r->name, node ? node->line : 0, node ? node->column : 0,
                                format, arguments);
    va_end(arguments);
}

/* Pass on what the library said of a definition that came from `table`. */
static void check(struct reader *r, scree_status status, const struct scree_toml *table) {
    if (!status || r->status) return;
    const scree_trouble *cause = scree_scene_trouble(r->scene);
    complain(r, table ? scree_toml_nearest(table, cause->field) : NULL, "%s", cause->text);
    r->status = r->trouble->status = status;
}

/* ---- typed access ---- */

/* Every key of `table` is one of `keys` (NULL-terminated). */
static void check_keys(struct reader *r, const struct scree_toml *table, const char *what, const char *const *keys) {
    for (const struct scree_toml *child = table->first; child; child = child->next) {
        int known = 0;
        for (const char *const *key = keys; *key; key++) known |= strcmp(*key, child->key) == 0;
        if (known) continue;
        complain(r, child, "unknown key \"%s\" in %s%s", child->key, what, scree_hint(child->key, keys).text);
    }
}

static int is_number(const struct scree_toml *node) {
    return node->type == SCREE_TOML_INTEGER || node->type == SCREE_TOML_FLOAT;
}

static double number_of(struct reader *r, const struct scree_toml *node, const char *what) {
    if (!is_number(node)) {
        complain(r, node, "%s must be a number, not %s", what, scree_toml_type_name(node->type));
        return 0.0;
    }
    if (!isfinite(node->number)) complain(r, node, "%s must be a finite number", what);
    return node->number;
}

static double read_number(struct reader *r, const struct scree_toml *table, const char *key, double fallback) {
    const struct scree_toml *node = scree_toml_get(table, key);
    return node ? number_of(r, node, key) : fallback;
}

static const char *read_string(struct reader *r, const struct scree_toml *table, const char *key) {
    const struct scree_toml *node = scree_toml_get(table, key);
    if (!node) return NULL;
    if (node->type == SCREE_TOML_STRING) return node->string;
    complain(r, node, "%s must be a string, not %s", key, scree_toml_type_name(node->type));
    return NULL;
}

static int read_boolean(struct reader *r, const struct scree_toml *table, const char *key) {
    const struct scree_toml *node = scree_toml_get(table, key);
    if (!node) return 0;
    if (node->type != SCREE_TOML_BOOLEAN)
        complain(r, node, "%s must be true or false, not %s", key, scree_toml_type_name(node->type));
    return node->number != 0.0;
}

/* Array of exactly `count` numbers; returns 1 if the key is there. */
static int read_numbers(struct reader *r, const struct scree_toml *table, const char *key, int count, double *to) {
    const struct scree_toml *node = scree_toml_get(table, key);
    if (!node) return 0;
    if (node->type != SCREE_TOML_ARRAY || node->count != count) {
        complain(r, node, "%s must be an array of %d numbers", key, count);
        return 1;
    }
    int k = 0;
    for (const struct scree_toml *value = node->first; value; value = value->next) to[k++] = number_of(r, value, key);
    return 1;
}

/* A table by key, NULL if it isn't there or is no table (which is reported). */
static const struct scree_toml *read_table(struct reader *r, const struct scree_toml *table, const char *key) {
    const struct scree_toml *node = scree_toml_get(table, key);
    if (!node || node->type == SCREE_TOML_TABLE) return node;
    complain(r, node, "%s must be a table, not %s", key, scree_toml_type_name(node->type));
    return NULL;
}

/* Call `read` for each entry of an array of tables. */
static void for_each(struct reader *r, const struct scree_toml *root, const char *key,
                     void (*read)(struct reader *, const struct scree_toml *)) {
    const struct scree_toml *array = scree_toml_get(root, key);
    if (!array) return;
    if (array->type != SCREE_TOML_ARRAY) {
        complain(r, array, "%s must be an array of tables: write [[%s]]", key, key);
        return;
    }
    for (const struct scree_toml *entry = array->first; entry && !r->status; entry = entry->next) {
        if (entry->type != SCREE_TOML_TABLE)
            complain(r, entry, "an entry of %s must be a table, not %s", key, scree_toml_type_name(entry->type));
        else
            read(r, entry);
    }
}

/* Index of `text` among NULL-terminated words, or 0 with a complaint. */
static int choose(struct reader *r, const struct scree_toml *node, const char *what, const char *const *words) {
    for (int k = 0; node->type == SCREE_TOML_STRING && words[k]; k++)
        if (strcmp(words[k], node->string) == 0) return k;
    char list[256] = "";
    for (int k = 0; words[k]; k++)
        snprintf(list + strlen(list), sizeof list - strlen(list), "%s\"%s\"", k ? ", " : "", words[k]);
    complain(r, node, "%s must be one of %s%s", what, list,
             node->type == SCREE_TOML_STRING ? scree_hint(node->string, words).text : "");
    return 0;
}

/* ---- names of materials, motions, bodies ---- */

typedef int finder(const scree_scene *scene, const char *name);

/* The index of the thing that a string names, or 0 with a complaint that gives the nearest of `siblings` ([[what]]). */
static int find_named(struct reader *r, const struct scree_toml *node, const char *what, finder *find) {
    if (node->type != SCREE_TOML_STRING) {
        complain(r, node, "the name of a %s must be a string, not %s", what, scree_toml_type_name(node->type));
        return 0;
    }
    int index = find(r->scene, node->string);
    if (index >= 0) return index;
    enum { MOST = 64 };
    const char *names[MOST + 1] = {0};
    int count = 0;
    const struct scree_toml *siblings = scree_toml_get(r->root, what);
    for (const struct scree_toml *s = siblings ? siblings->first : NULL; s && count < MOST; s = s->next) {
        const struct scree_toml *name = scree_toml_get(s, "name");
        if (name && name->type == SCREE_TOML_STRING) names[count++] = name->string;
    }
    complain(r, node, "there is no %s called \"%s\"%s", what, node->string, scree_hint(node->string, names).text);
    return 0;
}

/* ---- tables of the file ---- */

static void read_material(struct reader *r, const struct scree_toml *table) {
    static const char *const keys[] = {"name", "density", NULL};
    check_keys(r, table, "[[material]]", keys);
    scree_material_def def = {.name = read_string(r, table, "name"), .density = read_number(r, table, "density", 0.0)};
    if (!r->status) check(r, scree_scene_add_material(r->scene, &def, NULL), table);
}

/* { law = "…", parameter = number, … } */
static void read_law(struct reader *r, const struct scree_toml *table, const char *key, scree_law_choice *choice) {
    const struct scree_toml *law = read_table(r, table, key);
    if (!law) return;
    choice->law = read_string(r, law, "law");
    if (!choice->law) {
        complain(r, law, "%s needs a law, such as { law = \"linear\", … }; `scree laws` lists them", key);
        return;
    }
    for (const struct scree_toml *child = law->first; child && !r->status; child = child->next) {
        if (strcmp(child->key, "law") == 0) continue;
        if (choice->settings == SCREE_SETTINGS_MAX) {
            complain(r, child, "no law has more than %d parameters", SCREE_SETTINGS_MAX);
            return;
        }
        choice->setting[choice->settings++] = (scree_setting){child->key, number_of(r, child, child->key)};
    }
}

static void read_contact(struct reader *r, const struct scree_toml *table) {
    static const char *const keys[] = {"between", "normal", "friction", "shared_by", "none", NULL};
    check_keys(r, table, "[[contact]]", keys);
    scree_contact_def def = {0};
    const struct scree_toml *between = scree_toml_get(table, "between");
    if (!between || between->type != SCREE_TOML_ARRAY || between->count != 2)
        complain(r, between ? between : table, "a contact needs between = [\"one material\", \"another\"]");
    else {
        def.between[0] = find_named(r, between->first, "material", scree_scene_find_material);
        def.between[1] = find_named(r, between->last, "material", scree_scene_find_material);
    }
    read_law(r, table, "normal", &def.normal);
    read_law(r, table, "friction", &def.friction);
    double shared = read_number(r, table, "shared_by", 1.0);
    if (!(shared >= 1.0 && shared <= 1e6 && shared == floor(shared)))
        complain(r, scree_toml_get(table, "shared_by"), "shared_by must be a whole number of contacts, at least 1");
    def.shared_by = r->status ? 1 : (int)shared;
    def.none = read_boolean(r, table, "none");
    if (!r->status) check(r, scree_scene_add_contact(r->scene, &def), table);
}

/* Path of a file named in the scene: relative to the scene's folder. To be freed. */
static char *beside_scene(const struct reader *r, const char *file) {
    const char *slash = strrchr(r->name, '/');
    size_t folder = slash && file[0] != '/' ? (size_t)(slash - r->name) + 1 : 0;
    char *path = malloc(folder + strlen(file) + 1);
    if (!path) return NULL;
    memcpy(path, r->name, folder);
    memcpy(path + folder, file, strlen(file) + 1);
    return path;
}

enum { LARGEST_TABLE = 1 << 30 };

/* The columns of a motion table, with the names that they may have: the quantity, or the quantity and its unit. */
static const struct {
    const char *quantity, *names[4];
} motion_columns[] = {{"time", {"time", "time_s"}},
                      {"position", {"position", "position_m", "position_rad"}},
                      {"velocity", {"velocity", "velocity_m_s", "velocity_rad_s"}},
                      {"acceleration", {"acceleration", "acceleration_m_s2", "acceleration_rad_s2"}},
                      {"jerk", {"jerk", "jerk_m_s3", "jerk_rad_s3"}}};

enum { MOTION_COLUMNS = sizeof motion_columns / sizeof motion_columns[0] };

SCREE_PRINTF(5, 6)
static void complain_in_table(struct reader *r, const char *path, int line, int column, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    r->status = scree_report_at(r->trouble, SCREE_BAD_INPUT, path, line, column, format, arguments);
    va_end(arguments);
}

/* A column that would be taken for something else, or passed over, is refused: "time_ms", "velocty", a second time. */
static void check_motion_columns(struct reader *r, const char *path, const struct scree_table *table) {
    int seen[MOTION_COLUMNS] = {0};
    for (int k = 0; k < table->columns && !r->status; k++) {
        const char *all[4 * MOTION_COLUMNS] = {0};
        int found = -1, count = 0;
        for (int m = 0; m < MOTION_COLUMNS; m++)
            for (int n = 0; motion_columns[m].names[n]; n++) {
                all[count++] = motion_columns[m].names[n];
                if (strcmp(table->name[k], motion_columns[m].names[n]) == 0) found = m;
            }
        if (found < 0)
            complain_in_table(
                r, path, table->header, table->at[k],
                "there is no column \"%s\" in a motion table: it has time_s, position_m (or position_rad) "
                "and, if wanted, velocity_m_s, acceleration_m_s2 and jerk_m_s3 (or …_rad_…), in these units%s",
                table->name[k], scree_hint(table->name[k], all).text);
        else if (seen[found]++)
            complain_in_table(r, path, table->header, table->at[k], "two columns for the %s",
                              motion_columns[found].quantity);
    }
    for (int m = 0; m < 2 && !r->status; m++)
        if (!seen[m])
            complain_in_table(r, path, table->header, 1,
                              "the table needs the columns time_s and position_m (or position_rad)");
    for (int m = 3; m < MOTION_COLUMNS && !r->status; m++)
        if (seen[m] && !seen[m - 1])
            complain_in_table(r, path, table->header, 1, "the %s of a motion counts only beside its %s",
                              motion_columns[m].quantity, motion_columns[m - 1].quantity);
    if (!r->status && table->rows < 2)
        complain_in_table(r, path, 0, 0, "a motion needs at least 2 rows of numbers, this table has %zu", table->rows);
}

static void read_table_file(struct reader *r, const struct scree_toml *node, struct scree_table *table) {
    if (!node->string[0] || strcmp(node->string, "-") == 0) {
        complain(r, node, "file must name a table (standard input can't be one)");
        return;
    }
    char *path = beside_scene(r, node->string);
    size_t size;
    char *text = path ? scree_read_file(path, LARGEST_TABLE, &size, r->trouble) : NULL;
    if (!path) r->status = scree_report(r->trouble, SCREE_NO_MEMORY, NULL, "no memory");
    if (path && !text) r->status = r->trouble->status;
    if (text) r->status = scree_table_parse(text, size, path, "time", table, r->trouble);
    if (!r->status) check_motion_columns(r, path, table);
    free(text);
    free(path);
}

/* rows = [[time, position, …], …] as columns in the order time, position, velocity, acceleration, jerk. */
static void read_rows(struct reader *r, const struct scree_toml *rows, struct scree_table *table) {
    static const char *const names[] = {"time", "position", "velocity", "acceleration", "jerk"};
    int columns = rows->first && rows->first->type == SCREE_TOML_ARRAY ? rows->first->count : 0;
    if (rows->type != SCREE_TOML_ARRAY || columns < 2 || columns > 5) {
        complain(r, rows,
                 "rows must be an array of rows [time, position] and, if wanted, velocity, acceleration and jerk");
        return;
    }
    for (int k = 0; k < columns; k++) {
        table->name[k] = strdup(names[k]);
        table->column[k] = malloc((size_t)rows->count * sizeof(double));
        table->columns++;
        if (!table->name[k] || !table->column[k])
            r->status = scree_report(r->trouble, SCREE_NO_MEMORY, NULL, "no memory for a table");
    }
    for (const struct scree_toml *row = rows->first; row && !r->status; row = row->next) {
        if (row->type != SCREE_TOML_ARRAY || row->count != columns) {
            complain(r, row, "this row must have %d numbers like the first", columns);
            return;
        }
        int k = 0;
        for (const struct scree_toml *cell = row->first; cell; cell = cell->next, k++)
            table->column[k][table->rows] = number_of(r, cell, names[k]);
        size_t n = table->rows++;
        const double *time = table->column[0];
        if (n > 0 && !(time[n] > time[n - 1]))
            complain(r, row, "the times of a motion table must increase: row %zu has %g s after %g s", n + 1, time[n],
                     time[n - 1]);
    }
}

static void read_motion_table(struct reader *r, const struct scree_toml *table, scree_motion_def *def,
                              struct scree_table *columns) {
    static const char *const laws[] = {"linear", "spline", "cubic", "quintic", "velocity-quintic", NULL};
    const struct scree_toml *file = scree_toml_get(table, "file"), *rows = scree_toml_get(table, "rows");
    if (!file == !rows) {
        complain(r, table, "a table motion needs either rows = [[time, position], …] or file = \"….csv\"");
        return;
    }
    if (file && !read_string(r, table, "file")) return;
    if (file)
        read_table_file(r, file, columns);
    else
        read_rows(r, rows, columns);
    if (r->status) return;
    def->rows = columns->rows;
    def->times = scree_table_column(columns, "time");
    def->positions = scree_table_column(columns, "position");
    def->velocities = scree_table_column(columns, "velocity");
    def->accelerations = scree_table_column(columns, "acceleration");
    def->jerks = scree_table_column(columns, "jerk");
    def->table = def->jerks           ? SCREE_TABLE_VELOCITY_QUINTIC
                 : def->accelerations ? SCREE_TABLE_QUINTIC
                 : def->velocities    ? SCREE_TABLE_CUBIC
                                      : SCREE_TABLE_LINEAR;
    const struct scree_toml *law = scree_toml_get(table, "interpolation");
    if (law) def->table = (scree_table_law)choose(r, law, "interpolation", laws);
}

/* Keys of each kind of motion, in the order of scree_motion_kind; `needs`: without it nothing would move. */
static const struct {
    const char *kind, *needs, *keys[9];
} motion_kinds[] = {
    {"velocity", "velocity", {"name", "kind", "offset", "start", "duration", "velocity"}},
    {"rise", "stroke", {"name", "kind", "offset", "start", "duration", "stroke", "law"}},
    {"sine", "amplitude", {"name", "kind", "offset", "start", "duration", "amplitude", "frequency", "phase"}},
    {"table", NULL, {"name", "kind", "rows", "file", "interpolation"}}};

/* The kind of a motion; its keys are checked: one of another kind would be without effect. */
static scree_motion_kind read_motion_kind(struct reader *r, const struct scree_toml *table) {
    enum { KINDS = sizeof motion_kinds / sizeof motion_kinds[0] };
    const char *kinds[KINDS + 1] = {0};
    for (int k = 0; k < KINDS; k++) kinds[k] = motion_kinds[k].kind;
    const struct scree_toml *kind = scree_toml_get(table, "kind");
    if (!kind) complain(r, table, "a motion needs a kind: \"velocity\", \"rise\", \"sine\" or \"table\"");
    int index = kind ? choose(r, kind, "kind", kinds) : 0;
    if (r->status) return SCREE_MOTION_VELOCITY;
    char what[64];
    snprintf(what, sizeof what, "a [[motion]] of kind \"%s\"", kinds[index]);
    check_keys(r, table, what, motion_kinds[index].keys);
    const char *needs = motion_kinds[index].needs;
    if (needs && !scree_toml_get(table, needs)) complain(r, table, "%s needs %s", what, needs);
    return (scree_motion_kind)index;
}

static void read_motion(struct reader *r, const struct scree_toml *table) {
    static const char *const rises[] = {"quintic", "cycloid", NULL};
    scree_motion_kind kind = read_motion_kind(r, table);
    if (r->status) return;
    const struct scree_toml *law = scree_toml_get(table, "law");
    scree_motion_def def = {.name = read_string(r, table, "name"),
                            .kind = kind,
                            .offset = read_number(r, table, "offset", 0.0),
                            .start = read_number(r, table, "start", 0.0),
                            .duration = read_number(r, table, "duration", 0.0),
                            .velocity = read_number(r, table, "velocity", 0.0),
                            .stroke = read_number(r, table, "stroke", 0.0),
                            .amplitude = read_number(r, table, "amplitude", 0.0),
                            .frequency = read_number(r, table, "frequency", 0.0),
                            .phase = read_number(r, table, "phase", 0.0)};
    if (law) def.rise = (scree_rise_law)choose(r, law, "law", rises);
    struct scree_table columns = {0};
    if (!r->status && def.kind == SCREE_MOTION_TABLE) read_motion_table(r, table, &def, &columns);
    if (!r->status) check(r, scree_scene_add_motion(r->scene, &def, NULL), table);
    scree_table_free(&columns);
}

/* [x, y, z] or { vector = […], axis = […], tilt = "motion" } */
static void read_gravity(struct reader *r) {
    const struct scree_toml *node = scree_toml_get(r->root, "gravity");
    if (!node) return;
    scree_gravity_def def = {0};
    if (node->type == SCREE_TOML_TABLE) {
        static const char *const keys[] = {"vector", "axis", "tilt", NULL};
        check_keys(r, node, "gravity", keys);
        if (!read_numbers(r, node, "vector", 3, def.vector))
            complain(r, node, "gravity needs a vector = [x, y, z] in m/s^2");
        read_numbers(r, node, "axis", 3, def.axis);
        const struct scree_toml *tilt = scree_toml_get(node, "tilt");
        def.tilts = tilt != NULL;
        if (tilt) def.tilt = find_named(r, tilt, "motion", scree_scene_find_motion);
        if (!tilt && scree_toml_get(node, "axis"))
            complain(r, scree_toml_get(node, "axis"), "gravity has an axis only to tilt about: add tilt = \"motion\"");
    } else
        read_numbers(r, r->root, "gravity", 3, def.vector);
    if (!r->status) check(r, scree_scene_set_gravity(r->scene, &def), node);
}

static void read_shape(struct reader *r, const struct scree_toml *body, scree_shape *shape) {
    static const char *const keys[] = {"sphere", "box", "rounding", "plane", "rectangle", NULL};
    const struct scree_toml *table = read_table(r, body, "shape");
    if (!table) {
        complain(r, body,
                 "a body needs a shape: { sphere = radius }, { box = [x, y, z], rounding = radius }, "
                 "{ plane = true } or { rectangle = [x, y] }");
        return;
    }
    check_keys(r, table, "shape", keys);
    int kinds = 0;
    for (int k = 0; keys[k]; k++) kinds += strcmp(keys[k], "rounding") != 0 && scree_toml_get(table, keys[k]);
    if (kinds != 1) complain(r, table, "a shape is just one of sphere, box, plane, rectangle");
    if (scree_toml_get(table, "sphere")) {
        shape->kind = SCREE_SPHERE;
        shape->radius = read_number(r, table, "sphere", 0.0);
    } else if (read_numbers(r, table, "box", 3, shape->edge)) {
        shape->kind = SCREE_BOX;
        shape->rounding = read_number(r, table, "rounding", 0.0);
    } else if (read_numbers(r, table, "rectangle", 2, shape->edge))
        shape->kind = SCREE_RECTANGLE;
    else {
        shape->kind = SCREE_PLANE;
        if (!read_boolean(r, table, "plane")) complain(r, table, "write plane = true");
    }
    if (shape->kind != SCREE_BOX && scree_toml_get(table, "rounding"))
        complain(r, scree_toml_get(table, "rounding"), "only a box has a rounding");
}

/* [w, x, y, z] or { axis = […], angle = rad } or { axis = […], degrees = number } */
static void read_orientation(struct reader *r, const struct scree_toml *body, double q[4]) {
    static const char *const keys[] = {"axis", "angle", "degrees", NULL};
    const struct scree_toml *node = scree_toml_get(body, "orientation");
    if (!node) return;
    if (node->type != SCREE_TOML_TABLE) {
        read_numbers(r, body, "orientation", 4, q);
        if (!r->status && q[0] == 0.0 && q[1] == 0.0 && q[2] == 0.0 && q[3] == 0.0)
            complain(r, node, "the quaternion [w, x, y, z] must not be zero");
        return;
    }
    check_keys(r, node, "orientation", keys);
    double axis[3] = {0}, angle = read_number(r, node, "angle", 0.0) +
                                  read_number(r, node, "degrees", 0.0) * (3.14159265358979323846 / 180.0);
    if (!read_numbers(r, node, "axis", 3, axis) || (!scree_toml_get(node, "angle") == !scree_toml_get(node, "degrees")))
        complain(r, node, "an orientation is [w, x, y, z] or { axis = [x, y, z], angle = rad } (or degrees = …)");
    double length = sqrt(axis[0] * axis[0] + axis[1] * axis[1] + axis[2] * axis[2]);
    if (!(length > 0.0)) complain(r, node, "the axis must not be zero");
    if (r->status) return;
    q[0] = cos(0.5 * angle);
    for (int k = 0; k < 3; k++) q[1 + k] = sin(0.5 * angle) * axis[k] / length;
}

/* "free", "fixed" or the name of a motion. */
static scree_freedom read_freedom(struct reader *r, const struct scree_toml *node, int *motion) {
    if (node->type == SCREE_TOML_STRING && strcmp(node->string, "free") == 0) return SCREE_FREE;
    if (node->type == SCREE_TOML_STRING && strcmp(node->string, "fixed") == 0) return SCREE_FIXED;
    *motion = find_named(r, node, "motion", scree_scene_find_motion);
    return SCREE_DRIVEN;
}

/* turn = "free", "fixed", { hinge = axis } or { axis = axis, motion = "name" } */
static void read_turn(struct reader *r, const struct scree_toml *node, scree_joint *joint) {
    static const char *const keys[] = {"hinge", "axis", "motion", NULL};
    if (node->type != SCREE_TOML_TABLE) {
        joint->turn = read_freedom(r, node, &joint->turn_motion);
        if (!r->status && joint->turn == SCREE_DRIVEN)
            complain(r, node, "a driven turn needs its axis: turn = { axis = [x, y, z], motion = \"%s\" }",
                     node->string);
        return;
    }
    check_keys(r, node, "turn", keys);
    const struct scree_toml *motion = scree_toml_get(node, "motion"), *hinge = scree_toml_get(node, "hinge");
    if (read_numbers(r, node, "hinge", 3, joint->axis)) {
        joint->turn = SCREE_FREE;
        if (motion || scree_toml_get(node, "axis"))
            complain(r, node, "a turn has either a hinge, about which it is free, or an axis and a motion");
        if (joint->axis[0] == 0.0 && joint->axis[1] == 0.0 && joint->axis[2] == 0.0)
            complain(r, hinge, "the axis of a hinge must not be zero (turn = \"free\" turns about any axis)");
        return;
    }
    if (!read_numbers(r, node, "axis", 3, joint->axis) || !motion) {
        complain(r, node,
                 "turn is \"free\", \"fixed\", { hinge = [x, y, z] } or { axis = [x, y, z], motion = \"name\" }");
        return;
    }
    joint->turn = SCREE_DRIVEN;
    joint->turn_motion = find_named(r, motion, "motion", scree_scene_find_motion);
}

/* "free", "fixed", or { x = …, y = …, z = …, turn = …, others = "fixed" } */
static void read_joint(struct reader *r, const struct scree_toml *body, scree_joint *joint) {
    static const char *const keys[] = {"x", "y", "z", "turn", "others", NULL};
    static const char *const words[] = {"free", "fixed", NULL};
    const struct scree_toml *node = scree_toml_get(body, "joint");
    if (!node) return;
    const struct scree_toml *others = node->type == SCREE_TOML_TABLE ? scree_toml_get(node, "others") : node;
    scree_freedom freedom = others ? (scree_freedom)choose(r, others, "joint", words) : SCREE_FREE;
    for (int k = 0; k < 3; k++) joint->along[k] = freedom;
    joint->turn = freedom;
    if (node->type != SCREE_TOML_TABLE) return;
    check_keys(r, node, "joint", keys);
    for (int k = 0; k < 3; k++) {
        const struct scree_toml *along = scree_toml_get(node, keys[k]);
        if (along) joint->along[k] = read_freedom(r, along, &joint->along_motion[k]);
    }
    const struct scree_toml *turn = scree_toml_get(node, "turn");
    if (turn) read_turn(r, turn, joint);
}

static void read_body(struct reader *r, const struct scree_toml *table) {
    static const char *const keys[] = {"name",        "shape",    "material", "mass",  "position",
                                       "orientation", "velocity", "spin",     "joint", NULL};
    check_keys(r, table, "[[body]]", keys);
    scree_body_def def = {.name = read_string(r, table, "name"), .mass = read_number(r, table, "mass", 0.0)};
    const struct scree_toml *material = scree_toml_get(table, "material"), *mass = scree_toml_get(table, "mass");
    if (!material) complain(r, table, "a body needs a material");
    if (mass && !(def.mass > 0.0)) complain(r, mass, "the mass of a body must be > 0 kg, got %g", def.mass);
    if (r->status) return;
    def.material = find_named(r, material, "material", scree_scene_find_material);
    read_shape(r, table, &def.shape);
    read_numbers(r, table, "position", 3, def.position);
    read_numbers(r, table, "velocity", 3, def.velocity);
    read_numbers(r, table, "spin", 3, def.spin);
    read_orientation(r, table, def.orientation);
    read_joint(r, table, &def.joint);
    if (!r->status) check(r, scree_scene_add_body(r->scene, &def, NULL), table);
}

static void read_time(struct reader *r) {
    static const char *const keys[] = {"end", "step", "integrator", "speed", "force", "threads", NULL};
    static const char *const integrators[] = {"verlet", NULL};
    const struct scree_toml *table = read_table(r, r->root, "time");
    if (!table) {
        complain(r, NULL, "the scene needs a table [time] with its end (s)");
        return;
    }
    check_keys(r, table, "[time]", keys);
    const struct scree_toml *step = scree_toml_get(table, "step"), *end = scree_toml_get(table, "end");
    const struct scree_toml *integrator = scree_toml_get(table, "integrator");
    r->end = read_number(r, table, "end", 0.0);
    if (!end || !(r->end > 0.0)) complain(r, end ? end : table, "[time] needs end = the simulated time in s, > 0");
    scree_time_def def = {.divide = r->every > 0.0 && r->every < r->end ? r->every : r->end,
                          .speed = read_number(r, table, "speed", 0.0),
                          .force = read_boolean(r, table, "force"),
                          .energy = (r->request->write & SCREE_WRITE_ENERGY) != 0};
    if (step && step->type == SCREE_TOML_STRING) {
        if (strcmp(step->string, "auto") != 0) complain(r, step, "step must be a number of seconds or \"auto\"");
    } else if (step) {
        def.step = number_of(r, step, "step");
        if (!(def.step > 0.0)) complain(r, step, "step must be > 0 s (or \"auto\"), got %g", def.step);
    }
    if (integrator) def.integrator = (scree_integrator)choose(r, integrator, "integrator", integrators);
    double threads = read_number(r, table, "threads", 1.0);
    if (!(threads >= 1.0 && threads <= 1024.0 && threads == floor(threads)))
        complain(r, scree_toml_get(table, "threads"), "threads must be a whole number, 1 to 1024");
    def.threads = r->threads > 0 ? r->threads : r->status ? 1 : (int)threads;
    if (!r->status) check(r, scree_scene_set_time(r->scene, &def), table);
}

static void read_write_list(struct reader *r, const struct scree_toml *list) {
    static const char *const words[] = {"bodies.csv", "contacts.csv", "energy.csv", "vtk", NULL};
    if (list->type != SCREE_TOML_ARRAY) {
        complain(r, list, "write must be an array such as [\"bodies.csv\", \"vtk\"]");
        return;
    }
    r->request->write = 0;
    for (const struct scree_toml *entry = list->first; entry; entry = entry->next)
        r->request->write |= 1u << choose(r, entry, "an entry of write", words);
}

static void read_output(struct reader *r) {
    static const char *const keys[] = {"every", "write", "bodies", NULL};
    const struct scree_toml *table = read_table(r, r->root, "output");
    r->request->write = SCREE_WRITE_BODIES;
    if (!table) return;
    check_keys(r, table, "[output]", keys);
    const struct scree_toml *every = scree_toml_get(table, "every"), *write = scree_toml_get(table, "write");
    r->every = read_number(r, table, "every", 0.0);
    if (every && !(r->every > 0.0)) complain(r, every, "every must be > 0 s, got %g", r->every);
    if (write) read_write_list(r, write);
}

/* [output] bodies, once the bodies are known. */
static void read_output_bodies(struct reader *r) {
    const struct scree_toml *list = scree_toml_get(scree_toml_get(r->root, "output"), "bodies");
    if (!list) return;
    if (list->type != SCREE_TOML_ARRAY) complain(r, list, "bodies must be an array of names");
    if (!r->status && list->count == 0)
        complain(
            r, list,
            "bodies = [] would write none: leave bodies out for all that move, or bodies.csv out of write for none");
    if (r->status) return;
    r->request->body = malloc(((size_t)list->count + 1) * sizeof *r->request->body);
    if (!r->request->body) {
        r->status = scree_report(r->trouble, SCREE_NO_MEMORY, NULL, "no memory for a list of bodies");
        return;
    }
    for (const struct scree_toml *entry = list->first; entry; entry = entry->next)
        r->request->body[r->request->bodies++] = find_named(r, entry, "body", scree_scene_find_body);
}

static void read_root(struct reader *r) {
    static const char *const keys[] = {"title",  "gravity", "time",   "material", "contact",
                                       "motion", "body",    "output", NULL};
    check_keys(r, r->root, "the scene", keys);
    const char *title = read_string(r, r->root, "title");
    r->request->title = strdup(title ? title : "");
    if (!r->request->title) r->status = scree_report(r->trouble, SCREE_NO_MEMORY, NULL, "no memory for the title");
    read_output(r);
    if (!r->status) read_time(r);
    for_each(r, r->root, "material", read_material);
    for_each(r, r->root, "contact", read_contact);
    for_each(r, r->root, "motion", read_motion);
    if (!r->status) read_gravity(r);
    for_each(r, r->root, "body", read_body);
    if (!r->status) read_output_bodies(r);
    r->request->end = r->end;
    r->request->every = r->every;
}

/* ---- the whole ---- */

/* Steps that a run may have: up to here their number, and any time as a multiple of the step, is exact to rounding. */
static const double most_steps = 1e15;

long scree_steps_to(const scree_scene *scene, double time) {
    return (long)ceil(time / scree_scene_step_length(scene) * (1.0 - 1e-12));
}

static void check_length(struct reader *r) {
    double step = scree_scene_step_length(r->scene);
    const struct scree_toml *every = scree_toml_get(scree_toml_get(r->root, "output"), "every");
    const struct scree_toml *end = scree_toml_get(scree_toml_get(r->root, "time"), "end");
    if (r->end / step > most_steps)
        complain(r, end, "up to t = %g s it would take %.3g steps of %g s; the most is %g", r->end, r->end / step, step,
                 most_steps);
    /* 1e-9: the quotient of two numbers given in decimals. */
    if (r->every > 0.0 && r->every < step * (1.0 - 1e-9))
        complain(r, every, "rows every %g s are closer than the step of %g s", r->every, step);
}

static scree_status define(struct reader *r, struct scree_toml_document *document, const char *text, size_t size,
                           const char *const *assignments, int assignment_count) {
    r->status = scree_toml_parse(text, size, r->name, document, r->trouble);
    for (int k = 0; k < assignment_count && !r->status; k++)
        r->status = scree_toml_set(document, assignments[k], r->trouble);
    if (r->status) return r->status;
    r->root = document->root;
    r->scene = scree_scene_create();
    if (!r->scene) return r->status = scree_report(r->trouble, SCREE_NO_MEMORY, NULL, "no memory for a scene");
    read_root(r);
    if (r->status) return r->status;
    scree_status status = scree_scene_bake(r->scene);
    if (!status) {
        check_length(r);
        return r->status;
    }
    /* Of what baking refuses, only the step stands in one place of the file. */
    const scree_trouble *cause = scree_scene_trouble(r->scene);
    const struct scree_toml *time = scree_toml_get(r->root, "time");
    check(r, status, strcmp(cause->field, "step") == 0 ? time : NULL);
    return r->status;
}

scree_status scree_read_scene(const char *text, size_t size, const char *name, const char *const *assignments,
                              int assignment_count, int threads, scree_scene **scene, struct scree_run_request *request,
                              scree_trouble *trouble) {
    *request = (struct scree_run_request){0};
    *scene = NULL;
    struct reader r = {.name = name, .request = request, .trouble = trouble, .threads = threads};
    struct scree_toml_document document;
    struct scree_c_locale locale = scree_enter_c_locale();
    define(&r, &document, text, size, assignments, assignment_count);
    scree_toml_free(&document);
    scree_leave_c_locale(locale);
    if (r.status)
        scree_scene_destroy(r.scene);
    else
        *scene = r.scene;
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
    return status;
}

void scree_free_request(struct scree_run_request *request) {
    free(request->title);
    free(request->body);
    *request = (struct scree_run_request){0};
}
