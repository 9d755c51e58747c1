/* candidates_in_range.h - candidates in range at a state, found once for all evaluations at it.
 */
#ifndef CS_NARROW_PHASE_CANDIDATES_IN_RANGE_H
#define CS_NARROW_PHASE_CANDIDATES_IN_RANGE_H

#include "model/contact/broad_phase/candidates.h"

/* Sets the pairs in range of all chunks at x (3,n_points): edges by the smooth distance, points
 * and triangles by the true one. Updates the candidate list first if it does not cover x. Does
 * nothing if x equals the last one to the bit. Returns false if out of memory. With all
 * threads. */
bool cs_candidates_find_in_range(struct cs_candidates *candidates, const double *x);

#endif
