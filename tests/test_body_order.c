/* Scenes of many balls: their order in memory, near lists and slabs change nothing but the time. */
#include "contact/slabs.h"
#include "tests/allocations.h"
#include "tests/scenes.h"

#include <dirent.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>

/* ---- scenes ---- */

/* Balls without gravity or friction. */
#define BALLS_ALONE                                                                                                    \
    "gravity = [0, 0, 0]\n[time]\nintegrator = \"verlet\"\nend = 1\nstep = 2e-5\n"                                     \
    "[[material]]\nname = \"ball\"\ndensity = 2000\n[[contact]]\nbetween = [\"ball\", \"ball\"]\n"                     \
    "normal = { law = \"linear\", stiffness = 5e3, restitution = 0.3 }\n"

enum { COUNT = 1500 };

/* Balls of two sizes, or (`mixed`) of two materials too, that fly about in a closed box and rub, a frozen one now and
 * then, some boxes, one ball as large as a hundred, and a wall that shakes. */
static char *gas_text(double speed, int mixed) {
    char *text = malloc(COUNT * 300 + 8192);
    int used = sprintf(text, "%s",
                       "gravity = [0, 0, -9.81]\n[time]\nintegrator = \"verlet\"\nend = 1.0\nstep = 2e-5\n"
                       "[[material]]\nname = \"ball\"\ndensity = 2000\nyoung = 1e7\npoisson = 0.25\n"
                       "[[contact]]\nbetween = [\"ball\", \"ball\"]\n"
                       "normal = { law = \"linear\", stiffness = 2e4, restitution = 0.9 }\n"
                       "friction = { law = \"coulomb\", static = 0.5, kinetic = 0.4, stiffness = 1e4 }\n"
                       "rolling = { law = \"spring-dashpot\", rolling = 0.02, stiffness = 1e3 }\n"
                       "[[material]]\nname = \"block\"\ndensity = 2000\n"
                       "[[contact]]\nbetween = [\"ball\", \"block\"]\n"
                       "normal = { law = \"linear\", stiffness = 2e4, restitution = 0.9 }\n"
                       "[[contact]]\nbetween = [\"block\", \"block\"]\n"
                       "normal = { law = \"linear\", stiffness = 2e4, restitution = 0.9 }\n"
                       "[[motion]]\nname = \"shake\"\nkind = \"sine\"\namplitude = 2e-3\nfrequency = 30\n"
                       "[[body]]\nname = \"floor\"\nshape = { plane = true }\nmaterial = \"ball\"\njoint = { z = "
                       "\"shake\", others = \"fixed\" }\n");
    static const double from[5][2] = {{0.7071067811865476, 0.7071067811865476},
                                      {0.7071067811865476, -0.7071067811865476},
                                      {0.7071067811865476, -0.7071067811865476},
                                      {0.7071067811865476, 0.7071067811865476},
                                      {0.0, 1.0}};
    static const double at[5][3] = {
        {0.0, 0.0, 0.0}, {0.4, 0.0, 0.0}, {0.0, 0.0, 0.0}, {0.0, 0.18, 0.0}, {0.0, 0.0, 0.2}};
    for (int w = 0; w < 5; w++) {
        int about_y = w < 2;
        used += sprintf(
            text + used,
            "[[body]]\nname = \"wall %d\"\nshape = { plane = true }\nmaterial = \"ball\"\njoint = \"fixed\"\n"
            "position = [%g, %g, %g]\norientation = [%.17g, %.17g, %.17g, 0.0]\n",
            w, at[w][0], at[w][1], at[w][2], from[w][0], about_y ? 0.0 : from[w][1], about_y ? from[w][1] : 0.0);
    }
    uint64_t seed = 11;
    for (int k = 0; k < COUNT; k++) {
        int x = k % 31, y = k / 31 % 13, z = k / (31 * 13);
        const char *shape = k % 90 == 7 ? "box = [0.006, 0.007, 0.008], rounding = 0.001"
                            : k % 3     ? "sphere = 0.005"
                                        : "sphere = 0.004";
        used += sprintf(text + used, "[[body]]\nname = \"b%d\"\nmaterial = \"%s\"\nshape = { %s }\n", k,
                        k % 90 == 7 || (mixed && k % 5 == 3) ? "block" : "ball", k == 0 ? "sphere = 0.024" : shape);
        double place[3] = {0.02 + 0.012 * x, 0.02 + 0.012 * y, 0.02 + 0.012 * z};
        if (k == 0) place[0] = 0.2, place[1] = 0.09, place[2] = 0.15;
        double off[2], v[3];
        check_draw(&seed, -1e-4, 1e-4, 2, off);
        check_draw(&seed, -speed, speed, 3, v);
        used +=
            sprintf(text + used, "position = [%.17g, %.17g, %.17g]\n", place[0] + off[0], place[1] + off[1], place[2]);
        if (k % 200 == 5)
            used += sprintf(text + used, "joint = \"fixed\"\n");
        else
            used += sprintf(text + used, "velocity = [%.17g, %.17g, %.17g]\n", v[0], v[1], v[2]);
    }
    return text;
}

/* Touching pairs of spheres, by looking at all of them. */
static int touching_spheres(const scree_scene *scene) {
    static double ball[COUNT + 10][4];
    static int moves[COUNT + 10];
    int balls = 0, touching = 0;
    for (int k = 0; k < scree_scene_bodies(scene); k++) {
        scree_shape shape = scree_scene_body_shape(scene, k);
        if (shape.kind != SCREE_SPHERE) continue;
        const scree_body_state state = scree_scene_body(scene, k);
        memcpy(ball[balls], state.position, sizeof state.position);
        ball[balls][3] = shape.radius;
        moves[balls++] = scree_scene_body_moves(scene, k);
    }
    for (int i = 0; i < balls; i++)
        for (int j = i + 1; j < balls; j++) {
            double far = vec_norm(vec_sub(vec_from(ball[i]), vec_from(ball[j])));
            touching += (moves[i] || moves[j]) && far < ball[i][3] + ball[j][3];
        }
    return touching;
}

static int listed_spheres(scree_scene *scene) {
    static scree_contact_state contacts[20000];
    int count = 0, spheres = 0;
    CHECK(scree_scene_contacts(scene, contacts, 20000, &count) == SCREE_OK && count < 20000);
    for (int k = 0; k < count; k++)
        spheres += scree_scene_body_shape(scene, contacts[k].ball).kind == SCREE_SPHERE &&
                   scree_scene_body_shape(scene, contacts[k].host).kind == SCREE_SPHERE;
    return spheres;
}

/* ---- tests ---- */

/* How often the order changes in a run, looked at after every 512 steps; and no contact is missed. */
static void test_reordering(void) {
    char *text = gas_text(1.5, 0);
    scree_scene *scene = scene_from(text, NULL, 0, 1);
    int *before = malloc((size_t)scree_scene_bodies(scene) * sizeof *before), changes = 0, most = 0;
    CHECK(scene->bodies.order.slabs > 4 && scene->bodies.order.members > 6);
    for (int k = 0; k < 6; k++) {
        size_t size = (size_t)scree_scene_bodies(scene) * sizeof *before;
        memcpy(before, scene->bodies.number, size);
        go(scene, 513);
        changes += memcmp(before, scene->bodies.number, size) != 0;
        int touching = touching_spheres(scene);
        CHECK(listed_spheres(scene) == touching);
        most = touching > most ? touching : most;
    }
    CHECK(changes >= 2 && most > 40);
    for (int number = 0; number < scree_scene_bodies(scene); number++)
        CHECK(scene->bodies.number[scene->bodies.place[number]] == number);
    free(before);
    scree_scene_destroy(scene);
    free(text);
}

enum { STEPS = 1100, MIDDLE = 530 }; /* the order is looked at after 512 and 1024 */

/* What a run ends with; the energies, where they are kept. */
struct end {
    uint64_t hash;
    scree_energy energy;
};

static struct end end_of(scree_scene *scene) {
    struct end end;
    memset(&end, 0, sizeof end);
    end.hash = scree_scene_hash(scene);
    CHECK(scree_scene_energy(scene, &end.energy) == SCREE_OK);
    return end;
}

static int same(struct end a, struct end b) { return memcmp(&a, &b, sizeof a) == 0; }

static struct end end_after(const char *text, const char *const *changes, int count, int threads, long at_once) {
    scree_scene *scene = scene_from(text, changes, count, threads);
    for (long k = 0; k < STEPS; k += at_once) go(scene, at_once < STEPS - k ? at_once : STEPS - k);
    struct end end = end_of(scene);
    scree_scene_destroy(scene);
    return end;
}

/* Saved between two orderings, restored, and taken on. */
static struct end end_restored(const char *text, const char *const *changes, int count) {
    scree_scene *scene = scene_from(text, changes, count, 1), *other = scene_from(text, changes, count, 2);
    FILE *file = tmpfile();
    go(scene, MIDDLE);
    CHECK(scree_scene_save(scene, file, "memory") == SCREE_OK);
    rewind(file);
    CHECK(scree_scene_restore(other, file, "memory") == SCREE_OK);
    CHECK(same(end_of(other), end_of(scene)));
    go(other, STEPS - MIDDLE);
    struct end end = end_of(other);
    fclose(file);
    scree_scene_destroy(scene);
    scree_scene_destroy(other);
    return end;
}

/* With lists half as wide, so made at other times, and memory asked for ahead. */
static struct end end_with_narrow_lists(const char *text, const char *const *changes, int count) {
    scree_scene *scene = scene_from(text, changes, count, 1);
    scene->contacts.skin *= 0.5;
    scene->contacts.cached = 0;
    CHECK(scree_contacts_list(&scene->contacts, &scene->bodies, 1, NULL) == SCREE_OK);
    go(scene, STEPS);
    struct end end = end_of(scene);
    scree_scene_destroy(scene);
    return end;
}

/* The same bits of bodies and energies whatever works them out: threads, processor, steps at a time, the width of
 * lists, a pause; and measurements change nothing. */
static void test_same_bits(const char *const *changes, int count, int mixed) {
    static const int threads[] = {2, 3, 16};
    static const char *const isa[] = {"baseline", "avx2", "avx512"};
    char *text = gas_text(1.5, mixed);
    const char *measured[4] = {"output={write=[\"energy.csv\"]}"};
    for (int k = 0; k < count; k++) measured[1 + k] = changes[k];
    struct end end = end_after(text, measured, 1 + count, 1, STEPS);
    CHECK(end.energy.lost_normal > 0.0 && end.energy.lost_tangential > 0.0);
    for (size_t k = 0; k < sizeof threads / sizeof *threads; k++)
        CHECK(same(end_after(text, measured, 1 + count, threads[k], STEPS), end));
    for (size_t k = 0; k < sizeof isa / sizeof *isa; k++) {
        setenv("SCREE_ISA", isa[k], 1);
        CHECK(same(end_after(text, measured, 1 + count, 1, STEPS), end));
    }
    unsetenv("SCREE_ISA");
    CHECK(same(end_after(text, measured, 1 + count, 1, 7), end));
    CHECK(same(end_restored(text, measured, 1 + count), end));
    CHECK(same(end_with_narrow_lists(text, measured, 1 + count), end));
    CHECK(end_after(text, changes, count, 1, STEPS).hash == end.hash);
    CHECK(end_restored(text, changes, count).hash == end.hash);
    free(text);
}

/* Balls of one size have loops of their own, and sums of bodies may be kept at hand there. */
static uint64_t shaken(const char *isa, int in_hand) {
    setenv("SCREE_ISA", isa, 1);
    scree_scene *scene = scene_from(
        "gravity = [0, 0, 0]\n[time]\nintegrator = \"verlet\"\nend = 1\nstep = 2e-5\n"
        "[[material]]\nname = \"ball\"\ndensity = 2000\nyoung = 1e6\npoisson = 0.25\n"
        "[[contact]]\nbetween = [\"ball\", \"ball\"]\nnormal = { law = \"tsuji\", restitution = 0.6 }\n"
        "friction = { law = \"mindlin\", static = 0.5, kinetic = 0.5 }\n"
        "[[generate]]\nname = \"grain\"\nkind = \"lattice\"\nradius = 0.005\nspacing = 0.0101\njitter = 4e-5\n"
        "min = [0, 0, 0]\nmax = [0.172, 0.093, 0.093]\nmaterial = \"ball\"\nseed = 3\n",
        NULL, 0, 1);
    struct scree_bodies *bodies = &scene->bodies;
    uint64_t seed = 5, hash;
    CHECK(bodies->even > 0.0 && bodies->order.slabs > 2);
    for (int k = bodies->order.members; k < bodies->count; k++) check_draw(&seed, -0.5, 0.5, 3, bodies->state[k].v);
    scene->contacts.in_hand = in_hand;
    go(scene, 400);
    CHECK(touching_spheres(scene) > 300);
    hash = scree_scene_hash(scene);
    scree_scene_destroy(scene);
    unsetenv("SCREE_ISA");
    return hash;
}

static void test_one_size(void) {
    uint64_t hash = shaken("baseline", 0);
    CHECK(shaken("avx2", 0) == hash);
    CHECK(shaken("avx512", 0) == hash);
    CHECK(shaken("avx512", 1) == hash);
}

/* The gate of a strip (slabs.c), by looking through all contacts: blocks of them aren't cut. */
static void check_gate(const struct scree_bodies *bodies, const struct scree_batch *batch, int slab, int from, int to,
                       struct scree_gate gate) {
    const struct scree_part *segment = &batch->segment[1 + slab];
    int end = bodies->order.start[slab + 1], before = 0, through = 0, own = to - 1, next = -1, left = INT_MAX;
    for (int k = 0; k < segment->count; k++) {
        before += scree_first_of(&batch->ends[segment->first + k]) < from;
        through += scree_first_of(&batch->ends[segment->first + k]) < to;
    }
    for (int k = 0; k < segment->count; k++) {
        const struct scree_ends *contact = &batch->ends[segment->first + k];
        int later = contact->ball > contact->host ? contact->ball : contact->host;
        int last = later < end ? later : contact->ball + contact->host - later; /* in the slab */
        if (k < scree_padded(through) && last > own) own = last;
        if (later >= end && k < scree_padded(through) && later > next) next = later;
        if (later >= end && k >= scree_padded(before) && later < left) left = later;
    }
    CHECK(gate.last_own == own && gate.last_next == next && gate.first_next == left);
}

/* Slabs wait for each other by gates: these are right for the lists as they are, after lists have been made and after
 * single bodies have got new contacts. */
static void test_gates(void) {
    scree_scene *scene = scene_from(
        BALLS_ALONE
        "[[generate]]\nname = \"grain\"\nkind = \"lattice\"\nradius = 0.005\nspacing = 0.0125\njitter = 1e-4\n"
        "min = [0, 0, 0]\nmax = [0.51, 0.126, 0.126]\nmaterial = \"ball\"\nseed = 3\n",
        NULL, 0, 2);
    const struct scree_bodies *bodies = &scene->bodies;
    const struct scree_contacts *contacts = &scene->contacts;
    long strips = 0, renewed = contacts->renewals, answered = contacts->answers;
    CHECK(bodies->order.slabs > 8);
    uint64_t seed = 5;
    for (int k = bodies->order.members; k < bodies->count; k++)
        check_draw(&seed, -2.0, 2.0, 3, scene->bodies.state[k].v);
    for (int k = 0; k < 40; k++) {
        go(scene, 12);
        for (int slab = 0; slab < bodies->order.slabs; slab++) {
            int from = bodies->order.start[slab], end = bodies->order.start[slab + 1], strip = 0;
            int width = scree_strip_of(end - from);
            CHECK(contacts->gated[slab]);
            for (; from < end; from += width, strip++, strips++)
                check_gate(bodies, contacts->batch, slab, from, from + width < end ? from + width : end,
                           scree_gates_of(contacts, &bodies->order, slab)[strip]);
        }
    }
    CHECK(strips > 40 * 20 && contacts->renewals > renewed && contacts->answers > answered);
    scree_scene_destroy(scene);
}

/* Two slabs of any sizes, and one behind: the gates of none reach into those of the next. */
static void test_strips(void) {
    struct scree_order order = {.slabs = 3, .members = 5, .start = {5}};
    static struct scree_gate gate[2 * 20000 / SCREE_SHORTEST_STRIP + 3];
    struct scree_contacts contacts = {.gate = gate};
    uint64_t seed = 3;
    int wrong = 0, longest = 0;
    for (int k = 0; k < 10000; k++) {
        double size[2];
        check_draw(&seed, 0.0, k % 2 ? 500.0 : 20000.0, 2, size);
        for (int slab = 0; slab < 2; slab++) {
            int members = (int)size[slab], strip = scree_strip_of(members), strips = (members + strip - 1) / strip;
            order.start[slab + 1] = order.start[slab] + members;
            struct scree_gate *own = scree_gates_of(&contacts, &order, slab);
            wrong += scree_gates_of(&contacts, &order, slab + 1) - own < strips || strip < SCREE_SHORTEST_STRIP;
            longest = strip > longest ? strip : longest;
        }
    }
    CHECK(wrong == 0 && longest == 190);
}

/* The process's threads, by what the system calls them; none where it doesn't tell. */
static int find_threads(long *thread, int most) {
    DIR *all = opendir("/proc/self/task");
    int count = 0;
    for (struct dirent *entry; all && (entry = readdir(all));)
        if (entry->d_name[0] != '.' && count < most) thread[count++] = strtol(entry->d_name, NULL, 10);
    if (all) closedir(all);
    return count;
}

/* All parallel regions have the same threads, also where slabs are too few for them: the runtime would end those that
 * aren't needed, and begin others for the next region. */
static void test_threads_stay(void) {
    enum { THREADS = 24, MOST = 256 };
    scree_scene *scene = scene_from(
        BALLS_ALONE
        "[[generate]]\nname = \"grain\"\nkind = \"lattice\"\nradius = 0.005\nspacing = 0.0125\njitter = 1e-4\n"
        "min = [0, 0, 0]\nmax = [0.26, 0.126, 0.126]\nmaterial = \"ball\"\nseed = 3\n",
        NULL, 0, THREADS);
    const struct scree_bodies *bodies = &scene->bodies;
    const struct scree_contacts *contacts = &scene->contacts;
    uint64_t seed = 5;
    for (int k = bodies->order.members; k < bodies->count; k++)
        check_draw(&seed, -2.0, 2.0, 3, scene->bodies.state[k].v);
    go(scene, 20);
    long before[MOST], after[MOST], answered = contacts->answers, renewed = contacts->renewals;
    int count = find_threads(before, MOST), same = 0;
    go(scene, 200);
    CHECK(find_threads(after, MOST) == count && count < MOST);
    for (int k = 0; k < count; k++)
        for (int m = 0; m < count; m++) same += after[k] == before[m];
    CHECK(same == count);
    CHECK(bodies->order.slabs < THREADS && contacts->answers > answered && contacts->renewals > renewed);
    scree_scene_destroy(scene);
}

/* Something that only this contact keeps; every third one keeps nothing. */
static double mark_of(const struct scree_bodies *bodies, const struct scree_ends *contact) {
    int a = bodies->number[contact->ball], b = bodies->number[contact->host];
    return (a + b) % 3 ? 1.0 + a + 65536.0 * b : 0.0;
}

/* What holds beyond the touch stays in the near lists of slabs, though most bodies have come to rest and what is left
 * to them is less than its gap; so does what it keeps, among the contacts of those that still move. */
/* What was seen of a batch's contacts: kept ones that are near no more and ones that are near, and such without. */
struct held {
    int kept, far, near, idle;
};

/* Of the slabs. */
static struct held look_at_held(const scree_scene *scene, const struct scree_batch *batch) {
    const struct scree_bodies *bodies = &scene->bodies;
    const double *kept = batch->kept[SCREE_KEPT_NORMAL + 1];
    struct held held = {0, 0, 0, 0};
    for (int s = 1; s <= bodies->order.slabs; s++)
        for (int n = 0, k = batch->segment[s].first; n < batch->segment[s].count; n++, k++) {
            struct scree_contact contact = scree_contact_at(batch, k), before = scree_contact_at(batch, k - (n > 0));
            int is_near = scree_contact_is_near(&scene->contacts, bodies, batch, &contact);
            CHECK(n == 0 || scree_compare_contacts(&before, &contact, s) < 0);
            CHECK(kept[k] == mark_of(bodies, &batch->ends[k]) && (is_near || kept[k] > 0.0));
            held.kept += kept[k] > 0.0;
            held.far += !is_near;
            held.near += is_near;
            held.idle += kept[k] == 0.0;
        }
    CHECK(batch->segment[0].count == 0 && held.far + held.near == batch->count);
    return held;
}

static int mark_contacts(const struct scree_bodies *bodies, const struct scree_batch *batch) {
    double *kept = batch->kept[SCREE_KEPT_NORMAL + 1];
    int marked = 0;
    for (int k = scree_first(batch); k >= 0; k = scree_next(batch, k))
        marked += (kept[k] = mark_of(bodies, &batch->ends[k])) > 0.0;
    return marked;
}

static void test_held_beyond_margins(void) {
    scree_scene *scene = scene_from(
        "gravity = [0, 0, 0]\n[time]\nintegrator = \"verlet\"\nend = 1\nstep = 2e-5\n"
        "[[material]]\nname = \"ball\"\ndensity = 2000\n[[contact]]\nbetween = [\"ball\", \"ball\"]\n"
        "normal = { law = \"jkr\", modulus = 3e7, adhesion = 20.0 }\n"
        "[[body]]\nname = \"floor\"\nshape = { plane = true }\nmaterial = \"ball\"\njoint = \"fixed\"\n"
        "[[generate]]\nname = \"grain\"\nkind = \"lattice\"\nradius = 0.005\nspacing = 0.0102\njitter = 4e-5\n"
        "min = [0, 0, 0]\nmax = [0.172, 0.093, 0.093]\nmaterial = \"ball\"\nseed = 3\n",
        NULL, 0, 1);
    struct scree_bodies *bodies = &scene->bodies;
    struct scree_contacts *contacts = &scene->contacts;
    const struct scree_batch *balls = scree_batch_for(contacts, contacts->rule, SCREE_BALL_BALL);
    const struct scree_batch *floor = scree_batch_for(contacts, contacts->rule, SCREE_BALL_PLANE);
    uint64_t seed = 5;
    for (int k = bodies->order.members; k < bodies->count; k++) check_draw(&seed, -0.5, 0.5, 3, bodies->record[k].v);
    CHECK(scree_contacts_renew(contacts, bodies, 1, NULL) == SCREE_OK);
    int marked[2] = {mark_contacts(bodies, balls), mark_contacts(bodies, floor)};
    for (int k = bodies->order.members; k < bodies->count; k++)
        if (k % 4) memset(bodies->record[k].v, 0, 3 * sizeof(double));
    CHECK(scree_contacts_renew(contacts, bodies, 1, NULL) == SCREE_OK);
    struct held of_balls = look_at_held(scene, balls), on_floor = look_at_held(scene, floor);
    CHECK(bodies->order.slabs > 2);
    CHECK(of_balls.kept == marked[0] && of_balls.far > 300 && of_balls.near > 300 && of_balls.idle > 100);
    CHECK(on_floor.kept == marked[1] && on_floor.far > 10 && on_floor.near > 10);
    scree_scene_destroy(scene);
}

/* Slabs share the balls out where these lie, in a dense block of layers of 144: not by space, most of which is taken by
 * a few loose ones; and not across what one takes that has fallen deep. A slab is one and a half diameters thick at
 * least, and what a list looks ahead: two layers at most. */
static void test_shares(void) {
    enum { LAYER = 144, LAYERS = 20 };
    scree_scene *scene = scene_from(
        BALLS_ALONE
        "[[generate]]\nname = \"dense\"\nkind = \"lattice\"\nradius = 0.005\nspacing = 0.011\n"
        "min = [0, 0, 0]\nmax = [0.22, 0.132, 0.132]\nmaterial = \"ball\"\n"
        "[[generate]]\nname = \"loose\"\nkind = \"lattice\"\nradius = 0.005\nspacing = 0.033\n"
        "min = [0.22, 0, 0]\nmax = [1, 0.132, 0.132]\nmaterial = \"ball\"\n"
        "[[body]]\nname = \"far\"\nshape = { sphere = 0.005 }\nmaterial = \"ball\"\nposition = [0.5, 0, -3e3]\n",
        NULL, 0, 1);
    const struct scree_order *order = &scene->bodies.order;
    int slabs = order->slabs;
    CHECK(order->members == 0 && scene->bodies.count > LAYER * LAYERS && order->axis[0] == 0 && slabs > 12);
    for (int slab = 0; slab < slabs; slab++) CHECK(order->start[slab + 1] - order->start[slab] <= 2 * LAYER);
    scree_scene_destroy(scene);
}

/* Fast balls may meet others from slabs that aren't neighbours. Such contacts belong to segment 0, whoever finds them:
 * it is the same for any number of threads. */
static void test_strays(void) {
    enum { MOST = 4000 };
    static struct scree_contact alone[MOST];
    const char *text =
        BALLS_ALONE "[[generate]]\nname = \"grain\"\nkind = \"lattice\"\nradius = 0.005\nspacing = 0.011\n"
                    "jitter = 4e-4\nmin = [0, 0, 0]\nmax = [0.165, 0.165, 1]\ncount = 4275\nmaterial = \"ball\"\n"
                    "seed = 3\n";
    scree_scene *scene = scene_from(text, NULL, 0, 1);
    struct scree_contacts *contacts = &scene->contacts;
    int members = scene->bodies.order.members, across = scene->bodies.order.axis[0], found = 0, strays = 0;
    CHECK(scene->bodies.order.slabs > 4);
    for (int k = members; k < scene->bodies.count; k++) { /* those about the middle line */
        struct scree_record *record = &scene->bodies.record[k];
        if (hypot(record->x[0] - 0.0825, record->x[1] - 0.0825) < 0.016) record->v[across] = 40.0;
    }
    CHECK(scree_contacts_list(contacts, &scene->bodies, 1, NULL) == SCREE_OK); /* now all have flights */
    for (int turn = 0; turn < 400; turn++) {
        int same = 0;
        CHECK(scree_contacts_list(contacts, &scene->bodies, turn == 0 ? 1 : 4, NULL) == SCREE_OK);
        for (int b = 0; b < contacts->batches; b++) {
            const struct scree_batch *batch = &contacts->batch[b];
            for (int k = 0; k < batch->segment[0].outer_count; k++) {
                const struct scree_contact *one = &batch->loose[k];
                strays += turn == 0 && one->ball >= members && one->host >= members;
                if (turn == 0 && found < MOST)
                    alone[found++] = *one;
                else
                    same += same < found && memcmp(one, &alone[same], sizeof *one) == 0;
            }
        }
        CHECK(turn == 0 || same == found);
    }
    CHECK(strays > 10);
    scree_scene_destroy(scene);
}

/* A stream that shears, past fixed bodies or past none: flights keep its lists far longer than it takes to go half a
 * skin, and no contact is missed. */
static void check_flights(const char *stones, double most_lists) {
    enum { LOOKS = 40, BETWEEN = 23 };
    const double speed = 2.0;
    char text[2048];
    snprintf(text, sizeof text,
             "gravity = [0, 0, -9.81]\n[time]\nintegrator = \"verlet\"\nend = 1\nstep = 1e-5\n"
             "[[material]]\nname = \"ball\"\ndensity = 2000\n[[contact]]\nbetween = [\"ball\", \"ball\"]\n"
             "normal = { law = \"linear\", stiffness = 2e4, restitution = 0.5 }\n"
             "[[body]]\nname = \"floor\"\nshape = { plane = true }\nmaterial = \"ball\"\njoint = \"fixed\"\n%s"
             "[[generate]]\nname = \"grain\"\nkind = \"lattice\"\nradius = 0.005\nspacing = 0.0102\n"
             "jitter = 1e-4\nmin = [0, 0, 0]\nmax = [0.22, 0.1, 1]\ncount = 1500\nmaterial = \"ball\"\nseed = 3\n",
             stones);
    scree_scene *scene = scene_from(text, NULL, 0, 1);
    struct scree_bodies *bodies = &scene->bodies;
    uint64_t seed = 5;
    for (int k = bodies->order.members; k < bodies->count; k++) {
        double height = bodies->position[k][2], *v = bodies->state[k].v;
        for (int axis = 0; axis < 3; axis++) v[axis] = check_between(&seed, -0.05, 0.05);
        v[0] += speed + 4.0 * (height - 0.05);
    }
    int most = 0;
    for (int look = 0; look < LOOKS; look++) {
        go(scene, BETWEEN);
        int touching = touching_spheres(scene);
        CHECK(listed_spheres(scene) == touching && (bodies->flight || look == 0));
        most = touching > most ? touching : most;
    }
    double halves = speed * LOOKS * BETWEEN * scene->step / (0.5 * scene->contacts.skin);
    CHECK(most > 150 && halves > 15.0);
    CHECK((double)scene->contacts.rebuilds < most_lists * halves);
    scree_scene_destroy(scene);
}

static void test_flights(void) {
    check_flights("", 0.5);
    check_flights("[[body]]\nname = \"stone\"\nshape = { sphere = 0.01 }\nmaterial = \"ball\"\njoint = \"fixed\"\n"
                  "position = [0.25, 0.05, 0.03]\n"
                  "[[body]]\nname = \"brick\"\nshape = { box = [0.02, 0.02, 0.02] }\nmaterial = \"ball\"\n"
                  "joint = \"fixed\"\nposition = [0.24, 0.02, 0.01]\n",
                  1.5);
}

/* A run that stops amid its steps leaves the state of that instant, as if its steps had been taken one by one; but
 * positions are reckoned back over half a step, which rounds twice. */
static void test_stop(void) {
    enum { MOST = 700 };
    char *text = gas_text(1.5, 0);
    scree_scene *at_once = scene_from(text, NULL, 0, 0), *singly = scene_from(text, NULL, 0, 0);
    at_once->gravity.vector[0] = singly->gravity.vector[0] = 3e3; /* sooner or later one is too fast */
    CHECK(scree_scene_step(at_once, MOST) == SCREE_FAILED);
    scree_status status = SCREE_OK;
    for (int k = 0; k < MOST && !status; k++) status = scree_scene_step(singly, 1);
    CHECK(status == SCREE_FAILED && scree_scene_steps(at_once) == scree_scene_steps(singly));
    CHECK(strcmp(scree_scene_trouble(at_once)->text, scree_scene_trouble(singly)->text) == 0);
    for (int k = 0; k < scree_scene_bodies(at_once); k++) {
        scree_body_state a = scree_scene_body(at_once, k), b = scree_scene_body(singly, k);
        CHECK(memcmp(a.velocity, b.velocity, sizeof a.velocity) == 0);
        for (int axis = 0; axis < 3; axis++)
            NEAR(a.position[axis], b.position[axis], 4e-16 * (1.0 + fabs(b.position[axis])));
    }
    scree_scene_destroy(at_once);
    scree_scene_destroy(singly);
    free(text);
}

/* A run that stops where members of slabs are in the middle of the next step already forgets that when it goes back to
 * a state. */
static void test_back_after_stop(void) {
    char *text = gas_text(1.5, 0);
    scree_scene *stopped = scene_from(text, NULL, 0, 0), *other = scene_from(text, NULL, 0, 0);
    FILE *file = tmpfile();
    CHECK(scree_scene_save(other, file, "file") == SCREE_OK);
    for (int k = 0; k < stopped->bodies.count; k++)
        for (int axis = 0; axis < 3; axis++) stopped->bodies.state[k].v[axis] *= 8.0; /* too deep into each other */
    CHECK(scree_scene_step(stopped, 1000) == SCREE_FAILED && stopped->ahead);
    CONTAINS(scree_scene_trouble(stopped)->text, "overlap of");
    rewind(file);
    CHECK(scree_scene_restore(stopped, file, "file") == SCREE_OK);
    go(stopped, 20);
    go(other, 20);
    CHECK(scree_scene_hash(stopped) == scree_scene_hash(other));
    fclose(file);
    scree_scene_destroy(stopped);
    scree_scene_destroy(other);
    free(text);
}

/* Where energy books are kept, balls move on right behind their contacts; where gravity tilts, too, after all contacts.
 * By a tilt that stands still the books and bits are the same; and they close. */
static void test_books(void) {
    static const char fixed[] = "gravity = [0, 0, -9.81]\n";
    const char *change = "output={write=[\"energy.csv\"]}";
    char *text = gas_text(1.5, 0), *tilting = malloc(strlen(text) + 300);
    CHECK(strncmp(text, fixed, strlen(fixed)) == 0);
    sprintf(tilting, "gravity = { vector = [0, 0, -9.81], axis = [0, 1, 0], tilt = \"still\" }\n%s%s",
            text + strlen(fixed), "[[motion]]\nname = \"still\"\nkind = \"velocity\"\nvelocity = 0\n");
    scree_scene *one = scene_from(text, &change, 1, 1), *other = scene_from(tilting, &change, 1, 1);
    int driven = 0;
    scree_energy a, b;
    for (int k = 0; k < 4; k++) {
        go(one, 150);
        go(other, 150);
        CHECK(scree_scene_energy(one, &a) == SCREE_OK && scree_scene_energy(other, &b) == SCREE_OK);
        CHECK(memcmp(&a, &b, sizeof a) == 0);
        driven |= a.driven != 0.0;
        CHECK(scree_scene_hash(one) == scree_scene_hash(other));
    }
    CHECK(driven);
    /* Verlet's error, where contacts begin and end inside steps, is half a percent of all that is lost. */
    double least = scree_least(a.lost_normal, a.lost_tangential);
    CHECK(least > 0.1 * a.kinetic && fabs(a.balance) < 0.02 * least);
    scree_scene_destroy(one);
    scree_scene_destroy(other);
    free(tilting);
    free(text);
}

/* Too fast for the next step, but not for the one that made it so: the watch names the body, wherever in memory it
 * lies. */
static void test_watch(void) {
    const char *change = "time.watch=\"halve\"";
    char *text = gas_text(1.5, 0);
    scree_scene *scene = scene_from(text, &change, 1, 1);
    int fast = 0;
    for (int k = 0; k < scree_scene_bodies(scene); k++) {
        int place = scene->bodies.place[k];
        if (scene->bodies.class[place] == SCREE_CLASS_BALL && place > k + 100) fast = k;
    }
    CHECK(fast > 0);
    double gain = 3e2 * scene->step, most = scene->contacts.chosen_skin / scene->step;
    double *v = scene->bodies.state[scene->bodies.place[fast]].v;
    scene->gravity.vector[0] = 3e2;
    v[0] = most - 0.6 * gain;
    v[1] = v[2] = 0.0;
    CHECK(scree_scene_step(scene, 1) == SCREE_OK && scree_scene_halvings(scene) == 1);
    const scree_halving *halving = scree_scene_halving(scene, 0);
    CHECK(halving && halving->cause.body == fast && strstr(halving->cause.text, "too far in a step to be watched"));
    CHECK(halving && strstr(halving->cause.text, scree_scene_body_name(scene, fast).text));
    scree_scene_destroy(scene);
    free(text);
}

/* Once lists have grown, a step allocates nothing: neither lists, nor near lists, nor another order. In a gas a list
 * grows now and then all the same; many stretches of 500 steps, with some dozens of outer lists and an ordering each,
 * know nothing of it. */
static void test_allocations(void) {
    char *text = gas_text(1.0, 0);
    scree_scene *scene = scene_from(text, NULL, 0, 1);
    scene->contacts.most_margin = 0.0; /* so that there are many */
    go(scene, 2100);
    int calm = 0;
    for (int k = 0; k < 12; k++) {
        long before = allocations, lists = scene->contacts.rebuilds;
        go(scene, 500);
        calm += allocations == before;
        CHECK(scene->contacts.rebuilds > lists + 20);
    }
    CHECK(calm >= 4);
    scree_scene_destroy(scene);
    free(text);
}

/* One step, of whose allocations one after the other is refused: the scene stays as it was, may be looked at (which
 * takes memory too), and the try that succeeds comes out as if nothing had happened. Returns how many were. */
static int go_refused(scree_scene *scene, int looks) {
    long steps = scree_scene_steps(scene);
    uint64_t hash = scree_scene_hash(scene);
    for (int refusals = 0;; refusals++) {
        refused = 1 + refusals;
        scree_status status = scree_scene_step(scene, 1);
        int met = refused == 0;
        refused = 0;
        CHECK(status == SCREE_OK || (met && status == SCREE_NO_MEMORY));
        if (status == SCREE_OK || !met) return refusals;
        CHECK(scree_scene_trouble(scene)->text[0] && scree_scene_steps(scene) == steps);
        /* (The hash takes contacts in the order of bodies, which may be new at such a step.) */
        if (steps % 512) CHECK(scree_scene_hash(scene) == hash);
        scree_energy energy;
        if (looks) CHECK(scree_scene_energy(scene, &energy) == SCREE_OK && energy.kinetic > 0.0);
    }
}

static void check_refusals(const char *text, const char *const *changes, int count, int looks, int steps, int least) {
    scree_scene *scene = scene_from(text, changes, count, 1), *other = scene_from(text, changes, count, 1);
    int refusals = 0;
    for (int k = 0; k < steps; k++) {
        refusals += go_refused(scene, looks);
        go(other, 1);
    }
    CHECK(scree_scene_hash(scene) == scree_scene_hash(other));
    CHECK(refusals >= least);
    scree_scene_destroy(scene);
    scree_scene_destroy(other);
}

/* A scene whose restoring is refused memory stays as it was, or has the state and asks again in its next step. */
static void check_refused_restore(const char *text) {
    scree_scene *scene = scene_from(text, NULL, 0, 1);
    FILE *file = tmpfile();
    go(scene, 400);
    CHECK(scree_scene_save(scene, file, "memory") == SCREE_OK);
    uint64_t saved = scree_scene_hash(scene);
    go(scene, 20);
    int refusals = 0, applied = 0;
    for (scree_status status = SCREE_NO_MEMORY; status && refusals < 200; refusals++) {
        scree_scene *other = scene_from(text, NULL, 0, 1);
        uint64_t own = scree_scene_hash(other);
        rewind(file);
        refused = 1 + refusals;
        status = scree_scene_restore(other, file, "memory");
        CHECK(status == SCREE_OK || (status == SCREE_NO_MEMORY && refused == 0));
        refused = 0;
        applied = scree_scene_hash(other) == saved;
        CHECK(applied || (status && scree_scene_hash(other) == own));
        if (applied) go(other, 20);
        if (applied) CHECK(scree_scene_hash(other) == scree_scene_hash(scene));
        scree_scene_destroy(other);
    }
    CHECK(refusals > 3 && refusals < 200);
    fclose(file);
    scree_scene_destroy(scene);
}

/* A ball that touches an image and has to return into the box: while its new list is refused memory, it and its contact
 * stay what they are. */
static void test_refused_return(void) {
    scree_scene *scene = scene_from(
        "[time]\nintegrator = \"verlet\"\nend = 1.0\nstep = 1e-5\n[domain]\nmin = [0, -1, -1]\nmax = [0.1, 1, 1]\n"
        "periodic = [\"x\"]\n[[material]]\nname = \"m\"\ndensity = 1000\n[[contact]]\nbetween = [\"m\", \"m\"]\n"
        "normal = { law = \"linear\", stiffness = 1e4, restitution = 0.5 }\n"
        "friction = { law = \"coulomb\", static = 0.5, kinetic = 0.4, stiffness = 1e4 }\n"
        "[[body]]\nname = \"fixed\"\nshape = { sphere = 0.02 }\nmaterial = \"m\"\njoint = \"fixed\"\nposition = "
        "[0.002, 0, "
        "0]\n[[body]]\nname = \"ball\"\nshape = { sphere = 0.005 }\nmaterial = \"m\"\nposition = [0.015, 0, 0.0213]\n",
        NULL, 0, 1);
    struct scree_contacts *contacts = &scene->contacts;
    struct scree_bodies *bodies = &scene->bodies;
    const struct scree_batch *image = scree_batch_for(contacts, contacts->rule, SCREE_BALL_IMAGE);
    bodies->position[1][0] = bodies->record[1].x[0] = 0.115;
    CHECK(scree_contacts_list(contacts, bodies, 1, NULL) == SCREE_OK && image->count == 1);
    struct scree_contact before = scree_contact_at(image, scree_first(image));
    scree_keep(image, 0, scree_first(image), 0.25);
    struct scree_space listed = contacts->listed; /* that a list asks for */
    contacts->listed = (struct scree_space){NULL, 0};
    for (int part = 0; part < SCREE_PARTS; part++) contacts->found[part].capacity = 0;
    int refusals = 0;
    for (refused = 1; scree_contacts_return(contacts, bodies, 1, &scene->trouble) != SCREE_OK;
         refused = ++refusals + 1) {
        struct scree_contact after = scree_contact_at(image, scree_first(image));
        CHECK(image->count == 1 && memcmp(&after, &before, sizeof after) == 0);
        CHECK(scree_kept(image, 0, scree_first(image)) == 0.25 && bodies->position[1][0] == 0.115);
    }
    refused = 0;
    const struct scree_batch *own = scree_batch_for(contacts, contacts->rule, SCREE_BALL_BALL);
    CHECK(refusals > 1 && image->count == 0 && own->count == 1);
    CHECK(scree_kept(own, 0, scree_first(own)) == 0.25);
    scree_memory_free(listed.memory);
    scree_scene_destroy(scene);
}

/* Nor does it cost definitions: of motions there are as many names as places. */
static void test_refused_motions(void) {
    scree_scene *scene = scree_scene_create();
    int refusals = 0;
    for (int k = 0; k < 40; k++) {
        char name[24];
        snprintf(name, sizeof name, "motion %d", k);
        scree_motion_def def = {.name = name, .kind = SCREE_MOTION_VELOCITY, .velocity = k};
        scree_status status = SCREE_NO_MEMORY;
        for (int n = 1; status && n < 20; n++) {
            refused = n;
            status = scree_scene_add_motion(scene, &def, NULL);
            refusals += status == SCREE_NO_MEMORY;
        }
        refused = 0;
        CHECK(status == SCREE_OK);
    }
    for (int k = 0; k < 40; k++) {
        char name[24];
        snprintf(name, sizeof name, "motion %d", k);
        CHECK(scree_scene_find_motion(scene, name) == k);
    }
    CHECK(refusals > 40);
    scree_scene_destroy(scene);
}

/* Memory that is refused costs a step, not the run. */
static void test_refusals(const char *const *pair_impulse) {
    static const char grain[] =
        "[[generate]]\nname = \"%s\"\nkind = \"random\"\nradius = 0.005\ncount = %d\nmaterial = "
        "\"ball\"\nmin = [0, 0, 0.01]\nmax = [0.1, 0.1, %g]\nvelocity = [%g, 0.9, -0.5]\n";
    static const char *const adaptive[] = {"time.integrator=\"adaptive\"", "domain.periodic=[]"};
    char *gas = gas_text(1.5, 0), grains[4096];
    int used =
        snprintf(grains, sizeof grains, "%s",
                 "gravity = [0, 0, -9.81]\n[time]\nintegrator = \"verlet\"\nend = 1\nstep = 2e-5\n"
                 "[domain]\nmin = [0, 0, -1]\nmax = [0.1, 0.1, 1]\nperiodic = [\"x\", \"y\"]\n"
                 "[[material]]\nname = \"ball\"\ndensity = 2000\n[[contact]]\nbetween = [\"ball\", \"ball\"]\n"
                 "normal = { law = \"linear\", stiffness = 5e3, restitution = 0.9 }\n"
                 "friction = { law = \"coulomb\", static = 0.5, kinetic = 0.4, stiffness = 4e3 }\n"
                 "[[body]]\nname = \"floor\"\nshape = { plane = true }\nmaterial = \"ball\"\njoint = \"fixed\"\n");
    used += snprintf(grains + used, sizeof grains - (size_t)used, grain, "few", 12, 0.03, 0.3);
    check_refusals(gas, NULL, 0, 0, 530, 50);
    check_refusals(gas, NULL, 0, 1, 90, 5);
    check_refusals(gas, pair_impulse, 2, 0, 100, 50);
    check_refusals(gas, pair_impulse, 1, 0, 100, 50); /* with rolling, which sees the spins of mid-step */
    check_refusals(grains, adaptive, 2, 0, 40, 10);
    snprintf(grains + used, sizeof grains - (size_t)used, grain, "many", 500, 0.2, -1.1);
    check_refusals(grains, NULL, 0, 0, 1100, 25);
    check_refused_restore(gas);
    check_refused_restore(grains);
    test_refused_motions();
    test_refused_return();
    free(gas);
}

int main(void) {
    static const char *const pair_impulse[] = {"time.integrator=\"pair-impulse\"",
                                               "contact.0={between=[\"ball\", \"ball\"], normal={law=\"linear\", "
                                               "stiffness=2e4, restitution=0.9}, friction={law=\"coulomb\", "
                                               "static=0.5, kinetic=0.4, stiffness=1e4}}"};
    test_reordering();
    test_same_bits(NULL, 0, 0);
    test_same_bits(NULL, 0, 1);
    test_same_bits(pair_impulse, 2, 0);
    test_one_size();
    test_shares();
    test_gates();
    test_strips();
    test_threads_stay();
    test_held_beyond_margins();
    test_strays();
    test_flights();
    test_stop();
    test_back_after_stop();
    test_books();
    test_watch();
    test_allocations();
    test_refusals(pair_impulse);
    return check_report();
}
