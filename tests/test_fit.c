/* Fits of scenes to records: what scenes say between steps, values and their intervals, and fit files. */
#include "engine/cli/fit_model.h"
#include "solver/student.h"
#include "tests/check.h"

#include <unistd.h>

/* ---- Student's distribution ---- */

static void test_student(void) {
    /* Closed forms for one and two degrees of freedom. */
    for (double c = 0.05; c < 1.0; c += 0.05) {
        CLOSE(scree_student_bound(c, 1), tan(0.5 * 3.14159265358979323846 * c), 1e-13);
        CLOSE(scree_student_bound(c, 2), c * sqrt(2.0 / (1.0 - c * c)), 1e-13);
    }
    /* Abramowitz and Stegun, table 26.10, to its three digits; and the normal distribution's 1.959963984540 at many
     * degrees of freedom n, from which it is off by 1.96 (1.96^2 + 1)/(4 n). */
    static const struct {
        long freedom;
        double t95, t99;
    } table[] = {{3, 3.182, 5.841},  {4, 2.776, 4.604},  {5, 2.571, 4.032},  {10, 2.228, 3.169},
                 {15, 2.131, 2.947}, {30, 2.042, 2.750}, {60, 2.000, 2.660}, {120, 1.980, 2.617}};
    for (size_t k = 0; k < sizeof table / sizeof table[0]; k++) {
        NEAR(scree_student_bound(0.95, table[k].freedom), table[k].t95, 5.1e-4);
        NEAR(scree_student_bound(0.99, table[k].freedom), table[k].t99, 5.1e-4);
    }
    NEAR(scree_student_bound(0.95, 100000), 1.959963984540 + 2.3722e-5, 1e-8);
    CHECK(isnan(scree_student_bound(0.0, 5)) && isnan(scree_student_bound(1.0, 5)) &&
          isnan(scree_student_bound(0.5, 0)) && isnan(scree_student_bound(NAN, 5)));
}

/* ---- files of a test ---- */

static char folder[] = "/tmp/scree-test-XXXXXX";

static void write_file(const char *name, const char *text) {
    char path[64];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    FILE *file = fopen(path, "w");
    CHECK(file && fputs(text, file) >= 0 && fclose(file) == 0);
}

static scree_status read_fit(const char *text, struct fit_file *file, scree_trouble *trouble) {
    char path[64];
    write_file("fit.toml", text);
    snprintf(path, sizeof path, "%s/fit.toml", folder);
    return fit_file_read(path, NULL, 0, file, trouble);
}

/* A fit that must be read. */
static struct fit_file fit_of(const char *text) {
    struct fit_file file;
    scree_trouble trouble = {0};
    CHECK(read_fit(text, &file, &trouble) == SCREE_OK);
    if (trouble.status) printf("%s\n", trouble.text);
    return file;
}

/* A ball that falls by 20 mm, bounces once (k = 1000 N/m, e = 0.6, m = 10 g: in contact for 10 ms), and spins. */
static const char scene[] = "gravity = [0, 0, -9.81]\n"
                            "[time]\nend = 0.16\nstep = 2e-4\nintegrator = \"verlet\"\n"
                            "[[material]]\nname = \"m\"\n"
                            "[[contact]]\nbetween = [\"m\", \"m\"]\n"
                            "normal = { law = \"linear\", stiffness = 1000, restitution = 0.6 }\n"
                            "[[body]]\nname = \"ball\"\nshape = { sphere = 0.01 }\nmaterial = \"m\"\nmass = 0.01\n"
                            "position = [0, 0, 0.03]\nvelocity = [0.1, 0, 0]\nspin = [0, 0, 3]\n"
                            "[[body]]\nname = \"floor\"\nshape = { plane = true }\nmaterial = \"m\"\n"
                            "joint = \"fixed\"\n";

enum { ROWS = 60 };

/* A record of that many rows, the k-th at (k + 0.37) 2.6 ms: off the steps. The readings are put in later. */
static void write_record(const char *columns) {
    char text[8192];
    int length = snprintf(text, sizeof text, "time_s,%s\n", columns), count = 1;
    for (const char *c = columns; *c; c++) count += *c == ',';
    for (int k = 0; k < ROWS; k++) {
        length += snprintf(text + length, sizeof text - (size_t)length, "%.17g", (k + 0.37) * 2.6e-3);
        for (int c = 0; c < count; c++) length += snprintf(text + length, sizeof text - (size_t)length, ",0");
        length += snprintf(text + length, sizeof text - (size_t)length, "\n");
    }
    write_file("record.csv", text);
}

#define EXPERIMENT "[[experiment]]\nscene = \"scene.toml\"\nbody = \"ball\"\nrecord = \"record.csv\"\n"

static const char bounce[] = "[parameter]\nstiffness = { start = 1400, min = 10 }\n"
                             "restitution = { start = 0.8, min = 0.01, max = 1 }\n" EXPERIMENT
                             "set = [\"contact.0.normal.stiffness={stiffness}\",\n"
                             "       \"contact.0.normal.restitution={restitution}\"]\n";
static const double truth[2] = {1000.0, 0.6};

/* Let the scene say the readings of the first experiment, with parameters `x`. */
static void measure(struct fit_file *file, const double *x) {
    struct fit_experiment *e = &file->experiment[0];
    double *values = malloc(e->rows * (size_t)e->columns * sizeof *values), taken;
    scree_trouble trouble = {0};
    CHECK(fit_simulate(file, 0, x, 0.0, values, &taken, &trouble) == SCREE_OK);
    for (int c = 0; c < e->columns; c++) memcpy(e->reading[c], values + (size_t)c * e->rows, e->rows * sizeof *values);
    free(values);
}

static struct fit_result solved(const struct fit_file *file, int threads) {
    struct fit_result result;
    scree_trouble trouble = {0};
    CHECK(fit_solve(file, threads, NULL, &result, &trouble) == SCREE_OK);
    if (trouble.status) printf("%s\n", trouble.text);
    return result;
}

/* ---- what the scene says between steps ---- */

/* A ball in free flight: Verlet's method is exact there, and so is a cubic through its positions and velocities. */
static void test_between_steps(void) {
    write_record("x_m,z_m,vx_m_s,vz_m_s,wz_rad_s");
    struct fit_file file = fit_of("[parameter.step]\nstart = 1e-3\n" EXPERIMENT
                                  "deviation = { x_m = 1, z_m = 1, vx_m_s = 1, vz_m_s = 1, wz_rad_s = 1 }\n"
                                  "set = [\"time.step={step}\", \"body.ball.position=[0, 0, 1]\"]\n");
    const struct fit_experiment *e = &file.experiment[0];
    measure(&file, &file.parameter[0].start);
    for (size_t k = 0; k < e->rows; k++) {
        double t = e->time[k];
        NEAR(e->reading[0][k], 0.1 * t, 1e-15);
        NEAR(e->reading[1][k], 1.0 - 0.5 * 9.81 * t * t, 1e-14);
        /* A difference of positions over a step of 1e-3 s: their rounding, a thousandfold. */
        NEAR(e->reading[2][k], 0.1, 1e-12);
        NEAR(e->reading[3][k], -9.81 * t, 1e-12);
        NEAR(e->reading[4][k], 3.0, 1e-15); /* angular momentum over inertia */
    }
    fit_file_free(&file);
}

/* Steps from 4e-4 to 1e-4 s through an impact: the cubic's error doesn't hide the order two of the method. */
static void test_order(void) {
    write_record("z_m");
    struct fit_file file = fit_of("[parameter.step]\nstart = 1e-6\n" EXPERIMENT "set = [\"time.step={step}\"]\n");
    struct fit_experiment *e = &file.experiment[0];
    double reference[ROWS], error[3] = {0.0};
    measure(&file, &file.parameter[0].start);
    memcpy(reference, e->reading[0], sizeof reference);
    for (int k = 0; k < 3; k++) {
        double step = 4e-4 / (1 << k);
        measure(&file, &step);
        for (int row = 0; row < ROWS; row++) error[k] = scree_most(error[k], fabs(e->reading[0][row] - reference[row]));
    }
    /* The first touch falls somewhere into a step, which makes the ratio of 4 uneven. */
    CHECK(error[0] > 2.0 * error[1] && error[1] > 2.0 * error[2]);
    fit_file_free(&file);
}

/* ---- values ---- */

/* Readings that the scene itself has said lead back to its parameters. What is left is the convergence: the last step
 * from where a hundredth of nothing is still to be gained. */
static void test_exact(void) {
    write_record("z_m");
    struct fit_file file = fit_of(bounce);
    measure(&file, truth);
    struct fit_result one = solved(&file, 1), four = solved(&file, 4);
    CHECK(one.outcome.converged);
    CLOSE(one.value[0], truth[0], 1e-9);
    CLOSE(one.value[1], truth[1], 1e-9);
    /* Threads change nothing. */
    CHECK(memcmp(one.value, four.value, 8 * sizeof(double)) == 0);
    CHECK(memcmp(one.covariance, four.covariance, 4 * sizeof(double)) == 0);
    CHECK(memcmp(one.misfit, four.misfit, ROWS * sizeof(double)) == 0);
    fit_free_result(&one);
    fit_free_result(&four);
    fit_file_free(&file);
}

static double normal_random(uint64_t *seed) {
    double sum = -6.0;
    for (int k = 0; k < 12; k++) sum += check_random(seed);
    return sum;
}

/* Errors of many fits to noisy readings are as large as they say, and intervals of 95 % hold the truth as often. 100
 * fits of two parameters: the mean square of error over standard error is 1 within 0.14 (one standard deviation, if the
 * two were the same), of 58 degrees of freedom a little more; coverage 0.95 within 0.022. Four of these are allowed. */
static void test_intervals(void) {
    enum { FITS = 100 };
    const double noise = 2e-5;
    uint64_t seed = 9;
    write_record("z_m");
    struct fit_file file = fit_of(bounce);
    double clean[ROWS], squares[2] = {0.0}, covered[2] = {0.0};
    measure(&file, truth);
    memcpy(clean, file.experiment[0].reading[0], sizeof clean);
    for (int k = 0; k < 2; k++) file.parameter[k].start = truth[k] * 1.05;
    for (int fit = 0; fit < FITS; fit++) {
        for (int k = 0; k < ROWS; k++) file.experiment[0].reading[0][k] = clean[k] + noise * normal_random(&seed);
        struct fit_result result = solved(&file, 1);
        CHECK(result.outcome.converged && result.freedom == ROWS - 2);
        NEAR(result.scatter / noise, 1.0, 5.0 / sqrt(2.0 * (ROWS - 2)));
        for (int k = 0; k < 2; k++) {
            CHECK(result.state[k] == FIT_FREE);
            double off = (result.value[k] - truth[k]) / result.error[k];
            squares[k] += off * off / FITS;
            covered[k] += (result.low[k] < truth[k] && truth[k] < result.high[k]) / (double)FITS;
        }
        fit_free_result(&result);
    }
    for (int k = 0; k < 2; k++) {
        NEAR(squares[k], 1.0, 4 * 0.15);
        NEAR(covered[k], 0.95, 4 * 0.022);
    }
    fit_file_free(&file);
}

/* An automatic step goes with the stiffness, from a start four times too stiff; readings by a step 20 times as short.
 * At w h = pi/50 the first touch falls into a step, which is worth up to (w h)^2/8 of the speed v of 0.6 m/s; some 40
 * ms later that has moved the ball by e v (w h)^2/8 40 ms, which a stiffness off by (w h)^2 does too (by changing the
 * 10 ms of contact by half as much, at a mean speed of (1 + e) v/2). */
static void test_automatic_step(void) {
    write_record("z_m");
    struct fit_file file = fit_of(bounce), automatic;
    struct fit_experiment *e = &file.experiment[0];
    free(e->change[0]);
    e->change[0] = strdup("time.step=1e-5");
    measure(&file, truth);
    automatic = fit_of("[parameter]\nstiffness = { start = 4000, min = 10 }\n" EXPERIMENT
                       "set = [\"contact.0.normal.stiffness={stiffness}\", 'time.step=\"auto\"']\n");
    memcpy(automatic.experiment[0].reading[0], e->reading[0], e->rows * sizeof(double));
    struct fit_result result = solved(&automatic, 1);
    CHECK(result.outcome.converged);
    CLOSE(result.value[0], truth[0], pow(3.14159265358979323846 / 50.0, 2.0));
    fit_free_result(&result);
    fit_file_free(&automatic);
    fit_file_free(&file);
}

static void test_delay(void) {
    write_record("z_m");
    struct fit_file file =
        fit_of("[parameter]\ndelay = { start = 0, difference = 1e-5, max = 9e-4 }\n" EXPERIMENT "delay = \"delay\"\n");
    double delay = -1.3e-3;
    measure(&file, &delay);
    struct fit_result result = solved(&file, 1);
    /* The motion has a kink where the ball touches, which no derivative sees ahead. */
    CHECK(result.outcome.converged);
    NEAR(result.value[0], delay, 1e-9);
    fit_free_result(&result);
    fit_file_free(&file);
}

/* A clock that is right, of a record that begins with the scene: no later delay can be tried. */
static void test_no_delay(void) {
    write_record("z_m");
    struct fit_file file = fit_of("[parameter]\ndelay = { start = -1e-3 }\n" EXPERIMENT "delay = \"delay\"\n"
                                  "set = [\"time.end=0.2\"]\n");
    struct fit_experiment *e = &file.experiment[0];
    double delay = 0.0;
    for (size_t row = 1; row < e->rows; row++) e->time[row] -= e->time[0];
    e->time[0] = 0.0;
    file.parameter[0].high = 0.0;
    measure(&file, &delay);
    struct fit_result result = solved(&file, 1);
    CHECK(result.outcome.converged);
    NEAR(result.value[0], 0.0, 1e-9);
    fit_free_result(&result);
    fit_file_free(&file);
}

/* A start from which no way leads: the last trial is told, and there are no intervals. */
static void test_adrift(void) {
    write_record("z_m");
    struct fit_file file =
        fit_of("[parameter.e]\nstart = 0.9\n" EXPERIMENT "set = [\"contact.0.normal.restitution={e}\"]\n");
    struct fit_experiment *e = &file.experiment[0];
    measure(&file, &truth[1]);
    /* As if it had come back twice as high as it fell from: beyond a restitution of 1. */
    for (size_t row = 0; row < e->rows; row++) e->reading[0][row] += e->time[row] > 0.08 ? 0.04 : 0.0;
    struct fit_result result = solved(&file, 1);
    CHECK(!result.outcome.converged && result.state[0] == FIT_ADRIFT && isnan(result.error[0]));
    CONTAINS(result.refused.text, "restitution");
    fit_free_result(&result);
    fit_file_free(&file);
}

/* A parameter at its bound, and one of which no reading depends, at its bound or not. */
static void test_states(void) {
    write_record("z_m");
    struct fit_file file =
        fit_of("[parameter]\nrestitution = { start = 0.3, min = 0.01, max = 0.5 }\nspin = { start = 1 }\n"
               "turn = { start = 1, min = 1 }\n" EXPERIMENT
               "set = [\"contact.0.normal.restitution={restitution}\", \"body.ball.spin=[0, {turn}, {spin}]\"]\n");
    double x[3] = {0.6, 1.0, 1.0};
    measure(&file, x);
    struct fit_result result = solved(&file, 1);
    CHECK(result.state[0] == FIT_HELD && result.value[0] == 0.5 && isnan(result.error[0]) && isnan(result.low[0]));
    CHECK(result.state[1] == FIT_UNDETERMINED && isnan(result.error[1]));
    CHECK(result.state[2] == FIT_UNDETERMINED);
    fit_free_result(&result);
    fit_file_free(&file);
}

/* ---- experiments that can't be run ---- */

static void expect_failure(const char *text, const char *message) {
    struct fit_file file = fit_of(text);
    struct fit_result result;
    scree_trouble trouble = {0};
    scree_status status = fit_solve(&file, 1, NULL, &result, &trouble);
    CHECK(status && status == trouble.status);
    CONTAINS(trouble.text, message);
    fit_free_result(&result);
    fit_file_free(&file);
}

static void test_failures(void) {
    write_record("z_m");
#define ONE "[parameter.p]\nstart = 0.5\n" EXPERIMENT
    expect_failure(ONE "delay = 0.1\nset = [\"contact.0.normal.restitution={p}\"]", "begins 0.099038 s before");
    expect_failure(ONE "set = [\"contact.0.normal.restitution={p}\", \"time.end=0.1\"]", "set time.end");
    expect_failure(ONE "set = [\"contact.0.normal.restitutoin={p}\"]", "restitutoin");
    expect_failure(ONE "set = [\"contact.0.normal.restitution=-{p}\"]", "restitution");
    expect_failure(ONE "set = [\"contact.1.normal.restitution={p}\"]", "there is no \"1\"");
    expect_failure(ONE "set = [\"contact.0.normal.restitution={p}\", \"time.integrator='adaptive'\"]",
                   "readings must fall on");
    expect_failure(ONE "deviation = { z_m = 1e-310 }\nset = [\"contact.0.normal.restitution={p}\"]",
                   "beyond all numbers");
    expect_failure(ONE "set = [\"contact.3.normal.restitution={p}\"]", "fit.toml:3:1: contact.3");
    write_record("x_m");
    expect_failure(ONE "set = [\"contact.0.normal.restitution={p}\",\n"
                       "       \"domain={min=[-1, -1, -1], max=[1, 1, 1], periodic=['x']}\"]",
                   "along x, where positions jump; fit velocities");
#undef ONE
}

/* ---- fit files ---- */

static void test_places(void) {
    static const struct {
        const char *text, *place;
        size_t length;
    } cases[] = {{"a={b}", "{b}", 1},  {"a={ b = {c-d_2} }", "{c-d_2}", 5},
                 {"a={b=1}", NULL, 0}, {"a={}", NULL, 0},
                 {"a={b", NULL, 0},    {"a={{b}", "{b}", 1},
                 {"", NULL, 0}};
    for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++) {
        size_t length = 0;
        const char *place = fit_next_place(cases[k].text, &length);
        CHECK(!place == !cases[k].place);
        if (place && cases[k].place)
            CHECK(length == cases[k].length && strncmp(place, cases[k].place, length + 2) == 0);
    }
}

/* ---- what is refused ---- */

#define P "[parameter.p]\nstart = 0.5\n"
#define S "set = [\"contact.0.normal.restitution={p}\"]\n"

static void test_bad_files(void) {
    static const struct {
        const char *text, *message;
    } cases[] = {
        {"", "fit.toml: a fit file needs parameters"},
        {P, "fit.toml: a fit file needs [[experiment]]"},
        {P EXPERIMENT, "fit.toml:1:1: the parameter \"p\" changes nothing: {p} must stand"},
        {P EXPERIMENT S "title = \"t\"", "fit.toml:8:1: unknown key \"title\" in [[experiment]]"},
        {P EXPERIMENT "set = [\"a={q}\"]", "fit.toml:7:8: there is no parameter called \"q\""},
        {P EXPERIMENT "set = [\"a={pp}\"]", "did you mean \"p\"?"},
        {P EXPERIMENT "set = \"a={p}\"", "fit.toml:7:7: set must be an array"},
        {P EXPERIMENT "set = [1]", "fit.toml:7:8: a change to the scene is a string"},
        {P EXPERIMENT S "delay = \"q\"", "fit.toml:8:9: there is no parameter called \"q\""},
        {P EXPERIMENT S "delay = [1]", "fit.toml:8:9: delay (s, or the name of a parameter) must be a number"},
        {P EXPERIMENT S "columns = [\"zm\"]", "fit.toml:8:12: a column to be fitted must be one of \"x_m\""},
        {P EXPERIMENT S "columns = []", "fit.toml:8:11: columns must be an array of names"},
        {P EXPERIMENT S "columns = [\"x_m\"]", "record.csv:1:1: this record has no column x_m"},
        {P EXPERIMENT S "deviation = { z_m = 0 }", "fit.toml:8:21: the standard deviation of z_m must be positive"},
        {P EXPERIMENT S "deviation = { x_m = 1 }", "fit.toml:8:13: deviation names no column that is fitted"},
        {P EXPERIMENT S "deviation = { z_m = 1, x_m = -1 }", "fit.toml:8:30: the standard deviation of x_m"},
        {"[parameter.d]\nstart = 0.1\n" EXPERIMENT "delay = \"d\"", "\"d\" must start at 0.000962 s or below"},
        {P EXPERIMENT S "deviation = { z = 1 }", "fit.toml:8:15: unknown key \"z\" in deviation"},
        {P EXPERIMENT S "deviation = 1e-5", "fit.toml:8:13: deviation must be a table"},
        {P EXPERIMENT S EXPERIMENT "deviation = { z_m = 1 }", "of every fitted column of all records, or of none"},
        {"[parameter]\np = 1\n" EXPERIMENT S, "fit.toml:2:5: a parameter is a table"},
        {"[parameter.p]\nmin = 1\n" EXPERIMENT S, "fit.toml:1:1: the parameter \"p\" needs start"},
        {"[parameter.p]\nstart = 1\nmin = 2\n" EXPERIMENT S,
         "fit.toml:2:9: \"p\": start must be from min to max, got 1"},
        {"[parameter.p]\nstart = 1\nmin = 2\nmax = 1\n" EXPERIMENT S, "fit.toml:1:1: \"p\": min must be below max"},
        {"[parameter.p]\nstart = 0\n" EXPERIMENT S, "\"p\" starts at 0, which tells no size"},
        {"[parameter.p]\nstart = 1\ndifference = 0\n" EXPERIMENT S,
         "fit.toml:3:14: \"p\": difference must be positive"},
        {"[parameter.p]\nstart = 1\ndifference = 1e-17\n" EXPERIMENT S, "large enough to change 1; got 1e-17"},
        {P EXPERIMENT "set = [\"\"]", "fit.toml:7:8: a change to the scene is a string"},
        {"[parameter.p]\nstrat = 1\n" EXPERIMENT S, "did you mean \"start\"?"},
        {"[parameter.\"a b\"]\nstart = 1\n" EXPERIMENT S, "letters, digits, - and _ alone"},
        {"confidence = 1\n" P EXPERIMENT S, "fit.toml:1:14: confidence must be between 0 and 1, got 1"},
        {"confidense = 0.9\n" P EXPERIMENT S, "did you mean \"confidence\"?"},
        {P "[[experiment]]\nscene = \"none.toml\"\nbody = \"ball\"\nrecord = \"record.csv\"\n" S, "fit.toml:4:9: "},
        {P "[[experiment]]\nscene = \"scene.toml\"\nbody = \"ball\"\nrecord = \"none.csv\"\n" S, "fit.toml:6:10: "},
        {P "[[experiment]]\nbody = \"ball\"\nrecord = \"record.csv\"\n" S, "an experiment needs scene"},
        {P "[[experiment]]\nscene = \"scene.toml\"\nrecord = \"record.csv\"\n" S, "an experiment needs body"},
        {P "[[experiment]]\nscene = \"scene.toml\"\nbody = \"ball\"\n" S, "an experiment needs record"},
        {P "[experiment]\nscene = \"scene.toml\"\n", "experiment must be an array of tables"},
    };
    for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++) {
        struct fit_file file;
        scree_trouble trouble = {0};
        write_record("z_m");
        CHECK(read_fit(cases[k].text, &file, &trouble) != SCREE_OK);
        CONTAINS(trouble.text, cases[k].message);
        fit_file_free(&file);
    }
}

static void test_bad_records(void) {
    static const struct {
        const char *record, *message;
    } records[] = {{"time_s,z_m\n0,0\n0,0\n1,0\n", "record.csv:3:1: times must rise"},
                   {"t,z_m\n0,0\n", "record.csv:1:1: there is no column \"t\" in a record: it has time_s"},
                   {"time_s\n0\n1\n", "record.csv:1:1: a record needs a column such as x_m"},
                   {"z_m\n0\n", "record.csv:1:1: a record needs a column time_s"},
                   {"time_s,z_m,z_m\n0,0,0\n", "record.csv:1:12: there are two columns \"z_m\""},
                   {"time_s,v_z_m_s\n0,0\n", "did you mean \"vz_m_s\"?"},
                   {"time_s,z_m\n", "record.csv: no rows"},
                   {"time_s,body,z_m\n0,other,1\n", "record.csv: no rows of \"ball\""},
                   {"time_s,z_m\n0,0\n", "readings: 1, parameters: 1"},
                   {"time_s,z_m,vz_m_s\n0,0,0\n1,0,0\n", "z_m and vz_m_s are of different kinds"},
                   {"time_s,z_m\n0,x\n", "record.csv:2:3:"}};
    for (size_t k = 0; k < sizeof records / sizeof records[0]; k++) {
        struct fit_file file;
        scree_trouble trouble = {0};
        write_file("record.csv", records[k].record);
        CHECK(read_fit(P EXPERIMENT S, &file, &trouble) == SCREE_BAD_INPUT);
        CONTAINS(trouble.text, records[k].message);
        fit_file_free(&file);
    }
}

/* What the cases have in common is right; bodies.csv is a record of any of its bodies. */
static void test_good_record(void) {
    write_file("record.csv", "time_s,body,z_m,q_w\n0,ball,1,1\n0,floor,2,1\n0.1,ball,3,1\n");
    struct fit_file file = fit_of(P EXPERIMENT S "columns = [\"z_m\"]");
    CHECK(file.experiment[0].rows == 2 && file.experiment[0].reading[0][1] == 3.0);
    fit_file_free(&file);
}

int main(void) {
    CHECK(mkdtemp(folder) != NULL);
    write_file("scene.toml", scene);
    test_student();
    test_between_steps();
    test_order();
    test_exact();
    test_intervals();
    test_automatic_step();
    test_delay();
    test_no_delay();
    test_adrift();
    test_states();
    test_failures();
    test_places();
    test_bad_files();
    test_bad_records();
    test_good_record();
    static const char *const names[] = {"scene.toml", "record.csv", "fit.toml"};
    for (int k = 0; k < 3; k++) {
        char path[64];
        snprintf(path, sizeof path, "%s/%s", folder, names[k]);
        remove(path);
    }
    rmdir(folder);
    return check_report();
}
