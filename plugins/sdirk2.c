/* Two diagonally implicit stages with g = (1 - 1/sqrt 2) h.
 *
 * For y = (x, v), y' = F(t, y):
 *   y1 = y + g F(t + g, y1)
 *   y' = y + (h - g) F(t + g, y1) + g F(t + h, y'),   F(t + g, y1) = (y1 - y) / g
 * L-stable, order 2 (Alexander 1977).
 */
#include "newton_methods.h"

#include <math.h>
#include <string.h>

struct sdirk2_options {
    NEWTON_FIELDS;
};

static const struct cs_option rows[] = {NEWTON_ROWS(struct sdirk2_options)};

struct method {
    struct newton_method base;
    struct sdirk2_arrays arrays;
};

enum cs_step sdirk2_alloc(const struct cs_host *host, struct sdirk2_arrays *arrays) {
    double **const all[] = {&arrays->u, &arrays->xb, &arrays->ub};
    return step_halving_alloc(host, all, 3);
}

enum cs_step sdirk2_step(struct newton *newton, const struct sdirk2_arrays *arrays,
                         newton_solver *solve, double t, double h, double *x, double *v,
                         bool *accepted) {
    const double c = 1 - 1 / sqrt(2), g = c * h;
    const size_t n3 = 3 * (size_t)newton->host->view->n;
    double *u = arrays->u, *xb = arrays->xb, *ub = arrays->ub;
    struct newton_stage stage = {
        .t = t + g, .s = g, .gx = g, .gv = 1, .xb = x, .ub = v, .c = g, .x0 = x, .v0 = v};
    memcpy(u, v, n3 * sizeof *v);
    enum cs_step status = solve(newton, &stage, u, accepted);
    if (status != CS_STEP_OK || !*accepted)
        return status;

    /* (h - g) F of the first stage, whose slope is u and (u - v) / g */
    for (size_t k = 0; k < n3; k++) {
        ub[k] = v[k] + (1 - c) / c * (u[k] - v[k]);
        xb[k] = x[k] + (h - g) * u[k];
    }
    stage.t = t + h;
    stage.c = h;
    stage.xb = xb;
    stage.ub = ub;
    status = solve(newton, &stage, u, accepted);
    if (status != CS_STEP_OK || !*accepted)
        return status;
    memcpy(x, newton->x, n3 * sizeof *x);
    memcpy(v, u, n3 * sizeof *v);
    return CS_STEP_OK;
}

static enum cs_step step(struct step_halving *object, double t, double h, double *x, double *v,
                         bool *accepted) {
    struct method *self = (struct method *)object;
    return sdirk2_step(&self->base.newton, &self->arrays, newton_solve, t, h, x, v, accepted);
}

static enum cs_step create(const struct cs_host *host, const void *options, void **out) {
    const struct sdirk2_options *asked = options;
    struct newton_method *base = newton_method_create(host, sizeof(struct method), asked->dt,
                                                      asked->rtol, asked->iterations, step);
    if (!(*out = base))
        return CS_STEP_FAIL;
    return sdirk2_alloc(host, &((struct method *)base)->arrays);
}

const struct cs_integrator sdirk2 = {
    STEP_HALVING_METHOD(struct sdirk2_options, rows, step_halving_archive),
    .name = "sdirk2",
    .summary = "two diagonally implicit stages by Newton, L-stable",
    .source = "Alexander 1977",
    .order = 2,
    .order_damped = 2,
    .needs = CS_NEED_ENERGY | CS_NEED_SOLVE | CS_NEED_LAGGED_FRICTION,
    .traits = CS_IMPLICIT,
    .create = create,
};
