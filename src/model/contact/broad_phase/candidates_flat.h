/* candidates_flat.h - the grids that feel themselves, block by block: where one is flat with
 * those round it, pairs of what is there need not be looked for.
 *
 * Such blocks are found with a list, and are its business until something has moved by more
 * than a margin of their own, against the rest of its body. Then they are looked at again, all
 * of them, which costs a small part of a list; where all are as flat as they must be, the list
 * goes on from there. */
#ifndef CS_BROAD_PHASE_CANDIDATES_FLAT_H
#define CS_BROAD_PHASE_CANDIDATES_FLAT_H

#include "model/contact/body_pair_params.h"
#include "model/contact/broad_phase/aabb_cluster_build.h"
#include "model/contact/pair_distance.h"

/* the margin as a share of the least range: small, so that blocks may be bent */
#define CS_CANDIDATES_FLAT_MARGIN 0.1

struct cs_candidates_flat {
    const struct cs_body_pair_table *body_pairs; /* borrowed */
    struct cs_flat_region **grids; /* (n_bodies) NULL: none, or it does not feel itself */
    size_t n_points;
    uint32_t n_blocks;
    struct cs_grid_rectangle
        *work_neighbourhood[2]; /* (n_blocks) of each kind of pairs: those blocks that are
                    passed over; of one that is not flat nothing */
    uint32_t n_flat_blocks;     /* blocks that are, each kind by itself */
    double *x_at_build;         /* (3,n_points) where they were measured */
    double margin_now;          /* m, that they are good for */
};

/* Fixed arrays from the arena. CS_ERR_MEMORY. */
enum cs_status cs_candidates_flat_init(struct cs_candidates_flat *flat,
                                       const struct cs_system *system,
                                       const struct cs_body_pair_table *meetings,
                                       struct cs_arena *arena, struct cs_error *error);

/* Finds the blocks that are flat at x (3, n_points), good for a margin. With all threads. */
void cs_candidates_flat_find(struct cs_candidates_flat *flat, const double *x, double margin);

/* Whether they are still at x, for a margin from there; where not, nothing is changed. */
bool cs_candidates_flat_renew(struct cs_candidates_flat *flat, const double *x, double margin);

#endif
