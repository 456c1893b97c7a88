/* Lists of bodies that flow: neighbours go the same way, and come near each other far slower than they go. So a body
 * uses up its margin only by what it goes off its flight, which is straight, at the velocity that it had when the outer
 * lists were made; and lists look at where pairs fly until a certain time. No result depends on it. */
#include "bodies/memory.h"
#include "contact/contacts.h"

enum { SAMPLES = 4096, MOST_STEPS = 2000 };

/* Of some thousands of the members: mean velocity and speed, mean deviations from that velocity and from the flights so
 * far, m/s. */
struct swarm {
    struct vec velocity;
    double speed, apart, off;
};

static struct swarm survey(const struct scree_bodies *bodies) {
    int first = bodies->order.members, stride = 1 + (bodies->count - first) / SAMPLES, some = 0;
    struct swarm swarm = {.speed = 0.0};
    for (int k = first; k < bodies->count; k += stride, some++) {
        swarm.velocity = vec_add(swarm.velocity, vec_from(bodies->record[k].v));
        swarm.speed += vec_norm(vec_from(bodies->record[k].v));
    }
    swarm.velocity = vec_scale(1.0 / some, swarm.velocity);
    swarm.speed /= some;
    for (int k = first; k < bodies->count; k += stride)
        swarm.apart += vec_norm(vec_sub(vec_from(bodies->record[k].v), swarm.velocity)) / some;
    for (int k = first; k < bodies->count; k += stride) {
        double off = vec_norm(vec_sub(vec_from(bodies->record[k].v), scree_flight_of(bodies, k)));
        swarm.off += fmin(off, swarm.apart) / some; /* a few fast ones don't count for all */
    }
    return swarm;
}

/* Whether there are bodies that don't fly; but for planes, which are looked for anywhere. */
static int any_grounded(const struct scree_bodies *bodies) {
    int any = 0;
    for (int k = 0; k < bodies->count && !any; k++)
        any = bodies->class[k] != SCREE_CLASS_BALL && scree_kind_of(bodies, k)->shape.kind != SCREE_PLANE;
    return any;
}

/* Of spheres. */
static double least_radius(const struct scree_bodies *bodies) {
    double least = HUGE_VAL;
    for (int k = 0; k < bodies->count; k++)
        if (scree_kind_of(bodies, k)->shape.kind == SCREE_SPHERE && bodies->record[k].radius < least)
            least = bodies->record[k].radius;
    return least;
}

/* The velocity of a body's flight: off the mean one by `most` at most. */
static struct vec course_of(const struct scree_bodies *bodies, int k, struct vec mean, double most) {
    if (bodies->class[k] != SCREE_CLASS_BALL) return vec(0.0, 0.0, 0.0);
    struct vec apart = vec_sub(vec_from(bodies->record[k].v), mean);
    double speed = vec_norm(apart);
    return vec_axpy(mean, speed > most ? most / speed : 1.0, apart);
}

/* The faster flights lead apart, the shorter outer lists look ahead; what doesn't fly is off the mean velocity by as
 * much as that is off zero. */
static void set_out(struct scree_contacts *contacts, struct scree_bodies *bodies, const struct swarm *swarm,
                    double wander) {
    struct vec mean = swarm->velocity;
    double sweep = fmin(0.75 * contacts->skin, contacts->most_margin), most = 2.0 * swarm->apart;
    if (any_grounded(bodies)) most = fmax(most, vec_norm(mean));
    double last = fmin(sweep / most, MOST_STEPS * contacts->step), across = most * contacts->step;
    contacts->flights = (struct scree_flights){.sweep = most * last * (1.0 + 1e-6), /* flights are rounded */
                                               .bend = across * across / (4.0 * least_radius(bodies)),
                                               .wander = wander,
                                               .ahead = last,
                                               .last = last};
    for (int k = 0; k < bodies->count; k++) {
        struct vec course = course_of(bodies, k, mean, most);
        bodies->flight[k][0] = (float)course.x;
        bodies->flight[k][1] = (float)course.y;
        bodies->flight[k][2] = (float)course.z;
    }
}

/* How far off their flights bodies are to be expected soon, m/s: as at the end of the last ones, if those were long. */
static double wander_of(const struct scree_flights *last, const struct swarm *swarm, int flew) {
    if (!flew) return 0.25 * swarm->apart;
    return last->flown > 0.25 * last->last ? swarm->off : last->wander;
}

/* Bodies that hardly move need no flights: their margins are within twice the least (list.c). Those that may fall
 * asleep can't stay on them. Nor do bodies set out while some are a step ahead of others (sweep.c), but right after.
 * And pair impulses dismiss what can't touch so soon that a longer list costs less than flights. */
scree_status scree_flights_choose(struct scree_contacts *contacts, struct scree_bodies *bodies, int many,
                                  scree_trouble *trouble) {
    struct swarm swarm = {.speed = 0.0};
    int flew = bodies->flight != NULL, sweeps = contacts->sweep.steps > 0;
    if (many && !bodies->calm && !bodies->past) swarm = survey(bodies);
    double wander = wander_of(&contacts->flights, &swarm, flew);
    contacts->flights = (struct scree_flights){.until = HUGE_VAL, .last = HUGE_VAL};
    int fast = swarm.speed * contacts->step > contacts->skin / 8000.0 && isfinite(swarm.apart);
    if (fast && sweeps) contacts->flights.until = contacts->flights.last = 0.0; /* lists that hold for its rest */
    if (!fast || sweeps) {
        scree_memory_free(bodies->flight);
        bodies->flight = NULL;
        return SCREE_OK;
    }
    if (!flew) bodies->flight = scree_memory((size_t)bodies->count * sizeof *bodies->flight);
    if (!bodies->flight)
        return scree_report(trouble, SCREE_NO_MEMORY, NULL, "no memory for lists of %d bodies", bodies->count);
    set_out(contacts, bodies, &swarm, wander);
    return SCREE_OK;
}
