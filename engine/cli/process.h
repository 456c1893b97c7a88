/* The process model in the planner's loop: the scene of a comb, a product and two slide surfaces, with the comb's
 * stroke given by a profile. The scene file says what touches how; here its numbers are set from the task, and the
 * outcome is measured. */
#ifndef SCREE_CLI_PROCESS_H
#define SCREE_CLI_PROCESS_H

#include "engine/scree.h"
#include "solver/sensitivity.h"

/* How product and tines meet: as boxes, corners and edges; with the product's corner spheres alone; or, the tines
 * standing between the corners, with edges on edges alone, which bear a face by eight points instead of four. */
enum process_contact { PROCESS_BOXES, PROCESS_CORNERS, PROCESS_EDGES };

/* What the scene is made from. SI units. */
struct process {
    char *text, *name; /* of the scene file, owned */
    size_t size;
    int contact[3];                                      /* of the product with surfaces, rear and front tines */
    double length, depth, height, mass;                  /* product: along x, across, upwards, m; kg */
    double gap;                                          /* clear distance between rear and front tines, m */
    double distance;                                     /* of the transport, m: the surfaces are long enough for it */
    double start;                                        /* the product's lead before the rear tines at the start, m */
    double static_friction, kinetic_friction, threshold; /* product on surface; threshold m/s */
    double tine_stiffness, tine_restitution;             /* of all tines that one product meets, N/m */
    double surface_stiffness;                            /* of all that carry it, N/m */
    double gravity;                                      /* m/s^2 */
    double step;                                         /* largest step, s */
    enum process_contact contacts;
};

/* The scene of a task from the scene file at `path`: the standard product, tines and surfaces, changed where `task`
 * says so. SCREE_BAD_INPUT names what the file lacks of the bodies, motions and contacts of data/scenes/transport.toml.
 * To be freed with process_free, whether or not this fails. */
scree_status process_load(struct process *process, const char *path, const scree_transport *task,
                          scree_trouble *trouble);

/* Whether the scene can be made and run with the numbers that `process` has now, and its tines do what a profile
 * says. */
scree_status process_check(const struct process *process, scree_trouble *trouble);

/* SCREE_FAILED if a run takes more steps than anyone could wait for: a stroke of `duration` (s), and the time in which
 * friction stops what a comb of at most `fastest` (m/s) has thrown. */
scree_status process_check_length(const struct process *process, double duration, double fastest,
                                  scree_trouble *trouble);

void process_free(struct process *process);

/* State of the model at one instant. */
struct process_sample {
    double time, comb, comb_velocity, product, product_velocity; /* product: its rear face */
    double push, catch_force;                                    /* of rear and front tines on it, N */
};

/* One whole run with rear and front tines. */
struct process_run {
    double error;                   /* final position of the product beyond the target, m */
    double approach;                /* relative speed at the first touch of the front tines, m/s; 0: none */
    double touched;                 /* s, when; 0: never */
    double catch_force, push_force; /* largest, N */
    void (*watch)(void *context, const struct process_sample *sample); /* called every `every` seconds; may be NULL */
    void *context;
    double every;
    scree_trouble trouble;
};

/* Formulation C's view of the model (a scree_process; `context` is a struct process): the state at `until`, front tines
 * off. */
int process_catch(void *process, const struct scree_profile *profile, double until, scree_catch *result);

/* Run the profile with all tines until the product rests; `target` is its wanted final position, m. SCREE_FAILED if it
 * hasn't come to rest in the time that friction needs for the fastest slide, or that takes too many steps. */
scree_status process_simulate(const struct process *process, const struct scree_profile *profile, double target,
                              struct process_run *run);

#endif
