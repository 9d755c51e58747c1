/* vec3.h - products of 3-vectors. Sums run left to right. */
#ifndef CS_VEC3_H
#define CS_VEC3_H

#include <clothsim/clones.h>

#include <math.h>
#include <stdbool.h>

CS_INLINE double cs_vec3_dot(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* out = a x b; out must be neither a nor b. */
CS_INLINE void cs_vec3_cross(const double a[3], const double b[3], double out[3]) {
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

/* Scales a to length 1; a must not be 0. */
CS_INLINE void cs_vec3_normalise(double a[3]) {
    const double length = sqrt(cs_vec3_dot(a, a));
    for (int c = 0; c < 3; c++)
        a[c] /= length;
}

CS_INLINE bool cs_vec3_is_zero(const double a[3]) {
    return a[0] == 0 && a[1] == 0 && a[2] == 0;
}

#endif
