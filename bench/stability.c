/* scree-bench stability: where the step is stable, where it is right, and what the engine says to it. */
#include "bench/bench.h"

#include "engine/scene_file.h"

#include <complex.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char help[] =
    "usage: scree-bench stability [--limits] [--script]\n"
    "\n"
    "A ball on a spring that never opens (pressed deep into a plane, or held sideways by a sticking contact) swings "
    "from\n"
    "rest; its rate over some periods is compared with the exact exp(lambda t). Rows over omega*step (0.01 to 4) and "
    "damping\n"
    "ratio (0 to 2): the step that theory allows, stable or not, wrong by more than 10 % or not, errors of frequency "
    "and\n"
    "decay, and whether the engine takes the step without force = true.\n"
    "\n"
    "  --limits  instead of the map, for each damping ratio: the largest stable omega*step, found by halving, beside "
    "theory;\n"
    "            and the largest with errors below 10 %\n"
    "  --script  print a gnuplot script that draws the maps from data/bench/stability_map.csv\n"
    "\n"
    "example: scree-bench stability --limits\n";

static const char script[] =
    "# scree-bench stability > stability_map.csv; gnuplot stability_map.gp\n"
    "set datafile separator ','\n"
    "set terminal svg size 1700,700 dynamic\n"
    "set output 'stability_map.svg'\n"
    "set multiplot layout 2,5 title 'right (green), wrong by more than 10 % (yellow), unstable (red); line: theory'\n"
    "set logscale x\n"
    "set xlabel 'omega h'\n"
    "set ylabel 'damping ratio'\n"
    "set xrange [0.01:4]\n"
    "set yrange [-0.05:2.05]\n"
    "set key off\n"
    "do for [who in 'verlet pair-impulse'] { do for [law in 'linear hertz tsuji hunt-crossley coulomb'] {\n"
    "  set title who.', '.law\n"
    "  is(word) = (strcol(1) eq who && strcol(2) eq law && strcol(6) eq word) ? $3 : NaN\n"
    "  plot 'stability_map.csv' using 4:(is('right')) pt 7 ps 0.4 lc rgb '#2a9d4e', \\\n"
    "       '' using 4:(is('wrong')) pt 7 ps 0.4 lc rgb '#e0a000', \\\n"
    "       '' using 4:(is('unstable')) pt 7 ps 0.4 lc rgb '#c03030', \\\n"
    "       '' using 5:(strcol(1) eq who && strcol(2) eq law ? $3 : NaN) with lines lc rgb 'black'\n"
    "} }\n"
    "unset multiplot\n";

/* Largest stable omega*step at a damping ratio: engine/plan.c, h^2 K + 4 h C = 4. */
static double verlet_limit(double damping) { return 2.0 * (sqrt(1.0 + 4.0 * damping * damping) - 2.0 * damping); }

/* The same where the spring's stretch is summed up from predicted velocities. With a = h^2 K, b = h C, e = b/2 - a/4
 * the scheme's polynomial is (z - 1)^2 (z + e) + a z^2 + b z (z - 1): a root leaves at z = -1 where b = 1, or a pair of
 * roots where b + e (a + b) = 0. Without damping that is at once: the motion grows by a^2/8 a step. */
static double verlet_limit_of_stretch(double damping) {
    double low = 0.0, high = damping > 0.0 ? 0.5 / damping : 2.0;
    for (int k = 0; k < 60; k++) {
        double turn = 0.5 * (low + high), a = turn * turn, b = 2.0 * damping * turn;
        if (b + (0.5 * b - 0.25 * a) * (a + b) > 0.0)
            low = turn;
        else
            high = turn;
    }
    return low;
}

/* Classical Runge-Kutta, which a lone pair is integrated by: |1 + z + z^2/2 + z^3/6 + z^4/24| <= 1 for both z = lambda
 * h. */
static double runge_kutta_limit(double damping) {
    double complex root = csqrt(damping * damping - 1.0), rate[2] = {-damping + root, -damping - root};
    double turn = 0.0;
    for (int stable = 1; stable && turn < 8.0; turn += 1e-4)
        for (int k = 0; k < 2; k++) {
            double complex z = turn * rate[k];
            stable &= cabs(1.0 + z * (1.0 + z / 2.0 * (1.0 + z / 3.0 * (1.0 + z / 4.0)))) <= 1.0;
        }
    return turn;
}

/* Pair impulses take as many steps of Runge-Kutta as a contact's stiffness asks for, up to so many. */
enum { MOST_STEPS = 64 };
static double pair_impulse_limit(double damping) { return MOST_STEPS * runge_kutta_limit(damping); }

/* The integrators; limits may be NULL where no theory is at hand. */
static const struct {
    const char *name;
    double (*limit)(double damping), (*limit_of_stretch)(double damping);
} integrators[] = {{"verlet", verlet_limit, verlet_limit_of_stretch},
                   {"pair-impulse", pair_impulse_limit, pair_impulse_limit}};

enum law { LINEAR, HERTZ, TSUJI, HUNT_CROSSLEY, COULOMB, LAWS };
static const char *const law_names[LAWS] = {"linear", "hertz", "tsuji", "hunt-crossley", "coulomb"};

/* 1 kg, 1000 rad/s, pressed in by 1 mm of the 5 mm that a ball of 1 cm tolerates. The swing is so small beside that
 * that Hertz's spring is a linear one, and nothing slips, even after a growth by 100. */
static const double omega = 1e3, pressed = 1e-3, swing = 1e-9;

enum { GRID = 40, RATIOS = 21 };

/* Laws of a scene whose ball swings at omega with the damping ratio, and the gravity (m/s^2) that presses it in. */
static double write_laws(enum law law, double ratio, char *text, size_t size) {
    double k = omega * omega, hertz = k / (1.5 * sqrt(pressed)), gravity = k * pressed;
    switch (law) {
    case LINEAR:
        snprintf(text, size, "normal = { law = \"linear\", stiffness = %.17g, damping = %.17g }\n", k,
                 2.0 * ratio * omega);
        return gravity;
    case HERTZ:
        snprintf(text, size, "normal = { law = \"hertz\", stiffness = %.17g }\n", hertz);
        return gravity / 1.5;
    case TSUJI:
        snprintf(text, size, "normal = { law = \"tsuji\", stiffness = %.17g, alpha = %.17g }\n", hertz,
                 2.0 * ratio * sqrt(1.5));
        return gravity / 1.5;
    case HUNT_CROSSLEY:
        snprintf(text, size,
                 "normal = { law = \"hunt-crossley\", stiffness = %.17g, exponent = 1.5, factor = %.17g }\n", hertz,
                 2.0 * ratio * omega / (gravity / 1.5));
        return gravity / 1.5;
    default: /* sideways; the normal spring is soft enough to stay out of it */
        snprintf(text, size,
                 "normal = { law = \"linear\", stiffness = %.17g, damping = 0.0 }\n"
                 "friction = { law = \"coulomb\", static = 10.0, kinetic = 10.0, stiffness = %.17g, damping = %.17g "
                 "}\n",
                 k / 100.0, k, 2.0 * ratio * omega);
        return gravity / 100.0;
    }
}

/* The ball at rest at the origin, given a speed. `force`: take any step. NULL: the engine refuses the step. */
static scree_scene *make_scene(const char *integrator, enum law law, double ratio, double step, int force) {
    char laws[512], text[2048];
    double gravity = write_laws(law, ratio, laws, sizeof laws), speed = swing * omega;
    snprintf(text, sizeof text,
             "gravity = [0, 0, %.17g]\n[time]\nend = 1.0\nstep = %.17g\nforce = %s\nintegrator = \"%s\"\n"
             "[[material]]\nname = \"m\"\n"
             "[[body]]\nname = \"wall\"\nshape = { plane = true }\nmaterial = \"m\"\njoint = \"fixed\"\n"
             "position = [0, 0, %.17g]\n"
             "[[body]]\nname = \"ball\"\nshape = { sphere = 0.01 }\nmaterial = \"m\"\nmass = 1.0\n"
             "joint = { turn = \"fixed\" }\nvelocity = [%.17g, 0, %.17g]\n"
             "[[contact]]\nbetween = [\"m\", \"m\"]\n%s",
             -gravity, step, force ? "true" : "false", integrator, pressed - 0.01, law == COULOMB ? speed : 0.0,
             law == COULOMB ? 0.0 : speed, laws);
    scree_scene *scene = NULL;
    struct scree_run_request request;
    scree_trouble trouble;
    scree_status status = scree_read_scene(text, strlen(text), "stability", NULL, 0, 1, &scene, &request, &trouble);
    scree_free_request(&request);
    if (!status) {
        /* As if it had lain there before it got its speed: the impulse of the last step, from which velocities are
         * predicted. */
        double *impulse = scene->bodies.record[scree_scene_find_body(scene, "ball")].impulse;
        impulse[0] = impulse[1] = 0.0;
        impulse[2] = gravity * step;
        return scene;
    }
    scree_scene_destroy(scene);
    if (force) {
        cli_complain("%s", trouble.text);
        exit(EXIT_MISSED);
    }
    return NULL;
}

static void look(const scree_scene *scene, enum law law, double *x, double *v) {
    scree_body_state state = scree_scene_body(scene, scree_scene_find_body(scene, "ball"));
    int axis = law == COULOMB ? 0 : 2;
    *x = state.position[axis];
    *v = state.velocity[axis];
}

static double theory_of(int integrator, enum law law, double ratio) {
    double (*limit)(double) = law == COULOMB ? integrators[integrator].limit_of_stretch : integrators[integrator].limit;
    return limit ? limit(ratio) : NAN;
}

/* Stays within 100 swings for 2000 steps: what grows by less than 0.2 % a step passes. */
static int is_stable(const char *integrator, enum law law, double ratio, double step) {
    scree_scene *scene = make_scene(integrator, law, ratio, step, 1);
    double x = 0.0, v = 0.0;
    int stable = 1;
    /* No mode begins at zero. */
    scene->bodies.record[scree_scene_find_body(scene, "ball")].impulse[0] = 0.1 * swing * omega;
    for (int k = 0; k < 2000 && stable; k++) {
        stable = scree_scene_step(scene, 1) == SCREE_OK;
        look(scene, law, &x, &v);
        stable &= fabs(x) < 100.0 * swing;
    }
    scree_scene_destroy(scene);
    return stable;
}

struct errors {
    double frequency,
        decay; /* relative; NAN where the exact value is zero (decay: then growth or decay beside omega) */
};

/* Follows q = v - mu x, in which the exact motion is exp(lambda t): the pair of rates is lambda, mu, and lambda the
 * slow one of two real ones. What the scheme's own modes differ from the exact ones wobbles about the mean rate, so
 * some time is left out at the start for the fast mode to die, and the mean taken over up to two periods or a decay by
 * e^-8. */
static struct errors rate_errors(const char *integrator, enum law law, double ratio, double step) {
    double complex root = csqrt(ratio * ratio - 1.0), lambda = omega * (-ratio + root), mu = omega * (-ratio - root);
    double skip = ratio >= 1.0 ? 3.0 / cabs(mu) : 0.0;
    double span =
        ratio >= 1.0 ? 3.0 / cabs(lambda) : fmin(4.0 * acos(-1.0) / fabs(cimag(lambda)), 8.0 / (ratio * omega));
    long first = (long)ceil(skip / step), steps = (long)ceil(span / step);
    if (steps < 4) steps = 4;
    scree_scene *scene = make_scene(integrator, law, ratio, step, 1);
    double x, v, phase = 0.0, size = 0.0;
    double complex before = 0.0;
    for (long k = 0; k <= first + steps; k++) {
        look(scene, law, &x, &v);
        double complex q = v - mu * x;
        if (k > first) {
            phase += carg(q / before);
            size += log(cabs(q / before));
        }
        before = q;
        if (scree_scene_step(scene, 1)) break;
    }
    scree_scene_destroy(scene);
    double time = (double)steps * step;
    struct errors errors = {NAN, NAN};
    if (ratio < 1.0) errors.frequency = (phase / time - cimag(lambda)) / cimag(lambda);
    errors.decay = (size / time - creal(lambda)) / (ratio > 0.0 ? -creal(lambda) : omega);
    return errors;
}

static int is_right(struct errors errors) {
    return !(fabs(errors.frequency) > 0.1) && fabs(errors.decay) <= 0.1; /* no frequency (NAN) is no error */
}

static void print_number(double value) { isnan(value) ? printf(",") : printf(",%.3g", value); }

static void print_map(int integrator, enum law law) {
    const char *name = integrators[integrator].name;
    for (int r = 0; r < (law == HERTZ ? 1 : RATIOS); r++) {
        double ratio = 0.1 * r;
        for (int k = 0; k < GRID; k++) {
            double turn = 0.01 * pow(400.0, k / (GRID - 1.0)), step = turn / omega;
            int stable = is_stable(name, law, ratio, step);
            struct errors errors = {NAN, NAN};
            if (stable) errors = rate_errors(name, law, ratio, step);
            scree_scene *scene = make_scene(name, law, ratio, step, 0);
            printf("%s,%s,%.1f,%.4g", name, law_names[law], ratio, turn);
            print_number(theory_of(integrator, law, ratio));
            printf(",%s", !stable ? "unstable" : is_right(errors) ? "right" : "wrong");
            print_number(errors.frequency);
            print_number(errors.decay);
            printf(",%s\n", scene ? "taken" : "refused");
            scree_scene_destroy(scene);
        }
    }
}

static int is_good(const char *integrator, enum law law, double ratio, double turn, int right) {
    double step = turn / omega;
    return is_stable(integrator, law, ratio, step) && (!right || is_right(rate_errors(integrator, law, ratio, step)));
}

/* Largest omega*step below which all are stable (or right): upwards to the first that isn't, for some far beyond may be
 * so again; then by halving. Gaps in what is right are narrower. */
static double find_limit(const char *integrator, enum law law, double ratio, int right) {
    double low = 0.1, high = 0.1, stride = right ? 1.02 : 1.1;
    for (; high < 512.0 && is_good(integrator, law, ratio, high, right); high *= stride) low = high;
    for (int k = 0; k < 18; k++) {
        double middle = sqrt(low * high);
        *(is_good(integrator, law, ratio, middle, right) ? &low : &high) = middle;
    }
    return low;
}

static void print_limits(int integrator, enum law law) {
    const char *name = integrators[integrator].name;
    for (int r = 0; r < (law == HERTZ ? 1 : RATIOS); r++) {
        double ratio = 0.1 * r, limit = find_limit(name, law, ratio, 0), right = find_limit(name, law, ratio, 1);
        double theory = theory_of(integrator, law, ratio);
        printf("%s,%s,%.1f,%.5g", name, law_names[law], ratio, limit);
        print_number(theory);
        print_number(theory > 0.0 ? limit / theory - 1.0 : NAN);
        printf(",%.4g\n", right);
    }
}

int bench_stability(int count, char **words) {
    int limits = 0, wants_script = 0;
    const struct cli_option options[] = {
        {.name = "--limits", .flag = &limits}, {.name = "--script", .flag = &wants_script}, {0}};
    int code = bench_parse(count, words, options, help);
    if (code) return code < 0 ? EXIT_GOOD : code;
    if (wants_script) {
        fputs(script, stdout);
        return EXIT_GOOD;
    }
    bench_describe_machine();
    printf("%s\n", limits ? "integrator,law,damping_ratio,largest_stable_omega_h,theory,error,largest_right_omega_h"
                          : "integrator,law,damping_ratio,omega_h,theory,verdict,frequency_error,decay_error,engine");
    for (size_t k = 0; k < sizeof integrators / sizeof integrators[0]; k++)
        for (int law = 0; law < LAWS; law++)
            limits ? print_limits((int)k, (enum law)law) : print_map((int)k, (enum law)law);
    return EXIT_GOOD;
}
