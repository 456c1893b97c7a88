/* Which of the loops runs. */
#include "contact/loop.h"

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
