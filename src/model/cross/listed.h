/* listed.h - how far a move may go before two parts meet, from the list of contact's pairs. */
#ifndef CS_LISTED_H
#define CS_LISTED_H

#include "model/system/system.h"

/* Whether the list of pairs has all pairs of parts that may meet on the way from x0 to x1: all
 * bodies keep off each other and themselves, or `apart`: the others may meet; and the move is
 * short. The list is then good for all of the way. */
bool cs_listed_covers(const struct cs_system *system, bool apart, const double *x0,
                      const double *x1);

/* cs_crossings_share of the pairs in the list, to the same bits. With all threads. */
double cs_listed_share(const struct cs_system *system, const double *x0, const double *x1);

#endif
