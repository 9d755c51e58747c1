/* The search for candidates, in three filters: the clusters of triangles or edges near a
 * cluster of points or edges, and the boxes of their items (primitive_search.h); the distance
 * filter in single precision; what remains is listed.
 *
 * A batch of clusters is one thread's. Batches follow the order of clusters, which is spatial;
 * their pairs are brought into the order of keys afterwards. */
#include "model/contact/broad_phase/candidate_list.h"

#include "base/pool.h"
#include "model/system/seams.h"

#include <stdlib.h>
#include <string.h>

enum cs_status cs_candidates_find_init(struct cs_candidates *candidates, struct cs_arena *arena,
                                       struct cs_error *error) {
    const struct cs_surfaces *surfaces = candidates->system->surfaces;
    struct cs_primitive_search *search = &candidates->search;
    if (cs_primitive_search_init(search, candidates->system, arena, error))
        return error->status;
    CS_ARENA_ARRAY(arena, candidates->batches, search->n_batches, error);
    CS_ARENA_ARRAY(arena, candidates->rows[0], surfaces->n_points, error);
    CS_ARENA_ARRAY(arena, candidates->rows[1], surfaces->n_edges, error);
    return error->status;
}

void cs_candidates_find_finish(struct cs_candidates *candidates) {
    for (uint32_t b = 0; candidates->batches && b < candidates->search.n_batches; b++)
        free(candidates->batches[b].pairs), free(candidates->batches[b].seconds);
}

/* m, distance up to which pairs are listed; the factor exceeds the rounding of boxes */
static double reach_of(const struct cs_candidates *candidates, double range) {
    return (range + 2 * candidates->margin_now) * (1 + 1e-9);
}

static bool may_meet(const void *arg, uint32_t a, uint32_t b) {
    const struct cs_candidates *candidates = arg;
    return cs_body_pair_params_of(candidates->body_pairs, a, b)->range > 0;
}

/* Empties the distance filter, and appends the pairs that pass to a batch. */
static void store_pairs(struct cs_candidates *candidates, uint32_t number,
                        struct cs_distance_filter *filter) {
    struct cs_candidate_batch *batch = candidates->batches + number;
    struct cs_primitive_batch *of = candidates->search.batches + number;
    const uint32_t n = cs_distance_filter_run(filter, of->edges);
    of->failed =
        of->failed || !CS_ARENA_REALLOC(batch->pairs, batch->capacity, 2 * (batch->n + n));
    if (!n || of->failed)
        return;
    memcpy(batch->pairs + 2 * batch->n, filter->pairs, n * sizeof *filter->pairs);
    batch->n += n;
}

/* Takes pairs whose boxes overlap, unless they have a common point. */
static void store_chunk(void *arg, uint32_t number, const uint32_t (*pairs)[2], size_t n) {
    struct cs_candidates *candidates = arg;
    const bool edges = candidates->search.batches[number].edges;
    const enum cs_pair_kind kind = edges ? CS_PAIR_EDGE_EDGE : CS_PAIR_POINT_TRIANGLE;
    struct cs_distance_filter filter;
    filter.n = 0;
    for (size_t k = 0; k < n; k++) {
        uint32_t at[4];
        cs_candidate_vertices(candidates->system->surfaces, kind, pairs[k], at);
        if (cs_seams_join_pair(candidates->system, at, edges))
            continue;
        const double reach = reach_of(candidates, cs_candidate_range_of(candidates, kind, at));
        if (cs_distance_filter_add(&filter, candidates->scaled_points, at,
                                   reach * candidates->inverse_unit, pairs[k]))
            store_pairs(candidates, number, &filter);
    }
    store_pairs(candidates, number, &filter);
}

/* Sorts the pairs of a batch by their first items, and notes where those of each are. */
static void sort_batch(void *arg, uint32_t number) {
    const struct cs_candidates *candidates = arg;
    struct cs_primitive_batch *of = candidates->search.batches + number;
    struct cs_candidate_batch *batch = candidates->batches + number;
    struct cs_candidate_range *rows = candidates->rows[of->edges];
    const uint32_t *items =
        (of->edges ? &candidates->search.edges : &candidates->search.points)->items;
    const size_t first = CS_AABB_CLUSTER * (size_t)of->begin,
                 end = CS_AABB_CLUSTER * (size_t)of->end;
    of->failed =
        of->failed || !CS_ARENA_REALLOC(batch->seconds, batch->seconds_capacity, batch->n);
    for (size_t k = first; k < end; k++)
        if (items[k] != CS_NO_ITEM)
            rows[items[k]] = (struct cs_candidate_range){number, 0, 0};
    if (of->failed)
        return;
    for (size_t p = 0; p < batch->n; p++)
        rows[batch->pairs[2 * p]].n++;
    // counts become begins; filling then counts again
    for (uint32_t k = (uint32_t)first, begin = 0; k < end; k++)
        if (items[k] != CS_NO_ITEM) {
            rows[items[k]].begin = begin;
            begin += rows[items[k]].n;
            rows[items[k]].n = 0;
        }
    for (size_t p = 0; p < batch->n; p++) {
        struct cs_candidate_range *row = rows + batch->pairs[2 * p];
        batch->seconds[row->begin + row->n++] = batch->pairs[2 * p + 1];
    }
}

/* Writes the n pairs of one item in the order of their second numbers, by insertion: they are
 * few. */
static void put_row(uint32_t item, const uint32_t *seconds, size_t n, uint32_t *pairs) {
    for (size_t i = 0; i < n; i++) {
        size_t j = i;
        for (; j > 0 && pairs[2 * j - 1] > seconds[i]; j--)
            pairs[2 * j + 1] = pairs[2 * j - 1];
        pairs[2 * j + 1] = seconds[i];
        pairs[2 * i] = item;
    }
}

/* Copies the pairs of the items of a chunk from their batches, item by item in ascending order.
 */
static void list_chunk(void *arg, uint32_t number) {
    const struct cs_candidates *candidates = arg;
    struct cs_candidate_chunk *chunk = candidates->chunks + number;
    const struct cs_candidate_range *rows = candidates->rows[chunk->kind];
    size_t n = 0;
    for (uint32_t i = chunk->begin; i < chunk->end; i++)
        n += rows[i].n;
    chunk->n = 0;
    chunk->failed = !CS_ARENA_REALLOC(chunk->pairs, chunk->capacity, 2 * n);
    for (uint32_t i = chunk->begin; i < chunk->end && !chunk->failed; i++) {
        if (!rows[i].n)
            continue;
        put_row(i, candidates->batches[rows[i].batch].seconds + rows[i].begin, rows[i].n,
                chunk->pairs + 2 * chunk->n);
        chunk->n += rows[i].n;
    }
}

/* Fills all chunks from the batches in the order of keys; returns false if out of memory. */
static bool merge_batches(struct cs_candidates *candidates) {
    bool failed = false;
    cs_pool_run(candidates->n_chunks, list_chunk, candidates);
    candidates->n_listed = 0;
    for (uint32_t l = 0; l < candidates->n_chunks; l++) {
        failed = failed || candidates->chunks[l].failed;
        candidates->n_listed += candidates->chunks[l].n;
    }
    return !failed;
}

bool cs_candidates_find(struct cs_candidates *candidates) {
    struct cs_primitive_search *search = &candidates->search;
    const struct cs_body_pair_params widest = {.range = candidates->body_pairs->range_max};
    const struct cs_move_query query = {
        .x0 = candidates->x_at_build,
        .reach = {reach_of(candidates, cs_body_pair_params_range(&widest, false)),
                  reach_of(candidates, cs_body_pair_params_range(&widest, true))},
        .may_meet = may_meet,
        .take = store_chunk,
        .arg = candidates};
    for (uint32_t b = 0; b < search->n_batches; b++)
        candidates->batches[b].n = 0;
    bool failed = !cs_primitive_search_move(search, &query);
    cs_pool_run(search->n_batches, sort_batch, candidates);
    for (uint32_t b = 0; b < search->n_batches; b++)
        failed = failed || search->batches[b].failed;
    return !failed && merge_batches(candidates);
}

/* A list, and the state that is scaled. */
struct rounding {
    struct cs_candidates *search;
    const double *x;
};

/* points per job */
enum { ROUNDED = 2048 };

static void round_block(void *arg, uint32_t number) {
    const struct rounding *rounding = arg;
    const size_t n = rounding->search->system->surfaces->n_points;
    const size_t begin = (size_t)ROUNDED * number;
    cs_distance_filter_scale_points(rounding->x, n, rounding->search->inverse_unit, begin,
                                    n - begin < ROUNDED ? n : begin + ROUNDED,
                                    rounding->search->scaled_points);
}

void cs_candidates_scale_points(struct cs_candidates *candidates, const double *x) {
    struct rounding rounding = {candidates, x};
    cs_pool_run((candidates->system->surfaces->n_points + ROUNDED - 1) / ROUNDED, round_block,
                &rounding);
}
