/* linear.h - the host's linear solver: A u = b by preconditioned conjugate gradients, where
 *
 *   A = cm M + cd df/dv + ck df/dx     of the forces of CS_PART_LINEARISED
 *
 * is never assembled. A is symmetric. With matrix->psd each force's part is positive
 * semi-definite, and cm M makes A positive definite. Without psd, A may be indefinite; the
 * solver then reports CS_LINEAR_INDEFINITE.
 *
 * The preconditioner is one V-cycle of multigrid (multigrid.h) where both conditions hold, and
 * else the inverses of the 3x3 blocks of A's diagonal (block Jacobi):
 *
 *   - A body of the scene has more than 24 x 24 particles.
 *   - The matrix is stiff: -ck omega^2 - 2 cd delta > 16 cm. The view's bounds omega and delta
 *     limit the eigenvalues of M^-1 df/dx and M^-1 df/dv, so the left side bounds stiffness
 *     over mass. Or contact between surfaces is: the trace of the pairs' diagonal block of a
 *     particle exceeds 16 cm m. Layers that move together meet little of that stiffness, which
 *     blocks do not know.
 *
 * At the limit of 16 the condition number of M^-1 A is at most 17. The bound of conjugate
 * gradients, a factor (sqrt(17) - 1) / (sqrt(17) + 1) = 0.61 per iteration (Saad 2003, section
 * 6.11), then needs 16 iterations for 1e-3. In practice blocks need some 10.
 *
 * The choice depends on the scene and the step, never on measured time, which keeps runs
 * reproducible. If 500 iterations with multigrid do not suffice, blocks replace it until the
 * next setup. If 25 iterations with blocks do not suffice, multigrid replaces them for the rest
 * of that solve, where a body has more than 8 x 8 particles: contact between layers needs some
 * 90 iterations with blocks, whatever the size of the bodies. A solve thus ends after at most
 * 25 iterations more than with multigrid alone, and one that blocks do well in costs nothing
 * more.
 */
#ifndef CS_LINEAR_H
#define CS_LINEAR_H

#include "model/solver/multigrid.h"
#include "model/system/particle_system.h"

/* Limits of the rules above: a ratio of stiffness to mass, and iterations with multigrid and
 * with blocks. */
enum { CS_LINEAR_STIFF = 16, CS_LINEAR_STALL_ITERATIONS = 500, CS_LINEAR_SLOW_ITERATIONS = 25 };

/* The solver's arrays and its last matrix. The arena of init owns the arrays. */
struct cs_linear {
    const struct cs_system *system; /* borrowed */
    struct cs_matrix matrix;        /* of the last setup; its arrays are the caller's */
    double *factors; /* of the springs' blocks s I + w w^T, and of the membranes' edges */
    double *mass;    /* (n) cm m and the scalar parts of the forces, times the identity */
    double *blocks;  /* (6,n) the forces' parts that are 3x3 blocks; NULL: there are none */
    double *inverse; /* (6,n) inverses of the diagonal blocks */
    /* (3,n) each: residual, preconditioned residual, search direction, and A p. z and q are
     * one array: what the preconditioner makes is in p before A p is taken. */
    double *r, *z, *p, *q;
    struct cs_multigrid multigrid;
    double stiffness;    /* bound of stiffness over mass, with the unit of cm */
    bool stiff;          /* multigrid is in use */
    bool levels_are_set; /* the levels have the numbers of the last setup's matrix */
    bool levels_failed;  /* multigrid gave up on that matrix */
};

/* Takes the arrays from arena. Returns CS_ERR_MEMORY if out of memory. */
enum cs_status cs_linear_init(struct cs_linear *linear, const struct cs_system *system,
                              struct cs_arena *arena, struct cs_error *error);

/* Prepares A at the state of matrix, whose arrays stay the caller's. cm > 0, cd <= 0, ck <= 0.
 * Returns false if a diagonal block is not positive definite, which happens only without psd. A
 * is then indefinite and must not be used. Other indefinite matrices show in cs_linear_solve.
 */
bool cs_linear_setup(struct cs_linear *linear, const struct cs_matrix *matrix);

/* y = A p for p that is 0 on pinned particles; y (3,n) is 0 there too. */
void cs_linear_mul(const struct cs_linear *linear, const double *p, double *y);

/* The same without the forces that have blocks: masses, scalar parts and springs alone. */
void cs_linear_mul_scalar(const struct cs_linear *linear, const double *p, double *y);

/* z = B^-1 r with the preconditioner B, symmetric and positive definite. norm is |r|, by which
 * multigrid scales r for single precision. */
void cs_linear_precondition(struct cs_linear *linear, const double *r, double norm, double *z);

/* How a solve ended: by its residual, by a direction of negative curvature, by the iteration
 * limit, by a number that is not finite. */
enum cs_linear_end {
    CS_LINEAR_DONE,
    CS_LINEAR_INDEFINITE,
    CS_LINEAR_LIMIT,
    CS_LINEAR_NOT_FINITE
};

/* Solves A u = b to |b - A u| <= rtol |b| in the Euclidean norm, starting from u (3,n). Rows of
 * pinned particles are ignored in b and become 0 in u. *iterations counts products A p;
 * *residual is |b - A u| / |b|, by the recurrence. Results:
 *   - CS_LINEAR_DONE: the residual is reached. u = 0 if b is 0.
 *   - CS_LINEAR_INDEFINITE: p.A p <= 0. u holds the last iterate, *residual is 0.
 *   - CS_LINEAR_NOT_FINITE: b, A, the start or a product is not finite. u must not be used,
 *     *residual is 0.
 *   - CS_LINEAR_LIMIT: 10 n + 100 iterations did not suffice. u holds the last iterate. */
enum cs_linear_end cs_linear_solve(struct cs_linear *linear, const double *b, double rtol,
                                   double *u, uint64_t *iterations, double *residual);

#endif
