/* multigrid_level.h - one level of the multigrid: cells with masses, joined by springs with 3x3
 * blocks.
 *
 * A level is a matrix of the same form as the solver's, in single precision:
 *   (A p)_i = own_i p_i + sum over the springs of cell i of B (p_i - p_j),  B symmetric, >= 0
 * where own_i is the cell's mass and whatever ties it to pinned particles. The differences
 * matter: moving all cells alike costs their mass and nothing else, whatever the rounding of
 * stiff blocks. A cell without mass is dead: a pinned particle, or the padding around a grid.
 *
 * The smoother is Chebyshev's iteration of degree 3 on the diagonal blocks D, for eigenvalues
 * of D^-1 A in [1/3, 2]. That none is above 2 is a theorem: a spring's part of A is
 * ((B, -B), (-B, B)) and its part of 2 D is ((2 B, 0), (0, 2 B)); their difference
 * ((B, B), (B, B)) is not negative. Sum over the springs, and add own <= 2 own. A larger D
 * only makes eigenvalues smaller.
 *
 * Each cell is written by one block of a loop, from values of before the loop: threads change
 * no bit.
 */
#ifndef CS_MULTIGRID_LEVEL_H
#define CS_MULTIGRID_LEVEL_H

#include "base/arena.h"

#include <stdbool.h>
#include <stdint.h>

struct cs_extra_springs;

enum { CS_LEVEL_STEPS = 6 };

enum cs_level_form {
    CS_LEVEL_FACTORED,        /* a grid, 4 numbers a spring: s and w of B = s I + w w^T */
    CS_LEVEL_FACTORED_BLOCKS, /* the same with 3x3 blocks in own: of forces at single particles
                               */
    CS_LEVEL_GRID_BLOCKS,     /* a grid, 6 numbers a spring */
    CS_LEVEL_MESH             /* a mesh, 6 numbers for either end of a spring */
};

struct cs_level {
    enum cs_level_form form;
    uint32_t n;          /* length of the arrays, a multiple of 16 */
    uint32_t begin, end; /* where cells are, multiples of 16; all around is dead */

    /* a grid: cell (i, j) is begin + i pitch + j. Spring (s, i) joins the cells i and
     * i + steps[s], and its numbers are in row c of springs (n_steps, 4 or 6, n) */
    uint32_t columns, rows, pitch;
    uint32_t n_neighbour_offsets, neighbour_offsets[CS_LEVEL_STEPS];

    /* a mesh: blocks (n_springs, 6) one by one, and for the kernels in slots: cells 16 b to
     * 16 b + 15 have slots starts[b] to starts[b + 1] of springs (n_slots, 6, 16), neighbours
     * and numbers (n_slots, 16). Where a cell has fewer springs it is its own neighbour, and
     * the number is CS_GRAPH_NONE */
    uint32_t *starts, *neighbours, *spring_ids;
    uint32_t n_springs, *ends;
    float *blocks;
    uint32_t *coarse_springs; /* (n_springs) springs of the next level, or CS_GRAPH_NONE */

    /* a mesh, or a body that meets itself */
    uint32_t *parents; /* (n) cells of the next level; CS_GRAPH_NONE: padding */

    /* a body that meets itself: more springs, else NULL; cell i of the next level has been
     * made of children[child_starts[i]..child_starts[i + 1]) */
    struct cs_extra_springs *extra_springs;
    uint32_t *children, *children_begin;

    float *springs;
    float *diagonal; /* FACTORED: (n) masses; else (6,n): xx, xy, xz, yy, yz, zz */
    float *inverse;  /* (6,n) of the blocks of D; 0 of dead cells */
    float *residual, *solution, *correction,
        *correction_next; /* (3,n): residual, solution, last move and the next */
};

/* Takes the numbers of a level whose form and n are set, n_numbers of springs.
 * CS_ERR_MEMORY. */
enum cs_status cs_level_alloc(struct cs_level *level, size_t n_numbers, struct cs_arena *arena,
                              struct cs_error *error);

/* A grid's springs have 4 numbers, not 6. */
static inline bool cs_level_is_factored(const struct cs_level *level) {
    return level->form == CS_LEVEL_FACTORED || level->form == CS_LEVEL_FACTORED_BLOCKS;
}

static inline bool cs_level_is_alive(const struct cs_level *level, size_t i) {
    return level->diagonal[i] > 0;
}

/* Makes the inverses from springs and own. Each block of D gets 2^-20 of its trace on top: the
 * rounding of A d leaves up to 2^-24 of the stiffness along a flat sheet as a residual across
 * it, where there is only mass, and the smoother must not take that for one. */
void cs_level_invert(struct cs_level *level);

/* x = the smoother's answer to r from the start 0; then r -= A x. */
void cs_level_smooth_down(struct cs_level *level);

/* After x += d, the answer of the next level: r -= A d, and x += the smoother's answer to what
 * is left. r is used up. */
void cs_level_smooth_up(struct cs_level *level);

/* x = D^-1 r: all of the answer on a level without springs. */
void cs_level_solve_diagonal(struct cs_level *level);

/* r -= A d, for d that is 0 in dead cells. */
void cs_level_subtract_product(struct cs_level *level);

#endif
