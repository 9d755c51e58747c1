/* fixed_step.h - the loop over steps of equal length that fixed-step methods share.
 *
 * A method's own struct starts with struct fixed_step and gives it the step. The span of an
 * advance is cut into the fewest equal steps that are not longer than dt.
 *
 * In scenes with contact by force (fixed_step_guard) a step may be cut: it is taken as two
 * halves, each of which may be cut in turn, where it would pass over contact that it cannot see
 * (host->max_share), or where a method that chose dt by its stability limit has a smaller limit
 * in contact (host->rate). Two halves done, the next step is as long as both.
 */
#ifndef FIXED_STEP_H
#define FIXED_STEP_H

#include <clothsim/integrator.h>
#include <math.h>
#include <string.h>

struct fixed_step;

/* from (x, v) at t to t + h, without the commit */
typedef enum cs_step fixed_step_taker(struct fixed_step *self, double t, double h, double *x,
                                      double *v);

struct fixed_step {
    const struct cs_host *host;
    double dt;   /* longest step in s; HUGE_VAL: one step an advance */
    bool fresh;  /* the state was moved from outside: what the method remembers is void */
    bool told;   /* that dt was shortened */
    bool chosen; /* dt was chosen here, not asked for */
    fixed_step_taker *step;

    /* only in scenes with contact by force, see fixed_step_guard */
    double *saved; /* (6n) the state before a step; NULL: no step is cut */
    double (*limit)(const struct fixed_step *self, double omega, double delta); /* s, or NULL */
};

/* dt as options have it: 0 is one step an advance. */
static inline struct fixed_step fixed_step_of(const struct cs_host *host, double dt,
                                              fixed_step_taker *step) {
    return (struct fixed_step){
        .host = host, .dt = dt > 0 ? dt : HUGE_VAL, .chosen = dt <= 0, .step = step};
}

/* More steps than that in one advance are a wrong dt. */
#define FIXED_STEP_MAX 1e9
/* A dt that falls short of a whole number of steps by that share was meant to be one. */
#define FIXED_STEP_TYPED 1e-5

static inline enum cs_step fixed_step_count(struct fixed_step *self, double span, double *n) {
    // a frame of 1/60 s with dt = 1/120 is two steps, also where 1/120 was typed as 0.0083333
    *n = ceil(span / (self->dt * (1 + FIXED_STEP_TYPED)));
    if (!(*n <= FIXED_STEP_MAX))
        return self->host->fail(self->host->ctx, "dt = %g s needs more than %g steps in %g s",
                                self->dt, FIXED_STEP_MAX, span);
    if (*n < 1)
        *n = 1;
    const double h = span / *n;
    if (!self->told && !self->chosen && h < self->dt * (1 - 1e-9)) {
        self->host->note(self->host->ctx, "dt shortened from %.6g to %.6g s to meet the frame",
                         self->dt, h);
        self->told = true;
    }
    return CS_STEP_OK;
}

static inline enum cs_step fixed_step_restart(void *self, double t, const double *x,
                                              const double *v) {
    (void)t, (void)x, (void)v;
    ((struct fixed_step *)self)->fresh = true;
    return CS_STEP_OK;
}

/* What the loop remembers, for save and load. */
static inline enum cs_step fixed_step_archive(void *object, const struct cs_archive *archive) {
    struct fixed_step *self = (struct fixed_step *)object;
    uint64_t marks[] = {self->fresh, self->told};
    archive->wholes(archive->ctx, marks, 2);
    self->fresh = marks[0] != 0;
    self->told = marks[1] != 0;
    return CS_STEP_OK;
}

/* Lets steps be cut where the scene has contact by force; [create]. limit: the method's largest
 * stable step where it chose dt by it, else NULL. */
static inline enum cs_step fixed_step_guard(struct fixed_step *self,
                                            double (*limit)(const struct fixed_step *, double,
                                                            double)) {
    const struct cs_host *host = self->host;
    if (!CS_HAS(host, max_share) || !host->max_share)
        return CS_STEP_OK;
    self->limit = limit;
    self->saved = (double *)host->alloc(host->ctx, 6 * sizeof(double) * host->view->n);
    return self->saved ? CS_STEP_OK : CS_STEP_FAIL;
}

/* A step is cut into 2^FIXED_STEP_CUTS parts at most. */
#define FIXED_STEP_CUTS 16

/* The step from (x, v) at t to t + h, without the commit. *cut: it was not taken, it has to be
 * shorter. */
static inline enum cs_step fixed_step_try(struct fixed_step *self, double t, double h,
                                          double *x, double *v, bool *cut) {
    const struct cs_host *host = self->host;
    const size_t bytes = 6 * sizeof *x * host->view->n;
    *cut = false;
    if (!self->saved)
        return self->step(self, t, h, x, v);
    if (self->limit) {
        double omega, delta;
        host->rate(host->ctx, t, x, v, &omega, &delta);
        *cut = h > 0.9 * self->limit(self, omega, delta);
    }
    if (*cut)
        return CS_STEP_OK;
    memcpy(self->saved, x, bytes);
    const enum cs_step status = self->step(self, t, h, x, v);
    if (status == CS_STEP_OK && host->max_share(host->ctx, t, self->saved, t + h, x) < 1) {
        memcpy(x, self->saved, bytes);
        *cut = true;
    }
    return status;
}

/* One step of length h from t, whole or in parts; it ends at `end`. */
static inline enum cs_step fixed_step_cross(struct fixed_step *self, double t, double h,
                                            double end, double *x, double *v) {
    const struct cs_host *host = self->host;
    // the step is cut into 2^depth parts, of which `at` are done
    uint32_t depth = 0, at = 0;
    while (depth > 0 || at == 0) {
        const double part = h / (double)(1u << depth), from = t + at * part;
        bool cut, changed = false;
        enum cs_step status = fixed_step_try(self, from, part, x, v, &cut);
        if (status != CS_STEP_OK)
            return status;
        if (cut && depth == FIXED_STEP_CUTS)
            return host->fail(host->ctx,
                              "a step of %.3g s at t = %.9g s, halved %d times, still passes "
                              "over contact or through a surface",
                              part, from, FIXED_STEP_CUTS);
        if (cut) {
            depth++, at *= 2;
            self->fresh = true;
            continue;
        }
        at++;
        status = host->commit(host->ctx, at == 1u << depth ? end : t + at * part, part, x, v,
                              &changed);
        self->fresh = changed;
        if (status != CS_STEP_OK)
            return status;
        for (; depth > 0 && at % 2 == 0; at /= 2) {
            depth--;
            self->fresh = true;
        }
    }
    return CS_STEP_OK;
}

static inline enum cs_step fixed_step_advance(void *object, double t0, double t1, double *x,
                                              double *v) {
    struct fixed_step *self = object;
    double n;
    enum cs_step status = fixed_step_count(self, t1 - t0, &n);
    const double h = (t1 - t0) / n;
    for (double i = 0; i < n && status == CS_STEP_OK; i++)
        // times from t0, not summed up: the last is t1 to the bit
        status =
            fixed_step_cross(self, t0 + i * h, h, i + 1 == n ? t1 : t0 + (i + 1) * h, x, v);
    return status;
}

#endif
