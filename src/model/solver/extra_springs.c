/* Builds the lists of extra springs of a level, cell by cell, for every matrix.
 *
 * A chunk of blocks is filled in the order of its cells, so its slots are contiguous and the
 * result does not depend on threads. */
#include "model/solver/extra_springs.h"

#include "base/pool.h"

#include <clothsim/small.h>
#include <stdlib.h>
#include <string.h>

enum { LANES = CS_EXTRA_SPRINGS_LANES };

/* Frees the chunks' arrays, which outgrow the arena. */
static void finish_springs(void *object) {
    struct cs_extra_springs *springs = object;
    for (uint32_t p = 0; p < springs->n_pieces; p++) {
        free(springs->chunks[p].list);
        free(springs->chunks[p].partners);
        free(springs->chunks[p].cells);
        free(springs->chunks[p].springs);
    }
}

enum cs_status cs_extra_springs_init(struct cs_extra_springs *springs, uint32_t first,
                                     uint32_t n_cells, struct cs_arena *arena,
                                     struct cs_error *error) {
    *springs = (struct cs_extra_springs){.n_blocks = n_cells / LANES, .first = first};
    const uint32_t n_pieces =
        (springs->n_blocks + CS_EXTRA_SPRINGS_CHUNK - 1) / CS_EXTRA_SPRINGS_CHUNK;
    springs->chunks = cs_arena_alloc_array(arena, n_pieces, sizeof *springs->chunks, error);
    springs->begins = cs_arena_alloc_array(arena, springs->n_blocks, sizeof(uint32_t), error);
    CS_ARENA_ARRAY(arena, springs->diagonal_share, 6 * (size_t)n_cells, error);
    springs->ends = cs_arena_alloc_array(arena, springs->n_blocks, sizeof(uint32_t), error);
    springs->n_pieces = error->status ? 0 : n_pieces;
    if (!error->status)
        cs_arena_adopt(arena, finish_springs, springs, error);
    return error->status;
}

/* Finds the spring to a cell in the list, or appends one. A linear search, because a cell has
 * few partners. Returns NULL if out of memory. */
static struct cs_extra_spring *link_to(struct cs_extra_springs_chunk *chunk, uint32_t to) {
    const size_t n = chunk->n_list;
    for (size_t k = 0; k < n; k++)
        if (chunk->partners[k] == to)
            return chunk->list + k;
    chunk->failed = chunk->failed ||
                    !CS_ARENA_REALLOC(chunk->list, chunk->list_capacity, n + 1) ||
                    !CS_ARENA_REALLOC(chunk->partners, chunk->partners_capacity, n + 1);
    if (chunk->failed)
        return NULL;
    chunk->partners[n] = to;
    chunk->list[n] = (struct cs_extra_spring){0};
    chunk->n_list++;
    return chunk->list + n;
}

/* The sign of the trace decides. Blocks of contact pairs have eigenvalues of one sign only. */
void cs_extra_springs_add(struct cs_extra_springs_chunk *chunk, uint32_t to,
                          const float block[6], float factor) {
    struct cs_extra_spring *spring = link_to(chunk, to);
    const bool less = factor * (block[0] + block[3] + block[5]) < 0;
    for (int c = 0; spring && c < 6; c++)
        *((less ? spring->negative : spring->positive) + c) += factor * block[c];
}

/* Tells whether a block is positive semi-definite up to rounding. A spring may be stiff in one
 * direction alone, so 1e-6 of the trace is added before the test of the minors: the rounding of
 * a sum of floats is below that. */
static bool is_positive(const float block[6]) {
    double sum[6], cofactors[6];
    for (int c = 0; c < 6; c++)
        sum[c] = (double)block[c];
    const double extra = 1e-6 * (sum[0] + sum[3] + sum[5]);
    for (int c = 0; c < 6; c += c ? 2 : 3)
        sum[c] += extra;
    const double determinant = cs_sym3_cofactors(sum, cofactors);
    return cs_sym3_is_definite(sum, cofactors, determinant);
}

/* Appends an empty slot for 16 cells with joint numbers from `first` on: each cell is its own
 * neighbour, with the block 0. Returns false if out of memory, now or before. */
static bool open_slot(struct cs_extra_springs_chunk *chunk, uint32_t first) {
    const size_t n = (size_t)chunk->slots_used + 1, slot = chunk->slots_used;
    chunk->failed = chunk->failed ||
                    !CS_ARENA_REALLOC(chunk->cells, chunk->cells_capacity, LANES * n) ||
                    !CS_ARENA_REALLOC(chunk->springs, chunk->springs_capacity, 6 * LANES * n);
    if (chunk->failed)
        return false;
    for (uint32_t l = 0; l < LANES; l++)
        chunk->cells[LANES * slot + l] = first + l;
    memset(chunk->springs + 6 * LANES * slot, 0, 6 * LANES * sizeof *chunk->springs);
    chunk->slots_used++;
    return true;
}

/* Stores a spring in its slot and adds its part to the diagonal. A sum of both signs that is
 * positive semi-definite is its own part. If it is indefinite with a positive trace, the sum of
 * the positive contributions is taken instead. A sum of negative trace adds nothing. */
static void put_link(struct cs_extra_springs *springs, struct cs_extra_springs_chunk *chunk,
                     uint32_t cell, uint32_t k, size_t slot) {
    const struct cs_extra_spring *spring = chunk->list + k;
    const size_t n = (size_t)springs->n_blocks * LANES;
    float sum[6];
    for (int c = 0; c < 6; c++)
        sum[c] = spring->positive[c] + spring->negative[c];
    const bool above = sum[0] + sum[3] + sum[5] > 0;
    const bool mixed = spring->negative[0] + spring->negative[3] + spring->negative[5] < 0;
    const float *held = mixed && above && is_positive(sum) ? sum : spring->positive;
    chunk->cells[LANES * slot + cell % LANES] = chunk->partners[k];
    for (size_t c = 0; c < 6; c++) {
        chunk->springs[LANES * (6 * slot + c) + cell % LANES] = sum[c];
        springs->diagonal_share[c * n + cell] += above ? held[c] : 0;
    }
}

/* Stores the list of a cell from `slot` on, opening slots as needed, and sets its part of the
 * diagonal. */
static void put_list(struct cs_extra_springs *springs, struct cs_extra_springs_chunk *chunk,
                     uint32_t cell, size_t slot) {
    const size_t n = (size_t)springs->n_blocks * LANES;
    for (size_t c = 0; c < 6; c++)
        springs->diagonal_share[c * n + cell] = 0;
    for (uint32_t k = 0; k < chunk->n_list; k++, slot++)
        if (slot < chunk->slots_used || open_slot(chunk, springs->first + cell / LANES * LANES))
            put_link(springs, chunk, cell, k, slot);
}

/* Arguments of the loop over chunks. */
struct making {
    struct cs_extra_springs *springs;
    void (*find)(void *arg, struct cs_extra_springs_chunk *chunk, uint32_t cell);
    void *arg;
};

/* Builds one chunk. Blocks follow one another, so slots of a block are contiguous in it. */
static void make_piece(void *arg, uint32_t number) {
    const struct making *making = arg;
    struct cs_extra_springs *springs = making->springs;
    struct cs_extra_springs_chunk *chunk = springs->chunks + number;
    chunk->slots_used = 0;
    chunk->failed = false;
    const uint32_t begin = number * CS_EXTRA_SPRINGS_CHUNK,
                   end = begin + CS_EXTRA_SPRINGS_CHUNK;
    for (uint32_t b = begin; b < end && b < springs->n_blocks; b++) {
        springs->begins[b] = chunk->slots_used;
        for (uint32_t l = 0; l < LANES; l++) {
            chunk->n_list = 0;
            making->find(making->arg, chunk, LANES * b + l);
            put_list(springs, chunk, LANES * b + l, springs->begins[b]);
        }
        springs->ends[b] = chunk->slots_used;
    }
}

/* After failure is_nonempty is false, and the kernels skip the lists. */
bool cs_extra_springs_make(struct cs_extra_springs *springs,
                           void (*find)(void *arg, struct cs_extra_springs_chunk *chunk,
                                        uint32_t cell),
                           void *arg) {
    struct making making = {springs, find, arg};
    bool failed = false;
    springs->is_nonempty = false;
    cs_pool_run(springs->n_pieces, make_piece, &making);
    for (uint32_t p = 0; p < springs->n_pieces; p++) {
        failed = failed || springs->chunks[p].failed;
        springs->is_nonempty = springs->is_nonempty || springs->chunks[p].slots_used;
    }
    springs->is_nonempty = springs->is_nonempty && !failed;
    return !failed;
}
