/* vectorise.h - for a file whose loops do a whole thing a turn, lane by lane, and are to become
 * vectors: to be included before all that is inlined there. */
#ifndef CS_VECTORISE_H
#define CS_VECTORISE_H

#if defined(__GNUC__) && !defined(__clang__)
/* else gcc keeps branches round what could trap, and no such loop becomes one of vectors;
 * values are the same */
#pragma GCC optimize("no-trapping-math")
#endif

/* before a loop within the loop over lanes, so that what it fills is in registers when that is
 * looked at */
#define CS_UNROLLED _Pragma("GCC unroll 12")

#endif
