/* Trees of boxes, and what is found in them. */
#include "model/contact/broad_phase/aabb_tree.h"
#include "unit.h"

/* a number in -1..1, always the same ones */
static double draw(uint64_t *state) {
    *state = *state * 6364136223846793005u + 1442695040888963407u;
    return (double)(*state >> 11) / 4503599627370496.0 - 1;
}

/* a box of a size, empty ones among them; every fiftieth large */
static struct cs_aabb draw_box(uint64_t *seed, uint32_t number) {
    struct cs_aabb box;
    const double size = number % 50 == 7 ? 40 : number % 50 == 8 ? -1 : 0.05;
    for (int c = 0; c < 3; c++) {
        const double low = draw(seed) - (size > 1 ? size / 2 : 0);
        const double high = low + size * (1.5 + draw(seed));
        box.low[c] = size < 0 ? INFINITY : (float)low;
        box.high[c] = size < 0 ? -INFINITY : (float)high;
    }
    return box;
}

static bool overlap(const struct cs_aabb *a, const struct cs_aabb *b) {
    bool meet = true;
    for (int c = 0; c < 3; c++)
        meet = meet && a->low[c] <= a->high[c] && b->low[c] <= b->high[c] &&
               a->low[c] <= b->high[c] && b->low[c] <= a->high[c];
    return meet;
}

/* bodies of many items, of none, and of a few; three levels and a root */
enum { BODIES = 4, BOXES = 5000, QUERIES = 300 };
static const uint32_t first[BODIES + 1] = {0, 4900, 4900, 4917, BOXES};

/* Counts what a query finds, and that it comes in ascending order, without items before. */
static uint32_t look(const struct cs_aabb_tree *tree, const struct cs_aabb *boxes,
                     const struct cs_aabb *box, uint32_t body, uint32_t from) {
    static struct cs_near_list near;
    uint32_t n = 0, next = 0;
    near.n = 0;
    cs_aabb_tree_find(tree, body, from, box, &near);
    ck_assert(!near.failed);
    for (size_t k = 0; k < near.n; k++)
        for (uint32_t l = 0; l < near.items[k].n; l++) {
            const uint32_t leaf = near.items[k].leaves[l];
            uint32_t item = cs_aabb_tree_item(tree, body, leaf);
            ck_assert_uint_eq(near.items[k].body, body);
            ck_assert(item >= next && item + CS_AABB_NODE > from);
            next = item + CS_AABB_NODE;
            ck_assert(cs_aabb_node_overlaps(&near.items[k].boxes, box) >> l & 1);
            for (uint32_t bits = cs_aabb_node_overlaps(tree->levels[0] + leaf, box); bits;
                 bits /= 2, item++)
                if (bits & 1) {
                    ck_assert(item < first[body + 1] && overlap(box, boxes + item));
                    n += item >= from;
                }
        }
    return n;
}

TEST(items_near_a_box_are_found) {
    static struct cs_aabb boxes[BOXES];
    struct cs_arena arena = {0};
    struct cs_error error = {0};
    struct cs_aabb_tree tree;
    uint64_t seed = 3;
    uint32_t found = 0;
    ck_assert_int_eq(cs_aabb_tree_init(&tree, first, BODIES, &arena, &error), CS_OK);
    ck_assert_uint_eq(tree.n_levels, 4);
    ck_assert_uint_eq(tree.n_nodes[3], 1);
    // what a tree held before is gone after it is fitted again
    for (int time = 0; time < 2; time++) {
        for (uint32_t b = 0; b < BODIES; b++)
            for (uint32_t k = first[b]; k < first[b + 1]; k++) {
                const uint32_t lane = (k - first[b]) % CS_AABB_NODE;
                boxes[k] = draw_box(&seed, k);
                cs_aabb_node_set(tree.levels[0] + tree.first_leaf[b] +
                                     (k - first[b]) / CS_AABB_NODE,
                                 lane, boxes + k);
            }
        cs_aabb_tree_fit(&tree);
    }
    for (uint32_t q = 0; q < QUERIES; q++) {
        const struct cs_aabb box = draw_box(&seed, q);
        for (uint32_t b = 0; b < BODIES; b++) {
            const uint32_t from = q % 2 ? 0 : first[b] + (first[b + 1] - first[b]) / 3;
            uint32_t n = 0;
            for (uint32_t k = first[b]; k < first[b + 1]; k++)
                n += k >= from && overlap(&box, boxes + k);
            ck_assert_uint_eq(look(&tree, boxes, &box, b, from), n);
            found += n;
        }
    }
    ck_assert_uint_gt(found, 10000);
    cs_arena_finish(&arena);
}

/* bodies without items have a tree too */
TEST(nothing_is_found_in_nothing) {
    static const uint32_t none[2] = {0, 0};
    struct cs_arena arena = {0};
    struct cs_error error = {0};
    struct cs_aabb_tree tree;
    struct cs_near_list near = {0};
    const struct cs_aabb box = {{-1, -1, -1}, {1, 1, 1}};
    ck_assert_int_eq(cs_aabb_tree_init(&tree, none, 1, &arena, &error), CS_OK);
    cs_aabb_tree_fit(&tree);
    cs_aabb_tree_find(&tree, 0, 0, &box, &near);
    ck_assert(near.n == 0 && !near.failed);
    cs_arena_finish(&arena);
}
