/* extra_springs.h - springs between cells of one level that neither its grid nor its mesh has:
 * lists that are made anew for every matrix.
 *
 * They lie as the slots of a mesh's springs do: 16 cells have a range of slots, each of which
 * is one spring for each of them, whose other ends stand beside it. Where a cell has fewer it
 * is its own neighbour, and the spring is 0. A spring is in the lists of both its ends. It may
 * be below 0, where others make up for it: the diagonal has those above 0 alone, since the
 * bound of multigrid_level.h holds with or without springs below. */
#ifndef CS_EXTRA_SPRINGS_H
#define CS_EXTRA_SPRINGS_H

#include "base/arena.h"

#include <stdbool.h>
#include <stdint.h>

/* cells of a block, and blocks of a piece */
enum { CS_EXTRA_SPRINGS_LANES = 16, CS_EXTRA_SPRINGS_CHUNK = 64 };

/* A spring of the cell at work: what is above 0 of its block, and what is below. */
struct cs_extra_spring {
    uint32_t cell;
    float positive[6], negative[6];
};

/* The lists of some cells: one thread's. */
struct cs_extra_springs_chunk {
    struct cs_extra_spring *list; /* (n_list) of the cell at work */
    uint32_t *cells;              /* (n_slots, 16) other ends */
    float *springs;               /* (n_slots, 6, 16) */
    size_t list_capacity, cells_capacity, springs_capacity;
    uint32_t n_list, slots_used;
    bool failed; /* there was no memory */
};

struct cs_extra_springs {
    struct cs_extra_springs_chunk *chunks; /* (n_pieces) */
    uint32_t n_blocks, n_pieces;           /* of 16 cells; of blocks */
    uint32_t *begins, *ends;               /* (n_blocks) slots of a block in its piece */
    float *diagonal_share;                 /* (6, n_cells) shares in the diagonal */
    bool is_nonempty;                      /* there is a slot */
};

/* For so many cells, a multiple of 16; the arena owns what grows too. CS_ERR_MEMORY. */
enum cs_status cs_extra_springs_init(struct cs_extra_springs *links, uint32_t n_cells,
                                     struct cs_arena *arena, struct cs_error *error);

/* Makes all lists: find adds the springs of a cell, by several threads at the same time for
 * different cells. false: there was no memory, and there is no spring. */
bool cs_extra_springs_make(struct cs_extra_springs *links,
                           void (*find)(void *arg, struct cs_extra_springs_chunk *piece,
                                        uint32_t cell),
                           void *arg);

/* For find: a spring to a cell, its block times a factor, on top of what there is already. */
void cs_extra_springs_add(struct cs_extra_springs_chunk *piece, uint32_t to,
                          const float block[6], float factor);

/* The slots of block b. */
struct cs_extra_springs_slots {
    const uint32_t *cells;
    const float *springs;
    uint32_t n;
};
static inline struct cs_extra_springs_slots
cs_extra_springs_of(const struct cs_extra_springs *links, size_t b) {
    const struct cs_extra_springs_chunk *piece = links->chunks + b / CS_EXTRA_SPRINGS_CHUNK;
    const size_t begin = links->begins[b];
    const uint32_t n = links->ends[b] - links->begins[b];
    if (!n) // a piece without slots may have no memory
        return (struct cs_extra_springs_slots){0};
    return (struct cs_extra_springs_slots){piece->cells + CS_EXTRA_SPRINGS_LANES * begin,
                                           piece->springs + 6 * CS_EXTRA_SPRINGS_LANES * begin,
                                           n};
}

#endif
