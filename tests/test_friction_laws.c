/* contact/: friction and rolling laws against tables, closed forms and the second law; one at a time and in the
 * engine. */
#include "contact/slider.h"

#include "tests/scenes.h"

static const struct scree_pair_constants no_pair = {{0.0}};
static const double g = 9.81;

/* ---- one law by itself ---- */

struct friction {
    struct scree_rule rule;
    const struct scree_friction_law *law;
};

static struct friction make(scree_law_choice choice) {
    scree_contact_def def = {.normal = {"linear", 2, {{"stiffness", 1e5}, {"damping", 0.0}}}, .friction = choice};
    struct friction f;
    scree_trouble trouble = {0};
    CHECK(scree_bake_rule(&def, NULL, &f.rule, &trouble) == SCREE_OK);
    if (trouble.text[0]) printf("  %s\n", trouble.text);
    f.law = scree_friction_laws[f.rule.friction];
    return f;
}

static struct scree_tangential act(const struct friction *f, struct scree_pair_constants pair,
                                   struct scree_sliding at) {
    return f->law->force(&f->rule.friction_constants, pair, at);
}

/* Coefficient at speed v in a slanting direction: the force is against it, and the other way round with it. */
static double coefficient(const struct friction *f, double v) {
    struct vec along = vec(0.6, 0.0, -0.8);
    struct scree_sliding at = {.normal = 2.0, .velocity = vec_scale(v, along)};
    struct vec force = act(f, no_pair, at).force;
    NEAR(vec_norm(vec_cross(force, along)), 0.0, 1e-15);
    at.velocity = vec_scale(-v, along);
    NEAR(vec_norm(vec_add(act(f, no_pair, at).force, force)), 0.0, 0.0);
    return -vec_dot(force, along) / 2.0;
}

static void test_values(void) {
    static const struct {
        const char *column;
        scree_law_choice choice;
    } laws[] = {
        {"linear", {"ramp", 2, {{"kinetic", 0.4}, {"threshold", 1e-3}}}},
        {"tanh", {"tanh", 2, {{"kinetic", 0.4}, {"threshold", 1e-3}}}},
        {"cubic",
         {"step", 4, {{"static", 0.4}, {"kinetic", 0.4}, {"stiction_speed", 1e-3}, {"sliding_speed", 1.5e-3}}}},
        {"threlfall", {"threlfall", 2, {{"kinetic", 0.4}, {"threshold", 1e-3}}}},
        {"bengisu_akay",
         {"bengisu-akay", 4, {{"static", 0.6}, {"kinetic", 0.4}, {"threshold", 1e-3}, {"fall", 100.0}}}},
        {"ambrosio", {"ambrosio", 3, {{"kinetic", 0.4}, {"tolerance", 1e-4}, {"threshold", 1e-3}}}},
        {"stribeck_exp",
         {"stribeck", 4, {{"static", 0.6}, {"kinetic", 0.4}, {"stribeck_speed", 0.01}, {"threshold", 1e-5}}}},
        {"simscape", {"simscape", 3, {{"static", 0.6}, {"kinetic", 0.4}, {"threshold", 1e-3}}}},
        {"cfl_stick_slip", {"stick-slip", 3, {{"static", 0.6}, {"kinetic", 0.4}, {"threshold", 1e-3}}}},
        {"adams_static_kinetic",
         {"step", 4, {{"static", 0.6}, {"kinetic", 0.4}, {"stiction_speed", 1e-3}, {"sliding_speed", 1.5e-3}}}},
    };
    struct check_table *table = check_read("friction_law_values.csv");
    CHECK(table->columns == 1 + (int)(sizeof laws / sizeof laws[0]) && table->rows == 11);
    for (size_t l = 0; l < sizeof laws / sizeof laws[0]; l++) {
        struct friction f = make(laws[l].choice);
        CHECK(f.law->memory == 0);
        /* 15 digits in the table, a few roundings here. */
        for (int row = 0; row < table->rows; row++)
            NEAR(coefficient(&f, check_number(table, row, "v")), check_number(table, row, laws[l].column), 1e-15);
        /* slope() bounds the rise of the coefficient, and no law has a jump. */
        double slope = f.law->slope(&f.rule.friction_constants);
        for (double v = 0.0; v < 3e-3; v += 1e-6)
            CHECK(fabs(coefficient(&f, v + 1e-7) - coefficient(&f, v)) <= slope * 1e-7 * (1.0 + 1e-9));
    }
    free(table);
}

/* The viscous part, and Stribeck's curve with an exponent of its own. */
static void test_viscous(void) {
    struct friction f = make((scree_law_choice){"stribeck",
                                                6,
                                                {{"static", 0.6},
                                                 {"kinetic", 0.4},
                                                 {"stribeck_speed", 0.01},
                                                 {"threshold", 1e-4},
                                                 {"exponent", 0.8},
                                                 {"viscous", 3.0}}});
    for (double v = 2e-4; v < 1.0; v *= 1.7)
        NEAR(coefficient(&f, v), 0.4 + 0.2 * exp(-pow(v / 0.01, 0.8)) + 3.0 * v, 1e-14);
    f = make(
        (scree_law_choice){"simscape", 4, {{"static", 0.6}, {"kinetic", 0.4}, {"threshold", 1e-3}, {"viscous", 3.0}}});
    struct friction dry =
        make((scree_law_choice){"simscape", 3, {{"static", 0.6}, {"kinetic", 0.4}, {"threshold", 1e-3}}});
    for (double v = 1e-4; v < 1.0; v *= 1.7) NEAR(coefficient(&f, v) - coefficient(&dry, v), 3.0 * v, 1e-15);
}

/* ---- in the engine: a sphere on a plane, gravity tilted towards +x ---- */

struct slope_case {
    const char *friction, *rolling; /* tables as in a scene file; NULL: none */
    double angle;                   /* rad */
    int turns;                      /* a sphere that rolls; else a block, as it can't turn */
    double speed, spin[3];          /* at the start */
    double step;
};

enum { STIFFNESS = 1000000 };
static const double radius = 0.01, mass = 0.004;

/* It starts at the overlap that carries it, 4e-8 m: the lever of friction is shorter than the radius by 2e-6 of it. */
static scree_scene *on_slope(const struct slope_case *c) {
    char text[2048];
    double sine = sin(c->angle), cosine = cos(c->angle);
    snprintf(
        text, sizeof text,
        "gravity = [%.17g, 0, %.17g]\n[time]\nintegrator = \"verlet\"\nend = 100.0\nstep = %.17g\nspeed = "
        "0.01\n[output]\nwrite = "
        "[\"energy.csv\"]\n"
        "[[material]]\nname = \"ball\"\n[[material]]\nname = \"floor\"\n"
        "[[contact]]\nbetween = [\"ball\", \"floor\"]\nnormal = { law = \"linear\", stiffness = %d, damping = 30 }\n"
        "%s%s%s%s%s%s"
        "[[body]]\nname = \"floor\"\nshape = { plane = true }\nmaterial = \"floor\"\njoint = \"fixed\"\n"
        "[[body]]\nname = \"ball\"\nshape = { sphere = %.17g }\nmass = %.17g\nmaterial = \"ball\"\n"
        "position = [0, 0, %.17g]\nvelocity = [%.17g, 0, 0]\nspin = [%.17g, %.17g, %.17g]\n%s",
        g * sine, -g * cosine, c->step, STIFFNESS, c->friction ? "friction = { " : "", c->friction ? c->friction : "",
        c->friction ? " }\n" : "", c->rolling ? "rolling = { " : "", c->rolling ? c->rolling : "",
        c->rolling ? " }\n" : "", radius, mass, radius - mass * g * cosine / STIFFNESS, c->speed, c->spin[0],
        c->spin[1], c->spin[2], c->turns ? "" : "joint = { x = \"free\", z = \"free\", others = \"fixed\" }\n");
    return scene_from(text, NULL, 0, 0);
}

static double speed_after(scree_scene *scene, double time) {
    go(scene, lround(time / scree_scene_step_length(scene)));
    return state_of(scene, "ball").velocity[0];
}

/* The table's creep speeds, by inversion of the law and by simulation. */
static void test_creep(void) {
    static const struct {
        const char *column, *law;
        double speed, from; /* m/s: unit of the table, and where it counts from */
        scree_law_choice choice;
    } laws[] = {{"linear_ramp", "ramp", 1e-3, 0.0, {"ramp", 2, {{"kinetic", 0.4}, {"threshold", 1e-3}}}},
                {"tanh", "tanh", 1e-3, 0.0, {"tanh", 2, {{"kinetic", 0.4}, {"threshold", 1e-3}}}},
                {"cubic_step",
                 "step",
                 1e-3,
                 0.0,
                 {"step", 4, {{"static", 0.4}, {"kinetic", 0.4}, {"stiction_speed", 1e-3}, {"sliding_speed", 2e-3}}}},
                {"threlfall", "threlfall", 1e-3, 0.0, {"threlfall", 2, {{"kinetic", 0.4}, {"threshold", 1e-3}}}},
                {"bengisu_akay",
                 "bengisu-akay",
                 1e-3,
                 0.0,
                 {"bengisu-akay", 4, {{"static", 0.4}, {"kinetic", 0.3}, {"threshold", 1e-3}, {"fall", 100.0}}}},
                {"ambrosio_frac",
                 "ambrosio",
                 8e-4,
                 2e-4,
                 {"ambrosio", 3, {{"kinetic", 0.4}, {"tolerance", 2e-4}, {"threshold", 1e-3}}}},
                {"simscape_brk1.2",
                 "simscape",
                 1e-3,
                 0.0,
                 {"simscape", 3, {{"static", 0.48}, {"kinetic", 0.4}, {"threshold", 1e-3}}}}};
    struct check_table *table = check_read("friction_creep_on_incline.csv");
    for (size_t l = 0; l < sizeof laws / sizeof laws[0]; l++) {
        struct friction f = make(laws[l].choice);
        char choice[240];
        int used = snprintf(choice, sizeof choice, "law = \"%s\"", laws[l].choice.law);
        for (int k = 0; k < laws[l].choice.settings; k++)
            used += snprintf(choice + used, sizeof choice - (size_t)used, ", %s = %.17g",
                             laws[l].choice.setting[k].name, laws[l].choice.setting[k].value);
        for (int row = 0; row < table->rows; row++) {
            double r = check_number(table, row, "r");
            double creep = laws[l].from + laws[l].speed * check_number(table, row, laws[l].column);
            /* The coefficient is flat near its top: its rounding of 1e-16 counts for up to 1/(1 - r) = 100 times. */
            CLOSE(scree_creep_speed(f.law, &f.rule.friction_constants, 0.4 * r), creep, 1e-13);
            if (row % 3 || r > 0.9) continue;
            /* From rest the speed settles within some v_t/(mu g (1 - r)) = 3 ms; rounding of positions, 1e-16 R, makes
             * the normal force uncertain by 1e-16 R k of 0.04 N: 3e-11. */
            struct slope_case c = {.friction = choice, .angle = atan(0.4 * r), .step = 4e-6};
            scree_scene *scene = on_slope(&c);
            CLOSE(speed_after(scene, 0.2), creep, 1e-9);
            scree_scene_destroy(scene);
        }
    }
    free(table);
}

/* Laws that stick bring a load below the largest to rest, and the friction force is the load. */
static void test_rest(void) {
    static const char *const laws[] = {
        "law = \"coulomb\", static = 0.4, kinetic = 0.3, stiffness = 1e5, damping = 20",
        "law = \"mindlin\", static = 0.4, kinetic = 0.3, shear_modulus = 1e9, damping = 0.5",
        "law = \"mindlin-incremental\", static = 0.4, kinetic = 0.3, shear_modulus = 1e9, damping = 0.5",
        "law = \"mindlin-rescaled\", static = 0.4, kinetic = 0.3, shear_modulus = 1e9, damping = 0.5",
        "law = \"karnopp\", static = 0.4, kinetic = 0.3, band = 1e-3, stiffness = 1e5, damping = 20",
        "law = \"lugre\", static = 0.4, kinetic = 0.3, stribeck_speed = 1e-2, stiffness = 1e5, damping = 20",
        "law = \"elastoplastic\", static = 0.4, kinetic = 0.3, stribeck_speed = 1e-2, stiffness = 1e5, damping = 20"};
    for (size_t l = 0; l < sizeof laws / sizeof laws[0]; l++)
        for (double r = 0.1; r < 0.7; r += 0.25) {
            struct slope_case c = {.friction = laws[l], .angle = atan(0.4 * r), .step = 2e-6};
            scree_scene *scene = on_slope(&c);
            double speed = speed_after(scene, 0.2);
            scree_contact_state contact;
            int count;
            CHECK(scree_scene_contacts(scene, &contact, 1, &count) == SCREE_OK && count == 1);
            /* All have died out but rounding of positions, 1e-18 m a step of 2e-6 s. */
            NEAR(speed, 0.0, 1e-11);
            CLOSE(-contact.friction[0], mass * g * sin(c.angle), 1e-6);
            scree_energy energy;
            CHECK(scree_scene_energy(scene, &energy) == SCREE_OK);
            CHECK(energy.lost_tangential >= -1e-16);
            scree_scene_destroy(scene);
        }
}

/* ---- bristles ---- */

/* Drive a bristle law along x by steps of random length and speed; returns the force at the end of the way. */
static double drive(const struct friction *f, double normal, double way, double pace, uint64_t *seed,
                    struct scree_tangential *state) {
    double sign = way < 0.0 ? -1.0 : 1.0, left = fabs(way);
    while (left > 0.0) {
        double part = fmin(left, check_between(seed, 0.0, 1e-7)), speed = pace * check_between(seed, 0.5, 2.0);
        struct scree_sliding at = {.normal = normal, .half = 0.5 * part / speed, .stretch = state->stretch};
        at.velocity = vec(sign * speed, 0.0, 0.0);
        *state = act(f, no_pair, at);
        left -= part;
    }
    return -state->stretch.x;
}

/* Dahl's force depends on the way alone: loading, reversal, and the place where a load comes to rest. */
static void test_dahl(void) {
    struct friction f = make((scree_law_choice){"dahl", 2, {{"kinetic", 0.3}, {"stiffness", 1e5}}});
    double normal = 2.0, most = 0.6, scale = most / 1e5; /* N; m */
    uint64_t seed = 5;
    for (double r = 0.1; r < 0.99; r += 0.1) {
        struct scree_tangential state = {.sliding = 0.0};
        double stop = -scale * log(1.0 - r);
        /* A few hundred steps of rounding each. */
        double there = drive(&f, normal, stop, 0.3, &seed, &state);
        CLOSE(-1e5 * there, r * most, 1e-13);
        double back = drive(&f, normal, -2.0 * stop, 1e-3, &seed, &state);
        NEAR(-1e5 * back, most * (-1.0 + (1.0 + r) * exp(-2.0 * stop / scale)), 1e-13);
    }
}

/* Slow presliding of lugre is Dahl's with mu_s; of elastoplastic a spring up to its elastic range. */
static void test_presliding(void) {
    scree_setting settings[] = {{"static", 0.4}, {"kinetic", 0.3}, {"stribeck_speed", 1.0}, {"stiffness", 1e5}};
    scree_law_choice choice = {.law = "lugre", .settings = 4};
    memcpy(choice.setting, settings, sizeof settings);
    struct friction lugre = make(choice);
    choice.law = "elastoplastic";
    struct friction plastic = make(choice);
    uint64_t seed = 6;
    for (double way = 1e-6; way < 3e-5; way *= 1.5) {
        struct scree_tangential state = {.sliding = 0.0};
        /* At 1e-6 of Stribeck's speed the curve is at mu_s to 1e-12. */
        double there = drive(&lugre, 2.0, way, 1e-6, &seed, &state);
        CLOSE(-there, 8e-6 * (1.0 - exp(-way / 8e-6)), 1e-11);
        if (way > 0.7 * 6e-6) continue;
        state = (struct scree_tangential){.sliding = 0.0};
        there = drive(&plastic, 2.0, way, 1e-6, &seed, &state);
        double back = drive(&plastic, 2.0, -way, 1e-6, &seed, &state);
        CLOSE(-there, way, 1e-14);
        NEAR(back, 0.0, 1e-19);
    }
    /* Steady sliding is on Stribeck's curve. */
    for (double v = 1e-2; v < 10.0; v *= 2.0) {
        struct scree_tangential a = {.sliding = 0.0}, b = {.sliding = 0.0};
        double curve = 2.0 * (0.3 + 0.1 * exp(-v * v));
        for (int k = 0; k < 20000; k++) {
            struct scree_sliding at = {.normal = 2.0, .half = 1e-8 / v, .velocity = {0.0, v, 0.0}};
            at.stretch = a.stretch;
            a = act(&lugre, no_pair, at);
            at.stretch = b.stretch;
            b = act(&plastic, no_pair, at);
        }
        /* 20000 x 2e-8 m are 50 lengths g/s_0: nothing is left of the start. */
        CLOSE(-a.force.y, curve, 1e-13);
        CLOSE(-b.force.y, curve, 1e-13);
    }
}

/* A block under a load that vibrates below breakaway: how far it moves during the last 10 of 20 cycles, m. */
static double drift(const struct friction *f) {
    const double h = 2e-6, cycle = 0.01;
    double x = 0.0, v = 0.0, before = 0.0;
    struct vec stretch = {0.0, 0.0, 0.0};
    long steps = lround(cycle / h);
    for (long n = 0; n < 20 * steps; n++) {
        if (n == 10 * steps) before = x;
        double load = 0.6 * (0.3 + 0.25 * sin(2.0 * 3.14159265358979323846 * (double)n * h / cycle));
        struct scree_sliding at = {.normal = 2.0, .half = 0.5 * h, .velocity = {v, 0.0, 0.0}, .stretch = stretch};
        struct scree_tangential t = act(f, no_pair, at);
        stretch = t.stretch;
        x += h * v;
        v += h * (load + t.force.x) / 0.01;
    }
    return x - before;
}

static void test_drift(void) {
    scree_setting settings[] = {
        {"static", 0.4}, {"kinetic", 0.3}, {"stribeck_speed", 1e-2}, {"stiffness", 1e5}, {"damping", 30.0}};
    scree_law_choice choice = {.law = "lugre", .settings = 5};
    memcpy(choice.setting, settings, sizeof settings);
    struct friction lugre = make(choice);
    choice.law = "elastoplastic";
    struct friction plastic = make(choice);
    /* Bristles bend by 6e-6 m. lugre ratchets by a part of that per cycle; the load stays within the elastic range. */
    CHECK(drift(&lugre) > 1e-6);
    NEAR(drift(&plastic), 0.0, 1e-12);
}

/* ---- energy ---- */

/* Whatever the state, a step takes energy out at constant overlap, in any direction. Bristles without exception; a
 * slider unless the ball already moves along the force on it (the step in which the slip turns round), and when it
 * sticks again it gives back what sliding took too much, half a step's growth of the stretch (slider.h). */
static void test_takes_energy(void) {
    uint64_t seed = 12;
    for (int l = 0; scree_friction_laws[l]; l++) {
        struct friction f = make(scree_example(&scree_friction_laws[l]->text));
        const struct scree_law_constants *constants = &f.rule.friction_constants;
        struct scree_pair_constants pair = no_pair;
        if (f.law->pair) pair = f.law->pair(constants, 0.02, 0.01);
        int bristle = strcmp(f.law->text.name, "dahl") == 0 || strcmp(f.law->text.name, "lugre") == 0 ||
                      strcmp(f.law->text.name, "elastoplastic") == 0;
        struct scree_tangential kept = {.sliding = 0.0};
        double total = 0.0;
        for (int trial = 0; trial < 20000; trial++) {
            /* A walk: the state goes on, the load and the velocity jump. Now and then it starts anew. */
            if (trial % 50 == 0) kept = (struct scree_tangential){.sliding = 0.0};
            double pace = pow(10.0, check_between(&seed, -5.0, 1.0));
            struct scree_sliding at = {.normal = check_between(&seed, -2.0, 10.0), .overlap = 1e-5};
            at.normal = at.normal > 0.0 ? at.normal : 0.0;
            at.half = 0.5e-7 * pow(10.0, check_between(&seed, 0.0, 4.0));
            double across[3] = {0.0};
            check_draw(&seed, -pace, pace, 2, across);
            at.velocity = vec_from(across);
            at.stretch = kept.stretch;
            at.sliding = kept.sliding;
            kept = act(&f, pair, at);
            double work = -2.0 * at.half * vec_dot(kept.force, at.velocity);
            double before = f.law->stored(constants, pair, at);
            struct scree_sliding after = at;
            after.stretch = kept.stretch;
            double stored = f.law->stored(constants, pair, after) - before;
            if (!bristle && work < 0.0) continue;
            total += work - stored;
            double owed = 0.0;
            if (f.law->hold && at.sliding > 0.0 && !(kept.sliding > 0.0))
                owed = at.half * f.law->stiffness(constants, pair, at.overlap) *
                       (fmax(vec_dot(at.stretch, at.velocity), 0.0) + 0.5 * at.half * vec_norm2(at.velocity));
            CHECK(work - stored >= -1e-14 * (fabs(work) + before) - owed); /* rounding */
            /* Static friction is the most that anything holds; the viscous parts and the dashpots come on top. */
            if (at.normal == 0.0) CHECK(vec_norm(kept.force) == 0.0);
        }
        CHECK(total > 1e-3);
    }
}

/* Impulse of friction over a second, N s, of a contact whose load swells and falls while it is dragged about, so that
 * it sticks and slides; `turns`: and so that the slip turns. */
static struct vec drag_about(const struct friction *f, int turns, int steps) {
    struct scree_pair_constants pair = no_pair;
    struct scree_tangential kept = {.sliding = 0.0};
    struct vec impulse = {0.0, 0.0, 0.0};
    double h = 1.0 / steps;
    for (int n = 0; n < steps; n++) {
        double t = 6.283185307179586 * (n + 0.5) * h;
        struct scree_sliding at = {.normal = 5.0 * (1.0 + 0.8 * sin(t)), .overlap = 1e-5, .half = 0.5 * h};
        at.velocity = vec(0.02 * cos(1.3 * t), 0.0, turns ? 0.01 * sin(0.7 * t) : 0.0);
        at.stretch = kept.stretch;
        at.sliding = kept.sliding;
        kept = act(f, pair, at);
        impulse = vec_axpy(impulse, h, kept.force);
    }
    return impulse;
}

/* What a slider does in a step, as slider.h's header says it: D = G + p h k/2 with G = c + h k/2, p = (h k/2)/G. One
 * quotient serves for several, and a bare spring takes none: a handful of roundings apart. */
static void test_slider_of(void) {
    static const double dampings[] = {0.0, 1e-60, 1e-3, 0.5, 3.0, 1e9};
    const double roundings = 8 * 0x1p-53;
    for (int k = 0; k < 6 * 2 * 3; k++) {
        double c = dampings[k % 6], stiffness = 5e4 * (1 + k / 12), half = 1e-5 / (1 + k / 12), step = 2.0 * half;
        struct scree_sliding at = {.half = half, .sliding = k / 6 % 2, .apart = k / 12 == 1 ? 0.3 : 0.0};
        double stiff = half * stiffness, first = c * (1.0 - at.apart) + stiff, p = stiff / first, D = first + stiff * p;
        for (at.bare = 0; at.bare <= (c == 0.0); at.bare++) {
            struct scree_slider slider = scree_slider_of(at, stiffness, c, (struct scree_hold){0.4, 0.3});
            int slid = at.sliding > 0.0;
            NEAR(slider.drag / (slid ? D : first), 1.0, roundings);
            NEAR(slider.gone / (step * stiffness / D), 1.0, roundings);
            NEAR(slider.goes / (slid ? step : step * first / D), 1.0, roundings);
            NEAR(slider.stays / (slid ? step + half * p : step), 1.0, roundings);
            CHECK(slider.k == stiffness && slider.bears.holds == 0.4 && slider.bears.slides == 0.3);
        }
    }
}

/* Under Verlet's mid-step rule a slider errs by the second order of the step, whatever the dashpot: in what it does
 * while it slides, and in the stretch with which it sticks again; if the slip turns, where the dashpot's time c/k is no
 * shorter than the step (else the force turns towards the slip by an implicit step, of first order while it catches
 * up). Mean errors of n … n + 7 steps, as where in a step the slider breaks loose is a matter of chance. */
static void test_slider_order(void) {
    static const struct {
        double damping;
        int turns;
    } cases[] = {{0.0, 0}, {0.5, 0}, {5.0, 0}, {50.0, 0}, {5.0, 1}, {50.0, 1}};
    for (size_t c = 0; c < sizeof cases / sizeof cases[0]; c++) {
        struct friction f = make((scree_law_choice){
            "coulomb", 4, {{"static", 0.4}, {"kinetic", 0.4}, {"stiffness", 2e3}, {"damping", cases[c].damping}}});
        struct vec fine = drag_about(&f, cases[c].turns, 200000);
        double error[2] = {0.0, 0.0};
        for (int finer = 0; finer < 2; finer++)
            for (int n = 0; n < 8; n++)
                error[finer] +=
                    0.125 * vec_norm(vec_sub(drag_about(&f, cases[c].turns, (1000 << 3 * finer) + n), fine));
        double order = log2(error[0] / error[1]) / 3.0;
        if (getenv("SCREE_SHOW"))
            printf("slider %g %d: %.2e %.2e, order %.2f\n", cases[c].damping, cases[c].turns, error[0], error[1],
                   order);
        CHECK(order > 1.8);
    }
}

/* The same of bristles, which are cut in the middle of the step to what the load bears as it falls, and turn as those
 * do that are short enough all along (what is too long by the fall in a step turns too slowly: of first order). */
static void test_bristle_order(void) {
    static const char *const laws[] = {"dahl", "lugre", "elastoplastic"};
    for (int k = 0; k < 6; k++) {
        scree_law_choice choice = {laws[k / 2], 2, {{"kinetic", 0.3}, {"stiffness", 2e3}}};
        if (k / 2 > 0) {
            const scree_setting more[] = {{"static", 0.4}, {"stribeck_speed", 0.02}, {"damping", 2.0}};
            memcpy(choice.setting + 2, more, sizeof more);
            choice.settings = 5;
        }
        struct friction f = make(choice);
        struct vec fine = drag_about(&f, k % 2, 200000);
        double error[2] = {0.0, 0.0};
        for (int finer = 0; finer < 2; finer++)
            for (int n = 0; n < 8; n++)
                error[finer] += 0.125 * vec_norm(vec_sub(drag_about(&f, k % 2, (1000 << 3 * finer) + n), fine));
        double order = log2(error[0] / error[1]) / 3.0;
        if (getenv("SCREE_SHOW"))
            printf("%s %d: %.2e %.2e, order %.2f\n", laws[k / 2], k % 2, error[0], error[1], order);
        CHECK(order > 1.8);
    }
}

/* A contact with Mindlin's stiffness sheared to and fro at constant load: k_t x while it sticks, and 4 mu N (A - mu
 * N/k_t) J lost per cycle once it slides. */
static void test_mindlin_cycles(void) {
    static const char *const names[] = {"mindlin", "mindlin-incremental", "mindlin-rescaled"};
    const double shear = 1e9, lever = 0.01, overlap = 4e-6, normal = 2.0, mu = 0.3;
    double k = 8.0 * shear * sqrt(lever * overlap), amplitude = 2.5 * mu * normal / k;
    for (int n = 0; n < 3; n++) {
        struct friction f =
            make((scree_law_choice){names[n], 3, {{"static", mu}, {"kinetic", mu}, {"shear_modulus", shear}}});
        struct scree_pair_constants pair = f.law->pair(&f.rule.friction_constants, 0.02, lever);
        CLOSE(f.law->stiffness(&f.rule.friction_constants, pair, overlap), k, 1e-15);
        struct scree_tangential state = {.sliding = 0.0};
        const int steps = 8000; /* in a cycle */
        double lost[2] = {0.0}, h = 1e-6, x = 0.0;
        for (int s = 0; s < 2 * steps + steps / 4; s++) { /* a quarter to start with */
            double next = amplitude * sin(2.0 * 3.14159265358979323846 * (s + 1) / steps);
            struct scree_sliding at = {.normal = normal, .overlap = overlap, .half = 0.5 * h};
            at.velocity = vec((next - x) / h, 0.0, 0.0);
            at.stretch = state.stretch;
            at.sliding = state.sliding;
            state = act(&f, pair, at);
            if (s < steps / 4 && !(state.sliding > 0.0)) /* the force is that of the middle of the step */
                CLOSE(-state.force.x, k * 0.5 * (x + next), 1e-12);
            if (s >= steps / 4) lost[(s - steps / 4) / steps] -= h * state.force.x * at.velocity.x;
            x = next;
        }
        /* The border between sticking and sliding falls somewhere in a step, which is 1e-3 of the way at most: its
         * square. */
        CLOSE(lost[0], 4.0 * mu * normal * (amplitude - mu * normal / k), 1e-5);
        CLOSE(lost[1], 4.0 * mu * normal * (amplitude - mu * normal / k), 1e-5);
    }
}

/* Stretch x at overlap 4d, then the load falls to overlap d: the force falls by half with the memory in the stretch,
 * and stays with it in the force. Going back by x, the second leaves k(d) x - k(4d) x, and so has given more than was
 * put in: k(4d) x^2/2 - k(d) x^2/2. */
static void test_mindlin_memories(void) {
    static const char *const names[] = {"mindlin", "mindlin-incremental"};
    const double shear = 1e9, overlap = 1e-6, x = 1e-8, h = 1e-6;
    for (int n = 0; n < 2; n++) {
        struct friction f =
            make((scree_law_choice){names[n], 3, {{"static", 10.0}, {"kinetic", 10.0}, {"shear_modulus", shear}}});
        struct scree_pair_constants pair = f.law->pair(&f.rule.friction_constants, 0.02, 0.01);
        double k = 8.0 * shear * sqrt(0.01 * overlap), work = 0.0;
        struct scree_sliding at = {.normal = 10.0, .overlap = 4.0 * overlap, .half = 0.5 * h};
        at.velocity = vec(0.0, x / h, 0.0);
        struct scree_tangential t = act(&f, pair, at);
        CLOSE(-t.force.y, k * x, 1e-14); /* half the stretch at twice the stiffness */
        work -= t.force.y * x;
        at = (struct scree_sliding){.normal = 10.0, .overlap = overlap, .stretch = t.stretch};
        t = act(&f, pair, at);
        CLOSE(-t.force.y, n == 0 ? k * x : 2.0 * k * x, 1e-14);
        at.half = 0.5 * h;
        at.velocity = vec(0.0, -x / h, 0.0);
        t = act(&f, pair, at);
        work += t.force.y * x;
        at = (struct scree_sliding){.normal = 10.0, .overlap = overlap, .stretch = t.stretch};
        NEAR(-act(&f, pair, at).force.y, n == 0 ? 0.0 : k * x, 1e-13 * k * x);
        CLOSE(work, n == 0 ? 0.5 * k * x * x : -0.5 * k * x * x, 1e-13);
    }
}

/* The same way with the force rescaled while the load falls, in steps: stretched by x at overlap d, pressed to 4d (the
 * force stays), released to d (it falls to half of that), and back to where no force is left, x/2: (1 - 1/4) k x^2/2
 * are lost. In steps of half a step's growth each, the shares of a way multiply up to the whole, so rounding is all
 * that is left. */
static void test_mindlin_rescaled(void) {
    const double shear = 1e9, overlap = 1e-6, x = 1e-8, h = 1e-6;
    const int steps = 1000;
    struct friction f = make(
        (scree_law_choice){"mindlin-rescaled", 3, {{"static", 10.0}, {"kinetic", 10.0}, {"shear_modulus", shear}}});
    struct scree_pair_constants pair = f.law->pair(&f.rule.friction_constants, 0.02, 0.01);
    double k = 8.0 * shear * sqrt(0.01 * overlap), work = 0.0;
    struct scree_sliding at = {.normal = 10.0, .overlap = overlap, .half = 0.5 * h};
    at.velocity = vec(0.0, x / h, 0.0);
    struct scree_tangential t = act(&f, pair, at);
    work -= t.force.y * x;
    for (int fall = 0; fall < 2; fall++) {
        double growth = (fall ? -3.0 : 3.0) * overlap / steps;
        at = (struct scree_sliding){.normal = 10.0, .half = 0.5 * h, .closing = growth / h};
        for (int s = 0; s < steps; s++) {
            at.overlap = (fall ? 4.0 : 1.0) * overlap + ((double)s + 0.5) * growth;
            at.stretch = t.stretch;
            t = act(&f, pair, at);
        }
        at = (struct scree_sliding){.normal = 10.0, .overlap = fall ? overlap : 4.0 * overlap, .stretch = t.stretch};
        CLOSE(-act(&f, pair, at).force.y, fall ? 0.5 * k * x : k * x, 1e-12);
    }
    at = (struct scree_sliding){.normal = 10.0, .overlap = overlap, .half = 0.5 * h, .stretch = t.stretch};
    at.velocity = vec(0.0, -0.5 * x / h, 0.0);
    t = act(&f, pair, at);
    work += t.force.y * 0.5 * x;
    NEAR(t.stretch.y, 0.0, 1e-12 * k * x);
    CLOSE(work, 0.75 * 0.5 * k * x * x, 1e-12);
}

/* ---- slopes ---- */

/* Acceleration along the slope, m/s^2, and of R w, once what the start set off has died out. */
static void accelerations(const struct slope_case *c, double from, double to, double *along, double *turning) {
    scree_scene *scene = on_slope(c);
    speed_after(scene, from);
    scree_body_state first = state_of(scene, "ball");
    speed_after(scene, to - from);
    scree_body_state last = state_of(scene, "ball");
    *along = (last.velocity[0] - first.velocity[0]) / (to - from);
    *turning = radius * (last.spin[1] - first.spin[1]) / (to - from);
    scree_scene_destroy(scene);
}

static void test_inclines(void) {
    static const char *const laws[] = {
        "law = \"coulomb\", static = %g, kinetic = %g, stiffness = 1e6, damping = 60",
        "law = \"karnopp\", static = %g, kinetic = %g, band = 1e-3, stiffness = 1e6, damping = 60",
        "law = \"mindlin\", static = %g, kinetic = %g, shear_modulus = 6e9, damping = 0.5",
        "law = \"lugre\", static = %g, kinetic = %g, stribeck_speed = 1.0, stiffness = 1e6, damping = 60"};
    struct check_table *table = check_read("incline_block_and_sphere.csv");
    for (int row = 0; row < table->rows; row++)
        for (size_t l = 0; l < sizeof laws / sizeof laws[0]; l++) {
            double mu = check_number(table, row, "mu"), along, turning;
            double degree = 3.14159265358979323846 / 180.0;
            char law[160];
            snprintf(law, sizeof law, laws[l], mu, mu);
            struct slope_case c = {
                .friction = law, .angle = check_number(table, row, "alpha_deg") * degree, .step = 5e-6};
            accelerations(&c, 0.01, 0.03, &along, &turning);
            /* A block: friction is mu N to rounding, where it slides; rest to what is left of the start, e^-75 of
             * it. */
            NEAR(along, check_number(table, row, "a_block"), 1e-8);
            c.turns = 1;
            accelerations(&c, 0.01, 0.03, &along, &turning);
            /* A sphere: its lever is shorter by the overlap of 4e-8 m, 4e-6 of R. */
            NEAR(along, check_number(table, row, "a_sphere"), 2e-5);
            NEAR(turning, check_number(table, row, "R_domega_dt"), 2e-5);
        }
    free(table);
}

/* ---- rolling ---- */

static const char no_slip[] = "law = \"coulomb\", static = 0.8, kinetic = 0.8, stiffness = 1e6, damping = 60";

static void test_rolling_on_flat(void) {
    static const char *const laws[] = {"law = \"constant\", rolling = %g",
                                       "law = \"spring-dashpot\", rolling = %g, stiffness = 1e5, damping = 10"};
    struct check_table *table = check_read("rolling_resistance_flat.csv");
    for (int row = 0; row < table->rows; row++)
        for (int l = 0; l < 2; l++) {
            char law[120];
            double v0 = check_number(table, row, "v0"), stop = check_number(table, row, "stop_time"), along, turning;
            snprintf(law, sizeof law, laws[l], check_number(table, row, "mu_r"));
            struct slope_case c = {.friction = no_slip, .rolling = law, .turns = 1, .speed = v0, .step = 5e-6};
            c.spin[1] = v0 / radius;
            accelerations(&c, 0.02, 0.06, &along, &turning);
            /* The lever is shorter than R by 2e-6 of it; the rolling spring and the spring of friction take 1e-8 m to
             * stretch. */
            CLOSE(-along, check_number(table, row, "deceleration"), 2e-5);
            CLOSE(-turning, check_number(table, row, "deceleration"), 2e-5);
            if (stop > 0.8) continue;
            scree_scene *scene = on_slope(&c);
            go(scene, lround(stop / c.step));
            CLOSE(state_of(scene, "ball").position[0], check_number(table, row, "stop_distance"), 3e-5);
            /* Then it swings on the springs until that has died out, or chatters by M h/I, 5/2 mu_r g h of R w. */
            NEAR(speed_after(scene, 0.05), 0.0, l == 0 ? 2.5 * 0.2 * g * c.step : 1e-9);
            scree_scene_destroy(scene);
        }
    free(table);
}

/* On a slope the rolling spring holds up to tan(angle) = mu_r, and beyond that a = 5/7 g (sin - mu_r cos). */
static void test_rolling_on_slope(void) {
    static const char law[] = "law = \"spring-dashpot\", rolling = 0.1, stiffness = 1e5, damping = 10";
    for (double tangent = 0.02; tangent < 0.2; tangent += 0.03) {
        double along, turning, angle = atan(tangent);
        struct slope_case c = {.friction = no_slip, .rolling = law, .turns = 1, .angle = angle, .step = 5e-6};
        accelerations(&c, 0.05, 0.1, &along, &turning);
        double expected = tangent <= 0.1 ? 0.0 : 5.0 / 7.0 * g * (sin(angle) - 0.1 * cos(angle));
        NEAR(along, expected, tangent <= 0.1 ? 1e-8 : 2e-5); /* the lever again */
    }
    /* Viscous: v = tan(angle)/eta_r, reached within 7/5 /(eta_r g) = 7 ms. */
    struct slope_case c = {.friction = no_slip,
                           .rolling = "law = \"viscous\", rolling = 20",
                           .turns = 1,
                           .angle = atan(0.05),
                           .step = 5e-6};
    scree_scene *scene = on_slope(&c);
    CLOSE(speed_after(scene, 0.3), 0.05 / 20.0, 2e-5);
    scree_scene_destroy(scene);
}

/* A sphere that spins about the vertical: the coefficient of twisting stops it, at 5/2 mu_t g/R; the books balance. */
static void test_twisting(void) {
    static const char *const laws[] = {
        "law = \"constant\", rolling = 0.05, twisting = 0.02, threshold = 1e-4",
        "law = \"spring-dashpot\", rolling = 0.05, twisting = 0.02, stiffness = 1e5, damping = 10"};
    for (int l = 0; l < 2; l++) {
        struct slope_case c = {
            .friction = no_slip, .rolling = laws[l], .turns = 1, .spin = {0.0, 0.0, 20.0}, .step = 5e-6};
        scree_scene *scene = on_slope(&c);
        go(scene, 4000);
        double before = state_of(scene, "ball").spin[2];
        go(scene, 10000);
        scree_contact_state contact;
        int count;
        CHECK(scree_scene_contacts(scene, &contact, 1, &count) == SCREE_OK && count == 1);
        CLOSE(-contact.rolling[2], 0.02 * radius * mass * g, 1e-9);
        CLOSE((before - state_of(scene, "ball").spin[2]) / 0.05, 2.5 * 0.02 * g / radius, 1e-9);
        go(scene, 100000); /* 20 rad/s last 0.41 s */
        NEAR(state_of(scene, "ball").spin[2], 0.0, 1e-4);
        scree_energy energy;
        CHECK(scree_scene_energy(scene, &energy) == SCREE_OK);
        CLOSE(energy.lost_tangential, 0.5 * 0.4 * mass * radius * radius * 400.0, 1e-4); /* h M/(I w) of the end */
        NEAR(energy.balance, 0.0, 1e-4 * energy.lost_tangential);
        scree_scene_destroy(scene);
    }
}

/* ---- a mass on a belt ---- */

struct cycle {
    double period, highest, lowest, slowest; /* s, m, m, m/s */
};

/* The textbook's oscillator, stepped as the engine steps: forces in the middle of a step, from a velocity predicted
 * with the forces of the step before. The last but one of five cycles. */
static struct cycle belt_cycle(const struct friction *f, const struct check_table *table, int row, double step) {
    double k = check_number(table, row, "k"), m = check_number(table, row, "m"), belt = check_number(table, row, "V");
    double x = check_number(table, row, "x_restick"), v = belt, acceleration = 0.0, begun = 0.0;
    struct scree_tangential kept = {.sliding = 0.0};
    struct cycle cycle = {0.0, 0.0, 0.0, 0.0};
    int slips = 0, was_sliding = 0;
    for (long n = 0; slips < 5; n++) {
        double v_middle = v + 0.5 * step * acceleration, x_middle = x + 0.5 * step * v;
        struct scree_sliding at = {.normal = check_number(table, row, "N"), .half = 0.5 * step};
        at.velocity = vec(v_middle - belt, 0.0, 0.0);
        at.stretch = kept.stretch;
        at.sliding = kept.sliding;
        kept = act(f, no_pair, at);
        acceleration = (kept.force.x - k * x_middle) / m;
        v += step * acceleration;
        x = x_middle + 0.5 * step * v;
        int sliding = v < 0.5 * belt; /* well into slip, whatever the swing of the stick's spring */
        if (sliding && !was_sliding) {
            slips++;
            if (slips == 3) begun = (double)n * step;
            if (slips == 4) cycle.period = (double)n * step - begun;
            if (slips == 3) cycle.highest = cycle.lowest = x, cycle.slowest = v;
        }
        was_sliding = sliding;
        cycle.highest = slips == 3 ? scree_most(cycle.highest, x) : cycle.highest;
        cycle.lowest = slips == 3 ? scree_least(cycle.lowest, x) : cycle.lowest;
        cycle.slowest = slips == 3 ? scree_least(cycle.slowest, v) : cycle.slowest;
    }
    return cycle;
}

static double belt_error(const struct check_table *table, int row, double ratio, double step) {
    double k = check_number(table, row, "k"), m = check_number(table, row, "m");
    struct friction f = make((scree_law_choice){"coulomb",
                                                4,
                                                {{"static", check_number(table, row, "mu_s")},
                                                 {"kinetic", check_number(table, row, "mu_k")},
                                                 {"stiffness", ratio * k},
                                                 {"damping", sqrt(ratio * k * m)}}});
    struct cycle c = belt_cycle(&f, table, row, step / sqrt(ratio));
    double size = check_number(table, row, "x_slip_start"), speed = size * sqrt(k / m);
    double error = fabs(c.period / check_number(table, row, "period") - 1.0);
    error = scree_most(error, fabs(c.highest - check_number(table, row, "x_max")) / size);
    error = scree_most(error, fabs(c.lowest - check_number(table, row, "x_min")) / size);
    return scree_most(error, fabs(c.slowest - check_number(table, row, "v_min")) / speed);
}

/* The spring that holds bends by k/k_t of the way, at 1e3, 1e4 and 1e5: a few times that is the error, and the step,
 * which goes with its root, adds its square. */
static void test_belt(void) {
    struct check_table *table = check_read("stick_slip_oscillator.csv");
    for (int row = 0; row < table->rows; row++) {
        double step = 0.02 / sqrt(check_number(table, row, "k") / check_number(table, row, "m")), error[3];
        for (int n = 0; n < 3; n++) error[n] = belt_error(table, row, 1e3 * pow(10.0, n), step);
        for (int n = 0; n < 3; n++) NEAR(error[n], 0.0, 3e-3 * pow(10.0, -n));
    }
    free(table);
}

/* ---- oblique impacts ---- */

/* A sphere meets a plane at 1 m/s across it, without gravity. */
struct oblique {
    const char *normal, *friction;
    double tangent, mass, step, gap; /* of the velocities; kg; s; m before they touch */
};

static scree_body_state rebound(const struct oblique *c) {
    char text[1024];
    snprintf(text, sizeof text,
             "[time]\nintegrator = \"verlet\"\nend = 1.0\nstep = %.17g\nforce = true\n[[material]]\nname = \"m\"\n"
             "[[contact]]\nbetween = [\"m\", \"m\"]\nnormal = { %s }\nfriction = { %s }\n"
             "[[body]]\nname = \"floor\"\nshape = { plane = true }\nmaterial = \"m\"\njoint = \"fixed\"\n"
             "[[body]]\nname = \"ball\"\nshape = { sphere = %.17g }\nmass = %.17g\nmaterial = \"m\"\n"
             "position = [0, 0, %.17g]\nvelocity = [%.17g, 0, -1]\n",
             c->step, c->normal, c->friction, radius, c->mass, radius + c->gap, c->tangent);
    scree_scene *scene = scene_from(text, NULL, 0, 0);
    go(scene, (int)ceil(c->gap / c->step) + 1);
    for (int count = 1, n = 0; count && n < 1000000; n++) {
        go(scene, 1);
        CHECK(scree_scene_contacts(scene, NULL, 0, &count) == SCREE_OK);
    }
    scree_body_state state = state_of(scene, "ball");
    scree_scene_destroy(scene);
    return state;
}

/* Walton's rigid rule where the contact slides throughout: whatever the normal law. */
static void test_walton(void) {
    struct check_table *table = check_read("walton_rigid_sliding.csv");
    static const double stiffness = 1e13; /* overlap 2e-8 m: the lever is R to 1e-6 */
    double duration = 3.14159265358979323846 * sqrt(mass / stiffness), worst[2][3] = {{0.0}};
    int slid = 0;
    for (int row = 0; row < table->rows; row++) {
        if (strcmp(check_text(table, row, "regime"), "slide") != 0) continue; /* a soft contact never only rolls */
        double mu = check_number(table, row, "mu"), e = check_number(table, row, "e_n");
        double tangent = tan(check_number(table, row, "angle_deg") * 3.14159265358979323846 / 180.0);
        char normal[120], friction[2][160];
        snprintf(normal, sizeof normal, "law = \"linear-cut\", stiffness = %.17g, restitution = %.17g", stiffness, e);
        snprintf(friction[0], sizeof friction[0], "law = \"ramp\", kinetic = %.17g, threshold = 1e-9", mu);
        snprintf(friction[1], sizeof friction[1],
                 "law = \"coulomb\", static = %.17g, kinetic = %.17g, stiffness = %.17g", mu, mu, stiffness);
        slid++;
        /* A dashpot's force jumps at the first touch, faster than any spring can follow: elastic impacts only for
         * coulomb. */
        for (int l = 0; l < (e == 1.0 ? 2 : 1); l++)
            for (int n = 0; n < 3; n++) {
                struct oblique c = {normal, friction[l], tangent, mass, duration / (100 << (2 * n)), 0.0};
                scree_body_state after = rebound(&c);
                double e_t = after.velocity[0] / tangent, spin = radius * after.spin[1];
                double recoil = (after.velocity[0] - spin) / after.velocity[2];
                double error = fabs(e_t - check_number(table, row, "e_t"));
                error = scree_most(error, fabs(spin - check_number(table, row, "R_omega_over_vn")));
                error = scree_most(error, fabs(recoil - check_number(table, row, "recoil_tan")));
                worst[l][n] = scree_most(worst[l][n], error);
            }
    }
    CHECK(slid > 15);
    for (int n = 0; n < 3; n++) {
        /* Friction is mu times the normal force to rounding, so the error is that of the restitution: of second order.
         * The lever is left. */
        NEAR(worst[0][n], 0.0, 0.012 * pow(16.0, -n) + 2e-6);
        NEAR(worst[1][n], 0.0, 2e-6);
    }
    free(table);
}

/* Hertz's elastic contact with both of Mindlin's no-slip laws, against the solution to 40 digits. */
static void test_oblique_mindlin(void) {
    struct check_table *table = check_read("oblique_hertz_mindlin_noslip.csv");
    const double hertz = 5e17; /* N/m^1.5: overlap 1e-8 m, the lever is R to 5e-7 */
    double deepest = pow(1.25 * mass / hertz, 0.4), worst[2][3] = {{0.0}};
    int rows = 0;
    for (int row = 0; row < table->rows; row++) {
        if (check_number(table, row, "e_n") != 1.0) continue;
        int memory_in_force = strcmp(check_text(table, row, "form"), "inc") == 0;
        double mu = check_number(table, row, "mu"), tangent = check_number(table, row, "vs0_over_vn");
        double shear = check_number(table, row, "kappa") * hertz / (8.0 * sqrt(radius));
        char normal[120], friction[160];
        snprintf(normal, sizeof normal, "law = \"hunt-crossley\", stiffness = %.17g, factor = 0", hertz);
        snprintf(friction, sizeof friction,
                 "law = \"mindlin%s\", static = %.17g, kinetic = %.17g, shear_modulus = %.17g",
                 memory_in_force ? "-incremental" : "", mu, mu, shear);
        for (int n = 0; n < 3; n++) {
            struct oblique c = {normal, friction, tangent, mass, 2.94 * deepest / (100 << (2 * n)), 0.0};
            scree_body_state after = rebound(&c);
            double slip = after.velocity[0] - radius * after.spin[1];
            double error = fabs(slip - check_number(table, row, "vs_rebound_over_vn"));
            worst[memory_in_force][n] = scree_most(worst[memory_in_force][n], error / fmax(1.0, tangent));
        }
        rows++;
    }
    CHECK(rows > 100);
    /* At 100, 400 and 1600 steps: where a slide ends inside a step, its stretch is off by part of that step; of first
     * order. */
    for (int l = 0; l < 2; l++)
        for (int n = 0; n < 3; n++) NEAR(worst[l][n], 0.0, 0.008 * pow(4.0, -n));
    free(table);
}

/* Wherever in a step contact begins, the slider's spring is stretched from there on, though a dashpot has slowed the
 * ball down before the middle of the next step: of second order. Normal forces err by 0.2 (w h)^2 where they begin and
 * end, w = pi over the contact's duration; by as much friction does, whose load that is. */
static void test_touch_anywhere(void) {
    enum { PHASES = 256 };
    static const char normal[] = "law = \"linear-cut\", stiffness = 1e9, restitution = 0.5";
    static const char friction[] = "law = \"coulomb\", static = 0.4, kinetic = 0.4, stiffness = 3e8";
    double duration = 3.14159265358979323846 * sqrt(mass / 1e9);
    struct oblique c = {normal, friction, 0.5, mass, duration / 12800, 0.0};
    double fine = rebound(&c).velocity[0];
    for (int finer = 0; finer < 2; finer++) {
        double worst = 0.0, part = 3.14159265358979323846 / (50 << (2 * finer));
        c.step = duration / (50 << (2 * finer));
        for (int phase = 0; phase < PHASES; phase++) {
            c.gap = c.step * phase / PHASES;
            worst = scree_most(worst, fabs(rebound(&c).velocity[0] - fine));
        }
        if (getenv("SCREE_SHOW")) printf("touch anywhere %g of %g\n", worst, 0.4 * part * part * (c.tangent - fine));
        NEAR(worst, 0.0, 0.4 * part * part * (c.tangent - fine));
    }
}

/* ---- stability ---- */

/* At nine tenths of the limit that the laws' slope, stiffness and damping give, a pushed ball doesn't run away; with
 * the stiffest part of each kind of law in turn beyond the normal law's. */
static void test_stable_steps(void) {
    static const char *const cases[][2] = {
        {"law = \"coulomb\", static = 5, kinetic = 5, stiffness = 1e7", NULL},
        {"law = \"coulomb\", static = 5, kinetic = 5, stiffness = 1e6, damping = 1e3", NULL},
        {"law = \"mindlin\", static = 5, kinetic = 5, shear_modulus = 1e11", NULL},
        {"law = \"mindlin-incremental\", static = 5, kinetic = 5, shear_modulus = 1e11, damping = 1.0", NULL},
        {"law = \"karnopp\", static = 5, kinetic = 5, band = 1.0, stiffness = 1e7", NULL},
        {"law = \"dahl\", kinetic = 5, stiffness = 1e7", NULL},
        {"law = \"lugre\", static = 5, kinetic = 5, stribeck_speed = 1.0, stiffness = 1e7, damping = 100", NULL},
        {"law = \"elastoplastic\", static = 5, kinetic = 5, stribeck_speed = 1.0, stiffness = 1e7", NULL},
        {"law = \"ramp\", kinetic = 0.4, threshold = 1e-6", NULL},
        {"law = \"threlfall\", kinetic = 0.4, threshold = 1e-6", NULL},
        {"law = \"bengisu-akay\", static = 0.5, kinetic = 0.4, threshold = 1e-6, fall = 100", NULL},
        {"law = \"stribeck\", static = 0.5, kinetic = 0.4, stribeck_speed = 0.01, threshold = 1e-6", NULL},
        {"law = \"simscape\", static = 0.5, kinetic = 0.4, threshold = 1e-5", NULL},
        {"law = \"coulomb\", static = 5, kinetic = 5, stiffness = 1e7",
         "law = \"spring-dashpot\", rolling = 5, twisting = 5, stiffness = 1e7"},
        {"law = \"coulomb\", static = 5, kinetic = 5, stiffness = 1e6",
         "law = \"spring-dashpot\", rolling = 5, twisting = 5, stiffness = 1e6, damping = 300"},
        {"law = \"coulomb\", static = 5, kinetic = 5, stiffness = 1e6",
         "law = \"constant\", rolling = 0.1, twisting = 0.1, threshold = 1e-7"},
        {"law = \"coulomb\", static = 5, kinetic = 5, stiffness = 1e6",
         "law = \"viscous\", rolling = 1e5, twisting = 1e5"},
    };
    for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++) {
        struct slope_case c = {.friction = cases[k][0],
                               .rolling = cases[k][1],
                               .turns = 1,
                               .speed = 1e-3,
                               .spin = {0.02, -0.05, 0.1},
                               .step = 1e-12};
        scree_scene *scene = on_slope(&c);
        c.step = 0.9 * scene->plan.choice.limit;
        scree_scene_destroy(scene);
        scene = on_slope(&c);
        double fastest = 0.0;
        for (int n = 0; n < 400; n++) {
            go(scene, 100);
            scree_body_state state = state_of(scene, "ball");
            fastest = scree_most(fastest, vec_norm(vec_from(state.velocity)) + radius * vec_norm(vec_from(state.spin)));
        }
        if (fastest > 6e-3) printf("  %s\n", cases[k][0]);
        CHECK(fastest < 6e-3); /* at first 1e-3 + R 0.11 rad/s = 2.1e-3; the same energy can all be in one motion */
        scree_scene_destroy(scene);
    }
}

/* ---- memory ---- */

/* Balls thrown across a floor, onto each other. */
static scree_scene *balls(const char *friction) {
    char text[8192];
    uint64_t seed = 31;
    int used = snprintf(
        text, sizeof text,
        "gravity = [0, 0, -9.81]\n[time]\nintegrator = \"verlet\"\nend = 1.0\nstep = 1e-5\nforce = "
        "true\n[output]\nwrite = [\"energy.csv\"]\n"
        "[[material]]\nname = \"m\"\ndensity = 1000\n[[contact]]\nbetween = [\"m\", \"m\"]\n"
        "normal = { law = \"linear-cut\", stiffness = 2e4, restitution = 0.5 }\nfriction = { %s }\n"
        "rolling = { law = \"spring-dashpot\", rolling = 0.05, twisting = 0.02, stiffness = 1e3, damping = 0.5 }\n"
        "[[body]]\nname = \"floor\"\nshape = { plane = true }\nmaterial = \"m\"\njoint = \"fixed\"\n",
        friction);
    for (int k = 0; k < 18; k++) {
        double speed[2];
        check_draw(&seed, -0.3, 0.3, 2, speed);
        used += snprintf(text + used, sizeof text - (size_t)used,
                         "[[body]]\nname = \"b%d\"\nmaterial = \"m\"\nshape = { sphere = 0.01 }\n"
                         "position = [%.17g, %.17g, %.17g]\nvelocity = [%.17g, %.17g, -0.5]\n",
                         k, 0.021 * (k % 3), 0.021 * (k / 3 % 3), 0.011 + 0.021 * (k / 9), speed[0], speed[1]);
    }
    return scene_from(text, NULL, 0, 0);
}

/* What laws remember is carried over when lists are made anew, and saved and restored: the same bits. The books
 * balance. */
static void test_memory(void) {
    static const double skins[] = {0.001, 0.004, 0.02};
    for (int l = 0; scree_friction_laws[l]; l++) {
        if (!scree_friction_laws[l]->memory) continue;
        char friction[240];
        snprintf(friction, sizeof friction, "law = \"%s\", %s", scree_friction_laws[l]->text.name,
                 scree_friction_laws[l]->text.example);
        uint64_t hash[3];
        for (int n = 0; n < 3; n++) {
            scree_scene *scene = balls(friction);
            scene->contacts.skin = skins[n];
            CHECK(scree_contacts_list(&scene->contacts, &scene->bodies, 1, NULL) == SCREE_OK);
            go(scene, 8000);
            hash[n] = scree_scene_hash(scene);
            int moved = 0;
            for (int b = 0; b < scene->contacts.batches; b++)
                for (int k = 0; k < scene->contacts.batch[b].count; k++)
                    moved += scree_kept(&scene->contacts.batch[b], SCREE_KEPT_ROLLING, k) != 0.0;
            CHECK(moved > 5 && (n > 0 || scene->contacts.rebuilds > 3));
            scree_scene_destroy(scene);
        }
        CHECK(hash[0] == hash[1] && hash[1] == hash[2]);

        scree_scene *scene = balls(friction), *other = balls(friction);
        FILE *file = tmpfile();
        go(scene, 5000);
        CHECK(scree_scene_save(scene, file, "file") == SCREE_OK);
        rewind(file);
        CHECK(scree_scene_restore(other, file, "file") == SCREE_OK);
        fclose(file);
        go(other, 3000);
        go(scene, 3000);
        CHECK(scree_scene_hash(other) == scree_scene_hash(scene));
        scree_scene_destroy(scene);
        scree_scene_destroy(other);
    }
}

/* Two balls that meet spinning, without gravity: a rolling law keeps momentum and angular momentum, and the books
 * balance. */
static void test_rolling_momentum(void) {
    for (int l = 0; scree_rolling_laws[l]; l++) {
        char text[1600];
        snprintf(
            text, sizeof text,
            "[time]\nintegrator = \"verlet\"\nend = 1.0\nstep = 1e-6\n[output]\nwrite = [\"energy.csv\"]\n"
            "[[material]]\nname = \"m\"\ndensity = 2000\n[[contact]]\nbetween = [\"m\", \"m\"]\n"
            "normal = { law = \"linear\", stiffness = 1e4, damping = 0 }\nrolling = { law = \"%s\", %s }\n"
            "[[body]]\nname = \"a\"\nmaterial = \"m\"\nshape = { sphere = 0.01 }\nvelocity = [1.0, 0.3, 0.1]\n"
            "spin = [50, -20, 30]\n"
            "[[body]]\nname = \"b\"\nmaterial = \"m\"\nshape = { sphere = 0.013 }\nposition = [0.0235, 0.002, 0.001]\n"
            "spin = [10, 20, -10]\n",
            scree_rolling_laws[l]->text.name, scree_rolling_laws[l]->text.example);
        scree_scene *scene = scene_from(text, NULL, 0, 0);
        struct vec before = vec(0.0, 0.0, 0.0), after = before;
        for (int n = 0; n < 2; n++) {
            struct vec *sum = n ? &after : &before;
            for (int k = 0; k < 2; k++) {
                const struct scree_state *state = &scene->bodies.state[k];
                struct vec p = vec_scale(scree_kind_of(&scene->bodies, k)->inertia.mass, vec_from(state->v));
                *sum = vec_add(*sum, vec_add(vec_from(state->l), vec_cross(vec_from(scene->bodies.position[k]), p)));
            }
            if (n == 0) go(scene, 10000);
        }
        scree_energy energy;
        CHECK(scree_scene_energy(scene, &energy) == SCREE_OK);
        CHECK(energy.lost_tangential > 1e-6 && energy.stored == 0.0);
        /* Rounding of positions, up to 2e-18 m a step and the same way for long, times the momentum. */
        NEAR(vec_norm(vec_sub(after, before)), 0.0, 10000 * 2e-18 * 0.01);
        NEAR(energy.balance, 0.0, 1e-4 * energy.lost_tangential);
        scree_scene_destroy(scene);
    }
}

/* ---- what is refused ---- */

static void refuse_scene(const char *contact, const char *shape, const char *part) {
    char text[1024];
    snprintf(text, sizeof text,
             "[time]\nintegrator = \"verlet\"\nend = 1.0\n[[material]]\nname = \"m\"\ndensity = "
             "1000\n[[contact]]\nbetween = [\"m\", \"m\"]\n"
             "normal = { law = \"linear\", stiffness = 1e4, damping = 0 }\n%s\n"
             "[[body]]\nname = \"floor\"\nshape = { plane = true }\nmaterial = \"m\"\njoint = \"fixed\"\n"
             "[[body]]\nname = \"thing\"\nshape = { %s }\nmaterial = \"m\"\nposition = [0, 0, 1]\n",
             contact, shape);
    scree_scene *scene = NULL;
    struct scree_run_request request;
    scree_trouble trouble = {0};
    CHECK(scree_read_scene(text, strlen(text), "test.toml", NULL, 0, 0, &scene, &request, &trouble) == SCREE_BAD_INPUT);
    CONTAINS(trouble.text, part);
    scree_free_request(&request);
}

static void test_refusals(void) {
    static const char ball[] = "sphere = 0.01";
    refuse_scene("rolling = { law = \"viscous\", rolling = 0.1 }", "box = [0.1, 0.1, 0.1]", "only spheres roll");
    refuse_scene("rolling = { law = \"viscos\", rolling = 0.1 }", ball, "did you mean \"viscous\"");
    refuse_scene("rolling = { law = \"viscous\" }", ball, "needs rolling");
    refuse_scene("roling = { law = \"viscous\" }", ball, "did you mean \"rolling\"");
    refuse_scene("friction = { law = \"mindlin\", static = 0.3, kinetic = 0.3 }", ball, "needs shear_modulus");
    refuse_scene("friction = { law = \"ambrosio\", kinetic = 0.3, tolerance = 1e-3, threshold = 1e-3 }", ball,
                 "must be above tolerance");
    static const char *const laws[] = {"law = \"bengisu-akay\", threshold = 1e-3, fall = 100",
                                       "law = \"stribeck\", stribeck_speed = 0.01, threshold = 1e-3",
                                       "law = \"simscape\", threshold = 1e-3",
                                       "law = \"karnopp\", band = 1e-3, stiffness = 1e4",
                                       "law = \"lugre\", stribeck_speed = 0.01, stiffness = 1e4",
                                       "law = \"elastoplastic\", stribeck_speed = 0.01, stiffness = 1e4",
                                       "law = \"mindlin\", shear_modulus = 1e9",
                                       "law = \"mindlin-incremental\", shear_modulus = 1e9"};
    for (size_t l = 0; l < sizeof laws / sizeof laws[0]; l++) {
        char contact[200];
        snprintf(contact, sizeof contact, "friction = { %s, static = 0.2, kinetic = 0.3 }", laws[l]);
        refuse_scene(contact, ball, "below kinetic");
    }
    refuse_scene(
        "friction = { law = \"elastoplastic\", static = 0.4, kinetic = 0.3, stribeck_speed = 0.01, stiffness = "
        "1e4, elastic = 1 }",
        ball, "must be below 1");
}

/* G* from the materials: 1/G* = (2 - nu1)/G1 + (2 - nu2)/G2 with G = E/(2 (1 + nu)). */
static void test_shear_from_materials(void) {
    const double young[2] = {70e9, 3e9}, poisson[2] = {0.3, 0.4};
    struct scree_elastic elastic = scree_elastic_of(young, poisson);
    scree_contact_def def = {.normal = {"linear", 2, {{"stiffness", 1e5}, {"damping", 0.0}}},
                             .friction = {"mindlin", 2, {{"static", 0.3}, {"kinetic", 0.3}}}};
    struct scree_rule rule;
    CHECK(scree_bake_rule(&def, &elastic, &rule, NULL) == SCREE_OK);
    const struct scree_friction_law *law = scree_friction_laws[rule.friction];
    struct scree_pair_constants pair = law->pair(&rule.friction_constants, 1.0, 0.02);
    double soft = 1.7 * 2.6 / 70e9 + 1.6 * 2.8 / 3e9;
    CLOSE(law->stiffness(&rule.friction_constants, pair, 1e-6), 8.0 / soft * sqrt(0.02 * 1e-6), 1e-14);
}

int main(void) {
    test_values();
    test_viscous();
    test_creep();
    test_rest();
    test_dahl();
    test_presliding();
    test_drift();
    test_takes_energy();
    test_slider_of();
    test_slider_order();
    test_bristle_order();
    test_mindlin_cycles();
    test_mindlin_memories();
    test_mindlin_rescaled();
    test_inclines();
    test_rolling_on_flat();
    test_rolling_on_slope();
    test_twisting();
    test_belt();
    test_walton();
    test_oblique_mindlin();
    test_touch_anywhere();
    test_stable_steps();
    test_memory();
    test_rolling_momentum();
    test_refusals();
    test_shear_from_materials();
    return check_report();
}
