/* engine/: many spheres at once, from tables and generators. */
#include "contact/loop.h"
#include "contact/meet.h"
#include "engine/hash.h"
#include "engine/names.h"
#include "tests/scenes.h"

#include <limits.h>
#include <unistd.h>

/* Head of a scene of glass spheres; what follows is added by each test. */
#define HEAD                                                                                                           \
    "gravity = [0, 0, -9.81]\n[time]\nend = 1.0\n[[material]]\nname = \"glass\"\ndensity = 2500\n"                     \
    "[[contact]]\nbetween = [\"glass\", \"glass\"]\nnormal = { law = \"linear\", stiffness = 100, restitution = 0.6 "  \
    "}\n"                                                                                                              \
    "friction = { law = \"coulomb\", static = 0.5, kinetic = 0.5, stiffness = 80, damping = 0.01 }\n"
#define LATTICE                                                                                                        \
    "[[generate]]\nname = \"grain\"\nkind = \"lattice\"\nmaterial = \"glass\"\nradius = 0.001\nmin = [0, 0, 0]\n"      \
    "max = [0.01, 0.01, 0.03]\n"
#define RANDOM                                                                                                         \
    "[[generate]]\nname = \"grain\"\nkind = \"random\"\nmaterial = \"glass\"\nradius = [0.0002, 0.002]\n"              \
    "min = [0, 0, 0]\nmax = [0.05, 0.05, 0.05]\ncount = 2000\nseed = 3\n"

static scree_status read_text(const char *text, scree_scene **scene, scree_trouble *trouble) {
    struct scree_run_request request;
    scree_status status = scree_read_scene(text, strlen(text), "test.toml", NULL, 0, 1, scene, &request, trouble);
    scree_free_request(&request);
    return status;
}

static void test_lattice(void) {
    scree_scene *scene = scene_from(HEAD LATTICE "spacing = 0.0024\njitter = 1e-4\n", NULL, 0, 1);
    CHECK(scree_scene_bodies(scene) == 4 * 4 * 12);
    CHECK(scree_scene_find_body(scene, "grain 1") == 0 && scree_scene_find_body(scene, "grain 192") == 191);
    CHECK(scree_scene_find_body(scene, "grain 193") == -1);
    double drift = 0.0;
    for (int k = 0; k < 192; k++) {
        scree_body_state state = scree_scene_body(scene, k);
        int cell[3] = {k % 4, k / 4 % 4, k / 16};
        for (int axis = 0; axis < 3; axis++) {
            double off = fabs(state.position[axis] - 0.0024 * (cell[axis] + 0.5));
            CHECK(off <= 1e-4 * (1.0 + 1e-12));
            drift += off / (3 * 192);
        }
    }
    /* The mean of |uniform(-j, j)| is j/2, with a deviation of j/sqrt(12)/sqrt(576): 4 of them. */
    NEAR(drift, 0.5e-4, 4.0 * 1e-4 / sqrt(12.0 * 576.0));
    scree_scene_destroy(scene);

    scene = scene_from(HEAD LATTICE "count = 7\nvelocity = [0, 0, -1]\n", NULL, 0, 1);
    CHECK(scree_scene_bodies(scene) == 7);
    NEAR(state_of(scene, "grain 7").position[1], 0.003, 1e-18); /* spacing: a diameter; 5 a row, the second row */
    NEAR(state_of(scene, "grain 7").position[0], 0.003, 1e-18);
    CHECK(state_of(scene, "grain 7").velocity[2] == -1.0);
    scree_scene_destroy(scene);
}

/* The least gap between two spheres in parts of the smaller radius, and whether all are inside the box. */
static double least_gap(const scree_scene *scene, double low, double high) {
    double least = HUGE_VAL;
    for (int i = 0; i < scree_scene_bodies(scene); i++) {
        double r = scree_scene_body_shape(scene, i).radius;
        scree_body_state a = scree_scene_body(scene, i);
        for (int axis = 0; axis < 3; axis++)
            CHECK(a.position[axis] - r >= low - 1e-15 && a.position[axis] + r <= high + 1e-15);
        for (int j = 0; j < i; j++) {
            scree_body_state b = scree_scene_body(scene, j);
            double s = scree_scene_body_shape(scene, j).radius;
            double gap = vec_norm(vec_sub(vec_from(a.position), vec_from(b.position))) - r - s;
            least = scree_least(least, gap / fmin(r, s));
        }
    }
    return least;
}

/* What a generator makes, in every bit. */
static uint64_t hash_of(const char *text) {
    scree_scene *scene = scene_from(text, NULL, 0, 1);
    uint64_t hash = scree_scene_hash(scene);
    scree_scene_destroy(scene);
    return hash;
}

static void test_random_radii(void) {
    scree_scene *scene = scene_from(HEAD RANDOM, NULL, 0, 1);
    CHECK(scree_scene_bodies(scene) == 2000);
    CHECK(least_gap(scene, 0.0, 0.05) >= -1e-12); /* rounding of places in parts of the least radius */
    double smallest = HUGE_VAL, largest = 0.0, mean = 0.0;
    for (int k = 0; k < 2000; k++) {
        double r = scree_scene_body_shape(scene, k).radius;
        smallest = scree_least(smallest, r);
        largest = scree_most(largest, r);
        mean += r / 2000;
    }
    CHECK(smallest >= 0.0002 && smallest < 0.00021 && largest <= 0.002 && largest > 0.00198);
    NEAR(mean, 0.0011, 4.0 * 0.0018 / sqrt(12.0 * 2000.0)); /* 4 deviations of a mean of 2000 */
    scree_scene_destroy(scene);
}

/* By mass: of the volume, the lower half of the radii has as much as the upper one. The number of large ones is 1 in
 * 100, their share of the volume scatters by some 5 %. */
static void test_random_by_mass(void) {
    scree_scene *scene = scene_from(HEAD RANDOM "distribution = \"mass\"\n", NULL, 0, 1);
    double half[2] = {0.0, 0.0};
    for (int k = 0; k < 2000; k++) {
        double r = scree_scene_body_shape(scene, k).radius;
        half[r > 0.0011] += r * r * r;
    }
    NEAR(half[0] / (half[0] + half[1]), 0.5, 0.2);
    scree_scene_destroy(scene);
}

/* Beside a speck of dust, of which a large sphere reaches any number of cells. */
static void test_random_beside_dust(void) {
    scree_scene *scene =
        scene_from(HEAD "[[body]]\nname = \"dust\"\nmaterial = \"glass\"\nshape = { sphere = 1e-7 }\nposition = [0.02, "
                        "0.02, 0.02]\njoint = \"fixed\"\n[[generate]]\nname = \"large\"\nkind = "
                        "\"random\"\nmaterial = \"glass\"\ncount = 10\nradius = 0.004\nmin = [0, 0, 0]\nmax = [0.05, "
                        "0.05, 0.05]\n",
                   NULL, 0, 1);
    CHECK(scree_scene_bodies(scene) == 11);
    CHECK(least_gap(scene, 0.0, 0.05) >= -1e-9); /* rounding over the speck's radius */
    scree_scene_destroy(scene);
}

/* Nor do they overlap across the borders of a periodic box: with one that stands in a corner, and spheres at all
 * borders. */
static void test_random_across_borders(void) {
    scree_scene *scene =
        scene_from(HEAD "[domain]\nmin = [0, 0, 0]\nmax = [0.02, 0.02, 0.04]\nperiodic = [\"x\", \"y\"]\n"
                        "[[body]]\nname = \"corner\"\nshape = { sphere = 0.004 }\nmaterial = \"glass\"\n"
                        "position = [0.001, 0.019, 0.01]\njoint = \"fixed\"\n"
                        "[[generate]]\nname = \"grain\"\nkind = \"random\"\nmaterial = \"glass\"\nradius = 0.001\n"
                        "min = [-0.001, -0.001, 0]\nmax = [0.021, 0.021, 0.02]\ncount = 400\nseed = 3\n",
                   NULL, 0, 1);
    scree_energy energy;
    CHECK(scree_scene_energy(scene, &energy) == SCREE_OK && energy.stored == 0.0);
    scree_scene_destroy(scene);
}

/* Groups leave room for those before, single bodies among them. */
static void test_random_groups(void) {
    static const char *const fewer[] = {"generate.0.count=700", "generate.1.count=700", "generate.1.name=\"more\""};
    scree_scene *scene = scene_from(HEAD "[[body]]\nname = \"large\"\nmaterial = \"glass\"\nshape = { sphere = 0.02 }\n"
                                         "position = [0.025, 0.025, 0.025]\n" RANDOM RANDOM,
                                    fewer, 3, 1);
    CHECK(scree_scene_bodies(scene) == 1401 && least_gap(scene, 0.0, 0.05) >= -1e-12);
    scree_scene_destroy(scene);
}

/* The same places in every run, on every machine; others by another seed. */
static void test_random_again(void) {
    CHECK(hash_of(HEAD RANDOM) == hash_of(HEAD RANDOM));
    static const char *const other[] = {"generate.0.seed=4"};
    scree_scene *scene = scene_from(HEAD RANDOM, other, 1, 1);
    CHECK(scree_scene_hash(scene) != hash_of(HEAD RANDOM));
    scree_scene_destroy(scene);
    scene = scene_from(HEAD RANDOM, NULL, 0, 1);
    uint64_t hash = scree_hash_start;
    for (int k = 0; k < 2000; k++) {
        scree_body_state state = scree_scene_body(scene, k);
        hash = scree_hash_on(hash, state.position, sizeof state.position);
    }
    CHECK(hash == 0x2cff12b8fc50306cu);
    scree_scene_destroy(scene);
}

/* A hundred to one in one box: finds room, and no two overlap. */
static void test_wide_ratio(void) {
    scree_scene *scene = scene_from(HEAD "[[generate]]\nname = \"g\"\nkind = \"random\"\nmaterial = \"glass\"\n"
                                         "radius = [0.0001, 0.01]\ndistribution = \"mass\"\nmin = [0, 0, 0]\n"
                                         "max = [0.05, 0.05, 0.05]\ncount = 3000\nseed = 1\n",
                                    NULL, 0, 1);
    CHECK(least_gap(scene, 0.0, 0.05) >= -1e-12);
    scree_scene_destroy(scene);
}

/* A sine's peak is reckoned with, wherever its phase begins. */
static void test_shaken_speed(void) {
    char text[1024];
    for (int phase = 0; phase < 4; phase++) {
        snprintf(
            text, sizeof text,
            HEAD
            "[[motion]]\nname = \"shake\"\nkind = \"sine\"\namplitude = 0.1\nfrequency = 16\nphase = %g\n"
            "[[body]]\nname = \"floor\"\nshape = { plane = true }\nmaterial = \"glass\"\n"
            "joint = { z = \"shake\", others = \"fixed\" }\n"
            "[[body]]\nname = \"ball\"\nshape = { sphere = 0.001 }\nmaterial = \"glass\"\nposition = [0, 0, 0.15]\n",
            0.5 * phase * 3.14159265358979);
        scree_scene *scene = scene_from(text, NULL, 0, 1);
        CHECK(scene->plan.choice.speed >= 0.1 * 32.0 * 3.14159265358979);
        scree_scene_destroy(scene);
    }
}

/* ---- tables ---- */

static char table_path[64], scene_path[64];

static void write_file(const char *path, const char *text) {
    FILE *file = fopen(path, "w");
    CHECK(file && fputs(text, file) >= 0);
    if (file) fclose(file);
}

/* Read a scene with the table `table` and these lines of [[spheres]]. */
static scree_status read_table(const char *table, const char *lines, scree_scene **scene, scree_trouble *trouble) {
    char text[2048];
    struct scree_run_request request;
    snprintf(text, sizeof text, "%s[[spheres]]\nfile = \"%s\"\n%s", HEAD, strrchr(table_path, '/') + 1, lines);
    write_file(table_path, table);
    write_file(scene_path, text);
    scree_status status = scree_load_scene(scene_path, NULL, 0, 1, scene, &request, trouble);
    scree_free_request(&request);
    return status;
}

static void test_table(void) {
    scree_scene *scene;
    scree_trouble trouble = {0};
    const char *all = "# spheres\nname,x_m,y_m,z_m,radius_m,vx_m_s,vy_m_s,vz_m_s,wx_rad_s,wy_rad_s,wz_rad_s,material\n"
                      "one, 0,0,0.5,0.1, 1,2,3, 4,5,6, glass\n\n"
                      "\"two, \"\"2\"\"\",1,0,0.5,0.2,0,0,0,0,0,0,\"glass\"\n";
    CHECK(read_table(all, "", &scene, &trouble) == SCREE_OK);
    if (trouble.text[0]) printf("%s\n", trouble.text);
    scree_body_state one = state_of(scene, "one"), two = state_of(scene, "two, \"2\"");
    CHECK(one.position[2] == 0.5 && one.velocity[1] == 2.0 && two.position[0] == 1.0);
    NEAR(one.spin[2], 6.0, 6.0 * 4e-16); /* through the angular momentum and back */
    CHECK(scree_scene_body_shape(scene, 1).radius == 0.2);
    CHECK(strcmp(scree_scene_body_material(scene, 1), "glass") == 0);
    scree_scene_destroy(scene);

    CHECK(read_table("x,y,z\n0,0,0\n1,0,0\n", "radius = 0.1\nmaterial = \"glass\"\njoint = \"fixed\"\nname = \"s\"\n",
                     &scene, &trouble) == SCREE_OK);
    CHECK(scree_scene_find_body(scene, "s 2") == 1 && !scree_scene_body_moves(scene, 1));
    scree_scene_destroy(scene);
}

static void test_bad_tables(void) {
    static const char more[] = "radius = 0.1\nmaterial = \"glass\"\n";
    static const struct {
        const char *table, *lines, *message;
    } cases[] = {
        {"x,y,z\n0,0,0\n1,0,zero\n", more, ".csv:3:5: \"zero\" is no number"},
        {"x,y,z\n0,0,0\n\n1,0\n", more, ".csv:4:1: wrong number of columns"},
        {"x,y\n0,0\n", more, ".csv:1:1: the table needs the column z_m"},
        {"x,y,z,rdius\n0,0,0,1\n", more, ".csv:1:7: there is no column \"rdius\""},
        {"x,y,z,rdius\n0,0,0,1\n", more, "did you mean \"radius\"?"},
        {"x,y,z,x_m\n0,0,0,1\n", more, ".csv:1:7: two columns for x_m"},
        {"x,y,z,vx\n0,0,0,1\n", more, "of vx_m_s, vy_m_s, vz_m_s the table needs all or none"},
        {"x,y,z\n", more, "this table has no rows"},
        {"", more, "this table is empty"},
        {"x,y,z,radius\n0,0,0,1\n", more, "has a column radius_m already"},
        {"x,y,z\n0,0,0\n", "material = \"glass\"\n", "need radius = …"},
        {"x,y,z\n0,0,0\n", "radius = 1\n", "need material = …"},
        {"x,y,z,radius,material\n0,0,0,1,glass\n5,0,0,1,glas\n", "",
         ".csv:3:9: there is no material called \"glas\"; did you mean \"glass\"?"},
        {"x,y,z,radius,material\n0,0,0,1,glass\n5,0,0,-1,glass\n", "", ".csv:3:1: body \"sphere 2\": "},
        {"x,y,z,radius,material,mass\n0,0,0,1,glass,0\n5,0,0,1,glass,-1\n", "",
         ".csv:3:1: the mass of body \"sphere 2\" must be > 0 kg"},
        {"name,x,y,z\na,0,0,0\n# more\na,1,0,0\n", more, ".csv:4:1: there are two of the body \"a\""},
        {"name,x,y,z\na,0,0,0\n", "radius = 0.1\nmaterial = \"glass\"\nname = \"b\"\n", "column of names already"},
        {"x,y,z\n0,0,0\n0.05,0,0\n", more, "\"sphere 1\" and \"sphere 2\" overlap by 0.15 m at the start"},
        {"x,y,z\n0,0,0\n", "radus = 0.1\n", "unknown key \"radus\" in [[spheres]]; did you mean \"radius\"?"},
    };
    for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++) {
        scree_scene *scene;
        scree_trouble trouble = {0};
        CHECK(read_table(cases[k].table, cases[k].lines, &scene, &trouble) == SCREE_BAD_INPUT);
        CONTAINS(trouble.text, cases[k].message);
    }
}

static void test_bad_generators(void) {
    static const struct {
        const char *text, *message;
    } cases[] = {
        {HEAD LATTICE "spacing = 0\n", "spacing must be > 0 m, got 0"},
        {HEAD LATTICE "spacing = 0.0019\n", "points of \"grain\" come as close as 0.0019 m"},
        {HEAD LATTICE "spacing = 0.0021\njitter = 1e-4\n", "they would overlap"},
        {HEAD LATTICE "count = 376\n", "has 375 points 0.002 m apart, too few for 376"},
        {HEAD LATTICE "count = 0.5\n", "count must be a whole number"},
        {HEAD LATTICE "distribution = \"mass\"\n", "a distribution needs two radii"},
        {HEAD "[[generate]]\nname = \"g\"\nkind = \"pour\"\nmaterial = \"glass\"\n", "one of \"lattice\", \"random\""},
        {HEAD "[[generate]]\nname = \"g\"\nkind = \"lattice\"\nmaterial = \"glass\"\nradius = 1\n",
         "corners of its box"},
        {HEAD "[[generate]]\nname = \"g\"\nkind = \"lattice\"\nmaterial = \"glass\"\nradius = 1\nmin = [0, 0, 0]\n"
              "max = [2, 1, 2]\n",
         "is 1 m wide along y: a sphere of radius 1 m doesn't fit"},
        {HEAD "[[generate]]\nname = \"g\"\nkind = \"lattice\"\nmaterial = \"glass\"\nradius = 1e-6\nmin = [0, 0, 0]\n"
              "max = [2, 1, 2]\n",
         "a scene has at most"},
        {HEAD "[[generate]]\nname = \"g\"\nkind = \"random\"\nmaterial = \"glass\"\nradius = 1e-6\nmin = [0, 0, 0]\n"
              "max = [2, 1, 2]\ncount = 2000000000\n",
         "this machine has"},
        {HEAD "[[generate]]\nname = \"g\"\nkind = \"random\"\nmaterial = \"glass\"\nradius = 0.1\nmin = [0, 0, 0]\n"
              "max = [1, 1, 1]\ncount = 150\n",
         "of 150 spheres found room, which fill 0."},
        {HEAD "[[generate]]\nname = \"g\"\nkind = \"random\"\nmaterial = \"glass\"\nradius = 0.1\nmin = [0, 0, 0]\n"
              "max = [1, 1, 1]\ncount = 300\n",
         "300 spheres would fill 1.26 of the box"},
        {HEAD "[[body]]\nname = \"far\"\nmaterial = \"glass\"\nshape = { sphere = 0.001 }\nposition = [0, 1e8, 0]\n",
         "\"far\" is so far from the origin (1e+08 m along y)"},
        {HEAD "[[generate]]\nname = \"g\"\nkind = \"random\"\nmaterial = \"glass\"\nradius = 0.1\nmin = [0, 0, 0]\n"
              "max = [1, 1, 1]\n",
         "needs the count of its spheres"},
        {HEAD
         "[[generate]]\nname = \"g\"\nkind = \"lattice\"\nmaterial = \"glass\"\nradius = 1e-10\nmin = [0, 0, 0]\n"
         "max = [1e300, 2e-10, 1]\nspacing = 3e-10\n", /* infinitely many points along one axis, none along another */
         "too few for 1 spheres"},
        {HEAD RANDOM "jitter = 0.1\n", "only a lattice has jitter"},
        {HEAD LATTICE LATTICE, "there are two of the body \"grain 1\""},
    };
    for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++) {
        scree_scene *scene;
        scree_trouble trouble = {0};
        CHECK(read_text(cases[k].text, &scene, &trouble) != SCREE_OK);
        CONTAINS(trouble.text, cases[k].message);
        CONTAINS(trouble.text, "test.toml:");
    }
}

/* Spheres in the C API; a bad one leaves the scene as it was. */
static void test_api(void) {
    scree_scene *scene = scree_scene_create();
    int material, first = -1;
    CHECK(!scree_scene_add_material(scene, &(scree_material_def){.name = "m", .density = 1000}, &material));
    double at[3][3] = {{0, 0, 0}, {1, 0, 0}, {NAN, 0, 0}};
    scree_spheres_def def = {
        .name = "s", .material = material, .count = 3, .positions = (const double(*)[3])at, .radius = 0.1};
    CHECK(scree_scene_add_spheres(scene, &def, &first) == SCREE_BAD_INPUT && scree_scene_trouble(scene)->body == 2);
    CHECK(scree_scene_bodies(scene) == 0 && scree_scene_find_body(scene, "s 1") == -1);
    at[2][0] = 2.0;
    CHECK(scree_scene_add_spheres(scene, &def, &first) == SCREE_OK && first == 0);
    CHECK(scree_scene_add_body(scene, &(scree_body_def){.name = "last", .shape = {.radius = 1}, .position = {9, 0, 0}},
                               &first) == SCREE_OK);
    CHECK(first == 3 && scree_scene_find_body(scene, "s 3") == 2 && scree_scene_find_body(scene, "last") == 3);
    CHECK(scree_scene_body(scene, 2).position[0] == 2.0 && scree_scene_body(scene, 3).position[0] == 9.0);
    CHECK(strcmp(scree_scene_body_name(scene, 1).text, "s 2") == 0 && scree_scene_body_shape(scene, 3).radius == 1.0);
    CLOSE(scree_scene_body_mass(scene, 0), 1000 * 4.0 / 3.0 * 3.14159265358979323846 * 1e-3, 1e-15);
    def.count = 0;
    CHECK(scree_scene_add_spheres(scene, &def, &first) == SCREE_BAD_INPUT);
    def.count = 3;
    def.positions = NULL;
    CHECK(scree_scene_add_spheres(scene, &def, &first) == SCREE_BAD_INPUT);
    CONTAINS(scree_scene_trouble(scene)->text, "needs positions");
    scree_scene_destroy(scene);
}

/* Names that count on, in runs of every kind, and others between them; each is found under its number, and the other
 * way round. */
static void test_names(void) {
    enum { MANY = 4000 };
    static const char *const odd[] = {"a", "", "0", "00", "007", "a 0", "a 00", "a0999999998", "9999999999", "12 kg"};
    static char all[MANY][32];
    struct scree_names names = {0};
    uint64_t seed = 5;
    long number = 0;
    int count = 0;
    while (count < MANY) {
        char stem[24];
        const char *begin = odd[(int)check_between(&seed, 0, 9.99)];
        snprintf(stem, sizeof stem, "%s%d", begin, (int)check_between(&seed, 0, 3));
        if (check_between(&seed, 0, 1) < 0.5) stem[strlen(stem) - 1] = 0;
        if (check_between(&seed, 0, 1) < 0.5) number = (long)check_between(&seed, 0, 1200);
        int run = 1 + (int)check_between(&seed, 0, 150);
        for (int k = 0; k < run && count < MANY; k++, number++) {
            snprintf(all[count], sizeof *all, "%s%ld", stem, number);
            int known = scree_names_find(&names, all[count]), seen = 0;
            while (seen < count && strcmp(all[seen], all[count]) != 0) seen++;
            CHECK(known == (seen < count ? seen : -1));
            if (seen < count) continue;
            CHECK(scree_names_add(&names, all[count]) == 0);
            count++;
        }
    }
    for (int left = MANY; left > 0; left -= 777) {
        scree_names_cut(&names, left);
        CHECK(names.count == left);
        for (int k = 0; k < MANY; k++) {
            CHECK(scree_names_find(&names, all[k]) == (k < left ? k : -1));
            if (k < left) CHECK(strcmp(scree_names_at(&names, k).text, all[k]) == 0);
        }
    }
    CHECK(scree_names_find(&names, "b") == -1 && scree_names_add(&names, "b") == 0);
    CHECK(strcmp(scree_names_at(&names, names.count - 1).text, "b") == 0);
    scree_names_free(&names);
}

/* The longest name, and one that is longer. */
static void test_long_names(void) {
    scree_scene *scene = scree_scene_create();
    char name[SCREE_NAME_LENGTH + 2];
    memset(name, 'x', sizeof name);
    name[SCREE_NAME_LENGTH + 1] = 0;
    CHECK(!scree_scene_add_material(scene, &(scree_material_def){.name = "m", .density = 1000}, NULL));
    CHECK(scree_scene_add_body(scene, &(scree_body_def){.name = name, .shape = {.radius = 1}}, NULL) ==
          SCREE_BAD_INPUT);
    CONTAINS(scree_scene_trouble(scene)->text, "at most 255 bytes");
    CONTAINS(scree_scene_trouble(scene)->text, "has 256");
    CHECK(scree_scene_add_body(scene, &(scree_body_def){.name = name + 1, .shape = {.radius = 1}}, NULL) == SCREE_OK);
    CHECK(strcmp(scree_scene_body_name(scene, 0).text, name + 1) == 0 && scree_scene_find_body(scene, name + 1) == 0);
    scree_scene_destroy(scene);
}

/* ---- periodic domains ---- */

/* Balls that fly to and fro in a box of 0.05 x 0.03 x 0.04 m, periodic along `axes`; radii differ by up to `ratio`. */
static char *gas_text(const char *axes, int count, double ratio, uint64_t *seed, const char *more) {
    static char text[8192];
    double least = 0.004 / ratio;
    snprintf(text, sizeof text,
             "[time]\nintegrator = \"verlet\"\nend = 1.0\nstep = 2e-5\n%s[domain]\nmin = [-0.01, 0.02, 0]\nmax = "
             "[0.04, 0.05, 0.04]\nperiodic = "
             "[%s]\n"
             "[[material]]\nname = \"m\"\ndensity = 2000\n[[contact]]\nbetween = [\"m\", \"m\"]\n"
             "normal = { law = \"linear\", stiffness = 2e3, restitution = 0.9 }\n"
             "friction = { law = \"coulomb\", static = 0.3, kinetic = 0.3, stiffness = 1e3 }\n"
             "[[generate]]\nname = \"g\"\nkind = \"random\"\nmaterial = \"m\"\nradius = [%.9g, 0.004]\n"
             "distribution = \"mass\"\nmin = [-0.01, 0.02, 0]\nmax = [0.04, 0.05, 0.04]\ncount = %d\nseed = %d\n",
             more, axes, least, count, (int)check_between(seed, 0, 1e6));
    return text;
}

/* Give every body a velocity, before the first step. */
static void stir(scree_scene *scene, uint64_t *seed, double speed) {
    for (int k = 0; k < scene->bodies.count; k++)
        for (int axis = 0; axis < 3; axis++) scene->bodies.state[k].v[axis] = check_between(seed, -speed, speed);
}

/* Overlaps of all pairs with all images up to two periods off, by brute force, summed; their number, and that of those
 * across the border. */
static double brute_overlaps(const scree_scene *scene, int *count, long *across) {
    const struct scree_bodies *bodies = &scene->bodies;
    double sum = 0.0;
    *count = 0;
    for (int i = 0; i < bodies->count; i++)
        for (int j = 0; j < i; j++)
            for (int image = 0; image < 125; image++) {
                int n[3] = {image % 5 - 2, image / 5 % 5 - 2, image / 25 - 2};
                double d2 = 0.0, reach = bodies->record[i].radius + bodies->record[j].radius;
                int there = 1;
                for (int axis = 0; axis < 3; axis++) {
                    double d = bodies->position[i][axis] - bodies->position[j][axis] + n[axis] * bodies->period[axis];
                    d2 += d * d;
                    there &= bodies->period[axis] > 0.0 || n[axis] == 0;
                }
                if (!there || !(d2 < reach * reach)) continue;
                (*count)++;
                *across += n[0] || n[1] || n[2];
                sum += reach - sqrt(d2);
            }
    return sum;
}

/* No contact is missed and none is invented, whatever the axes, sizes and times between lists. */
static void test_periodic_contacts(void) {
    static const char *const axes[] = {"\"x\"", "\"y\", \"z\"", "\"x\", \"y\", \"z\"", "\"z\""};
    uint64_t seed = 11;
    long met = 0, images = 0;
    for (int trial = 0; trial < 24; trial++) {
        int wide = trial % 3 == 2;
        scree_scene *scene = scene_from(gas_text(axes[trial % 4], wide ? 300 : 80, wide ? 8.0 : 1.5, &seed, ""),
                                        (const char *const[]){wide ? "time.step=4e-6" : "time.step=2e-5"}, 1, 1);
        stir(scene, &seed, wide ? 0.3 : 2.0);
        /* Bodies leave where nothing holds them: only while they are near are there contacts. */
        for (int look = 0; look < 12; look++) {
            go(scene, wide ? 397 : 97);
            int expected, count, found = 0;
            double sum = brute_overlaps(scene, &expected, &images), listed = 0.0;
            CHECK(scree_scene_contacts(scene, NULL, 0, &count) == SCREE_OK);
            scree_contact_state *contacts = calloc((size_t)count + 1, sizeof *contacts);
            CHECK(scree_scene_contacts(scene, contacts, count, &found) == SCREE_OK && found == expected);
            for (int k = 0; k < count; k++) listed += contacts[k].overlap;
            /* Places to 1e-16 x 0.05 m a coordinate, a few of them a contact. */
            NEAR(listed, sum, 1e-16 * (count + 1));
            free(contacts);
            met += expected;
        }
        scree_scene_destroy(scene);
    }
    CHECK(met > 500 && images > 50); /* the test sees what it is about */
}

/* Moving the whole scene by some of the box (and so other pairs across its border) changes nothing but rounding: the
 * same impacts, contact memory carried across the border. */
static void test_periodic_shift(void) {
    uint64_t seed = 5;
    static const char *const verlet[] = {"time.step=1e-5"}, *const impulses[] = {"time.step=1e-5",
                                                                                 "time.integrator=\"pair-impulse\""};
    for (int method = 0; method < 2; method++) {
        scree_scene *scene[2];
        char *text = gas_text("\"x\", \"y\", \"z\"", 40, 1.2, &seed, "");
        uint64_t same = seed;
        for (int s = 0; s < 2; s++) {
            seed = same;
            scene[s] = scene_from(text, method ? impulses : verlet, method ? 2 : 1, 1);
            stir(scene[s], &seed, 0.5);
            for (int k = 0; s && k < scene[s]->bodies.count; k++) {
                for (int axis = 0; axis < 3; axis++) {
                    double way = (0.3 + 0.2 * axis) * scene[s]->bodies.period[axis];
                    scene[s]->bodies.position[k][axis] += way;
                    scene[s]->bodies.record[k].x[axis] += way;
                }
            }
            scene[s]->contacts.broken = 1; /* new lists */
        }
        long seen = 0;
        for (int look = 0; look < 30; look++) {
            for (int s = 0; s < 2; s++) {
                go(scene[s], 100);
                for (int b = 0; b < scene[s]->contacts.batches; b++)
                    if (scene[s]->contacts.batch[b].geometry == SCREE_BALL_IMAGE)
                        seen += scene[s]->contacts.batch[b].count;
            }
        }
        double worst = 0.0;
        for (int k = 0; k < scene[0]->bodies.count; k++) {
            const double *v = scene[0]->bodies.state[scene[0]->bodies.place[k]].v,
                         *other = scene[1]->bodies.state[scene[1]->bodies.place[k]].v;
            for (int axis = 0; axis < 3; axis++) worst = scree_most(worst, fabs(v[axis] - other[axis]));
        }
        CHECK(seen > 50); /* lists hold what is near at the moment: an image or so a look */
        /* Rounding of places (1e-17 m) grows by some 10 for each impact, of which a ball has three or four. */
        CHECK(worst < 1e-9);
        scree_scene_destroy(scene[0]);
        scree_scene_destroy(scene[1]);
    }
}

/* A ball that slides down an endless plane through several periods: energy books close, the position stays inside, a
 * restored run goes on with the same bits, across a return into the box too. */
static void test_periodic_slide(void) {
    const char *text =
        "gravity = [5, 0, -8.5]\n[time]\nintegrator = \"verlet\"\nend = 1.0\nstep = 5e-5\n[domain]\nmin = [0, -1, "
        "-1]\nmax = [0.05, 1, 1]\n"
        "periodic = [\"x\"]\n[[material]]\nname = \"m\"\ndensity = 2000\n[[contact]]\nbetween = [\"m\", \"m\"]\n"
        "normal = { law = \"linear\", stiffness = 2e3, restitution = 0.5 }\n"
        "friction = { law = \"coulomb\", static = 0.1, kinetic = 0.1, stiffness = 1e3 }\n"
        "[[body]]\nname = \"slope\"\nmaterial = \"m\"\nshape = { plane = true }\njoint = \"fixed\"\n"
        "[[body]]\nname = \"ball\"\nmaterial = \"m\"\nshape = { sphere = 0.005 }\nposition = [0.02, 0, 0.005]\n"
        "[[body]]\nname = \"other\"\nmaterial = \"m\"\nshape = { sphere = 0.005 }\nposition = [0.04, 0, 0.005]\n"
        "[output]\nwrite = [\"energy.csv\"]\n";
    scree_scene *scene = scene_from(text, NULL, 0, 1), *again = scene_from(text, NULL, 0, 1);
    FILE *file = tmpfile();
    go(scene, 3000);
    CHECK(scree_scene_save(scene, file, "state") == SCREE_OK);
    rewind(file);
    CHECK(scree_scene_restore(again, file, "state") == SCREE_OK);
    fclose(file);
    go(scene, 9000);
    go(again, 9000);
    CHECK(scree_scene_hash(scene) == scree_scene_hash(again));
    scree_energy energy;
    CHECK(scree_scene_energy(scene, &energy) == SCREE_OK);
    /* g sin slope less friction, 0.6 s: 4.15 x 0.36/2 m, 15 periods. Books lack what fixed steps lack elsewhere. */
    CHECK(scene->carried[0] > 2 * 10 * 0.05 * scree_scene_body_mass(scene, 1));
    CHECK(fabs(energy.balance) < 1e-4 * energy.kinetic);
    double x = state_of(scene, "ball").position[0];
    CHECK(x >= 0.0 && x < 0.05);
    scree_scene_destroy(scene);
    scree_scene_destroy(again);
}

/* The same bits for any number of threads, and lists made at other times. */
static void test_periodic_bits(void) {
    uint64_t seed = 21;
    char *text = gas_text("\"x\", \"y\"", 200, 3.0, &seed, "");
    uint64_t hash = 0;
    for (int variant = 0; variant < 3; variant++) {
        uint64_t same = 77;
        scree_scene *scene = scene_from(text, (const char *const[]){"time.force=true"}, 1, variant == 1 ? 3 : 1);
        if (variant == 2) scene->contacts.skin *= 0.7;
        stir(scene, &same, 1.0);
        go(scene, 3000);
        if (variant == 0) hash = scree_scene_hash(scene);
        CHECK(scree_scene_hash(scene) == hash);
        scree_scene_destroy(scene);
    }
}

/* Grains over a layer of fixed ones, so many that they lie in slabs, pressed down and flung along both periodic
 * axes. */
static scree_scene *crowd(int threads) {
    uint64_t seed = 31;
    scree_scene *scene = scene_from(
        "gravity = [0, 0, -300]\n[time]\nintegrator = \"verlet\"\nend = 1.0\nstep = 1e-5\n[domain]\nmin = [-0.01, "
        "0.02, -1]\n"
        "max = [0.04, 0.05, 1]\nperiodic = [\"x\", \"y\"]\n[[material]]\nname = \"m\"\ndensity = 2000\n"
        "[[contact]]\nbetween = [\"m\", \"m\"]\nnormal = { law = \"linear\", stiffness = 1e4, restitution = 0.8 }\n"
        "friction = { law = \"coulomb\", static = 0.3, kinetic = 0.3, stiffness = 5e3 }\n"
        "[[generate]]\nname = \"base\"\nkind = \"lattice\"\nmaterial = \"m\"\nradius = 0.001\n"
        "min = [-0.01, 0.02, 0]\nmax = [0.04, 0.05, 0.002]\nspacing = 0.002\njoint = \"fixed\"\n"
        "[[generate]]\nname = \"grain\"\nkind = \"lattice\"\nmaterial = \"m\"\nradius = [0.0008, 0.001]\nseed = 2\n"
        "min = [-0.01, 0.02, 0.002]\nmax = [0.04, 0.05, 0.012]\nspacing = 0.00205\n",
        (const char *const[]){"time.force=true"}, 1, threads);
    for (int k = 0; k < scene->bodies.count; k++) {
        int place = scene->bodies.place[k];
        if (scene->bodies.class[place] == SCREE_CLASS_FIXED) continue;
        for (int axis = 0; axis < 3; axis++)
            scene->bodies.state[place].v[axis] = check_between(&seed, -1.0, 1.0) + (axis == 0 ? 3.0 : axis == 1);
    }
    return scene;
}

/* Overlaps of all grains, of the nearest images, by brute force. */
static double brute_nearest(const scree_scene *scene, int *count) {
    const struct scree_bodies *bodies = &scene->bodies;
    double sum = 0.0;
    *count = 0;
    for (int i = 0; i < bodies->count; i++)
        for (int j = 0; j < i; j++) {
            if (bodies->class[i] == SCREE_CLASS_FIXED && bodies->class[j] == SCREE_CLASS_FIXED) continue;
            double gap = distance_between(bodies, bodies->position[i], bodies->position[j]) - bodies->record[i].radius -
                         bodies->record[j].radius;
            sum += gap < 0.0 ? -gap : 0.0;
            *count += gap < 0.0;
        }
    return sum;
}

static void check_crowd(scree_scene *scene) {
    int expected, count, found = 0;
    double sum = brute_nearest(scene, &expected), listed = 0.0;
    CHECK(scree_scene_contacts(scene, NULL, 0, &count) == SCREE_OK);
    scree_contact_state *contacts = calloc((size_t)count + 1, sizeof *contacts);
    CHECK(scree_scene_contacts(scene, contacts, count, &found) == SCREE_OK && found == expected && expected > 100);
    for (int k = 0; k < count; k++) listed += contacts[k].overlap;
    NEAR(listed, sum, 1e-16 * (count + 1)); /* places to 1e-16 x 0.05 m a coordinate, a few of them a contact */
    free(contacts);
}

/* All that is kept of contacts; and how many of them are kept something of. */
static double all_kept(const scree_scene *scene, int *count) {
    double sum = 0.0;
    *count = 0;
    for (int b = 0; b < scene->contacts.batches; b++) {
        const struct scree_batch *batch = &scene->contacts.batch[b];
        for (int k = scree_first(batch); k >= 0; k = scree_next(batch, k)) {
            double kept = 0.0;
            for (int m = 0; m < SCREE_MEMORY; m++) kept += fabs(scree_kept(batch, m, k));
            *count += kept > 0.0;
            sum += kept;
        }
    }
    return sum;
}

/* Bodies return into the box: what is kept of contacts follows them. */
static void check_memory(scree_scene *scene) {
    int before, after, expected, count;
    double kept = all_kept(scene, &before);
    CHECK(scree_contacts_return(&scene->contacts, &scene->bodies, 1, &scene->trouble) == SCREE_OK);
    CHECK(scene->contacts.returns > 100);
    NEAR(all_kept(scene, &after), kept, 1e-13 * kept); /* some hundred numbers in another order */
    CHECK(before == after && before > 50);
    brute_nearest(scene, &expected);
    CHECK(scree_scene_contacts(scene, NULL, 0, &count) == SCREE_OK && count == expected);
}

/* Slabs across a border: no contact is missed; the same bits for any number of threads, with breaks and lists at other
 * times, from a state that was saved, whether memory is asked for ahead or not. */
static void test_periodic_slabs(void) {
    enum { ALL = 1200, PART = 512 }; /* before bodies return */
    scree_scene *scene[4];
    for (int variant = 0; variant < 4; variant++) {
        scene[variant] = crowd(variant == 1 ? 3 : 1);
        scene[variant]->contacts.cached = variant % 2 ? 0 : INT_MAX;
    }
    CHECK(scene[0]->bodies.order.slabs >= 4);
    go(scene[0], PART);
    check_crowd(scene[0]);
    FILE *file = tmpfile();
    CHECK(scree_scene_save(scene[0], file, "state") == SCREE_OK);
    rewind(file);
    CHECK(scree_scene_restore(scene[3], file, "state") == SCREE_OK);
    go(scene[0], ALL - PART);
    go(scene[1], ALL);
    go(scene[3], ALL - PART);
    for (int k = 0; k < ALL; k++) {
        for (int j = 0; k % 37 == 0 && j < scene[2]->bodies.count; j++) scene[2]->bodies.path[j] = HUGE_VAL;
        go(scene[2], 1);
    }
    check_crowd(scene[0]);
    for (int variant = 1; variant < 4; variant++) CHECK(scree_scene_hash(scene[variant]) == scree_scene_hash(scene[0]));
    CHECK(scene[0]->carried[0] > 0.0 && scene[0]->carried[1] > 0.0);
    rewind(file);
    CHECK(scree_scene_restore(scene[3], file, "state") == SCREE_OK);
    fclose(file);
    check_memory(scene[3]);
    for (int variant = 0; variant < 4; variant++) scree_scene_destroy(scene[variant]);
}

/* So many that bodies are sorted in space and threads share the work: the same bits, and no contact missed. */
static void test_periodic_many(void) {
    const char *text = "[time]\nintegrator = \"verlet\"\nend = 1.0\nstep = 2e-5\n[domain]\nmin = [0, 0, 0]\nmax = "
                       "[0.092, 0.0552, 0.0552]\n"
                       "periodic = [\"x\", \"y\", \"z\"]\n[[material]]\nname = \"m\"\ndensity = 2000\n"
                       "[[contact]]\nbetween = [\"m\", \"m\"]\n"
                       "normal = { law = \"linear\", stiffness = 500, restitution = 0.9 }\n"
                       "friction = { law = \"coulomb\", static = 0.3, kinetic = 0.3, stiffness = 300 }\n"
                       "[[generate]]\nname = \"g\"\nkind = \"lattice\"\nmaterial = \"m\"\nradius = 0.002\n"
                       "min = [0, 0, 0]\nmax = [0.092, 0.0552, 0.0552]\nspacing = 0.0046\njitter = 3e-4\n";
    uint64_t hash = 0;
    for (int threads = 1; threads <= 3; threads += 2) {
        uint64_t seed = 3;
        scree_scene *scene = scene_from(text, NULL, 0, threads);
        CHECK(scree_scene_bodies(scene) == 20 * 12 * 12);
        stir(scene, &seed, 1.0);
        go(scene, 1300); /* across two returns into the box, 26 mm a body */
        if (threads == 1) hash = scree_scene_hash(scene);
        CHECK(scree_scene_hash(scene) == hash);
        int count, expected = 0;
        const struct scree_bodies *bodies = &scene->bodies;
        for (int i = 0; i < bodies->count; i++)
            for (int j = 0; j < i; j++) {
                double reach = bodies->record[i].radius + bodies->record[j].radius;
                expected += distance_between(bodies, bodies->position[i], bodies->position[j]) < reach;
            }
        CHECK(scree_scene_contacts(scene, NULL, 0, &count) == SCREE_OK && count == expected && count > 300);
        scree_scene_destroy(scene);
    }
}

/* Spheres a and b and 200 others, in lists that look ahead over their flights; velocities of a, of b, and of the
 * others, which lead these apart. */
static scree_scene *in_flight(const char *domain, const char *a, const char *b, double v[3][3]) {
    char text[2048];
    snprintf(
        text, sizeof text,
        "[time]\nintegrator = \"verlet\"\nend = 1.0\nstep = 5e-6\n%s[[material]]\nname = \"m\"\ndensity = 2000\n"
        "[[contact]]\nbetween = [\"m\", \"m\"]\nnormal = { law = \"linear\", stiffness = 2e3, restitution = 0.9 }\n"
        "[[body]]\nname = \"a\"\nshape = { sphere = 0.002 }\nmaterial = \"m\"\n%s\n"
        "[[body]]\nname = \"b\"\nshape = { sphere = 0.002 }\nmaterial = \"m\"\n%s\n"
        "[[generate]]\nname = \"g\"\nkind = \"lattice\"\nmaterial = \"m\"\nradius = 0.002\nspacing = 0.01\n"
        "count = 200\nmin = [0.02, 0, 0]\nmax = [0.08, 0.1, 0.1]\n",
        domain, a, b);
    scree_scene *scene = scene_from(text, NULL, 0, 1);
    struct scree_bodies *bodies = &scene->bodies;
    for (int k = 0; k < bodies->count; k++) {
        int number = bodies->number[k];
        double *own = bodies->state[k].v;
        memcpy(own, v[number < 2 ? number : 2], 3 * sizeof(double));
        if (number >= 2 && number % 2) own[2] = -own[2];
        memcpy(bodies->record[k].v, own, sizeof bodies->record[k].v);
    }
    CHECK(scree_contacts_list(&scene->contacts, bodies, 1, NULL) == SCREE_OK && bodies->flight);
    return scene;
}

/* They are in contact when a and b, which come nearer at a speed, have closed a gap, and not before. */
static void check_meeting(scree_scene *scene, double gap, double speed) {
    long steps = lround(gap / speed / scene->step);
    int count = 1;
    go(scene, steps - 2);
    CHECK(scree_scene_contacts(scene, NULL, 0, &count) == SCREE_OK && count == 0);
    go(scene, 4);
    CHECK(scree_scene_contacts(scene, NULL, 0, &count) == SCREE_OK && count == 1);
    scree_scene_destroy(scene);
}

/* Two that fly at each other across the border, twice as fast as all others, and so far apart that they meet only by
 * what flights lead beyond the skin. */
static void test_periodic_flights(void) {
    double v[3][3] = {{-2.0, 0.0, 0.0}, {2.0, 0.0, 0.0}, {0.0, 0.0, 1.0}}, gap = 0.0025;
    scree_scene *scene = in_flight("[domain]\nmin = [0, 0, 0]\nmax = [0.1, 0.1, 0.1]\nperiodic = [\"x\"]\n",
                                   "position = [0.00325, 0.05, 0.05]", "position = [0.09675, 0.05, 0.05]", v);
    CHECK(scene->contacts.skin < gap && gap < 4.0 * scene->contacts.flights.last);
    check_meeting(scene, gap, 4.0);
}

/* The same without a border, in cells that would lie apart if these were made for the skin alone: 6 mm wide. */
static void test_flights_from_afar(void) {
    double v[3][3] = {{2.0, 0.0, 0.0}, {-2.0, 0.0, 0.0}, {0.0, 0.0, 1.0}};
    check_meeting(in_flight("", "position = [0.0058, 0.15, 0.15]", "position = [0.0123, 0.15, 0.15]", v), 0.0025, 4.0);
}

/* One that flies at what stands still, among others that go the same way: forty times as fast as these fly apart. */
static void test_flight_at_fixed(void) {
    double v[3][3] = {{2.0, 0.0, 0.0}, {0.0, 0.0, 0.0}, {2.0, 0.0, 0.05}};
    scree_scene *scene =
        in_flight("", "position = [0.1, 0.05, 0.15]", "position = [0.112, 0.05, 0.15]\njoint = \"fixed\"", v);
    check_meeting(scene, 0.008, 2.0);
}

/* Two pass each other as fast as flights do, touched until just before the step, and nothing is left of their margins:
 * what acts in the step still is near. Half a step ago they were 2e-9 m in each other as they part now, but on a
 * straight way farther apart than that by (w h)^2/(8 d) = 1.1e-8 m, for which lists allow (flights.bend). */
static void check_passing(const char *domain, const char *a, const char *b, enum scree_geometry geometry) {
    double v[3][3] = {{-0.1, 1.9, 0.0}, {0.1, -1.9, 0.0}, {0.0, 0.0, 1.0}};
    scree_scene *scene = in_flight(domain, a, b, v);
    struct scree_contacts *contacts = &scene->contacts;
    struct scree_bodies *bodies = &scene->bodies;
    const struct scree_batch *batch = scree_batch_for(contacts, contacts->rule, geometry);
    struct scree_contact pair[SCREE_LANES];
    for (int lane = 0; lane < SCREE_LANES; lane++) pair[lane] = scree_contact_at(batch, scree_first(batch));
    int ball = pair[0].ball, host = pair[0].host;
    CHECK(batch->count == 1 && bodies->number[ball] < 2 && bodies->number[host] < 2);
    double closing = -0.2, overlap = 0.5 * closing * scene->step + 2e-9;
    double side = bodies->state[ball].v[0] > 0.0 ? 1.0 : -1.0, distance = 2.0 * 0.002 - overlap;
    struct vec apart = scree_apart(bodies, &pair[0], geometry), wanted = vec(side * distance, 0.0, 0.0);
    vec_store(vec_add(vec_from(bodies->record[ball].x), vec_sub(wanted, apart)), bodies->record[ball].x);
    bodies->path[ball] = bodies->path[host] = 0.5 * contacts->skin;
    CHECK(scree_share_of(scree_half_steps_in(overlap, closing, scene->step)) > 0.0);
    for (int straight = 0; straight < 2; straight++) {
        if (straight) contacts->flights.bend = 0.0;
        CHECK(scree_contact_is_near(contacts, bodies, batch, &pair[0]) == !straight);
        int judged = geometry != SCREE_BALL_BALL || (contacts->loop->judge(contacts, bodies, pair, 1) & 1) == !straight;
        CHECK(judged);
    }
    scree_scene_destroy(scene);
}

static void test_passing(void) {
    check_passing("", "position = [0.1, 0.15, 0.15]", "position = [0.1040005, 0.15, 0.15]", SCREE_BALL_BALL);
    check_passing("[domain]\nmin = [0, 0, 0]\nmax = [0.1, 0.1, 0.1]\nperiodic = [\"x\"]\n",
                  "position = [0.0979998, 0.05, 0.05]", "position = [0.0020002, 0.05, 0.05]", SCREE_BALL_IMAGE);
}

static const char belt_text[] =
    "[time]\nintegrator = \"verlet\"\nend = 1.0\nstep = 1e-4\n[domain]\nmin = [0, -1, -1]\nmax = [0.05, 1, "
    "1]\nperiodic = [\"x\"]\n"
    "[[material]]\nname = \"m\"\n[[contact]]\nbetween = [\"m\", \"m\"]\n"
    "normal = { law = \"linear\", stiffness = 1.0, damping = 0 }\n"
    "friction = { law = \"coulomb\", static = 1e3, kinetic = 1e3, stiffness = 1.0 }\n"
    "[[motion]]\nname = \"on\"\nkind = \"velocity\"\nvelocity = 1.0\n"
    "[[body]]\nname = \"heavy\"\nmaterial = \"m\"\nshape = { sphere = 0.005 }\nmass = 1e9\n"
    "position = [0.04, 0, 0]\n"
    "[[body]]\nname = \"belt\"\nmaterial = \"m\"\nshape = { sphere = 0.005 }\nposition = [0.001, 0, 0.0095]\n"
    "joint = { x = \"on\", others = \"fixed\" }\n";

static void test_periodic_drive(void) {
    scree_scene *scene = scene_from(belt_text, NULL, 0, 1);
    int count;
    for (int period = 0; period < 12; period++)
        for (int part = 0; part < 10; part++) {
            double x = 0.001 + 0.05 * part / 10.0; /* they touch within sqrt(0.01^2 - 0.0095^2) = 0.0031 m of 0.04 m */
            CHECK(scree_scene_contacts(scene, NULL, 0, &count) == SCREE_OK && count == (part == 8));
            NEAR(state_of(scene, "belt").position[0], x, 1e-12); /* the time is a sum of steps, up to 0.6 s */
            go(scene, 50);
        }
    scree_scene_destroy(scene);
    /* In touch since 40 steps when, after 512, bodies that are out of the domain return: what is driven has no way
     * back, and the spring between them is stretched by all of the way since the touch, but for the turning of the
     * normal. */
    static const char *const later[] = {"body.belt.position=[0.0389, 0, 0.0095]"};
    scree_contact_state contact;
    scene = scene_from(belt_text, later, 1, 1);
    go(scene, 520);
    CHECK(scree_scene_contacts(scene, &contact, 1, &count) == SCREE_OK && count == 1);
    NEAR(fabs(contact.friction[0]), 40 * 1e-4, 2e-4);
    scree_scene_destroy(scene);
}

/* A state belongs to where its domain begins, too, for there bodies return; and holds what those have carried off. */
static void test_states_of_domains(void) {
    static const char text[] =
        "[time]\nend = 1.0\nstep = 1e-3\nintegrator = \"verlet\"\n[domain]\nmin = [0, 0, 0]\nmax = [1, 1, 1]\n"
        "periodic = [\"x\"]\n[[material]]\nname = \"m\"\ndensity = 1000\n[[body]]\nname = \"ball\"\n"
        "shape = { sphere = 0.1 }\nmaterial = \"m\"\nposition = [0.5, 0.5, 0.5]\nvelocity = [1, 0, 0]\n";
    static const char *const moved[] = {"domain.min=[-0.1, 0, 0]", "domain.max=[0.9, 1, 1]"};
    scree_scene *scene = scene_from(text, NULL, 0, 1), *other = scene_from(text, moved, 2, 1);
    FILE *file = tmpfile();
    CHECK(scree_scene_save(scene, file, "file") == SCREE_OK);
    rewind(file);
    CHECK(scree_scene_restore(other, file, "file") == SCREE_BAD_INPUT);
    CONTAINS(scree_scene_trouble(other)->text, "what differs: periodic domain");
    scree_scene_destroy(other);
    other = scene_from(text, NULL, 0, 1);
    go(scene, 1100);
    rewind(file);
    CHECK(scree_scene_save(scene, file, "file") == SCREE_OK);
    rewind(file);
    CHECK(scree_scene_restore(other, file, "file") == SCREE_OK);
    CHECK(scene->carried[0] > 0.0 && other->carried[0] == scene->carried[0]);
    fclose(file);
    scree_scene_destroy(scene);
    scree_scene_destroy(other);
}

static void test_bad_domains(void) {
#define BALL "[[body]]\nname = \"ball\"\nmaterial = \"glass\"\nshape = { sphere = 0.1 }\n"
    static const struct {
        const char *text, *message;
    } cases[] = {
        {HEAD BALL "[domain]\nmin = [0, 0, 0]\nmax = [1, 1, 0.3]\nperiodic = [\"z\"]\n",
         "two diameters of the largest"},
        {HEAD BALL "position = [2, 0, 0]\n[domain]\nmin = [0, 0, 0]\nmax = [1, 1, 1]\n",
         "starts outside of the domain: its x is 2 m"},
        {HEAD BALL "[domain]\nmin = [0, 0, 0]\nmax = [1, 0, 1]\n", "must go up from min to max along y"},
        {HEAD BALL "[domain]\nmin = [0, 0, 0]\n", "needs its corners"},
        {HEAD BALL "[domain]\nmin = [0, 0, 0]\nmax = [1, 1, 1]\nperiodic = [\"w\"]\n", "one of \"x\", \"y\", \"z\""},
        {HEAD BALL "[domain]\nmin = [0, 0, 0]\nmax = [1, 1, 1]\nperiodic = \"x\"\n", "must be an array of axes"},
        {HEAD BALL "[domain]\nmin = [0, 0, 0]\nmax = [1, 1, 1]\nperiodc = [\"x\"]\n", "did you mean \"periodic\"?"},
        {HEAD "[[body]]\nname = \"box\"\nmaterial = \"glass\"\nshape = { box = [1, 1, 1] }\n"
              "[domain]\nmin = [0, 0, 0]\nmax = [9, 9, 9]\nperiodic = [\"x\"]\n",
         "body \"box\" is a box: only spheres and planes"},
        {HEAD BALL "[[body]]\nname = \"wall\"\nmaterial = \"glass\"\nshape = { plane = true }\njoint = \"fixed\"\n"
                   "[domain]\nmin = [0, 0, 0]\nmax = [1, 1, 1]\nperiodic = [\"z\"]\n",
         "plane \"wall\" cuts the axis z"},
    };
    for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++) {
        scree_scene *scene;
        scree_trouble trouble = {0};
        CHECK(read_text(cases[k].text, &scene, &trouble) == SCREE_BAD_INPUT);
        CONTAINS(trouble.text, cases[k].message);
        CONTAINS(trouble.text, "test.toml:");
    }
}

/* A tiny sphere in a huge box: the cells are as many as the bodies, not as the box has room for. */
static void test_tiny_in_huge(void) {
    scree_scene *scene =
        scene_from("[time]\nend = 1.0\nstep = 1e-3\n[domain]\nmin = [0, 0, 0]\nmax = [1e9, 1e9, 1e9]\nperiodic = "
                   "[\"x\", \"y\", \"z\"]\n"
                   "[[material]]\nname = \"m\"\ndensity = 1\n[[contact]]\nbetween = [\"m\", \"m\"]\n"
                   "normal = { law = \"linear\", stiffness = 1e-20, damping = 0 }\n"
                   "[[body]]\nname = \"a\"\nmaterial = \"m\"\nshape = { sphere = 1e-6 }\nposition = [5, 5, 5]\n"
                   "[[body]]\nname = \"b\"\nmaterial = \"m\"\nshape = { sphere = 1e6 }\nposition = [9e8, 5, 5]\n",
                   NULL, 0, 1);
    go(scene, 10);
    scree_scene_destroy(scene);
}

/* Spheres on a plane are met several at once, but one after the other where boxes' corners are met with them: no bit of
 * theirs tells which. */
static void check_beside_box(const char *integrator) {
    static const char spheres[] = HEAD
        "[[body]]\nname = \"slope\"\nshape = { plane = true }\nmaterial = \"glass\"\njoint = \"fixed\"\n"
        "position = [0.1, 0.2, 0.3]\norientation = { axis = [1, 2, 0], degrees = 7 }\n"
        "[[generate]]\nname = \"grain\"\nkind = \"lattice\"\nmaterial = \"glass\"\nradius = [0.0005, 0.001]\n"
        "min = [0, 0, 0.302]\nmax = [0.02, 0.02, 0.307]\nspacing = 0.0024\nseed = 1\nvelocity = [0.1, 0.2, -0.3]\n";
    static const char box[] =
        "[[body]]\nname = \"box\"\nshape = { box = [0.01, 0.01, 0.01] }\nmaterial = \"glass\"\n"
        "position = [0.2, 0.2, 0.297]\nvelocity = [0, 0, -0.5]\norientation = { axis = [1, 2, 0], degrees = 7 }\n";
    const char *const changes[] = {integrator, "time.step=3e-6"};
    char both[4096];
    snprintf(both, sizeof both, "%s%s", spheres, box);
    scree_scene *alone = scene_from(spheres, changes, 2, 1), *beside = scene_from(both, changes, 2, 1);
    go(alone, 6000);
    go(beside, 6000);
    int first = scree_scene_find_body(alone, "grain 1"), other = scree_scene_find_body(beside, "grain 1"), slid = 0;
    CHECK(scree_scene_bodies(alone) - first > 100);
    for (int k = 0; first + k < scree_scene_bodies(alone); k++) {
        scree_body_state one = scree_scene_body(alone, first + k), same = scree_scene_body(beside, other + k);
        CHECK(memcmp(&one, &same, sizeof one) == 0);
        slid += one.spin[0] != 0.0;
    }
    int cornered = 0;
    for (int b = 0; b < beside->contacts.batches; b++)
        cornered |= beside->contacts.batch[b].geometry == SCREE_BALL_PLANE && beside->contacts.batch[b].corner;
    for (int b = 0; b < alone->contacts.batches; b++) CHECK(!alone->contacts.batch[b].corner);
    CHECK(cornered && slid > 50);
    scree_scene_destroy(alone);
    scree_scene_destroy(beside);
}

int main(void) {
    snprintf(table_path, sizeof table_path, "/tmp/scree_spheres_%ld.csv", (long)getpid());
    snprintf(scene_path, sizeof scene_path, "/tmp/scree_spheres_%ld.toml", (long)getpid());
    test_lattice();
    test_random_radii();
    test_random_by_mass();
    test_random_beside_dust();
    test_random_across_borders();
    test_random_groups();
    test_random_again();
    test_shaken_speed();
    test_wide_ratio();
    test_table();
    test_bad_tables();
    test_bad_generators();
    test_api();
    test_names();
    test_long_names();
    test_periodic_contacts();
    test_periodic_shift();
    test_periodic_slide();
    test_periodic_bits();
    test_periodic_slabs();
    test_periodic_many();
    test_periodic_flights();
    test_flights_from_afar();
    test_flight_at_fixed();
    test_passing();
    test_periodic_drive();
    test_states_of_domains();
    test_bad_domains();
    test_tiny_in_huge();
    check_beside_box("time.integrator=\"verlet\"");
    check_beside_box("time.integrator=\"pair-impulse\"");
    remove(table_path);
    remove(scene_path);
    return check_report();
}
