/* product.h - products with a matrix of pairs of four particles, in lanes. */
#ifndef CS_PAIR_PRODUCT_H
#define CS_PAIR_PRODUCT_H

#include "model/pair/lanes.h"

/* What one lot of a set has for products. */
struct cs_product_lot {
    struct cs_pair_factors *factors; /* CS_PAIR_LANES pairs each */
    size_t factors_room;
    bool failed; /* there was no memory */
};

struct cs_product {
    const struct cs_pair_set *set; /* borrowed */
    struct cs_product_lot *lots;   /* those of the set */
    double (*products)[3];         /* (4 n) what a vector makes of each corner of all pairs */
    uint32_t *places;              /* (4 n) where the set's ends have theirs */
    size_t products_room, places_room;
};

/* For a set whose pairs have four particles each; the arena owns what it takes. CS_ERR_MEMORY.
 */
enum cs_status cs_product_init(struct cs_product *product, const struct cs_pair_set *set,
                               struct cs_arena *arena, struct cs_error *error);

/* Puts a matrix of the set that is not exact into lanes. false: no memory. */
bool cs_product_set(struct cs_product *product);

/* y (3,n) += the matrix without its diagonal blocks, times p, as cs_pair_set_multiply. With all
 * threads. */
void cs_product_add(const struct cs_product *product, const double *p, double *y);

#endif
