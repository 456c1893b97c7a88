/* Candidates: pairs of bodies whose bounding spheres come within what both may go, mostly the skin. Bodies lie in grids
 * of cells, one grid for each power of two of their size, so that a body of any size meets a few cells of its own grid
 * and of each coarser one (Hierarchical grids: Ericson, Real-Time Collision Detection, 2005, section 7.2). Planes,
 * which have no bounds, meet everything. */
#include "contact/approach.h"
#include "contact/geometry.h"

#include <limits.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

enum { LEVELS = 64 };

/* Places are told in parts of a cell, as 16-bit numbers that begin anew after ROUND parts, 32 cells. */
enum { PARTS = 2048, ROUND = 65536 };

/* A body in its column of cells, one above the other along z; columns go by a key. Where it is in the periodic box and
 * within what range it is looked for are there in rough, so that whoever looks into the cell needn't go to the body
 * itself unless it may be near. */
struct occupant {
    uint32_t column;
    int body;
    uint16_t at[3], range;
};

/* The finest grid's cell, and which grids hold bodies; the grid of each body. A column's key tells the place of its
 * cell 0, and others follow cell by cell: bodies that are next to each other along z lie side by side. Those of a place
 * begin at `start`; columns that overlap mix. */
struct grids {
    double finest;
    int used[LEVELS];
    int highest;
    struct occupant *occupant;
    int *start;
    int *seat;       /* [place of a body]: its cell's place, then where it is among the occupants */
    uint32_t places; /* a power of two */
    unsigned char *level;
};

/* Radius within which a body is looked for, and looks for others, half of the skin and its flight included. */
static double reach_of(const struct scree_contacts *contacts, const struct scree_record *record) {
    return record->bound + 0.5 * contacts->skin + contacts->flights.sweep;
}

/* The same of what the body may go yet: two whose ranges don't meet can't come together. */
static double range_of(const struct scree_contacts *contacts, const struct scree_bodies *bodies, int k) {
    return bodies->record[k].bound + (0.5 * contacts->skin - bodies->path[k]) + contacts->flights.sweep;
}

static int is_bounded(const struct scree_bodies *bodies, int k) {
    return scree_kind_of(bodies, k)->shape.kind != SCREE_PLANE;
}

static double cell_size(const struct grids *grids, int level) { return ldexp(grids->finest, level); }

static scree_status make_grids(struct scree_contacts *contacts, size_t bodies, struct grids *grids,
                               scree_trouble *trouble) {
    size_t places = 16;
    while (places < bodies) places *= 2;
    size_t size = bodies * (sizeof(struct occupant) + 1) + (places + 2) * sizeof(int);
    scree_status status = scree_make_space(&contacts->rough, size, trouble);
    if (status) return status;
    struct occupant *occupant = contacts->rough.memory;
    int *start = (int *)(occupant + bodies);
    *grids = (struct grids){.occupant = occupant,
                            .start = start,
                            .seat = contacts->seat,
                            .places = (uint32_t)places,
                            .level = (unsigned char *)(start + places + 2)};
    return SCREE_OK;
}

/* Put each body into the grid whose cells are just as large as its diameter: the largest one's as large as that, others
 * halved, so that bodies of one size, or nearly, aren't looked for in cells larger than they need. */
static void choose_levels(const struct scree_contacts *contacts, const struct scree_bodies *bodies,
                          struct grids *grids) {
    double finest = HUGE_VAL, coarsest = 0.0;
    int halvings = 1;
    for (int k = 0; k < bodies->count; k++) {
        if (!is_bounded(bodies, k)) continue;
        double size = 2.0 * reach_of(contacts, &bodies->record[k]);
        finest = size < finest ? size : finest;
        coarsest = size > coarsest ? size : coarsest;
    }
    if (coarsest > 0.0) frexp(coarsest / finest, &halvings);
    grids->finest = ldexp(coarsest, 1 - (halvings < LEVELS ? halvings : LEVELS - 1));
    for (int k = 0; k < bodies->count; k++) {
        if (!is_bounded(bodies, k)) continue;
        int level;
        double share = frexp(2.0 * reach_of(contacts, &bodies->record[k]) / grids->finest, &level);
        if (share == 0.5) level--; /* just that power of two */
        level = level > 0 ? level : 0;
        grids->level[k] = (unsigned char)level;
        grids->used[level] = 1;
        if (level > grids->highest) grids->highest = level;
    }
}

/* The whole number below; what is beyond exact ones comes to the outermost of them. A dozen times per body: so no
 * function of the library. */
static inline double whole_below(double x) {
    double inner = x < 1e15 ? x : 1e15, within = inner > -1e15 ? inner : -1e15, whole = (double)(int64_t)within;
    return whole > within ? whole - 1.0 : whole;
}

/* Number of the cell along one axis. */
static inline double cell_of(double x, double size) { return whole_below(x / size); }

/* A coordinate as the cells have it: inside of the periodic box. */
static double in_box(const struct scree_bodies *bodies, double x, int axis) {
    return x - bodies->period[axis] * scree_periods_off(bodies, x, axis);
}

/* A column's key, mixed axis by axis (Murmur's mixer, Appleby 2011); equal keys of different columns only cost time. */
static uint64_t mix(uint64_t key, double cell) {
    key = (key ^ (uint64_t)(int64_t)cell) * 0xff51afd7ed558ccdu;
    return key ^ key >> 32;
}

static uint64_t key_of_level(int level) { return 0x9e3779b97f4a7c15u * (uint64_t)(level + 1); }

static uint32_t column_of(uint64_t row, double y) { return (uint32_t)mix(row, y); }

static uint32_t place_in(const struct grids *grids, uint32_t column, double z) {
    return (column + (uint32_t)(int64_t)z) & (grids->places - 1);
}

/* A place in parts of cells of some size, rounded down. */
static void find_parts(const double at[3], double size, uint16_t parts[3]) {
    for (int axis = 0; axis < 3; axis++) parts[axis] = (uint16_t)(int64_t)cell_of(at[axis], size / PARTS);
}

/* And a range, rounded up: by one part more, so that the rounding of places, less than a part along each axis, is
 * covered by two of them. From ROUND - 1 on it is all there is. */
static inline double parts_of(double range, double size) {
    double parts = 1.0 - whole_below(-range / size * PARTS);
    return parts < 0.0 ? 0.0 : parts < ROUND - 1.0 ? parts : ROUND - 1.0;
}

/* Where body k is in the periodic box, and its cell there. */
static void cell_at(const struct scree_bodies *bodies, const struct grids *grids, int k, double at[3], double cell[3]) {
    double size = cell_size(grids, grids->level[k]);
    for (int axis = 0; axis < 3; axis++) {
        at[axis] = in_box(bodies, bodies->record[k].x[axis], axis);
        cell[axis] = cell_of(at[axis], size);
    }
}

/* The column of body k, the place of its cell, and where it is in the box. */
static uint32_t column_at(const struct scree_bodies *bodies, const struct grids *grids, int k, double at[3],
                          uint32_t *place) {
    double cell[3];
    cell_at(bodies, grids, k, at, cell);
    uint32_t column = column_of(mix(key_of_level(grids->level[k]), cell[0]), cell[1]);
    *place = place_in(grids, column, cell[2]);
    return column;
}

/* By place, and there by number: a count of each place gives its start. What takes long is shared. */
static void fill_cells(const struct scree_contacts *contacts, const struct scree_bodies *bodies, struct grids *grids,
                       int threads) {
    int *start = grids->start, *seat = grids->seat;
    (void)threads; /* without OpenMP */
#pragma omp parallel for schedule(static) num_threads(threads) if (threads > 1)
    for (int k = 0; k < bodies->count; k++) {
        uint32_t place = 0;
        double at[3];
        if (is_bounded(bodies, k)) column_at(bodies, grids, k, at, &place);
        seat[k] = (int)place;
    }
    memset(start, 0, ((size_t)grids->places + 2) * sizeof *start);
    for (int k = 0; k < bodies->count; k++) start[seat[k] + 2] += is_bounded(bodies, k);
    for (size_t p = 0; p < grids->places; p++) start[p + 2] += start[p + 1];
    for (int k = 0; k < bodies->count; k++)
        if (is_bounded(bodies, k)) seat[k] = start[seat[k] + 1]++; /* so each start becomes an end */
#pragma omp parallel for schedule(static) num_threads(threads) if (threads > 1)
    for (int k = 0; k < bodies->count; k++) {
        uint32_t place;
        double at[3], size = cell_size(grids, grids->level[k]);
        if (!is_bounded(bodies, k)) continue;
        uint32_t column = column_at(bodies, grids, k, at, &place);
        struct occupant *one = &grids->occupant[seat[k]];
        *one = (struct occupant){column, k, {0}, (uint16_t)parts_of(range_of(contacts, bodies, k), size)};
        find_parts(at, size, one->at);
    }
}

/* Whether a body may come to a plane. */
static int meets_plane(const struct scree_contacts *contacts, const struct scree_bodies *bodies, int plane, int k) {
    double left = scree_left_of(contacts, bodies, plane, k) + vec_norm(scree_flown(contacts, bodies, plane, k));
    const struct scree_record *a = &bodies->record[plane], *b = &bodies->record[k];
    const struct mat *frame = &scree_attitude_of(bodies, plane)->frame;
    return -scree_meet_plane(vec_from(b->x), b->bound, vec_from(a->x), frame).overlap <= left;
}

/* The bounds of two bodies. In a periodic box the image that comes nearest may be another one than that which is
 * nearest now: there flights count as going straight at each other. */
static SCREE_INLINE void put_bounds(const struct scree_contacts *contacts, const struct scree_bodies *bodies, int i,
                                    int j, int k, struct scree_approaches *to) {
    const struct scree_record *a = &bodies->record[i], *b = &bodies->record[j];
    struct vec flown = scree_flown(contacts, bodies, i, j);
    double reach = a->bound + b->bound + scree_left_of(contacts, bodies, i, j), apart[3];
    for (int axis = 0; axis < 3; axis++) apart[axis] = a->x[axis] - b->x[axis];
    if (bodies->periodic) {
        for (int axis = 0; axis < 3; axis++)
            apart[axis] -= bodies->period[axis] * scree_periods_in(bodies, apart[axis], axis);
        reach += vec_norm(flown);
        flown = vec(0.0, 0.0, 0.0);
    }
    scree_put_approach(to, k, vec_from(apart), flown, reach);
}

/* What looks for partners, and where it puts what it finds; bodies in the cells of the one that looks are weighed many
 * at once. */
struct seeker {
    const struct scree_contacts *contacts;
    const struct scree_bodies *bodies;
    const struct grids *grids;
    struct scree_found *found;
    int *number;    /* found by this part */
    int last;       /* for whom something was found last */
    uint16_t at[3]; /* where the one that looks stands for the cells that it looks into, */
    int range;      /* and how far it looks, in their parts */
    int count, seen[SCREE_LANES];
};

/* More than that isn't counted. */
enum { MOST_FOUND = INT_MAX / 2 };

static void put_number(struct seeker *s, int number) {
    if (s->found->count < s->found->capacity) s->number[s->found->count] = number;
    s->found->count += s->found->count < MOST_FOUND;
}

/* Take up a partner of body k whose bounds meet its, if their materials do; what there is no room for is counted. */
static void add_partner(struct seeker *s, int k, int partner) {
    if (!scree_contacts_rule(s->contacts, s->bodies, k, partner, NULL)) return;
    if (s->last != k) put_number(s, ~k);
    s->last = k;
    put_number(s, partner);
    s->found->partners += s->found->partners < MOST_FOUND;
}

/* Which of those that body k has seen it may meet. */
static void weigh(struct seeker *s, int k) {
    struct scree_approaches pairs;
    int near[SCREE_LANES], count = 0;
    for (int n = 0; n < s->count; n++) put_bounds(s->contacts, s->bodies, k, s->seen[n], n, &pairs);
    scree_judge_approaches(&pairs, s->count);
    for (int n = 0; n < s->count; n++) {
        near[count] = s->seen[n];
        count += pairs.near[n] > 0.0;
    }
    for (int n = 0; n < count; n++) add_partner(s, k, near[n]);
    s->count = 0;
}

static void stand_at(struct seeker *s, const double at[3], double range, double size) {
    find_parts(at, size, s->at);
    s->range = (int)parts_of(range, size);
}

/* As far as can be told in rough. Ways round are the shorter ones, so nobody near seems far. */
static inline int may_meet(const struct seeker *s, const struct occupant *other) {
    int64_t square = 0, reach = s->range + other->range;
    for (int axis = 0; axis < 3; axis++) {
        int64_t way = (int16_t)(uint16_t)(other->at[axis] - s->at[axis]);
        square += way * way;
    }
    return square <= reach * reach;
}

/* Partners of body k in so many cells of a column from `z` on; `after`: only those of higher number, in its own cell,
 * so that each pair is found once. */
static void look_into(struct seeker *s, int k, uint32_t column, double z, double cells, int after) {
    const struct grids *grids = s->grids;
    uint32_t place = place_in(grids, column, z), left = cells < grids->places ? (uint32_t)cells : grids->places;
    while (left > 0) { /* twice where the places are at an end */
        uint32_t run = left < grids->places - place ? left : grids->places - place;
        for (int n = grids->start[place]; n < grids->start[place + run]; n++) {
            const struct occupant *other = &grids->occupant[n];
            int own = (other->body == k) | (after & (other->body < k));
            if (s->count == SCREE_LANES) weigh(s, k);
            s->seen[s->count] = other->body;
            s->count += (other->column == column) & !own & may_meet(s, other);
        }
        left -= run;
        place = 0;
    }
}

/* Partners of body k in its own grid: whatever it can meet is in its cell or in one next to that, and half of these are
 * enough, since the other half look from there. */
static void look_beside(struct seeker *s, int k) {
    double own[3], at[3];
    cell_at(s->bodies, s->grids, k, at, own);
    stand_at(s, at, range_of(s->contacts, s->bodies, k), cell_size(s->grids, s->grids->level[k]));
    uint64_t level = key_of_level(s->grids->level[k]), same = mix(level, own[0]), next = mix(level, own[0] + 1.0);
    look_into(s, k, column_of(same, own[1]), own[2], 1.0, 1);
    look_into(s, k, column_of(same, own[1]), own[2] + 1.0, 1.0, 0);
    look_into(s, k, column_of(same, own[1] + 1.0), own[2] - 1.0, 3.0, 0);
    for (int y = -1; y <= 1; y++) look_into(s, k, column_of(next, own[1] + y), own[2] - 1.0, 3.0, 0);
}

/* Partners of body k in the grid of `level` around `at`: their centres are within its reach and half a cell, their own
 * largest reach. */
static void look_about(struct seeker *s, int k, int level, const double at[3], double far, double size, int after) {
    double low[3], high[3];
    stand_at(s, at, range_of(s->contacts, s->bodies, k), size);
    for (int axis = 0; axis < 3; axis++) {
        low[axis] = cell_of(at[axis] - far, size);
        high[axis] = cell_of(at[axis] + far, size);
    }
    for (double x = low[0]; x <= high[0]; x += 1.0)
        for (double y = low[1]; y <= high[1]; y += 1.0)
            look_into(s, k, column_of(mix(key_of_level(level), x), y), low[2], high[2] - low[2] + 1.0, after);
}

/* The same around the body, and around its images whose reach crosses the border of the periodic box. `own`: only
 * these, for what it can meet without crossing the border, look_beside has found. */
static void look_around(struct seeker *s, int k, int level, double reach, int own) {
    const struct scree_bodies *bodies = s->bodies;
    const struct scree_record *record = &bodies->record[k];
    double size = cell_size(s->grids, level), far = reach + 0.5 * size, at[3];
    if (!bodies->periodic) {
        look_about(s, k, level, record->x, far, size, 0);
        return;
    }
    int first[3] = {0}, last[3] = {0}, image[3];
    for (int axis = 0; axis < 3; axis++) {
        double period = bodies->period[axis], from_low = in_box(bodies, record->x[axis], axis) - bodies->low[axis];
        first[axis] = period > 0.0 && from_low + far >= period ? -1 : 0;
        last[axis] = period > 0.0 && from_low - far <= 0.0 ? 1 : 0;
    }
    for (image[0] = first[0]; image[0] <= last[0]; image[0]++)
        for (image[1] = first[1]; image[1] <= last[1]; image[1]++)
            for (image[2] = first[2]; image[2] <= last[2]; image[2]++) {
                if (own && image[0] == 0 && image[1] == 0 && image[2] == 0) continue;
                for (int axis = 0; axis < 3; axis++)
                    at[axis] = in_box(bodies, record->x[axis], axis) + image[axis] * bodies->period[axis];
                look_about(s, k, level, at, far, size, own);
            }
}

/* All partners of body k that it is its turn to find. A fast one, which may go farther than half the skin, finds all of
 * its partners, in all grids: so nobody else has to look farther than half the skin. */
static void look(struct seeker *s, int k) {
    const struct scree_contacts *contacts = s->contacts;
    const struct grids *grids = s->grids;
    double reach = reach_of(contacts, &s->bodies->record[k]), more = -s->bodies->path[k];
    int own = grids->level[k];
    for (int p = 0; p < contacts->planes; p++)
        if (meets_plane(contacts, s->bodies, contacts->plane[p], k)) add_partner(s, k, contacts->plane[p]);
    look_beside(s, k);
    for (int level = own + !s->bodies->periodic; level <= grids->highest; level++)
        if (grids->used[level]) look_around(s, k, level, reach, level == own);
    for (int level = 0; more > 0.0 && level <= grids->highest; level++)
        if (grids->used[level])
            look_around(s, k, level, reach + more + (contacts->widest_margin - 0.5 * contacts->skin), 0);
    weigh(s, k);
}

/* The partners of a body, from `first` to `end`, in order as they come, from place `kept` on; those found twice,
 * through cells with equal keys, once. Returns the place after the last. */
static int order_partners(int *partner, int first, int end, int kept) {
    int begin = kept;
    for (int p = first; p < end; p++) {
        int one = partner[p], place = kept;
        while (place > begin && partner[place - 1] > one) place--;
        if (place > begin && partner[place - 1] == one) continue;
        for (int q = kept++; q > place; q--) partner[q] = partner[q - 1];
        partner[place] = one;
    }
    return kept;
}

/* Where the numbers of a part are; NULL before there is room for any. */
static int *found_in(const struct scree_contacts *contacts, int part) {
    int *number = contacts->listed.memory;
    return number ? number + contacts->found[part].first : NULL;
}

/* Count the partners of each body that are larger than it, into the place behind its own. */
static void count_partners(const struct scree_contacts *contacts, int *start) {
    for (int part = 0; part < SCREE_PARTS; part++) {
        const int *number = found_in(contacts, part), count = contacts->found[part].count;
        for (int n = 0, k = 0; n < count; n++) {
            if (number[n] < 0)
                k = ~number[n];
            else
                start[(k < number[n] ? k : number[n]) + 1]++;
        }
    }
}

/* Each partner into the next place of the lesser body: so each start becomes an end. */
static void place_partners(const struct scree_contacts *contacts, int *start, int *partner) {
    for (int part = 0; part < SCREE_PARTS; part++) {
        const int *number = found_in(contacts, part), count = contacts->found[part].count;
        for (int n = 0, k = 0; n < count; n++) {
            if (number[n] < 0)
                k = ~number[n];
            else
                partner[start[k < number[n] ? k : number[n]]++] = k < number[n] ? number[n] : k;
        }
    }
}

/* Each body's partners in order, and those of a part side by side from where they began; returns how many. */
static int order_part(struct scree_contacts *contacts, const struct scree_bodies *bodies, int part, int begin) {
    int kept = begin;
    for (int k = scree_part_begin(bodies, part), first = begin; k < scree_part_begin(bodies, part + 1); k++) {
        int end = contacts->end[k];
        contacts->end[k] = kept = order_partners(contacts->partner, first, end, kept);
        first = end;
    }
    return kept - begin;
}

static int order_all(struct scree_contacts *contacts, const struct scree_bodies *bodies, int threads) {
    int begin[SCREE_PARTS], count[SCREE_PARTS], kept = 0;
    (void)threads; /* without OpenMP */
    for (int part = 0; part < SCREE_PARTS; part++) {
        int first = scree_part_begin(bodies, part);
        begin[part] = first > 0 ? contacts->end[first - 1] : 0;
    }
#pragma omp parallel for schedule(static) num_threads(threads) if (threads > 1)
    for (int part = 0; part < SCREE_PARTS; part++) count[part] = order_part(contacts, bodies, part, begin[part]);
    for (int part = 0; part < SCREE_PARTS; kept += count[part++]) {
        if (begin[part] == kept) continue; /* some before were found twice */
        memmove(contacts->partner + kept, contacts->partner + begin[part], (size_t)count[part] * sizeof(int));
        for (int k = scree_part_begin(bodies, part); k < scree_part_begin(bodies, part + 1); k++)
            contacts->end[k] -= begin[part] - kept;
    }
    return kept;
}

/* By (i, j): a count of each i gives its place. The cells have done their duty. */
static scree_status sort_pairs(struct scree_contacts *contacts, const struct scree_bodies *bodies, int threads,
                               scree_trouble *trouble) {
    size_t all = 0, count = (size_t)bodies->count;
    for (int part = 0; part < SCREE_PARTS; part++) all += (size_t)contacts->found[part].partners;
    contacts->pairs = 0;
    if (all > INT_MAX) return scree_report(trouble, SCREE_NO_MEMORY, NULL, "%zu pairs are too many", all);
    scree_status status = scree_make_space(&contacts->rough, (count + 1 + all) * sizeof(int), trouble);
    if (status) return status;
    int *start = contacts->end = contacts->rough.memory;
    contacts->partner = start + count + 1;
    for (size_t k = 0; k <= count; k++) start[k] = 0;
    count_partners(contacts, start);
    for (size_t k = 0; k < count; k++) start[k + 1] += start[k];
    place_partners(contacts, start, contacts->partner);
    contacts->pairs = order_all(contacts, bodies, threads);
    return SCREE_OK;
}

/* All parts look; returns 1 if some have found more than they have room for. */
static int search(struct scree_contacts *contacts, const struct scree_bodies *bodies, const struct grids *grids,
                  int threads) {
    int lack = 0;
    (void)threads; /* without OpenMP */
#pragma omp parallel for schedule(dynamic) num_threads(threads) if (threads > 1)
    for (int part = 0; part < SCREE_PARTS; part++) {
        struct scree_found *found = &contacts->found[part];
        struct seeker seeker = {.contacts = contacts,
                                .bodies = bodies,
                                .grids = grids,
                                .found = found,
                                .number = found_in(contacts, part),
                                .last = -1};
        int from = scree_part_begin(bodies, part), to = scree_part_begin(bodies, part + 1);
        found->count = found->partners = 0;
        for (int k = from; k < to; k++)
            if (is_bounded(bodies, k)) look(&seeker, k);
    }
    for (int part = 0; part < SCREE_PARTS; part++) lack |= contacts->found[part].count > contacts->found[part].capacity;
    return lack;
}

/* Shares for what was counted, where they were too small. */
static scree_status share_out(struct scree_contacts *contacts, scree_trouble *trouble) {
    size_t all = 0;
    for (int part = 0; part < SCREE_PARTS; part++) {
        struct scree_found *found = &contacts->found[part];
        if (found->count == MOST_FOUND)
            return scree_report(
                trouble, SCREE_NO_MEMORY, NULL,
                "more than %d pairs of bodies near each other are too many; are radii in the wrong unit?", MOST_FOUND);
        if (found->count > found->capacity) found->capacity = found->count + found->count / 16 + 16;
        found->first = all;
        all += (size_t)found->capacity;
    }
    scree_status status = scree_make_space(&contacts->listed, all * sizeof(int), trouble);
    for (int part = 0; status && part < SCREE_PARTS; part++) contacts->found[part].capacity = 0;
    return status;
}

scree_status scree_candidates(struct scree_contacts *contacts, const struct scree_bodies *bodies, int threads,
                              scree_trouble *trouble) {
    struct grids grids;
    scree_status status = make_grids(contacts, (size_t)bodies->count, &grids, trouble);
    if (status) return status;
    choose_levels(contacts, bodies, &grids);
    fill_cells(contacts, bodies, &grids, threads);
    contacts->planes = 0;
    for (int k = 0; k < bodies->count; k++)
        if (!is_bounded(bodies, k)) contacts->plane[contacts->planes++] = k;
    if (search(contacts, bodies, &grids, threads)) {
        status = share_out(contacts, trouble);
        if (status) return status;
        search(contacts, bodies, &grids, threads);
    }
    return sort_pairs(contacts, bodies, threads, trouble);
}
