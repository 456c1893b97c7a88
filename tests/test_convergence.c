/* Observed orders of convergence of the fixed-step integrators, on the smooth cases of scree-bench precision
 * (bench/precision_cases.c) and variations of them; and the errors of a frictional pile. tests/test_integrators.c has
 * lone impacts of every normal law, rows and cradles with their bounds, tests/test_oblique.c oblique impacts.
 *
 * The order is the slope, by least squares, of the logarithm of the error's root mean square over phases of first
 * touch. What orders are to be expected (h: step):
 *   verlet        2. Where the spring begins as d^(3/2), a step in which the touch falls errs by h^(5/2): 2.5 where
 *                 nothing of second order hides it, so for springs alone, whose second-order error is one of phase and
 *                 cancels at d = 0. Where a dashpot begins as d^(1/4), d^(1/2): 1.25, 1.5.
 *   pair-impulse  that of classical Runge-Kutta, 4, for a lone pair whose law is a polynomial between located ends; 5
 *                 where the spring is linear and alone (the term of fourth order is in the phase). 2.5 where it begins
 *                 as d^(3/2), which has no third derivative. 2 where a contact needs what others do to its bodies, or
 *                 friction turns with the normal; 3 in an elastic row, for the error of extrapolation changes its sign
 *                 as the bodies turn round.
 *   free body     2: half a turn, a step, half a turn. */
#include "tests/scenes.h"

#include "bench/precision.h"

static const char verlet[] = "time.integrator=\"verlet\"", pair[] = "time.integrator=\"pair-impulse\"";

static scree_scene *scene_of(const struct precision_case *c, const char *const *changes, int count) {
    char *text = c->scene ? NULL : c->make(c);
    scree_scene *scene = scene_from(text ? text : c->scene, changes, count, 1);
    free(text);
    return scene;
}

static void run(const struct precision_case *c, const char *integrator, const char *change, double step, double phase,
                double *numbers) {
    char length[64], place[160];
    long steps = (long)ceil(c->time / step);
    if (c->timed) step = c->time / (double)(steps = lround(c->time / step));
    const char *changes[4] = {length, integrator};
    int count = 2;
    snprintf(length, sizeof length, "time.step=%.17g", step);
    snprintf(place, sizeof place, "%s.position=[%.17g, %.17g, %.17g]", c->arrives ? c->arrives : "",
             c->touch[0] - phase * step * c->velocity[0], c->touch[1] - phase * step * c->velocity[1],
             c->touch[2] - phase * step * c->velocity[2]);
    if (c->arrives) changes[count++] = place;
    if (change) changes[count++] = change;
    scree_scene *scene = scene_of(c, changes, count);
    go(scene, steps);
    c->look(c, scene, numbers);
    scree_scene_destroy(scene);
}

enum { PHASES = 16, NUMBERS = 8 };

static double rms(const struct precision_case *c, const char *integrator, const char *change, double n,
                  const double *right) {
    double squares = 0.0, numbers[NUMBERS];
    for (int phase = 0; phase < PHASES; phase++) {
        double part = (phase + 0.5) / PHASES;
        run(c, integrator, change, c->duration / (n - 0.5 + part), fmod(7.3 * part, 1.0), numbers);
        for (int k = 0; k < c->numbers; k++) squares += (numbers[k] - right[k]) * (numbers[k] - right[k]);
    }
    return sqrt(squares / PHASES / c->numbers);
}

/* The slope over from, 2 from, … to steps a contact. */
static double order_of(const struct precision_case *c, const char *integrator, const char *change, double from,
                       double to, const double *right) {
    double count = 0.0, x = 0.0, y = 0.0, xx = 0.0, xy = 0.0;
    for (double n = from; n < 1.1 * to; n *= 2.0) {
        double a = log(n), b = log(rms(c, integrator, change, n, right));
        count += 1.0;
        x += a;
        y += b;
        xx += a * a;
        xy += a * b;
    }
    return -(count * xy - x * y) / (count * xx - x * x);
}

static const struct {
    const char *name, *integrator, *change;
    double from, to, order;
} slopes[] = {
    {"damped impact", verlet, NULL, 25, 1600, 2.0},
    {"damped impact", pair, NULL, 25, 800, 4.0},
    {"hertz impact", verlet, NULL, 25, 1600, 2.5},
    {"hertz impact", pair, NULL, 25, 1600, 2.5},
    {"tsuji impact", verlet, NULL, 100, 1600, 1.25},
    {"tsuji impact", verlet, "contact.0.normal={law=\"kuwabara-kono-cut\", stiffness=5e6, restitution=0.5, speed=1.0}",
     100, 1600, 1.5},
    {"hunt-crossley impact", verlet, NULL, 25, 1600, 2.0},
    {"hunt-crossley impact", pair, NULL, 50, 1600, 2.5},
    {"walton-braun impact", verlet, NULL, 25, 1600, 2.0},
    {"walton-braun impact", pair, NULL, 25, 400, 5.0},
    {"thornton impact", verlet, NULL, 100, 1600, 2.5},
    {"thornton impact", pair, NULL, 50, 1600, 2.5},
    {"oblique impact", verlet, "contact.0.friction={law=\"coulomb\", static=10, kinetic=10, stiffness=8e4}", 100, 800,
     2.0},
    {"oblique impact (mindlin)", verlet,
     "contact.0={between=[\"ball\",\"wall\"], normal={law=\"hertz\", stiffness=5e6}, friction={law=\"mindlin\", "
     "static=10, kinetic=10, "
     "shear_modulus=8e6}}",
     100, 800, 2.0},
    {"oblique impact (mindlin)", verlet,
     "contact.0={between=[\"ball\",\"wall\"], normal={law=\"hertz\", stiffness=5e6}, "
     "friction={law=\"mindlin-incremental\", static=10, kinetic=10, "
     "shear_modulus=8e6}}",
     100, 800, 2.0},
    {"oblique impact (mindlin)", verlet,
     "contact.0={between=[\"ball\",\"wall\"], normal={law=\"hertz\", stiffness=5e6}, "
     "friction={law=\"mindlin-rescaled\", static=10, kinetic=10, "
     "shear_modulus=8e6}}",
     100, 800, 2.0},
    /* Runge-Kutta's order where spring and slider change at located instants. */
    {"oblique impact", pair, "contact.0.friction={law=\"coulomb\", static=10, kinetic=10, stiffness=8e4}", 50, 400,
     4.0},
    {"oblique impact", pair, "contact.0.friction={law=\"coulomb\", static=0.05, kinetic=0.05, stiffness=8e4}", 50, 400,
     4.0},
    {"oblique impact", pair, "contact.0.friction={law=\"coulomb\", static=0.3, kinetic=0.2, stiffness=8e4}", 50, 400,
     4.0},
    {"sphere rolls down an incline", verlet, NULL, 100, 800, 2.0},
    /* With a given number of substeps: left to itself the integrator takes one or two, whichever the step asks for, and
     * errors are no single power. */
    {"sphere rolls down an incline", pair, "time.substeps=2", 25, 200, 4.0},
    {"sphere slips down an incline", pair, "time.substeps=2", 25, 200, 4.0},
    /* Corners break loose and hold again one after the other. */
    {"box down an incline", pair, NULL, 50, 200, 2.0},
    {"cradle", verlet, NULL, 50, 800, 2.0},
    {"cradle", pair, NULL, 200, 1600, 3.0},
    {"damped row of three", verlet, NULL, 50, 400, 2.0},
    {"damped row of three", pair, NULL, 200, 1600, 2.0},
    {"squeezed spheres", verlet, NULL, 50, 400, 2.0},
    {"squeezed spheres", pair, NULL, 200, 1600, 2.0},
    {"attitude of a free top after 12 turns", verlet, NULL, 25, 100, 2.0},
};

static const struct precision_case *find(const char *name) {
    for (int k = 0; k < precision_case_count; k++)
        if (strcmp(precision_cases[k].name, name) == 0) return &precision_cases[k];
    printf("no case %s\n", name);
    exit(1);
}

static void test_orders(void) {
    for (size_t k = 0; k < sizeof slopes / sizeof slopes[0]; k++) {
        const struct precision_case *c = find(slopes[k].name);
        double right[NUMBERS];
        CHECK(c->numbers <= NUMBERS);
        if (c->right)
            memcpy(right, c->right, sizeof(double) * (size_t)c->numbers);
        else if (c->solve)
            c->solve(c, right);
        else /* at 12.5 times the finest steps of the row, an error of 1 % or less of theirs */
            run(c, pair, slopes[k].change, c->duration / (12.5 * slopes[k].to), 0.0, right);
        double order = order_of(c, slopes[k].integrator, slopes[k].change, slopes[k].from, slopes[k].to, right);
        if (getenv("SCREE_SHOW"))
            printf("%-32s %-14.14s order %.2f (%g)\n", c->name, slopes[k].integrator + 16, order, slopes[k].order);
        NEAR(order, slopes[k].order, 0.2);
    }
}

/* ---- the closed forms of the cases ---- */

/* The ball on a spring goes about the rigid one: its slip is off by the stretch at the limit or less, its velocity by
 * twice that times the spring's rate q, its way by that for all the time. */
static void test_rolling_reference(void) {
    struct check_table *slope = check_read("incline_block_and_sphere.csv");
    for (int row = 0; row < slope->rows; row++) {
        double degrees = check_number(slope, row, "alpha_deg"), mu = check_number(slope, row, "mu"), numbers[3];
        struct precision_ball b = {0.01, 0.03, 9.81, degrees * 3.14159265358979323846 / 180.0, 1e9, 1e8, mu, 0.0, 0.3};
        double stretch = mu * b.mass * b.gravity / b.k_t, q = sqrt(b.k_t * 3.5 / b.mass);
        precision_roll(&b, numbers);
        NEAR(numbers[0], 0.5 * check_number(slope, row, "a_sphere") * 0.09, 2.0 * stretch * q * 0.3 + 1e-9);
        NEAR(numbers[1], check_number(slope, row, "a_sphere") * 0.3, 2.0 * stretch * q + 1e-9);
        NEAR(numbers[2], check_number(slope, row, "R_domega_dt") * 0.3, 2.0 * stretch * q + 1e-9);
    }
    free(slope);
    struct check_table *slip = check_read("mfix_dem04_exact.csv");
    for (int row = 0; row < slip->rows; row++) {
        double mu = check_number(slip, row, "mu"), numbers[3];
        struct precision_ball b = {5e-4, 5.235987755982989e-6, 9.80665, 0.0, 1e9, 1e8, mu, 0.1, 0.0};
        double stretch = mu * b.mass * b.gravity / b.k_t, q = sqrt(b.k_t * 3.5 / b.mass);
        b.time = check_number(slip, row, "t_s");
        precision_roll(&b, numbers);
        NEAR(numbers[0], check_number(slip, row, "distance"), 2.0 * stretch);
        NEAR(numbers[1], check_number(slip, row, "u_end"), 2.0 * stretch * q);
        NEAR(numbers[2], 5e-4 * check_number(slip, row, "omega_end"), 2.0 * stretch * q);
    }
    free(slip);
}

/* Without gravity on the spring a bounce would last pi/omega and leave e of the speed; with it, each is off by parts of
 * 2 g/(omega v) or less, where v > 1.1 m/s. A ball on an elastic spring comes back to where it was. */
static void test_bouncing_reference(void) {
    static const double pi = 3.14159265358979323846;
    double numbers[2], zeta = -log(0.9) / hypot(pi, log(0.9)), speed = 2.0;
    for (int n = 1; n <= 5; n++) {
        double top = n * pi / 1e5, up = speed * pow(0.9, n);
        for (int k = 1; k < n; k++) top += 2.0 * speed * pow(0.9, k) / 9.81;
        CHECK(precision_bounce(1.0, 9.81, 1e10, zeta, speed, top + up / 9.81, numbers) == n);
        NEAR(numbers[0], 0.5 * up * up / 9.81, n * 2.0 * 9.81 / 1e5);
        NEAR(numbers[1], 0.0, n * 2.0 * 9.81 / 1e5);
    }
    double period = 2.0 / 9.81 + (pi + 2.0 * atan(9.81 / 1e2)) / 1e2;
    CHECK(precision_bounce(1.0, 9.81, 1e4, 0.0, 1.0, 7.0 * period + 0.01, numbers) == 7);
    NEAR(numbers[0], -(9.81e-4 * (1.0 - cos(1.0)) + 1e-2 * sin(1.0)), 1e-13);
    NEAR(numbers[1], -(9.81e-2 * sin(1.0) + cos(1.0)), 1e-11);
}

/* ---- a pile ---- */

/* Two spheres rest on a floor, a third falls between them, off the middle: six pairs, friction 0.4. Velocities after 8
 * times the duration of a contact (a few impacts, each of which doubles errors at most). */
enum { DISCS = 3, PILE = 3 * DISCS };

struct pile {
    const char *laws;
    double duration;
};

static void run_pile(const struct pile *p, const char *integrator, double n, double *numbers) {
    char text[2048], change[64];
    long steps = lround(8.0 * n);
    snprintf(text, sizeof text,
             "gravity = [0, 0, -9.81]\n[time]\nend = 1.0\nforce = true\n[[material]]\nname = \"m\"\n"
             "[[body]]\nname = \"0\"\nshape = { sphere = 0.01 }\nmaterial = \"m\"\nmass = 0.03\n"
             "position = [-0.0105, 0, 0.01]\n"
             "[[body]]\nname = \"1\"\nshape = { sphere = 0.01 }\nmaterial = \"m\"\nmass = 0.03\n"
             "position = [0.0105, 0, 0.01]\n"
             "[[body]]\nname = \"2\"\nshape = { sphere = 0.01 }\nmaterial = \"m\"\nmass = 0.03\n"
             "position = [0.001, 0, 0.0275]\nvelocity = [0.1, 0, -1]\nspin = [0, 20, 0]\n"
             "[[body]]\nname = \"floor\"\nshape = { plane = true }\nmaterial = \"m\"\njoint = \"fixed\"\n"
             "[[contact]]\nbetween = [\"m\", \"m\"]\n%s\n",
             p->laws);
    snprintf(change, sizeof change, "time.step=%.17g", 8.0 * p->duration / (double)steps);
    const char *changes[] = {change, integrator, "time.substeps=4"};
    scree_scene *scene = scene_from(text, changes, n > 1000.0 && integrator == pair ? 3 : 2, 1);
    go(scene, steps);
    for (int k = 0; k < DISCS; k++) {
        scree_body_state body = scree_scene_body(scene, k);
        numbers[3 * k] = body.velocity[0];
        numbers[3 * k + 1] = body.velocity[2];
        numbers[3 * k + 2] = 0.01 * body.spin[1];
    }
    scree_scene_destroy(scene);
}

static double worst_pile(const struct pile *p, double n, const double *right) {
    double worst = 0.0, numbers[PILE];
    for (int k = 0; k < 16; k++) {
        run_pile(p, pair, n - 0.5 + (k + 0.5) / 16.0, numbers);
        for (int i = 0; i < PILE; i++) worst = scree_most(worst, fabs(numbers[i] - right[i]));
    }
    return worst;
}

static void test_pile(void) {
    static const struct pile piles[] = {
        {"normal = { law=\"linear-cut\", stiffness=1e5, restitution=0.5 }\nfriction = { law=\"coulomb\", static=0.4, "
         "kinetic=0.4, stiffness=8e4 }",
         1.25e-3},
        {"normal = { law=\"tsuji-cut\", stiffness=5e6, restitution=0.5 }\nfriction = { law=\"mindlin-incremental\", "
         "static=0.4, kinetic=0.4, shear_modulus=8e6 }",
         1.4e-3},
        {"normal = { law=\"hunt-crossley\", stiffness=5e6, restitution=0.5, speed=1.0 }\nfriction = { "
         "law=\"mindlin-rescaled\", static=0.4, kinetic=0.4, shear_modulus=8e6 }",
         1.4e-3},
    };
    for (size_t k = 0; k < sizeof piles / sizeof piles[0]; k++) {
        double right[PILE], other[PILE];
        run_pile(&piles[k], pair, 4000.0, right);
        run_pile(&piles[k], verlet, 4000.0, other);
        double apart = 0.0;
        for (int i = 0; i < PILE; i++) apart = scree_most(apart, fabs(right[i] - other[i]));
        double at20 = worst_pile(&piles[k], 20.0, right), at50 = worst_pile(&piles[k], 50.0, right);
        if (getenv("SCREE_SHOW")) printf("pile %-48.48s %.2e %.2e, verlet %.1e\n", piles[k].laws, at20, at50, apart);
        NEAR(apart, 0.0,
             4e-2 * 20.0 / 4000.0); /* verlet: of first order where friction begins, 4e-2 at 20 steps a contact */
        NEAR(at20, 0.0, 1e-3);
        NEAR(at50, 0.0, 1.2e-4);
    }
}

/* ---- an oblique impact of two spheres ---- */

/* Largest error of the sphere's velocity and spin, in parts of each, after an impact of 56 steps times `finer`. */
static double oblique_error(double damping, int finer) {
    static const char scene_text[] =
        "gravity = [0, 0, 0]\n[time]\nend = 0.002\nintegrator = \"%s\"\n%s\n"
        "[[material]]\nname = \"glass\"\ndensity = 2500\n[[contact]]\nbetween = [\"glass\", \"glass\"]\n"
        "normal = { law = \"linear\", stiffness = 500, restitution = 0.7 }\n"
        "friction = { law = \"coulomb\", static = 0.4, kinetic = 0.4, stiffness = 200, damping = %g }\n"
        "[[body]]\nname = \"rod\"\nshape = { sphere = 0.002 }\nmaterial = \"glass\"\njoint = \"fixed\"\n"
        "[[body]]\nname = \"ball\"\nshape = { sphere = 0.00099 }\nmaterial = \"glass\"\n"
        "position = [0.0011, 0.0003, 0.0029]\nvelocity = [0, 0, -0.25]\n";
    double number[2][3], error = 0.0;
    for (int exact = 0; exact < 2; exact++) {
        char text[1200], step[64];
        snprintf(step, sizeof step, exact ? "tolerance = 1e-13" : "step = %.17g", 8e-6 / finer);
        snprintf(text, sizeof text, scene_text, exact ? "adaptive" : "pair-impulse", step, damping);
        scree_scene *scene = scene_from(text, NULL, 0, 1);
        go(scene, exact ? scree_steps_to(scene, 0.002) : 250L * finer);
        scree_body_state state = state_of(scene, "ball");
        number[exact][0] = state.velocity[0];
        number[exact][1] = state.velocity[2];
        number[exact][2] = state.spin[1];
        scree_scene_destroy(scene);
    }
    for (int k = 0; k < 3; k++) error = scree_most(error, fabs(number[0][k] / number[1][k] - 1.0));
    return error;
}

/* The README's figures, rounded up; and that the errors fall as they should, over a factor of eight in the step. */
static void test_oblique_spheres(void) {
    double bare = oblique_error(0.0, 1), damped = oblique_error(0.05, 1);
    double fine_bare = oblique_error(0.0, 8), fine_damped = oblique_error(0.05, 8);
    if (getenv("SCREE_SHOW")) printf("oblique %.2e %.2e, damped %.2e %.2e\n", bare, fine_bare, damped, fine_damped);
    CHECK(bare < 1e-5 && log2(bare / fine_bare) > 3.0 * 1.8);
    CHECK(damped < 1e-5 && log2(damped / fine_damped) > 3.0 * 1.8);
}

int main(void) {
    test_orders();
    test_oblique_spheres();
    test_rolling_reference();
    test_bouncing_reference();
    test_pile();
    return check_report();
}
