/* Baking: the scene is checked as a whole and turned into a plan, with just the stages that it uses; and the step is
 * chosen from the stiffest contact that can happen. */
#include "contact/grip.h"
#include "contact/meet.h"
#include "contact/rest.h"
#include "engine/hash.h"
#include "engine/scene.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Steps per duration of the shortest contact that step = "auto" asks for, and the share of the stability limit that
 * it never exceeds: of a lone pair with Verlet, of a body among twelve others with pair impulses. */
static const double steps_per_contact = 50.0, share_of_limit = 0.2, share_of_impulse_limit = 0.5;
static const double pi = 3.14159265358979323846;

enum { few_spheres = 1000 };

/* Time of a step of pair impulses over that of a Verlet step, without and with friction, for choosing between them: of impacts 3.2
 * to 4.3 and 5 to 8, of a box that slides 16 (scree-bench precision, data/bench/precision.csv). */
static const double cost_of_impulses[2] = {3.5, 10.0};

/* ---- how soft bodies are ---- */

/* Softness of a box under springs at the four corners of a face, 1/kg summed over the corners: the largest eigenvalue of
 * its motions, which is at least that of one corner alone. Along the normal the box heaves, pitches and rolls, sideways it
 * slides (and tilts with it) or yaws; by symmetry these don't mix, so the largest of them counts. */
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
    double corner = centre + (a2[0] + a2[1] + a2[2]) * fmax(w[0], fmax(w[1], w[2]));
    return fmax(softest, corner);
}

/* Velocity per unit of force that a contact with body k sees from it, 1/kg. */
static double softness(const struct scree_bodies *bodies, int k, int tangential) {
    if (scree_kind_of(bodies, k)->shape.kind == SCREE_BOX &&
        bodies->record[k].inverse_mass + scree_kind_of(bodies, k)->inertia.inverse_moments[0] > 0)
        return box_softness(bodies, k, tangential);
    double centre = bodies->record[k].inverse_mass, radius = bodies->record[k].radius;
    return tangential ? centre + radius * radius * scree_kind_of(bodies, k)->inertia.inverse_moments[0] : centre;
}

/* ---- species: bodies that meet others alike ---- */

/* What makes a body the hardest of its species to follow, in one contact law or another. */
enum merit { LIGHTEST, SOFTEST, SOFTEST_SIDEWAYS, ROUNDEST, MERITS };

/* Bodies of one material, shape kind and mobility. */
struct species {
    long count;
    int pick[MERITS][2];              /* the first and the second by each merit; -1 if there is none */
    int standing, stands[2 * MERITS]; /* the same without repetition: they stand for all */
    int sharp;                        /* a box without rounding; -1: none */
};

static double merit_of(const struct scree_bodies *bodies, int k, enum merit merit) {
    if (merit == LIGHTEST) return bodies->record[k].inverse_mass;
    if (merit == ROUNDEST) return bodies->record[k].radius;
    return softness(bodies, k, merit == SOFTEST_SIDEWAYS);
}

static void enter(const struct scree_bodies *bodies, int k, enum merit merit, int pick[2]) {
    double value = merit_of(bodies, k, merit);
    if (pick[0] < 0 || value > merit_of(bodies, pick[0], merit)) {
        pick[1] = pick[0];
        pick[0] = k;
    } else if (pick[1] < 0 || value > merit_of(bodies, pick[1], merit)) {
        pick[1] = k;
    }
}

static void list_picks(struct species *species) {
    for (int p = 0; p < 2 * MERITS; p++) {
        int body = species->pick[p / 2][p % 2], known = body < 0;
        for (int k = 0; k < species->standing; k++) known |= species->stands[k] == body;
        if (!known) species->stands[species->standing++] = body;
    }
}

static int species_count(const struct scree_scene *scene) { return scene->materials * SCREE_SHAPE_KINDS * 2; }

/* The table of species, to be freed; NULL if there is no memory. */
static struct species *sort_into_species(const struct scree_scene *scene) {
    const struct scree_bodies *bodies = &scene->bodies;
    struct species *species = calloc((size_t)species_count(scene), sizeof *species);
    if (!species) return NULL;
    for (int s = 0; s < species_count(scene); s++) {
        memset(species[s].pick, -1, sizeof species[s].pick);
        species[s].sharp = -1;
    }
    for (int k = 0; k < bodies->count; k++) {
        int index = scree_kind_of(bodies, k)->material * SCREE_SHAPE_KINDS + (int)scree_kind_of(bodies, k)->shape.kind;
        struct species *s = &species[2 * index + scree_joint_can_move(&scree_kind_of(bodies, k)->joint)];
        for (int merit = 0; merit < MERITS; merit++) enter(bodies, k, (enum merit)merit, s->pick[merit]);
        s->count++;
        if (scree_kind_of(bodies, k)->shape.kind == SCREE_BOX && bodies->record[k].radius == 0.0) s->sharp = k;
    }
    for (int s = 0; s < species_count(scene); s++) list_picks(&species[s]);
    return species;
}

/* ---- the step ---- */

/* Overlap at which the elastic energy of a contact equals m v^2/2; NAN for m = 0. */
static double deepest_overlap(const struct scree_normal_law *law, const struct scree_law_constants *constants,
                              struct scree_pair_constants pair, double mass, double speed) {
    double energy = 0.5 * mass * speed * speed, low = 0.0, high = 1e-9;
    while (law->stored(constants, pair, (struct scree_pressing){.overlap = high}) < energy && high < 1e6) high *= 2.0;
    for (int k = 0; k < 60; k++) {
        double middle = 0.5 * (low + high);
        if (law->stored(constants, pair, (struct scree_pressing){.overlap = middle}) < energy)
            low = middle;
        else
            high = middle;
    }
    return high;
}

double scree_radius_of_pair(const struct scree_bodies *bodies, int i, int j) {
    int balls =
        (scree_kind_of(bodies, i)->shape.kind == SCREE_SPHERE) + (scree_kind_of(bodies, j)->shape.kind == SCREE_SPHERE);
    if (balls == 2) return scree_effective_radius(bodies, i, j, SCREE_BALL_BALL);
    if (balls == 1) return bodies->record[scree_kind_of(bodies, i)->shape.kind == SCREE_SPHERE ? i : j].radius;
    return fmax(bodies->record[i].radius, bodies->record[j].radius);
}

struct pair_rates {
    double stiffness;     /* largest eigenvalue of M^-1 K, 1/s^2 */
    double damping;       /* of M^-1 C, 1/s */
    double friction_ramp; /* of the ramp of a velocity-regularised friction law under the pair's own weight, 1/s */
    double reach;         /* of the normal law beyond touch, m */
    double stretch_step;  /* s: beyond it a stretched spring of friction or rolling gains energy */
};

static double weight_on(const struct scree_scene *scene, const struct scree_rule *rule, int i, int j) {
    return vec_norm(vec_from(scene->gravity.vector)) * scree_effective_mass(&scene->bodies, i, j) / rule->share;
}

static struct pair_rates friction_rates(const struct scree_scene *scene, const struct scree_rule *rule, int i, int j,
                                        double mass, double radius, double overlap) {
    const struct scree_friction_law *law = scree_friction_laws[rule->friction];
    const struct scree_law_constants *constants = &rule->friction_constants;
    double tangential = softness(&scene->bodies, i, 1) + softness(&scene->bodies, j, 1);
    struct scree_pair_constants pair = {{0.0}};
    if (law->pair) pair = law->pair(constants, mass, radius);
    return (struct pair_rates){law->stiffness(constants, pair, overlap) * tangential,
                               law->damping(constants, pair, overlap) * tangential,
                               law->slope(constants) * weight_on(scene, rule, i, j) * tangential, 0.0, HUGE_VAL};
}

/* Rolling and sliding of one pair share the spins: the largest eigenvalue is at most the sum of those of each alone. */
static void add_rolling_rates(const struct scree_scene *scene, const struct scree_rule *rule, int i, int j,
                              double radius, struct pair_rates *rates) {
    const struct scree_rolling_law *law = scree_rolling_laws[rule->rolling];
    const struct scree_law_constants *constants = &rule->rolling_constants;
    double turning = 0.0;
    for (int side = 0; side < 2; side++) {
        const double *w = scree_kind_of(&scene->bodies, side ? j : i)->inertia.inverse_moments;
        turning += radius * radius * fmax(w[0], fmax(w[1], w[2]));
    }
    rates->stiffness += law->stiffness(constants) * turning;
    rates->damping += law->damping(constants) * turning;
    rates->friction_ramp += law->slope(constants) * weight_on(scene, rule, i, j) * turning;
}

/* Stretches are summed up from predicted velocities, which makes the characteristic polynomial
 * (l - 1)^2 (l + h C/2 - h^2 K/4) + h^2 K l^2 + h C l (l - 1): a swing grows by (h^2 K)^2/8 - h C/2 a step, without damping at any
 * step (2e-6 where the step is 1/50 of a contact). The step at which that is 0.2 %. */
static double stretch_step(struct pair_rates sideways) {
    double k = sideways.stiffness, c = sideways.damping, low = 0.0, high = k > 0.0 ? 2.0 / sqrt(k) : HUGE_VAL;
    if (!(k > 0.0) || 2.0 - 0.5 * high * c < 2e-3) return HUGE_VAL; /* the limit of every spring is lower */
    for (int n = 0; n < 60; n++) {
        double middle = 0.5 * (low + high), square = middle * middle * k;
        if (square * square / 8.0 - 0.5 * middle * c < 2e-3)
            low = middle;
        else
            high = middle;
    }
    return low;
}

static struct pair_rates rates_of(const struct scree_scene *scene, const struct scree_rule *rule, int i, int j,
                                  double speed) {
    const struct scree_bodies *bodies = &scene->bodies;
    const struct scree_normal_law *law = scree_normal_laws[rule->normal];
    double normal = softness(bodies, i, 0) + softness(bodies, j, 0);
    double mass = scree_effective_mass(bodies, i, j) / rule->share;
    if (mass == 0.0) mass = 1.0 / normal; /* bodies that only turn */
    double radius = scree_radius_of_pair(bodies, i, j);
    struct scree_pair_constants pair = law->pair(&rule->normal_constants, mass, radius);
    double overlap = deepest_overlap(law, &rule->normal_constants, pair, mass, speed);
    struct scree_normal_force at =
        law->force(&rule->normal_constants, pair, (struct scree_pressing){overlap, speed, 0.0, 0.0});
    /* With the memory of that overlap: some laws are much stiffer on the way back. */
    struct scree_normal_force less =
        law->force(&rule->normal_constants, pair, (struct scree_pressing){0.999 * overlap, speed, at.first, at.second});
    double stiffness = (at.elastic - less.elastic) / (0.001 * overlap);
    struct pair_rates rates = {stiffness * normal, fmax(at.damping, less.damping) * normal, 0.0, 0.0, HUGE_VAL};
    struct pair_rates sideways = {0.0, 0.0, 0.0, 0.0, HUGE_VAL};
    if (law->reach) rates.reach = law->reach(&rule->normal_constants, pair);
    if (rule->friction >= 0) sideways = friction_rates(scene, rule, i, j, mass, radius, overlap);
    if (rule->rolling >= 0) add_rolling_rates(scene, rule, i, j, radius, &sideways);
    rates.stretch_step = stretch_step(sideways);
    rates.stiffness = fmax(rates.stiffness, sideways.stiffness);
    rates.damping = fmax(rates.damping, sideways.damping);
    rates.friction_ramp = sideways.friction_ramp;
    return rates;
}

/* Step at which h^2 K + 4 h C = 4: beyond it position Verlet with predicted velocities is unstable. From the
 * scheme's characteristic polynomial l^3 - 2 l^2 + l + h^2 K l^2 + h C (3 l^2 - 4 l + 1)/2 at l = -1, which is
 * where the first root leaves the unit circle (the other Jury conditions are weaker). */
static double stable_step(struct pair_rates rates) {
    double c = rates.damping + rates.friction_ramp, k = rates.stiffness;
    double root = 2.0 * c + sqrt(4.0 * c * c + 4.0 * k);
    return root > 0.0 ? 4.0 / root : HUGE_VAL;
}

/* The same for pair impulses, 1/h as a broken line over w = sqrt(K) and C below which no block of spheres with 12 neighbours
 * each grew, whatever its damping ratio; the others' extrapolated forces set it, not the pair's own motion. */
static double stable_impulse_step(struct pair_rates rates) {
    double c = rates.damping + rates.friction_ramp, w = sqrt(rates.stiffness);
    double rate = fmax(fmin(1.2 * w + 3.25 * c, 2.05 * w + 1.125 * c), 2.15 * c);
    return rate > 0.0 ? 1.0 / rate : HUGE_VAL;
}

/* Height that a body could fall through: from the highest to the lowest along gravity. */
static double fall_height(const struct scree_scene *scene) {
    struct vec g = vec_from(scene->gravity.vector);
    double size = vec_norm(g), low = HUGE_VAL, high = -HUGE_VAL;
    for (int k = 0; size > 0.0 && k < scene->bodies.count; k++) {
        double height = -vec_dot(g, vec_from(scene->bodies.position[k])) / size;
        low = fmin(low, height);
        high = fmax(high, height);
    }
    return high > low ? high - low : 0.0;
}

static double fastest_motion(const struct scree_motion *motion) {
    double fastest = 0.0;
    for (int k = 0; k < motion->count; k++) {
        double start = motion->pieces[k].start;
        double end = k + 1 < motion->count ? motion->pieces[k + 1].start : start + 1.0;
        for (int part = 0; part < 32; part++)
            fastest = fmax(fastest, fabs(scree_motion_at(motion, start + (end - start) * part / 32.0).velocity));
    }
    return fastest;
}

/* Largest impact speed to reckon with: what the bodies and the drives have, and what a fall adds. */
static double estimate_speed(const struct scree_scene *scene) {
    const struct scree_bodies *bodies = &scene->bodies;
    double fastest = 0.0, driven = 0.0;
    for (int k = 0; k < bodies->count; k++) {
        double spin = vec_norm(scree_bodies_spin(bodies, k, 0.0));
        double reach = scree_kind_of(bodies, k)->shape.kind == SCREE_PLANE ? 0.0 : bodies->record[k].bound;
        fastest = fmax(fastest, vec_norm(vec_from(bodies->state[k].v)) + spin * reach);
        for (int axis = 0; axis < 3; axis++)
            if (scree_kind_of(bodies, k)->joint.along[axis] == SCREE_DRIVEN)
                driven =
                    fmax(driven, fastest_motion(&bodies->motion[scree_kind_of(bodies, k)->joint.along_motion[axis]]));
        if (scree_kind_of(bodies, k)->joint.turn == SCREE_DRIVEN)
            driven = fmax(driven, reach * fastest_motion(&bodies->motion[scree_kind_of(bodies, k)->joint.turn_motion]));
    }
    double fall = sqrt(2.0 * vec_norm(vec_from(scene->gravity.vector)) * fall_height(scene));
    double speed = fastest + driven + fall;
    return speed > 0.0 ? speed : 1.0;
}

static void note_pair(double value, int i, int j, double *least, int pair[2]) {
    if (!(value < *least)) return;
    *least = value;
    pair[0] = i;
    pair[1] = j;
}

/* The pair of its rule that trial impacts stand for: the one with the shortest contact. The sphere has the mass with which corners
 * that share a load, or one alone, meet; the laws take their constants from that of the bodies, as ever. */
static void note_trial(const struct scree_scene *scene, const struct scree_rule *rule, int i, int j, double duration) {
    struct scree_rule_trial *trial = &scene->plan.trial[rule - scene->contacts.rule];
    const struct scree_bodies *bodies = &scene->bodies;
    if (trial->pair[0] >= 0 && !(duration < trial->duration)) return;
    double lightest = 1.0 / (softness(bodies, i, 0) + softness(bodies, j, 0));
    double mass = scree_effective_mass(bodies, i, j) / rule->share, radius = scree_radius_of_pair(bodies, i, j);
    double half = fmin(scree_shape_half_width(&scree_kind_of(bodies, i)->shape),
                       scree_shape_half_width(&scree_kind_of(bodies, j)->shape));
    if (mass == 0.0) mass = lightest;   /* bodies that only turn */
    if (!(radius > 0.0)) radius = half; /* sharp corners */
    *trial = (struct scree_rule_trial){
        .pair = {i, j},
        .duration = duration,
        .impact = {.rule = rule, .mass = fmin(lightest, mass), .law_mass = mass, .radius = radius}};
}

/* Let the contact of bodies i and j count. */
static void limit_by(const struct scree_scene *scene, int i, int j, struct scree_step_choice *choice) {
    const struct scree_rule *rule = scree_contacts_rule(&scene->contacts, &scene->bodies, i, j, NULL);
    if (!rule) return;
    struct pair_rates rates = rates_of(scene, rule, i, j, choice->speed);
    int impulses = scene->time.integrator == SCREE_PAIR_IMPULSE;
    double stable = impulses ? stable_impulse_step(rates) : stable_step(rates);
    note_pair(fmin(stable, rates.stretch_step), i, j, &choice->limit, choice->limit_pair);
    note_pair(pi / sqrt(rates.stiffness), i, j, &choice->duration, choice->shortest_pair);
    choice->reach = fmax(choice->reach, rates.reach);
    if (scene->plan.trial) note_trial(scene, rule, i, j, pi / sqrt(rates.stiffness));
}

static void find_limits(const struct scree_scene *scene, const struct species *species,
                        struct scree_step_choice *choice) {
    choice->limit = choice->duration = HUGE_VAL;
    choice->reach = 0.0;
    choice->limit_pair[0] = choice->limit_pair[1] = choice->shortest_pair[0] = choice->shortest_pair[1] = -1;
    for (int s = 0; s < species_count(scene); s++)
        for (int t = s; t < species_count(scene); t++)
            for (int a = 0; a < species[s].standing; a++)
                for (int b = s == t ? a + 1 : 0; b < species[t].standing; b++)
                    limit_by(scene, species[s].stands[a], species[t].stands[b], choice);
}

/* ---- the step by accuracy ---- */

static scree_status prepare_trials(struct scree_scene *scene) {
    for (int k = 0; k < scene->contacts.rules; k++) {
        struct scree_rule_trial *trial = &scene->plan.trial[k];
        if (trial->pair[0] < 0) continue;
        trial->impact.speed = scene->plan.choice.speed;
        scree_status status = scree_trial_prepare(&trial->impact, &scene->trouble);
        if (status) return status;
    }
    return SCREE_OK;
}

/* The rule that keeps farthest from the accuracy with this integrator; NULL: all reach it. */
static const struct scree_rule_trial *farthest(const struct scree_scene *scene, scree_integrator integrator) {
    const struct scree_rule_trial *worst = NULL;
    for (int k = 0; k < scene->contacts.rules; k++) {
        const struct scree_rule_trial *trial = &scene->plan.trial[k];
        if (trial->pair[0] < 0 || trial->impact.stays || trial->result[integrator].reached) continue;
        if (!worst || trial->result[integrator].error > worst->result[integrator].error) worst = trial;
    }
    return worst;
}

/* The longest step with which the scene's integrator is accurate enough, s; where bodies stay together, that of step = "auto". */
static scree_status find_accurate(struct scree_scene *scene) {
    const struct scree_time_def *time = &scene->time;
    scene->plan.choice.accurate = HUGE_VAL;
    for (int k = 0; k < scene->contacts.rules; k++) {
        struct scree_rule_trial *trial = &scene->plan.trial[k];
        struct scree_trial_result *result = &trial->result[time->integrator];
        if (trial->pair[0] < 0) continue;
        int substeps = time->integrator == SCREE_PAIR_IMPULSE ? time->substeps : 0;
        double step = trial->duration / steps_per_contact;
        if (!trial->impact.stays) {
            scree_status status =
                scree_trial_search(&trial->impact, time->integrator, substeps, time->accuracy, result, &scene->trouble);
            if (status) return status;
            step = result->step;
        }
        scene->plan.choice.accurate = fmin(scene->plan.choice.accurate, step);
    }
    return SCREE_OK;
}

static double stable_share(const struct scree_scene *scene) {
    double share = scene->time.integrator == SCREE_PAIR_IMPULSE ? share_of_impulse_limit : share_of_limit;
    return share * scene->plan.choice.limit;
}

/* Few spheres: each impact counts, and pair impulses give it more digits for the time it takes. Many, in steady contact, are computed
 * for their mean, which Verlet gets faster; boxes keep more of their energy with it (data/bench/collide.csv). */
static scree_integrator integrator_for(const struct scree_scene *scene) {
    const struct scree_bodies *bodies = &scene->bodies;
    int boxes = 0;
    for (int k = 0; k < bodies->count; k++) {
        const struct scree_kind *kind = scree_kind_of(bodies, k);
        boxes |= scree_joint_can_move(&kind->joint) && kind->shape.kind != SCREE_SPHERE;
    }
    return !boxes && scene->plan.free <= few_spheres ? SCREE_PAIR_IMPULSE : SCREE_VERLET;
}

/* Time per simulated second with the scene's integrator, in Verlet steps. */
static double cost_of_run(const struct scree_scene *scene) {
    double step = fmin(scene->plan.choice.accurate, stable_share(scene));
    int friction = 0;
    for (int k = 0; k < scene->contacts.rules; k++) friction |= scene->contacts.rule[k].friction >= 0;
    return (scene->time.integrator == SCREE_PAIR_IMPULSE ? cost_of_impulses[friction] : 1.0) / step;
}

static scree_status out_of_reach(struct scree_scene *scene) {
    int impulses = scene->plan.any_integrator || scene->time.integrator == SCREE_PAIR_IMPULSE;
    scree_integrator integrator = impulses ? SCREE_PAIR_IMPULSE : SCREE_VERLET;
    const struct scree_rule_trial *worst = farthest(scene, integrator);
    const struct scree_trial_result *result = &worst->result[integrator];
    return scree_report(&scene->trouble, SCREE_BAD_INPUT, "accuracy",
                        "an accuracy of %g can't be reached with the integrator %s: an impact of \"%s\" with \"%s\" at "
                        "%g m/s comes out within %.2g of its speed at %.0f steps per contact; ask for less%s",
                        scene->time.accuracy, impulses ? "pair-impulse" : "verlet",
                        scree_name_of(scene, worst->pair[0]).text, scree_name_of(scene, worst->pair[1]).text,
                        scene->plan.choice.speed, result->error, result->per_contact,
                        !impulses                    ? ", or take integrator = \"pair-impulse\""
                        : scene->plan.any_integrator ? ""
                        : scene->time.substeps < 4   ? ", or take substeps = 4"
                                                     : "");
}

/* Let trial impacts say how long a step may be, and which integrator is the cheaper if none is given. */
static scree_status choose_by_accuracy(struct scree_scene *scene, const struct species *species) {
    struct scree_step_choice *choice = &scene->plan.choice, best = {0};
    static const scree_integrator integrators[] = {SCREE_VERLET, SCREE_PAIR_IMPULSE};
    scree_integrator wanted = scene->time.integrator, taken = wanted;
    double least = HUGE_VAL;
    int found = 0;
    scree_status status = prepare_trials(scene);
    for (int k = 0; k < 2 && !status; k++) {
        if (!scene->plan.any_integrator && integrators[k] != wanted) continue;
        scene->time.integrator = integrators[k];
        find_limits(scene, species, choice);
        status = find_accurate(scene);
        double cost = cost_of_run(scene);
        if (farthest(scene, integrators[k]) || (found && !(cost < least))) continue;
        least = cost;
        best = *choice;
        taken = integrators[k];
        found = 1;
    }
    scene->time.integrator = taken;
    if (status) return status;
    if (!found) return out_of_reach(scene);
    *choice = best;
    return SCREE_OK;
}

/* Room for the trials of all rules. */
static scree_status make_trials(struct scree_scene *scene) {
    struct scree_rule_trial *trial = calloc((size_t)scene->contacts.rules + 1, sizeof *trial);
    if (!trial) return scree_report(&scene->trouble, SCREE_NO_MEMORY, NULL, "no memory for trial impacts");
    for (int k = 0; k < scene->contacts.rules; k++) trial[k].pair[0] = -1;
    scene->plan.trial = trial;
    return SCREE_OK;
}

static double automatic_step(struct scree_scene *scene) {
    const struct scree_time_def *time = &scene->time;
    struct scree_step_choice *choice = &scene->plan.choice;
    double step = time->accuracy > 0.0 ? choice->accurate : choice->duration / steps_per_contact;
    double most = stable_share(scene);
    choice->bound_by_damping = most < step;
    if (choice->bound_by_damping) step = most;
    if (!(step < HUGE_VAL)) step = time->divide > 0.0 ? time->divide / 100.0 : 1e-3; /* nothing can touch */
    if (time->divide > 0.0) step = time->divide / ceil(time->divide / step);
    return step;
}

static scree_status choose_step(struct scree_scene *scene, const struct species *species) {
    struct scree_step_choice *choice = &scene->plan.choice;
    const struct scree_time_def *time = &scene->time;
    scene->plan.any_integrator = time->integrator == SCREE_ANY_INTEGRATOR;
    if (scene->plan.any_integrator)
        scene->time.integrator = scene->time.sleep > 0.0 ? SCREE_VERLET : integrator_for(scene);
    choice->speed_given = time->speed > 0.0;
    choice->speed = choice->speed_given ? time->speed : estimate_speed(scene);
    scree_status status = time->accuracy > 0.0 ? make_trials(scene) : SCREE_OK;
    if (status) return status;
    find_limits(scene, species, choice);
    if (time->accuracy > 0.0) status = choose_by_accuracy(scene, species);
    if (status) return status;
    choice->automatic = time->step == 0.0;
    choice->step = choice->automatic ? automatic_step(scene) : time->step;
    int adaptive = time->integrator == SCREE_ADAPTIVE;
    if (adaptive && choice->automatic) choice->step = time->divide > 0.0 ? time->divide : 1e-3;
    scene->step = choice->step;
    if (adaptive) return SCREE_OK; /* its own steps are as small as they must be */
    if (choice->step <= choice->limit || time->force) return SCREE_OK;
    return scree_report(
        &scene->trouble, SCREE_BAD_INPUT, "step",
        "a step of %g s is beyond the stability limit of the stiffest contact, %g s (\"%s\" with \"%s\" at "
        "%g m/s); take a smaller one or step = \"auto\", or set force = true",
        choice->step, choice->limit, scree_name_of(scene, choice->limit_pair[0]).text,
        scree_name_of(scene, choice->limit_pair[1]).text, choice->speed);
}

/* ---- bodies and contacts ---- */

static scree_body_def definition_of(const void *scene, int index) { return scree_scene_definition(scene, index); }

/* A state replaces where free bodies start, but not where fixed ones are and driven ones count from; and whoever changes a start
 * means another run. */
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

/* After it the definitions of bodies are no longer needed: in large scenes they take more memory than some of the state. */
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

/* Sort all pairs of bodies, species by species, into those that can meet and those that can't; fails on a pair that could
 * meet without a rule. */
static scree_status check_pairs(struct scree_scene *scene, const struct species *species) {
    struct scree_scene_plan *plan = &scene->plan;
    const struct scree_bodies *bodies = &scene->bodies;
    for (int s = 0; s < species_count(scene); s++) {
        for (int t = s; t < species_count(scene); t++) {
            long pairs = s == t ? species[s].count * (species[s].count - 1) / 2 : species[s].count * species[t].count;
            if (pairs == 0) continue;
            int i = species[s].pick[LIGHTEST][0], j = species[t].pick[LIGHTEST][s == t], missing = 0;
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
static scree_status check_sharp(struct scree_scene *scene, const struct species *species) {
    const struct scree_bodies *bodies = &scene->bodies;
    for (int s = 0; s < species_count(scene); s++) {
        for (int t = 0; t < species_count(scene); t++) {
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
static scree_status check_turning(struct scree_scene *scene) {
    const struct scree_bodies *bodies = &scene->bodies;
    for (int i = 0; i < bodies->count; i++) {
        if (!scree_joint_can_move(&scree_kind_of(bodies, i)->joint) || bodies->record[i].inverse_mass > 0.0) continue;
        for (int j = 0; j < bodies->count; j++) {
            const struct scree_rule *rule = scree_contacts_rule(&scene->contacts, bodies, i, j, NULL);
            if (j == i || bodies->record[j].inverse_mass > 0.0 || !rule) continue;
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

static scree_status check_start_overlaps(struct scree_scene *scene) {
    struct scree_contacts *contacts = &scene->contacts;
    for (int b = 0; b < contacts->batches; b++) {
        for (int k = scree_first(&contacts->batch[b]); k >= 0; k = scree_next(&contacts->batch[b], k)) {
            struct scree_touch touch;
            if (!scree_contacts_measure(contacts, &scene->bodies, b, k, &touch)) continue;
            double limit = fmin(scene->bodies.record[touch.ball].limit, scene->bodies.record[touch.host].limit);
            if (touch.overlap <= limit) continue;
            return scree_report(
                &scene->trouble, SCREE_BAD_INPUT, "position",
                "bodies \"%s\" and \"%s\" overlap by %g m at the start; the most that makes sense is %g m",
                scree_name_of(scene, scene->bodies.number[touch.ball]).text,
                scree_name_of(scene, scene->bodies.number[touch.host]).text, touch.overlap, limit);
        }
    }
    return SCREE_OK;
}

static scree_status plan_pairs_and_step(struct scree_scene *scene) {
    struct species *species = sort_into_species(scene);
    if (!species) return scree_report(&scene->trouble, SCREE_NO_MEMORY, NULL, "no memory for the plan");
    scree_status status = check_pairs(scene, species);
    if (!status) status = check_sharp(scene, species);
    if (!status) status = check_turning(scene);
    if (!status) status = choose_step(scene, species);
    free(species);
    return status;
}

/* What the pair-impulse method needs before the first list. */
static scree_status keep_impulses(struct scree_scene *scene) {
    scree_status status = scree_bodies_keep_past(&scene->bodies, &scene->trouble);
    if (!status) status = scree_scene_look_now(scene);
    scree_contacts_keep_impulses(&scene->contacts, scene->time.substeps);
    return status;
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

/* The adaptive integrator doesn't follow edges on edges. Boxes that share an axis are let pass: should their edges touch all the same,
 * the run stops there. */
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
    if (!status && impulses) scree_contacts_begin_past(&scene->contacts, &scene->bodies, &scene->shadow, scene->step);
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
