/* The process model in the planner's loop: scenes that lack a part, products of other sizes, runs without end. */
#include "engine/cli/process.h"

#include "tests/check.h"

#include <unistd.h>

static const char scene_path[] = SCREE_DATA "/scenes/transport.toml";

static const scree_transport task = {.distance = 0.08,
                                     .gap = 0.05,
                                     .width = 0.03,
                                     .friction = 0.3,
                                     .gravity = 9.81,
                                     .share = 0.5,
                                     .fractions = {0.25, 0.5, 0.75}};

/* The scene with `before` (once) replaced by `after`, in a file whose name stays in `path`. */
static void write_changed(const char *before, const char *after, char path[64]) {
    static char text[1 << 16];
    FILE *from = fopen(scene_path, "rb");
    size_t size = from ? fread(text, 1, sizeof text - 1, from) : 0;
    if (from) fclose(from);
    text[size] = '\0';
    char *at = strstr(text, before);
    CHECK(at != NULL);
    snprintf(path, 64, "test_process_%d.toml", (int)getpid());
    FILE *to = fopen(path, "wb");
    CHECK(to != NULL);
    if (at && to) fprintf(to, "%.*s%s%s", (int)(at - text), text, after, at + strlen(before));
    if (to) fclose(to);
}

/* What is said about a scene with one thing changed. */
static scree_status judge(const char *before, const char *after, scree_trouble *trouble) {
    char path[64];
    struct process process;
    write_changed(before, after, path);
    scree_status status = process_load(&process, path, &task, trouble);
    if (!status) status = process_check(&process, trouble);
    process_free(&process);
    remove(path);
    return status;
}

static void test_lacking_parts(void) {
    static const char *const names[] = {"product",         "left surface",    "right surface",   "left rear tine",
                                        "right rear tine", "left front tine", "right front tine"};
    scree_trouble trouble = {0};
    for (size_t k = 0; k < sizeof names / sizeof names[0]; k++) {
        char before[64], wanted[64];
        snprintf(before, sizeof before, "[[body]]\nname = \"%s\"", names[k]);
        snprintf(wanted, sizeof wanted, "needs a body \"%s\"", names[k]);
        CHECK(judge(before, "[[body]]\nname = \"another\"", &trouble) == SCREE_BAD_INPUT);
        CONTAINS(trouble.text, wanted);
        CONTAINS(trouble.text, "test_process_");
    }
    CHECK(judge("name = \"lift\"", "name = \"up\"", &trouble) == SCREE_BAD_INPUT);
    CONTAINS(trouble.text, "needs a motion \"lift\"");
    CHECK(judge("between = [\"product\", \"front tine\"]", "between = [\"surface\", \"front tine\"]", &trouble) ==
          SCREE_BAD_INPUT);
    CONTAINS(trouble.text, "needs a contact between \"product\" and \"front tine\"");
    CHECK(judge("joint = { x = \"stroke\", z = \"lift\", others = \"fixed\" }", "joint = \"fixed\"", &trouble) ==
          SCREE_BAD_INPUT);
    CONTAINS(trouble.text, "the four tines must have the joint");
    CHECK(judge("[time]", "[tine]", &trouble) == SCREE_BAD_INPUT);
    CONTAINS(trouble.text, ":11:1: unknown key \"tine\"");
    CHECK(judge("title", "title", &trouble) == SCREE_OK);
}

static scree_plan plan_of(const scree_transport *t, double cycles, struct process *process) {
    scree_plan plan;
    scree_plan_options options = {.formulation = process ? SCREE_PLAN_C : SCREE_PLAN_B};
    if (process) options.process = process_catch;
    options.context = process;
    scree_plan_make(t, cycles, &options, &plan);
    return plan;
}

/* Contacts are found by what they are between, in whatever order. */
static void test_order(void) {
    char path[64];
    scree_trouble trouble;
    struct process process, swapped;
    scree_plan plan = plan_of(&task, 500.0, NULL);
    write_changed("between = [\"product\", \"surface\"]", "between = [\"rear tine\", \"product\"]", path);
    static char text[1 << 16];
    FILE *file = fopen(path, "r+b");
    size_t size = file ? fread(text, 1, sizeof text - 1, file) : 0;
    text[size] = '\0';
    char *second = strstr(text, "between = [\"product\", \"rear tine\"]");
    CHECK(second != NULL);
    if (second)
        memcpy(second, "between = [\"product\", \"surface\"]  ", strlen("between = [\"product\", \"rear tine\"]"));
    if (file) {
        rewind(file);
        fwrite(text, 1, size, file);
        fclose(file);
    }
    CHECK(process_load(&process, scene_path, &task, &trouble) == SCREE_OK);
    CHECK(process_load(&swapped, path, &task, &trouble) == SCREE_OK);
    scree_catch caught = {0}, other = {.clearance = 1.0, .velocity = 1.0, .acceleration = 1.0};
    CHECK(process_catch(&process, &plan.profile, plan.time[3], &caught) == 0);
    CHECK(process_catch(&swapped, &plan.profile, plan.time[3], &other) == 0);
    /* Forces are added up in another order: rounding of forces of up to 10 N over masses of 0.03 kg, twice integrated
     * over 45 ms. */
    NEAR(caught.clearance, other.clearance, 1e-13);
    NEAR(caught.velocity, other.velocity, 1e-11);
    process_free(&process);
    process_free(&swapped);
    remove(path);
}

/* Whatever its depth and height, the product is pushed by all four corners of a face and lies on the surfaces. */
static void test_sizes(void) {
    static const double depths[] = {0.05, 0.04, 0.008, 0.08}, heights[] = {0.012, 0.05, 0.002, 0.03};
    struct process process;
    scree_trouble trouble;
    CHECK(process_load(&process, scene_path, &task, &trouble) == SCREE_OK);
    process.step = 2e-6; /* within the stability limit of the deepest product, which yaws easily */
    scree_plan plan = plan_of(&task, 500.0, &process);
    struct process_run first = {.watch = NULL}, run = {.watch = NULL};
    CHECK(plan.state == SCREE_PLAN_GOOD);
    CHECK(process_simulate(&process, &plan.profile, task.distance, &first) == SCREE_OK);
    for (int k = 1; k < 4; k++) {
        process.depth = depths[k];
        process.height = heights[k];
        CHECK(process_check(&process, &trouble) == SCREE_OK);
        CHECK(process_simulate(&process, &plan.profile, task.distance, &run) == SCREE_OK);
        /* Friction below and tines above make the product pitch by some micrometres. */
        CLOSE(run.push_force, first.push_force, 0.02);
        CLOSE(run.catch_force, first.catch_force, 0.02);
        NEAR(run.error, 0.0, 2e-5);
    }
    process_free(&process);
}

/* A way longer than the surfaces of the scene file: they grow with it. */
static void test_long_way(void) {
    scree_transport t = task;
    struct process process;
    scree_trouble trouble;
    t.distance = 0.8;
    t.gap = 0.23;
    CHECK(process_load(&process, scene_path, &t, &trouble) == SCREE_OK);
    scree_plan plan = plan_of(&t, 120.0, &process);
    struct process_run run = {.watch = NULL};
    CHECK(plan.state == SCREE_PLAN_GOOD);
    CHECK(process_simulate(&process, &plan.profile, t.distance, &run) == SCREE_OK);
    NEAR(run.error, 0.0, 1e-4);
    process_free(&process);
}

/* The result of a run is that of a product at rest, however long it takes; and no run goes on for ever. */
static void test_rest(void) {
    struct process process;
    scree_trouble trouble;
    scree_plan plan = plan_of(&task, 500.0, NULL);
    struct process_run run = {.watch = NULL};
    CHECK(process_load(&process, scene_path, &task, &trouble) == SCREE_OK);
    process.step = 2e-5;
    process.threshold = 0.5; /* creeps to rest in some seconds: exp(-mu_s g t/threshold) from 0.1 m/s to 1e-9 m/s */
    CHECK(process_simulate(&process, &plan.profile, task.distance, &run) == SCREE_OK);
    process.step = 1e-12;
    CHECK(process_simulate(&process, &plan.profile, task.distance, &run) == SCREE_FAILED);
    CONTAINS(run.trouble.text, "more than 1000000000 steps");
    scree_catch caught;
    CHECK(process_catch(&process, &plan.profile, plan.time[3], &caught) != 0);
    CONTAINS(caught.cause, "more than 1000000000 steps");
    process.step = 1e-2;
    CHECK(process_catch(&process, &plan.profile, plan.time[3], &caught) != 0);
    CONTAINS(caught.cause, "stability limit");
    process.step = 2e-6;
    CHECK(process_catch(&process, &plan.profile, plan.time[3], &caught) == 0 && caught.cause[0] == '\0');
    process_free(&process);
}

int main(void) {
    test_lacking_parts();
    test_order();
    test_sizes();
    test_long_way();
    test_rest();
    return check_report();
}
