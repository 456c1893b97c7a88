/* Laws and bodies in one word of a command line. */
#include "engine/cli/words.h"

#include <stdlib.h>
#include <string.h>

static scree_status read_setting(struct words *words, char *word, const char *option, scree_trouble *trouble) {
    char *equals = strchr(word, '='), *end = NULL;
    if (!equals || equals == word || !equals[1])
        return scree_report(trouble, SCREE_BAD_INPUT, option, "%s \"%s …\": expected NAME=NUMBER, got \"%s\"", option,
                            words->name, word);
    *equals = '\0';
    double value = strtod(equals + 1, &end);
    if (*end || isnan(value))
        return scree_report(trouble, SCREE_BAD_INPUT, option, "%s \"%s …\": %s takes a number, not \"%s\"", option,
                            words->name, word, equals + 1);
    if (isinf(value) && strcmp(word, "young") != 0) /* inf: rigid */
        return scree_report(trouble, SCREE_BAD_INPUT, option, "%s \"%s …\": %s takes a finite number, not \"%s\"",
                            option, words->name, word, equals + 1);
    for (int k = 0; k < words->settings; k++)
        if (strcmp(words->setting[k].name, word) == 0)
            return scree_report(trouble, SCREE_BAD_INPUT, option, "%s \"%s …\": %s is given twice", option, words->name,
                                word);
    if (words->settings == WORDS_SETTINGS)
        return scree_report(trouble, SCREE_BAD_INPUT, option, "%s \"%s …\" has more than %d settings", option,
                            words->name, WORDS_SETTINGS);
    words->setting[words->settings++] = (scree_setting){word, value};
    return SCREE_OK;
}

scree_status words_read(struct words *words, const char *text, const char *option, scree_trouble *trouble) {
    *words = (struct words){.name = NULL};
    if (strlen(text) >= sizeof words->text)
        return scree_report(trouble, SCREE_BAD_INPUT, option, "%s is given more than %d characters", option,
                            WORDS_LENGTH - 1);
    strcpy(words->text, text);
    char *rest = NULL;
    for (char *word = strtok_r(words->text, " ,\t\n", &rest); word; word = strtok_r(NULL, " ,\t\n", &rest)) {
        if (!words->name) {
            words->name = word;
            continue;
        }
        scree_status status = read_setting(words, word, option, trouble);
        if (status) return status;
    }
    if (!words->name || strchr(words->name, '='))
        return scree_report(trouble, SCREE_BAD_INPUT, option,
                            "%s takes a name and settings, as in \"NAME key=1.5 other=2\", not \"%s\"", option, text);
    return SCREE_OK;
}

scree_status words_with(const struct words *words, const char *key, double value, struct words *changed,
                        scree_trouble *trouble) {
    *changed = *words;
    for (int k = 0; k < changed->settings; k++)
        if (strcmp(changed->setting[k].name, key) == 0) {
            changed->setting[k].value = value;
            return SCREE_OK;
        }
    if (changed->settings == WORDS_SETTINGS)
        return scree_report(trouble, SCREE_BAD_INPUT, key, "\"%s …\" has more than %d settings", words->name,
                            WORDS_SETTINGS);
    changed->setting[changed->settings++] = (scree_setting){key, value};
    return SCREE_OK;
}

scree_status words_law(const struct words *words, scree_law_choice *choice, scree_trouble *trouble) {
    *choice = (scree_law_choice){.law = words->name};
    if (words->settings > SCREE_SETTINGS_MAX)
        return scree_report(trouble, SCREE_BAD_INPUT, NULL,
                            "the law \"%s\" is given %d parameters; 0 to %d are possible", words->name, words->settings,
                            SCREE_SETTINGS_MAX);
    choice->settings = words->settings;
    memcpy(choice->setting, words->setting, sizeof(scree_setting) * (size_t)words->settings);
    return SCREE_OK;
}

/* ---- bodies ---- */

enum { RADIUS, X, Y, Z, ROUNDING, MASS, DENSITY, TILT_X, TILT_Y, YOUNG, POISSON, KEYS };

static const char *const keys[KEYS] = {"radius",  "x",      "y",      "z",     "rounding", "mass",
                                       "density", "tilt_x", "tilt_y", "young", "poisson"};

/* Which keys a shape takes. */
enum { TAKEN = 1, NEEDED };
static const struct {
    const char *name;
    scree_shape_kind kind;
    int takes[KEYS];
} shapes[] = {
    {"sphere",
     SCREE_SPHERE,
     {[RADIUS] = NEEDED, [MASS] = TAKEN, [DENSITY] = TAKEN, [YOUNG] = TAKEN, [POISSON] = TAKEN}},
    {"box",
     SCREE_BOX,
     {[X] = NEEDED,
      [Y] = NEEDED,
      [Z] = NEEDED,
      [ROUNDING] = TAKEN,
      [MASS] = TAKEN,
      [DENSITY] = TAKEN,
      [TILT_X] = TAKEN,
      [TILT_Y] = TAKEN,
      [YOUNG] = TAKEN,
      [POISSON] = TAKEN}},
    {"plane", SCREE_PLANE, {[YOUNG] = TAKEN, [POISSON] = TAKEN}},
};

enum { SHAPES = sizeof shapes / sizeof shapes[0] };

static scree_status read_keys(const struct words *words, const char *option, const int takes[KEYS], double value[KEYS],
                              scree_trouble *trouble) {
    const char *names[KEYS + 1] = {0};
    int count = 0;
    for (int k = 0; k < KEYS; k++) {
        value[k] = NAN;
        if (takes[k]) names[count++] = keys[k];
    }
    for (int s = 0; s < words->settings; s++) {
        int key = 0;
        while (key < KEYS && !(takes[key] && strcmp(keys[key], words->setting[s].name) == 0)) key++;
        if (key == KEYS)
            return scree_report(trouble, SCREE_BAD_INPUT, option, "%s: a %s has no \"%s\"%s", option, words->name,
                                words->setting[s].name, scree_hint_or_all(words->setting[s].name, names).text);
        value[key] = words->setting[s].value;
    }
    for (int k = 0; k < KEYS; k++)
        if (takes[k] == NEEDED && isnan(value[k]))
            return scree_report(trouble, SCREE_BAD_INPUT, option, "%s: a %s needs %s= (m)", option, words->name,
                                keys[k]);
    return SCREE_OK;
}

static double or_else(double value, double fallback) { return isnan(value) ? fallback : value; }

static scree_status read_mass(const char *option, const char *name, const double value[KEYS], struct words_body *body,
                              scree_trouble *trouble) {
    double mass = value[MASS], density = value[DENSITY];
    if (isnan(mass) == isnan(density))
        return scree_report(trouble, SCREE_BAD_INPUT, option, "%s: a %s takes either mass (kg) or density (kg/m^3), %s",
                            option, name, isnan(mass) ? "and neither is given" : "not both");
    body->mass = isnan(mass) ? density * scree_shape_volume(&body->shape) : mass;
    if (body->mass > 0.0 && isfinite(body->mass)) return SCREE_OK;
    return scree_report(trouble, SCREE_BAD_INPUT, option, "%s: %s must be > 0, got %g", option,
                        isnan(mass) ? "density" : "mass", isnan(mass) ? density : mass);
}

static scree_status read_material(const char *option, const double value[KEYS], struct words_body *body,
                                  scree_trouble *trouble) {
    /* A plane of which nothing is said is rigid. */
    body->young = or_else(value[YOUNG], body->shape.kind == SCREE_PLANE ? HUGE_VAL : 0.0);
    body->poisson = or_else(value[POISSON], 0.0);
    if (isnan(value[YOUNG]) != isnan(value[POISSON]) && value[YOUNG] != HUGE_VAL)
        return scree_report(trouble, SCREE_BAD_INPUT, option, "%s: young and poisson are given together", option);
    if (!isnan(value[YOUNG]) && !(body->young > 0.0))
        return scree_report(trouble, SCREE_BAD_INPUT, option, "%s: young must be > 0 (inf: rigid), got %g Pa", option,
                            body->young);
    if (!(body->poisson > -1.0 && body->poisson <= 0.5))
        return scree_report(trouble, SCREE_BAD_INPUT, option, "%s: poisson must be > -1 and <= 0.5, got %g", option,
                            body->poisson);
    return SCREE_OK;
}

/* Turned about the body's own y axis, then about the world's x axis, in degrees. */
static struct quat tilted(double x, double y) {
    double half = 3.14159265358979323846 / 360.0;
    struct quat about_x = {cos(half * x), sin(half * x), 0.0, 0.0}, about_y = {cos(half * y), 0.0, sin(half * y), 0.0};
    return quat_multiply(about_x, about_y);
}

scree_status words_body(const struct words *words, const char *option, struct words_body *body,
                        scree_trouble *trouble) {
    const char *names[SHAPES + 1] = {0};
    int shape = 0;
    for (int k = 0; k < SHAPES; k++) names[k] = shapes[k].name;
    while (shape < SHAPES && strcmp(shapes[shape].name, words->name) != 0) shape++;
    if (shape == SHAPES)
        return scree_report(trouble, SCREE_BAD_INPUT, option, "%s: there is no shape \"%s\" (sphere, box, plane)%s",
                            option, words->name, scree_hint(words->name, names).text);
    double value[KEYS];
    scree_status status = read_keys(words, option, shapes[shape].takes, value, trouble);
    if (status) return status;
    *body = (struct words_body){.attitude = tilted(or_else(value[TILT_X], 0.0), or_else(value[TILT_Y], 0.0))};
    body->shape = (scree_shape){.kind = shapes[shape].kind,
                                .radius = or_else(value[RADIUS], 0.0),
                                .edge = {or_else(value[X], 0.0), or_else(value[Y], 0.0), or_else(value[Z], 0.0)},
                                .rounding = or_else(value[ROUNDING], 0.0)};
    status = read_material(option, value, body, trouble);
    if (status || body->shape.kind == SCREE_PLANE) return status;
    scree_trouble inner = {0};
    if (scree_shape_check(&body->shape, &inner))
        return scree_report(trouble, SCREE_BAD_INPUT, option, "%s: %s", option, inner.text);
    return read_mass(option, words->name, value, body, trouble);
}
