/* Names the module when a fatal signal, or an end of the program, comes out of it. */
#include "sim/crash.h"

#include "base/status.h"

#include <signal.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const struct {
    int number;
    const char *what;
} signals[] = {{SIGSEGV, "used memory that is not there\n"},
               {SIGBUS, "used memory that is not there\n"},
               {SIGFPE, "divided by zero\n"},
               {SIGILL, "ran into what is no code\n"},
               {SIGABRT, "aborted\n"}};
enum { SIGNALS = sizeof signals / sizeof *signals, STACK = 65536 };

/* a handler has no argument of its own: what it prints lies ready */
static struct { const char *kind, *name, *place; /* kind NULL: nobody is watched */ } watched;
static struct sigaction before[SIGNALS];

/* only what is safe in a handler: write and _exit */
static bool put(const char *text) {
    return write(STDERR_FILENO, text, strlen(text)) >= 0;
}

static _Noreturn void tell(const char *how, const char *what) {
    const char *const parts[] = {"clothsim: ", watched.kind, " \"",         watched.name,
                                 "\" ",        how,          watched.place, what};
    for (size_t k = 0; k < sizeof parts / sizeof *parts; k++)
        if (!put(parts[k]))
            _exit(cs_status_exit_code(CS_ERR_INTERNAL));
    _exit(cs_status_exit_code(CS_ERR_MODULE));
}

static void report(int number) {
    char what[64] = ": it ";
    size_t k = 0;
    while (k < SIGNALS - 1 && signals[k].number != number)
        k++;
    strncat(what, signals[k].what, sizeof what - strlen(what) - 1);
    tell("crashed ", what);
}

/* a module that calls exit would else end a run as if it had finished */
static void report_exit(void) {
    if (watched.kind)
        tell("ended the program ", "\n");
}

/* a handler on the stack that has overflowed could not run */
static void take_stack(void) {
    static char stack[STACK];
    const stack_t other = {.ss_sp = stack, .ss_size = sizeof stack};
    sigaltstack(&other, NULL);
    atexit(report_exit);
}

void cs_crash_watch(const char *kind, const char *name, const char *place) {
    static bool prepared;
    struct sigaction action = {.sa_handler = report, .sa_flags = SA_ONSTACK};
    if (!prepared)
        take_stack();
    prepared = true;
    watched.name = name;
    watched.place = place;
    watched.kind = kind;
    for (int k = 0; k < SIGNALS; k++)
        sigaction(signals[k].number, &action, before + k);
}

void cs_crash_forget(void) {
    watched.kind = NULL;
    for (int k = 0; k < SIGNALS; k++)
        sigaction(signals[k].number, before + k, NULL);
}
