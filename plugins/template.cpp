/* SPDX-License-Identifier: MIT */
/* The explicit midpoint method of template.c in C++17, to start a module of your own from. Its
 * bits are those of template.c, where the steps are explained.
 *
 *   c++ -std=c++17 -O2 -shared -fPIC $(pkg-config --cflags clothsim) -o template.so template.cpp
 *   clothsim run SCENE.json --plugin ./template.so --integrator midpoint:dt=0.0005
 *
 * No exception may leave a call of the host: memory comes from host->alloc, never from new.
 * Manual: clothsim-integrator(7).
 */
#include <clothsim/integrator.h>
#include <algorithm>
#include <cmath>

namespace {

struct options {
    double dt;
};

const cs_option rows[] = {
    CS_OPTION(options, dt, "s", 0.0005, 1e-9, 1, "maximum step"),
};

/* The method's object: everything it remembers. */
struct midpoint {
    const cs_host *host;
    double dt;
    double *f;      /* (3,n) force in N */
    double *middle; /* (6n) the state half a step on: x, then v */
    double *before; /* (6n) the state before a step */

    /* out = y + h (velocity, f/m), where y and out are positions followed by velocities. */
    void move(double h, const double *y, const double *velocity, double *out) const {
        const cs_view &view = *host->view;
        const size_t n = view.n;
        for (size_t k = 0; k < 3 * n; k++) {
            out[k] = y[k] + h * velocity[k];
            out[3 * n + k] = y[3 * n + k] + h * f[k] * view.inv_mass[k % n];
        }
    }

    void step(double t, double h, double *x, double *v) const {
        double *vm = middle + 3 * static_cast<size_t>(host->view->n);
        host->force(host->ctx, t, x, v, CS_PART_ALL, f);
        move(h / 2, x, v, middle);
        host->force(host->ctx, t + h / 2, middle, vm, CS_PART_ALL, f);
        move(h, x, vm, x);
    }

    /* True if contact by force or a crossing asks for a shorter step than that to x1. */
    bool is_refused(double t, double h, const double *x1) const {
        return CS_HAS(host, max_step_fraction) && host->max_step_fraction &&
               host->max_step_fraction(host->ctx, t, before, t + h, x1) < 1;
    }

    /* One step from t to `end`, with its commit; a refused one as two halves. */
    cs_step take_step(double t, double h, double end, double *x, double *v) const {
        const size_t size = 6 * static_cast<size_t>(host->view->n);
        std::copy_n(x, size, before); // v follows x
        move(h, x, v, middle);
        bool refused = is_refused(t, h, middle), changed;
        if (!refused) {
            step(t, h, x, v);
            refused = is_refused(t, h, x);
        }
        if (!refused)
            return host->commit(host->ctx, end, h, x, v, &changed);
        std::copy_n(before, size, x);
        if (h < dt / 65536)
            return host->fail(host->ctx, "no step at t = %.9g s passes contact", t);
        const cs_step status = take_step(t, h / 2, t + h / 2, x, v);
        return status == CS_STEP_OK ? take_step(t + h / 2, h / 2, end, x, v) : status;
    }

    /* From t0 to exactly t1, in equal steps not longer than dt. */
    cs_step advance(double t0, double t1, double *x, double *v) const {
        const double n = std::ceil((t1 - t0) / dt * (1 - 1e-9)), h = (t1 - t0) / n;
        cs_step status = CS_STEP_OK;
        for (double i = 0; i < n && status == CS_STEP_OK; i++)
            status = take_step(t0 + i * h, h, i + 1 < n ? t0 + (i + 1) * h : t1, x, v);
        return status;
    }
};

double *array(const cs_host *host, size_t rows) {
    return static_cast<double *>(
        host->alloc(host->ctx, rows * host->view->n * sizeof(double)));
}

cs_step create(const cs_host *host, const void *given, void **out) {
    auto self = static_cast<midpoint *>(host->alloc(host->ctx, sizeof(midpoint)));
    if (!self)
        return CS_STEP_FAIL;
    *out = self;
    self->host = host;
    self->dt = static_cast<const options *>(given)->dt;
    self->f = array(host, 3);
    self->middle = array(host, 6);
    self->before = array(host, 6);
    return self->f && self->middle && self->before ? CS_STEP_OK : CS_STEP_FAIL;
}

cs_step restart(void *, double, const double *, const double *) { return CS_STEP_OK; }

cs_step advance(void *self, double t0, double t1, double *x, double *v) {
    return static_cast<midpoint *>(self)->advance(t0, t1, x, v);
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
    made.restart = restart;
    made.advance = advance;
    return made;
}();

const cs_integrator *const integrators[] = {&method};

} // namespace

CS_EXPORT const cs_module clothsim_module = {CS_ABI, sizeof(cs_integrator), 1, integrators};
