/* multigrid_hierarchy.h - the levels of one body: their structure is made once, their numbers
 * for every matrix.
 *
 * A grid is coarsened by 2 x 2 cells. A mesh is coarsened by joining cells in pairs, twice, as
 * in double pairwise aggregation (Notay 2010), along the heaviest springs
 * (multigrid_hierarchy.h). Pinned particles do not influence the aggregates, because events may
 * pin and release them: they are dead cells. A spring from a living to a dead cell (a Dirichlet
 * spring) adds its block to the diagonal of the living cell's aggregate.
 *
 * With P the prolongation, constant on each aggregate, Galerkin's product P^T A P is again a
 * matrix of masses and springs. A coarse cell has the sum of its cells' masses; two coarse
 * cells are joined by the sum of the springs between them; springs inside an aggregate vanish.
 *
 * That matrix is too stiff, because a smooth displacement becomes steps. Let it have the
 * difference g per cell, in one dimension. Per aggregate of two cells, the fine level has two
 * springs of the length change g, the coarse level one of 2 g:
 *
 *   fine    2 * k g^2 / 2   = k g^2
 *   coarse  k (2 g)^2 / 2   = 2 k g^2
 *
 * The same holds for 2 x 2 cells and both diagonals. The coarse correction is therefore about
 * half of the right one (Braess 1995, who scales the correction). Here the springs are
 * multiplied by CS_HIERARCHY_SOFTNESS = 1/2 and the masses are not, which leaves rigid motions
 * right: a translation meets mass alone. Dirichlet springs are halved likewise. Springs over
 * two cells (bending) would need the factor 1 on the first level; half of it only makes that
 * level too soft, which costs iterations and no accuracy. */
#ifndef CS_MULTIGRID_HIERARCHY_H
#define CS_MULTIGRID_HIERARCHY_H

#include "base/arena.h"
#include "model/solver/multigrid_level.h"
#include "model/spring/springs.h"

#include <math.h>
#include <stdint.h>

/* Enough for 2^32 cells: each level has at most half the cells, rounded up per axis of a grid,
 * which makes 33 levels at most. */
enum { CS_HIERARCHY_LEVELS_MAX = 34 };

/* Factor of springs from level to level; derivation above. */
#define CS_HIERARCHY_SOFTNESS 0.5F

/* The levels of one body, from the particles (levels[0]) to cells without springs. The arena of
 * cs_hierarchy_of_grid or cs_hierarchy_of_mesh owns the levels' arrays. */
struct cs_hierarchy {
    uint32_t first, count;            /* the body's particles [first, first + count) */
    uint32_t columns;                 /* particles per row; rows begin `pitch` cells apart */
    const struct cs_spring_run *runs; /* (n_runs) the body's, borrowed */
    uint32_t n_runs;
    bool has_particle_blocks; /* the matrix has 3x3 blocks at particles, not only numbers */
    bool has_body_contact;    /* contact acts between parts of the body, or with other bodies */
    const struct cs_hierarchy_kind *kind;
    uint32_t n_levels;
    struct cs_level levels[CS_HIERARCHY_LEVELS_MAX];
};

/* Operations that differ between grids and meshes. */
struct cs_hierarchy_kind {
    /* sets the first level's springs from the solver's factors (4 doubles per spring), over
     * scale */
    void (*load)(struct cs_hierarchy *hierarchy, const double *factors, double scale);
    /* sets the springs and the diagonal of the next level: P^T A P with halved springs */
    void (*coarsen)(const struct cs_level *fine, struct cs_level *coarse);
    /* residual of the next level: P^T r, sums over the living cells of each aggregate */
    void (*restrict_r)(const struct cs_level *fine, struct cs_level *coarse);
    /* correction of the living cells: P times the coarse solution; added to the solution */
    void (*prolong_x)(const struct cs_level *coarse, struct cs_level *fine);
    /* adds a level after the last one, which has no springs: bodies in contact have equally
     * many levels */
    void (*extend)(struct cs_hierarchy *hierarchy, struct cs_arena *arena,
                   struct cs_error *error);
};

/* Make the structure of all levels, without vectors (cs_level_alloc_vectors). The members above
 * `kind` are set by the caller. Return CS_ERR_MEMORY if out of memory. */
enum cs_status cs_hierarchy_of_grid(struct cs_hierarchy *hierarchy, struct cs_arena *arena,
                                    struct cs_error *error);
enum cs_status cs_hierarchy_of_mesh(struct cs_hierarchy *hierarchy, struct cs_arena *arena,
                                    struct cs_error *error);

/* Gives n bodies as many levels as the one that has most. */
void cs_hierarchies_make_equally_deep(struct cs_hierarchy *bodies, uint32_t n,
                                      struct cs_arena *arena, struct cs_error *error);

/* Reads s and w of one spring from the solver's factors, whose rows have `count` numbers.
 * Divides its block B = s I + w w^T by the scale; root is 1 / sqrt(scale).
 *
 * s < 0 means a compressed spring in an exact matrix. Its transverse part is dropped, and its
 * axial stiffness s + |w|^2 is preserved if that is positive:
 *
 *   s' = 0,   w' = w sqrt(max(0, 1 + s / |w|^2))
 *
 * The preconditioner is thereby positive definite even if the matrix is not. */
static inline void cs_hierarchy_spring(const double *factors, size_t count, double root,
                                       float spring[4]) {
    const double s = factors[0];
    if (s < 0) {
        const double x = factors[count], y = factors[2 * count], z = factors[3 * count];
        root *= sqrt(fmax(0, 1 + s / (x * x + y * y + z * z)));
    }
    spring[0] = (float)(s < 0 ? 0 : s * root * root);
    for (size_t c = 1; c < 4; c++)
        spring[c] = (float)(root * factors[c * count]);
}

/* B = s I + w w^T as xx, xy, xz, yy, yz, zz. */
static inline void cs_hierarchy_block(const float spring[4], float block[6]) {
    const float s = spring[0], x = spring[1], y = spring[2], z = spring[3];
    block[0] = s + x * x;
    block[1] = x * y;
    block[2] = x * z;
    block[3] = s + y * y;
    block[4] = y * z;
    block[5] = s + z * z;
}

/* Matches the nodes of a weighted graph in pairs, for the coarse levels of a
 * mesh.
 *
 * Heavy-edge matching (Karypis, Kumar 1998) visits the nodes and joins each free one with the
 * free neighbour across its heaviest edge. Here the order of visits is that of the nodes'
 * numbers and not random, so that the result is the same in every run. */

#define CS_GRAPH_NONE UINT32_MAX

/* An undirected graph; two nodes may share several edges. The arena that made it owns the
 * arrays. */
struct cs_graph {
    uint32_t n, n_edges;
    uint32_t *ends;  /* (n_edges, 2), two different nodes */
    double *weights; /* (n_edges) */
};

/* Makes a graph with about half the nodes. Node by node, each free one is joined with the free
 * neighbour to which its edges weigh most in total, the lowest-numbered of equals. A node whose
 * neighbours are all joined follows the heaviest of them. Every node with an edge is therefore
 * joined with another one; a node without edges stays alone.
 *
 * parents (n) are the new nodes of the old ones. targets (n_edges) are the new edges,
 * CS_GRAPH_NONE between two joined nodes; parallel edges become one with the sum of their
 * weights. Memory comes from work. Returns CS_ERR_MEMORY if out of memory; *coarse must not be
 * used then. */
enum cs_status cs_graph_match(const struct cs_graph *fine, struct cs_graph *coarse,
                              uint32_t *parents, uint32_t *targets, struct cs_arena *work,
                              struct cs_error *error);

#endif
