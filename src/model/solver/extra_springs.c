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
static void finish(void *object) {
    struct cs_extra_springs *links = object;
    for (uint32_t p = 0; p < links->n_pieces; p++) {
        free(links->chunks[p].list);
        free(links->chunks[p].partners);
        free(links->chunks[p].cells);
        free(links->chunks[p].springs);
    }
}

enum cs_status cs_extra_springs_init(struct cs_extra_springs *links, uint32_t first,
                                     uint32_t n_cells, struct cs_arena *arena,
                                     struct cs_error *error) {
    *links = (struct cs_extra_springs){.n_blocks = n_cells / LANES, .first = first};
    const uint32_t n_pieces =
        (links->n_blocks + CS_EXTRA_SPRINGS_CHUNK - 1) / CS_EXTRA_SPRINGS_CHUNK;
    links->chunks = cs_arena_alloc_array(arena, n_pieces, sizeof *links->chunks, error);
    links->begins = cs_arena_alloc_array(arena, links->n_blocks, sizeof(uint32_t), error);
    CS_ARENA_ARRAY(arena, links->diagonal_share, 6 * (size_t)n_cells, error);
    links->ends = cs_arena_alloc_array(arena, links->n_blocks, sizeof(uint32_t), error);
    links->n_pieces = error->status ? 0 : n_pieces;
    if (!error->status)
        cs_arena_adopt(arena, finish, links, error);
    return error->status;
}

/* Finds the spring to a cell in the list, or appends one. A linear search, because a cell has
 * few partners. Returns NULL if out of memory. */
static struct cs_extra_spring *link_to(struct cs_extra_springs_chunk *piece, uint32_t to) {
    const size_t n = piece->n_list;
    for (size_t k = 0; k < n; k++)
        if (piece->partners[k] == to)
            return piece->list + k;
    piece->failed = piece->failed ||
                    !CS_ARENA_REALLOC(piece->list, piece->list_capacity, n + 1) ||
                    !CS_ARENA_REALLOC(piece->partners, piece->partners_capacity, n + 1);
    if (piece->failed)
        return NULL;
    piece->partners[n] = to;
    piece->list[n] = (struct cs_extra_spring){0};
    piece->n_list++;
    return piece->list + n;
}

/* The sign of the trace decides. Blocks of contact pairs have eigenvalues of one sign only. */
void cs_extra_springs_add(struct cs_extra_springs_chunk *piece, uint32_t to,
                          const float block[6], float factor) {
    struct cs_extra_spring *link = link_to(piece, to);
    const bool less = factor * (block[0] + block[3] + block[5]) < 0;
    for (int c = 0; link && c < 6; c++)
        *((less ? link->negative : link->positive) + c) += factor * block[c];
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
static bool open_slot(struct cs_extra_springs_chunk *piece, uint32_t first) {
    const size_t n = (size_t)piece->slots_used + 1, slot = piece->slots_used;
    piece->failed = piece->failed ||
                    !CS_ARENA_REALLOC(piece->cells, piece->cells_capacity, LANES * n) ||
                    !CS_ARENA_REALLOC(piece->springs, piece->springs_capacity, 6 * LANES * n);
    if (piece->failed)
        return false;
    for (uint32_t l = 0; l < LANES; l++)
        piece->cells[LANES * slot + l] = first + l;
    memset(piece->springs + 6 * LANES * slot, 0, 6 * LANES * sizeof *piece->springs);
    piece->slots_used++;
    return true;
}

/* Stores a spring in its slot and adds its part to the diagonal. A sum of both signs that is
 * positive semi-definite is its own part. If it is indefinite with a positive trace, the sum of
 * the positive contributions is taken instead. A sum of negative trace adds nothing. */
static void put_link(struct cs_extra_springs *links, struct cs_extra_springs_chunk *piece,
                     uint32_t cell, uint32_t k, size_t slot) {
    const struct cs_extra_spring *link = piece->list + k;
    const size_t n = (size_t)links->n_blocks * LANES;
    float sum[6];
    for (int c = 0; c < 6; c++)
        sum[c] = link->positive[c] + link->negative[c];
    const bool above = sum[0] + sum[3] + sum[5] > 0;
    const bool mixed = link->negative[0] + link->negative[3] + link->negative[5] < 0;
    const float *held = mixed && above && is_positive(sum) ? sum : link->positive;
    piece->cells[LANES * slot + cell % LANES] = piece->partners[k];
    for (size_t c = 0; c < 6; c++) {
        piece->springs[LANES * (6 * slot + c) + cell % LANES] = sum[c];
        links->diagonal_share[c * n + cell] += above ? held[c] : 0;
    }
}

/* Stores the list of a cell from `slot` on, opening slots as needed, and sets its part of the
 * diagonal. */
static void put_list(struct cs_extra_springs *links, struct cs_extra_springs_chunk *piece,
                     uint32_t cell, size_t slot) {
    const size_t n = (size_t)links->n_blocks * LANES;
    for (size_t c = 0; c < 6; c++)
        links->diagonal_share[c * n + cell] = 0;
    for (uint32_t k = 0; k < piece->n_list; k++, slot++)
        if (slot < piece->slots_used || open_slot(piece, links->first + cell / LANES * LANES))
            put_link(links, piece, cell, k, slot);
}

/* Arguments of the loop over chunks. */
struct making {
    struct cs_extra_springs *links;
    void (*find)(void *arg, struct cs_extra_springs_chunk *piece, uint32_t cell);
    void *arg;
};

/* Builds one chunk. Blocks follow one another, so slots of a block are contiguous in it. */
static void make_piece(void *arg, uint32_t number) {
    const struct making *making = arg;
    struct cs_extra_springs *links = making->links;
    struct cs_extra_springs_chunk *piece = links->chunks + number;
    piece->slots_used = 0;
    piece->failed = false;
    const uint32_t begin = number * CS_EXTRA_SPRINGS_CHUNK,
                   end = begin + CS_EXTRA_SPRINGS_CHUNK;
    for (uint32_t b = begin; b < end && b < links->n_blocks; b++) {
        links->begins[b] = piece->slots_used;
        for (uint32_t l = 0; l < LANES; l++) {
            piece->n_list = 0;
            making->find(making->arg, piece, LANES * b + l);
            put_list(links, piece, LANES * b + l, links->begins[b]);
        }
        links->ends[b] = piece->slots_used;
    }
}

/* After failure is_nonempty is false, and the kernels skip the lists. */
bool cs_extra_springs_make(struct cs_extra_springs *links,
                           void (*find)(void *arg, struct cs_extra_springs_chunk *piece,
                                        uint32_t cell),
                           void *arg) {
    struct making making = {links, find, arg};
    bool failed = false;
    links->is_nonempty = false;
    cs_pool_run(links->n_pieces, make_piece, &making);
    for (uint32_t p = 0; p < links->n_pieces; p++) {
        failed = failed || links->chunks[p].failed;
        links->is_nonempty = links->is_nonempty || links->chunks[p].slots_used;
    }
    links->is_nonempty = links->is_nonempty && !failed;
    return !failed;
}
