/* Boxes of triangles and edges in clusters, then for a cluster of points or edges at a time the
 * clusters near it, for each its items whose boxes meet, and of these what may be near. */
#include "model/pair/search_find.h"

#include "base/pool.h"
#include "model/near/boxes.h"

#include <math.h>
#include <stdlib.h>

/* --- made once --- */

static enum cs_status take_clusters(const struct cs_order *order, struct cs_clusters *clusters,
                                    struct cs_arena *arena, struct cs_error *error) {
    if (cs_order_build(order, clusters, arena, error))
        return error->status;
    clusters->of = cs_arena_take_n(arena, clusters->n, sizeof *clusters->of, error);
    clusters->boxes = cs_arena_take_n(arena, clusters->n, sizeof *clusters->boxes, error);
    return error->status;
}

/* points have no boxes of their own */
static enum cs_status order_all(struct cs_search *search, struct cs_arena *arena,
                                struct cs_error *error) {
    const struct cs_surfaces *s = search->system->surfaces;
    const uint32_t n = s->n_bodies;
    struct cs_flat *const *grids = search->flat.grids;
    if (take_clusters(&(struct cs_order){s->triangles, 3, s->first_triangle, n, grids},
                      &search->triangles, arena, error) ||
        take_clusters(&(struct cs_order){s->edges, 2, s->first_edge, n, grids}, &search->edges,
                      arena, error))
        return error->status;
    return cs_order_build(&(struct cs_order){NULL, 1, s->first_point, n, grids},
                          &search->points, arena, error);
}

/* which clusters a thread does, and where what is found of an item will be */
static enum cs_status take_batches(struct cs_search *search, struct cs_arena *arena,
                                   struct cs_error *error) {
    const struct cs_surfaces *surfaces = search->system->surfaces;
    const uint32_t n[2] = {search->points.n, search->edges.n};
    const uint32_t count[2] = {(n[0] + CS_SEARCH_BATCH - 1) / CS_SEARCH_BATCH,
                               (n[1] + CS_SEARCH_BATCH - 1) / CS_SEARCH_BATCH};
    search->n_batches = count[0] + count[1];
    search->batches = cs_arena_take_n(arena, search->n_batches, sizeof *search->batches, error);
    search->rows[0] = cs_arena_take_n(arena, surfaces->n_points, sizeof **search->rows, error);
    search->rows[1] = cs_arena_take_n(arena, surfaces->n_edges, sizeof **search->rows, error);
    for (uint32_t b = 0; b < search->n_batches && !error->status; b++) {
        const int kind = b >= count[0];
        const uint32_t begin = CS_SEARCH_BATCH * (kind ? b - count[0] : b);
        search->batches[b] = (struct cs_search_batch){
            .kind = kind,
            .begin = begin,
            .end = n[kind] - begin > CS_SEARCH_BATCH ? begin + CS_SEARCH_BATCH : n[kind]};
    }
    return error->status;
}

enum cs_status cs_search_find_init(struct cs_search *search, struct cs_arena *arena,
                                   struct cs_error *error) {
    return order_all(search, arena, error) ? error->status : take_batches(search, arena, error);
}

void cs_search_find_finish(struct cs_search *search) {
    for (uint32_t b = 0; b < search->n_batches; b++) {
        free(search->batches[b].pairs);
        cs_cluster_near_finish(search->batches[b].near);
        cs_cluster_near_finish(search->batches[b].near + 1);
    }
    cs_clusters_finish(&search->triangles);
    cs_clusters_finish(&search->edges);
}

/* --- at a state --- */

static struct cs_boxes boxes_of(const struct cs_search *search, const uint32_t *corners,
                                uint32_t each) {
    return (struct cs_boxes){search->from, search->system->surfaces->n_points,
                             corners,      each,
                             search->body, search->meetings->any};
}

/* A batch at work: pairs whose boxes meet wait until they are asked about together. */
struct work {
    const struct cs_search *search;
    struct cs_search_batch *batch;
    struct cs_sieve sieve;
};

static void keep(struct cs_search_batch *batch, const uint32_t pair[2]) {
    uint32_t *pairs =
        cs_arena_grow(batch->pairs, &batch->room, batch->n + 1, 2 * sizeof *pairs);
    batch->failed = batch->failed || !pairs;
    if (!pairs)
        return;
    batch->pairs = pairs;
    pairs[2 * batch->n] = pair[0];
    pairs[2 * batch->n + 1] = pair[1];
    batch->n++;
}

static void measure(struct work *work) {
    const uint32_t n = cs_sieve_run(&work->sieve, work->batch->kind == CS_STENCIL_EDGES);
    for (uint32_t l = 0; l < n; l++)
        keep(work->batch, work->sieve.pairs[l]);
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
    const enum cs_stencil_kind kind = work->batch->kind;
    const uint32_t pair[2] = {item, other};
    uint32_t at[4];
    if (kind == CS_STENCIL_EDGES && other <= item)
        return;
    cs_search_corners(search->system->surfaces, kind, pair, at);
    const double range = cs_meeting_range(
        cs_meeting_of(search->meetings, search->body[at[0]], search->body[at[2]]),
        kind == CS_STENCIL_EDGES);
    if (share_corner(at, kind) || !(range > 0))
        return;
    const double reach = reach_of(search, range) * search->inverse;
    if (cs_sieve_add(&work->sieve, search->rough, at, reach, pair))
        measure(work);
}

/* m, how far what is of a body reaches for its own, or for others at most; 0: for none */
static double widest_reach(const struct cs_search *search, uint32_t body, bool own,
                           bool edges) {
    double widest = 0;
    for (uint32_t b = own ? body : 0; b < (own ? body + 1 : search->meetings->n_bodies); b++)
        if (own || b != body)
            widest =
                fmax(widest, cs_meeting_range(cs_meeting_of(search->meetings, body, b), edges));
    return widest > 0 ? reach_of(search, widest) : 0;
}

/* of all items of a cluster, that of edges as it was filled */
static struct cs_cell_box group_box(const struct cs_search *search, bool edges,
                                    uint32_t cluster, double reach) {
    const struct cs_boxes points = boxes_of(search, NULL, 1);
    struct cs_cell_box all = edges ? search->edges.boxes[cluster] : cs_box_none;
    for (uint32_t k = 0; k < CS_CLUSTER && !edges; k++) {
        const struct cs_cell_box one =
            cs_box_of(&points, search->points.items[CS_CLUSTER * (size_t)cluster + k], 0);
        cs_cell_box_join(&all, &one);
    }
    for (int c = 0; c < 3; c++) {
        all.low[c] -= reach;
        all.high[c] += reach;
    }
    return all;
}

/* A cluster of points or edges, and how far it reaches for its own body and for others. */
struct group {
    const struct cs_clusters *of, *others;
    uint32_t cluster;
    bool edges;
    double reach[2]; /* m; 0: not at all */
};

static struct group group_of(const struct cs_search *search, bool edges, uint32_t cluster) {
    struct group group = {.of = edges ? &search->edges : &search->points,
                          .others = edges ? &search->edges : &search->triangles,
                          .cluster = cluster,
                          .edges = edges};
    for (int k = 0; k < 2; k++)
        group.reach[k] = widest_reach(search, group.of->body[cluster], k == 0, edges);
    return group;
}

/* Sets near to the clusters of its own body, or of others, that a group may meet. */
static bool find_clusters(const struct cs_search *search, const struct group *group, bool own,
                          struct cs_cluster_near *near) {
    const double reach = group->reach[!own];
    const uint32_t block = group->of->block[group->cluster];
    const bool flat = own && search->flat.n_flat && block != CS_NO_BLOCK;
    near->n = 0;
    if (!(reach > 0))
        return true;
    near->own = own;
    near->body = group->of->body[group->cluster];
    // an edge is listed with later ones alone
    near->least = group->edges ? group->of->items[CS_CLUSTER * (size_t)group->cluster] : 0;
    const struct cs_cell_box box = group_box(search, group->edges, group->cluster, reach);
    return cs_cluster_near_find(
        near, group->others, &box,
        flat ? search->flat.round[group->edges ? CS_STENCIL_EDGES : CS_STENCIL_TRIANGLE] + block
             : NULL);
}

static void find_item(struct work *work, const struct group *group, uint32_t item) {
    const struct cs_search *search = work->search;
    const struct cs_boxes boxes = group->edges
                                      ? boxes_of(search, search->system->surfaces->edges, 2)
                                      : boxes_of(search, NULL, 1);
    for (int k = 0; k < 2; k++) {
        struct cs_cluster_near *near = work->batch->near + k;
        if (!near->n)
            continue;
        const struct cs_cell_box box = cs_box_of(&boxes, item, group->reach[k]);
        const uint32_t n = cs_cluster_near_items(near, group->others, &box);
        for (uint32_t l = 0; l < n; l++)
            take(work, item, near->items[l]);
    }
}

/* what the items of a cluster have near them */
static void find_together(struct work *work, uint32_t cluster) {
    const struct cs_search *search = work->search;
    struct cs_search_batch *batch = work->batch;
    const struct group group = group_of(search, batch->kind == CS_STENCIL_EDGES, cluster);
    const uint32_t *items = group.of->items + CS_CLUSTER * (size_t)cluster;
    bool there = true;
    for (int k = 0; k < 2; k++)
        there = there && find_clusters(search, &group, k == 0, batch->near + k);
    batch->failed = batch->failed || !there;
    for (uint32_t k = 0; k < CS_CLUSTER && there && batch->near[0].n + batch->near[1].n; k++)
        if (items[k] != CS_NO_ITEM)
            find_item(work, &group, items[k]);
}

/* notes where the pairs of each item are */
static void set_rows(const struct cs_search *search, const struct cs_clusters *of,
                     uint32_t number) {
    const struct cs_search_batch *batch = search->batches + number;
    struct cs_search_row *rows = search->rows[batch->kind];
    for (size_t k = CS_CLUSTER * (size_t)batch->begin; k < CS_CLUSTER * (size_t)batch->end; k++)
        if (of->items[k] != CS_NO_ITEM)
            rows[of->items[k]] = (struct cs_search_row){number, 0, 0};
    for (size_t p = 0; p < batch->n; p++) {
        struct cs_search_row *row = rows + batch->pairs[2 * p];
        row->begin = row->n ? row->begin : (uint32_t)p;
        row->n++;
    }
}

static void find_batch(void *arg, uint32_t number) {
    const struct cs_search *search = arg;
    struct cs_search_batch *batch = search->batches + number;
    const struct cs_clusters *of =
        batch->kind == CS_STENCIL_EDGES ? &search->edges : &search->points;
    struct work work;
    work.search = search;
    work.batch = batch;
    work.sieve.n = 0;
    batch->n = 0;
    batch->failed = false;
    for (uint32_t k = batch->begin; k < batch->end; k++)
        find_together(&work, k);
    measure(&work);
    set_rows(search, of, number);
}

static bool fill(const struct cs_search *search, struct cs_clusters *clusters,
                 const uint32_t *corners, uint32_t each) {
    const struct cs_boxes boxes = boxes_of(search, corners, each);
    return cs_boxes_fill(&boxes, clusters);
}

bool cs_search_find(struct cs_search *search) {
    const struct cs_surfaces *surfaces = search->system->surfaces;
    bool failed = !fill(search, &search->triangles, surfaces->triangles, 3) ||
                  !fill(search, &search->edges, surfaces->edges, 2);
    cs_pool_run(search->n_batches, find_batch, search);
    for (uint32_t b = 0; b < search->n_batches; b++)
        failed = failed || search->batches[b].failed;
    return !failed;
}
