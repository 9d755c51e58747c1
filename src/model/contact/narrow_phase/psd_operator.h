/* psd_operator.h - the positive semi-definite contact matrix as an operator: diagonal blocks,
 * and products with vectors in lanes, from stored factors.
 *
 *   P = sum of pairs c g g^T + (w w^T) x B,   c >= 0, B >= 0 with matrix.bound
 *
 * per pair 12 x 12, never formed. The solver keeps the diagonal blocks; the operator applies
 * the rest. Without matrix.bound the friction of subtracted features may make single B
 * negative. */
#ifndef CS_NARROW_PHASE_PSD_OPERATOR_H
#define CS_NARROW_PHASE_PSD_OPERATOR_H

#include "model/contact/narrow_phase/active_contacts.h"

/* Factors of one chunk of active contacts. */
struct cs_psd_chunk {
    struct cs_pair_factors *factors; /* CS_PAIR_LANES pairs each */
    size_t capacity;
    bool failed; /* there was no memory */
};

struct cs_psd_operator {
    struct cs_active_contacts
        *contacts; /* whose pairs it is of, which stay while it does; NULL: none */
    /* diagonal blocks are enlarged to bound P from above: P <= diag(blocks) */
    bool diagonal_bound;
    struct cs_psd_chunk *chunks;
    uint32_t n_chunks;
    /* (rows, 6) diagonal blocks, summed per row of each chunk */
    double *diagonal;
    size_t diagonal_capacity;
};

/* Prepares an empty operator; the arena owns its memory. CS_ERR_MEMORY. */
enum cs_status cs_psd_operator_init(struct cs_psd_operator *product, uint32_t n_chunks,
                                    struct cs_arena *arena, struct cs_error *error);

/* Binds the operator to active contacts, which it borrows until the next call. alone: the
 * blocks must bound all of P. Returns false if out of memory. */
bool cs_psd_operator_begin(struct cs_psd_operator *product, struct cs_active_contacts *active,
                           bool alone);
/* Returns the factors of a chunk, which the caller fills; NULL if out of memory. Threads may
 * call it for different chunks. */
struct cs_pair_factors *cs_psd_operator_chunk_begin(struct cs_psd_operator *product,
                                                    uint32_t number);
/* Sums the diagonal blocks of a chunk, after its factors were filled. */
void cs_psd_operator_chunk_end(struct cs_psd_operator *product, uint32_t number);
/* Returns false if a chunk ran out of memory. */
bool cs_psd_operator_end(struct cs_psd_operator *product);

/* blocks (6,n) += the diagonal blocks at particles [begin, end). */
void cs_psd_operator_add_blocks(const struct cs_psd_operator *product, size_t begin, size_t end,
                                double *blocks);

/* y (3,n) += (P - its diagonal blocks) p, with all threads. Sums are those of one thread. */
void cs_psd_operator_apply(const struct cs_psd_operator *product, const double *p, double *y);
/* y (3,n) += (sum of c g g^T) v for the velocities v (3,n_points) of all points, those of
 * colliders too: what the elastic forces change by the way that pairs go. */
void cs_psd_operator_approach(const struct cs_psd_operator *product, size_t n_points,
                              const double *v, double *y);

#endif
