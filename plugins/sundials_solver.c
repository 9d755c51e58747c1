/* sundials_solver.c - solves (I - g J) z = b of a Newton iteration by the host's solver.
 *
 * J is the Jacobian of y' = (v, M^-1 f): with K = df/dx, D = df/dv the two rows are
 *   z_x - g z_v = b_x,   M z_v - g (K z_x + D z_v) = M b_v.
 * Eliminating z_x leaves half the unknowns and the host's matrix:
 *   (M - g D - g^2 K) z_v = M b_v + g K b_x,   z_x = b_x + g z_v.
 * Nothing is kept from one iteration to the next: the matrix costs no factorisation. */
#include "sundials_solver.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* A solver that needs no matrix of the library's. */
static SUNLinearSolver_Type solver_type(SUNLinearSolver solver) {
    (void)solver;
    return SUNLINEARSOLVER_MATRIX_EMBEDDED;
}

/* Relative residuals of a solve, whatever the library allows. */
#define LOOSEST_RTOL  0.05
#define TIGHTEST_RTOL 1e-4

/* An unrecoverable failure. The library takes codes that it does not know, such as -1, for
 * success. */
#define SOLVE_FAILED SUNLS_PSOLVE_FAIL_UNREC

/* Solves that may fail in a row: after each the library tries a shorter step. */
enum { FAILED_SOLVES_MAX = 3 };

/* solve of the library's interface: z from b at the state and g of the Newton iteration. The
 * library allows a residual of that length; the host's tolerance is relative to the right-hand
 * side. cvode-bdf takes 0.35 to 0.49 of the iterations of TIGHTEST_RTOL alone, ark-dirk 0.82 to
 * 0.85, in as many steps to 5 %. */
static int solve_reduced(SUNLinearSolver solver, SUNMatrix none, N_Vector z, N_Vector b,
                         sunrealtype tolerance) {
    (void)none;
    struct sundials *self = solver->content;
    const struct cs_host *host = self->host;
    const size_t n = host->view->n;
    N_Vector y;
    double t, g;
    if (self->library->system(self->memory, &t, &y, &g) < 0)
        return SOLVE_FAILED;

    const double *x = sundials_data(y), *v = x + 3 * n;
    const double *bx = sundials_data(b), *bv = bx + 3 * n;
    double *zx = sundials_data(z), *zv = zx + 3 * n;
    host->jvp(host->ctx, t, x, v, CS_PART_LINEARISED, bx, NULL, self->b);
    for (size_t c = 0; c < 3; c++)
        for (size_t i = 0; i < n; i++)
            self->b[c * n + i] = host->view->mass[i] * bv[c * n + i] + g * self->b[c * n + i];
    const double allowed = tolerance / sqrt(N_VDotProd(b, b) + DBL_MIN);
    const double rtol = self->linear_rtol > 0
                            ? self->linear_rtol
                            : fmax(fmin(allowed, LOOSEST_RTOL), TIGHTEST_RTOL);
    memset(zv, 0, 3 * n * sizeof *zv);
    const bool may_fail = CS_HAS(host, lag_friction) && self->failed_solves < FAILED_SOLVES_MAX;
    self->status =
        host->solve_setup(host->ctx, t, x, v, 1, -g, -g * g, may_fail ? CS_SOLVE_MAY_FAIL : 0);
    if (self->status != CS_STEP_OK)
        return SOLVE_FAILED;
    self->status = host->solve(host->ctx, self->b, rtol, zv);
    // a step too long for the solver: the library takes a shorter one
    if (may_fail && self->status == CS_STEP_FAIL) {
        self->status = CS_STEP_OK;
        self->failed_solves++;
        return SUNLS_CONV_FAIL;
    }
    if (self->status != CS_STEP_OK)
        return SOLVE_FAILED;
    self->failed_solves = 0;

    // no force acts on pinned particles, where z_v = b_v; b is not 0 there while the library's
    // history of them is not
    for (size_t c = 0; c < 3; c++)
        for (size_t i = 0; i < n; i++)
            if (host->view->inv_mass[i] == 0)
                zv[c * n + i] = bv[c * n + i];
    host->vector->linear_sum(3 * n, 1, bx, g, zv, zx);
    return 0;
}

enum cs_step sundials_solver_init(struct sundials *self) {
    const struct cs_host *host = self->host;
    self->b = host->alloc(host->ctx, 3 * sizeof(double) * host->view->n);
    if (!self->b)
        return CS_STEP_FAIL;
    self->solver_ops.gettype = solver_type;
    self->solver_ops.solve = solve_reduced;
    self->solver.content = self;
    self->solver.ops = &self->solver_ops;
    self->solver.sunctx = self->context;
    return CS_STEP_OK;
}
