/* allocations.h - counts what is taken from the heap, by anyone in the process.
 *
 * The program's own malloc stands before the library's; where a sanitizer holds that place, its
 * hooks count. Include in one file of a program. */
#ifndef ALLOCATIONS_H
#define ALLOCATIONS_H

#include <errno.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#ifdef __has_feature
#define ALLOCATIONS_HAS(feature) __has_feature(feature)
#else
#define ALLOCATIONS_HAS(feature) 0
#endif

/* since the start of the program; volatile, as no compiler expects the library to change it */
static volatile uint64_t allocations;

#if defined(__SANITIZE_ADDRESS__) || ALLOCATIONS_HAS(address_sanitizer) ||                     \
    defined(__SANITIZE_THREAD__) || ALLOCATIONS_HAS(thread_sanitizer)

#include <sanitizer/allocator_interface.h>

static void allocations_hook(const volatile void *memory, size_t bytes) {
    (void)memory, (void)bytes;
    allocations++;
}
static void allocations_hook_free(const volatile void *memory) {
    (void)memory;
}
static void allocations_begin(void) {
    __sanitizer_install_malloc_and_free_hooks(allocations_hook, allocations_hook_free);
}

#else

void *__libc_malloc(size_t bytes);
void *__libc_calloc(size_t n, size_t bytes);
void *__libc_realloc(void *memory, size_t bytes);
void *__libc_memalign(size_t alignment, size_t bytes);

void *malloc(size_t bytes) {
    allocations++;
    return __libc_malloc(bytes);
}
void *calloc(size_t n, size_t bytes) {
    allocations++;
    return __libc_calloc(n, bytes);
}
void *realloc(void *memory, size_t bytes) {
    allocations++;
    return __libc_realloc(memory, bytes);
}
void *aligned_alloc(size_t alignment, size_t bytes) {
    allocations++;
    return __libc_memalign(alignment, bytes);
}
int posix_memalign(void **memory, size_t alignment, size_t bytes) {
    allocations++;
    *memory = __libc_memalign(alignment, bytes);
    return *memory ? 0 : ENOMEM;
}

static void allocations_begin(void) {
}

#endif
#endif
