/* contact_pairs.h - the pairs in range at a state, and what each does to its four particles.
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
#ifndef CS_NARROW_PHASE_CONTACT_PAIRS_H
#define CS_NARROW_PHASE_CONTACT_PAIRS_H

#include "model/contact/narrow_phase/active_contacts.h"
#include "model/contact/narrow_phase/psd_operator.h"
#include "model/contact/point_motion.h"

struct cs_pairs {
    const struct cs_system *system; /* borrowed */
    struct cs_body_pair_table body_pairs;
    struct cs_candidates candidates;
    struct cs_feature_weights feature_weights;
    struct cs_active_contacts
        lists[2]; /* in range at two states: of `kept`, and of the last question */
    struct cs_active_contacts *current_contacts; /* of the last question */
    struct cs_psd_operator solver_psd;           /* the solver's matrix, until the next, */
    struct cs_contact_set solver_exact;          /* or this one: kept.active is NULL */
    struct cs_psd_operator other_psd;            /* a matrix that is not kept, or */
    struct cs_contact_set other_exact;           /* one that is exact */
    enum {
        CS_PAIRS_SOLVER_PSD,
        CS_PAIRS_SOLVER_EXACT,
        CS_PAIRS_OTHER_PSD,
        CS_PAIRS_OTHER_EXACT
    } blocks;
    struct cs_point_motion *point_motion; /* (n_points) of the step that was asked about last */
    uint32_t unresolved_chunk;            /* the chunk with what was last not seen of a step */
    bool failed; /* there was no memory: pairs lack, and the run must end */
};

/* Makes system->pairs, and the surfaces if they are not there. CS_ERR_SCENE: as
 * cs_body_pair_table_build, or two parts of one body start nearer to each other than its
 * thickness; CS_ERR_MEMORY. */
enum cs_status cs_pairs_build(struct cs_system *system, struct cs_error *error);

/* Finds what the pairs do at a state: forces, or with at->dx or at->dv their change. With all
 * threads. */
void cs_pairs_set(struct cs_pairs *pairs, const struct cs_eval *at);
/* f (3,n) += that at particles [begin, end). */
void cs_pairs_add(const struct cs_pairs *pairs, size_t begin, size_t end, double *f);

/* J, of the elastic part. */
double cs_pairs_energy(struct cs_pairs *pairs, const struct cs_eval *at);

/* Finds the shares of a matrix. kept: for products too; else with matrix->bound for their
 * blocks alone. */
void cs_pairs_set_matrix(struct cs_pairs *pairs, const struct cs_matrix *matrix, bool kept);
/* blocks (6,n) += the diagonal blocks of the matrix that was found last, at particles
 * [begin, end). */
void cs_pairs_add_blocks(const struct cs_pairs *pairs, size_t begin, size_t end,
                         double *blocks);

/* y (3,n) += the kept matrix without its diagonal blocks, times p. With all threads. */
void cs_pairs_multiply(const struct cs_pairs *pairs, const double *p, double *y);

/* Adds the sums of norms in the rows of df/dx and df/dv at a state. */
void cs_pairs_add_bound(struct cs_pairs *pairs, const struct cs_eval *at, double *stiffness,
                        double *damping);

#endif
