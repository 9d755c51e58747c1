/* aabb_clusters.h - bounding boxes in clusters of sixteen. One vector comparison tests all
 * boxes of a cluster, and only clusters whose common box overlaps are tested.
 *
 * Single precision suffices: rounding is monotone, so that boxes that overlap still do after
 * all their bounds were rounded alike. */
#ifndef CS_BROAD_PHASE_AABB_CLUSTERS_H
#define CS_BROAD_PHASE_AABB_CLUSTERS_H

#include "model/system/particle_system.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Axis-aligned boxes sorted into the cells of a uniform grid by counting:
 * integer keys, no pointers, items of a cell in ascending order. */

/* Axis-aligned bounding box in m; empty if high is below low. */
struct cs_aabb {
    double low[3], high[3]; /* m */
};

/* Boxes that touch overlap, as do boxes with NaN: a broad phase must not lose them. */
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

enum { CS_AABB_CLUSTER = 16 };

/* Boxes of sixteen items by lanes; NaN: an empty lane, which no comparison finds. */
struct cs_aabb_cluster {
    float low[3][CS_AABB_CLUSTER], high[3][CS_AABB_CLUSTER]; /* m */
};

#define CS_NO_ITEM UINT32_MAX

/* All clusters of one kind of items. Arrays of n are constant but for the boxes. */
struct cs_aabb_clusters {
    uint32_t n;      /* clusters */
    uint32_t *items; /* (n, CS_AABB_CLUSTER) CS_NO_ITEM: none, with an empty box */
    /* (n) largest item of a cluster */
    uint32_t *max_item;
    /* (n) body of its items */
    uint32_t *body;
    struct cs_aabb_cluster *clusters; /* (n) boxes of items */
    /* (n) common box of each cluster; may be empty */
    struct cs_aabb *cluster_boxes;
    /* grids of the common boxes: usual ones, and those that are far larger than most */
    struct cs_uniform_grid grid[2];
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
    uint32_t body; /* clusters of others are skipped */
};

/* Sets a lane; a box with high below low is empty and overlaps nothing. */
void cs_aabb_cluster_set(struct cs_aabb_cluster *cluster, uint32_t lane,
                         const struct cs_aabb *box);

/* Sorts the common boxes into the cells. Returns false if out of memory. */
bool cs_aabb_clusters_sort(struct cs_aabb_clusters *clusters);

/* Finds the clusters that a box overlaps, but for skipped ones. Returns false if out of memory.
 */
bool cs_nearby_clusters_find(struct cs_nearby_clusters *nearby,
                             const struct cs_aabb_clusters *clusters,
                             const struct cs_aabb *box);

/* Finds the items of these clusters whose boxes overlap a box, into near->items; returns their
 * number. */
uint32_t cs_nearby_clusters_items(struct cs_nearby_clusters *nearby,
                                  const struct cs_aabb_clusters *clusters,
                                  const struct cs_aabb *box);

/* Free the memory. */
void cs_nearby_clusters_finish(struct cs_nearby_clusters *nearby);
void cs_aabb_clusters_finish(struct cs_aabb_clusters *clusters);

/* Assigns items to clusters: items of a grid by blocks, others in their
 * order. */

/* Points, edges or triangles of all bodies; everything is borrowed during the call. */
struct cs_cluster_input {
    const uint32_t *vertices; /* (n, each) points of an item; NULL: it is one itself */
    uint32_t vertices_per_item;
    const uint32_t *first; /* (n_bodies + 1) items of each body */
    uint32_t n_bodies;
    /* (n_ranges) particles of the first of these bodies: grids are sorted by blocks */
    const struct cs_body_range *bodies;
    uint32_t n_ranges;
};

/* Allocates and fills all of the clusters but their boxes. The arena owns the arrays.
 * CS_ERR_MEMORY. */
enum cs_status cs_cluster_input_build(const struct cs_cluster_input *input,
                                      struct cs_aabb_clusters *clusters, struct cs_arena *arena,
                                      struct cs_error *error);

#endif
