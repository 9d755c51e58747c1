/* isolate.h - runs a task that calls foreign code in a child process and turns its death into
 * an error message.
 *
 * The child does the whole task in the same order of steps. Only its status comes back; results
 * are in files. */
#ifndef CS_ISOLATE_H
#define CS_ISOLATE_H

#include "base/status.h"

#include <signal.h>

/* Request for a task. */
struct cs_isolate {
    double seconds; /* that one call into a module may take */
    enum cs_status (*task)(void *ctx, struct cs_error *error);
    void *ctx;
    const volatile sig_atomic_t *stop; /* set: the process is asked to stop; may be NULL */
};

/* Runs the task in a child of this process and waits for it. The child ends with this process.
 * Returns the status of the task. If the child died or a call took longer than `seconds`,
 * returns CS_ERR_MODULE (or the status of a memory failure) and names the module and the call.
 * Changes of memory by the task are lost. CS_ERR_MEMORY if no process can be started. */
enum cs_status cs_isolate_run(const struct cs_isolate *isolate, struct cs_error *error);

#endif
