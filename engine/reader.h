/* Typed access to the tables of a TOML file, with messages that name file, line and column. The first complaint stays;
 * after it nothing is read any more. */
#ifndef SCREE_ENGINE_READER_H
#define SCREE_ENGINE_READER_H

#include "engine/file.h"
#include "engine/table.h"
#include "engine/toml.h"

/* What is shared while one file is read. */
struct scree_reader {
    const char *name; /* of the file */
    const struct scree_toml *root;
    scree_trouble *trouble;
    scree_status status;        /* the first failure; everything after it does nothing */
    void *into;                 /* what the file is read into */
    struct scree_paths *beside; /* receives the files read beside it; NULL: nobody asks */
};

/* Read a file ("-": standard input), changed by `count` assignments (see scree_toml_set), with `read`, which begins at
 * the reader's root and reads into `into`. */
typedef void scree_read_root(struct scree_reader *r);
scree_status scree_read_toml(const char *path, const char *const *assignments, int count, scree_read_root *read,
                             void *into, scree_trouble *trouble);

/* Complain about a node (NULL: the file). */
SCREE_PRINTF(3, 4)
void scree_complain(struct scree_reader *r, const struct scree_toml *node, const char *format, ...);

/* Every key of `table` is one of `keys` (NULL-terminated); else the nearest is named. */
void scree_check_keys(struct scree_reader *r, const struct scree_toml *table, const char *what,
                      const char *const *keys);

/* Of a table that lacks a key: one that is like it must be a misspelt one. */
void scree_check_misspelt(struct scree_reader *r, const struct scree_toml *table, const char *what, const char *key);

/* A finite number; 0 after a complaint. */
double scree_number_of(struct scree_reader *r, const struct scree_toml *node, const char *what);

/* A whole number by key; 0 if it is absent. Its bounds are whole and at most 2^53. */
double scree_read_whole(struct scree_reader *r, const struct scree_toml *table, const char *key, double least,
                        double most);

/* A number, string (NULL if absent), boolean (0 if absent) by key. */
double scree_read_number(struct scree_reader *r, const struct scree_toml *table, const char *key, double fallback);
const char *scree_read_string(struct scree_reader *r, const struct scree_toml *table, const char *key);
int scree_read_boolean(struct scree_reader *r, const struct scree_toml *table, const char *key);

/* Array of exactly `count` numbers; returns 1 if the key is there. */
int scree_read_numbers(struct scree_reader *r, const struct scree_toml *table, const char *key, int count, double *to);

/* A table by key, NULL if it isn't there or is no table (which is reported). */
const struct scree_toml *scree_read_table(struct scree_reader *r, const struct scree_toml *table, const char *key);

/* Call `read` for each entry of an array of tables. */
void scree_read_each(struct scree_reader *r, const struct scree_toml *root, const char *key,
                     void (*read)(struct scree_reader *, const struct scree_toml *));

/* Index of a string among NULL-terminated words, or 0 with a complaint. */
int scree_choose(struct scree_reader *r, const struct scree_toml *node, const char *what, const char *const *words);

/* What has gone wrong with a file is told at the key that names it; the status stays. */
void scree_tell_place(struct scree_reader *r, const struct scree_toml *node);

/* The path of the file that a string names, relative to the folder of the file that is read; to be freed, NULL after a
 * complaint. And its content, of at most `largest` bytes, into `text`, to be freed. */
char *scree_read_path_beside(struct scree_reader *r, const struct scree_toml *node);
char *scree_read_file_beside(struct scree_reader *r, const struct scree_toml *node, size_t largest, char **text,
                             size_t *size);

/* Read the table that a string names, beside the file; `rising` names a column that must increase, NULL: none. Its
 * path, to be freed; NULL after a complaint. */
char *scree_read_table_file(struct scree_reader *r, const struct scree_toml *node, const char *rising,
                            struct scree_table *table);

/* The same with columns of words, named in `words` (NULL-terminated); `text` receives what they point into, to be freed
 * after the table. */
char *scree_read_word_file(struct scree_reader *r, const struct scree_toml *node, const char *const *words,
                           struct scree_table *table, char **text);

/* Complain about a place in a table's file: line and column from 1. */
SCREE_PRINTF(5, 6)
void scree_complain_in_table(struct scree_reader *r, const char *path, int line, int column, const char *format, ...);

/* A column that a table may have, by its names (NULL behind the last); messages call it by the first. */
struct scree_column {
    const char *names[3];
};

/* Which of the table's columns is which of `count` known ones: into `at`, -1 where there is none. Complains of a second
 * one, and of a column that isn't known, with the nearest that is and what there is in `what`: "a table of spheres: it
 * has x_m, …"; NULL leaves those alone. */
void scree_find_columns(struct scree_reader *r, const char *path, const struct scree_table *table,
                        const struct scree_column *known, int count, const char *what, int *at);

/* rows = [[…], …] as columns of these names (NULL-terminated), from `least` to as many as there are; `what` tells how
 * rows look. */
void scree_read_rows(struct scree_reader *r, const struct scree_toml *rows, const char *const *names, int least,
                     const char *what, struct scree_table *table);

#endif
