/* Bodies that meet others alike, so that few stand for all when a scene is checked and its step is chosen. */
#include "engine/plan.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Softness of a box under springs at the four corners of a face, 1/kg summed over the corners: the largest eigenvalue
 * of its motions, which is at least that of one corner alone. Along the normal the box heaves, pitches and rolls,
 * sideways it slides (and tilts with it) or yaws; by symmetry these don't mix, so the largest of them counts. */
static double box_softness(const struct scree_bodies *bodies, int k, int tangential) {
    const struct scree_inertia *inertia = &scree_kind_of(bodies, k)->inertia;
    const double *half = scree_attitude_of(bodies, k)->half, *w = inertia->inverse_moments;
    double centre = bodies->record[k].inverse_mass, softest = 0.0, a2[3];
    for (int axis = 0; axis < 3; axis++) a2[axis] = half[axis] * half[axis];
    for (int axis = 0; axis < 3; axis++) {
        int u = (axis + 1) % 3, v = (axis + 2) % 3;
        double normal = fmax(centre, fmax(a2[v] * w[u], a2[u] * w[v]));
        double slide = centre + a2[axis] * fmax(w[u], w[v]), yaw = (a2[u] + a2[v]) * w[axis];
        softest = fmax(softest, 4.0 * (tangential ? fmax(slide, yaw) : normal));
    }
    /* One corner: at most its whole lever for the softest axis, and at most all axes, each with the lever across it. */
    double whole = (a2[0] + a2[1] + a2[2]) * fmax(w[0], fmax(w[1], w[2]));
    double each = (a2[1] + a2[2]) * w[0] + (a2[2] + a2[0]) * w[1] + (a2[0] + a2[1]) * w[2];
    return fmax(softest, centre + fmin(whole, each));
}

double scree_softness(const struct scree_bodies *bodies, int k, int tangential) {
    if (scree_kind_of(bodies, k)->shape.kind == SCREE_BOX &&
        bodies->record[k].inverse_mass + scree_kind_of(bodies, k)->inertia.inverse_moments[0] > 0)
        return box_softness(bodies, k, tangential);
    double centre = bodies->record[k].inverse_mass, radius = bodies->record[k].radius;
    return tangential ? centre + radius * radius * scree_kind_of(bodies, k)->inertia.inverse_moments[0] : centre;
}

static double merit_of(const struct scree_bodies *bodies, int k, enum scree_merit merit) {
    if (merit == SCREE_LIGHTEST) return bodies->record[k].inverse_mass;
    if (merit == SCREE_ROUNDEST) return bodies->record[k].radius;
    return scree_softness(bodies, k, merit == SCREE_SOFTEST_SIDEWAYS);
}

static void enter(const struct scree_bodies *bodies, int k, enum scree_merit merit, int pick[2]) {
    double value = merit_of(bodies, k, merit);
    if (pick[0] < 0 || value > merit_of(bodies, pick[0], merit)) {
        pick[1] = pick[0];
        pick[0] = k;
    } else if (pick[1] < 0 || value > merit_of(bodies, pick[1], merit)) {
        pick[1] = k;
    }
}

static void list_picks(struct scree_species *species) {
    for (int p = 0; p < 2 * SCREE_MERITS; p++) {
        int body = species->pick[p / 2][p % 2], known = body < 0;
        for (int k = 0; k < species->standing; k++) known |= species->stands[k] == body;
        if (!known) species->stands[species->standing++] = body;
    }
}

int scree_species_count(const struct scree_scene *scene) { return scene->materials * SCREE_SHAPE_KINDS * 2; }

struct scree_species *scree_sort_into_species(const struct scree_scene *scene) {
    const struct scree_bodies *bodies = &scene->bodies;
    struct scree_species *species = calloc((size_t)scree_species_count(scene), sizeof *species);
    if (!species) return NULL;
    for (int s = 0; s < scree_species_count(scene); s++) {
        memset(species[s].pick, -1, sizeof species[s].pick);
        species[s].sharp = species[s].held[0] = species[s].held[1] = -1;
    }
    for (int k = 0; k < bodies->count; k++) {
        int index = scree_kind_of(bodies, k)->material * SCREE_SHAPE_KINDS + (int)scree_kind_of(bodies, k)->shape.kind;
        struct scree_species *s = &species[2 * index + scree_joint_can_move(&scree_kind_of(bodies, k)->joint)];
        for (int merit = 0; merit < SCREE_MERITS; merit++) enter(bodies, k, (enum scree_merit)merit, s->pick[merit]);
        s->count++;
        if (scree_kind_of(bodies, k)->shape.kind == SCREE_BOX && bodies->record[k].radius == 0.0) s->sharp = k;
        if (!(bodies->record[k].inverse_mass > 0.0) && s->held[1] < 0) s->held[s->held[0] >= 0] = k;
    }
    for (int s = 0; s < scree_species_count(scene); s++) list_picks(&species[s]);
    return species;
}
