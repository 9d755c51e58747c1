/* multigrid.h - the preconditioner of stiff steps: aggregation multigrid in single precision,
 * one V-cycle per application, body by body, or for all bodies together that touch each other.
 *
 * The cycle is symmetric and positive definite for any coarse levels. Let S be the smoother's
 * linear map from residual to correction and C >= 0 that of the coarse levels. Smoothing before
 * and after the coarse correction gives
 *
 *   x1 = S r,   x2 = x1 + C (r - A x1),   x = x2 + S (r - A x2)
 *   x = (2 S - S A S + (I - S A) C (I - A S)) r
 *
 * S A has its eigenvalues in (0, 2), see multigrid_hierarchy.h, so 2 S - S A S = S (2 S^-1 - A)
 * S is positive definite. The last term is symmetric and not negative.
 *
 * Aggregates and their halved springs: multigrid_hierarchy.h. Contact of a body with itself and
 * with other bodies: contact_coupling.h. Contact with colliders is in the diagonal blocks
 * alone.
 *
 * Gain: on a sheet of 64 x 64 particles and for a residual of 1e-3, conjugate gradients take 4
 * to 5 iterations instead of 100 to 240 with blocks. W-cycles gained nothing in a prototype. */
#ifndef CS_MULTIGRID_H
#define CS_MULTIGRID_H

#include "model/solver/contact_coupling.h"
#include "model/solver/multigrid_hierarchy.h"
#include "model/system/particle_system.h"

/* Multigrid preconditions stiff steps if one body has more particles than the first number. On
 * smaller sheets coarse levels do not pay: block Jacobi took about as long (measured with
 * square sheets). It has levels in reserve, for solves in which blocks are slow, above the
 * second. */
enum { CS_MULTIGRID_PARTICLES = 24 * 24, CS_MULTIGRID_RESERVE_PARTICLES = 8 * 8 };

/* The levels of all bodies. The arena of init owns the arrays. */
struct cs_multigrid {
    const struct cs_system *system;   /* borrowed */
    struct cs_hierarchy *hierarchies; /* (n) one per body; NULL: no body is large enough */
    uint32_t n;
    /* (n_levels, n) level k of body b, if bodies touch each other: these have equally many
     * levels with joint vectors, and are smoothed together. NULL: each body is alone. */
    struct cs_level **joint_levels;
    struct cs_coarsest coarsest; /* of these */
    double *internal_blocks; /* (6, particles) diagonal blocks of the pairs that extra springs
                                represent (contact_coupling.h); NULL: no such contact */
    struct cs_pair_vertices pair_vertices; /* those pairs, indexed by particle */
    double scale;                          /* divides the matrix, to fit single precision */
};

/* Makes the levels' structure from the bodies' springs; numbers follow in setup. Returns
 * CS_ERR_MEMORY if out of memory. */
enum cs_status cs_multigrid_init(struct cs_multigrid *multigrid, const struct cs_system *system,
                                 struct cs_arena *arena, struct cs_error *error);

/* Tells whether a body is large enough for stiff steps, or to have levels in reserve. If none
 * is large enough for that, init allocates nothing and n stays 0. */
bool cs_multigrid_is_used(const struct cs_scene *scene);
bool cs_multigrid_is_in_reserve(const struct cs_scene *scene);

/* The matrix to approximate: the springs' factors, and a mass and a block per particle. */
struct cs_multigrid_matrix {
    const double *factors, *x;    /* as cs_springs_factor makes them at x (3,n), then of the
                                     membranes' edges (membrane_forces.h) */
    const double *mass;           /* (n) a number times the identity */
    const double *blocks;         /* (6,n) positive semi-definite; NULL: 0 */
    const double *as_springs;     /* (6,n) parts of `blocks` that springs among the factors
                                     stand for; NULL: none */
    const struct cs_pairs *pairs; /* their diagonal blocks are in `blocks`; NULL: none */
    double trace_min;             /* smallest trace of an extra spring's block */
    double scale;                 /* about the largest entry of the matrix */
};

/* Computes the numbers of all levels. Returns false if out of memory for contact pairs: the
 * levels then miss some extra springs, but may still be applied. */
bool cs_multigrid_setup(struct cs_multigrid *multigrid,
                        const struct cs_multigrid_matrix *matrix);

/* z = one V-cycle for r. size is about |r|, by which r is scaled to fit single precision. z
 * (3,n) is 0 on pinned particles. */
void cs_multigrid_apply(struct cs_multigrid *multigrid, const double *r, double size,
                        double *z);

#endif
