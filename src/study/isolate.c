/* Runs a task in a forked process and reports how it ended. */
#include "study/isolate.h"

#include "base/clock.h"
#include "sim/crash.h"
#include "study/process_pool.h"

#include <errno.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>
#ifdef __linux__
#include <sys/prctl.h>
#endif

/* Interval between two checks of the calls. */
enum { PAUSE_NANOSECONDS = 20000000 };
#define LONGEST_LOOK 0.2 /* s */

/* Memory that both processes share. */
struct shared {
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
static _Noreturn void serve(const struct cs_isolate *isolate, struct shared *shared,
                            pid_t parent) {
    struct cs_error error = {0};
#ifdef __linux__
    /* also when the parent is killed: nobody else would tell how it ended */
    prctl(PR_SET_PDEATHSIG, SIGKILL);
#endif
    if (getppid() != parent)
        _exit(cs_status_exit_code(CS_ERR_INTERRUPT));
    cs_crash_log_to(&shared->log);
    isolate->task(isolate->ctx, &error);
    if ((fflush(stdout) || ferror(stdout)) && !error.status)
        cs_fail(&error, CS_ERR_FILE, "cannot write to standard output");
    shared->error = error;
    atomic_store(&shared->done, true);
    /* not exit: what modules left to be done there is not waited for */
    _exit(0);
}

/* Returns the call that has lasted too long, or NULL.
 *
 * Each entry and exit of a call increments its counter: an odd value means "inside". The
 * waiting time grows while the counter does not change. Each check adds at most LONGEST_LOOK,
 * so a suspended machine does not count as waiting. */
static const struct cs_crash_call *find_timed_out_call(const struct cs_isolate *isolate,
                                                       const struct shared *shared,
                                                       struct patience *patience) {
    const double now = cs_clock_wall(), passed = now - patience->looked;
    /* while both were stopped, nobody waited */
    const double step = passed < LONGEST_LOOK ? passed : LONGEST_LOOK;
    patience->looked = now;
    for (int k = 0; k < CS_CRASH_SIDES; k++) {
        const struct cs_crash_call *call = shared->log.calls + k;
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
static int wait_for(const struct cs_isolate *isolate, const struct shared *shared, pid_t child,
                    const sigset_t *death, struct cs_error *error) {
    const struct timespec pause = {.tv_nsec = PAUSE_NANOSECONDS};
    struct patience patience = {0};
    int end = 0;
    while (waitpid(child, &end, WNOHANG) != child) {
        const struct cs_crash_call *hung = find_timed_out_call(isolate, shared, &patience);
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
static enum cs_status run(const struct cs_isolate *isolate, struct shared *shared,
                          struct cs_error *error) {
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
        serve(isolate, shared, parent);
    if (child < 0)
        return cs_fail(error, CS_ERR_MEMORY, "cannot start another process: %s",
                       strerror(errno));
    const int end = wait_for(isolate, shared, child, &death, error);
    sigprocmask(SIG_SETMASK, &before, NULL);
    if (error->status)
        return error->status;
    if (!atomic_load(&shared->done))
        return cs_crash_report_print(&shared->log, end, error);
    *error = shared->error;
    return error->status;
}

enum cs_status cs_isolate_run(const struct cs_isolate *isolate, struct cs_error *error) {
    struct shared *shared = cs_process_pool_shared_alloc(sizeof *shared, error);
    if (shared)
        run(isolate, shared, error);
    cs_process_pool_shared_free(shared, sizeof *shared);
    return error->status;
}
