/* Figures 8 and 9: what the laws do, measured in the simulation. */
#include "contact/catalogue.h"
#include "engine/cli/figures.h"

#include <math.h>
#include <string.h>

/* ---- figure 8: force-overlap loops ---- */

enum { MOST_SAMPLES = 4000 };

/* Parameters for 0.03 kg at 1 m/s; the laws and their order are the catalogue's. */
static const struct {
    const char *law, *settings;
    int root; /* the dashpot sets in with a root of the overlap */
} normals[] = {
    {"linear", "stiffness=1e5, restitution=0.5", 0},
    {"linear-cut", "stiffness=1e5, restitution=0.5", 0},
    {"linear-loading", "stiffness=1e5, restitution=0.5", 0},
    {"blend", "stiffness=1e5, damping=65.4, full=2e-4", 0},
    {"hunt-crossley", "stiffness=5e6, restitution=0.5, speed=1.0", 0},
    {"impact", "stiffness=1e5, exponent=1.0, damping=30.0, full=2e-4", 0},
    {"hertz", "stiffness=5e6", 0},
    {"tsuji", "stiffness=5e6, restitution=0.5", 1},
    {"tsuji-cut", "stiffness=5e6, restitution=0.5", 1},
    {"matched", "stiffness=5e6, exponent=1.5, restitution=0.5", 1},
    {"matched-cut", "stiffness=1e7, exponent=2.0, restitution=0.5", 1},
    {"kuwabara-kono", "stiffness=5e6, restitution=0.5, speed=1.0", 1},
    {"kuwabara-kono-cut", "stiffness=5e6, restitution=0.5, speed=1.0", 1},
    {"hunt-crossley-1975", "stiffness=5e6, restitution=0.5", 0},
    {"herbert-mcwhannell", "stiffness=5e6, restitution=0.5", 0},
    {"lee-wang", "stiffness=5e6, restitution=0.5", 0},
    {"lankarani-nikravesh", "stiffness=5e6, restitution=0.5", 0},
    {"gonthier", "stiffness=5e6, restitution=0.5", 0},
    {"zhiying-qishao", "stiffness=5e6, restitution=0.5", 0},
    {"flores", "stiffness=5e6, restitution=0.5", 0},
    {"hu-guo", "stiffness=5e6, restitution=0.5", 0},
    {"jankowski", "stiffness=5e6, restitution=0.5", 1},
    {"anagnostopoulos", "stiffness=1e5, restitution=0.5", 0},
    {"walton-braun", "stiffness=1e5, restitution=0.5", 0},
    {"walton-braun-variable", "stiffness=1e5, restitution=0.5, speed=1.0", 0},
    {"thornton", "modulus=3e7, yield=3e6", 0},
    {"jkr", "modulus=3e7, adhesion=20.0", 0},
    {"dmt", "stiffness=5e6, adhesion=20.0", 0},
};

/* Place of the law in the table above, -1 if it isn't there. */
static int place_of(const char *law) {
    for (size_t k = 0; k < sizeof normals / sizeof normals[0]; k++)
        if (strcmp(normals[k].law, law) == 0) return (int)k;
    return -1;
}

/* Total normal force of the tines on the product, and the overlap of one of them. */
static scree_status loop_sample(scree_scene *scene, int first_tine, double *overlap, double *force) {
    scree_contact_state contact[16];
    int count = 0;
    scree_status status = scree_scene_contacts(scene, contact, 16, &count);
    *overlap = *force = 0.0;
    for (int k = 0; !status && k < count && k < 16; k++) {
        if (contact[k].host < first_tine) continue;
        *overlap = contact[k].overlap;
        *force += contact[k].normal_force;
    }
    return status;
}

/* One impact at 1 m/s into the table; `area` of the loop by the trapezoidal rule, and the speed after. */
static scree_status run_loop(struct figures *figures, const char *law, const char *settings, FILE *file, double *area,
                             double *speed) {
    char choice[240];
    snprintf(choice, sizeof choice, "contact.1.normal={law=\"%s\", %s}", law, settings);
    /* Some laws take the radius of corners: the tines get one, though none of their corners touches. */
    const char *changes[] = {choice, "body.3.shape={box=[0.03, 0.01, 0.025], rounding=1e-4}",
                             "body.4.shape={box=[0.03, 0.01, 0.025], rounding=1e-4}"};
    scree_scene *scene = figures_scene(figures, "restitution.toml", changes, 3, &figures->trouble);
    if (!scene) return figures->trouble.status;
    int first_tine = scree_scene_find_body(scene, "left tine"), product = scree_scene_find_body(scene, "product");
    double before = 0.0, force_before = 0.0, overlap = 0.0, force = 0.0;
    scree_status status = SCREE_OK;
    *area = 0.0;
    for (int k = 0; k < MOST_SAMPLES && !status; k++) {
        status = scree_scene_step(scene, 1);
        if (!status) status = loop_sample(scene, first_tine, &overlap, &force);
        /* A dashpot's force jumps at the first and the last touch: there the strip is a rectangle, not a trapezium. */
        double mean = k == 0 ? force : overlap == 0.0 ? force_before : 0.5 * (force + force_before);
        if (overlap == 0.0 && before < 0.0) mean = 0.0; /* pulled apart: it has let go where it was */
        *area += mean * (overlap - before);
        before = overlap;
        force_before = force;
        if (k % 10 == 0 || overlap == 0.0) fprintf(file, "\"%s\",%.17g,%.17g\n", law, overlap, force);
        if (overlap == 0.0) break;
    }
    if (status) figures->trouble = *scree_scene_trouble(scene);
    *speed = scree_scene_body(scene, product).velocity[0];
    scree_scene_destroy(scene);
    fprintf(file, "\n\n");
    return status;
}

static const char script_8[] = "set title 'Normal force over overlap: 0.03 kg at 1 m/s'\n"
                               "set xlabel 'overlap (mm)'\nset ylabel 'normal force (N)'\nset key bottom "
                               "right\nunset datafile columnheaders\nlaws = '%s'\n"
                               "plot for [k=1:words(laws)] 'fig_8.csv' index k-1 using ($2*1e3):3 with lines ls "
                               "(k-1)%%7+1 title word(laws, k)\n";

/* The loop of one law: into the table, and its area into the report: the energy that it lacks, the product has kept. */
static scree_status draw_loop(struct figures *figures, int place, FILE *file) {
    double area = 0.0, speed = 0.0;
    char quantity[96];
    scree_status status = run_loop(figures, normals[place].law, normals[place].settings, file, &area, &speed);
    if (status) return status;
    /* In the comb's frame the product meets it at 1 m/s and leaves at speed - 1. */
    double left = 0.5 * 0.03 * (speed - 1.0) * (speed - 1.0); /* a product that was never pushed hasn't met it */
    snprintf(quantity, sizeof quantity, "area of the loop and energy left, %s (J)", normals[place].law);
    /* Trapezia over 1500 steps: (1/1500)^2 of the loop, times a few where the branches bend; (1/1500)^(5/4) = 1.1e-4 where the
     * force begins like the fourth root of the overlap, ^(3/2) where it does like the second. */
    figures_report(figures, "8", quantity, 0.5 * 0.03, speed > 0.0 ? area + left : 0.0,
                   normals[place].root ? 2e-4 : 1e-5);
    return SCREE_OK;
}

scree_status figure_8(struct figures *figures) {
    struct scree_out out = {0};
    char laws[1024] = "", script[2048];
    scree_status status = figures_table(figures, "fig_8", "law,overlap_m,force_N", &out);
    for (int l = 0; scree_normal_laws[l] && !status; l++) {
        const char *law = scree_normal_laws[l]->text.name;
        int place = place_of(law);
        if (place < 0) {
            printf("8    the law %s isn't drawn: figure_laws.c has no parameters for it\n", law);
            continue;
        }
        size_t length = strlen(laws);
        snprintf(laws + length, sizeof laws - length, "%s%s", length ? " " : "", law);
        status = draw_loop(figures, place, out.file);
    }
    if (status) {
        scree_out_drop(&out, 0);
        return status;
    }
    snprintf(script, sizeof script, script_8, laws);
    status = scree_out_keep(&out, &figures->trouble);
    return status ? status : figures_plot(figures, "fig_8", script);
}

/* ---- figure 9: friction over velocity ---- */

enum { FRICTIONS = 5 };

static const struct {
    const char *label, *law;
} frictions[FRICTIONS] = {
    {"ramp", "law=\"ramp\", kinetic=0.3, threshold=1e-3"},
    {"tanh", "law=\"tanh\", kinetic=0.3, threshold=1e-3"},
    {"step", "law=\"step\", static=0.4, kinetic=0.3, stiction_speed=1e-3, sliding_speed=2e-3"},
    {"stick-slip", "law=\"stick-slip\", static=0.4, kinetic=0.3, threshold=1e-3"},
    {"coulomb", "law=\"coulomb\", static=0.4, kinetic=0.3, stiffness=4e4"},
};

/* The formula of a law without memory, written apart from the engine. */
static double formula(int n, double v) {
    double w = fabs(v) / 1e-3, mu = 0.0;
    if (n == 0) mu = 0.3 * fmin(w, 1.0);
    if (n == 1) mu = 0.3 * tanh(w);
    if (n == 2) {
        double s = fmin(fmax(w - 1.0, 0.0), 1.0);
        mu = w < 1.0 ? 0.4 * (1.5 * w - 0.5 * w * w * w) : 0.4 - 0.1 * s * s * (3.0 - 2.0 * s);
    }
    if (n == 3) mu = w < 1.0 ? 0.4 * w : w < 1.5 ? 0.4 - 0.2 * (w - 1.0) : 0.3;
    return v < 0.0 ? mu : -mu;
}

/* The product is driven to and fro over the surfaces; friction over normal force, once every 10 steps for one period. */
static scree_status run_friction(struct figures *figures, int n, FILE *file, double *worst) {
    char choice[160];
    snprintf(choice, sizeof choice, "contact.0.friction={%s}", frictions[n].law);
    const char *changes[] = {
        choice, "motion.slope={name=\"slope\", kind=\"sine\", amplitude=3.97887357729738e-5, frequency=20.0}",
        "gravity=[0,0,-9.81]", "body.product.joint={x=\"slope\", z=\"free\", others=\"fixed\"}"};
    scree_scene *scene = figures_scene(figures, "incline.toml", changes, 4, &figures->trouble);
    if (!scene) return figures->trouble.status;
    int product = scree_scene_find_body(scene, "product");
    *worst = 0.0;
    scree_status status = scree_scene_step(scene, 1);
    for (int k = 0; k < 750 && !status; k++) {
        scree_contact_state contact[16];
        int count = 0;
        status = scree_scene_step(scene, 10);
        if (!status) status = scree_scene_contacts(scene, contact, 16, &count);
        double v = scree_scene_body(scene, product).velocity[0], friction = 0.0, normal = 0.0;
        for (int c = 0; c < count && c < 16; c++) {
            friction += contact[c].friction[0];
            normal += contact[c].normal_force;
        }
        if (k >= 250) fprintf(file, "\"%s\",%.17g,%.17g\n", frictions[n].label, v, -friction / normal);
        *worst = fmax(*worst, fabs(friction / normal - formula(n, v)));
    }
    if (status) figures->trouble = *scree_scene_trouble(scene);
    scree_scene_destroy(scene);
    fprintf(file, "\n\n");
    return status;
}

static const char script_9[] = "set title 'Friction coefficient over relative velocity'\n"
                               "set xlabel 'relative velocity (mm/s)'\nset ylabel 'friction force over "
                               "normal force'\nset key bottom right\n"
                               "unset datafile columnheaders\nset yrange [-0.45:0.45]\n"
                               "plot for [k=0:4] 'fig_9.csv' index k using ($2*1e3):3 with lines ls k+1 "
                               "title word('ramp tanh step stick-slip coulomb', k+1)\n";

scree_status figure_9(struct figures *figures) {
    struct scree_out out = {0};
    scree_status status = figures_table(figures, "fig_9", "law,velocity_m_s,coefficient", &out);
    for (int n = 0; n < FRICTIONS && !status; n++) {
        double worst;
        char quantity[96];
        status = run_friction(figures, n, out.file, &worst);
        if (status || n == FRICTIONS - 1) break; /* the sticking law has no curve: it has a loop */
        snprintf(quantity, sizeof quantity, "coefficient against formula, largest difference, %s", frictions[n].label);
        figures_report(figures, "9", quantity, 0.0, worst, 1e-14);
    }
    if (status) {
        scree_out_drop(&out, 0);
        return status;
    }
    status = scree_out_keep(&out, &figures->trouble);
    if (!status) status = figures_plot(figures, "fig_9", script_9);
    return status;
}
