/* What baking a scene consists of (plan.c): bodies that meet others alike, the limits of a step, its choice. */
#ifndef SCREE_ENGINE_PLAN_H
#define SCREE_ENGINE_PLAN_H

#include "engine/scene.h"

/* Velocity per unit of force that a contact with body k sees from it, 1/kg. */
double scree_softness(const struct scree_bodies *bodies, int k, int tangential);

/* What makes a body the hardest of its species to follow, in one contact law or another. */
enum scree_merit { SCREE_LIGHTEST, SCREE_SOFTEST, SCREE_SOFTEST_SIDEWAYS, SCREE_ROUNDEST, SCREE_MERITS };

/* Bodies of one material, shape kind and mobility. */
struct scree_species {
    long count;
    int pick[SCREE_MERITS][2];              /* the first and the second by each merit; -1 if there is none */
    int standing, stands[2 * SCREE_MERITS]; /* the same without repetition: they stand for all */
    int sharp;                              /* a box without rounding; -1: none */
    int held[2];                            /* two whose centres no force moves; -1: none */
};

int scree_species_count(const struct scree_scene *scene);

/* The table of species, to be freed; NULL if there is no memory. */
struct scree_species *scree_sort_into_species(const struct scree_scene *scene);

/* Largest impact speed to reckon with, m/s: what the bodies and the drives have, and what a fall adds. */
double scree_estimate_speed(const struct scree_scene *scene);

/* Stability limit, shortest contact and reach of all contacts that can happen at the choice's speed, for the scene's
 * integrator; of rules on trial, the pair that trial impacts stand for. */
void scree_find_limits(const struct scree_scene *scene, const struct scree_species *species,
                       struct scree_step_choice *choice);

/* Set the scene's step, and its integrator if none was asked for; SCREE_BAD_INPUT for a step beyond the limit or an
 * accuracy out of reach, SCREE_NO_MEMORY. */
scree_status scree_choose_step(struct scree_scene *scene, const struct scree_species *species);

#endif
