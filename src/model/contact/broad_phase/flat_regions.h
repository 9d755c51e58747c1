/* flat_regions.h - where a grid is so flat that nothing in it comes near anything else of it.
 *
 * Between two places of a piece of a grid that is convex before it is bent, with the gradients
 * F of the cells (two columns: a cell's edges along and across the rows) in a box about A,
 *
 *   |x(p) - x(q)| >= (s - r) |p - q|       s the least singular value of A, r the most |F - A|
 *
 * for x(p) - x(q) is the sum of F dp along the straight line between them. With |p - q| in
 * cells, parts that share no corner are at 1/sqrt(2) or more: a corner and the diagonal of a
 * cell beside it. */
#ifndef CS_BROAD_PHASE_FLAT_REGIONS_H
#define CS_BROAD_PHASE_FLAT_REGIONS_H

#include "base/arena.h"

#include <stddef.h>
#include <stdint.h>

/* cells along a side of a block */
enum { CS_FLAT_REGION_BLOCK = 4 };

/* Boxes about a block's edges: along the rows, and across. */
struct cs_flat_region_edges {
    double low[2][3], high[2][3]; /* m */
    double sum;                   /* of all: not finite where one is not */
};

/* A grid in blocks; the last ones of rows and columns may be smaller. */
struct cs_flat_region {
    uint32_t first, columns, rows;      /* point first + row x columns + column */
    uint32_t first_block, first_row;    /* where several grids are numbered through */
    uint32_t n_blocks_x, n_blocks_y;    /* blocks */
    struct cs_flat_region_edges *edges; /* (down, across) */
    double *min_distance; /* (down, across) m: parts of the block and those round it that share
                      no corner are at least so far from each other; maybe not a number */
};

/* first to first_row are the caller's, of at least two columns and rows; sets the others, but
 * for apart. CS_ERR_MEMORY. */
enum cs_status cs_flat_region_init(struct cs_flat_region *flat, struct cs_arena *arena,
                                   struct cs_error *error);

/* Sets apart of all blocks at x (3, n), with all threads. */
void cs_flat_region_measure(struct cs_flat_region *flat, const double *x, size_t n);

/* The block of a place, one that it is in or at the rim of. */
static inline uint32_t cs_flat_region_block(const struct cs_flat_region *flat, uint32_t row,
                                            uint32_t column) {
    const uint32_t down = row / CS_FLAT_REGION_BLOCK, across = column / CS_FLAT_REGION_BLOCK;
    return (down < flat->n_blocks_y ? down : flat->n_blocks_y - 1) * flat->n_blocks_x +
           (across < flat->n_blocks_x ? across : flat->n_blocks_x - 1);
}

#endif
