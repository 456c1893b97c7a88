/* Prescribed motions: every kind is baked into polynomial pieces with at most one sine each. */
#include "bodies/motion.h"

#include "bodies/elementary.h"

#include <math.h>
#include <stdlib.h>

static const double two_pi = 6.28318530717958647692;

/* Value of a piece at time t after its start. */
static struct scree_motion_value value_of(const struct scree_motion_piece *piece, double t) {
    const double *c = piece->c;
    struct scree_motion_value value;
    value.position = c[0] + t * (c[1] + t * (c[2] + t * (c[3] + t * (c[4] + t * (c[5] + t * c[6])))));
    value.velocity =
        c[1] + t * (2.0 * c[2] + t * (3.0 * c[3] + t * (4.0 * c[4] + t * 5.0 * c[5] + t * t * 6.0 * c[6])));
    value.acceleration = 2.0 * c[2] + t * (6.0 * c[3] + t * (12.0 * c[4] + t * 20.0 * c[5] + t * t * 30.0 * c[6]));
    if (piece->amplitude != 0.0) {
        double sine, cosine;
        scree_sincos(piece->rate * t + piece->phase, &sine, &cosine);
        value.position += piece->amplitude * sine;
        value.velocity += piece->amplitude * piece->rate * cosine;
        value.acceleration -= piece->amplitude * piece->rate * piece->rate * sine;
    }
    return value;
}

static scree_status check_finite(double value, const char *field, scree_trouble *trouble) {
    if (isfinite(value)) return SCREE_OK;
    return scree_report(trouble, SCREE_BAD_INPUT, field, "%s of a motion must be a finite number", field);
}

static scree_status check_numbers(const scree_motion_def *def, scree_trouble *trouble) {
    const struct {
        const char *field;
        double value;
    } numbers[] = {{"offset", def->offset},       {"start", def->start},   {"duration", def->duration},
                   {"velocity", def->velocity},   {"stroke", def->stroke}, {"amplitude", def->amplitude},
                   {"frequency", def->frequency}, {"phase", def->phase}};
    for (size_t k = 0; k < sizeof numbers / sizeof numbers[0]; k++) {
        scree_status status = check_finite(numbers[k].value, numbers[k].field, trouble);
        if (status) return status;
    }
    if ((int)def->kind < 0 || def->kind > SCREE_MOTION_TABLE)
        return scree_report(trouble, SCREE_BAD_INPUT, "kind", "there is no kind %d of motion", (int)def->kind);
    if ((int)def->rise < 0 || def->rise > SCREE_RISE_CYCLOID)
        return scree_report(trouble, SCREE_BAD_INPUT, "law", "there is no law %d of a rise", (int)def->rise);
    if (def->duration < 0.0 || (def->kind == SCREE_MOTION_RISE && def->duration == 0.0))
        return scree_report(trouble, SCREE_BAD_INPUT, "duration", "the duration of a motion must be positive, got %g s",
                            def->duration);
    if (def->kind == SCREE_MOTION_SINE && !(def->frequency > 0.0))
        return scree_report(trouble, SCREE_BAD_INPUT, "frequency",
                            "the frequency of a sine motion must be positive, got %g Hz", def->frequency);
    return SCREE_OK;
}

static scree_status check_column(const double *column, const char *name, size_t rows, scree_trouble *trouble) {
    if (!column)
        return scree_report(trouble, SCREE_BAD_INPUT, "interpolation", "this table interpolation needs a column of %s",
                            name);
    for (size_t k = 0; k < rows; k++)
        if (!isfinite(column[k]))
            return scree_report(trouble, SCREE_BAD_INPUT, "table", "row %zu of a motion table: %s is not finite", k + 1,
                                name);
    return SCREE_OK;
}

static scree_status check_table(const scree_motion_def *def, scree_trouble *trouble) {
    if ((int)def->table < 0 || def->table > SCREE_TABLE_VELOCITY_QUINTIC)
        return scree_report(trouble, SCREE_BAD_INPUT, "interpolation", "there is no interpolation %d of a motion table",
                            (int)def->table);
    if (def->rows < 2 || def->rows > 10000000)
        return scree_report(trouble, SCREE_BAD_INPUT, "table",
                            "a motion table needs at least 2 rows (and at most 1e7), got %zu", def->rows);
    scree_status status = check_column(def->times, "times", def->rows, trouble);
    if (!status) status = check_column(def->positions, "positions", def->rows, trouble);
    if (!status && def->table >= SCREE_TABLE_CUBIC)
        status = check_column(def->velocities, "velocities", def->rows, trouble);
    if (!status && def->table >= SCREE_TABLE_QUINTIC)
        status = check_column(def->accelerations, "accelerations", def->rows, trouble);
    if (!status && def->table == SCREE_TABLE_VELOCITY_QUINTIC)
        status = check_column(def->jerks, "jerks", def->rows, trouble);
    if (status) return status;
    for (size_t k = 1; k < def->rows; k++)
        if (!(def->times[k] > def->times[k - 1]))
            return scree_report(trouble, SCREE_BAD_INPUT, "table",
                                "the times of a motion table must increase: row %zu has %g s after %g s", k + 1,
                                def->times[k], def->times[k - 1]);
    return SCREE_OK;
}

/* Second derivatives of the natural cubic spline through the table: the tridiagonal system solved by elimination
 * from the top (de Boor 1978, ch. IV). `m` has one entry a row and is the result; `work` as many. */
static void spline_curvatures(const scree_motion_def *def, double *m, double *work) {
    size_t last = def->rows - 1;
    const double *t = def->times, *x = def->positions;
    m[0] = work[0] = m[last] = 0.0;
    for (size_t k = 1; k < last; k++) {
        double before = t[k] - t[k - 1], after = t[k + 1] - t[k];
        double jump = 6.0 * ((x[k + 1] - x[k]) / after - (x[k] - x[k - 1]) / before);
        double pivot = 2.0 * (before + after) - before * work[k - 1];
        work[k] = after / pivot;
        m[k] = (jump - before * m[k - 1]) / pivot;
    }
    for (size_t k = last - 1; k > 0; k--) m[k] -= work[k] * m[k + 1];
}

/* Coefficients of the piece between rows k and k + 1. `m` holds spline curvatures or NULL. */
static void table_piece(const scree_motion_def *def, size_t k, const double *m, struct scree_motion_piece *piece) {
    double h = def->times[k + 1] - def->times[k];
    double rise = def->positions[k + 1] - def->positions[k];
    double *c = piece->c;
    piece->start = def->times[k];
    c[0] = def->positions[k];
    switch (def->table) {
    case SCREE_TABLE_LINEAR:
        c[1] = rise / h;
        break;
    case SCREE_TABLE_SPLINE:
        c[1] = rise / h - h * (2.0 * m[k] + m[k + 1]) / 6.0;
        c[2] = 0.5 * m[k];
        c[3] = (m[k + 1] - m[k]) / (6.0 * h);
        break;
    case SCREE_TABLE_CUBIC: {
        double va = def->velocities[k], vb = def->velocities[k + 1];
        c[1] = va;
        c[2] = (3.0 * rise / h - 2.0 * va - vb) / h;
        c[3] = (va + vb - 2.0 * rise / h) / (h * h);
        break;
    }
    case SCREE_TABLE_QUINTIC: {
        double va = def->velocities[k] * h, vb = def->velocities[k + 1] * h;
        double aa = def->accelerations[k] * h * h, ab = def->accelerations[k + 1] * h * h;
        double h3 = h * h * h;
        c[1] = def->velocities[k];
        c[2] = 0.5 * def->accelerations[k];
        c[3] = (10.0 * rise - 6.0 * va - 4.0 * vb - 1.5 * aa + 0.5 * ab) / h3;
        c[4] = (-15.0 * rise + 8.0 * va + 7.0 * vb + 1.5 * aa - ab) / (h3 * h);
        c[5] = (6.0 * rise - 3.0 * (va + vb) + 0.5 * (ab - aa)) / (h3 * h * h);
        break;
    }
    case SCREE_TABLE_VELOCITY_QUINTIC: { /* the quintic above, one derivative higher, and its integral */
        double more = def->velocities[k + 1] - def->velocities[k];
        double aa = def->accelerations[k] * h, ab = def->accelerations[k + 1] * h;
        double ja = def->jerks[k] * h * h, jb = def->jerks[k + 1] * h * h, h3 = h * h * h;
        c[1] = def->velocities[k];
        c[2] = def->accelerations[k] / 2.0;
        c[3] = def->jerks[k] / 6.0;
        c[4] = (10.0 * more - 6.0 * aa - 4.0 * ab - 1.5 * ja + 0.5 * jb) / (4.0 * h3);
        c[5] = (-15.0 * more + 8.0 * aa + 7.0 * ab + 1.5 * ja - jb) / (5.0 * h3 * h);
        c[6] = (6.0 * more - 3.0 * (aa + ab) + 0.5 * (jb - ja)) / (6.0 * h3 * h * h);
        break;
    }
    }
}

/* The pieces of a velocity table meet: the positions given are the integral of the velocity. */
static scree_status check_integral(const scree_motion_def *def, const struct scree_motion *motion,
                                   scree_trouble *trouble) {
    double span = 0.0;
    for (size_t k = 0; k < def->rows; k++) span = fmax(span, fabs(def->positions[k] - def->positions[0]));
    for (size_t k = 0; k + 1 < def->rows; k++) {
        double h = def->times[k + 1] - def->times[k], x = value_of(&motion->pieces[1 + k], h).position;
        /* Rounding of the coefficients and of what the table was written with. */
        if (fabs(x - def->positions[k + 1]) <= 1e-9 * span) continue;
        return scree_report(
            trouble, SCREE_BAD_INPUT, "table",
            "row %zu of a motion table: the position is %.9g, but the integral of the velocity leads to "
            "%.9g; where jerk jumps, take interpolation = \"quintic\"",
            k + 2, def->positions[k + 1], x);
    }
    return SCREE_OK;
}

static scree_status bake_table(const scree_motion_def *def, struct scree_motion *motion, scree_trouble *trouble) {
    double *spline = NULL;
    if (def->table == SCREE_TABLE_SPLINE) {
        spline = malloc(2 * def->rows * sizeof *spline);
        if (!spline) return scree_report(trouble, SCREE_NO_MEMORY, "table", "no memory for a motion table");
        spline_curvatures(def, spline, spline + def->rows);
    }
    size_t last = def->rows - 1;
    for (size_t k = 0; k < last; k++) table_piece(def, k, spline, &motion->pieces[1 + k]);
    free(spline);
    motion->pieces[0].c[0] = def->positions[0];
    motion->pieces[1 + last].start = def->times[last];
    motion->pieces[1 + last].c[0] = def->positions[last];
    return def->table == SCREE_TABLE_VELOCITY_QUINTIC ? check_integral(def, motion, trouble) : SCREE_OK;
}

/* Finite numbers may lead to others: rows 1e-320 s apart, a rise in 1e-200 s. */
static scree_status check_pieces(const struct scree_motion *motion, scree_trouble *trouble) {
    for (int k = 0; k < motion->count; k++) {
        const struct scree_motion_piece *piece = &motion->pieces[k];
        double sum = piece->amplitude * piece->rate * piece->rate;
        for (int i = 0; i < 7; i++) sum += 0.0 * piece->c[i];
        if (!isfinite(sum))
            return scree_report(trouble, SCREE_BAD_INPUT, NULL, "a motion is faster than numbers reach at t = %.9g s",
                                piece->start);
    }
    return SCREE_OK;
}

static void bake_formula(const scree_motion_def *def, struct scree_motion *motion) {
    struct scree_motion_piece *moving = &motion->pieces[1], *after = &motion->pieces[2];
    double s = def->stroke, d = def->duration, final = def->offset;
    motion->pieces[0].c[0] = def->offset;
    moving->start = def->start;
    moving->c[0] = def->offset;
    switch (def->kind) {
    case SCREE_MOTION_VELOCITY:
        moving->c[1] = def->velocity;
        final += def->velocity * d;
        break;
    case SCREE_MOTION_RISE:
        final += s;
        if (def->rise == SCREE_RISE_QUINTIC) {
            moving->c[3] = 10.0 * s / (d * d * d);
            moving->c[4] = -15.0 * s / (d * d * d * d);
            moving->c[5] = 6.0 * s / (d * d * d * d * d);
        } else {
            moving->c[1] = s / d;
            moving->amplitude = -s / two_pi;
            moving->rate = two_pi / d;
        }
        break;
    case SCREE_MOTION_SINE:
        moving->amplitude = def->amplitude;
        moving->rate = two_pi * def->frequency;
        moving->phase = def->phase;
        motion->pieces[0].c[0] = value_of(moving, 0.0).position;
        final = value_of(moving, d).position;
        break;
    case SCREE_MOTION_TABLE:
        break;
    }
    after->start = def->start + d;
    after->c[0] = final;
    if (d == 0.0) motion->count = 2; /* goes on for ever */
}

scree_status scree_motion_bake(const scree_motion_def *def, struct scree_motion *motion, scree_trouble *trouble) {
    *motion = (struct scree_motion){0};
    int table = def->kind == SCREE_MOTION_TABLE;
    scree_status status = table ? check_table(def, trouble) : check_numbers(def, trouble);
    if (status) return status;
    size_t count = table ? def->rows + 1 : 3; /* one before, the moving ones, one after */
    motion->pieces = calloc(count, sizeof *motion->pieces);
    if (!motion->pieces) return scree_report(trouble, SCREE_NO_MEMORY, NULL, "no memory for a motion");
    motion->count = (int)count;
    if (table)
        status = bake_table(def, motion, trouble);
    else
        bake_formula(def, motion);
    if (!status) status = check_pieces(motion, trouble);
    if (status) scree_motion_free(motion);
    return status;
}

void scree_motion_free(struct scree_motion *motion) {
    free(motion->pieces);
    *motion = (struct scree_motion){0};
}

struct scree_motion_value scree_motion_at(const struct scree_motion *motion, double time) {
    int low = 0, high = motion->count; /* the piece that holds `time` is in [low, high) */
    while (high - low > 1) {
        int middle = low + (high - low) / 2;
        if (time >= motion->pieces[middle].start)
            low = middle;
        else
            high = middle;
    }
    return value_of(&motion->pieces[low], time - motion->pieces[low].start);
}
