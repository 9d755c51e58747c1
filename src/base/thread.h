/* thread.h - starts threads that leave signals to the main thread. */
#ifndef CS_THREAD_H
#define CS_THREAD_H

#include <pthread.h>

/* pthread_create of a thread with all signals blocked except those of its own faults: a blocked
 * SIGSEGV would end the program without a message. Returns 0, or the error number of
 * pthread_create. */
int cs_thread_start(pthread_t *thread, void *(*work)(void *argument), void *argument);

#endif
