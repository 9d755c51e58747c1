/* conform_cache.h - reference states, kept so that the cards of several methods share them.
 *
 * A reference does not depend on the method that is looked at, so that one run of each serves
 * all cards that one command makes. */
#ifndef CS_CONFORM_CACHE_H
#define CS_CONFORM_CACHE_H

#include <stddef.h>

struct cs_conform_kept;

/* Empty when zeroed. */
struct cs_conform_cache {
    struct cs_conform_kept *first; /* owned */
};

/* The n values kept under that name; NULL: there are none, or there is no cache. */
const double *cs_conform_cache_find(const struct cs_conform_cache *cache, const char *name,
                                    size_t n);

/* Keeps a copy under that name. Without a cache, or out of memory, nothing is kept: the next
 * card runs the reference again. */
void cs_conform_cache_store(struct cs_conform_cache *cache, const char *name,
                            const double *values, size_t n);

void cs_conform_cache_finish(struct cs_conform_cache *cache);

#endif
