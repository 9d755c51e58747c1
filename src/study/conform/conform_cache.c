/* Stores reference states by name in a linked list: there are a few dozen. */
#include "study/conform/conform_cache.h"

#include <stdlib.h>
#include <string.h>

/* One reference; the newest is first in the list. */
struct cs_conform_kept {
    struct cs_conform_kept *next;
    char name[64];
    size_t n;
    double values[];
};

const double *cs_conform_cache_find(const struct cs_conform_cache *cache, const char *name,
                                    size_t n) {
    for (const struct cs_conform_kept *kept = cache ? cache->first : NULL; kept;
         kept = kept->next)
        if (kept->n == n && !strcmp(kept->name, name))
            return kept->values;
    return NULL;
}

void cs_conform_cache_store(struct cs_conform_cache *cache, const char *name,
                            const double *values, size_t n) {
    struct cs_conform_kept *kept = NULL;
    // a truncated name could match another one
    if (cache && strlen(name) < sizeof kept->name)
        kept = malloc(sizeof *kept + n * sizeof *values);
    if (!kept)
        return;
    strcpy(kept->name, name);
    kept->n = n;
    memcpy(kept->values, values, n * sizeof *values);
    kept->next = cache->first;
    cache->first = kept;
}

void cs_conform_cache_finish(struct cs_conform_cache *cache) {
    for (struct cs_conform_kept *kept = cache->first; kept;) {
        struct cs_conform_kept *next = kept->next;
        free(kept);
        kept = next;
    }
    cache->first = NULL;
}
