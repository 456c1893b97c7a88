/* Baking: the scene is checked as a whole and turned into a plan, with just the stages that it uses. */
#include "engine/plan.h"
#include "contact/grip.h"
#include "contact/meet.h"
#include "contact/rest.h"
#include "engine/hash.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double pi = 3.14159265358979323846;

/* ---- bodies and contacts ---- */

static scree_body_def definition_of(const void *scene, int index) { return scree_scene_definition(scene, index); }

/* A state replaces where free bodies start, but not where fixed ones are and driven ones count from; and whoever
 * changes a start means another run. */
static uint64_t print_start(uint64_t hash, const scree_body_def *def) {
    hash = scree_hash_on(hash, def->position, sizeof def->position);
    hash = scree_hash_on(hash, def->orientation, sizeof def->orientation);
    hash = scree_hash_on(hash, def->velocity, sizeof def->velocity);
    return scree_hash_on(hash, def->spin, sizeof def->spin);
}

static void set_period(struct scree_scene *scene) {
    struct scree_bodies *bodies = &scene->bodies;
    for (int axis = 0; axis < 3; axis++) {
        if (!scene->bounded || !scene->domain.periodic[axis]) continue;
        bodies->periodic = 1;
        bodies->low[axis] = scene->domain.min[axis];
        bodies->period[axis] = scene->domain.max[axis] - scene->domain.min[axis];
    }
}

/* After it the definitions of bodies are no longer needed: in large scenes they take more memory than some of the
 * state. */
static scree_status make_bodies(struct scree_scene *scene) {
    struct scree_bodies *bodies = &scene->bodies;
    scree_status status = scree_bodies_create(bodies, scene->defs, scene->motion, scene->motions, &scene->trouble);
    scene->motion = NULL; /* handed over */
    if (status) return status;
    scene->start = scree_hash_start;
    for (int k = 0; k < scene->defs && !status; k++) {
        scree_body_def def = scree_scene_definition(scene, k);
        status = scree_bodies_set(bodies, k, &def, scene->material[def.material].density, &scene->trouble);
        scene->start = print_start(scene->start, &def);
    }
    if (!status) status = scree_bodies_finish(bodies, definition_of, scene, &scene->trouble);
    if (status) return status;
    scree_scene_free_groups(scene);
    set_period(scene);
    scree_bodies_start(bodies, 0.0);
    return SCREE_OK;
}

static void count_bodies(struct scree_scene *scene) {
    struct scree_scene_plan *plan = &scene->plan;
    const struct scree_bodies *bodies = &scene->bodies;
    for (int k = 0; k < bodies->count; k++) {
        int moves = scree_joint_can_move(&scree_kind_of(bodies, k)->joint);
        plan->free += moves;
        plan->fixed += scree_joint_is_fixed(&scree_kind_of(bodies, k)->joint);
        plan->driven += !moves && !scree_joint_is_fixed(&scree_kind_of(bodies, k)->joint);
        plan->balls += bodies->class[k] == SCREE_CLASS_BALL;
        plan->general += bodies->class[k] == SCREE_CLASS_GENERAL;
    }
}

/* Sort all pairs of bodies, species by species, into those that can meet and those that can't; fails on a pair that
 * could meet without a rule. */
static scree_status check_pairs(struct scree_scene *scene, const struct scree_species *species) {
    struct scree_scene_plan *plan = &scene->plan;
    const struct scree_bodies *bodies = &scene->bodies;
    for (int s = 0; s < scree_species_count(scene); s++) {
        for (int t = s; t < scree_species_count(scene); t++) {
            long pairs = s == t ? species[s].count * (species[s].count - 1) / 2 : species[s].count * species[t].count;
            if (pairs == 0) continue;
            int i = species[s].pick[SCREE_LIGHTEST][0], j = species[t].pick[SCREE_LIGHTEST][s == t], missing = 0;
            int still = !scree_joint_can_move(&scree_kind_of(bodies, i)->joint) &&
                        !scree_joint_can_move(&scree_kind_of(bodies, j)->joint);
            const struct scree_rule *rule = scree_contacts_rule(&scene->contacts, bodies, i, j, &missing);
            if (missing)
                return scree_report(
                    &scene->trouble, SCREE_BAD_INPUT, NULL,
                    "bodies \"%s\" and \"%s\" could meet, but there is no contact between their materials "
                    "\"%s\" and \"%s\": add one (or one with none = true, to let them pass through each "
                    "other)",
                    scree_name_of(scene, i).text, scree_name_of(scene, j).text,
                    scene->material[scree_kind_of(bodies, i)->material].name,
                    scene->material[scree_kind_of(bodies, j)->material].name);
            if (rule && rule->rolling >= 0 && scree_kind_of(bodies, i)->shape.kind != SCREE_SPHERE &&
                scree_kind_of(bodies, j)->shape.kind != SCREE_SPHERE)
                return scree_report(
                    &scene->trouble, SCREE_BAD_INPUT, NULL,
                    "the contact of \"%s\" with \"%s\" has a rolling law, but neither is a sphere: only "
                    "spheres roll (give boxes a material of their own)",
                    scree_name_of(scene, i).text, scree_name_of(scene, j).text);
            plan->pairs_all += pairs;
            plan->pairs_meeting += rule ? pairs : 0;
            plan->pairs_still += !rule && still ? pairs : 0;
            plan->pairs_none += !rule && !still ? pairs : 0;
        }
    }
    return SCREE_OK;
}

/* Sharp corners have no radius that a law could use, as Hertz's stiffness does. */
static scree_status check_sharp(struct scree_scene *scene, const struct scree_species *species) {
    const struct scree_bodies *bodies = &scene->bodies;
    for (int s = 0; s < scree_species_count(scene); s++) {
        for (int t = 0; t < scree_species_count(scene); t++) {
            int i = species[s].sharp, j = species[t].count ? species[t].stands[0] : -1;
            if (j == i && j >= 0) j = species[t].standing > 1 ? species[t].stands[1] : -1;
            if (i < 0 || j < 0 || scree_kind_of(bodies, j)->shape.kind == SCREE_SPHERE) continue;
            const struct scree_rule *rule = scree_contacts_rule(&scene->contacts, bodies, i, j, NULL);
            if (!rule) continue;
            const struct scree_normal_law *law = scree_normal_laws[rule->normal];
            struct scree_pair_constants small = law->pair(&rule->normal_constants, 1.0, 1.0);
            struct scree_pair_constants large = law->pair(&rule->normal_constants, 1.0, 2.0);
            if (memcmp(&small, &large, sizeof small) == 0) continue;
            return scree_report(
                &scene->trouble, SCREE_BAD_INPUT, "rounding",
                "the contact of \"%s\" with \"%s\" takes the radius of the corners that touch, and those "
                "of \"%s\" are sharp: give it a rounding, or the contact a stiffness",
                scree_name_of(scene, i).text, scree_name_of(scene, j).text, scree_name_of(scene, i).text);
        }
    }
    return SCREE_OK;
}

/* Bodies that can only turn have no mass that a law could use, as restitution does. */
static scree_status check_turning(struct scree_scene *scene, const struct scree_species *species) {
    const struct scree_bodies *bodies = &scene->bodies;
    for (int s = 0; s < scree_species_count(scene); s++) {
        for (int t = 0; t < scree_species_count(scene); t++) {
            int i = species[s].held[0], j = species[t].held[s == t];
            if (i < 0 || j < 0 || !scree_joint_can_move(&scree_kind_of(bodies, i)->joint)) continue;
            const struct scree_rule *rule = scree_contacts_rule(&scene->contacts, bodies, i, j, NULL);
            if (!rule) continue;
            const struct scree_normal_law *law = scree_normal_laws[rule->normal];
            struct scree_pair_constants light = law->pair(&rule->normal_constants, 1.0, 1.0);
            struct scree_pair_constants heavy = law->pair(&rule->normal_constants, 2.0, 1.0);
            if (memcmp(&light, &heavy, sizeof light) == 0) continue;
            return scree_report(&scene->trouble, SCREE_BAD_INPUT, NULL,
                                "the contact of \"%s\" with \"%s\" asks for a restitution, which takes the bodies' "
                                "mass; but their centres are held and they only turn: give a damping instead",
                                scree_name_of(scene, i).text, scree_name_of(scene, j).text);
        }
    }
    return SCREE_OK;
}

/* Far from the origin numbers are too coarse for places: overlaps are some thousandths of a half-width. */
static scree_status check_distance(struct scree_scene *scene) {
    const struct scree_bodies *bodies = &scene->bodies;
    for (int k = 0; k < bodies->count; k++) {
        double half = scree_shape_half_width(&scree_kind_of(bodies, k)->shape);
        for (int axis = 0; axis < 3; axis++) {
            double far = fabs(bodies->position[k][axis]), coarse = nextafter(far, HUGE_VAL) - far;
            if (coarse <= 1e-6 * half) continue;
            return scree_report(&scene->trouble, SCREE_BAD_INPUT, "position",
                                "body \"%s\" is so far from the origin (%.3g m along %c) that places there are %.2g m "
                                "apart: too coarse for its half-width of %.3g m; move the scene nearer",
                                scree_name_of(scene, bodies->number[k]).text, far, 'x' + axis, coarse, half);
        }
    }
    return SCREE_OK;
}

/* Bodies start in the domain; only what has no end along a periodic axis, or fits into it twice, may be there. */
static scree_status check_domain(struct scree_scene *scene) {
    const struct scree_bodies *bodies = &scene->bodies;
    for (int k = 0; scene->bounded && k < bodies->count; k++) {
        int plane = scree_kind_of(bodies, k)->shape.kind == SCREE_PLANE,
            sphere = scree_kind_of(bodies, k)->shape.kind == SCREE_SPHERE;
        if (bodies->periodic && !plane && !sphere)
            return scree_report(&scene->trouble, SCREE_BAD_INPUT, NULL,
                                "body \"%s\" is a %s: only spheres and planes can be in a periodic domain yet",
                                scree_name_of(scene, k).text, scree_shape_name(scree_kind_of(bodies, k)->shape.kind));
        double normal[3] = {0.0, 0.0, 0.0};
        if (plane) vec_store(scree_attitude_of(bodies, k)->frame.column[2], normal);
        for (int axis = 0; axis < 3; axis++) {
            double x = bodies->position[k][axis], period = bodies->period[axis];
            /* Programs that put bodies back now and then write places that are somewhat beyond a periodic border. */
            double beyond = 0.5 * period, low = scene->domain.min[axis], high = scene->domain.max[axis];
            if (!plane && !(x >= low - beyond && x <= high + beyond))
                return scree_report(&scene->trouble, SCREE_BAD_INPUT, "position",
                                    "body \"%s\" starts outside of the domain: its %c is %.9g m, not %.9g to %.9g m",
                                    scree_name_of(scene, k).text, "xyz"[axis], x, low, high);
            if (sphere && period > 0.0 && period < 4.0 * bodies->record[k].radius)
                return scree_report(&scene->trouble, SCREE_BAD_INPUT, "domain",
                                    "the domain repeats itself every %g m along %c: that must be two diameters of the "
                                    "largest sphere at least, and \"%s\" is %g m wide",
                                    period, "xyz"[axis], scree_name_of(scene, k).text, 2.0 * bodies->record[k].radius);
            /* 1e-9: a normal across the axis, given in decimals. */
            if (plane && period > 0.0 && fabs(normal[axis]) > 1e-9)
                return scree_report(&scene->trouble, SCREE_BAD_INPUT, "orientation",
                                    "plane \"%s\" cuts the axis %c, along which the domain is periodic: it must be "
                                    "along it",
                                    scree_name_of(scene, k).text, "xyz"[axis]);
        }
    }
    return SCREE_OK;
}

/* A body must not meet itself: its image stays beyond what the list looks ahead. */
static scree_status check_period(struct scree_scene *scene) {
    const struct scree_bodies *bodies = &scene->bodies;
    double largest = 0.0;
    for (int k = 0; k < bodies->count; k++) largest = fmax(largest, bodies->record[k].radius);
    for (int axis = 0; axis < 3; axis++)
        if (bodies->period[axis] > 0.0 && bodies->period[axis] <= 2.0 * largest + scene->contacts.skin)
            return scree_report(&scene->trouble, SCREE_BAD_INPUT, "domain",
                                "the domain repeats itself every %g m along %c; with forces that reach as far as "
                                "these, it must be more than %g m",
                                bodies->period[axis], "xyz"[axis], 2.0 * largest + scene->contacts.skin);
    return SCREE_OK;
}

/* Keep the deepest overlap in the plan; one beyond what is tolerable is refused. */
static scree_status check_start_overlaps(struct scree_scene *scene) {
    struct scree_contacts *contacts = &scene->contacts;
    struct scree_scene_plan *plan = &scene->plan;
    for (int b = 0; b < contacts->batches; b++) {
        for (int k = scree_first(&contacts->batch[b]); k >= 0; k = scree_next(&contacts->batch[b], k)) {
            struct scree_touch touch;
            if (!scree_contacts_measure(contacts, &scene->bodies, b, k, &touch)) continue;
            double limit = fmin(scene->bodies.spin[touch.ball].limit, scene->bodies.spin[touch.host].limit);
            if (!(touch.overlap / limit > plan->start_share)) continue;
            plan->start_share = touch.overlap / limit;
            plan->start_overlap = touch.overlap;
            plan->start_ball = scene->bodies.number[touch.ball];
            plan->start_host = scene->bodies.number[touch.host];
        }
    }
    if (!(plan->start_share > 1.0)) return SCREE_OK;
    return scree_report(&scene->trouble, SCREE_BAD_INPUT, "position",
                        "bodies \"%s\" and \"%s\" overlap by %g m at the start; the most that makes sense is %g m",
                        scree_name_of(scene, plan->start_ball).text, scree_name_of(scene, plan->start_host).text,
                        plan->start_overlap, plan->start_overlap / plan->start_share);
}

static scree_status plan_pairs_and_step(struct scree_scene *scene) {
    struct scree_species *species = scree_sort_into_species(scene);
    if (!species) return scree_report(&scene->trouble, SCREE_NO_MEMORY, NULL, "no memory for the plan");
    scree_status status = check_pairs(scene, species);
    if (!status) status = check_sharp(scene, species);
    if (!status) status = check_turning(scene, species);
    if (!status) status = scree_choose_step(scene, species);
    free(species);
    return status;
}

/* What the pair-impulse method needs before the first list; */
static scree_status keep_impulses(struct scree_scene *scene) {
    scree_contacts_keep_impulses(&scene->contacts, scene->time.substeps);
    return scree_bodies_keep_past(&scene->bodies, &scene->trouble);
}

/* and after it, when bodies have their places. The shadow is taken anew: free balls aren't shown in it
 * (contact/starts.h), and what nobody writes takes no memory. */
static scree_status begin_impulses(struct scree_scene *scene) {
    scree_status status = scree_scene_look_now(scene);
    if (status) return status;
    scree_contacts_begin_past(&scene->contacts, &scene->bodies, &scene->shadow, scene->step);
    scree_bodies_free_shadow(&scene->shadow);
    return scree_bodies_shadow(&scene->bodies, &scene->shadow, &scene->trouble);
}

/* When forces count as balanced: within what the slowness asked for comes to in the shortest contact. */
static scree_status allow_sleep(struct scree_scene *scene) {
    double pull = scene->time.sleep * pi / scene->plan.choice.duration, g = vec_norm(vec_from(scene->gravity.vector));
    if (scene->gravity.tilts)
        return scree_report(&scene->trouble, SCREE_BAD_INPUT, "sleep",
                            "no body sleeps while gravity tilts: leave sleep out");
    if (g > 0.0) pull = fmin(pull, 0.01 * g);
    return scree_rest_allow(&scene->contacts, &scene->bodies, scene->time.sleep, pull, &scene->trouble);
}

/* Whether two boxes can meet, and not just as rectangles do, corner on side. */
static int may_cross(const struct scree_scene *scene, int i, int j) {
    const struct scree_bodies *bodies = &scene->bodies;
    if (scree_kind_of(bodies, i)->shape.kind != SCREE_BOX || scree_kind_of(bodies, j)->shape.kind != SCREE_BOX)
        return 0;
    const struct scree_rule *rule = scree_contacts_rule(&scene->contacts, bodies, i, j, NULL);
    if (!rule || rule->corners) return 0;
    struct scree_two_boxes boxes = scree_two_boxes_of(bodies, i, j);
    return !scree_share_axis(&boxes);
}

/* The adaptive integrator doesn't follow edges on edges. Boxes that share an axis are let pass: should their edges
 * touch all the same, the run stops there. */
static scree_status refuse_edges(struct scree_scene *scene) {
    const struct scree_bodies *bodies = &scene->bodies;
    for (int j = 0; j < bodies->count; j++)
        for (int i = 0; i < j; i++)
            if (may_cross(scene, i, j))
                return scree_report(
                    &scene->trouble, SCREE_BAD_INPUT, "integrator",
                    "the integrator \"adaptive\" doesn't know edges on edges, and the boxes \"%s\" and \"%s\" can meet "
                    "so; take \"verlet\", or let their materials meet with corners only (corners = true)",
                    scree_name_of(scene, bodies->number[i]).text, scree_name_of(scene, bodies->number[j]).text);
    return SCREE_OK;
}

static scree_status prepare_adaptive(struct scree_scene *scene) {
    if (scene->bodies.periodic)
        return scree_report(&scene->trouble, SCREE_BAD_INPUT, "integrator",
                            "the integrator \"adaptive\" doesn't know periodic domains; take \"verlet\"");
    for (int k = 0; k < scene->rules; k++) {
        const char *law = scree_grip_refuses(&scene->rule[k]);
        if (law)
            return scree_report(&scene->trouble, SCREE_BAD_INPUT, "integrator",
                                "the integrator \"adaptive\" can't follow the law \"%s\": its force jumps where the "
                                "motion stops, or its memory has rules of its own; take another law, or \"verlet\"",
                                law);
    }
    scree_status status = refuse_edges(scene);
    return status ? status : scree_adaptive_create(scene);
}

static scree_status bake(struct scree_scene *scene) {
    scree_status status = make_bodies(scene);
    if (!status)
        status = scree_contacts_create(&scene->contacts, scene->defs, scene->materials, scene->rule, scene->rules,
                                       &scene->trouble);
    if (!status && scene->time.integrator == SCREE_ADAPTIVE) status = prepare_adaptive(scene);
    if (status) return status;
    count_bodies(scene);
    status = check_domain(scene);
    if (!status) status = check_distance(scene);
    if (!status) status = plan_pairs_and_step(scene);
    int impulses = scene->time.integrator == SCREE_PAIR_IMPULSE; /* the plan may have chosen it */
    if (!status && impulses) status = keep_impulses(scene);
    if (!status && scene->time.sleep > 0.0) status = allow_sleep(scene);
    if (status) return status;
    scree_contacts_choose_skin(&scene->contacts, &scene->bodies, scene->adaptive ? 16 : 256, scene->plan.choice.reach);
    scene->contacts.measured = scene->time.energy;
    scene->contacts.step = scene->adaptive ? 0.0 : scene->step;
    status = check_period(scene);
    if (!status) status = scree_contacts_sort(&scene->contacts, &scene->bodies, 1, &scene->trouble);
    if (!status) status = check_start_overlaps(scene);
    if (!status && impulses) status = begin_impulses(scene);
    if (!status && !impulses && !scene->adaptive) scree_contacts_begin(&scene->contacts, &scene->bodies, scene->step);
    if (status || !scene->time.energy) return status;
    scree_energy energy;
    status = scree_energy_now(scene, &energy);
    scene->first_energy = energy.balance;
    return status;
}

scree_status scree_scene_bake(scree_scene *scene) {
    if (scene->baked)
        return scree_report(&scene->trouble, SCREE_BAD_INPUT, NULL, "%s",
                            scene->baked == 1 ? "the scene is baked already"
                                              : "baking this scene has failed: define it anew");
    if (scene->defs == 0) return scree_report(&scene->trouble, SCREE_BAD_INPUT, NULL, "the scene has no bodies");
    scree_status status = bake(scene);
    scene->baked = status ? -1 : 1;
    return status;
}
