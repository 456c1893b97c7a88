/* Look-up of names. */
#include "engine/names.h"

#include "engine/hash.h"

#include <stdlib.h>
#include <string.h>

/* Where a name is, or the empty place where it would be. */
static struct scree_name_entry *find(const struct scree_names *names, const char *name) {
    size_t place = (size_t)scree_hash_on(scree_hash_start, name, strlen(name));
    for (;; place++) {
        struct scree_name_entry *entry = &names->entry[place & (names->places - 1)];
        if (!entry->name || strcmp(entry->name, name) == 0) return entry;
    }
}

int scree_names_find(const struct scree_names *names, const char *name) {
    if (!name || !names->places) return -1;
    const struct scree_name_entry *entry = find(names, name);
    return entry->name ? entry->index : -1;
}

/* Twice the room: at most half of the places are taken, so that chains stay short. */
static int grow(struct scree_names *names) {
    struct scree_names larger = {.places = names->places ? 2 * names->places : 16, .count = names->count};
    larger.entry = calloc(larger.places, sizeof *larger.entry);
    if (!larger.entry) return 1;
    for (size_t k = 0; k < names->places; k++)
        if (names->entry[k].name) *find(&larger, names->entry[k].name) = names->entry[k];
    free(names->entry);
    *names = larger;
    return 0;
}

int scree_names_add(struct scree_names *names, const char *name, int index) {
    if (2 * ((size_t)names->count + 1) > names->places && grow(names)) return 1;
    *find(names, name) = (struct scree_name_entry){name, index};
    names->count++;
    return 0;
}

void scree_names_free(struct scree_names *names) {
    free(names->entry);
    *names = (struct scree_names){0};
}
