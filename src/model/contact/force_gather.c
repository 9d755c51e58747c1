/* Hash tables of the points of chunks, and lists of their rows by particles. */
#include "model/contact/force_gather.h"

#include <stdlib.h>
#include <string.h>

/* log2 of the slots of the smallest table */
enum { BITS_MIN = 9 };

static void finish_gather(void *object) {
    struct cs_gather *gather = object;
    for (uint32_t l = 0; l < gather->n_chunks; l++)
        free(gather->chunks[l].points), free(gather->chunks[l].slots);
    free(gather->rows);
    free(gather->row_sums);
    free(gather->gathered);
}

enum cs_status cs_gather_init(struct cs_gather *gather, uint32_t n_chunks, uint32_t n_particles,
                              struct cs_arena *arena, struct cs_error *error) {
    *gather = (struct cs_gather){.n_chunks = n_chunks, .n_particles = n_particles};
    gather->chunks = cs_arena_alloc_array(arena, n_chunks, sizeof *gather->chunks, error);
    CS_ARENA_ARRAY(arena, gather->starts, n_particles + (size_t)2, error);
    if (!error->status)
        cs_arena_adopt(arena, finish_gather, gather, error);
    return error->status;
}

/* --- rows of a chunk --- */

/* Slot of a point, or the free one where it would go: linear probing from a multiplicative hash
 * (2654435769 = 2^32 / golden ratio). */
static uint32_t *slot_of(const struct cs_gather_chunk *chunk, uint32_t point) {
    const uint32_t mask = (1u << chunk->bits) - 1;
    uint32_t at = (point * 2654435769u) >> (32 - chunk->bits);
    while (chunk->slots[at] && chunk->points[chunk->slots[at] - 1] != point)
        at = (at + 1) & mask;
    return chunk->slots + at;
}

/* Builds a table of 2^bits slots with the points so far; returns false if out of memory. */
static bool grow_table(struct cs_gather_chunk *chunk, uint32_t bits) {
    if (!CS_ARENA_REALLOC(chunk->slots, chunk->slots_capacity, (size_t)1 << bits))
        return false;
    chunk->bits = bits;
    memset(chunk->slots, 0, sizeof *chunk->slots << bits);
    for (uint32_t row = 0; row < chunk->n; row++)
        *slot_of(chunk, chunk->points[row]) = row + 1;
    return true;
}

void cs_gather_clear(struct cs_gather_chunk *chunk) {
    chunk->n = 0;
    chunk->bits = 0;
    chunk->failed = false;
}

/* Makes room for one row more, with the table at most half full; false if out of memory. */
static bool make_room(struct cs_gather_chunk *chunk) {
    if (!CS_ARENA_REALLOC(chunk->points, chunk->points_capacity, (size_t)chunk->n + 1))
        return false;
    if (!chunk->bits)
        return grow_table(chunk, BITS_MIN);
    return 2 * chunk->n < 1u << chunk->bits || grow_table(chunk, chunk->bits + 1);
}

void cs_gather_append(struct cs_gather_chunk *chunk, uint32_t point) {
    chunk->failed = chunk->failed || !CS_ARENA_REALLOC(chunk->points, chunk->points_capacity,
                                                       (size_t)chunk->n + 1);
    if (!chunk->failed)
        chunk->points[chunk->n++] = point;
}

static uint32_t append_row(struct cs_gather_chunk *chunk, uint32_t point) {
    if (!make_room(chunk)) {
        chunk->failed = true;
        return 0;
    }
    *slot_of(chunk, point) = chunk->n + 1;
    chunk->points[chunk->n] = point;
    return chunk->n++;
}

uint32_t cs_gather_row(struct cs_gather_chunk *chunk, uint32_t point) {
    const uint32_t slot = chunk->n ? *slot_of(chunk, point) : 0;
    return slot ? slot - 1 : append_row(chunk, point);
}

/* --- by particles --- */

static bool count_rows(struct cs_gather *gather) {
    bool failed = false;
    gather->n_rows = 0;
    for (uint32_t l = 0; l < gather->n_chunks; l++) {
        gather->chunks[l].row_offset = gather->n_rows;
        gather->n_rows += gather->chunks[l].n;
        failed = failed || gather->chunks[l].failed;
    }
    return !failed;
}

/* Counts the rows of each particle at the place after its own in starts, or stores them where
 * starts points. */
static void visit_rows(const struct cs_gather *gather, uint32_t *starts, bool put) {
    for (uint32_t l = 0; l < gather->n_chunks; l++)
        for (uint32_t row = 0; row < gather->chunks[l].n; row++) {
            const uint32_t point = gather->chunks[l].points[row];
            if (point < gather->n_particles && put)
                gather->rows[starts[point]++] = gather->chunks[l].row_offset + row;
            else if (point < gather->n_particles)
                starts[point + 1]++;
        }
}

/* Counting sort by particle. Counts go two places on, so that filling moves each start to where
 * it belongs. */
bool cs_gather_set(struct cs_gather *gather) {
    uint32_t *starts = gather->starts + 1;
    if (!count_rows(gather) ||
        !CS_ARENA_REALLOC(gather->rows, gather->rows_capacity, gather->n_rows) ||
        !CS_ARENA_REALLOC(gather->row_sums, gather->sums_capacity, 3 * (size_t)gather->n_rows))
        return false;
    if (!gather->n_rows)
        return true;
    memset(gather->starts, 0, (gather->n_particles + (size_t)2) * sizeof *starts);
    visit_rows(gather, starts, false);
    for (uint32_t i = 0; i < gather->n_particles; i++)
        starts[i + 1] += starts[i];
    visit_rows(gather, starts, true);
    return true;
}

/* --- data of rows --- */

bool cs_gather_reserve(struct cs_gather *gather, size_t width) {
    gather->width = width;
    return CS_ARENA_REALLOC(gather->gathered, gather->gathered_capacity,
                            width * gather->n_rows);
}

double *cs_gather_read(const struct cs_gather *gather, uint32_t number, size_t column,
                       const double *x, size_t n) {
    const struct cs_gather_chunk *chunk = gather->chunks + number;
    double *rows = cs_gather_of(chunk, gather->gathered, gather->width);
    for (size_t row = 0; row < chunk->n; row++)
        for (size_t c = 0; c < 3; c++)
            rows[row * gather->width + column + c] =
                x && chunk->points[row] < n ? x[c * n + chunk->points[row]] : 0;
    return rows;
}

void cs_gather_add(const struct cs_gather *gather, const double *rows, size_t width,
                   size_t begin, size_t end, double *out) {
    for (size_t i = begin; i < end && gather->n_rows; i++)
        for (uint32_t e = gather->starts[i]; e < gather->starts[i + 1]; e++)
            for (size_t c = 0; c < width; c++)
                out[c * gather->n_particles + i] += rows[width * gather->rows[e] + c];
}
