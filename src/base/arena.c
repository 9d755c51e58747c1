/* Bump allocation in blocks of at least 64 KiB; everything is freed at once.
 *
 * Allocations are aligned to 64 bytes: a cache line, and the widest vector. One that does not
 * fit the newest block opens a new block; the rest of the old one is lost. */
#include "base/arena.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

enum { ALIGNMENT = 64, BLOCK_BYTES = 64 * 1024 };

/* Header of a block. Its bytes begin at the next multiple of 64 after it. */
struct cs_arena_block {
    struct cs_arena_block *next;
    size_t used, capacity;
    unsigned char *bytes;
};

/* Allocates a zeroed block. Returns NULL if out of memory, or if the size would overflow. */
static struct cs_arena_block *block_create(size_t capacity) {
    if (capacity > SIZE_MAX - 2 * ALIGNMENT)
        return NULL;
    struct cs_arena_block *block = NULL;
    unsigned char *memory = calloc(1, capacity + 2 * ALIGNMENT);
    if (!memory)
        return NULL;
    block = (struct cs_arena_block *)(void *)memory;
    const uintptr_t start = (uintptr_t)(memory + sizeof *block);
    block->bytes = memory + sizeof *block + (ALIGNMENT - start % ALIGNMENT) % ALIGNMENT;
    block->capacity = capacity;
    return block;
}

void *cs_arena_alloc(struct cs_arena *arena, size_t bytes, struct cs_error *error) {
    /* an overflow saturates, and block_create refuses it */
    const size_t size = bytes <= SIZE_MAX - ALIGNMENT
                            ? (bytes + ALIGNMENT - 1) / ALIGNMENT * ALIGNMENT
                            : SIZE_MAX;
    struct cs_arena_block *block = arena->blocks;
    if (!block || block->capacity - block->used < size) {
        block = block_create(size > BLOCK_BYTES ? size : BLOCK_BYTES);
        if (!block) {
            cs_fail(error, CS_ERR_MEMORY, "out of memory (%zu more bytes were requested)",
                    bytes);
            return NULL;
        }
        block->next = arena->blocks;
        arena->blocks = block;
    }
    void *taken = block->bytes + block->used;
    block->used += size;
    arena->used += bytes;
    if (arena->part)
        *arena->part += bytes;
    return taken;
}

void *cs_arena_alloc_array(struct cs_arena *arena, size_t n, size_t size,
                           struct cs_error *error) {
    size_t bytes;
    if (__builtin_mul_overflow(n, size, &bytes))
        bytes = SIZE_MAX;
    return cs_arena_alloc(arena, bytes, error);
}

char *cs_arena_copy_text(struct cs_arena *arena, const char *text, struct cs_error *error) {
    const size_t bytes = strlen(text) + 1;
    char *copy = cs_arena_alloc(arena, bytes, error);
    return copy ? memcpy(copy, text, bytes) : NULL;
}

/* An adopted object. The node itself lies in the arena. */
struct cs_arena_owned {
    struct cs_arena_owned *next;
    void (*finish)(void *object);
    void *object;
};

void cs_arena_adopt(struct cs_arena *arena, void (*finish)(void *object), void *object,
                    struct cs_error *error) {
    struct cs_arena_owned *owned = cs_arena_alloc(arena, sizeof *owned, error);
    if (!owned)
        return;
    *owned = (struct cs_arena_owned){arena->adopted, finish, object};
    arena->adopted = owned;
}

void *cs_arena_realloc(void *items, size_t *room, size_t needed, size_t size) {
    if (needed <= *room)
        return items;
    const size_t larger = needed > 2 * *room ? needed : 2 * *room;
    size_t bytes;
    void *moved = __builtin_mul_overflow(larger, size, &bytes) ? NULL : realloc(items, bytes);
    *room = moved ? larger : *room;
    return moved;
}

void cs_arena_finish(struct cs_arena *arena) {
    for (; arena->adopted; arena->adopted = arena->adopted->next)
        arena->adopted->finish(arena->adopted->object);
    while (arena->blocks) {
        struct cs_arena_block *next = arena->blocks->next;
        free(arena->blocks);
        arena->blocks = next;
    }
    *arena = (struct cs_arena){0};
}
