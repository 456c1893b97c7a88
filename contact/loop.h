/* The contact loop as it was compiled for one kind of processor. */
#ifndef SCREE_CONTACT_LOOP_H
#define SCREE_CONTACT_LOOP_H

#include "contact/contacts.h"
#include "contact/starts.h"

struct scree_loop {
    const char *name;
    /* Contacts first … first + count - 1 (at most SCREE_LANES) of a batch through one step: what they yield. */
    void (*act)(const struct scree_contacts *contacts, const struct scree_bodies *bodies,
                const struct scree_batch *batch, int first, int count, double step, struct scree_yield *yield);
    /* Contacts of a slab, as many as there are, added straight to their bodies and to the tally. `trail`: as
     * scree_segment_work. */
    void (*act_straight)(const struct scree_contacts *contacts, struct scree_bodies *bodies,
                         const struct scree_batch *batch, int first, int count, double step, struct scree_tally *tally,
                         struct scree_trail *trail);
    /* Which of some pairs of spheres are near (judge.c), a bit for each; those behind the last one repeat one of them,
     * up to SCREE_LANES. */
    uint32_t (*judge)(const struct scree_contacts *contacts, const struct scree_bodies *bodies,
                      const struct scree_contact *pair, int count);
    /* Bodies from … to - 1, free or frozen balls, go on (scree_departure): those with lent[k] == wanted; NULL: all. */
    int (*move)(struct scree_bodies *bodies, int from, int to, const struct scree_departure *go,
                const unsigned char *lent, int wanted);
    /* A block of contacts through a step by pair impulses: those that are steady (steady.c), from where `bodies` are in
     * its middle, and with them those to which nothing can happen. Returns bits of their lanes; leaves the others
     * alone. */
    uint32_t (*hold_steady)(const struct scree_contacts *contacts, const struct scree_bodies *bodies,
                            const struct scree_batch *batch, int first, int count, double step,
                            struct scree_yield *yield, struct scree_moments *moments);
    /* Those that touch all through the step and nothing happens to (smooth.c), from what is shown of its start
     * (starts.h), in the slots of each; `now`: where planes are then. Likewise. */
    uint32_t (*impel)(const struct scree_contacts *contacts, const struct scree_bodies *now,
                      struct scree_starts *starts, const struct scree_ends *slot, const struct scree_batch *batch,
                      int first, int count, double step, struct scree_yield *yield, struct scree_moments *moments);
    /* The others, whatever happens to them: contacts first + lane[0 … count - 1] of a batch, of so many blocks that
     * there is a yield for each. Returns how many of them are left to within.c, and which: the first ones of `lane`. */
    int (*impel_few)(const struct scree_contacts *contacts, const struct scree_bodies *now, struct scree_starts *starts,
                     const struct scree_batch *batch, int first, int *lane, int count, double step,
                     struct scree_yield *yield, struct scree_moments *moments);
    /* Impulses of a block of them and their first moments into the bodies. Returns whether one is deeper or steeper
     * than the tally knows. */
    int (*add_up)(struct scree_bodies *bodies, const struct scree_ends *contact, int count, int turns, int hosts,
                  struct scree_yield *yield, struct scree_moments *moments, const struct scree_tally *tally);
    /* Balls among bodies from … to - 1, before and behind the contacts of such a step (pushed.c). The first: nonzero if
     * a path has outgrown the margin. */
    int (*look_both)(struct scree_bodies *bodies, int from, int to, double step, const double gravity[3],
                     double margin);
    /* What contacts ask for that aren't steady: contact[lane[0 … count - 1]], `lane` NULL: the first `count`. Their
     * bodies are shown, and slot[…] tells where. */
    void (*show)(const struct scree_bodies *bodies, const struct scree_bodies *now, const struct scree_ends *contact,
                 const int *lane, int count, double step, struct scree_ends *slot, struct scree_starts *starts);
    void (*advance_by_moments)(struct scree_bodies *bodies, int from, int to, double step, const double gravity[3]);
};

extern const struct scree_loop scree_loop_baseline, scree_loop_avx2, scree_loop_avx512;

/* The widest loop that this processor runs, or the one that the environment variable SCREE_ISA asks for (baseline,
 * avx2, avx512) if it can; all give the same bits. */
const struct scree_loop *scree_choose_loop(void);

/* The same for some few contacts, with which vectors of eight would be half empty and are slower to divide. */
const struct scree_loop *scree_choose_loop_for_few(void);

/* Whether the AVX-512 loop keeps the sums of bodies at hand on this processor: that pays on Zen 5 (a tenth of a step),
 * and costs up to as much on Zen 4, which takes vectors of eight in two halves, and on Intel's. */
int scree_sums_in_hand(void);

/* How many bodies surely stay in the third cache from step to step, at 2 kB each: four times what one needs by Verlet,
 * since others use the cache, too. So many aren't asked for ahead, which takes places from what the processor asks for
 * by itself: on an Intel Xeon whose third cache has 300 MB, 31,200 spheres in flow take 9 % less without it, pair
 * impulses of 10,000 6 to 9 %, 100,000 at rest as long as with it. */
int scree_bodies_in_cache(void);

#ifdef SCREE_LOOP /* the loop that is being compiled: its parts in other files */
#define SCREE_PART_OF(loop, part)   loop##_##part
#define SCREE_NAME_PART(loop, part) SCREE_PART_OF(loop, part)
#define SCREE_PART(part)            SCREE_NAME_PART(SCREE_LOOP, part)
uint32_t SCREE_PART(judge)(const struct scree_contacts *contacts, const struct scree_bodies *bodies,
                           const struct scree_contact *pair, int count);
uint32_t SCREE_PART(hold_steady)(const struct scree_contacts *contacts, const struct scree_bodies *bodies,
                                 const struct scree_batch *batch, int first, int count, double step,
                                 struct scree_yield *yield, struct scree_moments *moments);
uint32_t SCREE_PART(impel)(const struct scree_contacts *contacts, const struct scree_bodies *now,
                           struct scree_starts *starts, const struct scree_ends *slot, const struct scree_batch *batch,
                           int first, int count, double step, struct scree_yield *yield, struct scree_moments *moments);
int SCREE_PART(impel_few)(const struct scree_contacts *contacts, const struct scree_bodies *now,
                          struct scree_starts *starts, const struct scree_batch *batch, int first, int *lane, int count,
                          double step, struct scree_yield *yield, struct scree_moments *moments);
int SCREE_PART(add_up)(struct scree_bodies *bodies, const struct scree_ends *contact, int count, int turns, int hosts,
                       struct scree_yield *yield, struct scree_moments *moments, const struct scree_tally *tally);
int SCREE_PART(look_both)(struct scree_bodies *bodies, int from, int to, double step, const double gravity[3],
                          double margin);
void SCREE_PART(show)(const struct scree_bodies *bodies, const struct scree_bodies *now,
                      const struct scree_ends *contact, const int *lane, int count, double step,
                      struct scree_ends *slot, struct scree_starts *starts);
void SCREE_PART(advance_by_moments)(struct scree_bodies *bodies, int from, int to, double step,
                                    const double gravity[3]);
int SCREE_PART(move_by_moments)(struct scree_bodies *bodies, int from, int to, const struct scree_departure *go,
                                const unsigned char *lent, int wanted);
#endif

#endif
