/* contact/: every law against reference values, closed forms against integration, and what laws refuse. */
#include "contact/catalogue.h"
#include "contact/impact.h"

#include "tests/check.h"

static struct scree_pressing press(double overlap, double closing) { return scree_pressed(overlap, closing, 0.0, 0.0); }

static const struct scree_pair_constants no_pair = {{0.0}};

static const double k = 1e5, m = 0.03; /* of the check values of the process model */

/* A normal law for a pair of effective mass 0.03 kg and radius 0.01 m. */
struct normal {
    const struct scree_normal_law *law;
    struct scree_rule rule;
    struct scree_pair_constants pair;
};

static struct normal make_normal(scree_law_choice choice) {
    struct normal n = {0};
    scree_contact_def def = {.normal = choice};
    scree_trouble trouble = {0};
    CHECK(scree_bake_rule(&def, NULL, &n.rule, &trouble) == SCREE_OK);
    if (trouble.text[0]) printf("  %s\n", trouble.text);
    n.law = scree_normal_laws[n.rule.normal];
    n.pair = n.law->pair(&n.rule.normal_constants, m, 0.01);
    return n;
}

static struct normal linear_by(const char *law, const char *parameter, double value) {
    return make_normal((scree_law_choice){law, 2, {{"stiffness", k}, {parameter, value}}});
}

static double closed_form(const struct normal *n, double speed) {
    return n->law->restitution(&n->rule.normal_constants, n->pair, m, speed);
}

static struct scree_impact integrate(const struct normal *n, double speed) {
    return scree_impact(n->law, &n->rule.normal_constants, n->pair, m, speed, 0.0, NULL, NULL);
}

static double damping_of(const struct normal *n) {
    return n->law->force(&n->rule.normal_constants, n->pair, press(1e-5, 1.0)).damping;
}

/* Damping that gives the wanted restitution, all digits of the table in the process model's description. */
static void test_damping_for_restitution(void) {
    static const struct {
        const char *law;
        double damping[3]; /* for e = 0.3, 0.5, 0.7 */
    } rows[] = {{"linear", {39.2013, 23.6018, 12.3575}},
                {"linear-cut", {54.4698, 27.9640, 13.3880}},
                {"linear-loading", {146.354, 65.4356, 28.9064}}};
    static const double e[3] = {0.3, 0.5, 0.7};
    for (int row = 0; row < 3; row++)
        for (int column = 0; column < 3; column++) {
            struct normal n = linear_by(rows[row].law, "restitution", e[column]);
            CLOSE(damping_of(&n), rows[row].damping[column], 5.1e-6); /* six digits, the least accurate 12.3575 */
            CLOSE(closed_form(&n, 1.0), e[column], 1e-14);
            CLOSE(integrate(&n, 1.0).restitution, e[column], 1e-12);
        }
    /* Hunt-Crossley with c = 0.5 s/m. */
    static const double speed[4] = {0.1, 0.5, 1.0, 2.0}, falls[4] = {0.967739, 0.856851, 0.748435, 0.593624};
    for (int row = 0; row < 4; row++) {
        struct normal n = make_normal(
            (scree_law_choice){"hunt-crossley", 3, {{"stiffness", 1e7}, {"exponent", 1.5}, {"factor", 0.5}}});
        NEAR(closed_form(&n, speed[row]), falls[row], 5.1e-7);
        CLOSE(integrate(&n, speed[row]).restitution, closed_form(&n, speed[row]), 1e-10);
        struct normal back = make_normal((scree_law_choice){
            "hunt-crossley",
            3,
            {{"stiffness", 1e7}, {"restitution", closed_form(&n, speed[row])}, {"speed", speed[row]}}});
        CLOSE(damping_of(&back), damping_of(&n), 1e-13);
    }
}

/* Restitution over damping ratio, and contact time, against 40-digit tables. */
static void test_linear_tables(void) {
    struct check_table *table = check_read("restitution_linear_vs_zeta.csv");
    for (int row = 0; row < table->rows; row++) {
        double zeta = check_number(table, row, "zeta"), omega = sqrt(k / m);
        if (fabs(zeta - sqrt(0.5)) < 1e-8) zeta = sqrt(0.5); /* which the table prints with 8 digits */
        struct normal pulls = linear_by("linear", "damping", 2.0 * zeta * sqrt(k * m));
        struct normal cut = linear_by("linear-cut", "damping", 2.0 * zeta * sqrt(k * m));
        const char *never = strstr(check_text(table, row, "e_tension"), "never");
        /* exp(-x) amplifies rounding of its argument x < 25 by x. */
        if (!never) CLOSE(closed_form(&pulls, 1.0), check_number(table, row, "e_tension"), 1e-13);
        if (never) CHECK(closed_form(&pulls, 1.0) == 0.0);
        CLOSE(closed_form(&cut, 1.0), check_number(table, row, "e_no_tension"), 1e-13);
        struct scree_impact impact = integrate(&cut, 2.0);
        CLOSE(impact.restitution, check_number(table, row, "e_no_tension"), 1e-11);
        CLOSE(impact.duration * omega, check_number(table, row, "omega0_tc_no_tension"), 1e-11);
    }
    free(table);
    table = check_read("restitution_linear_dashpot.csv");
    for (int row = 0; row < table->rows; row++) {
        double e = check_number(table, row, "e_nominal"), critical = 2.0 * sqrt(k * m);
        struct normal pulls = linear_by("linear", "restitution", e), cut = linear_by("linear-cut", "restitution", e);
        CLOSE(damping_of(&pulls) / critical, check_number(table, row, "zeta_T"), 1e-13);
        CLOSE(damping_of(&cut) / critical, check_number(table, row, "zeta_C"), 1e-12);
        struct normal wrong = linear_by("linear-cut", "damping", damping_of(&pulls));
        CLOSE(closed_form(&wrong, 1.0), check_number(table, row, "e_cut_with_zeta_T"), 1e-12);
    }
    free(table);
}

/* Asked for and got, over the whole range, by integration. */
static void test_ask_and_get(void) {
    static const char *const laws[] = {"linear", "linear-cut", "linear-loading"};
    static const double wanted[] = {0.01, 0.05, 0.2, 0.4, 0.6, 0.8, 0.95, 0.99, 1.0};
    for (int law = 0; law < 3; law++)
        for (size_t row = 0; row < sizeof wanted / sizeof wanted[0]; row++) {
            struct normal n = linear_by(laws[law], "restitution", wanted[row]);
            CLOSE(integrate(&n, 0.7).restitution, wanted[row], 1e-11);
        }
    for (size_t row = 0; row < sizeof wanted / sizeof wanted[0]; row++) {
        struct normal n = make_normal((scree_law_choice){
            "hunt-crossley", 4, {{"stiffness", 1e5}, {"exponent", 1.0}, {"restitution", wanted[row]}, {"speed", 0.7}}});
        CLOSE(closed_form(&n, 0.7), wanted[row], 1e-13);
        CLOSE(integrate(&n, 0.7).restitution, wanted[row], 1e-11);
    }
    struct check_table *table = check_read("restitution_hunt_crossley_vs_d.csv");
    for (int row = 0; row < table->rows; row++) {
        double d = check_number(table, row, "lambda_v0");
        struct normal n = make_normal((scree_law_choice){"hunt-crossley", 2, {{"stiffness", 1e5}, {"factor", d}}});
        CLOSE(closed_form(&n, 1.0), check_number(table, row, "e"), 1e-13);
    }
    free(table);
}

/* Shared by four contacts, the pair behaves as with the total. */
static void test_shared(void) {
    scree_contact_def def = {.normal = {"linear-loading", 2, {{"stiffness", k}, {"restitution", 0.5}}}, .shared_by = 4};
    struct scree_rule rule;
    scree_trouble trouble;
    CHECK(scree_bake_rule(&def, NULL, &rule, &trouble) == SCREE_OK);
    const struct scree_normal_law *law = scree_normal_laws[rule.normal];
    struct scree_pair_constants pair = law->pair(&rule.normal_constants, m / rule.share, 0.01);
    struct scree_normal_force quarter = law->force(&rule.normal_constants, pair, press(1e-4, 1.0));
    struct normal whole = linear_by("linear-loading", "restitution", 0.5);
    struct scree_normal_force all = law->force(&whole.rule.normal_constants, whole.pair, press(1e-4, 1.0));
    CLOSE(4.0 * quarter.elastic, all.elastic, 1e-15);
    CLOSE(4.0 * quarter.damping, all.damping, 1e-15);
}

/* Whatever is a force, or makes one, is shared out. */
static int check_shared(const struct scree_law_text *text) {
    int shared = 0;
    for (const struct scree_parameter *p = text->parameters; p->name; p++) {
        int forceful = strncmp(p->unit, "N", 1) == 0 || strncmp(p->unit, "Pa", 2) == 0 || strncmp(p->unit, "J", 1) == 0;
        CHECK(p->shared == forceful);
        if (p->shared != forceful) fprintf(stderr, "%s: %s in %s\n", text->name, p->name, p->unit);
        shared += p->shared;
    }
    return shared;
}

static void test_all_shared(void) {
    int shared[3] = {0, 0, 0};
    for (int l = 0; scree_normal_laws[l]; l++) shared[0] += check_shared(&scree_normal_laws[l]->text);
    for (int l = 0; scree_friction_laws[l]; l++) shared[1] += check_shared(&scree_friction_laws[l]->text);
    for (int l = 0; scree_rolling_laws[l]; l++) shared[2] += check_shared(&scree_rolling_laws[l]->text);
    CHECK(shared[0] > 0 && shared[1] > 0 && shared[2] > 0);
}

static void test_unit_values(void) {
    struct check_table *table = check_read("normal_force_unit_values.csv");
    for (int row = 0; row < table->rows; row++) {
        double d = check_number(table, row, "d"), v = check_number(table, row, "v");
        struct normal linear =
            make_normal((scree_law_choice){"linear", 2, {{"stiffness", 1e5}, {"damping", 0.4 * sqrt(1e5 * 0.01)}}});
        struct normal hunt = make_normal(
            (scree_law_choice){"hunt-crossley", 3, {{"stiffness", 1e8}, {"exponent", 1.5}, {"factor", 0.375}}});
        struct normal hunt_1 = make_normal(
            (scree_law_choice){"hunt-crossley", 3, {{"stiffness", 1e5}, {"exponent", 1.0}, {"factor", 0.375}}});
        const struct normal *laws[] = {&linear, &hunt, &hunt_1};
        static const char *const columns[] = {"linear", "hunt_crossley_n1.5", "hunt_crossley_n1"};
        for (int l = 0; l < 3; l++) {
            struct scree_normal_force f =
                laws[l]->law->force(&laws[l]->rule.normal_constants, laws[l]->pair, press(d, v));
            /* The tables are rounded to 15 digits, and the linear row cancels. */
            double size = fabs(f.elastic) + fabs(f.damping * v);
            double expected = check_number(table, row, columns[l]);
            /* hunt_crossley_n1 is tabulated for K = 1e5. */
            NEAR(f.elastic + f.damping * v, expected, 2e-15 * size + 1e-15 * fabs(expected));
        }
    }
    free(table);
}

/* U is the integral of the reversible force, and no law's force jumps by more than its dashpot at the first touch. */
static void test_energy(void) {
    scree_law_choice choices[] = {
        {"linear", 2, {{"stiffness", k}, {"restitution", 0.5}}},
        {"linear-cut", 2, {{"stiffness", k}, {"restitution", 0.5}}},
        {"linear-loading", 2, {{"stiffness", k}, {"restitution", 0.5}}},
        {"blend", 4, {{"stiffness", 1e6}, {"exponent", 1.3}, {"damping", 50.0}, {"full", 1e-4}}},
        {"hunt-crossley", 3, {{"stiffness", 1e6}, {"exponent", 1.5}, {"factor", 0.4}}},
        {"impact", 4, {{"stiffness", 1e6}, {"exponent", 2.2}, {"damping", 50.0}, {"full", 1e-4}}}};
    for (size_t c = 0; c < sizeof choices / sizeof choices[0]; c++) {
        struct normal n = make_normal(choices[c]);
        const struct scree_law_constants *constants = &n.rule.normal_constants;
        double sum = 0.0, h = 1e-7;
        for (int step = 0; step < 3000; step++) {
            struct scree_normal_force middle = n.law->force(constants, n.pair, press((step + 0.5) * h, 0.3));
            sum += h * middle.reversible;
        }
        CLOSE(n.law->stored(constants, n.pair, press(3000 * h, 0.0)), sum,
              1e-6); /* midpoint rule: (1/3000)^2, worse at d = 0 */
        CHECK(n.law->stored(constants, n.pair, press(0.0, 0.0)) == 0.0);
        struct scree_normal_force touch = n.law->force(constants, n.pair, press(0.0, 1.0));
        CHECK(touch.elastic == 0.0 && touch.reversible == 0.0);
        if (c >= 3) CHECK(touch.damping == 0.0);
        struct scree_impact impact = integrate(&n, 1.0);
        CHECK(impact.restitution > 0.0 && impact.restitution < 1.0);
        struct scree_impact slower = integrate(&n, 0.1);
        /* Restitution depends on speed where the dashpot sets in with the overlap, and is the same elsewhere. */
        if (c < 3)
            CLOSE(slower.restitution, impact.restitution, 1e-10);
        else
            CHECK(fabs(slower.restitution - impact.restitution) > 1e-3);
    }
}

/* ---- measured forces ---- */

static void test_table(void) {
    static const double overlaps[] = {0.0, 1e-4, 1e-3}, speeds[] = {-1.0, 0.0, 2.0};
    double forces[9] = {-1.0, 0.0, 4.0, 3.0, 10.0, 30.0, 50.0, 100.0, 140.0};
    scree_force_table table = {3, 3, overlaps, speeds, forces};
    scree_contact_def def = {.normal = {.law = "table"}, .table = &table, .shared_by = 2};
    struct scree_rule rule;
    scree_trouble trouble = {0};
    CHECK(scree_bake_rule(&def, NULL, &rule, &trouble) == SCREE_OK);
    const struct scree_normal_law *law = scree_normal_laws[rule.normal];
    const struct scree_law_constants *constants = &rule.normal_constants;
    /* Half of each, for two contacts share a load; straight between the points. */
    struct scree_normal_force f = law->force(constants, no_pair, press(1e-4, 0.0));
    CHECK(f.elastic == 5.0 && f.damping == 0.0);
    f = law->force(constants, no_pair, press(5.5e-4, 1.0)); /* half-way up: 55 at rest, 85 at 2 m/s */
    NEAR(f.elastic, 27.5, 1e-14);
    NEAR(f.elastic + f.damping, 35.0, 1e-14);
    f = law->force(constants, no_pair, press(5.5e-4, 9.0)); /* beyond the speeds as at the last */
    NEAR(f.elastic + 9.0 * f.damping, 42.5, 1e-13);
    f = law->force(constants, no_pair, press(2e-3, -0.5)); /* beyond the overlaps as steep as before, damped as there */
    NEAR(f.elastic, 100.0, 1e-12);
    NEAR(f.elastic - 0.5 * f.damping, 87.5, 1e-12);
    /* Beside rest the dashpot is the slope, at speeds that say next to nothing too. */
    f = law->force(constants, no_pair, press(5.5e-4, 1e-300));
    NEAR(f.damping, 7.5, 1e-13);
    f = law->force(constants, no_pair, press(5.5e-4, -1e-300));
    NEAR(f.damping, 14.25, 1e-13);
    NEAR(law->stored(constants, no_pair, press(1e-3, 0.0)), 0.5 * (1e-4 * 5.0 + 9e-4 * 55.0), 1e-16);
    scree_free_rule(&rule);

    forces[5] = 9.0; /* less than at rest though approaching */
    CHECK(scree_bake_rule(&def, NULL, &rule, &trouble) == SCREE_BAD_INPUT);
    CONTAINS(trouble.text, "would give energy");
    forces[5] = NAN;
    CHECK(scree_bake_rule(&def, NULL, &rule, &trouble) == SCREE_BAD_INPUT);
    def.normal.law = "linear";
    CHECK(scree_bake_rule(&def, NULL, &rule, &trouble) == SCREE_BAD_INPUT);
    def.normal.law = "table";
    def.table = NULL;
    CHECK(scree_bake_rule(&def, NULL, &rule, &trouble) == SCREE_BAD_INPUT);
    CONTAINS(trouble.text, "rows");
}

/* ---- friction ---- */

static struct scree_rule make_friction(scree_law_choice choice, const struct scree_friction_law **law) {
    scree_contact_def def = {.normal = {"linear", 2, {{"stiffness", k}, {"damping", 0.0}}}, .friction = choice};
    struct scree_rule rule;
    scree_trouble trouble = {0};
    CHECK(scree_bake_rule(&def, NULL, &rule, &trouble) == SCREE_OK);
    if (trouble.text[0]) printf("  %s\n", trouble.text);
    *law = scree_friction_laws[rule.friction];
    return rule;
}

/* Coefficient at speed v, checking direction on the way: force against the velocity, for any direction. */
static double coefficient(const struct scree_friction_law *law, const struct scree_rule *rule, double v) {
    struct vec along = vec(0.6, 0.0, -0.8);
    struct scree_sliding at = {.normal = 2.0, .velocity = vec_scale(v, along)};
    struct vec force = law->force(&rule->friction_constants, no_pair, at).force;
    NEAR(vec_norm(vec_cross(force, along)), 0.0, 1e-15);
    return -vec_dot(force, along) / 2.0;
}

static void test_friction_values(void) {
    static const struct {
        const char *column;
        scree_law_choice choice;
    } laws[] = {
        {"linear", {"ramp", 2, {{"kinetic", 0.4}, {"threshold", 1e-3}}}},
        {"tanh", {"tanh", 2, {{"kinetic", 0.4}, {"threshold", 1e-3}}}},
        {"cfl_stick_slip", {"stick-slip", 3, {{"static", 0.6}, {"kinetic", 0.4}, {"threshold", 1e-3}}}},
        {"adams_static_kinetic",
         {"step", 4, {{"static", 0.6}, {"kinetic", 0.4}, {"stiction_speed", 1e-3}, {"sliding_speed", 1.5e-3}}}},
    };
    struct check_table *table = check_read("friction_law_values.csv");
    for (size_t l = 0; l < sizeof laws / sizeof laws[0]; l++) {
        const struct scree_friction_law *law;
        struct scree_rule rule = make_friction(laws[l].choice, &law);
        for (int row = 0; row < table->rows; row++)
            NEAR(coefficient(law, &rule, check_number(table, row, "v")), check_number(table, row, laws[l].column),
                 1e-15);
        CHECK(law->memory == 0);
        /* slope() bounds the rise of the coefficient. */
        for (double v = 0.0; v < 3e-3; v += 1e-5)
            CHECK(coefficient(law, &rule, v + 1e-6) - coefficient(law, &rule, v) <=
                  law->slope(&rule.friction_constants) * 1e-6 * (1.0 + 1e-9));
    }
    free(table);
}

static void test_creep(void) {
    static const struct {
        const char *column;
        scree_law_choice choice;
    } laws[] = {{"linear_ramp", {"ramp", 2, {{"kinetic", 0.4}, {"threshold", 1e-3}}}},
                {"tanh", {"tanh", 2, {{"kinetic", 0.4}, {"threshold", 1e-3}}}},
                {"cubic_step",
                 {"step", 4, {{"static", 0.4}, {"kinetic", 0.3}, {"stiction_speed", 1e-3}, {"sliding_speed", 2e-3}}}}};
    struct check_table *table = check_read("friction_creep_on_incline.csv");
    for (size_t l = 0; l < sizeof laws / sizeof laws[0]; l++) {
        const struct scree_friction_law *law;
        struct scree_rule rule = make_friction(laws[l].choice, &law);
        for (int row = 0; row < table->rows; row++) {
            double r = check_number(table, row, "r");
            /* The coefficient is flat near its top: its rounding of 1e-16 counts for up to 1/(1 - r) = 100 times. */
            CLOSE(scree_creep_speed(law, &rule.friction_constants, 0.4 * r),
                  1e-3 * check_number(table, row, laws[l].column), 1e-13);
        }
        CHECK(scree_creep_speed(law, &rule.friction_constants, 0.41) == HUGE_VAL);
    }
    free(table);
}

static void test_coulomb(void) {
    const struct scree_friction_law *law;
    scree_law_choice choice = {"coulomb", 3, {{"static", 0.5}, {"kinetic", 0.3}, {"stiffness", 1e4}}};
    struct scree_rule rule = make_friction(choice, &law);
    struct scree_sliding at = {.normal = 10.0, .stretch = {3e-4, 4e-4, 0.0}}; /* |k s| = 5 N = mu_s N */
    struct scree_tangential f = law->force(&rule.friction_constants, no_pair, at);
    NEAR(f.force.x, -3.0, 1e-15);
    CHECK(f.sliding == 0.0 && f.stretch.x == 3e-4);
    at.stretch.z = 1e-6; /* a little more: slides at mu_k, and the spring is left at what carries that */
    f = law->force(&rule.friction_constants, no_pair, at);
    CLOSE(vec_norm(f.force), 3.0, 1e-15);
    CHECK(f.sliding == 1.0);
    CLOSE(vec_norm(f.stretch) * 1e4, 3.0, 1e-15);
    at.stretch = f.stretch; /* goes on sliding until the force falls below mu_k N */
    at.sliding = 1.0;
    at.half = 1e-6;
    at.velocity = vec(1e-3, 0.0, 0.0);
    CHECK(law->force(&rule.friction_constants, no_pair, at).sliding == 1.0);
    at.velocity = vec(-1e-3, 0.0, 0.0);
    CHECK(law->force(&rule.friction_constants, no_pair, at).sliding == 0.0);
    at.normal = 0.0; /* no load, no force, no stretch */
    f = law->force(&rule.friction_constants, no_pair, at);
    CHECK(vec_norm(f.force) == 0.0 && vec_norm(f.stretch) == 0.0);
    CHECK(scree_creep_speed(law, &rule.friction_constants, 0.1) == 0.0);
}

/* Whatever the state, a step takes energy out: spring, dashpot and slider in a row are passive, and so is the scheme
 * (unless the ball already moves along the force on it: the step in which the slip turns round). A step that sticks
 * again gives back what the sliding steps took too much, half a step's growth of the stretch (slider.h). */
static void test_coulomb_takes_energy(void) {
    static const double dampings[] = {0.0, 0.1, 2.0, 50.0};
    uint64_t seed = 11;
    int slid = 0;
    for (int trial = 0; trial < 4000; trial++) {
        const struct scree_friction_law *law;
        scree_law_choice choice = {
            "coulomb", 4, {{"static", 0.5}, {"kinetic", 0.3}, {"stiffness", 1e4}, {"damping", dampings[trial % 4]}}};
        struct scree_rule rule = make_friction(choice, &law);
        struct scree_sliding at = {.normal = check_between(&seed, 0.0, 10.0), .half = 1e-5};
        double velocity[3] = {0.0}, stretch[3] = {0.0};
        check_draw(&seed, -1.0, 1.0, 2, velocity);
        check_draw(&seed, -5e-4, 5e-4, 2, stretch);
        at.velocity = vec_from(velocity);
        at.stretch = vec_from(stretch);
        at.sliding = trial % 3 == 0;
        struct scree_tangential f = law->force(&rule.friction_constants, no_pair, at);
        if (vec_dot(f.force, at.velocity) > 0.0) continue;
        slid += f.sliding > 0.0;
        double work = -2.0 * at.half * vec_dot(f.force, at.velocity);
        double before = law->stored(&rule.friction_constants, no_pair, at);
        at.stretch = f.stretch;
        double stored = law->stored(&rule.friction_constants, no_pair, at) - before;
        int again = at.sliding > 0.0 && !(f.sliding > 0.0);
        double growth =
            at.half * (fmax(vec_dot(vec_from(stretch), at.velocity), 0.0) + 0.5 * at.half * vec_norm2(at.velocity));
        CHECK(work - stored >= -1e-16 - (again ? 1e4 * growth : 0.0)); /* rounding of 1e-3 J */
    }
    CHECK(slid > 500);
}

/* A load that falls while the slip turns round and the spring unloads faster still: it holds at once, and gives back no
 * more than it had stored. */
static void test_coulomb_unloads(void) {
    for (int damped = 0; damped <= 1; damped++) {
        const struct scree_friction_law *law;
        scree_law_choice choice = {
            "coulomb", 4, {{"static", 0.3}, {"kinetic", 0.3}, {"stiffness", 1e4}, {"damping", damped ? 0.05 : 0.0}}};
        struct scree_rule rule = make_friction(choice, &law);
        struct scree_sliding at = {.half = 5e-7, .stretch = {-3e-4, 0.0, 0.0}, .sliding = 1.0};
        double first = law->stored(&rule.friction_constants, no_pair, at), taken = 0.0, least = 0.0;
        for (int step = 0; step < 500; step++) {
            at.normal =
                10.0 * (1.0 - (step + 0.5) / 500.0); /* mu N/k falls at 0.6 m/s, the spring unloads at 0.9 m/s */
            at.velocity = vec(0.9, 0.0, 0.0);
            struct scree_tangential f = law->force(&rule.friction_constants, no_pair, at);
            taken -= 2.0 * at.half * vec_dot(f.force, at.velocity);
            at.stretch = f.stretch;
            at.sliding = f.sliding;
            least = scree_least(least, taken - (law->stored(&rule.friction_constants, no_pair, at) - first));
        }
        CHECK(least >= -1e-16); /* rounding of 4.5e-4 J */
    }
}

/* ---- what is refused ---- */

static void refuse(scree_law_choice normal, scree_law_choice friction, const char *part, const char *field) {
    scree_contact_def def = {.normal = normal, .friction = friction};
    struct scree_rule rule;
    scree_trouble trouble = {0};
    CHECK(scree_bake_rule(&def, NULL, &rule, &trouble) == SCREE_BAD_INPUT);
    CONTAINS(trouble.text, part);
    CHECK(strcmp(trouble.field, field) == 0);
}

static void test_refusals(void) {
    scree_law_choice good = {"linear", 2, {{"stiffness", k}, {"restitution", 0.5}}}, none = {0};
    refuse((scree_law_choice){"lineer", 0, {{0}}}, none, "did you mean \"linear\"", "normal.law");
    refuse(good, (scree_law_choice){"stickslip", 0, {{0}}}, "did you mean \"stick-slip\"", "friction.law");
    refuse((scree_law_choice){"linear", 2, {{"stifness", k}, {"damping", 0.0}}}, none, "did you mean \"stiffness\"",
           "normal.stifness");
    refuse((scree_law_choice){"linear", 2, {{"spring_stiffness", k}, {"damping", 0.0}}}, none,
           "did you mean \"stiffness\"", "normal.spring_stiffness");
    refuse((scree_law_choice){"linear", 2, {{"stiffness", k}, {"e", 0.5}}}, none, "did you mean \"restitution\"",
           "normal.e"); /* its symbol in the formula */
    refuse((scree_law_choice){"linear", 1, {{"cohesion", k}}}, none, "it has stiffness, restitution, damping",
           "normal.cohesion");
    refuse((scree_law_choice){"linear", 1, {{"stiffness", k}}}, none, "neither is given", "normal");
    refuse((scree_law_choice){"linear", 3, {{"stiffness", k}, {"damping", 1.0}, {"restitution", 0.5}}}, none,
           "not both", "normal.restitution");
    refuse((scree_law_choice){"linear", 1, {{"damping", 1.0}}}, none, "needs stiffness", "normal");
    refuse((scree_law_choice){"linear", 2, {{"stiffness", -1.0}, {"damping", 1.0}}}, none, "must be > 0",
           "normal.stiffness");
    refuse((scree_law_choice){"linear", 2, {{"stiffness", NAN}, {"damping", 1.0}}}, none, "must be > 0",
           "normal.stiffness");
    refuse((scree_law_choice){"linear", 2, {{"stiffness", k}, {"restitution", 1.5}}}, none, "<= 1",
           "normal.restitution");
    refuse((scree_law_choice){"linear", 2, {{"stiffness", k}, {"restitution", 0.0}}}, none, "> 0",
           "normal.restitution");
    refuse((scree_law_choice){"hunt-crossley", 2, {{"stiffness", k}, {"restitution", 0.5}}}, none, "impact speed",
           "normal.restitution");
    refuse((scree_law_choice){"hunt-crossley", 3, {{"stiffness", k}, {"factor", 0.5}, {"speed", 1.0}}}, none,
           "goes with", "normal.speed");
    refuse((scree_law_choice){"blend", 2, {{"stiffness", k}, {"restitution", 0.5}}}, none,
           "no parameter \"restitution\"", "normal.restitution");
    refuse(good, (scree_law_choice){"stick-slip", 3, {{"static", 0.2}, {"kinetic", 0.3}, {"threshold", 1e-3}}},
           "below kinetic", "friction.static");
    refuse(good,
           (scree_law_choice){
               "step", 4, {{"static", 0.4}, {"kinetic", 0.3}, {"stiction_speed", 1e-3}, {"sliding_speed", 1e-3}}},
           "above stiction_speed", "friction.sliding_speed");
    refuse((scree_law_choice){0}, none, "needs a normal law", "normal");
}

/* Every description is complete: what `scree laws` prints. */
/* A member that every law of its kind has. */
static void needs(const struct scree_law_text *text, const char *member, int has) {
    if (!has) fprintf(stderr, "the law \"%s\" lacks .%s\n", text->name, member);
    CHECK(has);
}
#define NEEDS(law, member) needs(&(law)->text, #member, (law)->member != NULL)

#define NEEDS_TEXT(law)                                                                                                \
    do {                                                                                                               \
        NEEDS(law, text.formula);                                                                                      \
        NEEDS(law, text.source);                                                                                       \
        NEEDS(law, text.note);                                                                                         \
        NEEDS(law, text.example);                                                                                      \
        NEEDS(law, text.parameters);                                                                                   \
        NEEDS(law, bake);                                                                                              \
    } while (0)

static void test_descriptions(void) {
    for (int l = 0; scree_normal_laws[l]; l++) {
        const struct scree_normal_law *law = scree_normal_laws[l];
        NEEDS_TEXT(law);
        NEEDS(law, pair);
        NEEDS(law, force);
        NEEDS(law, stored);
        CHECK(scree_find_normal_law(law->text.name) == l && scree_find_friction_law(law->text.name) == -1);
    }
    for (int l = 0; scree_friction_laws[l]; l++) {
        const struct scree_friction_law *law = scree_friction_laws[l];
        NEEDS_TEXT(law);
        NEEDS(law, force);
        NEEDS(law, stored);
        NEEDS(law, slope);
        NEEDS(law, stiffness);
        NEEDS(law, damping);
        CHECK((law->hold != NULL) + (law->rate != NULL) == law->memory);
        CHECK((law->bears != NULL) == (law->rate != NULL));
        CHECK(law->hold || (!law->in_force && !law->grip && !law->band));
        CHECK(law->in_force ? !law->grip : !law->rescaled);
        CHECK(scree_find_friction_law(law->text.name) == l && scree_find_normal_law(law->text.name) == -1);
    }
    for (int l = 0; scree_rolling_laws[l]; l++) {
        const struct scree_rolling_law *law = scree_rolling_laws[l];
        NEEDS_TEXT(law);
        NEEDS(law, resist);
        NEEDS(law, slope);
        NEEDS(law, stiffness);
        NEEDS(law, damping);
        CHECK(scree_find_rolling_law(law->text.name) == l && scree_find_normal_law(law->text.name) == -1 &&
              scree_find_friction_law(law->text.name) == -1);
    }
}

/* A law that is like another one goes through the loops of that one, with constants of its own. */
static void test_likes(void) {
    uint64_t seed = 7;
    int likes = 0;
    for (int l = 0; scree_normal_laws[l]; l++) {
        const struct scree_normal_law *law = scree_normal_laws[l], *like = law->like;
        if (!like) continue;
        likes++;
        CHECK(!like->like && scree_normal_laws[scree_find_normal_law(like->text.name)] == like);
        CHECK(law->cut == like->cut && law->memory == like->memory && law->turns_smoothly == like->turns_smoothly);
        CHECK(law->raises == like->raises && law->root == like->root && !law->reach == !like->reach);
        CHECK(!law->bends == !like->bends);
        for (int n = 0; n < 1000; n++) {
            struct scree_law_constants c = {.exponent = scree_exponent_of(n % 2 ? 1.5 : 1.4)};
            struct scree_pair_constants pair;
            double at[8];
            check_draw(&seed, 0.5, 2.0, 4, c.c);
            check_draw(&seed, 0.5, 2.0, 4, pair.c);
            check_draw(&seed, -1.0, 1.0, 8, at);
            struct scree_pressing from = scree_pressed(at[0], at[1], at[2], at[3]);
            struct scree_pressing to = scree_pressed(at[4], at[5], at[2], at[3]);
            struct scree_normal_force one = law->force(&c, pair, from), other = like->force(&c, pair, from);
            CHECK(memcmp(&one, &other, sizeof one) == 0);
            if (from.overlap > 0.0) CHECK(law->stored(&c, pair, from) == like->stored(&c, pair, from));
            if (law->bends) CHECK(law->bends(&c, pair, from, to) == like->bends(&c, pair, from, to));
        }
    }
    CHECK(likes >= 9);
}

/* Springs whose force is kept go through loops of one law, told whether their force falls with the stiffness: they have
 * everything else in common that is asked of a slider there. */
static void test_springs_in_force(void) {
    const struct scree_friction_law *like = scree_friction_laws[scree_find_friction_law("mindlin-rescaled")];
    int likes = 0;
    for (int l = 0; scree_friction_laws[l]; l++) {
        const struct scree_friction_law *law = scree_friction_laws[l];
        if (!law->in_force) continue;
        likes++;
        CHECK(law->stiffness == like->stiffness && law->damping == like->damping && law->hold == like->hold);
        CHECK(law->slope == like->slope && law->root == like->root && law->pair == like->pair);
    }
    CHECK(likes == 2);
}

int main(void) {
    test_damping_for_restitution();
    test_linear_tables();
    test_ask_and_get();
    test_shared();
    test_all_shared();
    test_unit_values();
    test_energy();
    test_friction_values();
    test_creep();
    test_table();
    test_coulomb();
    test_coulomb_takes_energy();
    test_coulomb_unloads();
    test_refusals();
    test_descriptions();
    test_likes();
    test_springs_in_force();
    return check_report();
}
