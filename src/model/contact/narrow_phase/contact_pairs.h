/* contact_pairs.h - contact between surfaces: the pairs in range at a state, and the force of
 * each on its four points.
 *
 * With the smooth distance d of a pair, its gradient g (four vectors), the weights w of its
 * contact points, n the direction between them and V = sum w_i v_i their relative velocity:
 *
 *   elastic   F g_i                                   F = -psi'(d), barrier_law.h
 *   damping   -tau K n (n.V) w_i                      friction  -mu F T w_i / sqrt(T.T + ev^2)
 *
 * with T = V - n (n.V), as in point_contact.h. Each sums to 0 over the four points, so linear
 * momentum is kept. The elastic force has no torque, because g is the gradient of a function
 * that rigid motions do not change; nor has damping, which acts along n. Friction has a torque,
 * because its two points are a distance d apart. */
#ifndef CS_NARROW_PHASE_CONTACT_PAIRS_H
#define CS_NARROW_PHASE_CONTACT_PAIRS_H

#include "model/contact/narrow_phase/active_contacts.h"
#include "model/contact/narrow_phase/pair_matrix.h"
#include "model/system/surfaces.h"

/* Start, displacement and inverse mass of every surface point, one cache line
 * per point, because pairs access points at random. */

/* Indices of the eight numbers of a point: start (3, m), inverse mass (1/kg), displacement (3,
 * m), and one that is 0. */
enum {
    CS_POINT_MOVE_FROM = 0,
    CS_POINT_MOVE_INVERSE_MASS = 3,
    CS_POINT_MOVE_BY = 4,
    CS_POINT_MOVE_NUMBERS = 8
};

struct cs_point_motion {
    double values[CS_POINT_MOVE_NUMBERS];
};

/* Sets moves (n_points) for the straight motion from x0 to x1 (3,n_points). */
void cs_point_motion_set(const struct cs_system *system, const double *x0, const double *x1,
                         struct cs_point_motion *moves);

/* Pairs of a point and a triangle, or of two edges; borrowed. */
struct cs_moving_pairs {
    const struct cs_surfaces *surfaces;
    bool edges;
    const uint32_t *items; /* (n, 2) by their numbers */
    size_t n;
};

/* Copies to out (n, 2) the pairs whose primitives may come within `reach` in m at one fraction
 * of the move: cs_swept_aabbs_overlap (primitive_search.h) of their own points. Returns how
 * many; a few nanoseconds per pair. out must have room for all pairs. */
size_t cs_point_motion_filter(const struct cs_point_motion *moves,
                              const struct cs_moving_pairs *pairs, double reach, uint32_t *out);

/* All state of contact between surfaces; the system's arena owns it. */
struct cs_pairs {
    /* borrowed */
    const struct cs_system *system;
    struct cs_body_pair_table body_pairs;
    struct cs_candidates candidates;
    struct cs_feature_weights feature_weights;
    struct cs_active_contacts
        lists[2]; /* in range at two states: of `kept`, and of the last question */
    /* the list that the last query used */
    struct cs_active_contacts *current_contacts;
    struct cs_pair_matrix solver_matrix; /* for products and blocks */
    struct cs_pair_matrix other_matrix;  /* another, whose blocks alone are wanted */
    const struct cs_pair_matrix *blocks; /* the one that was made last */
    /* (n_points) of the last step that was checked */
    struct cs_point_motion *point_motion;
    /* n_builds of the list, all of whose pairs were resolved in that step; 0: not all were.
     * The swept pairs of its chunks are then all whose swept boxes come within range. */
    uint64_t swept_build;
    /* chunk that rejected the last step */
    uint32_t unresolved_chunk;
    /* out of memory: pairs are missing, and the run must end */
    bool failed;
};

/* Builds system->pairs, and the surfaces if they are missing. CS_ERR_SCENE as
 * cs_body_pair_table_build, or if two primitives of one body start closer than its thickness;
 * CS_ERR_MEMORY. */
enum cs_status cs_pairs_build(struct cs_system *system, struct cs_error *error);

/* Evaluates forces at a state, or their change if at->dx or at->dv is set, with all threads. */
void cs_pairs_set(struct cs_pairs *pairs, const struct cs_eval *at);

/* f (3,n) += the result at the particles [begin, end). */
void cs_pairs_add(const struct cs_pairs *pairs, size_t begin, size_t end, double *f);

/* Power in W that the vertices of colliders give at the state of the last force: -f.v of each.
 */
double cs_pairs_power(const struct cs_pairs *pairs, const struct cs_eval *at);

/* Elastic energy in J. */
double cs_pairs_energy(struct cs_pairs *pairs, const struct cs_eval *at);

/* Stores the friction of all pairs at (t, x) by cs_lagged_friction_store, in the chunks from
 * `first` on: one for each chunk of the candidates. */
void cs_pairs_store_friction(struct cs_pairs *pairs, double t, const double *x, uint32_t first);

/* Evaluates the matrix terms. kept: for the solver, which will ask for products; the matrix
 * stays until the next such call. Otherwise the diagonal blocks alone are wanted, which bound
 * the whole matrix if matrix->bound is set. */
void cs_pairs_set_matrix(struct cs_pairs *pairs, const struct cs_matrix *matrix, bool kept);

/* blocks (6,n) += the diagonal blocks of the last matrix at the particles [begin, end). */
void cs_pairs_add_blocks(const struct cs_pairs *pairs, size_t begin, size_t end,
                         double *blocks);

/* y (3,n) += (the solver's matrix - its diagonal blocks) p, with all threads. */
void cs_pairs_multiply(const struct cs_pairs *pairs, const double *p, double *y);

/* y (3,n) += the elastic part of the solver's matrix, which was made at the state of `matrix`,
 * times the velocities of all points there: with all threads. */
void cs_pairs_add_approach(struct cs_pairs *pairs, const struct cs_matrix *matrix, double *y);

/* Adds the Gershgorin row sums of df/dx (N/m) and df/dv (N s/m) at a state. */
void cs_pairs_add_bound(struct cs_pairs *pairs, const struct cs_eval *at, double *stiffness,
                        double *damping);

/* As cs_collider_contact_resolves_step (contact/step_check.h), for pairs that move straight
 * from x0 at t0 to x1 at t1. Samples are at most half a range of relative motion apart. The
 * energy that is not predicted must stay below CS_UNRESOLVED_ENERGY_MAX of the energy of the
 * pair: psi(d), the kinetic energy of its contact points, and psi at half the range, so that
 * pairs that barely touch do not decide. A point and a triangle have the distance of the
 * nearest feature, and decide only if the energy of all features of the point, in place of
 * psi(d), is not predicted either. Returns false too if bodies near each other move too
 * far for cs_candidates_cover_step. With all threads. */
bool cs_contact_pairs_resolve_step(struct cs_pairs *pairs, double t0, const double *x0,
                                   double t1, const double *x1);

#endif
