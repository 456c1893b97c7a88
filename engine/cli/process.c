/* The process model in the planner's loop. */
#include "engine/cli/process.h"

#include "bodies/quat.h"
#include "engine/c_locale.h"
#include "engine/file.h"
#include "engine/scene.h"
#include "engine/scene_file.h"
#include "engine/toml.h"

#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

enum { ASSIGNMENTS = 24, LONGEST = 320, LARGEST_SCENE = 1 << 20 };

/* Lengths of the scene that no task changes, m: of a tine along the way and across, of half the slot between the
 * surfaces; how far tines reach below the plane and above the product, how far surfaces and tines reach beyond the
 * centres of the corners, which meet faces and never edges. */
static const double tine_length = 0.03, tine_width = 0.01, half_slot = 0.003, below = 0.005, above = 0.008,
                    beyond = 2e-4;

/* ---- the scene file ---- */

/* Index of the rule between two materials; -1 if there is none. */
static int find_contact(const struct scree_toml *root, const char *a, const char *b) {
    const struct scree_toml *rules = scree_toml_get(root, "contact");
    int index = 0;
    for (const struct scree_toml *rule = rules ? rules->first : NULL; rule; rule = rule->next, index++) {
        const struct scree_toml *pair = scree_toml_get(rule, "between"), *first = pair ? pair->first : NULL;
        const char *x = first ? first->string : NULL, *y = first && first->next ? first->next->string : NULL;
        if (x && y && ((!strcmp(x, a) && !strcmp(y, b)) || (!strcmp(x, b) && !strcmp(y, a)))) return index;
    }
    return -1;
}

static int has_named(const struct scree_toml *root, const char *array, const char *name) {
    const struct scree_toml *all = scree_toml_get(root, array);
    for (const struct scree_toml *entry = all ? all->first : NULL; entry; entry = entry->next) {
        const struct scree_toml *own = scree_toml_get(entry, "name");
        if (own && own->string && strcmp(own->string, name) == 0) return 1;
    }
    return 0;
}

static scree_status find_parts_of_file(struct process *process, const struct scree_toml *root, scree_trouble *trouble) {
    static const char *const parts[][2] = {
        {"body", "product"},          {"body", "left surface"},    {"body", "right surface"},
        {"body", "left rear tine"},   {"body", "right rear tine"}, {"body", "left front tine"},
        {"body", "right front tine"}, {"motion", "stroke"},        {"motion", "lift"}};
    static const char *const partners[3] = {"surface", "rear tine", "front tine"};
    for (size_t k = 0; k < sizeof parts / sizeof parts[0]; k++)
        if (!has_named(root, parts[k][0], parts[k][1]))
            return scree_report(trouble, SCREE_BAD_INPUT, NULL,
                                "%s: a process model needs a %s \"%s\", as in transport.toml", process->name,
                                parts[k][0], parts[k][1]);
    for (int k = 0; k < 3; k++) {
        process->contact[k] = find_contact(root, "product", partners[k]);
        if (process->contact[k] < 0)
            return scree_report(
                trouble, SCREE_BAD_INPUT, NULL,
                "%s: a process model needs a contact between \"product\" and \"%s\", as in transport.toml",
                process->name, partners[k]);
    }
    return SCREE_OK;
}

scree_status process_load(struct process *process, const char *path, const scree_transport *task,
                          scree_trouble *trouble) {
    *process = (struct process){.name = strdup(path),
                                .length = task->width,
                                .depth = 0.05,
                                .height = 0.012,
                                .mass = 0.03,
                                .gap = task->gap,
                                .distance = task->distance,
                                .static_friction = 0.35,
                                .kinetic_friction = task->friction,
                                .threshold = 1e-3,
                                .tine_stiffness = 1e5,
                                .tine_restitution = 0.5,
                                .surface_stiffness = 4e5,
                                .gravity = task->gravity,
                                .step = 5e-6};
    if (!process->name) return scree_report(trouble, SCREE_NO_MEMORY, NULL, "no memory for a file name");
    process->text = scree_read_file(path, LARGEST_SCENE, &process->size, trouble);
    if (!process->text) return trouble->status;
    struct scree_toml_document document;
    struct scree_c_locale locale = scree_enter_c_locale();
    scree_status status = scree_toml_parse(process->text, process->size, path, &document, trouble);
    if (!status) status = find_parts_of_file(process, document.root, trouble);
    scree_toml_free(&document);
    scree_leave_c_locale(locale);
    return status;
}

void process_free(struct process *process) {
    free(process->text);
    free(process->name);
    process->text = process->name = NULL;
}

/* ---- the scene ---- */

/* Changes to the scene file, one a line of `text`. */
struct changes {
    int count, cut; /* cut: there was too little room */
    const char *list[ASSIGNMENTS];
    char text[ASSIGNMENTS][LONGEST];
    char stroke[SCREE_PROFILE_SEGMENTS * 140];
};

SCREE_PRINTF(2, 3) static void change(struct changes *changes, const char *format, ...) {
    va_list arguments;
    changes->cut |= changes->count == ASSIGNMENTS;
    if (changes->cut) return;
    va_start(arguments, format);
    changes->cut |= vsnprintf(changes->text[changes->count], LONGEST, format, arguments) >= LONGEST;
    va_end(arguments);
    changes->list[changes->count] = changes->text[changes->count];
    changes->count++;
}

/* The profile as rows of a motion table: pieces of degree 5 in the position, or of degree 5 in the velocity. */
static void change_stroke(struct changes *changes, const struct scree_profile *profile) {
    char *text = changes->stroke;
    size_t size = sizeof changes->stroke,
           used = (size_t)snprintf(text, size, "motion.stroke={name=\"stroke\",kind=\"table\",rows=[");
    int jerk = 0;
    for (int k = 0; k < profile->count; k++) jerk |= profile->segment[k].c[6] != 0.0;
    for (int k = 0; k <= profile->count; k++) {
        const struct scree_segment *segment = &profile->segment[k < profile->count ? k : k - 1];
        struct scree_kinematics at = scree_segment_at(segment, k < profile->count ? 0.0 : segment->duration);
        used +=
            (size_t)snprintf(text + used, size - used, "[%.17g,%.17g,%.17g,%.17g", profile->start[k], at.x, at.v, at.a);
        if (jerk) used += (size_t)snprintf(text + used, size - used, ",%.17g", at.j);
        used += (size_t)snprintf(text + used, size - used, "],");
    }
    snprintf(text + used, size - used, "]}");
    changes->list[changes->count++] = text;
}

/* Radius of the product's corners: 2 mm, less for a small product. */
static double rounding(const struct process *p) {
    return fmin(0.002, 0.2 * fmin(p->length, fmin(p->depth, p->height)));
}

/* Tines as high as the product needs: beside the surfaces, or between the corners (through slots of the surfaces, which
 * no corner comes near). */
static void change_tine(struct changes *changes, const struct process *p, const char *name, double x, double side) {
    double corner = 0.5 * p->depth - rounding(p), size = p->height + above + below, width = tine_width,
           inner = corner - fmin(beyond, 0.1 * corner);
    if (p->contacts == PROCESS_EDGES) {
        width = fmin(tine_width, 0.5 * corner);
        inner = 0.25 * corner;
    }
    change(changes, "body.\"%s\".shape={box=[%.17g,%.17g,%.17g]}", name, tine_length, width, size);
    change(changes, "body.\"%s\".position=[%.17g,%.17g,%.17g]", name, x, side * (inner + 0.5 * width),
           0.5 * size - below);
}

/* Surfaces that end just beyond the product's corners, and farther along the way than it can slide between tines. */
static void change_surface(struct changes *changes, const struct process *p, const char *name, double side) {
    double corner = 0.5 * p->depth - rounding(p), outer = corner + fmin(beyond, 0.1 * corner);
    double inner = fmin(half_slot, 0.5 * corner), reach = p->distance + p->gap;
    change(changes, "body.\"%s\".shape={rectangle=[%.17g,%.17g]}", name, 12.0 * reach, outer - inner);
    change(changes, "body.\"%s\".position=[%.17g,%.17g,0]", name, 4.0 * reach, side * 0.5 * (outer + inner));
}

static void change_bodies(struct changes *changes, const struct process *p) {
    double sunk = p->mass * p->gravity / p->surface_stiffness;
    change(changes, "body.product.shape={box=[%.17g,%.17g,%.17g],rounding=%.17g}", p->length, p->depth, p->height,
           rounding(p));
    change(changes, "body.product.mass=%.17g", p->mass);
    change(changes, "body.product.position=[%.17g,0,%.17g]", 0.5 * p->length + p->start, 0.5 * p->height - sunk);
    change_surface(changes, p, "left surface", 1.0);
    change_surface(changes, p, "right surface", -1.0);
    change_tine(changes, p, "left rear tine", -0.5 * tine_length, 1.0);
    change_tine(changes, p, "right rear tine", -0.5 * tine_length, -1.0);
    change_tine(changes, p, "left front tine", p->gap + 0.5 * tine_length, 1.0);
    change_tine(changes, p, "right front tine", p->gap + 0.5 * tine_length, -1.0);
}

/* Rear tines always touch, front tines only if they are to catch. */
static void change_contacts(struct changes *changes, const struct process *p, int caught) {
    change(changes,
           "contact.%d={between=[\"product\",\"surface\"],shared_by=4,"
           "normal={law=\"linear-loading\",stiffness=%.17g,restitution=0.5},"
           "friction={law=\"stick-slip\",static=%.17g,kinetic=%.17g,threshold=%.17g}}",
           p->contact[0], p->surface_stiffness, p->static_friction, p->kinetic_friction, p->threshold);
    for (int tines = 1; tines <= 2; tines++)
        change(changes,
               "contact.%d={between=[\"product\",\"%s tine\"],shared_by=%d,%s%s"
               "normal={law=\"linear-loading\",stiffness=%.17g,restitution=%.17g}}",
               p->contact[tines], tines == 1 ? "rear" : "front", p->contacts == PROCESS_EDGES ? 8 : 4,
               tines == 2 && !caught ? "none=true," : "", p->contacts == PROCESS_CORNERS ? "corners=true," : "",
               p->tine_stiffness, p->tine_restitution);
}

/* The scene for a profile, with front tines that touch (`caught`) or not; NULL after filling `trouble`. */
static scree_scene *make_scene(const struct process *p, const struct scree_profile *profile, double step, int caught,
                               scree_trouble *trouble) {
    struct changes changes = {0};
    change_stroke(&changes, profile);
    change(&changes, "motion.lift={name=\"lift\",kind=\"table\",rows=[[0,0,0,0],[1,0,0,0]]}");
    change(&changes, "gravity=[0,0,%.17g]", -p->gravity);
    change(&changes, "time={end=1.0,step=%.17g}", step);
    change(&changes, "output={write=[]}");
    change_bodies(&changes, p);
    change_contacts(&changes, p, caught);
    if (changes.cut) {
        scree_report(trouble, SCREE_BAD_INPUT, NULL, "no room for all changes to the scene");
        return NULL;
    }
    scree_scene *scene = NULL;
    struct scree_run_request request = {0};
    scree_read_scene(p->text, p->size, p->name, changes.list, changes.count, 1, &scene, &request, trouble);
    scree_free_request(&request);
    return scene;
}

/* ---- what is measured ---- */

enum { MOST_CONTACTS = 64 };

/* Indices of the bodies that matter. */
struct parts {
    int product, rear, front;
};

static struct parts find_parts(const scree_scene *scene) {
    return (struct parts){scree_scene_find_body(scene, "product"), scree_scene_find_body(scene, "left rear tine"),
                          scree_scene_find_body(scene, "left front tine")};
}

/* How far the corners of the product reach along x from its centre. */
static double reach(const struct process *p, const scree_body_state *product) {
    struct mat frame = quat_to_mat(quat_from(product->orientation));
    double r = rounding(p), half[3] = {0.5 * p->length - r, 0.5 * p->depth - r, 0.5 * p->height - r};
    double sum = r;
    for (int k = 0; k < 3; k++) sum += fabs(frame.column[k].x) * half[k];
    return sum;
}

/* Gap between the product's front corners and the front tines, m. */
static double clearance(const struct process *p, const scree_scene *scene, struct parts parts) {
    scree_body_state product = scree_scene_body(scene, parts.product);
    double front = scree_scene_body(scene, parts.front).position[0] - 0.5 * tine_length;
    return front - product.position[0] - reach(p, &product);
}

/* Forces of rear and front tines on the product, and of all on it along x. */
static scree_status forces(scree_scene *scene, double *rear, double *front, double *along) {
    scree_contact_state contact[MOST_CONTACTS];
    int count = 0;
    scree_status status = scree_scene_contacts(scene, contact, MOST_CONTACTS, &count);
    if (!status && count > MOST_CONTACTS)
        status = scree_scene_stop(scene, scree_scene_time(scene), -1, -1, "more contacts than the process has");
    *rear = *front = *along = 0.0;
    for (int k = 0; !status && k < count; k++) {
        double x = contact[k].normal_force * contact[k].normal[0];
        if (strstr(scree_scene_body_name(scene, contact[k].host).text, "rear")) *rear += x;
        if (strstr(scree_scene_body_name(scene, contact[k].host).text, "front")) *front -= x;
        *along += contact[k].force[0];
    }
    return status;
}

enum { MOST_STEPS = 1000000000 };

/* Steps of at most `largest` that make up `duration`; 0 if they are more than anyone could wait for. */
static long steps_in(double duration, double largest) {
    double steps = ceil(duration / largest * (1.0 - 1e-12));
    return steps <= MOST_STEPS ? (long)steps : 0;
}

/* Every tine is `x` from where it started, and nowhere else. */
static int tines_at(const scree_scene *scene, const struct process *p, double x) {
    static const char *const names[4] = {"left rear tine", "right rear tine", "left front tine", "right front tine"};
    int good = 1;
    for (int k = 0; k < 4; k++) {
        scree_body_state tine = scree_scene_body(scene, scree_scene_find_body(scene, names[k]));
        double start = k < 2 ? -0.5 * tine_length : p->gap + 0.5 * tine_length,
               height = 0.5 * (p->height + above - below);
        good &= fabs(tine.position[0] - start - x) <= 1e-9 * (p->gap + x) &&
                fabs(tine.position[2] - height) <= 1e-9 * p->gap;
    }
    return good;
}

scree_status process_check(const struct process *p, scree_trouble *trouble) {
    enum { STEPS = 10 };
    /* At a constant speed at which the product is hardly pressed in. */
    struct scree_kinematics at = {.v = 1e-3};
    struct scree_segment segment = scree_velocity_segment(1.0, 0.0, at, at);
    struct scree_profile profile = {0};
    scree_profile_append(&profile, &segment);
    scree_scene *scene = make_scene(p, &profile, p->step, 1, trouble);
    if (!scene) return trouble->status;
    scree_status status = scree_scene_step(scene, STEPS);
    if (status)
        *trouble = *scree_scene_trouble(scene);
    else if (!tines_at(scene, p, scree_profile_at(&profile, STEPS * p->step).x))
        status = scree_report(
            trouble, SCREE_BAD_INPUT, NULL,
            "%s: the four tines must have the joint { x = \"stroke\", z = \"lift\", others = \"fixed\" }", p->name);
    scree_scene_destroy(scene);
    return status;
}

static scree_status look_at_catch(const struct process *p, const struct scree_profile *profile, double until,
                                  scree_catch *result, scree_trouble *trouble) {
    long steps = steps_in(until, p->step);
    if (steps == 0)
        return scree_report(trouble, SCREE_FAILED, NULL, "%g s take more than %d steps of %g s", until, MOST_STEPS,
                            p->step);
    scree_scene *scene = make_scene(p, profile, until / (double)steps, 0, trouble);
    if (!scene) return trouble->status;
    scree_status status = scree_scene_step(scene, steps);
    double rear, front, along;
    if (!status) status = forces(scene, &rear, &front, &along);
    if (status) {
        *trouble = *scree_scene_trouble(scene);
    } else {
        struct parts parts = find_parts(scene);
        result->clearance = clearance(p, scene, parts);
        result->velocity = scree_scene_body(scene, parts.product).velocity[0];
        result->acceleration = along / p->mass;
    }
    scree_scene_destroy(scene);
    return status;
}

int process_catch(void *context, const struct scree_profile *profile, double until, scree_catch *result) {
    scree_trouble trouble = {0};
    scree_status status = look_at_catch(context, profile, until, result, &trouble);
    snprintf(result->cause, sizeof result->cause, "%.399s", trouble.text);
    return status != SCREE_OK;
}

static struct process_sample sample(const struct process *p, scree_scene *scene, struct parts parts) {
    double along;
    scree_body_state comb = scree_scene_body(scene, parts.rear), product = scree_scene_body(scene, parts.product);
    struct process_sample s = {.time = scree_scene_time(scene),
                               .comb = comb.position[0] + 0.5 * tine_length,
                               .comb_velocity = comb.velocity[0],
                               .product = product.position[0] - 0.5 * p->length,
                               .product_velocity = product.velocity[0]};
    if (forces(scene, &s.push, &s.catch_force, &along)) s.push = s.catch_force = NAN;
    return s;
}

/* Relative speed and gap at the end of a step. */
struct nearing {
    double time, gap, speed;
};

/* Keep the largest forces, and the first touch: where the gap, taken as straight over the step, vanishes. */
static void note(struct process_run *run, const struct process_sample *s, struct nearing *last, double gap) {
    struct nearing now = {s->time, gap, s->product_velocity - s->comb_velocity};
    run->catch_force = fmax(run->catch_force, s->catch_force);
    run->push_force = fmax(run->push_force, s->push);
    if (run->touched == 0.0 && gap <= 0.0) {
        double share = last->gap / (last->gap - now.gap);
        run->touched = last->time + share * (now.time - last->time);
        run->approach = fabs(last->speed + share * (now.speed - last->speed));
    }
    *last = now;
}

/* Longest time of a run, s: friction stops whatever the comb has thrown, bounces between the tines lose speed too, and
 * twice the comb's largest is more than restitution can give. The rest is for the creep at the end. */
static double longest_run(const struct process *p, double duration, double fastest) {
    /* The creep at the end decays from the threshold to 1e-9 m/s like exp(-mu_s g t/threshold): in 30 time constants if
     * the threshold is below 1e4 m/s. */
    double creep = 30.0 * p->threshold / (p->static_friction * p->gravity);
    return duration + 2.0 + creep + 2.0 * fastest / (p->kinetic_friction * p->gravity);
}

scree_status process_check_length(const struct process *p, double duration, double fastest, scree_trouble *trouble) {
    double longest = longest_run(p, duration, fastest);
    if (steps_in(longest, p->step)) return SCREE_OK;
    return scree_report(
        trouble, SCREE_FAILED, NULL,
        "a run may last %.3g s, until friction (%.3g m/s^2) has stopped the product: more than %d steps "
        "of %g s",
        longest, p->kinetic_friction * p->gravity, MOST_STEPS, p->step);
}

/* Step until the comb has arrived and the product rests. */
static scree_status run_to_rest(const struct process *p, scree_scene *scene, const struct scree_profile *profile,
                                double deadline, struct process_run *run, struct process_sample *s) {
    struct parts parts = find_parts(scene);
    scree_status status = SCREE_OK;
    double duration = scree_profile_duration(profile), shown = -1.0;
    *s = sample(p, scene, parts);
    struct nearing last = {.gap = clearance(p, scene, parts)};
    /* At rest as slow as the regularised friction lets it be: what is left of the way is below 1e-12 m. */
    while (!status && (s->time < duration || fabs(s->product_velocity) > 1e-9)) {
        if (s->time >= deadline)
            return scree_report(&run->trouble, SCREE_FAILED, NULL,
                                "the product still moves at %.3g m/s %.3g s after the comb has stopped",
                                s->product_velocity, s->time - duration);
        if (run->watch && s->time >= shown + run->every * (1.0 - 1e-9)) {
            run->watch(run->context, s);
            shown = s->time;
        }
        status = scree_scene_step(scene, 1);
        *s = sample(p, scene, parts);
        note(run, s, &last, clearance(p, scene, parts));
    }
    if (status) run->trouble = *scree_scene_trouble(scene);
    return status;
}

scree_status process_simulate(const struct process *p, const struct scree_profile *profile, double target,
                              struct process_run *run) {
    struct scree_extrema extrema = scree_profile_extrema(profile);
    double duration = scree_profile_duration(profile), fastest = fmax(extrema.largest.v, -extrema.least.v);
    run->error = run->approach = run->touched = run->catch_force = run->push_force = 0.0;
    if (process_check_length(p, duration, fastest, &run->trouble)) return SCREE_FAILED;
    scree_scene *scene = make_scene(p, profile, duration / (double)steps_in(duration, p->step), 1, &run->trouble);
    if (!scene) return run->trouble.status;
    struct process_sample s;
    scree_status status = run_to_rest(p, scene, profile, longest_run(p, duration, fastest), run, &s);
    run->error = s.product - target;
    scree_scene_destroy(scene);
    return status;
}
