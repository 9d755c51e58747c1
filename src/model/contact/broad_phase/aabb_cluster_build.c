/* Counting sort of items into blocks, sixteen to a cluster. */
#include "model/contact/broad_phase/aabb_clusters.h"

#include <string.h>

static uint32_t point_of(const struct cs_cluster_input *input, uint32_t item, uint32_t corner) {
    return input->vertices ? input->vertices[(size_t)input->vertices_per_item * item + corner]
                           : item;
}

/* cells per side of a block of a grid */
enum { BLOCK = 4 };

/* Blocks along a row or column of points; the last one may be larger by a point, or smaller. */
static uint32_t blocks_along(uint32_t points) {
    return (points - 2) / BLOCK + 1;
}

static uint32_t blocks_of(const struct cs_body_range *grid) {
    return blocks_along(grid->columns) * blocks_along(grid->rows);
}

static uint32_t smaller(uint32_t a, uint32_t b) {
    return a < b ? a : b;
}

/* Block of the first row and the first column that an item has a vertex in. */
static uint32_t block_of(const struct cs_cluster_input *input, const struct cs_body_range *grid,
                         uint32_t item) {
    uint32_t row = UINT32_MAX, column = UINT32_MAX;
    for (uint32_t k = 0; k < input->vertices_per_item; k++) {
        const uint32_t point = point_of(input, item, k) - grid->first;
        row = smaller(row, point / grid->columns);
        column = smaller(column, point % grid->columns);
    }
    const uint32_t across = blocks_along(grid->columns), down = blocks_along(grid->rows);
    return smaller(row / BLOCK, down - 1) * across + smaller(column / BLOCK, across - 1);
}

/* particles of a body that is a grid with cells; NULL: it is none */
static const struct cs_body_range *grid_of(const struct cs_cluster_input *input,
                                           uint32_t body) {
    const struct cs_body_range *range = input->bodies + body;
    return body < input->n_ranges && !range->mesh && range->columns > 1 && range->rows > 1
               ? range
               : NULL;
}

static uint32_t clusters_of(uint32_t n_items) {
    return (n_items + CS_AABB_CLUSTER - 1) / CS_AABB_CLUSTER;
}

/* Stores the items of a grid body, with each block in clusters of its own. at: work, one per
 * block; first counts, then the position of the next item. */
static void put_grid(const struct cs_cluster_input *input, uint32_t body,
                     struct cs_aabb_clusters *clusters, uint32_t *at) {
    const struct cs_body_range *grid = grid_of(input, body);
    const uint32_t blocks = blocks_of(grid);
    memset(at, 0, blocks * sizeof *at);
    for (uint32_t i = input->first[body]; i < input->first[body + 1]; i++)
        at[block_of(input, grid, i)]++;
    for (uint32_t b = 0; b < blocks; b++) {
        const uint32_t count = clusters_of(at[b]);
        at[b] = CS_AABB_CLUSTER * clusters->n;
        clusters->n += count;
    }
    for (uint32_t i = input->first[body]; i < input->first[body + 1]; i++)
        clusters->items[at[block_of(input, grid, i)]++] = i;
}

/* Stores the items of any other body in their order. */
static void put_body(const struct cs_cluster_input *input, uint32_t body,
                     struct cs_aabb_clusters *clusters) {
    const uint32_t n = input->first[body + 1] - input->first[body];
    for (uint32_t i = 0; i < n; i++)
        clusters->items[CS_AABB_CLUSTER * (size_t)clusters->n + i] = input->first[body] + i;
    clusters->n += clusters_of(n);
}

/* largest item of a cluster */
static uint32_t last_of(const uint32_t items[CS_AABB_CLUSTER]) {
    uint32_t last = items[0];
    for (uint32_t l = 1; l < CS_AABB_CLUSTER; l++)
        last = items[l] != CS_NO_ITEM && items[l] > last ? items[l] : last;
    return last;
}

/* Upper bounds of the clusters, and of the blocks of a grid. */
static void count(const struct cs_cluster_input *input, size_t *clusters, size_t *blocks) {
    *clusters = *blocks = 0;
    for (uint32_t b = 0; b < input->n_bodies; b++) {
        const size_t own = grid_of(input, b) ? blocks_of(grid_of(input, b)) : 0;
        *clusters += clusters_of(input->first[b + 1] - input->first[b]) + own;
        *blocks = own > *blocks ? own : *blocks;
    }
}

static enum cs_status allocate_clusters(struct cs_aabb_clusters *clusters, size_t most,
                                        struct cs_arena *arena, struct cs_error *error) {
    CS_ARENA_ARRAY(arena, clusters->items, CS_AABB_CLUSTER * most, error);
    clusters->max_item = cs_arena_alloc_array(arena, most, sizeof *clusters->max_item, error);
    clusters->body = cs_arena_alloc_array(arena, most, sizeof *clusters->body, error);
    return error->status;
}

enum cs_status cs_cluster_input_build(const struct cs_cluster_input *input,
                                      struct cs_aabb_clusters *clusters, struct cs_arena *arena,
                                      struct cs_error *error) {
    size_t most, blocks;
    count(input, &most, &blocks);
    uint32_t *at = cs_arena_alloc_array(arena, blocks, sizeof *at, error);
    if (allocate_clusters(clusters, most, arena, error))
        return error->status;
    memset(clusters->items, 0xff, CS_AABB_CLUSTER * most * sizeof *clusters->items);
    for (uint32_t b = 0; b < input->n_bodies; b++) {
        const uint32_t first = clusters->n;
        if (grid_of(input, b))
            put_grid(input, b, clusters, at);
        else
            put_body(input, b, clusters);
        for (uint32_t k = first; k < clusters->n; k++) {
            clusters->body[k] = b;
            clusters->max_item[k] = last_of(clusters->items + CS_AABB_CLUSTER * (size_t)k);
        }
    }
    return error->status;
}
