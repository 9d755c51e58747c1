/* aabb_tree.h - bounding boxes in a tree with sixteen branches a node. One vector comparison
 * tests all boxes of a node.
 *
 * Items stay in their order, in which neighbours follow each other: a leaf has the boxes of
 * sixteen items of one body, a node of a level above the common boxes of sixteen nodes below,
 * up to one root. Nothing is sorted, and what is found is in the order of the items.
 *
 * Single precision suffices: rounding is monotone, so that boxes that overlap still do after
 * all their bounds were rounded alike. */
#ifndef CS_BROAD_PHASE_AABB_TREE_H
#define CS_BROAD_PHASE_AABB_TREE_H

#include "base/arena.h"

#include <math.h>
#include <stdint.h>

/* Boxes per node; levels, with which all numbers of items have a tree. */
enum { CS_AABB_NODE = 16, CS_AABB_LEVELS = 9 };

/* Axis-aligned bounding box in m; empty if high is below low. */
struct cs_aabb {
    float low[3], high[3];
};

/* Boxes of sixteen items or nodes by lanes; NaN: an empty one, which no comparison finds. */
struct cs_aabb_node {
    float low[3][CS_AABB_NODE], high[3][CS_AABB_NODE]; /* m */
};

/* All items of one kind. */
struct cs_aabb_tree {
    const uint32_t *first; /* (n_bodies + 1) items of each body; borrowed */
    uint32_t n_bodies;
    uint32_t *first_leaf; /* (n_bodies + 1) leaves of each body */
    struct cs_aabb_node *levels[CS_AABB_LEVELS];
    uint32_t n_nodes[CS_AABB_LEVELS], n_levels; /* leaves first; the last level has one node */
};

/* Up to sixteen leaves of one body near a box, with their boxes. */
struct cs_near_leaves {
    uint32_t body, n, leaves[CS_AABB_NODE];
    struct cs_aabb_node boxes;
};

/* The result of a search. */
struct cs_near_list {
    struct cs_near_leaves *items; /* (n) in the order of the leaves */
    size_t n, capacity;
    bool failed; /* there was no memory */
};

/* Makes a tree without boxes. The arena owns the arrays. CS_ERR_MEMORY. */
enum cs_status cs_aabb_tree_init(struct cs_aabb_tree *tree, const uint32_t *first,
                                 uint32_t n_bodies, struct cs_arena *arena,
                                 struct cs_error *error);

/* First item of a leaf of a body. */
static inline uint32_t cs_aabb_tree_item(const struct cs_aabb_tree *tree, uint32_t body,
                                         uint32_t leaf) {
    return tree->first[body] + CS_AABB_NODE * (leaf - tree->first_leaf[body]);
}

/* Sets one box of a node. */
static inline void cs_aabb_node_set(struct cs_aabb_node *node, uint32_t lane,
                                    const struct cs_aabb *box) {
    for (int c = 0; c < 3; c++) {
        // of an empty one no number is true of anything, even of a box without end
        const bool some = box->high[c] >= box->low[c];
        node->low[c][lane] = some ? box->low[c] : NAN;
        node->high[c][lane] = some ? box->high[c] : NAN;
    }
}

/* Sets the boxes of all levels above the leaves. */
void cs_aabb_tree_fit(struct cs_aabb_tree *tree);

/* Bit mask of the boxes of a node that overlap a box; boxes that touch overlap. */
uint32_t cs_aabb_node_overlaps(const struct cs_aabb_node *node, const struct cs_aabb *box);

/* Appends the leaves of a body that a box overlaps, from the one of an item on. An empty box is
 * from infinity to -infinity. */
void cs_aabb_tree_find(const struct cs_aabb_tree *tree, uint32_t body, uint32_t item,
                       const struct cs_aabb *box, struct cs_near_list *near);

#endif
