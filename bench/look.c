/* scree-bench look: what a scene of many spheres is like at its start, to compare the states that several programs
 * arrive at. */
#include "bench/bench.h"

#include "engine/scene.h"
#include "engine/scene_file.h"

#include <math.h>
#include <stdlib.h>

static const char help[] =
    "usage: scree-bench look SCENE [--set KEY=VALUE …]\n"
    "\n"
    "Measure the moving spheres of a scene as they start: how many; contacts among all spheres, twice their number a\n"
    "moving sphere (coordination); share of the volume that is filled between a tenth and seven tenths of the height\n"
    "(packing); kinetic and rotational energy a sphere (J); mean height and speed along x (m, m/s); deepest overlap "
    "in\n"
    "radii; normal forces of walls, over the weight: what they bear of it, and what they press sideways.\n"
    "\n"
    "example: scree-bench look data/scenes/bed.toml\n";

struct look {
    int spheres, contacts;
    double low[3], high[3]; /* of what the moving spheres fill */
    double packing, kinetic, rotational, height, speed, deepest;
    double weight, borne, aside; /* N: of the spheres; of the walls' normal forces against gravity, and across it */
};

static int is_grain(const scree_scene *scene, int k) {
    return scree_scene_body_shape(scene, k).kind == SCREE_SPHERE && scree_scene_body_moves(scene, k);
}

static double size_of(const double a[3]) { return vec_norm(vec_from(a)); }

static void look_at_bodies(const scree_scene *scene, struct look *look) {
    for (int axis = 0; axis < 3; axis++) {
        look->low[axis] = HUGE_VAL;
        look->high[axis] = -HUGE_VAL;
    }
    for (int k = 0; k < scree_scene_bodies(scene); k++) {
        if (!is_grain(scene, k)) continue;
        scree_body_state state = scree_scene_body(scene, k);
        double r = scree_scene_body_shape(scene, k).radius, m = scree_scene_body_mass(scene, k);
        for (int axis = 0; axis < 3; axis++) {
            look->low[axis] = fmin(look->low[axis], state.position[axis] - r);
            look->high[axis] = fmax(look->high[axis], state.position[axis] + r);
        }
        look->spheres++;
        look->weight += m * size_of(scene->gravity.vector);
        look->kinetic += 0.5 * m * vec_norm2(vec_from(state.velocity));
        look->rotational += 0.5 * 0.4 * m * r * r * vec_norm2(vec_from(state.spin));
        look->height += state.position[2];
        look->speed += state.velocity[0];
    }
}

/* Volume of a sphere below a height h over its centre (Archimedes). */
static double volume_below(double r, double h) {
    if (h <= -r) return 0.0;
    if (h > r) h = r;
    return 3.14159265358979323846 * (2.0 / 3.0 * r * r * r + r * r * h - h * h * h / 3.0);
}

static void look_at_packing(const scree_scene *scene, struct look *look) {
    double height = look->high[2] - look->low[2], filled = 0.0;
    double bottom = look->low[2] + 0.1 * height, top = look->low[2] + 0.7 * height;
    for (int k = 0; k < scree_scene_bodies(scene); k++) {
        if (!is_grain(scene, k)) continue;
        double z = scree_scene_body(scene, k).position[2], r = scree_scene_body_shape(scene, k).radius;
        filled += volume_below(r, top - z) - volume_below(r, bottom - z);
    }
    look->packing = filled / ((look->high[0] - look->low[0]) * (look->high[1] - look->low[1]) * (top - bottom));
}

static int look_at_contacts(scree_scene *scene, struct look *look) {
    int count = 0, again = 0;
    if (scree_scene_contacts(scene, NULL, 0, &count)) return 1;
    scree_contact_state *state = calloc((size_t)count + 1, sizeof *state);
    if (!state || scree_scene_contacts(scene, state, count, &again)) {
        free(state);
        return 1;
    }
    for (int k = 0; k < count; k++) {
        scree_shape ball = scree_scene_body_shape(scene, state[k].ball);
        int wall = scree_scene_body_shape(scene, state[k].host).kind != SCREE_SPHERE;
        double down =
            vec_dot(vec_from(state[k].normal), vec_from(scene->gravity.vector)) / size_of(scene->gravity.vector);
        look->contacts += !wall;
        look->borne -= wall * state[k].normal_force * down;
        look->aside += wall * state[k].normal_force * sqrt(fmax(1.0 - down * down, 0.0));
        look->deepest = fmax(look->deepest, state[k].overlap / ball.radius);
    }
    free(state);
    return 0;
}

int bench_look(int count, char **words) {
    const char *changes[64];
    int change_count = 0;
    const struct cli_option options[] = {
        {.name = "--set", .list = changes, .list_count = &change_count, .list_capacity = 64}, {0}};
    int code = cli_parse(&count, words, options, help);
    if (code) return code < 0 ? EXIT_GOOD : code;
    if (count != 1) return cli_complain("look takes one scene file (see scree-bench look --help)");
    struct look look = {0};
    scree_scene *scene;
    struct scree_run_request request;
    scree_trouble trouble;
    scree_status status = scree_load_scene(words[0], changes, change_count, 1, &scene, &request, &trouble);
    scree_free_request(&request);
    if (status) {
        cli_complain("%s", trouble.text);
        return cli_exit_code(status);
    }
    look_at_bodies(scene, &look);
    look_at_packing(scene, &look);
    int failed = look_at_contacts(scene, &look);
    scree_scene_destroy(scene);
    if (failed) return cli_complain("no memory for the contacts"), EXIT_MISSED;
    if (!look.spheres) return cli_complain("%s has no spheres that move", words[0]);
    double n = look.spheres;
    printf("spheres,contacts,coordination,packing,kinetic_J,rotational_J,height_m,speed_m_s,deepest_radii,"
           "borne_of_weight,aside_of_weight\n");
    printf("%d,%d,%.4f,%.4f,%.4g,%.4g,%.6g,%.6g,%.4g,%.5f,%.5f\n", look.spheres, look.contacts, 2.0 * look.contacts / n,
           look.packing, look.kinetic / n, look.rotational / n, look.height / n, look.speed / n, look.deepest,
           look.borne / look.weight, look.aside / look.weight);
    return EXIT_GOOD;
}
