/* Edge against triangle by the signs of five determinants.
 *
 * The ends p, q are on both sides of the plane of a, b, c if orient(a, b, c, p) and orient(a,
 * b, c, q) differ. The line then meets the triangle if orient(a, b, p, q), orient(b, c, p, q)
 * and orient(c, a, p, q) have one sign. Two cheap certain tests come first: exact determinants
 * of coplanar points take far longer. */
#include "model/contact/ccd/edge_triangle.h"

#include "base/vec3.h"
#include "model/contact/ccd/orient3d.h"

#include <float.h>

static double larger(double a, double b) {
    return a > b ? a : b;
}
static double min_of(double a, double b) {
    return a < b ? a : b;
}

/* Returns whether the axis-aligned boxes are disjoint. Comparisons are exact. */
static bool has_gap(const double edge[2][3], const double triangle[3][3]) {
    for (int c = 0; c < 3; c++) {
        const double a = triangle[0][c], b = triangle[1][c], d = triangle[2][c];
        if (larger(edge[0][c], edge[1][c]) < min_of(min_of(a, b), d) ||
            min_of(edge[0][c], edge[1][c]) > larger(larger(a, b), d))
            return true;
    }
    return false;
}

/* Returns whether the projections on an axis are certainly disjoint. Any axis may be used,
 * rounded or not. `size` bounds the sum of magnitudes of a projection; 8 epsilon of it exceeds
 * the rounding of three products and two sums. */
static bool are_separated(const double edge[2][3], const double triangle[3][3],
                          const double axis[3]) {
    double at[5], size = 0;
    for (int k = 0; k < 5; k++) {
        const double *p = k < 2 ? edge[k] : triangle[k - 2], *from = triangle[0];
        const double x = axis[0] * (p[0] - from[0]), y = axis[1] * (p[1] - from[1]);
        const double z = axis[2] * (p[2] - from[2]);
        at[k] = x + y + z;
        size = larger(size, fabs(x) + fabs(y) + fabs(z));
    }
    const double margin = 8 * DBL_EPSILON * size;
    return min_of(at[0], at[1]) > larger(larger(at[2], at[3]), at[4]) + margin ||
           larger(at[0], at[1]) < min_of(min_of(at[2], at[3]), at[4]) - margin;
}

/* Tests the axes at right angles to the triangle's sides and to the edge, within the plane. In
 * a flat body nothing else gives a certain answer for edges beside a triangle, because all
 * determinants of coplanar points are 0 but for rounding. */
static bool are_on_same_side(const double edge[2][3], const double triangle[3][3]) {
    double sides[3][3], along[3], normal[3], axis[3];
    for (int k = 0; k < 3; k++)
        for (int c = 0; c < 3; c++)
            sides[k][c] = triangle[(k + 1) % 3][c] - triangle[k][c];
    cs_vec3_cross(sides[0], sides[1], normal);
    for (int k = 0; k < 3; k++) {
        cs_vec3_cross(normal, sides[k], axis);
        if (are_separated(edge, triangle, axis))
            return true;
    }
    for (int c = 0; c < 3; c++)
        along[c] = edge[1][c] - edge[0][c];
    cs_vec3_cross(normal, along, axis);
    return are_separated(edge, triangle, axis);
}

/* A product of signs >= 0 rejects ends on one side, and ends in the plane, whose sign is 0. The
 * last three signs use the moved end, so that none of them is 0 for a triangle with area. */
bool cs_edge_crosses_triangle(const double edge[2][3], const double triangle[3][3]) {
    if (has_gap(edge, triangle) || are_on_same_side(edge, triangle))
        return false;
    const double *a = triangle[0], *b = triangle[1], *c = triangle[2];
    const double *p = edge[0], *q = edge[1];
    if (cs_orient3d(a, b, c, p) * cs_orient3d(a, b, c, q) >= 0)
        return false;
    const int side = cs_orient3d_moved(a, b, p, q);
    return side == cs_orient3d_moved(b, c, p, q) && side == cs_orient3d_moved(c, a, p, q);
}
