/* Asked for and got: inverting laws by trial. */
#include "contact/ask.h"

#include "contact/catalogue.h"

#include <string.h>

/* What a law makes of two bodies of effective mass `mass` (kg) that meet at `speed` (m/s): its closed form if it has
 * one, else the integrator's answer. */
static double delivered_by(const struct scree_normal_law *law, const struct scree_law_constants *constants,
                           struct scree_pair_constants pair, double mass, double speed) {
    if (law->restitution) return law->restitution(constants, pair, mass, speed);
    return scree_impact(law, constants, pair, mass, speed, 0.0, NULL, NULL).restitution;
}

/* Between `low`, with more than wanted, and `high`: regula falsi that halves the weight of an end that stays (Dowell &
 * Jarratt, BIT 11 (1971) 168). */
static double close_in(double (*e)(void *, double), void *context, double wanted, double tolerance, double low,
                       double more, double high, double less) {
    double best = high;
    for (int k = 0, stayed = 0; k < 200; k++) {
        double middle = low + (high - low) * more / (more - less);
        if (!(middle > low && middle < high)) middle = 0.5 * (low + high);
        if (middle == low || middle == high) break;
        double miss = e(context, middle) - wanted;
        best = middle;
        if (fabs(miss) <= tolerance) break;
        if (miss > 0.0) {
            low = middle;
            more = miss;
            if (stayed > 0) less *= 0.5;
            stayed = 1;
        } else {
            high = middle;
            less = miss;
            if (stayed < 0) more *= 0.5;
            stayed = -1;
        }
    }
    return best;
}

double scree_ask_falling(double (*e)(void *context, double value), void *context, double wanted, double guess,
                         double tolerance) {
    if (e(context, 0.0) - wanted <= tolerance) return e(context, 0.0) - wanted < -tolerance ? NAN : 0.0;
    double here = guess, miss = e(context, here) - wanted;
    for (int k = 0; k < 100; k++) {
        double there = miss > 0.0 ? 4.0 * here : 0.25 * here, other = e(context, there) - wanted;
        if (miss > 0.0 && other <= 0.0) return close_in(e, context, wanted, tolerance, here, miss, there, other);
        if (miss <= 0.0 && other > 0.0) return close_in(e, context, wanted, tolerance, there, other, here, miss);
        here = there;
        miss = other;
    }
    return NAN;
}

/* ---- a parameter of a law ---- */

struct question {
    scree_law_choice choice; /* the value asked for is the last setting */
    const struct scree_elastic *elastic;
    const struct scree_wish *wish;
    scree_trouble *trouble;
    scree_status status;
};

/* NAN, and a status in the question, if the law refuses the value. */
static double restitution_of(void *context, double value) {
    struct question *question = context;
    scree_contact_def def = {.normal = question->choice};
    def.normal.setting[def.normal.settings - 1].value = value;
    struct scree_rule rule;
    scree_status status = scree_bake_rule(&def, question->elastic, &rule, question->trouble);
    if (status) {
        question->status = status;
        return NAN;
    }
    const struct scree_normal_law *law = scree_normal_laws[rule.normal];
    const struct scree_wish *wish = question->wish;
    struct scree_pair_constants pair = law->pair(&rule.normal_constants, wish->mass, wish->radius);
    return delivered_by(law, &rule.normal_constants, pair, wish->mass, wish->speed);
}

/* Whether a normal law takes 0 for a parameter, as dashpots do: then there is a restitution of 1 to begin with. */
static int may_vanish(const char *law, const char *parameter) {
    for (int n = 0; law && scree_normal_laws[n]; n++)
        for (const struct scree_parameter *p = scree_normal_laws[n]->text.parameters; p->name; p++)
            if (strcmp(scree_normal_laws[n]->text.name, law) == 0 && strcmp(p->name, parameter) == 0)
                return p->range == SCREE_NOT_NEGATIVE;
    return 1; /* unknown: the law complains */
}

scree_status scree_ask(const scree_law_choice *choice, const struct scree_elastic *elastic, const char *parameter,
                       const struct scree_wish *wish, double *value, scree_trouble *trouble) {
    struct question question = {*choice, elastic, wish, trouble, SCREE_OK};
    if (!(wish->restitution > 0.0 && wish->restitution <= 1.0 && wish->speed > 0.0 && wish->mass > 0.0 &&
          wish->radius >= 0.0 && wish->tolerance >= 0.0))
        return scree_report(trouble, SCREE_BAD_INPUT, NULL,
                            "asked for: 0 < restitution <= 1, speed > 0, mass > 0, radius >= 0 and tolerance >= 0");
    if (choice->settings < 0 || choice->settings >= SCREE_SETTINGS_MAX)
        return scree_report(trouble, SCREE_BAD_INPUT, NULL, "no room for one more parameter beside %d",
                            choice->settings);
    if (!may_vanish(choice->law, parameter))
        return scree_report(trouble, SCREE_BAD_INPUT, parameter,
                            "the %s of the law \"%s\" is no damping that could be chosen for a restitution", parameter,
                            choice->law);
    question.choice.setting[question.choice.settings++] = (scree_setting){parameter, 0.0};
    *value = scree_ask_falling(restitution_of, &question, wish->restitution, 1.0, wish->tolerance);
    if (question.status) return question.status;
    if (!isnan(*value)) return SCREE_OK;
    return scree_report(trouble, SCREE_BAD_INPUT, parameter,
                        "no %s of the law \"%s\" gives a restitution of %g at %g m/s, %g kg", parameter, choice->law,
                        wish->restitution, wish->speed, wish->mass);
}

/* ---- how far a law's own `restitution` goes ---- */

static int is_named(const struct scree_parameter *parameter, const char *name) {
    return parameter->name && strcmp(parameter->name, name) == 0;
}

/* Parameters for a request of `restitution`: 1 where there is no fallback, and nothing that stands instead of another
 * one. */
static scree_law_choice request(const struct scree_normal_law *law, double restitution) {
    scree_law_choice choice = {.law = law->text.name};
    const char *replaced = "";
    for (const struct scree_parameter *p = law->text.parameters; p->name; p++)
        if (is_named(p, "restitution") && p->instead_of) replaced = p->instead_of;
    for (const struct scree_parameter *p = law->text.parameters; p->name; p++) {
        int wanted = is_named(p, "restitution");
        if ((!wanted && p->instead_of) || strcmp(p->name, replaced) == 0) continue;
        if (p->optional && !isnan(p->fallback)) continue;
        choice.setting[choice.settings++] = (scree_setting){p->name, wanted ? restitution : 1.0};
    }
    return choice;
}

static double delivered(const struct scree_normal_law *law, double restitution) {
    scree_contact_def def = {.normal = request(law, restitution)};
    struct scree_rule rule;
    if (scree_bake_rule(&def, NULL, &rule, NULL)) return NAN;
    struct scree_pair_constants pair = law->pair(&rule.normal_constants, 1.0, 1.0);
    return delivered_by(law, &rule.normal_constants, pair, 1.0, 1.0);
}

struct scree_validity scree_validity_of(const struct scree_normal_law *law, double tolerance) {
    struct scree_validity validity = {0};
    for (const struct scree_parameter *p = law->text.parameters; p->name; p++)
        validity.asked |= is_named(p, "restitution");
    if (!validity.asked) return validity;
    int parts = law->restitution ? 1000 : 20; /* integration takes its time */
    for (int k = parts; k >= 1; k--) {
        double e = (double)k / parts, error = fabs(delivered(law, e) - e);
        if (!(error <= tolerance) && validity.from == 0.0) validity.from = (double)(k + 1) / parts;
        if (error <= validity.worst) continue;
        validity.worst = error;
        validity.worst_at = e;
    }
    return validity;
}
