/* Many spheres at once, from a table or from a generator; and the domain that they are in. */
#include "engine/scene_reader.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static scree_scene *scene_of(struct scree_reader *r) { return ((struct scree_scene_target *)r->into)->scene; }

/* ---- from a table ---- */

/* The columns that a table of spheres may have: with their unit, or without. */
enum { X, Y, Z, RADIUS, MASS, VX, VY, VZ, WX, WY, WZ, NAME, MATERIAL, COLUMNS };

static const struct scree_column columns[COLUMNS] = {
    {{"x_m", "x"}},       {{"y_m", "y"}},     {{"z_m", "z"}},     {{"radius_m", "radius"}}, {{"mass_kg", "mass"}},
    {{"vx_m_s", "vx"}},   {{"vy_m_s", "vy"}}, {{"vz_m_s", "vz"}}, {{"wx_rad_s", "wx"}},     {{"wy_rad_s", "wy"}},
    {{"wz_rad_s", "wz"}}, {{"name", "body"}}, {{"material"}}};

/* A table of spheres while it is read. */
struct bed {
    struct scree_table table;
    char *path, *text;
    int at[COLUMNS]; /* the table's column; -1: none */
    double (*position)[3], (*velocity)[3], (*spin)[3];
    int *material; /* of each row */
};

static void find_columns(struct scree_reader *r, struct bed *bed) {
    const struct scree_table *table = &bed->table;
    scree_find_columns(r, bed->path, table, columns, COLUMNS,
                       "a table of spheres: it has x_m, y_m, z_m and, if wanted, radius_m, mass_kg, vx_m_s …, "
                       "wx_rad_s …, name and material",
                       bed->at);
    for (int c = X; c <= Z && !r->status; c++)
        if (bed->at[c] < 0)
            scree_complain_in_table(r, bed->path, table->header, 1, "the table needs the column %s",
                                    columns[c].names[0]);
    for (int c = VX; c <= WZ && !r->status; c++) {
        int first = c < WX ? VX : WX;
        if ((bed->at[c] < 0) != (bed->at[first] < 0))
            scree_complain_in_table(r, bed->path, table->header, 1, "of %s, %s, %s the table needs all or none",
                                    columns[first].names[0], columns[first + 1].names[0], columns[first + 2].names[0]);
    }
    if (!r->status && table->rows < 1) scree_complain_in_table(r, bed->path, 0, 0, "this table has no rows");
}

/* Something that the table says row by row, or the scene file once for all. */
static void check_once(struct scree_reader *r, const struct scree_toml *table, const struct bed *bed, int column,
                       const char *key) {
    const struct scree_toml *node = scree_toml_get(table, key);
    if (bed->at[column] >= 0 && node)
        scree_complain(r, node, "the table %s has a column %s already", bed->path, columns[column].names[0]);
    if (bed->at[column] < 0 && !node)
        scree_complain(r, table, "these spheres need %s = …, or a column %s in %s", key, columns[column].names[0],
                       bed->path);
}

/* Three columns as vectors; NULL if there are none, or no memory (which is reported). */
static double (*gather(struct scree_reader *r, const struct bed *bed, int first))[3] {
    if (bed->at[first] < 0 || r->status) return NULL;
    double(*vectors)[3] = malloc(bed->table.rows * sizeof *vectors);
    if (!vectors) {
        r->status = scree_report(r->trouble, SCREE_NO_MEMORY, NULL, "no memory for %zu spheres", bed->table.rows);
        return NULL;
    }
    for (int axis = 0; axis < 3; axis++) {
        const double *column = bed->table.column[bed->at[first + axis]];
        for (size_t k = 0; k < bed->table.rows; k++) vectors[k][axis] = column[k];
    }
    return vectors;
}

/* The material of a row; the names of neighbours are mostly the same. */
static int material_of(struct scree_reader *r, const struct bed *bed, size_t row) {
    char **word = bed->table.word[bed->at[MATERIAL]];
    if (row > 0 && strcmp(word[row], word[row - 1]) == 0) return bed->material[row - 1];
    int found = scree_scene_find_material(scene_of(r), word[row]);
    const struct scree_table_row *at = &bed->table.row[row];
    if (found < 0)
        scree_complain_in_table(r, bed->path, at->line, (int)(word[row] - at->begins) + 1,
                                "there is no material called \"%s\"%s", word[row],
                                scree_hint_of(r, "material", word[row]).text);
    return found;
}

static void read_materials(struct scree_reader *r, struct bed *bed, const scree_spheres_def *def) {
    bed->material = malloc(bed->table.rows * sizeof *bed->material);
    if (!bed->material)
        r->status = scree_report(r->trouble, SCREE_NO_MEMORY, NULL, "no memory for %zu spheres", bed->table.rows);
    for (size_t k = 0; k < bed->table.rows && !r->status; k++)
        bed->material[k] = bed->at[MATERIAL] < 0 ? def->material : material_of(r, bed, k);
}

/* One group of spheres for each run of rows of one material. */
static void add_runs(struct scree_reader *r, const struct bed *bed, const scree_spheres_def *all,
                     const struct scree_toml *table) {
    for (int first = 0, next; first < (int)bed->table.rows && !r->status; first = next) {
        scree_spheres_def def = *all;
        for (next = first + 1; next < (int)bed->table.rows && bed->material[next] == bed->material[first];) next++;
        def.material = bed->material[first];
        def.first_number = first + 1;
        def.count = next - first;
        def.positions += first;
        if (def.radii) def.radii += first;
        if (def.masses) def.masses += first;
        if (def.velocities) def.velocities += first;
        if (def.spins) def.spins += first;
        if (def.names) def.names += first;
        scree_status status = scree_scene_add_spheres(scene_of(r), &def, NULL);
        const scree_trouble *cause = scree_scene_trouble(scene_of(r));
        if (status == SCREE_BAD_INPUT && cause->body >= 0)
            scree_complain_in_table(r, bed->path, bed->table.row[first + cause->body].line, 1, "%s", cause->text);
        scree_pass_on(r, status, table);
    }
}

static void add_bed(struct scree_reader *r, const struct scree_toml *table, struct bed *bed) {
    scree_spheres_def def = {.name = "sphere", .count = (int)bed->table.rows};
    const char *name = scree_read_string(r, table, "name");
    const struct scree_toml *material = scree_toml_get(table, "material");
    if (name) def.name = name;
    if (name && bed->at[NAME] >= 0)
        scree_complain(r, scree_toml_get(table, "name"), "the table %s has a column of names already", bed->path);
    if (bed->table.rows > 2000000000)
        scree_complain(r, table, "%zu spheres are more than a scene can have", bed->table.rows);
    check_once(r, table, bed, RADIUS, "radius");
    check_once(r, table, bed, MATERIAL, "material");
    if (!r->status && material) def.material = scree_find_named(r, material, "material", scree_scene_find_material);
    def.radius = scree_read_number(r, table, "radius", 0.0);
    scree_read_joint(r, table, &def.joint);
    bed->position = gather(r, bed, X);
    bed->velocity = gather(r, bed, VX);
    bed->spin = gather(r, bed, WX);
    def.positions = (const double(*)[3])bed->position;
    def.velocities = (const double(*)[3])bed->velocity;
    def.spins = (const double(*)[3])bed->spin;
    def.radii = scree_table_column(&bed->table, bed->at[RADIUS]);
    def.masses = scree_table_column(&bed->table, bed->at[MASS]);
    if (bed->at[NAME] >= 0) def.names = (const char *const *)bed->table.word[bed->at[NAME]];
    if (!r->status) read_materials(r, bed, &def);
    if (!r->status) add_runs(r, bed, &def, table);
}

void scree_read_spheres(struct scree_reader *r, const struct scree_toml *table) {
    static const char *const keys[] = {"name", "file", "material", "radius", "joint", NULL};
    static const char *const words[] = {"name", "body", "material", NULL};
    scree_check_keys(r, table, "[[spheres]]", keys);
    struct bed bed = {.path = NULL};
    const struct scree_toml *file = scree_toml_get(table, "file");
    if (!file || !scree_read_string(r, table, "file"))
        scree_complain(r, table, "[[spheres]] needs file = \"….csv\" with the columns x_m, y_m, z_m");
    if (!r->status) bed.path = scree_read_word_file(r, file, words, &bed.table, &bed.text);
    if (bed.path) find_columns(r, &bed);
    if (!r->status) add_bed(r, table, &bed);
    scree_table_free(&bed.table);
    free(bed.path);
    free(bed.text);
    free(bed.position);
    free(bed.velocity);
    free(bed.spin);
    free(bed.material);
}

/* ---- from a generator ---- */

/* radius = r or [least, largest] */
static void read_radius(struct scree_reader *r, const struct scree_toml *table, scree_generate_def *def) {
    const struct scree_toml *node = scree_toml_get(table, "radius");
    if (!node)
        scree_complain(r, table, "spheres need a radius = r, or radius = [least, largest]");
    else if (node->type == SCREE_TOML_ARRAY)
        scree_read_numbers(r, table, "radius", 2, def->radius);
    else
        def->radius[0] = scree_number_of(r, node, "radius");
}

void scree_read_generate(struct scree_reader *r, const struct scree_toml *table) {
    static const char *const common[] = {"name", "kind",  "material",     "joint",    "min",     "max",    "radius",
                                         "seed", "count", "distribution", "velocity", "spacing", "jitter", NULL};
    static const char *const kinds[] = {"lattice", "random", NULL}, *const spreads[] = {"uniform", "mass", NULL};
    scree_check_keys(r, table, "[[generate]]", common);
    const struct scree_toml *kind = scree_toml_get(table, "kind"), *material = scree_toml_get(table, "material");
    const struct scree_toml *spread = scree_toml_get(table, "distribution");
    if (!kind) scree_complain(r, table, "[[generate]] needs a kind: \"lattice\" or \"random\"");
    if (!material) scree_complain(r, table, "[[generate]] needs a material");
    if (r->status) return;
    scree_generate_def def = {.name = scree_read_string(r, table, "name"),
                              .kind = (scree_generator)scree_choose(r, kind, "kind", kinds),
                              .spacing = scree_read_positive(r, table, "spacing", " m"),
                              .jitter = scree_read_number(r, table, "jitter", 0.0)};
    def.material = scree_find_named(r, material, "material", scree_scene_find_material);
    for (int k = 0; common[k] && !r->status && def.kind == SCREE_RANDOM; k++)
        if ((strcmp(common[k], "spacing") == 0 || strcmp(common[k], "jitter") == 0) && scree_toml_get(table, common[k]))
            scree_complain(r, scree_toml_get(table, common[k]), "only a lattice has %s", common[k]);
    if (!scree_read_numbers(r, table, "min", 3, def.min) || !scree_read_numbers(r, table, "max", 3, def.max))
        scree_complain(r, table, "[[generate]] needs the corners of its box: min = [x, y, z] and max = [x, y, z]");
    read_radius(r, table, &def);
    if (spread) def.radii = (scree_radii)scree_choose(r, spread, "distribution", spreads);
    if (spread && (def.radius[1] == 0.0 || def.radius[1] == def.radius[0]))
        scree_complain(r, spread, "a distribution needs two radii: radius = [least, largest]");
    def.count = (int)scree_read_whole(r, table, "count", 1.0, 2147483647.0);
    def.seed = (uint64_t)scree_read_whole(r, table, "seed", 0.0, 9007199254740992.0);
    scree_read_numbers(r, table, "velocity", 3, def.velocity);
    scree_read_joint(r, table, &def.joint);
    if (!r->status) scree_pass_on(r, scree_scene_generate(scene_of(r), &def, NULL), table);
}

/* ---- the domain ---- */

void scree_read_domain(struct scree_reader *r) {
    static const char *const keys[] = {"min", "max", "periodic", NULL}, *const axes[] = {"x", "y", "z", NULL};
    const struct scree_toml *table = scree_read_table(r, r->root, "domain");
    if (!table) return;
    scree_domain_def def = {.periodic = {0}};
    const struct scree_toml *periodic = scree_toml_get(table, "periodic");
    scree_check_keys(r, table, "[domain]", keys);
    if (!scree_read_numbers(r, table, "min", 3, def.min) || !scree_read_numbers(r, table, "max", 3, def.max))
        scree_complain(r, table, "[domain] needs its corners: min = [x, y, z] and max = [x, y, z]");
    if (periodic && periodic->type != SCREE_TOML_ARRAY)
        scree_complain(r, periodic, "periodic must be an array of axes, such as [\"x\", \"y\"]");
    for (const struct scree_toml *axis = periodic ? periodic->first : NULL; axis && !r->status; axis = axis->next)
        def.periodic[scree_choose(r, axis, "an axis", axes)] = 1;
    if (!r->status) scree_pass_on(r, scree_scene_set_domain(scene_of(r), &def), table);
}
