/* The least-squares problems of More, Garbow & Hillstrom (ACM Trans. Math. Softw. 7 (1981) 17) with analytic Jacobians,
 * and those that MINPACK's own tests add. Numbers in comments are theirs. */
#include "bench/problems.h"

#include "bodies/elementary.h"

#include <math.h>
#include <stdint.h>
#include <string.h>

static const double pi = 3.14159265358979323846;

/* Entry (i, k) of a Jacobian by columns with m rows. */
#define J(i, k) j[(k)*m + (i)]

static void set(int n, double *x, const double *values) { memcpy(x, values, (size_t)n * sizeof *x); }

static void fill(int n, double *x, double value) {
    for (int k = 0; k < n; k++) x[k] = value;
}

/* ---- linear (32 to 34) ---- */

static void ones(int n, double *x) { fill(n, x, 1.0); }

static void full_rank(int n, int m, const double *x, double *r) {
    double sum = 0.0;
    for (int k = 0; k < n; k++) sum += x[k];
    for (int i = 0; i < m; i++) r[i] = -2.0 / m * sum - 1.0 + (i < n ? x[i] : 0.0);
}
static void full_rank_j(int n, int m, const double *x, double *j) {
    (void)x;
    for (int k = 0; k < n; k++)
        for (int i = 0; i < m; i++) J(i, k) = -2.0 / m + (i == k);
}

static void rank_one(int n, int m, const double *x, double *r) {
    double sum = 0.0;
    for (int k = 0; k < n; k++) sum += (k + 1) * x[k];
    for (int i = 0; i < m; i++) r[i] = (i + 1) * sum - 1.0;
}
static void rank_one_j(int n, int m, const double *x, double *j) {
    (void)x;
    for (int k = 0; k < n; k++)
        for (int i = 0; i < m; i++) J(i, k) = (i + 1.0) * (k + 1.0);
}

static void rank_one_zero(int n, int m, const double *x, double *r) {
    double sum = 0.0;
    for (int k = 1; k < n - 1; k++) sum += (k + 1) * x[k];
    for (int i = 0; i < m; i++) r[i] = (i == 0 || i == m - 1 ? 0.0 : i * sum) - 1.0;
}
static void rank_one_zero_j(int n, int m, const double *x, double *j) {
    (void)x;
    for (int k = 0; k < n; k++)
        for (int i = 0; i < m; i++) J(i, k) = k == 0 || k == n - 1 || i == 0 || i == m - 1 ? 0.0 : i * (k + 1.0);
}

/* ---- small ones ---- */

static void rosenbrock_0(int n, double *x) { set(n, x, (const double[]){-1.2, 1.0}); }
static void rosenbrock(int n, int m, const double *x, double *r) {
    (void)n, (void)m;
    r[0] = 10.0 * (x[1] - x[0] * x[0]);
    r[1] = 1.0 - x[0];
}
static void rosenbrock_j(int n, int m, const double *x, double *j) {
    (void)n;
    J(0, 0) = -20.0 * x[0];
    J(0, 1) = 10.0;
    J(1, 0) = -1.0;
    J(1, 1) = 0.0;
}

static void helical_0(int n, double *x) { set(n, x, (const double[]){-1.0, 0.0, 0.0}); }
static void helical(int n, int m, const double *x, double *r) {
    (void)n, (void)m;
    double theta = x[0] > 0.0   ? atan(x[1] / x[0]) / (2.0 * pi)
                   : x[0] < 0.0 ? atan(x[1] / x[0]) / (2.0 * pi) + 0.5
                                : copysign(0.25, x[1]);
    r[0] = 10.0 * (x[2] - 10.0 * theta);
    r[1] = 10.0 * (sqrt(x[0] * x[0] + x[1] * x[1]) - 1.0);
    r[2] = x[2];
}
static void helical_j(int n, int m, const double *x, double *j) {
    (void)n;
    double q = x[0] * x[0] + x[1] * x[1], root = sqrt(q);
    J(0, 0) = 100.0 * x[1] / (2.0 * pi * q);
    J(0, 1) = -100.0 * x[0] / (2.0 * pi * q);
    J(0, 2) = 10.0;
    J(1, 0) = 10.0 * x[0] / root;
    J(1, 1) = 10.0 * x[1] / root;
    J(1, 2) = J(2, 0) = J(2, 1) = 0.0;
    J(2, 2) = 1.0;
}

static void powell_0(int n, double *x) { set(n, x, (const double[]){3.0, -1.0, 0.0, 1.0}); }
static void powell(int n, int m, const double *x, double *r) {
    (void)n, (void)m;
    r[0] = x[0] + 10.0 * x[1];
    r[1] = sqrt(5.0) * (x[2] - x[3]);
    r[2] = (x[1] - 2.0 * x[2]) * (x[1] - 2.0 * x[2]);
    r[3] = sqrt(10.0) * (x[0] - x[3]) * (x[0] - x[3]);
}
static void powell_j(int n, int m, const double *x, double *j) {
    memset(j, 0, (size_t)(n * m) * sizeof *j);
    J(0, 0) = 1.0;
    J(0, 1) = 10.0;
    J(1, 2) = sqrt(5.0);
    J(1, 3) = -sqrt(5.0);
    J(2, 1) = 2.0 * (x[1] - 2.0 * x[2]);
    J(2, 2) = -2.0 * J(2, 1);
    J(3, 0) = 2.0 * sqrt(10.0) * (x[0] - x[3]);
    J(3, 3) = -J(3, 0);
}

static void freudenstein_0(int n, double *x) { set(n, x, (const double[]){0.5, -2.0}); }
static void freudenstein(int n, int m, const double *x, double *r) {
    (void)n, (void)m;
    r[0] = -13.0 + x[0] + ((5.0 - x[1]) * x[1] - 2.0) * x[1];
    r[1] = -29.0 + x[0] + ((x[1] + 1.0) * x[1] - 14.0) * x[1];
}
static void freudenstein_j(int n, int m, const double *x, double *j) {
    (void)n;
    J(0, 0) = J(1, 0) = 1.0;
    J(0, 1) = x[1] * (10.0 - 3.0 * x[1]) - 2.0;
    J(1, 1) = x[1] * (2.0 + 3.0 * x[1]) - 14.0;
}

static const double bard_y[15] = {0.14, 0.18, 0.22, 0.25, 0.29, 0.32, 0.35, 0.39,
                                  0.37, 0.58, 0.73, 0.96, 1.34, 2.1,  4.39};
static void bard(int n, int m, const double *x, double *r) {
    (void)n;
    for (int i = 0; i < m; i++) {
        double u = i + 1, v = 15 - i, w = fmin(u, v);
        r[i] = bard_y[i] - (x[0] + u / (v * x[1] + w * x[2]));
    }
}
static void bard_j(int n, int m, const double *x, double *j) {
    (void)n;
    for (int i = 0; i < m; i++) {
        double u = i + 1, v = 15 - i, w = fmin(u, v), q = v * x[1] + w * x[2];
        J(i, 0) = -1.0;
        J(i, 1) = u * v / (q * q);
        J(i, 2) = u * w / (q * q);
    }
}

static const double kowalik_y[11] = {0.1957, 0.1947, 0.1735, 0.16,   0.0844, 0.0627,
                                     0.0456, 0.0342, 0.0323, 0.0235, 0.0246};
static const double kowalik_u[11] = {4.0, 2.0, 1.0, 0.5, 0.25, 0.167, 0.125, 0.1, 0.0833, 0.0714, 0.0625};
static void kowalik_0(int n, double *x) { set(n, x, (const double[]){0.25, 0.39, 0.415, 0.39}); }
static void kowalik(int n, int m, const double *x, double *r) {
    (void)n;
    for (int i = 0; i < m; i++) {
        double u = kowalik_u[i];
        r[i] = kowalik_y[i] - x[0] * u * (u + x[1]) / (u * (u + x[2]) + x[3]);
    }
}
static void kowalik_j(int n, int m, const double *x, double *j) {
    (void)n;
    for (int i = 0; i < m; i++) {
        double u = kowalik_u[i], above = u * (u + x[1]), below = u * (u + x[2]) + x[3];
        J(i, 0) = -above / below;
        J(i, 1) = -x[0] * u / below;
        J(i, 2) = x[0] * above * u / (below * below);
        J(i, 3) = x[0] * above / (below * below);
    }
}

static const double meyer_y[16] = {34780, 28610, 23650, 19630, 16370, 13720, 11540, 9744,
                                   8261,  7030,  6005,  5147,  4427,  3820,  3307,  2872};
static void meyer_0(int n, double *x) { set(n, x, (const double[]){0.02, 4000.0, 250.0}); }
static void meyer(int n, int m, const double *x, double *r) {
    (void)n;
    for (int i = 0; i < m; i++) r[i] = x[0] * scree_exp(x[1] / (5.0 * (i + 1) + 45.0 + x[2])) - meyer_y[i];
}
static void meyer_j(int n, int m, const double *x, double *j) {
    (void)n;
    for (int i = 0; i < m; i++) {
        double q = 5.0 * (i + 1) + 45.0 + x[2], e = scree_exp(x[1] / q);
        J(i, 0) = e;
        J(i, 1) = x[0] * e / q;
        J(i, 2) = -x[0] * x[1] * e / (q * q);
    }
}

static void zeros(int n, double *x) { fill(n, x, 0.0); }
static void watson(int n, int m, const double *x, double *r) {
    (void)m;
    for (int i = 0; i < 29; i++) {
        double t = (i + 1) / 29.0, derivative = 0.0, value = 0.0, power = 1.0;
        for (int k = 1; k < n; k++, power *= t) derivative += k * power * x[k];
        power = 1.0;
        for (int k = 0; k < n; k++, power *= t) value += power * x[k];
        r[i] = derivative - value * value - 1.0;
    }
    r[29] = x[0];
    r[30] = x[1] - x[0] * x[0] - 1.0;
}
static void watson_j(int n, int m, const double *x, double *j) {
    memset(j, 0, (size_t)(n * m) * sizeof *j);
    for (int i = 0; i < 29; i++) {
        double t = (i + 1) / 29.0, value = 0.0, power = 1.0;
        for (int k = 0; k < n; k++, power *= t) value += power * x[k];
        power = 1.0 / t;
        for (int k = 0; k < n; k++, power *= t) J(i, k) = power * (k - 2.0 * t * value);
    }
    J(29, 0) = 1.0;
    J(30, 0) = -2.0 * x[0];
    J(30, 1) = 1.0;
}

static void box3_0(int n, double *x) { set(n, x, (const double[]){0.0, 10.0, 20.0}); }
static void box3(int n, int m, const double *x, double *r) {
    (void)n;
    for (int i = 0; i < m; i++) {
        double t = (i + 1) / 10.0;
        r[i] = scree_exp(-t * x[0]) - scree_exp(-t * x[1]) + (scree_exp(-(i + 1.0)) - scree_exp(-t)) * x[2];
    }
}
static void box3_j(int n, int m, const double *x, double *j) {
    (void)n;
    for (int i = 0; i < m; i++) {
        double t = (i + 1) / 10.0;
        J(i, 0) = -t * scree_exp(-t * x[0]);
        J(i, 1) = t * scree_exp(-t * x[1]);
        J(i, 2) = scree_exp(-(i + 1.0)) - scree_exp(-t);
    }
}

static void jennrich_0(int n, double *x) { set(n, x, (const double[]){0.3, 0.4}); }
static void jennrich(int n, int m, const double *x, double *r) {
    (void)n;
    for (int i = 0; i < m; i++) r[i] = 2.0 + 2.0 * (i + 1) - scree_exp((i + 1) * x[0]) - scree_exp((i + 1) * x[1]);
}
static void jennrich_j(int n, int m, const double *x, double *j) {
    (void)n;
    for (int i = 0; i < m; i++)
        for (int k = 0; k < 2; k++) J(i, k) = -(i + 1) * scree_exp((i + 1) * x[k]);
}

static void brown_dennis_0(int n, double *x) { set(n, x, (const double[]){25.0, 5.0, -5.0, -1.0}); }
static void brown_dennis(int n, int m, const double *x, double *r) {
    (void)n;
    for (int i = 0; i < m; i++) {
        double t = (i + 1) / 5.0, a = x[0] + t * x[1] - scree_exp(t), b = x[2] + x[3] * sin(t) - cos(t);
        r[i] = a * a + b * b;
    }
}
static void brown_dennis_j(int n, int m, const double *x, double *j) {
    (void)n;
    for (int i = 0; i < m; i++) {
        double t = (i + 1) / 5.0, a = x[0] + t * x[1] - scree_exp(t), b = x[2] + x[3] * sin(t) - cos(t);
        J(i, 0) = 2.0 * a;
        J(i, 1) = 2.0 * a * t;
        J(i, 2) = 2.0 * b;
        J(i, 3) = 2.0 * b * sin(t);
    }
}

/* Shifted Chebyshev polynomials by their recurrence, and their derivatives by its derivative. */
static void chebyquad_0(int n, double *x) {
    for (int k = 0; k < n; k++) x[k] = (k + 1.0) / (n + 1.0);
}
static void chebyquad(int n, int m, const double *x, double *r) {
    fill(m, r, 0.0);
    for (int k = 0; k < n; k++) {
        double before = 1.0, value = 2.0 * x[k] - 1.0, twice = 2.0 * value;
        for (int i = 0; i < m; i++) {
            r[i] += value / n;
            double next = twice * value - before;
            before = value;
            value = next;
        }
    }
    for (int i = 1; i < m; i += 2) r[i] += 1.0 / ((i + 1.0) * (i + 1.0) - 1.0);
}
static void chebyquad_j(int n, int m, const double *x, double *j) {
    for (int k = 0; k < n; k++) {
        double before = 1.0, value = 2.0 * x[k] - 1.0, twice = 2.0 * value, slope_before = 0.0, slope = 2.0;
        for (int i = 0; i < m; i++) {
            J(i, k) = slope / n;
            double next_slope = 4.0 * value + twice * slope - slope_before, next = twice * value - before;
            slope_before = slope;
            slope = next_slope;
            before = value;
            value = next;
        }
    }
}

static void halves(int n, double *x) { fill(n, x, 0.5); }
static void brown_almost(int n, int m, const double *x, double *r) {
    (void)m;
    double sum = -(n + 1.0), product = 1.0;
    for (int k = 0; k < n; k++) {
        sum += x[k];
        product *= x[k];
    }
    for (int i = 0; i < n - 1; i++) r[i] = x[i] + sum;
    r[n - 1] = product - 1.0;
}
static void brown_almost_j(int n, int m, const double *x, double *j) {
    for (int k = 0; k < n; k++) {
        double product = 1.0;
        for (int i = 0; i < n - 1; i++) J(i, k) = 1.0 + (i == k);
        for (int i = 0; i < n; i++) product *= i == k ? 1.0 : x[i];
        J(n - 1, k) = product;
    }
}

static const double osborne1_y[33] = {0.844, 0.908, 0.932, 0.936, 0.925, 0.908, 0.881, 0.85,  0.818, 0.784, 0.751,
                                      0.718, 0.685, 0.658, 0.628, 0.603, 0.58,  0.558, 0.538, 0.522, 0.506, 0.49,
                                      0.478, 0.467, 0.457, 0.448, 0.438, 0.431, 0.424, 0.42,  0.414, 0.411, 0.406};
static void osborne1_0(int n, double *x) { set(n, x, (const double[]){0.5, 1.5, -1.0, 0.01, 0.02}); }
static void osborne1(int n, int m, const double *x, double *r) {
    (void)n;
    for (int i = 0; i < m; i++)
        r[i] = osborne1_y[i] - (x[0] + x[1] * scree_exp(-10.0 * i * x[3]) + x[2] * scree_exp(-10.0 * i * x[4]));
}
static void osborne1_j(int n, int m, const double *x, double *j) {
    (void)n;
    for (int i = 0; i < m; i++) {
        double t = 10.0 * i, e = scree_exp(-t * x[3]), f = scree_exp(-t * x[4]);
        J(i, 0) = -1.0;
        J(i, 1) = -e;
        J(i, 2) = -f;
        J(i, 3) = t * x[1] * e;
        J(i, 4) = t * x[2] * f;
    }
}

static const double osborne2_y[65] = {1.366, 1.191, 1.112, 1.013, 0.991, 0.885, 0.831, 0.847, 0.786, 0.725, 0.746,
                                      0.679, 0.608, 0.655, 0.616, 0.606, 0.602, 0.626, 0.651, 0.724, 0.649, 0.649,
                                      0.694, 0.644, 0.624, 0.661, 0.612, 0.558, 0.533, 0.495, 0.5,   0.423, 0.395,
                                      0.375, 0.372, 0.391, 0.396, 0.405, 0.428, 0.429, 0.523, 0.562, 0.607, 0.653,
                                      0.672, 0.708, 0.633, 0.668, 0.645, 0.632, 0.591, 0.559, 0.597, 0.625, 0.739,
                                      0.71,  0.729, 0.72,  0.636, 0.581, 0.428, 0.292, 0.162, 0.098, 0.054};
static void osborne2_0(int n, double *x) {
    set(n, x, (const double[]){1.3, 0.65, 0.65, 0.7, 0.6, 3.0, 5.0, 7.0, 2.0, 4.5, 5.5});
}
static void osborne2(int n, int m, const double *x, double *r) {
    (void)n;
    for (int i = 0; i < m; i++) {
        double t = i / 10.0, sum = x[0] * scree_exp(-t * x[4]);
        for (int k = 1; k < 4; k++) sum += x[k] * scree_exp(-(t - x[7 + k]) * (t - x[7 + k]) * x[4 + k]);
        r[i] = osborne2_y[i] - sum;
    }
}
static void osborne2_j(int n, int m, const double *x, double *j) {
    (void)n;
    for (int i = 0; i < m; i++) {
        double t = i / 10.0, e = scree_exp(-t * x[4]);
        J(i, 0) = -e;
        J(i, 4) = x[0] * t * e;
        for (int k = 1; k < 4; k++) {
            double d = t - x[7 + k], f = scree_exp(-d * d * x[4 + k]);
            J(i, k) = -f;
            J(i, 4 + k) = x[k] * d * d * f;
            J(i, 7 + k) = -2.0 * x[k] * d * x[4 + k] * f;
        }
    }
}

static void powell_bad_0(int n, double *x) { set(n, x, (const double[]){0.0, 1.0}); }
static void powell_bad(int n, int m, const double *x, double *r) {
    (void)n, (void)m;
    r[0] = 1e4 * x[0] * x[1] - 1.0;
    r[1] = scree_exp(-x[0]) + scree_exp(-x[1]) - 1.0001;
}
static void powell_bad_j(int n, int m, const double *x, double *j) {
    (void)n;
    J(0, 0) = 1e4 * x[1];
    J(0, 1) = 1e4 * x[0];
    J(1, 0) = -scree_exp(-x[0]);
    J(1, 1) = -scree_exp(-x[1]);
}

static void brown_bad(int n, int m, const double *x, double *r) {
    (void)n, (void)m;
    r[0] = x[0] - 1e6;
    r[1] = x[1] - 2e-6;
    r[2] = x[0] * x[1] - 2.0;
}
static void brown_bad_j(int n, int m, const double *x, double *j) {
    memset(j, 0, (size_t)(n * m) * sizeof *j);
    J(0, 0) = J(1, 1) = 1.0;
    J(2, 0) = x[1];
    J(2, 1) = x[0];
}

static const double beale_y[3] = {1.5, 2.25, 2.625};
static void beale(int n, int m, const double *x, double *r) {
    (void)n;
    for (int i = 0; i < m; i++) r[i] = beale_y[i] - x[0] * (1.0 - pow(x[1], i + 1));
}
static void beale_j(int n, int m, const double *x, double *j) {
    (void)n;
    for (int i = 0; i < m; i++) {
        J(i, 0) = pow(x[1], i + 1) - 1.0;
        J(i, 1) = x[0] * (i + 1) * pow(x[1], i);
    }
}

static const double gaussian_y[15] = {0.0009, 0.0044, 0.0175, 0.054, 0.1295, 0.242,  0.3521, 0.3989,
                                      0.3521, 0.242,  0.1295, 0.054, 0.0175, 0.0044, 0.0009};
static void gaussian_0(int n, double *x) { set(n, x, (const double[]){0.4, 1.0, 0.0}); }
static void gaussian(int n, int m, const double *x, double *r) {
    (void)n;
    for (int i = 0; i < m; i++) {
        double d = (7.0 - i) / 2.0 - x[2];
        r[i] = x[0] * scree_exp(-0.5 * x[1] * d * d) - gaussian_y[i];
    }
}
static void gaussian_j(int n, int m, const double *x, double *j) {
    (void)n;
    for (int i = 0; i < m; i++) {
        double d = (7.0 - i) / 2.0 - x[2], e = scree_exp(-0.5 * x[1] * d * d);
        J(i, 0) = e;
        J(i, 1) = -0.5 * d * d * x[0] * e;
        J(i, 2) = x[0] * x[1] * d * e;
    }
}

static void gulf_0(int n, double *x) { set(n, x, (const double[]){5.0, 2.5, 0.15}); }
static void gulf(int n, int m, const double *x, double *r) {
    (void)n;
    for (int i = 0; i < m; i++) {
        double t = (i + 1) / 100.0, y = 25.0 + pow(-50.0 * log(t), 2.0 / 3.0);
        r[i] = scree_exp(-pow(fabs(y - x[1]), x[2]) / x[0]) - t;
    }
}
static void gulf_j(int n, int m, const double *x, double *j) {
    (void)n;
    for (int i = 0; i < m; i++) {
        double t = (i + 1) / 100.0, y = 25.0 + pow(-50.0 * log(t), 2.0 / 3.0), d = y - x[1], a = fabs(d);
        double p = pow(a, x[2]), e = scree_exp(-p / x[0]);
        J(i, 0) = e * p / (x[0] * x[0]);
        J(i, 1) = e * p * x[2] / (x[0] * d);
        J(i, 2) = -e * p * log(a) / x[0];
    }
}

static void wood_0(int n, double *x) { set(n, x, (const double[]){-3.0, -1.0, -3.0, -1.0}); }
static void wood(int n, int m, const double *x, double *r) {
    (void)n, (void)m;
    r[0] = 10.0 * (x[1] - x[0] * x[0]);
    r[1] = 1.0 - x[0];
    r[2] = sqrt(90.0) * (x[3] - x[2] * x[2]);
    r[3] = 1.0 - x[2];
    r[4] = sqrt(10.0) * (x[1] + x[3] - 2.0);
    r[5] = (x[1] - x[3]) / sqrt(10.0);
}
static void wood_j(int n, int m, const double *x, double *j) {
    memset(j, 0, (size_t)(n * m) * sizeof *j);
    J(0, 0) = -20.0 * x[0];
    J(0, 1) = 10.0;
    J(1, 0) = J(3, 2) = -1.0;
    J(2, 2) = -2.0 * sqrt(90.0) * x[2];
    J(2, 3) = sqrt(90.0);
    J(4, 1) = J(4, 3) = sqrt(10.0);
    J(5, 1) = 1.0 / sqrt(10.0);
    J(5, 3) = -1.0 / sqrt(10.0);
}

static void biggs_0(int n, double *x) { set(n, x, (const double[]){1.0, 2.0, 1.0, 1.0, 1.0, 1.0}); }
static void biggs(int n, int m, const double *x, double *r) {
    (void)n;
    for (int i = 0; i < m; i++) {
        double t = (i + 1) / 10.0, y = scree_exp(-t) - 5.0 * scree_exp(-10.0 * t) + 3.0 * scree_exp(-4.0 * t);
        r[i] = x[2] * scree_exp(-t * x[0]) - x[3] * scree_exp(-t * x[1]) + x[5] * scree_exp(-t * x[4]) - y;
    }
}
static void biggs_j(int n, int m, const double *x, double *j) {
    (void)n;
    for (int i = 0; i < m; i++) {
        double t = (i + 1) / 10.0;
        J(i, 2) = scree_exp(-t * x[0]);
        J(i, 0) = -t * x[2] * J(i, 2);
        J(i, 3) = -scree_exp(-t * x[1]);
        J(i, 1) = -t * x[3] * J(i, 3);
        J(i, 5) = scree_exp(-t * x[4]);
        J(i, 4) = -t * x[5] * J(i, 5);
    }
}

static void one_two_three(int n, double *x) {
    for (int k = 0; k < n; k++) x[k] = k + 1;
}
static void penalty1(int n, int m, const double *x, double *r) {
    (void)m;
    double sum = 0.0;
    for (int k = 0; k < n; k++) {
        r[k] = sqrt(1e-5) * (x[k] - 1.0);
        sum += x[k] * x[k];
    }
    r[n] = sum - 0.25;
}
static void penalty1_j(int n, int m, const double *x, double *j) {
    memset(j, 0, (size_t)(n * m) * sizeof *j);
    for (int k = 0; k < n; k++) {
        J(k, k) = sqrt(1e-5);
        J(n, k) = 2.0 * x[k];
    }
}

static void penalty2(int n, int m, const double *x, double *r) {
    (void)m;
    double root = sqrt(1e-5), sum = 0.0;
    r[0] = x[0] - 0.2;
    for (int i = 1; i < n; i++) {
        double y = scree_exp((i + 1) / 10.0) + scree_exp(i / 10.0);
        r[i] = root * (scree_exp(x[i] / 10.0) + scree_exp(x[i - 1] / 10.0) - y);
        r[n + i - 1] = root * (scree_exp(x[i] / 10.0) - scree_exp(-0.1));
    }
    for (int k = 0; k < n; k++) sum += (n - k) * x[k] * x[k];
    r[2 * n - 1] = sum - 1.0;
}
static void penalty2_j(int n, int m, const double *x, double *j) {
    double root = sqrt(1e-5);
    memset(j, 0, (size_t)(n * m) * sizeof *j);
    J(0, 0) = 1.0;
    for (int i = 1; i < n; i++) {
        J(i, i) = root * scree_exp(x[i] / 10.0) / 10.0;
        J(i, i - 1) = root * scree_exp(x[i - 1] / 10.0) / 10.0;
        J(n + i - 1, i) = J(i, i);
    }
    for (int k = 0; k < n; k++) J(2 * n - 1, k) = 2.0 * (n - k) * x[k];
}

static void variably_0(int n, double *x) {
    for (int k = 0; k < n; k++) x[k] = 1.0 - (k + 1.0) / n;
}
static void variably(int n, int m, const double *x, double *r) {
    (void)m;
    double sum = 0.0;
    for (int k = 0; k < n; k++) {
        r[k] = x[k] - 1.0;
        sum += (k + 1) * (x[k] - 1.0);
    }
    r[n] = sum;
    r[n + 1] = sum * sum;
}
static void variably_j(int n, int m, const double *x, double *j) {
    memset(j, 0, (size_t)(n * m) * sizeof *j);
    double sum = 0.0;
    for (int k = 0; k < n; k++) sum += (k + 1) * (x[k] - 1.0);
    for (int k = 0; k < n; k++) {
        J(k, k) = 1.0;
        J(n, k) = k + 1;
        J(n + 1, k) = 2.0 * sum * (k + 1);
    }
}

static void trigonometric_0(int n, double *x) { fill(n, x, 1.0 / n); }
static void trigonometric(int n, int m, const double *x, double *r) {
    (void)m;
    double sum = 0.0;
    for (int k = 0; k < n; k++) sum += cos(x[k]);
    for (int i = 0; i < n; i++) r[i] = n - sum + (i + 1) * (1.0 - cos(x[i])) - sin(x[i]);
}
static void trigonometric_j(int n, int m, const double *x, double *j) {
    for (int k = 0; k < n; k++)
        for (int i = 0; i < n; i++) J(i, k) = sin(x[k]) + (i == k ? (i + 1) * sin(x[i]) - cos(x[i]) : 0.0);
}

const struct mgh mgh_problems[MGH_PROBLEMS] = {
    {"LinFull", 5, 10, 1, 5.0, {0}, ones, full_rank, full_rank_j},
    {"LinFull", 5, 50, 1, 45.0, {0}, ones, full_rank, full_rank_j},
    {"LinR1", 5, 10, 1, 2.142857142857143, {0}, ones, rank_one, rank_one_j},
    {"LinR1", 5, 50, 1, 12.128712871287128, {0}, ones, rank_one, rank_one_j},
    {"LinR1z", 5, 10, 1, 3.6470588235294117, {0}, ones, rank_one_zero, rank_one_zero_j},
    {"LinR1z", 5, 50, 1, 13.628865979381443, {0}, ones, rank_one_zero, rank_one_zero_j},
    {"Rosenbrock", 2, 2, 3, 0.0, {0}, rosenbrock_0, rosenbrock, rosenbrock_j},
    {"Helical", 3, 3, 3, 0.0, {0}, helical_0, helical, helical_j},
    {"PowellSing", 4, 4, 3, 0.0, {0}, powell_0, powell, powell_j},
    {"FreudRoth", 2, 2, 3, 0.0, {48.98425367924}, freudenstein_0, freudenstein, freudenstein_j},
    {"Bard", 3, 15, 3, 8.21487730657897e-3, {17.42869333333}, ones, bard, bard_j},
    {"Kowalik", 4, 11, 3, 3.07505603849e-4, {1.02734e-3}, kowalik_0, kowalik, kowalik_j},
    {"Meyer", 3, 16, 2, 87.9458551708, {0}, meyer_0, meyer, meyer_j},
    {"Watson", 6, 31, 3, 2.28767005355e-3, {0}, zeros, watson, watson_j},
    {"Watson", 9, 31, 3, 1.39976013836e-6, {0}, zeros, watson, watson_j},
    {"Watson", 12, 31, 3, 4.72238e-10, {0}, zeros, watson, watson_j},
    {"Box3D", 3, 10, 1, 0.0, {0}, box3_0, box3, box3_j},
    {"Jennrich", 2, 10, 1, 124.362182355, {0}, jennrich_0, jennrich, jennrich_j},
    {"BrownDennis", 4, 20, 3, 85822.2016263, {0}, brown_dennis_0, brown_dennis, brown_dennis_j},
    {"Chebyquad", 1, 8, 3, 3.0665272324, {3.550391298, 3.5578937}, chebyquad_0, chebyquad, chebyquad_j},
    {"Chebyquad", 8, 8, 1, 3.516873725e-3, {0}, chebyquad_0, chebyquad, chebyquad_j},
    {"Chebyquad", 9, 9, 1, 0.0, {0}, chebyquad_0, chebyquad, chebyquad_j},
    {"Chebyquad", 10, 10, 1, 4.772713696e-3, {6.503954801e-3}, chebyquad_0, chebyquad, chebyquad_j},
    {"BrownAL", 10, 10, 3, 0.0, {1.0}, halves, brown_almost, brown_almost_j},
    {"BrownAL", 30, 30, 1, 0.0, {1.0}, halves, brown_almost, brown_almost_j},
    {"BrownAL", 40, 40, 1, 0.0, {1.0}, halves, brown_almost, brown_almost_j},
    {"Osborne1", 5, 33, 1, 5.46489469748e-5, {0}, osborne1_0, osborne1, osborne1_j},
    {"Osborne2", 11, 65, 1, 4.01377362935e-2, {0}, osborne2_0, osborne2, osborne2_j},
    {"PowellBad", 2, 2, 3, 0.0, {0}, powell_bad_0, powell_bad, powell_bad_j},
    {"BrownBad", 2, 3, 3, 0.0, {0}, ones, brown_bad, brown_bad_j},
    {"Beale", 2, 3, 3, 0.0, {0.4520}, ones, beale, beale_j},
    {"Gaussian", 3, 15, 3, 1.12793276961912e-8, {0}, gaussian_0, gaussian, gaussian_j},
    {"Gulf", 3, 99, 3, 0.0, {0.0380}, gulf_0, gulf, gulf_j},
    {"Wood", 4, 6, 3, 0.0, {0}, wood_0, wood, wood_j},
    {"Biggs6", 6, 13, 3, 0.0, {5.65564992e-3, 0.3063667725}, biggs_0, biggs, biggs_j},
    {"PenaltyI", 4, 5, 3, 2.24997750e-5, {0}, one_two_three, penalty1, penalty1_j},
    {"PenaltyII", 4, 8, 3, 9.37629e-6, {0}, halves, penalty2, penalty2_j},
    {"VarDim", 10, 12, 3, 0.0, {0}, variably_0, variably, variably_j},
    {"Trig", 10, 10, 3, 0.0, {2.79506e-5}, trigonometric_0, trigonometric, trigonometric_j},
};

static int residual(void *context, const double *x, double *r) {
    const struct mgh *problem = context;
    problem->residual(problem->n, problem->m, x, r);
    return 0;
}

static int jacobian(void *context, const double *x, double *j) {
    const struct mgh *problem = context;
    problem->jacobian(problem->n, problem->m, x, j);
    return 0;
}

scree_lm_problem mgh_problem(const struct mgh *problem) {
    return (scree_lm_problem){.unknowns = problem->n,
                              .residuals = problem->m,
                              .residual = residual,
                              .jacobian = jacobian,
                              .context = (void *)(uintptr_t)problem};
}

void mgh_start(const struct mgh *problem, int run, double *x) {
    static const double factors[3] = {1.0, 10.0, 100.0};
    int zero = 1;
    problem->start(problem->n, x);
    for (int k = 0; k < problem->n; k++) zero &= x[k] == 0.0;
    for (int k = 0; k < problem->n && run > 0; k++) x[k] = zero ? factors[run] : x[k] * factors[run];
}

enum mgh_kind mgh_judge(const struct mgh *problem, const double *x) {
    double r[100], sum = 0.0;
    problem->residual(problem->n, problem->m, x, r);
    for (int k = 0; k < problem->m; k++) sum += r[k] * r[k];
    double least = problem->minimum, limit = least * (1.0 + (least < 1e-8 ? 1e-4 : 1e-6));
    if (sum <= (least == 0.0 ? 1e-10 : limit)) return MGH_GLOBAL;
    for (int k = 0; k < 2; k++) /* printed with four digits at least */
        if (problem->local[k] > 0.0 && fabs(sum / problem->local[k] - 1.0) <= 5e-4) return MGH_LOCAL;
    return MGH_NEITHER;
}
