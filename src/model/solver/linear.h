/* linear.h - the one linear solver: A u = b with A = cm M + cd df/dv + ck df/dx of the forces
 * of CS_PART_LINEARISED, by conjugate gradients without assembling A.
 *
 * The preconditioner is multigrid (multigrid.h) where both hold, and else the inverses of the
 * 3x3 blocks of A's diagonal:
 *   - a body of the scene has more than 24 x 24 particles;
 *   - the matrix is stiff: -ck omega^2 - 2 cd delta > 16 cm, the largest ratio of stiffness to
 *     mass by the bounds of the view. Up to there blocks need some 10 iterations.
 * Both depend on the scene and on the step, never on time taken. After 500 iterations that did
 * not do, blocks take over until the next setup. */
#ifndef CS_LINEAR_H
#define CS_LINEAR_H

#include "model/solver/multigrid.h"
#include "model/system/system.h"

enum { CS_LINEAR_STIFF = 16, CS_LINEAR_STALL_ITERATIONS = 500 };

struct cs_linear {
    const struct cs_system *system; /* borrowed */
    struct cs_matrix matrix;        /* of the last setup; its arrays are the caller's */
    double *factors;                /* 4 doubles a spring */
    double *mass;                   /* (n) diagonal part: cm m and the forces' shares */
    double *blocks;        /* (6,n) the forces' shares that are blocks; NULL: there are none */
    double *inverse;       /* (6,n) inverses of the diagonal blocks */
    double *r, *z, *p, *q; /* (3,n) each */
    struct cs_multigrid multigrid;
    bool stiff; /* multigrid is in use */
};

/* Takes the arrays from arena. CS_ERR_MEMORY. */
enum cs_status cs_linear_init(struct cs_linear *linear, const struct cs_system *system,
                              struct cs_arena *arena, struct cs_error *error);

/* Prepares A. cm > 0, cd <= 0, ck <= 0. false: a diagonal block is not positive definite (only
 * without psd). */
bool cs_linear_setup(struct cs_linear *linear, const struct cs_matrix *matrix);

/* y = A p for p that is 0 on pinned particles; y is 0 there too. */
void cs_linear_mul(const struct cs_linear *linear, const double *p, double *y);

/* z = what stands for the inverse of A, times r; symmetric and positive. norm: of r. */
void cs_linear_precondition(struct cs_linear *linear, const double *r, double norm, double *z);

enum cs_linear_end { CS_LINEAR_DONE, CS_LINEAR_INDEFINITE, CS_LINEAR_LIMIT };

/* Solves A u = b to |b - A u| <= rtol |b|, from the start in u; rows of pinned particles are 0.
 * At most 10 n + 100 iterations. *iterations and *residual (relative) say how it went. */
enum cs_linear_end cs_linear_solve(struct cs_linear *linear, const double *b, double rtol,
                                   double *u, uint64_t *iterations, double *residual);

#endif
