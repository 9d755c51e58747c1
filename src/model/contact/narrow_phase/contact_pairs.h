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
                         struct cs_point_motion *motion);

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
size_t cs_point_motion_filter(const struct cs_point_motion *motion,
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
    /* chunk that rejected the last step */
    uint32_t unresolved_chunk;
    /* out of memory: pairs are missing, and the run must end */
    bool failed;
};

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
