/* scree laws: the catalogue of contact laws. */
#include "contact/ask.h"
#include "contact/catalogue.h"
#include "engine/cli/cli.h"

#include <stdio.h>

static const char help[] =
    "usage: scree laws [NAME]\n"
    "\n"
    "List the contact laws, or print one: formula, source, parameters with unit and range, what to know.\n"
    "\n"
    "example: scree laws linear-loading\n";

static void print_text(const struct scree_law_text *text, const char *kind, int memory) {
    printf("%s (%s)\n  %s\n  source: %s\n  %s\n  memory: %s\n%s", text->name, kind, text->formula, text->source,
           text->note, memory ? "kept from step to step while the contact lasts" : "none",
           text->parameters->name ? "  parameters:\n" : "");
    for (const struct scree_parameter *p = text->parameters; p->name; p++) {
        printf("    %-16s %-8s %-16s %s", p->name, p->unit, scree_range_text(p->range), p->meaning);
        if (p->instead_of) printf("; instead of %s", p->instead_of);
        if (p->optional && isnan(p->fallback)) printf("; optional");
        if (p->material) printf("; from `young` and `poisson` of the materials if not given");
        if (p->optional && !isnan(p->fallback)) printf("; %g if not given", p->fallback);
        printf("\n");
    }
    if (text->example) printf("  example: { law = \"%s\", %s }\n", text->name, text->example);
}

/* What the law makes of the restitution it is asked for: computed, not quoted. */
static void print_validity(const struct scree_normal_law *law) {
    static const double tolerance = 0.01;
    struct scree_validity validity = scree_validity_of(law, tolerance);
    if (!validity.asked) return;
    printf("  restitution: ");
    if (validity.from == 0.0)
        printf("delivers what is asked for, within %.1g (computed for 0 < e <= 1)\n", validity.worst);
    else if (validity.from > 1.0)
        printf("doesn't deliver what is asked for; worst by %.3g, at e = %.3g (computed)\n", validity.worst,
               validity.worst_at);
    else
        printf("delivers what is asked for within %g for e >= %.3g; worst by %.3g, at e = %.3g (computed)\n", tolerance,
               validity.from, validity.worst, validity.worst_at);
}

static void print_normal(const struct scree_normal_law *law) {
    print_text(&law->text, "normal law", law->memory);
    print_validity(law);
}

static void print_list(void) {
    printf("normal laws\n");
    for (int k = 0; scree_normal_laws[k]; k++)
        printf("  %-22s %s\n", scree_normal_laws[k]->text.name, scree_normal_laws[k]->text.formula);
    printf("friction laws\n");
    for (int k = 0; scree_friction_laws[k]; k++)
        printf("  %-22s %s\n", scree_friction_laws[k]->text.name, scree_friction_laws[k]->text.formula);
    printf("rolling laws\n");
    for (int k = 0; scree_rolling_laws[k]; k++)
        printf("  %-22s %s\n", scree_rolling_laws[k]->text.name, scree_rolling_laws[k]->text.formula);
    printf("`scree laws NAME` tells more.\n");
}

int cli_laws(int count, char **words) {
    static const struct cli_option options[] = {{0}};
    int code = cli_parse(&count, words, options, help);
    if (code) return code < 0 ? EXIT_GOOD : code;
    if (count == 0) print_list();
    for (int n = 0; n < count; n++) {
        int normal = scree_find_normal_law(words[n]), friction = scree_find_friction_law(words[n]);
        if (normal >= 0) print_normal(scree_normal_laws[normal]);
        int rolling = scree_find_rolling_law(words[n]);
        if (friction >= 0)
            print_text(&scree_friction_laws[friction]->text, "friction law", scree_friction_laws[friction]->memory);
        if (rolling >= 0)
            print_text(&scree_rolling_laws[rolling]->text, "rolling law", scree_rolling_laws[rolling]->memory);
        if (normal >= 0 || friction >= 0 || rolling >= 0) continue;
        const char *names[128] = {0};
        int found = 0;
        for (int k = 0; scree_normal_laws[k]; k++) names[found++] = scree_normal_laws[k]->text.name;
        for (int k = 0; scree_friction_laws[k]; k++) names[found++] = scree_friction_laws[k]->text.name;
        for (int k = 0; scree_rolling_laws[k]; k++) names[found++] = scree_rolling_laws[k]->text.name;
        return cli_complain("there is no law called \"%s\"%s", words[n], scree_hint(words[n], names).text);
    }
    return EXIT_GOOD;
}
