/* backward_euler.c - implicit Euler, solved to the end.
 *
 *   M (v' - v) = h f(t + h, x', v'),   x' = x + h v'
 * which is the minimum of the incremental potential where f has a potential (Gast et al. 2015).
 * implicit-linearised is its first Newton step from v' = 0.
 */
#include "newton_methods.h"

#include <string.h>

struct backward_euler_options {
    NEWTON_FIELDS;
};

static const struct cs_option rows[] = {NEWTON_ROWS(struct backward_euler_options)};

struct method {
    struct newton_method base;
    double *u; /* (3,n) in m/s */
};

static enum cs_step step(struct halving *object, double t, double h, double *x, double *v,
                         bool *accepted) {
    struct method *self = (struct method *)object;
    const size_t bytes = 3 * sizeof(double) * object->loop.host->view->n;
    const struct newton_stage stage = {.t = t + h, .s = h, .gx = h, .gv = 1, .xb = x, .ub = v};
    memcpy(self->u, v, bytes);
    const enum cs_step status = newton_solve(&self->base.newton, &stage, self->u, accepted);
    if (status != CS_STEP_OK || !*accepted)
        return status;
    memcpy(x, self->base.newton.x, bytes);
    memcpy(v, self->u, bytes);
    return CS_STEP_OK;
}

static enum cs_step create(const struct cs_host *host, const void *options, void **out) {
    const struct backward_euler_options *asked = options;
    struct newton_method *self = newton_method_create(host, sizeof(struct method), asked->dt,
                                                      asked->rtol, asked->iterations, step);
    if (!(*out = self))
        return CS_STEP_FAIL;
    double **const arrays[] = {&((struct method *)self)->u};
    return halving_take(host, arrays, 1);
}

const struct cs_integrator backward_euler = {
    HALVING_METHOD(struct backward_euler_options, rows),
    .name = "backward-euler",
    .summary = "implicit Euler by Newton with line search; stable at large steps, damps",
    .source = "Gast et al. 2015; Martin et al. 2011",
    .order = 1,
    .order_damped = 1,
    .needs = CS_NEED_ENERGY | CS_NEED_SOLVE,
    .traits = CS_IMPLICIT,
    .create = create,
};
