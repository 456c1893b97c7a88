/* Files: reading a whole one; writing one under a temporary name until it is whole. */
#include "engine/file.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

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

scree_status scree_out_open(struct scree_out *out, const char *path, scree_trouble *trouble) {
    size_t size = strlen(path) + sizeof ".part";
    *out = (struct scree_out){.path = strdup(path), .temporary = malloc(size)};
    if (!out->path || !out->temporary) {
        scree_out_drop(out, 0);
        return scree_report(trouble, SCREE_NO_MEMORY, NULL, "no memory for a file name");
    }
    snprintf(out->temporary, size, "%s.part", path);
    out->file = fopen(out->temporary, "wb");
    if (out->file) return SCREE_OK;
    scree_report(trouble, SCREE_NO_FILE, NULL, "%s: %s", out->temporary, strerror(errno));
    scree_out_drop(out, 1);
    return SCREE_NO_FILE;
}

static void forget(struct scree_out *out) {
    free(out->path);
    free(out->temporary);
    *out = (struct scree_out){0};
}

scree_status scree_out_keep(struct scree_out *out, scree_trouble *trouble) {
    if (!out->file) return SCREE_OK;
    errno = 0;
    int failed = fflush(out->file) != 0 || ferror(out->file);
    int error = errno;
    if (fclose(out->file) != 0 && !failed) {
        failed = 1;
        error = errno;
    }
    if (!failed && rename(out->temporary, out->path) != 0) {
        failed = 1;
        error = errno;
    }
    scree_status status = SCREE_OK;
    if (failed) {
        status =
            scree_report(trouble, SCREE_NO_FILE, NULL, "%s: %s", out->path, error ? strerror(error) : "write error");
        remove(out->temporary);
    }
    forget(out);
    return status;
}

void scree_out_drop(struct scree_out *out, int leave) {
    if (out->file) {
        fclose(out->file);
        if (!leave) remove(out->temporary);
    }
    forget(out);
}

scree_status scree_make_folder(const char *path, scree_trouble *trouble) {
    char *part = strdup(path);
    if (!part) return scree_report(trouble, SCREE_NO_MEMORY, NULL, "no memory for a file name");
    scree_status status = SCREE_OK;
    for (char *slash = part; slash && !status;) {
        slash = strchr(slash + 1, '/');
        if (slash) *slash = '\0';
        if (mkdir(part, 0777) != 0 && errno != EEXIST)
            status = scree_report(trouble, SCREE_NO_FILE, NULL, "%s: %s", part, strerror(errno));
        if (slash) *slash = '/';
    }
    free(part);
    return status;
}
