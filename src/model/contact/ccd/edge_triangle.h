/* edge_triangle.h - whether an edge goes through a triangle: exact, with every degenerate case
 * defined. */
#ifndef CS_EDGE_TRIANGLE_H
#define CS_EDGE_TRIANGLE_H

#include <stdbool.h>

/* True where the ends of the edge lie strictly on both sides of the triangle's plane, and the
 * edge passes between them through the triangle. To touch is not to pierce: an end in the plane
 * is on no side, so that neither edges in a triangle's plane nor corners on it count.
 *
 * An edge that passes exactly through a side or a corner of triangles is taken as if its second
 * end were moved by (e, e^2, e^3), with e above 0 and below every number. So it pierces exactly
 * one triangle of those around the corner or beside the side where the surface goes on, and
 * none or both of a fold. Triangles without area, and what is not a number, are never pierced.
 * The order of corners does not matter. Signs as in orient3d.h. */
bool cs_edge_crosses_triangle(const double edge[2][3], const double triangle[3][3]);

#endif
