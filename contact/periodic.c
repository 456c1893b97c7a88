/* The periodic box: bodies that have left it return. */
#include "contact/contacts.h"

#include <stdlib.h>
#include <string.h>

/* Periods that body k must go back along an axis to be in the box. */
static int periods_out(const struct scree_bodies *bodies, int k, int axis) {
    if (bodies->class[k] == SCREE_CLASS_FIXED || scree_kind_of(bodies, k)->joint.along[axis] != SCREE_FREE) return 0;
    double off = scree_periods_off(bodies, bodies->position[k][axis], axis);
    return fabs(off) <= SCREE_MOST_PERIODS ? (int)off : 0; /* farther in one go: the run is about to be stopped */
}

static scree_status room_for_returns(struct scree_contacts *contacts, int count, scree_trouble *trouble) {
    if (count <= contacts->return_capacity) return SCREE_OK;
    struct scree_return *returned = realloc(contacts->returned, 2 * (size_t)count * sizeof *returned);
    if (!returned) return scree_report(trouble, SCREE_NO_MEMORY, NULL, "no memory for %d bodies at the border", count);
    contacts->returned = returned;
    contacts->return_capacity = 2 * count;
    return SCREE_OK;
}

/* Whether a body is out by more than its own width: new lists cost so much that bodies return many at a time. */
static int is_far_out(const struct scree_bodies *bodies, int k) {
    int far = 0;
    for (int axis = 0; axis < 3; axis++) {
        double above = bodies->position[k][axis] - bodies->low[axis], width = 2.0 * bodies->record[k].bound;
        far |= (above < -width || above > bodies->period[axis] + width) && periods_out(bodies, k, axis) != 0;
    }
    return far;
}

static int any_far_out(const struct scree_bodies *bodies) {
    for (int k = 0; k < bodies->count; k++)
        if (is_far_out(bodies, k)) return 1;
    return 0;
}

static scree_status find_returns(struct scree_contacts *contacts, const struct scree_bodies *bodies,
                                 scree_trouble *trouble) {
    contacts->returns = 0;
    if (!any_far_out(bodies)) return SCREE_OK;
    for (int k = 0; k < bodies->count; k++) {
        struct scree_return out = {.body = k};
        int any = 0;
        for (int axis = 0; axis < 3; axis++) any |= out.periods[axis] = periods_out(bodies, k, axis);
        if (!any) continue;
        memcpy(out.from, bodies->position[k], sizeof out.from);
        memcpy(out.ahead, bodies->record[k].x, sizeof out.ahead);
        scree_status status = room_for_returns(contacts, contacts->returns + 1, trouble);
        if (status) return status;
        contacts->returned[contacts->returns++] = out;
    }
    return SCREE_OK;
}

static void bring_back(const struct scree_contacts *contacts, struct scree_bodies *bodies) {
    for (int n = 0; n < contacts->returns; n++) {
        const struct scree_return *out = &contacts->returned[n];
        for (int axis = 0; axis < 3; axis++) {
            double way = out->periods[axis] * bodies->period[axis];
            bodies->position[out->body][axis] -= way;
            bodies->record[out->body].x[axis] -= way;
        }
    }
}

/* Undo it after a failure. The way back needs no memory that the way there didn't. */
static void send_off(struct scree_contacts *contacts, struct scree_bodies *bodies, int recoded) {
    for (int n = 0; n < contacts->returns; n++) {
        struct scree_return *out = &contacts->returned[n];
        memcpy(bodies->position[out->body], out->from, sizeof out->from);
        memcpy(bodies->record[out->body].x, out->ahead, sizeof out->ahead);
        for (int axis = 0; axis < 3; axis++) out->periods[axis] = -out->periods[axis];
    }
    if (recoded) scree_contacts_recode(contacts, bodies, NULL);
    contacts->returns = 0;
}

scree_status scree_contacts_return(struct scree_contacts *contacts, struct scree_bodies *bodies, int threads,
                                   scree_trouble *trouble) {
    scree_status status = find_returns(contacts, bodies, trouble);
    if (status) contacts->returns = 0;
    if (status || contacts->returns == 0) return status;
    bring_back(contacts, bodies);
    status = scree_contacts_recode(contacts, bodies, trouble);
    int recoded = status == SCREE_OK;
    if (!status) status = scree_contacts_list(contacts, bodies, threads, trouble);
    if (status) send_off(contacts, bodies, recoded);
    return status;
}
