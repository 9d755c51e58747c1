/* arena.h - memory by lifetime: many takes, one release. */
#ifndef CS_ARENA_H
#define CS_ARENA_H

#include "base/status.h"

#include <stddef.h>

struct cs_arena_block;
struct cs_arena_owned;

/* A zeroed struct is an empty arena. */
struct cs_arena {
    struct cs_arena_block *blocks;  /* owned, newest first */
    size_t used;                    /* bytes handed out */
    size_t *part;                   /* borrowed: to which takes are added too; NULL: none */
    struct cs_arena_owned *adopted; /* objects that end with it, newest first */
};

/* Takes bytes, zeroed and 64-byte aligned; they live until finish. NULL and CS_ERR_MEMORY in
 * *error where there is no memory. bytes may be 0 (a valid pointer comes back). */
void *cs_arena_alloc(struct cs_arena *arena, size_t bytes, struct cs_error *error);

/* The same for n items of size bytes, safe against overflow. */
void *cs_arena_alloc_array(struct cs_arena *arena, size_t n, size_t size,
                           struct cs_error *error);

/* Copies a zero-terminated string. */
char *cs_arena_copy_text(struct cs_arena *arena, const char *text, struct cs_error *error);

/* Calls finish(object) when the arena is given back, before its memory goes: for objects in it
 * that hold other memory. CS_ERR_MEMORY: not noted, and not called. */
void cs_arena_adopt(struct cs_arena *arena, void (*finish)(void *object), void *object,
                    struct cs_error *error);

/* items with room for at least `needed` of them, of size bytes each: moved and *room set where
 * there are fewer, twice as many as before. The caller frees them. NULL: no memory, and items
 * are as they were. Unlike an arena's takes, for several threads at the same time. */
void *cs_arena_realloc(void *items, size_t *capacity, size_t needed, size_t size);

/* Gives everything back; the arena is empty again. */
void cs_arena_finish(struct cs_arena *arena);

#endif
