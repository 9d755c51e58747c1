/* contact_set.h - contacts that each act on a few particles at once: found chunk by chunk, each
 * with what it does, then gathered particle by particle, in the order of the chunks.
 */
#ifndef CS_CONTACT_SET_H
#define CS_CONTACT_SET_H

#include "base/arena.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* What one contact in range does. */
struct cs_contact_entry {
    uint32_t n, particles[4]; /* particles, 2 to 4; from n_particles on: points of obstacles */
    double vectors[4][3];     /* force, its change, or the gradient g of a matrix */
};

/* What it has of a matrix or of bounds: apart, so that forces go over no more than they need.
 */
struct cs_contact_matrix_part {
    double weights[4];      /* the weights w; of bounds: N s/m */
    double gradient_weight; /* along g g^T + (w w^T) x of, and cs_contact_chunk.full */
    double block[6];        /* xx, xy, xz, yy, yz, zz; of bounds: N/m of each particle */
    double product[4][3];   /* what cs_contact_set_multiply makes of a vector */
};

/* how the gradient of a pair turns: 12 x 12, symmetric */
struct cs_contact_hessian {
    double m[12][12];
};

/* What was found in range together: one thread's. */
struct cs_contact_chunk {
    struct cs_contact_entry *pairs;
    size_t n, capacity;
    size_t pair_offset;                   /* pairs of the chunks before it */
    struct cs_contact_matrix_part *parts; /* (n) of a matrix or of bounds */
    size_t parts_capacity;
    struct cs_contact_hessian *hessians; /* (n) of a matrix whose set is exact */
    size_t hessians_capacity;
    double energy; /* J */
    bool failed;   /* there was no memory */
};

/* A corner of a pair, as one of those that a particle gathers. */
struct cs_contact_vertex {
    const struct cs_contact_entry *pair;
    uint32_t vertex, chunk;
};

/* All in range at one state. */
struct cs_contact_set {
    struct cs_contact_chunk *chunks; /* (n_chunks) */
    uint32_t n_chunks, n_particles;
    size_t n;            /* pairs in all chunks */
    bool diagonal_bound; /* of a matrix: blocks that are above the whole of it */
    bool has_hessians;   /* of a matrix: chunks have `full` */
    bool no_gradients;   /* of a matrix: no pair has a gradient, `along` and `to` are 0 */
    bool failed;         /* there was no memory: pairs lack, and the run must end */
    uint32_t *vertices;  /* (4 n) points of all pairs; UINT32_MAX: it has fewer */
    struct cs_contact_vertex
        *particle_vertices; /* (4 n) those of particle i: ends[starts[i]..starts[i + 1]) */
    size_t vertices_capacity, particle_vertices_capacity;
    uint32_t *starts; /* (n_particles + 2) */
};

/* Points of obstacles feel nothing here, and do not move. */
static inline bool cs_contact_set_has(const struct cs_contact_set *set, uint32_t point) {
    return point < set->n_particles;
}

/* Fixed arrays from the arena, which then owns what grows too. CS_ERR_MEMORY. */
enum cs_status cs_contact_set_init(struct cs_contact_set *set, uint32_t n_particles,
                                   uint32_t n_chunks, struct cs_arena *arena,
                                   struct cs_error *error);

/* Empties a lot, before it is filled. */
void cs_contact_chunk_clear(struct cs_contact_chunk *chunk);
/* The next place of a lot; NULL: no memory. */
struct cs_contact_entry *cs_contact_chunk_next(struct cs_contact_chunk *chunk);
/* The part of the place that was given last; NULL: no memory. */
struct cs_contact_matrix_part *cs_contact_chunk_part(struct cs_contact_chunk *chunk);

/* Counts what the chunks hold, after they were filled; 0 where one failed. */
void cs_contact_set_count(struct cs_contact_set *set);
/* And finds the corners of each particle. */
void cs_contact_set_gather(struct cs_contact_set *set);

/* J, of all chunks. */
double cs_contact_set_energy(const struct cs_contact_set *set);

/* f (3,n) += what was gathered at particles [begin, end). */
void cs_contact_set_add(const struct cs_contact_set *set, size_t begin, size_t end, double *f);

/* blocks (6,n) += the diagonal blocks of a matrix there. With set->alone they are above all of
 * the matrix: (sum a_i)^2 <= sum |a_i| sum a_i^2/|a_i| of the weights, or the gradient. */
void cs_contact_set_add_blocks(const struct cs_contact_set *set, size_t begin, size_t end,
                               double *blocks);

/* y (3,n) += a matrix without its diagonal blocks, times p. With all threads. */
void cs_contact_set_multiply(const struct cs_contact_set *set, const double *p, double *y);

/* Adds the bounds of all to their particles. */
void cs_contact_set_add_bound(const struct cs_contact_set *set, double *stiffness,
                              double *damping);

#endif
