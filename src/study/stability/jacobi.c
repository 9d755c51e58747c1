#include "study/stability/jacobi.h"

#include <math.h>
#include <string.h>

enum { MOST_SWEEPS = 40 };

static double off_diagonal(uint32_t n, const double *a) {
    double sum = 0;
    for (uint32_t i = 0; i < n; i++)
        for (uint32_t j = 0; j < i; j++)
            sum += a[i * n + j] * a[i * n + j];
    return sum;
}

static double diagonal(uint32_t n, const double *a) {
    double sum = 0;
    for (uint32_t i = 0; i < n; i++)
        sum += a[i * n + i] * a[i * n + i];
    return sum;
}

/* turns entries k and l of a pair of lines by the rotation (c, s) */
static void turn(double *k, double *l, double c, double s) {
    const double old = *k;
    *k = c * old - s * *l;
    *l = s * old + c * *l;
}

/* the rotation of rows and columns p and q that makes a[p][q] zero */
static void rotate(uint32_t n, double *a, double *vectors, uint32_t p, uint32_t q) {
    const double apq = a[p * n + q];
    if (apq == 0)
        return;
    const double theta = (a[q * n + q] - a[p * n + p]) / (2 * apq);
    const double t = (theta < 0 ? -1 : 1) / (fabs(theta) + sqrt(theta * theta + 1));
    const double c = 1 / sqrt(t * t + 1), s = t * c;
    for (uint32_t i = 0; i < n; i++)
        turn(a + i * n + p, a + i * n + q, c, s);
    for (uint32_t i = 0; i < n; i++)
        turn(a + p * n + i, a + q * n + i, c, s);
    for (uint32_t i = 0; i < n; i++)
        turn(vectors + i * n + p, vectors + i * n + q, c, s);
}

void cs_jacobi(uint32_t n, double *a, double *vectors) {
    memset(vectors, 0, sizeof *vectors * n * n);
    for (uint32_t i = 0; i < n; i++)
        vectors[i * n + i] = 1;
    for (int sweep = 0; sweep < MOST_SWEEPS; sweep++) {
        if (!(off_diagonal(n, a) > 1e-28 * diagonal(n, a)))
            return;
        for (uint32_t p = 0; p + 1 < n; p++)
            for (uint32_t q = p + 1; q < n; q++)
                rotate(n, a, vectors, p, q);
    }
}
