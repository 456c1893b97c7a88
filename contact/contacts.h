/* The contacts of a scene: which pairs of bodies may touch, which contacts are near, and the one loop that turns
 * body records into impulses.
 *
 *   candidates   pairs of bodies that may touch before the list is made anew (candidates.c)
 *   list         their contacts within reach, one batch per geometry and pair of materials (list.c)
 *   near         those of them that may touch soon: of all bodies (near.c), of one that asks for itself (widen.c)
 *   loop         blocks of contacts through short passes; impulses into the bodies (loop.c)
 *
 * A contact is a ball (a sphere, or the corner of a rounded box) on a partner: another ball, a plane, a rectangle
 * or a box; or an edge on an edge (crossing.h). Whatever it is, it becomes a normal, an overlap and two arms, and goes
 * through the same laws. Every listed contact is computed, or known to give zero, as those out of touch do: so the
 * result doesn't depend on when lists are made. */
#ifndef SCREE_CONTACT_CONTACTS_H
#define SCREE_CONTACT_CONTACTS_H

#include "bodies/bodies.h"
#include "contact/catalogue.h"
#include "contact/crossing.h"

#include <stdint.h>

enum { SCREE_SEGMENTS = SCREE_SLABS + 1 };
enum {
    SCREE_LANES = 32,   /* contacts in a block: their work columns stay in the L1 cache */
    SCREE_WINDOW = 4,   /* blocks of which contacts that take longer are drawn together */
    SCREE_PADDING = 32, /* passes run over whole vectors: what columns hold is padded to a multiple of this */
};

static inline int scree_padded(int count) { return (count + SCREE_PADDING - 1) / SCREE_PADDING * SCREE_PADDING; }

/* Columns of pair constants: those of the normal law, then two of the friction law, then the lever of the rolling law,
 * m. */
enum {
    SCREE_PAIR_FRICTION = SCREE_PAIR_CONSTANTS,
    SCREE_PAIR_LEVER = SCREE_PAIR_FRICTION + 2,
    SCREE_PAIR_COLUMNS = SCREE_PAIR_LEVER + 1
};

enum scree_geometry {
    SCREE_BALL_BALL,
    SCREE_BALL_PLANE,
    SCREE_BALL_RECTANGLE,
    SCREE_BALL_BOX,
    SCREE_BALL_IMAGE, /* a ball on another that stands whole periods off; a batch of its own, so that the others pay
                         nothing */
    SCREE_EDGE_EDGE,
    SCREE_GEOMETRIES
};

/* One contact: ball on body `ball`, partner body `host`; `corner` is a row of the bodies' corner table (0: the ball is
 * the body's centre), of SCREE_BALL_IMAGE the code of its periods (scree_code_of, never 0), of SCREE_EDGE_EDGE that of
 * both edges (scree_crossing_code, never 0). Lists are sorted by (ball, host, corner), which is also what tells a
 * contact again in the next list. */
struct scree_contact {
    int ball, host, corner;
};

/* The same without its corner. */
struct scree_ends {
    int ball, host;
};

/* J that each contact of a block took out of the motion during the step. They are added up contact by contact: sums
 * that don't depend on how contacts fall into blocks. */
struct scree_losses {
    double normal[SCREE_LANES];     /* dissipated in normal direction */
    double tangential[SCREE_LANES]; /* done against friction and rolling resistance */
};

/* What a block of contacts yields. Impulses on the ball in N s, angular impulses on both bodies in N m s. */
struct scree_yield {
    double impulse[3][SCREE_LANES], turn_ball[3][SCREE_LANES], turn_host[3][SCREE_LANES];
    double depth[SCREE_LANES]; /* overlap over the largest tolerable overlap */
    double steep[SCREE_LANES]; /* scree_steepness: friction chatters beyond 1 */
    int silent;                /* only edges on edges: nothing touches, the rest isn't filled in */
    double lasts[SCREE_LANES]; /* whether bodies overlap at the end of the step; only of pair impulses */
    struct scree_losses lost;  /* if measured */
};

/* How much of a sliding velocity a friction law with a slope (s/m) takes in one step, at most, by the normal impulse
 * (N s): 1 is all of it. `softness`: inverse masses of both bodies (1/kg); a ball's rotation makes it 3.5 times as soft
 * as its mass, four corners that share a load four times. */
static inline double scree_steepness(double impulse, double slope, double softness) {
    return impulse * slope * (4.0 * softness);
}

/* What the pair-impulse method yields beside it, and keeps of each contact: the impulse of the last step, N s, and the
 * overlap (m) that its friction had on the mean, which tells the lever; then those of the step before, in whose place a
 * step writes its own. */
enum { SCREE_PAST_DEPTH = 3, SCREE_PAST_STEP = 4, SCREE_PAST = 2 * SCREE_PAST_STEP };

struct scree_moments {
    double impulse[3][SCREE_LANES], turn_ball[3][SCREE_LANES], turn_host[3][SCREE_LANES]; /* N s^2, N m s^2 */
};

/* From … to, both included; none: INT_MAX … -1. */
struct scree_span {
    int least, most;
};

/* Part of a batch's list: near contacts first … first + count - 1, out of the outer list's. Segment 0 holds what isn't
 * of one slab; segment 1 + s belongs to slab s of the bodies (bodies/order.c): its contacts touch bodies of slabs s and
 * s + 1 only. A line of cache each: lists of several are made at once. */
struct scree_part {
    _Alignas(64) int first;
    int count, capacity;
    int outer_count;                  /* contacts in its outer list; */
    int codes_first, codes;           /* of a slab: where its codes begin in the batch's, and how many they are */
    struct scree_span reach[2];       /* how far its partners lie behind who comes first: in the slab, in the next */
    int last;                         /* whose partners have been named last, while the list is made */
    int stirring_first, stirring_end; /* those that aren't still, in the batch's list of them (rest.h) */
};

/* How many contacts a slab has up to the end of a strip, and what they touch: the last place in the slab, and the last
 * one in the next slab (-1: none); and the first place in the next slab that those from this strip on touch (INT_MAX:
 * none). */
struct scree_gate {
    int contacts, last_own, last_next, first_next;
};

/* Steps that slabs go through in one sweep, at most (sweep.c). */
enum { SCREE_SWEEP = 4 };

/* A sweep that lists have stopped on its way: how many units of slabs each of its steps has passed, and how many it may
 * pass with the lists that it began with. */
struct scree_sweep {
    int steps; /* 0: there is none */
    int ahead; /* behind the last one, bodies go to the middle of the next */
    int passed[SCREE_SWEEP], until[SCREE_SWEEP];
    long made, stops; /* so far, and how often one has stopped on its way */
    int told;         /* of the last one, steps that the sums of the scene hold: all, or up to one that went too deep */
};

/* Between which bounds across slabs the bodies of one stay, and all that comes near them, until the outer list is made
 * anew, m. */
struct scree_stay {
    double low, high;
};

/* What laws keep of a contact. */
struct scree_held {
    int index;
    double kept[SCREE_MEMORY];
};

/* The contacts of two boxes edge on edge, a run of segment 0 of their batch. */
struct scree_run {
    int start;                     /* its first contact, from the segment's first on */
    double clear;                  /* how far the boxes may move from here on, m, their ways added up, and not touch */
    double from;                   /* their paths when that was measured, added up, m */
    struct scree_rectangles first; /* where to look first whether corners bear all */
};

/* Contacts of one geometry between one pair of materials. Owns its arrays; they grow and never shrink. What is kept of
 * a contact lies in columns: only those that the laws use are there. */
struct scree_batch {
    enum scree_geometry geometry;
    int rule;   /* index of the laws */
    int memory; /* how many numbers of each contact laws may keep, from the first on; of those that no law
                      asks for there is no column */
    int turns;  /* all contacts can turn bodies: friction, rolling, a box or a rectangle as partner; else only those of
                   corners */
    int any_turns;              /* some do */
    double slope;               /* of friction and rolling laws, s/m; 0 if none is regularised by velocity */
    int uniform;                /* one set of pair constants serves all (one block of them is made) */
    struct scree_part *segment; /* SCREE_SEGMENTS of them */
    int count, capacity;        /* near contacts of all segments; places for them, gaps between segments included */
    struct scree_ends *ends;
    int corners; /* some contacts may have one; of other batches there is no column of them */
    int *corner;
    double *pair[SCREE_PAIR_COLUMNS];
    int pair_capacity;
    unsigned char keeps[SCREE_MEMORY]; /* which numbers are kept: in columns, but for friction's state, which is 0 or 1:
                                          in bytes */
    double *kept[SCREE_MEMORY];
    unsigned char *slides;
    struct scree_yield *yield; /* per block of segment 0 */
    int blocks;                /* room for so many */
    /* Only of edges on edges: the runs, and of each block the run of its first contact. */
    int runs, run_capacity;
    struct scree_run *run;
    int *first_run;
    /* While bodies sleep (rest.h): of segment 0 the blocks that work, with what is kept of still contacts in them; of
     * slabs those that aren't still. */
    int works_capacity, held_capacity, held, stirring_capacity;
    unsigned char *works;
    struct scree_held *holds;
    int *stirring;
    /* For the pair-impulse method; NULL without it. */
    int impulses;
    double *past[SCREE_PAST];
    struct scree_moments *moments; /* per block of segment 0 */
    /* Contacts that may get near before bodies have gone half a skin; near ones are picked from them. Those of slabs,
     * which have no corners, are codes: ~i names the body that comes first, then each 2 j + 1 or 2 j its partner j,
     * which is the ball or isn't. */
    int outer_count;
    struct scree_contact *loose; /* of segment 0 */
    int *code;                   /* of the slabs */
};

static inline struct scree_contact scree_contact_at(const struct scree_batch *batch, int k) {
    return (struct scree_contact){batch->ends[k].ball, batch->ends[k].host, batch->corner ? batch->corner[k] : 0};
}

static inline void scree_put_contact(const struct scree_batch *batch, int k, struct scree_contact contact) {
    batch->ends[k] = (struct scree_ends){contact.ball, contact.host};
    if (batch->corner) batch->corner[k] = contact.corner;
}

/* Goes through the outer list of a segment. */
struct scree_outer {
    const struct scree_contact *loose;
    const int *code;
    int first;
};

static inline struct scree_outer scree_outer_of(const struct scree_batch *batch, int segment) {
    if (segment == 0) return (struct scree_outer){batch->loose, NULL, 0};
    return (struct scree_outer){NULL, batch->code + batch->segment[segment].codes_first, 0};
}

/* Written without branches: who comes next, and who is the ball, is a matter of chance. */
static inline struct scree_contact scree_next_outer(struct scree_outer *outer) {
    if (outer->loose) return *outer->loose++;
    int named = *outer->code >> 31; /* all bits, or none */
    outer->first ^= (outer->first ^ ~*outer->code) & named;
    outer->code -= named;
    int code = *outer->code++, partner = code >> 1, swap = -(code & 1) & (outer->first ^ partner);
    return (struct scree_contact){outer->first ^ swap, partner ^ swap, 0};
}

/* Indices of the near contacts of a batch, one after the other; -1: no more. */
static inline int scree_next(const struct scree_batch *batch, int k) {
    int s = 0;
    while (s < SCREE_SEGMENTS && (!batch->segment[s].count || k >= batch->segment[s].first + batch->segment[s].count))
        s++;
    if (s < SCREE_SEGMENTS && k + 1 < batch->segment[s].first + batch->segment[s].count) return k + 1;
    for (s++; s < SCREE_SEGMENTS; s++)
        if (batch->segment[s].count) return batch->segment[s].first;
    return -1;
}

static inline int scree_first(const struct scree_batch *batch) {
    for (int s = 0; s < SCREE_SEGMENTS; s++)
        if (batch->segment[s].count) return batch->segment[s].first;
    return -1;
}

/* Contacts of a block of segment 0. */
static inline int scree_contacts_in_block(const struct scree_batch *batch, int block) {
    int left = batch->segment[0].count - block * SCREE_LANES;
    return left < SCREE_LANES ? left : SCREE_LANES;
}

/* Number m of what laws keep of contact k. */
static inline double scree_kept(const struct scree_batch *batch, int m, int k) {
    if (m == SCREE_KEPT_STATE) return batch->slides && batch->slides[k] ? 1.0 : 0.0;
    return batch->kept[m] ? batch->kept[m][k] : 0.0;
}

/* Keep it, if the laws do. */
static inline void scree_keep(const struct scree_batch *batch, int m, int k, double value) {
    if (m == SCREE_KEPT_STATE && batch->slides) batch->slides[k] = value > 0.0;
    if (batch->kept[m]) batch->kept[m][k] = value;
}

/* Whether contact k is any other than one that is new. */
static inline int scree_keeps_something(const struct scree_batch *batch, int k) {
    for (int m = 0; m < SCREE_MEMORY; m++)
        if (scree_kept(batch, m, k) != 0.0) return 1;
    for (int m = 0; batch->impulses && m < SCREE_PAST; m++)
        if (batch->past[m][k] != 0.0) return 1;
    return 0;
}

/* Pair constant c of contact k. */
static inline double scree_pair(const struct scree_batch *batch, int c, int k) {
    return batch->pair[c][batch->uniform ? 0 : k];
}

/* Two balls of one size turn by the same lever, and only the sum of their spins counts, unless they roll on torques of
 * their own; that takes fewer operations. It depends on the scene alone: roundings differ. Slopes of friction ask for
 * masses, which then aren't at hand. */
static inline int scree_goes_even(const struct scree_bodies *bodies, const struct scree_batch *batch, int rolls) {
    int balls = batch->geometry == SCREE_BALL_BALL || batch->geometry == SCREE_BALL_IMAGE;
    return bodies->even > 0.0 && balls && !rolls && batch->slope == 0.0;
}

/* Sums of a segment, before they are added to the scene's in the order of segments. */
struct scree_tally {
    double lost_normal, work_tangential;
    double deepest, steepest; /* as in scree_contacts; places of the bodies, -1: none that is deeper */
    int deepest_ball, deepest_host, steepest_ball, steepest_host;
    int too_far; /* a body has outgrown its margin */
};

/* Contact by contact: the sum mustn't depend on how they fall into blocks. */
static inline void scree_tally_losses(struct scree_tally *tally, const struct scree_losses *lost, int count) {
    for (int k = 0; k < count; k++) {
        tally->lost_normal += lost->normal[k];
        tally->work_tangential += lost->tangential[k];
    }
}

/* All bodies are looked over in so many parts, by as many threads; the order of what they find doesn't depend on
 * these. */
enum { SCREE_PARTS = 32 };

/* Where the bodies of a part begin. */
static inline int scree_part_begin(const struct scree_bodies *bodies, int part) {
    return (int)((long)bodies->count * part / SCREE_PARTS);
}

/* Partners that a part has found, as numbers: ~k, then all that body k has found. */
struct scree_found {
    size_t first;        /* its share of the memory */
    int count, capacity; /* numbers */
    int partners;        /* those that aren't ~k */
};

/* Memory whose contents are needed no longer than until it is asked for anew. */
struct scree_space {
    void *memory;
    size_t size;
};

/* A body that returns into the periodic box: it is `periods` beyond it. */
struct scree_return {
    int body; /* its place */
    int periods[3];
    double from[3], ahead[3]; /* where its state and its record were, m */
};

/* A sleeper that somebody may push, and what still contacts do to it in a step, N s and N m s. */
struct scree_borderer {
    int body;
    double impulse[3], turn[3];
};

/* Bodies that sleep (rest.h). */
struct scree_rest {
    double speed; /* m/s, below which bodies rest; 0: none ever sleeps */
    double pull;  /* m/s^2 that forces may be off balance when they fall asleep; a quarter of what wakes them */
    int asleep;   /* bodies */
    int stale;    /* lists or sleepers aren't what they were when contacts were last looked through */
    int borderers, *on_border; /* [place]: number in `border` and one, 0: not on it */
    struct scree_borderer *border;
};

/* Lists where bodies fly (flight.c). */
struct scree_flights {
    double sweep; /* the most that a flight leads away from the mean one until outer lists are made anew, m */
    /* By which flights that lead past each other may lead apart less than straight away, in half a step, m. */
    double bend;
    double wander; /* m/s, off their flights at the end of the last ones, on the mean */
    double ahead;  /* s that the list being made looks ahead */
    double flown;  /* s since outer lists were made; */
    double until;  /* when near lists must be made anew, */
    double last;   /* and outer ones */
};

struct scree_contacts {
    const struct scree_loop *loop, *loop_for_few; /* for this processor; */
    int in_hand;                                  /* whether the loop keeps the sums of bodies at hand, there */
    int cached;                                   /* bodies that stay in its third cache */
    int materials;
    int rules;
    struct scree_rule *rule;
    int *rule_of; /* [materials x materials]: index of the rule, -1 if none is defined */
    int batches;
    struct scree_batch *batch;
    int *batch_of; /* [rules x SCREE_GEOMETRIES]: index of the batch */
    int *busy;     /* indices of the batches that hold contacts */
    int busy_batches;

    /* What making lists takes; each has one use after the other:
     *           while pairs are sought (candidates.c)          afterwards
     *   listed  the pairs as they are found, by parts (found)  the outer lists of all batches
     *   rough   the cells, then the pairs in order             numbers of bodies or contacts that nobody keeps
     * Rough has room for two numbers a body, or more. */
    struct scree_space listed, rough;
    struct scree_found found[SCREE_PARTS];
    int pairs, *end, *partner; /* in rough: the larger bodies of each body's pairs, and where these end */
    int planes, *plane;        /* bodies without bounds */
    double skin;          /* contacts with a gap up to this are in the outer list, m; each body may use up half of it */
    double chosen_skin;   /* the same; limits and the order of bodies go by it, whatever lists are made with */
    double most_margin;   /* a few fast bodies may use up more than half the skin: up to this, m; */
    double widest_margin; /* and that is the most that one has */
    double step;          /* s; margins of near lists are reckoned in steps (0, adaptive: as wide as the skin) */
    /* Per body: way that its margin may still take out of what the outer list leaves it, m; and in the same memory,
     * while pairs are sought, for margins are made anew behind it: where it is in the cells (candidates.c). */
    union {
        float *spare;
        int *seat;
    };
    struct scree_gate *gate; /* scree_gates_of the strips of slabs whose lists are as they were then: */
    unsigned char gated[SCREE_SLABS];
    /* [place]: a member of a stretch's first slab (SCREE_STRETCH), with contacts in the one before; and in the same
     * memory, while outer lists are made, for it is marked anew behind them: one that comes first in contacts of
     * segment 0. */
    union {
        unsigned char *lent;
        unsigned char *has_loose;
    };
    /* Where bodies are few: the margin that each should have at most, m, and pairs of boxes in the outer list. */
    double *widest;
    struct scree_space boxes;
    int box_pairs;
    struct scree_flights flights;
    double lasting; /* steps that margins are to last, where bodies are many */
    int broken;     /* for lack of memory lists are incomplete: all must be made before contacts are looked at */
    long rebuilds;  /* of the outer list */
    long renewals;  /* of near lists */
    long answers;   /* margins of single bodies since the beginning; */
    long enough;    /* when they are so many, the near lists are to be renewed */
    int extended;   /* how often the outer list has been extended for a body that went farther (widen.c) */
    int stays;      /* whether it is known where the bodies of slabs may be meanwhile: */
    struct scree_stay stay[SCREE_SLABS];
    struct scree_sweep sweep;
    struct scree_tally tally[SCREE_SWEEP][SCREE_SEGMENTS]; /* of each step of a sweep (else the first), each segment */
    struct scree_scratch *scratch;                         /* one for each thread (near.c) */
    int scratches;
    int returns, return_capacity; /* bodies that are returning into the periodic box, by rising place */
    struct scree_return *returned;
    int moving_capacity;
    struct scree_moving *moving; /* scratch for contacts that change their batch on it (reorder.c) */

    struct scree_rest rest;
    int substeps;           /* of the pair-impulse method */
    int measured;           /* sum up dissipation */
    double lost_normal;     /* J dissipated in normal direction so far */
    double work_tangential; /* J done against friction and rolling resistance so far */

    double deepest; /* largest overlap over tolerable overlap so far; and whose, by their numbers */
    int deepest_ball, deepest_host;
    double steepest; /* largest scree_yield.steep so far */
    int steepest_ball, steepest_host;
};

/* For a scene of so many bodies and materials; the rules are copied. */
scree_status scree_contacts_create(struct scree_contacts *contacts, int bodies, int materials,
                                   const struct scree_rule *rules, int rule_count, scree_trouble *trouble);
void scree_contacts_destroy(struct scree_contacts *contacts);

/* The rule for two bodies, NULL if forces can move neither, if their shapes never meet, or if their materials pass
 * through each other. `missing` (may be NULL) is set to 1 if the two could meet and no rule is defined. */
const struct scree_rule *scree_contacts_rule(const struct scree_contacts *contacts, const struct scree_bodies *bodies,
                                             int i, int j, int *missing);

/* How far lists look, and at most for fast bodies: wide where bodies are `few` or fewer (lists cost little, making them
 * anew does), narrow where they are many; always beyond `reach`, m, of the laws. Before the first list. */
void scree_contacts_choose_skin(struct scree_contacts *contacts, const struct scree_bodies *bodies, int few,
                                double reach);

/* Make outer and near lists from the records as they are; carries contact memory over, gives every body its margin:
 * its `path` is set so that it reaches half the skin when lists must be looked at. SCREE_NO_MEMORY: the lists
 * can't be used (`broken`), but what is kept of contacts is all there. */
scree_status scree_contacts_list(struct scree_contacts *contacts, struct scree_bodies *bodies, int threads,
                                 scree_trouble *trouble);

/* Note how deep boxes are in each other, whatever their contacts say of it: a run must not go on as if nothing had
 * happened. Of pairs in lists that hold. */
void scree_contacts_note_boxes(struct scree_contacts *contacts, const struct scree_bodies *bodies);

/* After bodies have outgrown their margins (path > skin/2): pick all near contacts anew from the outer list, or make
 * both lists anew if bodies have used up what the outer one left them and it isn't to be extended for them, or if they
 * are broken. */
scree_status scree_contacts_renew(struct scree_contacts *contacts, struct scree_bodies *bodies, int threads,
                                  scree_trouble *trouble);

/* The bodies that have outgrown their margins, by their places, if all can be answered alone (widen.c): how many they
 * are. 0: the lists are to be renewed. */
enum { SCREE_ASKING = 32 };
int scree_contacts_asking(const struct scree_contacts *contacts, const struct scree_bodies *bodies, int threads,
                          int asking[SCREE_ASKING]);

/* Give these new margins, and put what comes near by them into the near lists. Otherwise as scree_contacts_renew. */
scree_status scree_contacts_answer(struct scree_contacts *contacts, struct scree_bodies *bodies, const int *asking,
                                   int count, int threads, scree_trouble *trouble);

/* Put the bodies in the order of space, and the lists with them; the second only if they have got out of it. */
scree_status scree_contacts_sort(struct scree_contacts *contacts, struct scree_bodies *bodies, int threads,
                                 scree_trouble *trouble);
scree_status scree_contacts_keep_order(struct scree_contacts *contacts, struct scree_bodies *bodies, int threads,
                                       scree_trouble *trouble);

/* For a restored state: room for so many contacts in a batch, some with corners (or not); then forget all contacts, and
 * append one with its memory, in the list's order. The next list carries it over. `kept` counts if the batch has
 * memory, `past` if it keeps impulses. */
scree_status scree_contacts_reserve(struct scree_batch *batch, int count, int corners, scree_trouble *trouble);
void scree_contacts_forget(struct scree_contacts *contacts);
void scree_contacts_remember(struct scree_batch *batch, const struct scree_bodies *bodies,
                             const struct scree_contact *contact, const double *kept, const double *past);

/* How the members of slabs (bodies/order.c) move on as soon as all their impulses are there: to the end of the step,
 * and if `ahead` is set to the middle of the next step at once. */
struct scree_departure {
    double step, margin;
    double gravity[3]; /* in the middle of this step, and of the next one */
    double next_gravity[3];
    int ahead;
    double to_come; /* steps for which margins should do, at the speed of this one: half a step, or a sweep after it */
    int steps;      /* in one sweep: 1, or up to scree_steps_in_sweep; gravity is the same in all */
    int by_moments; /* of pair impulses; 0: by Verlet's method */
};

/* All near contacts through the loop for one step of length `step`, or the steps of a sweep: impulses are added into
 * the bodies' records. `go` NULL: nobody moves. Returns 1 if one that went ahead has outgrown its margin, as
 * scree_bodies_look_ahead does. If `sweep.steps` isn't 0 then, the sweep has stopped on its way: it goes on from there
 * with the next call, before which lists must be renewed. */
int scree_contacts_act(struct scree_contacts *contacts, struct scree_bodies *bodies, double step, int threads,
                       const struct scree_departure *go);

/* How many steps slabs may go through in one sweep, and gain by it: a part of SCREE_SWEEP where the third cache holds
 * what is under way but not the whole scene, else 1. */
int scree_most_in_sweep(const struct scree_contacts *contacts, const struct scree_bodies *bodies);

/* The same now: 1 while bodies fly (flight.c), or slabs with another one between them might meet. */
int scree_steps_in_sweep(struct scree_contacts *contacts, const struct scree_bodies *bodies);

/* By how many steps a body is ahead of where the sweep that stopped on its way began. */
int scree_steps_ahead(const struct scree_contacts *contacts, const struct scree_bodies *bodies, int k);

/* Step by pair impulses (impulse.c) instead: call it before the first list. `substeps` times as many per step and
 * contact as its stiffness asks for; 0: so many, with friction two where one isn't enough. */
void scree_contacts_keep_impulses(struct scree_contacts *contacts, int substeps);

/* Give contacts and bodies the past of a state at rest: the forces of `now` for two steps. For the start of a run. */
void scree_contacts_begin_past(struct scree_contacts *contacts, struct scree_bodies *bodies,
                               const struct scree_bodies *now, double step);

/* What pairs have to know of bodies before such a step: as scree_bodies_look_both, of the first `count` balls and of
 * all others; where balls are at its start is shown later, to whom it concerns (starts.h). */
int scree_contacts_look_both(struct scree_contacts *contacts, struct scree_bodies *bodies, int count, double time,
                             double step, const double gravity[3], double margin, struct scree_bodies *now,
                             int threads);

/* The first `count` bodies to its end, as scree_bodies_advance_by_moments. */
void scree_contacts_advance_by_moments(struct scree_contacts *contacts, struct scree_bodies *bodies, int count,
                                       double time, double step, const double gravity[3], int threads);

/* Contacts first … first + count - 1, a window of blocks or less, through such a step: what the contacts of each block
 * yield, and bits of those that went one by one (impulse.c). */
void scree_impel_window(const struct scree_contacts *contacts, const struct scree_bodies *bodies,
                        const struct scree_bodies *now, const struct scree_batch *batch, int first, int count,
                        double step, struct scree_yield *yield, struct scree_moments *moments, uint32_t *odd);

/* All near contacts through one step by pair impulses (impel.c): `bodies` half a step ahead, `now` all but free
 * balls at its start (scree_contacts_look_both before). Impulses and moments are added to the bodies. `go` and
 * what is returned: as with scree_contacts_act. */
int scree_contacts_impel(struct scree_contacts *contacts, struct scree_bodies *bodies, const struct scree_bodies *now,
                         double step, int threads, const struct scree_departure *go);

/* A contact as measured at the instant of the records, without changing anything. Vectors in the world. */
struct scree_touch {
    int ball, host, corner;
    int edges;               /* `corner` is the code of two edges */
    double overlap, closing; /* m, m/s */
    double normal_force;     /* N */
    double load; /* what of it friction and rolling count from, N (scree_borne, scree_relief); 0 if it pulls */
    double stored, stored_in_friction; /* J, in normal direction; in the springs of friction and rolling */
    struct vec normal;                 /* from the host towards the ball */
    struct vec point;                  /* middle of the overlap, m */
    struct scree_gradient lean;        /* of boxes, what one newton of the normal force does besides (scree_lean_of) */
    struct vec slip;                   /* tangential velocity of the ball, m/s */
    struct vec tangential;             /* friction force on the ball, N */
    struct vec torque;                 /* of the rolling law on the ball, N m */
    struct vec stretch;                /* of the tangential spring, m */
    int sliding;
};

/* Measure contact `index` of batch `batch`; returns 1 if it touches, else 0. `bodies` may be a shadow. */
int scree_contacts_measure(const struct scree_contacts *contacts, const struct scree_bodies *bodies, int batch,
                           int index, struct scree_touch *touch);

/* What crossings of edges take off the corner of a box on another box, N (relief.c). `boxes`: drawn in where they are
 * deep (scree_deep_boxes_of). */
double scree_relief(const struct scree_bodies *bodies, const struct scree_rule *rule,
                    const struct scree_contact *contact, const struct scree_two_boxes *boxes);

/* Whether a contact is one of those. */
int scree_may_be_relieved(const struct scree_bodies *bodies, const struct scree_contact *contact);

/* What contact `index` of batch `batch` does within a step if it goes on as at the instant of the records, N s and N m
 * s; `ball` is -1 if it doesn't touch. Changes nothing. */
struct scree_kick {
    int ball, host;
    double overlap;                           /* m */
    struct vec impulse, turn_ball, turn_host; /* the first on the ball, the opposite on the host */
    struct vec straight;                      /* the impulse less what boxes do besides (scree_lean_of) */
};
struct scree_kick scree_kick_now(const struct scree_contacts *contacts, const struct scree_bodies *bodies, int batch,
                                 int index, double step);

/* Leave in the records the impulses that contacts give at their instant within a step, for the start of a run: from
 * them the first step predicts its velocities, and bodies that begin at rest in touch stay at rest. */
void scree_contacts_begin(const struct scree_contacts *contacts, struct scree_bodies *bodies, double step);

/* Effective mass and radius of a pair of bodies, for law constants: of the ball and its partner. */
double scree_effective_mass(const struct scree_bodies *bodies, int i, int j);
double scree_effective_radius(const struct scree_bodies *bodies, int ball, int host, enum scree_geometry geometry);

/* ---- between the files of this folder ---- */

/* How deep the ball of a body, of this radius, can be in a rectangle before the whole body is below it, m; `corner` 0:
 * a sphere. */
static inline double scree_thickness(const struct scree_bodies *bodies, int ball, int corner, double radius) {
    return radius + (corner ? 2.0 * bodies->spin[ball].limit : radius);
}

/* Whether the contact can turn its bodies. It depends on the contact alone: what else is listed must not change a
 * bit. */
static inline int scree_contact_turns(const struct scree_batch *batch, const struct scree_contact *contact) {
    return batch->turns || (contact->corner > 0 && batch->geometry != SCREE_BALL_IMAGE);
}

/* Periods by which a partner stands off, as one number and back. */
enum { SCREE_MOST_PERIODS = 511 };

static inline int scree_code_of(const int periods[3]) {
    int code = 0;
    for (int axis = 0; axis < 3; axis++) code = (code << 10) | ((periods[axis] + SCREE_MOST_PERIODS + 1) & 1023);
    return code;
}

static inline int scree_periods_of(int code, int axis) {
    return ((code >> (10 * (2 - axis))) & 1023) - SCREE_MOST_PERIODS - 1;
}

/* The whole periods in a way along an axis that lead nearest to its end; 0 where it doesn't repeat. Most ways are
 * short, and need no division. */
static inline double scree_periods_in(const struct scree_bodies *bodies, double way, int axis) {
    double period = bodies->period[axis];
    return period > 0.0 && fabs(way) > 0.4 * period ? floor(way / period + 0.5) : 0.0;
}

/* If a free body is out of the periodic box by more than its width, put all that have left it back, and make the lists
 * anew; how many they are is in `returns` then. SCREE_NO_MEMORY: nothing was changed, in every bit. */
scree_status scree_contacts_return(struct scree_contacts *contacts, struct scree_bodies *bodies, int threads,
                                   scree_trouble *trouble);

/* Let contacts of the bodies in `returned` name the images that they mean now, in the batches that these belong to.
 * Lists are to be made after it. */
scree_status scree_contacts_recode(struct scree_contacts *contacts, const struct scree_bodies *bodies,
                                   scree_trouble *trouble);

/* Add what a block of segment 0 has yielded to its bodies and to the scene's sums, contact by contact. */
void scree_contacts_collect(struct scree_contacts *contacts, struct scree_bodies *bodies,
                            const struct scree_batch *batch, int block);

/* Keep the largest value so far, and whose it was: bodies by their places. */
static inline void scree_note(double value, const struct scree_bodies *bodies, int ball_place, int host_place,
                              double *largest, int *ball, int *host) {
    if (value <= *largest) return;
    *largest = value;
    *ball = bodies->number[ball_place];
    *host = bodies->number[host_place];
}

/* Slabs go in stretches of so many (slabs.c). */
enum { SCREE_STRETCH = 3 };

/* Bodies at places from … to - 1. */
struct scree_places {
    int from, to;
};

/* From one piece of a slab's contacts of two balls to the next: by pair impulses bodies before place `prefetched`
 * have been asked for; so many contacts come behind the piece; the slab is next to another thread's; the step comes
 * after `lap` others of its sweep. */
struct scree_trail {
    int prefetched, behind, at_border, lap;
    int asked;                  /* the bodies of the piece have been asked for, */
    struct scree_places ask[2]; /* and these of the slab and of the next one are to be, for the next piece */
};

/* The first place that a contact has to do with, and the last one. */
static inline int scree_first_of(const struct scree_ends *contact) {
    return contact->ball < contact->host ? contact->ball : contact->host;
}

static inline int scree_last_of(const struct scree_ends *contact) {
    return contact->ball > contact->host ? contact->ball : contact->host;
}

/* Work off the segments of the slabs by as many threads, piece by piece (slabs.c); tallies are added up. `trail`: from
 * piece to piece of a segment; `go`: NULL where nobody moves. Returns 1 if a body that moved ahead has outgrown its
 * margin. */
typedef void scree_segment_work(void *argument, struct scree_contacts *contacts, struct scree_bodies *bodies,
                                const struct scree_batch *batch, int first, int count, double step,
                                struct scree_tally *tally, struct scree_trail *trail);
int scree_contacts_by_slabs(struct scree_contacts *contacts, struct scree_bodies *bodies, double step, int threads,
                            scree_segment_work *work, void *argument, const struct scree_departure *go);

/* Find out where the bodies of slabs may be until the next outer list, if it isn't known. */
void scree_find_stays(struct scree_contacts *contacts, const struct scree_bodies *bodies);

/* Which segment a contact belongs to. */
int scree_segment_of(const struct scree_bodies *bodies, const struct scree_batch *batch,
                     const struct scree_contact *contact);

/* The order of contacts in a segment; negative: a before b. In a slab's segment by the body that comes first, so that
 * memory is walked; else by ball, partner, corner. */
static inline uint64_t scree_rank(const struct scree_contact *contact, int segment) {
    int swap = segment > 0 && contact->host < contact->ball;
    int first = swap ? contact->host : contact->ball, second = swap ? contact->ball : contact->host;
    return (uint64_t)first << 32 | (uint64_t)second;
}

static inline int scree_compare_contacts(const struct scree_contact *a, const struct scree_contact *b, int segment) {
    uint64_t one = scree_rank(a, segment), other = scree_rank(b, segment);
    int order = (one > other) - (one < other), corner = (a->corner > b->corner) - (a->corner < b->corner);
    return segment > 0 ? order : 2 * order + corner; /* without branches on the order, which is a matter of chance */
}

/* How far two bodies may still go, both together, before one of them asks for a list, m. */
static inline double scree_left_of(const struct scree_contacts *contacts, const struct scree_bodies *bodies, int i,
                                   int j) {
    double half = 0.5 * contacts->skin;
    return (half - bodies->path[i]) + (half - bodies->path[j]);
}

/* The velocity of a body's flight, m/s. */
static inline struct vec scree_flight_of(const struct scree_bodies *bodies, int k) {
    const float *row = scree_flight_row(bodies, k);
    return vec((double)row[0], (double)row[1], (double)row[2]);
}

/* The way that flights lead body i relative to body j within the time that the list being made looks ahead, m. */
static inline struct vec scree_flown(const struct scree_contacts *contacts, const struct scree_bodies *bodies, int i,
                                     int j) {
    if (!bodies->flight) return vec(0.0, 0.0, 0.0);
    return vec_scale(contacts->flights.ahead, vec_sub(scree_flight_of(bodies, i), scree_flight_of(bodies, j)));
}

/* The square of the least distance on the way, from `apart` on. */
static inline double scree_nearest2(struct vec apart, struct vec way) {
    double share = -vec_dot(apart, way) / (vec_norm2(way) + 1e-300);
    share = share < 1.0 ? share : 1.0;
    return vec_norm2(vec_axpy(apart, share > 0.0 ? share : 0.0, way));
}

/* For outer lists that are about to be made: give bodies flights if they are `many` and fast. SCREE_NO_MEMORY. */
scree_status scree_flights_choose(struct scree_contacts *contacts, struct scree_bodies *bodies, int many,
                                  scree_trouble *trouble);

/* Whether bodies have flown farther, with the next step, than near lists have looked ahead. */
static inline int scree_flights_over(const struct scree_contacts *contacts) {
    return contacts->flights.flown + contacts->step > contacts->flights.until;
}

/* The gap between a ball and its partner, as far as lists need it: exact while it is below `way`. What is above it
 * can't touch before the bodies have gone as much, both together. `overlap`: of the cores of two boxes
 * (scree_cores_overlap). */
double scree_gap(const struct scree_bodies *bodies, const struct scree_contact *contact, double way, double overlap);

/* Near lists from the outer list. */
scree_status scree_contacts_pick(struct scree_contacts *contacts, const struct scree_bodies *bodies, int threads,
                                 scree_trouble *trouble);

/* Whether a contact of the outer list may touch before one of its bodies has used up its margin. */
int scree_contact_is_near(const struct scree_contacts *contacts, const struct scree_bodies *bodies,
                          const struct scree_batch *batch, const struct scree_contact *contact);

/* Give a body a new margin, in the place of what is left of the last one, or what it went beyond. 0: the outer list has
 * left it too little. */
int scree_grant_anew(struct scree_contacts *contacts, const struct scree_bodies *bodies, int k);

/* A margin for such a body after the outer list has been extended, so that it may go `more`, m. */
int scree_grant_more(struct scree_contacts *contacts, const struct scree_bodies *bodies, int k, double more);

/* So often the outer list is extended; by then a new one costs less than going on. */
enum { SCREE_MOST_EXTENDED = 256 };

/* Extend the outer list by what a body needs to go farther, and give it a margin (widen.c). 0: all lists are to be made
 * anew. */
int scree_contacts_extend(struct scree_contacts *contacts, struct scree_bodies *bodies, int k);

/* Note how far behind `first` its partner lies; the next slab begins at place `next`. */
void scree_widen_reach(struct scree_part *segment, int first, int partner, int next);

/* Where segment s is the last of a stretch: mark the later body of its contact as lent to it, if that one is of the
 * next stretch. */
void scree_lend(struct scree_contacts *contacts, const struct scree_bodies *bodies, int s,
                const struct scree_contact *contact);

/* Free the scratch of near.c. */
void scree_contacts_free_scratch(struct scree_contacts *contacts);

/* Constants of the laws for each pair of bodies, where they aren't all the same. */
scree_status scree_pair_constants(const struct scree_contacts *contacts, const struct scree_bodies *bodies,
                                  struct scree_batch *batch, scree_trouble *trouble);

/* Those of a contact that has been put into segment s, at `place`. */
void scree_insert_constants(const struct scree_contacts *contacts, const struct scree_bodies *bodies,
                            struct scree_batch *batch, int s, int place);

/* More room in an array of `before` things of `size` bytes; 0 if there is no memory, and then it stays as it was. What
 * is new is zero. `array` is the address of a pointer. */
int scree_enlarge(void *array, int before, int after, size_t size);

/* Room for so many bytes, whatever was there before; SCREE_NO_MEMORY. */
scree_status scree_make_space(struct scree_space *space, size_t size, scree_trouble *trouble);

/* Pairs of bodies whose bounds come as near as margins and flights may bring them before the next list, in order: those
 * of i with j > i are partner[end[i - 1]] … partner[end[i] - 1]. */
scree_status scree_candidates(struct scree_contacts *contacts, const struct scree_bodies *bodies, int threads,
                              scree_trouble *trouble);

/* Batch for a rule and a geometry. */
static inline struct scree_batch *scree_batch_for(const struct scree_contacts *contacts, const struct scree_rule *rule,
                                                  enum scree_geometry geometry) {
    long index = rule - contacts->rule;
    return &contacts->batch[contacts->batch_of[index * SCREE_GEOMETRIES + geometry]];
}

#endif
