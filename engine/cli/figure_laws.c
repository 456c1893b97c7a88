/* Figures 8 and 9: what the laws do, measured in the simulation. */
#include "contact/catalogue.h"
#include "engine/cli/figures.h"

#include <math.h>
#include <string.h>

/* ---- figure 8: force-overlap loops ---- */

enum { MOST_SAMPLES = 4000 };

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
    char choice[480];
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
                               "set xlabel 'overlap (mm)'\nset ylabel 'normal force (N)'\nset key outside right top "
                               "font ',8'\nunset datafile columnheaders\nlaws = '%s'\n"
                               "plot for [k=1:words(laws)] 'fig_8.csv' index k-1 using ($2*1e3):3 with lines ls "
                               "(k-1)%%7+1 dt 1+(k-1)/7 title word(laws, k)\n";

/* The loop of one law: into the table, and its area into the report: the energy that it lacks, the product has kept. */
static scree_status draw_loop(struct figures *figures, const struct scree_normal_law *law, FILE *file) {
    double area = 0.0, speed = 0.0;
    char quantity[96];
    scree_status status = run_loop(figures, law->text.name, law->text.example, file, &area, &speed);
    if (status) return status;
    /* In the comb's frame the product meets it at 1 m/s and leaves at speed - 1. */
    double left = 0.5 * 0.03 * (speed - 1.0) * (speed - 1.0); /* a product that was never pushed hasn't met it */
    snprintf(quantity, sizeof quantity, "area of the loop and energy left, %s (J)", law->text.name);
    /* Trapezia over 1500 steps: (1/1500)^2 of the loop, times a few where the branches bend; (1/1500)^(5/4) = 1.1e-4
     * where the force begins like the fourth root of the overlap, ^(3/2) where it does like the second. */
    figures_report(figures, "8", quantity, 0.5 * 0.03, speed > 0.0 ? area + left : 0.0, law->root ? 2e-4 : 1e-5);
    return SCREE_OK;
}

scree_status figure_8(struct figures *figures) {
    struct scree_out out = {0};
    char laws[1024] = "", script[2048];
    scree_status status = figures_table(figures, "fig_8", "law,overlap_m,force_N", &out);
    for (int l = 0; scree_normal_laws[l] && !status; l++) {
        const char *law = scree_normal_laws[l]->text.name;
        if (!scree_normal_laws[l]->text.example) {
            printf("8    the law %s isn't drawn: its description has no example\n", law);
            continue;
        }
        size_t length = strlen(laws);
        snprintf(laws + length, sizeof laws - length, "%s%s", length ? " " : "", law);
        status = draw_loop(figures, scree_normal_laws[l], out.file);
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

/* The example of a friction law, apart from any scene. */
static scree_status bake_example(const struct scree_friction_law *law, struct scree_rule *rule,
                                 scree_trouble *trouble) {
    scree_contact_def def = {.normal = scree_example(&scree_normal_laws[0]->text),
                             .friction = scree_example(&law->text)};
    return scree_bake_rule(&def, NULL, rule, trouble);
}

/* Friction of a law without memory in a contact that slides at velocity v, N; 0 for one with memory. */
static double formula(const struct scree_friction_law *law, const struct scree_rule *rule,
                      const scree_contact_state *contact, double v) {
    if (law->memory) return 0.0;
    struct scree_sliding at = {.normal = contact->normal_force, .overlap = contact->overlap, .velocity = {v, 0.0, 0.0}};
    return law->force(&rule->friction_constants, (struct scree_pair_constants){{0.0}}, at).force.x;
}

/* The product is driven to and fro over the surfaces; friction over normal force, once every 10 steps for one period.
 * `worst` receives the largest difference from the law's formula. */
static scree_status run_friction(struct figures *figures, const struct scree_friction_law *law, FILE *file,
                                 double *worst) {
    char choice[480];
    struct scree_rule rule;
    if (bake_example(law, &rule, &figures->trouble)) return figures->trouble.status;
    snprintf(choice, sizeof choice, "contact.0.friction={law=\"%s\", %s}", law->text.name, law->text.example);
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
        double v = scree_scene_body(scene, product).velocity[0], friction = 0.0, normal = 0.0, expected = 0.0;
        for (int c = 0; c < count && c < 16; c++) {
            friction += contact[c].friction[0];
            normal += contact[c].normal_force;
            expected += formula(law, &rule, &contact[c], v);
        }
        if (k >= 250) fprintf(file, "\"%s\",%.17g,%.17g\n", law->text.name, v, -friction / normal);
        *worst = scree_most(*worst, fabs(friction - expected) / normal);
    }
    if (status) figures->trouble = *scree_scene_trouble(scene);
    scree_scene_destroy(scene);
    fprintf(file, "\n\n");
    return status;
}

static const char script_9[] = "set title 'Friction coefficient over relative velocity'\n"
                               "set xlabel 'relative velocity (mm/s)'\nset ylabel 'friction force over "
                               "normal force'\nset key outside right top font ',8'\n"
                               "unset datafile columnheaders\nset yrange [-0.45:0.45]\nlaws = '%s'\n"
                               "plot for [k=1:words(laws)] 'fig_9.csv' index k-1 using ($2*1e3):3 with lines ls "
                               "(k-1)%%7+1 dt 1+(k-1)/7 title word(laws, k)\n";

/* The curve of one law into the table, and how well it follows its formula into the report. A law with memory has a
 * loop instead of a curve. */
static scree_status draw_friction(struct figures *figures, const struct scree_friction_law *law, FILE *file) {
    double worst = 0.0;
    char quantity[96];
    scree_status status = run_friction(figures, law, file, &worst);
    if (status || law->memory) return status;
    snprintf(quantity, sizeof quantity, "coefficient against formula, largest difference, %s", law->text.name);
    figures_report(figures, "9", quantity, 0.0, worst, 1e-14);
    return SCREE_OK;
}

scree_status figure_9(struct figures *figures) {
    struct scree_out out = {0};
    char laws[1024] = "", script[2048];
    scree_status status = figures_table(figures, "fig_9", "law,velocity_m_s,coefficient", &out);
    for (int l = 0; scree_friction_laws[l] && !status; l++) {
        const struct scree_friction_law *law = scree_friction_laws[l];
        if (!law->text.example) {
            printf("9    the law %s isn't drawn: its description has no example\n", law->text.name);
            continue;
        }
        size_t length = strlen(laws);
        snprintf(laws + length, sizeof laws - length, "%s%s", length ? " " : "", law->text.name);
        status = draw_friction(figures, law, out.file);
    }
    if (status) {
        scree_out_drop(&out, 0);
        return status;
    }
    snprintf(script, sizeof script, script_9, laws);
    status = scree_out_keep(&out, &figures->trouble);
    return status ? status : figures_plot(figures, "fig_9", script);
}
