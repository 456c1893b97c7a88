/* Several steps in one sweep through the slabs: a scene that the third cache doesn't hold comes out of memory once for
 * all of them ("time skewing"; Wonnacott, IPDPS 2000).
 *
 * A slab may begin its next step as soon as it and the next one have moved on to the middle of it. So each step follows
 * the one before by a unit: a slab, or the first of a stretch and then the last one of the stretch before (slabs.c).
 * All sums keep their order, and no bit differs from steps one after the other.
 *
 * Where a body outgrows its margin on the way, what touches its slab waits; what doesn't, goes on. Then the sweep
 * stops, and lists are renewed from the records as they are, although some are a step or more ahead of others: as
 * always, a list may lack only pairs that can't touch before one of them has outgrown its margin from there.
 *
 * Slabs that aren't neighbours mustn't touch in all this time, whatever lists say. They don't if they are so far apart
 * that a body would have to go more than a skin in a step, at which a run stops. */
#include "contact/slabs.h"

#include <limits.h>

/* Which unit a slab belongs to; and which of its slabs a unit is named by, the last one to go. */
static int unit_of(int slab) { return slab - slab / SCREE_STRETCH; }

static int slab_of(int unit) { return unit > 0 ? unit + (unit - 1) / (SCREE_STRETCH - 1) : 0; }

/* ---- whether to ---- */

/* Non-members that move, or that contacts of members push on, have contacts of no slab (segment 0). */
static int are_frozen(const struct scree_bodies *bodies) {
    for (int k = 0; k < bodies->order.members; k++)
        if (bodies->class[k] != SCREE_CLASS_FIXED || scree_kind_of(bodies, k)->shape.kind == SCREE_SPHERE) return 0;
    return 1;
}

/* Whether slabs with another one between them stay apart for a sweep: two bodies, of which each may go a skin in a step
 * before it has a new margin. */
static int are_apart(struct scree_contacts *contacts, const struct scree_bodies *bodies) {
    double most = 2.0 * (SCREE_SWEEP - 1) * contacts->chosen_skin, high = -HUGE_VAL; /* of the slabs before the last */
    scree_find_stays(contacts, bodies);
    for (int slab = 2; slab < bodies->order.slabs; slab++) {
        high = fmax(high, contacts->stay[slab - 2].high);
        if (!(contacts->stay[slab].low - high > most)) return 0;
    }
    return 1;
}

/* From a unit's turn in one step to that in the next, a sweep goes through two units less one for each of its steps. So
 * many have to fit into the third cache, at 0.4 kB a body (scree_bodies_in_cache counts 2 kB), or 1 kB by pair
 * impulses. Where it has 32 MB, 100,000 spheres at rest take 0.91 of the time by 4 steps at once, 0.96 by 8; 1,000,000
 * take 0.91 to 1.00 by 2; 100,000 by pair impulses 0.95 by 2, 0.97 by 4. */
static int steps_in_cache(const struct scree_contacts *contacts, const struct scree_bodies *bodies) {
    double unit = (bodies->count - bodies->order.members) / (unit_of(bodies->order.slabs - 1) + 1.0);
    if (bodies->past) unit *= 1.0 / 0.4;
    int steps = SCREE_SWEEP;
    while (steps > 1 && (2 * steps - 1) * unit > 5.0 * contacts->cached) steps /= 2;
    return steps;
}

int scree_most_in_sweep(const struct scree_contacts *contacts, const struct scree_bodies *bodies) {
    enum { LEAST_SLABS = 2 * SCREE_SWEEP };
    if (bodies->count < contacts->cached || bodies->order.slabs < LEAST_SLABS) return 1;
    if (bodies->calm || bodies->periodic || contacts->measured) return 1;
    return are_frozen(bodies) ? steps_in_cache(contacts, bodies) : 1;
}

int scree_steps_in_sweep(struct scree_contacts *contacts, const struct scree_bodies *bodies) {
    int most = scree_most_in_sweep(contacts, bodies);
    return most > 1 && !bodies->flight && are_apart(contacts, bodies) ? most : 1;
}

/* ---- one sweep ---- */

int scree_steps_ahead(const struct scree_contacts *contacts, const struct scree_bodies *bodies, int k) {
    const struct scree_sweep *sweep = &contacts->sweep;
    int slab = bodies->slab[k], steps = 0;
    while (slab >= 0 && steps < sweep->steps && unit_of(slab) < sweep->passed[steps]) steps++;
    return steps;
}

static void begin(struct scree_slabs *all) {
    struct scree_sweep *sweep = &all->contacts->sweep;
    int steps = all->go->steps;
    for (int lap = 0; lap < steps; lap++) {
        sweep->passed[lap] = 0;
        scree_begin_tallies(all->contacts, all->slabs, lap);
    }
    sweep->steps = steps;
    sweep->ahead = all->go->ahead;
}

/* Whether a step may go through its next unit: the one before is two units ahead, or through with all. */
static int may_pass(const struct scree_sweep *sweep, int lap, int units) {
    int next = sweep->passed[lap], ahead = lap > 0 ? sweep->passed[lap - 1] : units;
    return next < units && next < sweep->until[lap] && (ahead == units || ahead > next + 1);
}

/* A unit through a step. Returns whether a body has outgrown its margin. */
static int pass(struct scree_slabs *all, int unit, int lap) {
    int slab = slab_of(unit), both = scree_ends_stretch(all, slab);
    const struct scree_tally *tally = &all->contacts->tally[lap][1 + slab];
    if (both) scree_act_slab(all, slab + 1, lap, 0);
    scree_act_slab(all, slab, lap, 0);
    return tally[0].too_far || (both && tally[1].too_far);
}

/* The latest step first: what it needs is at hand. */
static void go_through(struct scree_slabs *all, int units) {
    struct scree_sweep *sweep = &all->contacts->sweep;
    const struct scree_departure *given = all->go;
    for (int lap = sweep->steps - 1; lap >= 0;) {
        if (!may_pass(sweep, lap, units)) {
            lap--;
            continue;
        }
        struct scree_departure go = *given;
        go.ahead = lap + 1 < sweep->steps || given->ahead;
        go.to_come = lap + 1 < sweep->steps ? 0.5 : given->to_come;
        all->go = &go;
        int unit = sweep->passed[lap], too_far = pass(all, unit, lap);
        sweep->passed[lap]++;
        if (too_far && lap + 1 < sweep->steps && unit - 1 < sweep->until[lap + 1])
            sweep->until[lap + 1] = unit - 1; /* that unit touches bodies of this one */
        lap = sweep->steps - 1;
    }
    all->go = given;
}

int scree_sweep_slabs(struct scree_slabs *all) {
    struct scree_contacts *contacts = all->contacts;
    struct scree_sweep *sweep = &contacts->sweep;
    int units = unit_of(all->slabs - 1) + 1, too_far = 0;
    if (!sweep->steps) begin(all);
    for (int lap = 0; lap < sweep->steps; lap++) { /* with new lists */
        sweep->until[lap] = units;
        for (int slab = 0; slab < all->slabs; slab++) contacts->tally[lap][1 + slab].too_far = 0;
    }
    for (int slab = 0; slab < all->slabs; slab++) { /* nobody waits within a unit: units do */
        atomic_init(&all->front[slab].own, INT_MAX);
        atomic_init(&all->front[slab].next, INT_MAX);
        atomic_init(&all->state[slab], 0);
    }
    go_through(all, units);
    const struct scree_tally *last = contacts->tally[sweep->steps - 1];
    if (sweep->passed[sweep->steps - 1] < units) {
        sweep->stops++;
        return 1;
    }
    sweep->steps = 0;
    sweep->made++;
    for (int slab = 0; slab < all->slabs; slab++) too_far |= last[1 + slab].too_far;
    return too_far;
}
