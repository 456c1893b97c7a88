/* Boxes by the dozen: a row of dominoes, a wall of bricks, cards that lean on each other. */
#include "engine/cli/figures.h"

#include <math.h>

static const double gravity = 9.81;

/* ---- a row of dominoes: the rigid limit ---- */

/* Heights, thickness, gaps, m. */
struct row {
    double height, thickness, gap;
};

/* Behind the head of the wave all dominoes lean on the next one with their upper edge, without friction:
 * h sin(a' - a) = (s + d) cos a - d, with a' of the one behind (van Leeuwen, Am. J. Phys. 78 (2010) 721,
 * arXiv:physics/0401018). */
static double behind(const struct row *row, double angle, double *rate) {
    double pitch = row->gap + row->thickness, h = row->height;
    double apart = asin((pitch * cos(angle) - row->thickness) / h);
    *rate = 1.0 - pitch * sin(angle) / (h * cos(apart));
    return angle + apart;
}

/* What moves with the head at its angle, as seen from it: inertia, in parts of one domino's, and potential energy over
 * m g/2, of `fallen` dominoes and it. */
static void train(const struct row *row, double angle, int fallen, double *inertia, double *energy) {
    double speed = 1.0, rate;
    *inertia = *energy = 0.0;
    for (int k = 0; k <= fallen; k++) {
        *inertia += speed * speed;
        *energy += row->height * cos(angle) + row->thickness * sin(angle);
        angle = behind(row, angle, &rate);
        speed *= rate;
    }
}

/* One fall: the head turns from upright to where it hits the next one, energy is kept; at the hit what moved before
 * shares its momentum with one more, and nothing bounces. */
struct fall {
    double spin;       /* of the head, after the hit before, then after this one, rad/s */
    double half, time; /* s: until it has turned by half of that, and until it hits */
};

static void fall(const struct row *row, int fallen, struct fall *f) {
    enum { PARTS = 1000 };
    double h = row->height, d = row->thickness, hits = asin(row->gap / h), moment = (h * h + d * d) / 3.0;
    double inertia, energy, start, kinetic;
    train(row, 0.0, fallen, &inertia, &start);
    kinetic = inertia * f->spin * f->spin;
    f->time = 0.0;
    for (int k = 0; k < PARTS; k++) {
        if (k == PARTS / 2) f->half = f->time;
        train(row, hits * (k + 0.5) / PARTS, fallen, &inertia, &energy);
        f->time += hits / PARTS * sqrt(inertia / (kinetic + gravity / moment * (start - energy)));
    }
    train(row, hits, fallen, &inertia, &energy);
    f->spin = sqrt((kinetic + gravity / moment * (start - energy)) / inertia) * inertia / (1.0 + inertia);
}

enum { DOMINOES = 17, FROM = 1, TO = DOMINOES - 2 };
static const double kick = 4.0; /* rad/s, of the first */

/* Speed of the wave between the instants at which the dominoes FROM and TO have turned half-way. */
static double rigid_speed(const struct row *row) {
    struct fall f = {kick, 0.0, 0.0};
    double time = 0.0, first = 0.0;
    for (int k = 0; k <= TO; k++) {
        fall(row, k, &f);
        if (k == FROM) first = time + f.half;
        if (k < TO) time += f.time;
    }
    return (TO - FROM) * (row->gap + row->thickness) / (time + f.half - first);
}

/* ---- the same row in the engine ---- */

/* Feet don't slip, faces do; what meets stays together. */
static scree_scene *make_row(struct figures *figures, const struct row *row) {
    static char text[16384];
    double mass = 1000.0 * row->height * row->thickness * 0.025, stiffness = 1e5,
           damping = 2.0 * sqrt(stiffness * mass);
    int n = snprintf(text, sizeof text,
                     "gravity = [0, 0, -9.81]\n[time]\nend = 10\nspeed = 0.5\n[output]\nwrite = []\n"
                     "[[material]]\nname = \"m\"\ndensity = 1000\n[[material]]\nname = \"w\"\n"
                     "[[contact]]\nbetween = [\"m\", \"w\"]\n"
                     "normal = { law = \"linear-cut\", stiffness = %g, damping = %g }\n"
                     "friction = { law = \"coulomb\", static = 1e3, kinetic = 1e3, stiffness = %g, damping = %g }\n"
                     "[[contact]]\nbetween = [\"m\", \"m\"]\ncorners = true\n"
                     "normal = { law = \"linear-cut\", stiffness = %g, damping = %g }\n"
                     "[[body]]\nname = \"floor\"\nshape = { plane = true }\nmaterial = \"w\"\njoint = \"fixed\"\n",
                     stiffness, damping, stiffness, damping, 0.1 * stiffness, 0.3 * damping);
    for (int k = 0; k < DOMINOES; k++) {
        double spin = k ? 0.0 : kick;
        n += snprintf(
            text + n, sizeof text - (size_t)n,
            "[[body]]\nname = \"%d\"\nmaterial = \"m\"\nshape = { box = [%.17g, 0.025, %.17g], rounding = 5e-5 }\n"
            "position = [%.17g, 0, %.17g]\nvelocity = [%.17g, 0, %.17g]\nspin = [0, %.17g, 0]\n",
            k, row->thickness, row->height, (row->gap + row->thickness) * k, 0.5 * row->height,
            0.5 * spin * row->height, 0.5 * spin * row->thickness, spin);
    }
    return figures_scene_text(figures, text);
}

/* The same speed. */
static scree_status watch_row(struct figures *figures, const struct row *row, double *speed) {
    scree_scene *scene = make_row(figures, row);
    if (!scene) return figures->trouble.status;
    double goal = 0.5 * asin(row->gap / row->height), first = 0.0, angle = 0.0;
    scree_status status = SCREE_OK;
    for (int k = FROM; k <= TO && !status && scree_scene_time(scene) < 3.0;) {
        double before = angle, h = scree_scene_step_length(scene);
        status = figures_step(figures, scene, 1);
        angle = 2.0 * asin(scree_scene_body(scene, k + 1).orientation[2]);
        if (angle < goal) continue;
        double time = scree_scene_time(scene) - h * (angle - goal) / (angle - before);
        if (k == FROM) first = time;
        k = k == FROM ? TO : TO + 1;
        *speed = (TO - FROM) * (row->gap + row->thickness) / (time - first);
        angle = 2.0 * asin(scree_scene_body(scene, TO + 1).orientation[2]);
    }
    scree_scene_destroy(scene);
    return status;
}

/* Corners are balls of 5e-5 m, which makes the foot shorter by 1.3 % and the push that a domino needs to topple as much
 * smaller: a few 1e-3 of the speed. In the rigid limit nothing gives where dominoes lean, and they never part. */
scree_status suite_dominoes(struct figures *figures) {
    static const struct row rows[] = {{0.05, 0.008, 0.02}, {0.05, 0.008, 0.03}, {0.048, 0.0075, 0.012}};
    for (size_t k = 0; k < sizeof rows / sizeof rows[0]; k++) {
        const struct row *row = &rows[k];
        double speed = 0.0;
        scree_status status = watch_row(figures, row, &speed);
        if (status) return status;
        char quantity[96];
        snprintf(quantity, sizeof quantity, "speed of the wave, %g mm high, %g thick, %g apart (m/s)",
                 1e3 * row->height, 1e3 * row->thickness, 1e3 * row->gap);
        figures_report(figures, "dominoes", quantity, rigid_speed(row), speed, 5e-3);
    }
    return SCREE_OK;
}

/* ---- what stands ---- */

static const char head[] =
    "gravity = [0, 0, -9.81]\n[time]\nend = 100\nstep = 2e-5\n[output]\nwrite = []\n"
    "[[material]]\nname = \"m\"\ndensity = 1000\n[[contact]]\nbetween = [\"m\", \"m\"]\n"
    "normal = { law = \"linear-cut\", stiffness = 1e5, restitution = 0.2 }\n"
    "friction = { law = \"coulomb\", static = 0.5, kinetic = 0.5, stiffness = 1e5, damping = 50 }\n"
    "[[body]]\nname = \"floor\"\nshape = { plane = true }\nmaterial = \"m\"\njoint = \"fixed\"\n";

/* A wall of `courses` courses in running bond, bricks of 0.2 m x 0.1 m x 0.06 m with joints of 2 mm, half ones at the
 * ends of every other course. Returns how many they are. */
static int write_wall(char *text, size_t size, int courses, int across) {
    int used = snprintf(text, size, "%s", head), bricks = 0;
    for (int row = 0; row < courses; row++)
        for (int k = 0; k < across + row % 2; k++, bricks++) {
            int half = row % 2 && (k == 0 || k == across);
            double x = 0.202 * (k - 0.5 * (row % 2)) + (half ? k == 0 ? 0.0505 : -0.0505 : 0.0);
            used += snprintf(
                text + used, size - (size_t)used,
                "[[body]]\nname = \"%d.%d\"\nmaterial = \"m\"\nshape = { box = [%g, 0.1, 0.06], rounding = 3e-3 }\n"
                "position = [%.17g, 0, %.17g]\n",
                row, k, half ? 0.099 : 0.2, x, 0.03 + 0.06 * row);
        }
    return bricks;
}

/* Eight courses, after a second to settle: how far the bricks move in the next half second. */
scree_status suite_wall(struct figures *figures) {
    enum { COURSES = 8, ACROSS = 4, MOST = COURSES * (ACROSS + 1) };
    static char text[16384];
    int bricks = write_wall(text, sizeof text, COURSES, ACROSS);
    scree_scene *scene = figures_scene_text(figures, text);
    if (!scene) return figures->trouble.status;
    double before[MOST][3], moved = 0.0, turned = 0.0;
    scree_status status = figures_step(figures, scene, 50000);
    for (int k = 0; k < bricks; k++)
        for (int i = 0; i < 3; i++) before[k][i] = scree_scene_body(scene, k + 1).position[i];
    if (!status) status = figures_step(figures, scene, 25000);
    for (int k = 0; k < bricks; k++) {
        scree_body_state brick = scree_scene_body(scene, k + 1);
        for (int i = 0; i < 3; i++) moved = scree_most(moved, fabs(brick.position[i] - before[k][i]));
        turned = scree_most(turned, 2.0 * sqrt(1.0 - fmin(brick.orientation[0] * brick.orientation[0], 1.0)));
    }
    scree_scene_destroy(scene);
    if (status) return status;
    /* Dashpots let nothing swing for a second. Outer bricks lean: seven above them press 82 N on four springs, 2e-4 m,
     * over 0.1 m. */
    figures_report(figures, "wall", "a wall of 36 bricks: largest motion in half a second (m)", 0.0, moved, 1e-9);
    figures_report(figures, "wall", "the same: a brick's lean (rad)", 0.0, turned, 2e-3);
    return SCREE_OK;
}

/* Two cards lean on each other at an angle from the plumb line. Moments about the foot of one, a ball of the rounding,
 * ask for a friction of (h sin - t cos)/2/(h cos + r), with the core's height h and thickness t. Whether they stand. */
static const double card_rounding = 3e-3, card_height = 0.2 - 6e-3, card_thickness = 0.01 - 6e-3;

static double friction_needed(double angle) {
    return 0.5 * (card_height * sin(angle) - card_thickness * cos(angle)) / (card_height * cos(angle) + card_rounding);
}

static scree_status cards_stand(struct figures *figures, double angle, int *stand) {
    double h = card_height, t = card_thickness, r = card_rounding;
    double rise = r + 0.5 * (h * cos(angle) + t * sin(angle)), across = 0.5 * (h * sin(angle) + t * cos(angle)) + r;
    char text[2048];
    int used = snprintf(text, sizeof text, "%s", head);
    for (int side = -1; side < 2; side += 2)
        used +=
            snprintf(text + used, sizeof text - (size_t)used,
                     "[[body]]\nname = \"%s\"\nmaterial = \"m\"\nshape = { box = [0.01, 0.1, 0.2], rounding = 3e-3 }\n"
                     "position = [%.17g, 0, %.17g]\norientation = { axis = [0, 1, 0], angle = %.17g }\n",
                     side < 0 ? "left" : "right", side * across, rise, -side * angle);
    scree_scene *scene = figures_scene_text(figures, text);
    if (!scene) return figures->trouble.status;
    scree_status status = figures_step(figures, scene, 100000);
    *stand = scree_scene_body(scene, 1).position[2] > 0.9 * rise;
    scree_scene_destroy(scene);
    return status;
}

/* The angle at which they slide, by halves: their springs give by 2e-5 m, which is 1e-4 of their height, and the start,
 * on springs without load, asks for up to as much more. Near the critical angle they slide so slowly that two seconds
 * don't show it. */
scree_status suite_cards(struct figures *figures) {
    double exact[2] = {0.3, 1.2};
    for (int k = 0; k < 60; k++) {
        double middle = 0.5 * (exact[0] + exact[1]);
        exact[friction_needed(middle) > 0.5] = middle;
    }
    double low = 0.97 * exact[0], high = 1.03 * exact[0];
    for (int k = 0; k < 8; k++) {
        int stand = 0;
        scree_status status = cards_stand(figures, 0.5 * (low + high), &stand);
        if (status) return status;
        *(stand ? &low : &high) = 0.5 * (low + high);
    }
    figures_report(figures, "cards", "angle from which on two cards slide, friction 0.5 (rad)", exact[0],
                   0.5 * (low + high), 5e-3);
    return SCREE_OK;
}
