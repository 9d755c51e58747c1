/* thread_partition.h - how the threads of the pool share a system: blocks of particles, chunks
 * of springs.
 *
 * Each thread adds forces to the particles of its own block alone, in the order in which one
 * thread would. Sums, and the bits of the state, are therefore those of one thread. */
#ifndef CS_THREAD_PARTITION_H
#define CS_THREAD_PARTITION_H

#include "model/system/system.h"

/* Fills the partition in system->springs for the pool's present number of threads; bodies and
 * runs must be there. It stays valid for any number of threads. Returns CS_ERR_MEMORY if out of
 * memory. */
enum cs_status cs_thread_partition_build(struct cs_system *system, struct cs_error *error);

#endif
