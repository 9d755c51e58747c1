/* extra_springs.h - extra couplings of a multigrid level (contact between surfaces) that are
 * not in its grid or mesh; rebuilt for every matrix.
 *
 * They lie like the slots of a mesh's springs: 16 cells have a range of slots. A slot is one
 * spring for each of them, with the other ends beside it. A cell with fewer springs is its own
 * neighbour there, with the block 0. A spring is in the lists of both its ends.
 *
 * A spring may be negative if others make up for it, as in the energy of a contact pair
 * (contact_coupling.h). The diagonal D of the smoother contains only the positive ones. That is
 * enough: the bound of multigrid_hierarchy.h says that the positive springs' A is at most 2 D,
 * and a negative spring only makes A smaller. */
#ifndef CS_EXTRA_SPRINGS_H
#define CS_EXTRA_SPRINGS_H

#include "base/arena.h"

#include <stdint.h>

/* Cells per block; blocks per chunk, the unit of work of one thread. */
enum { CS_EXTRA_SPRINGS_LANES = 16, CS_EXTRA_SPRINGS_CHUNK = 64 };

/* A spring of the cell at work. Contributions with a positive and with a negative trace are
 * summed apart, so that their difference does not hide how large the positive part is. */
struct cs_extra_spring {
    float positive[6], negative[6];
};

/* The lists of CS_EXTRA_SPRINGS_CHUNK blocks of cells, built by one thread. It owns its arrays,
 * which grow and are kept for the next matrix. */
struct cs_extra_springs_chunk {
    struct cs_extra_spring *list; /* (n_list) of the cell at work */
    uint32_t *partners;           /* (n_list) their other ends */
    uint32_t *cells;              /* (n_slots, 16) other ends */
    float *springs;               /* (n_slots, 6, 16) */
    size_t list_capacity, partners_capacity, cells_capacity,
        springs_capacity; /* in numbers of the arrays */
    uint32_t n_list, slots_used;
    bool failed; /* out of memory: the lists are incomplete */
};

/* The extra springs of one level. */
struct cs_extra_springs {
    struct cs_extra_springs_chunk *chunks; /* (n_pieces) */
    uint32_t n_blocks, n_pieces;           /* blocks of 16 cells; chunks of blocks */
    uint32_t first; /* joint number of cell 0: other ends have joint numbers, so that they may
                       be cells of other bodies */
    uint32_t *begins, *ends; /* (n_blocks) slots of a block within its chunk */
    float *diagonal_share;   /* (6, n_cells) their part of the smoother's D */
    bool is_nonempty;        /* there is a slot; false after failure */
};

/* Makes empty lists for n_cells cells, a multiple of 16, with joint numbers from `first` on.
 * The arena owns them, and frees what grows. Returns CS_ERR_MEMORY if out of memory. */
enum cs_status cs_extra_springs_init(struct cs_extra_springs *springs, uint32_t first,
                                     uint32_t n_cells, struct cs_arena *arena,
                                     struct cs_error *error);

/* Replaces all lists. find adds the springs of one cell by cs_extra_springs_add; several
 * threads call it for different cells. Returns false if out of memory; there are no extra
 * springs then. */
bool cs_extra_springs_make(struct cs_extra_springs *springs,
                           void (*find)(void *arg, struct cs_extra_springs_chunk *chunk,
                                        uint32_t cell),
                           void *arg);

/* For find: adds a spring to cell `to` with the block times a factor, on top of those that the
 * list already has to that cell. The sign of the trace decides with which of them the block is
 * summed. */
void cs_extra_springs_add(struct cs_extra_springs_chunk *chunk, uint32_t to,
                          const float block[6], float factor);

/* The slots of block b; n is 0 if it has none. */
struct cs_extra_springs_slots {
    const uint32_t *cells;
    const float *springs;
    uint32_t n;
};
static inline struct cs_extra_springs_slots
cs_extra_springs_of(const struct cs_extra_springs *springs, size_t b) {
    const struct cs_extra_springs_chunk *chunk = springs->chunks + b / CS_EXTRA_SPRINGS_CHUNK;
    const size_t begin = springs->begins[b];
    const uint32_t n = springs->ends[b] - springs->begins[b];
    if (!n) // a chunk without slots may have no arrays
        return (struct cs_extra_springs_slots){0};
    return (struct cs_extra_springs_slots){chunk->cells + CS_EXTRA_SPRINGS_LANES * begin,
                                           chunk->springs + 6 * CS_EXTRA_SPRINGS_LANES * begin,
                                           n};
}

#endif
