/* shape_rotation.h - small matrices for shape matching, in + - * / and sqrt alone.
 *
 * A 3x3 matrix is 9 doubles by rows; a quaternion is x, y, z, w. */
#ifndef SHAPE_ROTATION_H
#define SHAPE_ROTATION_H

#include <stdbool.h>

/* Eigenvalues and vectors of a symmetric matrix a (n,n), n at most 4, by cyclic Jacobi
 * rotations: a becomes diagonal, column k of vectors (n,n) belongs to a[k][k]. a is
 * overwritten; sweeps are limited, so that numbers that are none end too. */
void shape_eigen(int n, double *a, double *vectors);

/* The proper rotation r that makes trace(r^T a) largest: for a = r s, s symmetric and positive,
 * that r (the polar decomposition); for an inverted a the nearest rotation, which turns the
 * least stretched axis back. It is the quaternion of the largest eigenvalue of a symmetric 4x4
 * matrix (Horn 1987, sec. 4), so that there is no square root of a matrix and no case of its
 * own for a flat a. Where several rotations are as good as each other (a line, a point, a
 * mirror image of a sphere; to 1e-12 of size) it is that nearest to the last one.
 * last: the last one in, this one out. size: of an undeformed a, the sum of its eigenvalues. */
void shape_rotation(const double a[9], double size, double last[4], double r[9]);

/* The rotation matrix of a unit quaternion. */
void shape_rotation_of(const double quaternion[4], double r[9]);

double shape_determinant(const double a[9]);

/* out = a b; out must be another matrix. */
void shape_product(const double a[9], const double b[9], double out[9]);

/* out = a^-T = a (a^T a)^-1. Returns false if the determinant is 0; out is then unchanged. */
bool shape_inverse_transposed(const double a[9], double out[9]);

/* Pseudo-inverse of a symmetric positive semi-definite a, and the projector on its null
 * space: the directions in which a is less than 1e-10 of its largest eigenvalue. */
void shape_pseudo_inverse(const double a[9], double inverse[9], double null[9]);

/* Cube root of d > 0 to a few roundings. */
double shape_cube_root(double d);

#endif
