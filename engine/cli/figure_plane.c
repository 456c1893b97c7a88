/* Figure 11b: the slope grows, the product begins to slide. */
#include "engine/cli/figures.h"

#include <math.h>

static const double gravity = 9.81, mu_s = 0.4, mu_k = 0.3, threshold = 1e-3;
static const double degree = 3.14159265358979323846 / 180.0, start = 20.0, rate = 2.0; /* degrees, degrees/s */

/* Acceleration of a point mass on the slope under the threshold law. */
static double acceleration(double time, double v) {
    double slope = (start + rate * time) * degree, w = v / threshold;
    double mu = w < 1.0 ? mu_s * w : w < 1.5 ? mu_s - (mu_s - mu_k) * 2.0 * (w - 1.0) : mu_k;
    return gravity * (sin(slope) - mu * cos(slope));
}

/* The point mass from `time` on: one Runge-Kutta step of length h. */
static double point_mass_step(double time, double v, double h) {
    double a = acceleration(time, v), b = acceleration(time + 0.5 * h, v + 0.5 * h * a);
    double c = acceleration(time + 0.5 * h, v + 0.5 * h * b), d = acceleration(time + h, v + h * c);
    return v + h / 6.0 * (a + 2.0 * (b + c) + d);
}

/* Slope at which the point mass passes the speed `wanted`, degrees. It starts at its creep speed for the first slope;
 * that start is forgotten within a millisecond. */
static double expected_passage(double wanted) {
    double h = 1e-6, v = threshold * tan(start * degree) / mu_s, time = 0.0;
    for (; v < wanted; time += h) {
        double next = point_mass_step(time, v, h);
        if (next >= wanted) return start + rate * (time + h * (wanted - v) / (next - v));
        v = next;
    }
    return start;
}

enum { PASSAGES = 3 };
static const double passages[PASSAGES] = {1.5e-3, 5e-3, 10e-3};

struct ramp {
    double start;             /* slope at the start, degrees */
    double passage[PASSAGES]; /* slope at which the product passed each speed, degrees */
    double first_slip;        /* slope at which a sticking contact first slid, degrees */
};

/* Run the ramp, sampling velocity over slope once a millisecond from the slope `start` on. */
static scree_status run_ramp(scree_scene *scene, double *samples, int count, struct ramp *ramp, int watch_slip) {
    int product = scree_scene_find_body(scene, "product");
    double before = 0.0, h = scree_scene_step_length(scene);
    long per_sample = lround(1e-3 / h);
    scree_status status = scree_scene_step(scene, lround((start - ramp->start) / rate / h));
    if (status) return status;
    for (int k = 0; k < count; k++) {
        samples[k] = scree_scene_body(scene, product).velocity[0];
        for (long n = 0; n < per_sample; n++) {
            status = scree_scene_step(scene, 1);
            if (status) return status;
            double v = scree_scene_body(scene, product).velocity[0], time = scree_scene_time(scene);
            for (int p = 0; p < PASSAGES; p++)
                if (before < passages[p] && v >= passages[p])
                    ramp->passage[p] = ramp->start + rate * (time - h + h * (passages[p] - before) / (v - before));
            before = v;
            scree_contact_state contact[16];
            int contacts = 0;
            if (!watch_slip || ramp->first_slip > 0.0) continue;
            status = scree_scene_contacts(scene, contact, 16, &contacts);
            if (status) return status;
            for (int c = 0; c < contacts && c < 16; c++)
                if (contact[c].sliding) ramp->first_slip = ramp->start + rate * time;
        }
    }
    return SCREE_OK;
}

static scree_status measure_creep(struct figures *figures, double *creep) {
    const char *steady[] = {"motion.slope.velocity=0", "motion.slope.offset=0.36651914291880921"}; /* 21 degrees */
    scree_scene *scene = figures_scene(figures, "incline.toml", steady, 2, &figures->trouble);
    if (!scene) return figures->trouble.status;
    scree_status status = scree_scene_step(scene, 20000);
    if (status) figures->trouble = *scree_scene_trouble(scene);
    *creep = scree_scene_body(scene, scree_scene_find_body(scene, "product")).velocity[0];
    scree_scene_destroy(scene);
    return status;
}

enum { SAMPLES = 1201 }; /* to 22.4 degrees */

static scree_status simulate(struct figures *figures, const char *const *changes, int count, double *samples,
                             struct ramp *ramp, int watch_slip) {
    scree_scene *scene = figures_scene(figures, "incline.toml", changes, count, &figures->trouble);
    if (!scene) return figures->trouble.status;
    scree_status status = run_ramp(scene, samples, SAMPLES, ramp, watch_slip);
    if (status) figures->trouble = *scree_scene_trouble(scene);
    scree_scene_destroy(scene);
    return status;
}

static const char script[] = "set title 'Inclined plane: the slope grows by 2°/s'\n"
                             "set xlabel 'inclination (°)'\nset ylabel 'product velocity (mm/s)'\n"
                             "set key top left\n"
                             "critical = 180/pi*atan(0.4)\n"
                             "set arrow from critical, graph 0 to critical, graph 1 nohead lc rgb '#888888' dt 3\n"
                             "set label 'arctan μ_s = 21.80°' at critical, graph 0.6 right offset -1,0\n"
                             "set xrange [21.4:22.0]\nset yrange [0:60]\n"
                             "plot 'fig_11b.csv' using 1:($4*1e3) with lines ls 1 title 'rigid body, Coulomb',\\\n"
                             "     '' using 1:($2*1e3) every 6 with points ls 2 title 'simulated, stick-slip law',\\\n"
                             "     '' using 1:($3*1e3) every 6::3 with points ls 3 title 'simulated, sticking law'\n";

scree_status figure_11b(struct figures *figures) {
    static double creeping[SAMPLES], sticking[SAMPLES];
    /* Kept from pitching, so that the corners bear alike: else the less loaded ones slide first and, at the lower
     * kinetic friction, leave the others too much. From 18.5 degrees on: the load comes on at once at the start, and
     * the force of spring and dashpot overshoots it by exp(-2) at critical damping. */
    static const char *const sticks[] = {
        "contact.0.friction={law=\"coulomb\", static=0.4, kinetic=0.3, stiffness=4e5, damping=250}",
        "body.product.joint={turn=\"fixed\"}", "motion.slope.offset=0.32288591161895097"};
    struct ramp ramp = {.start = start}, stick_ramp = {.start = 18.5};
    double creep = 0.0;
    scree_status status = simulate(figures, NULL, 0, creeping, &ramp, 0);
    if (!status) status = simulate(figures, sticks, 3, sticking, &stick_ramp, 1);
    if (!status) status = measure_creep(figures, &creep);
    struct scree_out out = {0};
    if (!status)
        status = figures_table(figures, "fig_11b", "inclination_deg,v_stick_slip_m_s,v_coulomb_m_s,v_rigid_coulomb_m_s",
                               &out);
    if (status) return status;
    double critical = atan(mu_s) / degree, rigid = 0.0;
    for (int k = 0; k < SAMPLES; k++) {
        double slope = start + rate * 1e-3 * k;
        fprintf(out.file, "%.17g,%.17g,%.17g,%.17g\n", slope, creeping[k], sticking[k], rigid);
        /* The rigid body of the text books: at rest up to the critical slope, then g (sin - mu_k cos). */
        double from = fmax(slope, critical), to = fmax(slope + rate * 1e-3, critical);
        double middle = 0.5 * (from + to) * degree;
        rigid += (to - from) / rate * gravity * (sin(middle) - mu_k * cos(middle));
    }
    status = scree_out_keep(&out, &figures->trouble);
    /* A steady creep is a fixed point of the step, so its error is rounding. */
    figures_report(figures, "11b", "creep speed at 21 deg, stick-slip (m/s)", threshold * tan(21.0 * degree) / mu_s,
                   creep, 1e-9);
    static const char *const names[PASSAGES] = {"inclination when v passes 1.5 mm/s, stick-slip (deg)",
                                                "inclination when v passes 5 mm/s, stick-slip (deg)",
                                                "inclination when v passes 10 mm/s, stick-slip (deg)"};
    /* The box pitches on its corner springs while friction grows: F' h^2/(4 k a^2) = 4e-9 m/s of 1e-3 m/s at its
     * corners, 4e-6. And it swings on them: while the slope grows the surfaces unload, and the dashpot acts in loading
     * only, so swings of up to the unloading speed live on, 3e-6 of the weight. Both together, twice for safety. */
    for (int p = 0; p < PASSAGES; p++)
        figures_report(figures, "11b", names[p], expected_passage(passages[p]), ramp.passage[p], 1.5e-5);
    /* The contact slides a little early by as much as its spring still swings. */
    figures_report(figures, "11b", "critical inclination, sticking law (deg)", critical, stick_ramp.first_slip, 1e-4);
    if (!status) status = figures_plot(figures, "fig_11b", script);
    return status;
}
