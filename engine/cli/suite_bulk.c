/* Grains by the thousand: discharge of a silo, load of a column between walls, angle of repose, rotating drum, impact on a bed.
 * After the benchmark of Dosta et al., Comput. Phys. Commun. 296 (2024) 109066 (data/reference/dosta2024_parameters.csv), made small: its
 * grains M1 (4 mm, 2500 kg/m^3, Poisson's ratio 0.2, restitution 0.5 and friction 0.3 among each other, 0.4 and 0.2 against walls), but
 * thousands of them instead of 25,000 to 122,000, and 1 MPa instead of 1 GPa (10 MPa for the impact). Rate and shape of a slow flow don't
 * depend on the modulus while overlaps are small: E/(rho g d) is 1e4, which makes 1 % of a diameter under ten layers. */
#include "engine/cli/figures.h"
#include "engine/scene_file.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double gravity = 9.81, pi = 3.14159265358979323846, radius = 2e-3, diameter = 4e-3, density = 2500.0;

/* ---- scenes as text ---- */

/* One run: a scene of its own, so that several go at the same time. */
struct run {
    char *text; /* of the scene, owned */
    scree_scene *scene;
    scree_status status;
    scree_trouble trouble;
};

struct grains {
    double young;            /* Pa */
    double rolling;          /* coefficient */
    double step, end, speed; /* s, s, m/s */
    const char *domain;      /* or "" */
};

/* Begin a scene. Tangential damping ratios are sqrt(5/6) of the normal ones, as LAMMPS and LIGGGHTS have them. */
static FILE *begin_scene(struct run *run, size_t *size, const struct grains *g) {
    *run = (struct run){.text = NULL};
    FILE *file = open_memstream(&run->text, size);
    if (!file) {
        run->status = scree_report(&run->trouble, SCREE_NO_MEMORY, NULL, "no memory for a scene");
        return NULL;
    }
    fprintf(file,
            "gravity = [0, 0, -9.81]\n[time]\nend = %g\nstep = %g\nspeed = %g\n%s"
            "[[material]]\nname = \"m1\"\ndensity = 2500\nyoung = %g\npoisson = 0.2\n"
            "[[material]]\nname = \"wall\"\ndensity = 7200\nyoung = %g\npoisson = 0.2\n"
            "[[contact]]\nbetween = [\"wall\", \"wall\"]\nnone = true\n",
            g->end, g->step, g->speed, g->domain, g->young, g->young);
    for (int wall = 0; wall < 2; wall++) {
        fprintf(file,
                "[[contact]]\nbetween = [\"m1\", \"%s\"]\nnormal = { law = \"tsuji\", restitution = %g }\n"
                "friction = { law = \"mindlin\", static = %g, kinetic = %g, damping = %g }\n",
                wall ? "wall" : "m1", wall ? 0.4 : 0.5, wall ? 0.2 : 0.3, wall ? 0.2 : 0.3, wall ? 0.2556 : 0.19668);
        if (g->rolling > 0.0)
            fprintf(file, "rolling = { law = \"spring-dashpot\", rolling = %g, stiffness = %g, damping = %g }\n",
                    g->rolling, 0.25 * g->young * radius, 0.02);
    }
    return file;
}

/* A plane at `at` along an axis, its free side towards + (`side` 1) or -. */
static void put_plane(FILE *file, const char *name, int axis, double at, int side, const char *joint) {
    static const char *const turns[3][2] = {{"axis = [0, 1, 0], degrees = -90", "axis = [0, 1, 0], degrees = 90"},
                                            {"axis = [1, 0, 0], degrees = 90", "axis = [1, 0, 0], degrees = -90"},
                                            {"axis = [1, 0, 0], degrees = 180", "axis = [1, 0, 0], degrees = 0"}};
    double position[3] = {0.0, 0.0, 0.0};
    position[axis] = at;
    fprintf(file,
            "[[body]]\nname = \"%s\"\nshape = { plane = true }\nmaterial = \"wall\"\njoint = %s\n"
            "position = [%.17g, %.17g, %.17g]\norientation = { %s }\n",
            name, joint, position[0], position[1], position[2], turns[axis][side]);
}

static void put_box(FILE *file, double half, const char *joint) {
    put_plane(file, "left", 0, -half, 1, joint);
    put_plane(file, "right", 0, half, 0, joint);
    put_plane(file, "front", 1, -half, 1, joint);
    put_plane(file, "back", 1, half, 0, joint);
}

static void put_rectangle(FILE *file, const char *name, const double x[2], const double y[2], const char *joint) {
    fprintf(file,
            "[[body]]\nname = \"%s\"\nshape = { rectangle = [%.17g, %.17g] }\nmaterial = \"wall\"\n"
            "position = [%.17g, %.17g, 0]\njoint = %s\n",
            name, x[1] - x[0], y[1] - y[0], 0.5 * (x[0] + x[1]), 0.5 * (y[0] + y[1]), joint);
}

/* Grains on a lattice, a little off their places. */
static void put_grains(FILE *file, const double min[3], const double max[3], int count, int seed) {
    fprintf(file,
            "[[generate]]\nname = \"grain\"\nkind = \"lattice\"\nmaterial = \"m1\"\nradius = %g\nspacing = 4.1e-3\n"
            "jitter = 5e-5\nseed = %d\nmin = [%.17g, %.17g, %.17g]\nmax = [%.17g, %.17g, %.17g]\n",
            radius, seed, min[0], min[1], min[2], max[0], max[1], max[2]);
    if (count) fprintf(file, "count = %d\n", count);
}

/* The scene is whole: make it. The text stays, to be written beside the data. */
static void end_scene(struct run *run, FILE *file, size_t *size) {
    fprintf(file, "[output]\nwrite = [\"spheres.csv\", \"vtk\"]\nevery = 0.01\n");
    if (fclose(file)) run->status = scree_report(&run->trouble, SCREE_NO_MEMORY, NULL, "no memory for a scene");
    if (run->status) return;
    struct scree_run_request request = {0};
    run->status = scree_read_scene(run->text, *size, "suite", NULL, 0, 1, &run->scene, &request, &run->trouble);
    scree_free_request(&request);
}

/* Go on until `time`. */
static int go_until(struct run *run, double time) {
    if (run->status) return 0;
    long steps = scree_steps_to(run->scene, time) - scree_scene_steps(run->scene);
    if (steps > 0) run->status = scree_scene_step(run->scene, steps);
    if (run->status) run->trouble = *scree_scene_trouble(run->scene);
    return !run->status;
}

/* The first body that is a grain; all after it are. */
static int first_grain(const scree_scene *scene) { return scree_scene_find_body(scene, "grain 1"); }

static void end_run(struct run *run) {
    scree_scene_destroy(run->scene);
    free(run->text);
    run->scene = NULL;
    run->text = NULL;
}

/* Write the scene of a run beside the data, so that it can be run, seen and given to other programs. */
static void write_scene(const struct figures *figures, struct run *run, const char *name) {
    struct scree_out out;
    char path[1024];
    if (run->status) return;
    snprintf(path, sizeof path, "%s/%s.toml", figures->folder, name);
    run->status = scree_out_open(&out, path, &run->trouble);
    if (run->status) return;
    fputs(run->text, out.file);
    run->status = scree_out_keep(&out, &run->trouble);
}

/* The first failure among runs, if any, is that of the suite. */
static scree_status check_runs(struct figures *figures, const struct run *runs, size_t stride, int count) {
    for (int k = 0; k < count; k++) {
        const struct run *run = (const struct run *)((const char *)runs + (size_t)k * stride);
        if (!run->status) continue;
        figures->trouble = run->trouble;
        return run->status;
    }
    return SCREE_OK;
}

static double grain_mass(void) { return 4.0 / 3.0 * pi * radius * radius * radius * density; }

/* What LAMMPS makes of the same scenes, by bench/peers/bulk.sh (data/reference/bulk_lammps.csv), and what may lie between two means of
 * runs from other places of the grains: three times its standard error. */
struct peer {
    double mean, scatter; /* of a run, about the mean */
    int runs;
};

static void report_beside(struct figures *figures, const char *figure, const char *quantity, const struct peer *peer,
                          double mean, int runs) {
    double error = peer->scatter * sqrt(1.0 / runs + 1.0 / peer->runs);
    figures_report(figures, figure, quantity, peer->mean, mean, 3.0 * error / peer->mean);
}

/* ---- a silo empties through a hole in its floor ---- */

enum { SILO_RUNS = 3, SILO_ROWS = 300 };

static const double silo_half = 28e-3, silo_opens = 0.25;

struct silo {
    struct run run;
    double hole;              /* edge, m */
    double bulk;              /* density of the bed before, kg/m^3 */
    double rate;              /* kg/s */
    int rows, out[SILO_ROWS]; /* grains below the floor, every 10 ms from the opening on */
};

/* Four rectangles round a square hole, and a plug that falls away from it. */
static void make_silo(struct silo *silo, int seed) {
    struct grains g = {.young = 1e6, .step = 4e-5, .end = 5.0, .speed = 1.0, .domain = ""};
    double h = 0.5 * silo->hole, b = silo_half;
    size_t size;
    FILE *file = begin_scene(&silo->run, &size, &g);
    if (!file) return;
    fprintf(file, "[[motion]]\nname = \"away\"\nkind = \"velocity\"\nvelocity = -5\nstart = %g\nduration = 0.03\n",
            silo_opens);
    put_box(file, b, "\"fixed\"");
    put_plane(file, "ground", 2, -0.1, 1,
              "\"fixed\""); /* what falls for long is fast, and lists are made anew for it */
    put_rectangle(file, "floor 1", (double[]){-h, b}, (double[]){h, b}, "\"fixed\"");
    put_rectangle(file, "floor 2", (double[]){h, b}, (double[]){-b, h}, "\"fixed\"");
    put_rectangle(file, "floor 3", (double[]){-b, h}, (double[]){-b, -h}, "\"fixed\"");
    put_rectangle(file, "floor 4", (double[]){-b, -h}, (double[]){-h, b}, "\"fixed\"");
    put_rectangle(file, "plug", (double[]){-h, h}, (double[]){-h, h}, "{ z = \"away\", others = \"fixed\" }");
    put_grains(file, (double[]){-b, -b, 0.0}, (double[]){b, b, 0.2}, 4000, seed);
    end_scene(&silo->run, file, &size);
}

/* Mass over volume between 4 and 14 diameters above the floor. */
static double bulk_density(const scree_scene *scene, double area) {
    int inside = 0;
    for (int k = first_grain(scene); k < scree_scene_bodies(scene); k++) {
        double z = scree_scene_body(scene, k).position[2];
        inside += z > 4.0 * diameter && z < 14.0 * diameter;
    }
    return inside * grain_mass() / (area * 10.0 * diameter);
}

static int grains_below(const scree_scene *scene, double level) {
    int below = 0;
    for (int k = first_grain(scene); k < scree_scene_bodies(scene); k++)
        below += scree_scene_body(scene, k).position[2] < level;
    return below;
}

/* Time at which `wanted` grains are out, between rows. */
static double time_of(const struct silo *silo, int wanted) {
    for (int k = 1; k < silo->rows; k++)
        if (silo->out[k] >= wanted)
            return 0.01 * (k - 1 + (double)(wanted - silo->out[k - 1]) / (silo->out[k] - silo->out[k - 1]));
    return NAN;
}

/* From 250 to 950 of 4000 grains out: the bed is nearly as high as wide, or higher, all the while. */
static void empty_silo(struct silo *silo, int seed) {
    static const int from = 250, to = 950;
    make_silo(silo, seed);
    if (go_until(&silo->run, silo_opens)) silo->bulk = bulk_density(silo->run.scene, 4.0 * silo_half * silo_half);
    for (int row = 0; row < SILO_ROWS && go_until(&silo->run, silo_opens + 0.01 * row); row++) {
        silo->out[row] = grains_below(silo->run.scene, -radius);
        silo->rows = row + 1;
        if (silo->out[row] >= to) break;
    }
    silo->rate = (to - from) * grain_mass() / (time_of(silo, to) - time_of(silo, from));
}

static const char silo_script[] = "set title 'Discharge of a silo through a square hole'\n"
                                  "set xlabel 'time since the opening (s)'\nset ylabel 'grains out'\nset key top left\n"
                                  "hole(k) = 5.5 + 0.75*k\n"
                                  "plot for [k=0:2] 'silo.csv' using 2:($1==hole(k) ? $3 : NaN) with lines ls k+1 "
                                  "title sprintf('%g diameters', hole(k))\n";

/* Beverloo, Leniger & van de Velde, Chem. Eng. Sci. 15 (1961) 260: W = C rho sqrt(g) (D - k d)^2.5; for a square hole (Nedderman,
 * Statics and Kinematics of Granular Materials, 1992, ch. 10: area and hydraulic diameter of what is left without a margin of k d/2)
 * 4/pi times that with its edge for D. C = 0.58 and k = 1.4 for spheres;
 * measured are 0.55 to 0.65 and 1.3 to 1.5, hence bounds of 10 %. Chance leaves 2 % of a rate, and so 0.13 of a k fitted to three: k itself
 * is no row. Below five diameters the law doesn't hold: through a hole of 4.5 come 14 % more. */
static double beverloo(double bulk, double edge) {
    return 4.0 / pi * 0.58 * bulk * sqrt(gravity) * pow(edge - 1.4 * diameter, 2.5);
}

scree_status suite_silo(struct figures *figures) {
    static struct silo silos[SILO_RUNS];
#pragma omp parallel for schedule(dynamic) num_threads(figures->threads)
    for (int k = 0; k < SILO_RUNS; k++) {
        silos[k] = (struct silo){.hole = (5.5 + 0.75 * k) * diameter};
        empty_silo(&silos[k], k + 1);
        if (k == 1) write_scene(figures, &silos[k].run, "silo");
    }
    scree_status status = check_runs(figures, &silos[0].run, sizeof silos[0], SILO_RUNS);
    struct scree_out out = {0};
    if (!status) status = figures_table(figures, "silo", "hole_diameters,time_s,grains_out", &out);
    for (int k = 0; k < SILO_RUNS; k++) {
        for (int row = 0; row < silos[k].rows && !status; row++)
            fprintf(out.file, "%g,%.17g,%d\n", 5.5 + 0.75 * k, 0.01 * row, silos[k].out[row]);
        end_run(&silos[k].run);
    }
    if (!status) status = scree_out_keep(&out, &figures->trouble);
    for (int k = 0; k < SILO_RUNS && !status; k++) {
        char quantity[80];
        snprintf(quantity, sizeof quantity, "rate through a hole of %g d, against Beverloo (kg/s)", 5.5 + 0.75 * k);
        figures_report(figures, "silo", quantity, beverloo(silos[k].bulk, silos[k].hole), silos[k].rate, 0.1);
    }
    return status ? status : figures_plot(figures, "silo", silo_script);
}

/* ---- Janssen's column ---- */

enum { COLUMN_RUNS = 2, COLUMN_BINS = 12, COLUMN_SAMPLES = 25 };

static const double column_half = 16e-3, column_moves = 0.25, column_end = 0.5;

/* The walls slide upwards, so that all grains along them hang on their friction. */
struct column {
    struct run run;
    double weight, base, normal, friction; /* N: of the grains, on the base, of the walls on them; means over samples */
    double press[COLUMN_BINS], hold[COLUMN_BINS],
        load[COLUMN_BINS]; /* N: of the walls, and weight, bin by bin from below */
};

static const double column_bin = 0.01; /* m */

static void make_column(struct column *column, int seed) {
    struct grains g = {.young = 1e6, .step = 4e-5, .end = 0.5, .speed = 1.0, .domain = ""};
    size_t size;
    FILE *file = begin_scene(&column->run, &size, &g);
    if (!file) return;
    fprintf(file, "[[motion]]\nname = \"up\"\nkind = \"velocity\"\nvelocity = 0.02\nstart = %g\n", column_moves);
    put_box(file, column_half, "{ z = \"up\", others = \"fixed\" }");
    put_plane(file, "base", 2, 0.0, 1, "\"fixed\"");
    put_grains(file, (double[]){-column_half, -column_half, 0.0}, (double[]){column_half, column_half, 0.2}, 2200,
               seed);
    end_scene(&column->run, file, &size);
}

static int bin_of(double z) {
    int bin = (int)floor(z / column_bin);
    return bin < 0 ? 0 : bin >= COLUMN_BINS ? COLUMN_BINS - 1 : bin;
}

static void sample_column(struct column *column) {
    enum { CAPACITY = 40000 };
    scree_scene *scene = column->run.scene;
    scree_contact_state *contacts = malloc(CAPACITY * sizeof *contacts);
    int count = 0;
    column->run.status = contacts ? scree_scene_contacts(scene, contacts, CAPACITY, &count)
                                  : scree_report(&column->run.trouble, SCREE_NO_MEMORY, NULL, "no memory for contacts");
    for (int k = 0; k < count && k < CAPACITY; k++) {
        const scree_contact_state *c = &contacts[k];
        if (c->host == 4) column->base += c->normal_force / COLUMN_SAMPLES;
        if (c->host >= 4) continue;
        int bin = bin_of(c->point[2]);
        column->normal += c->normal_force / COLUMN_SAMPLES;
        column->friction += c->friction[2] / COLUMN_SAMPLES;
        column->press[bin] += c->normal_force / COLUMN_SAMPLES;
        column->hold[bin] += c->friction[2] / COLUMN_SAMPLES;
    }
    for (int k = first_grain(scene); k < scree_scene_bodies(scene); k++)
        column->load[bin_of(scree_scene_body(scene, k).position[2])] += grain_mass() * gravity / COLUMN_SAMPLES;
    free(contacts);
}

static void load_column(struct column *column, int seed) {
    make_column(column, seed);
    column->weight = 2200 * grain_mass() * gravity;
    for (int k = 1; k <= COLUMN_SAMPLES; k++) {
        double share = 0.5 + 0.5 * k / COLUMN_SAMPLES; /* the second half of the walls' way */
        if (go_until(&column->run, column_moves + share * (column_end - column_moves))) sample_column(column);
    }
}

/* Pressure on the walls over that on the level between two bins, mean of the bins between a quarter and three quarters of the height. */
static double janssen_ratio(const struct column *c, double *height) {
    double above[COLUMN_BINS + 1] = {0.0}, ratio = 0.0, bins = 0.0;
    *height = 0.0;
    for (int k = COLUMN_BINS - 1; k >= 0; k--) {
        above[k] = above[k + 1] + c->load[k] - c->hold[k];
        *height += column_bin * c->load[k] / fmax(c->load[4], c->load[k]);
    }
    for (int k = 2; k < 9; k++) {
        double level = 0.5 * (above[k] + above[k + 1]) / (4.0 * column_half * column_half);
        ratio += c->press[k] / (8.0 * column_half * column_bin) / level;
        bins++;
    }
    return ratio / bins;
}

static const char column_script[] =
    "set title 'Load in a column between walls of friction 0.2'\n"
    "set xlabel 'load (N)'\nset ylabel 'height (m)'\n"
    "plot for [k=1:2] 'column.csv' using ($1==k ? $6 : NaN):2 with linespoints ls k title sprintf('run %d', k)\n";

/* Janssen, Z. Ver. dt. Ing. 39 (1895) 1045: load rho g L A (1 - exp(-H/L)), L = D/(4 mu K) for a square of edge D. K is what the walls
 * and levels of the column itself say, and mu how much of their friction is called upon: some nine tenths of it, since grains
 * along the wall roll as well as slide. What is tested is that both are the same all the way down; 10 %, as codes agree in this. */
scree_status suite_column(struct figures *figures) {
    static struct column columns[COLUMN_RUNS];
#pragma omp parallel for schedule(dynamic) num_threads(figures->threads)
    for (int k = 0; k < COLUMN_RUNS; k++) {
        columns[k] = (struct column){.weight = 0.0};
        load_column(&columns[k], k + 1);
        if (k == 0) write_scene(figures, &columns[k].run, "column");
    }
    scree_status status = check_runs(figures, &columns[0].run, sizeof columns[0], COLUMN_RUNS);
    struct scree_out out = {0};
    if (!status)
        status =
            figures_table(figures, "column", "run,height_m,weight_N,wall_normal_N,wall_friction_N,load_below_N", &out);
    double base = 0.0, law = 0.0, balance = 0.0;
    for (int k = 0; k < COLUMN_RUNS && !status; k++) {
        struct column *c = &columns[k];
        double height, ratio = janssen_ratio(c, &height), mu = c->friction / c->normal;
        double length = 2.0 * column_half / (4.0 * mu * ratio), above = 0.0;
        base += c->base / c->weight / COLUMN_RUNS;
        law += length / height * (1.0 - exp(-height / length)) / COLUMN_RUNS;
        balance += (c->base + c->friction) / c->weight / COLUMN_RUNS;
        for (int bin = COLUMN_BINS - 1; bin >= 0; bin--) {
            above += c->load[bin] - c->hold[bin];
            fprintf(out.file, "%d,%.17g,%.17g,%.17g,%.17g,%.17g\n", k + 1, column_bin * bin, c->load[bin],
                    c->press[bin], c->hold[bin], above);
        }
    }
    if (!status) status = scree_out_keep(&out, &figures->trouble);
    for (int k = 0; k < COLUMN_RUNS; k++) end_run(&columns[k].run);
    if (status) return status;
    /* Means of 25 instants, in which the grains still move. */
    figures_report(figures, "column", "base and walls bear, over the weight", 1.0, balance, 0.01);
    figures_report(figures, "column", "load of the base over the weight, against Janssen", law, base, 0.1);
    return figures_plot(figures, "column", column_script);
}

/* ---- angle of repose: what is left on a rough plate when its side walls go ---- */

enum { HEAP_SEEDS = 3, HEAP_RUNS = 2 * HEAP_SEEDS, HEAP_BINS = 16 };

static const double heap_half = 64e-3, heap_depth = 24e-3, heap_opens = 0.25, heap_end = 1.0;

struct heap {
    struct run run;
    double height[HEAP_BINS]; /* of the surface, m, from left to right */
    double angle;             /* rad */
    int left;                 /* grains on the plate */
};

/* The plate is a layer of fixed grains, 4 mm apart, up and down by a quarter of their diameter at most, periodic across. */
static void make_heap(struct heap *heap, double rolling, int seed) {
    struct grains g = {.young = 1e6,
                       .rolling = rolling,
                       .step = 4e-5,
                       .end = heap_end,
                       .speed = 1.0,
                       .domain = "[domain]\nmin = [-1, 0, -1]\nmax = [1, 0.024, 1]\nperiodic = [\"y\"]\n"};
    size_t size;
    FILE *file = begin_scene(&heap->run, &size, &g);
    if (!file) return;
    fprintf(file,
            "[[motion]]\nname = \"right\"\nkind = \"velocity\"\nvelocity = 1\nstart = %g\nduration = 0.1\n"
            "[[motion]]\nname = \"left\"\nkind = \"velocity\"\nvelocity = -1\nstart = %g\nduration = 0.1\n",
            heap_opens, heap_opens);
    put_plane(file, "left", 0, -heap_half, 1, "{ x = \"left\", others = \"fixed\" }");
    put_plane(file, "right", 0, heap_half, 0, "{ x = \"right\", others = \"fixed\" }");
    put_plane(file, "ground", 2, -0.1, 1, "\"fixed\"");
    for (int k = 0; k < 32 * 6; k++)
        fprintf(file,
                "[[body]]\nname = \"plate %d\"\nshape = { sphere = 2e-3 }\nmaterial = \"m1\"\njoint = \"fixed\"\n"
                "position = [%.17g, %.17g, %.17g]\n",
                k + 1, -heap_half + radius + diameter * (k % 32), radius + diameter * (k / 32),
                -radius + 1e-3 * ((k * 37 % 11) / 5.0 - 1.0));
    put_grains(file, (double[]){-heap_half, 0.0, 1e-3}, (double[]){heap_half, heap_depth, 0.2}, 2100, seed);
    end_scene(&heap->run, file, &size);
}

/* Highest grain over each square of two diameters, mean across. */
static void measure_heap(struct heap *heap) {
    enum { ACROSS = 3 };
    const scree_scene *scene = heap->run.scene;
    double top[HEAP_BINS][ACROSS] = {{0.0}}, width = 2.0 * heap_half / HEAP_BINS, slope = 0.0, square = 0.0;
    for (int k = first_grain(scene); k < scree_scene_bodies(scene); k++) {
        scree_body_state grain = scree_scene_body(scene, k);
        heap->left += grain.position[2] > -radius && fabs(grain.position[0]) < heap_half;
        int column = (int)floor((grain.position[0] + heap_half) / width);
        int row = (int)floor(grain.position[1] / heap_depth * ACROSS);
        if (column < 0 || column >= HEAP_BINS || row < 0 || row >= ACROSS) continue;
        top[column][row] = fmax(top[column][row], grain.position[2]);
    }
    for (int column = 0; column < HEAP_BINS; column++) {
        heap->height[column] = 0.0;
        for (int row = 0; row < ACROSS; row++) heap->height[column] += top[column][row] / ACROSS;
    }
    /* A line through both flanks at once, without the top and the edges. */
    double mean[2] = {0.0, 0.0};
    for (int k = 1; k < 7; k++) {
        mean[0] += (k + 0.5) * width / 6.0;
        mean[1] += 0.5 * (heap->height[k] + heap->height[HEAP_BINS - 1 - k]) / 6.0;
    }
    for (int k = 1; k < 7; k++) {
        double x = (k + 0.5) * width - mean[0];
        slope += x * (0.5 * (heap->height[k] + heap->height[HEAP_BINS - 1 - k]) - mean[1]);
        square += x * x;
    }
    heap->angle = atan(slope / square);
}

/* Heaps this small differ: by 1.4 degrees without rolling friction, by 2.8 with it, the grains left by 30 and 25. */
static const struct peer heap_angle[2] = {{24.9415, 1.4, 3}, {28.8406, 2.8, 3}},
                         heap_left[2] = {{1127.3, 30.0, 3}, {1233.7, 25.0, 3}};

static const char heap_script[] =
    "set title 'Angle of repose: surface of what stays on a plate'\n"
    "set xlabel 'x (m)'\nset ylabel 'height (m)'\nset size ratio -1\n"
    "plot 'heap.csv' using ($1<4 ? $2 : NaN):3 with points ls 1 title 'no rolling friction',\\\n"
    "     '' using ($1>3 ? $2 : NaN):3 with points ls 2 title 'rolling friction 0.1'\n";

scree_status suite_heap(struct figures *figures) {
    static struct heap heaps[HEAP_RUNS];
#pragma omp parallel for schedule(dynamic) num_threads(figures->threads)
    for (int k = 0; k < HEAP_RUNS; k++) {
        heaps[k] = (struct heap){.angle = 0.0};
        make_heap(&heaps[k], k < HEAP_SEEDS ? 0.0 : 0.1, k % HEAP_SEEDS + 1);
        if (k % HEAP_SEEDS == 0) write_scene(figures, &heaps[k].run, k ? "heap_rolling" : "heap");
        if (go_until(&heaps[k].run, heap_end)) measure_heap(&heaps[k]);
    }
    scree_status status = check_runs(figures, &heaps[0].run, sizeof heaps[0], HEAP_RUNS);
    struct scree_out out = {0};
    double angle[2] = {0.0}, left[2] = {0.0};
    if (!status) status = figures_table(figures, "heap", "run,x_m,height_m", &out);
    for (int k = 0; k < HEAP_RUNS; k++) {
        angle[k / HEAP_SEEDS] += heaps[k].angle * 180.0 / pi / HEAP_SEEDS;
        left[k / HEAP_SEEDS] += (double)heaps[k].left / HEAP_SEEDS;
        for (int bin = 0; bin < HEAP_BINS && !status; bin++)
            fprintf(out.file, "%d,%.17g,%.17g\n", k + 1, heap_half * ((2.0 * bin + 1.0) / HEAP_BINS - 1.0),
                    heaps[k].height[bin]);
        end_run(&heaps[k].run);
    }
    if (!status) status = scree_out_keep(&out, &figures->trouble);
    for (int rolls = 0; rolls < 2 && !status; rolls++) {
        report_beside(figures, "heap", rolls ? "angle, rolling friction 0.1 (degrees)" : "angle (degrees)",
                      &heap_angle[rolls], angle[rolls], HEAP_SEEDS);
        report_beside(figures, "heap", rolls ? "grains left, rolling friction 0.1" : "grains left on the plate",
                      &heap_left[rolls], left[rolls], HEAP_SEEDS);
    }
    return status ? status : figures_plot(figures, "heap", heap_script);
}

/* ---- a drum turns ---- */

enum { DRUM_RUNS = 2, DRUM_ROWS = 200, DRUM_AROUND = 72, DRUM_ACROSS = 5 };

static const double drum_radius = 52e-3, drum_turn = 2.8, drum_from = 1.0, drum_end = 2.5; /* m, rad/s, s */

struct drum {
    struct run run;
    double angle[DRUM_ROWS], mean; /* of the centre of mass from the plumb line, every 10 ms, rad */
    int rows;
};

/* The shell is grains that go round: x = R sin, z = R cos of one angle, and turn with it. Periodic along the axis. */
static void make_drum(struct drum *drum, int seed) {
    struct grains g = {.young = 1e6,
                       .step = 4e-5,
                       .end = drum_end,
                       .speed = 1.0,
                       .domain = "[domain]\nmin = [-0.1, 0, -0.1]\nmax = [0.1, 0.02, 0.1]\nperiodic = [\"y\"]\n"};
    size_t size;
    FILE *file = begin_scene(&drum->run, &size, &g);
    if (!file) return;
    fprintf(file, "[[motion]]\nname = \"turn\"\nkind = \"velocity\"\nvelocity = %.17g\n", drum_turn);
    for (int k = 0; k < DRUM_AROUND; k++)
        for (int along = 0; along < 2; along++)
            fprintf(
                file,
                "[[motion]]\nname = \"%c%d\"\nkind = \"sine\"\namplitude = %.17g\nfrequency = %.17g\nphase = %.17g\n",
                along ? 'z' : 'x', k, drum_radius, drum_turn / (2.0 * pi),
                2.0 * pi * k / DRUM_AROUND + (along ? 0.5 * pi : 0.0));
    for (int k = 0; k < DRUM_AROUND * DRUM_ACROSS; k++) {
        int at = k % DRUM_AROUND;
        fprintf(file,
                "[[body]]\nname = \"shell %d\"\nshape = { sphere = 2e-3 }\nmaterial = \"wall\"\n"
                "position = [0, %.17g, 0]\n"
                "joint = { x = \"x%d\", z = \"z%d\", y = \"fixed\", turn = { axis = [0, 1, 0], motion = \"turn\" } }\n",
                k + 1, radius + diameter * (k / DRUM_AROUND), at, at);
    }
    put_grains(file, (double[]){-34e-3, 0.0, -34e-3}, (double[]){34e-3, 20e-3, 34e-3}, 0, seed);
    end_scene(&drum->run, file, &size);
}

static void turn_drum(struct drum *drum, int seed) {
    make_drum(drum, seed);
    int last = (int)lround((drum_end - drum_from) / 0.01);
    for (int row = 0; row < last && row < DRUM_ROWS && go_until(&drum->run, drum_from + 0.01 * row); row++) {
        double x = 0.0, z = 0.0;
        for (int k = first_grain(drum->run.scene); k < scree_scene_bodies(drum->run.scene); k++) {
            scree_body_state grain = scree_scene_body(drum->run.scene, k);
            x += grain.position[0];
            z += grain.position[2];
        }
        drum->angle[row] = atan2(-x, -z);
        drum->mean += drum->angle[row] / last;
        drum->rows = row + 1;
    }
}

static const struct peer drum_angle = {31.7212, 0.28, 3};

static const char drum_script[] =
    "set title 'Drum: direction of the centre of mass'\n"
    "set xlabel 'time (s)'\nset ylabel 'angle from the plumb line (degrees)'\n"
    "plot for [k=1:2] 'drum.csv' using ($1==k ? $2 : NaN):3 with lines ls k title sprintf('run %d', k)\n";

scree_status suite_drum(struct figures *figures) {
    static struct drum drums[DRUM_RUNS];
#pragma omp parallel for schedule(dynamic) num_threads(figures->threads)
    for (int k = 0; k < DRUM_RUNS; k++) {
        drums[k] = (struct drum){.mean = 0.0};
        turn_drum(&drums[k], k + 1);
        if (k == 0) write_scene(figures, &drums[k].run, "drum");
    }
    scree_status status = check_runs(figures, &drums[0].run, sizeof drums[0], DRUM_RUNS);
    struct scree_out out = {0};
    double mean = 0.0;
    if (!status) status = figures_table(figures, "drum", "run,time_s,angle_deg", &out);
    for (int k = 0; k < DRUM_RUNS; k++) {
        mean += drums[k].mean * 180.0 / pi / DRUM_RUNS;
        for (int row = 0; row < drums[k].rows && !status; row++)
            fprintf(out.file, "%d,%.17g,%.17g\n", k + 1, drum_from + 0.01 * row, drums[k].angle[row] * 180.0 / pi);
        end_run(&drums[k].run);
    }
    if (!status) status = scree_out_keep(&out, &figures->trouble);
    if (status) return status;
    report_beside(figures, "drum", "dynamic angle, 1 to 2.5 s (degrees)", &drum_angle, mean, DRUM_RUNS);
    return figures_plot(figures, "drum", drum_script);
}

/* ---- a ball falls on a bed ---- */

enum { CRATER_RUNS = 3, CRATER_ROWS = 45 };

static const double crater_half = 30e-3, crater_ball = 10e-3, crater_from = 0.28, crater_end = 0.5;

struct crater {
    struct run run;
    double surface;             /* mean height of the highest grains before, m */
    double height[CRATER_ROWS]; /* of the ball's lowest point, every 5 ms */
    int rows;
};

/* The ball is thrown upwards while the bed settles, and comes back at 1.6 m/s. */
static void make_crater(struct crater *crater, int seed) {
    struct grains g = {.young = 1e7, .step = 1.25e-5, .end = crater_end, .speed = 1.5, .domain = ""};
    size_t size;
    FILE *file = begin_scene(&crater->run, &size, &g);
    if (!file) return;
    put_box(file, crater_half, "\"fixed\"");
    put_plane(file, "floor", 2, 0.0, 1, "\"fixed\"");
    fprintf(file,
            "[[body]]\nname = \"ball\"\nshape = { sphere = %g }\nmaterial = \"wall\"\nposition = [0, 0, 0.1]\n"
            "velocity = [0, 0, 1.35]\n",
            crater_ball);
    put_grains(file, (double[]){-crater_half, -crater_half, 0.0}, (double[]){crater_half, crater_half, 0.1}, 3300,
               seed);
    end_scene(&crater->run, file, &size);
}

/* Mean over squares of two diameters of the highest grain's top. */
static double surface_of(const scree_scene *scene) {
    enum { SQUARES = 7 };
    double top[SQUARES][SQUARES] = {{0.0}}, sum = 0.0;
    for (int k = first_grain(scene); k < scree_scene_bodies(scene); k++) {
        scree_body_state grain = scree_scene_body(scene, k);
        int i = (int)floor((grain.position[0] / crater_half + 1.0) * 0.5 * SQUARES);
        int j = (int)floor((grain.position[1] / crater_half + 1.0) * 0.5 * SQUARES);
        if (i < 0 || j < 0 || i >= SQUARES || j >= SQUARES) continue;
        top[i][j] = fmax(top[i][j], grain.position[2] + radius);
    }
    for (int k = 0; k < SQUARES * SQUARES; k++) sum += top[k / SQUARES][k % SQUARES];
    return sum / (SQUARES * SQUARES);
}

static void fall_on_bed(struct crater *crater, int seed) {
    make_crater(crater, seed);
    int ball = crater->run.status ? 0 : scree_scene_find_body(crater->run.scene, "ball");
    for (int row = 0; row < CRATER_ROWS && go_until(&crater->run, crater_from + 0.005 * row); row++) {
        if (row == 0) crater->surface = surface_of(crater->run.scene);
        crater->height[row] = scree_scene_body(crater->run.scene, ball).position[2] - crater_ball;
        crater->rows = row + 1;
    }
}

/* From places to places the depth differs by 1.8 mm. */
static const struct peer crater_depth = {0.02904, 1.8e-3, 1};

static const char crater_script[] =
    "set title 'A ball falls on a bed'\n"
    "set xlabel 'time (s)'\nset ylabel 'depth of its lowest point (m)'\n"
    "plot for [k=1:3] 'crater.csv' using ($1==k ? $2 : NaN):3 with lines ls k title sprintf('run %d', k)\n";

scree_status suite_crater(struct figures *figures) {
    static struct crater craters[CRATER_RUNS];
#pragma omp parallel for schedule(dynamic) num_threads(figures->threads)
    for (int k = 0; k < CRATER_RUNS; k++) {
        craters[k] = (struct crater){.surface = 0.0};
        fall_on_bed(&craters[k], k + 1);
        if (k == 0) write_scene(figures, &craters[k].run, "crater");
    }
    scree_status status = check_runs(figures, &craters[0].run, sizeof craters[0], CRATER_RUNS);
    struct scree_out out = {0};
    double depth = 0.0;
    if (!status) status = figures_table(figures, "crater", "run,time_s,depth_m", &out);
    for (int k = 0; k < CRATER_RUNS; k++) {
        const struct crater *c = &craters[k];
        for (int row = 0; row < c->rows && !status; row++)
            fprintf(out.file, "%d,%.17g,%.17g\n", k + 1, crater_from + 0.005 * row, c->surface - c->height[row]);
        if (c->rows) depth += (c->surface - c->height[c->rows - 1]) / CRATER_RUNS;
        end_run(&craters[k].run);
    }
    if (!status) status = scree_out_keep(&out, &figures->trouble);
    if (status) return status;
    report_beside(figures, "crater", "depth at which the ball stays (m)", &crater_depth, depth, CRATER_RUNS);
    return figures_plot(figures, "crater", crater_script);
}
