/* Files: reading a whole one; writing one under a temporary name until it is whole. */
#include "engine/file.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

/* Append the rest of the stream to a growing text. SCREE_OK leaves it NUL-terminated. */
static scree_status read_stream(FILE *file, const char *path, size_t largest, char **text, size_t *size,
                                scree_trouble *trouble) {
    size_t capacity = 0, got;
    *text = NULL;
    *size = 0;
    do {
        if (*size > largest)
            return scree_report(trouble, SCREE_BAD_INPUT, NULL, "%s: the file is too large (the most is %zu MB)", path,
                                largest >> 20);
        capacity = capacity ? 2 * capacity : 1 << 16;
        char *grown = realloc(*text, capacity + 1);
        if (!grown) return scree_report(trouble, SCREE_NO_MEMORY, NULL, "%s: no memory for the file", path);
        *text = grown;
        got = fread(*text + *size, 1, capacity - *size, file);
        *size += got;
    } while (*size == capacity);
    if (ferror(file)) return scree_report(trouble, SCREE_NO_FILE, NULL, "%s: %s", path, strerror(errno));
    (*text)[*size] = '\0';
    return SCREE_OK;
}

char *scree_read_file(const char *path, size_t largest, size_t *size, scree_trouble *trouble) {
    int standard = strcmp(path, "-") == 0;
    FILE *file = standard ? stdin : fopen(path, "rb");
    char *text;
    if (!file) {
        scree_report(trouble, SCREE_NO_FILE, NULL, "%s: %s", path, strerror(errno));
        return NULL;
    }
    scree_status status = read_stream(file, path, largest, &text, size, trouble);
    if (!standard) fclose(file);
    if (!status) return text;
    free(text);
    return NULL;
}

char *scree_join(const char *folder, const char *name) {
    size_t size = strlen(folder) + strlen(name) + 2;
    char *path = malloc(size);
    if (path) snprintf(path, size, "%s/%s", folder, name);
    return path;
}

static void forget(struct scree_out *out) {
    free(out->path);
    free(out->temporary);
    if (out->lock > 0) close(out->lock);
    *out = (struct scree_out){0};
}

static int is_at(int descriptor, const char *path) {
    struct stat own, there;
    return fstat(descriptor, &own) == 0 && stat(path, &there) == 0 && own.st_dev == there.st_dev &&
           own.st_ino == there.st_ino;
}

static int is_folder(const char *path) {
    struct stat there;
    return stat(path, &there) == 0 && S_ISDIR(there.st_mode);
}

/* An empty file that nobody else writes; -1, with EWOULDBLOCK if somebody does. */
static int open_alone(const char *path) {
    for (;;) {
        int descriptor = open(path, O_RDWR | O_CREAT, 0666);
        if (descriptor < 0) return -1;
        int locked =
            flock(descriptor, LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK; /* some file systems know no locks */
        int there = is_at(descriptor, path);                                   /* else it has got its name meanwhile */
        if (locked && there && ftruncate(descriptor, 0) == 0) return descriptor;
        int error = errno;
        close(descriptor);
        errno = error;
        if (!locked || there) return -1;
    }
}

scree_status scree_out_open(struct scree_out *out, const char *path, scree_trouble *trouble) {
    size_t size = strlen(path) + sizeof ".part";
    *out = (struct scree_out){.path = strdup(path), .temporary = malloc(size)};
    if (!out->path || !out->temporary) {
        forget(out);
        return scree_report(trouble, SCREE_NO_MEMORY, NULL, "no memory for a file name");
    }
    snprintf(out->temporary, size, "%s.part", path);
    if (is_folder(path)) { /* it would be in the way in the end */
        scree_report(trouble, SCREE_NO_FILE, NULL, "%s: %s", path, strerror(EISDIR));
        forget(out);
        return SCREE_NO_FILE;
    }
    int descriptor = open_alone(out->temporary);
    out->lock = descriptor < 0 ? 0 : dup(descriptor); /* holds the lock until the file has its name */
    if (out->lock > 0 && (out->file = fdopen(descriptor, "wb"))) return SCREE_OK;
    scree_report(trouble, SCREE_NO_FILE, NULL, "%s: %s", out->temporary,
                 errno == EWOULDBLOCK ? "another run is writing it" : strerror(errno));
    if (descriptor >= 0) close(descriptor);
    forget(out);
    return SCREE_NO_FILE;
}

/* An error after which nothing of the file is left. */
static scree_status give_up(struct scree_out *out, int error, scree_trouble *trouble) {
    scree_report(trouble, SCREE_NO_FILE, NULL, "%s: %s", out->path,
                 error ? strerror(error) : "not all of it could be written");
    remove(out->temporary);
    forget(out);
    return SCREE_NO_FILE;
}

scree_status scree_out_finish(struct scree_out *out, scree_trouble *trouble) {
    if (!out->file) return SCREE_OK;
    errno = 0;
    int failed = fflush(out->file) != 0 || ferror(out->file);
    int error = errno;
    if (fclose(out->file) != 0 && !failed) {
        failed = 1;
        error = errno;
    }
    out->file = NULL;
    return failed ? give_up(out, error, trouble) : SCREE_OK;
}

scree_status scree_out_keep(struct scree_out *out, scree_trouble *trouble) {
    scree_status status = scree_out_finish(out, trouble);
    if (status || !out->path) return status;
    if (rename(out->temporary, out->path) != 0) return give_up(out, errno, trouble);
    forget(out);
    return SCREE_OK;
}

void scree_out_drop(struct scree_out *out, int leave) {
    if (out->file) fclose(out->file);
    if (out->temporary && !leave) remove(out->temporary);
    forget(out);
}

scree_status scree_make_folder(const char *path, scree_trouble *trouble) {
    if (!*path) return scree_report(trouble, SCREE_NO_FILE, NULL, "the name of the folder for the results is empty");
    char *part = strdup(path);
    if (!part) return scree_report(trouble, SCREE_NO_MEMORY, NULL, "no memory for a file name");
    scree_status status = SCREE_OK;
    for (char *slash = part; slash && !status;) {
        slash = strchr(slash + 1, '/');
        if (slash) *slash = '\0';
        if (mkdir(part, 0777) != 0 && (errno != EEXIST || !is_folder(part)))
            status =
                scree_report(trouble, SCREE_NO_FILE, NULL, "%s: %s", part, strerror(errno == EEXIST ? ENOTDIR : errno));
        if (slash) *slash = '/';
    }
    free(part);
    return status;
}

/* Remove the files of a folder that are `ours`; the others move to the folder `to`, unless that is NULL. */
static void empty_folder(const char *path, const char *to, scree_ours *ours) {
    DIR *folder = opendir(path);
    if (!folder) return;
    for (struct dirent *entry; (entry = readdir(folder));) {
        if (strcmp(entry->d_name, ".") == 0 || strcmp(entry->d_name, "..") == 0) continue;
        char *from = scree_join(path, entry->d_name), *moved = to ? scree_join(to, entry->d_name) : NULL;
        if (from && ours(entry->d_name))
            remove(from);
        else if (from && moved)
            rename(from, moved);
        free(from);
        free(moved);
    }
    closedir(folder);
}

void scree_clear_folder(const char *path, scree_ours *ours) {
    empty_folder(path, NULL, ours);
    rmdir(path); /* fails, rightly, if something is left */
}

static int holds_others(const char *path, scree_ours *ours) {
    DIR *folder = opendir(path);
    int others = 0;
    for (struct dirent *entry; folder && (entry = readdir(folder));)
        others |= strcmp(entry->d_name, ".") != 0 && strcmp(entry->d_name, "..") != 0 && !ours(entry->d_name);
    if (folder) closedir(folder);
    return others;
}

scree_status scree_check_places(const char *path, const char *aside, scree_ours *ours, scree_trouble *trouble) {
    const char *const places[] = {path, aside};
    for (int k = 0; k < 2; k++) {
        struct stat there; /* a link to a folder would move without what is in it */
        if (lstat(places[k], &there) == 0 && !S_ISDIR(there.st_mode))
            return scree_report(trouble, SCREE_NO_FILE, NULL,
                                "%s is no folder of its own, and in the way of one; move it elsewhere", places[k]);
    }
    if (!holds_others(aside, ours)) return SCREE_OK;
    return scree_report(trouble, SCREE_NO_FILE, NULL,
                        "%s is in the way, and files that aren't results are in it; move it elsewhere", aside);
}

scree_status scree_replace_folder(const char *fresh, const char *path, const char *aside, scree_ours *ours,
                                  scree_trouble *trouble) {
    scree_status status = scree_check_places(path, aside, ours, trouble);
    if (status) return status;
    scree_clear_folder(aside, ours); /* of a run that was interrupted just here */
    int there = rename(path, aside) == 0;
    if (!there && errno != ENOENT) return scree_report(trouble, SCREE_NO_FILE, NULL, "%s: %s", path, strerror(errno));
    if (rename(fresh, path) != 0) {
        scree_report(trouble, SCREE_NO_FILE, NULL, "%s: %s", path, strerror(errno));
        if (there) rename(aside, path);
        return SCREE_NO_FILE;
    }
    if (!there) return SCREE_OK;
    empty_folder(aside, path, ours);
    rmdir(aside);
    return SCREE_OK;
}

int scree_same_file(const char *path, const char *other) {
    struct stat a, b;
    return stat(path, &a) == 0 && stat(other, &b) == 0 && a.st_dev == b.st_dev && a.st_ino == b.st_ino;
}

int scree_is_in(const char *folder, const char *path) {
    DIR *entries = opendir(folder);
    int found = 0;
    for (struct dirent *entry; entries && !found && (entry = readdir(entries));) {
        char *other = scree_join(folder, entry->d_name);
        found = other && scree_same_file(path, other);
        free(other);
    }
    if (entries) closedir(entries);
    return found;
}

scree_status scree_add_path(struct scree_paths *paths, const char *path, scree_trouble *trouble) {
    char **grown = realloc(paths->path, ((size_t)paths->count + 1) * sizeof *grown), *copy = strdup(path);
    if (grown) paths->path = grown;
    if (!grown || !copy) {
        free(copy);
        return scree_report(trouble, SCREE_NO_MEMORY, NULL, "no memory for a file name");
    }
    paths->path[paths->count++] = copy;
    return SCREE_OK;
}

void scree_free_paths(struct scree_paths *paths) {
    for (int k = 0; k < paths->count; k++) free(paths->path[k]);
    free(paths->path);
    *paths = (struct scree_paths){0};
}
