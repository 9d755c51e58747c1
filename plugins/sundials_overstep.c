/* Steps as the library likes, and what the host sees of them; see sundials_overstep.h. */
#include "sundials_overstep.h"

#include <string.h>

/* s ahead, where a step is told to head for: the first one is at most a tenth of it, and later
 * ones ignore it. No frame's time, so that steps are the same whatever the frames are; with 1 s
 * a loose tolerance begins too far. */
#define AHEAD 0.1

static size_t bytes_of(const struct sundials *self) {
    return 6 * sizeof(double) * (size_t)self->host->view->n;
}

void sundials_overstep_begin(struct sundials *self) {
    const struct cs_host *host = self->host;
    if (CS_HAS(host, may_overstep) && host->may_overstep)
        self->interpolated = sundials_vectors_acquire(&self->vectors);
}

void sundials_overstep_restart(struct sundials *self, double t, const double *x) {
    memcpy(sundials_data(self->state), x, bytes_of(self));
    self->t_internal = t;
}

/* an interpolant's weights are rounded: what does not move is put where it was */
static void restore_pins(const struct sundials *self, double *x) {
    const size_t n = self->host->view->n;
    const double *inv_mass = self->host->view->inv_mass, *kept = sundials_data(self->state);
    for (size_t i = 0; i < n; i++)
        for (size_t c = 0; inv_mass[i] == 0 && c < 6; c++)
            x[c * n + i] = kept[c * n + i];
}

/* x = the state at t, in the last step; the library's code */
static int show(struct sundials *self, double t, double *x) {
    if (t == self->t_internal) {
        memcpy(x, sundials_data(self->state), bytes_of(self));
        return 0;
    }
    sundials_wrap(self->interpolated, x);
    const int code = self->library->interpolate(self->memory, t, 0, self->interpolated);
    restore_pins(self, x);
    return code;
}

/* commit has moved what it was shown at t, after dt: the library goes on from there */
static int restart_if_changed(struct sundials *self, double t, double dt, const double *x) {
    const bool whole = t == self->t_internal;
    sundials_overstep_restart(self, t, x);
    return self->library->on_state_changed(self, t, whole ? dt : 0);
}

enum cs_step sundials_overstep_advance(struct sundials *self, double t0, double t1, double *x,
                                       double *v) {
    const struct cs_host *host = self->host;
    int64_t steps = 0;
    for (double t = t0, next; t < t1; t = next) {
        bool changed = false;
        int code = 0;
        if (self->t_internal <= t) {
            if (steps++ >= self->max_steps)
                return host->fail(host->ctx, "more than %lld steps from t = %.9g s to %.9g s",
                                  (long long)self->max_steps, t0, t);
            code = self->library->evolve(self->memory, self->t_internal + AHEAD, self->state,
                                         &self->t_internal, self->library->one_step);
        }
        next = self->t_internal < t1 ? self->t_internal : t1;
        if (code < 0 || self->status != CS_STEP_OK || (code = show(self, next, x)) < 0)
            return sundials_fail(self, code, t);
        const enum cs_step status = host->commit(host->ctx, next, next - t, x, v, &changed);
        if (status != CS_STEP_OK)
            return status;
        if (changed && (code = restart_if_changed(self, next, next - t, x)) < 0)
            return sundials_fail(self, code, next);
    }
    return CS_STEP_OK;
}
