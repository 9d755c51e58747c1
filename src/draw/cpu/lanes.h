/* lanes.h - four numbers at a time: the samples of a pixel, or neighbours in a row.
 *
 * + - * / sqrt, comparisons and whole numbers only, in one order and without contraction: the
 * bits do not depend on the compiler or the processor. Minima and maxima are written as
 * comparisons, since fmin and fmax are calls. */
#ifndef CS_DRAW_LANES_H
#define CS_DRAW_LANES_H

#include <clothsim/clones.h>
#include <stdint.h>

/* four floats; four integers, or a mask of all ones and zeros; four floats at any address */
typedef float cs_f4 __attribute__((vector_size(16)));
typedef int32_t cs_i4 __attribute__((vector_size(16)));
typedef float cs_f4_unaligned __attribute__((vector_size(16), aligned(4)));

/* Selects per lane: a if mask is all ones, b if it is 0. */
CS_INLINE cs_i4 cs_select(cs_i4 mask, cs_i4 a, cs_i4 b) {
    return (mask & a) | (~mask & b);
}

/* Limits each lane to least..most. */
CS_INLINE cs_f4 cs_clamp4(cs_f4 v, float least, float most) {
    const cs_f4 low = {least, least, least, least}, high = {most, most, most, most};
    v = (cs_f4)cs_select(v < low, (cs_i4)low, (cs_i4)v);
    return (cs_f4)cs_select(v > high, (cs_i4)high, (cs_i4)v);
}

CS_INLINE int cs_min(int a, int b) {
    return a < b ? a : b;
}
CS_INLINE int cs_max(int a, int b) {
    return a > b ? a : b;
}
/* Limits v to least..most; NaN becomes least. */
CS_INLINE float cs_clamp(float v, float least, float most) {
    const float raised = v > least ? v : least;
    return raised < most ? raised : most;
}

#endif
