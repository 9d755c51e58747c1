/* order8.c - a correct method of order 8 with error control, whose card must pass.
 *
 * Extrapolation of the explicit midpoint rule (Gragg 1965; Hairer, Norsett, Wanner 1993, II.9).
 * With y = (x, v) and F(t, y) = (v, M^-1 f(t, x, v)), a step h is made of n = 2, 4, 6, 8 parts
 * s = h/n,
 *   y_1 = y_0 + s F(t, y_0),   y_(k+1) = y_(k-1) + 2 s F(t + k s, y_k),   T_(j,1) = y_n,
 * whose error has even powers of s alone, so that
 *   T_(j,k+1) = T_(j,k) + (T_(j,k) - T_(j-1,k)) / ((n_j / n_(j-k))^2 - 1)
 * has order 2 k + 2: T_(4,4) has 8, and its distance from T_(4,3) is the error of the latter.
 */
#include <clothsim/integrator.h>
#include <math.h>
#include <string.h>

/* The variants: fewer columns, which claim an order that they do not have; no option dt; steps
 * of CAP at most, as if stability limited them. */
#ifndef COLUMNS
#define COLUMNS 4
#endif
#ifndef CAP
#define CAP HUGE_VAL
#endif

enum { TRIES = 60 };

struct options {
    double rtol, dt;
};

static const struct cs_option rows[] = {
    CS_OPTION(struct options, rtol, "", 1e-6, 1e-14, 0.1, "local error, in m and m/s"),
#ifndef NO_DT
    CS_OPTION(struct options, dt, "s", 0, 0, 1,
              "maximum step without error control; 0: with it"),
#endif
};

struct method {
    const struct cs_host *host;
    struct options asked;
    double h;                       /* s, the next step; 0: none is known */
    double *slope, *before, *after; /* (6n) each */
    double *column[COLUMNS];        /* (6n) each: T_(j,1), then T_(j,k) */
};

static enum cs_step create(const struct cs_host *host, const void *options, void **out) {
    const size_t length = 6 * (size_t)host->view->n;
    struct method *self = host->alloc(host->ctx, sizeof *self);
    double *memory = host->alloc(host->ctx, (COLUMNS + 3) * length * sizeof *memory);
    if (!self || !memory)
        return CS_STEP_FAIL;
    *out = self;
    self->host = host;
    memcpy(&self->asked, options, sizeof self->asked);
#ifdef NO_DT
    self->asked.dt = 0;
#endif
    self->slope = memory;
    self->before = memory + length;
    self->after = memory + 2 * length;
    for (int j = 0; j < COLUMNS; j++)
        self->column[j] = memory + (3 + j) * length;
    return CS_STEP_OK;
}

static enum cs_step restart(void *object, double t, const double *x, const double *v) {
    struct method *self = object;
    (void)t, (void)x, (void)v;
    self->h = 0;
    return CS_STEP_OK;
}

/* z = y + s F(t, at) */
static void add_slope(struct method *self, double t, const double *at, double s,
                      const double *y, double *z) {
    const struct cs_host *host = self->host;
    const size_t n = host->view->n;
    host->force(host->ctx, t, at, at + 3 * n, CS_PART_ALL, self->slope);
    for (size_t i = 0; i < 3 * n; i++) {
        const double velocity = at[3 * n + i];
        z[i] = y[i] + s * velocity;
        z[3 * n + i] = y[3 * n + i] + s * (self->slope[i] * host->view->inv_mass[i % n]);
    }
}

/* out = y_parts of the explicit midpoint rule; parts is even. */
static void midpoint(struct method *self, double t, double h, int parts, const double *y,
                     double *out) {
    const size_t bytes = 6 * sizeof *y * self->host->view->n;
    const double s = h / parts;
    double *even = self->before, *odd = self->after;
    memcpy(even, y, bytes);
    add_slope(self, t, even, s, even, odd);
    for (int k = 1; k < parts; k++) {
        double *const next = k % 2 ? even : odd, *const at = k % 2 ? odd : even;
        add_slope(self, t + k * s, at, 2 * s, next, next);
    }
    memcpy(out, even, bytes);
}

/* self->column[COLUMNS - 1] = the step from y; returns the error in units of rtol. */
static double step(struct method *self, double t, double h, const double *y) {
    const size_t length = 6 * (size_t)self->host->view->n;
    double sum = 0;
    for (int j = 0; j < COLUMNS; j++)
        midpoint(self, t, h, 2 * (j + 1), y, self->column[j]);
    for (int k = 1; k < COLUMNS; k++)
        for (int j = COLUMNS - 1; j >= k; j--) {
            const double ratio = (j + 1.0) / (j - k + 1), scale = 1 / (ratio * ratio - 1);
            for (size_t i = 0; i < length; i++) {
                const double change = scale * (self->column[j][i] - self->column[j - 1][i]);
                self->column[j][i] += change;
                if (k == COLUMNS - 1)
                    sum += change * change;
            }
        }
    return sqrt(sum / (double)length) / self->asked.rtol;
}

/* True if the step may not be taken whole: it would pass through a surface. */
static bool passes_through(const struct method *self, double t, double h, const double *x,
                           const double *v) {
    const struct cs_host *host = self->host;
    double *const straight = self->before;
    if (!CS_HAS(host, max_step_fraction) || !host->max_step_fraction)
        return false;
    for (size_t i = 0; i < 3 * (size_t)host->view->n; i++)
        straight[i] = x[i] + h * v[i];
    return host->max_step_fraction(host->ctx, t, x, t + h, straight) < 1 ||
           host->max_step_fraction(host->ctx, t, x, t + h, self->column[COLUMNS - 1]) < 1;
}

static enum cs_step advance(void *object, double t0, double t1, double *x, double *v) {
    struct method *self = object;
    const struct cs_host *host = self->host;
    const double dt = self->asked.dt;
    int tries = 0;
    for (double t = t0; t < t1;) {
        const double largest = dt > 0 ? dt : CAP;
        const double longest = (t1 - t) / ceil(fmax((t1 - t) / largest * (1 - 1e-9), 0.5));
        const bool is_cut = self->h > 0 && self->h < longest;
        const double h = is_cut ? fmin(self->h, longest / 2) : longest;
        const double error = step(self, t, h, x);
        const double factor = dt > 0 ? 1e9 : fmin(4, fmax(0.2, 0.9 * pow(error, -1.0 / 7)));
        const bool through = isfinite(error) && passes_through(self, t, h, x, v);
        if (!isfinite(error) || (error > 1 && !(dt > 0)) || through) {
            self->h = h * (through ? 0.5 : isfinite(factor) ? fmin(factor, 0.9) : 0.2);
            if (++tries > TRIES)
                return host->fail(host->ctx, "a step was refused %d times", tries);
            continue;
        }
        bool changed;
        tries = 0;
        self->h = is_cut || !(self->h > 0) ? h * factor : fmax(self->h, h * factor);
        t = is_cut ? t + h : h < t1 - t ? t + h : t1;
        memcpy(x, self->column[COLUMNS - 1], 6 * sizeof *x * host->view->n);
        const enum cs_step status = host->commit(host->ctx, t, h, x, v, &changed);
        if (status != CS_STEP_OK)
            return status;
    }
    return CS_STEP_OK;
}

static const struct cs_integrator order8 = {
    .size = sizeof order8,
    .name = NAME,
    .summary = "extrapolated midpoint rule of order 8",
    .source = "Gragg 1965",
    .order = 8,
    .order_damped = 8,
    .traits = CS_ADAPTIVE,
    .fidelity = CS_FIDELITY_ODE,
    .options = rows,
    .n_options = sizeof rows / sizeof *rows,
    .options_size = sizeof(struct options),
    .create = create,
    .restart = restart,
    .advance = advance,
};
static const struct cs_integrator *const all[] = {&order8};
CS_EXPORT const struct cs_module clothsim_module = {
    .abi = CS_ABI, .size = sizeof order8, .n = 1, .integrators = all};
