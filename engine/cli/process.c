/* The process model in the planner's loop. */
#include "engine/cli/process.h"

#include "bodies/quat.h"
#include "engine/file.h"
#include "engine/scene_file.h"

#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

enum { ASSIGNMENTS = 24, LONGEST = 320, LARGEST_SCENE = 1 << 20 };

scree_status process_load(struct process *process, const char *path, const scree_transport *task,
                          scree_trouble *trouble) {
    *process = (struct process){.name = path,
                                .length = task->width,
                                .depth = 0.05,
                                .height = 0.012,
                                .mass = 0.03,
                                .gap = task->gap,
                                .static_friction = 0.35,
                                .kinetic_friction = task->friction,
                                .threshold = 1e-3,
                                .tine_stiffness = 1e5,
                                .tine_restitution = 0.5,
                                .surface_stiffness = 4e5,
                                .gravity = task->gravity,
                                .step = 5e-6};
    process->text = scree_read_file(path, LARGEST_SCENE, &process->size, trouble);
    return process->text ? SCREE_OK : trouble->status;
}

void process_free(struct process *process) {
    free(process->text);
    process->text = NULL;
}

/* ---- the scene ---- */

/* Changes to the scene file, one a line of `text`. */
struct changes {
    int count;
    const char *list[ASSIGNMENTS];
    char text[ASSIGNMENTS][LONGEST];
    char stroke[SCREE_PROFILE_SEGMENTS * 140];
};

SCREE_PRINTF(2, 3) static void change(struct changes *changes, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(changes->text[changes->count], LONGEST, format, arguments);
    va_end(arguments);
    changes->list[changes->count] = changes->text[changes->count];
    changes->count++;
}

/* The profile as rows of a motion table: pieces of degree 5 in the position, or of degree 5 in the velocity. */
static void change_stroke(struct changes *changes, const struct scree_profile *profile) {
    char *text = changes->stroke;
    size_t size = sizeof changes->stroke, used = (size_t)snprintf(text, size, "motion.stroke.rows=[");
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
    snprintf(text + used, size - used, "]");
    changes->list[changes->count++] = text;
}

static void change_tine(struct changes *changes, const char *name, double x, double side) {
    change(changes, "body.\"%s\".position=[%.17g,%.17g,0.0075]", name, x, side * 0.0278);
}

/* The scene for a profile, with front tines that touch (`caught`) or not; NULL after filling `trouble`. */
static scree_scene *make_scene(const struct process *p, const struct scree_profile *profile, double step, int caught,
                               scree_trouble *trouble) {
    struct changes changes = {0};
    const double tine = 0.03; /* length of a tine in the scene file */
    double sunk = p->mass * p->gravity / p->surface_stiffness;
    change_stroke(&changes, profile);
    change(&changes, "motion.lift.rows=[[0,0,0,0],[1,0,0,0]]");
    change(&changes, "gravity=[0,0,%.17g]", -p->gravity);
    change(&changes, "time={end=1.0,step=%.17g}", step);
    change(&changes, "output={write=[]}");
    change(&changes, "body.product.shape={box=[%.17g,%.17g,%.17g],rounding=0.002}", p->length, p->depth, p->height);
    change(&changes, "body.product.mass=%.17g", p->mass);
    change(&changes, "body.product.position=[%.17g,0,%.17g]", 0.5 * p->length + p->start, 0.5 * p->height - sunk);
    change_tine(&changes, "left front tine", p->gap + 0.5 * tine, 1.0);
    change_tine(&changes, "right front tine", p->gap + 0.5 * tine, -1.0);
    change(&changes, "contact.0.friction={law=\"stick-slip\",static=%.17g,kinetic=%.17g,threshold=%.17g}",
           p->static_friction, p->kinetic_friction, p->threshold);
    change(&changes, "contact.0.normal={law=\"linear-loading\",stiffness=%.17g,restitution=0.5}", p->surface_stiffness);
    for (int tines = 1; tines <= 1 + caught; tines++)
        change(&changes,
               "contact.%d={between=[\"product\",\"%s "
               "tine\"],shared_by=4,normal={law=\"linear-loading\",stiffness=%.17g,restitution=%.17g}}",
               tines, tines == 1 ? "rear" : "front", p->tine_stiffness, p->tine_restitution);
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
    double rounding = 0.002,
           half[3] = {0.5 * p->length - rounding, 0.5 * p->depth - rounding, 0.5 * p->height - rounding};
    double sum = rounding;
    for (int k = 0; k < 3; k++) sum += fabs(frame.column[k].x) * half[k];
    return sum;
}

/* Gap between the product's front corners and the front tines, m. */
static double clearance(const struct process *p, const scree_scene *scene, struct parts parts) {
    scree_body_state product = scree_scene_body(scene, parts.product);
    double front = scree_scene_body(scene, parts.front).position[0] - 0.015;
    return front - product.position[0] - reach(p, &product);
}

/* Forces of rear and front tines on the product, and of all on it along x. */
static scree_status forces(scree_scene *scene, double *rear, double *front, double *along) {
    scree_contact_state contact[MOST_CONTACTS];
    int count = 0;
    scree_status status = scree_scene_contacts(scene, contact, MOST_CONTACTS, &count);
    *rear = *front = *along = 0.0;
    for (int k = 0; !status && k < count && k < MOST_CONTACTS; k++) {
        double x = contact[k].normal_force * contact[k].normal[0];
        if (strstr(scree_scene_body_name(scene, contact[k].host), "rear")) *rear += x;
        if (strstr(scree_scene_body_name(scene, contact[k].host), "front")) *front -= x;
        *along += x + contact[k].friction[0];
    }
    return status;
}

/* Steps of at most `largest` that make up `duration`. */
static long steps_in(double duration, double largest) { return (long)ceil(duration / largest * (1.0 - 1e-12)); }

int process_catch(void *context, const struct scree_profile *profile, double until, scree_catch *result) {
    const struct process *p = context;
    scree_trouble trouble;
    long steps = steps_in(until, p->step);
    scree_scene *scene = make_scene(p, profile, until / (double)steps, 0, &trouble);
    if (!scene) return 1;
    scree_status status = scree_scene_step(scene, steps);
    double rear, front, along;
    if (!status) status = forces(scene, &rear, &front, &along);
    if (!status) {
        struct parts parts = find_parts(scene);
        result->clearance = clearance(p, scene, parts);
        result->velocity = scree_scene_body(scene, parts.product).velocity[0];
        result->acceleration = along / p->mass;
    }
    scree_scene_destroy(scene);
    return status != SCREE_OK;
}

static struct process_sample sample(const struct process *p, scree_scene *scene, struct parts parts) {
    double along;
    scree_body_state comb = scree_scene_body(scene, parts.rear), product = scree_scene_body(scene, parts.product);
    struct process_sample s = {.time = scree_scene_time(scene),
                               .comb = comb.position[0] + 0.015,
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

scree_status process_simulate(const struct process *p, const struct scree_profile *profile, double target,
                              struct process_run *run) {
    double duration = scree_profile_duration(profile), step = duration / (double)steps_in(duration, p->step);
    run->error = run->approach = run->touched = run->catch_force = run->push_force = 0.0;
    scree_scene *scene = make_scene(p, profile, step, 1, &run->trouble);
    if (!scene) return run->trouble.status;
    struct parts parts = find_parts(scene);
    scree_status status = SCREE_OK;
    double shown = -1.0, deadline = duration + 2.0;
    struct process_sample s = sample(p, scene, parts);
    struct nearing last = {.gap = clearance(p, scene, parts)};
    /* At rest as slow as the regularised friction lets it be: what is left of the way is below 1e-12 m. */
    while (!status && (s.time < duration || (fabs(s.product_velocity) > 1e-9 && s.time < deadline))) {
        if (run->watch && s.time >= shown + run->every * (1.0 - 1e-9)) {
            run->watch(run->context, &s);
            shown = s.time;
        }
        status = scree_scene_step(scene, 1);
        s = sample(p, scene, parts);
        note(run, &s, &last, clearance(p, scene, parts));
    }
    if (status) run->trouble = *scree_scene_trouble(scene);
    run->error = s.product - target;
    scree_scene_destroy(scene);
    return status;
}
