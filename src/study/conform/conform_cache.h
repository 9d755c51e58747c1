/* conform_cache.h - stores reference states, shared by the cards of several methods.
 *
 * A reference does not depend on the tested method, so one run of each serves all cards that a
 * command makes. */
#ifndef CS_CONFORM_CACHE_H
#define CS_CONFORM_CACHE_H

#include <stddef.h>

struct cs_conform_kept;

/* Empty when zeroed. */
struct cs_conform_cache {
    struct cs_conform_kept *first; /* owned */
};

/* Returns the n values stored under that name, which the cache owns, or NULL if there are none,
 * if their number differs, or without a cache. */
const double *cs_conform_cache_find(const struct cs_conform_cache *cache, const char *name,
                                    size_t n);

/* Stores a copy under that name. Without a cache or out of memory nothing is stored, and the
 * next card runs the reference again: therefore there is no error. */
void cs_conform_cache_store(struct cs_conform_cache *cache, const char *name,
                            const double *values, size_t n);

/* Frees all values; the cache is then empty. */
void cs_conform_cache_finish(struct cs_conform_cache *cache);

#endif
