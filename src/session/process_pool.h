/* process_pool.h - distributes independent tasks over processes.
 *
 * Processes, not threads: modules need not be thread-safe, and a crash ends only its worker.
 * Tasks are taken from a shared counter, so long and short ones balance. */
#ifndef CS_PROCESS_POOL_H
#define CS_PROCESS_POOL_H

#include "base/status.h"
#include "sim/crash.h"

#include <signal.h>
#include <stdbool.h>
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
    uint32_t *ticks; /* of the pool: in memory that all workers see while it runs */
    /* s of processor time for a task, which is then left as it is; 0: any */
    double task_seconds_max;
    /* s that a method may keep from the host (cs_crash_patience_look); 0: any */
    double silence_max;
    /* set: the workers are asked to stop, and ended if they do not; may be NULL */
    const volatile sig_atomic_t *stop;
};

/* Times in s since the calls of a log last showed a sign, as a watcher counts them. Zeroed but
 * for `looked`, the time by the clock, and `process`, the one that logs. */
struct cs_crash_patience {
    unsigned calls[CS_CRASH_SIDES], hosts[CS_CRASH_SIDES]; /* parities at the last look */
    double waited[CS_CRASH_SIDES];                         /* in the call that is under way */
    double silent[CS_CRASH_SIDES]; /* in it, without work for it by the host */
    double looked, cpu;            /* by the wall, and of the process, at the last look */
    pid_t process;
};

/* Looks at the log, and returns the time since the last look: processor time of the process,
 * and a quarter of the wall time if it sleeps or has to wait for a processor. A loaded machine
 * thus gives no method less time. A suspended machine does not count: a look adds 0.2 s at
 * most.
 */
double cs_crash_patience_look(struct cs_crash_patience *patience,
                              const struct cs_crash_log *log);
/* The call of a method that has asked the host for nothing for longer than a limit; or NULL. */
const struct cs_crash_call *cs_crash_find_silent(const struct cs_crash_patience *patience,
                                                 const struct cs_crash_log *log, double limit);

/* s after which a method that keeps from the host hangs, in runs with a budget of so many
 * nominal s: far away, since no result may depend on a clock. */
static inline double cs_hang_seconds(double budget) {
    return 10 + 4 * budget;
}

/* Advances the progress; callable from every worker. */
void cs_process_pool_tick(struct cs_process_pool *pool, uint32_t ticks);

/* Runs all tasks and returns when they are done. The first error stops further tasks.
 * CS_ERR_MODULE if a worker crashed or hung; CS_ERR_INTERRUPT; CS_ERR_MEMORY if no worker can
 * be started. */
enum cs_status cs_process_pool_run(struct cs_process_pool *pool, struct cs_error *error);

/* Runs tasks that call foreign code in child processes, one process a task, and turns their
 * deaths into error messages.
 *
 * A child does the whole task in the same order of steps. Only its status comes back; results
 * are in files or in shared memory. It ends with this process. */

/* The limits of a child, in s of cs_crash_patience_look. */
struct cs_isolate {
    double seconds;      /* that one call into a module may take; 0: any */
    double task_seconds; /* that all of it may take; 0: any */
    /* that a call, or all of a cell, may go on after the request to stop; 0: any */
    double stop_seconds;
    double bytes; /* address space; 0: any */
    /* one of many: its standard output is standard error, and the kernel ends it before others
     * when the machine has no memory left */
    bool is_cell;
    enum cs_status (*task)(void *ctx, struct cs_error *error);
    void *ctx;
    const volatile sig_atomic_t *stop; /* set: the process is asked to stop; may be NULL */
};

/* Runs the task in a child of this process and waits for it. Returns the status of the task. If
 * the child died or took longer than its limits, returns CS_ERR_MODULE (or the status of a
 * memory failure) and names the module and the call; CS_ERR_INTERRUPT if it was killed because
 * it did not stop. Changes of memory by the task are lost. CS_ERR_MEMORY if no process can be
 * started. */
enum cs_status cs_isolate_run(const struct cs_isolate *isolate, struct cs_error *error);

/* Tasks of the same limits, several at a time, each in a child of its own. */
struct cs_isolate_queue {
    struct cs_isolate isolate; /* without task and ctx */
    uint32_t n_slots;          /* tasks at a time, up to CS_PROCESS_POOL_MAX */
    void *ctx;
    /* in this process: chooses the next task of a free slot; false: none is left */
    bool (*next)(void *ctx, uint32_t slot, struct cs_error *error);
    /* in the child */
    enum cs_status (*task)(void *ctx, uint32_t slot, struct cs_error *error);
    /* in this process: takes the result; an error of its own ends the queue */
    void (*ended)(void *ctx, uint32_t slot, const struct cs_error *result,
                  struct cs_error *error);
};

/* Runs tasks until none is left. An error of next or ended kills those under way. After a
 * request to stop no task is begun, and CS_ERR_INTERRUPT is returned when all have ended.
 * CS_ERR_MEMORY if no process can be started. */
enum cs_status cs_isolate_queue_run(const struct cs_isolate_queue *queue,
                                    struct cs_error *error);

#endif
