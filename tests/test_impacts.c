/* contact/encounter: oblique impacts of one pair against closed forms and 40-digit tables, and energy for every pair of laws. */
#include "contact/encounter.h"

#include "tests/check.h"

static const double pi = 3.14159265358979323846;

static struct scree_rule make_rule(scree_law_choice normal, scree_law_choice friction) {
    struct scree_rule rule = {0};
    scree_contact_def def = {.normal = normal, .friction = friction};
    scree_trouble trouble = {0};
    CHECK(scree_bake_rule(&def, NULL, &rule, &trouble) == SCREE_OK);
    if (trouble.text[0]) printf("  %s\n", trouble.text);
    return rule;
}

static const struct quat upright = {1.0, 0.0, 0.0, 0.0};

/* A sphere above a plane that nothing moves, with the centre's velocity (x along the plane, z down is negative). */
static struct scree_encounter sphere_on_plane(double radius, double mass, double along, double down) {
    scree_shape sphere = {.kind = SCREE_SPHERE, .radius = radius}, plane = {.kind = SCREE_PLANE};
    struct scree_encounter e = {.normal = {0.0, 0.0, 1.0}, .radius = radius};
    e.ball = scree_partner_of(&sphere, mass, upright, vec(0.0, 0.0, -1.0));
    e.host = scree_partner_of(&plane, 0.0, upright, vec(0.0, 0.0, 1.0));
    e.ball.velocity = vec(along, 0.0, -down);
    return e;
}

static double energy(const struct scree_partner *body) {
    return 0.5 * vec_norm2(body->velocity) / body->inverse_mass +
           0.5 * vec_norm2(body->spin) / body->inverse_moments[0];
}

/* What was lost is in the books. */
static void check_books(const struct scree_encounter *e, const struct scree_outcome_of_impact *after) {
    double before = energy(&e->ball), left = energy(&after->ball);
    NEAR((before - left - after->lost_normal - after->lost_tangential) / before, 0.0, 1e-10);
}

/* Cundall-Strack springs, e = 1: the table's 15 digits. */
static void test_linear_springs(void) {
    struct check_table *table = check_read("oblique_lsd_mfix_dem05.csv");
    double stiffness = 1.72e7, mass = 4000.0 * 4.0 / 3.0 * pi * 0.0025 * 0.0025 * 0.0025;
    struct scree_rule rule =
        make_rule((scree_law_choice){"linear-cut", 2, {{"stiffness", stiffness}, {"restitution", 1.0}}},
                  (scree_law_choice){"coulomb", 3, {{"static", 0.092}, {"kinetic", 0.092}, {"stiffness", 1.48e7}}});
    CHECK(table->rows > 15);
    for (int row = 0; row < table->rows; row++) {
        double angle = check_number(table, row, "angle_deg") * pi / 180.0;
        struct scree_encounter e = sphere_on_plane(0.0025, mass, 3.9 * sin(angle), 3.9 * cos(angle));
        struct scree_outcome_of_impact after = scree_meet(&e, &rule, NULL, NULL);
        CHECK(after.ending == SCREE_PARTED);
        NEAR(after.restitution, 1.0, 1e-10);
        double slip = after.ball.velocity.x + vec_cross(after.ball.spin, after.ball.arm).x;
        NEAR(slip / e.ball.velocity.z, -check_number(table, row, "vs_rebound_over_vn"), 1e-9);
        NEAR(after.ball.velocity.x / e.ball.velocity.x, check_number(table, row, "e_t"), 1e-9);
               after.ball.velocity.x / e.ball.velocity.x - check_number(table, row, "e_t"), after.restitution - 1);
        NEAR(after.duration, pi * sqrt(mass / stiffness), 1e-10 * after.duration);
        check_books(&e, &after);
    }
    free(table);
}

int main(void) {
    test_linear_springs();
    return check_report();
}
