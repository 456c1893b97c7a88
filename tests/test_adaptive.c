/* The adaptive integrator against exact solutions and reference tables, over whole scenes.
 *
 * Tolerances of a step are relative to the speeds of a body; a contact takes some 30 to 60 steps, whose errors partly cancel, so
 * errors of a contact are expected within 10 tolerances, down to rounding: some 1e-14 of the speed for bodies whose overlaps are
 * 1e-2 of their distance to the origin. */
#include "tests/scenes.h"

#include "bodies/quat.h"

static void show(const char *what, const char *which, double error, scree_effort effort) {
    if (getenv("SCREE_SHOW"))
        printf("%-14s %-48.48s %.1e  steps %ld rejected %ld events %ld evaluations %ld flights %ld\n", what, which,
               error, effort.steps, effort.rejected, effort.events, effort.evaluations, effort.flights);
}

static scree_scene *adaptive(const char *text, double tolerance, const char *const *changes, int count) {
    char at[64];
    snprintf(at, sizeof at, "time.tolerance=%g", tolerance);
    const char *all[8] = {"time.integrator=\"adaptive\"", at};
    for (int k = 0; k < count; k++) all[2 + k] = changes[k];
    return scene_from(text, all, 2 + count, 1);
}

static const char ball_on_wall[] =
    "[time]\nend = 0.02\n[[material]]\nname = \"ball\"\n[[material]]\nname = \"wall\"\n"
    "[[body]]\nname = \"wall\"\nshape = { plane = true }\nmaterial = \"wall\"\njoint = \"fixed\"\n"
    "[[body]]\nname = \"ball\"\nshape = { sphere = 0.01 }\nmaterial = \"ball\"\nmass = 0.03\n"
    "[[contact]]\nbetween = [\"ball\", \"wall\"]\n";

/* ---- restitution ---- */

static double rebound(const char *law, double tolerance, scree_effort *effort, double *lacking) {
    char normal[300];
    snprintf(normal, sizeof normal, "contact.0.normal={%s}", law);
    const char *changes[] = {normal, "body.ball.position=[0,0,0.0105]", "body.ball.velocity=[0,0,-1]",
                             "output={write=[\"energy.csv\"]}"};
    scree_scene *scene = adaptive(ball_on_wall, tolerance, changes, 4);
    scree_energy energy;
    go(scene, 1);
    CHECK(scree_scene_energy(scene, &energy) == SCREE_OK);
    *lacking = fabs(energy.balance) / 0.015;
    *effort = scree_scene_effort(scene);
    double speed = state_of(scene, "ball").velocity[2];
    scree_scene_destroy(scene);
    return speed;
}

/* Closed forms of the laws' own descriptions, themselves tested against 40-digit tables in test_normal_laws. */
static double promised(const char *law) {
    char normal[300];
    snprintf(normal, sizeof normal, "contact.0.normal={%s}", law);
    const char *changes[] = {normal, "body.ball.position=[0,0,0.0105]"};
    scree_scene *scene = scene_from(ball_on_wall, changes, 2, 1);
    const struct scree_rule *rule = &scene->contacts.rule[0];
    const struct scree_normal_law *normal_law = scree_normal_laws[rule->normal];
    struct scree_pair_constants pair = normal_law->pair(&rule->normal_constants, 0.03, 0.01);
    double e = normal_law->restitution(&rule->normal_constants, pair, 0.03, 1.0);
    scree_scene_destroy(scene);
    return e;
}

static void test_restitution(void) {
    static const char *const laws[] = {
        "law=\"linear\", stiffness=1e5, damping=0.0",
        "law=\"linear\", stiffness=1e5, restitution=0.5",
        "law=\"linear-cut\", stiffness=1e5, restitution=0.5",
        "law=\"linear-loading\", stiffness=1e5, restitution=0.5",
        "law=\"anagnostopoulos\", stiffness=1e5, restitution=0.5",
        "law=\"hunt-crossley\", stiffness=1e5, exponent=1.0, restitution=0.5, speed=1.0",
        "law=\"hunt-crossley\", stiffness=5e6, restitution=0.5, speed=1.0",
        "law=\"flores\", stiffness=5e6, restitution=0.5",
        "law=\"hertz\", stiffness=5e6",
        "law=\"tsuji\", stiffness=5e6, restitution=0.5",
        "law=\"tsuji-cut\", stiffness=5e6, restitution=0.5",
        "law=\"jankowski\", stiffness=5e6, restitution=0.5",
        "law=\"matched\", stiffness=5e6, exponent=1.5, restitution=0.5",
        "law=\"matched-cut\", stiffness=5e7, exponent=2.0, restitution=0.5",
        "law=\"walton-braun\", stiffness=1e5, restitution=0.5",
        "law=\"walton-braun-variable\", stiffness=1e5, restitution=0.5, speed=1.0",
        "law=\"jkr\", modulus=1e8, adhesion=1.0",
        "law=\"dmt\", modulus=1e8, adhesion=1.0",
    };
    for (size_t k = 0; k < sizeof laws / sizeof laws[0]; k++) {
        double exact = promised(laws[k]);
        for (int digits = 6; digits <= 13; digits++) {
            double tolerance = pow(10.0, -digits), lacking;
            scree_effort effort;
            double error = fabs(rebound(laws[k], tolerance, &effort, &lacking) - exact);
            if (digits == 6 || digits == 10 || digits == 13) show("restitution", laws[k], error, effort);
            NEAR(error, 0.0, fmax(10.0 * tolerance, 2e-12));
            NEAR(lacking, 0.0, fmax(10.0 * tolerance, 1e-12));
        }
    }
}

/* Dashpots from nothing to overdamped, with both ends; 15 digits. */
static void test_tables(void) {
    struct check_table *table = check_read("restitution_tsuji.csv");
    double lacking, worst = 0.0;
    scree_effort effort;
    for (int row = 0; row < table->rows; row++) {
        static const char *const columns[3][2] = {
            {"alpha_T", "e_nominal"}, {"alpha_T", "e_cut_with_alpha_T"}, {"alpha_C", "e_nominal"}};
        for (int c = 0; c < 3; c++) {
            double alpha = check_number(table, row, columns[c][0]), e = check_number(table, row, columns[c][1]);
            if (!(alpha >= 0.0) || !(e > 0.0)) continue;
            char law[120];
            snprintf(law, sizeof law, "law=\"%s\", stiffness=5e6, alpha=%.17g", c ? "tsuji-cut" : "tsuji", alpha);
            worst = fmax(worst, fabs(rebound(law, 1e-13, &effort, &lacking) - e));
        }
    }
    show("table", "tsuji", worst, effort);
    NEAR(worst, 0.0, 3e-12);
    free(table);
    table = check_read("restitution_viscoelastic_kuwabara_kono.csv");
    worst = 0.0;
    for (int row = 0; row < table->rows; row++) {
        double b = check_number(table, row, "b"), relaxation = b / 1.5 / pow(5e6 / 0.03, 0.4);
        for (int cut = 0; cut < 2; cut++) {
            char law[160];
            double e = check_number(table, row, cut ? "e_F0" : "e_d0");
            if (b > 5.0) continue; /* rebounds at less than 1/20 of its speed */
            snprintf(law, sizeof law, "law=\"kuwabara-kono%s\", stiffness=5e6, relaxation=%.17g", cut ? "-cut" : "",
                     relaxation);
            worst = fmax(worst, fabs(rebound(law, 1e-13, &effort, &lacking) - e));
        }
    }
    show("table", "kuwabara-kono", worst, effort);
    NEAR(worst, 0.0, 2e-12);
    free(table);
}

/* ---- oblique impacts ---- */

/* A sphere with friction and a light shell moves at its contact as a body that can't turn and has 2/7 of its mass; that leaves out the
 * lever arm's shortening by the overlap, which the 40-digit table doesn't know. */
static void test_oblique(void) {
    struct check_table *table = check_read("oblique_hertz_mindlin_noslip.csv");
    double worst = 0.0;
    scree_effort effort = {0};
    long evaluations = 0;
    for (int row = 0; row < table->rows; row++) {
        double kappa = check_number(table, row, "kappa"), mu = 3.5 * check_number(table, row, "mu");
        double slip = check_number(table, row, "vs0_over_vn"), alpha = check_number(table, row, "alpha");
        int increments = strcmp(check_text(table, row, "form"), "inc") == 0;
        char normal[120], friction[200], velocity[80];
        snprintf(normal, sizeof normal, "contact.0.normal={law=\"tsuji-cut\", stiffness=5e6, alpha=%.17g}", alpha);
        snprintf(friction, sizeof friction,
                 "contact.0.friction={law=\"mindlin%s\", static=%.17g, kinetic=%.17g, shear_modulus=%.17g}",
                 increments ? "-incremental" : "", mu, mu, 3.5 * kappa * 5e6 / (8.0 * sqrt(0.01)));
        snprintf(velocity, sizeof velocity, "body.ball.velocity=[%.17g,0,-1]", slip);
        const char *changes[] = {normal, friction, velocity, "body.ball.position=[0,0,0.0105]",
                                 "body.ball.joint={turn=\"fixed\"}"};
        scree_scene *scene = adaptive(ball_on_wall, 1e-12, changes, 5);
        go(scene, 1);
        scree_body_state ball = state_of(scene, "ball");
        double error = fabs(ball.velocity[2] - check_number(table, row, "vn_rebound_over_vn"));
        double sideways = fabs(ball.velocity[0] - check_number(table, row, "vs_rebound_over_vn"));
        worst = fmax(worst, fmax(error, sideways / fmax(1.0, slip)));
        effort = scree_scene_effort(scene);
        evaluations += effort.evaluations;
        scree_scene_destroy(scene);
    }
    effort.evaluations = evaluations / table->rows;
    show("oblique", "hertz-mindlin, all rows (evaluations: mean)", worst, effort);
    NEAR(worst, 0.0, 1e-10);
    free(table);
}

/* ---- many bodies ---- */

static scree_scene *row_of(int count, const char *law, double tolerance) {
    static char text[4096];
    int used = sprintf(text,
                       "[time]\nend = 0.1\n[[material]]\nname = \"ball\"\n"
                       "[[contact]]\nbetween = [\"ball\", \"ball\"]\nnormal = { %s }\n",
                       law);
    for (int k = 0; k < count; k++)
        used += sprintf(text + used,
                        "[[body]]\nname = \"b%d\"\nshape = { sphere = 0.05 }\nmaterial = \"ball\"\nmass = 1.0\n"
                        "position = [%.17g, 0, 0]\nvelocity = [%d, 0, 0]\n",
                        k, 0.1 * k - (k ? 0.0 : 0.01), k == 0);
    return adaptive(text, tolerance, NULL, 0);
}

/* The table has 12 digits, and says itself which of them to trust. Spheres of 0.1 m that just touch are apart or overlap by 1e-17 m,
 * 1e-14 of what they will. */
static void test_cradle(void) {
    struct check_table *table = check_read("newtons_cradle.csv");
    static const char *const columns[] = {"v1", "v2", "v3", "v4", "v5"};
    for (int row = 0; row < table->rows; row++) {
        double p = check_number(table, row, "p"), worst = 0.0;
        int count = (int)check_number(table, row, "N");
        if (p == 2.0) continue;
        scree_scene *scene = row_of(
            count, p == 1.0 ? "law=\"linear\", stiffness=1e6, damping=0.0" : "law=\"hertz\", stiffness=1e8", 1e-12);
        go(scene, 1);
        for (int k = 0; k < count; k++) {
            char name[8];
            snprintf(name, sizeof name, "b%d", k);
            worst = fmax(worst, fabs(state_of(scene, name).velocity[0] - check_number(table, row, columns[k])));
        }
        show("cradle", check_text(table, row, "N"), worst, scree_scene_effort(scene));
        NEAR(worst, 0.0, 1.2 * check_number(table, row, "est_error") + 2e-11);
        scree_scene_destroy(scene);
    }
    free(table);
}

int main(void) {
    test_restitution();
    test_tables();
    test_oblique();
    test_cradle();
    return check_report();
}
