/* The eight impact tests of Chung & Ooi, Granular Matter 13 (2011) 643, against Hertz's solution and the rules of sliding bodies. */
#include "engine/cli/figures.h"

#include <math.h>
#include <string.h>

static const double pi = 3.14159265358979323846;

struct material {
    double young, poisson, density;
};

/* A ball against a plane (`other` 0) or against another ball of radius `other` that waits for it, or comes to meet it. */
struct strike {
    struct material material;
    double radius, other;    /* m */
    double density;          /* of the other, kg/m^3 */
    double normal, sideways; /* speed, m/s; the other ball comes with `against` */
    double against;          /* m/s */
    double spin, other_spin; /* about y, rad/s */
    double restitution, mu;  /* mu 0: frictionless */
};

struct result {
    scree_body_state ball, other;
    double force, overlap, duration; /* largest ones; s */
};

/* Plane and balls are of one material; the plane is rigid: 1e6 times as stiff. */
static scree_scene *make_scene(struct figures *figures, const struct strike *s, double gap) {
    char text[2048], friction[160] = "", host[256];
    if (s->mu > 0.0)
        snprintf(friction, sizeof friction,
                 "friction = { law = \"mindlin-incremental\", static = %.17g, kinetic = %.17g }\n", s->mu, s->mu);
    if (s->other > 0.0)
        snprintf(host, sizeof host, "shape = { sphere = %.17g }\nvelocity = [0, 0, %.17g]\nspin = [0, %.17g, 0]\n",
                 s->other, s->against, s->other_spin);
    else
        snprintf(host, sizeof host, "shape = { plane = true }\njoint = \"fixed\"\n");
    snprintf(text, sizeof text,
             "[time]\nend = 1\nspeed = %.17g\nintegrator = \"pair-impulse\"\nsubsteps = 4\n[output]\nwrite = []\n"
             "[[material]]\nname = \"a\"\nyoung = %.17g\npoisson = %.17g\ndensity = %.17g\n"
             "[[material]]\nname = \"b\"\nyoung = %.17g\npoisson = %.17g\ndensity = %.17g\n"
             "[[contact]]\nbetween = [\"a\", \"b\"]\nnormal = { law = \"tsuji-cut\", restitution = %.17g }\n%s"
             "[[body]]\nname = \"host\"\nmaterial = \"b\"\nposition = [0, 0, %.17g]\n%s"
             "[[body]]\nname = \"ball\"\nmaterial = \"a\"\nshape = { sphere = %.17g }\nposition = [0, 0, %.17g]\n"
             "velocity = [%.17g, 0, %.17g]\nspin = [0, %.17g, 0]\n",
             s->normal + s->against, s->material.young, s->material.poisson, s->material.density,
             s->other > 0.0 ? s->material.young : 1e6 * s->material.young, s->material.poisson, s->density,
             s->restitution, friction, -s->other, host, s->radius, s->radius + gap, s->sideways, -s->normal, s->spin);
    return figures_scene_text(figures, text);
}

/* Largest of three values a step apart, on the parabola through them. */
static double peak(const double y[3]) {
    double bend = y[0] - 2.0 * y[1] + y[2], rise = 0.5 * (y[2] - y[0]);
    return bend < 0.0 ? y[1] - 0.5 * rise * rise / bend : y[1];
}

static scree_status strike(struct figures *figures, const struct strike *s, struct result *result) {
    double gap = 1e-6 * s->radius, approach = s->normal + s->against, force[3] = {0.0}, overlap[3] = {0.0};
    *result = (struct result){.duration = 0.0};
    scree_scene *scene = make_scene(figures, s, gap);
    if (!scene) return figures->trouble.status;
    scree_status status = SCREE_OK;
    for (int met = 0, touches = 1; !status && (!met || touches);) {
        scree_contact_state contact;
        status = figures_step(figures, scene, 1);
        if (!status) status = scree_scene_contacts(scene, &contact, 1, &touches);
        met |= touches > 0;
        memmove(force, force + 1, 2 * sizeof *force);
        memmove(overlap, overlap + 1, 2 * sizeof *overlap);
        force[2] = touches ? contact.normal_force : 0.0;
        overlap[2] = touches ? contact.overlap : 0.0;
        if (force[1] >= force[0] && force[1] >= force[2]) result->force = fmax(result->force, peak(force));
        if (overlap[1] >= overlap[0] && overlap[1] >= overlap[2])
            result->overlap = fmax(result->overlap, peak(overlap));
    }
    result->other = scree_scene_body(scene, 0);
    result->ball = scree_scene_body(scene, 1);
    double way = result->ball.position[2] - result->other.position[2] - s->radius - s->other;
    double parting = result->ball.velocity[2] - result->other.velocity[2];
    result->duration = scree_scene_time(scene) - gap / approach - way / parting;
    scree_scene_destroy(scene);
    return status;
}

static double mass_of(double radius, double density) { return 4.0 / 3.0 * pi * radius * radius * radius * density; }

/* Hertz: d = (5 m v^2/(4 K))^(2/5), F = K d^(3/2), t = 2.94327518432 d/v. The peaks lie between steps, 50 in a contact: a parabola is
 * right to (1/50)^4 of them there. */
scree_status suite_chung_ooi_elastic(struct figures *figures) {
    static const struct {
        const char *name;
        struct strike strike;
    } cases[] = {
        {"1 glass", {{4.8e10, 0.2, 2800.0}, 0.01, 0.01, 2800.0, 10.0, 0.0, 10.0, 0.0, 0.0, 0.9999999999, 0.0}},
        {"1 limestone", {{2e10, 0.25, 2500.0}, 0.01, 0.01, 2500.0, 10.0, 0.0, 10.0, 0.0, 0.0, 0.9999999999, 0.0}},
        {"2 aluminium", {{7e10, 0.3, 2699.0}, 0.1, 0.0, 1.0, 0.2, 0.0, 0.0, 0.0, 0.0, 0.9999999999, 0.0}},
        {"2 magnesium", {{4e10, 0.35, 1800.0}, 0.1, 0.0, 1.0, 0.2, 0.0, 0.0, 0.0, 0.0, 0.9999999999, 0.0}},
    };
    for (size_t c = 0; c < sizeof cases / sizeof cases[0]; c++) {
        const struct strike *s = &cases[c].strike;
        struct result result;
        scree_status status = strike(figures, s, &result);
        if (status) return status;
        int pair = s->other > 0.0;
        double plane = s->material.young / (1.0 - s->material.poisson * s->material.poisson);
        double young = pair ? 0.5 * plane : plane / (1.0 + 1e-6), mass = mass_of(s->radius, s->material.density);
        double k = 4.0 / 3.0 * young * sqrt(pair ? 0.5 * s->radius : s->radius), v = s->normal + s->against;
        double deepest = pow(1.25 * (pair ? 0.5 * mass : mass) * v * v / k, 0.4);
        char quantity[96];
        snprintf(quantity, sizeof quantity, "%s: largest force (N) (Kratos 3e-3)", cases[c].name);
        figures_report(figures, "1-2", quantity, k * pow(deepest, 1.5), result.force, 1e-5);
        snprintf(quantity, sizeof quantity, "%s: largest overlap (m) (Kratos 2e-3)", cases[c].name);
        figures_report(figures, "1-2", quantity, deepest, result.overlap, 1e-5);
        snprintf(quantity, sizeof quantity, "%s: contact time (s)", cases[c].name);
        figures_report(figures, "1-2", quantity, 2.94327518432 * deepest / v, result.duration, 1e-5);
    }
    return SCREE_OK;
}

static const struct material oxide = {3.8e11, 0.23, 4000.0}, iron = {1e11, 0.25, 7000.0},
                             aluminium = {7e10, 0.33, 2700.0}, steel = {2.08e11, 0.3, 7850.0},
                             polyethylene = {1e9, 0.4, 1400.0}, polyamide = {2.5e9, 0.4, 1000.0};

scree_status suite_chung_ooi_restitution(struct figures *figures) {
    for (double e = 0.2; e < 1.05; e += 0.2) {
        double worst = 0.0, asked = e < 0.99 ? e : 0.9999999999;
        for (int m = 0; m < 2; m++) {
            struct strike s = {m ? iron : oxide, 0.0025, 0.0, 1.0, 3.9, 0.0, 0.0, 0.0, 0.0, asked, 0.0};
            struct result result;
            scree_status status = strike(figures, &s, &result);
            if (status) return status;
            worst = fmax(worst, fabs(result.ball.velocity[2] / 3.9 - asked));
        }
        char quantity[96];
        snprintf(quantity, sizeof quantity, "3: restitution got less asked, %.1f (Kratos 1e-3 to 7e-3)", e);
        figures_report(figures, "3", quantity, 0.0, worst, 1e-5);
    }
    return SCREE_OK;
}

/* Where the contact slides throughout: e_t = 1 - mu (1 + e)/tan(angle), R w = 5/2 mu (1 + e) v_n, but for levers that are shorter by
 * half the overlap: the mean one, three quarters of the largest. */
static scree_status report_sliding(struct figures *figures, const char *test, const struct strike *base, double first,
                                   double speed) {
    double tangential = 0.0, spin = 0.0, sunk = 0.0;
    for (double degrees = first; degrees < 86.0; degrees += 5.0) {
        struct strike s = *base;
        double angle = degrees * pi / 180.0;
        s.normal = speed > 0.0 ? speed * cos(angle) : base->normal;
        s.sideways = s.normal * tan(angle);
        struct result result;
        scree_status status = strike(figures, &s, &result);
        if (status) return status;
        double push = s.mu * (1.0 + s.restitution) * s.normal;
        tangential = fmax(tangential, fabs((result.ball.velocity[0] - s.sideways + push) / s.sideways));
        spin = fmax(spin, fabs(s.radius * result.ball.spin[1] / (2.5 * push) - 1.0));
        sunk = fmax(sunk, 0.5 * result.overlap / s.radius);
    }
    char quantity[96];
    snprintf(quantity, sizeof quantity, "%s: tangential restitution while sliding, %g to 85 deg", test, first);
    figures_report(figures, "4-5", quantity, 0.0, tangential, 1e-4);
    snprintf(quantity, sizeof quantity, "%s: spin while sliding, %g to 85 deg", test, first);
    figures_report(figures, "4-5", quantity, 0.0, spin, sunk);
    return SCREE_OK;
}

scree_status suite_chung_ooi_oblique(struct figures *figures) {
    struct strike four = {oxide, 0.0025, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.98, 0.092};
    scree_status status = report_sliding(figures, "4 oxide (Kratos 4.6e-2)", &four, 30.0, 3.9);
    four.material = aluminium;
    if (!status) status = report_sliding(figures, "4 aluminium", &four, 30.0, 3.9);
    struct strike five = {steel, 1e-5, 0.0, 1.0, 5.0, 0.0, 0.0, 0.0, 0.0, 0.9999999999, 0.3};
    if (!status) status = report_sliding(figures, "5 steel (Kratos 1.5e-2)", &five, 65.0, 0.0);
    five.material = polyethylene;
    if (!status) status = report_sliding(figures, "5 polyethylene", &five, 65.0, 0.0);
    return status;
}

/* The tangential recoil of an impact with spin, beta, at 65, 70 … 85 degrees: solutions to 40 digits, aluminium and nylon
 * (data/reference/oblique_hertz_mindlin_noslip.csv, T6, memory in the force). */
static const double recoil[2][5] = {
    {-0.0444381544878434, -0.249506690369085, -0.444531080950948, -0.632733390321997, -0.816992847825269},
    {-0.046422407184956, -0.250621494379043, -0.445091478606602, -0.632959421287716, -0.817044826300404}};

/* 6: spin alone. Levers are shorter than R by half the overlap, which turns up in beta as much. */
static scree_status report_spin(struct figures *figures, const char *test, int nylon) {
    double worst = 0.0, sunk = 0.0;
    for (int k = 0; k < 5; k++) {
        double spin = 0.2 / 0.1 * tan((65.0 + 5.0 * k) * pi / 180.0);
        struct strike s = {nylon ? polyamide : aluminium, 0.1, 0.0, 1.0, 0.2, 0.0, 0.0, spin, 0.0, 0.5, 0.4};
        struct result result;
        scree_status status = strike(figures, &s, &result);
        if (status) return status;
        double after = result.ball.velocity[0] - s.radius * result.ball.spin[1];
        worst = fmax(worst, fabs(after / (s.radius * spin) - recoil[nylon][k]));
        sunk = fmax(sunk, result.overlap / s.radius);
    }
    figures_report(figures, "6-8", test, 0.0, worst, sunk + 1e-5);
    return SCREE_OK;
}

/* 7: opposite spins roll on each other. 8: unequal spheres; in units of the effective mass the same as on a plane. */
static scree_status report_pairs(struct figures *figures) {
    double omega = 0.2 / 0.1 * tan(60.0 * pi / 180.0);
    struct strike seven = {aluminium, 0.1, 0.1, 2700.0, 0.2, 0.0, 0.2, omega, -omega, 0.5, 0.4};
    struct result result;
    scree_status status = strike(figures, &seven, &result);
    if (status) return status;
    figures_report(figures, "6-8", "7: spin after, aluminium (rad/s)", omega, result.ball.spin[1], 1e-12);
    figures_report(figures, "6-8", "7: tangential velocity after (m/s)", 0.0, result.ball.velocity[0], 1e-12);
    double spin = 0.2 / 0.1 * tan(80.0 * pi / 180.0), m1 = mass_of(0.1, 2700.0), m2 = mass_of(0.5, 2700.0);
    struct strike eight = {aluminium, 0.1, 0.5, 2700.0, 0.2, 0.0, 0.0, spin, 0.0, 0.5, 0.4};
    double push = 2.0 / 7.0 * m1 * m2 / (m1 + m2) * 0.1 * spin * (1.0 + recoil[0][3]);
    status = strike(figures, &eight, &result);
    if (status) return status;
    double small = spin - push * 0.1 / (0.4 * m1 * 0.01), large = -push * 0.5 / (0.4 * m2 * 0.25);
    double sunk = result.overlap / 0.1;
    figures_report(figures, "6-8", "8: spin of the small one after (rad/s) (Kratos 4.2e-2)", small, result.ball.spin[1],
                   sunk + 1e-5);
    figures_report(figures, "6-8", "8: spin of the large one after (rad/s)", large, result.other.spin[1], sunk + 1e-5);
    return SCREE_OK;
}

scree_status suite_chung_ooi_spin(struct figures *figures) {
    scree_status status = report_spin(figures, "6: recoil, aluminium, 65 to 85 deg (Kratos 3.4e-2)", 0);
    if (!status) status = report_spin(figures, "6: recoil, nylon, 65 to 85 deg", 1);
    return status ? status : report_pairs(figures);
}
