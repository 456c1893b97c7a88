/* The nonlinear regression problems of NIST's Statistical Reference Datasets (itl.nist.gov/div898/strd), models with
 * analytic derivatives; data, starts and certified values are read from NIST's own files. */
#include "bench/problems.h"

#include "bodies/elementary.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double pi = 3.14159265358979323846;

/* With elementary functions that give the same bits everywhere: on the hard problems an iteration's way depends on
 * every bit. */
static double logarithm(double x) { return x > 0.0 ? scree_log(x) : NAN; }
static double power(double x, double p) { return scree_exp(p * logarithm(x)); }

static double misra1a(const double *b, const double *x, double *g) {
    double e = scree_exp(-b[1] * x[0]);
    g[0] = 1.0 - e;
    g[1] = b[0] * x[0] * e;
    return b[0] * (1.0 - e);
}

static double misra1b(const double *b, const double *x, double *g) {
    double q = 1.0 + 0.5 * b[1] * x[0];
    g[0] = 1.0 - 1.0 / (q * q);
    g[1] = b[0] * x[0] / (q * q * q);
    return b[0] * g[0];
}

static double misra1c(const double *b, const double *x, double *g) {
    double q = 1.0 + 2.0 * b[1] * x[0], root = sqrt(q);
    g[0] = 1.0 - 1.0 / root;
    g[1] = b[0] * x[0] / (q * root);
    return b[0] * g[0];
}

static double misra1d(const double *b, const double *x, double *g) {
    double q = 1.0 + b[1] * x[0];
    g[0] = b[1] * x[0] / q;
    g[1] = b[0] * x[0] / (q * q);
    return b[0] * g[0];
}

static double chwirut(const double *b, const double *x, double *g) {
    double e = scree_exp(-b[0] * x[0]), q = b[1] + b[2] * x[0], f = e / q;
    g[0] = -x[0] * f;
    g[1] = -f / q;
    g[2] = -x[0] * f / q;
    return f;
}

static double lanczos(const double *b, const double *x, double *g) {
    double f = 0.0;
    for (int k = 0; k < 6; k += 2) {
        double e = scree_exp(-b[k + 1] * x[0]);
        g[k] = e;
        g[k + 1] = -x[0] * b[k] * e;
        f += b[k] * e;
    }
    return f;
}

static double gauss(const double *b, const double *x, double *g) {
    double e = scree_exp(-b[1] * x[0]), f = b[0] * e;
    g[0] = e;
    g[1] = -x[0] * b[0] * e;
    for (int k = 2; k < 8; k += 3) {
        double t = (x[0] - b[k + 1]) / b[k + 2], h = scree_exp(-t * t);
        g[k] = h;
        g[k + 1] = b[k] * h * 2.0 * t / b[k + 2];
        g[k + 2] = b[k] * h * 2.0 * t * t / b[k + 2];
        f += b[k] * h;
    }
    return f;
}

static double danwood(const double *b, const double *x, double *g) {
    g[0] = power(x[0], b[1]);
    g[1] = b[0] * g[0] * logarithm(x[0]);
    return b[0] * g[0];
}

/* Polynomial of `above` coefficients over 1 + polynomial without constant of `below`. */
static double rational(const double *b, double x, int above, int below, double *g) {
    double numerator = 0.0, denominator = 1.0, power = 1.0;
    for (int k = 0; k < above; k++, power *= x) numerator += b[k] * power;
    power = x;
    for (int k = 0; k < below; k++, power *= x) denominator += b[above + k] * power;
    double f = numerator / denominator;
    power = 1.0;
    for (int k = 0; k < above; k++, power *= x) g[k] = power / denominator;
    power = x;
    for (int k = 0; k < below; k++, power *= x) g[above + k] = -f * power / denominator;
    return f;
}

static double kirby(const double *b, const double *x, double *g) { return rational(b, x[0], 3, 2, g); }
static double hahn(const double *b, const double *x, double *g) { return rational(b, x[0], 4, 3, g); }

static double nelson(const double *b, const double *x, double *g) {
    double e = scree_exp(-b[2] * x[1]);
    g[0] = 1.0;
    g[1] = -x[0] * e;
    g[2] = b[1] * x[0] * x[1] * e;
    return b[0] - b[1] * x[0] * e;
}

static double mgh17(const double *b, const double *x, double *g) {
    double e = scree_exp(-x[0] * b[3]), h = scree_exp(-x[0] * b[4]);
    g[0] = 1.0;
    g[1] = e;
    g[2] = h;
    g[3] = -x[0] * b[1] * e;
    g[4] = -x[0] * b[2] * h;
    return b[0] + b[1] * e + b[2] * h;
}

static double roszman(const double *b, const double *x, double *g) {
    double d = x[0] - b[3], q = d * d + b[2] * b[2];
    g[0] = 1.0;
    g[1] = -x[0];
    g[2] = -d / q / pi;
    g[3] = -b[2] / q / pi;
    return b[0] - b[1] * x[0] - atan(b[2] / d) / pi;
}

static double enso(const double *b, const double *x, double *g) {
    double a = 2.0 * pi * x[0] / 12.0, p = 2.0 * pi * x[0] / b[3], q = 2.0 * pi * x[0] / b[6];
    g[0] = 1.0;
    scree_sincos(a, &g[2], &g[1]);
    scree_sincos(p, &g[5], &g[4]);
    scree_sincos(q, &g[8], &g[7]);
    g[3] = (b[4] * g[5] - b[5] * g[4]) * p / b[3];
    g[6] = (b[7] * g[8] - b[8] * g[7]) * q / b[6];
    return b[0] + b[1] * g[1] + b[2] * g[2] + b[4] * g[4] + b[5] * g[5] + b[7] * g[7] + b[8] * g[8];
}

static double mgh09(const double *b, const double *x, double *g) {
    double above = x[0] * (x[0] + b[1]), below = x[0] * (x[0] + b[2]) + b[3], f = b[0] * above / below;
    g[0] = above / below;
    g[1] = b[0] * x[0] / below;
    g[2] = -f * x[0] / below;
    g[3] = -f / below;
    return f;
}

static double rat42(const double *b, const double *x, double *g) {
    double e = scree_exp(b[1] - b[2] * x[0]), q = 1.0 + e;
    g[0] = 1.0 / q;
    g[1] = -b[0] * e / (q * q);
    g[2] = b[0] * x[0] * e / (q * q);
    return b[0] / q;
}

static double rat43(const double *b, const double *x, double *g) {
    double e = scree_exp(b[1] - b[2] * x[0]), q = 1.0 + e, f = power(q, -1.0 / b[3]);
    g[0] = f;
    g[1] = -b[0] * f * e / (q * b[3]);
    g[2] = b[0] * f * x[0] * e / (q * b[3]);
    g[3] = b[0] * f * logarithm(q) / (b[3] * b[3]);
    return b[0] * f;
}

static double mgh10(const double *b, const double *x, double *g) {
    double q = x[0] + b[2], e = scree_exp(b[1] / q);
    g[0] = e;
    g[1] = b[0] * e / q;
    g[2] = -b[0] * e * b[1] / (q * q);
    return b[0] * e;
}

static double eckerle(const double *b, const double *x, double *g) {
    double t = (x[0] - b[2]) / b[1], e = scree_exp(-0.5 * t * t), f = b[0] / b[1] * e;
    g[0] = e / b[1];
    g[1] = f * (t * t - 1.0) / b[1];
    g[2] = f * t / b[1];
    return f;
}

static double bennett(const double *b, const double *x, double *g) {
    double q = b[1] + x[0], p = power(q, -1.0 / b[2]);
    g[0] = p;
    g[1] = -b[0] * p / (q * b[2]);
    g[2] = b[0] * p * logarithm(q) / (b[2] * b[2]);
    return b[0] * p;
}

static const struct {
    const char *name;
    int parameters;
    double (*model)(const double *b, const double *x, double *g);
} models[NIST_PROBLEMS] = {
    {"Misra1a", 2, misra1a},  {"Chwirut2", 3, chwirut}, {"Chwirut1", 3, chwirut}, {"Lanczos3", 6, lanczos},
    {"Gauss1", 8, gauss},     {"Gauss2", 8, gauss},     {"DanWood", 2, danwood},  {"Misra1b", 2, misra1b},
    {"Kirby2", 5, kirby},     {"Hahn1", 7, hahn},       {"Nelson", 3, nelson},    {"MGH17", 5, mgh17},
    {"Lanczos1", 6, lanczos}, {"Lanczos2", 6, lanczos}, {"Gauss3", 8, gauss},     {"Misra1c", 2, misra1c},
    {"Misra1d", 2, misra1d},  {"Roszman1", 4, roszman}, {"ENSO", 9, enso},        {"MGH09", 4, mgh09},
    {"Thurber", 7, hahn},     {"BoxBOD", 2, misra1a},   {"Rat42", 3, rat42},      {"MGH10", 3, mgh10},
    {"Eckerle4", 3, eckerle}, {"Rat43", 4, rat43},      {"Bennett5", 3, bennett},
};

/* "b1 = start start certified deviation" */
static int read_parameter(const char *line, struct nist *problem) {
    int number;
    double v[4];
    if (sscanf(line, " b%d = %lf %lf %lf %lf", &number, &v[0], &v[1], &v[2], &v[3]) != 5) return 0;
    if (number < 1 || number > problem->parameters) return 0;
    problem->start[0][number - 1] = v[0];
    problem->start[1][number - 1] = v[1];
    problem->certified[number - 1] = v[2];
    problem->deviation[number - 1] = v[3];
    return 1;
}

static int read_refined(const char *folder, struct nist *problem) {
    char path[1024], line[256], name[32], what[32];
    double value;
    int found = 0;
    snprintf(path, sizeof path, "%s/nist/reference_quad.csv", folder);
    FILE *file = fopen(path, "r");
    while (file && fgets(line, sizeof line, file)) {
        if (sscanf(line, "%31[^,],%31[^,],%lf", name, what, &value) != 3 || strcmp(name, problem->name) != 0 ||
            what[0] != 'b')
            continue;
        problem->refined[atoi(what + 1) - 1] = value;
        found++;
    }
    if (file) fclose(file);
    return found == problem->parameters;
}

int nist_load(int index, const char *folder, struct nist *problem) {
    *problem =
        (struct nist){.name = models[index].name, .parameters = models[index].parameters, .model = models[index].model};
    problem->takes_log = strcmp(problem->name, "Nelson") == 0;
    char path[1024], line[256];
    snprintf(path, sizeof path, "%s/nist/%s.dat", folder, problem->name);
    FILE *file = fopen(path, "r");
    int parameters = 0, data = 0;
    while (file && fgets(line, sizeof line, file)) {
        double y, x0, x1 = 0.0;
        parameters += read_parameter(line, problem);
        if (sscanf(line, " Residual Sum of Squares: %lf", &y) == 1) problem->certified_rss = y;
        if (strncmp(line, "Data:", 5) == 0) data++;
        /* "Data:" stands twice: in the description and above the numbers. */
        if (data < 2 || problem->rows == NIST_ROWS || sscanf(line, "%lf %lf %lf", &y, &x0, &x1) < 2) continue;
        problem->y[problem->rows] = problem->takes_log ? log(y) : y;
        problem->x[0][problem->rows] = x0;
        problem->x[1][problem->rows++] = x1;
    }
    if (file) fclose(file);
    return !(file && parameters == problem->parameters && problem->rows > parameters && read_refined(folder, problem));
}

static int residual(void *context, const double *b, double *r) {
    struct nist *problem = context;
    double g[NIST_PARAMETERS];
    problem->evaluations++;
    for (int k = 0; k < problem->rows; k++) {
        double x[2] = {problem->x[0][k], problem->x[1][k]};
        r[k] = problem->model(b, x, g) - problem->y[k];
    }
    return 0;
}

static int jacobian(void *context, const double *b, double *j) {
    struct nist *problem = context;
    double g[NIST_PARAMETERS];
    problem->jacobians++;
    for (int k = 0; k < problem->rows; k++) {
        double x[2] = {problem->x[0][k], problem->x[1][k]};
        problem->model(b, x, g);
        for (int p = 0; p < problem->parameters; p++) j[p * problem->rows + k] = g[p];
    }
    return 0;
}

scree_lm_problem nist_problem(struct nist *problem) {
    return (scree_lm_problem){.unknowns = problem->parameters,
                              .residuals = problem->rows,
                              .residual = residual,
                              .jacobian = jacobian,
                              .context = problem};
}

double nist_digits(const struct nist *problem, const double *b) {
    double least = 17.0;
    for (int k = 0; k < problem->parameters; k++) {
        double error = fabs(b[k] / problem->refined[k] - 1.0);
        if (!(error < 1.0)) return 0.0;
        if (error > 0.0) least = scree_least(least, -log10(error));
    }
    return least;
}
