/* The search for candidates, in four filters: the clusters of triangles or edges near a cluster
 * of points or edges (uniform grid); the boxes of their items; the distance filter in single
 * precision; what remains is listed.
 *
 * A batch of clusters is one thread's. Batches follow the order of clusters, which is spatial;
 * candidate_list.c brings their pairs into the order of keys afterwards. */
#include "model/contact/broad_phase/candidate_list.h"

#include "base/pool.h"
#include "model/contact/broad_phase/aabb_clusters.h"
#include "model/system/seams.h"

#include <clothsim/clones.h>
#include <math.h>
#include <stdlib.h>

/* Items of one kind at a state; all pointers are borrowed. */
struct item_boxes {
    const double *x; /* (3, n) */
    size_t n;
    const uint32_t *vertices; /* (items, each); NULL: an item is a point itself */
    const uint32_t *body;     /* (n) of each point */
    const bool *is_nonempty;  /* of each body: it meets one; else boxes are empty */
};

/* Box of an item of `each` points, grown by `grow` in m to all sides; empty for CS_NO_ITEM, and
 * for bodies without contact. With a constant for `each` it takes less time than to store it.
 */
CS_INLINE struct cs_aabb item_box(const struct item_boxes *boxes, uint32_t each, uint32_t item,
                                  double grow) {
    struct cs_aabb box;
    if (item == CS_NO_ITEM)
        return cs_aabb_empty;
    const uint32_t *at = each > 1 ? boxes->vertices + (size_t)each * item : &item;
    if (!boxes->is_nonempty[boxes->body[at[0]]])
        return cs_aabb_empty;
    for (size_t c = 0; c < 3; c++) {
        const double *x = boxes->x + c * boxes->n;
        box.low[c] = box.high[c] = x[at[0]];
        for (uint32_t k = 1; k < each; k++) {
            box.low[c] = x[at[k]] < box.low[c] ? x[at[k]] : box.low[c];
            box.high[c] = x[at[k]] > box.high[c] ? x[at[k]] : box.high[c];
        }
        box.low[c] -= grow;
        box.high[c] += grow;
    }
    return box;
}

/* --- made once --- */

enum cs_status cs_candidates_find_init(struct cs_candidates *candidates, struct cs_arena *arena,
                                       struct cs_error *error) {
    const struct cs_surfaces *surfaces = candidates->system->surfaces;
    struct cs_primitive_search *search = &candidates->search;
    if (cs_primitive_search_init(search, candidates->system, arena, error))
        return error->status;
    candidates->batches =
        cs_arena_alloc_array(arena, search->n_batches, sizeof *candidates->batches, error);
    candidates->rows[0] =
        cs_arena_alloc_array(arena, surfaces->n_points, sizeof **candidates->rows, error);
    candidates->rows[1] =
        cs_arena_alloc_array(arena, surfaces->n_edges, sizeof **candidates->rows, error);
    return error->status;
}

void cs_candidates_find_finish(struct cs_candidates *candidates) {
    for (uint32_t b = 0; candidates->batches && b < candidates->search.n_batches; b++)
        free(candidates->batches[b].pairs);
}

/* --- at a state --- */

static struct item_boxes boxes_of(const struct cs_candidates *candidates,
                                  const uint32_t *corners) {
    return (struct item_boxes){candidates->x_at_build, candidates->system->surfaces->n_points,
                               corners, candidates->body, candidates->body_pairs->has_partner};
}

/* A batch at work: pairs whose boxes overlap wait in the distance filter. */
struct work {
    const struct cs_candidates *search;
    struct cs_primitive_batch *of;
    struct cs_candidate_batch *batch;
    struct cs_distance_filter sieve;
};

/* Appends a pair to its batch. */
static void store_pairs(struct work *work, const uint32_t pair[2]) {
    struct cs_candidate_batch *batch = work->batch;
    uint32_t *pairs =
        cs_arena_realloc(batch->pairs, &batch->capacity, batch->n + 1, 2 * sizeof *pairs);
    work->of->failed = work->of->failed || !pairs;
    if (!pairs)
        return;
    batch->pairs = pairs;
    pairs[2 * batch->n] = pair[0];
    pairs[2 * batch->n + 1] = pair[1];
    batch->n++;
}

/* Empties the filter, and keeps the pairs that pass. */
static void measure(struct work *work) {
    const uint32_t n = cs_distance_filter_run(&work->sieve, work->of->edges);
    for (uint32_t l = 0; l < n; l++)
        store_pairs(work, work->sieve.pairs[l]);
}

/* m, distance up to which pairs are listed; the factor exceeds the rounding of boxes */
static double reach_of(const struct cs_candidates *candidates, double range) {
    return (range + 2 * candidates->margin_now) * (1 + 1e-9);
}

/* Puts the pairs of an item with n others into the filter, unless they have a common point or
 * no contact. A pair of edges is listed with its smaller number first, once. own: m, reach of
 * all pairs, within a body; 0: each has that of its bodies. */
CS_INLINE void take(struct work *work, enum cs_pair_kind kind, uint32_t item,
                    const uint32_t *others, uint32_t n, double own) {
    const struct cs_candidates *candidates = work->search;
    const bool edges = kind == CS_PAIR_EDGE_EDGE;
    for (uint32_t l = 0; l < n; l++) {
        const uint32_t pair[2] = {item, others[l]};
        uint32_t at[4];
        if (edges && others[l] <= item)
            continue;
        cs_candidate_vertices(candidates->system->surfaces, kind, pair, at);
        if (cs_seams_join_pair(candidates->system, at, edges))
            continue;
        double reach = own;
        if (!(reach > 0)) {
            const double range = cs_body_pair_params_range(
                cs_body_pair_params_of(candidates->body_pairs, candidates->body[at[0]],
                                       candidates->body[at[2]]),
                edges);
            if (!(range > 0))
                continue;
            reach = reach_of(candidates, range);
        }
        if (cs_distance_filter_add(&work->sieve, candidates->scaled_points, at,
                                   reach * candidates->inverse_unit, pair))
            measure(work);
    }
}

/* m, largest reach of a body for itself (own) or for other bodies; 0: it has no contact */
static double widest_reach(const struct cs_candidates *candidates, uint32_t body, bool own,
                           bool edges) {
    double widest = 0;
    for (uint32_t b = own ? body : 0; b < (own ? body + 1 : candidates->body_pairs->n_bodies);
         b++)
        if (own || b != body)
            widest = fmax(widest,
                          cs_body_pair_params_range(
                              cs_body_pair_params_of(candidates->body_pairs, body, b), edges));
    return widest > 0 ? reach_of(candidates, widest) : 0;
}

/* Box of all items of a cluster, grown by the reach. */
static struct cs_aabb group_box(const struct cs_candidates *candidates, bool edges,
                                uint32_t cluster, double reach) {
    const struct item_boxes points = boxes_of(candidates, NULL);
    struct cs_aabb all =
        edges ? candidates->search.edges.cluster_boxes[cluster] : cs_aabb_empty;
    for (uint32_t k = 0; k < CS_AABB_CLUSTER && !edges; k++) {
        const struct cs_aabb one =
            item_box(&points, 1,
                     candidates->search.points.items[CS_AABB_CLUSTER * (size_t)cluster + k], 0);
        cs_aabb_merge(&all, &one);
    }
    for (int c = 0; c < 3; c++) {
        all.low[c] -= reach;
        all.high[c] += reach;
    }
    return all;
}

/* A cluster of points or edges, and how far it reaches. */
struct group {
    const struct cs_aabb_clusters *of, *others;
    uint32_t cluster;
    bool edges;
    /* m: for its own body, and for others; 0: no contact */
    double reach[2];
};

/* Describes a cluster: points are tested against triangles, edges against edges. */
static struct group group_of(const struct cs_candidates *candidates, bool edges,
                             uint32_t cluster) {
    struct group group = {.of = edges ? &candidates->search.edges : &candidates->search.points,
                          .others =
                              edges ? &candidates->search.edges : &candidates->search.triangles,
                          .cluster = cluster,
                          .edges = edges};
    for (int k = 0; k < 2; k++)
        group.reach[k] = widest_reach(candidates, group.of->body[cluster], k == 0, edges);
    return group;
}

/* Finds the clusters near a group, of its own body or of others. Returns false if out of
 * memory. */
static bool find_clusters(const struct cs_candidates *candidates, const struct group *group,
                          bool own, struct cs_nearby_clusters *near) {
    const double reach = group->reach[!own];
    near->n = 0;
    if (!(reach > 0))
        return true;
    near->same_body_only = own;
    near->body = group->of->body[group->cluster];
    // an edge is listed with later ones alone
    near->first_item =
        group->edges ? group->of->items[CS_AABB_CLUSTER * (size_t)group->cluster] : 0;
    const struct cs_aabb box = group_box(candidates, group->edges, group->cluster, reach);
    return cs_nearby_clusters_find(near, group->others, &box);
}

/* Tests the box of one item against the items of the clusters found. */
static void find_item(struct work *work, const struct group *group, uint32_t item) {
    const struct cs_candidates *candidates = work->search;
    const struct item_boxes boxes = boxes_of(candidates, candidates->system->surfaces->edges);
    for (int k = 0; k < 2; k++) {
        struct cs_nearby_clusters *near = work->of->near + k;
        if (!near->n)
            continue;
        const double own = k ? 0 : group->reach[k];
        const struct cs_aabb box = group->edges ? item_box(&boxes, 2, item, group->reach[k])
                                                : item_box(&boxes, 1, item, group->reach[k]);
        const uint32_t n = cs_nearby_clusters_items(near, group->others, &box);
        if (group->edges)
            take(work, CS_PAIR_EDGE_EDGE, item, near->items, n, own);
        else
            take(work, CS_PAIR_POINT_TRIANGLE, item, near->items, n, own);
    }
}

/* Finds all pairs of the items of one cluster. */
static void query_cluster(struct work *work, uint32_t cluster) {
    const struct cs_candidates *candidates = work->search;
    struct cs_primitive_batch *batch = work->of;
    const struct group group = group_of(candidates, batch->edges, cluster);
    const uint32_t *items = group.of->items + CS_AABB_CLUSTER * (size_t)cluster;
    bool there = true;
    for (int k = 0; k < 2; k++)
        there = there && find_clusters(candidates, &group, k == 0, batch->near + k);
    batch->failed = batch->failed || !there;
    for (uint32_t k = 0; k < CS_AABB_CLUSTER && there && batch->near[0].n + batch->near[1].n;
         k++)
        if (items[k] != CS_NO_ITEM)
            find_item(work, &group, items[k]);
}

/* Notes where the pairs of each item are in the batch; they are contiguous. */
static void set_rows(const struct cs_candidates *candidates, const struct cs_aabb_clusters *of,
                     uint32_t number) {
    const struct cs_primitive_batch *items = candidates->search.batches + number;
    const struct cs_candidate_batch *batch = candidates->batches + number;
    struct cs_candidate_range *rows = candidates->rows[items->edges];
    for (size_t k = CS_AABB_CLUSTER * (size_t)items->begin;
         k < CS_AABB_CLUSTER * (size_t)items->end; k++)
        if (of->items[k] != CS_NO_ITEM)
            rows[of->items[k]] = (struct cs_candidate_range){number, 0, 0};
    for (size_t p = 0; p < batch->n; p++) {
        struct cs_candidate_range *row = rows + batch->pairs[2 * p];
        row->begin = row->n ? row->begin : (uint32_t)p;
        row->n++;
    }
}

/* Searches one batch. */
static void find_batch(void *arg, uint32_t number) {
    const struct cs_candidates *candidates = arg;
    struct work work;
    work.search = candidates;
    work.of = candidates->search.batches + number;
    work.batch = candidates->batches + number;
    work.sieve.n = 0;
    work.batch->n = 0;
    work.of->failed = false;
    for (uint32_t k = work.of->begin; k < work.of->end; k++)
        query_cluster(&work, k);
    measure(&work);
    set_rows(candidates,
             work.of->edges ? &candidates->search.edges : &candidates->search.points, number);
}

/* Boxes of the edges or triangles of a cluster at the state. */
static void edge_boxes(const void *arg, const uint32_t *items, struct cs_aabb *out) {
    for (int l = 0; l < CS_AABB_CLUSTER; l++)
        out[l] = item_box(arg, 2, items[l], 0);
}

static void triangle_boxes(const void *arg, const uint32_t *items, struct cs_aabb *out) {
    for (int l = 0; l < CS_AABB_CLUSTER; l++)
        out[l] = item_box(arg, 3, items[l], 0);
}

/* Boxes of triangles and edges are set first; then all batches run in parallel. */
bool cs_candidates_find(struct cs_candidates *candidates) {
    const struct cs_surfaces *surfaces = candidates->system->surfaces;
    struct cs_primitive_search *search = &candidates->search;
    const struct item_boxes triangles = boxes_of(candidates, surfaces->triangles),
                            edges = boxes_of(candidates, surfaces->edges);
    bool failed = !cs_aabb_clusters_fill(&search->triangles, triangle_boxes, &triangles) ||
                  !cs_aabb_clusters_fill(&search->edges, edge_boxes, &edges);
    cs_pool_run(search->n_batches, find_batch, candidates);
    for (uint32_t b = 0; b < search->n_batches; b++)
        failed = failed || search->batches[b].failed;
    return !failed;
}
