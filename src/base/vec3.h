/* vec3.h - products and lengths of 3-vectors, and symmetric 3 x 3 matrices, whose sums run left
 * to right; the smaller and the larger of two numbers, and a smooth positive part. */
#ifndef CS_VEC3_H
#define CS_VEC3_H

#include <clothsim/clones.h>

#include <math.h>
#include <stdbool.h>
#include <stddef.h>

/* By one comparison, for loops that vectorise: b if one of them is not a number. */
CS_INLINE double cs_fmin(double a, double b) {
    return a < b ? a : b;
}

CS_INLINE double cs_fmax(double a, double b) {
    return a > b ? a : b;
}

CS_INLINE double cs_vec3_dot(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

CS_INLINE double cs_vec3_length(const double a[3]) {
    return sqrt(cs_vec3_dot(a, a));
}

/* The length of a - b. */
CS_INLINE double cs_vec3_distance(const double a[3], const double b[3]) {
    const double d[3] = {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
    return cs_vec3_length(d);
}

/* The distance of vectors a and b of x (3,n). */
CS_INLINE double cs_vec3_distance_at(const double *x, size_t n, size_t a, size_t b) {
    const double d[3] = {x[b] - x[a], x[n + b] - x[n + a], x[2 * n + b] - x[2 * n + a]};
    return cs_vec3_length(d);
}

/* Extends the box from low to high by a point with a margin. */
CS_INLINE void cs_vec3_extend_box(double low[3], double high[3], const double p[3], double by) {
    for (int c = 0; c < 3; c++) {
        low[c] = fmin(low[c], p[c] - by);
        high[c] = fmax(high[c], p[c] + by);
    }
}

/* out = a x b; out must be neither a nor b. */
CS_INLINE void cs_vec3_cross(const double a[3], const double b[3], double out[3]) {
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

/* Scales a to length 1; a must not be 0. */
CS_INLINE void cs_vec3_normalise(double a[3]) {
    const double length = cs_vec3_length(a);
    for (int c = 0; c < 3; c++)
        a[c] /= length;
}

/* Row and column of the six numbers of a symmetric matrix: xx, xy, xz, yy, yz, zz. */
static const int cs_sym3_row[6] = {0, 0, 0, 1, 1, 2};
static const int cs_sym3_column[6] = {0, 1, 2, 1, 2, 2};

/* out = s p for a symmetric matrix s: xx, xy, xz, yy, yz, zz; out must not be p. */
CS_INLINE void cs_sym3_multiply(const double s[6], const double p[3], double out[3]) {
    out[0] = s[0] * p[0] + s[1] * p[1] + s[2] * p[2];
    out[1] = s[1] * p[0] + s[3] * p[1] + s[4] * p[2];
    out[2] = s[2] * p[0] + s[4] * p[1] + s[5] * p[2];
}

CS_INLINE bool cs_vec3_is_zero(const double a[3]) {
    return a[0] == 0 && a[1] == 0 && a[2] == 0;
}

/* The positive part of t smoothed over -e..e: 0 below, t above, else
 *   S(t) = 2e z^4 (z^2 - 3z + 5/2),   z = (t + e) / 2e
 * S' = z^3 (10 - 15 z + 6 z^2) is the quintic that rises from 0 to 1 with zero first and second
 * derivatives at both ends, hence three continuous derivatives of S. S'' = 15/e z^2 (1 - z)^2.
 * out: S, S', S''. e may be 0. */
CS_INLINE void cs_smooth_positive(double t, double e, double out[3]) {
    // chosen last, not branched to: loops over many vectorise
    const double z = (t + e) / (2 * e), left = 1 - z;
    const double value = 2 * e * (z * z) * (z * z) * (z * z - 3 * z + 2.5);
    const double slope = z * z * z * (10 - 15 * z + 6 * z * z);
    const double turn = 15 / e * (z * z) * (left * left);
    const double inner[3] = {value, slope, turn}, above[3] = {t, 1, 0};
    for (int k = 0; k < 3; k++) {
        const double below = t <= -e ? 0 : inner[k];
        out[k] = t >= e ? above[k] : below;
    }
}

#endif
