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
 * matter. Signs: orient3d.h. */
bool cs_edge_crosses_triangle(const double edge[2][3], const double triangle[3][3]);

#endif
