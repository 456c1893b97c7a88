/* Householder QR with column pivoting, and the trust-region step by the secular equation. */
#include "solver/qr.h"

#include <float.h>
#include <math.h>

/* fmax and fmin for numbers (not NaN), without a call. */
static inline double larger(double a, double b) { return a > b ? a : b; }
static inline double smaller(double a, double b) { return a < b ? a : b; }

static inline double dot(int count, const double *x, const double *y) {
    double s0 = 0.0, s1 = 0.0, s2 = 0.0, s3 = 0.0;
    int k = 0;
    for (; k + 4 <= count; k += 4) {
        s0 += x[k] * y[k];
        s1 += x[k + 1] * y[k + 1];
        s2 += x[k + 2] * y[k + 2];
        s3 += x[k + 3] * y[k + 3];
    }
    for (; k < count; k++) s0 += x[k] * y[k];
    return (s0 + s1) + (s2 + s3);
}

double scree_dot(int count, const double *x, const double *y) { return dot(count, x, y); }

double scree_binary_unit(double x) {
    int exponent = 0;
    if (x == 0.0 || !isfinite(x)) return 1.0;
    frexp(x, &exponent);
    return ldexp(1.0, exponent < -1000 ? 1000 : exponent > 1000 ? -1000 : -exponent);
}

/* Sum of (s x)^2, in the order of `dot`. */
static double squares(int count, double s, const double *x) {
    double sum[4] = {0.0, 0.0, 0.0, 0.0};
    int k = 0;
    for (; k + 4 <= count; k += 4)
        for (int i = 0; i < 4; i++) sum[i] += (s * x[k + i]) * (s * x[k + i]);
    for (; k < count; k++) sum[0] += (s * x[k]) * (s * x[k]);
    return (sum[0] + sum[1]) + (sum[2] + sum[3]);
}

double scree_norm(int count, const double *x) {
    double sum = dot(count, x, x);
    if (sum > 1e-280 && sum < 1e280) return sqrt(sum);
    double largest = 0.0;
    for (int k = 0; k < count; k++) {
        if (isnan(x[k])) return x[k];
        largest = larger(largest, fabs(x[k]));
    }
    if (largest == 0.0 || isinf(largest)) return largest;
    double unit = scree_binary_unit(largest);
    return sqrt(squares(count, unit, x)) / unit;
}

/* y <- y - s x */
static void subtract(int count, double s, const double *x, double *y) {
    for (int k = 0; k < count; k++) y[k] -= s * x[k];
}

static void swap_columns(int rows, double *a, double *b) {
    for (int k = 0; k < rows; k++) {
        double t = a[k];
        a[k] = b[k];
        b[k] = t;
    }
}

/* Bring the column of largest remaining norm to place j. */
static void bring_largest(int rows, int columns, int j, double *a, int *pivot, double *rest, double *reference) {
    int best = j;
    for (int k = j + 1; k < columns; k++)
        if (rest[k] > rest[best]) best = k;
    if (best == j) return;
    swap_columns(rows, a + j * rows, a + best * rows);
    int t = pivot[j];
    pivot[j] = pivot[best];
    pivot[best] = t;
    rest[best] = rest[j];
    reference[best] = reference[j];
}

void scree_qr_factor(int rows, int columns, double *a, int *pivot, double *diagonal, double *norms, double *work) {
    /* Squares of what is left of each column's norm, and of what it was when last computed afresh, in parts of the
     * largest. */
    double *rest = diagonal, *reference = work, largest = 0.0;
    for (int j = 0; j < columns; j++) {
        pivot[j] = j;
        norms[j] = scree_norm(rows, a + j * rows);
        largest = larger(largest, norms[j]);
    }
    double unit = largest > 0.0 ? 1.0 / largest : 0.0;
    for (int j = 0; j < columns; j++) rest[j] = reference[j] = (norms[j] * unit) * (norms[j] * unit);
    int steps = rows < columns ? rows : columns;
    for (int j = 0; j < steps; j++) {
        bring_largest(rows, columns, j, a, pivot, rest, reference);
        double *v = a + j * rows + j;
        int length = rows - j;
        double norm = scree_norm(length, v);
        if (norm == 0.0) {
            diagonal[j] = 0.0;
            continue;
        }
        if (v[0] < 0.0) norm = -norm;
        double scale = 1.0 / norm;
        for (int k = 0; k < length; k++) v[k] *= scale;
        v[0] += 1.0; /* H = I - v v^T/v[0] */
        double weight = 1.0 / v[0];
        for (int k = j + 1; k < columns; k++) {
            double *c = a + k * rows + j;
            subtract(length, dot(length, v, c) * weight, v, c);
            rest[k] -= (c[0] * unit) * (c[0] * unit);
            /* Downdating has cancelled away the digits: compute the norm afresh (LINPACK's test). */
            if (rest[k] > 20.0 * DBL_EPSILON * reference[k]) continue;
            double left = scree_norm(length - 1, c + 1) * unit;
            rest[k] = reference[k] = left * left;
        }
        diagonal[j] = -norm;
    }
}

void scree_qr_transform(int rows, int columns, const double *a, double *b) {
    int steps = rows < columns ? rows : columns;
    for (int j = 0; j < steps; j++) {
        const double *v = a + j * rows + j;
        if (v[0] == 0.0) continue;
        subtract(rows - j, dot(rows - j, v, b + j) / v[0], v, b + j);
    }
}

void scree_qr_triangle(int rows, int columns, const double *a, const double *diagonal, double *r) {
    for (int j = 0; j < columns; j++)
        for (int k = 0; k < columns; k++) r[j * columns + k] = k < j ? a[j * rows + k] : k == j ? diagonal[j] : 0.0;
}

int scree_qr_rank(int columns, const double *diagonal, const int *pivot, const double *norms, double tolerance) {
    int rank = 0;
    while (rank < columns && fabs(diagonal[rank]) > tolerance * norms[pivot[rank]]) rank++;
    return rank;
}

/* Back substitution R z = b in place, for the leading `rank` rows; the other entries become 0. */
static void solve_triangle(int n, int rank, const double *r, double *b) {
    for (int k = rank; k < n; k++) b[k] = 0.0;
    for (int j = rank - 1; j >= 0; j--) {
        b[j] /= r[j * n + j];
        for (int k = 0; k < j; k++) b[k] -= r[j * n + k] * b[j];
    }
}

/* Forward substitution S^T z = b in place for an upper triangle S. */
static void solve_transposed(int n, const double *s, double *b) {
    for (int j = 0; j < n; j++) {
        double sum = b[j];
        for (int k = 0; k < j; k++) sum -= s[j * n + k] * b[k];
        b[j] = sum / s[j * n + j];
    }
}

/* sqrt(a^2 + b^2) where the squares leave the range of numbers. */
static double far_hypotenuse(double a, double b) {
    double unit = scree_binary_unit(larger(fabs(a), fabs(b)));
    return sqrt((unit * a) * (unit * a) + (unit * b) * (unit * b)) / unit;
}

/* Rotate the row (0 … 0 t 0 … 0), t at place j, into the triangle `s` with right-hand side `b` (Givens rotations). The
 * row's own right-hand side is 0; its entries beyond j fill in `row`. */
static void rotate_in(int n, int j, double t, double *s, double *b, double *row) {
    double rhs = 0.0;
    for (int k = j; k < n; k++) row[k] = 0.0;
    row[j] = t;
    for (int k = j; k < n; k++) {
        if (row[k] == 0.0) continue;
        double diagonal = s[k * n + k], square = diagonal * diagonal + row[k] * row[k];
        double hypotenuse = square > 1e-280 && square < 1e280 ? sqrt(square) : far_hypotenuse(diagonal, row[k]);
        double scale = 1.0 / hypotenuse, c = diagonal * scale, sn = row[k] * scale;
        s[k * n + k] = hypotenuse;
        double kept = c * b[k] + sn * rhs;
        rhs = c * rhs - sn * b[k];
        b[k] = kept;
        for (int i = k + 1; i < n; i++) {
            double above = s[i * n + k];
            s[i * n + k] = c * above + sn * row[i];
            row[i] = c * row[i] - sn * above;
        }
    }
}

/* The triangle S of [R; sqrt(par) D P] in `s`, and p in `p`; `z` and `row` are scratch of n entries. */
static void damped(int n, const double *r, const int *pivot, const double *d, const double *b, double par, double *p,
                   double *s, double *z, double *row) {
    double root = sqrt(par);
    for (int k = 0; k < n * n; k++) s[k] = r[k];
    for (int k = 0; k < n; k++) z[k] = b[k];
    for (int j = 0; j < n; j++)
        if (root * d[pivot[j]] != 0.0) rotate_in(n, j, root * d[pivot[j]], s, z, row);
    int rank = 0;
    while (rank < n && s[rank * n + rank] != 0.0) rank++;
    solve_triangle(n, rank, s, z);
    for (int j = 0; j < n; j++) p[pivot[j]] = z[j];
}

void scree_qr_damped_solve(int n, const double *r, const int *pivot, const double *d, const double *b, double par,
                           double *p, double *work) {
    damped(n, r, pivot, d, b, par, p, work, work + n * n, work + n * n + n);
}

/* |D p|, and D p in `dp`. */
static double scaled_norm(int n, const double *d, const double *p, double *dp) {
    for (int k = 0; k < n; k++) dp[k] = d[k] * p[k];
    return scree_norm(n, dp);
}

double scree_qr_trust_step(int n, const double *r, const int *pivot, const double *d, const double *b, double radius,
                           double *par, double *p, double *work) {
    double *s = work, *z = work + n * n, *row = z + n, *dp = row + n, *w = dp + n;
    int rank = 0;
    while (rank < n && r[rank * n + rank] != 0.0) rank++;
    for (int k = 0; k < n; k++) z[k] = b[k];
    solve_triangle(n, rank, r, z);
    for (int j = 0; j < n; j++) p[pivot[j]] = z[j];
    double norm = scaled_norm(n, d, p, dp), beyond = norm - radius;
    if (beyond <= 0.1 * radius) {
        *par = 0.0;
        return norm;
    }
    /* Lower bound from Newton's step at par = 0 if R is regular, upper bound from the gradient (More 1978, section
     * 5). */
    double low = 0.0;
    if (rank == n) {
        for (int j = 0; j < n; j++) w[j] = d[pivot[j]] * (dp[pivot[j]] / norm);
        solve_transposed(n, r, w);
        double slope = scree_norm(n, w);
        low = beyond / radius / slope / slope;
    }
    double unit = scree_binary_unit(norm); /* products of two residuals may leave the range of numbers */
    for (int j = 0; j < n; j++) z[j] = unit * b[j];
    for (int j = 0; j < n; j++) w[j] = dot(j + 1, r + j * n, z) / d[pivot[j]];
    double gradient = scree_norm(n, w), high = gradient / (unit * radius);
    if (high == 0.0) high = DBL_MIN / smaller(radius, 0.1);
    *par = smaller(larger(*par, low), high);
    if (*par == 0.0) *par = gradient / (unit * norm);
    for (int trial = 0; trial < 10; trial++) {
        if (*par == 0.0) *par = larger(DBL_MIN, 0.001 * high);
        damped(n, r, pivot, d, b, *par, p, s, z, row);
        norm = scaled_norm(n, d, p, dp);
        double before = beyond;
        beyond = norm - radius;
        if (fabs(beyond) <= 0.1 * radius || (low == 0.0 && beyond <= before && before < 0.0)) break;
        for (int j = 0; j < n; j++) w[j] = d[pivot[j]] * (dp[pivot[j]] / norm);
        solve_transposed(n, s, w);
        double slope = scree_norm(n, w), correction = beyond / radius / slope / slope;
        if (beyond > 0.0) low = larger(low, *par);
        if (beyond < 0.0) high = smaller(high, *par);
        *par = larger(low, *par + correction);
    }
    return norm;
}
