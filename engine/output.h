/* What a run writes into its folder: bodies.csv, contacts.csv, energy.csv, frames for ParaView, and the final state. */
#ifndef SCREE_ENGINE_OUTPUT_H
#define SCREE_ENGINE_OUTPUT_H

#include "engine/file.h"
#include "engine/scene_file.h"

/* Everything is written under temporary names (NAME.part) and gets its own when all of it is whole, so that a run that
 * fails leaves the results of an earlier one as they were. */
struct scree_output {
    const char *folder;
    const struct scree_run_request *request;
    struct scree_out bodies, contacts, energy, series, spheres, state; /* `series`: the list of frames, scene.pvd */
    char *frames_part; /* owned; folder of the frames so far; NULL: none */
    int frames;
    scree_contact_state *touching; /* owned */
    int touching_capacity;
};

/* The tables by their names, and the bit of the request that asks for each. */
enum { SCREE_TABLES = 5 };
extern const struct scree_output_table {
    const char *name;
    unsigned write;
} scree_output_tables[SCREE_TABLES];

/* Make the folder and open what the request asks for. */
scree_status scree_output_open(struct scree_output *output, const char *folder, const struct scree_run_request *request,
                               scree_trouble *trouble);

/* A row (a frame) of everything for the scene as it is now. */
scree_status scree_output_row(struct scree_output *output, scree_scene *scene, scree_trouble *trouble);

/* Finish all files, and write final.state (and what is in spheres.csv) beside them. */
scree_status scree_output_keep(struct scree_output *output, scree_scene *scene, scree_trouble *trouble);

/* Write the state alone, for a run that is broken off. */
scree_status scree_output_state(struct scree_output *output, scree_scene *scene, scree_trouble *trouble);

/* Close everything; what is unfinished is removed or stays under its temporary name, the state only if it has been
 * written. After a successful keep it only frees memory. */
enum scree_rest_of_output { SCREE_REMOVE, SCREE_LEAVE, SCREE_LEAVE_STATE };
void scree_output_drop(struct scree_output *output, enum scree_rest_of_output rest);

#endif
