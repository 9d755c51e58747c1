/* thread.h - threads that leave signals to the thread of main. */
#ifndef CS_THREAD_H
#define CS_THREAD_H

#include <pthread.h>

/* pthread_create of a thread with all signals blocked, but for those of its own faults: one
 * that is blocked ends the program without a word. */
int cs_thread_start(pthread_t *thread, void *(*work)(void *argument), void *argument);

#endif
