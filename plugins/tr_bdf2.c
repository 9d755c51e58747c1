/* Trapezoidal rule to t + c h, then BDF2 to t + h, with c = 2 - sqrt 2.
 *
 * For y = (x, v), y' = F(t, y):
 *   y1 = y + c h/2 (F(y) + F(y1))
 *   y' = y + (y1 - y) / (c (2 - c)) + (1 - c)/(2 - c) h F(y')
 * c makes both stages have the factor g = c h/2 before F. L-stable, order 2 (Bank et al. 1985;
 * Hosea and Shampine 1996). The first stage takes the force at the start of the step as it is:
 * after a contact has pushed particles together, that force is felt in full, so that at large
 * steps in contact sdirk2 is calmer.
 */
#include "newton_methods.h"

#include <math.h>
#include <string.h>

struct tr_bdf2_options {
    NEWTON_FIELDS;
};

static const struct cs_option rows[] = {NEWTON_ROWS(struct tr_bdf2_options)};

struct method {
    struct newton_method base;
    double *u;       /* (3,n) velocity of the running stage */
    double *xb, *ub; /* (3,n) known part of the running stage */
};

static enum cs_step step(struct step_halving *object, double t, double h, double *x, double *v,
                         bool *accepted) {
    const double c = 2 - sqrt(2), g = c * h / 2, share = 1 / (c * (2 - c));
    struct method *self = (struct method *)object;
    struct newton *newton = &self->base.newton;
    const struct cs_host *host = newton->host;
    const struct cs_view *view = host->view;
    const size_t n = view->n;
    double *u = self->u, *xb = self->xb, *ub = self->ub;

    // trapezoidal rule: the known half is explicit
    host->force(host->ctx, t, x, v, CS_PART_ALL, ub);
    for (size_t d = 0; d < 3; d++)
        for (size_t i = 0; i < n; i++) {
            const size_t k = d * n + i;
            ub[k] = v[k] + g * view->inv_mass[i] * ub[k];
            xb[k] = x[k] + g * v[k];
        }
    memcpy(u, v, 3 * n * sizeof *u);
    struct newton_stage stage = {.t = t + c * h,
                                 .s = g,
                                 .gx = g,
                                 .gv = 1,
                                 .xb = xb,
                                 .ub = ub,
                                 .c = c * h,
                                 .x0 = x,
                                 .v0 = v};
    enum cs_step status = newton_solve(newton, &stage, u, accepted);
    if (status != CS_STEP_OK || !*accepted)
        return status;

    // BDF2 over the two unequal parts
    for (size_t k = 0; k < 3 * n; k++) {
        ub[k] = v[k] + share * (u[k] - v[k]);
        xb[k] = x[k] + share * (newton->x[k] - x[k]);
    }
    stage.t = t + h;
    stage.c = h;
    status = newton_solve(newton, &stage, u, accepted);
    if (status != CS_STEP_OK || !*accepted)
        return status;
    memcpy(x, newton->x, 3 * n * sizeof *x);
    memcpy(v, u, 3 * n * sizeof *v);
    return CS_STEP_OK;
}

static enum cs_step create(const struct cs_host *host, const void *options, void **out) {
    const struct tr_bdf2_options *asked = options;
    struct newton_method *base = newton_method_create(host, sizeof(struct method), asked->dt,
                                                      asked->rtol, asked->iterations, step);
    if (!(*out = base))
        return CS_STEP_FAIL;
    struct method *self = (struct method *)base;
    double **const arrays[] = {&self->u, &self->xb, &self->ub};
    return step_halving_alloc(host, arrays, 3);
}

const struct cs_integrator tr_bdf2 = {
    STEP_HALVING_METHOD(struct tr_bdf2_options, rows, step_halving_archive),
    .name = "tr-bdf2",
    .summary = "trapezoidal rule, then BDF2, by Newton: accurate at large steps, L-stable",
    .source = "Bank et al. 1985; Hosea, Shampine 1996",
    .order = 2,
    .order_damped = 2,
    .needs = CS_NEED_ENERGY | CS_NEED_SOLVE | CS_NEED_LAGGED_FRICTION,
    .traits = CS_IMPLICIT,
    .create = create,
};
