/* Figure 12: the comb hits the product, the product slides to rest. */
#include "engine/cli/figures.h"

#include <math.h>

static const double gravity = 9.81, mu_s = 0.4, mu_k = 0.3;

enum { SPEEDS = 12, THRESHOLDS = 2 };
static const double thresholds[THRESHOLDS] = {1e-3, 1e-2}; /* m/s */

/* Exact sliding distance from speed v to rest under the threshold law: v dv = -mu(v) g dx, integrated over its three
 * pieces; on the middle one mu falls linearly, mu = a - b v. */
static double exact_distance(double v, double threshold) {
    double b = 2.0 * (mu_s - mu_k) / threshold, a = mu_s + b * threshold, end = 1.5 * threshold;
    double fast = (v * v - end * end) / (2.0 * mu_k * gravity);
    double falling = (-(end - threshold) / b + a / (b * b) * log((a - b * threshold) / (a - b * end))) / gravity;
    double creeping = threshold * threshold / (mu_s * gravity);
    return fast + falling + creeping;
}

/* How far a free product ends off the point mass: friction, acting under its centre, pitches it on its corner springs,
 * by F h/(4 k a^2), which moves the centre by h times that, and lets it back at the end; twice for the swing that
 * follows. */
static double pitch_shift(void) {
    double h = 0.006, a = 0.013, k = 1e5, force = mu_s * 0.03 * gravity;
    return 2.0 * force * h * h / (4.0 * k * a * a);
}

struct slide {
    double speed;          /* of the comb, m/s; 0: the product starts at `start` instead */
    double start;          /* m/s */
    double threshold;      /* m/s */
    int upright;           /* the product can't pitch */
    double left, distance; /* result: speed after the impact, m/s; way from there to rest, m */
};

/* Step until the product has met the tines and is free of them again. */
static scree_status pass_impact(scree_scene *scene) {
    int met = 0, first_tine = scree_scene_find_body(scene, "left tine");
    for (long n = 0; n < 100000000; n++) {
        int tines = 0;
        scree_status status = scree_scene_step(scene, 1);
        if (!status) status = figures_contacts_from(scene, first_tine, &tines);
        if (status) return status;
        met |= tines > 0;
        if (met && !tines) return SCREE_OK;
    }
    return SCREE_OK;
}

static scree_status run_slide(const struct figures *figures, void *slides, int k, scree_trouble *trouble) {
    struct slide *slide = (struct slide *)slides + k;
    char velocity[64], duration[64], threshold[64], start[64], end[64];
    /* The comb reaches the product after 1 mm, and stops 2.5 ms later, well after the impact of 1.5 ms. */
    snprintf(velocity, sizeof velocity, "motion.stroke.velocity=%.17g", slide->speed);
    snprintf(duration, sizeof duration, "motion.stroke.duration=%.17g",
             slide->speed > 0.0 ? 1e-3 / slide->speed + 2.5e-3 : 1.0);
    snprintf(threshold, sizeof threshold, "contact.0.friction.threshold=%.17g", slide->threshold);
    snprintf(start, sizeof start, "body.product.velocity=[%.17g,0.0,0.0]", slide->start);
    snprintf(end, sizeof end, "time.end=%.17g", 100.0);
    const char *changes[] = {velocity, duration, threshold, start, end, "body.product.joint={turn=\"fixed\"}"};
    scree_scene *scene = figures_scene(figures, "impact_and_slide.toml", changes, slide->upright ? 6 : 5, trouble);
    if (!scene) return trouble->status;
    scree_status status = SCREE_OK;
    int product = scree_scene_find_body(scene, "product");
    if (slide->speed > 0.0) status = pass_impact(scene);
    /* The impact makes the product swing on its corner springs; take its speed when that has died away. */
    if (slide->speed > 0.0 && !status) status = scree_scene_step(scene, lround(0.01 / scree_scene_step_length(scene)));
    scree_body_state state = scree_scene_body(scene, product);
    double x = state.position[0];
    slide->left = state.velocity[0];
    while (!status && fabs(state.velocity[0]) > 1e-12) {
        status = scree_scene_step(scene, 200);
        state = scree_scene_body(scene, product);
    }
    if (status) *trouble = *scree_scene_trouble(scene);
    slide->distance = state.position[0] - x;
    scree_scene_destroy(scene);
    return status;
}

static const char script[] =
    "set title 'Impact and slide: e = 0.5, μ_k = 0.3'\n"
    "set xlabel 'collision velocity of the comb (m/s)'\n"
    "set ylabel 'sliding distance (mm)'\n"
    "set y2label 'relative error'\nset y2tics\nset ytics nomirror\nset logscale y2\nset format y2 '10^{%T}'\n"
    "set y2range [1e-8:1]\nset key top left\n"
    "plot 'fig_12.csv' using 1:($3*1e3) with lines ls 1 title 'expected, v^2/(2μ_k g)',\\\n"
    "     '' using 1:($4*1e3) with points ls 3 title 'simulated, threshold 1 mm/s',\\\n"
    "     '' using 1:5 axes x1y2 with linespoints ls 2 title 'error (right), threshold 1 mm/s',\\\n"
    "     '' using 1:9 axes x1y2 with linespoints ls 4 title 'error (right), threshold 10 mm/s'\n";

static void report_distance(struct figures *figures, const char *quantity, const struct slide *slide) {
    double exact = exact_distance(slide->left, slide->threshold);
    figures_report(figures, "12", quantity, exact, slide->distance, pitch_shift() / exact);
}

static scree_status write_slides(struct figures *figures, struct slide slides[THRESHOLDS][SPEEDS]) {
    struct scree_out out;
    scree_status status = figures_table(figures, "fig_12",
                                        "collision_velocity_m_s,v_1mm_s_m_s,expected_1mm_s_m,simulated_1mm_s_"
                                        "m,error_1mm_s,v_10mm_s_m_s,expected_10mm_s_m,"
                                        "simulated_10mm_s_m,error_10mm_s",
                                        &out);
    if (status) return status;
    for (int k = 0; k < SPEEDS; k++) {
        fprintf(out.file, "%.17g", slides[0][k].speed);
        for (int t = 0; t < THRESHOLDS; t++) {
            double v = slides[t][k].left, coulomb = v * v / (2.0 * mu_k * gravity), s = slides[t][k].distance;
            fprintf(out.file, ",%.17g,%.17g,%.17g,%.17g", v, coulomb, s, fabs(s / coulomb - 1.0));
        }
        fprintf(out.file, "\n");
    }
    return scree_out_keep(&out, &figures->trouble);
}

scree_status figure_12(struct figures *figures) {
    struct slide slides[THRESHOLDS][SPEEDS] = {0};
    for (int t = 0; t < THRESHOLDS; t++)
        for (int k = 0; k < SPEEDS; k++)
            slides[t][k] = (struct slide){.speed = 0.1 * pow(10.0, k / 11.0), .threshold = thresholds[t]};
    scree_status status = figures_do(figures, run_slide, slides[0], THRESHOLDS * SPEEDS);
    if (!status) status = write_slides(figures, slides);
    if (status) return status;
    double worst = 0.0;
    for (int t = 0; t < THRESHOLDS; t++)
        for (int k = 0; k < SPEEDS; k++)
            worst = scree_most(worst, fabs(slides[t][k].distance - exact_distance(slides[t][k].left, thresholds[t])));
    figures_report(figures, "12", "sliding distance less exact, largest over all speeds (m)", 0.0, worst,
                   pitch_shift());
    const struct slide *fast = &slides[0][SPEEDS - 1], *slow = &slides[0][0];
    report_distance(figures, "sliding distance, comb at 0.1 m/s, threshold law (m)", slow);
    report_distance(figures, "sliding distance, comb at 1 m/s, threshold law (m)", fast);
    double coulomb = fast->left * fast->left / (2.0 * mu_k * gravity);
    /* What the regularisation costs: the difference of the two closed forms. */
    figures_report(figures, "12", "recovered mu_k, comb at 1 m/s", mu_k, coulomb / fast->distance * mu_k,
                   fabs(exact_distance(fast->left, fast->threshold) / coulomb - 1.0) + pitch_shift() / coulomb);

    /* The product alone, kept from pitching: here the threshold law is met to the order of the step, (5e-6 s mu_s
     * g/threshold)^2 of the few micrometres in which it matters. */
    struct slide alone[4] = {{.start = 0.1, .threshold = 1e-2, .upright = 1},
                             {.start = 1.0, .threshold = 1e-2, .upright = 1},
                             {.start = 0.1, .threshold = 1e-3, .upright = 1},
                             {.start = 1.0, .threshold = 1e-3, .upright = 1}};
    status = figures_do(figures, run_slide, alone, 4);
    if (status) return status;
    for (int k = 0; k < 4; k++) {
        char quantity[96];
        snprintf(quantity, sizeof quantity, "distance from %g m/s, threshold %g mm/s, no pitch (m)", alone[k].start,
                 1e3 * alone[k].threshold);
        figures_report(figures, "12", quantity, exact_distance(alone[k].start, alone[k].threshold), alone[k].distance,
                       1e-6);
    }
    return figures_plot(figures, "fig_12", script);
}
