/* stops.c - stops a program at the start and before each call that files of its folder see, so
 * that a scheduler chooses which of several processes goes on (LD_PRELOAD; glibc).
 *
 * A call that waits for a lock is made again after a stop instead: nothing waits elsewhere.
 * Paths that begin with / are the program's own, and other processes and threads that it makes
 * run on. */
/* both names of a call are meant, not one for the other */
#undef _FILE_OFFSET_BITS

#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

static pid_t first;

__attribute__((constructor)) static void begin(void) {
    first = getpid();
    raise(SIGSTOP);
}

static void stop(void) {
    if (first && gettid() == first)
        raise(SIGSTOP);
}

static void stop_at(const char *path) {
    if (*path != '/')
        stop();
}

/* declares `real`, the call of that name in the C library */
#define REAL(name)                                                                             \
    __typeof__(&name) real;                                                                    \
    *(void **)&real = dlsym(RTLD_NEXT, #name)

#define OPEN(name, ...)                                                                        \
    va_list list;                                                                              \
    va_start(list, flags);                                                                     \
    const mode_t mode = flags & O_CREAT ? va_arg(list, mode_t) : 0;                            \
    va_end(list);                                                                              \
    stop_at(path);                                                                             \
    REAL(name);                                                                                \
    return real(__VA_ARGS__, flags, mode)

int open(const char *path, int flags, ...) {
    OPEN(open, path);
}

int open64(const char *path, int flags, ...) {
    OPEN(open64, path);
}

int openat(int folder, const char *path, int flags, ...) {
    OPEN(openat, folder, path);
}

int openat64(int folder, const char *path, int flags, ...) {
    OPEN(openat64, folder, path);
}

int rename(const char *from, const char *to) {
    stop_at(from);
    REAL(rename);
    return real(from, to);
}

int unlink(const char *path) {
    stop_at(path);
    REAL(unlink);
    return real(path);
}

int unlinkat(int folder, const char *path, int flags) {
    stop();
    REAL(unlinkat);
    return real(folder, path, flags);
}

int mkdir(const char *path, mode_t mode) {
    stop_at(path);
    REAL(mkdir);
    return real(path, mode);
}

int ftruncate(int file, off_t length) {
    stop();
    REAL(ftruncate);
    return real(file, length);
}

int ftruncate64(int file, off64_t length) {
    stop();
    REAL(ftruncate64);
    return real(file, length);
}

int close(int file) {
    stop(); /* a lock may end here */
    REAL(close);
    return real(file);
}

int flock(int file, int operation) {
    REAL(flock);
    int result;
    do {
        stop();
        result = real(file, operation | LOCK_NB);
    } while (result && errno == EWOULDBLOCK && !(operation & LOCK_NB));
    return result;
}

static int control(int (*real)(int, int, ...), int file, int command, void *argument) {
    const bool waits = command == F_SETLKW || command == F_OFD_SETLKW;
    const int try_ = command == F_SETLKW ? F_SETLK : F_OFD_SETLK;
    int result;
    do {
        if (waits || command == F_SETLK || command == F_OFD_SETLK)
            stop();
        result = real(file, waits ? try_ : command, argument);
    } while (waits && result && (errno == EAGAIN || errno == EACCES));
    return result;
}

#define CONTROL(name)                                                                          \
    va_list list;                                                                              \
    va_start(list, command);                                                                   \
    void *argument = va_arg(list, void *);                                                     \
    va_end(list);                                                                              \
    REAL(name);                                                                                \
    return control(real, file, command, argument)

int fcntl(int file, int command, ...) {
    CONTROL(fcntl);
}

int fcntl64(int file, int command, ...) {
    CONTROL(fcntl64);
}
