/* Events of the adaptive integrator: where a law changes within a step, and clocks that make the change smooth. */
#include "bodies/elementary.h"
#include "engine/adaptive.h"

#include <math.h>
#include <string.h>

enum { TRIES = 60 };

/* Rounding of an overlap, m: those below are zero. */
static double rounding_of(const struct scree_scene *scene, const struct scree_grip *grip) {
    return 4.5e-16 * scree_grip_size(grip, &scene->bodies);
}

/* How far below zero a switch function is still zero. */
static double nothing(const struct scree_scene *scene, const struct scree_grip *grip, int which) {
    return which == SCREE_SWITCH_OVERLAP ? rounding_of(scene, grip) : fmax(1e-3 * scene->time.tolerance, 1e-13);
}

/* ---- switch functions ---- */

/* By how much views at y -+ shift x rates must be put off so that both lie between two breaks of the motions: beyond,
 * driven bodies stand still. */
static double put_off(const struct scree_scene *scene, const double *y, const double *rates, double shift) {
    const struct scree_adaptive *a = scene->adaptive;
    double now = a->start + y[Y_TIME], way = shift * rates[Y_TIME];
    if (scene->bodies.motions == 0) return 0.0;
    if (now - way < a->earliest) return fmin(a->earliest + way - now, way) / rates[Y_TIME];
    if (now + way > a->limit) return fmax(a->limit - way - now, -way) / rates[Y_TIME];
    return 0.0;
}

/* Views a little sooner and later along the motion: at y -+ shift x rates, but for the clock where that is to stay. */
static void look_along(struct scree_scene *scene, const double *y, const double *rates, double shift, int clock_stays) {
    struct scree_adaptive *a = scene->adaptive;
    double *elsewhere = a->work.stage, off = put_off(scene, y, rates, shift);
    struct scree_grip_view *now = a->view;
    for (int side = 0; side < 2; side++) {
        for (size_t i = 0; i < a->work.size; i++) elsewhere[i] = y[i] + (off + (side ? shift : -shift)) * rates[i];
        if (clock_stays) elsewhere[Y_CLOCK] = y[Y_CLOCK];
        a->view = side ? a->later : a->sooner;
        scree_adaptive_rates(scene, elsewhere, a->work.end);
    }
    a->view = now;
    scree_adaptive_place(scene, y);
}

/* How far apart in time the views around are: of the contact whose root is the clock, and of the others; 0: there are
 * none. */
struct apart {
    double own, others;
};

/* Near the begin or the end of its contact the clock hardly moves: differences over so little time tell its own contact
 * enough, whose overlap it is to all digits, but of the others nothing but rounding. */
static struct apart look_around(struct scree_scene *scene, const double *y, const double *rates) {
    struct scree_adaptive *a = scene->adaptive;
    double little = HUGE_VAL;
    int others = 0;
    for (int k = 0; k < a->grips; k++) {
        const struct scree_grip *grip = &a->grip[k];
        if (!scree_grip_needs_rates(grip)) continue;
        little = fmin(little, 1e-5 * grip->depth / grip->speed);
        others |= k != a->clock;
    }
    if (little == HUGE_VAL || (a->clock >= 0 && !(fabs(rates[Y_TIME]) > 0.0))) return (struct apart){0.0, 0.0};
    double by = little / rates[Y_TIME], most = 1e-5 * y[Y_CLOCK];
    int slow = a->clock >= 0 && fabs(by) > most;
    double own = slow ? copysign(most, by) : by, time = 2.0 * own * rates[Y_TIME];
    look_along(scene, y, rates, own, 0);
    if (!slow || !others) return (struct apart){time, time};
    struct scree_grip_view sooner = a->sooner[a->clock], later = a->later[a->clock];
    look_along(scene, y, rates, by, 1);
    a->sooner[a->clock] = sooner;
    a->later[a->clock] = later;
    return (struct apart){time, 2.0 * little};
}

/* Beside the clock an overlap that is no more than rounding tells nothing of sliders: how they begin is settled. */
static void switches_of(const struct scree_scene *scene, int k, struct apart apart, double value[SCREE_SWITCHES]) {
    const struct scree_adaptive *a = scene->adaptive;
    double own = k == a->clock ? apart.own : apart.others;
    int around = own > 0.0, begins = k != a->clock && fabs(a->view[k].overlap) <= 4.0 * rounding_of(scene, &a->grip[k]);
    scree_grip_switches(&a->grip[k], &a->view[k], around ? &a->sooner[k] : NULL, around ? &a->later[k] : NULL, own,
                        value);
    for (int w = SCREE_SWITCH_SLIDE; w < SCREE_SWITCHES && begins; w++) value[w] = 1.0;
}

void scree_adaptive_switches(struct scree_scene *scene, const double *y, const double *rates,
                             double (*value)[SCREE_SWITCHES]) {
    struct scree_adaptive *a = scene->adaptive;
    struct apart apart = look_around(scene, y, rates);
    for (int k = 0; k < a->grips; k++) switches_of(scene, k, apart, value[k]);
}

int scree_adaptive_begin(struct scree_scene *scene) {
    struct scree_adaptive *a = scene->adaptive;
    int begun = 0;
    for (int k = 0; k < a->grips; k++) {
        struct scree_grip *grip = &a->grip[k];
        const struct scree_grip_view *view = &a->view[k];
        if (grip->state != SCREE_GRIP_APART || !(view->closing > 0.0)) continue;
        if (view->overlap < -rounding_of(scene, grip)) continue;
        scree_adaptive_claim(a, k);
        scree_grip_switch(grip, SCREE_SWITCH_OVERLAP, view, scree_adaptive_memory(a, k));
        begun++;
    }
    scene->effort.events += begun;
    return begun;
}

/* ---- locating ---- */

/* The step repeated with length h: rates, views and switch functions at its end, the last into `value`. */
static void repeat(struct scree_scene *scene, double h) {
    struct scree_adaptive *a = scene->adaptive;
    scree_dop853_step(&a->work, scree_adaptive_rates, scene, a->y, h);
    memcpy(a->arrived, a->work.end, a->work.size * sizeof *a->arrived);
    a->every = 1;
    scree_adaptive_rates(scene, a->arrived, a->next);
    a->every = 0;
    scree_adaptive_switches(scene, a->arrived, a->next, a->value);
}

/* Whether a slide changes where the step begins, clearly: another change there has made its function jump. */
static int is_due(const struct scree_adaptive *a, int k, int which) {
    return which >= SCREE_SWITCH_SLIDE && a->before[k][which] < -1e-6;
}

/* The switch function that has fallen below zero furthest, as far as one can tell from both ends: the first of all;
 * grip -1: none. */
static struct scree_event first_event(const struct scree_scene *scene) {
    const struct scree_adaptive *a = scene->adaptive;
    struct scree_event event = {-1, 0};
    double soonest = HUGE_VAL;
    for (int k = 0; k < a->grips; k++) {
        for (int w = 0; w < SCREE_SWITCHES; w++) {
            double end = a->value[k][w], begin = fmax(a->before[k][w], 0.0);
            int at_once = is_due(a, k, w);
            if (!(end < -nothing(scene, &a->grip[k], w)) && !at_once) continue;
            double when = at_once ? 0.0 : begin / (begin - end);
            if (when >= soonest) continue;
            soonest = when;
            event = (struct scree_event){k, w};
        }
    }
    return event;
}

/* Of two lengths as near as can be, the one behind a jump to below zero: a contact that has ended so would begin anew
 * before it. */
static double beyond(struct scree_scene *scene, double x1, double f1, double x2) {
    if (!(f1 > 0.0)) return x1;
    repeat(scene, x2);
    return x2;
}

/* Shorten the step to where one switch function, negative at its end, is zero: inverse quadratic interpolation with
 * bisection as Chandrupatla (Adv. Eng. Softw. 28 (1997) 145) chooses between them. A function that starts at zero
 * counts from where it is positive; if it is nowhere, the event is at the start. Returns the length. */
static double locate(struct scree_scene *scene, struct scree_event event, double h) {
    struct scree_adaptive *a = scene->adaptive;
    double small = nothing(scene, &a->grip[event.grip], event.which), *value = &a->value[event.grip][event.which];
    double low = 0.0, at_low = a->before[event.grip][event.which], high = h, at_high = *value;
    for (int k = 0; k < 12 && !(at_low > small); k++) {
        double part = 0.25 * high;
        repeat(scene, part);
        if (*value > small) {
            low = part;
            at_low = *value;
        } else if (*value < -small) {
            high = part;
            at_high = *value;
        } else { /* as good as zero, and later it is below: here */
            return part;
        }
    }
    if (!(at_low > small)) return 0.0;
    double x1 = high, f1 = at_high, x2 = low, f2 = at_low, x3 = low, f3 = at_low, t = f1 / (f1 - f2);
    t = fmin(fmax(t, 1e-3), 1.0 - 1e-3);
    for (int k = 0; k < TRIES; k++) {
        double x = x1 + t * (x2 - x1);
        repeat(scene, x);
        double f = *value;
        if ((f > 0.0) == (f1 > 0.0)) {
            x3 = x1;
            f3 = f1;
        } else {
            x3 = x2;
            f3 = f2;
            x2 = x1;
            f2 = f1;
        }
        x1 = x;
        f1 = f;
        if (fabs(f1) <= 0.25 * small) return x1;
        if (fabs(x2 - x1) <= 4e-16 * fabs(h))
            return event.which == SCREE_SWITCH_OVERLAP ? beyond(scene, x1, f1, x2) : x1;
        double xi = (x1 - x2) / (x3 - x2), phi = (f1 - f2) / (f3 - f2);
        t = 0.5;
        if (phi * phi < xi && (1.0 - phi) * (1.0 - phi) < 1.0 - xi)
            t = f1 / (f2 - f1) * (f3 / (f2 - f3)) + (x3 - x1) / (x2 - x1) * (f1 / (f3 - f1)) * (f2 / (f3 - f2));
        double least = 1e-16 * fabs(h / (x2 - x1));
        t = fmin(fmax(t, least), 1.0 - least);
    }
    return x1;
}

/* ---- what both ends of a step don't show ---- */

/* Whether a switch function may fall below zero for a moment: a slider may slide, or hold; a law that is cut may let go
 * if it changes its formula on the way; bodies may close in faster than ever since the touch, where laws remember that.
 */
static int may_dip(const struct scree_grip *grip, int which) {
    if (grip->state != SCREE_GRIP_HELD) return 0;
    if (which == SCREE_SWITCH_FORCE) return grip->normal->cut && grip->normal->bends;
    if (which == SCREE_SWITCH_PEAK) return grip->by_speed && grip->normal->memory && !grip->advancing;
    return which >= SCREE_SWITCH_SLIDE && scree_grip_may_slip(grip, which - SCREE_SWITCH_SLIDE);
}

/* Where the parabola through values at the begin, the middle and the end is least, as a share of the step, if that is
 * inside, and below zero (by more than `small`) or little: less than a fifth of either end, or than a twentieth of the
 * larger one, since by as much the parabola may be wrong; 1: it isn't. What is next to nothing at an end isn't looked
 * into, unless it is below zero in between. Cut there, the next step has a better parabola. */
static double dips_at(double begin, double middle, double end, double small) {
    double slope = 4.0 * middle - 3.0 * begin - end, bend = 2.0 * (begin + end - 2.0 * middle);
    double at = bend > 0.0 ? -0.5 * slope / bend : 0.0, least = begin + 0.5 * slope * at, ends = fmin(begin, end);
    double little = fmax(0.2 * ends, 0.05 * fmax(begin, end));
    if (!(at > 0.0 && at < 1.0)) return 1.0;
    return least < -small || (ends >= 1e-6 && least < little) ? at : 1.0;
}

/* How a contact whose law has no reach is pressed at a share of the step of length h: on the cubic through its overlaps
 * and their rates at both ends. */
static struct scree_pressing pressed_at(const struct scree_adaptive *a, int k, double h, double share) {
    double left = 1.0 - share, begin = a->before[k][SCREE_SWITCH_OVERLAP], end = a->view[k].overlap;
    double closing = a->closing[k], closing_there = a->view[k].closing;
    double rates = left * closing * a->work.k[0][Y_TIME] - share * closing_there * a->next[Y_TIME];
    double overlap = left * left * (1.0 + 2.0 * share) * begin + share * share * (3.0 - 2.0 * share) * end;
    return scree_pressed(overlap + share * left * h * rates, left * closing + share * closing_there, a->grip[k].first,
                         a->grip[k].second);
}

/* Where, as a share of the step, a law that has let go enters another piece of its formula: it may push there and let
 * go again before the end, but within one piece both ends of a step tell. 1: nowhere; next to either end, within a
 * millionth of the contact's depth, doesn't count, or the step that was cut there would be cut again. */
static double next_piece(const struct scree_adaptive *a, int k, double h) {
    const struct scree_grip *grip = &a->grip[k];
    if (grip->state != SCREE_GRIP_SPENT || !grip->normal->bends) return 1.0;
    const struct scree_law_constants *law = &grip->rule->normal_constants;
    double time = fabs(a->arrived[Y_TIME] - a->y[Y_TIME]), low = 1e-6 * grip->depth / (grip->speed * time);
    double high = 1.0 - low;
    if (!(low < high)) return 1.0;
    struct scree_pressing from = pressed_at(a, k, h, low);
    if (!grip->normal->bends(law, grip->of_normal, from, pressed_at(a, k, h, high))) return 1.0;
    for (int n = 0; n < TRIES; n++) {
        double middle = 0.5 * (low + high);
        if (grip->normal->bends(law, grip->of_normal, from, pressed_at(a, k, h, middle)))
            high = middle;
        else
            low = middle;
    }
    return high;
}

double scree_adaptive_doubt(struct scree_scene *scene, double h) {
    struct scree_adaptive *a = scene->adaptive;
    struct scree_grip_view *end = a->view;
    double *middle = a->work.k[1], *rates = a->work.k[2], soonest = 1.0; /* stages are done with */
    int any = 0, slips = 0;
    for (int k = 0; k < a->grips; k++) {
        for (int w = 0; w < SCREE_SWITCHES; w++) any |= may_dip(&a->grip[k], w);
        for (int way = 0; way < SCREE_GRIP_WAYS; way++) slips |= a->grip[k].slips[way];
        soonest = fmin(soonest, next_piece(a, k, h));
    }
    if (!any) return soonest < 1.0 ? soonest * h : 0.0;
    for (size_t i = 0; i < a->work.size; i++)
        middle[i] = 0.5 * (a->y[i] + a->arrived[i]) + 0.125 * h * (a->work.k[0][i] - a->next[i]);
    a->view = a->halfway;
    scree_adaptive_rates(scene, middle, rates);
    struct apart apart = slips ? look_around(scene, middle, rates) : (struct apart){0.0, 0.0};
    for (int k = 0; k < a->grips; k++) {
        double value[SCREE_SWITCHES], small = nothing(scene, &a->grip[k], SCREE_SWITCH_SLIDE);
        if (a->grip[k].state != SCREE_GRIP_HELD) continue; /* the halfway view has only those */
        switches_of(scene, k, apart, value);
        for (int w = 0; w < SCREE_SWITCHES; w++) {
            if (!may_dip(&a->grip[k], w)) continue;
            int unloaded = w >= SCREE_SWITCH_SLIDE && !(end[k].slides[w - SCREE_SWITCH_SLIDE] > 0.0);
            double dip = unloaded ? (value[w] < -small ? 0.5 : 1.0) /* where the load ends, it jumps */
                                  : dips_at(a->before[k][w], value[w], a->value[k][w], small);
            soonest = fmin(soonest, dip);
        }
    }
    a->view = end;
    scree_adaptive_place(scene, a->arrived);
    return soonest < 1.0 ? soonest * h : 0.0;
}

/* ---- changes ---- */

/* Near the border of sticking and slipping, or where the slip is as good as steady, rounding decides what it does,
 * again and again: one step then goes on with what it has. */
static void note_change(struct scree_grip *grip, int which, double time) {
    if (fabs(time - grip->since[which]) < 1e-4 * grip->depth / grip->speed) grip->wary[which] = 2;
    grip->since[which] = time;
}

void scree_adaptive_change(struct scree_scene *scene, struct scree_event event) {
    struct scree_adaptive *a = scene->adaptive;
    double *y = a->arrived;
    for (int k = 0; k < a->grips; k++) {
        for (int w = 0; w < SCREE_SWITCHES; w++) {
            int same = k == event.grip && w == event.which;
            int also = a->due[k] >> w & 1 && a->value[k][w] <= 4.0 * nothing(scene, &a->grip[k], w);
            if (!same && !also) continue;
            if (a->grip[k].state == SCREE_GRIP_APART) scree_adaptive_claim(a, k);
            scree_grip_switch(&a->grip[k], (enum scree_switch)w, &a->view[k], y + a->place[k]);
            if (w >= SCREE_SWITCH_SLIDE) note_change(&a->grip[k], w - SCREE_SWITCH_SLIDE, y[Y_TIME]);
            if (w == SCREE_SWITCH_NEAREST) note_change(&a->grip[k], SCREE_GRIP_GROWTH, y[Y_TIME]);
            scene->effort.events++;
            break; /* the others belonged to the phase that is over */
        }
    }
}

struct scree_event scree_adaptive_event(struct scree_scene *scene, double *h) {
    struct scree_adaptive *a = scene->adaptive;
    struct scree_event event = first_event(scene), none = {-1, 0};
    if (event.grip < 0) return none;
    for (int k = 0; k < a->grips; k++) {
        a->due[k] = 0;
        for (int w = 0; w < SCREE_SWITCHES; w++)
            if (a->value[k][w] < -nothing(scene, &a->grip[k], w)) a->due[k] |= 1 << w;
    }
    for (struct scree_event next = event; next.grip >= 0 && *h != 0.0;) {
        event = next;
        *h = is_due(a, event.grip, event.which) ? 0.0 : locate(scene, event, *h);
        if (*h == 0.0) break;
        next = first_event(scene);
        if (next.grip == event.grip && next.which == event.which) next = none;
    }
    if (*h == 0.0) {
        memcpy(a->arrived, a->y, a->work.size * sizeof *a->y);
        a->every = 1;
        scree_adaptive_rates(scene, a->arrived, a->next);
        a->every = 0;
        memcpy(a->value, a->before, (size_t)a->grips * sizeof *a->value);
    }
    return event;
}

/* ---- clocks ---- */

/* Up to which share of the contact's scale its root is the clock. */
static double clock_share(const struct scree_grip *grip) { return grip->root == 4 ? 0.24 : 0.2; }

/* Where forces set in or end like a root of the overlap, that root is the variable in which all is smooth: near the
 * begin up to about 0.45 of the contact's scale (p = 2; 0.7 for p = 4), near the end, if the overlap decides it, all
 * the way down. */
static int suits(const struct scree_grip *grip, const struct scree_grip_view *view, int runs, int *parting) {
    if (grip->state != SCREE_GRIP_HELD) return 0;
    double share = clock_share(grip) * (runs ? 1.0 : 0.5); /* to begin with it must pay */
    *parting = view->closing < 0.0;
    if (!*parting) return grip->root > 1 && view->closing > 0.3 * grip->speed && view->overlap < share * grip->depth;
    int lets_go = grip->normal->cut && grip->normal->root > 0; /* before the overlap ends */
    double left = view->overlap + grip->reach;
    double near = grip->reach > 0.0 ? 0.2 * grip->reach : 0.2 * grip->depth * -view->closing / grip->speed;
    return !lets_go && left < near && left > 0.0;
}

int scree_adaptive_clock(struct scree_scene *scene, double left) {
    struct scree_adaptive *a = scene->adaptive;
    int best = -1, parting = 0, before = a->clock;
    double least = HUGE_VAL, fastest = 0.0;
    for (int k = 0; k < a->grips; k++)
        if (a->grip[k].state == SCREE_GRIP_HELD) fastest = fmax(fastest, a->grip[k].speed);
    for (int k = 0; k < a->grips && !a->banned; k++) {
        const struct scree_grip *grip = &a->grip[k];
        int parts;
        if (grip->speed < 1e-2 * fastest) continue; /* others push it: its own speed is no measure of time */
        if (!suits(grip, &a->view[k], k == before, &parts)) continue;
        double share = (a->view[k].overlap + (parts ? grip->reach : 0.0)) / grip->depth;
        /* Contacts that begin at once don't take turns for the sake of rounding. */
        if (k == before) share -= 16.0 * rounding_of(scene, grip) / grip->depth;
        if (share >= least) continue;
        least = share;
        best = k;
        parting = parts;
    }
    if (best < 0) {
        a->clock = -1;
        a->y[Y_CLOCK] = 0.0;
        return before >= 0;
    }
    const struct scree_grip *grip = &a->grip[best];
    double share = clock_share(grip), offset = parting ? grip->reach : 0.0;
    double way = parting ? a->view[best].overlap + offset : share * grip->depth - a->view[best].overlap;
    if (best == before && parting == a->parting) return 0;
    if (2.0 * way > left * fabs(a->view[best].closing)) { /* the step of the scene ends before */
        a->clock = -1;
        a->y[Y_CLOCK] = 0.0;
        return before >= 0;
    }
    a->clock = best;
    a->parting = parting;
    a->root = parting ? grip->end_root : grip->root;
    a->offset = offset;
    a->goal = parting ? 0.0 : scree_whole_root(share * grip->depth, a->root);
    a->y[Y_CLOCK] = scree_whole_root(fmax(a->view[best].overlap + offset, 0.0), a->root);
    return 1;
}
