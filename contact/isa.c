/* Which of the loops runs on this processor, and how. */
#include "contact/loop.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const struct scree_loop *const loops[] = {
#ifdef SCREE_HAS_AVX512
    &scree_loop_avx512,
#endif
#ifdef SCREE_HAS_AVX2
    &scree_loop_avx2,
#endif
    &scree_loop_baseline,
};

static int runs(const struct scree_loop *loop) {
#ifdef SCREE_HAS_AVX512
    if (loop == &scree_loop_avx512)
        return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
               __builtin_cpu_supports("avx512vl");
#endif
#ifdef SCREE_HAS_AVX2
    if (loop == &scree_loop_avx2) return __builtin_cpu_supports("avx2");
#endif
    return loop == &scree_loop_baseline;
}

static const struct scree_loop *choose(size_t from) {
    const char *wanted = getenv("SCREE_ISA");
    const struct scree_loop *chosen = NULL;
    for (size_t k = 0; k < sizeof loops / sizeof *loops; k++) {
        if (!runs(loops[k])) continue;
        if (wanted && strcmp(wanted, loops[k]->name) == 0) return loops[k];
        if (!chosen && k >= from) chosen = loops[k];
    }
    return chosen;
}

const struct scree_loop *scree_choose_loop(void) { return choose(0); }

const struct scree_loop *scree_choose_loop_for_few(void) {
#ifdef SCREE_HAS_AVX512
    return choose(1);
#else
    return choose(0);
#endif
}

int scree_sums_in_hand(void) {
#ifdef SCREE_HAS_AVX512
    return __builtin_cpu_is("amd") && !__builtin_cpu_is("amdfam19h");
#else
    return 0;
#endif
}

/* Bytes of a processor's third cache; 32 MB if the system doesn't tell. */
static double third_cache(void) {
    long kilobytes = 0;
    FILE *file = fopen("/sys/devices/system/cpu/cpu0/cache/index3/size", "r");
    int told = file && fscanf(file, "%ldK", &kilobytes) == 1 && kilobytes > 0;
    if (file) fclose(file);
    return 1024.0 * (told ? (double)kilobytes : 32768.0);
}

int scree_bodies_in_cache(void) { return (int)fmin(third_cache() / 2048.0, 1e9); }
