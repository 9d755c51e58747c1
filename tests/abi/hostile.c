/* hostile.c - symplectic Euler that does one thing to the process it runs in: its option says
 * what. For the tests of what clothsim notices by itself, and of what only a second process
 * can. */
#include <clothsim/integrator.h>

#include <fcntl.h>
#include <fenv.h>
#include <locale.h>
#include <math.h>
#include <pthread.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <unistd.h>

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

enum when { CREATE, ADVANCE, STATS, DESTROY };
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
    X("crash-in-destroy", DESTROY, crash_here)
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

struct options {
    int32_t deed;
};

struct hostile {
    const struct cs_host *host;
    double *f; /* (3,n) N */
    size_t deed;
};

static const struct cs_option rows[] = {
    CS_OPTION_CHOICE(struct options, deed, names, 0, "what it does"),
};

/* what HOSTILE names is done while the module is loaded */
__attribute__((constructor)) static void loaded(void) {
    static double nobodys[1];
    const char *asked = getenv("HOSTILE");
    for (size_t k = 0; asked && names[k]; k++)
        if (!strcmp(names[k], asked))
            deeds[k].deed(nobodys);
}

static void act(const struct hostile *self, enum when when, double *x) {
    if (deeds[self->deed].when == when)
        deeds[self->deed].deed(x);
}

static enum cs_step create(const struct cs_host *host, const void *options, void **out) {
    struct hostile *self = host->alloc(host->ctx, sizeof *self);
    const size_t n = host->view->n;
    if (!self || !(self->f = host->alloc(host->ctx, 3 * n * sizeof *self->f)))
        return CS_STEP_FAIL;
    self->host = host;
    self->deed = (size_t)((const struct options *)options)->deed;
    *out = self;
    act(self, CREATE, self->f);
    return CS_STEP_OK;
}

static enum cs_step restart(void *self, double t, const double *x, const double *v) {
    (void)self, (void)t, (void)x, (void)v;
    return CS_STEP_OK;
}

static enum cs_step advance(void *object, double t0, double t1, double *x, double *v) {
    struct hostile *self = object;
    const struct cs_host *host = self->host;
    const uint32_t n = host->view->n;
    const double h = t1 - t0;
    bool changed;
    act(self, ADVANCE, x);
    host->force(host->ctx, t0, x, v, CS_PART_ALL, self->f);
    for (uint32_t k = 0; k < 3 * n; k++) {
        v[k] += h * self->f[k] * host->view->inv_mass[k % n];
        x[k] += h * v[k];
    }
    return host->commit(host->ctx, t1, h, x, v, &changed);
}

static void stats(const void *object, struct cs_stats *out) {
    const struct hostile *self = object;
    (void)out;
    act(self, STATS, self->f);
}

static void destroy(void *object) {
    const struct hostile *self = object;
    act(self, DESTROY, self->f);
}

static const struct cs_integrator hostile = {
    .size = sizeof hostile,
    .name = "hostile",
    .summary = "symplectic Euler that does one thing to its process",
    .source = "tests",
    .order = 1,
    .order_damped = 1,
    .fidelity = CS_FIDELITY_ODE,
    .options = rows,
    .n_options = 1,
    .options_size = sizeof(struct options),
    .create = create,
    .restart = restart,
    .advance = advance,
    .stats = stats,
    .destroy = destroy,
};
static const struct cs_integrator *const all[] = {&hostile};
CS_EXPORT const struct cs_module clothsim_module = {
    .abi = CS_ABI, .size = sizeof hostile, .n = 1, .integrators = all};
