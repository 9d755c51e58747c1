/* shape_rotation.c - the rotation nearest to a 3x3 matrix, by Horn's quaternion (Horn 1987,
 * sec. 4) and Jacobi's eigenvalue method; in + - * / and sqrt alone.
 *
 * trace(r^T a), which the nearest rotation r maximises, is the quadratic form q^T m q of the
 * unit quaternion q of r, with the symmetric 4x4 matrix m of horn_matrix. Its maximum is the
 * largest eigenvalue of m, at the eigenvector of it. */
#include "shape_rotation.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* Most sweeps of Jacobi's method, and its largest matrix. It converges quadratically; the limit
 * ends it for NaN too. */
enum { SWEEPS = 12, LARGEST = 4 };
/* Relative to the size: eigenvalues this near count as equal. */
#define SAME 1e-12
/* Relative to the largest eigenvalue: a direction below it counts as flat. */
#define FLAT 1e-10

/* Sum of |a| over the diagonal, or over the rest of a matrix (n,n). */
static double size_of(int n, const double *a, bool diagonal) {
    double sum = 0;
    for (int i = 0; i < n; i++)
        for (int j = 0; j < n; j++)
            sum += (i == j) == diagonal ? fabs(a[n * i + j]) : 0;
    return sum;
}

/* Rotate columns p and q of m, or rows, by the angle with cosine c and sine s. */
static void turn_columns(int n, double *m, int p, int q, double c, double s) {
    for (int i = 0; i < n; i++) {
        const double left = m[n * i + p], right = m[n * i + q];
        m[n * i + p] = c * left - s * right;
        m[n * i + q] = s * left + c * right;
    }
}
static void turn_rows(int n, double *m, int p, int q, double c, double s) {
    for (int j = 0; j < n; j++) {
        const double upper = m[n * p + j], lower = m[n * q + j];
        m[n * p + j] = c * upper - s * lower;
        m[n * q + j] = s * upper + c * lower;
    }
}

/* Makes a[p][q] zero by the smaller of the two possible rotations (t = tan, |t| <= 1), and
 * applies it to the eigenvectors (Golub, Van Loan 2013, sec. 8.5). */
static void jacobi_rotate(int n, double *a, double *vectors, int p, int q) {
    if (a[n * p + q] == 0)
        return;
    const double theta = (a[n * q + q] - a[n * p + p]) / (2 * a[n * p + q]);
    const double t = (theta < 0 ? -1 : 1) / (fabs(theta) + sqrt(theta * theta + 1));
    const double c = 1 / sqrt(t * t + 1), s = t * c;
    turn_columns(n, a, p, q, c, s);
    turn_rows(n, a, p, q, c, s);
    turn_columns(n, vectors, p, q, c, s);
    a[n * p + q] = a[n * q + p] = 0;
}

void shape_eigen(int n, double *a, double *vectors) {
    for (int i = 0; i < n; i++)
        for (int j = 0; j < n; j++)
            vectors[n * i + j] = i == j;
    for (int sweep = 0; sweep < SWEEPS; sweep++) {
        if (size_of(n, a, false) <= DBL_EPSILON / 16 * size_of(n, a, true))
            return;
        for (int p = 0; p < n; p++)
            for (int q = p + 1; q < n; q++)
                jacobi_rotate(n, a, vectors, p, q);
    }
}

void shape_rotation_of(const double quaternion[4], double r[9]) {
    const double x = quaternion[0], y = quaternion[1], z = quaternion[2], w = quaternion[3];
    const double turned[9] = {
        1 - 2 * (y * y + z * z), 2 * (x * y - w * z),     2 * (x * z + w * y),
        2 * (x * y + w * z),     1 - 2 * (x * x + z * z), 2 * (y * z - w * x),
        2 * (x * z - w * y),     2 * (y * z + w * x),     1 - 2 * (x * x + y * y)};
    memcpy(r, turned, sizeof turned);
}

/* Horn's matrix: its quadratic form at a unit quaternion is trace(r^T a). */
static void horn_matrix(const double a[9], double m[16]) {
    const double trace = a[0] + a[4] + a[8];
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++)
            m[4 * i + j] = a[3 * i + j] + a[3 * j + i] - (i == j ? trace : 0);
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        m[4 * i + 3] = m[12 + i] = a[3 * k + j] - a[3 * j + k];
    }
    m[15] = trace;
}

/* last = the normalised projection of the last quaternion on the eigenvectors of the largest
 * eigenvalue. If it is almost orthogonal to them, one of them. */
static void choose_eigenvector(const double m[16], const double vectors[16], double same,
                               double last[4]) {
    int best = 0;
    double shadow[4] = {0}, squared = 0;
    for (int k = 1; k < LARGEST; k++)
        if (m[5 * k] > m[5 * best])
            best = k;
    for (int k = 0; k < LARGEST; k++) {
        double along = 0;
        if (m[5 * k] < m[5 * best] - same)
            continue;
        for (int i = 0; i < LARGEST; i++)
            along += vectors[4 * i + k] * last[i];
        for (int i = 0; i < LARGEST; i++)
            shadow[i] += along * vectors[4 * i + k];
    }
    for (int i = 0; i < LARGEST; i++)
        squared += shadow[i] * shadow[i];
    // after a rotation by nearly 180 degrees the projection is only rounding
    const double length = sqrt(squared);
    for (int i = 0; i < LARGEST; i++)
        last[i] = length > 1e-6 ? shadow[i] / length : vectors[4 * i + best];
}

void shape_rotation(const double a[9], double size, double last[4], double r[9]) {
    double m[16], vectors[16];
    horn_matrix(a, m);
    shape_eigen(LARGEST, m, vectors);
    choose_eigenvector(m, vectors, SAME * (size + size_of(LARGEST, m, true)), last);
    shape_rotation_of(last, r);
}

/* Cofactor of a[i][j], with its sign from cyclic indices. */
static double cofactor(const double a[9], int i, int j) {
    const int p = (i + 1) % 3, q = (i + 2) % 3, s = (j + 1) % 3, t = (j + 2) % 3;
    return a[3 * p + s] * a[3 * q + t] - a[3 * p + t] * a[3 * q + s];
}

double shape_determinant(const double a[9]) {
    return a[0] * cofactor(a, 0, 0) + a[1] * cofactor(a, 0, 1) + a[2] * cofactor(a, 0, 2);
}

void shape_product(const double a[9], const double b[9], double out[9]) {
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            out[3 * i + j] =
                a[3 * i] * b[j] + a[3 * i + 1] * b[3 + j] + a[3 * i + 2] * b[6 + j];
}

bool shape_inverse_transposed(const double a[9], double out[9]) {
    const double determinant = shape_determinant(a);
    if (determinant == 0)
        return false;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            out[3 * i + j] = cofactor(a, i, j) / determinant;
    return true;
}

void shape_pseudo_inverse(const double a[9], double inverse[9], double null[9]) {
    double values[9], vectors[9], largest = 0;
    memcpy(values, a, sizeof values);
    shape_eigen(3, values, vectors);
    for (int k = 0; k < 3; k++)
        largest = values[4 * k] > largest ? values[4 * k] : largest;
    memset(inverse, 0, sizeof values);
    memset(null, 0, sizeof values);
    for (int k = 0; k < 3; k++) {
        const bool is_flat = values[4 * k] <= FLAT * largest;
        const double weight = is_flat ? 1 : 1 / values[4 * k];
        for (int i = 0; i < 3; i++)
            for (int j = 0; j < 3; j++)
                (is_flat ? null : inverse)[3 * i + j] +=
                    weight * vectors[3 * i + k] * vectors[3 * j + k];
    }
}

double shape_cube_root(double d) {
    enum { EIGHTHS = 400, STEPS = 8 };
    double scale = 1, root = 1;
    for (int k = 0; k < EIGHTHS && d > 8; k++, scale *= 2)
        d /= 8;
    for (int k = 0; k < EIGHTHS && d < 1; k++, scale /= 2)
        d *= 8;
    // Newton from 1 on 1..8
    for (int k = 0; k < STEPS; k++)
        root -= (root - d / (root * root)) / 3;
    return scale * root;
}
