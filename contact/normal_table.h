/* A law by measurement: force over overlap and closing speed on a grid, straight between its points.
 *   F = F0(d) + [F(d, u) - F0(d)],  F0(d) = F(d, 0) is stored and given back, the rest is lost
 * Beyond the last overlap F0 goes on as straight as between the last two, and the rest stays as it is there; beyond the
 * speeds the force stays as at the last. It never pulls. Tables whose rest would give energy are refused. */
#ifndef SCREE_CONTACT_NORMAL_TABLE_H
#define SCREE_CONTACT_NORMAL_TABLE_H

#include "contact/law.h"

static const struct scree_parameter table_parameters[] = {{0}};

/* The interval of rising `x` (count >= 2) that holds `at`, and how far along it `at` is: 0 … 1 inside, beyond
 * outside. */
static inline int table_interval(int count, const double *x, double at, double *share) {
    int low = 0, high = count - 1;
    while (high - low > 1) {
        int middle = (low + high) / 2;
        if (at >= x[middle])
            low = middle;
        else
            high = middle;
    }
    *share = (at - x[low]) / (x[low + 1] - x[low]);
    return low;
}

/* Force of one column of speeds at an overlap. */
static inline double table_column(const struct scree_force_table *t, int row, double share, int speed) {
    double low = t->force[row * t->speeds + speed], high = t->force[(row + 1) * t->speeds + speed];
    return low + share * (high - low);
}

static inline int table_rest(const struct scree_force_table *t) {
    int rest = 0;
    while (rest < t->speeds - 1 && t->speed[rest] < 0.0) rest++;
    return rest;
}

static inline struct scree_normal_force normal_table_force(const struct scree_law_constants *law,
                                                           struct scree_pair_constants pair, struct scree_pressing at) {
    (void)pair;
    const struct scree_force_table *t = law->table;
    double share, fraction = 0.0, overlap = at.overlap > 0.0 ? at.overlap : 0.0;
    int row = table_interval(t->overlaps, t->overlap, overlap, &share), rest = table_rest(t);
    double still = table_column(t, row, share, rest);
    if (t->speeds == 1 || at.closing == 0.0) return (struct scree_normal_force){still, 0.0, still, 0.0, 0.0};
    /* Beyond the last overlap only the spring goes on: a dashpot that fades would turn into a drive. */
    double within = share < 1.0 ? share : 1.0;
    int column = table_interval(t->speeds, t->speed, at.closing, &fraction);
    double low = table_column(t, row, within, column), high = table_column(t, row, within, column + 1);
    double clamped = fraction < 0.0 ? 0.0 : fraction > 1.0 ? 1.0 : fraction;
    double added = low + clamped * (high - low) - table_column(t, row, within, rest);
    /* Beside rest the dashpot is the slope: over next to no speed it would be made of rounding. */
    double from = t->speed[column], to = t->speed[column + 1];
    int beside = (from == 0.0 || to == 0.0) && clamped == fraction;
    double damping = beside ? (high - low) / (to - from) : added / at.closing;
    return (struct scree_normal_force){still, damping, still, 0.0, 0.0};
}

static inline double normal_table_stored(const struct scree_law_constants *law, struct scree_pair_constants pair,
                                         struct scree_pressing at) {
    (void)pair;
    const struct scree_force_table *t = law->table;
    double share, energy = 0.0;
    int row = table_interval(t->overlaps, t->overlap, at.overlap, &share), rest = table_rest(t);
    for (int k = 0; k < row; k++)
        energy += 0.5 * (t->overlap[k + 1] - t->overlap[k]) *
                  (t->force[k * t->speeds + rest] + t->force[(k + 1) * t->speeds + rest]);
    double from = t->force[row * t->speeds + rest];
    return energy + 0.5 * (at.overlap - t->overlap[row]) * (from + table_column(t, row, share, rest));
}

static inline scree_status table_check(const struct scree_force_table *t, scree_trouble *trouble) {
    int rest = table_rest(t);
    if (t->speed[rest] != 0.0)
        return scree_report(trouble, SCREE_BAD_INPUT, "table",
                            "a force table needs the closing speed 0 among its speeds");
    for (int k = 0; k < t->overlaps; k++) {
        double still = t->force[k * t->speeds + rest];
        if (!(k == 0 ? t->overlap[0] == 0.0 && still == 0.0 : t->overlap[k] > t->overlap[k - 1]))
            return scree_report(trouble, SCREE_BAD_INPUT, "table",
                                k ? "the overlaps of a force table must rise: %g m after %g m"
                                  : "a force table must begin at overlap 0 with force 0 at rest, not at %g m with %g N",
                                t->overlap[k], k ? t->overlap[k - 1] : still);
        for (int s = 0; s < t->speeds; s++) {
            double force = t->force[k * t->speeds + s], speed = t->speed[s];
            if (!isfinite(force) || !isfinite(t->overlap[k]) || (s && !(speed > t->speed[s - 1])))
                return scree_report(trouble, SCREE_BAD_INPUT, "table",
                                    "a force table must hold finite numbers and rising speeds: look at overlap %g m, "
                                    "speed %g m/s",
                                    t->overlap[k], speed);
            if ((speed > 0.0 && force < still) || (speed < 0.0 && force > still))
                return scree_report(
                    trouble, SCREE_BAD_INPUT, "table",
                    "at overlap %g m the force of %g N at a closing speed of %g m/s would give energy: at "
                    "rest it is %g N",
                    t->overlap[k], force, speed, still);
        }
    }
    return SCREE_OK;
}

static inline scree_status normal_table_bake(const struct scree_values *values, struct scree_law_constants *law,
                                             scree_trouble *trouble) {
    (void)values;
    if (law->table && law->table->overlaps >= 2 && law->table->speeds >= 1) return table_check(law->table, trouble);
    return scree_report(trouble, SCREE_BAD_INPUT, "table",
                        "the law \"table\" needs measured forces: rows = [[overlap, force], …] or file = \"….csv\"");
}

/* Where another interval of the table begins, or the table ends. */
static inline int normal_table_bends(const struct scree_law_constants *law, struct scree_pair_constants pair,
                                     struct scree_pressing from, struct scree_pressing to) {
    (void)pair;
    const struct scree_force_table *t = law->table;
    double share;
    if (table_interval(t->overlaps, t->overlap, from.overlap, &share) !=
        table_interval(t->overlaps, t->overlap, to.overlap, &share))
        return 1;
    if (t->speeds == 1) return 0;
    if (scree_between(from.overlap, to.overlap, t->overlap[t->overlaps - 1])) return 1;
    if (table_interval(t->speeds, t->speed, from.closing, &share) !=
        table_interval(t->speeds, t->speed, to.closing, &share))
        return 1;
    return scree_between(from.closing, to.closing, t->speed[0]) ||
           scree_between(from.closing, to.closing, t->speed[t->speeds - 1]);
}

static const struct scree_normal_law scree_normal_table = {
    .text =
        {.name = "table",
         .formula = "F(d, u) straight between the points of a table",
         .source = "measurements of the user",
         .note =
             "rows = [[d, F], …] or [[d, u, F], …], or file = \"….csv\" with the columns overlap_m, force_N and, if "
             "wanted, closing_m_s: every overlap with every speed, 0 among them. What depends on the speed is lost, "
             "the rest is stored. Beyond the last overlap the force at rest goes on as straight as before it, and what "
             "the speed adds stays; beyond the speeds the force stays. Stays scalar: a search in the table takes a "
             "branch.",
         .parameters = table_parameters,
         .example = "rows = [[0, -1, 0], [0, 0, 0], [0, 1, 20], [1e-4, -1, 2], [1e-4, 0, 6], [1e-4, 1, 26], [1e-3, -1, "
                    "60], [1e-3, 0, 100], [1e-3, 1, 120]]"},
    .cut = 1,
    .bake = normal_table_bake,
    .pair = scree_any_pair,
    .force = normal_table_force,
    .stored = normal_table_stored,
    .bends = normal_table_bends,
};

#endif
