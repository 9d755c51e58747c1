/* The springs' Jacobian as a matrix: own blocks of particles, and the factored form
 * y = sum of (s I + w w^T)(p_a - p_b) that the linear solver multiplies by. */
#include "model/springs.h"

#include "model/rows.h"

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
        blocks.u[c] = x[c * n + cs_spring_b(run, i)] - x[c * n + cs_spring_a(run, i)];
        squared += blocks.u[c] * blocks.u[c];
    }
    const double inverse = 1 / sqrt(squared), ratio = cs_spring_length(run, i) * inverse;
    for (uint32_t c = 0; c < 3; c++)
        blocks.u[c] *= inverse;
    blocks.alpha = cs_spring_stiffness(run, i) * (1 - ratio);
    blocks.beta = cs_spring_stiffness(run, i) * ratio;
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
            const uint32_t a = cs_spring_a(run, i), b = cs_spring_b(run, i);
            add_block(kxx, n, a, -s.alpha, -s.beta, s.u);
            add_block(kxx, n, b, -s.alpha, -s.beta, s.u);
            add_block(dvv, n, a, -s.gamma, -s.eta, s.u);
            add_block(dvv, n, b, -s.gamma, -s.eta, s.u);
        }
    }
}

/* factors of one piece; base: of its run's */
CS_INLINE void piece_factor(const struct piece *piece, struct ends e, double cd, double ck,
                            bool psd, const bool listed, double *base) {
    const struct cs_spring_run *run = piece->run;
    const double gamma = run->axial ? 0 : -cd * run->damping;
    const double eta = run->axial ? -cd * run->damping : 0;
    double *restrict s = base + piece->start;
    double *restrict wx = s + run->count, *restrict wy = wx + run->count;
    double *restrict wz = wy + run->count;
    const double L = run->length, k = run->stiffness;
    const size_t count = piece->count;
    for (size_t i = 0; i < count; i++) {
        const double length = listed ? piece->lengths[i] : L;
        const double stiffness = -ck * (listed ? piece->stiffnesses[i] : k);
        const double dx = e.bx[i] - e.ax[i], dy = e.by[i] - e.ay[i], dz = e.bz[i] - e.az[i];
        const double inverse = 1 / sqrt(dx * dx + dy * dy + dz * dz + DBL_MIN);
        const double ratio = length * inverse;
        /* a compressed spring's axial stiffness is k: beta alone would exceed it */
        const bool clamped = psd && ratio > 1;
        s[i] = gamma + (clamped ? 0 : stiffness * (1 - ratio));
        const double w = sqrt(stiffness * (clamped ? 1 : ratio) + eta) * inverse;
        wx[i] = w * dx;
        wy[i] = w * dy;
        wz[i] = w * dz;
    }
}

CS_CLONES void cs_springs_factor(const struct cs_springs *springs, uint32_t n, const double *x,
                                 double cd, double ck, bool psd, double *factors) {
    struct gathered places;
    for (uint32_t r = 0; r < springs->n_runs; r++) {
        const struct cs_spring_run *run = springs->runs + r;
        double *base = factors + 4 * (size_t)run->first;
        for (uint32_t start = 0; start < run->count; start += PIECE) {
            const struct piece piece = piece_of(run, start);
            const struct ends e = ends_of(&piece, x, n, &places);
            if (run->ends)
                piece_factor(&piece, e, cd, ck, psd, true, base);
            else
                piece_factor(&piece, e, cd, ck, psd, false, base);
        }
    }
}

CS_CLONES void cs_springs_mul_add(const struct cs_springs *springs, uint32_t n,
                                  const double *factors, const double *p, double *y) {
    double fx[PIECE], fy[PIECE], fz[PIECE];
    struct gathered places;
    for (uint32_t r = 0; r < springs->n_runs; r++) {
        const struct cs_spring_run *run = springs->runs + r;
        for (uint32_t start = 0; start < run->count; start += PIECE) {
            const struct piece piece = piece_of(run, start);
            const double *s = factors + 4 * (size_t)run->first + start;
            const double *wx = s + run->count, *wy = wx + run->count, *wz = wy + run->count;
            const struct ends e = ends_of(&piece, p, n, &places);
            for (size_t i = 0; i < piece.count; i++) {
                const double dx = e.ax[i] - e.bx[i], dy = e.ay[i] - e.by[i];
                const double dz = e.az[i] - e.bz[i];
                /* w.(p_a - p_b), left to right: the sum order is part of the state hash */
                const double along = wx[i] * dx + wy[i] * dy + wz[i] * dz;
                fx[i] = s[i] * dx + along * wx[i];
                fy[i] = s[i] * dy + along * wy[i];
                fz[i] = s[i] * dz + along * wz[i];
            }
            scatter(&piece, fx, fy, fz, n, y);
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
            add_block(blocks, n, cs_spring_a(run, i), s[i], 1, w);
            add_block(blocks, n, cs_spring_b(run, i), s[i], 1, w);
        }
    }
}
