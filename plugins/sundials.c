/* sundials.c - turns a library's failure into the method's; see sundials.h. */
#include "sundials.h"

#include <stdlib.h>

enum cs_step sundials_fail(struct sundials *self, int code, double t) {
    const struct cs_host *host = self->host;
    if (self->status != CS_STEP_OK)
        return self->status;
    char *name = self->library->code_name(code);
    host->fail(host->ctx, "%s failed at t = %.9g s: %s%s%s", self->library->name, t,
               name ? name : "out of memory", self->message[0] ? ": " : "", self->message);
    free(name);
    return CS_STEP_FAIL;
}
