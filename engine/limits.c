/* How stiff the contacts of a scene can get, and how long a step they allow. */
#include "contact/meet.h"
#include "engine/plan.h"

#include <math.h>

static const double pi = 3.14159265358979323846;

/* Overlap at which the elastic energy of a contact equals m v^2/2; m > 0. */
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
    double tangential = scree_softness(&scene->bodies, i, 1) + scree_softness(&scene->bodies, j, 1);
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
 * (l - 1)^2 (l + h C/2 - h^2 K/4) + h^2 K l^2 + h C l (l - 1): a swing grows by (h^2 K)^2/8 - h C/2 a step, without
 * damping at any step (2e-6 where the step is 1/50 of a contact). The step at which that is 0.2 %. */
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
    double normal = scree_softness(bodies, i, 0) + scree_softness(bodies, j, 0);
    double mass = scree_effective_mass(bodies, i, j) / rule->share;
    if (mass == 0.0) mass = 1.0 / normal; /* bodies that only turn */
    double radius = scree_radius_of_pair(bodies, i, j);
    struct scree_pair_constants pair = law->pair(&rule->normal_constants, mass, radius);
    double overlap = deepest_overlap(law, &rule->normal_constants, pair, mass, speed);
    struct scree_normal_force at = law->force(&rule->normal_constants, pair, scree_pressed(overlap, speed, 0.0, 0.0));
    /* With the memory of that overlap: some laws are much stiffer on the way back. */
    struct scree_normal_force less =
        law->force(&rule->normal_constants, pair, scree_pressed(0.999 * overlap, speed, at.first, at.second));
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

/* The same for pair impulses, 1/h as a broken line over w = sqrt(K) and C below which no block of spheres with 12
 * neighbours each grew, whatever its damping ratio; the others' extrapolated forces set it, not the pair's own
 * motion. */
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

/* A sine's peak by its rate: the instants that are looked at may all be its turning points. */
static double fastest_motion(const struct scree_motion *motion) {
    double fastest = 0.0;
    for (int k = 0; k < motion->count; k++) {
        const struct scree_motion_piece *piece = &motion->pieces[k];
        double end = k + 1 < motion->count ? motion->pieces[k + 1].start : piece->start + 1.0;
        fastest = fmax(fastest, fabs(piece->amplitude * piece->rate));
        for (int part = 0; part < 32; part++) {
            double time = piece->start + (end - piece->start) * part / 32.0;
            fastest = fmax(fastest, fabs(scree_motion_at(motion, time).velocity));
        }
    }
    return fastest;
}

double scree_estimate_speed(const struct scree_scene *scene) {
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

/* The pair of its rule that trial impacts stand for: the one with the shortest contact. The sphere has the mass with
 * which corners that share a load, or one alone, meet; the laws take their constants from that of the bodies, as
 * ever. */
static void note_trial(const struct scree_scene *scene, const struct scree_rule *rule, int i, int j, double duration) {
    struct scree_rule_trial *trial = &scene->plan.trial[rule - scene->contacts.rule];
    const struct scree_bodies *bodies = &scene->bodies;
    if (trial->pair[0] >= 0 && !(duration < trial->duration)) return;
    double lightest = 1.0 / (scree_softness(bodies, i, 0) + scree_softness(bodies, j, 0));
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

void scree_find_limits(const struct scree_scene *scene, const struct scree_species *species,
                       struct scree_step_choice *choice) {
    choice->limit = choice->duration = HUGE_VAL;
    choice->reach = 0.0;
    choice->limit_pair[0] = choice->limit_pair[1] = choice->shortest_pair[0] = choice->shortest_pair[1] = -1;
    for (int s = 0; s < scree_species_count(scene); s++)
        for (int t = s; t < scree_species_count(scene); t++)
            for (int a = 0; a < species[s].standing; a++)
                for (int b = s == t ? a + 1 : 0; b < species[t].standing; b++)
                    limit_by(scene, species[s].stands[a], species[t].stands[b], choice);
}
