/* aabb_cluster_build.h - assigns items to clusters: items of a grid by blocks, others in their
 * order. */
#ifndef CS_BROAD_PHASE_AABB_CLUSTER_BUILD_H
#define CS_BROAD_PHASE_AABB_CLUSTER_BUILD_H

#include "base/arena.h"
#include "model/contact/broad_phase/aabb_clusters.h"

#include <stddef.h>
#include <stdint.h>

/* Finds parts of a grid that are too flat to touch themselves, so that
 * self-collision can skip them (cf. Volino, Thalmann 1994).
 *
 * The criterion is a lower bound of distances and not a cone of normals. Let p and q be points
 * of a rectangular piece of the grid, in units of cells, and x(p) their positions. Along the
 * straight line from p to q,
 *
 *   x(p) - x(q) = integral of F dp,   F = (edge along a row, edge across the rows), 3 x 2
 *
 * with F constant in each triangle. If all edges lie in boxes about the columns of a matrix A,
 *
 *   |x(p) - x(q)| >= |A (p - q)| - |integral of (F - A) dp| >= (s - r) |p - q|
 *
 * where s is the least singular value of A and r the largest norm of F - A, which is at most
 * the root of the sum of squares of all half-widths. Primitives that share no vertex are at
 * least 1/sqrt(2) cells apart: a vertex and the diagonal of a cell beside it. So they are at
 * least (s - r) / sqrt(2) from each other in space.
 *
 * A block is measured together with the eight around it, since contact may join neighbours. The
 * rectangle must be convex before it is bent; a block with its neighbours is. */

/* cells per side of a block */
enum { CS_FLAT_REGION_BLOCK = 4 };

/* Bounding boxes of the edges of a block: [0] along the rows, [1] across them. */
struct cs_flat_region_edges {
    double low[2][3], high[2][3]; /* m */
    /* sum of all components: not finite if one of them is not */
    double sum;
};

/* A grid in blocks; the last block of a row or column may be smaller. */
struct cs_flat_region {
    /* points first + row columns + column */
    uint32_t first, columns, rows;
    /* numbers of its first block and row, where several grids are numbered in one sequence */
    uint32_t first_block, first_row;
    /* blocks along a row and across the rows */
    uint32_t n_blocks_x, n_blocks_y;
    /* (n_blocks_y, n_blocks_x) */
    struct cs_flat_region_edges *edges;
    /* (n_blocks_y, n_blocks_x) m, lower bound of the distance of primitives without a common
     * vertex in the block and those around it; negative: no statement; may be NaN */
    double *min_distance;
};

/* Allocates a grid. The caller has set first to first_row, with at least two columns and rows.
 * min_distance stays unset. The arena owns the arrays. CS_ERR_MEMORY. */
enum cs_status cs_flat_region_init(struct cs_flat_region *flat, struct cs_arena *arena,
                                   struct cs_error *error);

/* Sets min_distance of all blocks at x (3, n) in m, with all threads. */
void cs_flat_region_measure(struct cs_flat_region *flat, const double *x, size_t n);

/* Block of a point, one of those that it belongs to. */
static inline uint32_t cs_flat_region_block(const struct cs_flat_region *flat, uint32_t row,
                                            uint32_t column) {
    const uint32_t down = row / CS_FLAT_REGION_BLOCK, across = column / CS_FLAT_REGION_BLOCK;
    return (down < flat->n_blocks_y ? down : flat->n_blocks_y - 1) * flat->n_blocks_x +
           (across < flat->n_blocks_x ? across : flat->n_blocks_x - 1);
}

/* Points, edges or triangles of all bodies; everything is borrowed during the call. */
struct cs_cluster_input {
    const uint32_t *vertices; /* (n, each) points of an item; NULL: it is one itself */
    uint32_t vertices_per_item;
    const uint32_t *first; /* (n_bodies + 1) items of each body */
    uint32_t n_bodies;
    /* (n_bodies) NULL: the body is none; or NULL: none is */
    struct cs_flat_region *const *flat_regions;
};

/* Allocates and fills all of the clusters but their boxes. Rectangles exist if one body is a
 * grid. The arena owns the arrays. CS_ERR_MEMORY. */
enum cs_status cs_cluster_input_build(const struct cs_cluster_input *order,
                                      struct cs_aabb_clusters *clusters, struct cs_arena *arena,
                                      struct cs_error *error);

#endif
