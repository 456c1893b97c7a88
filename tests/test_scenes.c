/* engine/: many spheres at once, from tables and generators. */
#include "engine/hash.h"
#include "tests/scenes.h"

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
            least = fmin(least, gap / fmin(r, s));
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

static void test_random(void) {
    scree_scene *scene = scene_from(HEAD RANDOM, NULL, 0, 1);
    CHECK(scree_scene_bodies(scene) == 2000);
    CHECK(least_gap(scene, 0.0, 0.05) >= -1e-12); /* rounding of places in parts of the least radius */
    double smallest = HUGE_VAL, largest = 0.0, mean = 0.0;
    for (int k = 0; k < 2000; k++) {
        double r = scree_scene_body_shape(scene, k).radius;
        smallest = fmin(smallest, r);
        largest = fmax(largest, r);
        mean += r / 2000;
    }
    CHECK(smallest >= 0.0002 && smallest < 0.00021 && largest <= 0.002 && largest > 0.00198);
    NEAR(mean, 0.0011, 4.0 * 0.0018 / sqrt(12.0 * 2000.0)); /* 4 deviations of a mean of 2000 */
    scree_scene_destroy(scene);

    /* By mass: of the volume, the lower half of the radii has as much as the upper one. The number of large ones is 1 in 100,
     * their share of the volume scatters by some 5 %. */
    scene = scene_from(HEAD RANDOM "distribution = \"mass\"\n", NULL, 0, 1);
    double half[2] = {0.0, 0.0};
    for (int k = 0; k < 2000; k++) {
        double r = scree_scene_body_shape(scene, k).radius;
        half[r > 0.0011] += r * r * r;
    }
    NEAR(half[0] / (half[0] + half[1]), 0.5, 0.2);
    scree_scene_destroy(scene);

    CHECK(hash_of(HEAD RANDOM) == hash_of(HEAD RANDOM));
    static const char *const other[] = {"generate.0.seed=4"};
    scene = scene_from(HEAD RANDOM, other, 1, 1);
    CHECK(scree_scene_hash(scene) != hash_of(HEAD RANDOM));
    scree_scene_destroy(scene);
    /* The same places on every machine. */
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
        {"x,y,z,radius,material\n0,0,0,1,glass\n5,0,0,1,glas\n", "", ".csv:3:1: there is no material called \"glas\""},
        {"x,y,z,radius,material\n0,0,0,1,glass\n5,0,0,-1,glass\n", "", ".csv:3:1: body \"sphere 2\": "},
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
              "max = [1, 1, 1]\n",
         "needs the count of its spheres"},
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
    CHECK(strcmp(scree_scene_body_name(scene, 1), "s 2") == 0 && scree_scene_body_shape(scene, 3).radius == 1.0);
    CLOSE(scree_scene_body_mass(scene, 0), 1000 * 4.0 / 3.0 * 3.14159265358979323846 * 1e-3, 1e-15);
    def.count = 0;
    CHECK(scree_scene_add_spheres(scene, &def, &first) == SCREE_BAD_INPUT);
    scree_scene_destroy(scene);
}

int main(void) {
    snprintf(table_path, sizeof table_path, "/tmp/scree_spheres_%ld.csv", (long)getpid());
    snprintf(scene_path, sizeof scene_path, "/tmp/scree_spheres_%ld.toml", (long)getpid());
    test_lattice();
    test_random();
    test_wide_ratio();
    test_table();
    test_bad_tables();
    test_bad_generators();
    test_api();
    remove(table_path);
    remove(scene_path);
    return check_report();
}
