/* Of the Hunt-Crossley family, and what else can be had as published and calibrated: what each author's damping factor
 * delivers of the restitution it is asked for. */
#include "contact/catalogue.h"
#include "contact/impact.h"
#include "engine/cli/figures.h"

#include <math.h>
#include <string.h>

enum { ASKED = 50 };

static int has_both_factors(const struct scree_law_text *text) {
    for (const struct scree_parameter *p = text->parameters; p->name; p++)
        if (strcmp(p->name, "calibrated") == 0) return 1;
    return 0;
}

/* Integrated restitution of 1 kg at 1 m/s (it depends on neither), and the closed form's. */
static scree_status deliver(const char *name, double asked, double calibrated, double *integrated, double *closed,
                            scree_trouble *trouble) {
    scree_contact_def def = {
        .normal = {name, 3, {{"stiffness", 1e6}, {"restitution", asked}, {"calibrated", calibrated}}}};
    struct scree_rule rule;
    scree_status status = scree_bake_rule(&def, NULL, &rule, trouble);
    if (status) return status;
    const struct scree_normal_law *law = scree_normal_laws[rule.normal];
    struct scree_pair_constants pair = law->pair(&rule.normal_constants, 1.0, 1.0);
    *integrated = scree_impact(law, &rule.normal_constants, pair, 1.0, 1.0, 0.0, NULL, NULL).restitution;
    *closed = law->restitution(&rule.normal_constants, pair, 1.0, 1.0);
    return SCREE_OK;
}

/* One law: its rows of the table, and what the report says of it. */
static scree_status draw_law(struct figures *figures, const char *name, FILE *file) {
    double off_formula = 0.0, off_wish = 0.0;
    char quantity[96];
    scree_status status = SCREE_OK;
    for (int k = 1; k <= ASKED && !status; k++) {
        double asked = (double)k / ASKED, published = 0.0, calibrated = 0.0, closed = 0.0, exact = 0.0;
        status = deliver(name, asked, 0.0, &published, &closed, &figures->trouble);
        if (!status) status = deliver(name, asked, 1.0, &calibrated, &exact, &figures->trouble);
        off_formula = scree_most(off_formula, fabs(published - closed));
        off_wish = scree_most(off_wish, fabs(calibrated - asked));
        fprintf(file, "%s,%.17g,%.17g,%.17g\n", name, asked, published, calibrated);
    }
    fprintf(file, "\n\n");
    if (status) return status;
    /* The integrator's own bound. */
    snprintf(quantity, sizeof quantity, "e as published against formula, %s", name);
    figures_report(figures, "fam.", quantity, 0.0, off_formula, 1e-12);
    snprintf(quantity, sizeof quantity, "e calibrated against asked, %s", name);
    figures_report(figures, "fam.", quantity, 0.0, off_wish, 1e-12);
    return SCREE_OK;
}

static const char script_family[] =
    "set title 'Damping factors as published: restitution delivered over restitution asked'\n"
    "set xlabel 'restitution asked'\nset ylabel 'restitution delivered'\nset key bottom right noenhanced\n"
    "set xrange [0:1]\nset yrange [0:1]\nunset datafile columnheaders\nlaws = '%s'\n"
    "plot for [k=1:words(laws)] 'restitution_family.csv' index k-1 using 2:3 with linespoints ls (k-1)%%7+1 "
    "pointinterval 5 title word(laws, k), \\\n"
    "  'restitution_family.csv' index 0 using 2:4 with lines lw 1 lc rgb '#888888' title 'each, calibrated'\n";

scree_status figure_family(struct figures *figures) {
    struct scree_out out = {0};
    char laws[1024] = "", script[2048];
    scree_status status = figures_table(figures, "restitution_family", "law,asked,published,calibrated", &out);
    for (int l = 0; scree_normal_laws[l] && !status; l++) {
        const char *law = scree_normal_laws[l]->text.name;
        if (!has_both_factors(&scree_normal_laws[l]->text)) continue;
        size_t length = strlen(laws);
        snprintf(laws + length, sizeof laws - length, "%s%s", length ? " " : "", law);
        status = draw_law(figures, law, out.file);
    }
    if (status) {
        scree_out_drop(&out, 0);
        return status;
    }
    snprintf(script, sizeof script, script_family, laws);
    status = scree_out_keep(&out, &figures->trouble);
    return status ? status : figures_plot(figures, "restitution_family", script);
}
