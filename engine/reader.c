/* Typed access to the tables of a TOML file, with messages that name file, line and column. */
#include "engine/reader.h"

#include "engine/c_locale.h"
#include "engine/file.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- messages ---- */

SCREE_PRINTF(3, 4)
void scree_complain(struct scree_reader *r, const struct scree_toml *node, const char *format, ...) {
    va_list arguments;
    char name[1024];
    if (r->status) return;
    if (node && node->set) snprintf(name, sizeof name, "%.700s with %.300s", r->name, node->set);
    va_start(arguments, format);
    r->status = scree_report_at(r->trouble, SCREE_BAD_INPUT, node && node->set ? name : r->name, node ? node->line : 0,
                                node ? node->column : 0, format, arguments);
    va_end(arguments);
}

/* ---- the whole file ---- */

scree_status scree_read_toml(const char *path, const char *const *assignments, int count, scree_read_root *read,
                             void *into, scree_trouble *trouble) {
    size_t size;
    char *text = scree_read_file(path, SCREE_TOML_LARGEST, &size, trouble);
    if (!text) return trouble->status;
    struct scree_reader r = {.name = strcmp(path, "-") ? path : "standard input", .trouble = trouble, .into = into};
    struct scree_toml_document document;
    struct scree_c_locale locale = scree_enter_c_locale();
    r.status = scree_toml_parse(text, size, r.name, &document, trouble);
    for (int k = 0; k < count && !r.status; k++) r.status = scree_toml_set(&document, assignments[k], trouble);
    r.root = document.root;
    if (!r.status) read(&r);
    scree_toml_free(&document);
    scree_leave_c_locale(locale);
    free(text);
    return r.status;
}

/* ---- typed access ---- */

static int is_among(const char *key, const char *const *keys) {
    while (*keys && strcmp(*keys, key) != 0) keys++;
    return *keys != NULL;
}

/* The command that a file is for, told by a key that this one doesn't know; NULL: by none. */
static const char *command_for(const struct scree_toml *root, const char *const *keys) {
    static const char *const own[][2] = {
        {"transport", "plan"}, {"drive", "plan"},   {"parameter", "fit"}, {"experiment", "fit"}, {"gravity", "run"},
        {"time", "run"},       {"material", "run"}, {"contact", "run"},   {"spheres", "run"},    {"generate", "run"}};
    for (const struct scree_toml *child = root->first; child; child = child->next)
        for (size_t k = 0; !is_among(child->key, keys) && k < sizeof own / sizeof *own; k++)
            if (strcmp(child->key, own[k][0]) == 0) return own[k][1];
    return NULL;
}

static void complain_of_key(struct scree_reader *r, const struct scree_toml *child, const char *what,
                            const char *advice) {
    struct scree_toml at = *child;
    if (child->key_column) at.column = child->key_column;
    scree_complain(r, &at, "unknown key \"%s\" in %s%s", child->key, what, advice);
}

/* Every key of `table` is one of `keys` (NULL-terminated). */
void scree_check_keys(struct scree_reader *r, const struct scree_toml *table, const char *what,
                      const char *const *keys) {
    const char *command = table == r->root ? command_for(table, keys) : NULL;
    char other[64] = "";
    if (command) snprintf(other, sizeof other, "; this looks like a file for scree %s", command);
    for (const struct scree_toml *child = table->first; child; child = child->next)
        if (!is_among(child->key, keys))
            complain_of_key(r, child, what, command ? other : scree_hint_or_all(child->key, keys).text);
}

void scree_check_misspelt(struct scree_reader *r, const struct scree_toml *table, const char *what, const char *key) {
    const char *const keys[] = {key, NULL};
    for (const struct scree_toml *child = table->first; child; child = child->next)
        if (scree_nearest_name(child->key, keys)) complain_of_key(r, child, what, scree_hint(child->key, keys).text);
}

static int is_number(const struct scree_toml *node) {
    return node->type == SCREE_TOML_INTEGER || node->type == SCREE_TOML_FLOAT;
}

double scree_number_of(struct scree_reader *r, const struct scree_toml *node, const char *what) {
    if (!is_number(node)) {
        scree_complain(r, node, "%s must be a number, not %s", what, scree_toml_type_name(node->type));
        return 0.0;
    }
    if (!isfinite(node->number)) scree_complain(r, node, "%s must be a finite number", what);
    return node->number;
}

double scree_read_number(struct scree_reader *r, const struct scree_toml *table, const char *key, double fallback) {
    const struct scree_toml *node = scree_toml_get(table, key);
    return node ? scree_number_of(r, node, key) : fallback;
}

double scree_read_whole(struct scree_reader *r, const struct scree_toml *table, const char *key, double least,
                        double most) {
    const struct scree_toml *node = scree_toml_get(table, key);
    double value = node ? scree_number_of(r, node, key) : 0.0;
    if (node && !(value >= least && value <= most && value == floor(value)))
        scree_complain(r, node, "%s must be a whole number, %.0f to %.0f, got %g", key, least, most, value);
    return r->status ? 0.0 : value;
}

const char *scree_read_string(struct scree_reader *r, const struct scree_toml *table, const char *key) {
    const struct scree_toml *node = scree_toml_get(table, key);
    if (!node) return NULL;
    if (node->type == SCREE_TOML_STRING) return node->string;
    scree_complain(r, node, "%s must be a string, not %s", key, scree_toml_type_name(node->type));
    return NULL;
}

int scree_read_boolean(struct scree_reader *r, const struct scree_toml *table, const char *key) {
    const struct scree_toml *node = scree_toml_get(table, key);
    if (!node) return 0;
    if (node->type != SCREE_TOML_BOOLEAN)
        scree_complain(r, node, "%s must be true or false, not %s", key, scree_toml_type_name(node->type));
    return node->number != 0.0;
}

/* Array of exactly `count` numbers; returns 1 if the key is there. */
int scree_read_numbers(struct scree_reader *r, const struct scree_toml *table, const char *key, int count, double *to) {
    const struct scree_toml *node = scree_toml_get(table, key);
    if (!node) return 0;
    if (node->type != SCREE_TOML_ARRAY || node->count != count) {
        scree_complain(r, node, "%s must be an array of %d numbers", key, count);
        return 1;
    }
    int k = 0;
    for (const struct scree_toml *value = node->first; value; value = value->next)
        to[k++] = scree_number_of(r, value, key);
    return 1;
}

/* A table by key, NULL if it isn't there or is no table (which is reported). */
const struct scree_toml *scree_read_table(struct scree_reader *r, const struct scree_toml *table, const char *key) {
    const struct scree_toml *node = scree_toml_get(table, key);
    if (!node || node->type == SCREE_TOML_TABLE) return node;
    scree_complain(r, node, "%s must be a table, not %s", key, scree_toml_type_name(node->type));
    return NULL;
}

/* Call `read` for each entry of an array of tables. */
void scree_read_each(struct scree_reader *r, const struct scree_toml *root, const char *key,
                     void (*read)(struct scree_reader *, const struct scree_toml *)) {
    const struct scree_toml *array = scree_toml_get(root, key);
    if (!array) return;
    if (array->type != SCREE_TOML_ARRAY) {
        scree_complain(r, array, "%s must be an array of tables: write [[%s]]", key, key);
        return;
    }
    for (const struct scree_toml *entry = array->first; entry && !r->status; entry = entry->next) {
        if (entry->type != SCREE_TOML_TABLE)
            scree_complain(r, entry, "an entry of %s must be a table, not %s", key, scree_toml_type_name(entry->type));
        else
            read(r, entry);
    }
}

/* Index of `text` among NULL-terminated words, or 0 with a complaint. */
int scree_choose(struct scree_reader *r, const struct scree_toml *node, const char *what, const char *const *words) {
    for (int k = 0; node->type == SCREE_TOML_STRING && words[k]; k++)
        if (strcmp(words[k], node->string) == 0) return k;
    char list[256] = "";
    for (int k = 0; words[k]; k++)
        snprintf(list + strlen(list), sizeof list - strlen(list), "%s\"%s\"", k ? ", " : "", words[k]);
    scree_complain(r, node, "%s must be one of %s%s", what, list,
                   node->type == SCREE_TOML_STRING ? scree_hint(node->string, words).text : "");
    return 0;
}

/* ---- tables of numbers ---- */

/* Path of a file named in the file: relative to its folder. To be freed. */
static char *beside_file(const struct scree_reader *r, const char *file) {
    const char *slash = strrchr(r->name, '/');
    size_t folder = slash && file[0] != '/' ? (size_t)(slash - r->name) + 1 : 0;
    char *path = malloc(folder + strlen(file) + 1);
    if (!path) return NULL;
    memcpy(path, r->name, folder);
    memcpy(path + folder, file, strlen(file) + 1);
    return path;
}

char *scree_read_path_beside(struct scree_reader *r, const struct scree_toml *node) {
    if (!node->string[0] || strcmp(node->string, "-") == 0) {
        scree_complain(r, node, "%s must name a file (standard input can't be one)", node->key);
        return NULL;
    }
    char *path = beside_file(r, node->string);
    if (!path) r->status = scree_report(r->trouble, SCREE_NO_MEMORY, NULL, "no memory");
    return path;
}

void scree_tell_place(struct scree_reader *r, const struct scree_toml *node) {
    scree_trouble cause = *r->trouble;
    scree_complain(r, node, "%s", cause.text);
    r->status = r->trouble->status = cause.status;
}

char *scree_read_file_beside(struct scree_reader *r, const struct scree_toml *node, size_t largest, char **text,
                             size_t *size) {
    char *path = scree_read_path_beside(r, node);
    *text = path ? scree_read_file(path, largest, size, r->trouble) : NULL;
    if (path && !*text) scree_tell_place(r, node);
    if (*text && r->beside) r->status = scree_add_path(r->beside, path, r->trouble);
    if (!r->status) return path;
    free(path);
    return NULL;
}

enum { LARGEST_TABLE = 1 << 30 };

char *scree_read_table_file(struct scree_reader *r, const struct scree_toml *node, const char *rising,
                            struct scree_table *table) {
    char *text = NULL;
    size_t size = 0;
    char *path = scree_read_file_beside(r, node, LARGEST_TABLE, &text, &size);
    if (path) r->status = scree_table_parse(text, size, path, rising, table, r->trouble);
    free(text);
    if (!r->status) return path;
    free(path);
    return NULL;
}

char *scree_read_word_file(struct scree_reader *r, const struct scree_toml *node, const char *const *words,
                           struct scree_table *table, char **text) {
    size_t size = 0;
    *text = NULL;
    char *path = scree_read_file_beside(r, node, LARGEST_TABLE, text, &size);
    if (path) r->status = scree_table_parse_words(*text, size, path, words, table, r->trouble);
    if (!r->status) return path;
    free(path);
    return NULL;
}

SCREE_PRINTF(5, 6)
void scree_complain_in_table(struct scree_reader *r, const char *path, int line, int column, const char *format, ...) {
    va_list arguments;
    if (r->status) return;
    va_start(arguments, format);
    r->status = scree_report_at(r->trouble, SCREE_BAD_INPUT, path, line, column, format, arguments);
    va_end(arguments);
}

static int is_named(const struct scree_column *column, const char *name) {
    for (int n = 0; n < 3 && column->names[n]; n++)
        if (strcmp(column->names[n], name) == 0) return 1;
    return 0;
}

void scree_find_columns(struct scree_reader *r, const char *path, const struct scree_table *table,
                        const struct scree_column *known, int count, const char *what, int *at) {
    const char *all[3 * SCREE_TABLE_COLUMNS + 1] = {0};
    for (int c = 0, names = 0; c < count; c++) {
        at[c] = -1;
        for (int n = 0; n < 3 && known[c].names[n]; n++) all[names++] = known[c].names[n];
    }
    for (int k = 0; k < table->columns; k++) {
        const char *name = table->name[k];
        int c = 0;
        while (c < count && !is_named(&known[c], name)) c++;
        if (c < count && at[c] < 0)
            at[c] = k;
        else if (c < count)
            scree_complain_in_table(r, path, table->header, table->at[k], "two columns for %s", known[c].names[0]);
        else if (what)
            scree_complain_in_table(r, path, table->header, table->at[k], "there is no column \"%s\" in %s%s", name,
                                    what, scree_hint(name, all).text);
    }
}

void scree_read_rows(struct scree_reader *r, const struct scree_toml *rows, const char *const *names, int least,
                     const char *what, struct scree_table *table) {
    int columns = rows->first && rows->first->type == SCREE_TOML_ARRAY ? rows->first->count : 0, most = 0;
    while (names[most]) most++;
    if (rows->type != SCREE_TOML_ARRAY || columns < least || columns > most) {
        scree_complain(r, rows, "rows must be an array of rows %s", what);
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
            scree_complain(r, row, "this row must have %d numbers like the first", columns);
            return;
        }
        int k = 0;
        for (const struct scree_toml *cell = row->first; cell; cell = cell->next, k++)
            table->column[k][table->rows] = scree_number_of(r, cell, names[k]);
        table->rows++;
    }
}
