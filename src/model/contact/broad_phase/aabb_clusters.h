/* aabb_clusters.h - bounding boxes in clusters of sixteen. One vector comparison tests all
 * boxes of a cluster, and only clusters whose common box overlaps are tested.
 *
 * Single precision suffices: rounding is monotone, so that boxes that overlap still do after
 * all their bounds were rounded alike. */
#ifndef CS_BROAD_PHASE_AABB_CLUSTERS_H
#define CS_BROAD_PHASE_AABB_CLUSTERS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Axis-aligned boxes sorted into the cells of a uniform grid by counting:
 * integer keys, no pointers, items of a cell in ascending order. */

/* Axis-aligned bounding box in m; empty if high is below low. */
struct cs_aabb {
    double low[3], high[3]; /* m */
};

/* Boxes that touch overlap, and so do boxes with NaN: a broad phase must not lose them. */
static inline bool cs_aabbs_overlap(const struct cs_aabb *a, const struct cs_aabb *b) {
    bool apart = false;
    for (int c = 0; c < 3; c++)
        apart |= a->low[c] > b->high[c] || b->low[c] > a->high[c];
    return !apart;
}

/* Extends a box, which may be empty, to contain another. */
static inline void cs_aabb_merge(struct cs_aabb *box, const struct cs_aabb *other) {
    for (int c = 0; c < 3; c++) {
        box->low[c] = other->low[c] < box->low[c] ? other->low[c] : box->low[c];
        box->high[c] = other->high[c] > box->high[c] ? other->high[c] : box->high[c];
    }
}

/* Cells in compressed row format: cell c has items[cell_starts[c]] to [cell_starts[c + 1] - 1].
 */
struct cs_uniform_grid {
    /* lower corner in m; 1 / edge of a cell in 1/m */
    double origin[3], inverse_cell_size;
    uint32_t dim[3];
    /* (cells + 1) and the items of all cells */
    uint32_t *cell_starts, *items;
    size_t starts_capacity, items_capacity;
};

/* m, longest side; negative: the box is empty */
static inline double cs_aabb_longest_side(const struct cs_aabb *box) {
    double side = -1;
    for (int c = 0; c < 3; c++) {
        const double along = box->high[c] - box->low[c];
        side = along > side ? along : side;
    }
    return side;
}

/* Boxes of one grid: those with side_min < longest side <= side_max. */
struct cs_aabb_set {
    const struct cs_aabb *boxes; /* (n) */
    uint32_t n;
    double side_min, side_max; /* m */
};

/* Puts each box into every cell that it touches; empty boxes into none. Cells are about as
 * large as the mean box, and larger if there would be too many. If boxes are not finite or all
 * are empty, there are no cells (dim 0). Returns false if out of memory, again with dim 0. */
bool cs_uniform_grid_fill(struct cs_uniform_grid *cells, const struct cs_aabb_set *boxes);

/* First and last cell along each axis that a box touches. */
void cs_uniform_grid_range(const struct cs_uniform_grid *cells, const struct cs_aabb *box,
                           uint32_t first[3], uint32_t last[3]);

/* Cell along one axis of a coordinate; those outside the grid have the first or last one. */
static inline uint32_t cs_uniform_grid_index(const struct cs_uniform_grid *cells, double place,
                                             int axis) {
    const double end = cells->dim[axis] - 1;
    const double at = (place - cells->origin[axis]) * cells->inverse_cell_size;
    return (uint32_t)(at > 0 ? at < end ? at : end : 0);
}

/* Number of a cell: x runs fastest. */
static inline size_t cs_uniform_grid_cell(const struct cs_uniform_grid *cells, uint32_t x,
                                          uint32_t y, uint32_t z) {
    return ((size_t)z * cells->dim[1] + y) * cells->dim[0] + x;
}

/* Frees the memory; the grid is empty afterwards. */
void cs_uniform_grid_finish(struct cs_uniform_grid *cells);

enum { CS_AABB_CLUSTER = 16 };

/* Boxes of sixteen items by lanes; NaN: an empty lane, which no comparison finds. */
struct cs_aabb_cluster {
    float low[3][CS_AABB_CLUSTER], high[3][CS_AABB_CLUSTER]; /* m */
};

/* Rectangle of a grid: first and last row and column, inclusive. */
struct cs_grid_rectangle {
    float first[2], last[2];
};

#define CS_NO_ITEM  UINT32_MAX
#define CS_NO_BLOCK UINT32_MAX

/* All clusters of one kind of items. Arrays of n are constant but for the boxes. */
struct cs_aabb_clusters {
    uint32_t n;      /* clusters */
    uint32_t *items; /* (n, CS_AABB_CLUSTER) CS_NO_ITEM: none, with an empty box */
    /* (n) largest item of a cluster */
    uint32_t *max_item;
    /* (n) body of its items */
    uint32_t *body;
    /* (n) block of a grid that it belongs to; CS_NO_BLOCK: its body is no grid */
    uint32_t *grid_block;
    struct cs_aabb_cluster *clusters; /* (n) boxes of items */
    /* (n) common box of each cluster; may be empty */
    struct cs_aabb *cluster_boxes;
    /* grids of the common boxes: usual ones, and those that are far larger than most */
    struct cs_uniform_grid cells[2];
    struct cs_grid_rectangle
        *grid_rectangles; /* (n) that hold all of a cluster; NULL: there is no grid */
};

/* Result of a query for clusters, and its restrictions. */
struct cs_nearby_clusters {
    uint32_t *clusters; /* (n) */
    /* common boxes of the result, in clusters of sixteen */
    struct cs_aabb_cluster *boxes;
    /* result of cs_nearby_clusters_items */
    uint32_t *items;
    size_t n, clusters_capacity, boxes_capacity, items_capacity;
    /* clusters whose items are all below it are skipped */
    uint32_t first_item;
    /* body of the query; same_body_only: clusters of others are skipped, else those of the body
     */
    uint32_t body;
    bool same_body_only;
};

/* Sets a lane; a box with high below low is empty and overlaps nothing. */
void cs_aabb_cluster_set(struct cs_aabb_cluster *cluster, uint32_t lane,
                         const struct cs_aabb *box);

/* Sorts the common boxes into the cells. Returns false if out of memory. */
bool cs_aabb_clusters_sort(struct cs_aabb_clusters *clusters);

/* Finds the clusters that a box overlaps, but for skipped ones and those within the rectangle
 * `but` (NULL: none). Returns false if out of memory. */
bool cs_nearby_clusters_find(struct cs_nearby_clusters *near,
                             const struct cs_aabb_clusters *clusters, const struct cs_aabb *box,
                             const struct cs_grid_rectangle *but);

/* Finds the items of these clusters whose boxes overlap a box, into near->items; returns their
 * number. */
uint32_t cs_nearby_clusters_items(struct cs_nearby_clusters *near,
                                  const struct cs_aabb_clusters *clusters,
                                  const struct cs_aabb *box);

/* Free the memory. */
void cs_nearby_clusters_finish(struct cs_nearby_clusters *near);
void cs_aabb_clusters_finish(struct cs_aabb_clusters *clusters);

#endif
