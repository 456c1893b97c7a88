/* solver/qr: the factorisation and the trust-region step against what defines them, on random matrices. */
#include "solver/qr.h"

#include "tests/check.h"

#include <float.h>

enum { ROWS = 40, COLUMNS = 12 };

static uint64_t seed = 20240229;

/* Random m x n matrix of the given rank, columns of sizes spread over `spread` decades, times `scale`. */
static void make_matrix(int m, int n, int rank, double spread, double scale, double *a) {
    double left[ROWS * COLUMNS], right[COLUMNS * COLUMNS];
    for (int k = 0; k < m * rank; k++) left[k] = check_between(&seed, -1.0, 1.0);
    for (int k = 0; k < rank * n; k++) right[k] = check_between(&seed, -1.0, 1.0);
    for (int j = 0; j < n; j++) {
        double size = scale * pow(10.0, spread * check_between(&seed, -0.5, 0.5));
        for (int i = 0; i < m; i++) {
            double sum = 0.0;
            for (int k = 0; k < rank; k++) sum += left[k * m + i] * right[j * rank + k];
            a[j * m + i] = size * (rank == n ? left[j * m + i] : sum);
        }
    }
}

struct factored {
    double a[ROWS * COLUMNS], q[ROWS * COLUMNS]; /* the matrix, and its factorisation */
    double diagonal[COLUMNS], norms[COLUMNS], r[COLUMNS * COLUMNS];
    int pivot[COLUMNS], m, n;
};

static struct factored factored(int m, int n, int rank, double spread, double scale) {
    struct factored f = {.m = m, .n = n};
    double work[COLUMNS];
    make_matrix(m, n, rank, spread, scale, f.a);
    memcpy(f.q, f.a, sizeof f.a);
    scree_qr_factor(m, n, f.q, f.pivot, f.diagonal, f.norms, work);
    scree_qr_triangle(m, n, f.q, f.diagonal, f.r);
    return f;
}

/* Q^T (column pivot[j] of A) is column j of R. Householder's QR is backward stable: the error of a column is below
 * about m n eps of its norm (Higham, Accuracy and Stability, theorem 19.4); what is seen is far less. */
static void check_factors(const struct factored *f) {
    double limit = f->m * f->n * DBL_EPSILON;
    int seen[COLUMNS] = {0};
    for (int j = 0; j < f->n; j++) {
        double column[ROWS], error = 0.0, norm = scree_norm(f->m, f->a + f->pivot[j] * f->m);
        seen[f->pivot[j]]++;
        memcpy(column, f->a + f->pivot[j] * f->m, (size_t)f->m * sizeof(double));
        scree_qr_transform(f->m, f->n, f->q, column);
        for (int i = 0; i < f->m; i++)
            error = scree_most(error, fabs(column[i] - (i < f->n ? f->r[j * f->n + i] : 0.0)));
        CHECK(error <= limit * norm);
        CLOSE(scree_norm(f->m, column), norm, limit);
        CLOSE(f->norms[f->pivot[j]], norm, limit);
        for (int i = j + 1; i < f->n; i++) CHECK(f->r[j * f->n + i] == 0.0);
        /* The rest of the largest column comes first; its norm is kept by downdating, good to sqrt(20 eps) (LINPACK's
         * test). */
        if (j > 0) CHECK(fabs(f->diagonal[j]) <= fabs(f->diagonal[j - 1]) * (1.0 + 1e-7));
    }
    for (int j = 0; j < f->n; j++) CHECK(seen[j] == 1);
}

static void test_factor(void) {
    static const double scales[] = {1.0, 1e150, 1e-150};
    for (int trial = 0; trial < 300; trial++) {
        int n = 1 + trial % COLUMNS, m = n + trial * 7 % (ROWS - COLUMNS + 1);
        struct factored f = factored(m, n, n, trial % 3 * 6.0, scales[trial % 5 % 3]);
        check_factors(&f);
        CHECK(scree_qr_rank(n, f.diagonal, f.pivot, f.norms, 1e-13) == n);
    }
    struct factored zero = {.m = 5, .n = 3};
    double work[3];
    scree_qr_factor(5, 3, zero.q, zero.pivot, zero.diagonal, zero.norms, work);
    scree_qr_triangle(5, 3, zero.q, zero.diagonal, zero.r);
    CHECK(scree_qr_rank(3, zero.diagonal, zero.pivot, zero.norms, 1e-13) == 0);
}

static void test_rank(void) {
    for (int n = 2; n <= COLUMNS; n++)
        for (int rank = 1; rank < n; rank++) {
            struct factored f = factored(ROWS, n, rank, 0.0, 1.0);
            check_factors(&f);
            /* What is left of a dependent column is rounding, m n eps = 1e-13 of its norm at most. */
            CHECK(scree_qr_rank(n, f.diagonal, f.pivot, f.norms, 1e-12) == rank);
        }
    struct factored spread = factored(20, 6, 6, 40.0, 1.0); /* sizes of columns say nothing about the rank */
    CHECK(scree_qr_rank(6, spread.diagonal, spread.pivot, spread.norms, 1e-12) == 6);
}

static void test_norm(void) {
    static const double values[] = {1e-300, 1e-200, 1.0, 1e200, 1e300};
    for (size_t k = 0; k < sizeof values / sizeof values[0]; k++) {
        double x[7];
        for (int i = 0; i < 7; i++) x[i] = (i % 2 ? -1.0 : 1.0) * values[k];
        CLOSE(scree_norm(7, x), sqrt(7.0) * values[k], 4.0 * DBL_EPSILON);
    }
    double x[9], y[9];
    for (int i = 0; i < 9; i++) x[i] = check_between(&seed, -1.0, 1.0);
    for (int power = -900; power <= 900; power += 100) { /* a power of two changes no digit */
        for (int i = 0; i < 9; i++) y[i] = ldexp(x[i], power);
        CHECK(scree_norm(9, y) == ldexp(scree_norm(9, x), power));
    }
    CHECK(scree_norm(3, (double[]){0.0, 0.0, 0.0}) == 0.0);
    CHECK(isinf(scree_norm(3, (double[]){1.0, -INFINITY, 2.0})));
    CHECK(isnan(scree_norm(3, (double[]){1.0, NAN, INFINITY})));
    CHECK(scree_norm(0, x) == 0.0);
}

/* J^T (J p + f) + par D^2 p, which the step makes vanish; in parts of what its terms amount to. */
static double normal_equations(const struct factored *f, const double *right, const double *d, double par,
                               const double *p) {
    double rest[ROWS], worst = 0.0;
    for (int i = 0; i < f->m; i++) {
        rest[i] = right[i];
        for (int j = 0; j < f->n; j++) rest[i] += f->a[j * f->m + i] * p[j];
    }
    for (int j = 0; j < f->n; j++) {
        double sum = scree_dot(f->m, f->a + j * f->m, rest) + par * d[j] * (d[j] * p[j]),
               terms = par * d[j] * d[j] * fabs(p[j]);
        terms += f->norms[j] * scree_norm(f->m, right);
        for (int k = 0; k < f->n; k++) terms += f->norms[j] * f->norms[k] * fabs(p[k]);
        worst = scree_most(worst, sum == 0.0 ? 0.0 : fabs(sum) / terms); /* a column of zeros has no terms */
    }
    return worst;
}

static void test_trust_step(void) {
    int inside = 0, outside = 0;
    for (int trial = 0; trial < 600; trial++) {
        int n = 1 + trial % COLUMNS, m = n + 5;
        struct factored f = factored(m, n, n, trial % 2 * 4.0, trial % 7 == 6 ? 1e140 : 1.0);
        double right[ROWS], b[ROWS], d[COLUMNS], p[COLUMNS], work[COLUMNS * (COLUMNS + 4)], par = trial % 3;
        for (int i = 0; i < m; i++) b[i] = -(right[i] = check_between(&seed, -1.0, 1.0) * f.norms[0]);
        for (int j = 0; j < n; j++) d[j] = f.norms[j] * check_between(&seed, 1.0, 3.0);
        scree_qr_transform(m, n, f.q, b);
        double radius = scree_norm(m, right) * pow(10.0, check_between(&seed, -4.0, 1.0));
        double length = scree_qr_trust_step(n, f.r, f.pivot, d, b, radius, &par, p, work);
        double dp[COLUMNS];
        for (int j = 0; j < n; j++) dp[j] = d[j] * p[j];
        CLOSE(length, scree_norm(n, dp), 4.0 * DBL_EPSILON);
        CHECK(par >= 0.0);
        if (par == 0.0) CHECK(length <= 1.1 * radius);
        if (par > 0.0) NEAR(length, radius, 0.1 * radius);
        CHECK(normal_equations(&f, right, d, par, p) <= m * n * DBL_EPSILON);
        inside += par == 0.0;
        outside += par > 0.0;
        scree_qr_damped_solve(n, f.r, f.pivot, d, b, 0.7, p, work);
        CHECK(normal_equations(&f, right, d, 0.7, p) <= m * n * DBL_EPSILON);
    }
    CHECK(inside > 50 && outside > 50);
}

/* A column that is exactly zero: its unknown stays where it is, the others solve the rest. */
static void test_singular_step(void) {
    struct factored f = {.m = 6, .n = 3};
    double right[6], b[6], d[3] = {1.0, 1.0, 1.0}, p[3], work[3 * 7], par = 0.0;
    make_matrix(6, 3, 3, 0.0, 1.0, f.a);
    memset(f.a + 6, 0, 6 * sizeof(double));
    memcpy(f.q, f.a, sizeof f.a);
    scree_qr_factor(6, 3, f.q, f.pivot, f.diagonal, f.norms, work);
    scree_qr_triangle(6, 3, f.q, f.diagonal, f.r);
    for (int i = 0; i < 6; i++) b[i] = -(right[i] = check_between(&seed, -1.0, 1.0));
    scree_qr_transform(6, 3, f.q, b);
    for (double radius = 1e3; radius > 1e-4; radius *= 0.1) {
        double length = scree_qr_trust_step(3, f.r, f.pivot, d, b, radius, &par, p, work);
        CHECK(p[1] == 0.0);
        CHECK(length <= 1.1 * radius);
        CHECK(par == 0.0 || length >= 0.9 * radius);
        CHECK(normal_equations(&f, right, d, par, p) <= 6 * 3 * DBL_EPSILON);
    }
}

int main(void) {
    test_factor();
    test_rank();
    test_norm();
    test_trust_step();
    test_singular_step();
    return check_report();
}
