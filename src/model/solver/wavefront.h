/* wavefront.h - wavefront (temporal) blocking: runs several dependent loops over the blocks of
 * an array together. Each loop reads the results of its predecessor in a block and its two
 * neighbours.
 *
 * The loops advance together, each one block behind its predecessor, so that a block is still
 * in the cache for the next loop. An array that does not fit the cache is fetched once, not
 * once per loop. A loop may overwrite what its predecessor reads, as when two arrays are
 * swapped: the predecessor is past that block.
 *
 * With several threads the blocks are cut into stretches, one task each. Inside a stretch every
 * loop ends one block earlier on either side than its predecessor, because the neighbours'
 * results are missing. The wedges between the stretches follow as a second set of tasks.
 * Results are those of one loop after the other, for any number of threads. */
#ifndef CS_WAVEFRONT_H
#define CS_WAVEFRONT_H

#include <stdint.h>

/* n_loops loops over n_blocks blocks; step runs one loop on one block. */
struct cs_wavefront {
    uint32_t n_loops, n_blocks;
    void (*step)(void *arg, uint32_t loop, uint32_t block);
    void *arg;
};

/* Runs all loops and returns when they are done. */
void cs_wavefront_run(const struct cs_wavefront *wavefront);

#endif
