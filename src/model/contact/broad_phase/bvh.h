/* bvh.h - pairs of items that may meet during a move, from a tree of boxes.
 *
 * The tree is made once from where the items are at the start, body by body, since what is
 * beside each other on a surface stays so; for each question its boxes alone are set anew. No
 * pair that meets is left out, whatever the boxes have become; which pairs that do not meet are
 * tried too, and in which order, is a matter of speed. */
#ifndef CS_BVH_H
#define CS_BVH_H

#include "base/arena.h"
#include "model/contact/broad_phase/swept_aabb.h"

#include <stdint.h>

/* Items of a leaf at most. */
enum { CS_BOX_LEAF = 4 };

/* Node k of a tree that is written down depth first: its left child is k + 1. */
struct cs_bvh_node {
    struct cs_swept_aabb box;
    uint32_t first, end; /* places in items */
    uint32_t right;      /* its right child; 0: a leaf */
};

/* Pairs of nodes whose items are to be tried against each other: shares of the work. */
enum { CS_BVH_PAIRS_MAX = 1024 };
struct cs_bvh_pair {
    uint32_t a, b;
};

struct cs_bvh {
    uint32_t n, n_nodes, n_jobs;
    uint32_t *items; /* (n) */
    struct cs_bvh_node *nodes;
    struct cs_swept_aabb *boxes; /* (n) of the items */
    struct cs_bvh_pair *jobs;    /* (CS_BVH_PAIRS_MAX) */
    double max_distance;         /* m, of the last update */
};

/* Makes the tree over n items with those centres (n,3); items first[g] to first[g + 1] - 1 are
 * group g. The arena owns it. CS_ERR_MEMORY. */
enum cs_status cs_bvh_init(struct cs_bvh *tree, const double *centres, const uint32_t *first,
                           uint32_t n_groups, struct cs_arena *arena, struct cs_error *error);

/* Sets the boxes from tree->swept boxes, which the caller has filled, and shares the work out.
 */
void cs_bvh_update(struct cs_bvh *tree, double reach);

/* Calls visit(arg, i, j) with i < j for all pairs of a job whose swept boxes meet within reach;
 * the jobs 0..tree->n_jobs - 1 together have each pair once, in an order that depends on
 * nothing but the swept boxes. */
typedef void cs_bvh_visitor(void *arg, uint32_t i, uint32_t j);
void cs_bvh_visit(const struct cs_bvh *tree, uint32_t job, cs_bvh_visitor *visit, void *arg);

#endif
