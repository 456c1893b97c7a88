/* Tables of numbers in CSV: a header line that names the columns, then rows of decimal numbers. A byte order mark,
 * quotes around a cell, lines that begin with # and empty lines are skipped. */
#ifndef SCREE_ENGINE_TABLE_H
#define SCREE_ENGINE_TABLE_H

#include "bodies/trouble.h"

#include <stddef.h>

enum { SCREE_TABLE_COLUMNS = 32 };

/* Where a row stands: its line, and that line in the text. */
struct scree_table_row {
    int line;
    const char *begins;
};

/* Columns by name. Owns its memory. */
struct scree_table {
    int columns;
    size_t rows;
    int header;                          /* line of the header */
    int at[SCREE_TABLE_COLUMNS];         /* where each name begins on it, from 1 */
    char *name[SCREE_TABLE_COLUMNS];     /* as in the header, without blanks and quotes */
    double *column[SCREE_TABLE_COLUMNS]; /* rows entries; NULL for words */
    char **word[SCREE_TABLE_COLUMNS];    /* rows entries, which point into the text; NULL for numbers */
    struct scree_table_row *row;         /* NULL unless there may be words */
};

/* Parse `size` bytes of `text` (followed by a NUL; changed). `rising` names a column whose numbers must increase, NULL:
 * none. SCREE_BAD_INPUT names file, line and column of a bad cell. */
scree_status scree_table_parse(char *text, size_t size, const char *file, const char *rising, struct scree_table *table,
                               scree_trouble *trouble);

/* The same with columns of words, called as in the NULL-terminated list `words`. The text must outlive the table. */
scree_status scree_table_parse_words(char *text, size_t size, const char *file, const char *const *words,
                                     struct scree_table *table, scree_trouble *trouble);
void scree_table_free(struct scree_table *table);

/* The numbers of a column; NULL for -1, of one that isn't there. */
const double *scree_table_column(const struct scree_table *table, int column);

#endif
