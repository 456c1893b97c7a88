/* A reader for a strict subset of TOML 1.0 (toml.io): what is accepted means the same as there; what isn't supported
 * (multi-line strings, dates and times) is refused by name. Numbers are read in the thread's locale: see c_locale.h. */
#ifndef SCREE_ENGINE_TOML_H
#define SCREE_ENGINE_TOML_H

#include "bodies/trouble.h"

#include <stddef.h>
#include <stdint.h>

enum scree_toml_type {
    SCREE_TOML_TABLE,
    SCREE_TOML_ARRAY,
    SCREE_TOML_STRING,
    SCREE_TOML_INTEGER,
    SCREE_TOML_FLOAT,
    SCREE_TOML_BOOLEAN
};

/* A value. Nodes of one document live and die together. */
struct scree_toml {
    enum scree_toml_type type;
    int line, column;   /* where it stands, from 1; 0: it doesn't come from the file */
    int key_column;     /* where the key before it begins, 0: there is none */
    const char *set;    /* the assignment that it comes from, the caller's; NULL: it comes from the file */
    const char *key;    /* in a table: its name there; else NULL */
    const char *string; /* STRING */
    double number;      /* INTEGER, FLOAT, BOOLEAN (0 or 1) */
    int64_t integer;    /* INTEGER */
    int count;          /* TABLE, ARRAY: number of children */
    struct scree_toml *first, *last, *next;
    unsigned char defined; /* how a table came to be; see toml.c */
};

struct scree_toml_document {
    struct scree_toml *root;         /* a table */
    struct scree_toml_chunk *chunks; /* the memory of all nodes and strings */
    size_t nodes;                    /* how many there are */
};

/* Largest text in bytes and deepest nesting that are read; a scene with more bodies than fit keeps them in a table. */
enum { SCREE_TOML_LARGEST = 32 << 20, SCREE_TOML_DEEPEST = 32 };

/* Parse `size` bytes. On failure the trouble text begins with `name`:line:column. Free the document in any case. */
scree_status scree_toml_parse(const char *text, size_t size, const char *name, struct scree_toml_document *document,
                              scree_trouble *trouble);
void scree_toml_free(struct scree_toml_document *document);

/* Apply one `key.key=value` in TOML's own syntax; in an array of tables the next key is the `name` of an entry or its
 * number from 0. The last key is added if the table hasn't got it. */
scree_status scree_toml_set(struct scree_toml_document *document, const char *assignment, scree_trouble *trouble);

/* Child of a table by key, NULL if there is none (or if `table` is NULL). */
struct scree_toml *scree_toml_get(const struct scree_toml *table, const char *key);

/* Child by dotted path ("shape.rounding"); the deepest one that exists, at least `table` itself. */
const struct scree_toml *scree_toml_nearest(const struct scree_toml *table, const char *path);

/* "a table", "a string", … */
const char *scree_toml_type_name(enum scree_toml_type type);

#endif
