/* The order of bodies in memory: sorted in space, so that what touches lies near to each other, and so that contacts
 * can be worked off slab by slab. Everything here is a function of the state, so that it doesn't matter when or how
 * often it is looked at. */
#include "bodies/bodies.h"

#include <math.h>
#include <string.h>

enum { FEW = 16, PER_SLAB = 128 }; /* below so many members bodies aren't sorted; members of a slab at least */

/* Slabs are some layers thick, so that few partners lie in the next one: the others lie in the next row, and are at
 * hand still when their turn comes. But so many slabs at least, for threads to share, if they can be had. */
enum { LEAST_SLABS = 12 };
static const double layers_of_slab = 3.5, least_layers = 1.5;

static const double largest = 4.0; /* balls larger than this many mean radii are no members */

static double mean_radius(const struct scree_bodies *bodies) {
    double sum = 0.0;
    int count = 0;
    for (int k = 0; k < bodies->count; k++) { /* by numbers: the sum mustn't depend on the order */
        int place = bodies->place[k];
        if (scree_kind_of(bodies, place)->shape.kind != SCREE_SPHERE || bodies->class[place] == SCREE_CLASS_GENERAL)
            continue;
        sum += bodies->record[place].radius;
        count++;
    }
    return count ? sum / count : 0.0;
}

static int is_member(const struct scree_bodies *bodies, int k, double mean) {
    return scree_kind_of(bodies, k)->shape.kind == SCREE_SPHERE && bodies->class[k] != SCREE_CLASS_GENERAL &&
           bodies->record[k].radius <= largest * mean;
}

/* The bounds of the members; returns how many there are. */
static int measure(const struct scree_bodies *bodies, double mean, double low[3], double high[3], double *radius) {
    int count = 0;
    *radius = 0.0;
    for (int axis = 0; axis < 3; axis++) low[axis] = HUGE_VAL, high[axis] = -HUGE_VAL;
    for (int k = 0; k < bodies->count; k++) {
        if (!is_member(bodies, k, mean)) continue;
        for (int axis = 0; axis < 3; axis++) {
            low[axis] = fmin(low[axis], bodies->position[k][axis]);
            high[axis] = fmax(high[axis], bodies->position[k][axis]);
        }
        *radius = fmax(*radius, bodies->record[k].radius);
        count++;
    }
    return count;
}

static uint64_t cell(double x, double low, double width, double most) {
    return (uint64_t)fmax(fmin(floor((x - low) / width), most), 0.0);
}

/* Members in thin slices across an axis; those beyond a bound are in the last slice before it. */
enum { SLICES = 1024 };
static void count_slices(const struct scree_bodies *bodies, double mean, int axis, double low, double high,
                         int in[SLICES]) {
    memset(in, 0, SLICES * sizeof *in);
    for (int k = 0; k < bodies->count; k++)
        if (is_member(bodies, k, mean)) in[cell(bodies->position[k][axis], low, (high - low) / SLICES, SLICES - 1)]++;
}

/* Few that are far off all others, say fallen from a table's edge, don't count: bounds without the outermost members at
 * each end, one in FAR, where these take more than half of the way; and so on. */
static void leave_out(const struct scree_bodies *bodies, double mean, int members, int axis, double *low,
                      double *high) {
    enum { FAR = 128, TIMES = 8 };
    int in[SLICES];
    for (int time = 0; time < TIMES; time++) {
        double thickness = (*high - *low) / SLICES;
        int first = 0, last = SLICES - 1, below = 0, above = 0;
        count_slices(bodies, mean, axis, *low, *high, in);
        while (below + in[first] <= members / FAR) below += in[first++];
        while (above + in[last] <= members / FAR) above += in[last--];
        if (last + 1 - first > SLICES / 2) return;
        *high = *low + (last + 1) * thickness;
        *low += first * thickness;
    }
}

/* Where slabs end: where each has its share of the members; but none is thinner than `least`. So threads have as much
 * to do, wherever bodies lie. */
static void divide(const struct scree_bodies *bodies, double mean, int members, double high, double least,
                   struct scree_order *order) {
    int in[SLICES], axis = order->axis[0], slabs = order->slabs, slice = 0, before = 0;
    double low = order->low[axis], thickness = (high - low) / SLICES, end = low;
    count_slices(bodies, mean, axis, low, high, in);
    for (int slab = 0; slab < slabs - 1; slab++) {
        double share = (double)members * (slab + 1) / slabs;
        while (slice < SLICES && before + 0.5 * in[slice] < share) before += in[slice++];
        end = fmax(low + slice * thickness, end + least);
        end = fmin(end, high - (slabs - 1 - slab) * least);
        order->end[slab] = end;
    }
}

/* Axes, widths of rows, and slabs: none where members are few. */
static struct scree_order frame(const struct scree_bodies *bodies, double mean, double range) {
    struct scree_order order = {.slabs = 0};
    double high[3], extent[3], radius;
    int count = measure(bodies, mean, order.low, high, &radius);
    if (count < FEW) return order;
    for (int axis = 0; axis < 3; axis++) {
        if (!isfinite(high[axis] - order.low[axis])) return order;
        leave_out(bodies, mean, count, axis, &order.low[axis], &high[axis]);
        extent[axis] = high[axis] - order.low[axis];
    }
    int longest = extent[1] > extent[0] ? 1 : 0;
    if (extent[2] > extent[longest]) longest = 2;
    order.axis[0] = longest;
    order.axis[1] = longest == 0 ? 1 : 0; /* rows stand upright where they can */
    order.axis[2] = longest == 2 ? 1 : 2;
    double reach = 2.0 * radius + range, layers = extent[longest] / reach;
    double slabs = fmin(floor(layers / least_layers), fmax(floor(layers / layers_of_slab), LEAST_SLABS));
    order.slabs = (int)fmin(fmin(slabs, count / PER_SLAB), SCREE_SLABS);
    if (order.slabs < 2) order.slabs = 1;
    order.width[1] = order.width[2] = 2.0 * mean;
    if (order.slabs > 1) divide(bodies, mean, count, high[longest], least_layers * reach, &order);
    return order;
}

/* Slab, row, place in the row, as one number that orders; 0 for bodies that are no members. */
static uint64_t key_of(const struct scree_bodies *bodies, int k, const struct scree_order *order) {
    const double *x = bodies->position[k];
    int a = order->axis[0], b = order->axis[1], c = order->axis[2];
    uint64_t slab = 0;
    for (int s = 0; s < order->slabs - 1; s++) slab += order->end[s] <= x[a];
    uint64_t row = cell(x[b], order->low[b], order->width[1], 4095.0);
    return ((slab + 1) << 24) | (row << 12) | cell(x[c], order->low[c], order->width[2], 4095.0);
}

/* Heap sort: in place, and the same time whatever comes. */
static void sift(uint64_t *key, size_t root, size_t count) {
    uint64_t value = key[root];
    for (size_t child = 2 * root + 1; child < count; root = child, child = 2 * root + 1) {
        if (child + 1 < count && key[child + 1] > key[child]) child++;
        if (key[child] <= value) break;
        key[root] = key[child];
        key[child] = value;
    }
}

static void sort(uint64_t *key, size_t count) {
    for (size_t k = count / 2; k-- > 0;) sift(key, k, count);
    for (size_t last = count; last-- > 1;) {
        uint64_t value = key[0];
        key[0] = key[last];
        key[last] = value;
        sift(key, 0, last);
    }
}

void scree_bodies_sort(struct scree_bodies *bodies, double range, uint64_t *key, int *from) {
    double mean = mean_radius(bodies);
    struct scree_order order = frame(bodies, mean, range);
    if (order.slabs == 0 && bodies->order.slabs == 0) return;
    for (int k = 0; k < bodies->count; k++) {
        uint64_t where = order.slabs && is_member(bodies, k, mean) ? key_of(bodies, k, &order) : 0;
        /* Members keep the order that they have where space doesn't tell; the others are in that of their numbers. */
        key[k] = where << 32 | (uint64_t)(where ? k : bodies->number[k]);
    }
    sort(key, (size_t)bodies->count);
    int slab = -1;
    for (int k = 0; k < bodies->count; k++) {
        int where = (int)(key[k] >> 56) - 1, index = (int)(key[k] & 0xffffffffu);
        from[k] = where < 0 ? bodies->place[index] : index;
        if (where < 0) order.members = k + 1;
        while (slab < where) order.start[++slab] = k;
    }
    while (order.slabs && slab < order.slabs) order.start[++slab] = bodies->count;
    bodies->order = order;
    scree_bodies_permute(bodies, from);
    scree_bodies_mark_slabs(bodies);
}

void scree_bodies_mark_slabs(struct scree_bodies *bodies) {
    const struct scree_order *order = &bodies->order;
    memset(bodies->slab, -1, (size_t)bodies->count);
    bodies->mixed = 0;
    for (int k = order->members; k < bodies->count; k++)
        bodies->mixed |= scree_kind_of(bodies, k)->material != scree_kind_of(bodies, order->members)->material;
    for (int slab = 0; slab < order->slabs; slab++)
        for (int k = order->start[slab]; k < order->start[slab + 1]; k++) bodies->slab[k] = (signed char)slab;
}

int scree_bodies_disordered(const struct scree_bodies *bodies) {
    const struct scree_order *order = &bodies->order;
    long descents = 0, strangers = 0, members = bodies->count - order->members;
    uint64_t before = 0;
    if (order->slabs == 0) return 0;
    for (int k = order->members; k < bodies->count; k++) {
        uint64_t key = key_of(bodies, k, order), slab = key >> 24;
        descents += key < before;
        strangers += slab != (uint64_t)bodies->slab[k] + 1;
        before = key;
    }
    return descents > members / 3 || strangers > members / 8;
}

/* ---- permutation ---- */

_Static_assert(sizeof(struct scree_past) >= sizeof(struct scree_record), "the largest thing that is permuted");

/* Follow each cycle of the permutation; places that are done are marked by their complement. */
void scree_permute(void *array, size_t size, int *from, int count) {
    unsigned char *bytes = array, held[sizeof(struct scree_past)];
    for (int k = 0; array && k < count; k++) {
        if (from[k] < 0) continue;
        int to = k;
        memcpy(held, bytes + (size_t)k * size, size);
        while (from[to] != k) {
            int next = from[to];
            memcpy(bytes + (size_t)to * size, bytes + (size_t)next * size, size);
            from[to] = ~next;
            to = next;
        }
        memcpy(bytes + (size_t)to * size, held, size);
        from[to] = ~k;
    }
    for (int k = 0; array && k < count; k++) from[k] = ~from[k];
}

void scree_bodies_permute(struct scree_bodies *bodies, int *from) {
    int count = bodies->count;
    const struct {
        void *array;
        size_t size;
    } arrays[] = {
        {bodies->record, sizeof *bodies->record}, {bodies->spin, sizeof *bodies->spin},
        {bodies->state, sizeof *bodies->state},   {bodies->position, sizeof *bodies->position},
        {bodies->class, sizeof *bodies->class},   {bodies->kind_of, sizeof *bodies->kind_of},
        {bodies->past, sizeof *bodies->past},     {bodies->glance, sizeof *bodies->glance},
        {bodies->number, sizeof *bodies->number}, {bodies->calm, sizeof *bodies->calm},
        {bodies->flight, sizeof *bodies->flight}, {bodies->path, sizeof *bodies->path},
    };
    for (size_t k = 0; k < sizeof arrays / sizeof *arrays; k++)
        scree_permute(arrays[k].array, arrays[k].size, from, count);
    for (int k = 0; k < count; k++) bodies->place[bodies->number[k]] = k;
}
