/* SPDX-License-Identifier: MIT */
/* The explicit midpoint method of template.c in C++17, to start a module of your own from. Its
 * bits are those of template.c, where the steps are explained.
 *
 *   c++ -std=c++17 -O2 -shared -fPIC $(pkg-config --cflags clothsim) -o template.so
 * template.cpp clothsim run SCENE.json --plugin ./template.so --integrator midpoint:dt=0.0005
 *
 * No exception may leave a call of the host: memory comes from host->alloc, never from new.
 * Manual: clothsim-integrator(7).
 */
#include <clothsim/driver.h>

namespace {

struct options {
    double dt;
};

const cs_option rows[] = {
    CS_OPTION(options, dt, "s", 0.0005, 0, 1, "maximum step; 0: by the bounds of the state"),
};

/* The method's object: the driver, then everything that the method remembers. */
struct midpoint : cs_driver {
    double *f;      /* (3,n) force in N */
    double *middle; /* (6n) the state half a step on: x, then v */

    /* out = y + h (velocity, f/m), where y and out are positions followed by velocities. */
    void move(double h, const double *y, const double *velocity, double *out) const {
        const cs_view &view = *host->view;
        const size_t n = view.n;
        for (size_t k = 0; k < 3 * n; k++) {
            out[k] = y[k] + h * velocity[k];
            out[3 * n + k] = y[3 * n + k] + h * f[k] * view.inv_mass[k % n];
        }
    }
};

cs_step step(cs_driver *driver, double t, double h, double *x, double *v) {
    auto self = static_cast<midpoint *>(driver);
    const cs_host *host = self->host;
    double *vm = self->middle + 3 * static_cast<size_t>(host->view->n);
    host->force(host->ctx, t, x, v, CS_PART_ALL, self->f);
    self->move(h / 2, x, v, self->middle);
    host->force(host->ctx, t + h / 2, self->middle, vm, CS_PART_ALL, self->f);
    self->move(h, x, vm, x);
    return CS_STEP_OK;
}

double limit(const cs_driver *, double omega, double delta) {
    return 1 / (10 * omega + delta);
}

double *array(const cs_host *host, size_t rows) {
    return static_cast<double *>(host->alloc(host->ctx, rows * host->view->n * sizeof(double)));
}

cs_step create(const cs_host *host, const void *given, void **out) {
    auto self = static_cast<midpoint *>(host->alloc(host->ctx, sizeof(midpoint)));
    if (!self)
        return CS_STEP_FAIL;
    *out = self;
    self->step = step;
    self->limit = limit;
    self->f = array(host, 3);
    self->middle = array(host, 6);
    if (!self->f || !self->middle)
        return CS_STEP_FAIL;
    return cs_driver_init(self, host, static_cast<const options *>(given)->dt);
}

/* The claims of the method, which `clothsim conform` measures. */
const cs_integrator method = [] {
    cs_integrator made{};
    made.size = sizeof made;
    made.name = "midpoint";
    made.summary = "explicit midpoint method";
    made.source = "C. Runge, Mathematische Annalen 46 (1895)";
    made.order = made.order_damped = 2;
    made.fidelity = CS_FIDELITY_ODE;
    made.options = rows;
    made.n_options = sizeof rows / sizeof rows[0];
    made.options_size = sizeof(options);
    made.create = create;
    made.needs = CS_NEED_BOUNDS;
    made.restart = cs_driver_restart;
    made.advance = cs_driver_advance;
    made.stats = cs_driver_stats;
    made.save = made.load = cs_driver_archive;
    return made;
}();

const cs_integrator *const integrators[] = {&method};

} // namespace

CS_EXPORT const cs_module clothsim_module = {CS_ABI, sizeof(cs_integrator), 1, integrators};
