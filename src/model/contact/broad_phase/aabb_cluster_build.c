/* Counting sort of items into blocks, sixteen to a cluster, with the rectangle of each cluster.
 */
#include "model/contact/broad_phase/aabb_cluster_build.h"

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
        const struct cs_flat_region *grid = order->flat_regions[b];
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
        if (order->flat_regions[b])
            put_grid(order, b, clusters, at);
        else
            put_body(order, b, clusters);
        for (uint32_t k = first; k < clusters->n; k++) {
            clusters->body[k] = b;
            clusters->max_item[k] = last_of(clusters->items + CS_AABB_CLUSTER * (size_t)k);
            if (spans)
                set_span(order, order->flat_regions[b], clusters, k);
        }
    }
    return error->status;
}
