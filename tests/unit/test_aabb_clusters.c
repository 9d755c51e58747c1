/* Clusters that are made of blocks of a grid, and found in cells. */
#include "model/contact/broad_phase/aabb_clusters.h"
#include "unit.h"

/* three blocks of 4 x 4 cells by three */
enum { BLOCK = 4, CELLS = 3 * BLOCK, SIDE = CELLS + 1, POINTS = SIDE * SIDE };
enum { EDGES = 2 * SIDE * CELLS + CELLS * CELLS };

struct grid {
    uint32_t edges[2 * EDGES], n_edges;
};

static void add_edge(struct grid *grid, uint32_t a, uint32_t b) {
    grid->edges[2 * grid->n_edges] = a;
    grid->edges[2 * grid->n_edges++ + 1] = b;
}

static void connect(struct grid *grid) {
    grid->n_edges = 0;
    for (uint32_t i = 0; i < POINTS; i++) {
        const bool right = i % SIDE + 1 < SIDE, below = i + SIDE < POINTS;
        if (right)
            add_edge(grid, i, i + 1);
        if (below)
            add_edge(grid, i, i + SIDE);
        if (right && below)
            add_edge(grid, i + 1, i + SIDE);
    }
}

/* a number in -1..1, always the same ones */
static double draw(uint64_t *state) {
    *state = *state * 6364136223846793005u + 1442695040888963407u;
    return (double)(*state >> 11) / 4503599627370496.0 - 1;
}

/* every item once; those of a grid with others of their block alone */
TEST(clusters_have_all_items) {
    static struct grid grid;
    struct cs_arena arena = {0};
    struct cs_error error = {0};
    struct cs_aabb_clusters clusters = {0};
    static int seen[EDGES];
    const struct cs_body_range range = {.count = POINTS, .columns = SIDE, .rows = SIDE};
    const uint32_t first[3] = {0, EDGES - 40, EDGES}; // the last ones as if of a mesh
    connect(&grid);
    ck_assert_uint_eq(grid.n_edges, EDGES);
    const struct cs_cluster_input input = {grid.edges, 2, first, 2, &range, 1};
    ck_assert_int_eq(cs_cluster_input_build(&input, &clusters, &arena, &error), CS_OK);
    for (uint32_t k = 0; k < clusters.n; k++) {
        uint32_t low[2] = {SIDE, SIDE}, high[2] = {0, 0};
        for (uint32_t l = 0; l < CS_AABB_CLUSTER; l++) {
            const uint32_t item = clusters.items[CS_AABB_CLUSTER * k + l];
            if (item == CS_NO_ITEM)
                continue;
            seen[item]++;
            ck_assert_uint_le(item, clusters.max_item[k]);
            ck_assert_uint_eq(clusters.body[k], item >= first[1]);
            for (uint32_t c = 0; c < 4; c++) {
                const uint32_t point = grid.edges[2 * item + c / 2];
                const uint32_t at = c % 2 ? point % SIDE : point / SIDE;
                low[c % 2] = at < low[c % 2] ? at : low[c % 2];
                high[c % 2] = at > high[c % 2] ? at : high[c % 2];
            }
        }
        for (int c = 0; c < 2 && !clusters.body[k]; c++)
            ck_assert(low[c] / BLOCK == (high[c] - 1) / BLOCK || high[c] - low[c] <= BLOCK);
    }
    for (uint32_t e = 0; e < EDGES; e++)
        ck_assert_int_eq(seen[e], 1);
    cs_arena_finish(&arena);
}

/* a box of a size, empty ones among them; every fiftieth large */
static struct cs_aabb draw_box(uint64_t *seed, uint32_t number) {
    struct cs_aabb box;
    const double size = number % 50 == 7 ? 40 : number % 50 == 8 ? -1 : 0.05;
    for (int c = 0; c < 3; c++) {
        box.low[c] = draw(seed) - (size > 1 ? size / 2 : 0);
        box.high[c] = box.low[c] + size * (1.5 + draw(seed));
    }
    return box;
}

/* each cluster that a box meets once, large ones too, which have cells of their own */
TEST(clusters_near_a_box_are_found) {
    enum { BOXES = 500, QUERIES = 300 };
    static struct cs_aabb boxes[BOXES];
    static uint32_t last[BOXES], body[BOXES];
    struct cs_aabb_clusters clusters = {
        .n = BOXES, .max_item = last, .body = body, .cluster_boxes = boxes};
    struct cs_nearby_clusters nearby = {0};
    uint64_t seed = 3;
    for (uint32_t k = 0; k < BOXES; k++)
        boxes[k] = draw_box(&seed, k);
    ck_assert(cs_aabb_clusters_sort(&clusters));
    ck_assert(clusters.grid[1].dim[0] && 1 / clusters.grid[0].inverse_cell_size < 0.2);
    for (uint32_t q = 0; q < QUERIES; q++) {
        const struct cs_aabb box = draw_box(&seed, q);
        uint32_t meets[BOXES] = {0}, n = 0;
        ck_assert(cs_nearby_clusters_find(&nearby, &clusters, &box));
        for (size_t k = 0; k < nearby.n; k++)
            meets[nearby.clusters[k]]++;
        for (uint32_t k = 0; k < BOXES; k++) {
            const bool empty = q % 50 == 8 || k % 50 == 8;
            UNIT_ASSERT_OFTEN(meets[k] == (!empty && cs_aabbs_overlap(&box, boxes + k)));
            n += meets[k];
        }
        ck_assert_uint_eq(n, nearby.n);
    }
    cs_nearby_clusters_finish(&nearby);
    cs_aabb_clusters_finish(&clusters);
}
