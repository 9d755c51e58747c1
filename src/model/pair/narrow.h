/* narrow.h - what the pairs in range at a state do. */
#ifndef CS_PAIR_NARROW_H
#define CS_PAIR_NARROW_H

#include "model/pair/active.h"

/* what the pairs in range are asked for */
enum cs_pair_ask {
    CS_PAIR_FORCE,
    CS_PAIR_CHANGE, /* of the force */
    CS_PAIR_ENERGY, /* into the lots' energy: no pair is kept */
    CS_PAIR_MATRIX,
    CS_PAIR_BOUND
};

struct cs_narrow {
    const struct cs_active *active; /* those of x */
    const double *x, *v;            /* (3, n_points) at the state; v NULL: at rest */
    struct cs_pair_set *set;
    enum cs_pair_ask ask;
    struct cs_eval at;
    const struct cs_matrix *matrix; /* of CS_PAIR_MATRIX */
};

/* Fills the lots of narrow->set and counts them, with all threads. */
void cs_narrow_run(struct cs_narrow *narrow);

#endif
