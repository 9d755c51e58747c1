/* pair_set.h - contacts that each act on a few particles at once: found lot by lot, each with
 * what it does, then gathered particle by particle, in the order of the lots.
 */
#ifndef CS_PAIR_SET_H
#define CS_PAIR_SET_H

#include "base/arena.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* What one contact in range does. */
struct cs_pair {
    uint32_t n, at[4]; /* particles, 2 to 4; from n_particles on: points of obstacles */
    double to[4][3];   /* force, its change, or the gradient g of a matrix */
};

/* What it has of a matrix or of bounds: apart, so that forces go over no more than they need.
 */
struct cs_pair_part {
    double share[4]; /* the weights w; of bounds: N s/m */
    double along;    /* along g g^T + (w w^T) x of, and cs_pair_lot.full */
    double of[6];    /* xx, xy, xz, yy, yz, zz; of bounds: N/m of each particle */
    double by[4][3]; /* what cs_pair_set_multiply makes of a vector */
};

/* how the gradient of a pair turns: 12 x 12, symmetric */
struct cs_pair_turn {
    double of[12][12];
};

/* What was found in range together: one thread's. */
struct cs_pair_lot {
    struct cs_pair *pairs;
    size_t n, room;
    size_t first;               /* pairs of the lots before it */
    struct cs_pair_part *parts; /* (n) of a matrix or of bounds */
    size_t parts_room;
    struct cs_pair_turn *full; /* (n) of a matrix whose set is exact */
    size_t full_room;
    double energy; /* J */
    bool failed;   /* there was no memory */
};

/* A corner of a pair, as one of those that a particle gathers. */
struct cs_pair_end {
    const struct cs_pair *pair;
    uint32_t corner, lot;
};

/* All in range at one state. */
struct cs_pair_set {
    struct cs_pair_lot *lots; /* (n_lots) */
    uint32_t n_lots, n_particles;
    size_t n;                 /* pairs in all lots */
    bool alone;               /* of a matrix: blocks that are above the whole of it */
    bool exact;               /* of a matrix: lots have `full` */
    bool points;              /* of a matrix: no pair has a gradient, `along` and `to` are 0 */
    bool failed;              /* there was no memory: pairs lack, and the run must end */
    uint32_t *corners;        /* (4 n) points of all pairs; UINT32_MAX: it has fewer */
    struct cs_pair_end *ends; /* (4 n) those of particle i: ends[starts[i]..starts[i + 1]) */
    size_t corners_room, ends_room;
    uint32_t *starts; /* (n_particles + 2) */
};

/* Points of obstacles feel nothing here, and do not move. */
static inline bool cs_pair_set_has(const struct cs_pair_set *set, uint32_t point) {
    return point < set->n_particles;
}

/* Fixed arrays from the arena, which then owns what grows too. CS_ERR_MEMORY. */
enum cs_status cs_pair_set_init(struct cs_pair_set *set, uint32_t n_particles, uint32_t n_lots,
                                struct cs_arena *arena, struct cs_error *error);

/* Empties a lot, before it is filled. */
void cs_pair_lot_clear(struct cs_pair_lot *lot);
/* The next place of a lot; NULL: no memory. */
struct cs_pair *cs_pair_lot_next(struct cs_pair_lot *lot);
/* The part of the place that was given last; NULL: no memory. */
struct cs_pair_part *cs_pair_lot_part(struct cs_pair_lot *lot);

/* Counts what the lots hold, after they were filled; 0 where one failed. */
void cs_pair_set_count(struct cs_pair_set *set);
/* And finds the corners of each particle. */
void cs_pair_set_gather(struct cs_pair_set *set);

/* J, of all lots. */
double cs_pair_set_energy(const struct cs_pair_set *set);

/* f (3,n) += what was gathered at particles [begin, end). */
void cs_pair_set_add(const struct cs_pair_set *set, size_t begin, size_t end, double *f);

/* blocks (6,n) += the diagonal blocks of a matrix there. With set->alone they are above all of
 * the matrix: (sum a_i)^2 <= sum |a_i| sum a_i^2/|a_i| of the weights, or the gradient. */
void cs_pair_set_add_blocks(const struct cs_pair_set *set, size_t begin, size_t end,
                            double *blocks);

/* y (3,n) += a matrix without its diagonal blocks, times p. With all threads. */
void cs_pair_set_multiply(const struct cs_pair_set *set, const double *p, double *y);

/* Adds the bounds of all to their particles. */
void cs_pair_set_add_bound(const struct cs_pair_set *set, double *stiffness, double *damping);

#endif
