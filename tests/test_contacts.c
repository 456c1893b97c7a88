/* contact/: geometry against slow searches, lists against all pairs, the loop against its laws one by one. */
#include "contact/meet.h"
#include "tests/scenes.h"

static struct vec random_vec(uint64_t *seed, double size) {
    double x[3];
    check_draw(seed, -size, size, 3, x);
    return vec_from(x);
}

static struct quat random_attitude(uint64_t *seed) {
    double q[4];
    check_draw(seed, -1.0, 1.0, 4, q);
    return quat_normalise((struct quat){q[0], q[1], q[2], q[3]});
}

/* ---- geometry ---- */

/* Distance from a point to a box by cutting its faces into small squares: the slow way. */
static double slow_distance(struct vec p, struct vec origin, const struct mat *frame, const double half[3]) {
    enum { CELLS = 60 };
    double nearest = HUGE_VAL;
    for (int face = 0; face < 6; face++)
        for (int i = 0; i <= CELLS; i++)
            for (int j = 0; j <= CELLS; j++) {
                double c[3];
                int a = face / 2;
                c[a] = face % 2 ? half[a] : -half[a];
                c[(a + 1) % 3] = half[(a + 1) % 3] * (2.0 * i / CELLS - 1.0);
                c[(a + 2) % 3] = half[(a + 2) % 3] * (2.0 * j / CELLS - 1.0);
                struct vec on = vec_add(origin, mat_apply(frame, vec_from(c)));
                nearest = scree_least(nearest, vec_norm(vec_sub(p, on)));
            }
    return nearest;
}

static void test_ball_on_box(void) {
    uint64_t seed = 3;
    const double half[3] = {0.3, 0.2, 0.1}, radius = 0.05, rounding = 0.02;
    const double cell = 0.6 / 60; /* the search is right to half a cell's diagonal */
    for (int k = 0; k < 300; k++) {
        struct mat frame = quat_to_mat(random_attitude(&seed));
        struct vec origin = random_vec(&seed, 1.0), p = vec_add(origin, random_vec(&seed, 0.6));
        struct scree_whole sphere = {p, NULL};
        struct scree_meeting m = scree_meet_box(p, radius, sphere, origin, &frame, half, rounding);
        struct vec local = mat_undo(&frame, vec_sub(p, origin));
        int inside = fabs(local.x) < half[0] && fabs(local.y) < half[1] && fabs(local.z) < half[2];
        double slow = slow_distance(p, origin, &frame, half), distance = radius + rounding - m.overlap;
        NEAR(vec_norm(m.normal), 1.0, 1e-14);
        if (inside) distance = -distance;
        CHECK(distance <= slow + 1e-14 && slow * slow <= distance * distance + cell * cell);
        /* Moving the ball along the normal opens the contact by as much: the normal points away from the box. */
        sphere.centre = vec_axpy(p, 1e-6, m.normal);
        struct scree_meeting away = scree_meet_box(sphere.centre, radius, sphere, origin, &frame, half, rounding);
        NEAR(m.overlap - away.overlap, 1e-6, 1e-11);
    }
}

static void test_flat_partners(void) {
    uint64_t seed = 4;
    for (int k = 0; k < 300; k++) {
        struct mat frame = quat_to_mat(random_attitude(&seed));
        struct vec origin = random_vec(&seed, 1.0);
        struct vec local = random_vec(&seed, 0.5);
        struct vec p = vec_add(origin, mat_apply(&frame, local));
        const double half[3] = {0.3, 0.2, 0.0};
        NEAR(scree_meet_plane(p, 0.05, origin, &frame).overlap, 0.05 - local.z, 1e-14);
        /* A sphere meets the nearest point of the plate, from either side. */
        struct scree_meeting m =
            scree_meet_rectangle(p, 0.05, (struct scree_whole){p, NULL}, origin, &frame, half, 0.3);
        struct vec nearest = vec(fmin(fmax(local.x, -0.3), 0.3), fmin(fmax(local.y, -0.2), 0.2), 0.0);
        double distance = vec_norm(vec_sub(local, nearest));
        NEAR(m.overlap, 0.05 - distance, 1e-14);
        struct vec towards = vec_add(origin, mat_apply(&frame, nearest));
        NEAR(vec_norm(vec_sub(vec_axpy(p, -distance, m.normal), towards)), 0.0, 1e-14);
        struct scree_meeting b = scree_meet_ball(p, 0.05, origin, 0.1);
        NEAR(b.overlap, 0.15 - vec_norm(local), 1e-14);
        NEAR(vec_dot(b.normal, vec_sub(p, origin)), vec_norm(local), 1e-14);
    }
}

/* A corner is on the side of its box, in a plate and in a box. */
static void test_corners(void) {
    struct mat frame = quat_to_mat((struct quat){1.0, 0.0, 0.0, 0.0});
    struct scree_attitude box = {.frame = frame, .half = {0.05, 0.05, 0.05}};
    struct scree_whole above = {vec(0.01, 0.0, 0.0499), &box}, below = {vec(0.01, 0.0, -0.0499), &box};
    const double plate[3] = {0.03, 0.03, 0.0};
    struct vec zero = vec(0.0, 0.0, 0.0), corner = vec(0.01, 0.01, -1e-4), mirrored = vec(0.01, 0.01, 1e-4);
    NEAR(scree_meet_rectangle(corner, 0.0, above, zero, &frame, plate, 0.05).overlap, 1e-4, 1e-18);
    /* From beneath, with a rounding of 1 mm, 0.1 mm deep; and a corner still above while its body has tipped below. */
    struct vec beneath = vec(0.01, 0.01, -9e-4);
    NEAR(scree_meet_rectangle(beneath, 1e-3, below, zero, &frame, plate, 0.05).normal.z, -1.0, 0.0);
    NEAR(scree_meet_rectangle(beneath, 1e-3, below, zero, &frame, plate, 0.05).overlap, 1e-4, 1e-18);
    NEAR(scree_meet_rectangle(mirrored, 0.0, below, zero, &frame, plate, 0.05).overlap, -1e-4, 1e-18);
    CHECK(scree_meet_rectangle(corner, 0.0, above, zero, &frame, plate, 5e-5).overlap == SCREE_OUTSIDE);
    /* Beyond the border and below the side of its box: a wall. */
    struct scree_meeting wall = scree_meet_rectangle(vec(0.0305, 0.0, -1e-3), 1e-3, above, zero, &frame, plate, 0.05);
    NEAR(wall.overlap, 5e-4, 1e-17);
    CHECK(wall.normal.x == 1.0);
    /* Equal cubes, one above the other: the corner is in an edge of the lower one, and yet came from above. */
    const double cube[3] = {0.05, 0.05, 0.05};
    struct scree_whole upper = {vec(0.0, 0.0, 0.0999), &box};
    struct scree_meeting m = scree_meet_box(vec(0.05, 0.05, 0.0499), 0.0, upper, zero, &frame, cube, 0.0);
    CHECK(m.normal.z == 1.0);
    NEAR(m.overlap, 1e-4, 1e-16);
}

/* Depth of two boxes against a search: the shortest way that takes them apart, tried in many directions. */
static void test_boxes_depth(void) {
    uint64_t seed = 9;
    int apart_by_corners = 0;
    for (int k = 0; k < 400; k++) {
        double roundings = k % 2 ? 0.3 : 0.0;
        struct scree_attitude a = {.frame = quat_to_mat(random_attitude(&seed)), .half = {0.3, 0.2, 0.1}};
        struct scree_attitude b = {.frame = quat_to_mat(random_attitude(&seed)), .half = {0.1, 0.15, 0.25}};
        struct vec apart = random_vec(&seed, roundings > 0.0 ? 0.8 : 0.4);
        double depth = scree_boxes_depth(apart, &a, &b, roundings), least = HUGE_VAL;
        for (int trial = 0; trial < 20000; trial++) {
            struct vec from = random_vec(&seed, 1.0), n = vec_sub(from, random_vec(&seed, 1.0));
            n = vec_scale(1.0 / vec_norm(n), n);
            least = scree_least(least,
                                scree_box_reach(n, &a) + scree_box_reach(n, &b) + roundings - fabs(vec_dot(n, apart)));
        }
        apart_by_corners += roundings > 0.0 && depth > 0.0 && depth < roundings;
        /* Nearest of 20000 directions: within some 2 degrees, 1e-2 of boxes' 0.7 m across. */
        CHECK(depth <= fmax(least, 0.0) + 1e-14 && depth >= least - 0.015);
    }
    CHECK(apart_by_corners > 50);
}

/* ---- a crowd: spheres and boxes thrown into a room ---- */

/* Bricks pass through each other, to try that too. */
#define BETWEEN_STUFF(what)                                                                                            \
    "[[contact]]\nbetween = [\"stuff\", \"" what "\"]\n"                                                               \
    "normal = { law = \"linear-cut\", stiffness = 2e4, restitution = 0.6 }\n"                                          \
    "friction = { law = \"coulomb\", static = 0.5, kinetic = 0.4, stiffness = 1.5e4, damping = 0.5 }\n"
#define ON_WALL(what)                                                                                                  \
    "[[contact]]\nbetween = [\"" what "\", \"wall\"]\n"                                                                \
    "normal = { law = \"linear-loading\", stiffness = 2e4, restitution = 0.5 }\n"                                      \
    "friction = { law = \"stick-slip\", static = 0.5, kinetic = 0.4, threshold = 0.05 }\n"
static const char crowd_head[] =
    "gravity = [0, 0, -9.81]\n"
    "[time]\nintegrator = \"verlet\"\nend = 1.0\nstep = 2e-5\n"
    "[[material]]\nname = \"stuff\"\ndensity = 2000\n"
    "[[material]]\nname = \"brick\"\ndensity = 2000\n"
    "[[material]]\nname = \"wall\"\n" BETWEEN_STUFF("stuff") BETWEEN_STUFF("brick") ON_WALL("stuff") ON_WALL(
        "brick") "[[contact]]\nbetween = [\"brick\", \"brick\"]\nnone = true\n"
                 "[[body]]\nname = \"floor\"\nshape = { plane = true }\nmaterial = \"wall\"\njoint = \"fixed\"\n"
                 "[[body]]\nname = \"west\"\nshape = { plane = true }\nmaterial = \"wall\"\njoint = "
                 "\"fixed\"\nposition = [-0.08, "
                 "0, 0]\n"
                 "orientation = { axis = [0, 1, 0], degrees = 90 }\n"
                 "[[body]]\nname = \"east\"\nshape = { plane = true }\nmaterial = \"wall\"\njoint = "
                 "\"fixed\"\nposition = [0.08, 0, "
                 "0]\n"
                 "orientation = { axis = [0, 1, 0], degrees = -90 }\n"
                 "[[body]]\nname = \"south\"\nshape = { plane = true }\nmaterial = \"wall\"\njoint = "
                 "\"fixed\"\nposition = [0, "
                 "-0.08, 0]\n"
                 "orientation = { axis = [1, 0, 0], degrees = -90 }\n"
                 "[[body]]\nname = \"north\"\nshape = { plane = true }\nmaterial = \"wall\"\njoint = "
                 "\"fixed\"\nposition = [0, "
                 "0.08, 0]\n"
                 "orientation = { axis = [1, 0, 0], degrees = 90 }\n"
                 "[[body]]\nname = \"shelf\"\nshape = { rectangle = [0.05, 0.05] }\nmaterial = \"wall\"\njoint = "
                 "\"fixed\"\nposition = [0, 0, 0.001]\n";

/* The text of a crowd of `count` bodies on a loose grid; to be freed. */
static char *crowd_text(int count) {
    size_t size = sizeof crowd_head + (size_t)count * 320;
    char *text = malloc(size);
    int used = snprintf(text, size, "%s", crowd_head);
    uint64_t seed = 11;
    for (int k = 0; k < count; k++) {
        double x = -0.054 + 0.036 * (k % 4), y = -0.054 + 0.036 * (k / 4 % 4), z = 0.06 + 0.036 * (k / 16);
        double radius = check_between(&seed, 0.006, 0.012), off[2], speed[2];
        check_draw(&seed, -0.004, 0.004, 2, off);
        check_draw(&seed, -0.5, 0.5, 2, speed);
        used += snprintf(text + used, size - (size_t)used, "[[body]]\nname = \"b%d\"\nmaterial = \"%s\"\n", k,
                         k % 5 ? "stuff" : "brick");
        used += k % 8 == 0
                    ? snprintf(text + used, size - (size_t)used,
                               "shape = { box = [%.17g, %.17g, %.17g], rounding = 0.002 }\nspin = [1.0, 2.0, %d]\n",
                               1.2 * radius, 1.6 * radius, 2.0 * radius, k % 7)
                    : snprintf(text + used, size - (size_t)used, "shape = { sphere = %.17g }\n", radius);
        used += snprintf(text + used, size - (size_t)used,
                         "position = [%.17g, %.17g, %.17g]\nvelocity = [%.17g, %.17g, -1.0]\n", x + off[0], y + off[1],
                         z, speed[0], speed[1]);
    }
    return text;
}

/* Touching edges of two boxes, of all that there are. */
static int count_edges(const struct scree_bodies *bodies, int i, int j) {
    struct scree_two_boxes boxes = scree_two_boxes_of(bodies, i, j);
    int touching = 0;
    scree_draw_in(&boxes);
    for (int e = 0; e < SCREE_EDGES * SCREE_EDGES; e++)
        touching += scree_meet_edges(&boxes, e / SCREE_EDGES, e % SCREE_EDGES).meeting.overlap > 0.0;
    return touching;
}

/* Touching contacts found by looking at every ball and every partner. */
static int count_by_brute_force(const struct scree_bodies *bodies, const struct scree_contacts *contacts) {
    int touching = 0;
    for (int i = 0; i < bodies->count; i++)
        for (int j = 0; j < bodies->count; j++) {
            if (i == j || !scree_contacts_rule(contacts, bodies, i, j, NULL)) continue;
            scree_shape_kind ball = scree_kind_of(bodies, i)->shape.kind, host = scree_kind_of(bodies, j)->shape.kind;
            if (ball != SCREE_SPHERE && ball != SCREE_BOX) continue;
            if (ball == SCREE_SPHERE && host == SCREE_SPHERE && i > j) continue;
            if (ball == SCREE_BOX && host == SCREE_SPHERE) continue; /* there the sphere is the ball */
            if (ball == SCREE_BOX && host == SCREE_BOX && i < j) touching += count_edges(bodies, i, j);
            for (int c = 0; c < (ball == SCREE_BOX ? 8 : 1); c++) {
                const double *corner =
                    bodies->corner[ball == SCREE_BOX ? 1 + 8 * scree_kind_of(bodies, i)->slot + c : 0];
                struct vec p = vec_add(vec_from(bodies->record[i].x), vec_from(corner)),
                           origin = vec_from(bodies->record[j].x);
                double radius = bodies->record[i].radius, other = bodies->record[j].radius;
                struct scree_meeting m = scree_meet_ball(p, radius, origin, other);
                struct scree_whole whole = {vec_from(bodies->record[i].x),
                                            ball == SCREE_BOX ? scree_attitude_of(bodies, i) : NULL};
                if (host != SCREE_SPHERE) {
                    const struct scree_attitude *a = scree_attitude_of(bodies, j);
                    m = host == SCREE_PLANE ? scree_meet_plane(p, radius, origin, &a->frame)
                        : host == SCREE_RECTANGLE
                            ? scree_meet_rectangle(p, radius, whole, origin, &a->frame, a->half,
                                                   scree_thickness(bodies, i, whole.box != NULL, radius))
                            : scree_meet_box(p, radius, whole, origin, &a->frame, a->half, other);
                }
                if (ball == SCREE_BOX && host == SCREE_BOX) {
                    struct scree_two_boxes boxes = scree_two_boxes_of(bodies, i, j);
                    scree_draw_in(&boxes);
                    m = scree_meet_corner(&boxes, c).meeting;
                }
                touching += m.overlap > 0.0;
            }
        }
    return touching;
}

/* Candidate pairs of scattered bodies of sizes up to 1000:1, a few of which may go far, against all pairs: none missed,
 * none twice. `height`: over their spread sideways. */
static void check_candidates(double ratio, double spread, double height, int count, int periodic) {
    size_t size = 4096 + (size_t)count * 200;
    char *text = malloc(size);
    int used =
        snprintf(text, size,
                 "[time]\nintegrator = \"verlet\"\nend = 1.0\nstep = 1e-5\nforce = true\n[[material]]\nname = "
                 "\"m\"\ndensity = 1000\n"
                 "[[contact]]\nbetween = [\"m\", \"m\"]\nnormal = { law = \"linear\", stiffness = 1.0, damping = 0 }\n"
                 "[[body]]\nname = \"floor\"\nmaterial = \"m\"\nshape = { plane = true }\njoint = \"fixed\"\n"
                 "position = [0, 0, -1e6]\n");
    if (periodic)
        used += snprintf(text + used, size - (size_t)used,
                         "[domain]\nmin = [-1, %.17g, -1e9]\nmax = [1e9, %.17g, 1e9]\nperiodic = [\"y\"]\n", -spread,
                         spread);
    uint64_t seed = 17;
    for (int k = 0; k < count; k++) {
        double radius = 1e-3 * pow(ratio, pow(check_random(&seed), 3.0)), at[2];
        check_draw(&seed, -spread, spread, 2, at);
        used += snprintf(text + used, size - (size_t)used,
                         "[[body]]\nname = \"b%d\"\nmaterial = \"m\"\nshape = { sphere = %.17g }\n"
                         "position = [%.17g, %.17g, %.17g]\n",
                         k, radius, 1e3 * k, at[0], height * at[1]);
    }
    scree_scene *scene = scene_from(text, NULL, 0, 0);
    struct scree_contacts *contacts = &scene->contacts;
    struct scree_bodies *bodies = &scene->bodies;
    for (int k = 1; k <= count; k++) /* placed without overlaps; now as thick as it comes */
        bodies->record[k].x[0] = check_between(&seed, -spread, spread);
    contacts->widest_margin = 0.5 * contacts->skin;
    for (int k = 1; k <= count; k++) {
        double more = k % 16 == 0 ? check_between(&seed, 0.0, fmin(spread, 30.0 * contacts->skin)) : 0.0;
        bodies->path[k] = -more;
        contacts->widest_margin = fmax(contacts->widest_margin, 0.5 * contacts->skin + more);
    }
    CHECK(scree_candidates(contacts, bodies, 1, NULL) == SCREE_OK);
    int found = 0, wrong = 0;
    for (int i = 0; i <= count; i++)
        for (int j = i + 1; j <= count; j++) {
            const struct scree_record *a = &bodies->record[i], *b = &bodies->record[j];
            double far = distance_between(bodies, a->x, b->x);
            double left = contacts->skin - (bodies->path[i] + bodies->path[j]);
            if (i == 0 || far > a->bound + b->bound + left) continue; /* the floor is far below */
            wrong += found >= contacts->end[i] || contacts->partner[found] != j;
            found++;
        }
    CHECK(wrong == 0 && found == contacts->pairs && found == contacts->end[count]);
    scree_scene_destroy(scene);
    free(text);
}

static void test_candidates(void) {
    check_candidates(1.0, 0.02, 1.0, 400, 0);
    check_candidates(1.0, 0.02, 1.0, 400, 1);
    check_candidates(3.0, 0.02, 1.0, 400, 1);
    check_candidates(100.0, 0.2, 1.0, 400, 0);
    check_candidates(1000.0, 1.0, 1.0, 400, 0);
    check_candidates(10.0, 1e-5, 1.0, 60, 0);     /* all in one cell */
    check_candidates(3.0, 0.002, 1000.0, 400, 0); /* higher than the table of places, so that cells share these */
}

/* Rods that spin and fall among small grains at rest, and a paddle that is driven among them, faster than these ever
 * are: lists don't miss what they meet, and serve for dozens of steps, not only until a tip has gone a tenth of a
 * grain. */
static void test_fast_among_grains(void) {
    enum { STEPS = 1500, RODS = 6 };
    char text[4096];
    int used =
        snprintf(text, sizeof text,
                 "gravity = [0, 0, -9.81]\n[time]\nintegrator = \"verlet\"\nend = 1.0\nstep = 8e-6\n"
                 "[[material]]\nname = \"a\"\ndensity = 2000\n[[contact]]\nbetween = [\"a\", \"a\"]\n"
                 "normal = { law = \"linear-cut\", stiffness = 2000, restitution = 0.5 }\n"
                 "[[body]]\nname = \"floor\"\nmaterial = \"a\"\nshape = { plane = true }\njoint = \"fixed\"\n"
                 "[[generate]]\nname = \"g\"\nkind = \"lattice\"\nmaterial = \"a\"\nradius = 0.001\n"
                 "min = [-0.03, -0.03, 0]\nmax = [0.03, 0.03, 0.0022]\nspacing = 0.0021\n"
                 "[[motion]]\nname = \"stir\"\nkind = \"velocity\"\nvelocity = 60\n"
                 "[[motion]]\nname = \"sink\"\nkind = \"velocity\"\nvelocity = -1\n"
                 "[[body]]\nname = \"paddle\"\nmaterial = \"a\"\nshape = { rectangle = [0.02, 0.01] }\n"
                 "position = [0, 0.029, 0.018]\norientation = { axis = [0, 1, 0], degrees = 60 }\n"
                 "joint = { z = \"sink\", turn = { axis = [0, 1, 0], motion = \"stir\" }, others = \"fixed\" }\n");
    for (int k = 0; k < RODS; k++)
        used += snprintf(text + used, sizeof text - (size_t)used,
                         "[[body]]\nname = \"rod%d\"\nmaterial = \"a\"\nshape = { box = [0.02, 0.003, 0.003], rounding "
                         "= 0.0006 }\nposition = [0, %g, 0.014]\nvelocity = [0, 0, -1]\nspin = [3, 20, %d]\n",
                         k, 0.01 * k - 0.025, k);
    scree_scene *scene = scene_from(text, NULL, 0, 0);
    long before = scene->contacts.rebuilds;
    int most = 0;
    for (int k = 0; k < STEPS / 50; k++) {
        go(scene, 50);
        int listed = 0;
        CHECK(scree_scene_contacts(scene, NULL, 0, &listed) == SCREE_OK);
        CHECK(listed == count_by_brute_force(&scene->shadow, &scene->contacts));
        most = listed > most ? listed : most;
    }
    if (getenv("SCREE_SHOW")) printf("rods: %ld lists, %d contacts\n", scene->contacts.rebuilds - before, most);
    CHECK(scene->contacts.rebuilds - before < STEPS / 30);
    scree_scene_destroy(scene);
}

static void test_lists(void) {
    char *text = crowd_text(48);
    scree_scene *scene = scene_from(text, NULL, 0, 0);
    int most = 0;
    for (int k = 0; k < 1000; k++) {
        go(scene, 20);
        int listed = 0;
        CHECK(scree_scene_contacts(scene, NULL, 0, &listed) == SCREE_OK);
        CHECK(listed == count_by_brute_force(&scene->shadow, &scene->contacts));
        most = listed > most ? listed : most;
    }
    CHECK(most > 30); /* it did become a crowd */
    CHECK(scene->contacts.rebuilds > 5);
    scree_scene_destroy(scene);

    /* The result doesn't depend on when lists are made, nor on what they hold besides touching contacts. */
    static const double skins[] = {0.002, 0.004, 0.01, 0.05};
    uint64_t hash[4];
    for (int s = 0; s < 4; s++) {
        scene = scene_from(text, NULL, 0, 0);
        scene->contacts.skin = skins[s];
        CHECK(scree_contacts_list(&scene->contacts, &scene->bodies, 1, NULL) == SCREE_OK);
        go(scene, 6000);
        hash[s] = scree_scene_hash(scene);
        scree_scene_destroy(scene);
    }
    CHECK(hash[0] == hash[1] && hash[1] == hash[2] && hash[2] == hash[3]);
    free(text);
}

/* Touching balls of a scene that has nothing else, at the instant of its shadow. */
static int count_touching_balls(const struct scree_bodies *bodies) {
    int touching = 0;
    for (int i = 0; i < bodies->count; i++)
        for (int j = i + 1; j < bodies->count; j++) {
            const struct scree_record *a = &bodies->record[i], *b = &bodies->record[j];
            double reach = a->radius + b->radius;
            touching += vec_norm2(vec_sub(vec_from(a->x), vec_from(b->x))) < reach * reach;
        }
    return touching;
}

/* Contacts of a stretch with the first slab of the next one whose later body isn't lent to it. */
static int count_not_lent(const scree_scene *scene) {
    const struct scree_batch *batch = scene->contacts.batch;
    int count = 0;
    for (int slab = SCREE_STRETCH; slab < scene->bodies.order.slabs; slab += SCREE_STRETCH)
        for (int k = batch->segment[slab].first; k < batch->segment[slab].first + batch->segment[slab].count; k++) {
            struct scree_contact contact = scree_contact_at(batch, k);
            int later = contact.ball > contact.host ? contact.ball : contact.host;
            count += later >= scene->bodies.order.start[slab] && !scene->contacts.lent[later];
        }
    return count;
}

/* As every 512th step does when bodies are out of order: contacts move to other places, and lists are made. */
static void put_in_order(scree_scene *scene) {
    CHECK(scree_contacts_sort(&scene->contacts, &scene->bodies, 1, NULL) == SCREE_OK);
}

/* A long lattice, so many that they lie in slabs, of which a few layers move: no contact is missed across slabs, and
 * lists made anew in every step give the same bits, what friction keeps included. */
static void test_lists_of_slabs(void) {
    enum { LONG = 64, WIDE = 8, COUNT = LONG * WIDE * WIDE };
    size_t size = 1024 + (size_t)COUNT * 200;
    char *text = malloc(size);
    int used = snprintf(text, size,
                        "[time]\nintegrator = \"verlet\"\nend = 1.0\nstep = 1e-5\n[[material]]\nname = \"m\"\ndensity "
                        "= 1000\n[[contact]]\nbetween = [\"m\", \"m\"]\n"
                        "normal = { law = \"linear\", stiffness = 1e3, damping = 0 }\n"
                        "friction = { law = \"coulomb\", static = 0.5, kinetic = 0.4, stiffness = 4e2 }\n");
    uint64_t seed = 23;
    for (int k = 0; k < COUNT; k++) {
        int layer = k / (WIDE * WIDE), moves = layer >= 30 && layer < 33;
        double v[3];
        for (int axis = 0; axis < 3; axis++) v[axis] = moves ? check_between(&seed, -1.0, 1.0) : 0.0;
        used += snprintf(text + used, size - (size_t)used,
                         "[[body]]\nname = \"b%d\"\nmaterial = \"m\"\nshape = { sphere = 1e-3 }\n"
                         "position = [%.6f, %.6f, %.6f]\nvelocity = [%.17g, %.17g, %.17g]\n",
                         k, 2.15e-3 * layer, 2.15e-3 * (k / WIDE % WIDE), 2.15e-3 * (k % WIDE), v[0], v[1], v[2]);
    }
    scree_scene *scene = scene_from(text, NULL, 0, 0);
    CHECK(scene->bodies.order.slabs > 8);
    int most = 0;
    for (int k = 0; k < 120; k++) {
        int listed = 0;
        if (k % 8 == 0) put_in_order(scene);
        go(scene, 2);
        CHECK(count_not_lent(scene) == 0);
        go(scene, 3);
        CHECK(count_not_lent(scene) == 0);
        CHECK(scree_scene_contacts(scene, NULL, 0, &listed) == SCREE_OK);
        CHECK(listed == count_touching_balls(&scene->shadow));
        most = listed > most ? listed : most;
    }
    CHECK(most > 30 && scene->contacts.renewals > 3 && scene->contacts.answers > 3);
    uint64_t hash = scree_scene_hash(scene);
    scree_scene_destroy(scene);
    scene = scene_from(text, NULL, 0, 0);
    for (int k = 0; k < 600; k++) { /* both lists in every step */
        if (k % 40 == 0) put_in_order(scene);
        CHECK(scree_contacts_list(&scene->contacts, &scene->bodies, 1, NULL) == SCREE_OK);
        go(scene, 1);
    }
    CHECK(scree_scene_hash(scene) == hash);
    scree_scene_destroy(scene);
    free(text);
}

/* ---- momentum ---- */

static const char two_text[] = "[time]\nintegrator = \"verlet\"\nend = 1.0\nstep = 1e-5\n"
                               "[[material]]\nname = \"stuff\"\ndensity = 2000\n"
                               "[[contact]]\nbetween = [\"stuff\", \"stuff\"]\n"
                               "normal = { law = \"linear-cut\", stiffness = 1e4, restitution = 0.6 }\n"
                               "friction = { law = \"coulomb\", static = 0.5, kinetic = 0.4, stiffness = 8e3 }\n"
                               "[[body]]\nname = \"a\"\nmaterial = \"stuff\"\nshape = { sphere = 0.01 }\nvelocity = "
                               "[1.0, 0.3, 0.1]\nspin = [10, -20, 30]\n"
                               "[[body]]\nname = \"b\"\nmaterial = \"stuff\"\nshape = { sphere = 0.013 }\nposition = "
                               "[0.025, 0.01, 0.002]\nspin = [50, 20, -10]\n";

/* Total momentum and angular momentum about the origin. */
static void momenta(const scree_scene *scene, struct vec *p, struct vec *l) {
    *p = *l = vec(0.0, 0.0, 0.0);
    for (int k = 0; k < scene->bodies.count; k++) {
        const struct scree_state *s = &scene->bodies.state[k];
        struct vec momentum = vec_scale(scree_kind_of(&scene->bodies, k)->inertia.mass, vec_from(s->v));
        *p = vec_add(*p, momentum);
        *l = vec_add(*l, vec_add(vec_from(s->l), vec_cross(vec_from(scene->bodies.position[k]), momentum)));
    }
}

/* An impact changes the momentum by rounding; by how much the angular momentum, over itself. */
static double lost_momentum(const char *const *changes, int count) {
    scree_scene *scene = scene_from(two_text, changes, count, 0);
    struct vec p, l, p_after, l_after;
    momenta(scene, &p, &l);
    double met = 0.0;
    for (int k = 0; k < 30; k++) {
        go(scene, lround(1e-3 / scree_scene_step_length(scene)));
        met = scree_most(met, scree_scene_deepest(scene, NULL, NULL));
    }
    momenta(scene, &p_after, &l_after);
    CHECK(met > 0.01);
    CHECK(vec_norm(vec_sub(p_after, p)) < 1e-13 * vec_norm(p));
    scree_scene_destroy(scene);
    return vec_norm(vec_sub(l_after, l)) / vec_norm(l);
}

/* Impulses are equal and opposite at one point: what remains is rounding, some 1e-16 of the largest terms a step. */
static void check_momenta(const char *const *changes, int count) { CHECK(lost_momentum(changes, count) < 1e-12); }

static void test_momentum(void) {
    static const char *const boxes[] = {"body.a.shape={box=[0.02,0.015,0.018], rounding=0.003}",
                                        "body.b.shape={box=[0.02,0.022,0.025], rounding=0.002}"};
    check_momenta(NULL, 0);
    check_momenta(boxes, 1); /* the sphere b on the box a */
    check_momenta(boxes, 2);
    /* Pair impulses act at one point too, but along a course that the bodies follow to second order only: 16 times less
     * at a quarter of the step, but for the phase of the touch. */
    const char *impulses[] = {"time.integrator=\"pair-impulse\"", "time.step=1e-5"};
    double coarse = lost_momentum(impulses, 2);
    impulses[1] = "time.step=2.5e-6";
    double fine = lost_momentum(impulses, 2);
    CHECK(coarse < 1e-6 && fine < coarse / 8.0);
}

/* ---- the loop against the laws, one contact at a time ---- */

/* Impulse of one contact from its law's scalar function; what laws remember is empty yet. */
static struct vec impulse_by_hand(const scree_scene *scene, const struct scree_rule *rule, int batch, int index,
                                  double h) {
    struct scree_touch touch;
    if (!scree_contacts_measure(&scene->contacts, &scene->bodies, batch, index, &touch)) return vec(0.0, 0.0, 0.0);
    struct vec force = vec_scale(touch.normal_force, touch.normal);
    if (rule->friction < 0) return vec_scale(h, force);
    const struct scree_friction_law *friction = scree_friction_laws[rule->friction];
    if (!friction->memory) return vec_scale(h, vec_add(force, touch.tangential));
    struct scree_sliding at = {.normal = fmax(touch.normal_force, 0.0), .overlap = touch.overlap, .half = 0.5 * h};
    at.closing = touch.closing;
    at.velocity = touch.slip;
    struct scree_pair_constants pair = {{0.0}};
    double mass = scree_effective_mass(&scene->bodies, touch.ball, touch.host) / rule->share;
    double radius = scree_effective_radius(&scene->bodies, touch.ball, touch.host, SCREE_BALL_BALL);
    if (friction->pair) pair = friction->pair(&rule->friction_constants, mass, radius);
    return vec_scale(h, vec_add(force, friction->force(&rule->friction_constants, pair, at).force));
}

/* Angular impulse of one contact of two spheres: of its impulse j, and of the rolling law's scalar function. */
static struct vec turn_by_hand(const scree_scene *scene, const struct scree_rule *rule, int batch, int index, double h,
                               struct vec j) {
    struct scree_touch touch;
    if (!scree_contacts_measure(&scene->contacts, &scene->bodies, batch, index, &touch)) return vec(0.0, 0.0, 0.0);
    const struct scree_record *ball = &scene->bodies.record[touch.ball], *host = &scene->bodies.record[touch.host];
    struct scree_meeting m = scree_meet_ball(vec_from(ball->x), ball->radius, vec_from(host->x), host->radius);
    int even = scree_goes_even(&scene->bodies, &scene->contacts.batch[batch], rule->rolling >= 0);
    double lever_of_ball = even ? 0.5 * (ball->radius + host->radius - m.overlap) : ball->radius - 0.5 * m.overlap;
    struct vec turn = vec_scale(-lever_of_ball, vec_cross(m.normal, j));
    if (rule->rolling < 0) return turn;
    const struct scree_rolling_law *law = scree_rolling_laws[rule->rolling];
    const struct scree_law_constants *constants = &rule->rolling_constants;
    double lever = scree_effective_radius(&scene->bodies, touch.ball, touch.host, SCREE_BALL_BALL);
    struct vec velocity =
        vec_scale(lever, vec_sub(scree_spin_of(&scene->bodies, touch.ball), scree_spin_of(&scene->bodies, touch.host)));
    double along = vec_dot(velocity, m.normal);
    struct scree_sliding at = {.normal = fmax(touch.normal_force, 0.0), .overlap = touch.overlap, .half = 0.5 * h};
    at.velocity = vec_axpy(velocity, -along, m.normal);
    struct scree_tangential rolls = law->resist(constants, constants->c[SCREE_ROLLING_COEFFICIENT], at);
    at.velocity = vec(along, 0.0, 0.0);
    struct scree_tangential twists = law->resist(constants, constants->c[SCREE_TWISTING_COEFFICIENT], at);
    struct vec torque = vec_scale(lever, vec_axpy(rolls.force, twists.force.x, m.normal));
    return vec_add(turn, vec_scale(h, torque));
}

/* Pairs of spheres, of one size or not, pressed into each other at random, in numbers that leave lanes of the last
 * block empty; some faster, some slower, so that friction laws take all their branches. */
static scree_scene *pressed_pairs(const char *normal, const char *friction, const char *rolling, int pairs, int even) {
    size_t size = 4096 + (size_t)pairs * 1024;
    char *text = malloc(size);
    int used = snprintf(text, size,
                        "[time]\nintegrator = \"verlet\"\nend = 1.0\nstep = 1e-5\nforce = true\n[[material]]\nname = "
                        "\"m\"\ndensity = 1000\n[[contact]]\n"
                        "between = [\"m\", \"m\"]\nnormal = { %s }\n%s%s%s%s%s%s",
                        normal, friction ? "friction = { " : "", friction ? friction : "", friction ? " }\n" : "",
                        rolling ? "rolling = { " : "", rolling ? rolling : "", rolling ? " }\n" : "");
    uint64_t seed = 21;
    for (int k = 0; k < 2 * pairs; k++) {
        double radius = even ? 0.01 : check_between(&seed, 0.008, 0.012), pace = pow(10.0, -(k / 2 % 5)), off[2],
               slow[2];
        check_draw(&seed, -1e-3, 1e-3, 2, off);
        double speed = check_between(&seed, -0.3, 0.3);
        check_draw(&seed, -0.01, 0.01, 2, slow);
        double spin = check_between(&seed, -9.0, 9.0);
        used += snprintf(
            text + used, size - (size_t)used,
            "[[body]]\nname = \"b%d\"\nmaterial = \"m\"\nshape = { sphere = %.17g }\nposition = [%.17g, %.17g, %.17g]\n"
            "velocity = [%.17g, %.17g, %.17g]\nspin = [%.17g, %.17g, %.17g]\n",
            k, radius, 0.1 * (k / 2) + 0.0185 * (k % 2), off[0], off[1], speed, slow[0] * pace, slow[1] * pace,
            spin * pace, 3.0 * pace, -7.0 * pace);
    }
    scree_scene *scene = scene_from(text, NULL, 0, 0);
    free(text);
    return scene;
}

/* `least`: so many of the pairs must press each other. */
static void check_pairs(const char *normal, const char *friction, const char *rolling, int pairs, int even, int least) {
    scree_scene *scene = pressed_pairs(normal, friction, rolling, pairs, even);
    double h = scree_scene_step_length(scene);
    const double none[3] = {0.0, 0.0, 0.0};
    for (int k = 0; k < scene->bodies.count; k++) { /* as if they had come here freely */
        memset(scene->bodies.record[k].impulse, 0, sizeof scene->bodies.record[k].impulse);
        memset(scene->bodies.record[k].turn, 0, sizeof scene->bodies.record[k].turn);
    }
    scree_bodies_look_ahead(&scene->bodies, scene->bodies.count, 0.0, h, none, 1.0);
    int compared = 0, bodies = scene->bodies.count;
    struct vec *impulse = calloc((size_t)bodies, sizeof *impulse), *turn = calloc((size_t)bodies, sizeof *turn);
    for (int b = 0; b < scene->contacts.batches; b++)
        for (int k = 0; k < scene->contacts.batch[b].count; k++) {
            const struct scree_rule *rule = &scene->contacts.rule[0];
            int ball = scene->contacts.batch[b].ends[k].ball;
            struct vec j = impulse_by_hand(scene, rule, b, k, h);
            impulse[ball] = vec_add(impulse[ball], j); /* to zero, as the loop does: the zero of a sum has no sign */
            if (friction || rolling) turn[ball] = vec_add(turn[ball], turn_by_hand(scene, rule, b, k, h, j));
            compared += vec_norm(impulse[ball]) > 0.0;
        }
    scree_contacts_act(&scene->contacts, &scene->bodies, h, 1, NULL);
    for (int k = 0; k < bodies; k += 2) { /* balls are the lower of each pair */
        CHECK(memcmp(scene->bodies.record[k].impulse, &impulse[k], sizeof impulse[k]) == 0);
        CHECK(memcmp(scene->bodies.record[k].turn, &turn[k], sizeof turn[k]) == 0);
    }
    CHECK(compared > least);
    free(impulse);
    free(turn);
    scree_scene_destroy(scene);
}

static void check_laws(const char *normal, const char *friction, const char *rolling, int pairs, int even) {
    check_pairs(normal, friction, rolling, pairs, even, pairs / 2);
}

/* The same after some steps, for laws that remember: force and memory of every contact, from the memory that it has. */
static void check_remembering(const char *normal, int steps) {
    scree_scene *scene = pressed_pairs(normal, NULL, NULL, 37, 0);
    scene->step = 1e-7; /* short against these contacts */
    go(scene, steps);
    struct scree_batch *batch = &scene->contacts.batch[scene->contacts.busy[0]];
    const struct scree_normal_law *law = scree_normal_laws[scene->contacts.rule[0].normal];
    const double none[3] = {0.0, 0.0, 0.0};
    double h = scene->step;
    struct scree_normal_force expected[64];
    struct vec impulse[64];
    int compared[64], touching = 0;
    scree_bodies_look_ahead(&scene->bodies, scene->bodies.count, scree_scene_time(scene), h, none, 1.0);
    int remembering = 0;
    for (int k = 0; k < batch->count; k++) {
        double first = scree_kept(batch, SCREE_KEPT_NORMAL, k), second = scree_kept(batch, SCREE_KEPT_NORMAL + 1, k);
        struct scree_touch touch = {0};
        int touches = scree_contacts_measure(&scene->contacts, &scene->bodies, 0, k, &touch);
        remembering += touches && (first != 0.0 || second != 0.0);
        struct scree_pair_constants pair;
        for (int c = 0; c < SCREE_PAIR_CONSTANTS; c++) pair.c[c] = scree_pair(batch, c, k);
        struct scree_pressing at = scree_pressed(touch.overlap, touch.closing, first, second);
        struct scree_normal_force f = law->force(&scene->contacts.rule[0].normal_constants, pair, at);
        /* Wholly in touch, or wholly out. */
        compared[k] = !touches || touch.overlap > h * fabs(touch.closing);
        expected[k] = f;
        if (!touches) expected[k].first = expected[k].second = 0.0;
        impulse[k] = touches ? vec_scale(h, vec_scale(touch.normal_force, touch.normal)) : vec(0.0, 0.0, 0.0);
        touching += touches;
    }
    scree_contacts_act(&scene->contacts, &scene->bodies, h, 1, NULL);
    for (int k = 0; k < batch->count; k++) {
        CHECK(scree_kept(batch, SCREE_KEPT_NORMAL, k) == expected[k].first);
        CHECK(scree_kept(batch, SCREE_KEPT_NORMAL + 1, k) == expected[k].second);
        const double *got = scene->bodies.record[batch->ends[k].ball].impulse;
        if (compared[k]) CHECK(got[0] == impulse[k].x && got[1] == impulse[k].y && got[2] == impulse[k].z);
    }
    CHECK(touching > 10 && remembering > touching / 3); /* those that parted from the start have no impact speed */
    scree_scene_destroy(scene);
}

/* Parameters of a law as its description gives them. */
static const char *example_of(const struct scree_law_text *text, char choice[480]) {
    if (!text->example) printf("the law \"%s\" has no example\n", text->name);
    CHECK(text->example != NULL);
    snprintf(choice, 480, "law = \"%s\", %s", text->name, text->example ? text->example : "");
    return choice;
}

static void check_pair_of_laws(const char *normal, const char *friction) {
    check_laws(normal, friction, NULL, 1, 0);
    check_laws(normal, friction, NULL, 37, 0);
    check_laws(normal, friction, NULL, 37, 1);
}

/* Every normal law with every friction law, every rolling law; and branches that the examples leave out. */
static void test_loop_equals_laws(void) {
    static const char linear[] = "law = \"linear\", stiffness = 1e4, restitution = 0.5";
    static const char *const normals[] = {
        "law = \"blend\", stiffness = 1e6, exponent = 1.37, damping = 2.0, full = 5e-4",
        "law = \"impact\", stiffness = 1e6, exponent = 1.5, damping = 2.0, full = 5e-4",
        "law = \"tsuji-cut\", stiffness = 1e6, alpha = 0.3",
        "law = \"kuwabara-kono-cut\", modulus = 1e7, restitution = 0.7, speed = 0.3",
        "law = \"gonthier\", stiffness = 1e6, restitution = 0.6, calibrated = 1"};
    static const char *const frictions[] = {
        "law = \"stribeck\", static = 0.4, kinetic = 0.3, stribeck_speed = 0.05, threshold = 0.02, exponent = 0.8",
        "law = \"coulomb\", static = 0.4, kinetic = 0.3, stiffness = 1e4, damping = 20",
        "law = \"mindlin\", static = 0.4, kinetic = 0.3, shear_modulus = 1e6, damping = 0.2",
        "law = \"elastoplastic\", static = 3, kinetic = 2, stribeck_speed = 0.02, stiffness = 1e3, elastic = 0.1"};
    char normal[480], friction[480];
    for (int n = 0; scree_normal_laws[n]; n++) {
        example_of(&scree_normal_laws[n]->text, normal);
        check_pair_of_laws(normal, NULL);
        for (int f = 0; scree_friction_laws[f]; f++)
            check_pair_of_laws(normal, example_of(&scree_friction_laws[f]->text, friction));
        if (!scree_normal_laws[n]->memory) continue;
        check_remembering(normal, 3);
        check_remembering(normal, 300);
    }
    for (int r = 0; scree_rolling_laws[r]; r++) {
        char rolling[480];
        example_of(&scree_rolling_laws[r]->text, rolling);
        check_laws(linear, NULL, rolling, 37, 0);
        check_laws(linear, frictions[1], rolling, 37, 1);
    }
    check_laws(linear, NULL, "law = \"constant\", rolling = 0.1", 37, 0);
    for (size_t n = 0; n < sizeof normals / sizeof normals[0]; n++) check_pair_of_laws(normals[n], frictions[0]);
    for (size_t f = 0; f < sizeof frictions / sizeof frictions[0]; f++) check_pair_of_laws(linear, frictions[f]);
}

static int takes_exponent(const struct scree_law_text *text) {
    for (const struct scree_parameter *p = text->parameters; p->name; p++)
        if (!strcmp(p->name, "exponent")) return 1;
    return 0;
}

/* The example with another exponent. */
static const char *example_to_power(const struct scree_law_text *text, double exponent, char choice[480]) {
    char *own = strstr(example_of(text, choice), ", exponent = ");
    if (own) {
        char *behind = strchr(own + 1, ',');
        memmove(own, behind ? behind : own + strlen(own), behind ? strlen(behind) + 1 : 1);
    }
    size_t used = strlen(choice);
    snprintf(choice + used, 480 - used, ", exponent = %g", exponent);
    return choice;
}

/* The loop knows some exponents beforehand, if the law says that it takes one: loop and law agree at these and others.
 */
static void test_exponents(void) {
    static const char linear[] = "law = \"linear\", stiffness = 1e4, restitution = 0.5";
    static const double exponents[] = {1.0, 1.5, 2.0, 1.37};
    char choice[480];
    int laws = 0;
    for (int n = 0; scree_normal_laws[n]; n++) {
        const struct scree_law_text *text = &scree_normal_laws[n]->text;
        CHECK(scree_normal_laws[n]->raises == takes_exponent(text));
        laws += takes_exponent(text);
        for (int k = 0; takes_exponent(text) && k < 4; k++) {
            scree_scene *scene = pressed_pairs(example_to_power(text, exponents[k], choice), NULL, NULL, 1, 0);
            CHECK(scene->contacts.rule[0].normal_constants.exponent.known == (k < 3));
            scree_scene_destroy(scene);
            /* A soft spring that is cut lets go of those that part, about a half. */
            check_pairs(choice, NULL, NULL, 37, 0, 37 / 3);
        }
    }
    for (int f = 0; scree_friction_laws[f]; f++) {
        const struct scree_law_text *text = &scree_friction_laws[f]->text;
        laws += takes_exponent(text);
        for (int k = 0; takes_exponent(text) && k < 4; k++)
            check_laws(linear, example_to_power(text, exponents[k], choice), NULL, 37, 0);
    }
    CHECK(laws >= 14);
    for (int k = 0; k < 3; k++)
        NEAR(scree_power(1.7, exponents[k], scree_exponent_of(exponents[k])), pow(1.7, exponents[k]), 1e-15);
}

int main(void) {
    test_ball_on_box();
    test_flat_partners();
    test_corners();
    test_boxes_depth();
    test_candidates();
    test_fast_among_grains();
    test_lists();
    test_lists_of_slabs();
    test_momentum();
    test_loop_equals_laws();
    test_exponents();
    return check_report();
}
