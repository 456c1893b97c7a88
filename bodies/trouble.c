/* The trouble record, and the nearest valid name for messages about a wrong one. */
#include "bodies/trouble.h"

#include <ctype.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { LONGEST_NAME = 80, NAME_HEAD = 40, NAME_TAIL = 24, TEXT_HEAD = 200 };

static const char dots[] = "\xe2\x80\xa6"; /* … */

/* One character of the UTF-8 text `from` as it may be shown, into `to`; returns how many bytes of `from` it is. What
 * would act on a terminal or break a line (C0, DEL, C1) becomes \n, \t or \x1b. */
static size_t show(const char *from, char to[8]) {
    unsigned c = (unsigned char)from[0], next = c ? (unsigned char)from[1] : 0;
    if (c == 0xc2 && next >= 0x80 && next < 0xa0) {
        snprintf(to, 8, "\\x%02x", next);
        return 2;
    }
    if (c == '\n' || c == '\t')
        snprintf(to, 8, "\\%c", c == '\n' ? 'n' : 't');
    else if (c < 0x20 || c == 0x7f)
        snprintf(to, 8, "\\x%02x", c);
    else
        snprintf(to, 8, "%c", (int)c);
    return 1;
}

/* All of a text as it may be shown, to be freed; NULL if there is no memory. */
static char *show_all(const char *from) {
    char *shown = malloc(4 * strlen(from) + 8), *to = shown;
    if (!shown) return NULL;
    for (*to = '\0'; *from; to += strlen(to)) from += show(from, to);
    return shown;
}

/* The first byte of the character that `at` points into, at most three before; what isn't UTF-8 has none. */
static char *first_byte(char *at) {
    for (int k = 0; k < 3 && ((unsigned char)*at & 0xc0) == 0x80; k++) at--;
    return at;
}

/* Put dots in place of what stands between two places of a text, if they are shorter; returns the place behind them. */
static char *leave_out(char *from, char *to) {
    from = first_byte(from);
    to = first_byte(to);
    if (to - from <= (ptrdiff_t)strlen(dots)) return to;
    memcpy(from, dots, strlen(dots));
    from += strlen(dots);
    memmove(from, to, strlen(to) + 1);
    return from;
}

static void shorten_quoted_names(char *text) {
    for (char *open = strchr(text, '"'); open; open = strchr(open, '"')) {
        char *close = strchr(open + 1, '"');
        if (!close) return;
        if (close - open > LONGEST_NAME) {
            char *tail = first_byte(close - NAME_TAIL);
            ptrdiff_t kept = close - tail;
            close = leave_out(open + 1 + NAME_HEAD, tail) + kept;
        }
        open = close + 1;
    }
}

/* Make a text shorter than `room` bytes: first its names in quotes, then its own middle. */
static void shorten(char *text, size_t room) {
    if (strlen(text) < room) return;
    shorten_quoted_names(text);
    size_t length = strlen(text), tail = room - TEXT_HEAD - 8;
    if (length >= room) leave_out(text + TEXT_HEAD, text + length - tail);
}

/* `text` NULL: there was no memory for it. */
static scree_status fill(scree_trouble *trouble, scree_status status, const char *field, const char *text) {
    char *shown = text ? show_all(text) : NULL;
    if (shown) shorten(shown, sizeof trouble->text);
    trouble->status = status;
    trouble->time = 0.0;
    trouble->body = trouble->other = -1;
    snprintf(trouble->field, sizeof trouble->field, "%s", field ? field : "");
    snprintf(trouble->text, sizeof trouble->text, "%s", shown ? shown : "no memory for the message of an error");
    free(shown);
    return status;
}

/* "file:line:column: text", to be freed; `file` may be NULL. NULL if there is no memory. */
SCREE_PRINTF(4, 0)
static char *compose(const char *file, int line, int column, const char *format, va_list arguments) {
    char place[32] = "";
    va_list again;
    va_copy(again, arguments);
    if (file && line)
        snprintf(place, sizeof place, ":%d:%d: ", line, column);
    else if (file)
        snprintf(place, sizeof place, ": ");
    size_t head = (file ? strlen(file) : 0) + strlen(place);
    int length = vsnprintf(NULL, 0, format, arguments);
    char *text = length >= 0 ? malloc(head + (size_t)length + 1) : NULL;
    if (text) {
        snprintf(text, head + 1, "%s%s", file ? file : "", place);
        vsnprintf(text + head, (size_t)length + 1, format, again);
    }
    va_end(again);
    return text;
}

scree_status scree_report(scree_trouble *trouble, scree_status status, const char *field, const char *format, ...) {
    if (!trouble) return status;
    va_list arguments;
    va_start(arguments, format);
    char *text = compose(NULL, 0, 0, format, arguments);
    va_end(arguments);
    fill(trouble, status, field, text);
    free(text);
    return status;
}

scree_status scree_report_at(scree_trouble *trouble, scree_status status, const char *file, int line, int column,
                             const char *format, va_list arguments) {
    if (!trouble) return status;
    char *text = compose(file, line, column, format, arguments);
    fill(trouble, status, NULL, text);
    free(text);
    return status;
}

struct scree_shown scree_shown(const char *name) {
    struct scree_shown shown = {""};
    char *text = show_all(name);
    if (text && strlen(text) > LONGEST_NAME) leave_out(text + NAME_HEAD, text + strlen(text) - NAME_TAIL);
    snprintf(shown.text, sizeof shown.text, "%s", text ? text : "…");
    free(text);
    return shown;
}

static int are_one_letter(char a, char b) { return tolower((unsigned char)a) == tolower((unsigned char)b); }

/* Edits (insert, delete, replace) that turn a into b, whatever their case; names longer than 63 characters are far from
 * all. */
static size_t edit_distance(const char *a, const char *b) {
    size_t row[64];
    size_t length_a = strlen(a), length_b = strlen(b);
    if (length_a > 63 || length_b > 63) return (size_t)-1;
    for (size_t j = 0; j <= length_b; j++) row[j] = j;
    for (size_t i = 1; i <= length_a; i++) {
        size_t diagonal = row[0];
        row[0] = i;
        for (size_t j = 1; j <= length_b; j++) {
            size_t replaced = diagonal + !are_one_letter(a[i - 1], b[j - 1]);
            diagonal = row[j];
            size_t moved = (row[j] < row[j - 1] ? row[j] : row[j - 1]) + 1;
            row[j] = replaced < moved ? replaced : moved;
        }
    }
    return row[length_b];
}

/* "energy" for "energy.csv", "youngs_modulus" for "modulus": one of them is a part of the other, and not by chance. */
static int is_part_of_other(const char *a, const char *b) {
    enum { LEAST = 4 };
    if (strlen(a) < LEAST || strlen(b) < LEAST) return 0;
    return strstr(a, b) != NULL || strstr(b, a) != NULL;
}

const char *scree_nearest_name(const char *wrong, const char *const *names) {
    const char *nearest = NULL, *const *first = names;
    size_t least = strlen(wrong) / 3 + 2; /* farther than this it is no misspelling */
    for (; *names; names++) {
        size_t distance = edit_distance(wrong, *names);
        if (distance < least) {
            least = distance;
            nearest = *names;
        }
    }
    for (names = first; !nearest && *names; names++)
        if (is_part_of_other(wrong, *names)) nearest = *names;
    return nearest;
}

struct scree_hint scree_hint(const char *wrong, const char *const *names) {
    struct scree_hint hint = {""};
    const char *nearest = scree_nearest_name(wrong, names);
    if (nearest) snprintf(hint.text, sizeof hint.text, "; did you mean \"%.64s\"?", nearest);
    return hint;
}

struct scree_hint scree_hint_or_all(const char *wrong, const char *const *names) {
    struct scree_hint hint = scree_hint(wrong, names);
    size_t used = 0;
    if (hint.text[0]) return hint;
    for (int k = 0; names[k] && used < sizeof hint.text; k++)
        used += (size_t)snprintf(hint.text + used, sizeof hint.text - used, "%s%s", k ? ", " : "; it has ", names[k]);
    return hint;
}
