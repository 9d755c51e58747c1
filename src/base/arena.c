/* Bump allocation in blocks of at least 16 KiB; everything is freed at once.
 *
 * Allocations are aligned to 64 bytes: a cache line, and the widest vector. One that does not
 * fit the newest block opens a new block; the rest of the old one is lost. */
#include "base/arena.h"

#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <unistd.h>

enum { ALIGNMENT = 64, BLOCK_BYTES = 16 * 1024 };

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

bool cs_arena_realloc(void *address, size_t *capacity, size_t needed, size_t size) {
    if (needed <= *capacity)
        return true;
    const size_t larger = needed > 2 * *capacity ? needed : 2 * *capacity;
    size_t bytes;
    void *items;
    // the type of the pointer is the caller's
    memcpy(&items, address, sizeof items);
    items = __builtin_mul_overflow(larger, size, &bytes) ? NULL : realloc(items, bytes);
    if (!items)
        return false;
    memcpy(address, &items, sizeof items);
    *capacity = larger;
    return true;
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

enum { PATH_BYTES = 4200 };

/* Reads the number after a key at the begin of a line, or the first number of the file for the
 * key "". Returns NAN if there is none: "max" in a control group is none. */
static double read_number(const char *path, const char *key) {
    char line[256];
    double value = (double)NAN;
    FILE *file = fopen(path, "re");
    while (file && isnan(value) && fgets(line, sizeof line, file))
        if (!strncmp(line, key, strlen(key)) &&
            sscanf(line + strlen(key), "%lf", &value) != 1 && !*key)
            break;
    if (file)
        fclose(file);
    return value;
}

/* Lowers *least to a smaller value; a NAN is unknown. */
static void lower(double *least, double value, const char **limit, const char *name) {
    if (!(value < *least))
        return;
    *least = value > 0 ? value : 0;
    *limit = name;
}

/* Lowers *least by the limits of a control group and of those above it. Cached pages of files
 * count as free. */
static void lower_by_group(const char *folder, const char *group, const char *const names[3],
                           double *least, const char **limit) {
    char path[PATH_BYTES], file[PATH_BYTES + 64];
    const size_t top = (size_t)snprintf(path, sizeof path, "%s", folder);
    snprintf(path + top, sizeof path - top, "%s", strcmp(group, "/") ? group : "");
    for (;;) {
        double figures[3];
        static const char *const keys[] = {"", "", "inactive_file "};
        for (int k = 0; k < 3; k++) {
            snprintf(file, sizeof file, "%s/%s", path, names[k]);
            figures[k] = read_number(file, keys[k]);
        }
        lower(least, figures[0] - figures[1] + (figures[2] > 0 ? figures[2] : 0), limit,
              "the memory limit of the control group");
        char *end = strrchr(path + top, '/');
        if (!end)
            return;
        *end = 0;
    }
}

/* The groups of the process: "0::/PATH" of version 2, "N:...memory...:/PATH" of version 1. */
static void lower_by_groups(const char *root, double *least, const char **limit) {
    static const char *const names[][3] = {
        {"memory.limit_in_bytes", "memory.usage_in_bytes", "memory.stat"},
        {"memory.max", "memory.current", "memory.stat"}};
    char path[PATH_BYTES], line[PATH_BYTES];
    snprintf(path, sizeof path, "%s/proc/self/cgroup", root);
    FILE *file = fopen(path, "re");
    while (file && fgets(line, sizeof line, file)) {
        char *kind = strchr(line, ':'), *group = kind ? strchr(kind + 1, ':') : NULL;
        const bool unified = group == kind + 1;
        line[strcspn(line, "\n")] = 0;
        if (!group || (!unified && !strstr(kind, "memory")))
            continue;
        snprintf(path, sizeof path, "%s/sys/fs/cgroup%s", root, unified ? "" : "/memory");
        lower_by_group(path, group + 1, names[unified], least, limit);
    }
    if (file)
        fclose(file);
}

double cs_memory_left(const char *root, const char **limit) {
    char path[PATH_BYTES];
    double least = (double)INFINITY;
    struct rlimit space, data;
    snprintf(path, sizeof path, "%s/proc/self/statm", root);
    const double taken = read_number(path, "") * (double)sysconf(_SC_PAGESIZE);
    if (!getrlimit(RLIMIT_AS, &space) && space.rlim_cur != RLIM_INFINITY)
        lower(&least, (double)space.rlim_cur - taken, limit, "the limit of address space");
    if (!getrlimit(RLIMIT_DATA, &data) && data.rlim_cur != RLIM_INFINITY)
        lower(&least, (double)data.rlim_cur, limit, "the limit of data");
    lower_by_groups(root, &least, limit);
    snprintf(path, sizeof path, "%s/proc/meminfo", root);
    const double swap = read_number(path, "SwapFree:");
    lower(&least, 1024 * (read_number(path, "MemAvailable:") + (swap > 0 ? swap : 0)), limit,
          "the free memory of the machine");
    return least;
}
