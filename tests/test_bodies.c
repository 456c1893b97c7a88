/* bodies/: elementary functions, shapes, motions, and how one body moves alone. */
#include "bodies/bodies.h"
#include "bodies/elementary.h"

#include "tests/check.h"

static const double pi = 3.14159265358979323846;

/* ---- elementary functions ---- */

/* Error in units of the last place of the true value, computed in long double by the maths library. */
static double ulps(double value, long double truth) {
    double t = (double)truth;
    double place = nextafter(fabs(t), HUGE_VAL) - fabs(t);
    return (double)(fabsl((long double)value - truth) / (long double)place);
}

static void test_elementary(void) {
    uint64_t seed = 1;
    double worst_exp = 0, worst_log = 0, worst_tanh = 0, worst_sine = 0, worst_cosine = 0, worst_pow = 0;
    for (int k = 0; k < 200000; k++) {
        double x = check_between(&seed, -700.0, 700.0), y = exp(check_between(&seed, -690.0, 690.0));
        double t = check_between(&seed, -4.0, 4.0), a = check_between(&seed, -1e5, 1e5), sine, cosine;
        worst_exp = scree_most(worst_exp, ulps(scree_exp(x), expl((long double)x)));
        worst_log = scree_most(worst_log, ulps(scree_log(y), logl((long double)y)));
        worst_tanh = scree_most(worst_tanh, ulps(scree_tanh(t), tanhl((long double)t)));
        scree_sincos(a, &sine, &cosine);
        worst_sine = scree_most(worst_sine, (double)fabsl((long double)sine - sinl((long double)a)));
        worst_cosine = scree_most(worst_cosine, (double)fabsl((long double)cosine - cosl((long double)a)));
        double base = exp(check_between(&seed, -20.0, 5.0)), power = check_between(&seed, 1.0, 3.0);
        long double truth = powl((long double)base, (long double)power);
        worst_pow = scree_most(worst_pow, (double)(fabsl((long double)scree_pow(base, power) - truth) / truth));
    }
    /* Rounding of the last steps: under 2 ulp, with a truncation far below; the quotient in tanh near its switch
     * to the series loses a factor 1/(2 x 0.1). */
    CHECK(worst_exp < 2.0);
    CHECK(worst_log < 2.0);
    CHECK(worst_tanh < 8.0);
    CHECK(worst_sine < 4e-16 && worst_cosine < 4e-16);
    CHECK(worst_pow < 60.0 * 2.0 * 1.2e-16); /* |p ln x| <= 60 roundings of the logarithm */
    CHECK(scree_exp(0.0) == 1.0 && scree_log(1.0) == 0.0 && scree_tanh(0.0) == 0.0 && scree_pow(0.0, 1.5) == 0.0);
    CHECK(scree_exp(1000.0) < INFINITY && scree_exp(-1000.0) > 0.0);
    CHECK(scree_tanh(-0.3) == -scree_tanh(0.3) && scree_tanh(1e-9) == 1e-9);
    CHECK(scree_whole_power(3.0, 4) == 81.0 && scree_whole_power(3.0, 1) == 3.0 && scree_whole_power(0.0, 0) == 1.0);
    for (int root = 1; root <= 4; root *= 2) CHECK(scree_whole_power(scree_whole_root(81.0, root), root) == 81.0);
}

/* Whatever comes after it, what was no number stays none. */
static void test_extremes(void) {
    CHECK(scree_most(-1.0, 2.0) == 2.0 && scree_most(2.0, -1.0) == 2.0);
    CHECK(scree_least(-1.0, 2.0) == -1.0 && scree_least(2.0, -1.0) == -1.0);
    CHECK(isnan(scree_most(1.0, NAN)) && isnan(scree_most(NAN, 1.0)) && isnan(scree_most(NAN, HUGE_VAL)));
    CHECK(isnan(scree_least(1.0, NAN)) && isnan(scree_least(NAN, 1.0)) && isnan(scree_least(NAN, -HUGE_VAL)));
}

/* ---- shapes ---- */

/* Volume and moments by counting points, one at random in each cell of a grid: this knows nothing of the parts that the
 * formula adds up. */
static void count_rounded_box(const scree_shape *box, double *volume, double moments[3]) {
    enum { CELLS = 120 };
    uint64_t seed = 7;
    double xx[3] = {0}, cell = 1.0;
    *volume = 0.0;
    for (int k = 0; k < 3; k++) cell *= box->edge[k] / CELLS;
    for (int n = 0; n < CELLS * CELLS * CELLS; n++) {
        int index[3] = {n % CELLS, n / CELLS % CELLS, n / CELLS / CELLS};
        double p[3], beyond = 0.0;
        for (int a = 0; a < 3; a++) {
            p[a] = box->edge[a] * ((index[a] + check_random(&seed)) / CELLS - 0.5);
            double out = fmax(0.0, fabs(p[a]) - (0.5 * box->edge[a] - box->rounding));
            beyond += out * out;
        }
        if (beyond > box->rounding * box->rounding) continue;
        *volume += cell;
        for (int a = 0; a < 3; a++) xx[a] += cell * p[a] * p[a];
    }
    for (int a = 0; a < 3; a++) moments[a] = (xx[(a + 1) % 3] + xx[(a + 2) % 3]) / *volume;
}

static void test_shapes(void) {
    scree_shape sphere = {.kind = SCREE_SPHERE, .radius = 0.3};
    scree_shape ball = {.kind = SCREE_BOX, .edge = {0.6, 0.6, 0.6}, .rounding = 0.3};
    scree_shape box = {.kind = SCREE_BOX, .edge = {0.1, 0.2, 0.3}};
    scree_shape round = {.kind = SCREE_BOX, .edge = {1.0, 1.5, 2.0}, .rounding = 0.4};
    double of_sphere[3], of_ball[3], of_box[3], of_round[3], counted[3], volume;
    scree_shape_inertia(&sphere, of_sphere);
    scree_shape_inertia(&ball, of_ball);
    scree_shape_inertia(&box, of_box);
    scree_shape_inertia(&round, of_round);
    CLOSE(scree_shape_volume(&sphere), 4.0 / 3.0 * pi * 0.027, 1e-15);
    CLOSE(scree_shape_volume(&ball), scree_shape_volume(&sphere), 1e-15);
    for (int k = 0; k < 3; k++) CLOSE(of_ball[k], of_sphere[k], 1e-14);
    CLOSE(of_sphere[0], 0.4 * 0.09, 1e-15);
    CLOSE(scree_shape_volume(&box), 0.006, 1e-15);
    CLOSE(1000.0 * scree_shape_volume(&box) * of_box[0], 0.065, 1e-14); /* of torque_free_top.csv */
    CLOSE(1000.0 * scree_shape_volume(&box) * of_box[1], 0.05, 1e-14);
    CLOSE(1000.0 * scree_shape_volume(&box) * of_box[2], 0.025, 1e-14);
    count_rounded_box(&round, &volume, counted);
    /* The surface cuts some 9e4 of 1.7e6 cells, each an error of up to half a cell at random: 6e-5, times five. */
    CLOSE(scree_shape_volume(&round), volume, 3e-4);
    for (int k = 0; k < 3; k++) CLOSE(of_round[k], counted[k], 3e-4);
    CLOSE(scree_shape_bound(&round), sqrt(0.01 + 0.1225 + 0.36) + 0.4, 1e-15);
    CHECK(scree_shape_half_width(&round) == 0.5 && scree_shape_half_width(&sphere) == 0.3);

    scree_trouble trouble;
    scree_shape bad[] = {{.kind = SCREE_SPHERE, .radius = -1.0},
                         {.kind = SCREE_SPHERE, .radius = NAN},
                         {.kind = SCREE_BOX, .edge = {1.0, 0.0, 1.0}},
                         {.kind = SCREE_BOX, .edge = {1.0, 1.0, 1.0}, .rounding = 0.51},
                         {.kind = SCREE_RECTANGLE, .edge = {1.0, INFINITY}}};
    for (size_t k = 0; k < sizeof bad / sizeof bad[0]; k++)
        CHECK(scree_shape_check(&bad[k], &trouble) == SCREE_BAD_INPUT && trouble.text[0]);
    CHECK(scree_shape_check(&round, &trouble) == SCREE_OK);
}

/* ---- motions ---- */

/* Velocity and acceleration are the derivatives of position and velocity, by central differences. */
static void check_derivatives(const struct scree_motion *motion, double from, double to) {
    const double h = 1e-5;
    for (int k = 1; k < 50; k++) {
        double t = from + (to - from) * k / 50.0;
        struct scree_motion_value before = scree_motion_at(motion, t - h), at = scree_motion_at(motion, t),
                                  after = scree_motion_at(motion, t + h);
        /* Third derivatives here are below 1e5, so the difference quotient is good to h^2 x 1e5/6. */
        NEAR((after.position - before.position) / (2.0 * h), at.velocity, 2e-6);
        NEAR((after.velocity - before.velocity) / (2.0 * h), at.acceleration, 1e-3);
    }
}

static void test_formula_motions(void) {
    scree_trouble trouble;
    struct scree_motion motion;
    scree_motion_def quintic = {
        .kind = SCREE_MOTION_RISE, .offset = 1.0, .start = 0.5, .duration = 0.4, .stroke = 0.08};
    CHECK(scree_motion_bake(&quintic, &motion, &trouble) == SCREE_OK);
    CHECK(scree_motion_at(&motion, 0.2).position == 1.0 && scree_motion_at(&motion, 0.2).velocity == 0.0);
    NEAR(scree_motion_at(&motion, 0.7).position, 1.04, 1e-15);
    CLOSE(scree_motion_at(&motion, 0.7).velocity, 1.875 * 0.08 / 0.4, 1e-14);
    CLOSE(fabs(scree_motion_at(&motion, 0.5 + 0.4 * (0.5 - sqrt(3.0) / 6.0)).acceleration),
          10.0 / sqrt(3.0) * 0.08 / 0.16, 1e-13);
    CHECK(scree_motion_at(&motion, 2.0).position == 1.08 && scree_motion_at(&motion, 2.0).velocity == 0.0);
    NEAR(scree_motion_at(&motion, 0.9 - 1e-12).position, 1.08, 1e-15);
    check_derivatives(&motion, 0.5, 0.9);
    scree_motion_free(&motion);

    scree_motion_def cycloid = quintic;
    cycloid.rise = SCREE_RISE_CYCLOID;
    CHECK(scree_motion_bake(&cycloid, &motion, &trouble) == SCREE_OK);
    CLOSE(scree_motion_at(&motion, 0.7).velocity, 2.0 * 0.08 / 0.4, 1e-14);
    NEAR(scree_motion_at(&motion, 0.9).position, 1.08, 1e-15);
    check_derivatives(&motion, 0.5, 0.9);
    scree_motion_free(&motion);

    scree_motion_def sine = {
        .kind = SCREE_MOTION_SINE, .offset = 0.1, .amplitude = 0.01, .frequency = 5.0, .phase = 0.3};
    CHECK(scree_motion_bake(&sine, &motion, &trouble) == SCREE_OK);
    CLOSE(scree_motion_at(&motion, 1.234).position, 0.1 + 0.01 * sin(10.0 * pi * 1.234 + 0.3), 1e-14);
    NEAR(scree_motion_at(&motion, -1.0).position, 0.1 + 0.01 * sin(0.3), 1e-16);
    check_derivatives(&motion, 0.1, 0.9);
    scree_motion_free(&motion);

    scree_motion_def velocity = {.kind = SCREE_MOTION_VELOCITY, .velocity = 2.0, .start = 1.0, .duration = 3.0};
    CHECK(scree_motion_bake(&velocity, &motion, &trouble) == SCREE_OK);
    scree_motion_free(&motion);
    static const scree_motion_def bad[] = {
        {.kind = (scree_motion_kind)9},
        {.kind = SCREE_MOTION_RISE, .rise = (scree_rise_law)2, .duration = 1.0, .stroke = 1.0},
        {.kind = SCREE_MOTION_VELOCITY, .velocity = 1e308, .duration = 1e308},
        {.kind = SCREE_MOTION_RISE, .duration = 1e-200, .stroke = 1.0}};
    for (size_t k = 0; k < sizeof bad / sizeof bad[0]; k++)
        CHECK(scree_motion_bake(&bad[k], &motion, &trouble) == SCREE_BAD_INPUT && !motion.pieces);
    CHECK(scree_motion_bake(&velocity, &motion, &trouble) == SCREE_OK);
    CHECK(scree_motion_at(&motion, 0.5).position == 0.0 && scree_motion_at(&motion, 2.0).position == 2.0);
    CHECK(scree_motion_at(&motion, 9.0).position == 6.0 && scree_motion_at(&motion, 9.0).velocity == 0.0);
    scree_motion_free(&motion);
}

/* A polynomial and its derivatives, which tables must reproduce: of degree 5, or 6 for quintics in the velocity. */
static double polynomial_of(int degree, double t, int derivative) {
    static const double c[7] = {0.3, -1.0, 2.0, 0.7, -0.4, 0.25, 0.15};
    double sum = 0.0;
    for (int k = derivative; k <= degree; k++) {
        double factor = c[k];
        for (int d = 0; d < derivative; d++) factor *= k - d;
        sum += factor * pow(t, k - derivative);
    }
    return sum;
}

static double polynomial(double t, int derivative) { return polynomial_of(5, t, derivative); }

static void test_velocity_table(void) {
    enum { ROWS = 9 };
    double times[ROWS], values[4][ROWS];
    for (int k = 0; k < ROWS; k++) {
        times[k] = 0.25 * k + 0.03 * sin(7.0 * k);
        for (int d = 0; d < 4; d++) values[d][k] = polynomial_of(6, times[k], d);
    }
    scree_trouble trouble;
    struct scree_motion motion;
    scree_motion_def def = {.kind = SCREE_MOTION_TABLE,
                            .table = SCREE_TABLE_VELOCITY_QUINTIC,
                            .rows = ROWS,
                            .times = times,
                            .positions = values[0],
                            .velocities = values[1],
                            .accelerations = values[2],
                            .jerks = values[3]};
    CHECK(scree_motion_bake(&def, &motion, &trouble) == SCREE_OK);
    for (double t = times[0] + 0.013; t < times[ROWS - 1]; t += 0.03) {
        /* Rounding of values up to 60, over rows of 0.2 s for the acceleration. */
        NEAR(scree_motion_at(&motion, t).position, polynomial_of(6, t, 0), 1e-13);
        NEAR(scree_motion_at(&motion, t).velocity, polynomial_of(6, t, 1), 1e-12);
        NEAR(scree_motion_at(&motion, t).acceleration, polynomial_of(6, t, 2), 1e-11);
    }
    scree_motion_free(&motion);
    values[0][4] += 1e-6;
    CHECK(scree_motion_bake(&def, &motion, &trouble) == SCREE_BAD_INPUT);
    CONTAINS(trouble.text, "row 5");
    CONTAINS(trouble.text, "integral of the velocity");
    def.jerks = NULL;
    CHECK(scree_motion_bake(&def, &motion, &trouble) == SCREE_BAD_INPUT);
    CONTAINS(trouble.text, "jerks");
}

static void test_table_motions(void) {
    enum { ROWS = 41 };
    double times[ROWS], x[ROWS], v[ROWS], a[ROWS], wave[ROWS], wave_v[ROWS];
    for (int k = 0; k < ROWS; k++) {
        times[k] = 2.0 * k / (ROWS - 1.0) + 0.01 * sin(7.0 * k); /* uneven */
        x[k] = polynomial(times[k], 0);
        v[k] = polynomial(times[k], 1);
        a[k] = polynomial(times[k], 2);
        wave[k] = sin(3.0 * times[k]);
        wave_v[k] = 3.0 * cos(3.0 * times[k]);
    }
    scree_trouble trouble;
    struct scree_motion motion;
    scree_motion_def def = {.kind = SCREE_MOTION_TABLE,
                            .table = SCREE_TABLE_QUINTIC,
                            .rows = ROWS,
                            .times = times,
                            .positions = x,
                            .velocities = v,
                            .accelerations = a};
    CHECK(scree_motion_bake(&def, &motion, &trouble) == SCREE_OK);
    for (double t = times[0] + 0.013; t < times[ROWS - 1]; t += 0.03) {
        /* Exact but for rounding, which the differences of positions over a row of 0.03 s amplify by 1/0.03^2. */
        NEAR(scree_motion_at(&motion, t).position, polynomial(t, 0), 1e-14);
        NEAR(scree_motion_at(&motion, t).velocity, polynomial(t, 1), 1e-12);
        NEAR(scree_motion_at(&motion, t).acceleration, polynomial(t, 2), 1e-9);
    }
    CHECK(scree_motion_at(&motion, 1e9).position == x[ROWS - 1] && scree_motion_at(&motion, -1e9).position == x[0]);
    scree_motion_free(&motion);

    /* Interpolation errors of sin 3t with h = 0.06: linear h^2 9/8, cubic h^4 81/384, spline the same order inside. */
    double worst[3] = {0};
    for (int law = SCREE_TABLE_LINEAR; law <= SCREE_TABLE_CUBIC; law++) {
        def = (scree_motion_def){.kind = SCREE_MOTION_TABLE,
                                 .table = (scree_table_law)law,
                                 .rows = ROWS,
                                 .times = times,
                                 .positions = wave,
                                 .velocities = wave_v};
        CHECK(scree_motion_bake(&def, &motion, &trouble) == SCREE_OK);
        for (int k = 0; k < ROWS; k++) NEAR(scree_motion_at(&motion, times[k]).position, wave[k], 1e-15);
        for (double t = 0.6; t < 1.4; t += 0.007)
            worst[law] = scree_most(worst[law], fabs(scree_motion_at(&motion, t).position - sin(3.0 * t)));
        scree_motion_free(&motion);
    }
    CHECK(worst[SCREE_TABLE_LINEAR] < 9.0 / 8.0 * 0.0049 && worst[SCREE_TABLE_LINEAR] > 1e-4);
    CHECK(worst[SCREE_TABLE_CUBIC] < 81.0 / 384.0 * 2.4e-5);
    CHECK(worst[SCREE_TABLE_SPLINE] < 5.0 * 81.0 / 384.0 * 2.4e-5);
    CHECK(worst[SCREE_TABLE_SPLINE] < 0.01 * worst[SCREE_TABLE_LINEAR]);

    times[5] = times[4];
    CHECK(scree_motion_bake(&def, &motion, &trouble) == SCREE_BAD_INPUT);
    CONTAINS(trouble.text, "row 6");
    def.velocities = NULL;
    times[5] = 0.5 * (times[4] + times[6]);
    CHECK(scree_motion_bake(&def, &motion, &trouble) == SCREE_BAD_INPUT);
    CONTAINS(trouble.text, "velocities");
    def.rows = 1;
    CHECK(scree_motion_bake(&def, &motion, &trouble) == SCREE_BAD_INPUT);
    scree_motion_def still = {.kind = SCREE_MOTION_RISE, .stroke = 1.0};
    CHECK(scree_motion_bake(&still, &motion, &trouble) == SCREE_BAD_INPUT);
    still.duration = INFINITY;
    CHECK(scree_motion_bake(&still, &motion, &trouble) == SCREE_BAD_INPUT);
}

/* ---- one body alone ---- */

static const double no_gravity[3] = {0.0, 0.0, 0.0};

static scree_body_def pick(const void *defs, int index) { return ((const scree_body_def *)defs)[index]; }

static struct scree_bodies make_one(const scree_body_def *def, double density) {
    struct scree_bodies bodies;
    scree_trouble trouble;
    CHECK(scree_bodies_create(&bodies, 1, NULL, 0, &trouble) == SCREE_OK);
    CHECK(scree_bodies_set(&bodies, 0, def, density, &trouble) == SCREE_OK);
    CHECK(scree_bodies_finish(&bodies, pick, def, &trouble) == SCREE_OK);
    scree_bodies_start(&bodies, 0.0);
    return bodies;
}

static void step_alone(struct scree_bodies *bodies, long steps, double h, const double gravity[3]) {
    for (long k = 0; k < steps; k++) {
        scree_bodies_look_ahead(bodies, bodies->count, (double)k * h, h, gravity, 1e9);
        scree_bodies_advance(bodies, bodies->count, (double)k * h, h, gravity);
    }
}

static scree_body_def top(double wx, double wy, double wz) {
    return (scree_body_def){.shape = {.kind = SCREE_BOX, .edge = {0.1, 0.2, 0.3}}, .spin = {wx, wy, wz}};
}

/* Largest error of the attitude quaternion over the rows of the table up to 5 s, at a step. */
static double top_error(const struct check_table *table, double h) {
    scree_body_def def = top(1.0, 2.0, 3.0);
    struct scree_bodies bodies = make_one(&def, 1000.0);
    double worst = 0.0, time = 0.0;
    for (int row = 0; row < table->rows; row++) {
        if (strcmp(check_text(table, row, "case"), "generic") != 0) continue;
        double t = check_number(table, row, "t");
        if (isnan(t) || t > 5.0) continue;
        step_alone(&bodies, lround((t - time) / h), h, no_gravity);
        time = t;
        static const char *const names[] = {"q0", "q1", "q2", "q3"};
        for (int k = 0; k < 4; k++)
            worst = scree_most(worst, fabs(bodies.attitude[0].q[k] - check_number(table, row, names[k])));
    }
    scree_bodies_destroy(&bodies);
    return worst;
}

static void test_top(void) {
    struct check_table *table = check_read("torque_free_top.csv");
    double coarse = top_error(table, 2e-3), fine = top_error(table, 5e-4);
    free(table);
    CHECK(fine < 1e-4 && fine > 0.0);
    NEAR(log(coarse / fine) / log(4.0), 2.0, 0.05); /* order */

    /* Angular momentum is kept to rounding, and the energy doesn't drift: unstable spin, 1e6 steps. */
    scree_body_def def = top(0.01, 5.0, 0.01);
    struct scree_bodies bodies = make_one(&def, 1000.0);
    struct vec l = vec_from(bodies.state[0].l);
    double energy = 0.5 * vec_dot(scree_bodies_spin(&bodies, 0, 0.0), l), worst = 0.0;
    for (int k = 0; k < 100; k++) {
        step_alone(&bodies, 10000, 2e-3, no_gravity);
        double now = 0.5 * vec_dot(scree_bodies_spin(&bodies, 0, 0.0), vec_from(bodies.state[0].l));
        worst = scree_most(worst, fabs(now / energy - 1.0));
    }
    CHECK(vec_norm(vec_sub(vec_from(bodies.state[0].l), l)) == 0.0);
    CHECK(worst <
          1e-4); /* (w h)^2/12 = 1e-5 of the energy at most is exchanged, and no more after 2000 s than after 1 s */
    double *q = bodies.attitude[0].q;
    NEAR(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3], 1.0, 1e-15);
    scree_bodies_destroy(&bodies);
}

static void test_joints(void) {
    const double gravity[3] = {1.0, -2.0, -9.81};
    /* Free fall is exact: the position of a parabola at any step. */
    scree_body_def ball = {
        .shape = {.kind = SCREE_SPHERE, .radius = 0.01}, .velocity = {1.0, 0.0, 2.0}, .spin = {3.0, 4.0, 5.0}};
    struct scree_bodies bodies = make_one(&ball, 1000.0);
    CHECK(bodies.class[0] == SCREE_CLASS_BALL && bodies.attitudes == 0);
    step_alone(&bodies, 1000, 1e-3, gravity);
    NEAR(bodies.position[0][0], 1.5, 1e-12);
    NEAR(bodies.position[0][2], 2.0 - 0.5 * 9.81, 1e-12);
    NEAR(scree_bodies_spin(&bodies, 0, 1.0).y, 4.0, 1e-12);
    scree_bodies_destroy(&bodies);

    /* Guided: free along z, hinged about y; the rest fixed. */
    scree_body_def guided = {.shape = {.kind = SCREE_BOX, .edge = {0.1, 0.2, 0.3}},
                             .mass = 2.0,
                             .velocity = {0.0, 0.0, 1.0},
                             .spin = {0.0, 7.0, 0.0},
                             .joint = {.along = {SCREE_FIXED, SCREE_FIXED, SCREE_FREE}, .axis = {0.0, 2.0, 0.0}}};
    bodies = make_one(&guided, 0.0);
    step_alone(&bodies, 1000, 1e-3, gravity);
    CHECK(bodies.position[0][0] == 0.0 && bodies.position[0][1] == 0.0);
    NEAR(bodies.position[0][2], 1.0 - 0.5 * 9.81, 1e-12);
    NEAR(scree_bodies_spin(&bodies, 0, 1.0).y, 7.0, 1e-12);
    NEAR(bodies.attitude[0].q[0], cos(3.5), 1e-12); /* turned by 7 rad */
    NEAR(bodies.attitude[0].q[2], sin(3.5), 1e-12);
    CHECK(bodies.record[0].inverse_mass == 0.5);
    scree_bodies_destroy(&bodies);

    /* Driven along x and turning about z; what contacts see is half a step ahead. */
    scree_body_def driven = {.shape = {.kind = SCREE_BOX, .edge = {0.1, 0.2, 0.3}},
                             .position = {5.0, 6.0, 7.0},
                             .joint = {.along = {SCREE_DRIVEN, SCREE_FIXED, SCREE_FIXED},
                                       .turn = SCREE_DRIVEN,
                                       .along_motion = {0, 0, 0},
                                       .turn_motion = 1,
                                       .axis = {0.0, 0.0, 1.0}}};
    scree_trouble trouble;
    struct scree_motion *motions = calloc(2, sizeof *motions);
    scree_motion_def rise = {.kind = SCREE_MOTION_RISE, .duration = 1.0, .stroke = 0.5};
    scree_motion_def turn = {.kind = SCREE_MOTION_VELOCITY, .velocity = 2.0};
    CHECK(scree_motion_bake(&rise, &motions[0], &trouble) == SCREE_OK);
    CHECK(scree_motion_bake(&turn, &motions[1], &trouble) == SCREE_OK);
    CHECK(scree_bodies_create(&bodies, 1, motions, 2, &trouble) == SCREE_OK);
    CHECK(scree_bodies_set(&bodies, 0, &driven, 0.0, &trouble) == SCREE_OK);
    CHECK(scree_bodies_finish(&bodies, pick, &driven, &trouble) == SCREE_OK);
    scree_bodies_start(&bodies, 0.0);
    step_alone(&bodies, 500, 1e-3, gravity);
    NEAR(bodies.position[0][0], 5.25, 1e-14);
    CLOSE(bodies.state[0].v[0], 1.875 * 0.5, 1e-13);
    NEAR(bodies.attitude[0].q[3], sin(0.5), 1e-14);
    CHECK(scree_bodies_spin(&bodies, 0, 0.5).z == 2.0 && bodies.record[0].inverse_mass == 0.0);
    scree_bodies_look_ahead(&bodies, bodies.count, 0.5, 1e-3, gravity, 1e9);
    CLOSE(bodies.record[0].v[0], scree_motion_at(&bodies.motion[0], 0.5005).velocity, 1e-15);
    scree_bodies_destroy(&bodies);
}

/* The path since the last list never falls short of the way that any point of the body has gone. */
static void test_path(void) {
    scree_body_def def = top(3.0, -5.0, 4.0);
    def.velocity[0] = 0.3;
    struct scree_bodies bodies = make_one(&def, 1000.0);
    double start[8][3];
    for (int c = 0; c < 8; c++)
        vec_store(vec_add(vec_from(bodies.record[0].x), vec_from(bodies.corner[1 + c])), start[c]);
    for (int k = 0; k < 400; k++) {
        step_alone(&bodies, 1, 1e-3, no_gravity);
        for (int c = 0; c < 8; c++) {
            struct vec now = vec_add(vec_from(bodies.record[0].x), vec_from(bodies.corner[1 + c]));
            CHECK(vec_norm(vec_sub(now, vec_from(start[c]))) <= bodies.path[0] * (1.0 + 1e-6));
        }
    }
    CHECK(scree_bodies_look_ahead(&bodies, bodies.count, 0.0, 1e-3, no_gravity, 0.1) == 1);
    bodies.path[0] = 0.0;
    CHECK(scree_bodies_look_ahead(&bodies, bodies.count, 0.0, 1e-3, no_gravity, 0.1) == 0);
    bodies.state[0].v[1] = NAN;
    CHECK(scree_bodies_look_ahead(&bodies, bodies.count, 0.0, 1e-3, no_gravity, 0.1) == 1);
    scree_bodies_destroy(&bodies);
}

static void test_names(void) {
    static const char *const names[] = {"stiffness", "restitution", "damping", NULL};
    CHECK(strcmp(scree_nearest_name("stifness", names), "stiffness") == 0);
    CHECK(strcmp(scree_nearest_name("dampnig", names), "damping") == 0);
    CHECK(scree_nearest_name("xyz", names) == NULL);
    CHECK(scree_nearest_name("", names) == NULL);
}

int main(void) {
    test_elementary();
    test_extremes();
    test_shapes();
    test_formula_motions();
    test_table_motions();
    test_velocity_table();
    test_top();
    test_joints();
    test_path();
    test_names();
    return check_report();
}
