/* SPDX-License-Identifier: MIT */
/* driver.h - the loop around the step of a one-step method: a module may use it, or copy it.
 *
 * It cuts an advance into steps, takes a refused one as two halves, and commits each. A method
 * then is its options and its step:
 *   - dt > 0: equal steps not longer than dt.
 *   - dt = 0: before each step, the method's own limit at the bounds of the state
 *     (host->bounds_at, CS_NEED_BOUNDS). Where contact follows each step in commit, it is not
 *     longer than host->longest_step says.
 *   - Two displacements are judged by host->max_step_fraction, where the scene has it: that of
 *     the step, and that without forces. A step that enters contact and leaves it again ends
 *     outside.
 * The first member of the method's own struct must be the driver: self points to both.
 */
#ifndef CLOTHSIM_DRIVER_H
#define CLOTHSIM_DRIVER_H

#include <clothsim/integrator.h>

#include <math.h>

#ifdef __cplusplus
extern "C" {
#endif

/* A refused step is halved down to this fraction of its length. */
#define CS_DRIVER_SHORTEST (1 / 65536.)

struct cs_driver {
    const struct cs_host *host; /* borrowed */
    double dt;                  /* s; 0: chosen by `limit` */
    /* Takes (x, v) from t to t + h in place, without the commit. */
    enum cs_step (*step)(struct cs_driver *self, double t, double h, double *x, double *v);
    /* The longest step in s that is stable for angular frequencies up to omega and half damping
     * rates up to delta, both in 1/s; with dt = 0 alone. */
    double (*limit)(const struct cs_driver *self, double omega, double delta);
    double *before;    /* (6n) the state before a step */
    double *free_move; /* (3,n) in m: where it would go without forces */
    uint64_t rejected; /* steps that were refused */
};

/* Sets the driver up, and takes its memory; [create]. */
static inline enum cs_step cs_driver_init(struct cs_driver *self, const struct cs_host *host,
                                          double dt) {
    const size_t bytes = 3 * sizeof(double) * (size_t)host->view->n;
    self->host = host;
    self->dt = dt;
    self->before = (double *)host->alloc(host->ctx, 2 * bytes);
    self->free_move = (double *)host->alloc(host->ctx, bytes);
    return self->before && self->free_move ? CS_STEP_OK : CS_STEP_FAIL;
}

/* True if the displacement to x1 would pass over contact by force that no stage sees, or carry
 * surfaces through each other. The host offers the question where the scene needs it. */
static inline bool cs_driver_refuses(const struct cs_driver *self, double t, double h,
                                     const double *x1) {
    const struct cs_host *host = self->host;
    return CS_HAS(host, max_step_fraction) && host->max_step_fraction &&
           host->max_step_fraction(host->ctx, t, self->before, t + h, x1) < 1;
}

/* One step from t to `end`, which is t + h up to rounding, with its commit; halves of it where
 * it is refused, down to `shortest` s. */
static inline enum cs_step cs_driver_step_or_halve(struct cs_driver *self, double t, double h,
                                                   double end, double shortest, double *x,
                                                   double *v) {
    const struct cs_host *host = self->host;
    const size_t n3 = 3 * (size_t)host->view->n;
    for (size_t k = 0; k < 2 * n3; k++) /* v follows x */
        self->before[k] = x[k];
    for (size_t k = 0; k < n3; k++)
        self->free_move[k] = x[k] + h * v[k];
    bool refused = cs_driver_refuses(self, t, h, self->free_move), changed;
    if (!refused) {
        const enum cs_step status = self->step(self, t, h, x, v);
        if (status != CS_STEP_OK)
            return status;
        refused = cs_driver_refuses(self, t, h, x);
    }
    /* contact, strain limit, blow-up: anything but CS_STEP_OK goes up at once. If changed is
     * true a method with a history restarts; this one has none. */
    if (!refused)
        return host->commit(host->ctx, end, h, x, v, &changed);

    self->rejected++;
    for (size_t k = 0; k < 2 * n3; k++)
        x[k] = self->before[k];
    if (h < shortest)
        return host->fail(host->ctx,
                          "a step of %.3g s at t = %.9g s still misses contact or crosses a "
                          "surface",
                          h, t);
    const enum cs_step status =
        cs_driver_step_or_halve(self, t, h / 2, t + h / 2, shortest, x, v);
    return status == CS_STEP_OK
               ? cs_driver_step_or_halve(self, t + h / 2, h / 2, end, shortest, x, v)
               : status;
}

/* The longest step in s from a state; HUGE_VAL: any. A host older than CS_NEED_BOUNDS has the
 * view's bounds alone, which hold without contact. */
static inline double cs_driver_longest(const struct cs_driver *self, double t, const double *x,
                                       const double *v) {
    const struct cs_host *host = self->host;
    double omega = host->view->omega, delta = host->view->delta, contact = HUGE_VAL;
    if (CS_HAS(host, bounds_at) && host->bounds_at)
        host->bounds_at(host->ctx, t, x, v, &omega, &delta);
    if (CS_HAS(host, longest_step) && host->longest_step)
        contact = host->longest_step(host->ctx, t, x, v);
    const double stable = self->limit(self, omega, delta);
    return stable < contact ? stable : contact;
}

/* advance of the descriptor: from t0 to exactly t1. */
static inline enum cs_step cs_driver_advance(void *object, double t0, double t1, double *x,
                                             double *v) {
    struct cs_driver *self = (struct cs_driver *)object;
    enum cs_step status = CS_STEP_OK;
    double t = t0, i = 0;
    while (t < t1 && status == CS_STEP_OK) {
        const double longest = self->dt > 0 ? self->dt : cs_driver_longest(self, t, x, v);
        /* equal steps count from t0: a dt that fits is not spoilt by the rounding of t1 - t0 */
        const double begin = self->dt > 0 ? t0 : t;
        const double n = fmax(ceil((t1 - begin) / longest * (1 - 1e-9)), 1);
        const double h = (t1 - begin) / n;
        i = self->dt > 0 ? i + 1 : 1;
        const double end = i < n ? begin + i * h : t1;
        status = cs_driver_step_or_halve(self, t, h, end, CS_DRIVER_SHORTEST * h, x, v);
        t = end;
    }
    return status;
}

/* restart of the descriptor: the state was set from outside, and nothing is remembered of it.
 */
static inline enum cs_step cs_driver_restart(void *self, double t, const double *x,
                                             const double *v) {
    (void)self, (void)t, (void)x, (void)v;
    return CS_STEP_OK;
}

/* stats of the descriptor. */
static inline void cs_driver_stats(const void *object, struct cs_stats *out) {
    out->rejected = ((const struct cs_driver *)object)->rejected;
}

/* save and load of the descriptor: all that survives from one advance to the next. */
static inline enum cs_step cs_driver_archive(void *object, const struct cs_archive *archive) {
    archive->integers(archive->ctx, &((struct cs_driver *)object)->rejected, 1);
    return CS_STEP_OK;
}

#ifdef __cplusplus
}
#endif
#endif
