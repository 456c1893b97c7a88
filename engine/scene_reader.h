/* What the readers of a scene file's tables share (scene_file.c, scene_motions.c, scene_spheres.c). */
#ifndef SCREE_ENGINE_SCENE_READER_H
#define SCREE_ENGINE_SCENE_READER_H

#include "engine/reader.h"
#include "engine/scene_file.h"

/* What a motion's numbers are in; rows without a file say nothing of it. */
enum scree_motion_unit { SCREE_ANY_UNIT, SCREE_METRES, SCREE_RADIANS };

/* What a scene file is read into (scree_reader.into). */
struct scree_scene_target {
    scree_scene *scene;
    struct scree_run_request *request;
    int threads;
    double end, every;
    enum scree_motion_unit *motion_unit; /* of each motion; owned */
};

/* A number that must be > 0 where it is given (`unit`: " kg"); 0 if it isn't, which the library takes as such. */
double scree_read_positive(struct scree_reader *r, const struct scree_toml *table, const char *key, const char *unit);

/* Pass on what the library said of a definition that came from `table`. */
void scree_pass_on(struct scree_reader *r, scree_status status, const struct scree_toml *table);

typedef int scree_finder(const scree_scene *scene, const char *name);

/* The index of the thing that a string names, or 0 with a complaint that gives the nearest of its kind ([[what]]). */
int scree_find_named(struct scree_reader *r, const struct scree_toml *node, const char *what, scree_finder *find);

/* Which [[what]] of the file a wrong name may have meant. */
struct scree_hint scree_hint_of(const struct scree_reader *r, const char *what, const char *wrong);

/* joint = "free", "fixed", or { x = …, y = …, z = …, turn = …, others = "fixed" } */
void scree_read_joint(struct scree_reader *r, const struct scree_toml *body, scree_joint *joint);

/* [[motion]] */
void scree_read_motion(struct scree_reader *r, const struct scree_toml *table);

/* The motion that a string names, which drives `what`, in `unit`. */
int scree_read_driver(struct scree_reader *r, const struct scree_toml *node, const char *what,
                      enum scree_motion_unit unit);

/* [domain]: where bodies start, and the axes along which all repeats. */
void scree_read_domain(struct scree_reader *r);

/* [[spheres]] and [[generate]]: many spheres at once. */
void scree_read_spheres(struct scree_reader *r, const struct scree_toml *table);
void scree_read_generate(struct scree_reader *r, const struct scree_toml *table);

#endif
