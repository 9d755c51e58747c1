/* aabb_clusters.h - boxes by sixteens: those that meet a box are found with one comparison for
 * all of a sixteen, and only in sixteens that the box meets as a whole.
 *
 * Single precision is enough: rounding keeps the order of numbers, so that boxes that meet do
 * so when all are rounded. */
#ifndef CS_BROAD_PHASE_AABB_CLUSTERS_H
#define CS_BROAD_PHASE_AABB_CLUSTERS_H

#include "model/contact/broad_phase/uniform_grid.h"

enum { CS_AABB_CLUSTER = 16 };

struct cs_aabb_cluster {
    float low[3][CS_AABB_CLUSTER], high[3][CS_AABB_CLUSTER]; /* m */
};

/* A rectangle of a grid: rows and columns, first and last. */
struct cs_grid_rectangle {
    float first[2], last[2];
};

#define CS_NO_ITEM  UINT32_MAX
#define CS_NO_BLOCK UINT32_MAX

struct cs_aabb_clusters {
    uint32_t n;           /* clusters */
    uint32_t *items;      /* (n, CS_AABB_CLUSTER) CS_NO_ITEM: none, with an empty box */
    uint32_t *max_item;   /* (n) greatest item */
    uint32_t *body;       /* (n) that the items are of */
    uint32_t *grid_block; /* (n) of cs_cluster_input_build, of a grid; or CS_NO_BLOCK */
    struct cs_aabb_cluster *clusters; /* (n) boxes of items */
    struct cs_aabb *cluster_boxes;    /* (n) of clusters; may be empty */
    struct cs_uniform_grid cells[2];  /* of them, and of those that are far larger than most */
    struct cs_grid_rectangle
        *grid_rectangles; /* (n) that hold all of a cluster; NULL: there is no grid */
};

/* Clusters that may meet any of some boxes. */
struct cs_nearby_clusters {
    uint32_t *clusters;            /* (n) */
    struct cs_aabb_cluster *boxes; /* those of clusters, by sixteens */
    uint32_t *items;               /* what cs_nearby_clusters_items found */
    size_t n, clusters_capacity, boxes_capacity, items_capacity;
    uint32_t first_item; /* clusters of items before it are passed over */
    uint32_t body;       /* and those of this body, or with `own` of others */
    bool same_body_only;
};

/* Sets a lane; a box with high below low is empty, and met by none. */
void cs_aabb_cluster_set(struct cs_aabb_cluster *cluster, uint32_t lane,
                         const struct cs_aabb *box);

/* Sorts the boxes into cells. false: no memory. */
bool cs_aabb_clusters_sort(struct cs_aabb_clusters *clusters);

/* Sets near to the clusters that are not passed over and that a box meets; those that are
 * wholly in `but` are left out (NULL: none). false: no memory. */
bool cs_nearby_clusters_find(struct cs_nearby_clusters *near,
                             const struct cs_aabb_clusters *clusters, const struct cs_aabb *box,
                             const struct cs_grid_rectangle *but);

/* Items of these clusters whose boxes meet a box, into near->items; returns how many. */
uint32_t cs_nearby_clusters_items(struct cs_nearby_clusters *near,
                                  const struct cs_aabb_clusters *clusters,
                                  const struct cs_aabb *box);

/* Give memory back. */
void cs_nearby_clusters_finish(struct cs_nearby_clusters *near);
void cs_aabb_clusters_finish(struct cs_aabb_clusters *clusters);

#endif
