/* shim.c - makes the n-th call of a kind fail, in any program that it is loaded into before all
 * other libraries (LD_PRELOAD; glibc).
 *
 * FAULT=KIND:N fails the N-th call since the start, KIND:N+ that and all later ones; KIND is
 * one of those below. FAULT_COUNT names a file into which the number of calls of each goes at
 * the end. */
/* both names of a call are meant, not one for the other */
#undef _FILE_OFFSET_BITS

#include <dirent.h>
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum kind { MEMORY, WRITE, RENAME, FSYNC, THREAD, OPEN, LSEEK, UNLINK, MODULE, KINDS };
static const char *const names[] = {"memory", "write", "rename", "fsync", "thread",
                                    "open",   "lseek", "unlink", "module"};

static unsigned long wanted; /* 0: none fails */
static int kind;
static bool lasting;
static atomic_ulong calls[KINDS];

static bool fails(enum kind of) {
    const unsigned long call = atomic_fetch_add(calls + of, 1) + 1;
    return wanted && kind == (int)of && (lasting ? call >= wanted : call == wanted);
}

__attribute__((constructor)) static void begin(void) {
    const char *fault = getenv("FAULT"), *number = fault ? strchr(fault, ':') : NULL;
    char *end = NULL;
    if (!number)
        return;
    while (kind < KINDS - 1 && strncmp(names[kind], fault, (size_t)(number - fault)) != 0)
        kind++;
    wanted = strtoul(number + 1, &end, 10);
    lasting = *end == '+';
}

__attribute__((destructor)) static void end(void) {
    char text[256];
    int length = 0;
    const char *path = getenv("FAULT_COUNT");
    if (!path)
        return;
    wanted = 0;
    for (int k = 0; k < KINDS; k++)
        length += snprintf(text + length, sizeof text - (size_t)length, "%s %lu\n", names[k],
                           atomic_load(calls + k));
    const int file = open(path, O_WRONLY | O_CREAT | O_TRUNC, 0666);
    if (file < 0 || write(file, text, (size_t)length) != length)
        abort();
}

/* --- memory: dlsym itself would ask for some, hence glibc's own names --- */
extern void *__libc_malloc(size_t), *__libc_calloc(size_t, size_t),
    *__libc_realloc(void *, size_t), *__libc_memalign(size_t, size_t);

static bool starves(void) {
    if (!fails(MEMORY))
        return false;
    errno = ENOMEM;
    return true;
}

void *malloc(size_t size) {
    return starves() ? NULL : __libc_malloc(size);
}

void *calloc(size_t n, size_t size) {
    return starves() ? NULL : __libc_calloc(n, size);
}

void *realloc(void *memory, size_t size) {
    return starves() ? NULL : __libc_realloc(memory, size);
}

void *aligned_alloc(size_t alignment, size_t size) {
    return starves() ? NULL : __libc_memalign(alignment, size);
}

int posix_memalign(void **memory, size_t alignment, size_t size) {
    *memory = starves() ? NULL : __libc_memalign(alignment, size);
    return *memory ? 0 : ENOMEM;
}

/* --- the others: the next library's --- */
#define REAL(name)                                                                             \
    static __typeof__(name) *real;                                                             \
    if (!real)                                                                                 \
        *(void **)&real = dlsym(RTLD_NEXT, #name);

/* a full disk; the mark that ferror looks at is glibc's */
static bool is_full(FILE *file) {
    /* messages come through: what they say is looked at */
    if (file == stderr || !fails(WRITE))
        return false;
    if (file)
        file->_flags |= 0x20;
    errno = ENOSPC;
    return true;
}

ssize_t write(int file, const void *bytes, size_t size) {
    REAL(write)
    return file != STDERR_FILENO && is_full(NULL) ? -1 : real(file, bytes, size);
}

ssize_t pwrite64(int file, const void *bytes, size_t size, off64_t offset) {
    REAL(pwrite64)
    return is_full(NULL) ? -1 : real(file, bytes, size, offset);
}

size_t fwrite(const void *bytes, size_t size, size_t n, FILE *file) {
    REAL(fwrite)
    return is_full(file) ? 0 : real(bytes, size, n, file);
}

int fflush(FILE *file) {
    REAL(fflush)
    return is_full(file) ? EOF : real(file);
}

int fclose(FILE *file) {
    REAL(fclose)
    const bool full = is_full(file);
    return real(file) || full ? EOF : 0;
}

int rename(const char *from, const char *to) {
    REAL(rename)
    if (!fails(RENAME))
        return real(from, to);
    errno = EACCES;
    return -1;
}

int fsync(int file) {
    REAL(fsync)
    if (!fails(FSYNC))
        return real(file);
    errno = EIO;
    return -1;
}

static bool cannot_move(void) {
    if (!fails(LSEEK))
        return false;
    errno = EIO;
    return true;
}

off64_t lseek64(int file, off64_t offset, int whence) {
    REAL(lseek64)
    return cannot_move() ? -1 : real(file, offset, whence);
}

off_t lseek(int file, off_t offset, int whence) {
    return lseek64(file, offset, whence);
}

int fseeko64(FILE *file, off64_t offset, int whence) {
    REAL(fseeko64)
    return cannot_move() ? -1 : real(file, offset, whence);
}

int fseeko(FILE *file, off_t offset, int whence) {
    return fseeko64(file, offset, whence);
}

int fseek(FILE *file, long offset, int whence) {
    return fseeko64(file, offset, whence);
}

void rewind(FILE *file) {
    if (!fseeko64(file, 0, SEEK_SET))
        clearerr(file);
}

static bool may_not_remove(void) {
    if (!fails(UNLINK))
        return false;
    errno = EACCES;
    return true;
}

int unlink(const char *path) {
    REAL(unlink)
    return may_not_remove() ? -1 : real(path);
}

int remove(const char *path) {
    REAL(remove)
    return may_not_remove() ? -1 : real(path);
}

int pthread_create(pthread_t *restrict thread, const pthread_attr_t *restrict attributes,
                   void *(*work)(void *), void *restrict argument) {
    REAL(pthread_create)
    return fails(THREAD) ? EAGAIN : real(thread, attributes, work, argument);
}

static bool has_no_descriptor(void) {
    if (!fails(OPEN))
        return false;
    errno = EMFILE;
    return true;
}

/* the loader opens modules by itself: these are read for their hash */
static bool is_unreadable_module(const char *path) {
    const char *ending = strrchr(path, '.');
    if (!ending || strcmp(ending, ".so") != 0 || !fails(MODULE))
        return false;
    errno = EACCES;
    return true;
}

int open64(const char *path, int flags, ...) {
    REAL(open64)
    va_list rest;
    va_start(rest, flags);
    const mode_t mode = flags & (O_CREAT | O_TMPFILE) ? va_arg(rest, mode_t) : 0;
    va_end(rest);
    return has_no_descriptor() || is_unreadable_module(path) ? -1 : real(path, flags, mode);
}

int open(const char *path, int flags, ...) {
    va_list rest;
    va_start(rest, flags);
    const mode_t mode = flags & (O_CREAT | O_TMPFILE) ? va_arg(rest, mode_t) : 0;
    va_end(rest);
    return open64(path, flags, mode);
}

FILE *fopen64(const char *path, const char *mode) {
    REAL(fopen64)
    return has_no_descriptor() ? NULL : real(path, mode);
}

FILE *fopen(const char *path, const char *mode) {
    return fopen64(path, mode);
}

FILE *fdopen(int file, const char *mode) {
    REAL(fdopen)
    return has_no_descriptor() ? NULL : real(file, mode);
}

DIR *opendir(const char *path) {
    REAL(opendir)
    return has_no_descriptor() ? NULL : real(path);
}
