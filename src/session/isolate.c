/* isolate.c - runs tasks in forked processes and reports how they ended. */
#include "base/clock.h"
#include "session/process_pool.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdio.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#ifdef __linux__
#include <sys/prctl.h>
#endif

/* Interval between two checks of the children. */
enum { PAUSE_NANOSECONDS = 20000000 };

/* s without a call to the host, of a method that is to stop */
#define LONGEST_SILENCE 0.7

/* Memory that both processes share. */
struct isolate_shared {
    struct cs_crash_log log;
    struct cs_error error; /* of the task */
    atomic_bool done;      /* the task has returned: the error is complete */
};

/* Waiting times, by which hung calls are found. */
struct patience {
    struct cs_crash_patience calls;
    double task, stopping; /* s: of the task; since it was asked to stop */
    bool told;             /* the child was asked to stop */
};

/* A slot of a queue. */
struct child {
    const struct cs_isolate_queue *queue;
    struct isolate_shared *shared; /* owned */
    uint32_t slot;
    pid_t pid; /* 0: none */
    struct patience patience;
};

/* Settings of a process that is one of many. */
static void become_cell(const struct cs_isolate *isolate) {
    const int file =
        isolate->is_cell ? open("/proc/self/oom_score_adj", O_WRONLY | O_CLOEXEC) : -1;
    if (file >= 0) {
        /* where it may not be written, the kernel chooses by size alone */
        (void)!write(file, "1000", 4);
        close(file);
    }
    if (isolate->is_cell) {
        dup2(STDERR_FILENO, STDOUT_FILENO);
        clearerr(stdout); // a failure of the parent's
    }
    const struct rlimit space = {(rlim_t)isolate->bytes, (rlim_t)isolate->bytes};
    if (isolate->bytes > 0)
        setrlimit(RLIMIT_AS, &space);
}

/* The child: runs the task and exits without atexit handlers. */
static _Noreturn void child_serve(const struct child *child, pid_t parent) {
    struct cs_error error = {0};
#ifdef __linux__
    /* also when the parent is killed: nobody else would tell how it ended */
    prctl(PR_SET_PDEATHSIG, SIGKILL);
#endif
    if (getppid() != parent)
        _exit(cs_status_exit_code(CS_ERR_INTERRUPT));
    become_cell(&child->queue->isolate);
    cs_crash_log_to(&child->shared->log);
    if (!child->queue->isolate.is_cell)
        cs_crash_divert_output();
    child->queue->task(child->queue->ctx, child->slot, &error);
    if ((fflush(stdout) || ferror(stdout)) && !error.status)
        cs_fail(&error, CS_ERR_FILE, "cannot write to standard output");
    child->shared->error = error;
    atomic_store(&child->shared->done, true);
    /* not exit: what modules left to be done there is not waited for */
    _exit(0);
}

/* Adds the time since the last look, and returns the call that has lasted longer than its
 * limit, which is that of a stop once the child was asked to; or NULL. A method that is to stop
 * and does not come back to the host is not waited for. */
static const struct cs_crash_call *find_timed_out_call(struct child *child) {
    struct patience *patience = &child->patience;
    const struct cs_isolate *isolate = &child->queue->isolate;
    const struct cs_crash_log *log = &child->shared->log;
    const bool stops = patience->told && isolate->stop_seconds > 0 &&
                       !(isolate->seconds > 0 && isolate->seconds < isolate->stop_seconds);
    const double limit = stops ? isolate->stop_seconds : isolate->seconds;
    const double step = cs_crash_patience_look(&patience->calls, log);
    // the times of the task go on between its calls too
    patience->task += step;
    patience->stopping += patience->told ? step : 0;
    for (int k = 0; k < CS_CRASH_SIDES; k++)
        if (cs_crash_is_running(log->calls + k) && limit > 0 &&
            patience->calls.waited[k] > limit)
            return log->calls + k;
    return stops ? cs_crash_find_silent(&patience->calls, log, LONGEST_SILENCE) : NULL;
}

/* Reports that the whole task has reached its limit, and the call that is under way. */
static enum cs_status report_task_limit(const struct child *child, struct cs_error *result) {
    const double seconds = child->queue->isolate.task_seconds;
    for (int k = 0; k < CS_CRASH_SIDES; k++) {
        const struct cs_crash_call *call = child->shared->log.calls + k;
        if (call->kind && cs_crash_is_running(call))
            return cs_fail(result, CS_ERR_MODULE,
                           "ended at its limit of %g s: %s \"%s\" was %s", seconds, call->kind,
                           call->name, call->place);
    }
    return cs_fail(result, CS_ERR_MODULE, "ended at its limit of %g s", seconds);
}

/* Reports a limit that the child has reached; CS_OK: none. */
static enum cs_status check_limits(struct child *child, struct cs_error *result) {
    const struct cs_isolate *isolate = &child->queue->isolate;
    const struct cs_crash_call *hung = find_timed_out_call(child);
    if (hung && child->patience.told && isolate->stop_seconds > 0)
        return cs_fail(result, CS_ERR_INTERRUPT,
                       "interrupted; %s \"%s\" did not return %s and was ended", hung->kind,
                       hung->name, hung->place);
    if (hung)
        return cs_fail(result, CS_ERR_MODULE, "%s \"%s\" hung %s: it was ended after %g s",
                       hung->kind, hung->name, hung->place, isolate->seconds);
    if (isolate->task_seconds > 0 && child->patience.task > isolate->task_seconds)
        return report_task_limit(child, result);
    if (isolate->is_cell && isolate->stop_seconds > 0 &&
        child->patience.stopping > isolate->stop_seconds)
        return cs_fail(result, CS_ERR_INTERRUPT, "interrupted");
    return CS_OK;
}

/* Passes a request to stop on to the child, once. */
static void pass_on_stop(struct child *child) {
    const volatile sig_atomic_t *stop = child->queue->isolate.stop;
    if (!stop || !*stop || child->patience.told)
        return;
    child->patience.told = true;
    memset(child->patience.calls.waited, 0, sizeof child->patience.calls.waited);
    memset(child->patience.calls.silent, 0, sizeof child->patience.calls.silent);
    kill(child->pid, SIGTERM);
}

/* Looks at a child: true if it is dead, with the result of its task. One that reached a limit
 * is killed. */
static bool child_ended(struct child *child, struct cs_error *result) {
    int end = 0;
    bool dead = waitpid(child->pid, &end, WNOHANG) == child->pid;
    if (!dead && check_limits(child, result)) {
        kill(child->pid, SIGKILL);
        dead = waitpid(child->pid, &end, 0) == child->pid;
    }
    if (!dead) {
        pass_on_stop(child);
        return false;
    }
    child->pid = 0;
    if (result->status)
        return true;
    if (!atomic_load(&child->shared->done))
        cs_crash_report_print(&child->shared->log, end, result);
    else
        *result = child->shared->error;
    return true;
}

/* Forks the child of a slot. before: the mask of signals that its task has. */
static enum cs_status child_start(struct child *child, const sigset_t *before,
                                  struct cs_error *error) {
    const pid_t parent = getpid();
    *child->shared = (struct isolate_shared){0};
    child->patience = (struct patience){.calls.looked = cs_clock_wall()};
    /* what waits in the buffers is not to be written twice */
    fflush(NULL);
    child->pid = fork();
    if (!child->pid) {
        sigprocmask(SIG_SETMASK, before, NULL);
        child_serve(child, parent);
    }
    child->patience.calls.process = child->pid;
    if (child->pid < 0) {
        child->pid = 0;
        cs_fail(error, CS_ERR_MEMORY, "cannot start another process: %s", strerror(errno));
    }
    return error->status;
}

/* Looks at all slots: takes results, and fills free slots. Returns the number of tasks under
 * way. */
static uint32_t serve_slots(const struct cs_isolate_queue *queue, struct child *children,
                            const sigset_t *before, struct cs_error *error) {
    const volatile sig_atomic_t *stop = queue->isolate.stop;
    uint32_t n = 0;
    for (uint32_t k = 0; k < queue->n_slots; k++) {
        struct child *child = children + k;
        struct cs_error result = {0};
        if (child->pid && child_ended(child, &result))
            queue->ended(queue->ctx, k, &result, error);
        if (!child->pid && !error->status && !(stop && *stop) &&
            queue->next(queue->ctx, k, error) && child_start(child, before, error))
            return 0;
        n += child->pid != 0;
    }
    return error->status ? 0 : n;
}

/* Runs all tasks with SIGCHLD blocked, so that it ends a pause early. */
static void serve_queue(const struct cs_isolate_queue *queue, struct child *children,
                        struct cs_error *error) {
    const struct timespec pause = {.tv_nsec = PAUSE_NANOSECONDS};
    sigset_t death, before;
    /* where it is ignored, as some callers leave it, children could not be waited for */
    signal(SIGCHLD, SIG_DFL);
    sigemptyset(&death);
    sigaddset(&death, SIGCHLD);
    sigprocmask(SIG_BLOCK, &death, &before);
    while (serve_slots(queue, children, &before, error))
        sigtimedwait(&death, NULL, &pause);
    for (uint32_t k = 0; k < queue->n_slots; k++)
        if (children[k].pid) {
            kill(children[k].pid, SIGKILL);
            waitpid(children[k].pid, NULL, 0);
        }
    sigprocmask(SIG_SETMASK, &before, NULL);
}

enum cs_status cs_isolate_queue_run(const struct cs_isolate_queue *queue,
                                    struct cs_error *error) {
    struct child children[CS_PROCESS_POOL_MAX] = {{0}};
    for (uint32_t k = 0; k < queue->n_slots && !error->status; k++)
        children[k] = (struct child){
            .queue = queue,
            .shared = cs_process_pool_shared_alloc(sizeof *children->shared, error),
            .slot = k};
    if (!error->status)
        serve_queue(queue, children, error);
    for (uint32_t k = 0; k < queue->n_slots; k++)
        cs_process_pool_shared_free(children[k].shared, sizeof *children->shared);
    return error->status;
}

/* A queue of one task. */
struct single {
    const struct cs_isolate *isolate;
    bool begun;
};

static bool single_next(void *ctx, uint32_t slot, struct cs_error *error) {
    struct single *single = ctx;
    const bool next = !single->begun;
    (void)slot, (void)error;
    single->begun = true;
    return next;
}

static enum cs_status single_task(void *ctx, uint32_t slot, struct cs_error *error) {
    const struct single *single = ctx;
    (void)slot;
    return single->isolate->task(single->isolate->ctx, error);
}

static void single_ended(void *ctx, uint32_t slot, const struct cs_error *result,
                         struct cs_error *error) {
    (void)slot, (void)ctx;
    *error = *result;
}

enum cs_status cs_isolate_run(const struct cs_isolate *isolate, struct cs_error *error) {
    struct single single = {.isolate = isolate};
    const struct cs_isolate_queue queue = {.isolate = *isolate,
                                           .n_slots = 1,
                                           .ctx = &single,
                                           .next = single_next,
                                           .task = single_task,
                                           .ended = single_ended};
    cs_isolate_queue_run(&queue, error);
    return error->status || single.begun ? error->status
                                         : cs_fail(error, CS_ERR_INTERRUPT, "interrupted");
}
