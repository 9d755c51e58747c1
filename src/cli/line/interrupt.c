/* Turns SIGINT and SIGTERM into a flag that stops a run at its next step. */
#include "cli/line/interrupt.h"

#include <time.h>

enum { PATIENCE_SECONDS = 2 };

/* Written by the handler only; `first` is the time of the first signal. */
static volatile sig_atomic_t stop;
static struct timespec first;

/* Handler of both signals. A second signal ends the program only after a pause, because some
 * programs send each signal twice when they pass it on. */
static void request_stop(int signal_number) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    if (!stop) {
        first = now;
        stop = 1;
    } else if (now.tv_sec - first.tv_sec >= PATIENCE_SECONDS) {
        signal(signal_number, SIG_DFL);
        raise(signal_number);
    }
}

const volatile sig_atomic_t *cs_interrupt_catch(void) {
    struct sigaction action = {.sa_flags = SA_RESTART};
    sigfillset(&action.sa_mask);
    action.sa_handler = request_stop;
    sigaction(SIGINT, &action, NULL);
    sigaction(SIGTERM, &action, NULL);
    /* a reader that went away must not cut a picture short: the write fails, and is reported */
    signal(SIGPIPE, SIG_IGN);
    return &stop;
}
