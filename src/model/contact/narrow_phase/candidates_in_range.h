/* candidates_in_range.h - which pairs of the search's list are in range at a state: found once
 * for all that is asked there. */
#ifndef CS_NARROW_PHASE_CANDIDATES_IN_RANGE_H
#define CS_NARROW_PHASE_CANDIDATES_IN_RANGE_H

#include "model/contact/broad_phase/candidates.h"

/* Sets the close pairs of all chunks to those in range at x (3,n_points), edges by the smooth
 * distance; makes the list good for x where it is not. Where x is what it was the last time, to
 * the bit, nothing is done. false: no memory. With all threads. */
bool cs_candidates_find_in_range(struct cs_candidates *candidates, const double *x);

#endif
