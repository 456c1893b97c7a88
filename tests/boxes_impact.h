/* Random impacts of two boxes in free flight, whose energy tells whether contacts have a potential. */
#ifndef SCREE_TESTS_BOXES_IMPACT_H
#define SCREE_TESTS_BOXES_IMPACT_H

#include "bodies/quat.h"
#include "engine/scene_file.h"
#include "tests/boxes_oracle.h"

#include <stdio.h>
#include <string.h>

struct impact_kind {
    double roundness; /* rounding over half the shortest edge */
    double steps;     /* in pi sqrt(m/k) */
    double depth; /* largest overlap to be expected over the sum of roundings (0.02 of the shortest edge if sharp) */
    const char *damping; /* parameters of "linear-cut" besides the stiffness */
    const char *more;    /* of the contact; may be "" */
    const char *method;  /* integrator; NULL: verlet */
};

struct impact_result {
    int met, stopped;
    double gained,
        balance; /* energy at the end less that at the start, and what the books lack, over that at the start */
};

static inline int impact_write(char *text, size_t size, int used, int body, int shape, double rounding, struct quat q,
                               struct vec x, struct vec v, struct vec w) {
    const double *e = oracle_edges[shape];
    return used +
           snprintf(text + used, size - (size_t)used,
                    "[[body]]\nname = \"%d\"\nmaterial = \"m\"\nshape = { box = [%.17g, %.17g, %.17g], rounding = "
                    "%.17g }\norientation = [%.17g, %.17g, %.17g, %.17g]\nposition = [%.17g, %.17g, %.17g]\n"
                    "velocity = [%.17g, %.17g, %.17g]\nspin = [%.17g, %.17g, %.17g]\n",
                    body, e[0], e[1], e[2], rounding, q.w, q.x, q.y, q.z, x.x, x.y, x.z, v.x, v.y, v.z, w.x, w.y, w.z);
}

/* Mass of a box of 1000 kg/m^3. */
static inline double impact_mass(int shape, double rounding) {
    scree_shape box = {.kind = SCREE_BOX, .rounding = rounding};
    memcpy(box.edge, oracle_edges[shape], sizeof box.edge);
    return 1000.0 * scree_shape_volume(&box);
}

/* The scene of one impact: two boxes of random shape and attitude, just apart, of which the one flies against the other
 * at 1 m/s; both turn. *time receives how long it takes. */
static inline scree_scene *impact_scene(uint64_t *seed, const struct impact_kind *kind, double *time) {
    int first = (int)(ORACLE_SHAPES * oracle_random(seed)), second = (int)(ORACLE_SHAPES * oracle_random(seed));
    double thin_a = oracle_thickness(first), thin_b = oracle_thickness(second), thin = fmin(thin_a, thin_b);
    double rounding_a = 0.5 * kind->roundness * thin_a, rounding_b = 0.5 * kind->roundness * thin_b;
    struct quat q = oracle_attitude(seed), p = oracle_attitude(seed);
    struct vec way = oracle_direction(seed), off = oracle_direction(seed);
    struct vec spin_a = oracle_direction(seed), spin_b = oracle_direction(seed);
    struct oracle_pair pair;
    oracle_box(&pair.a, first, rounding_a, q);
    oracle_box(&pair.b, second, rounding_b, p);
    pair.boxes =
        (struct scree_two_boxes){&pair.a, &pair.b, vec(0.0, 0.0, 0.0), rounding_a, rounding_b, {.factor = 1.0}};
    double gap = 0.02 * thin;
    oracle_bring_together(&pair, way, -gap);
    double mass_a = impact_mass(first, rounding_a), mass_b = impact_mass(second, rounding_b);
    double mass = mass_a * mass_b / (mass_a + mass_b), roundings = rounding_a + rounding_b;
    double deep = roundings > 0.0 ? fmin(kind->depth * roundings, 0.1 * thin) : 0.02 * thin;
    double stiffness = mass / (deep * deep), contact = 3.14159265358979 * deep, step = contact / kind->steps;
    char text[4096];
    int used = snprintf(text, sizeof text,
                        "[time]\nend = 1.0\nintegrator = \"%s\"\nstep = %.17g\nforce = true\n[output]\nwrite = "
                        "[\"energy.csv\"]\n[[material]]\n"
                        "name = \"m\"\ndensity = 1000\n[[contact]]\nbetween = [\"m\", \"m\"]\nnormal = { law = "
                        "\"linear-cut\", stiffness = %.17g, %s }\n%s\n",
                        kind->method ? kind->method : "verlet", step, stiffness, kind->damping, kind->more);
    struct vec velocity = vec_axpy(vec_scale(-1.0, way), 0.3, off), zero = {0.0, 0.0, 0.0};
    used = impact_write(text, sizeof text, used, 0, first, rounding_a, q, pair.boxes.apart, velocity, spin_a);
    impact_write(text, sizeof text, used, 1, second, rounding_b, p, zero, zero, spin_b);
    *time = gap / 0.5 + 12.0 * deep + 2.0 * contact;
    scree_scene *scene = NULL;
    struct scree_run_request request;
    scree_trouble trouble;
    if (scree_read_scene(text, strlen(text), "impact", NULL, 0, 1, &scene, &request, &trouble)) {
        printf("%s\n", trouble.text);
        return NULL;
    }
    scree_free_request(&request);
    return scene;
}

static inline double impact_energy(scree_scene *scene, double *balance) {
    scree_energy energy;
    if (scree_scene_energy(scene, &energy)) return NAN;
    *balance = energy.balance;
    return energy.kinetic + energy.rotational + energy.stored;
}

static inline struct impact_result impact_run(uint64_t *seed, const struct impact_kind *kind) {
    double time, balance = NAN;
    struct impact_result result = {0};
    scree_scene *scene = impact_scene(seed, kind, &time);
    if (!scene) return result;
    double before = impact_energy(scene, &balance);
    result.stopped = scree_scene_step(scene, (long)(time / scree_scene_step_length(scene))) != SCREE_OK;
    result.met = !result.stopped && scree_scene_deepest(scene, NULL, NULL) > 0.0;
    result.gained = impact_energy(scene, &balance) / before - 1.0;
    result.balance = balance / before;
    scree_scene_destroy(scene);
    return result;
}

#endif
