/* psd_operator.h - a matrix of pairs that is not exact: its diagonal blocks, and products with
 * it, in lanes. */
#ifndef CS_NARROW_PHASE_PSD_OPERATOR_H
#define CS_NARROW_PHASE_PSD_OPERATOR_H

#include "model/contact/narrow_phase/active_contacts.h"

/* What one chunk has. */
struct cs_psd_chunk {
    struct cs_pair_factors *factors; /* CS_PAIR_LANES pairs each */
    size_t capacity;
    bool failed; /* there was no memory */
};

struct cs_psd_operator {
    struct cs_active_contacts
        *contacts;       /* whose pairs it is of, which stay while it does; NULL: none */
    bool diagonal_bound; /* blocks are above the whole of it */
    struct cs_psd_chunk *chunks;
    uint32_t n_chunks;
    double *diagonal; /* (rows, 6) diagonal blocks of what each chunk has */
    size_t diagonal_capacity;
};

/* The arena owns what it takes. CS_ERR_MEMORY. */
enum cs_status cs_psd_operator_init(struct cs_psd_operator *product, uint32_t n_chunks,
                                    struct cs_arena *arena, struct cs_error *error);

/* Makes it that of some pairs, whose blocks of factors are put then. false: no memory. */
bool cs_psd_operator_begin(struct cs_psd_operator *product, struct cs_active_contacts *active,
                           bool alone);
/* The factors of a lot, to be filled; NULL: no memory. Different lots at the same time. */
struct cs_pair_factors *cs_psd_operator_chunk_begin(struct cs_psd_operator *product,
                                                    uint32_t number);
/* After they are: takes their diagonal blocks. */
void cs_psd_operator_chunk_end(struct cs_psd_operator *product, uint32_t number);
/* After all; false: no memory. */
bool cs_psd_operator_end(struct cs_psd_operator *product);

/* blocks (6,n) += the diagonal blocks at particles [begin, end). */
void cs_psd_operator_add_blocks(const struct cs_psd_operator *product, size_t begin, size_t end,
                                double *blocks);

/* y (3,n) += the matrix without its diagonal blocks, times p. With all threads. */
void cs_psd_operator_apply(const struct cs_psd_operator *product, const double *p, double *y);

#endif
