/* Grains by the thousand: discharge of a silo, load of a column between walls, angle of repose, rotating drum, impact
 * on a bed. After the benchmark of Dosta et al., Comput. Phys. Commun. 296 (2024) 109066
 * (data/reference/dosta2024_parameters.csv), made small: its grains M1 and, in a silo and in a drum, M2 (2500 and 2000
 * kg/m^3, Poisson's ratio 0.2, restitution and friction by pairs below), of 4 mm, but thousands of them instead of
 * 25,000 to 122,000, and 1 MPa instead of 1 GPa (10 MPa for the impact). Rate and shape of a slow flow don't depend on
 * the modulus while overlaps are small: E/(rho g d) is 1e4, which makes 1 % of a diameter under ten layers. */
#include "engine/cli/figures.h"
#include "engine/scene_file.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double gravity = 9.81, pi = 3.14159265358979323846, radius = 2e-3, diameter = 4e-3,
                    densities[2] = {2500.0, 2000.0};

/* ---- scenes as text ---- */

/* One run: a scene of its own, so that several go at the same time. */
struct run {
    char *text;          /* of the scene, owned */
    const char *save_as; /* name under which the scene is written beside the data, so that it can be run, seen and given
                            to other programs; or NULL */
    scree_scene *scene;
    scree_status status;
    scree_trouble trouble;
};

struct grains {
    double young;            /* Pa, of M1; M2 has half of it */
    double rolling;          /* coefficient */
    double step, end, speed; /* s, s, m/s */
    const char *domain;      /* or "" */
};

/* Begin a scene. Tangential damping ratios are sqrt(5/6) of the normal ones, as LAMMPS and LIGGGHTS have them. */
static FILE *begin_scene(struct run *run, size_t *size, const struct grains *g) {
    *run = (struct run){.save_as = run->save_as};
    FILE *file = open_memstream(&run->text, size);
    if (!file) {
        run->status = scree_report(&run->trouble, SCREE_NO_MEMORY, NULL, "no memory for a scene");
        return NULL;
    }
    fprintf(file,
            "gravity = [0, 0, -9.81]\n[time]\nintegrator = \"verlet\"\nend = %g\nstep = %g\nspeed = %g\n%s"
            "[[material]]\nname = \"m1\"\ndensity = 2500\nyoung = %g\npoisson = 0.2\n"
            "[[material]]\nname = \"m2\"\ndensity = 2000\nyoung = %g\npoisson = 0.2\n"
            "[[material]]\nname = \"wall\"\ndensity = 7200\nyoung = %g\npoisson = 0.2\n"
            "[[contact]]\nbetween = [\"wall\", \"wall\"]\nnone = true\n",
            g->end, g->step, g->speed, g->domain, g->young, 0.5 * g->young, g->young);
    static const struct {
        const char *between;
        double restitution, friction;
    } pairs[] = {{"\"m1\", \"m1\"", 0.5, 0.3},
                 {"\"m2\", \"m2\"", 0.4, 0.4},
                 {"\"m1\", \"m2\"", 0.45, 0.2},
                 {"\"m1\", \"wall\"", 0.4, 0.2},
                 {"\"m2\", \"wall\"", 0.4, 0.2}};
    for (size_t k = 0; k < sizeof pairs / sizeof pairs[0]; k++) {
        double lost = log(pairs[k].restitution), damping = -lost / sqrt(pi * pi + lost * lost) * sqrt(5.0 / 6.0);
        fprintf(file,
                "[[contact]]\nbetween = [%s]\nnormal = { law = \"tsuji\", restitution = %g }\n"
                "friction = { law = \"mindlin\", static = %g, kinetic = %g, damping = %.5g }\n",
                pairs[k].between, pairs[k].restitution, pairs[k].friction, pairs[k].friction, damping);
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
struct lattice {
    const char *name, *material;
    double min[3], max[3];
    int count; /* 0: as many as fit */
};

static void put_grains(FILE *file, const struct lattice *l, int seed) {
    fprintf(file,
            "[[generate]]\nname = \"%s\"\nkind = \"lattice\"\nmaterial = \"%s\"\nradius = %g\nspacing = 4.1e-3\n"
            "jitter = 5e-5\nseed = %d\nmin = [%.17g, %.17g, %.17g]\nmax = [%.17g, %.17g, %.17g]\n",
            l->name, l->material, radius, seed, l->min[0], l->min[1], l->min[2], l->max[0], l->max[1], l->max[2]);
    if (l->count) fprintf(file, "count = %d\n", l->count);
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

static scree_status write_scene(struct figures *figures, const struct run *run) {
    struct scree_out out;
    char name[64];
    snprintf(name, sizeof name, "%s.toml", run->save_as);
    char *path = scree_join(figures->folder, name);
    if (!path) return scree_report(&figures->trouble, SCREE_NO_MEMORY, NULL, "no memory for a file name");
    scree_status status = scree_out_open(&out, path, &figures->trouble);
    free(path);
    if (status) return status;
    fputs(run->text, out.file);
    return scree_out_keep(&out, &figures->trouble);
}

/* A case: runs that go at the same time, each in a struct of its own that begins with its struct run. */
struct bulk_case {
    const char *name, *header; /* of the table */
    void *runs;
    size_t size; /* of one */
    int count;
    void (*work)(void *one, int number); /* make and run the scene, measure; sets run.save_as first */
    void (*write)(const void *one, int number, FILE *file); /* its rows */
};

static void *run_of(const struct bulk_case *c, int number) { return (char *)c->runs + (size_t)number * c->size; }

/* Make the runs, the table, and the scenes that are to be kept; the first failure among runs is that of the case. */
static scree_status run_case(struct figures *figures, const struct bulk_case *c) {
    memset(c->runs, 0, (size_t)c->count * c->size);
#pragma omp parallel for schedule(dynamic) num_threads(figures->threads)
    for (int k = 0; k < c->count; k++) c->work(run_of(c, k), k);
    scree_status status = SCREE_OK;
    struct scree_out out = {0};
    for (int k = 0; k < c->count && !status; k++) {
        const struct run *run = run_of(c, k);
        status = run->status;
        if (status)
            figures->trouble = run->trouble;
        else if (run->save_as)
            status = write_scene(figures, run);
    }
    if (!status) status = figures_table(figures, c->name, c->header, &out);
    for (int k = 0; k < c->count; k++) {
        if (!status) c->write(run_of(c, k), k, out.file);
        end_run(run_of(c, k));
    }
    return status ? status : scree_out_keep(&out, &figures->trouble);
}

static double grain_mass(double density) { return 4.0 / 3.0 * pi * radius * radius * radius * density; }

/* What LAMMPS makes of the same scenes, by bench/peers/bulk.sh (data/reference/bulk_lammps.csv), and what may lie
 * between two means of runs from other places of the grains: three times its standard error. */
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

enum { SILO_RUNS = 4, SILO_ROWS = 300 };

static const double silo_half = 28e-3, silo_opens = 0.25;

struct silo {
    struct run run;
    int second;               /* grains of M2 */
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
    put_grains(file, &(struct lattice){"grain", silo->second ? "m2" : "m1", {-b, -b, 0.0}, {b, b, 0.2}, 4000}, seed);
    end_scene(&silo->run, file, &size);
}

/* Mass over volume between 4 and 14 diameters above the floor. */
static double bulk_density(const scree_scene *scene, double area, double density) {
    int inside = 0;
    for (int k = first_grain(scene); k < scree_scene_bodies(scene); k++) {
        double z = scree_scene_body(scene, k).position[2];
        inside += z > 4.0 * diameter && z < 14.0 * diameter;
    }
    return inside * grain_mass(density) / (area * 10.0 * diameter);
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

/* Holes of 5.5, 6.25 and 7 diameters; the second once more with M2. From 250 to 950 of 4000 grains out: the bed is
 * nearly as high as wide, or higher, all the while. */
static void empty_silo(void *one, int number) {
    static const int from = 250, to = 950;
    struct silo *silo = one;
    silo->second = number == 3;
    silo->hole = (5.5 + 0.75 * (number == 3 ? 1 : number)) * diameter;
    silo->run.save_as = number == 1 ? "silo" : number == 3 ? "silo_m2" : NULL;
    make_silo(silo, number + 1);
    if (go_until(&silo->run, silo_opens))
        silo->bulk = bulk_density(silo->run.scene, 4.0 * silo_half * silo_half, densities[silo->second]);
    for (int row = 0; row < SILO_ROWS && go_until(&silo->run, silo_opens + 0.01 * row); row++) {
        silo->out[row] = grains_below(silo->run.scene, -radius);
        silo->rows = row + 1;
        if (silo->out[row] >= to) break;
    }
    silo->rate = (to - from) * grain_mass(densities[silo->second]) / (time_of(silo, to) - time_of(silo, from));
}

static void write_silo(const void *one, int number, FILE *file) {
    const struct silo *silo = one;
    for (int row = 0; row < silo->rows; row++)
        fprintf(file, "%d,%g,%.17g,%d\n", number + 1, silo->hole / diameter, 0.01 * row, silo->out[row]);
}

static const char silo_script[] = "set title 'Discharge of a silo through a square hole'\n"
                                  "set xlabel 'time since the opening (s)'\nset ylabel 'grains out'\nset key top left\n"
                                  "plot for [k=1:4] 'silo.csv' using 3:($1==k ? $4 : NaN) with lines ls k "
                                  "title word('5.5d 6.25d 7d 6.25d,M2', k)\n";

/* Beverloo, Leniger & van de Velde, Chem. Eng. Sci. 15 (1961) 260: W = C rho sqrt(g) (D - k d)^2.5; for a square hole
 * (Nedderman, Statics and Kinematics of Granular Materials, 1992, ch. 10: area and hydraulic diameter of what is left
 * without a margin of k d/2) 4/pi times that with its edge for D. C = 0.58 and k = 1.4 for spheres; measured are 0.55
 * to 0.65 and 1.3 to 1.5, hence bounds of 10 %. Chance leaves 2 % of a rate, and so 0.13 of a k fitted to three: k
 * itself is no row. Below five diameters the law says less: through a hole of 4.5 came 3 to 7 % more in three runs, of
 * M2 10 % in one. */
static double beverloo(double bulk, double edge) {
    return 4.0 / pi * 0.58 * bulk * sqrt(gravity) * pow(edge - 1.4 * diameter, 2.5);
}

scree_status suite_silo(struct figures *figures) {
    static struct silo silos[SILO_RUNS];
    scree_status status = run_case(figures, &(struct bulk_case){"silo", "run,hole_diameters,time_s,grains_out", silos,
                                                                sizeof silos[0], SILO_RUNS, empty_silo, write_silo});
    for (int k = 0; k < SILO_RUNS && !status; k++) {
        char quantity[80];
        snprintf(quantity, sizeof quantity, "rate through a hole of %g d%s, against Beverloo (kg/s)",
                 silos[k].hole / diameter, silos[k].second ? ", M2" : "");
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
    put_grains(
        file,
        &(struct lattice){"grain", "m1", {-column_half, -column_half, 0.0}, {column_half, column_half, 0.2}, 2200},
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
        column->load[bin_of(scree_scene_body(scene, k).position[2])] +=
            grain_mass(densities[0]) * gravity / COLUMN_SAMPLES;
    free(contacts);
}

static void load_column(void *one, int number) {
    struct column *column = one;
    column->run.save_as = number == 0 ? "column" : NULL;
    make_column(column, number + 1);
    column->weight = 2200 * grain_mass(densities[0]) * gravity;
    for (int k = 1; k <= COLUMN_SAMPLES; k++) {
        double share = 0.5 + 0.5 * k / COLUMN_SAMPLES; /* the second half of the walls' way */
        if (go_until(&column->run, column_moves + share * (column_end - column_moves))) sample_column(column);
    }
}

static void write_column(const void *one, int number, FILE *file) {
    const struct column *c = one;
    double above = 0.0;
    for (int bin = COLUMN_BINS - 1; bin >= 0; bin--) {
        above += c->load[bin] - c->hold[bin];
        fprintf(file, "%d,%.17g,%.17g,%.17g,%.17g,%.17g\n", number + 1, column_bin * bin, c->load[bin], c->press[bin],
                c->hold[bin], above);
    }
}

/* Pressure on the walls over that on the level between two bins, mean of the bins between a quarter and three quarters
 * of the height. */
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

/* Janssen, Z. Ver. dt. Ing. 39 (1895) 1045: load rho g L A (1 - exp(-H/L)), L = D/(4 mu K) for a square of edge D. K is
 * what the walls and levels of the column itself say, and mu how much of their friction is called upon: some nine
 * tenths of it, since grains along the wall roll as well as slide. What is tested is that both are the same all the way
 * down; 10 %, as codes agree in this. */
scree_status suite_column(struct figures *figures) {
    static struct column columns[COLUMN_RUNS];
    scree_status status = run_case(
        figures, &(struct bulk_case){"column", "run,height_m,weight_N,wall_normal_N,wall_friction_N,load_below_N",
                                     columns, sizeof columns[0], COLUMN_RUNS, load_column, write_column});
    double base = 0.0, law = 0.0, balance = 0.0;
    if (status) return status;
    for (int k = 0; k < COLUMN_RUNS; k++) {
        const struct column *c = &columns[k];
        double height, ratio = janssen_ratio(c, &height), mu = c->friction / c->normal;
        double length = 2.0 * column_half / (4.0 * mu * ratio);
        base += c->base / c->weight / COLUMN_RUNS;
        law += length / height * (1.0 - exp(-height / length)) / COLUMN_RUNS;
        balance += (c->base + c->friction) / c->weight / COLUMN_RUNS;
    }
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

/* The plate is a layer of fixed grains, 4 mm apart, up and down by a quarter of their diameter at most, periodic
 * across. */
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
    put_grains(file, &(struct lattice){"grain", "m1", {-heap_half, 0.0, 1e-3}, {heap_half, heap_depth, 0.2}, 2100},
               seed);
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

static void run_heap(void *one, int number) {
    struct heap *heap = one;
    int rolls = number >= HEAP_SEEDS, seed = number % HEAP_SEEDS + 1;
    heap->run.save_as = seed > 1 ? NULL : rolls ? "heap_rolling" : "heap";
    make_heap(heap, rolls ? 0.1 : 0.0, seed);
    if (go_until(&heap->run, heap_end)) measure_heap(heap);
}

static void write_heap(const void *one, int number, FILE *file) {
    const struct heap *heap = one;
    for (int bin = 0; bin < HEAP_BINS; bin++)
        fprintf(file, "%d,%.17g,%.17g\n", number + 1, heap_half * ((2.0 * bin + 1.0) / HEAP_BINS - 1.0),
                heap->height[bin]);
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
    scree_status status = run_case(figures, &(struct bulk_case){"heap", "run,x_m,height_m", heaps, sizeof heaps[0],
                                                                HEAP_RUNS, run_heap, write_heap});
    double angle[2] = {0.0}, left[2] = {0.0};
    for (int k = 0; k < HEAP_RUNS; k++) {
        angle[k / HEAP_SEEDS] += heaps[k].angle * 180.0 / pi / HEAP_SEEDS;
        left[k / HEAP_SEEDS] += (double)heaps[k].left / HEAP_SEEDS;
    }
    for (int rolls = 0; rolls < 2 && !status; rolls++) {
        report_beside(figures, "heap", rolls ? "angle, rolling friction 0.1 (degrees)" : "angle (degrees)",
                      &heap_angle[rolls], angle[rolls], HEAP_SEEDS);
        report_beside(figures, "heap", rolls ? "grains left, rolling friction 0.1" : "grains left on the plate",
                      &heap_left[rolls], left[rolls], HEAP_SEEDS);
    }
    return status ? status : figures_plot(figures, "heap", heap_script);
}

/* ---- a drum turns ---- */

enum { DRUM_SEEDS = 2, DRUM_RUNS = 2 * DRUM_SEEDS, DRUM_ROWS = 200, DRUM_AROUND = 72, DRUM_ACROSS = 5 };

static const double drum_radius = 52e-3, drum_turn = 2.8, drum_from = 1.0, drum_end = 2.5; /* m, rad/s, s */

struct drum {
    struct run run;
    int mixed;                      /* the right half of the grains is of M2 */
    double angle[DRUM_ROWS], mean;  /* of the centre of mass from the plumb line, every 10 ms, rad */
    double share[DRUM_ROWS], other; /* of M2 among the grains in the lower right quadrant */
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
    put_grains(file,
               &(struct lattice){"grain", "m1", {-34e-3, 0.0, -34e-3}, {drum->mixed ? 0.0 : 34e-3, 20e-3, 34e-3}, 0},
               seed);
    if (drum->mixed)
        put_grains(file, &(struct lattice){"other", "m2", {0.0, 0.0, -34e-3}, {34e-3, 20e-3, 34e-3}, 0}, seed);
    end_scene(&drum->run, file, &size);
}

/* Centre of mass of the grains, and the share of M2 among those with x > 0 and z < 0, as Dosta et al. count them. */
static void look_into_drum(struct drum *drum, double *angle, double *share) {
    const scree_scene *scene = drum->run.scene;
    int first = first_grain(scene), other = scree_scene_find_body(scene, "other 1"), all = 0, m2 = 0;
    double x = 0.0, z = 0.0;
    for (int k = first; k < scree_scene_bodies(scene); k++) {
        scree_body_state grain = scree_scene_body(scene, k);
        int second = other >= 0 && k >= other;
        x += grain.position[0] * densities[second];
        z += grain.position[2] * densities[second];
        if (grain.position[0] <= 0.0 || grain.position[2] >= 0.0) continue;
        all++;
        m2 += second;
    }
    *angle = atan2(-x, -z);
    *share = all ? (double)m2 / all : 0.0;
}

static void turn_drum(void *one, int number) {
    struct drum *drum = one;
    int last = (int)lround((drum_end - drum_from) / 0.01), seed = number % DRUM_SEEDS + 1;
    drum->mixed = number >= DRUM_SEEDS;
    drum->run.save_as = seed > 1 ? NULL : drum->mixed ? "drum_mixed" : "drum";
    make_drum(drum, seed);
    for (int row = 0; row < last && row < DRUM_ROWS && go_until(&drum->run, drum_from + 0.01 * row); row++) {
        look_into_drum(drum, &drum->angle[row], &drum->share[row]);
        drum->mean += drum->angle[row] / last;
        drum->other += drum->share[row] / last;
        drum->rows = row + 1;
    }
}

static void write_drum(const void *one, int number, FILE *file) {
    const struct drum *drum = one;
    for (int row = 0; row < drum->rows; row++)
        fprintf(file, "%d,%.17g,%.17g,%.17g\n", number + 1, drum_from + 0.01 * row, drum->angle[row] * 180.0 / pi,
                drum->share[row]);
}

static const struct peer drum_angle = {31.7212, 0.28, 3}, drum_angle_mixed = {31.3715, 0.28, 3},
                         drum_share = {0.515412, 9e-3, 3};

static const char drum_script[] =
    "set title 'Drum: direction of the centre of mass'\n"
    "set xlabel 'time (s)'\nset ylabel 'angle from the plumb line (degrees)'\n"
    "plot for [k=1:4] 'drum.csv' using ($1==k ? $2 : NaN):3 with lines ls k title sprintf('run %d', k)\n";

scree_status suite_drum(struct figures *figures) {
    static struct drum drums[DRUM_RUNS];
    scree_status status = run_case(figures, &(struct bulk_case){"drum", "run,time_s,angle_deg,share_of_m2", drums,
                                                                sizeof drums[0], DRUM_RUNS, turn_drum, write_drum});
    double mean[2] = {0.0}, other = 0.0;
    if (status) return status;
    for (int k = 0; k < DRUM_RUNS; k++) {
        mean[drums[k].mixed] += drums[k].mean * 180.0 / pi / DRUM_SEEDS;
        other += drums[k].other / DRUM_SEEDS;
    }
    report_beside(figures, "drum", "dynamic angle, 1 to 2.5 s (degrees)", &drum_angle, mean[0], DRUM_SEEDS);
    report_beside(figures, "drum", "the same, half of M2", &drum_angle_mixed, mean[1], DRUM_SEEDS);
    report_beside(figures, "drum", "share of M2 in the lower right quadrant", &drum_share, other, DRUM_SEEDS);
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
    put_grains(
        file,
        &(struct lattice){"grain", "m1", {-crater_half, -crater_half, 0.0}, {crater_half, crater_half, 0.1}, 3300},
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

static void fall_on_bed(void *one, int number) {
    struct crater *crater = one;
    crater->run.save_as = number == 0 ? "crater" : NULL;
    make_crater(crater, number + 1);
    int ball = crater->run.status ? 0 : scree_scene_find_body(crater->run.scene, "ball");
    for (int row = 0; row < CRATER_ROWS && go_until(&crater->run, crater_from + 0.005 * row); row++) {
        if (row == 0) crater->surface = surface_of(crater->run.scene);
        crater->height[row] = scree_scene_body(crater->run.scene, ball).position[2] - crater_ball;
        crater->rows = row + 1;
    }
}

static void write_crater(const void *one, int number, FILE *file) {
    const struct crater *c = one;
    for (int row = 0; row < c->rows; row++)
        fprintf(file, "%d,%.17g,%.17g\n", number + 1, crater_from + 0.005 * row, c->surface - c->height[row]);
}

/* From places to places the depth differs by 1.8 mm. */
static const struct peer crater_depth = {0.02904, 1.8e-3, 1};

static const char crater_script[] =
    "set title 'A ball falls on a bed'\n"
    "set xlabel 'time (s)'\nset ylabel 'depth of its lowest point (m)'\n"
    "plot for [k=1:3] 'crater.csv' using ($1==k ? $2 : NaN):3 with lines ls k title sprintf('run %d', k)\n";

scree_status suite_crater(struct figures *figures) {
    static struct crater craters[CRATER_RUNS];
    scree_status status =
        run_case(figures, &(struct bulk_case){"crater", "run,time_s,depth_m", craters, sizeof craters[0], CRATER_RUNS,
                                              fall_on_bed, write_crater});
    double depth = 0.0;
    if (status) return status;
    for (int k = 0; k < CRATER_RUNS; k++)
        depth += (craters[k].surface - craters[k].height[craters[k].rows - 1]) / CRATER_RUNS;
    report_beside(figures, "crater", "depth at which the ball stays (m)", &crater_depth, depth, CRATER_RUNS);
    return figures_plot(figures, "crater", crater_script);
}
