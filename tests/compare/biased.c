/* biased.c - the classical Runge-Kutta method with a planted bug: forces are 1e-6 too large. */
#include <clothsim/integrator.h>

#include <string.h>

#include "../../plugins/fixed_step.h"

struct biased {
    struct fixed_step base;
    double *k[4], *stage;
};

struct biased_options {
    double dt;
};

static const struct cs_option rows[] = {
    CS_OPTION(struct biased_options, dt, "s", 1e-3, 1e-9, 1, "step"),
};

static void slope(struct biased *self, double t, const double *y, double *out) {
    const struct cs_host *host = self->base.host;
    const size_t n = 3 * (size_t)host->view->n;
    memcpy(out, y + n, n * sizeof *y);
    host->force(host->ctx, t, y, y + n, CS_PART_ALL, out + n);
    for (size_t i = 0; i < n; i++)
        out[n + i] *= (1 + 1e-6) * host->view->inv_mass[i % host->view->n];
}

static enum cs_step step(struct fixed_step *base, double t, double h, double *x, double *v) {
    static const double at[4] = {0, 0.5, 0.5, 1}, weight[4] = {1, 2, 2, 1};
    struct biased *self = (struct biased *)base;
    const size_t values = 6 * (size_t)base->host->view->n;
    (void)v;
    for (int s = 0; s < 4; s++) {
        for (size_t i = 0; i < values; i++)
            self->stage[i] = x[i] + (s ? h * at[s] * self->k[s - 1][i] : 0);
        slope(self, t + at[s] * h, self->stage, self->k[s]);
    }
    for (int s = 0; s < 4; s++)
        for (size_t i = 0; i < values; i++)
            x[i] += h / 6 * weight[s] * self->k[s][i];
    return CS_STEP_OK;
}

static enum cs_step create(const struct cs_host *host, const void *options, void **out) {
    const size_t bytes = 6 * (size_t)host->view->n * sizeof(double);
    struct biased *self = host->alloc(host->ctx, sizeof *self);
    if (!self)
        return CS_STEP_FAIL;
    *out = self;
    self->base = fixed_step_of(host, ((const struct biased_options *)options)->dt, step);
    self->stage = host->alloc(host->ctx, bytes);
    for (int s = 0; s < 4; s++)
        self->k[s] = host->alloc(host->ctx, bytes);
    return self->stage && self->k[0] && self->k[1] && self->k[2] && self->k[3] ? CS_STEP_OK
                                                                               : CS_STEP_FAIL;
}

static const struct cs_integrator biased = {
    .size = sizeof biased,
    .name = "biased-rk4",
    .summary = "Runge-Kutta with forces that are 1e-6 too large",
    .source = "a planted bug",
    .order = 4,
    .order_damped = 4,
    .options = rows,
    .n_options = 1,
    .options_size = sizeof(struct biased_options),
    .create = create,
    .restart = fixed_step_restart,
    .advance = fixed_step_advance,
};

static const struct cs_integrator *const integrators[] = {&biased};
CS_EXPORT const struct cs_module clothsim_module = {CS_ABI, sizeof biased, 1, integrators};
