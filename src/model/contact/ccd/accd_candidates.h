/* accd_candidates.h - how far a move may go before two parts meet, from the list of contact's
 * pairs. */
#ifndef CS_ACCD_CANDIDATES_H
#define CS_ACCD_CANDIDATES_H

#include "model/system/system.h"

/* Whether the list of pairs has all pairs of parts that may meet on the way from x0 to x1: all
 * bodies keep off each other and themselves, or `apart`: the others may meet; and the move is
 * short. The list is then good for all of the way. */
bool cs_accd_candidates_suffice(const struct cs_system *system, bool apart, const double *x0,
                                const double *x1);

/* cs_crossings_safe_fraction of the pairs in the list, to the same bits. With all threads. */
double cs_accd_candidates_safe_fraction(const struct cs_system *system, const double *x0,
                                        const double *x1);

#endif
