/* multigrid.h - an approximate inverse of the solver's matrix: aggregation multigrid in single
 * precision, one V-cycle an application, body by body.
 *
 * It is symmetric and positive definite whatever the coarse levels do. With S the smoother (S A
 * has its eigenvalues in (0, 2), see multigrid_level.h, so that 2 S - S A S is positive) and C
 * >= 0 the answer of the coarse levels, a cycle is 2 S - S A S + (I - S A) C (I - A S).
 * Aggregates and their halved springs: multigrid_hierarchy.h; contact of a body with itself:
 * contact_coupling.h. */
#ifndef CS_MULTIGRID_H
#define CS_MULTIGRID_H

#include "model/solver/multigrid_hierarchy.h"
#include "model/solver/pair_vertices.h"
#include "model/system/system.h"

/* Scenes have levels where one body has more particles than this. */
enum { CS_MULTIGRID_PARTICLES = 24 * 24 };

struct cs_multigrid {
    const struct cs_system *system;   /* borrowed */
    struct cs_hierarchy *hierarchies; /* (n) one a body, or none */
    uint32_t n;
    double *internal_blocks; /* (6,n) blocks of pairs that are links (contact_coupling.h); NULL:
                      no body meets itself */
    struct cs_pair_vertices pair_vertices; /* of these pairs */
    double scale; /* what the matrix is divided by for single precision */
};

/* Makes the structure. CS_ERR_MEMORY. */
enum cs_status cs_multigrid_init(struct cs_multigrid *multigrid, const struct cs_system *system,
                                 struct cs_arena *arena, struct cs_error *error);

/* Whether a body is large enough for it; else init takes nothing, and there are no levels. */
bool cs_multigrid_is_used(const struct cs_scene *scene);

/* The matrix: springs' factors, and at each particle a mass and a block. */
struct cs_multigrid_matrix {
    const double *factors;        /* (4 doubles a spring) */
    const double *mass;           /* (n) */
    const double *blocks;         /* (6,n) positive semidefinite; NULL: 0 */
    const struct cs_pairs *pairs; /* whose diagonal blocks are in `blocks`; NULL: none */
    double trace_min; /* of the trace of a pair's block that is worth springs of its own */
    double scale;     /* about its largest number */
};

/* Makes the numbers. false: there was no memory for pairs. */
bool cs_multigrid_setup(struct cs_multigrid *multigrid,
                        const struct cs_multigrid_matrix *matrix);

/* z = one V-cycle for r. size is about that of r, so that its parts fit single precision. z is
 * 0 where particles are pinned. */
void cs_multigrid_apply(struct cs_multigrid *multigrid, const double *r, double size,
                        double *z);

#endif
