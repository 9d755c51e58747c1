/* A thread pool that waits passively. Each thread has a range of a loop's blocks, and takes
 * blocks from the others when its own are done.
 *
 * A loop opens, threads join it, and all take blocks by atomic counters. The caller closes the
 * loop when no block is left and every thread that joined has gone. A thread that wakes too
 * late finds the loop closed and waits for the next one. */
#include "base/pool.h"

#include "base/worker_thread.h"

#include <pthread.h>
#include <sched.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* Polls of a word before sleeping: some microseconds, less than a wake-up takes. Longer polling
 * would hold up another process that needs the core. Chosen by trial. */
enum { LOOKS = 200 };

/* Blocks meant for one thread. They are neighbours, and the same in every loop of as many
 * blocks, so they stay in its cache. Each struct has a cache line of its own, because `next` is
 * written by all threads. */
struct share {
    _Alignas(64) atomic_uint next;
    uint32_t end;
};

/* The pool: ranges of blocks, threads, the loop that runs, and the state that the lock
 * protects. */
struct pool {
    struct share shares[CS_POOL_THREADS_MAX];
    uint32_t n; /* threads, the caller among them */
    pthread_t threads[CS_POOL_THREADS_MAX];
    atomic_uint numbered; /* threads that have taken their index */

    atomic_bool busy; /* a loop runs; the caller of another one runs it alone */
    void (*task)(void *arg, uint32_t block);
    void *arg;

    pthread_mutex_t lock; /* of all members below; atomic ones are read without it */
    pthread_cond_t wake, left;
    atomic_uint loops;  /* number of loops so far; a change announces a new one */
    atomic_uint inside; /* threads in the loop, without the caller */
    uint32_t asleep;
    bool open; /* the loop may be joined */
    bool closing;
};

/* The pool; NULL: one thread. */
static struct pool *pool; /* NULL: one thread */

/* Lets the other hyper-thread of the core work. */
static void cpu_relax(void) {
#if defined(__x86_64__) || defined(__i386__)
    __builtin_ia32_pause();
#endif
}

/* Polls for a moment until *word differs from old. */
static void spin_wait(atomic_uint *word, uint32_t old) {
    for (int k = 0; k < LOOKS && atomic_load_explicit(word, memory_order_relaxed) == old; k++)
        cpu_relax();
}

/* Runs blocks: this thread's own range first, then the remainder of the others'. fetch_add
 * gives each block to one thread; counters may run past `end`. */
static void do_blocks(struct pool *p, uint32_t self) {
    for (uint32_t k = 0; k < p->n; k++) {
        struct share *share = p->shares + (self + k) % p->n;
        for (;;) {
            const uint32_t block =
                atomic_fetch_add_explicit(&share->next, 1, memory_order_relaxed);
            if (block >= share->end)
                break;
            p->task(p->arg, block);
        }
    }
}

/* Main function of a thread: joins loops until the pool closes. */
static void *serve(void *argument) {
    struct pool *p = argument;
    const uint32_t self = 1 + atomic_fetch_add(&p->numbered, 1);
    uint32_t seen = 0;
    pthread_mutex_lock(&p->lock);
    for (;;) {
        /* join a loop once only, and only while it is open */
        while (!p->closing && (!p->open || p->loops == seen)) {
            p->asleep++;
            pthread_cond_wait(&p->wake, &p->lock);
            p->asleep--;
        }
        if (p->closing)
            break;
        seen = p->loops;
        p->inside++;
        pthread_mutex_unlock(&p->lock);
        do_blocks(p, self);
        pthread_mutex_lock(&p->lock);
        if (--p->inside == 0)
            pthread_cond_signal(&p->left);
        pthread_mutex_unlock(&p->lock);
        /* the next loop often follows at once: look for it before sleeping */
        spin_wait(&p->loops, seen);
        pthread_mutex_lock(&p->lock);
    }
    pthread_mutex_unlock(&p->lock);
    return NULL;
}

/* Cuts the blocks into ranges as equal as possible. */
static void distribute(struct pool *p, uint32_t blocks) {
    for (uint32_t k = 0; k < p->n; k++) {
        p->shares[k].next = (uint32_t)((uint64_t)blocks * k / p->n);
        p->shares[k].end = (uint32_t)((uint64_t)blocks * (k + 1) / p->n);
    }
}

/* Announces a loop. The lock orders the loop's data before the threads' first look at them. */
static void open_loop(struct pool *p) {
    pthread_mutex_lock(&p->lock);
    p->open = true;
    p->loops++;
    if (p->asleep)
        pthread_cond_broadcast(&p->wake);
    pthread_mutex_unlock(&p->lock);
}

/* Waits for the threads that are in the loop, and for no other. All blocks are taken by now. */
static void close_loop(struct pool *p) {
    for (uint32_t inside; (inside = p->inside) > 0;) {
        spin_wait(&p->inside, inside);
        if (p->inside == inside)
            break;
    }
    pthread_mutex_lock(&p->lock);
    p->open = false;
    while (p->inside)
        pthread_cond_wait(&p->left, &p->lock);
    pthread_mutex_unlock(&p->lock);
}

void cs_pool_run(uint32_t blocks, void (*task)(void *arg, uint32_t block), void *arg) {
    struct pool *p = pool;
    if (!p || blocks < 2 || atomic_exchange(&p->busy, true)) {
        for (uint32_t block = 0; block < blocks; block++)
            task(arg, block);
        return;
    }
    p->task = task;
    p->arg = arg;
    distribute(p, blocks);
    open_loop(p);
    do_blocks(p, 0);
    close_loop(p);
    p->busy = false;
}

uint32_t cs_pool_processors(uint32_t most) {
#ifdef __linux__
    cpu_set_t allowed;
    const int n = sched_getaffinity(0, sizeof allowed, &allowed) ? 1 : CPU_COUNT(&allowed);
#else
    /* other systems have no mask, or no common call for it */
    const long online = sysconf(_SC_NPROCESSORS_ONLN);
    const int n = online > 0 && online < 65536 ? (int)online : 1;
#endif
    return (uint32_t)n < most ? (uint32_t)n : most;
}

uint32_t cs_pool_threads(void) {
    return pool ? pool->n : 1;
}

/* After fork: the child has none of the threads, and perhaps a lock that one of them held. */
static void forget(void) {
    pool = NULL;
}

/* Makes the pool and its threads. */
static enum cs_status start(uint32_t threads, struct cs_error *error) {
    static bool forgotten_by_children;
    pool = aligned_alloc(_Alignof(struct pool), sizeof *pool);
    /* fork handlers cannot be removed, so that there is one for all pools */
    if (!pool || (!forgotten_by_children && pthread_atfork(NULL, NULL, forget))) {
        free(pool);
        pool = NULL;
        return cs_fail(error, CS_ERR_MEMORY, "out of memory for threads");
    }
    forgotten_by_children = true;
    memset(pool, 0, sizeof *pool);
    pthread_mutex_init(&pool->lock, NULL);
    pthread_cond_init(&pool->wake, NULL);
    pthread_cond_init(&pool->left, NULL);
    /* n counts the threads that run: cs_pool_stop joins no others */
    for (pool->n = 1; pool->n < threads; pool->n++) {
        const int failed = cs_thread_start(pool->threads + pool->n, serve, pool);
        if (!failed)
            continue;
        cs_fail(error, CS_ERR_MEMORY, "cannot start thread %u of %u: %s", pool->n + 1, threads,
                strerror(failed));
        cs_pool_stop();
        break;
    }
    return error->status;
}

enum cs_status cs_pool_start(uint32_t threads, struct cs_error *error) {
    CS_ASSERT(threads >= 1 && threads <= CS_POOL_THREADS_MAX);
    cs_pool_stop();
    return threads == 1 ? CS_OK : start(threads, error);
}

void cs_pool_stop(void) {
    if (!pool)
        return;
    pthread_mutex_lock(&pool->lock);
    pool->closing = true;
    pthread_cond_broadcast(&pool->wake);
    pthread_mutex_unlock(&pool->lock);
    for (uint32_t k = 1; k < pool->n; k++)
        pthread_join(pool->threads[k], NULL);
    pthread_cond_destroy(&pool->left);
    pthread_cond_destroy(&pool->wake);
    pthread_mutex_destroy(&pool->lock);
    free(pool);
    pool = NULL;
}
