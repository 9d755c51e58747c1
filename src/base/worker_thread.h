/* worker_thread.h - a thread that does one piece of work at a time, beside the caller.
 *
 * For things that must stay on one thread, such as an OpenGL context, or that are to overlap
 * what the caller does next. What work leaves behind may be read after cs_worker_thread_wait.
 */
#ifndef CS_WORKER_THREAD_H
#define CS_WORKER_THREAD_H

#include "base/status.h"

struct cs_worker_thread;

/* Starts the thread, with all signals blocked: they are the caller's. NULL where none can be
 * started: every call takes it, and the caller then does the work itself, at once. */
struct cs_worker_thread *cs_worker_thread_create(void);

/* Waits for the work before and hands over the next. work and argument must live until it is
 * done. */
void cs_worker_thread_submit(struct cs_worker_thread *worker, void (*work)(void *argument),
                             void *argument);
/* Returns when nothing is left to do. */
void cs_worker_thread_wait(struct cs_worker_thread *worker);

/* Waits, and ends the thread. NULL is fine. */
void cs_worker_thread_destroy(struct cs_worker_thread *worker);

#endif
