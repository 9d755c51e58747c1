/* SPDX-License-Identifier: MIT */
/* small.h - 3-vectors and symmetric 3x3 blocks out of component-major arrays.
 *
 * Arrays lie component by component: vector i of an array (3,n) is array[i], array[n + i],
 * array[2 n + i]. A symmetric block is six doubles: xx, xy, xz, yy, yz, zz. All sums run from
 * left to right, and no function calls the mathematics library, so that the bits are the same
 * on every machine.
 *
 * There are two inverses. cs_sym3_invert_definite is for blocks that a solver of positive
 * definite systems takes; it says where a block is not one. cs_sym3_invert_any and
 * cs_sym3_invert are for any block and any units: they scale it first.
 */
#ifndef CLOTHSIM_SMALL_H
#define CLOTHSIM_SMALL_H

#include <math.h>
#include <stdbool.h>
#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Reads vector i of an array (3,n). */
static inline void cs_vec3_read(size_t n, const double *array, size_t i, double out[3]) {
    for (size_t c = 0; c < 3; c++)
        out[c] = array[c * n + i];
}

/* Writes vector i of an array (3,n). */
static inline void cs_vec3_write(size_t n, double *array, size_t i, const double a[3]) {
    for (size_t c = 0; c < 3; c++)
        array[c * n + i] = a[c];
}

/* Reads block i of an array (6,n). */
static inline void cs_sym3_read(size_t n, const double *array, size_t i, double out[6]) {
    for (size_t c = 0; c < 6; c++)
        out[c] = array[c * n + i];
}

/* Writes block i of an array (6,n). */
static inline void cs_sym3_write(size_t n, double *array, size_t i, const double a[6]) {
    for (size_t c = 0; c < 6; c++)
        array[c * n + i] = a[c];
}

/* out = a p, left to right. out may not be p. */
static inline void cs_sym3_mul(const double a[6], const double p[3], double out[3]) {
    out[0] = a[0] * p[0] + a[1] * p[1] + a[2] * p[2];
    out[1] = a[1] * p[0] + a[3] * p[1] + a[4] * p[2];
    out[2] = a[2] * p[0] + a[4] * p[1] + a[5] * p[2];
}

/* Writes the cofactors of a (the inverse is them over the determinant) and returns the
 * determinant. cofactors may not be a. This is the one formula of all inverses below. */
static inline double cs_sym3_cofactors(const double a[6], double cofactors[6]) {
    cofactors[0] = a[3] * a[5] - a[4] * a[4];
    cofactors[1] = a[2] * a[4] - a[1] * a[5];
    cofactors[2] = a[1] * a[4] - a[2] * a[3];
    cofactors[3] = a[0] * a[5] - a[2] * a[2];
    cofactors[4] = a[1] * a[2] - a[0] * a[4];
    cofactors[5] = a[0] * a[3] - a[1] * a[1];
    return a[0] * cofactors[0] + a[1] * cofactors[1] + a[2] * cofactors[2];
}

/* True if a is positive definite: its leading minors are above 0 (Sylvester). False for NaN.
 */
static inline bool cs_sym3_is_definite(const double a[6], const double cofactors[6],
                                       double determinant) {
    return a[0] > 0 && cofactors[5] > 0 && determinant > 0;
}

/* The inverse of a positive definite block. Returns false if a is not positive definite, and
 * leaves inverse unwritten. inverse may be a. */
static inline bool cs_sym3_invert_definite(const double a[6], double inverse[6]) {
    double cofactors[6];
    const double determinant = cs_sym3_cofactors(a, cofactors);
    if (!cs_sym3_is_definite(a, cofactors, determinant))
        return false;
    const double factor = 1 / determinant;
    for (int c = 0; c < 6; c++)
        inverse[c] = cofactors[c] * factor;
    return true;
}

/* The inverse by cofactors, of a block that need not be definite. There is no branch in it, so
 * that a loop over many blocks vectorises.
 *
 * Returns the determinant of a scaled to a largest entry of 1. Pass it to cs_sym3_is_regular:
 * if that is false, a is singular to working precision or not finite, and inverse is
 * worthless. inverse may be a. */
static inline double cs_sym3_invert_any(const double a[6], double inverse[6]) {
    double largest = 0;
    for (int c = 0; c < 6; c++)
        largest = fabs(a[c]) > largest ? fabs(a[c]) : largest;
    // scaled, so that light particles do not underflow
    double scaled[6], cofactors[6];
    for (int c = 0; c < 6; c++)
        scaled[c] = a[c] / largest;
    const double determinant = cs_sym3_cofactors(scaled, cofactors);
    for (int c = 0; c < 6; c++)
        inverse[c] = cofactors[c] / (determinant * largest);
    return determinant;
}

/* True if the block with this scaled determinant has an inverse: its magnitude is above 1e-30.
 * False for NaN. */
static inline bool cs_sym3_is_regular(double scaled_determinant) {
    return fabs(scaled_determinant) > 1e-30;
}

/* The same for a single block. Returns false if a is singular or not finite, and leaves
 * inverse unwritten. inverse may be a. */
static inline bool cs_sym3_invert(const double a[6], double inverse[6]) {
    double found[6];
    if (!cs_sym3_is_regular(cs_sym3_invert_any(a, found)))
        return false;
    for (int c = 0; c < 6; c++)
        inverse[c] = found[c];
    return true;
}

#ifdef __cplusplus
}
#endif
#endif
