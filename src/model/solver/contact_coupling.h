/* contact_coupling.h - contact of a body with itself in its multigrid, as springs between
 * cells.
 *
 * Over points x_i with weights w_i, whose sum is 0, and a block C a pair has the energy
 *
 *   C (sum w_i x_i)^2 / 2 = - sum over i < j of w_i w_j C (x_i - x_j)^2 / 2
 *
 * and so is springs between its points, of which some are below 0: those with weights of the
 * same sign, and those of pairs that take away (mesh_feature.h). But for a gradient that is
 * bent near a rim they are the pair. On the next level two cells have the sum of the springs
 * between their parts: Galerkin's product again, which is not halved as in
 * multigrid_hierarchy.h, since surfaces that lie on each other move against each other as
 * wholes.
 *
 * A pair with another body or an obstacle is not here. It has its diagonal blocks. */
#ifndef CS_CONTACT_COUPLING_H
#define CS_CONTACT_COUPLING_H

#include "model/solver/multigrid_hierarchy.h"
#include "model/solver/pair_vertices.h"

/* Gives the levels of a hierarchy what links need. CS_ERR_MEMORY. */
enum cs_status cs_coupling_init(struct cs_hierarchy *hierarchy, struct cs_arena *arena,
                                struct cs_error *error);

/* A matrix of pairs on its way into the first level. */
struct cs_coupling {
    struct cs_hierarchy *hierarchy;
    const struct cs_pairs *pairs;
    const struct cs_pair_vertices *pair_vertices; /* of these */
    const double *inv_mass;                       /* (n) of all particles */
    double scale;                                 /* of all blocks */
    double trace_min;        /* a pair has no links where its block's trace is less */
    double *internal_blocks; /* (6,n) the body's particles are set: what diagonal blocks have of
                      the pairs in links, less those of links to pinned particles */
};

/* Makes the links of the first level, and those of the next one. false: no memory. */
bool cs_coupling_load(struct cs_coupling *coupling);
bool cs_coupling_coarsen(const struct cs_level *fine, struct cs_level *coarse);

#endif
