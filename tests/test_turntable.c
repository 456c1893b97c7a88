/* Who looks on from a turntable sees nothing else: what is held on it stays where it is, and springs turn along. */
#include "tests/scenes.h"

#include <math.h>
#include <string.h>

/* The support turns about the vertical from the start on, and the body with it, at `RATE`, `PLACE` from the axis. */
#define RATE  5.0
#define PLACE 0.05
enum { STEPS = 12500 }; /* a turn */
#define STEP      1.0053096491487338e-4
#define STEP_TEXT "1.0053096491487338e-4"

static const char head[] =
    "gravity = [0, 0, -9.81]\n[time]\nend = 10.0\nstep = " STEP_TEXT "\n"
    "[[motion]]\nname = \"turn\"\nkind = \"velocity\"\nvelocity = 5\n"
    "[[material]]\nname = \"m\"\n[[contact]]\nbetween = [\"m\", \"m\"]\n"
    "normal = { law = \"linear\", stiffness = 1e4, damping = 5 }\n"
    "friction = { law = \"coulomb\", static = 0.6, kinetic = 0.5, stiffness = 1e3, damping = 3 }\n";

static const char rolling[] =
    "contact.0.rolling={ law=\"spring-dashpot\", rolling=0.6, twisting=0.1, stiffness=40, damping=0.3 }";

/* `change` may be NULL. */
struct table {
    const char *what, *support, *body, *change;
};

#define TURNED                                                                                                         \
    "joint = { x = \"fixed\", y = \"fixed\", z = \"fixed\", turn = { axis = [0, 0, 1], motion = \"turn\" } }\n"
#define PLANE  "shape = { plane = true }\n" TURNED
#define DRIVEN "joint = { turn = { axis = [0, 0, 1], motion = \"turn\" }, x = \"free\", y = \"free\", z = \"free\" }\n"
#define BALL   "shape = { sphere = 1.0 }\nposition = [0.05, 0, 0.99999019]\n" DRIVEN

/* All lie as deep in their support as their weight of 0.0981 N makes them. Balls that are big or can't roll stay where
 * they are put; one that could is held by a spring of rolling. */
static const struct table tables[] = {
    {"box on a plane", PLANE,
     "shape = { box = [0.02, 0.02, 0.01], rounding = 0.001 }\nposition = [0.05, 0, 0.00499755]\n", NULL},
    {"ball on a plane", PLANE, BALL, NULL},
    {"ball on a box", "shape = { box = [0.5, 0.5, 0.1] }\nposition = [0, 0, -0.05]\n" TURNED, BALL, NULL},
    {"balls of one size", "shape = { sphere = 1.0 }\nposition = [0, 0, -1]\n" TURNED,
     "shape = { sphere = 1.0 }\nposition = [0.05, 0, 0.99936509]\n" DRIVEN, NULL},
    {"balls of two sizes", "shape = { sphere = 2.0 }\nposition = [0, 0, -2]\n" TURNED,
     "shape = { sphere = 1.0 }\nposition = [0.05, 0, 0.99957349]\n" DRIVEN, NULL},
    {"ball that could roll", PLANE, "shape = { sphere = 0.01 }\nposition = [0.05, 0, 0.00999019]\n", rolling}};

static scree_scene *turning(const struct table *table, const char *integrator) {
    char text[2000], by[64];
    const char *changes[] = {by, "time.force=true", table->change};
    double spin = strstr(table->body, "motion") ? 0.0 : RATE;
    snprintf(by, sizeof by, "time.integrator=\"%s\"", integrator);
    snprintf(text, sizeof text,
             "%s[[body]]\nname = \"table\"\nmaterial = \"m\"\n%s[[body]]\nname = \"body\"\nmaterial = \"m\"\n"
             "mass = 0.01\nvelocity = [0, %.17g, 0]\nspin = [0, 0, %.17g]\n%s",
             head, table->support, RATE * PLACE, spin, table->body);
    return scene_from(text, changes, table->change ? 3 : 2, 1);
}

/* Friction on the body, as it is measured at this instant. */
static struct vec friction_of(const scree_scene *scene) {
    struct vec sum = {0.0, 0.0, 0.0};
    for (int b = 0; b < scene->contacts.batches; b++) {
        const struct scree_batch *batch = &scene->contacts.batch[b];
        for (int k = scree_first(batch); k >= 0; k = scree_next(batch, k)) {
            struct scree_touch touch;
            if (!scree_contacts_measure(&scene->contacts, &scene->bodies, b, k, &touch)) continue;
            double sign = scene->bodies.record[touch.ball].inverse_mass > 0.0 ? 1.0 : -1.0;
            sum = vec_axpy(sum, sign, touch.tangential);
        }
    }
    return sum;
}

/* After one turn all is at rest, seen from the table. Springs that didn't turn with it would creep by their stretch in
 * every radian, 2e-5 to 2e-3 m a turn here. Steps do to second order what they should (how far they turn a stretch, and
 * bodies on their way), and measure the force in the direction that it has at their end, not in their middle. */
static void test_held(const struct table *table, const char *integrator) {
    int steps = strcmp(integrator, "adaptive") != 0;
    double place[2], angle = steps ? (RATE * STEP) * (RATE * STEP) : 1e-9;
    scree_scene *scene = turning(table, integrator);
    for (int turn = 0; turn < 2; turn++) {
        go(scene, STEPS);
        scree_body_state body = state_of(scene, "body");
        place[turn] = atan2(body.position[1], body.position[0]);
    }
    scree_body_state body = state_of(scene, "body");
    struct vec force = friction_of(scene), out = {cos(place[1]), sin(place[1]), 0.0};
    double aside = force.y * out.x - force.x * out.y, load = vec_norm(force);
    double creep = fabs(place[1] - place[0]), bound = 2.0 * acos(-1.0) * angle;
    if (getenv("SCREE_SHOW"))
        printf("%s, %s: creeps by %.1e a turn (bound %.1e), force off by %.1e\n", table->what, integrator, creep, bound,
               aside / load);
    CHECK(creep < bound);
    CHECK(vec_dot(force, out) < 0.0 && hypot(body.position[0], body.position[1]) > PLACE);
    if (steps) CHECK(fabs(aside) < 0.1 * RATE * STEP * load);
    scree_scene_destroy(scene);
}

int main(void) {
    static const char *const integrators[] = {"verlet", "pair-impulse", "adaptive"};
    for (size_t k = 0; k < sizeof tables / sizeof *tables; k++)
        for (int i = 0; i < 3; i++) test_held(&tables[k], integrators[i]);
    return check_report();
}
