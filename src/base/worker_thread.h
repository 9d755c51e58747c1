/* worker_thread.h - a thread that runs one task at a time, concurrently with the caller.
 *
 * For work that must stay on one thread, such as an OpenGL context, or that overlaps the
 * caller's next work. Results may be read after cs_worker_thread_wait returns. */
#ifndef CS_WORKER_THREAD_H
#define CS_WORKER_THREAD_H

#include "base/status.h"

#include <pthread.h>

struct cs_worker_thread;

/* Starts the thread, with all signals blocked. Returns NULL if none can be started: all calls
 * accept NULL, and the caller then runs each task itself, at once. */
struct cs_worker_thread *cs_worker_thread_create(void);

/* Waits for the task before and starts the next one. work and argument must live until it is
 * done. */
void cs_worker_thread_submit(struct cs_worker_thread *worker, void (*work)(void *argument),
                             void *argument);

/* Returns when the last task is done. */
void cs_worker_thread_wait(struct cs_worker_thread *worker);

/* Waits for the last task, and ends the thread. NULL is allowed. */
void cs_worker_thread_destroy(struct cs_worker_thread *worker);

/* Starts threads that leave signals to the main thread. */

/* pthread_create of a thread with all signals blocked except those of its own faults: a blocked
 * SIGSEGV would end the program without a message. Returns 0, or the error number of
 * pthread_create. */
int cs_thread_start(pthread_t *thread, void *(*work)(void *argument), void *argument);

#endif
