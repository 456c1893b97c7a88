/* A fit file: the task that `scree fit` works on. */
#include "engine/cli/fit_file.h"

#include "engine/reader.h"
#include "solver/lm.h"

#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const char *const fit_quantity_name[FIT_QUANTITIES + 1] = {"x_m",    "y_m",      "z_m",      "vx_m_s",   "vy_m_s",
                                                           "vz_m_s", "wx_rad_s", "wy_rad_s", "wz_rad_s", NULL};

enum { MOST_CHANGES = 256 };

static void out_of_memory(struct scree_reader *r) {
    if (!r->status) r->status = scree_report(r->trouble, SCREE_NO_MEMORY, NULL, "no memory for a fit");
}

static char *copy_of(struct scree_reader *r, const char *text) {
    char *copy = strdup(text);
    if (!copy) out_of_memory(r);
    return copy;
}

/* ---- parameters ---- */

static int is_word(char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-';
}

const char *fit_next_place(const char *text, size_t *length) {
    for (const char *brace = strchr(text, '{'); brace; brace = strchr(brace + 1, '{')) {
        *length = 0;
        while (is_word(brace[1 + *length])) ++*length;
        if (*length > 0 && brace[1 + *length] == '}') return brace;
    }
    return NULL;
}

int fit_find_parameter(const struct fit_file *file, const char *name, size_t length) {
    for (int k = 0; k < file->parameters; k++)
        if (strlen(file->parameter[k].name) == length && strncmp(file->parameter[k].name, name, length) == 0) return k;
    return -1;
}

static struct scree_hint parameter_hint(const struct fit_file *file, const char *wrong) {
    const char *names[SCREE_LM_UNKNOWNS + 1] = {0};
    for (int k = 0; k < file->parameters; k++) names[k] = file->parameter[k].name;
    return scree_hint(wrong, names);
}

static void read_parameter(struct scree_reader *r, const struct scree_toml *table, struct fit_parameter *parameter) {
    static const char *const keys[] = {"start", "min", "max", "difference", NULL};
    const char *name = table->key;
    if (table->type != SCREE_TOML_TABLE) {
        scree_complain(r, table, "a parameter is a table, as in %s = { start = 0.3, min = 0 }, not %s", name,
                       scree_toml_type_name(table->type));
        return;
    }
    scree_check_keys(r, table, "a parameter", keys);
    size_t length = 0;
    while (is_word(name[length])) length++;
    if (name[length] || !length)
        scree_complain(r, table, "the name of a parameter has letters, digits, - and _ alone, so that {name} is it");
    if (!scree_toml_get(table, "start")) scree_complain(r, table, "the parameter \"%s\" needs start = …", name);
    *parameter = (struct fit_parameter){.name = copy_of(r, name),
                                        .start = scree_read_number(r, table, "start", 0.0),
                                        .low = scree_read_number(r, table, "min", -HUGE_VAL),
                                        .high = scree_read_number(r, table, "max", HUGE_VAL),
                                        .difference = scree_read_number(r, table, "difference", 0.0)};
    const struct scree_toml *difference = scree_toml_get(table, "difference");
    if (!(parameter->low < parameter->high))
        scree_complain(r, table, "\"%s\": min must be below max, got %g and %g", name, parameter->low, parameter->high);
    if (!(parameter->start >= parameter->low && parameter->start <= parameter->high))
        scree_complain(r, scree_toml_get(table, "start"), "\"%s\": start must be from min to max, got %g", name,
                       parameter->start);
    double above = parameter->start + parameter->difference, below = parameter->start - parameter->difference;
    if (difference && !(above > parameter->start && below < parameter->start))
        scree_complain(r, difference, "\"%s\": difference must be positive, and large enough to change %.17g; got %g",
                       name, parameter->start, parameter->difference);
    if (!difference && parameter->start == 0.0)
        scree_complain(r, table,
                       "\"%s\" starts at 0, which tells no size: it needs difference = …, over which derivatives are "
                       "taken",
                       name);
}

static void read_parameters(struct scree_reader *r, struct fit_file *f) {
    const struct scree_toml *table = scree_read_table(r, r->root, "parameter");
    if (!table || table->count < 1 || table->count > SCREE_LM_UNKNOWNS) {
        scree_complain(r, table, "a fit file needs parameters, 1 to %d: [parameter.NAME] with start = …",
                       SCREE_LM_UNKNOWNS);
        return;
    }
    f->parameter = calloc((size_t)table->count, sizeof *f->parameter);
    if (!f->parameter) out_of_memory(r);
    for (const struct scree_toml *entry = table->first; entry && !r->status; entry = entry->next)
        read_parameter(r, entry, &f->parameter[f->parameters++]);
}

/* ---- records ---- */

/* A record while it is read. */
struct record {
    struct scree_table table;
    char *path, *text;
    int time, body;            /* columns of the table; body -1: none */
    int at[FIT_QUANTITIES];    /* the same of each quantity; -1: not there, or not to be fitted */
    char want[FIT_QUANTITIES]; /* by `columns`; */
    int chosen;                /* which are given */
};

static void read_chosen(struct scree_reader *r, const struct scree_toml *list, struct record *record) {
    record->chosen = list != NULL;
    if (!list) return;
    if (list->type != SCREE_TOML_ARRAY || list->count < 1) {
        scree_complain(r, list, "columns must be an array of names, such as [\"x_m\"]");
        return;
    }
    for (const struct scree_toml *entry = list->first; entry; entry = entry->next)
        record->want[scree_choose(r, entry, "a column to be fitted", fit_quantity_name)] = 1;
}

/* Where the table has what; columns that aren't known are left alone if those to be fitted are named. */
static void find_columns(struct scree_reader *r, struct record *record) {
    enum { TIME, BODY, FIRST, COLUMNS = FIRST + FIT_QUANTITIES };
    struct scree_column known[COLUMNS] = {{{"time_s"}}, {{"body"}}};
    int at[COLUMNS];
    for (int q = 0; q < FIT_QUANTITIES; q++) known[FIRST + q].names[0] = fit_quantity_name[q];
    scree_find_columns(r, record->path, &record->table, known, COLUMNS,
                       record->chosen ? NULL
                                      : "a record: it has time_s and, of its body, x_m …, vx_m_s …, wx_rad_s …; name "
                                        "those to be fitted in columns = […] to leave others alone",
                       at);
    record->time = at[TIME];
    record->body = at[BODY];
    for (int q = 0; q < FIT_QUANTITIES; q++) record->at[q] = !record->chosen || record->want[q] ? at[FIRST + q] : -1;
}

static void check_columns(struct scree_reader *r, const struct record *record) {
    int line = record->table.header, found = 0;
    if (record->time < 0) scree_complain_in_table(r, record->path, line, 1, "a record needs a column time_s");
    for (int q = 0; q < FIT_QUANTITIES; q++) {
        found += record->at[q] >= 0;
        if (record->want[q] && record->at[q] < 0)
            scree_complain_in_table(r, record->path, line, 1, "this record has no column %s", fit_quantity_name[q]);
    }
    if (!found) scree_complain_in_table(r, record->path, line, 1, "a record needs a column such as x_m");
}

/* Take over the rows of the experiment's body. */
static void take_rows(struct scree_reader *r, const struct record *record, struct fit_experiment *e) {
    const struct scree_table *table = &record->table;
    e->time = malloc((table->rows + 1) * sizeof(double));
    if (!e->time) out_of_memory(r);
    for (int q = 0; q < FIT_QUANTITIES; q++) {
        if (record->at[q] < 0) continue;
        e->quantity[e->columns] = q;
        e->reading[e->columns] = malloc((table->rows + 1) * sizeof(double));
        if (!e->reading[e->columns++]) out_of_memory(r);
    }
    for (size_t k = 0; k < table->rows && !r->status; k++) {
        if (record->body >= 0 && strcmp(table->word[record->body][k], e->body) != 0) continue;
        double time = table->column[record->time][k];
        if (e->rows > 0 && !(time > e->time[e->rows - 1]))
            scree_complain_in_table(r, record->path, table->row[k].line, 1, "times must rise: %.17g s after %.17g s",
                                    time, e->time[e->rows - 1]);
        e->time[e->rows] = time;
        for (int c = 0; c < e->columns; c++) e->reading[c][e->rows] = table->column[record->at[e->quantity[c]]][k];
        e->rows++;
    }
    if (!r->status && e->rows == 0)
        scree_complain_in_table(r, record->path, 0, 0, record->body < 0 ? "no rows" : "no rows of \"%s\"", e->body);
}

static void read_record(struct scree_reader *r, const struct scree_toml *table, const struct scree_toml *columns,
                        struct fit_experiment *e) {
    static const char *const words[] = {"body", NULL};
    const struct scree_toml *node = scree_toml_get(table, "record");
    struct record record = {.path = NULL};
    if (!scree_read_string(r, table, "record"))
        scree_complain(r, table, "an experiment needs record = \"….csv\", what was measured");
    read_chosen(r, columns, &record);
    if (r->status) return;
    record.path = e->record = scree_read_word_file(r, node, words, &record.table, &record.text);
    if (!r->status) find_columns(r, &record);
    if (!r->status) check_columns(r, &record);
    if (!r->status) take_rows(r, &record, e);
    scree_table_free(&record.table);
    free(record.text);
}

/* deviation = { x_m = 1e-5, … }; returns how many of the columns have one. */
static int read_deviations(struct scree_reader *r, const struct scree_toml *table, struct fit_experiment *e) {
    int given = 0;
    for (int c = 0; c < e->columns; c++) e->deviation[c] = 1.0;
    if (!table) return 0;
    if (table->type != SCREE_TOML_TABLE) {
        scree_complain(r, table, "deviation must be a table such as { x_m = 1e-5 }, not %s",
                       scree_toml_type_name(table->type));
        return 0;
    }
    scree_check_keys(r, table, "deviation", fit_quantity_name);
    for (const struct scree_toml *node = table->first; node && !r->status; node = node->next)
        if (!(scree_number_of(r, node, node->key) > 0.0))
            scree_complain(r, node, "the standard deviation of %s must be positive, got %g", node->key, node->number);
    for (int c = 0; c < e->columns; c++) {
        const struct scree_toml *node = scree_toml_get(table, fit_quantity_name[e->quantity[c]]);
        if (!node) continue;
        e->deviation[c] = node->number;
        given++;
    }
    if (!given && table->count > 0)
        scree_complain(r, table, "deviation names no column that is fitted; of %s there is %s", e->record,
                       fit_quantity_name[e->quantity[0]]);
    return given;
}

/* ---- experiments ---- */

/* A key of an experiment; where it isn't there, the one for all at the top of the file. */
static const struct scree_toml *find_for(const struct scree_reader *r, const struct scree_toml *table,
                                         const char *key) {
    const struct scree_toml *own = scree_toml_get(table, key);
    return own ? own : scree_toml_get(r->root, key);
}

static const char *string_for(struct scree_reader *r, const struct scree_toml *table, const char *key,
                              const char *what) {
    const struct scree_toml *node = find_for(r, table, key);
    if (node && node->type == SCREE_TOML_STRING) return node->string;
    if (node)
        scree_complain(r, node, "%s must be a string, not %s", key, scree_toml_type_name(node->type));
    else
        scree_complain(r, table, "an experiment needs %s = \"…\", %s", key, what);
    return NULL;
}

static void check_places(struct scree_reader *r, const struct scree_toml *node, const struct fit_file *f) {
    size_t length;
    for (const char *place = fit_next_place(node->string, &length); place;
         place = fit_next_place(place + length + 2, &length)) {
        char name[64];
        snprintf(name, sizeof name, "%.*s", (int)length, place + 1);
        if (fit_find_parameter(f, place + 1, length) < 0)
            scree_complain(r, node, "there is no parameter called \"%s\"%s", name, parameter_hint(f, name).text);
    }
}

/* set = ["key=value", …], those for all first. */
static void read_changes(struct scree_reader *r, const struct scree_toml *table, const struct fit_file *f,
                         struct fit_experiment *e) {
    const struct scree_toml *lists[2] = {scree_toml_get(r->root, "set"), scree_toml_get(table, "set")};
    int count = 0;
    for (int k = 0; k < 2; k++) {
        if (lists[k] && lists[k]->type != SCREE_TOML_ARRAY)
            scree_complain(r, lists[k], "set must be an array of changes to the scene, as in [\"time.end=2\"]");
        if (lists[k]) count += lists[k]->count;
    }
    if (count > MOST_CHANGES)
        scree_complain(r, table, "this experiment changes its scene %d times; the most is %d", count, MOST_CHANGES);
    e->change = calloc((size_t)count + 1, sizeof *e->change);
    if (!e->change) out_of_memory(r);
    for (int k = 0; k < 2; k++)
        for (const struct scree_toml *entry = lists[k] ? lists[k]->first : NULL; entry && !r->status;
             entry = entry->next) {
            if (entry->type != SCREE_TOML_STRING || !strchr(entry->string, '=')) {
                scree_complain(r, entry,
                               "a change to the scene is a string such as \"time.end=2\", with a key and a value");
                return;
            }
            check_places(r, entry, f);
            e->change[e->changes++] = copy_of(r, entry->string);
        }
}

static void read_delay(struct scree_reader *r, const struct scree_toml *table, const struct fit_file *f,
                       struct fit_experiment *e) {
    const struct scree_toml *node = scree_toml_get(table, "delay");
    e->delay_parameter = -1;
    if (!node) return;
    if (node->type != SCREE_TOML_STRING) {
        e->delay = scree_number_of(r, node, "delay (s, or the name of a parameter)");
        return;
    }
    e->delay_parameter = fit_find_parameter(f, node->string, strlen(node->string));
    if (e->delay_parameter < 0)
        scree_complain(r, node, "there is no parameter called \"%s\"%s", node->string,
                       parameter_hint(f, node->string).text);
}

/* No later than the record begins: the scene isn't there before. */
static void bound_delay(struct scree_reader *r, const struct scree_toml *table, struct fit_file *f,
                        const struct fit_experiment *e) {
    if (e->delay_parameter < 0) return;
    struct fit_parameter *parameter = &f->parameter[e->delay_parameter];
    parameter->high = fmin(parameter->high, e->time[0]);
    if (!(parameter->start <= parameter->high && parameter->low < parameter->high))
        scree_complain(r, scree_toml_get(table, "delay"),
                       "\"%s\" must start at %g s or below, where %s begins, and min lie below that: the scene isn't "
                       "there before",
                       parameter->name, e->time[0], e->record);
}

static void read_experiment(struct scree_reader *r, const struct scree_toml *table) {
    static const char *const keys[] = {"scene", "body", "set", "record", "columns", "deviation", "delay", NULL};
    struct fit_file *f = r->into;
    struct fit_experiment *e = &f->experiment[f->experiments++];
    scree_check_keys(r, table, "[[experiment]]", keys);
    snprintf(e->place, sizeof e->place, "%s:%d:%d", r->name, table->line, table->column);
    string_for(r, table, "scene", "the scene file that simulates it");
    const char *body = string_for(r, table, "body", "the one that was measured");
    if (r->status) return;
    e->body = copy_of(r, body);
    const struct scree_toml *scene = find_for(r, table, "scene");
    if (!r->status) e->scene = scree_read_file_beside(r, scene, SCREE_TOML_LARGEST, &e->text, &e->size);
    if (!r->status) read_changes(r, table, f, e);
    if (!r->status) read_delay(r, table, f, e);
    if (!r->status) read_record(r, table, find_for(r, table, "columns"), e);
    if (r->status) return;
    bound_delay(r, table, f, e);
    int given = read_deviations(r, find_for(r, table, "deviation"), e);
    if (f->experiments == 1) f->weighted = given > 0;
    if (!r->status && given != (f->weighted ? e->columns : 0))
        scree_complain(r, table,
                       "deviation must say the standard deviation of every fitted column of all records, or "
                       "of none");
    f->readings += e->rows * (size_t)e->columns;
}

/* Without deviations all readings count alike, so they must be of one kind. */
static void check_kinds(struct scree_reader *r, const struct fit_file *f) {
    int first = f->experiment[0].quantity[0];
    for (int k = 0; k < f->experiments && !f->weighted; k++)
        for (int c = 0; c < f->experiment[k].columns; c++)
            if (f->experiment[k].quantity[c] / 3 != first / 3)
                scree_complain(r, NULL,
                               "%s and %s are of different kinds: deviation = { %s = …, %s = … } must say the standard "
                               "deviation of a reading, by which they are weighted",
                               fit_quantity_name[first], fit_quantity_name[f->experiment[k].quantity[c]],
                               fit_quantity_name[first], fit_quantity_name[f->experiment[k].quantity[c]]);
}

int fit_uses(const struct fit_file *file, int experiment, int parameter) {
    const struct fit_experiment *e = &file->experiment[experiment];
    size_t length;
    if (e->delay_parameter == parameter) return 1;
    for (int c = 0; c < e->changes; c++)
        for (const char *place = fit_next_place(e->change[c], &length); place;
             place = fit_next_place(place + length + 2, &length))
            if (fit_find_parameter(file, place + 1, length) == parameter) return 1;
    return 0;
}

static void check_use(struct scree_reader *r, const struct fit_file *f, int parameter) {
    const char *name = f->parameter[parameter].name;
    int used = 0;
    for (int k = 0; k < f->experiments; k++) used |= fit_uses(f, k, parameter);
    if (!used)
        scree_complain(r, scree_toml_get(scree_toml_get(r->root, "parameter"), name),
                       "the parameter \"%s\" changes nothing: {%s} must stand in a change of some experiment, as in "
                       "set = [\"contact.0.friction.kinetic={%s}\"]",
                       name, name, name);
}

static void read_experiments(struct scree_reader *r, struct fit_file *f) {
    const struct scree_toml *array = scree_toml_get(r->root, "experiment");
    if (!array || array->count < 1) {
        scree_complain(r, array, "a fit file needs [[experiment]] with scene, body, set and record");
        return;
    }
    f->experiment = calloc((size_t)array->count, sizeof *f->experiment);
    if (!f->experiment) out_of_memory(r);
    if (!r->status) scree_read_each(r, r->root, "experiment", read_experiment);
    if (!r->status) check_kinds(r, f);
    for (int k = 0; k < f->parameters && !r->status; k++) check_use(r, f, k);
    if (r->status) return;
    if (f->readings <= (size_t)f->parameters)
        scree_complain(r, NULL, "there must be more readings than parameters (readings: %zu, parameters: %d)",
                       f->readings, f->parameters);
    if (f->readings > INT_MAX || !scree_lm_workspace(f->parameters, (int)f->readings))
        scree_complain(r, NULL, "%zu readings are too many for %d parameters", f->readings, f->parameters);
}

static void read_root(struct scree_reader *r) {
    static const char *const keys[] = {"title", "confidence", "parameter", "experiment", "scene",
                                       "body",  "set",        "columns",   "deviation",  NULL};
    struct fit_file *f = r->into;
    scree_check_keys(r, r->root, "the fit file", keys);
    const char *title = scree_read_string(r, r->root, "title");
    f->title = copy_of(r, title ? title : "");
    f->confidence = scree_read_number(r, r->root, "confidence", 0.95);
    if (!(f->confidence > 0.0 && f->confidence < 1.0))
        scree_complain(r, scree_toml_get(r->root, "confidence"), "confidence must be between 0 and 1, got %g",
                       f->confidence);
    if (!r->status) read_parameters(r, f);
    if (!r->status) read_experiments(r, f);
}

scree_status fit_file_read(const char *path, const char *const *assignments, int count, struct fit_file *file,
                           scree_trouble *trouble) {
    *file = (struct fit_file){.title = NULL};
    return scree_read_toml(path, assignments, count, read_root, file, trouble);
}

void fit_file_free(struct fit_file *file) {
    for (int k = 0; k < file->parameters; k++) free(file->parameter[k].name);
    for (int k = 0; k < file->experiments; k++) {
        struct fit_experiment *e = &file->experiment[k];
        for (int c = 0; c < e->changes; c++) free(e->change[c]);
        for (int c = 0; c < e->columns; c++) free(e->reading[c]);
        free(e->scene);
        free(e->text);
        free(e->change);
        free(e->body);
        free(e->record);
        free(e->time);
    }
    free(file->title);
    free(file->parameter);
    free(file->experiment);
}
