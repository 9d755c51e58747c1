/* candidates.h - candidate list: pairs of points and triangles, and of edges, that may be in
 * range, with a margin as in Verlet's list (Verlet 1967).
 *
 * The list holds all pairs whose true distance was below range + 2 margins when it was built
 * (for edges, their fraction of the range). It is valid while no two points of a pair have
 * moved relative to each other by more than 2 margins. Motion is measured per body against the
 * middle of the displacements of its particles, so that a body that falls as a whole costs
 * nothing. The smooth distance is never below the true one, so no pair in range is missed.
 *
 * The additional pairs have no effect: a pair out of range adds nothing at all, not even 0, and
 * pairs are in the order of their keys (kind, first, second) in every list. Sums are therefore
 * functions of the state; their bits are the same for every margin and every age of the list.
 */
#ifndef CS_BROAD_PHASE_CANDIDATES_H
#define CS_BROAD_PHASE_CANDIDATES_H

#include "model/contact/broad_phase/candidate_list.h"

/* Margin in units of the smallest range. A larger one makes longer lists that are rebuilt less
 * often. Chosen by trial. */
#define CS_CANDIDATES_MARGIN 0.35

/* Prepares an empty list. Fixed arrays come from the system's arena, which then owns the lists
 * too. body_pairs is borrowed. CS_ERR_MEMORY. */
enum cs_status cs_candidates_init(struct cs_candidates *candidates, struct cs_system *system,
                                  const struct cs_body_pair_table *body_pairs,
                                  struct cs_error *error);

/* Makes the list valid at x (3,n_points) in m; rebuilds it if particles have moved by more than
 * its margin. Returns false if out of memory. */
bool cs_candidates_update(struct cs_candidates *candidates, const double *x);

/* Makes the list valid for all states on the straight way from x0 to x1 (3,n_points). Returns
 * false if out of memory, or if nearby bodies, or parts of one, move so far relative to each
 * other that the list would become too long: more than CS_CANDIDATES_FAR_MARGINS usual margins.
 */
enum { CS_CANDIDATES_FAR_MARGINS = 8 };
bool cs_candidates_cover_step(struct cs_candidates *candidates, const double *x0,
                              const double *x1);

/* Largest relative motion from x0 to x1 of two bodies with contact, or within one, in units of
 * their range; NaN if a position is NaN. */
double cs_candidates_max_motion(const struct cs_candidates *candidates, const double *x0,
                                const double *x1);

/* Returns whether all pairs of the current list that are in range at x are among those nearby:
 * such a pair was further apart where these were collected by at most its relative motion. */
bool cs_candidates_is_nearby(const struct cs_candidates *candidates, const double *x);

/* Largest motion, in ranges, up to which a list that covers the way contains all pairs that
 * ACCD can stop. ACCD stops a pair whose gap g has fallen to a tenth of its start s. With the
 * motion m, s <= g + m and g <= s/10 give g <= m/9. That must be below the range of edges; 8.9
 * leaves room for rounding. */
#define CS_CANDIDATES_ACCD_LIMIT (8.9 * CS_EDGE_RANGE_RATIO)

#endif
