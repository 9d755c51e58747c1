/* thread_partition.h - how the threads of the pool share a system: blocks of particles, chunks
 * of springs.
 *
 * Each thread adds forces to the particles of its block alone, in the order in which one thread
 * would: so sums, and the state's bits, are those of one thread. */
#ifndef CS_THREAD_PARTITION_H
#define CS_THREAD_PARTITION_H

#include "model/system/system.h"

/* Fills the part of system->springs that is about threads, for those of the pool now; bodies
 * and runs are there. It holds for any number of threads later. CS_ERR_MEMORY. */
enum cs_status cs_thread_partition_build(struct cs_system *system, struct cs_error *error);

#endif
