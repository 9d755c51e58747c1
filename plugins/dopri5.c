/* dopri5.c - the explicit pair 5(4) of Dormand and Prince with error control.
 *
 * With y = (x, v), F = (v, f/m): k_i = F(t + c_i h, y + h sum_j a_ij k_j), y' = y + h sum_j
 * a_7j k_j of order 5, and h sum_j e_j k_j is its distance from the method of order 4. The
 * last stage is evaluated at the new state: it is the first of the next step, unless the
 * state was changed. The last steps before a frame are cut so that one ends there.
 *
 * Error norm: the root of the mean, over the numbers that move, of (error / (atol + rtol
 * |y|))^2, |y| the larger of both ends. A step is accepted at 1 or below.
 *
 * Coefficients: Dormand, Prince 1980; Hairer, Norsett, Wanner 1993, table II.5.2. */
#include "step_control.h"

#include <clothsim/integrator.h>
#include <float.h>

enum { STAGES = 7, BLOCK = 512 };

// clang-format off
static const double nodes[STAGES] = {0, 1.0 / 5, 3.0 / 10, 4.0 / 5, 8.0 / 9, 1, 1};
static const double table[STAGES][STAGES - 1] = {
    {0},
    {1.0 / 5},
    {3.0 / 40, 9.0 / 40},
    {44.0 / 45, -56.0 / 15, 32.0 / 9},
    {19372.0 / 6561, -25360.0 / 2187, 64448.0 / 6561, -212.0 / 729},
    {9017.0 / 3168, -355.0 / 33, 46732.0 / 5247, 49.0 / 176, -5103.0 / 18656},
    {35.0 / 384, 0, 500.0 / 1113, 125.0 / 192, -2187.0 / 6784, 11.0 / 84},
};
static const double difference[STAGES] = {
    71.0 / 57600, 0, -71.0 / 16695, 71.0 / 1920, -17253.0 / 339200, 22.0 / 525, -1.0 / 40};
// clang-format on

struct dopri5_options {
    double rtol, atol, dt_max;
    int64_t max_steps;
};

static const struct cs_option rows[] = {
    CS_OPTION(struct dopri5_options, rtol, "", 1e-4, 1e-14, 0.1,
              "local error of a step, relative to the value"),
    CS_OPTION(struct dopri5_options, atol, "", 0, 0, 1,
              "absolute local error in m and m/s; 0: rtol of 1 m and 1 m/s"),
    CS_OPTION(struct dopri5_options, dt_max, "s", 0, 0, 10, "maximum step; 0: one frame"),
    CS_OPTION(struct dopri5_options, max_steps, "", 1000000, 1, 1e9,
              "maximum steps per frame, rejected ones included, before the run fails"),
};

struct dopri5 {
    const struct cs_host *host;
    struct dopri5_options asked;
    struct step_control control;
    size_t length;     /* 6n */
    double free;       /* values that move, at least 1 */
    double *k[STAGES]; /* (6n) each */
    double *next;      /* (6n): the state of a stage, then the new one */
    double *error;     /* (6n) */
    double *weight;    /* (6n): 1 / tolerance */
    bool fresh;        /* k[0] is not that of the state */
    bool started;      /* control.h was chosen */
    uint64_t rejected;
};

/* k (6n) = F(t, y). */
static void slope(struct dopri5 *self, double t, const double *y, double *k) {
    const struct cs_host *host = self->host;
    const size_t n = host->view->n;
    host->force(host->ctx, t, y, y + 3 * n, CS_PART_ALL, k + 3 * n);
    for (size_t c = 0; c < 3; c++)
        for (size_t i = 0; i < n; i++) {
            k[c * n + i] = y[(3 + c) * n + i];
            k[(3 + c) * n + i] *= host->view->inv_mass[i];
        }
}

/* z = y + h sum of a_j k_j over the first stages, in their order; y NULL: 0. In blocks that
 * stay in the cache. */
static void combine(const struct dopri5 *self, const double *y, double h, const double *a,
                    int stages, double *z) {
    for (size_t start = 0; start < self->length; start += BLOCK) {
        const size_t end = self->length - start < BLOCK ? self->length : start + BLOCK;
        for (size_t i = start; i < end; i++)
            z[i] = y ? y[i] : 0;
        for (int j = 0; j < stages; j++) {
            const double scaled = h * a[j];
            const double *k = self->k[j];
            for (size_t i = start; i < end; i++)
                z[i] += scaled * k[i];
        }
    }
}

/* weight (6n) = 1 / tolerance of each number of a step from y to z. */
static void weighted_error(struct dopri5 *self, const double *y, const double *z) {
    const double rtol = self->asked.rtol, atol = self->asked.atol;
    for (size_t i = 0; i < self->length; i++) {
        const double size = fabs(y[i]) > fabs(z[i]) ? fabs(y[i]) : fabs(z[i]);
        self->weight[i] = 1 / (atol + rtol * size);
    }
}

/* The weighted root mean square; pinned particles do not count in the mean. */
static double norm(const struct dopri5 *self, const double *values) {
    const struct cs_vector_kernels *vector = self->host->vector;
    return sqrt(vector->weighted_sum_of_squares(self->length, values, self->weight) /
                self->free);
}

/* A first step whose explicit Euler step changes y by a hundredth, and whose term of order 5
 * would be near the tolerance (Hairer, Norsett, Wanner 1993, sec. II.4). */
static double first_step(struct dopri5 *self, double t, double span, const double *y) {
    weighted_error(self, y, y);
    const double size = norm(self, y), speed = norm(self, self->k[0]);
    double h = size < 1e-5 || speed < 1e-5 ? 1e-6 : 0.01 * size / speed;
    h = h < span ? h : span;
    combine(self, y, h, (const double[]){1}, 1, self->next);
    slope(self, t + h, self->next, self->k[1]);
    combine(self, NULL, 1, (const double[]){-1, 1}, 2, self->error);
    const double bend = norm(self, self->error) / h;
    const double largest = bend > speed ? bend : speed;
    const double other = largest > 1e-15 ? step_fifth_root(0.01 / largest) : 1000 * h;
    return other < 100 * h ? other : 100 * h;
}

/* The new state and the error of a step, in units of the tolerance. */
static double attempt(struct dopri5 *self, double t, double h, const double *y) {
    for (int i = 1; i < STAGES; i++) {
        combine(self, y, h, table[i], i, self->next);
        slope(self, t + nodes[i] * h, self->next, self->k[i]);
    }
    combine(self, NULL, h, difference, STAGES, self->error);
    weighted_error(self, y, self->next);
    return norm(self, self->error);
}

/* The length of the next step: the rest of the advance in one step, at most 0.1 % longer than
 * planned; in two equal ones if it is less than two planned steps; else the planned step. No
 * step before a frame is then much shorter than planned. */
static double cut(double planned, double left) {
    if (left <= planned * 1.001)
        return left;
    return left < 2 * planned ? left / 2 : planned;
}

/* Takes the new state, and its slope as the first stage of the next step. */
static void accept(struct dopri5 *self, double *y) {
    for (size_t i = 0; i < self->length; i++)
        y[i] = self->next[i];
    double *last = self->k[STAGES - 1];
    self->k[STAGES - 1] = self->k[0];
    self->k[0] = last;
}

static enum cs_step restart(void *object, double t, const double *x, const double *v) {
    (void)t, (void)x, (void)v;
    struct dopri5 *self = object;
    self->control = (struct step_control){0};
    self->fresh = true;
    self->started = false;
    return CS_STEP_OK;
}

/* Evaluates the slope at the state if the last stage is not it, and chooses a first step
 * after a restart. */
static void prepare(struct dopri5 *self, double t, double span, const double *y) {
    if (self->fresh)
        slope(self, t, y, self->k[0]);
    self->fresh = false;
    if (!self->started)
        self->control.h = first_step(self, t, span, y);
    self->started = true;
}

/* An error that halves the next step, nearly: 0.9 / 32^(1/5) = 0.45. */
#define ERROR_OF_HALF 32

/* True if the step passes over contact by force, or through a surface. An error estimate
 * cannot see contact that no stage lies in. */
static bool passes_contact(const struct dopri5 *self, double t, double h, const double *x) {
    const struct cs_host *host = self->host;
    return CS_HAS(host, max_step_fraction) && host->max_step_fraction &&
           host->max_step_fraction(host->ctx, t, x, t + h, self->next) < 1;
}

/* The bound in s that contact by projection sets on the next step. */
static double longest_step(const struct dopri5 *self, double t, const double *x) {
    const struct cs_host *host = self->host;
    const double *v = x + 3 * (size_t)host->view->n;
    return CS_HAS(host, longest_step) && host->longest_step
               ? host->longest_step(host->ctx, t, x, v)
               : HUGE_VAL;
}

static enum cs_step advance(void *object, double t0, double t1, double *x, double *v) {
    struct dopri5 *self = object;
    const struct cs_host *host = self->host;
    const double dt_max = self->asked.dt_max > 0 ? self->asked.dt_max : t1 - t0;
    double t = t0;
    for (int64_t tries = 0; t < t1; tries++) {
        if (tries >= self->asked.max_steps)
            return host->fail(host->ctx, "more than %lld steps from t = %.9g s to %.9g s",
                              (long long)self->asked.max_steps, t0, t);
        prepare(self, t, t1 - t, x);
        struct step_control *control = &self->control;
        control->h = control->h < dt_max ? control->h : dt_max;
        const double most = longest_step(self, t, x);
        const double h = cut(control->h < most ? control->h : most, t1 - t);
        /* a shorter step is lost in the rounding of t; NaN is refused too */
        if (!(h > 4 * DBL_EPSILON * t1))
            return host->fail(host->ctx, "the step fell to %.3g s at t = %.9g s", h, t);
        double error = attempt(self, t, h, x);
        if (error <= 1 && passes_contact(self, t, h, x))
            error = ERROR_OF_HALF;
        if (!step_control_judge(control, h, error, h < control->h)) {
            self->rejected++;
            continue;
        }
        accept(self, x);
        /* ends at t1 itself, not at a sum that rounds beside it */
        t = h < t1 - t ? t + h : t1;
        bool changed = false;
        const enum cs_step status = host->commit(host->ctx, t, h, x, v, &changed);
        self->fresh = changed;
        if (status != CS_STEP_OK)
            return status;
    }
    return CS_STEP_OK;
}

static enum cs_step create(const struct cs_host *host, const void *options, void **out) {
    struct dopri5 *self = host->alloc(host->ctx, sizeof *self);
    if (!self)
        return CS_STEP_FAIL;
    *out = self;
    self->host = host;
    self->asked = *(const struct dopri5_options *)options;
    if (self->asked.atol <= 0)
        self->asked.atol = self->asked.rtol;
    self->length = 6 * (size_t)host->view->n;
    /* pinned particles have no error: the norm is a mean over the others */
    for (size_t i = 0; i < host->view->n; i++)
        self->free += host->view->inv_mass[i] > 0 ? 6 : 0;
    self->free = self->free > 1 ? self->free : 1;

    double **const arrays[] = {&self->next, &self->error, &self->weight};
    for (int i = 0; i < STAGES + 3; i++) {
        double **array = i < STAGES ? self->k + i : arrays[i - STAGES];
        if (!(*array = host->alloc(host->ctx, self->length * sizeof **array)))
            return CS_STEP_FAIL;
    }
    return CS_STEP_OK;
}

static void stats(const void *object, struct cs_stats *out) {
    out->rejected = ((const struct dopri5 *)object)->rejected;
}

/* the slope at the state, and what the control of the step knows */
static enum cs_step archive(void *object, const struct cs_archive *archive) {
    struct dopri5 *self = object;
    struct step_control *control = &self->control;
    uint64_t marks[] = {self->fresh, self->started, control->rejected};
    archive->integers(archive->ctx, marks, 3);
    self->fresh = marks[0] != 0;
    self->started = marks[1] != 0;
    control->rejected = marks[2] != 0;
    archive->integers(archive->ctx, &self->rejected, 1);
    archive->reals(archive->ctx, &control->h, 1);
    archive->reals(archive->ctx, &control->last_error_root, 1);
    archive->reals(archive->ctx, self->k[0], self->length);
    return CS_STEP_OK;
}

static const struct cs_integrator dopri5 = {
    .size = sizeof(struct cs_integrator),
    .name = "dopri5",
    .summary = "explicit Runge-Kutta pair 5(4) with error control",
    .source = "Dormand, Prince 1980; Hairer, Norsett, Wanner 1993, sec. II.4",
    .order = 5,
    .order_damped = 5,
    .traits = CS_ADAPTIVE,
    .fidelity = CS_FIDELITY_ODE,
    .options = rows,
    .n_options = sizeof rows / sizeof rows[0],
    .options_size = sizeof(struct dopri5_options),
    .create = create,
    .restart = restart,
    .advance = advance,
    .stats = stats,
    .save = archive,
    .load = archive,
};

static const struct cs_integrator *const integrators[] = {&dopri5};

CS_EXPORT const struct cs_module clothsim_module = {
    .abi = CS_ABI,
    .size = sizeof(struct cs_integrator),
    .n = sizeof integrators / sizeof integrators[0],
    .integrators = integrators,
};
