/* accd_candidates.h - collision-free fraction of a step, computed from contact's candidate
 * list. */
#ifndef CS_ACCD_CANDIDATES_H
#define CS_ACCD_CANDIDATES_H

#include "model/system/system.h"

/* Returns whether the candidate list contains all pairs of primitives that may meet on the way
 * from x0 to x1: contact is defined between all bodies, or `apart` says that the others may
 * cross, and the move is short. If so, the list covers the whole way afterwards. */
bool cs_accd_candidates_suffice(const struct cs_system *system, bool apart, const double *x0,
                                const double *x1);

/* cs_crossings_safe_fraction over the pairs of the list, bit for bit the same. With all
 * threads. Only after cs_accd_candidates_suffice returned true for the same x0 and x1. */
double cs_accd_candidates_safe_fraction(const struct cs_system *system, const double *x0,
                                        const double *x1);

#endif
