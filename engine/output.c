/* What a run writes into its folder. Numbers in %.17g, so that they read back as the same doubles; times, which are
 * whole steps, in %.15g, so that 0.058 doesn't come out as 0.057999999999999996. */
#include "engine/output.h"

#include "engine/c_locale.h"
#include "engine/scene.h"
#include "engine/vtk.h"

#include <stdlib.h>
#include <string.h>

static const char bodies_header[] = "time_s,body,x_m,y_m,z_m,q_w,q_x,q_y,q_z,vx_m_s,vy_m_s,vz_m_s,wx_rad_s,wy_rad_s,"
                                    "wz_rad_s\n";
static const char contacts_header[] = "time_s,ball,host,corner,x_m,y_m,z_m,nx,ny,nz,overlap_m,closing_m_s,slip_x_m_s,"
                                      "slip_y_m_s,slip_z_m_s,normal_force_N,friction_x_N,friction_y_N,friction_z_N,"
                                      "sliding,force_x_N,force_y_N,force_z_N\n";
static const char energy_header[] =
    "time_s,kinetic_J,rotational_J,potential_J,stored_J,lost_normal_J,lost_tangential_J,"
    "driven_J,balance_J,deepest_overlap\n";
static const char series_header[] =
    "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"1.0\">\n<Collection>\n";
static const char series_end[] = "</Collection>\n</VTKFile>\n";

/* What the scene was read from isn't written over. */
static scree_status check_inputs(const struct scree_output *output, const char *path, scree_trouble *trouble) {
    const struct scree_paths *inputs = &output->request->inputs;
    for (int k = 0; k < inputs->count; k++)
        if (scree_same_file(path, inputs->path[k]))
            return scree_report(trouble, SCREE_BAD_INPUT, NULL,
                                "%s: the scene is read from this file, and results would overwrite it; name another "
                                "folder for them",
                                inputs->path[k]);
    return SCREE_OK;
}

static scree_status open_one(struct scree_output *output, struct scree_out *out, const char *name, const char *header,
                             scree_trouble *trouble) {
    char *path = scree_join(output->folder, name);
    if (!path) return scree_report(trouble, SCREE_NO_MEMORY, NULL, "no memory for a file name");
    scree_status status = check_inputs(output, path, trouble);
    if (!status) status = scree_out_open(out, path, trouble);
    free(path);
    if (!status) fputs(header, out->file);
    return status;
}

/* spheres_000020.vtp and the like, finished or not. */
static int is_frame(const char *name) {
    for (int kind = 0; kind < SCREE_FRAME_KINDS; kind++) {
        const char *word = scree_frame_name((enum scree_frame_kind)kind);
        size_t length = strlen(word);
        if (strncmp(name, word, length) != 0 || name[length] != '_') continue;
        const char *digits = name + length + 1, *end = digits + strspn(digits, "0123456789");
        if (end - digits >= 6 && (strcmp(end, ".vtp") == 0 || strcmp(end, ".vtp.part") == 0)) return 1;
    }
    return 0;
}

/* Put the frames of the folder `part` in their place; NULL: only see whether that can be done. */
static scree_status place_frames(const struct scree_output *output, const char *part, scree_trouble *trouble) {
    char *path = scree_join(output->folder, "frames"), *aside = scree_join(output->folder, "frames.old");
    scree_status status = SCREE_OK;
    if (!path || !aside)
        status = scree_report(trouble, SCREE_NO_MEMORY, NULL, "no memory for a file name");
    else if (part)
        status = scree_replace_folder(part, path, aside, is_frame, trouble);
    else
        status = scree_check_places(path, aside, is_frame, trouble);
    free(path);
    free(aside);
    return status;
}

static scree_status open_frames(struct scree_output *output, scree_trouble *trouble) {
    scree_status status = place_frames(output, NULL, trouble);
    if (status) return status;
    output->frames_part = scree_join(output->folder, "frames.part");
    if (!output->frames_part) return scree_report(trouble, SCREE_NO_MEMORY, NULL, "no memory for a file name");
    scree_clear_folder(output->frames_part, is_frame);
    status = scree_make_folder(output->frames_part, trouble);
    return status ? status : open_one(output, &output->series, "scene.pvd", series_header, trouble);
}

const struct scree_output_table scree_output_tables[SCREE_TABLES] = {{"bodies.csv", SCREE_WRITE_BODIES},
                                                                     {"contacts.csv", SCREE_WRITE_CONTACTS},
                                                                     {"energy.csv", SCREE_WRITE_ENERGY},
                                                                     {"spheres.csv", SCREE_WRITE_SPHERES},
                                                                     {"scene.pvd", SCREE_WRITE_VTK}};

scree_status scree_output_open(struct scree_output *output, const char *folder, const struct scree_run_request *request,
                               scree_trouble *trouble) {
    *output = (struct scree_output){.folder = folder, .request = request};
    scree_status status = scree_make_folder(folder, trouble);
    unsigned write = request->write;
    /* Every run writes a state, so nobody else writes into the folder from here on. */
    if (!status) status = open_one(output, &output->state, "final.state", "", trouble);
    if (!status && write & SCREE_WRITE_BODIES)
        status = open_one(output, &output->bodies, "bodies.csv", bodies_header, trouble);
    if (!status && write & SCREE_WRITE_CONTACTS)
        status = open_one(output, &output->contacts, "contacts.csv", contacts_header, trouble);
    if (!status && write & SCREE_WRITE_ENERGY)
        status = open_one(output, &output->energy, "energy.csv", energy_header, trouble);
    if (!status && write & SCREE_WRITE_SPHERES)
        status = open_one(output, &output->spheres, "spheres.csv", "name,x_m,y_m,z_m,radius_m", trouble);
    if (!status && write & SCREE_WRITE_VTK) status = open_frames(output, trouble);
    if (status) scree_output_drop(output, 0);
    return status;
}

/* A name as a CSV cell (RFC 4180): quoted if it must be, as must blanks around it and the mark of a comment. */
static void put_name(FILE *file, const char *name) {
    size_t length = strlen(name);
    int bare = !strpbrk(name, ",\"\n\r") && length && !strchr(" \t#", name[0]) && !strchr(" \t", name[length - 1]);
    if (bare) {
        fputs(name, file);
        return;
    }
    fputc('"', file);
    for (; *name; name++) {
        if (*name == '"') fputc('"', file);
        fputc(*name, file);
    }
    fputc('"', file);
}

static void put_numbers(FILE *file, const double *values, int count) {
    for (int k = 0; k < count; k++) fprintf(file, ",%.17g", values[k]);
}

static void put_body(FILE *file, const scree_scene *scene, int k) {
    scree_body_state state = scree_scene_body(scene, k);
    fprintf(file, "%.15g,", scree_scene_time(scene));
    put_name(file, scree_scene_body_name(scene, k).text);
    put_numbers(file, state.position, 3);
    put_numbers(file, state.orientation, 4);
    put_numbers(file, state.velocity, 3);
    put_numbers(file, state.spin, 3);
    fputc('\n', file);
}

static void put_bodies(const struct scree_output *output, const scree_scene *scene) {
    const struct scree_run_request *request = output->request;
    for (int k = 0; k < request->bodies; k++) put_body(output->bodies.file, scene, request->body[k]);
    for (int k = 0; request->bodies == 0 && k < scree_scene_bodies(scene); k++)
        if (scree_scene_body_moves(scene, k)) put_body(output->bodies.file, scene, k);
}

static void put_contact(FILE *file, const scree_scene *scene, const scree_contact_state *state) {
    fprintf(file, "%.15g,", scree_scene_time(scene));
    put_name(file, scree_scene_body_name(scene, state->ball).text);
    fputc(',', file);
    put_name(file, scree_scene_body_name(scene, state->host).text);
    fprintf(file, ",%d", state->corner);
    put_numbers(file, state->point, 3);
    put_numbers(file, state->normal, 3);
    put_numbers(file, &state->overlap, 1);
    put_numbers(file, &state->closing, 1);
    put_numbers(file, state->slip, 3);
    put_numbers(file, &state->normal_force, 1);
    put_numbers(file, state->friction, 3);
    fprintf(file, ",%d", state->sliding);
    put_numbers(file, state->force, 3);
    fputc('\n', file);
}

static scree_status put_contacts(struct scree_output *output, scree_scene *scene, scree_trouble *trouble) {
    int count = 0;
    scree_status status = scree_scene_contacts(scene, output->touching, output->touching_capacity, &count);
    if (!status && count > output->touching_capacity) {
        scree_contact_state *grown = realloc(output->touching, 2 * (size_t)count * sizeof *grown);
        if (!grown) return scree_report(trouble, SCREE_NO_MEMORY, NULL, "no memory for %d contacts", count);
        output->touching = grown;
        output->touching_capacity = 2 * count;
        status = scree_scene_contacts(scene, output->touching, output->touching_capacity, &count);
    }
    if (status) {
        *trouble = *scree_scene_trouble(scene);
        return status;
    }
    for (int k = 0; k < count; k++) put_contact(output->contacts.file, scene, &output->touching[k]);
    return SCREE_OK;
}

static scree_status put_energy(struct scree_output *output, scree_scene *scene, scree_trouble *trouble) {
    scree_energy energy;
    scree_status status = scree_scene_energy(scene, &energy);
    if (status) {
        *trouble = *scree_scene_trouble(scene);
        return status;
    }
    const double values[] = {energy.kinetic, energy.rotational,  energy.potential,
                             energy.stored,  energy.lost_normal, energy.lost_tangential,
                             energy.driven,  energy.balance,     scree_scene_deepest(scene, NULL, NULL)};
    fprintf(output->energy.file, "%.15g", scree_scene_time(scene));
    put_numbers(output->energy.file, values, (int)(sizeof values / sizeof values[0]));
    fputc('\n', output->energy.file);
    return SCREE_OK;
}

static scree_status put_frames(struct scree_output *output, scree_scene *scene, scree_trouble *trouble) {
    for (int kind = 0; kind < SCREE_FRAME_KINDS; kind++) {
        char name[64];
        snprintf(name, sizeof name, "%s_%06d.vtp", scree_frame_name((enum scree_frame_kind)kind), output->frames);
        char *path = scree_join(output->frames_part, name);
        if (!path) return scree_report(trouble, SCREE_NO_MEMORY, NULL, "no memory for a file name");
        scree_status status = scree_write_frame(scene, (enum scree_frame_kind)kind, path, trouble);
        free(path);
        if (status) return status;
        fprintf(output->series.file, "<DataSet timestep=\"%.15g\" part=\"%d\" file=\"frames/%s\"/>\n",
                scree_scene_time(scene), kind, name);
    }
    output->frames++;
    return SCREE_OK;
}

scree_status scree_output_row(struct scree_output *output, scree_scene *scene, scree_trouble *trouble) {
    struct scree_c_locale locale = scree_enter_c_locale();
    scree_status status = SCREE_OK;
    if (output->bodies.file) put_bodies(output, scene);
    if (output->contacts.file) status = put_contacts(output, scene, trouble);
    if (!status && output->energy.file) status = put_energy(output, scene, trouble);
    if (!status && output->series.file) status = put_frames(output, scene, trouble);
    scree_leave_c_locale(locale);
    struct scree_out *const all[] = {&output->bodies, &output->contacts, &output->energy, &output->series};
    for (size_t k = 0; !status && k < sizeof all / sizeof all[0]; k++)
        if (all[k]->file && ferror(all[k]->file)) status = scree_out_finish(all[k], trouble);
    return status;
}

scree_status scree_output_state(struct scree_output *output, scree_scene *scene, scree_trouble *trouble) {
    scree_status status = scree_scene_save(scene, output->state.file, output->state.path);
    if (status) *trouble = *scree_scene_trouble(scene);
    return status ? status : scree_out_finish(&output->state, trouble);
}

static int is_moved_sphere(const scree_scene *scene, int k) {
    const struct scree_kind *kind = scree_kind_of(&scene->bodies, scene->bodies.place[k]);
    return kind->shape.kind == SCREE_SPHERE && scree_joint_can_move(&kind->joint);
}

/* The spheres that forces move, as [[spheres]] reads them; with masses, unless densities say them all. */
static scree_status finish_spheres(struct scree_output *output, scree_scene *scene, scree_trouble *trouble) {
    if (!output->spheres.file) return SCREE_OK;
    struct scree_c_locale locale = scree_enter_c_locale();
    FILE *file = output->spheres.file;
    int masses = 0;
    for (int k = 0; k < scree_scene_bodies(scene) && !masses; k++)
        masses = is_moved_sphere(scene, k) && scree_has_own_mass(scene, k);
    fprintf(file, "%s,vx_m_s,vy_m_s,vz_m_s,wx_rad_s,wy_rad_s,wz_rad_s,material\n", masses ? ",mass_kg" : "");
    for (int k = 0; k < scree_scene_bodies(scene); k++) {
        if (!is_moved_sphere(scene, k)) continue;
        scree_shape shape = scree_scene_body_shape(scene, k);
        scree_body_state state = scree_scene_body(scene, k);
        double mass = scree_scene_body_mass(scene, k);
        put_name(file, scree_scene_body_name(scene, k).text);
        put_numbers(file, state.position, 3);
        put_numbers(file, &shape.radius, 1);
        if (masses) put_numbers(file, &mass, 1);
        put_numbers(file, state.velocity, 3);
        put_numbers(file, state.spin, 3);
        fputc(',', file);
        put_name(file, scree_scene_body_material(scene, k));
        fputc('\n', file);
    }
    scree_leave_c_locale(locale);
    return scree_out_finish(&output->spheres, trouble);
}

static scree_status keep_frames(struct scree_output *output, scree_trouble *trouble) {
    if (!output->frames_part) return SCREE_OK;
    scree_status status = place_frames(output, output->frames_part, trouble);
    if (status) return status;
    free(output->frames_part);
    output->frames_part = NULL;
    return SCREE_OK;
}

scree_status scree_output_keep(struct scree_output *output, scree_scene *scene, scree_trouble *trouble) {
    struct scree_out *const all[] = {&output->bodies, &output->contacts, &output->energy,
                                     &output->series, &output->spheres,  &output->state};
    size_t count = sizeof all / sizeof all[0];
    if (output->series.file) fputs(series_end, output->series.file);
    scree_status status = scree_output_state(output, scene, trouble);
    if (!status) status = finish_spheres(output, scene, trouble);
    for (size_t k = 0; !status && k < count; k++) status = scree_out_finish(all[k], trouble);
    if (!status) status = keep_frames(output, trouble);
    for (size_t k = 0; !status && k < count; k++) status = scree_out_keep(all[k], trouble);
    return status;
}

void scree_output_drop(struct scree_output *output, enum scree_rest_of_output rest) {
    int leave = rest != SCREE_REMOVE;
    scree_out_drop(&output->bodies, leave);
    scree_out_drop(&output->contacts, leave);
    scree_out_drop(&output->energy, leave);
    scree_out_drop(&output->series, leave);
    scree_out_drop(&output->spheres, 0);
    scree_out_drop(&output->state, rest == SCREE_LEAVE_STATE);
    if (output->frames_part && !leave) scree_clear_folder(output->frames_part, is_frame);
    free(output->frames_part);
    free(output->touching);
    output->frames_part = NULL;
    output->touching = NULL;
}
