/* The list: boxes of triangles and edges in clusters, then for a few points or edges at a time
 * the clusters near them, for each its boxes, and of these the true distance. */
#include "model/pair/search_list.h"

#include "base/pool.h"
#include <math.h>

/* points or edges that look for clusters together */
enum { TOGETHER = 32 };

static const struct cs_cell_box nothing = {{HUGE_VAL, HUGE_VAL, HUGE_VAL},
                                           {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL}};

/* box about particles, grown to all sides */
static struct cs_cell_box box_of(const struct cs_search *search, const uint32_t *at,
                                 size_t count, double grow) {
    const size_t n = search->system->surfaces->n_points;
    struct cs_cell_box box;
    for (size_t c = 0; c < 3; c++) {
        const double *x = search->from + c * n;
        box.low[c] = box.high[c] = x[at[0]];
        for (size_t k = 1; k < count; k++) {
            box.low[c] = x[at[k]] < box.low[c] ? x[at[k]] : box.low[c];
            box.high[c] = x[at[k]] > box.high[c] ? x[at[k]] : box.high[c];
        }
        box.low[c] -= grow;
        box.high[c] += grow;
    }
    return box;
}

/* --- clusters --- */

struct filling {
    const struct cs_search *search;
    struct cs_clusters *clusters;
    const uint32_t *corners;
    size_t each;
};

/* a body that meets none has empty boxes */
static void fill_cluster(void *arg, uint32_t number) {
    const struct filling *filling = arg;
    const struct cs_search *search = filling->search;
    struct cs_cell_box *all = filling->clusters->boxes + number;
    *all = nothing;
    for (uint32_t lane = 0; lane < CS_CLUSTER; lane++) {
        const uint32_t item = CS_CLUSTER * number + lane;
        const uint32_t *at = filling->corners + filling->each * item;
        struct cs_cell_box box = nothing;
        if (item < filling->clusters->n && search->meetings->any[search->body[at[0]]])
            box = box_of(search, at, filling->each, 0);
        cs_cluster_set(filling->clusters->of + number, lane, &box);
        cs_cell_box_join(all, &box);
    }
}

static bool fill(struct cs_search *search, struct cs_clusters *clusters,
                 const uint32_t *corners, size_t each) {
    struct filling filling = {search, clusters, corners, each};
    const uint32_t count = cs_clusters_count(clusters->n);
    cs_pool_run(count, fill_cluster, &filling);
    return cs_cells_fill(&clusters->cells, clusters->boxes, count);
}

/* --- pairs --- */

/* A lot at work: pairs whose boxes meet wait until they are asked about together. */
struct work {
    const struct cs_search *search;
    struct cs_search_lot *lot;
    struct cs_sieve sieve;
};

static void keep(struct cs_search_lot *lot, const uint32_t pair[2]) {
    uint32_t *pairs = cs_arena_grow(lot->pairs, &lot->room, lot->n + 1, 2 * sizeof *pairs);
    lot->failed = lot->failed || !pairs;
    if (!pairs)
        return;
    lot->pairs = pairs;
    pairs[2 * lot->n] = pair[0];
    pairs[2 * lot->n + 1] = pair[1];
    lot->n++;
}

static void measure(struct work *work) {
    const uint32_t n = cs_sieve_run(&work->sieve, work->lot->kind == CS_STENCIL_EDGES);
    for (uint32_t l = 0; l < n; l++)
        keep(work->lot, work->sieve.pairs[l]);
}

static bool share_corner(const uint32_t at[4], enum cs_stencil_kind kind) {
    if (kind == CS_STENCIL_TRIANGLE)
        return at[0] == at[1] || at[0] == at[2] || at[0] == at[3];
    return at[0] == at[2] || at[0] == at[3] || at[1] == at[2] || at[1] == at[3];
}

/* the last bits of a reach are for rounding */
static double reach_of(const struct cs_search *search, double range) {
    return (range + 2 * search->held) * (1 + 1e-9);
}

static void take(struct work *work, uint32_t item, uint32_t other) {
    const struct cs_search *search = work->search;
    const enum cs_stencil_kind kind = work->lot->kind;
    const uint32_t pair[2] = {item, other};
    uint32_t at[4];
    if (kind == CS_STENCIL_EDGES && other <= item)
        return;
    cs_search_corners(search->system->surfaces, kind, pair, at);
    const double range = cs_search_range(
        cs_meeting_of(search->meetings, search->body[at[0]], search->body[at[2]]), kind);
    if (share_corner(at, kind) || !(range > 0))
        return;
    const double reach = reach_of(search, range) * search->inverse;
    if (cs_sieve_add(&work->sieve, search->rough, at, reach, pair))
        measure(work);
}

/* of one point or edge; empty where its body meets none */
static struct cs_cell_box item_box(const struct cs_search *search, enum cs_stencil_kind kind,
                                   uint32_t item) {
    const bool edges = kind == CS_STENCIL_EDGES;
    const uint32_t *at = edges ? search->system->surfaces->edges + 2 * (size_t)item : &item;
    if (!search->meetings->any[search->body[at[0]]])
        return nothing;
    const struct cs_meeting widest = {.range = search->meetings->widest};
    return box_of(search, at, edges ? 2 : 1, reach_of(search, cs_search_range(&widest, kind)));
}

static void find_together(struct work *work, uint32_t begin, uint32_t end) {
    const struct cs_search *search = work->search;
    struct cs_search_lot *lot = work->lot;
    const bool edges = lot->kind == CS_STENCIL_EDGES;
    const struct cs_clusters *clusters = edges ? &search->edges : &search->triangles;
    struct cs_cell_box boxes[TOGETHER], all = nothing;
    for (uint32_t i = begin; i < end; i++) {
        boxes[i - begin] = item_box(search, lot->kind, i);
        cs_cell_box_join(&all, boxes + i - begin);
    }
    // an edge is listed with later ones alone
    lot->near.least = edges ? begin / CS_CLUSTER : 0;
    if (!cs_cluster_near_find(&lot->near, clusters, &all)) {
        lot->failed = true;
        return;
    }
    for (uint32_t i = begin; i < end; i++) {
        const uint32_t n = cs_cluster_near_items(&lot->near, clusters, boxes + i - begin);
        for (uint32_t k = 0; k < n; k++)
            take(work, i, lot->near.items[k]);
    }
}

/* Sorts each row of pairs with the same first by their second: rows are short. */
static void sort_rows(uint32_t *pairs, size_t n) {
    for (size_t i = 1; i < n; i++) {
        const uint32_t first = pairs[2 * i], second = pairs[2 * i + 1];
        size_t j = i;
        for (; j > 0 && pairs[2 * j - 2] == first && pairs[2 * j - 1] > second; j--)
            pairs[2 * j + 1] = pairs[2 * j - 1];
        pairs[2 * j + 1] = second;
    }
}

static void list_lot(void *arg, uint32_t number) {
    const struct cs_search *search = arg;
    struct cs_search_lot *lot = search->lots + number;
    struct work work;
    work.search = search;
    work.lot = lot;
    work.sieve.n = 0;
    lot->n = 0;
    lot->failed = false;
    for (uint32_t i = lot->begin; i < lot->end; i += TOGETHER)
        find_together(&work, i, lot->end - i < TOGETHER ? lot->end : i + TOGETHER);
    measure(&work);
    sort_rows(lot->pairs, lot->n);
}

/* a search and the state that is rounded */
struct rounding {
    struct cs_search *search;
    const double *x;
};

/* points that are rounded together */
enum { ROUNDED = 2048 };

static void round_block(void *arg, uint32_t number) {
    const struct rounding *rounding = arg;
    const size_t n = rounding->search->system->surfaces->n_points;
    const size_t begin = (size_t)ROUNDED * number;
    cs_sieve_round(rounding->x, n, rounding->search->inverse, begin,
                   n - begin < ROUNDED ? n : begin + ROUNDED, rounding->search->rough);
}

void cs_search_round(struct cs_search *search, const double *x) {
    struct rounding rounding = {search, x};
    cs_pool_run((search->system->surfaces->n_points + ROUNDED - 1) / ROUNDED, round_block,
                &rounding);
}

bool cs_search_list(struct cs_search *search) {
    const struct cs_surfaces *surfaces = search->system->surfaces;
    bool failed = !fill(search, &search->triangles, surfaces->triangles, 3) ||
                  !fill(search, &search->edges, surfaces->edges, 2);
    cs_search_round(search, search->from);
    cs_pool_run(search->n_lots, list_lot, search);
    for (uint32_t l = 0; l < search->n_lots; l++)
        failed = failed || search->lots[l].failed;
    return !failed;
}
