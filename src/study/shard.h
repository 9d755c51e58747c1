/* shard.h - which share of a study's cells one process does. */
#ifndef CS_SHARD_H
#define CS_SHARD_H

#include <stdbool.h>
#include <stdint.h>

/* The number-th of so many, from 1 on; zeroed: all. */
struct cs_shard {
    uint32_t index, count;
};

static inline bool cs_shard_holds(const struct cs_shard *shard, uint32_t k) {
    return shard->count == 0 || k % shard->count == shard->index - 1;
}

#endif
