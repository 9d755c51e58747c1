/* constant_matrix.h - the matrix of local/global methods, factored once for each step length:
 *
 *   A = M + h D + h^2 L,   L = sum of k (e_a - e_b)(e_a - e_b)^T over springs,
 *
 * with D the same sum of the springs' dampers, and drag on its diagonal. A is (n,n): one system
 * for each of x, y and z. Rows of pinned particles are diagonal. By CHOLMOD, simplicial, so
 * that no BLAS has a say in the bits; its memory is its own.
 */
#ifndef CONSTANT_MATRIX_H
#define CONSTANT_MATRIX_H

#include <clothsim/integrator.h>
#include <suitesparse/cholmod.h>

struct constant_matrix {
    const struct cs_host *host; /* borrowed */
    double *drag;               /* (n) in N s/m */
    double h;                   /* the step that the factor belongs to; 0: none */
    cholmod_common common;
    bool started;
    cholmod_factor *factor;
    cholmod_dense *u, *y, *e; /* result and work of the solve, kept between calls */
};

/* Zeroed memory in, takes `drag` from the host. */
enum cs_step constant_matrix_init(struct constant_matrix *matrix, const struct cs_host *host);

/* Reads the drag of the scene from the force on unit velocities; ones, f: work (3,n). */
void constant_matrix_read_drag(struct constant_matrix *matrix, double t, const double *x,
                               double *ones, double *f);

/* Factors A for steps of h, unless the factor at hand is for the same step up to rounding: it
 * is then kept, and matrix->h is the step to use. */
enum cs_step constant_matrix_prepare(struct constant_matrix *matrix, double h);

/* Solves A u = b for three columns. b (4,n): the last row of it is 0, as CHOLMOD works on four
 * columns at once, and for three it would take memory in every call. *u (3,n) is valid until
 * the next call. */
enum cs_step constant_matrix_solve(struct constant_matrix *matrix, double *b, const double **u);

void constant_matrix_finish(struct constant_matrix *matrix);

#endif
