/* former.c - symplectic Euler as a module of the time before calls of the contract were
 * renamed: it knows former.h alone, and takes the steps of planted.c with NOTHING_WRONG. */
#include "former.h"

#include <math.h>
#include <string.h>

struct former {
    const struct cs_host *host;
    double dt, h;
    double *f, *x, *v; /* (3,n) in N; the state that is stepped */
    double *before;    /* (6,n) */
};

static const struct cs_option rows[] = {{.name = "dt",
                                         .unit = "s",
                                         .help = "longest step",
                                         .type = CS_REAL,
                                         .count = 1,
                                         .def = 1e-3,
                                         .min = 1e-9,
                                         .max = 10}};

static enum cs_step create(const struct cs_host *host, const void *options, void **out) {
    const size_t length = 3 * (size_t)host->view->n;
    struct former *self = host->alloc(host->ctx, sizeof *self);
    double *arrays = host->alloc(host->ctx, 3 * length * sizeof *arrays);
    // each of these calls has another name now
    if (!self || !arrays || !CS_HAS(host->vector, share) || !CS_HAS(host, max_share))
        return CS_STEP_FAIL;
    *self = (struct former){
        .host = host, .dt = *(const double *)options, .f = arrays, .before = arrays + length};
    *out = self;
    return CS_STEP_OK;
}

static enum cs_step restart(void *self, double t, const double *x, const double *v) {
    (void)self, (void)t, (void)x, (void)v;
    return CS_STEP_OK;
}

/* The numbers from begin to end of a step, on any thread. */
static void move(void *arg, size_t begin, size_t end) {
    struct former *self = arg;
    const struct cs_view *view = self->host->view;
    for (size_t k = begin; k < end; k++) {
        self->v[k] += self->h * self->f[k] * view->inv_mass[k % view->n];
        self->x[k] += self->h * self->v[k];
    }
}

static void step(struct former *self, double t, double h, double *x, double *v) {
    const struct cs_host *host = self->host;
    host->force(host->ctx, t, x, v, CS_PART_ALL, self->f);
    self->h = h;
    self->x = x;
    self->v = v;
    host->vector->share(3 * (size_t)host->view->n, move, self);
}

static enum cs_step advance(void *object, double t0, double t1, double *x, double *v) {
    struct former *self = object;
    const struct cs_host *host = self->host;
    const double n = ceil((t1 - t0) / self->dt * (1 - 1e-9)), h = (t1 - t0) / n;
    enum cs_step status = CS_STEP_OK;
    bool changed;
    for (double i = 0; i < n && status == CS_STEP_OK; i++) {
        const double t = t0 + i * h, end = i + 1 < n ? t0 + (i + 1) * h : t1;
        memcpy(self->before, x, 3 * sizeof *x * host->view->n);
        step(self, t, h, x, v);
        if (host->max_share && host->max_share(host->ctx, t, self->before, end, x) < 1)
            return host->fail(host->ctx, "a step that would pass through a surface");
        status = host->commit(host->ctx, end, h, x, v, &changed);
    }
    return status;
}

/* no step is made shorter here */
static const char *const fails[] = {"crossing", NULL};

static const struct cs_integrator former = {.size = sizeof former,
                                            .name = "former",
                                            .summary = "symplectic Euler of an earlier release",
                                            .source = "tests",
                                            .order = 1,
                                            .order_damped = 1,
                                            .traits = CS_SYMPLECTIC,
                                            .fidelity = CS_FIDELITY_ODE,
                                            .fails = fails,
                                            .options = rows,
                                            .n_options = 1,
                                            .options_size = sizeof(double),
                                            .create = create,
                                            .restart = restart,
                                            .advance = advance};

static const struct cs_integrator *const all[] = {&former};

__attribute__((visibility("default"))) extern const struct cs_module clothsim_module;
const struct cs_module clothsim_module = {CS_ABI, sizeof former, 1, all};
