/* aabb_clusters.h - bounding boxes in clusters of sixteen. One vector comparison tests all
 * boxes of a cluster, and only clusters whose common box overlaps are tested.
 *
 * Single precision suffices: rounding is monotone, so that boxes that overlap still do after
 * all their bounds were rounded alike. */
#ifndef CS_BROAD_PHASE_AABB_CLUSTERS_H
#define CS_BROAD_PHASE_AABB_CLUSTERS_H

#include "model/contact/broad_phase/uniform_grid.h"

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
