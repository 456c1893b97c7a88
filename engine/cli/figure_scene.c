/* Figures 7 and 10: pictures of the process scene, its bodies and its contacts. */
#include "bodies/quat.h"
#include "engine/cli/figures.h"

#include <math.h>

/* Outline of a flat side or of a box as polylines: points, with an empty line between lines. */
static void put_outline(FILE *file, const scree_scene *scene, int k) {
    static const int path[] = {0, 1, 3, 2, 0, 4, 5, 7, 6, 4, -1, 1, 5, -1, 2, 6, -1, 3, 7};
    scree_shape shape = scree_scene_body_shape(scene, k);
    scree_body_state state = scree_scene_body(scene, k);
    struct mat frame = quat_to_mat(quat_from(state.orientation));
    int points = shape.kind == SCREE_BOX ? (int)(sizeof path / sizeof path[0]) : 5;
    for (int n = 0; n < points; n++) {
        if (path[n] < 0) {
            fprintf(file, "\n");
            continue;
        }
        struct vec p = vec(path[n] & 1 ? 0.5 : -0.5, path[n] & 2 ? 0.5 : -0.5, path[n] & 4 ? 0.5 : -0.5);
        p = vec_times(p, vec(shape.edge[0], shape.edge[1], shape.kind == SCREE_BOX ? shape.edge[2] : 0.0));
        p = vec_add(vec_from(state.position), mat_apply(&frame, p));
        fprintf(file, "\"%s\",%.17g,%.17g,%.17g\n", scree_scene_body_name(scene, k).text, p.x, p.y, p.z);
    }
    fprintf(file, "\n");
}

/* Data sets of the picture: surfaces, product, rear tines, front tines, then the corner spheres' contacts. */
static scree_status write_scene(struct figures *figures, const char *name, scree_scene *scene) {
    static const char *const bodies[4][2] = {{"left surface", "right surface"},
                                             {"product", NULL},
                                             {"left rear tine", "right rear tine"},
                                             {"left front tine", "right front tine"}};
    struct scree_out out;
    scree_status status = figures_table(figures, name, "body,x_m,y_m,z_m", &out);
    if (status) return status;
    for (int set = 0; set < 4; set++) {
        for (int n = 0; n < 2 && bodies[set][n]; n++)
            put_outline(out.file, scene, scree_scene_find_body(scene, bodies[set][n]));
        fprintf(out.file, "\n");
    }
    scree_contact_state contact[32];
    int count = 0;
    status = scree_scene_contacts(scene, contact, 32, &count);
    if (status) {
        figures->trouble = *scree_scene_trouble(scene);
        scree_out_drop(&out, 0);
        return status;
    }
    for (int k = 0; k < count && k < 32; k++) {
        /* Drawn as an arrow whose length grows with the root of the force: weights and impacts differ a hundredfold. */
        double length = 0.01 * sqrt(contact[k].normal_force);
        fprintf(out.file, "\"%s\",%.17g,%.17g,%.17g,%.17g,%.17g,%.17g\n",
                scree_scene_body_name(scene, contact[k].host).text, contact[k].point[0], contact[k].point[1],
                contact[k].point[2], length * contact[k].normal[0], length * contact[k].normal[1],
                length * contact[k].normal[2]);
    }
    return scree_out_keep(&out, &figures->trouble);
}

#define VIEW                                                                                                           \
    "unset datafile columnheaders\nset view 65,28,1.9\nset view equal xyz\nset xyplane at -10\n"                       \
    "set xlabel 'x (mm)'\nset ylabel 'y (mm)' offset -4,0\nset clip two\nset zlabel 'z (mm)' offset "                  \
    "2,0\nset xtics 20\nset ytics 20\nset ztics 10\n"                                                                  \
    "set key top right\n"
#define BODIES(name)                                                                                                   \
    "splot '" name "' index 0 using ($2*1e3):($3*1e3):($4*1e3) with lines ls 5 title 'slide surfaces',\\\n"            \
    "      '' index 1 using ($2*1e3):($3*1e3):($4*1e3) with lines ls 1 lw 3 title 'product',\\\n"                      \
    "      '' index 2 using ($2*1e3):($3*1e3):($4*1e3) with lines ls 3 title 'rear tines',\\\n"                        \
    "      '' index 3 using ($2*1e3):($3*1e3):($4*1e3) with lines ls 4 title 'front tines'"

static const char script_7[] =
    "set title 'Bodies of the process model'\n" VIEW "set xrange [-35:90]\n" BODIES("fig_7.csv") "\n";
static const char script_10[] =
    "set title 'Contacts of the corner spheres while the comb pushes: arrow length as the root of the "
    "force'\n" VIEW "set xrange [-35:90]\n" BODIES(
        "fig_10.csv") ",\\\n"
                      "      '' index 4 using ($2*1e3):($3*1e3):($4*1e3):($5*1e3):($6*1e3):($7*1e3) with "
                      "vectors ls 2 lw 3 title 'contact forces'\n";

/* The scene as it starts, or while the comb pushes. */
static scree_status picture(struct figures *figures, const char *name, const char *script, double time, double *weight,
                            double *push) {
    const char *changes[] = {"output.write=[]"};
    scree_scene *scene = figures_scene(figures, "transport.toml", changes, 1, &figures->trouble);
    if (!scene) return figures->trouble.status;
    scree_status status = scree_scene_step(scene, lround(time / scree_scene_step_length(scene)));
    if (status) figures->trouble = *scree_scene_trouble(scene);
    if (!status) status = write_scene(figures, name, scene);
    scree_contact_state contact[32];
    int count = 0;
    if (!status) status = scree_scene_contacts(scene, contact, 32, &count);
    *weight = *push = 0.0;
    for (int k = 0; k < count && k < 32; k++) {
        *weight += contact[k].normal_force * contact[k].normal[2];
        *push += contact[k].normal_force * contact[k].normal[0];
    }
    scree_scene_destroy(scene);
    if (!status) status = figures_plot(figures, name, script);
    return status;
}

scree_status figure_7(struct figures *figures) {
    double weight, push;
    scree_status status = picture(figures, "fig_7", script_7, 0.0, &weight, &push);
    /* The start position is given to 1e-11 m of an overlap of 0.7 um. */
    if (!status) figures_report(figures, "7", "weight carried at the start (N)", 0.03 * 9.81, weight, 1e-4);
    return status;
}

scree_status figure_10(struct figures *figures) {
    double weight, push;
    scree_status status = picture(figures, "fig_10", script_10, 0.075, &weight, &push);
    if (status) return status;
    /* At a quarter of the rise the comb accelerates at 5.625 s/T^2; tines and surfaces give way a little. */
    double expected = 0.03 * (5.625 * 0.08 / 0.09 + 0.3 * 9.81);
    figures_report(figures, "10", "push of the tines at a quarter of the rise (N)", expected, push, 1e-3);
    figures_report(figures, "10", "weight carried at a quarter of the rise (N)", 0.03 * 9.81, weight, 1e-3);
    return SCREE_OK;
}
