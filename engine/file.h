/* Files: reading a whole one; writing one under a temporary name until it is whole. */
#ifndef SCREE_ENGINE_FILE_H
#define SCREE_ENGINE_FILE_H

#include "bodies/trouble.h"

#include <stddef.h>
#include <stdio.h>

/* The whole content of a file ("-": standard input), NUL-terminated, to be freed; NULL on failure. SCREE_BAD_INPUT if
 * it holds more than `largest` bytes. */
char *scree_read_file(const char *path, size_t largest, size_t *size, scree_trouble *trouble);

/* A file being written. Until it is kept its name ends in ".part", and a file of its final name stays as it was. */
struct scree_out {
    FILE *file;
    char *path, *temporary; /* owned */
    int lock;               /* keeps others from writing the temporary file */
};

/* Open for writing; SCREE_NO_FILE, also while another process writes a file of that name. */
scree_status scree_out_open(struct scree_out *out, const char *path, scree_trouble *trouble);

/* Flush and close, still under the temporary name; SCREE_NO_FILE if anything since the opening didn't reach the file
 * (then the temporary file is removed). Several files that belong together are all finished before the first is
 * kept. */
scree_status scree_out_finish(struct scree_out *out, scree_trouble *trouble);

/* Finish it, unless that is done, and give it its name; SCREE_NO_FILE. Does nothing on an `out` that isn't open. */
scree_status scree_out_keep(struct scree_out *out, scree_trouble *trouble);

/* Close and leave the temporary file (`leave` set) or remove it. Does nothing on an `out` that isn't open. */
void scree_out_drop(struct scree_out *out, int leave);

/* Make a folder and those above it; none is made twice. SCREE_NO_FILE. */
scree_status scree_make_folder(const char *path, scree_trouble *trouble);

/* Says of a file's name whether this program wrote it. */
typedef int scree_ours(const char *name);

/* Remove a folder's files that are `ours`, and the folder itself if that leaves it empty. */
void scree_clear_folder(const char *path, scree_ours *ours);

/* SCREE_NO_FILE if something is in the way of what follows: `path` or `aside` is there and no folder, or others' files
 * are in `aside`. */
scree_status scree_check_places(const char *path, const char *aside, scree_ours *ours, scree_trouble *trouble);

/* Let the folder `fresh` take the place of the folder `path`, if there is one: its files that are `ours` are removed,
 * all others move to the new one. `aside` is a name for the time in between. SCREE_NO_FILE: both are as they were. */
scree_status scree_replace_folder(const char *fresh, const char *path, const char *aside, scree_ours *ours,
                                  scree_trouble *trouble);

/* True if two paths lead to the same existing file or folder. */
int scree_same_file(const char *path, const char *other);

/* True if a file or folder, however `path` leads to it, is in a folder. */
int scree_is_in(const char *folder, const char *path);

/* A list of paths; owns them. */
struct scree_paths {
    int count;
    char **path;
};

/* SCREE_NO_MEMORY */
scree_status scree_add_path(struct scree_paths *paths, const char *path, scree_trouble *trouble);
void scree_free_paths(struct scree_paths *paths);

/* "folder/name", to be freed; NULL if there is no memory. */
char *scree_join(const char *folder, const char *name);

#endif
