/* Candidates: pairs of bodies whose bounding spheres come within the skin. Bodies are swept along x in the order of their
 * lower bounds (Baraff 1992); planes, which have no bounds, meet everything. */
#include "contact/contacts.h"

#include <stdlib.h>

static double lower_bound(const struct scree_bodies *bodies, int k) {
    return bodies->record[k].x[0] - bodies->record[k].bound;
}

/* Shell's sort with Ciura's gaps: quick on any order, and hardly more than one pass where little has changed. */
static void sort_by_lower_bound(const struct scree_bodies *bodies, int *order) {
    static const int gaps[] = {90927, 40412, 17961, 7983, 3548, 1577, 701, 301, 132, 57, 23, 10, 4, 1};
    for (size_t g = 0; g < sizeof gaps / sizeof gaps[0]; g++) {
        for (int k = gaps[g]; k < bodies->count; k++) {
            int body = order[k], place = k;
            double bound = lower_bound(bodies, body);
            for (; place >= gaps[g] && lower_bound(bodies, order[place - gaps[g]]) > bound; place -= gaps[g])
                order[place] = order[place - gaps[g]];
            order[place] = body;
        }
    }
}

static int compare_pairs(const void *a, const void *b) {
    const struct scree_body_pair *p = a, *q = b;
    if (p->i != q->i) return p->i < q->i ? -1 : 1;
    return (p->j > q->j) - (p->j < q->j);
}

static scree_status add_pair(struct scree_contacts *contacts, int i, int j, scree_trouble *trouble) {
    if (contacts->pairs == contacts->pair_capacity) {
        int capacity = contacts->pair_capacity ? 2 * contacts->pair_capacity : 64;
        struct scree_body_pair *grown = realloc(contacts->pair, (size_t)capacity * sizeof *grown);
        if (!grown) return scree_report(trouble, SCREE_NO_MEMORY, NULL, "no memory for %d candidate pairs", capacity);
        contacts->pair = grown;
        contacts->pair_capacity = capacity;
    }
    contacts->pair[contacts->pairs++] = (struct scree_body_pair){i < j ? i : j, i < j ? j : i};
    return SCREE_OK;
}

static int bounds_meet(const struct scree_bodies *bodies, int i, int j, double skin) {
    const struct scree_record *a = &bodies->record[i], *b = &bodies->record[j];
    double reach = a->bound + b->bound + skin;
    return vec_norm2(vec_sub(vec_from(a->x), vec_from(b->x))) <= reach * reach;
}

scree_status scree_candidates(struct scree_contacts *contacts, const struct scree_bodies *bodies,
                              scree_trouble *trouble) {
    int *order = contacts->order;
    contacts->pairs = 0;
    sort_by_lower_bound(bodies, order);
    for (int a = 0; a < bodies->count; a++) {
        int i = order[a];
        double upper = bodies->record[i].x[0] + bodies->record[i].bound + contacts->skin;
        for (int b = a + 1; b < bodies->count && lower_bound(bodies, order[b]) <= upper; b++) {
            int j = order[b];
            if (!bounds_meet(bodies, i, j, contacts->skin)) continue;
            if (!scree_contacts_rule(contacts, bodies, i, j, NULL)) continue;
            scree_status status = add_pair(contacts, i, j, trouble);
            if (status) return status;
        }
    }
    if (contacts->pairs) qsort(contacts->pair, (size_t)contacts->pairs, sizeof *contacts->pair, compare_pairs);
    return SCREE_OK;
}
