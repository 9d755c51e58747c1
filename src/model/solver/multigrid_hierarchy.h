/* multigrid_hierarchy.h - the levels of one body: their structure is made once, their numbers
 * for every matrix.
 *
 * A grid is coarsened by 2 x 2 cells. A mesh is coarsened by joining cells in pairs, twice, as
 * in double pairwise aggregation (Notay 2010), along the heaviest springs
 * (below). Pinned particles do not influence the aggregates, because events may
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
#include "model/spring/springs.h"

#include <clothsim/clones.h>
#include <float.h>
#include <math.h>

/* One level of the multigrid: cells with masses, joined by springs with 3x3
 * blocks.
 *
 * A level is a matrix of the same form as the solver's, in single precision:
 *
 *   (A p)_i = D0_i p_i + sum over the springs of cell i of B (p_i - p_j),  B symmetric, >= 0
 *
 * where D0_i is the cell's mass and its springs to pinned particles (`diagonal`). Products use
 * the differences: a translation of all cells then costs exactly its mass, whatever the
 * rounding of stiff blocks. A cell without mass is dead: a pinned particle, or the padding
 * around a grid. Dead cells have the inverse 0, so the smoother never moves them.
 *
 * The smoother is Chebyshev's iteration of degree 3 on the diagonal blocks D of A, for
 * eigenvalues of D^-1 A in [1/3, 2]. That none exceeds 2 is a theorem: a spring's part of A is
 * ((B, -B), (-B, B)) and its part of 2 D is ((2 B, 0), (0, 2 B)); their difference ((B, B), (B,
 * B)) is positive semi-definite. Sum over the springs, and add D0 <= 2 D0. A larger D only
 * makes eigenvalues smaller. No eigenvalue has to be estimated.
 *
 * The smoother's error polynomial, by Chebyshev's T3(c) = 4 c^3 - 3 c, is
 *
 *   1 - l s(l) = T3((7/6 - l) / (5/6)) / T3(7/5)
 *
 * Its magnitude is at most 1 / T3(7/5) = 0.148 on [1/3, 2], and below 1 on (0, 2];
 * the eigenvalues l s(l) of S A are therefore in (0, 2), which multigrid.h needs. The degree
 * was tuned with a prototype on square sheets: degree 2 took 20 instead of 15 iterations in the
 * same total time.
 *
 * Each cell is written by one block of a loop, from values of before the loop: the number of
 * threads changes no bit. */

struct cs_extra_springs;

/* Forward neighbours of a grid's cell at most: those of enum cs_spring_direction. */
enum { CS_LEVEL_STEPS = 6 };

/* Arrays of cells are whole multiples of it, and slots have as many springs side by side. */
enum { CS_LANES = 16 };

/* Storage of a level's matrix. */
enum cs_level_form {
    CS_LEVEL_FACTORED,        /* a grid, 4 numbers per spring: s and w of B = s I + w w^T */
    CS_LEVEL_FACTORED_BLOCKS, /* the same, with 3x3 blocks of forces in the diagonal */
    CS_LEVEL_GRID_BLOCKS,     /* a grid, 6 numbers per spring: coarse levels */
    CS_LEVEL_MESH             /* a mesh, 6 numbers for either end of a spring */
};

/* A level's structure and numbers. The arena of the hierarchy owns the arrays. */
struct cs_level {
    enum cs_level_form form;
    uint32_t n;          /* length of the arrays, a multiple of 16 */
    uint32_t begin, end; /* cells are in [begin, end), multiples of 16; all others are dead */

    /* A grid. Cell (i, j) is begin + i pitch + j. Spring (s, i) joins the cells i and i +
     * neighbour_offsets[s]; its numbers are at i in the rows (s, c) of springs (n_offsets, 4 or
     * 6, n). */
    uint32_t columns, rows, pitch;
    uint32_t n_neighbour_offsets, neighbour_offsets[CS_LEVEL_STEPS];

    /* A mesh. Blocks (n_springs, 6) are the springs one by one. For the kernels they lie in
     * slots: cells 16 b to 16 b + 15 have the slots starts[b] to starts[b + 1] of springs
     * (n_slots, 6, 16), neighbours and spring_ids (n_slots, 16). An unused slot joins its cell
     * to itself and has the id CS_GRAPH_NONE. */
    uint32_t *starts, *neighbours, *spring_ids;
    uint32_t n_springs, *ends;
    float *blocks;
    uint32_t *coarse_springs; /* (n_springs) springs of the next level; CS_GRAPH_NONE: inside an
                                 aggregate */

    /* a mesh */
    uint32_t *parents; /* (n) cells of the next level; CS_GRAPH_NONE: padding */

    /* A body in contact with itself or others: more springs, else NULL. Cell i of the next
     * level is the aggregate of children[children_begin[i]..children_begin[i + 1]).
     * joint_parents (stride) are the joint numbers of the parents, of all cells of the joint
     * vectors. */
    struct cs_extra_springs *extra_springs;
    uint32_t *children, *children_begin, *joint_parents;

    /* Levels of bodies that touch each other have joint vectors: `stride` cells, of which this
     * level has those from `first` on. Extra springs name cells by their joint numbers. A level
     * for itself has first = 0 and stride = n. */
    uint32_t first, stride;

    float *springs;  /* layout: above */
    float *diagonal; /* D0. FACTORED: (n) masses; else (6,n): xx, xy, xz, yy, yz, zz */
    float *inverse;  /* (6,n) inverses of the blocks of D; 0 in dead cells */
    float *residual, *solution, *correction,
        *correction_next; /* (3,stride); corrections of the smoother's last move and of the next
                           */
};

/* The same level of several bodies: smoothed together if they touch each other. */
struct cs_level_group {
    struct cs_level *const *levels; /* (n) */
    uint32_t n;
};

/* Allocates the numbers of a level whose form and n are set, with n_numbers floats for springs.
 * Returns CS_ERR_MEMORY if out of memory. */
enum cs_status cs_level_alloc(struct cs_level *level, size_t n_numbers, struct cs_arena *arena,
                              struct cs_error *error);

/* Allocates joint vectors for the levels of a group. Returns CS_ERR_MEMORY if out of memory. */
enum cs_status cs_level_alloc_vectors(const struct cs_level_group *group,
                                      struct cs_arena *arena, struct cs_error *error);

/* Tells whether springs have 4 numbers (s, w), not 6. */
static inline bool cs_level_is_factored(const struct cs_level *level) {
    return level->form == CS_LEVEL_FACTORED || level->form == CS_LEVEL_FACTORED_BLOCKS;
}

/* Tells whether a cell has mass. The first entry of its diagonal, xx or the mass, is positive
 * then. */
static inline bool cs_level_is_alive(const struct cs_level *level, size_t i) {
    return level->diagonal[i] > 0;
}

/* Computes the inverses of D from springs and diagonal. Each block of D gets 2^-20 of its trace
 * on top. Reason: across a flat sheet a block has only its mass. The rounding of A d leaves up
 * to 2^-24 of the stiffness along the sheet as a residual across it, which the smoother would
 * otherwise take for a large error. A larger D is allowed, see above. */
void cs_level_invert(struct cs_level *level);

/* Tells whether extra springs may join the bodies of a group. */
bool cs_level_is_coupled(const struct cs_level_group *group);

/* Smooths from the start 0: solution = S r, and then residual -= A solution. */
void cs_level_smooth_down(const struct cs_level_group *group);

/* Smooths after solution += correction, the coarse correction d: residual -= A d, and then
 * solution += S residual. The residual is not valid afterwards. */
void cs_level_smooth_up(const struct cs_level_group *group);

/* solution = D^-1 residual, the exact solution of a level without springs. */
void cs_level_solve_diagonal(struct cs_level *level);

/* residual -= A correction, for a correction that is 0 in dead cells. */
void cs_level_subtract_product(struct cs_level *level);

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
    /* sets the first level's springs from the solver's factors at positions x (3,n), over
     * scale */
    void (*load)(struct cs_hierarchy *hierarchy, const double *factors, const double *x,
                 size_t n, double scale);
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
void cs_hierarchies_make_equally_deep(struct cs_hierarchy *hierarchies, uint32_t n,
                                      struct cs_arena *arena, struct cs_error *error);

/* Makes the numbers of a level's spring of s and w, the latter over the root of the scale:
 * root is 1 / sqrt(scale).
 *
 * s < 0 means a compressed spring in an exact matrix (`turned`: some springs may have it). Its
 * transverse part is dropped, and its axial stiffness s + |w|^2 is preserved if that is
 * positive:
 *
 *   s' = 0,   w' = w sqrt(max(0, 1 + s / |w|^2))
 *
 * The preconditioner is thereby positive definite even if the matrix is not. */
CS_INLINE void cs_hierarchy_spring(const double sw[4], double root, bool turned,
                                   float spring[4]) {
    const double s = sw[0] < 0 ? 0 : sw[0];
    if (turned) {
        // DBL_MIN changes nothing but 0 / 0, where s >= 0 too
        const double squared = sw[1] * sw[1] + sw[2] * sw[2] + sw[3] * sw[3] + DBL_MIN;
        const double left = 1 + (sw[0] < 0 ? sw[0] : 0) / squared;
        root *= sqrt(left > 0 ? left : 0);
    }
    spring[0] = (float)(s * root * root);
    for (size_t c = 1; c < 4; c++)
        spring[c] = (float)(root * sw[c]);
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
