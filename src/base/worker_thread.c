/* A worker thread that runs one task at a time, handed over by a condition variable. */
#include "base/worker_thread.h"

#include <signal.h>
#include <stdbool.h>
#include <stdlib.h>

/* A thread and its only task. */
struct cs_worker_thread {
    pthread_t thread;
    pthread_mutex_t lock; /* of the members below */
    pthread_cond_t changed;
    void (*work)(void *argument); /* NULL: idle */
    void *argument;
    bool closing;
};

/* Runs tasks, without the lock, until the worker closes. */
static void *thread_main(void *object) {
    struct cs_worker_thread *worker = object;
    pthread_mutex_lock(&worker->lock);
    for (;;) {
        while (!worker->work && !worker->closing)
            pthread_cond_wait(&worker->changed, &worker->lock);
        if (!worker->work)
            break;
        pthread_mutex_unlock(&worker->lock);
        worker->work(worker->argument);
        pthread_mutex_lock(&worker->lock);
        worker->work = NULL;
        pthread_cond_broadcast(&worker->changed);
    }
    pthread_mutex_unlock(&worker->lock);
    return NULL;
}

struct cs_worker_thread *cs_worker_thread_create(void) {
    struct cs_worker_thread *worker = calloc(1, sizeof *worker);
    if (!worker)
        return NULL;
    pthread_mutex_init(&worker->lock, NULL);
    pthread_cond_init(&worker->changed, NULL);
    if (!cs_thread_start(&worker->thread, thread_main, worker))
        return worker;
    free(worker);
    return NULL;
}

/* Waits until the worker is idle; called, and left, with the lock held. */
static void wait_for_work(struct cs_worker_thread *worker) {
    while (worker->work)
        pthread_cond_wait(&worker->changed, &worker->lock);
}

void cs_worker_thread_submit(struct cs_worker_thread *worker, void (*work)(void *argument),
                             void *argument) {
    CS_ASSERT(work);
    if (!worker) {
        work(argument);
        return;
    }
    pthread_mutex_lock(&worker->lock);
    wait_for_work(worker);
    worker->work = work;
    worker->argument = argument;
    pthread_cond_broadcast(&worker->changed);
    pthread_mutex_unlock(&worker->lock);
}

void cs_worker_thread_wait(struct cs_worker_thread *worker) {
    if (!worker)
        return;
    pthread_mutex_lock(&worker->lock);
    wait_for_work(worker);
    pthread_mutex_unlock(&worker->lock);
}

void cs_worker_thread_destroy(struct cs_worker_thread *worker) {
    if (!worker)
        return;
    pthread_mutex_lock(&worker->lock);
    wait_for_work(worker);
    worker->closing = true;
    pthread_cond_broadcast(&worker->changed);
    pthread_mutex_unlock(&worker->lock);
    pthread_join(worker->thread, NULL);
    pthread_cond_destroy(&worker->changed);
    pthread_mutex_destroy(&worker->lock);
    free(worker);
}

/* Starts threads that have all signals blocked except those of their own faults. */

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
