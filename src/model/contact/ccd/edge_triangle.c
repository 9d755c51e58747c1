/* Edge against triangle by the signs of five determinants.
 *
 * The ends p, q are on both sides of the plane of a, b, c if orient(a, b, c, p) and orient(a,
 * b, c, q) differ. The line then meets the triangle if orient(a, b, p, q), orient(b, c, p, q)
 * and orient(c, a, p, q) have one sign. Two cheap certain tests come first: exact determinants
 * of coplanar points take far longer. */
#include "model/contact/ccd/edge_triangle.h"

#include "base/vec3.h"

#include <float.h>

/* Returns whether the axis-aligned boxes are disjoint. Comparisons are exact. */
static bool has_gap(const double edge[2][3], const double triangle[3][3]) {
    for (int c = 0; c < 3; c++) {
        const double a = triangle[0][c], b = triangle[1][c], d = triangle[2][c];
        if (cs_fmax(edge[0][c], edge[1][c]) < cs_fmin(cs_fmin(a, b), d) ||
            cs_fmin(edge[0][c], edge[1][c]) > cs_fmax(cs_fmax(a, b), d))
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
        size = cs_fmax(size, fabs(x) + fabs(y) + fabs(z));
    }
    const double margin = 8 * DBL_EPSILON * size;
    return cs_fmin(at[0], at[1]) > cs_fmax(cs_fmax(at[2], at[3]), at[4]) + margin ||
           cs_fmax(at[0], at[1]) < cs_fmin(cs_fmin(at[2], at[3]), at[4]) - margin;
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

/* Signs of determinants: an error-bounded test in double, then exact expansions. */

/* Largest number of terms. A difference is a sum of two doubles; a product of three doubles is
 * one of four; a determinant has six products of three differences, each of 2^3 terms. */
enum { PARTS_MAX = 6 * 8 * 4 };

/* Bound of the rounding error of a determinant over the sum of its magnitudes: (7 + 56 u) u
 * with u = 2^-53 (Shewchuk 1997, sec. 4.3). */
#define UNIT        (DBL_EPSILON / 2)
#define ORIENT_NEAR ((7 + 56 * UNIT) * UNIT)

/* Exact sum of doubles that do not overlap, in ascending order of magnitude, none of them 0. */
struct expansion {
    int n;
    double parts[PARTS_MAX];
};

/* a + b rounded, and the exact rounding error in *lost (Knuth's two-sum, any order of a, b) */
static double two_sum(double a, double b, double *lost) {
    const double sum = a + b, b_kept = sum - a, a_kept = sum - b_kept;
    *lost = (a - a_kept) + (b - b_kept);
    return sum;
}

/* the upper 26 bits of a (Veltkamp's split with 2^27 + 1) */
static double upper(double a) {
    const double c = 134217729 * a; // 2^27 + 1
    return c - (c - a);
}

/* a b rounded, and the exact rounding error in *lost (Dekker 1971) */
static double two_product(double a, double b, double *lost) {
    const double product = a * b, ah = upper(a), bh = upper(b), al = a - ah, bl = b - bh;
    *lost = ((ah * bh - product) + ah * bl + al * bh) + al * bl;
    return product;
}

/* Adds a double exactly: Shewchuk's GROW-EXPANSION, which keeps the order and the terms from
 * overlapping. Zeros are dropped. */
static void add_exactly(struct expansion *sum, double value) {
    int n = 0;
    for (int k = 0; k < sum->n; k++) {
        double lost;
        value = two_sum(value, sum->parts[k], &lost);
        if (lost != 0)
            sum->parts[n++] = lost;
    }
    if (value != 0)
        sum->parts[n++] = value;
    sum->n = n;
}

/* sum += sign a b, exactly */
static void add_product(struct expansion *sum, double a, double b, double sign) {
    double lost;
    if (a == 0 || b == 0)
        return;
    const double product = two_product(a, b, &lost);
    add_exactly(sum, sign * lost);
    add_exactly(sum, sign * product);
}

/* sum += sign a b c, exactly: both parts of a b times c */
static void add_product3(struct expansion *sum, double a, double b, double c, double sign) {
    double lost;
    if (a == 0 || b == 0)
        return;
    const double product = two_product(a, b, &lost);
    add_product(sum, lost, c, sign);
    add_product(sum, product, c, sign);
}

/* the largest part has the sign of the sum */
static int sign_of(double value) {
    return (value > 0) - (value < 0);
}

/* the largest term has the sign of the sum */
static int sign_of_sum(const struct expansion *sum) {
    return sum->n ? sign_of(sum->parts[sum->n - 1]) : 0;
}

/* a - b as two doubles: the rounded difference and its error */
static void subtract(const double a[3], const double b[3], double out[3][2]) {
    for (int k = 0; k < 3; k++)
        out[k][0] = two_sum(a[k], -b[k], &out[k][1]);
}

/* Sign of the determinant in expansions, all 6 x 8 products of parts. */
static int orient_exactly(const double a[3], const double b[3], const double c[3],
                          const double d[3]) {
    struct expansion sum = {.n = 0};
    double u[3][2], v[3][2], w[3][2];
    subtract(a, d, u);
    subtract(b, d, v);
    subtract(c, d, w);
    for (int i = 0; i < 3; i++)
        for (int bits = 0; bits < 8; bits++) {
            const int j = (i + 1) % 3, k = (i + 2) % 3;
            const int p = bits & 1, q = bits >> 1 & 1, r = bits >> 2;
            add_product3(&sum, u[i][p], v[j][q], w[k][r], 1);
            add_product3(&sum, u[i][p], v[k][q], w[j][r], -1);
        }
    return sign_of_sum(&sum);
}

int cs_orient3d(const double a[3], const double b[3], const double c[3], const double d[3]) {
    double u[3], v[3], w[3], value = 0, size = 0;
    for (int k = 0; k < 3; k++) {
        u[k] = a[k] - d[k];
        v[k] = b[k] - d[k];
        w[k] = c[k] - d[k];
    }
    for (int i = 0; i < 3; i++) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        const double first = v[j] * w[k], second = v[k] * w[j];
        value += u[i] * (first - second);
        size += fabs(u[i]) * (fabs(first) + fabs(second));
    }
    if (fabs(value) > ORIENT_NEAR * size)
        return sign_of(value);
    // all products are 0, or something is not a number
    if (!(size > 0))
        return 0;
    return orient_exactly(a, b, c, d);
}

/* Sign of component i of (a - c) x (b - c), exactly. */
static int cross_sign(const double a[3], const double b[3], const double c[3], int i) {
    struct expansion sum = {.n = 0};
    double u[3][2], v[3][2];
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    subtract(a, c, u);
    subtract(b, c, v);
    for (int bits = 0; bits < 4; bits++) {
        add_product(&sum, u[j][bits & 1], v[k][bits >> 1], 1);
        add_product(&sum, u[k][bits & 1], v[j][bits >> 1], -1);
    }
    return sign_of_sum(&sum);
}

/* cs_orient3d with d moved by (e, e^2, e^3) for an infinitesimal e > 0: 0 only if a, b and c
 * are collinear. The determinant falls by the move times (a - c) x (b - c). e, e^2, e^3 are of
 * decreasing order, so the first component that is not 0 decides. */
static int orient3d_moved(const double a[3], const double b[3], const double c[3],
                          const double d[3]) {
    int sign = cs_orient3d(a, b, c, d);
    // the determinant falls by the move times (a - c) x (b - c)
    for (int i = 0; i < 3 && !sign; i++)
        sign = -cross_sign(a, b, c, i);
    return sign;
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
    const int side = orient3d_moved(a, b, p, q);
    return side == orient3d_moved(b, c, p, q) && side == orient3d_moved(c, a, p, q);
}
