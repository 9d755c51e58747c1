/* contact_set.h - contacts that act on one to four points. Threads find and evaluate them in
 * chunks. Each point of a contact is a row of force_gather.h, so that particles sum in the
 * order of (chunk, contact, point), whatever the threads. */
#ifndef CS_CONTACT_SET_H
#define CS_CONTACT_SET_H

#include "model/contact/force_gather.h"

/* One contact in range, with what it adds to its points, or what friction remembers of it. */
struct cs_contact {
    uint32_t n, row; /* points, and the row of the first in its chunk; the others follow */
    double weights[4];
    double block[6]; /* of a matrix (w w^T) x B: xx, xy, xz, yy, yz, zz of B */
    /* force or its change in N, of which a point has w times factor; of bounds: N/m and N s/m,
     * of which it has w */
    double vector[3], factor;
    /* of lagged friction: mu N in N, negative for a feature that is subtracted; n; and the part
     * of the contact's velocity in m/s that belongs to colliders */
    double load, normal[3], obstacle[3];
};

/* Contacts of one chunk; one thread at a time writes it. */
struct cs_contact_chunk {
    struct cs_contact *contacts;
    size_t n, capacity;
    /* energy in J */
    double energy;
};

/* All contacts in range at one state. */
struct cs_contact_set {
    struct cs_contact_chunk *chunks; /* (gather.n_chunks) */
    struct cs_gather gather;         /* points from n_particles on are of colliders */
    size_t n;                        /* contacts in all chunks */
    /* matrix: diagonal blocks are enlarged to bound the whole matrix */
    bool diagonal_bound;
    /* out of memory: contacts are missing, and the run must end */
    bool failed;
};

/* Prepares an empty set; the arena owns all memory, that which grows included. CS_ERR_MEMORY.
 */
enum cs_status cs_contact_set_init(struct cs_contact_set *set, uint32_t n_particles,
                                   uint32_t n_chunks, struct cs_arena *arena,
                                   struct cs_error *error);

/* Empties a chunk before it is filled; its memory stays. */
void cs_contact_set_clear(struct cs_contact_set *set, uint32_t chunk);
/* Appends a contact of n points with their weights, whose factor is 1 and all else 0; NULL
 * if out of memory. The address is valid until the next call for the same
 * chunk. */
struct cs_contact *cs_contact_set_append(struct cs_contact_set *set, uint32_t chunk, uint32_t n,
                                         const uint32_t *points, const double *weights);

/* The points of a contact. */
static inline const uint32_t *cs_contact_points(const struct cs_contact_set *set,
                                                uint32_t chunk,
                                                const struct cs_contact *contact) {
    return set->gather.chunks[chunk].points + contact->row;
}

/* Counts the contacts of all chunks after they were filled, and lists the rows of each
 * particle; no contacts if one ran out of memory. */
void cs_contact_set_gather(struct cs_contact_set *set);

/* Energy in J of all chunks. */
double cs_contact_set_energy(const struct cs_contact_set *set);

/* Brings the vectors of all chunks into order, and the diagonal blocks of the matrix, for the
 * sums below. With set->diagonal_bound the blocks bound the whole matrix, by (sum a_i)^2 <= sum
 * |a_i| sum a_i^2/|a_i| of the weights (proof: find_growth of pair_lanes.c). */
void cs_contact_set_write_vectors(struct cs_contact_set *set);
void cs_contact_set_write_blocks(struct cs_contact_set *set);

/* f (3,n) += the vectors, blocks (6,n) += the diagonal blocks of particles [begin, end). */
void cs_contact_set_add(const struct cs_contact_set *set, size_t begin, size_t end, double *f);
void cs_contact_set_add_blocks(const struct cs_contact_set *set, size_t begin, size_t end,
                               double *blocks);

/* y (3,n) += (matrix - its diagonal blocks) p, with all threads. */
void cs_contact_set_multiply(const struct cs_contact_set *set, const double *p, double *y);

/* Adds the bounds of all contacts, which have no points of colliders, to their particles: N/m
 * and N s/m. */
void cs_contact_set_add_bound(const struct cs_contact_set *set, double *stiffness,
                              double *damping);

#endif
