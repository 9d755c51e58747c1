/* orient3d.h - on which side of a plane a point lies, without rounding.
 *
 * The signs are those of the exact determinants of the given doubles: taken in double where the
 * result is above its error bound, else again in expansions, sums of doubles that do not
 * overlap, which hold sums and products of doubles exactly (Shewchuk 1997; two-sum of Knuth;
 * two-product of Dekker 1971 with Veltkamp's split, since a fused multiply-add is not
 * everywhere). Exact while no product of three differences leaves the range of doubles. */
#ifndef CS_ORIENT3D_H
#define CS_ORIENT3D_H

/* The sign, -1, 0 or 1, of the determinant of the rows a - d, b - d, c - d: 1 where d lies
 * below the plane through a, b and c, seen from where these go counter-clockwise. 0 where any
 * of it is not a number. */
int cs_orient3d(const double a[3], const double b[3], const double c[3], const double d[3]);

/* The same where d is moved by (e, e^2, e^3), with e above 0 and below every number: 0 only
 * where a, b and c lie on a line. */
int cs_orient3d_moved(const double a[3], const double b[3], const double c[3],
                      const double d[3]);

#endif
