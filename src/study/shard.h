/* shard.h - which share of a study's cells one process does. */
#ifndef CS_SHARD_H
#define CS_SHARD_H

#include <stdbool.h>
#include <stdint.h>

/* The number-th of so many, from 1 on; zeroed: all. */
struct cs_shard {
    uint32_t number, of;
};

static inline bool cs_shard_holds(const struct cs_shard *shard, uint32_t k) {
    return shard->of == 0 || k % shard->of == shard->number - 1;
}

#endif
