/* Implicit Euler by local/global steps with a constant matrix.
 *
 * A spring's energy is the least over p with |p| = L of k/2 |x_b - x_a - p|^2. In turn,
 * `iterations` times over, from the place y = x + h v + h^2 f/m that the outer forces alone
 * lead to:
 *   local    p = L n with n the direction of the spring
 *   global   (M + h D + h^2 L) u = sum over springs of h^2 k (p - (y_b - y_a)) + dampers,
 *            x = y + u
 * (Liu et al. 2013, for u instead of x, so that free flight leaves no rounding). Neither half
 * can raise the incremental potential, and where both leave x as it is, x is the implicit Euler
 * step. Then v = (x' - x)/h.
 *
 * Dampers and drag are implicit too. Relative dampers and drag are in the matrix. An axial
 * damper is there as if it were relative, and its part across the spring is given back from the
 * last x: h c (I - n n^T)((x_b - x_a) - (x_b - x_a)_old), which is the same kind of projection.
 * All other forces are those that the state at the start of the step has at its end.
 */
#include "local_global.h"

extern const struct cs_integrator projective_dynamics;

static const struct cs_option rows[] = {
    FIXED_STEP_DT_BY_ERROR(struct local_global_options),
    CS_OPTION(struct local_global_options, iterations, "", 10, 1, 1e6,
              "iterations per step, each with a local and a global solve"),
};

static enum cs_step step(struct fixed_step *loop, double t, double step_length, double *x,
                         double *v) {
    struct local_global *self = (struct local_global *)loop;
    const size_t n = loop->host->view->n;
    enum cs_step status = local_global_begin(self, t, step_length, x, v);
    if (status != CS_STEP_OK)
        return status;

    const double *u = self->b;
    for (int64_t i = 0; i < self->iterations; i++) {
        local_global_pull(self, x, self->y);
        status = constant_matrix_solve(&self->matrix, self->b, &u);
        if (status != CS_STEP_OK)
            return status;
        for (size_t k = 0; k < 3 * n; k++)
            x[k] = self->y[k] + u[k];
        self->passes++;
    }
    for (size_t k = 0; k < 3 * n; k++)
        v[k] += u[k] / self->matrix.h;
    return CS_STEP_OK;
}

static enum cs_step create(const struct cs_host *host, const void *options, void **out) {
    struct local_global *self = *out = host->alloc(host->ctx, sizeof *self);
    return self ? local_global_init(self, host, options, step) : CS_STEP_FAIL;
}

static void stats(const void *object, struct cs_stats *out) {
    fixed_step_stats(object, out);
    out->newton = ((const struct local_global *)object)->passes;
    if (CS_HAS(out, sweeps))
        out->sweeps = 2 * out->newton; // the right-hand side, and the solve
}

static const struct cs_integrator fast_mass_spring = {
    .size = sizeof(struct cs_integrator),
    .name = "fast-mass-spring",
    .summary = "implicit Euler by local projections and one constant matrix, factored once",
    .source = "Liu, Bargteil, O'Brien, Kavan 2013",
    .order = 1,
    .order_damped = 1,
    .needs = CS_NEED_SPRINGS,
    .traits = CS_IMPLICIT | CS_LIBRARY_BITS | CS_EXPLICIT_OUTER,
    .fidelity = CS_FIDELITY_IMPLICIT_EULER,
    .fails = local_global_fails,
    .options = rows,
    .n_options = sizeof rows / sizeof rows[0],
    .options_size = sizeof(struct local_global_options),
    .create = create,
    .restart = local_global_restart,
    .advance = local_global_advance,
    .stats = stats,
    .destroy = local_global_destroy,
    .save = local_global_save,
    .load = local_global_load,
    .library = LOCAL_GLOBAL_LIBRARY,
};

static const struct cs_integrator *const integrators[] = {&fast_mass_spring,
                                                          &projective_dynamics};

CS_EXPORT const struct cs_module clothsim_module = {
    .abi = CS_ABI,
    .size = sizeof(struct cs_integrator),
    .n = sizeof integrators / sizeof integrators[0],
    .integrators = integrators,
};
