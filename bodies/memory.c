/* Memory for arrays: small ones from the heap, large ones from the system. In the heap the arrays that lists have
 * outgrown would leave holes, a tenth of a large scene. */
#define _DEFAULT_SOURCE /* MAP_ANONYMOUS, madvise */
#include "bodies/memory.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>

enum { LARGE = 64 << 10, LINE = 256 };

/* What lies in front of an array: how much of it comes from the system, 0: it is of the heap. */
struct front {
    size_t mapped;
    char unused[LINE - sizeof(size_t)];
};

static struct front *map(size_t size) {
    struct front *front = mmap(NULL, size, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (front == MAP_FAILED) return NULL;
#ifdef MADV_HUGEPAGE
    madvise(front, size, MADV_HUGEPAGE); /* fewer misses when bodies are looked up; where it is refused, so be it */
#endif
    front->mapped = size;
    return front;
}

static struct front *take(size_t size) {
    struct front *front = aligned_alloc(LINE, size);
    if (front) memset(front, 0, size);
    return front;
}

void *scree_memory(size_t size) {
    if (size > SIZE_MAX / 2) return NULL;
    size_t whole = sizeof(struct front) + (size + LINE - 1) / LINE * LINE;
    struct front *front = whole < LARGE ? take(whole) : map(whole);
    return front ? front + 1 : NULL;
}

void scree_memory_free(void *memory) {
    struct front *front = memory ? (struct front *)memory - 1 : NULL;
    if (front && front->mapped)
        munmap(front, front->mapped);
    else
        free(front);
}
