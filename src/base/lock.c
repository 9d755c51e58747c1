/* Takes and gives back locks on files. */
#include "base/lock.h"

#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <sys/file.h>
#include <unistd.h>

enum cs_status cs_lock_acquire(struct cs_lock *lock, const char *path, struct cs_error *error) {
    *lock = (struct cs_lock){0};
    const int descriptor = open(path, O_RDWR | O_CREAT | O_CLOEXEC, 0666);
    if (descriptor < 0)
        return cs_fail(error, CS_ERR_FILE, "cannot open %s: %s", path, strerror(errno));
    // a signal interrupts the wait, not the lock: who is told to stop looks at that once it is
    // held, and no owner waits long. A file system without locks has no owners.
    while (flock(descriptor, LOCK_EX) && errno == EINTR)
        ;
    lock->descriptor = descriptor;
    return CS_OK;
}

void cs_lock_release(struct cs_lock *lock) {
    if (lock->descriptor > 0)
        close(lock->descriptor);
    *lock = (struct cs_lock){0};
}
