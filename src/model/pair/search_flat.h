/* search_flat.h - the grids that feel themselves, block by block: where one is flat with those
 * round it, pairs of what is there need not be looked for.
 *
 * Such blocks are found with a list, and are its business until something has moved by more
 * than a margin of their own, against the rest of its body. Then they are looked at again, all
 * of them, which costs a small part of a list; where all are as flat as they must be, the list
 * goes on from there. */
#ifndef CS_PAIR_SEARCH_FLAT_H
#define CS_PAIR_SEARCH_FLAT_H

#include "model/near/order.h"
#include "model/pair/meeting.h"
#include "model/pair/stencil.h"

/* the margin as a share of the least range: small, so that blocks may be bent */
#define CS_SEARCH_FLAT_MARGIN 0.1

struct cs_search_flat {
    const struct cs_meetings *meetings; /* borrowed */
    struct cs_flat **grids;             /* (n_bodies) NULL: none, or it does not feel itself */
    size_t n_points;
    uint32_t n_blocks;
    struct cs_cluster_span *round[2]; /* (n_blocks) of each kind of pairs: those blocks that are
                                         passed over; of one that is not flat nothing */
    uint32_t n_flat;                  /* blocks that are, each kind by itself */
    double *from;                     /* (3,n_points) where they were measured */
    double held;                      /* m, that they are good for */
};

/* Fixed arrays from the arena. CS_ERR_MEMORY. */
enum cs_status cs_search_flat_init(struct cs_search_flat *flat, const struct cs_system *system,
                                   const struct cs_meetings *meetings, struct cs_arena *arena,
                                   struct cs_error *error);

/* Finds the blocks that are flat at x (3, n_points), good for a margin. With all threads. */
void cs_search_flat_find(struct cs_search_flat *flat, const double *x, double margin);

/* Whether they are still at x, for a margin from there; where not, nothing is changed. */
bool cs_search_flat_renew(struct cs_search_flat *flat, const double *x, double margin);

#endif
