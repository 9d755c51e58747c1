/* force_gather.h - deterministic scatter of pair forces to particles. Each chunk of pairs
 * accumulates into its own row per point; each particle then sums its rows in chunk order.
 *
 * A chunk also reads each of its points once, into the row. Sums are the same for any number of
 * threads, and memory traffic grows with points and not with pairs. */
#ifndef CS_CONTACT_FORCE_GATHER_H
#define CS_CONTACT_FORCE_GATHER_H

#include "base/arena.h"

#include <stdint.h>

/* Rows of one chunk. slots is a hash table with open addressing from points to rows. */
struct cs_gather_chunk {
    /* (n) point of each row */
    uint32_t *points;
    /* (1 << bits) row + 1 of a point; 0: free */
    uint32_t *slots;
    size_t points_capacity, slots_capacity;
    uint32_t n, bits;
    /* rows of all chunks before it */
    uint32_t row_offset;
    /* out of memory: rows are missing */
    bool failed;
};

/* Rows of all chunks, and the list of rows of each particle in compressed row format. */
struct cs_gather {
    struct cs_gather_chunk *chunks;
    uint32_t n_chunks, n_particles;
    uint32_t n_rows;  /* of all chunks */
    uint32_t *starts; /* (n_particles + 2) */
    /* row numbers of particle i: rows[starts[i]] to rows[starts[i + 1] - 1] */
    uint32_t *rows;
    /* (n_rows, 3) results of the last query */
    double *row_sums;
    /* (n_rows, width) data read for it */
    double *gathered;
    size_t width;
    size_t rows_capacity, sums_capacity, gathered_capacity;
};

/* Prepares empty tables; the arena owns all memory, that which grows included. CS_ERR_MEMORY.
 */
enum cs_status cs_gather_init(struct cs_gather *gather, uint32_t n_chunks, uint32_t n_particles,
                              struct cs_arena *arena, struct cs_error *error);

/* Removes the rows of a chunk; its memory stays. */
void cs_gather_clear(struct cs_gather_chunk *chunk);

/* Returns the row of a point in a chunk, and adds one if it has none. Out of memory sets
 * `failed` and returns 0. Threads may call it for different chunks. */
uint32_t cs_gather_row(struct cs_gather_chunk *chunk, uint32_t point);

/* Adds a row for a point, whether it has one or not: all rows of a chunk are added so, or none.
 */
void cs_gather_append(struct cs_gather_chunk *chunk, uint32_t point);

/* Lists the rows of each particle, after all rows were assigned. Points from n_particles on are
 * of colliders and gather nothing. Returns false if out of memory. */
bool cs_gather_set(struct cs_gather *gather);

/* Reserves `gathered` with `width` numbers per row. Returns false if out of memory. */
bool cs_gather_reserve(struct cs_gather *gather, size_t width);

/* Reads x (3,n) into the columns `column` to column + 2 of a chunk's rows, and returns its
 * first row. A point is 0 if x is NULL or the point is not below n. */
double *cs_gather_read(const struct cs_gather *gather, uint32_t number, size_t column,
                       const double *x, size_t n);

/* Rows of a chunk in an array (n_rows, width). */
static inline double *cs_gather_of(const struct cs_gather_chunk *chunk, double *rows,
                                   size_t width) {
    return rows + width * chunk->row_offset;
}

/* out (width, n_particles) += the rows of particles [begin, end). */
void cs_gather_add(const struct cs_gather *gather, const double *rows, size_t width,
                   size_t begin, size_t end, double *out);

#endif
