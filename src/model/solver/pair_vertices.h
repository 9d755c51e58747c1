/* pair_vertices.h - the contact part of the solver's matrix, indexed by particle. */
#ifndef CS_SOLVER_PAIR_VERTICES_H
#define CS_SOLVER_PAIR_VERTICES_H

#include "base/arena.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct cs_pairs;

/* One of the four points of a stored pair: number of the chunk, of the pair in it, and of the
 * point. */
struct cs_pair_vertex {
    uint32_t chunk, pair, vertex;
};

/* The index; rebuilt for each matrix in the memory that it has. */
struct cs_pair_vertices {
    uint32_t *starts;             /* (n + 2) */
    struct cs_pair_vertex *items; /* particle i has items[starts[i]..starts[i + 1]), in the
                                     order of the chunks and pairs */
    size_t starts_capacity, items_capacity;
};

/* Makes an empty index; the arena frees what grows. Returns CS_ERR_MEMORY if out of memory. */
enum cs_status cs_pair_vertices_init(struct cs_pair_vertices *corners, struct cs_arena *arena,
                                     struct cs_error *error);

/* Number of pairs in the stored matrix. */
size_t cs_pair_vertices_count(const struct cs_pairs *pairs);

/* Indexes the stored matrix. Returns false if out of memory; the index must not be used then.
 */
bool cs_pair_vertices_find(struct cs_pair_vertices *corners, const struct cs_pairs *pairs);

/* A pair's part of the matrix, seen from one of its vertices. */
struct cs_pair_vertex_terms {
    uint32_t points[4]; /* points of the pair */
    uint32_t vertex;
    double weight[4];
    double diagonal_block[6];    /* block of this vertex with itself */
    double unit_weight_block[6]; /* the pair's block C, for a weight of 1: taken at the vertex
                                    of the largest weight, whose gradient is bent least */
};
/* Reads the terms of a pair, of either kind of stored matrix, for one of its vertices. */
void cs_pair_vertices_read(const struct cs_pairs *pairs, const struct cs_pair_vertex *corner,
                           struct cs_pair_vertex_terms *share);

#endif
