/* constant_matrix.h - the matrix of local/global methods: factored once per step length, and
 * in every step while ramps change it.
 *
 *   A = M + h D + h^2 L,   L = sum over springs of k (e_a - e_b)(e_a - e_b)^T
 *
 * D is the same sum of the springs' dampers, plus drag on its diagonal. A is (n,n): one
 * system for each of x, y and z, because L does not depend on the directions of the springs.
 * Rows and columns of pinned particles are diagonal. A is symmetric and positive definite,
 * since M is and the other terms are sums of squares. Solved by CHOLMOD, simplicial, so that
 * no BLAS affects the bits; the factor lies in the library's own memory.
 *
 * The decisions of one step (prepare):
 * 1. Springs or dampers differ from those in the factor: factor again.
 * 2. Other particles are pinned than in the factor: factor again.
 * 3. Drag changes within this advance: set it to its value at the end of the step, and factor
 *    again.
 * 4. The step length differs by more than rounding (1e-9): factor again.
 * 5. Otherwise the factor stays, with the step length that it was made for: matrix->h.
 *
 * A new factor reuses the elimination order of the last restart. */
#ifndef CONSTANT_MATRIX_H
#define CONSTANT_MATRIX_H

#include <clothsim/integrator.h>
#include <suitesparse/cholmod.h>

/* The matrix, its factor, and the values that the factor was made with. */
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

/* Prepares *matrix, which must be zeroed, and takes its arrays from the host; [create]. After
 * a failure call finish too. */
enum cs_step constant_matrix_init(struct constant_matrix *matrix, const struct cs_host *host);

/* Drops the factor and its elimination order: masses, pins or springs were changed from
 * outside. */
void constant_matrix_restart(struct constant_matrix *matrix);

/* Reads the drag of the scene at both ends of an advance: minus the force of CS_PART_DRAG on
 * unit velocities. In between it is linear in time, as ramps are. ones, f: scratch (3,n). */
void constant_matrix_read_drag(struct constant_matrix *matrix, double t0, double t1,
                               const double *x, double *ones, double *f);

/* Makes the factor valid for a step of length h in s from t on, by the decisions above.
 * matrix->h is then the step length to use. CS_STEP_FAIL, with a message: out of memory, or
 * numbers beyond the range of doubles. */
enum cs_step constant_matrix_prepare(struct constant_matrix *matrix, double t, double h);

/* For save: the step length, drag and springs of the factor. load reads them, and factors
 * again: the factor itself is not saved. */
void constant_matrix_archive(struct constant_matrix *matrix, const struct cs_archive *archive);
enum cs_step constant_matrix_load(struct constant_matrix *matrix,
                                  const struct cs_archive *archive);

/* Solves A u = b for three right-hand sides. b (4,n): its last row must be 0. CHOLMOD works
 * on four columns at once, and would allocate memory in every call for three. *u (3,n) is the
 * matrix's, valid until the next call. */
enum cs_step constant_matrix_solve(struct constant_matrix *matrix, double *b, const double **u);

/* Frees the library's memory; safe after a failed init. */
void constant_matrix_finish(struct constant_matrix *matrix);

#endif
