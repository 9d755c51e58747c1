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

#endif
