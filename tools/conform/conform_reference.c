/* The reference method of conformance checks (Kutta 1901).
 *
 * For y = (x, v) and F(t, y) = (v, M^-1 f(t, x, v)), four stages
 *   k_i = F(t + c_i h, y + c_i h k_(i-1)),  c = 0, 1/2, 1/2, 1,
 *   y' = y + h/6 (k_1 + 2 k_2 + 2 k_3 + k_4).
 * The module interface is used as a plugin would use it: memory in create, one commit per step.
 * Steps divide an advance equally and are at most dt. */
#include "conform/conform_checks.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* One reference; the newest is first in the list. */
struct cs_conform_cached {
    struct cs_conform_cached *next;
    char name[64];
    size_t n;
    double values[];
};

const double *cs_conform_cache_find(const struct cs_conform_cache *cache, const char *name,
                                    size_t n) {
    for (const struct cs_conform_cached *cached = cache ? cache->first : NULL; cached;
         cached = cached->next)
        if (cached->n == n && !strcmp(cached->name, name))
            return cached->values;
    return NULL;
}

void cs_conform_cache_store(struct cs_conform_cache *cache, const char *name,
                            const double *values, size_t n) {
    struct cs_conform_cached *cached = NULL;
    // a truncated name could match another one
    if (cache && strlen(name) < sizeof cached->name)
        cached = malloc(sizeof *cached + n * sizeof *values);
    if (!cached)
        return;
    strcpy(cached->name, name);
    cached->n = n;
    memcpy(cached->values, values, n * sizeof *values);
    cached->next = cache->first;
    cache->first = cached;
}

void cs_conform_cache_finish(struct cs_conform_cache *cache) {
    for (struct cs_conform_cached *cached = cache->first; cached;) {
        struct cs_conform_cached *next = cached->next;
        free(cached);
        cached = next;
    }
    cache->first = NULL;
}

/* s */
struct options {
    double dt;
};

/* State of the method: no history, hence restart has nothing to do. */
struct reference {
    const struct cs_host *host;
    double dt;
    double *stage, *slope, *sum; /* (6n): a stage's state, its derivative, their sum */
};

static const struct cs_option rows[] = {
    CS_OPTION(struct options, dt, "s", 1e-4, 1e-9, 1, "longest step"),
};

static enum cs_step create(const struct cs_host *host, const void *options, void **out) {
    const size_t bytes = 6 * sizeof(double) * host->view->n;
    struct reference *self = host->alloc(host->ctx, sizeof *self);
    if (!self)
        return CS_STEP_FAIL;
    *out = self;
    self->host = host;
    self->dt = ((const struct options *)options)->dt;
    self->stage = host->alloc(host->ctx, bytes);
    self->slope = host->alloc(host->ctx, bytes);
    self->sum = host->alloc(host->ctx, bytes);
    return self->stage && self->slope && self->sum ? CS_STEP_OK : CS_STEP_FAIL;
}

static enum cs_step restart(void *self, double t, const double *x, const double *v) {
    (void)self, (void)t, (void)x, (void)v;
    return CS_STEP_OK;
}

/* slope = F(t, y); y and slope are (2, 3, n), positions or their rates first. */
static void evaluate(struct reference *self, double t, const double *y) {
    const struct cs_host *host = self->host;
    const size_t n = host->view->n, half = 3 * n;
    host->force(host->ctx, t, y, y + half, CS_PART_ALL, self->slope + half);
    for (size_t i = 0; i < half; i++) {
        self->slope[i] = y[half + i];
        self->slope[half + i] *= host->view->inv_mass[i % n];
    }
}

/* One step from t: the slope of the last stage is reused in place, the weighted sum
 * accumulates. */
static void step(struct reference *self, double t, double h, double *y) {
    static const double places[4] = {0, 0.5, 0.5, 1}, weights[4] = {1, 2, 2, 1};
    const size_t length = 6 * (size_t)self->host->view->n;
    for (int k = 0; k < 4; k++) {
        for (size_t i = 0; i < length; i++)
            self->stage[i] = k ? y[i] + places[k] * h * self->slope[i] : y[i];
        evaluate(self, t + places[k] * h, self->stage);
        for (size_t i = 0; i < length; i++)
            self->sum[i] = (k ? self->sum[i] : 0) + weights[k] * self->slope[i];
    }
    for (size_t i = 0; i < length; i++)
        y[i] += h / 6 * self->sum[i];
}

/* x and v are adjacent in memory, so one array y of 6n values serves both. */
static enum cs_step advance(void *object, double t0, double t1, double *x, double *v) {
    (void)v; // is x + 3n
    struct reference *self = object;
    const double n = ceil((t1 - t0) / self->dt * (1 - 1e-9)), h = (t1 - t0) / n;
    enum cs_step status = CS_STEP_OK;
    for (double i = 0; i < n && status == CS_STEP_OK; i++) {
        bool changed;
        step(self, t0 + i * h, h, x);
        status = self->host->commit(self->host->ctx, i + 1 < n ? t0 + (i + 1) * h : t1, h, x, v,
                                    &changed);
    }
    return status;
}

const struct cs_integrator cs_conform_reference = {
    .size = sizeof(struct cs_integrator),
    .name = "conform-reference",
    .summary = "classical Runge-Kutta method, for tiny steps",
    .source = "Kutta 1901",
    .order = 4,
    .order_damped = 4,
    .options = rows,
    .n_options = sizeof rows / sizeof *rows,
    .options_size = sizeof(struct options),
    .create = create,
    .restart = restart,
    .advance = advance,
};
