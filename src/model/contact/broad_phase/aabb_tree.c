/* The levels of a tree of boxes, and the search down from its root. */
#include "model/contact/broad_phase/aabb_tree.h"

#include <clothsim/clones.h>
#include <string.h>

static uint32_t nodes_of(uint32_t n) {
    return (n + CS_AABB_NODE - 1) / CS_AABB_NODE;
}

enum cs_status cs_aabb_tree_init(struct cs_aabb_tree *tree, const uint32_t *first,
                                 uint32_t n_bodies, struct cs_arena *arena,
                                 struct cs_error *error) {
    *tree = (struct cs_aabb_tree){.first = first, .n_bodies = n_bodies};
    if (!CS_ARENA_ARRAY(arena, tree->first_leaf, n_bodies + (size_t)1, error))
        return error->status;
    for (uint32_t b = 0; b < n_bodies; b++)
        tree->first_leaf[b + 1] = tree->first_leaf[b] + nodes_of(first[b + 1] - first[b]);
    for (uint32_t n = tree->first_leaf[n_bodies]; n && !error->status; n = nodes_of(n)) {
        const uint32_t level = tree->n_levels++;
        tree->n_nodes[level] = n;
        // bytes of ones are NaN
        if (CS_ARENA_ARRAY(arena, tree->levels[level], n, error))
            memset(tree->levels[level], 0xff, n * sizeof *tree->levels[level]);
        // leaves have a root above them
        if (n == 1 && level > 0)
            break;
    }
    return error->status;
}

/* Common box of a node; NaN extends nothing. */
static struct cs_aabb bound(const struct cs_aabb_node *node) {
    struct cs_aabb box;
    for (int c = 0; c < 3; c++) {
        box.low[c] = INFINITY;
        box.high[c] = -INFINITY;
        for (int l = 0; l < CS_AABB_NODE; l++) {
            box.low[c] = node->low[c][l] < box.low[c] ? node->low[c][l] : box.low[c];
            box.high[c] = node->high[c][l] > box.high[c] ? node->high[c][l] : box.high[c];
        }
    }
    return box;
}

void cs_aabb_tree_fit(struct cs_aabb_tree *tree) {
    for (uint32_t level = 1; level < tree->n_levels; level++)
        for (uint32_t k = 0; k < tree->n_nodes[level - 1]; k++) {
            const struct cs_aabb box = bound(tree->levels[level - 1] + k);
            cs_aabb_node_set(tree->levels[level] + k / CS_AABB_NODE, k % CS_AABB_NODE, &box);
        }
}

/* Comparisons with NaN are false, so that empty lanes never match. */
CS_CLONES uint32_t cs_aabb_node_overlaps(const struct cs_aabb_node *node,
                                         const struct cs_aabb *box) {
    uint32_t bits = 0;
    for (int l = 0; l < CS_AABB_NODE; l++) {
        uint32_t hit = node->low[0][l] <= box->high[0];
        hit &= node->low[1][l] <= box->high[1];
        hit &= node->low[2][l] <= box->high[2];
        hit &= node->high[0][l] >= box->low[0];
        hit &= node->high[1][l] >= box->low[1];
        hit &= node->high[2][l] >= box->low[2];
        bits |= hit << l;
    }
    return bits;
}

/* Appends a leaf with its box. */
static void append(const struct cs_aabb_tree *tree, uint32_t body, uint32_t leaf,
                   struct cs_near_list *near) {
    const struct cs_aabb_node *node = tree->levels[1] + leaf / CS_AABB_NODE;
    struct cs_near_leaves *last = near->n ? near->items + near->n - 1 : NULL;
    if (!last || last->body != body || last->n == CS_AABB_NODE) {
        if (!CS_ARENA_REALLOC(near->items, near->capacity, near->n + 1)) {
            near->failed = true;
            return;
        }
        // bytes of ones are NaN
        last = near->items + near->n++;
        last->body = body, last->n = 0;
        memset(&last->boxes, 0xff, sizeof last->boxes);
    }
    for (int c = 0; c < 3; c++) {
        last->boxes.low[c][last->n] = node->low[c][leaf % CS_AABB_NODE];
        last->boxes.high[c][last->n] = node->high[c][leaf % CS_AABB_NODE];
    }
    last->leaves[last->n++] = leaf;
}

/* One search. */
struct search {
    const struct cs_aabb_tree *tree;
    const struct cs_aabb *box;
    uint32_t body;
    uint64_t begin, end; /* leaves */
    struct cs_near_list *near;
};

/* Searches the branches of a node of a level above the leaves. */
static void visit(const struct search *search, uint32_t level, uint32_t node) {
    const uint64_t span = (uint64_t)1 << 4 * (level - 1);
    for (uint32_t bits = cs_aabb_node_overlaps(search->tree->levels[level] + node, search->box);
         bits; bits &= bits - 1) {
        const uint32_t branch = CS_AABB_NODE * node + (uint32_t)__builtin_ctz(bits);
        if (branch * span >= search->end || (branch + 1) * span <= search->begin)
            continue;
        // a node above leaves has these as its branches
        if (level > 1)
            visit(search, level - 1, branch);
        else
            append(search->tree, search->body, branch, search->near);
    }
}

void cs_aabb_tree_find(const struct cs_aabb_tree *tree, uint32_t body, uint32_t item,
                       const struct cs_aabb *box, struct cs_near_list *near) {
    const uint32_t first = tree->first[body];
    const struct search search = {.tree = tree,
                                  .box = box,
                                  .body = body,
                                  .begin = tree->first_leaf[body] +
                                           (item > first ? (item - first) / CS_AABB_NODE : 0),
                                  .end = tree->first_leaf[body + 1],
                                  .near = near};
    if (tree->n_levels)
        visit(&search, tree->n_levels - 1, 0);
}
