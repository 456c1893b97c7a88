/* The trouble record, and the nearest valid name for messages about a wrong one. */
#include "bodies/trouble.h"

#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

scree_status scree_report(scree_trouble *trouble, scree_status status, const char *field, const char *format, ...) {
    if (!trouble) return status;
    trouble->status = status;
    trouble->time = 0.0;
    trouble->body = trouble->other = -1;
    snprintf(trouble->field, sizeof trouble->field, "%s", field ? field : "");
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(trouble->text, sizeof trouble->text, format, arguments);
    va_end(arguments);
    return status;
}

/* Edits (insert, delete, replace) that turn a into b; names longer than 63 characters count as far. */
static size_t edit_distance(const char *a, const char *b) {
    size_t row[64];
    size_t length_a = strlen(a), length_b = strlen(b);
    if (length_a > 63 || length_b > 63) return 64;
    for (size_t j = 0; j <= length_b; j++) row[j] = j;
    for (size_t i = 1; i <= length_a; i++) {
        size_t diagonal = row[0];
        row[0] = i;
        for (size_t j = 1; j <= length_b; j++) {
            size_t replaced = diagonal + (a[i - 1] != b[j - 1]);
            diagonal = row[j];
            size_t moved = (row[j] < row[j - 1] ? row[j] : row[j - 1]) + 1;
            row[j] = replaced < moved ? replaced : moved;
        }
    }
    return row[length_b];
}

const char *scree_nearest_name(const char *wrong, const char *const *names) {
    const char *nearest = NULL;
    size_t least = strlen(wrong) / 2 + 2; /* farther than this it is no misspelling */
    for (; *names; names++) {
        size_t distance = edit_distance(wrong, *names);
        if (distance < least) {
            least = distance;
            nearest = *names;
        }
    }
    return nearest;
}

struct scree_hint scree_hint(const char *wrong, const char *const *names) {
    struct scree_hint hint = {""};
    const char *nearest = scree_nearest_name(wrong, names);
    if (nearest) snprintf(hint.text, sizeof hint.text, "; did you mean \"%.64s\"?", nearest);
    return hint;
}
