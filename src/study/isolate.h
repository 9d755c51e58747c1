/* isolate.h - work with foreign code in a process of its own, whose death is a message.
 *
 * The whole task is done there, by the same steps in the same order: nothing has to come back
 * but how it ended. */
#ifndef CS_ISOLATE_H
#define CS_ISOLATE_H

#include "base/status.h"

#include <signal.h>

struct cs_isolate {
    double seconds; /* that one call into a module may take */
    enum cs_status (*task)(void *ctx, struct cs_error *error);
    void *ctx;
    const volatile sig_atomic_t *stop; /* set: the process is told; may be NULL */
};

/* Does the task in a child of this process, which ends with it, and waits for it. Returns what
 * the task came to; where the process died, or a call took longer, CS_ERR_MODULE (or that of
 * memory) names the module and the call. What the task wrote is in its files; nothing else of
 * it is to be seen here. CS_ERR_MEMORY: there is no other process to be had. */
enum cs_status cs_isolate_run(const struct cs_isolate *isolate, struct cs_error *error);

#endif
