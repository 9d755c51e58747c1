/* close.h - which pairs of the search's list are in range at a state: found once for all that
 * is asked there. */
#ifndef CS_PAIR_CLOSE_H
#define CS_PAIR_CLOSE_H

#include "model/pair/search.h"

/* Sets the close pairs of all lots to those in range at x (3,n_points), edges by the smooth
 * distance; makes the list good for x where it is not. Where x is what it was the last time, to
 * the bit, nothing is done. false: no memory. With all threads. */
bool cs_close_find(struct cs_search *search, const double *x);

#endif
