/* exact_distance.h - true squared distances of points, triangles and edges, in lanes.
 * Candidates are selected by them, because the smooth distance of pair_distance.h may jump
 * where the true one, which is 1-Lipschitz, moves little. */
#ifndef CS_NARROW_PHASE_EXACT_DISTANCE_H
#define CS_NARROW_PHASE_EXACT_DISTANCE_H

#include "model/contact/broad_phase/candidates.h"
#include "model/contact/pair_distance.h"

/* Pairs of one kind; lanes without a pair hold unspecified numbers. */
enum { CS_EXACT_DISTANCE_LANES = 8 };

struct cs_exact_distance_lanes {
    double p[4][3][CS_EXACT_DISTANCE_LANES];
    double squared[CS_EXACT_DISTANCE_LANES];
};

/* Sets squared in m2: of point p[0] from triangle p[1] p[2] p[3], or of edges p[0] p[1] and
 * p[2] p[3]. Exact but for rounding; a triangle without area counts as its edges, an edge
 * without length as its points. Not finite, or 0, if p is not finite. */
void cs_exact_distance_measure(enum cs_pair_kind kind, struct cs_exact_distance_lanes *lanes);

/* Candidates in range at a state, found once for all evaluations at it.
 */

/* Sets the pairs in range of all chunks at x (3,n_points): edges by the smooth distance, points
 * and triangles by the true one. Updates the candidate list first if it does not cover x. Does
 * nothing if x equals the last one to the bit. Returns false if out of memory. With all
 * threads. */
bool cs_candidates_find_in_range(struct cs_candidates *candidates, const double *x);

#endif
