/* Boxes: the collider against an oracle, lists, and boxes that stand, slide, tip and fall. */
#include "tests/boxes_oracle.h"
#include "tests/scenes.h"

#include <stdarg.h>

/* ---- the collider ---- */

static void judge_boxes(long pairs, double roundness, double deepest) {
    uint64_t seed = 12345;
    struct oracle_count count = {0};
    for (long k = 0; k < pairs; k++) oracle_try_boxes(&seed, roundness, deepest, &count);
    /* Rounding: some 1e-16 of the coordinates, times the ratio of a box's edges, 20. */
    CHECK(count.phantoms == 0 && count.missed == 0 && count.deeper == 0);
    CHECK(count.touching > pairs / 2 && count.edges > pairs / 10);
}

static void test_collider(void) {
    judge_boxes(60000, 0.2, 0.95); /* up to nearly all of the roundings */
    judge_boxes(20000, 1.0, 0.95);
    judge_boxes(20000, 0.02, 0.95);
    judge_boxes(30000, 0.2, 0.0); /* up to half-way in */
    judge_boxes(60000, 0.0, 0.0);
    uint64_t seed = 54321;
    struct oracle_count count = {0};
    for (long k = 0; k < 100000; k++) oracle_try_sphere(&seed, &count);
    CHECK(count.phantoms == 0 && count.missed == 0 && count.deeper == 0);
    CHECK(count.touching > 50000);
}

enum { CORNERS = 8, FEATURES = SCREE_EDGES * SCREE_EDGES + CORNERS };

/* A pair of edges, or a corner of a. */
static struct scree_crossing meet_either(const struct scree_two_boxes *boxes, int which) {
    if (which < CORNERS) return scree_meet_corner(boxes, which);
    return scree_meet_edges(boxes, (which - CORNERS) / SCREE_EDGES, (which - CORNERS) % SCREE_EDGES);
}

/* Turn box a, or b, by a little about an axis, or shift a; what q becomes. */
static double moved_overlap(struct oracle_pair pair, int what, int axis, double by, int which) {
    struct vec unit = vec(axis == 0, axis == 1, axis == 2);
    struct scree_attitude *turned = what == 1 ? &pair.a : &pair.b;
    pair.boxes.a = &pair.a;
    pair.boxes.b = &pair.b;
    if (what == 0) pair.boxes.apart = vec_axpy(pair.boxes.apart, by, unit);
    for (int k = 0; what > 0 && k < 3; k++) {
        struct vec *column = &turned->frame.column[k];
        struct vec aside = vec_cross(unit, *column);
        *column = vec_add(vec_axpy(*column, sin(by), aside), vec_scale(1.0 - cos(by), vec_cross(unit, aside)));
    }
    scree_draw_in(&pair.boxes);
    return meet_either(&pair.boxes, which).meeting.overlap;
}

/* The least sine between an axis of the one and one of the other: edges that are nearly parallel turn their normal
 * fast, which no difference quotient follows. */
static double least_sine(const struct oracle_pair *pair) {
    double least = 1.0;
    for (int k = 0; k < 9; k++)
        least = scree_least(least, vec_norm(vec_cross(pair->a.frame.column[k / 3], pair->b.frame.column[k % 3])));
    return least;
}

/* Moving away from the other box, or turning, as the gradient says, makes q smaller by as much: between what is found
 * on the one and on the other side, which differ where the least deep direction, or the nearest face, is another
 * one. */
static void check_slope_of(const struct oracle_pair *pair, int which, const struct scree_crossing *c) {
    /* Curvature is up to 1/(0.2 x 1e-3 m) where cores are drawn in, times the shift; and rounding of q, 1e-16 m over
     * the shift. */
    const double by = 1e-8, tolerance = 1e-3;
    const struct vec gradient[3] = {c->force, c->turn_a, c->turn_b};
    for (int what = 0; what < 3; what++)
        for (int axis = 0; axis < 3; axis++) {
            double ahead = (c->meeting.overlap - moved_overlap(*pair, what, axis, by, which)) / by;
            double behind = (moved_overlap(*pair, what, axis, -by, which) - c->meeting.overlap) / by;
            double is = axis == 0 ? gradient[what].x : axis == 1 ? gradient[what].y : gradient[what].z;
            CHECK(is > fmin(ahead, behind) - tolerance && is < fmax(ahead, behind) + tolerance);
        }
}

/* What corners, and edges on edges, do is the gradient of their overlaps, also where corners share in an edge's, and in
 * boxes deeper in each other than their roundings. */
static void check_gradient(double roundness, double deepest, int pairs, int least) {
    uint64_t seed = 99;
    int found[2] = {0}, leaning = 0;
    for (int k = 0; k < pairs; k++) {
        struct oracle_pair pair;
        oracle_random_pair(&pair, &seed, roundness, deepest);
        if (least_sine(&pair) < 0.02) continue;
        scree_draw_in(&pair.boxes);
        CHECK(deepest == 0.0 || pair.boxes.inset.by == 0.0);
        for (int which = 0; which < FEATURES; which++) {
            struct scree_crossing c = meet_either(&pair.boxes, which);
            if (!(c.meeting.overlap > 1e-3)) continue;
            found[which >= CORNERS]++;
            leaning += vec_norm(vec_sub(c.force, c.meeting.normal)) > 0.05;
            check_slope_of(&pair, which, &c);
        }
    }
    CHECK(found[0] > least && found[1] > least && leaning > least / 10);
}

static void test_gradient(void) {
    check_gradient(0.5, 0.9, 1500, 100);
    check_gradient(0.0, 0.0, 1500, 100);
    check_gradient(0.05, 0.0, 1500, 100);
}

/* ---- scenes ---- */

/* A scene as it is written, body after body. */
struct draft {
    char text[65536];
    int used;
};

SCREE_PRINTF(2, 3) static void write_on(struct draft *d, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    d->used += vsnprintf(d->text + d->used, sizeof d->text - (size_t)d->used, format, arguments);
    va_end(arguments);
}

/* Gravity tilted by `slope` about y; one material whose contacts are damped springs of k for each point that
 * touches. */
static struct draft *begin_draft(double slope, double step, double stiffness, const char *friction) {
    struct draft *d = calloc(1, sizeof *d);
    write_on(d,
             "gravity = [%.17g, 0, %.17g]\n[time]\nend = 1000.0\nstep = %.17g\n[[material]]\nname = \"m\"\n"
             "density = 1000\n[[contact]]\nbetween = [\"m\", \"m\"]\n"
             "normal = { law = \"linear-cut\", stiffness = %.17g, restitution = 0.2 }\nfriction = { %s }\n",
             9.81 * sin(slope), -9.81 * cos(slope), step, stiffness, friction);
    return d;
}

static void add_box(struct draft *d, const char *name, struct vec size, double rounding, struct vec at,
                    const char *more) {
    write_on(d,
             "[[body]]\nname = \"%s\"\nmaterial = \"m\"\nshape = { box = [%.17g, %.17g, %.17g], rounding = %.17g }\n"
             "position = [%.17g, %.17g, %.17g]\n%s\n",
             name, size.x, size.y, size.z, rounding, at.x, at.y, at.z, more);
}

static void add_floor(struct draft *d) {
    write_on(d, "[[body]]\nname = \"floor\"\nmaterial = \"m\"\nshape = { plane = true }\njoint = \"fixed\"\n");
}

static scree_scene *end_draft(struct draft *d) {
    scree_scene *scene = scene_from(d->text, NULL, 0, 0);
    free(d);
    return scene;
}

static const char sticks[] = "law = \"coulomb\", static = 0.5, kinetic = 0.5, stiffness = 1e5, damping = 200";

/* Boxes that tumble in a heap: whenever lists are made, also just before a touch, and whatever they hold, the bits are
 * the same. */
static void test_lists_leave_no_trace(void) {
    static const double skins[] = {0.6e-3, 0.9e-3, 2e-3, 4e-3};
    uint64_t hash[4];
    for (int n = 0; n < 4; n++) {
        uint64_t seed = 5;
        struct draft *d =
            begin_draft(0.0, 1e-6, 1500.0, "law = \"coulomb\", static = 0.5, kinetic = 0.4, stiffness = 450");
        add_floor(d);
        for (int k = 0; k < 60; k++) {
            char name[16], more[256];
            struct quat q = oracle_attitude(&seed);
            snprintf(name, sizeof name, "b%d", k);
            snprintf(more, sizeof more, "orientation = [%.17g, %.17g, %.17g, %.17g]\nvelocity = [%g, %g, -0.5]", q.w,
                     q.x, q.y, q.z, 0.5 * (1 - k % 3), 0.5 * (1 - k / 3 % 3));
            const double *edge = oracle_edges[k % ORACLE_SHAPES];
            add_box(d, name, vec(0.01 * edge[0], 0.01 * fmax(edge[1], 0.3), 0.01 * fmax(edge[2], 0.3)),
                    k % 2 ? 2e-4 : 0.0, vec(0.017 * (k % 3 - 1), 0.017 * (k / 3 % 3 - 1), 0.01 + 0.017 * (k / 9)),
                    more);
        }
        scree_scene *scene = end_draft(d);
        scene->contacts.skin = skins[n];
        CHECK(scree_contacts_list(&scene->contacts, &scene->bodies, 1, NULL) == SCREE_OK);
        go(scene, 15000);
        hash[n] = scree_scene_hash(scene);
        scree_scene_destroy(scene);
    }
    CHECK(hash[0] == hash[1] && hash[1] == hash[2] && hash[2] == hash[3]);
}

/* What the bodies move by in `steps` steps, at most, m; their kinetic energy at the end, J. */
static double moved(scree_scene *scene, long steps, double *kinetic) {
    struct vec before[64];
    double most = 0.0;
    int bodies = scene->bodies.count;
    for (int k = 0; k < bodies; k++) before[k] = vec_from(scree_scene_body(scene, k).position);
    go(scene, steps);
    for (int k = 0; k < bodies; k++)
        most = scree_most(most, vec_norm(vec_sub(vec_from(scree_scene_body(scene, k).position), before[k])));
    scree_energy energy;
    CHECK(scree_scene_energy(scene, &energy) == SCREE_OK);
    *kinetic = energy.kinetic + energy.rotational;
    return most;
}

/* ---- lists ---- */

/* Put the pair where the first two bodies of the scene are. */
static void place_pair(struct scree_bodies *bodies, const struct oracle_pair *pair) {
    const struct scree_attitude *box[2] = {&pair->a, &pair->b};
    const double rounding[2] = {pair->boxes.rounding_a, pair->boxes.rounding_b};
    for (int k = 0; k < 2; k++) {
        vec_store(k ? vec(0.0, 0.0, 0.0) : pair->boxes.apart, bodies->record[k].x);
        bodies->record[k].radius = rounding[k];
        bodies->attitude[scree_kind_of(bodies, k)->slot] = *box[k];
        for (int c = 0; c < CORNERS; c++) {
            struct vec corner = vec(0.0, 0.0, 0.0);
            for (int axis = 0; axis < 3; axis++)
                corner =
                    vec_axpy(corner, (c >> axis & 1 ? 1.0 : -1.0) * box[k]->half[axis], box[k]->frame.column[axis]);
            vec_store(corner, bodies->corner[1 + CORNERS * scree_kind_of(bodies, k)->slot + c]);
        }
    }
}

/* Shift and turn box a, so that no point of it goes farther than `way`. */
static void move_pair(struct oracle_pair *pair, uint64_t *seed, double way) {
    double bound = pair->boxes.rounding_a + vec_norm(vec_from(pair->a.half)), shift = oracle_random(seed);
    struct vec axis = oracle_direction(seed);
    double half = 0.5 * (1.0 - shift) * way / bound;
    struct mat turn = quat_to_mat((struct quat){cos(half), sin(half) * axis.x, sin(half) * axis.y, sin(half) * axis.z});
    for (int k = 0; k < 3; k++) pair->a.frame.column[k] = mat_apply(&turn, pair->a.frame.column[k]);
    pair->boxes.apart = vec_axpy(pair->boxes.apart, shift * way, oracle_direction(seed));
}

/* Whatever touches after the boxes have gone some way was near for this way before: corners and edges, in boxes that
 * are, or get, deeper in each other than their roundings. */
static void test_foresight(void) {
    scree_scene *scene = scene_from("[[material]]\nname = \"m\"\ndensity = 1000\n[time]\nend = 1.0\nstep = 1e-5\n"
                                    "[[contact]]\nbetween = [\"m\", \"m\"]\nnormal = { law = \"linear-cut\", "
                                    "stiffness = 1e3, damping = 0 }\n[[body]]\nname = \"a\"\nmaterial = \"m\"\n"
                                    "shape = { box = [1, 1, 1] }\n[[body]]\nname = \"b\"\nmaterial = \"m\"\n"
                                    "shape = { box = [1, 1, 1] }\nposition = [2, 0, 0]\n",
                                    NULL, 0, 0);
    uint64_t seed = 31;
    int unforeseen = 0, came[2] = {0};
    for (int n = 0; n < 40000; n++) {
        struct oracle_pair pair;
        oracle_random_pair(&pair, &seed, n % 2 ? 0.1 : 0.0, 0.0);
        pair.boxes.a = &pair.a;
        pair.boxes.b = &pair.b;
        double way = 0.4 * pair.thinnest * oracle_random(&seed), overlap = scree_cores_overlap(&pair.boxes);
        int code[SCREE_EDGES * SCREE_EDGES], count = scree_near_edges(&pair.boxes, overlap, way, code);
        unsigned char near[2 * CORNERS + SCREE_EDGES * SCREE_EDGES + 1] = {0};
        place_pair(&scene->bodies, &pair);
        for (int k = 0; k < 2 * CORNERS; k++) {
            int ball = k / CORNERS, slot = scree_kind_of(&scene->bodies, ball)->slot;
            struct scree_contact contact = {ball, !ball, 1 + CORNERS * slot + k % CORNERS};
            near[k] = scree_gap(&scene->bodies, &contact, way, overlap) <= way;
        }
        for (int k = 0; k < count; k++) near[2 * CORNERS + code[k]] = 1;
        move_pair(&pair, &seed, way);
        struct scree_two_boxes boxes = pair.boxes, swapped = oracle_swap(&boxes);
        scree_draw_in(&boxes);
        scree_draw_in(&swapped);
        for (int k = 0; k < 2 * CORNERS; k++) {
            int touches = scree_meet_corner(k < CORNERS ? &boxes : &swapped, k % CORNERS).meeting.overlap > 0.0;
            unforeseen += touches && !near[k];
            came[0] += touches;
        }
        for (int e = 0; e < SCREE_EDGES * SCREE_EDGES; e++) {
            int touches = scree_meet_edges(&boxes, e / SCREE_EDGES, e % SCREE_EDGES).meeting.overlap > 0.0;
            unforeseen += touches && !near[2 * CORNERS + scree_crossing_code(e / SCREE_EDGES, e % SCREE_EDGES)];
            came[1] += touches;
        }
    }
    CHECK(unforeseen == 0);
    CHECK(came[0] > 10000 && came[1] > 10000);
    scree_scene_destroy(scene);
}

/* ---- boxes on boxes at rest ---- */

/* Faces on each other that no corner of either bears: a cube turned by 45 degrees on one as large (eight crossings), a
 * plank across two walls (four on each). It sinks by its weight over the sum of the springs, and stays where it is. */
static void test_crossed_faces(void) {
    for (int k = 0; k < 4; k++) {
        double rounding = k % 2 ? 0.004 : 0.0, stiffness = 1e5, kinetic, height;
        struct draft *d = begin_draft(0.0, 5e-5, stiffness, sticks);
        if (k < 2) {
            add_box(d, "lower", vec(0.1, 0.1, 0.1), rounding, vec(0.0, 0.0, 0.05), "joint = \"fixed\"");
            add_box(d, "upper", vec(0.1, 0.1, 0.1), rounding, vec(0.0, 0.0, 0.15),
                    "orientation = { axis = [0, 0, 1], degrees = 45 }");
            height = 0.15;
        } else {
            add_box(d, "left", vec(0.02, 0.2, 0.1), rounding, vec(-0.05, 0.0, 0.05), "joint = \"fixed\"");
            add_box(d, "right", vec(0.02, 0.2, 0.1), rounding, vec(0.05, 0.0, 0.05), "joint = \"fixed\"");
            add_box(d, "upper", vec(0.2, 0.1, 0.02), rounding, vec(0.0, 0.0, 0.11), "");
            height = 0.11;
        }
        scree_scene *scene = end_draft(d);
        double mass = scree_scene_body_mass(scene, scree_scene_find_body(scene, "upper"));
        go(scene, 15000);
        CHECK(moved(scene, 2000, &kinetic) < 1e-14);
        NEAR(state_of(scene, "upper").position[2], height - mass * 9.81 / (8.0 * stiffness), 1e-12);
        scree_scene_destroy(scene);
    }
}

/* A plank across two walls, for which no corner is there to bear it: if boxes are to meet with corners only, it falls
 * freely. */
static void test_corners_only(void) {
    const char *corners = "contact.0.corners=true";
    struct draft *d = begin_draft(0.0, 5e-5, 1e5, sticks);
    add_box(d, "left", vec(0.02, 0.2, 0.1), 0.004, vec(-0.05, 0.0, 0.05), "joint = \"fixed\"");
    add_box(d, "right", vec(0.02, 0.2, 0.1), 0.004, vec(0.05, 0.0, 0.05), "joint = \"fixed\"");
    add_box(d, "upper", vec(0.2, 0.1, 0.02), 0.004, vec(0.0, 0.0, 0.11), "");
    scree_scene *scene = scene_from(d->text, &corners, 1, 0);
    go(scene, 400);
    NEAR(state_of(scene, "upper").position[2], 0.11 - 0.5 * 9.81 * 0.02 * 0.02, 1e-12);
    scree_scene_destroy(scene);
    free(d);
}

/* Bricks that overlap by a corner each: two corners and two crossings. The crossings take over as the brick tilts, so
 * it stands; it tilts by less than what it sinks, 2 m g/k at one corner, over its half width. */
static void test_offset_bricks(void) {
    struct draft *d = begin_draft(0.0, 5e-5, 1e5, sticks);
    double kinetic;
    add_box(d, "lower", vec(0.2, 0.1, 0.05), 0.004, vec(0.0, 0.0, 0.025), "joint = \"fixed\"");
    add_box(d, "upper", vec(0.2, 0.1, 0.05), 0.004, vec(0.06, 0.03, 0.0748), "");
    scree_scene *scene = end_draft(d);
    go(scene, 40000);
    CHECK(moved(scene, 2000, &kinetic) < 1e-9);
    scree_body_state upper = state_of(scene, "upper");
    CHECK(2.0 * hypot(upper.orientation[1], upper.orientation[2]) < 2.0 * 9.81 / 1e5 / 0.05);
    scree_scene_destroy(scene);
}

/* A tower of twenty, and a wall of bricks in running bond: they stand as they were built. */
static void test_tower_and_wall(void) {
    double kinetic;
    struct draft *d = begin_draft(0.0, 2e-5, 1e6, sticks);
    add_floor(d);
    for (int k = 0; k < 20; k++) {
        char name[16];
        snprintf(name, sizeof name, "b%d", k);
        add_box(d, name, vec(0.1, 0.1, 0.1), 0.005, vec(0.0, 0.0, 0.05 + 0.1 * k), "");
    }
    scree_scene *scene = end_draft(d);
    go(scene, 50000);
    /* Of a side of 0.1 m, and of the tower's 20 x 1 kg x 9.81 m/s^2 x 1 m. */
    CHECK(moved(scene, 5000, &kinetic) < 1e-8);
    CHECK(kinetic < 1e-12 * 196.2);
    scree_scene_destroy(scene);

    d = begin_draft(0.0, 2e-5, 1e5, sticks);
    add_floor(d);
    for (int row = 0; row < 5; row++)
        for (int k = 0; k < 4 + row % 2; k++) { /* half bricks at the ends of every other row; joints of 2 mm */
            int half = row % 2 && (k == 0 || k == 4);
            double x = 0.202 * (k - 0.5 * (row % 2)) + (half ? k == 0 ? 0.0505 : -0.0505 : 0.0);
            char name[32];
            snprintf(name, sizeof name, "b%d.%d", row, k);
            add_box(d, name, vec(half ? 0.099 : 0.2, 0.1, 0.06), 0.003, vec(x, 0.0, 0.03 + 0.06 * row), "");
        }
    scene = end_draft(d);
    go(scene, 50000);
    CHECK(moved(scene, 5000, &kinetic) < 1e-8);
    CHECK(kinetic < 1e-12 * 20.0 * 1.2 * 9.81 * 0.3);
    scree_scene_destroy(scene);
}

/* ---- slopes ---- */

/* A box on a slope of another box, or across two rails, where edges alone bear it: it sticks just below the critical
 * angle and slides just above, as g (sin a - mu cos a). */
static void check_slope(double slope, int rails, int slides) {
    struct draft *d = begin_draft(slope, 2e-5, 1e6, sticks);
    double kinetic;
    if (rails) {
        add_box(d, "left", vec(2.0, 0.02, 0.1), 0.004, vec(0.5, -0.05, -0.05), "joint = \"fixed\"");
        add_box(d, "right", vec(2.0, 0.02, 0.1), 0.004, vec(0.5, 0.05, -0.05), "joint = \"fixed\"");
    } else {
        add_box(d, "slope", vec(2.0, 0.5, 0.1), 0.004, vec(0.5, 0.0, -0.05), "joint = \"fixed\"");
    }
    add_box(d, "block", vec(0.2, 0.2, 0.04), 0.004, vec(0.0, 0.0, 0.02), "");
    scree_scene *scene = end_draft(d);
    go(scene, 150000); /* the start pushes it off; it slows down by 5 mm/s^2 only */
    double before = state_of(scene, "block").position[0], v = state_of(scene, "block").velocity[0];
    double way = moved(scene, 25000, &kinetic), along = state_of(scene, "block").position[0] - before;
    if (slides)
        CLOSE((along - 0.5 * v) / 0.125, 9.81 * (sin(slope) - 0.5 * cos(slope)), 1e-6);
    else
        CHECK(way < 1e-13);
    scree_scene_destroy(scene);
}

static void test_slopes(void) {
    double critical = atan(0.5);
    for (int rails = 0; rails < 2; rails++) {
        check_slope(0.999 * critical, rails, 0);
        check_slope(1.001 * critical, rails, 1);
    }
}

/* A column on a slope tips where the slope leaves its foot, b/h, before it slides; 2 % below it stands, after
 * the rocking from a start on springs without load. */
static void test_tipping(void) {
    double tilt[2];
    for (int k = 0; k < 2; k++) {
        /* The foot ends where the corners' balls do; they sink and tilt it by some m g/(4 k) over 3 cm, 2e-5. */
        double slope = atan((k ? 1.005 : 0.98) * (0.06 - 2.0 * 0.002) / 0.2);
        struct draft *d = begin_draft(slope, 2e-5, 1e6, sticks);
        add_box(d, "slope", vec(2.0, 0.5, 0.1), 0.004, vec(0.5, 0.0, -0.05), "joint = \"fixed\"");
        add_box(d, "column", vec(0.06, 0.06, 0.2), 0.002, vec(0.0, 0.0, 0.1), "");
        scree_scene *scene = end_draft(d);
        go(scene, 100000);
        tilt[k] = 2.0 * fabs(state_of(scene, "column").orientation[2]);
        scree_scene_destroy(scene);
    }
    CHECK(tilt[0] < 1e-3 && tilt[1] > 1.0);
}

/* Two cards lean on each other, at an angle from the plumb line: moments about the foot ask for a friction of
 * (h sin - t cos)/2/(h cos + r), with the core's height h and thickness t and the rounding r. They stand with 1 % more
 * of it, and not with 2 % less. */
static double height_of_cards(double friction_share) {
    const double angle = 0.35, h = 0.2 - 2.0 * 0.003, t = 0.01 - 2.0 * 0.003, r = 0.003;
    double needed = 0.5 * (h * sin(angle) - t * cos(angle)) / (h * cos(angle) + r), mu = friction_share * needed;
    /* From the foot's ball, whose lowest point is on the floor, to the middle; the top's ball ends at x = 0. */
    double rise = r + 0.5 * (h * cos(angle) + t * sin(angle));
    double across = 0.5 * (h * sin(angle) + t * cos(angle)) + r;
    char friction[128], turn[2][96];
    snprintf(friction, sizeof friction,
             "law = \"coulomb\", static = %.17g, kinetic = %.17g, stiffness = 1e5, damping = 50", mu, mu);
    for (int k = 0; k < 2; k++)
        snprintf(turn[k], sizeof turn[k], "orientation = { axis = [0, 1, 0], angle = %.17g }", k ? -angle : angle);
    struct draft *d = begin_draft(0.0, 2e-5, 1e5, friction);
    add_floor(d);
    add_box(d, "left", vec(0.01, 0.1, 0.2), r, vec(-across, 0.0, rise), turn[0]);
    add_box(d, "right", vec(0.01, 0.1, 0.2), r, vec(across, 0.0, rise), turn[1]);
    scree_scene *scene = end_draft(d);
    go(scene, 75000);
    double height = state_of(scene, "left").position[2] / rise;
    scree_scene_destroy(scene);
    return height;
}

static void test_cards(void) {
    NEAR(height_of_cards(1.01), 1.0, 1e-3); /* less what the springs give */
    CHECK(height_of_cards(0.98) < 0.5);
}

/* ---- edge and corner on a plane ---- */

/* Against the solution for a spring whose attitude is followed (box_edge_impact_2d.csv); a box as deep as long has two
 * corners there. */
static void test_edge_impact(void) {
    struct check_table *table = check_read("box_edge_impact_2d.csv");
    int rows = 0;
    for (int row = 0; row < table->rows; row++) {
        double phi = check_number(table, row, "phi_deg"), k = check_number(table, row, "k");
        if (strcmp(check_text(table, row, "model"), "compliant") != 0 || k > 2e6) continue;
        if (check_number(table, row, "other_edge_min_height") < 0.0) continue;
        double time = check_number(table, row, "contact_time"), step = time / 2000.5;
        double low = 0.5 * (0.2 * sin(phi * acos(-1.0) / 180.0) + 0.1 * cos(phi * acos(-1.0) / 180.0));
        char text[2048];
        snprintf(text, sizeof text,
                 "[time]\nend = 1.0\nstep = %.17g\n[[material]]\nname = \"m\"\n[[contact]]\nbetween = [\"m\", \"m\"]\n"
                 "normal = { law = \"linear\", stiffness = %.17g, damping = 0.0 }\nshared_by = 2\n[[body]]\nname = "
                 "\"floor\"\nmaterial = \"m\"\nshape = { plane = true }\njoint = \"fixed\"\n[[body]]\nname = \"box\"\n"
                 "material = \"m\"\nmass = 1.0\nshape = { box = [0.2, 0.2, 0.1] }\nvelocity = [0, 0, -1]\n"
                 "position = [0, 0, %.17g]\norientation = { axis = [0, -1, 0], degrees = %.17g }\n",
                 step, k, low + step, phi);
        scree_scene *scene = scene_from(text, NULL, 0, 0);
        go(scene, 2010);
        scree_body_state box = state_of(scene, "box");
        /* Of second order: some (pi/2000)^2 of the speeds. */
        NEAR(box.velocity[2], check_number(table, row, "vy_after"), 5e-6);
        NEAR(-box.spin[1], check_number(table, row, "omega_after"), 5e-6 / 0.1);
        scree_scene_destroy(scene);
        rows++;
    }
    CHECK(rows >= 6);
    free(table);
}

/* In the limit of a stiff spring the rigid body's impulse (box_corner_impulse_3d.csv): the attitude turns by some 10
 * rad/s during the contact, so the error is some 10 rad/s x its time. */
static void test_corner_impact(void) {
    struct check_table *table = check_read("box_corner_impulse_3d.csv");
    int rows = 0;
    for (int row = 0; row < table->rows; row++) {
        if (check_number(table, row, "n_low") != 1.0) continue;
        double stiffness = 1e9, mass = check_number(table, row, "m_eff");
        double time = acos(-1.0) * sqrt(mass / stiffness), step = time / 200.0, degree = acos(-1.0) / 180.0;
        double rx = 0.5 * degree * check_number(table, row, "rx_deg");
        double ry = 0.5 * degree * check_number(table, row, "ry_deg");
        struct quat q =
            quat_multiply((struct quat){cos(rx), sin(rx), 0.0, 0.0}, (struct quat){cos(ry), 0.0, sin(ry), 0.0});
        char text[2048];
        snprintf(text, sizeof text,
                 "[time]\nend = 1.0\nstep = %.17g\n[[material]]\nname = \"m\"\n[[contact]]\nbetween = [\"m\", \"m\"]\n"
                 "normal = { law = \"linear\", stiffness = %.17g, damping = 0.0 }\n[[body]]\nname = \"floor\"\n"
                 "material = \"m\"\nshape = { plane = true }\njoint = \"fixed\"\n[[body]]\nname = \"box\"\n"
                 "material = \"m\"\nmass = 6.0\nshape = { box = [0.1, 0.2, 0.3] }\nvelocity = [0, 0, -1]\n"
                 "position = [0, 0, %.17g]\norientation = [%.17g, %.17g, %.17g, %.17g]\n",
                 step, stiffness, step - check_number(table, row, "r_z"), q.w, q.x, q.y, q.z);
        scree_scene *scene = scene_from(text, NULL, 0, 0);
        go(scene, 210);
        scree_body_state box = state_of(scene, "box");
        NEAR(box.velocity[2], check_number(table, row, "vz_after"), 20.0 * time);
        NEAR(box.spin[0], check_number(table, row, "wx"), 20.0 * time / 0.05);
        NEAR(box.spin[1], check_number(table, row, "wy"), 20.0 * time / 0.05);
        scree_scene_destroy(scene);
        rows++;
    }
    CHECK(rows >= 3);
    free(table);
}

/* Two crossed bars with adhesion, all but parallel, are pulled apart. Where their edges cross they hold on beyond the
 * touch, by some 5e-6 m, whether lists are made anew there or not. */
static void test_edges_hold_on(void) {
    static const char text[] =
        "gravity = [0, 0, 0]\n[time]\nend = 1\nstep = 2e-6\nintegrator = \"verlet\"\n"
        "[[material]]\nname = \"m\"\ndensity = 1000\n[[contact]]\nbetween = [\"m\", \"m\"]\n"
        "normal = { law = \"jkr\", modulus = 1e8, adhesion = 20.0 }\n"
        "[[body]]\nname = \"below\"\nshape = { box = [0.04, 0.01, 0.01], rounding = 0.001 }\nmaterial = \"m\"\n"
        "joint = \"fixed\"\norientation = { axis = [1, 0, 0], angle = 2e-5 }\n"
        "[[body]]\nname = \"above\"\nshape = { box = [0.01, 0.04, 0.01], rounding = 0.001 }\nmaterial = \"m\"\n"
        "position = [0, 0, 0.009995]\norientation = { axis = [0, 1, 0], angle = 2e-5 }\nvelocity = [0, 0, 0.1]\n";
    scree_scene *once = scene_from(text, NULL, 0, 1), *anew = scene_from(text, NULL, 0, 1);
    double at_touch = 0.0;
    for (int k = 0; k < 200; k++) {
        anew->contacts.broken = 1;
        go(once, 1);
        go(anew, 1);
        if (state_of(once, "above").position[2] < 0.01) at_touch = state_of(once, "above").velocity[2];
    }
    CHECK(state_of(once, "above").position[2] > 0.01001);
    CHECK(state_of(once, "above").velocity[2] < at_touch - 1e-3); /* it was slowed down beyond */
    CHECK(scree_scene_hash(once) == scree_scene_hash(anew));
    scree_scene_destroy(once);
    scree_scene_destroy(anew);
}

/* ---- forces as they are told ---- */

/* Of all contacts on a body. */
static struct vec force_on(scree_scene *scene, const char *name) {
    scree_contact_state contact[32];
    int count = 0, body = scree_scene_find_body(scene, name);
    struct vec sum = {0.0, 0.0, 0.0};
    CHECK(scree_scene_contacts(scene, contact, 32, &count) == SCREE_OK && count <= 32);
    for (int k = 0; k < count; k++)
        if (contact[k].ball == body || contact[k].host == body)
            sum = vec_axpy(sum, contact[k].ball == body ? 1.0 : -1.0, vec_from(contact[k].force));
    return sum;
}

/* And what they do to it within a step, as runs begin with and sleepers are held by; `turn`: about its centre. */
static struct vec kick_on(const scree_scene *scene, const char *name, struct vec *turn) {
    const struct scree_contacts *contacts = &scene->contacts;
    int body = scene->bodies.place[scree_scene_find_body(scene, name)];
    struct vec sum = {0.0, 0.0, 0.0};
    *turn = sum;
    for (int b = 0; b < contacts->batches; b++) {
        const struct scree_batch *batch = &contacts->batch[b];
        for (int k = scree_first(batch); k >= 0; k = scree_next(batch, k)) {
            struct scree_kick kick = scree_kick_now(contacts, &scene->bodies, b, k, scene->step);
            if (kick.ball != body && kick.host != body) continue;
            sum = vec_axpy(sum, kick.ball == body ? 1.0 : -1.0, kick.impulse);
            *turn = vec_add(*turn, kick.ball == body ? kick.turn_ball : kick.turn_host);
        }
    }
    return sum;
}

/* A box at rest on a slope, on another box and askew: edges bear it, with corners in reach, so that normal forces push
 * sideways, too. All together they bear its weight, whatever the rest is that motion still has (its decay: 20 times in
 * 1.5 ms). */
static void test_forces_at_rest(void) {
    static const char *const integrators[] = {"time.integrator=\"verlet\"", "time.integrator=\"pair-impulse\""};
    const double slope = 0.2;
    for (int n = 0; n < 4; n++) {
        double rounding = n / 2 ? 0.003 : 0.0;
        struct draft *d = begin_draft(slope, 4e-6, 1e5, sticks);
        add_box(d, "below", vec(0.04, 0.03, 0.02), rounding, vec(0.0, 0.0, 0.0), "joint = \"fixed\"");
        add_box(d, "above", vec(0.04, 0.03, 0.02), rounding, vec(0.004, 0.0, 0.02),
                "orientation = { axis = [0, 0, 1], angle = 0.05 }");
        scree_scene *scene = scene_from(d->text, &integrators[n % 2], 1, 0);
        free(d);
        go(scene, 50000);
        double weight = 9.81 * scree_scene_body_mass(scene, scree_scene_find_body(scene, "above"));
        struct vec borne = force_on(scene, "above");
        struct vec lacks = vec_add(borne, vec_scale(weight, vec(sin(slope), 0.0, -cos(slope))));
        CHECK(vec_norm(lacks) < 1e-9 * weight);
        struct vec turn, kick = kick_on(scene, "above", &turn);
        CHECK(vec_norm(vec_axpy(kick, -scene->step, borne)) < 1e-9 * weight * scene->step);
        CHECK(vec_norm(turn) < 1e-9 * weight * scene->step * 0.02);
        scree_scene_destroy(scene);
    }
}

/* A corner in a sharp box, with and without edges: at any time what is told is what the box is accelerated by. The
 * quotient of two steps errs by (omega h)^2/6 of the peak, 3e-5; by some omega h/4, 0.3 %, where contact begins or
 * ends, or another direction is the least deep. */
static void check_momentum(const char *integrator, const char *rule) {
    const double step = 5e-6, mass = 1000.0 * 0.04 * 0.03 * 0.02;
    char text[2048];
    snprintf(
        text, sizeof text,
        "[time]\nend = 1.0\nstep = %g\nintegrator = \"%s\"\n[[material]]\nname = \"m\"\ndensity = 1000\n"
        "[[contact]]\nbetween = [\"m\", \"m\"]\nnormal = { law = \"linear\", stiffness = 1e5, damping = 0 }\n%s"
        "[[body]]\nname = \"below\"\nshape = { box = [0.04, 0.03, 0.02] }\nmaterial = \"m\"\njoint = \"fixed\"\n"
        "[[body]]\nname = \"above\"\nshape = { box = [0.04, 0.03, 0.02] }\nmaterial = \"m\"\nvelocity = [0, 0, -1]\n"
        "position = [0.004, 0, 0.0225]\norientation = { axis = [0.1, 1, 0.3], angle = 0.1 }\n",
        step, integrator, rule);
    scree_scene *scene = scene_from(text, NULL, 0, 0);
    struct vec before = {0.0, 0.0, -1.0};
    double most = 0.0, worst = 0.0;
    for (int k = 0; k < 300; k++) {
        go(scene, 1);
        struct vec force = force_on(scene, "above");
        go(scene, 1);
        struct vec now = vec_from(state_of(scene, "above").velocity);
        struct vec acts = vec_scale(0.5 * mass / step, vec_sub(now, before));
        worst = scree_most(worst, vec_norm(vec_sub(force, acts)));
        most = scree_most(most, vec_norm(force));
        before = now;
    }
    CHECK(most > 1.0 && worst < 0.01 * most);
    scree_scene_destroy(scene);
}

static void test_forces_in_motion(void) {
    static const char *const integrators[] = {"verlet", "pair-impulse", "adaptive"};
    for (int n = 0; n < 3; n++) check_momentum(integrators[n], "corners = true\n");
    for (int n = 0; n < 2; n++) check_momentum(integrators[n], "");
}

/* Where boxes meet as rectangles do corners bear all: edges aren't told of, whatever rounding makes of their overlap.
 */
static void test_no_edges_of_rectangles(void) {
    struct draft *d = begin_draft(0.0, 4e-6, 1e5, sticks);
    add_box(d, "below", vec(0.04, 0.03, 0.02), 0.001, vec(0.0, 0.0, 0.0), "joint = \"fixed\"");
    add_box(d, "above", vec(0.04, 0.03, 0.02), 0.001, vec(0.004, 0.0, 0.0225),
            "orientation = { axis = [0, 1, 0], angle = 0.1 }\nvelocity = [0, 0, -0.5]");
    scree_scene *scene = end_draft(d);
    int corners = 0, edges = 0;
    for (int look = 0; look < 500; look++) {
        scree_contact_state contact[32];
        int count = 0;
        go(scene, 1);
        CHECK(scree_scene_contacts(scene, contact, 32, &count) == SCREE_OK && count <= 32);
        for (int k = 0; k < count; k++) {
            corners += contact[k].corner < 8;
            edges += contact[k].corner >= 8;
        }
    }
    CHECK(corners > 50 && edges == 0);
    scree_scene_destroy(scene);
}

int main(void) {
    test_collider();
    test_gradient();
    test_foresight();
    test_lists_leave_no_trace();
    test_crossed_faces();
    test_corners_only();
    test_offset_bricks();
    test_tower_and_wall();
    test_slopes();
    test_tipping();
    test_cards();
    test_edge_impact();
    test_corner_impact();
    test_edges_hold_on();
    test_forces_at_rest();
    test_forces_in_motion();
    test_no_edges_of_rectangles();
    return check_report();
}
