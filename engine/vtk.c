/* Frames for ParaView: XML PolyData with raw appended data (VTK file formats, section "XML File Formats"). */
#include "engine/vtk.h"

#include "bodies/quat.h"

#include "engine/file.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_ARRAYS = 8 };

/* One array of the file: `components` values of `type` for each of `count` points or cells. */
struct array {
    const char *name, *type;
    int components;
    size_t count, size; /* entries; bytes of one component */
    const void *data;
};

/* A frame: points, polygons (or single points), arrays on the points. */
struct frame {
    size_t points, cells, corners; /* corners: points in all cells together */
    double *point;                 /* [points][3] */
    int64_t *connectivity, *offset;
    int arrays;
    struct array array[MOST_ARRAYS]; /* data owned */
};

const char *scree_frame_name(enum scree_frame_kind kind) {
    static const char *const names[SCREE_FRAME_KINDS] = {"spheres", "boxes", "contacts"};
    return names[kind];
}

static int make_frame(struct frame *frame, size_t points, size_t cells, size_t corners) {
    *frame = (struct frame){.points = points, .cells = cells, .corners = corners};
    frame->point = calloc(points + 1, 3 * sizeof(double));
    frame->connectivity = calloc(corners + 1, sizeof(int64_t));
    frame->offset = calloc(cells + 1, sizeof(int64_t));
    return frame->point && frame->connectivity && frame->offset;
}

static void free_frame(struct frame *frame) {
    free(frame->point);
    free(frame->connectivity);
    free(frame->offset);
    for (int k = 0; k < frame->arrays; k++) free((void *)(uintptr_t)frame->array[k].data);
}

/* A new array of doubles on the points; NULL if there is no memory. */
static double *add_doubles(struct frame *frame, const char *name, int components) {
    double *data = calloc(frame->points + 1, (size_t)components * sizeof *data);
    if (data)
        frame->array[frame->arrays++] = (struct array){name, "Float64", components, frame->points, sizeof *data, data};
    return data;
}

static int32_t *add_integers(struct frame *frame, const char *name) {
    int32_t *data = calloc(frame->points + 1, sizeof *data);
    if (data) frame->array[frame->arrays++] = (struct array){name, "Int32", 1, frame->points, sizeof *data, data};
    return data;
}

/* ---- writing ---- */

static void declare(FILE *file, const struct array *array, uint64_t *offset) {
    fprintf(file,
            "<DataArray type=\"%s\" Name=\"%s\" NumberOfComponents=\"%d\" format=\"appended\" "
            "offset=\"%llu\"/>\n",
            array->type, array->name, array->components, (unsigned long long)*offset);
    *offset += sizeof(uint64_t) + array->count * array->size * (size_t)array->components;
}

static void append(FILE *file, const struct array *array) {
    uint64_t bytes = array->count * array->size * (size_t)array->components;
    fwrite(&bytes, sizeof bytes, 1, file);
    fwrite(array->data, 1, bytes, file);
}

static void write_polydata(FILE *file, const struct frame *frame, const char *cells) {
    const uint16_t one = 1;
    const char *order = *(const unsigned char *)&one ? "LittleEndian" : "BigEndian";
    struct array points = {"Points", "Float64", 3, frame->points, sizeof(double), frame->point};
    struct array connectivity = {"connectivity", "Int64", 1, frame->corners, sizeof(int64_t), frame->connectivity};
    struct array offsets = {"offsets", "Int64", 1, frame->cells, sizeof(int64_t), frame->offset};
    int polygons = strcmp(cells, "Polys") == 0;
    uint64_t offset = 0;
    fprintf(file,
            "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"%s\" "
            "header_type=\"UInt64\">\n<PolyData>\n",
            order);
    fprintf(file,
            "<Piece NumberOfPoints=\"%zu\" NumberOfVerts=\"%zu\" NumberOfLines=\"0\" NumberOfStrips=\"0\" "
            "NumberOfPolys=\"%zu\">\n<Points>\n",
            frame->points, polygons ? 0 : frame->cells, polygons ? frame->cells : 0);
    declare(file, &points, &offset);
    fprintf(file, "</Points>\n<%s>\n", cells);
    declare(file, &connectivity, &offset);
    declare(file, &offsets, &offset);
    fprintf(file, "</%s>\n<PointData>\n", cells);
    for (int k = 0; k < frame->arrays; k++) declare(file, &frame->array[k], &offset);
    fprintf(file, "</PointData>\n</Piece>\n</PolyData>\n<AppendedData encoding=\"raw\">\n_");
    append(file, &points);
    append(file, &connectivity);
    append(file, &offsets);
    for (int k = 0; k < frame->arrays; k++) append(file, &frame->array[k]);
    fprintf(file, "\n</AppendedData>\n</VTKFile>\n");
}

/* ---- filling ---- */

/* Each point is a cell of its own. */
static void single_points(struct frame *frame) {
    for (size_t k = 0; k < frame->cells; k++) {
        frame->connectivity[k] = (int64_t)k;
        frame->offset[k] = (int64_t)k + 1;
    }
}

static int fill_spheres(const scree_scene *scene, struct frame *frame) {
    size_t count = 0;
    for (int k = 0; k < scree_scene_bodies(scene); k++) count += scree_scene_body_shape(scene, k).kind == SCREE_SPHERE;
    if (!make_frame(frame, count, count, count)) return 0;
    double *radius = add_doubles(frame, "radius_m", 1), *velocity = add_doubles(frame, "velocity_m_s", 3);
    double *spin = add_doubles(frame, "spin_rad_s", 3);
    int32_t *body = add_integers(frame, "body");
    if (!radius || !velocity || !spin || !body) return 0;
    single_points(frame);
    size_t n = 0;
    for (int k = 0; k < scree_scene_bodies(scene); k++) {
        scree_shape shape = scree_scene_body_shape(scene, k);
        if (shape.kind != SCREE_SPHERE) continue;
        scree_body_state state = scree_scene_body(scene, k);
        memcpy(frame->point + 3 * n, state.position, sizeof state.position);
        memcpy(velocity + 3 * n, state.velocity, sizeof state.velocity);
        memcpy(spin + 3 * n, state.spin, sizeof state.spin);
        radius[n] = shape.radius;
        body[n++] = k;
    }
    return 1;
}

/* Half the extent of everything but planes, m: how large planes are drawn. */
static double scene_extent(const scree_scene *scene) {
    double extent = 0.0;
    for (int k = 0; k < scree_scene_bodies(scene); k++) {
        scree_shape shape = scree_scene_body_shape(scene, k);
        if (shape.kind == SCREE_PLANE) continue;
        scree_body_state state = scree_scene_body(scene, k);
        for (int axis = 0; axis < 3; axis++)
            extent = fmax(extent, fabs(state.position[axis]) + scree_shape_bound(&shape));
    }
    return extent > 0.0 ? extent : 1.0;
}

/* The corners of a box, bits of k for +x, +y, +z; or of a face, k = 0 … 3. */
static void put_corners(const scree_shape *shape, const scree_body_state *state, double extent, int corners,
                        double *point) {
    struct mat frame = quat_to_mat(quat_from(state->orientation));
    double half[3] = {0.5 * shape->edge[0], 0.5 * shape->edge[1], 0.5 * shape->edge[2]};
    if (shape->kind == SCREE_PLANE) half[0] = half[1] = extent;
    if (shape->kind != SCREE_BOX) half[2] = 0.0;
    for (int k = 0; k < corners; k++) {
        struct vec p = vec(k & 1 ? half[0] : -half[0], k & 2 ? half[1] : -half[1], k & 4 ? half[2] : -half[2]);
        vec_store(vec_add(vec_from(state->position), mat_apply(&frame, p)), point + 3 * k);
    }
}

static int fill_boxes(const scree_scene *scene, struct frame *frame) {
    static const int face[6][4] = {{0, 1, 3, 2}, {4, 6, 7, 5}, {0, 4, 5, 1}, {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 5, 7, 3}};
    size_t points = 0, cells = 0;
    for (int k = 0; k < scree_scene_bodies(scene); k++) {
        scree_shape_kind kind = scree_scene_body_shape(scene, k).kind;
        points += kind == SCREE_BOX ? 8 : kind == SCREE_SPHERE ? 0 : 4;
        cells += kind == SCREE_BOX ? 6 : kind == SCREE_SPHERE ? 0 : 1;
    }
    if (!make_frame(frame, points, cells, 4 * cells)) return 0;
    double *velocity = add_doubles(frame, "velocity_m_s", 3);
    int32_t *body = add_integers(frame, "body");
    if (!velocity || !body) return 0;
    double extent = scene_extent(scene);
    size_t n = 0, c = 0;
    for (int k = 0; k < scree_scene_bodies(scene); k++) {
        scree_shape shape = scree_scene_body_shape(scene, k);
        if (shape.kind == SCREE_SPHERE) continue;
        scree_body_state state = scree_scene_body(scene, k);
        int corners = shape.kind == SCREE_BOX ? 8 : 4, faces = shape.kind == SCREE_BOX ? 6 : 1;
        put_corners(&shape, &state, extent, corners, frame->point + 3 * n);
        for (int f = 0; f < faces; f++, c++) {
            for (int v = 0; v < 4; v++) frame->connectivity[4 * c + (size_t)v] = (int64_t)n + face[f][v];
            frame->offset[c] = 4 * ((int64_t)c + 1);
        }
        for (int v = 0; v < corners; v++, n++) {
            memcpy(velocity + 3 * n, state.velocity, sizeof state.velocity);
            body[n] = k;
        }
    }
    return 1;
}

static int fill_contacts(scree_scene *scene, struct frame *frame) {
    int count = 0, again = 0;
    if (scree_scene_contacts(scene, NULL, 0, &count)) return 0;
    scree_contact_state *state = calloc((size_t)count + 1, sizeof *state);
    int ok = state && !scree_scene_contacts(scene, state, count, &again) &&
             make_frame(frame, (size_t)count, (size_t)count, (size_t)count);
    double *force = ok ? add_doubles(frame, "force_N", 3) : NULL,
           *overlap = ok ? add_doubles(frame, "overlap_m", 1) : NULL;
    int32_t *ball = ok ? add_integers(frame, "ball") : NULL, *host = ok ? add_integers(frame, "host") : NULL;
    ok = ok && force && overlap && ball && host;
    if (ok) single_points(frame);
    for (int k = 0; ok && k < count; k++) {
        memcpy(frame->point + 3 * k, state[k].point, sizeof state[k].point);
        memcpy(force + 3 * k, state[k].force, sizeof state[k].force);
        overlap[k] = state[k].overlap;
        ball[k] = state[k].ball;
        host[k] = state[k].host;
    }
    free(state);
    return ok;
}

scree_status scree_write_frame(scree_scene *scene, enum scree_frame_kind kind, const char *path,
                               scree_trouble *trouble) {
    struct frame frame = {0};
    int filled = kind == SCREE_FRAME_SPHERES ? fill_spheres(scene, &frame)
                 : kind == SCREE_FRAME_BOXES ? fill_boxes(scene, &frame)
                                             : fill_contacts(scene, &frame);
    scree_status status =
        filled ? SCREE_OK
               : scree_report(trouble, SCREE_NO_MEMORY, NULL, "no memory for a frame of %s", scree_frame_name(kind));
    struct scree_out out = {0};
    if (!status) status = scree_out_open(&out, path, trouble);
    if (!status) {
        write_polydata(out.file, &frame, kind == SCREE_FRAME_BOXES ? "Polys" : "Verts");
        status = scree_out_keep(&out, trouble);
    }
    free_frame(&frame);
    return status;
}
