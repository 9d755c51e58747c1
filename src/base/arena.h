/* arena.h - memory by lifetime: many allocations, freed together. */
#ifndef CS_ARENA_H
#define CS_ARENA_H

#include "base/status.h"

#include <stdbool.h>
#include <stddef.h>

struct cs_arena_block;
struct cs_arena_owned;

/* A region of memory. A zeroed struct is an empty arena. Not for several threads at the same
 * time. */
struct cs_arena {
    struct cs_arena_block *blocks;  /* owned, newest first */
    size_t used;                    /* bytes handed out */
    size_t *part;                   /* borrowed: a second count of bytes; NULL: none */
    struct cs_arena_owned *adopted; /* objects to finish with it, newest first */
};

/* Returns the bytes that this process can still take: the least of what is left under the
 * limits of its address space and data, under the memory limits of its control groups (both
 * versions), and of the machine's free memory and swap. *limit names the least. Returns
 * infinity if none is known. root: before /proc and /sys; "" but in tests. */
double cs_memory_left(const char *root, const char **limit);

/* Allocates bytes, zeroed and 64-byte aligned, which live until cs_arena_finish. bytes may be
 * 0; the result is a valid pointer. Returns NULL and CS_ERR_MEMORY in *error if out of memory.
 */
void *cs_arena_alloc(struct cs_arena *arena, size_t bytes, struct cs_error *error);

/* The same for n items of size bytes; an overflow of the product counts as out of memory. */
void *cs_arena_alloc_array(struct cs_arena *arena, size_t n, size_t size,
                           struct cs_error *error);
/* Sets a pointer to n items of its type. */
#define CS_ARENA_ARRAY(arena, items, n, error)                                                 \
    ((items) = cs_arena_alloc_array(arena, n, sizeof *(items), error))

/* Copies a zero-terminated string. Returns NULL if out of memory. */
char *cs_arena_copy_text(struct cs_arena *arena, const char *text, struct cs_error *error);

/* Registers an object that holds other memory: finish(object) is called by cs_arena_finish
 * before the arena's blocks are freed, newest first. On CS_ERR_MEMORY it is not registered, and
 * finish is not called. */
void cs_arena_adopt(struct cs_arena *arena, void (*finish)(void *object), void *object,
                    struct cs_error *error);

/* Grows a malloc'd array to at least `needed` items of size bytes, at least doubling it, unless
 * it is large enough. address: of the pointer to it, which moves with it. The caller frees it.
 * Returns false if out of memory; the array and *capacity are then as before. May be called by
 * several threads, unlike an arena. */
bool cs_arena_realloc(void *address, size_t *capacity, size_t needed, size_t size);
#define CS_ARENA_REALLOC(items, capacity, needed)                                              \
    cs_arena_realloc(&(items), &(capacity), needed, sizeof *(items))

/* Finishes adopted objects and frees all blocks; the arena is empty afterwards. */
void cs_arena_finish(struct cs_arena *arena);

#endif
