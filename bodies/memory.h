/* Memory for arrays. */
#ifndef SCREE_BODIES_MEMORY_H
#define SCREE_BODIES_MEMORY_H

#include <stddef.h>

/* `size` bytes, zero, on a boundary of 64 bytes, so that a row of four never straddles cache lines; NULL if there are
 * none. What is large comes from the system page by page: what isn't touched takes no memory, and what is freed goes
 * back. */
void *scree_memory(size_t size);
void scree_memory_free(void *memory); /* NULL is left alone */

#endif
