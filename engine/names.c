/* Look-up of names. */
#include "engine/names.h"

#include "engine/hash.h"

#include <stdlib.h>
#include <string.h>

/* Memory for many names. */
struct scree_names_piece {
    struct scree_names_piece *before;
    size_t used, size;
    char text[];
};

enum { PIECE = 64 << 10 };

/* Where a name is, or the empty place where it would be. */
static int *find(const struct scree_names *names, const char *name) {
    size_t place = (size_t)scree_hash_on(scree_hash_start, name, strlen(name));
    for (;; place++) {
        int *number = &names->place[place & (names->places - 1)];
        if (*number < 0 || strcmp(names->name[*number], name) == 0) return number;
    }
}

int scree_names_find(const struct scree_names *names, const char *name) {
    return name && names->places ? *find(names, name) : -1;
}

/* Enter all names into the table anew. */
static void fill(struct scree_names *names) {
    if (names->places) memset(names->place, -1, names->places * sizeof *names->place);
    for (int k = 0; k < names->count; k++) *find(names, names->name[k]) = k;
}

/* Room for one more: at most half of the places are taken, so that chains stay short. */
static int grow(struct scree_names *names) {
    if (names->count == names->capacity) {
        int capacity = names->capacity ? 2 * names->capacity : 8;
        const char **name = realloc(names->name, (size_t)capacity * sizeof *name);
        if (!name) return 1;
        names->name = name;
        names->capacity = capacity;
    }
    if (2 * ((size_t)names->count + 1) <= names->places) return 0;
    size_t places = names->places ? 2 * names->places : 16;
    int *place = realloc(names->place, places * sizeof *place);
    if (!place) return 1;
    names->place = place;
    names->places = places;
    fill(names);
    return 0;
}

static char *keep(struct scree_names *names, const char *name) {
    size_t size = strlen(name) + 1;
    struct scree_names_piece *piece = names->piece;
    if (!piece || piece->size - piece->used < size) {
        size_t room = size > PIECE ? size : PIECE;
        piece = malloc(sizeof *piece + room);
        if (!piece) return NULL;
        *piece = (struct scree_names_piece){.before = names->piece, .size = room};
        names->piece = piece;
    }
    char *copy = piece->text + piece->used;
    piece->used += size;
    return memcpy(copy, name, size);
}

int scree_names_add(struct scree_names *names, const char *name) {
    if (grow(names)) return 1;
    const char *copy = keep(names, name);
    if (!copy) return 1;
    *find(names, copy) = names->count;
    names->name[names->count++] = copy;
    return 0;
}

void scree_names_cut(struct scree_names *names, int count) {
    if (count >= names->count) return;
    names->count = count;
    fill(names);
}

void scree_names_free(struct scree_names *names) {
    for (struct scree_names_piece *piece = names->piece, *before; piece; piece = before) {
        before = piece->before;
        free(piece);
    }
    free(names->name);
    free(names->place);
    *names = (struct scree_names){0};
}
