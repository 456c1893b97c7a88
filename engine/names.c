/* Look-up of names. */
#include "engine/names.h"

#include "engine/hash.h"

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Memory for many names. */
struct scree_names_piece {
    struct scree_names_piece *before;
    size_t used, size;
    char text[];
};

enum { PIECE = 64 << 10 };

/* A run ends where its number, divided by this, gives another whole number: so these tell which runs a name can belong
 * to. */
enum { RUN = 64 };

/* A name in its two parts. The number is as long as can be, without zeros before it: so both parts together are the
 * name again. */
static struct scree_names_run parts_of(const char *name) {
    enum { DIGITS = 9 };
    size_t length = strlen(name), stem = length;
    while (stem > 0 && length - stem < DIGITS && isdigit((unsigned char)name[stem - 1])) stem--;
    while (stem + 1 < length && name[stem] == '0') stem++;
    int number = stem < length ? (int)strtol(name + stem, NULL, 10) : -1;
    return (struct scree_names_run){name, 0, (int)stem, number};
}

static int same_stem(const struct scree_names_run *a, const struct scree_names_run *b) {
    return a->stem == b->stem && memcmp(a->text, b->text, (size_t)a->stem) == 0;
}

static int count_of(const struct scree_names *names, int run) {
    int end = run + 1 < names->runs ? names->run[run + 1].first : names->count;
    return end - names->run[run].first;
}

/* How many names of a run come before the one with these parts; -1: it isn't one of the run. */
static int way_into(const struct scree_names *names, int run, const struct scree_names_run *parts) {
    const struct scree_names_run *own = &names->run[run];
    int way = parts->number - own->number;
    return way >= 0 && way < count_of(names, run) && same_stem(own, parts) ? way : -1;
}

/* Where the run of a name is, or the empty place where it would be. */
static int *find(const struct scree_names *names, const struct scree_names_run *parts) {
    int group = parts->number / RUN;
    uint64_t hash = scree_hash_on(scree_hash_start, parts->text, (size_t)parts->stem);
    size_t place = (size_t)scree_hash_on(hash, &group, sizeof group);
    for (;; place++) {
        int *run = &names->place[place & (names->places - 1)];
        if (*run < 0 || way_into(names, *run, parts) >= 0) return run;
    }
}

int scree_names_find(const struct scree_names *names, const char *name) {
    if (!name || !names->places) return -1;
    struct scree_names_run parts = parts_of(name);
    int run = *find(names, &parts);
    return run < 0 ? -1 : names->run[run].first + way_into(names, run, &parts);
}

scree_name scree_names_at(const struct scree_names *names, int number) {
    int low = 0, high = names->runs;
    while (high - low > 1) {
        int middle = low + (high - low) / 2;
        if (names->run[middle].first <= number)
            low = middle;
        else
            high = middle;
    }
    const struct scree_names_run *run = &names->run[low];
    scree_name name;
    if (run->number < 0)
        snprintf(name.text, sizeof name.text, "%s", run->text);
    else
        snprintf(name.text, sizeof name.text, "%.*s%d", run->stem, run->text, run->number + number - run->first);
    return name;
}

/* Enter all runs into the table anew. */
static void fill(struct scree_names *names) {
    if (names->places) memset(names->place, -1, names->places * sizeof *names->place);
    for (int r = 0; r < names->runs; r++) *find(names, &names->run[r]) = r;
}

/* Room for one run more: at most half of the places are taken, so that chains stay short. */
static int grow(struct scree_names *names) {
    if (names->runs == names->capacity) {
        int capacity = names->capacity ? 2 * names->capacity : 8;
        struct scree_names_run *run = realloc(names->run, (size_t)capacity * sizeof *run);
        if (!run) return 1;
        names->run = run;
        names->capacity = capacity;
    }
    if (2 * ((size_t)names->runs + 1) <= names->places) return 0;
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

/* Whether the name is the one that the last run would have next. */
static int goes_on(const struct scree_names *names, const struct scree_names_run *parts) {
    if (names->runs == 0 || parts->number < 0) return 0;
    const struct scree_names_run *last = &names->run[names->runs - 1];
    return last->number >= 0 && parts->number == last->number + count_of(names, names->runs - 1) &&
           parts->number / RUN == last->number / RUN && same_stem(last, parts);
}

int scree_names_add(struct scree_names *names, const char *name) {
    struct scree_names_run parts = parts_of(name);
    if (!goes_on(names, &parts)) {
        if (grow(names)) return 1;
        parts.text = keep(names, name);
        if (!parts.text) return 1;
        parts.first = names->count;
        *find(names, &parts) = names->runs;
        names->run[names->runs++] = parts;
    }
    names->count++;
    return 0;
}

void scree_names_cut(struct scree_names *names, int count) {
    if (count >= names->count) return;
    names->count = count;
    while (names->runs > 0 && names->run[names->runs - 1].first >= count) names->runs--;
    fill(names);
}

void scree_names_free(struct scree_names *names) {
    for (struct scree_names_piece *piece = names->piece, *before; piece; piece = before) {
        before = piece->before;
        free(piece);
    }
    free(names->run);
    free(names->place);
    *names = (struct scree_names){0};
}
