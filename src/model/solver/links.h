/* links.h - springs between cells of one level that neither its grid nor its mesh has: lists
 * that are made anew for every matrix.
 *
 * They lie as the slots of a mesh's springs do: 16 cells have a range of slots, each of which
 * is one spring for each of them, whose other ends stand beside it. Where a cell has fewer it
 * is its own neighbour, and the spring is 0. A spring is in the lists of both its ends. It may
 * be below 0, where others make up for it: the diagonal has those above 0 alone, since the
 * bound of level.h holds with or without springs below. */
#ifndef CS_LINKS_H
#define CS_LINKS_H

#include "base/arena.h"

#include <stdbool.h>
#include <stdint.h>

/* cells of a block, and blocks of a piece */
enum { CS_LINKS_LANES = 16, CS_LINKS_PIECE = 64 };

/* A spring of the cell at work: what is above 0 of its block, and what is below. */
struct cs_link {
    uint32_t to;
    float more[6], less[6];
};

/* The lists of some cells: one thread's. */
struct cs_links_piece {
    struct cs_link *list; /* (n_list) of the cell at work */
    uint32_t *cells;      /* (n_slots, 16) other ends */
    float *springs;       /* (n_slots, 6, 16) */
    size_t list_room, cells_room, springs_room;
    uint32_t n_list, n_slots;
    bool failed; /* there was no memory */
};

struct cs_links {
    struct cs_links_piece *pieces; /* (n_pieces) */
    uint32_t n_blocks, n_pieces;   /* of 16 cells; of blocks */
    uint32_t *begins, *ends;       /* (n_blocks) slots of a block in its piece */
    float *held;                   /* (6, n_cells) shares in the diagonal */
    bool any;                      /* there is a slot */
};

/* For so many cells, a multiple of 16; the arena owns what grows too. CS_ERR_MEMORY. */
enum cs_status cs_links_init(struct cs_links *links, uint32_t n_cells, struct cs_arena *arena,
                             struct cs_error *error);

/* Makes all lists: find adds the springs of a cell, by several threads at the same time for
 * different cells. false: there was no memory, and there is no spring. */
bool cs_links_make(struct cs_links *links,
                   void (*find)(void *arg, struct cs_links_piece *piece, uint32_t cell),
                   void *arg);

/* For find: a spring to a cell, its block times a factor, on top of what there is already. */
void cs_links_add(struct cs_links_piece *piece, uint32_t to, const float block[6],
                  float factor);

/* The slots of block b. */
struct cs_links_slots {
    const uint32_t *cells;
    const float *springs;
    uint32_t n;
};
static inline struct cs_links_slots cs_links_of(const struct cs_links *links, size_t b) {
    const struct cs_links_piece *piece = links->pieces + b / CS_LINKS_PIECE;
    const size_t begin = links->begins[b];
    const uint32_t n = links->ends[b] - links->begins[b];
    if (!n) // a piece without slots may have no memory
        return (struct cs_links_slots){0};
    return (struct cs_links_slots){piece->cells + CS_LINKS_LANES * begin,
                                   piece->springs + 6 * CS_LINKS_LANES * begin, n};
}

#endif
