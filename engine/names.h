/* Names of things that are numbered from 0: by number, and the number by name. Names are kept in large pieces of memory, where
 * they stay; an open table of numbers finds them. Some 35 bytes a body, names of a dozen letters included. */
#ifndef SCREE_ENGINE_NAMES_H
#define SCREE_ENGINE_NAMES_H

#include <stddef.h>

struct scree_names {
    int count, capacity;
    const char **name;               /* by number */
    size_t places;                   /* a power of two, or 0 */
    int *place;                      /* numbers; -1: empty */
    struct scree_names_piece *piece; /* the newest; owns what the names point into */
};

/* Number of a name, -1 if it isn't there. */
int scree_names_find(const struct scree_names *names, const char *name);

/* Copy a name that isn't there and give it the next number; 0, or 1 if there is no memory (then nothing is changed). */
int scree_names_add(struct scree_names *names, const char *name);

/* Forget all names from number `count` on. */
void scree_names_cut(struct scree_names *names, int count);

void scree_names_free(struct scree_names *names);

#endif
