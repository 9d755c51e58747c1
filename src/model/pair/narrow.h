/* narrow.h - what the pairs in range at a state do. */
#ifndef CS_PAIR_NARROW_H
#define CS_PAIR_NARROW_H

#include "model/pair/active.h"
#include "model/pair/product.h"

/* what the pairs in range are asked for */
enum cs_pair_ask {
    CS_PAIR_FORCE,
    CS_PAIR_CHANGE, /* of the force */
    CS_PAIR_ENERGY,
    CS_PAIR_MATRIX,
    CS_PAIR_BOUND
};

struct cs_narrow {
    struct cs_active *active; /* those of x */
    const double *x, *v;      /* (3, n_points) at the state; v NULL: at rest */
    enum cs_pair_ask ask;
    struct cs_eval at;
    const struct cs_matrix *matrix; /* of CS_PAIR_MATRIX */
    struct cs_product *product;     /* of a matrix that is psd */
    struct cs_pair_set *set;        /* of any other */
};

/* Answers into the sums of the active pairs' rows, which are there but for energies: forces
 * (n_rows, 3), or bounds (2, n_rows), stiffness and damping; into their lots' energies; or
 * fills the product or the set. false: no memory. With all threads. */
bool cs_narrow_run(struct cs_narrow *narrow);

#endif
