/* level_kernels.h - the loops over the cells of one multigrid level: sweep of the smoother, its
 * start, and the inverses of the diagonal blocks. */
#ifndef CS_LEVEL_KERNELS_H
#define CS_LEVEL_KERNELS_H

#include "model/solver/multigrid_hierarchy.h"

/* One loop over the cells of a level. d is the last correction, e the next one. */
struct cs_level_loop {
    struct cs_level *level;
    void (*task)(const struct cs_level_loop *loop, size_t begin, size_t end);
    const float *d;
    float *e;     /* NULL: only the residual changes */
    float a, b;   /* gains: e = a d + b D^-1 r */
    bool fetches; /* the first loop to read a block's springs, which prefetches them */
};

/* Tasks over the cells [begin, end), multiples of CS_LANES.
 *
 * sweep:  residual -= A d, and, unless e is NULL, e = a d + b D^-1 residual, solution += e
 * start:  solution = e = b D^-1 residual, the first move of a smoother from 0
 * invert: the inverses; b is the fraction of the trace that D gets on top */
struct cs_level_kernels {
    void (*sweep)(const struct cs_level_loop *loop, size_t begin, size_t end);
    void (*start)(const struct cs_level_loop *loop, size_t begin, size_t end);
    void (*invert)(const struct cs_level_loop *loop, size_t begin, size_t end);
};

/* Compiled for vectors of 8 and of 16 floats; the bits are the same. */
extern const struct cs_level_kernels cs_level_kernels_8, cs_level_kernels_16;

/* Wavefront (temporal) blocking: runs several dependent loops over the blocks of
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

/* n_loops loops over n_blocks blocks; step runs one loop on one block. */
struct cs_wavefront {
    uint32_t n_loops, n_blocks;
    void (*step)(void *arg, uint32_t loop, uint32_t block);
    void *arg;
};

/* Runs all loops and returns when they are done. */
void cs_wavefront_run(const struct cs_wavefront *wavefront);

#endif
