/* sundials.c - a try of a step, and a library's failure as the method's; see sundials.h. */
#include "sundials.h"

#include <stdlib.h>
#include <string.h>

/* True if no step was short enough. */
static bool is_step_refused(int code) {
    return code == SUNDIALS_ERROR_TEST || code == SUNDIALS_CONVERGENCE ||
           code == SUNDIALS_REFUSED;
}

enum cs_step sundials_fail(struct sundials *self, int code, double t) {
    const struct cs_host *host = self->host;
    if (self->status != CS_STEP_OK)
        return self->status;
    char *name = self->library->code_name(code);
    host->fail(host->ctx, "%s failed at t = %.9g s: %s%s%s", self->library->name, t,
               name ? name : "out of memory", self->message[0] ? ": " : "", self->message);
    free(name);
    return is_step_refused(code) ? CS_STEP_HALT : CS_STEP_FAIL;
}

enum cs_step sundials_fail_by_count(struct sundials *self, double t0, double t) {
    self->host->fail(self->host->ctx, "more than %lld steps from t = %.9g s to %.9g s",
                     (long long)self->max_steps, t0, t);
    return CS_STEP_HALT;
}

bool sundials_passes_through(const struct sundials *self, double t0, double t,
                             const double *x) {
    const struct cs_host *host = self->host;
    return self->y_before && host->max_step_fraction(host->ctx, t0, self->y_before, t, x) < 1;
}

/* A step shorter than the advance by this factor is not shortened further: as 16 halvings in
 * fixed_step.c. */
#define PARTS_MAX 65536

/* Undoes the step from t to `reached` and restarts the library, which then takes a small
 * first step. Needed although the right-hand side refuses such states: the end of a step need
 * not be a point where it was evaluated. Returns a code below 0 on failure. */
static int restore_state(struct sundials *self, double t, double reached, double frame,
                         double *x) {
    const struct cs_host *host = self->host;
    memcpy(x, self->y_before, 6 * sizeof *x * host->view->n);
    if (self->equal_steps || (reached - t) * PARTS_MAX < frame) {
        host->fail(host->ctx,
                   "a step of %.3g s at t = %.9g s misses contact or crosses a surface",
                   reached - t, t);
        self->status = CS_STEP_HALT;
        return -1;
    }
    return self->library->on_state_changed(self, t, 0);
}

int sundials_try(struct sundials *self, double t1, double frame, double *x, double *t) {
    const double before = *t;
    if (self->y_before)
        memcpy(self->y_before, x, 6 * sizeof *x * self->host->view->n);
    int code = self->library->evolve(self->memory, t1, self->state, t, self->library->one_step);
    if (code >= 0 && self->status == CS_STEP_OK &&
        sundials_passes_through(self, self->judges_contact ? before : *t, *t, x)) {
        code = restore_state(self, before, *t, frame, x);
        *t = before;
    }
    return code;
}
