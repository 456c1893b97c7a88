/* Oblique impacts by pair impulses: largest errors over angles and phases of first touch for sliders and for friction
 * that remembers nothing, under laws of every kind; slips that begin and end within a step; slip that turns. "N" is the
 * number of steps in the duration of the contact, which they don't divide. */
#include "tests/steps.h"

/* ---- on a plane ---- */

static void strike(double degrees, const char *laws, double step, double phase, const char *integrator, int substeps,
                   double *velocity) {
    char text[2048];
    double angle = degrees * 3.14159265358979323846 / 180.0;
    snprintf(text, sizeof text,
             "[time]\nend = 1.0\nforce = true\n[[material]]\nname = \"ball\"\n[[material]]\nname = \"wall\"\n"
             "[[body]]\nname = \"wall\"\nshape = { plane = true }\nmaterial = \"wall\"\njoint = \"fixed\"\n"
             "[[body]]\nname = \"ball\"\nshape = { sphere = 0.01 }\nmaterial = \"ball\"\nmass = 0.03\n"
             "position = [0, 0, %.17g]\nvelocity = [%.17g, 0, %.17g]\n[[contact]]\nbetween = [\"ball\", "
             "\"wall\"]\n%s\n",
             0.01 + phase * step * cos(angle), sin(angle), -cos(angle), laws);
    scree_scene *scene = scene_with(text, step, integrator, substeps);
    long most = (long)(6e-3 / step) + 10;
    while (scree_scene_steps(scene) < most) go(scene, 1);
    CHECK(touches(scene) == 0);
    scree_body_state state = state_of(scene, "ball");
    velocity[0] = state.velocity[2];
    velocity[1] = state.velocity[0] - 0.01 * state.spin[1]; /* at the contact */
    scree_scene_destroy(scene);
}

/* The same impact by small steps of the plainest kind (error 1e-6 and less), independent of the engine but for the
 * normal law: a spring of 8e4 N/m behind a slider of 0.3, at the middle of the overlap. */
static void strike_plainly(double degrees, const char *laws, double *velocity) {
    char text[2048];
    double angle = degrees * 3.14159265358979323846 / 180.0, step = 1e-8, radius = 0.01, mass = 0.03;
    snprintf(text, sizeof text, "%s%s\n", ball_on_wall, laws);
    scree_scene *scene = scene_with(text, 1e-6, NULL, 0);
    const struct scree_rule *rule = &scene->contacts.rule[0];
    const struct scree_normal_law *law = scree_normal_laws[rule->normal];
    struct scree_pair_constants pair = law->pair(&rule->normal_constants, mass, radius);
    double overlap = 0.5 * step * cos(angle), closing = cos(angle), along = sin(angle), spin = 0.0, stretch = 0.0;
    for (;;) {
        struct scree_normal_force f =
            law->force(&rule->normal_constants, pair, (struct scree_pressing){.overlap = overlap, .closing = closing});
        double force = f.elastic + f.damping * closing, arm = radius - 0.5 * overlap;
        if (force < 0.0) break;
        double most = 0.3 * force / 8e4;
        stretch = fmin(fmax(stretch, -most), most);
        closing -= step * force / mass;
        along -= step * 8e4 * stretch / mass;
        spin += step * 8e4 * stretch * arm / (0.4 * mass * radius * radius);
        overlap += step * closing;
        stretch += step * (along - arm * spin);
    }
    velocity[0] = -closing;
    velocity[1] = along - radius * spin;
    scree_scene_destroy(scene);
}

struct oblique {
    const char *laws;
    double duration;
    int wide; /* 1 to 5: these laws go several at once, with every change between sticking and sliding located; 2: force
                 sets in as a root, or jumps; 3: the law changes its formula, and steps in which it does go one by one;
                 4: the slider has a dashpot; 5: it is stiffer */
};

/* Largest error over angles and phases at `n` steps a contact. */
static double worst_strike(const struct oblique *o, double n, int substeps, double (*reference)[2]) {
    double worst = 0.0, v[2];
    for (int k = 0; k < 12; k++)
        for (int phase = 0; phase < 16; phase++) {
            double part = (phase + 0.5) / 16.0, step = o->duration / (n - 0.5 + part);
            strike(5.0 + 5.0 * k, o->laws, step, fmod(7.3 * part, 1.0), pair_impulse, substeps, v);
            worst = scree_most(worst, scree_most(fabs(v[0] - reference[k][0]), fabs(v[1] - reference[k][1])));
        }
    return worst;
}

/* Bounds. Of laws that go several at once: Runge-Kutta's phase error over half an oscillation of the tangential spring
 * of angular frequency w = 3100/s, pi (w h)^4/120 of the speed, with two substeps at 20 steps a contact, one at 50, and
 * four: 9e-6, 3.6e-6; 5e-7, 1.4e-8. Where force sets in as a root of the overlap, the clock of the root errs by as much
 * whatever the substeps are: its first step is of a quarter of the root, and what it misses there goes like the impulse
 * of a step. Mindlin's spring may have w = 4000/s at the deepest: where it sticks that makes 0.6 w^5 h^4/120 s^-1 of
 * 0.5 m/s over the contact. A step that goes alone errs by its share of the tangential speed, at most 0.3 (1 + e) pi/2N
 * x 3.5 = 0.1 at 20, times what is too long of its levers on the mean, 1e-3: second order. Behind a dashpot, k/c
 * = 1.6e4/s, the stretch errs in a piece (half a step at 20 steps a contact, one at 50) by what the extrapolated
 * approximant of exp(-z) does, 1.5e-3 and 8e-4, times what the load gains over k, 2.4e-5 and 1.9e-5 m, and forgets half
 * of that by the next one: with w 2.2e-4 and 1.1e-4. In pieces of a quarter that is of third order, but a load that
 * begins like d^1.4 leaves a hundredth of its first piece, 2e-8 m. Of others: second order, since levers stay those of
 * the start of a step, up to u h/(4 R) = 2e-3 of them too long, which approach and parting make good but for a tenth;
 * and behind a dashpot a slider's way, by substeps. */
static void test_oblique(void) {
    static const struct oblique cases[] = {
        {"normal = { law=\"linear-cut\", stiffness=1e5, restitution=0.5 }\nfriction = { law=\"coulomb\", static=0.3, "
         "kinetic=0.3, stiffness=8e4 }",
         1.77e-3, 1},
        {"normal = { law=\"tsuji-cut\", stiffness=5e6, restitution=0.5 }\nfriction = { law=\"coulomb\", static=0.3, "
         "kinetic=0.3, stiffness=8e4 }",
         1.83e-3, 2},
        {"normal = { law=\"linear-cut\", stiffness=1e5, restitution=0.5 }\nfriction = { law=\"coulomb\", static=0.4, "
         "kinetic=0.3, stiffness=8e4 }",
         1.77e-3, 1},
        {"normal = { law=\"hertz\", stiffness=5e6 }\nfriction = { law=\"mindlin\", static=0.3, kinetic=0.3, "
         "shear_modulus=8e6 }",
         1.66e-3, 2},
        {"normal = { law=\"tsuji-cut\", stiffness=5e6, restitution=0.5 }\nfriction = { law=\"mindlin-incremental\", "
         "static=0.3, kinetic=0.3, shear_modulus=8e6 }",
         1.83e-3, 5},
        {"normal = { law=\"hunt-crossley\", stiffness=5e6, exponent=1.5, restitution=0.5, speed=1.0 }\n"
         "friction = { law=\"mindlin-rescaled\", static=0.3, kinetic=0.3, shear_modulus=8e6 }",
         1.8e-3, 2},
        {"normal = { law=\"hertz\", stiffness=5e6 }\nfriction = { law=\"mindlin-incremental\", static=0.4, "
         "kinetic=0.3, shear_modulus=8e6 }",
         1.66e-3, 2},
        {"normal = { law=\"hertz\", stiffness=5e6 }\nfriction = { law=\"mindlin-incremental\", static=0.4, "
         "kinetic=0.3, shear_modulus=8e6, damping=0.2 }",
         1.66e-3, 4},
        {"normal = { law=\"tsuji-cut\", stiffness=5e6, restitution=0.5 }\nfriction = { law=\"mindlin-rescaled\", "
         "static=0.3, kinetic=0.3, shear_modulus=8e6, damping=0.2 }",
         1.83e-3, 4},
        {"normal = { law=\"kuwabara-kono-cut\", stiffness=5e6, restitution=0.5, speed=1.0 }\nfriction = { "
         "law=\"mindlin\", static=0.3, kinetic=0.3, shear_modulus=8e6 }",
         1.8e-3, 2},
        {"normal = { law=\"hunt-crossley\", stiffness=5e6, exponent=1.4, restitution=0.5, speed=1.0 }\n"
         "friction = { law=\"mindlin\", static=0.3, kinetic=0.3, shear_modulus=8e6 }",
         1.8e-3, 2},
        {"normal = { law=\"matched-cut\", stiffness=5e6, exponent=1.5, restitution=0.5 }\nfriction = { "
         "law=\"coulomb\", static=0.3, kinetic=0.3, stiffness=8e4 }",
         1.83e-3, 2},
        {"normal = { law=\"linear-cut\", stiffness=1e5, restitution=0.5 }\nfriction = { law=\"tanh\", kinetic=0.3, "
         "threshold=0.1 }",
         1.77e-3, 2},
        {"normal = { law=\"tsuji-cut\", stiffness=5e6, restitution=0.5 }\nfriction = { law=\"tanh\", kinetic=0.3, "
         "threshold=0.1 }",
         1.83e-3, 2},
        {"normal = { law=\"hunt-crossley\", stiffness=5e6, exponent=1.4, restitution=0.5, speed=1.0 }\nfriction = { "
         "law=\"coulomb\", static=0.3, kinetic=0.3, stiffness=8e4 }",
         1.5e-3, 2},
        {"normal = { law=\"hunt-crossley-1975\", stiffness=5e6, restitution=0.5 }\nfriction = { law=\"mindlin\", "
         "static=0.3, kinetic=0.3, shear_modulus=8e6 }",
         1.75e-3, 2},
        {"normal = { law=\"flores\", stiffness=5e6, exponent=1.4, restitution=0.5 }\nfriction = { law=\"coulomb\", "
         "static=0.3, kinetic=0.3, stiffness=8e4 }",
         1.35e-3, 2},
        {"normal = { law=\"walton-braun\", stiffness=1e5, restitution=0.5 }\nfriction = { law=\"coulomb\", static=0.3, "
         "kinetic=0.3, stiffness=8e4 }",
         1.29e-3, 2},
        {"normal = { law=\"walton-braun\", stiffness=1e5, restitution=0.5 }\nfriction = { law=\"mindlin\", static=0.3, "
         "kinetic=0.3, shear_modulus=8e6 }",
         1.29e-3, 2},
        {"normal = { law=\"thornton\", modulus=3e7, yield=3e6 }\nfriction = { law=\"mindlin\", static=0.3, "
         "kinetic=0.3, shear_modulus=8e6 }",
         1.86e-3, 3},
        {"normal = { law=\"linear-loading\", stiffness=1e5, restitution=0.5 }\nfriction = { law=\"coulomb\", "
         "static=0.3, kinetic=0.3, stiffness=8e4 }",
         1.5e-3, 2},
        {"normal = { law=\"jankowski\", stiffness=5e6, restitution=0.5 }\nfriction = { law=\"mindlin\", static=0.3, "
         "kinetic=0.3, shear_modulus=8e6 }",
         1.63e-3, 2},
        {"normal = { law=\"impact\", stiffness=1e5, exponent=1.0, damping=30.0, full=2e-4 }\nfriction = { "
         "law=\"mindlin\", static=0.3, kinetic=0.3, shear_modulus=8e6 }",
         1.77e-3, 3},
        {"normal = { law=\"blend\", stiffness=1e5, damping=65.4, full=2e-4 }\nfriction = { law=\"tanh\", kinetic=0.3, "
         "threshold=0.1 }",
         1.5e-3, 3},
        {"normal = { law=\"dmt\", stiffness=5e6, adhesion=20.0 }\nfriction = { law=\"mindlin\", static=0.3, "
         "kinetic=0.3, shear_modulus=8e6 }",
         1.67e-3, 2},
        {"normal = { law=\"linear-cut\", stiffness=1e5, restitution=0.5 }\nfriction = { law=\"coulomb\", static=0.3, "
         "kinetic=0.3, stiffness=8e4, damping=5.0 }",
         1.77e-3, 4},
        {"normal = { law=\"hunt-crossley\", stiffness=5e6, exponent=1.4, restitution=0.5, speed=1.0 }\nfriction = { "
         "law=\"coulomb\", static=0.3, kinetic=0.3, stiffness=8e4, damping=5.0 }",
         1.5e-3, 4},
        {"normal = { law=\"dmt\", stiffness=5e6, adhesion=20.0 }\nfriction = { law=\"coulomb\", static=0.4, "
         "kinetic=0.3, stiffness=8e4, damping=5.0 }",
         1.67e-3, 4},
        {"normal = { law=\"jkr\", modulus=3e7, adhesion=20.0 }\nfriction = { law=\"mindlin-incremental\", static=0.3, "
         "kinetic=0.3, shear_modulus=8e6 }",
         1.8e-3, 0},
    };
    for (size_t c = 0; c < sizeof cases / sizeof cases[0]; c++) {
        double fine[12][2], plain[2];
        for (int k = 0; k < 12; k++) {
            strike(5.0 + 5.0 * k, cases[c].laws, cases[c].duration / 4000.0, 0.3, pair_impulse, 4, fine[k]);
            if (c < 2)
                strike_plainly(5.0 + 5.0 * k, cases[c].laws, plain);
            else /* the other integrator: where static friction ends it is up to half a step late, 0.1 x 80 N x 2.2e-7 s
                    x 3.5/0.03 kg */
                strike(5.0 + 5.0 * k, cases[c].laws, cases[c].duration / 4000.0, 0.3, NULL, 0, plain);
            NEAR(fine[k][0], plain[0], c < 2 ? 5e-6 : 2.1e-4);
            NEAR(fine[k][1], plain[1], c < 2 ? 5e-6 : 2.1e-4);
        }
        static const double bounds[6][2][2] = {{{3e-4, 4.8e-5}, {2e-4, 3.2e-5}}, {{9e-6, 3.6e-6}, {5e-7, 1.4e-8}},
                                               {{9e-6, 3.6e-6}, {9e-6, 3.6e-6}}, {{1e-4, 1.6e-5}, {1e-4, 1.6e-5}},
                                               {{2.2e-4, 1.1e-4}, {6e-5, 4e-5}}, {{2e-5, 8e-6}, {2e-5, 8e-6}}};
        const double(*bound)[2] = bounds[cases[c].wide];
        for (int s = 0; s < 2; s++) {
            double at20 = worst_strike(&cases[c], 20.0, s ? 4 : 0, fine);
            double at50 = worst_strike(&cases[c], 50.0, s ? 4 : 0, fine);
            double at200 = worst_strike(&cases[c], 200.0, s ? 4 : 0, fine);
            show(s ? "oblique x4" : "oblique x2", cases[c].laws + 9, at20, at50);
            show("", "N = 200, order", at200, log(at50 / at200) / log(4.0));
            NEAR(at20, 0.0, bound[s][0]);
            NEAR(at50, 0.0, bound[s][1]);
            if (s == 0 && !cases[c].wide) NEAR(log(at50 / at200) / log(4.0), 2.0, 0.2);
        }
    }
}

/* A slider that breaks loose and holds again within a step changes the rest of the contact, though nothing is to be
 * seen of it at the end: by up to the jump from static to kinetic friction (4e-3 to 2e-2 of the speed at these angles,
 * if it is missed). The bound is three times that of oblique impacts at 20 steps a contact: where a load just exceeds
 * what is held, its error moves the instant by its root. */
static void test_slips_in_between(void) {
    static const struct {
        const char *laws;
        double degrees;
    } cases[] = {{"normal = { law=\"linear-loading\", stiffness=1e5, restitution=0.5 }\n"
                  "friction = { law=\"mindlin\", static=0.4, kinetic=0.3, shear_modulus=8e6, damping=0.2 }",
                  38.0},
                 {"normal = { law=\"linear-cut\", stiffness=1e5, restitution=0.5 }\n"
                  "friction = { law=\"mindlin-incremental\", static=0.4, kinetic=0.3, shear_modulus=8e6, damping=0.2 }",
                  38.0},
                 {"normal = { law=\"flores\", stiffness=5e6, exponent=1.4, restitution=0.5 }\n"
                  "friction = { law=\"mindlin-rescaled\", static=0.4, kinetic=0.3, shear_modulus=8e6, damping=0.2 }",
                  18.0},
                 {"normal = { law=\"tsuji\", stiffness=5e6, restitution=0.5 }\n"
                  "friction = { law=\"coulomb\", static=0.3, kinetic=0.3, stiffness=8e4, damping=5.0 }",
                  28.0}};
    for (size_t c = 0; c < sizeof cases / sizeof cases[0]; c++) {
        double fine[2], v[2], worst = 0.0;
        strike(cases[c].degrees, cases[c].laws, 4e-7, 0.3, pair_impulse, 4, fine);
        for (int phase = 0; phase < 16; phase++) {
            double part = (phase + 0.5) / 16.0, step = 1.7e-3 / (19.5 + part);
            strike(cases[c].degrees, cases[c].laws, step, fmod(7.3 * part, 1.0), pair_impulse, 0, v);
            worst = scree_most(worst, scree_most(fabs(v[0] - fine[0]), fabs(v[1] - fine[1])));
        }
        show("in between", cases[c].laws + 9, worst, cases[c].degrees);
        NEAR(worst, 0.0, 1e-3);
    }
}

/* Behind a weak dashpot a slider that breaks loose slides on as behind a bare spring, however much shorter than a step
 * its stretch takes to relax. (One that was taken to hold again erred by up to 0.13 where static friction is the
 * larger.) The dashpot takes pi c w/k of the tangential speed in half an oscillation, which is less than 1 m/s; the
 * stretch errs as in test_oblique. */
static void test_weak_dashpots(void) {
    static const struct {
        const char *laws;
        double per_damping; /* c w/k of a damping of 1 */
    } cases[] = {{"normal = { law=\"linear-cut\", stiffness=1e5, restitution=0.5 }\n"
                  "friction = { law=\"coulomb\", static=0.4, kinetic=0.3, stiffness=8e4, damping=%g }",
                  3100.0 / 8e4},
                 {"normal = { law=\"tsuji\", stiffness=5e6, restitution=0.5 }\n"
                  "friction = { law=\"mindlin\", static=0.4, kinetic=0.3, shear_modulus=8e6, damping=%g }",
                  2.0}};
    for (size_t c = 0; c < sizeof cases / sizeof cases[0]; c++)
        for (double damping = 1e-6; damping < 2e-2; damping *= 10.0) {
            char laws[512], bare[512];
            double worst = 0.0, v[2], expected[2];
            snprintf(laws, sizeof laws, cases[c].laws, damping);
            snprintf(bare, sizeof bare, cases[c].laws, 0.0);
            for (int k = 0; k < 12; k++)
                for (int phase = 0; phase < 4; phase++) {
                    double part = (phase + 0.5) / 4.0, step = 1.77e-3 / (49.5 + part);
                    strike(5.0 + 5.0 * k, laws, step, fmod(7.3 * part, 1.0), pair_impulse, 0, v);
                    strike(5.0 + 5.0 * k, bare, step, fmod(7.3 * part, 1.0), pair_impulse, 0, expected);
                    worst = scree_most(worst, scree_most(fabs(v[0] - expected[0]), fabs(v[1] - expected[1])));
                }
            show("weak dashpot", laws + 9, worst, damping);
            NEAR(worst, 0.0, 3.14159 * cases[c].per_damping * damping + 1.1e-4);
        }
}

/* Springs that keep their force, under laws that change where they turn, or pull at once: as test_oblique has them for
 * those that keep their stretch. With a hold that was missed the errors were 1e-2 and more, and runs stopped where
 * contact ended as a slider broke loose. */
static void test_turns_of_sliders(void) {
    static const struct oblique cases[] = {
        {"normal = { law=\"linear-loading\", stiffness=1e5, restitution=0.5 }\nfriction = { "
         "law=\"mindlin-incremental\", static=0.3, kinetic=0.3, shear_modulus=8e6 }",
         1.5e-3, 0},
        {"normal = { law=\"jankowski\", stiffness=5e6, restitution=0.5 }\nfriction = { law=\"mindlin-incremental\", "
         "static=0.3, kinetic=0.3, shear_modulus=8e6 }",
         1.63e-3, 0},
        {"normal = { law=\"dmt\", stiffness=5e6, adhesion=20.0 }\nfriction = { law=\"mindlin-rescaled\", static=0.3, "
         "kinetic=0.3, shear_modulus=8e6 }",
         1.67e-3, 0}};
    for (size_t c = 0; c < sizeof cases / sizeof cases[0]; c++) {
        double fine[12][2];
        for (int k = 0; k < 12; k++)
            strike(5.0 + 5.0 * k, cases[c].laws, cases[c].duration / 4000.0, 0.3, pair_impulse, 4, fine[k]);
        double at20 = worst_strike(&cases[c], 20.0, 0, fine), at50 = worst_strike(&cases[c], 50.0, 0, fine);
        show("turns", cases[c].laws + 9, at20, at50);
        NEAR(at20, 0.0, 3e-4);
        NEAR(at50, 0.0, 4.8e-5);
    }
}

/* A ball that slides on a plane and leaves it at `speed` comes back within the step under a strong gravity: where it
 * is after `steps` that make 40 us, its velocities there. */
static void skip(const char *laws, double speed, int steps, double *velocity) {
    char text[2048];
    snprintf(text, sizeof text,
             "gravity = [0, 0, -1000]\n[time]\nend = 1.0\n[[material]]\nname = \"ball\"\n[[material]]\n"
             "name = \"wall\"\n[[body]]\nname = \"wall\"\nshape = { plane = true }\nmaterial = \"wall\"\n"
             "joint = \"fixed\"\n[[body]]\nname = \"ball\"\nshape = { sphere = 0.01 }\nmaterial = \"ball\"\n"
             "mass = 0.03\nposition = [0, 0, %.17g]\nvelocity = [1, 0, %.17g]\n"
             "[[contact]]\nbetween = [\"ball\", \"wall\"]\n%s\n",
             0.01 - 4e-6 * speed, speed, laws);
    scree_scene *scene = scene_with(text, 4e-5 / steps, pair_impulse, 0);
    go(scene, steps);
    scree_body_state state = state_of(scene, "ball");
    velocity[0] = state.velocity[2];
    velocity[1] = state.velocity[0] - 0.01 * state.spin[1]; /* at the contact */
    scree_scene_destroy(scene);
}

/* Nothing is to be seen at the end of the step of a flight in it, in which a dashpot would push bodies back before they
 * touch: by c u/m = 15 m/s^2 for some 1e-5 s (1e-4 m/s, measured with such a push); and its friction would be without
 * spring and dashpot to bear it. The slowest don't leave, but part and approach: a law with another formula for each
 * erred by 1e-5 m/s where that wasn't located. Instants are; what remains is of Runge-Kutta over the rest of the step:
 * w h = 0.07, and (w h)^4/120 = 2e-7 of speeds up to 0.04 m/s, 1e-8 m/s; of friction as much. Where a dashpot sets in
 * at rest like t^1.5, the first piece is all the rest of the step, in which Simpson's rule errs by six thousandths of
 * 3e-4 m/s, and what the stages are told of each other by as much again; the bound is twice that. So it is of a spring
 * that keeps its force, whose stiffness sets in as a root: there it was measured, 9e-6. */
static void test_flights_in_between(void) {
    static const struct {
        const char *laws;
        double bound;
    } cases[] = {{"normal = { law=\"linear-loading\", stiffness=1e5, restitution=0.5 }\n"
                  "friction = { law=\"mindlin\", static=0.3, kinetic=0.3, shear_modulus=8e6, damping=0.2 }",
                  3e-8},
                 {"normal = { law=\"linear\", stiffness=1e5, restitution=0.5 }\n"
                  "friction = { law=\"mindlin\", static=0.3, kinetic=0.3, shear_modulus=8e6, damping=0.2 }",
                  3e-8},
                 {"normal = { law=\"linear-loading\", stiffness=1e5, restitution=0.5 }\n"
                  "friction = { law=\"mindlin-incremental\", static=0.3, kinetic=0.3, shear_modulus=8e6 }",
                  1e-5},
                 {"normal = { law=\"linear-loading\", stiffness=1e5, restitution=0.5 }\n"
                  "friction = { law=\"coulomb\", static=0.3, kinetic=0.3, stiffness=8e4, damping=5.0 }",
                  3e-8},
                 {"normal = { law=\"linear\", stiffness=1e5, restitution=0.5 }\n"
                  "friction = { law=\"tanh\", kinetic=0.3, threshold=0.1 }",
                  3e-8},
                 {"normal = { law=\"jankowski\", stiffness=5e6, restitution=0.5 }\n"
                  "friction = { law=\"mindlin\", static=0.3, kinetic=0.3, shear_modulus=8e6, damping=0.2 }",
                  1e-5}};
    for (size_t c = 0; c < sizeof cases / sizeof cases[0]; c++) {
        double worst[2] = {0.0, 0.0}, fine[2], v[2];
        for (int k = 1; k <= 12; k++) {
            double speed = k * 1.2e-3; /* from the seventh on they leave, for up to 29 us */
            skip(cases[c].laws, speed, 1, v);
            skip(cases[c].laws, speed, 400, fine);
            for (int i = 0; i < 2; i++) worst[i] = scree_most(worst[i], fabs(v[i] - fine[i]));
        }
        show("flights", cases[c].laws + 9, worst[0], worst[1]);
        for (int i = 0; i < 2; i++) NEAR(worst[i], 0.0, cases[c].bound);
    }
}

/* ---- two spheres that graze each other ---- */

/* Two balls meet aside of their centres, with spins of their own, so that the slip turns: the velocities that they part
 * with, and of their surfaces by their spins, m/s. Contact lasts for 1.46 ms. */
static void graze(const char *laws, double step, const char *integrator, double numbers[12], scree_energy *books) {
    char text[1024];
    snprintf(text, sizeof text,
             "[time]\nend = 1.0\nforce = true\n[[material]]\nname = \"m\"\n"
             "[[body]]\nname = \"a\"\nshape = { sphere = 0.01 }\nmaterial = \"m\"\nmass = 0.03\n"
             "position = [0, 0, 0]\nvelocity = [1, 0, 0]\nspin = [40, 30, 20]\n"
             "[[body]]\nname = \"b\"\nshape = { sphere = 0.012 }\nmaterial = \"m\"\nmass = 0.05\n"
             "position = [0.0217, 0.006, 0]\nspin = [0, 10, -50]\n"
             "[[contact]]\nbetween = [\"m\", \"m\"]\n%s\n%s",
             laws, books ? "[output]\nwrite = [\"energy.csv\"]\n" : "");
    scree_scene *scene = scene_with(text, step, integrator, 0);
    go(scene, lround(4e-3 / step));
    CHECK(touches(scene) == 0);
    if (books) CHECK(scree_scene_energy(scene, books) == SCREE_OK);
    scree_body_state a = state_of(scene, "a"), b = state_of(scene, "b");
    for (int k = 0; k < 3; k++) {
        numbers[k] = a.velocity[k];
        numbers[3 + k] = b.velocity[k];
        numbers[6 + k] = 0.01 * a.spin[k];
        numbers[9 + k] = 0.012 * b.spin[k];
    }
    scree_scene_destroy(scene);
}

static double largest_difference(const double a[12], const double b[12]) {
    double largest = 0.0;
    for (int k = 0; k < 12; k++) largest = scree_most(largest, fabs(a[k] - b[k]));
    return largest;
}

static double worst_graze(const char *laws, double n, const double reference[12]) {
    double worst = 0.0, numbers[12];
    for (int phase = 0; phase < 8; phase++) {
        graze(laws, 1.46e-3 / (n - 0.5 + (phase + 0.5) / 8.0), pair_impulse, numbers, NULL);
        worst = scree_most(worst, largest_difference(numbers, reference));
    }
    return worst;
}

static const char *const grazes[] = {
    "normal = { law=\"linear-cut\", stiffness=1e5, restitution=0.5 }\n"
    "friction = { law=\"coulomb\", static=0.3, kinetic=0.3, stiffness=8e4, damping=10 }",
    "normal = { law=\"linear-cut\", stiffness=1e5, restitution=0.5 }\n"
    "friction = { law=\"coulomb\", static=0.4, kinetic=0.3, stiffness=8e4 }",
    "normal = { law=\"tsuji\", stiffness=5e6, restitution=0.5 }\n"
    "friction = { law=\"mindlin\", static=0.3, kinetic=0.3, shear_modulus=8e6, damping=0.05 }",
    "normal = { law=\"hertz\", stiffness=5e6 }\n"
    "friction = { law=\"mindlin\", static=0.4, kinetic=0.3, shear_modulus=8e6, damping=0.3 }",
    "normal = { law=\"hertz\", stiffness=5e6 }\n"
    "friction = { law=\"mindlin\", static=0.3, kinetic=0.3, shear_modulus=8e6 }",
};
enum { GRAZES = sizeof grazes / sizeof grazes[0] };

/* Sliders that break loose, turn towards the slip and hold again, with dashpots and without. A load that was linear in
 * time over a step would err by (w h)^2/12, w = pi over the contact's duration: by 3.3e-4 m/s at 50 steps a contact,
 * 2.1e-5 at 200. Reached by way of the middle it is a parabola, which errs by (w h)^3/125: 2e-6 and 3e-8. What remains
 * of second order is the direction of the slip, which turns by less than a tenth of w h in a step: it may have a
 * twentieth of that. The other integrator has the same limit; it is of first order where sliders hold or break loose,
 * up to 2.5e-6 m/s at 73000. */
static void test_turning_slip(void) {
    for (int l = 0; l < GRAZES; l++) {
        double fine[12], verlet[12];
        graze(grazes[l], 1.46e-3 / 4000, pair_impulse, fine, NULL);
        graze(grazes[l], 1.46e-3 / 73000, "time.integrator=\"verlet\"", verlet, NULL);
        NEAR(largest_difference(fine, verlet), 0.0, 2.5e-6);
        double at50 = worst_graze(grazes[l], 50.0, fine), at200 = worst_graze(grazes[l], 200.0, fine);
        show("turning slip", grazes[l] + 9, at50, at200);
        NEAR(at50, 0.0, 1.65e-5);
        NEAR(at200, 0.0, 1.05e-6);
    }
}

/* Their books, kept in the lanes: normal and tangential losses each come to those of fine steps as the loads do, by
 * 3.3e-4 and 2.1e-5 of what is moved about tangentially, 2e-3 J at most of 0.02 J; and lack no more. */
static void test_books_of_grazes(void) {
    static const double n[2] = {50.0, 200.0}, errs[2] = {3.3e-4 * 2e-3, 2.1e-5 * 2e-3};
    for (int l = 0; l < GRAZES; l++) {
        double numbers[12], wrong[2] = {0.0, 0.0};
        scree_energy fine, books;
        graze(grazes[l], 1.46e-3 / 73000, "time.integrator=\"verlet\"", numbers, &fine);
        CHECK(fine.lost_tangential > 1e-3 && fine.lost_tangential < 2e-3);
        for (int phase = 0; phase < 2 * 8; phase++) {
            double *worst = &wrong[phase % 2], part = (phase / 2 + 0.5) / 8.0;
            graze(grazes[l], 1.46e-3 / (n[phase % 2] - 0.5 + part), pair_impulse, numbers, &books);
            *worst = scree_most(*worst, fabs(books.balance));
            *worst = scree_most(*worst, fabs(books.lost_normal - fine.lost_normal));
            *worst = scree_most(*worst, fabs(books.lost_tangential - fine.lost_tangential));
        }
        show("books", grazes[l] + 9, wrong[0], wrong[1]);
        for (int k = 0; k < 2; k++) NEAR(wrong[k], 0.0, errs[k]);
    }
}

/* Contacts of two balls with a rolling law. The impulse behind the torque is nearly exact; the spins that it resists
 * are predicted from the step before, and err by half of what their change changes by in a step: with friction's share
 * of it by (w h)^2/2 of the whole, 2.1e-3 at 49 steps a contact, of second order. A spring reaches its limit inside a
 * step, and errs by that step's share besides. */
static void test_rolling_pair(void) {
    static const char friction[] = "normal = { law=\"linear-cut\", stiffness=1e5, restitution=0.5 }\n"
                                   "friction = { law=\"coulomb\", static=0.3, kinetic=0.3, stiffness=8e4 }\n";
    static const char *const laws[] = {"rolling = { law=\"viscous\", rolling=0.05, twisting=0.03 }",
                                       "rolling = { law=\"spring-dashpot\", rolling=0.05, twisting=0.03, "
                                       "stiffness=4e4, damping=5 }"};
    double free[12], fine[12], coarse[12];
    graze(friction, 1.46e-3 / 4900, "time.integrator=\"verlet\"", free, NULL);
    for (int l = 0; l < 2; l++) {
        char both[400];
        double wrong[2];
        snprintf(both, sizeof both, "%s%s", friction, laws[l]);
        graze(both, 1.46e-3 / 49000, "time.integrator=\"verlet\"", fine, NULL);
        for (int finer = 0; finer < 2; finer++) {
            graze(both, 1.46e-3 / (49 << finer), pair_impulse, coarse, NULL);
            wrong[finer] = largest_difference(coarse, fine);
        }
        double changed = largest_difference(fine, free);
        show("rolling pair", laws[l] + 10, wrong[0] / changed, wrong[1] / changed);
        CHECK(changed > 0.02);
        NEAR(wrong[0], 0.0, (l == 0 ? 2.1e-3 : 1.0 / 49) * changed);
        if (l == 0) CHECK(wrong[1] < 0.3 * wrong[0]);
    }
}

/* ---- many of them ---- */

enum { SIDE = 10, SPHERES = SIDE * SIDE * SIDE };

/* Spheres of 5 mm, not quite in rows, fall on each other between walls; their places after 10 ms in radii. */
static void settle(int steps, double (*place)[3]) {
    static const char *const walls[] = {"[0, 0, 0]\norientation = [1, 0, 0, 0]",
                                        "[0, 0, 0]\norientation = { axis = [0, 1, 0], degrees = 90 }",
                                        "[0, 0, 0]\norientation = { axis = [1, 0, 0], degrees = -90 }",
                                        "[0.103, 0, 0]\norientation = { axis = [0, 1, 0], degrees = -90 }",
                                        "[0, 0.103, 0]\norientation = { axis = [1, 0, 0], degrees = 90 }"};
    size_t size = 256 * SPHERES + 4096, used;
    char *text = malloc(size);
    uint64_t seed = 5;
    used = (size_t)snprintf(text, size,
                            "gravity = [0, 0, -9.81]\n[time]\nend = 1\nforce = true\n[[material]]\nname = \"m\"\n"
                            "density = 2500\n[[contact]]\nbetween = [\"m\", \"m\"]\n"
                            "normal = { law = \"linear-cut\", stiffness = 5e3, restitution = 0.5 }\n"
                            "friction = { law = \"coulomb\", static = 0.4, kinetic = 0.4, stiffness = 4e3 }\n");
    for (int k = 0; k < SPHERES; k++) {
        double at[3];
        check_draw(&seed, -1.5e-4, 1.5e-4, 3, at);
        used += (size_t)snprintf(text + used, size - used,
                                 "[[body]]\nname = \"%d\"\nshape = { sphere = 0.005 }\nmaterial = \"m\"\n"
                                 "position = [%.17g, %.17g, %.17g]\nvelocity = [0, 0, -0.3]\n",
                                 k, 0.00515 + 0.0103 * (k % SIDE) + at[0], 0.00515 + 0.0103 * (k / SIDE % SIDE) + at[1],
                                 0.00515 + 0.0103 * (k / (SIDE * SIDE)) + at[2]);
    }
    for (int k = 0; k < 5; k++)
        used += (size_t)snprintf(text + used, size - used,
                                 "[[body]]\nname = \"wall %d\"\nshape = { plane = true }\nmaterial = \"m\"\n"
                                 "joint = \"fixed\"\nposition = %s\n",
                                 k, walls[k]);
    scree_scene *scene = scene_with(text, 0.01 / steps, pair_impulse, 0);
    go(scene, steps);
    for (int k = 0; k < SPHERES; k++)
        for (int i = 0; i < 3; i++) place[k][i] = scree_scene_body(scene, k).position[i] / 0.005;
    scree_scene_destroy(scene);
    free(text);
}

/* Forces of a body's other contacts jump from step to step, and with them the load of a slider, by a second-order
 * amount. One that should hold again where a step begins once broke loose in turns there until it was left sliding,
 * against the way that it went: some sphere in a heap was off by 2e-3 of its radius, or 3e-3. What remains is of second
 * order: contacts take what others do from the steps before, which makes up to half a contact's overlap, 1e-2, times (w
 * h)^2 = (pi/100)^2, as often as spheres touch here: four times. */
static void test_heap(void) {
    static const int steps[] = {883, 885, 887, 889, 891, 893}; /* 100 a contact */
    static double fine[SPHERES][3], place[SPHERES][3];
    settle(6007, fine);
    for (size_t k = 0; k < sizeof steps / sizeof steps[0]; k++) {
        double worst = 0.0;
        settle(steps[k], place);
        for (int b = 0; b < SPHERES; b++)
            for (int i = 0; i < 3; i++) worst = scree_most(worst, fabs(place[b][i] - fine[b][i]));
        show("heap", "steps; radii", steps[k], worst);
        NEAR(worst, 0.0, 4e-5);
    }
}

int main(void) {
    test_oblique();
    test_slips_in_between();
    test_weak_dashpots();
    test_turns_of_sliders();
    test_flights_in_between();
    test_turning_slip();
    test_books_of_grazes();
    test_rolling_pair();
    test_heap();
    return check_report();
}
