/* bvh.h - pairs of items that may meet during a move, from a tree of swept boxes.
 *
 * The topology is built once from the positions at the start, body by body, because neighbours
 * on a surface stay neighbours. Each query only refits the boxes. Every pair that meets is
 * found, whatever shape the boxes have taken; only the number of tests and their order depend
 * on the quality of the tree.
 *
 * Nodes are stored depth first: the left child of node k is k + 1, and a node with all its
 * descendants is a contiguous range. The root is 0. */
#ifndef CS_BVH_H
#define CS_BVH_H

#include "base/arena.h"
#include "model/contact/broad_phase/swept_aabb.h"

#include <stdint.h>

/* largest number of items of a leaf */
enum { CS_BOX_LEAF = 4 };

/* One node and its box. */
struct cs_bvh_node {
    struct cs_swept_aabb box;
    /* its items are items[first] to items[end - 1] of the tree */
    uint32_t first, end;
    /* right child; 0: it is a leaf */
    uint32_t right;
};

/* Pairs of nodes whose items are tested against each other: the units of work of threads. */
enum { CS_BVH_PAIRS_MAX = 1024 };
struct cs_bvh_pair {
    uint32_t a, b;
};

/* A tree, the boxes of its items and the jobs of the last update. */
struct cs_bvh {
    uint32_t n, n_nodes, n_jobs;
    /* (n) items in the order of the leaves */
    uint32_t *items;
    struct cs_bvh_node *nodes;
    /* (n) boxes of the items; the caller fills them before cs_bvh_update */
    struct cs_swept_aabb *boxes;
    /* (CS_BVH_PAIRS_MAX), n_jobs of them in use */
    struct cs_bvh_pair *jobs;
    /* m, reach of the last update */
    double max_distance;
};

/* Builds the tree over n items with the centres (n,3) in m; items first[g] to first[g + 1] - 1
 * are group g. The arena owns the tree; boxes are not set. CS_ERR_MEMORY. */
enum cs_status cs_bvh_init(struct cs_bvh *tree, const double *centres, const uint32_t *first,
                           uint32_t n_groups, struct cs_arena *arena, struct cs_error *error);

/* Refits all nodes to tree->boxes, and splits the work into jobs. Pairs within `reach` in m
 * count as meeting. */
void cs_bvh_update(struct cs_bvh *tree, double reach);

/* Calls visit(arg, i, j) with i < j for the pairs of a job whose swept boxes come within reach.
 * The jobs 0 to tree->n_jobs - 1 visit each such pair once, in an order that depends on the
 * boxes alone. Threads may visit different jobs at the same time. */
typedef void cs_bvh_visitor(void *arg, uint32_t i, uint32_t j);
void cs_bvh_visit(const struct cs_bvh *tree, uint32_t job, cs_bvh_visitor *visit, void *arg);

#endif
