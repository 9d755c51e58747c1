/* SPDX-License-Identifier: MIT */
/* Explicit midpoint method, to start an integrator module of your own from.
 *
 *   x_m = x + h/2 v,  v_m = v + h/2 f(t, x, v)/m
 *   x'  = x + h v_m,  v'  = v + h f(t + h/2, x_m, v_m)/m       (Runge 1895)
 *
 * The loop of steps, halving of refused steps, commits, counts and checkpoints are those of
 * <clothsim/driver.h>. A method with a loop of its own copies what it needs from there.
 *
 * Build it against the installed header, look at it, run it, and get its card:
 *   cc -std=c17 -O2 -shared -fPIC $(pkg-config --cflags clothsim) -o template.so template.c -lm
 *   clothsim integrators --plugin ./template.so midpoint
 *   clothsim run SCENE.json --plugin ./template.so --integrator midpoint:dt=0.0005
 *   clothsim conform ./template.so
 * Manual: clothsim-integrator(7).
 */
#include <clothsim/driver.h>

/* The options and their table: type, unit, default, range, meaning. A method of fixed
 * steps calls its step dt, an adaptive one its tolerance rtol: the card sets them by these
 * names. */
struct options {
    double dt;
};

static const struct cs_option rows[] = {
    CS_OPTION(struct options, dt, "s", 0.0005, 0, 1,
              "maximum step; 0: by the bounds of the state"),
};

/* The method's object: the driver first, then everything that the method remembers. */
struct midpoint {
    struct cs_driver driver;
    double *f;      /* (3,n) force in N */
    double *middle; /* (6n) the state half a step on: x, then v */
};

/* out = y + h (velocity, f/m), where y and out are positions followed by velocities. A
 * pinned particle has f = 0 and 1/m = 0, and needs no case of its own. */
static void move(const struct midpoint *self, double h, const double *y, const double *velocity,
                 double *out) {
    const struct cs_view *view = self->driver.host->view;
    const size_t n = view->n;
    for (size_t c = 0; c < 3; c++)
        for (size_t i = 0, k = c * n; i < n; i++, k++) {
            out[k] = y[k] + h * velocity[k];
            out[3 * n + k] = y[3 * n + k] + h * self->f[k] * view->inv_mass[i];
        }
}

static enum cs_step step(struct cs_driver *driver, double t, double h, double *x, double *v) {
    struct midpoint *self = (struct midpoint *)driver;
    const struct cs_host *host = driver->host;
    double *xm = self->middle, *vm = xm + 3 * (size_t)host->view->n;
    host->force(host->ctx, t, x, v, CS_PART_ALL, self->f);
    move(self, h / 2, x, v, xm);
    host->force(host->ctx, t + h / 2, xm, vm, CS_PART_ALL, self->f);
    move(self, h, x, vm, x);
    return CS_STEP_OK;
}

/* Within |1 + z + z z/2| <= 1 for z = h (-delta +- sqrt(delta^2 - omega^2)): by damping h is at
 * most 1/delta. Without damping the method gains (h omega)^4 / 8 of the amplitude a step:
 * 0.1/omega. */
static double limit(const struct cs_driver *self, double omega, double delta) {
    (void)self;
    return 1 / (10 * omega + delta);
}

/* All memory is taken here. What host->alloc gives is zeroed and freed by the host; NULL was
 * reported already. The options are gone after the call: copy what is needed. */
static enum cs_step create(const struct cs_host *host, const void *options, void **out) {
    const size_t bytes = 3 * sizeof(double) * (size_t)host->view->n;
    struct midpoint *self = host->alloc(host->ctx, sizeof *self);
    if (!self)
        return CS_STEP_FAIL;
    *out = self;
    self->driver.step = step;
    self->driver.limit = limit;
    self->f = host->alloc(host->ctx, bytes);
    self->middle = host->alloc(host->ctx, 2 * bytes);
    if (!self->f || !self->middle)
        return CS_STEP_FAIL;
    return cs_driver_init(&self->driver, host, ((const struct options *)options)->dt);
}

/* The claims of the method, which `clothsim conform` measures. */
static const struct cs_integrator midpoint = {
    .size = sizeof midpoint,
    .name = "midpoint",
    .summary = "explicit midpoint method",
    .source = "C. Runge, Mathematische Annalen 46 (1895)",
    .order = 2,
    .order_damped = 2,
    .needs =
        CS_NEED_BOUNDS, /* of the driver with dt = 0; CS_NEED_JVP and others ask for more */
    .traits = 0,        /* CS_IMPLICIT, CS_ADAPTIVE, CS_SYMPLECTIC, ... */
    .fidelity = CS_FIDELITY_ODE,
    .fails = NULL, /* names of the checks that it is known to fail, closed by NULL */
    .options = rows,
    .n_options = sizeof rows / sizeof rows[0],
    .options_size = sizeof(struct options),
    .create = create,
    .restart = cs_driver_restart,
    .advance = cs_driver_advance,
    .stats = cs_driver_stats,
    .save = cs_driver_archive,
    .load = cs_driver_archive,
};

static const struct cs_integrator *const integrators[] = {&midpoint};

CS_EXPORT const struct cs_module clothsim_module = {
    .abi = CS_ABI,
    .size = sizeof(struct cs_integrator),
    .n = sizeof integrators / sizeof integrators[0],
    .integrators = integrators,
};
