/* Distributes independent tasks over forked processes. */
#include "session/process_pool.h"

#include "base/clock.h"

#include <errno.h>
#include <math.h>
#include <stdatomic.h>
#include <stdio.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#ifdef __GLIBC__
#include <malloc.h>
#endif

/* s that a worker may go on after the request to stop */
#define STOP_SECONDS 0.5

/* At most this is added to a waiting time by one look, s. */
#define LONGEST_LOOK 0.2
/* Fraction of the wall time that counts while a process does not compute. */
#define WAITING_SHARE 0.25

/* Each entry and exit of a call increments its parity. The waiting time grows while that does
 * not change, the silence while the host is not at work either. */
double cs_crash_patience_look(struct cs_crash_patience *patience,
                              const struct cs_crash_log *log) {
    const double now = cs_clock_wall(), cpu = cs_clock_cpu_of(patience->process);
    const double wall = now - patience->looked;
    const double passed = fmin(wall, fmax(cpu - patience->cpu, WAITING_SHARE * wall)),
                 step = fmin(passed, LONGEST_LOOK);
    patience->looked = now;
    patience->cpu = cpu;
    // an odd parity of the host is work that the method waits for
    for (int k = 0; k < CS_CRASH_SIDES; k++) {
        const unsigned call = atomic_load(&log->calls[k].call_parity);
        const unsigned host = atomic_load(&log->calls[k].host_parity);
        const bool same = call == patience->calls[k];
        const bool mute = same && host == patience->hosts[k] && host % 2 == 0;
        patience->waited[k] = same ? patience->waited[k] + step : 0;
        patience->silent[k] = mute ? patience->silent[k] + step : 0;
        patience->calls[k] = call;
        patience->hosts[k] = host;
    }
    return step;
}

const struct cs_crash_call *cs_crash_find_silent(const struct cs_crash_patience *patience,
                                                 const struct cs_crash_log *log, double limit) {
    const struct cs_crash_call *call = log->calls + CS_CRASH_METHOD;
    return limit > 0 && cs_crash_is_running(call) && patience->silent[CS_CRASH_METHOD] > limit
               ? call
               : NULL;
}

/* Memory that all workers share. */
struct shared {
    atomic_uint next;
    uint32_t ticks;
    struct cs_error errors[CS_PROCESS_POOL_MAX]; /* one a worker */
    struct cs_crash_log logs[CS_PROCESS_POOL_MAX];
    atomic_bool done[CS_PROCESS_POOL_MAX]; /* it has returned by itself */
};

void *cs_process_pool_shared_alloc(size_t bytes, struct cs_error *error) {
    void *memory =
        mmap(NULL, bytes + 1, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (memory != MAP_FAILED)
        return memory;
    cs_fail(error, CS_ERR_MEMORY, "out of memory");
    return NULL;
}

void cs_process_pool_shared_free(void *memory, size_t bytes) {
    if (memory)
        munmap(memory, bytes + 1);
}

void cs_process_pool_tick(struct cs_process_pool *pool, uint32_t ticks) {
    __atomic_fetch_add(pool->ticks, ticks, __ATOMIC_RELAXED);
}

/* Limits the processor time of one task: SIGPROF then ends the worker, which covers a task that
 * never returns to check its budget. */
static void limit_task(const struct cs_process_pool *pool) {
    const struct itimerval limit = {.it_value.tv_sec = (time_t)pool->task_seconds_max};
    if (pool->task_seconds_max > 0)
        setitimer(ITIMER_PROF, &limit, NULL);
}

/* Tunes malloc for tasks that open many sessions in succession: freed memory is kept for the
 * next session, not returned to the system and faulted in again page by page. The end of the
 * worker frees all. */
static void store_memory(void) {
#ifdef __GLIBC__
    mallopt(M_MMAP_THRESHOLD, 1 << 25);
    mallopt(M_TRIM_THRESHOLD, 1 << 28);
    mallopt(M_TOP_PAD, 1 << 22);
#endif
}

/* Takes tasks from the shared counter until none is left or one fails. */
static void serve(struct cs_process_pool *pool, struct shared *shared, uint32_t worker) {
    struct cs_error *error = shared->errors + worker;
    while (!error->status) {
        const uint32_t task = atomic_fetch_add(&shared->next, 1);
        if (task >= pool->n_tasks)
            return;
        limit_task(pool);
        pool->task(pool->ctx, task, error);
    }
    /* no worker begins another task */
    atomic_store(&shared->next, pool->n_tasks);
}

static void report(const struct cs_process_pool *pool) {
    if (pool->progress)
        pool->progress(pool->progress_ctx, __atomic_load_n(pool->ticks, __ATOMIC_RELAXED));
}

/* A worker as the caller sees it. */
struct worker {
    pid_t process; /* 0: none */
    struct cs_crash_patience patience;
    double stopping; /* s since it was asked to stop */
    bool is_late;    /* a call in a task with a limit of time hung: it was killed */
};

/* Takes over the error of a worker that ended. A limit of time is none; any other death is
 * reported as a crash. */
static void collect(struct shared *shared, uint32_t worker, bool overdue, int end,
                    struct cs_error *error) {
    if (error->status)
        return;
    if (shared->errors[worker].status)
        *error = shared->errors[worker];
    else if (!overdue && (end || !shared->done[worker]))
        cs_crash_report_print(shared->logs + worker, end, error);
    if (error->status)
        atomic_store(&shared->next, UINT32_MAX / 2);
}

/* Forks a worker. Its process is < 0 if there is none. */
static void start(struct cs_process_pool *pool, struct shared *shared, uint32_t number,
                  struct worker *worker) {
    *worker = (struct worker){.patience.looked = cs_clock_wall()};
    /* that of the worker before, which was ended in a task */
    shared->logs[number] = (struct cs_crash_log){0};
    worker->process = worker->patience.process = fork();
    if (worker->process)
        return;
    cs_crash_log_to(shared->logs + number);
    store_memory();
    serve(pool, shared, number);
    atomic_store(shared->done + number, true);
    _exit(0);
}

/* Passes a request to stop on, and ends a worker that does not stop or whose method hangs. */
static void hold_to_limits(const struct cs_process_pool *pool, struct shared *shared,
                           uint32_t number, struct worker *worker) {
    const struct cs_crash_log *log = shared->logs + number;
    const double step = cs_crash_patience_look(&worker->patience, log);
    const struct cs_crash_call *hung =
        cs_crash_find_silent(&worker->patience, log, pool->silence_max);
    const bool stops = pool->stop && *pool->stop;
    if (stops)
        kill(worker->process, (worker->stopping += step) > STOP_SECONDS ? SIGKILL : SIGTERM);
    else if (hung && pool->task_seconds_max > 0) {
        worker->is_late = true;
        kill(worker->process, SIGKILL);
    } else if (hung && !shared->errors[number].status) {
        cs_fail(shared->errors + number, CS_ERR_MODULE,
                "%s \"%s\" hung %s: it was ended after %g s", hung->kind, hung->name,
                hung->place, pool->silence_max);
        kill(worker->process, SIGKILL);
    }
}

/* Waits for all workers. Polls every 20 ms, so progress shows and signals are noticed. */
static void wait_for(struct cs_process_pool *pool, struct shared *shared,
                     struct worker *children, uint32_t n, struct cs_error *error) {
    const struct timespec pause = {.tv_nsec = 20000000};
    uint32_t left = n;
    while (left) {
        for (uint32_t k = 0; k < n; k++) {
            struct worker *child = children + k;
            int end = 0;
            if (child->process <= 0)
                continue;
            if (waitpid(child->process, &end, WNOHANG) != child->process) {
                hold_to_limits(pool, shared, k, child);
                continue;
            }
            // it died by the limit of time of its task
            const bool overdue =
                WIFSIGNALED(end) && (child->is_late || WTERMSIG(end) == SIGPROF);
            collect(shared, k, overdue, end, error);
            // one that was ended by its limit of time leaves the other tasks
            child->process = 0;
            if (overdue && atomic_load(&shared->next) < pool->n_tasks)
                start(pool, shared, k, child);
            left -= child->process <= 0;
        }
        if (left)
            nanosleep(&pause, NULL);
        report(pool);
    }
}

enum cs_status cs_process_pool_run(struct cs_process_pool *pool, struct cs_error *error) {
    struct shared *shared = cs_process_pool_shared_alloc(sizeof *shared, error);
    struct worker children[CS_PROCESS_POOL_MAX];
    uint32_t n = 0;
    if (!shared)
        return error->status;
    pool->ticks = &shared->ticks;
    /* what waits in the buffers is not to be written twice */
    fflush(NULL);
    while (n < pool->n_workers && n < pool->n_tasks && n < CS_PROCESS_POOL_MAX) {
        start(pool, shared, n, children + n);
        if (children[n].process < 0) {
            if (!n)
                cs_fail(error, CS_ERR_MEMORY, "cannot start a worker: %s", strerror(errno));
            break;
        }
        n++;
    }
    wait_for(pool, shared, children, n, error);
    if (pool->stop && *pool->stop) {
        *error = (struct cs_error){0};
        cs_fail(error, CS_ERR_INTERRUPT, "interrupted");
    }
    cs_process_pool_shared_free(shared, sizeof *shared);
    return error->status;
}
