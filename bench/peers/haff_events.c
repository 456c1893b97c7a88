/* Haff's gas of hard spheres, from one impact to the next: what suite_gas.c has of soft ones, in the same boxes, from
 * the same starts. Knows nothing of scree. Each sphere keeps its next impact; the nearest images count, so all impacts
 * are found anew twice in a unit of time, in which no two spheres come half a box nearer.
 *
 *   build/bench/haff-events 0 40
 *
 * prints, of runs 0 to 39, by how much 1/sqrt(T) grows in a unit of time between 5 and 40 (some 10 s each):
 * data/reference/haff_events.csv. */
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

enum { COUNT = 2000, UNITS = 40, FIRST = 5, LOOKS = 2 };

static const double pi = 3.14159265358979323846, share = 0.05, restitution = 0.9;

/* Places belong to each sphere's own time; its next impact, with whom and when. */
static double side, x[COUNT][3], v[COUNT][3], own[COUNT], when[COUNT];
static int with[COUNT];

static double even(uint64_t *seed) {
    *seed = *seed * 6364136223846793005u + 1442695040888963407u;
    return ((double)(*seed >> 11) + 0.5) / 9007199254740992.0;
}

/* From the nearest image of b to a, at a time; returns the square of the distance. */
static double between(int a, int b, double time, double way[3]) {
    double square = 0.0;
    for (int i = 0; i < 3; i++) {
        double d = x[a][i] + v[a][i] * (time - own[a]) - x[b][i] - v[b][i] * (time - own[b]);
        way[i] = d - side * rint(d / side);
        square += way[i] * way[i];
    }
    return square;
}

static void place_all(uint64_t seed) {
    for (int k = 0; k < COUNT;) {
        int is_free = 1;
        double way[3];
        for (int i = 0; i < 3; i++) x[k][i] = side * even(&seed);
        for (int other = 0; other < k && is_free; other++) is_free = between(k, other, 0.0, way) > 1.0;
        k += is_free;
    }
}

static double temperature(void) {
    double square = 0.0;
    for (int k = 0; k < COUNT; k++)
        for (int i = 0; i < 3; i++) square += v[k][i] * v[k][i];
    return square / (3.0 * COUNT);
}

static void throw_all(uint64_t seed) {
    double mean[3] = {0.0};
    for (int k = 0; k < COUNT; k++)
        for (int i = 0; i < 3; i++) {
            double u = even(&seed), w = even(&seed);
            v[k][i] = sqrt(-2.0 * log(u)) * cos(2.0 * pi * w);
            mean[i] += v[k][i] / COUNT;
        }
    for (int k = 0; k < COUNT; k++)
        for (int i = 0; i < 3; i++) v[k][i] -= mean[i];
    double speed = sqrt(temperature());
    for (int k = 0; k < COUNT; k++)
        for (int i = 0; i < 3; i++) v[k][i] /= speed;
}

/* When two spheres meet, from a time on. */
static double meeting(int a, int b, double time) {
    double way[3], gap = between(a, b, time, way) - 1.0, along = 0.0, square = 0.0;
    for (int i = 0; i < 3; i++) {
        double w = v[a][i] - v[b][i];
        along += way[i] * w;
        square += w * w;
    }
    double root = along * along - square * gap;
    if (along >= 0.0 || root < 0.0) return HUGE_VAL;
    double later = gap / (sqrt(root) - along);
    return time + (later > 0.0 ? later : 0.0);
}

static void take_sooner(int a, int b, double time) {
    double then = meeting(a, b, time);
    if (!(then < when[a])) return;
    when[a] = then;
    with[a] = b;
}

static void find_next(int a, double time) {
    when[a] = HUGE_VAL;
    with[a] = -1;
    for (int b = 0; b < COUNT; b++)
        if (b != a) take_sooner(a, b, time);
}

static void bring_to(int k, double time) {
    for (int i = 0; i < 3; i++) x[k][i] += v[k][i] * (time - own[k]);
    own[k] = time;
}

static void collide(int a, int b, double time) {
    double way[3], closing = 0.0;
    bring_to(a, time);
    bring_to(b, time);
    double apart = sqrt(between(a, b, time, way));
    for (int i = 0; i < 3; i++) closing -= (v[a][i] - v[b][i]) * way[i] / apart;
    for (int i = 0; i < 3 && closing > 0.0; i++) {
        double kick = 0.5 * (1.0 + restitution) * closing * way[i] / apart;
        v[a][i] += kick;
        v[b][i] -= kick;
    }
}

/* After an impact: those two, whoever was to meet them, and whoever meets them sooner now. */
static void look_again(int a, int b, double time) {
    find_next(a, time);
    find_next(b, time);
    for (int k = 0; k < COUNT; k++) {
        if (k == a || k == b) continue;
        if (with[k] == a || with[k] == b) {
            find_next(k, time);
            continue;
        }
        take_sooner(k, a, time);
        take_sooner(k, b, time);
    }
}

static void go_on(double from, double to) {
    for (int k = 0; k < COUNT; k++) find_next(k, from);
    for (;;) {
        int next = 0;
        for (int k = 1; k < COUNT; k++)
            if (when[k] < when[next]) next = k;
        if (when[next] >= to) break;
        double time = when[next];
        int other = with[next];
        collide(next, other, time);
        look_again(next, other, time);
    }
    for (int k = 0; k < COUNT; k++) bring_to(k, to);
}

int main(int count, char **words) {
    if (count != 3) {
        fprintf(stderr, "usage: haff-events FROM TO (runs FROM to TO - 1)\n");
        return 2;
    }
    int from = atoi(words[1]), to = atoi(words[2]);
    if (from < 0 || from >= to) {
        fprintf(stderr, "haff-events: FROM and TO are numbers of runs, 0 <= FROM < TO, not \"%s\" and \"%s\"\n",
                words[1], words[2]);
        return 2;
    }
    side = cbrt(COUNT * pi / 6.0 / share);
    printf("run,rate\n");
    for (int run = from; run < to; run++) {
        double first = 0.0;
        for (int k = 0; k < COUNT; k++)
            for (int i = 0; i < 3; i++) v[k][i] = own[k] = 0.0;
        place_all(2 * (uint64_t)run + 1);
        throw_all(2 * (uint64_t)run + 2);
        for (int unit = 0; unit < UNITS; unit++) {
            if (unit == FIRST) first = temperature();
            for (int look = 0; look < LOOKS; look++) go_on(unit + (double)look / LOOKS, unit + (look + 1.0) / LOOKS);
        }
        printf("%d,%.7f\n", run, (1.0 / sqrt(temperature()) - 1.0 / sqrt(first)) / (UNITS - FIRST));
        fflush(stdout);
    }
    return 0;
}
