/* The law catalogue: look-up by name and the checking of parameters. */
#include "contact/catalogue.h"

#include "contact/law_list.h"

#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define ENTRY(word) &scree_normal_##word,
const struct scree_normal_law *const scree_normal_laws[] = {SCREE_NORMAL_LAWS(ENTRY) NULL};
#undef ENTRY
#define ENTRY(word) &scree_friction_##word,
const struct scree_friction_law *const scree_friction_laws[] = {SCREE_FRICTION_LAWS(ENTRY) NULL};
#undef ENTRY
#define ENTRY(word) &scree_rolling_##word,
const struct scree_rolling_law *const scree_rolling_laws[] = {SCREE_ROLLING_LAWS(ENTRY) NULL};
#undef ENTRY

/* What is the same of laws of any kind: their texts, in the order of the lists above. */
enum kind { NORMAL, FRICTION, ROLLING, KINDS };
#define ENTRY(word) &scree_normal_##word.text,
static const struct scree_law_text *const normal_texts[] = {SCREE_NORMAL_LAWS(ENTRY) NULL};
#undef ENTRY
#define ENTRY(word) &scree_friction_##word.text,
static const struct scree_law_text *const friction_texts[] = {SCREE_FRICTION_LAWS(ENTRY) NULL};
#undef ENTRY
#define ENTRY(word) &scree_rolling_##word.text,
static const struct scree_law_text *const rolling_texts[] = {SCREE_ROLLING_LAWS(ENTRY) NULL};
#undef ENTRY
static const struct scree_law_text *const *const texts[] = {normal_texts, friction_texts, rolling_texts};
static const char *const kinds[] = {"normal", "friction", "rolling"};

static int find_law(enum kind kind, const char *name) {
    for (int k = 0; texts[kind][k]; k++)
        if (strcmp(texts[kind][k]->name, name) == 0) return k;
    return -1;
}

int scree_find_normal_law(const char *name) { return find_law(NORMAL, name); }
int scree_find_friction_law(const char *name) { return find_law(FRICTION, name); }
int scree_find_rolling_law(const char *name) { return find_law(ROLLING, name); }

enum { MOST_LAWS = 64 };
_Static_assert(sizeof normal_texts / sizeof *normal_texts <= MOST_LAWS, "more laws than hints reckon with");

static scree_status unknown_law(enum kind kind, const char *name, scree_trouble *trouble) {
    const char *names[MOST_LAWS] = {0};
    for (int k = 0; texts[kind][k]; k++) names[k] = texts[kind][k]->name;
    for (int other = 0; other < KINDS; other++)
        if (find_law((enum kind)other, name) >= 0)
            return scree_report(trouble, SCREE_BAD_INPUT, "law", "\"%s\" is a %s law, no %s law", name, kinds[other],
                                kinds[kind]);
    struct scree_hint hint = scree_hint(name, names);
    return scree_report(trouble, SCREE_BAD_INPUT, "law", "there is no %s law called \"%s\"%s", kinds[kind], name,
                        hint.text[0] ? hint.text : "; `scree laws` lists them");
}

const char *scree_range_text(enum scree_range range) {
    switch (range) {
    case SCREE_ANY_POSITIVE:
        return "> 0";
    case SCREE_NOT_NEGATIVE:
        return ">= 0";
    case SCREE_FRACTION:
        return "> 0 and <= 1";
    case SCREE_AT_LEAST_ONE:
        return ">= 1";
    case SCREE_FROM_ONE_TO_3:
        return ">= 1 and <= 3";
    case SCREE_ZERO_OR_ONE:
        return "0 or 1";
    }
    return "any";
}

static int in_range(double value, enum scree_range range) {
    if (!isfinite(value)) return 0;
    switch (range) {
    case SCREE_ANY_POSITIVE:
        return value > 0.0;
    case SCREE_NOT_NEGATIVE:
        return value >= 0.0;
    case SCREE_FRACTION:
        return value > 0.0 && value <= 1.0;
    case SCREE_AT_LEAST_ONE:
        return value >= 1.0;
    case SCREE_FROM_ONE_TO_3:
        return value >= 1.0 && value <= 3.0;
    case SCREE_ZERO_OR_ONE:
        return value == 0.0 || value == 1.0;
    }
    return 0;
}

static int find_parameter(const struct scree_law_text *text, const char *name) {
    for (int k = 0; text->parameters[k].name; k++)
        if (strcmp(text->parameters[k].name, name) == 0) return k;
    return -1;
}

scree_law_choice scree_example(const struct scree_law_text *text) {
    scree_law_choice choice = {.law = text->name};
    const char *rest = text->example;
    while (rest && choice.settings < SCREE_SETTINGS_MAX) {
        char name[40];
        double value;
        if (sscanf(rest, " %39[a-z_] = %lf", name, &value) != 2) break;
        int index = find_parameter(text, name);
        if (index < 0) break;
        choice.setting[choice.settings++] = (scree_setting){text->parameters[index].name, value};
        rest = strchr(rest, ',');
        if (rest) rest++;
    }
    return choice;
}

/* Whether a symbol of the formula, such as mu_k, is a word of what is said of a parameter. */
static int is_word_of(const char *symbol, const char *meaning) {
    static const char ends[] = " ,:;";
    for (const char *word = meaning; *word; word += strspn(word, ends)) {
        size_t length = strcspn(word, ends);
        if (length == strlen(symbol) && memcmp(word, symbol, length) == 0) return 1;
        word += length;
    }
    return 0;
}

/* The parameter that has it as its symbol, or the nearest name, or else all of them. */
static struct scree_hint hint_at_parameter(const struct scree_law_text *text, const char *wrong) {
    const char *names[SCREE_PARAMETERS + 1] = {0}, *meant = wrong;
    for (int k = 0; text->parameters[k].name; k++) {
        names[k] = text->parameters[k].name;
        if (meant == wrong && is_word_of(wrong, text->parameters[k].meaning)) meant = names[k];
    }
    return scree_hint_or_all(meant, names);
}

static scree_status read_settings(const struct scree_law_text *text, const scree_law_choice *choice,
                                  struct scree_values *values, scree_trouble *trouble) {
    if (choice->settings < 0 || choice->settings > SCREE_SETTINGS_MAX)
        return scree_report(trouble, SCREE_BAD_INPUT, NULL,
                            "the law \"%s\" is given %d parameters; 0 to %d are possible", text->name, choice->settings,
                            SCREE_SETTINGS_MAX);
    for (int k = 0; k < choice->settings; k++) {
        const scree_setting *setting = &choice->setting[k];
        if (!setting->name)
            return scree_report(trouble, SCREE_BAD_INPUT, NULL, "parameter %d of the law \"%s\" has no name", k + 1,
                                text->name);
        int index = find_parameter(text, setting->name);
        if (index < 0)
            return scree_report(trouble, SCREE_BAD_INPUT, setting->name, "the law \"%s\" has no parameter \"%s\"%s",
                                text->name, setting->name, hint_at_parameter(text, setting->name).text);
        const struct scree_parameter *parameter = &text->parameters[index];
        if (!isnan(values->v[index]))
            return scree_report(trouble, SCREE_BAD_INPUT, setting->name, "%s of the law \"%s\" is given twice",
                                parameter->name, text->name);
        if (!in_range(setting->value, parameter->range))
            return scree_report(
                trouble, SCREE_BAD_INPUT, setting->name, "%s of the law \"%s\" (%s) must be %s, got %g%s%s",
                parameter->name, text->name, parameter->meaning, scree_range_text(parameter->range), setting->value,
                strcmp(parameter->unit, "1") ? " " : "", strcmp(parameter->unit, "1") ? parameter->unit : "");
        values->v[index] = setting->value;
    }
    return SCREE_OK;
}

struct scree_elastic scree_elastic_of(const double young[2], const double poisson[2]) {
    double soft = 0.0, yielding = 0.0;
    for (int k = 0; k < 2; k++) {
        if (!(young[k] > 0.0)) return (struct scree_elastic){0.0, 0.0};
        double shear = young[k] / (2.0 * (1.0 + poisson[k]));
        soft += (1.0 - poisson[k] * poisson[k]) / young[k];
        yielding += (2.0 - poisson[k]) / shear;
    }
    if (soft == 0.0) return (struct scree_elastic){0.0, 0.0}; /* two rigid bodies have no contact stiffness */
    return (struct scree_elastic){1.0 / soft, 1.0 / yielding};
}

/* Whether a parameter is given that stands instead of parameter `index`. */
static int replaced(const struct scree_law_text *text, const struct scree_values *values, int index) {
    for (int k = 0; text->parameters[k].name; k++) {
        const char *other = text->parameters[k].instead_of;
        if (other && strcmp(other, text->parameters[index].name) == 0 && !isnan(values->v[k])) return 1;
    }
    return 0;
}

/* Parameters that weren't given, from the materials. */
static void take_from_materials(const struct scree_law_text *text, const struct scree_elastic *elastic,
                                struct scree_values *values) {
    for (int k = 0; text->parameters[k].name; k++) {
        if (replaced(text, values, k)) continue;
        enum scree_material_value from = text->parameters[k].material;
        double value = !elastic || from == SCREE_FROM_CONTACT ? 0.0
                       : from == SCREE_FROM_MODULUS           ? elastic->modulus
                                                              : elastic->shear;
        if (isnan(values->v[k]) && value > 0.0) values->v[k] = value;
    }
}

/* Every parameter that the law needs is there, and none that another one excludes. */
static scree_status check_complete(const struct scree_law_text *text, struct scree_values *values,
                                   scree_trouble *trouble) {
    for (int k = 0; text->parameters[k].name; k++) {
        const struct scree_parameter *parameter = &text->parameters[k];
        if (parameter->instead_of) {
            int other = find_parameter(text, parameter->instead_of);
            int both = !isnan(values->v[k]) && !isnan(values->v[other]);
            int neither = isnan(values->v[k]) && isnan(values->v[other]);
            if (both || neither)
                return scree_report(
                    trouble, SCREE_BAD_INPUT, both ? parameter->name : NULL,
                    "the law \"%s\" takes either %s (%s) or %s%s, %s", text->name, parameter->name, parameter->meaning,
                    parameter->instead_of,
                    neither && text->parameters[other].material ? " (or `young` and `poisson` of both materials)" : "",
                    both ? "not both" : "and neither is given");
            continue;
        }
        if (!isnan(values->v[k])) continue;
        if (parameter->optional) {
            values->v[k] = parameter->fallback;
            continue;
        }
        int alternative = 0; /* named by another parameter's instead_of, so checked there */
        for (int p = 0; text->parameters[p].name; p++)
            alternative |=
                text->parameters[p].instead_of && strcmp(text->parameters[p].instead_of, parameter->name) == 0;
        if (!alternative && parameter->material)
            return scree_report(trouble, SCREE_BAD_INPUT, NULL,
                                "the law \"%s\" needs %s (%s, in %s, %s), or `young` and `poisson` of both materials",
                                text->name, parameter->name, parameter->meaning, parameter->unit,
                                scree_range_text(parameter->range));
        if (!alternative)
            return scree_report(trouble, SCREE_BAD_INPUT, NULL, "the law \"%s\" needs %s (%s, in %s, %s)", text->name,
                                parameter->name, parameter->meaning, parameter->unit,
                                scree_range_text(parameter->range));
    }
    return SCREE_OK;
}

static scree_status read_values(const struct scree_law_text *text, const scree_law_choice *choice,
                                const struct scree_elastic *elastic, double share, struct scree_values *values,
                                scree_trouble *trouble) {
    for (int k = 0; k < SCREE_PARAMETERS; k++) values->v[k] = NAN;
    scree_status status = read_settings(text, choice, values, trouble);
    take_from_materials(text, elastic, values);
    if (!status) status = check_complete(text, values, trouble);
    if (status) return status;
    for (int k = 0; text->parameters[k].name; k++)
        if (text->parameters[k].shared) values->v[k] /= share;
    return SCREE_OK;
}

/* A copy of a force table in one piece of memory, its forces divided by `share`; NULL if there is no memory. */
static struct scree_force_table *copy_table(const struct scree_force_table *t, double share) {
    if (t->overlaps < 1 || t->speeds < 1) return calloc(1, sizeof(struct scree_force_table));
    size_t overlaps = (size_t)t->overlaps, speeds = (size_t)t->speeds;
    struct scree_force_table *copy = malloc(sizeof *copy + (overlaps + speeds + overlaps * speeds) * sizeof(double));
    if (!copy) return NULL;
    double *data = (double *)(copy + 1), *force = data + overlaps + speeds;
    memcpy(data, t->overlap, overlaps * sizeof *data);
    memcpy(data + overlaps, t->speed, speeds * sizeof *data);
    for (size_t k = 0; k < overlaps * speeds; k++) force[k] = t->force[k] / share;
    *copy = (struct scree_force_table){t->overlaps, t->speeds, data, data + overlaps, force};
    return copy;
}

void scree_free_rule(struct scree_rule *rule) {
    free((void *)(uintptr_t)rule->normal_constants.table);
    rule->normal_constants.table = NULL;
}

/* Which law it is, and the values of its parameters. */
static scree_status look_up(enum kind kind, const scree_law_choice *choice, const struct scree_elastic *elastic,
                            double share, int *law, struct scree_values *values, scree_trouble *trouble) {
    *law = find_law(kind, choice->law);
    if (*law < 0) return unknown_law(kind, choice->law, trouble);
    return read_values(texts[kind][*law], choice, elastic, share, values, trouble);
}

static scree_status bake_normal(const scree_law_choice *choice, const struct scree_elastic *elastic,
                                struct scree_rule *rule, scree_trouble *trouble) {
    struct scree_values values;
    if (!choice->law || !choice->law[0])
        return scree_report(trouble, SCREE_BAD_INPUT, NULL, "a contact needs a normal law, or none = true");
    scree_status status = look_up(NORMAL, choice, elastic, rule->share, &rule->normal, &values, trouble);
    return status ? status : scree_normal_laws[rule->normal]->bake(&values, &rule->normal_constants, trouble);
}

static scree_status bake_friction(const scree_law_choice *choice, const struct scree_elastic *elastic,
                                  struct scree_rule *rule, scree_trouble *trouble) {
    struct scree_values values;
    scree_status status = look_up(FRICTION, choice, elastic, rule->share, &rule->friction, &values, trouble);
    return status ? status : scree_friction_laws[rule->friction]->bake(&values, &rule->friction_constants, trouble);
}

static scree_status bake_rolling(const scree_law_choice *choice, const struct scree_elastic *elastic,
                                 struct scree_rule *rule, scree_trouble *trouble) {
    struct scree_values values;
    scree_status status = look_up(ROLLING, choice, elastic, rule->share, &rule->rolling, &values, trouble);
    return status ? status : scree_rolling_laws[rule->rolling]->bake(&values, &rule->rolling_constants, trouble);
}

static int is_chosen(const scree_law_choice *choice) { return choice->law && choice->law[0]; }

/* Say in which part of the definition the field of the trouble stands. */
static scree_status within(const char *part, scree_status status, scree_trouble *trouble) {
    if (!status || !trouble) return status;
    char field[sizeof trouble->field];
    snprintf(field, sizeof field, "%s%s%.40s", part, trouble->field[0] ? "." : "", trouble->field);
    memcpy(trouble->field, field, sizeof field);
    return status;
}

static scree_status bake_laws(const scree_contact_def *def, const struct scree_elastic *elastic,
                              struct scree_rule *rule, scree_trouble *trouble) {
    int needs_normal = !def->none || is_chosen(&def->normal);
    scree_status status =
        needs_normal ? within("normal", bake_normal(&def->normal, elastic, rule, trouble), trouble) : SCREE_OK;
    if (!status && is_chosen(&def->friction))
        status = within("friction", bake_friction(&def->friction, elastic, rule, trouble), trouble);
    if (!status && is_chosen(&def->rolling))
        status = within("rolling", bake_rolling(&def->rolling, elastic, rule, trouble), trouble);
    return status;
}

scree_status scree_bake_rule(const scree_contact_def *def, const struct scree_elastic *elastic, struct scree_rule *rule,
                             scree_trouble *trouble) {
    const struct scree_rule nothing = {
        .material = {def->between[0], def->between[1]}, .friction = -1, .rolling = -1, .share = 1.0};
    *rule = nothing;
    if (def->shared_by < 0)
        return scree_report(trouble, SCREE_BAD_INPUT, "shared_by", "shared_by must be a positive count, got %d",
                            def->shared_by);
    rule->share = def->shared_by ? def->shared_by : 1;
    rule->corners = def->corners != 0;
    if (def->table && (!def->normal.law || strcmp(def->normal.law, "table") != 0))
        return scree_report(trouble, SCREE_BAD_INPUT, "normal", "measured forces go with the law \"table\" only");
    if (def->table && !(def->table->overlap && def->table->speed && def->table->force))
        return scree_report(trouble, SCREE_BAD_INPUT, "table", "a force table needs overlaps, speeds and forces");
    if (def->table) {
        rule->normal_constants.table = copy_table(def->table, rule->share);
        if (!rule->normal_constants.table)
            return scree_report(trouble, SCREE_NO_MEMORY, "table", "no memory for a force table");
    }
    scree_status status = bake_laws(def, elastic, rule, trouble);
    if (status || def->none) scree_free_rule(rule);
    if (def->none) *rule = nothing; /* laws beside it have been looked at all the same */
    rule->touches = !def->none;
    return status;
}

static double coefficient_at(const struct scree_friction_law *law, const struct scree_law_constants *constants,
                             double speed) {
    struct scree_sliding at = {.normal = 1.0, .velocity = {speed, 0.0, 0.0}};
    return -law->force(constants, (struct scree_pair_constants){{0.0}}, at).force.x;
}

double scree_largest_coefficient(const struct scree_friction_law *law, const struct scree_law_constants *constants) {
    const double pace = 1.01, from = 1e-3 / law->slope(constants);
    double speed = from, largest = 0.0;
    for (; speed < 1e7 * from; speed *= pace) {
        double next = coefficient_at(law, constants, speed);
        if (next < largest) break;
        largest = next;
    }
    /* The top is within a pace of the last but one speed: a search by thirds. */
    double low = speed / (pace * pace), high = speed;
    for (int k = 0; k < 200; k++) {
        double a = low + (high - low) / 3.0, b = high - (high - low) / 3.0;
        if (coefficient_at(law, constants, a) < coefficient_at(law, constants, b))
            low = a;
        else
            high = b;
    }
    return fmax(largest, coefficient_at(law, constants, high));
}

double scree_creep_speed(const struct scree_friction_law *law, const struct scree_law_constants *constants,
                         double load_over_normal) {
    if (law->memory || law->slope(constants) == 0.0) return 0.0;
    /* The coefficient rises from 0: walk up until it is enough, then bisect. */
    double low = 0.0, high = 1e-6 * load_over_normal / law->slope(constants);
    int walks = 0;
    for (; coefficient_at(law, constants, high) < load_over_normal; high *= 1.1) {
        if (walks++ == 250) return HUGE_VAL; /* 2e4 times the ramp: the load is more than friction can hold */
        low = high;
    }
    for (int k = 0; k < 100; k++) {
        double middle = 0.5 * (low + high);
        if (coefficient_at(law, constants, middle) < load_over_normal)
            low = middle;
        else
            high = middle;
    }
    return high;
}
