/* Counting sort of items into blocks, sixteen to a cluster, with the rectangle of each cluster.
 */
#include "model/contact/broad_phase/aabb_clusters.h"

#include "base/pool.h"

#include <math.h>
#include <string.h>

static uint32_t point_of(const struct cs_cluster_input *order, uint32_t item, uint32_t corner) {
    return order->vertices ? order->vertices[(size_t)order->vertices_per_item * item + corner]
                           : item;
}

/* Rectangle of the vertices of one item. */
static struct cs_grid_rectangle span_of(const struct cs_cluster_input *order,
                                        const struct cs_flat_region *grid, uint32_t item) {
    struct cs_grid_rectangle span = {{HUGE_VALF, HUGE_VALF}, {-HUGE_VALF, -HUGE_VALF}};
    for (uint32_t k = 0; k < order->vertices_per_item; k++) {
        const uint32_t point = point_of(order, item, k) - grid->first;
        const float at[2] = {(float)(grid->first_row + point / grid->columns),
                             (float)(point % grid->columns)};
        for (int c = 0; c < 2; c++) {
            span.first[c] = fminf(span.first[c], at[c]);
            span.last[c] = fmaxf(span.last[c], at[c]);
        }
    }
    return span;
}

/* Block, within its grid, of the first vertex of an item's rectangle. */
static uint32_t block_of(const struct cs_cluster_input *order,
                         const struct cs_flat_region *grid, uint32_t item) {
    const struct cs_grid_rectangle span = span_of(order, grid, item);
    return cs_flat_region_block(grid, (uint32_t)span.first[0] - grid->first_row,
                                (uint32_t)span.first[1]);
}

/* grid of a body; NULL: it is none */
static const struct cs_flat_region *grid_of(const struct cs_cluster_input *order,
                                            uint32_t body) {
    return order->flat_regions ? order->flat_regions[body] : NULL;
}

static uint32_t clusters_of(uint32_t n_items) {
    return (n_items + CS_AABB_CLUSTER - 1) / CS_AABB_CLUSTER;
}

/* Stores the items of a grid body, with each block in clusters of its own. at: work, one per
 * block; first counts, then the position of the next item. */
static void put_grid(const struct cs_cluster_input *order, uint32_t body,
                     struct cs_aabb_clusters *clusters, uint32_t *at) {
    const struct cs_flat_region *grid = order->flat_regions[body];
    const uint32_t blocks = grid->n_blocks_x * grid->n_blocks_y;
    memset(at, 0, blocks * sizeof *at);
    for (uint32_t i = order->first[body]; i < order->first[body + 1]; i++)
        at[block_of(order, grid, i)]++;
    for (uint32_t b = 0; b < blocks; b++) {
        const uint32_t count = clusters_of(at[b]);
        at[b] = CS_AABB_CLUSTER * clusters->n;
        for (uint32_t k = 0; k < count; k++)
            clusters->grid_block[clusters->n++] = grid->first_block + b;
    }
    for (uint32_t i = order->first[body]; i < order->first[body + 1]; i++)
        clusters->items[at[block_of(order, grid, i)]++] = i;
}

/* Stores the items of any other body in their order. */
static void put_body(const struct cs_cluster_input *order, uint32_t body,
                     struct cs_aabb_clusters *clusters) {
    const uint32_t n = order->first[body + 1] - order->first[body];
    for (uint32_t i = 0; i < n; i++)
        clusters->items[CS_AABB_CLUSTER * (size_t)clusters->n + i] = order->first[body] + i;
    for (uint32_t k = clusters_of(n); k--;)
        clusters->grid_block[clusters->n++] = CS_NO_BLOCK;
}

/* Sets the rectangle of a cluster to that of its items; the whole plane if it is no grid. */
static void set_span(const struct cs_cluster_input *order, const struct cs_flat_region *grid,
                     const struct cs_aabb_clusters *clusters, uint32_t cluster) {
    static const struct cs_grid_rectangle everywhere = {{-HUGE_VALF, -HUGE_VALF},
                                                        {HUGE_VALF, HUGE_VALF}};
    struct cs_grid_rectangle *all = clusters->grid_rectangles + cluster;
    const uint32_t *items = clusters->items + CS_AABB_CLUSTER * (size_t)cluster;
    *all = grid ? span_of(order, grid, items[0]) : everywhere;
    for (uint32_t l = 1; l < CS_AABB_CLUSTER && grid && items[l] != CS_NO_ITEM; l++) {
        const struct cs_grid_rectangle one = span_of(order, grid, items[l]);
        for (int c = 0; c < 2; c++) {
            all->first[c] = fminf(all->first[c], one.first[c]);
            all->last[c] = fmaxf(all->last[c], one.last[c]);
        }
    }
}

/* largest item of a cluster */
static uint32_t last_of(const uint32_t items[CS_AABB_CLUSTER]) {
    uint32_t last = items[0];
    for (uint32_t l = 1; l < CS_AABB_CLUSTER; l++)
        last = items[l] != CS_NO_ITEM && items[l] > last ? items[l] : last;
    return last;
}

/* Upper bounds of the clusters, and of the blocks of a grid; returns whether there is a grid.
 */
static bool count(const struct cs_cluster_input *order, size_t *clusters, size_t *blocks) {
    *clusters = *blocks = 0;
    for (uint32_t b = 0; b < order->n_bodies; b++) {
        const struct cs_flat_region *grid = grid_of(order, b);
        const size_t own = grid ? (size_t)grid->n_blocks_x * grid->n_blocks_y : 0;
        *clusters += clusters_of(order->first[b + 1] - order->first[b]) + own;
        *blocks = own > *blocks ? own : *blocks;
    }
    return *blocks > 0;
}

static enum cs_status take(struct cs_aabb_clusters *clusters, size_t most, bool spans,
                           struct cs_arena *arena, struct cs_error *error) {
    clusters->items =
        cs_arena_alloc_array(arena, CS_AABB_CLUSTER * most, sizeof(uint32_t), error);
    clusters->max_item = cs_arena_alloc_array(arena, most, sizeof *clusters->max_item, error);
    clusters->body = cs_arena_alloc_array(arena, most, sizeof *clusters->body, error);
    clusters->grid_block =
        cs_arena_alloc_array(arena, most, sizeof *clusters->grid_block, error);
    if (spans)
        clusters->grid_rectangles =
            cs_arena_alloc_array(arena, most, sizeof *clusters->grid_rectangles, error);
    return error->status;
}

enum cs_status cs_cluster_input_build(const struct cs_cluster_input *order,
                                      struct cs_aabb_clusters *clusters, struct cs_arena *arena,
                                      struct cs_error *error) {
    size_t most, blocks;
    const bool spans = count(order, &most, &blocks);
    uint32_t *at = cs_arena_alloc_array(arena, blocks, sizeof *at, error);
    if (take(clusters, most, spans, arena, error))
        return error->status;
    memset(clusters->items, 0xff, CS_AABB_CLUSTER * most * sizeof *clusters->items);
    for (uint32_t b = 0; b < order->n_bodies; b++) {
        const uint32_t first = clusters->n;
        if (grid_of(order, b))
            put_grid(order, b, clusters, at);
        else
            put_body(order, b, clusters);
        for (uint32_t k = first; k < clusters->n; k++) {
            clusters->body[k] = b;
            clusters->max_item[k] = last_of(clusters->items + CS_AABB_CLUSTER * (size_t)k);
            if (spans)
                set_span(order, grid_of(order, b), clusters, k);
        }
    }
    return error->status;
}

/* Measures flat regions: boxes of the edges of each block, then the bound of (s - r) / sqrt(2)
 * over each block and its neighbours. Theory: aabb_clusters.h.
 *
 * The cost is one pass over the edges and 9 boxes per block, a small part of a search for
 * pairs. */

enum cs_status cs_flat_region_init(struct cs_flat_region *flat, struct cs_arena *arena,
                                   struct cs_error *error) {
    flat->n_blocks_x = (flat->columns - 2) / CS_FLAT_REGION_BLOCK + 1;
    flat->n_blocks_y = (flat->rows - 2) / CS_FLAT_REGION_BLOCK + 1;
    const size_t blocks = (size_t)flat->n_blocks_x * flat->n_blocks_y;
    flat->edges = cs_arena_alloc_array(arena, blocks, sizeof *flat->edges, error);
    flat->min_distance = cs_arena_alloc_array(arena, blocks, sizeof *flat->min_distance, error);
    return error->status;
}

/* A grid at a state. */
struct measuring {
    struct cs_flat_region *flat;
    const double *x;
    size_t n;
};

static void extend_bounds(double *low, double *high, double low_too, double high_too) {
    *low = low_too < *low ? low_too : *low;
    *high = high_too > *high ? high_too : *high;
}

/* boxes of no edge */
static const struct cs_flat_region_edges none = {
    {{HUGE_VAL, HUGE_VAL, HUGE_VAL}, {HUGE_VAL, HUGE_VAL, HUGE_VAL}},
    {{-HUGE_VAL, -HUGE_VAL, -HUGE_VAL}, {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL}},
    0};

/* Adds the edges from the points in rows [top, end) and columns [left, right) to the next
 * point; way 0: along the row, 1: across the rows. */
static void add_edges(const struct measuring *at, const uint32_t top, uint32_t end,
                      uint32_t left, uint32_t right, int way,
                      struct cs_flat_region_edges *edges) {
    const size_t columns = at->flat->columns, step = way ? columns : 1;
    for (size_t c = 0; c < 3; c++)
        for (size_t row = top; row < end; row++) {
            const double *x = at->x + c * at->n + at->flat->first + row * columns;
            for (size_t column = left; column < right; column++) {
                const double edge = x[column + step] - x[column];
                extend_bounds(&edges->low[way][c], &edges->high[way][c], edge, edge);
                edges->sum += edge;
            }
        }
}

/* Boxes of one row of blocks. Edges between blocks count in both. */
static void box_row(void *arg, uint32_t down) {
    const struct measuring *at = arg;
    const struct cs_flat_region *flat = at->flat;
    const uint32_t top = CS_FLAT_REGION_BLOCK * down;
    const uint32_t end =
        top + CS_FLAT_REGION_BLOCK < flat->rows ? top + CS_FLAT_REGION_BLOCK : flat->rows - 1;
    for (uint32_t across = 0; across < flat->n_blocks_x; across++) {
        const uint32_t left = CS_FLAT_REGION_BLOCK * across, last = left + CS_FLAT_REGION_BLOCK;
        const uint32_t right = last < flat->columns ? last : flat->columns - 1;
        struct cs_flat_region_edges edges = none;
        add_edges(at, top, end + 1, left, right, 0, &edges);
        add_edges(at, top, end, left, right + 1, 1, &edges);
        flat->edges[(size_t)down * flat->n_blocks_x + across] = edges;
    }
}

/* Boxes of a block and those around it. */
static struct cs_flat_region_edges join(const struct cs_flat_region *flat, uint32_t down,
                                        uint32_t across) {
    struct cs_flat_region_edges all = none;
    for (uint32_t i = down ? down - 1 : 0; i <= down + 1 && i < flat->n_blocks_y; i++)
        for (uint32_t j = across ? across - 1 : 0; j <= across + 1 && j < flat->n_blocks_x;
             j++) {
            const struct cs_flat_region_edges *one =
                flat->edges + (size_t)i * flat->n_blocks_x + j;
            for (int k = 0; k < 6; k++)
                extend_bounds(&all.low[k / 3][k % 3], &all.high[k / 3][k % 3],
                              one->low[k / 3][k % 3], one->high[k / 3][k % 3]);
            all.sum += one->sum;
        }
    return all;
}

/* (s - r) / sqrt(2). A = (u v) has the columns of box centres, and s^2 is the smaller
 * eigenvalue of A^T A = (a b; b c):
 *
 *   s^2 = (a + c - sqrt((a - c)^2 + 4 b^2)) / 2
 *
 * r is the Frobenius norm of the half-widths, an upper bound of the spectral norm. 0.707106 is
 * 1.1e-6 below 1/sqrt(2), far more than the rounding of the rest. NaN if an edge is not finite,
 * so that no comparison calls the block flat. */
static double bound_of(const struct cs_flat_region_edges *edges) {
    double a = 0, b = 0, c = 0, reach = 0 * edges->sum;
    for (int k = 0; k < 3; k++) {
        const double u = 0.5 * (edges->low[0][k] + edges->high[0][k]);
        const double v = 0.5 * (edges->low[1][k] + edges->high[1][k]);
        const double along = 0.5 * (edges->high[0][k] - edges->low[0][k]);
        const double over = 0.5 * (edges->high[1][k] - edges->low[1][k]);
        a += u * u;
        b += u * v;
        c += v * v;
        reach += along * along + over * over;
    }
    const double least = 0.5 * (a + c - sqrt((a - c) * (a - c) + 4 * b * b));
    return 0.707106 * (sqrt(least > 0 ? least : 0) - sqrt(reach));
}

/* Bounds of one row of blocks, after all boxes are set. */
static void part_row(void *arg, uint32_t down) {
    const struct measuring *at = arg;
    const struct cs_flat_region *flat = at->flat;
    for (uint32_t across = 0; across < flat->n_blocks_x; across++) {
        const struct cs_flat_region_edges all = join(flat, down, across);
        flat->min_distance[(size_t)down * flat->n_blocks_x + across] = bound_of(&all);
    }
}

void cs_flat_region_measure(struct cs_flat_region *flat, const double *x, size_t n) {
    struct measuring measuring = {flat, x, n};
    cs_pool_run(flat->n_blocks_y, box_row, &measuring);
    cs_pool_run(flat->n_blocks_y, part_row, &measuring);
}
