/* arena.h - memory by lifetime: many takes, one release. */
#ifndef CS_ARENA_H
#define CS_ARENA_H

#include "base/status.h"

#include <stddef.h>

struct cs_arena_block;

/* A zeroed struct is an empty arena. */
struct cs_arena {
    struct cs_arena_block *blocks; /* owned, newest first */
    size_t used;                   /* bytes handed out, for the plan */
};

/* Takes bytes, zeroed and 64-byte aligned; they live until finish. NULL and CS_ERR_MEMORY in
 * *error where there is no memory. bytes may be 0 (a valid pointer comes back). */
void *cs_arena_take(struct cs_arena *arena, size_t bytes, struct cs_error *error);

/* The same for n items of size bytes, safe against overflow. */
void *cs_arena_take_n(struct cs_arena *arena, size_t n, size_t size, struct cs_error *error);

/* Copies a zero-terminated string. */
char *cs_arena_take_text(struct cs_arena *arena, const char *text, struct cs_error *error);

/* Gives everything back; the arena is empty again. */
void cs_arena_finish(struct cs_arena *arena);

#endif
