/* Bodies that go farther than the outer list looked, one of many at a time: it is extended for them, nobody is missed,
 * and no bit depends on it. */
#include "tests/scenes.h"

#include <stdlib.h>
#include <string.h>

enum { LONG = 24, WIDE = 8, HIGH = 9, MOST = 200 * (LONG * WIDE * HIGH + 8) };

/* Balls of 1 mm at rest on a lattice, without gravity, but for two shafts down to the floor: through one a ball falls
 * without touching, through the other one that grazes what it passes. */
static char *text_of(void) {
    char *text = malloc(MOST);
    int used = sprintf(text, "%s",
                       "gravity = [0, 0, 0]\n[time]\nintegrator = \"verlet\"\nend = 1\nstep = 1e-5\n"
                       "[[material]]\nname = \"m\"\ndensity = 2500\n[[contact]]\nbetween = [\"m\", \"m\"]\n"
                       "normal = { law = \"linear\", stiffness = 2e3, restitution = 0.9 }\n"
                       "friction = { law = \"coulomb\", static = 0.5, kinetic = 0.4, stiffness = 1e3 }\n"
                       "[[body]]\nname = \"floor\"\nshape = { plane = true }\nmaterial = \"m\"\njoint = \"fixed\"\n");
    for (int k = 0; k < LONG * WIDE * HIGH; k++) {
        int x = k % LONG, y = k / LONG % WIDE, z = k / LONG / WIDE;
        int free = x == 12 && y == 4, grazes = x == 5 && y == 2;
        if ((free || grazes) && z < HIGH - 1) continue;
        used += sprintf(text + used,
                        "[[body]]\nname = \"%d\"\nshape = { sphere = 0.001 }\nmaterial = \"m\"\n"
                        "position = [%.17g, %.17g, %.17g]\nvelocity = [0, 0, %g]\n",
                        k, 2.3e-3 * x + (grazes ? 0.35e-3 : 0.0), 2.3e-3 * y, 1.2e-3 + 2.3e-3 * z,
                        free || grazes ? -0.4 : 0.0);
    }
    return text;
}

static int compare(const void *a, const void *b) {
    long one = *(const long *)a, other = *(const long *)b;
    return (one > other) - (one < other);
}

/* Pairs that may touch before one of them asks for a list are all near ones; those that come to the floor as well. */
static void check_lists(const scree_scene *scene) {
    static long listed[LONG * WIDE * HIGH * 40];
    const struct scree_contacts *contacts = &scene->contacts;
    const struct scree_bodies *bodies = &scene->bodies;
    size_t count = 0;
    for (int b = 0; b < contacts->batches; b++)
        for (int k = scree_first(&contacts->batch[b]); k >= 0; k = scree_next(&contacts->batch[b], k)) {
            struct scree_contact one = scree_contact_at(&contacts->batch[b], k);
            int low = one.ball < one.host ? one.ball : one.host;
            listed[count++] = (long)low * bodies->count + (one.ball + one.host - low);
        }
    qsort(listed, count, sizeof *listed, compare);
    for (int i = 0; i < bodies->count; i++)
        for (int j = i + 1; j < bodies->count; j++) {
            const struct scree_record *a = &bodies->record[i], *b = &bodies->record[j];
            double gap = i == 0 ? b->x[2] - b->radius
                                : vec_norm(vec_sub(vec_from(a->x), vec_from(b->x))) - a->radius - b->radius;
            if (!(gap < scree_left_of(contacts, bodies, i, j))) continue;
            long wanted = (long)i * bodies->count + j;
            CHECK(bsearch(&wanted, listed, count, sizeof *listed, compare) != NULL);
        }
}

int main(void) {
    char *text = text_of();
    scree_scene *scene = scene_from(text, NULL, 0, 1), *threaded = scene_from(text, NULL, 0, 2),
                *other = scene_from(text, NULL, 0, 1);
    CHECK(scene->bodies.order.slabs >= 8 && scene->bodies.place[0] == 0);
    int most = 0, falls = scree_scene_find_body(scene, "1644"); /* the uppermost place of the free shaft */
    CHECK(scree_scene_body(scene, falls).velocity[2] == -0.4);
    for (int k = 0; k < 60; k++) {
        go(scene, 100);
        check_lists(scene);
        most = scene->contacts.extended > most ? scene->contacts.extended : most;
        go(threaded, 100);
        for (int n = 0; n < 10; n++) {
            other->contacts.extended = SCREE_MOST_EXTENDED; /* never */
            go(other, 10);
        }
    }
    if (getenv("SCREE_SHOW"))
        printf("extended %d, outer lists %ld, otherwise %ld\n", most, scene->contacts.rebuilds,
               other->contacts.rebuilds);
    CHECK(scree_scene_body(scene, falls).velocity[2] > 0.3); /* it has come to the floor, which was out of sight */
    CHECK(most > 20 && 3 * scene->contacts.rebuilds < other->contacts.rebuilds);
    CHECK(scree_scene_hash(scene) == scree_scene_hash(other) && scree_scene_hash(scene) == scree_scene_hash(threaded));
    scree_scene_destroy(scene);
    scree_scene_destroy(threaded);
    scree_scene_destroy(other);
    free(text);
    return check_report();
}
