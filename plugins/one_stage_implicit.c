/* Methods of one Newton stage: implicit Euler and the midpoint rule.
 *
 *   M (u - v) = s f(t + s, X, u),   X = x + s u
 * backward-euler: s = h, x' = X, v' = u, which is the minimum of the incremental potential
 * where f has a potential (Gast et al. 2015). implicit-linearised is its first Newton step from
 * v' = 0.
 * implicit-midpoint: s = h/2, x' = 2 X - x, v' = 2 u - v (Hairer, Lubich, Wanner 2006, sec.
 * II.1). Symplectic and reversible up to Newton's rtol. A-stable but not L-stable: modes too
 * fast for the step ring on with alternating sign.
 */
#include "newton_methods.h"

#include <string.h>

struct one_stage_options {
    NEWTON_FIELDS;
};

static const struct cs_option rows[] = {NEWTON_ROWS(struct one_stage_options)};

struct method {
    struct newton_method base;
    double *u; /* (3,n) in m/s */
};

/* the stage, for u from the start v */
static enum cs_step solve(struct method *self, double t, double s, const double *x,
                          const double *v, bool *accepted) {
    struct newton *newton = &self->base.newton;
    const struct newton_stage stage = {
        .t = t + s, .s = s, .gx = s, .gv = 1, .xb = x, .ub = v, .c = s, .x0 = x, .v0 = v};
    memcpy(self->u, v, 3 * sizeof *v * newton->host->view->n);
    return newton_solve(newton, &stage, self->u, accepted);
}

static enum cs_step step_euler(struct step_halving *object, double t, double h, double *x,
                               double *v, bool *accepted) {
    struct method *self = (struct method *)object;
    const size_t bytes = 3 * sizeof(double) * object->fixed.host->view->n;
    const enum cs_step status = solve(self, t, h, x, v, accepted);
    if (status != CS_STEP_OK || !*accepted)
        return status;
    memcpy(x, self->base.newton.x, bytes);
    memcpy(v, self->u, bytes);
    return CS_STEP_OK;
}

static enum cs_step step_midpoint(struct step_halving *object, double t, double h, double *x,
                                  double *v, bool *accepted) {
    struct method *self = (struct method *)object;
    const struct cs_host *host = object->fixed.host;
    const size_t n3 = 3 * (size_t)host->view->n;
    const enum cs_step status = solve(self, t, h / 2, x, v, accepted);
    if (status != CS_STEP_OK || !*accepted)
        return status;
    host->vector->linear_sum(n3, 1, x, h, self->u, x);
    host->vector->linear_sum(n3, 2, self->u, -1, v, v);
    return CS_STEP_OK;
}

static enum cs_step create(const struct cs_host *host, const void *options,
                           step_halving_callback *step, void **out) {
    const struct one_stage_options *asked = options;
    struct newton_method *self = newton_method_create(host, sizeof(struct method), asked->dt,
                                                      asked->rtol, asked->iterations, step);
    if (!(*out = self))
        return CS_STEP_FAIL;
    double **const arrays[] = {&((struct method *)self)->u};
    return step_halving_alloc(host, arrays, 1);
}

static enum cs_step create_euler(const struct cs_host *host, const void *options, void **out) {
    const enum cs_step status = create(host, options, step_euler, out);
    if (*out)
        ((struct step_halving *)*out)->fixed.error.is_second_order = false;
    return status;
}

static enum cs_step create_midpoint(const struct cs_host *host, const void *options,
                                    void **out) {
    return create(host, options, step_midpoint, out);
}

const struct cs_integrator backward_euler = {
    STEP_HALVING_METHOD(struct one_stage_options, rows, step_halving_archive),
    .name = "backward-euler",
    .summary = "implicit Euler by Newton with line search; stable at large steps, damps",
    .source = "Gast et al. 2015; Martin et al. 2011",
    .order = 1,
    .order_damped = 1,
    .needs = CS_NEED_ENERGY | CS_NEED_SOLVE | CS_NEED_LAGGED_FRICTION,
    .traits = CS_IMPLICIT,
    .create = create_euler,
};

const struct cs_integrator implicit_midpoint = {
    STEP_HALVING_METHOD(struct one_stage_options, rows, step_halving_archive),
    .name = "implicit-midpoint",
    .summary =
        "midpoint rule by Newton: symplectic, no numerical damping; makes energy at long "
        "steps where springs are pressed hard",
    .source = "Hairer, Lubich, Wanner 2006, sec. II.1",
    .order = 2,
    .order_damped = 2,
    .needs = CS_NEED_ENERGY | CS_NEED_SOLVE | CS_NEED_LAGGED_FRICTION,
    .traits = CS_IMPLICIT | CS_SYMPLECTIC,
    .create = create_midpoint,
};
