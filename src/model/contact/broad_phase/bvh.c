/* A bounding volume hierarchy over items along a space-filling curve, halved recursively.
 *
 * Items of each group are sorted by their Morton codes (Morton 1966), so that items next to
 * each other in the order are near in space. Halving the order then gives compact boxes in O(n
 * log n) and needs no cost function. The upper levels are cut between groups where possible,
 * since two bodies move apart and would inflate a common box.
 *
 * A query descends pairs of nodes. The pair (root, root) is refined breadth first until there
 * are enough jobs for the threads; each job then descends depth first on its own. */
#include "model/contact/broad_phase/bvh.h"

#include <math.h>
#include <stdlib.h>

/* Number of jobs from which pairs of nodes are not refined further. A refinement gives at most
 * three pairs for one, so that fewer than CS_BVH_PAIRS_MAX result. */
enum { JOBS_ENOUGH = CS_BVH_PAIRS_MAX / 4 };

/* bits per coordinate: three of them fit into a 64-bit code */
enum { CURVE_BITS = 20 };

/* An item with its code. */
struct placed {
    uint64_t code;
    uint32_t item;
};

/* Order by code, then by item: the result of qsort is unique. */
static int by_code(const void *left, const void *right) {
    const struct placed *a = left, *b = right;
    if (a->code != b->code)
        return a->code < b->code ? -1 : 1;
    return (a->item > b->item) - (a->item < b->item);
}

/* Morton code of a point in the cube with corner `low` and edge `side`: the bits of the three
 * coordinates interleaved, highest first. NaN counts as the lower side. */
static uint64_t code_of(const double p[3], const double low[3], double side) {
    uint64_t code = 0, place[3];
    for (int c = 0; c < 3; c++) {
        const double share = side > 0 ? (p[c] - low[c]) / side : 0;
        // not a number is put first
        place[c] = share > 0 ? (uint64_t)(fmin(share, 1) * ((1 << CURVE_BITS) - 1)) : 0;
    }
    for (int bit = CURVE_BITS - 1; bit >= 0; bit--)
        for (int c = 0; c < 3; c++)
            code = code << 1 | (place[c] >> bit & 1);
    return code;
}

/* Sorts the items first..end - 1 of one group along the curve through their bounding cube. */
static void sort_group(const double *centres, uint32_t first, uint32_t end,
                       struct placed *placed, uint32_t *items) {
    double low[3] = {DBL_MAX, DBL_MAX, DBL_MAX}, high[3] = {-DBL_MAX, -DBL_MAX, -DBL_MAX};
    double side = 0;
    for (size_t k = first; k < end; k++)
        for (size_t c = 0; c < 3; c++)
            cs_swept_aabb_widen(low + c, high + c, centres[3 * k + c], centres[3 * k + c]);
    for (int c = 0; c < 3; c++)
        side = fmax(side, high[c] - low[c]);
    for (uint32_t k = first; k < end; k++)
        placed[k] = (struct placed){code_of(centres + 3 * (size_t)k, low, side), k};
    qsort(placed + first, end - first, sizeof *placed, by_code);
    for (uint32_t k = first; k < end; k++)
        items[k] = placed[k].item;
}

/* Position to cut [first, end) at: the begin of a group nearest to the middle, or the middle if
 * all of it is one group. */
static uint32_t place_to_cut(const uint32_t *groups, uint32_t n_groups, uint32_t first,
                             uint32_t end) {
    const uint32_t middle = first + (end - first) / 2;
    uint32_t best = middle, nearest = UINT32_MAX;
    for (uint32_t g = 1; g < n_groups; g++) {
        const uint32_t at = groups[g], far = at > middle ? at - middle : middle - at;
        if (at > first && at < end && far < nearest) {
            nearest = far;
            best = at;
        }
    }
    return best;
}

/* Adds the node of [first, end) and, depth first, its descendants. */
static void add_nodes(struct cs_bvh *tree, const uint32_t *groups, uint32_t n_groups,
                      uint32_t first, uint32_t end) {
    const uint32_t here = tree->n_nodes++;
    struct cs_bvh_node *node = tree->nodes + here;
    node->first = first;
    node->end = end;
    const uint32_t cut = place_to_cut(groups, n_groups, first, end);
    if (end - first <= CS_BOX_LEAF)
        return;
    add_nodes(tree, groups, n_groups, first, cut);
    node->right = tree->n_nodes;
    add_nodes(tree, groups, n_groups, cut, end);
}

/* A cut in the middle leaves leaves of at least two items; a cut at the end of a group may
 * leave one. So there are at most n/2 + n_groups leaves, and fewer than n + 2 n_groups nodes.
 */
enum cs_status cs_bvh_init(struct cs_bvh *tree, const double *centres, const uint32_t *first,
                           uint32_t n_groups, struct cs_arena *arena, struct cs_error *error) {
    const uint32_t n = first[n_groups];

    const size_t nodes_most = n + 2 * (size_t)n_groups + 1;
    *tree = (struct cs_bvh){.n = n};
    struct placed *placed = calloc(n ? n : 1, sizeof *placed);
    tree->items = cs_arena_alloc_array(arena, n, sizeof *tree->items, error);
    tree->nodes = cs_arena_alloc_array(arena, nodes_most, sizeof *tree->nodes, error);
    tree->boxes = cs_arena_alloc_array(arena, n, sizeof *tree->boxes, error);
    tree->jobs = cs_arena_alloc_array(arena, CS_BVH_PAIRS_MAX, sizeof *tree->jobs, error);
    if (!placed)
        cs_fail(error, CS_ERR_MEMORY, "out of memory for %u parts of surfaces", n);
    for (uint32_t g = 0; g < n_groups && !error->status; g++)
        sort_group(centres, first[g], first[g + 1], placed, tree->items);
    if (n && !error->status)
        add_nodes(tree, first, n_groups, 0, n);
    free(placed);
    return error->status;
}

/* Refits all boxes in one pass from the last node to the first: children come after their
 * parents in memory, so they are ready before them. */
static void set_boxes(struct cs_bvh *tree) {
    // children have higher numbers than their parents
    for (uint32_t k = tree->n_nodes; k-- > 0;) {
        struct cs_bvh_node *node = tree->nodes + k;
        node->box = cs_swept_aabb_empty();
        if (node->right) {
            cs_swept_aabb_merge(&node->box, &tree->nodes[k + 1].box);
            cs_swept_aabb_merge(&node->box, &tree->nodes[node->right].box);
        } else
            for (uint32_t i = node->first; i < node->end; i++)
                cs_swept_aabb_merge(&node->box, tree->boxes + tree->items[i]);
    }
}

/* Refines a pair of nodes into at most three pairs that may meet. Returns 0 if the pair does
 * not meet, and 1 with the pair itself for two leaves. A node paired with itself gives both
 * children with themselves and with each other; otherwise the node with more items is split. */
static uint32_t cut(const struct cs_bvh *tree, struct cs_bvh_pair pair,
                    struct cs_bvh_pair parts[3]) {
    const struct cs_bvh_node *a = tree->nodes + pair.a, *b = tree->nodes + pair.b;
    if (pair.a == pair.b && a->right) {
        parts[0] = (struct cs_bvh_pair){pair.a + 1, pair.a + 1};
        parts[1] = (struct cs_bvh_pair){a->right, a->right};
        parts[2] = (struct cs_bvh_pair){pair.a + 1, a->right};
        return 3;
    }
    parts[0] = parts[1] = pair;
    if (pair.a != pair.b && !cs_swept_aabbs_overlap(&a->box, &b->box, tree->max_distance))
        return 0;
    if (!a->right && !b->right)
        return 1;
    // the one with more in it
    const bool first = !b->right || (a->right && a->end - a->first >= b->end - b->first);
    if (first) {
        parts[0].a = pair.a + 1;
        parts[1].a = a->right;
    } else {
        parts[0].b = pair.b + 1;
        parts[1].b = b->right;
    }
    return 2;
}

/* Returns whether a pair cannot be refined. */
static bool is_leaf_pair(const struct cs_bvh *tree, struct cs_bvh_pair pair) {
    return !tree->nodes[pair.a].right && !tree->nodes[pair.b].right;
}

/* Refines all pairs once per pass, until there are enough jobs or only leaves. */
static void distribute(struct cs_bvh *tree) {
    struct cs_bvh_pair next[CS_BVH_PAIRS_MAX];
    tree->jobs[0] = (struct cs_bvh_pair){0, 0};
    tree->n_jobs = tree->n > 0;
    bool more = tree->n > 0;
    while (more && tree->n_jobs < JOBS_ENOUGH) {
        uint32_t n = 0;
        more = false;
        for (uint32_t k = 0; k < tree->n_jobs; k++) {
            n += cut(tree, tree->jobs[k], next + n);
            more |= !is_leaf_pair(tree, tree->jobs[k]);
        }
        for (uint32_t k = 0; k < n; k++)
            tree->jobs[k] = next[k];
        tree->n_jobs = n;
    }
}

/* Refits in O(n) and distributes; the topology does not change. */
void cs_bvh_update(struct cs_bvh *tree, double reach) {
    tree->max_distance = reach;
    set_boxes(tree);
    distribute(tree);
}

/* Visits the pairs of items of two leaves, or of one leaf with itself. */
static void visit_items(const struct cs_bvh *tree, struct cs_bvh_pair pair,
                        cs_bvh_visitor *visit, void *arg) {
    const struct cs_bvh_node *a = tree->nodes + pair.a, *b = tree->nodes + pair.b;
    for (uint32_t k = a->first; k < a->end; k++)
        for (uint32_t l = pair.a == pair.b ? k + 1 : b->first; l < b->end; l++) {
            const uint32_t i = tree->items[k], j = tree->items[l];
            if (cs_swept_aabbs_overlap(tree->boxes + i, tree->boxes + j, tree->max_distance))
                visit(arg, i < j ? i : j, i < j ? j : i);
        }
}

/* Descends a pair of nodes depth first; at most three pairs per level are pending. */
static void visit_pair(const struct cs_bvh *tree, struct cs_bvh_pair pair,
                       cs_bvh_visitor *visit, void *arg) {
    struct cs_bvh_pair parts[3];
    const uint32_t n = cut(tree, pair, parts);
    if (n == 1)
        visit_items(tree, pair, visit, arg);
    for (uint32_t k = 0; n > 1 && k < n; k++)
        visit_pair(tree, parts[k], visit, arg);
}

void cs_bvh_visit(const struct cs_bvh *tree, uint32_t job, cs_bvh_visitor *visit, void *arg) {
    visit_pair(tree, tree->jobs[job], visit, arg);
}
