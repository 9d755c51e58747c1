/* pair_matrix.h - the contact matrix of pairs as an operator: diagonal blocks, and products
 * with vectors in lanes, from stored factors.
 *
 *   A = sum of pairs c g g^T + (w w^T) x B + ck F H
 *
 * per pair 12 x 12. The last part, with the Hessian H of the distance, is in exact matrices
 * alone. A positive semi-definite one has c >= 0, and B >= 0 with matrix.bound, and is never
 * formed. The solver keeps the diagonal blocks; the operator applies the rest. Without
 * matrix.bound the friction of subtracted features may make single B negative. */
#ifndef CS_NARROW_PHASE_PAIR_MATRIX_H
#define CS_NARROW_PHASE_PAIR_MATRIX_H

#include "model/contact/narrow_phase/active_contacts.h"

/* ck F H of a pair by its four points: 12 x 12, symmetric. */
struct cs_pair_hessian {
    double m[12][12];
};

/* Terms of one chunk of active contacts. */
struct cs_pair_matrix_chunk {
    struct cs_pair_factors *factors;  /* CS_PAIR_LANES pairs each */
    struct cs_pair_hessian *hessians; /* of each pair, if the matrix is exact */
    size_t capacity, hessians_capacity;
    bool failed; /* there was no memory */
};

struct cs_pair_matrix {
    struct cs_active_contacts
        *contacts; /* whose pairs it is of, which stay while it does; NULL: none */
    bool exact;    /* it has Hessians */
    /* diagonal blocks are enlarged to bound A without H from above: A <= diag(blocks) */
    bool diagonal_bound;
    struct cs_pair_matrix_chunk *chunks;
    uint32_t n_chunks;
    /* (rows, 6) diagonal blocks, summed per row of each chunk */
    double *diagonal;
    size_t diagonal_capacity;
};

/* Prepares an empty operator; the arena owns its memory. CS_ERR_MEMORY. */
enum cs_status cs_pair_matrix_init(struct cs_pair_matrix *matrix, uint32_t n_chunks,
                                   struct cs_arena *arena, struct cs_error *error);

/* Binds the operator to active contacts, which it borrows until the next call. alone: the
 * blocks must bound all of A. Returns false if out of memory. */
bool cs_pair_matrix_begin(struct cs_pair_matrix *matrix, struct cs_active_contacts *active,
                          bool exact, bool alone);
/* Makes room for the terms of a chunk, which the caller fills; returns false if out of memory.
 * Threads may call it for different chunks. */
bool cs_pair_matrix_chunk_begin(struct cs_pair_matrix *matrix, uint32_t number);
/* Sets one Hessian for the pair *contact. */
void cs_pair_matrix_set_hessian(const struct cs_pair_contact *contact,
                                const struct cs_matrix *of, struct cs_pair_hessian *hessian);
/* Sums the diagonal blocks of a chunk, after its terms were filled. */
void cs_pair_matrix_chunk_end(struct cs_pair_matrix *matrix, uint32_t number);
/* Returns false if a chunk ran out of memory. */
bool cs_pair_matrix_end(struct cs_pair_matrix *matrix);

/* blocks (6,n) += the diagonal blocks at particles [begin, end). */
void cs_pair_matrix_add_blocks(const struct cs_pair_matrix *matrix, size_t begin, size_t end,
                               double *blocks);

/* y (3,n) += (A - its diagonal blocks) p, with all threads. Sums are those of one thread. */
void cs_pair_matrix_apply(const struct cs_pair_matrix *matrix, const double *p, double *y);
/* y (3,n) += (A without B) v for the velocities v (3,n_points) of all points, those of
 * colliders too: what the elastic forces change by the way that pairs go. */
void cs_pair_matrix_approach(const struct cs_pair_matrix *matrix, size_t n_points,
                             const double *v, double *y);

#endif
