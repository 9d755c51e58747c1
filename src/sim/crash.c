/* Names the integrator when a fatal signal arrives in its first call. */
#include "sim/crash.h"

#include "base/status.h"

#include <signal.h>
#include <stdio.h>
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
enum { SIGNALS = sizeof signals / sizeof *signals };

/* a handler has no argument of its own: what it prints is made ready before */
static char message[160];
static struct sigaction before[SIGNALS];

/* only what is safe in a handler: write and _exit */
static void report(int number) {
    const char *what = "crashed\n";
    for (int k = 0; k < SIGNALS; k++)
        if (signals[k].number == number)
            what = signals[k].what;
    if (write(STDERR_FILENO, message, strlen(message)) < 0 ||
        write(STDERR_FILENO, what, strlen(what)) < 0)
        _exit(cs_status_exit_code(CS_ERR_INTERNAL));
    _exit(cs_status_exit_code(CS_ERR_MODULE));
}

void cs_crash_watch(const char *integrator) {
    struct sigaction action = {.sa_handler = report};
    snprintf(message, sizeof message, "clothsim: integrator \"%.64s\" crashed in create: it ",
             integrator);
    for (int k = 0; k < SIGNALS; k++)
        sigaction(signals[k].number, &action, before + k);
}

void cs_crash_forget(void) {
    for (int k = 0; k < SIGNALS; k++)
        sigaction(signals[k].number, before + k, NULL);
}
