/* lock.h - one process at a time: a lock on a file, which the end of a process gives back. */
#ifndef CS_LOCK_H
#define CS_LOCK_H

#include "base/status.h"

struct cs_lock {
    int descriptor; /* above 0: taken */
};

/* Waits until no other process holds the lock on the file, which is made where there is none.
 * CS_ERR_FILE. */
enum cs_status cs_lock_acquire(struct cs_lock *lock, const char *path, struct cs_error *error);
/* Safe on a zeroed one. */
void cs_lock_release(struct cs_lock *lock);

#endif
