/* Look-up of names: which index a name has. Open addressing; the names themselves belong to the caller and stay where they are. */
#ifndef SCREE_ENGINE_NAMES_H
#define SCREE_ENGINE_NAMES_H

#include <stddef.h>

struct scree_names {
    size_t places; /* a power of two, or 0 */
    int count;
    struct scree_name_entry {
        const char *name; /* NULL: empty */
        int index;
    } * entry;
};

/* Index of a name, -1 if it isn't there. */
int scree_names_find(const struct scree_names *names, const char *name);

/* Add a name that isn't there; 0, or 1 if there is no memory. */
int scree_names_add(struct scree_names *names, const char *name, int index);

void scree_names_free(struct scree_names *names);

#endif
