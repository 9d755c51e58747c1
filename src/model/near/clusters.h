/* clusters.h - boxes by sixteens: those that meet a box are found with one comparison for all
 * of a sixteen, and only in sixteens that the box meets as a whole.
 *
 * Single precision is enough: rounding keeps the order of numbers, so that boxes that meet do
 * so when all are rounded. */
#ifndef CS_NEAR_CLUSTERS_H
#define CS_NEAR_CLUSTERS_H

#include "model/near/cells.h"

enum { CS_CLUSTER = 16 };

struct cs_cluster {
    float low[3][CS_CLUSTER], high[3][CS_CLUSTER]; /* m */
};

/* A rectangle of a grid: rows and columns, first and last. */
struct cs_cluster_span {
    float first[2], last[2];
};

#define CS_NO_ITEM  UINT32_MAX
#define CS_NO_BLOCK UINT32_MAX

struct cs_clusters {
    uint32_t n;                    /* clusters */
    uint32_t *items;               /* (n, CS_CLUSTER) CS_NO_ITEM: none, with an empty box */
    uint32_t *last;                /* (n) greatest item */
    uint32_t *body;                /* (n) that the items are of */
    uint32_t *block;               /* (n) of cs_order_build, of a grid; or CS_NO_BLOCK */
    struct cs_cluster *of;         /* (n) boxes of items */
    struct cs_cell_box *boxes;     /* (n) of clusters; may be empty */
    struct cs_cells cells[2];      /* of them, and of those that are far larger than most */
    struct cs_cluster_span *spans; /* (n) that hold all of a cluster; NULL: there is no grid */
};

/* Clusters that may meet any of some boxes. */
struct cs_cluster_near {
    uint32_t *clusters;       /* (n) */
    struct cs_cluster *boxes; /* those of clusters, by sixteens */
    uint32_t *items;          /* what cs_cluster_near_items found */
    size_t n, clusters_room, boxes_room, items_room;
    uint32_t least; /* clusters of items before it are passed over */
    uint32_t body;  /* and those of this body, or with `own` of others */
    bool own;
};

/* Sets a lane; a box with high below low is empty, and met by none. */
void cs_cluster_set(struct cs_cluster *cluster, uint32_t lane, const struct cs_cell_box *box);

/* Sorts the boxes into cells. false: no memory. */
bool cs_clusters_sort(struct cs_clusters *clusters);

/* Sets near to the clusters that are not passed over and that a box meets; those that are
 * wholly in `but` are left out (NULL: none). false: no memory. */
bool cs_cluster_near_find(struct cs_cluster_near *near, const struct cs_clusters *clusters,
                          const struct cs_cell_box *box, const struct cs_cluster_span *but);

/* Items of these clusters whose boxes meet a box, into near->items; returns how many. */
uint32_t cs_cluster_near_items(struct cs_cluster_near *near, const struct cs_clusters *clusters,
                               const struct cs_cell_box *box);

/* Give memory back. */
void cs_cluster_near_finish(struct cs_cluster_near *near);
void cs_clusters_finish(struct cs_clusters *clusters);

#endif
