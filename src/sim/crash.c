/* crash.c - reports a fatal signal, or an end of the program, that comes out of a module.
 *
 * A signal handler gets no argument and may call async-signal-safe functions only. Its texts
 * are therefore stored before each call, and it uses nothing but string functions on its own
 * stack, write and _exit. */
#include "sim/crash.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

/* The fatal signals, and how the message explains them. */
static const struct {
    int number;
    const char *what;
} signals[] = {{SIGSEGV, ": it accessed invalid memory"},
               {SIGBUS, ": it accessed invalid memory"},
               {SIGFPE, ": it divided by zero"},
               {SIGILL, ": it executed an illegal instruction"},
               {SIGABRT, ": it aborted"}};

enum {
    ENDED_BY_EXIT = -1,
    ENDED_BY_CHANGE = -2,
    SIGNALS = sizeof signals / sizeof *signals,
    STACK = 65536,
    TEXT = 1024
};

static const char IN_DESTROY[] = " in destroy";

/* The log of this process, unless cs_crash_log_to gave another; and the handlers before ours.
 */
static struct cs_crash_log own;
static struct cs_crash_log *calls = &own;
static struct sigaction before[SIGNALS];

/* Appends as much as fits; safe in a handler. */
static void add_part(char text[TEXT], const char *part) {
    strncat(text, part, TEXT - 1 - strlen(text));
}

/* Appends the message about a call: kind, name, how it ended, place, explanation. */
static void describe(const struct cs_crash_call *call, const char *how, const char *what,
                     char text[TEXT]) {
    const char *const parts[] = {call->out_of_memory ? "out of memory: " : "",
                                 call->kind,
                                 " \"",
                                 call->name,
                                 "\" ",
                                 how,
                                 call->place,
                                 what};
    for (size_t k = 0; k < sizeof parts / sizeof *parts; k++)
        add_part(text, parts[k]);
}

/* A failed allocation is blamed before the module. */
static enum cs_status status_of(const struct cs_crash_call *call) {
    return call->out_of_memory ? CS_ERR_MEMORY : CS_ERR_MODULE;
}

/* Prints the report and ends the process, by calls that are safe in a handler. A process that
 * is watched from outside prints nothing: the watcher reports. */
static _Noreturn void write_report(const struct cs_crash_call *call, const char *how,
                                   const char *what) {
    char text[TEXT] = "clothsim: ";
    describe(call, how, what, text);
    add_part(text, "\n");
    if (calls == &own && write(STDERR_FILENO, text, strlen(text)) < 0)
        _exit(cs_status_exit_code(CS_ERR_INTERNAL));
    _exit(cs_status_exit_code(status_of(call)));
}

/* The call to blame: the one under way on this thread. A thread that has called no module may
 * belong to one: then any call under way. NULL: the program's own fault. */
static struct cs_crash_call *find_call(void) {
    struct cs_crash_call *found = NULL;
    bool calls_modules = false;
    for (int k = 0; k < CS_CRASH_SIDES; k++) {
        struct cs_crash_call *call = calls->calls + k;
        const bool own_thread = call->kind && pthread_equal(call->thread, pthread_self());
        const bool under_way = cs_crash_is_running(call);
        if (own_thread && under_way)
            return call;
        calls_modules |= own_thread;
        found = under_way ? call : found;
    }
    return calls_modules ? NULL : found;
}

/* The explanation of a signal; "" for another one. */
static const char *signal_text(int number) {
    for (size_t k = 0; k < SIGNALS; k++)
        if (signals[k].number == number)
            return signals[k].what;
    return "";
}

/* The handler. A signal of the program's own is noted, and goes to the handlers of before. An
 * abort has told its reason. */
static void report(int number) {
    /* malloc sets ENOMEM when it fails, and libraries rarely test for it: no hook is needed */
    const bool starved = errno == ENOMEM;
    struct cs_crash_call *call = find_call();
    if (!call) {
        static const char crashed[] = "clothsim: clothsim itself crashed\n";
        calls->own_signal = number;
        if (calls == &own && number != SIGABRT &&
            write(STDERR_FILENO, crashed, sizeof crashed - 1) < 0)
            _exit(cs_status_exit_code(CS_ERR_INTERNAL));
        for (size_t k = 0; k < SIGNALS; k++)
            sigaction(signals[k].number, before + k, NULL);
        raise(number);
        return;
    }
    call->out_of_memory |= starved;
    call->signal = number;
    write_report(call, "crashed ", signal_text(number));
}

/* At exit: a module that calls exit would otherwise end a run like a finished one. */
static void report_exit(void) {
    struct cs_crash_call *call = find_call();
    if (!call)
        return;
    call->out_of_memory |= errno == ENOMEM;
    call->signal = ENDED_BY_EXIT;
    write_report(call, "ended the program ", "");
}

/* Installs the handlers, once. They run on a stack of their own: after a stack overflow the
 * normal one has no room. */
static void prepare(void) {
    static char stack[STACK];
    const stack_t other = {.ss_sp = stack, .ss_size = sizeof stack};
    struct sigaction action = {.sa_handler = report, .sa_flags = SA_ONSTACK};
    sigaltstack(&other, NULL);
    atexit(report_exit);
    for (size_t k = 0; k < SIGNALS; k++)
        sigaction(signals[k].number, &action, before + k);
}

/* The true standard output while calls write to standard error; 0: they do not. */
static int output;

void cs_crash_divert_output(void) {
    output = fcntl(STDOUT_FILENO, F_DUPFD_CLOEXEC, STDERR_FILENO + 1);
}

/* Writes what waits, and then points standard output elsewhere. Where the module left no way to
 * do so, it is closed, which is noticed. */
static void point_output(int file) {
    fflush(stdout);
    if (dup2(file, STDOUT_FILENO) < 0)
        close(STDOUT_FILENO);
}

void cs_crash_watch(enum cs_crash_side side, const char *kind, const char *name,
                    const char *place) {
    static pthread_once_t prepared = PTHREAD_ONCE_INIT;
    struct cs_crash_call *call = calls->calls + side;
    pthread_once(&prepared, prepare);
    if (output > 0 && side == CS_CRASH_METHOD)
        point_output(STDERR_FILENO);
    /* not snprintf, which is slow for a call at every advance */
    const size_t length = strnlen(name, sizeof call->name - 1);
    memcpy(call->name, name, length);
    call->name[length] = 0;
    call->kind = kind;
    call->place = place;
    call->thread = pthread_self();
    call->process = getpid();
    atomic_store(&call->host_parity, 0);
    atomic_fetch_add(&call->call_parity, 1);
    errno = 0;
}

void cs_crash_forget(enum cs_crash_side side) {
    const bool starved = errno == ENOMEM;
    struct cs_crash_call *call = calls->calls + side;
    /* the copy that a fork makes would otherwise write every file a second time */
    if (call->process != getpid())
        _exit(cs_status_exit_code(CS_ERR_MODULE));
    call->out_of_memory |= starved;
    if (output > 0 && side == CS_CRASH_METHOD)
        point_output(output);
    atomic_fetch_add(&call->call_parity, 1);
}

_Noreturn void cs_crash_end(enum cs_crash_side side, const char *what) {
    struct cs_crash_call *call = calls->calls + side;
    call->place = what;
    call->signal = ENDED_BY_CHANGE;
    write_report(call, "changed ", IN_DESTROY);
}

void cs_crash_begin(enum cs_crash_side side) {
    calls->calls[side].out_of_memory = false;
}

bool cs_crash_was_starved(enum cs_crash_side side) {
    return calls->calls[side].out_of_memory;
}

/* one thread writes: no locked instruction is needed */
void cs_crash_note_host(void) {
    atomic_uint *parity = &calls->calls[CS_CRASH_METHOD].host_parity;
    const unsigned now = atomic_load_explicit(parity, memory_order_relaxed);
    atomic_store_explicit(parity, now + 1, memory_order_relaxed);
}

void cs_crash_log_to(struct cs_crash_log *log) {
    calls = log;
}

/* The call that crashed; else one that is under way; else any that was made. NULL: none. */
static const struct cs_crash_call *find_faulting_call(const struct cs_crash_log *log) {
    const struct cs_crash_call *best = NULL;
    for (int k = 0; k < CS_CRASH_SIDES; k++) {
        const struct cs_crash_call *call = log->calls + k;
        if (call->signal)
            return call;
        if (call->kind && (!best || (cs_crash_is_running(call) && !cs_crash_is_running(best))))
            best = call;
    }
    return best;
}

/* The cause of an end as text: signal or exit code. */
static void print_end(int end, char text[TEXT]) {
    if (WIFSIGNALED(end))
        snprintf(text, TEXT, "signal %d (%s)", WTERMSIG(end), strsignal(WTERMSIG(end)));
    else
        snprintf(text, TEXT, "code %d", WEXITSTATUS(end));
}

enum cs_status cs_crash_report_print(const struct cs_crash_log *log, int end,
                                     struct cs_error *error) {
    const struct cs_crash_call *call = find_faulting_call(log);
    char how[TEXT] = "", what[TEXT + 32], text[TEXT] = "";
    print_end(end, how);
    if (!call)
        return cs_fail(error, CS_ERR_INTERNAL, "the run was ended by %s", how);
    if (log->own_signal && !call->signal)
        return cs_fail(
            error, CS_ERR_INTERNAL,
            "clothsim itself crashed%s; the last call of a module, %s \"%s\" %s, had "
            "returned",
            signal_text(log->own_signal), call->kind, call->name, call->place);
    if (call->signal == ENDED_BY_EXIT)
        describe(call, "ended the program ", "", text);
    else if (call->signal == ENDED_BY_CHANGE)
        describe(call, "changed ", IN_DESTROY, text);
    else if (call->signal)
        describe(call, "crashed ", signal_text(call->signal), text);
    else if (cs_crash_is_running(call)) {
        snprintf(what, sizeof what, " with %s", how);
        describe(call, "ended the program ", what, text);
    } else {
        snprintf(what, sizeof what, " with %s", how);
        describe(call, "ended the program after it was called ", what, text);
    }
    return cs_fail(error, status_of(call), "%s", text);
}
