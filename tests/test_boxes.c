/* Boxes: the collider against an oracle, energy of impacts, and boxes that stand, slide, tip and fall. */
#include "bodies/quat.h"
#include "tests/boxes_oracle.h"
#include "tests/scenes.h"

/* ---- the collider ---- */

static void judge_boxes(long pairs, double roundness, double deepest) {
    uint64_t seed = 12345;
    struct oracle_count count = {0};
    for (long k = 0; k < pairs; k++) oracle_try_boxes(&seed, roundness, deepest, &count);
    /* Rounding: some 1e-16 of the coordinates, times the ratio of a box's edges, 20. */
    CHECK(count.phantoms == 0 && count.missed == 0 && count.deeper == 0);
    CHECK(count.touching > pairs / 2 && count.edges > pairs / 10);
}

static void test_collider(void) {
    judge_boxes(60000, 0.2, 0.95); /* up to nearly all of the roundings */
    judge_boxes(20000, 1.0, 0.95);
    judge_boxes(20000, 0.02, 0.95);
    judge_boxes(30000, 0.2, 0.0); /* up to half-way in */
    judge_boxes(60000, 0.0, 0.0);
    uint64_t seed = 54321;
    struct oracle_count count = {0};
    for (long k = 0; k < 100000; k++) oracle_try_sphere(&seed, &count);
    CHECK(count.phantoms == 0 && count.missed == 0 && count.deeper == 0);
    CHECK(count.touching > 50000);
}

int main(void) {
    test_collider();
    return check_report();
}
