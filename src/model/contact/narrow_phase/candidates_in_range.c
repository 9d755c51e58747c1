/* Selects the candidates in range: by the single-precision filter, then by exact distances in
 * lanes. */
#include "model/contact/narrow_phase/candidates_in_range.h"

#include "base/arena.h"
#include "base/pool.h"
#include "model/contact/narrow_phase/exact_distance.h"
#include "model/contact/narrow_phase/pair_lanes.h"

#include <string.h>

/* Blocks of eight that are measured together: a vector load directly after scalar stores to the
 * same addresses would stall. */
enum { TOGETHER = 4, WAITING = TOGETHER * CS_PAIR_LANES };

/* One chunk at work: most pairs end in the distance filter. */
struct work {
    const struct cs_candidates *search;
    struct cs_candidate_chunk *chunk;
    struct cs_distance_filter sieve; /* first: most are held back there */
    struct cs_pair_lanes lanes[TOGETHER];
    uint32_t pairs[WAITING][2], waiting;
};

/* Distances of a block. Edges have the smooth one, that of their force. Triangles have the true
 * one, because their features may have smaller distances than the smooth one of the whole
 * triangle; a feature in range implies a true distance in range (mesh_feature.h). */
static void measure_lanes(enum cs_pair_kind kind, struct cs_pair_lanes *lanes) {
    struct cs_exact_distance_lanes near;
    if (kind == CS_PAIR_EDGE_EDGE) {
        cs_pair_lanes_measure(kind, lanes);
        return;
    }
    memcpy(near.p, lanes->p, sizeof near.p);
    cs_exact_distance_measure(kind, &near);
    for (int l = 0; l < CS_PAIR_LANES; l++)
        lanes->d[l] = sqrt(near.squared[l]);
}

/* Appends those of the waiting pairs that are in range, without a branch. */
static void measure(struct work *work) {
    struct cs_candidate_chunk *chunk = work->chunk;
    for (uint32_t k = 0; k < work->waiting; k += CS_PAIR_LANES)
        measure_lanes(chunk->kind, work->lanes + k / CS_PAIR_LANES);
    for (uint32_t k = 0; k < work->waiting; k++) {
        const struct cs_pair_lanes *lanes = work->lanes + k / CS_PAIR_LANES;
        const uint32_t l = k % CS_PAIR_LANES;
        // one that is out of range is written over
        memcpy(chunk->in_range + 2 * chunk->n_in_range, work->pairs[k], sizeof work->pairs[k]);
        chunk->n_in_range += lanes->d[l] < lanes->range[l];
    }
    work->waiting = 0;
}

/* Adds a pair that passed the filter to the waiting ones. */
static void take(struct work *work, const uint32_t pair[2]) {
    const struct cs_candidates *candidates = work->search;
    const size_t n = candidates->system->surfaces->n_points;
    const uint32_t k = work->waiting++, l = k % CS_PAIR_LANES;
    struct cs_pair_lanes *lanes = work->lanes + k / CS_PAIR_LANES;
    uint32_t at[4];
    cs_candidate_vertices(candidates->system->surfaces, work->chunk->kind, pair, at);
    memcpy(work->pairs[k], pair, sizeof work->pairs[k]);
    lanes->range[l] = cs_candidate_range_of(candidates, work->chunk->kind, at);
    for (size_t j = 0; j < 4; j++)
        for (size_t c = 0; c < 3; c++)
            lanes->p[j][c][l] = candidates->x_at_close[c * n + at[j]];
    if (work->waiting == WAITING)
        measure(work);
}

/* Runs the filter on the pairs it holds. */
static void filter_chunk(struct work *work) {
    const uint32_t n =
        cs_distance_filter_run(&work->sieve, work->chunk->kind == CS_PAIR_EDGE_EDGE);
    for (uint32_t l = 0; l < n; l++)
        take(work, work->sieve.pairs[l]);
}

static void put(struct work *work, const uint32_t pair[2]) {
    const struct cs_candidates *candidates = work->search;
    uint32_t at[4];
    cs_candidate_vertices(candidates->system->surfaces, work->chunk->kind, pair, at);
    const double reach =
        candidates->inverse_unit * cs_candidate_range_of(candidates, work->chunk->kind, at);
    if (cs_distance_filter_add(&work->sieve, candidates->scaled_points, at, reach, pair))
        filter_chunk(work);
}

static void find_chunk(void *arg, uint32_t number) {
    const struct cs_candidates *candidates = arg;
    struct cs_candidate_chunk *chunk = candidates->chunks + number;
    struct work work;
    work.search = candidates;
    work.chunk = chunk;
    work.waiting = work.sieve.n = 0;
    uint32_t *close = cs_arena_realloc(chunk->in_range, &chunk->close_capacity, chunk->n,
                                       2 * sizeof *chunk->in_range);
    chunk->n_in_range = 0;
    chunk->failed = chunk->n && !close;
    if (chunk->failed)
        return;
    chunk->in_range = close;
    for (size_t k = 0; k < chunk->n; k++)
        put(&work, chunk->pairs + 2 * k);
    filter_chunk(&work);
    measure(&work);
}

bool cs_candidates_find_in_range(struct cs_candidates *candidates, const double *x) {
    const size_t bytes = 3 * sizeof *x * candidates->system->surfaces->n_points;
    if (candidates->has_close_pairs && !memcmp(candidates->x_at_close, x, bytes))
        return true;
    candidates->has_close_pairs = false;
    if (!cs_candidates_update(candidates, x))
        return false;
    memcpy(candidates->x_at_close, x, bytes);
    if (candidates->n_listed)
        cs_candidates_scale_points(candidates, x);
    cs_pool_run(candidates->n_chunks, find_chunk, candidates);
    bool failed = false;
    for (uint32_t l = 0; l < candidates->n_chunks; l++)
        failed = failed || candidates->chunks[l].failed;
    candidates->has_close_pairs = !failed;
    candidates->close_count++;
    return !failed;
}
