/* Prescribed motions: their tables, their units, and who is driven by them. */
#include "engine/scene_reader.h"

#include <stdlib.h>
#include <string.h>

static struct scree_scene_target *into(struct scree_reader *r) { return r->into; }

/* ---- units ---- */

static const char *const unit_names[] = {"", "m", "rad"};

static void note_unit(struct scree_reader *r, int motion, enum scree_motion_unit unit) {
    enum scree_motion_unit *units = realloc(into(r)->motion_unit, ((size_t)motion + 1) * sizeof *units);
    if (!units) {
        r->status = scree_report(r->trouble, SCREE_NO_MEMORY, NULL, "no memory for the units of motions");
        return;
    }
    into(r)->motion_unit = units;
    units[motion] = unit;
}

int scree_read_driver(struct scree_reader *r, const struct scree_toml *node, const char *what,
                      enum scree_motion_unit unit) {
    int motion = scree_find_named(r, node, "motion", scree_scene_find_motion);
    enum scree_motion_unit own = r->status ? SCREE_ANY_UNIT : into(r)->motion_unit[motion];
    if (own != SCREE_ANY_UNIT && own != unit)
        scree_complain(r, node, "the motion \"%s\" is in %s, and %s goes by %s", node->string, unit_names[own], what,
                       unit_names[unit]);
    return motion;
}

/* ---- tables ---- */

/* The columns of a motion table, with the names that they may have: the quantity, or the quantity and its unit (by enum
 * scree_motion_unit). */
static const struct {
    const char *quantity, *names[4];
} motion_columns[] = {{"time", {"time", "time_s"}},
                      {"position", {"position", "position_m", "position_rad"}},
                      {"velocity", {"velocity", "velocity_m_s", "velocity_rad_s"}},
                      {"acceleration", {"acceleration", "acceleration_m_s2", "acceleration_rad_s2"}},
                      {"jerk", {"jerk", "jerk_m_s3", "jerk_rad_s3"}}};

enum { MOTION_COLUMNS = sizeof motion_columns / sizeof motion_columns[0] };

/* Columns of the comb's lift in a servo table (solver/table.h), which `axis = "lift"` chooses. */
static const char lift_prefix[] = "lift_";

/* Tables of two axes: of the lift's columns those for `lift` count, or those for the stroke; the time is for both. The
 * name without the prefix; NULL if the column is the other axis's. */
static const char *motion_column(const char *name, int lift) {
    size_t length = strlen(lift_prefix);
    int lifts = strncmp(name, lift_prefix, length) == 0,
        both = strcmp(name, "time") == 0 || strcmp(name, "time_s") == 0;
    if (lifts) return lift ? name + length : NULL;
    return lift && !both ? NULL : name;
}

/* A column that would be taken for something else, or passed over, is refused: "time_ms", "velocty", a second time. */
static void check_motion_columns(struct scree_reader *r, const char *path, const struct scree_table *table, int lift) {
    int seen[MOTION_COLUMNS] = {0};
    for (int k = 0; k < table->columns && !r->status; k++) {
        const char *all[4 * MOTION_COLUMNS] = {0};
        int found = -1, count = 0;
        const char *name = motion_column(table->name[k], lift);
        if (!name) continue;
        for (int m = 0; m < MOTION_COLUMNS; m++)
            for (int n = 0; motion_columns[m].names[n]; n++) {
                all[count++] = motion_columns[m].names[n];
                if (strcmp(name, motion_columns[m].names[n]) == 0) found = m;
            }
        if (strcmp(name, "angle_deg") == 0)
            scree_complain_in_table(r, path, table->header, table->at[k],
                                    "a table over the machine's angle is no motion over the time: [servo] angle = "
                                    "false writes one that is");
        else if (found < 0)
            scree_complain_in_table(
                r, path, table->header, table->at[k],
                "there is no column \"%s\" in a motion table: it has time_s, position_m (or position_rad) "
                "and, if wanted, velocity_m_s, acceleration_m_s2 and jerk_m_s3 (or …_rad_…), in these units%s",
                table->name[k], scree_hint(table->name[k], all).text);
        else if (seen[found]++)
            scree_complain_in_table(r, path, table->header, table->at[k], "two columns for the %s",
                                    motion_columns[found].quantity);
    }
    for (int m = 0; m < 2 && !r->status; m++)
        if (!seen[m])
            scree_complain_in_table(r, path, table->header, 1,
                                    "the table needs the columns time_s and position_m (or position_rad)");
    for (int m = 3; m < MOTION_COLUMNS && !r->status; m++)
        if (seen[m] && !seen[m - 1])
            scree_complain_in_table(r, path, table->header, 1, "the %s of a motion counts only beside its %s",
                                    motion_columns[m].quantity, motion_columns[m - 1].quantity);
    if (!r->status && table->rows < 2)
        scree_complain_in_table(r, path, 0, 0, "a motion needs at least 2 rows of numbers, this table has %zu",
                                table->rows);
}

/* The unit that a column's name tells. */
static enum scree_motion_unit unit_of(const char *name) {
    for (int m = 1; m < MOTION_COLUMNS; m++)
        for (int unit = SCREE_METRES; unit <= SCREE_RADIANS; unit++)
            if (strcmp(name, motion_columns[m].names[unit]) == 0) return (enum scree_motion_unit)unit;
    return SCREE_ANY_UNIT;
}

/* That of all columns; a mixture is refused. */
static enum scree_motion_unit unit_of_columns(struct scree_reader *r, const char *path, const struct scree_table *table,
                                              int lift) {
    enum scree_motion_unit unit = SCREE_ANY_UNIT;
    for (int k = 0; k < table->columns && !r->status; k++) {
        const char *name = motion_column(table->name[k], lift);
        enum scree_motion_unit own = name ? unit_of(name) : SCREE_ANY_UNIT;
        if (own == SCREE_ANY_UNIT) continue;
        if (unit != SCREE_ANY_UNIT && own != unit)
            scree_complain_in_table(r, path, table->header, table->at[k],
                                    "\"%s\" goes by %s, and a column before it by %s", table->name[k], unit_names[own],
                                    unit_names[unit]);
        unit = own;
    }
    return unit;
}

/* The times of a motion's rows increase. */
static void check_times(struct scree_reader *r, const struct scree_toml *rows, const struct scree_table *table) {
    size_t n = 0;
    const double *time = table->column[0];
    for (const struct scree_toml *row = rows->first; row && !r->status; row = row->next, n++)
        if (n > 0 && !(time[n] > time[n - 1]))
            scree_complain(r, row, "the times of a motion table must increase: row %zu has %g s after %g s", n + 1,
                           time[n], time[n - 1]);
}

static void read_motion_table(struct scree_reader *r, const struct scree_toml *table, scree_motion_def *def,
                              struct scree_table *columns, enum scree_motion_unit *unit) {
    static const char *const laws[] = {"linear", "spline", "cubic", "quintic", "velocity-quintic", NULL};
    const struct scree_toml *file = scree_toml_get(table, "file"), *rows = scree_toml_get(table, "rows");
    if (!file == !rows) {
        scree_complain(r, table, "a table motion needs either rows = [[time, position], …] or file = \"….csv\"");
        return;
    }
    if (file && !scree_read_string(r, table, "file")) return;
    static const char *const axes[] = {"stroke", "lift", NULL};
    const struct scree_toml *axis = scree_toml_get(table, "axis");
    int lift = axis ? scree_choose(r, axis, "axis", axes) : 0;
    if (axis && !file) scree_complain(r, axis, "axis chooses columns of a file; rows have one axis");
    if (r->status) return;
    char *path = file ? scree_read_table_file(r, file, "time", columns) : NULL;
    if (path) check_motion_columns(r, path, columns, lift);
    if (path) *unit = unit_of_columns(r, path, columns, lift);
    free(path);
    static const char *const names[] = {"time", "position", "velocity", "acceleration", "jerk", NULL};
    if (!file)
        scree_read_rows(r, rows, names, 2, "[time, position] and, if wanted, velocity, acceleration and jerk", columns);
    if (!file && !r->status) check_times(r, rows, columns);
    if (r->status) return;
    def->rows = columns->rows;
    def->times = scree_table_column(columns, "time");
    def->positions = scree_table_column(columns, lift ? "lift_position" : "position");
    def->velocities = scree_table_column(columns, lift ? "lift_velocity" : "velocity");
    def->accelerations = scree_table_column(columns, lift ? "lift_acceleration" : "acceleration");
    def->jerks = scree_table_column(columns, lift ? "lift_jerk" : "jerk");
    def->table = def->jerks           ? SCREE_TABLE_VELOCITY_QUINTIC
                 : def->accelerations ? SCREE_TABLE_QUINTIC
                 : def->velocities    ? SCREE_TABLE_CUBIC
                                      : SCREE_TABLE_LINEAR;
    const struct scree_toml *law = scree_toml_get(table, "interpolation");
    if (law) def->table = (scree_table_law)scree_choose(r, law, "interpolation", laws);
}

/* Keys of each kind of motion, in the order of scree_motion_kind; and those that it needs. */
static const struct {
    const char *kind, *needs[3], *keys[9];
} motion_kinds[] = {{"velocity", {"velocity"}, {"name", "kind", "offset", "start", "duration", "velocity"}},
                    {"rise", {"stroke", "duration"}, {"name", "kind", "offset", "start", "duration", "stroke", "law"}},
                    {"sine",
                     {"amplitude", "frequency"},
                     {"name", "kind", "offset", "start", "duration", "amplitude", "frequency", "phase"}},
                    {"table", {NULL}, {"name", "kind", "rows", "file", "axis", "interpolation"}}};

/* The kind of a motion; its keys are checked: one of another kind would be without effect. */
static scree_motion_kind read_motion_kind(struct scree_reader *r, const struct scree_toml *table) {
    enum { KINDS = sizeof motion_kinds / sizeof motion_kinds[0] };
    const char *kinds[KINDS + 1] = {0};
    for (int k = 0; k < KINDS; k++) kinds[k] = motion_kinds[k].kind;
    const struct scree_toml *kind = scree_toml_get(table, "kind");
    if (!kind) scree_complain(r, table, "a motion needs a kind: \"velocity\", \"rise\", \"sine\" or \"table\"");
    int index = kind ? scree_choose(r, kind, "kind", kinds) : 0;
    if (r->status) return SCREE_MOTION_VELOCITY;
    char what[64];
    snprintf(what, sizeof what, "a [[motion]] of kind \"%s\"", kinds[index]);
    scree_check_keys(r, table, what, motion_kinds[index].keys);
    for (const char *const *needs = motion_kinds[index].needs; *needs; needs++)
        if (!scree_toml_get(table, *needs)) scree_complain(r, table, "%s needs %s", what, *needs);
    const struct scree_toml *duration = scree_toml_get(table, "duration");
    if (duration && (duration->type == SCREE_TOML_INTEGER || duration->type == SCREE_TOML_FLOAT) &&
        duration->number == 0.0)
        scree_complain(r, duration, "duration must be > 0 s; left out, the motion goes on for ever");
    return (scree_motion_kind)index;
}

void scree_read_motion(struct scree_reader *r, const struct scree_toml *table) {
    static const char *const rises[] = {"quintic", "cycloid", NULL};
    scree_motion_kind kind = read_motion_kind(r, table);
    if (r->status) return;
    const struct scree_toml *law = scree_toml_get(table, "law");
    scree_motion_def def = {.name = scree_read_string(r, table, "name"),
                            .kind = kind,
                            .offset = scree_read_number(r, table, "offset", 0.0),
                            .start = scree_read_number(r, table, "start", 0.0),
                            .duration = scree_read_number(r, table, "duration", 0.0),
                            .velocity = scree_read_number(r, table, "velocity", 0.0),
                            .stroke = scree_read_number(r, table, "stroke", 0.0),
                            .amplitude = scree_read_number(r, table, "amplitude", 0.0),
                            .frequency = scree_read_number(r, table, "frequency", 0.0),
                            .phase = scree_read_number(r, table, "phase", 0.0)};
    if (law) def.rise = (scree_rise_law)scree_choose(r, law, "law", rises);
    struct scree_table columns = {0};
    enum scree_motion_unit unit = SCREE_ANY_UNIT;
    int index = 0;
    if (!r->status && def.kind == SCREE_MOTION_TABLE) read_motion_table(r, table, &def, &columns, &unit);
    if (!r->status) scree_pass_on(r, scree_scene_add_motion(into(r)->scene, &def, &index), table);
    if (!r->status) note_unit(r, index, unit);
    scree_table_free(&columns);
}
