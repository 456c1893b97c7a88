/* Scenes: creating, defining, destroying. Whatever is given in is checked here and copied. */
#include "engine/scene.h"

#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

scree_scene *scree_scene_create(void) {
    scree_scene *scene = calloc(1, sizeof *scene);
    if (!scene) return NULL;
    struct scree_contacts *contacts = &scene->contacts;
    contacts->deepest_ball = contacts->deepest_host = contacts->steepest_ball = contacts->steepest_host = -1;
    return scene;
}

void scree_scene_destroy(scree_scene *scene) {
    if (!scene) return;
    for (int k = 0; k < scene->materials; k++) free((char *)(uintptr_t)scene->material[k].name);
    for (int k = 0; scene->motion && k < scene->motions; k++) scree_motion_free(&scene->motion[k]);
    for (int k = 0; k < scene->motions; k++) free(scene->motion_name[k]);
    free(scene->material);
    free(scene->motion);
    free(scene->motion_name);
    for (int k = 0; k < scene->rules; k++) scree_free_rule(&scene->rule[k]);
    free(scene->rule);
    scree_scene_free_groups(scene);
    scree_names_free(&scene->names);
    free(scene->plan.trial);
    free(scene->checkpoint.state);
    scree_adaptive_destroy(scene);
    scree_bodies_free_shadow(&scene->shadow);
    scree_bodies_destroy(&scene->bodies);
    scree_contacts_destroy(&scene->contacts);
    free(scene);
}

const scree_trouble *scree_scene_trouble(const scree_scene *scene) { return &scene->trouble; }

/* Make room for one more entry of `size` bytes in an array of `count`. */
static scree_status make_room(scree_scene *scene, void **array, int count, int *capacity, size_t size) {
    if (count < *capacity) return SCREE_OK;
    int grown = *capacity ? 2 * *capacity : 8;
    void *memory = realloc(*array, (size_t)grown * size);
    if (!memory) return scree_report(&scene->trouble, SCREE_NO_MEMORY, NULL, "no memory for %d definitions", grown);
    *array = memory;
    *capacity = grown;
    return SCREE_OK;
}

/* A line feed, an escape, …; what would break a line of a table, or do things to a terminal. */
static int has_control(const char *name) {
    for (const unsigned char *c = (const unsigned char *)name; *c; c++)
        if (*c < 0x20 || *c == 0x7f || (*c == 0xc2 && c[1] >= 0x80 && c[1] < 0xa0)) return 1;
    return 0;
}

static scree_status check_new(scree_scene *scene, const char *what, const char *name, int known) {
    if (scene->baked)
        return scree_report(&scene->trouble, SCREE_BAD_INPUT, NULL, "a baked scene takes no new %s", what);
    if (!name || !name[0]) return scree_report(&scene->trouble, SCREE_BAD_INPUT, "name", "a %s needs a name", what);
    if (strlen(name) > SCREE_NAME_LENGTH)
        return scree_report(&scene->trouble, SCREE_BAD_INPUT, "name",
                            "the name of a %s has at most %d bytes, \"%s\" has %zu", what, SCREE_NAME_LENGTH, name,
                            strlen(name));
    if (has_control(name))
        return scree_report(&scene->trouble, SCREE_BAD_INPUT, "name",
                            "the name of a %s is one line without control characters, not \"%s\"", what, name);
    if (known >= 0)
        return scree_report(&scene->trouble, SCREE_BAD_INPUT, "name", "there are two of the %s \"%s\"", what, name);
    return SCREE_OK;
}

static scree_status copy_name(scree_scene *scene, const char *name, char **copy) {
    *copy = strdup(name);
    return *copy ? SCREE_OK : scree_report(&scene->trouble, SCREE_NO_MEMORY, NULL, "no memory for a name");
}

int scree_scene_find_material(const scree_scene *scene, const char *name) {
    for (int k = 0; name && k < scene->materials; k++)
        if (strcmp(scene->material[k].name, name) == 0) return k;
    return -1;
}

int scree_scene_find_motion(const scree_scene *scene, const char *name) {
    for (int k = 0; name && k < scene->motions; k++)
        if (strcmp(scene->motion_name[k], name) == 0) return k;
    return -1;
}

int scree_scene_find_body(const scree_scene *scene, const char *name) { return scree_names_find(&scene->names, name); }

scree_status scree_scene_add_material(scree_scene *scene, const scree_material_def *def, int *index) {
    scree_status status = check_new(scene, "material", def->name, scree_scene_find_material(scene, def->name));
    if (status) return status;
    if (!(def->density >= 0.0) || !isfinite(def->density))
        return scree_report(&scene->trouble, SCREE_BAD_INPUT, "density",
                            "the density of material \"%s\" must be a positive number in kg/m^3, got %g", def->name,
                            def->density);
    if (!(def->young >= 0.0))
        return scree_report(&scene->trouble, SCREE_BAD_INPUT, "young",
                            "Young's modulus of material \"%s\" must be positive (Pa), got %g", def->name, def->young);
    if (!(def->poisson > -1.0 && def->poisson <= 0.5))
        return scree_report(&scene->trouble, SCREE_BAD_INPUT, "poisson",
                            "Poisson's ratio of material \"%s\" must be above -1 and at most 0.5, got %g", def->name,
                            def->poisson);
    char *name = NULL;
    status = make_room(scene, (void **)&scene->material, scene->materials, &scene->material_capacity,
                       sizeof *scene->material);
    if (!status) status = copy_name(scene, def->name, &name);
    if (status) return status;
    scene->material[scene->materials] = *def;
    scene->material[scene->materials].name = name;
    if (index) *index = scene->materials;
    scene->materials++;
    return SCREE_OK;
}

scree_status scree_scene_add_motion(scree_scene *scene, const scree_motion_def *def, int *index) {
    scree_status status = check_new(scene, "motion", def->name, scree_scene_find_motion(scene, def->name));
    if (status) return status;
    int capacity = scene->motion_capacity, of_names = capacity;
    char *name = NULL;
    struct scree_motion motion;
    status = make_room(scene, (void **)&scene->motion, scene->motions, &capacity, sizeof *scene->motion);
    if (!status)
        status = make_room(scene, (void **)&scene->motion_name, scene->motions, &of_names, sizeof *scene->motion_name);
    if (!status) scene->motion_capacity = capacity; /* of both */
    if (!status) status = scree_motion_bake(def, &motion, &scene->trouble);
    if (status) return status;
    status = copy_name(scene, def->name, &name);
    if (status) {
        scree_motion_free(&motion);
        return status;
    }
    scene->motion[scene->motions] = motion;
    scene->motion_name[scene->motions] = name;
    if (index) *index = scene->motions;
    scene->motions++;
    return SCREE_OK;
}

scree_status scree_scene_add_contact(scree_scene *scene, const scree_contact_def *def) {
    int a = def->between[0], b = def->between[1];
    if (scene->baked) return scree_report(&scene->trouble, SCREE_BAD_INPUT, NULL, "a baked scene takes no new contact");
    if (a < 0 || b < 0 || a >= scene->materials || b >= scene->materials)
        return scree_report(&scene->trouble, SCREE_BAD_INPUT, "between",
                            "a contact is between two materials of the scene, got indices %d and %d", a, b);
    const char *first = scene->material[a].name, *second = scene->material[b].name;
    for (int k = 0; k < scene->rules; k++) {
        const int *other = scene->rule[k].material;
        if ((other[0] == a && other[1] == b) || (other[0] == b && other[1] == a))
            return scree_report(&scene->trouble, SCREE_BAD_INPUT, "between",
                                "there are two contacts between \"%s\" and \"%s\"", first, second);
    }
    scree_status status =
        make_room(scene, (void **)&scene->rule, scene->rules, &scene->rule_capacity, sizeof *scene->rule);
    if (status) return status;
    const scree_material_def *one = &scene->material[a], *other = &scene->material[b];
    struct scree_elastic elastic =
        scree_elastic_of((double[]){one->young, other->young}, (double[]){one->poisson, other->poisson});
    scree_trouble cause;
    status = scree_bake_rule(def, &elastic, &scene->rule[scene->rules], &cause);
    if (status)
        return scree_report(&scene->trouble, status, cause.field, "contact between \"%s\" and \"%s\": %s", first,
                            second, cause.text);
    scene->rules++;
    return SCREE_OK;
}

static int all_finite(const double *values, int count) {
    for (int k = 0; k < count; k++)
        if (!isfinite(values[k])) return 0;
    return 1;
}

static int is_zero(const double a[3]) { return a[0] == 0.0 && a[1] == 0.0 && a[2] == 0.0; }

/* A direction can be normalised: its square neither vanishes nor overflows. */
static int is_direction(const double a[3]) {
    double norm2 = vec_norm2(vec_from(a));
    return norm2 > 1e-200 && norm2 < 1e200;
}

static scree_status check_numbers(scree_scene *scene, const scree_body_def *def) {
    const struct {
        const char *field;
        const double *values;
        int count;
    } vectors[] = {{"position", def->position, 3},
                   {"orientation", def->orientation, 4},
                   {"velocity", def->velocity, 3},
                   {"spin", def->spin, 3},
                   {"joint", def->joint.axis, 3}};
    for (size_t k = 0; k < sizeof vectors / sizeof vectors[0]; k++)
        if (!all_finite(vectors[k].values, vectors[k].count))
            return scree_report(&scene->trouble, SCREE_BAD_INPUT, vectors[k].field,
                                "%s of body \"%s\" must consist of finite numbers", vectors[k].field, def->name);
    const double *q = def->orientation;
    double norm2 = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3];
    int left_out = q[0] == 0.0 && q[1] == 0.0 && q[2] == 0.0 && q[3] == 0.0;
    if (!left_out && !(norm2 > 1e-12 && norm2 < 1e12))
        return scree_report(&scene->trouble, SCREE_BAD_INPUT, "orientation",
                            "the orientation of body \"%s\" is no quaternion that can be normalised", def->name);
    if (!(def->mass >= 0.0) || !isfinite(def->mass))
        return scree_report(&scene->trouble, SCREE_BAD_INPUT, "mass", "the mass of body \"%s\" must be > 0 kg, got %g",
                            def->name, def->mass);
    return SCREE_OK;
}

static int known_freedoms(const scree_joint *joint) {
    const scree_freedom *along = joint->along;
    return (unsigned)along[0] <= SCREE_DRIVEN && (unsigned)along[1] <= SCREE_DRIVEN &&
           (unsigned)along[2] <= SCREE_DRIVEN && (unsigned)joint->turn <= SCREE_DRIVEN;
}

static scree_status check_joint(scree_scene *scene, const scree_body_def *def) {
    const scree_joint *joint = &def->joint;
    int wall = def->shape.kind == SCREE_PLANE || def->shape.kind == SCREE_RECTANGLE;
    int bad_motion = joint->turn == SCREE_DRIVEN && (joint->turn_motion < 0 || joint->turn_motion >= scene->motions);
    int moves_held = 0;
    for (int k = 0; k < 3; k++) {
        bad_motion |=
            joint->along[k] == SCREE_DRIVEN && (joint->along_motion[k] < 0 || joint->along_motion[k] >= scene->motions);
        moves_held |= joint->along[k] != SCREE_FREE && def->velocity[k] != 0.0;
    }
    if (!known_freedoms(joint))
        return scree_report(&scene->trouble, SCREE_BAD_INPUT, "joint",
                            "the joint of body \"%s\" must be free, fixed or driven in each direction", def->name);
    if (bad_motion)
        return scree_report(&scene->trouble, SCREE_BAD_INPUT, "joint",
                            "body \"%s\" is driven by a motion that isn't there", def->name);
    if (wall && scree_joint_can_move(joint))
        return scree_report(
            &scene->trouble, SCREE_BAD_INPUT, "joint",
            "body \"%s\" is a %s: it has no mass, so each direction must be fixed or driven (others = \"fixed\")",
            def->name, scree_shape_name(def->shape.kind));
    if (moves_held)
        return scree_report(&scene->trouble, SCREE_BAD_INPUT, "velocity",
                            "body \"%s\" has a velocity along a direction that its joint fixes or drives", def->name);
    if (joint->turn != SCREE_FREE && !is_zero(def->spin))
        return scree_report(&scene->trouble, SCREE_BAD_INPUT, "spin",
                            "body \"%s\" has a spin though its joint fixes or drives its turning", def->name);
    struct vec axis = vec_from(joint->axis), spin = vec_from(def->spin);
    /* 1e-9: an axis and a spin given in decimals are parallel to rounding. */
    if (joint->turn == SCREE_FREE && vec_norm(vec_cross(axis, spin)) > 1e-9 * vec_norm(axis) * vec_norm(spin))
        return scree_report(&scene->trouble, SCREE_BAD_INPUT, "spin",
                            "the spin of body \"%s\" isn't about the axis of its hinge", def->name);
    if (!is_direction(joint->axis) && (joint->turn == SCREE_DRIVEN || !is_zero(joint->axis)))
        return scree_report(&scene->trouble, SCREE_BAD_INPUT, "joint",
                            "the axis of body \"%s\" gives no direction: a driven turn needs one, a hinge too",
                            def->name);
    return SCREE_OK;
}

/* A plane that turned about anything but its normal would sweep through space infinitely fast far out. */
static scree_status check_turning_plane(scree_scene *scene, const scree_body_def *def) {
    if (def->shape.kind != SCREE_PLANE || def->joint.turn != SCREE_DRIVEN) return SCREE_OK;
    struct quat q = {1.0, 0.0, 0.0, 0.0};
    const double *o = def->orientation;
    if (o[0] != 0.0 || o[1] != 0.0 || o[2] != 0.0 || o[3] != 0.0) q = quat_normalise(quat_from(o));
    struct vec axis = vec_from(def->joint.axis);
    if (vec_norm(vec_cross(quat_to_mat(q).column[2], axis)) <= 1e-9 * vec_norm(axis)) return SCREE_OK;
    return scree_report(&scene->trouble, SCREE_BAD_INPUT, "joint",
                        "the plane \"%s\" can turn about its normal only; use a rectangle or a box", def->name);
}

static scree_status check_mass(scree_scene *scene, const scree_body_def *def) {
    const scree_material_def *material = &scene->material[def->material];
    if (!scree_joint_can_move(&def->joint)) return SCREE_OK;
    if (!(def->mass > 0.0) && !(material->density > 0.0))
        return scree_report(&scene->trouble, SCREE_BAD_INPUT, "mass",
                            "body \"%s\" has no mass: give it one (kg), or its material \"%s\" a density (kg/m^3)",
                            def->name, material->name);
    double mass = scree_body_mass(def, material->density), moments[3];
    scree_shape_inertia(&def->shape, moments);
    if (isnormal(mass) && isfinite(1.0 / mass) && isnormal(mass * moments[0]) && isfinite(1.0 / (mass * moments[0])))
        return SCREE_OK;
    return scree_report(&scene->trouble, SCREE_BAD_INPUT, "mass",
                        "body \"%s\" has a mass of %g kg and a size that numbers can't hold together", def->name, mass);
}

/* Everything about a body but its name's being new. */
static scree_status check_body(scree_scene *scene, const scree_body_def *def) {
    if (def->material < 0 || def->material >= scene->materials)
        return scree_report(&scene->trouble, SCREE_BAD_INPUT, "material",
                            "body \"%s\" is of material %d, which isn't there", def->name, def->material);
    scree_trouble cause;
    scree_status status = scree_shape_check(&def->shape, &cause);
    if (status) return scree_report(&scene->trouble, status, cause.field, "body \"%s\": %s", def->name, cause.text);
    status = check_numbers(scene, def);
    if (!status) status = check_joint(scene, def);
    if (!status) status = check_turning_plane(scene, def);
    if (!status) status = check_mass(scene, def);
    return status;
}

static scree_status add_name(scree_scene *scene, const char *name) {
    if (!scree_names_add(&scene->names, name)) return SCREE_OK;
    return scree_report(&scene->trouble, SCREE_NO_MEMORY, NULL, "no memory for the names of %d bodies",
                        scene->names.count);
}

static scree_status room_for_group(scree_scene *scene) {
    return make_room(scene, (void **)&scene->group, scene->groups, &scene->group_capacity, sizeof *scene->group);
}

static void add_group(scree_scene *scene, struct scree_body_group group, int *index) {
    group.first = scene->defs;
    group.like.name = NULL;
    scene->group[scene->groups++] = group;
    if (index) *index = scene->defs;
    scene->defs += group.count;
}

scree_status scree_scene_add_body(scree_scene *scene, const scree_body_def *def, int *index) {
    scree_status status = check_new(scene, "body", def->name, scree_scene_find_body(scene, def->name));
    if (!status) status = check_body(scene, def);
    if (!status) status = room_for_group(scene);
    if (!status) status = add_name(scene, def->name);
    if (!status) add_group(scene, (struct scree_body_group){.count = 1, .like = *def}, index);
    return status;
}

/* How sphere `k` of many is called; the caller's buffer holds the number. */
struct numbered {
    char text[300];
};

static const char *sphere_name(const scree_spheres_def *def, int k, struct numbered *numbered) {
    if (def->names) return def->names[k];
    snprintf(numbered->text, sizeof numbered->text, "%.*s %d", 256, def->name,
             (def->first_number ? def->first_number : 1) + k);
    return numbered->text;
}

static scree_body_def sphere_def(const scree_spheres_def *def, int k, const char *name) {
    scree_body_def body = {.name = name, .material = def->material, .joint = def->joint};
    body.shape = (scree_shape){.kind = SCREE_SPHERE, .radius = def->radii ? def->radii[k] : def->radius};
    memcpy(body.position, def->positions[k], sizeof body.position);
    if (def->masses) body.mass = def->masses[k];
    if (def->velocity) memcpy(body.velocity, def->velocity, sizeof body.velocity);
    if (def->velocities) memcpy(body.velocity, def->velocities[k], sizeof body.velocity);
    if (def->spins) memcpy(body.spin, def->spins[k], sizeof body.spin);
    return body;
}

static scree_status add_sphere(scree_scene *scene, const scree_spheres_def *def, struct scree_body_group *group,
                               int k) {
    struct numbered numbered;
    const char *name = sphere_name(def, k, &numbered);
    scree_status status = check_new(scene, "body", name, scree_scene_find_body(scene, name));
    scree_body_def body = sphere_def(def, k, name);
    if (!status) status = check_body(scene, &body);
    if (!status) status = add_name(scene, name);
    if (status) return status;
    if (k == 0) group->like = body;
    memcpy(group->place[k], body.position, sizeof body.position);
    group->place[k][3] = body.shape.radius;
    group->place[k][4] = body.mass;
    if (!group->motion) return SCREE_OK;
    memcpy(group->motion[k], body.velocity, sizeof body.velocity);
    memcpy(group->motion[k] + 3, body.spin, sizeof body.spin);
    return SCREE_OK;
}

scree_status scree_scene_add_spheres(scree_scene *scene, const scree_spheres_def *def, int *first) {
    if (def->count > INT_MAX - scene->defs)
        return scree_report(&scene->trouble, SCREE_NO_MEMORY, "count", "a scene can't have %d spheres more",
                            def->count);
    if (def->count < 1)
        return scree_report(&scene->trouble, SCREE_BAD_INPUT, "count", "a group of spheres has at least one, got %d",
                            def->count);
    if (!def->positions)
        return scree_report(&scene->trouble, SCREE_BAD_INPUT, "positions", "a group of spheres needs positions");
    if (def->first_number < 0 || def->first_number > INT_MAX - def->count)
        return scree_report(&scene->trouble, SCREE_BAD_INPUT, "first_number", "spheres can't be numbered from %d on",
                            def->first_number);
    scree_status status = check_new(scene, "group of spheres", def->name, -1);
    scene->trouble.body = -1;
    if (!status) status = room_for_group(scene);
    if (status) return status;
    struct scree_body_group group = {.count = def->count};
    int known = scene->names.count, moving = def->velocities || def->spins;
    group.place = malloc((size_t)def->count * sizeof *group.place);
    group.motion = moving ? malloc((size_t)def->count * sizeof *group.motion) : NULL;
    if (!group.place || (moving && !group.motion))
        status = scree_report(&scene->trouble, SCREE_NO_MEMORY, NULL, "no memory for %d spheres", def->count);
    for (int k = 0; k < def->count && !status; k++) {
        status = add_sphere(scene, def, &group, k);
        if (status) scene->trouble.body = k;
    }
    if (!status) {
        add_group(scene, group, first);
        return SCREE_OK;
    }
    scree_names_cut(&scene->names, known);
    free(group.place);
    free(group.motion);
    return status;
}

/* The group that body k belongs to. */
static const struct scree_body_group *group_of(const scree_scene *scene, int k) {
    int low = 0, high = scene->groups;
    while (high - low > 1) {
        int middle = low + (high - low) / 2;
        if (scene->group[middle].first <= k)
            low = middle;
        else
            high = middle;
    }
    return &scene->group[low];
}

scree_body_def scree_scene_definition(const scree_scene *scene, int k) {
    const struct scree_body_group *group = group_of(scene, k);
    scree_body_def def = group->like;
    for (int axis = 0; group->place && axis < 3; axis++) def.position[axis] = group->place[k - group->first][axis];
    if (group->place) def.shape.radius = group->place[k - group->first][3];
    if (group->place) def.mass = group->place[k - group->first][4];
    for (int axis = 0; group->motion && axis < 3; axis++) {
        def.velocity[axis] = group->motion[k - group->first][axis];
        def.spin[axis] = group->motion[k - group->first][3 + axis];
    }
    return def;
}

void scree_scene_free_groups(scree_scene *scene) {
    for (int k = 0; k < scene->groups; k++) {
        free(scene->group[k].place);
        free(scene->group[k].motion);
    }
    free(scene->group);
    scene->group = NULL;
    scene->groups = scene->group_capacity = 0;
}

scree_status scree_scene_set_gravity(scree_scene *scene, const scree_gravity_def *def) {
    if (scene->baked) return scree_report(&scene->trouble, SCREE_BAD_INPUT, NULL, "a baked scene keeps its gravity");
    if (!all_finite(def->vector, 3) || !all_finite(def->axis, 3))
        return scree_report(&scene->trouble, SCREE_BAD_INPUT, "gravity",
                            "gravity must consist of finite numbers (m/s^2)");
    if (def->tilts && (def->tilt < 0 || def->tilt >= scene->motions))
        return scree_report(&scene->trouble, SCREE_BAD_INPUT, "gravity", "gravity tilts by a motion that isn't there");
    if (def->tilts && !is_direction(def->axis))
        return scree_report(&scene->trouble, SCREE_BAD_INPUT, "gravity",
                            "tilting gravity needs an axis other than zero");
    scene->gravity = *def;
    return SCREE_OK;
}

scree_status scree_scene_set_domain(scree_scene *scene, const scree_domain_def *def) {
    static const char *const axes[] = {"x", "y", "z"};
    if (scene->baked) return scree_report(&scene->trouble, SCREE_BAD_INPUT, NULL, "a baked scene keeps its domain");
    for (int axis = 0; axis < 3; axis++) {
        double low = def->min[axis], high = def->max[axis];
        if (!isfinite(low) || !isfinite(high) || !isfinite(high - low) || !(high > low))
            return scree_report(&scene->trouble, SCREE_BAD_INPUT, "max",
                                "the domain must go up from min to max along %s, got %g and %g", axes[axis], low, high);
    }
    scene->domain = *def;
    scene->bounded = 1;
    return SCREE_OK;
}

static scree_status check_accuracy(scree_scene *scene, const scree_time_def *def) {
    if (def->accuracy == 0.0) return SCREE_OK;
    if (!(def->accuracy >= 1e-6 && def->accuracy <= 0.1))
        return scree_report(
            &scene->trouble, SCREE_BAD_INPUT, "accuracy",
            "accuracy must be 1e-6 to 0.1 (the error of a rebound in parts of the impact speed), got %g",
            def->accuracy);
    if (def->step != 0.0)
        return scree_report(&scene->trouble, SCREE_BAD_INPUT, "accuracy",
                            "accuracy finds the step, so that a step can't be given with it; leave one of them out");
    if (def->integrator == SCREE_ADAPTIVE)
        return scree_report(&scene->trouble, SCREE_BAD_INPUT, "accuracy",
                            "accuracy finds a fixed step; the integrator adaptive has a tolerance instead");
    return SCREE_OK;
}

scree_status scree_scene_set_time(scree_scene *scene, const scree_time_def *def) {
    if (scene->baked) return scree_report(&scene->trouble, SCREE_BAD_INPUT, NULL, "a baked scene keeps its step");
    const struct {
        const char *field;
        double value;
    } numbers[] = {{"step", def->step}, {"divide", def->divide}, {"speed", def->speed}, {"sleep", def->sleep}};
    for (size_t k = 0; k < sizeof numbers / sizeof numbers[0]; k++)
        if (!(numbers[k].value >= 0.0) || !isfinite(numbers[k].value))
            return scree_report(&scene->trouble, SCREE_BAD_INPUT, numbers[k].field,
                                "%s must be a positive number, got %g", numbers[k].field, numbers[k].value);
    scree_status status = check_accuracy(scene, def);
    if (status) return status;
    if (def->integrator != SCREE_ANY_INTEGRATOR && def->integrator != SCREE_VERLET &&
        def->integrator != SCREE_PAIR_IMPULSE && def->integrator != SCREE_ADAPTIVE)
        return scree_report(&scene->trouble, SCREE_BAD_INPUT, "integrator", "there is no integrator of number %d",
                            (int)def->integrator);
    if (def->substeps < 0 || def->substeps > SCREE_MOST_SUBSTEPS)
        return scree_report(&scene->trouble, SCREE_BAD_INPUT, "substeps", "substeps must be 1 to %d, got %d",
                            SCREE_MOST_SUBSTEPS, def->substeps);
    if (def->substeps && def->integrator != SCREE_PAIR_IMPULSE)
        return scree_report(&scene->trouble, SCREE_BAD_INPUT, "substeps",
                            "substeps goes with the integrator pair-impulse, which must be asked for");
    if (def->sleep > 0.0 && def->integrator != SCREE_ANY_INTEGRATOR && def->integrator != SCREE_VERLET)
        return scree_report(&scene->trouble, SCREE_BAD_INPUT, "sleep",
                            "sleep goes with the integrator verlet; under another nobody sleeps");
    if (def->watch != SCREE_WATCH_STOP && def->watch != SCREE_WATCH_HALVE)
        return scree_report(&scene->trouble, SCREE_BAD_INPUT, "watch", "there is no watch of number %d",
                            (int)def->watch);
    int adaptive = def->integrator == SCREE_ADAPTIVE;
    if (def->tolerance != 0.0 && !adaptive)
        return scree_report(&scene->trouble, SCREE_BAD_INPUT, "tolerance",
                            "tolerance goes with the integrator adaptive; it would be without effect");
    if (def->tolerance != 0.0 && !(def->tolerance >= 1e-13 && def->tolerance <= 1e-3))
        return scree_report(&scene->trouble, SCREE_BAD_INPUT, "tolerance", "tolerance must be 1e-13 to 1e-3, got %g",
                            def->tolerance);
    if (adaptive && def->watch == SCREE_WATCH_HALVE)
        return scree_report(&scene->trouble, SCREE_BAD_INPUT, "watch",
                            "the watch halves fixed steps; the integrator adaptive chooses its own by its tolerance");
    if (def->no_flight && !adaptive)
        return scree_report(&scene->trouble, SCREE_BAD_INPUT, "flight", "flight goes with the integrator adaptive");
    if (def->threads < 0 || def->threads > SCREE_MOST_THREADS)
        return scree_report(&scene->trouble, SCREE_BAD_INPUT, "threads", "threads must be 1 to %d, got %d",
                            SCREE_MOST_THREADS, def->threads);
    scene->time = *def;
    scene->time.energy |= def->watch == SCREE_WATCH_HALVE; /* so that writing them down changes nothing */
    if (adaptive && def->tolerance == 0.0) scene->time.tolerance = 1e-10;
    return SCREE_OK;
}

void scree_gravity_at(const struct scree_scene *scene, double time, double gravity[3]) {
    struct vec g = vec_from(scene->gravity.vector);
    if (scene->gravity.tilts) {
        /* Rodrigues' formula. */
        double angle = scree_motion_at(&scene->bodies.motion[scene->gravity.tilt], time).position, s, c;
        struct vec a = vec_from(scene->gravity.axis);
        a = vec_scale(1.0 / vec_norm(a), a);
        scree_sincos(angle, &s, &c);
        struct vec along = vec_scale((1.0 - c) * vec_dot(a, g), a);
        g = vec_add(vec_axpy(vec_scale(c, g), s, vec_cross(a, g)), along);
    }
    vec_store(g, gravity);
}
