/* A scene from a file: the TOML keys and what they mean. README.md, section "Scene files", is the user's page. */
#ifndef SCREE_ENGINE_SCENE_FILE_H
#define SCREE_ENGINE_SCENE_FILE_H

#include "engine/file.h"
#include "engine/scree.h"

enum scree_write {
    SCREE_WRITE_BODIES = 1,
    SCREE_WRITE_CONTACTS = 2,
    SCREE_WRITE_ENERGY = 4,
    SCREE_WRITE_VTK = 8,
    SCREE_WRITE_SPHERES = 16
};

/* What a scene file says besides the scene itself. */
struct scree_run_request {
    char *title;               /* owned; "" if none */
    double end;                /* s */
    double every;              /* s between rows of output; 0: only start and end */
    unsigned write;            /* enum scree_write */
    int bodies;                /* how many of `body` to write; 0: all that can move */
    int *body;                 /* owned; indices */
    struct scree_paths inputs; /* the files that the scene was read from */
};

/* Read `size` bytes of TOML, change it by `assignments` (see scree_toml_set), define the scene by it and bake it.
 * `name` is the file's name for messages; tables are looked for beside it. `threads` > 0 overrides the file. The scene
 * is created here and destroyed on failure; the request is to be freed in any case. */
scree_status scree_read_scene(const char *text, size_t size, const char *name, const char *const *assignments,
                              int assignment_count, int threads, scree_scene **scene, struct scree_run_request *request,
                              scree_trouble *trouble);

/* The same from a file; "-" is standard input. */
scree_status scree_load_scene(const char *path, const char *const *assignments, int assignment_count, int threads,
                              scree_scene **scene, struct scree_run_request *request, scree_trouble *trouble);

/* Steps from the start to the first instant that isn't before `time` (s). */
long scree_steps_to(const scree_scene *scene, double time);

void scree_free_request(struct scree_run_request *request);

#endif
