/* Figures 5a and 6a: the conventional motion, from the contact simulation, with the rigid formula beside it. */
#include "engine/cli/figures.h"
#include "solver/conventional.h"

#include <math.h>

static const struct scree_conventional rigid = {.stroke = 0.08, .share = 0.5, .friction = 0.3, .gravity = 9.81};

enum { STIFFNESSES = 3, SPEEDS = 17 };
static const double stiffnesses[STIFFNESSES] = {1e4, 1e5, 1e6}; /* N/m, of the tines together */

struct transport {
    double cycles, stiffness; /* 1/min, N/m */
    double error;             /* how far the product ends beyond its place, m */
};

/* The transport scene at an operating speed: the comb rises to its dwell and stays there. */
static scree_scene *transport_scene(const struct figures *figures, double cycles, double stiffness, double step,
                                    scree_trouble *trouble) {
    char stroke[160], rear[160], time_step[64];
    double duration = scree_conventional_duration(&rigid, cycles);
    snprintf(stroke, sizeof stroke, "motion.stroke.rows=[[0,0,0,0],[%.17g,%.17g,0,0]]", duration, rigid.stroke);
    snprintf(rear, sizeof rear, "contact.1.normal={law=\"linear-loading\", stiffness=%.17g, restitution=0.5}",
             stiffness);
    snprintf(time_step, sizeof time_step, "time.step=%.17g", step);
    const char *changes[] = {stroke, rear, time_step, "motion.lift.rows=[[0,0,0,0],[1,0,0,0]]", "output.write=[]"};
    return figures_scene(figures, "transport.toml", changes, 5, trouble);
}

/* Position of the product's rear face. */
static double rear_face(const scree_scene *scene) {
    return scree_scene_body(scene, scree_scene_find_body(scene, "product")).position[0] - 0.015;
}

static scree_status run_transport(const struct figures *figures, void *transports, int k, scree_trouble *trouble) {
    struct transport *transport = (struct transport *)transports + k;
    /* 40 steps in the time of a swing between product and tines, and enough for the surfaces. */
    double step = fmin(5e-6, 2.0 * 3.14 * sqrt(0.03 / transport->stiffness) / 40.0);
    scree_scene *scene = transport_scene(figures, transport->cycles, transport->stiffness, step, trouble);
    if (!scene) return trouble->status;
    scree_status status = SCREE_OK;
    double duration = scree_conventional_duration(&rigid, transport->cycles), speed = 1.0;
    int product = scree_scene_find_body(scene, "product");
    while (!status && (scree_scene_time(scene) < duration || fabs(speed) > 1e-9)) {
        status = scree_scene_step(scene, 200);
        speed = scree_scene_body(scene, product).velocity[0];
    }
    if (status) *trouble = *scree_scene_trouble(scene);
    transport->error = rear_face(scene) - rigid.stroke;
    scree_scene_destroy(scene);
    return status;
}

/* ---- figure 5a ---- */

static const char script_5a[] =
    "set title 'Conventional motion, 100 cycles/min'\n"
    "set xlabel 'path (mm)'\nset ylabel 'velocity (m/s)'\nset key bottom center\nset xrange [0:95]\nset "
    "yrange [0:0.55]\n"
    "plot 'fig_5a.csv' using ($2*1e3):3 with lines ls 1 title 'comb',\\\n"
    "     '' using ($6*1e3):7 with lines ls 2 title 'product, rigid',\\\n"
    "     '' using ($4*1e3):5 every 8 with points ls 3 title 'product, simulated'\n";

scree_status figure_5a(struct figures *figures) {
    const double cycles = 100.0;
    scree_scene *scene = transport_scene(figures, cycles, 1e6, 5e-6, &figures->trouble);
    if (!scene) return figures->trouble.status;
    struct scree_out out = {0};
    scree_status status = figures_table(
        figures, "fig_5a", "time_s,x_comb_m,v_comb_m_s,x_product_m,v_product_m_s,x_rigid_m,v_rigid_m_s", &out);
    int comb = scree_scene_find_body(scene, "left rear tine"), product = scree_scene_find_body(scene, "product");
    double left = scree_conventional_detachment(&rigid, cycles), x_left, v_left, a;
    scree_conventional_at(&rigid, cycles, left, &x_left, &v_left, &a);
    double worst = 0.0;
    while (!status && scree_scene_time(scene) <= 0.42) {
        double time = scree_scene_time(scene), x, v, slide = rigid.friction * rigid.gravity,
               t = fmin(time - left, v_left / slide);
        scree_conventional_at(&rigid, cycles, time, &x, &v, &a);
        double x_rigid = time < left ? x : x_left + t * (v_left - 0.5 * slide * t);
        double v_rigid = time < left ? v : v_left - slide * t;
        double v_product = scree_scene_body(scene, product).velocity[0];
        fprintf(out.file, "%.17g,%.17g,%.17g,%.17g,%.17g,%.17g,%.17g\n", time, x,
                scree_scene_body(scene, comb).velocity[0], rear_face(scene), v_product, x_rigid, v_rigid);
        worst = scree_most(worst, fabs(v_product - v_rigid));
        status = scree_scene_step(scene, 200);
        if (status) figures->trouble = *scree_scene_trouble(scene);
    }
    scree_scene_destroy(scene);
    if (status) {
        scree_out_drop(&out, 0);
        return status;
    }
    status = scree_out_keep(&out, &figures->trouble);
    /* The tines' spring stores and gives back sqrt(m/k) times the jumps of acceleration: 1e-4 s of some 10 m/s^2. */
    figures_report(figures, "5a", "product velocity against rigid, largest difference (m/s)", 0.0, worst, 3e-3);
    if (!status) status = figures_plot(figures, "fig_5a", script_5a);
    return status;
}

/* ---- figure 6a ---- */

static const char script_6a[] =
    "set title 'Conventional motion: 80 mm, half of the cycle, μ_k = 0.3'\n"
    "set xlabel 'operating speed (1/min)'\nset ylabel 'positioning error (mm)'\nset key top left\n"
    "set arrow from 75.727, graph 0 to 75.727, graph 0.5 nohead lc rgb '#888888' dt 3\n"
    "set label 'n_0' at 75.727, graph 0.52 center\n"
    "set arrow from 81.50, graph 0 to 81.50, graph 0.5 nohead lc rgb '#888888' dt 3\n"
    "set label 'n_{crit} (1 mm)' at 81.50, graph 0.52 left\n"
    "plot 'fig_6a.csv' using 1:($2*1e3) with lines ls 1 title 'rigid body',\\\n"
    "     '' using 1:($3*1e3) with points ls 2 title 'simulated, 10^4 N/m',\\\n"
    "     '' using 1:($4*1e3) with points ls 3 title 'simulated, 10^5 N/m',\\\n"
    "     '' using 1:($5*1e3) with points ls 4 title 'simulated, 10^6 N/m'\n";

/* How far compliant tines and the threshold of friction can shift the error: at detachment the tines' spring (overlap
 * m (a + mu_k g)/k) is unloading at m j/k, which the product has in excess of the comb; the jump of the jerk at the
 * start of the rise, 60 s/T^3, leaves it swinging at up to m j/k as well; and the product slides 1e-7 m off the point
 * mass (figure 12). */
static double largest_shift(double cycles, double stiffness) {
    double left = scree_conventional_detachment(&rigid, cycles), x, v, a, later, h = 1e-7;
    scree_conventional_at(&rigid, cycles, left + h, &x, &v, &later);
    scree_conventional_at(&rigid, cycles, left, &x, &v, &a);
    double duration = scree_conventional_duration(&rigid, cycles);
    double jerk = fabs(later - a) / h + 60.0 * rigid.stroke / (duration * duration * duration);
    return 0.03 * jerk / stiffness * v / (rigid.friction * rigid.gravity) + 1e-7;
}

static scree_status write_6a(struct figures *figures, struct transport transports[STIFFNESSES][SPEEDS]) {
    struct scree_out out;
    scree_status status = figures_table(
        figures, "fig_6a", "cycles_1_min,rigid_m,simulated_1e4_N_m_m,simulated_1e5_N_m_m,simulated_1e6_N_m_m", &out);
    if (status) return status;
    for (int n = 0; n < SPEEDS; n++) {
        double cycles = transports[0][n].cycles;
        fprintf(out.file, "%.17g,%.17g", cycles, scree_conventional_error(&rigid, cycles));
        for (int k = 0; k < STIFFNESSES; k++) fprintf(out.file, ",%.17g", transports[k][n].error);
        fprintf(out.file, "\n");
    }
    return scree_out_keep(&out, &figures->trouble);
}

scree_status figure_6a(struct figures *figures) {
    static struct transport transports[STIFFNESSES][SPEEDS];
    for (int k = 0; k < STIFFNESSES; k++)
        for (int n = 0; n < SPEEDS; n++)
            transports[k][n] = (struct transport){.cycles = 50.0 + 5.0 * n, .stiffness = stiffnesses[k]};
    scree_status status = figures_do(figures, run_transport, transports[0], STIFFNESSES * SPEEDS);
    if (!status) status = write_6a(figures, transports);
    if (status) return status;
    static const int shown[] = {6, 8, 10, 14}; /* 80, 90, 100, 120 cycles/min */
    for (int n = 0; n < 4; n++) {
        for (int k = 0; k < STIFFNESSES; k++) {
            const struct transport *t = &transports[k][shown[n]];
            char quantity[96];
            double error = scree_conventional_error(&rigid, t->cycles);
            snprintf(quantity, sizeof quantity, "positioning error at %g/min, tines %.0e N/m (m)", t->cycles,
                     t->stiffness);
            figures_report(figures, "6a", quantity, error, t->error, largest_shift(t->cycles, t->stiffness) / error);
        }
    }
    return figures_plot(figures, "fig_6a", script_6a);
}
