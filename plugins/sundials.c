/* sundials.c - turns a library's failure into the method's; see sundials.h. */
#include "sundials.h"

#include <stdlib.h>

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
