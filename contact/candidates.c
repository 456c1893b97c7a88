/* Candidates: pairs of bodies whose bounding spheres come within the skin. Bodies lie in grids of cells, one grid for each
 * power of two of their size, so that a body of any size meets a few cells of its own grid and of each coarser one (Hierarchical
 * grids: Ericson, Real-Time Collision Detection, 2005, section 7.2). Planes, which have no bounds, meet everything. */
#include "contact/contacts.h"

#include <stdint.h>
#include <stdlib.h>

enum { LEVELS = 64 };

/* The finest grid's cell, and which grids hold bodies. */
struct grids {
    double finest;
    int used[LEVELS];
    int highest;
};

/* Radius within which a body looks for others, half of the skin included. */
static double reach_of(const struct scree_contacts *contacts, const struct scree_record *record) {
    return record->bound + 0.5 * contacts->skin;
}

static int is_bounded(const struct scree_bodies *bodies, int k) { return bodies->shape[k].kind != SCREE_PLANE; }

static double cell_size(const struct grids *grids, int level) { return ldexp(grids->finest, level); }

/* Put each body into the grid whose cells are just as large as its diameter. */
static struct grids choose_levels(struct scree_contacts *contacts, const struct scree_bodies *bodies) {
    struct grids grids = {.finest = HUGE_VAL};
    double coarsest = 0.0;
    for (int k = 0; k < bodies->count; k++) {
        if (!is_bounded(bodies, k)) continue;
        double size = 2.0 * reach_of(contacts, &bodies->record[k]);
        grids.finest = fmin(grids.finest, size);
        coarsest = fmax(coarsest, size);
    }
    grids.finest = fmax(grids.finest, ldexp(coarsest, 2 - LEVELS));
    for (int k = 0; k < bodies->count; k++) {
        if (!is_bounded(bodies, k)) continue;
        int level;
        double share = frexp(2.0 * reach_of(contacts, &bodies->record[k]) / grids.finest, &level);
        if (share == 0.5) level--; /* just that power of two */
        level = level > 0 ? level : 0;
        contacts->level[k] = (unsigned char)level;
        grids.used[level] = 1;
        if (level > grids.highest) grids.highest = level;
    }
    return grids;
}

/* Number of the cell along one axis; what is beyond exact whole numbers shares the outermost one. */
static double cell_of(double x, double size) { return fmax(fmin(floor(x / size), 1e15), -1e15); }

/* A coordinate as the cells have it: inside of the periodic box. */
static double in_box(const struct scree_bodies *bodies, double x, int axis) {
    return x - bodies->period[axis] * scree_periods_off(bodies, x, axis);
}

/* A cell's key; equal keys of different cells only cost time. */
static uint64_t key_of(int level, const double cell[3]) {
    uint64_t key = 0x9e3779b97f4a7c15u * (uint64_t)(level + 1);
    for (int axis = 0; axis < 3; axis++) {
        key = (key ^ (uint64_t)(int64_t)cell[axis]) * 0xff51afd7ed558ccdu; /* Murmur's mixer (Appleby 2011) */
        key ^= key >> 32;
    }
    return key;
}

/* Each cell's bodies as a chain; cells whose keys fall on one place share a chain. */
static void fill_cells(struct scree_contacts *contacts, const struct scree_bodies *bodies, const struct grids *grids) {
    for (size_t k = 0; k <= contacts->last_place; k++) contacts->place[k] = -1;
    for (int k = bodies->count - 1; k >= 0; k--) {
        if (!is_bounded(bodies, k)) continue;
        double size = cell_size(grids, contacts->level[k]), cell[3];
        for (int axis = 0; axis < 3; axis++)
            cell[axis] = cell_of(in_box(bodies, bodies->record[k].x[axis], axis), size);
        contacts->key[k] = key_of(contacts->level[k], cell);
        size_t place = (size_t)contacts->key[k] & contacts->last_place;
        contacts->next[k] = contacts->place[place];
        contacts->place[place] = k;
    }
}

static int bounds_meet(const struct scree_bodies *bodies, int i, int j, double skin) {
    const struct scree_record *a = &bodies->record[i], *b = &bodies->record[j];
    double reach = a->bound + b->bound + skin;
    struct vec apart = vec_sub(vec_from(a->x), vec_from(b->x));
    if (bodies->periodic) apart = scree_nearest_image(bodies, apart);
    return vec_norm2(apart) <= reach * reach;
}

/* Take up the pair if its bounds and its materials meet. */
static scree_status add_pair(struct scree_contacts *contacts, const struct scree_bodies *bodies, int i, int j,
                             scree_trouble *trouble) {
    if (!bounds_meet(bodies, i, j, contacts->skin)) return SCREE_OK;
    if (!scree_contacts_rule(contacts, bodies, i, j, NULL)) return SCREE_OK;
    if (contacts->pairs == contacts->pair_capacity) {
        int capacity = contacts->pair_capacity ? 2 * contacts->pair_capacity : 64;
        struct scree_body_pair *pair = realloc(contacts->pair, (size_t)capacity * sizeof *pair);
        if (pair) contacts->pair = pair;
        struct scree_body_pair *sorted = realloc(contacts->sorted, (size_t)capacity * sizeof *sorted);
        if (sorted) contacts->sorted = sorted;
        if (!pair || !sorted)
            return scree_report(trouble, SCREE_NO_MEMORY, NULL, "no memory for %d candidate pairs", capacity);
        contacts->pair_capacity = capacity;
    }
    contacts->pair[contacts->pairs++] = (struct scree_body_pair){i < j ? i : j, i < j ? j : i};
    return SCREE_OK;
}

/* Partners of body k in one cell; `after`: only those of higher number, in its own cell, so that each pair is found once. */
static scree_status look_into(struct scree_contacts *contacts, const struct scree_bodies *bodies, int k, int level,
                              const double cell[3], int after, scree_trouble *trouble) {
    uint64_t key = key_of(level, cell);
    scree_status status = SCREE_OK;
    for (int other = contacts->place[(size_t)key & contacts->last_place]; other >= 0 && !status;
         other = contacts->next[other]) {
        if (contacts->key[other] != key || contacts->level[other] != level) continue;
        if (after && other <= k) continue;
        status = add_pair(contacts, bodies, k, other, trouble);
    }
    return status;
}

/* Partners of body k in its own grid: whatever it can meet is in its cell or in one next to that, and half of these are enough, since
 * the other half look from there. */
static scree_status look_beside(struct scree_contacts *contacts, const struct scree_bodies *bodies,
                                const struct grids *grids, int k, scree_trouble *trouble) {
    int level = contacts->level[k];
    double size = cell_size(grids, level), own[3], cell[3];
    for (int axis = 0; axis < 3; axis++) own[axis] = cell_of(in_box(bodies, bodies->record[k].x[axis], axis), size);
    scree_status status = look_into(contacts, bodies, k, level, own, 1, trouble);
    for (int n = 14; n < 27 && !status; n++) { /* 13 would be its own */
        cell[0] = own[0] + (n / 9 - 1);
        cell[1] = own[1] + (n / 3 % 3 - 1);
        cell[2] = own[2] + (n % 3 - 1);
        status = look_into(contacts, bodies, k, level, cell, 0, trouble);
    }
    return status;
}

/* Partners of body k in the grid of `level` around `at`: their centres are within its reach and half a cell, their own
 * largest reach. */
static scree_status look_about(struct scree_contacts *contacts, const struct scree_bodies *bodies, int k, int level,
                               const double at[3], double far, double size, int after, scree_trouble *trouble) {
    double low[3], high[3], cell[3];
    for (int axis = 0; axis < 3; axis++) {
        low[axis] = cell_of(at[axis] - far, size);
        high[axis] = cell_of(at[axis] + far, size);
    }
    scree_status status = SCREE_OK;
    for (cell[0] = low[0]; cell[0] <= high[0] && !status; cell[0] += 1.0)
        for (cell[1] = low[1]; cell[1] <= high[1] && !status; cell[1] += 1.0)
            for (cell[2] = low[2]; cell[2] <= high[2] && !status; cell[2] += 1.0)
                status = look_into(contacts, bodies, k, level, cell, after, trouble);
    return status;
}

/* The same in a coarser grid around the body, and around its images whose reach crosses the border of the periodic box. In its own
 * grid only these: what it can meet without crossing the border, look_beside finds. */
static scree_status look_around(struct scree_contacts *contacts, const struct scree_bodies *bodies,
                                const struct grids *grids, int k, int level, scree_trouble *trouble) {
    const struct scree_record *record = &bodies->record[k];
    double size = cell_size(grids, level), far = reach_of(contacts, record) + 0.5 * size, at[3];
    int own = level == contacts->level[k];
    if (!bodies->periodic) return look_about(contacts, bodies, k, level, record->x, far, size, 0, trouble);
    int first[3] = {0}, last[3] = {0}, image[3];
    for (int axis = 0; axis < 3; axis++) {
        double period = bodies->period[axis], from_low = in_box(bodies, record->x[axis], axis) - bodies->low[axis];
        first[axis] = period > 0.0 && from_low + far >= period ? -1 : 0;
        last[axis] = period > 0.0 && from_low - far <= 0.0 ? 1 : 0;
    }
    scree_status status = SCREE_OK;
    for (image[0] = first[0]; image[0] <= last[0]; image[0]++)
        for (image[1] = first[1]; image[1] <= last[1]; image[1]++)
            for (image[2] = first[2]; image[2] <= last[2] && !status; image[2]++) {
                if (own && image[0] == 0 && image[1] == 0 && image[2] == 0) continue;
                for (int axis = 0; axis < 3; axis++)
                    at[axis] = in_box(bodies, record->x[axis], axis) + image[axis] * bodies->period[axis];
                status = look_about(contacts, bodies, k, level, at, far, size, own, trouble);
            }
    return status;
}

static scree_status meet_planes(struct scree_contacts *contacts, const struct scree_bodies *bodies,
                                scree_trouble *trouble) {
    scree_status status = SCREE_OK;
    for (int plane = 0; plane < bodies->count; plane++) {
        if (is_bounded(bodies, plane)) continue;
        for (int k = 0; k < bodies->count && !status; k++)
            if (is_bounded(bodies, k)) status = add_pair(contacts, bodies, plane, k, trouble);
    }
    return status;
}

/* By (i, j): a count of each i gives its place, then its few j are put in order as they come. A pair found twice, through cells
 * with equal keys, is kept once. */
static void sort_pairs(struct scree_contacts *contacts, int bodies) {
    int *start = contacts->start;
    for (int k = 0; k <= bodies; k++) start[k] = 0;
    for (int p = 0; p < contacts->pairs; p++) start[contacts->pair[p].i + 1]++;
    for (int k = 0; k < bodies; k++) start[k + 1] += start[k];
    for (int p = 0; p < contacts->pairs; p++) contacts->sorted[start[contacts->pair[p].i]++] = contacts->pair[p];
    int kept = 0;
    for (int p = 0; p < contacts->pairs; p++) {
        struct scree_body_pair pair = contacts->sorted[p];
        int place = kept++;
        for (; place > 0 && contacts->pair[place - 1].i == pair.i && contacts->pair[place - 1].j > pair.j; place--)
            contacts->pair[place] = contacts->pair[place - 1];
        contacts->pair[place] = pair;
        int twice = place > 0 && contacts->pair[place - 1].i == pair.i && contacts->pair[place - 1].j == pair.j;
        if (!twice) continue;
        for (kept--; place < kept; place++) contacts->pair[place] = contacts->pair[place + 1];
    }
    contacts->pairs = kept;
}

scree_status scree_candidates(struct scree_contacts *contacts, const struct scree_bodies *bodies,
                              scree_trouble *trouble) {
    contacts->pairs = 0;
    struct grids grids = choose_levels(contacts, bodies);
    fill_cells(contacts, bodies, &grids);
    scree_status status = meet_planes(contacts, bodies, trouble);
    for (int k = 0; k < bodies->count && !status; k++) {
        if (!is_bounded(bodies, k)) continue;
        status = look_beside(contacts, bodies, &grids, k, trouble);
        for (int level = contacts->level[k] + !bodies->periodic; level <= grids.highest && !status; level++)
            if (grids.used[level]) status = look_around(contacts, bodies, &grids, k, level, trouble);
    }
    if (status) return status;
    if (contacts->pairs) sort_pairs(contacts, bodies->count);
    return SCREE_OK;
}
