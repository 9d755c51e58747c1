/* The search for candidates: pairs whose boxes overlap (primitive_search.h), then the distance
 * filter in single precision; what remains is listed. */
#include "model/contact/broad_phase/candidate_list.h"

#include "base/pool.h"
#include "model/system/seams.h"

#include <string.h>

/* m, distance up to which pairs are listed; the factor exceeds the rounding of boxes */
static double reach_of(const struct cs_candidates *candidates, double range) {
    return (range + 2 * candidates->margin_now) * (1 + 1e-9);
}

static bool may_meet(const void *arg, uint32_t a, uint32_t b) {
    const struct cs_candidates *candidates = arg;
    return cs_body_pair_params_of(candidates->body_pairs, a, b)->range > 0;
}

/* Empties the distance filter, and appends the pairs that pass to a chunk. */
static void store_pairs(struct cs_candidate_chunk *chunk, struct cs_distance_filter *filter) {
    const uint32_t n = cs_distance_filter_run(chunk->kind, filter);
    chunk->failed =
        chunk->failed || !CS_ARENA_REALLOC(chunk->pairs, chunk->capacity, 2 * (chunk->n + n));
    if (!n || chunk->failed)
        return;
    memcpy(chunk->pairs + 2 * chunk->n, filter->pairs, n * sizeof *filter->pairs);
    chunk->n += n;
}

/* Takes pairs whose boxes overlap, unless they have a common point. */
static void store_chunk(void *arg, uint32_t number, const uint32_t (*pairs)[2], size_t n) {
    struct cs_candidates *candidates = arg;
    struct cs_candidate_chunk *chunk = candidates->chunks + number;
    struct cs_distance_filter filter;
    filter.n = 0;
    for (size_t k = 0; k < n; k++) {
        uint32_t at[4];
        cs_candidate_vertices(candidates->system->surfaces, chunk->kind, pairs[k], at);
        if (cs_seams_join_pair(candidates->system, at, chunk->kind == CS_PAIR_EDGE_EDGE))
            continue;
        const double reach =
            reach_of(candidates, cs_candidate_range_of(candidates, chunk->kind, at));
        if (cs_distance_filter_add(&filter, candidates->scaled_points, at,
                                   reach * candidates->inverse_unit, pairs[k]))
            store_pairs(chunk, &filter);
    }
    store_pairs(chunk, &filter);
}

bool cs_candidates_find(struct cs_candidates *candidates) {
    const struct cs_body_pair_params widest = {.range = candidates->body_pairs->range_max};
    const struct cs_move_query query = {
        .x0 = candidates->x_at_build,
        .reach = {reach_of(candidates, cs_body_pair_params_range(&widest, false)),
                  reach_of(candidates, cs_body_pair_params_range(&widest, true))},
        .may_meet = may_meet,
        .take = store_chunk,
        .arg = candidates};
    for (uint32_t l = 0; l < candidates->n_chunks; l++)
        candidates->chunks[l].n = 0, candidates->chunks[l].failed = false;
    bool failed = !cs_primitive_search_move(&candidates->search, &query);
    candidates->n_listed = 0;
    for (uint32_t l = 0; l < candidates->n_chunks; l++) {
        failed = failed || candidates->chunks[l].failed;
        candidates->n_listed += candidates->chunks[l].n;
    }
    return !failed;
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
