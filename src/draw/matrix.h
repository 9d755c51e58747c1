/* matrix.h - 3-vectors and 4x4 matrices for cameras; + - * / and sqrt only, for equal bits.
 *
 * Matrices are stored by columns, as OpenGL takes them: element (row, column) is [4 column +
 * row]. Clip space is OpenGL's: -w <= x, y, z <= w is visible, z = -w at the near plane. */
#ifndef CS_DRAW_MATRIX_H
#define CS_DRAW_MATRIX_H

#include "base/vec3.h"

#include <math.h>
#include <string.h>

/* out = a - b. */
static inline void cs_subtract(const double a[3], const double b[3], double out[3]) {
    for (int i = 0; i < 3; i++)
        out[i] = a[i] - b[i];
}

/* Makes a unit vector in place; the zero vector stays. */
static inline void cs_normalise(double a[3]) {
    const double length = cs_vec3_length(a);
    for (int i = 0; i < 3; i++)
        a[i] = length > 0 ? a[i] / length : 0;
}

/* Sets a unit vector `across` at right angles to the unit vector `along`, and the third one
 * that makes (across, third, along) right-handed. */
static inline void cs_frame_from_direction(const double along[3], double across[3],
                                           double third[3]) {
    const double axis[3] = {fabs(along[0]) < 0.6, fabs(along[0]) >= 0.6, 0};
    cs_vec3_cross(axis, along, across);
    cs_normalise(across);
    cs_vec3_cross(along, across, third);
}

/* out = a b; out may be neither. */
static inline void cs_matrix_multiply(const double a[16], const double b[16], double out[16]) {
    for (int column = 0; column < 4; column++)
        for (int row = 0; row < 4; row++) {
            double sum = 0;
            for (int k = 0; k < 4; k++)
                sum += a[4 * k + row] * b[4 * column + k];
            out[4 * column + row] = sum;
        }
}

/* World to camera: x right, y up, z towards the camera. Rows are the camera's axes a_k, and the
 * translation is -a_k.eye. */
static inline void cs_matrix_look(const double eye[3], const double target[3],
                                  const double up[3], double out[16]) {
    double axes[3][3], unused[3];
    cs_subtract(eye, target, axes[2]);
    cs_normalise(axes[2]);
    cs_vec3_cross(up, axes[2], axes[0]);
    // looking straight along up: any turn will do
    if (cs_vec3_length(axes[0]) < 1e-9 * cs_vec3_length(up))
        cs_frame_from_direction(axes[2], axes[0], unused);
    cs_normalise(axes[0]);
    cs_vec3_cross(axes[2], axes[0], axes[1]);
    memset(out, 0, 16 * sizeof *out);
    for (int row = 0; row < 3; row++) {
        for (int i = 0; i < 3; i++)
            out[4 * i + row] = axes[row][i];
        out[12 + row] = -cs_vec3_dot(axes[row], eye);
    }
    out[15] = 1;
}

/* Tangent of an angle of 0..1.5 as the quotient of the series of sine and cosine: libm's last
 * bit depends on the machine. Terms shrink as 1.5^k / k!, below the last bit after 24 of
 * them. */
static inline double cs_tangent(double angle) {
    double sine = 0, cosine = 0, term = 1;
    for (int k = 0; k < 28; k++) {
        const double signed_term = k & 2 ? -term : term;
        if (k & 1)
            sine += signed_term;
        else
            cosine += signed_term;
        term = term * angle / (k + 1);
    }
    return sine / cosine;
}

/* Perspective: w is the distance along the view, z/w runs from -1 at near to 1 at far. slope:
 * tangent of half the vertical angle; aspect: width over height. */
static inline void cs_matrix_perspective(double slope, double aspect, double near, double far,
                                         double out[16]) {
    memset(out, 0, 16 * sizeof *out);
    out[0] = 1 / (slope * aspect);
    out[5] = 1 / slope;
    out[10] = (far + near) / (near - far);
    out[11] = -1;
    out[14] = 2 * far * near / (near - far);
}

/* Parallel projection: w is 1 and z linear. half: m from the middle of the picture to its upper
 * edge. */
static inline void cs_matrix_parallel(double half, double aspect, double near, double far,
                                      double out[16]) {
    memset(out, 0, 16 * sizeof *out);
    out[0] = 1 / (half * aspect);
    out[5] = 1 / half;
    out[10] = 2 / (near - far);
    out[14] = (far + near) / (near - far);
    out[15] = 1;
}

/* Rounds a matrix to floats, for a view block. */
static inline void cs_matrix_to_float(const double from[16], float to[16]) {
    for (int i = 0; i < 16; i++)
        to[i] = (float)from[i];
}

#endif
