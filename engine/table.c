/* Tables of numbers in CSV. */
#include "engine/table.h"

#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

/* What the functions below share while one table is read. */
struct reader {
    const char *file, *rising;
    const char *const *words; /* columns that aren't numbers; NULL: none */
    char *rest;               /* of the text */
    int line;
    const char *line_start;
    struct scree_table *table;
    scree_trouble *trouble;
};

SCREE_PRINTF(3, 4)
static scree_status complain(const struct reader *r, const char *at, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    scree_report_at(r->trouble, SCREE_BAD_INPUT, r->file, r->line, (int)(at - r->line_start) + 1, format, arguments);
    va_end(arguments);
    return SCREE_BAD_INPUT;
}

/* Next line of the text, NULL at its end; cuts it off in place. */
static char *next_line(struct reader *r) {
    char *start = r->rest;
    if (!*start) return NULL;
    char *end = start + strcspn(start, "\n");
    r->rest = *end ? end + 1 : end;
    *end = '\0';
    if (end > start && end[-1] == '\r') end[-1] = '\0';
    r->line++;
    r->line_start = start;
    return start;
}

static int is_comment(const char *line) {
    line += strspn(line, " \t");
    return *line == '#' || *line == '\0';
}

/* Take the quotes off a cell that is quoted as a whole, in place (RFC 4180); where it ends, NULL if it isn't quoted
 * so. */
static char *unquote(char *cell) {
    char *to = cell, *close = cell + 1;
    if (*cell != '"') return NULL;
    while (*close && (close[0] != '"' || close[1] == '"')) close += *close == '"' ? 2 : 1;
    if (!*close) return NULL;
    char *end = close + 1 + strspn(close + 1, " \t");
    if (*end && *end != ',') return NULL;
    for (const char *from = cell + 1; from < close; from++) {
        if (*from == '"') from++;
        *to++ = *from;
    }
    *to = '\0';
    return end;
}

/* Cut off the next cell of a line, without the blanks and the quotes around it; NULL behind the last. `odd`: it begins
 * with a quote and doesn't end with one. */
static char *next_cell(char **line, int *odd) {
    char *cell = *line;
    if (!cell) return NULL;
    cell += strspn(cell, " \t");
    int begins = *cell == '"';
    char *quoted = unquote(cell), *end = quoted ? quoted : cell + strcspn(cell, ",");
    *odd = begins && !quoted;
    *line = *end ? end + 1 : NULL;
    if (quoted) return cell;
    *end = '\0';
    while (end > cell && (end[-1] == ' ' || end[-1] == '\t')) *--end = '\0';
    return cell;
}

/* A column is called `word` if that is its name, or its name up to the unit. */
static int is_called(const char *name, const char *word) {
    size_t length = strlen(word);
    return strncmp(name, word, length) == 0 && (name[length] == '\0' || name[length] == '_');
}

static const char odd_quotes[] = "%s: a quote that isn't closed, or closed before the cell's end";

static scree_status parse_header(struct reader *r, char *line) {
    struct scree_table *table = r->table;
    table->header = r->line;
    int odd;
    for (char *name; (name = next_cell(&line, &odd));) {
        if (odd) return complain(r, name, odd_quotes, name);
        if (table->columns == SCREE_TABLE_COLUMNS)
            return complain(r, name, "more than %d columns", SCREE_TABLE_COLUMNS);
        if (!*name || strchr("+-.0123456789", *name))
            return complain(r, name,
                            "expected a header that names the columns, such as \"time_s,position_m\" or \"x,y,z\"");
        if (strchr(name, ';')) return complain(r, name, "\"%s\": columns are separated by commas", name);
        for (int k = 0; k < table->columns; k++)
            if (strcmp(table->name[k], name) == 0) return complain(r, name, "there are two columns \"%s\"", name);
        table->at[table->columns] = (int)(name - r->line_start) + 1;
        table->name[table->columns] = strdup(name);
        if (!table->name[table->columns])
            return scree_report(r->trouble, SCREE_NO_MEMORY, NULL, "no memory for a table");
        table->columns++;
    }
    return SCREE_OK;
}

/* Digits, point, sign and exponent: neither hexadecimal nor infinite nor "nan". */
static int parse_number(const char *cell, double *value) {
    char *end;
    *value = strtod(cell, &end);
    return *cell && !*end && cell[strspn(cell, "+-.0123456789eE")] == '\0' && *value - *value == 0.0;
}

static scree_status parse_row(struct reader *r, char *line) {
    struct scree_table *table = r->table;
    int k = 0, odd;
    for (char *cell; (cell = next_cell(&line, &odd)); k++) {
        if (odd) return complain(r, cell, odd_quotes, cell);
        if (k == table->columns)
            return complain(r, cell, "wrong number of columns: expected %d (%s …)", table->columns, table->name[0]);
        double *column = table->column[k];
        if (!column) {
            table->word[k][table->rows] = cell;
            continue;
        }
        if (!parse_number(cell, &column[table->rows]))
            return complain(r, cell, "\"%s\" is no number; expected a finite decimal one for %s", cell, table->name[k]);
        if (r->rising && table->rows > 0 && is_called(table->name[k], r->rising) &&
            !(column[table->rows] > column[table->rows - 1]))
            return complain(r, cell, "%s must increase: %.9g after %.9g", table->name[k], column[table->rows],
                            column[table->rows - 1]);
    }
    if (k < table->columns)
        return complain(r, r->line_start, "wrong number of columns: %d, expected %d (%s …)", k, table->columns,
                        table->name[0]);
    if (table->row) table->row[table->rows] = (struct scree_table_row){r->line, r->line_start};
    table->rows++;
    return SCREE_OK;
}

static size_t count_lines(const char *text) {
    size_t lines = 1;
    for (; *text; text++) lines += *text == '\n';
    return lines;
}

/* A NUL would end the text for the functions below: say where it is. */
static scree_status check_no_nul(struct reader *r, size_t size) {
    const char *end = r->rest + strlen(r->rest), *c = r->rest;
    if (end == r->rest + size) return SCREE_OK;
    r->line = 1;
    for (r->line_start = c; c < end; c++) {
        if (*c != '\n') continue;
        r->line++;
        r->line_start = c + 1;
    }
    return complain(r, end, "this is no text: a byte 0");
}

static int is_word(const struct reader *r, const char *name) {
    for (const char *const *word = r->words; word && *word; word++)
        if (strcmp(*word, name) == 0) return 1;
    return 0;
}

/* Room for so many rows. */
static scree_status make_columns(struct reader *r, size_t rows) {
    struct scree_table *table = r->table;
    int ok = 1;
    if (r->words) ok = (table->row = malloc(rows * sizeof *table->row)) != NULL;
    for (int k = 0; k < table->columns; k++) {
        if (is_word(r, table->name[k]))
            ok = ok && (table->word[k] = malloc(rows * sizeof *table->word[k])) != NULL;
        else
            ok = ok && (table->column[k] = malloc(rows * sizeof *table->column[k])) != NULL;
    }
    return ok ? SCREE_OK : scree_report(r->trouble, SCREE_NO_MEMORY, NULL, "no memory for a table");
}

static scree_status parse_lines(struct reader *r) {
    struct scree_table *table = r->table;
    size_t most = count_lines(r->rest);
    scree_status status = SCREE_OK;
    for (char *line; !status && (line = next_line(r));) {
        if (is_comment(line)) continue;
        if (table->columns > 0) {
            status = parse_row(r, line);
            continue;
        }
        status = parse_header(r, line);
        if (!status) status = make_columns(r, most);
    }
    if (!status && table->columns == 0)
        status = scree_report(r->trouble, SCREE_BAD_INPUT, NULL, "%s: this table is empty", r->file);
    return status;
}

static scree_status parse(struct reader *r, size_t size) {
    const char *text = r->rest;
    *r->table = (struct scree_table){0};
    scree_status status = check_no_nul(r, size);
    r->line = 0;
    if (size >= 3 && memcmp(text, "\xef\xbb\xbf", 3) == 0) r->rest += 3;
    if (!status) status = parse_lines(r);
    if (status) scree_table_free(r->table);
    return status;
}

scree_status scree_table_parse(char *text, size_t size, const char *file, const char *rising, struct scree_table *table,
                               scree_trouble *trouble) {
    struct reader r = {.file = file, .rising = rising, .rest = text, .table = table, .trouble = trouble};
    return parse(&r, size);
}

scree_status scree_table_parse_words(char *text, size_t size, const char *file, const char *const *words,
                                     struct scree_table *table, scree_trouble *trouble) {
    struct reader r = {.file = file, .words = words, .rest = text, .table = table, .trouble = trouble};
    return parse(&r, size);
}

void scree_table_free(struct scree_table *table) {
    for (int k = 0; k < SCREE_TABLE_COLUMNS; k++) {
        free(table->name[k]);
        free(table->column[k]);
        free(table->word[k]);
    }
    free(table->row);
    *table = (struct scree_table){0};
}

const double *scree_table_column(const struct scree_table *table, int column) {
    return column < 0 ? NULL : table->column[column];
}
