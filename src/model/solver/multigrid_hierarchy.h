/* multigrid_hierarchy.h - the levels of one body's multigrid: their structure is made once,
 * their numbers for every matrix.
 *
 * A grid is coarsened by 2 x 2 cells; a mesh by joining cells in pairs, twice
 * (graph_matching.h). Which particles are pinned does not matter for that, as events change it:
 * they are dead cells, and what ties a living cell to them becomes part of `own` of its
 * aggregate.
 *
 * On the next level a cell has the mass of its parts, and springs have the sum of those between
 * two aggregates, halved: Galerkin's product for piecewise constant functions, whose stiffness
 * is about twice too large because a smooth motion becomes steps (Braess 1995). Halving the
 * springs, and not doubling the whole correction, leaves rigid motions right. */
#ifndef CS_MULTIGRID_HIERARCHY_H
#define CS_MULTIGRID_HIERARCHY_H

#include "model/solver/multigrid_level.h"
#include "model/spring/springs.h"

#include <math.h>

enum { CS_HIERARCHY_LEVELS_MAX = 34 };

#define CS_HIERARCHY_SOFTNESS 0.5F

struct cs_hierarchy {
    uint32_t first, count;            /* particles */
    uint32_t columns;                 /* of particles a row; rows are cells apart, see pitch */
    const struct cs_spring_run *runs; /* (n_runs) the body's, borrowed */
    uint32_t n_runs;
    bool has_particle_blocks; /* the matrix has blocks at single particles, not numbers alone */
    bool has_self_contact;    /* the body meets itself */
    const struct cs_hierarchy_kind *kind;
    uint32_t n_levels;
    struct cs_level levels[CS_HIERARCHY_LEVELS_MAX];
};

/* What grids and meshes do in their own way. */
struct cs_hierarchy_kind {
    /* the first level's springs from the solver's factors (4 doubles a spring) over scale */
    void (*load)(struct cs_hierarchy *hierarchy, const double *factors, double scale);
    /* springs and own of the next level */
    void (*coarsen)(const struct cs_level *fine, struct cs_level *coarse);
    /* r of the next level: sums of the living cells' r */
    void (*restrict_r)(const struct cs_level *fine, struct cs_level *coarse);
    /* d of the living cells: x of their aggregates, and x += d */
    void (*prolong_x)(const struct cs_level *coarse, struct cs_level *fine);
};

/* Make the levels; first, count, columns, runs and forced are set. CS_ERR_MEMORY. */
enum cs_status cs_hierarchy_of_grid(struct cs_hierarchy *hierarchy, struct cs_arena *arena,
                                    struct cs_error *error);
enum cs_status cs_hierarchy_of_mesh(struct cs_hierarchy *hierarchy, struct cs_arena *arena,
                                    struct cs_error *error);

/* s and w of a spring from the solver's factors, whose rows have `count` numbers; root is
 * 1 / sqrt(scale). A spring with s < 0 loses its transverse part and keeps its stiffness along
 * itself: the preconditioner is positive definite even where the matrix is not. */
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

#endif
