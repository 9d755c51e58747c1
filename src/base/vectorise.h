/* vectorise.h - compiler settings for files whose loops compute one whole item per iteration,
 * lane by lane, and must vectorise. Include it before everything that is inlined there. */
#ifndef CS_VECTORISE_H
#define CS_VECTORISE_H

#if defined(__GNUC__) && !defined(__clang__)
/* Otherwise gcc keeps branches around operations that could trap, and does not vectorise such
 * loops. Results are the same. */
#pragma GCC optimize("no-trapping-math")
#endif

/* Unrolls a short loop inside the loop over lanes, so that its array stays in registers. */
#define CS_UNROLLED _Pragma("GCC unroll 12")

#endif
