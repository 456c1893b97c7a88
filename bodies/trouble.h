/* What can go wrong, and the record that says what did: status codes and the trouble record. Every function
 * that can fail returns a status; the details go into a record that the caller owns. */
#ifndef SCREE_BODIES_TROUBLE_H
#define SCREE_BODIES_TROUBLE_H

#if defined(__GNUC__)
#define SCREE_API               __attribute__((visibility("default")))
#define SCREE_PRINTF(text, arg) __attribute__((format(printf, text, arg)))
#else
#define SCREE_API
#define SCREE_PRINTF(text, arg)
#endif

typedef enum scree_status {
    SCREE_OK = 0,
    SCREE_BAD_INPUT, /* a definition or a file that makes no sense; nothing was changed */
    SCREE_NO_MEMORY, /* an allocation failed; the state is kept */
    SCREE_NO_FILE,   /* a file that can't be opened, read or written */
    SCREE_FAILED     /* the simulation went wrong and was stopped */
} scree_status;

/* The last thing that went wrong. `text` is one sentence for people; `field` names the entry of a definition that
 * it is about ("mass", "shape.rounding", …), empty if none, so that a file reader can add the line. For SCREE_FAILED
 * `time` (s), `body` and `other` (indices, -1: none) say where. */
typedef struct scree_trouble {
    scree_status status;
    char field[64];
    char text[768];
    double time;
    int body, other;
} scree_trouble;

/* Fill the record; returns `status`, so that a failure can be reported and returned in one line. `field` may be
 * NULL. A NULL record is allowed: then only the status is returned. */
SCREE_PRINTF(4, 5)
scree_status scree_report(scree_trouble *trouble, scree_status status, const char *field, const char *format, ...);

/* The name in `names` (NULL-terminated) that is most like `wrong`, for messages; NULL if none is near. */
const char *scree_nearest_name(const char *wrong, const char *const *names);

/* "; did you mean "x"?" with that name, or "" if none is near: the end of a message, written into `text`. */
struct scree_hint {
    char text[96];
};
struct scree_hint scree_hint(const char *wrong, const char *const *names);

#endif
