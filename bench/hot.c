/* scree-bench hot: the contact loop at scale, on settled beds of spheres, through the public functions. */
#include "bench/roofline.h"

#include "contact/loop.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const char help[] =
    "usage: scree-bench hot [--bodies N] [--threads N] [--steps N] [--repeats N] [--settle N] [--laws NAME]\n"
    "                       [--integrator NAME] [--write FILE] [--read FILE] [--tiles N] [--ratio N]\n"
    "\n"
    "Time a step of a settled bed: spheres of 1 mm radius, 2500 kg/m^3, E = 1e7 Pa, nu = 0.25, e = 0.6, mu = 0.5, "
    "within five walls,\n"
    "step 1e-5 s, 20 layers deep at 100000 (13 at 1000, 31 at 10000), poured from a lattice with jitter and settled "
    "for some steps. "
    "--laws mindlin (default):\n"
    "Hertz's spring, Tsuji's dashpot, Mindlin's friction with memory; linear: linear spring, Coulomb's friction with "
    "memory; plain: Hertz's\n"
    "spring alone. --integrator verlet (default) or pair-impulse. --write keeps the settled bed (positions, "
    "velocities, spins), --read takes it up again\n"
    "(and lets it settle for --settle steps), so that builds can be compared on one bed; --tiles "
    "lays it out N by N times within the walls (N*N*bodies spheres); --ratio puts "
    "spheres\n"
    "up to N times as large in the place of others, each size sqrt(10) times the next and a hundredth as often\n"
    "(those more than ten times as large weigh a thousandth, so that they crush nothing). "
    "Columns: processor's "
    "path (SCREE_ISA=baseline, avx2 or avx512 asks for one), laws, bodies, "
    "threads;\n"
    "nanoseconds per body and step, median of the repeats and least, and those of the contacts run alone; contacts "
    "that "
    "touch per\n"
    "body, and that are computed; nanoseconds per touching contact and step; near lists made during the repeats, and "
    "nanoseconds per\n"
    "body for each; the same for outer lists; bytes of memory per body (resident, all told but the program); of one "
    "contact in the\n"
    "loop alone, by Verlet on one thread: nanoseconds, instructions where the machine counts them, sums and products, "
    "bytes; nanoseconds\n"
    "that the machine takes at least for these (measured at best on the spot), for its quotients and roots, for its "
    "bytes from a field as\n"
    "large as the bed; how many times as long as the longest of these it takes; hash of the state.\n"
    "Unless given: --bodies 10000 --threads 1 --steps 100 --repeats 9 --settle 15000.\n"
    "\n"
    "example: scree-bench hot --bodies 10000 --steps 100 --repeats 9\n";

enum { MOST_REPEATS = 1000, WALLS = 5 };
static const double radius = 1e-3;

struct request {
    const char *laws, *write, *read;
    scree_integrator integrator;
    int bodies, threads, steps, repeats, settle, tiles, ratio;
};

struct bed {
    int bodies, side; /* spheres of a tile; along each edge of its floor */
    double edge;      /* of a tile's floor, m */
    int tiles;        /* along each edge */
};

/* The floor: 40 mm for 10000 spheres, 160 mm for 100000. */
static struct bed bed_of(int bodies, int tiles) {
    struct bed bed = {.bodies = bodies, .side = 9, .tiles = tiles};
    if (bodies > 5000) bed.side = 18;
    if (bodies > 50000) bed.side = 72;
    if (bodies > 500000) bed.side = (int)ceil(sqrt(bodies / 20.0));
    bed.edge = 2.2 * radius * bed.side + 0.4 * radius;
    return bed;
}

/* On a lattice of spacing 2.2 radii, with jitter. */
static void place_sphere(const struct bed *bed, int k, uint64_t *seed, double position[3]) {
    int at[3] = {k % bed->side, k / bed->side % bed->side, k / (bed->side * bed->side)};
    for (int axis = 0; axis < 3; axis++)
        position[axis] = (1.3 + 2.2 * at[axis] + 0.09 * (2.0 * bench_random(seed) - 1.0)) * radius;
}

static void check(scree_scene *scene, scree_status status) {
    if (!status) return;
    cli_complain("%s", scree_scene_trouble(scene)->text);
    exit(EXIT_MISSED);
}

static void add_wall(scree_scene *scene, const char *name, double x, double y, const double normal[3]) {
    scree_body_def def = {.name = name, .shape = {.kind = SCREE_PLANE}, .material = 0, .position = {x, y, 0.0}};
    /* The quaternion that turns +z to the normal. */
    double q[4] = {1.0 + normal[2], -normal[1], normal[0], 0.0};
    memcpy(def.orientation, q, sizeof q);
    for (int k = 0; k < 3; k++) def.joint.along[k] = SCREE_FIXED;
    def.joint.turn = SCREE_FIXED;
    check(scene, scree_scene_add_body(scene, &def, NULL));
}

static void add_laws(scree_scene *scene, const char *laws, int materials) {
    scree_contact_def contact = {.between = {0, 0}};
    scree_law_choice hertz = {"tsuji", 1, {{"restitution", 0.6}}};
    scree_law_choice mindlin = {"mindlin", 3, {{"static", 0.5}, {"kinetic", 0.5}, {"damping", 0.16}}};
    scree_law_choice linear = {"linear", 2, {{"stiffness", 1000.0}, {"restitution", 0.6}}};
    scree_law_choice coulomb = {"coulomb", 3, {{"static", 0.5}, {"kinetic", 0.5}, {"stiffness", 800.0}}};
    scree_law_choice plain = {"hertz", 0, {{0}}};
    contact.normal = hertz;
    contact.friction = mindlin;
    if (strcmp(laws, "linear") == 0) {
        contact.normal = linear;
        contact.friction = coulomb;
    }
    if (strcmp(laws, "plain") == 0) {
        contact.normal = plain;
        contact.friction.law = NULL;
    }
    for (int a = 0; a < materials; a++)
        for (int b = a; b < materials; b++) {
            contact.between[0] = a;
            contact.between[1] = b;
            check(scene, scree_scene_add_contact(scene, &contact));
        }
}

/* Position, velocity and spin of a sphere. */
struct stored {
    double position[3], velocity[3], spin[3];
};

static struct stored *read_bed(const char *name, int bodies) {
    FILE *file = fopen(name, "rb");
    if (!file) exit(cli_complain("%s can't be read", name));
    struct stored *stored = malloc((size_t)bodies * sizeof *stored);
    if (!stored || fread(stored, sizeof *stored, (size_t)bodies, file) != (size_t)bodies)
        exit(cli_complain("%s holds less than %d spheres", name, bodies));
    if (fgetc(file) != EOF)
        exit(cli_complain("%s holds more than %d spheres: say how many with --bodies", name, bodies));
    fclose(file);
    return stored;
}

/* The spheres of all tiles; as in a tile that was read if there is one. */
static struct bench_spheres lay_out(const struct bed *bed, const struct stored *start) {
    struct bench_spheres spheres = bench_make_spheres(bed->bodies * bed->tiles * bed->tiles);
    uint64_t seed = 1;
    for (int k = 0; k < spheres.count; k++) {
        int tile = k / bed->bodies, own = k % bed->bodies;
        place_sphere(bed, own, &seed, spheres.position[k]);
        if (start) {
            memcpy(spheres.position[k], start[own].position, sizeof *spheres.position);
            memcpy(spheres.velocity[k], start[own].velocity, sizeof *spheres.velocity);
            memcpy(spheres.spin[k], start[own].spin, sizeof *spheres.spin);
        }
        spheres.position[k][0] += tile % bed->tiles * bed->edge;
        spheres.position[k][1] += tile / bed->tiles * bed->edge;
        spheres.radius[k] = radius;
    }
    return spheres;
}

static void add_some(scree_scene *scene, const struct bench_spheres *all, int first, int count, int material) {
    scree_spheres_def def = {.name = material ? "light" : "s", .count = count, .material = material};
    def.positions = (const double(*)[3])(all->position + first);
    def.velocities = (const double(*)[3])(all->velocity + first);
    def.spins = (const double(*)[3])(all->spin + first);
    def.radii = all->radius + first;
    check(scene, scree_scene_add_spheres(scene, &def, NULL));
}

/* Spheres so large that they would crush the others are light; they come first. */
static void add_spheres(scree_scene *scene, const struct bed *bed, int ratio, const struct stored *start) {
    struct bench_spheres spheres = lay_out(bed, start);
    if (ratio > 1) {
        struct bench_spheres mixed = bench_mix_sizes(&spheres, bed->tiles * bed->edge, ratio);
        bench_free_spheres(&spheres);
        spheres = mixed;
    }
    int light = 0;
    while (light < spheres.count && spheres.radius[light] > 11.0 * radius) light++;
    if (light > 0) add_some(scene, &spheres, 0, light, 1);
    add_some(scene, &spheres, light, spheres.count - light, 0);
    bench_free_spheres(&spheres);
}

/* A bed as it begins. */
static scree_scene *make_bed(const struct bed *bed, const struct request *request, const struct stored *start) {
    scree_scene *scene = scree_scene_create();
    if (!scene) exit(EXIT_MISSED);
    scree_material_def glass = {.name = "glass", .density = 2500.0, .young = 1e7, .poisson = 0.25};
    scree_material_def light = {.name = "light", .density = 2.5, .young = 1e7, .poisson = 0.25};
    scree_gravity_def gravity = {.vector = {0.0, 0.0, -9.81}};
    scree_time_def time = {.step = 1e-5, .threads = request->threads, .speed = 0.5, .integrator = request->integrator};
    double edge = bed->tiles * bed->edge;
    check(scene, scree_scene_add_material(scene, &glass, NULL));
    if (request->ratio > 10) check(scene, scree_scene_add_material(scene, &light, NULL));
    check(scene, scree_scene_set_gravity(scene, &gravity));
    check(scene, scree_scene_set_time(scene, &time));
    add_laws(scene, request->laws, request->ratio > 10 ? 2 : 1);
    add_wall(scene, "floor", 0.0, 0.0, (double[]){0.0, 0.0, 1.0});
    add_wall(scene, "west", 0.0, 0.0, (double[]){1.0, 0.0, 0.0});
    add_wall(scene, "east", edge, 0.0, (double[]){-1.0, 0.0, 0.0});
    add_wall(scene, "south", 0.0, 0.0, (double[]){0.0, 1.0, 0.0});
    add_wall(scene, "north", 0.0, edge, (double[]){0.0, -1.0, 0.0});
    add_spheres(scene, bed, request->ratio, start);
    check(scene, scree_scene_bake(scene));
    return scene;
}

static void write_bed(const scree_scene *scene, const char *name) {
    FILE *file = fopen(name, "wb");
    int failed = !file;
    for (int k = WALLS; k < scree_scene_bodies(scene) && !failed; k++) {
        scree_body_state state = scree_scene_body(scene, k);
        failed |= fwrite(state.position, sizeof state.position, 1, file) != 1;
        failed |= fwrite(state.velocity, sizeof state.velocity, 1, file) != 1;
        failed |= fwrite(state.spin, sizeof state.spin, 1, file) != 1;
    }
    if (file) failed |= fclose(file) != 0;
    if (failed) exit(cli_complain("%s can't be written", name));
}

/* Bytes of this process that lie in memory, without those of files, which are the program and its libraries. */
static double resident(void) {
    long pages = 0, of_files = 0, ignored;
    FILE *file = fopen("/proc/self/statm", "r");
    if (file && fscanf(file, "%ld %ld %ld", &ignored, &pages, &of_files) != 3) pages = of_files = 0;
    if (file) fclose(file);
    return (double)(pages - of_files) * (double)sysconf(_SC_PAGESIZE);
}

/* Nanoseconds per body of stages run alone, on the scene as it is at the end: contacts, a near list, an outer list with
 * its near list. What is left of a step is the moving of bodies. */
struct stages {
    double contacts, near, outer;
    double instructions; /* per body, of the contacts; negative: unknown */
};

static struct stages time_stages(scree_scene *scene, int bodies, int threads, int steps) {
    struct stages stages;
    bench_count_on();
    double start = bench_now();
    for (int k = 0; k < steps; k++) scree_contacts_act(&scene->contacts, &scene->bodies, scene->step, threads, NULL);
    stages.contacts = (bench_now() - start) / ((double)steps * bodies) * 1e9;
    stages.instructions = bench_counted() / ((double)steps * bodies);
    start = bench_now();
    check(scene, scree_contacts_pick(&scene->contacts, &scene->bodies, threads, NULL));
    stages.near = (bench_now() - start) / bodies * 1e9;
    start = bench_now();
    check(scene, scree_contacts_list(&scene->contacts, &scene->bodies, threads, NULL));
    stages.outer = (bench_now() - start) / bodies * 1e9;
    return stages;
}

/* Contacts that touch, at the instant of the records: without the copy of these that measuring takes otherwise. */
static int count_touching(const scree_scene *scene) {
    const struct scree_contacts *contacts = &scene->contacts;
    struct scree_touch touch;
    int count = 0;
    for (int b = 0; b < contacts->batches; b++)
        for (int k = scree_first(&contacts->batch[b]); k >= 0; k = scree_next(&contacts->batch[b], k))
            count += scree_contacts_measure(contacts, &scene->bodies, b, k, &touch);
    return count;
}

/* A contact in the loop alone beside what the machine can do; empty fields where that isn't known. */
static void print_roofline(const scree_scene *scene, const struct request *request, const struct stages *stages,
                           double listed) {
    struct bench_work work = bench_contact_work(scene, request->laws, listed);
    if (!work.flops || request->threads > 1 || request->integrator != SCREE_VERLET) {
        printf(",,,,,,,,");
        return;
    }
    double bytes = work.bytes * listed * (scree_scene_bodies(scene) - WALLS), time = stages->contacts / listed;
    struct bench_limit limit = bench_limit_of(work, scene->contacts.loop->name, bytes);
    printf("%.2f,", time);
    if (stages->instructions >= 0.0) printf("%.0f", stages->instructions / listed);
    printf(",%d,%.0f,%.2f,%.2f,%.2f,%.2f,", work.flops, work.bytes, limit.arithmetic, limit.divider, limit.memory,
           time / limit.least);
}

static void run(const struct request *request) {
    static double times[MOST_REPEATS];
    struct bed bed = bed_of(request->bodies, request->tiles);
    double before = resident();
    struct stored *start = request->read ? read_bed(request->read, request->bodies) : NULL;
    scree_scene *scene = make_bed(&bed, request, start);
    free(start);
    int bodies = scree_scene_bodies(scene) - WALLS;
    bench_describe_machine();
    printf("isa,laws,bodies,threads,body_step_ns,least_ns,contacts_alone_ns,contacts_per_body,listed_per_body,"
           "contact_step_ns,near_lists,near_list_ns,outer_lists,outer_list_ns,bytes_per_body,"
           "contact_ns,instructions,flops,bytes,flops_ns,divider_ns,bytes_ns,over_limit,hash\n");
    fflush(stdout);
    bench_step(scene, request->settle);
    if (request->write) write_bed(scene, request->write);
    long lists = scene->contacts.rebuilds, renewals = scene->contacts.renewals, listed = 0;
    for (int r = 0; r < request->repeats; r++) {
        double from = bench_now();
        bench_step(scene, request->steps);
        times[r] = (bench_now() - from) / ((double)request->steps * bodies) * 1e9;
    }
    lists = scene->contacts.rebuilds - lists;
    renewals = scene->contacts.renewals - renewals;
    for (int b = 0; b < scene->contacts.batches; b++) listed += scene->contacts.batch[b].count;
    double bytes = (resident() - before) / bodies;
    int touching = count_touching(scene);
    double median = bench_median(times, request->repeats), contacts = (double)touching / bodies;
    uint64_t hash = scree_scene_hash(scene);
    struct stages stages = time_stages(scene, bodies, request->threads, request->steps);
    printf("%s,%s,%d,%d,%.2f,%.2f,%.2f,%.3f,%.3f,", scene->contacts.loop->name, request->laws, bodies, request->threads,
           median, times[0], stages.contacts, contacts, (double)listed / bodies);
    if (touching) printf("%.2f", median / contacts);
    printf(",%ld,%.1f,%ld,%.0f,%.0f,", renewals, stages.near, lists, stages.outer, bytes);
    print_roofline(scene, request, &stages, (double)listed / bodies);
    printf("%016llx\n", (unsigned long long)hash);
    scree_scene_destroy(scene);
}

int bench_hot(int count, char **words) {
    const char *integrator = "verlet", *bodies = "10000", *threads = "1", *steps = "100", *repeats = "9",
               *settle = "15000", *tiles = "1", *ratio = "1";
    struct request request = {.laws = "mindlin", .integrator = SCREE_VERLET};
    const struct cli_option options[] = {
        {.name = "--bodies", .value = &bodies},         {.name = "--threads", .value = &threads},
        {.name = "--steps", .value = &steps},           {.name = "--repeats", .value = &repeats},
        {.name = "--settle", .value = &settle},         {.name = "--laws", .value = &request.laws},
        {.name = "--integrator", .value = &integrator}, {.name = "--write", .value = &request.write},
        {.name = "--read", .value = &request.read},     {.name = "--tiles", .value = &tiles},
        {.name = "--ratio", .value = &ratio},           {0}};
    int code = bench_parse(count, words, options, help);
    if (code) return code < 0 ? EXIT_GOOD : code;
    if (strcmp(integrator, "pair-impulse") == 0)
        request.integrator = SCREE_PAIR_IMPULSE;
    else if (strcmp(integrator, "verlet") != 0)
        return cli_complain("--integrator is verlet or pair-impulse, not \"%s\"", integrator);
    if (strcmp(request.laws, "mindlin") != 0 && strcmp(request.laws, "linear") != 0 &&
        strcmp(request.laws, "plain") != 0)
        return cli_complain("--laws is mindlin, linear or plain, not \"%s\"", request.laws);
    request.bodies = cli_whole_number(bodies, "--bodies", 10000000);
    request.threads = cli_whole_number(threads, "--threads", 1024);
    request.steps = cli_whole_number(steps, "--steps", 100000000);
    request.repeats = cli_whole_number(repeats, "--repeats", MOST_REPEATS);
    request.settle = cli_whole_number(settle, "--settle", 100000000);
    request.tiles = cli_whole_number(tiles, "--tiles", 30);
    request.ratio = cli_whole_number(ratio, "--ratio", 1000);
    if (request.ratio > 1 && !request.read) return cli_complain("--ratio takes a settled bed: --read FILE");
    if (!request.bodies || !request.tiles || !request.threads || !request.steps || !request.repeats ||
        !request.settle || !request.ratio)
        return EXIT_USAGE;
    run(&request);
    return EXIT_GOOD;
}
