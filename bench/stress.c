/* scree-bench stress: scenes far from the ordinary, what becomes of them, and what the engine says. */
#include "bench/bench.h"

#include "engine/scene_file.h"

#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

static const char help[] =
    "usage: scree-bench stress [--integrator NAME] [--steps N] [--rest | --alone]\n"
    "\n"
    "Mass and stiffness ratios, stacks, speeds, overlaps, long rests, thin, tiny and huge bodies, fast spins, strong "
    "gravity.\n"
    "Each row: case, parameters, what happened (right, wrong, warned, refused, stopped), the measured error, what it "
    "is of,\n"
    "its bound, and what the engine said. Warned and wrong are beyond the bound, with a warning of scree run and "
    "without a word.\n"
    "Cases that stopped, or were warned of, follow a second time with watch = \"halve\", as \"halved: ...\".\n"
    "\n"
    "  --integrator NAME  verlet (if not given) or pair-impulse\n"
    "  --steps N          steps of the long rests; 10000000 if not given, after which their bounds hold: not all rest "
    "soon\n"
    "  --rest             only long rests of what lies still, under either integrator\n"
    "  --alone            only that of one ball on a floor\n"
    "\n"
    "example: scree-bench stress --alone --steps 1000000000\n";

static const double pi = 3.14159265358979323846;

/* ---- one row ---- */

struct row {
    const char *name, *of; /* case; what the error is of */
    char parameters[160], said[800];
    const char *end; /* NULL: went through; refused or stopped */
    double error, bound;
    int halvings;
};

/* Cases run twice: the second time with the step halved where it goes wrong, those that the first time didn't go
 * right. */
enum { MOST_ROWS = 512 };
static struct {
    const char *integrator; /* NULL: as the scene has it */
    int halving, row;
    unsigned char again[MOST_ROWS];
} run;

__attribute__((format(printf, 5, 6))) static struct row begin(const char *name, const char *of, double error,
                                                              double bound, const char *format, ...) {
    struct row row = {.name = name, .of = of, .error = error, .bound = bound};
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(row.parameters, sizeof row.parameters, format, arguments);
    va_end(arguments);
    return row;
}

static void quote(const char *text) {
    putchar('"');
    for (; *text; text++) putchar(*text == '"' ? '\'' : *text);
    putchar('"');
}

static void finish(struct row *row) {
    int right = row->error <= row->bound, warned = strncmp(row->said, "scree run warns", 15) == 0;
    const char *what = row->end ? row->end : right ? "right" : warned ? "warned" : "wrong";
    int place = run.row++ % MOST_ROWS;
    if (!run.halving) run.again[place] = strcmp(what, "right") != 0 && strcmp(what, "refused") != 0;
    if (run.halving && !run.again[place]) return;
    if (row->halvings && !row->end) { /* who stops says so himself */
        size_t length = strlen(row->said);
        snprintf(row->said + length, sizeof row->said - length, "%sthe step was halved %d time%s", length ? "; " : "",
                 row->halvings, row->halvings > 1 ? "s" : "");
    }
    printf("%s%s,", run.halving ? "halved: " : "", row->name);
    quote(row->parameters);
    printf(",%s,", what);
    if (!row->end) printf("%.3g", row->error);
    printf(",%s,%.0e,", row->of, row->bound);
    quote(row->said);
    putchar('\n');
    fflush(stdout);
}

/* ---- scenes ---- */

struct text {
    char at[65536];
    size_t size;
};

__attribute__((format(printf, 2, 3))) static void add(struct text *text, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    int written = vsnprintf(text->at + text->size, sizeof text->at - text->size, format, arguments);
    va_end(arguments);
    text->size += (size_t)written;
    if (text->size < sizeof text->at) return;
    cli_complain("a scene of the benchmark is too long");
    exit(EXIT_MISSED);
}

/* Everything is of material "m" and meets by the laws given; the floor is of material "floor". */
static void head_on_slope(struct text *text, double along, double gravity, const char *time, const char *laws) {
    text->size = 0;
    add(text,
        "gravity = [%.17g, 0, %.17g]\n[time]\nend = 1.0\n%s%s\n[output]\nwrite = [\"energy.csv\"]\n"
        "[[material]]\nname = \"m\"\ndensity = 2000\n[[material]]\nname = \"floor\"\n"
        "[[contact]]\nbetween = [\"m\", \"m\"]\n%s\n",
        along, -gravity, time, strstr(time, "integrator") ? "" : "\nintegrator = \"verlet\"", laws);
}

static void head(struct text *text, double gravity, const char *time, const char *laws) {
    head_on_slope(text, 0.0, gravity, time, laws);
}

static void add_floor(struct text *text, const char *laws) {
    add(text, "[[contact]]\nbetween = [\"m\", \"floor\"]\n%s\n", laws);
    add(text, "[[body]]\nname = \"floor\"\nshape = { plane = true }\nmaterial = \"floor\"\njoint = \"fixed\"\n");
}

static void add_ball(struct text *text, const char *name, double radius, double mass, double z, double speed) {
    add(text, "[[body]]\nname = \"%s\"\nshape = { sphere = %.17g }\nmaterial = \"m\"\n", name, radius);
    if (mass > 0.0) add(text, "mass = %.17g\n", mass);
    add(text, "position = [0, 0, %.17g]\nvelocity = [0, 0, %.17g]\n", z, speed);
}

static void add_box(struct text *text, const char *name, double x, double y, double z, double height,
                    const char *more) {
    add(text,
        "[[body]]\nname = \"%s\"\nshape = { box = [%.17g, %.17g, %.17g] }\nmaterial = \"m\"\n"
        "position = [0, 0, %.17g]\n%s\n",
        name, x, y, z, height, more);
}

/* NULL: refused, which the row notes. */
static scree_scene *make(struct row *row, const struct text *text) {
    scree_scene *scene = NULL;
    struct scree_run_request request;
    scree_trouble trouble;
    const char *changes[2];
    int count = 0;
    if (run.integrator) changes[count++] = run.integrator;
    if (run.halving) changes[count++] = "time.watch=\"halve\"";
    row->end = "refused";
    if (run.halving && !run.again[run.row % MOST_ROWS]) return NULL; /* not wanted */
    row->end = NULL;
    scree_status status =
        scree_read_scene(text->at, text->size, "stress", changes, count, 1, &scene, &request, &trouble);
    scree_free_request(&request);
    if (!status) return scene;
    scree_scene_destroy(scene);
    row->end = "refused";
    snprintf(row->said, sizeof row->said, "%s", trouble.text);
    return NULL;
}

/* 1: went through; 0: stopped, which the row notes. So many steps of the length at the start: more once it has been
 * halved. */
static int step(struct row *row, scree_scene *scene, long steps) {
    scree_status status = scree_scene_step(scene, steps << scree_scene_halvings(scene));
    int halvings = scree_scene_halvings(scene);
    if (halvings > row->halvings) row->halvings = halvings;
    if (status == SCREE_OK) return 1;
    row->end = "stopped";
    snprintf(row->said, sizeof row->said, "%s", scree_scene_trouble(scene)->text);
    return 0;
}

static scree_body_state body(const scree_scene *scene, const char *name) {
    return scree_scene_body(scene, scree_scene_find_body(scene, name));
}

static scree_energy energy(scree_scene *scene) {
    scree_energy now;
    scree_scene_energy(scene, &now);
    return now;
}

static double moving(scree_scene *scene) {
    scree_energy now = energy(scene);
    return now.kinetic + now.rotational;
}

/* What `scree run` says at the end: of a step above a tenth of a contact, of bodies too fast to graze, and of books
 * that lack a tenth of the energy turned over (engine/cli/run.c). `largest` is the most that the motion had, J. */
static void note_warnings(struct row *row, scree_scene *scene, double largest) {
    const struct scree_step_choice *choice = &scene->plan.choice;
    scree_energy now = energy(scene);
    double share = fabs(now.balance) / (largest + now.lost_normal + now.lost_tangential);
    if (scree_scene_halvings(scene)) share = scree_most(share, scree_books_lack(scene));
    if (share > 0.1)
        snprintf(row->said, sizeof row->said, "scree run warns: the energy books lack %.0f %%", 100.0 * share);
    else if (choice->step > choice->duration / 10.0 && !row->said[0])
        snprintf(row->said, sizeof row->said, "scree run warns: the step is %.2g of the shortest contact",
                 choice->step / choice->duration);
    else if (scene->hasty > 0.25)
        snprintf(row->said, sizeof row->said, "scree run warns: a body moved by %.2g of the list's margin in one step",
                 scene->hasty);
}

static const char spring[] = "normal = { law = \"linear\", stiffness = 1e5, damping = 0.0 }";
static const char damped[] = "normal = { law = \"linear-cut\", stiffness = 1e5, restitution = 0.2 }";

/* ---- ratios ---- */

/* Elastic central impact: a ball of mass m1 hits one of m2 at 1 m/s. */
static void hit(double m1, double m2) {
    struct row row = begin("impact of unequal masses", "velocities after (of 1 m/s or the faster)", NAN, 1e-2,
                           "%g kg at 1 m/s on %g kg, step auto", m1, m2);
    static struct text text;
    head(&text, 0.0, "step = \"auto\"", spring);
    add_ball(&text, "a", 0.01, m1, 0.0, 1.0);
    add_ball(&text, "b", 0.01, m2, 0.0201, 0.0);
    scree_scene *scene = make(&row, &text);
    if (scene) {
        /* The approach of 0.1 mm, twice the contact time. */
        double mass = m1 * m2 / (m1 + m2), time = 1e-4 + 2.0 * pi * sqrt(mass / 1e5);
        step(&row, scene, (long)(time / scree_scene_step_length(scene)) + 2);
        double after_a = (m1 - m2) / (m1 + m2), after_b = 2.0 * m1 / (m1 + m2);
        row.error =
            scree_most(fabs(body(scene, "a").velocity[2] - after_a), fabs(body(scene, "b").velocity[2] - after_b));
        row.error /= fmax(1.0, after_b);
    }
    finish(&row);
    scree_scene_destroy(scene);
}

/* Two balls on a floor, each on the stiffness that lets it sink by 0.1 mm at rest: they stay. */
static void pile(double below, double above) {
    struct row row = begin("pile of unequal masses", "rest height (of the overlap)", NAN, 1e-6,
                           "%g kg on %g kg; 1e6 steps, step auto", above, below);
    static struct text text;
    char laws[160], ground[160];
    double g = 9.81, sunk = 1e-4;
    snprintf(laws, sizeof laws, "normal = { law = \"linear\", stiffness = %.17g, restitution = 0.5 }",
             above * g / sunk);
    snprintf(ground, sizeof ground, "normal = { law = \"linear\", stiffness = %.17g, restitution = 0.5 }",
             (above + below) * g / sunk);
    head(&text, g, "step = \"auto\"", laws);
    add_floor(&text, ground);
    add_ball(&text, "low", 0.01, below, 0.01 - sunk, 0.0);
    add_ball(&text, "high", 0.01, above, 0.03 - 2.0 * sunk, 0.0);
    scree_scene *scene = make(&row, &text);
    if (scene && step(&row, scene, 1000000))
        row.error = scree_most(fabs(body(scene, "low").position[2] - (0.01 - sunk)),
                               fabs(body(scene, "high").position[2] - (0.03 - 2.0 * sunk))) /
                    sunk;
    finish(&row);
    scree_scene_destroy(scene);
}

/* A pair of balls bounces on a floor, elastically: springs of unequal stiffness. The books tell. */
static void springs(double ground, double between) {
    struct row row = begin("springs of unequal stiffness", "energy balance (of the energy at the start)", NAN, 1e-2,
                           "ball on ball on floor at 0.1 m/s: %g N/m on %g N/m; 1e6 steps, step auto", between, ground);
    static struct text text;
    char laws[160], floor[160];
    snprintf(laws, sizeof laws, "normal = { law = \"linear\", stiffness = %.17g, damping = 0.0 }", between);
    snprintf(floor, sizeof floor, "normal = { law = \"linear\", stiffness = %.17g, damping = 0.0 }", ground);
    head(&text, 0.0, "step = \"auto\"", laws);
    add_floor(&text, floor);
    add_ball(&text, "low", 0.01, 0.01, 0.0101, -0.1);
    add_ball(&text, "high", 0.01, 0.01, 0.0302, -0.1);
    scree_scene *scene = make(&row, &text);
    double start = scene ? moving(scene) : 1.0;
    row.error = 0.0;
    for (int k = 0; scene && k < 1000 && step(&row, scene, 1000); k++)
        row.error = scree_most(row.error, fabs(energy(scene).balance) / start);
    finish(&row);
    scree_scene_destroy(scene);
}

/* ---- stacks ---- */

static void sphere_stack(int count) {
    struct row row = begin("stack of spheres", "lowest overlap (of n m g/k)", NAN, 1e-6,
                           "%d balls of 0.03 kg from rest; 1e5 steps, step auto", count);
    static struct text text;
    double sink = 0.03 * 9.81 / 1e5, z = 0.01;
    head(&text, 9.81, "step = \"auto\"", damped);
    add_floor(&text, damped);
    for (int k = 0; k < count; k++) {
        char name[16];
        snprintf(name, sizeof name, "b%d", k);
        z -= sink * (count - k);
        add_ball(&text, name, 0.01, 0.03, z, 0.0);
        z += 0.02;
    }
    scree_scene *scene = make(&row, &text);
    if (scene && step(&row, scene, 100000)) {
        row.error = fabs((0.01 - body(scene, "b0").position[2]) / (sink * count) - 1.0);
        snprintf(row.said, sizeof row.said, "kinetic energy %.2g J", moving(scene));
    }
    finish(&row);
    scree_scene_destroy(scene);
}

/* Boxes set down one on the other; they come to rest upright with their weight on the floor. */
static void box_stack(int count, double narrower) {
    struct row row = begin(narrower > 0.0 ? "pyramid of boxes" : "stack of equal boxes",
                           "force on the floor (of n m g)", NAN, 1e-3, "%d boxes of 5 x 5 x 2 cm%s; 1 s", count,
                           narrower > 0.0 ? ", each 2 mm narrower" : ", corner above corner");
    static struct text text;
    static const char laws[] = "normal = { law = \"linear-cut\", stiffness = 4e5, restitution = 0.2 }\n"
                               "friction = { law = \"coulomb\", static = 0.5, kinetic = 0.4, stiffness = 1e5, damping "
                               "= 20.0 }\nshared_by = 4";
    head(&text, 9.81, "step = \"auto\"\nspeed = 0.1", laws);
    add_floor(&text, laws);
    double weight = 0.0;
    for (int k = 0; k < count; k++) {
        char name[16];
        double side = 0.05 - narrower * k;
        snprintf(name, sizeof name, "b%d", k);
        add_box(&text, name, side, side, 0.02, 0.01 + 0.02 * k, "");
        weight += 9.81 * 2000.0 * side * side * 0.02;
    }
    scree_scene *scene = make(&row, &text);
    if (scene && step(&row, scene, (long)(1.0 / scree_scene_step_length(scene)))) {
        scree_contact_state contacts[512];
        int touching, floor = scree_scene_find_body(scene, "floor");
        double force = 0.0, away = 0.0;
        scree_scene_contacts(scene, contacts, 512, &touching);
        for (int k = 0; k < touching && k < 512; k++)
            if (contacts[k].host == floor || contacts[k].ball == floor) force += contacts[k].normal_force;
        for (int k = 0; k < scree_scene_bodies(scene); k++)
            away =
                scree_most(away, hypot(scree_scene_body(scene, k).position[0], scree_scene_body(scene, k).position[1]));
        row.error = fabs(force / weight - 1.0);
        snprintf(row.said, sizeof row.said, "kinetic energy %.2g J; largest sideways way %.2g m", moving(scene), away);
    }
    finish(&row);
    scree_scene_destroy(scene);
}

/* ---- speeds and overlaps ---- */

enum target { WALL, BALL, PLATE, TARGETS };

/* A ball flies at a target from several distances; what isn't thrown back and isn't stopped has passed through. */
static void shot(enum target target, double speeds, int automatic) {
    static const char *const what[TARGETS] = {"a plane", "a ball", "a plate of 1 mm"};
    double contact = pi * sqrt(0.03 / 1e5), v = speeds * 0.01 / contact;
    struct row row = begin("fast ball", "rebound (of the speed)", 0.0, 1e-2,
                           "%g radii per contact time (%.4g m/s) on %s, step %s; 16 distances", speeds, v, what[target],
                           automatic ? "auto" : "1/50 contact");
    static struct text text;
    for (int k = 0; k < 16 && !row.end; k++) {
        char time[64] = "step = \"auto\"";
        if (!automatic) snprintf(time, sizeof time, "step = %.17g", contact / 50.0);
        head(&text, 0.0, time, spring);
        if (target == WALL) add_floor(&text, spring);
        if (target != WALL)
            add(&text,
                "[[body]]\nname = \"target\"\nmaterial = \"m\"\njoint = \"fixed\"\nposition = [0, 0, %s]\n"
                "shape = { %s }\n",
                target == BALL ? "-0.01" : "-0.0005", target == BALL ? "sphere = 0.01" : "box = [0.2, 0.2, 0.001]");
        add_ball(&text, "ball", 0.01, 0.03, 0.02 + 0.0037 * k, -v);
        scree_scene *scene = make(&row, &text);
        if (scene && step(&row, scene, (long)((0.2 / v + 2.0 * contact) / scree_scene_step_length(scene))))
            row.error = scree_most(row.error, fabs(body(scene, "ball").velocity[2] / v - 1.0));
        scree_scene_destroy(scene);
    }
    finish(&row);
}

/* Sideways speed that a ball at `speed` (m/s) takes from a ball that it passes with an overlap of 0.2 radii. NAN:
 * stopped. */
static double deflection(struct row *row, double speed, double length, double phase) {
    static struct text text;
    char time[64];
    snprintf(time, sizeof time, "step = %.17g", length);
    head(&text, 0.0, time, spring);
    add(&text, "[[body]]\nname = \"target\"\nmaterial = \"m\"\njoint = \"fixed\"\nposition = [0.018, 0, 0]\n"
               "shape = { sphere = 0.01 }\n");
    add_ball(&text, "ball", 0.01, 0.03, 0.03 + phase * length * speed, -speed);
    scree_scene *scene = make(row, &text);
    double sideways = NAN;
    if (scene && step(row, scene, (long)(0.07 / speed / length))) {
        sideways = -body(scene, "ball").velocity[0];
        note_warnings(row, scene, moving(scene));
    }
    scree_scene_destroy(scene);
    return sideways;
}

/* A contact that is short because the ball is past: the spring has no say in that. */
static void graze(double way) {
    double contact = pi * sqrt(0.03 / 1e5), length = contact / 50.0, speed = way * 0.01 / length;
    struct row row = begin("grazing ball", "sideways speed (of that at 1/200 of the step)", 0.0, 1e-2,
                           "past a ball at %g radii per step, step 1/50 contact; 8 distances", way);
    double exact = deflection(&row, speed, length / 200.0, 0.0);
    for (int k = 0; k < 8 && !row.end; k++)
        row.error = scree_most(row.error, fabs(deflection(&row, speed, length, k / 8.0) / exact - 1.0));
    finish(&row);
}

/* A ball that starts pressed in leaves with the energy of the spring. */
static void overlap(double radii, int on_ball) {
    struct row row = begin("overlap at the start", "speed of release (of d sqrt(k/m))", NAN, 1e-2,
                           "%g radii, on a %s, step auto", radii, on_ball ? "ball" : "plane");
    static struct text text;
    double depth = 0.01 * radii, omega = sqrt(1e5 / 0.03);
    head(&text, 0.0, "step = \"auto\"", spring);
    if (!on_ball) add_floor(&text, spring);
    if (on_ball)
        add(&text, "[[body]]\nname = \"target\"\nmaterial = \"m\"\njoint = \"fixed\"\nposition = [0, 0, -0.01]\n"
                   "shape = { sphere = 0.01 }\n");
    add_ball(&text, "ball", 0.01, 0.03, 0.01 - depth, 0.0);
    scree_scene *scene = make(&row, &text);
    if (scene && step(&row, scene, (long)(pi / omega / scree_scene_step_length(scene))))
        row.error = fabs(body(scene, "ball").velocity[2] / (depth * omega) - 1.0);
    finish(&row);
    scree_scene_destroy(scene);
}

/* ---- coarse steps ---- */

/* An elastic impact at few steps per contact. The worst of 16 phases. */
static void coarse(double per_contact) {
    double contact = pi * sqrt(0.03 / 1e5);
    struct row row = begin("coarse step", "rebound (of the speed)", 0.0, 1e-2,
                           "ball on a plane at 1 m/s, %g steps per contact; 16 distances", per_contact);
    static struct text text;
    for (int k = 0; k < 16 && !row.end; k++) {
        char time[64];
        snprintf(time, sizeof time, "step = %.17g", contact / per_contact);
        head(&text, 0.0, time, spring);
        add_floor(&text, spring);
        add_ball(&text, "ball", 0.01, 0.03, 0.0105 + 0.0001 * k, -1.0);
        scree_scene *scene = make(&row, &text);
        if (scene && step(&row, scene, (long)((0.003 + 3.0 * contact) / scree_scene_step_length(scene)))) {
            row.error = scree_most(row.error, fabs(body(scene, "ball").velocity[2] - 1.0));
            note_warnings(&row, scene, fmax(0.015, moving(scene)));
        }
        scree_scene_destroy(scene);
    }
    finish(&row);
}

/* A ball pressed between two walls swings on both springs; the limit of the step knows of single contacts only. */
static void squeezed(double share) {
    double omega = sqrt(1e5 / 0.03), start = 0.5 * 0.03 * 1e-8;
    struct row row = begin("ball between two walls", "energy balance (of the energy of the swing)", 0.0, 1e-1,
                           "step of %g of the limit of one spring; 1e4 steps", share);
    static struct text text;
    char time[64];
    snprintf(time, sizeof time, "step = %.17g", share * 2.0 / omega);
    head(&text, 0.0, time, spring);
    add_floor(&text, spring);
    add(&text, "[[body]]\nname = \"lid\"\nshape = { plane = true }\nmaterial = \"floor\"\njoint = \"fixed\"\n"
               "position = [0, 0, 0.018]\norientation = { axis = [1, 0, 0], degrees = 180 }\n");
    add_ball(&text, "ball", 0.01, 0.03, 0.009, 1e-4);
    scree_scene *scene = make(&row, &text);
    for (int n = 0; scene && n < 100 && step(&row, scene, 100); n++)
        row.error = scree_most(row.error, fabs(energy(scene).balance) / start);
    if (scene && !row.end) note_warnings(&row, scene, energy(scene).stored);
    finish(&row);
    scree_scene_destroy(scene);
}

/* A ball that can't turn swings sideways on a friction spring without a dashpot: predicted velocities let it grow. */
static void sticking(double turn, double ratio) {
    struct row row = begin("sticking spring", "energy balance (of the energy at the start)", 0.0, 1e-1,
                           "damping ratio %g, omega h = %g; 1e4 steps", ratio, turn);
    static struct text text;
    char time[64], laws[300];
    double omega = 1e3, k = omega * omega, pressed = 1e-3, start = 0.5e-8;
    snprintf(time, sizeof time, "step = %.17g", turn / omega);
    snprintf(laws, sizeof laws,
             "normal = { law = \"linear\", stiffness = %.17g, damping = 0.0 }\n"
             "friction = { law = \"coulomb\", static = 10.0, kinetic = 10.0, stiffness = %.17g, damping = %.17g }",
             k / 100.0, k, 2.0 * ratio * omega);
    head(&text, k / 100.0 * pressed, time, spring);
    add_floor(&text, laws);
    add(&text,
        "[[body]]\nname = \"ball\"\nshape = { sphere = 0.01 }\nmaterial = \"m\"\nmass = 1.0\n"
        "position = [0, 0, %.17g]\nvelocity = [1e-4, 0, 0]\njoint = { turn = \"fixed\" }\n",
        0.01 - pressed);
    scree_scene *scene = make(&row, &text);
    for (int n = 0; scene && n < 100 && step(&row, scene, 100); n++)
        row.error = scree_most(row.error, fabs(energy(scene).balance) / start);
    if (scene && !row.end) note_warnings(&row, scene, fmax(start, moving(scene)));
    finish(&row);
    scree_scene_destroy(scene);
}

/* ---- long rests ---- */

/* A box on a slope of `load` (tangent), held by friction: what it moves by in the second half, beyond the law's own
 * creep. */
static void rest(const char *law, const char *friction, double load, double creep, long steps) {
    struct row row = begin("long rest", "speed in the second half beyond the law's creep (m/s)", NAN, 1e-9,
                           "box on a slope of %g, %s; %ld steps of 1e-5 s", load, law, steps);
    static struct text text;
    double g = 9.81, cosine = 1.0 / sqrt(1.0 + load * load);
    char laws[400];
    snprintf(laws, sizeof laws,
             "normal = { law = \"linear-cut\", stiffness = 4e5, restitution = 0.2 }\nshared_by = 4\nfriction = { %s }",
             friction);
    head_on_slope(&text, g * cosine * load, g * cosine, "step = 1e-5", spring);
    add_floor(&text, laws);
    add_box(&text, "box", 0.05, 0.05, 0.02, 0.01, "mass = 0.1");
    scree_scene *scene = make(&row, &text);
    if (scene && step(&row, scene, steps / 2)) {
        double before = body(scene, "box").position[0], time = scree_scene_time(scene);
        if (step(&row, scene, steps / 2)) {
            double after = body(scene, "box").position[0];
            row.error = fabs((after - before) / (scree_scene_time(scene) - time) - creep);
            snprintf(row.said, sizeof row.said, "way %.3g m; kinetic energy %.2g J; energy balance %.2g J",
                     after - before, moving(scene), energy(scene).balance);
        }
    }
    finish(&row);
    scree_scene_destroy(scene);
}

/* Bodies that lie still: fastest motion, and how far they are from the heights that are given (0: from where they lay
 * after `settling` steps). A position can't be better than its last digit, 2.8e-17 m at 0.2 m, which the forces move it
 * by within a step; ten bodies on each other add theirs up. */
static void lie(const char *what, const char *integrator, const struct text *text, long settling, long steps,
                const double *heights, double overlap, double bound) {
    struct row speed =
        begin("long rest", "fastest motion (m/s)", 0.0, bound, "%s, %s; %ld steps", what, integrator, steps);
    struct row sunk = begin("long rest", "largest shift (of the smallest overlap)", 0.0, 10.0 * 2.8e-17 / overlap,
                            "%s, %s; %ld steps", what, integrator, steps);
    scree_scene *scene = make(&speed, text);
    int count = scene ? scree_scene_bodies(scene) : 0;
    int through = scene && (settling == 0 || step(&speed, scene, settling));
    double start[16];
    for (int k = 0; k < count && k < 16; k++)
        start[k] = heights[k] > 0.0 ? heights[k] : scree_scene_body(scene, k).position[2];
    for (long n = 0; through && n < steps; n += 1000) {
        through = step(&speed, scene, 1000);
        for (int k = 0; k < count && k < 16; k++) {
            scree_body_state now = scree_scene_body(scene, k);
            for (int i = 0; i < 3; i++) speed.error = scree_most(speed.error, fabs(now.velocity[i]));
            sunk.error = scree_most(sunk.error, fabs(now.position[2] - start[k]) / overlap);
        }
    }
    sunk.end = speed.end;
    if (settling > 0) snprintf(sunk.said, sizeof sunk.said, "after %ld steps for the start to die away", settling);
    finish(&speed);
    finish(&sunk);
    scree_scene_destroy(scene);
}

/* Spheres on each other, set down on the overlaps that carry them. Verlet doesn't know at its first step what the
 * contacts do to the bodies, and predicts a free fall of half a step: that swing must die away before it rests. */
static void lie_stacked(int count, const char *integrator, double gravity, double stiffness, double mass, double length,
                        long steps) {
    enum { MOST = 10 };
    static struct text text;
    double radius = 0.01, top = 0.0, heights[MOST + 1] = {0.0};
    char time[128], laws[128], what[64];
    snprintf(time, sizeof time, "step = %.17g\nintegrator = \"%s\"", length, integrator);
    snprintf(laws, sizeof laws, "normal = { law = \"linear-cut\", stiffness = %.17g, restitution = 0.5 }", stiffness);
    snprintf(what, sizeof what, "stack of %d at %g m/s^2, steps of %g s", count, gravity, length);
    head(&text, gravity, time, laws);
    add_floor(&text, laws);
    for (int k = 0; k < count; k++) {
        char name[16];
        snprintf(name, sizeof name, "%d", k);
        top += (k ? 2.0 : 1.0) * radius - (count - k) * mass * gravity / stiffness;
        heights[k + 1] = top;
        add_ball(&text, name, radius, mass, top, 0.0);
    }
    /* The last digit of 0.2 m, in a step. */
    lie(what, integrator, &text, strcmp(integrator, "verlet") == 0 ? 500000 : 0, steps, heights,
        mass * gravity / stiffness, fmax(1e-14, 2.8e-17 / length));
}

/* A sphere between two fixed ones, with friction: placed at rest; dropped, it keeps where it came to rest. */
static void lie_in_notch(const char *integrator, int dropped, long steps) {
    static struct text text;
    static const double anywhere[3] = {0.0};
    double low = 0.012, high = 0.016, length = 6e-3;
    char time[128];
    for (int k = 0; k < 200; k++) { /* the two forces 100 d z/r hold the weight, d = 0.02 - r, r^2 = z^2 + 0.012^2 */
        double z = 0.5 * (low + high), r = sqrt(z * z + 0.012 * 0.012);
        if (2.0 * 100.0 * (0.02 - r) * z / r > 0.01)
            low = z;
        else
            high = z;
    }
    snprintf(time, sizeof time, "step = %.17g\nintegrator = \"%s\"", length, integrator);
    head(&text, 0.01, time,
         "normal = { law = \"linear-cut\", stiffness = 100.0, restitution = 0.5 }\n"
         "friction = { law = \"coulomb\", static = 0.5, kinetic = 0.4, stiffness = 80.0 }");
    for (int side = -1; side < 2; side += 2)
        add(&text,
            "[[body]]\nname = \"%s\"\nshape = { sphere = 0.01 }\nmaterial = \"m\"\nposition = [%g, 0, 0]\n"
            "joint = \"fixed\"\n",
            side < 0 ? "left" : "right", 0.012 * side);
    add_ball(&text, "ball", 0.01, 1.0, low + 1e-3 * dropped, 0.0);
    lie(dropped ? "dropped into a notch with friction" : "placed in a notch with friction", integrator, &text,
        dropped || strcmp(integrator, "verlet") == 0 ? 500000 : 0, steps, anywhere, 1e-4, 1e-14);
}

static void lies(long steps) {
    static const char *const integrators[] = {"verlet", "pair-impulse"};
    for (int k = 0; k < 2; k++) {
        lie_stacked(10, integrators[k], 0.01, 100.0, 1.0, 6e-3, steps);
        lie_stacked(10, integrators[k], 9.81, 1e5, 0.03, 2e-5, steps);
        lie_in_notch(integrators[k], 0, steps);
        lie_in_notch(integrators[k], 1, steps);
    }
}

static void rests(long steps) {
    /* tanh(v/v_t) = load/mu; creep of a ramp likewise: what the laws say of themselves. */
    double load = 0.2;
    rest("coulomb without dashpot", "law = \"coulomb\", static = 0.5, kinetic = 0.4, stiffness = 1e5", load, 0.0,
         steps);
    rest("coulomb with dashpot", "law = \"coulomb\", static = 0.5, kinetic = 0.4, stiffness = 1e5, damping = 20.0",
         load, 0.0, steps);
    rest("tanh", "law = \"tanh\", kinetic = 0.5, threshold = 1e-3", load, 1e-3 * atanh(load / 0.5), steps);
    rest("tanh, threshold near what the step bears", "law = \"tanh\", kinetic = 0.5, threshold = 2e-4", load,
         2e-4 * atanh(load / 0.5), steps);
    rest("tanh, threshold below what the step bears", "law = \"tanh\", kinetic = 0.5, threshold = 1e-6", load,
         1e-6 * atanh(load / 0.5), steps);
}

/* ---- shapes, spins and sizes ---- */

/* A thin box is thrown at a floor askew, elastically. */
static void thin(double x, double y, double z, double stiffness) {
    struct row row = begin("thin box on a floor", "energy balance (of the energy at the start)", 0.0, 1e-2,
                           "%g x %g x %g m, askew at 1 m/s on %g N/m; 0.15 s, step auto", x, y, z, stiffness);
    static struct text text;
    char laws[160];
    snprintf(laws, sizeof laws, "normal = { law = \"linear\", stiffness = %.17g, damping = 0.0 }", stiffness);
    head(&text, 0.0, "step = \"auto\"", spring);
    add_floor(&text, laws);
    add_box(&text, "box", x, y, z, 0.06,
            "velocity = [0, 0, -1]\norientation = { axis = [1, 2, 0.5], degrees = 50 }\nspin = [3, 5, 1]");
    scree_scene *scene = make(&row, &text);
    double start = scene ? moving(scene) : 1.0;
    long steps = scene ? (long)(0.15 / scree_scene_step_length(scene) / 1000.0) : 0;
    for (int k = 0; scene && k < 1000 && step(&row, scene, steps); k++)
        row.error = scree_most(row.error, fabs(energy(scene).balance) / start);
    if (scene && !row.end)
        snprintf(row.said, sizeof row.said, "deepest overlap: %.2g of the tolerable; rises at %.3g m/s",
                 scree_scene_deepest(scene, NULL, NULL), body(scene, "box").velocity[2]);
    finish(&row);
    scree_scene_destroy(scene);
}

/* A box spins freely, near its middle axis: energy of rotation. */
static void spin(double rate, double per_step) {
    struct row row = begin("fast spin", "energy of rotation", 0.0, 1e-2,
                           "box of 3 x 4 x 5 cm at %g rad/s, %g rad per step; 1e5 steps", rate, per_step);
    static struct text text;
    char time[64], more[96];
    snprintf(time, sizeof time, "step = %.17g", per_step / rate);
    snprintf(more, sizeof more, "spin = [%.17g, %.17g, %.17g]", 0.01 * rate, rate, 0.01 * rate);
    head(&text, 0.0, time, spring);
    add_box(&text, "box", 0.03, 0.04, 0.05, 0.0, more);
    scree_scene *scene = make(&row, &text);
    double start = scene ? energy(scene).rotational : 1.0;
    for (int k = 0; scene && k < 1000 && step(&row, scene, 100); k++)
        row.error = scree_most(row.error, fabs(energy(scene).rotational / start - 1.0));
    finish(&row);
    scree_scene_destroy(scene);
}

/* A glassy ball bounces once by Hertz's law, elastically. */
static void size(double radius) {
    struct row row =
        begin("size", "rebound (of the speed)", NAN, 1e-2, "radius %g m, E* = 1e9 Pa, 0.1 m/s, step auto", radius);
    static struct text text;
    static const char laws[] = "normal = { law = \"hertz\", modulus = 1e9 }";
    head(&text, 0.0, "step = \"auto\"", laws);
    add_floor(&text, laws);
    add_ball(&text, "ball", radius, 0.0, 1.001 * radius, -0.1);
    scree_scene *scene = make(&row, &text);
    if (scene) {
        double time = 0.001 * radius / 0.1 + 3.0 * scene->plan.choice.duration;
        if (step(&row, scene, (long)(time / scree_scene_step_length(scene))))
            row.error = fabs(body(scene, "ball").velocity[2] / 0.1 - 1.0);
    }
    finish(&row);
    scree_scene_destroy(scene);
}

/* A ball falls from 1 cm and bounces elastically, ten times in a row; it then has the energy of the start. */
static void fall(double gravity, double stiffness) {
    struct row row = begin("gravity", "energy balance (of m g h, or of m v^2/2)", 0.0, 1e-2,
                           "%g m/s^2, ball of 0.03 kg from 1 cm at 0.1 m/s on %g N/m, step auto", gravity, stiffness);
    static struct text text;
    char laws[160];
    snprintf(laws, sizeof laws, "normal = { law = \"linear\", stiffness = %.17g, damping = 0.0 }", stiffness);
    head(&text, gravity, "step = \"auto\"", laws);
    add_floor(&text, laws);
    add_ball(&text, "ball", 0.01, 0.03, 0.02, -0.1);
    scree_scene *scene = make(&row, &text);
    double start = 0.03 * (gravity * 0.01 + 0.005);
    for (int k = 0; scene && k < 1000 && step(&row, scene, 100); k++)
        row.error = scree_most(row.error, fabs(energy(scene).balance) / start);
    finish(&row);
    scree_scene_destroy(scene);
}

static void ratios(void) {
    static const double ratio[] = {1.0, 1e3, 1e6, 1e9};
    for (int k = 0; k < 4; k++) hit(0.03, 0.03 * ratio[k]);
    for (int k = 1; k < 4; k++) hit(0.03 * ratio[k], 0.03);
    for (int k = 0; k < 4; k++) pile(0.03 * ratio[k], 0.03);
    for (int k = 1; k < 4; k++) pile(0.03, 0.03 * ratio[k]);
    for (int k = 0; k < 4; k++) springs(1e2, 1e2 * ratio[k]);
    for (int k = 1; k < 4; k++) springs(1e2 * ratio[k], 1e2);
}

static void stacks(void) {
    static const int spheres[] = {1, 3, 10, 30, 100}, boxes[] = {1, 2, 3, 5, 10, 20};
    for (int k = 0; k < 5; k++) sphere_stack(spheres[k]);
    for (int k = 0; k < 6; k++) box_stack(boxes[k], 0.0);
    for (int k = 1; k < 6; k++) box_stack(boxes[k], 0.002);
}

static void speeds_and_overlaps(void) {
    static const double speeds[] = {0.1, 1.0, 10.0, 100.0, 1e3, 1e4}, radii[] = {0.1, 0.3, 0.5, 0.51, 0.75, 1.0};
    static const double ways[] = {0.03, 0.1, 0.3, 0.6, 0.95};
    for (int target = 0; target < TARGETS; target++)
        for (int k = 0; k < 6; k++)
            for (int automatic = 0; automatic < 2; automatic++) shot((enum target)target, speeds[k], automatic);
    for (int k = 0; k < 5; k++) graze(ways[k]);
    for (int k = 0; k < 6; k++)
        for (int on_ball = 0; on_ball < 2; on_ball++) overlap(radii[k], on_ball);
}

static void all(long steps) {
    ratios();
    stacks();
    speeds_and_overlaps();
    static const double per_contact[] = {1.5, 1.7, 2.0, 3.0, 5.0, 10.0, 20.0},
                        turns[] = {0.06, 0.2, 0.35, 0.5, 1.0, 1.5};
    for (int k = 0; k < 7; k++) coarse(per_contact[k]);
    for (int k = 0; k < 12; k++) sticking(turns[k % 6], k < 6 ? 0.0 : 0.05);
    for (double share = 0.05; share < 1.0; share += 0.3) squeezed(share);
    rests(steps);
    for (double stiffness = 1e4; stiffness < 2e6; stiffness *= 100.0) {
        thin(0.1, 0.1, 0.001, stiffness);
        thin(0.1, 0.01, 0.001, stiffness);
        thin(0.1, 0.001, 0.001, stiffness);
    }
    for (double per_step = 0.01; per_step < 20.0; per_step *= 10.0) spin(1e5, per_step);
    for (double radius = 1e-6; radius < 2e3; radius *= 1e3) size(radius);
    fall(0.0, 1e5);
    fall(1e4, 1e5);
    fall(1e4, 1e7);
}

int bench_stress(int count, char **words) {
    const char *wanted = NULL, *integrator = NULL;
    int only_rest = 0, alone = 0;
    const struct cli_option options[] = {{.name = "--integrator", .value = &integrator},
                                         {.name = "--steps", .value = &wanted},
                                         {.name = "--rest", .flag = &only_rest},
                                         {.name = "--alone", .flag = &alone},
                                         {0}};
    int code = bench_parse(count, words, options, help);
    if (code) return code < 0 ? EXIT_GOOD : code;
    long steps = wanted ? cli_whole_number(wanted, "--steps", 2000000000) : 10000000;
    if (!steps) return EXIT_USAGE;
    if (integrator && strcmp(integrator, "pair-impulse") == 0)
        run.integrator = "time.integrator=\"pair-impulse\"";
    else if (integrator && strcmp(integrator, "verlet") != 0)
        return cli_complain("the integrator is verlet or pair-impulse, not \"%s\"", integrator);
    bench_describe_machine();
    printf("case,parameters,what_happened,error,error_of,bound,said\n");
    if (only_rest) lies(steps);
    if (alone) lie_stacked(1, run.integrator ? "pair-impulse" : "verlet", 9.81, 1e5, 0.03, 2e-5, steps);
    for (run.halving = 0; run.halving < 2 && !only_rest && !alone; run.halving++) {
        run.row = 0;
        all(steps);
    }
    return EXIT_GOOD;
}
