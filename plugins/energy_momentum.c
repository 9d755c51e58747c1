/* energy_momentum.c - the midpoint rule with springs that neither make nor lose energy.
 *
 *   M (v' - v) = h f((x + x')/2, (v + v')/2),   x' = x + h (v + v')/2
 * as implicit-midpoint, but a spring from d to d' over the step, with the lengths l and l' and
 * d" = (d + d')/2, pulls with
 *   f_a = k (1 - 2 L/(l + l')) d"
 * Since l'^2 - l^2 = 2 d".(d' - d), its work f_a.(d' - d) is the change of k (l - L)^2 / 2 for
 * any step, and a force along d" turns nothing: energy, momentum and angular momentum of
 * springs under gravity are kept to Newton's tolerance (LaBudde, Greenspan 1976; Simo, Tarnow
 * 1992; Gonzalez 1996, whose discrete gradient this is in the length of a spring). Membranes,
 * bending and contact keep the midpoint rule, which has order 2 and no exact energy.
 *
 * Newton's matrix is that of the springs at the midpoint, which differs from the derivative of
 * f_a by terms of the order of the step: the iteration converges linearly, with a small factor.
 */
#include "newton_methods.h"

#include <float.h>
#include <math.h>
#include <string.h>

struct energy_momentum_options {
    NEWTON_FIELDS;
};

/* the energy is kept no better than the equation is solved */
static const struct cs_option rows[] = {
    FIXED_STEP_DT_BY_ERROR(struct energy_momentum_options),
    CS_OPTION(struct energy_momentum_options, rtol, "", 1e-9, 1e-14, 0.1,
              "residual of Newton's iteration, relative to the impulse of the step"),
    CS_OPTION(struct energy_momentum_options, iterations, "", 50, 1, 1000,
              "maximum Newton iterations; then friction of contact is lagged, or the step "
              "is halved, up to 12 times")};

struct method {
    struct newton_method base;
    double *u; /* (3,n) in m/s: (v + v')/2 */
};

static double inverse_length(const double d[3]) {
    return 1 / sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2] + DBL_MIN);
}

/* Turns the springs' forces at X, the middle of the step, into those of the step from x0. */
static void exchange_springs(struct newton *newton, const struct newton_stage *stage) {
    const struct cs_view *view = newton->host->view;
    const size_t n = view->n;
    for (size_t s = 0; s < view->n_springs; s++) {
        const size_t a = view->ends[2 * s], b = view->ends[2 * s + 1];
        double middle[3], begin[3], end[3];
        for (size_t c = 0; c < 3; c++) {
            middle[c] = newton->x[c * n + b] - newton->x[c * n + a];
            begin[c] = stage->x0[c * n + b] - stage->x0[c * n + a];
            end[c] = 2 * middle[c] - begin[c];
        }
        const double inverse = 2 / (1 / inverse_length(begin) + 1 / inverse_length(end));
        const double pull =
            view->stiffness[s] * view->length[s] * (inverse_length(middle) - inverse);
        for (size_t c = 0; c < 3; c++) {
            newton->f[c * n + a] += pull * middle[c];
            newton->f[c * n + b] -= pull * middle[c];
        }
    }
}

static enum cs_step step(struct step_halving *object, double t, double h, double *x, double *v,
                         bool *accepted) {
    struct method *self = (struct method *)object;
    const struct cs_host *host = object->fixed.host;
    const size_t n3 = 3 * (size_t)host->view->n;
    const struct newton_stage stage = {.t = t + h / 2,
                                       .s = h / 2,
                                       .gx = h / 2,
                                       .gv = 1,
                                       .xb = x,
                                       .ub = v,
                                       .c = h / 2,
                                       .x0 = x,
                                       .v0 = v,
                                       .exchange = exchange_springs};
    memcpy(self->u, v, n3 * sizeof *v);
    const enum cs_step status = newton_solve(&self->base.newton, &stage, self->u, accepted);
    if (status != CS_STEP_OK || !*accepted)
        return status;
    host->vector->linear_sum(n3, 1, x, h, self->u, x);
    host->vector->linear_sum(n3, 2, self->u, -1, v, v);
    return CS_STEP_OK;
}

static enum cs_step create(const struct cs_host *host, const void *options, void **out) {
    const struct energy_momentum_options *asked = options;
    struct newton_method *self = newton_method_create(host, sizeof(struct method), asked->dt,
                                                      asked->rtol, asked->iterations, step);
    if (!(*out = self))
        return CS_STEP_FAIL;
    double **const arrays[] = {&((struct method *)self)->u};
    return step_halving_alloc(host, arrays, 1);
}

const struct cs_integrator energy_momentum = {
    STEP_HALVING_METHOD(struct energy_momentum_options, rows, step_halving_archive),
    .name = "energy-momentum",
    .summary =
        "midpoint rule whose springs conserve energy and momentum at any step, by Newton",
    .source = "Simo, Tarnow 1992; Gonzalez 1996; LaBudde, Greenspan 1976",
    .order = 2,
    .order_damped = 2,
    .needs = CS_NEED_ENERGY | CS_NEED_SOLVE | CS_NEED_LAGGED_FRICTION | CS_NEED_SPRINGS,
    .traits = CS_IMPLICIT,
    .create = create,
};
