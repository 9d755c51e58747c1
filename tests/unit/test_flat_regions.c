/* Flat parts of grids: the bound of how far their parts are from each other, against all pairs
 * there are; and the clusters that are made of blocks, and found in cells. */
#include "model/contact/broad_phase/aabb_clusters.h"
#include "model/contact/narrow_phase/active_contacts.h"
#include "unit.h"

#include <math.h>

/* three blocks by three, so that all is round the one in the middle */
enum {
    SIDE = 3 * CS_FLAT_REGION_BLOCK + 1,
    POINTS = SIDE * SIDE,
    CELLS = SIDE - 1,
    STATES = 24
};
enum { TRIANGLES = 2 * CELLS * CELLS, EDGES = 2 * SIDE * CELLS + CELLS * CELLS };
#define EDGE 0.02

struct grid {
    double x[3 * POINTS];
    uint32_t triangles[3 * TRIANGLES], edges[2 * EDGES], n_edges;
};

static void add_edge(struct grid *grid, uint32_t a, uint32_t b) {
    grid->edges[2 * grid->n_edges] = a;
    grid->edges[2 * grid->n_edges++ + 1] = b;
}

static void connect(struct grid *grid) {
    uint32_t *corner = grid->triangles;
    grid->n_edges = 0;
    for (uint32_t i = 0; i < POINTS; i++) {
        const bool right = i % SIDE + 1 < SIDE, below = i + SIDE < POINTS;
        if (right)
            add_edge(grid, i, i + 1);
        if (below)
            add_edge(grid, i, i + SIDE);
        if (!right || !below)
            continue;
        add_edge(grid, i + 1, i + SIDE);
        const uint32_t two[6] = {i, i + SIDE, i + 1, i + 1, i + SIDE, i + SIDE + 1};
        memcpy(corner, two, sizeof two);
        corner += 6;
    }
}

/* a number in -1..1, always the same ones */
static double draw(uint64_t *state) {
    *state = *state * 6364136223846793005u + 1442695040888963407u;
    return (double)(*state >> 11) / 4503599627370496.0 - 1;
}

/* stretched and skewed a little, and bent and shaken by ever more */
static void place(struct grid *grid, int number) {
    uint64_t seed = (uint64_t)number + 1;
    const double much = number / (double)STATES, phase = draw(&seed);
    const double skew[4] = {1 + 0.3 * much * draw(&seed), 0.3 * much * draw(&seed),
                            0.3 * much * draw(&seed), 1 + 0.3 * much * draw(&seed)};
    for (int i = 0; i < POINTS; i++) {
        const double u = EDGE * (double)(i % SIDE), v = EDGE * (double)(i / SIDE);
        grid->x[i] = 5 + skew[0] * u + skew[1] * v + 0.1 * much * EDGE * draw(&seed);
        grid->x[POINTS + i] = much * EDGE * sin(12 * u + 7 * v + phase);
        grid->x[2 * POINTS + i] = skew[2] * u + skew[3] * v + 0.1 * much * EDGE * draw(&seed);
    }
}

static bool share(const uint32_t *a, uint32_t n, const uint32_t *b, uint32_t m) {
    bool same = false;
    for (uint32_t i = 0; i < n * m; i++)
        same = same || a[i % n] == b[i / n];
    return same;
}

/* of a with b, both of so many points; HUGE_VAL where they share one */
static double distance(const struct grid *grid, const uint32_t *a, uint32_t n,
                       const uint32_t *b) {
    static struct cs_exact_distance_lanes lanes;
    if (share(a, n, b, 4 - n))
        return HUGE_VAL;
    for (uint32_t k = 0; k < 4; k++)
        for (uint32_t c = 0; c < 3; c++)
            lanes.p[k][c][0] = grid->x[c * POINTS + (k < n ? a[k] : b[k - n])];
    cs_exact_distance_measure(n == 1 ? CS_PAIR_POINT_TRIANGLE : CS_PAIR_EDGE_EDGE, &lanes);
    return sqrt(lanes.squared[0]);
}

static double least_distance(const struct grid *grid) {
    double least = HUGE_VAL;
    for (uint32_t a = 0; a < POINTS; a++)
        for (uint32_t t = 0; t < TRIANGLES; t++)
            least = fmin(least, distance(grid, &a, 1, grid->triangles + 3 * t));
    for (uint32_t a = 0; a < EDGES; a++)
        for (uint32_t b = a + 1; b < EDGES; b++)
            least = fmin(least, distance(grid, grid->edges + 2 * a, 2, grid->edges + 2 * b));
    return least;
}

static void open_flat(struct cs_flat_region *flat, struct cs_arena *arena) {
    struct cs_error error = {0};
    *flat = (struct cs_flat_region){.columns = SIDE, .rows = SIDE};
    ck_assert_int_eq(cs_flat_region_init(flat, arena, &error), CS_OK);
    ck_assert_uint_eq(flat->n_blocks_x * flat->n_blocks_y, 9);
}

/* never further apart than they are, and by half as much more it would be: a fault that is to
 * be found */
TEST(bound_is_below_all_distances) {
    static struct grid grid;
    struct cs_arena arena = {0};
    struct cs_flat_region flat;
    int above = 0, flats = 0;
    connect(&grid);
    ck_assert_uint_eq(grid.n_edges, EDGES);
    open_flat(&flat, &arena);
    for (int state = 0; state < STATES; state++) {
        place(&grid, state);
        cs_flat_region_measure(&flat, grid.x, POINTS);
        const double bound = flat.min_distance[4], least = least_distance(&grid);
        ck_assert_msg(bound <= least, "state %d: %.17g > %.17g", state, bound, least);
        above += 1.5 * bound > least;
        flats += bound > 0.5 * EDGE;
        if (!state)
            ck_assert_double_eq_tol(bound, EDGE * sqrt(0.5), 2e-6 * EDGE);
    }
    ck_assert_int_gt(above, 3);
    ck_assert_int_gt(flats, 3);
    cs_arena_finish(&arena);
}

/* a place that is not finite makes its blocks, and those beside them, not flat */
TEST(not_finite_is_not_flat) {
    static const double bad[] = {(double)NAN, HUGE_VAL, -HUGE_VAL};
    static struct grid grid;
    struct cs_arena arena = {0};
    struct cs_flat_region flat;
    open_flat(&flat, &arena);
    for (int k = 0; k < 9; k++) {
        place(&grid, 0);
        grid.x[k / 3 * POINTS] = bad[k % 3]; // the first corner of all
        cs_flat_region_measure(&flat, grid.x, POINTS);
        for (int b = 0; b < 9; b++)
            ck_assert_int_eq(flat.min_distance[b] > 0, b % 3 == 2 || b / 3 == 2);
    }
    cs_arena_finish(&arena);
}

/* every item once; those of a grid with the others of their block, which its span holds */
TEST(clusters_have_all_items) {
    static struct grid grid;
    struct cs_arena arena = {0};
    struct cs_error error = {0};
    struct cs_flat_region flat;
    struct cs_aabb_clusters clusters = {0};
    static int seen[EDGES];
    const uint32_t first[3] = {0, EDGES - 40, EDGES}; // the last ones as if of a mesh
    connect(&grid);
    open_flat(&flat, &arena);
    const struct cs_cluster_input order = {grid.edges, 2, first, 2,
                                           (struct cs_flat_region *[2]){&flat, NULL}};
    ck_assert_int_eq(cs_cluster_input_build(&order, &clusters, &arena, &error), CS_OK);
    for (uint32_t k = 0; k < clusters.n; k++)
        for (uint32_t l = 0; l < CS_AABB_CLUSTER; l++) {
            const uint32_t item = clusters.items[CS_AABB_CLUSTER * k + l];
            const struct cs_grid_rectangle *span = clusters.grid_rectangles + k;
            if (item == CS_NO_ITEM)
                continue;
            seen[item]++;
            ck_assert_uint_le(item, clusters.max_item[k]);
            ck_assert_int_eq(clusters.grid_block[k] == CS_NO_BLOCK, item >= first[1]);
            for (uint32_t c = 0; c < 2; c++) {
                const uint32_t point = grid.edges[2 * item + c];
                const double at[2] = {point / SIDE, point % SIDE};
                for (int way = 0; way < 2; way++)
                    ck_assert((double)span->first[way] <= at[way] &&
                              at[way] <= (double)span->last[way]);
            }
            if (item < first[1])
                ck_assert(span->last[0] - span->first[0] <= CS_FLAT_REGION_BLOCK &&
                          span->last[1] - span->first[1] <= CS_FLAT_REGION_BLOCK);
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
    struct cs_nearby_clusters near = {.same_body_only = true};
    uint64_t seed = 3;
    for (uint32_t k = 0; k < BOXES; k++)
        boxes[k] = draw_box(&seed, k);
    ck_assert(cs_aabb_clusters_sort(&clusters));
    ck_assert(clusters.cells[1].dim[0] && 1 / clusters.cells[0].inverse_cell_size < 0.2);
    for (uint32_t q = 0; q < QUERIES; q++) {
        const struct cs_aabb box = draw_box(&seed, q);
        uint32_t meets[BOXES] = {0}, n = 0;
        ck_assert(cs_nearby_clusters_find(&near, &clusters, &box, NULL));
        for (size_t k = 0; k < near.n; k++)
            meets[near.clusters[k]]++;
        for (uint32_t k = 0; k < BOXES; k++) {
            const bool empty = q % 50 == 8 || k % 50 == 8;
            UNIT_ASSERT_OFTEN(meets[k] == (!empty && cs_aabbs_overlap(&box, boxes + k)));
            n += meets[k];
        }
        ck_assert_uint_eq(n, near.n);
    }
    cs_nearby_clusters_finish(&near);
    cs_aabb_clusters_finish(&clusters);
}
