/* process_pool.h - distributes independent tasks over processes.
 *
 * Processes, not threads: a budget of processor time then belongs to one task, modules need not
 * be thread-safe, and a crash ends only its worker. Tasks are taken from a shared counter, so
 * long and short ones balance. */
#ifndef CS_PROCESS_POOL_H
#define CS_PROCESS_POOL_H

#include "base/status.h"

#include <signal.h>
#include <stddef.h>
#include <stdint.h>

/* Workers at a time, at most; one a processor is a sensible number. */
enum { CS_PROCESS_POOL_MAX = 16 };

/* Allocates zeroed memory that all workers share; results belong there. Returns NULL with
 * CS_ERR_MEMORY. Freed with the same size; NULL is allowed. */
void *cs_process_pool_shared_alloc(size_t bytes, struct cs_error *error);
void cs_process_pool_shared_free(void *memory, size_t bytes);

/* Request for a run of tasks; pointers are borrowed. */
struct cs_process_pool {
    uint32_t n_workers, n_tasks;
    /* one task, in its own process; it must call cs_process_pool_tick as it progresses */
    enum cs_status (*task)(void *ctx, uint32_t task, struct cs_error *error);
    void *ctx;
    /* in the calling process, about ten times a second; may be NULL */
    void (*progress)(void *ctx, uint32_t ticks);
    void *progress_ctx;
    uint32_t *ticks;         /* of the pool: in memory that all workers see while it runs */
    double task_seconds_max; /* of processor time for a task, which is then left as it is; 0:
                                any */
    const volatile sig_atomic_t *stop; /* set: the workers are asked to stop; may be NULL */
};

/* Advances the progress; callable from every worker. */
void cs_process_pool_tick(struct cs_process_pool *workers, uint32_t ticks);

/* Runs all tasks and returns when they are done. The first error stops further tasks.
 * CS_ERR_MODULE if a worker crashed; CS_ERR_INTERRUPT; CS_ERR_MEMORY if no worker can be
 * started. */
enum cs_status cs_process_pool_run(struct cs_process_pool *workers, struct cs_error *error);

/* Runs a task that calls foreign code in a child process and turns its death into
 * an error message.
 *
 * The child does the whole task in the same order of steps. Only its status comes back; results
 * are in files. */

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
