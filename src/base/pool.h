/* pool.h - the threads of this process, which share the blocks of one loop at a time.
 *
 * There is one pool per process, because the vector kernels of the module contract have no
 * argument to reach one by. A block's result must not depend on the thread that computes it,
 * nor on other blocks of the same loop; results are then the same for any number of threads.
 *
 * Waiting is passive, because a core may belong to another process: nobody waits for a thread
 * that does not come; the others take its blocks. A child process after fork has no pool and
 * may start its own. */
#ifndef CS_POOL_H
#define CS_POOL_H

#include "base/status.h"

#include <stdint.h>

enum { CS_POOL_THREADS_MAX = 64 };

/* Shares loops among `threads` (1..CS_POOL_THREADS_MAX) from now on, the caller included; 1
 * makes no thread. Stops the threads of before. Signals stay with the caller. On CS_ERR_MEMORY
 * there is one thread. Must not be called within a loop, nor while one runs. */
enum cs_status cs_pool_start(uint32_t threads, struct cs_error *error);

/* Ends the threads; loops are the caller's alone again. Allowed without a pool. */
void cs_pool_stop(void);

/* Processors that this process may use, 1..most: a sensible number of threads. */
uint32_t cs_pool_processors(uint32_t most);

/* Threads that share a loop, the caller among them; 1 without a pool. */
uint32_t cs_pool_threads(void);

/* Calls task(arg, block) once for every block 0..blocks-1, in any order and concurrently, and
 * returns when all are done; the caller then sees their results. With one thread, or within or
 * beside another loop, the caller runs all blocks itself, in order. Cannot fail. */
void cs_pool_run(uint32_t blocks, void (*task)(void *arg, uint32_t block), void *arg);

#endif
