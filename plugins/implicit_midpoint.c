/* implicit_midpoint.c - the midpoint rule: symmetric, symplectic, without numerical damping.
 *
 *   M (u - v) = h/2 f(t + h/2, X, u),   X = x + h/2 u
 *   x' = 2 X - x,   v' = 2 u - v
 * (Hairer, Lubich, Wanner 2006, sec. II.1). Symplectic and reversible up to Newton's rtol.
 * A-stable but not L-stable: modes too fast for the step ring on with alternating sign.
 */
#include "newton_methods.h"

#include <string.h>

struct midpoint_options {
    NEWTON_FIELDS;
};

static const struct cs_option rows[] = {NEWTON_ROWS(struct midpoint_options)};

struct method {
    struct newton_method base;
    double *u; /* (3,n) in m/s */
};

static enum cs_step step(struct halving *object, double t, double h, double *x, double *v,
                         bool *accepted) {
    struct method *self = (struct method *)object;
    const struct cs_host *host = object->loop.host;
    const size_t n3 = 3 * (size_t)host->view->n;
    const struct newton_stage stage = {
        .t = t + h / 2, .s = h / 2, .gx = h / 2, .gv = 1, .xb = x, .ub = v};
    memcpy(self->u, v, n3 * sizeof *v);
    const enum cs_step status = newton_solve(&self->base.newton, &stage, self->u, accepted);
    if (status != CS_STEP_OK || !*accepted)
        return status;
    host->vector->linear_sum(n3, 1, x, h, self->u, x);
    host->vector->linear_sum(n3, 2, self->u, -1, v, v);
    return CS_STEP_OK;
}

static enum cs_step create(const struct cs_host *host, const void *options, void **out) {
    const struct midpoint_options *asked = options;
    struct newton_method *self = newton_method_create(host, sizeof(struct method), asked->dt,
                                                      asked->rtol, asked->iterations, step);
    if (!(*out = self))
        return CS_STEP_FAIL;
    double **const arrays[] = {&((struct method *)self)->u};
    return halving_take(host, arrays, 1);
}

const struct cs_integrator implicit_midpoint = {
    HALVING_METHOD(struct midpoint_options, rows),
    .name = "implicit-midpoint",
    .summary = "midpoint rule by Newton: symplectic, no numerical damping",
    .source = "Hairer, Lubich, Wanner 2006, sec. II.1",
    .order = 2,
    .order_damped = 2,
    .needs = CS_NEED_ENERGY | CS_NEED_SOLVE,
    .traits = CS_IMPLICIT | CS_SYMPLECTIC,
    .create = create,
};
