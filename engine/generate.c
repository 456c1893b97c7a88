/* Spheres by rule: on a lattice, or anywhere. What is random is drawn in one fixed order from one small generator, so
 * that a definition means the same spheres on every machine. */
#include "engine/scene.h"

#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <unistd.h>

/* splitmix64 (Steele, Lea & Flood, "Fast splittable pseudorandom number generators", OOPSLA 2014). */
static uint64_t next(uint64_t *state) {
    uint64_t z = *state += 0x9e3779b97f4a7c15u;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
}

/* Uniform in [0, 1). */
static double draw(uint64_t *state) { return (double)(next(state) >> 11) * 0x1p-53; }

static double draw_between(uint64_t *state, double low, double high) { return low + (high - low) * draw(state); }

/* For masses spread evenly over the radii their number goes with r^-3; its integral is turned round. */
static double draw_radius(const scree_generate_def *def, uint64_t *state) {
    double a = def->radius[0], b = def->radius[1] > 0.0 ? def->radius[1] : a;
    if (a == b) return a;
    if (def->radii == SCREE_RADII_UNIFORM) return draw_between(state, a, b);
    double share = draw(state), r = a / sqrt(1.0 - share * (1.0 - (a / b) * (a / b)));
    return r < b ? r : b;
}

/* ---- what all kinds check ---- */

static double largest_radius(const scree_generate_def *def) { return fmax(def->radius[0], def->radius[1]); }

static scree_status check_box(scree_scene *scene, const scree_generate_def *def) {
    static const char *const axes[] = {"x", "y", "z"};
    for (int axis = 0; axis < 3; axis++) {
        double room = def->max[axis] - def->min[axis];
        if (!isfinite(def->min[axis]) || !isfinite(def->max[axis]) || !isfinite(room))
            return scree_report(&scene->trouble, SCREE_BAD_INPUT, "max", "the box of \"%s\" must be finite", def->name);
        if (!(room >=
              2.0 * largest_radius(def) * (1.0 - 1e-12))) /* a box that is just one diameter wide, in decimals */
            return scree_report(&scene->trouble, SCREE_BAD_INPUT, "max",
                                "the box of \"%s\" is %g m wide along %s: a sphere of radius %g m doesn't fit",
                                def->name, room, axes[axis], largest_radius(def));
    }
    return SCREE_OK;
}

static scree_status check_definition(scree_scene *scene, const scree_generate_def *def) {
    const double *r = def->radius;
    if (scene->baked) return scree_report(&scene->trouble, SCREE_BAD_INPUT, NULL, "a baked scene takes no new spheres");
    if (!def->name || !def->name[0])
        return scree_report(&scene->trouble, SCREE_BAD_INPUT, "name", "a group of spheres needs a name");
    if (def->radii != SCREE_RADII_UNIFORM && def->radii != SCREE_RADII_MASS)
        return scree_report(&scene->trouble, SCREE_BAD_INPUT, "distribution", "there is no distribution of number %d",
                            (int)def->radii);
    if (def->kind != SCREE_LATTICE && def->kind != SCREE_RANDOM)
        return scree_report(&scene->trouble, SCREE_BAD_INPUT, "kind", "there is no generator of number %d",
                            (int)def->kind);
    if (!(r[0] > 0.0) || !isfinite(r[0]) || !isfinite(r[1]) || !(r[1] == 0.0 || r[1] >= r[0]))
        return scree_report(&scene->trouble, SCREE_BAD_INPUT, "radius",
                            "the radii of \"%s\" must be > 0 m, the least first, got %g and %g", def->name, r[0], r[1]);
    if (def->count < 0)
        return scree_report(&scene->trouble, SCREE_BAD_INPUT, "count", "\"%s\" can't be %d spheres", def->name,
                            def->count);
    return check_box(scene, def);
}

/* What a sphere takes at the least, from here to the end of a run, contacts left out. */
static const double bytes_per_sphere = 600.0;

/* More bodies than memory allows are refused before they are made: else the machine would go down with them. */
static scree_status check_memory(scree_scene *scene, const scree_generate_def *def, double count) {
#ifdef _SC_PHYS_PAGES
    double memory = (double)sysconf(_SC_PHYS_PAGES) * (double)sysconf(_SC_PAGESIZE);
#else
    double memory = 0.0;
#endif
    if (count + scene->defs > INT_MAX)
        return scree_report(&scene->trouble, SCREE_NO_MEMORY, "count",
                            "\"%s\" would be %.3g spheres; a scene has at most %d bodies", def->name, count, INT_MAX);
    if (!(memory > 0.0) || (count + scene->defs) * bytes_per_sphere < memory) return SCREE_OK;
    return scree_report(&scene->trouble, SCREE_NO_MEMORY, "count",
                        "\"%s\" would be %.3g spheres: they need some %.2g GB, this machine has %.2g GB", def->name,
                        count, 1e-9 * (count + scene->defs) * bytes_per_sphere, 1e-9 * memory);
}

/* ---- a lattice ---- */

struct lattice {
    double spacing;
    int points[3]; /* along each axis */
};

/* Spacing and points; their number along an axis may be too large for the memory, not for the type. */
static scree_status plan_lattice(scree_scene *scene, const scree_generate_def *def, struct lattice *lattice,
                                 double *count) {
    double diameter = 2.0 * largest_radius(def), jitter = def->jitter, points = 1.0;
    if (!(jitter >= 0.0) || !isfinite(jitter))
        return scree_report(&scene->trouble, SCREE_BAD_INPUT, "jitter", "the jitter of \"%s\" must be >= 0 m, got %g",
                            def->name, jitter);
    if (!(def->spacing >= 0.0) || !isfinite(def->spacing))
        return scree_report(&scene->trouble, SCREE_BAD_INPUT, "spacing", "the spacing of \"%s\" must be > 0 m, got %g",
                            def->name, def->spacing);
    lattice->spacing = def->spacing > 0.0 ? def->spacing : diameter + 2.0 * jitter;
    double closest = lattice->spacing - 2.0 * jitter;
    /* 1e-12: lengths that fit exactly are given in decimals. */
    if (scree_joint_can_move(&def->joint) && closest < diameter * (1.0 - 1e-12))
        return scree_report(&scene->trouble, SCREE_BAD_INPUT, "spacing",
                            "points of \"%s\" come as close as %g m (spacing less twice the jitter), and spheres are "
                            "up to %g m wide: they would overlap",
                            def->name, closest, diameter);
    for (int axis = 0; axis < 3; axis++) {
        double most = floor((def->max[axis] - def->min[axis]) / lattice->spacing * (1.0 + 1e-12));
        points *= most;
        lattice->points[axis] = most < INT_MAX ? (int)most : INT_MAX;
    }
    if (!(points >= (def->count ? def->count : 1))) /* infinity times nothing too */
        return scree_report(&scene->trouble, SCREE_BAD_INPUT, "count",
                            "the box of \"%s\" has %.0f points %g m apart, too few for %d spheres", def->name, points,
                            lattice->spacing, def->count ? def->count : 1);
    *count = def->count ? def->count : points;
    return SCREE_OK;
}

static void fill_lattice(const scree_generate_def *def, const struct lattice *lattice, int count, double (*at)[3],
                         double *radius) {
    uint64_t state = def->seed;
    for (int k = 0; k < count; k++) {
        int row = k / lattice->points[0];
        int cell[3] = {k % lattice->points[0], row % lattice->points[1], row / lattice->points[1]};
        for (int axis = 0; axis < 3; axis++) {
            at[k][axis] = def->min[axis] + (cell[axis] + 0.5) * lattice->spacing;
            if (def->jitter > 0.0) at[k][axis] += draw_between(&state, -def->jitter, def->jitter);
        }
        radius[k] = draw_radius(def, &state);
    }
}

/* ---- anywhere ---- */

/* Spheres so far, those that were there before among them, in cells of grids: one for each power of two of their size,
 * the coarsest is number 0. A sphere lies in the finest grid whose cells are as large as its diameter. */
enum { GRIDS = 32, TRIES = 20000 };

struct cells {
    double coarsest;
    int highest; /* finest grid in use */
    size_t last; /* number of places, a power of two, less one */
    int *place, *next;
    int *behind; /* of a grid's spheres the one that came before, -1: none */
    int newest[GRIDS], spheres[GRIDS];
    const double (*at)[3];
    const double *radius;
};

/* Number of the cell along one axis; what is beyond exact whole numbers shares the outermost one. */
static long cell_of(double x, double size) { return (long)fmax(fmin(floor(x / size), 1e15), -1e15); }

static size_t place_of(const struct cells *cells, int level, const long cell[3]) {
    uint64_t state = (uint64_t)level;
    for (int axis = 0; axis < 3; axis++) state = next(&state) ^ (uint64_t)cell[axis];
    return (size_t)next(&state) & cells->last;
}

/* Whether one of a chain is too near; other cells' spheres in the same chain only cost time. */
static int chain_overlaps(const struct cells *cells, const int *next, int first, const double at[3], double radius) {
    for (int k = first; k >= 0; k = next[k]) {
        double reach = radius + cells->radius[k];
        if (vec_norm2(vec_sub(vec_from(at), vec_from(cells->at[k]))) < reach * reach) return 1;
    }
    return 0;
}

static int overlaps(const struct cells *cells, const double at[3], double radius) {
    for (int level = 0; level <= cells->highest; level++) {
        if (cells->spheres[level] == 0) continue;
        double size = ldexp(cells->coarsest, -level), reach = radius + 0.5 * size;
        long low[3], high[3], cell[3];
        double in_reach = 1.0;
        for (int axis = 0; axis < 3; axis++) {
            low[axis] = cell_of(at[axis] - reach, size);
            high[axis] = cell_of(at[axis] + reach, size);
            in_reach *= (double)(high[axis] - low[axis]) + 1.0;
        }
        if (in_reach > cells->spheres[level]) { /* one large sphere reaches any number of small cells */
            if (chain_overlaps(cells, cells->behind, cells->newest[level], at, radius)) return 1;
            continue;
        }
        for (cell[0] = low[0]; cell[0] <= high[0]; cell[0]++)
            for (cell[1] = low[1]; cell[1] <= high[1]; cell[1]++)
                for (cell[2] = low[2]; cell[2] <= high[2]; cell[2]++)
                    if (chain_overlaps(cells, cells->next, cells->place[place_of(cells, level, cell)], at, radius))
                        return 1;
    }
    return 0;
}

/* The same, of images across the borders of the periodic box too. */
static int is_taken(const struct cells *cells, const scree_domain_def *domain, const double at[3], double radius) {
    int first[3] = {0}, last[3] = {0}, image[3];
    double reach = radius + 0.5 * cells->coarsest;
    for (int axis = 0; axis < 3; axis++) {
        first[axis] = domain->periodic[axis] && at[axis] + reach > domain->max[axis] ? -1 : 0;
        last[axis] = domain->periodic[axis] && at[axis] - reach < domain->min[axis] ? 1 : 0;
    }
    for (image[0] = first[0]; image[0] <= last[0]; image[0]++)
        for (image[1] = first[1]; image[1] <= last[1]; image[1]++)
            for (image[2] = first[2]; image[2] <= last[2]; image[2]++) {
                double there[3];
                for (int axis = 0; axis < 3; axis++)
                    there[axis] = at[axis] + image[axis] * (domain->max[axis] - domain->min[axis]);
                if (overlaps(cells, there, radius)) return 1;
            }
    return 0;
}

static void enter(struct cells *cells, int k) {
    int level = 0;
    while (level < GRIDS - 1 && 2.0 * cells->radius[k] <= ldexp(cells->coarsest, -level - 1)) level++;
    if (level > cells->highest) cells->highest = level;
    double size = ldexp(cells->coarsest, -level);
    long cell[3];
    for (int axis = 0; axis < 3; axis++) cell[axis] = cell_of(cells->at[k][axis], size);
    size_t place = place_of(cells, level, cell);
    cells->next[k] = cells->place[place];
    cells->place[place] = k;
    cells->behind[k] = cells->spheres[level]++ ? cells->newest[level] : -1;
    cells->newest[level] = k;
}

static int compare_larger_first(const void *a, const void *b) {
    double first = *(const double *)a, second = *(const double *)b;
    return (first < second) - (first > second);
}

static double volume_of(double radius) { return 4.0 / 3.0 * 3.14159265358979323846 * radius * radius * radius; }

static scree_status place_all(scree_scene *scene, const scree_generate_def *def, struct cells *cells, double (*at)[3],
                              uint64_t *state) {
    double volume = 0.0, room = 1.0, all = 0.0;
    for (int axis = 0; axis < 3; axis++) room *= def->max[axis] - def->min[axis];
    for (int k = 0; k < def->count; k++) all += volume_of(cells->radius[k]);
    if (!(all < room))
        return scree_report(&scene->trouble, SCREE_BAD_INPUT, "count",
                            "\"%s\": %d spheres would fill %.3g of the box; put at random, spheres of one size fill "
                            "little more than 0.3",
                            def->name, def->count, all / room);
    for (int k = 0; k < def->count; k++) {
        double r = cells->radius[k];
        int tries = 0;
        do {
            for (int axis = 0; axis < 3; axis++)
                at[k][axis] = draw_between(state, def->min[axis] + r, def->max[axis] - r);
        } while (is_taken(cells, &scene->domain, at[k], r) && ++tries < TRIES);
        if (tries == TRIES)
            return scree_report(&scene->trouble, SCREE_BAD_INPUT, "count",
                                "\"%s\": only %d of %d spheres found room, which fill %.3g of the box; put at random, "
                                "spheres of one size fill little more than 0.3: take a larger box, or a lattice",
                                def->name, k, def->count, volume / room);
        volume += volume_of(r);
        enter(cells, k);
    }
    return SCREE_OK;
}

/* Whether a sphere, or one of its images, reaches into the box along an axis. */
static int reaches_in(const scree_domain_def *domain, const scree_generate_def *def, int axis, double x, double r) {
    double period = domain->periodic[axis] ? domain->max[axis] - domain->min[axis] : 0.0;
    for (int image = -1; image <= 1; image++)
        if (x + image * period + r > def->min[axis] && x + image * period - r < def->max[axis]) return 1;
    return 0;
}

/* Spheres that are there already and reach into the box, behind those of this definition; returns how many. */
static int find_others(const scree_scene *scene, const scree_generate_def *def, double (*at)[3], double *radius) {
    int found = 0;
    for (int k = 0; k < scene->defs; k++) {
        scree_body_def body = scree_scene_definition(scene, k);
        double r = body.shape.radius, *x = body.position;
        int inside = body.shape.kind == SCREE_SPHERE;
        for (int axis = 0; axis < 3; axis++) inside &= reaches_in(&scene->domain, def, axis, x[axis], r);
        if (!inside) continue;
        memcpy(at[def->count + found], x, sizeof *at);
        radius[def->count + found++] = r;
    }
    return found;
}

/* Both arrays have room for all spheres that are there already, too. */
static scree_status fill_random(scree_scene *scene, const scree_generate_def *def, double (*at)[3], double *radius) {
    uint64_t state = def->seed;
    int others = find_others(scene, def, at, radius);
    size_t places = 16, count = (size_t)def->count, all = count + (size_t)others;
    while (places < 2 * all) places *= 2;
    struct cells cells = {.last = places - 1, .at = (const double(*)[3])at, .radius = radius};
    cells.place = malloc(places * sizeof *cells.place);
    cells.next = malloc(2 * all * sizeof *cells.next);
    scree_status status = SCREE_OK;
    if (!cells.place || !cells.next)
        status = scree_report(&scene->trouble, SCREE_NO_MEMORY, NULL, "no memory for %d spheres", def->count);
    if (!status) cells.behind = cells.next + all;
    for (size_t k = 0; k < places && !status; k++) cells.place[k] = -1;
    for (size_t k = 0; k < count; k++) radius[k] = draw_radius(def, &state);
    qsort(radius, count, sizeof *radius, compare_larger_first);
    cells.coarsest = 2.0 * radius[0];
    for (size_t k = count; k < all; k++) cells.coarsest = fmax(cells.coarsest, 2.0 * radius[k]);
    for (size_t k = count; k < all && !status; k++) enter(&cells, (int)k);
    if (!status) status = place_all(scene, def, &cells, at, &state);
    free(cells.place);
    free(cells.next);
    return status;
}

/* ---- the whole ---- */

static scree_status add(scree_scene *scene, const scree_generate_def *def, int count, double (*at)[3],
                        const double *radius, int *first) {
    scree_spheres_def spheres = {.name = def->name,
                                 .material = def->material,
                                 .joint = def->joint,
                                 .count = count,
                                 .positions = (const double(*)[3])at,
                                 .radii = radius,
                                 .velocity = def->velocity};
    return scree_scene_add_spheres(scene, &spheres, first);
}

scree_status scree_scene_generate(scree_scene *scene, const scree_generate_def *def, int *first) {
    struct lattice lattice = {0.0, {1, 1, 1}};
    double wanted = def->count;
    scree_status status = check_definition(scene, def);
    if (!status && def->kind == SCREE_LATTICE) status = plan_lattice(scene, def, &lattice, &wanted);
    if (!status && wanted < 1.0)
        status =
            scree_report(&scene->trouble, SCREE_BAD_INPUT, "count", "\"%s\" needs the count of its spheres", def->name);
    if (!status) status = check_memory(scene, def, wanted);
    if (status) return status;
    int count = (int)wanted;
    size_t room = (size_t)count + (def->kind == SCREE_RANDOM ? (size_t)scene->defs : 0);
    double(*at)[3] = malloc(room * sizeof *at), *radius = malloc(room * sizeof *radius);
    if (!at || !radius)
        status = scree_report(&scene->trouble, SCREE_NO_MEMORY, NULL, "no memory for %d spheres", count);
    else if (def->kind == SCREE_LATTICE)
        fill_lattice(def, &lattice, count, at, radius);
    else
        status = fill_random(scene, def, at, radius);
    if (!status) status = add(scene, def, count, at, radius, first);
    free(at);
    free(radius);
    return status;
}
