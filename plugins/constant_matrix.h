/* constant_matrix.h - the matrix of local/global methods, factored once for each step length,
 * and anew in each step while ramps change it:
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
    const struct cs_host *host;    /* borrowed */
    double *drag;                  /* (n) in N s/m */
    double *drag_begin, *drag_end; /* (n) in N s/m: drag at the ends of the advance */
    double begin, end;             /* s, of the advance */
    bool drag_changes;             /* within the advance */
    double *springs;               /* (2,n_springs): stiffness and damping in the factor */
    double *inv_mass;              /* (n) in 1/kg: 0 where a particle is pinned in the factor */
    double h;                      /* the step that the factor belongs to; 0: none */
    cholmod_common common;
    bool started;
    cholmod_factor *factor;
    cholmod_dense *u, *y, *solve_work; /* result and work of the solve, kept between calls */
};

/* Zeroed memory in, takes its arrays from the host. */
enum cs_step constant_matrix_init(struct constant_matrix *matrix, const struct cs_host *host);

/* Forgets the factor: masses, pins or springs were changed. */
void constant_matrix_restart(struct constant_matrix *matrix);

/* Reads the drag of the scene at both ends of an advance, from the force on unit velocities;
 * in between it is linear in time. ones, f: work (3,n). */
void constant_matrix_read_drag(struct constant_matrix *matrix, double t0, double t1,
                               const double *x, double *ones, double *f);

/* Factors A for the step of h from t on, with the springs as they are, unless the factor at
 * hand is for the same ones, the same pins and, up to rounding, the same step: it is then kept,
 * and matrix->h is the step to use. */
enum cs_step constant_matrix_prepare(struct constant_matrix *matrix, double t, double h);

/* For save: the step, the drag and the springs that the factor was made with. For load: takes
 * them back, and factors anew. */
void constant_matrix_archive(struct constant_matrix *matrix, const struct cs_archive *archive);
enum cs_step constant_matrix_load(struct constant_matrix *matrix,
                                  const struct cs_archive *archive);

/* Solves A u = b for three columns. b (4,n): the last row of it is 0, as CHOLMOD works on four
 * columns at once, and for three it would take memory in every call. *u (3,n) is valid until
 * the next call. */
enum cs_step constant_matrix_solve(struct constant_matrix *matrix, double *b, const double **u);

void constant_matrix_finish(struct constant_matrix *matrix);

#endif
