/* Frames for ParaView: XML PolyData (.vtp), one file a frame for spheres, for flat-sided bodies and for contacts. */
#ifndef SCREE_ENGINE_VTK_H
#define SCREE_ENGINE_VTK_H

#include "engine/scree.h"

enum scree_frame_kind { SCREE_FRAME_SPHERES, SCREE_FRAME_BOXES, SCREE_FRAME_CONTACTS, SCREE_FRAME_KINDS };

/* "spheres", "boxes", "contacts". */
const char *scree_frame_name(enum scree_frame_kind kind);

/* Write one frame of the scene as it is now. Planes are drawn as squares as large as the rest of the scene. */
scree_status scree_write_frame(scree_scene *scene, enum scree_frame_kind kind, const char *path,
                               scree_trouble *trouble);

#endif
