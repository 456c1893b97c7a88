/* Checks for the tests: a failure prints both values, file and line, and the program goes on; its exit status
 * counts. */
#ifndef SCREE_TESTS_CHECK_H
#define SCREE_TESTS_CHECK_H

#include "bodies/elementary.h"

#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int check_count, check_failures;

#define CHECK(condition)                                                                                               \
    do {                                                                                                               \
        check_count++;                                                                                                 \
        if (!(condition)) {                                                                                            \
            check_failures++;                                                                                          \
            printf("%s:%d: failed: %s\n", __FILE__, __LINE__, #condition);                                             \
        }                                                                                                              \
    } while (0)

static inline void check_close(const char *file, int line, const char *text, double value, double expected,
                               double error, double tolerance) {
    check_count++;
    if (error <= tolerance) return; /* a NaN fails */
    check_failures++;
    printf("%s:%d: %s is %.17g, expected %.17g; error %.3g, tolerance %.3g\n", file, line, text, value, expected, error,
           tolerance);
}

/* |value - expected| <= tolerance */
#define NEAR(value, expected, tolerance)                                                                               \
    check_close(__FILE__, __LINE__, #value, (value), (expected), fabs((value) - (expected)), (tolerance))

/* |value - expected| <= tolerance |expected| */
#define CLOSE(value, expected, tolerance)                                                                              \
    check_close(__FILE__, __LINE__, #value, (value), (expected), fabs((value) - (expected)) / fabs(expected),          \
                (tolerance))

/* `text` contains `part`. */
#define CONTAINS(text, part)                                                                                           \
    do {                                                                                                               \
        check_count++;                                                                                                 \
        if (!strstr((text), (part))) {                                                                                 \
            check_failures++;                                                                                          \
            printf("%s:%d: \"%s\" lacks \"%s\"\n", __FILE__, __LINE__, (text), (part));                                \
        }                                                                                                              \
    } while (0)

/* At the end of main. */
static inline int check_report(void) {
    printf("%d checks, %d failed\n", check_count, check_failures);
    return check_failures ? 1 : 0;
}

/* Uniform in [0, 1), the same sequence everywhere (xorshift64*, Vigna 2016). */
static inline double check_random(uint64_t *seed) {
    *seed ^= *seed >> 12;
    *seed ^= *seed << 25;
    *seed ^= *seed >> 27;
    return (double)((*seed * 0x2545f4914f6cdd1du) >> 11) * 0x1p-53;
}

static inline double check_between(uint64_t *seed, double low, double high) {
    return low + (high - low) * check_random(seed);
}

/* Several of them. (As arguments of one call they would be drawn in an order that is the compiler's own.) */
static inline void check_draw(uint64_t *seed, double low, double high, int count, double *numbers) {
    for (int k = 0; k < count; k++) numbers[k] = check_between(seed, low, high);
}

/* ---- reference tables: CSV with # comments and a header; cells as text ---- */

enum { CHECK_COLUMNS = 32, CHECK_CELL = 48, CHECK_ROWS = 400 };

struct check_table {
    int rows, columns;
    char header[CHECK_COLUMNS][CHECK_CELL];
    char cell[CHECK_ROWS][CHECK_COLUMNS][CHECK_CELL];
};

static inline int check_split(char *line, char cells[CHECK_COLUMNS][CHECK_CELL]) {
    int count = 0;
    line[strcspn(line, "\r\n")] = '\0';
    for (char *cell = line, *comma; cell && count < CHECK_COLUMNS; cell = comma ? comma + 1 : NULL) {
        comma = strchr(cell, ',');
        if (comma) *comma = '\0';
        snprintf(cells[count++], CHECK_CELL, "%.*s", CHECK_CELL - 1, cell);
    }
    return count;
}

/* Read data/reference/NAME; ends the test program if it can't. To be freed. */
static inline struct check_table *check_read(const char *name) {
    char path[512], line[8192];
    snprintf(path, sizeof path, "%s/reference/%s", SCREE_DATA, name);
    FILE *file = fopen(path, "r");
    struct check_table *table = calloc(1, sizeof *table);
    if (!file || !table) {
        printf("can't read %s\n", path);
        exit(1);
    }
    while (fgets(line, sizeof line, file)) {
        if (line[0] == '#' || line[0] == '\n') continue;
        if (table->columns == 0)
            table->columns = check_split(line, table->header);
        else if (table->rows < CHECK_ROWS)
            check_split(line, table->cell[table->rows++]);
    }
    fclose(file);
    return table;
}

/* Text of a cell by row number and column name; "" if there is no such column. */
static inline const char *check_text(const struct check_table *table, int row, const char *column) {
    for (int k = 0; k < table->columns; k++)
        if (strcmp(table->header[k], column) == 0) return table->cell[row][k];
    printf("no column %s\n", column);
    check_failures++;
    return "";
}

static inline double check_number(const struct check_table *table, int row, const char *column) {
    const char *text = check_text(table, row, column);
    char *end;
    double value = strtod(text, &end);
    return end == text ? NAN : value;
}

#endif
