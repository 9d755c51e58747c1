/* orient3d.h - side of a plane on which a point lies, without rounding.
 *
 * The signs are those of the exact determinants of the given doubles. The determinant is taken
 * in double first, and accepted if it exceeds its error bound. Otherwise it is taken again in
 * expansions, sums of doubles that do not overlap, which hold sums and products of doubles
 * exactly (Shewchuk 1997; two-sum of Knuth; two-product of Dekker 1971 with Veltkamp's split,
 * since a fused multiply-add is not available everywhere). Exact as long as no product of three
 * differences leaves the range of doubles. */
#ifndef CS_ORIENT3D_H
#define CS_ORIENT3D_H

/* Sign, -1, 0 or 1, of the determinant of the rows a - d, b - d, c - d: 1 if d lies below the
 * plane through a, b and c, seen from where these go counter-clockwise. 0 if a number is NaN.
 */
int cs_orient3d(const double a[3], const double b[3], const double c[3], const double d[3]);

/* The same with d moved by (e, e^2, e^3) for an infinitesimal e > 0: 0 only if a, b and c are
 * collinear. */
int cs_orient3d_moved(const double a[3], const double b[3], const double c[3],
                      const double d[3]);

#endif
