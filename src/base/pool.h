/* pool.h - the threads of this process, which share out the blocks of one loop at a time.
 *
 * There is one pool a process, on purpose: the vector kernels of the module contract have no
 * argument through which one could reach them. A block must not depend on who does it, nor on
 * what the others of the same loop do; then results are the same over thread counts.
 *
 * Waiting is passive, as a core may belong to someone else: a thread that does not come is not
 * waited for, and the blocks meant for it are done by the others. A child process after fork
 * has no pool and may start its own.
 */
#ifndef CS_POOL_H
#define CS_POOL_H

#include "base/status.h"

#include <stdint.h>

enum { CS_POOL_THREADS_MAX = 64 };

/* From now on loops are shared by `threads` (1..CS_POOL_THREADS_MAX), the caller among them; 1
 * makes no thread. Threads of before are stopped. Signals stay the caller's. On failure there
 * is one thread, and CS_ERR_MEMORY. Not from within a loop, nor beside one. */
enum cs_status cs_pool_start(uint32_t threads, struct cs_error *error);

/* Ends the threads; loops are the caller's alone again. Allowed without a pool. */
void cs_pool_stop(void);

/* Processors that this process may run on, 1..most: a sensible number of threads. */
uint32_t cs_pool_processors(uint32_t most);

/* Threads that share a loop, the caller among them; 1 without a pool. */
uint32_t cs_pool_threads(void);

/* Calls task(arg, block) once for every block of 0..blocks-1, in any order and at the same
 * time, and returns when all are done; what they wrote is then seen by the caller. In order and
 * by the caller alone with one thread, or within or beside another loop. Cannot fail. */
void cs_pool_run(uint32_t blocks, void (*task)(void *arg, uint32_t block), void *arg);

#endif
