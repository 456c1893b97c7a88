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

/* The columns of a motion table: the quantity, or the quantity and its unit (by enum scree_motion_unit). One over the
 * machine's angle is told what it is. */
enum { TIME, POSITION, VELOCITY, ACCELERATION, JERK, ANGLE, MOTION_COLUMNS };

static const struct scree_column motion_columns[MOTION_COLUMNS] = {
    {{"time", "time_s"}},
    {{"position", "position_m", "position_rad"}},
    {{"velocity", "velocity_m_s", "velocity_rad_s"}},
    {{"acceleration", "acceleration_m_s2", "acceleration_rad_s2"}},
    {{"jerk", "jerk_m_s3", "jerk_rad_s3"}},
    {{"angle_deg"}}};

/* Of a table of two axes (solver/table.h) the columns of the comb's lift, which `axis = "lift"` chooses, without their
 * prefix, or those of the stroke; the time is for both. Shares the table's memory. */
static struct scree_table axis_of(const struct scree_table *table, int lift) {
    static const char prefix[] = "lift_";
    struct scree_table own = {.rows = table->rows, .header = table->header};
    for (int k = 0; k < table->columns; k++) {
        int lifts = strncmp(table->name[k], prefix, strlen(prefix)) == 0;
        if (lifts != lift && strcmp(table->name[k], "time") != 0 && strcmp(table->name[k], "time_s") != 0) continue;
        own.at[own.columns] = table->at[k];
        own.name[own.columns] = table->name[k] + (lifts ? strlen(prefix) : 0);
        own.column[own.columns++] = table->column[k];
    }
    return own;
}

/* Of a file, or of rows (`path` NULL), whose columns can be but right. */
static void find_motion_columns(struct scree_reader *r, const char *path, const struct scree_table *table, int *at) {
    scree_find_columns(r, path, table, motion_columns, MOTION_COLUMNS,
                       "a motion table: it has time_s, position_m (or position_rad) and, if wanted, velocity_m_s, "
                       "acceleration_m_s2 and jerk_m_s3 (or …_rad_…), in these units",
                       at);
    if (at[ANGLE] >= 0)
        scree_complain_in_table(r, path, table->header, table->at[at[ANGLE]],
                                "a table over the machine's angle is no motion over the time: [servo] angle = "
                                "false writes one that is");
    if (at[TIME] < 0 || at[POSITION] < 0)
        scree_complain_in_table(r, path, table->header, 1,
                                "the table needs the columns time_s and position_m (or position_rad)");
    for (int m = ACCELERATION; m <= JERK; m++)
        if (at[m] >= 0 && at[m - 1] < 0)
            scree_complain_in_table(r, path, table->header, 1, "the %s of a motion counts only beside its %s",
                                    motion_columns[m].names[0], motion_columns[m - 1].names[0]);
    if (path && table->rows < 2)
        scree_complain_in_table(r, path, 0, 0, "a motion needs at least 2 rows of numbers, this table has %zu",
                                table->rows);
}

/* The unit that a column's name tells. */
static enum scree_motion_unit unit_of(const char *name) {
    for (int m = POSITION; m <= JERK; m++)
        for (int unit = SCREE_METRES; unit <= SCREE_RADIANS; unit++)
            if (strcmp(name, motion_columns[m].names[unit]) == 0) return (enum scree_motion_unit)unit;
    return SCREE_ANY_UNIT;
}

/* That of all columns; a mixture is refused. */
static enum scree_motion_unit unit_of_columns(struct scree_reader *r, const char *path,
                                              const struct scree_table *table) {
    enum scree_motion_unit unit = SCREE_ANY_UNIT;
    for (int k = 0; k < table->columns && !r->status; k++) {
        enum scree_motion_unit own = unit_of(table->name[k]);
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
    static const char *const names[] = {"time", "position", "velocity", "acceleration", "jerk", NULL};
    if (!file)
        scree_read_rows(r, rows, names, 2, "[time, position] and, if wanted, velocity, acceleration and jerk", columns);
    if (!file && !r->status) check_times(r, rows, columns);
    int at[MOTION_COLUMNS];
    struct scree_table own = axis_of(columns, lift);
    if (!r->status) find_motion_columns(r, path, &own, at);
    if (!r->status) *unit = unit_of_columns(r, path, &own);
    free(path);
    if (r->status) return;
    def->rows = columns->rows;
    def->times = scree_table_column(&own, at[TIME]);
    def->positions = scree_table_column(&own, at[POSITION]);
    def->velocities = scree_table_column(&own, at[VELOCITY]);
    def->accelerations = scree_table_column(&own, at[ACCELERATION]);
    def->jerks = scree_table_column(&own, at[JERK]);
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
    if (!kind) scree_check_misspelt(r, table, "[[motion]]", "kind");
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
