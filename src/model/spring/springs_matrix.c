/* The springs' Jacobian in the factored form y = sum of (s I + w w^T)(p_a - p_b) that the
 * linear solver multiplies by. */
#include "model/spring/springs.h"

#include "base/pool.h"
#include "model/spring/grid_stencil.h"

#include <float.h>
#include <math.h>

/* factors of one piece, where they lie in the run's */
CS_INLINE void factor_of(const struct piece *piece, struct ends e,
                         const struct cs_matrix *matrix, const bool listed, double *base) {
    const struct cs_spring_run *run = piece->run;
    const double cd = matrix->cd, ck = matrix->ck;
    /* of a rest length to a length, in the matrix */
    const double most = matrix->psd ? 1 : HUGE_VAL;
    const double gamma = run->axial ? 0 : -cd * run->damping;
    const double eta = run->axial ? -cd * run->damping : 0;
    double *restrict s = base + piece->start;
    double *restrict wx = s + run->count, *restrict wy = wx + run->count;
    double *restrict wz = wy + run->count;
    const double L = run->length, k = run->stiffness;
    const size_t count = piece->count;
    CS_INDEPENDENT
    for (size_t i = 0; i < count; i++) {
        const double length = listed ? piece->lengths[i] : L;
        const double stiffness = -ck * (listed ? piece->stiffnesses[i] : k);
        const struct difference d = across(e, i, listed);
        const double inverse = 1 / sqrt(d.x * d.x + d.y * d.y + d.z * d.z + DBL_MIN);
        const double ratio = length * inverse;
        /* a compressed spring's axial stiffness is k: beta alone would exceed it */
        const double clamped = ratio < most ? ratio : most;
        s[i] = gamma + stiffness * (1 - clamped);
        const double w = sqrt(stiffness * clamped + eta) * inverse;
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
    struct gather_buffer places;
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
        if (!springs->slots || !springs->runs[r].ends)
            factor_springs(made, springs->runs + r, 0, springs->runs[r].count);
}

CS_CLONES static void factor_chunk(void *arg, uint32_t number) {
    const struct factoring *made = arg;
    const struct cs_spring_chunk *chunk = made->springs->chunks + number;
    factor_springs(made, made->springs->runs + chunk->run, chunk->begin, chunk->end);
}

void cs_springs_factor(const struct cs_springs *springs, uint32_t n,
                       const struct cs_matrix *matrix, double *factors) {
    struct factoring made = {springs, n, matrix, factors};
    cs_pool_run((springs->n_runs + RUNS - 1) / RUNS, factor_runs, &made);
    cs_pool_run(springs->n_chunks, factor_chunk, &made);
}

/* w.(p_a - p_b), left to right: the sum order is part of the state hash */
CS_INLINE struct difference mul_of(double s, const struct difference w,
                                   const struct difference d) {
    const double along = w.x * d.x + w.y * d.y + w.z * d.z;
    return (struct difference){s * d.x + along * w.x, s * d.y + along * w.y,
                               s * d.z + along * w.z};
}

CS_INLINE void mul(const struct stencil_input *in, const struct stencil_direction *way,
                   size_t i, double *out) {
    const double *p = in->x, *s = way->factors;
    const size_t n = in->n, b = i + way->offset, count = way->count;
    const struct difference w = {s[count + i], s[2 * count + i], s[3 * count + i]};
    const struct difference d = {p[i] - p[b], p[n + i] - p[n + b], p[2 * n + i] - p[2 * n + b]};
    fan_put(mul_of(s[i], w, d), out);
}

CS_STENCIL_KERNEL(product, mul, 3, 0, 0);

static const struct stencil_kernel *choose_mul(const struct spring_job *job,
                                               const struct cs_spring_run *first) {
    (void)job, (void)first;
    return &product;
}

CS_INLINE void mul_piece(const struct spring_job *job, const struct piece *piece,
                         double *restrict fx, double *restrict fy, double *restrict fz) {
    struct gather_buffer places;
    const struct cs_spring_run *run = piece->run;
    const double *s = job->factors + 4 * (size_t)run->first + piece->start;
    const double *wx = s + run->count, *wy = wx + run->count, *wz = wy + run->count;
    const struct ends e = ends_of(piece, job->at.x, job->n, true, &places);
    for (size_t i = 0; i < piece->count; i++) {
        const struct difference w = {wx[i], wy[i], wz[i]};
        const struct difference f = mul_of(s[i], w, across(e, i, true));
        fx[i] = f.x;
        fy[i] = f.y;
        fz[i] = f.z;
    }
}

CS_CLONES static void wait_mul_chunk(void *job, uint32_t chunk) {
    compute_chunk_to_slots(job, ((const struct spring_job *)job)->springs->chunks + chunk,
                           has_anything, mul_piece);
}

CS_CLONES static void mul_add_block(void *arg, uint32_t number) {
    const struct spring_job *job = arg;
    const struct cs_block block = cs_springs_block(job->springs, (uint32_t)job->n, number);
    add_runs(job, &block, has_anything, choose_mul, mul_piece);
}

void cs_springs_mul_add(const struct cs_springs *springs, uint32_t n, const double *factors,
                        const double *p, double *y) {
    struct spring_job job = {
        .springs = springs, .n = n, .at = {.x = p}, .factors = factors, .to = y};
    cs_pool_run(springs->n_chunks, wait_mul_chunk, &job);
    cs_pool_run(springs->n_blocks, mul_add_block, &job);
}
