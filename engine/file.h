/* Files: reading a whole one; writing one under a temporary name until it is whole. */
#ifndef SCREE_ENGINE_FILE_H
#define SCREE_ENGINE_FILE_H

#include "bodies/trouble.h"

#include <stddef.h>
#include <stdio.h>

/* The whole content of a file ("-": standard input), NUL-terminated, to be freed; NULL on failure. SCREE_BAD_INPUT if it
 * holds more than `largest` bytes. */
char *scree_read_file(const char *path, size_t largest, size_t *size, scree_trouble *trouble);

/* A file being written. Until it is kept its name ends in ".part", and a file of its final name stays as it was. */
struct scree_out {
    FILE *file;
    char *path, *temporary; /* owned */
};

/* Open for writing; SCREE_NO_FILE. */
scree_status scree_out_open(struct scree_out *out, const char *path, scree_trouble *trouble);

/* Flush, close and give it its name; SCREE_NO_FILE if anything since the opening didn't reach the file (then the
 * temporary file is removed). Does nothing on an `out` that isn't open. */
scree_status scree_out_keep(struct scree_out *out, scree_trouble *trouble);

/* Close and leave the temporary file (`leave` set) or remove it. Does nothing on an `out` that isn't open. */
void scree_out_drop(struct scree_out *out, int leave);

/* Make a folder and those above it; none is made twice. SCREE_NO_FILE. */
scree_status scree_make_folder(const char *path, scree_trouble *trouble);

/* "folder/name", to be freed; NULL if there is no memory. */
char *scree_join(const char *folder, const char *name);

#endif
