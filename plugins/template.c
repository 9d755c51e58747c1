/* SPDX-License-Identifier: MIT */
/* Explicit midpoint method, to start an integrator module of your own from.
 *
 *   x_m = x + h/2 v,  v_m = v + h/2 f(t, x, v)/m
 *   x'  = x + h v_m,  v'  = v + h f(t + h/2, x_m, v_m)/m       (Runge 1895)
 *
 * Build it against the installed header, look at it, run it, and get its card:
 *   cc -std=c17 -O2 -shared -fPIC $(pkg-config --cflags clothsim) -o template.so template.c -lm
 *   clothsim integrators --plugin ./template.so midpoint
 *   clothsim run SCENE.json --plugin ./template.so --integrator midpoint:dt=0.0005
 *   clothsim conform ./template.so
 * Manual: clothsim-integrator(7).
 */
#include <clothsim/integrator.h>
#include <math.h>
#include <string.h>

/* The options and their table: type, unit, default, range, meaning. A method of fixed
 * steps calls its step dt, an adaptive one its tolerance rtol: the card sets them by these
 * names. */
struct options {
    double dt;
};

static const struct cs_option rows[] = {
    CS_OPTION(struct options, dt, "s", 0.0005, 1e-9, 1, "maximum step"),
};

/* The method's object: everything it remembers. */
struct midpoint {
    const struct cs_host *host;
    double dt;
    double *f;      /* (3,n) force in N */
    double *middle; /* (6n) the state half a step on: x, then v */
    double *before; /* (6n) the state before a step */
};

/* All memory is taken here. What host->alloc gives is zeroed and freed by the host; NULL was
 * reported already. The options are gone after the call: copy what is needed. */
static enum cs_step create(const struct cs_host *host, const void *options, void **out) {
    const size_t n = host->view->n;
    struct midpoint *self = host->alloc(host->ctx, sizeof *self);
    if (!self)
        return CS_STEP_FAIL;
    *out = self;
    self->host = host;
    self->dt = ((const struct options *)options)->dt;
    self->f = host->alloc(host->ctx, 3 * n * sizeof *self->f);
    self->middle = host->alloc(host->ctx, 6 * n * sizeof *self->middle);
    self->before = host->alloc(host->ctx, 6 * n * sizeof *self->before);
    return self->f && self->middle && self->before ? CS_STEP_OK : CS_STEP_FAIL;
}

/* The state was set from outside. A method that keeps earlier steps forgets them here; this one
 * keeps none. */
static enum cs_step restart(void *self, double t, const double *x, const double *v) {
    (void)self, (void)t, (void)x, (void)v;
    return CS_STEP_OK;
}

/* out = y + h (velocity, f/m), where y and out are positions followed by velocities. A
 * pinned particle has f = 0 and 1/m = 0, and needs no case of its own. */
static void move(const struct midpoint *self, double h, const double *y, const double *velocity,
                 double *out) {
    const struct cs_view *view = self->host->view;
    const size_t n = view->n;
    for (size_t c = 0; c < 3; c++)
        for (size_t i = 0, k = c * n; i < n; i++, k++) {
            out[k] = y[k] + h * velocity[k];
            out[3 * n + k] = y[3 * n + k] + h * self->f[k] * view->inv_mass[i];
        }
}

static void step(struct midpoint *self, double t, double h, double *x, double *v) {
    const struct cs_host *host = self->host;
    double *xm = self->middle, *vm = xm + 3 * (size_t)host->view->n;
    host->force(host->ctx, t, x, v, CS_PART_ALL, self->f);
    move(self, h / 2, x, v, xm);
    host->force(host->ctx, t + h / 2, xm, vm, CS_PART_ALL, self->f);
    move(self, h, x, vm, x);
}

/* True if the displacement to x1 would pass over contact by force that no stage sees, or carry
 * surfaces through each other. The host offers the question where the scene needs it. */
static bool is_refused(const struct midpoint *self, double t, double h, const double *x1) {
    const struct cs_host *host = self->host;
    return CS_HAS(host, max_step_fraction) && host->max_step_fraction &&
           host->max_step_fraction(host->ctx, t, self->before, t + h, x1) < 1;
}

/* A refused step is taken as two halves, and those likewise, down to this fraction of dt. */
#define SHORTEST (1 / 65536.)

/* One step from t to `end`, which is t + h up to rounding, with its commit. Two displacements
 * are judged: that of the step, and that without forces, since a step that enters contact and
 * leaves it again ends outside. */
static enum cs_step take_step(struct midpoint *self, double t, double h, double end, double *x,
                              double *v) {
    const struct cs_host *host = self->host;
    const size_t bytes = 6 * host->view->n * sizeof *x; /* v follows x */
    memcpy(self->before, x, bytes);
    move(self, h, x, v, self->middle);
    bool refused = is_refused(self, t, h, self->middle), changed;
    if (!refused) {
        step(self, t, h, x, v);
        refused = is_refused(self, t, h, x);
    }
    if (!refused)
        // contact, strain limit, blow-up: return anything but CS_STEP_OK at once; if
        // changed is true a method with a history restarts
        return host->commit(host->ctx, end, h, x, v, &changed);

    memcpy(x, self->before, bytes);
    if (h < SHORTEST * self->dt)
        return host->fail(host->ctx,
                          "a step of %.3g s at t = %.9g s still misses contact or crosses a "
                          "surface",
                          h, t);
    const enum cs_step status = take_step(self, t, h / 2, t + h / 2, x, v);
    return status == CS_STEP_OK ? take_step(self, t + h / 2, h / 2, end, x, v) : status;
}

/* From t0 to exactly t1, in equal steps not longer than dt. */
static enum cs_step advance(void *object, double t0, double t1, double *x, double *v) {
    struct midpoint *self = object;
    // a dt that fits is not spoilt by the rounding of t1 - t0
    const double n = ceil((t1 - t0) / self->dt * (1 - 1e-9)), h = (t1 - t0) / n;
    enum cs_step status = CS_STEP_OK;
    for (double i = 0; i < n && status == CS_STEP_OK; i++)
        status = take_step(self, t0 + i * h, h, i + 1 < n ? t0 + (i + 1) * h : t1, x, v);
    return status;
}

/* The claims of the method, which `clothsim conform` measures. */
static const struct cs_integrator midpoint = {
    .size = sizeof midpoint,
    .name = "midpoint",
    .summary = "explicit midpoint method",
    .source = "C. Runge, Mathematische Annalen 46 (1895)",
    .order = 2,
    .order_damped = 2,
    .needs = 0,  /* only the force; CS_NEED_JVP, CS_NEED_SOLVE and others ask for more */
    .traits = 0, /* CS_IMPLICIT, CS_ADAPTIVE, CS_SYMPLECTIC, ... */
    .fidelity = CS_FIDELITY_ODE,
    .fails = NULL, /* names of the checks that it is known to fail, closed by NULL */
    .options = rows,
    .n_options = sizeof rows / sizeof rows[0],
    .options_size = sizeof(struct options),
    .create = create,
    .restart = restart,
    .advance = advance,
};

static const struct cs_integrator *const integrators[] = {&midpoint};

CS_EXPORT const struct cs_module clothsim_module = {
    .abi = CS_ABI,
    .size = sizeof(struct cs_integrator),
    .n = sizeof integrators / sizeof integrators[0],
    .integrators = integrators,
};
