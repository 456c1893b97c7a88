/* FNV-1a, 64 bits (Fowler, Noll & Vo; public domain). */
#ifndef SCREE_ENGINE_HASH_H
#define SCREE_ENGINE_HASH_H

#include <stddef.h>
#include <stdint.h>

static const uint64_t scree_hash_start = 0xcbf29ce484222325u;

static inline uint64_t scree_hash_on(uint64_t hash, const void *data, size_t size) {
    const unsigned char *bytes = data;
    for (size_t k = 0; k < size; k++) hash = (hash ^ bytes[k]) * 0x100000001b3u;
    return hash;
}

#endif
