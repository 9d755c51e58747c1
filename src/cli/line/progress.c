/* Shows a progress line with the time that is left: one that changes on a terminal, else one
 * now and then. */
#include "cli/line/print.h"

#include "base/clock.h"
#include "session/session.h"

#include <stdio.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

void cs_progress_begin(struct cs_progress *progress, const char *what, bool quiet) {
    *progress =
        (struct cs_progress){.shown = !quiet, .terminal = isatty(STDERR_FILENO), .label = what};
    progress->start = progress->last = cs_clock_wall();
}

/* s between two lines of a log */
#define OFF_TERMINAL 30

static void write_line(struct cs_progress *progress, const char *line) {
    const int width = (int)strlen(line);
    /* blanks cover what is left of a longer line, on the plainest of terminals too */
    fprintf(stderr, "\r%s%*s", line, width < progress->width ? progress->width - width : 0, "");
    fflush(stderr);
    progress->width = width;
}

void cs_progress_show(void *ctx, uint32_t done, uint32_t total) {
    struct cs_progress *progress = ctx;
    const double now = cs_clock_wall();
    if (!progress->shown || !done ||
        now - progress->last < (progress->terminal ? 0.1 : OFF_TERMINAL))
        return;
    const double left = (now - progress->start) / done * (total - done);
    char line[80];
    snprintf(line, sizeof line, "%s %u of %u, %u %%, %.0f:%02u left", progress->label, done,
             total, (uint32_t)(100.0 * done / total), (left - (uint32_t)left % 60) / 60,
             (uint32_t)left % 60);
    if (progress->terminal)
        write_line(progress, line);
    else
        fprintf(stderr, "%s\n", line);
    progress->last = now;
}

void cs_progress_end(struct cs_progress *progress) {
    if (!progress->width)
        return;
    write_line(progress, "");
    fputc('\r', stderr);
    fflush(stderr);
}

/* Turns signals that end a program into a flag that stops a run at its next step. */

enum { PATIENCE_SECONDS = 2 };

/* Number and time of the first signal, written by the handler only. */
static volatile sig_atomic_t stop;

static struct timespec first;

/* A second signal ends the program only after a pause, because some
 * programs send each signal twice when they pass it on. */
static void request_stop(int signal_number) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    if (!stop) {
        first = now;
        stop = signal_number;
    } else if (now.tv_sec - first.tv_sec >= PATIENCE_SECONDS) {
        signal(signal_number, SIG_DFL);
        raise(signal_number);
    }
}

const volatile sig_atomic_t *cs_interrupt_catch(void) {
    struct sigaction action = {.sa_flags = SA_RESTART};
    sigfillset(&action.sa_mask);
    action.sa_handler = request_stop;
    for (int k = 0; k < CS_INTERRUPTS; k++) {
        struct sigaction before;
        sigaction(cs_interrupts[k], NULL, &before);
        // that of a program under nohup stays ignored
        if (cs_interrupts[k] != SIGHUP || before.sa_handler != SIG_IGN)
            sigaction(cs_interrupts[k], &action, NULL);
    }
    /* a reader that went away must not cut a picture short: the write fails, and is reported */
    signal(SIGPIPE, SIG_IGN);
    return &stop;
}

int cs_interrupt_exit_code(void) {
    return 128 + (stop ? stop : SIGINT);
}
