/* Merges the batches into chunks in the order of keys, and scales positions to single
 * precision. */
#include "model/contact/broad_phase/candidate_list.h"

#include "base/pool.h"

#include <math.h>
#include <string.h>

/* Insertion sort of the pairs of one item by their second number: they are few. */
static void sort_row(uint32_t *pairs, size_t n) {
    for (size_t i = 1; i < n; i++) {
        const uint32_t second = pairs[2 * i + 1];
        size_t j = i;
        for (; j > 0 && pairs[2 * j - 1] > second; j--)
            pairs[2 * j + 1] = pairs[2 * j - 1];
        pairs[2 * j + 1] = second;
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
        memcpy(pairs + 2 * chunk->n,
               candidates->batches[rows[i].batch].pairs + 2 * (size_t)rows[i].begin,
               2 * rows[i].n * sizeof *pairs);
        sort_row(pairs + 2 * chunk->n, rows[i].n);
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

/* Decides which blocks of grids are flat, and keeps the rectangles that the search skips. */

/* empty rectangle: the block is not flat */
static const struct cs_grid_rectangle nowhere = {{HUGE_VALF, HUGE_VALF},
                                                 {-HUGE_VALF, -HUGE_VALF}};

/* --- made once --- */

/* 2^24: rows and columns are compared as floats, which are exact up to there */
enum { POINTS_MAX = 1 << 24 };

/* Returns whether a body is a grid with self-contact and few enough points. */
static bool is_grid(const struct cs_system *system, const struct cs_body_pair_table *meetings,
                    uint32_t body) {
    if (body >= system->scene->bodies.n ||
        !(cs_body_pair_params_of(meetings, body, body)->range > 0))
        return false;
    const struct cs_body_range *range = system->bodies + body;
    return !range->mesh && range->columns > 1 && range->rows > 1 &&
           range->first + range->count <= POINTS_MAX;
}

/* Adds a grid with its blocks numbered after those of the grids before. */
static void add_grid(struct cs_candidates_flat *flat, const struct cs_body_range *range,
                     struct cs_flat_region **grid, struct cs_arena *arena,
                     struct cs_error *error) {
    *grid = cs_arena_alloc(arena, sizeof **grid, error);
    if (error->status)
        return;
    // rows are numbered through by points, so that no two grids have one in common
    **grid = (struct cs_flat_region){.first = range->first,
                                     .columns = range->columns,
                                     .rows = range->rows,
                                     .first_row = range->first,
                                     .first_block = flat->n_blocks};
    if (!cs_flat_region_init(*grid, arena, error))
        flat->n_blocks += (*grid)->n_blocks_x * (*grid)->n_blocks_y;
}

enum cs_status cs_candidates_flat_init(struct cs_candidates_flat *flat,
                                       const struct cs_system *system,
                                       const struct cs_body_pair_table *meetings,
                                       struct cs_arena *arena, struct cs_error *error) {
    const size_t n = system->surfaces->n_points;
    *flat = (struct cs_candidates_flat){.body_pairs = meetings, .n_points = n};
    flat->grids =
        cs_arena_alloc_array(arena, meetings->n_bodies, sizeof(struct cs_flat_region *), error);
    for (uint32_t b = 0; b < meetings->n_bodies && !error->status; b++)
        if (is_grid(system, meetings, b))
            add_grid(flat, system->bodies + b, flat->grids + b, arena, error);
    for (int kind = 0; kind < 2 && flat->n_blocks; kind++)
        flat->work_neighbourhood[kind] = cs_arena_alloc_array(
            arena, flat->n_blocks, sizeof *flat->work_neighbourhood[kind], error);
    if (flat->n_blocks)
        flat->x_at_build = cs_arena_alloc_array(arena, 3 * n, sizeof *flat->x_at_build, error);
    return error->status;
}

/* --- at a state --- */

/* Rectangle of points of a block and the eight around it. */
static struct cs_grid_rectangle neighbourhood_of(const struct cs_flat_region *grid,
                                                 uint32_t down, uint32_t across) {
    const uint32_t top = CS_FLAT_REGION_BLOCK * (down ? down - 1 : 0);
    const uint32_t end = CS_FLAT_REGION_BLOCK * (down + 2);
    const uint32_t last = end < grid->rows ? end : grid->rows - 1;
    return (struct cs_grid_rectangle){
        {(float)(grid->first_row + top),
         (float)(CS_FLAT_REGION_BLOCK * (across ? across - 1 : 0))},
        {(float)(grid->first_row + last), (float)(CS_FLAT_REGION_BLOCK * (across + 2))}};
}

/* m, distance that skipped pairs must have: the range, plus what both sides may move */
static double needed(const struct cs_candidates_flat *flat, uint32_t body, bool edges,
                     double margin) {
    return cs_body_pair_params_range(cs_body_pair_params_of(flat->body_pairs, body, body),
                                     edges) +
           2 * margin;
}

/* Sets the rectangles of one grid to those of flat blocks; returns their number. A comparison
 * with NaN is false, so that a block with positions that are not finite is not flat. */
static uint32_t find_in(const struct cs_flat_region *grid, double apart,
                        struct cs_grid_rectangle *round) {
    uint32_t n = 0;
    for (uint32_t b = 0; b < grid->n_blocks_x * grid->n_blocks_y; b++) {
        const bool is = grid->min_distance[b] >= apart;
        round[grid->first_block + b] =
            is ? neighbourhood_of(grid, b / grid->n_blocks_x, b % grid->n_blocks_x) : nowhere;
        n += is;
    }
    return n;
}

/* Restarts the margin of flat blocks at x. */
static void store_state(struct cs_candidates_flat *flat, const double *x, double margin) {
    memcpy(flat->x_at_build, x, 3 * flat->n_points * sizeof *x);
    flat->margin_now = margin;
}

/* Both kinds of pairs have rectangles of their own, because edges have a smaller range. */
void cs_candidates_flat_find(struct cs_candidates_flat *flat, const double *x, double margin) {
    flat->n_flat_blocks = 0;
    for (uint32_t b = 0; b < flat->body_pairs->n_bodies; b++) {
        struct cs_flat_region *grid = flat->grids[b];
        if (grid)
            cs_flat_region_measure(grid, x, flat->n_points);
        for (int kind = 0; kind < 2 && grid; kind++)
            flat->n_flat_blocks +=
                find_in(grid, needed(flat, b, kind == CS_PAIR_EDGE_EDGE, margin),
                        flat->work_neighbourhood[kind]);
    }
    if (flat->n_flat_blocks)
        store_state(flat, x, margin);
}

/* Returns whether all blocks that were flat are so still. */
static bool has_not_moved(const struct cs_flat_region *grid, double apart,
                          const struct cs_grid_rectangle *round) {
    bool still = true;
    for (uint32_t b = 0; b < grid->n_blocks_x * grid->n_blocks_y; b++)
        still = still && (round[grid->first_block + b].first[0] == nowhere.first[0] ||
                          grid->min_distance[b] >= apart);
    return still;
}

bool cs_candidates_flat_renew(struct cs_candidates_flat *flat, const double *x, double margin) {
    bool still = true;
    for (uint32_t b = 0; b < flat->body_pairs->n_bodies && still; b++) {
        struct cs_flat_region *grid = flat->grids[b];
        if (grid)
            cs_flat_region_measure(grid, x, flat->n_points);
        for (int kind = 0; kind < 2 && grid; kind++)
            still =
                still && has_not_moved(grid, needed(flat, b, kind == CS_PAIR_EDGE_EDGE, margin),
                                       flat->work_neighbourhood[kind]);
    }
    if (still)
        store_state(flat, x, margin);
    return still;
}
