/* Names of things that are numbered from 0: by number, and the number by name. Of names that count on, "s 1", "s 2", …,
 * as those of many spheres do, only the first of 64 is kept. */
#ifndef SCREE_ENGINE_NAMES_H
#define SCREE_ENGINE_NAMES_H

#include "engine/scree.h"

#include <stddef.h>

/* Names that follow one another: the same text, then numbers that rise by one. */
struct scree_names_run {
    const char *text; /* of the first name */
    int first;        /* its place among all names */
    int stem;         /* letters before its number */
    int number;       /* with which it ends; -1: none, and it stands alone */
};

struct scree_names {
    int count, runs, capacity;
    struct scree_names_run *run;     /* by rising places */
    size_t places;                   /* a power of two, or 0 */
    int *place;                      /* a table of runs; -1: empty */
    struct scree_names_piece *piece; /* the newest; owns what the texts point into */
};

/* Number of a name, -1 if it isn't there. */
int scree_names_find(const struct scree_names *names, const char *name);

/* Name by number, from 0 to count - 1. */
scree_name scree_names_at(const struct scree_names *names, int number);

/* Copy a name of at most SCREE_NAME_LENGTH bytes that isn't there and give it the next number; 0, or 1 if there is no
 * memory (then nothing is changed). */
int scree_names_add(struct scree_names *names, const char *name);

/* Forget all names from number `count` on. */
void scree_names_cut(struct scree_names *names, int count);

void scree_names_free(struct scree_names *names);

#endif
