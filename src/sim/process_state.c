/* process_state.c - reads and restores the process-wide state around foreign code. */
#include "sim/process_state.h"

#include <fenv.h>
#include <locale.h>
#include <poll.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#if defined(__SSE2__)
#include <xmmintrin.h>
/* MXCSR bits of exceptions that have occurred: ordinary arithmetic sets them. */
enum { STICKY_FLAGS = 0x3f };
static unsigned control_get(void) {
    return _mm_getcsr() & ~(unsigned)STICKY_FLAGS;
}
static void control_set(unsigned control) {
    _mm_setcsr(control);
}
#elif defined(__aarch64__)
static unsigned control_get(void) {
    unsigned long fpcr;
    __asm__ volatile("mrs %0, fpcr" : "=r"(fpcr));
    return (unsigned)fpcr;
}
static void control_set(unsigned control) {
    __asm__ volatile("msr fpcr, %0" : : "r"((unsigned long)control));
}
#else
static unsigned control_get(void) {
    return 0;
}
static void control_set(unsigned control) {
    (void)control;
}
#endif

const char cs_process_state_mode[] = "the floating-point mode";
static const int numbers[CS_PROCESS_STATE_SIGNALS] = {SIGINT, SIGTERM};

/* A bit for each of the streams 0, 1, 2 that is open: poll reports a closed one as POLLNVAL. */
static unsigned open_streams(void) {
    struct pollfd streams[] = {{.fd = 0}, {.fd = 1}, {.fd = 2}};
    enum { STREAMS = sizeof streams / sizeof *streams };
    unsigned open = 0;
    poll(streams, STREAMS, 0);
    for (unsigned k = 0; k < STREAMS; k++)
        open |= (unsigned)!(streams[k].revents & POLLNVAL) << k;
    return open;
}

/* True if there is a child process: waitid fails with ECHILD only without any. WNOWAIT leaves
 * it to be waited for by its owner. */
static bool is_parent(void) {
    siginfo_t info;
    return !waitid(P_ALL, 0, &info, WEXITED | WNOHANG | WNOWAIT);
}

struct cs_process_state cs_process_state_save(void) {
    struct cs_process_state guard = {.fp_control = control_get(),
                                     .rounding = fegetround(),
                                     .streams = open_streams(),
                                     .has_children = is_parent()};
    struct stat info;
    for (int k = 0; k < CS_PROCESS_STATE_SIGNALS; k++)
        sigaction(numbers[k], NULL, guard.signals + k);
    if (!stat(".", &info)) {
        guard.cwd_device = info.st_dev;
        guard.cwd_inode = info.st_ino;
    }
    return guard;
}

/* Restores handlers that differ; true if one did. */
static bool restore_signals(const struct cs_process_state *guard) {
    bool changed = false;
    for (int k = 0; k < CS_PROCESS_STATE_SIGNALS; k++) {
        struct sigaction now;
        sigaction(numbers[k], NULL, &now);
        if (now.sa_handler == guard->signals[k].sa_handler)
            continue;
        sigaction(numbers[k], guard->signals + k, NULL);
        changed = true;
    }
    return changed;
}

/* Restores the C locale, in which numbers are read and written with a point; true if it had
 * changed. */
static bool restore_locale(void) {
    if (!strcmp(setlocale(LC_NUMERIC, NULL), "C") && !strcmp(localeconv()->decimal_point, "."))
        return false;
    uselocale(LC_GLOBAL_LOCALE);
    setlocale(LC_ALL, "C");
    return true;
}

/* True if the working folder is another one, or gone. */
static bool has_moved(const struct cs_process_state *guard) {
    struct stat info;
    return stat(".", &info) || info.st_dev != guard->cwd_device ||
           info.st_ino != guard->cwd_inode;
}

/* Restores rounding, traps and flush-to-zero; true if one had changed. */
static bool restore_mode(const struct cs_process_state *guard) {
    if (control_get() == guard->fp_control && fegetround() == guard->rounding)
        return false;
    fesetround(guard->rounding);
    control_set(guard->fp_control);
    return true;
}

const char *cs_process_state_restore(const struct cs_process_state *guard) {
    /* all three are restored, whichever is reported */
    const bool mode = restore_mode(guard), signals = restore_signals(guard),
               locale = restore_locale();
    return mode                                  ? cs_process_state_mode
           : signals                             ? "a signal handler"
           : locale                              ? "the locale"
           : has_moved(guard)                    ? "the working folder"
           : open_streams() != guard->streams    ? "the open standard streams"
           : is_parent() && !guard->has_children ? "the set of processes"
                                                 : NULL;
}
