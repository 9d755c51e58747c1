/* contact_set.h - contacts that act on two to four particles. Threads find and evaluate them in
 * chunks; forces are then gathered per particle in chunk order.
 *
 * The order of every sum is that of (chunk, contact, vertex) and does not depend on threads. */
#ifndef CS_CONTACT_SET_H
#define CS_CONTACT_SET_H

#include "base/arena.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* One contact in range and its effect on its points. */
struct cs_contact_entry {
    /* number of points, 2 to 4, and the points; from n_particles on they are points of
     * colliders */
    uint32_t n, particles[4];
    /* force or its change in N */
    double vectors[4][3];
};

/* Terms of a contact in a matrix, (w w^T) x B, or its bounds. They are stored apart from struct
 * cs_contact_entry, so that forces read no more memory than they need.
 */
struct cs_contact_matrix_part {
    /* weights w of the points; of bounds: N s/m of each point */
    double weights[4];
    /* B: xx, xy, xz, yy, yz, zz; of bounds: N/m of each point */
    double block[6];
    /* result of cs_contact_set_multiply at each point */
    double product[4][3];
};

/* Contacts of one chunk; one thread at a time writes it. */
struct cs_contact_chunk {
    struct cs_contact_entry *pairs;
    size_t n, capacity;
    size_t pair_offset;                   /* pairs of the chunks before it */
    struct cs_contact_matrix_part *parts; /* (n) of a matrix or of bounds */
    size_t parts_capacity;
    /* energy in J */
    double energy;
    /* out of memory: contacts are missing */
    bool failed;
};

/* One vertex of a contact, in the list of the particle that gathers it. */
struct cs_contact_vertex {
    const struct cs_contact_entry *pair;
    uint32_t vertex, chunk;
};

/* All contacts in range at one state. starts and particle_vertices are a compressed row format:
 * particle i has particle_vertices[starts[i]] to [starts[i + 1] - 1]. */
struct cs_contact_set {
    struct cs_contact_chunk *chunks; /* (n_chunks) */
    uint32_t n_chunks, n_particles;
    size_t n; /* pairs in all chunks */
    /* matrix: diagonal blocks are enlarged to bound the whole matrix */
    bool diagonal_bound;
    /* out of memory: contacts are missing, and the run must end */
    bool failed;
    uint32_t *vertices; /* (4 n) points of all pairs; UINT32_MAX: it has fewer */
    struct cs_contact_vertex
        *particle_vertices; /* (4 n) those of particle i: ends[starts[i]..starts[i + 1]) */
    size_t vertices_capacity, particle_vertices_capacity;
    uint32_t *starts; /* (n_particles + 2) */
};

/* Returns whether a point is a particle. Points of colliders receive no force here. */
static inline bool cs_contact_set_has(const struct cs_contact_set *set, uint32_t point) {
    return point < set->n_particles;
}

/* Prepares an empty set; the arena owns all memory, that which grows included. CS_ERR_MEMORY.
 */
enum cs_status cs_contact_set_init(struct cs_contact_set *set, uint32_t n_particles,
                                   uint32_t n_chunks, struct cs_arena *arena,
                                   struct cs_error *error);

/* Empties a chunk before it is filled; its memory stays. */
void cs_contact_chunk_clear(struct cs_contact_chunk *chunk);
/* Appends a contact with unspecified content; NULL if out of memory. The address is valid until
 * the next call for the same chunk. */
struct cs_contact_entry *cs_contact_chunk_next(struct cs_contact_chunk *chunk);
/* Returns the matrix terms of the contact that was appended last; NULL if out of memory. */
struct cs_contact_matrix_part *cs_contact_chunk_part(struct cs_contact_chunk *chunk);

/* Counts the contacts of all chunks after they were filled; 0 if one ran out of memory. */
void cs_contact_set_count(struct cs_contact_set *set);
/* Builds the lists of vertices per particle, after cs_contact_set_count. */
void cs_contact_set_gather(struct cs_contact_set *set);

/* Energy in J of all chunks. */
double cs_contact_set_energy(const struct cs_contact_set *set);

/* f (3,n) += the vectors of the particles [begin, end). */
void cs_contact_set_add(const struct cs_contact_set *set, size_t begin, size_t end, double *f);

/* blocks (6,n) += the diagonal blocks of the matrix at the particles [begin, end). With
 * set->diagonal_bound they bound the whole matrix, by (sum a_i)^2 <= sum |a_i| sum a_i^2/|a_i|
 * of the weights (proof: find_growth of pair_lanes.c). */
void cs_contact_set_add_blocks(const struct cs_contact_set *set, size_t begin, size_t end,
                               double *blocks);

/* y (3,n) += (matrix - its diagonal blocks) p, with all threads. */
void cs_contact_set_multiply(const struct cs_contact_set *set, const double *p, double *y);

/* Adds the bounds of all contacts to their particles: N/m and N s/m. */
void cs_contact_set_add_bound(const struct cs_contact_set *set, double *stiffness,
                              double *damping);

#endif
