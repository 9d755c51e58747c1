/* pair_vertices.h - the kept matrix of pairs, by the particles that they are of. */
#ifndef CS_SOLVER_PAIR_VERTICES_H
#define CS_SOLVER_PAIR_VERTICES_H

#include "base/arena.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct cs_pairs;

/* A corner of a pair. */
struct cs_pair_vertex {
    uint32_t chunk, pair, vertex;
};

struct cs_pair_vertices {
    uint32_t *starts;             /* (n + 2) */
    struct cs_pair_vertex *items; /* those of particle i: of[starts[i]..starts[i + 1]), in the
                             order of the chunks */
    size_t starts_capacity, items_capacity;
};

/* The arena owns what grows. CS_ERR_MEMORY. */
enum cs_status cs_pair_vertices_init(struct cs_pair_vertices *corners, struct cs_arena *arena,
                                     struct cs_error *error);

/* How many pairs the kept matrix is of. */
size_t cs_pair_vertices_count(const struct cs_pairs *pairs);

/* Finds the corners of the kept matrix. false: no memory. */
bool cs_pair_vertices_find(struct cs_pair_vertices *corners, const struct cs_pairs *pairs);

/* What a pair has of the matrix, seen from one of its corners. */
struct cs_pair_vertex_terms {
    uint32_t points[4]; /* points of the pair */
    uint32_t vertex;
    double weight[4];
    double diagonal_block[6];    /* the block of the corner with itself */
    double unit_weight_block[6]; /* that of a corner whose weight would be 1, where the gradient
                        is bent least and does not turn */
};
void cs_pair_vertices_read(const struct cs_pairs *pairs, const struct cs_pair_vertex *corner,
                           struct cs_pair_vertex_terms *share);

#endif
