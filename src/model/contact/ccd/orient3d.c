/* Signs of determinants: an error-bounded test in double, then exact expansions. */
#include "model/contact/ccd/orient3d.h"

#include "base/vec3.h"

#include <float.h>

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
static void add(struct expansion *sum, double value) {
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
    add(sum, sign * lost);
    add(sum, sign * product);
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

/* The determinant falls by the move times (a - c) x (b - c). e, e^2, e^3 are of decreasing
 * order, so the first component that is not 0 decides. */
int cs_orient3d_moved(const double a[3], const double b[3], const double c[3],
                      const double d[3]) {
    int sign = cs_orient3d(a, b, c, d);
    // the determinant falls by the move times (a - c) x (b - c)
    for (int i = 0; i < 3 && !sign; i++)
        sign = -cross_sign(a, b, c, i);
    return sign;
}
