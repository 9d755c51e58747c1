/* multigrid_level.h - one level of the multigrid: cells with masses, joined by springs with 3x3
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
#ifndef CS_MULTIGRID_LEVEL_H
#define CS_MULTIGRID_LEVEL_H

#include "base/arena.h"

#include <stdbool.h>
#include <stdint.h>

struct cs_extra_springs;

/* Forward neighbours of a grid's cell at most: those of enum cs_spring_direction. */
enum { CS_LEVEL_STEPS = 6 };

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

#endif
