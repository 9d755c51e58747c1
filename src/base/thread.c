/* Starts threads that have all signals blocked except those of their own faults. */
#include "base/thread.h"

#include <signal.h>

int cs_thread_start(pthread_t *thread, void *(*work)(void *argument), void *argument) {
    static const int own[] = {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT};
    sigset_t others, before;
    sigfillset(&others);
    for (size_t k = 0; k < sizeof own / sizeof *own; k++)
        sigdelset(&others, own[k]);
    /* a thread starts with the mask of the one that makes it */
    pthread_sigmask(SIG_SETMASK, &others, &before);
    const int failed = pthread_create(thread, NULL, work, argument);
    pthread_sigmask(SIG_SETMASK, &before, NULL);
    return failed;
}
