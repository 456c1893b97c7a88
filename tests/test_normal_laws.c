/* contact/: the normal laws against the reference tables, by closed form and by integration; what every law must keep
 * to; and adhesion in scenes. */
#include "contact/ask.h"
#include "tests/scenes.h"

/* A normal law for a pair of bodies. */
struct normal {
    const struct scree_normal_law *law;
    struct scree_rule rule;
    struct scree_pair_constants pair;
    double mass;
};

static struct normal make(scree_law_choice choice, double mass, double radius) {
    struct normal n = {.mass = mass};
    scree_contact_def def = {.normal = choice};
    scree_trouble trouble = {0};
    CHECK(scree_bake_rule(&def, NULL, &n.rule, &trouble) == SCREE_OK);
    if (trouble.text[0]) printf("  %s\n", trouble.text);
    n.law = scree_normal_laws[n.rule.normal];
    n.pair = n.law->pair(&n.rule.normal_constants, mass, radius);
    return n;
}

/* In the units of stiffness, effective mass and radius 1. */
static struct normal unit(scree_law_choice choice) { return make(choice, 1.0, 1.0); }

static struct normal unit_with(const char *law, const char *parameter, double value) {
    return unit((scree_law_choice){law, 2, {{"stiffness", 1.0}, {parameter, value}}});
}

static double closed_form(const struct normal *n, double speed) {
    return n->law->restitution(&n->rule.normal_constants, n->pair, n->mass, speed);
}

static struct scree_impact integrate(const struct normal *n, double speed) {
    return scree_impact(n->law, &n->rule.normal_constants, n->pair, n->mass, speed, 0.0, NULL, NULL);
}

static struct scree_normal_force force_of(const struct normal *n, struct scree_pressing at) {
    return n->law->force(&n->rule.normal_constants, n->pair, at);
}

static double stored_of(const struct normal *n, struct scree_pressing at) {
    return n->law->stored(&n->rule.normal_constants, n->pair, at);
}

/* ---- the tables. Printed to 15 digits, closed forms agree to a few units of the last one; the integrator's steps are
 * right to 1e-14 each, some hundreds of them to 1e-11 ---- */

static const double printed = 2e-14, integrated = 1e-11;

static void test_hertz_constants(void) {
    struct check_table *table = check_read("hertz_constants.csv");
    struct normal n = unit((scree_law_choice){"hertz", 1, {{"stiffness", 1.0}}});
    struct scree_impact impact = integrate(&n, 1.0);
    /* The last two rows are the series of the viscoelastic law: see below. */
    const double values[4] = {impact.duration / impact.deepest, impact.deepest, impact.duration, impact.force};
    for (int row = 0; row < 4; row++) CLOSE(values[row], check_number(table, row, "value"), integrated);
    CLOSE(impact.restitution, 1.0, integrated);
    double c1 = check_number(table, 4, "value"), c2 = check_number(table, 5, "value"), b = 1e-3;
    struct normal viscous = unit_with("kuwabara-kono", "relaxation", b / 1.5);
    struct normal cut = unit_with("kuwabara-kono-cut", "relaxation", b / 1.5);
    /* The next term of the series is -0.5 b^3, of the law that ends where the force does some 0.26 b^(5/2), 8e-9. */
    double series = 1.0 - c1 * b + c2 * b * b;
    NEAR(integrate(&viscous, 1.0).restitution, series - 0.5 * b * b * b, 0.2 * b * b * b);
    NEAR(integrate(&cut, 1.0).restitution, series + 0.26 * b * b * sqrt(b), 0.02 * b * b * sqrt(b));
    /* The moduli give the stiffness that is put in. */
    struct normal moduli = make((scree_law_choice){"hertz", 1, {{"modulus", 3.0}}}, 1.0, 0.25);
    CLOSE(force_of(&moduli, (struct scree_pressing){.overlap = 4.0}).elastic, 4.0 / 3.0 * 3.0 * 0.5 * 8.0, 1e-15);
    free(table);
}

static void test_unit_values(void) {
    struct check_table *table = check_read("normal_force_unit_values.csv");
    const struct normal laws[] = {
        make((scree_law_choice){"hertz", 1, {{"stiffness", 1e8}}}, 0.01, 1.0),
        make((scree_law_choice){"tsuji", 2, {{"stiffness", 1e8}, {"alpha", 0.5}}}, 0.01, 1.0),
        make((scree_law_choice){"kuwabara-kono", 2, {{"stiffness", 1e8}, {"relaxation", 1e-5}}}, 0.01, 1.0),
        make((scree_law_choice){"lee-wang", 2, {{"stiffness", 1e8}, {"restitution", 1e-12}}}, 0.01, 1.0),
        make((scree_law_choice){"lee-wang", 3, {{"stiffness", 1e5}, {"exponent", 1.0}, {"restitution", 1e-12}}}, 0.01,
             1.0)};
    static const char *const columns[] = {"hertz", "tsuji", "kuwabara_kono", "hunt_crossley_n1.5", "hunt_crossley_n1"};
    for (int l = 0; l < 5; l++)
        for (int row = 0; row < table->rows; row++) {
            double v = check_number(table, row, "v"), expected = check_number(table, row, columns[l]);
            struct scree_normal_force f =
                force_of(&laws[l], scree_pressed(check_number(table, row, "d"), v, l >= 3 ? 2.0 : 0.0, 0.0));
            double size = fabs(f.elastic) + fabs(f.damping * v);
            /* Lee & Wang's D is 0.75 (1 - e), that of the table 0.75. */
            NEAR(f.elastic + f.damping * v, expected, 2e-15 * size + 1e-15 * fabs(expected) + (l >= 3) * 1e-12 * size);
        }
    free(table);
}

static void test_tsuji_table(void) {
    struct check_table *table = check_read("restitution_tsuji.csv");
    for (int row = 0; row < table->rows; row++) {
        double e = check_number(table, row, "e_nominal");
        struct normal pulls = unit_with("tsuji", "restitution", e), cut = unit_with("tsuji-cut", "restitution", e);
        double alpha = force_of(&pulls, scree_pressed(1.0, 1.0, 0.0, 0.0)).damping;
        double alpha_cut = force_of(&cut, scree_pressed(1.0, 1.0, 0.0, 0.0)).damping;
        NEAR(alpha, check_number(table, row, "alpha_T"), printed * (1.0 + alpha));
        /* Near e = 1 alpha is small, and e has the rounding of 1. */
        NEAR(alpha_cut, check_number(table, row, "alpha_C"), printed * (1.0 + alpha_cut));
        CLOSE(integrate(&pulls, 1.0).restitution, e, integrated);
        CLOSE(integrate(&cut, 1.0).restitution, e, integrated);
        struct normal crossed = unit_with("tsuji-cut", "alpha", check_number(table, row, "alpha_T"));
        CLOSE(closed_form(&crossed, 1.0), check_number(table, row, "e_cut_with_alpha_T"), printed);
        CLOSE(integrate(&crossed, 1.0).restitution, check_number(table, row, "e_cut_with_alpha_T"), integrated);
        struct normal fit = unit_with("tsuji-cut", "alpha", check_number(table, row, "alpha_T13"));
        CLOSE(closed_form(&fit, 1.0), check_number(table, row, "e_T13"), 1e-13); /* of an alpha with 15 digits */
    }
    free(table);
}

static void test_matched_table(void) {
    struct check_table *table = check_read("restitution_powerlaw_matched_dashpot.csv");
    for (int row = 0; row < table->rows; row++) {
        double p = check_number(table, row, "p"), alpha = check_number(table, row, "alpha");
        double pulling = check_number(table, row, "e_tension"), cut = check_number(table, row, "e_no_tension");
        scree_law_choice choice = {"matched", 3, {{"stiffness", 1.0}, {"exponent", p}, {"alpha", alpha}}};
        struct normal n = unit(choice);
        /* e = exp(-x): the rounding of x < 10 counts x times; overdamped bodies never part. */
        NEAR(closed_form(&n, 1.0), pulling, 2e-13 * pulling);
        NEAR(integrate(&n, 1.0).restitution, pulling, 10.0 * integrated * pulling);
        choice.law = "matched-cut";
        n = unit(choice);
        CLOSE(closed_form(&n, 1.0), cut, printed);
        CLOSE(integrate(&n, 1.0).restitution, cut, integrated);
    }
    free(table);
}

static void test_viscoelastic_tables(void) {
    struct check_table *table = check_read("restitution_viscoelastic_kuwabara_kono.csv");
    for (int row = 0; row < table->rows; row++) {
        double b = check_number(table, row, "b");
        struct normal pulls = unit_with("kuwabara-kono", "relaxation", b / 1.5);
        struct normal cut = unit_with("kuwabara-kono-cut", "relaxation", b / 1.5);
        struct scree_impact impact = integrate(&pulls, 1.0), shorter = integrate(&cut, 1.0);
        CLOSE(impact.restitution, check_number(table, row, "e_d0"), integrated);
        CLOSE(impact.duration, check_number(table, row, "tc_d0"), integrated);
        CLOSE(impact.deepest, check_number(table, row, "dmax"), integrated);
        CLOSE(shorter.restitution, check_number(table, row, "e_F0"), integrated);
        CLOSE(shorter.duration, check_number(table, row, "tc_F0"), integrated);
        /* Asked the other way round. What counts is what it delivers: the search ends at 1e-13 of e. */
        double e = check_number(table, row, "e_F0");
        scree_law_choice choice = {"kuwabara-kono-cut", 3, {{"stiffness", 7.0}, {"restitution", e}, {"speed", 0.3}}};
        struct normal asked = make(choice, 0.2, 1.0);
        NEAR(integrate(&asked, 0.3).restitution, e, integrated);
    }
    free(table);
    table = check_read("restitution_viscoelastic_examples.csv");
    for (int row = 0; row < table->rows; row++) {
        double radius = check_number(table, row, "R"), nu = check_number(table, row, "nu");
        double mass = 2.0 / 3.0 * 3.14159265358979323846 * radius * radius * radius * check_number(table, row, "rho");
        double young[2] = {check_number(table, row, "Y"), check_number(table, row, "Y")}, poisson[2] = {nu, nu};
        struct scree_elastic elastic = scree_elastic_of(young, poisson);
        scree_contact_def def = {.normal = {"kuwabara-kono-cut", 1, {{"relaxation", check_number(table, row, "A")}}}};
        struct normal n = {.mass = mass};
        CHECK(scree_bake_rule(&def, &elastic, &n.rule, NULL) == SCREE_OK);
        n.law = scree_normal_laws[n.rule.normal];
        n.pair = n.law->pair(&n.rule.normal_constants, mass, 0.5 * radius);
        struct scree_impact impact = integrate(&n, check_number(table, row, "v0_relative"));
        CLOSE(impact.restitution, check_number(table, row, "e_F0"), integrated);
        CLOSE(impact.duration, check_number(table, row, "contact_time"), integrated);
        CLOSE(impact.deepest, check_number(table, row, "dmax"), integrated);
    }
    free(table);
}

static const struct {
    const char *label, *law;
} family[] = {{"Hunt-Crossley 1975", "hunt-crossley-1975"},
              {"Herbert-McWhannell 1977", "herbert-mcwhannell"},
              {"Lee-Wang 1983", "lee-wang"},
              {"Lankarani-Nikravesh 1990", "lankarani-nikravesh"},
              {"Gonthier 2004", "gonthier"},
              {"Zhiying-Qishao 2006", "zhiying-qishao"},
              {"Flores 2011", "flores"},
              {"Hu-Guo 2015", "hu-guo"},
              {"exact inverse", "gonthier"}};
enum { FAMILY = sizeof family / sizeof family[0] };

static int member(const char *label) {
    for (int k = 0; k < FAMILY; k++)
        if (strcmp(family[k].label, label) == 0) return k;
    printf("the law \"%s\" of a table is unknown\n", label);
    check_failures++;
    return 0;
}

static struct normal of_family(int k, double exponent, double e) {
    return unit((scree_law_choice){
        family[k].law,
        4,
        {{"stiffness", 1.0}, {"exponent", exponent}, {"restitution", e}, {"calibrated", k == FAMILY - 1 ? 1.0 : 0.0}}});
}

static void test_family_tables(void) {
    struct check_table *table = check_read("restitution_hunt_crossley_family.csv");
    for (int row = 0; row < table->rows; row++) {
        int k = member(check_text(table, row, "law"));
        double e = check_number(table, row, "e_requested"), got = check_number(table, row, "e_actual");
        double elastic = pow(1.25, 0.4), speed = 3.0;
        struct normal n = of_family(k, 1.5, e), linear = of_family(k, 1.0, e);
        double d = force_of(&n, scree_pressed(1.0, speed, 0.0, 0.0)).damping * speed;
        /* The root of the exact relation is flat near e = 1, where D is small: its rounding is that of e. */
        NEAR(d, check_number(table, row, "d_c"), 1e-13 * d + 1e-14);
        CLOSE(closed_form(&n, speed), got, 1e-13);
        struct scree_impact impact = integrate(&n, 1.0), other = integrate(&linear, speed);
        CLOSE(impact.restitution, got, integrated);
        CLOSE(other.restitution, got, integrated);
        CLOSE(impact.deepest / elastic, check_number(table, row, "dmax_ratio_n1.5"), integrated);
        CLOSE(0.8 * pow(impact.deepest, 2.5), check_number(table, row, "peak_energy_ratio"), 3.0 * integrated);
        CLOSE(other.deepest * other.deepest / (speed * speed), check_number(table, row, "peak_energy_ratio"),
              3.0 * integrated);
    }
    free(table);
    table = check_read("restitution_hunt_crossley_summary.csv");
    for (int row = 0; row < table->rows; row++) {
        int k = member(check_text(table, row, "law"));
        double worst = check_number(table, row, "max_abs_error"), at = check_number(table, row, "at_e");
        struct normal n = of_family(k, 1.5, at), least = of_family(k, 1.5, 1e-9);
        if (k == FAMILY - 1) { /* asks and gets: rounding is all that is left */
            NEAR(closed_form(&n, 1.0), at, 1e-15);
            continue;
        }
        CLOSE(fabs(closed_form(&n, 1.0) - at), worst, 1e-5); /* six digits */
        NEAR(closed_form(&least, 1.0), check_number(table, row, "e_actual_as_e_req_to_0"), 1e-8);
        /* The table knows e in steps of up to 0.05, all of which lie on the finer grid. */
        static const double tolerances[] = {0.001, 0.01, 0.05};
        static const char *const columns[] = {"e_min_err_0.001", "e_min_err_0.01", "e_min_err_0.05"};
        for (int c = 0; c < 3; c++) {
            struct scree_validity validity = scree_validity_of(n.law, tolerances[c]);
            double from = check_number(table, row, columns[c]);
            CHECK(validity.asked && validity.from <= from + 1e-12 && validity.from > from - 0.05);
        }
    }
    free(table);
}

static void test_jankowski_table(void) {
    struct check_table *table = check_read("restitution_jankowski.csv");
    for (int row = 0; row < table->rows; row++) {
        double e = check_number(table, row, "e_requested");
        struct normal n = unit_with("jankowski", "restitution", e);
        struct normal calibrated =
            unit((scree_law_choice){"jankowski", 3, {{"stiffness", 1.0}, {"restitution", e}, {"calibrated", 1.0}}});
        CLOSE(0.5 * force_of(&n, scree_pressed(1.0, 1.0, 0.0, 0.0)).damping, check_number(table, row, "xi"), 1e-14);
        CLOSE(closed_form(&n, 1.0), check_number(table, row, "e_actual"), 1e-11); /* the table has about 11 digits */
        CLOSE(integrate(&n, 1.0).restitution, closed_form(&n, 1.0), integrated);
        CLOSE(integrate(&calibrated, 2.0).restitution, e, integrated);
    }
    free(table);
}

static void test_linear_tables(void) {
    struct check_table *table = check_read("restitution_linear_dashpot.csv");
    for (int row = 0; row < table->rows; row++) {
        double e = check_number(table, row, "e_nominal");
        struct normal pulls = unit_with("linear", "restitution", e), cut = unit_with("linear-cut", "restitution", e);
        struct normal wrong = unit_with("anagnostopoulos", "restitution", e);
        struct scree_impact with_pull = integrate(&pulls, 1.0), with_cut = integrate(&cut, 1.0);
        struct scree_impact with_wrong = integrate(&wrong, 1.0);
        CLOSE(with_pull.restitution, e, integrated);
        CLOSE(with_pull.duration, check_number(table, row, "omega0_tc_tension_zeta_T"), integrated);
        CLOSE(with_cut.restitution, e, integrated);
        CLOSE(with_cut.duration, check_number(table, row, "omega0_tc_cutoff_zeta_C"), integrated);
        CLOSE(closed_form(&wrong, 1.0), check_number(table, row, "e_cut_with_zeta_T"), 1e-13);
        CLOSE(with_wrong.restitution, check_number(table, row, "e_cut_with_zeta_T"), integrated);
        CLOSE(with_wrong.duration, check_number(table, row, "omega0_tc_cutoff_zeta_T"), integrated);
        struct normal crossed = unit_with("linear", "damping", 2.0 * check_number(table, row, "zeta_C"));
        double expected = check_number(table, row, "e_tension_with_zeta_C");
        /* exp(-x) with x up to 8, and a zeta that near 1 is divided by sqrt(1 - zeta). */
        NEAR(closed_form(&crossed, 1.0), expected, 1e-12 * expected);
    }
    free(table);
    table = check_read("restitution_linear_vs_zeta.csv");
    for (int row = 0; row < table->rows; row++) {
        double zeta = check_number(table, row, "zeta"), expected = check_number(table, row, "e_tension");
        if (fabs(zeta - sqrt(0.5)) < 1e-8) zeta = sqrt(0.5); /* which the table prints with 8 digits */
        if (strstr(check_text(table, row, "e_tension"), "never")) expected = 0.0;
        struct normal n = unit_with("linear", "damping", 2.0 * zeta);
        /* At the end the motion has shrunk to e: what was lost to rounding before counts 1/e times, less what damping
         * forgives. */
        NEAR(integrate(&n, 1.0).restitution, expected, integrated * (expected < 1e-3 ? 100.0 : 1.0) * expected);
    }
    free(table);
}

static void test_walton_table(void) {
    struct check_table *table = check_read("restitution_walton_braun.csv");
    for (int row = 0; row < table->rows; row++) {
        const char *value = strchr(check_text(table, row, "parameter"), '=');
        int constant = strcmp(check_text(table, row, "variant"), "constant") == 0;
        double number = value ? strtod(value + 1, NULL) : NAN, e = check_number(table, row, "e");
        struct normal n = constant ? unit_with("walton-braun", "unloading", number)
                                   : unit_with("walton-braun-variable", "slope", number);
        /* The way back is 1/e^2 times as stiff: the rounding of the largest overlap counts as much more in its
         * force. */
        double tolerance = integrated + 1e-14 / (e * e);
        CLOSE(closed_form(&n, 1.0), e, printed);
        struct scree_impact impact = integrate(&n, 1.0);
        CLOSE(impact.restitution, e, tolerance);
        CLOSE(impact.duration, check_number(table, row, "omega0_tc"), integrated);
        CLOSE(impact.deepest, 1.0, integrated);
        scree_law_choice by_e = {constant ? "walton-braun" : "walton-braun-variable",
                                 constant ? 2 : 3,
                                 {{"stiffness", 1.0}, {"restitution", e}, {"speed", 2.0}}};
        struct normal asked = unit(by_e);
        CLOSE(integrate(&asked, 2.0).restitution, e, tolerance);
    }
    free(table);
}

static void test_thornton_table(void) {
    struct check_table *table = check_read("restitution_thornton_elastoplastic.csv");
    const double pi = 3.14159265358979323846, modulus = 2.0, yield = 0.3;
    for (int row = 0; row < table->rows; row++) {
        struct normal n = unit((scree_law_choice){"thornton", 2, {{"modulus", modulus}, {"yield", yield}}});
        double first = pow(0.5 * pi / modulus, 2.0) * sqrt(8.0 * pi / 15.0) * pow(yield, 2.5);
        double ratio = check_number(table, row, "Vi_over_Vy"), speed = ratio * first;
        double yield_overlap = pow(0.5 * pi * yield / modulus, 2.0);
        double yield_force = 4.0 / 3.0 * modulus * pow(yield_overlap, 1.5);
        struct scree_impact impact = integrate(&n, speed);
        CLOSE(closed_form(&n, speed), check_number(table, row, "e_formula"), 1e-13);
        CLOSE(impact.restitution, check_number(table, row, "e_direct"), integrated);
        CLOSE(impact.deepest / yield_overlap, check_number(table, row, "dmax_over_dy"), integrated);
        CLOSE(impact.force / yield_force, check_number(table, row, "Fmax_over_Fy"), integrated);
        /* The overlap that is left: where the unloading force has just vanished. */
        double left = check_number(table, row, "d_residual_over_dy") * yield_overlap;
        struct scree_pressing just = scree_pressed(left * (1.0 + 1e-9), -1.0, impact.deepest, 0.0);
        if (left > 1e-20) CHECK(force_of(&n, just).elastic > 0.0);
        just.overlap = left * (1.0 - 1e-9);
        CHECK(force_of(&n, just).elastic == 0.0);
        /* Rp/R: unloading is Hertz's law with that radius. */
        double radius = check_number(table, row, "Rp_over_R"), middle = 0.5 * (impact.deepest + left);
        just.overlap = middle;
        CLOSE(force_of(&n, just).elastic, 4.0 / 3.0 * modulus * sqrt(radius) * pow(middle - left, 1.5), 1e-9);
    }
    free(table);
}

/* An independent integration of the plain equation (DOP853); its contact times have its error, some 1e-12. */
static void test_crosscheck(void) {
    struct check_table *table = check_read("restitution_crosscheck.csv");
    for (int row = 0; row < table->rows; row++) {
        const char *law = check_text(table, row, "law"), *text = check_text(table, row, "parameter_end");
        const char *first = strchr(text, '='), *second = first ? strchr(first + 1, '=') : NULL;
        double a = first ? strtod(first + 1, NULL) : NAN, b = second ? strtod(second + 1, NULL) : NAN;
        int cut = strstr(text, "cutoff") || strstr(text, "F0");
        scree_law_choice choice = {cut ? "linear-cut" : "linear", 2, {{"stiffness", 1.0}, {"damping", 2.0 * a}}};
        if (strcmp(law, "Tsuji") == 0)
            choice = (scree_law_choice){cut ? "tsuji-cut" : "tsuji", 2, {{"stiffness", 1.0}, {"alpha", a}}};
        if (strcmp(law, "Kuwabara-Kono") == 0)
            choice = (scree_law_choice){
                cut ? "kuwabara-kono-cut" : "kuwabara-kono", 2, {{"stiffness", 1.0}, {"relaxation", a / 1.5}}};
        if (strcmp(law, "Hunt-Crossley") == 0)
            choice = (scree_law_choice){"hunt-crossley", 3, {{"stiffness", 1.0}, {"factor", a}, {"exponent", b}}};
        if (strcmp(law, "power law") == 0)
            choice = (scree_law_choice){"matched-cut", 3, {{"stiffness", 1.0}, {"exponent", a}, {"alpha", b}}};
        struct normal n = unit(choice);
        struct scree_impact impact = integrate(&n, 1.0);
        CLOSE(impact.restitution, check_number(table, row, "e_ref"), integrated);
        CLOSE(impact.duration, check_number(table, row, "t_contact_ode"), 1e-11);
    }
    free(table);
}

/* ---- what every law keeps to ---- */

/* At least one choice for each law; lengths of 1e-4 … 1e-3 m, forces of 1 … 100 N. */
static const scree_law_choice samples[] = {
    {"linear", 2, {{"stiffness", 1e5}, {"restitution", 0.5}}},
    {"linear-cut", 2, {{"stiffness", 1e5}, {"restitution", 0.2}}},
    {"linear-loading", 2, {{"stiffness", 1e5}, {"restitution", 0.7}}},
    {"blend", 4, {{"stiffness", 1e6}, {"exponent", 1.3}, {"damping", 50.0}, {"full", 1e-4}}},
    {"hunt-crossley", 3, {{"stiffness", 1e6}, {"exponent", 1.5}, {"factor", 0.4}}},
    {"impact", 4, {{"stiffness", 1e6}, {"exponent", 2.2}, {"damping", 50.0}, {"full", 1e-4}}},
    {"hertz", 1, {{"modulus", 1e8}}},
    {"tsuji", 2, {{"modulus", 1e8}, {"restitution", 0.5}}},
    {"tsuji-cut", 2, {{"stiffness", 1e7}, {"alpha", 0.6}}},
    {"matched", 3, {{"stiffness", 1e9}, {"exponent", 2.0}, {"restitution", 0.6}}},
    {"matched-cut", 3, {{"stiffness", 1e6}, {"exponent", 1.2}, {"restitution", 0.3}}},
    {"kuwabara-kono", 2, {{"modulus", 1e8}, {"relaxation", 2e-5}}},
    {"kuwabara-kono-cut", 3, {{"modulus", 1e8}, {"restitution", 0.6}, {"speed", 0.5}}},
    {"hunt-crossley-1975", 2, {{"stiffness", 1e7}, {"restitution", 0.1}}},
    {"herbert-mcwhannell", 2, {{"stiffness", 1e7}, {"restitution", 0.3}}},
    {"lee-wang", 3, {{"stiffness", 1e7}, {"restitution", 0.9}, {"exponent", 1.7}}},
    {"lankarani-nikravesh", 2, {{"stiffness", 1e7}, {"restitution", 0.5}}},
    {"gonthier", 3, {{"stiffness", 1e5}, {"restitution", 0.1}, {"exponent", 1.0}}},
    {"zhiying-qishao", 2, {{"stiffness", 1e7}, {"restitution", 0.5}}},
    {"flores", 3, {{"stiffness", 1e7}, {"restitution", 0.05}, {"calibrated", 1.0}}},
    {"hu-guo", 2, {{"stiffness", 1e7}, {"restitution", 0.2}}},
    {"jankowski", 2, {{"modulus", 1e8}, {"restitution", 0.4}}},
    {"anagnostopoulos", 2, {{"stiffness", 1e5}, {"restitution", 0.4}}},
    {"walton-braun", 2, {{"stiffness", 1e5}, {"restitution", 0.4}}},
    {"walton-braun-variable", 2, {{"stiffness", 1e5}, {"slope", 3e3}}},
    {"thornton", 2, {{"modulus", 1e8}, {"yield", 3e6}}},
    {"jkr", 2, {{"modulus", 1e8}, {"adhesion", 5.0}}},
    {"dmt", 2, {{"modulus", 1e8}, {"adhesion", 5.0}}},
};
enum { SAMPLES = sizeof samples / sizeof samples[0] };

static void test_all_are_sampled(void) {
    for (int l = 0; scree_normal_laws[l]; l++) {
        int found = strcmp(scree_normal_laws[l]->text.name, "table") == 0; /* takes forces: test_laws.c */
        for (int s = 0; s < SAMPLES; s++) found |= strcmp(samples[s].law, scree_normal_laws[l]->text.name) == 0;
        if (!found) printf("test_normal_laws lacks the law \"%s\"\n", scree_normal_laws[l]->text.name);
        CHECK(found);
    }
}

/* Over masses, radii and speeds: no energy gained, and the closed form delivered. */
static void test_impacts(void) {
    uint64_t seed = 5;
    for (int s = 0; s < SAMPLES; s++)
        for (int trial = 0; trial < 12; trial++) {
            double mass = 0.03 * pow(10.0, check_between(&seed, -1.0, 1.0));
            double speed = pow(10.0, check_between(&seed, -1.0, 0.5)), radius = check_between(&seed, 0.005, 0.02);
            struct normal n = make(samples[s], mass, radius);
            struct scree_impact impact = integrate(&n, speed);
            CHECK(impact.restitution <= 1.0 + integrated && impact.restitution >= 0.0);
            CHECK(impact.deepest > 0.0 && impact.duration > 0.0 && impact.force > 0.0);
            if (n.law->restitution) NEAR(impact.restitution, closed_form(&n, speed), integrated);
        }
}

/* A way in, half back, further in, and out: with the speed of an oscillation, which vanishes where the way turns. */
struct way {
    double from, to;
};

/* What was seen along the way. */
struct seen {
    double stored, sum, largest, jump; /* J, J, N, N */
};

static void walk(const struct normal *n, struct way way, int parts, struct scree_pressing *at, struct seen *seen) {
    double h = (way.to - way.from) / parts, before = NAN;
    for (int k = 0; k < parts; k++) {
        double phase = (k + 0.5) / parts, direction = h > 0.0 ? 1.0 : -1.0;
        at->closing = direction * 0.3 * sqrt(phase * (1.0 - phase));
        at->overlap = way.from + (k + 0.5) * h;
        struct scree_normal_force f = force_of(n, *at);
        double raw = f.elastic + f.damping * at->closing;
        double force = n->law->cut && raw < 0.0 ? 0.0 : raw, size = fabs(f.elastic) + fabs(f.damping * at->closing);
        /* No power is made. */
        CHECK((force - f.reversible) * at->closing >= -1e-12 * size);
        seen->sum += h * f.reversible;
        if (phase > 0.01 && fabs(at->overlap) > 2e-5) seen->jump = scree_most(seen->jump, fabs(force - before));
        before = force;
        seen->largest = scree_most(seen->largest, fabs(force));
        at->overlap = way.from + (k + 1) * h;
        f = force_of(n, *at);
        at->first = f.first;
        at->second = f.second;
    }
    seen->stored = stored_of(n, *at);
}

static struct seen walk_all(const struct normal *n, int parts) {
    static const struct way ways[] = {{0.0, 4e-4}, {4e-4, 3.5e-4}, {3.5e-4, 6e-4}, {6e-4, 0.0}};
    struct scree_pressing at = scree_pressed(1e-12, 0.1, 0.0, 0.0);
    struct scree_normal_force touch = force_of(n, at);
    at.first = touch.first;
    at.second = touch.second;
    struct seen seen = {.sum = stored_of(n, at)};
    for (int k = 0; k < 4; k++) {
        walk(n, ways[k], parts, &at, &seen);
        /* The midpoint rule: (1/parts)^(3/2) at worst, where the force begins or ends like a root. */
        if (k < 3) NEAR(seen.sum, seen.stored, 1e-5 * seen.largest * 6e-4);
    }
    return seen;
}

static void test_energy(void) {
    for (int s = 0; s < SAMPLES; s++) {
        struct normal n = make(samples[s], 0.03, 0.01);
        struct seen coarse = walk_all(&n, 2000), fine = walk_all(&n, 8000);
        /* A continuous force changes a quarter as much in steps a quarter as long, half as much where the speed turns
         * like a root, a little more where spring and dashpot cancel there; a jump stays. */
        CHECK(fine.jump < 0.7 * coarse.jump);
    }
}

/* ---- ask and get ---- */

static void ask(scree_law_choice choice, const char *parameter) {
    struct scree_wish wish = {.speed = 0.7, .mass = 0.02, .radius = 0.01, .tolerance = 1e-11};
    for (int k = 1; k <= 9; k++) {
        wish.restitution = 0.1 * k;
        double value = NAN;
        scree_trouble trouble = {0};
        CHECK(scree_ask(&choice, NULL, parameter, &wish, &value, &trouble) == SCREE_OK);
        scree_law_choice full = choice;
        full.setting[full.settings++] = (scree_setting){parameter, value};
        struct normal n = make(full, wish.mass, wish.radius);
        NEAR(integrate(&n, wish.speed).restitution, wish.restitution, 2e-11);
    }
    wish.restitution = 1.0;
    double value = NAN;
    CHECK(scree_ask(&choice, NULL, parameter, &wish, &value, NULL) == SCREE_OK);
    CHECK(value == 0.0);
}

static void test_ask(void) {
    ask((scree_law_choice){"impact", 3, {{"stiffness", 1e6}, {"exponent", 1.5}, {"full", 1e-4}}}, "damping");
    ask((scree_law_choice){"kuwabara-kono", 1, {{"modulus", 1e8}}}, "relaxation");
    ask((scree_law_choice){"kuwabara-kono-cut", 1, {{"modulus", 1e8}}}, "relaxation");
    ask((scree_law_choice){"jankowski", 1, {{"modulus", 1e8}}}, "xi");
    ask((scree_law_choice){"hunt-crossley", 1, {{"stiffness", 1e7}}}, "factor");
    ask((scree_law_choice){"walton-braun-variable", 1, {{"stiffness", 1e5}}}, "slope");
    scree_law_choice blend = {"blend", 2, {{"stiffness", 1e6}, {"full", 1e-5}}};
    struct scree_wish wish = {0.5, 0.7, 0.02, 0.01, 1e-11};
    double value;
    scree_trouble trouble = {0};
    CHECK(scree_ask(&blend, NULL, "damping", &wish, &value, &trouble) == SCREE_OK);
    CHECK(scree_ask(&blend, NULL, "dampin", &wish, &value, &trouble) == SCREE_BAD_INPUT);
    CONTAINS(trouble.text, "did you mean \"damping\"");
    wish.restitution = 1.5;
    CHECK(scree_ask(&blend, NULL, "damping", &wish, &value, &trouble) == SCREE_BAD_INPUT);
}

/* Laws that say they deliver do; the others are found out. */
static void test_validity(void) {
    static const char *const exact[] = {"linear", "linear-cut", "linear-loading", "tsuji", "tsuji-cut", "walton-braun"};
    for (size_t k = 0; k < sizeof exact / sizeof exact[0]; k++) {
        struct scree_validity validity = scree_validity_of(scree_normal_laws[scree_find_normal_law(exact[k])], 0.01);
        CHECK(validity.asked && validity.from == 0.0 && validity.worst < 1e-12);
    }
    struct scree_validity cut = scree_validity_of(scree_normal_laws[scree_find_normal_law("anagnostopoulos")], 0.01);
    CHECK(cut.from > 0.7 && cut.from < 0.85 && cut.worst > 0.16);
    CHECK(!scree_validity_of(scree_normal_laws[scree_find_normal_law("blend")], 0.01).asked);
}

/* ---- what is refused ---- */

static void refuse(scree_law_choice choice, const char *part) {
    scree_contact_def def = {.normal = choice};
    struct scree_rule rule;
    scree_trouble trouble = {0};
    CHECK(scree_bake_rule(&def, NULL, &rule, &trouble) == SCREE_BAD_INPUT);
    CONTAINS(trouble.text, part);
}

static const char sharp_text[] =
    "[time]\nend = 1.0\n[[material]]\nname = \"m\"\ndensity = 1000\nyoung = 1e7\npoisson = 0.3\n"
    "[[contact]]\nbetween = [\"m\", \"m\"]\nnormal = { law = \"hertz\" }\n"
    "[[body]]\nname = \"floor\"\nmaterial = \"m\"\nshape = { plane = true }\njoint = \"fixed\"\n"
    "[[body]]\nname = \"brick\"\nmaterial = \"m\"\nshape = { box = [0.01, 0.01, 0.01] }\nposition = [0, 0, 0.02]\n";

static void test_refusals(void) {
    refuse((scree_law_choice){"walton-braun", 2, {{"stiffness", 2.0}, {"unloading", 1.0}}}, "gain energy");
    refuse((scree_law_choice){"walton-braun-variable", 2, {{"stiffness", 2.0}, {"restitution", 0.5}}}, "impact speed");
    refuse((scree_law_choice){"kuwabara-kono", 2, {{"stiffness", 2.0}, {"restitution", 0.5}}}, "impact speed");
    refuse((scree_law_choice){"flores", 3, {{"stiffness", 2.0}, {"restitution", 0.5}, {"calibrated", 0.5}}}, "0 or 1");
    refuse((scree_law_choice){"hertz", 0, {{0}}}, "`young` and `poisson`");
    refuse((scree_law_choice){"hertz", 2, {{"stiffness", 1.0}, {"modulus", 1.0}}}, "not both");
    refuse((scree_law_choice){"jkr", 1, {{"adhesion", 1.0}}}, "needs modulus");
    /* Sharp corners have no Hertzian stiffness; rounded ones, and a stiffness, do. */
    scree_scene *scene;
    struct scree_run_request request;
    scree_trouble trouble;
    CHECK(scree_read_scene(sharp_text, strlen(sharp_text), "sharp.toml", NULL, 0, 0, &scene, &request, &trouble) ==
          SCREE_BAD_INPUT);
    CONTAINS(trouble.text, "are sharp");
    scree_free_request(&request);
    static const char *const cures[] = {"body.brick.shape={box=[0.01, 0.01, 0.01], rounding=0.001}",
                                        "contact.0.normal={law=\"hertz\", stiffness=1e6}"};
    for (int k = 0; k < 2; k++) scree_scene_destroy(scene_from(sharp_text, &cures[k], 1, 0));
}

/* ---- adhesion ---- */

static void test_jkr_force(void) {
    const double pi = 3.14159265358979323846, w = 5.0, modulus = 1e8, radius = 0.01;
    struct normal n = make((scree_law_choice){"jkr", 2, {{"modulus", modulus}, {"adhesion", w}}}, 0.03, radius);
    double contact = cbrt(pi * w * radius * radius / (8.0 * modulus)), length = contact * contact / radius;
    double reach = n.law->reach(&n.rule.normal_constants, n.pair), least = 0.0;
    CLOSE(reach, 3.0 * length, 1e-14);
    /* From the contact's radius to overlap and force by the formulas of the paper, and back by the law. */
    for (int k = 0; k <= 4000; k++) {
        double a = contact * (1.0 + 1e-3 * k * k / 40.0);
        double d = a * a / radius - sqrt(2.0 * pi * w * a / modulus);
        double f = 4.0 * modulus * a * a * a / (3.0 * radius) - sqrt(8.0 * pi * w * modulus * a * a * a);
        double size = 4.0 * modulus * a * a * a / (3.0 * radius) + 2.0 * pi * w * radius;
        /* Near the pull-off distance, x = 1, the overlap changes by 6 (x - 1)^2 only: its rounding counts 1/(x - 1)
         * times; at the distance itself rounding decides whether it still holds. */
        double beyond = sqrt(a / contact) - 1.0;
        if (k > 0) NEAR(force_of(&n, scree_pressed(d, 0.0, 0.0, 1.0)).elastic, f, (1e-15 / beyond + 1e-14) * size);
        least = scree_least(least, f);
    }
    double at_least = -cbrt(3.0) * length;
    CLOSE(force_of(&n, scree_pressed(at_least, 0.0, 0.0, 1.0)).elastic, -1.5 * pi * w * radius, 1e-14);
    CHECK(least >= -1.5 * pi * w * radius * (1.0 + 1e-14));
    CHECK(force_of(&n, scree_pressed(-1.001 * reach, 0.0, 0.0, 1.0)).second == 0.0);
    CHECK(force_of(&n, scree_pressed(-0.5 * length, 0.0, 0.0, 0.0)).second == 0.0); /* never touched */
    struct normal dmt = make((scree_law_choice){"dmt", 2, {{"modulus", modulus}, {"adhesion", w}}}, 0.03, radius);
    CLOSE(force_of(&dmt, (struct scree_pressing){.overlap = 1e-300}).elastic, -2.0 * pi * w * radius, 1e-14);
    /* Too slow to part again. */
    double loss = (2.4 * cbrt(4.0) + 0.4) * pi * w * contact * contact, escape = sqrt(2.0 * loss / 0.03);
    CHECK(integrate(&n, 0.99 * escape).restitution == 0.0);
    CHECK(integrate(&n, 1.01 * escape).restitution > 0.1);
}

#define HANGING                                                                                                        \
    "[time]\nintegrator = \"verlet\"\nend = 1.0\nstep = 1e-6\n[output]\nevery = 1e-3\nwrite = [\"energy.csv\"]\n"      \
    "[[material]]\nname = \"soft\"\ndensity = 1000\nyoung = 2e6\npoisson = 0.5\n"                                      \
    "[[contact]]\nbetween = [\"soft\", \"soft\"]\nnormal = { law = \"%s\", adhesion = 0.5 }\n"                         \
    "[[body]]\nname = \"top\"\nmaterial = \"soft\"\nshape = { sphere = 0.002 }\njoint = \"fixed\"\n"                   \
    "[[body]]\nname = \"low\"\nmaterial = \"soft\"\nshape = { sphere = 0.002 }\nposition = [0, 0, %.17g]\n"            \
    "velocity = [0, 0, %.17g]\n"

static scree_scene *hanging(const char *law, double height, double velocity, double weight) {
    char text[2048], gravity[80];
    snprintf(text, sizeof text, HANGING, law, height, velocity);
    snprintf(gravity, sizeof gravity, "gravity=[0,0,%.17g]", -weight);
    const char *changes[] = {gravity};
    return scene_from(text, changes, 1, 0);
}

static int touching(scree_scene *scene) {
    int count = 0;
    CHECK(scree_scene_contacts(scene, NULL, 0, &count) == SCREE_OK);
    return count;
}

/* The list made anew after every so many steps, as it is when bodies travel. */
static void go_with_new_lists(scree_scene *scene, int steps, int every) {
    for (int k = 0; k < steps; k += every) {
        go(scene, every);
        CHECK(scree_contacts_list(&scene->contacts, &scene->bodies, 1, NULL) == SCREE_OK);
    }
}

/* E* = E/(2 (1 - nu^2)) of the scene above, effective radius 1 mm. */
static const double modulus_there = 2e6 / 1.5, radius_there = 1e-3, work_there = 0.5;

/* Pulled apart, the bodies hold until the analytic distance, whatever happens to the list meanwhile. */
static void test_reach(void) {
    const double pi = 3.14159265358979323846;
    double contact = cbrt(pi * work_there * radius_there * radius_there / (8.0 * modulus_there));
    double reach = 3.0 * contact * contact / radius_there;
    static const int every[] = {1, 7, 100000};
    for (int k = 0; k < 3; k++) {
        scree_scene *scene = hanging("jkr", -0.00399, -1.0, 0.0);
        scene->contacts.skin = fmin(scene->contacts.skin, 1.2 * reach);
        double farthest = 0.0, gap = 0.0;
        for (int step = 0; step < 2000 && gap < 2.0 * reach; step++) {
            go(scene, 1);
            if (step % every[k] == 0) CHECK(scree_contacts_list(&scene->contacts, &scene->bodies, 1, NULL) == SCREE_OK);
            gap = -scree_scene_body(scene, 1).position[2] - 0.004;
            if (touching(scene)) farthest = scree_most(farthest, gap);
        }
        CHECK(gap > reach);
        /* It lets go in the middle of a step, 1e-6 m long. */
        NEAR(farthest, reach, 1.1e-6);
        scree_scene_destroy(scene);
    }
    /* So soft that they reach farther than lists usually do, 3.0 mm against 2 mm: planning sees to it. */
    static const char *const soft[] = {"contact.0.normal={law=\"jkr\", modulus=200.0, adhesion=0.5}"};
    char text[2048];
    snprintf(text, sizeof text, HANGING, "jkr", -0.0042, 0.0);
    scree_scene *scene = scene_from(text, soft, 1, 0);
    contact = cbrt(pi * work_there * radius_there * radius_there / (8.0 * 200.0));
    CHECK(3.0 * contact * contact / radius_there > 0.0029);
    CHECK(scene->contacts.skin > 3.0 * contact * contact / radius_there);
    scree_scene_destroy(scene);
}

/* In a scene, a weight a little below the pull-off force goes on hanging, one a little above falls: the body starts at
 * the overlap where the law pulls hardest, has been attached before, and is at rest. */
static void check_pull_off(const char *law, double overlap, double pull) {
    const double mass = 1000.0 * 4.0 / 3.0 * 3.14159265358979323846 * 8e-9;
    for (int heavy = 0; heavy < 2; heavy++) {
        scree_scene *scene = hanging(law, -0.004 + overlap, 0.0, pull * (heavy ? 1.001 : 0.999) / mass);
        struct scree_contacts *contacts = &scene->contacts;
        CHECK(contacts->busy_batches == 1);
        struct scree_batch *batch = &contacts->batch[contacts->busy[0]];
        if (batch->memory) batch->kept[SCREE_KEPT_NORMAL + 1][0] = 1.0;
        go_with_new_lists(scene, 40000, 1000);
        CHECK(touching(scene) == !heavy);
        scree_scene_destroy(scene);
    }
}

static void test_pull_off(void) {
    const double pi = 3.14159265358979323846;
    double contact = cbrt(pi * work_there * radius_there * radius_there / (8.0 * modulus_there));
    double pull = pi * work_there * radius_there;
    check_pull_off("jkr", -cbrt(3.0) * contact * contact / radius_there, 1.5 * pull);
    check_pull_off("dmt", 1e-9, 2.0 * pull);
}

/* An impact with adhesion in a scene: restitution by closed form, and attaching booked as a loss. */
static void test_adhesive_impact(void) {
    const double mass = 1000.0 * 4.0 / 3.0 * 3.14159265358979323846 * 8e-9, speed = 0.05;
    scree_scene *scene = hanging("jkr", -0.00401, speed, 0.0);
    go(scene, 20);
    const struct scree_contacts *contacts = &scene->contacts;
    const struct scree_batch *batch = &contacts->batch[contacts->busy[0]];
    const struct scree_rule *rule = &contacts->rule[batch->rule];
    const struct scree_normal_law *law = scree_normal_laws[rule->normal];
    struct scree_pair_constants pair = law->pair(&rule->normal_constants, mass, radius_there);
    double e = law->restitution(&rule->normal_constants, pair, mass, speed), energy = 0.5 * mass * speed * speed;
    int met = 0;
    for (int k = 0; k < 4000 && !(met && !touching(scene)); k++) {
        go(scene, 1);
        met |= touching(scene);
    }
    scree_energy now;
    CHECK(scree_scene_energy(scene, &now) == SCREE_OK);
    CHECK(met && !touching(scene) && now.stored == 0.0);
    /* The pull of up to 1.3 pi w R sets in and ends anywhere in a step of 1e-6 s: an impulse of that over m u, were it
     * not shared out; what is left is that it ends like a root. */
    double impulse = 1.3 * 3.14159265358979323846 * work_there * radius_there * 1e-6 / (mass * speed);
    double tolerance = impulse * sqrt(impulse);
    NEAR(-scree_scene_body(scene, 1).velocity[2] / speed, e, tolerance);
    NEAR(now.lost_normal / energy, 1.0 - e * e, 2.0 * tolerance);
    NEAR(now.balance / energy, 0.0, 2.0 * tolerance);
    CHECK(e < 0.9);
    scree_scene_destroy(scene);
    /* Bodies that overlap at the start attach in the first step, and that isn't lost twice. */
    scene = hanging("jkr", -0.0039999, 0.0, 0.0);
    go(scene, 50);
    CHECK(touching(scene) && scree_scene_energy(scene, &now) == SCREE_OK);
    CHECK(now.lost_normal > 1e-8);
    /* Position Verlet keeps the energy to (step/period)^2, some 1e-5, of what swings. */
    NEAR(now.balance, 0.0, 1e-3 * now.lost_normal);
    scree_scene_destroy(scene);
}

int main(void) {
    test_hertz_constants();
    test_unit_values();
    test_tsuji_table();
    test_matched_table();
    test_viscoelastic_tables();
    test_family_tables();
    test_jankowski_table();
    test_linear_tables();
    test_walton_table();
    test_thornton_table();
    test_crosscheck();
    test_all_are_sampled();
    test_impacts();
    test_energy();
    test_ask();
    test_validity();
    test_refusals();
    test_jkr_force();
    test_reach();
    test_pull_off();
    test_adhesive_impact();
    return check_report();
}
