/* Contacts that hardly change, in the pair-impulse method (contact/steady.c): which are, how right they are, and that
 * they never make anything grow. */
#include "contact/loop.h"
#include "tests/scenes.h"

#include <string.h>

/* How many contacts press, and how many of them the next step finds steady. (What it makes of these is lost with the
 * scene.) */
struct count {
    int pressing, steady;
};

static struct count count_steady(scree_scene *scene) {
    struct scree_contacts *contacts = &scene->contacts;
    struct scree_bodies *bodies = &scene->bodies;
    struct count found = {0, 0};
    double gravity[3], step = scene->step;
    scree_gravity_at(scene, scree_scene_time(scene) + 0.5 * step, gravity);
    scree_contacts_look_both(contacts, bodies, bodies->count, scree_scene_time(scene), step, gravity, INFINITY,
                             &scene->shadow, 1);
    for (int b = 0; b < contacts->batches; b++) {
        const struct scree_batch *batch = &contacts->batch[b];
        for (int k = scree_first(batch); k >= 0; k = scree_next(batch, k))
            found.pressing += batch->past[0][k] != 0.0 || batch->past[1][k] != 0.0 || batch->past[2][k] != 0.0;
        for (int s = 0; s < SCREE_SEGMENTS; s++)
            for (int done = 0, left; (left = batch->segment[s].count - done) > 0; done += SCREE_LANES) {
                static struct scree_yield yield;
                static struct scree_moments moments;
                int first = batch->segment[s].first + done, count = left < SCREE_LANES ? left : SCREE_LANES;
                uint32_t lanes =
                    contacts->loop->hold_steady(contacts, bodies, batch, first, count, step, &yield, &moments);
                for (int k = 0; k < count; k++) found.steady += lanes >> k & 1 && yield.lasts[k] > 0.0;
            }
    }
    return found;
}

/* ---- which are ---- */

static struct count bed_after(const char *const *changes, int count, int steps) {
    scree_scene *scene = scene_file("bed.toml", changes, count);
    go(scene, steps);
    struct count found = count_steady(scene);
    scree_scene_destroy(scene);
    return found;
}

/* Of a bed that is being poured few (of one at rest most: test_same_bits); none where substeps are asked for, under
 * laws that remember, or that have several formulas. */
static void test_bed(void) {
    const char *const changes[] = {"time.integrator=\"pair-impulse\"", "generate.grains.count=200", NULL};
    static const char *const others[] = {"time.substeps=2",
                                         "contact.0.normal={law=\"walton-braun\", stiffness=2000, restitution=0.7}",
                                         "contact.0.friction={law=\"mindlin-incremental\", static=0.5, kinetic=0.5}",
                                         "contact.0.friction={law=\"tanh\", kinetic=0.5, threshold=0.01}"};
    struct count poured = bed_after(changes, 2, 2000);
    if (getenv("SCREE_SHOW")) printf("poured %d of %d\n", poured.steady, poured.pressing);
    CHECK(poured.pressing > 100 && poured.steady < 0.3 * poured.pressing);
    for (size_t k = 0; k < sizeof others / sizeof *others; k++) {
        const char *const changed[] = {changes[0], changes[1], others[k]};
        struct count found = bed_after(changed, 3, 2500);
        CHECK(found.pressing > 100 && found.steady == 0);
    }
}

static const char balls[] =
    "[time]\nend = 1\nintegrator = \"pair-impulse\"\n[[material]]\nname = \"m\"\n"
    "[[contact]]\nbetween = [\"m\", \"m\"]\nnormal = { law = \"hertz\", stiffness = 5e6 }\n"
    "friction = { law = \"coulomb\", static = 0.5, kinetic = 0.5, stiffness = 5e4 }\n"
    "[[body]]\nname = \"a\"\nshape = { sphere = 0.01 }\nmaterial = \"m\"\nmass = 0.03\n"
    "[[body]]\nname = \"b\"\nshape = { sphere = 0.01 }\nmaterial = \"m\"\nmass = 0.03\nposition = [0.0201, 0, 0]\n"
    "velocity = [-1, 0, 0.3]\n";

/* No impact is, however finely it is resolved, nor what presses a ball that nothing else pushes: there all but its own
 * force is known, and the other way is of fourth order. */
static void test_alone(void) {
    for (double step = 1e-5; step > 1e-7; step *= 0.2) {
        char at[64];
        snprintf(at, sizeof at, "time.step=%g", step);
        const char *const changes[] = {at};
        int pressed = 0;
        for (int steps = 20; steps < (int)(4e-4 / step); steps += (int)(1.4e-5 / step)) {
            scree_scene *scene = scene_from(balls, changes, 1, 1);
            go(scene, steps);
            struct count found = count_steady(scene);
            pressed += found.pressing;
            CHECK(found.steady == 0);
            scree_scene_destroy(scene);
        }
        CHECK(pressed > 5);
    }
    scree_scene *scene = scene_file("incline.toml", (const char *const[]){"time.integrator=\"pair-impulse\""}, 1);
    go(scene, 20000);
    struct count found = count_steady(scene);
    CHECK(found.pressing > 0 && found.steady == 0);
    scree_scene_destroy(scene);
}

/* ---- how right they are ---- */

/* A row of balls between two walls, squeezed by an overlap at each contact, and shaken so that their loads swing by a
 * few hundredths; where they rub, sideways too. */
static scree_scene *row_of(const char *laws, double speed, double step, int substeps) {
    enum { COUNT = 5 };
    static const double draw[COUNT][4] = {{1.0, 0.3, 0.0, 20.0},
                                          {-0.6, -0.5, 0.4, 0.0},
                                          {0.2, 0.1, -0.7, -30.0},
                                          {0.7, 0.4, 0.2, 10.0},
                                          {-0.9, 0.0, 0.1, 0.0}};
    const double overlap = 1e-4, aside = strstr(laws, "friction") ? 0.2 * speed : 0.0;
    char text[4096], asked[32] = "";
    if (substeps) snprintf(asked, sizeof asked, "substeps = %d\n", substeps);
    int used = snprintf(text, sizeof text,
                        "[time]\nend = 1\nintegrator = \"pair-impulse\"\nstep = %.17g\n%s[[material]]\nname = \"m\"\n"
                        "[[contact]]\nbetween = [\"m\", \"m\"]\n%s\n"
                        "[[body]]\nname = \"left\"\nshape = { plane = true }\nmaterial = \"m\"\njoint = \"fixed\"\n"
                        "orientation = { axis = [0, 1, 0], degrees = 90 }\n"
                        "[[body]]\nname = \"right\"\nshape = { plane = true }\nmaterial = \"m\"\njoint = \"fixed\"\n"
                        "position = [%.17g, 0, 0]\norientation = { axis = [0, 1, 0], degrees = -90 }\n",
                        step, asked, laws, COUNT * 0.02 - (COUNT + 1) * overlap);
    for (int k = 0; k < COUNT; k++)
        used += snprintf(text + used, sizeof text - (size_t)used,
                         "[[body]]\nname = \"b%d\"\nshape = { sphere = 0.01 }\nmaterial = \"m\"\nmass = 0.03\n"
                         "position = [%.17g, 0, 0]\nvelocity = [%.17g, %.17g, %.17g]\nspin = [0, %.17g, 0]\n",
                         k, 0.01 - overlap + k * (0.02 - overlap), speed * draw[k][0], aside * draw[k][1],
                         aside * draw[k][2], aside > 0.0 ? speed * draw[k][3] : 0.0);
    return scene_from(text, NULL, 0, 1);
}

/* Largest difference of the speeds of bodies and of their surfaces. */
static double worst_of(scree_scene *scene, const scree_scene *fine) {
    double worst = 0.0;
    for (int k = 0; k < scree_scene_bodies(scene); k++) {
        scree_body_state a = scree_scene_body(scene, k), b = scree_scene_body(fine, k);
        for (int axis = 0; axis < 3; axis++) {
            worst = fmax(worst, fabs(a.velocity[axis] - b.velocity[axis]));
            worst = fmax(worst, 0.01 * fabs(a.spin[axis] - b.spin[axis]));
        }
    }
    return worst;
}

/* Of third order, until the balls have gone on for 20/w, w the frequency of a pair: bounds are a third above what
 * errors are at w h = 0.2, in parts of the speed, and an eighth of that with each half of the step; a quarter where
 * sideways motion counts, which such a row amplifies until it buckles. */
static void test_row(void) {
    static const struct {
        const char *laws;
        double frequency, bound, falls; /* of a pair, 1/s */
    } rows[] = {
        {"normal = { law = \"linear-cut\", stiffness = 1e5, restitution = 0.5 }", 2582, 4.7e-4, 8},
        {"normal = { law = \"hertz\", stiffness = 1e7 }", 3162, 3.4e-3, 8},
        {"normal = { law = \"kuwabara-kono\", stiffness = 1e7, relaxation = 2e-4 }", 3162, 4.7e-4, 8},
        {"normal = { law = \"tsuji\", stiffness = 1e7, restitution = 0.6 }\nfriction = { law = \"coulomb\", static = "
         "0.5, kinetic = 0.5, stiffness = 8e4, damping = 5 }",
         3162, 1.1e-3, 4},
    };
    const double speed = 0.01; /* m/s */
    for (size_t k = 0; k < sizeof rows / sizeof *rows; k++) {
        double bound = rows[k].bound;
        for (int halves = 0; halves < 3; halves++, bound /= rows[k].falls) {
            double step = 0.2 / rows[k].frequency / (1 << halves);
            long steps = lround(20.0 / rows[k].frequency / step);
            scree_scene *scene = row_of(rows[k].laws, speed, step, 0);
            scree_scene *fine = row_of(rows[k].laws, speed, step / 64, 4);
            go(scene, steps);
            go(fine, 64 * steps);
            double error = worst_of(scene, fine) / speed;
            struct count found = count_steady(scene);
            if (getenv("SCREE_SHOW")) printf("row %zu: %.3g of %.3g\n", k, error, bound);
            CHECK(error < bound && found.pressing == 6 && found.steady == 6);
            scree_scene_destroy(scene);
            scree_scene_destroy(fine);
        }
    }
}

/* ---- nothing grows ---- */

/* Balls in the densest packing, twelve neighbours each, pressed by a periodic box, with random speeds. */
static scree_scene *crystal_of(double step, double damping, double drag) {
    enum { CELLS = 3 };
    static const double place[4][3] = {{0, 0, 0}, {0.5, 0.5, 0}, {0.5, 0, 0.5}, {0, 0.5, 0.5}};
    const double width = 0.02 * 0.995 * sqrt(2.0);
    char *text = malloc(4 * CELLS * CELLS * CELLS * 300 + 2048);
    uint64_t seed = 3;
    int used = sprintf(
        text,
        "[time]\nend = 1\nintegrator = \"pair-impulse\"\nstep = %.17g\nforce = true\n[[material]]\nname = \"m\"\n"
        "[domain]\nmin = [0, 0, 0]\nmax = [%.17g, %.17g, %.17g]\nperiodic = [\"x\", \"y\", \"z\"]\n"
        "[[contact]]\nbetween = [\"m\", \"m\"]\nnormal = { law = \"linear\", stiffness = 1e5, damping = %g }\n"
        "friction = { law = \"coulomb\", static = 5, kinetic = 5, stiffness = %g, damping = %g }\n",
        step, CELLS * width, CELLS * width, CELLS * width, damping, drag > 0.0 ? 2.8e4 : 1.0, drag);
    for (int k = 0; k < 4 * CELLS * CELLS * CELLS; k++) {
        int cell = k / 4, at[3] = {cell % CELLS, cell / CELLS % CELLS, cell / (CELLS * CELLS)};
        double v[6];
        check_draw(&seed, -1e-5, 1e-5, 6, v);
        used +=
            sprintf(text + used,
                    "[[body]]\nname = \"b%d\"\nshape = { sphere = 0.01 }\nmaterial = \"m\"\nmass = 0.03\nposition = "
                    "[%.17g, %.17g, %.17g]\nvelocity = [%g, %g, %g]\nspin = [%g, %g, %g]\n",
                    k, width * (at[0] + place[k % 4][0] + 0.25), width * (at[1] + place[k % 4][1] + 0.25),
                    width * (at[2] + place[k % 4][2] + 0.25), v[0], v[1], v[2], 30 * v[3], 30 * v[4], 30 * v[5]);
    }
    scree_scene *scene = scene_from(text, NULL, 0, 1);
    free(text);
    return scene;
}

static double motion_of(scree_scene *scene) {
    scree_energy energy;
    CHECK(scree_scene_energy(scene, &energy) == SCREE_OK);
    return energy.kinetic + energy.rotational;
}

/* Up to where contacts count as tame (2 z w h = 0.5; (w h)^2 = 0.2, as Hertz's law has it: two thirds of that are
 * linear springs') motion doesn't grow. Beyond, none is steady. */
static void test_crystal(void) {
    const double frequency = 2582, mass = 0.015; /* 1/s, kg, of a pair */
    for (int k = 0; k < 3 * 3 * 2; k++) {
        int rubs = k / 9;
        double step = 0.36 / frequency / (1 + k % 3), damping = 0.245 * (k / 3 % 3) * mass / step;
        scree_scene *scene = crystal_of(step, damping, rubs ? damping / 3.5 : 0.0);
        double before = motion_of(scene), most = 0.0;
        for (int part = 0; part < 20; part++) {
            go(scene, 40);
            most = fmax(most, motion_of(scene));
        }
        struct count found = count_steady(scene);
        if (getenv("SCREE_SHOW")) printf("crystal %d: %.3g of %.3g\n", k, most, before);
        CHECK(most < before && found.pressing == 648 && found.steady == 648);
        scree_scene_destroy(scene);
    }
    static const double beyond[][2] = {{0.37, 0.0}, {0.1, 0.51}}; /* w h, 2 z w h */
    for (int k = 0; k < 2; k++) {
        double step = beyond[k][0] / frequency;
        scree_scene *scene = crystal_of(step, beyond[k][1] * mass / step, 0.0);
        go(scene, 3);
        CHECK(count_steady(scene).steady == 0);
        scree_scene_destroy(scene);
    }
}

/* ---- the same bits ---- */

/* On one thread or three, with all lists renewed now and then, and from a saved state: of a bed at rest, of whose
 * contacts most are steady. */
static void test_same_bits(void) {
    enum { POUR = 13000, STEPS = 800 };
    static const char *const changes[] = {"time.integrator=\"pair-impulse\"", "generate.grains.count=200"};
    scree_scene *plain = scene_file("bed.toml", changes, 2), *other = scene_file("bed.toml", changes, 2);
    FILE *file = tmpfile();
    go(plain, POUR);
    CHECK(scree_scene_save(plain, file, "memory") == SCREE_OK);
    rewind(file);
    CHECK(scree_scene_restore(other, file, "memory") == SCREE_OK);
    fclose(file);
    other->time.threads = 3;
    go(plain, STEPS);
    for (int done = 0; done < STEPS; done += 40) {
        for (int k = 0; k < other->bodies.count; k++) other->bodies.path[k] = 0.5 * other->contacts.skin;
        go(other, 40);
    }
    CHECK(scree_scene_hash(plain) == scree_scene_hash(other));
    struct count rest = count_steady(plain);
    if (getenv("SCREE_SHOW")) printf("at rest %d of %d\n", rest.steady, rest.pressing);
    CHECK(rest.pressing > 350 && rest.steady > 0.6 * rest.pressing);
    scree_scene_destroy(plain);
    scree_scene_destroy(other);
}

/* ---- what other contacts ask for ---- */

/* As many bodies as a window can have, whose places all ask for the same row of the table, or for some few: each has a
 * slot of its own, in order, and is found there again. */
static void test_starts(void) {
    static struct scree_starts starts;
    for (int apart = SCREE_START_TABLE; apart >= 1; apart /= 8) {
        int wrong = 0, is_new;
        scree_begin_starts(&starts);
        for (int turn = 0; turn < 2; turn++)
            for (int k = 0; k < SCREE_MOST_STARTS; k++)
                wrong += scree_slot_of(&starts, 7 + apart * k, &is_new) != k || is_new != !turn;
        CHECK(wrong == 0 && starts.count == SCREE_MOST_STARTS);
    }
}

int main(void) {
    test_bed();
    test_starts();
    test_alone();
    test_row();
    test_crystal();
    test_same_bits();
    return check_report();
}
