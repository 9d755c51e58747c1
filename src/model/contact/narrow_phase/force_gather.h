/* force_gather.h - what chunks of pairs have for particles: each chunk has a row of its own for
 * each point that it touches, where it reads the point once and adds up what its pairs have for
 * it; then particles add their rows in the order of the chunks. So sums are the same for any
 * number of threads, and few numbers go through memory.
 */
#ifndef CS_NARROW_PHASE_FORCE_GATHER_H
#define CS_NARROW_PHASE_FORCE_GATHER_H

#include "base/arena.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* One chunk's rows. */
struct cs_gather_chunk {
    uint32_t *points; /* (n) of each row */
    uint32_t *slots;  /* (1 << bits) of a table: 1 + rows, by their points; 0: free */
    size_t points_capacity, slots_capacity;
    uint32_t n, bits;
    uint32_t row_offset; /* rows of the chunks before */
    bool failed;         /* there was no memory */
};

struct cs_gather {
    struct cs_gather_chunk *chunks;
    uint32_t n_chunks, n_particles;
    uint32_t n_rows;  /* of all chunks */
    uint32_t *starts; /* (n_particles + 2) */
    uint32_t *rows;   /* those of particle i: rows[starts[i] .. starts[i + 1]) */
    double *row_sums; /* (n_rows, 3) of what was asked for last */
    double *gathered; /* (n_rows, width) of what was read for it */
    size_t width;
    size_t rows_capacity, sums_capacity, gathered_capacity;
};

/* Fixed arrays from the arena, which then owns what grows too. CS_ERR_MEMORY. */
enum cs_status cs_gather_init(struct cs_gather *gather, uint32_t n_chunks, uint32_t n_particles,
                              struct cs_arena *arena, struct cs_error *error);

/* Empties a lot. */
void cs_gather_clear(struct cs_gather_chunk *chunk);

/* The row of a point in a lot, a new one where it has none. Different lots at the same time. */
uint32_t cs_gather_row(struct cs_gather_chunk *chunk, uint32_t point);

/* Finds the rows of each particle after all were given out; points from n_particles on feel
 * nothing. false: no memory. */
bool cs_gather_set(struct cs_gather *gather);

/* Takes memory for what rows read, (n_rows, width). false: there is none. */
bool cs_gather_reserve(struct cs_gather *gather, size_t width);

/* Reads x (3,n) into three columns of a lot's rows, from `column` on, and returns the first
 * row; 0 where x is NULL, or a point is not below n. */
double *cs_gather_read(const struct cs_gather *gather, uint32_t number, size_t column,
                       const double *x, size_t n);

/* Of a lot: its rows in an array (n_rows, width). */
static inline double *cs_gather_of(const struct cs_gather_chunk *chunk, double *rows,
                                   size_t width) {
    return rows + width * chunk->row_offset;
}

/* out (width, n_particles) += the rows of particles [begin, end). */
void cs_gather_add(const struct cs_gather *gather, const double *rows, size_t width,
                   size_t begin, size_t end, double *out);

#endif
