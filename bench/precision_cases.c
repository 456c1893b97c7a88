/* The table of cases: one entry each. */
#include "bench/precision.h"

#include <math.h>
#include <stdlib.h>

#define TIME "[time]\nend = 1e4\nforce = true\n"
#define WALL                                                                                                           \
    "[[material]]\nname = \"ball\"\n[[material]]\nname = \"wall\"\n"                                                   \
    "[[body]]\nname = \"wall\"\nshape = { plane = true }\nmaterial = \"wall\"\njoint = \"fixed\"\n"
#define BALL    TIME WALL "[[body]]\nname = \"first\"\nshape = { sphere = 0.01 }\nmaterial = \"ball\"\nmass = 0.03\n"
#define DOWN    "velocity = [0, 0, -1]\n"
#define ALONG   "velocity = [0.573576436351046, 0, -0.819152044288992]\n"
#define CONTACT "[[contact]]\nbetween = [\"ball\", \"wall\"]\n"
#define BOX                                                                                                            \
    WALL "[[body]]\nname = \"first\"\nshape = { box = [0.03, 0.05, 0.012], rounding = 0.001 }\n"                       \
         "material = \"ball\"\nmass = 0.03\n"
#define SLIDER                                                                                                         \
    CONTACT "normal = { law = \"linear-cut\", stiffness = 1e4, restitution = 0.5 }\nshared_by = 4\n"                   \
            "friction = { law = \"coulomb\", static = 0.4, kinetic = 0.3, stiffness = 8e3, damping = 2.0 }\n"

/* ---- looking ---- */

static scree_body_state named(const scree_scene *scene, const char *name) {
    return scree_scene_body(scene, scree_scene_find_body(scene, name));
}

/* Velocities of a ball of 10 mm that came with 1 m/s: up, along, of rolling. */
static void look_rebound(const struct precision_case *self, const scree_scene *scene, double *numbers) {
    scree_body_state first = named(scene, "first");
    (void)self;
    numbers[0] = first.velocity[2];
    numbers[1] = first.velocity[0];
    numbers[2] = 0.01 * first.spin[1];
}

static void look_row(const struct precision_case *self, const scree_scene *scene, double *numbers) {
    for (int k = 0; k < self->numbers; k++) numbers[k] = scree_scene_body(scene, k).velocity[0];
}

/* In parts of (0.1 m/s)^2/(2 x 0.3 x 9.81 m/s^2). */
static void look_slide(const struct precision_case *self, const scree_scene *scene, double *numbers) {
    (void)self;
    numbers[0] = named(scene, "first").position[0] / 1.7e-3;
}

/* Of a box that slides down a slope of 20 degrees: way and velocity in parts of what they would be rigidly after 0.2
 * s. */
static void look_incline(const struct precision_case *self, const scree_scene *scene, double *numbers) {
    scree_body_state first = named(scene, "first");
    double pull = 3.3552176060248105 - 0.3 * 9.218384609909762;
    numbers[0] = first.position[0] / (0.5 * pull * self->time * self->time);
    numbers[1] = first.velocity[0] / (pull * self->time);
}

/* Energy of the elastic ball; NAN while it is pressed. */
static void look_energy(const struct precision_case *self, const scree_scene *scene, double *numbers) {
    scree_body_state first = named(scene, "first");
    double energy = 0.5 * first.velocity[2] * first.velocity[2] + 9.81 * (first.position[2] - 0.01);
    (void)self;
    numbers[0] = first.position[2] < 0.01 ? NAN : energy / (0.5 + 9.81 * 0.01);
}

/* Height and velocity of the damped ball, in parts of those of its first fall. */
static void look_bounce(const struct precision_case *self, const scree_scene *scene, double *numbers) {
    scree_body_state first = named(scene, "first");
    (void)self;
    numbers[0] = (first.position[2] - 0.01) / (0.25 / 19.62);
    numbers[1] = first.velocity[2] / 0.5;
}

static void solve_bounce(const struct precision_case *self, double *numbers) {
    double log_e = log(0.97), zeta = -log_e / hypot(3.14159265358979323846, log_e);
    precision_bounce(0.03, 9.81, 1e6, zeta, 0.5, self->time, numbers);
    numbers[0] /= 0.25 / 19.62;
    numbers[1] /= 0.5;
}

/* Places of two spheres squeezed by 50 micrometres, and their velocities, in parts of that and of 0.5 m/s. */
static void look_squeezed(const struct precision_case *self, const scree_scene *scene, double *numbers) {
    (void)self;
    for (int k = 0; k < 2; k++) {
        scree_body_state body = scree_scene_body(scene, k);
        numbers[k] = body.position[2] / 5e-5;
        numbers[k + 2] = body.velocity[2] / 0.5;
    }
}

/* Attitude of the top. */
static void look_attitude(const struct precision_case *self, const scree_scene *scene, double *numbers) {
    scree_body_state body = named(scene, "first");
    double sign = body.orientation[0] < 0.0 ? 1.0 : -1.0;
    (void)self;
    for (int k = 0; k < 4; k++) numbers[k] = sign * body.orientation[k];
}

/* Its energy and angular momentum, in parts of what they are. */
static void look_kept(const struct precision_case *self, const scree_scene *scene, double *numbers) {
    static const double moment[3] = {0.065, 0.05, 0.025};
    scree_body_state body = named(scene, "first");
    struct mat axes = quat_to_mat(quat_from(body.orientation));
    struct vec spin = mat_undo(&axes, vec_from(body.spin));
    double w[3] = {spin.x, spin.y, spin.z}, energy = 0.0, momentum = 0.0;
    (void)self;
    for (int k = 0; k < 3; k++) {
        energy += 0.5 * moment[k] * w[k] * w[k];
        momentum += moment[k] * w[k] * moment[k] * w[k];
    }
    numbers[0] = energy / 0.245;
    numbers[1] = sqrt(momentum) / 0.140890028036054;
}

/* The product in parts of the stroke of 80 mm, and its velocity of 0.5 m/s. */
static void look_product(const struct precision_case *self, const scree_scene *scene, double *numbers) {
    scree_body_state product = named(scene, "product");
    (void)self;
    numbers[0] = product.position[0] / 0.08;
    numbers[1] = product.position[2] / 0.08;
    numbers[2] = product.velocity[0] / 0.5;
    numbers[3] = product.velocity[2] / 0.5;
}

/* ---- a sphere rolls and slides ---- */

static char *make_roll(const struct precision_case *self) {
    const struct precision_ball *b = self->of;
    char *text = malloc(2048);
    if (!text) return NULL;
    snprintf(text, 2048,
             "gravity = [%.17g, 0, %.17g]\n" TIME WALL "[[body]]\nname = \"first\"\nshape = { sphere = %.17g }\n"
             "material = \"ball\"\nmass = %.17g\nvelocity = [%.17g, 0, 0]\nposition = [0, 0, %.17g]\n" CONTACT
             "normal = { law = \"linear-cut\", stiffness = %.17g, restitution = 0.5 }\n"
             "friction = { law = \"coulomb\", static = %.17g, kinetic = %.17g, stiffness = %.17g }\n",
             b->gravity * sin(b->alpha), -b->gravity * cos(b->alpha), b->radius, b->mass, b->speed,
             b->radius - b->mass * b->gravity * cos(b->alpha) / b->k, b->k, b->mu, b->mu, b->k_t);
    return text;
}

/* In parts of what the start and the slope alone would make. */
static void scale_roll(const struct precision_ball *b, double *numbers) {
    double down = b->gravity * sin(b->alpha);
    numbers[0] /= (b->speed + 0.5 * down * b->time) * b->time;
    numbers[1] /= b->speed + down * b->time;
    numbers[2] /= b->speed + down * b->time;
}

static void look_roll(const struct precision_case *self, const scree_scene *scene, double *numbers) {
    const struct precision_ball *b = self->of;
    scree_body_state first = named(scene, "first");
    numbers[0] = first.position[0];
    numbers[1] = first.velocity[0];
    numbers[2] = b->radius * first.spin[1];
    scale_roll(b, numbers);
}

static void solve_roll(const struct precision_case *self, double *numbers) {
    precision_roll(self->of, numbers);
    scale_roll(self->of, numbers);
}

/* The ball of MFiX's DEM04 (0.5 mm, 10000 kg/m^3, 0.1 m/s), with a spring for friction. */
static const struct precision_ball slipping = {5e-4, 5.235987755982989e-6, 9.80665, 0.0, 1e4, 2.5e3, 0.3, 0.1, 0.012};
static const struct precision_ball slope_rolls = {0.01, 0.03, 9.81, 0.17453292519943295, 1e4, 8e3, 0.3, 0.0, 0.2};
static const struct precision_ball slope_slips = {0.01, 0.03, 9.81, 0.52359877559829887, 1e4, 8e3, 0.1, 0.0, 0.2};

/* ---- a thousand spheres ---- */

enum { SIDE = 10, SPHERES = SIDE * SIDE * SIDE };

/* A lattice with jitter falls into a box: the floor's blow has gone through most of the layers at the end. */
static char *make_heap(const struct precision_case *self) {
    static const char *const walls[] = {"[0, 0, 0]",     "[1, 0, 0, 0]",
                                        "[0, 0, 0]",     "{ axis = [0, 1, 0], degrees = 90 }",
                                        "[0, 0, 0]",     "{ axis = [1, 0, 0], degrees = -90 }",
                                        "[0.103, 0, 0]", "{ axis = [0, 1, 0], degrees = -90 }",
                                        "[0, 0.103, 0]", "{ axis = [1, 0, 0], degrees = 90 }"};
    size_t size = 256 * SPHERES + 4096, used;
    char *text = malloc(size);
    uint64_t seed = 5;
    (void)self;
    if (!text) return NULL;
    used = (size_t)snprintf(text, size, "%s",
                            "gravity = [0, 0, -9.81]\n" TIME "[[material]]\nname = \"m\"\ndensity = 2500\n"
                            "[[contact]]\nbetween = [\"m\", \"m\"]\n"
                            "normal = { law = \"linear-cut\", stiffness = 5e3, restitution = 0.5 }\n"
                            "friction = { law = \"coulomb\", static = 0.4, kinetic = 0.4, stiffness = 4e3 }\n");
    for (int k = 0; k < SPHERES; k++) {
        double place[3] = {k % SIDE, k / SIDE % SIDE, k / (SIDE * SIDE)};
        for (int i = 0; i < 3; i++) {
            seed = seed * 6364136223846793005u + 1442695040888963407u;
            place[i] = 0.00515 + 0.0103 * place[i] + 3e-4 * ((double)(seed >> 11) * 0x1p-53 - 0.5);
        }
        used += (size_t)snprintf(text + used, size - used,
                                 "[[body]]\nname = \"%d\"\nshape = { sphere = 0.005 }\nmaterial = \"m\"\n"
                                 "position = [%.17g, %.17g, %.17g]\nvelocity = [0, 0, -0.3]\n",
                                 k, place[0], place[1], place[2]);
    }
    for (int k = 0; k < 5; k++)
        used += (size_t)snprintf(text + used, size - used,
                                 "[[body]]\nname = \"wall %d\"\nshape = { plane = true }\nmaterial = \"m\"\n"
                                 "joint = \"fixed\"\nposition = %s\norientation = %s\n",
                                 k, walls[2 * k], walls[2 * k + 1]);
    return text;
}

/* Positions in parts of a radius. */
static void look_heap(const struct precision_case *self, const scree_scene *scene, double *numbers) {
    (void)self;
    for (int k = 0; k < SPHERES; k++) {
        scree_body_state body = scree_scene_body(scene, k);
        for (int i = 0; i < 3; i++) numbers[3 * k + i] = body.position[i] / 0.005;
    }
}

/* ---- the table ---- */

static const double half[] = {0.5}, whole[] = {1.0};
/* data/reference: newtons_cradle.csv, restitution_thornton_elastoplastic.csv, dem03 and torque_free_top.csv (last
 * rows). */
static const double cradle[] = {-0.130261695065, 0.150229569434, 0.980032125631};
static const double thornton[] = {0.77333689897015};
static const double squeezed[] = {4.30837671247574e-4 / 5e-5, 0.00137229600808934 / 5e-5, 0.0193113650496113 / 0.5,
                                  0.170610611950389 / 0.5};
static const double attitude[] = {-0.0750559492305227, -0.0987465899270472, 0.0672012690134506, -0.989999850962548};
static const double kept[] = {1.0, 1.0};

#define IMPACT                                                                                                         \
    .time = 3e-3, .arrives = "body.1", .touch = {0.0, 0.0, 0.01}, .velocity = {0.0, 0.0, -1.0}, .numbers = 1,          \
    .look = look_rebound
#define OBLIQUE                                                                                                        \
    .time = 3e-3, .arrives = "body.1", .touch = {0.0, 0.0, 0.01},                                                      \
    .velocity = {0.573576436351046, 0.0, -0.819152044288992}, .numbers = 3, .look = look_rebound
#define ROW_HEAD TIME "[[material]]\nname = \"m\"\n[[contact]]\nbetween = [\"m\", \"m\"]\n"
#define ROW_BODIES                                                                                                     \
    "[[body]]\nname = \"1\"\nshape = { sphere = 0.5 }\nmaterial = \"m\"\nmass = 1.0\nvelocity = [1, 0, 0]\n"           \
    "[[body]]\nname = \"2\"\nshape = { sphere = 0.5 }\nmaterial = \"m\"\nmass = 1.0\nposition = [1, 0, 0]\n"           \
    "[[body]]\nname = \"3\"\nshape = { sphere = 0.5 }\nmaterial = \"m\"\nmass = 1.0\nposition = [2, 0, 0]\n"
#define ROW                                                                                                            \
    .duration = 2.2214e-3, .time = 12e-3, .arrives = "body.0", .velocity = {1.0, 0.0, 0.0}, .numbers = 3,              \
    .look = look_row

/* A box of 10 x 20 x 30 cm, that turns once in about 1.6 s; "contact": 2 rad of it. */
#define TOP                                                                                                            \
    TIME "[[material]]\nname = \"m\"\ndensity = 1000\n[[body]]\nname = \"first\"\n"                                    \
         "shape = { box = [0.1, 0.2, 0.3] }\nmaterial = \"m\"\nspin = [1, 2, 3]\n"

const struct precision_case precision_cases[] = {
    {.name = "damped impact",
     .many = 1,
     .scene = BALL DOWN CONTACT "normal = { law = \"linear-cut\", stiffness = 1e5, restitution = 0.5 }\n",
     .duration = 1.77e-3,
     IMPACT,
     .right = half},
    {.name = "damped impact with tension",
     .many = 1,
     .scene = BALL DOWN CONTACT "normal = { law = \"linear\", stiffness = 1e5, restitution = 0.5 }\n",
     .duration = 1.762106e-3,
     IMPACT,
     .right = half},
    {.name = "hertz impact",
     .many = 1,
     .scene = BALL DOWN CONTACT "normal = { law = \"hertz\", stiffness = 5e6 }\n",
     .duration = 1.66e-3,
     IMPACT,
     .right = whole},
    {.name = "tsuji impact",
     .many = 1,
     .scene = BALL DOWN CONTACT "normal = { law = \"tsuji-cut\", stiffness = 5e6, restitution = 0.5 }\n",
     .duration = 1.809764e-3,
     IMPACT,
     .right = half},
    {.name = "hunt-crossley impact",
     .scene =
         BALL DOWN CONTACT "normal = { law = \"hunt-crossley\", stiffness = 5e6, restitution = 0.5, speed = 1.0 }\n",
     .duration = 2.1e-3,
     IMPACT,
     .right = half},
    {.name = "walton-braun impact",
     .scene = BALL DOWN CONTACT "normal = { law = \"walton-braun\", stiffness = 1e5, restitution = 0.5 }\n",
     .duration = 1.2905e-3,
     IMPACT,
     .right = half},
    {.name = "thornton impact",
     .scene = BALL DOWN CONTACT "normal = { law = \"thornton\", modulus = 1e8, yield = 6517944.039433037 }\n",
     .duration = 1.0e-3,
     IMPACT,
     .right = thornton},
    {.name = "oblique impact",
     .many = 1,
     .scene = BALL ALONG CONTACT "normal = { law = \"linear-cut\", stiffness = 1e5, restitution = 0.5 }\n"
                                 "friction = { law = \"coulomb\", static = 0.3, kinetic = 0.3, stiffness = 8e4 }\n",
     .duration = 1.762106e-3,
     OBLIQUE},
    {.name = "oblique impact with tension",
     .many = 1,
     .scene = BALL ALONG CONTACT "normal = { law = \"linear\", stiffness = 1e5, restitution = 0.5 }\n"
                                 "friction = { law = \"coulomb\", static = 0.3, kinetic = 0.3, stiffness = 8e4 }\n",
     .duration = 1.762106e-3,
     OBLIQUE},
    {.name = "oblique impact (mindlin)",
     .many = 1,
     .scene = BALL ALONG CONTACT "normal = { law = \"tsuji-cut\", stiffness = 5e6, restitution = 0.5 }\n"
                                 "friction = { law = \"mindlin\", static = 0.3, kinetic = 0.3, shear_modulus = 8e6 }\n",
     .duration = 1.8e-3,
     OBLIQUE},
    {.name = "slide to rest",
     .scene = "gravity = [0, 0, -9.81]\n" TIME BOX "velocity = [0.1, 0, 0]\nposition = [0, 0, 0.006]\n" SLIDER,
     .phases = 8,
     .duration = 5.4e-3,
     .time = 0.4,
     .numbers = 1,
     .look = look_slide},
    {.name = "box down an incline",
     .scene = "gravity = [3.3552176060248105, 0, -9.218384609909762]\n" TIME BOX
              "position = [0, 0, 0.005972344846]\n" SLIDER,
     .phases = 8,
     .duration = 5.4e-3,
     .time = 0.2,
     .timed = 1,
     .numbers = 2,
     .look = look_incline},
    {.name = "sphere rolls down an incline",
     .make = make_roll,
     .phases = 8,
     .duration = 5.4e-3,
     .time = 0.2,
     .timed = 1,
     .numbers = 3,
     .look = look_roll,
     .solve = solve_roll,
     .of = &slope_rolls},
    {.name = "sphere slips down an incline",
     .make = make_roll,
     .phases = 8,
     .duration = 5.4e-3,
     .time = 0.2,
     .timed = 1,
     .numbers = 3,
     .look = look_roll,
     .solve = solve_roll,
     .of = &slope_slips},
    {.name = "slip turns to rolling",
     .make = make_roll,
     .phases = 8,
     .duration = 7.2e-5,
     .time = 0.012,
     .timed = 1,
     .numbers = 3,
     .look = look_roll,
     .solve = solve_roll,
     .of = &slipping},
    {.name = "cradle",
     .scene = ROW_HEAD "normal = { law = \"linear\", stiffness = 1e6, damping = 0.0 }\n" ROW_BODIES,
     ROW,
     .right = cradle},
    {.name = "damped row of three",
     .scene = ROW_HEAD "normal = { law = \"linear-cut\", stiffness = 1e6, restitution = 0.5 }\n" ROW_BODIES,
     ROW},
    {.name = "squeezed spheres",
     .scene = "gravity = [0, 0, -9.80665]\n" TIME "[[material]]\nname = \"m\"\n[[contact]]\nbetween = [\"m\", \"m\"]\n"
              "normal = { law = \"linear\", stiffness = 1000.0, restitution = 0.9 }\n"
              "[[body]]\nname = \"1\"\nshape = { sphere = 5e-4 }\nmaterial = \"m\"\nmass = 1.0471975511965978e-5\n"
              "position = [0, 0, 4.5e-4]\n"
              "[[body]]\nname = \"2\"\nshape = { sphere = 5e-4 }\nmaterial = \"m\"\nmass = 5.235987755982989e-6\n"
              "position = [0, 0, 1.35e-3]\n"
              "[[body]]\nname = \"floor\"\nshape = { plane = true }\nmaterial = \"m\"\njoint = \"fixed\"\n"
              "[[body]]\nname = \"lid\"\nshape = { plane = true }\nmaterial = \"m\"\njoint = \"fixed\"\n"
              "position = [0, 0, 1.8e-3]\norientation = [0, 1, 0, 0]\n",
     .duration = 2.3e-4,
     .time = 1e-3,
     .timed = 1,
     .numbers = 4,
     .look = look_squeezed,
     .right = squeezed},
    {.name = "energy of 20 elastic bounces",
     .scene = "gravity = [0, 0, -9.81]\n" BALL DOWN "position = [0, 0, 0.02]\n" CONTACT
              "normal = { law = \"hertz\", stiffness = 5e6 }\n",
     .duration = 1.66e-3,
     .time = 4.1,
     .numbers = 1,
     .look = look_energy,
     .right = whole},
    {.name = "100 damped bounces",
     .scene = "gravity = [0, 0, -9.81]\n" BALL "velocity = [0, 0, -0.5]\nposition = [0, 0, 0.01]\n" CONTACT
              "normal = { law = \"linear\", stiffness = 1e6, restitution = 0.97 }\n",
     .duration = 5.44e-4,
     .time = 3.3,
     .timed = 1,
     .phases = 4,
     .numbers = 2,
     .look = look_bounce,
     .solve = solve_bounce},
    {.name = "attitude of a free top after 12 turns",
     .scene = TOP,
     .duration = 0.5,
     .time = 20.0,
     .timed = 1,
     .numbers = 4,
     .look = look_attitude,
     .right = attitude},
    {.name = "energy and momentum of a free top",
     .scene = TOP,
     .duration = 0.5,
     .time = 1000.0,
     .timed = 1,
     .phases = 4,
     .numbers = 2,
     .look = look_kept,
     .right = kept},
    {.name = "transport sliding",
     .file = "transport.toml",
     .duration = 8.6e-4,
     .time = 0.25,
     .timed = 1,
     .phases = 2,
     .numbers = 4,
     .look = look_product},
    {.name = "transport cycle",
     .file = "transport.toml",
     .duration = 8.6e-4,
     .time = 0.6,
     .timed = 1,
     .phases = 2,
     .numbers = 4,
     .look = look_product},
    {.name = "1000 spheres settle",
     .make = make_heap,
     .duration = 1.13e-3,
     .time = 0.01,
     .timed = 1,
     .phases = 2,
     .fine = 4000,
     .numbers = 3 * SPHERES,
     .look = look_heap},
};
const int precision_case_count = sizeof precision_cases / sizeof precision_cases[0];
