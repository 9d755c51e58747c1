/* product.h - a matrix of pairs that is not exact: its diagonal blocks, and products with it,
 * in lanes. */
#ifndef CS_PAIR_PRODUCT_H
#define CS_PAIR_PRODUCT_H

#include "model/pair/active.h"

/* What one lot has. */
struct cs_product_lot {
    struct cs_pair_factors *factors; /* CS_PAIR_LANES pairs each */
    size_t room;
    bool failed; /* there was no memory */
};

struct cs_product {
    struct cs_active *active; /* whose pairs it is of, which stay while it does; NULL: none */
    bool alone;               /* blocks are above the whole of it */
    struct cs_product_lot *lots;
    uint32_t n_lots;
    double *own; /* (rows, 6) diagonal blocks of what each lot has */
    size_t own_room;
};

/* The arena owns what it takes. CS_ERR_MEMORY. */
enum cs_status cs_product_init(struct cs_product *product, uint32_t n_lots,
                               struct cs_arena *arena, struct cs_error *error);

/* Makes it that of some pairs, whose blocks of factors are put then. false: no memory. */
bool cs_product_begin(struct cs_product *product, struct cs_active *active, bool alone);
/* The factors of a lot, to be filled; NULL: no memory. Different lots at the same time. */
struct cs_pair_factors *cs_product_lot_begin(struct cs_product *product, uint32_t number);
/* After they are: takes their diagonal blocks. */
void cs_product_lot_end(struct cs_product *product, uint32_t number);
/* After all; false: no memory. */
bool cs_product_end(struct cs_product *product);

/* blocks (6,n) += the diagonal blocks at particles [begin, end). */
void cs_product_add_blocks(const struct cs_product *product, size_t begin, size_t end,
                           double *blocks);

/* y (3,n) += the matrix without its diagonal blocks, times p. With all threads. */
void cs_product_add(const struct cs_product *product, const double *p, double *y);

#endif
