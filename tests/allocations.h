/* Allocations, counted and refused, for tests that are linked with their wrappers (tests/meson.build). */
#ifndef SCREE_TESTS_ALLOCATIONS_H
#define SCREE_TESTS_ALLOCATIONS_H

#include "bodies/memory.h"

#include <stdlib.h>

void *__real_malloc(size_t size);
void *__real_calloc(size_t count, size_t size);
void *__real_realloc(void *memory, size_t size);
void *__real_aligned_alloc(size_t alignment, size_t size);
void *__wrap_malloc(size_t size);
void *__wrap_calloc(size_t count, size_t size);
void *__wrap_realloc(void *memory, size_t size);
void *__wrap_aligned_alloc(size_t alignment, size_t size);

void *__real_scree_memory(size_t size);
void *__wrap_scree_memory(size_t size);

static long allocations;
static long refused; /* the one to be refused, counted from 1; 0: none */

static int refuses(void) {
    allocations++;
    return refused > 0 && --refused == 0;
}

/* From the heap or from the system. */
void *__wrap_scree_memory(size_t size) { return refuses() ? NULL : __real_scree_memory(size); }

void *__wrap_malloc(size_t size) { return refuses() ? NULL : __real_malloc(size); }

void *__wrap_calloc(size_t count, size_t size) { return refuses() ? NULL : __real_calloc(count, size); }

void *__wrap_realloc(void *memory, size_t size) { return refuses() ? NULL : __real_realloc(memory, size); }

void *__wrap_aligned_alloc(size_t alignment, size_t size) {
    return refuses() ? NULL : __real_aligned_alloc(alignment, size);
}

#endif
