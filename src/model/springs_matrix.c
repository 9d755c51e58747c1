/* The springs' Jacobian as a matrix: own blocks of particles, and the factored form
 * y = sum of (s I + w w^T)(p_a - p_b) that the linear solver multiplies by. */
#include "model/springs.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* alpha I + beta u u^T is minus the stiffness of one spring; both damping models beside it */
struct blocks {
    double alpha, beta; /* of -df/dx */
    double gamma, eta;  /* of -df/dv: gamma I + eta u u^T */
    double u[3];
};

static struct blocks blocks_of(const struct cs_spring_run *run, uint32_t n, const double *x,
                               uint32_t i) {
    struct blocks blocks = {0};
    double squared = DBL_MIN;
    for (uint32_t c = 0; c < 3; c++) {
        blocks.u[c] = x[c * n + run->b + i] - x[c * n + run->a + i];
        squared += blocks.u[c] * blocks.u[c];
    }
    const double inverse = 1 / sqrt(squared), ratio = run->length * inverse;
    for (uint32_t c = 0; c < 3; c++)
        blocks.u[c] *= inverse;
    blocks.alpha = run->stiffness * (1 - ratio);
    blocks.beta = run->stiffness * ratio;
    *(run->axial ? &blocks.eta : &blocks.gamma) = run->damping;
    return blocks;
}

/* blocks (6,n) of particle i += share (a I + b u u^T) */
static void add_block(double *blocks, uint32_t n, uint32_t i, double a, double b,
                      const double u[3]) {
    blocks[i] += a + b * u[0] * u[0];
    blocks[n + i] += b * u[0] * u[1];
    blocks[2 * n + i] += b * u[0] * u[2];
    blocks[3 * n + i] += a + b * u[1] * u[1];
    blocks[4 * n + i] += b * u[1] * u[2];
    blocks[5 * n + i] += a + b * u[2] * u[2];
}

void cs_springs_add_diagonal(const struct cs_springs *springs, uint32_t n, const double *x,
                             double *kxx, double *dvv) {
    for (uint32_t r = 0; r < springs->n_runs; r++) {
        const struct cs_spring_run *run = springs->runs + r;
        for (uint32_t i = 0; i < run->count; i++) {
            const struct blocks s = blocks_of(run, n, x, i);
            add_block(kxx, n, run->a + i, -s.alpha, -s.beta, s.u);
            add_block(kxx, n, run->b + i, -s.alpha, -s.beta, s.u);
            add_block(dvv, n, run->a + i, -s.gamma, -s.eta, s.u);
            add_block(dvv, n, run->b + i, -s.gamma, -s.eta, s.u);
        }
    }
}

void cs_springs_factor(const struct cs_springs *springs, uint32_t n, const double *x, double cd,
                       double ck, bool psd, double *factors) {
    for (uint32_t r = 0; r < springs->n_runs; r++) {
        const struct cs_spring_run *run = springs->runs + r;
        const double gamma = run->axial ? 0 : -cd * run->damping;
        const double eta = run->axial ? -cd * run->damping : 0;
        const double stiffness = -ck * run->stiffness;
        double *restrict s = factors + 4 * (size_t)run->first;
        double *restrict wx = s + run->count, *restrict wy = wx + run->count;
        double *restrict wz = wy + run->count;
        const double *a = x + run->a, *b = x + run->b;
        for (uint32_t i = 0; i < run->count; i++) {
            const double dx = b[i] - a[i], dy = b[n + i] - a[n + i];
            const double dz = b[2 * (size_t)n + i] - a[2 * (size_t)n + i];
            const double inverse = 1 / sqrt(dx * dx + dy * dy + dz * dz + DBL_MIN);
            const double ratio = run->length * inverse;
            const double alpha = stiffness * (1 - ratio);
            s[i] = gamma + (psd && alpha < 0 ? 0 : alpha);
            /* a compressed spring's axial stiffness is k: beta alone would exceed it */
            const double beta = stiffness * (psd && alpha < 0 ? 1 : ratio);
            const double w = sqrt(beta + eta) * inverse;
            wx[i] = w * dx;
            wy[i] = w * dy;
            wz[i] = w * dz;
        }
    }
}

void cs_springs_mul_add(const struct cs_springs *springs, uint32_t n, const double *factors,
                        const double *p, double *y) {
    enum { PIECE = 256 };
    double fx[PIECE], fy[PIECE], fz[PIECE];
    for (uint32_t r = 0; r < springs->n_runs; r++) {
        const struct cs_spring_run *run = springs->runs + r;
        for (uint32_t start = 0; start < run->count; start += PIECE) {
            const uint32_t left = run->count - start, count = left < PIECE ? left : PIECE;
            const double *restrict s = factors + 4 * (size_t)run->first + start;
            const double *restrict wx = s + run->count, *restrict wy = wx + run->count;
            const double *restrict wz = wy + run->count;
            const double *a = p + run->a + start, *b = p + run->b + start;
            for (uint32_t i = 0; i < count; i++) {
                const double dx = a[i] - b[i], dy = a[n + i] - b[n + i];
                const double dz = a[2 * (size_t)n + i] - b[2 * (size_t)n + i];
                /* w.(p_a - p_b), left to right: the sum order is part of the state hash */
                const double along = wx[i] * dx + wy[i] * dy + wz[i] * dz;
                fx[i] = s[i] * dx + along * wx[i];
                fy[i] = s[i] * dy + along * wy[i];
                fz[i] = s[i] * dz + along * wz[i];
            }
            double *to_a = y + run->a + start, *to_b = y + run->b + start;
            const double *rows[3] = {fx, fy, fz};
            for (uint32_t c = 0; c < 3; c++, to_a += n, to_b += n) {
                for (uint32_t i = 0; i < count; i++)
                    to_a[i] += rows[c][i];
                for (uint32_t i = 0; i < count; i++)
                    to_b[i] -= rows[c][i];
            }
        }
    }
}

void cs_springs_factor_diagonal(const struct cs_springs *springs, uint32_t n,
                                const double *factors, double *blocks) {
    for (uint32_t r = 0; r < springs->n_runs; r++) {
        const struct cs_spring_run *run = springs->runs + r;
        const double *s = factors + 4 * (size_t)run->first;
        const uint32_t count = run->count;
        for (uint32_t i = 0; i < count; i++) {
            const double w[3] = {s[count + i], s[2 * count + i], s[3 * count + i]};
            add_block(blocks, n, run->a + i, s[i], 1, w);
            add_block(blocks, n, run->b + i, s[i], 1, w);
        }
    }
}
