/* What a run writes into its folder: bodies.csv, contacts.csv, energy.csv, frames for ParaView, and the final state. */
#ifndef SCREE_ENGINE_OUTPUT_H
#define SCREE_ENGINE_OUTPUT_H

#include "engine/file.h"
#include "engine/scene_file.h"

struct scree_output {
    const char *folder;
    const struct scree_run_request *request;
    struct scree_out bodies, contacts, energy, series; /* `series`: the list of frames, scene.pvd */
    int frames;
    scree_contact_state *touching; /* owned */
    int touching_capacity;
};

/* Make the folder and open what the request asks for. */
scree_status scree_output_open(struct scree_output *output, const char *folder, const struct scree_run_request *request,
                               scree_trouble *trouble);

/* A row (a frame) of everything for the scene as it is now. */
scree_status scree_output_row(struct scree_output *output, scree_scene *scene, scree_trouble *trouble);

/* Finish all files, and write final.state beside them. */
scree_status scree_output_keep(struct scree_output *output, scree_scene *scene, scree_trouble *trouble);

/* Close everything; the unfinished tables stay under their temporary names (*.part). After keep it only frees memory. */
void scree_output_drop(struct scree_output *output);

#endif
