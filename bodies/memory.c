/* Memory for arrays: small ones from the heap, large ones from the system. In the heap the arrays that lists have
 * outgrown would leave holes, a tenth of a large scene. */
#define _DEFAULT_SOURCE /* MAP_ANONYMOUS, madvise */
#include "bodies/memory.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

enum { LARGE = 64 << 10, LINE = 256, HUGE_PAGE = 2 << 20, MOST_ALIGNED = 8 * HUGE_PAGE };

/* What lies in front of an array: how much of it comes from the system, 0: it is of the heap. */
struct front {
    size_t mapped;
    char unused[LINE - sizeof(size_t)];
};

static size_t up_to(size_t size, size_t unit) { return (size + unit - 1) / unit * unit; }

/* From the system, so that what holds a huge page begins with one: the kernel makes none that an array holds in part.
 * What lies in front of it and behind is given back. Larger arrays lose little at their ends, and columns that are
 * walked side by side would use the same sets of caches. */
static char *map_at_huge_page(size_t size) {
    size_t spare = size < HUGE_PAGE || size > MOST_ALIGNED ? 0 : HUGE_PAGE;
    char *start = mmap(NULL, size + spare, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (start == MAP_FAILED) return NULL;
    size_t before = spare ? up_to((uintptr_t)start, HUGE_PAGE) - (uintptr_t)start : 0, behind = spare - before;
    if (before) munmap(start, before);
    if (behind) munmap(start + before + size, behind);
    return start + before;
}

/* An array that fills a huge page but for a 32nd has one. (By an eighth, 100,000 spheres took 401 bytes each instead of
 * 397, and no less time on an Intel Xeon.) */
static struct front *map(size_t size) {
    int nearly = size < HUGE_PAGE && HUGE_PAGE - size <= size / 32;
    size = nearly ? HUGE_PAGE : up_to(size, (size_t)sysconf(_SC_PAGESIZE));
    struct front *front = (struct front *)map_at_huge_page(size);
    if (!front) return NULL;
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
