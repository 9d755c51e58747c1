/* The springs' Jacobian as a matrix: diagonal blocks, and the factored form
 * y = sum of (s I + w w^T)(p_a - p_b) that the linear solver multiplies by. */
#include "model/spring/springs.h"

#include "base/pool.h"
#include "model/spring/rows.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* symmetric blocks of one piece's springs, a row each: xx, xy, xz, yy, yz, zz */
struct blocks {
    double rows[6][PIECE];
};

/* a I + b u u^T */
CS_INLINE void set_block(struct blocks *blocks, size_t i, double a, double b,
                         const struct difference u) {
    blocks->rows[0][i] = a + b * u.x * u.x;
    blocks->rows[1][i] = b * u.x * u.y;
    blocks->rows[2][i] = b * u.x * u.z;
    blocks->rows[3][i] = a + b * u.y * u.y;
    blocks->rows[4][i] = b * u.y * u.z;
    blocks->rows[5][i] = a + b * u.z * u.z;
}

/* Adds the blocks of a piece to both ends, sums (6,n). The second ends come first: a particle
 * in the middle of a grid's row meets the spring on its left before the one on its right, as
 * springs come one by one. */
CS_INLINE void add_blocks(const struct piece *piece, const struct blocks *blocks, size_t n,
                          double *sums) {
    double *a = sums + piece->run->a, *b = sums + piece->run->b;
    if (!piece->run->ends) {
        for (size_t c = 0; c < 6; c++) {
            add_row(piece->count, blocks->rows[c], b + piece->start + c * n);
            add_row(piece->count, blocks->rows[c], a + piece->start + c * n);
        }
        return;
    }
    const uint32_t *ends = piece->run->ends + 2 * (size_t)piece->start;
    for (size_t i = 0; i < piece->count; i++)
        for (size_t c = 0; c < 6; c++) {
            a[c * n + ends[2 * i]] += blocks->rows[c][i];
            b[c * n + ends[2 * i + 1]] += blocks->rows[c][i];
        }
}

/* Diagonal blocks of one piece: of df/dx; of df/dv only with axial dampers, which turn with the
 * spring. */
CS_INLINE void piece_diagonal(const struct piece *piece, struct ends e, const bool listed,
                              const bool axial, struct blocks *stiff, struct blocks *damp) {
    const struct cs_spring_run *run = piece->run;
    const double L = run->length, k = run->stiffness, damping = run->damping;
    const size_t count = piece->count;
    for (size_t i = 0; i < count; i++) {
        const double length = listed ? piece->lengths[i] : L;
        const double stiffness = listed ? piece->stiffnesses[i] : k;
        const struct difference d = across(e, i, listed);
        const double inverse = 1 / sqrt(d.x * d.x + d.y * d.y + d.z * d.z + DBL_MIN);
        const double ratio = length * inverse;
        const struct difference u = {d.x * inverse, d.y * inverse, d.z * inverse};
        set_block(stiff, i, -(stiffness * (1 - ratio)), -(stiffness * ratio), u);
        if (axial)
            set_block(damp, i, 0, -damping, u);
    }
}

/* relative dampers are the same in every direction */
CS_INLINE void add_relative(const struct piece *piece, size_t n, double *dvv) {
    const double damping = piece->run->damping;
    for (size_t c = 0; c < 6; c += c ? 2 : 3)
        for (uint32_t i = piece->start; i < piece->start + piece->count; i++) {
            dvv[c * n + cs_spring_b(piece->run, i)] -= damping;
            dvv[c * n + cs_spring_a(piece->run, i)] -= damping;
        }
}

CS_INLINE void run_diagonal(const struct cs_spring_run *run, uint32_t n, const double *x,
                            const bool listed, double *kxx, double *dvv) {
    struct gathered places;
    struct blocks stiff, damp;
    for (uint32_t start = 0; start < run->count; start += PIECE) {
        const struct piece piece = piece_of(run, start);
        const struct ends e = ends_of(&piece, x, n, false, &places);
        if (run->axial && run->damping != 0) {
            piece_diagonal(&piece, e, listed, true, &stiff, &damp);
            add_blocks(&piece, &damp, n, dvv);
        } else
            piece_diagonal(&piece, e, listed, false, &stiff, &damp);
        add_blocks(&piece, &stiff, n, kxx);
        if (!run->axial && run->damping != 0)
            add_relative(&piece, n, dvv);
    }
}

CS_CLONES void cs_springs_add_diagonal(const struct cs_springs *springs, uint32_t n,
                                       const double *x, double *kxx, double *dvv) {
    for (uint32_t r = 0; r < springs->n_runs; r++) {
        const struct cs_spring_run *run = springs->runs + r;
        if (run->ends)
            run_diagonal(run, n, x, true, kxx, dvv);
        else
            run_diagonal(run, n, x, false, kxx, dvv);
    }
}

/* factors of one piece, where they lie in the run's */
CS_INLINE void factor_of(const struct piece *piece, struct ends e,
                         const struct cs_matrix *matrix, const bool listed, double *base) {
    const struct cs_spring_run *run = piece->run;
    const double cd = matrix->cd, ck = matrix->ck;
    const bool psd = matrix->psd;
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
        const struct difference d = across(e, i, listed);
        const double inverse = 1 / sqrt(d.x * d.x + d.y * d.y + d.z * d.z + DBL_MIN);
        const double ratio = length * inverse;
        /* a compressed spring's axial stiffness is k: beta alone would exceed it */
        const bool clamped = psd && ratio > 1;
        s[i] = gamma + (clamped ? 0 : stiffness * (1 - ratio));
        const double w = sqrt(stiffness * (clamped ? 1 : ratio) + eta) * inverse;
        wx[i] = w * d.x;
        wy[i] = w * d.y;
        wz[i] = w * d.z;
    }
}

struct factoring {
    const struct cs_springs *springs;
    size_t n;
    const struct cs_matrix *matrix;
    double *factors;
};

/* springs [begin, end) of a run, from a whole number of pieces on */
CS_INLINE void factor_springs(const struct factoring *made, const struct cs_spring_run *run,
                              uint32_t begin, uint32_t end) {
    struct gathered places;
    double *base = made->factors + 4 * (size_t)run->first;
    for (uint32_t start = begin; start < end; start += PIECE) {
        const struct piece piece = piece_of(run, start);
        const struct ends e = ends_of(&piece, made->matrix->x, made->n, false, &places);
        if (run->ends)
            factor_of(&piece, e, made->matrix, true, base);
        else
            factor_of(&piece, e, made->matrix, false, base);
    }
}

CS_CLONES static void factor_runs(void *arg, uint32_t block) {
    const struct factoring *made = arg;
    const struct cs_springs *springs = made->springs;
    for (uint32_t r = RUNS * block; r < springs->n_runs && r < RUNS * (block + 1); r++)
        if (!springs->waits || !springs->runs[r].ends)
            factor_springs(made, springs->runs + r, 0, springs->runs[r].count);
}

CS_CLONES static void factor_lot(void *arg, uint32_t number) {
    const struct factoring *made = arg;
    const struct cs_lot *lot = made->springs->lots + number;
    factor_springs(made, made->springs->runs + lot->run, lot->begin, lot->end);
}

void cs_springs_factor(const struct cs_springs *springs, uint32_t n,
                       const struct cs_matrix *matrix, double *factors) {
    struct factoring made = {springs, n, matrix, factors};
    cs_pool_run((springs->n_runs + RUNS - 1) / RUNS, factor_runs, &made);
    cs_pool_run(springs->n_lots, factor_lot, &made);
}

CS_INLINE void mul_listed_or_not(const struct job *job, const struct piece *piece,
                                 const bool listed, double *restrict fx, double *restrict fy,
                                 double *restrict fz) {
    struct gathered places;
    const struct cs_spring_run *run = piece->run;
    const double *s = job->factors + 4 * (size_t)run->first + piece->start;
    const double *wx = s + run->count, *wy = wx + run->count, *wz = wy + run->count;
    const struct ends e = ends_of(piece, job->at.x, job->n, true, &places);
    for (size_t i = 0; i < piece->count; i++) {
        const struct difference d = across(e, i, listed);
        /* w.(p_a - p_b), left to right: the sum order is part of the state hash */
        const double along = wx[i] * d.x + wy[i] * d.y + wz[i] * d.z;
        fx[i] = s[i] * d.x + along * wx[i];
        fy[i] = s[i] * d.y + along * wy[i];
        fz[i] = s[i] * d.z + along * wz[i];
    }
}

CS_INLINE void mul_piece(const struct job *job, const struct piece *piece, double *restrict fx,
                         double *restrict fy, double *restrict fz) {
    if (piece->run->ends)
        mul_listed_or_not(job, piece, true, fx, fy, fz);
    else
        mul_listed_or_not(job, piece, false, fx, fy, fz);
}

CS_INLINE bool asks_always(const struct job *job, const struct cs_spring_run *run) {
    (void)job, (void)run;
    return true;
}

CS_CLONES static void wait_mul_lot(void *job, uint32_t lot) {
    wait_lot(job, ((const struct job *)job)->springs->lots + lot, asks_always, mul_piece);
}

CS_CLONES static void mul_add_block(void *arg, uint32_t number) {
    const struct job *job = arg;
    const struct cs_block block = cs_springs_block(job->springs, (uint32_t)job->n, number);
    add_runs(job, &block, asks_always, mul_piece);
}

void cs_springs_mul_add(const struct cs_springs *springs, uint32_t n, const double *factors,
                        const double *p, double *y) {
    struct job job = {.springs = springs, .n = n, .at = {.x = p}, .factors = factors, .to = y};
    cs_pool_run(springs->n_lots, wait_mul_lot, &job);
    cs_pool_run(springs->n_blocks, mul_add_block, &job);
}

CS_CLONES void cs_springs_factor_diagonal(const struct cs_springs *springs, uint32_t n,
                                          const double *factors, double *sums) {
    struct blocks blocks;
    for (uint32_t r = 0; r < springs->n_runs; r++) {
        const struct cs_spring_run *run = springs->runs + r;
        for (uint32_t start = 0; start < run->count; start += PIECE) {
            const struct piece piece = piece_of(run, start);
            const double *s = factors + 4 * (size_t)run->first + start;
            const double *wx = s + run->count, *wy = wx + run->count, *wz = wy + run->count;
            for (size_t i = 0; i < piece.count; i++)
                set_block(&blocks, i, s[i], 1, (struct difference){wx[i], wy[i], wz[i]});
            add_blocks(&piece, &blocks, n, sums);
        }
    }
}
