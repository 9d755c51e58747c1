#include "model/vector.h"

#include <math.h>

enum { BLOCK = 4096, LANES = 8 };

static double lanes_sum(const double s[LANES]) {
    return ((s[0] + s[4]) + (s[2] + s[6])) + ((s[1] + s[5]) + (s[3] + s[7]));
}

static double dot_block(size_t n, const double *x, const double *y) {
    double lanes[LANES] = {0};
    size_t i = 0;
    for (; i + LANES <= n; i += LANES)
        for (size_t l = 0; l < LANES; l++)
            lanes[l] += x[i + l] * y[i + l];
    for (size_t l = 0; i < n; i++, l++)
        lanes[l] += x[i] * y[i];
    return lanes_sum(lanes);
}

double cs_vector_dot(size_t n, const double *x, const double *y) {
    double sum = 0;
    for (size_t start = 0; start < n; start += BLOCK)
        sum += dot_block(n - start < BLOCK ? n - start : BLOCK, x + start, y + start);
    return sum;
}

static double weighted_block(size_t n, const double *x, const double *w) {
    double lanes[LANES] = {0};
    size_t i = 0;
    for (; i + LANES <= n; i += LANES)
        for (size_t l = 0; l < LANES; l++)
            lanes[l] += x[i + l] * w[i + l] * (x[i + l] * w[i + l]);
    for (size_t l = 0; i < n; i++, l++)
        lanes[l] += x[i] * w[i] * (x[i] * w[i]);
    return lanes_sum(lanes);
}

static double weighted_square(size_t n, const double *x, const double *w) {
    double sum = 0;
    for (size_t start = 0; start < n; start += BLOCK)
        sum += weighted_block(n - start < BLOCK ? n - start : BLOCK, x + start, w + start);
    return sum;
}

static void linear_sum(size_t n, double a, const double *x, double b, const double *y,
                       double *z) {
    for (size_t i = 0; i < n; i++)
        z[i] = a * x[i] + b * y[i];
}

static double max_norm(size_t n, const double *x) {
    double largest = 0;
    for (size_t i = 0; i < n; i++)
        if (!(fabs(x[i]) <= largest) && largest == largest)
            largest = fabs(x[i]); /* a NaN is taken, and stays */
    return largest;
}

const struct cs_vector_kernels cs_vector_kernels = {
    .size = sizeof(struct cs_vector_kernels),
    .linear_sum = linear_sum,
    .dot = cs_vector_dot,
    .weighted_square = weighted_square,
    .max_norm = max_norm,
};
