/* solver/: segments, plans for a rigid product, operating speeds, closed paths, characteristic maps, sensitivities,
 * tables. */
#include "solver/conventional.h"
#include "solver/map.h"
#include "solver/sensitivity.h"
#include "solver/table.h"

#include "tests/check.h"

/* The worked example of the process model: s_P = 80, w = 30, G = 50 mm, quarter time shares. */
static const scree_transport task = {.distance = 0.08,
                                     .gap = 0.05,
                                     .width = 0.03,
                                     .friction = 0.3,
                                     .gravity = 9.81,
                                     .share = 0.5,
                                     .fractions = {0.25, 0.5, 0.75}};
static const double mu_g = 0.3 * 9.81;

static scree_plan plan_of(const scree_transport *transport, double cycles, enum scree_formulation formulation) {
    scree_plan plan;
    scree_plan_options options = {.formulation = formulation};
    scree_plan_make(transport, cycles, &options, &plan);
    return plan;
}

/* ---- segments and profiles ---- */

static struct scree_kinematics random_state(uint64_t *seed) {
    double x[4];
    check_draw(seed, -1.0, 1.0, 4, x);
    return (struct scree_kinematics){x[0], x[1], x[2], x[3]};
}

/* v(u) as the process model writes it, term by term. */
static double quintic_of_six(double d, struct scree_kinematics a, struct scree_kinematics b, double u) {
    double u2 = u * u, u3 = u2 * u, u4 = u3 * u, u5 = u4 * u;
    return a.v * (1 - 10 * u3 + 15 * u4 - 6 * u5) + b.v * (10 * u3 - 15 * u4 + 6 * u5) +
           d * a.a * (u - 6 * u3 + 8 * u4 - 3 * u5) + d * b.a * (-4 * u3 + 7 * u4 - 3 * u5) +
           d * d * a.j * (u2 - 3 * u3 + 3 * u4 - u5) / 2 + d * d * b.j * (u3 - 2 * u4 + u5) / 2;
}

static void test_segments(void) {
    uint64_t seed = 7;
    for (int k = 0; k < 200; k++) {
        double d = check_between(&seed, 0.5, 2.0);
        struct scree_kinematics from = random_state(&seed), to = random_state(&seed);
        struct scree_segment segment = scree_velocity_segment(d, from.x, from, to);
        struct scree_kinematics a = scree_segment_at(&segment, 0.0), b = scree_segment_at(&segment, d);
        /* Coefficients of the velocity are below 100 for these ends; jerk multiplies them by up to 20/d^2 = 80 and sums
         * six: 1e4 roundings of 1e-16. */
        const double rounding = 2e-12;
        NEAR(a.x, from.x, rounding);
        NEAR(a.v, from.v, rounding);
        NEAR(a.a, from.a, rounding);
        NEAR(a.j, from.j, rounding);
        NEAR(b.v, to.v, rounding);
        NEAR(b.a, to.a, rounding);
        NEAR(b.j, to.j, rounding);
        double travel = d * (from.v + to.v) / 2 + d * d * (from.a - to.a) / 10 + d * d * d * (from.j + to.j) / 120;
        NEAR(b.x - a.x, travel, rounding);
        double u = check_random(&seed);
        NEAR(scree_segment_at(&segment, u * d).v, quintic_of_six(d, from, to, u), rounding);
        double terms[SCREE_SEGMENT_TERMS], tau = check_between(&seed, -0.3, 0.3);
        scree_segment_taylor(&segment, u * d, terms);
        NEAR(scree_polynomial(6, terms, tau), scree_segment_at(&segment, u * d + tau).x, rounding);

        segment = scree_position_segment(d, from, to);
        a = scree_segment_at(&segment, 0.0);
        b = scree_segment_at(&segment, d);
        NEAR(a.x, from.x, rounding);
        NEAR(a.v, from.v, rounding);
        NEAR(a.a, from.a, rounding);
        NEAR(b.x, to.x, rounding);
        NEAR(b.v, to.v, rounding);
        NEAR(b.a, to.a, rounding);
        CHECK(segment.c[6] == 0.0);
    }
}

/* A profile of random velocity segments, joined without jumps. */
static struct scree_profile random_profile(uint64_t *seed, int segments) {
    struct scree_profile profile = {0};
    struct scree_kinematics at = random_state(seed);
    for (int k = 0; k < segments; k++) {
        struct scree_kinematics to = random_state(seed);
        struct scree_segment segment = scree_velocity_segment(check_between(seed, 0.5, 2.0), at.x, at, to);
        to.x = scree_segment_at(&segment, segment.duration).x;
        CHECK(scree_profile_append(&profile, &segment) == 0);
        at = to;
    }
    return profile;
}

static double component(struct scree_kinematics at, int order) {
    return order == 0 ? at.x : order == 1 ? at.v : order == 2 ? at.a : at.j;
}

/* Bound on the derivative of this order of a segment: sum of its terms' largest values. */
static double derivative_bound(const struct scree_segment *segment, int order) {
    double sum = 0.0;
    for (int k = order; k < SCREE_SEGMENT_TERMS; k++) {
        double term = fabs(segment->c[k]);
        for (int i = 0; i < order; i++) term *= (k - i) / segment->duration;
        sum += term;
    }
    return sum;
}

static void test_extrema(void) {
    enum { SAMPLES = 4000 };
    uint64_t seed = 11;
    for (int k = 0; k < 20; k++) {
        struct scree_profile profile = random_profile(&seed, 3);
        struct scree_extrema exact = scree_profile_extrema(&profile);
        for (int order = 0; order < 4; order++) {
            double least = HUGE_VAL, largest = -HUGE_VAL, gap = 0.0;
            for (int s = 0; s < profile.count; s++) {
                const struct scree_segment *segment = &profile.segment[s];
                double h = segment->duration / SAMPLES;
                /* A sample is at most h/2 from the extremum, where the slope is zero. */
                gap = scree_most(gap, derivative_bound(segment, order + 2) * h * h / 8.0);
                for (int i = 0; i <= SAMPLES; i++) {
                    double x = component(scree_segment_at(segment, i * h), order);
                    least = scree_least(least, x);
                    largest = scree_most(largest, x);
                }
            }
            NEAR(component(exact.largest, order), largest, gap + 1e-12);
            NEAR(component(exact.least, order), least, gap + 1e-12);
            CHECK(component(exact.largest, order) >= largest - 1e-12);
            CHECK(component(exact.least, order) <= least + 1e-12);
        }
    }
}

static void test_profiles(void) {
    uint64_t seed = 13;
    struct scree_profile profile = random_profile(&seed, 4);
    struct scree_kinematics jump = scree_profile_jumps(&profile);
    CHECK(jump.x < 2e-12 && jump.v < 2e-12 && jump.a < 2e-12 && jump.j < 2e-12);

    /* Another duration: powers of the ratio. */
    double duration = scree_profile_duration(&profile), ratio = 0.37;
    struct scree_profile scaled = scree_profile_scaled(&profile, ratio * duration);
    CLOSE(scree_profile_duration(&scaled), ratio * duration, 1e-15);
    for (int k = 0; k <= 50; k++) {
        struct scree_kinematics a = scree_profile_at(&profile, duration * k / 50.0);
        struct scree_kinematics b = scree_profile_at(&scaled, ratio * duration * k / 50.0);
        /* Rounding of the time, an ulp of 8 s, times the next derivative (< 100). */
        NEAR(b.x, a.x, 1e-12);
        NEAR(b.v * ratio, a.v, 1e-12);
        NEAR(b.a * ratio * ratio, a.a, 1e-12);
        NEAR(b.j * ratio * ratio * ratio, a.j, 1e-11);
    }

    /* Before and after: at rest. */
    struct scree_kinematics after = scree_profile_at(&profile, duration + 1.0);
    const struct scree_segment *last = &profile.segment[3];
    CHECK(after.x == scree_segment_at(last, last->duration).x && after.v == 0.0 && after.a == 0.0);
    CHECK(scree_profile_at(&profile, -1.0).x == profile.segment[0].c[0] && scree_profile_at(&profile, -1.0).v == 0.0);

    /* A jump is found. */
    struct scree_profile broken = profile;
    broken.segment[2].c[0] += 0.25;
    NEAR(scree_profile_jumps(&broken).x, 0.25, 2e-12);

    /* Only so many segments fit. */
    while (profile.count < SCREE_PROFILE_SEGMENTS) CHECK(scree_profile_append(&profile, last) == 0);
    CHECK(scree_profile_append(&profile, last) == 1);
}

/* One quintic cut into pieces becomes one again; a real change stays. */
static void test_merge(void) {
    struct scree_kinematics from = {0.1, 0.2, -0.5, 0.0}, to = {1.0, -0.3, 0.7, 0.0};
    struct scree_segment whole = scree_position_segment(1.5, from, to);
    double cuts[4] = {0.0, 0.4, 1.1, 1.5};
    struct scree_profile profile = {0};
    for (int k = 0; k < 3; k++) {
        struct scree_segment piece = scree_position_segment(cuts[k + 1] - cuts[k], scree_segment_at(&whole, cuts[k]),
                                                            scree_segment_at(&whole, cuts[k + 1]));
        scree_profile_append(&profile, &piece);
    }
    struct scree_segment rest = scree_position_segment(1.0, scree_segment_at(&whole, 1.5), from);
    scree_profile_append(&profile, &rest);
    CHECK(scree_profile_merge(&profile, 1e-10) == 2);
    CHECK(profile.count == 2);
    NEAR(profile.start[1], 1.5, 1e-15);
    NEAR(profile.start[2], 2.5, 1e-15);
    for (int k = 0; k < SCREE_SEGMENT_TERMS; k++)
        NEAR(profile.segment[0].c[k], whole.c[k], 1e-11); /* terms of a piece of 0.4, scaled by (1.5/0.4)^5 = 740 */
    CHECK(scree_profile_merge(&profile, 1e-10) == 2);
    struct scree_profile empty = {0};
    CHECK(scree_profile_merge(&empty, 1e-10) == 0);
}

static void test_roots(void) {
    /* (u - 0.1)(u - 0.3)(u - 0.5)(u - 0.7)(u - 0.9)(u - 2) */
    static const double known[6] = {0.1, 0.3, 0.5, 0.7, 0.9, 2.0};
    double c[7] = {1.0}, roots[6];
    for (int k = 0; k < 6; k++) {
        for (int i = k + 1; i > 0; i--) c[i] = c[i - 1] - known[k] * c[i];
        c[0] *= -known[k];
    }
    CHECK(scree_polynomial_roots(6, c, 0.0, 1.0, roots) == 5);
    for (int k = 0; k < 5; k++)
        NEAR(roots[k], known[k], 2e-13); /* six roundings of sums of terms up to 2, over slopes of 1e-2 */
    CHECK(scree_polynomial_roots(6, c, 0.0, 3.0, roots) == 6);
    CHECK(scree_polynomial_roots(6, c, 0.35, 0.45, roots) == 0);
    CHECK(scree_polynomial_roots(2, (const double[]){-1.0, 0.0, 0.0}, 0.0, 1.0, roots) == 0);
    struct scree_segment segment =
        scree_position_segment(2.0, (struct scree_kinematics){0}, (struct scree_kinematics){.x = 1.0});
    double t = scree_segment_first(&segment, -0.5); /* 60 u (1 - u)(1 - 2 u)/4 = -1/2 */
    NEAR(scree_segment_at(&segment, t).a, -0.5, 1e-14);
    CHECK(t > 1.0 && t < 1.5);
    CHECK(scree_segment_first(&segment, 0.0) == 0.0);
    CHECK(scree_segment_first(&segment, -1.5) == -1.0);
}

/* ---- the worked example ---- */

/* Largest |second derivative of v| of a quintic c0 … c5 over a duration, by dense sampling. */
static double sampled_jerk(const double *c, double d) {
    double largest = 0.0;
    for (int k = 0; k <= 100000; k++) {
        double u = k / 100000.0;
        largest = scree_most(largest, fabs(2 * c[2] + u * (6 * c[3] + u * (12 * c[4] + u * 20 * c[5]))) / (d * d));
    }
    return largest;
}

/* Half a unit of the last printed digit, and a little for its own rounding. */
#define PRINTED(value, expected, unit) NEAR(value, expected, 0.5001 * (unit))

static void test_table_a(void) {
    static const struct {
        double n, v[3], x[3], most, least, jerk;
    } rows[] = {
        {300, {1.1402, 0.2667, 0.9931}, {14.4370, 31.8394, 47.7703}, 86.8, -73.2, 1.10e4},
        {500, {1.8219, 0.4444, 1.7336}, {13.7306, 30.6622, 47.0640}, 229.0, -215.4, 4.75e4},
        {700, {2.5204, 0.6222, 2.4574}, {13.5360, 30.3378, 46.8694}, 442.4, -428.8, 1.28e5},
    };
    static const double jerk_unit[] = {1e2, 1e2, 1e3};
    for (int row = 0; row < 3; row++) {
        scree_plan plan = plan_of(&task, rows[row].n, SCREE_PLAN_A);
        CHECK(plan.state == SCREE_PLAN_GOOD);
        double T = plan.duration, s = task.distance, play = scree_transport_play(&task);
        CLOSE(T, 30.0 / rows[row].n, 1e-15);
        for (int k = 0; k < 3; k++) {
            PRINTED(plan.event[k + 1].v, rows[row].v[k], 1e-4);
            PRINTED(1e3 * plan.event[k + 1].x, rows[row].x[k], 1e-4);
        }
        CLOSE(plan.event[1].v, 4 * s / (3 * T) + mu_g * T / 4, 1e-14);
        CLOSE(plan.event[3].v, 4 * s / (3 * T) - mu_g * T / 4, 1e-14);
        CLOSE(plan.event[2].v, 4 * (s / 3 - play) / T, 1e-13); /* a difference of numbers four times as large */
        PRINTED(plan.extrema.largest.a, rows[row].most, 0.1);
        PRINTED(plan.extrema.least.a, rows[row].least, 0.1);
        PRINTED(scree_extrema_jerk(&plan.extrema), rows[row].jerk, jerk_unit[row]);
        /* The largest |jerk| is a negative one, inside of segment 01; the largest positive one is 1 or 2 % less. */
        CHECK(plan.extrema.largest.j < -plan.extrema.least.j);
        double sampled = 0.0;
        for (int k = 0; k < 4; k++) {
            double c[6], d = plan.time[k + 1] - plan.time[k];
            for (int i = 0; i < 6; i++) c[i] = plan.profile.segment[k].c[i + 1] * (i + 1) / d;
            sampled = scree_most(sampled, sampled_jerk(c, d));
        }
        CLOSE(scree_extrema_jerk(&plan.extrema), sampled, 1e-9); /* a parabola's top, missed by up to 5e-6 */
        NEAR(plan.event[4].x, s - play, 1e-16);
        scree_catch at = scree_slide_catch(&task, &plan.profile, plan.detached, plan.time[3]);
        NEAR(at.clearance, 0.0, 1e-16);
        NEAR(at.velocity - plan.event[3].v, 0.0, 1e-15);
    }
}

static void test_coefficients(void) {
    static const double expected[4][6] = {{0, 0, 0, 18.395808, -27.637857, 11.063972},
                                          {1.821923, -0.044145, 0, -13.509913, 20.309015, -8.132435},
                                          {0.444444, 0, 0, 13.068463, -19.646840, 7.867565},
                                          {1.733633, -0.044145, 0, -17.071458, 25.651332, -10.269362}};
    scree_plan plan = plan_of(&task, 500.0, SCREE_PLAN_A);
    for (int k = 0; k < 4; k++)
        for (int i = 0; i < 6; i++)
            PRINTED(plan.profile.segment[k].c[i + 1] * (i + 1) / plan.profile.segment[k].duration, expected[k][i],
                    1e-6);
}

static void test_table_b(void) {
    static const double rows[3][4] = {
        {300, 1.14046, 0.26353, 0.99601}, {500, 1.82258, 0.44215, 1.73527}, {700, 2.52105, 0.62045, 2.45849}};
    for (int row = 0; row < 3; row++) {
        scree_plan plan = plan_of(&task, rows[row][0], SCREE_PLAN_B);
        CHECK(plan.state == SCREE_PLAN_GOOD && plan.solver.converged);
        for (int k = 0; k < 3; k++) PRINTED(plan.event[k + 1].v, rows[row][k + 1], 1e-5);
        CLOSE(plan.event[3].a, -mu_g, 1e-9);
        scree_catch at = scree_slide_catch(&task, &plan.profile, plan.detached, plan.time[3]);
        /* The solver's residual is 1e-8 at most, of play and of 1.5 mean speeds. */
        NEAR(at.clearance, 0.0, 1e-8 * scree_transport_play(&task));
        NEAR(at.velocity, plan.event[3].v, 1e-8 * task.distance / plan.duration);
        if (row == 1) PRINTED(plan.detached / plan.duration, 0.2584, 1e-4);
        if (row == 1) PRINTED(plan.detached_velocity, 1.82207, 1e-5);
    }
}

static void test_nine(void) {
    static const double shares[][3] = {{0.25, 0.5, 0.75}, {0.3, 0.45, 0.7}, {0.2, 0.5, 0.8}};
    for (int s = 0; s < 3; s++)
        for (int n = 200; n <= 800; n += 200) {
            scree_transport other = task;
            memcpy(other.fractions, shares[s], sizeof other.fractions);
            scree_plan a = plan_of(&other, n, SCREE_PLAN_A), nine;
            scree_lm_outcome outcome = scree_plan_nine(&other, n, &nine);
            CHECK(outcome.converged && nine.state == SCREE_PLAN_GOOD);
            for (int k = 1; k < 4; k++) {
                CLOSE(nine.event[k].v, a.event[k].v, 1e-9); /* nine equations, well conditioned, solved to rounding */
                NEAR(nine.event[k].a, a.event[k].a, 1e-9 * mu_g);
                CLOSE(nine.time[k], a.time[k], 1e-9);
            }
        }
    scree_transport wrong = task;
    scree_plan plan;
    wrong.gap = 0.02;
    CHECK(scree_plan_nine(&wrong, 500.0, &plan).reason == SCREE_LM_BAD_INPUT && plan.state == SCREE_PLAN_BAD_TASK);
}

/* One root of B, from wherever the search begins. */
static void test_random_starts(void) {
    uint64_t seed = 17;
    scree_plan root = plan_of(&task, 500.0, SCREE_PLAN_B);
    double mean = task.distance / root.duration;
    for (int k = 0; k < 200; k++) {
        const double low[4] = {0.1 * mean, 0.0, 0.1 * mean, -20.0 * mu_g},
                     high[4] = {3.0 * mean, 1.5 * mean, 3.0 * mean, 0.0};
        double guess[4];
        for (int i = 0; i < 4; i++) guess[i] = check_between(&seed, low[i], high[i]);
        scree_plan plan;
        scree_plan_options options = {.formulation = SCREE_PLAN_B, .guess = guess};
        scree_plan_make(&task, 500.0, &options, &plan);
        CHECK(plan.state == SCREE_PLAN_GOOD);
        for (int i = 1; i < 4; i++) NEAR(plan.event[i].v, root.event[i].v, 1e-7 * mean);
    }
}

/* Near the end the comb's braking fades and the product stops earlier by mu g tau^2/36. */
static void test_residual_error(void) {
    for (int n = 200; n <= 800; n += 100) {
        scree_plan plan = plan_of(&task, n, SCREE_PLAN_A);
        scree_slide slide = scree_slide_simulate(&task, &plan.profile, 0.0);
        double release = scree_slide_release(&plan.profile, mu_g, plan.time[3]), tau = plan.duration - release;
        double d4 = plan.duration - plan.time[3];
        CHECK(slide.detached && tau > 0.0 && tau < d4);
        /* The braking is c s^2 (1 - 2 s …) in s = tau/D4. */
        CLOSE(-slide.error, mu_g * tau * tau / 36.0, 3.0 * tau / d4);
        struct scree_kinematics at = scree_profile_at(&plan.profile, release);
        double exact = at.x + at.v * at.v / (2.0 * mu_g) - plan.event[4].x;
        NEAR(slide.error, exact, 1e-15);
    }
}

/* ---- what makes a plan fail ---- */

static void fails(const scree_plan *plan, enum scree_plan_state state, const char *part) {
    CHECK(plan->state == state);
    if (plan->state != state) printf("  state %d: %s\n", (int)plan->state, plan->text);
    CONTAINS(plan->text, part);
}

static void test_bad_tasks(void) {
    static const double speeds[] = {0.0, -500.0, NAN, HUGE_VAL};
    for (int f = SCREE_PLAN_A; f <= SCREE_PLAN_C; f++) {
        enum scree_formulation formulation = (enum scree_formulation)f;
        scree_transport t = task;
        for (int k = 0; k < 4; k++) {
            scree_plan plan = plan_of(&t, speeds[k], formulation);
            fails(&plan, SCREE_PLAN_BAD_TASK, "operating speed must be positive");
        }
        struct {
            scree_transport t;
            const char *part;
        } bad[] = {{task, "not wider than the product"},
                   {task, "less than the transport distance"},
                   {task, "increase between 0 and 1"},
                   {task, "increase between 0 and 1"},
                   {task, "increase between 0 and 1"},
                   {task, "share of the cycle"},
                   {task, "must be positive"},
                   {task, "must be positive"},
                   {task, "must not be negative"},
                   {task, "must not be negative"},
                   {task, "must be positive"}};
        bad[0].t.gap = 0.03;
        bad[1].t.gap = 0.12;
        bad[2].t.fractions[1] = 0.25;
        bad[3].t.fractions[2] = 1.0;
        bad[4].t.fractions[0] = NAN;
        bad[5].t.share = 1.2;
        bad[6].t.friction = 0.0;
        bad[7].t.distance = NAN;
        bad[8].t.largest_acceleration = -1.0;
        bad[9].t.largest_jerk = NAN;
        bad[10].t.gravity = HUGE_VAL;
        for (size_t k = 0; k < sizeof bad / sizeof bad[0]; k++) {
            scree_plan plan = plan_of(&bad[k].t, 500.0, formulation);
            fails(&plan, SCREE_PLAN_BAD_TASK, bad[k].part);
        }
    }
    scree_plan plan = plan_of(&task, 500.0, SCREE_PLAN_C);
    fails(&plan, SCREE_PLAN_BAD_TASK, "needs a process model");
}

static void test_failures(void) {
    for (int f = SCREE_PLAN_A; f <= SCREE_PLAN_B; f++) {
        enum scree_formulation formulation = (enum scree_formulation)f;
        /* Too slow for these time shares: the product doesn't stay caught. (That the comb would also have to move
         * backwards is a consequence.) */
        static const double slow[] = {20.0, 60.0, 90.0};
        for (int k = 0; k < 3; k++) {
            scree_plan plan = plan_of(&task, slow[k], formulation);
            fails(&plan, SCREE_PLAN_SECOND_SEPARATION, "after the catch the comb brakes too softly");
        }
        CHECK(plan_of(&task, 101.0, formulation).state == SCREE_PLAN_GOOD);

        scree_transport t = task;
        t.largest_acceleration = 200.0;
        scree_plan plan = plan_of(&t, 500.0, formulation);
        fails(&plan, SCREE_PLAN_ACCELERATION, "the drive gives 200");
        t.largest_acceleration = 0.0;
        t.largest_jerk = 4e4;
        plan = plan_of(&t, 500.0, formulation);
        fails(&plan, SCREE_PLAN_JERK, "the drive gives 4e+04");
        t.largest_jerk = 0.0;
        t.gap = 0.06; /* play beyond a third of the distance: v2 = 4 (s/3 - play)/T < 0 */
        plan = plan_of(&t, 500.0, formulation);
        fails(&plan, SCREE_PLAN_BACKWARDS, "backwards");
        /* Little play and a long approach: the product is at the front tines before event 3, by play < mu g D3^2/10. */
        t = task;
        t.gap = 0.031;
        t.fractions[1] = 0.27;
        plan = plan_of(&t, 200.0, formulation);
        fails(&plan, SCREE_PLAN_EARLY_CONTACT, "meets a tine again");
    }
    scree_plan design = plan_of(&task, 500.0, SCREE_PLAN_A), plan;
    scree_plan_scaled(&task, &design, 500.0, &plan);
    CHECK(plan.state == SCREE_PLAN_GOOD);
    scree_plan_scaled(&task, &design, 700.0, &plan);
    fails(&plan, SCREE_PLAN_EARLY_DETACHMENT, "before the push ends");
    scree_plan_scaled(&task, &design, 65.0, &plan);
    fails(&plan, SCREE_PLAN_NO_DETACHMENT, "too softly for the product to leave it");
    CHECK(plan.detached > plan.time[3]); /* only when it stops */
}

/* ---- the process model in the loop ---- */

/* A rigid product that compliant tines shift by known amounts. */
struct model {
    double back, slower; /* s^2/m: clearance per v1^2; velocity lost in parts of v1 */
    int calls, broken, stubborn;
};

static int model_catch(void *context, const struct scree_profile *profile, double until, scree_catch *result) {
    struct model *model = context;
    model->calls++;
    double left = scree_slide_detachment(profile, mu_g);
    if (model->broken) snprintf(result->cause, sizeof result->cause, "it is broken");
    if (model->broken || left < 0.0) return 1;
    double v1 = scree_profile_at(profile, profile->start[1]).v;
    *result = scree_slide_catch(&task, profile, left, until);
    result->clearance += model->back * v1 * v1;
    result->velocity -= model->slower * v1;
    if (model->stubborn) result->clearance = 1e-3;
    return 0;
}

static scree_plan plan_with(struct model *model, double cycles) {
    scree_plan plan;
    scree_plan_options options = {.formulation = SCREE_PLAN_C, .process = model_catch, .context = model};
    scree_plan_make(&task, cycles, &options, &plan);
    return plan;
}

static void test_model_in_loop(void) {
    for (int n = 300; n <= 700; n += 100)
        for (int side = -1; side <= 1; side += 2) {
            struct model model = {.back = side * 1e-4, .slower = side * 0.02};
            scree_plan plan = plan_with(&model, n), rigid = plan_of(&task, n, SCREE_PLAN_B);
            scree_catch at = {0};
            CHECK(plan.state == SCREE_PLAN_GOOD);
            if (plan.state) printf("  %d/min: %s\n", n, plan.text);
            CHECK(plan.simulations == model.calls && plan.simulations <= 12); /* a digit or more a step */
            CHECK(model_catch(&model, &plan.profile, plan.time[3], &at) == 0);
            NEAR(at.clearance, 0.0, 1e-7); /* the default bound, and its share of the play for the speed */
            NEAR(at.velocity, plan.event[3].v, 1e-7 / scree_transport_play(&task) * task.distance / plan.duration);
            NEAR(plan.event[4].x, task.distance - scree_transport_play(&task), 1e-9);
            CHECK(fabs(plan.event[3].v - rigid.event[3].v) > 1e-3); /* and it wasn't there before */
        }
    struct model broken = {.broken = 1}, stubborn = {.stubborn = 1};
    scree_plan plan = plan_with(&broken, 500.0);
    fails(&plan, SCREE_PLAN_MODEL_FAILED, "process model failed at the start of the iteration: it is broken");
    plan = plan_with(&stubborn, 500.0);
    fails(&plan, SCREE_PLAN_NO_SOLUTION, "clearance of 0.001 m");
    CHECK(plan.simulations <= 61);
}

static int stop(void *context, const scree_lm_progress *progress) {
    (void)progress;
    ++*(int *)context;
    return 1;
}

static void test_stopped(void) {
    struct model model = {.back = 1e-3};
    int calls = 0;
    scree_plan plan;
    scree_plan_options options = {.formulation = SCREE_PLAN_C,
                                  .process = model_catch,
                                  .context = &model,
                                  .callback = stop,
                                  .callback_context = &calls};
    scree_plan_make(&task, 700.0, &options, &plan);
    CHECK(calls == 1 && plan.solver.reason == SCREE_LM_STOPPED);
    fails(&plan, SCREE_PLAN_NO_SOLUTION, "the iteration ended with");
}

/* ---- operating speeds ---- */

static void test_scaled(void) {
    scree_plan design = plan_of(&task, 500.0, SCREE_PLAN_A);
    /* Values by an independent program: detachment and contact by bisection, positions from the polynomials.
     * Slow: 2.28348 rather than the 2.354 of mu g (L^2 - L_d^2)/2, since the product leaves later (at 0.26153 T); fast:
     * -0.65736, not -0.64866, since it leaves before event 1 (at 0.24496 T). */
    NEAR(1e3 * scree_scaled_clearance(&task, &design, 300.0), 2.2834831972, 1e-9);
    NEAR(1e3 * scree_scaled_clearance(&task, &design, 700.0), -0.6573634587, 1e-9);
    NEAR(scree_scaled_clearance(&task, &design, 500.0), 0.0, 1e-15);
    CHECK(scree_scaled_clearance(&task, &design, 65.0) == HUGE_VAL);
    PRINTED(1e3 * scree_scaled_clearance(&task, &design, 700.0), -0.657, 1e-3);
    struct scree_profile slow = scree_profile_scaled(&design.profile, 0.1);
    struct scree_profile fast = scree_profile_scaled(&design.profile, 30.0 / 700.0);
    CLOSE(scree_slide_detachment(&slow, mu_g), 0.26153434914 * 0.1, 1e-9);
    CLOSE(scree_slide_detachment(&fast, mu_g), 0.24496203048 * 30.0 / 700.0, 1e-9);
    static const double restitution[] = {0.0, 0.3, 0.5};
    for (int k = 0; k < 3; k++) {
        scree_slide a = scree_slide_simulate(&task, &slow, restitution[k]);
        scree_slide b = scree_slide_simulate(&task, &fast, restitution[k]);
        NEAR(a.first_contact, 0.6179931539993, 1e-9);
        NEAR(b.first_contact, 0.4745810973517, 1e-9);
        CHECK(!a.unfinished && !b.unfinished);
        /* A plastic catch hides the fault; restitution shows it. */
        if (k == 0) CHECK(fabs(a.error) < 1e-6 && fabs(b.error) < 1e-6);
        if (k == 2) CHECK(a.error < -5e-4 && b.error < -1e-3);
    }
}

static void test_limits(void) {
    scree_plan design = plan_of(&task, 500.0, SCREE_PLAN_A);
    double low, high;
    scree_limit_range(&task, &design, 0.5, 1e-3, &low, &high);
    NEAR(low, 297.0, 1.0); /* "about", whole cycles */
    NEAR(high, 545.0, 1.0);
    scree_limit_range(&task, &design, 0.3, 1e-3, &low, &high);
    NEAR(low, 267.0, 1.0);
    NEAR(high, 683.0, 1.0);
    struct scree_profile edge = scree_profile_scaled(&design.profile, 30.0 / high);
    NEAR(scree_slide_simulate(&task, &edge, 0.3).error, -1e-3, 1e-9); /* 40 halvings of 1/min */

    struct scree_profile brake = {0};
    scree_profile_append(&brake, &design.profile.segment[1]);
    PRINTED(scree_limit_detachment(&task, &design), 65.6, 0.1);
    CLOSE(scree_limit_detachment(&task, &design), 500.0 * sqrt(mu_g / -scree_profile_extrema(&brake).least.a), 1e-14);
    scree_plan plan;
    scree_plan_scaled(&task, &design, scree_limit_detachment(&task, &design) * 1.001, &plan);
    CHECK(plan.detached < plan.time[2]);
    scree_plan_scaled(&task, &design, scree_limit_detachment(&task, &design) * 0.999, &plan);
    CHECK(plan.detached > plan.time[3]);

    PRINTED(scree_limit_low(&task), 99.7, 0.1);
    CLOSE(scree_limit_low(&task), 60.0 * 0.5 * sqrt(0.3 * mu_g / task.distance), 1e-12); /* bisection to rounding */
    CHECK(plan_of(&task, scree_limit_low(&task) * 1.0001, SCREE_PLAN_A).state == SCREE_PLAN_GOOD);
    CHECK(plan_of(&task, scree_limit_low(&task) * 0.9999, SCREE_PLAN_A).state == SCREE_PLAN_SECOND_SEPARATION);

    struct scree_conventional motion = {.stroke = 0.08, .share = 0.5, .friction = 0.3, .gravity = 9.81};
    PRINTED(scree_conventional_critical(&motion, 1e-3), 81.50, 0.01);
    CHECK(isnan(scree_conventional_critical(&motion, 0.0)) && isnan(scree_conventional_critical(&motion, HUGE_VAL)));
    struct scree_conventional slippery = motion, weightless = motion;
    slippery.friction = weightless.gravity = 0.0;
    CHECK(isnan(scree_conventional_critical(&slippery, 1e-3)) && isnan(scree_conventional_critical(&weightless, 1e-3)));
    CHECK(scree_conventional_critical(&motion, 1e-3) < scree_limit_low(&task)); /* a gap that neither motion covers */

    /* Peaks over s_P/T^2 and s_P/T^3 depend on the speed through mu g T^2/s_P only, and fall to a limit: "about" is 2
     * %. */
    for (int n = 500; n <= 700; n += 200) {
        scree_plan p = plan_of(&task, n, SCREE_PLAN_A);
        double T = p.duration;
        CLOSE(scree_extrema_acceleration(&p.extrema), 10.2 * task.distance / (T * T), 0.02);
        CLOSE(scree_extrema_jerk(&p.extrema), 127.0 * task.distance / (T * T * T), 0.02);
    }
    scree_transport limited = task;
    CHECK(scree_limit_drive(&limited, 100.0, 1000.0) == HUGE_VAL);
    limited.largest_acceleration = 300.0;
    double most = scree_limit_drive(&limited, 100.0, 1000.0);
    scree_plan at_limit = plan_of(&task, most, SCREE_PLAN_A);
    CLOSE(scree_extrema_acceleration(&at_limit.extrema), 300.0, 1e-9);
    CHECK(scree_limit_drive(&limited, 900.0, 1000.0) == 900.0);
}

/* Other time shares cost less; the search never returns worse ones, and an admissible plan. */
static double speed_of_comb(void *context, const scree_plan *plan) {
    ++*(int *)context;
    return plan->extrema.largest.v;
}

static void test_shares(void) {
    static const enum scree_shares_rule rules[] = {SCREE_LEAST_ACCELERATION, SCREE_LEAST_JERK};
    scree_plan quarter = plan_of(&task, 500.0, SCREE_PLAN_A), plan;
    for (int k = 0; k < 2; k++) {
        scree_transport t = task;
        scree_plan_shares(&t, 500.0, NULL, rules[k], NULL, NULL, &plan);
        double before = k ? scree_extrema_jerk(&quarter.extrema) : scree_extrema_acceleration(&quarter.extrema);
        double after = k ? scree_extrema_jerk(&plan.extrema) : scree_extrema_acceleration(&plan.extrema);
        CHECK(plan.state == SCREE_PLAN_GOOD && after < 0.99 * before);
        for (int i = 0; i < 3; i++) CLOSE(plan.time[i + 1], t.fractions[i] * plan.duration, 1e-15);
    }
    scree_transport t = task;
    int calls = 0;
    scree_plan_shares(&t, 500.0, NULL, SCREE_LEAST_CATCH, speed_of_comb, &calls, &plan);
    CHECK(plan.state == SCREE_PLAN_GOOD && calls > 4 && plan.extrema.largest.v < quarter.extrema.largest.v);
    scree_plan_shares(&t, 500.0, NULL, SCREE_LEAST_CATCH, NULL, NULL, &plan);
    CHECK(plan.state == SCREE_PLAN_BAD_TASK && plan.text[0]);
    /* Where quarter shares fail, between the conventional motion's limit and theirs, an earlier catch works. */
    t = task;
    memcpy(t.fractions, (const double[]){0.225, 0.3, 0.475}, sizeof t.fractions);
    CHECK(plan_of(&t, 88.0, SCREE_PLAN_A).state == SCREE_PLAN_GOOD &&
          scree_limit_low(&t) < 0.9 * scree_limit_low(&task));
}

/* ---- rises and cycles ---- */

static void test_rises(void) {
    /* Peaks of the modified sine as the handbooks print them. */
    struct scree_kinematics sine = scree_cam_peaks(SCREE_CAM_MODIFIED_SINE);
    PRINTED(sine.v, 1.760, 1e-3);
    PRINTED(sine.a, 5.528, 1e-3);
    PRINTED(sine.j, 69.47, 1e-2);
    for (int k = 0; k < SCREE_CAM_LAWS; k++) {
        enum scree_cam_law law = (enum scree_cam_law)k;
        struct scree_kinematics peaks = scree_cam_peaks(law), start = scree_cam_at(law, 0.0),
                                end = scree_cam_at(law, 1.0);
        CHECK(scree_cam_names[k][0] != '\0');
        CHECK(start.x == 0.0 && start.v == 0.0 && start.a == 0.0);
        NEAR(end.x, 1.0, 1e-15);
        NEAR(end.v, 0.0, 1e-15);
        NEAR(end.a, 0.0, 2e-15); /* 2 pi sin(2 pi) */
        CHECK(scree_cam_at(law, -0.1).x == 0.0 && scree_cam_at(law, 1.1).x == 1.0 && scree_cam_at(law, 1.1).v == 0.0);
        const double h = 1e-3;
        double v = 0.0, a = 0.0, j = 0.0;
        for (int i = 0; i <= 8000; i++) {
            double u = i / 8000.0;
            struct scree_kinematics at = scree_cam_at(law, u), mirrored = scree_cam_at(law, 1.0 - u);
            v = scree_most(v, fabs(at.v));
            a = scree_most(a, fabs(at.a));
            j = scree_most(j, fabs(at.j));
            NEAR(at.x + mirrored.x, 1.0, 1e-14);
            NEAR(at.v, mirrored.v, 1e-14);
            NEAR(at.a, -mirrored.a, 1e-13);
        }
        CLOSE(v, peaks.v, 1e-15 * 10);
        CLOSE(a, peaks.a, 1e-7); /* the quintic's peak is not on the grid: 60 (h/2)^2/5.8 with h = 1/8000 */
        CLOSE(j, peaks.j, 1e-15 * 10);
        NEAR(scree_cam_at(law, peaks.x).a, -peaks.a, 1e-13);
        /* Each is the derivative of the one before, except across the jerk's jumps (modified sine: u = 1/8, 7/8 are
         * corners). */
        for (int i = 2; i < 998; i++) {
            double u = i * h;
            if (fabs(u - 0.125) < 2 * h || fabs(u - 0.875) < 2 * h) continue;
            struct scree_kinematics b = scree_cam_at(law, u - h), c = scree_cam_at(law, u + h),
                                    at = scree_cam_at(law, u);
            /* Central differences err by h^2/6 times the third derivative: (4 pi)^3 times the size at most. */
            NEAR((c.x - b.x) / (2 * h), at.v, h * h / 6 * peaks.j);
            NEAR((c.v - b.v) / (2 * h), at.a, h * h / 6 * 1000.0);
            NEAR((c.a - b.a) / (2 * h), at.j, h * h / 6 * 12000.0);
        }
    }
    /* The law with the gentlest peak keeps its product longest. */
    struct scree_conventional motion = {.stroke = 0.08, .share = 0.5, .friction = 0.3, .gravity = 9.81};
    double limit[SCREE_CAM_LAWS];
    for (int k = 0; k < SCREE_CAM_LAWS; k++) {
        motion.law = (enum scree_cam_law)k;
        limit[k] = scree_conventional_limit(&motion);
        double x, v, a, n = 1.2 * limit[k], t = scree_conventional_detachment(&motion, n);
        CHECK(t > 0.5 * scree_conventional_duration(&motion, n));
        scree_conventional_at(&motion, n, t, &x, &v, &a);
        CLOSE(a, -mu_g, 1e-13);
        CLOSE(scree_conventional_error(&motion, n), x + v * v / (2 * mu_g) - 0.08, 1e-12);
        CHECK(scree_conventional_error(&motion, 0.999 * limit[k]) == 0.0);
        double critical = scree_conventional_critical(&motion, 1e-3);
        NEAR(scree_conventional_error(&motion, critical), 1e-3, 1e-12);
    }
    PRINTED(limit[SCREE_CAM_QUINTIC], 75.727, 1e-3);
    CHECK(limit[SCREE_CAM_MODIFIED_SINE] > limit[SCREE_CAM_QUINTIC] &&
          limit[SCREE_CAM_QUINTIC] > limit[SCREE_CAM_CYCLOID]);
}

static void test_cycles(void) {
    scree_plan plan = plan_of(&task, 500.0, SCREE_PLAN_B);
    static const double overlaps[] = {0.0, 0.3, 1.0};
    for (int k = 0; k < 3; k++) {
        scree_cycle_def def = {.cycles = 500.0, .lift = 0.015, .share = 0.25, .overlap = overlaps[k]};
        scree_cycle cycle;
        CHECK(scree_cycle_make(&def, &plan.profile, &cycle) == 0);
        CLOSE(cycle.duration, 0.12, 1e-15);
        CLOSE(cycle.forward, 0.06, 1e-15);
        const struct scree_profile *axes[2] = {&cycle.x, &cycle.z};
        for (int i = 0; i < 2; i++) {
            struct scree_kinematics jump = scree_profile_jumps(axes[i]), x[2], z[2];
            struct scree_extrema size = scree_profile_extrema(axes[i]);
            /* Sums of polynomial terms about 30 times as large as what they make. */
            CHECK(jump.x <= 1e-15 && jump.v <= 1e-13 * size.largest.v && jump.a <= 1e-13 * size.largest.a);
            scree_cycle_at(&cycle, 0.0, &x[0], &z[0]);
            x[1] = scree_profile_at(&cycle.x, cycle.duration);
            z[1] = scree_profile_at(&cycle.z, cycle.duration);
            struct scree_kinematics start = i ? z[0] : x[0], end = i ? z[1] : x[1];
            NEAR(end.x, start.x, 1e-16);
            NEAR(end.v, start.v, 1e-13 * size.largest.v);
            NEAR(end.a, start.a, 1e-13 * size.largest.a);
            CLOSE(scree_profile_duration(axes[i]), cycle.duration, 1e-15);
        }
        /* In the plane while it pushes, up while it returns; the comb doesn't move back before it has left. */
        struct scree_kinematics x, z;
        for (int i = 0; i <= 600; i++) {
            double t = cycle.duration * i / 600.0;
            scree_cycle_at(&cycle, t + 3.0 * cycle.duration, &x, &z);
            NEAR(x.x, scree_profile_at(&cycle.x, t).x,
                 1e-14); /* time is rounded to an ulp of 0.5 s: 1e-16 times 2 m/s, and periods */
            if (t < cycle.forward) CHECK(z.x == 0.0 && z.v == 0.0);
            if (t > cycle.forward && x.v < -1e-9) CHECK(z.x >= cycle.departure - 1e-12);
            CHECK(z.x >= -1e-15 && z.x <= 0.015 + 1e-15);
        }
        if (k == 0) NEAR(cycle.departure, 0.015, 1e-16);
        if (k == 2) CHECK(cycle.departure == 0.0);
        /* Halfway up after (1 - overlap) of leaving: the quintic's value. */
        double u = 1.0 - overlaps[k];
        NEAR(cycle.departure, 0.015 * u * u * u * (10 - u * (15 - 6 * u)), 1e-16);
    }
}

static void test_bad_cycles(void) {
    scree_plan plan = plan_of(&task, 500.0, SCREE_PLAN_B);
    struct scree_profile moving = plan.profile, empty = {0};
    moving.count = 3; /* ends where the product is caught */
    const struct {
        scree_cycle_def def;
        const struct scree_profile *forward;
        const char *part;
    } bad[] = {{{.lift = 0.01}, &plan.profile, "operating speed"},
               {{.cycles = HUGE_VAL, .lift = 0.01}, &plan.profile, "operating speed"},
               {{.cycles = 500}, &plan.profile, "lift"},
               {{.cycles = 500, .lift = NAN}, &plan.profile, "lift"},
               {{.cycles = 500, .lift = 0.01, .share = 0.6}, &plan.profile, "share of leaving"},
               {{.cycles = 500, .lift = 0.01, .overlap = -0.1}, &plan.profile, "overlap"},
               {{.cycles = 1000, .lift = 0.01}, &plan.profile, "no time for the return"},
               {{.cycles = 500, .lift = 0.01}, &empty, "segments"},
               {{.cycles = 500, .lift = 0.01}, &moving, "at rest"}};
    for (size_t k = 0; k < sizeof bad / sizeof bad[0]; k++) {
        scree_cycle cycle;
        CHECK(scree_cycle_make(&bad[k].def, bad[k].forward, &cycle) == 1);
        CONTAINS(cycle.text, bad[k].part);
    }
    scree_cycle down;
    CHECK(scree_cycle_make(&(scree_cycle_def){.cycles = 400, .lift = -0.01}, &plan.profile, &down) == 0);
    NEAR(scree_profile_extrema(&down.z).least.x, -0.01, 1e-16);
}

/* ---- characteristic map ---- */

static void test_map_weights(void) {
    static const double expected[SCREE_MAP_WEIGHTS] = {0.0, -0.254, -0.866}; /* mm, at 500 between 300 and 700 */
    scree_map_knot knots[4];
    for (int w = 0; w < SCREE_MAP_WEIGHTS; w++) {
        scree_map map = {.weight = (enum scree_map_weight)w, .capacity = 4, .knots = knots};
        scree_plan a = plan_of(&task, 700.0, SCREE_PLAN_A), b = plan_of(&task, 300.0, SCREE_PLAN_A);
        CHECK(scree_map_add(&map, &a) == SCREE_MAP_GOOD && scree_map_add(&map, &b) == SCREE_MAP_GOOD);
        CHECK(map.count == 2 && knots[0].cycles == 300.0 && knots[1].cycles == 700.0);
        struct scree_profile profile;
        for (double n = 300.0; n <= 700.0; n += 12.5) {
            CHECK(scree_map_profile(&map, n, &profile) == SCREE_MAP_GOOD);
            CLOSE(scree_profile_duration(&profile), 30.0 / n, 1e-14);
            NEAR(scree_profile_at(&profile, 1.0).x, 0.06,
                 1e-16 * 4); /* any blend keeps the stroke: rounding of four segments */
        }
        CHECK(scree_map_profile(&map, 500.0, &profile) == SCREE_MAP_GOOD);
        double clearance = 1e3 * scree_map_clearance((void *)(uintptr_t)&task, &profile, 500.0);
        if (w == SCREE_MAP_INVERSE_SQUARE)
            NEAR(clearance, 0.0, 1e-12); /* exact but for rounding */
        else
            PRINTED(clearance, expected[w], 1e-3);
        /* At a knot it is the plan. */
        CHECK(scree_map_profile(&map, 700.0, &profile) == SCREE_MAP_GOOD);
        for (int i = 0; i <= 100; i++)
            NEAR(scree_profile_at(&profile, a.duration * i / 100.0).x,
                 scree_profile_at(&a.profile, a.duration * i / 100.0).x, 1e-16 * 4);
    }
}

static void test_map_states(void) {
    scree_map_knot knots[2], blend;
    scree_map map = {.capacity = 2, .knots = knots};
    struct scree_profile profile;
    CHECK(scree_map_profile(&map, 500.0, &profile) == SCREE_MAP_EMPTY);
    scree_plan plan = plan_of(&task, 500.0, SCREE_PLAN_A), bad = plan_of(&task, 90.0, SCREE_PLAN_A);
    CHECK(scree_map_add(&map, &bad) == SCREE_MAP_BAD_PLAN && map.count == 0);
    CHECK(scree_map_add(&map, &plan) == SCREE_MAP_GOOD);
    CHECK(scree_map_blend(&map, 500.0, &blend) == SCREE_MAP_GOOD && blend.v[1] == knots[0].v[1]);
    CHECK(scree_map_add(&map, &plan) == SCREE_MAP_GOOD && map.count == 1); /* replaced */
    plan = plan_of(&task, 600.0, SCREE_PLAN_A);
    CHECK(scree_map_add(&map, &plan) == SCREE_MAP_GOOD);
    plan = plan_of(&task, 550.0, SCREE_PLAN_A);
    CHECK(scree_map_add(&map, &plan) == SCREE_MAP_FULL && map.count == 2);
    static const double outside[] = {499.999, 600.001, NAN, -1.0, HUGE_VAL};
    for (int k = 0; k < 5; k++) CHECK(scree_map_profile(&map, outside[k], &profile) == SCREE_MAP_OUTSIDE);
    for (int k = SCREE_MAP_GOOD; k <= SCREE_MAP_BAD_INPUT; k++)
        CHECK(scree_map_text((enum scree_map_state)k)[0] != '\0');
    /* Different time shares on both sides: the stroke is kept, too. */
    scree_transport other = task;
    other.fractions[0] = 0.3;
    other.fractions[2] = 0.72;
    plan = plan_of(&other, 600.0, SCREE_PLAN_A);
    CHECK(scree_map_add(&map, &plan) == SCREE_MAP_GOOD && map.count == 2);
    for (double n = 500.0; n <= 600.0; n += 10.0) {
        CHECK(scree_map_profile(&map, n, &profile) == SCREE_MAP_GOOD);
        NEAR(scree_profile_at(&profile, 1.0).x, 0.06, 1e-16 * 4);
    }
}

static double no_number(void *context, const struct scree_profile *profile, double cycles) {
    (void)context, (void)profile, (void)cycles;
    return NAN;
}

static void test_map_placing(void) {
    enum { ROOM = 40 };
    static const enum scree_formulation formulations[] = {SCREE_PLAN_A, SCREE_PLAN_B};
    scree_map_knot knots[ROOM];
    scree_transport t = task;
    int needed[SCREE_MAP_WEIGHTS] = {0};
    for (int f = 0; f < 2; f++)
        for (int w = 0; w < SCREE_MAP_WEIGHTS; w++) {
            scree_map map = {.weight = (enum scree_map_weight)w, .capacity = ROOM, .knots = knots};
            scree_plan_options plan = {.formulation = formulations[f]};
            scree_map_options options = {
                .low = 200, .high = 800, .bound = 2e-5, .samples = 5, .error = scree_map_clearance, .context = &t};
            scree_map_report report = scree_map_place(&map, &t, &plan, &options);
            CHECK(report.state == SCREE_MAP_GOOD && report.error <= 2e-5 && report.at > 200.0 && report.at < 800.0);
            needed[w] = map.count;
            double worst = 0.0;
            for (int k = 0; k + 1 < map.count; k++) {
                CHECK(knots[k].cycles < knots[k + 1].cycles);
                for (int i = 1; i < 40; i++) {
                    struct scree_profile profile;
                    double n = knots[k].cycles + (knots[k + 1].cycles - knots[k].cycles) * i / 40.0;
                    CHECK(scree_map_profile(&map, n, &profile) == SCREE_MAP_GOOD);
                    worst = scree_most(worst, fabs(scree_map_clearance(&t, &profile, n)));
                }
            }
            /* Between six samples an arch of error is missed by (1/12)^2 of its height twice over; bound at 5 %. */
            CHECK(worst <= 1.05 * 2e-5);
            if (f == 0 && w == SCREE_MAP_INVERSE_SQUARE) CHECK(map.count == 2 && report.error < 1e-15);
        }
    CHECK(needed[SCREE_MAP_INVERSE_SQUARE] < needed[SCREE_MAP_INVERSE]);
    CHECK(needed[SCREE_MAP_INVERSE] < needed[SCREE_MAP_LINEAR]);

    scree_map map = {.weight = SCREE_MAP_LINEAR, .capacity = 3, .knots = knots};
    scree_map_options options = {.low = 200, .high = 800, .bound = 2e-5, .error = scree_map_clearance, .context = &t};
    scree_map_report report = scree_map_place(&map, &t, NULL, &options);
    CHECK(report.state == SCREE_MAP_FULL && map.count == 3 && report.error > 2e-5 && isfinite(report.error));
    options.error = no_number;
    report = scree_map_place(&map, &t, NULL, &options);
    CHECK(report.state == SCREE_MAP_FULL && report.error == HUGE_VAL);
    /* However many knots there is room for: halving an interval comes to an end where numbers do. */
    scree_map_knot many[256];
    scree_map roomy = {.weight = SCREE_MAP_LINEAR, .capacity = 256, .knots = many};
    report = scree_map_place(&roomy, &t, NULL, &options);
    CHECK(report.state == SCREE_MAP_FULL && roomy.count < 256);
    options.error = scree_map_clearance;
    options.low = 80.0;
    report = scree_map_place(&map, &t, NULL, &options);
    CHECK(report.state == SCREE_MAP_BAD_PLAN && report.plan.state == SCREE_PLAN_SECOND_SEPARATION);
    options.low = 900.0;
    CHECK(scree_map_place(&map, &t, NULL, &options).state == SCREE_MAP_BAD_INPUT);
    options.low = 200.0;
    options.bound = NAN;
    CHECK(scree_map_place(&map, &t, NULL, &options).state == SCREE_MAP_BAD_INPUT);
}

/* ---- sensitivities ---- */

struct fixed {
    const scree_plan *plan;
    int fails;
};

static int rigid_outcome(void *context, const double conditions[SCREE_CONDITIONS], scree_outcome *outcome) {
    struct fixed *fixed = context;
    if (fixed->fails) return 1;
    scree_transport t = task;
    t.friction = conditions[SCREE_BY_FRICTION];
    t.gap = t.width + conditions[SCREE_BY_PLAY];
    const struct scree_profile *profile = &fixed->plan->profile;
    double left = scree_slide_detachment(profile, t.friction * t.gravity);
    outcome->clearance = scree_slide_catch(&t, profile, left, fixed->plan->time[3]).clearance;
    outcome->error = scree_slide_from(&t, profile, conditions[SCREE_BY_RESTITUTION], conditions[SCREE_BY_START]).error;
    return left < 0.0;
}

static void test_sensitivities(void) {
    static const double at[SCREE_CONDITIONS] = {0.3, 0.02, 1e-3, 0.0, 0.0};
    scree_outcome exact[SCREE_CONDITIONS], differences[SCREE_CONDITIONS];
    for (int n = 300; n <= 700; n += 200) {
        scree_plan b = plan_of(&task, n, SCREE_PLAN_B);
        struct fixed fixed = {&b, 0};
        const double steps[SCREE_CONDITIONS] = {1e-4, 1e-5, 1e-4, 0.0, 0.0};
        CHECK(scree_rigid_sensitivities(&task, &b, exact) == 0);
        CHECK(scree_sensitivities(rigid_outcome, &fixed, at, steps, differences) == 0);
        double slide = b.time[3] - b.detached;
        CLOSE(exact[SCREE_BY_FRICTION].clearance, 0.5 * 9.81 * slide * slide, 1e-9);
        /* Central differences err by (h/mu)^2 = 1e-7 times a factor: the curvature of the detachment's time over the
         * square of the slide's part before it, (t3 - td)/(td - t1) = 50 or so. */
        CLOSE(differences[SCREE_BY_FRICTION].clearance, exact[SCREE_BY_FRICTION].clearance, 1e-5);
        CLOSE(differences[SCREE_BY_FRICTION].error, exact[SCREE_BY_FRICTION].error, 1e-6);
        double tau = b.duration - scree_slide_release(&b.profile, mu_g, b.time[3]);
        CLOSE(exact[SCREE_BY_FRICTION].error, -9.81 * tau * tau / 18.0, 3.0 * tau / (b.duration - b.time[3]));
        NEAR(differences[SCREE_BY_PLAY].clearance, exact[SCREE_BY_PLAY].clearance, 1e-11); /* rounding over the step */
        NEAR(differences[SCREE_BY_PLAY].error, exact[SCREE_BY_PLAY].error, 1e-11);
        NEAR(differences[SCREE_BY_START].clearance, 0.0, 0.0);
        NEAR(differences[SCREE_BY_START].error, 0.0, 1e-12);
        CHECK(differences[SCREE_BY_STIFFNESS].error == 0.0);
    }
    /* Formulation A detaches where the braking just touches friction: the detachment moves as the square root of a
     * change, the product's position as its power 3/2, so differences approach the derivative as the root of the
     * step. */
    scree_plan a = plan_of(&task, 500.0, SCREE_PLAN_A);
    struct fixed fixed = {&a, 0};
    double off[2];
    CHECK(scree_rigid_sensitivities(&task, &a, exact) == 0);
    for (int k = 0; k < 2; k++) {
        const double steps[SCREE_CONDITIONS] = {k ? 2.5e-6 : 1e-5, 0.0, 0.0, 0.0, 0.0};
        CHECK(scree_sensitivities(rigid_outcome, &fixed, at, steps, differences) == 0);
        off[k] = fabs(differences[SCREE_BY_FRICTION].clearance / exact[SCREE_BY_FRICTION].clearance - 1.0);
    }
    CHECK(off[0] < 1e-3);
    CLOSE(off[0] / off[1], 2.0, 0.1);

    fixed.fails = 1;
    CHECK(scree_sensitivities(rigid_outcome, &fixed, at, at, differences) == 1);
    scree_plan soft;
    scree_plan_scaled(&task, &a, 60.0, &soft);
    CHECK(scree_rigid_sensitivities(&task, &soft, exact) == 1);
    for (int k = 0; k < SCREE_CONDITIONS; k++) CHECK(scree_condition_names[k][0] != '\0');
}

/* ---- tables ---- */

enum { COLUMNS = 9 };

struct rows {
    int count, rising;
    double first[COLUMNS], last[COLUMNS];
    double travel[2]; /* of x and z, by Hermite's quadrature of velocities, accelerations and jerks */
};

/* A sum without rounding of its own to speak of (Neumaier, ZAMM 54 (1974) 39). */
static void add(double sum[2], double x) {
    double t = sum[0] + x;
    sum[1] += fabs(sum[0]) >= fabs(x) ? (sum[0] - t) + x : (x - t) + sum[0];
    sum[0] = t;
}

static struct rows read_rows(FILE *file, int columns, double seconds) {
    struct rows rows = {.rising = 1};
    double sum[2][2] = {{0}};
    char line[512];
    rewind(file);
    CHECK(fgets(line, sizeof line, file) != NULL);
    while (fgets(line, sizeof line, file)) {
        double now[COLUMNS] = {0};
        char *at = line;
        for (int k = 0; k < columns; k++) now[k] = strtod(at, &at), at++;
        if (rows.count == 0) memcpy(rows.first, now, sizeof now);
        if (rows.count > 0) {
            double h = (now[0] - rows.last[0]) * seconds;
            rows.rising &= h > 0.0;
            for (int k = 0; 4 * k + 4 < columns; k++) {
                const double *a = rows.last + 1 + 4 * k, *b = now + 1 + 4 * k;
                add(sum[k], h * (a[1] + b[1]) / 2);
                add(sum[k], h * h * (a[2] - b[2]) / 10);
                add(sum[k], h * h * h * (a[3] + b[3]) / 120);
            }
        }
        memcpy(rows.last, now, sizeof now);
        rows.count++;
    }
    for (int k = 0; k < 2; k++) rows.travel[k] = sum[k][0] + sum[k][1];
    return rows;
}

static void test_tables(void) {
    scree_plan plan = plan_of(&task, 500.0, SCREE_PLAN_B);
    static const double rates[] = {50.0, 1000.0, 4000.0, 12345.6};
    for (int k = 0; k < 4; k++) {
        FILE *file = tmpfile();
        scree_table_options options = {.rate = rates[k]};
        CHECK(file != NULL && scree_table_write(file, &plan.profile, &options) == 0);
        struct rows rows = read_rows(file, 5, 1.0);
        int grid = (int)ceil(0.06 * rates[k] - 1e-6);
        CHECK(rows.rising && rows.count > grid && rows.count <= grid + 4);
        CHECK(rows.first[0] == 0.0 && rows.first[1] == 0.0);
        struct scree_kinematics end = scree_segment_at(&plan.profile.segment[3], plan.profile.segment[3].duration);
        CHECK(rows.last[0] == plan.profile.start[4] && rows.last[1] == end.x && rows.last[2] == end.v);
        /* Rounding: of the end position, of times (half an ulp of 0.06 s times differences of up to 2 m/s) and of
         * velocities (half an ulp of 2 m/s times 0.06 s): some 1e-17 each; an ulp of 0.06 m is 7e-18. */
        NEAR(rows.travel[0], rows.last[1], 3e-17);
        NEAR(rows.travel[0], 0.06, 1e-11); /* the stroke itself, as far as the solver has it */
        fclose(file);
    }
    scree_table_options bad = {.rate = 0.0};
    FILE *file = tmpfile();
    struct scree_profile empty = {0};
    CHECK(file != NULL && scree_table_write(file, &plan.profile, &bad) == 1);
    bad.rate = NAN;
    CHECK(scree_table_write(file, &plan.profile, &bad) == 1);
    bad.rate = 1e3;
    CHECK(scree_table_write(file, &empty, &bad) == 1);
    fclose(file);
    FILE *full = fopen("/dev/full", "w");
    if (full) {
        CHECK(scree_table_write(full, &plan.profile, &bad) == 1);
        fclose(full);
    }
}

static void test_cycle_tables(void) {
    scree_plan plan = plan_of(&task, 500.0, SCREE_PLAN_B);
    scree_cycle cycle;
    scree_cycle_def def = {.cycles = 500.0, .lift = 0.015, .overlap = 0.4};
    CHECK(scree_cycle_make(&def, &plan.profile, &cycle) == 0);
    for (int both = 0; both <= 1; both++)
        for (int angle = 0; angle <= 1; angle++) {
            FILE *file = tmpfile();
            scree_table_options options = {.rate = 2000.0, .both_sides = both, .cycles = angle ? 500.0 : 0.0};
            CHECK(file != NULL && scree_table_write_cycle(file, &cycle, &options) == 0);
            struct rows rows = read_rows(file, 9, angle ? 1.0 / 3000.0 : 1.0);
            CHECK(rows.rising == !both);
            NEAR(rows.last[0], angle ? 360.0 : 0.12, angle ? 1e-13 : 0.0);
            NEAR(rows.last[1], 0.0, 1e-16);
            NEAR(rows.last[5], 0.0, 1e-16);
            /* The whole path closes. Angles are rounded to an ulp of 360, 1.2e-16 s here. One-sided jerks at the jumps
             * (two of x, four of z, as large as a quintic's largest jerk) leave h^3/120 each. */
            double h = 1.0 / 2000.0, left = both ? 0.0 : h * h * h / 120.0;
            struct scree_extrema size = scree_profile_extrema(&cycle.z);
            struct scree_kinematics back = scree_segment_at(&cycle.x.segment[5], 0.0);
            NEAR(rows.travel[0], 0.0, 1e-15 + 2.0 * left * fabs(back.j));
            NEAR(rows.travel[1], 0.0, 1e-15 + 4.0 * left * scree_extrema_jerk(&size));
            fclose(file);
        }
}

/* ---- the same bits everywhere ---- */

/* FNV-1a over the bits of some numbers. */
static uint64_t hash_of(uint64_t hash, int count, const double *x) {
    for (int k = 0; k < count; k++) {
        uint64_t bits;
        memcpy(&bits, &x[k], sizeof bits);
        hash = (hash ^ bits) * 0x100000001b3u;
    }
    return hash;
}

/* Plans, slides and limits of formulation A need only + - * / and sqrt, so every build must find these bits. */
static void test_bits(void) {
    uint64_t hash = 0xcbf29ce484222325u;
    for (int n = 300; n <= 700; n += 40) {
        scree_plan plan = plan_of(&task, n, SCREE_PLAN_A);
        double range[2];
        scree_limit_range(&task, &plan, 0.4, 1e-3, &range[0], &range[1]);
        for (int k = 0; k < 4; k++) hash = hash_of(hash, SCREE_SEGMENT_TERMS, plan.profile.segment[k].c);
        hash = hash_of(hash, 2, range);
    }
    CHECK(hash == 0xcd0b45d3f37b93ecu);
    if (hash != 0xcd0b45d3f37b93ecu) printf("  hash %016llx\n", (unsigned long long)hash);
}

int main(void) {
    test_segments();
    test_extrema();
    test_profiles();
    test_merge();
    test_roots();
    test_table_a();
    test_coefficients();
    test_table_b();
    test_nine();
    test_random_starts();
    test_residual_error();
    test_bad_tasks();
    test_failures();
    test_model_in_loop();
    test_stopped();
    test_scaled();
    test_limits();
    test_shares();
    test_rises();
    test_cycles();
    test_bad_cycles();
    test_map_weights();
    test_map_states();
    test_map_placing();
    test_sensitivities();
    test_tables();
    test_cycle_tables();
    test_bits();
    return check_report();
}
