/* hostile.c - symplectic Euler that does one thing to the process it runs in: its option says
 * what (deeds.h). For the tests of what clothsim notices by itself, and of what only a second
 * process can. */
#include "deeds.h"

#include <string.h>

struct options {
    int32_t deed;
    double dt; /* s */
};

struct hostile {
    const struct cs_host *host;
    double *f; /* (3,n) N */
    size_t deed;
    double dt; /* s */
};

static const struct cs_option rows[] = {
    CS_OPTION_CHOICE(struct options, deed, names, 0, "what it does"),
    CS_OPTION(struct options, dt, "s", 1, 1e-9, 1e3, "step, at most a frame"),
};

/* what HOSTILE names is done while the module is loaded */
__attribute__((constructor)) static void loaded(void) {
    static double nobodys[1];
    const char *asked = getenv("HOSTILE");
    for (size_t k = 0; asked && names[k]; k++)
        if (!strcmp(names[k], asked))
            deeds[k].deed(nobodys);
}

static void act(struct hostile *self, enum when when, double *x) {
    const char *sign = getenv("SIGN");
    FILE *file;
    acting = self->host;
    if (deeds[self->deed].when != when)
        return;
    // whoever waits for the deed sees a file
    if (sign && (file = fopen(sign, "w")))
        fclose(file);
    deeds[self->deed].deed(x);
}

static enum cs_step create(const struct cs_host *host, const void *options, void **out) {
    struct hostile *self = host->alloc(host->ctx, sizeof *self);
    const size_t n = host->view->n;
    if (!self || !(self->f = host->alloc(host->ctx, 3 * n * sizeof *self->f)))
        return CS_STEP_FAIL;
    self->host = host;
    self->deed = (size_t)((const struct options *)options)->deed;
    self->dt = ((const struct options *)options)->dt;
    *out = self;
    act(self, CREATE, self->f);
    return CS_STEP_OK;
}

static enum cs_step restart(void *self, double t, const double *x, const double *v) {
    (void)t, (void)v;
    act(self, RESTART, (double *)(uintptr_t)x);
    return CS_STEP_OK;
}

static enum cs_step advance(void *object, double t0, double t1, double *x, double *v) {
    struct hostile *self = object;
    const struct cs_host *host = self->host;
    const uint32_t n = host->view->n, steps = (uint32_t)ceil((t1 - t0) / self->dt);
    const double h = (t1 - t0) / steps;
    enum cs_step end = CS_STEP_OK;
    bool changed;
    act(self, ADVANCE, x);
    for (uint32_t s = 1; s <= steps && end == CS_STEP_OK; s++) {
        host->force(host->ctx, t0 + (s - 1) * h, x, v, CS_PART_ALL, self->f);
        for (uint32_t k = 0; k < 3 * n; k++) {
            v[k] += h * self->f[k] * host->view->inv_mass[k % n];
            x[k] += h * v[k];
        }
        end = host->commit(host->ctx, s < steps ? t0 + s * h : t1, h, x, v, &changed);
    }
    return end;
}

static void stats(const void *object, struct cs_stats *out) {
    struct hostile *self = (struct hostile *)(uintptr_t)object;
    (void)out;
    act(self, STATS, self->f);
}

static void destroy(void *object) {
    struct hostile *self = object;
    act(self, DESTROY, self->f);
}

static const struct cs_integrator hostile = {
    .size = sizeof hostile,
    .name = "hostile",
    .summary = "symplectic Euler that does one thing to its process",
    .source = "tests",
    .order = 1,
    .order_damped = 1,
    .fidelity = CS_FIDELITY_ODE,
    .options = rows,
    .n_options = sizeof rows / sizeof *rows,
    .options_size = sizeof(struct options),
    .create = create,
    .restart = restart,
    .advance = advance,
    .stats = stats,
    .destroy = destroy,
};
static const struct cs_integrator *const all[] = {&hostile};
CS_EXPORT const struct cs_module clothsim_module = {
    .abi = CS_ABI, .size = sizeof hostile, .n = 1, .integrators = all};
