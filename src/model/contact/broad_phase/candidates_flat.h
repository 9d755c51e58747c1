/* candidates_flat.h - flat blocks of the grids with self-contact. Pairs within a flat block and
 * its neighbours are skipped by the search.
 *
 * Flat blocks are found with a candidate list. They are valid until a body has deformed by more
 * than a margin of their own, measured against its mean motion. Then all blocks are measured
 * again, at a small part of the cost of a list; if every flat block is still flat enough, the
 * list stays in use. */
#ifndef CS_BROAD_PHASE_CANDIDATES_FLAT_H
#define CS_BROAD_PHASE_CANDIDATES_FLAT_H

#include "model/contact/body_pair_params.h"
#include "model/contact/broad_phase/aabb_cluster_build.h"
#include "model/contact/pair_distance.h"

/* Margin in units of the smallest range. It is small so that blocks may be bent more: a flat
 * block needs a distance of range + 2 margins. Chosen by trial. */
#define CS_CANDIDATES_FLAT_MARGIN 0.1

/* Flat blocks of all grids. */
struct cs_candidates_flat {
    const struct cs_body_pair_table *body_pairs; /* borrowed */
    /* (n_bodies) NULL: not a grid, or without self-contact */
    struct cs_flat_region **grids;
    size_t n_points;
    uint32_t n_blocks;
    struct cs_grid_rectangle
        *work_neighbourhood[2]; /* (n_blocks) of each kind of pairs: those blocks that are
                    passed over; of one that is not flat nothing */
    uint32_t n_flat_blocks;     /* blocks that are, each kind by itself */
    /* (3,n_points) positions in m where they were measured */
    double *x_at_build;
    /* m, margin that they are valid for */
    double margin_now;
};

/* Allocates fixed arrays in the arena, which owns them. CS_ERR_MEMORY. */
enum cs_status cs_candidates_flat_init(struct cs_candidates_flat *flat,
                                       const struct cs_system *system,
                                       const struct cs_body_pair_table *meetings,
                                       struct cs_arena *arena, struct cs_error *error);

/* Finds the flat blocks at x (3, n_points), valid for a margin in m. With all threads. */
void cs_candidates_flat_find(struct cs_candidates_flat *flat, const double *x, double margin);

/* Returns whether all flat blocks are flat at x too, and then restarts their margin there.
 * Otherwise nothing changes. */
bool cs_candidates_flat_renew(struct cs_candidates_flat *flat, const double *x, double margin);

#endif
