/* The plan of a scene in words: what runs, what is skipped and why, the step and what dictated it. */
#include "contact/impact.h"
#include "engine/adaptive.h"
#include "engine/c_locale.h"
#include "engine/scene.h"

#include <math.h>

static void describe_bodies(const scree_scene *scene, FILE *file) {
    const struct scree_scene_plan *plan = &scene->plan;
    fprintf(file, "bodies: %d (%d moved by forces, %d driven, %d fixed)\n", scene->bodies.count, plan->free,
            plan->driven, plan->fixed);
    if (scene->bodies.periodic) fprintf(file, "periodic along");
    for (int axis = 0, any = 0; axis < 3; axis++)
        if (scene->bodies.period[axis] > 0.0)
            fprintf(file, "%s %c, every %.6g m", any++ ? "," : "", "xyz"[axis], scene -> bodies.period[axis]);
    if (scene->bodies.periodic) fprintf(file, "\n");
    fprintf(file, "pairs of bodies: %ld, of which %ld can meet\n", plan->pairs_all, plan->pairs_meeting);
    if (plan->pairs_still)
        fprintf(file, "  skipped: %ld, since forces move neither body (fixed or driven)\n", plan->pairs_still);
    if (plan->pairs_none)
        fprintf(file, "  skipped: %ld, since the bodies pass through each other (none = true, or walls)\n",
                plan->pairs_none);
}

static struct scree_shown material_name(const scree_scene *scene, int index) {
    return scree_shown(scene->material[index].name);
}

static struct scree_shown body_name(const scree_scene *scene, int index) {
    return scree_shown(scree_name_of(scene, index).text);
}

static void describe_creep(const struct scree_friction_law *law, const struct scree_law_constants *constants,
                           FILE *file) {
    double largest = scree_largest_coefficient(law, constants);
    fprintf(file,
            "    has no true rest: creeps at %.4g m/s under half and %.4g m/s under 0.9 of the largest "
            "friction force\n",
            scree_creep_speed(law, constants, 0.5 * largest), scree_creep_speed(law, constants, 0.9 * largest));
}

/* The lightest body of a material, -1: none. `movable` 0: one that forces don't move. */
static int lightest(const scree_scene *scene, int material, int movable, int other_than) {
    const struct scree_bodies *bodies = &scene->bodies;
    int found = -1;
    for (int number = 0; number < bodies->count; number++) {
        int k = bodies->place[number];
        double inverse = bodies->record[k].inverse_mass;
        if (scree_kind_of(bodies, k)->material != material || (inverse > 0.0) != movable || k == other_than) continue;
        if (found < 0 || inverse > bodies->record[found].inverse_mass) found = k;
    }
    return found;
}

/* The lightest pair of bodies that a rule is for; 0 if there is none. */
static int lightest_pair(const scree_scene *scene, const struct scree_rule *rule, int pair[2]) {
    double least = HUGE_VAL;
    for (int movable = 0; movable < 3; movable++) { /* one that moves with one that doesn't, and two that move */
        int i = lightest(scene, rule->material[0], movable != 0, -1);
        int j = lightest(scene, rule->material[1], movable != 1, i);
        if (i < 0 || j < 0) continue;
        if (scree_contacts_rule(&scene->contacts, &scene->bodies, i, j, NULL) != rule) continue;
        double mass = scree_effective_mass(&scene->bodies, i, j);
        if (!(mass > 0.0 && mass < least)) continue;
        least = mass;
        pair[0] = i;
        pair[1] = j;
    }
    return least < HUGE_VAL;
}

/* What a head-on impact of the lightest pair comes to, up to the speed that the step reckons with. */
static void describe_impacts(const scree_scene *scene, const struct scree_rule *rule, FILE *file) {
    int pair[2] = {0};
    if (!lightest_pair(scene, rule, pair)) return;
    const struct scree_normal_law *law = scree_normal_laws[rule->normal];
    double mass = scree_effective_mass(&scene->bodies, pair[0], pair[1]) / rule->share;
    double radius = scree_radius_of_pair(&scene->bodies, pair[0], pair[1]);
    struct scree_pair_constants of_pair = law->pair(&rule->normal_constants, mass, radius);
    fprintf(file, "    impacts of \"%s\" with \"%s\", head-on:\n", body_name(scene, scene->bodies.number[pair[0]]).text,
            body_name(scene, scene->bodies.number[pair[1]]).text);
    for (int k = 2; k >= 0; k--) {
        double speed = scene->plan.choice.speed * (k == 2 ? 0.01 : k == 1 ? 0.1 : 1.0);
        struct scree_impact impact = scree_impact(law, &rule->normal_constants, of_pair, mass, speed, 0.0, NULL, NULL);
        fprintf(file, "      at %.3g m/s: restitution %.4f, contact time %.4g s, overlap %.4g m\n", speed,
                impact.restitution, impact.duration, impact.deepest);
    }
}

static void describe_rule(const scree_scene *scene, const struct scree_rule *rule, FILE *file) {
    fprintf(file, "  \"%s\" with \"%s\": ", material_name(scene, rule->material[0]).text,
            material_name(scene, rule->material[1]).text);
    if (!rule->touches) {
        fprintf(file, "none\n");
        return;
    }
    const struct scree_friction_law *friction = rule->friction >= 0 ? scree_friction_laws[rule->friction] : NULL;
    fprintf(file, "%s, %s", scree_normal_laws[rule->normal]->text.name,
            friction ? friction->text.name : "frictionless");
    if (rule->rolling >= 0) fprintf(file, ", rolling %s", scree_rolling_laws[rule->rolling]->text.name);
    if (rule->share > 1.0) fprintf(file, ", stiffness and damping shared by %g contacts", rule->share);
    fprintf(file, "%s\n", rule->corners ? ", boxes by corners only" : "");
    if (friction && !friction->memory && friction->slope(&rule->friction_constants) > 0.0)
        describe_creep(friction, &rule->friction_constants, file);
    describe_impacts(scene, rule, file);
}

static void describe_order(const scree_scene *scene, FILE *file) {
    const struct scree_order *order = &scene->bodies.order;
    if (!order->slabs) return;
    fprintf(file, "bodies in the order of space: %d balls in %d slabs across %c", scene->bodies.count - order->members,
            order->slabs, "xyz"[order->axis[0]]);
    int most = scree_scene_most_in_sweep(scene);
    if (most > 1) fprintf(file, ", up to %d steps in one sweep through them where nothing goes fast", most);
    fprintf(file, "\n");
}

static void describe_near(const scree_scene *scene, FILE *file) {
    static const char *const names[SCREE_GEOMETRIES] = {
        "ball on ball", "ball on plane", "ball on rectangle", "ball on box", "ball on the image of a ball",
        "edge on edge"};
    long near[SCREE_GEOMETRIES] = {0};
    for (int b = 0; b < scene->contacts.batches; b++)
        near[scene->contacts.batch[b].geometry] += scene->contacts.batch[b].count;
    fprintf(file, "contacts in the first list, of what may touch soon:");
    int any = 0;
    for (int g = 0; g < SCREE_GEOMETRIES; g++)
        if (near[g]) fprintf(file, "%s %ld %s", any++ ? "," : "", near[g], names[g]);
    fprintf(file, any ? "\n" : " none\n");
    const struct scree_scene_plan *plan = &scene->plan;
    if (plan->start_share > 0.0)
        fprintf(file, "deepest overlap at the start: %.4g m, %.2g of the tolerable, \"%s\" with \"%s\"\n",
                plan->start_overlap, plan->start_share, body_name(scene, plan->start_ball).text,
                body_name(scene, plan->start_host).text);
}

static const char *integrator_name(scree_integrator integrator) {
    return integrator == SCREE_PAIR_IMPULSE ? "pair-impulse" : "verlet";
}

/* What the trial impacts of one rule have found. */
static void describe_trial(const scree_scene *scene, const struct scree_rule_trial *trial, FILE *file) {
    scree_integrator own = scene->time.integrator;
    scree_integrator other = own == SCREE_VERLET ? SCREE_PAIR_IMPULSE : SCREE_VERLET;
    const struct scree_trial_result *result = &trial->result[own], *spare = &trial->result[other];
    if (trial->pair[0] < 0) return;
    fprintf(file, "    \"%s\" with \"%s\": ", body_name(scene, trial->pair[0]).text,
            body_name(scene, trial->pair[1]).text);
    if (trial->impact.stays) {
        fprintf(file, "skipped, since they stay together; 1/50 of the contact\n");
        return;
    }
    fprintf(file, "%.4g steps per contact of %.4g s, error found %.2g", result->per_contact, trial->impact.duration[0],
            result->error);
    if (spare->reached)
        fprintf(file, " (%s: %.4g steps)", integrator_name(other), spare->per_contact);
    else if (spare->per_contact > 0.0)
        fprintf(file, " (%s: not reached)", integrator_name(other));
    fprintf(file, "\n");
}

/* Why the step is as it is, where the scene has left that to the engine. */
static void describe_rule_of_step(const scree_scene *scene, FILE *file) {
    const char *cut = "";
    if (scene->plan.choice.bound_by_damping)
        cut = scene->time.integrator == SCREE_PAIR_IMPULSE
                  ? ", here cut to 1/2 of the stability limit because of damping or friction"
                  : ", here cut to 1/5 of the stability limit because of damping or friction";
    if (!scene->plan.trial) {
        fprintf(file, "  rule: 1/50 of the shortest contact%s\n", cut);
        return;
    }
    fprintf(file, "  rule: rebounds within %g of the impact speed, by trial impacts%s%s\n", scene->time.accuracy,
            scene->contacts.rules && scene->plan.any_integrator ? ", with the integrator that is the cheaper" : "",
            cut);
    for (int k = 0; k < scene->contacts.rules; k++) describe_trial(scene, &scene->plan.trial[k], file);
}

static void describe_adaptive(const scree_scene *scene, FILE *file) {

    const struct scree_step_choice *choice = &scene->plan.choice;
    fprintf(file, "integrator: adaptive (Dormand-Prince 8(5,3)), tolerance of a step: %.3g\n", scene->time.tolerance);
    fprintf(file, "step: as long as the tolerance allows; the scene is looked at every %.9g s\n", choice->step);
    fprintf(file, "  events located: touch, end of contact, changes of a law%s\n",
            scene->bodies.motions ? ", breaks of motions" : "");
    int fly = scree_adaptive_can_fly(scene);
    fprintf(file, "  free flight: %s\n",
            scene->time.no_flight ? "integrated, as asked (flight = false)"
            : fly                 ? "straight to the next possible touch while nothing touches"
                                  : "integrated, since motions drive a body or tilt gravity");
    for (int k = 0; k < scene->contacts.rules; k++) {
        const struct scree_rule *rule = &scene->contacts.rule[k];
        const struct scree_friction_law *law = rule->friction >= 0 ? scree_friction_laws[rule->friction] : NULL;
        if (!rule->touches || !law) continue;
        fprintf(file, "  \"%s\" with \"%s\": %s\n", material_name(scene, rule->material[0]).text,
                material_name(scene, rule->material[1]).text,
                law->hold   ? "sticks and slips, each change located"
                : law->rate ? "bristles, integrated with the motion"
                : law->slope(&rule->friction_constants) > 0.0
                    ? "friction that grows with speed, steps short enough for its slope"
                    : "friction without memory");
    }
    if (choice->shortest_pair[0] < 0) {
        fprintf(file, "  nothing can touch\n");
        return;
    }
    fprintf(file, "  the shortest contact lasts %.4g s: \"%s\" with \"%s\", at impacts of up to %.4g m/s (%s)\n",
            choice->duration, body_name(scene, choice->shortest_pair[0]).text,
            body_name(scene, choice->shortest_pair[1]).text, choice->speed,
            choice->speed_given ? "given" : "estimated");
}

static void describe_step(const scree_scene *scene, FILE *file) {
    const struct scree_step_choice *choice = &scene->plan.choice;
    if (scene->time.integrator == SCREE_ADAPTIVE) {
        describe_adaptive(scene, file);
        return;
    }
    int chosen = scene->plan.any_integrator && !scene->plan.trial; /* else the trials say why */
    if (scene->time.integrator == SCREE_PAIR_IMPULSE)
        fprintf(file, "integrator: pair-impulse%s, %d substep%s of a contact in a step, with friction %d\n",
                chosen ? " (chosen: only few spheres are moved by forces)" : "",
                scene->time.substeps ? scene->time.substeps : 1, scene->time.substeps > 1 ? "s" : "",
                scene->time.substeps ? scene->time.substeps : 2);
    else
        fprintf(file, "integrator: verlet%s\n",
                !chosen                   ? ""
                : scene->time.sleep > 0.0 ? " (chosen: bodies may sleep)"
                                          : " (chosen: many bodies, or boxes, are moved by forces)");
    if (scene->time.sleep > 0.0)
        fprintf(file,
                "sleep: below %.3g m/s, while forces are balanced within %.3g m/s^2; beyond %.3g m/s^2 they wake\n",
                scene->time.sleep, scene->contacts.rest.pull, 4.0 * scene->contacts.rest.pull);
    fprintf(file, "step: %.9g s, %s\n", choice->step,
            scene->plan.trial   ? "by accuracy"
            : choice->automatic ? "automatic"
                                : "as given");
    if (scene->time.watch == SCREE_WATCH_HALVE)
        fprintf(file, "  halved where the run goes wrong, up to %d times\n", SCREE_HALVINGS);
    if (choice->shortest_pair[0] < 0) {
        fprintf(file, "  nothing can touch\n");
        return;
    }
    fprintf(file, "  the shortest contact lasts %.4g s (%.3g steps): \"%s\" with \"%s\"\n", choice->duration,
            choice->duration / choice->step, body_name(scene, choice->shortest_pair[0]).text,
            body_name(scene, choice->shortest_pair[1]).text);
    fprintf(file, "  stable up to: %.4g s, \"%s\" with \"%s\"%s\n", choice->limit,
            body_name(scene, choice->limit_pair[0]).text, body_name(scene, choice->limit_pair[1]).text,
            choice->step > choice->limit ? "  (FORCED BEYOND IT)" : "");
    if (choice->automatic) describe_rule_of_step(scene, file);
    if (choice->automatic && scene->time.divide > 0.0)
        fprintf(file, "  lowered so that %.9g s (between rows, or of the whole run) is a whole number of steps: %.0f\n",
                scene->time.divide, scene->time.divide / choice->step);
    fprintf(file, "  reckons with impacts up to %.4g m/s (%s)\n", choice->speed,
            choice->speed_given ? "given"
                                : "estimated from velocities, motions and heights; set time.speed if you know better");
}

static void describe_stages(const scree_scene *scene, FILE *file) {
    const struct scree_contacts *contacts = &scene->contacts;
    int memory = 0, friction = 0, frictionless = 0, regularised = 0, rolling = 0;
    for (int k = 0; k < contacts->rules; k++) {
        const struct scree_rule *rule = &contacts->rule[k];
        const struct scree_friction_law *law = rule->friction >= 0 ? scree_friction_laws[rule->friction] : NULL;
        friction += law != NULL;
        frictionless += rule->touches && !law;
        memory += (law && law->memory) || (rule->touches && scree_normal_laws[rule->normal]->memory) ||
                  (rule->rolling >= 0 && scree_rolling_laws[rule->rolling]->memory);
        rolling += rule->rolling >= 0;
        regularised += law && law->slope(&rule->friction_constants) > 0.0;
    }
    int impulses = scene->time.integrator == SCREE_PAIR_IMPULSE, adaptive = scene->time.integrator == SCREE_ADAPTIVE;
    if (adaptive)
        fprintf(file, "runs each evaluation: place bodies, contacts that touch, rates%s\n",
                scene->time.energy ? "; each row: energy books" : "");
    else
        fprintf(file, "runs each step: look ahead, %s, normal law%s%s%s, impulses%s, advance%s\n",
                impulses ? "look now, gather both, inside each contact" : "gather", friction ? ", friction law" : "",
                rolling ? ", rolling law" : "", memory ? ", contact memory" : "", impulses ? " and moments" : "",
                scene->time.energy ? ", energy books" : "");
    fprintf(file, "skipped:\n  search for contacts, until a body has moved %.3g m\n", 0.5 * contacts->skin);
    if (frictionless)
        fprintf(file, "  friction in %d kind%s of contact: frictionless\n", frictionless, frictionless > 1 ? "s" : "");
    if (!memory) fprintf(file, "  contact memory: no law keeps any\n");
    if (!friction && !rolling && scene->plan.general == 0)
        fprintf(file, "  torques and spins: nothing turns frictionless spheres\n");
    if (scene->plan.balls)
        fprintf(file, "  attitudes of %d free spheres: no contact depends on them\n", scene->plan.balls);
    if (scene->plan.fixed)
        fprintf(file, "  motion of %d fixed bod%s\n", scene->plan.fixed, scene->plan.fixed > 1 ? "ies" : "y");
    if (!regularised) fprintf(file, "  watch on the slope of friction: no law is regularised by velocity\n");
    if (!scene->gravity.tilts) fprintf(file, "  tilting of gravity\n");
    if (!scene->time.energy) fprintf(file, "  energy books: not asked for\n");
}

void scree_scene_describe(const scree_scene *scene, FILE *file) {
    if (scene->baked != 1) {
        fprintf(file, "no plan: the scene has not been baked%s\n", scene->baked ? " successfully" : "");
        return;
    }
    struct scree_c_locale locale = scree_enter_c_locale();
    describe_bodies(scene, file);
    fprintf(file, "materials in contact:\n");
    for (int k = 0; k < scene->contacts.rules; k++) describe_rule(scene, &scene->contacts.rule[k], file);
    describe_order(scene, file);
    describe_near(scene, file);
    describe_step(scene, file);
    describe_stages(scene, file);
    scree_leave_c_locale(locale);
}
