/* Distributes independent tasks over forked processes. */
#include "study/process_pool.h"

#include "base/clock.h"
#include "sim/crash.h"

#include <errno.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdbool.h>
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

void cs_process_pool_tick(struct cs_process_pool *workers, uint32_t ticks) {
    __atomic_fetch_add(workers->ticks, ticks, __ATOMIC_RELAXED);
}

/* Limits the processor time of one task: SIGPROF then ends the worker, which covers a task that
 * never returns to check its budget. */
static void limit_task(const struct cs_process_pool *workers) {
    const struct itimerval limit = {.it_value.tv_sec = (time_t)workers->task_seconds_max};
    if (workers->task_seconds_max > 0)
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
static void serve(struct cs_process_pool *workers, struct shared *shared, uint32_t worker) {
    struct cs_error *error = shared->errors + worker;
    while (!error->status) {
        const uint32_t task = atomic_fetch_add(&shared->next, 1);
        if (task >= workers->n_tasks)
            return;
        limit_task(workers);
        workers->task(workers->ctx, task, error);
    }
    /* no worker begins another task */
    atomic_store(&shared->next, workers->n_tasks);
}

static void report(const struct cs_process_pool *workers) {
    if (workers->progress)
        workers->progress(workers->progress_ctx,
                          __atomic_load_n(workers->ticks, __ATOMIC_RELAXED));
}

/* Takes over the error of a worker that ended. Death by SIGPROF is the time limit, and no
 * error; any other death is reported as a crash. */
static void collect(struct shared *shared, uint32_t worker, int end, struct cs_error *error) {
    if (error->status)
        return;
    if (shared->errors[worker].status)
        *error = shared->errors[worker];
    else if (WIFSIGNALED(end) && WTERMSIG(end) == SIGPROF)
        return;
    else if (end || !shared->done[worker])
        cs_crash_report_print(shared->logs + worker, end, error);
    if (error->status)
        atomic_store(&shared->next, UINT32_MAX / 2);
}

/* Forks a worker. Returns its process in the parent, < 0 if there is none. */
static pid_t start(struct cs_process_pool *workers, struct shared *shared, uint32_t worker) {
    /* that of the worker before, which was ended in a task */
    shared->logs[worker] = (struct cs_crash_log){0};
    const pid_t child = fork();
    if (child)
        return child;
    cs_crash_log_to(shared->logs + worker);
    store_memory();
    serve(workers, shared, worker);
    atomic_store(shared->done + worker, true);
    _exit(0);
}

/* True if a worker died by its time limit while tasks are left: it is replaced. */
static bool wants_another(const struct cs_process_pool *workers, struct shared *shared,
                          int end) {
    return WIFSIGNALED(end) && WTERMSIG(end) == SIGPROF &&
           atomic_load(&shared->next) < workers->n_tasks;
}

/* Passes a request to stop on to all workers. */
static void terminate_workers(const struct cs_process_pool *workers, const pid_t *children,
                              uint32_t n) {
    for (uint32_t k = 0; workers->stop && *workers->stop && k < n; k++)
        if (children[k] > 0)
            kill(children[k], SIGTERM);
}

/* Waits for all workers. Polls every 20 ms, so progress shows and signals are noticed. */
static void wait_for(struct cs_process_pool *workers, struct shared *shared, pid_t *children,
                     uint32_t n, struct cs_error *error) {
    const struct timespec pause = {.tv_nsec = 20000000};
    uint32_t left = n;
    while (left) {
        for (uint32_t k = 0; k < n; k++) {
            int end = 0;
            if (children[k] <= 0 || waitpid(children[k], &end, WNOHANG) != children[k])
                continue;
            collect(shared, k, end, error);
            children[k] = wants_another(workers, shared, end) ? start(workers, shared, k) : 0;
            left -= children[k] <= 0;
        }
        terminate_workers(workers, children, n);
        if (left)
            nanosleep(&pause, NULL);
        report(workers);
    }
}

enum cs_status cs_process_pool_run(struct cs_process_pool *workers, struct cs_error *error) {
    struct shared *shared = cs_process_pool_shared_alloc(sizeof *shared, error);
    pid_t children[CS_PROCESS_POOL_MAX];
    uint32_t n = 0;
    if (!shared)
        return error->status;
    workers->ticks = &shared->ticks;
    /* what waits in the buffers is not to be written twice */
    fflush(NULL);
    while (n < workers->n_workers && n < workers->n_tasks && n < CS_PROCESS_POOL_MAX) {
        children[n] = start(workers, shared, n);
        if (children[n] < 0) {
            if (!n)
                cs_fail(error, CS_ERR_MEMORY, "cannot start a worker: %s", strerror(errno));
            break;
        }
        n++;
    }
    wait_for(workers, shared, children, n, error);
    if (workers->stop && *workers->stop) {
        *error = (struct cs_error){0};
        cs_fail(error, CS_ERR_INTERRUPT, "interrupted");
    }
    cs_process_pool_shared_free(shared, sizeof *shared);
    return error->status;
}

/* Runs a task in a forked process and reports how it ended. */

#ifdef __linux__
#include <sys/prctl.h>
#endif

/* Interval between two checks of the calls. */
enum { PAUSE_NANOSECONDS = 20000000 };

#define LONGEST_LOOK 0.2 /* s */

/* Memory that both processes share. */
struct isolate_shared {
    struct cs_crash_log log;
    struct cs_error error; /* of the task */
    atomic_bool done;      /* the task has returned: the error is complete */
};

/* Waiting times of the calls, by which hung ones are found. */
struct patience {
    unsigned edges[CS_CRASH_SIDES];
    double waited[CS_CRASH_SIDES]; /* s */
    double looked;                 /* s, by the clock */
    bool told;                     /* the child was asked to stop */
};

/* The child: runs the task and exits without atexit handlers. */
static _Noreturn void isolate_serve(const struct cs_isolate *isolate,
                                    struct isolate_shared *isolate_shared, pid_t parent) {
    struct cs_error error = {0};
#ifdef __linux__
    /* also when the parent is killed: nobody else would tell how it ended */
    prctl(PR_SET_PDEATHSIG, SIGKILL);
#endif
    if (getppid() != parent)
        _exit(cs_status_exit_code(CS_ERR_INTERRUPT));
    cs_crash_log_to(&isolate_shared->log);
    isolate->task(isolate->ctx, &error);
    if ((fflush(stdout) || ferror(stdout)) && !error.status)
        cs_fail(&error, CS_ERR_FILE, "cannot write to standard output");
    isolate_shared->error = error;
    atomic_store(&isolate_shared->done, true);
    /* not exit: what modules left to be done there is not waited for */
    _exit(0);
}

/* Returns the call that has lasted too long, or NULL.
 *
 * Each entry and exit of a call increments its counter: an odd value means "inside". The
 * waiting time grows while the counter does not change. Each check adds at most LONGEST_LOOK,
 * so a suspended machine does not count as waiting. */
static const struct cs_crash_call *
find_timed_out_call(const struct cs_isolate *isolate,
                    const struct isolate_shared *isolate_shared, struct patience *patience) {
    const double now = cs_clock_wall(), passed = now - patience->looked;
    /* while both were stopped, nobody waited */
    const double step = passed < LONGEST_LOOK ? passed : LONGEST_LOOK;
    patience->looked = now;
    for (int k = 0; k < CS_CRASH_SIDES; k++) {
        const struct cs_crash_call *call = isolate_shared->log.calls + k;
        const unsigned edges = atomic_load(&call->call_parity);
        patience->waited[k] = edges == patience->edges[k] ? patience->waited[k] + step : 0;
        patience->edges[k] = edges;
        if (edges % 2 && patience->waited[k] > isolate->seconds)
            return call;
    }
    return NULL;
}

/* Passes a request to stop on to the child, once. */
static void pass_on_stop(const struct cs_isolate *isolate, pid_t child,
                         struct patience *patience) {
    if (!isolate->stop || !*isolate->stop || patience->told)
        return;
    patience->told = true;
    kill(child, SIGTERM);
}

/* Waits until the child is dead, and returns its wait status. SIGCHLD ends a pause early. A
 * hung child is killed. */
static int isolate_wait_for(const struct cs_isolate *isolate,
                            const struct isolate_shared *isolate_shared, pid_t child,
                            const sigset_t *death, struct cs_error *error) {
    const struct timespec pause = {.tv_nsec = PAUSE_NANOSECONDS};
    struct patience patience = {0};
    int end = 0;
    while (waitpid(child, &end, WNOHANG) != child) {
        const struct cs_crash_call *hung =
            find_timed_out_call(isolate, isolate_shared, &patience);
        if (hung) {
            cs_fail(error, CS_ERR_MODULE, "%s \"%s\" hung %s: it was ended after %g s",
                    hung->kind, hung->name, hung->place, isolate->seconds);
            kill(child, SIGKILL);
            waitpid(child, &end, 0);
            return end;
        }
        pass_on_stop(isolate, child, &patience);
        sigtimedwait(death, NULL, &pause);
    }
    return end;
}

/* Forks, waits and collects the error of the task. */
static enum cs_status run(const struct cs_isolate *isolate,
                          struct isolate_shared *isolate_shared, struct cs_error *error) {
    sigset_t death, before;
    const pid_t parent = getpid();
    /* where it is ignored, as some callers leave it, children could not be waited for */
    signal(SIGCHLD, SIG_DFL);
    sigemptyset(&death);
    sigaddset(&death, SIGCHLD);
    sigprocmask(SIG_BLOCK, &death, &before);
    /* what waits in the buffers is not to be written twice */
    fflush(NULL);
    const pid_t child = fork();
    if (child <= 0)
        sigprocmask(SIG_SETMASK, &before, NULL);
    if (!child)
        isolate_serve(isolate, isolate_shared, parent);
    if (child < 0)
        return cs_fail(error, CS_ERR_MEMORY, "cannot start another process: %s",
                       strerror(errno));
    const int end = isolate_wait_for(isolate, isolate_shared, child, &death, error);
    sigprocmask(SIG_SETMASK, &before, NULL);
    if (error->status)
        return error->status;
    if (!atomic_load(&isolate_shared->done))
        return cs_crash_report_print(&isolate_shared->log, end, error);
    *error = isolate_shared->error;
    return error->status;
}

enum cs_status cs_isolate_run(const struct cs_isolate *isolate, struct cs_error *error) {
    struct isolate_shared *isolate_shared =
        cs_process_pool_shared_alloc(sizeof *isolate_shared, error);
    if (isolate_shared)
        run(isolate, isolate_shared, error);
    cs_process_pool_shared_free(isolate_shared, sizeof *isolate_shared);
    return error->status;
}
