/* fixed_step.h - the loop over steps of equal length that fixed-step methods share.
 *
 * A method's own struct starts with struct fixed_step and gives it the step. The span of an
 * advance is cut into the fewest equal steps that are not longer than dt.
 */
#ifndef FIXED_STEP_H
#define FIXED_STEP_H

#include <clothsim/integrator.h>
#include <math.h>

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
};

/* dt as options have it: 0 is one step an advance. */
static inline struct fixed_step fixed_step_of(const struct cs_host *host, double dt,
                                              fixed_step_taker *step) {
    return (struct fixed_step){
        .host = host, .dt = dt > 0 ? dt : HUGE_VAL, .chosen = dt <= 0, .step = step};
}

/* More steps than that in one advance are a wrong dt. */
#define FIXED_STEP_MAX 1e9

static inline enum cs_step fixed_step_count(struct fixed_step *self, double span, double *n) {
    // the tolerance keeps a frame of 1/60 s with dt = 1/600 at ten steps
    *n = ceil(span / (self->dt * (1 + 1e-9)));
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

static inline enum cs_step fixed_step_advance(void *object, double t0, double t1, double *x,
                                              double *v) {
    struct fixed_step *self = object;
    const struct cs_host *host = self->host;
    double n;
    enum cs_step status = fixed_step_count(self, t1 - t0, &n);
    const double h = (t1 - t0) / n;
    double t = t0;
    for (double i = 1; i <= n && status == CS_STEP_OK; i++) {
        status = self->step(self, t, h, x, v);
        if (status != CS_STEP_OK)
            break;
        // times from t0, not summed up: the last is t1 to the bit
        t = i == n ? t1 : t0 + i * h;
        bool changed = false;
        status = host->commit(host->ctx, t, h, x, v, &changed);
        self->fresh = changed;
    }
    return status;
}

#endif
