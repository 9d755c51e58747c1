/* process_pool.h - independent tasks shared out among processes.
 *
 * Processes, not threads: a budget of processor time then belongs to one task alone, modules
 * need not share anything, and one that crashes takes only its worker along.
 */
#ifndef CS_PROCESS_POOL_H
#define CS_PROCESS_POOL_H

#include "base/status.h"

#include <signal.h>
#include <stddef.h>
#include <stdint.h>

/* Workers at a time, at most; one a processor is a sensible number. */
enum { CS_PROCESS_POOL_MAX = 16 };

/* Results live in memory that all workers see; zeroed. CS_ERR_MEMORY. */
void *cs_process_pool_shared_alloc(size_t bytes, struct cs_error *error);
void cs_process_pool_shared_free(void *memory, size_t bytes);

struct cs_process_pool {
    uint32_t n_workers, n_tasks;
    /* one task, in a process of its own; ticks is to be raised (cs_process_pool_tick) as it
     * goes */
    enum cs_status (*task)(void *ctx, uint32_t task, struct cs_error *error);
    void *ctx;
    /* in the calling process, about ten times a second; may be NULL */
    void (*progress)(void *ctx, uint32_t ticks);
    void *progress_ctx;
    uint32_t *ticks;         /* of the pool: in memory that all workers see while it runs */
    double task_seconds_max; /* of processor time for a task, which is then left as it is; 0:
                                any */
    const volatile sig_atomic_t *stop; /* set: the workers are told; may be NULL */
};

void cs_process_pool_tick(struct cs_process_pool *workers, uint32_t ticks);

/* Returns when all are done; the first error ends the rest. CS_ERR_MODULE where a worker
 * crashed. */
enum cs_status cs_process_pool_run(struct cs_process_pool *workers, struct cs_error *error);

#endif
