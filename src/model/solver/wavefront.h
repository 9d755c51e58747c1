/* wavefront.h - several loops over the same blocks of an array, each of which looks at what the
 * one before made of a block and of its two neighbours.
 *
 * They go over the blocks together, each a block behind the one before, and find in the cache
 * what that has left there: an array that does not fit is fetched once, not once a loop. A loop
 * may write over what the one before reads: two arrays that change places will do. With several
 * threads each takes a stretch of blocks, in which every loop ends a block earlier on both
 * sides; the wedges between stretches follow. Results are those of one loop after the other,
 * whatever the number of threads. */
#ifndef CS_WAVEFRONT_H
#define CS_WAVEFRONT_H

#include <stdint.h>

struct cs_wavefront {
    uint32_t n_loops, n_blocks;
    void (*step)(void *arg, uint32_t loop, uint32_t block);
    void *arg;
};

void cs_wavefront_run(const struct cs_wavefront *wavefront);

#endif
