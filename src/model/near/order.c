/* Items counted into blocks, sixteen to a cluster, and what of the grid a cluster spans. */
#include "model/near/order.h"

#include <math.h>
#include <string.h>

static uint32_t point_of(const struct cs_order *order, uint32_t item, uint32_t corner) {
    return order->corners ? order->corners[(size_t)order->each * item + corner] : item;
}

static struct cs_cluster_span span_of(const struct cs_order *order, const struct cs_flat *grid,
                                      uint32_t item) {
    struct cs_cluster_span span = {{HUGE_VALF, HUGE_VALF}, {-HUGE_VALF, -HUGE_VALF}};
    for (uint32_t k = 0; k < order->each; k++) {
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

/* within the grid, of the corner where an item begins */
static uint32_t block_of(const struct cs_order *order, const struct cs_flat *grid,
                         uint32_t item) {
    const struct cs_cluster_span span = span_of(order, grid, item);
    return cs_flat_block(grid, (uint32_t)span.first[0] - grid->first_row,
                         (uint32_t)span.first[1]);
}

static uint32_t clusters_of(uint32_t n_items) {
    return (n_items + CS_CLUSTER - 1) / CS_CLUSTER;
}

/* Items of a body one behind the other, blocks beginning a cluster each; at: the place of each
 * block's next item. */
static void put_grid(const struct cs_order *order, uint32_t body, struct cs_clusters *clusters,
                     uint32_t *at) {
    const struct cs_flat *grid = order->grids[body];
    const uint32_t blocks = grid->across * grid->down;
    memset(at, 0, blocks * sizeof *at);
    for (uint32_t i = order->first[body]; i < order->first[body + 1]; i++)
        at[block_of(order, grid, i)]++;
    for (uint32_t b = 0; b < blocks; b++) {
        const uint32_t count = clusters_of(at[b]);
        at[b] = CS_CLUSTER * clusters->n;
        for (uint32_t k = 0; k < count; k++)
            clusters->block[clusters->n++] = grid->first_block + b;
    }
    for (uint32_t i = order->first[body]; i < order->first[body + 1]; i++)
        clusters->items[at[block_of(order, grid, i)]++] = i;
}

static void put_body(const struct cs_order *order, uint32_t body,
                     struct cs_clusters *clusters) {
    const uint32_t n = order->first[body + 1] - order->first[body];
    for (uint32_t i = 0; i < n; i++)
        clusters->items[CS_CLUSTER * (size_t)clusters->n + i] = order->first[body] + i;
    for (uint32_t k = clusters_of(n); k--;)
        clusters->block[clusters->n++] = CS_NO_BLOCK;
}

static void set_span(const struct cs_order *order, const struct cs_flat *grid,
                     const struct cs_clusters *clusters, uint32_t cluster) {
    static const struct cs_cluster_span everywhere = {{-HUGE_VALF, -HUGE_VALF},
                                                      {HUGE_VALF, HUGE_VALF}};
    struct cs_cluster_span *all = clusters->spans + cluster;
    const uint32_t *items = clusters->items + CS_CLUSTER * (size_t)cluster;
    *all = grid ? span_of(order, grid, items[0]) : everywhere;
    for (uint32_t l = 1; l < CS_CLUSTER && grid && items[l] != CS_NO_ITEM; l++) {
        const struct cs_cluster_span one = span_of(order, grid, items[l]);
        for (int c = 0; c < 2; c++) {
            all->first[c] = fminf(all->first[c], one.first[c]);
            all->last[c] = fmaxf(all->last[c], one.last[c]);
        }
    }
}

static uint32_t last_of(const uint32_t items[CS_CLUSTER]) {
    uint32_t last = items[0];
    for (uint32_t l = 1; l < CS_CLUSTER; l++)
        last = items[l] != CS_NO_ITEM && items[l] > last ? items[l] : last;
    return last;
}

/* most clusters, and most blocks of a grid; returns whether there is one */
static bool count(const struct cs_order *order, size_t *clusters, size_t *blocks) {
    *clusters = *blocks = 0;
    for (uint32_t b = 0; b < order->n_bodies; b++) {
        const struct cs_flat *grid = order->grids[b];
        const size_t own = grid ? (size_t)grid->across * grid->down : 0;
        *clusters += clusters_of(order->first[b + 1] - order->first[b]) + own;
        *blocks = own > *blocks ? own : *blocks;
    }
    return *blocks > 0;
}

static enum cs_status take(struct cs_clusters *clusters, size_t most, bool spans,
                           struct cs_arena *arena, struct cs_error *error) {
    clusters->items = cs_arena_take_n(arena, CS_CLUSTER * most, sizeof(uint32_t), error);
    clusters->last = cs_arena_take_n(arena, most, sizeof *clusters->last, error);
    clusters->body = cs_arena_take_n(arena, most, sizeof *clusters->body, error);
    clusters->block = cs_arena_take_n(arena, most, sizeof *clusters->block, error);
    if (spans)
        clusters->spans = cs_arena_take_n(arena, most, sizeof *clusters->spans, error);
    return error->status;
}

enum cs_status cs_order_build(const struct cs_order *order, struct cs_clusters *clusters,
                              struct cs_arena *arena, struct cs_error *error) {
    size_t most, blocks;
    const bool spans = count(order, &most, &blocks);
    uint32_t *at = cs_arena_take_n(arena, blocks, sizeof *at, error);
    if (take(clusters, most, spans, arena, error))
        return error->status;
    memset(clusters->items, 0xff, CS_CLUSTER * most * sizeof *clusters->items);
    for (uint32_t b = 0; b < order->n_bodies; b++) {
        const uint32_t first = clusters->n;
        if (order->grids[b])
            put_grid(order, b, clusters, at);
        else
            put_body(order, b, clusters);
        for (uint32_t k = first; k < clusters->n; k++) {
            clusters->body[k] = b;
            clusters->last[k] = last_of(clusters->items + CS_CLUSTER * (size_t)k);
            if (spans)
                set_span(order, order->grids[b], clusters, k);
        }
    }
    return error->status;
}
