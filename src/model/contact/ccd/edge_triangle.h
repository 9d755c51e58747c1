/* edge_triangle.h - tests whether an edge pierces a triangle: exact, with every degenerate case
 * defined. */
#ifndef CS_EDGE_TRIANGLE_H
#define CS_EDGE_TRIANGLE_H

#include <stdbool.h>

/* Returns true if the ends of the edge lie strictly on both sides of the triangle's plane and
 * the edge passes through the triangle between them. Touching is not piercing: an end in the
 * plane is on no side, so that neither edges in the plane of a triangle nor vertices on it
 * count.
 *
 * If an edge passes exactly through a side or vertex of triangles, its second end counts as
 * moved by (e, e^2, e^3) with an infinitesimal e > 0. It then pierces exactly one of the
 * triangles around the vertex or beside the side where the surface continues, and none or both
 * of a fold. Triangles without area and NaN are never pierced. The order of vertices does not
 * matter. Signs: edge_triangle.h. */
bool cs_edge_crosses_triangle(const double edge[2][3], const double triangle[3][3]);

/* Side of a plane on which a point lies, without rounding.
 *
 * The signs are those of the exact determinants of the given doubles. The determinant is taken
 * in double first, and accepted if it exceeds its error bound. Otherwise it is taken again in
 * expansions, sums of doubles that do not overlap, which hold sums and products of doubles
 * exactly (Shewchuk 1997; two-sum of Knuth; two-product of Dekker 1971 with Veltkamp's split,
 * since a fused multiply-add is not available everywhere). Exact as long as no product of three
 * differences leaves the range of doubles. */

/* Sign, -1, 0 or 1, of the determinant of the rows a - d, b - d, c - d: 1 if d lies below the
 * plane through a, b and c, seen from where these go counter-clockwise. 0 if a number is NaN.
 */
int cs_orient3d(const double a[3], const double b[3], const double c[3], const double d[3]);

#endif
