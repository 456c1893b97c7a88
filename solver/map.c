/* Characteristic map: knots in order of speed, blended between neighbours, placed where the error is largest. */
#include "solver/map.h"

#include <math.h>
#include <string.h>

const char *const scree_map_names[SCREE_MAP_WEIGHTS] = {"1/n^2", "1/n", "n"};

const char *scree_map_text(enum scree_map_state state) {
    static const char *const texts[] = {"good",
                                        "the operating speed is outside of the map's knots",
                                        "the map has no knots",
                                        "no room for more knots before the error bound is met",
                                        "a knot has no admissible plan",
                                        "the range of speeds, the bound or the capacity makes no sense"};
    return texts[state];
}

/* Values of a plan, as a knot. */
static scree_map_knot knot_of(const scree_plan *plan) {
    scree_map_knot knot = {.cycles = plan->cycles};
    double T = plan->duration;
    for (int k = 0; k < 3; k++) {
        knot.fractions[k] = plan->time[1 + k] / T;
        knot.v[k] = plan->event[1 + k].v * T;
        knot.a[k] = plan->event[1 + k].a * T * T;
    }
    return knot;
}

enum scree_map_state scree_map_add(scree_map *map, const scree_plan *plan) {
    if (plan->state != SCREE_PLAN_GOOD) return SCREE_MAP_BAD_PLAN;
    int place = 0;
    while (place < map->count && map->knots[place].cycles < plan->cycles) place++;
    int known = place < map->count && map->knots[place].cycles == plan->cycles;
    if (!known && map->count == map->capacity) return SCREE_MAP_FULL;
    if (map->count == 0) {
        map->stroke = plan->event[4].x;
        map->share = plan->duration * plan->cycles / 60.0;
    }
    if (!known) {
        memmove(&map->knots[place + 1], &map->knots[place], (size_t)(map->count - place) * sizeof *map->knots);
        map->count++;
    }
    map->knots[place] = knot_of(plan);
    return SCREE_MAP_GOOD;
}

static double variable(enum scree_map_weight weight, double cycles) {
    return weight == SCREE_MAP_LINEAR ? cycles : weight == SCREE_MAP_INVERSE ? 1.0 / cycles : 1.0 / (cycles * cycles);
}

/* Comb's travel of a knot, m. */
static double travel(const scree_map_knot *knot) {
    double f[5] = {0.0, knot->fractions[0], knot->fractions[1], knot->fractions[2], 1.0}, sum = 0.0;
    for (int k = 0; k < 4; k++) {
        double d = f[k + 1] - f[k], va = k ? knot->v[k - 1] : 0.0, vb = k < 3 ? knot->v[k] : 0.0;
        double aa = k ? knot->a[k - 1] : 0.0, ab = k < 3 ? knot->a[k] : 0.0;
        sum += 0.5 * d * (va + vb) + 0.1 * d * d * (aa - ab);
    }
    return sum;
}

enum scree_map_state scree_map_blend(const scree_map *map, double cycles, scree_map_knot *blend) {
    if (map->count == 0) return SCREE_MAP_EMPTY;
    const scree_map_knot *knots = map->knots;
    if (!(cycles >= knots[0].cycles && cycles <= knots[map->count - 1].cycles)) return SCREE_MAP_OUTSIDE;
    int k = 0;
    while (k < map->count - 2 && cycles > knots[k + 1].cycles) k++;
    const scree_map_knot *low = &knots[k], *high = &knots[map->count > 1 ? k + 1 : k];
    double from = variable(map->weight, low->cycles), to = variable(map->weight, high->cycles);
    double w = low == high ? 0.0 : (variable(map->weight, cycles) - from) / (to - from);
    *blend = (scree_map_knot){.cycles = cycles};
    int same = 1;
    for (int i = 0; i < 3; i++) {
        same &= low->fractions[i] == high->fractions[i];
        blend->fractions[i] = same ? low->fractions[i] : (1.0 - w) * low->fractions[i] + w * high->fractions[i];
        blend->v[i] = (1.0 - w) * low->v[i] + w * high->v[i];
        blend->a[i] = (1.0 - w) * low->a[i] + w * high->a[i];
    }
    double factor = same ? 1.0 : map->stroke / travel(blend);
    for (int i = 0; i < 3; i++) {
        blend->v[i] *= factor;
        blend->a[i] *= factor;
    }
    return SCREE_MAP_GOOD;
}

enum scree_map_state scree_map_profile(const scree_map *map, double cycles, struct scree_profile *profile) {
    scree_map_knot blend;
    enum scree_map_state state = scree_map_blend(map, cycles, &blend);
    if (state) return state;
    double T = 60.0 * map->share / cycles, time[5] = {0.0, 0.0, 0.0, 0.0, T}, v[3], a[3];
    for (int k = 0; k < 3; k++) {
        time[1 + k] = blend.fractions[k] * T;
        v[k] = blend.v[k] / T;
        a[k] = blend.a[k] / (T * T);
    }
    *profile = scree_plan_profile(time, v, a);
    return SCREE_MAP_GOOD;
}

/* ---- placing knots ---- */

/* Largest |error| at the sample speeds between knot k and the next. */
static void judge(scree_map *map, int k, const scree_map_options *options, scree_map_report *report) {
    scree_map_knot *low = &map->knots[k];
    int samples = options->samples > 0 ? options->samples : 3;
    double wide = map->knots[k + 1].cycles - low->cycles;
    low->error = -1.0;
    for (int i = 1; i <= samples; i++) {
        struct scree_profile profile;
        double cycles = low->cycles + wide * i / (samples + 1), error = HUGE_VAL;
        if (!scree_map_profile(map, cycles, &profile)) error = fabs(options->error(options->context, &profile, cycles));
        report->evaluations++;
        if (!isfinite(error)) error = HUGE_VAL;
        if (error > low->error) {
            low->error = error;
            low->at = cycles;
        }
    }
}

/* The interval with the largest error, by its lower knot. */
static int worst(const scree_map *map) {
    int worst = 0;
    for (int k = 1; k < map->count - 1; k++)
        if (map->knots[k].error > map->knots[worst].error) worst = k;
    return worst;
}

static enum scree_map_state plan_knot(scree_map *map, const scree_transport *transport, const scree_plan_options *plan,
                                      double cycles, scree_map_report *report) {
    if (map->count == map->capacity) return SCREE_MAP_FULL;
    scree_plan_make(transport, cycles, plan, &report->plan);
    return scree_map_add(map, &report->plan);
}

scree_map_report scree_map_place(scree_map *map, const scree_transport *transport, const scree_plan_options *plan,
                                 const scree_map_options *options) {
    scree_map_report report = {.error = HUGE_VAL, .at = options->low};
    int sane = options->low > 0.0 && options->high > options->low && isfinite(options->high) && options->bound > 0.0 &&
               options->error && map->capacity >= 2;
    map->count = 0;
    report.state = sane ? plan_knot(map, transport, plan, options->low, &report) : SCREE_MAP_BAD_INPUT;
    if (!report.state) report.state = plan_knot(map, transport, plan, options->high, &report);
    if (report.state) return report;
    judge(map, 0, options, &report);
    while (!report.state) {
        int k = worst(map);
        report.error = map->knots[k].error;
        report.at = map->knots[k].at;
        if (report.error <= options->bound) return report;
        double low = map->knots[k].cycles, high = map->knots[k + 1].cycles, middle = 0.5 * (low + high);
        if (!(middle > low && middle < high)) {
            report.state = SCREE_MAP_FULL;
            return report;
        }
        report.state = plan_knot(map, transport, plan, middle, &report);
        if (report.state) return report;
        judge(map, k, options, &report);
        judge(map, k + 1, options, &report);
    }
    return report;
}

double scree_map_clearance(void *transport, const struct scree_profile *profile, double cycles) {
    const scree_transport *t = transport;
    (void)cycles;
    double left = scree_slide_detachment(profile, scree_transport_slowing(t));
    return left < 0.0 || left > profile->start[3] ? HUGE_VAL
                                                  : scree_slide_catch(t, profile, left, profile->start[3]).clearance;
}
