/* Tables of numbers in CSV. */
#include "engine/table.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Next line of the text, NULL at its end; cuts it off in place. */
static char *next_line(char **rest, int *line) {
    char *start = *rest;
    if (!start || !*start) return NULL;
    char *end = start + strcspn(start, "\n");
    *rest = *end ? end + 1 : end;
    *end = '\0';
    if (end > start && end[-1] == '\r') end[-1] = '\0';
    (*line)++;
    return start;
}

static int is_comment(const char *line) {
    line += strspn(line, " \t");
    return *line == '#' || *line == '\0';
}

static char *trim(char *cell) {
    cell += strspn(cell, " \t");
    for (size_t k = strlen(cell); k > 0 && (cell[k - 1] == ' ' || cell[k - 1] == '\t'); k--) cell[k - 1] = '\0';
    return cell;
}

static scree_status parse_header(char *line, const char *file, int number, struct scree_table *table,
                                 scree_trouble *trouble) {
    for (char *cell = line, *comma; cell; cell = comma ? comma + 1 : NULL) {
        comma = strchr(cell, ',');
        if (comma) *comma = '\0';
        char *name = trim(cell);
        if (table->columns == SCREE_TABLE_COLUMNS)
            return scree_report(trouble, SCREE_BAD_INPUT, NULL, "%s:%d: more than %d columns", file, number,
                                SCREE_TABLE_COLUMNS);
        if (!*name || strchr("+-.0123456789", *name))
            return scree_report(trouble, SCREE_BAD_INPUT, NULL,
                                "%s:%d: expected a header that names the columns, such as \"time_s,position_m\"", file,
                                number);
        table->name[table->columns] = strdup(name);
        if (!table->name[table->columns]) return scree_report(trouble, SCREE_NO_MEMORY, NULL, "no memory for a table");
        table->columns++;
    }
    return SCREE_OK;
}

static scree_status parse_row(char *line, const char *file, int number, struct scree_table *table,
                              scree_trouble *trouble) {
    char *at = line;
    for (int k = 0; k < table->columns; k++) {
        char *end;
        double value = strtod(at, &end);
        int empty = end == at;
        end += strspn(end, " \t");
        int last = k + 1 == table->columns;
        if (empty || (*end != ',' && *end != '\0') || (last && *end == ',') || (!last && *end == '\0')) {
            const char *what = empty || (*end != ',' && *end != '\0') ? "this is no number" : "wrong number of columns";
            return scree_report(trouble, SCREE_BAD_INPUT, NULL, "%s:%d:%d: %s; expected %d numbers (%s …)", file,
                                number, (int)(at - line) + 1, what, table->columns, table->name[0]);
        }
        table->column[k][table->rows] = value;
        at = end + 1;
    }
    table->rows++;
    return SCREE_OK;
}

static size_t count_lines(const char *text) {
    size_t lines = 1;
    for (; *text; text++) lines += *text == '\n';
    return lines;
}

scree_status scree_table_parse(char *text, const char *file, struct scree_table *table, scree_trouble *trouble) {
    *table = (struct scree_table){0};
    size_t most = count_lines(text);
    int number = 0;
    char *line;
    scree_status status = SCREE_OK;
    while (!status && (line = next_line(&text, &number))) {
        if (is_comment(line)) continue;
        if (table->columns == 0) {
            status = parse_header(line, file, number, table, trouble);
            for (int k = 0; !status && k < table->columns; k++) {
                table->column[k] = malloc(most * sizeof(double));
                if (!table->column[k]) status = scree_report(trouble, SCREE_NO_MEMORY, NULL, "no memory for a table");
            }
        } else
            status = parse_row(line, file, number, table, trouble);
    }
    if (!status && table->columns == 0)
        status = scree_report(trouble, SCREE_BAD_INPUT, NULL, "%s: this table is empty", file);
    if (status) scree_table_free(table);
    return status;
}

void scree_table_free(struct scree_table *table) {
    for (int k = 0; k < SCREE_TABLE_COLUMNS; k++) {
        free(table->name[k]);
        free(table->column[k]);
    }
    *table = (struct scree_table){0};
}

const double *scree_table_column(const struct scree_table *table, const char *name) {
    size_t length = strlen(name);
    for (int k = 0; k < table->columns; k++)
        if (strncmp(table->name[k], name, length) == 0 &&
            (table->name[k][length] == '\0' || table->name[k][length] == '_'))
            return table->column[k];
    return NULL;
}
