/* Merges the batches into chunks in the order of keys, and scales positions to single
 * precision. */
#include "model/contact/broad_phase/candidate_list.h"

#include "base/pool.h"

#include <string.h>

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
    uint32_t *pairs = cs_arena_realloc(chunk->pairs, &chunk->capacity, n, 2 * sizeof *pairs);
    chunk->n = 0;
    chunk->failed = n && !pairs;
    if (!n || !pairs)
        return;
    chunk->pairs = pairs;
    for (uint32_t i = chunk->begin; i < chunk->end; i++) {
        if (!rows[i].n)
            continue;
        put_row(i, candidates->batches[rows[i].batch].seconds + rows[i].begin, rows[i].n,
                pairs + 2 * chunk->n);
        chunk->n += rows[i].n;
    }
}

bool cs_candidates_merge_batches(struct cs_candidates *candidates) {
    bool failed = false;
    cs_pool_run(candidates->n_chunks, list_chunk, candidates);
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
