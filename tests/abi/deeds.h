/* deeds.h - what hostile.c does to the process that it runs in: one function a deed, and the
 * list of their names, each with the call of the module in which it happens. */
#ifndef DEEDS_H
#define DEEDS_H

#include <clothsim/integrator.h>

#include <fenv.h>
#include <locale.h>
#include <math.h>
#include <pthread.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>

static const struct cs_host *acting; /* of the method that does its deed */

static void nothing(double *x) {
    (void)x;
}

static void hang(double *x) {
    (void)x;
    for (;;)
        pause();
}

static void kill_itself(double *x) {
    (void)x;
    raise(SIGKILL);
}

static void end(double *x) {
    (void)x;
    _exit(0);
}

static void fork_once(double *x) {
    (void)x;
    if (fork() < 0)
        abort();
}

static void write_far(double *x) {
    *(volatile double *)(x + ((size_t)1 << 40)) = 1;
}

static void write_to_code(double *x) {
    (void)x;
    *(volatile char *)(uintptr_t)&nothing = 1;
}

static void free_foreign(double *x) {
    volatile uintptr_t foreign = (uintptr_t)(x + 1);
    free((void *)foreign);
}

static void free_twice(double *x) {
    (void)x;
    void *volatile memory = malloc(4000);
    void *volatile other = malloc(4000);
    free(memory);
    free(memory);
    free(other);
}

static void divide(double *x) {
    volatile int zero = 0;
    x[0] = 1 / zero;
    /* some processors give a number */
    raise(SIGFPE);
}

static void *crash(void *argument) {
    (void)argument;
    volatile int *volatile nowhere = NULL;
    *nowhere = 1;
    return NULL;
}

static void crash_here(double *x) {
    crash(x);
}

static void crash_in_a_thread(double *x) {
    pthread_t thread;
    if (!pthread_create(&thread, NULL, crash, x))
        pthread_join(thread, NULL);
}

static void *doze(void *argument) {
    for (;;)
        pause();
    return argument;
}

static void leave_a_thread(double *x) {
    pthread_t thread;
    pthread_create(&thread, NULL, doze, x);
}

static void round_up(double *x) {
    (void)x;
    fesetround(FE_UPWARD);
}

/* harmless, and installed everywhere; one of a country would read 0.5 as 0 */
static void change_locale(double *x) {
    (void)x;
    setlocale(LC_ALL, "C.UTF-8");
}

static void ignore_signals(double *x) {
    (void)x;
    signal(SIGINT, SIG_IGN);
}

static void move_away(double *x) {
    (void)x;
    if (chdir("/"))
        abort();
}

static void close_all(double *x) {
    (void)x;
    for (int k = 0; k < 64; k++)
        close(k);
}

/* all memory is taken by others; twice as much as there may be is asked for */
static void *take_too_much(void) {
    const struct rlimit little = {.rlim_cur = 1 << 20, .rlim_max = RLIM_INFINITY};
    setrlimit(RLIMIT_AS, &little);
    return malloc((size_t)1 << 32);
}

static void use_no_memory(double *x) {
    (void)x;
    *(volatile char *)take_too_much() = 1;
}

static void abort_without_memory(double *x) {
    (void)x;
    if (!take_too_much())
        abort();
}

static void exit_normally(double *x) {
    (void)x;
    exit(0);
}

static void end_with_error(double *x) {
    (void)x;
    _exit(3);
}

static void exit_thread(double *x) {
    (void)x;
    pthread_exit(NULL);
}

static void stop_itself(double *x) {
    (void)x;
    raise(SIGSTOP);
}

static void loop(double *x) {
    for (volatile double *y = x;; y[0] += 0)
        ;
}

static void loop_deaf(double *x) {
    sigset_t all;
    sigfillset(&all);
    sigprocmask(SIG_BLOCK, &all, NULL);
    loop(x);
}

static void hear_nothing_and_crash(double *x) {
    signal(SIGSEGV, SIG_DFL);
    crash(x);
}

static void (*volatile again)(double *x);

static void recurse(double *x) {
    volatile double large[100000];
    large[0] = x[0];
    again(x);
    x[0] = large[0];
}

static void recurse_for_ever(double *x) {
    again = recurse;
    recurse(x);
}

/* as a leak does: pages are touched, until none is given */
static void eat_memory(double *x) {
    (void)x;
    for (;;) {
        volatile char *piece = malloc(1 << 20);
        for (size_t k = 0; k < 1 << 20; k += 4096)
            piece[k] = 1;
    }
}

static void no_more_files(double *x) {
    const struct rlimit none = {0, 0};
    (void)x;
    setrlimit(RLIMIT_NOFILE, &none);
}

static void no_more_time(double *x) {
    const struct rlimit none = {0, 0};
    (void)x;
    setrlimit(RLIMIT_CPU, &none);
    loop(x);
}

static void set_alarm(double *x) {
    alarm(1);
    loop(x);
}

static void print(double *x) {
    (void)x;
    printf("1 00000000000000000000000000000000\n");
    (void)!write(STDOUT_FILENO, "2 1\n", 4);
}

static void close_output(double *x) {
    (void)x;
    close(STDOUT_FILENO);
}

static void become_another(double *x) {
    (void)x;
    execl("/bin/true", "true", (char *)NULL);
}

static void jump_nowhere(double *x) {
    void (*volatile nowhere)(double *) = NULL;
    nowhere(x);
}

static void unmap_stack(double *x) {
    volatile char here = 0;
    (void)x;
    munmap((void *)((uintptr_t)&here & ~(uintptr_t)4095), 4096);
}

static void make_nan(double *x) {
    x[0] = (double)NAN;
}

static void terminate(double *x) {
    (void)x;
    raise(SIGTERM);
}

static void flush_to_zero(double *x) {
    (void)x;
#ifdef __SSE2__
    __builtin_ia32_ldmxcsr(__builtin_ia32_stmxcsr() | 0x8040);
#endif
}

static void trap(double *x) {
    (void)x;
    feenableexcept(FE_INEXACT);
}

static void move_state(double *x) {
    x[0] += 1;
}

/* against the const of both */
static void write_to_view(double *x) {
    volatile double *mass = (double *)(uintptr_t)acting->view->mass;
    (void)x;
    mass[0] *= 2;
}

static void write_to_sizes(double *x) {
    struct cs_view *view = (struct cs_view *)(uintptr_t)acting->view;
    (void)x;
    *(volatile uint32_t *)&view->n = 1;
}

enum when { CREATE, ADVANCE, STATS, DESTROY, RESTART };
#define DEEDS(X)                                                                               \
    X("nothing", ADVANCE, nothing)                                                             \
    X("hang", ADVANCE, hang)                                                                   \
    X("hang-in-create", CREATE, hang)                                                          \
    X("kill", ADVANCE, kill_itself)                                                            \
    X("end", ADVANCE, end)                                                                     \
    X("fork", ADVANCE, fork_once)                                                              \
    X("write-far", ADVANCE, write_far)                                                         \
    X("write-to-code", ADVANCE, write_to_code)                                                 \
    X("free", ADVANCE, free_foreign)                                                           \
    X("free-twice", ADVANCE, free_twice)                                                       \
    X("divide", ADVANCE, divide)                                                               \
    X("crash-in-a-thread", ADVANCE, crash_in_a_thread)                                         \
    X("leave-a-thread", ADVANCE, leave_a_thread)                                               \
    X("round", ADVANCE, round_up)                                                              \
    X("locale", ADVANCE, change_locale)                                                        \
    X("signals", ADVANCE, ignore_signals)                                                      \
    X("folder", ADVANCE, move_away)                                                            \
    X("close", ADVANCE, close_all)                                                             \
    X("use-no-memory", ADVANCE, use_no_memory)                                                 \
    X("abort-without-memory", CREATE, abort_without_memory)                                    \
    X("crash-in-stats", STATS, crash_here)                                                     \
    X("crash-in-destroy", DESTROY, crash_here)                                                 \
    X("exit", ADVANCE, exit_normally)                                                          \
    X("exit-in-create", CREATE, exit_normally)                                                 \
    X("exit-in-destroy", DESTROY, exit_normally)                                               \
    X("exit-in-restart", RESTART, exit_normally)                                               \
    X("end-in-create", CREATE, end)                                                            \
    X("end-in-stats", STATS, end)                                                              \
    X("end-in-destroy", DESTROY, end)                                                          \
    X("end-in-restart", RESTART, end)                                                          \
    X("end-with-error", ADVANCE, end_with_error)                                               \
    X("exit-thread", ADVANCE, exit_thread)                                                     \
    X("stop", ADVANCE, stop_itself)                                                            \
    X("loop", ADVANCE, loop)                                                                   \
    X("loop-in-restart", RESTART, loop)                                                        \
    X("loop-in-destroy", DESTROY, loop)                                                        \
    X("loop-deaf", ADVANCE, loop_deaf)                                                         \
    X("crash-unheard", ADVANCE, hear_nothing_and_crash)                                        \
    X("crash-in-restart", RESTART, crash_here)                                                 \
    X("crash-in-create", CREATE, crash_here)                                                   \
    X("kill-in-create", CREATE, kill_itself)                                                   \
    X("kill-in-destroy", DESTROY, kill_itself)                                                 \
    X("recurse", ADVANCE, recurse_for_ever)                                                    \
    X("eat-memory", ADVANCE, eat_memory)                                                       \
    X("no-files", ADVANCE, no_more_files)                                                      \
    X("no-time", ADVANCE, no_more_time)                                                        \
    X("alarm", ADVANCE, set_alarm)                                                             \
    X("print", ADVANCE, print)                                                                 \
    X("close-output", ADVANCE, close_output)                                                   \
    X("exec", ADVANCE, become_another)                                                         \
    X("jump-nowhere", ADVANCE, jump_nowhere)                                                   \
    X("unmap-stack", ADVANCE, unmap_stack)                                                     \
    X("nan", ADVANCE, make_nan)                                                                \
    X("terminate", ADVANCE, terminate)                                                         \
    X("flush-to-zero", ADVANCE, flush_to_zero)                                                 \
    X("trap", ADVANCE, trap)                                                                   \
    X("fork-in-create", CREATE, fork_once)                                                     \
    X("folder-in-destroy", DESTROY, move_away)                                                 \
    X("move-in-restart", RESTART, move_state)                                                  \
    X("write-to-view", ADVANCE, write_to_view)                                                 \
    X("write-to-view-in-create", CREATE, write_to_view)                                        \
    X("write-to-sizes", ADVANCE, write_to_sizes)
static const struct {
    enum when when;
    void (*deed)(double *x);
} deeds[] = {
#define X(name, when, deed) {when, deed},
    DEEDS(X)
#undef X
};
static const char *const names[] = {
#define X(name, when, deed) name,
    DEEDS(X)
#undef X
        NULL};

#endif
