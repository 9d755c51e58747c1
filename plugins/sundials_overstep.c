/* sundials_overstep.c - lets the library step as it likes, and shows the host the
 * interpolated state.
 *
 * The library's time t_internal is ahead of the host's t or equal to it. One turn of the
 * loop: if they are equal the library takes a step; then the host's time moves to the end of
 * that step or to the frame, whichever is first, and that state is committed. */
#include "sundials_overstep.h"

#include <math.h>
#include <string.h>

/* s, distance of the target time that a step is given. CVODE limits its first step to a tenth
 * of it; later steps ignore it. A constant instead of the frame's time makes steps
 * independent of frames. Chosen by trial: with 1 s a loose tolerance starts with too long a
 * step. */
#define AHEAD 0.1

/* Bytes of a state (6n). */
static size_t bytes_of(const struct sundials *self) {
    return 6 * sizeof(double) * (size_t)self->host->view->n;
}

void sundials_overstep_begin(struct sundials *self) {
    const struct cs_host *host = self->host;
    if (CS_HAS(host, overstep_until) && host->overstep_until > 0)
        self->interpolated = sundials_vectors_acquire(&self->vectors);
}

void sundials_overstep_restart(struct sundials *self, double t, const double *x) {
    memcpy(sundials_data(self->state), x, bytes_of(self));
    self->t_internal = t;
}

/* Restores pinned particles to their bits: the interpolant's weights do not sum to 1 exactly.
 */
static void restore_pins(const struct sundials *self, double *x) {
    const size_t n = self->host->view->n;
    const double *inv_mass = self->host->view->inv_mass, *kept = sundials_data(self->state);
    for (size_t i = 0; i < n; i++)
        for (size_t c = 0; inv_mass[i] == 0 && c < 6; c++)
            x[c * n + i] = kept[c * n + i];
}

/* x = the state at t within the last step. Returns the library's code. */
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

/* commit changed the interpolated state at t: restarts the library from it. dt, the length of
 * the part, counts as a step only if the part ended where the library's step did. */
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
        while (self->t_internal <= t && code >= 0 && self->status == CS_STEP_OK) {
            if (steps++ >= self->max_steps)
                return sundials_fail_by_count(self, t0, t);
            if (host->overstep_until < HUGE_VAL)
                code = self->library->set_stop(self->memory, host->overstep_until);
            if (code >= 0)
                code = sundials_try(self, t + AHEAD, AHEAD, sundials_data(self->state),
                                    &self->t_internal);
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
