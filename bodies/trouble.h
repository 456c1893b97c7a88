/* What can go wrong, and the record that says what did: status codes and the trouble record. Every function
 * that can fail returns a status; the details go into a record that the caller owns. */
#ifndef SCREE_BODIES_TROUBLE_H
#define SCREE_BODIES_TROUBLE_H

#include <stdarg.h>

#if defined(__GNUC__)
#define SCREE_API               __attribute__((visibility("default")))
#define SCREE_PRINTF(text, arg) __attribute__((format(printf, text, arg)))
#else
#define SCREE_API
#define SCREE_PRINTF(text, arg)
#endif

typedef enum scree_status {
    SCREE_OK = 0,
    SCREE_BAD_INPUT, /* a definition or a file that makes no sense; nothing was changed, but a scene that was to be
                        baked is lost */
    SCREE_NO_MEMORY, /* an allocation failed; the state is kept */
    SCREE_NO_FILE,   /* a file that can't be opened, read or written */
    SCREE_FAILED     /* the simulation went wrong and was stopped */
} scree_status;

/* The last thing that went wrong. `text` is one sentence for people; `field` names the entry of a definition that
 * it is about ("mass", "shape.rounding", …), empty if none, so that a file reader can add the line. For SCREE_FAILED
 * `time` (s), `body` and `other` (indices, -1: none) say where; where a sphere of many is refused, `body` says which.
 */
typedef struct scree_trouble {
    scree_status status;
    char field[64];
    char text[768];
    double time;
    int body, other;
} scree_trouble;

/* ---- inside the library and its programs; the shared library keeps these to itself ---- */

/* Fill the record; returns `status`, so that a failure can be reported and returned in one line. `field` may be
 * NULL. A NULL record is allowed: then only the status is returned. Control characters are shown as \n or \x1b; a text
 * too long for the record loses the middle of its long names ("…" stands there), never its end, which holds the
 * cause. */
SCREE_PRINTF(4, 5)
scree_status scree_report(scree_trouble *trouble, scree_status status, const char *field, const char *format, ...);

/* The same for a place in a file: the text begins with "file:line:column: " ("file: " if `line` is 0). */
SCREE_PRINTF(6, 0)
scree_status scree_report_at(scree_trouble *trouble, scree_status status, const char *file, int line, int column,
                             const char *format, va_list arguments);

/* A name as it may be printed: control characters shown as such, shortened in the middle if it is long. */
struct scree_shown {
    char text[256];
};
struct scree_shown scree_shown(const char *name);

/* The name in `names` (NULL-terminated) that is most like `wrong`, for messages; NULL if none is near. */
const char *scree_nearest_name(const char *wrong, const char *const *names);

/* "; did you mean "x"?" with that name, or "" if none is near: the end of a message, written into `text`. */
struct scree_hint {
    char text[320];
};
struct scree_hint scree_hint(const char *wrong, const char *const *names);

/* The same; if none is near, all of them. */
struct scree_hint scree_hint_or_all(const char *wrong, const char *const *names);

#endif
