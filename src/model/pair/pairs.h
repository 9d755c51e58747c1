/* pairs.h - the pairs in range at a state, and what each does to its four particles.
 *
 * With the smooth distance d of a pair, its gradient g (four vectors), the weights w of its
 * contact points, n the direction between these and V = sum w_i v_i their velocity against each
 * other:
 *
 *   elastic   F g_i                                   F = -psi'(d), law.h
 *   damping   -tau K n (n.V) w_i                      friction  -mu F T w_i / sqrt(T.T + ev^2)
 *
 * with T = V - n (n.V), as in touch.h. Each sums to 0 over the four. Elastic force and damping
 * turn nothing; friction acts at two points a distance d apart, and turns the pair by as much.
 */
#ifndef CS_PAIR_PAIRS_H
#define CS_PAIR_PAIRS_H

#include "model/pair/reaction.h"
#include "model/pair/search.h"

/* A corner of a pair, as one of those that a particle gathers. */
struct cs_pair_end {
    const struct cs_pair *pair;
    uint32_t corner, lot;
};

/* What lots of the search found in range. */
struct cs_pair_lot {
    struct cs_pair *pairs;
    size_t n, room;
    struct cs_pair_turn *full; /* (n) of a matrix that is exact */
    size_t full_room;
    double energy; /* J */
    bool failed;
};

/* All pairs in range at one state, in the order of their keys. */
struct cs_pair_set {
    struct cs_pair_lot *lots; /* as many as the search has */
    size_t n;
    bool alone;               /* of a matrix: blocks that are above the whole of it */
    bool exact;               /* of a matrix: lots have `full` */
    struct cs_pair_end *ends; /* (4 n) those of particle i: ends[starts[i]..starts[i + 1]) */
    size_t ends_room;
    uint32_t *starts; /* (particles + 1) */
};

struct cs_pairs {
    const struct cs_system *system; /* borrowed */
    struct cs_meetings meetings;
    struct cs_search search;
    struct cs_pair_set now;           /* of the last force, product or bound */
    struct cs_pair_set matrix;        /* of the solver's matrix, until the next */
    const struct cs_pair_set *blocks; /* whose diagonal blocks are asked for */
    bool failed; /* there was no memory: forces lack pairs, and the run must end */
};

/* Makes system->pairs, and the surfaces if they are not there. CS_ERR_SCENE: as
 * cs_meetings_build, or two parts of one body start nearer to each other than its thickness;
 * CS_ERR_MEMORY. */
enum cs_status cs_pairs_build(struct cs_system *system, struct cs_error *error);

/* Sets pairs->now to what the pairs do at a state: forces, or with at->dx or at->dv their
 * change. With all threads. */
void cs_pairs_set(struct cs_pairs *pairs, const struct cs_eval *at);

/* J, of the elastic part. */
double cs_pairs_energy(struct cs_pairs *pairs, const struct cs_eval *at);

/* Sets pairs->blocks to the shares of a matrix. kept: in pairs->matrix, for cs_pairs_multiply;
 * else in pairs->now; and then with matrix->bound the diagonal blocks alone are above all of
 * the shares: (sum a_i)^2 <= sum |a_i| sum a_i^2/|a_i| of the weights, or the gradient, at
 * four. */
void cs_pairs_set_matrix(struct cs_pairs *pairs, const struct cs_matrix *matrix, bool kept);

/* blocks (6,n) += the diagonal blocks at particles [begin, end). */
void cs_pairs_add_blocks(const struct cs_pairs *pairs, size_t begin, size_t end,
                         double *blocks);

/* y (3,n) += the kept matrix without its diagonal blocks, times p. With all threads. */
void cs_pairs_multiply(const struct cs_pairs *pairs, const double *p, double *y);

/* Adds the sums of norms in the rows of df/dx and df/dv at a state. */
void cs_pairs_add_bound(struct cs_pairs *pairs, const struct cs_eval *at, double *stiffness,
                        double *damping);

#endif
